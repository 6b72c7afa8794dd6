"""The command works, or says in one sentence why not, where a machine gives it less than usual."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

INTERRUPTED_AT_START = """
import sys
class Interrupt:
    def find_spec(self, name, path=None, target=None):
        if name == "workhold.cli.commands":
            raise KeyboardInterrupt
sys.meta_path.insert(0, Interrupt())
from workhold.__main__ import run
run()
"""


def features(part: object, prepare: Callable[[], None] | None = None, **changes: str | None) -> Any:
    """Run ``workhold features``, with variables of the environment changed or (None) removed."""
    environment = {name: value for name, value in (os.environ | changes).items() if value is not None}
    return subprocess.run(
        [sys.executable, "-m", "workhold", "features", str(part)],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=prepare,
    )


@pytest.mark.parametrize("home", [None, "/dev/null", "/nowhere/at/all"])
def test_without_a_home_nothing_is_kept_and_nothing_fails(home: str | None) -> None:
    """HOME unset, no folder, or one that cannot be made."""
    done = features("widget", HOME=home, XDG_CACHE_HOME=home, WORKHOLD_CACHE_DIR=None)
    assert (done.returncode, done.stderr) == (0, "")


def test_too_little_memory_is_one_sentence() -> None:
    """With an address space in which the libraries have no place."""
    resource = pytest.importorskip("resource")
    limit = 150 << 20

    def prepare() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

    done = features("widget", prepare)
    assert done.returncode == 2
    assert (
        done.stderr
        == "workhold: error: this needs more memory than there is: close other programs, or raise the limit.\n"
    )


def test_interrupted_while_it_is_loaded_it_leaves_no_traceback() -> None:
    """Ctrl-C in the first half second ends it as it does later."""
    done = subprocess.run([sys.executable, "-c", INTERRUPTED_AT_START], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == "workhold: interrupted; no unfinished file was left behind.\n"


@pytest.mark.parametrize("ending", ["json", "dxf", "svg", "step"])
def test_fifty_million_bytes_are_refused_unread(tmp_path: Path, ending: str) -> None:
    """By the size alone: the file is a hole."""
    path = tmp_path / f"part.{ending}"
    with path.open("wb") as stream:
        stream.truncate(50_000_000)
    done = features(path)
    assert done.returncode == 2 and "the file is larger than 40 MB" in done.stderr and done.stderr.count("\n") == 1


def test_twenty_thousand_segments_are_read_and_one_more_is_not(tmp_path: Path) -> None:
    """The largest part that is taken, as a polygon around a circle."""
    for count, code in ((20_000, 0), (20_001, 2)):
        angles = np.linspace(0, 2 * np.pi, count, endpoint=False)
        loop = [[1e3 * x, 1e3 * y, 0.0] for x, y in zip(np.cos(angles), np.sin(angles), strict=True)]
        path = tmp_path / f"{count}.json"
        path.write_text(json.dumps({"units": "mm", "loops": [loop]}))
        done = features(path)
        assert done.returncode == code, done.stderr
    assert "more than the 20000 this program takes" in done.stderr


def test_names_do_not_steer_the_terminal(tmp_path: Path) -> None:
    """A part whose name clears the screen, sets the window's title and turns the direction of writing."""
    path = tmp_path / "part.json"
    loop = [[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]
    path.write_text(json.dumps({"name": "\x1b[2J\x1b]0;owned\x07\u202eabc\r\n", "units": "mm", "loops": [loop]}))
    done = features(path)
    assert done.returncode == 0
    assert done.stdout.startswith("?[2J?]0;owned??abc") and done.stdout.replace("\n", "").isprintable()
