"""What supports, a seating, a result without fixtures and one without its widget show in a notebook.

Each shows tables, and a picture where there is one. Of a result without fixtures these are the rules, the
nearest miss, and what would help.
"""

from __future__ import annotations

from importlib.util import find_spec
from math import isfinite
from typing import TYPE_CHECKING, Any

from attrs import frozen

from workhold.drawing.bench import bench_of, draw_bench
from workhold.drawing.fixture_pictures import draw_thumbnail
from workhold.drawing.scene import Box, Scene, View
from workhold.drawing.supports_drawn import PlannedSupports, draw_supports
from workhold.errors import InputError
from workhold.model.quality import SEATING_FIGURES
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.search_report import Explanation
from workhold.model.support_triples import ChosenSupports
from workhold.presenting.data import REQUIREMENTS
from workhold.presenting.figure_words import figure_text, rounded, unit_of
from workhold.presenting.markup import Markup, image, paragraph, safe, table
from workhold.presenting.notebook import fixture_html, sentence
from workhold.supports.words import set_headings, set_row, why_no_set
from workhold.units import MILLIMETRE

if TYPE_CHECKING:
    from workhold.model.result import Result
    from workhold.model.seating import Seating
    from workhold.model.support_triples import Supports

__all__ = ["StillPicture", "WhyNone", "result_widget", "seating_html", "supports_html", "why_none"]

# Sets of three and seats that are shown; the width of a picture in pixels, and its page with a rim.
MOST_SETS, MOST_SEATS = 6, 12
SMALL, PAGE, RIM = 240, (360.0, 270.0), 8.0
# Changes that would help of which so many are shown, and the width of the picture in pixels.
MOST_HELPS, WIDE = 6, 320


def supports_html(supports: Supports) -> str:
    """Shows the supports of a fixture: the best sets of three with the clamp on top, or why there is none."""
    title = paragraph(Markup(f"<b>{safe(sentence(supports.words))}</b>"))
    if not supports.triples:
        return "\n".join((title, paragraph(why_no_set(supports, MILLIMETRE))))
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
    return image(scene.svg(), f"Supports in {names} under {query.workpiece.name}", SMALL, False)


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


@frozen(repr=False)
class WhyNone:
    """Why there is no fixture that a query asks for.

    Parameters
    ----------
    query : what was asked in vain.
    explanation : what each rule took away, the nearest miss, and what would help.
    """

    query: Query
    explanation: Explanation

    @property
    def words(self) -> str:
        """The sentence that says which rule took the last contacts away, or that there are none."""
        last, toolkit = self.explanation.last_rule, self.query.toolkit
        if not self.explanation.contacts or last is None:
            return f"No {toolkit.wording.four} can touch the part at the same time."
        return f"The last contacts were removed by: {last}."

    def __repr__(self) -> str:
        return f"<WhyNone: {self.words}>"

    def _repr_html_(self) -> str:
        pieces = [Markup(f"<p><b>{safe(self.words)}</b></p>")]
        explanation, toolkit = self.explanation, self.query.toolkit
        if explanation.removals:
            rows = [
                (one.rule, f"{one.before:,}", f"{one.removed:,}", f"{one.after:,}")
                for one in explanation.removals
            ]
            pieces.append(table(("rule", ">sets of four contacts", ">removed", ">left"), rows))
        if explanation.nearest is not None:
            drawn = draw_thumbnail(explanation.nearest.fixture, self.query.workpiece, toolkit)
            words = f"Nearest miss: {explanation.nearest.words}"
            pieces += [paragraph(words), paragraph(image(drawn, words, WIDE))]
        helps = [
            (one.change, f"{one.fixtures:,}" if one.complete else f"over {one.fixtures:,}")
            for one in explanation.helps[:MOST_HELPS]
        ]
        if helps:
            pieces.append(table(("what would help", ">fixtures"), helps))
        else:
            pieces.append(paragraph("No single change that was tried helps."))
        return "\n".join(pieces)


def why_none(result: Result) -> WhyNone:
    """Explains a result without fixtures, see :meth:`workhold.Result.why_none`."""
    from workhold.search.explaining import explain

    if len(result):
        raise InputError("there are fixtures: why there is none is asked of a result without one.")
    if sum(result.found.values()) or not result.complete:
        raise InputError(f"that there is none, was not found out. {' '.join(result.notes)}".strip())
    return WhyNone(result.query, explain(result.query))


@frozen(repr=False)
class StillPicture:
    """A fixture of a result that stands in for its widget.

    Parameters
    ----------
    result, rank : of the fixture, from 1.
    """

    result: Result
    rank: int

    def __repr__(self) -> str:
        return f"<StillPicture: fixture {self.rank} of {len(self.result)} of {self.result.workpiece.name}>"

    def _repr_html_(self) -> str:
        words = f"This picture moves with another library: pip install '{REQUIREMENTS['anywidget']}'."
        return f"{fixture_html(self.result[self.rank - 1])}\n{paragraph(words)}"


def result_widget(result: Result, rank: int = 1, **asked: Any) -> Any:
    """Makes the widget of a result, see :meth:`workhold.Result.widget`."""
    if find_spec("anywidget") is None:
        if not 1 <= rank <= len(result):
            raise InputError(f"there is no fixture {rank}: {len(result)} are listed.")
        return StillPicture(result, rank)
    from workhold.presenting.widget import FixtureWidget

    return FixtureWidget(result, rank, **asked)
