"""Whatever is typed where an option takes numbers, the command works or says what is wrong in one sentence."""

from __future__ import annotations

import json
import re
import warnings
from pathlib import Path
from typing import Any

import click
import pytest
from typer.main import get_command
from typer.testing import CliRunner

from fakes import fake_result
from workhold import save
from workhold.cli.main import app

VALUES = ("1e308", "1e400", "nan", "inf", "-1", "0", "", "much", "1e308in", "9" * 400)
PLATE = {"units": "mm", "loops": [[[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]]}
PROGRAM = "G21 G90 G54\nT1 M6\nG0 X-20 Y-20 Z50\nZ-5\nG1 X80 F500\nY60\nX-20\nY-20\nG0 Z50\nM30\n"
TOOLS = "tool,diameter,unit\n1,10,mm\n"
VISE = ("--pitch", "20", "--columns", "2", "--peg-radius", "3")
# What a command is tried with, in the folder of the files above. A batch starts processes each time, and has the options
# of a design and of an exploration.
BASES: dict[str, tuple[str, ...]] = {
    "design": ("plate.json", *VISE, "--best", "1"),
    "show": ("result.json", "1"),
    "seat": ("result.json", "1"),
    "supports": ("result.json", "1", "--thickness", "12"),
    "sheet": ("result.json", "1", "-o", "sheet.svg", "--force"),
    "explore": ("plate.json", *VISE),
    "copies": ("result.json", "1"),
    "family": ("plate.json", *VISE),
    "features": ("plate.json",),
    "program": ("program.nc", "--tools", "tools.csv", "--thickness", "20"),
    "drill": ("-o", "drill.dxf", "--force", "--toolkit", "plate-20mm"),
    "verify": ("result.json",),
    "benchmark": ("list",),
}
# How a verification of made-up fixtures ends, which are refuted.
NOT_PROVEN = "interrupted was\n"
# Options whose words hold numbers, and how these stand in them.
SHAPES = {
    "LENGTH": "{0}", "HEIGHT": "{0}", "N": "{0}", "K": "{0}", "MM": "{0}", "S": "{0}", "SECONDS": "{0}",
    "KW": "{0}", "FORCE": "{0}", "MU": "{0}", "LOSS": "{0}", "LIST": "{0}", "1|2": "{0}",
    "X[,Y]": "{0},{0}", "X,Y": "{0},{0}", "X,Y,Z": "{0},{0},{0}", "LEAST,MOST": "0,{0}", "LOW,HIGH": "0,{0}",
    "LOW:HIGH": "0:{0}", "FROM..TO": "0..{0}", "DISTANCE[,WIDTH/2]": "{0},{0}", "PEG[,FACE]": "{0},{0}",
    "X,Y,LEAST,MOST": "{0},{0},0,{0}", "X,Y;X,Y": "{0},{0};{0},{0}", "FIGURE=VALUE": "tilt={0}",
    "top|bottom|LENGTH": "{0}", "NAME|KC,MC": "{0},{0}", "LOAD": "force={0} at={0},{0}", "ZONE": "{0},{0},{0}",
    "FACES": "{0}", "N|NAME": "{0}", "POINT": "{0},{0}", "PLACE": "{0},{0}",
}  # fmt: skip


def options_of(name: str) -> list[tuple[str, str]]:
    """The options of a command that take numbers, and the shapes of their words."""
    group = get_command(app)
    assert isinstance(group, click.Group) or hasattr(group, "get_command")
    command = group.get_command(click.Context(group), name)  # type: ignore[attr-defined]
    found = []
    for parameter in command.params:
        shape = SHAPES.get(getattr(parameter, "metavar", None) or "")
        if shape is not None and parameter.param_type_name == "option":
            found.append((parameter.opts[-1], shape))
    return found


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The files, in the current folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plate.json").write_text(json.dumps(PLATE))
    (tmp_path / "program.nc").write_text(PROGRAM)
    (tmp_path / "tools.csv").write_text(TOOLS)
    save(fake_result(2), tmp_path / "result.json")
    return tmp_path


def tried(*words: str) -> str:
    """What is wrong with the outcome of a command line; nothing where it is right."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        done: Any = CliRunner().invoke(app, list(words))
    said = done.stderr.strip()
    if done.exit_code == 0 or (done.exit_code == 2 and not said and done.stdout.endswith(NOT_PROVEN)):
        return ""
    lines = [line for line in said.splitlines() if not line.startswith("note: ")]
    if done.exit_code == 2 and len(lines) == 1 and re.match("workhold: error: .{1,1020}[.]$", lines[0]):
        return ""
    return f"{' '.join(words)[:300]!r} ends with {done.exit_code}: {said[-300:]}"


def refuse_faults(name: str, every: int) -> None:
    """Try each option of a command with each word, or with every so many-th of all these."""
    words, wrong, count = BASES[name], [], 0
    for option, shape in options_of(name):
        at = words.index(option) if option in words else len(words)
        base = (*words[:at], *words[at + 2 :])
        for value in VALUES:
            count += 1
            if count % every == 0:
                typed = shape.format(value)
                given = (f"{option}={typed}",) if option.startswith("--") else (option, typed)
                wrong.append(tried(name, *base, *given))
    assert wrong and not any(wrong), "\n".join(filter(None, wrong))


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["features", "program", "show", "drill"])
@pytest.mark.usefixtures("folder")
def test_words_for_numbers_are_used_or_refused_in_one_sentence(name: str) -> None:
    """Every seventh of the commands that do not search, so that each option has one or two of them."""
    refuse_faults(name, 7)


@pytest.mark.prove
@pytest.mark.parametrize("name", BASES)
@pytest.mark.usefixtures("folder")
def test_all_words_for_numbers_are_used_or_refused_in_one_sentence(name: str) -> None:
    """As above, all of them."""
    refuse_faults(name, 1)


@pytest.mark.parametrize("option", ["--thickness", "--peg-length", "--support-height", "--plate-thickness"])
def test_a_length_beyond_any_part_is_refused_where_it_is_typed(folder: Path, option: str) -> None:
    """Before a drawing to scale divides by it."""
    assert (folder / "result.json").exists()
    done = CliRunner().invoke(app, ["sheet", "result.json", "1", "-o", "s.svg", option, "1e308"])
    assert done.exit_code == 2 and f"{option} 1e+308 is beyond 1e+06 mm" in done.stderr
