"""Ways down off the passes of a few pegs by themselves, followed once for all patterns in which they stand alike.

In a pattern such a way is one of its own as far as no further peg is in the part; from there on it is followed with all
pegs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.kernels.seating.closing import AT_REST
from workhold.kernels.seating.columns import (
    CONTACTS,
    DOUBT,
    MOTION,
    PLACE_X,
    PLACE_Y,
    SECOND,
    SEPARATION,
    THETA,
)
from workhold.kernels.seating.following import free_until
from workhold.seating.descents import LONGEST_STEP, Closing, Nodes
from workhold.seating.groups import Group

if TYPE_CHECKING:
    from workhold.seating.equilibria import Equilibria

__all__ = ["BESIDE", "CONFIG", "WaysDown", "both_ways_down", "steps_off"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# mm. How far from a pass a way down begins, and how near it begins at least; and by which part of its way the motion may
# have bent there.
BESIDE = 0.01
SHORTEST, MOST_BEND = 1e-5, 0.1
CONFIG = [THETA, PLACE_X, PLACE_Y, SEPARATION]


def steps_off(rows: Array, size: float) -> tuple[Array, Array]:
    """Steps (N, 4) along the free motions of passes (N, 24) at which ways down begin, and their lengths (N,) in mm: shorter
    where the motion bends so much that they would lie elsewhere."""
    motions, seconds = rows[:, MOTION : MOTION + 3], np.abs(rows[:, SECOND])
    speeds = np.abs(motions[:, 0]) * size + np.hypot(motions[:, 1], motions[:, 2])
    bent = 2.0 * MOST_BEND * speeds * speeds
    lengths = np.where(
        seconds * BESIDE > bent, np.maximum(bent / np.maximum(seconds, 1e-300), SHORTEST), np.full(len(rows), BESIDE)
    )
    steps = np.zeros((len(rows), 4))
    steps[:, :3] = (lengths / speeds)[:, None] * motions
    return steps, lengths


def starts_off(rows: Array, size: float) -> tuple[Array, Array]:
    """Where ways down begin, to one and the other side of each of some passes (N, 24): configurations (2 N, 4), and how long
    their first steps are in mm (2 N,)."""
    (steps, lengths), configs = steps_off(rows, size), rows[:, CONFIG]
    return np.stack([configs + steps, configs - steps], axis=1).reshape(-1, 4), np.repeat(lengths / 2.0, 2)


@frozen(eq=False)
class Followed:
    """Ways that were followed.

    Parameters
    ----------
    numbers : (N, 2) of the ways off both sides of each candidate, -1 as long as they are not known.
    nodes, how : along them, and how they end, as of ``Closing.followed``.
    """

    numbers: IntArray
    nodes: Nodes
    how: NDArray[np.int8]


@define(eq=False)
class WaysDown:
    """The ways down of a group of pegs.

    Parameters
    ----------
    closing : the jaws with these pegs alone.
    candidates : (N, 24) their equilibria.
    known : what was followed so far.
    """

    closing: Closing
    candidates: Array
    known: Followed = field(init=False)

    def __attrs_post_init__(self) -> None:
        none = Nodes(np.zeros((0, 6)), np.zeros(1, np.int64))
        self.known = Followed(np.full((len(self.candidates), 2), -1), none, np.zeros(0, np.int8))

    def off(self, rows: IntArray) -> Followed:
        """The ways off some of the candidates, those known, and followed, before among others."""
        # Another thread may follow some at the same time: what one of them found is lost then, and found again.
        known = self.known
        new = rows[known.numbers[rows, 0] < 0]
        if len(new):
            starts, first = starts_off(self.candidates[new], self.closing.size)
            every = self.candidates
            is_seat = (every[:, DOUBT] == 0.0) & ((every[:, SECOND] > 0.0) | (every[:, CONTACTS] == 4.0))
            nodes, how = self.closing.followed(starts, first, every[is_seat][:, CONFIG])
            numbers = np.array(known.numbers)
            numbers[new] = len(known.how) + np.arange(len(starts)).reshape(-1, 2)
            known = Followed(numbers, known.nodes.joined(nodes), np.concatenate([known.how, how]))
            self.known = known
        return known


def both_ways_down(found: Equilibria, closing: Closing, seats: Array) -> tuple[Array, Array, NDArray[np.int8]]:
    """Where the ways down off both sides of all passes begin, where they end (2 N, 4), and how.

    Parameters
    ----------
    seats : (M, 4) configurations at which closing is known to end.
    """
    starts, first = starts_off(found.passes, closing.size)
    ends, how = np.array(starts), np.full(len(starts), AT_REST, np.int8)
    lengths, left = np.stack([first, first], axis=1), np.ones(len(starts), np.bool_)
    for number, (group, down) in enumerate(found.groups):
        chosen = np.flatnonzero(found.origins[:, 0] == number)
        if len(chosen):
            known = down.off(found.origins[chosen, 1])
            ways, lasts = free_ways(group, known, known.numbers[found.origins[chosen, 1]].ravel(), closing)
            mine = (2 * chosen[:, None] + [0, 1]).ravel()
            begun = lasts >= known.nodes.begins[ways]
            reached = known.nodes.rows[lasts[begun]]
            ends[mine[begun]], lengths[mine[begun]] = reached[:, :4] + group.shift, reached[:, 4:]
            left[mine] = ~begun | (lasts + 1 < known.nodes.begins[ways + 1]) | (known.how[ways] != AT_REST)
    ends[left], how[left] = closing.run(ends[left], lengths[left], seats)
    return starts, ends, how


def free_ways(group: Group, known: Followed, ways: IntArray, closing: Closing) -> tuple[IntArray, IntArray]:
    """Some ways of a group, and the last node of each at which the pattern's other pegs are not in the part."""
    others = np.array([peg for peg in range(len(closing.pattern.pegs)) if peg not in group.numbers], np.int64)
    most, lasts = LONGEST_STEP * min(closing.pattern.radii), np.empty(len(ways), np.int64)
    work = closing.obstacles, np.empty(4), np.empty((4, 2)), np.empty((4, 3))
    free_until(ways, known.nodes.rows, known.nodes.begins, group.shift, others, most, *work, lasts)
    return ways, lasts
