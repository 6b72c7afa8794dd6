"""``workhold serve`` as a process."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import httpx
import pytest
from running_server import PATIENCE

from workhold.cli.main import app
from workhold.cli.serving_commands import FIRST_RUN

COMMAND = [sys.executable, "-m", "workhold", "serve"]


def is_alive(pid: int) -> bool:
    """Whether a process runs."""
    try:
        return "Z" not in Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False


@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGKILL])
def test_it_serves_and_leaves_nothing_behind(ending: signal.Signals) -> None:
    environment = {**os.environ, "WORKHOLD_SECONDS": "77"}
    process = subprocess.Popen(
        [*COMMAND, "--port", "0"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    )
    assert process.stdout is not None and process.stderr is not None
    line = process.stdout.readline()
    found = re.search(r"http://127\.0\.0\.1:\d+/", line)
    assert found, line + process.stderr.read()
    about = httpx.get(f"{found[0]}api/about", timeout=PATIENCE).json()
    assert about["limits"]["seconds"] == 77.0
    children = [
        int(pid) for pid in Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    ]
    assert children
    process.send_signal(ending)
    assert process.wait(PATIENCE) == {signal.SIGINT: 0, signal.SIGKILL: -signal.SIGKILL}[ending]
    if ending != signal.SIGKILL:
        # Kernels that no test has compiled yet are compiled now.
        assert process.stderr.read() in ("", f"{FIRST_RUN}\n")
    end = time.monotonic() + PATIENCE
    while any(map(is_alive, children)):
        assert time.monotonic() < end, "workers stay"
        time.sleep(0.05)


@pytest.mark.parametrize(
    "arguments",
    [
        ["--port", "x"],
        ["--port", "70000"],
        ["--host", "no..host"],
        ["--searches", "0"],
        ["--searches", "0.5"],
        ["--searches", "100000000"],
        ["--seconds", "-1"],
        ["--memory", "much"],
    ],
)
def test_options_that_cannot_be_are_refused(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert app(["serve", *arguments], standalone_mode=False) == 2
    error = capsys.readouterr().err
    assert error.startswith("workhold: error: ") and error.count("\n") == 1


def test_a_port_that_is_taken_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert app(["serve", "--port", str(port)], standalone_mode=False) == 2
    assert str(port) in capsys.readouterr().err
