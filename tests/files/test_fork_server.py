"""A process kept ready forks one for each piece of work: what it has loaded is there, and nothing else is shared."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from workhold.errors import InputError
from workhold.files import fork_server
from workhold.files.apart import run_apart

pytestmark = pytest.mark.thorough

if not fork_server.CAN_FORK:
    pytest.skip("no process is forked here", allow_module_level=True)

# Seconds to wait for what comes at once on a machine that has nothing else to do.
PATIENCE = 120
# Its answer: the processes that loaded it and that work, what an earlier piece of work left, and the surroundings.
MODULE = """
import os, pathlib, time
LOADED_BY, LEFT = os.getpid(), []
def prepare(): pass
def read_as_plain_data(content):
    if content == b"crash": os.abort()
    if content: pathlib.Path(content.decode() + "-begun").touch()
    while content and not pathlib.Path(content.decode()).exists(): time.sleep(0.02)
    LEFT.append(1)
    return LOADED_BY, os.getpid(), len(LEFT), os.environ.get("SAID_BESIDE"), sum(1 for _ in os.scandir("/proc/self/fd"))
"""


@pytest.fixture(autouse=True)
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A module that says where it was loaded and where it works, on the path of this process only."""
    (tmp_path / "saying_where.py").write_text(MODULE)
    monkeypatch.syspath_prepend(tmp_path)


def said(content: bytes = b"") -> tuple[int, int, int, str | None, int]:
    """What the module answers."""
    return tuple(run_apart("saying_where", content, {}, "the file"))


def test_each_piece_of_work_has_a_process_of_its_own_with_what_is_loaded() -> None:
    """A crash between takes nothing along, and no stream of another is left open."""
    first = said()
    with pytest.raises(InputError, match="breaks down"):
        said(b"crash")
    other = said()
    assert first[0] == other[0] == fork_server.SERVERS[0].process.pid
    assert len({first[0], first[1], other[1]}) == 3
    assert first[2:] == other[2:] == (1, None, other[4])


def test_a_server_that_was_ended_is_started_again() -> None:
    """By Ctrl-C in a terminal, say, which reaches it too, or for want of work."""
    first = said()
    os.kill(first[0], signal.SIGKILL)
    fork_server.SERVERS[0].process.wait()
    assert first[0] != said()[0] == fork_server.SERVERS[0].process.pid


def test_work_goes_on_where_its_server_ended(tmp_path: Path) -> None:
    """The next piece of work finds out that the server has ended, though the one that it forked is still at work."""
    end = tmp_path / "end"
    with ThreadPoolExecutor(1) as pool:
        first = pool.submit(said, bytes(end))
        while not (tmp_path / "end-begun").exists():
            time.sleep(0.02)
        fork_server.SERVERS[0].process.kill()
        fork_server.SERVERS[0].process.wait()
        other = said()
        end.write_text("")
        assert first.result()[0] != other[0]


def test_what_cannot_be_loaded_ends_no_server(tmp_path: Path) -> None:
    """The process that was forked for it says why."""
    wanting = "from workhold.errors import InputError\ndef prepare(): raise InputError('it is missing.')\n"
    (tmp_path / "wanting_too.py").write_text(wanting)
    first = said()
    with pytest.raises(InputError, match="it is missing"):
        run_apart("wanting_too", b"", {}, "the file")
    assert said()[0] == first[0]


def test_one_of_other_surroundings_is_not_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the environment says now is what the work finds; the server of before ends."""
    first, process = said(), fork_server.SERVERS[0].process
    monkeypatch.setenv("SAID_BESIDE", "yes")
    other = said()
    assert (first[3], other[3]) == (None, "yes") and first[0] != other[0] and process.returncode is not None


def test_a_process_that_was_forked_has_its_own() -> None:
    """It neither asks its parent's server nor ends it."""
    first = said()
    number = os.fork()
    if number == 0:
        alone = False
        try:
            alone = said()[0] != first[0]
            fork_server.end_servers()
        finally:
            os._exit(0 if alone else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(number, 0)[1]) == 0
    assert said()[0] == first[0]


@pytest.mark.parametrize("is_closed", [True, False])
def test_it_ends_with_its_starter_and_where_nobody_asks(is_closed: bool) -> None:
    """It waits as long as it is told where its line stays open, and no longer."""
    seconds = 1000 if is_closed else 0.1
    ours, its = socket.socketpair()
    code = f"from workhold.files import fork_server as f; f.IDLE_SECONDS = {seconds}; f.serve(print, print)"
    with subprocess.Popen([sys.executable, "-c", code], stdin=its) as process:
        its.close()
        if is_closed:
            ours.close()
        assert process.wait(PATIENCE) == 0
    ours.close()


def test_one_that_never_starts_is_asked_twice_only() -> None:
    """Then each piece of work is started as where nothing can be forked."""
    assert fork_server.fork_from_server("saying_where", [sys.executable, "-c", "pass"]) is None
    assert fork_server.SERVERS == []
