"""The jaw force that loads ask for, of a part held between two flat jaws by friction.

Both jaws press with affine pressures (``statics.patches``). In each cell of a patch friction acts in any direction of
the plane, at most the coefficient times the pressure at the cell's centre times its area; the circle of directions is
a polygon of 16 sides inside it. Parallels push upward and the work stop along the jaws, without friction. A load is
held at a jaw force F if such forces balance it where the jaw that moves presses with F. For given pressures every
friction that balances is a safe one: the lower bound theorem of limit analysis.

The least F is a linear program with six equations of balance, and its dual asks for a motion of the part. F is convex
in the load, so that of a range of loads those at its corners are the worst.

Reference: D. C. Drucker, W. Prager, H. J. Greenberg, *Extended limit design theorems for continuous media*, Quarterly of
Applied Mathematics 9 (1952).
"""

from __future__ import annotations

from functools import cached_property
from math import cos, pi, radians, sin
from typing import TYPE_CHECKING, Protocol

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.errors import WorkholdError
from workhold.geometry.segment import Point
from workhold.model.jaw_hold import Patch
from workhold.model.requirements import Load
from workhold.statics.linear_program import LinearProgram
from workhold.statics.patches import PressedPatch, hulls_meet

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "BROKEN",
    "DIRECTIONS",
    "Grip",
    "HeldByFriction",
    "MotionProgram",
    "corners_of_load",
    "directed",
    "is_pressed_all_over",
    "find_least_peak_pressure",
]

Array = NDArray[np.float64]
# Directions of friction in a cell; one of them is upward.
DIRECTIONS = 16
# How far in mm, of the two kerns, may miss each other by rounding.
KERN_SLACK = 1e-7
# A motion is no larger than this per unit of load; a load that drives it so far is held by no jaw force.
FARTHEST = 1e7
# How much more work, of all that is done, breaks a condition, and how often conditions are added for a load.
BROKEN, MOST_TURNS = 1e-9, 1000
# Parts of the largest force and moment of a load below which they are rounding, and below which a share of a
# condition is.
NEGLIGIBLE, NEGLIGIBLE_SHARE = 1e-12, 1e-9
# Digits in N after the point by which loads are told apart.
SAME_DIGITS = 6
# Six conditions that are nearly one less determine no motion.
MOST_CONDITION = 1e9


