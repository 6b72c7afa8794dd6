"""Three parallel forces: two pegs of one jaw on a line and an arc, and a third on a parallel line.

There the chord of the two is a tangency, and its instant centre infinitely far. S depends on the orientation
alone, because two of the three lie on parallel lines. The orientation has an extremum along the chord's
curve: so S has one too.
"""

from __future__ import annotations

from itertools import permutations
from math import hypot

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.seating.columns import CANDIDATE_LENGTH, Given
from workhold.kernels.seating.parallel import ALPHA, at_tangencies, tangent_chords
from workhold.seating.growing_rows import filled
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.pattern import Pattern

__all__ = ["parallel_candidates"]

Array = NDArray[np.float64]


def parallel_candidates(boundary: ObstacleBoundary, pattern: Pattern, given: Given) -> list[Array]:
    """Candidates (N, 24) of pegs of a jaw on a line and an arc, with a third peg on a parallel line.

    The third line may be the first line itself.
    """
    out, pegs, right = [], pattern.pegs.tolist(), pattern.right.tolist()
    for i, j in permutations(range(len(pegs)), 2):
        if right[i] != right[j]:
            continue
        chords = chords_at_tangencies(boundary, hypot(pegs[j][0] - pegs[i][0], pegs[j][1] - pegs[i][1]), right[i])
        if len(chords):
            reach = chords, pattern.stop, pattern.widest, given
            out.append(filled(CANDIDATE_LENGTH, 256, at_tangencies, i, j, *reach))
    return out


def chords_at_tangencies(boundary: ObstacleBoundary, d: float, jaw: int) -> Array:
    """Tangencies (C, 5) of the chords of a length, for pegs of a jaw: ``kernels.seating.parallel``."""
    known, key = boundary.once(tangencies), (round(d, 9), jaw)
    if key not in known:
        first, end = boundary.parts[jaw].tolist()
        known[key] = filled(ALPHA + 1, 256, tangent_chords, boundary.pieces, first, end, d)
    return known[key]


def tangencies(_: ObstacleBoundary) -> dict[tuple[float, int], Array]:
    """Room for the tangencies on a part, by the length of the chord and the jaw."""
    return {}
