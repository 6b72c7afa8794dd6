"""The tree of joins: which seats come together at which pass, and from where a part gets out.

From a pass both ways down are followed to what they end in. While the jaws are opened, cages grow and join where the
lowest pass between them is reached: so passes are taken in the order of their separation.

Glossary
--------
place : what a way down ends in: a seat, a loose set, something not settled, the outside or the stop.
join : a pass, with the places that both of its ways down end in.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from math import pi, tau

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.kernels.seating.closing import AT_REST, AT_THE_STOP
from workhold.kernels.seating.columns import MOTION, PLACE_X, PLACE_Y, SECOND, SEPARATION, THETA
from workhold.seating.descents import Closing
from workhold.seating.equilibria import Equilibria
from workhold.seating.families import Family

__all__ = ["OUTSIDE", "STOP", "Join", "Tree"]

Array = NDArray[np.float64]
Seen = tuple[Array, int, bool, list[int], int, list[int]]
OUTSIDE, STOP = -1, -2
# mm. How far from a pass a way down begins, and how long its first steps are; how near it begins at least, and by which
# part of its way the motion may have bent there.
BESIDE, FIRST_STEP = 0.01, 0.005
SHORTEST, MOST_BEND = 1e-5, 0.1
# mm. A way down that ends this near to a seat, with a separation this near, ended in it.
AT_SEAT, SAME_LEVEL = 0.05, 1e-3
# mm. What ends lower than a loose set by this much fell off it.
FALLS = 1e-6
CONFIG = [THETA, PLACE_X, PLACE_Y, SEPARATION]


@frozen
class Join:
    """A pass.

    Parameters
    ----------
    separation : there, in mm.
    candidate : (24,) row of the pass.
    places : what its two ways down end in.
    """

    separation: float
    candidate: Array = field(eq=False)
    places: tuple[int, int]


@define(frozen=True, eq=False)
class Tree:
    """What can be reached from where.

    Parameters
    ----------
    seats : (N, 24) rows of strict seats.
    loose : loose sets of which none leads down: their places follow those of the seats.
    slack : loose sets with three contacts or more from which ways lead down: nothing rests there for certain.
    doubtful : (M, 4) configurations of what is not settled, whose places follow.
    joins : in the order of their separations.
    shared : places of the loose sets that some seats lie on.
    """

    seats: Array
    loose: list[Family]
    slack: list[Family]
    doubtful: Array
    joins: tuple[Join, ...]
    shared: dict[int, int]

    @classmethod
    def of(cls, found: Equilibria, closing: Closing) -> Tree:
        """Follow the ways down of all passes and the ends of all loose sets."""
        rested = lying_on(found.loose, found.seats[:, CONFIG], closing.size)
        strict = np.array([number is None for number in rested], np.bool_)
        # A flat face may lead on from a curved seat: such a seat is a place of its own only where nothing leads on.
        builder = Builder(closing, found.seats, [], [], [row[CONFIG] for row in found.doubtful], strict)
        slack, joins = list[Family](), list[tuple[Array, Array]]()
        seats = np.ascontiguousarray(found.seats[strict][:, CONFIG])
        beyond = [ends_of(family, closing.size) for family in found.loose]
        ended = closing.run(np.concatenate([np.zeros((0, 4)), *beyond]), FIRST_STEP, seats)[0][:, 3]
        ended_of = np.split(ended, np.cumsum([len(starts) for starts in beyond]))
        for family, starts, ends in zip(found.loose, beyond, ended_of[:-1], strict=True):
            falling = ends < family.separation - FALLS
            if not falling.any():
                builder.loose.append(family)
                continue
            # A part on two pegs that slides off is no rest at all; on three or more it lies there a while.
            if family.across is None and family.candidate[4] >= 3.0:
                slack.append(family)
            builder.falling.append((family, starts[int(np.argmax(falling))]))
            if falling.sum() == 2:
                joins.append((family.candidate, starts))
        steps, lengths = steps_off(found.passes, closing.size)
        beside = np.concatenate([np.full(len(joins), BESIDE), lengths])
        configs = found.passes[:, CONFIG]
        joins += zip(found.passes, np.stack([configs + steps, configs - steps], axis=1), strict=True)
        starts = np.array([start for _, start in joins]).reshape(-1, 4)
        ends, how = np.zeros((2 * len(joins), 4)), np.zeros(2 * len(joins), np.int8)
        for length in set(beside.tolist()):
            chosen = np.repeat(beside == length, 2)
            ends[chosen], how[chosen] = closing.run(starts[chosen], length / 2.0, seats)
        places = builder.places(starts, ends, how)
        made = [
            Join(float(row[SEPARATION]), row, (places[2 * k], places[2 * k + 1])) for k, (row, _) in enumerate(joins)
        ]
        doubtful = np.array(builder.doubtful).reshape(-1, 4)
        beside_loose = lying_on(builder.loose, found.seats[~strict][:, CONFIG], closing.size)
        shared = {
            k: len(found.seats) + number
            for k, number in zip(np.flatnonzero(~strict).tolist(), beside_loose, strict=True)
            if number is not None
        }
        joins_made = tuple(sorted(made, key=lambda join: join.separation))
        return cls(found.seats, builder.loose, slack, doubtful, joins_made, shared)

    @cached_property
    def first_joins(self) -> dict[int, Join]:
        """Of each place the first pass at which its cage joins another."""
        out = dict[int, Join]()
        for join in self.joins:
            if len(set(join.places)) == 2:
                for place in join.places:
                    out.setdefault(place, join)
        return out

    def join_of(self, place: int) -> Join | None:
        """The first pass at which the cage of a place joins another; None where it never does."""
        return self.first_joins.get(self.shared.get(place, place))

    def way_out(self, place: int) -> float | None:
        """The separation from which on a part can get from a place to the outside; None where it never can."""
        place, group = self.shared.get(place, place), dict[int, int]()

        def root(k: int) -> int:
            while group.setdefault(k, k) != k:
                k = group[k]
            return k

        for join in self.joins:
            one, two = (root(k) for k in join.places)
            group[one] = two
            if root(place) == root(OUTSIDE):
                return join.separation
        return None


def lying_on(families: list[Family], configs: Array, size: float) -> list[int | None]:
    """Of each configuration (N, 4) the number of the first loose set that it lies on, with its separation; None of none."""
    near = numbers_of(np.abs(separations(families) - configs[:, 3:]) < FALLS)
    return [
        next((k for k in some if families[k].holds(config, size)), None)
        for config, some in zip(configs, near, strict=True)
    ]


def numbers_of(told: NDArray[np.bool_]) -> list[list[int]]:
    """Of each row (N, M) the numbers of those that are true."""
    out: list[list[int]] = [[] for _ in told]
    for n, k in np.argwhere(told).tolist():
        out[n].append(k)
    return out


def separations(families: Iterable[Family]) -> Array:
    """Those of loose sets, in mm."""
    return np.array([family.separation for family in families], dtype=np.float64)


def steps_off(rows: Array, size: float) -> tuple[Array, Array]:
    """Steps (N, 4) along the free motions of passes (N, 24) at which ways down begin, and their lengths (N,) in mm: shorter
    where the motion bends so much that they would lie elsewhere."""
    motions, seconds = rows[:, MOTION : MOTION + 3], np.abs(rows[:, SECOND])
    speeds = np.abs(motions[:, 0]) * size + np.hypot(motions[:, 1], motions[:, 2])
    bent = 2.0 * MOST_BEND * speeds * speeds
    lengths = np.where(
        seconds * BESIDE > bent, np.maximum(bent / np.maximum(seconds, 1e-300), SHORTEST), np.full(len(rows), BESIDE)
    )
    steps = np.zeros((len(rows), 4))
    steps[:, :3] = (lengths / speeds)[:, None] * motions
    return steps, lengths


def ends_of(family: Family, size: float) -> Array:
    """Configurations (2, 4) just beyond the ends of a loose set, or to both sides of its middle; none of a whole turn."""
    if family.across is not None:
        step = BESIDE * np.array([0.0, *family.across, 0.0])
        return family.middle + np.stack([step, -step])
    if family.is_closed or len(family.configs) < 3:
        return np.zeros((0, 4))
    out = []
    # The end may be the same as the configuration before it, but not as the one before that.
    for end, before in ((0, 2), (-1, -3)):
        step = family.configs[end] - family.configs[before]
        step[0] = (step[0] + pi) % tau - pi
        length = abs(step[0]) * size + np.hypot(*step[1:3])
        if length > 0.0:
            out.append(family.configs[end] + BESIDE * step / length)
    return np.array(out).reshape(-1, 4)


@define(eq=False, slots=False)
class Builder:
    """What ways down have ended in so far.

    Parameters
    ----------
    closing : the jaws.
    seats, loose, doubtful : as of :class:`Tree`, the last as far as they are known.
    falling : loose sets off which a way leads down, and a configuration on it.
    strict : (N,) which seats lie on no loose set.
    fallen : places of what ways off the falling sets end in, as far as they were asked for.
    """

    closing: Closing
    seats: Array
    loose: list[Family]
    falling: list[tuple[Family, Array]]
    doubtful: list[Array]
    strict: NDArray[np.bool_]
    fallen: dict[int, int] = field(factory=dict)

    def places(self, starts: Array, configs: Array, how: NDArray[np.int8]) -> list[int]:
        """The places of the ends (N, 4) of ways down that began at some configurations (N, 4)."""
        return [self.place(*one) for one in self.seen(starts, configs, how)]

    def seen(self, starts: Array, configs: Array, how: NDArray[np.int8]) -> list[Seen]:
        """What is asked of the ends of ways down, all at once; see ``place``."""
        stopped = how == AT_THE_STOP
        away = np.zeros(len(how), np.bool_)
        away[stopped] = self.closing.escape(configs[stopped])
        # What can be taken away at first can be, wherever closing the jaws leads.
        left = stopped & ~away
        away[left] = self.closing.escape(starts[left])
        falls, loose = (
            numbers_of(np.abs(levels - configs[:, 3:]) < SAME_LEVEL) for levels in (self.fall_levels, self.loose_levels)
        )
        near = self.near_seats(configs).tolist()
        return list(zip(configs, how.tolist(), away.tolist(), falls, near, loose, strict=True))

    @cached_property
    def fall_levels(self) -> Array:
        """The separations of the falling sets, in mm."""
        return separations(family for family, _ in self.falling)

    @cached_property
    def loose_levels(self) -> Array:
        """The separations of the loose sets, in mm."""
        return separations(self.loose)

    def near_seats(self, configs: Array) -> NDArray[np.int64]:
        """The number of the strict seat that each configuration (N, 4) is in, -1 where there is none."""
        if not self.strict.any():
            return np.full(len(configs), -1)
        strict = np.flatnonzero(self.strict)
        seats = self.seats[strict][:, CONFIG]
        away = distances(configs[:, None], seats, self.closing.size)
        nearest = np.argmin(away, axis=1)
        is_in = away[np.arange(len(configs)), nearest] < AT_SEAT
        is_in &= np.abs(seats[nearest, 3] - configs[:, 3]) < SAME_LEVEL
        return np.where(is_in, strict[nearest], -1)

    @cached_property
    def below(self) -> list[Seen]:
        """What ways off the falling sets end in."""
        starts = np.array([beyond for _, beyond in self.falling])
        return self.seen(starts, *self.closing.run(starts, FIRST_STEP))

    def place(self, config: Array, how: int, is_away: bool, falls: list[int], near: int, loose: list[int]) -> int:
        """The place of the end of a way down; one that is not known is added to what is not settled.

        Parameters
        ----------
        is_away : whether the part can be taken away there.
        falls, loose : numbers of loose sets with nearly its separation, off which a way leads, and that are rests.
        near : number of the seat that it is in, or -1.
        """
        if how == AT_THE_STOP:
            return OUTSIDE if is_away else STOP
        size = self.closing.size
        for k in falls:
            family, _ = self.falling[k]
            # On flat faces no step leads down; the way goes on, lower, where the part slides off them.
            if how == AT_REST and config[3] >= family.separation - FALLS and family.holds(config, size):
                end = self.below[k]
                if end[0][3] < family.separation - FALLS:
                    if k not in self.fallen:
                        self.fallen[k] = self.place(*end)
                    return self.fallen[k]
        if how == AT_REST and near >= 0:
            return near
        for k in loose:
            if how == AT_REST and self.loose[k].holds(config, size):
                return len(self.seats) + k
        before = len(self.seats) + len(self.loose)
        if self.doubtful:
            away = distances(np.array(self.doubtful), config, size)
            nearest = int(np.argmin(away))
            if away[nearest] < 10.0 * AT_SEAT:
                return before + nearest
        self.doubtful.append(config)
        return before + len(self.doubtful) - 1


def distances(configs: Array, others: Array, size: float) -> Array:
    """How far in mm configurations (..., 4) are from others, turns counted by the size."""
    turn = np.abs((configs[..., 0] - others[..., 0] + pi) % tau - pi)
    return np.asarray(turn * size + np.hypot(configs[..., 1] - others[..., 1], configs[..., 2] - others[..., 2]))
