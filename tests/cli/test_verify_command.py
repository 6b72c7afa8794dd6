"""``workhold verify``."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest

from fakes import fake_result
from workhold import Query, Result, Tolerance, Vise, Workpiece, design, save
from workhold.model.fixture_table import FixtureTable, make_unknown_quality
from workhold.model.search_report import ProofReport
from workhold.statics.effective_error import EffectiveErrors
from workhold.statics.quality import measure_quality


@pytest.fixture(scope="module")
def proven_text(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A result file of a wedge."""
    path = tmp_path_factory.mktemp("wedge") / "r.json"
    wedge = Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
    save(design(wedge, Vise(pitch=15, columns=1, peg_radius=2)), path)
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
    match = re.match(line, outcome.stdout)
    assert match is not None
    assert match[1] == match[2] != "0"
    assert outcome.stderr == ""
    heading, *points = outcome.stdout[match.end() :].splitlines()
    assert heading == "A file alone cannot show this; --complete checks it:"
    told = ("fixtures were left out", "query was wider", "how many", "how much work", "was interrupted")
    assert len(points) == 5 and all(word in point for word, point in zip(told, points, strict=True))
    assert "a smaller gap or contact margin, a larger opening, more rows, fewer restrictions" in points[1]


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
    """What was made up is not a fixture of anything."""
    save(fake_result(9), tmp_path / "r.json")
    outcome = run("verify", tmp_path / "r.json")
    assert outcome.exit_code == 2
    assert outcome.stdout.count("is refuted: ") == 5
    assert "9 fixtures: 0 proven, 9 refuted" in outcome.stdout
    assert run("verify", tmp_path / "r.json", "--list", 2).stdout.count("is refuted: ") == 2
    assert "is refuted: " not in run("verify", tmp_path / "r.json", "--list", 0).stdout


def find_miss_of_exact_test(hair: float) -> Result:
    """One Type II fixture whose second peg touches its face ``hair`` mm from the convex corner at (5, -hair).

    Pegs of radius 5 in whole millimetres touch faces of slope 3/4 and two upright ones: every contact is exact, and the
    forces follow from the balance of the wrenches.
    """
    outline = [[35, -19.5], [35, 25], [7, 21], [1, 13], [5, 8], [5, -hair], [9, -8], [-1, -13], [7, -19]]
    part = Workpiece.from_loops("part", [[[x, y, 0.0] for x, y in outline]])
    vise = Vise(pitch=20, columns=1, peg_radius=5, row_offset=3)
    middle = 2.6 / 5.6
    low = (1 - middle) / (4 / 3 * 0.8 + 0.6)
    force = np.array([[low, middle, low * 4 / 3, 1.0]])
    table = FixtureTable(
        arrangement=np.array([1], np.int8),
        column=np.zeros((1, 4), np.int32),
        row=np.array([[0, 1, 2, 1]], np.int32),
        face=np.array([[7, 4, 2, 0]], np.int32),
        theta=np.zeros(1),
        position=np.array([[0.0, 20.0]]),
        jaw_separation=np.array([40.0]),
        force=force,
        quality=make_unknown_quality((force / force.sum()).min(axis=1)),
    )
    table = attrs.evolve(table, quality=measure_quality(table, part, vise, Tolerance(), ()))
    counts, proof = {"I": 0, "II": 1}, ProofReport(96, 1, 0, 1, 0)
    work = ("chord_curves", "sliding_pairs", "curve_pairs", "crossings_sought", "contacts_examined")
    statistics = {"features": 9} | dict.fromkeys(work, 0)
    query = Query(part, vise)
    least = round(float(EffectiveErrors.from_query(query).compute_errors(table).min()), 9)
    return Result(
        query, table, counts, counts, statistics=statistics, proof=proof, least_effective_error=least
    )


