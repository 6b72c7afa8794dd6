"""Three pegs on the carrier that stands still, one on the carrier that moves (the paper's Type II).

Three standing pegs are two chords that share their tail: they fit where the tails' parameters on the shared
feature agree at the same orientation. A *limb* is a piece of one of these two chord curves, with the numbers
that matter for its pairing (columns LIMB_... below).
"""

from __future__ import annotations

from math import cos, hypot, pi, sin

import numpy as np

from workhold.conventions import GAP_SLACK
from workhold.kernels.base.arrays import sort_rows
from workhold.kernels.base.compiling import Array, IntArray, IntVector, Vector, compiled, inner
from workhold.kernels.base.feature import HALF_EXTENT, IS_ARC, compute_local_size
from workhold.kernels.base.interval import TURN
from workhold.kernels.base.tables import (
    CENTER,
    COLUMN_STEP,
    CURVE,
    HEAD,
    HIGH,
    LOW,
    ROW_STEP,
    STEADY,
    TAIL,
    VALUE_LEAST,
    VALUE_MOST,
    X_STANDING,
    Curves,
    Features,
    Lattice,
    Limits,
    NearSpots,
    Precision,
)
from workhold.kernels.chord.evaluation import POSITION
from workhold.kernels.chord.intervals import share_one_line
from workhold.kernels.contact.location_bounds import (
    BEYOND,
    CONTACT_LENGTH,
    bound_least_error,
    find_most_allowed,
)
from workhold.kernels.contact.record import make_angle, write_given_up
from workhold.kernels.contact.rules import share_a_carrier
from workhold.kernels.curves.block_work import (
    CROSSED,
    NO_ROOM_FOR_PIECES,
    NO_ROOM_FOR_RECORDS,
    PAIRS,
    STOPPED,
    BlockSpace,
    BlockWork,
    has_no_moving_peg,
    is_among,
    make_block_work,
    place_triple,
)
from workhold.kernels.curves.moving_pegs import add_moving_pegs, find_height_range
from workhold.kernels.curves.near_spots import find_spots, is_any_joined, may_be_three, write_piece_spots
from workhold.kernels.curves.piece_bounds import HAIR, clear_edges
from workhold.kernels.curves.pieces import write_pieces
from workhold.kernels.curves.roots import ROOT_PSI, ROOT_RADIUS, may_meet, write_crossings

# Columns of a limb, one of the two chords of a triple, as the pairing of pieces needs it: psi from LIMB_LOW
# to LIMB_HIGH, bounds of the tail's parameter, index of its piece, feature of the tail, ranges of the spots
# of tail and head (first and past-the-last).
LIMB_LOW, LIMB_HIGH, LIMB_VALUE_LEAST, LIMB_VALUE_MOST, LIMB_PIECE, LIMB_TAIL = range(6)
LIMB_TAIL_FIRST, LIMB_TAIL_END, LIMB_HEAD_FIRST, LIMB_HEAD_END = range(6, 10)
# Both contacts as spots (``contact.location_bounds``).
LIMB_TAIL_SPOT, LIMB_HEAD_SPOT = 10, 10 + CONTACT_LENGTH
# Radians from the seam of a circle, where no curve goes on, in which rounding may take a value past it.
BESIDE_SEAM = 1e-3


@inner
def find_farthest_right(features: Features, low: float, high: float) -> float:
    """Return an upper bound of x in mm of the moving pegs that touch the part, for psi in [low, high].

    x is measured in the toolkit's frame from the part's origin; -inf where no feature is touched by moving
    pegs.
    """
    psi, half = (low + high) / 2.0, (high - low) / 2.0
    most = -np.inf
    for k in range(features.moving[0], features.moving[1]):
        row = features.loose[k]
        _, highest = find_height_range(row, cos(psi), sin(psi))
        size = compute_local_size(row) + row[HALF_EXTENT]
        most = max(most, highest + size * half)
    return most


