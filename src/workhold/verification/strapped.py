"""Seats under straps, derived anew: poses in balls, the push by hand, where straps stand, and the force they
need.

A seat is proven from its holes and faces alone, in ball arithmetic. Straps and push are derived from the loops of the
part, and the force from another method (``verification.jaw_forces``) with the foot's moments from Green's theorem.
That straps are the best of all places is not shown here; answering the query again shows it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import combinations, pairwise
from math import atan2, cos, degrees, hypot, inf, pi, radians, sin

import numpy as np
from attrs import evolve, field, frozen
from flint import arb, arb_mat, ctx
from numpy.typing import NDArray

from workhold.fixels.strap_set import StrapSet
from workhold.fixels.support_hardware import SupportPads
from workhold.geometry.loop import make_loop_segments
from workhold.geometry.segment import Arc, Segment, measure_distance_to_segment
from workhold.model.fixture import Fixture
from workhold.model.friction import find_friction_coefficient
from workhold.model.own_outlines import measure_outline_diameter
from workhold.model.pose import Pose
from workhold.model.query import Query
from workhold.model.requirements import Load
from workhold.model.straps import Strap, StrappedHold
from workhold.model.support_request import SupportRequest
from workhold.verification.ball_geometry import PRECISIONS, BallOutline, cross
from workhold.verification.contacts import BallContact, BallPose, make_joint_outline, select_outline_for
from workhold.verification.foot import Foot
from workhold.verification.jaw_forces import (
    LENGTH,
    HeldBetweenJaws,
    PressingJaw,
    UnsettledError,
    compute_wrenches,
)
from workhold.verification.jaw_program import find_program_force, find_program_force_faults
from workhold.verification.placing import enclose_written_pose, find_avoided_faces, judge_gaps, prove_pose
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.support_listing import SupportPlaces, measure_gap, split_borders
from workhold.verification.tolerances import AGREEMENT, Finding
from workhold.verification.tool_walk import HoldingElement, list_elements, make_walk
from workhold.verification.touching import judge_touching

__all__ = ["StrapJudge"]

Array = NDArray[np.float64]
# No unit. The determinant of three locators' wrenches is above this.
LEAST_SEAT = 1e-6
# A part lies on so many.
SUPPORTS = 3
# Parts of a force, and N, by which it may differ; with arcs, and of a range of directions, by more.
FORCE_PART, FORCE_HAIR, ARC_PART, RANGE_PART = 1e-3, 1e-3, 5e-3, 0.012
# Directions of a range that are looked at, and of friction at a tip.
DIRECTIONS, WAYS = 64, 16
# Parts of a number of times by which it may differ, and how many times mean any number.
SAME_TIMES, MOST_TIMES = 1e-9, 1e6
# Points of a bar's axis that are looked at.
BAR_POINTS = 200
# Degrees. How far from square to the outline a hand pushes, with rounding, and of direction and place.
MOST_ASLANT, ON_OUTLINE = 60.0 + 1e-6, 1e-6
# mm. How far beside the kern the middle of the tips may be by rounding.
KERN_SLACK = 1e-6


@frozen(eq=False)
class StrapJudge:
    """Judge of the fixtures of a query whose toolkit has straps; it derives them independently."""

    query: Query
    seen: dict[tuple[object, ...], int] = field(factory=dict, init=False)

    @property
    def straps(self) -> StrapSet:
        straps = self.query.toolkit.strap_set
        assert straps is not None
        return straps

    @cached_property
    def hardware(self) -> ToolkitRules:
        return ToolkitRules.from_query(self.query)

    @cached_property
    def wrench_length(self) -> float:
        """L of the wrenches in mm, half the diameter of the peg-centre locus."""
        return measure_outline_diameter(self.query.workpiece) / 2 + self.query.toolkit.plates[0].peg_radius

    @cached_property
    def outline(self) -> BallOutline:
        with ctx.workprec(PRECISIONS[0]):
            return make_joint_outline(self.query.workpiece)

    @cached_property
    def request(self) -> SupportRequest:
        """The faces that the straps' tips and the plate may touch."""
        known, query = self.query.part_height, self.query
        return evolve(
            SupportRequest.from_workpiece(
                query.workpiece,
                1.0 if known is None else query.thickness,
                tip_radius=self.straps.tip_radius,
                toolkit=query.toolkit,
            ),
            bottom_zones=query.restrictions.zones,
        )

    def find_faults(self, fixture: Fixture, place: int) -> Iterator[str]:
        """Yield one sentence, without full stop, for each fault of a fixture.

        ``place`` is the fixture's index in the list, from 0. The fixture is stored in ``seen``, so that a
        later equal one counts as a fault.
        """
        hold = fixture.hold
        if not isinstance(hold, StrappedHold):
            yield "it is not held by straps"
            return
        plate = self.query.toolkit.plates[0]
        holes = [(peg.column, peg.row) for peg in fixture.pegs]
        if len(set(holes)) != 3:
            yield "its three locators do not stand in three holes"
            return
        for column, row in holes:
            if not (0 <= column < (plate.columns or inf) and 0 <= row < (plate.rows or inf)):
                yield f"hole {plate.name_place(column, row)} is not on the plate"
                return
        known = {face.number for face in self.query.workpiece.numbered.faces}
        if not known.issuperset(peg.face for peg in fixture.pegs):
            yield "a locator is on a segment that does not name a face"
            return
        if find_avoided_faces(self.query) & {peg.face for peg in fixture.pegs}:
            yield "a locator touches a face that is to be avoided"
        touched = {peg.face for peg in fixture.pegs}
        if not touched.issuperset(self.query.restrictions.touch):
            yield "a face that is to be touched is not"
        angles, theta = self.query.restrictions.angles, fixture.pose.theta_deg
        if angles and not any((theta - low + 1e-6) % 360 <= high - low + 2e-6 for low, high in angles):
            yield f"the part is turned by {theta:g} degrees, which is not asked for"
        with ctx.workprec(PRECISIONS[1]):
            yield from self.find_seat_faults(fixture)
        keys = self.make_keys(fixture)
        earlier = [self.seen[key] for key in keys if key in self.seen]
        if earlier:
            yield f"it is the same as fixture {earlier[0] + 1}"
        for key in keys:
            self.seen.setdefault(key, place)
        yield from self.find_zone_faults(fixture)
        yield from self.find_tool_faults(fixture, hold)
        if hold.is_looked_at:
            yield from self.find_push_faults(fixture, hold)
            yield from self.find_strap_faults(fixture, hold)

    def make_keys(self, fixture: Fixture) -> list[tuple[object, ...]]:
        """Return the keys of a seat; fixtures with a key in common are the same seat.

        There is a second key, after half a turn, where half a turn leaves the toolkit as it is.
        """
        plate, pose = self.query.toolkit.plates[0], fixture.pose
        column, row = (min(getattr(peg, name) for peg in fixture.pegs) for name in ("column", "row"))
        holes = sorted((peg.column - column, peg.row - row) for peg in fixture.pegs)
        x, y = plate.compute_hole_center(column, row)
        at = np.array([pose.x - x, pose.y - y])
        out = [(round(pose.theta_deg, 4) % 360, tuple(holes), *(at.round(4) + 0.0).tolist())]
        if self.query.toolkit.half_turned is not None:
            wide, high = (max(hole[k] for hole in holes) for k in (0, 1))
            turned = sorted((wide - a, high - b) for a, b in holes)
            there = np.array([wide * plate.pitch[0], high * plate.pitch[1]]) - at
            out.append(
                (round(pose.theta_deg + 180, 4) % 360, tuple(turned), *(there.round(4) + 0.0).tolist())
            )
        return list(out)

    def find_seat_faults(self, fixture: Fixture) -> Iterator[str]:
        """Yield the faults of the three locators: each must touch its face between the ends, and all must fix
        the pose.
        """
        outline, hardware = self.outline, self.hardware
        contacts = hardware.make_contacts(fixture, outline)
        touching = [
            (name, contact, peg.face, select_outline_for(outline, peg.carrier))
            for name, contact, peg in zip(hardware.names, contacts, fixture.pegs, strict=True)
        ]
        yield from select_definite(
            judge_gaps([one[:3] for one in touching], enclose_written_pose(fixture.pose, []))
        )
        proven, doubts = prove_pose(contacts, fixture.pose, {})
        yield from (doubt.reason for doubt in doubts)
        if proven is None:
            return
        for name, contact, face, met in touching:
            found = judge_touching(name, contact, face, proven, met, self.query.contact_margin)
            yield from select_definite(found)
        size = abs(compute_determinant(contacts, proven)) / self.wrench_length
        if not size > LEAST_SEAT * (1 - 1e-6):
            yield "the three locators do not fix the pose: it is a double solution, or nearly"

    def find_zone_faults(self, fixture: Fixture) -> Iterator[str]:
        """Yield a fault for each locator in a keep-out zone."""
        back, radius = fixture.pose.inverse, self.query.toolkit.plates[0].body_radius
        for zone in self.query.restrictions.zones:
            loop = make_loop_segments(zone.loop)
            for peg in fixture.pegs:
                point = back.apply(peg.x, peg.y)
                if is_inside(point, [loop]) or measure_distance(point, loop) < radius - AGREEMENT:
                    yield f"locator {peg.hole} stands in a keep-out zone"

    def find_tool_faults(self, fixture: Fixture, hold: StrappedHold) -> Iterator[str]:
        """Yield one sentence for each locator, strap or support to which a tool of the program comes too
        near.
        """
        if self.query.program_to_clear is None:
            return
        program, height = self.query.program_to_clear
        walk = make_walk(program)
        elements = [*list_elements(fixture, self.hardware, height), *self.list_strap_elements(fixture, hold)]
        for element in elements:
            near = walk.find_nearest(element)
            if near.high < program.clearance - AGREEMENT:
                yield (
                    f"line {near.line} of the program brings a tool within {near.high:.6g} mm of {element.name}, and "
                    f"{program.clearance:g} mm are to be kept"
                )

    def list_strap_elements(self, fixture: Fixture, hold: StrappedHold) -> Iterator[HoldingElement]:
        """Yield the space of straps and supports, in the part's frame.

        For each strap they are the bar, upward from the face under its tip, and the bolt with its heel; for
        each support a disc below the part.
        """
        back, radius = fixture.pose.inverse, self.straps.tip_radius
        plate = self.query.toolkit.plates[0]
        for number, one in enumerate(hold.straps, 1):
            x, y = (float(value) for value in self.straps.bolts.compute_hole_center(*one.hole))
            far = hypot(x - one.at[0], y - one.at[1])
            share = 2 * radius / far if far else 0.0
            heel = back.apply(x + share * (x - one.at[0]), y + share * (y - one.at[1]))
            tip, bolt, end = ((float(a), float(b)) for a, b in (back.apply(*one.at), back.apply(x, y), heel))
            name, low = f"strap {number}", one.height - self.raised
            top = low + self.straps.standout
            yield HoldingElement(name, name, tip, end, radius, top, low=low)
            yield HoldingElement(f"the bolt of {name}", name, bolt, end, radius, top)
        for column, row in hold.supports:
            x, y = (float(value) for value in back.apply(*plate.compute_hole_center(column, row)))
            name = f"the support in {plate.name_place(column, row)}"
            yield HoldingElement(name, name, (x, y), (x, y), self.request.pad_radius, 0.0)

    def find_push_faults(self, fixture: Fixture, hold: StrappedHold) -> Iterator[str]:
        """Yield the faults of the push by hand.

        It must act at the outline, nearly square to it, and press the part against all three locators, with
        the written shares. Yields nothing if no push is written.
        """
        push = hold.push
        if push is None:
            return
        workpiece, pose = self.query.workpiece, fixture.pose
        outer = [pose.carry(one) for one in workpiece.segments[: workpiece.outer_count]]
        near = [one for one in outer if measure_distance_to_segment(push.at, one) <= ON_OUTLINE]
        if not near:
            yield "the push by hand is not at the outline"
            return
        off = [measure_slant(one, push.at, push.direction_deg) for one in near]
        # At a corner a hand pushes between both inward normals, or within reach of either.
        if min(map(abs, off)) > MOST_ASLANT and not (min(off) < 0 < max(off)):
            yield "the push by hand is more than 60 degrees from square to the outline"
        turn = radians(push.direction_deg)
        points, inward = locate_contacts(fixture, self.query)
        rows = np.array(
            [[*way, p[0] * way[1] - p[1] * way[0]] for p, way in zip(points, inward, strict=True)]
        )
        x, y = push.at
        load = np.array([cos(turn), sin(turn), x * sin(turn) - y * cos(turn)])
        shares = np.linalg.solve(rows.T, -load)
        if shares.min() <= 0:
            yield "the push by hand does not press the part against all three locators"
        if push.shares and np.abs(shares - push.shares).max() > 1e-6:
            yield "the push by hand presses locators otherwise than is written"

    def find_strap_faults(self, fixture: Fixture, hold: StrappedHold) -> Iterator[str]:
        """Yield the faults of the straps: of their places, of their pressure on the part, and of their
        written forces.
        """
        if not hold.straps:
            return
        if len(hold.straps) != self.straps.count:
            yield f"{len(hold.straps)} straps hold it, and {self.straps.count} are asked for"
            return
        for number, one in enumerate(hold.straps, 1):
            yield from (f"strap {number} {words}" for words in self.find_place_faults(fixture, one))
        for one, other in combinations(hold.straps, 2):
            if one.hole == other.hole:
                yield "two straps have their bolts in one hole"
            if (
                hypot(one.at[0] - other.at[0], one.at[1] - other.at[1])
                < 2 * self.straps.tip_radius - AGREEMENT
            ):
                yield "the tips of two straps overlap"
        foot = self.make_foot(fixture.pose)
        if self.straps.is_over_supports:
            faults = list(self.find_support_faults(fixture, hold))
            yield from faults
            if not faults:
                yield from self.find_force_faults(fixture, hold, foot)
            return
        if hold.supports or any(one.over is not None for one in hold.straps):
            yield "it lies on supports, which are not asked for"
            return
        middle = np.mean([one.at for one in hold.straps], axis=0)
        if foot.compute_pressures(middle).min() * foot.area < -KERN_SLACK:
            yield "the straps alone do not press the part flat on the plate"
        yield from self.find_force_faults(fixture, hold, foot)

    def find_support_faults(self, fixture: Fixture, hold: StrappedHold) -> Iterator[str]:
        """Yield the faults of the three supports: of their places, and for each strap's tip that is not over
        one of them.
        """
        plate, holes = self.query.toolkit.plates[0], hold.supports
        if len(set(holes)) != SUPPORTS or len(holes) != SUPPORTS:
            yield "it does not lie on supports in three holes"
            return
        room = SupportPlaces(self.query, fixture, self.request)
        for column, row in holes:
            name = plate.name_place(column, row)
            if not (0 <= column < (plate.columns or inf) and 0 <= row < (plate.rows or inf)):
                yield f"the support in {name} is not on the plate"
            short = room.compute_pad_room((plate.name, column, row))
            if short < -AGREEMENT:
                yield f"the support in {name} breaks its rules by {-short:.3g} mm"
        places = np.array([plate.compute_hole_center(*one) for one in holes], float)
        corners = np.column_stack([places, np.ones(SUPPORTS)])
        if abs(np.linalg.det(corners)) < AGREEMENT:
            yield "its supports are on one line"
            return
        for number, one in enumerate(hold.straps, 1):
            if one.over not in holes:
                yield f"strap {number} is over no support of the part"
                continue
            x, y = plate.compute_hole_center(*one.over)
            if hypot(one.at[0] - x, one.at[1] - y) > self.request.pad_radius + AGREEMENT:
                yield f"strap {number} has its tip beside its support"
        middle = np.mean([one.at for one in hold.straps], axis=0)
        if np.linalg.solve(corners.T, [*middle, 1.0]).min() < -AGREEMENT:
            yield "the straps alone tip the part over its supports"

    def find_place_faults(self, fixture: Fixture, strap: Strap) -> Iterator[str]:
        """Yield the faults of a strap's place, as words that follow "strap 1".

        Its bolt must be in a free hole, clear of the part, and its tip on the part's upper face with the foot
        below it.
        """
        straps, plate, workpiece = self.straps, self.query.toolkit.plates[0], self.query.workpiece
        bolts, (column, row) = straps.bolts, strap.hole
        if not (0 <= column < (bolts.columns or inf) and 0 <= row < (bolts.rows or inf)):
            yield "has its bolt in a hole that is not there"
            return
        x, y = (float(value) for value in bolts.compute_hole_center(column, row))
        far = hypot(strap.at[0] - x, strap.at[1] - y)
        if not straps.reach[0] - AGREEMENT <= far <= straps.reach[1] + AGREEMENT:
            yield f"reaches {far:.6g} mm from its bolt, which it does not"
        room = plate.peg_radius if straps.is_on_dowel_holes else 2 * plate.peg_radius
        if any(hypot(peg.x - x, peg.y - y) < room - AGREEMENT for peg in fixture.pegs):
            yield "has its bolt where a locator stands"
        back = fixture.pose.inverse
        bolt, tip = back.apply(x, y), back.apply(*strap.at)
        loops = workpiece.loop_segments
        if (
            is_inside(bolt, loops)
            or min(measure_distance(bolt, loop) for loop in loops) < plate.peg_radius - AGREEMENT
        ):
            yield "has its bolt in the part"
        if any(gap < plate.peg_radius - AGREEMENT for gap in self.measure_gaps_above(bolt)):
            yield "has its bolt in what juts out of the part above"
        faces = [("upper face", self.request.top), ("foot", self.request.bottom)]
        for name, face in faces[: 1 if straps.is_over_supports else 2]:
            borders = loops if face is None else [make_loop_segments(np.asarray(loop)) for loop in face]
            room = min((measure_distance(tip, loop) for loop in borders), default=-1.0)
            if not is_inside(tip, borders) or room < straps.tip_radius - AGREEMENT:
                yield f"has its tip not wholly over the part's {name}"
        for zone in self.query.restrictions.zones:
            loop = make_loop_segments(zone.loop)
            if is_inside(tip, [loop]) or measure_distance(tip, loop) < straps.tip_radius - AGREEMENT:
                yield "has its tip in a keep-out zone"
        high = self.request.find_clamped_height((float(tip[0]), float(tip[1])))
        if not self.is_off_rising(high, tip, bolt):
            yield "runs into what rises beside the face under its tip"
        if straps.is_over_supports:
            high += self.raised
        if abs(strap.height - high) > AGREEMENT:
            yield f"has its heel {strap.height:.6g} mm high, and the face under its tip is {high:.6g} mm high"

    def measure_gaps_above(self, point: tuple[float, float]) -> Iterator[float]:
        """Yield the distance in mm of a point of the part's frame from each region of a solid that is seen from
        above, by height; negative inside it.
        """
        solid = self.query.workpiece.solid
        if solid is None:
            return
        top = solid.top or ()
        groups = (
            (top, solid.top_heights or (solid.height,) * len(top)),
            (solid.rising, solid.rising_heights),
        )
        for loops, heights in groups:
            for level in dict.fromkeys(heights):
                own = [
                    split_borders(np.array(one)) for one, z in zip(loops, heights, strict=True) if z == level
                ]
                yield measure_gap(own, point)

    def is_off_rising(self, height: float, tip: tuple[float, float], bolt: tuple[float, float]) -> bool:
        """Return whether a strap's bar clears what of the part rises above the face under its tip.

        ``height`` is that face's in mm; ``tip`` and ``bolt`` are points in the part's frame. The bar is looked
        at in points of its axis, so that it is not judged to run into what it only comes near to.
        """
        asked, radius = self.request, self.straps.tip_radius
        own = [
            split_borders(one)
            for one, z in zip(asked.rising, asked.rising_heights, strict=True)
            if z == height
        ]
        far = hypot(bolt[0] - tip[0], bolt[1] - tip[1])
        if not own or not far:
            return True
        long = 1.0 + 2.0 * radius / far
        return all(
            measure_gap(own, (tip[0] + share * (bolt[0] - tip[0]), tip[1] + share * (bolt[1] - tip[1])))
            >= radius - AGREEMENT
            for share in np.linspace(0.0, long, BAR_POINTS).tolist()
        )

    def make_foot(self, pose: Pose) -> Foot:
        """Return the foot of the part on the plate."""
        loops = self.request.bottom
        if loops is None:
            some: Sequence[Sequence[Segment]] = self.query.workpiece.loop_segments
        else:
            some = [make_loop_segments(np.asarray(loop)) for loop in loops]
        return Foot([[pose.carry(segment) for segment in loop] for loop in some])

    def find_force_faults(self, fixture: Fixture, hold: StrappedHold, foot: Foot) -> Iterator[str]:
        """Yield a fault for each load, and for the program, whose derived force differs from the written
        force.
        """
        if len(hold.clamp_needed_each) != len(self.query.loads):
            yield f"{len(hold.clamp_needed_each)} forces are written for {len(self.query.loads)} loads"
            return
        has_arcs = any(isinstance(one, Arc) for one in self.query.workpiece.segments)
        held, centre = self.make_held_part(fixture, hold, foot)
        weight = self.compute_weight_wrench(foot, centre)
        program = self.query.program
        if program is not None and program.forces is not None:
            yield from find_program_force_faults(
                program,
                hold.program_need,
                fixture,
                held,
                self.request.thickness,
                self.query.safety_factor,
                (centre, weight),
                "force of the straps",
            )
        elif hold.program_need is not None:
            yield "a force of its program is given, and no program presses on the part"
        for number, (load, written) in enumerate(
            zip(self.query.loads, hold.clamp_needed_each, strict=True), 1
        ):
            part = (ARC_PART if has_arcs else FORCE_PART) + (RANGE_PART if is_range(load) else 0.0)
            try:
                found = self.find_needed_force(held, load, fixture.pose, centre, weight)
            except UnsettledError:
                continue
            if (found is None) != (written is None):
                yield f"load {number} asks for {describe_force(found)}, not {describe_force(written)}"
            elif found is None or written is None:
                continue
            elif abs(found - written) > FORCE_HAIR + part * max(found, written):
                yield f"load {number} asks for {found:.6g} N of each strap, not {written:.6g} N"
        if self.query.jaw_force is not None:
            yield from self.find_safety_faults(fixture, hold, held, centre, weight)

    def find_safety_faults(
        self, fixture: Fixture, hold: StrappedHold, held: HeldBetweenJaws, centre: Array, weight: Array
    ) -> Iterator[str]:
        """Yield a fault for each load, and for the program, that the given force does not hold as often as
        written.

        Without a weight the number of times follows from the force needed. Beside a weight the force needed
        at that number is derived, and may be smaller than the given force.
        """
        force, safety, program = self.query.jaw_force, self.query.safety_factor, self.query.program
        assert force is not None
        if len(hold.safety_each) != len(hold.needs):
            yield f"it says of {len(hold.safety_each)} of {len(hold.needs)} loads how often the given force holds them"
            return
        names = [f"load {number}" for number in range(1, len(self.query.loads) + 1)]
        for place, (need, times) in enumerate(zip(hold.needs, hold.safety_each, strict=True)):
            name = names[place] if place < len(names) else "the program"
            if need is None:
                if times > 0.0:
                    yield f"the given force is said to hold {name} {times:.6g} times, and none does"
                continue
            if not weight.any():
                derived = safety * force / need if need > 0.0 else inf
                if min(derived, MOST_TIMES) * (1 - SAME_TIMES) > times or times > derived * (1 + SAME_TIMES):
                    yield f"the given force holds {name} {derived:.6g} times, not {times:.6g} times"
                continue
            if (times < safety) != (force < need):
                yield f"the given force holds {name} less than {safety:g} times, or no less, other than written"
            if times > MOST_TIMES:
                continue
            try:
                if place < len(names):
                    load = self.query.loads[place]
                    found = self.find_needed_force(held, load, fixture.pose, centre, weight, times)
                else:
                    assert program is not None
                    frame = (centre, weight)
                    found = find_program_force(program, fixture, held, self.request.thickness, times, frame)
            except UnsettledError:
                continue
            if found is None or found > force * (1 + RANGE_PART) + FORCE_HAIR:
                yield f"the given force holds {name} less than {times:.6g} times"

    def make_held_part(
        self, fixture: Fixture, hold: StrappedHold, foot: Foot
    ) -> tuple[HeldBetweenJaws, Array]:
        """Return (part held between plate and tips, centre (3,) that moments are taken about)."""
        centre = np.array([*foot.centre, 0.0])
        below = self.make_jaw_below(hold, foot, centre)
        places = np.array([[*one.at, one.height - self.raised] for one in hold.straps]) - centre
        tips = PressingJaw(
            compute_wrenches(places, (0.0, 0.0, -1.0)).sum(axis=0)[None],
            list_rubbing_wrenches(places),
            np.full((1, len(places)), find_friction_coefficient(self.query.friction, "tip")),
        )
        points, inward = locate_contacts(fixture, self.query)
        workpiece = self.query.workpiece
        bands = self.request.adapt_to_fixture(
            fixture, workpiece.solid, numbered=workpiece.numbered
        ).list_peg_bands(3)
        free = [
            compute_wrenches(np.array([[*point, z]]) - centre, (float(way[0]), float(way[1]), 0.0))[0]
            for point, way, band in zip(points, inward, bands, strict=True)
            for z in band
        ]
        return HeldBetweenJaws(below, tips, np.array(free)), centre

    @property
    def raised(self) -> float:
        """Height of the supports above the plate, in mm; 0 without them, and if it is not given."""
        if not self.straps.is_over_supports:
            return 0.0
        return (self.query.toolkit.supports or SupportPads()).height or 0.0

    def make_jaw_below(self, hold: StrappedHold, foot: Foot, centre: Array) -> PressingJaw:
        """Return the surface that presses upward below the part: the plate on the foot, or the three
        supports, each at a point.
        """
        if not self.straps.is_over_supports:
            return foot.make_pressing_jaw(find_friction_coefficient(self.query.friction, "plate"), centre)
        plate = self.query.toolkit.plates[0]
        at = np.array([[*plate.compute_hole_center(*one), 0.0] for one in hold.supports], float) - centre
        coefficient = find_friction_coefficient(self.query.friction, "support")
        return PressingJaw(
            compute_wrenches(at, (0.0, 0.0, 1.0)), list_rubbing_wrenches(at), coefficient * np.eye(SUPPORTS)
        )

    def compute_weight_wrench(self, foot: Foot, centre: Array) -> Array:
        """Return the wrench (6,) of the part's weight, which acts at the centre of its foot."""
        down = compute_wrenches(np.array([[*foot.centre, 0.0]]) - centre, (0.0, 0.0, -1.0))[0]
        return np.asarray((self.query.weight or 0.0) * down)

    def find_needed_force(
        self,
        held: HeldBetweenJaws,
        load: Load,
        pose: Pose,
        centre: Array,
        weight: Array,
        times: float | None = None,
    ) -> float | None:
        """Return the least force in N of each strap that holds a load; None where no force suffices.

        ``centre`` (3,) is the point that moments are taken about, ``weight`` (6,) the wrench of the part's
        weight. The load acts ``times`` times, the query's safety factor if None.
        """
        height = self.query.part_height if load.height is None else load.height
        turn, factor = radians(pose.theta_deg), self.query.safety_factor if times is None else times
        low, high = (radians(one) for one in load.directions)
        count = DIRECTIONS if high > low and load.force else 0
        ways = [low + (high - low) * k / max(count, 1) for k in range(count + 1)]
        most = 0.0
        for x, y in load.points or ((0.0, 0.0),):
            at = np.array([[*pose.apply(x, y), height or 0.0]], float) - centre
            for way in ways:
                force = load.force * cos(way + turn), load.force * sin(way + turn), load.upward
                row = compute_wrenches(at, force)[0]
                row[5] += load.moment / LENGTH
                found = held.find_least_force(row * factor + weight)
                if found is None:
                    return None
                most = max(most, found[0])
        return most

    def find_order_faults(self, fixtures: Sequence[Fixture], ahead: int = 0) -> Iterator[str]:
        """Yield one sentence for the first fixture that belongs before its predecessor in the list.

        The first ``ahead`` fixtures stand in another order.
        """
        rows = [classify_hold(one.hold) for one in fixtures[ahead:] if isinstance(one.hold, StrappedHold)]
        for place, (before, after) in enumerate(pairwise(rows), ahead + 2):
            if after < before:
                yield f"fixture {place} is better than the one before it: unfit ones, and such as hold less, come last"
                return


