"""The jaw force that loads require, for a part held between two flat jaws by friction.

Both jaws press with affine pressures (``statics.patches``). In each cell of a patch friction acts in any
direction of the plane. It is at most the coefficient of friction times the pressure at the cell's centre
times the cell's area; the circle of possible friction forces is replaced by an inscribed polygon with 16
corners. Parallels push upward and the work stop along the jaws, without friction. A jaw force F holds a load
if such forces balance it while the moving jaw presses with F. By the lower bound theorem of limit analysis
any balancing friction is safe for given pressures.

The least F is the value of a linear program with six equations of balance; the dual program seeks a motion of
the part. F is convex in the load, so the worst loads of a range are its corners.

Reference: D. C. Drucker, W. Prager, H. J. Greenberg, *Extended limit design theorems for continuous media*,
Quarterly of Applied Mathematics 9 (1952).
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
from workhold.model.jaw_hold import JawPatch
from workhold.model.requirements import Load
from workhold.statics.linear_program import LinearProgram
from workhold.statics.patches import PressedPatch, hulls_meet

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "BROKEN",
    "DIRECTIONS",
    "FrictionHold",
    "HeldByFriction",
    "MotionProgram",
    "list_load_corners",
    "enclose_directions",
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
class FrictionHold:
    """A part between two flat jaws, in the form for the linear programs of its loads.

    x runs along the jaws, y from the fixed to the moving jaw, z upward.

    Parameters
    ----------
    fixed, moving : patch that each jaw touches.
    opening : distance between the jaws, in mm.
    friction : the coefficient between jaws and part.
    stop_points : (K, 3) points in mm at which the work stop may push; empty without one.
    stop_way : 1 where the stop pushes toward +x, -1 toward -x.
    parallels : places y in mm of the two parallels under the part; None for one at each jaw.
    """

    fixed: PressedPatch
    moving: PressedPatch
    opening: float
    friction: float
    stop_points: Array
    stop_way: float = 1.0
    parallels: tuple[float, float] | None = None

    @classmethod
    def from_patches(
        cls,
        fixed: JawPatch,
        moving: JawPatch,
        opening: float,
        friction: float,
        stop_points: Sequence[tuple[float, float, float]] = (),
        stop_way: float = 1.0,
        parallels: tuple[float, float] | None = None,
    ) -> FrictionHold:
        """Return the hold by two patches; ``stop_points`` are points (x, y,
        z) in mm on the work stop, if there is one.

        ``parallels`` are the places y in mm of the parallels under the part; None for one at each jaw.
        """
        points = np.array(stop_points, np.float64).reshape(-1, 3)
        return cls(PressedPatch(fixed), PressedPatch(moving), opening, friction, points, stop_way, parallels)

    @cached_property
    def centre(self) -> Array:
        """Point (3,) in mm that moments are taken about."""
        ends = np.array([self.fixed.patch.ends, self.moving.patch.ends])
        tops = [one[3] for patch in (self.fixed, self.moving) for one in patch.rectangles]
        return np.array([ends.mean(), self.opening / 2, max(tops) / 2])

    @cached_property
    def length(self) -> float:
        """Length in mm that moments are divided by."""
        ends = np.array([self.fixed.patch.ends, self.moving.patch.ends])
        return float(max(self.opening, np.ptp(ends), 1.0) / 2)

    def compute_wrenches(self, points: Array, forces: Array) -> Array:
        """Return wrenches (N, 6) of forces (N, 3) in N at points (N, 3) in mm.

        A wrench is the force, then its moment about ``centre``, divided by ``length``.
        """
        arms = points - self.centre
        return np.hstack([forces, np.cross(arms, forces) / self.length])

    @cached_property
    def pressing(self) -> Array:
        """Wrenches (R, 6) that the R unit pressures of both jaws exert on the part, those of the fixed jaw
        first.

        The unit pressures are ``PressedFace.edges``.
        """
        rows = []
        for patch, y, way in ((self.fixed, 0.0, 1.0), (self.moving, self.opening, -1.0)):
            points = np.column_stack([patch.centres[:, 0], np.full(len(patch.edges), y), patch.centres[:, 1]])
            rows.append(self.compute_wrenches(points, np.tile([0.0, way, 0.0], (len(points), 1))))
        return np.vstack(rows)

    @cached_property
    def pushing(self) -> Array:
        """Wrenches (K, 6) of K unit forces without friction: first of
        the parallels upward, then of the work stop.
        """
        near, far = (0.0, self.opening) if self.parallels is None else self.parallels
        points = [
            (x, y, 0.0) for patch, y in ((self.fixed, near), (self.moving, far)) for x in patch.patch.ends
        ]
        upward = self.compute_wrenches(np.array(points), np.tile([0.0, 0.0, 1.0], (len(points), 1)))
        ways = np.tile([self.stop_way, 0.0, 0.0], (len(self.stop_points), 1))
        return np.vstack([upward, self.compute_wrenches(self.stop_points, ways)])

    @cached_property
    def rubbing(self) -> Array:
        """Wrenches (C, 16, 6) of unit friction forces: in each of the C
        cells of both jaws, in 16 directions.
        """
        turns = 2 * pi / DIRECTIONS * np.arange(DIRECTIONS)
        ways = np.column_stack([np.sin(turns), np.zeros(DIRECTIONS), np.cos(turns)])
        rows = []
        for patch, y in ((self.fixed, 0.0), (self.moving, self.opening)):
            centre = patch.cells.centre
            points = np.column_stack([centre[:, 0], np.full(len(centre), y), centre[:, 1]])
            rows.append(
                self.compute_wrenches(np.repeat(points, DIRECTIONS, axis=0), np.tile(ways, (len(points), 1)))
            )
        return np.vstack(rows).reshape(-1, DIRECTIONS, 6)

    @cached_property
    def bearing(self) -> Array:
        """Largest friction force (C, R) of each of the C cells, per unit of each of the R pressures of
        ``pressing``.
        """
        own, other = (
            (self.friction * patch.compute_pressures(patch.cells.centre) * patch.cells.area).T
            for patch in (self.fixed, self.moving)
        )
        count = len(own), len(other), own.shape[1], other.shape[1]
        out = np.zeros((count[0] + count[1], count[2] + count[3]))
        out[: count[0], : count[2]], out[count[0] :, count[2] :] = own, other
        return out

    @cached_property
    def clamp_force_per_pressure(self) -> Array:
        """Jaw force in N, (R,), per unit of each pressure of ``pressing``.

        It is 0 for pressures of the fixed jaw, 1 for those of the moving jaw.
        """
        return np.repeat([0.0, 1.0], [len(self.fixed.edges), len(self.moving.edges)])

    def compute_forces_needed(self, loads: Array) -> list[float | None]:
        """Return the least jaw force in N that holds each load; None for a load that no jaw force holds.

        ``loads`` (N, 6) are wrenches on the part, as :meth:`compute_wrenches` returns them.
        """
        motions = MotionProgram(self)
        return [motions.find_least_force(load) for load in loads]


class HeldByFriction(Protocol):
    """A part that is held by pressures with friction, and by pushing forces without friction.

    Parameters
    ----------
    pushing : (K, 6) wrenches of K unit forces without friction.
    pressing : (R, 6) wrenches of R unit pressures.
    rubbing : (C, D, 6) wrenches of unit friction forces in each of C cells, in D directions.
    bearing : (C, R) largest friction force of each cell, per unit of each pressure of ``pressing``.
    clamp_force_per_pressure : (R,) clamp force per unit of each pressure: 1 for pressures that clamp, else 0.
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
    def clamp_force_per_pressure(self) -> Array: ...


