"""Bounds of the location error: of contacts in place, and of all contacts on short stretches of features.

The location error is the largest movement of a point of the silhouette when all pegs and faces are off by
their tolerances. Here the movement is taken of a few points and along a few directions only, the probes. So
it comes out too small, never too large. The *effective* error is the location error times the largest of 1
and ``Precision.doubts`` of the features touched. A *spot* is a short stretch of a feature (columns SPOT_...
below), a *seat* the contacts of three locators that fix the pose. The movement of a probe is a sum over
contacts, each with its error. Signs of errors are free, so the largest sum is that of the sizes:

    sum of peg |a_i| + sum over faces of face |sum of a_i at the face|.

Here a_i is the movement along a probe for an error of 1 of contact i.

Stretches: let a seat have contacts u and a location error of no more than e. Then no point of the silhouette
moves by more than e. So the part turns by no more than 2 e / d, where d is the largest distance of two of
them. Let contacts u' be the middles of stretches that hold u. What a contact measures of a movement changes
from u to u'. On a line it changes by no more than the half length times the turn, and on an arc by the half
sweep times the movement of the centre. So the same movement belongs to errors of u' that are off by no more
than g_i e. Let z be the largest movement of a probe at u' for the tolerances, and h that for errors of sizes
g_i. Then z is at most e (1 + h), and e >= z / (1 + h) is the bound, the largest of all probes. It holds as
well where contacts in the middles fix no pose: all is multiplied by the determinant.

Two pegs on each of two carriers: what a moving peg measures lacks its part of the travel, n . x times the
travel. From u to u' that part changes by no more than the turn s of its normal and the turn h of the pegs,
times the travel. The travel is no more than 2 e over the larger n . x of both moving pegs: each says what
the part moves there, which is no more than e, and is off by no more than peg + face. That is no more than e
either, because such an error of a standing peg moves the part by as much. So g_i is larger there by
2 (s + h) over the larger n . x.
"""

from __future__ import annotations

from math import floor

import numpy as np

from workhold.kernels.base.compiling import (
    Array,
    ByteArray,
    IntMatrix,
    IntVector,
    Matrix,
    compiled,
    inner,
)
from workhold.kernels.base.feature import IS_ARC, RADIUS
from workhold.kernels.base.interval import TURN
from workhold.kernels.base.tables import NearSpots, Precision
from workhold.kernels.contact.record import Angle
from workhold.kernels.contact.rules import compute_outward_normal

# Parts of three spots wait in no more rows than this: each level adds seven, and has half as large spots.
MOST_WAITING = 512
# Columns of a spot, a stretch of a feature: the normal at its middle (2), its moment about the centre over L,
# the error that contacts in it may have for a location error of 1, its feature, the index of the first of the
# spots that it consists of (its children), and their number. A finest spot has no children (0); its column
# SPOT_FIRST is its own number among the finest.
SPOT_NX, SPOT_NY, SPOT_MOMENT, SPOT_GIVE, SPOT_FEATURE, SPOT_FIRST, SPOT_COUNT = range(7)
SPOT_LENGTH = 7
# A contact in place has only the first five of these columns.
CONTACT_LENGTH = 5
# Errors this part beyond the limit are surely beyond it, whatever is rounded.
BEYOND = 1.001
# Error bound of movements, as a multiple of that of a minor: with three locators, and with two and two.
# Let normals turn by s and points move by r. The components of the cross product of two wrenches are then
# off by 5.7 s + 2 r / L, half of ``bound_minor_error``. A probe multiplies them by no more than 1.42 + 1.42
# together, and three contacts make 4.3 minors. A determinant is off by one. Of two and two, wrenches of sizes
# up to 2 are combined before.
WIDE_OF_THREE, WIDE_OF_FOUR = 4.5, 40.0
# Radians beside a quarter turn that count as such.
SQUARE = 1e-4


@inner
def cross_rows(one: Array, two: Array, out: Array) -> None:
    """Write the cross product ``one`` x ``two`` of two vectors of three to ``out`` (3,)."""
    out[0] = one[1] * two[2] - one[2] * two[1]
    out[1] = one[2] * two[0] - one[0] * two[2]
    out[2] = one[0] * two[1] - one[1] * two[0]


@inner
def probe_error(moves: Array, features: Array, count: int, precision: Precision, probe: int) -> float:
    """Return the largest movement in mm of one probe when pegs and faces are off by their tolerances, with
    any signs.

    A probe is a point of the silhouette with a direction; ``probe`` is its row in ``precision.probes``. See
    :func:`bound_error` for ``moves``, ``features`` and ``count``.
    """
    total, probes, faces = 0.0, precision.probes, precision.faces
    x, y, turn = probes[probe, 0], probes[probe, 1], probes[probe, 2]
    for i in range(count):
        along = moves[i, 0] * x + moves[i, 1] * y + moves[i, 2] * turn
        total += precision.peg * abs(along)
        face, first = faces[int(features[i])], True
        for j in range(i):
            first = first and faces[int(features[j])] != face
        if not first:
            continue
        for j in range(i + 1, count):
            if faces[int(features[j])] == face:
                along += moves[j, 0] * x + moves[j, 1] * y + moves[j, 2] * turn
        total += precision.face * abs(along)
    return total


