"""Loose equilibria: sets of configurations with one S along which the part slides on flat faces, or turns on concentric
arcs."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import combinations, product
from math import asin, atan2, cos, hypot, pi, sin, sqrt, tau

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.conventions import PARALLEL, SAME_CENTER
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CONTACTS,
    PEG,
    PIECE,
    PLACE_X,
    PLACE_Y,
    SEPARATION,
    THETA,
)
from workhold.kernels.seating.pieces import clearances
from workhold.seating.holdings import Slide
from workhold.seating.locus import Locus, all_contained, contains
from workhold.seating.pattern import Pattern

__all__ = ["Family", "Finder", "families"]

Array = NDArray[np.float64]
# Configurations by which a slide is told, and a turn.
SLIDE_STEPS, TURN_STEPS = 144, 384
# How often, and into how many parts, the step in which a slide ends is cut to find where.
EDGE_ROUNDS, EDGE_PARTS = 5, 32
# mm. Pegs this near touch all along; shorter slides are none; separations this near are one, or one where ways end.
TOUCHES, SHORTEST, SAME, SAME_LEVEL = 1e-7, 1e-6, 1e-6, 1e-3
# A force's share below this is none.
LEAST_SHARE = 1e-9
Contact = tuple[int, int]


@define(frozen=True, eq=False)
class Family:
    """A connected set of equilibria with one separation.

    Parameters
    ----------
    candidate : the middle of where the most pegs touch, and what they touch.
    configs : (N, 4) along it.
    is_closed : whether it is a whole turn, which has no ends.
    across : (2,) direction in which the part gives way to both sides, or None where it does not.
    """

    candidate: Array
    configs: Array
    is_closed: bool
    across: tuple[float, float] | None

    @property
    def middle(self) -> Array:
        """The configuration (4,) of the candidate."""
        return self.candidate[[THETA, PLACE_X, PLACE_Y, SEPARATION]]

    def holds(self, config: Array, arm: float) -> bool:
        """Whether a configuration lies in the set, as far as its steps tell."""
        if abs(config[3] - self.candidate[SEPARATION]) >= SAME_LEVEL:
            return False
        turn = (self.configs[:, 0] - config[0] + pi) % tau - pi
        away = np.abs(turn) * arm + np.hypot(*(self.configs[:, 1:3] - config[1:3]).T)
        steps = np.abs(np.diff(self.configs, axis=0)) @ np.array([arm, 1.0, 1.0, 0.0])
        return bool(away.min() <= steps.max(initial=0.0) + 0.02)


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

    def clearances(self, configs: Array) -> Array:
        """Distances (N, K) in mm of pegs from the boundary in configurations (N, 4), the last one of a wall."""
        points = self.pattern.at(configs)
        out = np.empty((points.shape[1] + (self.pattern.wall is not None), len(points)))
        if self.pattern.wall is not None:
            out[-1] = self.locus.hull.clearance(configs, self.pattern.wall)
        for k, side in enumerate(self.pattern.right.tolist()):
            first, end = self.locus.parts[side].tolist()
            clearances(np.ascontiguousarray(points[:, k]), self.rows, first, end, out[k])
        return out.T

    def of_pegs(self, contacts: list[Contact]) -> list[Contact]:
        """The contacts that are not a wall's."""
        return [(peg, piece) for peg, piece in contacts if peg < len(self.pattern.pegs)]

    def nearest(self, peg: int, config: Array) -> int:
        """Number of the piece that a peg, or a wall, touches in a configuration."""
        if peg < len(self.pattern.pegs):
            return nearest(self.locus, int(self.pattern.right[peg]), *self.pattern.at(config[None])[0, peg])
        assert self.pattern.wall is not None
        angle = atan2(-self.pattern.wall[1], -self.pattern.wall[0]) - config[0]
        return len(self.rows) + int(self.locus.hull.reach(np.array([angle]))[0].argmax())

    def touch(self, contacts: list[Contact]) -> bool:
        """Whether pegs can touch the pieces that they are said to touch."""
        return all(self.locus.fits(self.pattern.right[peg], piece) for peg, piece in contacts)

    def cut(
        self, configs: Array, contacts: list[Contact], closed: bool, across: tuple[float, float] | None
    ) -> list[Family]:
        """The free runs of a set of configurations in which some contacts stay."""
        points = self.pattern.at(configs)
        clear = self.clearances(configs)
        good = np.asarray((clear > -TOUCHES).all(axis=1), np.bool_)
        for peg, piece in self.of_pegs(contacts):
            good &= all_contained(self.rows[piece], points[:, peg])
        out = []
        for numbers in runs(good, closed):
            # The middle of where the most pegs touch.
            touches = np.abs(clear[numbers]) < TOUCHES
            most = np.flatnonzero(touches.sum(axis=1) == touches.sum(axis=1).max())
            middle = numbers[most[len(most) // 2]]
            touching = np.flatnonzero(np.abs(clear[middle]) < TOUCHES).tolist()
            known = dict(contacts)
            told = [(peg, known[peg] if peg in known else self.nearest(peg, configs[middle])) for peg in touching]
            row = np.zeros(CANDIDATE_LENGTH)
            row[[THETA, PLACE_X, PLACE_Y, SEPARATION]] = configs[middle]
            row[CONTACTS], row[PEG : PEG + 4], row[PIECE : PIECE + 4] = len(told), -1.0, -1.0
            for at, (peg, piece) in enumerate(told):
                row[PEG + at], row[PIECE + at] = peg, piece
            along = configs[numbers]
            if not closed:
                ends = [(numbers[0], numbers[0] - 1), (numbers[-1], numbers[-1] + 1)]
                first, last = (
                    self.edge(configs[inner], configs[outer], contacts) if 0 <= outer < len(configs) else configs[inner]
                    for inner, outer in ends
                )
                along = np.concatenate([[first], along, [last]])
            out.append(Family(row, along, closed and len(numbers) == len(configs), across))
        return out

    def edge(self, inner: Array, outer: Array, contacts: list[Contact]) -> Array:
        """The last free configuration on the straight way from one that is free to one that is not."""
        for _ in range(EDGE_ROUNDS):
            between = inner + np.linspace(0.0, 1.0, EDGE_PARTS + 1)[:, None] * (outer - inner)
            points = self.pattern.at(between)
            good = np.asarray((self.clearances(between) > -TOUCHES).all(axis=1), np.bool_)
            for peg, piece in self.of_pegs(contacts):
                good &= all_contained(self.rows[piece], points[:, peg])
            good[0], good[-1] = True, False
            last = int(np.argmin(good)) - 1
            inner, outer = between[last], between[last + 1]
        return inner

    def sliding(
        self, theta: float, start: Array, line: Array, low: float, high: float, s: float, contacts: list[Contact]
    ) -> list[Family]:
        """The families of a part that slides with one peg, which stands at ``start``, on a line from a parameter to
        another."""
        if high - low < SHORTEST or not self.pattern.reaches(s, SAME):
            return []
        t = np.linspace(low, high, SLIDE_STEPS)
        x, y = line[X] + t * line[AXIS_X], line[Y] + t * line[AXIS_Y]
        c, d = cos(theta), sin(theta)
        every = np.ones(SLIDE_STEPS)
        configs = np.stack([theta * every, start[0] - (c * x - d * y), start[1] - (d * x + c * y), s * every], axis=1)
        return self.cut(configs, contacts, False, None)

    def turning(
        self,
        row: Array,
        center: tuple[float, float],
        s: float,
        contacts: list[Contact],
        across: tuple[float, float] | None,
    ) -> list[Family]:
        """The families of a part that turns about the centre of an arc, which stands at a place in the vise."""
        if not self.pattern.reaches(s, SAME):
            return []
        theta = np.arange(TURN_STEPS) * tau / TURN_STEPS
        c, d = np.cos(theta), np.sin(theta)
        x, y = center[0] - (c * row[X] - d * row[Y]), center[1] - (d * row[X] + c * row[Y])
        return self.cut(np.stack([theta, x, y, np.full(TURN_STEPS, s)], axis=1), contacts, True, across)

    def on_one_line(self) -> list[Family]:
        """Two pegs that press parallel faces, or arcs of one centre, along one line."""
        out = []
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
            for group in self.concentric:
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

    def on_parallel_lines(self, slides: tuple[Slide, ...]) -> list[Family]:
        """Two pegs of one jaw and one of the other on parallel faces, the middle one of the three against the outer two."""
        out = []
        pegs, right = self.pattern.pegs, self.pattern.right
        for slide in slides:
            a, b = slide.pieces
            one = self.rows[a]
            theta = -slide.psi
            c, d = cos(theta), sin(theta)
            # The face's direction and its outward normal in the vise frame.
            tx, ty = c * one[AXIS_X] - d * one[AXIS_Y], d * one[AXIS_X] + c * one[AXIS_Y]
            nx, ny = ty, -tx
            if one[IS_ARC] != 0.0 or abs(nx) < 1e-9:
                continue
            for k, other in product(np.flatnonzero(right != right[slide.first]).tolist(), self.parallel_to[a]):
                two = self.rows[other]
                thick = (one[X] - two[X]) * one[AXIS_Y] - (one[Y] - two[Y]) * one[AXIS_X]
                run, rise = pegs[k] - pegs[slide.first]
                moving = 1.0 if right[k] == 1 else -1.0
                s = -(thick + run * nx + rise * ny) / (moving * nx)
                places = pegs[:, 0] * tx + pegs[:, 1] * ty + s * right * tx
                contacts = [(slide.first, a), (slide.second, b), (k, other)]
                if not (self.touch(contacts) and self.opposes(contacts, places, moving * nx)):
                    continue
                shift = (two[X] - one[X]) * one[AXIS_X] + (two[Y] - one[Y]) * one[AXIS_Y]
                shift -= places[k] - places[slide.first]
                low, high = max(slide.low, shift - two[HALF_EXTENT]), min(slide.high, shift + two[HALF_EXTENT])
                start = pegs[slide.first] + [s * right[slide.first], 0.0]
                out += self.sliding(theta, start, one, low, high, s, contacts)
        return out

    @cached_property
    def parallel_to(self) -> dict[int, list[int]]:
        """Numbers of the straight pieces parallel to each of them."""
        along = self.rows[:, [AXIS_X, AXIS_Y]]
        cross = np.abs(np.outer(along[:, 0], along[:, 1]) - np.outer(along[:, 1], along[:, 0]))
        return {a: [k for k in self.lines if cross[a, k] <= PARALLEL] for a in self.lines}

    def opposes(self, contacts: list[Contact], places: Array, push: float) -> bool:
        """Whether of three parallel forces the middle one is against the outer two, and the last presses its jaw outward.

        Parameters
        ----------
        places : (4,) of the pegs along the faces, in mm.
        push : of a normal like the first contact's, how much it presses the jaw of the last peg outward.
        """
        first = self.rows[contacts[0][1]]
        sides = [float(np.sign(self.rows[k, [AXIS_X, AXIS_Y]] @ first[[AXIS_X, AXIS_Y]])) for _, k in contacts]
        (p, one), (q, middle), (r, other) = sorted(zip((places[peg] for peg, _ in contacts), sides, strict=True))
        return q - p > SHORTEST and r - q > SHORTEST and one == other == -middle and sides[2] * push > 0.0

    @cached_property
    def concentric(self) -> list[list[int]]:
        """Arcs by their centres."""
        groups: list[list[int]] = []
        for k in np.flatnonzero(self.rows[:, IS_ARC] != 0.0).tolist():
            center = self.rows[k, [X, Y]]
            group = next((g for g in groups if np.hypot(*(self.rows[g[0], [X, Y]] - center)) <= SAME_CENTER), None)
            groups.append([k]) if group is None else group.append(k)
        return groups

    def on_one_center(self) -> list[Family]:
        """Two pegs of one jaw and one of the other on arcs of one centre."""
        out = []
        pegs, right = self.pattern.pegs, self.pattern.right
        pairs = [(p, q) for p, q in combinations(range(len(right)), 2) if right[p] == right[q]]
        for group, (p, q) in product(self.concentric, pairs):
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


def families(locus: Locus, pattern: Pattern, slides: tuple[Slide, ...], on_wall: Sequence[Family] = ()) -> list[Family]:
    """All loose equilibria of a pattern, each once: the one with the most contacts of those that lie in each other."""
    finder = Finder(locus, pattern)
    kept: list[Family] = []
    found = finder.on_one_line() + finder.on_parallel_lines(slides) + finder.on_one_center() + list(on_wall)
    for one in sorted(found, key=lambda family: -family.candidate[CONTACTS]):
        if not any(abs(one.middle[3] - other.middle[3]) < SAME and other.holds(one.middle, 1.0) for other in kept):
            kept.append(one)
    return kept


def runs(good: NDArray[np.bool_], closed: bool) -> list[NDArray[np.int64]]:
    """Numbers of neighbours that are all good, run by run; of what is closed the last and the first are neighbours."""
    count = len(good)
    if good.all():
        return [np.arange(count)]
    shift = int(np.argmin(good)) if closed else 0
    order = (np.arange(count) + shift) % count
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good[order], [False]]).astype(np.int8)))
    return [order[first:end] for first, end in edges.reshape(-1, 2)]


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


def nearest(locus: Locus, side: int, x: float, y: float) -> int:
    """Number of the piece that a peg that stands still (0), or moves (1), touches at a point of its boundary."""
    first, end = locus.parts[side].tolist()
    rows = locus.rows[first:end]
    away = np.where(
        rows[:, IS_ARC] == 0.0,
        np.abs((x - rows[:, X]) * rows[:, AXIS_Y] - (y - rows[:, Y]) * rows[:, AXIS_X]),
        np.abs(np.hypot(x - rows[:, X], y - rows[:, Y]) - rows[:, RADIUS]),
    )
    on = np.array([contains(row, x, y) for row in rows])
    return int(first + np.argmin(np.where(on, away, np.inf)))
