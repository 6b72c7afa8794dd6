"""The sets of the benchmark, read from the manifest that comes with the program, and their files' form.

The manifest names every workpiece with family, reason, source, licence and checksum, and every set with its
toolkit, the counts of its complete list and the list's checksums. Lists themselves are not shipped: a search
makes them, and the checksums say whether they are the ones meant.

A set's file, ``workhold-benchmark/1``, has the query, then one fixture in each line. A fixture has the keys
that it has in a result file, except those that are a matter of opinion. Figures are those of the model; the
order is by type, direction, holes and pose, not by preference. The manual describes the form for other
programs (docs/benchmark.md).

Glossary
--------
set : a workpiece and a toolkit, with the complete list of the fixtures that hold the one in the other.
head : everything in a set's file except the fixtures.
line : one fixture as JSON text.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from functools import cache
from hashlib import sha256
from importlib.resources import files
from typing import Any

from attrs import frozen

from workhold.errors import InputError
from workhold.files.result.fixture_text import write_fixture_lines
from workhold.files.result.writer import make_head as result_head
from workhold.fixels.kinds import make_toolkit
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.workpiece import Workpiece

__all__ = [
    "COMMON",
    "FIGURE_KEYS",
    "FORMAT",
    "SetEntry",
    "SetText",
    "read_benchmark_file",
    "load_manifest",
    "make_set_query",
    "find_set",
    "make_set_text",
    "load_sets",
    "compute_checksums",
]

HOME = "benchmark"
MANIFEST = "manifest.json"
# Files that belong to every copy of the benchmark, beside the workpieces.
COMMON = (MANIFEST, "check.py", "set.schema.json", "entry.schema.json")
FORMAT = "workhold-benchmark/1"
# The figures that the model defines and that the points of contact alone decide.
FIGURE_KEYS = ("closure_margin", "clamp_amplification", "wrench_radius", "location_error", "clamp_freedom")
# Of a fixture, what is repeated as a result file has it.
TOOLKIT_KEYS = ("vise", "toolkit")
KEPT = ("type", "direction", "directions", "wall", "ratio", "pegs", "pose", "jaw_separation")

SetText = tuple[dict[str, Any], list[str]]


@frozen
class SetEntry:
    """The manifest's entry of a set.

    Parameters
    ----------
    name : of the set, in files and commands.
    part : name of the workpiece.
    toolkit : its kind, and the fields that differ from the defaults, as ``make_toolkit`` takes them.
    listing : "all" for two clamps (every pair is listed); None for other toolkits.
    reason : why it is in the benchmark.
    counts : number of fixtures in the complete list by type.
    sums : checksums, see :func:`compute_checksums`.
    """

    name: str
    part: str
    toolkit: Mapping[str, Any]
    listing: str | None
    reason: str
    counts: Mapping[str, int]
    sums: Mapping[str, str]

    @property
    def size(self) -> int:
        """The number of fixtures in the complete list."""
        return sum(self.counts.values())


def read_benchmark_file(name: str) -> bytes:
    """Return the bytes of a file of the benchmark, such as ``check.py`` or ``parts/kite.json``."""
    return (files("workhold") / "data" / HOME).joinpath(*name.split("/")).read_bytes()


@cache
def load_manifest() -> Mapping[str, Any]:
    """Return the manifest of the benchmark as parsed JSON; cached."""
    content: dict[str, Any] = json.loads(read_benchmark_file(MANIFEST))
    return content


@cache
def load_sets() -> tuple[SetEntry, ...]:
    """Return all sets, in the order of the manifest."""
    return tuple(
        SetEntry(
            name=one["name"],
            part=one["workpiece"],
            toolkit=one["toolkit"],
            listing=one["listing"],
            reason=one["reason"],
            counts=one["counts"],
            sums=one["sums"],
        )
        for one in load_manifest()["sets"]
    )


def find_set(name: str) -> SetEntry:
    """Return the set with this name.

    Raises
    ------
    InputError
        For an unknown name; the message gives similar ones.
    """
    by_name = {one.name: one for one in load_sets()}
    if name in by_name:
        return by_name[name]
    close = get_close_matches(name, by_name, n=3, cutoff=0.4)
    remedy = f"did you mean {' or '.join(close)}?" if close else "workhold benchmark list names them all."
    raise InputError(f"no set of the benchmark has the name {name[:80]!r}: {remedy}")


def make_set_query(entry: SetEntry) -> Query:
    """Return the query whose complete result is the list of a set.

    Raises
    ------
    InputError
        When the checksum of the workpiece's file is not the one in the manifest.
    """
    content = read_benchmark_file(f"parts/{entry.part}.json")
    if sha256(content).hexdigest() != load_manifest()["workpieces"][entry.part]["sha256"]:
        raise InputError(f"the benchmark's workpiece {entry.part} has been changed: install workhold again.")
    part, given = json.loads(content), dict(entry.toolkit)
    toolkit = make_toolkit(given.pop("kind"), given)
    return Query(Workpiece.from_loops(part["name"], part["loops"]), toolkit, listing=entry.listing)


def make_set_text(name: str, result: Result) -> SetText:
    """Return (head, lines) of a set's file, from the complete result of the set's query."""
    fixtures = [
        reduce_fixture(json.loads(line))
        for lines in write_fixture_lines(result.table, result.toolkit, result.workpiece)
        for line in lines
    ]
    fixtures.sort(key=make_order_key)
    return make_set_head(name, result), [json.dumps(one) for one in fixtures]


def reduce_fixture(fixture: Mapping[str, Any]) -> dict[str, Any]:
    """Return a fixture object of a result file, reduced to the keys that a set's file has."""
    quality = {key: fixture["quality"][key] for key in FIGURE_KEYS if key in fixture["quality"]}
    return {key: fixture[key] for key in KEPT if key in fixture} | {"quality": quality}


