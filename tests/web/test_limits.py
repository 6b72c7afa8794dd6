"""What the server does not give, and that others do not suffer for it."""

from __future__ import annotations

import gc
import json
import socket
import weakref
from collections.abc import Iterator
from math import cos, sin, tau

import pytest
from running_server import LONG, PATIENCE, SQUARE, RunningServer, arriving, request, running_server
from test_parts import refused

from workhold.web import pool

LIMITED = {
    "upload_bytes": 2_000,
    "request_bytes": 20_000,
    "uploads": 1,
    "segments": 20,
    "waiting": 2,
    "jobs": 3,
    "seconds": 600.0,
    "fixtures": 100,
    "kept_jobs": 20,
    "kept_bytes": 120_000,
    "streams": 1,
}


@pytest.fixture(scope="module")
def small() -> Iterator[RunningServer]:
    """A server that gives little."""
    with running_server(**LIMITED) as running:
        yield running


@pytest.fixture(autouse=True)
def tidy(small: RunningServer) -> Iterator[None]:
    """Leave no job behind."""
    yield
    for name in list(small.state.jobs.by_name):
        small.client.delete(f"/api/jobs/{name}")
    small.wait_until(lambda: not small.state.searchers.busy)


@pytest.mark.thorough
def test_large_files_and_requests_are_refused(small: RunningServer) -> None:
    refused(small.client.post("/api/parts", content=bytes(2_001)), 413)
    refused(small.client.post("/api/jobs", content=bytes(20_001)), 413)


@pytest.mark.thorough
def test_parts_of_many_segments_are_refused(small: RunningServer) -> None:
    many = [[k, 0, 0] for k in range(20)] + [[10, 10, 0]]
    assert "21 segments" in refused(
        small.client.post("/api/parts/check", json={"name": "m", "loops": [many]})
    )
    refused(small.client.post("/api/jobs", json=request(workpiece={"name": "m", "loops": [many]})))


def test_files_that_arrive_slowly_keep_nobody_from_anything_else(small: RunningServer) -> None:
    with socket.create_connection(small.address, timeout=PATIENCE) as slow:
        slow.sendall(b"POST /api/parts HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000\r\n\r\n<svg")
        small.wait_until(lambda: arriving(small) == 1)
        # The only place for a file is taken; everything else goes on.
        answer = small.client.post("/api/parts", content=b"x")
        refused(answer, 503)
        assert answer.headers["retry-after"]
        assert small.client.get("/api/about").status_code == 200
    small.wait_until(lambda: arriving(small) == 0)


@pytest.mark.thorough
def test_too_many_searches_of_one_address_are_refused(small: RunningServer) -> None:
    for _ in range(3):
        small.submit(LONG)
    answer = small.client.post("/api/jobs", json=request())
    refused(answer, 429)
    assert answer.headers["retry-after"]


@pytest.mark.thorough
def test_only_the_best_fixtures_are_kept_and_it_is_said(small: RunningServer) -> None:
    url = small.done(request())
    state = small.client.get(url).json()
    assert state["complete"] and state["found"] == 505 and state["listed"] == 100
    assert any("505" in note and "100" in note for note in state["notes"])
    assert small.client.get(f"{url}/fixtures").json()["total"] == 100