@inner
def write_limbs(
    pieces: Array, features: Features, curves: Curves, farthest: float, length: float, out: Array
) -> int:
    """Write the limbs (N, 20) of those pieces whose chords may belong to three standing pegs; return their
    number.

    A limb is one of the two chords, with a common tail, that three standing pegs form. A piece is left out
    where no moving peg fits to the right of its pegs (``farthest`` is the largest x in mm of moving pegs), or
    where its contacts are ruled out by their spots. ``out`` receives the limbs. ``length`` is L in mm, by
    which moments are divided. See ``base.tables`` for the layout of ``pieces``.
    """
    count, integers, touched = int(np.int64(0)), curves.integers, features.standing
    asks_spots = features.near.joined.shape[0] > 0
    for k in range(pieces.shape[0]):
        row = pieces[k]
        tail = integers[int(row[CURVE]), TAIL]
        if row[X_STANDING] > farthest or not is_among(tail, touched):
            continue
        limb = out[count]
        limb[LIMB_VALUE_LEAST], limb[LIMB_VALUE_MOST] = row[VALUE_LEAST] - HAIR, row[VALUE_MOST] + HAIR
        limb[LIMB_LOW], limb[LIMB_HIGH], limb[LIMB_PIECE] = row[LOW], row[HIGH], k
        limb[LIMB_TAIL] = tail
        if asks_spots and not write_spots(limb, row, features, curves, length):
            continue
        count += 1
    return count


@inner
def write_spots(limb: Array, piece: Array, features: Features, curves: Curves, length: float) -> bool:
    """Write the spots (stretches of features) that tail and head of a piece may touch to the piece's limb
    (20,).

    Return whether some spot of the tail and some spot of the head may be touched by two locators together.
    See the comment at LIMB_LOW for the columns of ``limb``, ``base.tables`` for the layout of ``piece``.
    """
    number, near = int(piece[CURVE]), features.near
    tail, head = curves.integers[number, TAIL], curves.integers[number, HEAD]
    there, ahead = write_piece_spots(
        piece, limb[LIMB_TAIL_SPOT:LIMB_HEAD_SPOT], limb[LIMB_HEAD_SPOT:], features, curves, length
    )
    first, end = find_spots(features.loose[tail], tail, near, there.x, there.y, there.radius)
    begin, last = find_spots(features.loose[head], head, near, ahead.x, ahead.y, ahead.radius)
    limb[LIMB_TAIL_FIRST], limb[LIMB_TAIL_END] = first, end
    limb[LIMB_HEAD_FIRST], limb[LIMB_HEAD_END] = begin, last
    return is_any_joined(near, first, end, begin, last)


@inner
def are_near(limb: Array, other: Array, near: NearSpots) -> bool:
    """Return whether the three pegs of two limbs with a common tail are not ruled out by the spots that they
    may touch.

    See the comment at LIMB_LOW for the columns of ``limb`` and ``other``.
    """
    first = int(max(limb[LIMB_TAIL_FIRST], other[LIMB_TAIL_FIRST]))
    end = int(min(limb[LIMB_TAIL_END], other[LIMB_TAIL_END]))
    for i in range(first, end):
        for j in range(int(limb[LIMB_HEAD_FIRST]), int(limb[LIMB_HEAD_END])):
            for k in range(int(other[LIMB_HEAD_FIRST]), int(other[LIMB_HEAD_END])):
                if may_be_three(near, i, j, k):
                    return True
    return False


@inner
def are_limbs_beyond(limb: Array, other: Array, precision: Precision, room: Array) -> bool:
    """Return whether every seat of the three pegs of two limbs with a common tail has too large a location
    error.

    False where this is not certain. ``room`` is (4, 3) work space. See the comment at LIMB_LOW for the
    columns of ``limb`` and ``other``.
    """
    tail, head, third = limb[LIMB_TAIL_SPOT:LIMB_HEAD_SPOT], limb[LIMB_HEAD_SPOT:], other[LIMB_HEAD_SPOT:]
    low, high = max(limb[LIMB_LOW], other[LIMB_LOW]), min(limb[LIMB_HIGH], other[LIMB_HIGH])
    most = BEYOND * find_most_allowed(low, high, precision)
    return bound_least_error(tail, head, third, precision, room, most) > most


