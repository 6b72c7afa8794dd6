r"""Peg pairs that fix the orientation while the part can slide, so that the resultant has no information about
the other pegs.

Two pegs of one jaw on parallel lines, or on equal arcs whose centres are exactly as far apart as the pegs,
fix the orientation by themselves. The part can still move along the lines or around the arcs until the other
pegs stop it. In the resultant such a pair is a factor without information about the others, and it is divided
out. So the pair gives the orientation, and the other contacts give the rest of the pose at that orientation,
by intersecting two circles or lines at a time. One measure, ``ContactSystems.compute_arc_misfit``, decides
what is divided out and what is listed here.

Two such pairs at one orientation leave the part a freedom that no contact resists, so they never form a
fixture together.

The resultant of Type I is also useless if both jaws touch the same two lines or circles with the same step,
level with each other. Pegs in the same place (separation 0) fit at every orientation. In fixtures of this
kind the jaws' pegs are in the two different places that an orientation allows, and these are level at a few
orientations only.
"""

from __future__ import annotations

from math import ceil, floor

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.algebra.candidates import PegPairs, are_parallel, find_sector
from workhold.algebra.conditions import STEEPEST, SimultaneousContacts, find_row_points
from workhold.algebra.resultants import Complex, ContactSystems
from workhold.contact.problem import SearchFrame
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
    "are_alike_on_both_jaws",
    "find_level_orientations",
    "intersect_carriers",
    "find_sliding_pairs",
    "find_three_and_one_contacts",
    "find_two_and_two_contacts",
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
    pair : its index among the peg pairs.
    psi : the orientation in radians.
    error : by how much in mm the two contacts may miss the exact condition for sliding together.
    """

    pair: int
    psi: float
    error: float


def compute_pair_step(pairs: PegPairs, k: int, frame: SearchFrame) -> complex:
    """Return the step from the first to the second peg of pair k as a complex number in mm."""
    return complex(pairs.column[k] * frame.lattice.pitch_x, pairs.row[k] * frame.lattice.pitch_y)


def find_sliding_pairs(
    pairs: PegPairs, scaled: Array, frame: SearchFrame, diameter: float
) -> list[SlidingPair]:
    """Return all peg pairs that fix the orientation, one entry for each orientation.

    ``scaled`` are the features (F, 10) with lengths as fractions of the part's size, which is ``diameter`` in
    mm. See ``kernels.base.feature`` for the layout of rows.
    """
    step = (pairs.column * frame.lattice.pitch_x + 1j * pairs.row * frame.lattice.pitch_y) / diameter
    contacts = ContactSystems(
        scaled[np.stack([pairs.tail, pairs.head], axis=1)], np.stack([0.0 * step, step], axis=1)
    )
    between, rows = contacts.middle[:, 1] - contacts.middle[:, 0], contacts.rows
    misfit = contacts.compute_arc_misfit(0, 1)
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


def bound_orientation_error(
    sliding_pair: SlidingPair, row: Array, point: Complex, step: complex, slope: Array
) -> Array:
    """Return an error bound in radians of the orientation of a sliding pair, (N,).

    An error e of the contacts turns the pegs by e divided by the distance between their two lines of action.

    Parameters
    ----------
    row : feature of the first peg.
    point : (N,) places of the first peg as complex numbers.
    step : from the first peg to the second, turned by the orientation, in mm.
    slope : (N,) factors on the error: bounds of the first peg's movement when the curves that determine its
        place move by 1.
    """
    normal = (
        row[AXIS_Y] - 1j * row[AXIS_X] if row[IS_ARC] == 0.0 else (point - row[X] - 1j * row[Y]) / row[RADIUS]
    )
    arm = np.maximum(np.abs((np.conj(normal) * step).imag), abs(step) / STEEPEST)
    return np.asarray(
        np.clip(2.0 * sliding_pair.error / arm * slope, LEAST_SLIDING_REACH, MOST_SLIDING_REACH)
    )


def intersect_carriers(a: Array, b: Array, shift: complex) -> list[tuple[complex, float]]:
    """Return the points of the line or circle of feature ``a`` that lie, after a move by ``shift``, on the
    line or circle of feature ``b``.

    There are up to two. Each is a pair (point as a complex number, bound of the point's movement when either
    line or circle moves by 1).
    """
    one, two = complex(a[X], a[Y]), complex(b[X], b[Y]) - shift
    if a[IS_ARC] == 0.0 and b[IS_ARC] == 0.0:
        turn = a[AXIS_X] * b[AXIS_Y] - a[AXIS_Y] * b[AXIS_X]
        if abs(turn) <= PARALLEL:
            return []
        off = two - one
        along = (off.real * b[AXIS_Y] - off.imag * b[AXIS_X]) / turn
        return [(one + along * complex(a[AXIS_X], a[AXIS_Y]), bound_steepness(1.0, abs(turn)))]
    if a[IS_ARC] == 0.0:
        return intersect_line_with_circle(one, complex(a[AXIS_X], a[AXIS_Y]), two, b[RADIUS])
    if b[IS_ARC] == 0.0:
        return intersect_line_with_circle(two, complex(b[AXIS_X], b[AXIS_Y]), one, a[RADIUS])
    gap = abs(two - one)
    if gap <= COINCIDENT * (a[RADIUS] + b[RADIUS]):
        return []
    along = (gap + (a[RADIUS] - b[RADIUS]) * (a[RADIUS] + b[RADIUS]) / gap) / 2.0
    if abs(along) >= a[RADIUS]:
        return []
    half = ((a[RADIUS] - along) * (a[RADIUS] + along)) ** 0.5
    direction = (two - one) / gap
    slope = bound_steepness(a[RADIUS] * b[RADIUS], half * gap)
    return [(one + direction * complex(along, sign * half), slope) for sign in (1.0, -1.0)]


def bound_steepness(size: float, across: float) -> float:
    """Return a bound, at most ``STEEPEST``, of the movement of a meeting point of two curves when the curves
    move by 1.

    The bound is 3 ``size`` / ``across``: ``across`` is small against ``size`` if the curves meet at a small
    angle.
    """
    return min(3.0 * size / max(across, size / STEEPEST), STEEPEST)


def intersect_line_with_circle(
    point: complex, tangent: complex, center: complex, radius: float
) -> list[tuple[complex, float]]:
    """Return the two points where a line meets a circle, in the form of :func:`intersect_carriers`; an empty list for a
    tangent or a miss.

    The line goes through ``point`` with the unit direction ``tangent``. (At a tangency the contacts carry no
    force that holds.)
    """
    off = (point - center) * tangent.conjugate()
    if abs(off.imag) >= radius:
        return []
    half = ((radius - off.imag) * (radius + off.imag)) ** 0.5
    slope = bound_steepness(radius, half)
    return [(center + tangent * complex(sign * half, off.imag), slope) for sign in (1.0, -1.0)]


def find_two_and_two_contacts(
    pairs: PegPairs, sliding_pairs: list[SlidingPair], rows: Array, frame: SearchFrame
) -> list[SimultaneousContacts]:
    """Return the simultaneous contacts of a left pair that slides and a right pair that stops it.

    Contacts with a sliding right pair need no separate search: they are the same after a half turn.
    """
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
            for point, steep in intersect_carriers(rows[c], rows[d], step):
                line, tail, slope = find_stopping_rows(rows[a], sliding_pair.psi, (point / z).imag, frame)
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
                        bound_orientation_error(
                            sliding_pair, rows[a], tail, own, np.minimum(steep * slope, STEEPEST)
                        ),
                        center,
                    )
                )
    return found


def find_stopping_rows(
    row: Array, psi: float, height: float, frame: SearchFrame
) -> tuple[IntArray, Complex, Array]:
    """Return the places of the first left peg on its feature at which
    the first right peg is in a row of holes.

    Parameters
    ----------
    row : the left peg's feature.
    psi : orientation in radians.
    height : height of the first right peg along the frame's y axis, in mm.

    Returns
    -------
    (rows (M,) of the first right peg, counted from the first left peg; places (M,) of the left peg as complex
        numbers; bounds (M,) of their movement per change of height or orientation)
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