@frozen(eq=False)
class Grip:
    """A part between two flat jaws, ready for the linear programs of its loads.

    Parameters
    ----------
    fixed, moving : what each jaw touches.
    opening : S in mm.
    friction : the coefficient between jaws and part.
    stop_points : (K, 3) in mm, where the work stop may push; empty without one.
    stop_way : 1 where it pushes along x, -1 where against it.
    """

    fixed: PressedPatch
    moving: PressedPatch
    opening: float
    friction: float
    stop_points: Array
    stop_way: float = 1.0

    @classmethod
    def of(
        cls,
        fixed: Patch,
        moving: Patch,
        opening: float,
        friction: float,
        stop_points: Sequence[tuple[float, float, float]] = (),
        stop_way: float = 1.0,
    ) -> Grip:
        points = np.array(stop_points, np.float64).reshape(-1, 3)
        return cls(PressedPatch(fixed), PressedPatch(moving), opening, friction, points, stop_way)

    @cached_property
    def centre(self) -> Array:
        """What moments are taken about, in mm."""
        ends = np.array([self.fixed.patch.ends, self.moving.patch.ends])
        tops = [one[3] for patch in (self.fixed, self.moving) for one in patch.rectangles]
        return np.array([ends.mean(), self.opening / 2, max(tops) / 2])

    @cached_property
    def length(self) -> float:
        """What moments are divided by, in mm."""
        ends = np.array([self.fixed.patch.ends, self.moving.patch.ends])
        return float(max(self.opening, np.ptp(ends), 1.0) / 2)

    def wrenches(self, points: Array, forces: Array) -> Array:
        """Wrenches (N, 6) of forces (N, 3) at points (N, 3) in mm, moments over the length."""
        arms = points - self.centre
        return np.hstack([forces, np.cross(arms, forces) / self.length])

    @cached_property
    def pressing(self) -> Array:
        """Wrenches (R, 6) of the edges of pressure, those of the fixed jaw first."""
        rows = []
        for patch, y, way in ((self.fixed, 0.0, 1.0), (self.moving, self.opening, -1.0)):
            points = np.column_stack([patch.centres[:, 0], np.full(len(patch.edges), y), patch.centres[:, 1]])
            rows.append(self.wrenches(points, np.tile([0.0, way, 0.0], (len(points), 1))))
        return np.vstack(rows)

    @cached_property
    def pushing(self) -> Array:
        """Wrenches (K, 6) of unit forces of the parallels, then of the work stop."""
        points = [
            (x, y, 0.0)
            for patch, y in ((self.fixed, 0.0), (self.moving, self.opening))
            for x in patch.patch.ends
        ]
        upward = self.wrenches(np.array(points), np.tile([0.0, 0.0, 1.0], (len(points), 1)))
        ways = np.tile([self.stop_way, 0.0, 0.0], (len(self.stop_points), 1))
        return np.vstack([upward, self.wrenches(self.stop_points, ways)])

    @cached_property
    def rubbing(self) -> Array:
        """Wrenches (C, 16, 6) of unit forces of friction in the cells of both jaws, in each direction."""
        turns = 2 * pi / DIRECTIONS * np.arange(DIRECTIONS)
        ways = np.column_stack([np.sin(turns), np.zeros(DIRECTIONS), np.cos(turns)])
        rows = []
        for patch, y in ((self.fixed, 0.0), (self.moving, self.opening)):
            centre = patch.cells.centre
            points = np.column_stack([centre[:, 0], np.full(len(centre), y), centre[:, 1]])
            rows.append(self.wrenches(np.repeat(points, DIRECTIONS, axis=0), np.tile(ways, (len(points), 1))))
        return np.vstack(rows).reshape(-1, DIRECTIONS, 6)

    @cached_property
    def bearing(self) -> Array:
        """The friction (C, R) that each cell bears per unit of each edge of pressure."""
        own, other = (
            (self.friction * patch.pressure(patch.cells.centre) * patch.cells.area).T
            for patch in (self.fixed, self.moving)
        )
        count = len(own), len(other), own.shape[1], other.shape[1]
        out = np.zeros((count[0] + count[1], count[2] + count[3]))
        out[: count[0], : count[2]], out[count[0] :, count[2] :] = own, other
        return out

    @cached_property
    def most_work(self) -> Array:
        """(R,) The jaw force that a unit of each pressure stands for: 1 of the jaw that moves."""
        return np.repeat([0.0, 1.0], [len(self.fixed.edges), len(self.moving.edges)])

    def forces_needed(self, loads: Array) -> list[float | None]:
        """The least jaw force in N for each of some loads (N, 6) as :meth:`wrenches` has them.

        It is None for a load that no jaw force holds.
        """
        motions = MotionProgram(self)
        return [motions.least_force(load) for load in loads]


class HeldByFriction(Protocol):
    """A part that is held by pressures with friction, and by forces without.

    Parameters
    ----------
    pushing : wrenches (K, 6) of unit forces without friction.
    pressing : wrenches (R, 6) of pressures.
    rubbing : wrenches (C, D, 6) of unit forces of friction in each cell, in each direction.
    bearing : the friction (C, R) that each cell bears per unit of each pressure.
    most_work : (R,) the clamp force that a unit of each pressure stands for: 1 of what clamps, else 0.
    """

    @property
    def pushing(self) -> Array: ...
    @property
    def pressing(self) -> Array: ...
    @property
    def rubbing(self) -> Array: ...
    @property
    def bearing(self) -> Array: ...
    @property
    def most_work(self) -> Array: ...


