"""Selection of the best triples of supports, or of all in order, in blocks that need little memory.

Let r_j be the force that the clamp must put on support j to keep it in contact. The sum of max(r_j, 0) is a
lower bound of the clamp force that a triple needs, wherever the clamp stands. The force on a support is at
least the force that loads alone exert on it, and at least a third of the force on all three. The tipping arm
is at most the radius of the incircle. So triples whose bounds rank after the last of the best triples so far
are skipped; the clamp's best point is computed only for the others. If the clamp's point is given, the bounds
are exact.
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
from workhold.supports.forces import CornerTriples, HoleSides, Triangles
from workhold.supports.holes import CarrierRoom

__all__ = [
    "MOST_LISTED",
    "BoundFigures",
    "ChosenTriples",
    "Stop",
    "TripleChoice",
    "WorkLimit",
    "round_coarsely",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Flags = NDArray[np.bool_]
Key = tuple[float, ...]
Ranked = tuple[Key, tuple[int, ...]]
# Up to FEW_HOLES holes all triples are one block; with more, each hole's triples are blocks of AT_ONCE at
# most.
FEW_HOLES, AT_ONCE = 48, 1 << 16
# Number of triples for which the clamp's best point is sought at a time, at first and later.
FIRST, LATER = 12, 256
# Largest number of triples that are listed; more would be useless, and not fit the memory.
MOST_LISTED = 150_000
COARSE = 2
# Relative rounding error between bounds and figures.
ROUNDING = 1e-9


def round_coarsely(value: float) -> float:
    """Return a figure rounded to two significant digits, for comparison in the ranking; 0 for figures below
    1e-9.
    """
    return float(f"{value:.{COARSE - 1}e}") if abs(value) > 10.0**-FIGURE_DECIMALS else 0.0


def bound_coarse_figure(value: float) -> tuple[float, float]:
    """Return (low, high), an interval that contains all figures that :func:`round_coarsely` rounds to
    ``value``.

    Figures below low are rounded to less, figures above high to more.
    """
    if value <= 0.0:
        return 0.0, 10.0**-FIGURE_DECIMALS
    half = 0.5 * 10.0 ** (floor(log10(value * (1 + ROUNDING))) - COARSE + 1)
    # Below a power of ten figures are ten times as fine.
    below = half * 0.1 if round_coarsely(value - half * 0.2) != round_coarsely(value) else half
    return value - min(half, below) * (1 - ROUNDING), value + half * (1 + ROUNDING)


@define(eq=False)
class WorkLimit:
    """A limit on the search of supports under several fixtures, by a count of examined places of the clamp.

    Unlike a clock it makes the outcome reproducible.

    Parameters
    ----------
    most : number of places that may be examined, of all triples together.
    done : number of places examined so far.
    """

    most: int
    done: int = 0

    def is_set(self) -> bool:
        """Return whether the limit is reached."""
        return self.done >= self.most


# What may stop a search: an event, or a count.
Stop: TypeAlias = Event | WorkLimit


@lru_cache(maxsize=4)
def list_triples(count: int) -> IntArray:
    """Return all combinations (N, 3) of three numbers from 0 to count - 1, in lexicographic order.

    The array is read-only and cached.
    """
    out = np.array(list(combinations(range(count), 3)), np.int64).reshape(-1, 3)
    out.setflags(write=False)
    return out


@define(frozen=True, eq=False)
class ChosenTriples:
    """Triples of holes in the order of their rank.

    Parameters
    ----------
    corners : the triples, best first.
    count : number of all valid triples; None if not all were examined.
    stopped : whether the search was stopped early.
    """

    corners: CornerTriples
    count: int | None
    stopped: bool


@define(frozen=True, eq=False)
class BoundFigures:
    """Figures of N triples that decide their order, or bounds of them; forces are in N, lengths in mm.

    Forces are 0 without loads.

    Parameters
    ----------
    falls : 1.0 if the part falls over before it is clamped, else 0.0.
    late : 1.0 if the clamp may not stand at the requested point, else 0.0.
    hang : class of the clamp's place, see :class:`RankedPlaces`.
    need : clamp force needed.
    force : largest force on a support.
    arm : tipping arm.
    standing : distance by which the part's centre of area is inside the triangle.
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
        """The first figures of the order: ``falls``, ``late`` and ``hang``."""
        return self.falls, self.late, self.hang

    def take(self, rows: NDArray[np.intp] | Flags) -> BoundFigures:
        """Return the figures of the rows that an index array or a mask selects."""
        every = (*self.classes, self.need, self.force, self.arm, self.standing)
        return BoundFigures(*(one[rows] for one in every))

    def sort_rows(self) -> NDArray[np.intp]:
        """Return the indices (N,) that sort the triples best first; figures are not rounded for this."""
        return np.lexsort((-self.arm, self.force, self.need, self.hang, self.late, self.falls))


