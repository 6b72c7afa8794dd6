"""Loose equilibria: sets of configurations with one S along which the part slides on flat faces, or turns on concentric
arcs."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import combinations, product
from math import asin, atan2, cos, hypot, nan, sin, sqrt, tau

import numpy as np
from attrs import define, frozen
from numpy.typing import NDArray

from workhold.conventions import PARALLEL
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import Families, Given, Obstacles, Ways
from workhold.kernels.seating.freedom import free_runs, keep_free
from workhold.kernels.seating.loose import write_each_once
from workhold.kernels.seating.parallel import (
    AT_HIGH,
    AT_LOW,
    AT_SEPARATION,
    AT_THETA,
    OF_SLIDE,
    ON_THIRD,
    THIRD,
    THREE_FACES,
    on_three_faces,
)
from workhold.kernels.seating.slides import SLIDE_FIRST, SLIDE_ONE, SLIDE_SECOND, SLIDE_TWO
from workhold.seating.filled import filled
from workhold.seating.groups import Group
from workhold.seating.locus import Locus
from workhold.seating.pattern import Pattern

__all__ = ["Finder", "Way", "joined", "of_pattern"]

Array = NDArray[np.float64]
# Configurations by which a slide is told, and a turn.
SLIDE_STEPS, TURN_STEPS = 144, 384
# mm. Shorter slides are none; separations this near are one.
SHORTEST, SAME = 1e-6, 1e-6
# A force's share below this is none.
LEAST_SHARE = 1e-9
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
    def opposed(self) -> list[tuple[int, int]]:
        """Pairs of straight pieces that face away from each other."""
        along = self.rows[:, [AXIS_X, AXIS_Y]]
        return [(a, b) for a, b in product(self.lines, repeat=2) if np.abs(along[a] + along[b]).sum() <= PARALLEL]

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
        count = keep_free(every, self.around, np.empty((len(self.pattern.pegs), 3)))
        return every.first(count)

    def touch(self, contacts: list[Contact]) -> bool:
        """Whether pegs can touch the pieces that they are said to touch."""
        return all(self.locus.fits(self.pattern.right[peg], piece) for peg, piece in contacts)

    def cut(self, ways: Ways) -> Families:
        """The free runs of ways at separations that are reached."""
        if not len(ways.counts):
            return NO_FAMILIES
        # At least every second configuration hinders between runs; each has two ends besides.
        most, pegs = len(ways.configs) // 2 + len(ways.counts), len(self.pattern.pegs)
        out = Families.room(most, len(ways.configs) + 2 * most)
        low, high = self.pattern.stop + SAME, self.pattern.widest - SAME
        clear, seen = np.empty((len(ways.configs), self.obstacles)), np.empty((pegs, 3))
        touched, work = np.empty(pegs, np.int64), np.empty((4, 4))
        return out.first(free_runs(ways, low, high, self.around, clear, seen, touched, work, out))

    def sliding(
        self, theta: float, start: Array, line: Array, low: float, high: float, s: float, contacts: list[Contact]
    ) -> list[Way]:
        """The way of a part that slides with one peg, which stands at ``start``, on a line from a parameter to another."""
        if high - low < SHORTEST or not self.pattern.reaches(s, SAME):
            return []
        t = np.linspace(low, high, SLIDE_STEPS)
        x, y = line[X] + t * line[AXIS_X], line[Y] + t * line[AXIS_Y]
        c, d = cos(theta), sin(theta)
        every = np.ones(SLIDE_STEPS)
        configs = np.stack([theta * every, start[0] - (c * x - d * y), start[1] - (d * x + c * y), s * every], axis=1)
        return [Way(configs, contacts, False, None)]

    def turning(
        self,
        row: Array,
        center: tuple[float, float],
        s: float,
        contacts: list[Contact],
        across: tuple[float, float] | None,
    ) -> list[Way]:
        """The way of a part that turns about the centre of an arc, which stands at a place in the vise."""
        if not self.pattern.reaches(s, SAME):
            return []
        theta = np.arange(TURN_STEPS) * tau / TURN_STEPS
        c, d = np.cos(theta), np.sin(theta)
        x, y = center[0] - (c * row[X] - d * row[Y]), center[1] - (d * row[X] + c * row[Y])
        return [Way(np.stack([theta, x, y, np.full(TURN_STEPS, s)], axis=1), contacts, True, across)]

    def on_one_line(self) -> list[Way]:
        """Two pegs that press parallel faces, or arcs of one centre, along one line."""
        out = list[Way]()
        pegs, right = self.pattern.pegs, self.pattern.right
        for i, j in product(np.flatnonzero(right == 0).tolist(), np.flatnonzero(right == 1).tolist()):
            run, rise = pegs[j] - pegs[i]
            for a, b in self.opposed:
                one, two = self.rows[a], self.rows[b]
                ux, uy = -one[AXIS_Y], one[AXIS_X]
                d = (two[X] - one[X]) * ux + (two[Y] - one[Y]) * uy
                if abs(d) <= abs(rise) * (1.0 + 1e-12) or not self.touch([(i, a), (j, b)]):
                    continue
                omega = asin(rise / d)
                shift = (two[X] - one[X]) * one[AXIS_X] + (two[Y] - one[Y]) * one[AXIS_Y]
                low, high = (
                    max(-one[HALF_EXTENT], shift - two[HALF_EXTENT]),
                    min(one[HALF_EXTENT], shift + two[HALF_EXTENT]),
                )
                s, contacts = d * cos(omega) - run, [(i, a), (j, b)]
                out += self.sliding(omega - atan2(uy, ux), pegs[i], one, low, high, s, contacts)
            for group in self.locus.concentric:
                for a, b in product(group, repeat=2):
                    one, two = (float(self.rows[k, SIGN] * self.rows[k, RADIUS]) for k in (a, b))
                    d = one + two
                    if abs(d) <= max(abs(rise) * (1.0 + 1e-12), SHORTEST) or not self.touch([(i, a), (j, b)]):
                        continue
                    omega = asin(rise / d)
                    center = pegs[i, 0] + one * cos(omega), pegs[i, 1] + one * sin(omega)
                    # Square to the line the centre gives way where both arcs bend away.
                    falls = 2.0 / d < 1.0 / one + 1.0 / two - 1e-12
                    across = (-sin(omega), cos(omega)) if falls else None
                    out += self.turning(self.rows[a], center, d * cos(omega) - run, [(i, a), (j, b)], across)
        return out

    def on_parallel_lines(self, slides: Array, given: Given) -> list[Way]:
        """Two pegs of one jaw, on slides (S, 7), and one of the other on parallel faces, the middle one of the three against
        the outer two."""
        out = list[Way]()
        ends = self.pattern.stop, self.pattern.widest
        for row in filled(THREE_FACES, 64, on_three_faces, slides, given, *ends):
            slide = slides[int(row[OF_SLIDE])]
            first, a, s = int(slide[SLIDE_FIRST]), int(slide[SLIDE_ONE]), float(row[AT_SEPARATION])
            contacts = [
                (first, a),
                (int(slide[SLIDE_SECOND]), int(slide[SLIDE_TWO])),
                (int(row[THIRD]), int(row[ON_THIRD])),
            ]
            start = self.pattern.pegs[first] + [s * self.pattern.right[first], 0.0]
            out += self.sliding(row[AT_THETA], start, self.rows[a], row[AT_LOW], row[AT_HIGH], s, contacts)
        return out

    def on_one_center(self) -> list[Way]:
        """Two pegs of one jaw and one of the other on arcs of one centre."""
        out = list[Way]()
        pegs, right = self.pattern.pegs, self.pattern.right
        pairs = [(p, q) for p, q in combinations(range(len(right)), 2) if right[p] == right[q]]
        for group, (p, q) in product(self.locus.concentric, pairs):
            for a, b in product(group, repeat=2):
                if not self.touch([(p, a), (q, b)]):
                    continue
                for x, y in circles_meet(pegs[p], self.rows[a, RADIUS], pegs[q], self.rows[b, RADIUS]):
                    for c, k in product(group, np.flatnonzero(right != right[p]).tolist()):
                        if not self.touch([(k, c)]):
                            continue
                        square = self.rows[c, RADIUS] ** 2 - (y - pegs[k, 1]) ** 2
                        for side in (1.0, -1.0) if square >= 0.0 else ():
                            at = x + side * sqrt(square)
                            s = at - pegs[k, 0] if right[k] == 1 else pegs[k, 0] - at
                            center = (x + s * right[p], y)
                            if self.balances(s, center, [(p, a), (q, b), (k, c)]):
                                out += self.turning(self.rows[a], center, s, [(p, a), (q, b), (k, c)], None)
        return out

    def balances(self, s: float, center: tuple[float, float], contacts: list[Contact]) -> bool:
        """Whether three forces towards or from one centre can balance with the jaw's."""
        matrix = np.empty((3, 3))
        for at, (peg, piece) in enumerate(contacts):
            x, y = self.pattern.pegs[peg] + [s * self.pattern.right[peg], 0.0] - np.array(center)
            n = self.rows[piece, SIGN] * np.array([x, y]) / self.rows[piece, RADIUS]
            matrix[:, at] = *n, n[0] * self.pattern.right[peg]
        if abs(np.linalg.det(matrix)) < LEAST_SHARE:
            return False
        return bool((np.linalg.solve(matrix, [0.0, 0.0, 1.0]) > LEAST_SHARE).all())

    def families(self, found: Families) -> Families:
        """Those found, each once: the one with the most contacts of those that lie in each other."""
        if not len(found.rows):
            return found
        out = Families.room(len(found.rows), len(found.configs))
        return out.first(write_each_once(found, 1.0, SAME, out))


def circles_meet(one: Array, r1: float, two: Array, r2: float) -> list[tuple[float, float]]:
    """The points at given distances from two places."""
    d = hypot(*(two - one))
    along = (d * d + r1 * r1 - r2 * r2) / (2.0 * d)
    square = r1 * r1 - along * along
    if square < 0.0:
        return []
    ex, ey = (two - one) / d
    half = sqrt(square)
    return [(one[0] + along * ex - t * half * ey, one[1] + along * ey + t * half * ex) for t in (1.0, -1.0)]
