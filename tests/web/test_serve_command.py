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
from running_server import LONG, PATIENCE

from workhold.cli.main import app

pytestmark = pytest.mark.thorough

COMMAND = [sys.executable, "-m", "workhold", "serve"]
FIRST_RUN = "workhold: the kernels are being compiled for this machine, which takes half a minute or so the first time.\n"


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
        assert process.stderr.read() in ("", FIRST_RUN)
    end = time.monotonic() + PATIENCE
    while any(map(is_alive, children)):
        assert time.monotonic() < end, "workers stay"
        time.sleep(0.05)


@pytest.mark.parametrize(("ending", "code"), [(signal.SIGTERM, 143), (signal.SIGINT, 0)])
def test_it_ends_while_clients_listen_and_send(tmp_path: Path, ending: signal.Signals, code: int) -> None:
    """Without a word, and without files of what was being done."""
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    process = subprocess.Popen(
        [*COMMAND, "--port", "0"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    )
    assert process.stdout is not None and process.stderr is not None
    line = process.stdout.readline()
    found = re.search(r"http://127\.0\.0\.1:(\d+)/", line)
    assert found, line + process.stderr.read()
    job = httpx.post(f"{found[0]}api/v1/jobs", json=LONG, timeout=PATIENCE).json()["url"]
    with (
        socket.create_connection(("127.0.0.1", int(found[1])), timeout=PATIENCE) as listening,
        socket.create_connection(("127.0.0.1", int(found[1])), timeout=PATIENCE) as sending,
    ):
        sending.sendall(b"POST /api/parts HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000\r\n\r\n<svg")
        listening.sendall(f"GET {job}/events HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
        assert b" 200 " in listening.recv(400)
        process.send_signal(ending)
        assert process.wait(PATIENCE) == code
    assert process.stderr.read() in ("", FIRST_RUN)
    assert list(tmp_path.iterdir()) == []


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
