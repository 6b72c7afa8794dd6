"""All equilibria of a pattern of pegs and a part, sorted into seats, passes and what is loose or not settled."""

from __future__ import annotations

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.conventions import SAME_POSE
from workhold.kernels.seating.candidates import complete_two, fourths
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CLEAR,
    CONTACTS,
    DEPTH,
    FORCE,
    SECOND,
    SEPARATION,
    Families,
)
from workhold.kernels.seating.four_contacts import two_holdings
from workhold.kernels.seating.freedom import first_of_each
from workhold.kernels.seating.slides import slides_held
from workhold.kernels.seating.three_contacts import ROOT_LENGTH
from workhold.seating.alone import Kept, alone, balanced, settled
from workhold.seating.balance import settle_on_wall
from workhold.seating.common_normals import squeezed
from workhold.seating.families import Finder, joined, of_pattern
from workhold.seating.fence import fence_candidates
from workhold.seating.filled import filled
from workhold.seating.groups import Group, groups_of
from workhold.seating.holdings import Holdings
from workhold.seating.locus import Locus
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
    work = np.empty((DEPTH, 2)), np.empty(len(jaws[1]), np.int64)
    roots = filled(ROOT_LENGTH, 1024, two_holdings, *jaws, holdings.sought, *work)
    candidates = [filled(CANDIDATE_LENGTH, len(roots) + 1, complete_two, roots, given, pockets)]
    groups, ways, origins = list[tuple[Group, WaysDown]](), [], [nowhere(len(candidates[0]))]
    kept = Kept.on(locus)
    for group in groups_of(pattern):
        own = alone(kept, locus, group, size)
        candidates.append(group.candidates(own.candidates))
        rows = np.empty((len(own.candidates), 2), np.int64)
        rows[:, 0], rows[:, 1] = len(groups), own.down.first + np.arange(len(rows))
        origins.append(rows)
        groups.append((group, own.down))
        if len(own.fixed):
            jaw, fixed = group.sides[0], group.candidates(own.fixed)
            candidates.append(filled(CANDIDATE_LENGTH, 4 * len(fixed) + 64, fourths, fixed, jaw, given))
            origins.append(nowhere(len(candidates[-1])))
        ways.append((group, own.ways))
    candidates.append(filled(CANDIDATE_LENGTH, 256, slides_held, holdings.slides, *jaws, given, pockets))
    every, whose = np.concatenate(candidates), np.concatenate([*origins, nowhere(len(candidates[-1]))])
    reached = pattern.reaches(every[:, SEPARATION])
    every = settled(every[reached], given, size)
    return sorted_out(every, finder.families(finder.cut(of_pattern(ways))), whose[reached], tuple(groups))


def on_fence(locus: Locus, pattern: Pattern, size: float) -> Equilibria:
    """The same between a wall, a locator and a tip."""
    pressed = np.array(squeezed(pattern, locus.common_normals)).reshape(-1, CANDIDATE_LENGTH)
    candidates = np.concatenate([pressed, fence_candidates(locus, pattern)])
    settle_on_wall(candidates, locus, pattern, size)
    finder = Finder(locus, pattern)
    loose = joined([finder.cut(finder.free(finder.on_one_line())), *on_wall(finder)])
    return sorted_out(candidates, finder.families(loose), nowhere(len(candidates)))


def nowhere(count: int) -> NDArray[np.int64]:
    """The origins (N, 2) of so many candidates that are of no group."""
    return np.full((count, 2), -1)


def sorted_out(
    candidates: Array, loose: Families, origins: NDArray[np.int64], groups: tuple[tuple[Group, WaysDown], ...] = ()
) -> Equilibria:
    """Candidates whose forces are known as seats and passes, beside what is loose; where they are from as of Equilibria."""
    sure, rest = balanced(candidates)
    sure &= candidates[:, CLEAR] > -CLEAR_SLACK
    rest &= candidates[:, CLEAR] > -CLEAR_IN_DOUBT
    found = candidates[sure]
    order = once(found, SAME_POSE, SAME)
    found, whose = found[order], origins[sure][order]
    four = found[:, CONTACTS] == 4.0
    is_pass = ~four & (found[:, SECOND] < 0.0)
    doubtful = candidates[rest]
    doubtful = doubtful[np.argsort(-doubtful[:, FORCE : FORCE + 4].sum(axis=1), kind="stable")]
    return Equilibria(
        found[four | (found[:, SECOND] > 0.0)],
        found[is_pass],
        loose,
        doubtful[once(doubtful, SAME_DOUBT, SAME_DOUBT)],
        whose[is_pass],
        groups,
    )


def once(rows: Array, turn: float, shift: float) -> NDArray[np.int64]:
    """Numbers of candidates, each configuration once, the first of those that agree; ordered by separation."""
    kept = np.empty(len(rows), np.int64)
    kept = kept[: first_of_each(rows, turn, shift, kept)]
    return kept[np.argsort(rows[kept, SEPARATION], kind="stable")]
