"""The blocks of figures on a setup sheet: quality, and what the loads do."""

from __future__ import annotations

from workhold.drawing.fonts import shortened
from workhold.drawing.length_unit import LengthUnit
from workhold.drawing.panel import Column, pegs_words
from workhold.drawing.sheet_writing import BODY, NOTE, Sheet, heading
from workhold.model.load import ANY_DIRECTION, Load
from workhold.model.quality import (
    CLAMP_AMPLIFICATION,
    CLOSURE_MARGIN,
    EDGE_DISTANCE,
    FIGURES,
    LOAD_REACTION,
    LOCATION_ERROR,
    WRENCH_RADIUS,
)
from workhold.model.setting import contact_names
from workhold.statics.jaw import jaw_words

__all__ = ["write_loads", "write_quality"]

ON_THE_SHEET = CLOSURE_MARGIN, CLAMP_AMPLIFICATION, WRENCH_RADIUS, LOCATION_ERROR, EDGE_DISTANCE, LOAD_REACTION
# More loads than this are left to the command line; the hardest are shown.
MOST_LOADS = 6
# Of the width of a column, how much the name of a load may take.
WIDEST_LOAD = 0.3


def write_quality(column: Column, sheet: Sheet) -> None:
    """Write the figures of quality that are known, but for those that cautions, loads and the angle tell of."""
    heading(column, "Quality")
    for figure in (FIGURES[number] for number in ON_THE_SHEET):
        value = sheet.fixture.quality.get(figure.key)
        if value is None:
            continue
        match figure.unit:
            case "mm":
                words = sheet.lengths.words(value)
            case "N":
                words = sheet.lengths.unit.force_words(value)
            case _:
                words = f"{value:.4f}" if value >= 0.001 else f"{value:.2e}".replace("-", "−")
        column.fact(figure.words + (" (largest peg force)" if figure.key == "load_reaction" else ""), words)
    tolerance, lengths = sheet.details.tolerance, sheet.lengths
    if "location_error" in sheet.fixture.quality:
        allowed = f"pegs off by up to {lengths.short(tolerance.peg, 3)}, faces by {lengths.short(tolerance.face, 3)}"
        read = f", of which {lengths.short(tolerance.departure, 3)} because the drawing's curves were read as arcs"
        column.paragraph(f"Location error: {allowed}{read if tolerance.departure else ''}.", NOTE)


def load_words(load: Load, lengths: LengthUnit) -> str:
    """What a load is, in the part's coordinates.

    >>> load_words(Load(((10, 5),), 200, (30, 30), -500), LengthUnit.mm(1))
    '200 N at x 10.0, y 5.0 mm, towards 30°; moment −0.5 N m'
    """
    unit, words = lengths.unit, []
    if load.force:
        x, y = (lengths.number(value) for value in load.points[0])
        place = (
            f"x {x}, y {y} {unit.abbreviation}" if len(load.points) == 1 else f"the worst of {len(load.points)} points"
        )
        low, high = load.directions
        towards = f"towards {low:g}°" if low == high else f"towards {low:g}° to {high:g}°"
        any_way = load.directions == ANY_DIRECTION
        words.append(f"{unit.force_words(load.force)} at {place}, {'any direction' if any_way else towards}")
    if load.moment:
        words.append(f"moment {unit.moment_words(load.moment)}")
    return "; ".join(words)


def write_loads(column: Column, sheet: Sheet) -> None:
    """Write what acts on the part, the jaw force it needs and each peg's largest force, the hardest load first."""
    details, unit, moving = sheet.details, sheet.lengths.unit, sheet.toolkit.moving
    heading(column, f"Loads and reactions, {unit.force}")
    cases = sorted(enumerate(details.loads, 1), key=lambda numbered: -numbered[1].needed.value)
    friction = [] if details.friction is None else [f"µ {details.friction:g}"]
    names = [name.removeprefix(f"{moving.noun} ") for name in contact_names(sheet.fixture, sheet.toolkit)]
    header = ["Load", "needs" if sheet.toolkit.tips else moving.pushers, *friction, *names]
    rows = []
    for number, case in cases[:MOST_LOADS]:
        name = shortened(case.load.name or f"load {number}", BODY, WIDEST_LOAD * column.width, bold=True)
        held = case.needed_with_friction
        more = [] if details.friction is None else ["–" if held is None else unit.force_above(held)]
        rows.append([name, unit.force_above(case.needed.value), *more, *map(unit.force_above, case.largest)])
    column.table(header, rows, BODY)
    for number, case in cases[:MOST_LOADS]:
        column.paragraph(f"{case.load.name or f'load {number}'}: {load_words(case.load, sheet.lengths)}.", NOTE)
    if len(cases) > MOST_LOADS:
        column.paragraph(
            f"The other {len(cases) - MOST_LOADS} loads need no more {moving.noun} force than these.", NOTE
        )
    at = unit.force_words(cases[0][1].jaw_force)
    what = jaw_words(cases[0][1].jaw_stiffness, sheet.toolkit)
    what = f"the {moving.noun} force below which a peg lets go in {what}"
    column.paragraph(f"{header[1].capitalize()}: {what}, without friction.", NOTE)
    if not sheet.is_closed_at_once:
        column.paragraph(f"The {moving.noun} force is that of both {moving.noun}s added up, in the ratio told.", NOTE)
    if details.friction is not None:
        column.paragraph(
            f"µ {details.friction:g}: the least {moving.noun} force that could hold at all with that friction.", NOTE
        )
    column.paragraph(
        f"Under each {pegs_words(sheet.toolkit)}: its largest force on the part at a {moving.noun} force of {at}.", NOTE
    )
