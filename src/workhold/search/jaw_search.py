"""Every way to hold a part between two flat jaws: each hull edge on the fixed jaw, each height of parallels,
each stop.

The hull edge on the fixed jaw fixes the angle. The moving jaw touches the point or edge of the part that is
farthest from the fixed one: a parallel hull edge, a point of an arc, or a corner. The contacts of both jaws
and their places along the jaws follow in closed form; so the list is complete. A part without a hull edge,
such as a disc, stands as it is drawn.

Glossary
--------
touch : a stretch along a jaw, or a point of the jaw, that the part touches.
examined hold : a combination of hull edge, parallels and stop, with the first rule that it breaks.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import product
from math import atan2, cos, degrees, hypot, inf, pi, sin
from threading import Event

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.contact.problem import Progress
from workhold.conventions import PARALLEL, READING, SQUARE_TILT, TOUCHING
from workhold.fixels.jaw_pair import JawPair
from workhold.geometry.hull import HullEdge, HullTouch, find_hull_edges, find_touches_along
from workhold.geometry.segment import Arc, Segment
from workhold.geometry.symmetry import find_rotations_onto_itself
from workhold.model.first_choice import FACTORS
from workhold.model.fixture_table import FixtureTable, make_flat_jaw_table
from workhold.model.friction import find_friction_coefficient
from workhold.model.jaw_hold import JawHold, JawPatch, ProgramJawForce, find_largest_force
from workhold.model.notes import NoFixture, Note, Remark, Stage
from workhold.model.pose import Pose
from workhold.model.program import Program
from workhold.model.quality import round_number_coarsely
from workhold.model.query import Query
from workhold.model.raw_block import measure_jaws_over_part
from workhold.model.requirements import Load, lie_in_angle_ranges
from workhold.model.result import Result
from workhold.model.solid import Band
from workhold.model.vise_bodies import find_stop_level, list_vise_bodies
from workhold.model.workpiece import Workpiece
from workhold.statics.friction import (
    FrictionHold,
    find_least_peak_pressure,
    is_pressed_all_over,
    list_load_corners,
)
from workhold.statics.jaw_clearance import (
    ToolNearVise,
    describe_left_out,
    describe_tools_in_the_way,
    find_tool_in_the_way,
    join_advice,
    place_parallels,
)
from workhold.statics.jaw_program import CuttingPieces, find_worst_move
from workhold.statics.patches import PressedPatch, hulls_meet
from workhold.units import format_times

__all__ = [
    "RULES",
    "ExaminedHold",
    "JawSearch",
    "find_fixtures_between_jaws",
    "is_square",
    "make_fitness_key",
    "weigh_force",
]

Array = NDArray[np.float64]
# The rules in the order in which they are asked.
RULES = {
    "angles": "angles of the part",
    "grip": "a grip of the least height by both jaws",
    "opening": "largest opening",
    "push": "jaws that press opposite each other",
    "avoid": "faces to avoid",
    "touch": "faces to touch",
    "program": "vise clear of the program",
}
# The stage, as notes name it, of a rule that took the last way.
STAGE_OF: dict[str, Stage] = {"angles": "shape", "grip": "pair", "push": "set"}
# Sine of the angle between straight sides that still count as parallel, if their ends are off by no more than
# a drawing's rounding.
NEARLY_PARALLEL = 1e-6
# Heights in mm that stand for a part's where its thickness is not given.
UNKNOWN_BAND = (0.0, 1.0)
# mm. The patches on both jaws may miss each other by this much, for rounding.
PUSH_SLACK = 1e-7


@frozen
class JawTouch:
    """A stretch or a point along a jaw at which the part touches it.

    Parameters
    ----------
    low, high : ends of the stretch, in mm along the jaw; equal for a point.
    band : (lowest, highest) height of the touch above the part's lower side, in mm.
    faces : numbers of the faces that touch; empty for a corner.
    """

    low: float
    high: float
    band: Band
    faces: tuple[int, ...]

    @property
    def is_point(self) -> bool:
        """Whether the touch is a point rather than a stretch."""
        return self.high <= self.low


@frozen(eq=False)
class JawOutline:
    """The outline of a part at the heights of the jaws, for one height of the jaws' top.

    Parameters
    ----------
    outline : outline of the part at the heights of the jaws.
    first : number that the outline's first segment has in files and pictures.
    height : height of the part, in mm; None where not given.
    """

    outline: Workpiece
    first: int
    height: float | None

    @cached_property
    def segments(self) -> list[Segment]:
        """Faces of the outer loops as segments, loop after loop."""
        return [face.segment for face in self.outline.outer_faces]

    @cached_property
    def edges(self) -> tuple[HullEdge, ...]:
        """Hull edges of the outer loops; empty for a part without any, such as a disc."""
        return find_hull_edges(self.segments, self.outline.outer_face_counts)

    @cached_property
    def angles(self) -> list[float]:
        """Orientations in radians in [0, 2 pi); entry k brings hull edge k onto the fixed jaw.

        [0.0] for a part without hull edges.
        """
        turns = [-atan2(edge.tangent[1], edge.tangent[0]) % (2 * pi) for edge in self.edges]
        return turns or [0.0]

    def find_band(self, number: int) -> Band | None:
        """Return the heights (low, high) in mm at which a jaw may touch a face; None if it may touch none.

        ``number`` is the face's index in ``segments``.
        """
        solid = self.outline.solid
        if solid is not None:
            return solid.bands[self.outline.outer_faces[number].number]
        return UNKNOWN_BAND if self.height is None else (0.0, self.height)

    def find_face_number(self, index: int) -> int:
        """Return the number, as files and pictures show it, of the face ``segments[index]``."""
        return self.first + self.outline.outer_faces[index].number

    def lay_at_angle(self, place: int) -> PartOnJaw:
        """Return the part as it lies at ``angles[place]``, with hull edge
        ``edges[place]`` on the fixed jaw.
        """
        return PartOnJaw(self, self.angles[place], self.edges[place] if self.edges else None)


@frozen(eq=False)
class PartOnJaw:
    """A part that lies at an angle on the fixed jaw; x runs along the jaws, y away from the fixed one.

    Parameters
    ----------
    of : outline of the part, with its hull edges.
    theta : orientation in radians.
    edge : the hull edge that lies on the fixed jaw; None for a part without one.
    """

    of: JawOutline
    theta: float
    edge: HullEdge | None

    def turn_point(self, point: tuple[float, float]) -> tuple[float, float]:
        """Return a point of the drawing in mm, turned by theta about the origin."""
        c, s = cos(self.theta), sin(self.theta)
        return c * point[0] - s * point[1], s * point[0] + c * point[1]

    @cached_property
    def reaches(self) -> dict[tuple[int, int], tuple[float, list[tuple[float, float, tuple[int, ...]]]]]:
        """Outermost points of the turned outline, by direction (-1, 0), (1, 0), (0, -1) or (0, 1).

        Each value is (1) the largest coordinate in mm along the direction, and (2) the points (x, y, indices
        of faces) there. A point on an arc has one face, a corner two.
        """
        points: list[tuple[float, float, tuple[int, ...]]] = []
        count = 0
        ways = ((-1, 0), (1, 0), (0, -1), (0, 1))
        found = {way: list[tuple[float, float, float, tuple[int, ...]]]() for way in ways}
        for size in self.of.outline.outer_face_counts:
            for k in range(count, count + size):
                face, before = self.of.segments[k], count + (k - count - 1) % size
                if not (isinstance(face, Arc) and face.is_full):
                    x, y = self.turn_point(face.start)
                    points.append((x, y, (before, k)))
                if isinstance(face, Arc) and face.sign > 0:
                    (x, y), middle = self.turn_point(face.center), face.mid_angle + self.theta
                    for a, b in ways:
                        along = a * cos(middle) + b * sin(middle)
                        if face.is_full or along >= cos(face.half_sweep):
                            at = x + a * face.radius, y + b * face.radius
                            found[a, b].append((a * at[0] + b * at[1], *at, (k,)))
            count += size
        out = {}
        for way, arcs in found.items():
            every = [*arcs, *((way[0] * x + way[1] * y, x, y, faces) for x, y, faces in points)]
            most = max(one[0] for one in every)
            there: list[tuple[float, float, tuple[int, ...]]] = []
            for reach, x, y, faces in every:
                # The end of an arc that touches there is no corner.
                alike = any(hypot(x - other[0], y - other[1]) <= READING for other in there)
                if reach >= most - TOUCHING and not alike:
                    there.append((x, y, faces))
            out[way] = most, there
        return out

    def measure_reach(self, a: int, b: int) -> float:
        """Return the largest coordinate in mm of the turned outline along a direction (a, b).

        The direction is one of the keys of ``reaches``.
        """
        return self.reaches[a, b][0]

    @cached_property
    def opposite(self) -> HullEdge | None:
        """Hull edge that lies on the moving jaw, antiparallel to
        ``edge``; None where there is no such hull edge.
        """
        if self.edge is None:
            return None
        tx, ty = self.edge.tangent
        for other in self.of.edges:
            ox, oy = other.tangent
            off = abs(tx * oy - ty * ox)
            if tx * ox + ty * oy < 0 and (
                off <= PARALLEL or (off <= NEARLY_PARALLEL and off * other.length <= 2 * READING)
            ):
                return other
        return None

    @cached_property
    def level(self) -> float:
        """Coordinate y of the fixed jaw in mm, in the turned drawing."""
        return -self.measure_reach(0, -1) if self.edge is None else self.turn_point(self.edge.start.point)[1]

    @cached_property
    def opening(self) -> float:
        """Distance between the jaws' faces, in mm."""
        return self.measure_reach(0, 1) - self.level

    @cached_property
    def touched(self) -> tuple[list[JawTouch], list[JawTouch]]:
        """Touches on the fixed jaw, and touches on the moving jaw, as two lists."""
        return self.find_touches(self.edge, -1), self.find_touches(self.opposite, 1)

    def find_touches(self, edge: HullEdge | None, way: int) -> list[JawTouch]:
        """Return the stretches and points at which the part touches a jaw, stretches first.

        ``way`` is -1 for the fixed jaw, 1 for the moving jaw. ``edge`` is the hull edge on that jaw, or None
        to take the outermost points. These are left out: faces that may not be touched, and corners on a
        stretch that is listed.
        """
        if edge is None:
            along = [HullTouch(x, x, faces) for x, _, faces in self.reaches[0, way][1]]
        else:
            start = self.turn_point(edge.start.point)[0]
            along = []
            for one in find_touches_along(edge, self.of.segments, self.of.outline.outer_face_counts):
                low, high = sorted((start - way * one.low, start - way * one.high))
                along.append(HullTouch(low, high, one.faces))
        out = list[JawTouch]()
        for one in sorted(along, key=lambda one: (one.low == one.high, len(one.faces), one.low)):
            bands = [self.of.find_band(index) for index in one.faces]
            if any(band is None for band in bands):
                continue
            low, high = max(band[0] for band in bands if band), min(band[1] for band in bands if band)
            is_corner = len(one.faces) > 1
            if is_corner and any(other.low - READING <= one.low <= other.high + READING for other in out):
                continue
            faces = () if is_corner else tuple(self.of.find_face_number(index) for index in one.faces)
            out.append(JawTouch(one.low, one.high, (low, high), faces))
        return out

    def list_touched_faces(self) -> set[int]:
        """Return the numbers of all faces that touch the fixed or the moving jaw.

        Where only a corner touches, both its faces count.
        """
        out = set[int]()
        for edge, way in ((self.edge, -1), (self.opposite, 1)):
            if edge is None:
                indices = [index for *_, faces in self.reaches[0, way][1] for index in faces]
            else:
                touched = find_touches_along(edge, self.of.segments, self.of.outline.outer_face_counts)
                along = [one for one in touched if len(one.faces) == 1]
                indices = [index for one in along or touched for index in one.faces]
            out |= {self.of.find_face_number(index) for index in indices}
        return out


