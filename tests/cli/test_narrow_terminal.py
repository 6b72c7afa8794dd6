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


@pytest.mark.thinned(7)
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
