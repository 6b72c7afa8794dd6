"""Edges: chords at the ends of pieces, with what pieces need of them (see ``piece_columns``).

An edge of a curve serves the pieces on both of its sides, also where they are in neighbouring cells; and it tells for how
long after it the curve's pegs stand too far along x for another peg to stand farther.
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner, inner_making_arrays
from workhold.kernels.base.feature import IS_ARC, SIGN
from workhold.kernels.chord.evaluation import chord_state, valued
from workhold.kernels.curves.columns import LENGTH
from workhold.kernels.curves.piece_columns import (
    EDGE_ACROSS,
    EDGE_ARM,
    EDGE_CENTER,
    EDGE_CENTER_ERROR,
    EDGE_ERROR,
    EDGE_LENGTH,
    EDGE_SLOPE,
    EDGE_SLOPE_ERROR,
    EDGE_VALUE,
    EDGE_VALUE_ERROR,
    EDGE_X,
    HEAD_NORMAL_X,
    HEAD_NORMAL_Y,
    TAIL_NORMAL_X,
    TAIL_NORMAL_Y,
)

Array = NDArray[np.float64]

# Rounding of places in mm, generously counted.
HAIR = 1e-6


@inner_making_arrays
def kept_edges(count: int) -> Array:
    """The (M, 15) last edges of so many curves, with psi behind them; as yet none. They serve neighbouring cells, one after
    the other, in one mode."""
    return np.full((count, EDGE_LENGTH + 1), np.nan)


@inner
def write_edge(
    edge: Array, a: Array, b: Array, curve: Array, psi: float, cosine: float, sine: float, mode: float
) -> None:
    """Write what a piece needs of a chord at one of its ends, of an orientation with its cosine and sine, to a (14,) row."""
    state = chord_state(a, b, curve, psi, cosine, sine)
    edge[EDGE_VALUE], edge[EDGE_SLOPE], edge[EDGE_VALUE_ERROR], edge[EDGE_SLOPE_ERROR] = valued(
        a, b, state, cosine, sine, mode
    )
    edge[EDGE_X] = cosine * state[0] + sine * state[1]
    px, py, ax, ay = state[6], state[7], state[6] - state[0], state[7] - state[1]
    edge[EDGE_CENTER] = sqrt(px * px + py * py)
    edge[EDGE_ARM] = sqrt(ax * ax + ay * ay) + curve[LENGTH]
    edge[EDGE_ERROR] = state[8]
    edge[EDGE_ACROSS] = cosine * py - sine * px
    edge[EDGE_CENTER_ERROR] = state[9]
    side_a = 1.0 if a[IS_ARC] == 0.0 else a[SIGN]
    side_b = 1.0 if b[IS_ARC] == 0.0 else b[SIGN]
    edge[TAIL_NORMAL_X] = side_a * (cosine * state[2] + sine * state[3])
    edge[TAIL_NORMAL_Y] = side_a * (cosine * state[3] - sine * state[2])
    edge[HEAD_NORMAL_X] = side_b * (cosine * state[4] + sine * state[5])
    edge[HEAD_NORMAL_Y] = side_b * (cosine * state[5] - sine * state[4])


@inner
def is_farther(edge: Array, at: float, right: float, speed: float, farthest: float) -> bool:
    """Whether the tails of a curve from an edge on, at psi ``at``, up to psi ``right`` all stand farther right than a place
    in mm, in a stretch of an instant centre of a ``speed``.

    The place along x has a slope of at most |P|, and |P| grows by no more than the speed. By what a piece's bound
    of its place sags (see ``pieces.write_steady``) it is less, so that nothing is left out here that its bound would keep.
    """
    width = right - at
    center = edge[EDGE_CENTER] + edge[EDGE_CENTER_ERROR] + 2.0 * speed * width
    away = center * width + (center + speed) * width * width / 8.0
    return edge[EDGE_X] - away - 2.0 * edge[EDGE_ERROR] - HAIR > farthest
