"""The straps that hold a part down on a plate with the least force, exact over a finite set of places.

The force that a set of straps needs is a linear program with six equations (``statics.friction``). Its dual
is a motion of the part that locators and plate allow. A motion bounds the force of every set of straps: no
set needs less than the work of the load on this motion divided by the work that the straps of the set do on
it per unit of force. The force of the set with the least bound is computed, which gives new motions, until no
bound is below the least force found. For most sets the force is never computed.

The straps alone must press the part flat on the plate: the middle of their tips lies in the kern of the
part's foot, which is the set of its possible centres of pressure. So straps that hold at a force hold at
every greater force.
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
    SAFETY,
    Coefficients,
    find_friction_coefficient,
    to_coefficients,
)
from workhold.model.jaw_hold import ProgramJawForce, find_largest_force
from workhold.model.program import Program
from workhold.model.query import Query
from workhold.model.requirements import Load, Zone
from workhold.model.straps import Strap, StrapHardware, StrappedHold, bound_safety
from workhold.model.support_request import SpatialLoad, SupportRequest
from workhold.statics.friction import MotionProgram, enclose_directions
from workhold.statics.jaw_program import CuttingPieces, PressedPart, find_worst_move
from workhold.statics.patches import PressedPolygon
from workhold.statics.strapped import PressingTips, StrappedPart, StrapsOnPart
from workhold.supports.hand_push import find_hand_push
from workhold.supports.strap_places import StrapPlaces, find_strap_places
from workhold.supports.straps_beside_part import are_beside_rising
from workhold.supports.straps_over_supports import ALIKE, PadPlaces, SupportedStraps
from workhold.supports.straps_past_tools import are_clear

__all__ = [
    "NO_LOADS",
    "PadSizes",
    "StrapQuestion",
    "StrapSearch",
    "ask_for_straps",
    "choose_support_height",
    "find_given_force",
    "make_pads_request",
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
LOCATORS = 3
# What stands for the thickness in mm of a part that nothing loads, where nobody says.
UNKNOWN_HEIGHT = 1.0
NO_LOADS = "straps are chosen by the force that loads ask for: give one load or more."


@frozen
class PadSizes:
    """Sizes of supports under straps, in mm; None for the toolkit's sizes, or the usual ones.

    Parameters
    ----------
    radius : radius of the round pads.
    margin : smallest distance of a pad from the border of the face that it supports.
    height : height of the supports above the plate.
    """

    radius: float | None = None
    margin: float | None = None
    height: float | None = None


@frozen
class StrapQuestion:
    """A request for straps: the hardware, the part, the loads and the friction.

    Parameters
    ----------
    straps : number, reach, tips and rated force of the straps.
    request : thickness of the part, and faces that tips and plate may touch; its fields of a clamp are not
        used.
    loads : loads that act on the part, each by itself.
    friction : coefficients of friction by name, such as "tip" and "plate"; None for usual ones.
    safety : factor on the loads.
    weight : weight of the part in N, not multiplied by ``safety``; it acts at the middle of the foot.
    is_over_supports : whether the part lies on three supports, and each tip presses over one of them.
    program : program whose tools must clear the straps; their forces on the part, if known, count as loads.
        None for none.
    given_force : given force in N of each strap at its tip, to state the safety against the loads; None if
        not given.
    support_height : height in mm of the supports above the plate; None if not given.
    peg_height : height of the locators in mm, to warn of locators that a tool of the program would hit; None
        if the tools are known to clear all of them.
    """

    straps: StrapHardware
    request: SupportRequest
    loads: tuple[SpatialLoad, ...] = ()
    friction: Coefficients | None = None
    safety: float = SAFETY
    weight: float = 0.0
    is_over_supports: bool = False
    program: Program | None = None
    given_force: float | None = None
    support_height: float | None = None
    peg_height: float | None = None

    @property
    def below(self) -> str:
        """Name of the coefficient of friction between the part and its rest: "support" or "plate"."""
        return "support" if self.is_over_supports else "plate"

    @property
    def counted(self) -> tuple[str, str]:
        """Names of the two coefficients of friction that are used."""
        return "tip", self.below

    def find_plate(self, fixture: Fixture) -> Carrier:
        """Return the plate of a fixture, with the holes for locators."""
        return next(one for one in get_toolkit(fixture).carriers if one.has_lattice and one.travel is None)

    def get_bolt_holes(self, fixture: Fixture) -> Carrier:
        """Return the lattice of holes for bolts on the plate of a fixture.

        It is the plate itself unless the toolkit gives bolts holes of their own.
        """
        straps = get_toolkit(fixture).strap_set
        return self.find_plate(fixture) if straps is None else straps.bolts

    def list_locators(self, fixture: Fixture) -> list[Peg]:
        """Return the three pegs of a fixture that stand still; an end
        of a contact with a wall counts as a peg.

        Raises
        ------
        InputError
            For more or fewer than three locators, and for more or less than one plate.
        """
        toolkit = get_toolkit(fixture)
        still = [peg for peg in fixture.pegs if toolkit.find_carrier(peg.carrier).travel is None]
        if len(toolkit.plates) != 1 or len(still) != LOCATORS:
            raise InputError(
                "straps hold a part against three locators on one plate: take a fixture on a plate, or beside a fence."
            )
        return still


def get_toolkit(fixture: Fixture) -> Toolkit:
    """Return the toolkit of the result that a fixture belongs to."""
    return fixture.listing.result.toolkit


def make_usual_request(
    query: Query, thickness: float | None, tip_radius: float, zones: Sequence[Zone] = ()
) -> SupportRequest:
    """Return the faces of a part that tips and plate may touch, with the part's thickness.

    The faces are those of the part's solid, if it has one.

    Parameters
    ----------
    thickness : thickness of the part in mm; None for that of its solid.
    zones : zones in which no tip may stand.
    """
    usual = SupportRequest.from_workpiece(query.workpiece, thickness, tip_radius=tip_radius)
    return evolve(usual, top_zones=tuple(zones))


def make_pads_request(
    query: Query, request: SupportRequest, zones: Sequence[Zone], sizes: PadSizes | None = None
) -> SupportRequest:
    """Return a request for the faces of a part with the pads of supports, which keep off zones below.

    ``sizes`` are given sizes of the pads; missing ones are those of the toolkit, or else the usual ones.
    Raises InputError for pads that do not fit between holes.
    """
    given = sizes or PadSizes()
    pads = SupportRequest.from_workpiece(
        query.workpiece, request.thickness, pad_radius=given.radius, toolkit=query.toolkit
    )
    pads.refuse_fat_pads(query.toolkit)
    margin = pads.pad_margin if given.margin is None else given.margin
    return evolve(request, pad_radius=pads.pad_radius, pad_margin=margin, bottom_zones=tuple(zones))


def make_question(query: Query) -> StrapQuestion:
    """Return the request for straps that a query with straps in its toolkit makes.

    Tips keep off the query's keep-out zones, and so do pads of supports.
    """
    straps = query.toolkit.strap_set
    assert straps is not None
    # Without loads nobody need know how thick the part is.
    height = None if query.part_height is not None else UNKNOWN_HEIGHT
    zones = query.restrictions.zones
    request = make_usual_request(query, height or query.thickness, straps.tip_radius, zones)
    if straps.is_over_supports:
        request = make_pads_request(query, request, zones)
    return StrapQuestion(
        StrapHardware.from_straps(straps),
        request,
        tuple(SpatialLoad.from_planar_load(load) for load in query.loads),
        query.friction,
        query.safety_factor,
        query.weight or 0.0,
        straps.is_over_supports,
        query.program,
        query.jaw_force,
        choose_support_height(query),
    )


def find_given_force(query: Query) -> float | None:
    """Return the force in N that a query gives for each strap; None if it gives none.

    Without straps in its toolkit the query's jaw force is that of a clamp and does not count.
    """
    return query.jaw_force if query.toolkit.strap_set is not None else None


def choose_support_height(query: Query, pads: PadSizes | None = None) -> float | None:
    """Return the height of the supports in mm: as given, else as in the query's toolkit, else None."""
    own = (query.toolkit.supports or SupportPads()).height
    return own if pads is None or pads.height is None else pads.height


