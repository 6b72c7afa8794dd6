"""Jobs that are followed: events are resumed, a job that is left stops if that was asked, and memory is bounded."""

from __future__ import annotations

import json
from collections.abc import Iterator
from time import monotonic
from typing import Any

import httpx
import pytest
from running_server import LONG, PATIENCE, RunningServer, request, running_server
from test_parts import refused

LEFT = 0.4


@pytest.fixture(scope="module")
def impatient() -> Iterator[RunningServer]:
    """A server that gives up what is left soon."""
    with running_server(left_seconds=LEFT, seconds=600.0) as running:
        yield running


def events(server: RunningServer, url: str, seen: str | None = None) -> list[tuple[int, dict[str, Any]]]:
    """The ids and the data of a job's events, after those that were seen."""
    headers = {} if seen is None else {"Last-Event-ID": seen}
    answer = server.client.get(f"{url}/events", headers=headers)
    assert answer.status_code == 200, answer.text
    blocks = [block.split("\n") for block in answer.text.strip().split("\n\n") if block.startswith("id: ")]
    return [
        (int(one.removeprefix("id: ")), json.loads(data.removeprefix("data: "))) for one, _, data in blocks
    ]


@pytest.mark.thorough
def test_events_go_on_where_they_were_left(server: RunningServer) -> None:
    """What was seen is not told again; after the last one there is nothing more to connect for."""
    url = server.done(request())
    (whole,) = events(server, url)
    for other in (str(whole[0] - 1), "0", "99999", "x", "-1", "1" * 30):
        assert events(server, url, other) == [whole]
    last = server.client.get(f"{url}/events", headers={"Last-Event-ID": str(whole[0])})
    assert (last.status_code, last.content) == (204, b"")


@pytest.mark.thorough
def test_events_of_a_running_job_wait_for_a_change(server: RunningServer) -> None:
    """Whoever has seen the present state is told the next one first."""
    url = server.submit(LONG)
    server.state_when(url, lambda state: state["revision"] > 0)
    with httpx.Client(base_url=server.client.base_url, timeout=PATIENCE) as other:
        with other.stream("GET", f"{url}/events") as stream:
            first = next(line for line in stream.iter_lines() if line.startswith("id: "))
        seen = first.removeprefix("id: ")
        with other.stream("GET", f"{url}/events", headers={"Last-Event-ID": seen}) as stream:
            again = next(line for line in stream.iter_lines() if line.startswith("id: "))
    assert int(again.removeprefix("id: ")) > int(seen)
    server.client.delete(url)


@pytest.mark.thorough
@pytest.mark.parametrize("path", ["jobs", "explore"])
def test_a_job_that_is_left_stops_where_that_was_asked(impatient: RunningServer, path: str) -> None:
    asked = LONG if path == "jobs" else {"workpiece": LONG["workpiece"], "toolkits": [LONG["toolkit"]]}
    url = impatient.submit(asked, f"/api/v1/{path}?when_left=cancel")
    job = impatient.state.jobs.by_name[url.rpartition("/")[2]]
    impatient.wait_until(lambda: job.is_over)
    assert job.state == "cancelled"
    # It can be asked for all the same.
    assert impatient.client.get(url).json()["state"] == "cancelled"


@pytest.mark.thorough
def test_a_job_that_waits_and_is_left_never_begins(impatient: RunningServer) -> None:
    first = impatient.submit(LONG)
    url = impatient.submit(LONG, "/api/v1/jobs?when_left=cancel")
    waiting = impatient.state.jobs.by_name[url.rpartition("/")[2]]
    impatient.wait_until(lambda: waiting.is_over)
    assert (waiting.state, waiting.began) == ("cancelled", None)
    impatient.client.delete(first)


@pytest.mark.thorough
def test_a_job_that_is_followed_or_asked_for_goes_on(impatient: RunningServer) -> None:
    """For longer than it would be kept; it stops once the connection is gone."""
    url = impatient.submit(LONG, "/api/v1/jobs?when_left=cancel")
    job = impatient.state.jobs.by_name[url.rpartition("/")[2]]
    with (
        httpx.Client(base_url=impatient.client.base_url, timeout=PATIENCE) as other,
        other.stream("GET", f"{url}/events") as stream,
    ):
        for line in stream.iter_lines():
            if line.startswith("data: ") and json.loads(line.removeprefix("data: "))["seconds"] > 3 * LEFT:
                before = monotonic()
                break
        assert not job.is_over
    impatient.wait_until(lambda: not job.watchers)
    # It was in use until the connection was gone, and the time counts from there; its end would be a later use.
    used = job.used
    assert job.ended is None and used >= before
    impatient.wait_until(lambda: job.is_over)
    assert job.state == "cancelled"
    url = impatient.submit(LONG, "/api/v1/jobs?when_left=cancel")
    asked_for = impatient.state_when(url, lambda state: state["seconds"] > 3 * LEFT)
    assert asked_for["state"] in ("running", "listing")
    impatient.client.delete(url)


@pytest.mark.thorough
def test_a_job_is_kept_unless_that_was_asked(impatient: RunningServer) -> None:
    kept, left = impatient.submit(LONG), impatient.submit(LONG, "/api/v1/jobs?when_left=cancel")
    jobs = impatient.state.jobs.by_name
    impatient.wait_until(lambda: jobs[left.rpartition("/")[2]].is_over)
    assert not jobs[kept.rpartition("/")[2]].is_over
    impatient.client.delete(kept)
    refused(impatient.client.post("/api/v1/jobs?when_left=forget", json=LONG))


@pytest.mark.thorough
def test_large_requests_count_in_what_is_kept() -> None:
    """Small results of large requests: the oldest are forgotten."""
    zone = [[500 + k, 500 + k * k, 0] for k in range(300)]
    large = request(restrictions={"zones": [zone]}, contact_margin=0.5)
    with running_server(kept_bytes=400_000) as server:
        urls = [server.done(large) for _ in range(6)]
        found = [server.client.get(url).status_code for url in urls]
        kept = sum(job.size for job in server.state.jobs.by_name.values())
        assert found[-1] == 200 and found[0] == 404
        assert kept <= 400_000
        assert all(job.weight > 50_000 for job in server.state.jobs.by_name.values())
        # Orders of a list count too.
        job = server.state.jobs.by_name[urls[-1].rpartition("/")[2]]
        before = job.size
        assert server.client.get(f"{urls[-1]}/fixtures?sort=tilt").status_code == 200
        assert job.size > before
