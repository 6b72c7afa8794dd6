"""Jobs of the server, while they run and for some time after their last use.

Glossary
--------
job : a search, a comparison of toolkits, or a family of parts, with its state and what it has found.
revision : a number that grows whenever the fixtures to show have changed.
"""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from secrets import token_urlsafe
from time import monotonic
from typing import TYPE_CHECKING, Any

from attrs import define, evolve, field

from workhold.errors import InputError
from workhold.listing.identity import ShownEntries
from workhold.model.notes import BestOnly, Cut, KeptBest, Note, Stopped, ToolkitsLeft
from workhold.model.result import Result
from workhold.model.search_report import Explanation
from workhold.model.seating import Seating
from workhold.seating.clamping import HandLoading
from workhold.web.answers import describe_proof
from workhold.web.families import FoundFamily
from workhold.web.guard import ServerLimits
from workhold.web.part_tasks import estimate_shape_size
from workhold.web.pool import BusyError, FailedError, PoolTask, StoppedError, WorkerPool
from workhold.web.searching import AskedQueries, SearchOutcome
from workhold.web.selection import ListSelection
from workhold.web.worker import return_memory

if TYPE_CHECKING:
    from workhold.files.step.part_shape import PartShape

__all__ = ["JobRegistry", "ServerJob", "TooManyError"]

# Bytes of a random name; nobody can guess 128 bits.
NAME_BYTES = 16
# The part of a search after which its records are decided and listed, see ``search.design``.
LISTING = 0.9
OVER = ("done", "failed", "cancelled")
ORDERS_KEPT, SEATINGS_KEPT = 8, 32
# Seconds after which memory of deleted jobs is given back.
FREE_AFTER = 0.5
# Bytes of memory for each byte of a request that is kept: it is kept as it came and as the query made of it.
BYTES_KEPT = 16


class TooManyError(BusyError):
    """One address has too many searches."""


@define(eq=False)
class ServerJob:
    """A job, with its state and what it has found.

    Parameters
    ----------
    name : a random token.
    request : the request as it came.
    asked : the query; for a comparison, the queries and the names of their toolkits.
    address : address of the client.
    kind : "design", "explore" for a comparison of toolkits, or "family" of several parts.
    weight : estimate of the bytes of memory that the request takes.
    stops_when_left : whether the job is cancelled when no client has requested or followed it for some time.
    shape : shape of the part, where its file was sent for that.
    best : number of listed fixtures that are already known to be the best of all, while the search continues.
    """

    name: str
    request: Mapping[str, Any]
    asked: AskedQueries
    address: str
    kind: str
    weight: int = 0
    stops_when_left: bool = False
    state: str = "queued"
    fraction: float = 0.0
    found: int = 0
    best: int = 0
    began: float | None = None
    ended: float | None = None
    result: Result | None = None
    revision: int = 0
    notes: tuple[Note, ...] = ()
    error: str | None = None
    table: list[dict[str, Any]] = field(factory=list)
    task: PoolTask | None = None
    runner: asyncio.Task[None] | None = None
    explaining: asyncio.Task[Explanation] | None = None
    used: float = field(factory=monotonic)
    version: int = 0
    watchers: set[asyncio.Event] = field(factory=set)
    orders: dict[tuple[int, ListSelection], ShownEntries] = field(factory=dict)
    result_hash: str | None = None
    family: FoundFamily | None = None
    seatings: dict[tuple[int, int], Seating | HandLoading] = field(factory=dict)
    shape: PartShape | None = None

    @property
    def compares(self) -> bool:
        """Whether the job compares toolkits."""
        return self.kind == "explore"

    @property
    def is_over(self) -> bool:
        """Whether the job has ended: done, failed or cancelled."""
        return self.state in OVER

    @property
    def size(self) -> int:
        """Estimate of the bytes that the job keeps: request, shape, fixtures, and cached selections of the
        list.
        """
        kept = self.weight + estimate_shape_size(self.shape)
        kept += sum(found.index.nbytes + found.like.nbytes for found in self.orders.values())
        if self.result is None:
            return kept
        table = self.result.table
        return kept + sum(int(getattr(table, a.name).nbytes) for a in table.__attrs_attrs__)

    def wake_watchers(self) -> None:
        """Increase the version and wake all streams that follow the job."""
        self.version += 1
        for watcher in self.watchers:
            watcher.set()

    def answer(self) -> dict[str, Any]:
        """Return the state of the job as plain data, without its request."""
        result, over = self.result, self.is_over
        end = self.ended if self.ended is not None else monotonic()
        complete = self.state == "done" and (
            self.kind != "design" or (result is not None and result.complete)
        )
        listed = result if over and result is not None and self.state != "failed" else None
        return {
            "job": self.name,
            "kind": self.kind,
            "state": self.state,
            "fraction": round(self.fraction, 4),
            "found": self.found,
            "seconds": 0.0 if self.began is None else round(end - self.began, 3),
            "counts": None if listed is None else dict(listed.found),
            "distinct": None if listed is None else dict(listed.distinct),
            "best": 0 if over else self.best,
            "listed": 0 if result is None else len(result),
            "arrangements": self.asked.arrangements if self.kind == "design" else [],
            "ranking": None if result is None else list(result.query.rank_by),
            "complete": complete,
            "notes": list(map(str, self.notes)),
            "proof": None if listed is None or listed.proof is None else describe_proof(listed.proof),
            "error": self.error,
            "revision": self.revision,
            "table": list(self.table) if self.compares else None,
        }

    def keep_seating(self, key: tuple[int, int], seating: Seating | HandLoading) -> None:
        """Keep the seating of a fixture under ``key``, (revision, rank).

        The oldest one is dropped where too many are kept.
        """
        while len(self.seatings) >= SEATINGS_KEPT:
            self.seatings.pop(next(iter(self.seatings)))
        self.seatings[key] = seating

    def choose_entries(self, selection: ListSelection, result: Result) -> ShownEntries:
        """Return the entries of the result that a selection chooses; recent selections are cached."""
        key = (self.revision, selection)
        if key not in self.orders:
            found = selection.choose_entries(result)
            while len(self.orders) >= ORDERS_KEPT:
                self.orders.pop(next(iter(self.orders)))
            self.orders[key] = found
        return self.orders[key]


