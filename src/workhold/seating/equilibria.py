"""All equilibria of a pattern of pegs and a part, sorted into seats, passes and what is loose or not settled."""

from __future__ import annotations

from math import pi, tau

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.conventions import SAME_POSE
from workhold.kernels.seating.candidates import complete_third, complete_three, complete_two, settle
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CLEAR,
    CONTACTS,
    DEPTH,
    DOUBT,
    FORCE,
    PLACE_X,
    PLACE_Y,
    RESIDUAL,
    SECOND,
    SEPARATION,
    THETA,
)
from workhold.kernels.seating.four_contacts import third_of_jaw, two_holdings
from workhold.kernels.seating.three_contacts import ROOT_LENGTH, three_contacts
from workhold.seating.balance import settle_on_wall
from workhold.seating.common_normals import squeezed
from workhold.seating.families import Family, Finder, families
from workhold.seating.fence import fence_candidates
from workhold.seating.holdings import Holdings, filled
from workhold.seating.locus import Locus
from workhold.seating.pattern import Pattern
from workhold.seating.sliding import slid
from workhold.seating.tangent import at_tangencies
from workhold.seating.wall_families import on_wall

__all__ = ["Equilibria", "equilibria"]

Array = NDArray[np.float64]

# No unit. Forces balance to this, per unit of jaw force; each is above the second.
BALANCED, LEAST_FORCE = 1e-7, 1e-9
# mm. Pegs that do not touch may be in the part by this much: rounding.
CLEAR_SLACK = 1e-7
# The same of what bounds leave in doubt, which is known less well.
BALANCED_IN_DOUBT, CLEAR_IN_DOUBT = 1e-3, 1e-5
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
    """

    seats: Array
    passes: Array
    loose: list[Family]
    doubtful: Array


def equilibria(locus: Locus, pattern: Pattern, size: float) -> Equilibria:
    """All equilibria of a pattern; ``size`` in mm, of the part, is what moments are divided by."""
    if pattern.wall is not None:
        return on_fence(locus, pattern, size)
    holdings = Holdings.of(locus, pattern)
    # Curves run past the ends of pieces by a hair, and so do the pieces that their roots are sought on.
    given, sought = holdings.given, holdings.given._replace(rows=np.array(locus.loose))
    stack, pockets = np.empty((DEPTH, 2)), locus.pocket_pieces
    three = filled(ROOT_LENGTH, 1024, three_contacts, holdings.cells, sought, locus.discs, pattern.stop, stack)
    two = filled(ROOT_LENGTH, 1024, two_holdings, holdings.of_jaw(0), holdings.of_jaw(1), sought, stack)
    third = filled(ROOT_LENGTH, 1024, third_of_jaw, holdings.cells, sought, locus.discs, stack)
    candidates = np.concatenate(
        [
            filled(CANDIDATE_LENGTH, len(three) + 1, complete_three, three, given, pockets),
            filled(CANDIDATE_LENGTH, len(two) + 1, complete_two, two, given, pockets),
            filled(
                CANDIDATE_LENGTH, 8 * len(third) + 16, complete_third, third, given, pockets, np.empty(CANDIDATE_LENGTH)
            ),
            np.array(
                squeezed(pattern, locus.common_normals) + slid(locus, pattern, holdings) + at_tangencies(locus, pattern)
            ).reshape(-1, CANDIDATE_LENGTH),
        ]
    )
    candidates = candidates[pattern.reaches(candidates[:, SEPARATION])]
    settle(candidates, given, size, np.empty((4, 4)), np.empty((4, 5)))
    return sorted_out(candidates, families(locus, pattern, holdings.slides))


def on_fence(locus: Locus, pattern: Pattern, size: float) -> Equilibria:
    """The same between a wall, a locator and a tip."""
    candidates = np.array(squeezed(pattern, locus.common_normals) + fence_candidates(locus, pattern))
    candidates = candidates.reshape(-1, CANDIDATE_LENGTH)
    settle_on_wall(candidates, locus, pattern, size)
    return sorted_out(candidates, families(locus, pattern, (), on_wall(Finder(locus, pattern))))


def sorted_out(candidates: Array, loose: list[Family]) -> Equilibria:
    """Candidates whose forces are known as seats and passes, beside what is loose."""
    used = np.arange(4) < candidates[:, CONTACTS, None]
    forces = np.where(used, candidates[:, FORCE : FORCE + 4], np.inf)
    pressed, doubt = forces.min(axis=1, initial=np.inf) > LEAST_FORCE, candidates[:, DOUBT] != 0.0
    sure = pressed & ~doubt & (candidates[:, RESIDUAL] < BALANCED) & (candidates[:, CLEAR] > -CLEAR_SLACK)
    rest = pressed & doubt & (candidates[:, RESIDUAL] < BALANCED_IN_DOUBT) & (candidates[:, CLEAR] > -CLEAR_IN_DOUBT)
    found = once(candidates[sure], SAME_POSE, SAME)
    four = found[:, CONTACTS] == 4.0
    hardest = np.argsort(-candidates[rest, FORCE : FORCE + 4].sum(axis=1), kind="stable")
    return Equilibria(
        found[four | (found[:, SECOND] > 0.0)],
        found[~four & (found[:, SECOND] < 0.0)],
        loose,
        once(candidates[rest][hardest], SAME_DOUBT, SAME_DOUBT),
    )


def once(rows: Array, turn: float, shift: float) -> Array:
    """Candidates, each configuration once, the first of those that agree; ordered by separation."""
    kept: list[int] = []
    for k, row in enumerate(rows):
        near = rows[kept]
        same = np.abs((near[:, THETA] - row[THETA] + pi) % tau - pi) < turn
        for column in (PLACE_X, PLACE_Y, SEPARATION):
            same &= np.abs(near[:, column] - row[column]) < shift
        same &= near[:, CONTACTS] == row[CONTACTS]
        if not same.any():
            kept.append(k)
    chosen = rows[kept]
    return np.asarray(chosen[np.argsort(chosen[:, SEPARATION], kind="stable")])