def classify_hold(hold: StrappedHold) -> int:
    """Return the class by which seats are sorted: 0 held, 1 not examined, 2 not held, 3 unfit for a workshop."""
    if hold.is_unfit:
        return 3
    if not hold.is_looked_at:
        return 1
    return 2 if hold.holds_nothing else 0


def describe_force(force: float | None) -> str:
    """Return a force in words, such as "250 N"; for None, words that no force is enough."""
    return "a force that none is enough for" if force is None else f"{force:.6g} N"


def is_range(load: Load) -> bool:
    """Return whether a load has a force with a range of directions."""
    return bool(load.force) and load.directions[1] > load.directions[0]


def select_definite(findings: Iterator[Finding]) -> Iterator[str]:
    """Yield the reasons of those findings that are definite."""
    return (one.reason for one in findings if one.definite)


def compute_determinant(contacts: Sequence[BallContact], pose: BallPose) -> arb:
    """Return the determinant of the wrenches (n, q x n) of three contacts, in mm."""
    rows = [
        (contact.compute_outward_normal(pose), contact.compute_center_in_part(pose)) for contact in contacts
    ]
    return arb_mat([[*normal, cross(point, normal)] for normal, point in rows]).det()


def locate_contacts(fixture: Fixture, query: Query) -> tuple[list[tuple[float, float]], list[Array]]:
    """Return (points, directions): where each locator touches the part, and the unit vector in which it
    pushes the part.

    Both are in the plate's frame, points in mm.
    """
    faces = {face.number: face.segment for face in query.workpiece.numbered.faces}
    points, inward = list[tuple[float, float]](), list[Array]()
    for peg in fixture.pegs:
        side = fixture.pose.carry(faces[peg.face])
        if isinstance(side, Arc):
            away = np.array([peg.x - side.center[0], peg.y - side.center[1]])
            unit = away / np.hypot(*away)
            point = np.array(side.center) + side.radius * unit
            outward = unit if side.sign > 0 else -unit
        else:
            outward = np.array(side.compute_normal())
            start = np.array(side.start)
            point = np.array([peg.x, peg.y]) - outward * float(outward @ (np.array([peg.x, peg.y]) - start))
        points.append((float(point[0]), float(point[1])))
        inward.append(-outward)
    return points, inward


