"""What a terminal of 80 columns shows of every command: no line is wider, and no number is cut."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

from fakes import fake_result
from workhold import save
from workhold.cli.commands import print_remark
from workhold.cli.main import COMMANDS
from workhold.cli.table import Table

LONG = "a file name that says what machine, what side and what operation it is for"
SEARCHES = {
    "toolkits": ("toolkits",),
    "toolkits of a fence": ("toolkits", "fence-20mm"),
    "toolkits in inches": ("toolkits", "--unit", "inch"),
    "parts": ("parts",),
    "schema": ("schema",),
    "features": ("features", "flange"),
    "show": ("show", "r.json", "1"),
    "show with a load": (
        "show",
        "r.json",
        "1",
        "--load",
        "force=200 at=10,5 direction=30..60",
        "--friction",
        "0.2",
    ),
    "explore": ("explore", "widget", "--vise", "plate-20mm,fence-20mm"),
    "explore two clamps": ("explore", "widget", "--vise", "two-clamp-plate-20mm", "--clamp-radius", "3,5"),
    "design with two clamps": ("design", "widget", "--vise", "two-clamp-plate-20mm", "--best", "3"),
    "design with none": ("design", "widget", "--pitch", "60", "--columns", "1", "--peg-radius", "1"),
    "batch": ("batch", "widget", "--toolkit", "plate-20mm", "--out", "batch"),
    "family": ("family", "widget", "flange", "--vise", "plate-20mm", "--setups", "2"),
}


def widest(text: str) -> int:
    """The letters of the longest line."""
    return max(map(len, text.splitlines()), default=0)


@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_a_help_fits_80_columns_and_breaks_no_option(run: Any, command: str) -> None:
    """Lines may end after a word, but not within the name of an option."""
    outcome = run(*filter(None, (command,)), "--help")
    assert outcome.exit_code == 0 and ("Example" in outcome.stdout or not command)
    assert widest(outcome.stdout) <= 80
    assert not [line for line in outcome.stdout.splitlines() if line.rstrip().endswith("-")]


@pytest.mark.parametrize("case", SEARCHES)
def test_what_a_command_prints_fits_80_columns(
    run: Any, case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Tables and sentences; no text is cut with an ellipsis."""
    monkeypatch.chdir(tmp_path)
    save(fake_result(12), tmp_path / "r.json")
    monkeypatch.setenv("COLUMNS", "80")
    outcome = run(*SEARCHES[case])
    assert outcome.exit_code == 0, outcome.stderr
    assert outcome.stdout and widest(outcome.stdout) <= 80
    assert "…" not in outcome.stdout


@pytest.mark.parametrize("spare", [0, 1, 3])
@pytest.mark.parametrize("width", [30, 40, 60, 80, 120])
def test_any_table_fits_and_cuts_no_number(width: int, spare: int) -> None:
    """A number is there as a whole or its column is named among those left out."""
    numbers = [f"{10**k + 0.125}" for k in range(1, 9)]
    table = Table(("part", *(f">figure {k} mm" for k in range(8)), "words"), spare=spare)
    table.add_row(LONG, *numbers, LONG)
    table.add_row("short", *reversed(numbers), "x" * 200)
    fitted = table.fitted(width)
    lines = [*fitted.headings, *fitted.lines]
    assert max(map(len, lines)) <= width
    said = " ".join(" ".join(lines).split())
    for k, number in enumerate(numbers):
        assert number in said.split() or f"figure {k} mm," in said
    assert set(LONG.split()) <= set(said.split())


def test_a_word_wider_than_the_terminal_is_broken_and_keeps_its_letters() -> None:
    """As the name of a file without blanks may be."""
    table = Table(("file", ">figure mm"))
    table.add_row("part" * 30, "1.5")
    fitted = table.fitted(50)
    assert max(map(len, fitted.lines)) <= 50 and "1.5" in fitted.lines[1]
    assert "".join("".join(fitted.lines[1:]).replace("1.5", "").split()) == "part" * 30


def test_without_a_limit_nothing_is_left_out_or_wrapped() -> None:
    """What is piped keeps every column on one line."""
    table = Table(("part", ">figure mm", "words"), spare=2)
    table.add_row(LONG, "1.5", LONG)
    assert len(table.lines()) == 3 and table.lines()[2].count(LONG) == 2


def test_a_remark_is_wrapped_on_a_terminal_alone(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Other programs get one line."""
    monkeypatch.setenv("COLUMNS", "80")
    print_remark(LONG * 3)
    assert capsys.readouterr().err.count("\n") == 1
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    print_remark(" ".join([LONG] * 3))
    said = capsys.readouterr().err
    assert widest(said) <= 80 and said.split() == ["workhold:", *LONG.split() * 3]
