"""Fixtures that a list holds twice (model: "When two fixtures are the same").

Two fixtures with the same holes, up to lattice steps, names of pegs and the half turn that swaps the jaws, and with the same
place of the workpiece among them are one, whatever faces are named: the pose says what is touched.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, pi, radians, sin, tau
from typing import Any

from attrs import field, frozen

from workhold.model.fixture import Fixture
from workhold.verification.rules import SAME

__all__ = ["Seen"]

Key = tuple[Any, ...]
Place = tuple[float, float, float, float]


def patterns(fixture: Fixture) -> Iterator[tuple[Key, Place]]:
    """Each pattern of holes that names a fixture, with orientation and place of the workpiece and opening of the jaws.

    There are two only when a half turn of the vise leaves the pattern as it is.
    """
    named = [pattern(fixture, sign) for sign in (1, -1)]
    least = min(key for key, _ in named)
    return ((key, place) for key, place in named if key == least)


def pattern(fixture: Fixture, sign: int) -> tuple[Key, Place]:
    """The pattern of holes as it is (sign 1) or after a half turn of the vise (-1); by motions of its own, not ``Pose``."""
    near = "left" if sign > 0 else "right"
    lowest = min(sign * peg.row for peg in fixture.pegs)
    key, anchors = [], []
    for ours in (True, False):
        pegs = [peg for peg in fixture.pegs if (peg.jaw == near) == ours]
        first = min(sign * peg.column for peg in pegs)
        places = sorted((sign * peg.column - first, sign * peg.row - lowest, k) for k, peg in enumerate(pegs))
        key.append(tuple((column, row) for column, row, _ in places))
        anchors.append(pegs[places[0][2]])
    theta = radians(fixture.pose.theta_deg)
    x, y = anchors[0].x - fixture.pose.x, anchors[0].y - fixture.pose.y
    in_part = cos(theta) * x + sin(theta) * y, cos(theta) * y - sin(theta) * x
    return tuple(key), (theta + (pi if sign < 0 else 0.0), *in_part, sign * (anchors[1].x - anchors[0].x))


@frozen(eq=False)
class Seen:
    """The fixtures of a list looked at so far."""

    known: dict[Key, list[tuple[int, Place]]] = field(factory=dict, init=False)

    def add(self, index: int, fixture: Fixture) -> int | None:
        """Take in a fixture with pegs on both jaws; return the index of an earlier one that is the same, if any."""
        first = None
        for key, place in patterns(fixture):
            known = self.known.setdefault(key, [])
            if first is None:
                first = next((k for k, other in known if k != index and same(place, other)), None)
            known.append((index, place))
        return first


def same(a: Place, b: Place) -> bool:
    """Whether two places of the workpiece agree."""
    turn = (a[0] - b[0] + pi) % tau - pi
    return abs(turn) <= SAME and all(abs(p - q) <= SAME for p, q in zip(a[1:], b[1:], strict=True))
