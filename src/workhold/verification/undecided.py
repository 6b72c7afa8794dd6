"""Check that an undecided entry of a proof is a possible place: four contacts, or two chords, that may exist.

The entry names faces, holes and a range of orientations. In the workpiece's frame each peg's centre moves on
the line or circle of its face, offset outward by the peg radius. The curve of each other peg of a jaw, moved
back by the step between their holes, is also a curve for the jaw's first peg. The crossings of two of these
curves are computed in ball arithmetic; they give the centres of all pegs of the jaw. Each peg must then touch
its face between the face's ends. The rows of the pegs of two jaws must have the distance given in the entry,
and the pegs must be at least the smallest gap apart.

A condition that certainly fails in the whole range is a fault. Parallel curves decide nothing. An undecided
entry need not be a solution: it may miss one by the distance that pegs move within the range.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from math import hypot, radians

from attrs import evolve, frozen
from flint import arb, ctx

from workhold.fixels.contacts import WALL_END
from workhold.fixels.toolkit import Arrangement, Carrier
from workhold.model.query import Query
from workhold.model.search_report import AT_AN_EDGE, GIVEN_UP, NEARLY_DOUBLE, UNBOUNDED, UndecidedCandidate
from workhold.verification.ball_geometry import (
    PRECISIONS,
    ArcSide,
    BallOutline,
    LineSide,
    Point,
    Side,
    compute_dot_product,
    compute_norm,
    cross,
    turn_vector,
)
from workhold.verification.contacts import compute_standoff, make_joint_outline
from workhold.verification.rules.travel import count_quarter_turns, turn_hole_back
from workhold.verification.seat import LOCATORS
from workhold.verification.tolerances import AGREEMENT
from workhold.verification.touching import find_points_on_circle, find_points_on_line

__all__ = ["find_undecided_faults"]

# mm. Features end so much farther out while contacts are sought; contacts are off by their errors.
LOOSE = 10 * AGREEMENT
# No unit. Lines with a sine less than this between them may be taken for parallel, and the others cross where
# they do.
PARALLEL = 1e-7
# Degrees. An orientation is written to 1e-10.
WRITTEN = 1e-9
REASONS = (AT_AN_EDGE, GIVEN_UP, NEARLY_DOUBLE, UNBOUNDED)


@frozen(eq=False)
class TouchingPeg:
    """A peg that touches a side.

    Parameters
    ----------
    side : the side touched.
    radius : the distance of its centre from the side in mm.
    step : vector from the first peg of its jaw to it, in the workpiece's frame in mm.
    column : of its hole.
    loose : tolerance in mm of its place.
    """

    side: Side
    radius: arb
    step: Point
    column: int
    loose: float


def find_undecided_faults(entries: Sequence[UndecidedCandidate], query: Query) -> Iterator[str]:
    """Yield one sentence for each undecided entry, numbered from 1, that certainly is not a possible place."""
    if not entries:
        return
    with ctx.workprec(PRECISIONS[0]):
        outline = make_joint_outline(query.workpiece)
        for number, entry in enumerate(entries, 1):
            parts = (
                split_into_single_entries(entry, query)
                if query.toolkit.travel_count > 1
                else ((entry, query),)
            )
            fault = next(filter(None, (find_entry_fault(*part, outline) for part in parts)), "")
            if fault:
                yield f"undecided candidate {number} of the proof {fault}"


def find_entry_fault(entry: UndecidedCandidate, query: Query, outline: BallOutline) -> str:
    """Return a verb phrase that describes the fault of an entry; "" if there is none.

    The entry has four contacts, or is a pair of chords.
    """
    fault = find_written_fault(entry, query, outline)
    if WALL_END not in query.toolkit.contacts:
        fault = fault or find_count_fault(entry, query)
        fault = fault or find_holes_fault(entry, query) or find_place_fault(entry, query, outline)
    return fault


def split_into_single_entries(
    entry: UndecidedCandidate, query: Query
) -> Iterator[tuple[UndecidedCandidate, Query]]:
    """Yield (entry, query) for each clamp of an entry with two clamps, as if the toolkit had that clamp
    alone.

    An entry whose type or number of faces is not asked for is yielded once, with a type that no query has.
    """
    _, *directions = entry.type.split()
    alone = {one.direction: (one.name, way) for way in query.toolkit.ways for one in way.arrangements}
    asked = (
        query.toolkit.arrangements
        if len(directions) > 1
        else [a for w in query.toolkit.ways for a in w.arrangements]
    )
    if entry.type not in [one.title for one in asked] or len(entry.faces) - LOCATORS != len(directions):
        # Of a kind that is not asked for, which is the fault.
        yield evolve(entry, type=f"{entry.type} with {len(entry.faces)} pegs"), query
        return
    for number, direction in enumerate(directions, LOCATORS):
        chosen = (*range(LOCATORS), number)
        faces, columns, rows = (
            [values[k] for k in chosen] for values in (entry.faces, entry.columns, entry.rows)
        )
        if len(directions) > 1:
            columns, rows = [k - columns[0] for k in columns], [k - rows[0] for k in rows]
            (columns if direction.endswith("x") else rows)[LOCATORS] = 0
        name, way = alone[direction]
        single = evolve(query, toolkit=way, types=None, rank_by=None, best=None, listing=None)
        holes = tuple(faces), tuple(columns), tuple(rows)
        yield (
            UndecidedCandidate(f"{name} {direction}", *holes, entry.theta_deg, entry.reason, entry.reach_deg),
            single,
        )


def is_of_chords(entry: UndecidedCandidate) -> bool:
    """Return whether an entry is a pair of chords, each from the first to the second peg of a jaw, and not
    four contacts.
    """
    return entry.reason == GIVEN_UP


def find_arrangement(entry: UndecidedCandidate, query: Query) -> Arrangement:
    """Return the arrangement whose title is the entry's: its type, and its direction if there are several."""
    return next(one for one in query.toolkit.arrangements if one.title == entry.type)


