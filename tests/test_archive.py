"""Archives of columns: NumPy opens them, nothing is read before it is looked at, and what is not an archive is refused."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

from workhold import archive
from workhold.archive import ArchiveWriter, ColumnFormat, is_archive, map_archive, release_mapped_pages
from workhold.errors import InputError

COLUMNS = {"a": ColumnFormat("<f8", (2,)), "b": ColumnFormat("|i1"), "c": ColumnFormat("<i4", (4,))}
TEXT = '{"head": "ä"}'


def columns_of(rows: int) -> list[np.ndarray[Any, Any]]:
    random = np.random.default_rng(rows)
    return [
        random.random((rows, 2)),
        random.integers(-128, 128, rows).astype(np.int8),
        random.integers(-9, 9, (rows, 4)).astype(np.int32),
    ]


def written(path: Path, rows: int, together: int = 300) -> Path:
    with path.open("wb") as stream:
        writer = ArchiveWriter(stream, COLUMNS, rows)
        for start in range(0, rows, together):
            writer.append_rows([column[start : start + together] for column in columns_of(rows)])
        writer.close("head.json", TEXT, "mark")
    return path


@pytest.mark.parametrize("rows", [0, 1, 1000])
def test_numpy_and_zip_open_what_is_written(tmp_path: Path, rows: int) -> None:
    path = written(tmp_path / "a.npz", rows)
    assert is_archive(path) and path.read_bytes().endswith(b"mark")
    assert zipfile.ZipFile(path).testzip() is None
    loaded = np.load(path, allow_pickle=False)
    text, mapped = map_archive(path, COLUMNS, "head.json", whole=True)
    assert text == TEXT == loaded["head.json"].decode()
    for name, values in zip(COLUMNS, columns_of(rows), strict=True):
        np.testing.assert_array_equal(loaded[name], values)
        np.testing.assert_array_equal(mapped[name], values)
        assert mapped[name].dtype == values.dtype and mapped[name].flags.aligned


@pytest.mark.parametrize(("rows", "room"), [(0, 1), (7, 1000), (1000, 12_345_678)])
def test_fewer_rows_than_there_is_room_for(tmp_path: Path, rows: int, room: int) -> None:
    """The checksums are those of what is there."""
    with (tmp_path / "a.npz").open("wb") as stream:
        writer = ArchiveWriter(stream, COLUMNS, room)
        writer.append_rows(columns_of(rows))
        writer.close("head.json", TEXT, "mark")
    assert zipfile.ZipFile(tmp_path / "a.npz").testzip() is None
    loaded = np.load(tmp_path / "a.npz", allow_pickle=False)
    text, mapped = map_archive(tmp_path / "a.npz", COLUMNS, "head.json", whole=True)
    assert text == TEXT
    for name, values in zip(COLUMNS, columns_of(rows), strict=True):
        np.testing.assert_array_equal(loaded[name], values)
        np.testing.assert_array_equal(mapped[name], values)


def test_the_bytes_do_not_depend_on_the_blocks(tmp_path: Path) -> None:
    assert written(tmp_path / "a", 1000, 7).read_bytes() == written(tmp_path / "b", 1000, 1000).read_bytes()


def test_opening_reads_no_column(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A column whose numbers are damaged is opened all the same, unless all is to be read."""
    path = written(tmp_path / "a.npz", 1000)
    content = bytearray(path.read_bytes())
    content[8000] ^= 1
    path.write_bytes(content)
    map_archive(path, COLUMNS, "head.json")
    with pytest.raises(InputError, match=r"a\.npy has been changed since it was written"):
        map_archive(path, COLUMNS, "head.json", whole=True)


def test_every_truncation_is_refused(tmp_path: Path) -> None:
    content = written(tmp_path / "a.npz", 40).read_bytes()
    for length in range(4, len(content) - 4, 13):
        (tmp_path / "t.npz").write_bytes(content[:length])
        with pytest.raises(InputError):
            map_archive(tmp_path / "t.npz", COLUMNS, "head.json")


@pytest.mark.thorough
def test_damaged_bytes_give_the_same_columns_or_one_sentence(tmp_path: Path) -> None:
    """Bytes changed at random: the text is what was written or all is refused, and arrays never lie beyond the file."""
    content, random, refused = written(tmp_path / "a.npz", 5).read_bytes(), Random(1996), 0
    for _ in range(600):
        damaged = bytearray(content)
        for _ in range(random.choice([1, 1, 4])):
            damaged[random.randrange(len(damaged))] = random.choice([0, 1, 0x7F, 0xFF, random.randrange(256)])
        (tmp_path / "t.npz").write_bytes(damaged)
        try:
            text, mapped = map_archive(tmp_path / "t.npz", COLUMNS, "head.json")
        except InputError as error:
            refused += 1
            assert "\n" not in str(error) and str(error).endswith(".")
        else:
            assert text == TEXT
            assert [mapped[name].shape for name in COLUMNS] == [(5, 2), (5,), (5, 4)]
    assert 50 < refused < 550


def array_bytes(values: Any, **options: Any) -> bytes:
    stream = io.BytesIO()
    np.save(stream, values, **options)
    return stream.getvalue()


