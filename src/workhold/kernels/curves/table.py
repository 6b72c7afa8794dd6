"""The table of all chord curves and sliding pairs of a workpiece: pairs of features times lattice steps."""

from __future__ import annotations

from math import ceil, cos, hypot, sin

import numpy as np

from workhold.kernels.base.arrays import with_room
from workhold.kernels.base.compiling import Array, IntArray, compiled_making_arrays, inner
from workhold.kernels.base.feature import HALF_EXTENT, IS_ARC, RADIUS, X, Y, point_at
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
from workhold.kernels.chord.evaluation import parameter_on, write_curve, write_shift
from workhold.kernels.chord.intervals import NARROW, SLIVER, chord_intervals
from workhold.kernels.chord.stretches import STRETCH_LENGTH, add_stretches
from workhold.kernels.curves.near_spots import may_join
from workhold.kernels.curves.piece_bounds import tail_disc
from workhold.kernels.curves.sliding_pairs import sliding_pairs_between

# Rounding of distances in mm, generously counted.
ROUNDING = 1e-9
# A chord's range is looked at in so many parts.
RANGE_PARTS = 16


@inner
def reach(row: Array) -> float:
    """Largest distance of a feature's points from its middle (line) or centre (arc)."""
    return row[HALF_EXTENT] if row[IS_ARC] == 0.0 else row[RADIUS]


@inner
def may_reach(row: Array, x: float, y: float, radius: float) -> bool:
    """Whether a point of a feature's carrier, known to a radius in mm, may be on the feature."""
    s, off = abs(parameter_on(row, x, y)), radius + ROUNDING
    if row[IS_ARC] == 0.0:
        return not s > row[HALF_EXTENT] + off
    # From an arc's centre a disc of up to half its radius R is seen under 1.1 radius / R to either side.
    return not (off <= 0.5 * row[RADIUS] and s > row[HALF_EXTENT] + 1.1 * off / row[RADIUS])


@inner
def may_exist(a: Array, b: Array, curve: Array) -> bool:
    """Whether a chord may lie on both features somewhere in its range.

    Ranges too narrow to be tested in the middle, but wider than a sliver, are given wherever the carriers of
    the features meet. Beside a tangency to a circle of many arcs that is so of each arc, however far from
    there.
    """
    middle = (curve[FROM] + curve[TO]) / 2.0
    half = (curve[TO] - curve[FROM]) / 2.0 + max(curve[TANGENT_FROM], curve[TANGENT_TO])
    if half > NARROW or curve[TO] - curve[FROM] <= 3.0 * SLIVER:
        return True
    x, y, radius = tail_disc(a, b, curve, middle, half)
    d = curve[LENGTH]
    at_head = may_reach(b, x + d * cos(middle), y + d * sin(middle), radius + d * half)
    return at_head and may_reach(a, x, y, radius)


@inner
def write_near_range(a: Array, b: Array, ends: tuple[int, int], near: NearSpots, curve: Array) -> bool:
    """Writes the part of a chord's range in which its contacts may be of interest; whether there is any."""
    curve[NEAR_FROM], curve[NEAR_TO] = curve[FROM], curve[TO]
    if near.joined.shape[0] == 0:
        return True
    slack, d = max(curve[TANGENT_FROM], curve[TANGENT_TO]), curve[LENGTH]
    low, size = curve[FROM], (curve[TO] - curve[FROM]) / RANGE_PARTS
    first, last = RANGE_PARTS, -1
    for k in range(RANGE_PARTS):
        middle, half = low + (k + 0.5) * size, 0.5 * size + slack + SLIVER
        x, y, radius = tail_disc(a, b, curve, middle, half)
        head = (x + d * cos(middle), y + d * sin(middle), radius + d * half)
        if may_join(a, b, ends, near, (x, y, radius), head):
            first, last = min(first, k), k
    if last < 0:
        return False
    if first > 0:
        curve[NEAR_FROM] = low + first * size
    if last < RANGE_PARTS - 1:
        curve[NEAR_TO] = low + (last + 1) * size
    return True


@inner
def slides_near(a: Array, b: Array, ends: tuple[int, int], near: NearSpots, pair: Array, d: float) -> bool:
    """Whether contacts of a sliding pair may be of interest; its range is cut to where they may."""
    if near.joined.shape[0] == 0:
        return True
    first, last = RANGE_PARTS, -1
    low, size = pair[SLIDE_FROM], (pair[SLIDE_TO] - pair[SLIDE_FROM]) / RANGE_PARTS
    half = 0.5 * size * (1.0 if a[IS_ARC] == 0.0 else a[RADIUS]) + ROUNDING
    for k in range(RANGE_PARTS):
        x, y = point_at(a, low + (k + 0.5) * size)
        head = (x + d * cos(pair[DIRECTION]), y + d * sin(pair[DIRECTION]), half)
        if may_join(a, b, ends, near, (x, y, half), head):
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
    """Whether a chord of a step turned by an angle is at some orientation within (K, 2) ranges, for alpha from
    ``low`` to ``high``; all in radians. It always is where there are none."""
    for k in range(within.shape[0]):
        # Where the range ends, a turn or more before the chord begins there or not.
        end = within[k, 1] + ROUNDING
        end += TURN * ceil((low - angle - end) / TURN)
        if end - (within[k, 1] - within[k, 0]) - 2.0 * ROUNDING <= high - angle:
            return True
    return within.shape[0] == 0


