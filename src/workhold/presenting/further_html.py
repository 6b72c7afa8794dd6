"""What supports and a seating show of themselves in a notebook: tables, and a picture where there is one."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

from workhold.drawing.bench import bench_of, draw_bench
from workhold.drawing.scene import Box, Scene, View
from workhold.drawing.supports_drawn import PlannedSupports, draw_supports
from workhold.model.quality import SEATING_FIGURES
from workhold.model.recounted import ChosenSupports
from workhold.presenting.figure_words import figure_text, rounded, unit_of
from workhold.presenting.markup import Markup, image, paragraph, safe, table
from workhold.presenting.notebook import sentence
from workhold.supports.words import set_headings, set_row, why_none
from workhold.units import MILLIMETRE

if TYPE_CHECKING:
    from workhold.model.seating import Seating
    from workhold.model.support_triples import Supports

__all__ = ["seating_html", "supports_html"]

# Sets of three and seats that are shown; the width of a picture in pixels, and its page with a rim.
MOST_SETS, MOST_SEATS = 6, 12
WIDE, PAGE, RIM = 240, (360.0, 270.0), 8.0


def supports_html(supports: Supports) -> str:
    """Shows the supports of a fixture: the best sets of three with the clamp on top, or why there is none."""
    title = paragraph(Markup(f"<b>{safe(sentence(supports.words))}</b>"))
    if not supports.triples:
        return "\n".join((title, paragraph(why_none(supports, MILLIMETRE))))
    loaded = bool(supports.loads)
    headings = (">rank", "picture", *set_headings(MILLIMETRE, loaded))
    rows = [
        (str(rank), supports_picture(supports, rank), *set_row(triple, MILLIMETRE, loaded))
        for rank, triple in enumerate(supports.triples[:MOST_SETS], 1)
    ]
    notes = [
        "The clamp presses at that point of the part's coordinates; where the last figure is above 0, the "
        "part stands before it is clamped."
    ]
    if loaded:
        notes.append(f"Forces are for a closing force of {supports.jaw_force:.0f} N, without friction.")
    if len(supports.triples) > MOST_SETS:
        notes.insert(0, f"{MOST_SETS} of {len(supports.triples):,} sets of three shown.")
    return "\n".join((title, table(headings, rows), paragraph(*notes)))


def supports_picture(supports: Supports, rank: int) -> Markup:
    """The small picture of a fixture on a set of three."""
    chosen = ChosenSupports.of(supports, rank)
    query = supports.query
    bench = bench_of(chosen.recounted.fixture, query.workpiece, query.toolkit)
    scene = Scene.page(PAGE, query.workpiece.name)
    width, height = PAGE
    view = View.fitting(bench.extent, Box(RIM, RIM, width - RIM, height - RIM))
    draw_bench(scene, bench, view, weight=0.7, longest=26.0, axes=False)
    draw_supports(scene, PlannedSupports.of(chosen), view)
    names = ", ".join(pad.hole for pad in chosen.pads)
    return image(scene.svg(), f"Supports in {names} under {query.workpiece.name}", WIDE, False)


def seating_html(seating: Seating) -> str:
    """Shows a seating: its figures, and where else closing can come to rest."""
    unit, known = MILLIMETRE, seating.figures
    figures = [
        (one.words, figure_text(one, known[one.key], unit), unit_of(one, unit), one.meaning)
        for one in SEATING_FIGURES
    ]
    pieces = [
        paragraph(Markup(f"<b>{safe(sentence(seating.words))}</b>")),
        table(("figure", ">value", "unit", "meaning"), figures),
    ]
    own = next((seat for seat in seating.seats if seat.is_own), None)
    rows = []
    for number, seat in enumerate(seating.seats[:MOST_SEATS], 1):
        start = 0.0 if own is None else own.pose.theta_deg
        turned = (
            seat.pose.theta_deg if seat.mirrored else (seat.pose.theta_deg - start + 180.0) % 360.0 - 180.0
        )
        depth = seat.depth
        rows.append(
            (
                str(number),
                unit.number(seat.difference),
                rounded(turned, 1),
                "over" if seat.mirrored else "up",
                "-" if depth is None or not isfinite(depth) else unit.number(depth),
                "right" if seat.is_own else "same place" if seat.same_place else "wrong",
            )
        )
    of = unit.abbreviation
    pieces.append(paragraph("Where closing can come to rest:"))
    pieces.append(
        table((">seat", f">differs {of}", ">turned by", "side", f">held {of}", "how it lies"), rows)
    )
    if len(seating.seats) > MOST_SEATS:
        pieces.append(paragraph(f"{MOST_SEATS} of {len(seating.seats):,} seats shown."))
    return "\n".join([*pieces, *map(paragraph, (f"{sentence(words)}." for words in seating.warnings))])
