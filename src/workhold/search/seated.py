"""The seating of the first fixtures of a list, and the new order that follows from it.

A search finds and ranks fixtures by figures that do not need the seating. Then the seating is computed for
the first fixtures, as many as the query asks for, once for each pattern of pegs. These fixtures are ranked
again; warnings of the seating count like those of quality. Equal fixtures keep their order. Fixtures whose
seating breaks the query's rules are left out. If there are such rules, fixtures without a computed seating
are left out as well.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path
from threading import Event
from typing import Protocol

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.contact.problem import Progress
from workhold.errors import InputError
from workhold.listing.ranking import convert_to_billionths, find_usual_errors, make_order_keys
from workhold.listing.results import make_stage_progress
from workhold.model.fixture_table import FixtureTable
from workhold.model.notes import BestOnly, Cut, Note, PushedByHand, Seated
from workhold.model.quality import FIGURES, SEATING_FIGURES, WARNINGS, fill_figure_rows
from workhold.model.query import SEATING_KEYS, Query
from workhold.model.result import Result
from workhold.model.seating import Seating
from workhold.seating.part_features import refuse_own_outlines
from workhold.seating.pattern import refuse_unseated
from workhold.statics.effective_error import classify_angles

__all__ = ["ResultSink", "refuse_unasked", "answer_with_seating"]

# The share of the work, as progress reports it, that is the search.
SEARCHED = 0.3


class ResultSink(Protocol):
    """A receiver of results too large for memory.

    Attributes
    ----------
    folder : for temporary files of sorting.
    """

    @property
    def folder(self) -> Path: ...

    def receive(self, result: Result, listed: int, tables: Iterable[FixtureTable]) -> None:
        """Take a result and its fixtures, best first, in tables one after the other.

        Parameters
        ----------
        listed : number of fixtures in all tables together; fewer come if the search is cancelled.
        """


@frozen
class SeatingWork:
    """A query whose fixtures' seating is to be computed, with threads, progress and cancel.

    Parameters
    ----------
    query : the query; its ``seating`` is the number of first fixtures that get one.
    threads : how many threads share the work.
    progress : called as ``progress(fraction done, number of fixtures)``; None for no reports.
    cancel : when set, no further pattern of pegs is begun.
    """

    query: Query
    threads: int
    progress: Progress | None
    cancel: Event | None


def answer_with_seating(
    query: Query,
    search: Callable[..., Result],
    *,
    threads: int = 1,
    progress: Progress | None = None,
    cancel: Event | None = None,
    sink: ResultSink | None = None,
) -> Result:
    """Return the answer to a query, with the seating of the first fixtures if the query asks for it.

    Parameters
    ----------
    search : called as ``search(query, progress=…, cancel=…)`` with a query without seating, and with
        ``sink=…`` where a sink is given; returns the result.
    threads, progress, cancel : see ``search.design.answer``.
    sink : takes the fixtures; the result that is returned has none then.

    Raises
    ------
    InputError
        Where :func:`refuse_unasked` or the search raises it.
    """
    if query.seating is None:
        return search(query, progress=progress, cancel=cancel)
    refuse_unasked(query)
    by_hand, rest = is_put_in_by_hand(query), None
    if not by_hand:
        # A sink takes fixtures while the search still reports its end.
        whole = progress if sink is None or progress is None else make_rising_progress(progress)
        progress, rest = make_stage_progress(whole, 0.0, SEARCHED), make_stage_progress(whole, SEARCHED, 1.0)
    work = SeatingWork(query, threads, rest, cancel)
    taker = {} if sink is None else {"sink": SeatedSink(sink, work)}
    result = search(query.without_seating, progress=progress, cancel=cancel, **taker)
    if by_hand:
        return explain_putting_in_by_hand(result, query)
    return add_seatings(result, work) if sink is None else evolve(result, query=query)


def is_put_in_by_hand(query: Query) -> bool:
    """Return whether the part is pushed against its locators by hand, as with two clamps."""
    return not query.toolkit.closes_at_once


def refuse_unasked(query: Query) -> None:
    """Raise InputError where a query asks for something that seating cannot answer.

    Raises
    ------
    InputError
        Two cases: (a) with one closing movement, where ``refuse_unseated`` or ``refuse_own_outlines`` raises
        it; (b) with two clamps, if rules or rankings use figures of seating.
    """
    if not is_put_in_by_hand(query):
        refuse_own_outlines(query.workpiece)
        refuse_unseated(query.toolkit)
    elif query.has_seating_rules or not SEATING_KEYS.isdisjoint(query.rank_by):
        raise InputError(
            "with two clamps the part is put against its locators by hand, so no opening, reading "
            "or other figure of seating can choose or rank fixtures: ask for the seating alone."
        )


def explain_putting_in_by_hand(result: Result, query: Query) -> Result:
    """Return the result of a query with two clamps as the answer to the same query with seating.

    The fixtures stay the same; a note says that the part is pushed against its locators by hand.
    """
    notes = (*result.reasons, PushedByHand()) if sum(result.found.values()) else result.reasons
    return evolve(result, query=query, notes=notes)


def make_rising_progress(progress: Progress) -> Progress:
    """Return a progress callback that passes reports on, with a fraction that never decreases."""
    highest = 0.0

    def report(fraction: float, found: int) -> None:
        """Report the largest fraction so far, and the number of fixtures as given."""
        nonlocal highest
        highest = max(highest, fraction)
        progress(highest, found)

    return report


def add_seatings(result: Result, work: SeatingWork) -> Result:
    """Return a result with the seatings of its first fixtures added, and its fixtures ordered anew by them.

    ``result`` answers the query without seating. Fixtures that break rules of seating are left out. If the
    query has such rules, fixtures whose seating was not computed are left out, too.
    """
    query, count = work.query, min(work.query.seating or 0, len(result))
    seatings = find_seatings(result.slice_rows(slice(0, count)), work)
    looked_at = np.flatnonzero([one is not None for one in seatings])
    known = [one for one in seatings if one is not None]
    order = order_by_seating(result.table.take(looked_at), known, query, result.least_effective_error)
    kept = [place for place in order.tolist() if is_as_asked(known[place], query)]
    notes: list[Note] = [
        BestOnly(query.best) if isinstance(note, BestOnly) and query.best else note for note in result.reasons
    ]
    first = looked_at[kept]
    if query.has_seating_rules:
        # Why there is no fixture at all is said already.
        notes = [note for note in notes if not isinstance(note, Cut)]
        rows, notes = first, [*notes, Seated(len(known), len(kept))] if len(result) else notes
    else:
        rows = np.concatenate([first, np.delete(np.arange(len(result)), first)])
    return evolve(
        result,
        query=query,
        table=result.table.take(rows[: query.best]),
        seating=tuple(known[place] for place in kept[: query.best]),
        complete=result.complete and len(known) == count,
        notes=notes,
    )


def is_as_asked(seating: Seating, query: Query) -> bool:
    """Return whether a seating satisfies the query's opening and foolproof rules; True for a query without
    them.

    A rule that the query does not have is kept.
    """
    catches = query.opening is None or seating.is_caught_from(query.opening)
    return catches and (seating.is_foolproof or not query.foolproof)


def order_by_seating(
    table: FixtureTable, seatings: Sequence[Seating], query: Query, least_effective_error: float | None
) -> NDArray[np.intp]:
    """Return the indices (N,) that put fixtures with seatings in
    order, best first; equal ones keep their order.

    ``least_effective_error`` is the least effective location error in mm of all fixtures found, also of those
    without a seating; the ranking counts its steps of error from there. None if the ranking does not use it.
    """
    further = [[one.figures[figure.key] for figure in SEATING_FIGURES] for one in seatings]
    seating = np.array(further).reshape(len(seatings), len(SEATING_FIGURES))
    # What there is of a program stays the last column.
    whole = fill_figure_rows(table.quality)
    quality = np.hstack([whole[:, : len(FIGURES)], seating, whole[:, len(FIGURES) :]])
    quality[:, WARNINGS] += [one.warning_count for one in seatings]
    effective = find_usual_errors(query)
    error = None if effective is None else effective.compute_errors(table)
    keys = make_order_keys(quality, query, error, classify_angles(table.theta))
    return keys.sort(
        None
        if least_effective_error is None
        else int(convert_to_billionths(np.array([least_effective_error]))[0])
    )


def find_seatings(result: Result, work: SeatingWork) -> list[Seating | None]:
    """Return the seating of each fixture of a result, in order; None
    for those not computed before ``cancel``.
    """
    progress, count = work.progress, sum(result.found.values())
    # Loading it takes longer than many a search.
    from workhold.seating.solver import SeatingSolver

    made = SeatingSolver(result.workpiece, result.toolkit).solve_until_cancelled(
        result,
        threads=work.threads,
        progress=None if progress is None else lambda done: progress(done, count),
        cancel=work.cancel,
    )
    return [None if one is None else evolve(one, opening=work.query.opening) for one in made]


@frozen
class SeatedSink:
    """A sink that adds the seating of the first fixtures to a result, and passes the result on.

    Parameters
    ----------
    sink : receives the results with seating.
    work : the query, with threads, progress and cancel for the seating.
    """

    sink: ResultSink
    work: SeatingWork

    @property
    def folder(self) -> Path:
        """Folder for temporary files of sorting."""
        return self.sink.folder

    def receive(self, result: Result, listed: int, tables: Iterable[FixtureTable]) -> None:
        """Pass on a result with the seating of its first fixtures; see :meth:`ResultSink.receive`."""
        if is_put_in_by_hand(self.work.query):
            self.sink.receive(explain_putting_in_by_hand(result, self.work.query), listed, tables)
            return
        rest = iter(tables)
        held = list(take_tables(rest, self.work.query.seating or 0)) or [result.table]
        made = add_seatings(evolve(result, table=FixtureTable.concatenate(held)), self.work)
        further = () if self.work.query.has_seating_rules else rest
        count = len(made) + (0 if self.work.query.has_seating_rules else listed - sum(map(len, held)))
        self.sink.receive(made, count, chain([made.table], further))


def take_tables(tables: Iterator[FixtureTable], count: int) -> Iterator[FixtureTable]:
    """Yield tables until they have at least ``count`` fixtures together, or the iterator ends.

    The iterator can be continued afterwards.
    """
    while count > 0 and (table := next(tables, None)) is not None:
        count -= len(table)
        yield table
