"""The state shared by the routes of one server: its workers, its jobs and the page's files.

The files are read once into a table; names in requests are looked up only there.
"""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Coroutine, Iterator
from contextlib import asynccontextmanager, suppress
from hashlib import sha256
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any, get_type_hints

from attrs import define, field, frozen
from fastapi.routing import APIRoute
from starlette.requests import Request
from starlette.responses import Response

from workhold.web.guard import ServerLimits
from workhold.web.jobs import JobRegistry
from workhold.web.pool import PoolTask, StoppedError, WorkerPool
from workhold.web.request_forms import Form

__all__ = [
    "CheckedRoute",
    "ServerState",
    "get_client_address",
    "run_at_desk",
    "run_at_desk_while_connected",
    "get_state",
]

TYPES = {
    "html": "text/html; charset=utf-8",
    "css": "text/css; charset=utf-8",
    "js": "text/javascript; charset=utf-8",
    "svg": "image/svg+xml",
    "json": "application/json",
    "txt": "text/plain; charset=utf-8",
}


@frozen
class StaticFile:
    """A file of the page.

    Parameters
    ----------
    content : bytes of the file.
    type : content type.
    tag : identifier of this content, for caches.
    """

    content: bytes
    type: str
    tag: str


def read_static_files() -> dict[str, StaticFile]:
    """Return the files of the page by their paths below ``static``, such as ``space/orbit.js``."""
    return dict(read_files_below(files("workhold.web") / "static", ""))


def read_files_below(folder: Traversable, prefix: str) -> Iterator[tuple[str, StaticFile]]:
    """Yield (path, file) for each file below a folder whose ending is known; ``prefix`` comes before the
    path.
    """
    for entry in folder.iterdir():
        kind = TYPES.get(entry.name.rpartition(".")[2].lower())
        if entry.is_dir():
            yield from read_files_below(entry, f"{prefix}{entry.name}/")
        elif kind is not None:
            content = entry.read_bytes()
            yield prefix + entry.name, StaticFile(content, kind, f'"{sha256(content).hexdigest()[:20]}"')


@define(eq=False)
class ServerState:
    """Workers, jobs, and the page's files.

    Parameters
    ----------
    limits : limits of the server.
    searchers, desks : workers that search, and workers for quick tasks.
    """

    limits: ServerLimits
    searchers: WorkerPool = field(init=False)
    desks: WorkerPool = field(init=False)
    jobs: JobRegistry = field(init=False)
    files: dict[str, StaticFile] = field(factory=read_static_files, init=False)
    builtin: dict[str, dict[str, Any]] = field(factory=dict, init=False)
    streams: int = field(default=0, init=False)
    is_closing: asyncio.Event = field(factory=asyncio.Event, init=False)

    def __attrs_post_init__(self) -> None:
        limits = self.limits
        self.searchers = WorkerPool("search", limits.searches, limits.memory_bytes, limits.waiting)
        self.desks = WorkerPool("desk", limits.desks, limits.desk_memory_bytes, limits.waiting)
        self.jobs = JobRegistry(self.searchers, limits)

    @asynccontextmanager
    async def open(self) -> AsyncIterator[None]:
        """Run the workers within the block."""
        self.searchers.open()
        self.desks.open()
        sweeper = asyncio.create_task(self.jobs.forget_jobs_regularly())
        try:
            yield
        finally:
            sweeper.cancel()
            with suppress(asyncio.CancelledError):
                await sweeper
            await self.close()

    async def close(self) -> None:
        """End streams of events, and the workers with their tasks; calling it again does nothing."""
        self.is_closing.set()
        self.jobs.wake_watchers()
        await asyncio.gather(self.searchers.close(), self.desks.close())


def get_state(request: Request) -> ServerState:
    """Return the state of the server that received a request."""
    state: ServerState = request.app.state.server
    return state


def get_client_address(request: Request) -> str:
    """Return the address of the client of a request; "" where it is not known."""
    return "" if request.client is None else request.client.host


async def run_at_desk(request: Request, name: str, payload: Any, seconds: float | None = None) -> Any:
    """Return the outcome of a quick task done by a worker.

    ``seconds`` is the time limit; None for that of quick tasks. For errors see
    :meth:`workhold.web.pool.WorkerPool.run`.
    """
    state = get_state(request)
    return await state.desks.run(
        PoolTask(name, payload, seconds or state.limits.desk_seconds, get_client_address(request))
    )


async def run_at_desk_while_connected(request: Request, name: str, payload: Any) -> Any:
    """Return the outcome of a quick task done by a worker; the task is asked to stop when the client hangs
    up.

    The task must end by itself when asked to stop. Raises StoppedError when the client is gone.
    """
    state = get_state(request)
    task = PoolTask(name, payload, state.limits.desk_seconds, get_client_address(request), stops_well=True)
    running, gone = asyncio.create_task(state.desks.run(task)), asyncio.create_task(wait_for_hang_up(request))
    try:
        await asyncio.wait((running, gone), return_when=asyncio.FIRST_COMPLETED)
        if not running.done():
            raise StoppedError
        return running.result()
    finally:
        for one in (running, gone):
            one.cancel()
        await asyncio.gather(running, gone, return_exceptions=True)


# Bytes of a request that is checked where all clients wait for it, which takes some 10 ms.
AT_ONCE = 1 << 15


class CheckedRoute(APIRoute):
    """A route whose larger requests are checked by a worker first.

    Checking a request with hundreds of thousands of faults takes seconds. Meanwhile the server itself could
    not answer.
    """

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Return the handler of a request of this route,
        which has larger bodies checked by a worker first.
        """
        handler, form = super().get_route_handler(), self.find_form()

        async def handle_checked_request(request: Request) -> Response:
            """Return the answer to a request, after a check of a large body."""
            if form is not None:
                body = await request.body()
                if len(body) > AT_ONCE:
                    await run_at_desk(request, "check_body", (form, body, get_state(request).limits.segments))
            return await handler(request)

        return handle_checked_request

    def find_form(self) -> type[Form] | None:
        """Return the form of the route's requests; None if their body is empty or the bytes of a file."""
        kinds = get_type_hints(self.endpoint).values()
        return next((kind for kind in kinds if isinstance(kind, type) and issubclass(kind, Form)), None)


async def wait_for_hang_up(request: Request) -> None:
    """Wait until the client of a request, whose body has been received, disconnects."""
    while (await request.receive())["type"] != "http.disconnect":
        pass
