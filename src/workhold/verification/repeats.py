"""Fixtures that a list holds twice (model: "When two fixtures are the same").

Two fixtures with the same pattern of holes (``hardware``), up to lattice steps, names of pegs and the half turn that leaves
the toolkit as it is, and with the same place of the workpiece among them are one, whatever faces are named: the pose says
what is touched.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, pi, sin, tau

from attrs import field, frozen

from workhold.model.fixture import Fixture
from workhold.verification.hardware import Hardware, Key, Place
from workhold.verification.rules import SAME
from workhold.verification.turning import Turning

__all__ = ["Seen"]

# The symmetry of a drawing is told to a millionth of a millimetre, too.
TURNED = 4 * SAME


@frozen(eq=False)
class Seen:
    """The fixtures of a list looked at so far.

    Parameters
    ----------
    hardware : what they stand on.
    rotations : angles in radians of the rotations of the workpiece onto itself, the identity left out.
    center : the point in mm that they keep.
    sets : of each type, how many sets the fixtures form when those that a rotation carries into each other count once.
    """

    hardware: Hardware
    rotations: Sequence[float] = ()
    center: tuple[float, float] = (0.0, 0.0)
    sets: dict[str, int] = field(factory=dict, init=False)
    known: dict[Key, list[tuple[int, Place]]] = field(factory=dict, init=False)

    @classmethod
    def of(cls, turning: Turning, hardware: Hardware) -> Seen:
        """Nothing seen yet of fixtures of a workpiece that is carried onto itself in these ways."""
        return cls(hardware, turning.angles, turning.center)

    def add(self, index: int, fixture: Fixture) -> int | None:
        """Take in a fixture that is not refuted; return the index of an earlier one that is the same, if any."""
        first, alone = self.find(fixture), True
        for key, place in self.hardware.patterns(fixture):
            known = self.known.setdefault(key, [])
            images = [self.turned(place, angle) for angle in self.rotations]
            alone &= not any(same(a, b, TURNED) for a in images for k, b in known if k != index)
            known.append((index, place))
        if first is None and alone:
            self.sets[fixture.type] = self.sets.get(fixture.type, 0) + 1
        return first

    def find(self, fixture: Fixture) -> int | None:
        """The index of a fixture taken in that is the same, if any."""
        named = ((place, self.known.get(key, ())) for key, place in self.hardware.patterns(fixture))
        return next((k for place, known in named for k, other in known if same(place, other)), None)

    def turned(self, place: Place, angle: float) -> Place:
        """The place of a workpiece that lies the same way after it is turned about its own centre."""
        x, y = place[1] - self.center[0], place[2] - self.center[1]
        turned_x, turned_y = cos(angle) * x - sin(angle) * y, sin(angle) * x + cos(angle) * y
        return place[0] - angle, self.center[0] + turned_x, self.center[1] + turned_y, *place[3:]


def same(a: Place, b: Place, most: float = SAME) -> bool:
    """Whether two places of the workpiece agree."""
    turn = (a[0] - b[0] + pi) % tau - pi
    return abs(turn) <= most and all(abs(p - q) <= most for p, q in zip(a[1:], b[1:], strict=True))
