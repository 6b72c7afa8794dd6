"""The clients of the examples work with a server that runs: from a drawing to the sheet of the first choice."""

from __future__ import annotations

import os
import re
import shutil
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, ClassVar

import pytest
from running_server import RunningServer, running_server

pytestmark = pytest.mark.thorough

ROOT = Path(__file__).parents[2]
CLIENTS = ROOT / "examples" / "clients"
PAGE = (ROOT / "docs" / "server.md").read_text(encoding="utf-8")
PROGRAMS = {
    "python": [sys.executable, str(CLIENTS / "design.py")],
    "node": ["node", str(CLIENTS / "design.mjs")],
}
TOKEN = "a-secret"


class QuietHandler(SimpleHTTPRequestHandler):
    """Files of a folder, without a line on the terminal for each."""

    extensions_map: ClassVar[dict[str, str]] = {
        **SimpleHTTPRequestHandler.extensions_map,
        ".mjs": "text/javascript",
    }  # type: ignore[misc]

    def log_message(self, format: str, *arguments: object) -> None:
        """Says nothing."""


@pytest.fixture(scope="module")
def elsewhere() -> Iterator[str]:
    """The origin of another site, which has the clients' files."""
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(QuietHandler, directory=str(CLIENTS))) as site:
        threading.Thread(target=site.serve_forever, daemon=True).start()
        yield f"http://localhost:{site.server_address[1]}"
        site.shutdown()


@pytest.fixture(scope="module")
def serving(elsewhere: str) -> Iterator[RunningServer]:
    """A server that pages of the other site may use."""
    with running_server(origins=[elsewhere]) as running:
        yield running


