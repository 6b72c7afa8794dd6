"""What jobs of the server are kept and counted, by the jobs alone."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from time import monotonic
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from attrs import evolve
from running_server import run_alone

from fakes import fake_result
from workhold.files.step.part_shape import PartShape
from workhold.model.notes import BestOnly, Many
from workhold.web import jobs as kept_jobs
from workhold.web.families import FoundFamily
from workhold.web.guard import ServerLimits
from workhold.web.jobs import JobRegistry, ServerJob, TooManyError
from workhold.web.searching import AskedQueries, SearchOutcome

LIMITS = ServerLimits(jobs=2, kept_jobs=4, kept_bytes=1_000, life_seconds=100.0, left_seconds=0.05)


class FakePool:
    """A pool that does what a test says."""

    def __init__(self) -> None:
        self.work: Callable[[Any], Awaitable[Any]] | None = None
        self.cancelled: list[Any] = []

    def refuse_more(self, address: str) -> None:
        """There is room."""

    def cancel(self, task: Any) -> None:
        """Notes it, and lets the work see it."""
        self.cancelled.append(task)
        task.stop.set()

    async def run(self, task: Any) -> Any:
        """Does the work."""
        assert self.work is not None
        return await self.work(task)


@pytest.fixture
def jobs(monkeypatch: pytest.MonkeyPatch) -> Iterator[JobRegistry]:
    """Jobs in a pool that does nothing, which leave the memory of the process alone."""
    monkeypatch.setattr(JobRegistry, "free_memory", lambda self: None)
    yield JobRegistry(FakePool(), LIMITS)  # type: ignore[arg-type]


def job(
    jobs: JobRegistry,
    name: str,
    *,
    state: str = "done",
    unused: float = 0.0,
    asked: Any = None,
    **values: Any,
) -> ServerJob:
    """A job that was used some seconds ago."""
    made = ServerJob(name, {}, asked, values.pop("address", "a"), values.pop("kind", "design"), **values)
    made.state, made.used = state, monotonic() - unused
    jobs.by_name[name] = made
    return made


def test_searches_of_an_address_count_until_they_are_over(jobs: JobRegistry) -> None:
    """Those of others do not."""
    job(jobs, "one", state="running")
    job(jobs, "two", state="queued")
    for state in ("done", "failed", "cancelled"):
        job(jobs, state, state=state, address="b")
    job(jobs, "three", state="running", address="b")
    jobs.refuse_more("b")
    jobs.refuse_more("c")
    with pytest.raises(TooManyError, match="2 of your searches are not over yet"):
        jobs.refuse_more("a")
    jobs.by_name["one"].state = "done"
    jobs.refuse_more("a")


def test_the_longest_unused_go_first_and_no_more_than_must(jobs: JobRegistry) -> None:
    """By bytes of what is over, and by number of all; a job that runs stays."""
    for name, unused, weight in (("b", 30, 400), ("a", 40, 400), ("d", 10, 400), ("c", 20, 400)):
        job(jobs, name, unused=unused, weight=weight)
    jobs.make_room()
    assert set(jobs.by_name) == {"c", "d"}
    for name, unused in (("f", 80), ("e", 90)):
        job(jobs, name, unused=unused, state="running", weight=5_000)
    jobs.make_room()
    assert set(jobs.by_name) == {"c", "d", "e", "f"}
    job(jobs, "g", unused=5)
    jobs.make_room()
    assert set(jobs.by_name) == {"d", "e", "f", "g"}


def test_the_newest_stays_whatever_its_size(jobs: JobRegistry) -> None:
    job(jobs, "large", weight=5_000)
    jobs.make_room()
    assert set(jobs.by_name) == {"large"}
    job(jobs, "old", unused=10)
    jobs.make_room()
    assert set(jobs.by_name) == {"large"}


def test_a_job_is_forgotten_after_its_life(jobs: JobRegistry) -> None:
    """Where there is room for it, too."""
    for name, unused in (("old", 101.0), ("older", 500.0), ("new", 90.0)):
        job(jobs, name, unused=unused)
    job(jobs, "left", unused=101.0, state="running")
    jobs.make_room()
    assert set(jobs.by_name) == {"new"}


def test_shapes_and_orders_count_and_few_orders_and_seatings_are_kept(
    jobs: JobRegistry, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The oldest go first."""
    positions, triangles = np.zeros((6, 3)), np.zeros((2, 3), dtype=np.int64)
    one = job(jobs, "one", weight=100, shape=PartShape(positions, positions, triangles, "kept"))
    assert one.size == 100 + 2 * positions.nbytes + triangles.nbytes + 4
    found = SimpleNamespace(index=np.zeros(3, dtype=np.int64), like=np.zeros(3, dtype=np.int64))
    selections: list[Any] = []
    for _ in range(kept_jobs.ORDERS_KEPT + 2):
        selections.append(SimpleNamespaceWithHash(choose_entries=lambda result: found))
        assert one.choose_entries(selections[-1], None) is found  # type: ignore[arg-type]
    assert [key[1] for key in one.orders] == selections[2:]
    assert one.size == 100 + 2 * positions.nbytes + triangles.nbytes + 4 + kept_jobs.ORDERS_KEPT * 48
    for rank in range(kept_jobs.SEATINGS_KEPT + 3):
        one.keep_seating((1, rank), None)  # type: ignore[arg-type]
    assert list(one.seatings) == [(1, rank) for rank in range(3, kept_jobs.SEATINGS_KEPT + 3)]