@define(eq=False)
class MotionProgram:
    """The motions of the part that what holds it resists, and which of them a load drives hardest.

    By duality the least clamp force is the largest power of the load on a motion (6,) against which each pressure that
    does not clamp, with the friction that goes with it, does no work, those that clamp no more than 1 for a unit of
    force, and forces without friction none. Friction takes in each cell the direction that works most, so that each
    pressure stands for very many linear conditions. Those are added that the last motion breaks, until it breaks none;
    loads of one grip share them.

    Parameters
    ----------
    grip : of the part.
    conditions : (K, 6) forces of the program's rows.
    answered : jaw forces that suffice for loads, by their bytes.
    motions : (L, 6) that answered loads.
    inverses : (L, 6, 6) of the forces of the six conditions that each of them meets.
    """

    grip: HeldByFriction
    program: LinearProgram = field(init=False)
    conditions: Array = field(init=False)
    answered: dict[bytes, float] = field(factory=dict, init=False)
    motions: Array = field(factory=lambda: np.zeros((0, 6)), init=False)
    inverses: Array = field(factory=lambda: np.zeros((0, 6, 6)), init=False)

    def __attrs_post_init__(self) -> None:
        free = self.grip.pushing
        below = np.full(len(free), -np.inf)
        self.program = LinearProgram.of(free, np.zeros(6), below, np.zeros(len(free)), most=FARTHEST)
        self.conditions = free

    def least_force(self, load: Array, enough: float = -np.inf) -> float | None:
        """Return the least clamp force in N that balances a load (6,); None where none does.

        Where no more than ``enough`` is asked for, it may be more than the least, and at most that.
        """
        return self.driven_by(load, enough)[0]

    def driven_by(self, load: Array, enough: float = -np.inf) -> tuple[float | None, Array]:
        """Return the least clamp force in N that balances a load (6,), and the motion (6,) whose power it is.

        The force is None where none does; then the motion is one that no clamp force resists, but for a little. Where
        no more than ``enough`` is asked for, the force may be more than the least, and at most that.
        """
        size = float(np.abs(load).max())
        if size == 0.0:
            return 0.0, np.zeros(6)
        # Forces balance the load, so that it drives the part against the way they work.
        driven = -load / size
        driven[np.abs(driven) < NEGLIGIBLE] = 0.0
        for _ in range(MOST_TURNS):
            motion = self.program.with_costs(-driven)
            if motion is None:
                break
            if float(driven @ motion) * size <= enough:
                return max(float(driven @ motion), 0.0) * size, motion
            if not self.cut_off(motion):
                is_free = np.abs(motion).max() > 0.5 * FARTHEST
                return None if is_free else max(float(driven @ motion), 0.0) * size, motion
        raise WorkholdError(
            "the clamp force of a load was not found: report it with the part, the hardware and the load."
        )

    def most_known(self, loads: Array) -> float:
        """Return a jaw force in N that the hardest of some loads (N, 6) asks for at least."""
        return max(float((self.motions @ -loads.T).max(initial=0.0)), 0.0)

    def least_forces(self, loads: Array, most: float = np.inf) -> Array:
        """Return the least jaw force in N for each load (N, 6), infinite where none holds it.

        A motion that meets six conditions is the answer for every load that is a sum of these conditions' forces, so
        that one linear program answers all loads in that cone. Forces up to ``most`` may be more than the least. Once
        one is above, all that are not known are NaN.
        """
        keys = [load.tobytes() for load in loads.round(SAME_DIGITS)]
        # What only suffices must not stand for the least.
        out = np.array([self.answered.get(key, np.nan) if most < np.inf else np.nan for key in keys])
        driven = -loads
        left = np.flatnonzero(np.isnan(out))
        left = self.answer_in_cones(self.inverses, self.motions, driven, left, out)
        while len(left) and not (out > most).any():
            first = int(left[(driven[left] @ self.motions.T).max(axis=1, initial=0.0).argmax()])
            enough = most if most < np.inf else -np.inf
            need, count = self.least_force(loads[first], enough), len(self.motions)
            out[first], left = (np.inf if need is None else need), left[left != first]
            self.answered[keys[first]] = float(out[first])
            if need is not None and need > enough:
                self.remember_cone(loads[first])
                left = self.answer_in_cones(self.inverses[count:], self.motions[count:], driven, left, out)
        return out

    def remember_cone(self, load: Array) -> None:
        """Keep the motion that answered a load (6,) last, where the conditions that it meets determine it."""
        rows = self.program.bounding_rows() if load.any() else None
        if rows is None or np.linalg.cond(self.conditions[rows]) > MOST_CONDITION:
            return
        self.inverses = np.concatenate([self.inverses, np.linalg.inv(self.conditions[rows])[None]])
        self.motions = np.concatenate([self.motions, self.program.solution()[None]])

    @staticmethod
    def answer_in_cones(
        inverses: Array, motions: Array, driven: Array, left: NDArray[np.intp], out: Array
    ) -> NDArray[np.intp]:
        """Write the forces of those of some loads (N, 6), against which the part is driven, that lie in cones (K, 6, 6).

        Return the numbers of the others.
        """
        if not len(inverses) or not len(left):
            return left
        some = driven[left]
        least = np.matmul(some, inverses).min(axis=2)
        slack = -NEGLIGIBLE_SHARE * np.abs(some).max(axis=1)
        cone = least.argmax(axis=0)
        inside = least[cone, np.arange(len(some))] >= slack
        out[left[inside]] = np.maximum((some[inside] * motions[cone[inside]]).sum(axis=1), 0.0)
        return np.asarray(left[~inside])

    def cut_off(self, motion: Array) -> bool:
        """Adds the conditions that a motion (6,) breaks; whether there are any.

        Forces on the part push it back, so that work is done against the motion by what they do along it.
        """
        grip = self.grip
        along = grip.rubbing @ motion
        chosen = along.argmax(axis=1)
        rubbed = grip.rubbing[np.arange(len(chosen)), chosen]
        forces = grip.pressing + grip.bearing.T @ rubbed
        work = forces @ motion - grip.most_work
        broken = work > BROKEN * (1.0 + np.abs(forces * motion).sum(axis=1))
        if broken.any():
            self.program.add_rows(forces[broken], grip.most_work[broken])
            self.conditions = np.vstack([self.conditions, forces[broken]])
        return bool(broken.any())