@inner
def sort_limbs(limbs: Array, keys: Array, order: IntArray, out: Array) -> None:
    """Write limbs (N, 20) to ``out``, the limbs of each tail in ascending order of LIMB_VALUE_LEAST.

    In ``limbs``, those of one tail must follow one another; the groups keep their order. ``keys`` and
    ``order`` are (N,) work space. See the comment at LIMB_LOW for the columns of ``limbs``.
    """
    first = int(np.int64(0))
    for k in range(1, limbs.shape[0] + 1):
        if k == limbs.shape[0] or limbs[k, LIMB_TAIL] != limbs[first, LIMB_TAIL]:
            sort_rows(limbs[first:k], LIMB_VALUE_LEAST, 1.0, keys[first:k], order[first:k], out[first:k])
            first = k


@inner
def add_triples(out: Array, count: int, number: int, one: int, two: int, work: BlockWork) -> int:
    """Try every moving peg with the three standing pegs at each of the first ``number`` crossings in
    ``work.roots``.

    Append the fixtures to ``out``, of which ``count`` records are written already. The crossings are those of
    the curves with the indices ``one`` and ``two``, which share their tail. Return the new number of records,
    or NO_ROOM_FOR_RECORDS (-1).
    """
    for root in range(number):
        psi, reach = work.roots[root, ROOT_PSI], work.roots[root, ROOT_RADIUS]
        angle = make_angle(psi)
        place_triple(work.pegs, one, two, angle, reach, work.features.rows, work.curves)
        count = add_moving_pegs(out, count, angle, reach, work)
        if count < 0:
            break
    return count


@inner
def heads_share_a_line(one: IntArray, two: IntArray, features: Array, lattice: Lattice) -> bool:
    """Return whether the heads of two chords with a common tail push along one line of action.

    ``one`` and ``two`` are the whole numbers (7,) of the curves. Such pairs of chords must be left out: all
    their curves nearly agree where the pegs stand square to the features, which makes thousands of crossings
    that no rounding keeps apart. (Single chords whose tail and head push along one line are not in the table
    of curves.) See ``base.tables`` for the layout of ``one`` and ``two``, ``base.feature`` for that of
    ``features``.
    """
    x = (two[COLUMN_STEP] - one[COLUMN_STEP]) * lattice.pitch_x
    y = (two[ROW_STEP] - one[ROW_STEP]) * lattice.pitch_y
    return share_one_line(features[one[HEAD]], features[two[HEAD]], hypot(x, y))


