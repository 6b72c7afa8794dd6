"""What a result claims, number for number as its file writes it.

Reading a result to use it drops what can be worked out again, such as the pegs' x and y, and takes what the file does not
give for the usual. A verification has to see every number, and what is missing. Head and lines come by the one reader
there is of result files (``files.result.parts``); what is made of them here is compared with nothing of the search.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from attrs import evolve, frozen

from workhold.archive import is_archive
from workhold.errors import InputError
from workhold.files.result.forms import Head
from workhold.files.result.head import checked_head
from workhold.files.result.parts import read_parts
from workhold.files.result.seating_forms import seatings_told
from workhold.files.text import json_value
from workhold.model.fixture import Fixture
from workhold.model.proof import Proof
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.verification.claims import claim_of, with_claims
from workhold.verification.columns import Columns, FixturesInColumns, columns_of
from workhold.verification.reading import fixtures_of
from workhold.verification.rules.hardware import ToolkitRules

__all__ = ["Listing", "listing_of", "read_listing"]


@frozen(eq=False)
class Listing:
    """A result as it is written.

    Parameters
    ----------
    query : what was asked.
    fixtures : as listed.
    counts, found, distinct : numbers of fixtures by type, as written.
    complete, notes, statistics, proof, pairs, seats : see ``Result``.
    faults : contradictions in the head of the file, one sentence each.
    """

    query: Query
    fixtures: Sequence[Fixture]
    counts: Mapping[str, int]
    found: Mapping[str, int]
    distinct: Mapping[str, int]
    complete: bool
    notes: Sequence[str]
    statistics: Mapping[str, int]
    proof: Proof | None
    faults: tuple[str, ...] = ()
    pairs: int | None = None
    seats: int | None = None

    @property
    def hardware(self) -> ToolkitRules:
        """The rules of its toolkit."""
        return ToolkitRules.of(self.query)


def listing_of(result: Result) -> Listing:
    """What a result claims that is not in a file."""
    return Listing(
        result.query,
        with_claims(list(result), result.query),
        result.counts,
        result.found,
        result.distinct,
        result.complete,
        result.notes,
        result.statistics,
        result.proof,
        pairs=result.pairs,
        seats=result.seats,
    )


def read_listing(path: str | Path) -> Listing:
    """Read what a result file claims.

    Raises
    ------
    InputError
        When the file cannot be read, is no result file, or describes no usable workpiece or toolkit.
    """
    path = Path(path)
    head, taken, seatings = head_and_fixtures(path)
    try:
        query = head.query()
        types = query.toolkit.types
        return Listing(
            query,
            taken_in(taken, seatings, ToolkitRules.of(query), query, path),
            numbers_of(head.counts, "counts", types),
            numbers_of(head.found, "found", types, head.counts),
            numbers_of(head.distinct, "distinct", types, head.counts),
            head.complete,
            head.notes,
            head.statistics,
            None if head.proof is None else head.proof.proof(),
            (*keys_missing(head), *turned_loops(head.workpiece.loops, query)),
            head.pairs,
            head.seats,
        )
    except InputError as error:
        raise InputError(f"{path} cannot be verified: {error}") from error


def head_and_fixtures(path: Path) -> tuple[Head, list[Fixture] | Columns, list[Any]]:
    """The head of a file, and its fixtures, or their numbers and the seating of the first where it is one in columns.

    Raises
    ------
    InputError
        When the file cannot be read or is no result file.
    """
    try:
        if is_archive(path):
            text, columns = columns_of(path)
            data = json_value(text)
            head = checked_head(data, path)
            return head, columns, seatings_told(data, path)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}.") from error
    return *read_parts(path, fixtures_of), []


def taken_in(
    fixtures: list[Fixture] | Columns, seatings: Sequence[Any], hardware: ToolkitRules, query: Query, path: Path
) -> Sequence[Fixture]:
    """Fixtures as they are read, of a kind of toolkit, and the seating of the first where it stands apart from them.

    Raises
    ------
    InputError
        Naming the first one that is of another kind, or whose seating cannot be used.
    """
    if not isinstance(fixtures, list):
        listed = FixturesInColumns(fixtures, hardware.toolkit)
        if len(seatings) > len(listed):
            raise InputError(f"the seating of {len(seatings)} fixtures is told, but {len(listed)} are listed.")
        poses = [fixture.pose for fixture in listed[: len(seatings)]]
        told = enumerate(zip(seatings, poses, strict=True), 1)
        return evolve(listed, claims=tuple(claim_of(one, pose, query, path, k) for k, (one, pose) in told))
    out = []
    for number, fixture in enumerate(fixtures, 1):
        try:
            out.append(hardware.taken(fixture))
        except InputError as error:
            raise InputError(f"fixture {number} cannot be used: {error}.") from error
    return with_claims(out, query, path)


def keys_missing(head: Head) -> list[str]:
    """A fault for every key of the form that is not there: what would be taken for it is claimed by nobody."""
    # Of a vise and a toolkit one is enough, an account that is missing is named in any case, and a fit decides nothing; a
    # departure counts in the tolerance of the faces, which is there.
    spared = {"toolkit" if head.toolkit is None else "vise", "proof", "tolerance.fit"}
    spared |= {"workpiece.departure", "tolerance.departure", "vise.flat", "toolkit.flat"}
    if head.seating is None:
        spared |= {"seating", "opening", "foolproof"}
    if getattr(head.toolkit, "clamps", 1) == 1:
        spared |= {"listing", "pairs", "seats", "toolkit.clamps"}
    return [f"the key {key} is missing" for key in head.not_given() if key not in spared]


def numbers_of(
    counts: Mapping[str, int] | None, key: str, types: Sequence[str], usual: Mapping[str, int] | None = None
) -> Mapping[str, int]:
    """Numbers of fixtures by type.

    Raises
    ------
    InputError
        When they are not of the toolkit's types.
    """
    counts = usual if counts is None else counts
    if counts is None or set(counts) != set(types):
        raise InputError(f"{key} does not give a number for each of the types {', '.join(types)} and no other.")
    return counts


def turned_loops(loops: Sequence[Any], query: Query) -> list[str]:
    """A fault for every loop that does not run with the material on its left, which makes its numbers ambiguous."""
    return [
        f"loop {index} does not have the material on its left"
        for index, (written, used) in enumerate(zip(loops, query.workpiece.loops, strict=True))
        if written != used.tolist()
    ]
