"""The straps that hold a part down on a plate with the least force, exact over a finite set of places.

The force that a set of straps needs is a linear program with six equations (``statics.friction``). Its dual is a motion
of the part that locators and plate allow. That motion bounds the force of every other set: straps at other places do
the work on it that they do, so that no set needs less than the load's work over theirs. The set with the least bound
is reckoned, which gives new motions, until no bound is below the least force found. Most sets are never reckoned.

The straps alone must press the part flat on the plate: the middle of their tips lies in the kern of its foot. So what
holds at a force holds at every greater one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import product
from math import acos, ceil, cos, inf, isfinite, radians, sin
from threading import Event

import numpy as np
from attrs import define, evolve, field, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.fixels.carrier import Carrier
from workhold.fixels.support_hardware import SupportPads
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.hull import compute_convex_hull
from workhold.geometry.loop import make_loop_segments
from workhold.geometry.segment import Arc, Segment
from workhold.model.fixture import Fixture, Peg
from workhold.model.friction import (
    COUNTED_BY_STRAPS,
    COUNTED_OVER_SUPPORTS,
    SAFETY,
    Coefficients,
    find_friction_coefficient,
    to_coefficients,
)
from workhold.model.jaw_hold import ProgramJawForce
from workhold.model.program import Program
from workhold.model.query import Query
from workhold.model.requirements import Load, Zone
from workhold.model.straps import Strap, StrapHardware, StrappedHold
from workhold.model.support_request import SpatialLoad, SupportRequest
from workhold.statics.friction import MotionProgram, enclose_directions
from workhold.statics.jaw_program import CuttingPieces, PressedPart, find_worst_move
from workhold.statics.patches import PressedPolygon
from workhold.statics.strapped import StrappedPart, StrapsOnPart
from workhold.supports.hand_push import find_hand_push
from workhold.supports.strap_places import StrapPlaces, find_strap_places
from workhold.supports.straps_over_supports import PadPlaces, SupportedStraps
from workhold.supports.straps_past_tools import are_clear

__all__ = [
    "NO_LOADS",
    "StrapQuestion",
    "StrapSearch",
    "ask_for_straps",
    "find_straps",
    "make_question",
    "make_usual_request",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
# How far chords may be off an arc of the part's foot, in mm.
CHORD = 0.1
# How far beside the kern in mm the middle of the tips may be by rounding.
KERN_SLACK = 1e-7
# By how much, of a force, sets are no better than one another.
ALIKE = 1e-9
LOCATORS = 3
# What stands for the thickness in mm of a part that nothing loads, where nobody says.
UNKNOWN_HEIGHT = 1.0
NO_LOADS = "straps are chosen by the force that loads ask for: give one load or more."


@frozen
class StrapQuestion:
    """What is asked of straps.

    Parameters
    ----------
    straps : that there are.
    request : how thick the part is, and which faces tips and plate may touch; its clamp is not asked for.
    loads : that act on the part, each by itself.
    friction : coefficients by name, of "tip" and "plate"; usual ones for None.
    safety : the factor on loads.
    weight : of the part in N, without that factor; it acts at the middle of the foot.
    is_over_supports : whether the part lies on three supports, and each tip presses over one of them.
    program : whose tools pass the straps, and press on the part where their forces are known.
    """

    straps: StrapHardware
    request: SupportRequest
    loads: tuple[SpatialLoad, ...] = ()
    friction: Coefficients | None = None
    safety: float = SAFETY
    weight: float = 0.0
    is_over_supports: bool = False
    program: Program | None = None

    @property
    def below(self) -> str:
        """The name of the coefficient of friction below the part."""
        return "support" if self.is_over_supports else "plate"

    @property
    def counted(self) -> tuple[str, str]:
        """The names of the coefficients of friction that count."""
        return COUNTED_OVER_SUPPORTS if self.is_over_supports else COUNTED_BY_STRAPS

    def find_plate(self, fixture: Fixture) -> Carrier:
        """Return the plate of a fixture, with the holes for locators and bolts."""
        return next(one for one in get_toolkit(fixture).carriers if one.has_lattice and one.travel is None)

    def get_bolt_holes(self, fixture: Fixture) -> Carrier:
        """Return the holes for bolts on the plate of a fixture."""
        straps = get_toolkit(fixture).strap_set
        return self.find_plate(fixture) if straps is None else straps.bolts

    def list_locators(self, fixture: Fixture) -> list[Peg]:
        """Return the pegs of a fixture that stand still, among them the ends of a contact with a wall.

        Raises
        ------
        InputError
            For a fixture that has other than three on one plate.
        """
        toolkit = get_toolkit(fixture)
        still = [peg for peg in fixture.pegs if toolkit.find_carrier(peg.carrier).travel is None]
        if len(toolkit.plates) != 1 or len(still) != LOCATORS:
            raise InputError(
                "straps hold a part against three locators on one plate: take a fixture on a plate, or beside a fence."
            )
        return still


def get_toolkit(fixture: Fixture) -> Toolkit:
    """Return the toolkit of a fixture of a result."""
    return fixture.listing.result.toolkit


def make_usual_request(
    query: Query, thickness: float | None, tip_radius: float, zones: Sequence[Zone] = ()
) -> SupportRequest:
    """Return the faces of a part that tips and plate may touch, as a solid says them.

    Parameters
    ----------
    thickness : in mm; that of the solid if None.
    zones : where no tip may stand.
    """
    usual = SupportRequest.from_workpiece(query.workpiece, thickness, tip_radius=tip_radius)
    return evolve(usual, top_zones=tuple(zones))


def make_question(query: Query) -> StrapQuestion:
    """Return what a query whose toolkit has straps asks of them; tips stand off its keep-out zones as locators do."""
    straps = query.toolkit.strap_set
    assert straps is not None
    # Without loads nobody need know how thick the part is.
    height = None if query.part_height is not None else UNKNOWN_HEIGHT
    zones = query.restrictions.zones
    request = make_usual_request(query, height or query.thickness, straps.tip_radius, zones)
    if straps.is_over_supports:
        pads = SupportRequest.from_workpiece(query.workpiece, request.thickness, toolkit=query.toolkit)
        pads.refuse_fat_pads(query.toolkit)
        request = evolve(request, pad_radius=pads.pad_radius, pad_margin=pads.pad_margin, bottom_zones=zones)
    return StrapQuestion(
        StrapHardware.from_straps(straps),
        request,
        tuple(SpatialLoad.from_planar_load(load) for load in query.loads),
        query.friction,
        query.safety_factor,
        query.weight or 0.0,
        straps.is_over_supports,
        query.program,
    )


def find_straps(
    fixture: Fixture, query: Query, asked: StrapQuestion, cancel: Event | None = None
) -> StrappedHold:
    """Return the straps that hold a part with the least force against the three locators of a fixture on a plate.

    What pushes the part sideways in the fixture is not there; a hand does it until the straps are tight.

    Raises
    ------
    InputError
        For a fixture that has other than three locators on one plate.
    """
    return StrapSearch(fixture, query, asked).find_best(cancel)


def ask_for_straps(
    fixture: Fixture,
    thickness: float | None,
    straps: StrapHardware,
    *,
    loads: Sequence[Load | SpatialLoad] | None = None,
    friction: Mapping[str, float] | None = None,
    safety: float | None = None,
    weight: float = 0.0,
    zones: Sequence[Zone] = (),
) -> StrappedHold:
    """Return the straps of a fixture, with what nobody says as usual; see
    :meth:`workhold.model.fixture.Fixture.straps`.
    """
    query = fixture.listing.result.query
    given = query.loads if loads is None else loads
    if not given:
        raise InputError(NO_LOADS)
    spatial = tuple(
        load if isinstance(load, SpatialLoad) else SpatialLoad.from_planar_load(load) for load in given
    )
    request = make_usual_request(query, thickness, straps.tip_radius, zones)
    factor = SAFETY if safety is None else safety
    if not (isfinite(factor) and factor > 0):
        raise InputError(f"safety factor {factor:g} cannot be used: give a number above 0, such as 2.")
    if not (isfinite(weight) and weight >= 0):
        raise InputError(f"weight {weight:g} cannot be used: give it in N, 0 or more.")
    asked = StrapQuestion(straps, request, spatial, to_coefficients(friction), factor, weight)
    return find_straps(fixture, query, asked)


@frozen(eq=False)
class StrapSearch:
    """The search for the straps of a fixture; see :func:`find_straps`."""

    fixture: Fixture
    query: Query
    asked: StrapQuestion

    @cached_property
    def locators(self) -> list[int]:
        """The numbers of the pegs that stand still, among them the ends of a contact with a wall."""
        still = self.asked.list_locators(self.fixture)
        return [number for number, peg in enumerate(self.fixture.pegs) if any(peg is one for one in still)]

    @cached_property
    def part(self) -> StrappedPart:
        """The part on the plate."""
        return self.part_on(self.foot)

    def part_on(self, below: PressedPolygon | Array) -> StrappedPart:
        """The part on its foot, or on points (S, 2) of supports."""
        fixture, request = self.fixture, self.asked.request
        touched, inward = fixture.contact_points[self.locators], -fixture.normals[self.locators]
        workpiece = self.query.workpiece
        bands = request.adapt_to_fixture(fixture, workpiece.solid, numbered=workpiece.numbered)
        heights = bands.list_peg_bands(len(fixture.pegs))[self.locators]
        return StrappedPart(
            touched, inward, heights, below, find_friction_coefficient(self.asked.friction, self.asked.below)
        )

    @cached_property
    def foot(self) -> PressedPolygon:
        """What of the part lies on the plate, in the plate's frame."""
        loops = self.asked.request.bottom or self.query.workpiece.loops
        return PressedPolygon(
            tuple(
                self.fixture.pose.apply(flatten_loop(make_loop_segments(np.asarray(loop)))) for loop in loops
            )
        )

    @cached_property
    def places(self) -> StrapPlaces:
        query, asked = self.query, self.asked
        places = find_strap_places(self.fixture, query.workpiece, query.toolkit, asked.request, asked.straps)
        straps = query.toolkit.strap_set
        if asked.program is None or straps is None:
            return places
        bolts = asked.get_bolt_holes(self.fixture)
        clear = are_clear(
            asked.program,
            self.fixture.pose,
            places.at,
            np.column_stack(bolts.compute_hole_center(places.hole[:, 0], places.hole[:, 1])).reshape(-1, 2),
            self.measure_heights(places.at),
            straps,
        )
        return StrapPlaces(places.hole[clear], places.at[clear])

    @cached_property
    def heights(self) -> Array:
        """The height (P,) of the face on which a tip presses at each place, in mm."""
        return self.measure_heights(self.places.at)

    def measure_heights(self, at: Array) -> Array:
        """The heights (N,) in mm of the face on which tips at points (N, 2) of the plate press, above its foot."""
        request, back = self.asked.request, self.fixture.pose.inverse
        return np.array([request.find_clamped_height((float(x), float(y))) for x, y in back.apply(at)])

    @cached_property
    def down(self) -> Array:
        """Wrenches (P, 6) of the unit force of a tip at each place."""
        return self.part.compute_level_wrenches(self.places.at, self.heights, (0.0, 0.0, -1.0))

    @cached_property
    def tip_friction(self) -> Array:
        """Wrenches (P, 16, 6) of unit forces of friction of a tip at each place."""
        return self.part.compute_friction_wrenches(self.places.at, self.heights)

    @property
    def coefficient(self) -> float:
        return find_friction_coefficient(self.asked.friction, "tip")

    @cached_property
    def loads(self) -> list[Array]:
        """The wrenches (N, 6) of the corners of each load, with the safety factor, and of the weight."""
        part, asked, weight = self.part, self.asked, self.weight
        out = []
        for load in asked.loads:
            points, forces = list_load_corners(load.with_height(asked.request.thickness), self.fixture)
            rows = part.compute_wrenches(points, forces)
            tilt = self.fixture.pose.turn(np.array([load.tilt]))[0]
            rows[:, 3:] += np.array([*tilt, load.moment]) / part.length
            out.append(rows * asked.safety + weight)
        return out

    @cached_property
    def weight(self) -> Array:
        """The wrench (6,) of the part's weight, at the middle of its foot."""
        integrals = self.foot.integrals[0]
        middle = (integrals[1:] / integrals[0])[None]
        return np.asarray(
            self.asked.weight * self.part.compute_level_wrenches(middle, 0.0, (0.0, 0.0, -1.0))[0]
        )

    @cached_property
    def cuts(self) -> CuttingPieces | None:
        """Where the tools of the program press on the part; None where they do nowhere, or nobody says how hard."""
        program = self.asked.program
        if program is None or program.forces is None:
            return None
        cuts = CuttingPieces.from_program(program, self.asked.request.thickness)
        return cuts if len(cuts) else None

    def program_need(self, grip: StrapsOnPart) -> ProgramJawForce | None:
        """What the tools of the program ask of each strap; None without their forces."""
        cuts, program, pose = self.cuts, self.asked.program, self.fixture.pose
        if cuts is None or program is None:
            return None
        theta = radians(pose.theta_deg)
        return find_worst_move(grip, cuts, program, theta, (pose.x, pose.y), self.asked.safety, self.weight)

    def reckon(self, grip: StrapsOnPart, keep: Callable[[Array, float], None], enough: float) -> float:
        """The force that loads and program ask of straps, or a bound that is not below ``enough``.

        Of a program it is what the hardest load asks for that an ascent finds; what is told in the end is proven
        (:meth:`program_need`). Each motion (6,) that a load drives, with its power, is handed to ``keep``.
        """
        program, need = MotionProgram(grip), 0.0
        for row in (row for rows in self.loads for row in rows):
            force, motion = program.find_driven_motion(row)
            power = float(-row @ motion)
            if force is None:
                keep(motion / np.abs(motion).max(), power / np.abs(motion).max())
                return inf
            if force > need:
                need = force
                keep(motion, power)
            if need > enough:
                return need
        return need if self.cuts is None else max(need, self.reckon_program(self.cuts, grip, keep))

    def reckon_program(
        self, cuts: CuttingPieces, grip: StrapsOnPart, keep: Callable[[Array, float], None]
    ) -> float:
        """The force that the program asks of straps by its hardest load; as of :meth:`reckon`."""
        pose, motions = self.fixture.pose, MotionProgram(grip)
        theta = radians(pose.theta_deg)
        pressed = PressedPart(cuts, grip, motions, theta, (pose.x, pose.y), self.asked.safety, self.weight)
        force, _, hardest = pressed.climb()
        for motion in motions.motions:
            load, _ = pressed.find_hardest_load(motion)
            keep(motion, float(-load @ motion))
        if force == inf:
            _, motion = motions.find_driven_motion(hardest)
            keep(motion / np.abs(motion).max(), float(-hardest @ motion) / np.abs(motion).max())
        return force

    def place_straps(self, chosen: Sequence[int]) -> StrapsOnPart:
        """Return the part with straps at some places."""
        numbers = list(chosen)
        return StrapsOnPart(self.part, self.down[numbers], self.tip_friction[numbers], self.coefficient)

    def compute_needs(self, chosen: Sequence[int]) -> tuple[float | None, ...]:
        """Return the force in N of each strap at some places that each load asks for; None where none is enough."""
        return self.needs_of(self.place_straps(chosen))

    def needs_of(self, grip: StrapsOnPart) -> tuple[float | None, ...]:
        """The force in N of each strap of a part that each load asks for; None where none is enough."""
        program = MotionProgram(grip)
        out = []
        for rows in self.loads:
            forces = [program.find_least_force(row) for row in rows]
            out.append(
                None if None in forces else max((one for one in forces if one is not None), default=0.0)
            )
        return tuple(out)

    def find_compatible_pairs(self) -> BoolArray:
        """Return whether two straps can be at two places (P, P): bolts in two holes, and tips side by side."""
        hole, at = self.places.hole, self.places.at
        same = (hole[:, None] == hole[None]).all(axis=2)
        apart = np.hypot(*np.moveaxis(at[:, None] - at[None], 2, 0))
        return np.asarray(~same & (apart >= 2 * self.asked.straps.tip_radius - ALIKE))

    def find_best(self, cancel: Event | None = None) -> StrappedHold:
        """Return the straps that need the least force."""
        if self.asked.is_over_supports:
            return self.best_over_supports(cancel)
        hold = evolve(self.find_unloaded_hold(), places=len(self.places))
        chosen = SetSearch(self).find_least(self.asked.straps.count, cancel)
        if chosen is None:
            return hold
        each = self.compute_needs(chosen)
        straps = tuple(
            Strap(
                (int(self.places.hole[k, 0]), int(self.places.hole[k, 1])),
                (float(self.places.at[k, 0]), float(self.places.at[k, 1])),
                float(self.heights[k]),
            )
            for k in chosen
        )
        return evolve(
            hold,
            straps=straps,
            clamp_needed_each=each,
            program_need=self.program_need(self.place_straps(chosen)),
        )

    def best_over_supports(self, cancel: Event | None = None) -> StrappedHold:
        """The supports and the straps over them that need the least force."""
        pads = PadPlaces.of(self)
        hold, found = evolve(self.find_unloaded_hold(), places=len(pads)), SupportedStraps(self, pads)
        chosen = found.least(cancel)
        if chosen is None:
            return hold
        raised = (self.query.toolkit.supports or SupportPads()).height or 0.0
        bolts = found.find_bolts(chosen.strapped)
        assert bolts is not None
        holes = [(int(column), int(row)) for column, row in pads.hole]
        straps = tuple(
            Strap(
                bolt, (float(pads.at[k, 0]), float(pads.at[k, 1])), float(found.heights[k]) + raised, holes[k]
            )
            for k, bolt in zip(chosen.strapped, bolts, strict=True)
        )
        return evolve(
            hold,
            straps=straps,
            clamp_needed_each=found.needs(chosen),
            program_need=self.program_need(found.on(chosen)),
            supports=tuple(holes[k] for k in chosen.pads),
        )

    def find_unloaded_hold(self) -> StrappedHold:
        """Return the push by hand alone, without any straps."""
        workpiece = self.query.workpiece
        segments = [self.fixture.pose.carry(one) for one in workpiece.segments[: workpiece.outer_count]]
        push = find_hand_push(segments, self.part.touched, self.part.inward)
        return StrappedHold((), push, None, (), self.asked.straps.max_force)

    @cached_property
    def kern(self) -> Array:
        """The sides (R, 3) of the kern of the foot, a x + b y <= c within, of unit normals."""
        corners = np.array(compute_convex_hull((float(x), float(y)) for x, y in self.foot.centres))
        along = np.roll(corners, -1, axis=0) - corners
        normals = np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]
        return np.column_stack([normals, (normals * corners).sum(axis=1)])

    def find_pressing_flat(self, sets: IntArray) -> BoolArray:
        """Return whether the plate bears all over the foot where straps at sets of places (N, K) press: in its
        kern.
        """
        middle = np.zeros((len(sets), 2))
        for k in range(sets.shape[1]):
            middle += self.places.at[sets[:, k]] / sets.shape[1]
        out = np.ones(len(sets), np.bool_)
        for a, b, most in self.kern:
            out &= a * middle[:, 0] + b * middle[:, 1] <= most + KERN_SLACK
        return out


