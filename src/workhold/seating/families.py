"""Loose equilibria: sets of configurations with one S along which the part slides on flat faces, or turns on concentric
arcs: where it is free along the ways that it can go (``seating.loose_ways``)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import nan

import numpy as np
from attrs import define, frozen
from numpy.typing import NDArray

from workhold.kernels.base.feature import IS_ARC
from workhold.kernels.seating.columns import Families, Obstacles, Ways
from workhold.kernels.seating.freedom import free_runs, keep_free
from workhold.kernels.seating.loose import write_each_once
from workhold.seating.groups import Group
from workhold.seating.locus import Locus
from workhold.seating.pattern import Pattern

__all__ = ["Contact", "Finder", "Way", "joined", "of_pattern"]

Array = NDArray[np.float64]
# Configurations by which a slide is told.
SLIDE_STEPS = 144
# mm. Shorter slides are none; separations this near are one.
SHORTEST, SAME = 1e-6, 1e-6
Contact = tuple[int, int]
NO_FAMILIES = Families.room(0, 0)
NO_WAYS = Ways.room(0, 0)


@frozen(eq=False)
class Way:
    """Configurations with one separation between which the part can go while some contacts stay.

    Parameters
    ----------
    configs : (N, 4) along it.
    contacts : pegs and the pieces that they touch all along.
    is_closed : whether the last one is beside the first.
    across : (2,) direction in which the part gives way to both sides, or None where it does not.
    """

    configs: Array
    contacts: list[Contact]
    is_closed: bool
    across: tuple[float, float] | None


def of_pattern(told: Sequence[tuple[Group, Ways]]) -> Ways:
    """The ways of groups of pegs as those of their pattern."""
    some = [(group, ways) for group, ways in told if len(ways.counts)]
    if not some:
        return NO_WAYS
    out = Ways(*(np.concatenate(same) for same in zip(*(ways for _, ways in some), strict=True)))
    shifts = np.repeat([group.shift for group, _ in some], [len(ways.configs) for _, ways in some], axis=0)
    np.add(out.configs, shifts, out=out.configs)
    numbers = [[*group.numbers, -1, -1][:4] for group, _ in some]
    return out._replace(pegs=np.repeat(numbers, [len(ways.counts) for _, ways in some], axis=0))


def joined(parts: Sequence[Families]) -> Families:
    """Loose sets, one after the other."""
    rows, configs, _, closed, across = (np.concatenate(same) for same in zip(NO_FAMILIES, *parts, strict=True))
    counts = [np.diff(part.begins) for part in parts]
    return Families(rows, configs, np.cumsum(np.concatenate([np.zeros(1, np.int64), *counts])), closed, across)


@define(frozen=True, eq=False, slots=False)
class Finder:
    """What families are sought with."""

    locus: Locus
    pattern: Pattern

    @property
    def rows(self) -> Array:
        """The pieces."""
        return self.locus.rows

    @cached_property
    def lines(self) -> list[int]:
        """Numbers of the straight pieces."""
        return np.flatnonzero(self.rows[:, IS_ARC] == 0.0).tolist()

    @cached_property
    def around(self) -> Obstacles:
        """What keeps the pegs off the part; no turn is counted, and nothing stops."""
        return self.locus.obstacles(self.pattern, 1.0, 0.0)

    @property
    def obstacles(self) -> int:
        """How many pegs and walls there are."""
        return len(self.pattern.pegs) + (self.pattern.wall is not None)

    def free(self, ways: Sequence[Way]) -> Ways:
        """The ways along which the part is free somewhere, with what is known of it."""
        every = Ways.room(len(ways), sum(len(way.configs) for way in ways))
        if not ways:
            return every
        np.concatenate([way.configs for way in ways], out=every.configs)
        every.pegs[:, : self.obstacles] = np.arange(self.obstacles)
        for k, way in enumerate(ways):
            every.counts[k], every.closed[k], every.across[k] = len(way.configs), way.is_closed, way.across or nan
            for peg, piece in way.contacts:
                every.pieces[k, peg] = piece
        count = keep_free(every, self.around, np.empty((len(self.pattern.pegs), 4)))
        return every.first(count)

    def cut(self, ways: Ways) -> Families:
        """The free runs of ways at separations that are reached."""
        if not len(ways.counts):
            return NO_FAMILIES
        # At least every second configuration hinders between runs; each has two ends besides.
        most, pegs = len(ways.configs) // 2 + len(ways.counts), len(self.pattern.pegs)
        out = Families.room(most, len(ways.configs) + 2 * most)
        low, high = self.pattern.stop + SAME, self.pattern.widest - SAME
        clear, seen = np.empty((len(ways.configs), self.obstacles)), np.empty((pegs, 4))
        touched, work = np.empty(pegs, np.int64), np.empty((4, 4))
        return out.first(free_runs(ways, low, high, self.around, clear, seen, touched, work, out))

    def families(self, found: Families) -> Families:
        """Those found, each once: the one with the most contacts of those that lie in each other."""
        if not len(found.rows):
            return found
        out = Families.room(len(found.rows), len(found.configs))
        return out.first(write_each_once(found, 1.0, SAME, out))
