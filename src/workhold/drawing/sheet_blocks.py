"""The blocks of words and tables on a setup sheet: title, steps, quality, loads, and the part's upper side.

A part turned over shows the mirror image of its outline. Where that is the outline itself, nothing
distinguishes the sides. Else two marks do that look like no others: the way from one to the other,
counter-clockwise about the middle, is less than half a turn on one side only. Turning the part round does not
change that.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from math import atan2, hypot, pi

from attrs import frozen

from workhold.drawing.bench import draw_inset
from workhold.drawing.panel import TextColumn, draw_legend, fixture_words, pegs_words
from workhold.drawing.scene import BLACK, Box, LengthUnit, shortened, text_width, wrapped
from workhold.drawing.seats import write_seating, write_wrong_seats
from workhold.drawing.sheet_setting import CLAMPS, OPENING, write_counting, write_pegs
from workhold.drawing.sheet_writing import (
    BODY,
    NOTE,
    Block,
    MovingBlocks,
    Sheet,
    Writer,
    fact_or_field,
    heading,
)
from workhold.fixels.carrier import Measure
from workhold.geometry.segment import Arc, Point
from workhold.geometry.symmetry import is_own_mirror_image, middle_of
from workhold.model.fixture import Fixture
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
from workhold.model.setup import contact_names, hole_centers
from workhold.model.workpiece import Workpiece
from workhold.statics.loads import jaw_words
from workhold.units import INCH

__all__ = ["Mark", "blocks_of", "distinguishing_marks", "marks_of", "side_words"]

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
            case "mm":
                words = sheet.lengths.words(value)
            case "N":
                words = sheet.lengths.unit.force_words(value)
            case _:
                words = f"{value:.4f}" if value >= 0.001 else f"{value:.2e}".replace("-", "−")
        column.fact(figure.words + (" (largest peg force)" if figure.key == "load_reaction" else ""), words)
    tolerance, lengths = sheet.details.tolerance, sheet.lengths
    if "location_error" in sheet.fixture.quality:
        sizes = (tolerance.peg, tolerance.face, tolerance.departure)
        peg, face, off = (lengths.short(size, 3) for size in sizes)
        read = f", of which {off} because the drawing's curves were read as arcs"
        allowed = f"pegs off by up to {peg}, faces by {face}{read if tolerance.departure else ''}"
        column.paragraph(f"Location error: {allowed}.", NOTE)


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


# Of the larger one: lengths and radii of two marks that differ by less look the same.
SEEN = 0.025
# The sine of the angle between two marks, seen from the middle, is at least this; and of the part's diagonal
# each is so far from the middle.
APART, AWAY = 0.3, 0.08
# So many of the longest marks are compared.
MOST_MARKS = 60
EIGHTHS = ("right", "upper right", "top", "upper left", "left", "lower left", "bottom", "lower right")
# Height of the picture of the part as drawn by its width, and at most, page units.
TALLEST_INSET, HIGHEST_INSET, INSET_ROOM = 0.75, 230.0, 56.0


def write_side(column: TextColumn, sheet: Sheet) -> None:
    """Writes the part's thickness, and which side is up."""
    heading(column, "Part and its upper side")
    thickness = sheet.details.thickness
    fact_or_field(column, "thickness", None if thickness is None else sheet.lengths.words(thickness))
    column.paragraph(side_words(sheet.workpiece, sheet.fixture, sheet.lengths), BODY)


def write_part(column: TextColumn, sheet: Sheet) -> None:
    """Draws the part as it was drawn."""
    x0, y0, x1, y1 = sheet.workpiece.bounds
    height = INSET_ROOM + min(HIGHEST_INSET, column.width * min(TALLEST_INSET, (y1 - y0) / (x1 - x0)))
    column.y += 10
    box = Box(column.x, column.y, column.x + column.width, column.y + height)
    draw_inset(column.scene, box, sheet.workpiece, sheet.fixture, sheet.toolkit, sheet.zero.point)
    column.y += height


@frozen
class Mark:
    """A hole or a face of the outer outline; lengths in mm.

    Parameters
    ----------
    hole : its number, counted from 1; 0 for a face.
    place : its middle, from that of the part's outside dimensions, in the part's coordinates.
    length : of its outline.
    radius : of a round hole or an arc; 0 for what is straight or has several faces.
    bend : 1 where it bulges out of the part, -1 into it, 0 where it is straight; 2 for holes.
    """

    hole: int
    place: Point
    length: float
    radius: float
    bend: int

    def is_like(self, other: Mark) -> bool:
        """Whether the two look the same."""
        sizes = ((self.length, other.length), (self.radius, other.radius))
        return self.bend == other.bend and all(abs(a - b) <= SEEN * max(a, b) for a, b in sizes)

    def words(self, lengths: LengthUnit) -> str:
        """What it is."""
        if self.hole:
            return f"hole {self.hole}" + (f", Ø {lengths.short(2 * self.radius, 4)}," if self.radius else "")
        if self.radius:
            return (
                f"the {'rounding' if self.bend > 0 else 'hollow'} of radius {lengths.short(self.radius, 4)}"
            )
        return f"the straight edge {lengths.short(self.length, 4)} long"


