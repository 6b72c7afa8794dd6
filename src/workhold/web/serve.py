"""The server's process: its socket, its connections, and its end."""

from __future__ import annotations

import asyncio
import signal
import socket
from collections import Counter
from collections.abc import Callable, Collection
from functools import partial
from ipaddress import ip_address
from types import FrameType
from typing import Any

import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from workhold.errors import InputError
from workhold.web.app import create_app
from workhold.web.guard import Hosts, ServerLimits
from workhold.web.origins import Origins
from workhold.web.state import ServerState

__all__ = ["bound_socket", "is_for_others", "make_server", "run_server"]

# Seconds a client has to send the first lines of a request, and a response to end when the server stops.
HEADER_SECONDS = 15.0
STOP_SECONDS = 1
# Seconds after which connections are closed that have not ended by themselves then.
LAST_SECONDS = 0.2
TERMINATED = 143


class PatientProtocol(H11Protocol):
    """HTTP that drops clients who send no request in time, or who take too many connections.

    A server makes a subclass of its own with these:

    Attributes
    ----------
    most : connections of one address at the same time.
    trusted : proxies, whose connections are those of many.
    open_connections : by address.
    """

    most: int
    trusted: Collection[str]
    open_connections: Counter[str]
    header_timer: asyncio.TimerHandle | None = None
    peer: str = ""

    def connection_made(self, transport: Any) -> None:
        """Count a connection, and close one too many."""
        super().connection_made(transport)
        self.peer = self.client[0] if self.client else ""
        self.open_connections[self.peer] += 1
        if self.open_connections[self.peer] > self.most and self.peer not in self.trusted:
            transport.close()
            return
        self.watch()

    def data_received(self, data: bytes) -> None:
        """Pass data on, and starts or stops the timer."""
        super().data_received(data)
        self.watch()

    def connection_lost(self, exc: Exception | None) -> None:
        """Count a connection no longer."""
        if self.header_timer is not None:
            self.header_timer.cancel()
        self.open_connections[self.peer] -= 1
        if not self.open_connections[self.peer]:
            del self.open_connections[self.peer]
        super().connection_lost(exc)

    def watch(self) -> None:
        """Run the timer while a request has begun and its first lines are not complete."""
        awaited = self.cycle is None or self.cycle.response_complete
        if awaited and self.header_timer is None:
            self.header_timer = self.loop.call_later(HEADER_SECONDS, self.give_up)
        elif not awaited and self.header_timer is not None:
            self.header_timer.cancel()
            self.header_timer = None

    def give_up(self) -> None:
        """Close a connection without a request."""
        self.header_timer = None
        if self.cycle is None or self.cycle.response_complete:
            self.transport.close()


class Server(uvicorn.Server):
    """A server that reports when it listens, and notes by which signal it was stopped.

    uvicorn would raise that signal again.
    """

    def __init__(self, config: uvicorn.Config, listening: Callable[[], None]) -> None:
        super().__init__(config)
        self.listening = listening
        self.stopped_by: int | None = None

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Stop in order on the first signal, and without a wait on the second."""
        self.force_exit = self.should_exit
        self.should_exit = True
        self.stopped_by = sig

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End streams and workers first, and soon lets go of clients who still send."""
        state: ServerState | None = getattr(self.config.app.state, "server", None)  # type: ignore[union-attr]
        if state is not None:
            await state.close()
        late = asyncio.create_task(self.let_go())
        try:
            await super().shutdown(sockets)
        finally:
            late.cancel()

    async def let_go(self) -> None:
        """Close the connections that are left after a moment."""
        await asyncio.sleep(LAST_SECONDS)
        for connection in list(self.server_state.connections):
            connection.transport.abort()

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Start, and reports that the server listens."""
        await super().startup(sockets)
        if self.started and not self.should_exit:
            self.listening()


def run_server(
    host: str,
    port: int,
    limits: ServerLimits,
    more_hosts: Collection[str],
    proxies: Collection[str],
    token: str | None,
    listening: Callable[[str], None],
    prepare: Callable[[], None],
    origins: Collection[str],
) -> None:
    """Serve until interrupted.

    Parameters
    ----------
    host, port : where to listen; port 0 takes a free one.
    limits : how much to give.
    more_hosts : further names that the server may be called by.
    proxies : addresses of reverse proxies that are trusted to say whom they ask for.
    token : a secret that every request must bring, or None.
    listening : called with the page's address once it is there.
    prepare : called before the first worker is started, when the address is known to be free.
    origins : of other sites' pages that may use it, as ``web.origins.check_origin`` writes them.

    Raises
    ------
    InputError
        When nothing can listen there.
    """
    listener = bound_socket(host, port)
    shown = f"http://{format_host(host)}:{listener.getsockname()[1]}/"
    if token is not None:
        shown += f"?token={token}"
    hosts, allowed = list_hosts(host, more_hosts), Origins(frozenset(origins))
    server = make_server(limits, hosts, partial(listening, shown), proxies, token, allowed)
    try:
        prepare()
        server.run(sockets=[listener])
        if server.stopped_by == signal.SIGTERM:
            raise SystemExit(TERMINATED)
    finally:
        listener.close()


def make_server(
    limits: ServerLimits,
    hosts: Hosts,
    listening: Callable[[], None],
    proxies: Collection[str] = (),
    token: str | None = None,
    origins: Origins | None = None,
) -> Server:
    """Make a server that does not run yet; parameters as for :func:`run_server`.

    ``listening`` is called once the server takes requests.
    """
    own = {"most": limits.client_connections, "trusted": frozenset(proxies), "open_connections": Counter()}
    config = uvicorn.Config(
        create_app(limits, hosts, token, origins),
        http=type("Protocol", (PatientProtocol,), own),
        ws="none",
        lifespan="on",
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=bool(proxies),
        forwarded_allow_ips=list(proxies),
        limit_concurrency=limits.connections,
        timeout_graceful_shutdown=STOP_SECONDS,
    )
    return Server(config, listening)


def bound_socket(host: str, port: int) -> socket.socket:
    """Open a socket that listens at an address.

    Refuses an address that there is not, or at which another program listens.
    """
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
    except (OSError, UnicodeError) as error:
        raise InputError(
            f"--host {host!r} is no address of this machine: leave it out, or give one such as 0.0.0.0."
        ) from error
    listener = socket.socket(family, kind, protocol)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
    except OSError as error:
        listener.close()
        reason = (error.strerror or str(error)).lower()
        raise InputError(
            f"nothing can listen at {host} port {port} ({reason}): choose another --port."
        ) from error
    listener.set_inheritable(False)
    return listener


def is_everywhere(host: str) -> bool:
    """Return whether a host means every address of the machine."""
    try:
        return ip_address(host).is_unspecified
    except ValueError:
        return False


def is_for_others(host: str) -> bool:
    """Return whether a server that listens at a host can be reached from other machines.

    >>> is_for_others("0.0.0.0"), is_for_others("localhost"), is_for_others("127.0.0.9")
    (True, False, False)
    """
    try:
        return not ip_address(host).is_loopback
    except ValueError:
        return host.lower() != "localhost"


def list_hosts(host: str, more: Collection[str]) -> Hosts:
    everywhere = is_everywhere(host)
    names = {*Hosts().names, *(name.lower() for name in more)}
    names.add(socket.gethostname().lower() if everywhere else host.lower())
    return Hosts(frozenset(names), any_address=everywhere)


def format_host(host: str) -> str:
    """Write a host as it stands in an address that can be opened."""
    if is_everywhere(host):
        return "127.0.0.1"
    return f"[{host}]" if ":" in host else host
