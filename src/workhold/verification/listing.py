"""What a result claims, number for number as its file writes it.

Reading a result to use it drops what can be worked out again, such as the pegs' x and y, and takes what the file does not
give for the usual. A verification has to see every number, and what is missing. Head and lines come by the one reader
there is of result files (``files.result.parts``); what is made of them here is compared with nothing of the search.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import Any

from attrs import frozen

from workhold.archive import is_archive
from workhold.errors import InputError
from workhold.files.result.forms import Head
from workhold.files.result.head import checked_head
from workhold.files.result.parts import read_parts
from workhold.files.text import json_value
from workhold.model.fixture import Fixture, Peg, Pose
from workhold.model.proof import Proof
from workhold.model.quality import FIGURES
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.verification.columns import Columns, FixturesInColumns, columns_of
from workhold.verification.fence import WALL_ENDS
from workhold.verification.hardware import Hardware
from workhold.verification.kinds import hardware_of
from workhold.verification.plate import PLATE, WAYS, clamp_place
from workhold.verification.rules import WALL

__all__ = ["Listing", "listing_of", "read_listing"]


@frozen(eq=False)
class Listing:
    """A result as it is written.

    Parameters
    ----------
    query : what was asked.
    fixtures : as listed.
    counts, found, distinct : numbers of fixtures by type, as written.
    complete, notes, statistics, proof : see ``Result``.
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

    @property
    def hardware(self) -> Hardware:
        """The rules of its toolkit."""
        return hardware_of(self.query.toolkit)


class UnusableError(Exception):
    """A value of the wrong kind; the message goes behind the place."""


def listing_of(result: Result) -> Listing:
    """What a result claims that is not in a file."""
    return Listing(
        result.query,
        list(result),
        result.counts,
        result.found,
        result.distinct,
        result.complete,
        result.notes,
        result.statistics,
        result.proof,
    )


def read_listing(path: str | Path) -> Listing:
    """Read what a result file claims.

    Raises
    ------
    InputError
        When the file cannot be read, is no result file, or describes no usable workpiece or toolkit.
    """
    path = Path(path)
    head, taken = head_and_fixtures(path)
    try:
        query = head.query()
        types = query.toolkit.types
        return Listing(
            query,
            taken_in(taken, hardware_of(query.toolkit)),
            numbers_of(head.counts, "counts", types),
            numbers_of(head.found, "found", types, head.counts),
            numbers_of(head.distinct, "distinct", types, head.counts),
            head.complete,
            head.notes,
            head.statistics,
            None if head.proof is None else head.proof.proof(),
            (*keys_missing(head), *turned_loops(head.workpiece.loops, query)),
        )
    except InputError as error:
        raise InputError(f"{path} cannot be verified: {error}") from error


def head_and_fixtures(path: Path) -> tuple[Head, list[Fixture] | Columns]:
    """The head of a file, and its fixtures, or their numbers where it is one in columns.

    Raises
    ------
    InputError
        When the file cannot be read or is no result file.
    """
    try:
        if is_archive(path):
            text, columns = columns_of(path)
            return checked_head(json_value(text), path), columns
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}.") from error
    return read_parts(path, fixtures_of)


def taken_in(fixtures: list[Fixture] | Columns, hardware: Hardware) -> Sequence[Fixture]:
    """Fixtures as they are read, of a kind of toolkit.

    Raises
    ------
    InputError
        Naming the first one that is of another kind.
    """
    if not isinstance(fixtures, list):
        return FixturesInColumns(fixtures, hardware.toolkit)
    out = []
    for number, fixture in enumerate(fixtures, 1):
        try:
            out.append(hardware.taken(fixture))
        except InputError as error:
            raise InputError(f"fixture {number} cannot be used: {error}.") from error
    return out


def keys_missing(head: Head) -> list[str]:
    """A fault for every key of the form that is not there: what would be taken for it is claimed by nobody."""
    # Of a vise and a toolkit one is enough, an account that is missing is told in any case, and a fit decides nothing; a
    # departure counts in the tolerance of the faces, which is there.
    spared = {"toolkit" if head.toolkit is None else "vise", "proof", "tolerance.fit"}
    spared |= {"workpiece.departure", "tolerance.departure"}
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


def fixtures_of(items: Iterable[Any], path: Path) -> list[Fixture]:
    """Fixtures from their JSON objects.

    Raises
    ------
    InputError
        Naming the first one that cannot be used, counted from 1.
    """
    fixtures = []
    for number, item in enumerate(items, 1):
        try:
            fixtures.append(fixture_from(item))
        except UnusableError as error:
            raise InputError(f"{path} cannot be verified: number {number} in fixtures: {error}.") from error
    return fixtures


