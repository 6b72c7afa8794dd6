"""Whether the bending that a file states of its fixtures is right.

Each figure is computed in two ways. On the mesh that the file's figures are of, made anew, they must come out
the same, with their error. On a finer mesh the movement at the stated place must lie within the stated error.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from math import cos, isfinite, pi, sin

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.geometry.segment import measure_distance_to_segment
from workhold.model.elastic_material import MATERIALS
from workhold.model.fixture import Fixture
from workhold.model.part_bending import BendingFigures
from workhold.model.query import Query
from workhold.model.requirements import Load
from workhold.verification.bending.body import (
    NODES,
    SIX,
    SMOOTH,
    Body,
    Field,
    JudgedMesh,
    MeshError,
    Spread,
    make_judged_mesh,
)
from workhold.verification.bending.pressed import (
    BESIDE,
    LevelDisc,
    PressedSetup,
    find_usual_force,
    make_level_disc,
    make_pressed_setup,
)
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.tolerances import Finding

__all__ = ["BendingJudge"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Mask = NDArray[np.bool_]
UP = np.array([0.0, 0.0, 1.0])
# Figures of the same mesh agree to this share, errors to this share of themselves and of their figure, and both to so
# many mm or MPa.
SAME, SAME_ERROR, NOTHING = 0.01, 0.05, 1e-6
# Of a mesh with more elements a finer one would take minutes.
MOST_FOR_FINER = 6000
# How much finer the second mesh is, and by what share of a movement it may be beyond the stated error.
FINER, BEYOND = 1.5, 0.01
# What is added to twice the change of a stress, of it; radius of a load's disc in mm; directions of its range; how many
# places of loads are looked at beside the stated one.
OF_STRESS, LOAD_RADIUS, DIRECTIONS, MOST_PLACES = 0.1, 2.0, 24, 4
# How far beside sharp inner edges stress counts, how near a node of the mesh and a face of the outline a point is that
# lies there, in mm.
BESIDE_EDGES, AT_NODE, ON_FACE = 1.0, 0.01, 0.02
# Nodes with the largest stress by one face alone that are looked at.
MOST_STRESSED = 40


@define(eq=False)
class Clamped:
    """A fixture's part under a load, with the motion that lays it against its locators.

    Parameters
    ----------
    moved : displacement of the held body.
    motion : (6,) shifts in mm, then turns in radians about the origin.
    """

    moved: Field
    motion: Array

    def read(self, faces: IntArray, shares: Array, at: Array) -> Array:
        """Return the movement (M, 3) at points ``at`` (M, 3) that are given on faces as well."""
        return self.moved.read(faces, shares) + move_rigidly(self.motion, at)

    @cached_property
    def at_nodes(self) -> Array:
        """Movement (F, 15, 3) at the nodes of all faces."""
        nodes = self.moved.body.mesh.nodes
        return self.moved.read_faces(NODES) + move_rigidly(self.motion, nodes)

    @cached_property
    def tensors(self) -> Array:
        """Stress (F, 15, 3, 3) in MPa in the plane of the surface, at the nodes of each face."""
        return self.moved.compute_plane_tensors(NODES)


def move_rigidly(motion: Array, points: Array) -> Array:
    """Return the movement of points (..., 3) by a rigid motion (6,)."""
    return np.asarray(motion[:3] + np.cross(motion[3:], points))


def compute_mises(tensor: Array) -> Array:
    """Return von Mises' stress of tensors (..., 3, 3)."""
    deviator = tensor - np.trace(tensor, axis1=-2, axis2=-1)[..., None, None] / 3 * np.eye(3)
    return np.asarray(np.sqrt(1.5 * (deviator**2).sum(axis=(-2, -1))))


def is_apart(stated: float, found: float, share: float, of: float = 0.0) -> bool:
    """Return whether a stated figure differs from a found one by more than a share of it, and of ``of``."""
    return abs(stated - found) > share * abs(found) + SAME / 5 * of + NOTHING


