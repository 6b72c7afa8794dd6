"""The usual order, derived independently: effective location errors, the least of them, and the steps above
it.

The rules are those of docs/quality.md, "Which comes first". The last digit of a number in a file may be
wrong, and a contact, an angle or an edge of the part may lie at the limit of a rule. Then both sides are
right, so factors, errors and steps are ranges here. The search's code for ordering fixtures is not used, and
places are computed from the vertices of the outline.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from math import atan2, cos, floor, hypot, inf, pi, radians, sin, tau

from attrs import frozen

from workhold.fixels.carrier import Carrier
from workhold.fixels.contacts import CLAMP_TIP
from workhold.geometry.segment import Line
from workhold.model.fixture import Fixture, Peg
from workhold.model.query import Query
from workhold.verification.tolerances import (
    AGREEMENT,
    ASLANT,
    AT_AN_END,
    CLAMP_IN_HOLE,
    DOWEL_IN_HOLE,
    HANGING,
    STEP,
    TURNED,
    WRITTEN_ANGLE,
)

__all__ = ["EffectiveJudge", "classify_angle"]

# What a number is at least and at most.
Range = tuple[float, float]
# Files have twelve digits, and an error is rounded to nine decimals.
DIGITS, BILLION, HALF = 2e-12, 1e9, 1e-3
# A greater effective error in billionths of a mm than any fixture has.
MOST_ERROR = 4 * 10**17


@frozen(eq=False)
class EffectiveJudge:
    """Effective location errors of the fixtures of a query, and steps above the least one.

    Parameters
    ----------
    query : the query.
    least : least effective error in mm among all fixtures found, as the file states it; None if it does not.
    """

    query: Query
    least: float | None

    def compute_effective_error(self, fixture: Fixture) -> tuple[int, int]:
        """Return (least, greatest) possible effective error in whole billionths of a mm.

        It is the written location error times the factor of each rule that applies. If the fixture states no
        location error, it may have any value up to ``MOST_ERROR``.
        """
        written = fixture.quality.get("location_error")
        if written is None:
            return 0, MOST_ERROR
        low, high = written * (1 - DIGITS), written * (1 + DIGITS)
        for times, (surely, perhaps) in self.list_factors(fixture):
            low, high = low * (times if surely else 1.0), high * (times if perhaps else 1.0)
        return floor(low * BILLION + 0.5 - HALF), floor(high * BILLION + 0.5 + HALF)

    def count_error_steps(self, fixture: Fixture) -> Range:
        """Return (least, greatest) number of steps of a factor 1.1 by which the effective error exceeds
        ``self.least``.
        """
        least = round((self.least or 0.0) * BILLION)
        low, high = (count_steps_above(end, least) for end in self.compute_effective_error(fixture))
        return low, high

    def list_factors(self, fixture: Fixture) -> Iterator[tuple[float, tuple[bool, bool]]]:
        """Yield (factor, (certainly, perhaps)) for each rule that can multiply a fixture's location error.

        The two booleans say whether the rule certainly holds, and whether it may hold.
        """
        low, high = classify_angle(fixture.pose.theta_deg)
        yield TURNED, (low == high == 1, 1 in (low, high))
        yield ASLANT, (low == high == 2, high == 2)
        yield AT_AN_END, self.touches_an_end(fixture)
        pegs = [(self.find_carrier(peg).contact is CLAMP_TIP, self.is_inside(peg)) for peg in fixture.pegs]
        for times, wanted in ((CLAMP_IN_HOLE, True), (DOWEL_IN_HOLE, False)):
            holds = any(inside for is_clamp, inside in pegs if is_clamp == wanted)
            yield times, (holds, holds)
        yield HANGING, self.hangs_over(fixture)

    def find_carrier(self, peg: Peg) -> Carrier:
        """Return the carrier of the query's toolkit on which a peg stands."""
        return self.query.toolkit.find_carrier(peg.carrier)

    @cached_property
    def holes(self) -> frozenset[int]:
        """The numbers of the faces of the part's holes.

        Empty if jaws clamp outward, or if no other faces may be touched.
        """
        part = self.query.workpiece.numbered
        outside = {face.number for face in part.faces if face.number not in part.inside}
        left = outside - set(self.query.restrictions.avoid) - self.query.workpiece.untouchable
        opens = self.query.toolkit.clamping < 0
        return frozenset() if opens or not left else part.inside

    def is_inside(self, peg: Peg) -> bool:
        """Return whether a peg stands in a hole of the part although other faces
        could have been used (see ``holes``).
        """
        return peg.face in self.holes and self.find_carrier(peg).contact.is_placed

    def touches_an_end(self, fixture: Fixture) -> tuple[bool, bool]:
        """Return (certainly, perhaps): whether any peg's centre is nearer than the peg's radius to an end of
        a straight face.
        """
        faces = {face.number: face.segment for face in self.query.workpiece.numbered.faces}
        surely = perhaps = False
        for peg in fixture.pegs:
            one, side = self.find_carrier(peg), faces.get(peg.face)
            if not (one.contact.is_placed and isinstance(side, Line)):
                continue
            x, y = map_to_part(fixture, peg.x, peg.y)
            (ax, ay), (bx, by) = side.start, side.end
            long = hypot(bx - ax, by - ay)
            away = ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / long
            short = one.peg_radius - min(away, long - away)
            surely, perhaps = surely or short > AGREEMENT, perhaps or short > -AGREEMENT
        return surely, perhaps

    def hangs_over(self, fixture: Fixture) -> tuple[bool, bool]:
        """Return (certainly, perhaps): whether the part overhangs the plates at every shift of the fixture by
        whole holes.
        """
        surely = perhaps = False
        for axis in (0, 1):
            one, other = (self.is_over(fixture, axis, spare) for spare in (2 * AGREEMENT, 0.0))
            surely, perhaps = surely or one, perhaps or other
        return surely, perhaps

    def is_over(self, fixture: Fixture, axis: int, spare: float) -> bool:
        """Return whether the part reaches more than ``spare`` mm beyond the plates along an axis (0 for x, 1
        for y).

        True only if this holds for every shift by whole holes that keeps the pegs on their plates. False if a
        plate is endless along the axis.
        """
        toolkit, plates = self.query.toolkit, self.query.toolkit.plates
        counts = [(plate.columns, plate.rows)[axis] for plate in plates]
        if None in counts:
            return False
        pitch, travel = plates[0].pitch[axis], fixture.travel
        first = [plate.compute_hole_center(0, 0, travel)[axis] for plate in plates]
        low = min(first) - pitch / 2
        high = max(at + ((count or 0) - 0.5) * pitch for at, count in zip(first, counts, strict=True))
        least, most = self.compute_extent(fixture, axis)
        has_wall = any(one.is_wall for one in toolkit.carriers)
        shifts = [0]
        is_moved = any(one.travel is not None and one.is_along_x == (axis == 0) for one in plates)
        if not is_moved and not (axis == 1 and has_wall):
            pegs = [peg for peg in fixture.pegs if self.find_carrier(peg).counted_axes[axis]]
            used = [(peg.column, peg.row)[axis] for peg in pegs]
            stood_on = [toolkit.find_carrier(self.find_carrier(peg).stands_on) for peg in pegs]
            ends = [(plate.columns, plate.rows)[axis] or 0 for plate in stood_on]
            room = min(end - 1 - hole for end, hole in zip(ends, used, strict=True))
            shifts = list(range(-min(used), room + 1))
        below = -inf if axis == 1 and has_wall else low - spare
        return not any(least + k * pitch >= below and most + k * pitch <= high + spare for k in shifts)

    def compute_extent(self, fixture: Fixture, axis: int) -> Range:
        """Return the least and greatest x (axis 0) or y (axis 1) of the clamped
        part in the toolkit's frame, in mm.
        """
        part, turn = self.query.workpiece, radians(fixture.pose.theta_deg)
        values = list[float]()
        for loop in part.loops[: part.pieces]:
            corners = loop.tolist()
            for (x, y, bulge), (u, v, _) in zip(corners, [*corners[1:], corners[0]], strict=True):
                a, b = place_point(fixture, turn, x, y), place_point(fixture, turn, u, v)
                values.append(a[axis])
                if bulge > 0:
                    values += find_arc_extremes(a, b, bulge, axis)
        return min(values), max(values)