def find_three_and_one_contacts(
    pairs: PegPairs, sliding_pairs: list[SlidingPair], rows: Array, frame: SearchFrame
) -> list[SimultaneousContacts]:
    """Return the simultaneous contacts of a left pair that slides and a third left peg that stops it.

    The third peg may come before, between or after the two pegs of the pair in the order of pegs.
    """
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
            for point, slope in intersect_carriers(rows[a], rows[c], third):
                places = np.array([[point, point + own, point + third]])
                found.append(
                    SimultaneousContacts(
                        3,
                        np.array([[a, b, c]]),
                        np.array([[0, pairs.column[i], column]]),
                        np.array([[0, pairs.row[i], row]]),
                        np.array([sliding_pair.psi]),
                        bound_orientation_error(sliding_pair, rows[a], places[:, 0], own, np.array([slope])),
                        places,
                    )
                )
    return found


def list_third_pegs(pairs: PegPairs, tail: int) -> list[tuple[int, int, int]]:
    """Return (feature, column step, row step) of pegs that can stand
    beside a peg on feature ``tail``, before or after it.
    """
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


def are_alike_on_both_jaws(contacts: ContactSystems) -> NDArray[np.bool_]:
    """Return, for each system, whether both jaws touch the same lines or circles with the same step at one
    level, (N,)."""
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
    """Return the orientations at which both places that two pegs can have on their features are level.

    The systems are those for which :func:`are_alike_on_both_jaws` is True. Return (indices of systems, psi in
    radians). The places are mirror images in the line (of the second peg) or in the line through the circles'
    centres (with the pegs brought together). So either the line is level, Re(n* z) = 0, or that line of
    centres is upright, Re(x + D / z) = 0. Here x is the step, and D the vector from the second centre to the
    first. Two lines allow only one place, and so no fixture.
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
