"""One fixture of a file: the same as of the whole file, and nothing read for the others."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import workhold
from workhold import Fence, InputError, OpeningVise, Plate, Query, Result, Vise, Workpiece, answer
from workhold.files.result import reader
from workhold.files.result.one_fixture import read_one

BLOCK = [[[0, 0, 0], [60, 0, 0], [60, 40, 0], [31, 47, 0], [0, 40, 0]]]
HOLED = [[[0, 0, 0], [70, 0, 0], [66, 50, 0], [0, 45, 0]], [[24, 22, -1], [44, 22, -1]]]
KINDS = {
    "vise": (BLOCK, Vise(10, 3, 3.0), {}),
    "seating": (BLOCK, Vise(10, 3, 3.0), {"seating": 3}),
    "opening vise": (HOLED, OpeningVise(5, 2, 1.5), {}),
    "plate": (BLOCK, Plate(10, 3.0, columns=8, rows=8, travel=(5, 25)), {"best": 60}),
    "two clamps": (BLOCK, Plate(20, 3.0, clamps=2), {"best": 40}),
    "fence": (HOLED, Fence(10, 3.0, wall_offset=5), {}),
}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], tuple[Result, Path]]:
    """The result of a kind, and the folder with its files."""
    known: dict[str, tuple[Result, Path]] = {}

    def of(kind: str) -> tuple[Result, Path]:
        if kind not in known:
            loops, toolkit, asked = KINDS[kind]
            folder = tmp_path_factory.mktemp("made")
            workhold.save(
                answer(Query(Workpiece.from_loops("part", loops), toolkit, **asked)), folder / "r.json"
            )
            result = workhold.open(folder / "r.json")
            workhold.save(result, folder / "r.npz")
            (folder / "other.json").write_text(json.dumps(json.loads((folder / "r.json").read_text())))
            known[kind] = result, folder
        return known[kind]

    return of


@pytest.fixture
def document(made: Any, tmp_path: Path) -> Callable[[Callable[[list[bytes]], None]], Path]:
    """The file of a vise after a change of its lines."""

    def changed(change: Callable[[list[bytes]], None]) -> Path:
        lines = (made("vise")[1] / "r.json").read_bytes().splitlines(keepends=True)
        change(lines)
        (tmp_path / "r.json").write_bytes(b"".join(lines))
        return tmp_path / "r.json"

    return changed


def first_line(lines: list[bytes]) -> int:
    return next(k for k, line in enumerate(lines) if line.startswith(b'"fixtures"')) + 1


@pytest.mark.thorough
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["r.json", "other.json", "r.npz"])
def test_it_is_the_one_of_the_whole_file(kind: str, name: str, made: Any) -> None:
    """With its seating, and with how many use the same holes."""
    _, folder = made(kind)
    whole = workhold.open(folder / name)
    assert len(whole) > 4
    for rank in (1, 2, 3, 4, len(whole)):
        one = read_one(folder / name, rank)
        fixture, expected = one[rank - 1], whole[rank - 1]
        assert (fixture, fixture.seating, len(one)) == (expected, expected.seating, len(whole))
        assert fixture.listing.others == expected.listing.others
        assert (one.query, one.found, one.notes, one.proof) == (
            whole.query,
            whole.found,
            whole.notes,
            whole.proof,
        )


@pytest.mark.thorough
def test_same_holes_are_some(made: Any) -> None:
    """So that the comparison above says something."""
    assert any(fixture.listing.others for fixture in made("vise")[0])


@pytest.mark.thorough
def test_the_others_are_read_once_they_are_asked_for(made: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    whole, folder = made("vise")
    rows = list[int]()
    read = reader.make_fixture_row
    monkeypatch.setattr(reader, "make_fixture_row", lambda fixture: rows.append(1) or read(fixture))
    one = read_one(folder / "r.json", 5)
    assert one[4].listing.others == whole[4].listing.others and len(rows) == 1
    assert one[3] == whole[3] and one[5] == whole[5] and one.counts == whole.counts and one == whole
    assert len(rows) == 1 + len(whole)


def test_a_fixture_that_there_is_not_is_refused(made: Any) -> None:
    whole, folder = made("vise")
    for name in ("r.json", "other.json", "r.npz"):
        with pytest.raises(InputError, match=f"lists {len(whole)} fixtures: there is no fixture 9999"):
            read_one(folder / name, 9999)


@pytest.mark.thorough
def test_a_damaged_file_is_refused(document: Any) -> None:
    """For its head, the fixture, and how many there are; the place is that in the file."""

    def line(number: int, old: bytes, new: bytes) -> Callable[[list[bytes]], None]:
        def change(lines: list[bytes]) -> None:
            place = first_line(lines) + number - 1
            assert old in lines[place]
            lines[place] = lines[place].replace(old, new, 1)

        return change

    def drop(lines: list[bytes]) -> None:
        del lines[first_line(lines) + 1]

    for change, words in (
        (drop, "counts say .* fixtures, but .* are listed"),
        (line(3, b'"x": ', b'"x": 1'), "fixture 3 has a peg whose x, y are not those of its hole"),
        (line(3, b'"pose"', b'"place"'), "fixture 3 has no key 'pose'"),
        (line(3, b'"force": ', b'"force": -'), "fixture 3 has a peg whose force is not positive"),
        (line(3, b'"column": ', b'"column": 9'), "fixture 3 has a peg in a column beyond"),
        (line(3, b'{"type"', b'{"type'), "is not valid JSON"),
        (lambda lines: lines.pop(), "is not valid JSON"),
        (lambda lines: lines.pop(1), "the key workpiece is missing"),
    ):
        with pytest.raises(InputError, match=words):
            read_one(document(change), 3)
    assert read_one(document(line(4, b'"pose"', b'"place"')), 3)[2].listing.rank == 3


@pytest.mark.thorough
def test_seating_behind_one_without_is_refused(made: Any, tmp_path: Path) -> None:
    content = json.loads((made("seating")[1] / "r.json").read_text())
    del content["fixtures"][1]["seating"]
    lines = (made("seating")[1] / "r.json").read_text().splitlines(keepends=True)
    place = first_line([line.encode() for line in lines]) + 1
    lines[place] = json.dumps(content["fixtures"][1]) + ",\n"
    (tmp_path / "r.json").write_text("".join(lines))
    with pytest.raises(InputError, match="fixture 3 has its seating stated, but not the one before it"):
        read_one(tmp_path / "r.json", 3)


def test_what_is_not_a_result_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text("{}")
    for path in (tmp_path / "a.json", tmp_path / "none.json", tmp_path):
        with pytest.raises(InputError):
            read_one(path, 1)
