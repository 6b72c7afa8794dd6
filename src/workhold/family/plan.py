"""The plan at a point of the curve: its set-ups in order, and the position of every member in its set-up.

The chosen order moves the fewest pegs. A set-up may be anywhere on the lattice where the toolkit has no end.
Two consecutive set-ups share the pegs that are in the same holes; the others are moved. Up to ``MOST_EXACT``
set-ups the order is the shortest path through all of them (Held & Karp, *A dynamic programming approach to
sequencing problems*, 1962). With more, it goes from each to the nearest that is left. In a plain vise the
parallels and the work stop take the place of pegs.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.family.covering import LossTable, Point
from workhold.family.jaw_setups import JawSetUp, StopRange, choose_stop_level, list_changed_places
from workhold.family.members import Member
from workhold.family.patterns import NOTHING, list_holes, move_onto_pattern, shift_fixture
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.fixture_table import FixtureTable, make_fixture_of_row
from workhold.model.jaw_hold import JawHold
from workhold.model.quality import find_figure_number

__all__ = [
    "MOST_EXACT",
    "SetUpFreedom",
    "Holding",
    "FamilyPlan",
    "SetUp",
    "PlanStep",
    "find_best_order",
    "find_freedom",
    "make_plan",
]

MOST_EXACT = 12
# The cost of a way that nobody goes.
FAR = 1 << 30

Holes = Sequence[tuple[int, int, int]]


@frozen
class SetUpFreedom:
    """Whether a set-up may be moved by columns, and by rows."""

    columns: bool
    rows: bool


@frozen
class PlanStep:
    """A set-up in the order in which set-ups follow each other.

    Parameters
    ----------
    setup : its index.
    columns, rows : how far the set-up is shifted, in columns and rows.
    moved : number of pegs to place, since the previous set-up has none in these holes.
    """

    setup: int
    columns: int
    rows: int
    moved: int


def find_freedom(toolkit: Toolkit) -> SetUpFreedom:
    """Return whether set-ups of a toolkit may be moved by columns, and whether by rows.

    They may if its plates have no end. By rows they may only if, besides, rows are not counted from a wall
    and no hole is blocked.
    """
    plates, is_counted = toolkit.plates, toolkit.datum.fixes_rows
    return SetUpFreedom(
        columns=all(plate.columns is None for plate in plates),
        rows=not is_counted and all(plate.rows is None and not plate.blocked for plate in plates),
    )


def move_holes(holes: Holes, columns: int, rows: int) -> list[tuple[int, int, int]]:
    """Return the holes moved by columns and rows; a column or row equal to ``NOTHING`` stays."""
    return [
        (one, column if column == NOTHING else column + columns, row if row == NOTHING else row + rows)
        for one, column, row in holes
    ]


def list_moves(before: Holes, after: Holes, freedom: SetUpFreedom) -> Iterator[tuple[int, int]]:
    """Yield moves (columns, rows) of ``after``: first (0, 0), then each that brings one of its pegs into a
    hole of ``before``.

    A move is 0 along directions in which set-ups may not be moved.
    """
    yield 0, 0
    for (one, column, row), (other, x, y) in product(before, after):
        if one == other:
            yield (column - x if freedom.columns else 0), (row - y if freedom.rows else 0)


def find_cheapest_move(before: Holes, after: Holes, freedom: SetUpFreedom) -> tuple[int, int, int]:
    """Return (pegs to place, columns, rows) of the move of ``after`` that leaves the fewest pegs to place
    after ``before``.

    Of equally good moves it is the shortest, then the first.
    """
    there = Counter(before)
    best = min(
        (sum((Counter(move_holes(after, *move)) - there).values()), abs(move[0]) + abs(move[1]), move)
        for move in set(list_moves(before, after, freedom))
    )
    return best[0], *best[2]


def find_best_order(setups: Sequence[Holes], freedom: SetUpFreedom) -> list[PlanStep]:
    """Return the steps through all set-ups in the order that needs the fewest pegs to be placed.

    ``setups`` gives the holes of each set-up. Of equally good orders it is the first by indices. All set-ups
    are moved so that the lowest column and row are 0 in the directions in which they may be moved.
    """
    cost = np.array([[find_cheapest_move(one, other, freedom)[0] for other in setups] for one in setups])
    path = find_shortest_path(cost) if len(setups) <= MOST_EXACT else find_greedy_path(cost)
    stood: list[tuple[PlanStep, Holes]] = []
    for number in path:
        holes = setups[number]
        pegs, columns, rows = (
            find_cheapest_move(stood[-1][1], holes, freedom) if stood else (len(holes), 0, 0)
        )
        stood.append((PlanStep(number, columns, rows, pegs), move_holes(holes, columns, rows)))
    first_column, first_row = (
        min((hole[axis] for _, holes in stood for hole in holes if hole[axis] != NOTHING), default=0)
        if free
        else 0
        for axis, free in ((1, freedom.columns), (2, freedom.rows))
    )
    return [
        evolve(step, columns=step.columns - first_column, rows=step.rows - first_row) for step, _ in stood
    ]


def find_shortest_path(cost: NDArray[np.int64]) -> list[int]:
    """Return the shortest path through all S places, as indices; of equally short paths the first.

    ``cost`` (S, S) is the cost from the place of the row to the place of the column.
    """
    count = len(cost)
    bit, every = 1 << np.arange(count), np.arange(count)
    # length[v, s]: of the shortest way from place s through all that are not among the bits of v.
    length, onward = np.zeros((1 << count, count), np.int64), np.zeros((1 << count, count), np.int64)
    for visited in range((1 << count) - 2, 0, -1):
        ahead = np.flatnonzero(visited & bit == 0)
        ways = cost[:, ahead] + length[visited | bit[ahead], ahead]
        chosen = ways.argmin(axis=1)
        onward[visited], length[visited] = ahead[chosen], ways[every, chosen]
    path = [int(np.argmin(length[bit, every]))]
    visited = int(bit[path[0]])
    while len(path) < count:
        path.append(int(onward[visited, path[-1]]))
        visited |= int(bit[path[-1]])
    return path


def find_greedy_path(cost: NDArray[np.int64]) -> list[int]:
    """Return a path through all S places, as indices: from place 0, always on to the nearest place not yet
    visited.

    ``cost`` (S, S) is the cost from the place of the row to the place of the column.
    """
    path, left = [0], np.arange(len(cost)) != 0
    while left.any():
        path.append(int(np.argmin(np.where(left, cost[path[-1]], FAR))))
        left[path[-1]] = False
    return path


@frozen(eq=False)
class Holding:
    """A member as it lies in a set-up.

    Parameters
    ----------
    member : the part.
    number : number of the fixture in the list of all the part's fixtures, best first, from 1.
    loss : loss of the fixture.
    turned : whether the listed fixture is used after half a turn of everything, so that the other jaw is the
        fixed one.
    row : the fixture as placed in the set-up, a table of one row.
    in_place : whether its pegs are in the holes of the set-up; False when the vise's largest opening or
        smallest gap forces other columns.
    hold : how flat jaws hold it; None with pegs.
    stop_range : where the tip of a work stop can stop it; None with pegs.
    """

    member: Member
    number: int
    loss: float
    turned: bool
    row: FixtureTable
    in_place: bool = True
    hold: JawHold | None = None
    stop_range: StopRange | None = None

    @property
    def fixture(self) -> Fixture:
        """The fixture as placed in the set-up."""
        query = self.member.query
        return evolve(make_fixture_of_row(self.row, query.toolkit, 0, query.workpiece), hold=self.hold)

    @property
    def figure(self) -> float:
        """The fixture's value of the figure of which losses are computed; NaN where it is not known."""
        if self.hold is not None:
            value = getattr(self.hold, self.member.figure.key)
            return float("nan") if value is None else float(value)
        return float(self.row.quality[0, find_figure_number(self.member.query.rank_by[0]) or 0])