def measure_slant(segment: Segment, point: tuple[float, float], direction_deg: float) -> float:
    """Return the angle in degrees, counter-clockwise, from a segment's inward normal at ``point`` to a
    direction.

    ``direction_deg`` is in degrees from x; the result is at least -180 and below 180.
    """
    if isinstance(segment, Arc):
        away = np.array([point[0] - segment.center[0], point[1] - segment.center[1]])
        nx, ny = segment.sign * away / np.hypot(*away)
    else:
        nx, ny = segment.compute_normal()
    return (direction_deg - degrees(atan2(-ny, -nx)) + 180.0) % 360.0 - 180.0


def measure_distance(point: tuple[float, float], loop: Sequence[Segment]) -> float:
    """Return the distance of a point from a loop, in mm."""
    return min(measure_distance_to_segment((float(point[0]), float(point[1])), one) for one in loop)


def is_inside(point: tuple[float, float], loops: Sequence[Sequence[Segment]]) -> bool:
    """Return whether a point is within an odd number of loops; arcs are replaced by 64 chords."""
    x, y = float(point[0]), float(point[1])
    count = 0
    for loop in loops:
        total = 0.0
        for one in loop:
            pieces = 1 if not isinstance(one, Arc) else 64
            for k in range(pieces):
                ends = [
                    one.compute_point(get_running_sign(one) * one.half_extent * (2 * j / pieces - 1.0))
                    for j in (k, k + 1)
                ]
                (ax, ay), (bx, by) = ((end[0] - x, end[1] - y) for end in ends)
                total += atan2(ax * by - ay * bx, ax * bx + ay * by)
        count += abs(round(total / (2 * pi)))
    return count % 2 == 1


def get_running_sign(segment: Segment) -> float:
    """Return 1 if a segment's parameter grows from its start to its end, -1 if it falls."""
    return segment.sign if isinstance(segment, Arc) else 1.0


def list_rubbing_wrenches(places: Array) -> Array:
    """Return wrenches (N, 16, 6) of friction of 1 N at points (N, 3), in 16 directions."""
    turns = [2 * pi * k / WAYS for k in range(WAYS)]
    return np.stack([compute_wrenches(places, (cos(turn), sin(turn), 0.0)) for turn in turns], axis=1)
