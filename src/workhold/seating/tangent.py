"""Three parallel forces: two pegs of one jaw on a line and an arc, with parallel normals, and a third on a parallel line.

There the chord of the two is a tangency, and its instant centre infinitely far. S depends on the orientation alone, because
two of the three lie on parallel lines, and the orientation has an extremum along the chord's curve: so S has one too.
"""

from __future__ import annotations

from itertools import permutations
from math import atan2, hypot, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import PARALLEL
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, X, Y
from workhold.kernels.seating.columns import CANDIDATE_LENGTH, Given
from workhold.kernels.seating.parallel import ALPHA, at_tangencies
from workhold.seating.filled import filled
from workhold.seating.locus import Locus, contains
from workhold.seating.pattern import Pattern

__all__ = ["tangent"]

Array = NDArray[np.float64]


def tangent(locus: Locus, pattern: Pattern, given: Given) -> list[Array]:
    """Candidates (N, 24) of all pairs of pegs of a jaw, lines and arcs, with a third peg on a line parallel to the first."""
    out = []
    for i, j in permutations(range(len(pattern.pegs)), 2):
        if pattern.right[i] != pattern.right[j]:
            continue
        chords = chords_at_tangencies(locus, hypot(*(pattern.pegs[j] - pattern.pegs[i])), int(pattern.right[i]))
        reach = chords, pattern.stop, pattern.widest, given
        out.append(filled(CANDIDATE_LENGTH, 256, at_tangencies, i, j, *reach))
    return out


def chords_at_tangencies(locus: Locus, d: float, jaw: int) -> Array:
    """Tangencies (C, 5) of the chords of a length, for pegs of a jaw: ``kernels.seating.parallel``."""
    key = round(d, 9), jaw
    if key not in locus.tangents:
        first, end = locus.parts[jaw].tolist()
        numbers = range(first, end)
        arcs = [b for b in numbers if locus.rows[b, IS_ARC] != 0.0]
        lines = [a for a in numbers if locus.rows[a, IS_ARC] == 0.0 and has_parallel(locus.rows, a)]
        found = [
            one for a in lines for b in arcs for side in (1.0, -1.0) for one in tangencies(locus.rows, a, b, d, side)
        ]
        locus.tangents[key] = np.array(found).reshape(-1, ALPHA + 1)
    return locus.tangents[key]


def has_parallel(rows: Array, number: int) -> bool:
    """Whether another line is parallel to one."""
    line, lines = rows[number], rows[:, IS_ARC] == 0.0
    cross = np.abs(line[AXIS_X] * rows[:, AXIS_Y] - line[AXIS_Y] * rows[:, AXIS_X])
    return bool(np.count_nonzero(lines & (cross <= PARALLEL)) > 1)


def tangencies(rows: Array, a: int, b: int, d: float, side: float) -> list[tuple[float, ...]]:
    """Those of the chords of length d from line a to the place of arc b whose normal is the line's."""
    line, arc = rows[a], rows[b]
    nx, ny = line[AXIS_Y], -line[AXIS_X]
    x, y = arc[X] + side * arc[RADIUS] * nx, arc[Y] + side * arc[RADIUS] * ny
    rise = (x - line[X]) * nx + (y - line[Y]) * ny
    if abs(rise) >= d or not contains(arc, x, y):
        return []
    found = list[tuple[float, ...]]()
    for run in (sqrt(d * d - rise * rise), -sqrt(d * d - rise * rise)):
        wx, wy = rise * nx + run * line[AXIS_X], rise * ny + run * line[AXIS_Y]
        if contains(line, x - wx, y - wy):
            found.append((a, b, x - wx, y - wy, atan2(wy, wx)))
    return found
