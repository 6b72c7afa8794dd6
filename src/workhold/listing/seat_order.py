r"""The order in which seats are looked at when only the best are asked for, and where the search may stop.

Contacts of three locators and one clamp are grouped by seat before they are proven. What the locators alone
say of a fixture bounds its rank from above, whatever its two clamps are:

- location error and tilt are the seat's alone, the same for all its clamps;
- the least distance to an end or an edge, and the smallest face, are those of five contacts, so no larger
  than those of three. Warnings of contacts near an edge are at least those of the locators;
- points and warnings grow with location error, contacts near an edge, tilt, a strong peg and a small face.
  Without the clamps' share they can only be fewer;
- the closure margin is at most 1/5, for five shares sum to 1, and clamp freedom at most 90 degrees; forces
  are above zero.

Rounding to digits never turns two numbers round. So key by key the bound is no worse than the fixture's own
key, and so is the whole in lexicographic order. Seats are looked at in the order of their bounds. The search
may stop once as many fixtures are kept as are asked for, and the next bound is worse than the last of them.
Then no further seat holds one that is listed. Seats of equal bounds are looked at, for what ranks alike is
listed in the order of holes.

What pairs of clamps bound (``listing.bounds``) takes longer. So it is asked only of groups that are next
to be looked at, or as good as these by all figures before the first of those.

Seats are taken whole, with all contacts that may be theirs. A group is one of holes and orientation. Contacts
whose orientation is not well known are put together with all others of the same holes. So a group holds every
seat that it touches, and what is found at it does not depend on the others. Each place in a group is bounded
by itself, and the best counts. A group with a contact whose place is not well known has no bound. Where that
is because locators touch along one line or pass one point, they hold nothing (``proof.degenerate``). Such
contacts stand by themselves, after all others.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from math import inf, pi, tau

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from workhold.contact.problem import QUARTERS, ROUNDINGS, Problem
from workhold.conventions import SAME_PLACE, SAME_POSE, SQUARE_TILT
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, X, Y
from workhold.kernels.contact import record
from workhold.kernels.contact.quality import LOAD_LENGTH, figures
from workhold.kernels.contact.seats import numbers_of_seats
from workhold.listing.bounds import BOUNDED, bound_pairs, find_first_clamp_figure
from workhold.listing.canonical_form import NEAR_END, assign_contacts_to_faces, make_candidates
from workhold.listing.contact_groups import PackedContacts, SeatGroups
from workhold.listing.ranking import OrderKeys, make_best_possible_figures, make_order_keys
from workhold.model.clamps import LOCATORS
from workhold.model.first_choice import FACTORS
from workhold.model.quality import (
    CLAMP_AMPLIFICATION,
    EDGE_DISTANCE,
    END_DISTANCE,
    FIGURES,
    LOCATION_ERROR,
    PENALTY,
    SMALLEST_FACE,
    TILT,
    WARNINGS,
)
from workhold.model.query import Query
from workhold.proof.degenerate import hold_nothing
from workhold.statics.contact_matrix import (
    Touched,
    compute_outward_normals,
    invert_locator_matrices,
    wrenches,
)
from workhold.statics.effective_error import EffectiveErrors, classify_angles, to_ends
from workhold.statics.judging import Judging, is_astray, is_near_edge, is_strong
from workhold.statics.quality import extremes, main_direction, measure_faces, tilts

__all__ = ["make_ordered_groups"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Radians. Contacts whose orientation is known less well are put together with all others of the same holes,
# and bound nothing; so are those that are this near to where orientations are counted from.
WELL_KNOWN, AT_START = 1e-7, 1e-5
# Radians. Orientations are counted from here, which is no angle that parts have for a reason.
START = 0.123456789
# Radians and mm. What is surely farther apart is two seats.
APART = 4e-8
# Bits of a number that are those of holes, and steps of orientation to a radian that the others count. A step
# is less than half of ``SAME_POSE``.
HOLES = -1 << 24
STEPS = ((1 << 24) - 1) / tau
# What figures may be off by: as parts of one, and in degrees.
SHARE, ANGLE = 1e-6, 1e-4
# Bounds that are off by more than this part of one are none.
MOST_SHARE = 0.01
# Larger than the number of any contact.
NO_CONTACT = np.iinfo(np.int64).max
# How often places of locators are found from what they were before.
ROUNDS = 3


def make_ordered_groups(
    records: Sequence[PackedContacts], problems: Sequence[Problem], query: Query
) -> SeatGroups:
    """Return the groups of the contacts of each direction.

    Parameters
    ----------
    records : of each direction.
    problems : the search of each direction.
    """
    numbers = [
        seat_numbers(some, problem)
        for part, problem in zip(records, problems, strict=True)
        for some in part.iterate_parts()
    ]
    holes, theta, turn, place, off, holds = (np.concatenate(parts) for parts in zip(*numbers, strict=True))
    del numbers
    holes &= HOLES
    unsure = holds & (~(turn <= WELL_KNOWN) | (theta < AT_START) | (theta > tau - AT_START))
    loose = is_among(holes, np.unique(holes[unsure]))
    theta[loose] = 0.0
    # Numbers of whole steps of orientation stand in the bits that those of holes leave.
    order = np.argsort(holes | (theta * STEPS).astype(np.int64))
    order = order[holds[order]]
    fresh = np.ones(len(order), np.bool_)
    fresh[1:] = (np.diff(holes[order]) != 0) | (np.diff(theta[order]) > 4 * SAME_POSE)
    starts, group = np.flatnonzero(fresh), np.cumsum(fresh) - 1
    by_place = place[order]
    several = np.maximum.reduceat(by_place, starts) - np.minimum.reduceat(by_place, starts) > SAME_PLACE
    mixed = np.flatnonzero(several[group])
    order[mixed] = order[mixed[np.lexsort([by_place[mixed], group[mixed]])]]
    del by_place
    known = (theta, turn), (place, off)
    bounds = group_bounds(order, group, known, records, problems, query)
    unknown = loose | ~(off <= SAME_PLACE)
    bounds = bounds.drop_bounds_where(np.logical_or.reduceat(unknown[order], starts))
    groups, alike = SeatGroups(order, starts, bounds), find_first_clamp_figure(query)
    groups = groups.append_group(np.flatnonzero(~holds))
    if alike is None:
        return groups

    def sharpened(order: IntArray, starts: IntArray) -> OrderKeys:
        group = np.cumsum(np.bincount(starts, minlength=len(order))) - 1
        return group_bounds(order, group, known, records, problems, query, by_pairs=True)

    # The first number is of what is fit for a workshop.
    return evolve(groups, sharpened=sharpened, alike=alike + 1)


def group_bounds(
    order: IntArray,
    group: IntArray,
    known: tuple[tuple[Array, Array], tuple[Array, Array]],
    records: Sequence[PackedContacts],
    problems: Sequence[Problem],
    query: Query,
    by_pairs: bool = False,
) -> OrderKeys:
    """Return the keys of G groups that no fixture in one has less than, the least of those of the places in
    it.

    Numbers of contacts (M,) come group by group, and in each by place, with those of the groups. ``known``
    are orientations and places (M,), each with how far they may be off. ``by_pairs`` says whether pairs of
    clamps are to bound them, too.
    """
    place, off = (values[order] for values in known[1])
    fresh = np.ones(len(order), np.bool_)
    fresh[1:] = (np.diff(group) > 0) | (np.diff(place) > SAME_PLACE)
    starts = np.flatnonzero(fresh)
    first = find_best_known(order, off, starts)
    edges = np.cumsum([0, *map(len, records)])
    direction = np.searchsorted(edges, first, side="right") - 1
    parts, places = list[OrderKeys](), list[IntArray]()
    pairs = bound_pairs(order, starts, records, problems, query) if by_pairs else None
    for number, (part, problem) in enumerate(zip(records, problems, strict=True)):
        chosen = np.flatnonzero(direction == number)
        known_within = known[1][1][first[chosen]]
        some, of_pairs = part.take(first[chosen] - edges[number]), None if pairs is None else pairs[chosen]
        parts.append(bound_keys(some, known_within, problem, query, of_pairs))
        places.append(chosen)
    bounds = reduce(OrderKeys.concatenate, parts).take(np.argsort(np.concatenate(places), kind="stable"))
    for values, doubts in known:
        middle, radius = values[order], 2.0 * doubts[order]
        low, high = np.minimum.reduceat(middle + radius, starts), np.maximum.reduceat(middle - radius, starts)
        # One contact cannot stand for two seats.
        bounds = bounds.drop_bounds_where(high - low > APART)
    return bounds.find_least_of_groups(group[starts])


def find_best_known(order: IntArray, off: Array, starts: IntArray) -> IntArray:
    """Return the lowest of numbers (M,) in an order that are off the least, of each place (G,)."""
    least = np.repeat(np.minimum.reduceat(off, starts), np.diff(starts, append=len(off)))
    return np.asarray(np.minimum.reduceat(np.where(off <= least, order, NO_CONTACT), starts))


def is_among(numbers: IntArray, few: IntArray) -> BoolArray:
    """Return which numbers (N,) are among a few (F,) in ascending order."""
    if len(few) == 0:
        return np.zeros(len(numbers), np.bool_)
    return np.asarray(few[np.minimum(np.searchsorted(few, numbers), len(few) - 1)] == numbers)


def seat_numbers(records: Array, problem: Problem) -> tuple[IntArray, Array, Array, Array, Array, BoolArray]:
    """Return what distinguishes the seats of contacts (N, 19), whatever the direction of the clamp.

    Returns
    -------
    Six arrays (N,). The first is a number for the holes of locators, the same wherever they are on the
    plate. Then come orientations from ``START`` on, and how far they may be off. Then a number for the place
    of the part beside the holes in mm, and how far that may be off. The last says whether locators may hold.
    """
    frame, count = problem.frame, len(records)
    holes, theta, place = np.empty(count, np.int64), np.empty(count), np.empty(count)
    quarters = np.array([*QUARTERS[frame.quarters], frame.quarters * (pi / 2)], np.float64)
    pitch = np.array(problem.toolkit.carriers[0].pitch, np.float64)
    numbers_of_seats(records, quarters, pitch, START, holes, theta, place)
    turn = np.where(records[:, record.STANDING] < 0, inf, records[:, record.REACH])
    off, holds = bound_places_off(records, problem), np.ones(count, np.bool_)
    vague = np.flatnonzero(~(off <= SAME_PLACE))
    if len(vague):
        holds[vague] = ~hold_nothing(records[vague], problem)
    return holes, theta, turn, place, off, holds


def bound_places_off(records: Array, problem: Problem) -> Array:
    """Return how far (N,) centres of locators may be off in mm, in contacts (N, 19) that know it of all pegs
    alike.

    Where a clamp grazes an arc, it is known badly, but the locators fix the part. Say their centres are
    within r of where they belong. Then each is off the tangent there by no more than r^2 (1/R + 1/L) and its
    rest. So the part is off by no more than that times the inverse of the locators' wrenches, a smaller r.
    """
    turn = np.where(records[:, record.STANDING] < 0, inf, records[:, record.REACH] * problem.wrench_length)
    off = np.asarray(records[:, record.LARGEST_RADIUS] + turn)
    vague = np.flatnonzero((off > SAME_PLACE) & (off < inf))
    c = make_candidates(records[vague], problem)
    rows, point = problem.rows[c.feature[:, :LOCATORS]], c.point[:, :LOCATORS]
    radius = np.where(rows[..., IS_ARC] != 0.0, rows[..., RADIUS], inf)
    across, along = point[..., 0] - rows[..., X], point[..., 1] - rows[..., Y]
    straight = across * rows[..., AXIS_Y] - along * rows[..., AXIS_X]
    rests = np.where(radius < inf, np.hypot(across, along) - rows[..., RADIUS], straight)
    rounding = ROUNDINGS * (np.abs(rows[..., [X, Y, RADIUS]]).max(axis=-1) + problem.wrench_length)
    rest = (np.abs(rests) + rounding).max(axis=1, initial=0.0)
    bent = 1.0 / radius.min(axis=1, initial=inf) + 1.0 / problem.wrench_length
    inverse = invert_locator_matrices(
        wrenches(point, compute_outward_normals(rows, point), problem.wrench_length)
    )
    # A movement in mm and mm turned over L moves no centre by four times its largest entry.
    most = 4.0 * np.abs(inverse).sum(axis=2).max(axis=1, initial=0.0)
    within = off[vague]
    for _ in range(ROUNDS):
        within = np.fmin(within, most * (rest + within * within * bent))
    off[vague] = np.minimum(off[vague], within + turn[vague])
    return off


def bound_keys(
    records: Array, off: Array, problem: Problem, query: Query, pairs: Array | None = None
) -> OrderKeys:
    """Return the keys that no fixture has less than whose locators touch as those of records (N, 19) do.

    A contact at a joint may be listed on either face; what is less counts. Places may be ``off`` by so many mm
    (N,); ``pairs`` (N, 3) are bounds of the pairs of clamps, None where they are not known.
    """
    number, records = assign_contacts_to_faces(records, problem, LOCATORS)
    off, pairs = off[number], None if pairs is None else pairs[number]
    quality = bound_figures(records, off, problem, query, pairs)
    theta = compute_seen_angles(records, problem)
    error = (
        quality[:, LOCATION_ERROR] * bound_error_factors(records, off, problem, query)
        if query.has_house_order
        else None
    )
    keys = make_order_keys(quality, query, error, classify_angles(theta, ANGLE))
    return keys.drop_bounds_where(np.isnan(quality[:, LOCATION_ERROR])).find_least_of_groups(number)


def compute_seen_angles(records: Array, problem: Problem) -> Array:
    """Return the orientations (N,) of the part on the plate in radians."""
    return np.asarray(problem.frame.quarters * (pi / 2) - records[:, record.PSI])


def bound_error_factors(records: Array, off: Array, problem: Problem, query: Query) -> Array:
    """Return the factors (N,) of the location error that are no larger than those of a fixture with these
    locators.

    What the clamps do, and whether the part hangs over, can only make them larger.
    """
    effective, c = EffectiveErrors.of(query), make_candidates(records, problem)
    faces = problem.faces[c.feature[:, :LOCATORS]].astype(np.int64)
    angle = classify_angles(compute_seen_angles(records, problem), ANGLE)
    points = c.point[:, :LOCATORS] + np.asarray(problem.workpiece.center)
    place = 4.0 * SAME_PLACE + 16.0 * off
    near = to_ends(points, effective.lines[faces]) < query.toolkit.carriers[0].peg_radius - place[:, None]
    held = {
        "quarter_turn": angle == 1,
        "other_angle": angle == 2,
        "face_end": near.any(axis=1),
        "dowel_in_bore": effective.unasked[faces].any(axis=1),
    }
    times = [np.where(held[one.key], one.times, 1.0) for one in FACTORS if one.key in held]
    return np.asarray(np.prod(times, axis=0))


def bound_figures(
    records: Array, off: Array, problem: Problem, query: Query, pairs: Array | None = None
) -> Array:
    """Return figures of quality (N, F) that no fixture with these locators exceeds.

    NaN stands where nothing is known.
    """
    touched = Touched.of(problem.workpiece, problem.toolkit, problem.loci, problem.wrench_length)
    c = make_candidates(records, problem)
    faces = problem.faces[c.feature[:, :LOCATORS]].astype(np.int64)
    found = touched.locators(np.ascontiguousarray(c.point[:, :LOCATORS]), faces)
    out = np.empty((len(records), len(FIGURES)))
    # The kernel takes four contacts or more. The last has no say, and no other touches its face.
    four = [
        np.ascontiguousarray(values[:, [0, 1, 2, 0]])
        for values in (found.points, found.normals, found.ends, found.edges)
    ]
    inverses, alone = np.zeros((len(records), 4, 4)), np.full((len(records), 4), -1)
    inverses[:, :, :LOCATORS], inverses[:, LOCATORS], alone[:, :LOCATORS] = found.inverses, 1.0, faces
    tolerances = np.array([query.tolerance.peg, query.tolerance.face])
    rest = (
        touched.length,
        tolerances,
        *extremes(problem.workpiece),
        np.zeros((0, LOAD_LENGTH)),
        out,
        np.empty((10, 3)),
    )
    points, normals, to_ends, to_edges = four
    figures(points, normals, to_ends, to_edges, inverses, alone, *rest)
    ends, edges = found.ends, found.edges
    norm = np.abs(inverses[:, :LOCATORS, :LOCATORS]).sum(axis=2).max(axis=1, initial=0.0)
    # How far places may be off, and what that does to the inverse, to first order and generously.
    rows = problem.rows[c.feature[:, :LOCATORS]]
    curved = (1.0 / np.where(rows[..., IS_ARC] != 0.0, rows[..., RADIUS], inf)).max(axis=1, initial=0.0)
    place = 4.0 * SAME_PLACE + 16.0 * off
    # Beside a joint it may be off the feature that goes on there by as much as it is from it.
    nearest = np.abs(ends).min(axis=1, initial=inf)
    place = place + np.where(nearest <= NEAR_END, nearest, 0.0)
    share = SHARE + 8.0 * norm * place * (1.0 / touched.length + curved)
    known = (share < MOST_SHARE) & (place < 2.0 * NEAR_END)
    error = out[:, LOCATION_ERROR] * (1.0 - share)
    end, edge = (np.min(values, axis=1, initial=inf) + place for values in (ends, edges))
    out = make_best_possible_figures(len(records), query)
    out[:, END_DISTANCE], out[:, EDGE_DISTANCE] = end, np.minimum(edge, touched.length)
    tilt = tilts(compute_seen_angles(records, problem), main_direction(problem.workpiece))
    out[:, TILT] = np.where(tilt < SQUARE_TILT + ANGLE, 0.0, tilt - ANGLE)
    out[:, SMALLEST_FACE] = measure_faces(problem.workpiece).take(faces).min(axis=1, initial=inf)
    out[:, LOCATION_ERROR] = np.where(known, error, np.nan)
    if pairs is not None:
        for number, column in BOUNDED.items():
            out[:, number] = pairs[:, column]
    judging = Judging.of(touched.length, query.toolkit, query.tolerance)
    near = is_near_edge(edges + place[:, None]).sum(axis=1)
    out[:, WARNINGS] = near + is_astray(error, judging.off) + is_strong(out[:, CLAMP_AMPLIFICATION])
    out[:, PENALTY] = judging.penalty(out)
    return out
