"""Sentences of the readers speak the language of whoever asks: options, fields of the page, or arguments in Python."""

from __future__ import annotations

import ast
import re
from inspect import signature
from pathlib import Path

import pytest
from typer.testing import CliRunner

import workhold
from workhold import load
from workhold.cli.main import app
from workhold.cli.options import CALLED as ON_THE_COMMAND_LINE
from workhold.files import questions
from workhold.files.part.load import read_workpiece
from workhold.files.questions import name_questions
from workhold.web.part_tasks import CALLED as ON_THE_PAGE
from workhold.web.part_tasks import UploadedPart, read_part

SOURCE = Path(workhold.__file__).parent
# Where the tip starts is asked by programs, which name it themselves.
MARKS = [
    value
    for name in questions.__all__
    if isinstance(value := getattr(questions, name), str) and value != questions.START
]
FLAG = re.compile(r"(?<![\w-])--[a-z]")
OF_OPTIONS = {"spelled", "typed"}
# Serving is a command alone, and pip's own option is not a word of ours.
# The report of many parts is written by a command, and has the command for each sheet.
OWN = ("web/serve.py", "files/step/library.py", "batch/report.py")
TWO_SQUARES = b"""<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="40mm" viewBox="0 0 90 40">
<path d="M0 0h40v40h-40z"/><path d="M60 0h20v20h-20z"/></svg>"""


@pytest.mark.thorough
def test_nothing_but_the_command_line_names_a_flag() -> None:
    """No text outside the commands holds one, but for descriptions of code and what a declaration says of its option."""
    for path in SOURCE.rglob("*.py"):
        place = path.relative_to(SOURCE).as_posix()
        # A file of the data is a program that stands by itself, with a command line of its own.
        if place.startswith(("cli/", "data/")) or place in OWN:
            continue
        tree = ast.parse(path.read_text(encoding="utf-8"))
        described = {
            id(part)
            for node in ast.walk(tree)
            if isinstance(node, ast.Expr) or (isinstance(node, ast.keyword) and node.arg in OF_OPTIONS)
            for part in ast.walk(node.value)
        }
        for node in ast.walk(tree):
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in described:
                assert not FLAG.search(node.value), f"{place}:{node.lineno}: {node.value}"


@pytest.mark.parametrize("called", [ON_THE_COMMAND_LINE, ON_THE_PAGE], ids=["command line", "page"])
def test_every_question_has_a_name(called: dict[str, str]) -> None:
    """No mark is left in a sentence, and no name is without a question."""
    assert {f"<{name}>" for name in called} == set(MARKS)
    assert "<" not in name_questions(" ".join(MARKS), called)


def test_names_are_those_of_options_and_arguments() -> None:
    """Whoever reads a name finds it in the help of each command that reads a part, or in the signature in Python."""
    for command in ("design", "explore", "features"):
        text = CliRunner().invoke(app, [command, "--help"]).output
        # Heights of a toolkit's own are not a question about the part.
        options = [name for name in ON_THE_COMMAND_LINE.values() if name.startswith("--")]
        assert len(options) == len(MARKS) - 1
        assert all(re.search(rf"  {name} ", text) for name in options)
    assert {name_questions(mark, None) for mark in MARKS} < set(signature(load).parameters)


def test_one_remark_in_three_languages(tmp_path: Path) -> None:
    """A drawing of two parts asks which one, and a part of a file that has no layers is asked for by one."""
    path = tmp_path / "two.svg"
    path.write_bytes(TWO_SQUARES)
    assert "choose another with part_number" in read_workpiece(path).remarks[-1]
    assert "choose another with --part" in CliRunner().invoke(app, ["features", str(path)]).output
    answer = read_part(UploadedPart(TWO_SQUARES, "two.svg", 100, {}), None)  # type: ignore[arg-type]
    assert "choose another with the part number" in answer["remarks"][-1]
    with pytest.raises(workhold.InputError, match="leave layers out"):
        load(path, layers=["cut"])
    assert "leave --layer out" in CliRunner().invoke(app, ["features", str(path), "--layer", "cut"]).output