@frozen(eq=False)
class SetUp:
    """A pattern in its holes with the members that it holds.

    Parameters
    ----------
    pattern : its number among all patterns of the family, in the order of their identities.
    holdings : the members held here, at least one, in the order of the family.
    moved : number of pegs to place, since the previous set-up has none in these holes; in the first set-up,
        the number of all pegs. In a plain vise it counts the parallels and the work stop.
    jaws : parallels and work stop of a plain vise; None with pegs.
    """

    pattern: int
    holdings: tuple[Holding, ...]
    moved: int
    jaws: JawSetUp | None = None

    @property
    def standing(self) -> Holding:
        """The first holding whose pegs are in the holes of the set-up."""
        return next(one for one in self.holdings if one.in_place)


@frozen(eq=False)
class FamilyPlan:
    """The plan at one point of a family's curve.

    Parameters
    ----------
    point : the point of the curve.
    setups : in the order in which the fewest pegs are moved.
    """

    point: Point
    setups: tuple[SetUp, ...]

    @property
    def moved(self) -> int:
        """Number of pegs to place, summed over all set-ups but the first."""
        return sum(setup.moved for setup in self.setups[1:])


def make_plan(point: Point, table: LossTable, members: Sequence[Member]) -> FamilyPlan:
    """Return the plan of a point of the curve.

    Each member is in the set-up with the least loss on it, and set-ups are in the order that needs the fewest
    pegs to be placed.
    """
    losses = table.list_losses(point.patterns)
    # Where two patterns suit a member alike, the one with the smaller identity has it.
    suits = np.argmin(np.where(np.isnan(losses), np.inf, losses), axis=0)
    setups = []
    for place, pattern in enumerate(point.patterns):
        held = [members[number] for number in np.flatnonzero(suits == place).tolist()]
        holdings = [make_holding(one, table.words[pattern]) for one in held]
        if holdings and holdings[0].hold is not None:
            jaws = JawSetUp.from_words(table.words[pattern].tolist())
            setups.append(SetUp(pattern, tuple(holdings), 0, jaws))
        elif holdings:
            setups.append(SetUp(pattern, align_holdings(holdings), 0))
    return FamilyPlan(point, sort_in_best_order(place_stops(setups)))


