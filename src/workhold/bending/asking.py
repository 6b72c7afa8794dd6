"""How far the fixtures of a result bend their part: one mesh and one factorization for all of them.

On the mesh as it was made every unit load is solved once: of each contact of all the fixtures, however many share it,
of what bears the part, and of the places where tools and loads press. What a fixture's clamps do, and how far it gives
at each place, are sums of these. The mesh is then refined, and what was worst is reckoned again: the difference is the
error that is told.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from threading import Event

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.bending.elastic import ElasticBody, PointForces, rigid_motions
from workhold.bending.figures import Bending, BentPlace
from workhold.bending.holding import ElasticHold, PadsBelow, hold_of_fixture
from workhold.bending.materials import ElasticMaterial
from workhold.bending.meshing import Surface, make_mesh, refine_mesh
from workhold.bending.patches import BESIDE, LoadPatch, make_disc, make_foot
from workhold.bending.places import CutterLoads, list_cutter_loads
from workhold.bending.shape import PartToBend
from workhold.contact.problem import Progress
from workhold.conventions import STATED_FORCE
from workhold.errors import InputError
from workhold.geometry.segment import Segment, measure_distance_to_segment
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.workpiece import Workpiece

__all__ = ["BendingQuestion", "find_bendings"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
# Radius of what a tool or a load presses on, in mm: its dent is not counted, so that it matters little.
CUTTER_RADIUS = 2.0
# The error that is told, of the change from the mesh to the refined one: at a dent, which is read near by, the change
# halves at the next refinement, so that what is left is at most as much as it.
UNSURE = 2.0
# Nodes so near to a face of the outline are on it, in mm.
ON_FACE = 0.02
TOP, BOTTOM = "top", "bottom"
# The shares of the work that are done once the mesh is made, the unit loads are solved, and the mesh is refined.
MESHED, SOLVED, REFINED = 0.2, 0.6, 0.75


@frozen(eq=False)
class BendingQuestion:
    """What is asked of bending.

    Parameters
    ----------
    material : what the part is of.
    thickness : of the part in mm; that of its solid, or of the query, if None.
    jaw_force : in N; that of the query if None, else the one that its loads need, else a thousand newtons.
    faces : which faces are to be cut: numbers of faces of the outline, "top" and "bottom"; all where there are none.
    stiffness : how many times as stiff as a contact the closed jaw is.
    below : pads and clamp under the part of a fixture, by its index; it lies on its level faces elsewhere.
    """

    material: ElasticMaterial
    thickness: float | None = None
    jaw_force: float | None = None
    faces: tuple[int | str, ...] = ()
    stiffness: float = np.inf
    below: dict[int, PadsBelow] = field(factory=dict)

    def height_of(self, query: Query) -> float:
        """The height of the part in mm.

        Raises
        ------
        InputError
            Where nobody says it.
        """
        solid = query.workpiece.solid
        if solid is not None:
            return solid.height
        height = self.thickness if self.thickness is not None else query.part_height
        if height is None:
            raise InputError("how far a part bends depends on how thick it is: give its thickness.")
        return height

    def force_on(self, fixture: Fixture, query: Query) -> tuple[float, bool]:
        """The jaw force in N, and whether it is only stated because nobody knows one."""
        given = query.jaw_force if self.jaw_force is None else self.jaw_force
        if given is not None:
            return given, False
        needed = fixture.quality.get("jaw_force_needed", fixture.quality.get("clamp_needed", 0.0))
        if query.is_loaded and np.isfinite(needed) and needed > 0.0:
            return float(needed), False
        return STATED_FORCE, True


@define(eq=False)
class UnitLoads:
    """Unit loads on a part, each once, by what they are.

    Parameters
    ----------
    forces : in the order in which they came.
    """

    forces: list[PointForces] = field(factory=list)
    numbers: dict[bytes, int] = field(factory=dict)

    def add(self, columns: Iterable[PointForces]) -> list[int]:
        """The numbers of some loads, those that are new at the end."""
        found = []
        for column in columns:
            key = (np.round(column.points, 6).tobytes(), np.round(column.forces, 12).tobytes())
            number = self.numbers.setdefault(b"".join(key), len(self.forces))
            if number == len(self.forces):
                self.forces.append(column)
            found.append(number)
        return found


@frozen(eq=False)
class HeldFixture:
    """A fixture as a load on the part.

    Parameters
    ----------
    hold : its columns.
    numbers : of these among all unit loads.
    force, is_stated : the jaw force in N, and whether nobody said it.
    """

    hold: ElasticHold
    numbers: list[int]
    force: float
    is_stated: bool


@frozen(eq=False)
class WorstGive:
    """Where a fixture gives most on the mesh that is not refined.

    Parameters
    ----------
    value : in mm.
    load : number of what presses.
    place : number of the place.
    vector : (4,) the forces and the moment there.
    """

    value: float
    load: int
    place: int
    vector: Array


def find_bendings(
    result: Result,
    rows: Sequence[int],
    shape: PartToBend,
    asked: BendingQuestion,
    cancel: Event | None = None,
    progress: Progress | None = None,
) -> list[Bending]:
    """How far some fixtures of a result bend their part; fewer of them where ``cancel`` is set on the way.

    Parameters
    ----------
    rows : their indices in the result.
    progress : called as ``progress(fraction done, fixtures)``.

    Raises
    ------
    InputError
        For a part of which nobody says how thick it is, that has no level face to lie on or cannot be meshed, and faces
        to be cut that there are not. Also when the extra ``bending`` is not installed.
    """
    query, height = result.query, asked.height_of(result.query)
    cancel, tell = cancel or Event(), progress or tell_nobody
    refuse_unknown_faces(asked.faces, query.workpiece)
    tell(0.0, 0)
    coarse = ElasticBody(make_mesh(shape), asked.material)
    foot = make_foot(coarse.surface.nodes, coarse.surface.triangles, coarse.surface.normals, 0.0)
    if foot is None:
        raise InputError(
            "the part has no level face that it lies on, so it is not known what bears it: design it the other side up."
        )
    tell(MESHED, 0)
    units = UnitLoads()
    held: list[HeldFixture] = []
    for row in rows:
        fixture = result[row]
        force, is_stated = asked.force_on(fixture, query)
        hold = hold_of_fixture(
            fixture,
            query.workpiece,
            query.toolkit,
            foot,
            jaw_force=force,
            height=height,
            pressed_up_to=query.pressed_up_to,
            stiffness=asked.stiffness,
            below=asked.below.get(row),
        )
        held.append(HeldFixture(hold, units.add(hold.columns), force, is_stated))
    loads = list_cutter_loads(query, height)
    places = [] if loads is None else find_pressed_places(loads, coarse)
    cuts = [units.add((*(patch.press(axis) for axis in np.eye(3)), patch.twist())) for patch in places]
    solved = SolvedLoads(coarse, units, asked, height, query)
    for number in range(len(units.forces)):
        if cancel.is_set():
            return []
        solved.solve(number)
        tell(MESHED + (SOLVED - MESHED) * (number + 1) / len(units.forces), 0)
    gives = [None if loads is None else solved.find_worst_give(one, loads, places, cuts) for one in held]
    fine = ElasticBody(refine_mesh(coarse.mesh), asked.material)
    refined = SolvedLoads(fine, units, asked, height, query)
    tell(REFINED, 0)
    found: list[Bending] = []
    for one, give in zip(held, gives, strict=True):
        if cancel.is_set():
            break
        found.append(describe(one, give, solved, refined, loads, places, cuts, query, asked))
        tell(REFINED + (1 - REFINED) * len(found) / len(held), len(found))
    return found


def tell_nobody(fraction: float, count: int) -> None:
    """Where nobody watches."""


def describe(
    one: HeldFixture,
    give: WorstGive | None,
    solved: SolvedLoads,
    refined: SolvedLoads,
    loads: CutterLoads | None,
    places: list[LoadPatch],
    cuts: list[list[int]],
    query: Query,
    asked: BendingQuestion,
) -> Bending:
    """What is told of a fixture, from both meshes."""
    distorted = []
    for level in (solved, refined):
        moved = level.lay(one, level.add_up(one.numbers, one.hold.clamping), np.zeros(len(one.hold.gives)))
        pressed = level.find_pressed(one)
        size = np.where(pressed | ~level.is_cut, 0.0, np.linalg.norm(moved, axis=1))
        distorted.append((moved, pressed, int(size.argmax()), float(size.max())))
    (*_, before), (moved, pressed, node, most) = distorted
    at = refined.body.surface.nodes[node].tolist()
    given = None
    if give is not None and loads is not None:
        value = refined.compute_give(one, places[give.place], cuts[give.place], give.vector)
        row, there = int(loads.row[give.load]), loads.points[give.load].tolist()
        line = tool = load = None
        if row >= 0 and query.program is not None:
            moves = query.program.moves
            line, tool = int(moves.line[row]), int(moves.tool[row])
        else:
            load = -row
        given = BentPlace(value, UNSURE * abs(value - give.value), tuple(there), line, tool, load)
    return Bending(
        asked.material,
        one.force,
        one.is_stated,
        BentPlace(most, UNSURE * abs(most - before), tuple(at)),
        given,
        refined.body.elements,
        describe_faces(asked.faces),
        refined.body.surface,
        moved,
        pressed,
    )


def find_pressed_places(loads: CutterLoads, body: ElasticBody) -> list[LoadPatch]:
    """The patches of the surface that are loaded where tools and loads press."""
    found = []
    for number in loads.chosen.tolist():
        footing = body.find_footing(PointForces(loads.points[number][None], np.zeros((1, 3))))
        nodes = body.surface.nodes[body.surface.triangles[footing.triangles[0]]]
        found.append(make_disc(footing.weights[0] @ nodes, CUTTER_RADIUS, None))
    return found


class SolvedLoads:
    """A body with what is solved of the unit loads on it."""

    def __init__(
        self, body: ElasticBody, units: UnitLoads, asked: BendingQuestion, height: float, query: Query
    ) -> None:
        self.body, self.units = body, units
        self.works: dict[int, Array] = {}
        self.responses: dict[int, Array] = {}
        self.is_cut = find_cut_nodes(body.surface, asked.faces, query.workpiece, height)

    def work_of(self, number: int) -> Array:
        """The work (N, 3) of a unit load on the nodes."""
        if number not in self.works:
            self.works[number] = self.body.spread(self.units.forces[number])
        return self.works[number]

    def solve(self, number: int) -> None:
        """Solve a unit load."""
        self.responses[number] = self.body.respond([self.work_of(number)])[0]

    def add_up(self, numbers: Sequence[int], factors: Array) -> Array:
        """How nodes move (N, 3) under a sum of unit loads: superposed where all are solved, else solved at once."""
        known = self.responses if all(number in self.responses for number in numbers) else None
        total = np.zeros_like(self.body.surface.nodes)
        for number, factor in zip(numbers, factors.tolist(), strict=True):
            if factor:
                total += factor * (self.work_of(number) if known is None else known[number])
        return total if known is not None else self.body.respond([total])[0]

    def read(self, forces: PointForces, moved: Array) -> float:
        """What is read of a movement."""
        number = self.units.add([forces])[0]
        return float((self.work_of(number) * moved).sum())

    def find_motion(self, one: HeldFixture, moved: Array, gives: Array) -> Array:
        """The rigid motion that lays a movement against the locators of a fixture."""
        readings = [np.array([self.read(each, moved) for each in level]) for level in one.hold.locating]
        return one.hold.find_motion(readings, gives)

    def lay(self, one: HeldFixture, moved: Array, gives: Array) -> Array:
        """A movement (N, 3) laid against the locators of a fixture, whose contacts give way by (R,) in mm."""
        motion = self.find_motion(one, moved, gives)
        return moved + rigid_motions(self.body.surface.nodes) @ motion

    def find_pressed(self, one: HeldFixture) -> Mask:
        """Which nodes (N,) lie where something presses, or so near that its dent is felt."""
        nodes = self.body.surface.nodes
        nearest = np.full(len(nodes), np.inf)
        for start in range(0, len(one.hold.pressed), 64):
            away = nodes[:, None] - one.hold.pressed[None, start : start + 64]
            nearest = np.minimum(nearest, (away**2).sum(axis=2).min(axis=1))
        return nearest < BESIDE**2

    def compute_give(self, one: HeldFixture, place: LoadPatch, cut: list[int], vector: Array) -> float:
        """How far the part gives in mm where something presses with a vector (4,)."""
        matrix = self.compute_compliance(one, place, cut, vector[:, None])
        return float(np.linalg.norm(matrix[:, 0]))

    def compute_compliance(self, one: HeldFixture, place: LoadPatch, cut: list[int], vectors: Array) -> Array:
        """How a place moves (3, V) under vectors (4, V) of forces and a moment on it, with all that answers them."""
        columns = []
        for vector in vectors.T:
            wrench = sum(v * self.units.forces[k].wrench for v, k in zip(vector.tolist(), cut, strict=True))
            answer = one.hold.answers @ wrench
            moved = self.add_up([*cut, *one.numbers], np.concatenate([vector, answer]))
            motion = self.find_motion(one, moved, one.hold.gives @ answer)
            there = rigid_motions(place.middle[None])[0] @ motion
            columns.append(
                [self.read(place.read(axis), moved) + there[k] for k, axis in enumerate(np.eye(3))]
            )
        return np.array(columns).T

    def find_worst_give(
        self, one: HeldFixture, loads: CutterLoads, places: list[LoadPatch], cuts: list[list[int]]
    ) -> WorstGive:
        """Where a fixture gives most, and under what."""
        matrices = [
            self.compute_compliance(one, place, cut, np.eye(4))
            for place, cut in zip(places, cuts, strict=True)
        ]
        worst: WorstGive | None = None
        for number in range(len(loads)):
            place = int(loads.owner[number])
            vectors = loads.list_vectors(number)
            sizes = np.linalg.norm(vectors @ matrices[place].T, axis=1)
            most = int(sizes.argmax())
            if worst is None or sizes[most] > worst.value:
                worst = WorstGive(float(sizes[most]), number, place, vectors[most])
        assert worst is not None
        return worst


def refuse_unknown_faces(faces: Sequence[int | str], workpiece: Workpiece) -> None:
    """Refuses faces to be cut that the part does not have."""
    known = {face.number for face in workpiece.faces} | {TOP, BOTTOM}
    for face in faces:
        if face not in known:
            raise InputError(
                f"face {face} of {workpiece.name} does not exist: name faces by their numbers, or {TOP} and {BOTTOM}."
            )


def describe_faces(faces: Sequence[int | str]) -> str | None:
    """The faces to be cut in words; None for all."""
    numbers = ", ".join(str(face) for face in faces if isinstance(face, int))
    level = [str(face) for face in faces if isinstance(face, str)]
    return ", ".join([*level, *([f"faces {numbers}"] if numbers else [])]) or None


def find_cut_nodes(surface: Surface, faces: Sequence[int | str], workpiece: Workpiece, height: float) -> Mask:
    """Which nodes (N,) of a surface are on faces that are to be cut; all where none is named."""
    nodes = surface.nodes
    if not faces:
        return np.ones(len(nodes), np.bool_)
    found = np.zeros(len(nodes), np.bool_)
    for name, side in ((TOP, 1.0), (BOTTOM, -1.0)):
        if name in faces:
            found[surface.triangles[surface.normals[:, 2] * side > 0.999].ravel()] = True
    segments = {face.number: face.segment for face in workpiece.faces}
    upright = np.zeros(len(nodes), np.bool_)
    upright[surface.triangles[np.abs(surface.normals[:, 2]) < 0.5].ravel()] = True
    for face in faces:
        if isinstance(face, int):
            found |= upright & (measure_distances(segments[face], nodes[:, :2]) < ON_FACE)
    return found


def measure_distances(segment: Segment, points: Array) -> Array:
    """Return the distances (N,) of points (N, 2) from a segment, in mm."""
    return np.array([measure_distance_to_segment((x, y), segment) for x, y in points.tolist()])