def turn_entry_along_x(entry: UndecidedCandidate, query: Query) -> tuple[UndecidedCandidate, list[Carrier]]:
    """Return an entry turned by quarter turns so that its clamp moves along -x, and the turned carriers of
    its four pegs.
    """
    arrangement, carriers = find_arrangement(entry, query), query.toolkit.carriers
    if is_of_chords(entry) and arrangement.pegs != (2, 2):
        pegs = [carriers[0]] * 4
    else:
        pegs = [carriers[number] for number in arrangement.carriers]
    turns = 0 if arrangement.direction is None else count_quarter_turns(arrangement.direction)
    if turns == 0:
        return entry, pegs
    holes = [turn_hole_back(turns, *hole) for hole in zip(entry.columns, entry.rows, strict=True)]
    columns, rows = ((a, b, c, d) for a, b, c, d in zip(*holes, strict=True))
    if turns % 2:
        pegs = [evolve(one, pitch=one.pitch[::-1], columns=one.rows, rows=one.columns) for one in pegs]
    return evolve(entry, columns=columns, rows=rows, theta_deg=entry.theta_deg - 90.0 * turns), pegs


def group_pegs(entry: UndecidedCandidate, query: Query) -> list[list[int]]:
    """Return lists of peg indices, from 0; in each list the holes are counted from the hole of the list's
    first peg.

    The lists are those of the two jaws, or of the locators and the clamp. Empty lists are left out.
    """
    first, count = 2 if is_of_chords(entry) else find_arrangement(entry, query).pegs[0], len(entry.faces)
    return [group for group in (list(range(first)), list(range(first, count))) if group]


def find_written_fault(entry: UndecidedCandidate, query: Query, outline: BallOutline) -> str:
    """Return a verb phrase if an entry's type, reason, reach or face numbers are wrong, else ""."""
    if entry.type not in [one.title for one in query.toolkit.arrangements if one.name in query.types]:
        return f"is of type {entry.type}, which is not asked for"
    if entry.reason not in REASONS:
        return "is undecided for a reason that is none"
    if not is_of_chords(entry) and entry.reason != UNBOUNDED and entry.reach_deg is None:
        return "does not say how far its orientation may be off"
    if not set(entry.faces) <= set(outline.faces):
        return "names a segment that is not a face"
    return ""