def is_pressed_all_over(fixed: Patch, moving: Patch) -> bool:
    """Whether both jaws can press all over what they touch with equal resultants: their kerns meet."""
    one, other = PressedPatch(fixed), PressedPatch(moving)
    return hulls_meet(one.centres, other.centres, KERN_SLACK)


def find_least_peak_pressure(fixed: Patch, moving: Patch, force: float) -> float | None:
    """The least that the largest pressure in MPa can be at a jaw force in N without a load.

    It is None where a jaw touches along lines, whose pressure has no bound, and where the kerns do not meet.
    """
    if fixed.is_line or moving.is_line or not is_pressed_all_over(fixed, moving):
        return None
    patches = PressedPatch(fixed), PressedPatch(moving)
    own, other = patches
    counts, size = (
        (len(own.edges), len(other.edges)),
        max(float(one.largest_pressure().max()) for one in patches),
    )
    middle = own.integrals[0, 1:] / own.integrals[0, 0]
    arms = [one.centres - middle for one in patches]
    span = max(1.0, *(float(np.abs(one).max()) for one in arms))
    corners = [one.largest_pressure().T / size for one in patches]
    # Rows: the force of each jaw, the moments of both, and the pressure at each corner; the last column is the most.
    matrix = np.zeros((4 + sum(map(len, corners)), sum(counts) + 1))
    matrix[0, : counts[0]] = matrix[1, counts[0] : -1] = 1.0
    matrix[2:4, : counts[0]], matrix[2:4, counts[0] : -1] = arms[0].T / span, -arms[1].T / span
    matrix[4 : 4 + len(corners[0]), : counts[0]], matrix[4 + len(corners[0]) :, counts[0] : -1] = corners
    matrix[4:, -1] = -1.0
    # The kerns may miss each other by rounding.
    slack = np.array([0.0, 0.0, *[2 * KERN_SLACK / span] * 2])
    level = np.array([1.0, 1.0, 0.0, 0.0])
    below = np.full(len(matrix) - 4, -np.inf)
    lower, upper = (
        np.concatenate([level - slack, below]),
        np.concatenate([level + slack, np.zeros(len(below))]),
    )
    least = LinearProgram.of(matrix, np.eye(1, matrix.shape[1], matrix.shape[1] - 1)[0], lower, upper).least()
    return None if least is None else least * size * force


def directed(low: float, high: float, steps: int = 32) -> Array:
    """Unit vectors (N, 2), and a little longer ones, whose hull holds those of a range of directions in radians.

    One direction is itself. The corners of a range lie on tangents of the circle, at most 0.5 % outside it.
    """
    if high <= low:
        return np.array([[cos(low), sin(low)]])
    count = max(int(np.ceil((high - low) / (2 * pi / steps))), 1)
    step = (high - low) / count
    middles = low + (np.arange(count) + 0.5) * step
    corners = np.column_stack([np.cos(middles), np.sin(middles)]) / cos(step / 2)
    if high - low >= 2 * pi:
        return corners
    ends = np.array([[cos(low), sin(low)], [cos(high), sin(high)]])
    return np.vstack([ends, corners])


def corners_of_load(load: Load, theta: float, position: Point, height: float) -> tuple[Array, Array]:
    """Points (N, 3) in mm and forces (N, 3) in N, the worst of a load among them, of a part in a pose.

    Parameters
    ----------
    theta : the part's orientation in radians.
    position : of the part's origin, in mm.
    height : at which the load acts, in mm.
    """
    low, high = (radians(angle) + theta for angle in load.directions)
    ways = directed(low, high) if load.force else np.zeros((1, 2))
    points = np.array(load.points or ((0.0, 0.0),))
    c, s = cos(theta), sin(theta)
    x, y = c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]
    places = np.column_stack([x + position[0], y + position[1], np.full(len(points), height)])
    forces = np.column_stack([load.force * ways, np.full(len(ways), load.upward)])
    return np.repeat(places, len(ways), axis=0), np.tile(forces, (len(places), 1))
