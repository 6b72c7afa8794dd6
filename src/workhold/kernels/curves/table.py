"""The table of all chord curves and sliding pairs of a workpiece: pairs of features times lattice steps."""

from __future__ import annotations

from math import ceil, cos, hypot, sin
from typing import NamedTuple

import numpy as np

from workhold.kernels.base.compiling import (
    Array,
    IntArray,
    IntMatrix,
    IntVector,
    Matrix,
    Vector,
    compiled,
    inner,
)
from workhold.kernels.base.feature import HALF_EXTENT, IS_ARC, RADIUS, X, Y, compute_point
from workhold.kernels.base.interval import TURN
from workhold.kernels.base.tables import (
    CENTER,
    COLUMN_STEP,
    CURVE_INTEGERS,
    CURVE_REALS,
    DIRECTION,
    END_STRETCH,
    FIRST_STRETCH,
    FROM,
    HEAD,
    LENGTH,
    NEAR_FROM,
    NEAR_TO,
    ORIENTATION,
    ROW_STEP,
    SLIDE_FROM,
    SLIDE_TO,
    SLIDING_PAIR_REALS,
    STEP_LENGTH,
    TAIL,
    TANGENT_FROM,
    TANGENT_TO,
    TO,
    NearSpots,
)
from workhold.kernels.chord.evaluation import find_parameter, write_curve, write_shift
from workhold.kernels.chord.intervals import (
    ALIVE,
    MOST_EVENTS,
    MOST_RANGES,
    NARROW,
    SLIVER,
    write_chord_intervals,
)
from workhold.kernels.chord.stretches import DEPTH, STRETCH_LENGTH, add_stretches
from workhold.kernels.curves.near_spots import may_join
from workhold.kernels.curves.piece_bounds import Disc, enclose_tail
from workhold.kernels.curves.sliding_pairs import MOST_SLIDES, write_sliding_pairs

# Rounding of distances in mm, generously counted.
ROUNDING = 1e-9
# A chord's range is looked at in so many parts.
RANGE_PARTS = 16


@inner
def measure_reach(row: Array) -> float:
    """Return the largest distance in mm of a feature's points from its middle (line) or centre (arc).

    See ``base.feature`` for the layout of ``row``.
    """
    return row[HALF_EXTENT] if row[IS_ARC] == 0.0 else row[RADIUS]


@inner
def may_reach(row: Array, x: float, y: float, radius: float) -> bool:
    """Return whether a point of a feature's line or circle, known to
    ``radius`` in mm, may be on the feature itself.

    See ``base.feature`` for the layout of ``row``.
    """
    s, off = abs(find_parameter(row, x, y)), radius + ROUNDING
    if row[IS_ARC] == 0.0:
        return not s > row[HALF_EXTENT] + off
    # From an arc's centre a disc of up to half its radius R is seen under 1.1 radius / R to either side.
    return not (off <= 0.5 * row[RADIUS] and s > row[HALF_EXTENT] + 1.1 * off / row[RADIUS])


@inner
def may_exist(a: Array, b: Array, curve: Array) -> bool:
    """Return whether a chord may lie on both features somewhere in a curve's range; always True for a wide
    range.

    ``curve`` (16,) has the range in alpha. A range too narrow to be tested in its middle was kept wherever
    the lines or circles of the features meet. Beside a tangency to a circle of many arcs such a range was
    kept for each arc, however far from it. This test drops those ranges. See ``base.feature`` for the layout
    of ``a`` and ``b``, ``base.tables`` for that of ``curve``.
    """
    middle = (curve[FROM] + curve[TO]) / 2.0
    half = (curve[TO] - curve[FROM]) / 2.0 + max(curve[TANGENT_FROM], curve[TANGENT_TO])
    if half > NARROW or curve[TO] - curve[FROM] <= 3.0 * SLIVER:
        return True
    x, y, radius = enclose_tail(a, b, curve, middle, half)
    d = curve[LENGTH]
    at_head = may_reach(b, x + d * cos(middle), y + d * sin(middle), radius + d * half)
    return at_head and may_reach(a, x, y, radius)


