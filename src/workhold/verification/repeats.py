"""Fixtures that a list holds twice (model: "When two fixtures are the same").

Two fixtures with the same pattern of holes, up to lattice steps, names of pegs and the half turn that leaves
the toolkit as it is, and with the same place of the workpiece among them are one, whatever faces are named:
the pose says what is touched.

Which rotations carry a workpiece onto itself is derived from the marks of its faces alone. The rotations of
order n carry the faces that are not about the kept point in cycles of n, so n divides their number; and the
mean of the faces' middles is that point. Each such part of a turn is tried, the smallest first. What a
drawing has to ``SAME`` is taken for symmetric, so of one that misses it by about as much it cannot be said.

Glossary
--------
pattern : the holes of a fixture in a form in which equal fixtures have equal ones, with the place of the
    workpiece.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import cos, pi, radians, sin, tau
from typing import Any

import numpy as np
from attrs import field, frozen
from numpy.typing import NDArray

from workhold.geometry.segment import Arc, Point, Segment
from workhold.model.fixture import Fixture, Peg
from workhold.model.workpiece import Workpiece
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.rules.stroke import OPPOSITE, WAYS, direction_of, directions_of, is_along_x, line_of
from workhold.verification.tolerances import SAME

__all__ = ["Key", "Place", "Seen", "Turning"]

Key = tuple[Any, ...]
# Orientation, place in the workpiece's frame of the first peg, and how far from it each other group of pegs
# that moves is.
Place = tuple[float, ...]

# By how many times SAME faces may miss their images where it is certain, and at most, that they are meant to
# meet them.
CERTAIN, PERHAPS = 0.25, 4.0


@frozen
class Turning:
    """The rotations of a workpiece onto itself.

    Parameters
    ----------
    order : how many there are at most with the identity; 1 for concentric circles, which turn at every angle.
    center : the point in mm that they keep.
    is_certain : whether there certainly are as many.
    """

    order: int
    center: Point
    is_certain: bool

    @classmethod
    def of(cls, workpiece: Workpiece) -> Turning:
        """The rotations of a workpiece."""
        marks = np.array([marks_of(face.segment) for face in workpiece.faces])
        center = marks[:, 0].mean()
        marks[:, :3] -= center
        most = order_of(marks, PERHAPS * SAME)
        least = most if most == 1 else order_of(marks, CERTAIN * SAME)
        return cls(most, (float(center.real), float(center.imag)), least == most)

    @property
    def angles(self) -> list[float]:
        """In radians, the identity left out."""
        return [tau * k / self.order for k in range(1, self.order)]


def marks_of(face: Segment) -> list[complex]:
    """Middle, start and end of a face, or thrice a whole circle's centre; and its radius, negative in a hollow."""
    radius = face.sign * face.radius if isinstance(face, Arc) else 0.0
    points = [face.center] * 3 if isinstance(face, Arc) and face.is_full else [face.at(0.0), face.start, face.end]
    return [*(complex(*point) for point in points), complex(radius)]


def order_of(marks: NDArray[np.complex128], off: float) -> int:
    """The most rotations that carry each of the marks (N, 4) about 0 to within so many mm of others."""
    outer = marks[np.abs(marks[:, 0]) > off]
    orders = (n for n in range(len(outer), 1, -1) if len(outer) % n == 0)
    return next((n for n in orders if all(has_image(one, n, outer, off) for one in outer)), 1)


def has_image(one: NDArray[np.complex128], order: int, marks: NDArray[np.complex128], off: float) -> bool:
    """Whether one of the marks (N, 4) is where a part of a turn carries some (4,)."""
    turned = one * np.array([*[np.exp(2j * pi / order)] * 3, 1.0])
    return bool((np.abs(marks - turned).max(axis=1) <= off).any())


# The symmetry of a drawing is known to a millionth of a millimetre, too.
TURNED = 4 * SAME


