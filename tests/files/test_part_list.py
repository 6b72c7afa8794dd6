"""A list of parts: each file once, in an order that does not depend on the disk, and no file ends the others."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from workhold.errors import InputError
from workhold.files import part_list as module
from workhold.files.part_list import ListedPart, list_parts, read_listed

SQUARE = json.dumps(
    {"name": "square", "units": "mm", "loops": [[[0, 0, 0], [9, 0, 0], [9, 9, 0], [0, 9, 0]]]}
)


def folder_of(root: Path, *names: str) -> Path:
    """A folder with the same square under many names."""
    for name in names:
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(SQUARE)
    return root


def names_of(*given: str | Path, leave_out: tuple[Path, ...] = ()) -> list[str]:
    return [part.name for part in list_parts(given, leave_out)]


def test_a_folder_is_its_drawings_in_the_order_people_count(tmp_path: Path) -> None:
    folder = folder_of(
        tmp_path,
        *(
            "p10.json",
            "P2.DXF",
            "p1.svg",
            "a/z.stp",
            "a/b.step",
            "notes.txt",
            "p02.json",
            "p²².json",
            "p1000.svg",
        ),
    )
    assert names_of(folder) == [
        *("p1.svg", "p02.json", "P2.DXF", "p10.json", "p1000.svg", "p²².json", "a/b.step", "a/z.stp")
    ]
    assert [part.path for part in list_parts([folder])][-1] == tmp_path / "a" / "z.stp"


def test_files_and_names_stand_where_they_were_typed(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, "a.json", "b.json")
    typed = str(folder / "b.json")
    assert names_of("widget", typed, folder) == ["widget", typed, "a.json"]


def test_two_of_one_name_are_told_by_their_folders(tmp_path: Path) -> None:
    one, two = folder_of(tmp_path / "one", "a.json", "b.json"), folder_of(tmp_path / "two", "a.json")
    assert names_of(one, two) == [str(one / "a.json"), "b.json", str(two / "a.json")]


def test_hidden_files_own_results_and_folders_left_out_are_no_parts(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, "a.json", ".b.json", ".git/c.json", "out/d.json", "in/e.json")
    (folder / "r.json").write_text('{"format": "workhold-result/1",\n')
    assert names_of(folder, leave_out=(folder / "out",)) == ["a.json", "in/e.json"]


def test_a_folder_left_out_is_known_by_any_name(tmp_path: Path) -> None:
    folder = folder_of(tmp_path / "parts", "a.json", "out/d.json")
    (tmp_path / "link").symlink_to(folder)
    for given, left in ((folder, tmp_path / "link"), (tmp_path / "link", folder)):
        assert names_of(given, leave_out=(left / "out",)) == ["a.json"]


def test_a_folder_that_nobody_may_read_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(path: Path) -> object:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "scandir", refuse)
    with pytest.raises(InputError, match=r"cannot be read \(permission denied\)"):
        list_parts([tmp_path])


def test_names_that_are_not_utf8_can_be_written(tmp_path: Path) -> None:
    name = os.fsdecode(b"p\xff.json")
    names_of(folder_of(tmp_path, name))[0].encode()


def test_what_is_no_file_is_a_row_that_costs_no_other(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, "a.json")
    (folder / "circle.json").symlink_to("circle.json")
    (folder / "lost.json").symlink_to("nowhere")
    os.mkfifo(folder / "pipe.json")
    (folder / "under.dxf.json").mkdir()
    said = {part.name: read_listed(part).refusal for part in list_parts([folder])}
    link = "this is a link that leads to no file: give the file itself."
    pipe = "this is not a regular file: give a .json, .dxf, .svg or .step file."
    assert said == {
        "a.json": "",
        "circle.json": f"circle.json: {link}",
        "lost.json": f"lost.json: {link}",
        "pipe.json": f"pipe.json: {pipe}",
    }


def test_an_inner_folder_that_nobody_may_read_costs_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = folder_of(tmp_path, "a.json", "closed/b.json", "open/c.json")
    look = os.scandir

    def refuse(path: Path) -> object:
        if path == folder / "closed":
            raise PermissionError(13, "Permission denied")
        return look(path)

    monkeypatch.setattr(os, "scandir", refuse)
    monkeypatch.setattr(os, "access", lambda path, _: path != folder / "closed")
    parts = list_parts([folder])
    assert [part.name for part in parts] == ["a.json", "closed", "open/c.json"]
    assert "cannot be looked into: allow reading it" in read_listed(parts[1]).refusal


@pytest.mark.thorough
def test_folders_may_lie_in_each_other_as_deep_as_the_disk_allows(tmp_path: Path) -> None:
    nested = [tmp_path]
    for _ in range(1200):
        nested.append(nested[-1] / "d")
        nested[-1].mkdir()
    part = nested[-1] / "a.json"
    part.write_text(SQUARE)
    assert [one.path for one in list_parts([tmp_path])] == [part]
    # Removing them all at once would take as many calls within each other.
    part.unlink()
    for folder in reversed(nested[1:]):
        folder.rmdir()


def test_a_link_of_another_ending_hides_no_part(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, "z.json")
    (folder / "a.dxf").symlink_to("z.json")
    (folder / "b.json").symlink_to("z.json")
    (folder / "c.JSON").symlink_to("z.json")
    assert names_of(folder) == ["a.dxf", "b.json"]


def test_a_link_to_a_folder_above_is_no_circle(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, "a.json")
    (folder / "up").symlink_to(folder, target_is_directory=True)
    os.link(folder / "a.json", folder / "b.json")
    (folder / "c.json").symlink_to(folder / "a.json")
    # A hard link is a file of its own; a soft one is the file that it leads to.
    assert names_of(folder) == ["a.json", "b.json"]


@pytest.mark.parametrize("name", ["missing.dxf", "a\0b", "n" * 5000])
def test_what_does_not_exist_is_refused(name: str) -> None:
    with pytest.raises(InputError, match="file not found, and no built-in part has that name"):
        list_parts(["widget", name])


def test_a_folder_without_a_drawing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"has no drawing in it: give a folder with \.dxf"):
        list_parts([tmp_path])


def test_a_disk_is_no_list(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_PARTS", 2)
    assert len(list_parts([folder_of(tmp_path, "a.json", "b.json")])) == 2
    with pytest.raises(InputError, match="more than 2 parts"):
        list_parts([folder_of(tmp_path, "c.json")])


def test_a_part_that_cannot_be_read_is_a_sentence(tmp_path: Path) -> None:
    for name, content in (
        ("empty.dxf", b""),
        ("broken.dxf", b"0\nSECTION\n2\nENTITIES\n0\nLINE\n"),
        ("odd.svg", b"<"),
    ):
        (tmp_path / name).write_bytes(content)
        read = read_listed(list_parts([tmp_path / name])[0])
        assert read.loaded is None
        assert read.refusal.startswith(f"{name}: ")
    gone = read_listed(ListedPart("gone", tmp_path / "gone.json"))
    assert gone.loaded is None and "file not found" in gone.refusal


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (
            IndexError("list index out of range"),
            "the file is damaged, or holds what this program cannot read: save it anew",
        ),
        (MemoryError(), "reading it takes more memory than there is: save less in it"),
    ],
)
def test_a_fault_of_a_library_is_a_sentence_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: Exception, words: str
) -> None:
    def broken(path: Path, **options: object) -> None:
        raise error

    monkeypatch.setattr(module, "read_workpiece", broken)
    assert read_listed(ListedPart("a", tmp_path / "a.dxf")).refusal == f"a.dxf: {words}."


def test_reading_takes_its_options(tmp_path: Path) -> None:
    (tmp_path / "a.svg").write_text('<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0H2V1H0Z"/></svg>')
    read = read_listed(list_parts([tmp_path])[0], unit="inch")
    assert read.loaded is not None
    assert read.loaded.workpiece.bounds[2] == pytest.approx(50.8)
