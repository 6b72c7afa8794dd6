"""Python writes over no file of somebody else's, over nothing that it reads, and under no other kind's name."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import workhold
from workhold import Fixture, Result
from workhold.errors import InputError
from workhold.files.replacing import (
    is_own,
    refuse_other_ending,
    refuse_output,
    refuse_output_folder,
)
from workhold.files.supports_file import write_supports

FOREIGN = b"years of work"
PLATE = workhold.Workpiece.from_loops("plate", [[[0, 0, 0], [80, 0, 0], [80, 60, 0], [0, 60, 0]]])
VISE = workhold.Vise(pitch=10, columns=6, peg_radius=3)

Write = Callable[..., object]


@pytest.fixture(scope="module")
def result() -> Result:
    """Two ways to hold a plate."""
    return workhold.design(PLATE, VISE, best=2)


@pytest.fixture(scope="module")
def supports(result: Result) -> Any:
    """What holds it up."""
    return result[0].supports(12, best=1, pad_radius=3)


def step_writer() -> Write:
    """The function that writes a set-up as STEP, which an extra is needed for."""
    pytest.importorskip("OCP")
    from workhold.files.step.writer import write_setup_step

    return write_setup_step


# How to write a file in Python, by its name.
WRITERS: dict[str, Callable[[Result, Any], Write]] = {
    "r.json": lambda result, _: lambda path, **asked: workhold.save(result, path, **asked),
    "r.csv": lambda result, _: lambda path, **asked: workhold.save(result, path, **asked),
    "r.npz": lambda result, _: lambda path, **asked: workhold.save(result, path, **asked),
    "a.npz": lambda result, _: lambda path, **asked: workhold.answer_to_file(result.query, path, **asked),
    "part.svg": lambda result, _: result.workpiece.draw,
    "part.png": lambda result, _: result.workpiece.draw,
    "glance.svg": lambda result, _: result.draw,
    "fixture.png": lambda result, _: result[0].draw,
    "kept.svg": lambda result, _: result[0].draw().save,  # type: ignore[attr-defined]
    "sheet.pdf": lambda result, _: result[0].save_sheet,
    "sheet.svg": lambda result, _: result[0].save_sheet,
    "sheet.png": lambda result, _: result[0].save_sheet,
    "setup.dxf": lambda result, _: result[0].save_sheet,
    "pins.csv": lambda result, _: result[0].save_sheet,
    "fixture.glb": lambda result, _: result[0].save_glb,
    "supports.json": lambda _, found: lambda path, **asked: write_supports(found, path, **asked),
    "setup.step": lambda result, _: (
        lambda path, **asked: step_writer()(
            result[0], result.workpiece, result.toolkit, path, thickness=12, **asked
        )
    ),
}


@pytest.mark.thorough
@pytest.mark.parametrize("name", WRITERS)
def test_foreign_files_are_kept_until_it_is_asked_for_and_own_ones_replaced(
    result: Result, supports: Any, tmp_path: Path, name: str
) -> None:
    write, path = WRITERS[name](result, supports), tmp_path / name
    path.write_bytes(FOREIGN)
    with pytest.raises(
        InputError, match=r"was not written by workhold: give another name, or overwrite=True"
    ):
        write(path)
    assert path.read_bytes() == FOREIGN
    write(path, overwrite=True)
    written = path.read_bytes()
    assert written != FOREIGN and is_own(path)
    write(path)
    assert path.read_bytes() == written
    assert [one.name for one in tmp_path.iterdir()] == [name]


@pytest.mark.thorough
@pytest.mark.thinned(6)
@pytest.mark.parametrize("name", WRITERS)
def test_where_nothing_can_be_written_a_sentence_says_so(
    result: Result, supports: Any, tmp_path: Path, name: str
) -> None:
    """A folder, a folder that is missing, a link in a circle, a device that is full."""
    write = WRITERS[name](result, supports)
    (tmp_path / name).mkdir()
    (tmp_path / "circle").symlink_to(tmp_path / "circle")
    full = tmp_path / f"full{Path(name).suffix}"
    full.symlink_to("/dev/full")
    for path in (tmp_path / name, tmp_path / "missing" / name, tmp_path / "circle" / name, full):
        with pytest.raises(InputError):
            write(path)
        with pytest.raises(InputError):
            write(path, overwrite=True)
    assert sorted(one.name for one in tmp_path.iterdir()) == sorted(["circle", full.name, name])


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", WRITERS)
def test_no_writer_takes_the_name_of_another_kind_of_file(
    result: Result, supports: Any, tmp_path: Path, name: str
) -> None:
    write = WRITERS[name](result, supports)
    for ending in (".stl", ".html", ".igs", ".parquet"):
        with pytest.raises(InputError):
            write(tmp_path / f"a{ending}")
    assert list(tmp_path.iterdir()) == []


def test_the_form_asked_for_has_to_be_that_of_the_name(result: Result, tmp_path: Path) -> None:
    for name, form in (("r.npz", "json"), ("r.json", "csv"), ("r.svg", "json"), ("r.csv", "npz")):
        with pytest.raises(InputError, match=rf"let the name end in \.{form}"):
            workhold.save(result, tmp_path / name, form)
    with pytest.raises(InputError, match=r"let the name end in \.npz"):
        workhold.answer_to_file(result.query, tmp_path / "r.json")
    assert list(tmp_path.iterdir()) == []
    workhold.save(result, tmp_path / "r.txt", "csv")


@pytest.mark.parametrize("link", [None, os.symlink, os.link], ids=["same name", "symbolic link", "hard link"])
def test_what_is_read_is_never_replaced(result: Result, tmp_path: Path, link: Any) -> None:
    """Not even where that is asked for."""
    read, path = tmp_path / "r.json", tmp_path / "sheet.pdf"
    workhold.save(result, read)
    if link is None:
        read.rename(path)
        read = path
    else:
        link(read, path)
    before = read.read_bytes()
    for overwrite in (False, True):
        with pytest.raises(InputError, match="is also an input"):
            result[0].save_sheet(path, result_file=read, overwrite=overwrite)
        with pytest.raises(InputError, match="is also an input"):
            result[0].save_glb(linked(read, tmp_path), part=read, overwrite=overwrite)
    assert read.read_bytes() == before


def linked(read: Path, folder: Path) -> Path:
    """The name of a GLB file that leads to another one."""
    path = folder / "x.glb"
    if not path.exists():
        path.symlink_to(read)
    return path


def test_two_processes_that_write_one_file_leave_one_of_the_two(result: Result, tmp_path: Path) -> None:
    """Each has a temporary name of its own."""
    from threading import Thread

    path = tmp_path / "r.json"
    writers = [Thread(target=workhold.save, args=(result, path)) for _ in range(4)]
    for one in writers:
        one.start()
    for one in writers:
        one.join()
    assert len(workhold.open(path)) == len(result)
    assert list(tmp_path.iterdir()) == [path]


def test_an_error_while_it_is_written_leaves_the_earlier_file(
    result: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "r.json"
    workhold.save(result, path)
    before = path.read_bytes()

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("workhold.files.result.writer.write_fixture_lines", interrupted)
    with pytest.raises(KeyboardInterrupt):
        workhold.save(result, path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.thorough
def test_the_hash_of_another_result_does_not_get_on_a_sheet(result: Result, tmp_path: Path) -> None:
    other: Fixture = workhold.design(PLATE, workhold.Vise(pitch=10, columns=5, peg_radius=3), best=1)[0]
    for name in ("r.json", "r.npz"):
        workhold.save(result, tmp_path / name)
        result[1].save_sheet(tmp_path / "a.svg", result_file=tmp_path / name)
        with pytest.raises(InputError, match="has another fixture in place 1"):
            other.save_sheet(tmp_path / "b.svg", result_file=tmp_path / name)
    workhold.save(result.slice_rows(slice(1, 2)), tmp_path / "last.json")
    with pytest.raises(InputError, match="has another fixture in place 1"):
        result[0].save_sheet(tmp_path / "b.svg", result_file=tmp_path / "last.json")
    assert not (tmp_path / "b.svg").exists()


@pytest.mark.parametrize(
    ("content", "own"),
    [
        ("", True),
        ("toolkit,fixtures,type_I,reason\n", True),
        ("part,file,toolkit,state\n", True),
        ("PAR1 workhold-table/1 PAR1", True),
        ("format workhold-benchmark/1\n", True),
        ("toolkit,fixtures\n", False),
        ("workhold\n", False),
    ],
)
def test_files_are_known_by_their_marks(tmp_path: Path, content: str, own: bool) -> None:
    """Those of comparisons, batches and benchmarks too; an empty file holds nothing that could be lost."""
    path = tmp_path / "file"
    path.write_text(content)
    assert is_own(path) is own
    assert not is_own(tmp_path / "no such file")


def test_outputs_are_refused_before_any_work_is_done_for_them(tmp_path: Path) -> None:
    """A folder that is not there, a file in a folder's place, and an input among several outputs."""
    with pytest.raises(InputError, match="nowhere"):
        refuse_output(tmp_path / "nowhere" / "a.json")
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="cannot be a folder"):
        refuse_output_folder(tmp_path / "file", [], [], False)
    (tmp_path / "b").write_text("read")
    with pytest.raises(InputError, match="b is also an input"):
        (tmp_path / "a").touch()
        refuse_output_folder(tmp_path, ["a", "b"], iter([tmp_path / "b"]), True)
    # The name of something else than a file is not an input that could be replaced.
    refuse_output(tmp_path / "a", ["a\0b", None])


def test_an_ending_is_known_in_capitals_too() -> None:
    with pytest.raises(InputError, match="is not the name of a picture"):
        refuse_other_ending("a.STL", [".svg"], "a picture")
    refuse_other_ending("a.SVG", [".svg"], "a picture")
