"""The path of the tip as rows of moves, in mm from the program's own zero: lines, arcs and drill cycles.

A rapid move to a place with an unknown coordinate is left out. A rapid move from such a place is reduced to
its end point. A cut is never left out: if its path is not fully known, the program is refused.

Arcs are split into spans of half a turn or less. In a drill cycle pecks (Q) go up and down between the plane
R and the bottom. One move down and one up sweep the same space, and replace all of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import atan2, ceil, cos, hypot, pi, sin, sqrt, tan
from typing import Any, NoReturn

from attrs import define, field, frozen

from workhold.conventions import ARC_RADII
from workhold.errors import InputError, join_words
from workhold.files.budget import LIMITS, Budget
from workhold.files.program.words import AT_FEED_UP, NOSE, ControlState
from workhold.files.questions import START
from workhold.limits import MOST_LENGTH

__all__ = [
    "AXES",
    "PathWriter",
    "Place",
    "PlaneArc",
    "Reached",
    "make_arc_about_center",
    "make_arc_of_radius",
    "drill_holes",
    "refuse_unknown",
]

AXES = "XYZ"
# Digits in mm to which places are rounded, so that sums of increments are the places that they mean.
DIGITS = 9
Place = tuple[float, float, float]
# A place of which not every coordinate needs to be known.
Reached = list[float | None]
Point = tuple[float, float]
MOST_REPEATS = 10_000
PECKING = ("73", "83")


@define
class PathWriter:
    """A writer of the moves that blocks make, with the control's state.

    Parameters
    ----------
    modes : state of the control whose moves are written.
    line : number of the line of the block that is read.
    rows : rows of the moves, see ``model.moves.Moves.from_rows``; the tool is -1 before any tool is called.
    arrivals : lines with a move that starts at an unknown place.
    unplaced : lines of incremental rapid moves that start at an unknown place.
    adrift : lines of rapid moves to a place with an unknown coordinate.
    nose : lines of rapid moves to a height of the spindle's nose.
    unpecked : lines of peck drilling without the depth of a peck, which does not change the swept space.
    has_heights : whether the program gives any height.
    offset_used : code of the zero from which the moves are measured; None before the first.
    budget : number of moves, and time, that may still be spent.
    """

    modes: ControlState = field(factory=ControlState)
    line: int = 0
    rows: list[tuple[Any, ...]] = field(factory=list)
    arrivals: list[int] = field(factory=list)
    unplaced: list[int] = field(factory=list)
    adrift: list[int] = field(factory=list)
    nose: list[int] = field(factory=list)
    unpecked: list[int] = field(factory=list)
    has_heights: bool = True
    offset_used: str | None = None
    budget: Budget = field(factory=lambda: Budget(LIMITS["program"]))

    def get_unit_scale(self) -> float:
        """Return the millimetres in the unit in force.

        Raises
        ------
        InputError
            Before the program says its unit.
        """
        if self.modes.unit is None:
            raise InputError(
                "a length stands before G20 (inch) or G21 (mm), so that its unit is not known: write one of "
                "them, or give the program's unit."
            )
        return self.modes.unit.millimetres

    def convert_to_mm(self, value: float) -> float:
        """Return a length in mm from a number in the unit in force.

        Raises
        ------
        InputError
            For a number before the program says its unit, and for a length that is too large.
        """
        found = round(value * self.get_unit_scale(), DIGITS)
        if abs(found) > MOST_LENGTH:
            raise InputError(f"the length {value:g} is beyond {MOST_LENGTH:g} mm: correct it.")
        return found

    def compute_target_position(self, values: dict[str, float], rapid: bool = False) -> Reached:
        """Return the position (x, y, z) in mm to which the axis
        words of a block lead; None for an unknown coordinate.

        Raises InputError for an increment from an unknown position, unless ``rapid`` says that the move is a
        rapid one: then its line is added to ``unplaced``.

        Parameters
        ----------
        values : numbers of the block by letter.
        """
        place = list(self.modes.place)
        if self.offset_used is not None and values:
            self.refuse_other_zero()
        for axis, letter in enumerate(AXES):
            if letter not in values:
                continue
            self.modes.named = True
            value = self.convert_to_mm(values[letter])
            if axis == 2 and self.modes.length == NOSE:
                place[axis], self.modes.lost[axis] = None, NOSE
                if rapid:
                    self.nose.append(self.line)
                continue
            if self.modes.distance == "91":
                before = place[axis]
                if before is None and rapid:
                    self.unplaced.append(self.line)
                    continue
                if before is None:
                    raise InputError(
                        f"{letter} is an increment (G91) from a place that the program does not say: write "
                        "where the tool goes first after G90."
                    )
                value = round(before + value, DIGITS)
                if abs(value) > MOST_LENGTH:
                    raise InputError(f"increments lead beyond {MOST_LENGTH:g} mm: correct them.")
            place[axis] = value
        return place

    def forget_position(self, axes: Iterable[int], why: str) -> None:
        """Set the tip's coordinates along some axes (0 to 2) to None, and store why they are unknown."""
        for axis in axes:
            self.modes.place[axis], self.modes.lost[axis] = None, why
        if self.modes.place[2] is None:
            self.modes.initial = None

    def set_zero_offset(self, offset: str) -> None:
        """Put a zero in force by its code; if the tip's position was measured from another zero, it becomes
        unknown.
        """
        if offset != self.modes.offset and self.modes.named:
            self.forget_position(range(3), f"line {self.line} changes to another zero")
        self.modes.offset = offset

    def refuse_other_zero(self) -> None:
        """Raise InputError if the position is measured from another zero than that of the moves so far."""
        modes = self.modes
        if self.offset_used != modes.offset:
            raise InputError(
                f"G{modes.offset} comes after moves in G{self.offset_used}, and how the two zeros lie to "
                "each other is not said by the program: give one program for each."
            )

    def move_to(self, place: Reached, cutting: bool, bulge: float = 0.0) -> None:
        """Move the tip to a position (x, y, z) in mm, and add a row for the move where its path is known.

        A move from an unknown position gives a row with equal start and end, both at ``place``; a rapid move
        to an unknown position gives no row. ``bulge`` is the arc's seen from above.

        Raises
        ------
        InputError
            For a cut along an unknown path, other than straight down or up to a known height.
        """
        before = self.modes.place
        x, y, z = place
        from_x, from_y, from_z = before
        if cutting and (z is None or None in before):
            upright = x is not None and y is not None and z is not None and (x, y) == (from_x, from_y)
            if not upright:
                refuse_unknown(
                    self, [None if None in ends else 0.0 for ends in zip(before, place, strict=True)]
                )
        self.modes.place = place
        if x is None or y is None or z is None:
            self.adrift.append(self.line)
            return
        end = (x, y, z)
        if from_x is None or from_y is None or from_z is None:
            self.arrivals.append(self.line)
            self.append_move(cutting, end, end, 0.0)
        elif before != place or self.has_other_tool():
            self.append_move(cutting, (from_x, from_y, from_z), end, bulge)

    def has_other_tool(self) -> bool:
        """Return whether the tool in the spindle is not the tool of the last row."""
        return bool(self.rows) and self.rows[-1][1] != self.modes.tool and self.modes.tool is not None

    def append_move(self, cutting: bool, start: Place, end: Place, bulge: float) -> None:
        """Append the row of a move from ``start`` to ``end`` in mm, with tool, feed and speed in force.

        Raises
        ------
        InputError
            For one move too many.
        """
        modes = self.modes
        self.offset_used = modes.offset
        feed = 0.0
        if cutting:
            feed = modes.feed * (1.0 if modes.unit is None else modes.unit.millimetres)
            # The inverse time of G93 counts for a block, not for its spans.
            feed *= {"94": 1.0, "95": modes.spindle, "93": 0.0}[modes.feed_kind]
        self.budget.spend()
        tool = -1 if modes.tool is None else modes.tool
        in_cycle = modes.cycle is not None
        self.rows.append((self.line, tool, cutting, start, end, bulge, feed, modes.spindle, in_cycle))


