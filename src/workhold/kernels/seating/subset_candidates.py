"""The candidates of a pattern from those of subsets of its pegs, which are kept in the subsets' own frames.

Columns of a subset:

- FIRST, END : of its candidates among all that are kept.
- NUMBER : of the first in their origins.
- JAW : 0 or 1 where its pegs are all of one jaw and fix the part to it, else -1.
- NAMES : four names, the pattern's numbers of its pegs, and last -1 of none.
- SHIFT : what is added to x, y and S.

Columns of what is gathered are those of a candidate, then SUBSET and ORIGIN: the subset that makes it and its
number in the origins, -1 where none does.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.seating.candidates import add_fourths
from workhold.kernels.seating.columns import CANDIDATE_LENGTH, PEG, PLACE_X, SEPARATION, Given

Array = NDArray[np.float64]

FIRST, END, NUMBER, JAW, NAMES, SHIFT = 0, 1, 2, 3, 4, 8
SUBSET_LENGTH = 11
SUBSET, ORIGIN = CANDIDATE_LENGTH, CANDIDATE_LENGTH + 1
GATHERED_LENGTH = CANDIDATE_LENGTH + 2


@inner
def write_moved(row: Array, subset: Array, out: Array) -> None:
    """Writes a candidate of a subset as one of the pattern."""
    for k in range(CANDIDATE_LENGTH):
        out[k] = row[k]
    for k in range(3):
        out[PLACE_X + k] = row[PLACE_X + k] + subset[SHIFT + k]
    for k in range(PEG, PEG + 4):
        out[k] = subset[NAMES + (int(row[k]) if row[k] >= 0.0 else 3)]


@inner
def keep_reached(out: Array, count: int, end: int, stop: float, widest: float) -> int:
    """Keeps the rows from ``count`` to ``end`` at separations that are reached, which no subset has.

    Returns the new count.
    """
    for n in range(count, end):
        if stop < out[n, SEPARATION] < widest:
            for k in range(CANDIDATE_LENGTH):
                out[count, k] = out[n, k]
            out[count, SUBSET] = out[count, ORIGIN] = -1.0
            count += 1
    return count


@inner
def add_rows(rows: Array, stop: float, widest: float, out: Array, count: int) -> int:
    """Adds candidates of no subset at separations that are reached; returns the new count, or -1.

    -1 means that they do not fit.
    """
    if count + rows.shape[0] > out.shape[0]:
        return -1
    for n in range(rows.shape[0]):
        for k in range(CANDIDATE_LENGTH):
            out[count + n, k] = rows[n, k]
    return keep_reached(out, count, count + rows.shape[0], stop, widest)


@compiled
def gathered(
    subsets: Array,
    kept: Array,
    before: Array,
    after: Array,
    stop: float,
    widest: float,
    given: Given,
    fixed: Array,
    out: Array,
) -> int:
    """Writes all candidates of a pattern at separations that are reached; returns their number, or -1.

    -1 means that they do not fit.

    Of subsets of one jaw they are those with a fourth contact.

    Parameters
    ----------
    subsets : (G, 11), see above.
    kept : (C, 24) candidates of subsets.
    before, after : (N, 24) candidates of no subset, which come before and after those of subsets.
    stop, widest : separations in mm.
    fixed : (24,) work space.
    out : (N, 26), written here.
    """
    count = add_rows(before, stop, widest, out, 0)
    for number in range(subsets.shape[0]):
        subset = subsets[number]
        first = int(subset[FIRST])
        for n in range(first, int(subset[END])):
            if count < 0 or count >= out.shape[0]:
                return -1
            if subset[JAW] >= 0.0:
                write_moved(kept[n], subset, fixed)
                end = add_fourths(fixed, int(subset[JAW]), given, out, count)
                count = keep_reached(out, count, end, stop, widest) if end >= 0 else -1
            elif stop < kept[n, SEPARATION] + subset[SHIFT + 2] < widest:
                write_moved(kept[n], subset, out[count])
                out[count, SUBSET], out[count, ORIGIN] = number, subset[NUMBER] + (n - first)
                count += 1
    return -1 if count < 0 else add_rows(after, stop, widest, out, count)
