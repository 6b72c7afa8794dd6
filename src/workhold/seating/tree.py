"""The tree of joins: which seats come together at which pass, and from where a part gets out.

From a pass both ways down are followed to what they end in. While the jaws are opened, cages grow and join where the
lowest pass between them is reached: so passes are taken in the order of their separation.

Glossary
--------
place : what a way down ends in: a seat, a loose set, something not settled, the outside or the stop.
join : a pass, with the places that both of its ways down end in.
"""

from __future__ import annotations

from functools import cached_property
from math import pi, tau

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.kernels.seating.closing import AT_REST, AT_THE_STOP
from workhold.kernels.seating.columns import CONFIG, SEPARATION
from workhold.kernels.seating.freedom import nearest_of
from workhold.seating.descents import Closing
from workhold.seating.equilibria import Equilibria
from workhold.seating.families import Families, Family
from workhold.seating.ways_down import BESIDE, both_ways_down

__all__ = ["OUTSIDE", "STOP", "Join", "Tree"]

Array = NDArray[np.float64]
OUTSIDE, STOP, UNKNOWN = -1, -2, -3
# mm. How long the first steps of a way down off a loose set are.
FIRST_STEP = BESIDE / 2.0
# mm. A way down that ends this near to a seat, with a separation this near, ended in it.
AT_SEAT, SAME_LEVEL = 0.05, 1e-3
# mm. What ends lower than a loose set by this much fell off it.
FALLS = 1e-6


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
        loose = Families.of(found.loose)
        rested = first_of(loose.hold(found.seats[:, CONFIG], closing.size, FALLS))
        strict = rested < 0
        # A flat face may lead on from a curved seat: such a seat is a place of its own only where nothing leads on.
        builder = Builder(closing, found.seats, [], [], [row[CONFIG] for row in found.doubtful], strict)
        slack, rows = list[Family](), list[Array]()
        seats = np.ascontiguousarray(found.seats[strict][:, CONFIG])
        beyond = ends_of(loose, closing.size)
        ended, how_ended = closing.run(np.concatenate([np.zeros((0, 4)), *beyond]), FIRST_STEP, seats)
        at, starts, ends, how = 0, list[Array](), list[Array](), list[NDArray[np.int8]]()
        for family, begun in zip(found.loose, beyond, strict=True):
            end, way = ended[at : at + len(begun)], how_ended[at : at + len(begun)]
            at, falling = at + len(begun), end[:, 3] < family.separation - FALLS
            if not falling.any():
                builder.loose.append(family)
                continue
            # A part on two pegs that slides off is no rest at all; on three or more it lies there a while.
            if family.across is None and family.candidate[4] >= 3.0:
                slack.append(family)
            first = int(np.argmax(falling))
            builder.falling.append((family, begun[first], end[first], int(way[first])))
            if falling.sum() == 2:
                rows.append(family.candidate)
                starts.append(begun)
                ends.append(end)
                how.append(way)
        off, down, told = both_ways_down(found, closing, seats)
        rows += list(found.passes)
        places = builder.places(
            np.concatenate([*starts, off]), np.concatenate([*ends, down]), np.concatenate([*how, told])
        )
        made = [Join(float(row[SEPARATION]), row, (places[2 * k], places[2 * k + 1])) for k, row in enumerate(rows)]
        doubtful = np.array(builder.doubtful).reshape(-1, 4)
        beside_loose = first_of(builder.loose_sets.hold(found.seats[~strict][:, CONFIG], closing.size, FALLS))
        lying = np.flatnonzero(~strict)[beside_loose >= 0]
        shared = dict(zip(lying.tolist(), (len(found.seats) + beside_loose[beside_loose >= 0]).tolist(), strict=True))
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


