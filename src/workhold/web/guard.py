"""Limits of the server, and the guard that stands before every request.

Limits are sizes, counts, times and memory. The guard checks each request's host name, origin and size, and
sets the headers of answers.
"""

from __future__ import annotations

import asyncio
import json
import os
from collections import Counter
from collections.abc import Awaitable, Callable, Collection, MutableMapping
from hmac import compare_digest
from ipaddress import ip_address
from typing import Any
from urllib.parse import parse_qs

from attrs import define, field, frozen
from starlette.exceptions import HTTPException

from workhold.web.origins import AllowedOrigins

__all__ = ["BASES", "Guard", "AllowedHosts", "ServerLimits", "compute_usual_memory"]

# Memory of a search in bytes; the least with which one can work; and the share of the machine's that all
# searches may take.
MEMORY, LEAST_MEMORY, SHARE = 4 << 30, 1 << 30, 0.7


@frozen
class ServerLimits:
    """Limits of a server.

    Parameters
    ----------
    upload_bytes : most bytes of a file with a part.
    request_bytes : most bytes of any other request.
    body_seconds : seconds within which a request must arrive.
    uploads, client_uploads : files that may arrive at the same time, from all addresses and from one.
    segments : most segments of a part.
    searches : number of searches at the same time, each in a process of its own.
    desks : number of processes for quick tasks: reading files, pictures, loads.
    waiting : number of searches, and of quick tasks, that may wait for a process.
    jobs : number of unfinished searches of one address.
    seconds : time limit of a search; its result is then what it has found so far.
    desk_seconds : time limit for reading a file, a picture and the like.
    memory_bytes, desk_memory_bytes : address space of a process that searches, and of one for quick tasks.
    fixtures : most fixtures kept of one search, the best ones.
    kept_jobs, kept_bytes : number of searches kept, and bytes of their fixtures; the least recently used are
        deleted first.
    life_seconds : seconds after its last use until a search is deleted.
    left_seconds : seconds after which a job is cancelled if its client has gone and the request asked for
        this.
    streams : number of streams of events at the same time.
    connections, client_connections : connections at the same time, from all addresses and from one.
    """

    upload_bytes: int = 20_000_000
    request_bytes: int = 4_000_000
    body_seconds: float = 60.0
    uploads: int = 16
    client_uploads: int = 4
    segments: int = 2_000
    searches: int = 2
    desks: int = 2
    waiting: int = 64
    jobs: int = 64
    seconds: float = 120.0
    desk_seconds: float = 20.0
    memory_bytes: int = MEMORY
    desk_memory_bytes: int = 2 << 30
    fixtures: int = 300_000
    kept_jobs: int = 1_000
    kept_bytes: int = 1 << 30
    life_seconds: float = 3600.0
    left_seconds: float = 10.0
    streams: int = 256
    connections: int = 1_024
    client_connections: int = 128


def compute_usual_memory(searches: int) -> int:
    """Return the bytes of address space for each of ``searches`` simultaneous searches.

    It is 4 GiB, or an equal share of the machine's memory where that is less, but at least 1 GiB.
    """
    try:
        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):
        return MEMORY
    return min(MEMORY, max(int(SHARE * memory / searches), LEAST_MEMORY))


Scope = MutableMapping[str, Any]
Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

