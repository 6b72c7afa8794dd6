"""The first fixtures of a list with their seating, ordered anew by it.

A search finds and ranks fixtures by figures that do without seating. The seating of the first of them, as
many as a query asks for, is worked out, each pattern of pegs once. Then they are ordered by the query's
ranking, in which the warnings of the seating count as those of quality do. Equal fixtures keep their order.
Those whose seating is not as asked are left out, and so are then all whose seating was not worked out.
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

__all__ = ["Sink", "refuse_unasked", "answer_with_seating"]

# The share of the work, as progress reports it, that is the search.
SEARCHED = 0.3


class Sink(Protocol):
    """A sink for results too large for memory.

    Attributes
    ----------
    folder : where there is room for what is being sorted.
    """

    @property
    def folder(self) -> Path: ...

    def receive(self, result: Result, listed: int, tables: Iterable[FixtureTable]) -> None:
        """Takes a result and its fixtures, best first, in tables one after the other.

        Parameters
        ----------
        listed : how many fixtures there are; fewer come when somebody cancels.
        """


@frozen
class SeatingWork:
    """A query whose seating is worked out, and how.

    Parameters
    ----------
    query : what is asked, with seating.
    threads : how many share the work.
    progress : called as ``progress(fraction done, fixtures)``.
    cancel : when set, no further pattern is begun.
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
    sink: Sink | None = None,
) -> Result:
    """Answers a query, and finds the seating of the first fixtures if it asks for that.

    Parameters
    ----------
    search : answers a query without seating, watched by ``progress`` and ``cancel``; if there is a sink here,
        a ``sink`` takes its fixtures.
    threads, progress, cancel : see ``search.design.answer``.
    sink : takes the fixtures; the result that is returned has none then.

    Raises
    ------
    InputError
        As :func:`refuse_unasked`, and what the search raises.
    """
    if query.seating is None:
        return search(query, progress=progress, cancel=cancel)
    refuse_unasked(query)
    by_hand, rest = is_put_in_by_hand(query), None
    if not by_hand:
        # A sink takes fixtures while the search still reports its end.
        whole = progress if sink is None or progress is None else rising(progress)
        progress, rest = make_stage_progress(whole, 0.0, SEARCHED), make_stage_progress(whole, SEARCHED, 1.0)
    work = SeatingWork(query, threads, rest, cancel)
    taker = {} if sink is None else {"sink": SeatedSink(sink, work)}
    result = search(query.without_seating, progress=progress, cancel=cancel, **taker)
    if by_hand:
        return explain_putting_in_by_hand(result, query)
    return seated(result, work) if sink is None else evolve(result, query=query)


def is_put_in_by_hand(query: Query) -> bool:
    """Whether the part is pushed against its locators by hand.

    So it is with two clamps, of which none brings it home.
    """
    return not query.toolkit.closes_at_once


def refuse_unasked(query: Query) -> None:
    """Refuses what cannot be asked of seating.

    Raises
    ------
    InputError
        As ``refuse_unseated``, but that with two clamps only figures of seating cannot be asked for.
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
    """The result of a query with seating for two clamps: the same fixtures, and how the part is put in."""
    notes = (*result.reasons, PushedByHand()) if sum(result.found.values()) else result.reasons
    return evolve(result, query=query, notes=notes)


def rising(progress: Progress) -> Progress:
    """A progress that never goes back."""
    highest = 0.0

    def report(fraction: float, found: int) -> None:
        nonlocal highest
        highest = max(highest, fraction)
        progress(highest, found)

    return report


def seated(result: Result, work: SeatingWork, listed: int | None = None) -> Result:
    """A result of a query without seating as that of the query with it.

    Parameters
    ----------
    listed : how many fixtures it lists, where it does not have all of them.
    """
    query, count = work.query, min(work.query.seating or 0, len(result))
    seatings = seatings_of(result.part(slice(0, count)), work)
    looked_at = np.flatnonzero([one is not None for one in seatings])
    known = [one for one in seatings if one is not None]
    order = order_of(result.table.take(looked_at), known, query, result.least_effective_error)
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
    """Whether a seating keeps the rules of a query."""
    catches = query.opening is None or seating.catches(query.opening)
    return catches and (seating.is_foolproof or not query.foolproof)


def order_of(
    table: FixtureTable, seatings: Sequence[Seating], query: Query, least_effective_error: float | None
) -> NDArray[np.intp]:
    """The order of fixtures with their seating, best first; equal ones as they are.

    Steps count from the least effective error in mm of all fixtures, with a seating or not.
    """
    further = [[one.figures[figure.key] for figure in SEATING_FIGURES] for one in seatings]
    seating = np.array(further).reshape(len(seatings), len(SEATING_FIGURES))
    # What there is of a program stays the last column.
    whole = fill_figure_rows(table.quality)
    quality = np.hstack([whole[:, : len(FIGURES)], seating, whole[:, len(FIGURES) :]])
    quality[:, WARNINGS] += [one.warning_count for one in seatings]
    effective = find_usual_errors(query)
    error = None if effective is None else effective.errors(table)
    keys = make_order_keys(quality, query, error, classify_angles(table.theta))
    return keys.order(
        None
        if least_effective_error is None
        else int(convert_to_billionths(np.array([least_effective_error]))[0])
    )


def seatings_of(result: Result, work: SeatingWork) -> list[Seating | None]:
    """The seatings of all fixtures of a result; None for fixtures that were left."""
    progress, count = work.progress, sum(result.found.values())
    # Loading it takes longer than many a search.
    from workhold.seating.solver import Solver

    made = Solver(result.workpiece, result.toolkit).as_many(
        result,
        threads=work.threads,
        progress=None if progress is None else lambda done: progress(done, count),
        cancel=work.cancel,
    )
    return [None if one is None else evolve(one, opening=work.query.opening) for one in made]


@frozen
class SeatedSink:
    """Hands over results with the seating of their first fixtures.

    Parameters
    ----------
    sink : takes them.
    work : how the seating is worked out.
    """

    sink: Sink
    work: SeatingWork

    @property
    def folder(self) -> Path:
        """Where there is room for what is being sorted."""
        return self.sink.folder

    def receive(self, result: Result, listed: int, tables: Iterable[FixtureTable]) -> None:
        """Takes a result and its fixtures, best first, in tables one after the other."""
        if is_put_in_by_hand(self.work.query):
            self.sink.receive(explain_putting_in_by_hand(result, self.work.query), listed, tables)
            return
        rest = iter(tables)
        held = list(taken(rest, self.work.query.seating or 0)) or [result.table]
        made = seated(evolve(result, table=FixtureTable.joined(held)), self.work, listed)
        further = () if self.work.query.has_seating_rules else rest
        count = len(made) + (0 if self.work.query.has_seating_rules else listed - sum(map(len, held)))
        self.sink.receive(made, count, chain([made.table], further))


def taken(tables: Iterator[FixtureTable], count: int) -> Iterator[FixtureTable]:
    """Tables, until they have so many fixtures or there are no more."""
    while count > 0 and (table := next(tables, None)) is not None:
        count -= len(table)
        yield table