def find_straps(
    fixture: Fixture, query: Query, asked: StrapQuestion, cancel: Event | None = None
) -> StrappedHold:
    """Return the straps that hold a part with the least force against
    the three locators of a fixture on a plate.

    Clamps of the fixture are not used; a hand pushes the part against the locators until the straps are
    tight. After ``cancel``, the best straps found so far.

    Raises
    ------
    InputError
        For more or fewer than three locators, and for more or less than one plate.
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
    jaw_force: float | None = None,
    pads: PadSizes | None = None,
    zones_below: Sequence[Zone] = (),
    program: Program | None = None,
) -> StrappedHold:
    """Return the straps of a fixture; see :meth:`workhold.model.fixture.Fixture.straps`.

    None stands for the usual value of a parameter: ``loads`` of the query, ``thickness`` of the solid, usual
    ``friction`` and ``safety``.
    """
    query = fixture.listing.result.query
    given = query.loads if loads is None else loads
    passed = query.program if program is None else program.keep_forces_on(query.workpiece.outer_loops)
    if not given and (passed is None or passed.forces is None):
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
    if jaw_force is not None and not (isfinite(jaw_force) and jaw_force >= 0):
        raise InputError(f"force {jaw_force:g} of each strap cannot be used: give it in N, 0 or more.")
    force = find_given_force(query) if jaw_force is None else jaw_force
    if pads is not None:
        request = make_pads_request(query, request, zones_below, pads)
    asked = StrapQuestion(
        straps,
        request,
        spatial,
        to_coefficients(friction),
        factor,
        weight,
        is_over_supports=pads is not None,
        program=passed,
        given_force=force,
        support_height=choose_support_height(query, pads),
    )
    return evolve(
        find_straps(fixture, query, asked),
        tip_radius=straps.tip_radius,
        pad_radius=None if pads is None else request.pad_radius,
        support_height=None if pads is None else asked.support_height,
    )


@frozen(eq=False)
class StrapSearch:
    """The search for the straps of a fixture; see :func:`find_straps`.

    Arrays with P rows have a row for each of the P places for a strap.
    """

    fixture: Fixture
    query: Query
    asked: StrapQuestion

    @cached_property
    def locators(self) -> list[int]:
        """Indices of the fixture's pegs that stand still; an end of a contact with a wall counts as a peg."""
        still = self.asked.list_locators(self.fixture)
        return [number for number, peg in enumerate(self.fixture.pegs) if any(peg is one for one in still)]

    @cached_property
    def part(self) -> StrappedPart:
        """The part on the plate, without straps."""
        return self.make_part_on(self.foot)

    def make_part_on(self, below: PressedPolygon | Array) -> StrappedPart:
        """Return the part, without straps, on its foot or on the points (S, 2) of S supports."""
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
        """Outline of the part's lower face, which lies on the plate, in the plate's frame."""
        loops = self.asked.request.bottom or self.query.workpiece.loops
        return PressedPolygon(
            tuple(
                self.fixture.pose.apply(flatten_loop(make_loop_segments(np.asarray(loop)))) for loop in loops
            )
        )

    @cached_property
    def places(self) -> StrapPlaces:
        """Places for straps; without those at which a tool of the program would hit the strap."""
        query, asked = self.query, self.asked
        places = find_strap_places(self.fixture, query.workpiece, query.toolkit, asked.request, asked.straps)
        bolts = asked.get_bolt_holes(self.fixture)
        holes = np.column_stack(bolts.compute_hole_center(places.hole[:, 0], places.hole[:, 1]))
        clear = self.find_clear(places.at, holes.reshape(-1, 2))
        return StrapPlaces(places.hole[clear], places.at[clear])

    def find_clear(self, tip: Array, bolt: Array) -> BoolArray:
        """Return a mask (N,): True for straps that do not collide with the part and that all tools clear.

        ``tip`` and ``bolt`` (N, 2) are the points at which they press, and the centres of their bolts, in mm in
        the plate's frame.
        """
        asked, pose = self.asked, self.fixture.pose
        if asked.program is None and not asked.request.rising:
            return np.ones(len(tip), np.bool_)
        heights = self.measure_heights(tip)
        clear = are_beside_rising(asked.request, pose, tip, bolt, heights, asked.straps.tip_radius)
        if asked.program is not None:
            clear &= are_clear(asked.program, pose, tip, bolt, heights, asked.straps)
        return clear

    def measure_heights(self, at: Array) -> Array:
        """Return the height in mm, above the part's lower side, of the
        face under tips at points (N, 2), as (N,).

        The points are in mm in the plate's frame.
        """
        request, back = self.asked.request, self.fixture.pose.inverse
        return np.array([request.find_clamped_height((float(x), float(y))) for x, y in back.apply(at)])

    @cached_property
    def tips(self) -> PressingTips:
        """Tips at all P places."""
        return self.make_tips(self.part, self.places.at)

    def make_tips(self, part: StrappedPart, at: Array) -> PressingTips:
        """Return the tips that may press on a part at points (N, 2), in mm in the plate's frame."""
        friction = find_friction_coefficient(self.asked.friction, "tip")
        return PressingTips(part, at, self.measure_heights(at), friction)

    @cached_property
    def loads(self) -> list[Array]:
        """Wrenches (N, 6) of each load's corners, multiplied by the
        safety factor, with the part's weight added.
        """
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
        """Wrench (6,) of the part's weight, which acts at the middle of its foot."""
        integrals = self.foot.integrals[0]
        middle = (integrals[1:] / integrals[0])[None]
        return np.asarray(
            self.asked.weight * self.part.compute_level_wrenches(middle, 0.0, (0.0, 0.0, -1.0))[0]
        )

    @cached_property
    def cuts(self) -> CuttingPieces | None:
        """Pieces of the program's path on which tools press on the part;
        None without such pieces or without forces.
        """
        program = self.asked.program
        if program is None or program.forces is None:
            return None
        cuts = CuttingPieces.from_program(program, self.asked.request.thickness)
        return cuts if len(cuts) else None

    def find_program_need(self, grip: StrapsOnPart, is_weighed: bool = True) -> ProgramJawForce | None:
        """Return the largest strap force that the program's tools need, with its move; None without their
        forces.

        ``is_weighed`` tells whether the part's weight acts as well.
        """
        cuts, program, pose = self.cuts, self.asked.program, self.fixture.pose
        if cuts is None or program is None:
            return None
        theta, weight = radians(pose.theta_deg), self.weight if is_weighed else None
        return find_worst_move(grip, cuts, program, theta, (pose.x, pose.y), self.asked.safety, weight)

    def add_forces(self, hold: StrappedHold, grip: StrapsOnPart) -> StrappedHold:
        """Return a hold with the forces that loads and program need of its straps.

        If a force of the straps is given, the hold also has the safety of that force against each load and
        the program.
        """
        asked = self.asked
        out = evolve(
            hold, clamp_needed_each=self.compute_needs_of(grip), program_need=self.find_program_need(grip)
        )
        if asked.given_force is None:
            return out
        bare, still = (
            out.needs,
            0.0 if not asked.weight else MotionProgram(grip).find_least_force(self.weight),
        )
        if asked.weight:
            alone = self.find_program_need(grip, is_weighed=False)
            bare = (*self.compute_needs_of(grip, self.weight), *(() if alone is None else (alone.force,)))
        times = (
            bound_safety(asked.given_force, asked.safety, need, without, still)
            for need, without in zip(out.needs, bare, strict=True)
        )
        return evolve(out, safety_each=tuple(times))

    def compute_force(self, grip: StrapsOnPart, keep: Callable[[Array, float], None], enough: float) -> float:
        """Return the force in N of each strap that loads and program need,
        or a lower bound of it that exceeds ``enough``.

        inf where no force holds. For a program, the need is that of the hardest load found by an ascent; the
        need in the final answer is proven (:meth:`find_program_need`). ``keep`` is called with each motion (6,)
        that a load drives, and the power of the load on it.
        """
        program, need = MotionProgram(grip), 0.0
        for row in (row for rows in self.loads for row in rows):
            force, motion = program.find_driven_motion(row)
            power = float(-row @ motion)
            if force is None:
                size = np.abs(motion).max()
                keep(motion / size, power / size)
                return inf
            if force > need:
                need = force
                keep(motion, power)
            if need > enough:
                return need
        return need if self.cuts is None else max(need, self.compute_program_force(self.cuts, grip, keep))

    def compute_program_force(
        self, cuts: CuttingPieces, grip: StrapsOnPart, keep: Callable[[Array, float], None]
    ) -> float:
        """Return the force in N of each strap that the program needs,
        by the hardest load that an ascent finds.

        ``keep`` is called as in :meth:`compute_force`.
        """
        pose, motions = self.fixture.pose, MotionProgram(grip)
        theta = radians(pose.theta_deg)
        pressed = PressedPart(cuts, grip, motions, theta, (pose.x, pose.y), self.asked.safety, self.weight)
        force, _, hardest = pressed.find_hard_load()
        for motion in motions.motions:
            load, _ = pressed.find_hardest_load(motion)
            keep(motion, float(-load @ motion))
        if force == inf:
            _, motion = motions.find_driven_motion(hardest)
            size = np.abs(motion).max()
            keep(motion / size, float(-hardest @ motion) / size)
        return force

    def compute_needs(self, chosen: Sequence[int]) -> tuple[float | None, ...]:
        """Return, for each load, the force in N that each strap at some
        places needs; None where no force holds the load.
        """
        return self.compute_needs_of(self.tips.press(chosen))

    def compute_needs_of(self, grip: StrapsOnPart, less: Array | float = 0.0) -> tuple[float | None, ...]:
        """Return, for each load, the force in N that each strap on a part
        needs; None where no force holds the load.

        ``less`` is a wrench (6,) that is subtracted from every load, such as the weight's.
        """
        program = MotionProgram(grip)
        out = []
        for rows in self.loads:
            out.append(find_largest_force([program.find_least_force(row - less) for row in rows]))
        return tuple(out)

    def find_compatible_pairs(self) -> BoolArray:
        """Return a mask (P, P): True for two places whose bolts are in
        different holes and whose tips do not overlap.
        """
        hole, at = self.places.hole, self.places.at
        same = (hole[:, None] == hole[None]).all(axis=2)
        apart = np.hypot(*np.moveaxis(at[:, None] - at[None], 2, 0))
        return np.asarray(~same & (apart >= 2 * self.asked.straps.tip_radius - ALIKE))

    def find_best(self, cancel: Event | None = None) -> StrappedHold:
        """Return the straps that need the least force; a hold without straps if there are no places for them.

        After ``cancel``, the best straps found so far.
        """
        if self.asked.is_over_supports:
            return self.find_best_over_supports(cancel)
        hold = evolve(self.find_unloaded_hold(), places=len(self.places))
        chosen = SetSearch(self).find_least(self.asked.straps.count, cancel)
        if chosen is None:
            return hold
        straps = tuple(
            Strap(
                (int(self.places.hole[k, 0]), int(self.places.hole[k, 1])),
                (float(self.places.at[k, 0]), float(self.places.at[k, 1])),
                float(self.tips.heights[k]),
            )
            for k in chosen
        )
        return self.add_forces(evolve(hold, straps=straps), self.tips.press(chosen))

    def find_best_over_supports(self, cancel: Event | None = None) -> StrappedHold:
        """Return the supports, and the straps over them, that need the least force.

        A hold without straps where there are no places for them.
        """
        pads = PadPlaces.from_search(self)
        hold, found = evolve(self.find_unloaded_hold(), places=len(pads)), SupportedStraps(self, pads)
        chosen = found.find_least(cancel)
        if chosen is None:
            return hold
        raised = self.asked.support_height or 0.0
        bolts = found.find_bolts(chosen.strapped)
        assert bolts is not None
        holes = [(int(column), int(row)) for column, row in pads.hole]
        straps = tuple(
            Strap(
                bolt,
                (float(pads.at[k, 0]), float(pads.at[k, 1])),
                float(found.tips.heights[k]) + raised,
                holes[k],
            )
            for k, bolt in zip(chosen.strapped, bolts, strict=True)
        )
        supports = tuple(holes[k] for k in chosen.pads)
        return self.add_forces(evolve(hold, straps=straps, supports=supports), found.place_straps(chosen))

    def find_unloaded_hold(self) -> StrappedHold:
        """Return a hold with the push by hand alone, without any straps."""
        workpiece = self.query.workpiece
        segments = [self.fixture.pose.carry(one) for one in workpiece.segments[: workpiece.outer_count]]
        push = find_hand_push(segments, self.part.touched, self.part.inward)
        return StrappedHold((), push, None, (), self.asked.straps.max_force)

    @cached_property
    def kern(self) -> Array:
        """Sides (R, 3) of the kern of the foot: rows (a, b, c) with the unit normal (a, b) and a x + b y <= c
        inside.

        The kern is the set of possible centres of pressure of the foot.
        """
        corners = np.array(compute_convex_hull((float(x), float(y)) for x, y in self.foot.centres))
        along = np.roll(corners, -1, axis=0) - corners
        normals = np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]
        return np.column_stack([normals, (normals * corners).sum(axis=1)])

    def find_pressing_flat(self, sets: IntArray) -> BoolArray:
        """Return a mask (N,): True for sets of straps that alone press the foot on the plate all over.

        ``sets`` (N, K) are indices of places. The middle of a set's tips must lie in the kern.
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
    """The search among sets of places for the set of straps that needs the least force.

    Each motion (6,) found so far gives a lower bound of the force of every set.

    Parameters
    ----------
    search : the search for straps that has the P places.
    work : (P, M) work that a strap at each place does on each of M motions, friction included, per N of
        force.
    power : (M,) power, on each motion, of the load that drives it.
    least_force : least force in N found so far; inf before.
    chosen : places of the set with this force; None before.
    """

    search: StrapSearch
    work: Array = field(init=False)
    power: Array = field(init=False)
    least_force: float = field(init=False, default=inf)
    chosen: tuple[int, ...] | None = field(init=False, default=None)

    def __attrs_post_init__(self) -> None:
        self.work, self.power = np.zeros((len(self.search.places), 0)), np.zeros(0)

    def find_least(self, count: int, cancel: Event | None = None) -> tuple[int, ...] | None:
        """Return the indices of the places of ``count`` straps that need the least force, ascending.

        None if there are no such places. If no force is enough, the first set.
        """
        may = self.search.find_compatible_pairs()
        for sets in list_sets(may, count, self.can_improve):
            if cancel is not None and cancel.is_set():
                break
            self.search_sets(sets)
        return self.chosen

    def bound_forces(self, sets: IntArray, since: int = 0) -> Array:
        """Return lower bounds in N of the forces that sets need, (N,); inf
        where a motion shows that no force is enough.

        ``sets`` (N, K) are indices of places. Only motions from index ``since`` on are used.
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
        """Return whether a set of the places ``taken`` and ``more`` further ones may need less force than the
        best set so far.
        """
        if not len(self.power) or self.least_force == inf:
            return True
        most = self.work[list(taken)].sum(axis=0) + more * np.maximum(self.work.max(axis=0), 0.0)
        with np.errstate(divide="ignore"):
            bound = np.where(most > 0.0, self.power / np.where(most > 0.0, most, 1.0), inf).max()
        return bool(bound < self.least_force * (1.0 - ALIKE))

    def search_sets(self, sets: IntArray) -> None:
        """Update the best set by any of the sets (N, K), indices of places, that needs less force."""
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
        """Return the force in N that a set (K,) of places needs, or a
        lower bound of it that exceeds the best so far.

        The motions that are found on the way are kept.
        """
        search = self.search
        return search.compute_force(search.tips.press(chosen.tolist()), self.keep_motion, self.least_force)

    def keep_motion(self, motion: Array, power: float) -> None:
        """Append a motion (6,) and the power of the load that drives it, for bounds."""
        self.work = np.column_stack([self.work, self.search.tips.compute_work(motion)])
        self.power = np.append(self.power, power)


def list_sets(
    may: BoolArray, count: int, is_promising: Callable[[Sequence[int], int], bool]
) -> Iterator[IntArray]:
    """Yield, in lexicographic order, arrays (N, K) of the sets of K =
    ``count`` places that may stand together.

    ``may`` (P, P) tells which two places may. The sets of an array have all but their last two places in
    common. ``is_promising(taken, more)`` tells whether to continue with sets that begin with ``taken`` and
    have ``more`` further places.
    """

    def extend(taken: tuple[int, ...], free: IntArray) -> Iterator[IntArray]:
        """Yield the sets that begin with ``taken`` and go on with some of the places ``free``."""
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
    """Return (1) points (N, 3) in mm and (2) forces (N, 3) in N whose
    convex hull contains every case of a load.

    Both are in the plate's frame. The load's moments are left out.
    """
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
    """Return the corners (N, 2) of a loop in which arcs are replaced by chords, at most 0.1 mm off."""
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
