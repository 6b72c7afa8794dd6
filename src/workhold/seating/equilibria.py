"""All equilibria of a pattern of pegs and a part, sorted into seats, passes and what is loose or not settled."""

from __future__ import annotations

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.conventions import SAME_POSE
from workhold.kernels.seating.candidates import DOUBTFUL, IN_BALANCE, complete_two
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CELL_LENGTH,
    CONTACTS,
    DEPTH,
    FORCE,
    SECOND,
    SEPARATION,
    Families,
    Ways,
)
from workhold.kernels.seating.four_contacts import two_holdings
from workhold.kernels.seating.freedom import first_of_each
from workhold.kernels.seating.gathering import GATHERED_LENGTH, GROUP, gathered
from workhold.kernels.seating.slides import slides_held
from workhold.kernels.seating.three_contacts import ROOT_LENGTH
from workhold.seating.alone import Kept, alone, balanced, settled
from workhold.seating.balance import settle_on_wall
from workhold.seating.common_normals import squeezed
from workhold.seating.families import Finder, joined, of_pattern
from workhold.seating.fence import fence_candidates
from workhold.seating.groups import Group, groups_of
from workhold.seating.growing_rows import filled
from workhold.seating.holdings import Holdings
from workhold.seating.locus import Locus
from workhold.seating.loose_ways import on_one_line
from workhold.seating.pattern import Pattern
from workhold.seating.wall_families import on_wall
from workhold.seating.ways_down import WaysDown

__all__ = ["Equilibria", "equilibria"]

Array = NDArray[np.float64]

# mm. Pegs that do not touch may be in the part by this much: rounding.
CLEAR_SLACK = 1e-7
# The same where bounds leave in doubt whether the place exists, which is known less well.
CLEAR_IN_DOUBT = 1e-5
# mm. Configurations this near are one equilibrium; those in doubt this near are told as one.
SAME, SAME_DOUBT = 1e-5, 0.1


@define(frozen=True, eq=False)
class Equilibria:
    """What was found.

    Parameters
    ----------
    seats : (N, 24) candidates at which the separation has a strict minimum, ordered by it.
    passes : (N, 24) those with one way down, to both sides of the direction of motion.
    loose : sets of equilibria with one separation.
    doubtful : (N, 24) those of which bounds did not decide that they exist, of near ones the one that presses hardest.
    origins : (N, 2) for each pass the number of the group that makes it, and of its candidate among all that are kept; -1
        where none does.
    groups : what is known of the ways down of groups.
    """

    seats: Array
    passes: Array
    loose: Families
    doubtful: Array
    origins: NDArray[np.int64]
    groups: tuple[tuple[Group, WaysDown], ...] = ()


def equilibria(locus: Locus, pattern: Pattern, size: float) -> Equilibria:
    """All equilibria of a pattern; ``size`` in mm, of the part, is what moments are divided by."""
    if pattern.wall is not None:
        return on_fence(locus, pattern, size)
    holdings, finder = Holdings.of(locus, pattern), Finder(locus, pattern)
    given, jaws, pockets = holdings.given, (holdings.of_jaw(0), holdings.of_jaw(1)), locus.pocket_pieces
    work = np.empty((2, CELL_LENGTH)), np.empty((DEPTH, 2)), np.empty(len(jaws[1].cells), np.int64)
    roots = filled(ROOT_LENGTH, 1024, two_holdings, *jaws, holdings.sought, *work)
    two = filled(CANDIDATE_LENGTH, len(roots) + 1, complete_two, roots, given, pockets)
    slid = filled(CANDIDATE_LENGTH, 256, slides_held, holdings.slides, *jaws, given, pockets)
    kept, ends, told = Kept.on(locus), (pattern.stop, pattern.widest), list[tuple[float, ...]]()
    groups, ways = list[tuple[Group, WaysDown]](), list[tuple[Group, Ways]]()
    for group in groups_of(pattern):
        own = alone(kept, locus, group, size)
        told.append((own.first, own.end, own.down.first, *group.told))
        groups.append((group, own.down))
        ways.append((group, own.ways))
    room = len(two) + len(slid) + sum(int(end - first) for first, end, *_ in told) + 256
    among = np.array(told, dtype=np.float64), kept.candidates, two, slid, *ends, given, np.empty(CANDIDATE_LENGTH)
    found = filled(GATHERED_LENGTH, room, gathered, *among)
    every = settled(np.ascontiguousarray(found[:, :GROUP]), given, size)
    loose = finder.families(finder.cut(of_pattern(ways)))
    return sorted_out(every, loose, found[:, GROUP:].astype(np.int64), tuple(groups))


def on_fence(locus: Locus, pattern: Pattern, size: float) -> Equilibria:
    """The same between a wall, a locator and a tip."""
    pressed = np.array(squeezed(locus, pattern)).reshape(-1, CANDIDATE_LENGTH)
    candidates = np.concatenate([pressed, fence_candidates(locus, pattern)])
    settle_on_wall(candidates, locus, pattern, size)
    finder = Finder(locus, pattern)
    loose = joined([finder.cut(finder.free(on_one_line(locus, pattern))), *on_wall(finder)])
    return sorted_out(candidates, finder.families(loose), np.full((len(candidates), 2), -1))


def sorted_out(
    candidates: Array, loose: Families, origins: NDArray[np.int64], groups: tuple[tuple[Group, WaysDown], ...] = ()
) -> Equilibria:
    """Candidates whose forces are known as seats and passes, beside what is loose; where they are from as of Equilibria."""
    told = balanced(candidates, CLEAR_SLACK, CLEAR_IN_DOUBT)
    sure = told == IN_BALANCE
    found = candidates[sure]
    order = once(found, SAME_POSE, SAME)
    found, whose = found[order], origins[sure][order]
    four = found[:, CONTACTS] == 4.0
    is_pass = ~four & (found[:, SECOND] < 0.0)
    doubtful = candidates[told == DOUBTFUL]
    if len(doubtful):
        doubtful = doubtful[np.argsort(-doubtful[:, FORCE : FORCE + 4].sum(axis=1), kind="stable")]
        doubtful = doubtful[once(doubtful, SAME_DOUBT, SAME_DOUBT)]
    seats, passes = found[four | (found[:, SECOND] > 0.0)], found[is_pass]
    return Equilibria(seats, passes, loose, doubtful, whose[is_pass], groups)


def once(rows: Array, turn: float, shift: float) -> NDArray[np.int64]:
    """Numbers of candidates, each configuration once, the first of those that agree; ordered by separation."""
    kept = np.empty(len(rows), np.int64)
    kept = kept[: first_of_each(rows, turn, shift, kept)]
    return kept[np.argsort(rows[kept, SEPARATION], kind="stable")]