def marks_of(workpiece: Workpiece) -> list[Mark]:
    """The holes, and after them the faces of the outer outline, the longest first of either."""
    outer, (x, y) = len(workpiece.loops[0]), workpiece.center
    segments = {face.number: face.segment for face in workpiece.faces}
    holes, number = [], outer
    for count, (loop, at) in enumerate(
        zip(workpiece.loop_segments[1:], hole_centers(workpiece), strict=True), 1
    ):
        face = segments.get(number)
        radius = face.radius if isinstance(face, Arc) and face.is_full else 0.0
        holes.append(Mark(count, (at[0] - x, at[1] - y), sum(segment.length for segment in loop), radius, 2))
        number += len(loop)
    faces = []
    for segment in (segments[number] for number in segments if number < outer):
        radius, bend = (segment.radius, int(segment.sign)) if isinstance(segment, Arc) else (0.0, 0)
        at = middle_of(segment)
        faces.append(Mark(0, (at[0] - x, at[1] - y), segment.length, radius, bend))
    ordered = [sorted(several, key=lambda mark: -mark.length) for several in (holes, faces)]
    return (ordered[0] + ordered[1])[:MOST_MARKS]


def distinguishing_marks(workpiece: Workpiece) -> tuple[Mark, Mark] | None:
    """The two marks, each like no other, that are plainest to see; None where there are no two.

    They span the largest triangle with the middle. A triangle counts twice with one hole and three times with
    two.
    """
    marks = marks_of(workpiece)
    x0, y0, x1, y1 = workpiece.bounds
    away = AWAY * hypot(x1 - x0, y1 - y0)
    single = [
        mark
        for mark in marks
        if hypot(*mark.place) >= away and not any(mark.is_like(other) for other in marks if other is not mark)
    ]
    best: tuple[float, tuple[Mark, Mark]] | None = None
    for one, other in combinations(single, 2):
        area = abs(one.place[0] * other.place[1] - one.place[1] * other.place[0])
        if area < APART * hypot(*one.place) * hypot(*other.place):
            continue
        plain = area * (1 + (one.hole > 0) + (other.hole > 0))
        if best is None or plain > best[0]:
            best = plain, (one, other)
    return best and best[1]


def side_words(workpiece: Workpiece, fixture: Fixture, lengths: LengthUnit) -> str:
    """Sentences on which side is up in a fixture and how to see it."""
    if is_own_mirror_image([face.segment for face in workpiece.faces]):
        return (
            "The outline is its own mirror image: either side up looks alike and lies in the same pegs. If "
            "the sides differ, mark the upper one first."
        )
    marks = distinguishing_marks(workpiece)
    if marks is None:
        return (
            "The outline differs from its mirror image, but by nothing that is plain to see: mark the upper "
            "side first, and hold the part beside the plan."
        )
    (x, y), places = fixture.pose.apply(*workpiece.center), []
    for mark in marks:
        there = fixture.pose.apply(mark.place[0] + workpiece.center[0], mark.place[1] + workpiece.center[1])
        eighth = round(atan2(float(there[1] - y), float(there[0] - x)) / (pi / 4)) % 8
        places.append(f"{mark.words(lengths)} at the {EIGHTHS[eighth]}")
    return f"Lying as in the plan, it has {places[0]} and {places[1]}. Turned over, it never has."


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
    if sheet.seating is not None:
        others += [write_seating, write_wrong_seats]
    elif sheet.details.by_hand is not None or sheet.details.not_seated:
        others.append(write_seating)
    if sheet.details.loads:
        others.append(write_loads)
    others += [write_quality, write_counting, write_legend]

    def bound(writer: Writer) -> Block:
        return lambda column: writer(column, sheet)

    return list(map(bound, needed)), list(map(bound, others))


def write_title(column: TextColumn, sheet: Sheet) -> None:
    """Writes which fixture of which part this is."""
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
    """Writes part zero, its place, the part's turn, and the lines to program a control with."""
    zero, lengths = sheet.zero, sheet.lengths
    (x, y), turn = sheet.zero_place, f"{sheet.fixture.pose.theta_deg:.4f}"
    heading(column, "Part zero X0 Y0 and angle")
    column.fact("X0 Y0 is the", zero.words, BODY, bold=True)
    column.fact(f"x from {sheet.datum.x}", lengths.words(x), bold=True)
    column.fact(f"y from {sheet.datum.y}", lengths.words(y), bold=True)
    column.fact("turned by θ, counter-clockwise", f"{turn}°", bold=True)
    drawn = ", y ".join(map(lengths.words, zero.point))
    place = "" if sheet.zero_shown else " It lies outside the plan."
    column.paragraph(f"In the part's drawing it is at x {drawn}.{place} x runs to the right, y upward.", NOTE)
    # Haas takes three places behind the point (Mill Operator's Manual, G68).
    word = f"{sheet.fixture.pose.theta_deg:.3f}"
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
    """Writes what to beware of, each behind a sign."""
    heading(column, "Beware")
    for caution in sheet.cautions:
        y = column.y
        column.scene.text((column.x, y + 0.75 * BODY), "▲", BODY, bold=True, middle=False)
        column.paragraph(caution.sentence, BODY, indent=18)
        column.y += 2


def write_steps(column: TextColumn, sheet: Sheet) -> None:
    """Writes what to do, in order."""
    heading(column, "Setting up")
    given = "as given under part zero X0 Y0, or touch off the part there"
    zero = f"Set the machine's zero, G54, from {sheet.datum.name} {given}."
    for number, step in enumerate([*MOVING[sheet.toolkit.moving.measure].steps(sheet), zero], 1):
        column.scene.text((column.x, column.y + 0.75 * BODY), f"{number}.", BODY, bold=True, middle=False)
        column.paragraph(step, BODY, indent=18)
        column.y += 2


def write_legend(column: TextColumn, sheet: Sheet) -> None:
    """Explains the signs of the plan."""
    heading(column, "Signs")
    draw_legend(column, sheet.toolkit, BLACK)