class SimpleNamespaceWithHash(SimpleNamespace):
    """A selection that is itself and no other."""

    __hash__ = object.__hash__
    __eq__ = object.__eq__


@pytest.mark.parametrize("is_deleted", [False, True])
def test_a_job_is_used_until_its_end_and_nothing_is_kept_of_one_that_was_deleted(
    jobs: JobRegistry, is_deleted: bool
) -> None:
    family = FoundFamily(None, (), "")  # type: ignore[arg-type]

    async def work(task: Any) -> Any:
        task.begun()
        await asyncio.sleep(0.02)
        if is_deleted:
            jobs.by_name.clear()
        return family

    async def whole() -> ServerJob:
        made = job(jobs, "one", state="queued", unused=50.0, kind="family")
        jobs.pool.work = work  # type: ignore[attr-defined]
        await jobs.run(made)
        return made

    made = run_alone(whole())
    assert made.state == "done" and made.ended is not None and made.used == made.ended
    assert made.family is (None if is_deleted else family)


def test_a_job_that_is_left_is_cancelled_unless_somebody_watches_it(jobs: JobRegistry) -> None:
    """The time counts from its last use."""

    async def whole(watched: bool, unused: float) -> bool:
        made = job(jobs, "one", state="running", unused=unused)
        made.task = SimpleNamespace(stop=asyncio.Event())  # type: ignore[assignment]
        watcher = asyncio.Event()
        if watched:
            made.watchers.add(watcher)
        leaving = asyncio.create_task(jobs.stop_when_left(made))
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        is_cancelled = bool(jobs.pool.cancelled)  # type: ignore[attr-defined]
        leaving.cancel()
        return is_cancelled

    assert not run_alone(whole(True, 50.0))
    assert not run_alone(whole(False, -50.0))
    assert run_alone(whole(False, 50.0))


def test_how_many_there_are_about_is_said_beside_the_best(jobs: JobRegistry) -> None:
    """Not that nobody counted them, which the kept result says, as it is one of the best alone."""
    whole = fake_result(5)
    limited = evolve(whole, query=evolve(whole.query, best=5), notes=(BestOnly(5),))
    made = job(jobs, "one", asked=AskedQueries.from_queries((("", whole.query),)))
    jobs.keep_outcome(made, SearchOutcome(limited, 0, (Many(4_240_000, 5),)))
    assert tuple(map(str, made.notes)) == ("There are about 4,200,000 fixtures: these are the best 5.",)
    assert made.result is not None and made.result.query.best == 5 and made.result.notes == (BestOnly(5),)
    jobs.keep_outcome(made, SearchOutcome(evolve(whole, notes=(BestOnly(5),)), 0))
    assert made.notes == (BestOnly(5),) and made.result.query.best is None
