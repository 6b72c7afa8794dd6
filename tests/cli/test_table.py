"""Tables: as they are where there is room, and within the width that there is."""

from __future__ import annotations

import os
import termios
from pathlib import Path
from typing import Any

import pytest

from fakes import fake_result
from workhold import save
from workhold.cli.table import Table, find_terminal_width

LONG = "a file name that says what machine, what side and what operation it is for"


def table(spare: int = 0) -> Table:
    """Three columns, the last of them words."""
    made = Table(("name", ">a long heading mm", "what it is"), spare=spare)
    made.add_row("one", "1.5", "a plate with dowel holes every twenty millimetres")
    made.add_row("two", "12.25", "a table")
    made.red.add(1)
    return made


def test_without_a_limit_every_row_is_one_line() -> None:
    """Headings, a rule, and the rows."""
    assert [line.split()[0] for line in table().format_lines()] == ["name", "─" * 76, "one", "two"]


@pytest.mark.parametrize("width", [50, 60, 75, 76, 200])
def test_a_table_is_no_wider_than_there_is_room_and_loses_no_word(width: int) -> None:
    """Headings and the last column take several lines; what is red stays red on all of them."""
    fitted = table().fit_to_width(width)
    lines = [*fitted.headings, *fitted.lines]
    assert max(map(len, lines)) <= width
    words = " ".join(lines).split()
    whole = "name a long heading mm what it is one 1.5 plate twenty millimetres two table"
    assert set(whole.split()) <= set(words)
    assert [fitted.lines[k].split()[0] for k in sorted(fitted.red)] == ["two"]


def test_spare_columns_are_left_out_and_named() -> None:
    """Only where there is no room for them."""
    fitted = table(spare=1).fit_to_width(40)
    said = " ".join(fitted.lines)
    assert "No room for: what it is. A wider terminal" in said and "--json" in said
    assert max(map(len, fitted.lines)) <= 40
    assert "plate" not in " ".join(fitted.lines)
    assert "plate" in " ".join(table(spare=1).fit_to_width(76).lines)


@pytest.mark.parametrize("spare", [0, 1, 3])
@pytest.mark.parametrize("width", [30, 40, 60, 80, 120])
def test_any_table_fits_and_cuts_no_number(width: int, spare: int) -> None:
    """A number is there as a whole or its column is named among those left out."""
    numbers = [f"{10**k + 0.125}" for k in range(1, 9)]
    table = Table(("part", *(f">figure {k} mm" for k in range(8)), "words"), spare=spare)
    table.add_row(LONG, *numbers, LONG)
    table.add_row("short", *reversed(numbers), "x" * 200)
    fitted = table.fit_to_width(width)
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
    fitted = table.fit_to_width(50)
    assert max(map(len, fitted.lines)) <= 50 and "1.5" in fitted.lines[1]
    assert "".join("".join(fitted.lines[1:]).replace("1.5", "").split()) == "part" * 30


def test_without_a_limit_nothing_is_left_out_or_wrapped() -> None:
    """What is piped keeps every column on one line."""
    table = Table(("part", ">figure mm", "words"), spare=2)
    table.add_row(LONG, "1.5", LONG)
    assert len(table.format_lines()) == 3 and table.format_lines()[2].count(LONG) == 2


def test_a_terminal_that_nobody_has_told_its_size_has_no_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    ours, theirs = os.openpty()
    with os.fdopen(theirs, "w") as terminal:
        assert find_terminal_width(terminal) is None
        termios.tcsetwinsize(theirs, (24, 80))
        assert find_terminal_width(terminal) == 80
    os.close(ours)


def test_usual_commands_fit_80_columns(run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The tables of a fixture and of the vises."""
    save(fake_result(12), tmp_path / "r.json")
    monkeypatch.setenv("COLUMNS", "80")
    for words in (("show", tmp_path / "r.json", 1), ("toolkits",), ("features", "widget")):
        outcome = run(*words)
        assert outcome.exit_code == 0, outcome.stderr
        lines = outcome.stdout.splitlines()
        rules = [k for k, line in enumerate(lines) if line.startswith("──")]
        assert rules
        for k in rules:
            end = next((n for n in range(k, len(lines)) if not lines[n].strip()), len(lines))
            assert all(len(line) <= 80 for line in lines[k:end])