@inner
def write_near_range(a: Array, b: Array, ends: tuple[int, int], near: NearSpots, curve: Array) -> bool:
    """Set NEAR_FROM and NEAR_TO of a curve (16,): the part of its range in which ``near`` allows both
    contacts.

    Return whether there is any such part. ``ends`` are the numbers of the features ``a`` and ``b``. Where
    ``near`` rules nothing out, the part is the whole range. See ``base.feature`` for the layout of ``a`` and
    ``b``, ``base.tables`` for that of ``curve``.
    """
    curve[NEAR_FROM], curve[NEAR_TO] = curve[FROM], curve[TO]
    if near.joined.shape[0] == 0:
        return True
    slack, d = max(curve[TANGENT_FROM], curve[TANGENT_TO]), curve[LENGTH]
    low, size = curve[FROM], (curve[TO] - curve[FROM]) / RANGE_PARTS
    first, last = RANGE_PARTS, -1
    for k in range(RANGE_PARTS):
        middle, half = low + (k + 0.5) * size, 0.5 * size + slack + SLIVER
        tail = enclose_tail(a, b, curve, middle, half)
        head = Disc(tail.x + d * cos(middle), tail.y + d * sin(middle), tail.radius + d * half)
        if may_join(a, b, ends, near, tail, head):
            first, last = min(first, k), k
    if last < 0:
        return False
    if first > 0:
        curve[NEAR_FROM] = low + first * size
    if last < RANGE_PARTS - 1:
        curve[NEAR_TO] = low + (last + 1) * size
    return True


@inner
def trim_sliding_range(
    a: Array, b: Array, ends: tuple[int, int], near: NearSpots, pair: Array, d: float
) -> bool:
    """Cut the range of a sliding pair in place to the part in which ``near`` allows both contacts.

    Return whether there is any such part. ``pair`` begins with SLIDE_FROM, SLIDE_TO, DIRECTION; ``ends`` are
    the numbers of the features ``a`` and ``b``, d is the chord's length in mm. See ``base.feature`` for the
    layout of ``a`` and ``b``, ``base.tables`` for that of ``pair``.
    """
    if near.joined.shape[0] == 0:
        return True
    first, last = RANGE_PARTS, -1
    low, size = pair[SLIDE_FROM], (pair[SLIDE_TO] - pair[SLIDE_FROM]) / RANGE_PARTS
    half = 0.5 * size * (1.0 if a[IS_ARC] == 0.0 else a[RADIUS]) + ROUNDING
    for k in range(RANGE_PARTS):
        x, y = compute_point(a, low + (k + 0.5) * size)
        head = Disc(x + d * cos(pair[DIRECTION]), y + d * sin(pair[DIRECTION]), half)
        if may_join(a, b, ends, near, Disc(x, y, half), head):
            first, last = min(first, k), k
    if last < 0:
        return False
    if last < RANGE_PARTS - 1:
        pair[SLIDE_TO] = low + (last + 1) * size
    if first > 0:
        pair[SLIDE_FROM] = low + first * size
    return True


@inner
def comes_within(low: float, high: float, angle: float, within: Array) -> bool:
    """Return whether an orientation psi = alpha - ``angle``, for some alpha in [low, high], lies in one of K
    ranges.

    ``within`` (K, 2) are the ranges. All angles are in radians, modulo turns. Return True where K is 0.
    """
    for k in range(within.shape[0]):
        # Where the range ends, a turn or more before the chord begins there or not.
        end = within[k, 1] + ROUNDING
        end += TURN * ceil((low - angle - end) / TURN)
        if end - (within[k, 1] - within[k, 0]) - 2.0 * ROUNDING <= high - angle:
            return True
    return within.shape[0] == 0


