"""The tree of joins: which seats come together at which pass, and from where a part gets out.

From a pass both ways down are followed to what they end in. While the jaws are opened, cages grow and join where the
lowest pass between them is reached: so passes are taken in the order of their separation.

Glossary
--------
place : what a way down ends in: a seat, a loose set, something not settled, the outside or the stop.
join : a pass, with the places that both of its ways down end in.
"""

from __future__ import annotations

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
        every = np.ones(len(found.seats), np.bool_)
        builder = Builder(closing, found.seats, [], [], [row[CONFIG] for row in found.doubtful], every)
        slack, joins = list[Family](), list[tuple[Array, Array]]()
        seats = np.ascontiguousarray(found.seats[:, CONFIG])
        # A flat face may lead on from a curved seat: such a seat is a place of its own only where nothing leads on.
        builder.strict = np.array([on_one_of(found.loose, seat, closing.size) is None for seat in seats], np.bool_)
        seats = seats[builder.strict]
        for family in found.loose:
            starts = ends_of(family, closing.size)
            low = family.middle[3] - FALLS
            falling = closing.run(starts, FIRST_STEP, seats)[0][:, 3] < low
            if not falling.any():
                builder.loose.append(family)
                continue
            # A part on two pegs that slides off is no rest at all; on three or more it lies there a while.
            if family.across is None and family.candidate[4] >= 3.0:
                slack.append(family)
            if falling.any():
                builder.falling.append((family, starts[int(np.argmax(falling))]))
            if falling.sum() == 2:
                joins.append((family.candidate, starts))
        beside = [BESIDE] * len(joins)
        for row in found.passes:
            step, length = step_off(row, closing.size)
            joins.append((row, row[CONFIG] + np.stack([step, -step])))
            beside.append(length)
        configs, how = np.zeros((2 * len(joins), 4)), np.zeros(2 * len(joins), np.int8)
        starts = np.array([start for _, start in joins]).reshape(-1, 4)
        for length in set(beside):
            chosen = np.repeat(np.array(beside) == length, 2)
            configs[chosen], how[chosen] = closing.run(starts[chosen], length / 2.0, seats)
        places = [builder.place(config, end) for config, end in zip(configs, how.tolist(), strict=True)]
        made = [
            Join(float(row[SEPARATION]), row, (places[2 * k], places[2 * k + 1])) for k, (row, _) in enumerate(joins)
        ]
        doubtful = np.array(builder.doubtful).reshape(-1, 4)
        shared = {}
        for k in np.flatnonzero(~builder.strict).tolist():
            number = on_one_of(builder.loose, found.seats[k, CONFIG], closing.size)
            if number is not None:
                shared[k] = len(found.seats) + number
        joins_made = tuple(sorted(made, key=lambda join: join.separation))
        return cls(found.seats, builder.loose, slack, doubtful, joins_made, shared)

    def join_of(self, place: int) -> Join | None:
        """The first pass at which the cage of a place joins another; None where it never does."""
        place = self.shared.get(place, place)
        return next((join for join in self.joins if place in join.places and len(set(join.places)) == 2), None)

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


def on_one_of(families: list[Family], config: Array, size: float) -> int | None:
    """Number of the first loose set that a configuration lies on, with its separation; None of none."""
    for k, family in enumerate(families):
        if abs(family.middle[3] - config[3]) < FALLS and family.holds(config, size):
            return k
    return None


def step_off(row: Array, size: float) -> tuple[Array, float]:
    """The step (4,) along a pass's free motion at which a way down begins, and its length in mm: shorter where the motion
    bends so much that it would lie elsewhere."""
    motion, second = row[MOTION : MOTION + 3], abs(float(row[SECOND]))
    speed = float(abs(motion[0]) * size + np.hypot(*motion[1:]))
    length = BESIDE
    if second * BESIDE > 2.0 * MOST_BEND * speed * speed:
        length = max(2.0 * MOST_BEND * speed * speed / second, SHORTEST)
    return np.append(length / speed * motion, 0.0), length


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


@define(eq=False)
class Builder:
    """What ways down have ended in so far.

    Parameters
    ----------
    closing : the jaws.
    seats, loose, doubtful : as of :class:`Tree`, the last as far as they are known.
    falling : loose sets off which a way leads down, and a configuration on it.
    strict : (N,) which seats lie on no loose set.
    below : what ways off the falling sets end in, as far as it was asked for.
    """

    closing: Closing
    seats: Array
    loose: list[Family]
    falling: list[tuple[Family, Array]]
    doubtful: list[Array]
    strict: NDArray[np.bool_]
    below: dict[int, tuple[Array, int]] = field(factory=dict)

    def place(self, config: Array, how: int) -> int:
        """The place of the end of a way down; one that is not known is added to what is not settled."""
        if how == AT_THE_STOP:
            return OUTSIDE if self.closing.escapes(config) else STOP
        size = self.closing.size
        for k, (family, beyond) in enumerate(self.falling):
            # On flat faces no step leads down; the way goes on, lower, where the part slides off them.
            if how == AT_REST and config[3] >= family.middle[3] - FALLS and family.holds(config, size):
                if k not in self.below:
                    configs, ends = self.closing.run(beyond[None], FIRST_STEP)
                    self.below[k] = configs[0], int(ends[0])
                if self.below[k][0][3] < family.middle[3] - FALLS:
                    return self.place(*self.below[k])
        if how == AT_REST and self.strict.any():
            away = distances(self.seats[:, CONFIG], config, size)
            near = int(np.argmin(np.where(self.strict, away, np.inf)))
            if away[near] < AT_SEAT and abs(self.seats[near, SEPARATION] - config[3]) < SAME_LEVEL:
                return near
        for k, family in enumerate(self.loose):
            if how == AT_REST and family.holds(config, size):
                return len(self.seats) + k
        before = len(self.seats) + len(self.loose)
        if self.doubtful:
            away = distances(np.array(self.doubtful), config, size)
            near = int(np.argmin(away))
            if away[near] < 10.0 * AT_SEAT:
                return before + near
        self.doubtful.append(config)
        return before + len(self.doubtful) - 1


def distances(configs: Array, config: Array, size: float) -> Array:
    """How far in mm configurations (N, 4) are from one, turns counted by the size."""
    turn = np.abs((configs[:, 0] - config[0] + pi) % tau - pi)
    return np.asarray(turn * size + np.hypot(configs[:, 1] - config[1], configs[:, 2] - config[2]))
