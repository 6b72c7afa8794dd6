"""A part as an elastic body that nothing holds: how its surface moves under forces, each set of them once solved.

The displacement field u minimizes the energy of linear elasticity, with second-order tetrahedra. The body is free, so
its stiffness matrix K is singular: its null space are the six rigid motions R. Each load f is balanced by forces that
accelerate the whole body, f - M R (R'MR)⁻¹ R'f, M the mass matrix; in a sum of loads that balance by themselves these
cancel. Six freedoms at three nodes are fixed, where no force flows then, K is factorized once, and the mean rigid
motion is taken out of the answer. So the compliance C = P K⁻ P', P = 1 - R (R'MR)⁻¹ R'M, is symmetric and depends on
none of the nodes that are fixed (inertia relief; T. J. R. Hughes, *The Finite Element Method*, 1987, for the rest).

Loads and readings are both sums of forces at points of the surface, written as the work they do on the nodes: what one
load moves another's points by is what the other moves the first one's by (Maxwell and Betti).
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
from workhold.bending.materials import ElasticMaterial
from workhold.bending.meshing import Surface
from workhold.errors import InputError

__all__ = ["ElasticBody", "PointForces", "rigid_motions"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# How far beside a patch the triangles are looked for that its points lie on, in mm, at first.
NEAR = 1.0
# The least cosine between a patch's outward direction and a triangle's normal: the other side of a thin wall is another.
ALIKE = 0.5


@frozen(eq=False)
class PointForces:
    """Forces at points of the surface, as a load, or as what is read of a movement: its work on them.

    Parameters
    ----------
    points : (M, 3) in mm, on the surface or near it.
    forces : (M, 3) in N.
    outward : direction out of the part there; None where any side may be the nearest.
    """

    points: Array
    forces: Array
    outward: Array | None = None

    @property
    def wrench(self) -> Array:
        """Force and moment about the origin (6,), in N and N mm."""
        moments = np.cross(self.points, self.forces)
        return np.concatenate([self.forces.sum(axis=0), moments.sum(axis=0)])


def rigid_motions(points: Array) -> Array:
    """Movements (N, 3, 6) of points (N, 3) by unit shifts along x, y, z and unit turns about them."""
    x, y, z = points.T
    zero, one = np.zeros(len(points)), np.ones(len(points))
    shifts = [np.stack([one if k == axis else zero for k in range(3)], axis=1) for axis in range(3)]
    turns = [np.stack(parts, axis=1) for parts in ((zero, -z, y), (z, zero, -x), (-y, x, zero))]
    return np.stack([*shifts, *turns], axis=2)


@frozen(eq=False)
class Footing:
    """Where points of the surface lie: in each a triangle and the weights of its six nodes.

    Parameters
    ----------
    triangles : (M,) numbers.
    weights : (M, 6).
    """

    triangles: IntArray
    weights: Array


@define(eq=False)
class ElasticBody:
    """A meshed part of a material, factorized when it is first asked.

    Parameters
    ----------
    mesh : of NGSolve.
    material : what it is of.
    """

    mesh: Any
    material: ElasticMaterial
    space: Any = field(init=False)
    scalar: Any = field(init=False)
    bubble: float = field(init=False)

    def __attrs_post_init__(self) -> None:
        solving = load_elements().solving
        self.space = solving.VectorH1(self.mesh, order=2)
        self.scalar = solving.H1(self.mesh, order=2)
        self.bubble = self.find_bubble()

    @property
    def unknowns(self) -> int:
        """How many there are."""
        return int(self.space.ndof)

    @property
    def elements(self) -> int:
        """How many tetrahedra there are."""
        return int(self.mesh.ne)

    def find_bubble(self) -> float:
        """Find what the shape function of an edge is over the product of its ends' coordinates."""
        solving = load_elements().solving
        probe = solving.GridFunction(self.scalar)
        element = next(iter(self.scalar.Elements(solving.BND)))
        probe.vec[element.dofs[3]] = 1.0
        middles = solving.IntegrationRule([(0.5, 0.5), (0.5, 0.0), (0.0, 0.5)], [0.0] * 3)
        values = np.array(probe(self.mesh.MapToAllElements(middles, solving.BND))).reshape(-1, 3)[0]
        return float(4.0 * values[np.abs(values).argmax()])

    @cached_property
    def surface(self) -> Surface:
        """The surface with its nodes."""
        return self.faces[0]

    @cached_property
    def faces(self) -> tuple[Surface, IntArray, IntArray]:
        """The surface, and of each of its nodes the unknown of a component, and the two corners of an edge's node.

        Corners have themselves twice for the last.
        """
        solving = load_elements().solving
        rows: list[list[int]] = []
        ends: dict[int, tuple[int, ...]] = {}
        for element in self.scalar.Elements(solving.BND):
            corners, edges = [v.nr for v in element.vertices], element.edges
            unknown = dict(zip(corners, element.dofs[:3], strict=True))
            middle = {}
            for edge, number in zip(edges, element.dofs[3:], strict=True):
                pair = frozenset(v.nr for v in self.mesh[edge].vertices)
                middle[pair] = number
                ends[number] = tuple(unknown[v] for v in sorted(pair))
            pairs = (corners[:2], corners[1:], corners[::2])
            rows.append([*element.dofs[:3], *(middle[frozenset(pair)] for pair in pairs)])
        table = np.array(rows, np.int64)
        points = [(1.0, 0.0), (0.0, 1.0), (0.0, 0.0), (0.5, 0.5), (0.0, 0.5), (0.5, 0.0)]
        rule = solving.IntegrationRule(points, [0.0] * 6)
        mapped = self.mesh.MapToAllElements(rule, solving.BND)
        places = np.array(solving.CoefficientFunction((solving.x, solving.y, solving.z))(mapped)).reshape(
            -1, 6, 3
        )
        facing = np.array(solving.specialcf.normal(3)(mapped)).reshape(-1, 6, 3).mean(axis=1)
        facing /= np.linalg.norm(facing, axis=1)[:, None]
        used, numbers = np.unique(table, return_inverse=True)
        triangles = numbers.reshape(table.shape)
        nodes = np.zeros((len(used), 3))
        nodes[triangles.ravel()] = places.reshape(-1, 3)
        a, b, c = np.moveaxis(nodes[triangles[:, :3]], 1, 0)
        inward = (np.cross(b - a, c - a) * facing).sum(axis=1) < 0
        triangles[inward] = triangles[inward][:, [0, 2, 1, 5, 4, 3]]
        both = np.array([ends.get(number, (number, number)) for number in used.tolist()], np.int64)
        return Surface(nodes, triangles, facing), used, both

    def find_footing(self, forces: PointForces) -> Footing:
        """Find the triangles that points lie on, and the weights of their nodes there."""
        surface, points, near = self.surface, forces.points, NEAR
        faces = (
            np.ones(len(surface.triangles), np.bool_)
            if forces.outward is None
            else surface.normals @ forces.outward > ALIKE
        )
        corners = surface.nodes[surface.triangles[:, :3]]
        low, high = corners.min(axis=1), corners.max(axis=1)
        while True:
            beside = (high >= points.min(axis=0) - near).all(axis=1) & (low <= points.max(axis=0) + near).all(
                axis=1
            )
            chosen = np.flatnonzero(faces & beside)
            if len(chosen):
                break
            near *= 2.0
            if near > 1e6:
                raise InputError(
                    "a contact lies on no face of the part that is meshed: give the STEP file or the thickness that belongs "
                    "to the result."
                )
        shares, distances = project_onto(points, corners[chosen])
        nearest = distances.argmin(axis=1)
        at = shares[np.arange(len(points)), nearest]
        a, b, c = at.T
        weights = np.stack(
            [a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * a * c], axis=1
        )
        return Footing(chosen[nearest], weights)

    def spread(self, forces: PointForces) -> Array:
        """The work (N, 3) that forces do on each node of the surface."""
        footing = self.find_footing(forces)
        work = np.zeros((len(self.surface.nodes), 3))
        for k in range(6):
            np.add.at(
                work,
                self.surface.triangles[footing.triangles, k],
                footing.weights[:, k, None] * forces.forces,
            )
        return work

    def respond(self, works: Sequence[Array]) -> Array:
        """How nodes of the surface move (L, N, 3) in mm under loads, each by itself; none turns or shifts the body.

        Parameters
        ----------
        works : of each load the work (N, 3) on the nodes, see :meth:`spread`.
        """
        count, nodes = self.scalar.ndof, len(self.surface.nodes)
        out = np.empty((len(works), nodes, 3))
        _, used, both = self.faces
        solver, load, answer = self.factorized
        for place, work in enumerate(works):
            full = np.zeros((3, count))
            is_edge = both[:, 0] != both[:, 1]
            # A node's value is half of its ends' sum and a quarter of the edge's own unknown times the bubble.
            full[:, used[~is_edge]] = work[~is_edge].T
            full[:, used[is_edge]] = work[is_edge].T * (self.bubble / 4.0)
            for end in range(2):
                np.add.at(full.T, both[is_edge, end], 0.5 * work[is_edge])
            flat = full.reshape(-1)
            flat = flat - self.weighted @ (self.turning @ (self.motions.T @ flat))
            load.FV().NumPy()[:] = flat
            answer.data = solver * load
            moved = answer.FV().NumPy().copy()
            moved -= self.motions @ (self.turning @ (self.weighted.T @ moved))
            field_ = moved.reshape(3, count).T
            values = field_[used]
            values[is_edge] = (
                0.5 * (field_[both[is_edge, 0]] + field_[both[is_edge, 1]])
                + self.bubble / 4.0 * field_[used[is_edge]]
            )
            out[place] = values
        return out

    @cached_property
    def motions(self) -> Array:
        """Rigid motions about the middle of the box (3 n, 6), as unknowns."""
        solving = load_elements().solving
        low = self.surface.nodes.min(axis=0)
        high = self.surface.nodes.max(axis=0)
        x, y, z = (
            axis - float(middle)
            for axis, middle in zip((solving.x, solving.y, solving.z), (low + high) / 2, strict=True)
        )
        fields = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0, -z, y), (z, 0, -x), (-y, x, 0)]
        probe = solving.GridFunction(self.space)
        columns = []
        for parts in fields:
            probe.Set(solving.CoefficientFunction(parts))
            columns.append(probe.vec.FV().NumPy().copy())
        return np.stack(columns, axis=1)

    @cached_property
    def weighted(self) -> Array:
        """Mass times the rigid motions (3 n, 6)."""
        solving = load_elements().solving
        u, v = self.space.TnT()
        mass = solving.BilinearForm(self.space, symmetric=True)
        mass += u * v * solving.dx
        mass.Assemble()
        given, taken = mass.mat.CreateColVector(), mass.mat.CreateColVector()
        columns = []
        for column in self.motions.T:
            given.FV().NumPy()[:] = column
            taken.data = mass.mat * given
            columns.append(taken.FV().NumPy().copy())
        return np.stack(columns, axis=1)

    @cached_property
    def turning(self) -> Array:
        """The inverse (6, 6) of the body's inertia."""
        return np.asarray(np.linalg.inv(self.motions.T @ self.weighted), np.float64)

    @cached_property
    def factorized(self) -> tuple[Any, Any, Any]:
        """The stiffness matrix without six freedoms, factorized, with room for a load and an answer."""
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
        form.Assemble()
        free = self.space.FreeDofs()
        for number in self.choose_fixed():
            free.Clear(number)
        solver = form.mat.Inverse(free, inverse="sparsecholesky")
        return solver, form.mat.CreateColVector(), form.mat.CreateColVector()

    def choose_fixed(self) -> list[int]:
        """Choose six unknowns at three corners of the mesh that leave the body no motion, far from each other."""
        _, used, both = self.faces
        corners = np.flatnonzero(both[:, 0] == both[:, 1])
        points = self.surface.nodes[corners]
        first = int(np.linalg.norm(points - points.mean(axis=0), axis=1).argmax())
        second = int(np.linalg.norm(points - points[first], axis=1).argmax())
        along = points[second] - points[first]
        third = int(np.linalg.norm(np.cross(points - points[first], along), axis=1).argmax())
        rows = rigid_motions(points[[first, second, third]] - points.mean(axis=0))
        rows[:, :, 3:] /= np.linalg.norm(along)
        choices = [
            [(0, 0), (0, 1), (0, 2), *((1, axis) for axis in range(3) if axis != left), (2, last)]
            for left, last in product(range(3), repeat=2)
        ]
        best = min(choices, key=lambda chosen: np.linalg.cond([rows[node, axis] for node, axis in chosen]))
        nodes, count = (first, second, third), self.scalar.ndof
        return [int(used[corners[nodes[node]]]) + axis * count for node, axis in best]


def project_onto(points: Array, corners: Array) -> tuple[Array, Array]:
    """The nearest points of triangles to points: shares of the corners (M, T, 3), and squared distances (M, T).

    Points are (M, 3), corners (T, 3, 3), in mm. What lies beside a triangle is laid on the nearest of its sides.
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