@inner
def bound_error(moves: Array, features: Array, count: int, precision: Precision, enough: float) -> float:
    """Return a lower bound in mm of the location error: the largest movement of any probe in
    ``precision.probes``.

    The search for the largest ends at a movement above ``enough``.

    Parameters
    ----------
    moves : (C, 3) movement of the part (x, y, turn times L) per unit error of each contact. If all moves are
        multiplied by a number, so is the result.
    features : (C,) index of the feature that each contact touches.
    count : C.
    """
    most = 0.0
    for p in range(precision.probes.shape[0]):
        most = max(most, probe_error(moves, features, count, precision, p))
        if most > enough:
            break
    return most


@inner
def find_doubt(features: Array, count: int, precision: Precision) -> float:
    """Return the factor on the location error of contacts on the first ``count`` of ``features`` (C,), at
    least 1.

    It is the largest of ``precision.doubts`` of these features.
    """
    doubt = 1.0
    for i in range(count):
        doubt = max(doubt, precision.doubts[int(features[i])])
    return doubt


@inner
def find_most_allowed(low: float, high: float, precision: Precision) -> float:
    """Return the largest effective error in mm that is allowed at orientations from ``low`` to ``high`` in
    radians.

    Two cases: (a) the range holds, or nearly holds, a multiple of a quarter turn: ``precision.most``; (b)
    otherwise ``precision.most_aslant``.
    """
    quarter = TURN / 4.0
    if floor((high + SQUARE) / quarter) > floor((low - SQUARE) / quarter):
        return precision.most
    return precision.most_aslant


@inner
def is_beyond(
    moves: Array, features: Array, count: int, size: float, band: float, psi: float, precision: Precision
) -> bool:
    """Return whether contacts certainly have a larger effective error than is allowed.

    Parameters
    ----------
    moves : (C, 3) movement of the part per unit error of each contact, times ``size``, see
        :func:`bound_error`.
    features : (C,) index of the feature that each contact touches.
    count : C, 3 or 4.
    size : absolute determinant that ``moves`` are multiplied by.
    band : error bound of a minor, see ``contact.rules.bound_minor_error``.
    psi : orientation in radians.
    """
    most = BEYOND * find_most_allowed(psi, psi, precision) / find_doubt(features, count, precision)
    wide = band * (WIDE_OF_THREE if count == 3 else WIDE_OF_FOUR)
    enough = most * (size + wide) + wide * (precision.peg + precision.face)
    return bound_error(moves, features, count, precision, enough) > enough


@inner
def is_two_and_two_beyond(
    points: Array,
    normals: Array,
    features: Array,
    angle: Angle,
    length: float,
    band: float,
    still: int,
    precision: Precision,
    room: Array,
) -> bool:
    """Return whether two pegs on each of two carriers certainly have a larger effective error than is
    allowed.

    The moving carrier's travel is free, so its two pegs together constrain only one wrench, a combination
    without a component along the travel.

    Parameters
    ----------
    points, normals : (4, 2) of the contacts in the part's frame, the pegs of a carrier next to each other.
    features : (4,) index of the feature that each touches.
    angle : orientation with its cosine and sine.
    still : 0 where the first two pegs stand still, 2 where the last two do.
    length : L in mm, by which moments are divided.
    band : error bound of a minor.
    room : (8, 3) work space.
    """
    wrenches, moves = room[:4], room[4:]
    for k in range(4):
        wrenches[k, 0], wrenches[k, 1] = normals[k, 0], normals[k, 1]
        wrenches[k, 2] = (points[k, 0] * normals[k, 1] - points[k, 1] * normals[k, 0]) / length
    a, b, c, d = still, still + 1, 2 - still, 3 - still
    one = normals[c, 0] * angle.cosine + normals[c, 1] * angle.sine
    two = normals[d, 0] * angle.cosine + normals[d, 1] * angle.sine
    for n in range(3):
        wrenches[c, n] = two * wrenches[c, n] - one * wrenches[d, n]
    cross_rows(wrenches[b], wrenches[c], moves[a])
    cross_rows(wrenches[c], wrenches[a], moves[b])
    cross_rows(wrenches[a], wrenches[b], moves[c])
    size = abs(wrenches[a, 0] * moves[a, 0] + wrenches[a, 1] * moves[a, 1] + wrenches[a, 2] * moves[a, 2])
    for n in range(3):
        moves[d, n] = -one * moves[c, n]
        moves[c, n] = two * moves[c, n]
    return is_beyond(moves, features, 4, size, band, angle.psi, precision)