def make_order_key(fixture: Mapping[str, Any]) -> tuple[Any, ...]:
    """Return the sort key of a fixture object: type, directions, holes, pose, faces."""
    pegs = fixture["pegs"]
    pose = fixture["pose"]
    return (
        fixture["type"],
        list(fixture.get("directions", [fixture.get("direction", "")])),
        [(peg.get("column", -1), peg.get("row", -1)) for peg in pegs],
        (pose["theta_deg"], pose["x"], pose["y"]),
        [peg["segment"] for peg in pegs],
    )


def make_set_head(name: str, result: Result) -> dict[str, Any]:
    """Return the head of a set's file (everything except the fixtures), from a result."""
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


def format_set_text(head: Mapping[str, Any], lines: Iterable[str]) -> str:
    """Return the text of a set's file from its head and lines."""
    entries = "".join(f"{json.dumps(key)}: {json.dumps(value)},\n" for key, value in head.items())
    return "{" + entries + '"fixtures": [\n' + ",\n".join(lines) + "\n]}\n"


def compute_checksums(head: Mapping[str, Any], lines: Sequence[str]) -> dict[str, str]:
    """Return the checksums of a set, SHA-256 in hexadecimal, under the keys "file", "fixtures" and "holes".

    "file" is of the whole text and "fixtures" of the lines joined by line ends. "holes" is of the whole
    numbers in the lines only (:func:`format_holes_line`); it is the same on machines whose arithmetic rounds
    otherwise.
    """
    return {
        "file": compute_sha256(format_set_text(head, lines)),
        "fixtures": compute_sha256("\n".join(lines)),
        "holes": compute_sha256("\n".join(map(format_holes_line, lines))),
    }


def format_holes_line(line: str) -> str:
    """Return a fixture's line reduced to type, directions, and column, row and face of each peg, as JSON
    text.
    """
    fixture = json.loads(line)
    pegs = [[peg.get("column"), peg.get("row"), peg["segment"]] for peg in fixture["pegs"]]
    return json.dumps([fixture["type"], fixture.get("directions", fixture.get("direction")), pegs])


def compute_sha256(text: str) -> str:
    """Return the SHA-256 of a text in UTF-8, in hexadecimal."""
    return sha256(text.encode("utf-8")).hexdigest()
