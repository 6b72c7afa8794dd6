"""Rows come out of runs as a stable sort of all of them would put them, from memory and from the disk."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from workhold.listing import runs
from workhold.listing.runs import ExternalSort, SortedRun, make_keys, map_in_order, sort_keys


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Parts of a few rows, so that little is much."""
    for name, value in (("PART", 60), ("ROOM", 150), ("STRIDE", 7)):
        monkeypatch.setattr(runs, name, value)


def test_keys_are_in_the_order_of_the_numbers() -> None:
    """Lexicographic, NaN last, both zeros alike; whole numbers behind floats and in front of them."""
    random = np.random.default_rng(3)
    special = [0.0, -0.0, 1.0, -1.0, np.inf, -np.inf, np.nan, -np.nan, 5e-324, -5e-324, 1e300, -1e300]
    floats, whole = random.choice(special, (2, 400)), random.integers(0, 3, 400) << 40
    key = make_keys(floats[0], whole, floats[1])
    expected = np.lexsort([floats[1], whole, floats[0]])
    np.testing.assert_array_equal(np.argsort(key, kind="stable"), expected)
    assert len(make_keys(np.zeros(0), np.zeros(0, np.int64))) == 0


@pytest.mark.parametrize("most", [runs.MOST, 10**9, 10**6, 500])
def test_the_order_of_keys_is_that_of_their_bytes(monkeypatch: pytest.MonkeyPatch, most: int) -> None:
    """Equal ones as they stand, also where their words are too many for one number."""
    monkeypatch.setattr(runs, "MOST", most)
    random = np.random.default_rng(4)
    for count in (0, 1, 2, 30, 200):
        for kinds in range(1, 5):
            some = (
                random.integers(0, 3, count),
                random.integers(0, 1 << 62, count),
                np.round(random.normal(size=count), 1),
                np.where(random.random(count) < 0.3, np.nan, random.normal(size=count)),
            )
            keys = make_keys(*(some[k] for k in random.permutation(4)[:kinds]))
            np.testing.assert_array_equal(sort_keys(keys), np.argsort(keys, kind="stable"))


@pytest.mark.parametrize("rows", [0, 1, 59, 1000])
@pytest.mark.parametrize("values", [5, 10**9])
@pytest.mark.parametrize("on_disk", [False, True])
def test_rows_are_sorted_and_equal_keys_stay_in_order(
    small: None, tmp_path: Path, rows: int, values: int, on_disk: bool
) -> None:
    random = np.random.default_rng(rows)
    numbers = random.integers(0, values, rows)
    columns = (np.arange(rows), random.random((rows, 2)), np.arange(rows).astype(np.int8))
    kept = ExternalSort(tmp_path if on_disk else None)
    kept.add_run(SortedRun.from_columns(make_keys(numbers[:0]), tuple(column[:0] for column in columns)))
    for start in range(0, rows, 33):
        block = slice(start, start + 33)
        kept.add_run(
            SortedRun.from_columns(make_keys(numbers[block]), tuple(column[block] for column in columns))
        )
    assert len(kept) == rows
    assert (kept.scratch is not None) == (on_disk and rows > 150)
    parts = [part() for part in kept.list_parts()]
    order = np.argsort(numbers, kind="stable")
    for number, column in enumerate(columns):
        np.testing.assert_array_equal(np.concatenate([part.columns[number] for part in parts]), column[order])
    for one, other in pairwise(parts):
        assert len(one) == 0 or len(other) == 0 or one.keys[-1] < other.keys[0]
    if values > rows:
        assert max(map(len, parts)) <= 60 + 7 * (rows // 33 + 2)
    kept.close()
    assert list(tmp_path.iterdir()) == []


def test_what_is_written_after_a_look_at_it_is_at_the_end(tmp_path: Path) -> None:
    scratch = runs.ScratchFile(tmp_path)
    places = [scratch.write(np.arange(9))]
    assert scratch.read(places[0], 8) == np.arange(1).tobytes()
    places.append(scratch.write(np.arange(5)))
    assert [scratch.read(place, 72) for place in places] == [np.arange(9).tobytes(), np.arange(5).tobytes()]


def test_a_full_disk_is_an_error(small: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Full:
        def seek(self, *_: Any) -> int:
            return 0

        def write(self, *_: Any) -> int:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(runs, "TemporaryFile", lambda **_: Full())
    kept = ExternalSort(tmp_path)
    with pytest.raises(OSError, match="No space left"):
        kept.add_run(SortedRun.from_columns(make_keys(np.arange(200)), (np.arange(200),)))


@pytest.mark.parametrize("threads", [1, 3])
def test_work_is_handed_back_in_order(threads: int) -> None:
    begun: list[int] = []

    def items() -> Any:
        for number in range(20):
            begun.append(number)
            yield number

    with ThreadPoolExecutor(threads) as pool:
        for number, square in enumerate(map_in_order(pool, 4, lambda n: n * n, items())):
            assert square == number**2
            assert len(begun) <= number + 5
