"""The papers of a fixture from Python are those that the command writes."""

from __future__ import annotations

import pickle
from datetime import date
from hashlib import sha256
from pathlib import Path
from typing import Any

import attrs
import pytest
from typer.testing import CliRunner

import workhold
from workhold.cli.main import app
from workhold.errors import InputError

WEDGE = workhold.Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
RESULT = workhold.design(WEDGE, workhold.Vise(pitch=15, columns=1, peg_radius=2))
DAY = date(2026, 3, 31)


@pytest.fixture(scope="module")
def result_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The result in a file."""
    path = tmp_path_factory.mktemp("result") / "wedge.json"
    workhold.save(RESULT, path)
    return path


@pytest.mark.thorough
@pytest.mark.parametrize("ending", ["svg", "pdf", "dxf", "csv"])
def test_papers_are_those_of_the_command(ending: str, result_file: Path, tmp_path: Path) -> None:
    """Byte for byte, with the same wishes; a fixture that went through pickle has the same."""
    theirs = tmp_path / f"theirs.{ending}"
    words = f"--date {DAY} --jaw-force 900 --unit inch --zero centre --clearance 2mm --thickness 8mm --jaw constant".split()
    outcome = CliRunner().invoke(app, ["sheet", str(result_file), "2", "-o", str(theirs), *words])
    assert outcome.exit_code == 0, outcome.stderr
    asked: dict[str, Any] = {"unit": "inch", "zero": "centre", "thickness": 8.0, "clearance": 2.0}
    if ending in ("svg", "pdf"):
        asked |= {"day": DAY, "jaw_force": 900, "jaw": "constant"}
    # A file rounds; what is opened is what the command sees.
    second = workhold.open(result_file)[1]
    for k, fixture in enumerate((second, pickle.loads(pickle.dumps(second)))):
        ours = tmp_path / f"ours{k}.{ending}"
        fixture.save_sheet(ours, result_file=result_file, **asked)
        assert ours.read_bytes() == theirs.read_bytes()


def test_a_sheet_names_a_file_only_where_there_is_one(result_file: Path, tmp_path: Path) -> None:
    RESULT[0].save_sheet(tmp_path / "without.svg", day=DAY)
    RESULT[0].save_sheet(tmp_path / "with.svg", day=DAY, result_file=result_file)
    digest = sha256(result_file.read_bytes()).hexdigest()[:12]
    assert digest in (tmp_path / "with.svg").read_text()
    assert "SHA-256" not in (tmp_path / "without.svg").read_text()


@pytest.mark.parametrize(
    ("path", "asked", "words"),
    [
        ("sheet.txt", {}, "names no kind of setup sheet"),
        ("sheet.svg", {"paper": "a3"}, "the paper cannot be 'a3': choose a4 or letter"),
        ("sheet.svg", {"unit": "ell"}, "Unit 'ell' is not known"),
        ("sheet.svg", {"result_file": "none.json"}, "none.json cannot be read"),
        ("sheet.svg", {"jaw": "soft"}, "soft"),
        ("none/sheet.svg", {}, "cannot be written"),
    ],
)
def test_what_cannot_be_is_told_in_a_sentence(
    path: str, asked: dict[str, Any], words: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=words):
        RESULT[0].save_sheet(tmp_path / path, **asked)


def test_a_fixture_that_was_changed_has_no_sheet(tmp_path: Path) -> None:
    """The sheet would show the one that is listed."""
    changed = attrs.evolve(RESULT[0], travel=RESULT[0].travel + 1)
    with pytest.raises(InputError, match="was changed since it was listed"):
        changed.save_sheet(tmp_path / "sheet.svg")