@frozen(eq=False)
class Seen:
    """The fixtures of a list looked at so far.

    Parameters
    ----------
    hardware : what they stand on.
    rotations : angles in radians of the rotations of the workpiece onto itself, the identity left out.
    center : the point in mm that they keep.
    sets : of each type, how many sets the fixtures form when those that a rotation carries into each other
        count once.
    """

    hardware: ToolkitRules
    rotations: Sequence[float] = ()
    center: tuple[float, float] = (0.0, 0.0)
    sets: dict[str, int] = field(factory=dict, init=False)
    known: dict[Key, list[tuple[int, Place]]] = field(factory=dict, init=False)

    @classmethod
    def of(cls, turning: Turning, hardware: ToolkitRules) -> Seen:
        """Nothing seen yet of fixtures of a workpiece that is carried onto itself in these ways."""
        return cls(hardware, turning.angles, turning.center)

    def add(self, index: int, fixture: Fixture) -> int | None:
        """Take in a fixture that is not refuted; return the index of an earlier one that is the same."""
        first, alone = self.find(fixture), True
        for key, place in patterns(fixture, self.hardware):
            known = self.known.setdefault(key, [])
            images = [self.turned(place, angle) for angle in self.rotations]
            alone &= not any(same(a, b, TURNED) for a in images for k, b in known if k != index)
            known.append((index, place))
        if first is None and alone:
            self.sets[fixture.type] = self.sets.get(fixture.type, 0) + 1
        return first

    def find(self, fixture: Fixture) -> int | None:
        """The index of a fixture taken in that is the same, if any."""
        named = ((place, self.known.get(key, ())) for key, place in patterns(fixture, self.hardware))
        return next((k for place, known in named for k, other in known if same(place, other)), None)

    def turned(self, place: Place, angle: float) -> Place:
        """The place of a workpiece that lies the same way after it is turned about its own centre."""
        x, y = place[1] - self.center[0], place[2] - self.center[1]
        turned_x, turned_y = cos(angle) * x - sin(angle) * y, sin(angle) * x + cos(angle) * y
        return place[0] - angle, self.center[0] + turned_x, self.center[1] + turned_y, *place[3:]


def patterns(fixture: Fixture, hardware: ToolkitRules) -> Iterator[tuple[Key, Place]]:
    """Each pattern that names a fixture.

    There are two where a half turn of the toolkit leaves the holes as they are, and none where the pegs are
    not those of a fixture.
    """
    there = {peg.carrier for peg in fixture.pegs}
    clamps = [direction_of(peg) for peg in fixture.pegs if direction_of(peg)]
    if tuple(clamps) != directions_of(fixture) or not there.issuperset(one.name for one in hardware.lattices):
        return iter(())
    # With a wall nothing is the same after a turn.
    named = [pattern(fixture, hardware, sign) for sign in ((1, -1) if hardware.wall is None else (1,))]
    least = min(key for key, _ in named)
    return ((key, place) for key, place in named if key == least)


def pattern(fixture: Fixture, hardware: ToolkitRules, sign: int) -> tuple[Key, Place]:
    """The pattern as it is (sign 1) or after half a turn of the toolkit (-1), which swaps two jaws.

    Columns count from the first of each carrier, rows from the lowest; beside a wall that and what stands
    still keep theirs. Clamps are their directions and lines, of which the lines do not count where one pair
    stands for all of its seat.
    """
    groups = [[peg for peg in fixture.pegs if peg.carrier == one.name] for one in hardware.lattices][::sign]
    lowest = min(sign * peg.row for group in groups for peg in group)
    holes, anchors, firsts = [], list[Peg](), list[int]()
    for pegs in groups:
        firsts.append(min(sign * peg.column for peg in pegs))
        places = sorted((sign * peg.column - firsts[-1], sign * peg.row - lowest, k) for k, peg in enumerate(pegs))
        holes.append(tuple((column, row) for column, row, _ in places))
        anchors.append(pegs[places[0][2]])
    first, rest = anchors[0], anchors[1:]
    clamps = []
    for clamp in (peg for peg in fixture.pegs if direction_of(peg)):
        direction, along_x = direction_of(clamp), is_along_x(clamp)
        line = sign * line_of(clamp) - (lowest if along_x else firsts[0])
        ahead = sign * (clamp.x - first.x if along_x else clamp.y - first.y)
        clamps.append((list(WAYS).index(direction if sign > 0 else OPPOSITE[direction]), line, ahead))
    clamps.sort()
    alone = hardware.every or len(clamps) < 2
    lines = tuple((way, line) if alone else way for way, line, _ in clamps)
    above = lowest if hardware.wall is not None and hardware.lattices[0].travel is None else 0
    theta = radians(fixture.pose.theta_deg)
    x, y = first.x - fixture.pose.x, first.y - fixture.pose.y
    # By a motion of its own, not ``Pose``, which is checked.
    place = theta + (pi if sign < 0 else 0.0), cos(theta) * x + sin(theta) * y, cos(theta) * y - sin(theta) * x
    apart = [sign * (value - of_first) for one in rest for value, of_first in ((one.x, first.x), (one.y, first.y))]
    return (lines, tuple(holes), above), (*place, *apart, *(ahead for *_, ahead in clamps if alone))


def same(a: Place, b: Place, most: float = SAME) -> bool:
    """Whether two places of the workpiece agree."""
    turn = (a[0] - b[0] + pi) % tau - pi
    return abs(turn) <= most and all(abs(p - q) <= most for p, q in zip(a[1:], b[1:], strict=True))
