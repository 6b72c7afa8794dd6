"""The library that meshes and the reader of STEP files live in one process, whichever is used first."""

from __future__ import annotations

import subprocess
import sys

import pytest

pytest.importorskip("OCP")
pytest.importorskip("ngsolve")

MESH = "from workhold.bending.library import load_elements; load_elements()"
READ = "from OCP.gp import gp_Pnt; from OCP.STEPControl import STEPControl_Reader"


@pytest.mark.parametrize("first, second", [(MESH, READ), (READ, MESH)])
def test_a_process_that_loads_both_ends_well(first: str, second: str) -> None:
    """It has crashed at its end."""
    assert subprocess.run([sys.executable, "-c", f"{first}\n{second}"], check=False).returncode == 0