def find_count_fault(entry: UndecidedCandidate, query: Query) -> str:
    """Return a verb phrase where an entry's number of faces or holes is not its number of pegs; "" where both
    are.
    """
    count = 4 if is_of_chords(entry) else sum(find_arrangement(entry, query).pegs)
    numbers = (entry.faces, entry.columns, entry.rows)
    return "" if all(len(one) == count for one in numbers) else f"has not {count} faces and holes"


def find_holes_fault(entry: UndecidedCandidate, query: Query) -> str:
    """Return a verb phrase where holes are counted wrongly, used twice, or span more than the carrier; ""
    otherwise.
    """
    entry, carriers = turn_entry_along_x(entry, query)
    for group in group_pegs(entry, query):
        carrier, first = carriers[group[0]], group[0]
        if entry.columns[first] or (entry.rows[first] and (first == 0 or is_of_chords(entry))):
            return "does not count its holes from the first peg"
        holes = {(entry.columns[k], entry.rows[k]) for k in group}
        if len(holes) < len(group):
            return "has two pegs in the same hole"
        for column, row in holes:
            if carrier.columns is not None and abs(column) >= carrier.columns:
                return f"spans {abs(column) + 1} columns of a {carrier.noun} with {carrier.columns}"
            if carrier.rows is not None and abs(row - entry.rows[first]) >= carrier.rows:
                return (
                    f"spans {abs(row - entry.rows[first]) + 1} rows of a {carrier.noun} with {carrier.rows}"
                )
    return ""


def find_place_fault(entry: UndecidedCandidate, query: Query, outline: BallOutline) -> str:
    """Return a verb phrase where the pegs certainly cannot touch their faces anywhere in the entry's range;
    "" otherwise.
    """
    if entry.reach_deg is None and not is_of_chords(entry):
        return ""
    entry, carriers = turn_entry_along_x(entry, query)
    theta = arb(entry.theta_deg, (entry.reach_deg or 0.0) + WRITTEN)
    sine, cosine = (theta / 180).sin_cos_pi()
    loose = LOOSE + radians(entry.reach_deg or 0.0) * bound_outline_size(query)
    groups = group_pegs(entry, query)
    pegs = []
    for group in groups:
        pitch_x, pitch_y = carriers[group[0]].pitch
        steps = [
            (arb(pitch_x) * entry.columns[k], arb(pitch_y) * (entry.rows[k] - entry.rows[group[0]]))
            for k in group
        ]
        sides = [outline.faces[entry.faces[k]] for k in group]
        turns = [turn_vector(step, cosine, -sine) for step in steps]
        radii = [
            compute_standoff(side, carriers[group[0]].peg_radius, carriers[group[0]].flat) for side in sides
        ]
        columns = [entry.columns[k] for k in group]
        pegs.append([TouchingPeg(*one, loose) for one in zip(sides, radii, turns, columns, strict=True)])
    held = [find_first_peg_places(group) if len(group) > 1 else None for group in pegs]
    if any(places is not None and not places for places in held):
        return "is not a place where its pegs touch their faces"
    standing = held[0]
    if is_of_chords(entry) or len(held) == 1 or standing is None:
        return ""
    moving = held[1]
    first, second = (carriers[group[0]] for group in groups)
    up = arb(second.pitch[1]) * entry.rows[groups[1][0]] + second.offset[1] - first.offset[1]
    reach = arb(max(peg.column for peg in pegs[0])) - min(peg.column for peg in pegs[1])
    gap = query.toolkit.gap
    ahead = None if gap is None else reach * first.pitch[0] + gap
    if len(pegs[1]) == 1:
        rows = [find_places_on_row(pegs[1][0], tail, up, (cosine, sine)) for tail in standing]
        moving = None if None in rows else [place for row in rows for place in row or ()]
    if moving is None:
        return ""
    for tail, place in product(standing, moving):
        apart = turn_vector((place[0] - tail[0], place[1] - tail[1]), cosine, sine)
        if not (abs(apart[1] - up) > loose or (ahead is not None and apart[0] < ahead - loose)):
            return ""
    if gap is None:
        return "is not a place where the clamp's tip is on its line"
    return "is not a place where the pegs of both jaws stand in their rows, the smallest gap apart"


