"""Sliding pairs: chords that fit at one orientation only and slide there.

Two pegs on parallel lines, or on arcs of equal radius whose centres lie exactly one chord apart, fix the orientation;
the workpiece can still slide along the lines or around the arcs, and the other pegs stop it. Such a chord is not a curve
over the orientation: it stands upright at one. It is met with the other chords by evaluating those there.

Two sliding pairs at one orientation leave the workpiece a freedom that the contacts do not resist, so they never make a
fixture together; nor does a sliding pair whose contacts share one line of action.
"""

from __future__ import annotations

from math import acos, atan2, ceil, cos, floor, hypot, pi, sin

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import PARALLEL, SQUARE
from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.base.given import Features, Lattice, Limits
from workhold.kernels.base.growing import with_room
from workhold.kernels.chord.coincidences import are_one_chord_apart, shares_a_line
from workhold.kernels.chord.evaluation import backward_error, parameter_on
from workhold.kernels.contact.record import (
    PEG_LENGTH,
    PEG_RADIUS,
    PEG_X,
    PEG_Y,
    RECORD_LENGTH,
    place_peg,
    write_record,
)
from workhold.kernels.contact.rules import is_fixture, is_listed, share_a_carrier
from workhold.kernels.crossing.three_and_one import add_moving_pegs, height_range, place_triple, row_meets
from workhold.kernels.crossing.two_and_two import CANDIDATES, CONTACTS, is_among, place_chord
from workhold.kernels.curves.columns import (
    COLUMN_STEP,
    DIRECTION,
    FROM,
    HEAD,
    ORIENTATION,
    ROW_STEP,
    SHIFT,
    SLIDE_FROM,
    SLIDE_TO,
    STEP_LENGTH,
    TAIL,
    TO,
    Curves,
    SlidingPairs,
)

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

TURN = 2.0 * pi
# Rounding of a sliding pair's orientation, and how far outside a curve's range it still counts as inside, in radians.
ROUNDING = 4e-15
INSIDE = 1e-12


@inner
def line_sliding_pairs(a: Array, b: Array, d: float, out: Array) -> int:
    """Write the sliding pairs between two parallel lines as (from, to, alpha) rows; return their number."""
    nx, ny = a[4], -a[3]
    cosine = (nx * (b[1] - a[1]) + ny * (b[2] - a[2])) / d
    if abs(cosine) >= 1.0 - SQUARE:
        return 0
    count = 0
    same = 1.0 if a[3] * b[3] + a[4] * b[4] > 0.0 else -1.0
    for k in range(2):
        alpha = atan2(ny, nx) + (1.0 - 2.0 * k) * acos(cosine)
        # Parameter on b of the head when the tail is in the middle of a; it moves by +-s with the tail.
        middle = same * ((a[1] + d * cos(alpha) - b[1]) * b[3] + (a[2] + d * sin(alpha) - b[2]) * b[4])
        low, high = max(-a[5], -b[5] - middle), min(a[5], b[5] - middle)
        if low <= high:
            out[count, SLIDE_FROM], out[count, SLIDE_TO], out[count, DIRECTION] = low, high, alpha
            count += 1
    return count


@inner
def arc_sliding_pairs(a: Array, b: Array, d: float, out: Array) -> int:
    """Write the sliding pairs between equal arcs one chord apart as (from, to, alpha) rows; return their number."""
    if not are_one_chord_apart(a, b, d):
        return 0
    alpha = atan2(b[2] - a[2], b[1] - a[1])
    turned = atan2(a[3] * b[4] - a[4] * b[3], a[3] * b[3] + a[4] * b[4])
    if b[5] >= pi:
        out[0, SLIDE_FROM], out[0, SLIDE_TO], out[0, DIRECTION] = -a[5], a[5], alpha
        return 1
    count = 0
    for lap in range(-1, 2):
        middle = turned + lap * TURN
        low, high = max(-a[5], middle - b[5]), min(a[5], middle + b[5])
        if low <= high:
            out[count, SLIDE_FROM], out[count, SLIDE_TO], out[count, DIRECTION] = low, high, alpha
            count += 1
    return count