def refuse_unknown(path: PathWriter, place: Reached, what: str = "the tool cuts at a place") -> NoReturn:
    """Raise InputError for a cut at a place with unknown coordinates (None), with the reason and a remedy.

    ``what`` begins the message.
    """
    unknown: dict[str, list[int]] = {}
    for axis in (axis for axis, value in enumerate(place) if value is None):
        unknown.setdefault(path.modes.lost[axis], []).append(axis)
    reasons, remedies = [], []
    for why, axes in unknown.items():
        names = join_words([AXES[axis] for axis in axes])
        remedies.append(f"write {names} with G0 before it")
        if axes == [2] and not path.has_heights:
            reasons.append("no height (Z) is given anywhere in the program")
        elif why == NOSE:
            reasons.append("Z is the height of the spindle's nose after G49, and not that of the tip")
            remedies[-1] = "write G43 with H and Z before it"
        elif why:
            reasons.append(f"{why}, and {names} {'is' if len(axes) == 1 else 'are'} not named after it")
        else:
            reasons.append(f"{names} {'is' if len(axes) == 1 else 'are'} not named before")
    either = f", or give where the tip is at the start with {START}" if "" in unknown else ""
    raise InputError(
        f"{what} that the program does not say, as {' and '.join(reasons)}: {' and '.join(remedies)}{either}."
    )


