"""The command ``straps``: its sentences, its tables and its JSON."""

from __future__ import annotations

import json
from typing import Any

import pytest

import workhold
from workhold import Plate, Workpiece
from workhold.files.result.writer import write_result

BLOCK = Workpiece.from_points("block", [(0, 0), (100, 0), (100, 60), (0, 60)])
LOADED = ("--thickness", "25", "--load", "force=300 at=50,30")


@pytest.fixture(scope="module")
def result_file(tmp_path_factory: Any) -> str:
    path = tmp_path_factory.mktemp("straps") / "block.json"
    plate = Plate(pitch=20, peg_radius=3, columns=8, rows=6, clamps=2)
    write_result(workhold.design(BLOCK, plate, best=1), path)
    return str(path)


def test_bolts_heels_push_and_force_are_said(run: Any, result_file: str) -> None:
    outcome = run("straps", result_file, "1", *LOADED, "--strap-force", "1000")
    assert outcome.exit_code == 0, outcome.stderr
    for words in (
        "Locators stand in A2, B1, F1",
        "heels 25.000 mm high",
        "Push the part by hand",
        "loads times 2",
    ):
        assert words in outcome.stdout
    assert "a strap is rated for 1000 N" in outcome.stderr


def test_json_has_what_the_tables_have(run: Any, result_file: str) -> None:
    outcome = run("straps", result_file, "1", *LOADED, "--friction", "tip=0.2,plate=0.2", "--json")
    found = json.loads(outcome.stdout)
    assert found["type"] == "strapped"
    assert len(found["straps"]) == 2
    assert len(found["pegs"]) == 3
    assert found["friction"] == {"tip": 0.2, "plate": 0.2}
    smoother = json.loads(run("straps", result_file, "1", *LOADED, "--json").stdout)
    assert found["quality"]["clamp_needed"] < smoother["quality"]["clamp_needed"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--thickness", "25"), "give one load or more"),
        (LOADED[2:], "the thickness of the part is not known"),
        ((*LOADED, "--count", "5"), "give 1 to 4"),
        ((*LOADED, "--reach", "60:20"), "cannot reach"),
        ((*LOADED, "--friction", "ice=0.1"), "friction of 'ice' is not known"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(
    run: Any, result_file: str, words: tuple[str, ...], said: str
) -> None:
    outcome = run("straps", result_file, "1", *words)
    assert outcome.exit_code != 0
    assert said in " ".join(outcome.stderr.split())