@define(eq=False)
class BendingJudge:
    """Judge of the bending of the fixtures of a query.

    Parameters
    ----------
    query : what was asked.
    kept : the solid in Open CASCADE's own form; None for a drawn part.
    meshes : meshes made so far, by thickness and how much finer they are; a sentence where none can be made.
    bodies : bodies made so far, by mesh, material and order.
    """

    query: Query
    kept: str | None = None
    meshes: dict[tuple[float, float], JudgedMesh | str] = field(factory=dict, init=False)
    bodies: dict[tuple[float, float, float, float, int], Body] = field(factory=dict, init=False)
    feet: dict[int, tuple[Array, Array]] = field(factory=dict, init=False)

    @cached_property
    def hardware(self) -> ToolkitRules:
        return ToolkitRules.from_query(self.query)

    def judge(self, fixture: Fixture, told: BendingFigures, is_whole: bool = True) -> Iterator[Finding]:
        """Yield a finding for each thing that is wrong, or may be, with the bending stated of a fixture.

        Where ``is_whole`` is False nothing is computed again.
        """
        yield from self.judge_statement(told)
        if not is_whole:
            return
        mesh = self.find_mesh(told, 1.0)
        is_large = isinstance(mesh, JudgedMesh) and int(mesh.made.ne) > MOST_FOR_FINER
        fine = 1.0 if is_large else FINER
        finer = self.find_mesh(told, fine)
        if isinstance(mesh, str) or isinstance(finer, str):
            yield Finding(
                False, f"its bending was not computed again: {mesh if isinstance(mesh, str) else finer}"
            )
            return
        try:
            yield from self.judge_on(fixture, told, mesh, finer, fine)
        except MeshError as error:
            yield Finding(True, f"its bending cannot be computed: {error}")

    def judge_on(
        self, fixture: Fixture, told: BendingFigures, mesh: JudgedMesh, finer: JudgedMesh, fine: float
    ) -> Iterator[Finding]:
        """Yield the findings of figures, on the mesh that they are of and on a finer one.

        ``fine`` says how much finer that is; 1 for a part that takes too many elements for that.
        """
        setting = make_pressed_setup(fixture, self.query, self.hardware, told)
        is_same = int(mesh.made.ne) == told.elements
        if is_same:
            second, third = (self.clamp(self.find_body(told, 1.0, order), setting, told) for order in (2, 3))
            yield from self.judge_distortion(told, setting, second, third)
            yield from self.judge_stress(told, setting, second, third)
            yield from self.judge_give(fixture, told, setting)
        exact = self.clamp(self.find_body(told, fine, 3), setting, told)
        at = np.array([told.clamp_distortion.at])
        moved = float(np.linalg.norm(exact.read(*finer.locate(at[0])[:2], at)))
        stated = told.clamp_distortion
        if abs(stated.value - moved) > stated.error + BEYOND * moved + NOTHING:
            yield Finding(
                True,
                f"clamp_distortion is given as {stated.value:g} mm, give or take {stated.error:g}, and on a finer mesh "
                f"it is {moved:.6g} mm there",
            )
        if not is_same:
            yield Finding(
                False,
                f"its mesh has {told.elements} elements, and the one made here {mesh.made.ne}, so that only "
                "clamp_distortion was held to its error; another version of NGSolve makes another mesh",
            )

    def judge_statement(self, told: BendingFigures) -> Iterator[Finding]:
        """Yield a finding for each contradiction between the bending and the query, or the table of materials."""
        usual, material = MATERIALS.get(told.material.name), told.material
        if usual is not None and usual != material:
            yield Finding(True, f"the numbers of its material are not those of {material.name}")
        parts = material.name.split(",")
        if len(parts) > 1:
            numbers = (material.elastic_modulus, material.poisson, material.strength)
            try:
                named = tuple(map(float, parts))
            except ValueError:
                named = ()
            if named and named != numbers[: len(named)]:
                yield Finding(True, f"the numbers of its material are not {material.name}")
        if told.is_assumed and (told.jaw_force != find_usual_force() or self.query.jaw_force is not None):
            yield Finding(True, "its jaw force is said to be a convention, and is none")
        solid = self.query.workpiece.solid
        if solid is not None and abs(solid.height - told.thickness) > NOTHING:
            yield Finding(
                True, f"it is bent {told.thickness:g} mm thick, and the part has {solid.height:g} mm"
            )
        known = {face.number for face in self.query.workpiece.faces} | {"top", "bottom"}
        if unknown := [face for face in told.faces if face not in known]:
            yield Finding(True, f"face {unknown[0]} to be cut does not exist")
        program = self.query.program
        forces = None if program is None else program.forces
        # Tools that touch nothing press on nothing.
        acts = bool(self.query.loads) or (forces is not None and len(forces.stretches.move) > 0)
        if (told.give is not None) != acts:
            yield Finding(True, "how far it gives is missing" if acts else "it gives where nothing acts")

    def find_mesh(self, told: BendingFigures, finer: float) -> JudgedMesh | str:
        """Return a mesh of the part, or a phrase that says why there is none."""
        key = (told.thickness, finer)
        if key not in self.meshes:
            try:
                self.meshes[key] = make_judged_mesh(self.query.workpiece, told.thickness, self.kept, finer)
            except MeshError as error:
                self.meshes[key] = str(error)
        return self.meshes[key]

    def find_body(self, told: BendingFigures, finer: float, order: int) -> Body:
        """Return the part as an elastic body with elements of an order."""
        modulus, ratio = told.material.elastic_modulus, told.material.poisson
        key = (told.thickness, finer, modulus, ratio, order)
        if key not in self.bodies:
            mesh = self.find_mesh(told, finer)
            assert isinstance(mesh, JudgedMesh)
            self.bodies[key] = Body(mesh, modulus, ratio, order)
        return self.bodies[key]

    def find_foot(self, body: Body) -> tuple[Array, Array]:
        """Return (centre (3,), matrix (3, 3)) of the level faces that the part lies on.

        The matrix has the integrals over them of products of 1, and of x and y from the centre.
        """
        key = id(body.mesh)
        if key not in self.feet:
            area, by_x, by_y = body.mesh.integrate_foot_products(np.zeros(3))[0].tolist()
            if not area > 0.0:
                raise MeshError("the part has no level face that it lies on")
            center = np.array([by_x / area, by_y / area, 0.0])
            self.feet[key] = center, body.mesh.integrate_foot_products(center)
        return self.feet[key]

    def clamp(self, body: Body, setting: PressedSetup, told: BendingFigures) -> Clamped:
        """Return the part under its clamps, at the stated force."""
        forces = np.array([told.jaw_force * strip.share for strip in setting.strips])
        others: list[tuple[Array, Array, Array | None]] = []
        if setting.tip is not None:
            points = setting.tip.points
            others.append((points, np.tile(-setting.tip_force * UP / len(points), (len(points), 1)), UP))
        return self.press(body, setting, forces, others, np.zeros(len(forces)))

    def press(
        self,
        body: Body,
        setting: PressedSetup,
        forces: Array,
        others: list[tuple[Array, Array, Array | None]],
        gives: Array,
    ) -> Clamped:
        """Return the part under forces of its pegs (P,), and under others, as it then lies against its locators.

        Parameters
        ----------
        others : points (M, 3), forces (M, 3) in N, and outward direction of each.
        gives : (P,) how far each peg gives way, in mm.
        """
        loads = [
            (
                strip.points,
                np.tile(-force * strip.outward / len(strip.points), (len(strip.points), 1)),
                strip.outward,
            )
            for strip, force in zip(setting.strips, forces.tolist(), strict=True)
        ] + others
        down = sum(float(force[:, 2].sum()) for _, force, _ in loads)
        moments = sum(np.cross(points, force).sum(axis=0) for points, force, _ in loads)
        pressures, center = (0.0, 0.0, 0.0), np.zeros(3)
        if setting.pads:
            middles = np.array([pad.middle for pad in setting.pads])
            rows = np.stack([np.ones(3), middles[:, 1], -middles[:, 0]])
            borne = np.linalg.solve(rows, -np.array([down, moments[0], moments[1]]))
            for pad, force in zip(setting.pads, borne.tolist(), strict=True):
                count = len(pad.points)
                loads.append((pad.points, np.tile(force * UP / count, (count, 1)), -UP))
        else:
            center, matrix = self.find_foot(body)
            about = moments - np.cross(center, [0.0, 0.0, down])
            p, q, r = np.linalg.solve(matrix, [-down, about[1], -about[0]]).tolist()
            pressures = (p, q, r)
        spread = [Spread(*body.mesh.project(points, outward), force) for points, force, outward in loads]
        moved = body.solve(body.make_vector(spread, pressures, center))
        return Clamped(moved, self.lay(body, setting, moved, gives))

    def lay(self, body: Body, setting: PressedSetup, moved: Field, gives: Array) -> Array:
        """Return the rigid motion (6,) that lays a bent part against its locators.

        What moves with a jaw or a clamp follows the part. The system is as large as what it is solved for.
        """
        size = float(np.ptp(body.mesh.nodes.reshape(-1, 3), axis=0).max())
        rows, values = [], []

        def add(points: Array, direction: Array, read: float, value: float, ways: Array) -> None:
            """Add the equation that a mean movement, ``read`` by bending, is ``value`` along a direction."""
            middle = points.mean(axis=0)
            turns = np.cross(middle, direction) / size
            rows.append(np.concatenate([direction, turns, -ways]))
            values.append(value - read)

        for strip, give in zip(setting.strips, gives.tolist(), strict=True):
            faces, shares = body.mesh.project(strip.beside, strip.outward)
            ways = np.zeros(setting.movers)
            if strip.mover is not None:
                ways[strip.mover] = strip.outward @ strip.way
            read = float(moved.read(faces, shares).mean(axis=0) @ strip.outward)
            add(strip.beside, strip.outward, read, give, ways)
        still = np.zeros(setting.movers)
        if setting.pads:
            for pad in setting.pads:
                read = float(moved.read(*body.mesh.project(pad.beside, -UP))[:, 2].mean())
                add(pad.beside, UP, read, 0.0, still)
        else:
            center, matrix = self.find_foot(body)
            rise, by_x, by_y = np.linalg.solve(matrix, moved.integrate_foot(center)).tolist()
            # The plane nearest to the foot is level and at 0.
            for row, value in (
                (np.concatenate([UP, np.cross(center, UP) / size]), -rise),
                (np.array([0, 0, 0, 0, -1 / size, 0]), -by_x),
                (np.array([0, 0, 0, 1 / size, 0, 0]), -by_y),
            ):
                scale = 1.0 if row[2] else size
                rows.append(np.concatenate([row * scale, still]))
                values.append(value * scale)
        found, *_ = np.linalg.lstsq(np.array(rows), np.array(values), rcond=1e-9)
        return np.concatenate([found[:3], found[3:6] / size])

    def judge_distortion(
        self, told: BendingFigures, setting: PressedSetup, second: Clamped, third: Clamped
    ) -> Iterator[Finding]:
        """Yield a finding where the stated movement by clamping, its error or its place is wrong."""
        stated, mesh = told.clamp_distortion, third.moved.body.mesh
        at = np.array([stated.at])
        faces, shares, _ = mesh.locate(at[0])
        after, before = (one.read(faces, shares, at)[0] for one in (third, second))
        value, change = float(np.linalg.norm(after)), float(np.linalg.norm(after - before))
        yield from judge_figure("clamp_distortion", "mm", stated.value, value)
        if is_apart(stated.error, 2 * change, SAME_ERROR, stated.value):
            yield Finding(
                True,
                f"the error of clamp_distortion is given as {stated.error:g} mm, and is {2 * change:.6g} mm",
            )
        counts = self.find_cut(told, mesh)
        is_cut = mesh.locate(at[0], np.flatnonzero(counts.all(axis=1)))[2] < AT_NODE
        if not is_cut or measure_nearest(at, setting.pressed)[0] < BESIDE - AT_NODE:
            yield Finding(True, "clamp_distortion is stated at a place that does not count")
        sizes = np.where(counts, np.linalg.norm(third.at_nodes, axis=2), 0.0)
        most = self.find_most(sizes, mesh, setting.pressed, stated.value * (1 + SAME) + NOTHING)
        if most is not None:
            yield Finding(
                True,
                f"clamp_distortion is given as {stated.value:g} mm, and at {most[1]} it is {most[0]:.6g} mm",
            )

    def find_most(
        self, sizes: Array, mesh: JudgedMesh, pressed: Array, limit: float
    ) -> tuple[float, str] | None:
        """Return the first of the largest sizes (F, 15) at nodes above a limit that is not beside a pressed point, and
        its place in words; None where there is none.
        """
        above = np.argwhere(sizes > limit)
        if not len(above):
            return None
        points = mesh.nodes[above[:, 0], above[:, 1]]
        left = measure_nearest(points, pressed) >= BESIDE
        if not left.any():
            return None
        best = above[left][sizes[above[left][:, 0], above[left][:, 1]].argmax()]
        place = ", ".join(f"{value:.3f}" for value in mesh.nodes[best[0], best[1]])
        return float(sizes[best[0], best[1]]), f"({place})"

    def find_cut(self, told: BendingFigures, mesh: JudgedMesh) -> Mask:
        """Return which nodes (F, 15) are on faces to be cut; all where none is named."""
        counts = np.zeros(mesh.nodes.shape[:2], np.bool_)
        if not told.faces:
            return ~counts
        upward = mesh.normals[:, 2]
        segments = {face.number: face.segment for face in self.query.workpiece.faces}
        for face in told.faces:
            if isinstance(face, str):
                counts[upward * (1.0 if face == "top" else -1.0) > 0.999] = True
                continue
            for row in np.flatnonzero(np.abs(upward) < 0.5).tolist():
                counts[row] |= np.array(
                    [
                        measure_distance_to_segment((x, y), segments[face]) < ON_FACE
                        for x, y, _ in mesh.nodes[row].tolist()
                    ]
                )
        return counts

    def judge_stress(
        self, told: BendingFigures, setting: PressedSetup, second: Clamped, third: Clamped
    ) -> Iterator[Finding]:
        """Yield a finding where the stated stress, its error or its place is wrong."""
        stated, mesh = told.stress, third.moved.body.mesh
        at = np.array(stated.at)
        away = np.linalg.norm(mesh.nodes - at, axis=2)
        face, node = (int(one) for one in np.unravel_index(int(away.argmin()), away.shape))
        if away[face, node] > AT_NODE:
            yield Finding(True, "the stress is stated at a place that is no node of the surface")
            return
        inner = find_inner_edges(mesh)
        near = measure_nearest(at[None], setting.pressed)[0] < BESIDE - AT_NODE
        if near or (len(inner) and measure_nearest(at[None], inner)[0] < BESIDE_EDGES - 0.3):
            yield Finding(True, "the stress is stated at a place that does not count")
        pairs = list(average_at(mesh, third.tensors, second.tensors, mesh.nodes[face, node]))
        value, other = min(pairs, key=lambda pair: abs(pair[0] - stated.value))
        yield from judge_figure("stress", "MPa", stated.value, value)
        error = 2 * abs(value - other) + OF_STRESS * value
        if is_apart(stated.error, error, SAME_ERROR, stated.value):
            yield Finding(
                True, f"the error of the stress is given as {stated.error:g} MPa, and is {error:.6g} MPa"
            )
        sizes = compute_mises(third.tensors)
        sizes[self.find_pressed_faces(mesh, setting)] = 0.0
        limit = stated.value * (1 + SAME) + NOTHING
        for number in np.argsort(-sizes, axis=None)[:MOST_STRESSED].tolist():
            row, column = divmod(number, sizes.shape[1])
            point = mesh.nodes[row, column]
            if sizes[row, column] <= limit:
                break
            if measure_nearest(point[None], setting.pressed)[0] < BESIDE + AT_NODE:
                continue
            if len(inner) and measure_nearest(point[None], inner)[0] < BESIDE_EDGES + 0.3:
                continue
            most = min(one for one, _ in average_at(mesh, third.tensors, second.tensors, point))
            if most > limit:
                place = ", ".join(f"{value:.3f}" for value in point)
                yield Finding(
                    True,
                    f"the stress is given as {stated.value:g} MPa, and at ({place}) it is {most:.6g} MPa",
                )
                return

    def find_pressed_faces(self, mesh: JudgedMesh, setting: PressedSetup) -> IntArray:
        """Return the faces on which something presses."""
        found = [mesh.project(strip.points, strip.outward)[0] for strip in setting.strips]
        found += [mesh.project(pad.points, -UP)[0] for pad in setting.pads]
        found += [] if setting.tip is None else [mesh.project(setting.tip.points, UP)[0]]
        return np.unique(np.concatenate(found))

    def judge_give(self, fixture: Fixture, told: BendingFigures, setting: PressedSetup) -> Iterator[Finding]:
        """Yield a finding where it is wrong how far a load makes the part give; a program's cuts are not looked at."""
        stated = told.give
        if stated is None or stated.load is None:
            return
        if stated.load > len(self.query.loads):
            yield Finding(True, f"it gives under load {stated.load}, which does not exist")
            return
        places = [
            (number, load, np.array([*point, find_top(load, told.thickness)]))
            for number, load in enumerate(self.query.loads, 1)
            for point in load.points or (self.query.workpiece.center,)
        ]
        own = [one for one in places if one[0] == stated.load and np.abs(one[2] - stated.at).max() < AT_NODE]
        if not own:
            yield Finding(True, f"it gives at a place where load {stated.load} does not act")
            return
        second, third = (self.find_body(told, 1.0, order) for order in (2, 3))
        before = self.find_give(second, setting, told, own[0][2])
        vectors = list_vectors(own[0][1])
        worst = vectors[int(np.linalg.norm(vectors @ before.T, axis=1).argmax())]
        after = self.find_give(third, setting, told, own[0][2]) @ worst
        value, change = float(np.linalg.norm(after)), float(np.linalg.norm(after - before @ worst))
        yield from judge_figure("give", "mm", stated.value, value)
        if is_apart(stated.error, 2 * change, SAME_ERROR, stated.value):
            yield Finding(
                True, f"the error of the give is given as {stated.error:g} mm, and is {2 * change:.6g} mm"
            )
        others = [one for one in places if one is not own[0]]
        for number, load, point in others if len(others) <= MOST_PLACES else ():
            matrix = self.find_give(second, setting, told, point)
            most = float(np.linalg.norm(list_vectors(load) @ matrix.T, axis=1).max())
            if most > (stated.value + stated.error) * (1 + SAME) + NOTHING:
                yield Finding(
                    True, f"it gives by {most:.6g} mm under load {number}, more than the give stated"
                )
                return

    def find_give(self, body: Body, setting: PressedSetup, told: BendingFigures, point: Array) -> Array:
        """Return the movement (3, 4) in mm of a loaded place by unit forces along x, y and z and a unit moment about z."""
        (face,), (share,) = body.mesh.project(point[None], None)
        weights = np.array([*share, 1.0 - share.sum()])
        disc = make_level_disc(weights @ body.mesh.corners[face], LOAD_RADIUS)
        columns = []
        for load in (*np.eye(3), None):
            forces = make_disc_forces(disc, load)
            pegs = self.answer(setting, told, disc.points, forces)
            gives = np.array([strip.give for strip in setting.strips]) * pegs
            pressed = self.press(body, setting, pegs, [(disc.points, forces, None)], gives)
            read = pressed.moved.read(*body.mesh.project(disc.beside, None)).mean(axis=0)
            columns.append(read + move_rigidly(pressed.motion, disc.middle))
        return np.array(columns).T

    def answer(self, setting: PressedSetup, told: BendingFigures, points: Array, forces: Array) -> Array:
        """Return the change of the forces of pegs (P,) in N that balances forces in the plane.

        Of all that balance those have the least squares, where the change of each jaw's force counts by how stiff the
        jaw is.
        """
        moment = float(np.cross(points, forces).sum(axis=0)[2])
        load = np.array([*forces[:, :2].sum(axis=0), moment])
        middles = np.array([strip.points.mean(axis=0) for strip in setting.strips])
        inward = -np.array([strip.outward for strip in setting.strips])
        size = max(float(np.abs(middles).max()), 1.0)
        rows = np.stack([inward[:, 0], inward[:, 1], np.cross(middles, inward)[:, 2] / size])
        load[2] /= size
        first = -np.linalg.pinv(rows) @ load
        if not isfinite(told.stiffness):
            return np.asarray(first)
        jaws = np.zeros((setting.movers, len(setting.strips)))
        for k, strip in enumerate(setting.strips):
            if strip.mover is not None:
                jaws[strip.mover, k] = strip.outward @ strip.way
        free = np.linalg.svd(rows)[2][3:].T
        weight = 1 / np.sqrt(max(told.stiffness, 1e-12))
        system, right = (
            np.vstack([free, weight * jaws @ free]),
            np.concatenate([first, weight * jaws @ first]),
        )
        found, *_ = np.linalg.lstsq(system, -right, rcond=None)
        return np.asarray(first + free @ found)