GOOD = {f"{name}.npy": array_bytes(values) for name, values in zip(COLUMNS, columns_of(6), strict=True)}


def zipped(path: Path, members: list[tuple[str, bytes]], kind: int = zipfile.ZIP_STORED) -> Path:
    with zipfile.ZipFile(path, "w", kind) as file:
        for name, content in members:
            file.writestr(name, content)
    return path


def test_an_archive_of_another_program_is_read(tmp_path: Path) -> None:
    members = [("more", b"x"), *GOOD.items(), ("head.json", TEXT.encode())]
    _, mapped = map_archive(zipped(tmp_path / "a.npz", members), COLUMNS, "head.json", whole=True)
    np.testing.assert_array_equal(mapped["a"], columns_of(6)[0])


@pytest.mark.filterwarnings("ignore:Duplicate name")
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda m: m[1:], "a.npy is missing"),
        (lambda m: m[:-1], "head.json is missing"),
        (lambda m: [*m, m[0]], "a.npy is there twice"),
        (
            lambda m: [("a.npy", array_bytes(np.zeros((6, 3)))), *m[1:]],
            "not an array of <f8 with rows of shape",
        ),
        (lambda m: [("a.npy", array_bytes(np.zeros((6, 2), np.float32))), *m[1:]], "not an array of <f8"),
        (lambda m: [("a.npy", array_bytes(np.zeros((6, 2), order="F"))), *m[1:]], "not an array of <f8"),
        (lambda m: [("a.npy", array_bytes(np.zeros((7, 2)))), *m[1:]], "do not have the same number of rows"),
        (
            lambda m: [("a.npy", array_bytes(np.array([[{}, 1]] * 6), allow_pickle=True)), *m[1:]],
            "not an array of <f8",
        ),
        (lambda m: [("a.npy", array_bytes(np.zeros((6, 2)))[:-8]), *m[1:]], "not an array of <f8"),
        (lambda m: [("a.npy", b""), *m[1:]], "it is damaged"),
        (lambda m: [("a.npy", b"\x93NUMPY\x01\x00\xff\xff"), *m[1:]], "not an array of <f8"),
        (lambda m: [*m[:-1], ("head.json", b"\xff\xfe")], "it is damaged"),
        (lambda m: [*m, *((f"{k:0>200}", b"") for k in range(6000))], "its directory is too large"),
    ],
)
def test_what_is_not_as_it_must_be_is_refused(
    tmp_path: Path, change: Callable[[list[tuple[str, bytes]]], list[tuple[str, bytes]]], message: str
) -> None:
    path = zipped(tmp_path / "a.npz", change([*GOOD.items(), ("head.json", TEXT.encode())]))
    with pytest.raises(InputError, match=message):
        map_archive(path, COLUMNS, "head.json")


def test_packed_members_are_refused_and_never_unpacked(tmp_path: Path) -> None:
    path = zipped(tmp_path / "a.npz", [*GOOD.items(), ("head.json", b" " * 10_000_000)], zipfile.ZIP_DEFLATED)
    with pytest.raises(InputError, match="is packed"):
        map_archive(path, COLUMNS, "head.json")


def test_a_text_too_large_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(archive, "MOST_TEXT", len(TEXT))
    with pytest.raises(InputError, match=r"its head\.json is too large"):
        map_archive(written(tmp_path / "a.npz", 3), COLUMNS, "head.json")


def test_members_that_overlap_are_refused(tmp_path: Path) -> None:
    """Two names for one place, as in bombs that need little room."""
    path = zipped(tmp_path / "a.npz", [*GOOD.items(), ("head.json", TEXT.encode())])
    names = {"a.npy": ColumnFormat("<f8", (2,)), "d.npy": ColumnFormat("<f8", (2,))}
    with zipfile.ZipFile(path, "a") as file:
        first = file.getinfo("a.npy")
        again = zipfile.ZipInfo("d.npy")
        again.header_offset, again.CRC = first.header_offset, first.CRC
        again.file_size = again.compress_size = first.file_size
        file.filelist.append(again)
        file._didModify = True  # type: ignore[attr-defined]
    with pytest.raises(InputError, match="its members overlap"):
        map_archive(path, {name[0]: column for name, column in names.items()}, "head.json")


STATUS = Path("/proc/self/status")


@pytest.mark.skipif(not STATUS.exists(), reason="only Linux says what of a file is in memory")
def test_parts_read_before_leave_the_memory(tmp_path: Path) -> None:
    """A column that was read takes no memory once it is released, and can be read again."""

    def measure_mapped_memory() -> int:
        """The bytes of mapped files that are in memory."""
        return 1024 * int(STATUS.read_text().split("RssFile:")[1].split()[0])

    rows = 1 << 20
    column = map_archive(written(tmp_path / "a.npz", rows, rows), COLUMNS, "head.json")[1]["a"]
    total, before = float(column.sum()), measure_mapped_memory()
    release_mapped_pages(column)
    assert measure_mapped_memory() < before - column.nbytes // 2
    release_mapped_pages(np.zeros(3))
    assert float(column.sum()) == total
