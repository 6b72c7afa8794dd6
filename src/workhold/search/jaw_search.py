"""Every way to hold a part between two flat jaws: each hull edge on the fixed jaw, each height of parallels, each stop.

The hull edge on the fixed jaw fixes the angle. The jaw that moves touches what is farthest from it: a hull edge that is
parallel, or an arc's point, or a corner. What both touch, and where along the jaws it lies, follows in closed form; so
the list is complete. A part without a hull edge, such as a disc, stands as it is drawn.

Glossary
--------
touch : a stretch along a jaw that the part touches, or a point of it.
examined : a hull edge with parallels and a stop, and the first rule that it breaks.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import product
from math import atan2, cos, degrees, hypot, inf, pi, sin
from threading import Event

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.contact.problem import Progress
from workhold.contact.swept import find_swept_below
from workhold.conventions import PARALLEL, READING, SQUARE_TILT, TOUCHING
from workhold.fixels.jaw_pair import JawPair
from workhold.geometry.hull import HullEdge, HullTouch, find_touches_along, hull_edges
from workhold.geometry.segment import Arc, Segment
from workhold.geometry.symmetry import find_rotations_onto_itself
from workhold.model.fixture_table import FixtureTable, make_flat_jaw_table
from workhold.model.friction import find_friction_coefficient
from workhold.model.jaw_hold import JawHold, Patch, ProgramNeed
from workhold.model.notes import NoFixture, Note, Remark, Stage
from workhold.model.program import Program
from workhold.model.quality import round_number_coarsely
from workhold.model.query import Query
from workhold.model.requirements import Load, lie_in_angle_ranges
from workhold.model.result import Result
from workhold.model.solid import Band
from workhold.model.workpiece import Workpiece
from workhold.statics.friction import (
    Grip,
    corners_of_load,
    find_least_peak_pressure,
    is_pressed_all_over,
)
from workhold.statics.jaw_program import CuttingPieces, worst_of_program
from workhold.statics.patches import PressedPatch, hulls_meet

__all__ = ["RULES", "Examined", "JawSearch", "find_fixtures_between_jaws"]

Array = NDArray[np.float64]
# The rules in the order in which they are asked.
RULES = {
    "angles": "angles of the part",
    "grip": "a grip of the least height by both jaws",
    "opening": "largest opening",
    "push": "jaws that press opposite each other",
    "avoid": "faces to avoid",
    "touch": "faces to touch",
    "program": "jaws clear of the program",
}
# What a rule is about that left nothing, as notes have it.
STAGE_OF: dict[str, Stage] = {"angles": "shape", "grip": "pair", "push": "set"}
# Straight sides that a drawing's decimals turn by less are parallel where they are off by no more than it means.
NEARLY_PARALLEL = 1e-6
# Two heights of one thickness where nobody says how thick the part is, in mm.
UNKNOWN_BAND = (0.0, 1.0)
# How far outward in mm jaws are taken to reach whose thickness is not given.
JAW_DEPTH = 1e4
# How far in mm what both jaws touch may miss each other by rounding.
PUSH_SLACK = 1e-7


@frozen
class JawTouch:
    """What of a part lies on a jaw.

    Parameters
    ----------
    low, high : from where to where along the jaw, in mm; equal for a point.
    band : the heights at which it touches, in mm.
    faces : numbers of the faces that touch; none for a corner.
    """

    low: float
    high: float
    band: Band
    faces: tuple[int, ...]

    @property
    def is_point(self) -> bool:
        return self.high <= self.low


@frozen(eq=False)
class JawOutline:
    """The outline that jaws meet whose top is at one height, and how it can lie.

    Parameters
    ----------
    outline : of the part between the heights of the jaws.
    first : the number of its first segment.
    height : of the part, in mm; None where nobody says.
    """

    outline: Workpiece
    first: int
    height: float | None

    @cached_property
    def segments(self) -> list[Segment]:
        return [face.segment for face in self.outline.outer_faces]

    @cached_property
    def edges(self) -> tuple[HullEdge, ...]:
        return hull_edges(self.segments, self.outline.outer_face_counts)

    @cached_property
    def angles(self) -> list[float]:
        """The orientations in radians at which it can lie on the fixed jaw; as drawn where it has no hull edge."""
        turns = [-atan2(edge.tangent[1], edge.tangent[0]) % (2 * pi) for edge in self.edges]
        return turns or [0.0]

    def band(self, number: int) -> Band | None:
        """The heights at which a face of an index is touched; None where it may not be."""
        solid = self.outline.solid
        if solid is not None:
            return solid.bands[self.outline.outer_faces[number].number]
        return UNKNOWN_BAND if self.height is None else (0.0, self.height)

    def number(self, index: int) -> int:
        """The number of a face, as files and pictures have it."""
        return self.first + self.outline.outer_faces[index].number

    def lying(self, place: int) -> Lying:
        """How it lies at the angle of a place in :attr:`angles`."""
        return Lying(self, self.angles[place], self.edges[place] if self.edges else None)


@frozen(eq=False)
class Lying:
    """A part that lies at an angle on the fixed jaw; x runs along the jaws, y away from the fixed one.

    Parameters
    ----------
    theta : in radians.
    edge : the hull edge that lies on the fixed jaw; None of a part that has none.
    """

    of: JawOutline
    theta: float
    edge: HullEdge | None

    def turned(self, point: tuple[float, float]) -> tuple[float, float]:
        """A point of the drawing, turned."""
        c, s = cos(self.theta), sin(self.theta)
        return c * point[0] - s * point[1], s * point[0] + c * point[1]

    @cached_property
    def reaches(self) -> dict[tuple[int, int], tuple[float, list[tuple[float, float, tuple[int, ...]]]]]:
        """How far the outline reaches along -x, x, -y and y, in mm, and the turned points there with their faces.

        A point has one face where it lies on an arc, and two where it is a corner.
        """
        points: list[tuple[float, float, tuple[int, ...]]] = []
        count = 0
        ways = ((-1, 0), (1, 0), (0, -1), (0, 1))
        found = {way: list[tuple[float, float, float, tuple[int, ...]]]() for way in ways}
        for size in self.of.outline.outer_face_counts:
            for k in range(count, count + size):
                face, before = self.of.segments[k], count + (k - count - 1) % size
                if not (isinstance(face, Arc) and face.is_full):
                    x, y = self.turned(face.start)
                    points.append((x, y, (before, k)))
                if isinstance(face, Arc) and face.sign > 0:
                    (x, y), middle = self.turned(face.center), face.mid_angle + self.theta
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

    def reach(self, a: int, b: int) -> float:
        return self.reaches[a, b][0]

    @cached_property
    def opposite(self) -> HullEdge | None:
        """The hull edge that lies on the jaw that moves, if one does."""
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
        """y of the fixed jaw."""
        return -self.reach(0, -1) if self.edge is None else self.turned(self.edge.start.point)[1]

    @cached_property
    def opening(self) -> float:
        """S in mm."""
        return self.reach(0, 1) - self.level

    @cached_property
    def touched(self) -> tuple[list[JawTouch], list[JawTouch]]:
        """What the fixed jaw touches, and what the one that moves does."""
        return self.touches(self.edge, -1), self.touches(self.opposite, 1)

    def touches(self, edge: HullEdge | None, way: int) -> list[JawTouch]:
        """What lies on the jaw below (-1) or above (1)."""
        if edge is None:
            along = [HullTouch(x, x, faces) for x, _, faces in self.reaches[0, way][1]]
        else:
            start = self.turned(edge.start.point)[0]
            along = []
            for one in find_touches_along(edge, self.of.segments, self.of.outline.outer_face_counts):
                low, high = sorted((start - way * one.low, start - way * one.high))
                along.append(HullTouch(low, high, one.faces))
        out = list[JawTouch]()
        for one in sorted(along, key=lambda one: (one.low == one.high, len(one.faces), one.low)):
            bands = [self.of.band(index) for index in one.faces]
            if any(band is None for band in bands):
                continue
            low, high = max(band[0] for band in bands if band), min(band[1] for band in bands if band)
            is_corner = len(one.faces) > 1
            if is_corner and any(other.low - READING <= one.low <= other.high + READING for other in out):
                continue
            faces = () if is_corner else tuple(self.of.number(index) for index in one.faces)
            out.append(JawTouch(one.low, one.high, (low, high), faces))
        return out

    def faces_at(self) -> set[int]:
        """The numbers of all faces that either jaw touches, those of corners as well."""
        out = set[int]()
        for edge, way in ((self.edge, -1), (self.opposite, 1)):
            if edge is None:
                indices = [index for *_, faces in self.reaches[0, way][1] for index in faces]
            else:
                touched = find_touches_along(edge, self.of.segments, self.of.outline.outer_face_counts)
                along = [one for one in touched if len(one.faces) == 1]
                indices = [index for one in along or touched for index in one.faces]
            out |= {self.of.number(index) for index in indices}
        return out


def gripped(touches: Sequence[JawTouch], top: float, least: float) -> list[JawTouch]:
    """What of some touches jaws grip whose top is so high above the part's lower side: stretches, or else points."""
    cut = [evolve(one, band=(max(one.band[0], 0.0), min(one.band[1], top))) for one in touches]
    high = [one for one in cut if one.band[1] - one.band[0] >= least]
    return [one for one in high if not one.is_point] or high


