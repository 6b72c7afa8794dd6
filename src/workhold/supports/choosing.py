"""The best few triples of supports, or all of them in order, looked at in blocks that need little memory.

Sum max(r_j, 0) bounds the clamp force that a triple needs from below, wherever the clamp stands. The force on
a support is at least what loads alone press on it, and at least a third of what all three carry. The tipping
arm is at most the radius of the incircle. So a triple whose bounds come after the last of the best so far is
left out, and the clamp's best point is sought for the others only. Where the point is given all is known.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import lru_cache
from itertools import combinations
from math import floor, log10
from threading import Event
from typing import TypeAlias

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.conventions import FIGURE_DECIMALS, GAP_SLACK
from workhold.errors import InputError
from workhold.supports.clamp_point import RankedPlaces
from workhold.supports.forces import Corners, Sides, Triangles
from workhold.supports.holes import CarrierRoom

__all__ = ["MOST_LISTED", "BoundFigures", "Chosen", "Stop", "TripleChoice", "WorkLimit", "coarse"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Flags = NDArray[np.bool_]
Key = tuple[float, ...]
Ranked = tuple[Key, tuple[int, ...]]
# Triples of so many holes are looked at in one block; of more, those of one hole after the other, so
# many at a time.
FEW_HOLES, AT_ONCE = 48, 1 << 16
# Triples for which the clamp's best point is sought at a time, first and later.
FIRST, LATER = 12, 256
# A list of more is of no use to anybody, and would not fit the memory.
MOST_LISTED = 150_000
COARSE = 2
# Bounds and figures agree to this share.
ROUNDING = 1e-9


def coarse(value: float) -> float:
    """A figure to two significant digits, as the ranking counts it; a force below 1e-9 is none."""
    return float(f"{value:.{COARSE - 1}e}") if abs(value) > 10.0**-FIGURE_DECIMALS else 0.0


def bound_coarse_figure(value: float) -> tuple[float, float]:
    """Between which figures all that count as a coarse one lie: all below the first count as less."""
    if value <= 0.0:
        return 0.0, 10.0**-FIGURE_DECIMALS
    half = 0.5 * 10.0 ** (floor(log10(value * (1 + ROUNDING))) - COARSE + 1)
    # Below a power of ten figures are ten times as fine.
    below = half * 0.1 if coarse(value - half * 0.2) != coarse(value) else half
    return value - min(half, below) * (1 - ROUNDING), value + half * (1 + ROUNDING)


@define(eq=False)
class WorkLimit:
    """Stops the search of the sets under several fixtures once so many places of the clamp were looked at.

    It counts, and looks at no clock: the same is found every time.

    Parameters
    ----------
    most : places, of all triples together.
    done : those that were looked at.
    """

    most: int
    done: int = 0

    def is_set(self) -> bool:
        return self.done >= self.most


# What may stop a search: an event, or a count.
Stop: TypeAlias = Event | WorkLimit


@lru_cache(maxsize=4)
def list_triples(count: int) -> IntArray:
    """All three numbers (N, 3) below a count, in order."""
    out = np.array(list(combinations(range(count), 3)), np.int64).reshape(-1, 3)
    out.setflags(write=False)
    return out


@define(frozen=True, eq=False)
class Chosen:
    """Triples in order of their rank.

    Parameters
    ----------
    corners : the triples.
    count : how many are valid; None where not all were looked at.
    stopped : whether it was stopped before the end.
    """

    corners: Corners
    count: int | None
    stopped: bool


@define(frozen=True, eq=False)
class BoundFigures:
    """Figures of N triples that decide their order; forces are 0 without loads.

    Parameters
    ----------
    falls : 1.0 for those from which the part falls over before it is clamped.
    late : 1.0 for those over which the clamp may not stand at the point asked for.
    hang : class of the clamp's place, see :class:`RankedPlaces`.
    need, force : clamp force needed, and the largest force on a support.
    arm, standing : tipping arm, and how far the centre of area is inside.
    """

    falls: Array
    late: Array
    hang: Array
    need: Array
    force: Array
    arm: Array
    standing: Array

    @property
    def classes(self) -> tuple[Array, Array, Array]:
        """What decides before all figures, first to last."""
        return self.falls, self.late, self.hang

    def take(self, rows: NDArray[np.intp] | Flags) -> BoundFigures:
        every = (*self.classes, self.need, self.force, self.arm, self.standing)
        return BoundFigures(*(one[rows] for one in every))

    def sorted_rows(self) -> NDArray[np.intp]:
        """The rows (N,) from the best figures to the worst, but for how they are rounded."""
        return np.lexsort((-self.arm, self.force, self.need, self.hang, self.late, self.falls))


@define(eq=False)
class Kept:
    """The best triples so far, or all, with the keys that they are ranked by.

    Parameters
    ----------
    limit : how many; None for all.
    found : keys and numbers of holes.
    left_out : whether there may be others.
    """

    limit: int | None
    found: list[Ranked] = field(factory=list)
    left_out: bool = False

    @property
    def last(self) -> Key | None:
        """The key that a triple has to come before; None while there is room for more."""
        return self.found[-1][0] if self.found and len(self.found) == self.limit else None

    def add(self, ranked: list[Ranked]) -> None:
        """Adds triples.

        Raises
        ------
        InputError
            For more than can be listed.
        """
        self.found += ranked
        if self.limit is not None:
            self.left_out |= len(self.found) > self.limit
            self.found = sorted(self.found)[: self.limit]
        elif len(self.found) > MOST_LISTED:
            raise InputError(
                f"more than {MOST_LISTED:,} sets of three supports hold the part up, too many to list: "
                "ask for the best of them only."
            )


@define(frozen=True, eq=False)
class TripleChoice:
    """The triples of one fixture.

    Parameters
    ----------
    sides, room, places : of the holes, of the carriers, and of the tip.
    inside : least distance of the clamp from a side, in mm.
    center : (2,) of the part's area, in mm in the part's coordinates.
    point : where the clamp stands; None where it is free.
    """

    sides: Sides
    room: CarrierRoom
    places: RankedPlaces
    inside: float
    center: Array
    point: Array | None
    point_allowed: bool = field(init=False)
    point_class: float = field(init=False)

    def __attrs_post_init__(self) -> None:
        allowed = self.point is not None and bool(self.places.allows(self.point[None])[0])
        object.__setattr__(self, "point_allowed", allowed)
        of_point = 0.0 if self.point is None else float(self.places.class_of(self.point[None])[0])
        object.__setattr__(self, "point_class", of_point)

    def chosen(
        self,
        best: int | None,
        cancel: Stop | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> Chosen:
        """The best triples, or all.

        Parameters
        ----------
        best : how many; None for all.
        cancel : when set, it stops soon, with the best of those looked at.
        progress : called with the fraction done.

        Raises
        ------
        InputError
            For all of too many.
        """
        kept = Kept(best)
        stopped = False
        for fraction, triples in () if self.places.is_empty else self.blocks():
            if cancel is not None and cancel.is_set():
                stopped = True
                break
            corners = self.sides.corners(triples, self.inside)
            bounds = self.bounds(corners)
            order = self.open_rows(bounds, np.arange(len(corners.numbers)), kept)
            order = order[bounds.take(order).sorted_rows()]
            step = LATER if best is None else max(FIRST, best)
            while len(order):
                rows, order, step = order[:step], order[step:], LATER
                kept.left_out |= kept.last is not None
                kept.add(self.judged(corners.take(rows), kept.last))
                if isinstance(cancel, WorkLimit):
                    cancel.done += len(rows) * self.places.candidate_count
                order = self.open_rows(bounds, order, kept)
            if progress is not None:
                progress(fraction)
        if progress is not None and not stopped:
            progress(1.0)
        numbers = np.array([holes for _, holes in sorted(kept.found)], np.int64).reshape(-1, 3)
        count = None if kept.left_out or stopped else len(numbers)
        return Chosen(self.sides.corners(numbers, self.inside), count, stopped)

    def open_rows(self, bounds: BoundFigures, rows: NDArray[np.intp], kept: Kept) -> NDArray[np.intp]:
        """The rows of triples that may come before the last of those kept."""
        if kept.last is None:
            return rows
        entering = self.entering(bounds.take(rows), kept.last)
        kept.left_out |= not entering.all()
        return rows[entering]

    def blocks(self) -> Iterator[tuple[float, IntArray]]:
        """Triples (N, 3) of holes any two of which may be used, in order, with the fraction done after."""
        pairs = self.room.pairs()
        count = len(pairs)
        if count <= FEW_HOLES:
            triples = list_triples(count)
            i, j, k = triples.T
            yield 1.0, triples[pairs[i, j] & pairs[i, k] & pairs[j, k]]
            return
        for i in range(count - 2):
            beside = i + 1 + np.flatnonzero(pairs[i, i + 1 :])
            j, k = np.nonzero(np.triu(pairs[np.ix_(beside, beside)], 1))
            # The work falls with the square of how many holes are left.
            done = 1.0 - (1.0 - (i + 1) / count) ** 3
            for first in range(0, len(j), AT_ONCE):
                one, other = beside[j[first : first + AT_ONCE]], beside[k[first : first + AT_ONCE]]
                yield done, np.stack([np.full(len(one), i), one, other], axis=1)

    def bounds(self, corners: Corners) -> BoundFigures:
        """What the figures of triples cannot be better than; where the point is given, what they are."""
        count = len(corners.numbers)
        late, hang, need, force = (np.zeros(count) for _ in range(4))
        arm, standing = self.sides.incircle(corners), self.standing(corners)
        given = self.given_at(corners)
        if self.point is not None:
            late = (~given).astype(np.float64)
        if self.sides.loads:
            reach, most = self.sides.reach(corners), self.sides.largest(corners)
            need = row_sum(np.maximum(reach, 0.0))
            force = np.maximum(most.max(axis=1), (need + row_sum(most)) / 3)
        if given.any():
            own = corners.take(given)
            need[given], force[given], arm[given] = self.figures_at(own, self.given_points(own))
            hang[given] = self.point_class
        return BoundFigures(falls_over(standing), late, hang, need, force, arm, standing)

    def standing(self, corners: Corners) -> Array:
        """How far (N,) in mm the centre of area is inside the triangles, as far as it counts."""
        inside = self.sides.distances(corners, self.center).min(axis=1)
        return np.asarray(np.round(inside, FIGURE_DECIMALS))

    def given_at(self, corners: Corners) -> Flags:
        """Over which triples (N,) the clamp may stand at the point asked for; none where none was."""
        if self.point is None or not self.point_allowed:
            return np.zeros(len(corners.numbers), np.bool_)
        return np.asarray(self.sides.distances(corners, self.point).min(axis=1) >= self.inside - GAP_SLACK)

    def given_points(self, corners: Corners) -> Array:
        """The point asked for, for each triple (N, 2)."""
        return np.broadcast_to(np.zeros(2) if self.point is None else self.point, (len(corners.numbers), 2))

    def figures_at(self, corners: Corners, points: Array) -> tuple[Array, Array, Array]:
        """Clamp force needed, largest support force at it, and arm (N,) with the clamp at points (N, 2)."""
        sides = self.sides.distances(corners, points)
        arm = sides.min(axis=1)
        if not self.sides.loads:
            return np.zeros(len(arm)), np.zeros(len(arm)), arm
        shares = sides / corners.heights
        with np.errstate(divide="ignore", invalid="ignore"):
            need = np.maximum((self.sides.reach(corners) / shares).max(axis=1), 0.0)
            force = (need[:, None] * shares + self.sides.largest(corners)).max(axis=1)
        return need, np.maximum(force, 0.0), arm

    def entering(self, bounds: BoundFigures, last: Key) -> Flags:
        """Which triples (N,) may come before one of a key, by bounds of their figures."""
        count = len(bounds.classes)
        keys: list[tuple[Array, float, float]] = [
            (value, one, one) for value, one in zip(bounds.classes, last[:count], strict=True)
        ]
        figures = last[count:]
        if self.sides.loads:
            # Forces of loads, then minus the arm and minus the standing.
            keys += [
                (value, *bound_coarse_figure(one))
                for value, one in zip((bounds.need, bounds.force), figures[:2], strict=True)
            ]
            keys += [
                (-value, one, one)
                for value, one in zip((bounds.arm, bounds.standing), figures[2:], strict=True)
            ]
        else:
            low, high = bound_coarse_figure(-figures[0])
            keys += [(-bounds.arm, -high, -low), (-bounds.standing, figures[1], figures[1])]
        open_, out = np.ones(len(bounds.need), np.bool_), np.zeros(len(bounds.need), np.bool_)
        for value, low, high in keys:
            slack = ROUNDING * (1.0 + abs(high))
            out |= open_ & (value < low - slack)
            open_ &= (value >= low - slack) & (value <= high + slack)
        return out | open_

    def arms(self, corners: Corners) -> tuple[Array, Array, Array]:
        """The best points (N, 2) for the tipping arm, the arms, and the classes of the points.

        An arm is 0 where the clamp may stand nowhere.
        """
        some = self.triangles(corners)
        points, value, classes = self.places.best(some, some.steepness, self.inside)
        return points, 1.0 / value, classes

    def least_forces(self, corners: Corners) -> tuple[Array, Array, Array]:
        """The points (N, 2) of the least clamp force, that force, and the classes of the points.

        Points are NaN where none is needed, and the class is the first.
        """
        reach = self.sides.reach(corners) if self.sides.loads else np.zeros(corners.heights.shape)
        points, need, classes = np.full((len(reach), 2), np.nan), np.zeros(len(reach)), np.zeros(len(reach))
        some: Flags = np.asarray((reach > 0.0).any(axis=1))
        if some.any():
            points[some], need[some], classes[some] = self.places.best(
                self.triangles(corners.take(some)), reach[some], self.inside
            )
        return points, need, classes

    def triangles(self, corners: Corners) -> Triangles:
        return Triangles.of(self.sides.points[corners.numbers])

    def judged(self, corners: Corners, last: Key | None) -> list[Ranked]:
        """Keys and holes of triples that are valid and may come before the last of the best so far."""
        corners = corners.take(self.room.standing(corners.numbers).fits)
        given = self.given_at(corners)
        out: list[Ranked] = []
        if given.any():
            own = corners.take(given)
            of_point = np.full(len(own.heights), self.point_class)
            out += self.keyed(own, 0.0, of_point, *self.figures_at(own, self.given_points(own)))
        own = corners.take(~given)
        late = 0.0 if self.point is None else 1.0
        points, need, hang = self.least_forces(own)
        usable: Flags = np.isfinite(need)
        own, points, need, hang = own.take(usable), points[usable], need[usable], hang[usable]
        # No clamp is needed anywhere: the arm alone says where it stands.
        free = np.isnan(points[:, 0])
        force = np.zeros(len(need))
        if self.sides.loads:
            known = self.figures_at(own.take(~free), points[~free])
            force[~free] = known[1]
            force[free] = np.maximum(self.sides.largest(own.take(free)).max(axis=1), 0.0)
        if last is not None:
            some = self.bounds(own)
            lates = np.full(len(need), late)
            figures = BoundFigures(some.falls, lates, hang, need, force, some.arm, some.standing)
            better = self.entering(figures, last)
            own, need, force = own.take(better), need[better], force[better]
        _, arm, hang = self.arms(own)
        usable = arm > 0.0
        return out + self.keyed(
            own.take(usable), late, hang[usable], need[usable], force[usable], arm[usable]
        )

    def keyed(
        self, corners: Corners, late: float, hang: Array, need: Array, force: Array, arm: Array
    ) -> list[Ranked]:
        standing = self.standing(corners)
        falls = falls_over(standing)
        out: list[Ranked] = []
        for k, row in enumerate(corners.numbers.tolist()):
            classes, stands = (float(falls[k]), late, float(hang[k])), -float(standing[k])
            if self.sides.loads:
                figures = (coarse(need[k]), coarse(force[k]), -round(float(arm[k]), FIGURE_DECIMALS))
                out.append(((*classes, *figures, stands), tuple(row)))
            else:
                out.append(((*classes, -coarse(arm[k]), stands), tuple(row)))
        return out


def falls_over(standing: Array) -> Array:
    """1.0 for triples (N,) from which the part falls over before it is clamped, 0.0 for others."""
    return np.asarray(standing < 0.0, np.float64)


def row_sum(values: Array) -> Array:
    """Sums (N,) of three columns."""
    return np.asarray(values[:, 0] + values[:, 1] + values[:, 2])
