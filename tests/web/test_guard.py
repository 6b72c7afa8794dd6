"""Who may ask for what: names, origins, sizes; and the headers of every answer."""

from __future__ import annotations

import socket
from collections.abc import Iterator

import httpx
import pytest
from running_server import PATIENCE, RunningServer, request
from test_parts import refused

from workhold.web.serve import list_hosts


@pytest.mark.thorough
@pytest.mark.parametrize(
    "path", ["/", "/api/about", "/api/none", "/static/none.js", "/api/openapi.json", "/api/jobs/x"]
)
def test_every_answer_has_the_headers(server: RunningServer, path: str) -> None:
    headers = server.client.get(path).headers
    policy = headers["content-security-policy"]
    for part in (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "connect-src 'self'",
        "frame-ancestors 'none'",
    ):
        assert part in policy
    assert "unsafe" not in policy
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert "access-control-allow-origin" not in headers
    if path.startswith("/api/"):
        assert headers["cache-control"] == "no-store"


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:80", "127.0.0.1.evil.example", "10.0.0.1", "", "[::2]"]
)
def test_other_names_are_refused(server: RunningServer, host: str) -> None:
    refused(server.client.get("/api/about", headers={"Host": host}))


@pytest.mark.parametrize("host", ["localhost", "LOCALHOST:8000", "127.0.0.1:1", "[::1]:8000"])
def test_names_of_this_machine_are_let_through(server: RunningServer, host: str) -> None:
    assert server.client.get("/api/about", headers={"Host": host}).status_code == 200


def test_a_server_for_all_addresses_is_called_by_numbers_and_given_names_only() -> None:
    hosts = list_hosts("0.0.0.0", ["shop.example"])
    assert hosts.knows("192.168.1.5:8000") and hosts.knows("Shop.Example") and not hosts.knows("evil.example")
    assert not list_hosts("127.0.0.1", []).knows("192.168.1.5")
    assert list_hosts("shop.example", []).knows("shop.example:80")


@pytest.mark.thorough
@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "https://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://localhost:1"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
    ],
)
def test_pages_of_other_sites_change_nothing(server: RunningServer, headers: dict[str, str]) -> None:
    url = server.done(request())
    before = len(server.state.jobs.by_name)
    refused(server.client.post("/api/jobs", json=request(), headers=headers), 403)
    refused(server.client.post("/api/parts", content=b"x", headers=headers), 403)
    refused(server.client.delete(url, headers=headers), 403)
    assert len(server.state.jobs.by_name) == before


def test_the_page_itself_may(server: RunningServer) -> None:
    origin = str(server.client.base_url).rstrip("/")
    headers = {"Origin": origin, "Sec-Fetch-Site": "same-origin"}
    answer = server.client.post("/api/jobs", json=request(), headers=headers)
    assert answer.status_code == 202


def test_compressed_requests_are_not_unpacked(server: RunningServer) -> None:
    for encoding in ("gzip", "deflate", "br", "zstd"):
        refused(server.client.post("/api/jobs", content=b"x", headers={"Content-Encoding": encoding}), 415)


def test_a_gigabyte_is_refused_before_it_is_sent(server: RunningServer) -> None:
    with socket.create_connection(server.address, timeout=PATIENCE) as connection:
        connection.sendall(
            b"POST /api/parts HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000000\r\n\r\n"
        )
        assert b" 413 " in connection.recv(200)


def test_a_body_without_a_length_is_cut_off(server: RunningServer) -> None:
    sent = 0

    def endless() -> Iterator[bytes]:
        nonlocal sent
        while sent < 1_000_000_000:
            sent += 1 << 16
            yield bytes(1 << 16)

    try:
        answer = server.client.post(
            "/api/jobs", content=endless(), headers={"Content-Type": "application/json"}
        )
        refused(answer, 413)
    except (httpx.WriteError, httpx.RemoteProtocolError, httpx.ReadError):
        # The server stopped listening in the middle of it, and the client never looked at the answer.
        pass
    assert sent < 100_000_000


@pytest.mark.parametrize("length", ["-1", "x", "9" * 30])
def test_lengths_that_are_none_are_refused(server: RunningServer, length: str) -> None:
    with socket.create_connection(server.address, timeout=PATIENCE) as connection:
        connection.sendall(
            f"POST /api/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Length: {length}\r\n\r\n".encode()
        )
        assert connection.recv(200).split(b" ")[1] in (b"400", b"413")