def clip_touches_to_jaws(touches: Sequence[JawTouch], shift: float, width: float) -> Patch | None:
    """What of some touches lies on jaws of a width, moved along them by ``shift``; None where nothing does."""
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
    return Patch(tuple(rows), tuple(sorted(dict.fromkeys(faces))), not faces)


def find_common_middle(one: Sequence[JawTouch], other: Sequence[JawTouch]) -> float | None:
    """The middle of what the ranges of two jaws' touches have in common; None where that is nothing."""
    low = max(min(touch.low for touch in touches) for touches in (one, other))
    high = min(max(touch.high for touch in touches) for touches in (one, other))
    return (low + high) / 2 if low <= high else None


@frozen
class Examined:
    """A hull edge with parallels and a stop.

    Parameters
    ----------
    theta, position : the pose, in radians and mm.
    hold : how the jaws hold it; None where a rule is broken before both touch it.
    rule : the first rule that it breaks, one of :data:`RULES`; None for a fixture.
    line : of the program whose tool comes too near a jaw.
    """

    theta: float
    position: tuple[float, float]
    hold: JawHold | None
    rule: str | None
    line: int | None = None


@frozen(eq=False)
class JawSearch:
    """The search of a query whose toolkit has two flat jaws."""

    query: Query

    @property
    def jaws(self) -> JawPair:
        jaws = self.query.toolkit.flat_jaws
        assert jaws is not None
        return jaws

    @cached_property
    def lyings(self) -> dict[float, list[Lying]]:
        """How the part can lie, for each height of parallels."""
        out, known = {}, dict[int, list[Lying]]()
        for parallels in self.jaws.parallels:
            outline, first = self.query.workpiece.outline_of(self.jaws.name_outline_role(parallels))
            if first not in known:
                one = JawOutline(outline, first, self.query.part_height)
                known[first] = [one.lying(place) for place in range(len(one.angles))]
            out[parallels] = known[first]
        return out

    @property
    def size(self) -> int:
        """How many ways there are to examine."""
        return sum(len(some) for some in self.lyings.values()) * len(self.jaws.stops)

    def examined(self) -> Iterator[Examined]:
        """Each way that there is, with the first rule that it breaks."""
        for parallels, stop in product(self.jaws.parallels, self.jaws.stops):
            for lying in self.lyings[parallels]:
                yield self.examine(lying, parallels, stop)

    def examine(self, lying: Lying, parallels: float, stop: str | None) -> Examined:
        query, jaws = self.query, self.jaws
        top = jaws.compute_top(parallels)
        nothing = Examined(lying.theta, (0.0, 0.0), None, "grip")
        if not lie_in_angle_ranges(degrees(lying.theta), query.restrictions.angles):
            return evolve(nothing, rule="angles")
        least = jaws.least_grip if query.part_height is not None else 0.0
        if top < jaws.least_grip:
            return nothing
        fixed, moving = (gripped(touches, top, least) for touches in lying.touched)
        if not fixed or not moving:
            return nothing
        middle = find_common_middle(fixed, moving)
        low, high = -lying.reach(-1, 0), lying.reach(1, 0)
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
        found = Examined(lying.theta, (shift, 0.0 - lying.level), hold, None)
        rule = self.broken(hold, lying)
        if rule is None and query.program is not None:
            line = self.line_near_jaws(query.program, found, hold)
            return found if line is None else evolve(found, rule="program", line=line)
        return evolve(found, rule=rule)

    def broken(self, hold: JawHold, lying: Lying) -> str | None:
        """The first rule that a hold breaks."""
        most = self.jaws.max_opening
        if most is not None and hold.opening > most + TOUCHING:
            return "opening"
        one, other = (np.array(PressedPatch(patch).corners) for patch in (hold.fixed, hold.moving))
        if not hulls_meet(one, other, PUSH_SLACK):
            return "push"
        asked = self.query.restrictions
        if asked.avoid and not lying.faces_at().isdisjoint(self.every_face(asked.avoid)):
            return "avoid"
        if asked.touch and not set(asked.touch) <= {*hold.fixed.segments, *hold.moving.segments}:
            return "touch"
        return None

    def line_near_jaws(self, program: Program, one: Examined, hold: JawHold) -> int | None:
        """The line of a program whose tool comes too near a jaw, a box from its face outward; None where none does."""
        swept = find_swept_below(program, self.jaws.compute_top(hold.parallels))
        if not len(swept):
            return None
        depth = JAW_DEPTH if self.jaws.thickness is None else self.jaws.thickness
        c, s = cos(one.theta), sin(one.theta)
        # Turned back, as the part was drawn.
        back, place = np.array([[c, -s], [s, c]]), np.array(one.position)
        for low, high in ((-depth, 0.0), (hold.opening, hold.opening + depth)):
            box = np.array([[0.0, low], [self.jaws.width, low], [self.jaws.width, high], [0.0, high]])
            reach, line = swept.reach_of_box((box - place) @ back)
            if reach < program.clearance:
                return line
        return None

    def every_face(self, faces: Sequence[int]) -> set[int]:
        """The numbers of faces, in every outline of a solid."""
        numbered = self.query.workpiece.numbered
        return {*faces, *numbered.segments_under(numbered.faces_over(faces))}

    def grip(self, one: Examined, hold: JawHold) -> Grip:
        """The grip of a fixture, for its loads."""
        lying = next(each for each in self.lyings[hold.parallels] if each.theta == one.theta)
        points, way = list[tuple[float, float, float]](), 1.0
        if hold.stop is not None:
            side = -1 if hold.stop == "left" else 1
            way = -float(side)
            y = [at + one.position[1] for _, at, _ in lying.reaches[side, 0][1]]
            x = side * lying.reach(side, 0) + one.position[0]
            high = min(self.jaws.compute_top(hold.parallels), self.height)
            points = [(x, each, z) for each in sorted({min(y), max(y)}) for z in (0.0, high)]
        return Grip.of(
            hold.fixed,
            hold.moving,
            hold.opening,
            find_friction_coefficient(self.query.friction, "jaw"),
            points,
            way,
        )

    @property
    def height(self) -> float:
        """How high the part is in mm, or what stands for it where nobody says."""
        known = self.query.part_height
        return UNKNOWN_BAND[1] if known is None else known

    def wrenches(self, load: Load, one: Examined, grip: Grip) -> Array:
        """The wrenches (N, 6) of a load's corners, with the safety factor."""
        height = load.height if load.height is not None else self.height
        if self.query.part_height is None:
            height = self.height / 2
        rows = grip.wrenches(*corners_of_load(load, one.theta, one.position, height))
        rows[:, 5] += load.moment / grip.length
        return np.asarray(rows * self.query.safety_factor)

    @cached_property
    def pieces(self) -> CuttingPieces | None:
        """Where the tools of the program press on the part; None without their forces."""
        program = self.query.program
        if program is None or program.forces is None:
            return None
        return CuttingPieces.from_program(program, self.height)

    @property
    def first_cut(self) -> ProgramNeed | None:
        """What the program asks for where no jaw force holds anything: more than any force, where it first cuts."""
        pieces, program = self.pieces, self.query.program
        if pieces is None or program is None or not len(pieces):
            return None
        move = int(pieces.move.min())
        return ProgramNeed(None, int(program.moves.line[move]), int(program.moves.tool[move]), move)

    def asked_by_program(self, one: Examined, grip: Grip) -> ProgramNeed | None:
        """What the tools of the program ask for; None without their forces."""
        pieces, query = self.pieces, self.query
        if pieces is None or query.program is None:
            return None
        return worst_of_program(grip, pieces, query.program, one.theta, one.position, query.safety_factor)

    def loaded(self, one: Examined) -> Examined:
        """A fixture with what its loads ask for, and with its warnings."""
        hold, loads = one.hold, self.query.loads
        assert hold is not None
        each: list[float | None] = [None] * len(loads)
        of_program = self.first_cut
        if self.query.is_loaded and hold.full_contact:
            grip = self.grip(one, hold)
            each = [find_largest_force(grip.forces_needed(self.wrenches(load, one, grip))) for load in loads]
            of_program = self.asked_by_program(one, grip)
        hold = evolve(hold, clamp_needed_each=tuple(each), program_need=of_program)
        needed = hold.clamp_needed
        pressure = None if not needed else find_least_peak_pressure(hold.fixed, hold.moving, needed)
        hold = evolve(hold, max_pressure=None if self.query.part_height is None else pressure)
        return evolve(one, hold=evolve(hold, warnings=tuple(self.warnings(hold))))

    @property
    def acting(self) -> str:
        """What acts on the part, in words."""
        names = ("the loads", bool(self.query.loads)), ("the tools", self.pieces is not None)
        return " and ".join(name for name, is_there in names if is_there)

    def warnings(self, hold: JawHold) -> Iterator[str]:
        """What to beware of, sentences."""
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
                f"closed with {self.query.jaw_force:g} N the jaws hold {self.acting} {reached:.2f} times, and {safety:g} "
                "times are asked for"
            )
        if hold.above == 0.0:
            yield "nothing of the part stands above the jaws"
        ends = hold.fixed.ends, hold.moving.ends
        if max(one[1] for one in ends) >= self.jaws.width or min(one[0] for one in ends) <= 0.0:
            yield "the part reaches to the end of the jaws or beyond"


