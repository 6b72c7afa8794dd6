"""The form of one set in a file, ``workhold-benchmark/1``: the question, the complete list, and its sums.

A set's file has one fixture in a line. What a fixture says is that of a result file, less what is a matter
of opinion. Figures are those of the model; the order is by type, direction, holes and pose, not by
preference. The manual describes the form for other programs (docs/benchmark.md).

Glossary
--------
head : everything in the file but the fixtures.
line : one fixture as JSON.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from hashlib import sha256
from typing import Any

from workhold.files.result.fixture_text import fixture_lines
from workhold.files.result.writer import head as result_head
from workhold.model.result import Result

__all__ = ["FIGURE_KEYS", "FORMAT", "SetText", "set_text", "sums_of"]

FORMAT = "workhold-benchmark/1"
# The figures that the model defines and that the points of contact alone decide.
FIGURE_KEYS = ("closure_margin", "clamp_amplification", "wrench_radius", "location_error", "clamp_freedom")
# Of a fixture, what is repeated as a result file has it.
TOOLKIT_KEYS = ("vise", "toolkit")
KEPT = ("type", "direction", "directions", "wall", "ratio", "pegs", "pose", "jaw_separation")

SetText = tuple[dict[str, Any], list[str]]


def set_text(name: str, result: Result) -> SetText:
    """The head and the lines of a set's file.

    Parameters
    ----------
    name : of the set.
    result : complete, of the set's query.
    """
    fixtures = [
        reduced(json.loads(line))
        for lines in fixture_lines(result.table, result.toolkit, result.workpiece)
        for line in lines
    ]
    fixtures.sort(key=place_in_order)
    return head_of(name, result), [json.dumps(one) for one in fixtures]


def reduced(fixture: Mapping[str, Any]) -> dict[str, Any]:
    """A fixture of a result file with what a set says of it."""
    quality = {key: fixture["quality"][key] for key in FIGURE_KEYS if key in fixture["quality"]}
    return {key: fixture[key] for key in KEPT if key in fixture} | {"quality": quality}


def place_in_order(fixture: Mapping[str, Any]) -> tuple[Any, ...]:
    """What fixtures of a set are sorted by."""
    pegs = fixture["pegs"]
    pose = fixture["pose"]
    return (
        fixture["type"],
        list(fixture.get("directions", [fixture.get("direction", "")])),
        [(peg.get("column", -1), peg.get("row", -1)) for peg in pegs],
        (pose["theta_deg"], pose["x"], pose["y"]),
        [peg["segment"] for peg in pegs],
    )


def head_of(name: str, result: Result) -> dict[str, Any]:
    """The head of a set's file."""
    said = result_head(result)
    key = next(key for key in TOOLKIT_KEYS if key in said)
    workpiece = {key: said["workpiece"][key] for key in ("name", "units", "loops")}
    return {
        "format": FORMAT,
        "set": name,
        "workpiece": workpiece,
        "toolkit": {"kind": result.query.toolkit.kind} | said[key],
        "options": {
            "contact_margin": said["contact_margin"],
            "tolerance": {key: said["tolerance"][key] for key in ("peg", "face")},
        },
        "counts": said["counts"],
        "distinct": said["distinct"],
        "statistics": said["statistics"],
        "proof": said.get("proof"),
    }


def file_text(head: Mapping[str, Any], lines: Iterable[str]) -> str:
    """The text of a set's file."""
    entries = "".join(f"{json.dumps(key)}: {json.dumps(value)},\n" for key, value in head.items())
    return "{" + entries + '"fixtures": [\n' + ",\n".join(lines) + "\n]}\n"


def sums_of(head: Mapping[str, Any], lines: Sequence[str]) -> dict[str, str]:
    """The checksums (SHA-256) of a set, by what they are of.

    Returns
    -------
    ``file`` of the whole text, ``fixtures`` of the lines joined by line ends, and ``holes`` of what is whole
    numbers in them. The last is the same on machines whose arithmetic rounds otherwise.
    """
    return {
        "file": digest(file_text(head, lines)),
        "fixtures": digest("\n".join(lines)),
        "holes": digest("\n".join(map(holes_line, lines))),
    }


def holes_line(line: str) -> str:
    """The whole numbers of a fixture: of every peg column, row and face."""
    fixture = json.loads(line)
    pegs = [[peg.get("column"), peg.get("row"), peg["segment"]] for peg in fixture["pegs"]]
    return json.dumps([fixture["type"], fixture.get("directions", fixture.get("direction")), pegs])


def digest(text: str) -> str:
    """The SHA-256 of a text."""
    return sha256(text.encode("utf-8")).hexdigest()
