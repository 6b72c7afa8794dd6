"""Writing the result file: one line of JSON for every fixture, streamed from the arrays in blocks.

Glossary
--------
head : everything but the fixtures; a few lines in front of them.
block : the fixtures that are turned into Python objects at the same time.

The bytes depend on nothing but the result. Lengths are rounded to 1e-9 mm and angles to 1e-10 degree; forces and
quality have twelve significant digits. :mod:`workhold.files.result.reader` reads the file back.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np
from attrs import asdict

from workhold.files.atomic import text_file
from workhold.files.result.pairs import flats_told, pair_lines
from workhold.files.result.rounding import LENGTH_STEPS, as_told, known_figures, rounded, rounded_degrees
from workhold.fixels.fields import USUAL
from workhold.model.flat import Flat
from workhold.model.force_ratio import working_forces
from workhold.model.holes import Holes
from workhold.model.load import Load
from workhold.model.proof import Proof
from workhold.model.quality import FIGURES, Figure
from workhold.model.query import Query
from workhold.model.result import FixtureTable, Result, peg_places
from workhold.model.seating import Seating
from workhold.model.tolerance import Tolerance
from workhold.model.toolkit import Arrangement, Carrier, Toolkit
from workhold.model.workpiece import Workpiece

__all__ = [
    "FORMAT",
    "asked_entry",
    "fixture_rows",
    "head",
    "load_entry",
    "proof_entry",
    "result_text",
    "toolkit_fields",
    "workpiece_entry",
    "written",
    "write_result",
    "write_result_to",
]

FORMAT = "workhold-result/1"
BLOCK = 4096

CONTACT = '"x": %r, "y": %r, "segment": %d, "force": %.12g'
POSE = '"pose": {"theta_deg": %r, "x": %r, "y": %r}, '
WALL = '"wall": {"from": [%r, %r], "to": [%r, %r], "segments": [%d, %d], "forces": [%.12g, %.12g]}, '
# A number that is not written.
LEFT_OUT = "%.0s"


def fixture_template(arrangement: Arrangement, toolkit: Toolkit, figures: Sequence[Figure]) -> str:
    """The line of a fixture with its numbers left open, in the order of :func:`fixture_rows`."""
    carriers = [toolkit.carriers[number] for number in arrangement.carriers]
    pegs = ", ".join(f"{{{peg_template(one, toolkit)}}}" for one in carriers if not one.is_wall)
    quality = ", ".join(f'"{figure.key}": %.12g' for figure in figures)
    direction = "" if arrangement.direction is None else f'"direction": "{arrangement.direction}", '
    travel = f"{LEFT_OUT}" if toolkit.moving.on else '"jaw_separation": %r, '
    wall = "" if toolkit.wall is None else WALL
    flats = ', "flats": %s' if toolkit.has_flats else ""
    return (
        f'{{"type": "{arrangement.name}", {direction}{wall}"pegs": [{pegs}], {POSE}{travel}"quality": {{{quality}}}'
        f"{flats}}}"
    )


def peg_template(carrier: Carrier, toolkit: Toolkit) -> str:
    """What is written of a peg of a carrier, with its numbers left open; those of the place of a clamp come twice."""
    if toolkit.moving.on is None:
        return f'"jaw": "{carrier.name}", "column": %d, "row": %d, {CONTACT}'
    if carrier.on is None:
        return f'"role": "locator", "column": %d, "row": %d, {CONTACT}'
    hole = "[%d, %d]" if carrier.has_a_hole else f"null{LEFT_OUT}{LEFT_OUT}"
    line = f'{LEFT_OUT}"row": %d' if carrier.is_along_x else f'"column": %d{LEFT_OUT}'
    return f'"role": "clamp", "hole": {hole}, {line}, {CONTACT}'


def with_wall(numbers: tuple[Any, ...]) -> tuple[Any, ...]:
    """The numbers of a fixture with those of its second and third peg, the ends of a wall, first: places, faces, forces."""
    ends = numbers[6:12], numbers[12:18]
    places = (value for end in ends for value in end[2:4])
    faces, forces = (tuple(end[k] for end in ends) for k in (4, 5))
    return *places, *faces, *forces, *numbers[:6], *numbers[18:]


def write_result(result: Result, path: str | Path) -> None:
    """Write a result file (MODEL, "Result file"); an earlier file of that name is replaced only when all went well.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    with text_file(path) as stream:
        write_result_to(result, stream)


