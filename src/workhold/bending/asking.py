"""How far the fixtures of a result bend their part: one mesh and two factorizations for all of them.

Each unit load is solved once: at the contacts of all fixtures (fixtures share equal contacts), at the
supports below the part, and at the places where tools and loads press. The movement under a fixture's clamps
and the movement at each cutter place are sums of these solutions. All are computed with elements of the
second order. The worst cases are computed again with the third order. The values of the third order are
reported, with an error estimated from the difference.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain
from threading import Event

import numpy as np
from attrs import define, evolve, field, frozen
from numpy.typing import NDArray

from workhold.bending.elastic import ElasticBody, PointForces, make_rigid_motions
from workhold.bending.figures import Bending
from workhold.bending.holding import BELOW, ElasticHold, make_elastic_hold
from workhold.bending.meshing import make_mesh
from workhold.bending.patches import BESIDE, RestingFaces, find_foot_corners, make_disc, make_foot
from workhold.bending.places import CutterLoads, list_cutter_loads
from workhold.bending.resting import PlateRest, find_rest
from workhold.bending.shape import PartToBend
from workhold.bending.stress import BESIDE_EDGES, StressedSurface
from workhold.bending.surface import Footing, Surface, list_lattice
from workhold.contact.problem import Progress
from workhold.conventions import STATED_FORCE
from workhold.errors import InputError
from workhold.geometry.segment import Segment, measure_distance_to_segment
from workhold.model.elastic_material import ElasticMaterial
from workhold.model.fixture import Fixture
from workhold.model.part_bending import BentPlace, LargestStress, PadsBelow, describe_cut_faces
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.straps import StrappedHold
from workhold.model.workpiece import Workpiece

__all__ = ["BendingQuestion", "find_bendings"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
# Radius of what a tool or a load presses on, in mm: its dent is not counted, so that it matters little.
CUTTER_RADIUS = 2.0
# The error that is told, of the change from the second order to the third.
UNSURE = 2.0
# What is added to it where a part may lift off a plate, of the movement: cells of other sizes change that as much.
OF_CELLS = 0.1
# What is added to the error of a stress, of it: beside sharp inner edges finer meshes change it as much.
OF_STRESS = 0.1
# Nodes so near to a face of the outline are on it, in mm.
ON_FACE = 0.02
TOP, BOTTOM = "top", "bottom"
# The shares of the work that are done once the mesh is made, and the unit loads are solved with the second order.
MESHED, SOLVED = 0.25, 0.4
# How far apart in mm points beside patches are at which the largest movement is looked for, and into how many pieces a
# quarter of the side of a face is cut for it at most.
CLOSE_BY, MOST_QUARTERS = 0.5, 8
# Points near which nodes are looked for at once.
PRESSED_AT_ONCE = 64


@frozen(eq=False)
class BendingQuestion:
    """A request to compute how far fixtures bend a part.

    Parameters
    ----------
    material : material of the part.
    thickness : thickness of the part in mm; None for that of its solid or of the query.
    jaw_force : jaw force in N; None for that of the query, else the one that the query's loads need, else
        1000 N.
    faces : faces to be machined: only their movement counts. Face numbers of the outline, "top" and "bottom";
        empty for all faces.
    stiffness : ratio of the stiffness of the closed jaw to that of one contact.
    below : by index of a fixture, the pads under its part and the clamp on top; the parts of other fixtures
        lie on their level faces.
    straps : by index of a fixture, straps that hold its part in place of its side clamps.
    """

    material: ElasticMaterial
    thickness: float | None = None
    jaw_force: float | None = None
    faces: tuple[int | str, ...] = ()
    stiffness: float = np.inf
    below: dict[int, PadsBelow] = field(factory=dict)
    straps: dict[int, StrappedHold] = field(factory=dict)

    def find_part_height(self, query: Query) -> float:
        """Return the height of the part in mm.

        Raises
        ------
        InputError
            When neither the question, the solid nor the query gives the height.
        """
        solid = query.workpiece.solid
        if solid is not None:
            return solid.height
        height = self.thickness if self.thickness is not None else query.part_height
        if height is None:
            raise InputError("how far a part bends depends on how thick it is: give its thickness.")
        return height

    def find_jaw_force(self, fixture: Fixture, query: Query) -> tuple[float, bool]:
        """Return (jaw force in N, whether that force is assumed). It is assumed when neither the question nor
        the query gives a force and the loads need none.
        """
        given = query.jaw_force if self.jaw_force is None else self.jaw_force
        needed = fixture.quality.get("jaw_force_needed", fixture.quality.get("clamp_needed", 0.0))
        is_loaded = query.is_loaded
        if isinstance(fixture.hold, StrappedHold) and fixture.hold.tip_radius is not None:
            # Forces of the query are those of the side clamps.
            given, needed, is_loaded = self.jaw_force, fixture.hold.clamp_needed or 0.0, True
        if given is not None:
            return given, False
        if is_loaded and np.isfinite(needed) and needed > 0.0:
            return float(needed), False
        return STATED_FORCE, True


@define(eq=False)
class UnitLoads:
    """Unit loads on a part and readings of its movement. Equal ones are stored once and share a number.

    Parameters
    ----------
    surface : surface of the part's mesh.
    forces : the loads and readings; the number of one is its index here, from 0.
    footings : for each of ``forces``, the points of the surface where it acts.
    numbers : number of each load or reading, by its points and forces as bytes.
    places : footings, by points and outward direction as bytes.
    """

    surface: Surface
    forces: list[PointForces] = field(factory=list)
    footings: list[Footing] = field(factory=list)
    numbers: dict[bytes, int] = field(factory=dict)
    places: dict[bytes, Footing] = field(factory=dict)

    def add(self, forces: Iterable[PointForces]) -> list[int]:
        """Return the number of each given load or reading. New ones are appended."""
        found = []
        for one in forces:
            key = np.round(one.points, 6).tobytes() + np.round(one.forces, 12).tobytes()
            number = self.numbers.setdefault(key, len(self.forces))
            if number == len(self.forces):
                self.forces.append(one)
                self.footings.append(self.find_footing(one))
            found.append(number)
        return found

    def find_footing(self, one: PointForces) -> Footing:
        """Return the points of the surface where a load acts. Loads with equal points share one footing."""
        outward = b"" if one.outward is None else one.outward.tobytes()
        key = one.points.tobytes() + outward
        if key not in self.places:
            self.places[key] = self.surface.find_footing(one.points, one.outward)
        return self.places[key]

    def find_pressed_faces(self, hold: ElasticHold) -> NDArray[np.int64]:
        """Return the indices of the surface's faces that pegs, tips, pads and jaws press on. Faces that lie
        on a plate are left out.
        """
        pressed = {point.tobytes() for point in hold.pressed}
        return np.unique(
            np.concatenate(
                [self.find_footing(one).faces for one in hold.columns if one.points[0].tobytes() in pressed]
            )
        )


@frozen(eq=False)
class HeldFixture:
    """A fixture seen as a load on the part.

    Parameters
    ----------
    hold : the elastic hold, with its unit loads (columns).
    numbers : for each column of the hold, its number in :class:`UnitLoads`.
    reads : for each level of the hold's locators, the numbers of its readings in :class:`UnitLoads`.
    force, is_assumed : jaw force in N, and whether it is assumed because none was given.
    below : the pads under the part and the clamp on top; None without.
    has_own_straps : whether straps hold the part that are not the fixture's own.
    rest : where the part touches the plate that straps press it on; None without straps on a plate.
    """

    hold: ElasticHold
    numbers: list[int]
    reads: list[list[int]]
    force: float
    is_assumed: bool
    below: PadsBelow | None = None
    has_own_straps: bool = False
    rest: PlateRest | None = None

    def estimate_error(self, value: float, change: float) -> float:
        """Return the error estimate in mm of a movement. ``value`` is the movement with elements of the third
        order, and ``change`` its change from the second order.
        """
        return UNSURE * change + (0.0 if self.rest is None else OF_CELLS * value)


@frozen(eq=False)
class PressedPlace:
    """A place where tools or loads press on the part.

    Parameters
    ----------
    middle : (3,) centre of the place in mm.
    cuts : numbers in :class:`UnitLoads` of the four unit loads at this place: forces along x, y and z, and a
        moment about z.
    reads : numbers in :class:`UnitLoads` of the three readings at this place: movements along x, y and z.
    wrenches : (6, 4) force and moment about the origin of each of the four unit loads.
    """

    middle: Array
    cuts: list[int]
    reads: list[int]
    wrenches: Array


@frozen(eq=False)
class WorstGive:
    """The load under which the part moves farthest at the cutter, computed with elements of the second order.

    Parameters
    ----------
    value : movement in mm.
    load : index of the load in the :class:`workhold.bending.places.CutterLoads`.
    place : index of the :class:`PressedPlace`.
    factors : factors of the place's four unit loads, then of the fixture's columns, under this load.
    """

    value: float
    load: int
    place: int
    factors: Array


def find_bendings(
    result: Result,
    rows: Sequence[int],
    shape: PartToBend,
    asked: BendingQuestion,
    cancel: Event | None = None,
    progress: Progress | None = None,
) -> list[Bending]:
    """Return how far given fixtures of a result bend their part, in the order of ``rows``.

    The list is shorter if ``cancel`` is set before the end.

    Parameters
    ----------
    rows : indices of the fixtures in the result.
    progress : called as ``progress(fraction done, fixtures)``.

    Raises
    ------
    InputError
        When the part's thickness is not given, the part has no level face to lie on or cannot be meshed, a
        face to be cut does not exist, or the extra ``bending`` is not installed.
    """
    query, height = result.query, asked.find_part_height(result.query)
    cancel, tell = cancel or Event(), progress or ignore_progress
    refuse_unknown_faces(asked.faces, query.workpiece)
    tell(0.0, 0)
    mesh = make_mesh(shape)
    surface = mesh.surface
    corners = find_foot_corners(surface.nodes, surface.triangles, surface.normals, 0.0)
    foot = make_foot(corners)
    if foot is None:
        raise InputError(
            "the part has no level face that it lies on, so it is not known what bears it: design it the other side up."
        )
    tell(MESHED, 0)
    units = UnitLoads(surface)
    chosen = [
        evolve(result[row], hold=asked.straps[row]) if row in asked.straps else result[row] for row in rows
    ]
    is_strapped = any(isinstance(fixture.hold, StrappedHold) for fixture in chosen)
    faces = RestingFaces.from_corners(corners) if is_strapped else None
    held: list[HeldFixture] = []
    for row, fixture in zip(rows, chosen, strict=True):
        force, is_assumed = asked.find_jaw_force(fixture, query)
        hold = make_elastic_hold(
            fixture,
            query.workpiece,
            query.toolkit,
            foot,
            jaw_force=force,
            height=height,
            pressed_top=query.pressed_top,
            stiffness=asked.stiffness,
            below=asked.below.get(row),
            faces=faces,
        )
        reads = [units.add(level) for level in hold.locating]
        numbers, below = units.add(hold.columns), asked.below.get(row)
        held.append(HeldFixture(hold, numbers, reads, force, is_assumed, below, row in asked.straps))
    loads = list_cutter_loads(query, height)
    places = [] if loads is None else find_pressed_places(loads, units)
    second, third = (SolvedLoads(ElasticBody(mesh, asked.material, order), units) for order in (2, 3))
    needed = sorted(
        {*chain.from_iterable(one.numbers for one in held), *chain.from_iterable(p.cuts for p in places)}
    )
    for count, number in enumerate(needed):
        if cancel.is_set():
            return []
        second.solve(number)
        tell(MESHED + (SOLVED - MESHED) * (count + 1) / len(needed), 0)
    held = [second.add_plate_forces(one) for one in held]
    is_cut = find_cut_nodes(surface, asked.faces, query.workpiece, height)
    stressed = StressedSurface(surface, asked.material)
    beside_edges = find_pressed(surface.nodes, stressed.inner_edges, BESIDE_EDGES)
    gives = [None if loads is None else second.find_worst_give(one, loads, places) for one in held]
    cut = {number for give in gives if give is not None for number in places[give.place].cuts}
    apart = len(cut.union(*(one.numbers for one in held)))
    third.is_summed = (1 if loads is None else 2) * len(held) < apart
    found: list[Bending] = []
    for one, give in zip(held, gives, strict=True):
        if cancel.is_set():
            break
        found.append(
            make_bending(
                one, give, second, third, loads, places, is_cut, stressed, beside_edges, query, asked
            )
        )
        tell(SOLVED + (1 - SOLVED) * len(found) / len(held), len(found))
    return found


def ignore_progress(fraction: float, count: int) -> None:
    """Do nothing. This is the progress callback used when the caller gives none."""


def make_bending(
    one: HeldFixture,
    give: WorstGive | None,
    second: SolvedLoads,
    third: SolvedLoads,
    loads: CutterLoads | None,
    places: list[PressedPlace],
    is_cut: Mask,
    stressed: StressedSurface,
    beside_edges: Mask,
    query: Query,
    asked: BendingQuestion,
) -> Bending:
    """Return the bending of one fixture, from its solutions with elements of the second and the third order.

    The reported values are those of the third order. Errors are estimated from the difference.
    """
    surface = third.body.surface
    pressed = find_pressed(surface.nodes, one.hold.pressed)
    moved = third.solve_clamping(one)
    most = find_most_moved(one, moved, pressed, is_cut, second, third)
    given = None
    if give is not None and loads is not None:
        before, after = (
            level.move_place(one, places[give.place], give.factors[:, None])[:, 0]
            for level in (second, third)
        )
        value, change = float(np.linalg.norm(after)), float(np.linalg.norm(after - before))
        row, there = int(loads.row[give.load]), loads.points[give.load].tolist()
        line = tool = load = None
        if row >= 0 and query.program is not None:
            moves = query.program.moves
            line, tool = int(moves.line[row]), int(moves.tool[row])
        else:
            load = -row
        given = BentPlace(value, one.estimate_error(value, change), tuple(there), line, tool, load)
    return Bending(
        material=asked.material,
        thickness=asked.find_part_height(query),
        jaw_force=one.force,
        is_assumed=one.is_assumed,
        stiffness=asked.stiffness,
        faces=asked.faces,
        below=one.below,
        clamp_distortion=most,
        give=given,
        stress=find_largest_stress(one, moved, pressed | beside_edges, stressed, second),
        elements=third.body.elements,
        surface=surface,
        moved=moved,
        pressed=pressed,
        has_own_straps=one.has_own_straps,
    )


def find_most_moved(
    one: HeldFixture, moved: Array, pressed: Mask, is_cut: Mask, second: SolvedLoads, third: SolvedLoads
) -> BentPlace:
    """Return the place where clamping moves the surface most, outside of dents.

    Only nodes in ``is_cut`` count, and not those in ``pressed``. Places between nodes are searched as well,
    on each face that has a node moved at least as far as the farthest counted node.

    Parameters
    ----------
    moved, pressed, is_cut : (N, 3) movement and (N,) masks of the N surface nodes, see :class:`Bending`.
    """
    surface = third.body.surface
    size = np.linalg.norm(moved, axis=1)
    most = float(np.where(pressed | ~is_cut, 0.0, size).max())
    of_faces = surface.faces
    faces = np.flatnonzero(is_cut[of_faces].all(axis=1) & (size[of_faces].max(axis=1) >= most))
    longest = np.linalg.norm(np.diff(surface.corners[faces], axis=1), axis=2).max()
    shares = list_lattice(4 * int(np.clip(np.ceil(longest / CLOSE_BY / 4), 1, MOST_QUARTERS)))
    points, after = (
        surface.interpolate_points(faces, shares),
        third.compute_clamping_movement(one, faces, shares),
    )
    far = np.linalg.norm(after, axis=2)
    most_there = np.flatnonzero(far >= (1.0 - 1e-9) * most)
    is_dent = find_pressed(points.reshape(-1, 3)[most_there], one.hold.pressed)
    far.ravel()[most_there[is_dent]] = 0.0
    face, point = np.divmod(int(far.argmax()), len(shares))
    before = second.compute_clamping_movement(one, faces[[face]], shares[[point]])[0, 0]
    change = float(np.linalg.norm(after[face, point] - before))
    value = float(far[face, point])
    return BentPlace(value, one.estimate_error(value, change), tuple(points[face, point].tolist()))


def find_largest_stress(
    one: HeldFixture, moved: Array, left_out: Mask, stressed: StressedSurface, second: SolvedLoads
) -> LargestStress:
    """Return the largest von Mises stress on the surface under a fixture's clamps.

    Stress is evaluated face by face, so every face with a pressed node is left out as well.

    Parameters
    ----------
    moved, left_out : (N, 3) movement of the N surface nodes in mm, with elements of the third order, and (N,)
        mask of the nodes that do not count.
    """
    counts = ~left_out[stressed.surface.faces]
    counts[second.units.find_pressed_faces(one.hold)] = False
    after = stressed.compute_mises_stress(moved)
    face, node = np.divmod(int(np.where(counts, after, 0.0).argmax()), after.shape[1])
    change = abs(
        float(after[face, node] - stressed.compute_mises_stress(second.solve_clamping(one))[face, node])
    )
    value = float(after[face, node])
    error = UNSURE * change + OF_STRESS * value
    return LargestStress(value, error, tuple(stressed.places[face, node].tolist()))


def find_pressed_places(loads: CutterLoads, units: UnitLoads) -> list[PressedPlace]:
    """Return a loaded patch of the surface for each chosen place where tools and loads press.

    The unit loads and readings of these patches are added to ``units``.
    """
    found = []
    for number in loads.chosen.tolist():
        footing = units.surface.find_footing(loads.points[number][None], None)
        patch = make_disc(units.surface.place(footing)[0], CUTTER_RADIUS, None)
        pressing = [*(patch.make_force(axis) for axis in np.eye(3)), patch.make_unit_moment()]
        wrenches = np.array([force.wrench for force in pressing]).T
        reads = units.add(patch.read(axis) for axis in np.eye(3))
        found.append(PressedPlace(patch.middle, units.add(pressing), reads, wrenches))
    return found


def find_pressed(nodes: Array, points: Array, beside: float = BESIDE) -> Mask:
    """Return the mask (N,) of those nodes (N, 3) that are nearer than ``beside`` mm to a pressed point (K,
    3).

    The surface is dented there.
    """
    found = np.zeros(len(nodes), np.bool_)
    for start in range(0, len(points), PRESSED_AT_ONCE):
        some = points[start : start + PRESSED_AT_ONCE]
        within = (nodes > some.min(axis=0) - beside) & (nodes < some.max(axis=0) + beside)
        near = np.flatnonzero(within.all(axis=1) & ~found)
        away = nodes[near, None] - some
        found[near] = ((away**2).sum(axis=2) < beside**2).any(axis=1)
    return found


class SolvedLoads:
    """An elastic body with the solutions under unit loads, each computed when it is first needed.

    S is the number of surface unknowns per component, see ``ElasticBody.surface_unknowns``.

    Parameters
    ----------
    is_summed : whether each sum of unit loads is solved as one load. This is faster when there are fewer sums
        than unit loads.
    """

    def __init__(self, body: ElasticBody, units: UnitLoads, is_summed: bool = False) -> None:
        self.body, self.units, self.is_summed = body, units, is_summed
        # Sums have negative numbers, in the order in which they came.
        self.sums: dict[bytes, int] = {}
        self.works: dict[int, Array] = {}
        self.responses: dict[int, Array] = {}
        self.readings: dict[tuple[int, int], float] = {}

    def compute_work(self, number: int) -> Array:
        """Return the work (S, 3) that a unit load or reading does per unit of each unknown of the surface."""
        if number not in self.works:
            self.works[number] = self.body.compute_work(
                self.units.forces[number], self.units.footings[number]
            )
        return self.works[number]

    def solve(self, number: int) -> Array:
        """Return the surface's unknowns (S, 3) under the unit load with this number. The result is cached."""
        if number not in self.responses:
            self.responses[number] = self.body.solve_loads([self.compute_work(number)])[0]
        return self.responses[number]

    def gather_loads(self, numbers: Sequence[int], factors: Array) -> tuple[Sequence[int], Array]:
        """Return (numbers, factors) of the loads to solve for a sum of unit loads.

        They are the arguments unchanged. If ``is_summed``, they are the number of a single load that equals
        the sum, with factor 1. Numbers of such single loads are negative.
        """
        if not self.is_summed:
            return numbers, factors
        key = np.array(numbers).tobytes() + factors.tobytes()
        number = self.sums.setdefault(key, -1 - len(self.sums))
        if number not in self.works:
            self.works[number] = np.asarray(
                sum(
                    factor * self.compute_work(k) for k, factor in zip(numbers, factors.tolist(), strict=True)
                )
            )
        return [number], np.ones(1)

    def add_up(self, numbers: Sequence[int], factors: Array) -> Array:
        """Return the surface's unknowns (S, 3) under the sum of unit loads ``numbers``, each times its
        factor.
        """
        numbers, factors = self.gather_loads(numbers, factors)
        total = np.zeros((len(self.body.surface_unknowns[0]), 3))
        for number, factor in zip(numbers, factors.tolist(), strict=True):
            if factor:
                total += factor * self.solve(number)
        return total

    def read(self, reads: Sequence[int], numbers: Sequence[int]) -> Array:
        """Return what the readings ``reads`` (R) measure under each of the unit loads ``numbers`` (L): an
        array (R, L).
        """
        return np.array([[self.compute_reading(read, number) for number in numbers] for read in reads])

    def compute_reading(self, read: int, number: int) -> float:
        """Return what the reading with number ``read`` measures under the unit load with this number."""
        pair = (read, number)
        if pair not in self.readings:
            self.readings[pair] = float(np.einsum("sk,sk->", self.compute_work(read), self.solve(number)))
        return self.readings[pair]

    def find_motion(self, one: HeldFixture, numbers: Sequence[int], factors: Array, gives: Array) -> Array:
        """Return the rigid motion (6,) that lays the part, under a sum of unit loads, against a fixture's
        locators.

        It has three shifts in mm, then three turns in radians.

        Parameters
        ----------
        gives : (R,) distance in mm by which each contact of the first level of locators gives way.
        """
        numbers, factors = self.gather_loads(numbers, factors)
        return one.hold.find_motion([self.read(level, numbers) @ factors for level in one.reads], gives)

    def solve_clamping(self, one: HeldFixture) -> Array:
        """Return the movement (N, 3) in mm of the surface's nodes under a fixture's clamps, with the part
        laid against its locators.
        """
        values, motion = self.compute_clamped_state(one)
        return self.body.move_nodes(values) + make_rigid_motions(self.body.surface.nodes) @ motion

    def compute_clamping_movement(self, one: HeldFixture, faces: NDArray[np.int64], shares: Array) -> Array:
        """Return the movement (F, K, 3) in mm of points on F faces under a fixture's clamps, with the part
        laid against its locators.

        The points are at the barycentric coordinates ``shares`` (K, 3), the same on each face.
        """
        values, motion = self.compute_clamped_state(one)
        points = self.body.surface.interpolate_points(faces, shares)
        rigid = (make_rigid_motions(points.reshape(-1, 3)) @ motion).reshape(points.shape)
        return self.body.interpolate_movement(values, faces, shares) + rigid

    def compute_clamped_state(self, one: HeldFixture) -> tuple[Array, Array]:
        """Return (unknowns, motion) under a fixture's clamps.

        These are the surface's unknowns (S, 3) and the rigid motion (6,) that lays the part against its
        locators.
        """
        clamping = one.hold.clamping
        motion = self.find_motion(one, one.numbers, clamping, np.zeros(len(one.hold.gives)))
        return self.add_up(one.numbers, clamping), motion

    def add_plate_forces(self, one: HeldFixture) -> HeldFixture:
        """Return a fixture with the forces by which its plate carries the part under clamping.

        The fixture comes back unchanged unless its part lies on a plate that it may lift off.
        """
        resting = list(one.hold.resting)
        if not resting:
            return one
        cells = [one.numbers[k] for k in resting]
        moved = self.read(cells, one.numbers)
        wrenches = np.array([column.wrench[BELOW] for column in one.hold.columns])
        clamping = one.hold.clamping.copy()
        rest = find_rest(moved[:, resting], wrenches[resting], moved @ clamping, wrenches.T @ clamping)
        clamping[resting] = rest.pressures
        touching = [resting[k] for k in rest.touching.tolist()]
        columns = tuple(one.hold.columns[k] for k in touching)
        hold = evolve(
            one.hold, clamping=clamping, resting=tuple(touching), locating=(one.hold.locating[0], columns)
        )
        reads = [one.reads[0], [one.numbers[k] for k in touching]]
        return evolve(one, hold=hold, reads=reads, rest=rest)

    def find_factors(self, one: HeldFixture, place: PressedPlace, vectors: Array) -> Array:
        """Return the factors (4 + C, V) of a place's four unit loads and a fixture's C columns under V loads there.

        ``vectors`` (4, V) are forces along x, y and z in N, and moments about z in N mm.
        """
        hold = one.hold
        factors = np.vstack([vectors, hold.answers @ place.wrenches @ vectors])
        if one.rest is not None:
            resting = list(hold.resting)
            numbers = [*place.cuts, *one.numbers]
            rise = self.read([one.numbers[k] for k in resting], numbers) @ factors
            wrenches = np.array([column.wrench[BELOW] for column in hold.columns]).T
            load = place.wrenches[BELOW] @ vectors + wrenches @ factors[4:]
            factors[[4 + k for k in resting]] += one.rest.compute_bearing_forces(rise, load)
        return factors

    def move_place(self, one: HeldFixture, place: PressedPlace, factors: Array) -> Array:
        """Return the movement (3, V) in mm of a place under V loads on it.

        It includes the reactions at the contacts that balance the load, and the compliance of these contacts.

        Parameters
        ----------
        factors : (4 + C, V) factors of the unit loads, see :meth:`find_factors`.
        """
        numbers = [*place.cuts, *one.numbers]
        rigid = make_rigid_motions(place.middle[None])[0]
        moved = []
        for own in np.ascontiguousarray(factors.T):
            motion = self.find_motion(one, numbers, own, one.hold.gives @ own[4:])
            loaded, shares = self.gather_loads(numbers, own)
            moved.append(self.read(place.reads, loaded) @ shares + rigid @ motion)
        return np.array(moved).T

    def find_worst_give(self, one: HeldFixture, loads: CutterLoads, places: list[PressedPlace]) -> WorstGive:
        """Return the load under which the part moves farthest at the cutter. Each load is applied at the
        nearest of the chosen places.
        """
        factors = [self.find_factors(one, place, np.eye(4)) for place in places]
        matrices = [self.move_place(one, *pair) for pair in zip(places, factors, strict=True)]
        worst: WorstGive | None = None
        for number in range(len(loads)):
            place = int(loads.owner[number])
            vectors = loads.list_vectors(number)
            sizes = np.linalg.norm(vectors @ matrices[place].T, axis=1)
            most = int(sizes.argmax())
            if worst is None or sizes[most] > worst.value:
                worst = WorstGive(float(sizes[most]), number, place, factors[place] @ vectors[most])
        assert worst is not None
        return worst


def refuse_unknown_faces(faces: Sequence[int | str], workpiece: Workpiece) -> None:
    """Raise InputError for faces to be cut that the part does not have."""
    known = {face.number for face in workpiece.faces} | {TOP, BOTTOM}
    for face in faces:
        if face not in known:
            raise InputError(
                f"face {face} of {workpiece.name} does not exist: name faces by their numbers, or {TOP} and {BOTTOM}."
            )


def find_cut_nodes(surface: Surface, faces: Sequence[int | str], workpiece: Workpiece, height: float) -> Mask:
    """Return the mask (N,) of the surface's nodes on the faces to be cut; all True when no face is named.

    Raises InputError when no face of the mesh lies on the named faces.
    """
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
    if not found[surface.faces].all(axis=1).any():
        raise InputError(
            f"nothing of {workpiece.name} lies on what is to be cut ({describe_cut_faces(faces)})."
        )
    return found


def measure_distances(segment: Segment, points: Array) -> Array:
    """Return the distances (N,) of points (N, 2) from a segment, in mm."""
    return np.array([measure_distance_to_segment((x, y), segment) for x, y in points.tolist()])