def bound_outline_size(query: Query) -> float:
    """Return an upper bound in mm of the distance between two points of the part, or of pegs that touch
    it.
    """
    x0, y0, x1, y1 = query.workpiece.bounds
    return hypot(x1 - x0, y1 - y0) + 2.0 * max(carrier.peg_radius for carrier in query.toolkit.carriers)


def find_first_peg_places(group: Sequence[TouchingPeg]) -> list[Point] | None:
    """Return the possible centres of a jaw's first peg, in the part's frame, at which all pegs of the jaw
    touch.

    Returns None if the centre may be anywhere along a path, and [] if there is no such centre.
    """
    one = group[0]
    other = next((peg for peg in group[1:] if are_across(one, peg)), None)
    if other is None:
        return None if all(may_slide_with(one, peg) for peg in group[1:]) else []
    side, (x, y), spare = other.side, other.step, arb(0, other.loose)
    if isinstance(side, LineSide):
        points = find_points_on_line(
            one.side,
            one.radius,
            side.normal,
            side.level + other.radius + spare - compute_dot_product(side.normal, (x, y)),
        )
    else:
        center = side.center[0] - x, side.center[1] - y
        points = find_points_on_circle(
            one.side, one.radius, center, side.compute_offset_radius(other.radius) + spare
        )
    return [point for point in points if all(may_touch(peg, point) for peg in group)]


def are_across(one: TouchingPeg, other: TouchingPeg) -> bool:
    """Return whether the paths of two pegs' centres certainly do not run alongside each other.

    False where they may be parallel lines or concentric circles, or nearly so.
    """
    a, b = one.side, other.side
    if isinstance(a, LineSide) and isinstance(b, LineSide):
        return bool(abs(cross(a.tangent, b.tangent)) > PARALLEL)
    if isinstance(a, ArcSide) and isinstance(b, ArcSide):
        x, y = b.center[0] - other.step[0] - a.center[0], b.center[1] - other.step[1] - a.center[1]
        return bool(compute_norm((x, y)) > one.loose)
    return True


def may_slide_with(one: TouchingPeg, other: TouchingPeg) -> bool:
    """Return whether two pegs may touch their sides at the same time; their paths are
    parallel or concentric.
    """
    a, b = one.side, other.side
    if isinstance(a, ArcSide):
        return (
            not abs(a.compute_offset_radius(one.radius) - b.compute_offset_radius(other.radius)) > one.loose
            if isinstance(b, ArcSide)
            else True
        )
    off = one.radius
    point = a.start[0] + off * a.normal[0] + other.step[0], a.start[1] + off * a.normal[1] + other.step[1]
    return not abs(b.compute_gap(point) - other.radius) > one.loose + PARALLEL * (
        a.length + compute_norm(other.step)
    )


def may_touch(peg: TouchingPeg, first: Point) -> bool:
    """Return whether a peg may touch its side between the side's ends, with
    the first peg of its jaw at ``first``.
    """
    side, point = peg.side, (first[0] + peg.step[0], first[1] + peg.step[1])
    if isinstance(side, ArcSide) and not side.compute_offset_radius(peg.radius) > 0:
        return False
    if abs(side.compute_gap(point) - peg.radius) > peg.loose:
        return False
    return not any(slack < -peg.loose for slack in side.compute_slacks(point, peg.radius))


def find_places_on_row(moved: TouchingPeg, tail: Point, up: arb, turn: Point) -> list[Point] | None:
    """Return the possible centres, in the part's frame, of a peg whose row is ``up`` mm above the row of the
    peg at ``tail``.

    ``turn`` is (cosine, sine) of the orientation. Returns None if the peg's side runs along the row.
    """
    side, across = moved.side, turn_vector((arb(0), arb(1)), turn[0], -turn[1])
    if isinstance(side, LineSide):
        slope = compute_dot_product(across, side.tangent)
        if not (slope > 0 or slope < 0):
            return None
    peg = evolve(moved, step=(arb(0), arb(0)))
    points = find_points_on_line(
        side, moved.radius, across, compute_dot_product(across, tail) + up + arb(0, moved.loose)
    )
    return [point for point in points if may_touch(peg, point)]
