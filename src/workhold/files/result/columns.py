"""Large results in columns: an archive (:mod:`workhold.archive`) of one array for each kind of number.

Its text ``result.json`` is the head of the JSON form (:mod:`workhold.files.result.writer`). The numbers are
those of that form, rounded as there, so that a result can go from one form to the other and back without a
change. Places of pegs follow from their holes and are not written. Opening such a file reads the head and the
types; fixtures are read, and checked, when they are accessed.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path
from threading import Event
from typing import Any

import numpy as np
from attrs import define, evolve, field, frozen
from numpy.typing import NDArray

from workhold.archive import ArchiveWriter, map_archive, release_mapped_pages
from workhold.errors import InputError
from workhold.files.atomic import explain_system_errors, write_binary_file
from workhold.files.replacing import refuse_other_ending, refuse_output
from workhold.files.result.bending_forms import add_bendings, check_bending, read_head_bendings
from workhold.files.result.fixture_forms import add_seatings, check_seating, read_head_seatings
from workhold.files.result.fixture_text import round_table_for_file, round_to_twelve_digits
from workhold.files.result.parts import (
    HEAD,
    PINS_KNOWN,
    check_head,
    check_query,
    describe_columns,
    describe_columns_from_head,
    make_result_from_counts,
    parse_head,
    refuse_faulty,
    refuse_unknown_types,
)
from workhold.files.result.writer import FORMAT, make_head, write_head_json
from workhold.model.fixture_table import FixtureTable
from workhold.model.quality import BEFORE_PINS, FIGURES
from workhold.model.query import Query
from workhold.model.result import Result

__all__ = ["ColumnsSink", "MappedTable", "answer_to_file", "read_columns", "write_columns"]

# Fixtures rounded and written together.
BLOCK = 1 << 15


@frozen
class ColumnsSink:
    """A sink that writes a result in columns as its fixtures come; an earlier file is replaced only after
    success.
    """

    path: Path

    @property
    def folder(self) -> Path:
        """The folder of the file, where the sorting has its temporary files as well."""
        return self.path.resolve().parent

    def receive(self, result: Result, listed: int, tables: Iterable[FixtureTable]) -> None:
        """Write a result and its fixtures.

        There are at most ``listed`` fixtures, and fewer if the user stops the search.
        """
        counts = Counter[str]()
        bends = result.query.knows_heights
        figures = len(FIGURES) if bends else BEFORE_PINS
        columns = describe_columns(result.toolkit.travel_count, result.query.program is not None, figures)
        with write_binary_file(self.path) as stream:
            archive = ArchiveWriter(stream, columns, listed)
            for table in tables:
                counts.update(result.toolkit.count_arrangements(table.arrangement))
                table = table.with_figure_columns(columns["quality"].shape[0])
                for start in range(0, len(table), BLOCK):
                    archive.append_rows(round_columns_for_file(table.take(slice(start, start + BLOCK))))
            if archive.done < listed:
                result = result.mark_cut_short(archive.done)
            text = make_head(result, with_pieces=False)
            if bends:
                text[PINS_KNOWN] = True
            text["counts"] = {name: counts[name] for name in result.toolkit.types}
            if result.query.seating is not None:
                text["seatings"] = [one.to_fields() for one in result.seating]
            if result.bending:
                text["bendings"] = [
                    {"fixture": row + 1, "bending": one.to_data()} for row, one in result.bending.items()
                ]
            parts = write_head_json(text, result.query.program, ", ", is_ascii=False)
            archive.close(HEAD, "".join(parts) + "}", FORMAT)


def refuse_holds(query: Query, path: str | Path) -> None:
    """Raise InputError for a query whose toolkit holds by friction: columns have room for pegs only."""
    if isinstance(query, Query) and query.toolkit.holds_by_friction:
        has = "straps as well" if query.toolkit.strap_set is not None else "none"
        raise InputError(
            f"{path}: a file in columns is of pegs, and a {query.toolkit.noun} has {has}: let the name end in .json or .csv."
        )


def write_columns(result: Result, path: str | Path) -> None:
    """Write a result file in columns; an earlier file of that name is replaced only after success."""
    refuse_holds(result.query, path)
    ColumnsSink(Path(path)).receive(result, len(result), [result.table])


def answer_to_file(
    query: Query,
    path: str | Path,
    *,
    overwrite: bool = False,
    threads: int | None = None,
    progress: Callable[[float, int], None] | None = None,
    cancel: Event | None = None,
    preview: Callable[[Result], None] | None = None,
) -> Result:
    """Find every fixture that a query asks for, however many, and write them in columns.

    No more than some 100 MB of fixtures are in memory at a time. Fixtures that are being sorted are kept
    beside the file, in files without a name, and take up to twice its size.

    Parameters
    ----------
    query : what to search for.
    path : of the file, whose name ends in .npz.
    overwrite : whether a file that workhold has not written may be replaced.
    threads, progress, cancel, preview : as :func:`workhold.answer` takes them.

    Returns
    -------
    Result
        Read from the file: fixtures are read when they are accessed.

    Raises
    ------
    InputError
        In the cases of ``workhold.answer``, and when the file cannot be written or replaced, or the disk is
        full.
    """
    from workhold.search.design import answer

    path = Path(path)
    refuse_holds(query, path)
    refuse_other_ending(path, [".npz"], "a result file in columns")
    refuse_output(path, force=overwrite)
    with explain_system_errors(path):
        answer(
            query,
            sink=ColumnsSink(path),
            threads=threads,
            progress=progress,
            cancel=cancel,
            preview=preview,
        )
    return read_columns(path)


def round_columns_for_file(table: FixtureTable) -> tuple[NDArray[Any], ...]:
    """Return the columns of a table in the order of
    :func:`describe_columns`, rounded as the JSON form writes them.
    """
    _, read = round_table_for_file(table)
    *columns, pairs = evolve(
        read, force=round_to_twelve_digits(table.force), quality=round_to_twelve_digits(table.quality)
    ).columns
    return (*columns, pairs) if table.force.ndim == 3 else tuple(columns)


@define(frozen=True, eq=False)
class MappedTable(FixtureTable):
    """The fixtures of a file in columns; those that :meth:`take` returns are checked.

    Parameters
    ----------
    query : the query that the fixtures answer.
    path : of the file.
    """

    query: Query = field(kw_only=True)
    path: Path = field(kw_only=True)

    def take(self, order: NDArray[Any] | slice) -> FixtureTable:
        """Return the fixtures at some rows; raise InputError if one is faulty.

        Parts of the file read for earlier calls leave the memory, so that a large file read in blocks takes
        little of it.
        """
        release_mapped_pages(self.arrangement)
        table = super().take(order)
        places = range(len(self))[order] if isinstance(order, slice) else np.arange(len(self))[order]
        refuse_faulty(table, self.query, self.path, places)
        return table


def read_columns(path: Path) -> Result:
    """Return the result of a file in columns; only the head and the fixtures' types are read at once.

    Raises InputError for a file that is not a result file, or contradicts itself.
    """
    text, columns = map_archive(path, describe_columns_from_head, HEAD)
    try:
        data = parse_head(text)
    except InputError as error:
        raise InputError(f"{path} is not a result file: {error}") from error
    head = check_head(data, path)
    query = check_query(head, path)
    refuse_unknown_types(columns["arrangement"], query.toolkit, path)
    result = make_result_from_counts(MappedTable(**columns, query=query, path=path), head, query, path)
    seatings = read_head_seatings(data, path)
    if len(seatings) > len(result):
        raise InputError(
            f"{path}: the seating of {len(seatings)} fixtures is stated, but {len(result)} are listed."
        )
    # The pose decides which of the seats is the fixture's own.
    poses = [result[place].pose for place in range(len(seatings))]
    seating = [
        check_seating(one, pose, path, k)
        for k, (one, pose) in enumerate(zip(seatings, poses, strict=True), 1)
    ]
    bendings = read_head_bendings(data, path, len(result))
    bending = {row: check_bending(one, path, row + 1) for row, one in bendings.items()}
    return add_bendings(add_seatings(result, seating, path), bending, head.bent_by, path)