def make_holding(member: Member, words: NDArray[np.int64]) -> Holding:
    """Return the best fixture of a member that has the pattern ``words`` (W,)."""
    place = int(np.flatnonzero((member.words == words).all(axis=1))[0])
    row = member.table.take(slice(place, place + 1))
    holding = Holding(
        member, int(member.number[place]) + 1, float(member.loss[place]), bool(member.turned[place]), row
    )
    if not member.holds:
        return holding
    return evolve(holding, hold=member.holds[place], stop_range=member.stop_ranges[place])


def place_stops(setups: Sequence[SetUp]) -> list[SetUp]:
    """Return the set-ups with the tip of each work stop where it suits all parts, at one place in as many of them
    as possible.

    Set-ups with pegs, and without a stop, are returned unchanged.
    """
    out = list(setups)
    ends = {setup.jaws.stop for setup in setups if setup.jaws is not None and setup.jaws.stop is not None}
    for end in sorted(ends):
        places = [k for k, setup in enumerate(setups) if setup.jaws is not None and setup.jaws.stop == end]
        # All of them with one stop; else those together whose patterns have the tip at one place.
        levels = sorted({jaws.level for k in places if (jaws := setups[k].jaws) is not None})
        for level in levels:
            level_for_all = find_stop_level([setups[k] for k in places], level)
            if level_for_all is not None:
                groups = {level_for_all: places}
                break
        else:
            groups = {}
            for level in levels:
                alike = [k for k in places if (jaws := setups[k].jaws) is not None and jaws.level == level]
                found = find_stop_level([setups[k] for k in alike], level)
                groups[level if found is None else found] = alike
        for level, some in groups.items():
            for k in some:
                jaws = setups[k].jaws
                assert jaws is not None
                out[k] = evolve(setups[k], jaws=evolve(jaws, level=level))
    return out


def find_stop_level(setups: Sequence[SetUp], tried: float) -> float | None:
    """Return y in mm for the tip of a work stop that serves all parts of some set-ups; None where none is known.

    ``tried`` is a place that serves those of one of them.
    """
    held = [one for setup in setups for one in setup.holdings]
    ranges = [one.stop_range for one in held if one.stop_range is not None]
    parts = [(one.member.query, one.hold, one.fixture.pose) for one in held if one.hold is not None]
    return choose_stop_level(ranges, tried, parts)


def align_holdings(holdings: Sequence[Holding]) -> tuple[Holding, ...]:
    """Return the holdings of one pattern, moved into common holes.

    The holes are those of the holding that most of the others can join. A holding that cannot be moved there
    keeps its place, with ``in_place`` False.
    """
    best: list[Holding] = []
    for target in holdings:
        toolkit = target.member.query.toolkit
        moved = [move_onto_pattern(one.row, target.row, toolkit) for one in holdings]
        tried = [
            evolve(one, row=one.row if row is None else row, in_place=row is not None)
            for one, row in zip(holdings, moved, strict=True)
        ]
        if sum(one.in_place for one in tried) > sum(one.in_place for one in best):
            best = tried
        if all(one.in_place for one in best):
            break
    return tuple(best)


def sort_in_best_order(setups: Sequence[SetUp]) -> tuple[SetUp, ...]:
    """Return the set-ups in the order that needs the fewest pegs to be placed, each shifted as this order
    needs it.

    In a plain vise it is the order with the fewest changes of parallels and work stop.
    """
    toolkit = setups[0].holdings[0].member.query.toolkit
    jaws = [list_changed_places(setup.jaws) for setup in setups if setup.jaws is not None]
    if jaws:
        steps = find_best_order(jaws, SetUpFreedom(columns=False, rows=False))
        return tuple(evolve(setups[step.setup], moved=step.moved) for step in steps)
    holes = [list_holes(setup.standing.row, toolkit) for setup in setups]
    out = []
    for step in find_best_order(holes, find_freedom(toolkit)):
        setup = setups[step.setup]
        rows = (shift_fixture(one.row, toolkit, {0: step.columns}, step.rows) for one in setup.holdings)
        holdings = tuple(evolve(one, row=row) for one, row in zip(setup.holdings, rows, strict=True))
        out.append(evolve(setup, holdings=holdings, moved=step.moved))
    return tuple(out)