@define(eq=False)
class SetSearch:
    """The sets of places, with the bounds that motions found so far give each.

    Parameters
    ----------
    search : whose places they are.
    work : (P, M) that the straps at each place do on each motion, with their friction, per unit of force.
    power : (M,) of the load that drives each motion.
    """

    search: StrapSearch
    work: Array = field(init=False)
    power: Array = field(init=False)
    least_force: float = field(init=False, default=inf)
    chosen: tuple[int, ...] | None = field(init=False, default=None)

    def __attrs_post_init__(self) -> None:
        self.work, self.power = np.zeros((len(self.search.places), 0)), np.zeros(0)

    def find_least(self, count: int, cancel: Event | None = None) -> tuple[int, ...] | None:
        """Return the places of so many straps that need the least force, in order; None where there are no such
        places.

        Where no force is enough it is the first set.
        """
        may = self.search.find_compatible_pairs()
        for sets in list_sets(may, count, self.can_improve):
            if cancel is not None and cancel.is_set():
                break
            self.search_sets(sets)
        return self.chosen

    def bound_forces(self, sets: IntArray, since: int = 0) -> Array:
        """Return the least force (N,) that sets (N, K) may need, by the motions from one on; infinite where none is
        enough.
        """
        work, power = self.work[:, since:], self.power[since:]
        out = np.zeros(len(sets))
        for number, driven in enumerate(power):
            own = work[:, number]
            done = own[sets[:, 0]].copy()
            for k in range(1, sets.shape[1]):
                done += own[sets[:, k]]
            np.maximum(out, np.divide(driven, done, out=np.full(len(sets), inf), where=done > 0.0), out=out)
        return out

    def can_improve(self, taken: Sequence[int], more: int) -> bool:
        """Return whether some set with these places, and so many more, may need less than what was found."""
        if not len(self.power) or self.least_force == inf:
            return True
        most = self.work[list(taken)].sum(axis=0) + more * np.maximum(self.work.max(axis=0), 0.0)
        with np.errstate(divide="ignore"):
            bound = np.where(most > 0.0, self.power / np.where(most > 0.0, most, 1.0), inf).max()
        return bool(bound < self.least_force * (1.0 - ALIKE))

    def search_sets(self, sets: IntArray) -> None:
        """Look among sets (N, K) for one that needs less than the best so far."""
        sets = sets[self.search.find_pressing_flat(sets)]
        bounds, seen = self.bound_forces(sets), len(self.power)
        if self.chosen is None and len(sets):
            self.chosen = tuple(sets[0].tolist())
        while len(sets):
            first = int(bounds.argmin())
            if bounds[first] >= self.least_force * (1.0 - ALIKE) or bounds[first] == inf:
                return
            need = self.compute_force(sets[first])
            if need < self.least_force:
                self.least_force, self.chosen = need, tuple(sets[first].tolist())
            bounds = np.maximum(bounds, self.bound_forces(sets, seen))
            bounds[first], seen = inf, len(self.power)

    def compute_force(self, chosen: IntArray) -> float:
        """Return the force that a set (K,) needs, or a bound that is not below the best; its motions are kept."""
        search = self.search
        return search.reckon(search.place_straps(chosen.tolist()), self.keep_motion, self.least_force)

    def keep_motion(self, motion: Array, power: float) -> None:
        """Keep a motion (6,) that a load drives with a power."""
        search = self.search
        rubbed = (search.tip_friction @ motion).max(axis=1, initial=0.0)
        work = search.down @ motion + search.coefficient * rubbed
        self.work = np.column_stack([self.work, work])
        self.power = np.append(self.power, power)


