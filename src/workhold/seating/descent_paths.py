"""Descent paths off the passes of subsets of pegs, followed once for all patterns with such subsets.

In a pattern such a path is one of its own as long as no further peg is in the part. From there on it is
followed with all pegs.

Glossary
--------
descent path : a path off a saddle along which a function falls, here the separation as the jaws close: J.
    Milnor, *Morse Theory* (1963).
descent cache : descent paths that are kept, as a function's values are: D. Michie, "Memo functions and
    machine learning", Nature 218 (1968).
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
from workhold.kernels.seating.descent_paths import begin_descents
from workhold.seating.closing import Closing
from workhold.seating.growing_rows import with_room

__all__ = ["DescentCache", "DescentPaths", "descent_starts"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# Nodes for which there is room at first.
ROOM = 65_536


def descent_starts(rows: Array, size: float) -> tuple[Array, Array]:
    """Where descent paths begin, to one and the other side of each of some passes (N, 24).

    Returns
    -------
    tuple
        Configurations (2 N, 4), and how long the first steps are in mm (2 N, 2).
    """
    starts, lengths = np.empty((2 * len(rows), 4)), np.empty((2 * len(rows), 2))
    begin_descents(np.ascontiguousarray(rows), size, starts, lengths)
    return starts, lengths


@define(eq=False)
class DescentCache:
    """The descent paths of all subsets of pegs on a part, as far as they were followed.

    What was written stays where it is: whoever has read how much there is reads it while others add to it.

    Parameters
    ----------
    numbers : (C, 2) of the paths off both sides of each candidate, -1 as long as they are not known.
    nodes : (M, 10) along all paths: ``kernels.seating.columns``.
    begins : (W + 1,) where the nodes of each path begin and, last, end.
    how : (W,) how each path ends: ``kernels.seating.closing``.
    counts : how many candidates, nodes and paths there are: there is room for more.
    """

    numbers: IntArray = field(factory=lambda: np.zeros((0, 2), np.int64))
    nodes: Array = field(factory=lambda: np.empty((ROOM, NODE_LENGTH)))
    begins: IntArray = field(factory=lambda: np.zeros(1, np.int64))
    how: NDArray[np.int8] = field(factory=lambda: np.zeros(0, np.int8))
    counts: tuple[int, int, int] = (0, 0, 0)
    lock: Lock = field(factory=Lock)

    def with_candidates(self, count: int) -> int:
        """Makes room for so many further candidates, and returns the number of the first."""
        with self.lock:
            first, nodes, paths = self.counts
            self.numbers = with_room(self.numbers, first, count)
            self.numbers[first : first + count] = -1
            self.counts = first + count, nodes, paths
        return first

    def add(self, candidates: IntArray, nodes: Array, begins: IntArray, how: NDArray[np.int8]) -> None:
        """Adds the paths off both sides of some candidates, with where they begin and how they end."""
        with self.lock:
            every, first, paths = self.counts
            self.nodes, self.how = with_room(self.nodes, first, len(nodes)), with_room(self.how, paths, len(how))
            self.begins = with_room(self.begins, paths + 1, len(how))
            self.nodes[first : first + len(nodes)] = nodes
            self.begins[paths + 1 : paths + len(begins)] = first + begins[1:]
            self.how[paths : paths + len(how)] = how
            self.counts = every, first + len(nodes), paths + len(how)
            self.numbers[candidates] = paths + np.arange(len(how)).reshape(-1, 2)


@define(eq=False, slots=False)
class DescentPaths:
    """The descent paths of a subset of pegs.

    Parameters
    ----------
    closing : the jaws with these pegs alone.
    candidates : (N, 24) their equilibria.
    cache : what was followed so far.
    first : number of the first candidate in the cache.
    """

    closing: Closing
    candidates: Array
    cache: DescentCache
    first: int = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.first = self.cache.with_candidates(len(self.candidates))

    def follow(self, numbers: IntArray) -> None:
        """Follows the paths off some of the candidates, by their numbers in the cache."""
        # Another thread may follow some at the same time: then both are there, and are the same.
        starts, first = descent_starts(self.candidates[numbers - self.first], self.closing.size)
        self.cache.add(numbers, *self.closing.followed(starts, first, self.seats))

    @cached_property
    def seats(self) -> Array:
        """Configurations (M, 4) of the candidates at which closing ends for certain."""
        every = self.candidates
        is_seat = (every[:, DOUBT] == 0.0) & ((every[:, SECOND] > 0.0) | (every[:, CONTACTS] == 4.0))
        return np.asarray(every[is_seat][:, CONFIG])