def fixture_from(item: Any) -> Fixture:
    """A fixture from its JSON object.

    Raises
    ------
    UnusableError
        Saying what is missing.
    """
    if not isinstance(item, dict):
        raise UnusableError("it is no fixture")
    pegs, pose, quality = item.get("pegs"), item.get("pose"), item.get("quality")
    direction = word(item, "direction") if item.get("direction") is not None else None
    if direction not in (None, *WAYS):
        raise UnusableError(f"its direction is not {' or '.join(WAYS)}")
    on_wall = wall_pegs_from(item["wall"]) if "wall" in item else ()
    if not isinstance(pegs, list) or len(on_wall) + len(pegs) != 4 or not all(isinstance(peg, dict) for peg in pegs):
        raise UnusableError("it does not have four pegs")
    taken = tuple(peg_from(peg) if direction is None else plate_peg_from(peg, direction) for peg in pegs)
    if not isinstance(pose, dict):
        raise UnusableError("it has no pose")
    if not isinstance(quality, dict):
        raise UnusableError("it has no quality")
    return Fixture(
        word(item, "type"),
        (*taken[:1], *on_wall, *taken[1:]),
        Pose(real(pose, "theta_deg"), real(pose, "x"), real(pose, "y")),
        # How far a clamp has travelled follows from its place.
        real(item, "jaw_separation") if direction is None else 0.0,
        {figure.key: real(quality, figure.key) for figure in FIGURES if figure.key in quality},
        direction,
    )


def wall_pegs_from(item: Any) -> tuple[Peg, Peg]:
    """The two ends of the contact with a wall from their JSON object.

    Raises
    ------
    UnusableError
        Saying what is missing.
    """
    if not isinstance(item, dict):
        raise UnusableError("its wall is not told by places, segments and forces")
    pairs = []
    for key in ("from", "to", "segments", "forces"):
        value = item.get(key)
        if not isinstance(value, list) or len(value) != 2:
            raise UnusableError(f"the {key} of its wall is not two numbers")
        pairs.append({"first": value[0], "second": value[1]})
    *places, faces, forces = pairs
    one, other = (
        Peg(WALL, 0, 0, real(place, "first"), real(place, "second"), whole(faces, which), real(forces, which), called)
        for place, which, called in zip(places, ("first", "second"), WALL_ENDS, strict=True)
    )
    return one, other


def plate_peg_from(item: Mapping[str, Any], direction: str) -> Peg:
    """A locator, or a clamp that moves in a direction, from its JSON object.

    Raises
    ------
    UnusableError
        Saying what is missing.
    """
    role, line = word(item, "role"), "row" if direction.endswith("x") else "column"
    contact = real(item, "x"), real(item, "y"), whole(item, "segment"), real(item, "force")
    if role == "locator":
        return Peg(PLATE, whole(item, "column"), whole(item, "row"), *contact)
    if role != "clamp":
        raise UnusableError("the role of a peg is neither locator nor clamp")
    if "hole" not in item:
        raise UnusableError("the key hole is missing")
    hole, place = item["hole"], {"column": 0, "row": 0}
    if hole is not None:
        if not isinstance(hole, list) or len(hole) != 2:
            raise UnusableError("the hole of its clamp is not a column and a row")
        numbers = {"column": hole[0], "row": hole[1]}
        place = {name: whole(numbers, name) for name in numbers}
    if hole is not None and place[line] != whole(item, line):
        raise UnusableError(f"the {line} of its clamp is not that of its hole")
    place[line] = whole(item, line)
    column, row = place["column"], place["row"]
    called = clamp_place(direction, column, row, hole is not None) if min(column, row) >= 0 else None
    return Peg(f"clamp {direction}", column, row, *contact, called)


def peg_from(item: Mapping[str, Any]) -> Peg:
    """A peg of a vise from its JSON object.

    Raises
    ------
    UnusableError
        Saying what is missing.
    """
    column, row, segment = (whole(item, key) for key in ("column", "row", "segment"))
    x, y, force = (real(item, key) for key in ("x", "y", "force"))
    return Peg(word(item, "jaw"), column, row, x, y, segment, force)


def word(item: Mapping[str, Any], key: str) -> str:
    """A word of a JSON object.

    Raises
    ------
    UnusableError
        When it is missing or no word.
    """
    value = item.get(key)
    if not isinstance(value, str):
        raise UnusableError(f"{key} is {value!r}, not a word" if key in item else f"the key {key} is missing")
    return value


def real(item: Mapping[str, Any], key: str) -> float:
    """A finite number of a JSON object.

    Raises
    ------
    UnusableError
        When it is missing or no number.
    """
    value: Any = item.get(key)
    if type(value) not in (int, float) or abs(value) > 1e300 or not isfinite(value):
        raise UnusableError(f"{key} is {value!r}, not a number" if key in item else f"the key {key} is missing")
    return float(value)


def whole(item: Mapping[str, Any], key: str) -> int:
    """A whole number of a JSON object.

    Raises
    ------
    UnusableError
        When it is missing or no whole number of a sensible size.
    """
    value = item.get(key)
    if type(value) is not int or abs(value) > 2**31:
        raise UnusableError(f"{key} is {value!r}, not a whole number" if key in item else f"the key {key} is missing")
    return value