def judge_figure(name: str, unit: str, stated: float, found: float) -> Iterator[Finding]:
    """Yield a finding where a stated figure is not the one that was found."""
    if is_apart(stated, found, SAME):
        yield Finding(True, f"{name} is given as {stated:g} {unit}, and is {found:.6g} {unit}")


def find_top(load: Load, thickness: float) -> float:
    """Return the height in mm at which a load acts."""
    return thickness if load.height is None else min(max(load.height, 0.0), thickness)


def list_vectors(load: Load) -> Array:
    """Return (V, 4): the forces along x, y and z in N and moments about z in N mm that a load may be."""
    low, high = np.radians(load.directions)
    half = min(float(high - low) / 2, pi)
    shares = np.linspace(-1.0, 1.0, DIRECTIONS) if half > 0.0 else np.zeros(1)
    angles = ((low + high) / 2 + half * shares).tolist()
    return np.array([(load.force * cos(a), load.force * sin(a), load.upward, load.moment) for a in angles])


def make_disc_forces(disc: LevelDisc, direction: Array | None) -> Array:
    """Return the forces (M, 3) of 1 N in a direction on a disc, or where that is None of 1 N mm about z."""
    count = len(disc.points)
    if direction is not None:
        return np.tile(direction / count, (count, 1))
    arms = disc.points - disc.middle
    across = np.column_stack([-arms[:, 1], arms[:, 0], np.zeros(count)])
    return np.asarray(across / (arms[:, :2] ** 2).sum())


