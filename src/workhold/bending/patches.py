"""Pressed patches of the surface, and readings of the movement beside them.

Under a patch the surface is dented: the narrower the patch, the deeper the dent, and no mesh gives its depth.
So movements are read a little beside the patch. There they do not depend on how the force is spread over the
patch.
"""

from __future__ import annotations

from math import ceil, cos, pi, sin

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.bending.elastic import PointForces

__all__ = [
    "BESIDE",
    "PEG_WIDTH",
    "LoadPatch",
    "RestingFaces",
    "find_foot_corners",
    "make_disc",
    "make_foot",
    "make_rectangle",
    "make_strip",
]

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
# Squares that the level faces a part lies on are cut into, about, where it is looked for which of them touch the plate;
# and points across one of them, at least.
CELLS, ACROSS_CELL = 48, 3
# Ends of the rings that are cut into sectors under a tip, each as a share of the tip's radius and one of the height.
UNDER_TIP, SECTORS = ((0.5, 0.0), (1.0, 0.0), (1.0, 0.7), (1.0, 2.0)), 6


@frozen(eq=False)
class LoadPatch:
    """A patch of the surface.

    Parameters
    ----------
    points : (M, 3) points of the patch in mm.
    beside : (K, 3) points beside the patch where movements are read, in mm.
    outward : unit vector (3,) out of the part; None to take the nearest side.
    weights : (M,) fraction of the patch's area that each point represents; None for equal fractions.
    """

    points: Array
    beside: Array
    outward: Array | None
    weights: Array | None = None

    @property
    def middle(self) -> Array:
        """Centroid (3,) of the patch in mm."""
        return self.shares @ self.points

    @property
    def shares(self) -> Array:
        """Fraction (M,) of the patch's area that each point represents."""
        return np.full(len(self.points), 1.0 / len(self.points)) if self.weights is None else self.weights

    def make_force(self, direction: Array, factors: Array | None = None) -> PointForces:
        """Return a force of 1 N in a direction (3,), spread evenly over the patch.

        With ``factors`` (M,), the force at each point is multiplied by its factor.
        """
        shares = self.shares if factors is None else self.shares * factors
        return PointForces(self.points, shares[:, None] * direction, self.outward)

    def read(self, direction: Array) -> PointForces:
        """Return the reading of the mean movement in a direction (3,) of the points beside the patch."""
        count = len(self.beside)
        return PointForces(self.beside, np.tile(direction / count, (count, 1)), self.outward)

    def make_unit_moment(self) -> PointForces:
        """Return forces whose moment about the vertical axis (z) through the patch's centroid is 1 N mm."""
        arms = self.points - self.middle
        forces = self.shares[:, None] * np.column_stack([-arms[:, 1], arms[:, 0], np.zeros(len(arms))])
        return PointForces(self.points, forces / self.compute_gyration(), self.outward)

    def compute_gyration(self) -> float:
        """Return the mean square distance in mm² of the patch's area from the vertical axis (z) through its
        middle.
        """
        arms = self.points - self.middle
        return float(self.shares @ (arms[:, :2] ** 2).sum(axis=1))


def compute_interval_middles(low: float, high: float, count: int) -> Array:
    """Return the middles of ``count`` equal pieces of an interval."""
    return low + (np.arange(count) + 0.5) / count * (high - low)


def make_strip(point: tuple[float, float], normal: tuple[float, float], low: float, high: float) -> LoadPatch:
    """Return the vertical strip of the surface on which a round peg presses.

    Parameters
    ----------
    point : contact point (x, y) in mm.
    normal : outward unit normal of the part at that point.
    low, high : heights in mm between which the peg presses.
    """
    along = (-normal[1], normal[0])
    heights = compute_interval_middles(low, high, max(ACROSS, ceil((high - low) / ALONG)))

    def shift_along(offsets: Array) -> Array:
        off, z = (one.ravel() for one in np.meshgrid(offsets, heights, indexing="ij"))
        return np.column_stack([point[0] + off * along[0], point[1] + off * along[1], z])

    half = PEG_WIDTH / 2
    return LoadPatch(
        shift_along(compute_interval_middles(-half, half, ACROSS)),
        shift_along(np.array([-half - BESIDE, half + BESIDE])),
        np.array([*normal, 0.0]),
    )


def make_disc(middle: Array, radius: float, outward: Array | None) -> LoadPatch:
    """Return a level disc: the patch of a pad, of a tip, or of a cutter on any side of the part.

    Parameters
    ----------
    middle : (3,) centre in mm.
    radius : in mm.
    outward : unit vector (3,) out of the part; None to take the side nearest to the points.
    """

    def ring(far: float, count: int) -> Array:
        angles = 2 * pi * (np.arange(count) + 0.5) / count
        return np.asarray(middle + [(far * cos(a), far * sin(a), 0.0) for a in angles])

    points = np.concatenate([ring(share * radius, count) for share, count in RINGS])
    return LoadPatch(points, ring(radius + BESIDE, AROUND), outward)


