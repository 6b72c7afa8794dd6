"""Loose equilibria: where a part is free along its self-motions, so that it rests anywhere along them.

Glossary
--------
equilibrium manifold : equilibria that are not isolated, with one separation: a nondegenerate critical
    manifold of R. Bott, "Nondegenerate critical manifolds", Annals of Mathematics 60 (1954).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import nan

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.kernels.base.feature import IS_ARC
from workhold.kernels.seating.columns import Manifolds, Obstacles, SelfMotions
from workhold.kernels.seating.equilibrium_manifolds import write_each_once
from workhold.kernels.seating.freedom import free_runs, keep_free
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.pattern import Pattern
from workhold.seating.peg_subsets import PegSubset
from workhold.seating.self_motions import SAME, SelfMotion

__all__ = ["ManifoldFinder", "joined", "of_pattern"]

Array = NDArray[np.float64]
NO_MANIFOLDS = Manifolds.room(0, 0)
NO_MOTIONS = SelfMotions.room(0, 0)


def of_pattern(found: Sequence[tuple[PegSubset, SelfMotions]]) -> SelfMotions:
    """The self-motions of subsets of pegs as those of their pattern."""
    some = [(subset, motions) for subset, motions in found if len(motions.counts)]
    if not some:
        return NO_MOTIONS
    out = SelfMotions(*(np.concatenate(same) for same in zip(*(motions for _, motions in some), strict=True)))
    shifts = np.repeat([subset.shift for subset, _ in some], [len(motions.configs) for _, motions in some], axis=0)
    np.add(out.configs, shifts, out=out.configs)
    numbers = [[*subset.numbers, -1, -1][:4] for subset, _ in some]
    return out._replace(pegs=np.repeat(numbers, [len(motions.counts) for _, motions in some], axis=0))


def joined(parts: Sequence[Manifolds]) -> Manifolds:
    """Manifolds, one after the other."""
    rows, configs, _, closed, across = (np.concatenate(same) for same in zip(NO_MANIFOLDS, *parts, strict=True))
    counts = [np.diff(part.begins) for part in parts]
    return Manifolds(rows, configs, np.cumsum(np.concatenate([np.zeros(1, np.int64), *counts])), closed, across)


@define(frozen=True, eq=False, slots=False)
class ManifoldFinder:
    """Finds the equilibrium manifolds of a pattern on a part.

    Parameters
    ----------
    boundary, pattern : of the part and the pegs.
    """

    boundary: ObstacleBoundary
    pattern: Pattern

    @property
    def rows(self) -> Array:
        """The pieces."""
        return self.boundary.rows

    @cached_property
    def lines(self) -> list[int]:
        """Numbers of the straight pieces."""
        return np.flatnonzero(self.rows[:, IS_ARC] == 0.0).tolist()

    @cached_property
    def around(self) -> Obstacles:
        """What keeps the pegs off the part, where turns and the stop do not count."""
        return self.boundary.obstacles(self.pattern, 1.0, 0.0)

    @property
    def obstacles(self) -> int:
        """How many pegs and walls there are."""
        return len(self.pattern.pegs) + (self.pattern.half_plane is not None)

    def free(self, motions: Sequence[SelfMotion]) -> SelfMotions:
        """The self-motions along which the part is free somewhere, with where it is known to be."""
        every = SelfMotions.room(len(motions), sum(len(motion.configs) for motion in motions))
        if not motions:
            return every
        np.concatenate([motion.configs for motion in motions], out=every.configs)
        every.pegs[:, : self.obstacles] = np.arange(self.obstacles)
        for k, motion in enumerate(motions):
            every.counts[k], every.closed[k] = len(motion.configs), motion.is_closed
            every.across[k] = motion.across or nan
            for peg, piece in motion.contacts:
                every.pieces[k, peg] = piece
        count = keep_free(every, self.around, np.empty((len(self.pattern.pegs), 4)))
        return every.first(count)

    def cut(self, motions: SelfMotions) -> Manifolds:
        """The free runs of self-motions at separations that are reached."""
        if not len(motions.counts):
            return NO_MANIFOLDS
        # At least every second configuration hinders between runs; each has two ends besides.
        most, pegs = len(motions.configs) // 2 + len(motions.counts), len(self.pattern.pegs)
        out = Manifolds.room(most, len(motions.configs) + 2 * most)
        low, high = self.pattern.stop + SAME, self.pattern.widest - SAME
        clear, seen = np.empty((len(motions.configs), self.obstacles)), np.empty((pegs, 4))
        touched, work = np.empty(pegs, np.int64), np.empty((4, 4))
        return out.first(free_runs(motions, low, high, self.around, clear, seen, touched, work, out))

    def distinct(self, found: Manifolds) -> Manifolds:
        """The manifolds found, each once: of those that lie in each other the one with the most contacts."""
        if not len(found.rows):
            return found
        out = Manifolds.room(len(found.rows), len(found.configs))
        return out.first(write_each_once(found, 1.0, SAME, out))
