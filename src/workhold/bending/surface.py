"""The surface of a mesh: nodes, triangles fine enough to find the largest movement, and projection of points
onto it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.bending.library import load_elements
from workhold.errors import InputError

__all__ = ["LATTICE", "Footing", "Surface", "find_surface", "list_lattice", "find_lattice_node"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def list_lattice(pieces: int) -> Array:
    """Return barycentric coordinates (K, 3) of evenly spaced points of a triangle, its sides cut into
    ``pieces`` pieces.

    >>> list_lattice(1).tolist()
    [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]
    """
    whole = [(i, j, pieces - i - j) for i in range(pieces + 1) for j in range(pieces + 1 - i)]
    return np.array(whole, np.float64) / pieces


# Quarters of a face's barycentric coordinates at which its movement is looked at: its corners, three nodes of each side,
# and three inside.
LATTICE = list_lattice(4)
QUARTERS = np.rint(4 * LATTICE).astype(np.int64)
# How far beside a patch the faces are looked for that its points lie on, in mm, at first.
NEAR = 1.0
# Points of a patch whose faces are looked for at once: those that lie by each other mostly follow each other.
AT_ONCE = 64
# The least cosine between a patch's outward direction and a face's normal: the other side of a thin wall is another.
ALIKE = 0.5


@frozen(eq=False)
class Footing:
    """Places of M points on a surface: for each a face, and barycentric coordinates in it.

    Parameters
    ----------
    faces : (M,) indices of faces.
    shares : (M, 3) barycentric coordinates.
    """

    faces: IntArray
    shares: Array


@frozen(eq=False)
class Surface:
    """The surface of a mesh: F faces of elements, each also cut into four triangles of six nodes.

    Parameters
    ----------
    nodes : (N, 3) in mm.
    triangles : (4 F, 6) indices of nodes: three corners, counter-clockwise from outside, then the middles of
        the edges from first to second, second to third, and third to first corner.
    normals : (4 F, 3) outward unit normals.
    faces : (F, 15) indices of the nodes of each face, in the order of ``LATTICE``.
    vertices : (F, 3) the library's numbers of the corners of each face, counter-clockwise from outside.
    """

    nodes: Array
    triangles: IntArray
    normals: Array
    faces: IntArray
    vertices: IntArray

    @property
    def corners(self) -> Array:
        """Corners (F, 3, 3) of the faces, in mm."""
        return self.nodes[
            self.faces[:, [find_lattice_node(4, 0), find_lattice_node(0, 4), find_lattice_node(0, 0)]]
        ]

    def find_footing(self, points: Array, outward: Array | None) -> Footing:
        """Return the places on the surface nearest to points (M, 3): faces and barycentric coordinates.

        Parameters
        ----------
        outward : direction (3,) out of the part at the points, which the face's normal must roughly have;
            None where any side may be the nearest.

        Raises
        ------
        InputError
            When no face of the part points that way.
        """
        corners = self.corners
        facing = self.normals.reshape(len(corners), 4, 3).mean(axis=1)
        alike = np.arange(len(corners)) if outward is None else np.flatnonzero(facing @ outward > ALIKE)
        if not len(alike):
            raise InputError(
                "a contact lies on no face of the part that is meshed: give the STEP file or the thickness that belongs to "
                "the result."
            )
        low, high = corners[alike].min(axis=1), corners[alike].max(axis=1)
        faces, shares = np.empty(len(points), np.int64), np.empty((len(points), 3))
        for start in range(0, len(points), AT_ONCE):
            some = slice(start, start + AT_ONCE)
            least, most = points[some].min(axis=0), points[some].max(axis=0)
            near, chosen = NEAR, np.zeros(0, np.int64)
            while not len(chosen):
                beside = (high >= least - near).all(axis=1) & (low <= most + near).all(axis=1)
                chosen = alike[beside]
                near *= 2.0
            found, distances = project_onto(points[some], corners[chosen])
            nearest = distances.argmin(axis=1)
            faces[some], shares[some] = chosen[nearest], found[np.arange(len(nearest)), nearest]
        return Footing(faces, shares)

    def interpolate_points(self, faces: IntArray, shares: Array) -> Array:
        """Return the points (F, K, 3) in mm of curved faces at the barycentric coordinates ``shares`` (K, 3)."""
        a, b, c = shares.T
        weights = [a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * c * a]
        six = [find_lattice_node(*one) for one in ((4, 0), (0, 4), (0, 0), (2, 2), (0, 2), (2, 0))]
        return np.asarray(np.einsum("sk,fsx->fkx", np.array(weights), self.nodes[self.faces[faces][:, six]]))

    def place(self, footing: Footing) -> Array:
        """Return the points (M, 3) in mm of a footing, on the flat triangles through the corners of the
        faces.
        """
        return np.asarray(np.einsum("mc,mck->mk", footing.shares, self.corners[footing.faces]))


def find_lattice_node(first: int, second: int) -> int:
    """Return the index in ``LATTICE`` of the node with these barycentric coordinates, both in quarters."""
    return int(np.flatnonzero((QUARTERS[:, 0] == first) & (QUARTERS[:, 1] == second))[0])


def list_small_triangles() -> IntArray:
    """Return the four triangles (4, 6) that a face is cut into, as indices into ``LATTICE``."""
    rows = []
    for corners in (
        ((4, 0), (2, 2), (2, 0)),
        ((2, 2), (0, 4), (0, 2)),
        ((2, 0), (0, 2), (0, 0)),
        ((2, 2), (0, 2), (2, 0)),
    ):
        a, b, c = (np.array(one) for one in corners)
        rows.append([find_lattice_node(*one) for one in (a, b, c, (a + b) // 2, (b + c) // 2, (c + a) // 2)])
    return np.array(rows, np.int64)


def find_surface(mesh: Any) -> Surface:
    """Return the surface of a mesh of the library, whose faces run counter-clockwise from outside."""
    solving = load_elements().solving
    elements = list(mesh.Elements(solving.BND))
    vertices = np.array([[v.nr for v in one.vertices] for one in elements], np.int64)
    rule = solving.IntegrationRule([tuple(one) for one in LATTICE[:, :2].tolist()], [0.0] * len(LATTICE))
    mapped = mesh.MapToAllElements(rule, solving.BND)
    shape = (len(elements), len(LATTICE), 3)
    places = np.array(solving.CoefficientFunction((solving.x, solving.y, solving.z))(mapped)).reshape(shape)
    _, faces = np.unique(name_nodes(vertices, int(mesh.nv)), return_inverse=True)
    faces = faces.reshape(len(elements), len(LATTICE))
    nodes = np.zeros((int(faces.max()) + 1, 3))
    nodes[faces.ravel()] = places.reshape(-1, 3)
    triangles = faces[:, list_small_triangles()].reshape(-1, 6)
    a, b, c = np.moveaxis(nodes[triangles[:, :3]], 1, 0)
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return Surface(nodes, triangles, normals, faces, vertices)


def name_nodes(vertices: IntArray, count: int) -> IntArray:
    """Return integers (F, 15) that identify the nodes of F faces with vertices (F, 3): shared nodes have
    equal ones.

    At a corner or on an edge, the integer is computed from the numbers of the edge's corners and the node's
    position in quarters of the edge. Integers of nodes inside a face are negative.

    Parameters
    ----------
    count : number of all vertices of the mesh.
    """
    names = np.empty((len(vertices), len(LATTICE)), np.int64)
    for column, quarters in enumerate(QUARTERS.tolist()):
        ends = [k for k in range(3) if quarters[k]]
        if len(ends) == 3:
            names[:, column] = -1 - (np.arange(len(vertices)) * len(LATTICE) + column)
            continue
        a, b = ends[0], ends[-1]
        is_lower = vertices[:, a] <= vertices[:, b]
        low, high = np.minimum(vertices[:, a], vertices[:, b]), np.maximum(vertices[:, a], vertices[:, b])
        share = np.where(is_lower, quarters[a], quarters[b]) if a != b else 0
        names[:, column] = (low * count + high) * 4 + share
    return names


def project_onto(points: Array, corners: Array) -> tuple[Array, Array]:
    """Return the points of T triangles nearest to M points: barycentric coordinates (M, T, 3), squared
    distances (M, T).

    Points are (M, 3) and corners (T, 3, 3), in mm. A point beside a triangle is projected onto the nearest
    side.
    """
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, ac = b - a, c - a
    d00, d01, d11 = (ab * ab).sum(axis=1), (ab * ac).sum(axis=1), (ac * ac).sum(axis=1)
    from_a = points[:, None] - a
    d20, d21 = np.einsum("mtk,tk->mt", from_a, ab), np.einsum("mtk,tk->mt", from_a, ac)
    area = d00 * d11 - d01 * d01
    second, third = (d11 * d20 - d01 * d21) / area, (d00 * d21 - d01 * d20) / area
    shares = np.stack([1.0 - second - third, second, third], axis=2)
    outside = (shares < 0.0).any(axis=2)
    if outside.any():
        best = np.full(outside.shape, np.inf)
        for first, last in ((0, 1), (1, 2), (2, 0)):
            start, side = corners[:, first], corners[:, last] - corners[:, first]
            from_start = points[:, None] - start
            along = np.clip(np.einsum("mtk,tk->mt", from_start, side) / (side * side).sum(axis=1), 0.0, 1.0)
            away = ((from_start - along[..., None] * side) ** 2).sum(axis=2)
            nearer = outside & (away < best)
            best[nearer] = away[nearer]
            clipped = np.zeros_like(shares)
            clipped[..., first], clipped[..., last] = 1.0 - along, along
            shares[nearer] = clipped[nearer]
    there = np.einsum("mtc,tck->mtk", shares, corners)
    return shares, ((points[:, None] - there) ** 2).sum(axis=2)