def make_rectangle(corner: Array, sides: tuple[Array, Array], spacing: float = ALONG) -> tuple[Array, Array]:
    """Return points (M, 3) spread evenly over a flat rectangle, and the area in mm² that each represents.

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


def find_foot_corners(nodes: Array, triangles: NDArray[np.int64], normals: Array, lowest: float) -> Array:
    """Return the corners (T, 3, 3) in mm of the triangles of the level faces on which a part lies.

    These are at the height ``lowest`` in mm. Nodes (N, 3), triangles (K, 6) and outward normals (K, 3) are
    those of a mesh's surface.
    """
    corners = nodes[triangles[:, :3]]
    is_foot = (normals[:, 2] < -0.999) & (np.abs(corners[:, :, 2] - lowest).max(axis=1) < 1e-3)
    return np.asarray(corners[is_foot])


def compute_areas(corners: Array) -> Array:
    """Return the areas (T,) in mm² of triangles with the corners (T, 3, 3)."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(np.linalg.norm(across, axis=1) / 2)


def make_foot(corners: Array) -> LoadPatch | None:
    """Return the patch of the level faces on which a part lies, given the corners (T, 3, 3) of their
    triangles; None for no triangles.
    """
    if not len(corners):
        return None
    areas, middles = compute_areas(corners), corners.mean(axis=1)
    return LoadPatch(middles, middles, np.array([0.0, 0.0, -1.0]), areas / areas.sum())


@frozen(eq=False)
class RestingFaces:
    """The level faces on which a part lies, cut into cells. A plate below touches each cell or does not.

    Parameters
    ----------
    corners : (T, 3, 3) corners of the faces' triangles in mm.
    cells : cells that cover the faces, about :data:`CELLS` squares.
    """

    corners: Array
    cells: tuple[LoadPatch, ...]

    @classmethod
    def from_corners(cls, corners: Array) -> RestingFaces:
        """Return the faces cut into squares, given the corners (T, 3, 3) of their triangles in mm."""
        side = float(np.sqrt(compute_areas(corners).sum() / CELLS))
        points, areas = sample_triangles(corners, side / ACROSS_CELL)
        squares = np.floor((points[:, :2] - points[:, :2].min(axis=0)) / side).astype(np.int64)
        return cls(corners, split_cells(points, areas, squares))

    def make_cells_under(
        self, tip: tuple[float, float], radius: float, height: float
    ) -> tuple[LoadPatch, ...]:
        """Return small cells under a tip, where the plate carries most of the tip's force.

        They are sectors of rings about the tip's axis, out to where the force spreads in the part.

        Parameters
        ----------
        tip : (x, y) of the tip's middle in mm.
        radius : of the tip in mm.
        height : of the face under the tip in mm.
        """
        ends = np.array([share * radius + part * height for share, part in UNDER_TIP])
        low, high = self.corners[:, :, :2].min(axis=1), self.corners[:, :, :2].max(axis=1)
        beside = np.maximum(np.maximum(low - tip, tip - high), 0.0)
        near = self.corners[np.hypot(*beside.T) < ends[-1]]
        if not len(near):
            return ()
        points, areas = sample_triangles(near, float(np.diff(ends, prepend=0.0).min()) / ACROSS_CELL)
        away = points[:, :2] - tip
        ring = np.searchsorted(ends, np.hypot(*away.T))
        sector = np.floor((np.arctan2(away[:, 1], away[:, 0]) / (2 * pi) + 0.5) * SECTORS).astype(np.int64)
        sector = np.where(ring == 0, 0, sector % SECTORS)
        inside = ring < len(ends)
        return split_cells(points[inside], areas[inside], np.column_stack([ring, sector])[inside])


def split_cells(points: Array, areas: Array, keys: NDArray[np.int64]) -> tuple[LoadPatch, ...]:
    """Return a patch for each distinct row of ``keys`` (M, 2), made of the points (M, 3) with that key.

    ``areas`` (M,) is the area in mm² that each point represents.
    """
    _, own = np.unique(keys, axis=0, return_inverse=True)
    own = own.ravel()
    patches = []
    for number in range(int(own.max()) + 1):
        some = own == number
        weights = areas[some] / areas[some].sum()
        patches.append(LoadPatch(points[some], points[some], np.array([0.0, 0.0, -1.0]), weights))
    return tuple(patches)


def sample_triangles(corners: Array, spacing: float) -> tuple[Array, Array]:
    """Return points (M, 3) spread over triangles, and the area in mm² that each represents.

    ``corners`` (T, 3, 3) are in mm. Each triangle is cut into similar triangles with sides of at most
    ``spacing`` mm; the points are their centroids.
    """
    points, areas = [], []
    for corner, area in zip(corners, compute_areas(corners).tolist(), strict=True):
        longest = np.linalg.norm(np.roll(corner, 1, axis=0) - corner, axis=1).max()
        pieces = max(1, ceil(float(longest) / spacing))
        rows = [
            (i + shift, j + shift)
            for shift, less in ((1 / 3, 0), (2 / 3, 1))
            for i in range(pieces - less)
            for j in range(pieces - less - i)
        ]
        first, second = np.array(rows).T / pieces
        shares = np.column_stack([1.0 - first - second, first, second])
        points.append(shares @ corner)
        areas.append(np.full(len(rows), area / len(rows)))
    return np.concatenate(points), np.concatenate(areas)
