"""Clients take turns: whoever asks for much keeps nobody else waiting; proxies, tokens, and a page below a path."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from contextlib import ExitStack
from itertools import pairwise
from typing import Any, TypeVar

import httpx
import pytest
from hypothesis import given
from hypothesis import strategies as st
from running_server import LONG, PATIENCE, RunningServer, arriving, request, run_alone, running_server

from workhold.cli.main import app
from workhold.web import serve
from workhold.web.guard import ServerLimits, compute_usual_memory
from workhold.web.pool import BusyError, PoolTask, WorkerPool
from workhold.web.serve import list_hosts

T = TypeVar("T")
OTHER = "127.0.0.2"
FEW = {"client_uploads": 2, "uploads": 6, "connections": 40, "client_connections": 12}


def order_of_turns(clients: list[str], size: int) -> list[str]:
    """Whose turn it was, one after the other, when each worker ends the oldest of its tasks before the next is begun."""

    async def play() -> list[str]:
        pool = WorkerPool("search", size, 1 << 30, len(clients) + 1)
        pool.waiting = [PoolTask("x", None, 1.0, client) for client in clients]
        order, running = [], []
        while pool.waiting:
            if pool.choose_next_task() is None:
                pool.release_worker(running.pop(0))
                continue
            task = await pool.wait_for_task()
            order.append(task.client)
            running.append(task)
            if len(running) == size:
                pool.release_worker(running.pop(0))
        return order

    return run_alone(play())


@pytest.mark.thorough
@given(st.lists(st.sampled_from("abc"), min_size=1, max_size=30), st.integers(1, 4))
def test_everybody_gets_a_turn_before_anybody_gets_another(clients: list[str], size: int) -> None:
    """While several clients wait, nobody has two turns between two of another who waits; nobody is left out."""
    order = order_of_turns(clients, size)
    assert sorted(order) == sorted(clients)
    for one in set(clients):
        last = max(k for k, client in enumerate(order) if client == one)
        turns = [k for k, client in enumerate(order[: last + 1]) if client == one]
        for before, after in pairwise(turns):
            between = order[before + 1 : after]
            # With several workers a client that has none comes first, so two of another are begun while the one still runs.
            assert all(between.count(other) <= size for other in set(between))


def test_nobody_has_all_workers() -> None:
    """One worker of several is kept for the next who comes; who has a worker has it until it is free again."""

    async def play() -> None:
        pool = WorkerPool("search", 3, 1 << 30, 64)
        pool.waiting = [PoolTask("x", None, 1.0, "greedy") for _ in range(5)]
        mine = [await pool.wait_for_task() for _ in range(2)]
        assert pool.choose_next_task() is None
        pool.waiting.append(PoolTask("x", None, 1.0, "other"))
        assert (await pool.wait_for_task()).client == "other"
        assert pool.choose_next_task() is None
        pool.release_worker(mine[0])
        assert (await pool.wait_for_task()).client == "greedy"

    run_alone(play())


def test_some_places_in_the_queue_are_kept_from_each_client() -> None:
    """Who has filled three quarters of the queue is refused; another still finds a place."""

    async def play() -> None:
        pool = WorkerPool("search", 1, 1 << 30, 8)
        pool.waiting = [PoolTask("x", None, 1.0, "greedy") for _ in range(5)]
        pool.refuse_more("greedy")
        pool.waiting.append(PoolTask("x", None, 1.0, "greedy"))
        with pytest.raises(BusyError):
            pool.refuse_more("greedy")
        pool.refuse_more("other")

    run_alone(play())


@pytest.fixture(scope="module")
def shared() -> Iterator[RunningServer]:
    """A server with two searches at the same time, which several clients share; a proxy of theirs is trusted."""
    with running_server(proxies=["127.0.0.1"], searches=2, seconds=600.0, **FEW) as running:
        yield running


@pytest.fixture
def other(shared: RunningServer) -> Iterator[httpx.Client]:
    """A client with another address."""
    with shared.client_from(OTHER) as client:
        yield client


@pytest.mark.thorough
def test_nobody_waits_behind_anothers_searches(shared: RunningServer, other: httpx.Client) -> None:
    """A search of another client comes to its end while the many of the first are still to be done."""
    urls = [shared.submit(LONG) for _ in range(6)]
    answer = other.post("/api/jobs", json=request())
    assert answer.status_code == 202
    assert shared.outcome(answer.json()["url"])["state"] == "done"
    states = [shared.client.get(url).json()["state"] for url in urls]
    assert "done" not in states and states.count("queued") >= 4
    for url in urls:
        shared.client.delete(url)
    shared.wait_until(lambda: not shared.state.searchers.busy)


def drips(shared: RunningServer, stack: ExitStack, address: str) -> socket.socket:
    """A connection from an address."""
    one = stack.enter_context(socket.socket())
    one.bind((address, 0))
    one.settimeout(PATIENCE)
    one.connect(shared.address)
    return one


@pytest.mark.thorough
def test_slow_uploads_of_one_client_leave_places_for_others(
    shared: RunningServer, other: httpx.Client
) -> None:
    """Files that arrive byte by byte take no more places than one client has; the next of it is told so."""
    head = f"POST /api/parts HTTP/1.1\r\nHost: 127.0.0.1:{shared.address[1]}\r\nContent-Length: 1000\r\n\r\nx"
    with ExitStack() as stack:
        slow = [drips(shared, stack, "127.0.0.1") for _ in range(5)]
        for one in slow[:2]:
            one.sendall(head.encode())
        shared.wait_until(lambda: arriving(shared) == 2)
        for one in slow[2:]:
            one.sendall(head.encode())
        refused = [one.recv(200).split(b"\r\n")[0] for one in slow[2:]]
        assert all(b"429" in line for line in refused)
        body = b'{"name": "square", "units": "mm", "loops": [[[0,0,0],[30,0,0],[30,30,0],[0,30,0]]]}'
        assert (
            other.post("/api/parts", content=body, headers={"X-Filename": "square.json"}).status_code == 200
        )


def test_idle_connections_of_one_client_leave_some_for_others(
    shared: RunningServer, other: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beyond its share a client's connections are closed at once; others are answered. A trusted proxy may have more."""
    # None is closed because it has waited.
    monkeypatch.setattr(serve, "HEADER_SECONDS", PATIENCE)
    with ExitStack() as stack:
        idle = [drips(shared, stack, "127.0.0.3") for _ in range(30)]
        # What was closed answers the read with nothing; what is open has nothing to read.
        for one in idle:
            one.setblocking(False)
        shared.wait_until(lambda: sum(map(is_closed, idle)) >= 30 - FEW["client_connections"])
        assert other.get("/api/about").status_code == 200
        assert sum(map(is_closed, idle)) == 30 - FEW["client_connections"]
    with ExitStack() as stack:
        many = [drips(shared, stack, "127.0.0.1") for _ in range(20)]
        assert other.get("/api/about").status_code == 200
        for one in many:
            one.setblocking(False)
        assert not any(map(is_closed, many))