def first_of(told: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Of each row (N, M) the number of the first that is true; -1 where none is."""
    if told.shape[1] == 0:
        return np.full(len(told), -1)
    return np.where(told.any(axis=1), told.argmax(axis=1), -1)


def ends_of(families: Families, size: float) -> list[Array]:
    """Configurations (2, 4) just beyond the ends of each loose set, or to both sides of its middle; none of a whole turn."""
    sets = families.sets
    out = [np.zeros((0, 4))] * len(sets)
    ended = [k for k, one in enumerate(sets) if one.across is None and not one.is_closed and len(one.configs) >= 3]
    if ended:
        # The end may be the same as the configuration before it, but not as the one before that.
        first, end = families.begins[ended], families.begins[1:][ended]
        rows = families.configs[np.stack([first, end - 1, first + 2, end - 3], axis=1)]
        steps = rows[:, :2] - rows[:, 2:]
        steps[:, :, 0] = (steps[:, :, 0] + pi) % tau - pi
        lengths = np.abs(steps[:, :, 0]) * size + np.hypot(steps[:, :, 1], steps[:, :, 2])
        leads_on, beyond = lengths > 0.0, rows[:, :2] + BESIDE * steps / np.maximum(lengths, 1e-300)[:, :, None]
        for k, there, good in zip(ended, beyond, leads_on, strict=True):
            out[k] = there if good.all() else there[good]
    for k, family in enumerate(sets):
        if family.across is not None:
            step = BESIDE * np.array([0.0, *family.across, 0.0])
            out[k] = family.middle + np.stack([step, -step])
    return out


@define(eq=False, slots=False)
class Builder:
    """What ways down have ended in so far.

    Parameters
    ----------
    closing : the jaws.
    seats, loose, doubtful : as of :class:`Tree`, the last as far as they are known.
    falling : loose sets off which a way leads down, with a configuration on it, what it ends in, and how.
    strict : (N,) which seats lie on no loose set.
    fallen : places of what ways off the falling sets end in, as far as they were asked for.
    """

    closing: Closing
    seats: Array
    loose: list[Family]
    falling: list[tuple[Family, Array, Array, int]]
    doubtful: list[Array]
    strict: NDArray[np.bool_]
    fallen: dict[int, int] = field(factory=dict)

    def places(self, starts: Array, configs: Array, how: NDArray[np.int8]) -> list[int]:
        """The places of the ends (N, 4) of ways down that began at some configurations (N, 4); those that are not known are
        added to what is not settled."""
        falls, places = self.seen(starts, configs, how)
        out: list[int] = places.tolist()
        for n in np.flatnonzero((falls >= 0) | (places == UNKNOWN)).tolist():
            out[n] = self.place_of(int(falls[n]), int(places[n]), configs[n])
        return out

    def seen(self, starts: Array, configs: Array, how: NDArray[np.int8]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Of each end of a way down, as of ``places``, the number of the loose set off which the way leads on, -1 where none
        does, and its place where it does not, ``UNKNOWN`` of what is not settled."""
        stopped, at_rest, size = how == AT_THE_STOP, how == AT_REST, self.closing.size
        places = np.where(self.leave(starts, configs, stopped), OUTSIDE, STOP)
        near, loose = self.near_seats(configs), first_of(self.loose_sets.hold(configs, size, SAME_LEVEL))
        resting = np.where(near >= 0, near, np.where(loose >= 0, len(self.seats) + loose, UNKNOWN))
        # On flat faces no step leads down; the way goes on, lower, where the part slides off them.
        falling = self.falling_sets
        on = falling.hold(configs, size, SAME_LEVEL) & (configs[:, 3:] >= falling.levels - FALLS)
        return np.where(at_rest, first_of(on), -1), np.where(stopped, places, np.where(at_rest, resting, UNKNOWN))

    def place_of(self, fall: int, place: int, config: Array) -> int:
        """The place of an end of which ``seen`` told the first two."""
        if fall >= 0:
            if fall not in self.fallen:
                # Lower than the set, and so never off it again.
                falls, places = self.below
                self.fallen[fall] = self.place_of(int(falls[fall]), int(places[fall]), self.falling[fall][2])
            return self.fallen[fall]
        return self.in_doubt(config) if place == UNKNOWN else place

    def in_doubt(self, config: Array) -> int:
        """The place of what is not settled."""
        before = len(self.seats) + len(self.loose)
        if self.doubtful:
            away = distances(np.array(self.doubtful), config, self.closing.size)
            nearest = int(np.argmin(away))
            if away[nearest] < 10.0 * AT_SEAT:
                return before + nearest
        self.doubtful.append(config)
        return before + len(self.doubtful) - 1

    def leave(self, starts: Array, configs: Array, stopped: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether a part can be taken away where ways ended that were stopped (N,), or where they began: what can be taken
        away at first can be, wherever closing the jaws leads."""
        away = np.zeros(len(stopped), np.bool_)
        away[stopped] = self.closing.escape(configs[stopped])
        left = stopped & ~away
        away[left] = self.closing.escape(starts[left])
        return away

    @cached_property
    def falling_sets(self) -> Families:
        """The falling sets."""
        return Families.of([family for family, *_ in self.falling])

    @cached_property
    def loose_sets(self) -> Families:
        """The loose sets."""
        return Families.of(self.loose)

    def near_seats(self, configs: Array) -> NDArray[np.int64]:
        """The number of the strict seat that each configuration (N, 4) is in, -1 where there is none."""
        numbers, seats = self.ordered
        out = np.empty(len(configs), np.int64)
        nearest_of(np.ascontiguousarray(configs), seats, self.closing.size, AT_SEAT, SAME_LEVEL, out)
        return numbers[out]

    @cached_property
    def ordered(self) -> tuple[NDArray[np.int64], Array]:
        """The numbers (N + 1,) of the strict seats by their separation, and -1, and their configurations (N, 4)."""
        numbers = np.flatnonzero(self.strict)
        numbers = numbers[np.argsort(self.seats[numbers, SEPARATION], kind="stable")]
        return np.append(numbers, -1), np.ascontiguousarray(self.seats[numbers][:, CONFIG])

    @cached_property
    def below(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """What ways off the falling sets end in, as of ``seen``."""
        starts, ends = (np.array([falling[k] for falling in self.falling]) for k in (1, 2))
        return self.seen(starts, ends, np.array([how for *_, how in self.falling], np.int8))


def distances(configs: Array, others: Array, size: float) -> Array:
    """How far in mm configurations (..., 4) are from others, turns counted by the size."""
    turn = np.abs((configs[..., 0] - others[..., 0] + pi) % tau - pi)
    return np.asarray(turn * size + np.hypot(configs[..., 1] - others[..., 1], configs[..., 2] - others[..., 2]))
