"""The command works, or says in one sentence why not, where a machine gives it less than usual."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest

import workhold
from fakes import fake_result
from workhold import Workpiece, save
from workhold.cli.main import exit_code
from workhold.model.notes import Remark

pytestmark = pytest.mark.thorough

EXAMPLES = Path(__file__).parents[2] / "examples"
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


@pytest.mark.parametrize("part", ["widget", EXAMPLES / "rectangle.dxf"])
@pytest.mark.parametrize("home", [None, "/dev/null", "/proc/nowhere"])
def test_without_a_home_nothing_is_kept_and_nothing_fails(part: object, home: str | None) -> None:
    """HOME unset, no folder, or one that cannot be made; the library that reads drawings says nothing of it either."""
    done = features(part, HOME=home, XDG_CACHE_HOME=home, WORKHOLD_CACHE_DIR=None)
    assert (done.returncode, done.stderr) == (0, "")


def limited(size: int) -> Callable[[], None]:
    """What gives a process so many bytes of address space."""
    resource = pytest.importorskip("resource")
    return lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size))


@pytest.mark.parametrize(
    ("megabytes", "sentence"),
    [
        (
            60,
            "workhold takes 160 MB of address space, and this process is limited to 60 MB (ulimit -v): raise the limit.",
        ),
        (
            100,
            "workhold takes 160 MB of address space, and this process is limited to 100 MB (ulimit -v): raise the limit.",
        ),
        (
            600,
            "bracket.dxf: compiling the kernels takes 1,000 MB of address space, and this process is limited to "
            "600 MB (ulimit -v): raise the limit, or install a wheel with compiled kernels.",
        ),
    ],
)
def test_too_little_memory_is_one_sentence(megabytes: int, sentence: str, tmp_path: Path) -> None:
    """Where the libraries would end the process by a signal, or with a complaint of their own."""
    to_compile = {"WORKHOLD_KERNELS": "cache", "WORKHOLD_CACHE_DIR": str(tmp_path)}
    done = features(EXAMPLES / "bracket.dxf", limited(megabytes * 10**6), **to_compile)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"workhold: error: {sentence}\n")


def test_more_threads_than_there_is_memory_for_is_one_sentence(tmp_path: Path) -> None:
    """Each takes some megabytes for itself; without room for one the C library would end the process."""
    words = ("design", "widget", "--pitch", "8", "--columns", "2", "--peg-radius", "3", "--threads", "900")
    done = subprocess.run(
        [sys.executable, "-m", "workhold", *words, "--out", tmp_path / "r.json"],
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=limited(1 << 30),
    )
    sentence = (
        "workhold: error: a search in 900 threads takes 7,550 MB of address space, and this process is limited "
        "to 1,074 MB (ulimit -v): ask for fewer."
    )
    assert (done.returncode, done.stderr.splitlines()) == (2, [sentence])
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("error", [MemoryError(), RuntimeError("can't start new thread"), OSError(12, "no")])
def test_where_memory_runs_out_it_is_one_sentence(
    error: Exception, capsys: pytest.CaptureFixture[str]
) -> None:
    def command() -> int:
        raise error

    assert exit_code(command) == 2
    assert capsys.readouterr().err == (
        "workhold: error: this needs more memory than there is: close other programs, use fewer threads, or raise "
        "the limit.\n"
    )


def test_interrupted_while_it_is_loaded_it_leaves_no_traceback() -> None:
    """Ctrl-C in the first half second ends it as it does later."""
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED_AT_START], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == "workhold: interrupted; no unfinished file was left behind.\n"


@pytest.mark.parametrize("ending", ["json", "dxf", "svg", "step"])
def test_fifty_million_bytes_are_refused_unread(tmp_path: Path, ending: str) -> None:
    """By the size alone: the file is a hole."""
    path = tmp_path / f"part.{ending}"
    with path.open("wb") as stream:
        stream.truncate(50_000_000)
    done = features(path)
    assert (
        done.returncode == 2
        and "the file is larger than 40 MB" in done.stderr
        and done.stderr.count("\n") == 1
    )


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
    path.write_text(
        json.dumps({"name": "\x1b[2J\x1b]0;owned\x07\u202eabc\r\n", "units": "mm", "loops": [loop]})
    )
    done = features(path)
    assert done.returncode == 0
    assert done.stdout.startswith("?[2J?]0;owned??abc") and done.stdout.replace("\n", "").isprintable()


def test_a_result_on_the_terminal_does_not_steer_it_and_keeps_its_names(run: Any, tmp_path: Path) -> None:
    """Of C0, DEL, C1, the override of the direction of writing, and what no terminal of another language has."""
    name = "a\x1b[2J\x7f\x9b31m\u202eb\u2028ü"
    result = fake_result(3, notes=(name,))
    part = Workpiece.from_loops(name, result.workpiece.loops)
    save(attrs.evolve(result, query=attrs.evolve(result.query, workpiece=part)), tmp_path / "r.json")
    done = run("convert", tmp_path / "r.json", "-")
    assert done.exit_code == 0, done.stderr
    assert done.stdout.isascii() and done.stdout.replace("\n", "").isprintable()
    (tmp_path / "again.json").write_text(done.stdout)
    again = workhold.open(tmp_path / "again.json")
    assert (again.workpiece.name, again.notes) == (name, (Remark(name),))
