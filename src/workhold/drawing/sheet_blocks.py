"""The blocks of words and tables on a setup sheet: title, steps, quality, and loads, and which there are."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite

from workhold.drawing.hardware_table import write_hardware
from workhold.drawing.panel import TextColumn, draw_legend, fixture_words, pegs_words, value_words
from workhold.drawing.program_picture import write_program
from workhold.drawing.scene import BLACK, LengthUnit, degrees_text, shortened, text_width, wrapped
from workhold.drawing.seats import write_seating, write_wrong_seats
from workhold.drawing.sheet_setting import CLAMPS, OPENING, write_counting, write_pegs
from workhold.drawing.sheet_writing import BODY, NOTE, Block, MovingBlocks, Sheet, Writer, heading
from workhold.drawing.supports_drawn import draw_pad, draw_tip, support_steps, write_heights, write_supports
from workhold.drawing.upper_side import write_part, write_side, write_side_up
from workhold.fixels.carrier import Measure
from workhold.model.quality import (
    CLAMP_AMPLIFICATION,
    CLOSURE_MARGIN,
    EDGE_DISTANCE,
    FIGURES,
    LOAD_REACTION,
    LOCATION_ERROR,
    WRENCH_RADIUS,
)
from workhold.model.requirements import ANY_DIRECTION, Load
from workhold.model.setup import contact_names
from workhold.statics.loads import jaw_words
from workhold.units import INCH

__all__ = ["blocks_of"]

ON_THE_SHEET = (
    CLOSURE_MARGIN,
    CLAMP_AMPLIFICATION,
    WRENCH_RADIUS,
    LOCATION_ERROR,
    EDGE_DISTANCE,
    LOAD_REACTION,
)
# More loads than this are left to the command line; the hardest are shown.
MOST_LOADS = 6
# Of the width of a column, how much the name of a load may take.
WIDEST_LOAD = 0.3


def write_quality(column: TextColumn, sheet: Sheet) -> None:
    """Writes the figures of quality that are known, but for those that other blocks show."""
    heading(column, "Quality")
    for figure in (FIGURES[number] for number in ON_THE_SHEET):
        value = sheet.fixture.quality.get(figure.key)
        if value is None:
            continue
        match figure.unit:
            # The figure is then the length that stands for no edge, which nobody can measure on the part.
            case "mm" if figure.key == FIGURES[EDGE_DISTANCE].key and not any(
                map(isfinite, sheet.edge_distances)
            ):
                words = "no edge there"
            case "mm":
                words = sheet.lengths.words(value)
            case "N":
                words = sheet.lengths.unit.force_words(value)
            case _:
                words = value_words(value)
        column.fact(figure.words + (" (largest peg force)" if figure.key == "load_reaction" else ""), words)
    tolerance, lengths = sheet.details.tolerance, sheet.lengths
    if "location_error" in sheet.fixture.quality:
        sizes = (tolerance.peg, tolerance.face, tolerance.departure)
        peg, face, off = (lengths.short(size, 3) for size in sizes)
        read = f", of which {off} because the drawing's curves were read as arcs"
        allowed = f"pegs off by up to {peg}, faces by {face}{read if tolerance.departure else ''}"
        column.paragraph(f"Location error: {allowed}.", NOTE)
    if sheet.details.why_first:
        column.paragraph(sheet.details.why_first, NOTE)


def load_words(load: Load, lengths: LengthUnit) -> str:
    """What a load is, in the part's coordinates.

    >>> load_words(Load(((10, 5),), 200, (30, 30), -500), LengthUnit.mm(1))
    '200 N at x 10.0, y 5.0 mm, towards 30°; moment −0.5 N m'
    """
    unit, words = lengths.unit, []
    if load.force:
        x, y = (lengths.number(value) for value in load.points[0])
        place = (
            f"x {x}, y {y} {unit.abbreviation}"
            if len(load.points) == 1
            else f"the worst of {len(load.points)} points"
        )
        low, high = load.directions
        towards = f"towards {low:g}°" if low == high else f"towards {low:g}° to {high:g}°"
        any_way = load.directions == ANY_DIRECTION
        words.append(f"{unit.force_words(load.force)} at {place}, {'any direction' if any_way else towards}")
    if load.moment:
        words.append(f"moment {unit.moment_words(load.moment)}")
    return "; ".join(words)


def write_loads(column: TextColumn, sheet: Sheet) -> None:
    """Writes the loads, the hardest first, with the jaw force needed and each peg's largest force."""
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
        column.paragraph(
            f"{case.load.name or f'load {number}'}: {load_words(case.load, sheet.lengths)}.", NOTE
        )
    if len(cases) > MOST_LOADS:
        column.paragraph(
            f"The other {len(cases) - MOST_LOADS} loads need no more {moving.noun} force than these.", NOTE
        )
    at = unit.force_words(cases[0][1].jaw_force)
    what = f"the {moving.noun} force below which a peg lets go in "
    what += jaw_words(cases[0][1].jaw_stiffness, sheet.toolkit)
    column.paragraph(f"{header[1].capitalize()}: {what}, without friction.", NOTE)
    if not sheet.is_closed_at_once:
        column.paragraph(
            f"The {moving.noun} force is that of both {moving.noun}s added up, in the ratio stated.", NOTE
        )
    if details.friction is not None:
        column.paragraph(
            f"µ {details.friction:g}: the least {moving.noun} force that could hold at all with that "
            "friction.",
            NOTE,
        )
    column.paragraph(
        f"Under each {pegs_words(sheet.toolkit)}: its largest force on the part at a {moving.noun} force "
        f"of {at}.",
        NOTE,
    )