@inner
def write_spot(
    row: Array,
    feature: int,
    x: float,
    y: float,
    radius: float,
    precision: Precision,
    length: float,
    out: Array,
) -> None:
    """Write a contact at (x, y), known to ``radius`` mm, as a spot to the first five columns of ``out``.

    The contact is on the feature numbered ``feature``, whose row is ``row``; ``length`` is L in mm, by which
    moments are divided. SPOT_GIVE becomes how far the contact's own error may be, for a location error of 1,
    because of the radius. See ``base.feature`` for the layout of ``row``.
    """
    nx, ny = compute_outward_normal(row, x, y)
    out[SPOT_NX], out[SPOT_NY], out[SPOT_FEATURE] = nx, ny, feature
    out[SPOT_MOMENT] = (x * ny - y * nx) / length
    off = radius if row[IS_ARC] == 0.0 else bound_normal_swing(row, radius)
    out[SPOT_GIVE] = off * precision.gives[feature]


@inner
def bound_normal_swing(row: Array, radius: float) -> float:
    """Return by how many radians the normal of a contact known to ``radius`` mm may be off; 0 on a line.

    See ``base.feature`` for the layout of ``row``.
    """
    if row[IS_ARC] == 0.0:
        return 0.0
    # See ``curves.near_spots``.
    return 1.1 * radius / row[RADIUS] if radius <= 0.5 * row[RADIUS] else 2.0


@inner
def bound_least_error(
    first: Array, second: Array, third: Array, precision: Precision, room: Array, enough: float
) -> float:
    """Return a lower bound in mm of the effective error of every seat with contacts in three spots.

    ``first``, ``second`` and ``third`` are spot rows, ``room`` is (4, 3) work space. The search for a good
    bound ends at one above ``enough``. See the comment at SPOT_NX for the columns of a spot.
    """
    cross_rows(second, third, room[0])
    cross_rows(third, first, room[1])
    cross_rows(first, second, room[2])
    size = abs(first[0] * room[0, 0] + first[1] * room[0, 1] + first[2] * room[0, 2])
    room[3, 0], room[3, 1], room[3, 2] = first[SPOT_FEATURE], second[SPOT_FEATURE], third[SPOT_FEATURE]
    least, probes, doubt = 0.0, precision.probes, find_doubt(room[3], 3, precision)
    for p in range(probes.shape[0]):
        give = 0.0
        for i in range(3):
            spot = first if i == 0 else (second if i == 1 else third)
            along = room[i, 0] * probes[p, 0] + room[i, 1] * probes[p, 1] + room[i, 2] * probes[p, 2]
            give += spot[SPOT_GIVE] * abs(along)
        error = doubt * probe_error(room, room[3], 3, precision, p) / max(size + give, 1e-300)
        least = max(least, error)
        if least > enough:
            break
    return least


@inner
def bound_least_error_of_four(
    first: Array,
    second: Array,
    third: Array,
    fourth: Array,
    along: tuple[float, float],
    extra: tuple[float, float],
    precision: Precision,
    room: Array,
    numbers: Array,
    enough: float,
) -> float:
    """Return a lower bound in mm of the effective error of every fixture of two standing and two moving pegs
    with contacts in four spots.

    See the comment at SPOT_NX for the columns of a spot.

    Parameters
    ----------
    first, second : spot rows of the standing pegs.
    third, fourth : spot rows of the moving pegs.
    along : for each moving peg, the component of its outward normal along the travel.
    extra : for each moving peg, the additional error of its contact, per unit of location error, because of
        the travel.
    room : (8, 3) work space.
    numbers : (4,) work space.
    enough : the search for a good bound ends at one above this.
    """
    across, moves = room[3], room[4:]
    for n in range(3):
        across[n] = along[1] * third[n] - along[0] * fourth[n]
    cross_rows(second, across, moves[0])
    cross_rows(across, first, moves[1])
    cross_rows(first, second, moves[2])
    size = abs(first[0] * moves[0, 0] + first[1] * moves[0, 1] + first[2] * moves[0, 2])
    for n in range(3):
        moves[3, n] = -along[0] * moves[2, n]
        moves[2, n] = along[1] * moves[2, n]
    numbers[0], numbers[1] = first[SPOT_FEATURE], second[SPOT_FEATURE]
    numbers[2], numbers[3] = third[SPOT_FEATURE], fourth[SPOT_FEATURE]
    gives = (first[SPOT_GIVE], second[SPOT_GIVE], third[SPOT_GIVE] + extra[0], fourth[SPOT_GIVE] + extra[1])
    least, probes, doubt = 0.0, precision.probes, find_doubt(numbers, 4, precision)
    for p in range(probes.shape[0]):
        give = 0.0
        for i in range(4):
            give += gives[i] * abs(
                moves[i, 0] * probes[p, 0] + moves[i, 1] * probes[p, 1] + moves[i, 2] * probes[p, 2]
            )
        error = doubt * probe_error(moves, numbers, 4, precision, p) / max(size + give, 1e-300)
        least = max(least, error)
        if least > enough:
            break
    return least