def select_gripped(touches: Sequence[JawTouch], top: float, least: float) -> list[JawTouch]:
    """Return the touches cut to the heights 0 to ``top`` mm. Those less than ``least`` mm high after that are
    dropped.

    Points are returned only if no stretch is left.
    """
    cut = [evolve(one, band=(max(one.band[0], 0.0), min(one.band[1], top))) for one in touches]
    high = [one for one in cut if one.band[1] - one.band[0] >= least]
    return [one for one in high if not one.is_point] or high


def clip_touches_to_jaws(touches: Sequence[JawTouch], shift: float, width: float) -> JawPatch | None:
    """Return the part of the touches that lies on a jaw, as one patch; None where no touch lies on the jaw.

    The touches are first moved by ``shift`` mm along the jaw, which extends from 0 to ``width`` mm. Adjacent
    stretches of the same heights are joined.
    """
    moved = [evolve(one, low=one.low + shift, high=one.high + shift) for one in touches]
    rows = list[tuple[float, float, float, float]]()
    faces = list[int]()
    for one in sorted(moved, key=lambda one: (one.low, one.band)):
        low, high = max(one.low, 0.0), min(one.high, width)
        if (one.is_point and low > high) or (not one.is_point and low >= high):
            continue
        if rows and not one.is_point and rows[-1][2:] == one.band and low - rows[-1][1] <= TOUCHING:
            rows[-1] = (rows[-1][0], max(rows[-1][1], high), *one.band)
        else:
            rows.append((low, high, *one.band))
        faces += one.faces
    if not rows:
        return None
    return JawPatch(tuple(rows), tuple(sorted(dict.fromkeys(faces))), not faces)