def find_largest_force(needs: Sequence[float | None]) -> float | None:
    """The largest of some forces; None where one of them is none."""
    known = [need for need in needs if need is not None]
    return max(known) if len(known) == len(needs) else None


def is_square(theta: float) -> bool:
    """Whether an angle in radians is a quarter turn, or none."""
    return abs((degrees(theta) + 45.0) % 90.0 - 45.0) < SQUARE_TILT


def order_of(one: Examined, query: Query) -> tuple[float, ...]:
    """What fixtures are put in order by: smaller comes first."""
    hold = one.hold
    assert hold is not None
    key: list[float] = [hold.is_unfit, not hold.full_contact, hold.is_beyond_rating]
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
                    else round_number_coarsely(hold.clamp_needed)
                )
            case "contact_area":
                key.append(-round_number_coarsely(hold.contact_area))
            case "max_pressure":
                key.append(inf if hold.max_pressure is None else round_number_coarsely(hold.max_pressure))
            case _:
                value = getattr(hold, name)
                key.append(inf if value is None else -round(value, 6))
    stops = ("left", "right")
    return (*key, round(one.theta, 9), hold.parallels, stops.index(hold.stop) if hold.stop else -1)


def find_fixtures_between_jaws(
    query: Query, progress: Progress | None = None, cancel: Event | None = None
) -> Result:
    """Finds every way to hold a part between the flat jaws of a query's toolkit."""
    search, found, whole = JawSearch(query), list[Examined](), True
    size, rules, lines = search.size, dict.fromkeys(RULES, 0), Counter[int]()
    for number, one in enumerate(search.examined(), 1):
        if cancel is not None and cancel.is_set():
            whole = False
            break
        if one.rule is None:
            found.append(search.loaded(one))
        else:
            rules[one.rule] += 1
            lines.update([] if one.line is None else [one.line])
        if progress is not None:
            progress(number / size, len(found))
    found.sort(key=lambda one: order_of(one, query))
    listed = found[: query.best]
    notes = list[Note]()
    if whole and not found:
        notes.append(no_fixture(rules, lines, query))
    count = {query.toolkit.arrangements[0].name: len(found)}
    return Result(
        query=query,
        table=table_of(listed),
        found=count,
        distinct=dict.fromkeys(count, distinct(found, query.workpiece)),
        complete=whole,
        notes=tuple(notes),
        statistics={"hull_edges": sum(len(some) for some in search.lyings.values()), "examined": size},
        holds=tuple(one.hold for one in listed if one.hold is not None),
    )


