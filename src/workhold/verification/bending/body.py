"""A part as an elastic body, solved for all loads of a fixture at once.

Three corners of the mesh are held, in six directions, so that nothing turns or slides; loads that balance
leave no force there. The displacement is a field of NGSolve, of which movements and gradients are read.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache, cached_property
from importlib import import_module
from math import sqrt
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from attrs import define, frozen
from numpy.typing import NDArray

from workhold.geometry.segment import Arc, Segment
from workhold.model.workpiece import Workpiece

__all__ = [
    "NODES",
    "SIX",
    "SMOOTH",
    "Body",
    "Field",
    "JudgedMesh",
    "Spread",
    "MeshError",
    "has_elements",
    "make_judged_mesh",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# The mesh that figures of a file are of: about so many tetrahedra, each of this share of the cube of its size, no larger
# than twice the least extent of the part, graded so; and what is tried next where the mesher fails.
TETRAHEDRA, SHARE, OF_EXTENT = 1000, 0.17, 2.0
# A sheet that so takes more than MOST has elements up to eight times its thickness, of which one layer has so many per
# square of their size.
MOST, OF_SHEET, PER_SQUARE, ROOM = 12_000, 8.0, 6.5, 0.8
GRADED = ((0.8, 0.8), (0.8, 1.0), (0.3, 2.0))
# Barycentric coordinates (15, 2) of the nodes of a face, in the order in which they are read.
NODES = np.array([(i, j) for i in range(5) for j in range(5 - i)], np.float64) / 4
# Of these the corners and the middles of the sides. How many faces near a point are looked at for it, in so many steps.
SIX = [
    int(np.abs(4 * NODES - one).sum(axis=1).argmin())
    for one in ((4, 0), (0, 4), (0, 0), (2, 2), (0, 2), (2, 0))
]
NEAREST, STEPS = 8, 8
# Directions in which the faces of one edge differ by less are those of a smooth surface: the cosine of 25 degrees.
SMOOTH = 0.9063
# Of the mean area at its nodes, what a face must have at one.
LEAST_AREA = 0.1


class MeshError(Exception):
    """A part whose mesh cannot be made; its message is a phrase that says why."""


@cache
def has_elements() -> bool:
    """Return whether NGSolve and Netgen are installed and can be loaded."""
    with suppress(ImportError):
        # Both libraries bring an Open CASCADE; loaded in this order they bear each other.
        import_module("OCP")
    try:
        import_module("ngsolve").SetNumThreads(1)
        import_module("netgen.meshing").SetMessageImportance(0)
    except ImportError:
        return False
    return True


def load(name: str) -> Any:
    """Return a module of the library."""
    return import_module(name)


def make_edges(segment: Segment, is_back: bool) -> list[Any]:
    """Return the edges of a segment at z = 0, from its start to its end or back; an arc has two."""
    shapes = load("netgen.occ")

    def point(x: float, y: float) -> Any:
        return shapes.Pnt(x, y, 0.0)

    ends = [point(*segment.start), point(*segment.end)]
    if not isinstance(segment, Arc):
        return [shapes.Segment(*(ends[::-1] if is_back else ends))]
    turns = segment.sign * segment.half_sweep * np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
    angles = segment.mid_angle + (turns[::-1] if is_back else turns)
    (x, y), radius = segment.center, segment.radius
    at = [point(x + radius * np.cos(angle), y + radius * np.sin(angle)) for angle in angles]
    last = at[0] if segment.is_full else ends[0 if is_back else 1]
    return [shapes.ArcOfCircle(*at[:3]), shapes.ArcOfCircle(at[2], at[3], last)]


def make_shape(part: Workpiece, thickness: float, kept: str | None) -> Any:
    """Return the part as a shape of the library: that of a solid's file, or a prism.

    ``kept`` is the text of the solid in Open CASCADE's form; None makes the prism.
    """
    shapes = load("netgen.occ")
    if kept is not None:
        with TemporaryDirectory(prefix="workhold-") as folder:
            place = Path(folder) / "solid.brep"
            place.write_text(kept, encoding="ascii")
            return shapes.OCCGeometry(str(place)).shape
    if part.pieces != 1:
        raise MeshError("the part is seen in several pieces")
    outer, *holes = part.loop_segments

    def fill(loop: Any, is_back: bool) -> Any:
        """Return the flat face inside a loop; ``is_back`` for one that runs clockwise."""
        edges = [make_edges(one, is_back) for one in (reversed(loop) if is_back else loop)]
        return shapes.Face(shapes.Wire([edge for several in edges for edge in several]))

    face = fill(outer, False)
    for hole in holes:
        face -= fill(hole, True)
    return face.Extrude(thickness * shapes.Z)


@contextmanager
def keep_quiet() -> Iterator[None]:
    """Throw away what the mesher writes to the process's outputs where it fails."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept, nowhere = [os.dup(1), os.dup(2)], os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(kept[0], 1)
        os.dup2(kept[1], 2)
        for number in (*kept, nowhere):
            os.close(number)