@inner
def sliding_pairs_between(a: Array, b: Array, d: float) -> Array:
    """Sliding pairs of a chord of length d from feature a to feature b.

    Returns
    -------
    (N, 3) array
        Columns: lowest and highest parameter of the tail on a, alpha in radians.
    """
    out = np.empty((4, 3))
    count = 0
    if a[0] == 0.0 and b[0] == 0.0:
        if abs(a[3] * b[4] - a[4] * b[3]) <= PARALLEL:
            count = line_sliding_pairs(a, b, d, out)
    elif a[0] != 0.0 and b[0] != 0.0:
        count = arc_sliding_pairs(a, b, d, out)
    return out[:count]


@inner
def orientation_inside(curve: int, psi: float, reach: float, reals: Array) -> tuple[bool, float]:
    """Whether a curve may exist at an orientation known to ``reach``, and psi moved by whole turns into its range."""
    low, high = reals[curve, FROM] - reals[curve, SHIFT], reals[curve, TO] - reals[curve, SHIFT]
    inside = psi + TURN * ceil((low - INSIDE - reach - psi) / TURN)
    return (inside <= high + INSIDE + reach, min(max(inside, low), high))


@inner
def sliding_pair_reach(a: Array, b: Array, sliding_pair: Array) -> float:
    """How far in radians the orientation of a sliding pair may be off.

    Between lines the distance h across gives the angle off square by cos = h / d, so an error of h counts by 1 / (d sin).
    """
    d = sliding_pair[STEP_LENGTH]
    error = backward_error(a, b, d)
    if a[0] == 0.0:
        nx, ny = a[4], -a[3]
        along = abs(cos(sliding_pair[DIRECTION]) * ny - sin(sliding_pair[DIRECTION]) * nx)
        tilt = abs(a[3] * b[4] - a[4] * b[3]) + ROUNDING
        return ROUNDING + (error + tilt * (a[5] + b[5] + d)) / (d * max(along, 1e-8))
    return ROUNDING + (error + 4.0 * (abs(hypot(b[1] - a[1], b[2] - a[2]) - d) + abs(a[6] - b[6]))) / d


@inner
def place_sliding_pair(
    pegs: Array,
    x: float,
    y: float,
    line: float,
    whole: IntArray,
    sliding_pair: Array,
    radius: float,
    reach: float,
) -> None:
    """Write the pegs of a sliding pair to (2, 6) places, with its tail at (x, y) in row ``line`` of column 0."""
    alpha, d = sliding_pair[DIRECTION], sliding_pair[STEP_LENGTH]
    place_peg(pegs[0], x, y, whole[TAIL], 0.0, line, radius)
    place_peg(
        pegs[1],
        x + d * cos(alpha),
        y + d * sin(alpha),
        whole[HEAD],
        float(whole[COLUMN_STEP]),
        line + whole[ROW_STEP],
        radius + d * reach,
    )


@inner
def tail_inside(row: Array, sliding_pair: Array, x: float, y: float, radius: float) -> bool:
    """Whether a tail known to a radius in mm may lie in a sliding pair's range on its feature."""
    spare = radius + 1e-10
    if row[0] != 0.0:
        spare = 1.2 * spare / row[6]
    s = parameter_on(row, x, y)
    return sliding_pair[SLIDE_FROM] - spare <= s <= sliding_pair[SLIDE_TO] + spare


