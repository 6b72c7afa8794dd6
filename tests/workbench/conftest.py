"""Scripts that run in FreeCAD, with the workbench of this folder and a command ``workhold`` of its own."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from warm_command import script, warm_command
from workbench.scripts import Scripted

ROOT = Path(__file__).parents[2]
# What every script begins with: two parts, one on the other, away from the origin.
HEAD = f"""
import json, sys
sys.path.insert(0, {str(ROOT / "freecad")!r})
import FreeCAD as App, Part
from workhold_workbench import child, fixture, solid
child.use("WORKHOLD")
document = App.newDocument("held")
block = document.addObject("Part::Box", "Block")
block.Length, block.Width, block.Height = 60, 40, 12
block.Placement.Base = App.Vector(100, 20, 5)
document.recompute()

def answered(**values):
    with open("ANSWER", "w") as stream:
        json.dump(values, stream)

def shared(held):
    # The volume in mm3 that each body has in common with the part.
    bodies = [(one.Label, one.Shape) for one in held.Group]
    part = solid.shape_of(held.HeldPart)
    return {{label: round(shape.common(part).Volume, 6) for label, shape in bodies}}

def said_by(work):
    try:
        return work()
    except child.Refusal as refusal:
        return "refused: " + str(refusal)

def marks(held):
    # Kind, directions and holes of the fixture that stands in the document, and how the part is turned.
    holes, angle = json.loads(held.Marks)
    return [holes, round(angle)]

def distances(held):
    return {{one.Label: round(one.Shape.distToShape(held.HeldPart.Shape)[0], 6) for one in held.Group}}
"""


PATH = os.pathsep.join(entry for entry in sys.path if entry)
# Its own home, where the kernels are kept that were compiled before.
OWN = {"HOME": str(Path.home()), "PYTHONPATH": PATH}


@pytest.fixture(scope="session")
def warm(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The command as a script that does not have to load anything."""
    if shutil.which("freecadcmd") is None:
        pytest.skip("freecadcmd is not installed")
    pytest.importorskip("OCP", reason="the extra 'step' is not installed")
    with warm_command(tmp_path_factory.mktemp("warm")) as address:
        yield script(address, **OWN)


@pytest.fixture
def scripted(warm: str, tmp_path: Path) -> Scripted:
    """Runs a script in FreeCAD, and returns what it answers."""
    return running_scripts(warm, tmp_path)


@pytest.fixture
def scripted_as_installed(tmp_path: Path) -> Scripted:
    """The same with a command that starts as a user's does."""
    pytest.importorskip("OCP", reason="the extra 'step' is not installed")
    given = " ".join(f"{name}={shlex.quote(value)}" for name, value in OWN.items())
    run = shlex.join([sys.executable, "-m", "workhold"])
    return running_scripts(f'#!/bin/sh\n{given} exec {run} "$@"\n', tmp_path)


def running_scripts(text: str, tmp_path: Path) -> Scripted:
    """What runs scripts in FreeCAD, in a folder with a command of its own."""
    command = tmp_path / "workhold"
    command.write_text(text)
    command.chmod(0o755)

    def ran(code: str, program: tuple[str, ...] = ("freecadcmd",), **environment: str) -> dict[str, Any]:
        if shutil.which(program[0]) is None:
            pytest.skip(f"{program[0]} is not installed")
        script = tmp_path / "script.py"
        head = HEAD.replace("WORKHOLD", str(command)).replace("ANSWER", str(tmp_path / "answer.json"))
        script.write_text(head + code)
        own = {**os.environ, "HOME": str(tmp_path), **environment}
        own.pop("PYTHONPATH", None)
        outcome = subprocess.run(
            [*program, str(script)],
            cwd=tmp_path,
            env=own,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
        answer = tmp_path / "answer.json"
        assert answer.exists(), outcome.stdout[-3000:] + outcome.stderr[-3000:]
        values: dict[str, Any] = json.loads(answer.read_text())
        return values

    return ran