@define(eq=False)
class JudgedMesh:
    """A mesh with curved elements, and its surface of F triangular faces.

    Parameters
    ----------
    made : mesh of the library.
    """

    made: Any

    @cached_property
    def faces(self) -> IntArray:
        """Numbers (F, 3) of the corners of each face."""
        solving = load("ngsolve")
        return np.array([[v.nr for v in one.vertices] for one in self.made.Elements(solving.BND)], np.int64)

    @cached_property
    def corners(self) -> Array:
        """Corners (F, 3, 3) of each face in mm."""
        points = np.array([v.point for v in self.made.vertices])
        return np.asarray(points[self.faces])

    @cached_property
    def normals(self) -> Array:
        """Outward unit normals (F, 3) of the flat triangles through the corners."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        across = np.cross(b - a, c - a)
        return np.asarray(across / np.linalg.norm(across, axis=1)[:, None])

    @cached_property
    def nodes(self) -> Array:
        """Points (F, 15, 3) of each face in mm at ``NODES``."""
        return self.evaluate(load("ngsolve").CF(self.coordinates), NODES)

    @cached_property
    def facing(self) -> Array:
        """Outward unit normals (F, 15, 3) at the nodes of each face."""
        return self.evaluate(load("ngsolve").specialcf.normal(3), NODES)

    @cached_property
    def areas(self) -> Array:
        """Area (F, 15) that each face has at its nodes, per unit of its barycentric coordinates; 0 where it has next to
        none, so that how it is stretched there is not known.
        """
        sides = self.evaluate(load("ngsolve").specialcf.JacobianMatrix(3, 2), NODES)
        sides = sides.reshape(*sides.shape[:2], 3, 2)
        size = np.linalg.norm(np.cross(sides[..., 0], sides[..., 1]), axis=2)
        return np.where(size > LEAST_AREA * size.mean(axis=1, keepdims=True), size, 0.0)

    @cached_property
    def foot(self) -> Any:
        """Function that is 1 on the level faces at z = 0 that look down, 0 elsewhere."""
        solving = load("ngsolve")
        down = solving.specialcf.normal(3)[2]
        return solving.IfPos(-0.999 - down, 1.0, 0.0) * solving.IfPos(1e-3 - solving.z, 1.0, 0.0)

    def integrate_foot_products(self, center: Array) -> Array:
        """Return the integrals (3, 3) over the foot of the products of 1, and of x and y from ``center``."""
        solving = load("ngsolve")
        x, y, _ = self.coordinates
        terms = (solving.CF(1.0), x - float(center[0]), y - float(center[1]))
        return np.array(
            [
                [solving.Integrate(self.foot * one * other, self.made, solving.BND) for other in terms]
                for one in terms
            ]
        )

    @property
    def coordinates(self) -> tuple[Any, Any, Any]:
        solving = load("ngsolve")
        return solving.x, solving.y, solving.z

    def evaluate(self, function: Any, shares: Array) -> Array:
        """Return a function (F, K, D) at barycentric coordinates (K, 2) of each face."""
        solving = load("ngsolve")
        rule = solving.IntegrationRule([tuple(one) for one in shares.tolist()], [0.0] * len(shares))
        values = np.array(function(self.made.MapToAllElements(rule, solving.BND)))
        return values.reshape(len(self.faces), len(shares), -1)

    def project(self, points: Array, outward: Array | None) -> tuple[IntArray, Array]:
        """Return (faces (M,), barycentric coordinates (M, 2)) of the nearest points of the flat faces to points (M, 3).

        With ``outward`` (3,) only faces count whose normal is within 60 degrees of it.
        """
        own = np.arange(len(self.faces)) if outward is None else np.flatnonzero(self.normals @ outward > 0.5)
        if not len(own):
            raise MeshError("a contact lies on no face of the part")
        faces, shares = np.empty(len(points), np.int64), np.empty((len(points), 2))
        for number, point in enumerate(points):
            found = find_nearest(point, self.corners[own])
            away = ((np.einsum("fc,fck->fk", found, self.corners[own]) - point) ** 2).sum(axis=1)
            best = int(away.argmin())
            faces[number], shares[number] = own[best], found[best, :2]
        return faces, shares

    def locate(self, point: Array, own: IntArray | None = None) -> tuple[IntArray, Array, float]:
        """Return (face (1,), barycentric coordinates (1, 2), distance in mm) of the point of the curved faces nearest to
        a point (3,).

        Only the faces ``own`` are looked at; None for all.
        """
        own = np.arange(len(self.faces)) if own is None else own
        found = find_nearest(point, self.corners[own])
        away = np.linalg.norm(np.einsum("fc,fck->fk", found, self.corners[own]) - point, axis=1)
        best, least = (0, np.zeros(2)), np.inf
        for number in np.argsort(away)[:NEAREST].tolist():
            share, six = found[number, :2].copy(), self.nodes[own[number], SIX]
            for _ in range(STEPS):
                values, slopes = compute_quadratics(share)
                step, *_ = np.linalg.lstsq(six.T @ slopes, point - values @ six, rcond=None)
                share = np.clip(share + step, 0.0, 1.0)
                share /= max(share.sum(), 1.0)
            far = float(np.linalg.norm(compute_quadratics(share)[0] @ six - point))
            if far < least:
                best, least = (int(own[number]), share), far
        return np.array([best[0]]), best[1][None], least


def compute_quadratics(share: Array) -> tuple[Array, Array]:
    """Return (values (6,), slopes (6, 2)) of the quadratic functions of the nodes ``SIX`` at barycentric
    coordinates (2,).
    """
    a, b = share.tolist()
    c = 1.0 - a - b
    values = [a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * c * a]
    slopes = [
        (4 * a - 1, 0.0),
        (0.0, 4 * b - 1),
        (1 - 4 * c, 1 - 4 * c),
        (4 * b, 4 * a),
        (-4 * b, 4 * (c - b)),
        (4 * (c - a), -4 * a),
    ]
    return np.array(values), np.array(slopes)


def find_nearest(point: Array, corners: Array) -> Array:
    """Return the barycentric coordinates (T, 3) of the points of T triangles nearest to a point (3,).

    ``corners`` are (T, 3, 3). The plane's foot counts where it lies inside, else the nearest point of a side.
    """
    a, b, c = np.moveaxis(corners, 1, 0)
    across = np.cross(b - a, c - a)
    square = (across**2).sum(axis=1)
    inner = np.stack(
        [
            (np.cross(stop - start, point - start) * across).sum(axis=1) / square
            for start, stop in ((b, c), (c, a), (a, b))
        ],
        axis=1,
    )
    best, least = inner.copy(), np.where((inner >= 0.0).all(axis=1), 0.0, np.inf)
    for first, second in ((0, 1), (1, 2), (2, 0)):
        start, along = corners[:, first], corners[:, second] - corners[:, first]
        share = np.clip(((point - start) * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
        away = ((start + share[:, None] * along - point) ** 2).sum(axis=1)
        nearer = away < least
        least[nearer] = away[nearer]
        best[nearer] = 0.0
        best[nearer, first], best[nearer, second] = 1.0 - share[nearer], share[nearer]
    return best


def choose_size(volume: float, thin: float) -> float:
    """Return the size of elements in mm of a part with this volume in mm³ and least extent in mm.

    Raises
    ------
    MeshError
        For a sheet that takes too many.
    """
    most = float((volume / (SHARE * TETRAHEDRA)) ** (1 / 3))
    size = min(most, OF_EXTENT * thin)
    layer = PER_SQUARE * volume / thin if thin > 0.0 else np.inf
    if layer / size**2 > MOST:
        size = min(most, max(size, sqrt(layer / (ROOM * MOST))), OF_SHEET * thin)
    if layer / size**2 > MOST:
        raise MeshError("the part is a sheet that takes too many elements")
    return size


def make_judged_mesh(part: Workpiece, thickness: float, kept: str | None, finer: float = 1.0) -> JudgedMesh:
    """Return the mesh that figures of a file are of, or with ``finer`` above 1 one with smaller elements.

    Raises
    ------
    MeshError
        Where the mesher fails.
    """
    shapes, meshing = load("netgen.occ"), load("netgen.meshing")
    failures = (RuntimeError, meshing.NgException)
    try:
        shape = make_shape(part, thickness, kept)
        low, high = (np.array(list(corner)) for corner in shape.bounding_box)
        size = choose_size(float(shape.mass), float((high - low).min()))
        whole, made = shapes.OCCGeometry(shape), None
        for grading, curving in GRADED:
            with suppress(*failures), keep_quiet():
                made = whole.GenerateMesh(
                    maxh=size / finer,
                    grading=grading,
                    curvaturesafety=curving,
                    optsteps3d=2,
                    parallel_meshing=False,
                )
                break
    except failures as error:
        raise MeshError("the part cannot be meshed") from error
    if made is None or not made.ne:
        raise MeshError("the part cannot be meshed")
    curved = load("ngsolve").Mesh(made)
    curved.Curve(2)
    return JudgedMesh(curved)


@frozen(eq=False)
class Spread:
    """Forces (M, 3) in N on points of the surface, given by faces (M,) and barycentric coordinates (M, 2)."""

    faces: IntArray
    shares: Array
    forces: Array


@define(eq=False)
class Body:
    """A meshed part of a material, with elements of one order.

    Parameters
    ----------
    mesh : its mesh.
    modulus, ratio : Young's modulus in MPa and Poisson's ratio.
    order : 2 or 3.
    """

    mesh: JudgedMesh
    modulus: float
    ratio: float
    order: int

    @cached_property
    def space(self) -> Any:
        return load("ngsolve").VectorH1(self.mesh.made, order=self.order)

    @cached_property
    def scalar(self) -> Any:
        """Space of one component, of which the other space has three."""
        return load("ngsolve").H1(self.mesh.made, order=self.order)

    @cached_property
    def solver(self) -> Any:
        """Inverse of the stiffness matrix, with six unknowns held at 0."""
        solving = load("ngsolve")
        u, v = self.space.TnT()
        lame = self.modulus * self.ratio / ((1 + self.ratio) * (1 - 2 * self.ratio))
        energy = 2 * self.modulus / (2 + 2 * self.ratio) * solving.InnerProduct(
            solving.Sym(solving.Grad(u)), solving.Sym(solving.Grad(v))
        ) + lame * solving.div(u) * solving.div(v)
        form = solving.BilinearForm(self.space, symmetric=True)
        form += energy * solving.dx
        matrix = form.Assemble().mat
        free = solving.BitArray(self.space.ndof)
        free.Set()
        for vertex, axis in self.choose_fixed_coordinates():
            free[int(self.scalar.ndof) * axis + vertex] = False
        return matrix.Inverse(free, inverse="sparsecholesky")

    def choose_fixed_coordinates(self) -> list[tuple[int, int]]:
        """Return six pairs (corner, axis), at which springs leave no rigid motion free.

        The first corner has all three axes. The second has the two axes most nearly perpendicular to the line
        between both. The third, the corner farthest from that line, has the axis along which a turn about the
        line moves it most.
        """
        numbers = np.unique(self.mesh.faces)
        points = np.array([v.point for v in self.mesh.made.vertices])[numbers]
        first = int((points @ (1.0, 0.7, 0.4)).argmin())
        second = int(np.linalg.norm(points - points[first], axis=1).argmax())
        line = points[second] - points[first]
        third = int(np.linalg.norm(np.cross(points - points[first], line), axis=1).argmax())
        along = int(np.abs(line).argmax())
        across = [axis for axis in range(3) if axis != along]
        # A turn about the line moves the third corner along this axis most.
        spins = int(np.abs(np.cross(line, points[third] - points[first])).argmax())
        return [
            *((int(numbers[first]), axis) for axis in range(3)),
            *((int(numbers[second]), axis) for axis in across),
            (int(numbers[third]), spins),
        ]

    def make_vector(self, loads: list[Spread], pressures: tuple[float, float, float], center: Array) -> Array:
        """Return the work (3, n) of loads on the unknowns of each component.

        ``pressures`` (p, q, r) in MPa and MPa/mm press upward on the foot: p + q (x - center_x) + r (y - center_y).
        """
        solving = load("ngsolve")
        work = np.zeros((3, int(self.scalar.ndof)))
        for one in loads:
            for face, share, force in zip(one.faces.tolist(), one.shares.tolist(), one.forces, strict=True):
                numbers, values = self.compute_shapes(face, share)
                work[:, numbers] += force[:, None] * values
        p, q, r = pressures
        if any(pressures):
            x, y, _ = self.mesh.coordinates
            test = self.scalar.TestFunction()
            form = solving.LinearForm(self.scalar)
            affine = p + q * (x - float(center[0])) + r * (y - float(center[1]))
            form += self.mesh.foot * affine * test * solving.ds
            work[2] += form.Assemble().vec.FV().NumPy()
        return work

    def compute_shapes(self, face: int, share: list[float]) -> tuple[list[int], Array]:
        """Return (unknowns, their shape functions' values) at a point of a face."""
        solving = load("ngsolve")
        element = solving.ElementId(solving.BND, face)
        values = self.scalar.GetFE(element).CalcShape(*share, 0.0)
        return list(self.scalar.GetDofNrs(element)), np.array(values)

    def solve(self, work: Array) -> Field:
        """Return the displacement under the work (3, n) of loads that balance."""
        solving = load("ngsolve")
        moved = solving.GridFunction(self.space)
        right = moved.vec.CreateVector()
        right.FV().NumPy()[:] = work.reshape(-1)
        moved.vec.data = self.solver * right
        return Field(self, moved)


@define(eq=False)
class Field:
    """The displacement of a body.

    Parameters
    ----------
    body : the body.
    moved : field of the library, in mm.
    """

    body: Body
    moved: Any

    def read(self, faces: IntArray, shares: Array) -> Array:
        """Return the movement (M, 3) at points of faces (M,) at barycentric coordinates (M, 2)."""
        values = self.moved.vec.FV().NumPy().reshape(3, -1)
        out = []
        for face, share in zip(faces.tolist(), shares.tolist(), strict=True):
            numbers, shapes = self.body.compute_shapes(face, share)
            out.append(values[:, numbers] @ shapes)
        return np.array(out)

    def read_faces(self, shares: Array) -> Array:
        """Return the movement (F, K, 3) at barycentric coordinates (K, 2) of each face."""
        return self.body.mesh.evaluate(self.moved, shares)

    def integrate_foot(self, center: Array) -> Array:
        """Return the integrals (3,) over the foot of the rise, and of the rise times x and y from ``center``."""
        solving = load("ngsolve")
        x, y, _ = self.body.mesh.coordinates
        rise = self.body.mesh.foot * self.moved[2]
        arms = (1.0, x - float(center[0]), y - float(center[1]))
        mesh = self.body.mesh.made
        return np.array([solving.Integrate(rise * arm, mesh, solving.BND) for arm in arms])

    def compute_plane_tensors(self, shares: Array) -> Array:
        """Return the stress (F, K, 3, 3) in MPa in the plane of the surface, at barycentric coordinates (K, 2) of each
        face, from the gradient inside the elements beside it.

        Nothing presses there, so that the stress across the surface is 0.
        """
        solving, mesh = load("ngsolve"), self.body.mesh
        slopes = mesh.evaluate(solving.BoundaryFromVolumeCF(solving.Grad(self.moved)), shares)
        strain = slopes.reshape(*slopes.shape[:2], 3, 3)
        strain = (strain + np.swapaxes(strain, 2, 3)) / 2
        normal = mesh.evaluate(solving.specialcf.normal(3), shares)
        flat = np.eye(3) - normal[..., :, None] * normal[..., None, :]
        along = flat @ strain @ flat
        ratio = self.body.ratio
        spread = np.trace(along, axis1=2, axis2=3)[..., None, None] * flat
        return np.asarray(self.body.modulus / (1 + ratio) * (along + ratio / (1 - ratio) * spread))
