"""Output files appear whole or not at all."""

from __future__ import annotations

import os
import stat
import threading
from pathlib import Path

import pytest

from workhold.errors import InputError
from workhold.files.atomic import refuse_unwritable, refuse_unwritable_folder, write_bytes, write_text_file


def test_text_replaces_the_earlier_file_at_the_end(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    with write_text_file(path) as stream:
        stream.write("nëw\n")
        stream.flush()
        assert path.read_text() == "old"
    assert path.read_bytes() == "nëw\n".encode()
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("error", [ValueError("mistake"), KeyboardInterrupt(), SystemExit(3)])
def test_any_error_leaves_the_earlier_file_and_nothing_else(tmp_path: Path, error: BaseException) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(type(error)), write_text_file(path) as stream:
        stream.write("new")
        raise error
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_mistake_of_the_program_is_not_blamed_on_the_user(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="mistake") as caught, write_text_file(tmp_path / "a.txt"):
        raise ValueError("mistake")
    assert not isinstance(caught.value, InputError)


def test_a_full_disk_is_told_in_a_sentence(tmp_path: Path) -> None:
    with (
        pytest.raises(InputError, match=r"a\.txt cannot be written: No space left"),
        write_text_file(tmp_path / "a.txt"),
    ):
        raise OSError(28, "No space left on device")
    assert list(tmp_path.iterdir()) == []


def test_permissions_of_the_earlier_file_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "a.bin"
    path.write_bytes(b"")
    path.chmod(0o640)
    write_bytes(path, b"new")
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_a_new_file_has_the_usual_permissions(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        write_bytes(tmp_path / "a.bin", b"new")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a.bin").stat().st_mode) == 0o640


def test_a_symbolic_link_stays_and_its_target_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    target, link = tmp_path / "folder" / "a.txt", tmp_path / "link.txt"
    target.write_text("old")
    link.symlink_to(target)
    write_bytes(link, b"new")
    assert link.is_symlink()
    assert target.read_text() == "new"


def test_a_pipe_is_written_to_and_not_replaced(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    received: list[bytes] = []
    reader = threading.Thread(target=lambda: received.append(pipe.read_bytes()))
    reader.start()
    write_bytes(pipe, b"new")
    reader.join(120)
    assert received == [b"new"]
    assert pipe.is_fifo()


def test_a_very_long_name_is_no_trouble(tmp_path: Path) -> None:
    path = tmp_path / ("n" * 250)
    write_bytes(path, b"new")
    assert path.read_bytes() == b"new"


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("folder", "is a folder: name a file in it"),
        ("missing/a.json", "there is no folder .*missing: create it first"),
        ("file/a.json", "there is no folder"),
        ("a\0b", "cannot be a file's name"),
        ("n" * 300, "cannot be|File name too long"),
    ],
)
def test_impossible_outputs_are_refused_before_any_work(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=message):
        refuse_unwritable(tmp_path / name)
    with pytest.raises(InputError, match=message):
        write_bytes(tmp_path / name, b"")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["file", "folder"]


def test_possible_outputs_pass_and_leave_no_trace(tmp_path: Path) -> None:
    (tmp_path / "old.json").write_text("old")
    refuse_unwritable(tmp_path / "new.json")
    refuse_unwritable(tmp_path / "old.json")
    refuse_unwritable("/dev/null")
    refuse_unwritable_folder(tmp_path)
    refuse_unwritable_folder(tmp_path / "new" / "deep")
    assert [p.name for p in tmp_path.iterdir()] == ["old.json"]
    assert (tmp_path / "old.json").read_text() == "old"


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for name in ("file", "file/deeper"):
        with pytest.raises(InputError, match="is a file"):
            refuse_unwritable_folder(tmp_path / name)
