"""The plan at a point of the curve: its set-ups in order, and how every member lies in the one that holds it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.family.curve import Point, Table
from workhold.family.holding import holes_of, moved_onto, shifted
from workhold.family.members import Member
from workhold.family.order import best_order, freedom_of
from workhold.model.fixture import Fixture
from workhold.model.quality import figure_number
from workhold.model.result import FixtureTable, fixture_at

__all__ = ["Holding", "Plan", "SetUp", "plan_of"]


@frozen(eq=False)
class Holding:
    """How a member lies in a set-up.

    Parameters
    ----------
    member : the part.
    number : of the fixture in the list of all of the part's fixtures, best first, from 1.
    loss : of the fixture.
    turned : whether it is listed as it is half a turn of everything before, so that the other jaw stands still.
    row : the fixture as it stands in the set-up, a table of one row.
    in_place : whether its pegs stand in the holes of the set-up; not so of a vise whose largest opening, or smallest gap,
        asks for other columns.
    """

    member: Member
    number: int
    loss: float
    turned: bool
    row: FixtureTable
    in_place: bool = True

    @property
    def fixture(self) -> Fixture:
        """The fixture as it stands in the set-up."""
        return fixture_at(self.row, self.member.query.toolkit, 0, self.member.query.workpiece)

    @property
    def figure(self) -> float:
        """The figure that losses are told of."""
        return float(self.row.quality[0, figure_number(self.member.query.ranking[0]) or 0])


@frozen(eq=False)
class SetUp:
    """A pattern in its holes with the members that it holds.

    Parameters
    ----------
    pattern : its number among all patterns of the family, in the order of their identities.
    holdings : at least one, in the order of the family.
    moved : how many pegs are to be placed that did not stand there in the set-up before; all of them in the first.
    """

    pattern: int
    holdings: tuple[Holding, ...]
    moved: int

    @property
    def standing(self) -> Holding:
        """A holding whose pegs stand in the holes of the set-up."""
        return next(one for one in self.holdings if one.in_place)


@frozen(eq=False)
class Plan:
    """A plan.

    Parameters
    ----------
    point : of the curve.
    setups : in the order in which the fewest pegs are moved.
    """

    point: Point
    setups: tuple[SetUp, ...]

    @property
    def moved(self) -> int:
        """How many pegs are moved between the set-ups in all."""
        return sum(setup.moved for setup in self.setups[1:])


def plan_of(point: Point, table: Table, members: Sequence[Member]) -> Plan:
    """The plan at a point of a family's curve."""
    losses = table.losses_of(point.patterns)
    # Where two patterns suit a member alike, the one with the smaller identity has it.
    suits = np.argmin(np.where(np.isnan(losses), np.inf, losses), axis=0)
    setups = []
    for place, pattern in enumerate(point.patterns):
        held = [members[number] for number in np.flatnonzero(suits == place).tolist()]
        if held:
            setups.append(SetUp(pattern, together([holding(one, table.words[pattern]) for one in held]), 0))
    return Plan(point, in_best_order(setups))


def holding(member: Member, words: NDArray[np.int64]) -> Holding:
    """How the best fixture of a member with a pattern lies."""
    place = int(np.flatnonzero((member.words == words).all(axis=1))[0])
    row = member.table.take(slice(place, place + 1))
    return Holding(member, int(member.number[place]) + 1, float(member.loss[place]), bool(member.turned[place]), row)


def together(holdings: Sequence[Holding]) -> tuple[Holding, ...]:
    """Holdings of one pattern in the same holes: those of the first whose holes suit most of the others."""
    best: list[Holding] = []
    for target in holdings:
        toolkit = target.member.query.toolkit
        moved = [moved_onto(one.row, target.row, toolkit) for one in holdings]
        tried = [one if row is None else evolve(one, row=row) for one, row in zip(holdings, moved, strict=True)]
        tried = [evolve(one, in_place=row is not None) for one, row in zip(tried, moved, strict=True)]
        if sum(one.in_place for one in tried) > sum(one.in_place for one in best):
            best = tried
        if all(one.in_place for one in best):
            break
    return tuple(best)


def in_best_order(setups: Sequence[SetUp]) -> tuple[SetUp, ...]:
    """Set-ups in the order in which the fewest pegs are moved, each where that asks for it to stand."""
    toolkit = setups[0].holdings[0].member.query.toolkit
    holes = [holes_of(setup.standing.row, toolkit) for setup in setups]
    out = []
    for step in best_order(holes, freedom_of(toolkit)):
        setup = setups[step.setup]
        rows = (shifted(one.row, toolkit, {0: step.columns}, step.rows) for one in setup.holdings)
        holdings = tuple(evolve(one, row=row) for one, row in zip(setup.holdings, rows, strict=True))
        out.append(evolve(setup, holdings=holdings, moved=step.moved))
    return tuple(out)
