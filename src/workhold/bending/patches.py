"""Patches of the surface that are pressed, and readings of the movement beside them.

Under a patch the surface is dented: the narrower the patch, the deeper, and no mesh tells how deep. So
movements are read a little beside the patch, where they do not depend on how the force is distributed over
it.
"""

from __future__ import annotations

from math import ceil, cos, pi, sin

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.bending.elastic import PointForces

__all__ = ["BESIDE", "PEG_WIDTH", "LoadPatch", "make_disc", "make_foot", "make_rectangle", "make_strip"]

Array = NDArray[np.float64]

# How wide a round peg presses on a face, in mm. Hertz's theory gives some tenths for usual forces; what is read beside
# the strip hardly depends on it.
PEG_WIDTH = 2.0
# How far beside a patch movements are read, in mm.
BESIDE = 2.0
# Points of a patch across its width, and the length in mm that one stands for along it, at most.
ACROSS, ALONG = 4, 2.0
# Points of a disc by rings, and of what is read around it.
RINGS, AROUND = ((0.25, 4), (0.75, 12)), 12


@frozen(eq=False)
class LoadPatch:
    """A patch of the surface.

    Parameters
    ----------
    points : (M, 3) points of the patch in mm.
    beside : (K, 3) points beside the patch where movements are read, in mm.
    outward : unit vector (3,) out of the part; None where the nearest side counts.
    weights : (M,) fraction of the patch's area that each point stands for; all the same if None.
    """

    points: Array
    beside: Array
    outward: Array | None
    weights: Array | None = None

    @property
    def middle(self) -> Array:
        """Mean (3,) of the points."""
        return np.asarray(self.points.mean(axis=0))

    def press(self, direction: Array, factors: Array | None = None) -> PointForces:
        """Return a force of 1 N in a direction (3,), spread evenly over the patch.

        With ``factors`` (M,), the force at each point is multiplied by its factor.
        """
        shares = np.full(len(self.points), 1.0 / len(self.points)) if self.weights is None else self.weights
        if factors is not None:
            shares = shares * factors
        return PointForces(self.points, shares[:, None] * direction, self.outward)

    def read(self, direction: Array) -> PointForces:
        """Return the reading of the mean movement in a direction (3,) of the points beside the patch."""
        count = len(self.beside)
        return PointForces(self.beside, np.tile(direction / count, (count, 1)), self.outward)

    def make_unit_moment(self) -> PointForces:
        """Return forces with a moment of 1 N mm about the vertical axis (z) through the middle."""
        arms = self.points - self.middle
        forces = np.column_stack([-arms[:, 1], arms[:, 0], np.zeros(len(arms))])
        return PointForces(self.points, forces / (arms[:, :2] ** 2).sum(), self.outward)


def compute_interval_middles(low: float, high: float, count: int) -> Array:
    """Return the middles of ``count`` equal pieces of an interval."""
    return low + (np.arange(count) + 0.5) / count * (high - low)


def make_strip(point: tuple[float, float], normal: tuple[float, float], low: float, high: float) -> LoadPatch:
    """Return the vertical strip of the surface on which a round peg presses.

    Parameters
    ----------
    point : where the peg touches, (x, y) in mm.
    normal : outward unit normal of the part at that point.
    low, high : heights in mm between which the peg presses.
    """
    along = (-normal[1], normal[0])
    heights = compute_interval_middles(low, high, max(ACROSS, ceil((high - low) / ALONG)))

    def at(offsets: Array) -> Array:
        off, z = (one.ravel() for one in np.meshgrid(offsets, heights, indexing="ij"))
        return np.column_stack([point[0] + off * along[0], point[1] + off * along[1], z])

    half = PEG_WIDTH / 2
    return LoadPatch(
        at(compute_interval_middles(-half, half, ACROSS)),
        at(np.array([-half - BESIDE, half + BESIDE])),
        np.array([*normal, 0.0]),
    )


def make_disc(middle: Array, radius: float, outward: Array | None) -> LoadPatch:
    """Return a level disc, such as that of a pad or a tip, or the place of a cutter on any side of the part.

    Parameters
    ----------
    middle : (3,) centre in mm.
    radius : in mm.
    outward : unit vector (3,) out of the part; None where the side nearest to the points counts.
    """

    def ring(far: float, count: int) -> Array:
        angles = 2 * pi * (np.arange(count) + 0.5) / count
        return np.asarray(middle + [(far * cos(a), far * sin(a), 0.0) for a in angles])

    points = np.concatenate([ring(share * radius, count) for share, count in RINGS])
    return LoadPatch(points, ring(radius + BESIDE, AROUND), outward)


def make_rectangle(corner: Array, sides: tuple[Array, Array], spacing: float = ALONG) -> tuple[Array, Array]:
    """Return points (M, 3) spread evenly over a flat rectangle, and the area in mm² that each stands for.

    The rectangle is spanned from ``corner`` (3,) by two vectors ``sides`` (3,); points are at most
    ``spacing`` mm apart, at least two along each side.
    """
    lengths = [float(np.linalg.norm(side)) for side in sides]
    counts = [max(2, ceil(length / spacing)) for length in lengths]
    first, second = (
        one.ravel()
        for one in np.meshgrid(*(compute_interval_middles(0.0, 1.0, n) for n in counts), indexing="ij")
    )
    points = corner + first[:, None] * sides[0] + second[:, None] * sides[1]
    return points, np.full(len(points), lengths[0] * lengths[1] / len(points))


def make_foot(nodes: Array, triangles: NDArray[np.int64], normals: Array, lowest: float) -> LoadPatch | None:
    """Return the patch of the level faces on which a part lies, at the height ``lowest`` in mm; None where it
    has none.

    Nodes (N, 3), triangles (T, 6) and outward normals (T, 3) are those of a mesh's surface.
    """
    corners = nodes[triangles[:, :3]]
    is_foot = (normals[:, 2] < -0.999) & (np.abs(corners[:, :, 2] - lowest).max(axis=1) < 1e-3)
    if not is_foot.any():
        return None
    own = corners[is_foot]
    areas = np.linalg.norm(np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0]), axis=1)
    middles = own.mean(axis=1)
    return LoadPatch(middles, middles, np.array([0.0, 0.0, -1.0]), areas / areas.sum())