def write_result_to(result: Result, stream: IO[str]) -> None:
    """Write a result to an open text stream."""
    for text in result_text(result):
        stream.write(text)


def result_text(result: Result) -> Iterator[str]:
    """The text of a result file, piece by piece; in ASCII, so that no name in it steers a terminal."""
    lines = [f"{json.dumps(key)}: {json.dumps(value)},\n" for key, value in head(result).items()]
    yield "{" + "".join(lines) + '"fixtures": ['
    separator, count = "\n", 0
    for lines in fixture_lines(result.table, result.toolkit, result.workpiece):
        told = result.seating[count : count + len(lines)]
        lines[: len(told)] = map(with_seating, lines, told)
        yield separator + ",\n".join(lines)
        separator, count = ",\n", count + len(lines)
    yield "\n]}\n"


def with_seating(line: str, told: Seating) -> str:
    """The line of a fixture with its seating."""
    return f'{line[:-1]}, "seating": {json.dumps(told.as_fields())}}}'


def fixture_lines(table: FixtureTable, toolkit: Toolkit, workpiece: Workpiece) -> Iterator[list[str]]:
    """The lines of a list of fixtures, block by block."""
    if toolkit.needs_pairs:
        yield from pair_lines(table, toolkit, workpiece)
        return
    figures = known_figures(table)
    templates = [fixture_template(one, toolkit, figures) for one in toolkit.arrangements]
    for kind, numbers in fixture_rows(table, toolkit, workpiece):
        if toolkit.moving.on is not None:
            numbers = map(with_place_again, numbers)
        if toolkit.wall is not None:
            numbers = map(with_wall, numbers)
        if toolkit.has_flats:
            numbers = ((*row[:-1], json.dumps(row[-1])) for row in numbers)
        yield [templates[k] % row for k, row in zip(kind, numbers, strict=True)]


def with_place_again(numbers: tuple[Any, ...]) -> tuple[Any, ...]:
    """The numbers of a fixture with the column and row of the last peg, a clamp, given a second time."""
    return numbers[:20] + numbers[18:20] + numbers[20:]


def head(result: Result) -> dict[str, Any]:
    """Everything in the file but the fixtures, at full precision."""
    return {
        "format": FORMAT,
        "workpiece": workpiece_entry(result.workpiece),
        **asked_entry(result.query),
        "counts": result.counts,
        "found": {kind: int(count) for kind, count in result.found.items()},
        "distinct": {kind: int(count) for kind, count in result.distinct.items()},
        "complete": bool(result.complete),
        "notes": list(result.notes),
        **({} if result.pairs is None else {"pairs": result.pairs, "seats": result.seats}),
        "statistics": {name: int(count) for name, count in result.statistics.items()},
    } | ({} if result.proof is None else {"proof": proof_entry(result.proof)})


def workpiece_entry(workpiece: Workpiece) -> dict[str, Any]:
    """A workpiece as it is written; its file has the same form."""
    return {
        "name": workpiece.name,
        "units": "mm",
        "loops": [(loop + 0.0).tolist() for loop in workpiece.loops],
        "departure": workpiece.departure,
    }


def asked_entry(query: Query) -> dict[str, Any]:
    """What a query asks about a workpiece, as it is written."""
    return {
        **toolkit_entry(query.toolkit),
        "types": list(query.arrangements),
        "contact_margin": float(query.contact_margin),
        "restrictions": {
            "avoid": [int(face) for face in query.restrictions.avoid],
            "zones": [(zone.loop + 0.0).tolist() for zone in query.restrictions.zones],
            "angles": [[float(low), float(high)] for low, high in query.restrictions.angles],
        },
        "ranking": list(query.ranking),
        "tolerance": tolerance_entry(query.tolerance),
        "loads": [load_entry(load) for load in query.loads],
        "best": query.best,
        **({} if query.listing is None else {"listing": query.listing}),
        "jaw_force": query.jaw_force,
        **(
            {}
            if query.seating is None
            else {"seating": query.seating, "opening": query.opening, "foolproof": query.foolproof}
        ),
    }