@compiled
def sliding_two_and_two(
    chosen: IntArray,
    sliding_pairs: SlidingPairs,
    members: IntArray,
    features: Features,
    curves: Curves,
    lattice: Lattice,
    limits: Limits,
    counting: bool,
    stats: IntArray,
) -> Array:
    """All fixtures of two and two pegs that rest on one of the ``chosen`` sliding pairs and on a curve of ``members``.

    Parameters and result as for ``two_and_two_cells``.
    """
    out = np.empty((16, RECORD_LENGTH))
    count = int(np.int64(0))
    pegs, work, null = np.empty((4, PEG_LENGTH)), np.empty((8, 2)), np.empty(4)
    loose, rows, pitch_y = features.loose, features.rows, lattice.pitch_y
    for u in chosen:
        whole, sliding_pair = sliding_pairs.integers[u], sliding_pairs.reals[u]
        psi = sliding_pair[ORIENTATION]
        ax, ay = -sin(psi), cos(psi)
        row = loose[whole[TAIL]]
        reach = sliding_pair_reach(row, loose[whole[HEAD]], sliding_pair)
        lowest, highest = height_range(row, ax, ay)
        for curve in members:
            exists, inside = orientation_inside(curve, psi, reach, curves.reals)
            if not exists or shares_a_line(curves.reals[curve], inside):
                continue
            tail = curves.integers[curve, TAIL]
            place_chord(pegs[:2], curve, inside, 2.0 * reach + INSIDE, 0.0, rows, curves)
            height = ax * pegs[0, PEG_X] + ay * pegs[0, PEG_Y]
            error = pegs[0, PEG_RADIUS] + 4.0 * limits.wrench_length * reach
            slack = 1e-9 + error / pitch_y
            for order in range(2):
                # The sliding pair stands still for order 0, and is on the moving carrier for order 1.
                one, two = (whole[TAIL], tail) if order == 0 else (tail, whole[TAIL])
                if not (is_among(one, features.standing) and is_among(two, features.moving)):
                    continue
                sign = 1.0 if order == 0 else -1.0
                base = height - sign * lattice.row_offset
                first = int(ceil((lowest - base) / pitch_y - slack))
                last = int(floor((highest - base) / pitch_y + slack))
                for line in range(first, last + 1):
                    for k in range(2):
                        meets, x, y, radius = row_meets(row, ax, ay, base + line * pitch_y, error, 1.0 - 2.0 * k)
                        if not meets or not tail_inside(row, sliding_pair, x, y, radius):
                            continue
                        # The first peg of the standing chord is in row 0.
                        slid, turned = (0.0, float(-line)) if order == 0 else (float(line), 0.0)
                        at, other = 2 * order, 2 - 2 * order
                        place_sliding_pair(pegs[at : at + 2], x, y, slid, whole, sliding_pair, radius, reach)
                        place_chord(pegs[other : other + 2], curve, inside, 2.0 * reach + INSIDE, turned, rows, curves)
                        verdict, separation = is_fixture(pegs, 2.0, psi, reach, features, limits, work, null)
                        stats[CANDIDATES] += 1
                        if verdict > 0 and order == 0:
                            stats[CONTACTS] += 1
                        if is_listed(verdict, counting, count, limits):
                            out = with_room(out, count)
                            write_record(out[count], 2.0, pegs, psi, separation, reach)
                            count += 1
    return out[:count]


@compiled
def sliding_three_and_one(
    chosen: IntArray,
    sliding_pairs: SlidingPairs,
    members: IntArray,
    features: Features,
    curves: Curves,
    lattice: Lattice,
    limits: Limits,
    counting: bool,
    stats: IntArray,
) -> Array:
    """All fixtures of three and one peg two of whose standing pegs form one of the ``chosen`` sliding pairs from the shared
    tail.

    Parameters and result as for ``two_and_two_cells``.
    """
    out = np.empty((16, RECORD_LENGTH))
    count = int(np.int64(0))
    pegs, work, null = np.empty((4, PEG_LENGTH)), np.empty((8, 2)), np.empty(4)
    loose = features.loose
    for u in chosen:
        whole, sliding_pair = sliding_pairs.integers[u], sliding_pairs.reals[u]
        psi, tail = sliding_pair[ORIENTATION], whole[TAIL]
        if not is_among(tail, features.standing):
            continue
        reach = sliding_pair_reach(loose[tail], loose[whole[HEAD]], sliding_pair)
        for curve in members:
            if curves.integers[curve, TAIL] != tail:
                continue
            exists, inside = orientation_inside(curve, psi, reach, curves.reals)
            if not exists or not share_a_carrier(whole, curves.integers[curve], limits):
                continue
            if shares_a_line(curves.reals[curve], inside):
                continue
            place_triple(pegs, curve, curve, inside, 2.0 * reach + INSIDE, features.rows, curves)
            x, y, radius = pegs[0, PEG_X], pegs[0, PEG_Y], pegs[0, PEG_RADIUS]
            if not tail_inside(loose[tail], sliding_pair, x, y, radius):
                continue
            place_sliding_pair(pegs[:2], x, y, 0.0, whole, sliding_pair, radius, reach)
            out, count = add_moving_pegs(
                out, count, pegs, psi, reach, features, lattice, limits, counting, work, null, stats
            )
    return out[:count]
