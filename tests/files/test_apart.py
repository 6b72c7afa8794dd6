"""Work in a process of its own: whatever becomes of the process, its starter gets an answer or one sentence."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from attrs import evolve

from workhold.errors import InputError
from workhold.files import apart
from workhold.files.apart import run_apart
from workhold.files.budget import LIMITS
from workhold.files.fork_server import CAN_FORK

# Seconds to wait for what comes at once on a machine that has nothing else to do.
PATIENCE = 120
# A module whose work is what its content says.
MODULE = """
import os, signal, sys, time
from pathlib import Path
from workhold.errors import InputError
def prepare(): pass
def read_as_plain_data(content, **options):
    if content == b"crash": os.kill(os.getpid(), signal.SIGSEGV)
    if content == b"loop":
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        while True: pass
    if content == b"killed": os.kill(os.getpid(), signal.SIGKILL)
    if content == b"hog": return len(bytearray(1 << 40))
    if content == b"refuse": raise InputError("this is refused.")
    if content == b"fault": raise ValueError("a mistake")
    if content == b"noise": os.write(1, b"words of a library")
    if content == b"sleep":
        Path(options["place"]).write_text(str(os.getpid()))
        time.sleep(100)
    return [len(content), options]
"""


@pytest.fixture(
    params=[
        pytest.param(True, marks=pytest.mark.skipif(not CAN_FORK, reason="no process is forked here")),
        False,
    ]
)
def work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> str:
    """A module, on the path of this process only, that does what its content says, in a process forked or started anew."""
    monkeypatch.setattr(apart, "CAN_FORK", request.param)
    (tmp_path / "foreign_work.py").write_text(MODULE)
    monkeypatch.syspath_prepend(tmp_path)
    return "foreign_work"


@pytest.mark.thorough
def test_content_and_options_go_there_and_plain_data_come_back(work: str) -> None:
    """A megabyte passes through the pipes, and what a library prints does not mix with the answer."""
    assert run_apart(work, b"x" * 1_000_000, {"axis": None}, "the file") == [1_000_000, {"axis": None}]
    assert run_apart(work, b"noise", {}, "the file") == [5, {}]


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"crash", "the file is damaged so that the library that reads it breaks down: save it anew."),
        (
            b"loop",
            "the file was given up after 1 s of reading: it is damaged, or holds too much; save less in it.",
        ),
        (
            b"killed",
            "the file ran out of memory while it was read: close other programs, or save less in it.",
        ),
        (b"hog", "the file needs more than 2.7 GB of memory to read: save less in it."),
        (b"refuse", "this is refused."),
    ],
)
def test_every_bad_end_is_one_sentence(
    work: str, monkeypatch: pytest.MonkeyPatch, content: bytes, said: str
) -> None:
    """A crash, an endless loop deaf to SIGTERM, a lack of memory, and a refusal of the work itself."""
    if content == b"loop":
        monkeypatch.setitem(LIMITS, "step", evolve(LIMITS["step"], seconds=0.9))
    with pytest.raises(InputError) as caught:
        run_apart(work, content, {}, "the file")
    assert str(caught.value) == said


def test_one_that_waits_for_ever_is_ended(work: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It takes no processor, so the clock on the wall ends it."""
    monkeypatch.setattr(apart, "WALL_FACTOR", 0.01)
    place = tmp_path / "number"
    with pytest.raises(InputError, match="given up after 12 s"):
        run_apart(work, b"sleep", {"place": str(place)}, "the file")
    wait_until(lambda: not place.exists() or not is_alive(int(place.read_text() or 0)))


@pytest.mark.thorough
def test_to_prepare_takes_its_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The clock of the reading starts behind it; what is refused while it prepares is told."""
    (tmp_path / "slow_work.py").write_text(
        "import time\nprepare = lambda: time.sleep(2)\nread_as_plain_data = lambda content: 1\n"
    )
    wanting = "from workhold.errors import InputError\ndef prepare(): raise InputError('it is missing.')\n"
    (tmp_path / "wanting_work.py").write_text(wanting)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(apart, "WALL_FACTOR", 0.1)
    assert run_apart("slow_work", b"", {}, "the file") == 1
    with pytest.raises(InputError, match="it is missing"):
        run_apart("wanting_work", b"", {}, "the file")


def test_a_mistake_of_the_program_stays_one(work: str) -> None:
    """It is not a fault of the file's, and its traceback is told."""
    with pytest.raises(RuntimeError, match="a mistake"):
        run_apart(work, b"fault", {}, "the file")


@pytest.mark.thorough
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_the_process_ends_with_its_starter(work: str, tmp_path: Path, number: int) -> None:
    """Ctrl-C, SIGTERM and SIGKILL of the starter alone leave no process behind."""
    place = tmp_path / "number"
    script = tmp_path / "starter.py"
    # No ``if __name__ == "__main__"``; who starts the tests may have told their processes to ignore Ctrl-C.
    script.write_text(
        "import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"
        f"from workhold.files import apart\napart.CAN_FORK = {apart.CAN_FORK}\n"
        f"apart.run_apart('foreign_work', b'sleep', {{'place': {str(place)!r}}}, '')"
    )
    starter = subprocess.Popen([sys.executable, script], stderr=subprocess.DEVNULL)
    wait_until(lambda: place.exists() and place.read_text() != "")
    starter.send_signal(number)
    assert starter.wait(PATIENCE) != 0
    wait_until(lambda: not is_alive(int(place.read_text())))


def wait_until(holds) -> None:  # type: ignore[no-untyped-def]
    """Wait until a condition holds."""
    end = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.02)


def is_alive(number: int) -> bool:
    """Whether there is a process of a number that has not ended."""
    try:
        os.kill(number, 0)
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except ProcessLookupError:
        return False
    except FileNotFoundError:
        # Gone meanwhile, or a system that tells no more.
        return not Path("/proc/self/stat").exists()
