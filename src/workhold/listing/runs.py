"""Rows too many for memory, sorted by keys: runs that are sorted each, kept on the disk, and merged part by
part.

Reference: D. E. Knuth, *The Art of Computer Programming* 3 (1998), section 5.4; runs are cut at the same keys
instead of being merged row by row, which array operations do better.

Glossary
--------
key : bytes that compare as rows are to be ordered; rows of one key stay in the order in which they were
    added.
run : rows in the order of their keys.
part : the rows of all runs between two keys.
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

__all__ = ["Columns", "Runs", "SortedRun", "map_in_order", "make_keys"]

Keys = NDArray[np.bytes_]
Columns = tuple[NDArray[Any], ...]
One = TypeVar("One")
Other = TypeVar("Other")

# Rows merged at a time, rows in memory that go to the disk together, and rows between two keys that are
# remembered.
PART, ROOM, STRIDE = 1 << 15, 1 << 18, 1 << 9
SIGN = np.uint64(1 << 63)
# The largest number of 64 bits.
MOST = (1 << 64) - 1


def make_keys(*numbers: NDArray[Any]) -> Keys:
    """Return the keys (N,) by which rows are in the lexicographic order of numbers (N,) each: whole ones from
    0 upward, or floats, of which NaN comes last.
    """
    words = np.empty((len(numbers[0]), len(numbers)), ">u8")
    for k, values in enumerate(numbers):
        if values.dtype.kind == "f":
            # A float's bits are in its order but for the sign, as J. Herf writes, "Radix tricks" (2001).
            bits = np.where(np.isnan(values), np.nan, values + 0.0).view(np.uint64)
            words[:, k] = np.where(bits & SIGN, ~bits, bits | SIGN)
        else:
            words[:, k] = values
    return words.view(f"S{8 * len(numbers)}")[:, 0]


def order_of(keys: Keys) -> NDArray[np.intp]:
    """Return the order (N,) of keys, equal ones as they stand.

    Comparing bytes takes long. So the words that keys are made of become one number. Each counts by its
    distance from the least of its kind or, where that is too much for a number, by its rank. The number is
    sorted with the index behind it.
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
    """Return the numbers (N,) in the order of others, from 0 upward, and how many there may be: no more than
    ``most``, or as few as there are different ones.
    """
    least = int(word.min())
    span = int(word.max()) - least + 1
    return (word - np.uint64(least), span) if span <= most else rank_numbers(word)


def rank_numbers(word: NDArray[np.uint64]) -> tuple[NDArray[np.uint64], int]:
    """Return the ranks (N,) of numbers, equal ones alike, and how many there are."""
    values, ranks = np.unique(word, return_inverse=True)
    return ranks.astype(np.uint64), len(values)


@frozen(eq=False)
class SortedRun:
    """Rows in memory in the order of their keys."""

    keys: Keys
    columns: Columns

    @classmethod
    def from_columns(cls, keys: Keys, columns: Columns) -> SortedRun:
        order = order_of(keys)
        return cls(keys.take(order), tuple(column.take(order, axis=0) for column in columns))

    @classmethod
    def merge_runs(cls, runs: Sequence[SortedRun]) -> SortedRun:
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
        """The first key, and every so many-th after it."""
        return self.keys[::STRIDE]

    def place(self, key: Keys) -> int:
        """Return how many of its rows come before a key (1,)."""
        return int(np.searchsorted(self.keys, key)[0])

    def read_rows(self, first: int, end: int) -> SortedRun:
        return SortedRun(self.keys[first:end], tuple(column[first:end] for column in self.columns))


@define(eq=False)
class Scratch:
    """A file without a name that any thread may write to its end or read; it is gone when the program ends,
    however it does.

    Parameters
    ----------
    folder : in which it takes room.
    """

    folder: Path
    file: IO[bytes] = field(init=False)
    lock: Lock = field(factory=Lock, init=False)

    def __attrs_post_init__(self) -> None:
        self.file = TemporaryFile(dir=self.folder, buffering=0)  # noqa: SIM115

    def write(self, array: NDArray[Any]) -> int:
        """Write the bytes of an array; the place where they begin."""
        content = np.ascontiguousarray(array).reshape(-1).view(np.uint8).data
        with self.lock:
            place = self.file.seek(0, os.SEEK_END)
            while content:
                content = content[self.file.write(content) :]
        return place

    def read(self, place: int, size: int) -> bytes:
        with self.lock:
            self.file.seek(place)
            return self.file.read(size)


