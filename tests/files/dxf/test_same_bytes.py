"""A drawing for a machine is the same file in every process, however Python orders its sets there."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.thorough

SRC = Path(__file__).parents[3] / "src"
PLATES = """
import sys
from workhold import Vise
from workhold.files.dxf.writer import make_plates_dxf
from workhold.model.dowels import list_jaw_plates
sys.stdout.buffer.write(make_plates_dxf(list_jaw_plates(Vise(pitch=20, columns=2, peg_radius=3, rows=3))))
"""


def drawn(seed: int) -> bytes:
    """The drill template of a vise's plates, made in a process of its own."""
    environment = {**os.environ, "PYTHONHASHSEED": str(seed), "PYTHONPATH": str(SRC)}
    return subprocess.run(
        [sys.executable, "-c", PLATES], env=environment, capture_output=True, check=True
    ).stdout


@pytest.mark.parametrize("seed", [4])
def test_a_drill_template_does_not_depend_on_the_seed_of_hashes(seed: int) -> None:
    """The seed is one with which classes came in another order."""
    assert drawn(seed) == drawn(0) != b""
