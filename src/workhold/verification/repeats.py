"""Fixtures of a list whose pegs form the same pattern: listed twice, or missing among the seats of each
other.

Two fixtures are the same (model: "When two fixtures are the same") if the workpiece has the same place among
the same pattern of holes. Lattice steps, names of pegs and a half turn that maps the toolkit onto itself make
no difference. Nor do the numbers of faces, because the pose determines the contacts.

Which rotations carry a workpiece onto itself is derived from the marks of its faces (middle, ends and radius)
alone. They keep the mean of the faces' middles. A rotation of order n carries the faces that are not centred
on this point in cycles of n, so n divides their number. Each such divisor is tried, the largest first. A
drawing symmetric to within ``SAME`` counts as symmetric. If it misses the symmetry by only slightly more, the
question is left open.

Glossary
--------
pattern : the holes of a fixture in a form that is equal for equal fixtures, with the place of the workpiece.
stance : the relative places of the pegs of a fixture. Fixtures of one stance use the same pegs, and each is
    among the seats of the others.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import cos, pi, radians, sin, tau
from typing import Any

import numpy as np
from attrs import field, frozen
from numpy.typing import NDArray

from workhold.fixels.contacts import WALL_END
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Point, Segment
from workhold.model.fixture import Fixture, Peg
from workhold.model.query import Query
from workhold.model.workpiece import Workpiece
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.rules.travel import (
    OPPOSITE,
    WAYS,
    find_clamp_line,
    find_direction,
    is_along_x,
    list_directions,
)
from workhold.verification.tolerances import SAME

__all__ = ["Key", "KnownFixtures", "PartRotations", "Place", "find_pattern_faults", "describe_stance"]

Key = tuple[Any, ...]
# Orientation, place in the workpiece's frame of the first peg, and how far from it each other group of pegs
# that moves is.
Place = tuple[float, ...]

# By how many times SAME faces may miss their images where it is certain, and at most, that they are meant to
# meet them.
CERTAIN, PERHAPS = 0.25, 4.0


@frozen
class PartRotations:
    """The rotations that carry a workpiece onto itself.

    Parameters
    ----------
    order : the largest possible number of rotations, with the identity; 1 for concentric circles, which every
        turn keeps.
    center : the fixed point of the rotations, in mm.
    is_certain : whether ``order`` is certainly their number.
    """

    order: int
    center: Point
    is_certain: bool

    @classmethod
    def from_workpiece(cls, workpiece: Workpiece) -> PartRotations:
        """Return the rotations that carry every outline of a workpiece onto itself."""
        every = enumerate(workpiece.every_outline)
        marks = np.array(
            [[*list_face_marks(face.segment), number] for number, one in every for face in one.faces]
        )
        center = marks[:, 0].mean()
        marks[:, :3] -= center
        most = count_rotations(marks, PERHAPS * SAME)
        least = most if most == 1 else count_rotations(marks, CERTAIN * SAME)
        return cls(most, (float(center.real), float(center.imag)), least == most)

    @property
    def angles(self) -> list[float]:
        """The angles of the rotations in radians, without the identity."""
        return [tau * k / self.order for k in range(1, self.order)]


def list_face_marks(face: Segment) -> list[complex]:
    """Return [middle, start, end, radius] of a face as complex numbers.

    The radius is negative if the face is concave, and 0 if it is straight. A whole circle has its centre in
    place of the three points.
    """
    radius = face.sign * face.radius if isinstance(face, Arc) else 0.0
    points = (
        [face.center] * 3
        if isinstance(face, Arc) and face.is_full
        else [face.compute_point(0.0), face.start, face.end]
    )
    return [*(complex(*point) for point in points), complex(radius)]


def count_rotations(marks: NDArray[np.complex128], off: float) -> int:
    """Return the largest order n such that a turn by 1/n carries every mark onto another one, to within
    ``off`` mm.

    The marks (N, 5) are complex, turned about 0; their last column is the outline's number, which a turn does
    not change.
    """
    outer = marks[np.abs(marks[:, 0]) > off]
    orders = (n for n in range(len(outer), 1, -1) if len(outer) % n == 0)
    return next((n for n in orders if all(has_image(one, n, outer, off) for one in outer)), 1)


def has_image(one: NDArray[np.complex128], order: int, marks: NDArray[np.complex128], off: float) -> bool:
    """Return whether the turn by 1/``order`` carries a mark onto some row of ``marks`` (N, 5), to within
    ``off`` mm.

    ``one`` (5,) is the mark, with the outline's number last.
    """
    turned = one * np.array([*[np.exp(2j * pi / order)] * 3, 1.0, 1.0])
    return bool((np.abs(marks - turned).max(axis=1) <= off).any())


# The symmetry of a drawing is known to a millionth of a millimetre, too.
TURNED = 4 * SAME


@frozen(eq=False)
class KnownFixtures:
    """The fixtures of a list that were added so far.

    Parameters
    ----------
    hardware : the rules of their toolkit.
    rotations : angles in radians of the rotations of the workpiece onto itself, the identity left out.
    center : the fixed point of these rotations, in mm.
    sets : by type, the number of fixtures, where fixtures that a rotation carries into each other count once.
    known : by pattern, the (index, place) of each fixture added.
    """

    hardware: ToolkitRules
    rotations: Sequence[float] = ()
    center: tuple[float, float] = (0.0, 0.0)
    sets: dict[str, int] = field(factory=dict, init=False)
    known: dict[Key, list[tuple[int, Place]]] = field(factory=dict, init=False)

    @classmethod
    def make_empty(cls, turning: PartRotations, hardware: ToolkitRules) -> KnownFixtures:
        """Return a store without fixtures for a workpiece with these rotations."""
        return cls(hardware, turning.angles, turning.center)

    def add(self, index: int, fixture: Fixture) -> int | None:
        """Add a fixture that is not refuted; return the index of an earlier fixture that is the same, or
        None.

        ``sets`` grows by one for the fixture's type where the fixture is new and no rotation of an earlier
        one.
        """
        first, alone = self.find(fixture), True
        for key, place in list_patterns(fixture, self.hardware):
            known = self.known.setdefault(key, [])
            images = [self.turn_place(place, angle) for angle in self.rotations]
            alone &= not any(are_same_place(a, b, TURNED) for a in images for k, b in known if k != index)
            known.append((index, place))
        if first is None and alone:
            self.sets[fixture.type] = self.sets.get(fixture.type, 0) + 1
        return first

    def find(self, fixture: Fixture) -> int | None:
        """Return the index of an earlier added fixture that is the same, or None."""
        named = ((place, self.known.get(key, ())) for key, place in list_patterns(fixture, self.hardware))
        return next((k for place, known in named for k, other in known if are_same_place(place, other)), None)

    def turn_place(self, place: Place, angle: float) -> Place:
        """Return the place of the workpiece after it is turned in its own frame by
        ``angle`` radians about ``center``.
        """
        x, y = place[1] - self.center[0], place[2] - self.center[1]
        turned_x, turned_y = cos(angle) * x - sin(angle) * y, sin(angle) * x + cos(angle) * y
        return place[0] - angle, self.center[0] + turned_x, self.center[1] + turned_y, *place[3:]


def list_patterns(fixture: Fixture, hardware: ToolkitRules) -> Iterator[tuple[Key, Place]]:
    """Yield the (pattern, place) pairs of a fixture; fixtures that have a pair in common are the same.

    Yields two pairs if half a turn of the toolkit gives the same pattern, and none if the pegs are not those
    of a fixture.
    """
    there = {peg.carrier for peg in fixture.pegs}
    clamps = [find_direction(peg) for peg in fixture.pegs if find_direction(peg)]
    if tuple(clamps) != list_directions(fixture) or not there.issuperset(
        one.name for one in hardware.lattices
    ):
        return iter(())
    named = [make_pattern(fixture, hardware, sign) for sign in ((1, -1) if hardware.half_turns else (1,))]
    least = min(key for key, _ in named)
    return ((key, place) for key, place in named if key == least)


def make_pattern(fixture: Fixture, hardware: ToolkitRules, sign: int) -> tuple[Key, Place]:
    """Return (pattern, place of the workpiece): as listed for ``sign`` 1, after half a turn of the toolkit
    for -1.

    The half turn swaps two jaws. Columns count from the first peg of each carrier, rows from the lowest peg;
    beside a fixed wall the pattern also holds the lowest row. Clamps are given by direction and line; the
    line is left out if one listed pair represents all pairs of its seat.
    """
    groups = [[peg for peg in fixture.pegs if peg.carrier == one.name] for one in hardware.lattices][::sign]
    lowest = min(sign * peg.row for group in groups for peg in group)
    holes, anchors, firsts = [], list[Peg](), list[int]()
    for pegs in groups:
        firsts.append(min(sign * peg.column for peg in pegs))
        places = sorted(
            (sign * peg.column - firsts[-1], sign * peg.row - lowest, k) for k, peg in enumerate(pegs)
        )
        holes.append(tuple((column, row) for column, row, _ in places))
        anchors.append(pegs[places[0][2]])
    first, rest = anchors[0], anchors[1:]
    clamps = []
    for clamp in (peg for peg in fixture.pegs if find_direction(peg)):
        direction, along_x = find_direction(clamp), is_along_x(clamp)
        line = sign * find_clamp_line(clamp) - (lowest if along_x else firsts[0])
        ahead = sign * (clamp.x - first.x if along_x else clamp.y - first.y)
        clamps.append((list(WAYS).index(direction if sign > 0 else OPPOSITE[direction]), line, ahead))
    clamps.sort()
    alone = hardware.every or len(clamps) < 2
    lines = tuple((way, line) if alone else way for way, line, _ in clamps)
    above = lowest if hardware.keeps_rows else 0
    theta = radians(fixture.pose.theta_deg)
    x, y = first.x - fixture.pose.x, first.y - fixture.pose.y
    # By a motion of its own, not ``Pose``, which is checked.
    place = (
        theta + (pi if sign < 0 else 0.0),
        cos(theta) * x + sin(theta) * y,
        cos(theta) * y - sin(theta) * x,
    )
    apart = [
        sign * (value - of_first) for one in rest for value, of_first in ((one.x, first.x), (one.y, first.y))
    ]
    return (lines, tuple(holes), above), (*place, *apart, *(ahead for *_, ahead in clamps if alone))


def are_same_place(a: Place, b: Place, most: float = SAME) -> bool:
    """Return whether two places of the workpiece agree to ``most`` (radians for the turn, mm else)."""
    turn = (a[0] - b[0] + pi) % tau - pi
    return abs(turn) <= most and all(abs(p - q) <= most for p, q in zip(a[1:], b[1:], strict=True))


# Degrees and mm. A fixture is a stated seat whose pose and separation agree to this.
SAME_SEAT = 1e-5


def find_pattern_faults(fixtures: Sequence[Fixture], query: Query) -> Iterator[str]:
    """Yield one sentence for the first fixture that is missing among the listed seats of another fixture on
    equal pegs.

    Only fixtures with a stated seating have listed seats.
    """
    if not query.toolkit.closes_at_once:
        return
    seated = [fixture for fixture in fixtures[: query.seating or 0] if fixture.seating is not None]
    if seated and not all(map(ToolkitRules(query.toolkit).has_carriers, fixtures)):
        # What stands on something else is refuted, and its pegs stand as nothing does.
        return
    stances = [describe_stance(fixture, query.toolkit) for fixture in (fixtures if seated else ())]
    patterns: dict[tuple[Any, ...], list[int]] = {stances[number].key: [] for number in range(len(seated))}
    for place, other in enumerate(stances):
        if (found := patterns.get(other.key)) is not None:
            found.append(place)
    for number, fixture in enumerate(seated):
        own = stances[number]
        for place in patterns[own.key]:
            other, pose = stances[place], fixtures[place].pose
            moved = {
                "theta_deg": pose.theta_deg,
                "x": pose.x - other.anchor[0] + own.anchor[0],
                "y": pose.y - other.anchor[1] + own.anchor[1],
            }
            apart = other.apart - own.apart
            if any(min(own.apart, other.apart) < there < max(own.apart, other.apart) for there in own.met):
                continue
            if not any(is_seat(seat, moved, apart) for seat in fixture.seating.fields["seats"]):
                yield (
                    f"fixture {place + 1} stands on the pegs of fixture {number + 1}, but is not among its "
                    "seats"
                )
                return


@frozen
class PegStance:
    """The relative places of the pegs of a fixture.

    Parameters
    ----------
    key : equal for fixtures whose pegs differ only by a shift and by the travel of the moving ones.
    anchor : place in mm of the first fixed peg; if only a wall is fixed, of the wall's point below the first
        peg.
    apart : distance in mm from the anchor to the first moving peg, along the direction in which the travel
        grows.
    met : the same distance for each fixed peg in the path of a clamp's tip.
    """

    key: tuple[Any, ...]
    anchor: tuple[float, float]
    apart: float
    met: tuple[float, ...]


def describe_stance(fixture: Fixture, toolkit: Toolkit) -> PegStance:
    """Return the relative places of the placed pegs of a fixture; some carrier of the toolkit must move."""
    by_place = sorted(fixture.placed, key=lambda peg: (peg.x, peg.y))
    still = [peg for peg in by_place if toolkit.find_carrier(peg.carrier).travel is None]
    moved = [peg for peg in by_place if peg not in still]
    tip = moved[0]
    first_x, first_y = (still[0].x, still[0].y) if still else (tip.x, 0.0)
    carrier = toolkit.find_carrier(tip.carrier)
    assert carrier.travel is not None
    ux, uy = carrier.travel.unit

    def measure_along(peg: Peg) -> float:
        """Return how far in mm a peg is from the anchor along the direction of travel."""
        return (peg.x - first_x) * ux + (peg.y - first_y) * uy

    def measure_across(peg: Peg) -> float:
        """Return how far in mm a peg is from the anchor, to the left of the direction of travel."""
        return (peg.y - first_y) * ux - (peg.x - first_x) * uy

    places = [(peg.x - first_x, peg.y - first_y) for peg in still]
    places += [(peg.x - tip.x, peg.y - tip.y) for peg in moved]
    numbers, met = [measure_across(tip), *(part for place in places for part in place)], list[float]()
    if carrier.on is not None:
        # A clamp's stroke is counted from its hole, and a wall stands where it is.
        x, y = carrier.compute_hole_center(tip.column, tip.row)
        numbers += [x - first_x, y - first_y] if carrier.measure == "stroke" else []
        numbers += [first_y] if WALL_END in toolkit.contacts else []
        reach = [carrier.peg_radius + toolkit.find_carrier(peg.carrier).peg_radius for peg in still]
        met = [
            measure_along(peg)
            for peg, near in zip(still, reach, strict=True)
            if abs(measure_across(peg) - measure_across(tip)) < near
        ]
    key = (fixture.direction, len(still), *(round(part, 5) + 0.0 for part in numbers))
    return PegStance(key, (first_x, first_y), measure_along(tip), tuple(met))


def is_seat(seat: Mapping[str, Any], pose: Mapping[str, float], difference: float) -> bool:
    """Return whether a seat has the kind "fixture", is not mirrored, and has this pose and this difference.

    Pose and difference agree to ``SAME_SEAT``.
    """
    turn = (seat["pose"]["theta_deg"] - pose["theta_deg"] + 180.0) % 360.0 - 180.0
    away = max(abs(seat["pose"][name] - pose[name]) for name in ("x", "y"))
    kind = seat["kind"] == "fixture" and not seat["mirrored"]
    return kind and max(abs(turn), away, abs(seat["difference"] - difference)) < SAME_SEAT
