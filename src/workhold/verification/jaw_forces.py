"""The jaw force that a load needs between two flat jaws, by another method than the search's.

A jaw's pressures are sums of a few extreme pressures with unit force, and its largest friction is the sum of
the friction that each of these allows in the cells. So the wrenches of a jaw with unit force are a convex
set. A motion of the part (a twist) finds the point of this set that does most work on it. Such points are
enough to find the least force, by a linear program in six equations: for the dual prices of the last solution
a point is added, until none improves the solution (column generation). It is solved by the revised simplex
method with bases of six columns. The search's code is not used.

Reference: G. B. Dantzig, P. Wolfe, *Decomposition principle for linear programs*, Operations Research 8
(1960).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, pi, sin

import numpy as np
from attrs import field, frozen
from numpy.typing import NDArray

from workhold.model.jaw_hold import JawPatch, Rectangle

__all__ = [
    "LENGTH",
    "HeldBetweenJaws",
    "UnsettledError",
    "list_extreme_pressures",
    "compute_resultant_points",
    "compute_wrenches",
]

Array = NDArray[np.float64]
# Cells of a rectangle, and of a line, and directions of friction: part of what is claimed.
CELLS, CELLS_OF_LINE, WAYS = (6, 4), 6, 16
# A twist that gains less than this, of loads of size 1, gains nothing; how large the side is moved so that no step of
# the method stands still; and how many steps there are at most.
GAIN, MOVED, MOST_STEPS = 1e-9, 1e-10, 4000
# A length in mm by which moments are divided.
LENGTH = 50.0


class UnsettledError(Exception):
    """The method did not converge."""


def find_hull_corners(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the corners of the convex hull of points, counter-clockwise from the leftmost (gift wrapping).

    Fewer than three points are returned sorted.
    """
    left = sorted(set(points))
    if len(left) < 3:
        return left
    out, at = [left[0]], left[0]
    while True:
        ahead = left[0] if left[0] != at else left[1]
        for one in left:
            turn = (ahead[0] - at[0]) * (one[1] - at[1]) - (ahead[1] - at[1]) * (one[0] - at[0])
            far = (one[0] - at[0]) ** 2 + (one[1] - at[1]) ** 2 > (ahead[0] - at[0]) ** 2 + (
                ahead[1] - at[1]
            ) ** 2
            if one != at and (turn < 0 or (turn == 0 and far)):
                ahead = one
        if ahead == out[0]:
            return out
        out.append(ahead)
        at = ahead


def compute_area_moments(rectangles: Sequence[Rectangle]) -> tuple[float, Array, Array]:
    """Return (area, centre (2,), second moments (2, 2) about the centre) of rectangles taken together.

    Where all rectangles have zero width, lengths take the place of areas.
    """
    line = all(x0 == x1 for x0, x1, _, _ in rectangles)
    areas = np.array([(z1 - z0) * (1.0 if line else x1 - x0) for x0, x1, z0, z1 in rectangles])
    centres = np.array([((x0 + x1) / 2, (z0 + z1) / 2) for x0, x1, z0, z1 in rectangles])
    sizes = np.array([(x1 - x0, z1 - z0) for x0, x1, z0, z1 in rectangles])
    area = float(areas.sum())
    centre = areas @ centres / area
    off = centres - centre
    second = np.einsum("k,ki,kj->ij", areas, off, off) + np.diag(areas @ sizes**2 / 12)
    return area, centre, second


def list_extreme_pressures(patch: JawPatch) -> tuple[Array, list[tuple[float, float]]]:
    """Return (rows (R, 3), corners) of the R extreme linear pressures of unit force on a patch, and its
    hull's corners.

    Each row gives a pressure p = row · (1, x, z), which vanishes along one side of the hull.
    """
    area, centre, _ = compute_area_moments(patch.rectangles)
    corners = find_hull_corners(
        [(x, z) for x0, x1, z0, z1 in patch.rectangles for x in (x0, x1) for z in (z0, z1)]
    )
    rows = []
    if len(corners) == 2:
        sides = [((0.0, 1.0), corners[0][1]), ((0.0, -1.0), -corners[1][1])]
        centre = np.array([corners[0][0], centre[1]])
    else:
        sides = []
        for (x, z), (other_x, other_z) in zip(corners, [*corners[1:], corners[0]], strict=True):
            inward = np.array([z - other_z, other_x - x]) / np.hypot(other_x - x, other_z - z)
            sides.append(((float(inward[0]), float(inward[1])), float(inward @ (x, z))))
    for normal, level in sides:
        # p rises from the side as the distance does; its mean is what it is at the centre.
        mean = float(np.dot(normal, centre)) - level
        rows.append(np.array([-level, *normal]) / (mean * area))
    return np.array(rows), corners