@inner
def has_step_within(curve: Array, angles: Array, first: int, end: int, within: Array) -> bool:
    """Return whether a chord with one of the lattice steps ``first`` to ``end`` - 1 has an orientation in one
    of K ranges.

    ``within`` (K, 2) are the ranges of psi, ``curve`` has the range of alpha, ``angles`` the directions of
    the steps; see :func:`comes_within`. See ``base.tables`` for the layout of ``curve``.
    """
    found = False
    for step in range(first, end):
        found = found or comes_within(curve[FROM], curve[TO], angles[step], within)
    return found


class CurveSpace(NamedTuple):
    """The memory that the curves of one tail are written to; see :func:`make_curve_space`.

    Parameters
    ----------
    integers, reals : (C, 7) and (C, 16) receive the curves, see ``base.tables``.
    pair_integers, pair_reals : (C, 7) and (C, 5) receive the sliding pairs, see ``base.tables``.
    stretches : (C, 13) receive the curves' stretches, see ``chord.stretches``.
    curve : (16,) work space.
    events, ranges, slides, stack : work space, see ``chord.intervals``, ``sliding_pairs`` and
        ``chord.stretches``.
    """

    integers: IntMatrix
    reals: Matrix
    pair_integers: IntMatrix
    pair_reals: Matrix
    stretches: Matrix
    curve: Vector
    events: Matrix
    ranges: Matrix
    slides: Matrix
    stack: Vector


def make_curve_space(rows: int) -> CurveSpace:
    """Return memory, not initialized, for ``rows`` curves, as many
    sliding pairs and as many stretches of one tail.
    """
    return CurveSpace(
        integers=np.empty((rows, CURVE_INTEGERS), np.int64),
        reals=np.empty((rows, CURVE_REALS)),
        pair_integers=np.empty((rows, CURVE_INTEGERS), np.int64),
        pair_reals=np.empty((rows, SLIDING_PAIR_REALS)),
        stretches=np.empty((rows, STRETCH_LENGTH)),
        curve=np.empty(CURVE_REALS),
        events=np.empty((MOST_EVENTS, ALIVE + 1)),
        ranges=np.empty((MOST_RANGES, 5)),
        slides=np.empty((MOST_SLIDES, 3)),
        stack=np.empty(DEPTH),
    )