def tolerance_entry(tolerance: Tolerance) -> dict[str, Any]:
    """How far pegs and faces may be off, the fit of the dowels where it is known, and what of the faces is departure."""
    fit = None if tolerance.fit is None else asdict(tolerance.fit)
    return {"peg": tolerance.peg, "face": tolerance.face, "fit": fit, "departure": tolerance.departure}


def toolkit_entry(toolkit: Toolkit) -> dict[str, Any]:
    """The key of a toolkit in a file, and what it holds: of the vise its fields, of others their kind and fields."""
    if toolkit.kind == USUAL:
        return {"vise": toolkit_fields(toolkit)}
    return {"toolkit": {"kind": toolkit.kind, **toolkit_fields(toolkit)}}


def toolkit_fields(toolkit: Toolkit) -> dict[str, Any]:
    """The fields of a toolkit as they are written: lengths in mm, holes by name; how many holes there are comes first."""
    fields = {name: written(value) for name, value in asdict(toolkit, recurse=False).items()}  # type: ignore[arg-type]
    if fields["flat"] is None:
        del fields["flat"]
    return {name: fields.pop(name) for name in ("pitch", "columns", "rows")} | fields


def written(value: Any) -> Any:
    """A value of a field as it is written."""
    if isinstance(value, tuple):
        return [written(one) for one in value]
    if isinstance(value, Flat):
        return asdict(value)
    return value.name if isinstance(value, Holes) else value


def load_entry(load: Load) -> dict[str, Any]:
    """A load as it is written: N, N mm, mm and degrees."""
    return {
        "name": load.name,
        "points": [[float(x), float(y)] for x, y in load.points],
        "force": load.force,
        "directions": [float(angle) for angle in load.directions],
        "moment": load.moment,
    }


def proof_entry(proof: Proof) -> dict[str, Any]:
    """The account of the search as it is written."""
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
                "theta_deg": float(rounded_degrees(item.theta_deg)),
                "reach_deg": item.reach_deg,
                "reason": item.reason,
            }
            for item in proof.undecided
        ],
    }


def fixture_rows(
    table: FixtureTable, toolkit: Toolkit, workpiece: Workpiece
) -> Iterator[tuple[list[int], Iterator[tuple[Any, ...]]]]:
    """Blocks of fixtures as plain numbers, rounded as they are written.

    Yields
    ------
    The indices of the arrangements, and for every fixture a tuple of numbers: for each peg column, row, x, y, face, force
    (of two clamps at their working ratio); then theta in degrees, x and y of the pose, jaw separation or the travel of each
    clamp; and after them the figures of :func:`known_figures`. Where pegs have flats, last a list: which way the flat of
    each looks that stands in a hole.
    """
    known = [FIGURES.index(figure) for figure in known_figures(table)]
    for start in range(0, len(table), BLOCK):
        block = table.take(slice(start, start + BLOCK))
        theta, told = as_told(block)
        x, y = (rounded(places, LENGTH_STEPS) for places in peg_places(told, toolkit, workpiece))
        columns: list[list[Any]] = []
        force = working_forces(block.force) if toolkit.needs_pairs else block.force
        for peg in range(toolkit.peg_count):
            numbers = (block.column, block.row, x, y, block.face, force)
            columns += [array[:, peg].tolist() for array in numbers]
        figures = [block.quality[:, number] for number in known]
        columns += [
            array.tolist() for array in (theta, *told.position.T, *np.atleast_2d(told.jaw_separation.T), *figures)
        ]
        if toolkit.has_flats:
            columns.append(flats_told(block, toolkit, workpiece))
        yield block.arrangement.tolist(), zip(*columns, strict=True)