@inner
def any_comes_within(curve: Array, angles: Array, first: int, end: int, within: Array) -> bool:
    """Whether a chord of one of some steps, which are equally long, comes within ranges of orientations."""
    found = False
    for step in range(first, end):
        found = found or comes_within(curve[FROM], curve[TO], angles[step], within)
    return found


@compiled_making_arrays
def tail_curves(
    tail: int,
    features: Array,
    centers: IntArray,
    lengths: Array,
    starts: IntArray,
    steps: IntArray,
    angles: Array,
    near: NearSpots,
    within: Array,
) -> tuple[IntArray, Array, IntArray, Array, Array]:
    """All chords of interest whose tail is on one feature and whose head is on the same feature or one of a
    higher number.

    Parameters
    ----------
    tail : index of the tail's feature.
    features : (F, 10) rows.
    centers : (F,) number of each arc's centre, -1 for lines; concentric arcs share it.
    lengths : (D,) lengths of the lattice steps in mm.
    starts : (D + 1,) where the steps of each length begin.
    steps : (S, 2) column and row differences. Both directions of every step are listed.
    angles : (S,) their directions in radians.
    near : which two stretches of features locators of interest may touch.
    within : (K, 2) ranges of psi in radians in which curves are of interest; none for everywhere.

    Returns
    -------
    (integers, reals, sliding pair integers, sliding pair reals, stretches)
        See ``base.tables``. The orientations of sliding pairs, alpha - shift, are still to be brought into
        range by the caller, and the curves' stretches are counted from 0 for this tail.
    """
    integers, reals = np.empty((256, CURVE_INTEGERS), np.int64), np.empty((256, CURVE_REALS))
    whole, sliding_pairs = np.empty((16, CURVE_INTEGERS), np.int64), np.empty((16, SLIDING_PAIR_REALS))
    stretches = np.empty((64, STRETCH_LENGTH))
    count = sliding_pair_count = stretch_count = int(np.int64(0))
    curve = np.empty(CURVE_REALS)
    a = features[tail]
    for head in range(tail, features.shape[0]):
        b = features[head]
        apart, play = hypot(b[X] - a[X], b[Y] - a[Y]), reach(a) + reach(b)
        center = centers[tail] if centers[tail] == centers[head] else -1
        for length in range(lengths.shape[0]):
            d = lengths[length]
            if d > apart + play + ROUNDING or d < apart - play - ROUNDING:
                continue
            ranges = chord_intervals(a, b, d)
            sliding = sliding_pairs_between(a, b, d)
            slides = 0
            for k in range(sliding.shape[0]):
                if slides_near(a, b, (tail, head), near, sliding[k], d):
                    for column_of in range(3):
                        sliding[slides, column_of] = sliding[k, column_of]
                    slides += 1
            for k in range(ranges.shape[0]):
                write_curve(curve, a, b, d, ranges[k, 2], 0.0)
                curve[FROM], curve[TO] = ranges[k, 0], ranges[k, 1]
                curve[TANGENT_FROM], curve[TANGENT_TO] = ranges[k, 3], ranges[k, 4]
                if not any_comes_within(curve, angles, starts[length], starts[length + 1], within):
                    continue
                if not may_exist(a, b, curve) or not write_near_range(a, b, (tail, head), near, curve):
                    continue
                first = stretch_count
                stretches, stretch_count = add_stretches(stretches, stretch_count, a, b, curve)
                for step in range(starts[length], starts[length + 1]):
                    column, row = steps[step, 0], steps[step, 1]
                    if head == tail and (column < 0 or (column == 0 and row < 0)):
                        continue
                    if not comes_within(curve[NEAR_FROM], curve[NEAR_TO], angles[step], within):
                        continue
                    integers, reals = with_room(integers, count), with_room(reals, count)
                    write_step(integers[count], tail, head, column, row, center)
                    integers[count, FIRST_STRETCH], integers[count, END_STRETCH] = first, stretch_count
                    for k_of in range(CURVE_REALS):
                        reals[count, k_of] = curve[k_of]
                    write_shift(reals[count], angles[step])
                    count += 1
            for step in range(starts[length], starts[length + 1]):
                column, row = steps[step, 0], steps[step, 1]
                if head == tail and (column < 0 or (column == 0 and row < 0)):
                    continue
                for k in range(slides):
                    whole = with_room(whole, sliding_pair_count)
                    sliding_pairs = with_room(sliding_pairs, sliding_pair_count)
                    write_step(whole[sliding_pair_count], tail, head, column, row, center)
                    for column_of in range(3):
                        sliding_pairs[sliding_pair_count, column_of] = sliding[k, column_of]
                    sliding_pairs[sliding_pair_count, STEP_LENGTH] = d
                    sliding_pairs[sliding_pair_count, ORIENTATION] = sliding[k, DIRECTION] - angles[step]
                    sliding_pair_count += 1
    return (
        integers[:count],
        reals[:count],
        whole[:sliding_pair_count],
        sliding_pairs[:sliding_pair_count],
        stretches[:stretch_count],
    )


@inner
def write_step(row: IntArray, tail: int, head: int, column_step: int, row_step: int, center: int) -> None:
    """Writes the whole numbers of a curve or sliding pair."""
    row[TAIL], row[HEAD], row[COLUMN_STEP], row[ROW_STEP] = tail, head, column_step, row_step
    row[CENTER] = center
