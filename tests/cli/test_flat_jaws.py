"""A plain vise at the commands for many parts and many toolkits: compared where it can be, refused in a sentence."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
RECTANGLE, BRACKET = (str(EXAMPLES / name) for name in ("rectangle.dxf", "bracket.dxf"))


def test_plain_vises_are_compared_by_their_own_figures(run: Any) -> None:
    """The first choice is one of them, with the area that its jaws touch."""
    outcome = run("explore", RECTANGLE, "--toolkit", "plain-vise")
    assert outcome.exit_code == 0, outcome.stderr
    assert "contact area" in outcome.stdout
    assert "First choice: plain-vise-" in outcome.stdout
    assert "its first fixture has contact area" in outcome.stdout


def test_a_batch_has_plain_vises_beside_others(run: Any, tmp_path: Any) -> None:
    """Their rows have no holes, and the faces that both jaws touch."""
    folder = tmp_path / "all"
    words = ("--toolkit", "plain-vise-6-inch,table-50mm", "--out", str(folder))
    outcome = run("batch", RECTANGLE, *words)
    assert outcome.exit_code == 0, outcome.stderr
    assert "2 jobs" in outcome.stdout + outcome.stderr


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("family", "a plain vise has no holes to keep pegs in"),
        ("copies", "a plain vise holds one part"),
        ("seat", "the seating is worked out only for round pegs"),
    ],
)
def test_what_is_of_pegs_is_refused_in_a_sentence(
    command: str, message: str, run: Any, tmp_path: Any
) -> None:
    if command == "family":
        outcome = run(command, RECTANGLE, BRACKET, "--toolkit", "plain-vise-6-inch")
    else:
        path = tmp_path / "result.json"
        made = run("design", RECTANGLE, "--toolkit", "plain-vise-6-inch", "--out", str(path))
        assert made.exit_code == 0, made.stderr
        more = ("--columns", "5", "--rows", "5") if command == "copies" else ()
        outcome = run(command, str(path), "1", *more)
    assert outcome.exit_code == 2
    assert message in outcome.stderr
