"""Three parallel forces: two pegs of one jaw on a line and an arc, with parallel normals, and a third on a parallel line.

There the chord of the two is a tangency, and its instant centre infinitely far. S depends on the orientation alone, because
two of the three lie on parallel lines, and the orientation has an extremum along the chord's curve: so S has one too.
"""

from __future__ import annotations

from itertools import permutations, product
from math import atan2, cos, hypot, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import PARALLEL
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, X, Y
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CONTACTS,
    MOTION,
    PEG,
    PIECE,
    PLACE_X,
    PLACE_Y,
    SECOND,
    SEPARATION,
    THETA,
)
from workhold.seating.locus import Locus, contains
from workhold.seating.pattern import Pattern

__all__ = ["at_tangencies"]

Array = NDArray[np.float64]
# Radians by which the orientation is changed to see on which side the chord goes on.
STEP = 1e-6


def at_tangencies(locus: Locus, pattern: Pattern) -> list[Array]:
    """Candidates of all pairs of pegs of one jaw, lines and arcs, with a third peg on a line parallel to the first."""
    out = []
    for i, j in permutations(range(4), 2):
        if pattern.right[i] != pattern.right[j]:
            continue
        dx, dy = pattern.pegs[j] - pattern.pegs[i]
        others = [k for k in range(4) if pattern.right[k] != pattern.right[i]]
        for a, b, tail, alpha in chords_at_tangencies(locus, hypot(dx, dy), int(pattern.right[i])):
            theta = atan2(dy, dx) - alpha
            for k, c in product(others, parallels(locus)[a]):
                if locus.fits(pattern.right[k], c):
                    out += with_third(locus, pattern, theta, tail, (i, j, k), (a, b, c), hypot(dx, dy))
    return out


def parallels(locus: Locus) -> dict[int, list[int]]:
    """Numbers of the other lines parallel to each line that has some."""
    if not locus.parallels:
        lines = np.flatnonzero(locus.rows[:, IS_ARC] == 0.0).tolist()
        found = {a: [c for c in lines if c != a and parallel(locus.rows[a], locus.rows[c])] for a in lines}
        locus.parallels.update((a, others) for a, others in found.items() if others)
    return locus.parallels


def chords_at_tangencies(locus: Locus, d: float, jaw: int) -> list[tuple[int, int, tuple[float, float], float]]:
    """Lines, arcs, tails and directions of the chords of a length that are tangencies, for pegs of a jaw."""
    key = round(d, 9), jaw
    if key not in locus.tangents:
        arcs = [b for b in np.flatnonzero(locus.rows[:, IS_ARC] != 0.0).tolist() if locus.fits(jaw, b)]
        lines = [a for a in parallels(locus) if locus.fits(jaw, a)]
        locus.tangents[key] = [
            (a, b, tail, alpha)
            for a, b, side in product(lines, arcs, (1.0, -1.0))
            for tail, alpha in tangencies(locus.rows[a], locus.rows[b], d, side)
        ]
    return locus.tangents[key]


def parallel(one: Array, two: Array) -> bool:
    """Whether two lines are parallel."""
    return bool(abs(one[AXIS_X] * two[AXIS_Y] - one[AXIS_Y] * two[AXIS_X]) <= PARALLEL)


def tangencies(line: Array, arc: Array, d: float, side: float) -> list[tuple[tuple[float, float], float]]:
    """Tails on a line and directions of the chords of length d to the place of an arc whose normal is the line's."""
    nx, ny = line[AXIS_Y], -line[AXIS_X]
    x, y = arc[X] + side * arc[RADIUS] * nx, arc[Y] + side * arc[RADIUS] * ny
    rise = (x - line[X]) * nx + (y - line[Y]) * ny
    if abs(rise) >= d or not contains(arc, x, y):
        return []
    found = []
    for run in (sqrt(d * d - rise * rise), -sqrt(d * d - rise * rise)):
        wx, wy = rise * nx + run * line[AXIS_X], rise * ny + run * line[AXIS_Y]
        if contains(line, x - wx, y - wy):
            found.append(((x - wx, y - wy), atan2(wy, wx)))
    return found


def separation(pattern: Pattern, theta: float, line: Array, other: Array, first: int, third: int) -> float | None:
    """S at which two pegs, of both jaws, lie on two parallel lines at an orientation; None where the lines are level."""
    nx = cos(theta) * line[AXIS_Y] + sin(theta) * line[AXIS_X]
    ny = sin(theta) * line[AXIS_Y] - cos(theta) * line[AXIS_X]
    moving = nx * float(pattern.right[third] - pattern.right[first])
    if abs(moving) < 1e-9:
        return None
    gap = (other[X] - line[X]) * line[AXIS_Y] - (other[Y] - line[Y]) * line[AXIS_X]
    run, rise = pattern.pegs[third] - pattern.pegs[first]
    return float((gap - run * nx - rise * ny) / moving)


def with_third(
    locus: Locus,
    pattern: Pattern,
    theta: float,
    tail: tuple[float, float],
    pegs: tuple[int, int, int],
    pieces: tuple[int, int, int],
    d: float,
) -> list[Array]:
    """The candidate with a third peg on a line, if it is there."""
    line, arc, other = (locus.rows[piece] for piece in pieces)
    s = separation(pattern, theta, line, other, pegs[0], pegs[2])
    if s is None or not pattern.reaches(s):
        return []
    c, e = cos(theta), sin(theta)
    run, rise = pattern.pegs[pegs[2]] - pattern.pegs[pegs[0]]
    run += s * float(pattern.right[pegs[2]] - pattern.right[pegs[0]])
    if not contains(other, tail[0] + c * run + e * rise, tail[1] + c * rise - e * run):
        return []
    row = np.zeros(CANDIDATE_LENGTH)
    start = pattern.pegs[pegs[0]] + [s * pattern.right[pegs[0]], 0.0]
    row[THETA], row[SEPARATION], row[CONTACTS] = theta, s, 3.0
    row[PLACE_X], row[PLACE_Y] = start[0] - (c * tail[0] - e * tail[1]), start[1] - (e * tail[0] + c * tail[1])
    row[PEG : PEG + 4], row[PIECE : PIECE + 4] = [*pegs, -1], [*pieces, -1]
    # The chord goes on to the side on which the arc is met.
    one, two = pattern.pegs[pegs[1]] - pattern.pegs[pegs[0]]
    nx, ny = line[AXIS_Y], -line[AXIS_X]
    turn = -STEP
    for step in (STEP, -STEP):
        alpha = atan2(two, one) - (theta + step)
        wx, wy = d * cos(alpha), d * sin(alpha)
        if abs((line[X] + wx - arc[X]) * nx + (line[Y] + wy - arc[Y]) * ny) < arc[RADIUS]:
            turn = step
    after = separation(pattern, theta + turn, line, other, pegs[0], pegs[2])
    row[SECOND] = 0.0 if after is None else (after - s) / STEP
    row[MOTION + 1], row[MOTION + 2] = c * line[AXIS_X] - e * line[AXIS_Y], e * line[AXIS_X] + c * line[AXIS_Y]
    return [row]
