"""``holdfast verify``."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from fakes import fake_result
from holdfast import Vise, Workpiece, design
from holdfast.files.result_file import write_result


@pytest.fixture(scope="module")
def proven_text(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A result file of a wedge."""
    path = tmp_path_factory.mktemp("wedge") / "r.json"
    wedge = Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
    write_result(design(wedge, Vise(pitch=15, columns=1, peg_radius=2)), path)
    return path.read_text()


@pytest.fixture
def result_file(proven_text: str, tmp_path: Path) -> Path:
    """That file, to be edited."""
    path = tmp_path / "r.json"
    path.write_text(proven_text)
    return path


def edited(path: Path, edit: Callable[[dict[str, Any]], object]) -> Path:
    """Edit the JSON of a file in place."""
    data = json.loads(path.read_text())
    edit(data)
    path.write_text(json.dumps(data))
    return path


def test_a_proven_result_in_one_line(run: Any, result_file: Path) -> None:
    outcome = run("verify", result_file)
    assert outcome.exit_code == 0, outcome.stderr
    line = r"(\d+) fixtures: (\d+) proven, 0 refuted, 0 undecided at 128 bits; \d+\.\d s\n"
    match = re.fullmatch(line, outcome.stdout)
    assert match is not None
    assert match[1] == match[2] != "0"
    assert outcome.stderr == ""


def test_refuted_fixtures_end_with_exit_code_2(run: Any, result_file: Path) -> None:
    def edit(data: dict[str, Any]) -> None:
        data["fixtures"][1]["pegs"][0]["row"] += 7
        data["counts"]["I"] += 1

    outcome = run("verify", edited(result_file, edit))
    assert outcome.exit_code == 2
    lines = outcome.stdout.splitlines()
    assert lines[0].startswith("The file: counts say ")
    assert lines[1].startswith("Fixture 2 is refuted: the y of peg 1 is 105 mm from that of its hole.")
    assert ", 1 refuted, 0 undecided" in lines[2]
    assert outcome.stderr == ""


def test_only_the_first_are_listed(run: Any, tmp_path: Path) -> None:
    """What was made up is no fixture of anything."""
    write_result(fake_result(9), tmp_path / "r.json")
    outcome = run("verify", tmp_path / "r.json")
    assert outcome.exit_code == 2
    assert outcome.stdout.count("is refuted: ") == 5
    assert "9 fixtures: 0 proven, 9 refuted" in outcome.stdout
    assert run("verify", tmp_path / "r.json", "--list", 2).stdout.count("is refuted: ") == 2
    assert "is refuted: " not in run("verify", tmp_path / "r.json", "--list", 0).stdout


def test_undecided_fixtures_are_no_fault(run: Any, tmp_path: Path) -> None:
    rectangle = Workpiece.from_loops("rectangle", [[[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]])
    write_result(design(rectangle, Vise(pitch=10, columns=2, peg_radius=3)), tmp_path / "r.json")
    outcome = run("verify", tmp_path / "r.json")
    assert outcome.exit_code == 0
    assert "is undecided: the jaw separation is exactly the smallest gap." in outcome.stdout


def test_an_empty_result(run: Any, result_file: Path) -> None:
    def edit(data: dict[str, Any]) -> None:
        none = {"I": 0, "II": 0}
        data.update(fixtures=[], counts=none, found=none, distinct=none)

    outcome = run("verify", edited(result_file, edit))
    assert outcome.exit_code == 0
    assert outcome.stdout.startswith("0 fixtures: 0 proven, 0 refuted, 0 undecided")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("none.json",), "none.json cannot be read: No such file"),
        ((".",), "cannot be read: Is a directory"),
        (("r.json", "--list", "all"), "--list 'all' is not a whole number"),
        ((), "Missing argument 'RESULT'"),
    ],
)
def test_refusals(
    run: Any, result_file: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], message: str
) -> None:
    monkeypatch.chdir(result_file.parent)
    outcome = run("verify", *arguments)
    assert outcome.exit_code == 2
    assert message in outcome.stderr
    assert outcome.stderr.count("\n") == 1
    assert outcome.stdout == ""


def test_help(run: Any) -> None:
    outcome = run("verify", "--help")
    assert outcome.exit_code == 0
    assert "Example: holdfast verify" in outcome.stdout


def test_nothing_of_the_search_is_loaded(result_file: Path, tmp_path: Path, process: Any) -> None:
    """The proof shares no solver with the search, and the command loads none of it."""
    code = (
        "import sys; from holdfast.verification import verify_file; v = verify_file('r.json'); assert v.proven; "
        "print([m for m in sys.modules if m.startswith(('holdfast.search', 'holdfast.kernels', 'holdfast.contact'))])"
    )
    outcome = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path, check=True)
    loaded = set(re.findall(r"'([^']+)'", outcome.stdout))
    assert loaded <= {"holdfast.kernels", "holdfast.kernels.compiling", "holdfast.kernels.distance"}
    assert process("verify", "r.json").returncode == 0
