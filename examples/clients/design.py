"""A client of workhold serve that needs nothing but Python: from a drawing to the sheet of the first choice.

python design.py bracket.dxf [http://127.0.0.1:8000]
"""

import json
import os
import sys
import time
from pathlib import Path
from urllib.error import HTTPError
from urllib.parse import quote, urlencode
from urllib.request import Request, urlopen

TOOLKIT = {"kind": "vise", "pitch": [10, 10], "columns": 2, "peg_radius": 3}  # mm
TOKEN = os.environ.get("WORKHOLD_TOKEN")  # of a server that asks for one
OVER = ("done", "failed", "cancelled")
TRIES = 5  # connections in a row that bring nothing, until the server is given up


def ask(server, path, content=None, method=None, **headers):
    """Opens an address; what the server refuses ends the program with the server's sentence."""
    if isinstance(content, dict):
        content = json.dumps(content).encode()
        headers["Content-Type"] = "application/json"
    if TOKEN:
        headers["Authorization"] = f"Bearer {TOKEN}"
    try:
        return urlopen(Request(server + path, content, headers, method=method), timeout=60)
    except HTTPError as refusal:
        sys.exit(json.load(refusal)["error"])


def states(server, job):
    """The states of a job until it is over; a stream that breaks goes on after the last event that came."""
    seen, state, failed = "", {}, 0
    while state.get("state") not in OVER:
        try:
            for line in ask(server, f"{job}/events", **{"Last-Event-ID": seen}):
                name, _, value = line.decode().rstrip("\n").partition(": ")
                if name == "id":
                    seen = value
                elif name == "data":
                    state, failed = json.loads(value), 0
                    yield state
        except OSError:
            failed += 1
            if failed == TRIES:
                raise
            time.sleep(1)


def main(drawing, server="http://127.0.0.1:8000"):
    """Reads the part, searches, prints the three first choices, and saves the sheet of the first."""
    path = Path(drawing)
    sent = {"X-Filename": quote(path.name)}
    survey = json.load(ask(server, "/api/v1/parts/survey", path.read_bytes(), **sent))
    if survey["error"]:
        sys.exit(survey["error"])
    part = {key: survey["part"][key] for key in ("name", "loops", "departure")}
    begun = json.load(ask(server, "/api/v1/jobs?when_left=cancel", {"workpiece": part, "toolkit": TOOLKIT}))
    told = ""
    for state in states(server, begun["url"]):
        words = f"{state['state']}: {state['found']} fixtures"
        if words != told:
            print(words, file=sys.stderr)
        told = words
    if state["state"] != "done":
        sys.exit(state["error"] or "The search was cancelled.")
    choices = json.load(ask(server, begun["url"] + "/fixtures?" + urlencode({"limit": 3})))
    for row in choices["rows"]:
        print(row["rank"], *row["holes"], f"{row['quality']['location_error']:.3f} mm")
    if choices["rows"]:
        sheet = ask(server, begun["url"] + "/fixtures/1/sheet.pdf?jaw_force=3000").read()
        path.with_suffix(".pdf").write_bytes(sheet)
    ask(server, begun["url"], method="DELETE")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except OSError as error:
        sys.exit(f"The server does not answer, or a file cannot be used: {error}")