def list_sets(
    may: BoolArray, count: int, is_promising: Callable[[Sequence[int], int], bool]
) -> Iterator[IntArray]:
    """Return the sets (N, K) of places that may stand together by (P, P), in order; those of the same first ones at once."""

    def extend(taken: tuple[int, ...], free: IntArray) -> Iterator[IntArray]:
        more = count - len(taken)
        if more == 1:
            yield np.column_stack([*(np.full(len(free), one) for one in taken), free])
        elif more == 2:
            one, other = np.nonzero(np.triu(may[np.ix_(free, free)], 1))
            pairs = np.column_stack([free[one], free[other]])
            yield np.column_stack([*(np.full(len(pairs), one) for one in taken), pairs])
        else:
            for number, place in enumerate(free.tolist()):
                if is_promising((*taken, place), more - 1):
                    rest = free[number + 1 :]
                    yield from extend((*taken, place), rest[may[place, rest]])

    yield from extend((), np.arange(len(may)))


def list_load_corners(load: SpatialLoad, fixture: Fixture) -> tuple[Array, Array]:
    """Return points (N, 3) in mm and forces (N, 3) in N on the plate, the worst of a load among them."""
    pose = fixture.pose
    low, high = (radians(angle + pose.theta_deg) for angle in load.directions)
    ways = enclose_directions(low, high) if load.force else np.zeros((1, 2))
    points = pose.apply(np.array(load.points or ((0.0, 0.0),)))
    heights = sorted(set(load.heights or (0.0, 0.0)))
    rows = [
        ((x, y, z), (load.force * way[0], load.force * way[1], -axial))
        for (x, y), z, axial, way in product(points.tolist(), heights, sorted(set(load.axial)), ways.tolist())
    ]
    places, forces = (np.array(some) for some in zip(*rows, strict=True))
    return places, forces


def flatten_loop(segments: Sequence[Segment]) -> Array:
    """Return the corners (N, 2) of a loop whose arcs are chords, at most 0.1 mm off."""
    out = list[tuple[float, float]]()
    for one in segments:
        if not isinstance(one, Arc):
            out.append(one.start)
            continue
        half = acos(max(1.0 - CHORD / one.radius, 0.0))
        count = max(ceil(one.half_sweep / half), 1)
        for k in range(count):
            angle = one.mid_angle + one.sign * one.half_sweep * (2 * k / count - 1.0)
            out.append((one.center[0] + one.radius * cos(angle), one.center[1] + one.radius * sin(angle)))
    return np.array(out)
