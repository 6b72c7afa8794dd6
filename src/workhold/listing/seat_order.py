r"""The order in which seats are examined when only the best are asked for, and when the search may stop.

Contacts of three locators and one clamp are grouped by seat before they are proven. The locators alone bound
the rank of a fixture, whatever its two clamps are:

- location error and tilt are the seat's alone, the same for all its clamps;
- the least distance to an end or an edge, and the smallest face, are taken over five contacts, so they are no
  larger than the same figures over the three locators. At least as many contacts as locators are near an
  edge;
- points and warnings grow with location error, contacts near an edge, tilt, a strong peg and a small face.
  Without the clamps' share they can only be fewer;
- the closure margin is at most 1/5, for five shares sum to 1, and clamp freedom at most 90 degrees; forces
  are above zero.

Rounding to digits never reverses the order of two numbers. So key by key the bound is no worse than the
fixture's own key, and so it is in lexicographic order. Seats are examined in the order of their bounds. The
search may stop once as many fixtures are kept as are asked for, and the next bound is worse than the last of
them. Then no further seat has a listed fixture. Seats with equal bounds are examined, since equal fixtures
are listed in the order of holes.

Bounds by pairs of clamps (``listing.bounds``) take longer. So they are computed only for the groups that come
next, and for groups that are as good as these by all figures before the first figure that pairs bound.

Seats are examined whole, with all contacts that may belong to them. A group has the same holes and nearly the
same orientation. Contacts whose orientation is not well known are grouped with all others of the same holes.
So a group contains every seat that it touches, and is examined independently of others. Each place of the
part in a group is bounded by itself, and the best bound counts. A group with a contact whose place is not
well known has no bound. If that is because the locators' lines of force are parallel or meet in a point, they
hold nothing (``proof.degenerate``); such contacts are a group of their own, after all others.
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
from workhold.kernels.contact.quality import LOAD_LENGTH, write_figures
from workhold.kernels.contact.seats import write_seat_numbers
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
from workhold.proof.degenerate import cannot_hold
from workhold.statics.contact_matrix import (
    TouchableFeatures,
    compute_outward_normals,
    compute_wrenches,
    invert_locator_matrices,
)
from workhold.statics.effective_error import EffectiveErrors, classify_angles, measure_end_distances
from workhold.statics.judging import JudgingLimits, is_astray, is_near_edge, is_strong
from workhold.statics.quality import (
    compute_tilts,
    find_main_direction,
    find_silhouette_extremes,
    measure_faces,
)

__all__ = ["make_ordered_groups"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Radians. Contacts with a larger error of orientation are grouped with all others of the same holes, without
# bounds; so are those within AT_START of START.
WELL_KNOWN, AT_START = 1e-7, 1e-5
# Radians. Orientations are counted from here, an angle that parts have only by chance.
START = 0.123456789
# Radians and mm. Places or orientations that surely differ by more are two seats.
APART = 4e-8
# Mask of the bits of a number that hold the holes' hash, and steps of orientation per radian in the other
# bits. A step is less than half of ``SAME_POSE``.
HOLES = -1 << 24
STEPS = ((1 << 24) - 1) / tau
# Errors of figures: relative, and of angles in degrees.
SHARE, ANGLE = 1e-6, 1e-4
# Bounds with a larger relative error are not used.
MOST_SHARE = 0.01
# Larger than the number of any contact.
NO_CONTACT = np.iinfo(np.int64).max
# Number of iterations that sharpen the bound of a place.
ROUNDS = 3


def make_ordered_groups(
    records: Sequence[PackedContacts], problems: Sequence[Problem], query: Query
) -> SeatGroups:
    """Return the contacts of all directions of the clamp in groups of seats, with bounds of their rank.

    Parameters
    ----------
    records, problems : contacts and problem of each direction of the clamp.
    """
    numbers = [
        number_seats(some, problem)
        for part, problem in zip(records, problems, strict=True)
        for some in part.iterate_parts()
    ]
    holes, theta, turn, place, off, holds = (np.concatenate(parts) for parts in zip(*numbers, strict=True))
    del numbers
    holes &= HOLES
    unsure = holds & (~(turn <= WELL_KNOWN) | (theta < AT_START) | (theta > tau - AT_START))
    loose = mask_members(holes, np.unique(holes[unsure]))
    theta[loose] = 0.0
    # The steps of orientation are in the bits that the holes' hash leaves free.
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
    bounds = bound_groups(order, group, known, records, problems, query)
    unknown = loose | ~(off <= SAME_PLACE)
    bounds = bounds.drop_bounds_where(np.logical_or.reduceat(unknown[order], starts))
    groups, alike = SeatGroups(order, starts, bounds), find_first_clamp_figure(query)
    groups = groups.append_group(np.flatnonzero(~holds))
    if alike is None:
        return groups

    def sharpen_bounds(order: IntArray, starts: IntArray) -> OrderKeys:
        """Return bounds of some groups that also take account of the pairs of their clamps.

        ``order`` and ``starts`` are as in :class:`SeatGroups`.
        """
        group = np.cumsum(np.bincount(starts, minlength=len(order))) - 1
        return bound_groups(order, group, known, records, problems, query, by_pairs=True)

    # The first key number is whether a fixture is unfit.
    return evolve(groups, sharpened=sharpen_bounds, alike=alike + 1)


def bound_groups(
    order: IntArray,
    group: IntArray,
    known: tuple[tuple[Array, Array], tuple[Array, Array]],
    records: Sequence[PackedContacts],
    problems: Sequence[Problem],
    query: Query,
    by_pairs: bool = False,
) -> OrderKeys:
    """Return lower bounds of the ranking keys of the fixtures in each
    of G groups; the best of its seats counts.

    Parameters
    ----------
    order : (M,) indices of contacts, group by group, and within a group by place.
    group : (M,) group number of each contact in ``order``, ascending from 0.
    known : (orientations, their error bounds) in radians, and (places, their error bounds) in mm, of all
        contacts.
    by_pairs : whether pairs of clamps are to sharpen the bounds.
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
        # The contacts may be of two seats, so the bound of one does not hold for all.
        bounds = bounds.drop_bounds_where(high - low > APART)
    return bounds.find_least_of_groups(group[starts])


