"""Bounds of the location error: of contacts in place, and of all contacts on short stretches of features.

The location error is the largest movement of a point of the silhouette when all pegs and faces are off by
their tolerances. Here the movement is taken of a few points and along a few directions only, the probes. So
it comes out too small, never too large. The movement of a probe is a sum over contacts, each with its error.
Signs of errors are free, so the largest sum is that of the sizes:

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
from workhold.kernels.contact.rules import outward_normal

# Columns of a spot, a stretch of a feature: its normal, its moment about the centre over L, what contacts in
# it may be off by for a location error of 1, its feature, the first of the spots that it is made of, and how
# many these are (0: it is one of the finest, and has the number that stands for the first).
# Parts of three spots wait in no more rows than this: each level adds seven, and has half as large spots.
MOST_WAITING = 512
SPOT_NX, SPOT_NY, SPOT_MOMENT, SPOT_GIVE, SPOT_FEATURE, SPOT_FIRST, SPOT_COUNT = range(7)
SPOT_LENGTH = 7
# Of a contact in place no more than these are known.
CONTACT_LENGTH = 5
# Errors this part beyond the limit are surely beyond it, whatever is rounded.
BEYOND = 1.001
# By how many times what a minor may be off by movements may be, at most: with three locators, and with two and two.
# Let normals turn by s and points move by r. The components of the cross product of two wrenches are then
# off by 5.7 s + 2 r / L, half of ``minor_band``. A probe multiplies them by no more than 1.42 + 1.42 together,
# and three contacts make 4.3 minors. A determinant is off by one. Of two and two, wrenches of sizes up to 2
# are combined before.
WIDE_OF_THREE, WIDE_OF_FOUR = 4.5, 40.0
# Radians beside a quarter turn that count as such.
SQUARE = 1e-4


@inner
def cross_rows(one: Array, two: Array, out: Array) -> None:
    """Writes the cross product of two rows of three."""
    out[0] = one[1] * two[2] - one[2] * two[1]
    out[1] = one[2] * two[0] - one[0] * two[2]
    out[2] = one[0] * two[1] - one[1] * two[0]


@inner
def probe_error(moves: Array, features: Array, count: int, precision: Precision, probe: int) -> float:
    """The largest movement of one probe in mm, see ``error_times``."""
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
def error_times(moves: Array, features: Array, count: int, precision: Precision, enough: float) -> float:
    """A lower bound of the location error in mm for movements (C, 3) that errors of 1 of contacts make.

    ``features`` (C,) are those touched. Where movements are multiplied by something, so is the result.
    A bound above ``enough`` is as good as any larger one.
    """
    most = 0.0
    for p in range(precision.probes.shape[0]):
        most = max(most, probe_error(moves, features, count, precision, p))
        if most > enough:
            break
    return most


@inner
def doubt_at(features: Array, count: int, precision: Precision) -> float:
    """The factor by which contacts on features (C,) count more, at least."""
    doubt = 1.0
    for i in range(count):
        doubt = max(doubt, precision.doubts[int(features[i])])
    return doubt


@inner
def most_allowed(low: float, high: float, precision: Precision) -> float:
    """The largest error of interest at orientations from ``low`` to ``high`` in radians."""
    quarter = TURN / 4.0
    if floor((high + SQUARE) / quarter) > floor((low - SQUARE) / quarter):
        return precision.most
    return precision.most_aslant


@inner
def is_beyond(
    moves: Array, features: Array, count: int, size: float, band: float, psi: float, precision: Precision
) -> bool:
    """Whether contacts surely have a larger effective error than is of interest.

    Parameters
    ----------
    moves : (C, 3) movements that errors of 1 make, times ``size``, of which ``band`` may be wrong.
    features : (C,) touched.
    psi : orientation in radians.
    """
    most = BEYOND * most_allowed(psi, psi, precision) / doubt_at(features, count, precision)
    wide = band * (WIDE_OF_THREE if count == 3 else WIDE_OF_FOUR)
    enough = most * (size + wide) + wide * (precision.peg + precision.face)
    return error_times(moves, features, count, precision, enough) > enough


@inner
def two_and_two_beyond(
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
    """Whether two pegs on each of two carriers surely have a larger effective error than is of interest.

    The travel of the carrier that moves is free. What its two pegs say besides is one wrench across it.

    Parameters
    ----------
    points, normals : (4, 2) of the contacts, two of either carrier after each other.
    features : (4,) touched.
    still : 0 where the first two pegs stand still, 2 where the last two do.
    length : L in mm.
    band : what a minor may be off by.
    room : (8, 3) work space.
    """
    wrenches, moves = room[:4], room[4:]
    for k in range(4):
        wrenches[k, 0], wrenches[k, 1] = normals[k, 0], normals[k, 1]
        wrenches[k, 2] = (points[k, 0] * normals[k, 1] - points[k, 1] * normals[k, 0]) / length
    a, b, c, d = still, still + 1, 2 - still, 3 - still
    one = normals[c, 0] * angle[1] + normals[c, 1] * angle[2]
    two = normals[d, 0] * angle[1] + normals[d, 1] * angle[2]
    for n in range(3):
        wrenches[c, n] = two * wrenches[c, n] - one * wrenches[d, n]
    cross_rows(wrenches[b], wrenches[c], moves[a])
    cross_rows(wrenches[c], wrenches[a], moves[b])
    cross_rows(wrenches[a], wrenches[b], moves[c])
    size = abs(wrenches[a, 0] * moves[a, 0] + wrenches[a, 1] * moves[a, 1] + wrenches[a, 2] * moves[a, 2])
    for n in range(3):
        moves[d, n] = -one * moves[c, n]
        moves[c, n] = two * moves[c, n]
    return is_beyond(moves, features, 4, size, band, angle[0], precision)


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
    """Writes a contact on a feature, known to a radius in mm, as a spot (5,)."""
    nx, ny = outward_normal(row, x, y)
    out[SPOT_NX], out[SPOT_NY], out[SPOT_FEATURE] = nx, ny, feature
    out[SPOT_MOMENT] = (x * ny - y * nx) / length
    off = radius if row[IS_ARC] == 0.0 else swing_within(row, radius)
    out[SPOT_GIVE] = off * precision.gives[feature]


@inner
def swing_within(row: Array, radius: float) -> float:
    """By how many radians the normal of a contact may be off that is known to a radius in mm."""
    if row[IS_ARC] == 0.0:
        return 0.0
    # See ``curves.near_spots``.
    return 1.1 * radius / row[RADIUS] if radius <= 0.5 * row[RADIUS] else 2.0


@inner
def least_error_in(
    first: Array, second: Array, third: Array, precision: Precision, room: Array, enough: float
) -> float:
    """What the effective error of any seat with contacts in three spots is no less than, in mm.

    ``room`` is (4, 3) work space; a bound above ``enough`` is as good as any larger one.
    """
    cross_rows(second, third, room[0])
    cross_rows(third, first, room[1])
    cross_rows(first, second, room[2])
    size = abs(first[0] * room[0, 0] + first[1] * room[0, 1] + first[2] * room[0, 2])
    room[3, 0], room[3, 1], room[3, 2] = first[SPOT_FEATURE], second[SPOT_FEATURE], third[SPOT_FEATURE]
    least, probes, doubt = 0.0, precision.probes, doubt_at(room[3], 3, precision)
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
def least_error_of_four(
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
    """What the effective error of any seat of two and two pegs with contacts in four spots is no less than, in mm.

    Parameters
    ----------
    first, second : spots of the standing pegs.
    third, fourth : spots of the moving pegs.
    along : the normals of the moving pegs' contacts along the travel.
    extra : what contacts of the moving pegs may be off by for a location error of 1, because of the travel.
    room : (8, 3) work space.
    numbers : (4,) work space.
    enough : a bound above this is as good as any larger one.
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
    least, probes, doubt = 0.0, precision.probes, doubt_at(numbers, 4, precision)
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
    """Marks three spots in every order."""
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
    """Mark the spots that locators with no larger effective error may touch.

    Parameters
    ----------
    spots : (S, 7), the first so many of them the ``roots``, in the order of features.
    most : effective error in mm.
    near : receives the marks, for the finest spots.
    counts : (2,) to which is added how many triples of spots were looked at, and how many were ruled out.
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
                    if least_error_in(first, second, third, precision, room, most) > most:
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
                                stack[height, 0] = part_of(spots, one, a)
                                stack[height, 1] = part_of(spots, two, b)
                                stack[height, 2] = part_of(spots, three, c)
                                height += 1


@inner
def part_of(spots: Array, spot: int, number: int) -> int:
    """A spot that another is made of, by its number among these; one of the finest is itself."""
    return int(spots[spot, SPOT_FIRST]) + number if spots[spot, SPOT_COUNT] > 0.0 else spot


@compiled
def least_middle_error(spots: Matrix, roots: int, precision: Precision, room: Matrix) -> float:
    """Return the least effective error in mm of three contacts in the middles of the first spots; infinite
    when no three fix the pose. ``room`` is (4, 3) work space."""
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
                least = min(least, error_times(room, room[3], 3, precision, np.inf) / size)
    return least
