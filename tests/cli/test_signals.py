"""Ctrl-C and SIGTERM end every long command soon, at whatever stage they come; run by make prove."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from importlib.util import find_spec
from math import cos, pi, sin
from pathlib import Path

import pytest

pytestmark = pytest.mark.prove

VISE = ("--pitch", "5", "--columns", "4", "--peg-radius", "2")
COMMANDS = {
    "design": ("design", "flange", *VISE),
    "set-up of a gear": ("design", "gear.json", *VISE),
    "algebra": ("design", "flange", *VISE, "--engine", "algebra"),
    "explore": ("explore", "flange", "--pitch", "4,5,6", "--columns", "2,4,6", "--peg-radius", "1.5,2"),
    "verify": ("verify", "flange.npz"),
    "bend": ("bend", "flange.npz", "--thickness", "8"),
}
# Seconds: the program promises two, to which a busy machine may add.
MOST = 30
# Seconds after which Ctrl-C is pressed again.
PATIENCE = 3
TEETH = 100


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a gear, whose chords take a while to set up, and a result of many fixtures."""
    made = tmp_path_factory.mktemp("signals")
    corners = [
        (50 + 4 * (k % 4 in (1, 2)), 2 * pi * (k + (0.4 if k % 2 else 0)) / (4 * TEETH))
        for k in range(4 * TEETH)
    ]
    loop = [[radius * cos(angle), radius * sin(angle), 0.0] for radius, angle in corners]
    (made / "gear.json").write_text(json.dumps({"units": "mm", "loops": [loop]}))
    arguments = ["design", "flange", *VISE, "--out", "flange.npz"]
    subprocess.run([sys.executable, "-m", "workhold", *arguments], cwd=made, check=True, capture_output=True)
    return made


@pytest.fixture
def started(folder: Path, request: pytest.FixtureRequest) -> Iterator[subprocess.Popen[str]]:
    """A command in a process of its own, which is not left behind."""
    if request.param == "bend" and not find_spec("ngsolve"):
        pytest.skip("the extra 'bending' is not installed")
    with subprocess.Popen(
        [sys.executable, "-m", "workhold", *COMMANDS[request.param]],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        yield process
        process.kill()


def wait_until_it_listens(process: subprocess.Popen[str]) -> None:
    """Wait until a process catches SIGTERM: before, while Python itself is loaded, nobody can."""
    while process.poll() is None:
        caught = re.search(r"^SigCgt:\s*(\w+)", Path(f"/proc/{process.pid}/status").read_text(), re.MULTILINE)
        if caught and int(caught[1], 16) >> (signal.SIGTERM - 1) & 1:
            return
        time.sleep(0.01)


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs Linux's /proc")
@pytest.mark.parametrize("seconds", [0.5, 3.0])
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
@pytest.mark.parametrize("started", COMMANDS, indirect=True)
def test_a_signal_ends_the_command(
    started: subprocess.Popen[str], number: signal.Signals, code: int, seconds: float, folder: Path
) -> None:
    """With its code and no traceback, and no file beside those there were; a command may be done before, and Ctrl-C twice
    ends one that hands over what it has found."""
    before = sorted(folder.iterdir())
    wait_until_it_listens(started)
    time.sleep(seconds)
    done = started.poll() is not None
    started.send_signal(number)
    if number == signal.SIGINT:
        # What was found may be handed over for any time, until one is told again.
        with suppress(subprocess.TimeoutExpired):
            started.wait(PATIENCE)
        started.send_signal(number)
    _, error = started.communicate(timeout=MOST)
    # A signal that comes while Python clears up after all is done has nothing to end.
    assert started.returncode == code or (started.returncode == 0 and (done or seconds > 1)), error
    assert "Traceback" not in error and "fault" not in error
    assert sorted(folder.iterdir()) == before
