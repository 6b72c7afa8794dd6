"""Ways down off the passes of a few pegs by themselves, followed once for all patterns in which they stand alike.

In a pattern such a way is one of its own as far as no further peg is in the part; from there on it is followed with all
pegs.
"""

from __future__ import annotations

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
    MOTION,
    NODE_LENGTH,
    SECOND,
    STEP,
    STEP_ALONG,
)
from workhold.kernels.seating.following import free_until
from workhold.seating.descents import LONGEST_STEP, Closing

if TYPE_CHECKING:
    from workhold.seating.equilibria import Equilibria

__all__ = ["BESIDE", "Trodden", "WaysDown", "both_ways_down", "steps_off"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# mm. How far from a pass a way down begins, and how near it begins at least; and by which part of its way the motion may
# have bent there.
BESIDE = 0.01
SHORTEST, MOST_BEND = 1e-5, 0.1


def steps_off(rows: Array, size: float) -> tuple[Array, Array]:
    """Steps (N, 4) along the free motions of passes (N, 24) at which ways down begin, and their lengths (N,) in mm: shorter
    where the motion bends so much that they would lie elsewhere."""
    motions, seconds = rows[:, MOTION : MOTION + 3], np.abs(rows[:, SECOND])
    speeds = np.abs(motions[:, 0]) * size + np.hypot(motions[:, 1], motions[:, 2])
    bent = 2.0 * MOST_BEND * speeds * speeds
    lengths = np.where(seconds * BESIDE > bent, np.maximum(bent / np.maximum(seconds, 1e-300), SHORTEST), BESIDE)
    steps = np.zeros((len(rows), 4))
    steps[:, :3] = (lengths / speeds)[:, None] * motions
    return steps, lengths


def starts_off(rows: Array, size: float) -> tuple[Array, Array]:
    """Where ways down begin, to one and the other side of each of some passes (N, 24): configurations (2 N, 4), and how long
    their first steps are in mm (2 N,)."""
    (steps, lengths), configs = steps_off(rows, size), rows[:, CONFIG]
    starts, first = np.empty((len(rows), 2, 4)), np.empty((len(rows), 2))
    starts[:, 0], starts[:, 1], first[:] = configs + steps, configs - steps, lengths[:, None] / 2.0
    return starts.reshape(-1, 4), first.ravel()


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
    nodes: Array = field(factory=lambda: np.zeros((0, NODE_LENGTH)))
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


@define(eq=False)
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
        every = self.candidates
        is_seat = (every[:, DOUBT] == 0.0) & ((every[:, SECOND] > 0.0) | (every[:, CONTACTS] == 4.0))
        self.trodden.add(numbers, *self.closing.followed(starts, first, every[is_seat][:, CONFIG]))


def both_ways_down(found: Equilibria, closing: Closing, seats: Array) -> tuple[Array, Array, NDArray[np.int8]]:
    """Where the ways down off both sides of all passes begin, where they end (2 N, 4), and how.

    Parameters
    ----------
    seats : (M, 4) configurations at which closing is known to end.
    """
    starts, first = starts_off(found.passes, closing.size)
    ends, how = np.array(starts), np.full(len(starts), AT_REST, np.int8)
    lengths, left = np.stack([first, first], axis=1), np.ones(len(starts), np.bool_)
    known = np.flatnonzero(found.origins[:, 0] >= 0)
    if len(known):
        trodden = found.groups[0][1].trodden
        ways, whose, lasts = free_ways(found, known, closing)
        mine, begun = (2 * known[:, None] + [0, 1]).ravel(), lasts >= trodden.begins[ways]
        reached, mine_begun = trodden.nodes[lasts[begun]], mine[begun]
        lengths[mine_begun], ends[mine_begun] = reached[:, [STEP, STEP_ALONG]], reached[:, :4]
        ends[mine_begun] += shifts_of(found)[whose[begun]]
        left[mine] = ~begun | (lasts + 1 < trodden.begins[ways + 1]) | (trodden.how[ways] != AT_REST)
    ends[left], how[left] = closing.run(ends[left], lengths[left], seats)
    return starts, ends, how


def shifts_of(found: Equilibria) -> Array:
    """By which configurations of each group (G, 4) become those of the pattern."""
    return np.array([group.shift for group, _ in found.groups])


def free_ways(found: Equilibria, passes: IntArray, closing: Closing) -> tuple[IntArray, IntArray, IntArray]:
    """The ways off both sides of some passes (2 N,), the groups whose they are, and the last node of each at which the
    pattern's other pegs are not in the part."""
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
    work = shifts_of(found), others, most, closing.obstacles, np.empty((4, 4))
    free_until(ways, whose, trodden.nodes, trodden.begins, *work, lasts)
    return ways, whose, lasts
