"""Many clients at once: is anything lost, does memory stay flat, are others answered while some do their worst?

Starts ``workhold serve`` and lets clients search, follow, page, draw, cancel and delete for a minute; some send nonsense,
files that are too large, and requests that never end. Prints figures; exit code 1 when something was lost.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import random
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import httpx
from attrs import define, field

from workhold.files.part.load import load

WIDGET = {"name": "widget", "loops": [loop.tolist() for loop in load("widget").loops]}
KNOB = {"name": "8Handle", "loops": [loop.tolist() for loop in load("8Handle").loops]}
LOAD = {"points": [[10, 5]], "force": 200, "directions": [-30, 30]}
# Memory is compared after so many seconds and at the end.
SETTLED = 15.0


@define
class Tally:
    """What happened."""

    counts: Counter[str] = field(factory=Counter)
    statuses: Counter[int] = field(factory=Counter)
    waits: dict[str, list[float]] = field(factory=dict)
    wrong: list[str] = field(factory=list)
    jobs: set[str] = field(factory=set)
    found: dict[str, int] = field(factory=dict)


async def ask(
    client: httpx.AsyncClient, tally: Tally, kind: str, method: str, url: str, **more: Any
) -> httpx.Response:
    """Send a request; one that is told to come back later does."""
    while True:
        start = time.perf_counter()
        answer = await client.request(method, url, **more)
        tally.waits.setdefault(kind, []).append(time.perf_counter() - start)
        tally.statuses[answer.status_code] += 1
        if answer.status_code not in (429, 503):
            return answer
        await asyncio.sleep(float(answer.headers["retry-after"]) * random.random())


async def search(client: httpx.AsyncClient, tally: Tally, chance: random.Random) -> None:
    """Search, follow the search to its end, look at the fixtures, forget it."""
    pitch = chance.choice([7, 8, 9, 10])
    asked = {"workpiece": WIDGET, "vise": {"pitch": [pitch, pitch], "columns": 1, "peg_radius": 3}}
    url = (await ask(client, tally, "submit", "POST", "/api/jobs", json=asked)).json()["url"]
    tally.jobs.add(url)
    last: dict[str, Any] = {}
    if chance.random() < 0.5:
        async with client.stream("GET", f"{url}/events") as stream:
            async for line in stream.aiter_lines():
                if line.startswith("data: "):
                    last = json.loads(line.removeprefix("data: "))
    while last.get("state") not in ("done", "failed"):
        last = (await ask(client, tally, "poll", "GET", url)).json()
        await asyncio.sleep(0.1)
    expected = tally.found.setdefault(str(pitch), last["found"])
    if last["state"] != "done" or last["found"] != expected or not last["complete"]:
        tally.wrong.append(f"pitch {pitch}: {last['state']} {last['found']} of {expected} {last['error']}")
    page = (await ask(client, tally, "page", "GET", f"{url}/fixtures?limit=200&sort=wrench_radius")).json()
    if page["total"] != expected:
        tally.wrong.append(f"a page of {page['total']} fixtures, not {expected}")
    await ask(client, tally, "loads", "POST", f"{url}/fixtures/1/loads", json={"loads": [LOAD]})
    if chance.random() < 0.2:
        sheet = await ask(client, tally, "sheet", "GET", f"{url}/fixtures/1/sheet.pdf")
        if not sheet.content.startswith(b"%PDF"):
            tally.wrong.append("a sheet that is none")
    await ask(client, tally, "delete", "DELETE", url)
    tally.counts["searches"] += 1


async def cancelled(client: httpx.AsyncClient, tally: Tally, chance: random.Random) -> None:
    """Begin a long search and forget it soon."""
    asked = {"workpiece": KNOB, "vise": {"pitch": [3, 3], "columns": 6, "peg_radius": 1.4}}
    url = (await ask(client, tally, "submit", "POST", "/api/jobs", json=asked)).json()["url"]
    tally.jobs.add(url)
    await asyncio.sleep(chance.random())
    await ask(client, tally, "delete", "DELETE", url)
    tally.counts["cancelled"] += 1


async def mischief(client: httpx.AsyncClient, tally: Tally, chance: random.Random) -> None:
    """Send what should not be sent."""
    kind = chance.randrange(4)
    if kind == 0:
        answer = await ask(client, tally, "refused", "POST", "/api/parts", content=b"PK\x03\x04" * 1000)
    elif kind == 1:
        answer = await ask(client, tally, "refused", "POST", "/api/jobs", json={"workpiece": [[[]]]})
    elif kind == 2:
        answer = await ask(client, tally, "refused", "POST", "/api/jobs", content=bytes(4_000_001))
    else:
        address = client.base_url
        _, writer = await asyncio.open_connection(address.host, address.port)
        writer.write(b"POST /api/parts HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000\r\n\r\n<svg")
        await asyncio.sleep(1.0)
        writer.close()
        return
    if answer.status_code not in (400, 413):
        tally.wrong.append(f"nonsense was answered with {answer.status_code}")
    tally.counts["refused"] += 1


async def client_loop(base: str, tally: Tally, seed: int, end: float) -> None:
    """One client until the time is up."""
    chance = random.Random(seed)
    async with httpx.AsyncClient(base_url=base, timeout=120.0) as client:
        while time.monotonic() < end:
            roll = chance.random()
            action = search if roll < 0.7 else cancelled if roll < 0.85 else mischief
            try:
                await action(client, tally, chance)
            except (httpx.WriteError, httpx.ReadError, httpx.RemoteProtocolError) as error:
                if action is not mischief:
                    tally.wrong.append(f"{action.__name__}: {error!r}")
            await asyncio.sleep(chance.random() * 0.2)


def memory(pid: int) -> dict[int, float]:
    """Resident memory in MiB of a process and its children."""
    out = {}
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    for each in [pid, *map(int, children)]:
        found = re.search(r"VmRSS:\s+(\d+)", Path(f"/proc/{each}/status").read_text())
        if found:
            out[each] = int(found[1]) / 1024
    return out


async def run(base: str, pid: int, clients: int, seconds: float) -> Tally:
    """All clients for some time, with memory written down meanwhile."""
    tally, start = Tally(), time.monotonic()
    loops = [asyncio.create_task(client_loop(base, tally, seed, start + seconds)) for seed in range(clients)]
    while not all(loop.done() for loop in loops):
        await asyncio.sleep(5.0)
        sizes = memory(pid)
        line = f"{time.monotonic() - start:5.0f} s  server {sizes[pid]:.0f} MiB, all {sum(sizes.values()):.0f} MiB"
        sys.stdout.write(f"{line}, {tally.counts['searches']} searches\n")
        tally.waits.setdefault("memory", []).append(sizes[pid])
    for loop in loops:
        loop.result()
    async with httpx.AsyncClient(base_url=base, timeout=60.0) as client:
        left = [url for url in tally.jobs if (await client.get(url)).status_code != 404]
        if left:
            tally.wrong.append(f"{len(left)} deleted searches are still there")
    return tally


def main() -> int:
    """Run as a script."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--clients", type=int, default=50)
    parser.add_argument("--seconds", type=float, default=60.0)
    options = parser.parse_args()
    command = [sys.executable, "-m", "workhold", "serve", "--port", "0"]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert server.stdout is not None
        address = re.search(r"http://\S+", server.stdout.readline())
        assert address is not None
        tally = asyncio.run(run(address[0].rstrip("/"), server.pid, options.clients, options.seconds))
    finally:
        server.send_signal(signal.SIGINT)
        code = server.wait(30)
    sizes = tally.waits.pop("memory")
    for kind, waits in sorted(tally.waits.items()):
        waits.sort()
        middle, high = waits[len(waits) // 2], waits[int(0.99 * (len(waits) - 1))]
        sys.stdout.write(
            f"{kind:8} {len(waits):6} requests, median {1e3 * middle:7.1f} ms, 99 % {1e3 * high:7.1f} ms\n"
        )
    sys.stdout.write(f"counts {dict(tally.counts)}, statuses {dict(sorted(tally.statuses.items()))}\n")
    early = sizes[min(int(SETTLED / 5), len(sizes) - 1)]
    sys.stdout.write(f"server's memory {early:.0f} MiB after {SETTLED:g} s, {sizes[-1]:.0f} MiB at the end\n")
    for sentence in tally.wrong[:20]:
        sys.stdout.write(f"WRONG: {sentence}\n")
    if any(status >= 500 and status != 503 for status in tally.statuses):
        tally.wrong.append("mistakes of the server")
    if code != 0:
        tally.wrong.append(f"the server ended with {code}")
    return 1 if tally.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