def write_bending(column: TextColumn, sheet: Sheet) -> None:
    """Writes how far each peg bends, and what that moves the part by."""
    bent, lengths, mover = sheet.details.bent, sheet.lengths, sheet.toolkit.moving.noun
    assert bent is not None
    heading(column, f"{sheet.toolkit.plates[0].peg.capitalize()}s bend")
    at = bent.at_force(mover, lengths.unit)
    header = [
        "",
        f"pressed at {lengths.sign}",
        f"gives way {lengths.sign}",
        f"stress {lengths.unit.pressure}",
    ]
    rows = [
        [
            peg.hole,
            lengths.number(peg.height),
            lengths.number(peg.deflection),
            lengths.unit.stress_number(peg.stress),
        ]
        for peg in bent.pegs
    ]
    column.table(header, rows, BODY)
    column.fact("moves the part by up to", lengths.words(bent.movement))
    column.fact("with forces at the top", lengths.words(bent.worst_movement))
    column.paragraph(
        f"{at[0].upper()}{at[1:]}, beside the location error. Built in at the {sheet.plates_noun}, Ø "
        f"{lengths.short(bent.most.diameter)}; a real hole gives more.",
        NOTE,
    )


NAME_SIZES = (26.0, 22.0, 18.0)
MOST_NAME_LINES = 3
# What a sheet says of what moves, by what is set on it.
MOVING: Mapping[Measure, MovingBlocks] = {"opening": OPENING, "stroke": CLAMPS, "tip": CLAMPS}


def blocks_of(sheet: Sheet) -> tuple[list[Block], list[Block]]:
    """All blocks of a sheet in reading order: those needed beside the plan, and the others."""
    moving = MOVING[sheet.toolkit.moving.measure]
    needed: list[Writer] = [write_title, write_pegs, *moving.settings(sheet), write_zero]
    others: list[Writer] = [write_side, write_part, write_steps]
    if sheet.cautions:
        needed.append(write_cautions)
    if sheet.details.program is not None:
        needed.append(write_program)
    upright: list[Writer] = [] if sheet.details.supports is None else [write_supports]
    upright += [write_hardware] if sheet.heights is None else [write_heights, write_hardware]
    if sheet.workpiece.solid is not None:
        upright.append(write_side_up)
    others = [*upright, *others]
    if sheet.seating is not None:
        others += [write_seating, write_wrong_seats]
    elif sheet.details.by_hand is not None or sheet.details.not_seated:
        others.append(write_seating)
    if sheet.details.loads:
        others.append(write_loads)
    if sheet.details.bent is not None:
        others.append(write_bending)
    others += [write_quality, write_counting, write_legend]

    def bound(writer: Writer) -> Block:
        return lambda column: writer(column, sheet)

    return list(map(bound, needed)), list(map(bound, others))