def run(client: str, drawing: Path, server: str, token: str = "") -> subprocess.CompletedProcess[str]:
    """What a client prints; without it where its program is not there."""
    program = PROGRAMS[client]
    if shutil.which(program[0]) is None:
        pytest.skip(f"{program[0]} is not installed")
    environment = {**os.environ, "WORKHOLD_TOKEN": token}
    return subprocess.run(
        [*program, str(drawing), server],
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def address(server: RunningServer) -> str:
    """The server's address, as it is given to a client."""
    return str(server.client.base_url).rstrip("/")


def first_choices(server: RunningServer) -> list[str]:
    """The lines that a client prints of the bracket, from what the server answers here."""
    path = ROOT / "examples" / "bracket.dxf"
    part = server.client.post(
        "/api/parts", content=path.read_bytes(), headers={"X-Filename": path.name}
    ).json()
    toolkit = {"kind": "vise", "pitch": [10, 10], "columns": 2, "peg_radius": 3}
    url = server.done({"workpiece": {key: part[key] for key in ("name", "loops")}, "toolkit": toolkit})
    rows = server.client.get(f"{url}/fixtures?limit=3").json()["rows"]
    server.client.delete(url)
    return [
        f"{row['rank']} {' '.join(row['holes'])} {row['quality']['location_error']:.3f} mm" for row in rows
    ]


@pytest.mark.parametrize("client", PROGRAMS)
def test_a_client_goes_from_a_drawing_to_a_sheet(serving: RunningServer, client: str, tmp_path: Path) -> None:
    """It prints the first three choices, saves the sheet, tells its states, and leaves no job behind."""
    drawing = shutil.copy(ROOT / "examples" / "bracket.dxf", tmp_path / "bräcket.dxf")
    outcome = run(client, Path(drawing), address(serving))
    assert outcome.returncode == 0, outcome.stderr
    assert outcome.stdout.splitlines() == first_choices(serving)
    assert (tmp_path / "bräcket.pdf").read_bytes().startswith(b"%PDF")
    told = outcome.stderr.splitlines()
    assert told[-1].startswith("done: ") and len(told) >= 2
    assert not serving.state.jobs.by_name


@pytest.mark.parametrize("client", PROGRAMS)
def test_what_the_server_refuses_is_its_sentence(serving: RunningServer, client: str, tmp_path: Path) -> None:
    drawing = tmp_path / "part.txt"
    drawing.write_text("no drawing")
    outcome = run(client, drawing, address(serving))
    assert outcome.returncode == 1 and not outcome.stdout
    (sentence,) = outcome.stderr.splitlines()
    assert sentence.endswith("export the part's outline as one of these.")


@pytest.mark.parametrize("client", PROGRAMS)
def test_a_server_that_is_not_there_is_a_sentence(client: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
    outcome = run(client, ROOT / "examples" / "bracket.dxf", f"http://127.0.0.1:{port}")
    assert outcome.returncode == 1
    (sentence,) = outcome.stderr.splitlines()
    assert sentence.startswith("The server does not answer")


@pytest.mark.parametrize("client", PROGRAMS)
def test_a_server_that_asks_for_a_token_is_given_it(client: str, tmp_path: Path) -> None:
    drawing = Path(shutil.copy(ROOT / "examples" / "bracket.dxf", tmp_path))
    with running_server(token=TOKEN) as asking:
        refused = run(client, drawing, address(asking))
        assert refused.returncode == 1 and "asks for a token" in refused.stderr
        assert run(client, drawing, address(asking), TOKEN).returncode == 0


@pytest.mark.parametrize("client", PROGRAMS)
def test_a_stream_that_breaks_is_taken_up_again(serving: RunningServer, client: str, tmp_path: Path) -> None:
    """Through a middleman that cuts the first stream of events off after its first event."""
    drawing = Path(shutil.copy(ROOT / "examples" / "bracket.dxf", tmp_path))
    seen: list[bytes] = []
    with socket.create_server(("127.0.0.1", 0)) as entrance:
        threading.Thread(target=pass_on, args=(entrance, serving.address, seen), daemon=True).start()
        outcome = run(client, drawing, f"http://localhost:{entrance.getsockname()[1]}")
    assert outcome.returncode == 0, outcome.stderr
    streams = [head for head in seen if b"/events" in head.split(b"\r\n")[0]]
    resumed = [re.search(rb"(?im)^last-event-id: *(\d*)\r?$", head) for head in streams]
    assert len(streams) >= 2
    # The first has seen nothing, and the next one names what it has seen.
    assert resumed[0] is None or not resumed[0][1]
    assert resumed[1] is not None and resumed[1][1]


def pass_on(entrance: socket.socket, target: tuple[str, int], seen: list[bytes]) -> None:
    """Passes connections on, one request each, until the entrance is closed."""
    while True:
        try:
            inner, _ = entrance.accept()
        except OSError:
            return
        threading.Thread(target=pass_one, args=(inner, target, seen), daemon=True).start()


def pass_one(inner: socket.socket, target: tuple[str, int], seen: list[bytes]) -> None:
    """Passes one request on, and its answer back; of the first stream only the beginning."""
    with inner, socket.create_connection(target) as outer:
        head = b""
        while b"\r\n\r\n" not in head:
            head += inner.recv(65536)
        lines, _, body = head.partition(b"\r\n\r\n")
        length = re.search(rb"(?i)content-length: *(\d+)", lines)
        while length and len(body) < int(length[1]):
            body += inner.recv(65536)
        is_cut = b"/events" in lines.split(b"\r\n")[0] and not any(b"/events" in one for one in seen)
        seen.append(lines)
        kept = [line for line in lines.split(b"\r\n") if not line.lower().startswith(b"connection:")]
        outer.sendall(b"\r\n".join([*kept, b"Connection: close"]) + b"\r\n\r\n" + body)
        sent = b""
        while piece := outer.recv(65536):
            inner.sendall(piece)
            sent += piece
            if is_cut and sent.count(b"\n\n") >= 1:
                return


def test_the_same_code_works_in_a_page_of_another_site(
    serving: RunningServer, elsewhere: str, browser: Any
) -> None:
    page = browser.new_page()
    page.goto(f"{elsewhere}/design.html")
    page.fill("#server", address(serving))
    page.set_input_files("#drawing", str(ROOT / "examples" / "bracket.dxf"))
    page.wait_for_selector("#sheet:not([hidden])", timeout=120_000)
    rows = page.locator("#rows li").all_inner_texts()
    size = page.evaluate(
        "async () => (await (await fetch(document.getElementById('sheet').href)).blob()).size"
    )
    # A page that is not named is told nothing.
    page.goto(elsewhere.replace("localhost", "127.0.0.1") + "/design.html")
    page.fill("#server", address(serving))
    page.set_input_files("#drawing", str(ROOT / "examples" / "bracket.dxf"))
    page.wait_for_function("document.getElementById('state').textContent")
    said = page.inner_text("#state")
    page.close()
    assert rows == first_choices(serving)
    assert size > 10_000
    assert said == "The server does not answer, or lets no page of this site in."


@pytest.mark.parametrize("path", sorted(CLIENTS.iterdir()), ids=lambda path: path.name)
def test_the_manual_shows_the_files_as_they_are(path: Path) -> None:
    """A block with the path of a file has what the file has."""
    blocks = re.findall(r"^```\w+ title=\"([\w./]+)\"\n(.*?)^```$", PAGE, flags=re.S | re.M)
    assert dict(blocks)[f"examples/clients/{path.name}"] == path.read_text(encoding="utf-8")