@pytest.mark.parametrize(("hair", "verdict"), [(1e-9, "undecided"), (2e-9, "proven"), (5e-10, "refuted")])
def test_undecided_fixtures_are_no_fault(run: Any, tmp_path: Path, hair: float, verdict: str) -> None:
    """A contact must lie more than 1e-9 mm from a corner. One that lies exactly there, on the very edge of the rule, is
    neither proven nor refuted at any precision; a little to either side it is decided."""
    save(find_miss_of_exact_test(hair), tmp_path / "r.json")
    outcome = run("verify", tmp_path / "r.json")
    counts = {"proven": 0, "refuted": 0, "undecided": 0} | {verdict: 1}
    words = ", ".join(f"{count} {name}" for name, count in counts.items())
    assert f"1 fixture: {words} at {512 if verdict == 'undecided' else 128} bits" in outcome.stdout
    assert outcome.exit_code == (2 if verdict == "refuted" else 0)
    told = f"Fixture 1 is {verdict}: peg 2 touches face 4 exactly at its end."
    assert (told in outcome.stdout) == (verdict != "proven")


@pytest.mark.thorough
def test_a_rectangle_on_the_lattice_is_proven_throughout(run: Any, tmp_path: Path) -> None:
    """Two faces exactly as far apart as two holes: the edges of the rules stand off what drawings meet exactly."""
    rectangle = Workpiece.from_loops("rectangle", [[[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]])
    result = design(rectangle, Vise(pitch=10, columns=2, peg_radius=3))
    save(result, tmp_path / "r.json")
    outcome = run("verify", tmp_path / "r.json")
    assert outcome.exit_code == 0
    count = len(result)
    assert outcome.stdout.startswith(f"{count} fixtures: {count} proven, 0 refuted, 0 undecided at 128 bits")


def test_an_empty_result(run: Any, result_file: Path) -> None:
    def edit(data: dict[str, Any]) -> None:
        none = {"I": 0, "II": 0}
        data.update(fixtures=[], counts=none, found=none, distinct=none)

    outcome = run("verify", edited(result_file, edit))
    assert outcome.exit_code == 2
    assert outcome.stdout.startswith('The file: the note is missing that says "')
    disc = Workpiece.from_loops("disc", [[[20, 0, 1], [-20, 0, 1]]])
    save(design(disc, Vise(pitch=13, columns=2, peg_radius=3)), result_file)
    outcome = run("verify", result_file)
    assert outcome.exit_code == 0
    assert outcome.stdout.startswith("0 fixtures: 0 proven, 0 refuted, 0 undecided")


def test_a_fixture_left_out_with_all_counts_adjusted(run: Any, result_file: Path) -> None:
    """No file shows that; a search does."""

    def edit(data: dict[str, Any]) -> None:
        kind = data["fixtures"].pop(2)["type"]
        for key in ("counts", "found", "distinct"):
            data[key][kind] -= 1

    assert run("verify", result_file, "--complete").exit_code == 0
    edited(result_file, edit)
    assert run("verify", result_file).exit_code == 0
    outcome = run("verify", result_file, "--complete", "--threads", 1)
    assert outcome.exit_code == 2
    assert outcome.stdout.startswith(
        "The file: a search finds 1 fixture that it does not list, the first of them of type "
    )
    assert "A search of the same query was compared with the file." in outcome.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("none.json",), "none.json cannot be read: No such file"),
        ((".",), "is not a file: give a result file"),
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
    assert "Example: workhold verify" in outcome.stdout


@pytest.mark.thorough
def test_nothing_of_the_search_is_loaded(result_file: Path, tmp_path: Path, process: Any) -> None:
    """The proof shares no arithmetic with the search, and the command loads none: only what reading a drawing needs."""
    code = (
        "import sys; from workhold.verification import verify_file; v = verify_file('r.json'); assert v.proven; "
        "print([m for m in sys.modules if m.startswith('workhold.')])"
    )
    outcome = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path, check=True
    )
    room = r"'workhold\.((?:algebra|contact|kernels|listing|proof|search|statics)(?:\.[a-z_.]+)?)'"
    loaded = set(re.findall(room, outcome.stdout))
    rooms = {
        "kernels.base." + name
        for name in ("built", "compiling", "distance", "feature", "lean", "shallow", "sources", "storing")
    }
    assert loaded <= {"kernels", "kernels.base", *rooms}
    assert process("verify", "r.json").returncode == 0