def find_arc_extremes(
    a: tuple[float, float], b: tuple[float, float], bulge: float, axis: int
) -> Iterator[float]:
    """Yield the least or greatest x (``axis`` 0) or y (``axis`` 1) that a convex arc from a to b reaches
    between its ends.

    Yields 0 to 2 numbers. ``bulge`` is positive: the tangent of a quarter of the arc's angle.
    """
    chord = hypot(b[0] - a[0], b[1] - a[1])
    radius = chord * (1 + bulge * bulge) / (4 * bulge)
    # From the middle of the chord to the centre, on the left of the way.
    away = chord * (1 - bulge * bulge) / (4 * bulge)
    x = (a[0] + b[0]) / 2 - away * (b[1] - a[1]) / chord
    y = (a[1] + b[1]) / 2 + away * (b[0] - a[0]) / chord
    start, end = atan2(a[1] - y, a[0] - x), atan2(b[1] - y, b[0] - x)
    for sign in (1, -1):
        direction = (0.0 if axis == 0 else pi / 2) + (pi if sign < 0 else 0.0)
        if (direction - start) % tau <= (end - start) % tau:
            yield (x, y)[axis] + sign * radius


def place_point(fixture: Fixture, turn: float, x: float, y: float) -> tuple[float, float]:
    """Return a point of the part's frame in the toolkit's frame, in mm;
    ``turn`` is the pose's angle in radians.
    """
    return (
        fixture.pose.x + cos(turn) * x - sin(turn) * y,
        fixture.pose.y + sin(turn) * x + cos(turn) * y,
    )


def map_to_part(fixture: Fixture, x: float, y: float) -> tuple[float, float]:
    """Return a point of the toolkit's frame in the part's frame, in mm."""
    turn, x, y = radians(fixture.pose.theta_deg), x - fixture.pose.x, y - fixture.pose.y
    return cos(turn) * x + sin(turn) * y, cos(turn) * y - sin(turn) * x


def classify_angle(degrees: float) -> tuple[int, int]:
    """Return (least, greatest) class of an angle: 0 at 0 degrees, 1 at 90, 180 and 270 degrees, 2 elsewhere.

    Both are equal unless the angle is within a rounding of the edge between classes.
    """
    nearest = round(degrees / 90.0)
    off, square = abs(degrees - 90.0 * nearest), 0 if nearest % 4 == 0 else 1
    if off > 2 * WRITTEN_ANGLE:
        return 2, 2
    return square, 2 if off > WRITTEN_ANGLE / 2 else square


def count_steps_above(error: int, least: int) -> int:
    """Return the largest whole j >= 0 with ``error`` >= 1.1^j · max(``least``, 1), or 0 if there is none.

    ``error`` and ``least`` are in billionths of a mm.
    """
    up, down = STEP
    steps, left, right = 0, error * down, max(least, 1) * up
    while left >= right:
        steps, left, right = steps + 1, left * down, right * up
    return steps
