r"""Peg pairs at which the resultant says nothing: the orientation is fixed and the part slides.

Two pegs of one jaw on parallel lines, or on equal arcs whose centres are exactly as far apart as the pegs,
fix the orientation by themselves. Along the lines, or around the arcs, the part is free, and the other pegs
stop it. In the resultant such a pair is a factor that carries no information about the others, and is divided
out. So the orientation is taken from the pair, and the rest of the pose from the other contacts at that
orientation: two circles or lines met at a time. One measure, ``ContactSystems.misfit``, decides what is
divided out and what is listed here.

Two such pairs at one orientation leave the part a freedom no contact resists, and never make a fixture
together.

The resultant of Type I also says nothing when both jaws hold the same two lines or circles with the same
step, level with each other. Pegs in the same place (separation 0) fit at every orientation. The fixtures
among these have the jaws' pegs in the two different places that an orientation allows, which are level at a
few orientations only.
"""

from __future__ import annotations

from math import ceil, floor

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.algebra.candidates import PegPairs, are_parallel, find_sector
from workhold.algebra.conditions import STEEPEST, SimultaneousContacts, find_row_points
from workhold.algebra.resultants import Complex, ContactSystems
from workhold.contact.problem import Frame
from workhold.conventions import (
    COINCIDENT,
    LEAST_SLIDING_REACH,
    MISFIT_ROUNDING,
    MOST_SLIDING_REACH,
    PARALLEL,
    ROW_SLACK,
    SQUARE,
)
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, X, Y

