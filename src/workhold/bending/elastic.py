"""A part as a free elastic body: the movement of its surface under sets of forces.

The displacement field u minimizes the energy of linear elasticity, with tetrahedra of the second order or the third. The
body is free, so its stiffness matrix K is singular: its null space are the six rigid motions R. Each load f is balanced
by forces that accelerate the body as if its mass were in the corners of the mesh, f - M R (R'MR)⁻¹ R'f, M that mass; in a
sum of loads that balance by themselves these cancel, wherever the mass is. Springs hold six freedoms at three nodes; no
force flows there then, however stiff they are. K with the springs is factorized once, and the mean rigid motion is taken
out of the answer. So the compliance C = P K⁻ P', P = 1 - R (R'MR)⁻¹ R'M, is symmetric and depends on none of the nodes
that are held (inertia relief; T. J. R. Hughes, *The Finite Element Method*, 1987, for the rest).

Loads and readings are both sums of forces at points of the surface, written as the work that they do on its
unknowns. The work of load A on the movement by load B equals the work of B on the movement by A (Maxwell and
Betti).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.bending.library import load_elements
from workhold.bending.meshing import PartMesh
from workhold.bending.surface import LATTICE, Footing, Surface
from workhold.model.elastic_material import ElasticMaterial

__all__ = ["ElasticBody", "PointForces", "make_rigid_motions"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@frozen(eq=False)
class PointForces:
    """Forces at points of the surface: a load, or a reading of a movement, whose value is the work of the
    forces on it.

    Parameters
    ----------
    points : (M, 3) in mm, on the surface or near it.
    forces : (M, 3) in N.
    outward : direction (3,) out of the part at the points; None where the nearest side counts.
    """

    points: Array
    forces: Array
    outward: Array | None = None

    @property
    def wrench(self) -> Array:
        """Force and moment about the origin (6,), in N and N mm."""
        moments = np.cross(self.points, self.forces)
        return np.concatenate([self.forces.sum(axis=0), moments.sum(axis=0)])


def make_rigid_motions(points: Array) -> Array:
    """Return movements (N, 3, 6) of points (N, 3) by unit shifts along x, y, z and unit turns about them."""
    x, y, z = points.T
    zero, one = np.zeros(len(points)), np.ones(len(points))
    shifts = [np.stack([one if k == axis else zero for k in range(3)], axis=1) for axis in range(3)]
    turns = [np.stack(parts, axis=1) for parts in ((zero, -z, y), (z, zero, -x), (-y, x, zero))]
    return np.stack([*shifts, *turns], axis=2)


# Sums over all unknowns, without the library of NumPy that spreads small work over threads and waits for them.


def project_on_columns(columns: Array, values: Array) -> Array:
    """Return the transpose of ``columns`` (n, 6) times ``values`` (n,): an array (6,)."""
    return np.asarray(np.einsum("nk,n->k", columns, values))


def combine_columns(columns: Array, factors: Array) -> Array:
    """Return ``columns`` (n, 6) times ``factors`` (6,): an array (n,)."""
    return np.asarray(np.einsum("nk,k->n", columns, factors))


@define(eq=False)
class ElasticBody:
    """A meshed part of a material; its stiffness matrix is factorized at first use.

    Parameters
    ----------
    mesh : mesh of the part.
    material : its material.
    order : order of the elements, 2 or 3.
    """

    mesh: PartMesh
    material: ElasticMaterial
    order: int = 2
    space: Any = field(init=False)
    scalar: Any = field(init=False)

    def __attrs_post_init__(self) -> None:
        solving = load_elements().solving
        self.space = solving.H1(self.mesh.made, order=self.order, dim=3)
        self.scalar = solving.H1(self.mesh.made, order=self.order)

    @property
    def unknowns(self) -> int:
        """Number of unknowns of the body, over all three components."""
        return 3 * int(self.scalar.ndof)

    @property
    def elements(self) -> int:
        """Number of tetrahedra."""
        return int(self.mesh.made.ne)

    @property
    def surface(self) -> Surface:
        """Surface of the mesh, with its nodes."""
        return self.mesh.surface

    @cached_property
    def surface_unknowns(self) -> tuple[IntArray, IntArray]:
        """Unknowns that move the surface, as (numbers, table).

        ``numbers`` (S,) are the body's unknowns of one component; ``table`` (F, D) has the D unknowns of each
        face as indices into ``numbers``.
        """
        solving = load_elements().solving
        rows = np.array([list(one.dofs) for one in self.scalar.Elements(solving.BND)], np.int64)
        used, numbers = np.unique(rows, return_inverse=True)
        return used, numbers.reshape(rows.shape)

    def compute_shapes(self, footing: Footing) -> Array:
        """Return the values (M, D) of the D shape functions of each point's face, at the M points of a
        footing.
        """
        solving = load_elements().solving
        faces = footing.faces.tolist()
        own = {face: self.scalar.GetFE(solving.ElementId(solving.BND, face)) for face in set(faces)}
        shares = zip(faces, footing.shares.tolist(), strict=True)
        values = [own[face].CalcShape(x, y) for face, (x, y, _) in shares]
        return np.array(values, np.float64).reshape(len(faces), -1)

    def compute_work(self, forces: PointForces, footing: Footing | None = None) -> Array:
        """Return the work (S, 3) that forces do per unit of each unknown of the surface.

        Parameters
        ----------
        footing : where the forces act on the surface; found here if None.
        """
        if footing is None:
            footing = self.surface.find_footing(forces.points, forces.outward)
        used, table = self.surface_unknowns
        work = np.zeros((len(used), 3))
        shapes = self.compute_shapes(footing)
        np.add.at(work, table[footing.faces], shapes[:, :, None] * forces.forces[:, None])
        return work

    def move_nodes(self, values: Array) -> Array:
        """Return the movement (N, 3) in mm of the surface's nodes, computed from the values (S, 3) of the
        surface's unknowns.
        """
        faces = self.surface.faces
        moved = np.empty((len(self.surface.nodes), 3))
        moved[faces.ravel()] = self.interpolate_movement(values, np.arange(len(faces)), LATTICE).reshape(
            -1, 3
        )
        return moved

    def interpolate_movement(self, values: Array, faces: IntArray, shares: Array) -> Array:
        """Return the movement (F, K, 3) in mm of points on F faces, computed from the values (S, 3) of the
        surface's unknowns.

        The points are at the barycentric coordinates ``shares`` (K, 3), the same on each face.
        """
        _, table = self.surface_unknowns
        kinds, first, own = self.kinds_of_faces
        there = np.tile(shares, (len(kinds), 1)), np.repeat(first, len(shares))
        shapes = self.compute_shapes(Footing(there[1], there[0])).reshape(len(kinds), len(shares), -1)
        return np.asarray(np.einsum("fkd,fdx->fkx", shapes[own[faces]], values[table[faces]]))

    @cached_property
    def kinds_of_faces(self) -> tuple[IntArray, IntArray, IntArray]:
        """Faces classified by their shape functions: (kinds, a face of each kind, kind (F,) of each face).

        The shape functions of a face depend only on the order of the numbers of its corners.
        """
        order = self.surface.vertices.argsort(axis=1)
        kinds, first, own = np.unique(order, axis=0, return_index=True, return_inverse=True)
        return kinds, first, own.ravel()

    def solve_loads(self, works: Sequence[Array]) -> Array:
        """Return the values (L, S, 3) of the surface's unknowns in mm under each of L loads by itself.

        Parameters
        ----------
        works : for each load, its work (S, 3) on the unknowns of the surface, see :meth:`compute_work`.
        """
        used, _ = self.surface_unknowns
        solver, load, answer = self.factorized
        motions, weighted, turning = self.motions
        out = np.empty((len(works), len(used), 3))
        for place, work in enumerate(works):
            full = np.zeros((int(self.scalar.ndof), 3))
            full[used] = work
            flat = full.reshape(-1)
            load.FV().NumPy()[:] = flat - combine_columns(
                weighted, turning @ project_on_columns(motions, flat)
            )
            answer.data = solver * load
            moved = answer.FV().NumPy()
            moved = moved - combine_columns(motions, turning @ project_on_columns(weighted, moved))
            out[place] = moved.reshape(-1, 3)[used]
        return out

    @cached_property
    def motions(self) -> tuple[Array, Array, Array]:
        """Rigid motions R about the middle of the bounding box as unknowns (3 n, 6), then M R, then the
        inverse of R'MR.

        For R and M see the head of this file; n is the number of unknowns of a component.
        """
        solving = load_elements().solving
        nodes = self.surface.nodes
        x, y, z = (
            axis - float(middle)
            for axis, middle in zip(
                (solving.x, solving.y, solving.z), (nodes.min(axis=0) + nodes.max(axis=0)) / 2, strict=True
            )
        )
        probe = solving.GridFunction(self.space)
        probe.Set(solving.CoefficientFunction((x, y, z)))
        places = probe.vec.FV().NumPy().reshape(-1, 3).copy()
        # The first unknowns are those of corners; a constant field has no others.
        is_corner = np.arange(len(places)) < int(self.mesh.made.nv)
        motions = make_rigid_motions(places)
        motions[:, :, :3] *= is_corner[:, None, None]
        motions = motions.reshape(-1, 6)
        weighted = motions * np.repeat(is_corner, 3)[:, None]
        return motions, weighted, np.asarray(np.linalg.inv(motions.T @ weighted), np.float64)

    @cached_property
    def factorized(self) -> tuple[Any, Any, Any]:
        """(factorized stiffness matrix with springs at six unknowns, vector for a load, vector for the
        solution).
        """
        solving = load_elements().solving
        modulus, ratio = self.material.elastic_modulus, self.material.poisson
        shear = modulus / (2 * (1 + ratio))
        volume = modulus * ratio / ((1 + ratio) * (1 - 2 * ratio))
        u, v = self.space.TnT()
        strain, tested = solving.Sym(solving.Grad(u)), solving.Sym(solving.Grad(v))
        form = solving.BilinearForm(self.space, symmetric=True)
        form += (
            2 * shear * solving.InnerProduct(strain, tested)
            + volume * solving.Trace(strain) * solving.Trace(tested)
        ) * solving.dx
        matrix = form.Assemble().mat
        for number, axis in self.choose_fixed_coordinates():
            block = matrix[number, number]
            entries = block.NumPy()
            entries[axis, axis] *= 2.0
            matrix[number, number] = block
        solver = matrix.Inverse(self.space.FreeDofs(), inverse="sparsecholesky")
        return solver, matrix.CreateColVector(), matrix.CreateColVector()

    def choose_fixed_coordinates(self) -> list[tuple[int, int]]:
        """Return six pairs (number of a corner, axis). Springs at them leave no rigid motion free.

        They are at three corners of the mesh that are far from each other.
        """
        vertices, at = np.unique(self.surface.vertices.ravel(), return_index=True)
        points = self.surface.corners.reshape(-1, 3)[at]
        first = int(np.linalg.norm(points - points.mean(axis=0), axis=1).argmax())
        second = int(np.linalg.norm(points - points[first], axis=1).argmax())
        along = points[second] - points[first]
        third = int(np.linalg.norm(np.cross(points - points[first], along), axis=1).argmax())
        rows = make_rigid_motions(points[[first, second, third]] - points.mean(axis=0))
        rows[:, :, 3:] /= np.linalg.norm(along)
        choices = [
            [(0, 0), (0, 1), (0, 2), *((1, axis) for axis in range(3) if axis != left), (2, last)]
            for left, last in product(range(3), repeat=2)
        ]
        best = min(choices, key=lambda chosen: np.linalg.cond([rows[node, axis] for node, axis in chosen]))
        nodes = (first, second, third)
        return [(int(vertices[nodes[node]]), axis) for node, axis in best]