def find_common_middle(one: Sequence[JawTouch], other: Sequence[JawTouch]) -> float | None:
    """Return the middle, in mm along the jaws, of the overlap of two ranges; None without overlap.

    The ranges are those from the lowest to the highest touch on ``one`` jaw and on the ``other``.
    """
    low = max(min(touch.low for touch in touches) for touches in (one, other))
    high = min(max(touch.high for touch in touches) for touches in (one, other))
    return (low + high) / 2 if low <= high else None


@frozen
class ExaminedHold:
    """A combination of hull edge, parallels and stop, and the first rule that it breaks.

    Parameters
    ----------
    theta : orientation of the part, in radians.
    position : place of the drawing's origin in the frame of the jaws, in mm.
    hold : how the jaws hold the part; None where a rule is broken before both jaws touch it.
    rule : key in :data:`RULES` of the first rule that is broken; None for a fixture.
    near : place where a tool of the program comes too near the vise; None if no tool does.
    """

    theta: float
    position: tuple[float, float]
    hold: JawHold | None
    rule: str | None
    near: ToolNearVise | None = None

    @property
    def pose(self) -> Pose:
        """Pose of the part between the jaws."""
        return Pose(degrees(self.theta), *self.position)


@frozen(eq=False)
class JawSearch:
    """The search of a query whose toolkit has two flat jaws."""

    query: Query

    @property
    def jaws(self) -> JawPair:
        """Flat jaws of the query's toolkit."""
        jaws = self.query.toolkit.flat_jaws
        assert jaws is not None
        return jaws

    @cached_property
    def lyings(self) -> dict[float, list[PartOnJaw]]:
        """Ways in which the part can lie on the fixed jaw, by height of parallels in mm."""
        out, known = {}, dict[int, list[PartOnJaw]]()
        for parallels in self.jaws.parallels:
            outline, first = self.query.workpiece.find_outline(self.jaws.name_outline_role(parallels))
            if first not in known:
                one = JawOutline(outline, first, self.query.part_height)
                known[first] = [one.lay_at_angle(place) for place in range(len(one.angles))]
            out[parallels] = known[first]
        return out

    @property
    def size(self) -> int:
        """Number of combinations of hull edge, parallels and stop."""
        return sum(len(some) for some in self.lyings.values()) * len(self.jaws.stops)

    def examine_all(self) -> Iterator[ExaminedHold]:
        """Yield the examined hold of every combination of parallels, stop and hull edge."""
        for parallels, stop in product(self.jaws.parallels, self.jaws.stops):
            for lying in self.lyings[parallels]:
                yield self.examine(lying, parallels, stop)

    def examine(self, lying: PartOnJaw, parallels: float, stop: str | None) -> ExaminedHold:
        """Return the examined hold of a part that lies on the fixed jaw, on parallels and against a stop.

        ``parallels`` is their height in mm; ``stop`` is "left", "right" or None. Loads and warnings are not
        yet applied.
        """
        query, jaws = self.query, self.jaws
        top = jaws.compute_top(parallels)
        nothing = ExaminedHold(lying.theta, (0.0, 0.0), None, "grip")
        if not lie_in_angle_ranges(degrees(lying.theta), query.restrictions.angles):
            return evolve(nothing, rule="angles")
        least = jaws.least_grip if query.part_height is not None else 0.0
        if top < jaws.least_grip:
            return nothing
        fixed, moving = (select_gripped(touches, top, least) for touches in lying.touched)
        if not fixed or not moving:
            return nothing
        middle = find_common_middle(fixed, moving)
        low, high = -lying.measure_reach(-1, 0), lying.measure_reach(1, 0)
        match stop:
            case "left":
                shift = jaws.stop_offset - low
            case "right":
                shift = jaws.width - jaws.stop_offset - high
            case _:
                shift = jaws.width / 2 - ((low + high) / 2 if middle is None else middle)
        on_fixed, on_moving = (
            clip_touches_to_jaws(touches, shift, jaws.width) for touches in (fixed, moving)
        )
        if on_fixed is None or on_moving is None:
            return nothing
        hold = JawHold(
            parallels=parallels,
            stop=stop,
            fixed=on_fixed,
            moving=on_moving,
            opening=lying.opening,
            above=None if query.part_height is None or top == inf else max(query.part_height - top, 0.0),
            full_contact=is_pressed_all_over(on_fixed, on_moving),
            max_force=jaws.max_force,
            unit_force=query.unit_force,
        )
        found = ExaminedHold(lying.theta, (shift, 0.0 - lying.level), hold, None)
        rule = self.find_broken_rule(hold, lying)
        if rule is None and query.program is not None:
            return self.keep_clear(query.program, found)
        return evolve(found, rule=rule)

    def find_broken_rule(self, hold: JawHold, lying: PartOnJaw) -> str | None:
        """Return the key in :data:`RULES` of the first broken rule; None if none is broken.

        The rules are tested in the order "opening", "push", "avoid", "touch".
        """
        most = self.jaws.max_opening
        if most is not None and hold.opening > most + TOUCHING:
            return "opening"
        one, other = (np.array(PressedPatch(patch).corners) for patch in (hold.fixed, hold.moving))
        if not hulls_meet(one, other, PUSH_SLACK):
            return "push"
        asked = self.query.restrictions
        if asked.avoid and not lying.list_touched_faces().isdisjoint(
            self.list_faces_in_outlines(asked.avoid)
        ):
            return "avoid"
        if asked.touch and not set(asked.touch) <= {*hold.fixed.segments, *hold.moving.segments}:
            return "touch"
        return None

    def keep_clear(self, program: Program, one: ExaminedHold) -> ExaminedHold:
        """Return an examined hold whose parallels keep clear of a program's tools.

        If a tool still comes too near the vise, the hold breaks the rule "program".
        """
        hold, pose = one.hold, one.pose
        assert hold is not None
        query, jaws = self.query, self.jaws
        hold = place_parallels(program, jaws, hold, pose) or hold
        level = find_stop_level(query.workpiece, jaws, hold, pose)
        near = find_tool_in_the_way(program, list_vise_bodies(jaws, hold, query.part_height, level), pose)
        if near is None:
            return evolve(one, hold=hold)
        return evolve(one, rule="program", near=near)

    def list_faces_in_outlines(self, faces: Sequence[int]) -> set[int]:
        """Return the numbers of faces, and the numbers that the same
        faces have in the other outlines of a solid.
        """
        numbered = self.query.workpiece.numbered
        return {*faces, *numbered.list_segments_under(numbered.list_faces_over(faces))}

    def make_grip(self, one: ExaminedHold, hold: JawHold) -> FrictionHold:
        """Return the friction model of a hold, with the points at which the part touches the stop."""
        lying = next(each for each in self.lyings[hold.parallels] if each.theta == one.theta)
        points, way = list[tuple[float, float, float]](), 1.0
        if hold.stop is not None:
            side = -1 if hold.stop == "left" else 1
            way = -float(side)
            y = [at + one.position[1] for _, at, _ in lying.reaches[side, 0][1]]
            x = side * lying.measure_reach(side, 0) + one.position[0]
            high = min(self.jaws.compute_top(hold.parallels), self.height)
            points = [(x, each, z) for each in sorted({min(y), max(y)}) for z in (0.0, high)]
        return FrictionHold.from_patches(
            hold.fixed,
            hold.moving,
            hold.opening,
            find_friction_coefficient(self.query.friction, "jaw"),
            points,
            way,
            hold.parallels_across,
        )

    @property
    def height(self) -> float:
        """Height of the part in mm; 1.0 where it is not given."""
        known = self.query.part_height
        return UNKNOWN_BAND[1] if known is None else known

    def compute_wrenches(self, load: Load, one: ExaminedHold, grip: FrictionHold) -> Array:
        """Return wrenches (N, 6) whose convex hull covers a load's range, multiplied by the safety factor.

        The components are those of ``FrictionHold``.
        """
        height = load.height if load.height is not None else self.height
        if self.query.part_height is None:
            height = self.height / 2
        rows = grip.compute_wrenches(*list_load_corners(load, one.theta, one.position, height))
        rows[:, 5] += load.moment / grip.length
        return np.asarray(rows * self.query.safety_factor)

    @cached_property
    def pieces(self) -> CuttingPieces | None:
        """Pieces of the program's moves on which tools cut the
        part; None where the program has no cutting forces.
        """
        program = self.query.program
        if program is None or program.forces is None:
            return None
        return CuttingPieces.from_program(program, self.height)

    @property
    def first_cut(self) -> ProgramJawForce | None:
        """The program's first cut with the force None, for holds that no jaw force makes strong enough; None
        if nothing is cut.
        """
        pieces, program = self.pieces, self.query.program
        if pieces is None or program is None or not len(pieces):
            return None
        move = int(pieces.move.min())
        return ProgramJawForce(None, int(program.moves.line[move]), int(program.moves.tool[move]), move)

    def compute_program_need(self, one: ExaminedHold, grip: FrictionHold) -> ProgramJawForce | None:
        """Return the largest jaw force that the program's tools need, with its move; None without cutting
        forces.
        """
        pieces, query = self.pieces, self.query
        if pieces is None or query.program is None:
            return None
        return find_worst_move(grip, pieces, query.program, one.theta, one.position, query.safety_factor)

    def apply_loads(self, one: ExaminedHold) -> ExaminedHold:
        """Return an examined hold with the jaw forces that the loads and the program need, its pressure and
        its warnings.

        If the jaws do not press over their whole contact, every needed force is None: no load counts as held.
        """
        hold, loads = one.hold, self.query.loads
        assert hold is not None
        each: list[float | None] = [None] * len(loads)
        of_program = self.first_cut
        if self.query.is_loaded and hold.full_contact:
            grip = self.make_grip(one, hold)
            each = [
                find_largest_force(grip.compute_forces_needed(self.compute_wrenches(load, one, grip)))
                for load in loads
            ]
            of_program = self.compute_program_need(one, grip)
        hold = evolve(hold, clamp_needed_each=tuple(each), program_need=of_program)
        needed = hold.clamp_needed
        pressure = None if not needed else find_least_peak_pressure(hold.fixed, hold.moving, needed)
        hold = evolve(hold, max_pressure=None if self.query.part_height is None else pressure)
        return evolve(one, hold=evolve(hold, warnings=tuple(self.iterate_warnings(hold))))

    @property
    def acting(self) -> str:
        """Name of what acts on the part, for sentences: "the loads", "the tools", or both."""
        names = ("the loads", bool(self.query.loads)), ("the tools", self.pieces is not None)
        return " and ".join(name for name, is_there in names if is_there)

    def iterate_warnings(self, hold: JawHold) -> Iterator[str]:
        """Yield the warnings about a hold, as sentences."""
        for words, patch in (("fixed", hold.fixed), ("moving", hold.moving)):
            if patch.is_corner:
                yield f"unfit: the {words} jaw touches a corner alone, which marks the part"
        if not hold.full_contact:
            yield (
                "a jaw cannot press all over what it touches, so the part lifts off it at one end, and no load is taken "
                "to be held"
            )
        else:
            for number, need in enumerate(hold.clamp_needed_each, 1):
                if need is None:
                    named = self.query.loads[number - 1].name
                    yield f"no jaw force holds load {number}{f', {named}' if named else ''}"
            asked = hold.program_need
            if asked is not None and asked.force is None:
                yield f"no jaw force holds the part against T{asked.tool} in line {asked.line} of the program"
        if hold.slip_reserve is not None and hold.slip_reserve < 1:
            yield f"{self.acting} ask for {hold.clamp_needed:.0f} N, and the vise is rated for {hold.max_force:g} N"
        reached, safety = hold.safety_reached, self.query.safety_factor
        if reached is not None and reached < safety:
            yield (
                f"closed with {self.query.jaw_force:g} N the jaws hold {self.acting} {format_times(reached)}, and "
                f"{safety:g} times are asked for"
            )
        if hold.above == 0.0:
            yield "nothing of the part stands above the jaws"
        ends = hold.fixed.ends, hold.moving.ends
        # A stop at the end of the jaws is there for the part to reach it.
        is_left = hold.stop != "left" and min(one[0] for one in ends) <= 0.0
        is_right = hold.stop != "right" and max(one[1] for one in ends) >= self.jaws.width
        if is_left or is_right:
            yield "the part reaches to the end of the jaws or beyond"