@compiled
def write_tail_curves(
    tail: int,
    features: Matrix,
    centers: IntVector,
    lengths: Vector,
    starts: IntVector,
    steps: IntMatrix,
    angles: Vector,
    near: NearSpots,
    within: Matrix,
    space: CurveSpace,
) -> tuple[int, int, int]:
    """Write the chord curves and sliding pairs with the tail on one feature to ``space``, except those ruled
    out.

    The head is on the same feature or one of a higher number. See ``base.feature`` for the layout of
    ``features``.

    Parameters
    ----------
    tail : index of the tail's feature.
    features : (F, 10) rows.
    centers : (F,) number of each arc's centre, -1 for lines; concentric arcs share it.
    lengths : (D,) lengths of the lattice steps in mm.
    starts : (D + 1,) index of the first step of each length, then S.
    steps : (S, 2) column and row differences between two holes. Both directions of every step are listed.
    angles : (S,) their directions in radians.
    near : which two stretches of features two locators may touch together; others are ruled out.
    within : (K, 2) ranges of psi in radians; curves outside all of them are ruled out. (0, 2) for no limit.

    Returns
    -------
    (int, int, int)
        Numbers of curves, sliding pairs and stretches; (-1, 0, 0) where there is no room. The orientations of
        sliding pairs, alpha - shift, are still to be brought into range by the caller, and the curves'
        stretches are counted from 0 for this tail.
    """
    integers, reals, ranges, sliding = space.integers, space.reals, space.ranges, space.slides
    curve = space.curve
    count = pair_count = stretch_count = int(np.int64(0))
    a = features[tail]
    for head in range(tail, features.shape[0]):
        b = features[head]
        apart, play = hypot(b[X] - a[X], b[Y] - a[Y]), measure_reach(a) + measure_reach(b)
        center = centers[tail] if centers[tail] == centers[head] else -1
        for length in range(lengths.shape[0]):
            d = lengths[length]
            if d > apart + play + ROUNDING or d < apart - play - ROUNDING:
                continue
            slides = 0
            for k in range(write_sliding_pairs(a, b, d, sliding)):
                if trim_sliding_range(a, b, (tail, head), near, sliding[k], d):
                    for column_of in range(3):
                        sliding[slides, column_of] = sliding[k, column_of]
                    slides += 1
            for k in range(write_chord_intervals(a, b, d, space.events, ranges)):
                write_curve(curve, a, b, d, ranges[k, 2], 0.0)
                curve[FROM], curve[TO] = ranges[k, 0], ranges[k, 1]
                curve[TANGENT_FROM], curve[TANGENT_TO] = ranges[k, 3], ranges[k, 4]
                if not has_step_within(curve, angles, starts[length], starts[length + 1], within):
                    continue
                if not may_exist(a, b, curve) or not write_near_range(a, b, (tail, head), near, curve):
                    continue
                first = stretch_count
                stretch_count = add_stretches(space.stretches, stretch_count, a, b, curve, space.stack)
                if stretch_count < 0:
                    return -1, 0, 0
                for step in range(starts[length], starts[length + 1]):
                    column, row = steps[step, 0], steps[step, 1]
                    if head == tail and (column < 0 or (column == 0 and row < 0)):
                        continue
                    if not comes_within(curve[NEAR_FROM], curve[NEAR_TO], angles[step], within):
                        continue
                    if count == integers.shape[0]:
                        return -1, 0, 0
                    write_step(integers[count], tail, head, column, row, center)
                    integers[count, FIRST_STRETCH], integers[count, END_STRETCH] = first, stretch_count
                    for k_of in range(CURVE_REALS):
                        reals[count, k_of] = curve[k_of]
                    write_shift(reals[count], angles[step])
                    count += 1
            pair_count = write_steps_of_slides(
                tail,
                head,
                center,
                d,
                starts[length],
                starts[length + 1],
                steps,
                angles,
                slides,
                space,
                pair_count,
            )
            if pair_count < 0:
                return -1, 0, 0
    return count, pair_count, stretch_count


@inner
def write_steps_of_slides(
    tail: int,
    head: int,
    center: int,
    d: float,
    first: int,
    end: int,
    steps: IntArray,
    angles: Array,
    slides: int,
    space: CurveSpace,
    count: int,
) -> int:
    """Write the sliding pairs of two features for each step in
    [first, end), which have one length, to ``space``.

    They are written after the first ``count`` pairs; return the new number, -1 when there is no room.
    ``space.slides[:slides]`` are the pairs of the features, see ``sliding_pairs.write_sliding_pairs``.
    """
    for step in range(first, end):
        column, row = steps[step, 0], steps[step, 1]
        if head == tail and (column < 0 or (column == 0 and row < 0)):
            continue
        for k in range(slides):
            if count == space.pair_integers.shape[0]:
                return -1
            write_step(space.pair_integers[count], tail, head, column, row, center)
            pair = space.pair_reals[count]
            for column_of in range(3):
                pair[column_of] = space.slides[k, column_of]
            pair[STEP_LENGTH], pair[ORIENTATION] = d, space.slides[k, DIRECTION] - angles[step]
            count += 1
    return count


@inner
def write_step(row: IntArray, tail: int, head: int, column_step: int, row_step: int, center: int) -> None:
    """Write TAIL, HEAD, COLUMN_STEP, ROW_STEP and CENTER of a curve or sliding pair to ``row`` (7,).

    See ``base.tables`` for the layout of ``row``.
    """
    row[TAIL], row[HEAD], row[COLUMN_STEP], row[ROW_STEP] = tail, head, column_step, row_step
    row[CENTER] = center