def is_closed(one: socket.socket) -> bool:
    """Whether the other end has closed a connection on which it has said nothing."""
    try:
        return one.recv(1) == b""
    except BlockingIOError:
        return False
    except OSError:
        return True


@pytest.mark.thorough
def test_a_proxy_is_believed_only_when_it_is_trusted(shared: RunningServer, other: httpx.Client) -> None:
    """The trusted proxy's word tells one client from another; what anybody else says of itself counts for nothing."""
    for client, said, counted in ((shared.client, "10.1.2.3", "10.1.2.3"), (other, "10.1.2.4", OTHER)):
        answer = client.post("/api/jobs", json=request(), headers={"X-Forwarded-For": said})
        job = shared.state.jobs.get(answer.json()["job"])
        assert job is not None and job.address == counted
        shared.outcome(answer.json()["url"])


@pytest.mark.thorough
def test_a_token_lets_in_who_has_it() -> None:
    """Nothing is answered without it; the printed address gives a cookie, and programs send it as a bearer's token."""
    with running_server(token="secret-of-the-shop") as running:
        base = str(running.client.base_url)
        with httpx.Client(base_url=base, timeout=PATIENCE) as fresh:
            for path in ("/", "/api/about", "/static/style.css", "/?token=wrong"):
                answer = fresh.get(path)
                assert answer.status_code == 401
                assert "token" in answer.json()["error"]
            assert fresh.post("/api/jobs?token=secret-of-the-shop", json=request()).status_code == 401
            assert (
                fresh.get("/api/about", headers={"Authorization": "Bearer secret-of-the-shop"}).status_code
                == 200
            )
            welcome = fresh.get("/?token=secret-of-the-shop")
            assert welcome.status_code == 303 and welcome.headers["location"] == "./"
            assert (
                "HttpOnly" in welcome.headers["set-cookie"]
                and "SameSite=Strict" in welcome.headers["set-cookie"]
            )
            assert fresh.get("/api/about").status_code == 200


@pytest.mark.thorough
def test_whoever_lets_others_in_is_told_what_that_means(monkeypatch: pytest.MonkeyPatch) -> None:
    """A plain warning where the page can be reached from elsewhere without a token, and only there."""
    from typer.testing import CliRunner

    asked: list[Any] = []

    def run_server(*arguments: Any) -> None:
        asked.append(arguments)
        arguments[6]("http://127.0.0.1:8000/")

    monkeypatch.setattr(serve, "run_server", run_server)
    said = {}
    for arguments in ([], ["--host", "0.0.0.0"], ["--host", "0.0.0.0", "--ask-token"]):
        outcome = CliRunner().invoke(app, ["serve", *arguments])
        assert outcome.exit_code == 0, outcome.output
        said[tuple(arguments)] = outcome.stderr
    assert [("everybody" in text) for text in said.values()] == [False, True, False]
    assert [arguments[5] is not None for arguments in asked] == [False, False, True]
    assert CliRunner().invoke(app, ["serve", "--trust-proxy", "nginx"]).exit_code == 2


def test_searches_share_the_machines_memory() -> None:
    """No search is given more than its share of what there is, and never less than one can work with."""
    assert ServerLimits().memory_bytes == 4 << 30
    shares = [compute_usual_memory(searches) for searches in (1, 2, 4, 8, 64)]
    assert shares == sorted(shares, reverse=True)
    assert all(1 << 30 <= share <= 4 << 30 for share in shares)


def test_the_names_of_the_server_hold_behind_a_proxy() -> None:
    """A proxy that hands the visitor's Host on needs its name to be allowed."""
    assert list_hosts("127.0.0.1", ["plates.example"]).knows("plates.example:443")