def is_square(theta: float) -> bool:
    """Return whether an angle in radians is a multiple of a quarter turn, within ``SQUARE_TILT`` degrees."""
    return abs((degrees(theta) + 45.0) % 90.0 - 45.0) < SQUARE_TILT


def weigh_force(force: float, theta: float) -> float:
    """Return a jaw force in N as the order counts it: more by a twentieth where the part is turned, at ``theta`` in
    radians.

    For so little nobody turns the program as well (see ``model.first_choice``).
    """
    is_turned = abs((degrees(theta) + 180.0) % 360.0 - 180.0) >= SQUARE_TILT
    return force * FACTORS[0].times if is_turned else force


def make_fitness_key(hold: JawHold, query: Query) -> list[float]:
    """Return the part of the sort key of a hold that says how fit it is; fitter holds have smaller keys.

    Unfit holds come last, then holds without full contact, then those beyond the vise's rating, then those of
    which nothing stands above the jaws, the deepest between them last. Of a raw block those come first whose
    jaws reach least over the finished part's lower side.
    """
    # A part that ends below the jaws' top can be cut nowhere but from above, and hardly be measured.
    is_sunk = hold.above == 0.0
    key: list[float] = [hold.is_unfit, not hold.full_contact, hold.is_beyond_rating, is_sunk]
    jaws, raw, height = query.toolkit.flat_jaws, query.raw, query.part_height
    if is_sunk and jaws is not None and height is not None:
        key.append(round(jaws.compute_top(hold.parallels) - height, 6))
    else:
        key.append(0.0)
    if raw is not None and jaws is not None:
        # What is left below the part is there to be gripped.
        key.append(round(measure_jaws_over_part(hold, raw, jaws), 6))
    return key