def write_title(column: TextColumn, sheet: Sheet) -> None:
    size = next(
        (s for s in NAME_SIZES if text_width(sheet.name, s, bold=True) <= column.width), NAME_SIZES[-1]
    )
    lines = wrapped(sheet.name, size, column.width, bold=True)
    if len(lines) > MOST_NAME_LINES:
        rest = " ".join(lines[MOST_NAME_LINES - 1 :])
        lines = [*lines[: MOST_NAME_LINES - 1], shortened(rest + "…", size, column.width, bold=True)]
    for line in lines:
        column.words(line, size, bold=True, gap=0.4)
    column.y += 4
    column.words(f"Fixture {sheet.details.number} of {sheet.details.count}", 16, bold=True, gap=0.5)
    column.paragraph(fixture_words(sheet.fixture, sheet.toolkit), BODY)
    x0, y0, x1, y1 = sheet.workpiece.bounds
    outside = f"{sheet.lengths.number(x1 - x0)} × {sheet.lengths.words(y1 - y0)}"
    column.words(f"Outside {outside}, as drawn", BODY, gap=0.3)


def write_zero(column: TextColumn, sheet: Sheet) -> None:
    zero, lengths = sheet.zero, sheet.lengths
    (x, y), turn = sheet.zero_place, sheet.fixture.pose.written_deg
    heading(column, "Part zero X0 Y0 and angle")
    column.fact("X0 Y0 is the", zero.words, BODY, bold=True)
    column.fact(f"x from {sheet.datum.x}", lengths.words(x), bold=True)
    column.fact(f"y from {sheet.datum.y}", lengths.words(y), bold=True)
    column.fact("turned by θ, counter-clockwise", degrees_text(turn, 4), bold=True)
    drawn = ", y ".join(map(lengths.words, zero.point))
    place = "" if sheet.zero_shown else " It lies outside the plan."
    column.paragraph(f"In the part's drawing it is at x {drawn}.{place} x runs to the right, y upward.", NOTE)
    # Haas takes three places behind the point (Mill Operator's Manual, G68).
    word = f"{turn:z.3f}"
    turning = f"G68 X0 Y0 R{word}" if float(word) else "no G68, as the part is not turned"
    machine = sheet.details.machine_position
    if machine is None:
        words = f"G54: the machine's position over {sheet.datum.point}, plus this x and y; then {turning}."
        column.paragraph(words, NOTE)
        return
    gx, gy = (
        lengths.number(start + way).replace("−", "-") for start, way in zip(machine, (x, y), strict=True)
    )
    unit = "G20" if sheet.lengths.unit is INCH else "G21"
    column.paragraph(
        f"{sheet.datum.name} at machine {' and '.join(map(lengths.words, machine))}, x along the "
        "machine's X:",
        NOTE,
    )
    column.y += 3
    column.words(f"{unit} G10 L2 P1 X{gx} Y{gy}", BODY, bold=True)
    column.words(f"G54 {turning}" if float(word) else "G54", BODY, bold=True)


def write_cautions(column: TextColumn, sheet: Sheet) -> None:
    heading(column, "Beware")
    for caution in sheet.cautions:
        column.item("▲", caution.sentence, BODY)


def write_steps(column: TextColumn, sheet: Sheet) -> None:
    heading(column, "Setting up")
    given = "as given under part zero X0 Y0, or touch off the part there"
    zero = f"Set the machine's zero, G54, from {sheet.datum.name} {given}."
    steps = support_steps(sheet, MOVING[sheet.toolkit.moving.measure].steps(sheet))
    for number, step in enumerate([*steps, zero], 1):
        column.item(f"{number}.", step, BODY)


def write_legend(column: TextColumn, sheet: Sheet) -> None:
    heading(column, "Signs")
    of_supports = ((draw_pad, "support below the part"), (draw_tip, "clamp on top, presses down"))
    draw_legend(column, sheet.toolkit, BLACK, of_supports if sheet.details.supports is not None else ())
