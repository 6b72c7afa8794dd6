"""No command writes over what it reads, nor over a file that workhold has not written."""

from __future__ import annotations

import os
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from reading_helpers import RECTANGLE, new_dxf

from fakes import fake_result
from workhold import save
from workhold.cli import design_report
from workhold.errors import InputError
from workhold.files import atomic

VISE = ("--pitch", 10, "--columns", 2, "--peg-radius", 2)
FOREIGN = b"years of work"
# Commands as they are typed in a folder with plate.dxf, r.json and l.toml, without the name of the output.
COMMANDS = {
    "design": ("design", "plate.dxf", *VISE, "--loads", "l.toml", "--out"),
    "features": ("features", "plate.dxf", "--draw"),
    "show": ("show", "r.json", 1, "--draw"),
    "sheet": ("sheet", "r.json", 1, "-o"),
    "explore": ("explore", "plate.dxf", "--vise", "v.toml", "--out"),
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, searched: Any) -> Path:
    """A folder to work in, with a drawing, a result, a vise and loads."""
    document, space = new_dxf()
    space.add_lwpolyline(RECTANGLE, close=True)
    document.saveas(tmp_path / "plate.dxf")
    save(fake_result(3), tmp_path / "r.json")
    (tmp_path / "v.toml").write_text('unit = "mm"\npitch = 10\ncolumns = 2\npeg_radius = 2\n')
    (tmp_path / "l.toml").write_text("[[load]]\nforce = 1\nat = [1, 2]\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("workhold.kernels.base.libraries.is_built", lambda rooms=(): True)
    return tmp_path


@pytest.mark.thinned(3)
@pytest.mark.parametrize(
    ("command", "read"),
    [
        ("design", "plate.dxf"),
        ("design", "l.toml"),
        ("features", "plate.dxf"),
        ("show", "r.json"),
        ("sheet", "r.json"),
        ("explore", "plate.dxf"),
        ("explore", "v.toml"),
    ],
)
@pytest.mark.parametrize("link", [None, os.symlink, os.link], ids=["same name", "symbolic link", "hard link"])
def test_what_is_read_is_not_written_over(run: Any, folder: Path, command: str, read: str, link: Any) -> None:
    """Under its own name and through links, also with --force."""
    before = (folder / read).read_bytes()
    endings = {"features": ".svg", "show": ".svg", "sheet": ".pdf"}
    output = read if link is None and command not in endings else f"out{endings.get(command, '.json')}"
    if output != read:
        (link or os.link)(folder / read, folder / output)
    outcome = run(*COMMANDS[command], output, "--force")
    assert outcome.exit_code == 2
    assert outcome.stderr == f"workhold: error: {output} is also an input: give the output another name.\n"
    assert (folder / read).read_bytes() == before


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("command", "name"),
    [
        ("design", "o.json"),
        ("design", "o.csv"),
        ("features", "o.png"),
        ("features", "o.svg"),
        ("show", "o.svg"),
    ]
    + [("sheet", f"o.{ending}") for ending in ("pdf", "svg", "png", "dxf")],
)
def test_foreign_files_are_kept_and_own_ones_replaced(
    run: Any, folder: Path, command: str, name: str
) -> None:
    """A foreign file stays as it is, until --force is given; then it is a file of workhold's, and may be replaced."""
    (folder / name).write_bytes(FOREIGN)
    outcome = run(*COMMANDS[command], name)
    assert outcome.exit_code == 2
    assert outcome.stderr.endswith(
        f"{name} was not written by workhold: give another name, or --force to replace it.\n"
    )
    assert (folder / name).read_bytes() == FOREIGN
    assert run(*COMMANDS[command], name, "--force").exit_code == 0
    assert (folder / name).read_bytes() != FOREIGN
    assert run(*COMMANDS[command], name).exit_code == 0


def test_a_result_does_not_take_the_name_of_another_kind_of_file(run: Any, folder: Path) -> None:
    """Which is said before anything is searched."""
    for name, *form in (("o.svg",), ("o.stl",), ("o.json", "--format", "csv"), ("o.npz", "--format", "json")):
        outcome = run(*COMMANDS["design"], name, *form)
        assert outcome.exit_code == 2 and "is not the name of such a result file" in outcome.stderr
        assert not (folder / name).exists()


def test_an_empty_file_may_be_replaced(run: Any, folder: Path) -> None:
    """As a program makes it that reserves a name."""
    (folder / "o.svg").write_bytes(b"")
    assert run(*COMMANDS["features"], "o.svg").exit_code == 0


@pytest.mark.thorough
def test_a_folder_of_pictures_keeps_what_is_not_a_picture_of_workhold(
    run: Any, folder: Path, searched: dict[str, Any]
) -> None:
    """A drawing of the user's that has the name of a picture is kept, and so is the part itself."""
    searched["result"] = fake_result(1)
    (folder / "d").mkdir()
    mine = folder / "d" / "fixture-03.svg"
    mine.write_bytes(FOREIGN)
    assert run("design", "plate.dxf", *VISE, "--draw", "d").exit_code == 2
    assert mine.read_bytes() == FOREIGN
    assert run("design", "plate.dxf", *VISE, "--draw", "d", "--force").exit_code == 0
    assert run("design", "plate.dxf", *VISE, "--draw", "d").exit_code == 0
    assert run("design", mine, *VISE, "--draw", "d").exit_code == 2


def test_a_full_disk_leaves_no_half_of_the_pictures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What was written before the disk was full is removed again."""
    svg = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"/>'
    monkeypatch.setattr(import_module("workhold.drawing.render"), "render", lambda svg, ending: b"picture")

    def write(path: Path, content: bytes) -> None:
        if path.name == "b.png":
            raise InputError("No space left on device")
        path.write_bytes(content)

    monkeypatch.setattr(atomic, "write_bytes", write)
    with pytest.raises(InputError):
        design_report.write_pictures({"a": svg, "b": svg}, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_link_that_leads_nowhere_names_the_folder_that_is_missing(run: Any, folder: Path) -> None:
    """Not the folder that the link is in."""
    (folder / "o.svg").symlink_to(folder / "missing" / "o.svg")
    outcome = run(*COMMANDS["features"], "o.svg")
    assert outcome.exit_code == 2 and f"there is no folder {folder / 'missing'}: create it" in outcome.stderr
