"""Quartets of jaw-specified features with their pegs (paper, sections 3, 3.2, 3.5 and 3.5.1).

A candidate is four features, the pegs that touch them, and the sectors of orientations at which they might. Everything
here only bounds; what a bound cannot exclude is handed on.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, floor, pi

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.algebra.wedges import HALF_SECTOR, SECTORS, PegPairs, facing
from workhold.contact.frame import Frame
from workhold.conventions import PARALLEL, WEDGE_SLACK

__all__ = ["Facings", "Systems", "type_one_systems", "type_two_systems"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@define(frozen=True, eq=False)
class Systems:
    """N systems of contact equations: for Type I four pegs, for Type II the three on the left jaw.

    Parameters
    ----------
    feature, column, row : (N, 4) or (N, 3); rows count from the first peg, columns from the first peg of the same jaw.
        The left pegs come first.
    sectors : (N, SECTORS) orientations not excluded.
    """

    feature: IntArray
    column: IntArray
    row: IntArray
    sectors: BoolArray

    def __len__(self) -> int:
        return len(self.feature)

    def take(self, which: IntArray | BoolArray) -> Systems:
        """The systems of an index array or mask."""
        return Systems(self.feature[which], self.column[which], self.row[which], self.sectors[which])


@define(frozen=True, eq=False)
class Facings:
    """What directions features face.

    Parameters
    ----------
    left, right : (F, SECTORS) whether a feature can be pushed so as to clamp by a left peg, or by a right peg, at an
        orientation. These are the two parts of the valid orientations (section 3.2).
    resists : (F, SECTORS) whether a feature has a normal within a quarter turn of a direction. Four features can close
        only if every direction is resisted by one of them (section 3).
    """

    left: BoolArray
    right: BoolArray
    resists: BoolArray

    @classmethod
    def of(cls, rows: Array, clamping: int) -> Facings:
        """The facings of feature rows (F, 10) for right pegs that clamp by pushing left (1) or right (-1)."""
        right = facing(rows, pi / 2 + HALF_SECTOR)
        left, right = (np.roll(right, -SECTORS // 2, axis=1), right)[::clamping]
        return cls(left, right, facing(rows, pi / 2))


def are_parallel(rows: Array, a: IntArray, b: IntArray) -> BoolArray:
    """Which pairs of features are parallel lines."""
    turn = rows[a, 3] * rows[b, 4] - rows[a, 4] * rows[b, 3]
    return np.asarray((rows[a, 0] == 0.0) & (rows[b, 0] == 0.0) & (np.abs(turn) <= PARALLEL))


def jaw_ranks(pairs: PegPairs, rows: Array) -> IntArray:
    """A rank (N,) of each peg pair that is the same for the pair with its features exchanged, higher with more arcs.

    Half a turn of the toolkit exchanges the jaws and each pair's features. So it is enough to look at quartets whose left
    pair ranks at least as high as the right one.
    """
    arcs = (rows[pairs.tail, 0] != 0.0).astype(np.int64) + (rows[pairs.head, 0] != 0.0)
    first, second = np.minimum(pairs.tail, pairs.head), np.maximum(pairs.tail, pairs.head)
    order = np.lexsort([pairs.column, pairs.row, second, first, arcs])
    keys = np.stack([arcs, first, second, pairs.row, pairs.column], axis=1)[order]
    fresh = np.ones(len(order), np.int64)
    fresh[1:] = (keys[1:] != keys[:-1]).any(axis=1)
    rank = np.empty(len(order), np.int64)
    rank[order] = np.cumsum(fresh)
    return rank


def type_one_systems(pairs: PegPairs, rows: Array, frame: Frame) -> Iterator[Systems]:
    """Quartets with two pegs on each jaw, but those with parallel lines on one jaw (section 3.5.1)."""
    facings = Facings.of(rows, frame.toolkit.clamping)
    generic = np.flatnonzero(~are_parallel(rows, pairs.tail, pairs.head))
    rank, sectors = jaw_ranks(pairs, rows), pairs.sectors
    resists = facings.resists[pairs.tail] | facings.resists[pairs.head]
    as_left = sectors & (facings.left[pairs.tail] | facings.left[pairs.head])
    as_right = sectors & (facings.right[pairs.tail] | facings.right[pairs.head])
    # From the first peg to the rightmost of a left pair and to the leftmost of a right pair.
    rightward = np.maximum(pairs.column, 0) * frame.lattice.pitch_x
    leftward = np.minimum(pairs.column, 0) * frame.lattice.pitch_x
    for one in generic:
        two = generic[rank[generic] <= rank[one]]
        two = two[(resists[one] | resists[two]).all(axis=1)]
        room = pairs.high[two, :, 0] + leftward[two, None] - pairs.low[one, :, 0] - rightward[one]
        shared = as_left[one] & as_right[two] & (room >= frame.gap - WEDGE_SLACK)
        keep = shared.any(axis=1)
        if keep.any():
            yield from with_rows(pairs, int(one), two[keep], shared[keep], frame)


def with_rows(pairs: PegPairs, one: int, two: IntArray, shared: BoolArray, frame: Frame) -> Iterator[Systems]:
    """Systems of one left pair with right pairs, for every row of the right jaw that the wedges allow."""
    pitch, offset = frame.lattice.pitch_y, frame.lattice.row_offset
    low = np.where(shared, (pairs.low[two, :, 1] - pairs.high[one, :, 1] - offset) / pitch, np.inf)
    high = np.where(shared, (pairs.high[two, :, 1] - pairs.low[one, :, 1] - offset) / pitch, -np.inf)
    for line in range(ceil(low.min()), floor(high.max()) + 1):
        inside = (low <= line) & (line <= high)
        keep = inside.any(axis=1)
        if not keep.any():
            continue
        right = two[keep]
        zero = np.zeros(len(right), np.int64)
        feature = np.stack(
            [zero + pairs.tail[one], zero + pairs.head[one], pairs.tail[right], pairs.head[right]], axis=1
        )
        column = np.stack([zero, zero + pairs.column[one], zero, pairs.column[right]], axis=1)
        row = np.stack([zero, zero + pairs.row[one], zero + line, pairs.row[right] + line], axis=1)
        yield Systems(feature, column, row, inside[keep])


def type_two_systems(pairs: PegPairs, rows: Array, frame: Frame) -> Iterator[Systems]:
    """Triples of left pegs, those with parallel lines among them too; the fourth peg follows the pose (section 3.5).

    The third peg lies in the wedges from the first and from the second peg.
    """
    facings = Facings.of(rows, frame.toolkit.clamping)
    count = len(rows)
    number = {key: k for k, key in enumerate(zip(*(v.tolist() for v in whole(pairs)), strict=True))}
    sectors = pairs.sectors
    place = pairs.row * (1 << 20) + pairs.column
    right = facings.right.any(axis=0)
    for one in range(len(pairs)):
        two = np.flatnonzero((pairs.tail == pairs.tail[one]) & (place > place[one]))
        a, b = int(pairs.tail[one]), int(pairs.head[one])
        third, kept = [], []
        for k in two:
            key = (b, int(pairs.head[k]), int(pairs.column[k] - pairs.column[one]), int(pairs.row[k] - pairs.row[one]))
            if key in number:
                third.append(number[key])
                kept.append(int(k))
        if not kept:
            continue
        two, across = np.array(kept), np.array(third)
        shared = (pairs.tails[one] & pairs.tails[two]).any(axis=1) & sectors[across] & right
        pushed = facings.left[a] | facings.left[b] | facings.left[pairs.head[two]]
        resists = facings.resists[a] | facings.resists[b] | facings.resists[pairs.head[two]]
        closes = np.any([(resists | facings.resists[e]).all(axis=1) for e in range(count)], axis=0)
        shared &= pushed & closes[:, None]
        keep = shared.any(axis=1)
        two = two[keep]
        zero = np.zeros(len(two), np.int64)
        yield Systems(
            np.stack([zero + a, zero + b, pairs.head[two]], axis=1),
            np.stack([zero, zero + pairs.column[one], pairs.column[two]], axis=1),
            np.stack([zero, zero + pairs.row[one], pairs.row[two]], axis=1),
            shared[keep],
        )


def whole(pairs: PegPairs) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    """The whole numbers that name peg pairs."""
    return pairs.tail, pairs.head, pairs.column, pairs.row