def find_best_known(order: IntArray, off: Array, starts: IntArray) -> IntArray:
    """Return, for each of G slices of ``order`` (M,), the index in it whose place is known best.

    Slice g begins at ``starts[g]``. ``off`` (M,) are the error bounds of the places; of equal ones the lowest
    index is taken.
    """
    least = np.repeat(np.minimum.reduceat(off, starts), np.diff(starts, append=len(off)))
    return np.asarray(np.minimum.reduceat(np.where(off <= least, order, NO_CONTACT), starts))


def mask_members(numbers: IntArray, few: IntArray) -> BoolArray:
    """Return a mask (N,): True for numbers that occur in ``few`` (F,), which is ascending."""
    if len(few) == 0:
        return np.zeros(len(numbers), np.bool_)
    return np.asarray(few[np.minimum(np.searchsorted(few, numbers), len(few) - 1)] == numbers)


def number_seats(records: Array, problem: Problem) -> tuple[IntArray, Array, Array, Array, Array, BoolArray]:
    """Return six arrays (N,) that identify the seat of each contact (N, 19), regardless of the direction of
    its clamp.

    Returns
    -------
    holes : a hash of the locators' holes, the same wherever they are on the plate.
    theta : orientation in radians, counted from ``START``.
    turn : error bound of ``theta`` in radians.
    place : a number in mm that identifies the place of the part relative to the holes.
    off : error bound of ``place`` in mm.
    holds : whether the locators may hold the part.
    """
    frame, count = problem.frame, len(records)
    holes, theta, place = np.empty(count, np.int64), np.empty(count), np.empty(count)
    quarters = np.array([*QUARTERS[frame.quarters], frame.quarters * (pi / 2)], np.float64)
    pitch = np.array(problem.toolkit.carriers[0].pitch, np.float64)
    write_seat_numbers(records, quarters, pitch, START, holes, theta, place)
    turn = np.where(records[:, record.STANDING] < 0, inf, records[:, record.REACH])
    off, holds = bound_places_off(records, problem), np.ones(count, np.bool_)
    vague = np.flatnonzero(~(off <= SAME_PLACE))
    if len(vague):
        holds[vague] = ~cannot_hold(records[vague], problem)
    return holes, theta, turn, place, off, holds


def bound_places_off(records: Array, problem: Problem) -> Array:
    """Return error bounds of the locators' centres in contacts (N, 19), in mm, (N,); inf where not known.

    A record has one bound for all its pegs, which is poor if the clamp grazes an arc; but the locators alone
    fix the part. If the centres are within r of their true places, each is off the tangent by at most r^2
    (1/R + 1/L) plus its residual; R is the arc's radius, L the length that moments are divided by. So the
    part is off by this times the inverse of the locators' wrenches, which is a smaller r.
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
        compute_wrenches(point, compute_outward_normals(rows, point), problem.wrench_length)
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
    """Return lower bounds of the ranking keys of fixtures with the three locators of each record, N rows.

    A contact at a joint may be listed on either of two faces; the better one counts. ``records`` is (N, 19).

    Parameters
    ----------
    off : (N,) error bounds of the locators' centres, in mm.
    pairs : (N, 3) bounds by the pairs of clamps, see ``listing.bounds.bound_pairs``; None where not known.
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
    """Return the orientations of the part on the plate in radians, (N,), from records (N, 19)."""
    return np.asarray(problem.frame.quarters * (pi / 2) - records[:, record.PSI])