@define(eq=False)
class KeptTriples:
    """The best triples found so far, or all triples, with their ranking keys.

    Parameters
    ----------
    limit : number of triples that are kept; None for all.
    found : (key, indices of holes) of each triple kept; ascending if there is a limit.
    left_out : whether valid triples may have been left out.
    """

    limit: int | None
    found: list[Ranked] = field(factory=list)
    left_out: bool = False

    @property
    def last(self) -> Key | None:
        """Key of the worst kept triple, which a further triple must beat; None while there is room for more
        triples.
        """
        return self.found[-1][0] if self.found and len(self.found) == self.limit else None

    def add_ranked(self, ranked: list[Ranked]) -> None:
        """Add triples, and keep only the best of all.

        Raises
        ------
        InputError
            For more than :data:`MOST_LISTED` without a limit.
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
    """The choice of triples of supports under one fixture.

    Parameters
    ----------
    sides : the holes that may hold a support, with the directed lines between them and the forces of the
        loads.
    room : the room of the carriers, which decides the holes that can be used together.
    places : the places for the clamp's tip.
    inside : least distance of the clamp from a side of the triangle, in mm.
    center : (2,) centre of the part's area, in mm in the part's coordinates.
    point : (2,) requested point of the clamp; None for any point.
    """

    sides: HoleSides
    room: CarrierRoom
    places: RankedPlaces
    inside: float
    center: Array
    point: Array | None
    point_allowed: bool = field(init=False)
    point_class: float = field(init=False)

    def __attrs_post_init__(self) -> None:
        allowed = self.point is not None and bool(self.places.find_allowed(self.point[None])[0])
        object.__setattr__(self, "point_allowed", allowed)
        of_point = 0.0 if self.point is None else float(self.places.find_classes(self.point[None])[0])
        object.__setattr__(self, "point_class", of_point)

    def choose(
        self,
        best: int | None,
        cancel: Stop | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> ChosenTriples:
        """Return the best triples, or all of them, best first.

        Parameters
        ----------
        best : number of triples; None for all.
        cancel : when set, the search stops soon with the best triples examined so far.
        progress : called with the fraction done.

        Raises
        ------
        InputError
            For more than :data:`MOST_LISTED` where all are asked for.
        """
        kept = KeptTriples(best)
        stopped = False
        for fraction, triples in () if self.places.is_empty else self.iterate_blocks():
            if cancel is not None and cancel.is_set():
                stopped = True
                break
            corners = self.sides.make_corners(triples, self.inside)
            bounds = self.bound_figures(corners)
            order = self.find_open_rows(bounds, np.arange(len(corners.numbers)), kept)
            order = order[bounds.take(order).sort_rows()]
            step = LATER if best is None else max(FIRST, best)
            while len(order):
                rows, order, step = order[:step], order[step:], LATER
                kept.left_out |= kept.last is not None
                kept.add_ranked(self.judge_triples(corners.take(rows), kept.last))
                if isinstance(cancel, WorkLimit):
                    cancel.done += len(rows) * self.places.candidate_count
                order = self.find_open_rows(bounds, order, kept)
            if progress is not None:
                progress(fraction)
        if progress is not None and not stopped:
            progress(1.0)
        numbers = np.array([holes for _, holes in sorted(kept.found)], np.int64).reshape(-1, 3)
        count = None if kept.left_out or stopped else len(numbers)
        return ChosenTriples(self.sides.make_corners(numbers, self.inside), count, stopped)

    def find_open_rows(
        self, bounds: BoundFigures, rows: NDArray[np.intp], kept: KeptTriples
    ) -> NDArray[np.intp]:
        """Return those of ``rows`` whose bounds allow a rank before the last of the triples kept."""
        if kept.last is None:
            return rows
        entering = self.find_entering(bounds.take(rows), kept.last)
        kept.left_out |= not entering.all()
        return rows[entering]

    def iterate_blocks(self) -> Iterator[tuple[float, IntArray]]:
        """Yield (fraction done after the block, triples (N, 3)), in lexicographic order.

        A triple is three indices of holes that are pairwise compatible.
        """
        pairs = self.room.find_compatible_pairs()
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

    def bound_figures(self, corners: CornerTriples) -> BoundFigures:
        """Return bounds of figures: no figure of a triple is better than its bound.

        For triples over which the clamp may stand at the requested point, the bounds are the figures
        themselves.
        """
        count = len(corners.numbers)
        late, hang, need, force = (np.zeros(count) for _ in range(4))
        arm, standing = self.sides.compute_incircles(corners), self.measure_standing(corners)
        given = self.find_allowed_at_given(corners)
        if self.point is not None:
            late = (~given).astype(np.float64)
        if self.sides.loads:
            reach, most = (
                self.sides.compute_contact_forces(corners),
                self.sides.compute_largest_forces(corners),
            )
            need = sum_columns(np.maximum(reach, 0.0))
            force = np.maximum(most.max(axis=1), (need + sum_columns(most)) / 3)
        if given.any():
            own = corners.take(given)
            need[given], force[given], arm[given] = self.compute_figures(own, self.repeat_given_point(own))
            hang[given] = self.point_class
        return BoundFigures(falls_over(standing), late, hang, need, force, arm, standing)

    def measure_standing(self, corners: CornerTriples) -> Array:
        """Return how far in mm the centre of the part's area is inside
        each triangle, rounded, (N,); negative outside.
        """
        inside = self.sides.measure_distances(corners, self.center).min(axis=1)
        return np.asarray(np.round(inside, FIGURE_DECIMALS))

    def find_allowed_at_given(self, corners: CornerTriples) -> Flags:
        """Return a mask (N,): True for triples over which the clamp may stand at the requested point.

        All are False if no point was requested.
        """
        if self.point is None or not self.point_allowed:
            return np.zeros(len(corners.numbers), np.bool_)
        return np.asarray(
            self.sides.measure_distances(corners, self.point).min(axis=1) >= self.inside - GAP_SLACK
        )

    def repeat_given_point(self, corners: CornerTriples) -> Array:
        """Return the requested point, repeated for each triple, (N, 2); zeros if no point was requested."""
        return np.broadcast_to(np.zeros(2) if self.point is None else self.point, (len(corners.numbers), 2))

    def compute_figures(self, corners: CornerTriples, points: Array) -> tuple[Array, Array, Array]:
        """Return (the clamp force needed in N, the largest support force with it in N, the tipping arm in
        mm), (N,) each.

        The clamp stands at points (N, 2). Without loads the forces are 0.
        """
        sides = self.sides.measure_distances(corners, points)
        arm = sides.min(axis=1)
        if not self.sides.loads:
            return np.zeros(len(arm)), np.zeros(len(arm)), arm
        shares = sides / corners.heights
        with np.errstate(divide="ignore", invalid="ignore"):
            need = np.maximum((self.sides.compute_contact_forces(corners) / shares).max(axis=1), 0.0)
            force = (need[:, None] * shares + self.sides.compute_largest_forces(corners)).max(axis=1)
        return need, np.maximum(force, 0.0), arm

    def find_entering(self, bounds: BoundFigures, last: Key) -> Flags:
        """Return a mask (N,): True for triples whose bounds allow a rank before the key ``last``."""
        count = len(bounds.classes)
        keys: list[tuple[Array, float, float]] = [
            (value, one, one) for value, one in zip(bounds.classes, last[:count], strict=True)
        ]
        figures = last[count:]
        if self.sides.loads:
            # Keys: forces, then the negated arm, then the negated standing.
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

    def find_best_arms(self, corners: CornerTriples) -> tuple[Array, Array, Array]:
        """Return (the points (N, 2) with the largest tipping arm, the arms in mm, the points' classes).

        The arm is 0 if there is no place for the clamp. For classes see :class:`RankedPlaces`.
        """
        some = self.make_triangles(corners)
        points, value, classes = self.places.find_best(some, some.steepness, self.inside)
        return points, 1.0 / value, classes

    def find_least_forces(self, corners: CornerTriples) -> tuple[Array, Array, Array]:
        """Return (the points (N, 2) with the least clamp force, the forces in N, the points' classes).

        If no clamp is needed, the point is NaN, and force and class are 0. If there is no place for the
        clamp, the force is inf.
        """
        reach = (
            self.sides.compute_contact_forces(corners)
            if self.sides.loads
            else np.zeros(corners.heights.shape)
        )
        points, need, classes = np.full((len(reach), 2), np.nan), np.zeros(len(reach)), np.zeros(len(reach))
        some: Flags = np.asarray((reach > 0.0).any(axis=1))
        if some.any():
            points[some], need[some], classes[some] = self.places.find_best(
                self.make_triangles(corners.take(some)), reach[some], self.inside
            )
        return points, need, classes

    def make_triangles(self, corners: CornerTriples) -> Triangles:
        """Return the triangles of corner triples."""
        return Triangles.from_corners(self.sides.points[corners.numbers])

    def judge_triples(self, corners: CornerTriples, last: Key | None) -> list[Ranked]:
        """Return (key, indices of holes) of the valid triples that rank before the key ``last``.

        With ``last`` None, all valid triples are returned.
        """
        corners = corners.take(self.room.place_sets(corners.numbers).fits)
        given = self.find_allowed_at_given(corners)
        out: list[Ranked] = []
        if given.any():
            own = corners.take(given)
            of_point = np.full(len(own.heights), self.point_class)
            out += self.make_keys(
                own, 0.0, of_point, *self.compute_figures(own, self.repeat_given_point(own))
            )
        own = corners.take(~given)
        late = 0.0 if self.point is None else 1.0
        points, need, hang = self.find_least_forces(own)
        usable: Flags = np.isfinite(need)
        own, points, need, hang = own.take(usable), points[usable], need[usable], hang[usable]
        # No clamp is needed anywhere: the arm alone says where it stands.
        free = np.isnan(points[:, 0])
        force = np.zeros(len(need))
        if self.sides.loads:
            known = self.compute_figures(own.take(~free), points[~free])
            force[~free] = known[1]
            force[free] = np.maximum(self.sides.compute_largest_forces(own.take(free)).max(axis=1), 0.0)
        if last is not None:
            some = self.bound_figures(own)
            lates = np.full(len(need), late)
            figures = BoundFigures(some.falls, lates, hang, need, force, some.arm, some.standing)
            better = self.find_entering(figures, last)
            own, need, force = own.take(better), need[better], force[better]
        _, arm, hang = self.find_best_arms(own)
        usable = arm > 0.0
        return out + self.make_keys(
            own.take(usable), late, hang[usable], need[usable], force[usable], arm[usable]
        )

    def make_keys(
        self, corners: CornerTriples, late: float, hang: Array, need: Array, force: Array, arm: Array
    ) -> list[Ranked]:
        """Return (key, indices of holes) of N triples from their figures (N,); smaller keys are better.

        ``late`` is 1.0 for triples over which the clamp cannot stand at the requested point, else 0.0.
        """
        standing = self.measure_standing(corners)
        falls = falls_over(standing)
        out: list[Ranked] = []
        for k, row in enumerate(corners.numbers.tolist()):
            classes, stands = (float(falls[k]), late, float(hang[k])), -float(standing[k])
            if self.sides.loads:
                figures = (
                    round_coarsely(need[k]),
                    round_coarsely(force[k]),
                    -round(float(arm[k]), FIGURE_DECIMALS),
                )
                out.append(((*classes, *figures, stands), tuple(row)))
            else:
                out.append(((*classes, -round_coarsely(arm[k]), stands), tuple(row)))
        return out


def falls_over(standing: Array) -> Array:
    """Return 1.0 for triples from which the part falls over before it is clamped, else 0.0, (N,).

    The part falls where ``standing`` is negative, see :class:`BoundFigures`.
    """
    return np.asarray(standing < 0.0, np.float64)


def sum_columns(values: Array) -> Array:
    """Return the sums (N,) of the three columns of (N, 3)."""
    return np.asarray(values[:, 0] + values[:, 1] + values[:, 2])
