"""A server that runs while tests talk to it, and what they ask it for."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable, Collection, Coroutine, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, TypeVar

import httpx
import pytest
from attrs import define
from warm_worker import warm_context

from reading_here import work_reading_here
from workhold import load
from workhold.web.guard import AllowedHosts, ServerLimits
from workhold.web.origins import AllowedOrigins
from workhold.web.serve import Server, make_server, open_bound_socket
from workhold.web.state import ServerState

T = TypeVar("T")
# Seconds to wait for what comes at once on a machine that has nothing else to do.
PATIENCE = 120.0
# Kernels may have to be compiled first.
START_PATIENCE = 400.0

WIDGET = {"name": "widget", "loops": [loop.tolist() for loop in load("widget").loops]}
VISE = {"pitch": [8, 8], "columns": 1, "peg_radius": 3}
SQUARE = [[0, 0, 0], [30, 0, 0], [30, 30, 0], [0, 30, 0]]
# A search that takes longer than any test.
LONG = {
    "workpiece": {"name": "8Handle", "loops": [loop.tolist() for loop in load("8Handle").loops]},
    "toolkit": {"pitch": [3, 3], "columns": 7, "peg_radius": 1.4},
}


def run_alone(play: Coroutine[Any, Any, T]) -> T:
    """What a coroutine returns; in a thread of its own, since the browser's tests keep a loop running in this one."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, play).result()


def request(**changes: Any) -> dict[str, Any]:
    """A search of the widget, with some values changed."""
    return {"workpiece": WIDGET, "toolkit": VISE, **changes}


@define
class RunningServer:
    """A server in a thread, a client of it, and its insides."""

    server: Server
    client: httpx.Client
    address: tuple[str, int]

    @property
    def state(self) -> ServerState:
        """What the routes share."""
        return self.server.config.app.state.server  # type: ignore[union-attr]

    def client_from(self, address: str) -> httpx.Client:
        """A client with another address of this machine."""
        transport = httpx.HTTPTransport(local_address=address)
        return httpx.Client(base_url=self.client.base_url, transport=transport, timeout=PATIENCE)

    def submit(self, asked: dict[str, Any], path: str = "/api/jobs") -> str:
        """Begin a job; its address."""
        answer = self.client.post(path, json=asked)
        assert answer.status_code == 202, answer.text
        url: str = answer.json()["url"]
        return url

    def state_when(self, url: str, holds: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """The state of a job as soon as something holds of it."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            state: dict[str, Any] = self.client.get(url).json()
            if holds(state):
                return state
            time.sleep(0.02)
        raise AssertionError(f"waited in vain: {state}")

    def outcome(self, url: str) -> dict[str, Any]:
        """The state of a job once it is over."""
        return self.state_when(url, lambda state: state["state"] in ("done", "failed", "cancelled"))

    def done(self, asked: dict[str, Any], path: str = "/api/jobs") -> str:
        """The address of a job that is done."""
        url = self.submit(asked, path)
        state = self.outcome(url)
        assert state["state"] == "done", state
        return url

    def wait_until(self, holds: Callable[[], object], patience: float = PATIENCE) -> None:
        """Wait until something holds of the server's insides."""
        end = time.monotonic() + patience
        while not holds():
            assert time.monotonic() < end, "waited in vain"
            time.sleep(0.02)


def arriving(server: RunningServer) -> int:
    """How many files are arriving."""
    app = server.server.config.app.middleware_stack  # type: ignore[union-attr]
    while not hasattr(app, "arriving"):
        app = app.app
    return int(app.arriving.total())


@contextmanager
def running_server(
    proxies: Collection[str] = (),
    token: str | None = None,
    origins: Collection[str] = (),
    **limits: Any,
) -> Iterator[RunningServer]:
    """A server with one worker of each kind, ready for requests; workers are forked, and the desk
    reads STEP files itself."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("workhold.web.pool.run_worker", work_reading_here)
        patch.setattr("workhold.web.pool.get_context", lambda _: warm_context())
        yield from served(proxies, token, origins, **limits)


def served(
    proxies: Collection[str], token: str | None, origins: Collection[str], **limits: Any
) -> Iterator[RunningServer]:
    """What :func:`running_server` does, with the workers that there are."""
    listening = threading.Event()
    socket = open_bound_socket("127.0.0.1", 0)
    given = ServerLimits(**{"searches": 1, "desks": 1, "desk_seconds": PATIENCE, **limits})
    server = make_server(given, AllowedHosts(), listening.set, proxies, token, AllowedOrigins(origins))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [socket]})
    thread.start()
    try:
        assert listening.wait(PATIENCE)
        host, port = socket.getsockname()
        with httpx.Client(base_url=f"http://{host}:{port}", timeout=PATIENCE) as client:
            running = RunningServer(server, client, (host, port))
            state = running.state
            running.wait_until(
                lambda: state.searchers.ready.is_set() and state.desks.ready.is_set(), START_PATIENCE
            )
            yield running
    finally:
        server.should_exit = True
        thread.join(PATIENCE)
        socket.close()
    assert not thread.is_alive()
