"""The largest stress on the surface of a bent part, from how its surface moves.

Only contacts press on the surface, so elsewhere its stress is plane: it follows from the strain of the
surface along itself (S. P. Timoshenko, J. N. Goodier, *Theory of Elasticity*, chapter 2). In a wall that
bends, stress is largest on the surface. Von Mises stress is compared with the strength.

Stress is not evaluated under and beside contacts, nor beside sharp inner edges. There it grows without limit
as the mesh gets finer; real cutters leave a radius.
"""

from __future__ import annotations

from functools import cache, cached_property

import numpy as np
from attrs import define, frozen
from numpy.typing import NDArray

from workhold.bending.surface import LATTICE, Surface, find_lattice_node
from workhold.model.elastic_material import ElasticMaterial

__all__ = ["BESIDE_EDGES", "StressedSurface"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# Degree of the polynomials that the movement of a face is, at most, which its nodes fix.
DEGREE = 4
# How far beside sharp inner edges stress is looked at, in mm, how far apart their points are, and the least angle
# between the faces of a sharp edge, in degrees.
BESIDE_EDGES, EDGE_POINTS, SHARP = 1.0, 0.5, 25.0
# Where a face has less of its area at a node, over the mean, how it is stretched there is not known. What is added to
# lengths in mm that are divided by.
LEAST_AREA, TINY = 0.1, 1e-12


@frozen(eq=False)
class FaceDerivatives:
    """Matrices (15, 15) that turn values at the nodes of a face into derivatives there.

    Parameters
    ----------
    first, second : derivative by the first and by the second barycentric coordinate; the third one changes so
        that the sum stays 1.
    """

    first: Array
    second: Array


@cache
def make_derivatives() -> FaceDerivatives:
    """Return the matrices of derivatives at the nodes of ``LATTICE``."""
    a, b = LATTICE[:, 0], LATTICE[:, 1]
    powers = [(i, j) for i in range(DEGREE + 1) for j in range(DEGREE + 1 - i)]
    values = np.stack([a**i * b**j for i, j in powers], axis=1)
    by_first = np.stack([i * a ** max(i - 1, 0) * b**j for i, j in powers], axis=1)
    by_second = np.stack([j * a**i * b ** max(j - 1, 0) for i, j in powers], axis=1)
    inverse = np.linalg.inv(values)
    return FaceDerivatives(by_first @ inverse, by_second @ inverse)


def differentiate(values: Array) -> tuple[Array, Array]:
    """Return the derivatives (F, 15, 3), by the first and the second barycentric coordinate, of values (F, 15, 3)
    at the nodes of F faces.
    """
    own = make_derivatives()
    return np.einsum("pk,fkx->fpx", own.first, values), np.einsum("pk,fkx->fpx", own.second, values)


@define(eq=False)
class StressedSurface:
    """The surface of a mesh, prepared for the computation of stress on it.

    Parameters
    ----------
    surface : surface of the mesh, with F faces of 15 nodes each.
    material : material of the part.
    """

    surface: Surface
    material: ElasticMaterial

    @cached_property
    def places(self) -> Array:
        """Nodes (F, 15, 3) of each face in mm."""
        return self.surface.nodes[self.surface.faces]

    @cached_property
    def along(self) -> tuple[Array, Array]:
        """Tangents (F, 15, 3) at the nodes, by the first and the second barycentric coordinate."""
        return differentiate(self.places)

    @cached_property
    def normals(self) -> Array:
        """Outward unit normals (F, 15, 3) at the nodes of each face; the face's central normal at degenerate
        nodes.
        """
        across = np.cross(*self.along)
        middle = across.mean(axis=1, keepdims=True)
        size = np.linalg.norm(across, axis=2, keepdims=True)
        is_flat = size > LEAST_AREA * np.linalg.norm(middle, axis=2, keepdims=True)
        across = np.where(is_flat, across, middle)
        return np.asarray(across / np.linalg.norm(across, axis=2, keepdims=True))

    @cached_property
    def weights(self) -> Array:
        """Area (F, 15) of a face at each node, relative to the mean over its nodes; 0 at degenerate nodes.

        A node is degenerate where two sides of the face continue along one curve. Strain is not known there.
        """
        size = np.linalg.norm(np.cross(*self.along), axis=2)
        return np.where(size > LEAST_AREA * size.mean(axis=1, keepdims=True), size, 0.0)

    @cached_property
    def pairs(self) -> tuple[IntArray, IntArray]:
        """Pairs (P,), (P,) of entries, each numbered face times 15 plus node, that share a smooth node.

        Both entries of a pair are the same node of the mesh, and no sharp edge separates their faces. Each
        entry is also paired with itself.
        """
        node = self.surface.faces.ravel()
        order = np.argsort(node, kind="stable")
        sizes = np.bincount(node)
        most = int(sizes.max())
        starts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
        table = np.full((len(sizes), most), -1, np.int64)
        table[node[order], np.arange(len(node)) - starts[node[order]]] = order
        others = table[node]
        one, place = np.nonzero(others >= 0)
        other = others[one, place]
        normals = self.normals.reshape(-1, 3)
        is_smooth = (normals[one] * normals[other]).sum(axis=1) > np.cos(np.radians(SHARP))
        return one[is_smooth], other[is_smooth]

    @cached_property
    def inner_edges(self) -> Array:
        """Points (K, 3) in mm along all sharp inner edges of the surface, close to each other."""
        sides = np.array([find_lattice_node(2, 2), find_lattice_node(0, 2), find_lattice_node(2, 0)])
        corners = [find_lattice_node(4, 0), find_lattice_node(0, 4), find_lattice_node(0, 0)]
        node = self.surface.faces[:, sides].ravel()
        order = np.argsort(node, kind="stable")
        is_same = node[order[:-1]] == node[order[1:]]
        one, other = order[:-1][is_same], order[1:][is_same]
        middles = self.places.mean(axis=1)
        first, second = (self.normals[k // 3, sides[k % 3]] for k in (one, other))
        is_sharp = (first * second).sum(axis=1) < np.cos(np.radians(SHARP))
        is_inner = ((middles[other // 3] - middles[one // 3]) * first).sum(axis=1) > 0.0
        found = [np.zeros((0, 3))]
        for entry in one[is_sharp & is_inner].tolist():
            face, side = divmod(entry, 3)
            start, end = self.places[face, corners[side]], self.places[face, corners[(side + 1) % 3]]
            count = int(np.ceil(np.linalg.norm(end - start) / EDGE_POINTS)) + 1
            found.append(start + np.linspace(0.0, 1.0, count)[:, None] * (end - start))
        return np.concatenate(found)

    def compute_mises_stress(self, moved: Array) -> Array:
        """Return von Mises' stress (F, 15) in MPa at the nodes of each face, from the movement (N, 3) of the
        surface's nodes in mm.

        At a node the stress is the mean over all faces that meet there without a sharp edge between them.
        """
        first, second, shear, axes = self.compute_plane_stress(moved[self.surface.faces])
        x, y = axes
        whole = (
            first[..., None, None] * x[..., :, None] * x[..., None, :]
            + second[..., None, None] * y[..., :, None] * y[..., None, :]
            + shear[..., None, None] * (x[..., :, None] * y[..., None, :] + y[..., :, None] * x[..., None, :])
        ).reshape(-1, 9)
        one, other = self.pairs
        weights = self.weights.ravel()
        count = len(weights)
        total = np.bincount(one, weights[other], count)
        known = np.where(total > 0.0, total, 1.0)
        xx, xy, xz, _, yy, yz, _, _, zz = (
            np.bincount(one, weights[other] * whole[other, k], count) / known for k in range(9)
        )
        apart = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
        return np.sqrt(apart / 2 + 3 * (xy**2 + yz**2 + xz**2)).reshape(self.weights.shape)

    def compute_plane_stress(self, moved: Array) -> tuple[Array, Array, Array, tuple[Array, Array]]:
        """Return (along x, along y, shear, (x, y)) at the nodes of each face: stresses (F, 15) in MPa, and the unit
        vectors (F, 15, 3) along which they act.

        ``moved`` (F, 15, 3) is the movement of the nodes in mm.
        """
        along, moving = self.along, differentiate(moved)
        x = along[0] / np.maximum(np.linalg.norm(along[0], axis=2, keepdims=True), TINY)
        y = np.cross(self.normals, x)
        length, skew = (along[0] * x).sum(axis=2), (along[1] * x).sum(axis=2)
        high = (along[1] * y).sum(axis=2)
        high = np.where(self.weights > 0.0, high, 1.0)
        # Derivatives of the movement by lengths along x and y.
        by_x = moving[0] / np.maximum(length, TINY)[..., None]
        by_y = (moving[1] - skew[..., None] * by_x) / high[..., None]
        xx, yy = (by_x * x).sum(axis=2), (by_y * y).sum(axis=2)
        xy = ((by_x * y).sum(axis=2) + (by_y * x).sum(axis=2)) / 2
        modulus, ratio = self.material.elastic_modulus, self.material.poisson
        plane = modulus / (1 - ratio**2)
        return plane * (xx + ratio * yy), plane * (yy + ratio * xx), modulus / (1 + ratio) * xy, (x, y)