def table_of(listed: Sequence[Examined]) -> FixtureTable:
    """The table of some fixtures."""
    holds = [one.hold for one in listed if one.hold is not None]
    return make_flat_jaw_table(
        [one.theta for one in listed],
        [one.position for one in listed],
        [hold.opening for hold in holds],
        [len(hold.warnings) for hold in holds],
    )


def distinct(found: Sequence[Examined], workpiece: Workpiece) -> int:
    """How many fixtures there are where such that a rotation of the part makes the same count once."""
    every = workpiece.numbered
    turns = [
        one.angle for one in find_rotations_onto_itself([face.segment for face in every.faces], every.marks)
    ]
    seen = set[tuple[object, ...]]()
    for one in found:
        assert one.hold is not None
        least = min(round((one.theta - turn) % (2 * pi), 6) % round(2 * pi, 6) for turn in turns)
        seen.add((least, one.hold.parallels, one.hold.stop))
    return len(seen)


def no_fixture(rules: dict[str, int], lines: Counter[int], query: Query) -> Note:
    """Why there is no fixture: the last rule that took any away."""
    wording = query.toolkit.wording
    if lines:
        line = min(lines, key=lambda line: (-lines[line], line))
        return Remark(
            f"Both jaws would press the part, but line {line} of the program brings a tool too near a jaw."
        )
    last = next((rule for rule in reversed(RULES) if rules[rule]), "grip")
    return NoFixture(STAGE_OF.get(last, "hold"), wording)
