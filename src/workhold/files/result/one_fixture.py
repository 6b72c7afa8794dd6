"""Reading of one fixture of a result file, without the others.

In a file with one fixture on every line the other lines are counted and skipped. If data of other fixtures
are needed later, the file is read again: only the text of its lines to count fixtures in the same holes,
otherwise the whole file as usual. A file in columns, or of another layout, is read as a whole.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
from attrs import evolve, fields, frozen
from numpy.typing import NDArray

from workhold.archive import is_archive
from workhold.errors import InputError
from workhold.files.result.fixture_forms import add_seatings
from workhold.files.result.hold_text import is_friction_fixture
from workhold.files.result.parts import (
    OtherLayoutError,
    check_head,
    check_query,
    explain_reading_errors,
    make_result,
    parse_fixture_text,
    read_lines,
    split_fixture_texts,
    start_of_fixtures,
)
from workhold.files.result.reader import add_missing_figures, check_table, collect_columns, read_result
from workhold.model.fixture_table import FixtureTable
from workhold.model.result import Result

__all__ = ["read_one"]

SEATED = b'"seating"'
# What says in the line of a fixture of which type it is and where its pegs stand.
STANDING = re.compile(rb'"(type|directions?|jaw|role|hole|column|row)"\s*:\s*("[^"]*"|-?\d+|null|\[[^\]]*\])')


@frozen
class OneFixtureRead:
    """The texts read from a file for one fixture.

    Parameters
    ----------
    texts : the text of the fixture asked for, at the end. If it and all before it have their seating in the
        file, the texts of those before it come first.
    first : index of the first of ``texts`` in the file, from 0.
    count : number of fixtures in the file.
    """

    texts: list[bytes]
    first: int
    count: int


def read_one(path: str | Path, rank: int) -> Result:
    """Return the result in a file, of which only the fixture of a rank (from 1) is
    read; other fixtures are read when they are accessed.

    Raises
    ------
    InputError
        When the file cannot be read, is not a result file, lists fewer fixtures, or contradicts itself.
    """
    path = Path(path)
    try:
        if not path.is_file():
            raise OtherLayoutError
        with explain_reading_errors(path):
            if is_archive(path):
                raise OtherLayoutError
            data, found = read_lines(path, partial(pick_fixture, rank=rank))
            if found.texts and is_friction_fixture(parse_fixture_text(found.texts[-1])):
                raise OtherLayoutError
            columns = collect_columns(map(parse_fixture_text, found.texts), path, found.first)
    except OtherLayoutError:
        result = read_result(path)
        refuse_missing(path, rank, len(result))
        return result
    head = check_head(data, path)
    query, said = check_query(head, path), sum(head.counts.values())
    if said != found.count:
        raise InputError(f"{path}: counts say {said} fixtures, but {found.count} are listed.")
    refuse_missing(path, rank, found.count)
    rows = add_missing_figures(check_table(columns, query, path, found.first), query)
    result = add_seatings(
        make_result(TableOfFile(rows, found, path), head, query, path), columns.seating, path
    )
    return evolve(result, bending=columns.bending, bent_by=head.bent_by)


def refuse_missing(path: Path, rank: int, count: int) -> None:
    """Raise InputError for a rank above the number of fixtures."""
    if rank > count:
        raise InputError(f"{path} lists {count} fixtures: there is no fixture {rank}.")


def pick_fixture(texts: Iterable[bytes], path: Path, rank: int) -> OneFixtureRead:
    """Return the text of the fixture of a rank (from 1), with the texts that have
    to be read before it, and the number of all texts.
    """
    chosen: list[bytes] = []
    number = 0
    for number, text in enumerate(texts, 1):
        if number <= rank:
            # Seating is stated of the first fixtures, or of none.
            if SEATED not in text:
                chosen = []
            if number == rank or SEATED in text:
                chosen.append(text)
    return OneFixtureRead(chosen, min(rank, number) - len(chosen), number)


class TableOfFile(FixtureTable):
    """A table of all fixtures of a file, of which some are read at first. All others are read when one of
    them is accessed.

    Parameters
    ----------
    read : table of the fixtures that are read.
    found : texts of the fixtures that are read, with their place in the file.
    path : of the file.
    """

    read: FixtureTable
    found: OneFixtureRead
    path: Path

    def __init__(self, read: FixtureTable, found: OneFixtureRead, path: Path) -> None:
        vars(self).update(read=read, found=found, path=path)

    def __len__(self) -> int:
        return self.found.count

    @cached_property
    def whole(self) -> FixtureTable:
        """All fixtures, read as usual at the first access."""
        return read_result(self.path).table

    def __getattr__(self, name: str) -> Any:
        """Return a column of the whole table."""
        if name in {column.name for column in fields(FixtureTable)}:
            return getattr(self.whole, name)
        raise AttributeError(name)

    def take(self, order: NDArray[Any] | slice) -> FixtureTable:
        """Return the fixtures at some rows; the file is read only if some
        of these fixtures are not read yet.
        """
        places = np.arange(len(self))[order] - self.found.first
        is_read = len(places) > 0 and places.min() >= 0 and places.max() < len(self.read)
        return self.read.take(places) if is_read else self.whole.take(order)

    def count_in_same_holes(self, index: int) -> int:
        """Return how many other fixtures have their pegs in the same holes as the fixture at ``index``, which
        must be read already.
        """
        here = STANDING.findall(self.found.texts[index - self.found.first])
        with explain_reading_errors(self.path), self.path.open("rb") as stream:
            stream.seek(start_of_fixtures(stream))
            return (
                sum(STANDING.findall(text) == here for text in split_fixture_texts(stream, [], self.path)) - 1
            )