@define(eq=False)
class MotionProgram:
    """The linear program for the motion of the part that a load drives
    hardest, dual to that for the least clamp force.

    The least clamp force is the largest power of the load on a motion (6,) under these conditions: (a)
    pressures that do not clamp, with their friction, and forces without friction do no work against the
    motion; (b) each pressure that clamps does work of at most 1 per unit. In each cell friction acts in the
    direction of its largest work, so each pressure gives very many linear conditions. A condition is added
    when the last motion breaks it, until none is broken; all loads of one grip share them.

    Parameters
    ----------
    grip : pressures, forces and friction that hold the part.
    conditions : (K, 6) coefficients of the program's rows.
    answered : clamp forces already computed, by the bytes of the rounded load.
    motions : (L, 6) optimal motions of L solved loads.
    inverses : (L, 6, 6) for each of these motions the inverse of the matrix of its six active conditions.
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
        self.program = LinearProgram.from_matrix(free, np.zeros(6), below, np.zeros(len(free)), most=FARTHEST)
        self.conditions = free

    def find_least_force(self, load: Array, enough: float = -np.inf) -> float | None:
        """Return the least clamp force in N that balances a load (6,); None where no force does.

        If the least force is at most ``enough``, any force between it and ``enough`` may be returned instead.
        """
        return self.find_driven_motion(load, enough)[0]

    def find_driven_motion(self, load: Array, enough: float = -np.inf) -> tuple[float | None, Array]:
        """Return (the least clamp force in N that balances a load (6,), the motion (6,) that the load
        drives).

        The force is the power of the load on the motion. It is None where no force balances the load; the
        motion is then one that no clamp force resists. If the least force is at most ``enough``, any force
        between it and ``enough`` may be returned instead.

        Raises
        ------
        WorkholdError
            When the solver does not end.
        """
        size = float(np.abs(load).max())
        if size == 0.0:
            return 0.0, np.zeros(6)
        # Forces balance the load, so that it drives the part against the way they work.
        driven = -load / size
        driven[np.abs(driven) < NEGLIGIBLE] = 0.0
        for _ in range(MOST_TURNS):
            motion = self.program.solve_with_costs(-driven)
            if motion is None:
                break
            if float(driven @ motion) * size <= enough:
                return max(float(driven @ motion), 0.0) * size, motion
            if not self.add_broken_conditions(motion):
                is_free = np.abs(motion).max() > 0.5 * FARTHEST
                return None if is_free else max(float(driven @ motion), 0.0) * size, motion
        raise WorkholdError(
            "the clamp force of a load was not found: report it with the part, the hardware and the load."
        )

    def bound_force(self, loads: Array) -> float:
        """Return a lower bound in N of the largest clamp force that loads
        (N, 6) need, from the motions known so far.
        """
        return max(float((self.motions @ -loads.T).max(initial=0.0)), 0.0)

    def find_least_forces(self, loads: Array, most: float = np.inf) -> Array:
        """Return the least clamp force in N for each load (N, 6), inf where no force holds it, as (N,).

        Where the least force is at most ``most``, a larger force up to ``most`` may be returned instead. Once
        a force is above ``most``, the remaining ones stay NaN.

        A motion with six active conditions is optimal for every load in the cone of these conditions' forces.
        So one linear program answers all loads in that cone.
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
            need, count = self.find_least_force(loads[first], enough), len(self.motions)
            out[first], left = (np.inf if need is None else need), left[left != first]
            self.answered[keys[first]] = float(out[first])
            if need is not None and need > enough:
                self.remember_cone(loads[first])
                left = self.answer_in_cones(self.inverses[count:], self.motions[count:], driven, left, out)
        return out

    def remember_cone(self, load: Array) -> None:
        """Store the last motion and its six active conditions, to answer further loads; skip this if they
        determine the motion badly.
        """
        rows = self.program.find_bounding_rows() if load.any() else None
        if rows is None or np.linalg.cond(self.conditions[rows]) > MOST_CONDITION:
            return
        self.inverses = np.concatenate([self.inverses, np.linalg.inv(self.conditions[rows])[None]])
        self.motions = np.concatenate([self.motions, self.program.read_solution()[None]])

    @staticmethod
    def answer_in_cones(
        inverses: Array, motions: Array, driven: Array, left: NDArray[np.intp], out: Array
    ) -> NDArray[np.intp]:
        """Write into ``out`` (N,) the forces for loads in a known cone; return the indices of the other
        loads.

        Parameters
        ----------
        inverses, motions : (K, 6, 6) and (K, 6), see :class:`MotionProgram`, one of each for K cones.
        driven : (N, 6) the loads, negated.
        left : indices of the loads to answer.
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

    def add_broken_conditions(self, motion: Array) -> bool:
        """Add to the program the conditions that a motion (6,) breaks; return whether it breaks any."""
        grip = self.grip
        along = grip.rubbing @ motion
        chosen = along.argmax(axis=1)
        rubbed = grip.rubbing[np.arange(len(chosen)), chosen]
        forces = grip.pressing + grip.bearing.T @ rubbed
        work = forces @ motion - grip.clamp_force_per_pressure
        broken = work > BROKEN * (1.0 + np.abs(forces * motion).sum(axis=1))
        if broken.any():
            self.program.add_rows(forces[broken], grip.clamp_force_per_pressure[broken])
            self.conditions = np.vstack([self.conditions, forces[broken]])
        return bool(broken.any())


def is_pressed_all_over(fixed: JawPatch, moving: JawPatch) -> bool:
    """Return whether both jaws can press over their whole contacts with equal and opposite forces.

    They can if their kerns meet; a kern is the set of possible centres of pressure.
    """
    one, other = PressedPatch(fixed), PressedPatch(moving)
    return hulls_meet(one.centres, other.centres, KERN_SLACK)


def find_least_peak_pressure(fixed: JawPatch, moving: JawPatch, force: float) -> float | None:
    """Return the least possible peak pressure in MPa at a jaw force in N, without loads.

    None for a jaw that touches along a line (unbounded pressure), and for a jaw that cannot press over its
    whole contact.
    """
    if fixed.is_line or moving.is_line or not is_pressed_all_over(fixed, moving):
        return None
    patches = PressedPatch(fixed), PressedPatch(moving)
    own, other = patches
    counts, size = (
        (len(own.edges), len(other.edges)),
        max(float(one.compute_largest_pressures().max()) for one in patches),
    )
    middle = own.integrals[0, 1:] / own.integrals[0, 0]
    arms = [one.centres - middle for one in patches]
    span = max(1.0, *(float(np.abs(one).max()) for one in arms))
    corners = [one.compute_largest_pressures().T / size for one in patches]
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
    least = LinearProgram.from_matrix(
        matrix, np.eye(1, matrix.shape[1], matrix.shape[1] - 1)[0], lower, upper
    ).find_least_cost()
    return None if least is None else least * size * force


def enclose_directions(low: float, high: float, steps: int = 32) -> Array:
    """Return vectors (N, 2) whose convex hull contains the unit vectors of a range of directions.

    The range is from ``low`` to ``high`` in radians. With 32 ``steps`` per turn the vectors are at most 0.5 %
    longer than 1. For low = high the result is that single unit vector.
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


def list_load_corners(load: Load, theta: float, position: Point, height: float) -> tuple[Array, Array]:
    """Return (1) points (N, 3) in mm and (2) forces (N, 3) in N whose
    convex hull contains every case of a load.

    Both are in the jaws' frame. The load's moment is left out.

    Parameters
    ----------
    theta : orientation of the part in radians.
    position : place of the part's origin, in mm.
    height : height at which the load acts, in mm.
    """
    low, high = (radians(angle) + theta for angle in load.directions)
    ways = enclose_directions(low, high) if load.force else np.zeros((1, 2))
    points = np.array(load.points or ((0.0, 0.0),))
    c, s = cos(theta), sin(theta)
    x, y = c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]
    places = np.column_stack([x + position[0], y + position[1], np.full(len(points), height)])
    forces = np.column_stack([load.force * ways, np.full(len(ways), load.upward)])
    return np.repeat(places, len(ways), axis=0), np.tile(forces, (len(places), 1))