def measure_nearest(points: Array, others: Array) -> Array:
    """Return how far each of some points (N, 3) is from the nearest of others (M, 3), in mm."""
    found = np.full(len(points), np.inf)
    for start in range(0, len(others), 64):
        away = np.linalg.norm(points[:, None] - others[None, start : start + 64], axis=2)
        found = np.minimum(found, away.min(axis=1))
    return found


def average_at(mesh: JudgedMesh, third: Array, second: Array, point: Array) -> Iterator[tuple[float, float]]:
    """Yield von Mises' stresses by two fields of tensors (F, 15, 3, 3) at a node, for each face there.

    They are those of the mean of the faces that meet there without a sharp edge to that one, by their areas.
    """
    faces, nodes = np.nonzero(np.linalg.norm(mesh.nodes - point, axis=2) < AT_NODE / 10)
    normals, areas = mesh.facing[faces, nodes], mesh.areas[faces, nodes]
    for normal in normals:
        smooth = np.flatnonzero(normals @ normal > SMOOTH)
        if not areas[smooth].sum() > 0.0:
            continue
        weights = areas[smooth] / areas[smooth].sum()
        yield tuple(
            float(compute_mises(np.einsum("f,fxy->xy", weights, field[faces[smooth], nodes[smooth]])))
            for field in (third, second)
        )  # type: ignore[misc]


def find_inner_edges(mesh: JudgedMesh) -> Array:
    """Return points (K, 3) along the sharp edges of the surface between faces that rise towards each other."""
    sides: dict[tuple[int, int], tuple[int, int]] = {}
    found = [np.zeros((0, 3))]
    middles = mesh.nodes.mean(axis=1)
    for face, corners in enumerate(mesh.faces.tolist()):
        for start, end, node in ((0, 1, SIX[3]), (1, 2, SIX[4]), (2, 0, SIX[5])):
            key = (min(corners[start], corners[end]), max(corners[start], corners[end]))
            other, node_of_other = sides.setdefault(key, (face, node))
            normal = mesh.facing[face, node]
            is_sharp = normal @ mesh.facing[other, node_of_other] < SMOOTH
            if other != face and is_sharp and (middles[other] - middles[face]) @ normal > 0.0:
                a, b = mesh.corners[face, start], mesh.corners[face, end]
                shares = np.linspace(0.0, 1.0, int(2 * np.linalg.norm(b - a)) + 2)
                found.append(a + shares[:, None] * (b - a))
    return np.concatenate(found)