def make_order_key(one: ExaminedHold, query: Query) -> tuple[float, ...]:
    """Return the sort key of an examined hold that is a fixture; better holds have smaller keys.

    The fittest come first (:func:`make_fitness_key`); equally fit ones are in the query's ranking.
    """
    hold = one.hold
    assert hold is not None
    key = make_fitness_key(hold, query)
    for name in query.rank_by:
        match name:
            case "square":
                key.append(not is_square(one.theta))
            case "clamp_needed":
                key.append(
                    0.0
                    if not query.is_loaded
                    else inf
                    if hold.clamp_needed is None
                    else round_number_coarsely(weigh_force(hold.clamp_needed, one.theta))
                )
            case "contact_area":
                key.append(-round_number_coarsely(hold.contact_area))
            case "max_pressure":
                key.append(inf if hold.max_pressure is None else round_number_coarsely(hold.max_pressure))
            case _:
                value = getattr(hold, name)
                key.append(inf if value is None else -round(value, 6))
    stops = ("left", "right")
    key.append(hold.has_moved_parallels)
    return (*key, round(one.theta, 9), hold.parallels, stops.index(hold.stop) if hold.stop else -1)


def find_fixtures_between_jaws(
    query: Query, progress: Progress | None = None, cancel: Event | None = None
) -> Result:
    """Return every way, or only the best ways, to hold a part between the flat jaws of a query's toolkit."""
    search, found, whole = JawSearch(query), list[ExaminedHold](), True
    size, rules, near = search.size, dict.fromkeys(RULES, 0), list[ToolNearVise]()
    for number, one in enumerate(search.examine_all(), 1):
        if cancel is not None and cancel.is_set():
            whole = False
            break
        if one.rule is None:
            found.append(search.apply_loads(one))
        else:
            rules[one.rule] += 1
            near += [] if one.near is None else [one.near]
        if progress is not None:
            progress(number / size, len(found))
    found.sort(key=lambda one: make_order_key(one, query))
    listed = found[: query.best]
    notes = list[Note]()
    if whole and not found:
        notes.append(explain_no_fixture(rules, near, query))
    elif near and query.program is not None:
        notes.append(Remark(describe_left_out(near, query.program)))
    count = {query.toolkit.arrangements[0].name: len(found)}
    return Result(
        query=query,
        table=make_table(listed),
        found=count,
        distinct=dict.fromkeys(count, count_distinct(found, query.workpiece)),
        complete=whole,
        notes=tuple(notes),
        statistics={"hull_edges": sum(len(some) for some in search.lyings.values()), "examined": size},
        holds=tuple(one.hold for one in listed if one.hold is not None),
    )