def compute_resultant_points(patch: JawPatch) -> Array:
    """Return the points (R, 2), as (x, z) in mm, at which the resultants of the R extreme pressures act.

    Each is the patch's centre plus its second moments times the pressure's slope.
    """
    pressures, _ = list_extreme_pressures(patch)
    _, centre, second = compute_area_moments(patch.rectangles)
    return np.asarray(centre + pressures[:, 1:] @ second)


@frozen(eq=False)
class PressingJaw:
    """The wrenches that a jaw can exert with unit force: R extreme pressures, and friction at C cells of its
    patch.

    Parameters
    ----------
    pressing : (R, 6) wrenches of the extreme pressures.
    rubbing : (C, 16, 6) wrenches of a unit of friction at each cell, in 16 directions.
    bearing : (R, C) the largest friction at each cell under each extreme pressure.
    """

    pressing: Array
    rubbing: Array
    bearing: Array

    @classmethod
    def from_patch(cls, patch: JawPatch, y: float, way: float, friction: float) -> PressingJaw:
        """Return the jaw that presses on a patch in the plane at ``y`` mm.

        ``way`` is 1 where it presses along +y, -1 along -y; ``friction`` is the coefficient of friction.
        """
        pressures, _ = list_extreme_pressures(patch)
        acting = compute_resultant_points(patch)
        pressing = compute_wrenches(
            np.column_stack([acting[:, 0], np.full(len(acting), y), acting[:, 1]]), (0.0, way, 0.0)
        )
        line = all(x0 == x1 for x0, x1, _, _ in patch.rectangles)
        points, areas = list[tuple[float, float, float]](), list[float]()
        for x0, x1, z0, z1 in patch.rectangles:
            across, up = (1, CELLS_OF_LINE) if line else CELLS
            for j in range(up):
                for i in range(across):
                    points.append(
                        (
                            x0 + (2 * i + 1) * (x1 - x0) / (2 * across),
                            y,
                            z0 + (2 * j + 1) * (z1 - z0) / (2 * up),
                        )
                    )
                    areas.append((z1 - z0) / up * (1.0 if line else (x1 - x0) / across))
        at = np.array(points)
        turns = [2 * pi * k / WAYS for k in range(WAYS)]
        rubbing = np.stack([compute_wrenches(at, (cos(turn), 0.0, sin(turn))) for turn in turns], axis=1)
        local = pressures @ np.column_stack([np.ones(len(at)), at[:, 0], at[:, 2]]).T
        return cls(pressing, rubbing, friction * np.maximum(local, 0.0) * np.array(areas))

    def find_best_wrench(self, twist: Array) -> tuple[float, Array]:
        """Return (work, wrench (6,)) for the wrench of unit force that does most work on a motion ``twist``
        (6,).
        """
        works = self.rubbing @ twist
        chosen = works.argmax(axis=1)
        friction = self.bearing @ np.take_along_axis(works, chosen[:, None], axis=1)[:, 0]
        total = self.pressing @ twist + friction
        row = int(total.argmax())
        rubbed = self.rubbing[np.arange(len(chosen)), chosen]
        return float(total[row]), self.pressing[row] + self.bearing[row] @ rubbed


def compute_wrenches(points: Array, force: tuple[float, float, float]) -> Array:
    """Return the wrenches (N, 6) of the same ``force`` at each of N points (N, 3).

    Columns: the force in N, then its moments about the origin in N mm divided by ``LENGTH``.
    """
    forces = np.tile(force, (len(points), 1))
    x, y, z = points.T
    fx, fy, fz = forces.T
    return np.column_stack(
        [forces, (y * fz - z * fy) / LENGTH, (z * fx - x * fz) / LENGTH, (x * fy - y * fx) / LENGTH]
    )