@frozen(eq=False)
class StoredRun:
    """Rows on the disk in the order of their keys: arrays one after the other in a file, keys first."""

    scratch: Scratch
    places: tuple[int, ...]
    forms: tuple[tuple[np.dtype[Any], tuple[int, ...]], ...]
    count: int
    some_keys: Keys

    @classmethod
    def from_run(cls, run: SortedRun, scratch: Scratch) -> StoredRun:
        arrays = (run.keys, *run.columns)
        places = tuple(scratch.write(array) for array in arrays)
        forms = tuple((array.dtype, array.shape[1:]) for array in arrays)
        return cls(scratch, places, forms, len(run), run.some_keys.copy())

    def __len__(self) -> int:
        return self.count

    def read_array(self, number: int, first: int, end: int) -> NDArray[Any]:
        form, shape = self.forms[number]
        size = form.itemsize * int(np.prod(shape, dtype=np.int64))
        content = self.scratch.read(self.places[number] + first * size, (end - first) * size)
        return np.frombuffer(content, form).reshape(end - first, *shape)

    def place(self, key: Keys) -> int:
        """Return how many of its rows come before a key (1,)."""
        first = STRIDE * max(int(np.searchsorted(self.some_keys, key)[0]) - 1, 0)
        return first + int(
            np.searchsorted(self.read_array(0, first, min(first + STRIDE, self.count)), key)[0]
        )

    def read_rows(self, first: int, end: int) -> SortedRun:
        keys, *columns = (self.read_array(number, first, end) for number in range(len(self.forms)))
        return SortedRun(keys, tuple(columns))


@define(eq=False)
class Runs:
    """Rows that are added in runs and taken out in the order of their keys.

    Parameters
    ----------
    folder : of the file that holds what does not stay in memory; None for memory alone.
    """

    folder: Path | None = None
    runs: list[SortedRun | StoredRun] = field(factory=list, init=False)
    fresh: list[SortedRun] = field(factory=list, init=False)
    scratch: Scratch | None = field(default=None, init=False)

    def __len__(self) -> int:
        return sum(map(len, self.runs)) + sum(map(len, self.fresh))

    def add(self, run: SortedRun) -> None:
        """Add rows.

        Raises
        ------
        OSError
            When the disk is full.
        """
        self.fresh.append(run)
        if self.folder is not None and sum(map(len, self.fresh)) >= ROOM:
            self.scratch = self.scratch or Scratch(self.folder)
            self.runs.append(StoredRun.from_run(SortedRun.merge_runs(self.fresh), self.scratch))
            self.fresh = []

    def list_parts(self) -> list[Callable[[], SortedRun]]:
        """Return what gives the rows of all runs in the order of their keys, part by part; rows of one key
        are in one part. At least one, where there is any run.
        """
        runs = [*self.runs, *self.fresh]
        keys = np.sort(np.concatenate([run.some_keys for run in runs]))
        pivots = np.unique(keys[PART // STRIDE :: PART // STRIDE])
        places = [[run.place(pivots[k : k + 1]) for run in runs] for k in range(len(pivots))]
        edges = [[0] * len(runs), *places, [len(run) for run in runs]]
        return [self.make_part(runs, first, end) for first, end in pairwise(edges)]

    def iterate_runs(self) -> Iterator[Callable[[], SortedRun]]:
        """Yield what gives the rows of each run by itself, which are forgotten here as they are asked for."""
        while self.runs or self.fresh:
            run = (self.runs or self.fresh).pop(0)
            yield partial(run.read_rows, 0, len(run))

    def make_part(
        self, runs: Sequence[SortedRun | StoredRun], first: list[int], end: list[int]
    ) -> Callable[[], SortedRun]:
        return lambda: SortedRun.merge_runs(
            [run.read_rows(low, high) for run, low, high in zip(runs, first, end, strict=True)]
        )

    def close(self) -> None:
        """Give back memory and disk."""
        self.runs, self.fresh = [], []
        if self.scratch is not None:
            self.scratch.file.close()


def map_in_order(
    pool: Executor, ahead: int, work: Callable[[One], Other], items: Iterable[One]
) -> Iterator[Other]:
    """Yield what work gives for each item, in the order of the items; at most ``ahead`` items are begun and
    not yet taken.
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
        # Nobody takes what is left; what it reads must stay until it is over.
        for future in running:
            future.cancel()
        wait(running)
