"""Ways down off the passes of a few pegs by themselves, followed once for all patterns in which they stand alike.

In a pattern such a way is one of its own as far as no further peg is in the part; from there on it is followed with all
pegs.
"""

from __future__ import annotations

from functools import cached_property
from threading import Lock
from typing import TYPE_CHECKING, Any

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.kernels.seating.closing import AT_REST
from workhold.kernels.seating.columns import (
    CONFIG,
    CONTACTS,
    DOUBT,
    NODE_LENGTH,
    SECOND,
)
from workhold.kernels.seating.following import begin_ways, free_until, take_up
from workhold.seating.descents import LONGEST_STEP, Closing

if TYPE_CHECKING:
    from workhold.seating.equilibria import Equilibria

__all__ = ["Trodden", "WaysDown", "both_ways_down", "starts_off"]

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


def with_room(rows: NDArray[Any], count: int, more: int) -> NDArray[Any]:
    """An array of which some rows are taken, with room for more: itself, or one of twice the length that begins as it."""
    if count + more <= len(rows):
        return rows
    out = np.empty((2 * (count + more), *rows.shape[1:]), rows.dtype)
    out[:count] = rows[:count]
    return out


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


def both_ways_down(found: Equilibria, closing: Closing, seats: Array) -> tuple[Array, Array, NDArray[np.int8]]:
    """Where the ways down off both sides of all passes begin, where they end (2 N, 4), and how.

    Parameters
    ----------
    seats : (M, 4) configurations at which closing is known to end.
    """
    starts, lengths = starts_off(found.passes, closing.size)
    ends, how, left = np.array(starts), np.full(len(starts), AT_REST, np.int8), np.ones(len(starts), np.int8)
    known = np.flatnonzero(found.origins[:, 0] >= 0)
    if len(known):
        trodden, shifts = found.groups[0][1].trodden, shifts_of(found)
        ways = free_ways(found, known, closing, shifts)
        take_up(known, *ways, trodden.nodes, trodden.begins, trodden.how, shifts, ends, lengths, left)
    rest = np.flatnonzero(left)
    ends[rest], how[rest] = closing.run(ends[rest], lengths[rest], seats)
    return starts, ends, how


def shifts_of(found: Equilibria) -> Array:
    """By which configurations of each group (G, 4) become those of the pattern."""
    return np.array([group.shift for group, _ in found.groups])


def free_ways(
    found: Equilibria, passes: IntArray, closing: Closing, shifts: Array
) -> tuple[IntArray, IntArray, IntArray]:
    """The ways off both sides of some passes (2 N,), the groups whose they are, and the last node of each at which the
    pattern's other pegs are not in the part; shifts as of ``shifts_of``."""
    whose, numbers = found.origins[passes, 0], found.origins[passes, 1]
    trodden = found.groups[0][1].trodden
    new = trodden.numbers[numbers, 0] < 0
    for group in dict.fromkeys(whose[new].tolist()):
        found.groups[group][1].follow(numbers[new & (whose == group)])
    ways, whose = trodden.numbers[numbers].ravel(), np.repeat(whose, 2)
    others = np.ones((len(found.groups), len(closing.pattern.pegs)), np.int8)
    for row, (group, _) in zip(others, found.groups, strict=True):
        row[list(group.numbers)] = 0
    most, lasts = LONGEST_STEP * min(closing.pattern.radii), np.empty(len(ways), np.int64)
    work = shifts, others, most, closing.obstacles, np.empty((4, 4))
    free_until(ways, whose, trodden.nodes, trodden.begins, *work, lasts)
    return ways, whose, lasts