@frozen(eq=False)
class HeldBetweenJaws:
    """A part between two jaws, on parallels and perhaps against a stop.

    Parameters
    ----------
    fixed, moving : the jaws.
    free : (K, 6) wrenches of K unit forces of parallels and the stop, which cost no jaw force.
    """

    fixed: PressingJaw
    moving: PressingJaw
    free: Array
    side: Array = field(init=False)

    @side.default
    def make_small_side(self) -> Array:
        """Return a small right-hand side (6,) with no two equal entries, which prevents degenerate simplex
        steps.
        """
        return MOVED * np.array([0.61803399, 0.41421356, 0.73205081, 0.23606798, 0.64575131, 0.31662479])

    @classmethod
    def from_patches(
        cls,
        fixed: JawPatch,
        moving: JawPatch,
        opening: float,
        friction: float,
        stop: Sequence[tuple[float, float, float]],
        stop_way: float,
        parallels: tuple[float, float] | None = None,
    ) -> HeldBetweenJaws:
        """Return the part held between two patches, the fixed one at y = 0 and the moving one at y =
        ``opening`` mm.

        ``friction`` is the coefficient of friction. ``stop`` has the points at which a work stop pushes,
        along +x (``stop_way`` 1) or -x (-1). ``parallels`` are the places y in mm of the parallels under the
        part; None for one at each jaw.
        """
        feet = [
            (end, y, 0.0)
            for patch, y in zip(
                (fixed, moving), (0.0, opening) if parallels is None else parallels, strict=True
            )
            for end in (min(one[0] for one in patch.rectangles), max(one[1] for one in patch.rectangles))
        ]
        free = compute_wrenches(np.array(feet), (0.0, 0.0, 1.0))
        if stop:
            free = np.vstack([free, compute_wrenches(np.array(stop), (stop_way, 0.0, 0.0))])
        return cls(
            PressingJaw.from_patch(fixed, 0.0, 1.0, friction),
            PressingJaw.from_patch(moving, opening, -1.0, friction),
            free,
        )

    def compute_needed_force(
        self, point: tuple[float, float, float], force: tuple[float, float, float], moment: float
    ) -> float | None:
        """Return the least jaw force in N that holds a load; None if no jaw force does.

        The load is a force in N at a point, and a moment about z in N mm.

        Raises
        ------
        UnsettledError
            When the method does not converge.
        """
        load = compute_wrenches(np.array([point]), force)[0]
        load[5] += moment / LENGTH
        found = self.find_least_force(load)
        return None if found is None else found[0]

    def find_least_force(self, load: Array) -> tuple[float, Array] | None:
        """Return (least jaw force in N for a load (6,), dual prices (6,)); None where no force suffices.

        The prices give a lower bound for any other load: it needs at least -prices · load. Moments of the
        load are divided by :data:`LENGTH`.

        Raises
        ------
        UnsettledError
            When the method does not converge.
        """
        size = float(np.abs(load).max())
        if size == 0.0:
            return 0.0, np.zeros(6)
        least = self.solve_least_cost(-load / size + self.side)
        return None if least is None else (max(least[0], 0.0) * size, least[1])

    def solve_least_cost(self, side: Array) -> tuple[float, Array] | None:
        """Return (least jaw force, dual prices (6,)) for wrenches of the contacts that sum to ``side`` (6,).

        Returns None where no wrenches of the contacts sum to it.

        Raises
        ------
        UnsettledError
            When the simplex method does not converge.
        """
        # The first basis stands for what is not balanced yet.
        columns, prices = np.diag(np.where(side < 0, -1.0, 1.0)), np.zeros(6)
        missing = np.ones(6, np.bool_)
        costs = np.zeros(6)
        for is_first in (True, False):
            for _ in range(MOST_STEPS):
                inverse = np.linalg.inv(columns)
                amount = inverse @ side
                prices = (np.where(missing, 1.0, 0.0) if is_first else costs) @ inverse
                gain, column, cost = self.find_entering_wrench(prices, is_first)
                if gain <= GAIN:
                    break
                change = inverse @ column
                # What is missing stays so, once it is nothing.
                at_rest = missing & (np.abs(change) > 1e-11) if not is_first else np.zeros(6, np.bool_)
                ratios = np.full(6, np.inf)
                down = change > 1e-11
                ratios[down] = np.maximum(amount[down], 0.0) / change[down]
                ratios[at_rest] = 0.0
                if not np.isfinite(ratios).any():
                    raise UnsettledError
                leaving = int(ratios.argmin())
                columns[:, leaving], costs[leaving], missing[leaving] = column, cost, False
            else:
                raise UnsettledError
            if is_first and np.where(missing, amount, 0.0).sum() > 10 * MOVED:
                return None
        return float(costs @ amount), prices

    def find_entering_wrench(self, prices: Array, is_first: bool) -> tuple[float, Array, float]:
        """Return (reduced gain, wrench (6,), cost) of the wrench with the largest reduced gain at dual prices
        (6,).

        The cost is 1 for a wrench of the moving jaw, else 0. In the first phase (``is_first``) the gain is
        computed without costs.
        """
        found = []
        for jaw, cost in ((self.fixed, 0.0), (self.moving, 0.0 if is_first else 1.0)):
            work, best = jaw.find_best_wrench(prices)
            found.append((work - cost, best, 0.0 if jaw is self.fixed else 1.0))
        works = self.free @ prices
        number = int(works.argmax())
        found.append((float(works[number]), self.free[number], 0.0))
        return max(found, key=lambda one: one[0])
