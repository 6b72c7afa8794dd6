"""Pages of other sites: none may use the server, but for those whose origins are named."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from running_server import RunningServer, request, running_server
from test_parts import refused
from typer.testing import CliRunner

from workhold.cli.main import app
from workhold.web.origins import check_origin

SHOP = "https://shop.example"
ASKS = {"Access-Control-Request-Method": "POST", "Access-Control-Request-Headers": "content-type"}


@pytest.fixture(scope="module")
def shared() -> Iterator[RunningServer]:
    """A server that asks for a token, and that pages of one other site may use."""
    with running_server(token="secret", origins=[SHOP]) as running:
        running.client.headers["Authorization"] = "Bearer secret"
        yield running


def crossing(headers: dict[str, str]) -> dict[str, str]:
    """The headers of an answer that browsers look at before they hand it to a page of another site."""
    return {key: value for key, value in headers.items() if key.startswith("access-control-")}


@pytest.mark.thorough
def test_a_page_of_a_named_site_searches(shared: RunningServer) -> None:
    """As a browser does it: it asks without the token, sends with it, and reads the answer."""
    headers = {"Origin": SHOP, "Sec-Fetch-Site": "cross-site"}
    with shared.client_from("127.0.0.1") as bare:
        asked = bare.options("/api/v1/jobs", headers={**headers, **ASKS})
        assert asked.status_code == 204 and not asked.content
        assert asked.headers["access-control-allow-origin"] == SHOP
        assert "POST" in asked.headers["access-control-allow-methods"]
        allowed = asked.headers["access-control-allow-headers"].lower()
        for name in ("authorization", "content-type", "last-event-id", "x-filename"):
            assert name in allowed
        refused(bare.post("/api/v1/jobs", headers=headers, json=request()), 401)
    begun = shared.client.post("/api/v1/jobs", headers=headers, json=request())
    assert begun.status_code == 202
    assert crossing(begun.headers)["access-control-allow-origin"] == SHOP
    assert "Location" in begun.headers["access-control-expose-headers"]
    # No cookie goes along, so that nobody's session is used.
    assert "access-control-allow-credentials" not in begun.headers
    url = begun.json()["url"]
    wrong = shared.client.get(f"{url}x", headers=headers)
    assert wrong.status_code == 404 and crossing(wrong.headers)["access-control-allow-origin"] == SHOP
    assert shared.client.delete(url, headers=headers).status_code == 204


@pytest.mark.thorough
@pytest.mark.parametrize(
    "origin", ["https://evil.example", "http://shop.example", f"{SHOP}:444", f"{SHOP}.evil.example", "null"]
)
def test_other_pages_stay_out(shared: RunningServer, origin: str) -> None:
    headers = {"Origin": origin, "Sec-Fetch-Site": "cross-site"}
    asked = shared.client.options("/api/v1/jobs", headers={**headers, **ASKS})
    assert asked.status_code >= 400 and not crossing(asked.headers)
    refused(shared.client.post("/api/v1/jobs", headers=headers, json=request()), 403)
    seen = shared.client.get("/api/v1/about", headers=headers)
    assert seen.status_code == 200 and not crossing(seen.headers)
    # So that no cache hands the answer of one page to another.
    assert seen.headers["vary"] == "Origin"


@pytest.mark.thorough
def test_the_page_of_the_server_itself_is_not_shared(shared: RunningServer) -> None:
    assert not crossing(shared.client.get("/static/main.js", headers={"Origin": SHOP}).headers)
    assert not crossing(shared.client.get("/", headers={"Origin": SHOP}).headers)


def test_without_named_sites_nothing_is_said_of_any(server: RunningServer) -> None:
    asked = server.client.options("/api/v1/jobs", headers={"Origin": SHOP, **ASKS})
    assert asked.status_code == 405
    answer = server.client.get("/api/v1/about", headers={"Origin": SHOP})
    assert not crossing(answer.headers) and "vary" not in answer.headers


def test_a_page_of_the_internet_may_reach_a_server_at_home(shared: RunningServer) -> None:
    """Where its browser asks for that: see Private Network Access."""
    private = {"Access-Control-Request-Private-Network": "true"}
    for more, told in ((private, "true"), ({}, None)):
        asked = shared.client.options("/api/v1/jobs", headers={"Origin": SHOP, **ASKS, **more})
        assert asked.headers.get("access-control-allow-private-network") == told


@pytest.mark.parametrize(
    ("given", "written"),
    [
        (SHOP, SHOP),
        ("HTTP://LocalHost:5173", "http://localhost:5173"),
        ("http://shop.example:80/", "http://shop.example"),
        ("https://shop.example:80", "https://shop.example:80"),
        ("http://[::1]:3000", "http://[::1]:3000"),
    ],
)
def test_origins_are_written_as_browsers_send_them(given: str, written: str) -> None:
    assert check_origin(given) == written


@pytest.mark.parametrize(
    "given",
    [
        "*",
        "null",
        "shop.example",
        "ftp://shop.example",
        f"{SHOP}/page",
        f"{SHOP}?x=1",
        "https://u@shop.example",
        "http://x:y",
        "",
    ],
)
def test_what_is_no_origin_is_refused(given: str) -> None:
    outcome = CliRunner().invoke(app, ["serve", "--allow-origin", given, "--port", "0"])
    assert outcome.exit_code == 2 and "is not an origin" in " ".join(outcome.stderr.split())