def make_table(listed: Sequence[ExaminedHold]) -> FixtureTable:
    """Return the fixture table of holds by flat jaws, one row each."""
    holds = [one.hold for one in listed if one.hold is not None]
    return make_flat_jaw_table(
        [one.theta for one in listed],
        [one.position for one in listed],
        [hold.opening for hold in holds],
        [len(hold.warnings) for hold in holds],
    )


def count_distinct(found: Sequence[ExaminedHold], workpiece: Workpiece) -> int:
    """Return the number of distinct holds. Holds that a rotation of the part onto itself makes equal count
    once.
    """
    every = workpiece.as_finished.numbered
    turns = [
        one.angle for one in find_rotations_onto_itself([face.segment for face in every.faces], every.marks)
    ]
    seen = set[tuple[object, ...]]()
    for one in found:
        assert one.hold is not None
        least = min(round((one.theta - turn) % (2 * pi), 6) % round(2 * pi, 6) for turn in turns)
        seen.add((least, one.hold.parallels, one.hold.stop))
    return len(seen)


def explain_no_fixture(rules: dict[str, int], near: Sequence[ToolNearVise], query: Query) -> Note:
    """Return the note that says why there is no fixture between flat jaws.

    If a program is the obstacle, the note names the bodies that its tools hit, and the worst line. Otherwise
    it names the last rule, in the order of :data:`RULES`, that a combination broke. ``rules`` counts
    combinations by the first rule they break, ``near`` are the places where tools come too near.
    """
    jaws, program = query.toolkit.flat_jaws, query.program
    if near and jaws is not None and program is not None:
        return Remark(
            f"Both jaws would press the part, but {describe_tools_in_the_way(near, program)}. "
            f"{join_advice(near, jaws, program)}"
        )
    last = next((rule for rule in reversed(RULES) if rules[rule]), "grip")
    return NoFixture(STAGE_OF.get(last, "hold"), query.toolkit.wording)
