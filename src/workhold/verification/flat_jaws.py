"""Fixtures between flat jaws, derived independently: poses, contacts of each jaw, the rules, and the forces
that loads need.

A fixture is given by a pose, parallels and a stop. All further data are derived from the loops of the part
and compared with the file: lengths to 1e-6 mm, forces to a thousandth. The methods differ from the search's:
forces come from ``verification.jaw_forces``, the resultants of pressures from second moments, and hulls are
tested for contact by the hull of all differences.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import cos, hypot, inf, pi, radians, sin

import numpy as np
from attrs import field, frozen
from numpy.typing import NDArray

from workhold.fixels.jaw_pair import JawPair
from workhold.geometry.segment import Arc, Line, Segment
from workhold.model.fixture import Fixture
from workhold.model.friction import find_friction_coefficient
from workhold.model.jaw_hold import JawHold, JawPatch, Rectangle
from workhold.model.query import Query
from workhold.model.requirements import Load
from workhold.verification.jaw_forces import (
    HeldBetweenJaws,
    UnsettledError,
    compute_resultant_points,
    find_hull_corners,
    list_extreme_pressures,
)
from workhold.verification.jaw_program import find_program_force_faults
from workhold.verification.tolerances import AGREEMENT
from workhold.verification.tool_walk import HoldingElement, make_walk

__all__ = ["JawJudge"]

# mm. What lies this near to a jaw lies on it.
ON_JAW = 1e-6
# mm. Two hulls miss each other if they do so by more; by less than the second either may be said.
MISSED, EITHER = 1e-7, 1e-6
# Parts of a force, and N, by which it may differ; and by how much the worst of a range of directions may be above.
FORCE_PART, FORCE_HAIR, RANGE_PART = 1e-3, 1e-3, 0.01
# Directions of a range that are looked at.
DIRECTIONS = 64
UNKNOWN_HEIGHT = 1.0
# mm. How far outward jaws reach whose thickness nobody gives.
ENDLESS = 1e4
# mm, and of the opening: how thick parallels are at most where nobody says.
USUAL_PARALLEL, USUAL_SHARE = 8.0, 0.2


@frozen
class JawContact:
    """A contact of the part with a jaw: from x = low to high along the jaw, from height bottom to top, in mm.

    A point has low = high. ``face`` is the face that touches, or None at a corner.
    """

    low: float
    high: float
    bottom: float
    top: float
    face: int | None


@frozen(eq=False)
class JawJudge:
    """Judge of the fixtures of a query whose toolkit has flat jaws; it derives them independently."""

    query: Query
    seen: dict[tuple[int, float, str | None], int] = field(factory=dict, init=False)

    @property
    def jaws(self) -> JawPair:
        """The pair of flat jaws of the query's toolkit."""
        jaws = self.query.toolkit.flat_jaws
        assert jaws is not None
        return jaws

    @property
    def height(self) -> float:
        """The height of the part in mm; 1.0 where it is unknown."""
        known = self.query.part_height
        return UNKNOWN_HEIGHT if known is None else known

    def find_faults(self, fixture: Fixture, place: int) -> Iterator[str]:
        """Yield one sentence, without full stop, for each fault of a fixture.

        ``place`` is the fixture's index in the list, from 0. The fixture is stored in ``seen``, so that a
        later equal one counts as a fault.
        """
        hold = fixture.hold
        if not isinstance(hold, JawHold):
            yield "it is not held by flat jaws"
            return
        if not any(abs(hold.parallels - one) <= AGREEMENT for one in self.jaws.parallels):
            yield f"there are no parallels of {hold.parallels:g} mm"
            return
        if hold.stop not in self.jaws.stops:
            yield f"the work stop is {hold.stop or 'missing'}, and none of those asked for is there"
            return
        yield from self.find_placement_faults(fixture, hold)
        key = round(fixture.pose.theta_deg * 1e4), round(hold.parallels, 6), hold.stop
        if (first := self.seen.setdefault(key, place)) != place:
            yield f"it is the same as fixture {first + 1}"

    def find_order_faults(self, fixtures: Sequence[Fixture], ahead: int = 0) -> Iterator[str]:
        """Yield one sentence for the first fixture that belongs before its predecessor in the list; nothing
        if all are in order. The first ``ahead`` fixtures stand in another order.
        """
        rows = [rank_cautions(one.hold) for one in fixtures[ahead:] if isinstance(one.hold, JawHold)]
        for place, (before, after) in enumerate(pairwise(rows), ahead + 2):
            if after < before:
                yield f"fixture {place} is better than the one before it: unfit ones, and such as hold less, come last"
                return

    def find_placement_faults(self, fixture: Fixture, hold: JawHold) -> Iterator[str]:
        """Yield one sentence for each fault of a fixture's pose, contacts,
        restrictions, program clearance and grip.

        Stops early at faults after which the rest cannot be derived.
        """
        outline, first = self.query.workpiece.find_outline(self.jaws.name_outline_role(hold.parallels))
        segments = [fixture.pose.carry(segment) for segment in outline.segments[: outline.outer_count]]
        face_of = {number: first + face.number for face in outline.outer_faces for number in face.segments}
        solid = outline.solid
        bands = {
            number: (0.0, self.height) if solid is None else solid.bands[number]
            for number in range(len(segments))
        }
        boxes = np.array([compute_segment_box(segment) for segment in segments])
        (low_x, low_y), (high_x, high_y) = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
        if abs(low_y) > AGREEMENT or abs(high_y - hold.opening) > AGREEMENT:
            yield f"the part reaches from y = {low_y:.9g} to {high_y:.9g}, not from 0 to {hold.opening:.9g}"
            return
        most = self.jaws.max_opening
        if most is not None and hold.opening > most + AGREEMENT:
            yield f"the jaws would open {hold.opening:.9g} mm, and they open {most:g}"
        top = self.jaws.compute_top(hold.parallels)
        lies = [self.find_lying_on_jaw(segments, bands, face_of, level) for level in (0.0, float(high_y))]
        if len({(round(one.low, 5), round(one.high, 5)) for one in lies[0]}) == 1 and all(
            one.low == one.high for one in lies[0]
        ):
            has_edge = self.has_hull_edge(segments)
            if has_edge or abs((fixture.pose.theta_deg + 180) % 360 - 180) > AGREEMENT:
                yield "no straight side of the part's hull lies on the fixed jaw"
                return
        known = self.query.part_height is not None
        gripped = [find_grip(some, top, self.jaws.least_grip if known else 0.0) for some in lies]
        if top < self.jaws.least_grip or not all(gripped):
            yield "the jaws do not grip the part high enough"
            return
        yield from self.find_shift_faults(hold, gripped, (float(low_x), float(high_x)))
        derived = [make_patch(some, self.jaws.width) for some in gripped]
        for name, mine, theirs in zip(("fixed", "moving"), derived, (hold.fixed, hold.moving), strict=True):
            if not are_alike(mine.rectangles, theirs.rectangles):
                yield f"what the {name} jaw touches is {list(mine.rectangles)}, not {list(theirs.rectangles)}"
            if mine.segments != theirs.segments:
                yield f"the {name} jaw touches faces {list(mine.segments)}, not {list(theirs.segments)}"
        asked, touched = self.query.restrictions, {*derived[0].segments, *derived[1].segments}
        if asked.avoid and not touched.isdisjoint(asked.avoid):
            yield "a jaw touches a face that is to be avoided"
        if asked.touch and not set(asked.touch) <= touched:
            yield "a face that is to be touched is not"
        theta = fixture.pose.theta_deg
        if asked.angles and not any(
            (theta - low + 1e-6) % 360 <= high - low + 2e-6 for low, high in asked.angles
        ):
            yield f"the part is turned by {theta:g} degrees, which is not asked for"
        yield from self.find_program_faults(fixture, hold, segments)
        yield from self.find_grip_faults(fixture, hold, derived[0], derived[1], segments)

    def list_obstacles(
        self, hold: JawHold, segments: Sequence[Segment]
    ) -> Iterator[tuple[str, tuple[float, float, float, float], float]]:
        """Yield (name, x0, y0, x1, y1 of its box in mm, height of its top in mm) of the bodies that tools
        keep clear of.

        These are both jaws, a work stop, two parallels and the bed. ``segments`` are the part's outline in the
        jaws' frame.
        """
        jaws, opening, bed = self.jaws, hold.opening, 0.0 - hold.parallels
        deep, top = ENDLESS if jaws.thickness is None else jaws.thickness, jaws.compute_top(hold.parallels)
        yield "the fixed jaw", (0.0, -deep, jaws.width, 0.0), top
        yield "the moving jaw", (0.0, opening, jaws.width, opening + deep), top
        if hold.stop is not None:
            way = 1.0 if hold.stop == "left" else -1.0
            at = jaws.stop_offset if hold.stop == "left" else jaws.width - jaws.stop_offset
            y, far = find_stop_middle(segments, way), at - way * ENDLESS
            box = (min(at, far), y - jaws.stop_width / 2, max(at, far), y + jaws.stop_width / 2)
            known = self.query.part_height
            yield "the work stop", box, top if known is None else min(top, known)
        if hold.parallels:
            usual = min(USUAL_PARALLEL, opening * USUAL_SHARE)
            own = jaws.parallel_thickness
            thick = usual if own is None else min(own, opening / 2)
            near, far = hold.parallel_offsets
            for low in (near, opening - far - thick):
                yield "a parallel", (0.0, low, jaws.width, low + thick), 0.0
        yield "the bed of the vise", (0.0, 0.0, jaws.width, opening), bed

    def find_program_faults(
        self, fixture: Fixture, hold: JawHold, segments: Sequence[Segment]
    ) -> Iterator[str]:
        """Yield one sentence if a tool of the program comes too near to the sides of a jaw, the work stop, a
        parallel or the bed, or collides with it.

        Stops after the first fault. Also yields one for parallels at an impossible place.
        """
        thick = [
            box[3] - box[1] for name, box, _ in self.list_obstacles(hold, segments) if name == "a parallel"
        ]
        for offset in hold.parallel_offsets:
            if not -AGREEMENT <= offset <= hold.opening / 2 - max(thick, default=0.0) + AGREEMENT:
                yield f"a parallel stands {offset:.6g} mm from its jaw, and not in that half of the opening"
        program = self.query.program
        if program is None:
            if hold.parallel_offsets != (0.0, 0.0):
                yield "its parallels stand away from the jaws, and there is no program"
            return
        walk, turn = make_walk(program), radians(-fixture.pose.theta_deg)
        at, moves = fixture.pose.apply(0.0, 0.0), program.moves
        under = {number: min(one.low for one in tool.cylinders) for number, tool in program.tools.items()}
        # Both ends of all moves, with the height of the tool's lowest cylinder.
        ends = np.concatenate([moves.start, moves.end])
        ends[:, 2] += np.tile([under[number] for number in moves.tool.tolist()], 2)
        ends[:, :2] = fixture.pose.apply(ends[:, :2])

        def map_to_part(x: float, y: float) -> tuple[float, float]:
            """Return a point of the jaws' frame in the part's frame, in mm."""
            off = complex(x - float(at[0]), y - float(at[1])) * complex(cos(turn), sin(turn))
            return off.real, off.imag

        for name, (x0, y0, x1, y1), top in self.list_obstacles(hold, segments):
            ring = [map_to_part(*place) for place in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
            near = [
                walk.find_nearest(HoldingElement(name, name, start, end, 0.0, top))
                for start, end in zip(ring, [*ring[1:], ring[0]], strict=True)
            ]
            for one in near:
                if one.high < program.clearance - AGREEMENT:
                    yield (
                        f"line {one.line} of the program brings a tool within {max(one.high, 0.0):.6g} mm of "
                        f"{name}, and {program.clearance:g} mm are to be kept"
                    )
                    return
            inside = (ends[:, 0] > x0) & (ends[:, 0] < x1) & (ends[:, 1] > y0) & (ends[:, 1] < y1)
            inside &= ends[:, 2] <= top
            if inside.any():
                move = int(inside.argmax()) % len(program.moves)
                yield f"line {int(program.moves.line[move])} of the program is in {name}"
                return

    def has_hull_edge(self, segments: Sequence[Segment]) -> bool:
        """Return whether the convex hull of an outline has a straight edge.

        Arcs are sampled, so an edge counts only if it is longer than every chord between samples.
        """
        points = np.array([point for one in segments for point in sample_segment(one)])
        hull = np.array(find_hull_corners([(float(x), float(y)) for x, y in points.round(9)]))
        sides = np.hypot(*(np.roll(hull, -1, axis=0) - hull).T)
        arcs = [one.radius for one in segments if isinstance(one, Arc)]
        return bool(sides.max() > 2 * max(arcs, default=0.0) * sin(pi / SAMPLES) + 1e-4)

    def find_lying_on_jaw(
        self,
        segments: Sequence[Segment],
        bands: dict[int, tuple[float, float] | None],
        face_of: dict[int, int],
        level: float,
    ) -> list[JawContact]:
        """Return the stretches and points of an outline that lie on a jaw face at y = ``level`` mm.

        ``bands`` gives the heights (bottom, top) of each segment, None for no upright face; ``face_of`` its
        face number. Corners come last, and only if no stretch contains them; such a contact has no face.
        """
        out = list[JawContact]()
        ends = list[tuple[float, int]]()
        for number, one in enumerate(segments):
            band = bands[number]
            points = [one.start, one.end]
            on = [abs(y - level) <= ON_JAW for _, y in points]
            if isinstance(one, Line) and all(on):
                if band is not None:
                    (x0, _), (x1, _) = sorted(points)
                    out.append(JawContact(x0, x1, *band, face_of[number]))
                continue
            if isinstance(one, Arc) and one.sign > 0:
                foot = one.center[0], one.center[1] + (one.radius if level > 0 else -one.radius)
                if abs(foot[1] - level) <= ON_JAW and abs(one.find_parameter(foot)) <= one.half_sweep + 1e-9:
                    if band is not None:
                        out.append(JawContact(foot[0], foot[0], *band, face_of[number]))
                    continue
            ends += [(x, number) for (x, _), is_on in zip(points, on, strict=True) if is_on]
        for x, _ in ends:
            near = [other for at, other in ends if abs(at - x) <= ON_JAW]
            if any(one.low - ON_JAW <= x <= one.high + ON_JAW for one in out):
                continue
            some = [bands[other] for other in near]
            if any(band is None for band in some):
                continue
            bottom, top = max(band[0] for band in some if band), min(band[1] for band in some if band)
            out.append(JawContact(x, x, bottom, top, None))
        return out

    def find_shift_faults(
        self, hold: JawHold, gripped: Sequence[Sequence[JawContact]], ends: tuple[float, float]
    ) -> Iterator[str]:
        """Yield one sentence if the part's place along the jaws is not the one that its stop, or centring,
        requires.

        ``gripped`` are the contacts of the fixed and the moving jaw, ``ends`` the part's least and greatest x
        in mm.
        """
        jaws = self.jaws
        if hold.stop == "left":
            off = ends[0] - jaws.stop_offset
        elif hold.stop == "right":
            off = ends[1] - (jaws.width - jaws.stop_offset)
        else:
            low = max(min(one.low for one in some) for some in gripped)
            high = min(max(one.high for one in some) for some in gripped)
            offs = [(ends[0] + ends[1]) / 2 - jaws.width / 2] if low > high - EITHER else []
            offs += [(low + high) / 2 - jaws.width / 2] if low <= high + EITHER else []
            off = min(offs, key=abs)
        if abs(off) > AGREEMENT:
            yield f"the part lies {off:.9g} mm along the jaws from where {'the stop' if hold.stop else 'the middle'} is"

    def find_grip_faults(
        self, fixture: Fixture, hold: JawHold, fixed: JawPatch, moving: JawPatch, segments: Sequence[Segment]
    ) -> Iterator[str]:
        """Yield one sentence where the jaws do not clamp the part, or a written figure
        or force differs from the derived one.
        """
        corners = [np.array(list_extreme_pressures(patch)[1]) for patch in (fixed, moving)]
        if measure_hull_distance(*corners) > EITHER:
            yield "the jaws do not press opposite each other: the part turns away as they close"
        missed = measure_hull_distance(compute_resultant_points(fixed), compute_resultant_points(moving))
        if (missed <= MISSED) != hold.full_contact and not -EITHER <= missed <= EITHER:
            yield f"{'both jaws press' if missed <= 0 else 'a jaw cannot press'} all over what they touch, not as written"
        is_marked = any(words.startswith("unfit") for words in hold.warnings)
        if is_marked != (fixed.is_corner or moving.is_corner):
            yield "it is unfit where a jaw touches corners alone, and nowhere else"
        for name, value, derived in self.compare_figures(hold, fixed, moving):
            if abs(value - derived) > AGREEMENT * (1 + abs(derived)):
                yield f"{name} is {value:.9g} in the file and comes to {derived:.9g}"
        for key, derived in self.derive_ratios(hold):
            written = fixture.quality.get(key, derived)
            if abs(written - derived) > AGREEMENT * (1 + abs(derived)):
                yield f"{key.replace('_', ' ')} is {written:.9g} in the file and comes to {derived:.9g}"
        loads = self.query.loads
        if len(hold.clamp_needed_each) != len(loads):
            yield f"there are forces for {len(hold.clamp_needed_each)} loads, and {len(loads)} were given"
            return
        if not hold.full_contact:
            if any(need is not None for need in hold.forces_needed):
                yield "loads are held by jaws that cannot press all over"
            return
        points, way = self.list_stop_points(hold, segments)
        friction = find_friction_coefficient(self.query.friction, "jaw")
        held = HeldBetweenJaws.from_patches(
            fixed, moving, hold.opening, friction, points, way, hold.parallels_across
        )
        for number, (load, need) in enumerate(zip(loads, hold.clamp_needed_each, strict=True), 1):
            yield from self.find_force_faults(number, load, need, fixture, held)
        program, height = self.query.program, self.query.part_height
        if program is not None and program.forces is not None and height is not None:
            yield from find_program_force_faults(
                program, hold.program_need, fixture, held, height, self.query.safety_factor
            )
        elif hold.program_need is not None:
            yield "a jaw force of its program is given, and the program has no forces"
        stated, each = fixture.quality.get("clamp_needed"), hold.forces_needed
        worst = [need for need in each if need is not None]
        if len(worst) == len(each) > 0 and stated is not None and abs(stated - max(worst)) > FORCE_HAIR:
            yield f"the jaw force needed is {stated:.9g} N in the file, and {max(worst):.9g} N are asked for"

    def compare_figures(
        self, hold: JawHold, fixed: JawPatch, moving: JawPatch
    ) -> Iterator[tuple[str, float, float]]:
        """Yield (name, written, derived) for the grip, the contact area and, where
        written, the height above the jaws.
        """
        tops = [min(one[3] for one in patch.rectangles) for patch in (fixed, moving)]
        feet = [max(one[2] for one in patch.rectangles) for patch in (fixed, moving)]
        yield "the grip", hold.grip, max(min(tops) - max(feet), 0.0)
        areas = [
            sum((x1 - x0) * (z1 - z0) for x0, x1, z0, z1 in patch.rectangles) for patch in (fixed, moving)
        ]
        yield "the contact area", hold.contact_area, min(areas)
        top = self.jaws.compute_top(hold.parallels)
        if hold.above is not None and top < inf:
            yield "what stands above the jaws", hold.above, max(self.height - top, 0.0)

    def derive_ratios(self, hold: JawHold) -> Iterator[tuple[str, float]]:
        """Yield (key, derived value) of those figures of quality that follow from the hold's own fields and
        the query.
        """
        yield "grip", hold.grip
        yield "contact_area", hold.contact_area
        needs = [need for need in hold.forces_needed if need is not None]
        if not needs or len(needs) < len(hold.forces_needed) or max(needs) <= 0:
            return
        if self.jaws.max_force is not None:
            yield "slip_reserve", self.jaws.max_force / max(needs)
        if self.query.jaw_force is not None:
            yield "safety_reached", self.query.safety_factor * self.query.jaw_force / max(needs)

    def list_stop_points(
        self, hold: JawHold, segments: Sequence[Segment]
    ) -> tuple[list[tuple[float, float, float]], float]:
        """Return (points, sign): the points at which the work stop may push, and its direction: 1.0 for +x,
        -1.0 for -x.

        The points are the part's extreme points, at height 0 and at the height of the jaws' top, in mm in the
        jaws' frame; [] without a stop.
        """
        if hold.stop is None:
            return [], 1.0
        way = 1.0 if hold.stop == "left" else -1.0
        reached = [(way * x, x, y) for one in segments for x, y in find_extreme_points(one)]
        least = min(one[0] for one in reached)
        there = [(x, y) for along, x, y in reached if along <= least + ON_JAW]
        high = min(self.jaws.compute_top(hold.parallels), self.height)
        ends = min(there, key=lambda one: one[1]), max(there, key=lambda one: one[1])
        return [(x, y, z) for x, y in ends for z in (0.0, high)], way

    def find_force_faults(
        self, number: int, load: Load, need: float | None, fixture: Fixture, held: HeldBetweenJaws
    ) -> Iterator[str]:
        """Yield one sentence if the written jaw force for a load differs from the derived one.

        Yields nothing if the method does not converge.

        Parameters
        ----------
        number : number of the load, from 1, for the message.
        need : the written force in N; None if the file says that no force suffices.
        """
        low, high = load.directions
        turns = (
            [low]
            if high <= low or not load.force
            else [low + (high - low) * k / DIRECTIONS for k in range(DIRECTIONS + 1)]
        )
        height = (
            self.height / 2
            if self.query.part_height is None
            else self.height
            if load.height is None
            else load.height
        )
        factor, worst = self.query.safety_factor, 0.0
        try:
            for x, y in load.points or ((0.0, 0.0),):
                at = fixture.pose.apply(x, y)
                for turn in turns:
                    way = radians(turn + fixture.pose.theta_deg)
                    force = (
                        load.force * cos(way) * factor,
                        load.force * sin(way) * factor,
                        load.upward * factor,
                    )
                    one = held.compute_needed_force(
                        (float(at[0]), float(at[1]), height), force, load.moment * factor
                    )
                    if one is None:
                        if need is not None:
                            yield f"load {number} is held by no jaw force, and {need:.9g} N are written"
                        return
                    worst = max(worst, one)
        except (UnsettledError, np.linalg.LinAlgError):
            return
        if need is None:
            yield f"load {number} is held at {worst:.9g} N, and none is written"
            return
        spare = FORCE_HAIR + FORCE_PART * worst
        above = spare + (RANGE_PART * worst if len(turns) > 1 else 0.0)
        if not -spare <= need - worst <= above:
            yield f"load {number} asks for {worst:.9g} N, and {need:.9g} N are written"


SAMPLES = 256


def rank_cautions(hold: JawHold) -> tuple[bool, bool, bool]:
    """Return the sort key of a hold; False sorts first and is better.

    It is (a jaw touches corners alone, a jaw cannot press all over its contact, a load needs more jaw force
    than the vise has).
    """
    needs = [need for need in hold.forces_needed if need is not None]
    strong = hold.max_force is None or not needs or max(needs) <= hold.max_force
    return (
        not (hold.fixed.segments and hold.moving.segments),
        not hold.full_contact,
        len(needs) < len(hold.forces_needed) or not strong,
    )


def sample_segment(segment: Segment) -> list[tuple[float, float]]:
    """Return points along a segment: both ends of a line, ``SAMPLES`` + 1 evenly spaced points of an arc."""
    if isinstance(segment, Line):
        return [segment.start, segment.end]
    half = segment.half_extent
    return [segment.compute_point(half * (2 * k / SAMPLES - 1)) for k in range(SAMPLES + 1)]


def find_extreme_points(segment: Segment) -> list[tuple[float, float]]:
    """Return the ends of a segment, and of an arc also its points with the least or greatest x or y."""
    points = [segment.start, segment.end]
    if isinstance(segment, Arc):
        (x, y), radius = segment.center, segment.radius
        for a, b in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            point = x + a * radius, y + b * radius
            if abs(segment.find_parameter(point)) <= segment.half_sweep + 1e-9:
                points.append(point)
    return points


def compute_segment_box(segment: Segment) -> tuple[float, float, float, float]:
    """Return the least x, least y, greatest x and greatest y of a segment."""
    x, y = zip(*find_extreme_points(segment), strict=True)
    return min(x), min(y), max(x), max(y)


def find_grip(lies: Sequence[JawContact], top: float, least: float) -> list[JawContact]:
    """Return the contacts cut to heights 0 to ``top`` mm that are then at least ``least`` mm high.

    If any of them is a stretch, only the stretches are returned, otherwise the points.
    """
    cut = [JawContact(one.low, one.high, max(one.bottom, 0.0), min(one.top, top), one.face) for one in lies]
    high = [one for one in cut if one.top - one.bottom >= least - 1e-9]
    return [one for one in high if one.high > one.low] or high


def make_patch(lies: Sequence[JawContact], width: float) -> JawPatch:
    """Return the contacts cut to a jaw of this width as a patch; touching
    stretches of equal heights are joined.
    """
    rows = list[list[float]]()
    for one in sorted(lies, key=lambda one: (one.low, one.bottom, one.top)):
        low, high = max(one.low, 0.0), min(one.high, width)
        if low > high or (one.high > one.low and low == high):
            continue
        last = rows[-1] if rows else None
        if (
            last is not None
            and one.high > one.low
            and last[2:] == [one.bottom, one.top]
            and low - last[1] <= ON_JAW
        ):
            last[1] = max(last[1], high)
        else:
            rows.append([low, high, one.bottom, one.top])
    faces = tuple(sorted({one.face for one in lies if one.face is not None}))
    return JawPatch(tuple((a, b, c, d) for a, b, c, d in rows), faces, not faces)


def are_alike(mine: Sequence[Rectangle], theirs: Sequence[Rectangle]) -> bool:
    """Return whether two lists of rectangles are equal to within ``AGREEMENT``, in any order."""
    return len(mine) == len(theirs) and all(
        abs(a - b) <= AGREEMENT
        for one, other in zip(sorted(mine), sorted(theirs), strict=True)
        for a, b in zip(one, other, strict=True)
    )


def measure_hull_distance(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Return the distance between the convex hulls of points (N, 2) and (M, 2); negative where the hulls
    overlap.

    A negative result is minus the depth of the overlap. It is the signed distance of the origin from the hull
    of all differences of points.
    """
    differences = [(float(x), float(y)) for x, y in (one[:, None] - other[None]).reshape(-1, 2).round(12)]
    hull = find_hull_corners(differences)
    if len(hull) > 2:
        depth = inf
        for (x, y), (ahead_x, ahead_y) in zip(hull, [*hull[1:], hull[0]], strict=True):
            size = hypot(ahead_x - x, ahead_y - y)
            depth = min(depth, (-(ahead_x - x) * y + (ahead_y - y) * x) / size)
        if depth >= 0:
            return -depth
    ends = hull if len(hull) > 1 else [hull[0], hull[0]]
    return min(measure_distance_to_origin(p, q) for p, q in zip(ends, [*ends[1:], ends[0]], strict=True))


def measure_distance_to_origin(p: tuple[float, float], q: tuple[float, float]) -> float:
    """Return the distance of the origin from the straight segment from p to q."""
    dx, dy = q[0] - p[0], q[1] - p[1]
    square = dx * dx + dy * dy
    share = 0.0 if square == 0 else min(max(-(p[0] * dx + p[1] * dy) / square, 0.0), 1.0)
    return hypot(p[0] + share * dx, p[1] + share * dy)


def find_stop_middle(segments: Sequence[Segment], way: float) -> float:
    """Return the y in mm at which a work stop touches an outline.

    It is the middle of the longest upright line farthest out, the lower one of two equally long ones. Without
    such a line it is the lowest of the points farthest out. ``way`` is 1.0 for a stop at the left, -1.0 at
    the right.
    """
    reached = [(way * x, x, y) for one in segments for x, y in find_extreme_points(one)]
    least = min(one[0] for one in reached)
    best: tuple[float, float] | None = None
    for one in segments:
        if isinstance(one, Line) and all(way * x <= least + ON_JAW for x, _ in (one.start, one.end)):
            low, high = sorted((one.start[1], one.end[1]))
            if best is None or (round(low - high, 6), low) < (round(best[0] - best[1], 6), best[0]):
                best = low, high
    if best is not None:
        return (best[0] + best[1]) / 2
    return min(y for along, _, y in reached if along <= least + ON_JAW)
