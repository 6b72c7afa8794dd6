"""The complete lists of sets: made by a search, written with all that a copy of the benchmark needs, and
compared.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from threading import Event
from typing import Any

from attrs import frozen

from workhold.benchmark.catalogue import (
    COMMON,
    SetEntry,
    compute_checksums,
    find_set,
    format_set_text,
    make_set_query,
    make_set_text,
    read_benchmark_file,
)
from workhold.benchmark.matching import (
    Comparison,
    ListedPlaces,
    Submission,
    compare_places,
    read_entered_fixture,
)
from workhold.errors import InputError
from workhold.files.atomic import write_binary_file, write_bytes
from workhold.search.design import answer

__all__ = [
    "LARGE",
    "MadeSet",
    "compare_entry",
    "load_arrow",
    "make_list",
    "make_and_write_sets",
    "write_common",
]

# Fixtures from which on a set is written as Parquet where that is asked for.
LARGE = 5000


@frozen
class MadeSet:
    """A set whose list was made.

    Parameters
    ----------
    entry : its entry in the manifest.
    path : its file.
    counts : number of its fixtures by type.
    differs : which of the checksums "fixtures", "holes" and "file" are not those of the manifest.
    """

    entry: SetEntry
    path: Path
    counts: Mapping[str, int]
    differs: tuple[str, ...]

    @property
    def size(self) -> int:
        """The number of fixtures found."""
        return sum(self.counts.values())

    @property
    def is_same(self) -> bool:
        """Whether the list is the one of the manifest; numbers may differ by rounding."""
        return "holes" not in self.differs


def make_list(
    entry: SetEntry, threads: int | None = None, cancel: Event | None = None
) -> tuple[dict[str, Any], list[str]] | None:
    """Return (head, lines) of a set's file, made by a search; None if that was cancelled.

    Parameters
    ----------
    threads : number of threads; None for the default.
    cancel : when set, the search ends.
    """
    result = answer(make_set_query(entry), threads=threads, cancel=cancel)
    return make_set_text(entry.name, result) if result.complete else None


def make_and_write_sets(
    chosen: Sequence[SetEntry],
    folder: Path,
    *,
    parquet: bool = False,
    threads: int | None = None,
    progress: Callable[[float, int], None] | None = None,
    cancel: Event | None = None,
) -> Iterator[MadeSet]:
    """Make sets one after the other, write each into a folder, and yield it.

    Once ``cancel`` is set, no further set is yielded.

    Parameters
    ----------
    parquet : whether large sets are written as Parquet instead of JSON; needs pyarrow.
    threads : number of threads of each search; None for the default.
    progress : called with the share of the sets that are done and the number of fixtures in these.
    cancel : when set, the running search ends.
    """
    total, fixtures, done = sum(one.size + 200 for one in chosen), 0, 0
    for entry in chosen:
        made = make_list(entry, threads, cancel)
        if made is None:
            return
        head, lines = made
        sums = compute_checksums(head, lines)
        large = parquet and len(lines) >= LARGE
        path = folder / f"{entry.name}.{'parquet' if large else 'json'}"
        if large:
            write_parquet(path, head, lines)
        else:
            write_bytes(path, format_set_text(head, lines).encode("utf-8"))
        fixtures, done = fixtures + len(lines), done + entry.size + 200
        if progress is not None:
            progress(done / total, fixtures)
        differs = tuple(name for name, value in sums.items() if entry.sums.get(name) != value)
        yield MadeSet(entry, path, head["counts"], differs)


def write_common(chosen: Sequence[SetEntry], folder: Path) -> None:
    """Write into a folder what all sets need: manifest, checker and schemas; also the workpieces of the
    chosen sets.

    The folder is made if needed.
    """
    (folder / "parts").mkdir(parents=True, exist_ok=True)
    for name in (*COMMON, *(f"parts/{part}.json" for part in {one.part for one in chosen})):
        write_bytes(folder / name, read_benchmark_file(name))


def write_parquet(path: Path, head: Mapping[str, Any], lines: Sequence[str]) -> None:
    """Write a set as Parquet, with a row for each fixture and the head in the metadata of the schema."""
    arrow, tables = load_arrow()
    rows = [json.loads(line) for line in lines]
    table = arrow.Table.from_pylist(rows)
    table = table.replace_schema_metadata({"workhold-benchmark": json.dumps(head)})
    with write_binary_file(path) as stream:
        tables.write_table(table, stream, compression="zstd")


def load_arrow() -> tuple[Any, Any]:
    """Return the modules ``pyarrow`` and ``pyarrow.parquet``.

    Raises
    ------
    InputError
        Where it is not installed.
    """
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as error:
        raise InputError("Parquet needs pyarrow: pip install 'pyarrow>=18', or ask for JSON.") from error
    return pyarrow, pyarrow.parquet


def compare_entry(
    entry: Submission,
    tolerance: float,
    symmetric: bool,
    threads: int | None = None,
    cancel: Event | None = None,
) -> Comparison | None:
    """Return the comparison of another program's list with the complete list; None if cancelled.

    The complete list is made anew by a search. ``tolerance`` and ``symmetric`` are those of
    ``matching.compare_places``.

    Raises
    ------
    InputError
        When the list made here is not the one of the manifest.
    """
    known = find_set(entry.set_name)
    query = make_set_query(known)
    made = make_list(known, threads, cancel)
    if made is None:
        return None
    head, lines = made
    if compute_checksums(head, lines)["holes"] != known.sums["holes"]:
        raise InputError(
            f"the list of {known.name} made here differs from the one in the manifest: install "
            "workhold again."
        )
    complete = [read_entered_fixture(json.loads(line)) for line in lines]
    return compare_places(
        ListedPlaces(query.workpiece, complete),
        ListedPlaces(query.workpiece, entry.fixtures),
        tolerance,
        symmetric,
    )
