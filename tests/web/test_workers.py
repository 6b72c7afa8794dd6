"""Workers may die; the server and the other searches go on."""

from __future__ import annotations

import os
import signal
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from running_server import LONG, RunningServer, request, running_server

pytestmark = pytest.mark.thorough


@pytest.fixture(scope="module")
def pair() -> Iterator[RunningServer]:
    """A server with two workers that search."""
    with running_server(searches=2) as running:
        running.wait_until(lambda: len(running.state.searchers.workers) == 2)
        yield running


def pids(server: RunningServer) -> list[int]:
    """Process numbers of the workers that search."""
    return [worker.process.pid for worker in server.state.searchers.workers.values()]


def tell(pid: int, what: signal.Signals) -> None:
    """Send a signal to a worker; one that has ended meanwhile needs none."""
    with suppress(ProcessLookupError):
        os.kill(pid, what)


def test_a_killed_worker_fails_its_search_only(pair: RunningServer) -> None:
    # One client never has all workers.
    with pair.client_from("127.0.0.2") as other:
        clients = {
            client.post("/api/jobs", json=LONG).json()["url"]: client for client in (pair.client, other)
        }
        for url in clients:
            pair.state_when(url, lambda state: state["state"] == "running")
        tell(pids(pair)[0], signal.SIGKILL)
        pair.wait_until(lambda: any(job.is_over for job in pair.state.jobs.by_name.values()))
        states = {url: pair.client.get(url).json() for url in clients}
        (failed,) = [url for url, state in states.items() if state["state"] == "failed"]
        assert states[failed]["error"].endswith(".")
        (alive,) = [url for url, state in states.items() if state["state"] == "running"]
        # A new worker takes the place of the dead one while the other still works.
        again = clients[failed].post("/api/jobs", json=request()).json()["url"]
        assert pair.outcome(again)["state"] == "done"
        assert pair.client.get(alive).json()["state"] == "running"
        pair.client.delete(alive)


def test_a_worker_that_dies_in_its_sleep_is_replaced(pair: RunningServer) -> None:
    pair.wait_until(lambda: not pair.state.searchers.busy)
    before = pids(pair)
    for pid in before:
        tell(pid, signal.SIGKILL)
    pair.wait_until(lambda: not set(before) & set(pids(pair)))
    for url in [pair.submit(request()) for _ in range(4)]:
        assert pair.outcome(url)["state"] == "done"


def test_a_worker_that_does_not_hear_is_ended_and_replaced(pair: RunningServer) -> None:
    url = pair.submit(LONG)
    pair.state_when(url, lambda state: state["state"] == "running")
    (busy,) = [job.task for job in pair.state.jobs.by_name.values() if not job.is_over]
    assert busy is not None
    before = pids(pair)
    for pid in before:
        tell(pid, signal.SIGSTOP)
    pair.client.post(f"{url}/cancel")
    assert pair.outcome(url)["state"] == "cancelled"
    pair.wait_until(lambda: set(before) - set(pids(pair)))
    for pid in set(before) & set(pids(pair)):
        tell(pid, signal.SIGCONT)
    assert pair.outcome(pair.submit(request()))["state"] == "done"


def test_a_desk_that_dies_is_replaced(pair: RunningServer) -> None:
    (desk,) = pair.state.desks.workers.values()
    # What it would have written for a time is in a folder of its own.
    (folder,) = Path(tempfile.gettempdir()).glob(f"workhold-worker-{desk.process.pid}-*")
    (folder / "upload").write_bytes(b"half a drawing")
    tell(desk.process.pid, signal.SIGKILL)
    assert pair.client.get("/api/parts/flange").status_code in (200, 503)
    assert pair.client.get("/api/parts/flange").status_code == 200
    pair.wait_until(lambda: not folder.exists())
