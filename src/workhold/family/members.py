"""A member of a family: a part with the patterns that hold it, each with the best fixture that has it."""

from __future__ import annotations

from collections.abc import Sequence
from tempfile import TemporaryFile
from typing import Any

import numpy as np
from attrs import fields, frozen
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import ANGLE_SLACK
from workhold.errors import InputError
from workhold.family.holding import turned
from workhold.family.losses import Threshold, losses, may_be_used
from workhold.family.patterns import half_turn, pattern_words, zero_words
from workhold.listing.canonical_form import changes
from workhold.listing.ranking import measured
from workhold.model.part_zero import PartZero, part_zero
from workhold.model.quality import FIGURES, figure_number
from workhold.model.query import Query
from workhold.model.result import FixtureTable, Result

__all__ = ["Member", "member_of"]

IntArray = NDArray[np.int64]

# Bytes of fixtures of one member that are kept in memory; more of them are kept in a file without a name.
IN_MEMORY = 1 << 24


@frozen(eq=False)
class Member:
    """A part of a family.

    Parameters
    ----------
    name : what it is called among the others.
    path : its file, "" where there is none.
    digest : SHA-256 of that file in hexadecimal, "" where there is none.
    query : what was asked for it.
    zero : its zero, X0 Y0.
    fixtures : how many fixtures it has.
    patterns : how many patterns hold it, one and its half turn counted once.
    best : the best value of the figure that losses are told of; NaN where it has no fixture.
    words : (P, W) the patterns that hold it, in lexicographic order.
    loss : (P,) of each pattern.
    number : (P,) place of the best fixture with each pattern in the list of all fixtures, from 0.
    turned : (P,) whether these are after half a turn of everything.
    table : these P fixtures as they stand in their patterns: as listed, or after half a turn of everything.
    """

    name: str
    path: str
    digest: str
    query: Query
    zero: PartZero
    fixtures: int
    patterns: int
    best: float
    words: IntArray
    loss: NDArray[np.float64]
    number: IntArray
    turned: NDArray[np.bool_]
    table: FixtureTable


def member_of(
    name: str,
    result: Result,
    thresholds: Sequence[Threshold] = (),
    unfit: bool = False,
    path: str = "",
    digest: str = "",
    zero: PartZero | None = None,
    same_zero: bool = False,
) -> Member:
    """The member that a part is, from all its fixtures.

    Parameters
    ----------
    result : all fixtures, ranked; the first figure of its ranking is that of losses.
    thresholds, unfit : what may be used, see ``family.losses.may_be_used``.
    zero : the part's zero; the usual one if None.
    same_zero : whether patterns are told apart by where the zero lies as well, and how the part is turned.

    Raises
    ------
    InputError
        When there is no room for the fixtures.
    """
    query = result.query
    figure = FIGURES[figure_number(query.ranking[0]) or 0]
    table, number = with_half_turns(result.table, query)
    values = table.quality[:, FIGURES.index(figure)]
    good = may_be_used(table, (), query.tolerance, unfit)
    loss = np.full(len(table), np.inf)
    loss[good] = losses(values[good], figure)
    best = float(values[good][np.argmin(loss[good])]) if good.any() else float("nan")
    used = np.flatnonzero(good & may_be_used(table, thresholds, query.tolerance, unfit))
    words, cost, turn = pattern_words(table.take(used), query.toolkit), loss[used], used >= len(result)
    count = distinct_patterns(words, number[used], turn)
    zero = part_zero(query.workpiece) if zero is None else zero
    if same_zero:
        words = np.concatenate([words, zero_words(table.take(used), query.toolkit, zero)], axis=1)
    # Rows are ranked, and sorting keeps that order: of equal losses the first is the best.
    order = np.lexsort([cost, *words.T[::-1]])
    first = order[changes(list(words[order].T))]
    kept = spilled(table.take(used[first]))
    chosen = words[first], cost[first], number[used[first]], turn[first], kept
    return Member(name, path, digest, query, zero, len(result), count, best, *chosen)


def distinct_patterns(words: IntArray, number: IntArray, turn: NDArray[np.bool_]) -> int:
    """How many patterns (N, W) there are when one and its half turn count once; ``number`` (N,) tells the fixtures, and
    ``turn`` (N,) which are after the half turn."""
    ahead = np.full((int(number.max(initial=-1)) + 1, words.shape[1]), np.iinfo(np.int64).max)
    # What comes first is the smaller of the two of each fixture, whatever the order in which they are given.
    for some in (~turn, turn):
        one, other = words[some], ahead[number[some]]
        differs = one != other
        place, rows = differs.argmax(axis=1), np.arange(len(one))
        ahead[number[some]] = np.where((one[rows, place] < other[rows, place])[:, None], one, other)
    used = ahead[np.unique(number)]
    order = np.lexsort(used.T[::-1])
    return int(changes(list(used[order].T)).sum())


def with_half_turns(table: FixtureTable, query: Query) -> tuple[FixtureTable, IntArray]:
    """Fixtures, and after them those that half a turn of everything makes of them where their arrangement stays as it is and
    nothing forbids it: a range of angles, or holes that are blocked; and the place (N,) of each in the list."""
    toolkit = query.toolkit
    tables, numbers = [table], [np.arange(len(table))]
    blocked = any(plate.blocked for plate in toolkit.plates)
    for arrangement in range(len(toolkit.arrangements)):
        places = half_turn(toolkit, arrangement)
        if blocked or places is None:
            continue
        kind = table.arrangement == arrangement
        number = np.flatnonzero(kind & at_angle(np.degrees(table.theta) + 180.0, query))
        if len(number):
            after = turned(table.take(number), toolkit)
            # Where another jaw stands still the location error changes; the locators of a plate stay what they are.
            tables.append(after if places[0] == 0 else measured(after, Problem.of(query)))
            numbers.append(number)
    return FixtureTable.joined(tables), np.concatenate(numbers)


def at_angle(degrees: NDArray[np.float64], query: Query) -> NDArray[np.bool_]:
    """Which orientations (N,) in degrees lie in one of the ranges allowed, which are all where none is given."""
    inside = np.full(len(degrees), not query.restrictions.angles)
    for low, high in query.restrictions.angles:
        inside |= (degrees - low + ANGLE_SLACK) % 360.0 <= high - low + 2 * ANGLE_SLACK
    return inside


def spilled(table: FixtureTable) -> FixtureTable:
    """A table that takes little memory, however long it is.

    Raises
    ------
    InputError
        When there is no room on the disk for temporary files.
    """
    if sum(column.nbytes for column in table.columns) < IN_MEMORY:
        return table
    names = [one.name for one in fields(FixtureTable)]
    kinds: list[tuple[Any, ...]] = [
        (name, column.dtype, column.shape[1:]) for name, column in zip(names, table.columns, strict=True)
    ]
    rows = np.empty(len(table), np.dtype(kinds))
    for name, column in zip(names, table.columns, strict=True):
        rows[name] = column
    try:
        with TemporaryFile() as stream:
            rows.tofile(stream)
            stream.flush()
            mapped = np.memmap(stream, rows.dtype, "r", shape=rows.shape)
    except OSError as error:
        raise InputError(f"there is no room for temporary files: {error.strerror or error}.") from error
    return FixtureTable(*(mapped[name] for name in names))
