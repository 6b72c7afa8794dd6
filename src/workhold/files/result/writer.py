"""Writing of the result file: its head, and one line of JSON for every fixture
(``files.result.fixture_text``).

Glossary
--------
head : everything but the fixtures; a few lines in front of them.

The bytes depend on nothing but the result. Lengths are rounded to 1e-9 mm and angles to 1e-10 degree; forces
and quality have twelve significant digits. :mod:`workhold.files.result.reader` reads the file back.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from attrs import asdict

from workhold.asking.declaring import list_declarations
from workhold.asking.search import SearchQuestion
from workhold.files.atomic import write_text_file
from workhold.files.result.fixture_text import round_degrees, round_table_for_file, write_fixture_lines
from workhold.files.result.hold_text import write_hold_lines
from workhold.fixels.carrier import HoleSelection
from workhold.fixels.kinds import USUAL
from workhold.fixels.pegs import PegFlat
from workhold.fixels.support_hardware import HARDWARE, PinLimits, SupportPads, TopClamp
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture_table import FixtureTable
from workhold.model.notes import Note
from workhold.model.program import Program
from workhold.model.quality import PROGRAM_CLEARANCE
from workhold.model.query import Query
from workhold.model.requirements import Load
from workhold.model.result import Result
from workhold.model.search_report import ProofReport
from workhold.model.solid import BESIDE_TOP, STANDING, SolidOutline
from workhold.model.workpiece import Workpiece

__all__ = [
    "FORMAT",
    "make_query_entry",
    "make_head",
    "write_head_json",
    "make_load_entry",
    "write_program_json",
    "make_proof_entry",
    "write_result_text",
    "make_solid_entry",
    "make_toolkit_fields",
    "make_workpiece_entry",
    "write_result",
    "convert_to_json_value",
]

FORMAT = "workhold-result/1"
# The key of kinds that have one of their own; others stand under "toolkit", with their kind.
OWN_KEYS = {USUAL: "vise"}
# Pieces of a program of which the text is made at a time.
AT_ONCE = 2000


def write_result(result: Result, path: str | Path) -> None:
    """Write a result file (MODEL, "Result file"); an earlier file is replaced only after success."""
    with write_text_file(path) as stream:
        stream.writelines(write_result_text(result))


def write_result_text(result: Result) -> Iterator[str]:
    """Yield the text of a result file, piece by piece; in ASCII, so that no name in it steers a terminal."""
    yield from write_head_json(make_head(result, with_pieces=False), result.query.program, ",\n")
    yield ',\n"fixtures": ['
    separator, count = "\n", 0
    if result.toolkit.holds_by_friction:
        lines = list(write_hold_lines(result))
        add_bending_entries(lines, result, 0)
        yield "".join(f"{',' * (number > 0)}\n{line}" for number, line in enumerate(lines))
        yield "\n]}\n"
        return
    for lines in write_fixture_lines(result.table, result.toolkit, result.workpiece):
        seatings = result.seating[count : count + len(lines)]
        lines[: len(seatings)] = [
            add_entry_to_line(line, "seating", one.to_fields())
            for line, one in zip(lines, seatings, strict=False)
        ]
        if result.query.program_to_clear is not None:
            lines = add_clearances(lines, result, slice(count, count + len(lines)))
        add_bending_entries(lines, result, count)
        yield separator + ",\n".join(lines)
        separator, count = ",\n", count + len(lines)
    yield "\n]}\n"


def add_entry_to_line(line: str, key: str, value: dict[str, Any]) -> str:
    """Return the JSON line of a fixture with a further key and value."""
    return f'{line[:-1]}, "{key}": {json.dumps(value)}}}'


def add_bending_entries(lines: list[str], result: Result, first: int) -> None:
    """Add to the JSON lines of fixtures how far they bend their part, where the result says so.

    ``first`` is the index of the first line's fixture in the result.
    """
    if not result.bending:
        return
    for place, line in enumerate(lines):
        if (bent := result.bending.get(first + place)) is not None:
            lines[place] = add_entry_to_line(line, "bending", bent.to_data())


def add_clearances(lines: list[str], result: Result, rows: slice) -> list[str]:
    """Return the JSON lines of the fixtures at ``rows``, with the program's
    nearest move and the forces that it needs added.

    A fixture gets no clearance if the tools stay above the pegs. Forces are added only if the program has
    forces.
    """
    # Other files are written without what measures.
    from workhold.statics.program_clearance import find_nearest_moves, name_element

    assert result.query.program_to_clear is not None
    program = result.query.program_to_clear[0]
    toolkit, (_, table) = result.toolkit, round_table_for_file(result.table.take(rows))
    near = find_nearest_moves(table, result.workpiece, toolkit, *result.query.program_to_clear)
    out = []
    for number, line in enumerate(lines):
        if near.line[number] >= 0:
            said = {
                "distance": float(f"{table.quality[number, PROGRAM_CLEARANCE]:.12g}"),
                "line": int(near.line[number]),
                "tool": int(near.tool[number]),
                "element": name_element(table, toolkit, number, int(near.contact[number])),
            }
            line = add_entry_to_line(line, "program_clearance", said)
        out.append(line)
    return out if program.forces is None else add_program_forces(out, table, result, program)


def add_program_forces(lines: list[str], table: FixtureTable, result: Result, program: Program) -> list[str]:
    """Return the JSON lines of the fixtures of a table, each with its entry of the forces that the program
    needs, if it has one.
    """
    from workhold.statics.program_forces import find_cutting_needs

    jaw_force = result.query.jaw_force
    needs = find_cutting_needs(table, result.workpiece, result.toolkit, program, jaw_force)
    return [
        line if need is None else add_entry_to_line(line, "program_forces", need.to_dict())
        for line, need in zip(lines, needs, strict=True)
    ]


def make_head(result: Result, with_pieces: bool = True) -> dict[str, Any]:
    """Return everything in the file but the fixtures, as a JSON object at full precision.

    Parameters
    ----------
    with_pieces : whether the tool cylinders on all moves of a program are included; False includes the
        program's other data only.
    """
    return {
        "format": FORMAT,
        **make_solid_entry(result.workpiece.solid),
        "workpiece": make_workpiece_entry(result.workpiece),
        **make_own_outlines_entry(result.workpiece),
        **make_query_entry(result.query, with_pieces),
        "counts": result.counts,
        "found": {kind: int(count) for kind, count in result.found.items()},
        "distinct": {kind: int(count) for kind, count in result.distinct.items()},
        "complete": bool(result.complete),
        **make_notes_entry(result.notes),
        **({} if result.pairs is None else {"pairs": result.pairs, "seats": result.seats}),
        **make_least_error_entry(result),
        **({} if result.bent_by is None else {"bent_by": result.bent_by}),
        "statistics": {name: int(count) for name, count in result.statistics.items()},
    } | ({} if result.proof is None else {"proof": make_proof_entry(result.proof)})


def make_notes_entry(notes: Sequence[Note]) -> dict[str, Any]:
    """Return the entries of notes: their sentences, and their data in the same order."""
    return {"notes": [note.words for note in notes], "note_data": [note.data for note in notes]}


def make_least_error_entry(result: Result) -> dict[str, float]:
    """Return the entry of the least effective location error in mm; {} if the result is not ranked in steps
    of that error.
    """
    least = result.least_effective_error
    return {} if least is None else {"least_effective_error": least}


def write_program_json(program: Program) -> Iterator[str]:
    """Yield the JSON of a program in pieces of text; its content is that of ``Program.to_dict``."""
    start = json.dumps(program.make_head())
    yield f'{start[:-1]}, "pieces": ['
    separator, pieces = "", program.iterate_entries()
    while some := [json.dumps(piece) for piece in islice(pieces, AT_ONCE)]:
        yield separator + ", ".join(some)
        separator = ", "
    yield "]}"


def write_head_json(
    entries: Mapping[str, Any], program: Program | None, separator: str, is_ascii: bool = True
) -> Iterator[str]:
    """Yield the JSON of a head in parts, without its closing bracket.

    Parameters
    ----------
    entries : entries of the head.
    program : written with all that it sweeps under the key ``program``; None if there is none.
    separator : text between two entries.
    is_ascii : whether characters outside ASCII are escaped.
    """
    before = "{"
    for key, value in entries.items():
        yield f"{before}{json.dumps(key)}: "
        if key == "program" and program is not None:
            yield from write_program_json(program)
        else:
            yield json.dumps(value, ensure_ascii=is_ascii)
        before = separator


def make_workpiece_entry(workpiece: Workpiece) -> dict[str, Any]:
    """Return a workpiece as a JSON object; a workpiece file has the same form."""
    return {
        "name": workpiece.name,
        "units": "mm",
        "loops": [(loop + 0.0).tolist() for loop in workpiece.loops],
        "departure": workpiece.departure,
        **make_bands_entry(workpiece.solid),
        **({} if workpiece.finished is None else {"finished": make_workpiece_entry(workpiece.finished)}),
    }


def make_bands_entry(solid: SolidOutline | None) -> dict[str, Any]:
    """Return the entries of a solid: the heights that may be touched on each
    segment, and its upright and level faces; {} for None.
    """
    if solid is None:
        return {}
    faces = {"solid_faces": [list(faces) for faces in solid.faces]} if solid.faces else {}
    faces_known = {"bottom": solid.bottom, "top": solid.top}
    level: dict[str, Any] = {name: loops for name, loops in faces_known.items() if loops is not None}
    beside = ("top_heights", *BESIDE_TOP, "unclear_heights")
    level |= {key: list(value) for key in beside if (value := getattr(solid, key))}
    runs = {"runs": [list(map(list, rows)) for rows in solid.runs]} if any(solid.runs) else {}
    return {"bands": [None if band is None else list(band) for band in solid.bands], **runs, **faces, **level}


def make_solid_entry(solid: SolidOutline | None) -> dict[str, Any]:
    """Return the entry ``solid``: axis and height of the solid, and the
    heights and limits of the pegs; {} for None.
    """
    if solid is None:
        return {}
    return {"solid": {key: getattr(solid, key) for key in STANDING}}


def make_own_outlines_entry(workpiece: Workpiece) -> dict[str, Any]:
    """Return the entry of the outlines that jaws or clamps
    with heights of their own meet, by role; {} without any.

    The numbers of their segments continue after those of the workpiece, outline by outline in this order. An
    outline that equals an earlier one has the same numbers as that.
    """
    own = {
        role: {"loops": [(loop + 0.0).tolist() for loop in one.loops], **make_bands_entry(one.solid)}
        for role, one in workpiece.outlines
    }
    return {"outlines": own} if own else {}


def make_query_entry(query: Query, with_pieces: bool = True) -> dict[str, Any]:
    """Return the entries of a query without its workpiece; for ``with_pieces`` see :func:`make_head`."""
    asked = {
        **make_toolkit_entry(query.toolkit),
        "types": list(query.types),
        "contact_margin": float(query.contact_margin),
        "restrictions": {
            "avoid": [int(face) for face in query.restrictions.avoid],
            "zones": [(zone.loop + 0.0).tolist() for zone in query.restrictions.zones],
            "angles": [[float(low), float(high)] for low, high in query.restrictions.angles],
            **({"touch": list(query.restrictions.touch)} if query.restrictions.touch else {}),
        },
        "ranking": list(query.rank_by),
        "tolerance": asdict(query.tolerance),
        "loads": [make_load_entry(load) for load in query.loads],
    }
    always = {"best", "jaw_force"} | ({"opening", "foolproof"} if query.seating is not None else set())
    asked |= {
        row.name: value
        for row in list_declarations(SearchQuestion)
        if row.name not in asked
        and ((value := getattr(query, row.name)) != row.default or row.name in always)
    }
    if query.friction is not None:
        asked["friction"] = dict(query.friction)
    if query.raw is not None:
        asked["raw"] = query.raw.to_dict()
    if query.program is not None:
        program = query.program.to_dict() if with_pieces else query.program.make_head()
        asked["program"] = program
    return asked


def make_toolkit_entry(toolkit: Toolkit) -> dict[str, Any]:
    """Return the entry of a toolkit: its fields under a
    key of its own, or under ``toolkit`` with its kind.
    """
    fields = make_toolkit_fields(toolkit)
    key = OWN_KEYS.get(toolkit.kind)
    return {"toolkit": {"kind": toolkit.kind, **fields}} if key is None else {key: fields}


def make_toolkit_fields(toolkit: Toolkit) -> dict[str, Any]:
    """Return the fields of a toolkit as JSON values: lengths
    in mm, holes by name; pitch, columns and rows come first.
    """
    # The tolerance stands among what was asked.
    values = asdict(toolkit, recurse=False, filter=lambda one, _: one.name != "tolerance")  # type: ignore[arg-type]
    fields = {name: convert_to_json_value(value) for name, value in values.items()}
    silent = {row.name for row in toolkit.table.fields if row.is_silent} | set(HARDWARE)
    fields = {name: value for name, value in fields.items() if name not in silent or value is not None}
    return {name: fields.pop(name) for name in ("pitch", "columns", "rows") if name in fields} | fields


def convert_to_json_value(value: Any) -> Any:
    """Return a field's value as a JSON value; other values
    than tuples, holes and hardware are returned unchanged.
    """
    if isinstance(value, tuple):
        return [convert_to_json_value(one) for one in value]
    if isinstance(value, PegFlat):
        return asdict(value)
    if isinstance(value, (SupportPads, TopClamp, PinLimits)):
        return {name: convert_to_json_value(one) for name, one in asdict(value).items() if one is not None}
    return value.name if isinstance(value, HoleSelection) else value


def make_load_entry(load: Load) -> dict[str, Any]:
    """Return a load as a JSON object; forces in N, moments in N·mm, lengths in mm, directions in degrees.

    Heights that are zero or unknown, and upward forces of zero, are left out.
    """
    entry = {"name": load.name} | asdict(load)
    # What stands in no plane is written where it is said.
    return {key: value for key, value in entry.items() if key not in ("upward", "height") or value}


def make_proof_entry(proof: ProofReport) -> dict[str, Any]:
    """Return the account of the search as a JSON object."""
    return {
        "cells": int(proof.cells),
        "candidates": int(proof.candidates),
        "discarded_by_bound": int(proof.discarded_by_bound),
        "verified": int(proof.verified),
        "escalated": int(proof.escalated),
        "undecided": [
            {
                "type": item.type,
                "segments": [int(face) for face in item.faces],
                "columns": [int(column) for column in item.columns],
                "rows": [int(row) for row in item.rows],
                "theta_deg": float(round_degrees(item.theta_deg)),
                "reach_deg": item.reach_deg,
                "reason": item.reason,
            }
            for item in proof.undecided
        ],
    }
