"""Equilibria of subsets of a pattern's pegs, found once for all patterns that share a subset.

Two or three of a pattern's pegs balance the part, or pegs of one jaw fix it. Such a subset stands alike in
many patterns of one lattice (``seating.pattern``), so its equilibria are kept with the part.
"""

from __future__ import annotations

from math import inf
from threading import Lock

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.kernels.seating.candidates import NO_BALANCE, complete_third, complete_three
from workhold.kernels.seating.columns import CANDIDATE_LENGTH, DEPTH, SEPARATION, Given, SelfMotions
from workhold.kernels.seating.four_contacts import third_of_jaw
from workhold.kernels.seating.parallel_and_concentric import about_one_center
from workhold.kernels.seating.slides import slides_blocked, slides_squared
from workhold.kernels.seating.three_contacts import ROOT_LENGTH, three_contacts
from workhold.seating.antipodal_contacts import antipodal_candidates, parallel_candidates
from workhold.seating.closing import Closing, DescentCache, DescentPaths, filled, with_room
from workhold.seating.contact_forces import verdicts, with_forces
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.pattern import PegSubset
from workhold.seating.self_motions import (
    NO_MOTIONS,
    ManifoldFinder,
    on_one_center,
    on_one_line,
    on_parallel_lines,
)
from workhold.seating.two_contact_curves import TwoContactCurves

__all__ = ["SubsetCache", "SubsetEquilibria", "equilibria_of_subset"]

Array = NDArray[np.float64]
# Subsets of which something is kept, and nodes of their descent paths, of 80 bytes; with more, all are
# forgotten.
MOST_KEPT, MOST_NODES = 1024, 600_000
NONE = np.zeros((0, CANDIDATE_LENGTH))
# Candidates of a subset and its self-motions, see ``SubsetEquilibria``.
Found = tuple[Array, SelfMotions]


@frozen(eq=False)
class SubsetEquilibria:
    """The equilibria of a subset of pegs, in its own frame.

    Parameters
    ----------
    first, end : where the subset's candidates stand among all that are kept. In them two or three contacts
        balance; of pegs of one jaw three contacts fix the part, whose place is that at separation 0.
    motions : self-motions of the part between the pegs.
    descents : paths off the candidates, as far as they were followed.
    """

    first: int
    end: int
    motions: SelfMotions
    descents: DescentPaths


@define(eq=False)
class SubsetCache:
    """The equilibria of subsets of pegs on a part that were found so far.

    Parameters
    ----------
    found : those of each subset, by how its pegs stand.
    descents : their descent paths.
    candidates : (C, 24) of all subsets; there is room for more. What was written stays where it is.
    count : how many candidates there are.
    """

    found: dict[tuple[object, ...], SubsetEquilibria] = field(factory=dict)
    descents: DescentCache = field(factory=DescentCache)
    candidates: Array = field(factory=lambda: NONE)
    count: int = 0
    lock: Lock = field(factory=Lock)

    def with_candidates(self, rows: Array) -> int:
        """Keeps further candidates (N, 24), and returns the number of the first."""
        with self.lock:
            first = self.count
            self.candidates = with_room(self.candidates, first, len(rows))
            self.candidates[first : first + len(rows)] = rows
            self.count += len(rows)
        return first

    @classmethod
    def on(cls, boundary: ObstacleBoundary) -> SubsetCache:
        """The cache of a part, or an empty one if that is full, which whoever has it goes on with."""
        kept = boundary.once(cls.empty)
        is_full = len(kept.found) >= MOST_KEPT or kept.descents.counts[1] > MOST_NODES
        return boundary.once(cls.empty, anew=True) if is_full else kept

    @classmethod
    def empty(cls, _: ObstacleBoundary) -> SubsetCache:
        """An empty cache."""
        return cls()


def equilibria_of_subset(
    kept: SubsetCache, boundary: ObstacleBoundary, subset: PegSubset, size: float
) -> SubsetEquilibria:
    """The equilibria of a subset, found now or before; ``size`` is the part's in mm."""
    key = size, subset.key
    found = kept.found.get(key)
    if found is None:
        kind = (
            jaw_equilibria
            if subset.is_of_a_jaw
            else pair_equilibria
            if len(subset.sides) == 2
            else triple_equilibria
        )
        candidates, motions = kind(boundary, subset, size)
        passes = NONE if subset.is_of_a_jaw else candidates
        descents = DescentPaths(Closing(boundary, subset.pattern, size), passes, kept.descents)
        first = kept.with_candidates(candidates)
        found = kept.found[key] = SubsetEquilibria(first, first + len(candidates), motions, descents)
    return found


def pair_equilibria(boundary: ObstacleBoundary, subset: PegSubset, size: float) -> Found:
    """Equilibria of a peg of each jaw: antipodal contacts, and self-motions along one line."""
    pattern, given = subset.pattern, TwoContactCurves.of_jaw_alone(boundary, subset).given
    candidates = antipodal_candidates(boundary, pattern)
    return in_balance(candidates, given, size), ManifoldFinder(boundary, pattern).free(
        on_one_line(boundary, pattern)
    )


def triple_equilibria(boundary: ObstacleBoundary, subset: PegSubset, size: float) -> Found:
    """Equilibria of two pegs of a jaw and one of the other."""
    # The only peg of the other jaw has two contacts in pockets alone.
    pattern, curves = subset.pattern, TwoContactCurves.of_jaw_alone(boundary, subset)
    given, slides = curves.given, curves.slides
    [(known, _, _)] = curves.jaws.values()
    work = np.empty((DEPTH, 2)), np.empty((5, len(boundary.discs)))
    sought = known.cells, known.middles, curves.sought, boundary.discs, pattern.stop
    roots = filled(ROOT_LENGTH, 1024, three_contacts, *sought, *work)
    candidates = [
        filled(CANDIDATE_LENGTH, len(roots) + 1, complete_three, roots, given, boundary.pocket_pieces),
        *([filled(CANDIDATE_LENGTH, 256, slides_squared, slides, given)] if len(slides) else []),
        *parallel_candidates(boundary, pattern, given),
        filled(CANDIDATE_LENGTH, 64, about_one_center, given, pattern.stop, pattern.widest),
    ]
    every = np.concatenate(candidates)
    motions = [*on_parallel_lines(boundary, pattern, slides, given), *on_one_center(boundary, pattern)]
    reached = every[pattern.reaches(every[:, SEPARATION])]
    return in_balance(reached, given, size), ManifoldFinder(boundary, pattern).free(motions)


def jaw_equilibria(boundary: ObstacleBoundary, subset: PegSubset, _: float) -> Found:
    """Poses that pegs of one jaw fix by three contacts: three pegs, or two of which one is in a pocket."""
    curves, stack = TwoContactCurves.of_jaw_alone(boundary, subset), np.empty((DEPTH, 2))
    [(known, _, _)] = curves.jaws.values()
    roots = filled(
        ROOT_LENGTH, 1024, third_of_jaw, known.cells, known.middles, curves.sought, boundary.discs, stack
    )
    fixed = [
        filled(CANDIDATE_LENGTH, len(roots) + 1, complete_third, roots, curves.given, boundary.pocket_pieces),
        filled(CANDIDATE_LENGTH, 256, slides_blocked, curves.slides, curves.given),
    ]
    return np.concatenate(fixed), NO_MOTIONS


def in_balance(candidates: Array, given: Given, size: float) -> Array:
    """The candidates of a subset that may be equilibria."""
    return np.asarray(candidates[verdicts(with_forces(candidates, given, size), inf, inf) != NO_BALANCE])
