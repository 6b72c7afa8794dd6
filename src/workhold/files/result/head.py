"""The head of a result file read back: everything but the fixtures, whatever form those have."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from attrs import evolve
from pydantic import ValidationError

from workhold.errors import InputError
from workhold.files.result.forms import Head, ProofPart
from workhold.files.toolkit.shapes import TAGS
from workhold.fixels.toolkit import Toolkit
from workhold.model.proof import Proof
from workhold.model.query import Query
from workhold.model.result import FixtureTable, Result
from workhold.model.seating import Seating

__all__ = ["checked_head", "checked_query", "result_with", "with_seating"]


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
        key = ".".join(str(part) for part in first["loc"] if part not in TAGS)
        if first["type"] == "missing":
            raise InputError(f"{path} is not a complete result file: the key {key} is missing.") from error
        reason = first["msg"][:1].lower() + first["msg"][1:]
        raise InputError(f"{path}: {key or 'the head'} cannot be used: {reason}.") from error


def checked_query(head: Head, path: Path) -> Query:
    """What was asked.

    Raises
    ------
    InputError
        When a part of it cannot be, or the counts are of other types.
    """
    try:
        query = head.query()
        refuse_other_types(head, query.toolkit)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return query


def refuse_other_types(head: Head, toolkit: Toolkit) -> None:
    """Refuse counts of other types than the toolkit's.

    Raises
    ------
    InputError
        Naming the counts.
    """
    names = toolkit.types
    for key in ("counts", "found", "distinct"):
        counts = getattr(head, key)
        if counts is not None and set(counts) != set(names):
            raise InputError(f"{key} does not give a number for each of the types {', '.join(names)} and no other.")


def result_with(table: FixtureTable, head: Head, query: Query, path: Path) -> Result:
    """The result of a head and a table.

    Raises
    ------
    InputError
        When the counts are not those of the table, or the account of the search does not add up.
    """
    for name, listed in query.toolkit.arrangements_counted(table.arrangement).items():
        if head.counts[name] != listed:
            said = head.counts[name]
            raise InputError(f"{path}: counts say {said} fixtures of type {name}, but {listed} are listed.")
    return Result(
        query,
        table,
        found=head.found or head.counts,
        distinct=head.distinct or head.counts,
        complete=head.complete,
        notes=tuple(head.notes),
        statistics=head.statistics,
        proof=None if head.proof is None else checked_proof(head.proof, query, path),
        pairs=head.pairs,
        seats=head.seats,
    )


def with_seating(result: Result, seating: Sequence[Seating], path: Path) -> Result:
    """A result with the seating of its first fixtures.

    Raises
    ------
    InputError
        Where that is told though it was not asked for, or of more fixtures than it was asked of.
    """
    query = result.query
    if len(seating) > (query.seating or 0) or len(seating) > len(result):
        raise InputError(
            f"{path}: the seating of {len(seating)} fixtures is told, but it is asked of {query.seating or 0} and "
            f"{len(result)} are listed."
        )
    return evolve(result, seating=tuple(one.in_toolkit(query.toolkit, query.opening) for one in seating))


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
    # With two clamps also contacts of one of them may be undecided.
    toolkits = (query.toolkit, *query.toolkit.ways)
    types = list(dict.fromkeys(one.title for toolkit in toolkits for one in toolkit.arrangements))
    for number, item in enumerate(part.undecided, 1):
        if item.type not in types:
            raise InputError(f"{path}: undecided candidate {number} of the proof is not of type {' or '.join(types)}.")
        pegs = (4, query.toolkit.peg_count)
        for key in ("columns", "rows", "segments"):
            if len(getattr(item, key)) not in pegs:
                raise InputError(
                    f"{path}: proof.undecided.{number - 1}.{key} cannot be used: it needs one for each peg."
                )
        if not faces.issuperset(item.segments):
            raise InputError(f"{path}: undecided candidate {number} of the proof names a segment that is no face.")
    return part.proof()
