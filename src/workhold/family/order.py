"""The order of set-ups in which the fewest pegs are moved, and where each set-up stands beside the one before.

A set-up may stand anywhere on the lattice where the toolkit has no end. Two set-ups one after the other share the pegs that
stand in the same holes, and the rest is moved. The order is that of the shortest path through all set-ups (Held & Karp, *A
dynamic programming approach to sequencing problems*, 1962), up to ``MOST_EXACT`` of them; beyond, it goes from each to the
nearest that is left.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.family.holding import NOTHING
from workhold.fixels.toolkit import Toolkit

__all__ = ["MOST_EXACT", "Freedom", "Step", "best_order", "freedom_of"]

MOST_EXACT = 12
# The cost of a way that nobody goes.
FAR = 1 << 30

Holes = Sequence[tuple[int, int, int]]


@frozen
class Freedom:
    """Whether a set-up may be moved by columns, and by rows."""

    columns: bool
    rows: bool


@frozen
class Step:
    """A set-up in its place in the order.

    Parameters
    ----------
    setup : its number.
    columns, rows : how far it is moved beside where it stood.
    moved : how many pegs are to be placed that did not stand there in the set-up before.
    """

    setup: int
    columns: int
    rows: int
    moved: int


def freedom_of(toolkit: Toolkit) -> Freedom:
    """Which ways set-ups of a toolkit may be moved: where it has no end."""
    plates, is_counted = toolkit.plates, toolkit.datum.fixes_rows
    return Freedom(
        columns=all(plate.columns is None for plate in plates),
        rows=not is_counted and all(plate.rows is None and not plate.blocked for plate in plates),
    )


def moved(holes: Holes, columns: int, rows: int) -> list[tuple[int, int, int]]:
    """Holes after a move; a place that tells nothing stays."""
    return [
        (one, column if column == NOTHING else column + columns, row if row == NOTHING else row + rows)
        for one, column, row in holes
    ]


def moves(before: Holes, after: Holes, freedom: Freedom) -> Iterator[tuple[int, int]]:
    """Moves that bring a peg of one set-up onto a peg of another, and none."""
    yield 0, 0
    for (one, column, row), (other, x, y) in product(before, after):
        if one == other:
            yield (column - x if freedom.columns else 0), (row - y if freedom.rows else 0)


def nearest(before: Holes, after: Holes, freedom: Freedom) -> tuple[int, int, int]:
    """The fewest pegs to place for a set-up after another one, and the move that needs so few, the first of them."""
    there = Counter(before)
    best = min(
        (sum((Counter(moved(after, *move)) - there).values()), abs(move[0]) + abs(move[1]), move)
        for move in set(moves(before, after, freedom))
    )
    return best[0], *best[2]


def best_order(setups: Sequence[Holes], freedom: Freedom) -> list[Step]:
    """The order of set-ups, from the holes of each, moved so that the lowest column and row that may be moved are 0.

    Of equal orders it is the first in the order of the numbers.
    """
    cost = np.array([[nearest(one, other, freedom)[0] for other in setups] for one in setups])
    path = shortest_path(cost) if len(setups) <= MOST_EXACT else greedy_path(cost)
    stood: list[tuple[Step, Holes]] = []
    for number in path:
        holes = setups[number]
        pegs, columns, rows = nearest(stood[-1][1], holes, freedom) if stood else (len(holes), 0, 0)
        stood.append((Step(number, columns, rows, pegs), moved(holes, columns, rows)))
    first_column, first_row = (
        min((hole[axis] for _, holes in stood for hole in holes if hole[axis] != NOTHING), default=0) if free else 0
        for axis, free in ((1, freedom.columns), (2, freedom.rows))
    )
    return [evolve(step, columns=step.columns - first_column, rows=step.rows - first_row) for step, _ in stood]


def shortest_path(cost: NDArray[np.int64]) -> list[int]:
    """The shortest path through all places, from the costs (S, S) of the ways between them; of equal ones the first."""
    count = len(cost)
    bit, every = 1 << np.arange(count), np.arange(count)
    # length[v, s]: of the shortest way from place s through all that are not among the bits of v.
    length, onward = np.zeros((1 << count, count), np.int64), np.zeros((1 << count, count), np.int64)
    for visited in range((1 << count) - 2, 0, -1):
        ahead = np.flatnonzero(visited & bit == 0)
        ways = cost[:, ahead] + length[visited | bit[ahead], ahead]
        chosen = ways.argmin(axis=1)
        onward[visited], length[visited] = ahead[chosen], ways[every, chosen]
    path = [int(np.argmin(length[bit, every]))]
    visited = int(bit[path[0]])
    while len(path) < count:
        path.append(int(onward[visited, path[-1]]))
        visited |= int(bit[path[-1]])
    return path


def greedy_path(cost: NDArray[np.int64]) -> list[int]:
    """A path from the first place to the nearest that is left, and so on."""
    path, left = [0], np.arange(len(cost)) != 0
    while left.any():
        path.append(int(np.argmin(np.where(left, cost[path[-1]], FAR))))
        left[path[-1]] = False
    return path