@inner
def mark_triple(triples: ByteArray, a: int, b: int, c: int) -> None:
    """Set ``triples`` to 1 at the indices (a, b, c) and at all their permutations."""
    triples[a, b, c] = triples[a, c, b] = 1
    triples[b, a, c] = triples[b, c, a] = 1
    triples[c, a, b] = triples[c, b, a] = 1


@compiled
def join_near_spots(
    spots: Matrix,
    roots: int,
    most: float,
    precision: Precision,
    near: NearSpots,
    counts: IntVector,
    stack: IntMatrix,
    room: Matrix,
) -> None:
    """Mark the pairs and triples of finest spots that three locators may touch with an effective error up to
    ``most`` mm.

    A finest spot is one that is not divided further. See the comment at SPOT_NX for the columns of ``spots``.

    Parameters
    ----------
    spots : (S, 7) spots. The first ``roots`` rows are those that belong to no larger spot, in the order of
        features; the spots that a spot is divided into stand in later rows.
    most : effective error in mm.
    near : its arrays ``joined`` and ``triples`` receive 1 for finest spots that may be touched together;
        other entries stay as they are.
    counts : (2,) to which the numbers of triples examined and of triples ruled out are added.
    stack : (MOST_WAITING, 3) work space.
    room : (4, 3) work space.
    """
    joined, keeps_triples = near.joined, near.triples.shape[0] > 0
    for i in range(roots):
        for j in range(i, roots):
            for k in range(j, roots):
                stack[0, 0], stack[0, 1], stack[0, 2] = i, j, k
                height = 1
                while height > 0:
                    height -= 1
                    one, two, three = stack[height, 0], stack[height, 1], stack[height, 2]
                    counts[0] += 1
                    first, second, third = spots[one], spots[two], spots[three]
                    if bound_least_error(first, second, third, precision, room, most) > most:
                        counts[1] += 1
                        continue
                    if first[SPOT_COUNT] + second[SPOT_COUNT] + third[SPOT_COUNT] == 0.0:
                        a, b, c = int(first[SPOT_FIRST]), int(second[SPOT_FIRST]), int(third[SPOT_FIRST])
                        joined[a, b] = joined[b, a] = 1
                        joined[a, c] = joined[c, a] = 1
                        if first[SPOT_FEATURE] == second[SPOT_FEATURE]:
                            joined[b, c] = joined[c, b] = 1
                        if keeps_triples:
                            mark_triple(near.triples, a, b, c)
                        continue
                    for a in range(max(int(first[SPOT_COUNT]), 1)):
                        for b in range(max(int(second[SPOT_COUNT]), 1)):
                            for c in range(max(int(third[SPOT_COUNT]), 1)):
                                stack[height, 0] = get_part(spots, one, a)
                                stack[height, 1] = get_part(spots, two, b)
                                stack[height, 2] = get_part(spots, three, c)
                                height += 1


@inner
def get_part(spots: Array, spot: int, number: int) -> int:
    """Return the row of a spot's child ``number``: of one of the spots that it is divided into.

    A finest spot, which is not divided, is its own child. See the comment at SPOT_NX for the columns of
    ``spots``.
    """
    return int(spots[spot, SPOT_FIRST]) + number if spots[spot, SPOT_COUNT] > 0.0 else spot


@compiled
def find_least_middle_error(spots: Matrix, roots: int, precision: Precision, room: Matrix) -> float:
    """Return the least effective error in mm of three contacts in the middles of the first ``roots`` spots.

    Contacts may share a spot. Return inf when no three fix the pose. ``room`` is (4, 3) work space. See the
    comment at SPOT_NX for the columns of ``spots``.
    """
    least = np.inf
    for i in range(roots):
        for j in range(i, roots):
            for k in range(j, roots):
                first, second, third = spots[i], spots[j], spots[k]
                cross_rows(second, third, room[0])
                size = abs(first[0] * room[0, 0] + first[1] * room[0, 1] + first[2] * room[0, 2])
                if size <= 1e-6:
                    continue
                cross_rows(third, first, room[1])
                cross_rows(first, second, room[2])
                room[3, 0], room[3, 1] = first[SPOT_FEATURE], second[SPOT_FEATURE]
                room[3, 2] = third[SPOT_FEATURE]
                least = min(least, bound_error(room, room[3], 3, precision, np.inf) / size)
    return least
