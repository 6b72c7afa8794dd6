"""Loose equilibria: sets of configurations with one S along which the part slides on flat faces, or turns on concentric
arcs."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import combinations, product
from math import asin, atan2, cos, hypot, pi, sin, sqrt, tau

import numpy as np
from attrs import define, evolve, frozen
from numpy.typing import NDArray

from workhold.conventions import END_SLACK, PARALLEL
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CONFIG,
    CONTACTS,
    PEG,
    PIECE,
    SEPARATION,
    Given,
    Obstacles,
)
from workhold.kernels.seating.freedom import (
    RUN_COUNT,
    RUN_END,
    RUN_FIRST,
    RUN_LENGTH,
    RUN_MIDDLE,
    RUN_START,
    RUN_TOUCHES,
    RUN_WAY,
    free_ones,
    free_runs,
    lie_along,
)
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

__all__ = ["Families", "Family", "Finder", "Way"]

Array = NDArray[np.float64]
# Configurations by which a slide is told, and a turn.
SLIDE_STEPS, TURN_STEPS = 144, 384
# mm. Shorter slides are none; separations this near are one.
SHORTEST, SAME = 1e-6, 1e-6
# A force's share below this is none.
LEAST_SHARE = 1e-9
Contact = tuple[int, int]


@define(frozen=True, eq=False, slots=False)
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

    @cached_property
    def middle(self) -> Array:
        """The configuration (4,) of the candidate."""
        return self.candidate[CONFIG]

    @property
    def separation(self) -> float:
        """S in mm."""
        return float(self.candidate[SEPARATION])


@frozen(eq=False)
class Families:
    """Some loose sets, to ask of all at once what lies in which.

    Parameters
    ----------
    sets : each by itself.
    levels : (F,) their separations in mm.
    configs, begins : (M, 4) along all, and where those of each begin, as of ``one_after_other``.
    """

    sets: Sequence[Family]
    levels: Array
    configs: Array
    begins: NDArray[np.int64]

    @classmethod
    def of(cls, families: Sequence[Family]) -> Families:
        """Those of a list."""
        levels = np.array([one.separation for one in families], dtype=np.float64)
        return cls(families, levels, *one_after_other([one.configs for one in families]))

    def hold(self, configs: Array, arm: float, most: float) -> NDArray[np.bool_]:
        """Which sets each configuration (N, 4) lies in, as far as their steps tell: (N, F).

        Parameters
        ----------
        arm : in mm, by which turns are counted.
        most : by how much in mm the separation may differ.
        """
        out = np.empty((len(configs), len(self.levels)), np.int8)
        lie_along(np.ascontiguousarray(configs), self.configs, self.begins, self.levels, arm, most, out)
        return out.astype(np.bool_)


def one_after_other(parts: Sequence[Array]) -> tuple[Array, NDArray[np.int64]]:
    """Configurations (N, 4) in one array, and where those of each part begin and, last, end."""
    return np.concatenate([np.zeros((0, 4)), *parts]), np.cumsum([0, *(len(part) for part in parts)])


@frozen(eq=False)
class Way:
    """Configurations with one separation between which the part can go while some contacts stay.

    Parameters
    ----------
    configs : (N, 4) along it.
    contacts : pegs and the pieces that they touch all along.
    is_closed : whether the last one is beside the first.
    across : see ``Family``.
    known, clear : pegs whose clearances are known, and these (N, 4) in mm, -inf first where one of them hinders.
    """

    configs: Array
    contacts: list[Contact]
    is_closed: bool
    across: tuple[float, float] | None
    known: tuple[int, ...] = ()
    clear: Array | None = None

    def moved(self, group: Group) -> Way:
        """The way of a group of pegs as one of its pattern."""
        contacts = [(group.numbers[peg], piece) for peg, piece in self.contacts]
        configs = self.configs + group.shift
        return Way(
            configs, contacts, self.is_closed, self.across, tuple(group.numbers[k] for k in self.known), self.clear
        )


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

    def touched(self, way: Way) -> NDArray[np.int64]:
        """The piece (K,) that each peg has to touch, -1 where none."""
        out = np.full(len(self.pattern.pegs), -1)
        for peg, piece in way.contacts:
            if peg < len(out):
                out[peg] = piece
        return out

    def freedom(self, way: Way) -> tuple[Array, NDArray[np.bool_]]:
        """Clearances (N, 4) in mm of pegs along a way, told where the part is free and touches what it has to, and where it
        does."""
        clear, good = np.empty((len(way.configs), 4)), np.empty(len(way.configs), np.int8)
        seen = np.empty((len(self.pattern.pegs), 3))
        free_ones(way.configs, self.touched(way), self.around, seen, clear, good)
        return clear, good != 0

    def free(self, ways: list[Way]) -> tuple[Way, ...]:
        """The ways along which the part is free somewhere, with what is known of it."""
        out = []
        for way in ways:
            clear, good = self.freedom(way)
            if good.any():
                clear[~good] = -np.inf
                out.append(evolve(way, known=tuple(range(self.obstacles)), clear=clear))
        return tuple(out)

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

    def cut_all(self, ways: Sequence[Way]) -> list[Family]:
        """The free runs of ways at separations that are reached."""
        return self.cut([way for way in ways if self.pattern.reaches(way.configs[0, 3], SAME)])

    def cut(self, ways: Sequence[Way]) -> list[Family]:
        """The free runs of ways."""
        if not ways:
            return []
        configs, begins = one_after_other([way.configs for way in ways])
        names, touched = np.full((len(ways), 4), -1), np.array([self.touched(way) for way in ways])
        for name, way in zip(names, ways, strict=True):
            name[: len(way.known)] = way.known
        known = np.concatenate([np.zeros((len(way.configs), 4)) if way.clear is None else way.clear for way in ways])
        closed, clear = np.array([way.is_closed for way in ways], np.int8), np.empty((len(configs), self.obstacles))
        work = clear, np.empty((len(self.pattern.pegs), 3)), np.empty((4, max(4, self.obstacles)))
        given = configs, begins, closed, touched, names, known, self.around
        runs = filled(RUN_LENGTH, 2 * len(ways) + 64, free_runs, *given, *work)
        return [self.family(ways[int(run[RUN_WAY])], run, configs, begins) for run in runs]

    def family(self, way: Way, run: Array, configs: Array, begins: NDArray[np.int64]) -> Family:
        """A free run of a way."""
        begin, count = int(begins[int(run[RUN_WAY])]), int(run[RUN_COUNT])
        first, middle, bits = (int(run[k]) for k in (RUN_FIRST, RUN_MIDDLE, RUN_TOUCHES))
        known = dict(way.contacts)
        told = [
            (peg, known[peg] if peg in known else self.nearest(peg, configs[middle]))
            for peg in range(self.obstacles)
            if bits >> peg & 1
        ]
        row = np.zeros(CANDIDATE_LENGTH)
        row[CONFIG] = configs[middle]
        row[CONTACTS], row[PEG : PEG + 4], row[PIECE : PIECE + 4] = len(told), -1.0, -1.0
        for at, (peg, piece) in enumerate(told):
            row[PEG + at], row[PIECE + at] = peg, piece
        if way.is_closed:
            along = way.configs[(first - begin + np.arange(count)) % len(way.configs)]
            return Family(row, along, count == len(way.configs), way.across)
        ends = run[RUN_START:RUN_END], run[RUN_END:RUN_LENGTH]
        return Family(row, np.concatenate([ends[:1], configs[first : first + count], ends[1:]]), False, way.across)

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

    def families(self, found: list[Family]) -> list[Family]:
        """Those found, each once: the one with the most contacts of those that lie in each other."""
        every = sorted(found, key=lambda family: -family.candidate[CONTACTS])
        middles = np.array([one.middle for one in every]).reshape(-1, 4)
        inside, kept = Families.of(every).hold(middles, 1.0, SAME), list[int]()
        for number, holding in enumerate(inside):
            if not holding[kept].any():
                kept.append(number)
        return [every[number] for number in kept]


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
    is_arc, dx, dy = rows[:, IS_ARC] != 0.0, x - rows[:, X], y - rows[:, Y]
    forth, beside = dx * rows[:, AXIS_X] + dy * rows[:, AXIS_Y], dx * rows[:, AXIS_Y] - dy * rows[:, AXIS_X]
    away = np.abs(np.where(is_arc, np.hypot(dx, dy) - rows[:, RADIUS], beside))
    # As of ``contains``, of all at once.
    along = np.abs(np.where(is_arc, np.arctan2(-beside, forth), forth))
    on = along <= rows[:, HALF_EXTENT] + END_SLACK / np.where(is_arc, rows[:, RADIUS], 1.0)
    on |= is_arc & (rows[:, HALF_EXTENT] >= pi)
    return int(first + np.argmin(np.where(on, away, np.inf)))
