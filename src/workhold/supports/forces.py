"""Support forces of triangles: what loads and the jaws ask of the clamp, at the worst heights.

With beta_j(q) = b_j . q + c_j the barycentric coordinates of a point of the plane, a support presses with

    N_j = C beta_j(t) + A beta_j(p) + b_j . (z g + (M_y, -M_x) + sum h_i a_i (-n_i)),

for a clamp force C at t, a force g at (p, z) with A downward, and peg forces a_i at heights h_i. That is the
balance of the vertical forces and of both tilting moments, because beta_j is affine. As a_i >= 0, the height
that lowers N_j most is the lower end of a band where b_j . (-n_i) > 0 and the upper end elsewhere, whatever
the load. In the direction of g all is a constant and a sinusoid; in p, z and A it is linear.
"""

from __future__ import annotations

from itertools import product
from math import radians

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.support_request import SpatialLoad
from workhold.model.workpiece import Workpiece
from workhold.statics.contact_matrix import Touched

__all__ = ["Lines", "PegForces", "Triangles", "largest_over", "lifted_by_jaws", "support_forces"]

Array = NDArray[np.float64]


@define(frozen=True, eq=False)
class PegForces:
    """How the pegs of one fixture answer loads in the plane.

    Parameters
    ----------
    center : (2,) about which moments are taken, in mm.
    pushes : (P, 2) unit vectors in which pegs push, in the part's frame.
    answers : (P, 4) peg forces per unit of g_x, g_y, moment about the centre, and jaw force.
    """

    center: Array
    pushes: Array
    answers: Array

    @classmethod
    def of(cls, fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit) -> PegForces:
        """The responses of a fixture whose jaw keeps its force."""
        touched = Touched.of(workpiece, toolkit)
        return cls.within(fixture, toolkit, touched)

    @classmethod
    def within(cls, fixture: Fixture, toolkit: Toolkit, touched: Touched) -> PegForces:
        """The responses where what the pegs touch is known already."""
        matrices = touched.of_fixture(fixture, toolkit)
        scale = np.array([1.0, 1.0, touched.length, 1.0])
        return cls(touched.center, -matrices.normals[0], matrices.inverses[0].T / scale)

    def at(self, point: Array) -> Array:
        """Peg forces (P, 2) per unit of a force in x and in y at a point."""
        dx, dy = point - self.center
        x, y, moment, _ = self.answers.T
        return np.stack([x - dy * moment, y + dx * moment], axis=1)


@define(frozen=True, eq=False)
class Lines:
    """Affine functions n . q + c of points q: distances from lines, or barycentric coordinates.

    Parameters
    ----------
    normals : (..., 2) n.
    constants : (...) c.
    """

    normals: Array
    constants: Array

    def at(self, points: Array) -> Array:
        """The values (...) at points (..., 2)."""
        return np.asarray(
            self.normals[..., 0] * points[..., 0] + self.normals[..., 1] * points[..., 1] + self.constants
        )

    def leverage(self, pegs: PegForces, bands: Array, highest: bool) -> Array:
        """h_i n . (-n_i) as (..., P) at the heights of bands (P, 2) that make it least, or greatest."""
        along = self.normals[..., :1] * pegs.pushes[:, 0] + self.normals[..., 1:] * pegs.pushes[:, 1]
        ends = along * bands[:, 0], along * bands[:, 1]
        return np.maximum(*ends) if highest else np.minimum(*ends)


@define(frozen=True, eq=False)
class Triangles:
    """N triangles of supports.

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
    def of(cls, corners: Array) -> Triangles:
        """Triangles from their corners (N, 3, 2), none of them flat."""
        after, before = np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1)
        side = before - after
        # b_j is square to the side that faces corner j, and beta_j is 1 at that corner.
        across = np.stack([-side[..., 1], side[..., 0]], axis=-1)
        height = ((corners - after) * across).sum(axis=-1)
        slopes = across / height[..., None]
        return cls(corners, slopes, -(slopes * after).sum(axis=-1))

    def take(self, rows: NDArray[np.int64]) -> Triangles:
        """Some of the triangles."""
        return Triangles(self.corners[rows], self.slopes[rows], self.constants[rows])

    @property
    def steepness(self) -> Array:
        """Lengths (N, 3) of b_j: one over the height of the triangle over each side."""
        return np.hypot(self.slopes[..., 0], self.slopes[..., 1])

    def shares(self, points: Array) -> Array:
        """Barycentric coordinates (N, ..., 3) of points (N, ..., 2), or of points (2,) for all."""
        shape = (len(self.slopes), *[1] * max(points.ndim - 2, 0))
        lines = Lines(self.slopes.reshape(*shape, 3, 2), self.constants.reshape(*shape, 3))
        return lines.at(points[..., None, :])

    def sides(self, points: Array) -> Array:
        """Distances (N, ..., 3) of points from the three sides, positive inside."""
        shares = self.shares(points)
        extra = shares.ndim - 2
        return np.asarray(shares / self.steepness.reshape(len(self.slopes), *[1] * extra, 3))


def largest_over(x: Array, y: Array, directions: tuple[float, float]) -> Array:
    """Largest x cos + y sin over a range of directions in degrees."""
    if directions[1] - directions[0] >= 360.0:
        return np.hypot(x, y)
    low, high = (radians(angle) for angle in directions)
    ends = np.maximum(x * np.cos(low) + y * np.sin(low), x * np.cos(high) + y * np.sin(high))
    peak = (np.arctan2(y, x) - low) % (2 * np.pi)
    return np.where(peak <= high - low, np.hypot(x, y), ends)


def support_forces(
    lines: Lines, pegs: PegForces, bands: Array, loads: tuple[SpatialLoad, ...], jaw_force: float
) -> tuple[Array, Array]:
    """Least and largest forces (N,) of supports without the clamp, over all loads and heights.

    Parameters
    ----------
    lines : beta_j of N supports; or distances from the sides that face them, which makes all forces larger by
        the heights of the supports over these.
    bands : (P, 2) of the pegs.
    loads : with their heights written out.
    jaw_force : on what moves, F.
    """
    x, y = lines.normals[..., 0], lines.normals[..., 1]
    out = []
    for sign in (1.0, -1.0):
        levers = lines.leverage(pegs, bands, highest=sign < 0)
        jaws = levers @ pegs.answers[:, 3] * jaw_force
        worst = np.full(x.shape, np.inf)
        for load in loads:
            turned = levers @ pegs.answers[:, 2] * load.moment
            still = jaws + turned + x * load.tilt[1] - y * load.tilt[0]
            assert load.heights is not None
            for point in load.points or (tuple(pegs.center),):
                where = np.array(point)
                moved = levers @ pegs.at(where) if load.force else np.zeros((*x.shape, 2))
                shares = lines.at(where)
                for height, axial in product(set(load.heights), set(load.axial)):
                    value = sign * (still + axial * shares)
                    if load.force:
                        value -= load.force * largest_over(
                            -sign * (moved[..., 0] + height * x),
                            -sign * (moved[..., 1] + height * y),
                            load.directions,
                        )
                    worst = np.minimum(worst, value)
        out.append(sign * worst)
    return out[0], out[1]


def lifted_by_jaws(lines: Lines, pegs: PegForces, bands: Array) -> Array:
    """Lifts (...) of supports per N of jaw force at the worst heights, as the forces above."""
    return np.asarray(-(lines.leverage(pegs, bands, highest=False) @ pegs.answers[:, 3]))