@define(eq=False)
class JobRegistry:
    """All jobs of a server.

    Parameters
    ----------
    pool : workers that search.
    limits : limits of the server.
    """

    pool: WorkerPool
    limits: ServerLimits
    by_name: dict[str, ServerJob] = field(factory=dict, init=False)
    freeing: asyncio.Task[None] | None = field(default=None, init=False)

    def get(self, name: str) -> ServerJob | None:
        """Return a job by its name, and note that it was used; None where there is none (any more)."""
        job = self.by_name.get(name)
        if job is not None:
            job.used = monotonic()
        return job

    def refuse_more(self, address: str) -> None:
        """Raise TooManyError where an address has too many unfinished jobs,
        BusyError where too many tasks wait.
        """
        running = sum(not job.is_over and job.address == address for job in self.by_name.values())
        if running >= self.limits.jobs:
            raise TooManyError(
                f"{running} of your searches are not over yet: wait for one of them, or cancel one."
            )
        self.pool.refuse_more(address)

    def submit(
        self,
        request: Mapping[str, Any],
        asked: AskedQueries,
        address: str,
        kind: str,
        sent_bytes: int = 0,
        stops_when_left: bool = False,
    ) -> ServerJob:
        """Return a new job, which runs in the background; ``sent_bytes`` is the length of its request.

        Raises TooManyError or BusyError as :meth:`refuse_more`.
        """
        self.refuse_more(address)
        weight = sent_bytes * BYTES_KEPT
        job = ServerJob(token_urlsafe(NAME_BYTES), request, asked, address, kind, weight, stops_when_left)
        self.by_name[job.name] = job
        job.runner = asyncio.create_task(self.run(job))
        self.make_room()
        return job

    async def stop_when_left(self, job: ServerJob) -> None:
        """Cancel a job when no client has requested or followed it for ``limits.left_seconds``."""
        while not job.is_over:
            away = 0.0 if job.watchers else monotonic() - job.used
            if away >= self.limits.left_seconds:
                self.cancel(job)
                return
            await asyncio.sleep(self.limits.left_seconds - away)

    def begin(self, job: ServerJob) -> None:
        """Note that a worker has begun a job, and wake its watchers."""
        job.began = monotonic()
        job.state = "running"
        job.wake_watchers()

    async def run(self, job: ServerJob) -> None:
        """Run a job in the pool and keep its outcome or error; its watchers are woken at the end."""
        payload: Any = job.asked
        if job.kind == "design":
            payload = job.asked, self.limits.fixtures, bool(job.request.get("every", False))
        name = "search" if job.kind == "design" else job.kind
        job.task = PoolTask(
            name,
            payload,
            self.limits.seconds,
            job.address,
            stops_well=job.kind != "family",
            report=lambda value: self.apply_report(job, value),
            begun=lambda: self.begin(job),
        )
        leaving = asyncio.create_task(self.stop_when_left(job)) if job.stops_when_left else None
        try:
            outcome = await self.pool.run(job.task)
            if isinstance(outcome, SearchOutcome):
                self.keep_outcome(job, outcome)
            elif isinstance(outcome, FoundFamily):
                job.family, job.fraction = outcome, 1.0
            elif len(job.table) < job.asked.count and not job.task.stop.is_set():
                job.notes = (ToolkitsLeft(self.limits.seconds),)
            job.state = "cancelled" if job.task.stop.is_set() else "done"
        except StoppedError:
            job.state = "cancelled"
        except (BusyError, FailedError, InputError) as error:
            job.state, job.error = "failed", str(error)
        finally:
            if leaving is not None:
                leaving.cancel()
        if self.by_name.get(job.name) is not job:
            # It was deleted meanwhile, and nobody will ask for what came of it.
            job.result = job.family = None
            self.free_memory()
        job.ended = monotonic()
        job.used = max(job.used, job.ended)
        job.wake_watchers()
        self.make_room()

    def keep_outcome(self, job: ServerJob, found: SearchOutcome) -> None:
        """Keep the outcome of a search in its job, with the notes that the server adds."""
        result, notes = found.result, [*found.result.notes]
        if found.left_out:
            kept = KeptBest(sum(result.found.values()), len(result))
            notes = [kept, *(note for note in notes if not isinstance(note, Cut))]
        if not result.complete and job.task is not None and not job.task.stop.is_set():
            notes.insert(0, Stopped(self.limits.seconds))
        job.result = evolve(result, notes=notes)
        # How many there are about says more than that nobody counted them.
        told = [note for note in notes if not (found.notes and isinstance(note, BestOnly))]
        job.notes = (*found.notes, *told)
        job.found = sum(result.found.values())
        job.fraction = 1.0 if result.complete else job.fraction
        job.revision += 1
        job.orders.clear()

    def apply_report(self, job: ServerJob, value: tuple[Any, ...]) -> None:
        """Apply a worker's report to a job, and wake its watchers.

        Reports are ("progress", fraction, found), ("preview" or "first", result) and ("row", row).
        """
        match value:
            case ("progress", fraction, found):
                job.fraction, job.found = max(float(fraction), job.fraction), max(int(found), job.best)
                if job.fraction >= LISTING and job.kind == "design":
                    job.state = "listing"
            case ("preview" | "first" as kind, Result() as result):
                job.result = result
                if kind == "first":
                    job.best, job.found = len(result), max(job.found, len(result))
                job.revision += 1
                job.orders.clear()
            case ("row", row):
                job.table.append(row)
                job.revision += 1
        job.wake_watchers()

    async def explain(self, job: ServerJob) -> Explanation:
        """Return why a job found no fixture; computed once and shared by all callers.

        Raises
        ------
        BusyError, FailedError, StoppedError
            When the computation did not finish; the caller may try again.
        """
        if job.explaining is None or (job.explaining.done() and not ended_without_error(job.explaining)):
            task = PoolTask("explanation", job.asked, self.limits.seconds, job.address)
            job.explaining = asyncio.create_task(self.pool.run(task))
        return await asyncio.shield(job.explaining)

    def cancel(self, job: ServerJob) -> None:
        """Ask a job that is not over to stop; its findings are kept."""
        if job.task is not None and not job.is_over:
            self.pool.cancel(job.task)

    def delete(self, name: str) -> None:
        """Stop and forget the job with a name, if there is one."""
        job = self.by_name.pop(name, None)
        if job is None:
            return
        self.cancel(job)
        if job.explaining is not None:
            job.explaining.cancel()
        if not job.is_over:
            job.state = "cancelled"
        job.wake_watchers()
        self.free_memory()

    def make_room(self) -> None:
        """Delete jobs past their lifetime and, if too much is kept, the least recently used ones."""
        now = monotonic()
        for job in [job for job in self.by_name.values() if now - job.used > self.limits.life_seconds]:
            self.delete(job.name)
        over = sorted((job for job in self.by_name.values() if job.is_over), key=lambda job: job.used)
        total = sum(job.size for job in over)
        # The newest stays whatever its size, which the limit on fixtures bounds.
        for job in over[:-1]:
            if total <= self.limits.kept_bytes and len(self.by_name) <= self.limits.kept_jobs:
                break
            total -= job.size
            self.delete(job.name)

    def wake_watchers(self) -> None:
        """Wake all streams that follow any job, without a new version."""
        for job in self.by_name.values():
            for watcher in job.watchers:
                watcher.set()

    def free_memory(self) -> None:
        """Schedule one :meth:`return_memory_later` for the memory of deleted jobs, unless one is scheduled already."""
        if self.freeing is None or self.freeing.done():
            self.freeing = asyncio.create_task(self.return_memory_later())

    async def return_memory_later(self) -> None:
        """Give freed memory back to the system after :data:`FREE_AFTER` seconds."""
        await asyncio.sleep(FREE_AFTER)
        await asyncio.to_thread(return_memory)

    async def forget_jobs_regularly(self) -> None:
        """Call :meth:`make_room` at intervals until cancelled."""
        while True:
            await asyncio.sleep(min(max(self.limits.life_seconds / 10, 0.1), 30.0))
            self.make_room()


def ended_without_error(task: asyncio.Task[Explanation]) -> bool:
    """Return whether a finished task was neither cancelled nor failed."""
    return not task.cancelled() and task.exception() is None
