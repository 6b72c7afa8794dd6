"""Reading a result file back (MODEL, "Result file"), from workhold or from any other program that writes the form.

The head is checked by pydantic, the fixtures by array operations. A file with one fixture per line, as workhold writes
it, is read line by line; any other layout of the same JSON is read as a whole. Messages count fixtures and pegs from 1.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray
from pydantic import ValidationError

from workhold.conventions import AGREEMENT
from workhold.errors import InputError
from workhold.files.result.forms import Head, ProofPart
from workhold.files.text import json_value
from workhold.model.proof import Proof
from workhold.model.quality import CLOSURE_MARGIN, FIGURES, LOAD_REACTION
from workhold.model.query import Query
from workhold.model.result import FixtureTable, Result
from workhold.model.toolkit import Toolkit

__all__ = ["read_result"]

BLOCK = 4096
LARGEST_NUMBER = 2**31 - 1
# Bytes of a file of another layout, which takes twenty times as much memory.
LARGEST_WHOLE = 200_000_000


@frozen
class Columns:
    """The fixtures of a file as arrays: (N,) types and (N, 4) jaws by name, (N, 4, 3) holes and faces, (N, 4, 3) x, y and
    forces, (N, 4) pose in degrees and mm and jaw separation, (N, 6) figures of quality (NaN where the file gives none)."""

    types: NDArray[np.str_]
    jaws: NDArray[np.str_]
    holes: NDArray[np.int32]
    contacts: NDArray[np.float64]
    placing: NDArray[np.float64]
    quality: NDArray[np.float64]


class OtherLayoutError(Exception):
    """The file does not have one fixture on every line."""


def read_result(path: str | Path) -> Result:
    """Read a result file.

    Raises
    ------
    InputError
        When the file cannot be read, is no result file, or contradicts itself.
    """
    path = Path(path)
    try:
        try:
            data, columns = read_lines(path)
        except OtherLayoutError:
            data, columns = read_whole(path)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}.") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is not a result file: it is not text.") from error
    except RecursionError as error:
        raise InputError(f"{path} is not a result file: its brackets are nested too deeply.") from error
    head = checked_head(data, path)
    try:
        query = head.query()
        refuse_other_types(head, query.toolkit)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    result = Result(
        query,
        measured(checked_table(columns, query, path), query),
        found=head.found or head.counts,
        distinct=head.distinct or head.counts,
        complete=head.complete,
        notes=tuple(head.notes),
        statistics=head.statistics,
        proof=None if head.proof is None else checked_proof(head.proof, query, path),
    )
    for name, listed in result.counts.items():
        if head.counts[name] != listed:
            said = head.counts[name]
            raise InputError(f"{path}: counts say {said} fixtures of type {name}, but {listed} are listed.")
    return result


def refuse_other_types(head: Head, toolkit: Toolkit) -> None:
    """Refuse counts of other types than the toolkit's.

    Raises
    ------
    InputError
        Naming the counts.
    """
    names = [one.name for one in toolkit.arrangements]
    for key in ("counts", "found", "distinct"):
        counts = getattr(head, key)
        if counts is not None and set(counts) != set(names):
            raise InputError(f"{key} does not give a number for each of the types {', '.join(names)} and no other.")


def read_lines(path: Path) -> tuple[Any, Columns]:
    """Head and fixtures of a file with one fixture per line, never holding more than a block of them as objects.

    Raises
    ------
    OtherLayoutError
        When the lines are not of that form.
    """
    with path.open(encoding="utf-8-sig") as stream:
        before: list[str] = []
        for line in stream:
            before.append(line)
            if line.strip() == '"fixtures": [':
                break
        else:
            raise OtherLayoutError
        after: list[str] = []
        columns = collected(fixture_lines(stream, after), path)
        try:
            data = json_value("".join(before + after) + stream.read())
        except ValueError as error:
            raise OtherLayoutError from error
    return data, columns


def fixture_lines(stream: Iterable[str], after: list[str]) -> Iterator[Any]:
    """The fixtures on their lines; the line that ends the list goes to ``after``."""
    last = False
    for line in stream:
        text = line.strip()
        if text.startswith("]"):
            after.append(line)
            return
        if last:
            raise OtherLayoutError
        last = not text.endswith(",")
        try:
            yield json_value(text.removesuffix(","))
        except ValueError as error:
            raise OtherLayoutError from error
    raise OtherLayoutError


def read_whole(path: Path) -> tuple[Any, Columns]:
    """Head and fixtures of a file of any layout."""
    if path.is_file() and path.stat().st_size > LARGEST_WHOLE:
        raise InputError(
            f"{path} is too large a file to be read but with one fixture on every line, as workhold writes it."
        )
    text = path.read_text(encoding="utf-8-sig")
    if not text.strip():
        raise InputError(f"{path} is empty: it is not a result file.")
    try:
        data = json_value(text)
    except InputError as error:
        raise InputError(f"{path} is not a result file: {error}") from error
    if not isinstance(data, dict) or not isinstance(data.get("fixtures"), list):
        raise InputError(f"{path} is not a result file: it has no list of fixtures.")
    return data, collected(data.pop("fixtures"), path)


def checked_head(data: Any, path: Path) -> Head:
    """Check the head's keys.

    Raises
    ------
    InputError
        Naming the first key that is missing or cannot be used.
    """
    try:
        return Head.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        if first["type"] == "missing":
            raise InputError(f"{path} is not a complete result file: the key {key} is missing.") from error
        reason = first["msg"][:1].lower() + first["msg"][1:]
        raise InputError(f"{path}: {key or 'the head'} cannot be used: {reason}.") from error


def checked_proof(part: ProofPart, query: Query, path: Path) -> Proof:
    """The account of the search.

    Raises
    ------
    InputError
        When its counts do not add up, or an undecided candidate names an unknown type or a segment that is no face.
    """
    accounted = part.discarded_by_bound + part.verified + len(part.undecided)
    if accounted != part.candidates:
        raise InputError(
            f"{path}: the proof says {part.candidates} candidates, but {accounted} are discarded, verified or undecided."
        )
    faces = {face.number for face in query.workpiece.faces}
    types = [one.name for one in query.toolkit.arrangements]
    for number, item in enumerate(part.undecided, 1):
        if item.type not in types:
            raise InputError(f"{path}: undecided candidate {number} of the proof is not of type {' or '.join(types)}.")
        if not faces.issuperset(item.segments):
            raise InputError(f"{path}: undecided candidate {number} of the proof names a segment that is no face.")
    return part.proof()


def collected(fixtures: Iterable[Any], path: Path) -> Columns:
    """Put fixtures into arrays, block by block.

    Raises
    ------
    InputError
        Naming the first fixture with a missing key or a value of the wrong kind.
    """
    blocks: list[list[NDArray[Any]]] = [[] for _ in range(6)]
    iterator = iter(fixtures)
    number = 1
    while True:
        rows = []
        for fixture in islice(iterator, BLOCK):
            try:
                rows.append(fixture_row(fixture))
            except KeyError as error:
                raise InputError(f"{path}: fixture {number} has no key {error}.") from error
            except (TypeError, ValueError, AttributeError) as error:
                raise InputError(f"{path}: fixture {number} cannot be used: {error}.") from error
            number += 1
        kinds = (np.str_, np.str_, np.int32, np.float64, np.float64, np.float64)
        shapes = ((), (4,), (4, 3), (4, 3), (4,), (len(FIGURES),))
        for k, (kind, shape) in enumerate(zip(kinds, shapes, strict=True)):
            blocks[k].append(np.array([row[k] for row in rows], dtype=kind).reshape(len(rows), *shape))
        if len(rows) < BLOCK:
            return Columns(*(np.concatenate(parts) for parts in blocks))


def fixture_row(
    fixture: Any,
) -> tuple[str, list[str], list[list[int]], list[list[float]], list[float], list[float]]:
    """The numbers of one fixture, for one row of each array of :class:`Columns`."""
    name = fixture["type"]
    pegs, pose = fixture["pegs"], fixture["pose"]
    if not isinstance(pegs, list) or len(pegs) != 4:
        raise ValueError("it does not have four pegs")
    jaws = [peg["jaw"] for peg in pegs]
    if not all(isinstance(word, str) for word in (name, *jaws)):
        raise ValueError("its type or a peg's jaw is not text")
    holes = [[peg["column"], peg["row"], peg["segment"]] for peg in pegs]
    contacts = [[peg["x"], peg["y"], peg["force"]] for peg in pegs]
    figures = fixture.get("quality", {})
    known = [figures[figure.key] for figure in FIGURES if figure.key in figures]
    placing = [pose["theta_deg"], pose["x"], pose["y"], fixture["jaw_separation"]]
    if {type(value) for hole in holes for value in hole} != {int}:
        raise ValueError("a peg's column, row or segment is not a whole number")
    if any(not 0 <= value <= LARGEST_NUMBER for hole in holes for value in hole):
        raise ValueError("a peg's column, row or segment is negative or far too large")
    numbers = [value for contact in contacts for value in contact] + placing + known
    if not {type(value) for value in numbers} <= {int, float} or any(abs(value) > 1e300 for value in numbers):
        raise ValueError("a length, an angle or a force is not a finite number")
    return name, jaws, holes, contacts, placing, [figures.get(figure.key, np.nan) for figure in FIGURES]


def indices(words: NDArray[np.str_], names: Sequence[str]) -> NDArray[np.int8]:
    """The place of each word among some names; -1 for a word that is none of them."""
    out = np.full(words.shape, -1, np.int8)
    for index, name in enumerate(names):
        out[words == name] = index
    return out


def checked_table(columns: Columns, query: Query, path: Path) -> FixtureTable:
    """The table of the fixtures, pegs in the order of their arrangements.

    Raises
    ------
    InputError
        Naming the first fixture that contradicts the vise, the workpiece or itself.
    """
    toolkit = query.toolkit
    arrangements, carriers = ([one.name for one in several] for several in (toolkit.arrangements, toolkit.carriers))
    arrangement, jaw = indices(columns.types, arrangements), indices(columns.jaws, carriers)
    order = np.argsort(jaw, axis=1, kind="stable")
    jaw = np.take_along_axis(jaw, order, axis=1)
    hole = np.take_along_axis(columns.holes, order[:, :, None], axis=1)
    contact = np.take_along_axis(columns.contacts, order[:, :, None], axis=1)
    column, row, face = (np.ascontiguousarray(hole[:, :, k]) for k in range(3))
    theta_deg, x, y, separation = columns.placing.T
    force = np.ascontiguousarray(contact[:, :, 2])

    def refuse(faulty: NDArray[np.bool_], reason: str) -> None:
        where = np.flatnonzero(faulty if faulty.ndim == 1 else faulty.any(axis=1))
        if where.size:
            raise InputError(f"{path}: fixture {int(where[0]) + 1} {reason}.")

    refuse(arrangement < 0, f"cannot be used: its type is not {' or '.join(arrangements)}")
    refuse(jaw < 0, f"cannot be used: a peg's jaw is not {' or '.join(carriers)}")
    refuse(jaw != toolkit.peg_carriers(arrangement), "does not have the pegs of its type on each jaw")
    for number, carrier in enumerate(toolkit.carriers):
        beyond = (jaw == number) & (column >= carrier.columns)
        refuse(beyond, f"has a peg in a column beyond the {carrier.columns} of the {carrier.name} jaw")
        if carrier.rows is not None:
            beyond = (jaw == number) & (row >= carrier.rows)
            refuse(beyond, f"has a peg in a row beyond the {carrier.rows} of the {carrier.name} jaw")
    faces = [face.number for face in query.workpiece.faces]
    refuse(~np.isin(face, faces), "has a peg on a segment that does not name a face of the workpiece")
    hole_x, hole_y = toolkit.places(arrangement, column, row, separation)
    apart = np.hypot(contact[:, :, 0] - hole_x, contact[:, :, 1] - hole_y) > AGREEMENT
    refuse(apart, "has a peg whose x, y are not those of its hole")
    refuse(force <= 0, "has a peg whose force is not positive")
    return FixtureTable(
        arrangement=arrangement,
        column=column,
        row=row,
        face=face,
        theta=np.radians(theta_deg) % (2 * np.pi),
        position=np.stack([x, y], axis=1),
        jaw_separation=separation.copy(),
        null_vector=null_vectors(force, columns.quality[:, CLOSURE_MARGIN]),
        force=force,
        quality=columns.quality,
    )


def measured(table: FixtureTable, query: Query) -> FixtureTable:
    """The table with the figures of quality that the file does not give."""
    wanted = np.isnan(table.quality)
    if not query.loads:
        wanted[:, LOAD_REACTION] = False
    if not wanted.any():
        return table
    from workhold.model.vise import Vise
    from workhold.statics.quality import quality_of

    vise = query.toolkit
    assert isinstance(vise, Vise)

    figures = quality_of(table, query.workpiece, vise, query.tolerance, query.loads)
    return evolve(table, quality=np.where(wanted, figures, table.quality))


def null_vectors(force: NDArray[np.float64], margin: NDArray[np.float64]) -> NDArray[np.float64]:
    """Null vectors (N, 4) of sum 1 from forces (N, 4), which are proportional to them.

    Forces are written with twelve digits; the smallest entry is taken from the closure margin as written, so that
    reading and writing again gives the same file.
    """
    null_vector: NDArray[np.float64] = force / force.sum(axis=1, keepdims=True)
    smallest = null_vector.argmin(axis=1)
    rows = np.arange(len(force))
    margin = np.where(np.isnan(margin), null_vector[rows, smallest], margin)
    null_vector = np.maximum(null_vector, margin[:, None])
    null_vector[rows, smallest] = margin
    return null_vector