__all__ = [
    "SlidingPair",
    "alike",
    "find_level_orientations",
    "meets",
    "find_sliding_pairs",
    "three_and_one_sliding_pairs",
    "two_and_two_sliding_pairs",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Arcs are listed up to this many times the misfit at which they are divided out, so that the rounding of a
# misfit that lies on that edge cannot lose a pair.
SPARE = 2.0


@define(frozen=True)
class SlidingPair:
    """A peg pair that fixes the orientation.

    Parameters
    ----------
    pair : its index.
    psi : the orientation in radians.
    error : by how much in mm its two contacts may be off from sliding together.
    """

    pair: int
    psi: float
    error: float


def compute_pair_step(pairs: PegPairs, k: int, frame: Frame) -> complex:
    """Step between the pegs of a pair as a complex number in mm."""
    return complex(pairs.column[k] * frame.lattice.pitch_x, pairs.row[k] * frame.lattice.pitch_y)


def find_sliding_pairs(pairs: PegPairs, scaled: Array, frame: Frame, diameter: float) -> list[SlidingPair]:
    """All peg pairs that fix the orientation, once for each orientation.

    Features (F, 10) have lengths in parts of the part's size, which is ``diameter`` in mm.
    """
    step = (pairs.column * frame.lattice.pitch_x + 1j * pairs.row * frame.lattice.pitch_y) / diameter
    contacts = ContactSystems(
        scaled[np.stack([pairs.tail, pairs.head], axis=1)], np.stack([0.0 * step, step], axis=1)
    )
    between, rows = contacts.middle[:, 1] - contacts.middle[:, 0], contacts.rows
    misfit = contacts.misfit(0, 1)
    arcs = np.flatnonzero(misfit <= SPARE * COINCIDENT)
    cosine = (np.conj(contacts.normal[:, 0]) * between).real / np.abs(step)
    lines = np.flatnonzero(are_parallel(scaled, pairs.tail, pairs.head) & (np.abs(cosine) < 1.0 - SQUARE))
    turn = np.abs(rows[lines, 0, 3] * rows[lines, 1, 4] - rows[lines, 0, 4] * rows[lines, 1, 3])
    apart = turn * (rows[lines, :, HALF_EXTENT].sum(axis=1) + np.abs(step[lines]))
    middle, spread = np.angle(contacts.normal[lines, 0] / step[lines]), np.arccos(cosine[lines])
    pair = np.concatenate([arcs, lines, lines])
    psi = np.concatenate([np.angle(between[arcs] / step[arcs]), middle + spread, middle - spread])
    error = (np.concatenate([misfit[arcs], apart, apart]) + MISFIT_ROUNDING) * diameter
    order = np.argsort(pair, kind="stable")
    return [SlidingPair(int(pair[k]), float(psi[k]), float(error[k])) for k in order]


def reach_of(sliding_pair: SlidingPair, row: Array, point: Complex, step: complex, slope: Array) -> Array:
    """How far in radians the orientation of a sliding pair may be off, (N,).

    Contacts that miss by e turn the pegs by e over the distance between their two lines of action. The step
    leads from the first peg to the second, turned by the orientation, in mm. ``slope`` is how much farther
    the contacts move than the pegs turn, see :func:`find_row_points`.
    """
    normal = (
        row[AXIS_Y] - 1j * row[AXIS_X] if row[IS_ARC] == 0.0 else (point - row[X] - 1j * row[Y]) / row[RADIUS]
    )
    arm = np.maximum(np.abs((np.conj(normal) * step).imag), abs(step) / STEEPEST)
    return np.asarray(
        np.clip(2.0 * sliding_pair.error / arm * slope, LEAST_SLIDING_REACH, MOST_SLIDING_REACH)
    )


def meets(a: Array, b: Array, shift: complex) -> list[tuple[complex, float]]:
    """Points of feature a's line or circle whose shifted image is on feature b's, and how far they move.

    There are none, one or two; they move when either line or circle does.
    """
    one, two = complex(a[X], a[Y]), complex(b[X], b[Y]) - shift
    if a[IS_ARC] == 0.0 and b[IS_ARC] == 0.0:
        turn = a[AXIS_X] * b[AXIS_Y] - a[AXIS_Y] * b[AXIS_X]
        if abs(turn) <= PARALLEL:
            return []
        off = two - one
        along = (off.real * b[AXIS_Y] - off.imag * b[AXIS_X]) / turn
        return [(one + along * complex(a[AXIS_X], a[AXIS_Y]), steepness(1.0, abs(turn)))]
    if a[IS_ARC] == 0.0:
        return line_meets_circle(one, complex(a[AXIS_X], a[AXIS_Y]), two, b[RADIUS])
    if b[IS_ARC] == 0.0:
        return line_meets_circle(two, complex(b[AXIS_X], b[AXIS_Y]), one, a[RADIUS])
    gap = abs(two - one)
    if gap <= COINCIDENT * (a[RADIUS] + b[RADIUS]):
        return []
    along = (gap + (a[RADIUS] - b[RADIUS]) * (a[RADIUS] + b[RADIUS]) / gap) / 2.0
    if abs(along) >= a[RADIUS]:
        return []
    half = ((a[RADIUS] - along) * (a[RADIUS] + along)) ** 0.5
    direction = (two - one) / gap
    slope = steepness(a[RADIUS] * b[RADIUS], half * gap)
    return [(one + direction * complex(along, sign * half), slope) for sign in (1.0, -1.0)]


def steepness(size: float, across: float) -> float:
    """A bound of how much a meeting point moves when what meets there does, at most ``STEEPEST``."""
    return min(3.0 * size / max(across, size / STEEPEST), STEEPEST)


def line_meets_circle(
    point: complex, tangent: complex, center: complex, radius: float
) -> list[tuple[complex, float]]:
    """Where a line through a point meets a circle; none for a tangent, which carries no force."""
    off = (point - center) * tangent.conjugate()
    if abs(off.imag) >= radius:
        return []
    half = ((radius - off.imag) * (radius + off.imag)) ** 0.5
    slope = steepness(radius, half)
    return [(center + tangent * complex(sign * half, off.imag), slope) for sign in (1.0, -1.0)]


def two_and_two_sliding_pairs(
    pairs: PegPairs, sliding_pairs: list[SlidingPair], rows: Array, frame: Frame
) -> list[SimultaneousContacts]:
    """Left pairs that slide, stopped by a right pair (sliding right pairs are these after a half turn)."""
    found = []
    sectors = pairs.sectors
    for sliding_pair in sliding_pairs:
        i, z = sliding_pair.pair, complex(np.exp(1j * sliding_pair.psi))
        a, b = int(pairs.tail[i]), int(pairs.head[i])
        own = z * compute_pair_step(pairs, i, frame)
        sector = int(find_sector(np.array(sliding_pair.psi)))
        near = sectors[:, sector] | sectors[:, sector - 1] | sectors[:, (sector + 1) % sectors.shape[1]]
        for j in np.flatnonzero(near):
            c, d = int(pairs.tail[j]), int(pairs.head[j])
            step = z * compute_pair_step(pairs, int(j), frame)
            for point, steep in meets(rows[c], rows[d], step):
                line, tail, slope = stopped(rows[a], sliding_pair.psi, (point / z).imag, frame)
                if len(line) == 0:
                    continue
                zero = np.zeros(len(line), np.int64)
                center = np.stack([tail, tail + own, zero + point, zero + point + step], axis=1)
                found.append(
                    SimultaneousContacts(
                        2,
                        np.stack([zero + a, zero + b, zero + c, zero + d], axis=1),
                        np.stack([zero, zero + pairs.column[i], zero, zero + pairs.column[j]], axis=1),
                        np.stack([zero, zero + pairs.row[i], line, line + pairs.row[j]], axis=1),
                        np.full(len(line), sliding_pair.psi),
                        reach_of(sliding_pair, rows[a], tail, own, np.minimum(steep * slope, STEEPEST)),
                        center,
                    )
                )
    return found


def stopped(row: Array, psi: float, height: float, frame: Frame) -> tuple[IntArray, Complex, Array]:
    """Rows of the first right peg, places of the first left peg on its feature, and how far they move.

    Rows are counted from the first left peg. Places move when the height or the orientation does. ``height``
    is the place of the first right peg along the frame's y axis in mm.
    """
    middle = ((row[X] + 1j * row[Y]) * np.exp(-1j * psi)).imag
    tangent = ((row[AXIS_X] + 1j * row[AXIS_Y]) * np.exp(-1j * psi)).imag
    reach = abs(row[HALF_EXTENT] * tangent) if row[IS_ARC] == 0.0 else row[RADIUS]
    pitch = frame.lattice.pitch_y
    first = ceil((height - frame.lattice.row_offset - middle - reach) / pitch - ROW_SLACK)
    last = floor((height - frame.lattice.row_offset - middle + reach) / pitch + ROW_SLACK)
    line = np.arange(first, last + 1)
    index, point, slope = find_row_points(
        row, np.full(len(line), psi), height - frame.lattice.row_offset - line * pitch
    )
    return line[index], point, slope


def three_and_one_sliding_pairs(
    pairs: PegPairs, sliding_pairs: list[SlidingPair], rows: Array, frame: Frame
) -> list[SimultaneousContacts]:
    """Left pairs that slide, stopped by a third left peg anywhere in the order of pegs."""
    found = []
    most = frame.standing.column_count - 1
    for sliding_pair in sliding_pairs:
        i, z = sliding_pair.pair, complex(np.exp(1j * sliding_pair.psi))
        a, b, own = int(pairs.tail[i]), int(pairs.head[i]), z * compute_pair_step(pairs, i, frame)
        for c, column, row in list_third_pegs(pairs, a):
            spread = (0, int(pairs.column[i]), column)
            if (column, row) in ((0, 0), (int(pairs.column[i]), int(pairs.row[i]))) or max(spread) - min(
                spread
            ) > most:
                continue
            third = z * complex(column * frame.lattice.pitch_x, row * frame.lattice.pitch_y)
            for point, slope in meets(rows[a], rows[c], third):
                places = np.array([[point, point + own, point + third]])
                found.append(
                    SimultaneousContacts(
                        3,
                        np.array([[a, b, c]]),
                        np.array([[0, pairs.column[i], column]]),
                        np.array([[0, pairs.row[i], row]]),
                        np.array([sliding_pair.psi]),
                        reach_of(sliding_pair, rows[a], places[:, 0], own, np.array([slope])),
                        places,
                    )
                )
    return found


def list_third_pegs(pairs: PegPairs, tail: int) -> list[tuple[int, int, int]]:
    """Features and steps (columns, rows) of pegs that can stand beside a peg, before or after it."""
    after = [
        (int(h), int(k), int(m))
        for t, h, k, m in zip(pairs.tail, pairs.head, pairs.column, pairs.row, strict=True)
        if t == tail
    ]
    before = [
        (int(t), -int(k), -int(m))
        for t, h, k, m in zip(pairs.tail, pairs.head, pairs.column, pairs.row, strict=True)
        if h == tail
    ]
    return after + before


def alike(contacts: ContactSystems) -> NDArray[np.bool_]:
    """Which systems (N,) have the same lines or circles and the same step on both jaws, at one level."""
    rows, point = contacts.rows, contacts.point
    same = np.abs(point[:, 2]) + np.abs(point[:, 3] - point[:, 1]) <= COINCIDENT
    for k in range(2):
        one, two = rows[:, k], rows[:, k + 2]
        off = two[:, 1:3] - one[:, 1:3]
        across = off[:, 0] * one[:, AXIS_Y] - off[:, 1] * one[:, AXIS_X]
        turn = one[:, AXIS_X] * two[:, AXIS_Y] - one[:, AXIS_Y] * two[:, AXIS_X]
        lines = (one[:, IS_ARC] == 0.0) & (np.abs(across) <= COINCIDENT) & (np.abs(turn) <= PARALLEL)
        misfit = np.abs(off).max(axis=1) + np.abs(two[:, RADIUS] - one[:, RADIUS])
        circles = (one[:, IS_ARC] != 0.0) & (misfit <= COINCIDENT)
        same &= (one[:, IS_ARC] == two[:, IS_ARC]) & (lines | circles)
    return np.asarray(same)


def find_level_orientations(contacts: ContactSystems) -> tuple[IntArray, Array]:
    """Orientations at which the two places of such a pair are level: (indices of systems, psi in radians).

    The places are mirror images in the line (second peg) or in the line through the circles' centres (pegs
    brought together). So either the line is level, Re(n* z) = 0, or that line of centres is upright, Re(x + D
    / z) = 0. There x is the step, and D the vector from the second centre to the first. Lines alone have one
    place, and so no fixture.
    """
    first = np.flatnonzero(contacts.rows[:, 0, IS_ARC] != 0.0)
    line = first[contacts.rows[first, 1, 0] == 0.0]
    turn = np.angle(contacts.normal[line, 1])
    owners, found = [line, line], [turn + np.pi / 2, turn - np.pi / 2]
    both = first[contacts.rows[first, 1, 0] != 0.0]
    between = contacts.middle[both, 0] - contacts.middle[both, 1]
    size = np.abs(between)
    cosine = -contacts.point[both, 1].real / np.where(size == 0.0, 1e-300, size)
    fits = np.abs(cosine) < 1.0
    both, middle, spread = both[fits], np.angle(between[fits]), np.arccos(cosine[fits])
    owners += [both, both]
    found += [middle + spread, middle - spread]
    return np.concatenate(owners), np.concatenate(found)
