"""Ways down off the passes of a few pegs by themselves, followed once for all patterns in which they stand alike.

In a pattern such a way is one of its own as far as no further peg is in the part; from there on it is followed with all
pegs.
"""

from __future__ import annotations

from functools import cached_property
from threading import Lock

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.kernels.seating.columns import (
    CONFIG,
    CONTACTS,
    DOUBT,
    NODE_LENGTH,
    SECOND,
)
from workhold.kernels.seating.following import begin_ways
from workhold.seating.descents import Closing
from workhold.seating.growing_rows import with_room

__all__ = ["Trodden", "WaysDown", "starts_off"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# Nodes for which there is room at first.
ROOM = 65_536


def starts_off(rows: Array, size: float) -> tuple[Array, Array]:
    """Where ways down begin, to one and the other side of each of some passes (N, 24): configurations (2 N, 4), and how long
    their first steps are in mm (2 N, 2)."""
    starts, lengths = np.empty((2 * len(rows), 4)), np.empty((2 * len(rows), 2))
    begin_ways(np.ascontiguousarray(rows), size, starts, lengths)
    return starts, lengths


@define(eq=False)
class Trodden:
    """The ways down of all groups of pegs on a part, as far as they were followed.

    What was written stays where it is: who has read how much there is reads it while others add to it.

    Parameters
    ----------
    numbers : (C, 2) of the ways off both sides of each candidate, -1 as long as they are not known.
    nodes : (M, 10) along all ways: ``kernels.seating.columns``.
    begins : (W + 1,) where those of each way begin and, last, end.
    how : (W,) how each ends: ``kernels.seating.closing``.
    counts : how many candidates, nodes and ways there are: there is room for more.
    """

    numbers: IntArray = field(factory=lambda: np.zeros((0, 2), np.int64))
    nodes: Array = field(factory=lambda: np.empty((ROOM, NODE_LENGTH)))
    begins: IntArray = field(factory=lambda: np.zeros(1, np.int64))
    how: NDArray[np.int8] = field(factory=lambda: np.zeros(0, np.int8))
    counts: tuple[int, int, int] = (0, 0, 0)
    lock: Lock = field(factory=Lock)

    def with_candidates(self, count: int) -> int:
        """The number of the first of so many further candidates."""
        with self.lock:
            first, nodes, ways = self.counts
            self.numbers = with_room(self.numbers, first, count)
            self.numbers[first : first + count] = -1
            self.counts = first + count, nodes, ways
        return first

    def add(self, candidates: IntArray, nodes: Array, begins: IntArray, how: NDArray[np.int8]) -> None:
        """Add the ways off both sides of some candidates, one after the other; the last two as of all."""
        with self.lock:
            every, first, ways = self.counts
            self.nodes, self.how = with_room(self.nodes, first, len(nodes)), with_room(self.how, ways, len(how))
            self.begins = with_room(self.begins, ways + 1, len(how))
            self.nodes[first : first + len(nodes)] = nodes
            self.begins[ways + 1 : ways + len(begins)] = first + begins[1:]
            self.how[ways : ways + len(how)] = how
            self.counts = every, first + len(nodes), ways + len(how)
            self.numbers[candidates] = ways + np.arange(len(how)).reshape(-1, 2)


@define(eq=False, slots=False)
class WaysDown:
    """The ways down of a group of pegs.

    Parameters
    ----------
    closing : the jaws with these pegs alone.
    candidates : (N, 24) their equilibria.
    trodden : what was followed so far.
    first : number of the first candidate there.
    """

    closing: Closing
    candidates: Array
    trodden: Trodden
    first: int = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.first = self.trodden.with_candidates(len(self.candidates))

    def follow(self, numbers: IntArray) -> None:
        """Follow the ways off some of the candidates, by their numbers there."""
        # Another thread may follow some at the same time: then both are there, and are the same.
        starts, first = starts_off(self.candidates[numbers - self.first], self.closing.size)
        self.trodden.add(numbers, *self.closing.followed(starts, first, self.seats))

    @cached_property
    def seats(self) -> Array:
        """Configurations (M, 4) of those at which closing ends for certain."""
        every = self.candidates
        is_seat = (every[:, DOUBT] == 0.0) & ((every[:, SECOND] > 0.0) | (every[:, CONTACTS] == 4.0))
        return np.asarray(every[is_seat][:, CONFIG])