@frozen
class PlaneArc:
    """An arc from a place to another, perhaps over several turns.

    Parameters
    ----------
    center : (x, y) in mm.
    sweep : in radians, positive counter-clockwise.
    """

    center: Point
    sweep: float

    def iterate_spans(self, start: Place, end: Place) -> Iterator[tuple[Place, float]]:
        """Yield the end and the bulge of each span of the arc; a span is at most half a turn.

        If the arc's ends are not equally far from the centre, the distance from the centre changes linearly
        with the sweep; so does the height.
        """
        count = max(ceil(abs(self.sweep) / pi - 1e-9), 1)
        (x, y), part = self.center, self.sweep / count
        bulge = tan(part / 4)
        from_x, from_y = start[0] - x, start[1] - y
        angle, radius = atan2(from_y, from_x), hypot(from_x, from_y)
        last = hypot(end[0] - x, end[1] - y)
        for number in range(1, count):
            share, turned = number / count, angle + number * part
            reach = radius + share * (last - radius)
            height = start[2] + share * (end[2] - start[2])
            yield (x + reach * cos(turned), y + reach * sin(turned), height), bulge
        yield end, bulge


def make_arc_about_center(center: Point, start: Place, end: Place, clockwise: bool, turns: int) -> PlaneArc:
    """Return an arc about a centre (x, y) in mm; a full circle where its ends are the same.

    The arc makes ``turns`` - 1 whole turns more. Raises InputError for ends that are not equally far from the
    centre.
    """
    (x, y), (to_x, to_y) = (
        (start[0] - center[0], start[1] - center[1]),
        (end[0] - center[0], end[1] - center[1]),
    )
    radius, other = hypot(x, y), hypot(to_x, to_y)
    if abs(radius - other) > ARC_RADII or min(radius, other) == 0.0:
        raise InputError(
            f"the arc begins {radius:.4f} mm from its centre and ends {other:.4f} mm from it: correct I and "
            "J, which are distances from the arc's start, or places after G90.1."
        )
    angle = atan2(x * to_y - y * to_x, x * to_x + y * to_y)
    if clockwise:
        angle = -angle
    if angle <= 0.0:
        angle += 2 * pi
    angle += 2 * pi * (turns - 1)
    return PlaneArc(center, -angle if clockwise else angle)


def make_arc_of_radius(radius: float, start: Place, end: Place, clockwise: bool) -> PlaneArc:
    """Return an arc of a radius in mm; of more than half a turn where the radius is negative.

    Raises InputError for equal ends, and for ends too far apart.
    """
    x, y = end[0] - start[0], end[1] - start[1]
    chord, size = hypot(x, y), abs(radius)
    if chord == 0.0:
        raise InputError(
            "an arc with R ends where it begins, so that its centre is not known: write I and J."
        )
    if chord / 2 > size + ARC_RADII:
        raise InputError(
            f"the arc's ends are {chord:.4f} mm apart, more than twice its radius of {size:.4f} mm: correct "
            "R."
        )
    away = sqrt(max(size * size - chord * chord / 4, 0.0))
    half = atan2(chord / 2, away)
    sweep = 2 * half if radius > 0 else 2 * pi - 2 * half
    # The centre lies to the left of an arc that is run counter-clockwise and is less than half a turn.
    side = away if (radius > 0) != clockwise else -away
    center = (start[0] + x / 2 - side * y / chord, start[1] + y / 2 + side * x / chord)
    return PlaneArc(center, -sweep if clockwise else sweep)


