"""What two or three pegs of a pattern do by themselves, found once for all patterns in which they stand alike."""

from __future__ import annotations

from math import inf
from threading import Lock

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.kernels.seating.candidates import NO_BALANCE, complete_third, complete_three, settle, tell_balance
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    DEPTH,
    SEPARATION,
    Given,
    Ways,
)
from workhold.kernels.seating.concentric import about_one_center
from workhold.kernels.seating.four_contacts import third_of_jaw
from workhold.kernels.seating.slides import slides_squared, slides_stopped
from workhold.kernels.seating.three_contacts import ROOT_LENGTH, three_contacts
from workhold.seating.common_normals import squeezed
from workhold.seating.descents import Closing
from workhold.seating.families import NO_WAYS, Finder
from workhold.seating.groups import Group
from workhold.seating.growing_rows import filled, with_room
from workhold.seating.holdings import Holdings
from workhold.seating.locus import Locus
from workhold.seating.loose_ways import on_one_center, on_one_line, on_parallel_lines
from workhold.seating.tangent import tangent
from workhold.seating.ways_down import Trodden, WaysDown

__all__ = ["Alone", "Kept", "alone", "balanced", "settled"]

Array = NDArray[np.float64]
# Groups of which something is kept, and nodes of their ways down, of 80 bytes; beyond, all are forgotten.
MOST_KEPT, MOST_NODES = 1024, 600_000
NONE = np.zeros((0, CANDIDATE_LENGTH))
# Of a group its candidates and the ways, as of ``Alone``.
Told = tuple[Array, Ways]


@frozen(eq=False)
class Alone:
    """What a group of pegs does, in its own frame.

    Parameters
    ----------
    first, end : of its candidates among all that are kept. They are those of two or three contacts in which forces balance,
        or of pegs of one jaw those in which three contacts fix the part: its place that at separation 0.
    ways : that the part can go between the pegs with one separation.
    down : off the candidates, as far as they were followed.
    """

    first: int
    end: int
    ways: Ways
    down: WaysDown


@define(eq=False)
class Kept:
    """What is known of groups on a part.

    Parameters
    ----------
    found : what each does, by how its pegs stand.
    trodden : their ways down.
    candidates : (C, 24) of all groups; there is room for more. What was written stays where it is.
    count : how many there are.
    """

    found: dict[tuple[object, ...], Alone] = field(factory=dict)
    trodden: Trodden = field(factory=Trodden)
    candidates: Array = field(factory=lambda: NONE)
    count: int = 0
    lock: Lock = field(factory=Lock)

    def with_candidates(self, rows: Array) -> int:
        """The number of the first of some further candidates (N, 24)."""
        with self.lock:
            first = self.count
            self.candidates = with_room(self.candidates, first, len(rows))
            self.candidates[first : first + len(rows)] = rows
            self.count += len(rows)
        return first

    @classmethod
    def on(cls, locus: Locus) -> Kept:
        """What is kept of the groups on a part: nothing when it has become too much. Who has it goes on with it."""
        kept = locus.once(cls.empty)
        is_full = len(kept.found) >= MOST_KEPT or kept.trodden.counts[1] > MOST_NODES
        return locus.once(cls.empty, anew=True) if is_full else kept

    @classmethod
    def empty(cls, _: Locus) -> Kept:
        """Nothing so far."""
        return cls()


def alone(kept: Kept, locus: Locus, group: Group, size: float) -> Alone:
    """What a group does; ``size`` in mm as of ``equilibria``."""
    key = size, group.key
    found = kept.found.get(key)
    if found is None:
        kind = jaw_alone if group.is_of_a_jaw else two_alone if len(group.sides) == 2 else three_alone
        candidates, ways = kind(locus, group, size)
        down = WaysDown(Closing(locus, group.pattern, size), NONE if group.is_of_a_jaw else candidates, kept.trodden)
        first = kept.with_candidates(candidates)
        found = kept.found[key] = Alone(first, first + len(candidates), ways, down)
    return found


def two_alone(locus: Locus, group: Group, size: float) -> Told:
    """Of a peg of each jaw: on common normals, and on parallel faces or arcs of one centre."""
    pattern, given = group.pattern, Holdings.of_jaw_alone(locus, group).given
    candidates = np.array(squeezed(locus, pattern)).reshape(-1, CANDIDATE_LENGTH)
    return in_balance(candidates, given, size), Finder(locus, pattern).free(on_one_line(locus, pattern))


def three_alone(locus: Locus, group: Group, size: float) -> Told:
    """Of two pegs of a jaw and one of the other."""
    # The only peg of the other jaw holds the part in pockets alone.
    pattern, holdings = group.pattern, Holdings.of_jaw_alone(locus, group)
    given, slides = holdings.given, holdings.slides
    [(known, _, _)] = holdings.jaws.values()
    work = np.empty((DEPTH, 2)), np.empty((5, len(locus.discs)))
    sought = known.cells, known.middles, holdings.sought, locus.discs, pattern.stop
    roots = filled(ROOT_LENGTH, 1024, three_contacts, *sought, *work)
    candidates = [
        filled(CANDIDATE_LENGTH, len(roots) + 1, complete_three, roots, given, locus.pocket_pieces),
        *([filled(CANDIDATE_LENGTH, 256, slides_squared, slides, given)] if len(slides) else []),
        *tangent(locus, pattern, given),
        filled(CANDIDATE_LENGTH, 64, about_one_center, given, pattern.stop, pattern.widest),
    ]
    every = np.concatenate(candidates)
    ways = [*on_parallel_lines(locus, pattern, slides, given), *on_one_center(locus, pattern)]
    reached = every[pattern.reaches(every[:, SEPARATION])]
    return in_balance(reached, given, size), Finder(locus, pattern).free(ways)


def jaw_alone(locus: Locus, group: Group, _: float) -> Told:
    """Of pegs of one jaw that touch in three places: three, or two of which one is in a pocket."""
    holdings, stack = Holdings.of_jaw_alone(locus, group), np.empty((DEPTH, 2))
    [(known, _, _)] = holdings.jaws.values()
    roots = filled(ROOT_LENGTH, 1024, third_of_jaw, known.cells, known.middles, holdings.sought, locus.discs, stack)
    fixed = [
        filled(CANDIDATE_LENGTH, len(roots) + 1, complete_third, roots, holdings.given, locus.pocket_pieces),
        filled(CANDIDATE_LENGTH, 256, slides_stopped, holdings.slides, holdings.given),
    ]
    return np.concatenate(fixed), NO_WAYS


def settled(candidates: Array, given: Given, size: float) -> Array:
    """Candidates (N, 24) with their forces and clearances."""
    settle(candidates, given, size, np.empty((4, 4)), np.empty((4, 5)))
    return candidates


def balanced(candidates: Array, slack: float, slack_in_doubt: float) -> NDArray[np.int8]:
    """Whether all contacts of settled candidates (N, 24) press and forces balance: ``kernels.seating.candidates``."""
    told = np.empty(len(candidates), np.int8)
    tell_balance(candidates, slack, slack_in_doubt, told)
    return told


def in_balance(candidates: Array, given: Given, size: float) -> Array:
    """Candidates of a group, those that may be equilibria."""
    return np.asarray(candidates[balanced(settled(candidates, given, size), inf, inf) != NO_BALANCE])
