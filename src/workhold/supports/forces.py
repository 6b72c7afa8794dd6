"""Support forces of triangles: the clamp forces that loads and the jaws require, at the worst heights.

With beta_j(q) = b_j . q + c_j the barycentric coordinates of a point of the plane, a support presses with

    N_j = C beta_j(t) + A beta_j(p) + b_j . (z g + (M_y, -M_x) + sum h_i a_i (-n_i)),

for a clamp force C at t, a force g at (p, z) with A downward, and peg forces a_i at heights h_i. That is the
balance of the vertical forces and of both tilting moments, because beta_j is affine. As a_i >= 0, N_j is
least at the lower end of a band if b_j . (-n_i) > 0 and at the upper end otherwise, whatever the load. As a
function of the direction of g, N_j is a constant plus a sinusoid; in p, z and A it is linear.

Let d be the distance from the side of a triangle opposite to support j, and h_j the height of the triangle
over that side. Then beta_j(q) = d(q) / h_j, and h_j N_j is the same for all supports opposite to the side. So
the worst loads are computed once per directed line through two holes instead of once per triangle, of which
there are far more.

Glossary
--------
side : a directed line from one hole to another; points on its left are at a positive distance.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from math import radians

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.conventions import AGREEMENT, GAP_SLACK
from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.support_request import SpatialLoad
from workhold.statics.contact_matrix import TouchableFeatures

__all__ = [
    "CornerTriples",
    "AffineFunctions",
    "PegForces",
    "HoleSides",
    "Triangles",
    "WeakJawError",
    "compute_jaw_lift",
    "find_needed_jaw_force",
    "count_worst_cases",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# Two supports and a third nearer to their line than this, in mm, are on one line.
ON_ONE_LINE = 1e-6
# Sides whose loads are looked for together.
AT_ONCE = 1 << 16


@define(frozen=True, eq=False)
class PegForces:
    """Peg forces of one fixture per unit of load in the plane.

    Parameters
    ----------
    center : (2,) point in mm about which moments are taken.
    pushes : (P, 2) unit vectors along which the P pegs push, in the part's frame.
    answers : (P, 4) peg forces per unit of g_x, g_y, moment in N mm about the centre, and jaw force.
    """

    center: Array
    pushes: Array
    answers: Array

    @classmethod
    def from_fixture(cls, fixture: Fixture, toolkit: Toolkit, touched: TouchableFeatures) -> PegForces:
        """Return the peg forces of a fixture per unit of load, with a jaw that keeps its force."""
        matrices = touched.compute_for_fixture(fixture, toolkit)
        scale = np.array([1.0, 1.0, touched.length, 1.0])
        return cls(touched.center, -matrices.normals[0], matrices.inverses[0].T / scale)

    def compute_forces(self, point: Array) -> Array:
        """Return the force of each peg per unit of a force in x, and in y,
        at a point (2,) in mm, as (P, 2).
        """
        dx, dy = point - self.center
        x, y, moment, _ = self.answers.T
        return np.stack([x - dy * moment, y + dx * moment], axis=1)


@define(frozen=True, eq=False)
class AffineFunctions:
    """Affine functions n . q + c of points q: distances from lines, or barycentric coordinates.

    Parameters
    ----------
    normals : (..., 2) n.
    constants : (...) c.
    """

    normals: Array
    constants: Array

    def evaluate(self, points: Array) -> Array:
        """Return the values (...) at points (..., 2)."""
        return np.asarray(
            self.normals[..., 0] * points[..., 0] + self.normals[..., 1] * points[..., 1] + self.constants
        )

    def compute_leverage(self, pegs: PegForces, bands: Array, highest: bool) -> Array:
        """Return h_i n . (-n_i) for each peg i, (..., P), at the end of its band where it is least.

        With ``highest``, at the end where it is largest. Here n is ``normals``, -n_i is the direction in
        which peg i pushes, and h_i the height in mm at which it presses. ``bands`` (P, 2) are the lowest and
        highest heights.
        """
        along = self.normals[..., :1] * pegs.pushes[:, 0] + self.normals[..., 1:] * pegs.pushes[:, 1]
        ends = along * bands[:, 0], along * bands[:, 1]
        return np.maximum(*ends) if highest else np.minimum(*ends)


@define(frozen=True, eq=False)
class Triangles:
    """N triangles of supports with their barycentric coordinates beta_j(q) = b_j . q + c_j.

    Parameters
    ----------
    corners : (N, 3, 2) in mm.
    slopes : (N, 3, 2) b_j, in 1/mm.
    constants : (N, 3) c_j.
    """

    corners: Array
    slopes: Array
    constants: Array

    @classmethod
    def from_corners(cls, corners: Array) -> Triangles:
        """Return the triangles with corners (N, 3, 2); none may be flat."""
        after, before = np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1)
        side = before - after
        # b_j is square to the side that faces corner j, and beta_j is 1 at that corner.
        across = np.stack([-side[..., 1], side[..., 0]], axis=-1)
        height = ((corners - after) * across).sum(axis=-1)
        slopes = across / height[..., None]
        return cls(corners, slopes, -(slopes * after).sum(axis=-1))

    def take(self, rows: NDArray[np.int64]) -> Triangles:
        """Return the triangles with some indices."""
        return Triangles(self.corners[rows], self.slopes[rows], self.constants[rows])

    @property
    def steepness(self) -> Array:
        """Lengths of the vectors b_j, (N, 3), in 1/mm: the inverse of the
        triangle's height over the side opposite corner j.
        """
        return np.hypot(self.slopes[..., 0], self.slopes[..., 1])

    def compute_shares(self, points: Array) -> Array:
        """Return the barycentric coordinates (N, ..., 3) of points (N, ..., 2) in their triangles.

        A single point (2,) is taken in all triangles.
        """
        shape = (len(self.slopes), *[1] * max(points.ndim - 2, 0))
        lines = AffineFunctions(self.slopes.reshape(*shape, 3, 2), self.constants.reshape(*shape, 3))
        return lines.evaluate(points[..., None, :])

    def measure_side_distances(self, points: Array) -> Array:
        """Return the distance in mm of points from each side of their
        triangles, (N, ..., 3), positive inside.

        Points as in :meth:`compute_shares`.
        """
        shares = self.compute_shares(points)
        extra = shares.ndim - 2
        return np.asarray(shares / self.steepness.reshape(len(self.slopes), *[1] * extra, 3))


def find_largest_over_directions(x: Array, y: Array, directions: tuple[float, float]) -> Array:
    """Return the largest x cos t + y sin t, elementwise, for t in a range of degrees."""
    if directions[1] - directions[0] >= 360.0:
        return np.hypot(x, y)
    low, high = (radians(angle) for angle in directions)
    ends = np.maximum(x * np.cos(low) + y * np.sin(low), x * np.cos(high) + y * np.sin(high))
    peak = (np.arctan2(y, x) - low) % (2 * np.pi)
    return np.where(peak <= high - low, np.hypot(x, y), ends)


def compute_support_forces(
    lines: AffineFunctions, pegs: PegForces, bands: Array, loads: tuple[SpatialLoad, ...], jaw_force: float
) -> tuple[Array, Array]:
    """Return (1) the least and (2) the largest force in N on each of
    N supports, without the clamp, (N,) each.

    They are taken over all loads, and over the heights at which pegs may press.

    Parameters
    ----------
    lines : barycentric coordinate beta_j of each support. If distances from the opposite sides are given
        instead, the forces are multiplied by the triangles' heights over these sides.
    bands : (P, 2) heights at which each peg presses, in mm.
    loads : loads whose heights are known.
    jaw_force : force on the moving carrier, in N.
    """
    x, y = lines.normals[..., 0], lines.normals[..., 1]
    out = []
    for sign in (1.0, -1.0):
        levers = lines.compute_leverage(pegs, bands, highest=sign < 0)
        jaws = levers @ pegs.answers[:, 3] * jaw_force
        worst = np.full(x.shape, np.inf)
        for load in loads:
            turned = levers @ pegs.answers[:, 2] * load.moment
            still = jaws + turned + x * load.tilt[1] - y * load.tilt[0]
            assert load.heights is not None
            for point in load.points or (tuple(pegs.center),):
                where = np.array(point)
                moved = levers @ pegs.compute_forces(where) if load.force else np.zeros((*x.shape, 2))
                shares = lines.evaluate(where)
                for height, axial in product(set(load.heights), set(load.axial)):
                    value = sign * (still + axial * shares)
                    if load.force:
                        value -= load.force * find_largest_over_directions(
                            -sign * (moved[..., 0] + height * x),
                            -sign * (moved[..., 1] + height * y),
                            load.directions,
                        )
                    worst = np.minimum(worst, value)
        out.append(sign * worst)
    return out[0], out[1]


def count_worst_cases(load: SpatialLoad) -> int:
    """Return how many combinations of point, height and axial force of a load must be examined."""
    return max(len(load.points), 1) * len(set(load.heights or (0.0,))) * len(set(load.axial))


def compute_jaw_lift(lines: AffineFunctions, pegs: PegForces, bands: Array) -> Array:
    """Return the largest force by which the jaw lifts each support, (...), in N per N of jaw force.

    Parameters as in :func:`compute_support_forces`.
    """
    return np.asarray(-(lines.compute_leverage(pegs, bands, highest=False) @ pegs.answers[:, 3]))


class WeakJawError(InputError):
    """A jaw force that is too small for a load."""


def find_needed_jaw_force(pegs: PegForces, loads: Sequence[SpatialLoad], jaw_force: float | None) -> float:
    """Return the given jaw force in N; for None, the least one that
    keeps all pegs in contact under every load.

    Raises
    ------
    WeakJawError
        When the given jaw force is too small for a load.
    """
    needs = [find_jaw_force_for_load(pegs, load) for load in loads]
    if jaw_force is None:
        return max(needs, default=0.0)
    for load, need in zip(loads, needs, strict=True):
        if need > jaw_force * (1 + AGREEMENT):
            name = f"the load '{load.name}'" if load.name else "a load"
            raise WeakJawError(
                f"with a jaw force of {jaw_force:g} N a peg loses contact under {name}, which needs "
                f"{need:.6g} N: give more, or leave it out."
            )
    return float(jaw_force)


def find_jaw_force_for_load(pegs: PegForces, load: SpatialLoad) -> float:
    """Return the jaw force in N above which no peg lets go under a load; at least 0.

    Peg i presses with a_i + F h_i, where a_i balances the load and h_i > 0.
    """
    if load.force == 0.0 and load.moment == 0.0:
        return 0.0
    _, _, moment, closing = pegs.answers.T
    worst = 0.0
    for point in (load.points if load.force else ()) or (tuple(pegs.center),):
        x, y = pegs.compute_forces(np.array(point)).T
        asked = load.force * find_largest_over_directions(-x, -y, load.directions) - load.moment * moment
        worst = max(worst, float((asked / closing).max()))
    return worst


@define(frozen=True, eq=False)
class CornerTriples:
    """N triangles of holes, counter-clockwise; lengths in mm.

    Parameters
    ----------
    numbers : (N, 3) indices of the holes, ascending.
    sides : (N, 3) numbers of the sides opposite to these holes, see :class:`HoleSides`.
    heights : (N, 3) heights of the triangle over these sides.
    """

    numbers: IntArray
    sides: IntArray
    heights: Array

    def take(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> CornerTriples:
        """Return the triangles that an index array or a mask selects."""
        return CornerTriples(self.numbers[rows], self.sides[rows], self.heights[rows])


@define(frozen=True, eq=False)
class HoleSides:
    """The directed sides between H holes; side H·a + b runs from hole a to hole b.

    Parameters
    ----------
    points : (H, 2) centres of the holes, in mm in the part's coordinates.
    pegs : peg forces of the fixture per unit of load.
    bands : (P, 2) lowest and highest height in mm at which each peg presses.
    loads : loads whose heights are known.
    jaw_force : force on the moving carrier, in N.
    length : (H·H,) length of each side, in mm.
    least, most : (H·H,) least and largest force on a support, without the clamp, times the support's distance
        from the side, in N mm; empty without loads.
    """

    points: Array
    pegs: PegForces
    bands: Array
    loads: tuple[SpatialLoad, ...]
    jaw_force: float
    length: Array = field(init=False)
    least: Array = field(init=False)
    most: Array = field(init=False)

    def __attrs_post_init__(self) -> None:
        count = len(self.points)
        apart = self.points[None] - self.points[:, None]
        object.__setattr__(self, "length", np.hypot(apart[..., 0], apart[..., 1]).ravel())
        least, most = np.zeros((2, count * count if self.loads else 0))
        for first in range(0, len(least), AT_ONCE):
            numbers = np.arange(first, min(first + AT_ONCE, len(least)))
            least[numbers], most[numbers] = compute_support_forces(
                self.make_lines(numbers), self.pegs, self.bands, self.loads, self.jaw_force
            )
        object.__setattr__(self, "least", least)
        object.__setattr__(self, "most", most)

    def make_lines(self, numbers: IntArray) -> AffineFunctions:
        """Return the distances from sides, given by number (...), as affine functions, positive on the left.

        They are zero for sides from a hole to itself.
        """
        begin, end = self.points[numbers // len(self.points)], self.points[numbers % len(self.points)]
        length = self.length[numbers]
        along = (end - begin) / np.where(length > 0.0, length, np.inf)[..., None]
        normals = np.stack([-along[..., 1], along[..., 0]], axis=-1)
        return AffineFunctions(normals, -(normals[..., 0] * begin[..., 0] + normals[..., 1] * begin[..., 1]))

    def make_corners(self, numbers: IntArray, inside: float) -> CornerTriples:
        """Return the triangles of three holes whose incircle has a radius of at least ``inside`` mm.

        ``numbers`` (N, 3) are indices of holes, ascending in each row. Flat triangles are left out, too. The
        incircle's centre is the point farthest inside the triangle.
        """
        count = len(self.points)
        i, j, k = numbers.T
        (ax, ay), (bx, by), (cx, cy) = (self.points[one].T for one in (i, j, k))
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        turned = area < 0.0
        first, second = np.where(turned, k, j), np.where(turned, j, k)
        # Of i, j and k the sides j k, k i and i j, or the other way round.
        sides = np.stack(
            [
                first * count + second,
                np.where(turned, i * count + k, k * count + i),
                np.where(turned, j * count + i, i * count + j),
            ],
            axis=1,
        )
        length = self.length[sides]
        area = np.abs(area)
        kept = (area > ON_ONE_LINE * length.max(axis=1, initial=0.0)) & (
            area >= (inside - GAP_SLACK) * (length[:, 0] + length[:, 1] + length[:, 2])
        )
        return CornerTriples(numbers[kept], sides[kept], area[kept, None] / length[kept])

    def compute_contact_forces(self, corners: CornerTriples) -> Array:
        """Return r_j, the force in N that the clamp must put on each support to keep it in contact, (N, 3).

        Negative where the support stays in contact without the clamp.
        """
        return -self.least[corners.sides] / corners.heights

    def compute_largest_forces(self, corners: CornerTriples) -> Array:
        """Return the largest force (N, 3) in N on each support, without the clamp."""
        return self.most[corners.sides] / corners.heights

    def compute_incircles(self, corners: CornerTriples) -> Array:
        """Return the radii (N,) in mm of the triangles' incircles."""
        one = 1.0 / corners.heights
        return np.asarray(1.0 / (one[:, 0] + one[:, 1] + one[:, 2]))

    def measure_distances(self, corners: CornerTriples, points: Array) -> Array:
        """Return the distance in mm of points from each side of their triangles, (N, 3), positive inside.

        ``points`` is (N, 2), or (2,) for the same point in all triangles.
        """
        return self.make_lines(corners.sides).evaluate(points[..., None, :])
