"""``workhold program``: what was understood of a program, as tables within 80 columns, as JSON and as a picture."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Run = Callable[..., Any]
HAAS = Path(__file__).parent.parent / "data" / "programs" / "haas.nc"


def test_tools_figures_and_what_was_left_out(run: Run) -> None:
    """A row for each tool, the box of the tips, the time, and the notes with their lines."""
    outcome = run("program", HAAS)
    assert outcome.exit_code == 0 and not outcome.stderr
    rows = [line.split() for line in outcome.stdout.splitlines() if line.startswith("T")]
    assert rows[0] == ["T1", "10.000", "flat", "end", "mill", "1", "16", "264", "37", "0:18", "-12.000"]
    assert rows[1] == ["T3", "6.800", "drill", "1", "39", "76", "196", "0:38", "-14.000"]
    for words in (
        "haas.nc: 52 lines in mm, 28 moves.",
        "X -12.000 to 66.000, Y -6.000 to 46.000, Z -14.000 to 15.000 mm; heights are above the program's Z0.",
        "Cutting takes 0:56",
        "Lines 8, 32, 48 and 49: a move to a place of the machine's own",
        "The holder of T1 and T3 is not known",
    ):
        assert words in outcome.stdout


def test_where_it_runs_shifts_what_is_told(run: Run) -> None:
    """The zero and the height, in the unit of the command; heights are then above the part's lower side."""
    placed = run("program", HAAS, "--zero", "1in,0", "--z-zero", "top", "--thickness", "12")
    assert "X 13.400 to 91.400" in placed.stdout and "Z -2.000 to 27.000 mm" in placed.stdout
    assert "above the part's lower side" in placed.stdout
    for option, span in (("bottom", "Z -14.000 to 15.000"), ("3", "Z -11.000 to 18.000")):
        assert span in run("program", HAAS, "--z-zero", option).stdout
    assert "Z -0.5512 to 0.5906 in" in run("program", HAAS, "--unit", "inch").stdout


def test_json_has_the_same(run: Run) -> None:
    """Tools, calls, figures and notes in one object."""
    data = json.loads(run("program", HAAS, "--json").stdout)
    assert data["calls"] == [{"line": 11, "tool": 1}, {"line": 35, "tool": 3}]
    assert (data["lines"], data["moves"], data["skipped"]) == (52, 28, [8, 32, 48, 49])
    assert data["tip"] == {"low": [-12, -6, -14], "high": [66, 46, 15]} and data["written"] == []
    assert data["tools"]["3"]["diameter"] == 6.8 and data["figures"][1]["lowest_cut"] == -14
    assert "pieces" not in data


def test_tools_come_from_a_table(run: Run, tmp_path: Path) -> None:
    """A table counts before the comments; without either, its form is shown."""
    table = tmp_path / "tools.csv"
    table.write_text("tool,diameter,stickout,holder_diameter\n1,12,40,50\n3,7,60,40\n")
    shown = run("program", HAAS, "--tools", table).stdout
    assert "12.000" in shown and "The holder" not in shown and "read in mm like the program" in shown
    bare = tmp_path / "bare.nc"
    bare.write_text(HAAS.read_text().replace("D=", "d "))
    outcome = run("program", bare)
    assert outcome.exit_code == 2 and "calls T1 and T3" in outcome.stderr and "tool.1 = {" in outcome.stderr


def test_a_picture_is_written_once(run: Run, tmp_path: Path) -> None:
    """SVG and PNG; a file that is there already is left alone."""
    for name, first in (("a.svg", b"<?xml"), ("a.png", b"\x89PNG")):
        outcome = run("program", HAAS, "--draw", tmp_path / name)
        assert outcome.exit_code == 0 and outcome.stdout.endswith(f"Written to {tmp_path / name}.\n")
        assert (tmp_path / name).read_bytes().startswith(first)
    (tmp_path / "own.svg").write_text("<svg>mine</svg>")
    outcome = run("program", HAAS, "--draw", tmp_path / "own.svg")
    assert outcome.exit_code == 2 and (tmp_path / "own.svg").read_text() == "<svg>mine</svg>"


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--zero", "5"), "--zero '5' is not a place"),
        (("--zero", "a,5"), "--zero 'a' is not a length"),
        (("--z-zero", "middle"), "--z-zero 'middle' is not a length"),
        (("--thickness", "0"), "not above 0"),
        (("--rapid", "curved"), "--rapid"),
        (("--program-unit", "cm"), "--program-unit"),
        (("--tools", "none.toml"), "none.toml is not a table of tools: there is no file of that name"),
        (("--draw", "a.pdf"), ".svg"),
    ],
)
def test_words_that_mean_nothing_are_refused(run: Run, options: tuple[str, ...], words: str) -> None:
    """Before anything is written."""
    outcome = run("program", HAAS, *options)
    assert outcome.exit_code == 2 and words in outcome.stderr and not outcome.stdout


def test_a_terminal_of_80_columns_holds_it(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """No line is wider, and no number is cut."""
    wide = run("program", HAAS).stdout
    monkeypatch.setenv("COLUMNS", "80")
    narrow = run("program", HAAS).stdout
    assert max(map(len, narrow.splitlines())) <= 80
    numbers = ("10.000", "6.800", "264", "196", "0:38", "-12.000", "-14.000")
    assert all(number in narrow for number in numbers) and "No room" not in narrow
    assert max(map(len, wide.splitlines())) > 80
