"""The scripts of ``make bench`` run to their end: hours into it would be late to learn that one does not."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.thorough

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
# Those that take long in the smallest part of them, and those that need a browser, have no test.
SHORT = (
    "table_one",
    "growth",
    "floor",
    "threads",
    "many",
    "toolkits",
    "pruning",
    "seating",
    "solids",
    "batch_queue",
    "batch_estimate",
    "batch_simulation",
)


@pytest.mark.prove
@pytest.mark.parametrize("name", SHORT)
def test_a_quick_trial_of_a_section_ends_well(name: str) -> None:
    """Whatever its figures are, it prints them; a quick trial keeps none."""
    command = [sys.executable, BENCHMARKS / f"{name}.py", "--quick"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "target" in done.stdout or name == "solids", done.stdout