@pytest.mark.thorough
def test_the_longest_unused_go_when_too_much_is_kept(small: RunningServer) -> None:
    urls = [small.done(request()) for _ in range(3)]
    size = small.state.jobs.by_name[urls[-1].rpartition("/")[2]].size
    assert size <= LIMITED["kept_bytes"] < 4 * size
    small.client.get(urls[0])
    urls += [small.done(request()) for _ in range(LIMITED["kept_bytes"] // size - 2)]
    assert [small.client.get(url).status_code for url in urls] == [200, 404, *[200] * (len(urls) - 2)]


@pytest.mark.thorough
def test_what_is_wrong_in_very_many_places_is_found_out_by_a_worker(
    server: RunningServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The process that hears all clients never looks at it; small requests it does."""
    by_worker: list[str] = []
    whole = pool.WorkerPool.run

    async def run(self: pool.WorkerPool, task: pool.PoolTask) -> object:
        by_worker.append(task.name)
        return await whole(self, task)

    monkeypatch.setattr(pool.WorkerPool, "run", run)
    few = {"name": "m", "loops": [SQUARE], **{f"k{k}": 1 for k in range(5_000)}}
    many = {"name": "m", "loops": [SQUARE], **{f"k{k}": 1 for k in range(250_000)}}
    long_part = {"name": "m", "loops": [[[k, k * k, 0] for k in range(3_000)]]}
    lists = {
        "axis": "z",
        "height": 9,
        "peg_height": 5,
        "head_room": 0,
        "least_band": 1,
        "bands": [[0, 9]] * 4,
    }
    solid = {"name": "m", "loops": [SQUARE], "solid": {**lists, "bottom": [SQUARE] * 7_000}}
    deep = b"[" * 1_900_000 + b"]" * 1_900_000
    for content, words in (
        (json.dumps(few).encode(), "at k0: extra inputs are not permitted"),
        (json.dumps(many).encode(), "more than 100,000 values"),
        (json.dumps(solid).encode(), "more than 100,000 values"),
        (json.dumps(long_part).encode(), "3000 segments, more than the 2000"),
        (b'{"name":"m","loops":[' + b",".join([b'[["a"]]'] * 1_500) + b"]}" + b" " * 40_000, "at loops.0.0"),
        (deep, "not valid JSON"),
        (b'{"name":' * 300_000, "not valid JSON"),
        (b"\xff" * 40_000, "not valid JSON"),
    ):
        by_worker.clear()
        assert words in refused(server.client.post("/api/parts/check", content=content))
        assert by_worker == ["check_body"]
    by_worker.clear()
    assert "extra inputs" in refused(
        server.client.post("/api/parts/check", json={"name": "m", "loops": [SQUARE], "k": 1})
    )
    assert by_worker == []


@pytest.mark.thorough
def test_what_a_search_found_is_freed_when_it_is_deleted(server: RunningServer) -> None:
    """Nothing that waits for the next search holds what came of the last one, also if it was still running."""
    url = server.done(request())
    job = server.state.jobs.by_name[url.rpartition("/")[2]]
    kept = [weakref.ref(job), weakref.ref(job.result), weakref.ref(job.result.table)]  # type: ignore[union-attr]
    del job
    server.client.delete(url)
    running = server.submit(LONG)
    server.state_when(running, lambda state: state["state"] == "running")
    kept.append(weakref.ref(server.state.jobs.by_name[running.rpartition("/")[2]]))
    server.client.delete(running)
    server.wait_until(lambda: gc.collect() >= 0 and not any(one() for one in kept))


@pytest.mark.thorough
def test_one_stream_too_many_is_refused(small: RunningServer) -> None:
    url = small.submit(LONG)
    with small.client.stream("GET", f"{url}/events") as stream:
        lines = stream.iter_lines()
        next(lines)
        refused(small.client.get(f"{url}/events"), 503)


@pytest.fixture(scope="module")
def strict() -> Iterator[RunningServer]:
    """A server of little memory."""
    with running_server(memory_bytes=1 << 30) as running:
        yield running


@pytest.fixture(scope="module")
def hasty() -> Iterator[RunningServer]:
    """A server that does not wait, and keeps few fixtures, of which any search finds more."""
    with running_server(body_seconds=0.5, seconds=3.0, fixtures=3) as running:
        yield running


@pytest.mark.thorough
def test_a_slow_client_is_let_go(hasty: RunningServer) -> None:
    with socket.create_connection(hasty.address, timeout=PATIENCE) as slow:
        slow.sendall(b"POST /api/parts HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000\r\n\r\n<svg")
        assert b" 408 " in slow.recv(400)


@pytest.mark.thorough
def test_a_search_that_takes_too_long_shows_what_it_found(hasty: RunningServer) -> None:
    state = hasty.outcome(hasty.submit(LONG))
    assert state["state"] == "done" and not state["complete"]
    assert any("3 s" in note for note in state["notes"])
    assert state["listed"] == 3 < state["found"]


@pytest.mark.thorough
def test_a_search_that_needs_too_much_memory_fails_in_a_sentence(strict: RunningServer) -> None:
    corners = [[30 * cos(tau * k / 120), (30 - k % 3) * sin(tau * k / 120), 0.0] for k in range(120)]
    huge = {"pitch": [0.5, 0.5], "columns": 60, "peg_radius": 0.01}
    state = strict.outcome(strict.submit(request(toolkit=huge, workpiece={"name": "s", "loops": [corners]})))
    assert state["state"] == "failed" and "memory" in state["error"]
    assert strict.outcome(strict.submit(request()))["state"] == "done"


@pytest.mark.thorough
def test_nothing_is_kept_after_the_life_of_a_search(small: RunningServer) -> None:
    """Which begins anew each time that it is asked for; room is made for every search."""
    url, life = small.done(request()), small.state.limits.life_seconds
    job = small.state.jobs.by_name[url.rpartition("/")[2]]
    for lives, status in ((0.6, 200), (0.6, 200), (1.1, 404)):
        job.used -= lives * life
        small.done(request())
        assert small.client.get(url).status_code == status


@pytest.mark.thorough
def test_the_server_looks_for_what_to_forget_by_itself() -> None:
    with running_server(life_seconds=0.2) as running:
        running.submit(request())
        running.wait_until(lambda: not running.state.jobs.by_name)