HEADERS = {
    b"content-security-policy": (
        b"default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
        b"connect-src 'self'; "
        b"base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    b"x-content-type-options": b"nosniff",
    b"referrer-policy": b"no-referrer",
    b"cross-origin-resource-policy": b"same-origin",
    b"cross-origin-opener-policy": b"same-origin",
    b"permissions-policy": b"camera=(), geolocation=(), microphone=()",
}
READING = ("GET", "HEAD", "OPTIONS")
# Where the interface is: its version, and the present one for those who do not say.
BASES = ("/api/v1", "/api")
UPLOADS = tuple(f"{base}{path}" for base in BASES for path in ("/parts", "/parts/survey", "/parts/shape"))
COOKIE = "workhold-token"


@define
class AllowedHosts:
    """The host names under which the server may be addressed. Another name suggests a link from a foreign
    page.

    Parameters
    ----------
    names : in small letters, without port.
    any_address : whether any numeric address is allowed, as when the server listens on all addresses.
    """

    names: Collection[str] = ("localhost", "127.0.0.1", "::1")
    any_address: bool = False

    def knows(self, host: str) -> bool:
        """Return whether a Host header, port ignored, names this server:
        a known name or, if allowed, any numeric address.

        >>> AllowedHosts().knows("localhost:8000"), AllowedHosts().knows("evil.example"), AllowedHosts().knows("[::1]:80")
        (True, False, True)
        """
        name = strip_port(host)
        if name in self.names:
            return True
        try:
            ip_address(name)
        except ValueError:
            return False
        return self.any_address


def strip_port(host: str) -> str:
    """Return a host without its port and brackets, in small letters."""
    if host.startswith("["):
        return host[1:].partition("]")[0].lower()
    return host.partition(":")[0].lower()


@define
class Guard:
    """The outermost layer of the server: it refuses inadmissible requests.

    Parameters
    ----------
    app : application that it protects.
    hosts : names of the server.
    limits : limits on bytes, and on the time a request may take to arrive.
    token : secret that every request must contain; None for none.
    origins : origins of other sites' pages that may use the server.
    """

    app: App
    hosts: AllowedHosts
    limits: ServerLimits
    token: str | None = None
    origins: AllowedOrigins = field(factory=AllowedOrigins)
    arriving: Counter[str] = field(factory=Counter, init=False)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request that is refused; pass any other request to the application, with limits on its
        body.
        """
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        headers = {name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]}
        is_api = scope["path"].startswith("/api/")

        async def send_guarded(message: Message) -> None:
            """Send a message, adding the guard's headers to the start of a response."""
            if message["type"] == "http.response.start":
                present = {name.lower() for name, _ in message["headers"]}
                more = [(name, value) for name, value in HEADERS.items() if name not in present]
                if is_api and b"cache-control" not in present:
                    more.append((b"cache-control", b"no-store"))
                more += self.origins.make_sharing_headers(headers) if is_api else []
                message["headers"] = [*message["headers"], *more]
            await send(message)

        refusal = self.find_refusal(scope, headers)
        if refusal is not None:
            await send_error(send_guarded, *refusal)
            return
        if is_api and self.origins.is_preflight(scope["method"], headers):
            # It brings no token: browsers send none before they have been let in.
            may = self.origins.answer_preflight(headers)
            await send_guarded({"type": "http.response.start", "status": 204, "headers": may})
            await send_guarded({"type": "http.response.body", "body": b""})
            return
        if self.token is not None and not holds_token(self.token, headers):
            await ask_for_token(send_guarded, scope, self.token)
            return
        uploads = scope["method"] == "POST" and scope["path"] in UPLOADS
        client = scope["client"][0] if scope.get("client") else ""
        if uploads and self.arriving[client] >= self.limits.client_uploads:
            await send_error(
                send_guarded, 429, "Too many of your files are arriving at the same time: send one by one."
            )
            return
        if uploads and self.arriving.total() >= self.limits.uploads:
            await send_error(
                send_guarded, 503, "Too many files are arriving at the same time: try again in a moment."
            )
            return
        self.arriving[client] += uploads
        try:
            most = self.limits.upload_bytes if uploads else self.limits.request_bytes
            await self.app(scope, LimitedBody(receive, most, self.limits.body_seconds), send_guarded)
        finally:
            self.arriving[client] -= uploads
            self.arriving += Counter()

    def find_refusal(self, scope: Scope, headers: dict[str, str]) -> tuple[int, str] | None:
        """Return (status, sentence) for a request with inadmissible headers; None for an admissible request."""
        host = headers.get("host", "")
        if not self.hosts.knows(host):
            return 400, "This server is not known by that name: use the address that it printed."
        if len(scope.get("raw_path") or b"") + len(scope.get("query_string") or b"") > 4_000:
            return 414, "The address is too long."
        if scope["method"] not in READING:
            site = headers.get("sec-fetch-site", "same-origin")
            origin = headers.get("origin")
            strange = origin is not None and origin.partition("://")[2].lower() != host.lower()
            strange = strange or site not in ("same-origin", "none")
            if strange and not self.origins.allows(headers):
                return 403, "A page of another site may not change anything here."
            if headers.get("content-encoding", "identity").lower() != "identity":
                return 415, "Send the request as it is, without compression."
            most = self.limits.upload_bytes if scope["path"] in UPLOADS else self.limits.request_bytes
            length = headers.get("content-length", "0")
            if not (length.isascii() and length.isdigit()):
                return 400, "The length of the request is not a number."
            if len(length) > 15 or int(length) > most:
                return 413, explain_too_large(most)
        return None


def holds_token(token: str, headers: dict[str, str]) -> bool:
    """Return whether a request's headers contain the token, as a cookie or as a bearer token."""
    cookies = (part.strip().partition("=") for part in headers.get("cookie", "").split(";"))
    offered = [value for name, _, value in cookies if name == COOKIE]
    kind, _, value = headers.get("authorization", "").partition(" ")
    if kind.lower() == "bearer":
        offered.append(value.strip())
    return any(compare_digest(one.encode(), token.encode()) for one in offered)


async def ask_for_token(send: Send, scope: Scope, token: str) -> None:
    """Answer a request without the token: status 401, or a redirect that sets the cookie.

    The redirect is sent where the address of the request contains the token.
    """
    query = parse_qs((scope.get("query_string") or b"").decode("latin-1"))
    offered = query.get("token", [""])[0]
    if scope["method"] not in ("GET", "HEAD") or not compare_digest(offered.encode(), token.encode()):
        await send_error(
            send, 401, "This server asks for a token: open the page with the address that it printed."
        )
        return
    # Without a path the cookie is for the page's own folder, also behind a proxy that serves the page under a
    # path.
    cookie = f"{COOKIE}={token}; HttpOnly; SameSite=Strict"
    headers = [(b"location", b"./"), (b"set-cookie", cookie.encode()), (b"content-length", b"0")]
    await send({"type": "http.response.start", "status": 303, "headers": headers})
    await send({"type": "http.response.body", "body": b""})


@define
class LimitedBody:
    """The body of a request, read up to a limit of bytes and of time.

    Parameters
    ----------
    receive : the server's own function to receive messages.
    most : most bytes.
    seconds : time limit for the whole body.
    """

    receive: Receive
    most: int
    seconds: float
    taken: int = 0
    is_whole: bool = False
    end: float | None = None

    async def __call__(self) -> Message:
        """Return the next message of the body or, once it is complete, the server's next message.

        Raises HTTPException 413 for a body that is too large, and 408 for one that takes too long.
        """
        if self.is_whole:
            return await self.receive()
        now = asyncio.get_running_loop().time()
        self.end = now + self.seconds if self.end is None else self.end
        try:
            async with asyncio.timeout(max(self.end - now, 0.0)):
                message = await self.receive()
        except TimeoutError:
            raise HTTPException(408, f"The request took longer than {self.seconds:g} s to arrive.") from None
        self.taken += len(message.get("body", b""))
        if self.taken > self.most:
            raise HTTPException(413, explain_too_large(self.most))
        self.is_whole = not message.get("more_body", False)
        return message


def explain_too_large(most: int) -> str:
    """Return a sentence that says how many bytes a request may have."""
    size = f"{most / 1e6:g} MB" if most >= 100_000 else f"{most} bytes"
    return f"The request is larger than {size}: send a drawing of the part's outline only."


async def send_error(send: Send, status: int, sentence: str) -> None:
    """Send an error as JSON, in the form that the application's errors have."""
    body = json.dumps({"error": sentence, "place": None}).encode()
    headers = [(b"content-type", b"application/json"), (b"content-length", str(len(body)).encode())]
    if status in (408, 413):
        headers.append((b"connection", b"close"))
    if status in (429, 503):
        headers.append((b"retry-after", b"1"))
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})