@inner
def add_limb_pairs(out: Array, count: int, limbs: Array, pieces: Array, work: BlockWork) -> int:
    """Append the fixtures of all pairs of limbs (N, 20) with a common tail, and pairs given up, to ``out``.

    ``count`` records are written already. Limbs are in the order of :func:`sort_limbs`. Return the new number
    of records, or NO_ROOM_FOR_RECORDS (-1). See ``base.tables`` for the layout of ``pieces``.
    """
    stats, lattice, limits = work.stats, work.lattice, work.limits
    loose, curves, integers = work.features.loose, work.curves, work.curves.integers
    near, asks_spots = work.features.near, work.features.near.joined.shape[0] > 0
    end = int(np.int64(0))
    for i in range(limbs.shape[0]):
        if stats[STOPPED] != 0:
            break
        limb = limbs[i]
        tail = int(limb[LIMB_TAIL])
        while end < limbs.shape[0] and limbs[end, LIMB_TAIL] == limb[LIMB_TAIL]:
            end += 1
        stats[PAIRS] += end - 1 - i
        circle = loose[tail, IS_ARC] != 0.0 and loose[tail, HALF_EXTENT] >= pi
        period = TURN if circle else 0.0
        for ahead in range(end - 1 - i):
            other = limbs[i + 1 + ahead]
            if other[LIMB_VALUE_LEAST] > limb[LIMB_VALUE_MOST]:
                # All that follow have larger values, too. Beside a circle's seam these may be the same ones.
                if not circle or limb[LIMB_VALUE_LEAST] > BESIDE_SEAM - pi:
                    break
                if other[LIMB_VALUE_MOST] < limb[LIMB_VALUE_LEAST] + TURN:
                    continue
            if limb[LIMB_LOW] >= other[LIMB_HIGH] or other[LIMB_LOW] >= limb[LIMB_HIGH]:
                continue
            first = pieces[int(max(limb[LIMB_PIECE], other[LIMB_PIECE]))]
            second = pieces[int(min(limb[LIMB_PIECE], other[LIMB_PIECE]))]
            one, two = int(first[CURVE]), int(second[CURVE])
            if not share_a_carrier(integers[one], integers[two], limits):
                continue
            if integers[one, CENTER] >= 0 and integers[one, CENTER] == integers[two, CENTER]:
                continue
            steady = first[STEADY] * second[STEADY] == 1.0
            if steady and not may_meet(first, second, 0.0, period):
                continue
            if asks_spots and (
                not are_near(limb, other, near)
                or are_limbs_beyond(limb, other, work.features.precision, work.triple[:4])
            ):
                continue
            if not work.counting and heads_share_a_line(integers[one], integers[two], loose, lattice):
                continue
            if stats[STOPPED] != 0:
                break
            number = write_crossings(
                first, second, loose, curves, POSITION, 0.0, period, 0.0, work.stack, work.roots
            )
            if number >= 0:
                count = add_triples(out, count, number, one, two, work)
            elif count < out.shape[0]:
                write_given_up(out[count], 3.0, first, second, integers)
                count += 1
            else:
                count = NO_ROOM_FOR_RECORDS
            if count < 0:
                return count
            stats[CROSSED] += 1
    return count


@compiled
def write_three_and_one(
    edges: Vector,
    members: IntVector,
    features: Features,
    curves: Curves,
    lattice: Lattice,
    limits: Limits,
    counting: bool,
    stats: IntVector,
    space: BlockSpace,
) -> int:
    """Write all fixtures of three standing pegs and one moving peg
    with psi in some neighbouring cells to ``space.out``.

    Those whose chords from the shared tail are sliding pairs are left out. Parameters and result are those of
    ``write_two_and_two``. The shared tail is on the feature of the lowest number, so that each triple of pegs
    occurs once. The curves, and so the pieces, are in the order of their tails.
    """
    count = int(np.int64(0))
    work = make_block_work(features, curves, lattice, limits, counting, stats, space)
    kept = space.kept[: members.shape[0]]
    clear_edges(kept)
    for cell in range(edges.shape[0] - 1):
        if stats[STOPPED] != 0:
            break
        low, high, farthest = edges[cell], edges[cell + 1], np.inf
        if not counting and not has_no_moving_peg(features):
            farthest = find_farthest_right(features, low, high) - limits.gap + GAP_SLACK + HAIR
        number = write_pieces(
            low,
            high,
            members,
            features.loose,
            curves,
            lattice.pitch_x,
            0.0,
            POSITION,
            farthest,
            kept,
            space.edges,
            space.pieces,
        )
        if number < 0:
            return NO_ROOM_FOR_PIECES
        pieces = space.pieces[:number]
        found = write_limbs(
            pieces, features, curves, farthest, limits.wrench_length, space.unordered_limbs[:number]
        )
        limbs = space.limbs[:found]
        sort_limbs(space.unordered_limbs[:found], space.keys[:found], space.order[:found], limbs)
        count = add_limb_pairs(space.out, count, limbs, pieces, work)
        if count < 0:
            return NO_ROOM_FOR_RECORDS
    return count
