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
from workhold.web.guard import AllowedHosts, ServerLimits
from workhold.web.origins import AllowedOrigins
from workhold.web.state import ServerState

__all__ = ["open_bound_socket", "is_for_others", "make_server", "run_server"]

# Seconds a client has to send the first lines of a request, and a response to end when the server stops.
HEADER_SECONDS = 15.0
STOP_SECONDS = 1
# Seconds after which connections are closed that have not ended by themselves then.
LAST_SECONDS = 0.2
TERMINATED = 143


class PatientProtocol(H11Protocol):
    """HTTP protocol that drops clients who send no request in time or open too many connections.

    Each server makes its own subclass with these attributes.

    Attributes
    ----------
    most : most connections of one address at the same time.
    trusted : addresses of proxies, whose connections come from many clients.
    open_connections : number of open connections by address.
    """

    most: int
    trusted: Collection[str]
    open_connections: Counter[str]
    header_timer: asyncio.TimerHandle | None = None
    peer: str = ""

    def connection_made(self, transport: Any) -> None:
        """Count a new connection, and close it if its address has too many."""
        super().connection_made(transport)
        self.peer = self.client[0] if self.client else ""
        self.open_connections[self.peer] += 1
        if self.open_connections[self.peer] > self.most and self.peer not in self.trusted:
            transport.close()
            return
        self.watch()

    def data_received(self, data: bytes) -> None:
        """Pass data on, then start or stop the timer for the request's first lines."""
        super().data_received(data)
        self.watch()

    def connection_lost(self, exc: Exception | None) -> None:
        """Remove a closed connection from the count, and stop its timer."""
        if self.header_timer is not None:
            self.header_timer.cancel()
        self.open_connections[self.peer] -= 1
        if not self.open_connections[self.peer]:
            del self.open_connections[self.peer]
        super().connection_lost(exc)

    def watch(self) -> None:
        """Start the timer while the first lines of a request are awaited; stop it once they are complete."""
        awaited = self.cycle is None or self.cycle.response_complete
        if awaited and self.header_timer is None:
            self.header_timer = self.loop.call_later(HEADER_SECONDS, self.give_up)
        elif not awaited and self.header_timer is not None:
            self.header_timer.cancel()
            self.header_timer = None

    def give_up(self) -> None:
        """Close the connection if no request has come."""
        self.header_timer = None
        if self.cycle is None or self.cycle.response_complete:
            self.transport.close()


class Server(uvicorn.Server):
    """A uvicorn server that reports when it listens, and notes by which signal it was stopped.

    uvicorn by itself would raise that signal again.
    """

    def __init__(self, config: uvicorn.Config, listening: Callable[[], None]) -> None:
        super().__init__(config)
        self.listening = listening
        self.stopped_by: int | None = None

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Stop gracefully on the first signal, at once on the second."""
        self.force_exit = self.should_exit
        self.should_exit = True
        self.stopped_by = sig

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End streams and workers, then shut down; connections that stay open are closed after a moment."""
        state: ServerState | None = getattr(self.config.app.state, "server", None)  # type: ignore[union-attr]
        if state is not None:
            await state.close()
        late = asyncio.create_task(self.let_go())
        try:
            await super().shutdown(sockets)
        finally:
            late.cancel()

    async def let_go(self) -> None:
        """Close the connections that are still open after :data:`LAST_SECONDS`."""
        await asyncio.sleep(LAST_SECONDS)
        for connection in list(self.server_state.connections):
            connection.transport.abort()

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Start, and report that the server listens."""
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
    """Serve until interrupted; raise SystemExit after SIGTERM.

    Parameters
    ----------
    host, port : where to listen; port 0 takes a free one.
    limits : sizes, counts, times and memory that the server allows.
    more_hosts : further names that the server may be called by.
    proxies : addresses of reverse proxies that are trusted to name the client that they ask for.
    token : secret that every request must contain; None for none.
    listening : called with the page's address once the server listens there.
    prepare : called before the first worker is started, when the address is known to be free.
    origins : of other sites' pages that may use it, as ``web.origins.check_origin`` writes them.

    Raises
    ------
    InputError
        When the server cannot listen at this address.
    """
    listener = open_bound_socket(host, port)
    shown = f"http://{format_host(host)}:{listener.getsockname()[1]}/"
    if token is not None:
        shown += f"?token={token}"
    hosts, allowed = list_hosts(host, more_hosts), AllowedOrigins(frozenset(origins))
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
    hosts: AllowedHosts,
    listening: Callable[[], None],
    proxies: Collection[str] = (),
    token: str | None = None,
    origins: AllowedOrigins | None = None,
) -> Server:
    """Return a server that does not run yet; parameters as for :func:`run_server`.

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


def open_bound_socket(host: str, port: int) -> socket.socket:
    """Return a socket bound to an address, which the server then listens at.

    Raises InputError for a host that this machine does not have, and a port that is taken.
    """
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
    except (OSError, UnicodeError) as error:
        raise InputError(
            f"--host {host!r} is not an address of this machine: leave it out, or give one such as 0.0.0.0."
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
    """Return whether a host, such as 0.0.0.0, stands for all addresses of the machine."""
    try:
        return ip_address(host).is_unspecified
    except ValueError:
        return False


def is_for_others(host: str) -> bool:
    """Return whether other machines can reach a server that listens at this host.

    >>> is_for_others("0.0.0.0"), is_for_others("localhost"), is_for_others("127.0.0.9")
    (True, False, False)
    """
    try:
        return not ip_address(host).is_loopback
    except ValueError:
        return host.lower() != "localhost"


def list_hosts(host: str, more: Collection[str]) -> AllowedHosts:
    """Return the names by which a server at this host may be called: those of the machine, ``host`` and
    ``more``.
    """
    everywhere = is_everywhere(host)
    names = {*AllowedHosts().names, *(name.lower() for name in more)}
    names.add(socket.gethostname().lower() if everywhere else host.lower())
    return AllowedHosts(frozenset(names), any_address=everywhere)


def format_host(host: str) -> str:
    """Return a host as written in a URL that a browser can open."""
    if is_everywhere(host):
        return "127.0.0.1"
    return f"[{host}]" if ":" in host else host
