"""The fixtures found so far by a search of a few at a time, or the best of them: measured, counted and
ranked."""

from __future__ import annotations

from attrs import define, field

from workhold.contact.problem import Problem
from workhold.listing.identity import Identity, SetCount, identity_order
from workhold.listing.listed import Work, proof_of
from workhold.listing.ranking import best_marked, measured_as, rank
from workhold.model.notes import undecided_note
from workhold.model.query import Query
from workhold.model.result import FixtureTable, Result
from workhold.proof.deciding import Account
from workhold.statics.contact_matrix import Touched

__all__ = ["RankedTable"]


@define(eq=False)
class RankedTable:
    """Fixtures that are listed once, no more of them than are asked for.

    Parameters
    ----------
    query : what is asked.
    problem : the search of one direction of the clamp, for what all have in common.
    """

    query: Query
    problem: Problem
    touched: Touched = field(init=False)
    count: SetCount = field(init=False)
    tables: list[FixtureTable] = field(init=False)

    def __attrs_post_init__(self) -> None:
        part, toolkit = self.query.workpiece, self.query.toolkit
        self.touched = Touched.of(part, toolkit, length=self.problem.wrench_length)
        self.count = SetCount(Identity(toolkit, part, self.query.listing != "best"))
        self.tables = [FixtureTable.empty(toolkit)]

    def __len__(self) -> int:
        return int(self.count.found.sum())

    def add(self, table: FixtureTable) -> None:
        """Takes fixtures; where only the best are asked for, keeps those that may be among them."""
        query, most = self.query, self.query.best
        self.count.add(table)
        self.tables.append(measured_as(table, query, self.touched))
        if most is not None:
            together = self.together()
            chosen = best_marked(together.quality, query.ranking, query.tolerance, most, ties=True)
            self.tables = [together.take(chosen)]

    def together(self) -> FixtureTable:
        """What is kept, in the order of identities."""
        everything = FixtureTable.joined(self.tables)
        self.tables = [everything.take(identity_order(everything))]
        return self.tables[0]

    def result(self, account: Account, work: Work) -> Result:
        """The result of all."""
        query, table = self.query, self.together()
        order = rank(table.quality, query.ranking, query.tolerance)[: query.best]
        return Result(
            query=query,
            table=table.take(order),
            found=self.count.by_type(self.count.found),
            distinct=self.count.by_type(self.count.distinct),
            complete=work.complete,
            notes=(undecided_note(len(account.undecided)),) if account.undecided else (),
            statistics=work.statistics,
            proof=proof_of(account, work),
        )
