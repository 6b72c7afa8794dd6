"""The clearance between a program's tools and the fixture, by a walk along the moves with bounds.

The walk uses the program's own moves of the tool tip, not the search's simplified ones. A stretch of a move
lies within its sagitta of its chord, so its distance from an element is that of the chord to within the
sagitta. Stretches that cannot contain the least distance are dropped. The others are halved, and so are
stretches on which a cylinder of the tool reaches the pegs' height or leaves it. Numbers are doubles: their
rounding is far below the tolerance that decides, ``tolerances.AGREEMENT``.

Glossary
--------
element : a part of the fixture: a disc, a capsule (all points within a radius of a middle line), or a half
    plane.
stretch : a part of a move, between two shares of it (0 to 1), with one cylinder of its tool.
sagitta : the largest distance of a stretch from its chord.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from math import inf, radians

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.fixels.carrier import Carrier
from workhold.model.fixture import Fixture, Peg
from workhold.model.program import Program
from workhold.model.quality import PROGRAM_FIGURE
from workhold.model.query import Query
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.tolerances import AGREEMENT

__all__ = [
    "HoldingElement",
    "ToolWalk",
    "make_element_name",
    "list_elements",
    "find_program_fault",
    "make_walk",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# mm. To this the least distance is worked out, and how far heights may be off.
FINE, HAIR = 1e-7, 1e-9
MOST_HALVINGS = 200


@frozen
class HoldingElement:
    """Something that holds the part, in the part's frame in mm: a disc, a capsule or a half plane.

    Parameters
    ----------
    name : its name in messages.
    place : the name of its place.
    start, end : ends of its middle line. For a half plane, a point on its border, and the unit vector away
        from it.
    radius : around the middle line; 0 for a half plane.
    height : of its upper end.
    is_half_plane : whether it is a half plane.
    low : height of its lower end; 0 means that it stands from below the part.
    """

    name: str
    place: str
    start: tuple[float, float]
    end: tuple[float, float]
    radius: float
    height: float
    is_half_plane: bool = False
    low: float = 0.0


@frozen
class NearestApproach:
    """Lower and upper bound in mm of the least clearance, and the program line of that move."""

    low: float
    high: float
    line: int


@frozen(eq=False)
class PathStretches:
    """N stretches, each a part of a move with one cylinder of the move's tool.

    Parameters
    ----------
    move : (N,) numbers of moves.
    first, last : (N,) shares of the move, from 0 to 1, at which each stretch begins and ends.
    under, over, radius : (N,) heights of the cylinder's ends above the tip, and its radius, in mm.
    """

    move: IntArray
    first: Array
    last: Array
    under: Array
    over: Array
    radius: Array

    def take(self, chosen: NDArray[np.bool_] | IntArray) -> PathStretches:
        """Return only the stretches that a mask or indices select."""
        rest = (self.first, self.last, self.under, self.over, self.radius)
        return PathStretches(self.move[chosen], *(values[chosen] for values in rest))

    def halve(self) -> PathStretches:
        """Return 2 N stretches: the first halves of all, then the second halves."""
        middle = (self.first + self.last) / 2
        both = [np.concatenate([v, v]) for v in (self.move, self.under, self.over, self.radius)]
        first, last = np.concatenate([self.first, middle]), np.concatenate([middle, self.last])
        return PathStretches(both[0], first, last, *both[1:])


@frozen(eq=False)
class ToolWalk:
    """The moves of a program, with the circles of round ones.

    Parameters
    ----------
    program : the program.
    center, radius, turn, sweep : (M, 2) and (M,) centre, radius, start angle and swept angle in radians of
        round moves.
    is_round, is_box : (M,) whether a move is an arc, and whether it may take any path in the box of its ends.
    """

    program: Program
    center: Array
    radius: Array
    turn: Array
    sweep: Array
    is_round: NDArray[np.bool_]
    is_box: NDArray[np.bool_]

    @classmethod
    def from_program(cls, program: Program) -> ToolWalk:
        """Return the moves of a program with centre, radius and angles of its round moves."""
        moves = program.moves
        start, end, bulge = moves.start[:, :2], moves.end[:, :2], moves.bulge
        chord = end - start
        is_round = (bulge != 0.0) & (chord != 0.0).any(axis=1)
        safe = np.where(is_round, bulge, 1.0)
        left = np.stack([-chord[:, 1], chord[:, 0]], axis=1)
        # The tangent of half the half sweep is the bulge, so its cotangent places the centre.
        center = (start + end) / 2 + left * ((1.0 - safe * safe) / (4.0 * safe))[:, None]
        arm = start - center
        changes = (moves.start != moves.end).sum(axis=1)
        is_box = (program.rapid == "box") & ~moves.cutting & (changes > 1)
        return cls(
            program,
            center,
            np.hypot(*arm.T),
            np.arctan2(arm[:, 1], arm[:, 0]),
            4.0 * np.arctan(np.where(is_round, bulge, 0.0)),
            is_round,
            np.asarray(is_box),
        )

    def list_stretches(self) -> PathStretches:
        """Return one stretch over the whole move for every move and every cylinder of its tool."""
        parts = []
        for number, tool in self.program.tools.items():
            moved = np.flatnonzero(self.program.moves.tool == number)
            for cylinder in tool.cylinders:
                ones = np.ones(len(moved))
                sizes = (size * ones for size in (cylinder.low, cylinder.high, cylinder.radius))
                parts.append(PathStretches(moved, 0.0 * ones, ones, *sizes))
        columns = ("move", "first", "last", "under", "over", "radius")
        joined = [np.concatenate([getattr(part, name) for part in parts] or [[]]) for name in columns]
        return PathStretches(joined[0].astype(np.int64), *joined[1:])

    def compute_places_at(self, move: IntArray, share: Array) -> Array:
        """Return the tool axis's places (N, 2) in mm at shares (N,) from 0 to 1 of moves (N,)."""
        moves = self.program.moves
        start, end = moves.start[move, :2], moves.end[move, :2]
        straight = start + share[:, None] * (end - start)
        angle = self.turn[move] + share * self.sweep[move]
        bent = self.center[move] + self.radius[move, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        return np.asarray(np.where(self.is_round[move, None], bent, straight))

    def find_nearest(
        self, element: HoldingElement, line: object = None, tool: object = None
    ) -> NearestApproach:
        """Return bounds of the least clearance of an element from the tools; inf if no tool comes down to its
        height.

        The bounds are at most ``FINE`` mm apart, unless halving ends early. Without any approach the line is
        -1.

        Parameters
        ----------
        line, tool : the program line and tool number whose moves are searched; None for all.
        """
        found, at = inf, -1
        waiting, low, moves = self.list_stretches(), inf, self.program.moves
        if line is not None:
            waiting = waiting.take((moves.line[waiting.move] == line) & (moves.tool[waiting.move] == tool))
        start, rise = moves.start[:, 2], (moves.end - moves.start)[:, 2]
        for _ in range(MOST_HALVINGS):
            move = waiting.move
            one, other = (start[move] + t * rise[move] + waiting.under for t in (waiting.first, waiting.last))
            boxed = self.is_box[move]
            # In a box everything counts as long as its lower height does.
            least, most = np.minimum(one, other), np.where(boxed, -inf, np.maximum(one, other))
            long = waiting.over - waiting.under
            # Where an element begins higher, the cylinder's upper end must come up to that.
            from_below = element.low <= 0.0
            top = np.where(from_below | boxed, inf, least + long)
            there = least <= element.height + HAIR
            there &= from_below | (np.maximum(one, other) + long >= element.low - HAIR)
            waiting = waiting.take(there)
            move, boxed, one, other = move[there], boxed[there], one[there], other[there]
            least, most, top, long = least[there], most[there], top[there], long[there]
            if not len(move):
                break
            off, sagitta = self.measure_distances(waiting, element, boxed)
            off -= waiting.radius + element.radius
            whole = (most <= element.height) & (top >= element.low)
            # Of a stretch that does not count all along, an end may.
            sure = np.where(whole, off + sagitta, inf)
            for z, share in ((one, waiting.first), (other, waiting.last)):
                counts = (z <= element.height) & (from_below | (z + long >= element.low))
                points = self.compute_places_at(move, share)
                at_end = (
                    self.measure_chord_distances(points, points, element) - waiting.radius - element.radius
                )
                sure = np.where(~whole & counts, np.minimum(sure, at_end), sure)
            best = int(sure.argmin())
            if sure[best] < found:
                found, at = float(sure[best]), int(moves.line[move[best]])
            done = (whole & (sagitta <= FINE / 4)) | (waiting.last - waiting.first < 1e-15)
            below = off - sagitta
            low = min(low, float(below[done].min(initial=inf)))
            kept = ~done & (below < found - FINE)
            # What is let go is no lower than what is known, less what is asked for.
            low = min(low, float(below[~done & ~kept].min(initial=inf)))
            waiting = waiting.take(kept).halve()
            if not len(waiting.move):
                break
        return NearestApproach(min(low, found), found, at)

    def measure_distances(
        self, stretches: PathStretches, element: HoldingElement, boxed: NDArray[np.bool_]
    ) -> tuple[Array, Array]:
        """Return in mm the distances (N,) of the stretches' chords from an element, and the stretches' sagittas (N,).

        Where ``boxed`` (N,) is True, the distance is that of the bounding box of the move's ends.
        """
        move = stretches.move
        one, other = (
            self.compute_places_at(move, stretches.first),
            self.compute_places_at(move, stretches.last),
        )
        sweep = np.abs(self.sweep[move]) * (stretches.last - stretches.first)
        bow = 2.0 * np.sin(np.minimum(sweep, np.pi) / 4) ** 2
        # An arc of half a turn or more is within its radius of its chord's ends.
        sagitta = np.where(self.is_round[move], np.where(sweep < np.pi, bow, 2.0) * self.radius[move], 0.0)
        off = self.measure_chord_distances(one, other, element)
        for k in np.flatnonzero(boxed).tolist():
            start, end = self.program.moves.start[move[k], :2], self.program.moves.end[move[k], :2]
            off[k] = self.measure_box_distance(start, end, element)
        return off, sagitta

    def measure_chord_distances(self, one: Array, other: Array, element: HoldingElement) -> Array:
        """Return the distances (N,) in mm of straight segments from an element's middle line or half plane.

        The segments run from ``one`` (N, 2) to ``other`` (N, 2), and may be points. The distance is 0 in a
        half plane.
        """
        start, end = np.array(element.start), np.array(element.end)
        if element.is_half_plane:
            return np.asarray(np.maximum(np.minimum((one - start) @ end, (other - start) @ end), 0.0))
        ends = [measure_points_to_piece(one, start, end), measure_points_to_piece(other, start, end)]
        ends += [measure_pieces_to_point(one, other, start), measure_pieces_to_point(one, other, end)]
        least = np.minimum.reduce(ends)
        return np.where(are_crossing(one, other, start, end), 0.0, least)

    def measure_box_distance(self, one: Array, other: Array, element: HoldingElement) -> float:
        """Return the distance in mm of a box from an element's middle line or half plane.

        ``one`` and ``other`` are two opposite corners of the box.
        """
        (x0, y0), (x1, y1) = np.minimum(one, other), np.maximum(one, other)
        corners = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
        sides = float(self.measure_chord_distances(corners, np.roll(corners, -1, axis=0), element).min())
        inside = x0 <= element.start[0] <= x1 and y0 <= element.start[1] <= y1
        return 0.0 if inside and not element.is_half_plane else sides


def measure_points_to_piece(points: Array, start: Array, end: Array) -> Array:
    """Return the distances (N,) of points (N, 2) from one straight segment; start and end may be equal."""
    along = end - start
    long = float(along @ along)
    share = np.clip((points - start) @ along / long, 0.0, 1.0) if long > 0.0 else np.zeros(len(points))
    return np.asarray(np.hypot(*(points - start - share[:, None] * along).T))


def measure_pieces_to_point(one: Array, other: Array, point: Array) -> Array:
    """Return the distances (N,) of straight segments from ``one`` to
    ``other``, both (N, 2), from one point (2,).
    """
    along = other - one
    long = (along * along).sum(axis=1)
    share = ((point - one) * along).sum(axis=1) / np.where(long > 0.0, long, 1.0)
    return np.asarray(np.hypot(*(point - one - np.clip(share, 0.0, 1.0)[:, None] * along).T))


def are_crossing(one: Array, other: Array, start: Array, end: Array) -> NDArray[np.bool_]:
    """Return (N,) booleans: whether each of N segments properly crosses the segment from ``start`` to
    ``end``.

    The N segments run from ``one`` (N, 2) to ``other`` (N, 2). Segments that only touch, or are parallel, do
    not cross.
    """

    def compute_side(a: Array, b: Array, c: Array) -> Array:
        """Return twice the signed area of the triangle a, b, c: positive where c is to the left of a to b."""
        return np.asarray((b - a)[..., 0] * (c - a)[..., 1] - (b - a)[..., 1] * (c - a)[..., 0])

    apart = compute_side(start, end, one) * compute_side(start, end, other) < 0.0
    return np.asarray(apart & (compute_side(one, other, start) * compute_side(one, other, end) < 0.0))


@lru_cache(maxsize=8)
def make_walk(program: Program) -> ToolWalk:
    """Return the walk along a program; cached."""
    return ToolWalk.from_program(program)


def find_program_fault(fixture: Fixture, query: Query, hardware: ToolkitRules) -> str:
    """Return a sentence, without full stop, if a fixture and the program disagree, else "".

    Two faults: a tool comes too near to the fixture; the written clearance is missing, superfluous or wrong.
    """
    said = fixture.quality.get(PROGRAM_FIGURE.key)
    if query.program_to_clear is None:
        return "" if said is None else f"its {PROGRAM_FIGURE.words} is given, and there is no program"
    program, height = query.program_to_clear
    walk, least = make_walk(program), NearestApproach(inf, inf, -1)
    elements = list(list_elements(fixture, hardware, height))
    for element in elements:
        near = walk.find_nearest(element)
        if near.high < program.clearance - AGREEMENT:
            return (
                f"line {near.line} of the program brings a tool within {near.high:.6g} mm of {element.name}, "
                f"and {program.clearance:g} mm are to be kept"
            )
        high, line = (near.high, near.line) if near.high < least.high else (least.high, least.line)
        least = NearestApproach(min(least.low, near.low), high, line)
    if (said is None) != (least.high == inf):
        return (
            f"its {PROGRAM_FIGURE.words} is {'missing' if said is None else 'given, and no tool comes down'}"
        )
    if said is not None and not least.low - AGREEMENT <= said <= least.high + AGREEMENT:
        return f"its {PROGRAM_FIGURE.words} is {said:.12g} in the file and comes to {least.high:.9g}"
    return find_clearance_fault(fixture, walk, elements, least)


def find_clearance_fault(
    fixture: Fixture, walk: ToolWalk, elements: Sequence[HoldingElement], least: NearestApproach
) -> str:
    """Return a sentence if the file names a wrong nearest move; "" if it names the right one or none.

    ``elements`` are the elements of the fixture, and ``least`` is the derived nearest approach.
    """
    said = fixture.passing
    if said is None:
        return ""
    keys = ("distance", "line", "tool", "element")
    if not isinstance(said, dict) or any(key not in said for key in keys):
        return f"its {PROGRAM_FIGURE.words} does not have {', '.join(keys[:-1])} and {keys[-1]}"
    if said["distance"] != fixture.quality.get(PROGRAM_FIGURE.key):
        return f"its {PROGRAM_FIGURE.words} is given twice, and differs"
    named = [one for one in elements if one.place == said["element"]]
    near = min((walk.find_nearest(one, said["line"], said["tool"]).low for one in named), default=inf)
    if near > least.high + AGREEMENT:
        return (
            f"T{said['tool']} does not come nearest in line {said['line']} of the program, to the "
            f"{said['element']}"
        )
    return ""


def list_elements(fixture: Fixture, hardware: ToolkitRules, height: float) -> Iterator[HoldingElement]:
    """Yield the walls, pegs and clamps that hold a part, in the part's frame in mm.

    A peg whose body is wider below height 0 yields a second element. ``height`` is the top of elements that
    have no heights of their own.
    """
    angle = radians(fixture.pose.theta_deg)
    cosine, sine = np.cos(angle), np.sin(angle)

    def map_to_part(x: float, y: float) -> tuple[float, float]:
        """Return a point of the toolkit's frame in the part's frame."""
        dx, dy = x - fixture.pose.x, y - fixture.pose.y
        return float(cosine * dx + sine * dy), float(cosine * dy - sine * dx)

    for wall in hardware.walls:
        # Up in the toolkit is this way in the part.
        low, top = wall.heights or (0.0, height)
        up = float(sine), float(cosine)
        yield HoldingElement(f"the {wall.noun}", wall.noun, map_to_part(0.0, 0.0), up, 0.0, top, True, low)
    for name, peg in hardware.list_placed(fixture):
        carrier = hardware.carriers[peg.carrier]
        low, top = carrier.heights or (0.0, height)
        ends = map_to_part(peg.x, peg.y), map_to_part(*find_far_end(peg, carrier))
        whole = HoldingElement(
            name, make_element_name(peg, hardware), *ends, carrier.peg_radius, top, low=low
        )
        yield whole
        if carrier.body_radius > carrier.peg_radius:
            yield evolve(whole, radius=carrier.body_radius, height=0.0, low=0.0)


def make_element_name(peg: Peg, hardware: ToolkitRules) -> str:
    """Return the name that files give to the place of a peg: its hole, with the peg's noun, or the wall."""
    carrier = hardware.carriers[peg.carrier]
    if carrier in hardware.walls:
        return carrier.noun
    return f"{carrier.peg} {peg.hole}" if carrier.has_lattice else peg.hole


def find_far_end(peg: Peg, carrier: Carrier) -> tuple[float, float]:
    """Return the end of a peg's middle line that is not at the peg's centre, in the toolkit's frame in mm.

    For a clamp bolted in a hole it is that hole. For all other pegs it is the centre again.
    """
    if not carrier.has_body_behind:
        return peg.x, peg.y
    (x, y), (pitch_x, pitch_y) = carrier.offset, carrier.pitch
    return x + peg.column * pitch_x, y + peg.row * pitch_y