def drill_holes(path: PathWriter, values: dict[str, float]) -> set[str]:
    """Add the moves of a block with a drill cycle: over the hole, down to R, to Z at the feed, and up again.

    With L or K this is repeated, each time moved on by the increments of the block. Return the letters that
    have a meaning in the block. Raises InputError for a cycle that lacks a value, or that controls read in
    different ways.
    """
    modes = path.modes
    bottom, plane = read_drilling_heights(path, values)
    initial, slow = modes.initial, modes.cycle in AT_FEED_UP
    for _ in range(read_drilling_repeats(path, values)):
        x, y, z = path.compute_target_position({key: values[key] for key in ("X", "Y") if key in values})
        if x is None or y is None:
            refuse_unknown(path, [x, y, z], "a hole is drilled at a place")
        path.move_to([x, y, z], cutting=False)
        path.move_to([x, y, plane], cutting=False)
        path.move_to([x, y, bottom], cutting=True)
        if slow:
            path.move_to([x, y, plane], cutting=True)
        up = initial if modes.back == "98" else plane
        path.move_to([x, y, up], cutting=False)
    return {"X", "Y", "Z", "R", "Q", "P", "L", "K"}


def read_drilling_heights(path: PathWriter, values: dict[str, float]) -> tuple[float, float]:
    """Return the z in mm of the hole's bottom and of the
    plane R; values that a block does not give stay in force.

    Raises InputError for a cycle where one of them is missing, or where start, R and bottom are not in this
    order downward.
    """
    modes, sticky = path.modes, path.modes.sticky
    if modes.plane != "17":
        raise InputError(f"a drill cycle stands in the plane G{modes.plane}: write G17 before it.")
    initial, now = modes.initial, modes.place[2]
    if initial is None or now is None:
        refuse_unknown(path, [0.0, 0.0, None], "a drill cycle begins at a height")
    if modes.distance == "91":
        if now != initial:
            raise InputError(
                "a drill cycle in increments (G91) goes on at the plane R (G99), which controls read in "
                "different ways: write it after G90."
            )
        if "R" in values:
            sticky["R"] = initial + path.convert_to_mm(values["R"])
        if "Z" in values and "R" in sticky:
            sticky["Z"] = sticky["R"] + path.convert_to_mm(values["Z"])
    else:
        sticky.update({key: path.convert_to_mm(values[key]) for key in "RZ" if key in values})
    for key, what in (("R", "the plane to which it returns"), ("Z", "the bottom of its hole")):
        if key not in sticky:
            raise InputError(f"a drill cycle has no {key}, {what}: write it.")
    if "Q" in values:
        sticky["Q"] = values["Q"]
    if modes.cycle in PECKING and sticky.get("Q", 0.0) < 0.0:
        raise InputError(f"Q of G{modes.cycle}, the depth of a peck, is below 0: write one above 0.")
    if modes.cycle in PECKING and not sticky.get("Q", 0.0):
        path.unpecked.append(path.line)
    bottom, plane = round(sticky["Z"], DIGITS), round(sticky["R"], DIGITS)
    if bottom > plane:
        raise InputError("the bottom Z of a hole is above the plane R of its cycle: correct them.")
    if now < plane:
        raise InputError(
            "a drill cycle begins below its plane R, where controls go different ways: write G0 with a Z "
            "above R before it."
        )
    return bottom, plane


def read_drilling_repeats(path: PathWriter, values: dict[str, float]) -> int:
    """Return how often a block drills: L, or K on other controls; 1 without them.

    Raises InputError for both together and for wrong numbers.
    """
    given = [values[key] for key in "LK" if key in values]
    if len(given) > 1:
        raise InputError("a drill cycle has both L and K: write one of them.")
    count = given[0] if given else 1.0
    if count != int(count) or not 1 <= count <= MOST_REPEATS:
        raise InputError(f"a drill cycle is repeated {count:g} times: write a whole number from 1.")
    return int(count)
