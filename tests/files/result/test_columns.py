"""The result file in columns says what the JSON form says, is read where it is looked at, and trusted no more than JSON."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest

import workhold
from fakes import fake_proof, fake_result
from workhold import Result
from workhold.archive import ArchiveWriter, map_archive
from workhold.errors import InputError
from workhold.files.result import columns as in_columns
from workhold.files.result.columns import round_to_twelve_digits, write_columns
from workhold.files.result.parts import HEAD, describe_columns
from workhold.files.result.reader import read_result
from workhold.files.result.writer import write_result
from workhold.listing.identity import make_entries
from workhold.model.fixture_table import FixtureTable
from workhold.verification.listing import read_listing


@pytest.mark.thorough
@pytest.mark.parametrize("count", [0, 1, 7, 5000])
def test_the_same_bytes_come_back_from_the_other_form(tmp_path: Path, count: int, monkeypatch: Any) -> None:
    monkeypatch.setattr(in_columns, "BLOCK", 999)
    result = fake_result(count, notes=("remark ä",), complete=False, proof=fake_proof(2))
    for name in ("a.json", "a.npz"):
        workhold.save(result, tmp_path / name)
    workhold.save(workhold.open(tmp_path / "a.npz"), tmp_path / "b.json")
    workhold.save(workhold.open(tmp_path / "a.json"), tmp_path / "b.npz")
    for form in ("json", "npz"):
        assert (tmp_path / f"a.{form}").read_bytes() == (tmp_path / f"b.{form}").read_bytes()


def test_a_file_without_fixtures_lists_none(tmp_path: Path) -> None:
    workhold.save(fake_result(0), tmp_path / "a.npz")
    read = workhold.open(tmp_path / "a.npz")
    assert len(read.table.take(np.zeros(0, np.int64))) == 0 and len(make_entries(read).index) == 0


def test_both_forms_give_the_same_result(tmp_path: Path) -> None:
    """Number for number, whatever the name of the file."""
    write_result(fake_result(50, proof=fake_proof(1)), tmp_path / "a")
    write_columns(fake_result(50, proof=fake_proof(1)), tmp_path / "b.json")
    one, other = read_result(tmp_path / "a"), read_result(tmp_path / "b.json")
    for name in ("query", "found", "distinct", "counts", "complete", "notes", "statistics", "proof"):
        assert getattr(one, name) == getattr(other, name)
    for mine, theirs in zip(one.table.columns, other.table.columns, strict=True):
        np.testing.assert_array_equal(mine, theirs)
    assert list(one) == list(other) and one[-3] == other[-3] and list(one[4:9]) == list(other[4:9])
    listings = [read_listing(tmp_path / name) for name in ("a", "b.json")]
    assert list(listings[0].fixtures) == [
        attrs.evolve(
            fixture, pegs=tuple(attrs.evolve(p, x=round(p.x, 9), y=round(p.y, 9)) for p in fixture.pegs)
        )
        for fixture in listings[1].fixtures
    ]
    assert attrs.evolve(listings[0], fixtures=()).counts == attrs.evolve(listings[1], fixtures=()).counts


def test_numbers_are_rounded_as_twelve_digits_are_read() -> None:
    random = np.random.default_rng(0)
    values = random.choice([-1, 1], 20_000) * random.random(20_000) * 10.0 ** random.integers(-40, 40, 20_000)
    powers = 10.0 ** np.arange(-30, 31)
    halves = np.round(random.random(20_000) * 1e4, 8) + 5e-9 * (np.arange(20_000) % 2)
    values = np.concatenate(
        [values, powers, np.nextafter(powers, 0), np.nextafter(powers, np.inf), halves, [0.0, 5e-324, 1e300]]
    )
    np.testing.assert_array_equal(
        round_to_twelve_digits(values), [float(f"{value:.12g}") for value in values]
    )
    assert np.isnan(round_to_twelve_digits(np.array([np.nan, 1.0, np.inf, -np.inf]))).tolist() == [
        True,
        False,
        True,
        True,
    ]


def test_one_fixture_is_read_and_not_the_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    taken: list[int] = []
    take = FixtureTable.take

    def recorded(self: FixtureTable, order: Any) -> FixtureTable:
        table = take(self, order)
        taken.append(len(table))
        return table

    write_columns(fake_result(3000), tmp_path / "a.npz")
    monkeypatch.setattr(FixtureTable, "take", recorded)
    assert read_result(tmp_path / "a.npz")[2999].pose == fake_result(3000)[2999].pose or taken
    assert taken[0] == 1


def rewritten(path: Path, result: Result, head: Callable[[str], str], **changed: Any) -> Path:
    """A file in columns of a result with another head and other columns."""
    write_columns(result, path)
    text, columns = map_archive(path, describe_columns(1), HEAD)
    with path.with_suffix(".new").open("wb") as stream:
        archive = ArchiveWriter(stream, describe_columns(1), len(result))
        archive.append_rows([changed.get(name, values) for name, values in columns.items()])
        archive.close(HEAD, head(text), "mark")
    return path.with_suffix(".new")


def altered(result: Result, name: str, place: Any, value: Any) -> np.ndarray[Any, Any]:
    values = np.array(getattr(result.table, name))
    values[place] = value
    return values


DAMAGED: list[tuple[str, Any, Any, str]] = [
    ("column", (2, 0), 3, "fixture 3 has a peg in a column beyond the 3 of the left jaw"),
    ("column", (2, 3), -1, "fixture 3 has a peg in a column beyond the 3 of the right jaw"),
    ("row", (2, 3), -1, "fixture 3 has a peg in a row"),
    ("face", (2, 1), 77, "fixture 3 has a peg on a segment that does not name a face"),
    ("theta", 2, np.nan, "fixture 3 cannot be used: .* is not a finite number"),
    ("position", (2, 1), np.inf, "fixture 3 cannot be used: .* is not a finite number"),
    ("jaw_separation", 2, 1e301, "fixture 3 cannot be used: .* is not a finite number"),
    ("quality", (2, 1), -np.inf, "fixture 3 cannot be used: .* is not a finite number"),
    ("force", (2, 3), 0.0, "fixture 3 has a peg whose force is not positive"),
    ("force", (2, 3), np.nan, "fixture 3 cannot be used: .* is not a finite number"),
]


@pytest.mark.parametrize(("name", "place", "value", "message"), DAMAGED)
def test_a_damaged_fixture_is_refused_when_it_is_looked_at(
    tmp_path: Path, name: str, place: Any, value: Any, message: str
) -> None:
    result = fake_result(9)
    path = rewritten(tmp_path / "a.npz", result, str, **{name: altered(result, name, place, value)})
    opened = read_result(path)
    assert opened[3].pose.x == pytest.approx(result[3].pose.x)
    for look in (lambda: opened[2], lambda: opened[-7], lambda: list(opened), lambda: opened[1:4]):
        with pytest.raises(InputError, match=message) as caught:
            look()
        assert "\n" not in str(caught.value) and str(caught.value).endswith(".")
    with pytest.raises(InputError, match="fixture 3 "):
        workhold.save(opened, tmp_path / "b.json")
    with pytest.raises(InputError, match="fixture 3 "):
        opened.table.take(np.array([4, 2]))
    assert not (tmp_path / "b.json").exists()


@pytest.mark.parametrize("value", [2, -1])
def test_types_are_checked_when_the_file_is_opened(tmp_path: Path, value: int) -> None:
    result = fake_result(9)
    path = rewritten(tmp_path / "a.npz", result, str, arrangement=altered(result, "arrangement", 2, value))
    with pytest.raises(InputError, match="fixture 3 cannot be used: its type is not I or II"):
        read_result(path)
    with pytest.raises(InputError, match="number 3 in fixtures"):
        read_listing(path)


@pytest.mark.parametrize("name", ["theta", "position", "force"])
def test_a_verification_refuses_what_is_no_number(tmp_path: Path, name: str) -> None:
    result = fake_result(9)
    path = rewritten(tmp_path / "a.npz", result, str, **{name: altered(result, name, 2, np.nan)})
    with pytest.raises(InputError, match="number 3 in fixtures"):
        read_listing(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"I": ', '"I": 1', "counts say 1[0-9]* fixtures of type I, but"),
        ('"workhold-result/1"', '"workhold-result/9"', "format cannot be used"),
        ('"counts"', '"account"', "the key counts is missing"),
        ("{", "[", "is not a result file: the file is not valid JSON"),
        ('"columns": 3', '"columns": 3, "columns": 3', 'the key "columns" is given twice'),
        ('"columns": 3', '"columns": 1e999', "Infinity|columns cannot be used"),
    ],
)
def test_a_damaged_head_is_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = rewritten(tmp_path / "a.npz", fake_result(9), lambda text: text.replace(old, new, 1))
    with pytest.raises(InputError, match=message):
        read_result(path)


def test_an_error_on_the_way_leaves_the_earlier_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.npz"
    path.write_text("old")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(ArchiveWriter, "append_rows", full)
    with pytest.raises(InputError, match=r"a\.npz cannot be written: No space left on device"):
        write_columns(fake_result(3), path)
    assert path.read_text() == "old" and list(tmp_path.iterdir()) == [path]


def test_a_form_that_does_not_exist_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match="'doc' is not a form of a result file: choose one of json, csv, npz"
    ):
        workhold.save(fake_result(1), tmp_path / "a.doc")
