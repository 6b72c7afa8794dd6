"""An external sort of rows too many for memory: runs are sorted, kept on disk, and merged part by part.

Reference: D. E. Knuth, *The Art of Computer Programming* 3 (1998), section 5.4; runs are cut at the same keys
instead of being merged row by row, because array operations are faster.

Glossary
--------
key : a byte string for each row; rows are ordered by comparing their keys. Rows with equal keys stay in the
    order in which they were added.
run : rows in the order of their keys.
part : all rows of all runs whose keys lie between two given keys.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, Future, wait
from functools import partial
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryFile
from threading import Lock
from typing import IO, Any, TypeVar

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

__all__ = ["Columns", "ExternalSort", "SortedRun", "map_in_order", "make_keys"]

Keys = NDArray[np.bytes_]
Columns = tuple[NDArray[Any], ...]
One = TypeVar("One")
Other = TypeVar("Other")

# Number of rows in a part, of rows in memory that go to the disk together, and of rows from one remembered
# key to the next.
PART, ROOM, STRIDE = 1 << 15, 1 << 18, 1 << 9
SIGN = np.uint64(1 << 63)
# The largest number of 64 bits.
MOST = (1 << 64) - 1


def make_keys(*numbers: NDArray[Any]) -> Keys:
    """Return byte strings (N,) that sort as the tuples (numbers[0][k], numbers[1][k], …) do.

    Each argument is (N,): integers from 0 up, or floats, of which NaN comes last.
    """
    words = np.empty((len(numbers[0]), len(numbers)), ">u8")
    for k, values in enumerate(numbers):
        if values.dtype.kind == "f":
            # The bits of a float, as an integer, are in its order, except for the sign (J. Herf, "Radix
            # tricks", 2001).
            bits = np.where(np.isnan(values), np.nan, values + 0.0).view(np.uint64)
            words[:, k] = np.where(bits & SIGN, ~bits, bits | SIGN)
        else:
            words[:, k] = values
    return words.view(f"S{8 * len(numbers)}")[:, 0]


def sort_keys(keys: Keys) -> NDArray[np.intp]:
    """Return the indices (N,) that sort keys; equal keys keep their order.

    For speed the words of the keys are combined into one integer, each word as its distance from the least
    word or, if that takes too many bits, as its rank; the index is in the lowest bits.
    """
    count = max(len(keys), 1)
    number, size = np.zeros(len(keys), np.uint64), 1
    for column in keys.view(">u8").reshape(len(keys), -1).T if len(keys) else ():
        word, span = compress_numbers(column.astype(np.uint64), MOST // (size * count))
        if size * span * count > MOST:
            number, size = rank_numbers(number)
        if size * span * count > MOST:
            return np.argsort(keys, kind="stable")
        number, size = number * np.uint64(span) + word, size * span
    ordered = np.sort(number * np.uint64(count) + np.arange(len(keys), dtype=np.uint64))
    return np.asarray(ordered % np.uint64(count)).astype(np.intp)


def compress_numbers(word: NDArray[np.uint64], most: int) -> tuple[NDArray[np.uint64], int]:
    """Return (1) integers from 0 up in the same order as ``word``, (N,), and (2) a number above all of them.

    The integers are distances from the least word if these are below ``most``, else ranks.
    """
    least = int(word.min())
    span = int(word.max()) - least + 1
    return (word - np.uint64(least), span) if span <= most else rank_numbers(word)


def rank_numbers(word: NDArray[np.uint64]) -> tuple[NDArray[np.uint64], int]:
    """Return (1) the ranks of numbers, (N,), from 0 without gaps,
    and (2) how many distinct numbers there are.
    """
    values, ranks = np.unique(word, return_inverse=True)
    return ranks.astype(np.uint64), len(values)


@frozen(eq=False)
class SortedRun:
    """Rows in memory in the order of their keys.

    Parameters
    ----------
    keys : (N,) ascending.
    columns : arrays of N rows each.
    """

    keys: Keys
    columns: Columns

    @classmethod
    def from_columns(cls, keys: Keys, columns: Columns) -> SortedRun:
        """Return a run of rows, sorted by their keys; rows of equal keys keep their order."""
        order = sort_keys(keys)
        return cls(keys.take(order), tuple(column.take(order, axis=0) for column in columns))

    @classmethod
    def merge_runs(cls, runs: Sequence[SortedRun]) -> SortedRun:
        """Return one run with the rows of several runs; there must be at least one."""
        if len(runs) == 1:
            return runs[0]
        columns = zip(*(run.columns for run in runs), strict=True)
        return cls.from_columns(
            np.concatenate([run.keys for run in runs]), tuple(map(np.concatenate, columns))
        )

    def __len__(self) -> int:
        return len(self.keys)

    @property
    def some_keys(self) -> Keys:
        """Every ``STRIDE``-th key from the first on."""
        return self.keys[::STRIDE]

    def count_before(self, key: Keys) -> int:
        """Return the number of rows with keys smaller than ``key`` (1,)."""
        return int(np.searchsorted(self.keys, key)[0])

    def read_rows(self, first: int, end: int) -> SortedRun:
        """Return the rows ``first`` to ``end - 1`` as a run."""
        return SortedRun(self.keys[first:end], tuple(column[first:end] for column in self.columns))


@define(eq=False)
class ScratchFile:
    """A temporary file that any thread may append to or read; it vanishes when the program ends.

    Parameters
    ----------
    folder : folder in which the file is created.
    """

    folder: Path
    file: IO[bytes] = field(init=False)
    lock: Lock = field(factory=Lock, init=False)

    def __attrs_post_init__(self) -> None:
        self.file = TemporaryFile(dir=self.folder, buffering=0)  # noqa: SIM115

    def write(self, array: NDArray[Any]) -> int:
        """Append the bytes of an array; return the offset in bytes at which they begin."""
        content = np.ascontiguousarray(array).reshape(-1).view(np.uint8).data
        with self.lock:
            place = self.file.seek(0, os.SEEK_END)
            while content:
                content = content[self.file.write(content) :]
        return place

    def read(self, place: int, size: int) -> bytes:
        """Return ``size`` bytes from the offset ``place``."""
        with self.lock:
            self.file.seek(place)
            return self.file.read(size)


@frozen(eq=False)
class StoredRun:
    """Rows on disk in the order of their keys: arrays one after the other in a file, keys first.

    Parameters
    ----------
    places : offset in bytes of each array.
    forms : dtype and shape of a row of each array.
    count : number of rows.
    some_keys : every ``STRIDE``-th key, kept in memory.
    """

    scratch: ScratchFile
    places: tuple[int, ...]
    forms: tuple[tuple[np.dtype[Any], tuple[int, ...]], ...]
    count: int
    some_keys: Keys

    @classmethod
    def from_run(cls, run: SortedRun, scratch: ScratchFile) -> StoredRun:
        """Write a run to a scratch file, and return the stored run."""
        arrays = (run.keys, *run.columns)
        places = tuple(scratch.write(array) for array in arrays)
        forms = tuple((array.dtype, array.shape[1:]) for array in arrays)
        return cls(scratch, places, forms, len(run), run.some_keys.copy())

    def __len__(self) -> int:
        return self.count

    def read_array(self, number: int, first: int, end: int) -> NDArray[Any]:
        """Return the rows ``first`` to ``end - 1`` of one array; ``number`` 0 is the array of keys."""
        form, shape = self.forms[number]
        size = form.itemsize * int(np.prod(shape, dtype=np.int64))
        content = self.scratch.read(self.places[number] + first * size, (end - first) * size)
        return np.frombuffer(content, form).reshape(end - first, *shape)

    def count_before(self, key: Keys) -> int:
        """Return the number of rows with keys smaller than ``key`` (1,)."""
        first = STRIDE * max(int(np.searchsorted(self.some_keys, key)[0]) - 1, 0)
        return first + int(
            np.searchsorted(self.read_array(0, first, min(first + STRIDE, self.count)), key)[0]
        )

    def read_rows(self, first: int, end: int) -> SortedRun:
        """Return the rows ``first`` to ``end - 1``, read into memory, as a run."""
        keys, *columns = (self.read_array(number, first, end) for number in range(len(self.forms)))
        return SortedRun(keys, tuple(columns))


@define(eq=False)
class ExternalSort:
    """Rows that are added in sorted runs and read in the order of their keys.

    Parameters
    ----------
    folder : folder for the temporary file; None to keep all in memory.
    """

    folder: Path | None = None
    runs: list[SortedRun | StoredRun] = field(factory=list, init=False)
    fresh: list[SortedRun] = field(factory=list, init=False)
    scratch: ScratchFile | None = field(default=None, init=False)

    def __len__(self) -> int:
        return sum(map(len, self.runs)) + sum(map(len, self.fresh))

    def add_run(self, run: SortedRun) -> None:
        """Add a sorted run; where there is a folder, runs are written to disk once enough are in memory.

        Raises
        ------
        OSError
            When the disk is full.
        """
        self.fresh.append(run)
        if self.folder is not None and sum(map(len, self.fresh)) >= ROOM:
            self.scratch = self.scratch or ScratchFile(self.folder)
            self.runs.append(StoredRun.from_run(SortedRun.merge_runs(self.fresh), self.scratch))
            self.fresh = []

    def list_parts(self) -> list[Callable[[], SortedRun]]:
        """Return functions that each read one part; the parts, one after
        the other, are all rows in order of key.

        Rows of equal keys are in the same part. At least one run must have been added.
        """
        runs = [*self.runs, *self.fresh]
        keys = np.sort(np.concatenate([run.some_keys for run in runs]))
        pivots = np.unique(keys[PART // STRIDE :: PART // STRIDE])
        places = [[run.count_before(pivots[k : k + 1]) for run in runs] for k in range(len(pivots))]
        edges = [[0] * len(runs), *places, [len(run) for run in runs]]
        return [self.make_part(runs, first, end) for first, end in pairwise(edges)]

    def iterate_runs(self) -> Iterator[Callable[[], SortedRun]]:
        """Yield, for each run, a function that reads all its rows; the runs are removed from this object."""
        while self.runs or self.fresh:
            run = (self.runs or self.fresh).pop(0)
            yield partial(run.read_rows, 0, len(run))

    def make_part(
        self, runs: Sequence[SortedRun | StoredRun], first: list[int], end: list[int]
    ) -> Callable[[], SortedRun]:
        """Return a function that merges the rows ``first[k]`` to ``end[k] - 1`` of every run k."""
        return lambda: SortedRun.merge_runs(
            [run.read_rows(low, high) for run, low, high in zip(runs, first, end, strict=True)]
        )

    def close(self) -> None:
        """Drop all rows, and delete the temporary file."""
        self.runs, self.fresh = [], []
        if self.scratch is not None:
            self.scratch.file.close()


def map_in_order(
    pool: Executor, ahead: int, work: Callable[[One], Other], items: Iterable[One]
) -> Iterator[Other]:
    """Yield ``work(item)`` for each item, in the order of the items, computed on the pool.

    Apart from the item that is awaited, at most ``ahead`` items are begun and not yet yielded. If the caller
    ends the iteration early, it waits until running work has finished.
    """
    running: deque[Future[Other]] = deque()
    try:
        for item in items:
            running.append(pool.submit(work, item))
            if len(running) > ahead:
                yield running.popleft().result()
        while running:
            yield running.popleft().result()
    finally:
        # Pending work is dropped; its files must stay until running work is over.
        for future in running:
            future.cancel()
        wait(running)