def bound_error_factors(records: Array, off: Array, problem: Problem, query: Query) -> Array:
    """Return lower bounds of the factors on the location error, (N,),
    of fixtures with the locators of each record.

    Clamps and an overhanging part can only make the factors larger. ``off`` (N,) are error bounds of the
    locators' centres in mm.
    """
    effective, c = EffectiveErrors.from_query(query), make_candidates(records, problem)
    faces = problem.faces[c.feature[:, :LOCATORS]].astype(np.int64)
    angle = classify_angles(compute_seen_angles(records, problem), ANGLE)
    points = c.point[:, :LOCATORS] + np.asarray(problem.workpiece.center)
    place = 4.0 * SAME_PLACE + 16.0 * off
    near = (
        measure_end_distances(points, effective.lines[faces])
        < query.toolkit.carriers[0].peg_radius - place[:, None]
    )
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
    """Return figures of quality (N, F) at least as good as those of
    any fixture with the locators of each record.

    The location error is NaN if no bound is known. ``off`` and ``pairs`` are as in :func:`bound_keys`.
    """
    touched = TouchableFeatures.from_workpiece(
        problem.workpiece, problem.toolkit, problem.loci, problem.wrench_length
    )
    c = make_candidates(records, problem)
    faces = problem.faces[c.feature[:, :LOCATORS]].astype(np.int64)
    found = touched.compute_locators(np.ascontiguousarray(c.point[:, :LOCATORS]), faces)
    out = np.empty((len(records), len(FIGURES)))
    # The kernel takes at least four contacts; the fourth repeats the first but moves nothing and shares no
    # face.
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
        *find_silhouette_extremes(problem.workpiece),
        np.zeros((0, LOAD_LENGTH)),
        out,
        np.empty((10, 3)),
    )
    points, normals, to_ends, to_edges = four
    write_figures(points, normals, to_ends, to_edges, inverses, alone, *rest)
    ends, edges = found.ends, found.edges
    norm = np.abs(inverses[:, :LOCATORS, :LOCATORS]).sum(axis=2).max(axis=1, initial=0.0)
    # Error bounds of places, and the relative error of the inverse that they cause, to first order,
    # generously.
    rows = problem.rows[c.feature[:, :LOCATORS]]
    curved = (1.0 / np.where(rows[..., IS_ARC] != 0.0, rows[..., RADIUS], inf)).max(axis=1, initial=0.0)
    place = 4.0 * SAME_PLACE + 16.0 * off
    # Near a joint a contact may be off the next feature by its distance from the joint.
    nearest = np.abs(ends).min(axis=1, initial=inf)
    place = place + np.where(nearest <= NEAR_END, nearest, 0.0)
    share = SHARE + 8.0 * norm * place * (1.0 / touched.length + curved)
    known = (share < MOST_SHARE) & (place < 2.0 * NEAR_END)
    error = out[:, LOCATION_ERROR] * (1.0 - share)
    end, edge = (np.min(values, axis=1, initial=inf) + place for values in (ends, edges))
    out = make_best_possible_figures(len(records), query)
    out[:, END_DISTANCE], out[:, EDGE_DISTANCE] = end, np.minimum(edge, touched.length)
    tilt = compute_tilts(compute_seen_angles(records, problem), find_main_direction(problem.workpiece))
    out[:, TILT] = np.where(tilt < SQUARE_TILT + ANGLE, 0.0, tilt - ANGLE)
    out[:, SMALLEST_FACE] = measure_faces(problem.workpiece).take(faces).min(axis=1, initial=inf)
    out[:, LOCATION_ERROR] = np.where(known, error, np.nan)
    if pairs is not None:
        for number, column in BOUNDED.items():
            out[:, number] = pairs[:, column]
    judging = JudgingLimits.from_toolkit(touched.length, query.toolkit, query.tolerance)
    near = is_near_edge(edges + place[:, None]).sum(axis=1)
    out[:, WARNINGS] = near + is_astray(error, judging.off) + is_strong(out[:, CLAMP_AMPLIFICATION])
    out[:, PENALTY] = judging.compute_penalty(out)
    return out
