"""The two parts of a result file: its head, checked by pydantic, and its fixtures as JSON objects.

A file with one fixture per line, as workhold writes it, is read line by line, so that no more than one
fixture at a time is an object. Any other layout of the same JSON is read as a whole. Every reader of result
files uses this module. Fixtures have to meet the same conditions in whatever form they are written. For a
file in columns, the head also determines the columns (docs/columns.md).

Glossary
--------
head : everything but the fixtures, whatever form those have.
swept piece : a cylinder of a tool on one move of a program. A program has many, so each is packed into bytes
    as soon as it is read.
"""

from __future__ import annotations

import json
import re
import struct
from codecs import BOM_UTF8
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any, BinaryIO, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from workhold.archive import ColumnFormat, Columns
from workhold.errors import InputError
from workhold.files.budget import LIMITS
from workhold.files.result.forms import MISSING, Head, ProofPart, describe_first_fault
from workhold.files.result.notes import read_notes
from workhold.files.text import parse_json, read_limited
from workhold.fixels.fields import CLAMPS
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture_table import FixtureTable
from workhold.model.moves import PIECE_KEYS, pack_piece
from workhold.model.quality import BEFORE_PINS, FIGURES
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.search_report import ProofReport

__all__ = [
    "HEAD",
    "PINS_KNOWN",
    "LARGEST_LENGTH",
    "LARGEST_NUMBER",
    "OtherLayoutError",
    "check_head",
    "check_query",
    "describe_columns",
    "describe_columns_from_head",
    "split_fixture_texts",
    "parse_head",
    "parse_fixture_text",
    "explain_reading_errors",
    "read_lines",
    "read_parts",
    "refuse_faulty",
    "refuse_rows",
    "refuse_unknown_types",
    "make_result",
    "make_result_from_counts",
    "start_of_fixtures",
]

LARGEST_NUMBER = 2**31 - 1
LARGEST_LENGTH = 1e300
NOT_FINITE = "cannot be used: a length, an angle or a force is not a finite number"


HEAD = "result.json"
# The key of the head of a file in columns that says that these have figures of how far pegs bend.
PINS_KNOWN = "bending"
# Bytes of the line of a fixture, and of all that stands before and after the fixtures, as of the text of an
# archive. What is looked through for the first fixture is read in such pieces.
MOST_LINE, MOST_AROUND, CHUNK = 20_000_000, 50_000_000, 1 << 20
# What stands alone on the line before the first fixture, and how long that line may be.
FIRST_LINE = re.compile(rb'"fixtures": \[[ \t\r]{0,99}\n')
LONGEST_FIRST_LINE = 250


def describe_columns(travels: int, has_program: bool = False, figures: int = BEFORE_PINS) -> Columns:
    """Return the format of each column by name (docs/columns.md).

    Parameters
    ----------
    travels : number of moving carriers of a fixture, 1 or 2.
    has_program : whether the column of figures ends with the program clearance.
    figures : number of figures of quality without the program clearance.
    """
    pegs, several = 3 + travels, (travels,) if travels > 1 else ()
    return {
        "arrangement": ColumnFormat("|i1"),
        **dict.fromkeys(("column", "row", "face"), ColumnFormat("<i4", (pegs,))),
        "theta": ColumnFormat("<f8"),
        "position": ColumnFormat("<f8", (2,)),
        "jaw_separation": ColumnFormat("<f8", several),
        "force": ColumnFormat("<f8", (pegs, *several)),
        "quality": ColumnFormat("<f8", (figures + has_program,)),
        **({"pairs": ColumnFormat("<i4")} if travels > 1 else {}),
    }


def drop_swept_piece(entries: dict[str, Any]) -> dict[str, Any] | None:
    """Return a JSON object unchanged, or None for one that is a cylinder of a tool on a move of a program.

    For use as ``object_hook``; a program has many such objects.
    """
    return None if entries.keys() == PIECE_KEYS else entries


def describe_columns_from_head(head: str) -> Columns:
    """Return the formats of the columns by name, from the text of a head;
    those of a vise if the text is not a head.
    """
    try:
        said = json.loads(head, object_hook=drop_swept_piece)
        toolkit = said.get("toolkit")
        travels = 2 if toolkit is not None and toolkit.get(CLAMPS.name) == 2 else 1
        figures = len(FIGURES) if said.get(PINS_KNOWN) else BEFORE_PINS
        return describe_columns(travels, said.get("program") is not None, figures)
    except (ValueError, AttributeError, RecursionError):
        return describe_columns(1)


def pack_swept_piece(entries: dict[str, Any]) -> Any:
    """Return a JSON object unchanged, or packed into bytes
    if it is a cylinder of a tool on a move of a program.

    A cylinder that cannot be packed is returned unchanged.
    """
    if entries.keys() != PIECE_KEYS:
        return entries
    try:
        return pack_piece(entries)
    except (InputError, LookupError, TypeError, ValueError, struct.error):
        # Whoever makes the program says what is wrong.
        return entries


def parse_head(text: str) -> Any:
    """Return the content of a head's JSON; tools' cylinders on moves of a program are packed into bytes.

    Raises InputError for broken JSON.
    """
    return parse_json(text, pack_swept_piece)


def refuse_unknown_types(arrangement: NDArray[np.integer[Any]], toolkit: Toolkit, path: Path) -> None:
    """Raise InputError if an index in ``arrangement`` (N,) does not
    stand for a fixture type of the toolkit.
    """
    names = [one.title for one in toolkit.arrangements]
    if arrangement.min(initial=0) < 0 or arrangement.max(initial=0) >= len(names):
        number = int(np.argmax((arrangement < 0) | (arrangement >= len(names)))) + 1
        raise InputError(f"{path}: fixture {number} cannot be used: its type is not {' or '.join(names)}.")


def refuse_rows(faulty: NDArray[np.bool_], reason: str, path: Path, places: Sequence[int]) -> None:
    """Raise InputError if a fixture is faulty, naming the
    first; ``reason`` follows its number in the message.

    Parameters
    ----------
    faulty : (N,) by fixtures, or (N, P) by their pegs.
    places : index of each fixture in the file, from 0.
    """
    if faulty.any():
        first = int(np.argwhere(faulty)[0, 0])
        raise InputError(f"{path}: fixture {places[first] + 1} {reason}.")


def refuse_faulty(table: FixtureTable, query: Query, path: Path, places: Sequence[int]) -> None:
    """Raise InputError for fixtures that contradict the toolkit, the workpiece or themselves. The caller must
    have checked their types.

    ``places`` are the indices of the fixtures in the file, from 0.
    """
    if len(table) == 0:
        return
    toolkit, refuse = query.toolkit, partial(refuse_rows, path=path, places=places)
    asked = [number for number, one in enumerate(toolkit.arrangements) if one.name in query.types]
    refuse(~np.isin(table.arrangement, asked), "is of a type that was not asked for")
    jaw = toolkit.find_peg_carriers(table.arrangement)
    for number, carrier in enumerate(toolkit.carriers):
        for what, places_on, most in (
            ("column", table.column, carrier.columns),
            ("row", table.row, carrier.rows),
        ):
            outside = (jaw == number) & (
                (places_on < 0) | (places_on >= (LARGEST_NUMBER if most is None else most))
            )
            refuse(outside, f"has a peg in a {what} beyond the {most} of the {carrier.title}")
    faces = [face.number for face in query.workpiece.numbered.faces]
    refuse(~np.isin(table.face, faces), "has a peg on a segment that does not name a face of the workpiece")
    for values in (table.theta, table.position, table.jaw_separation, table.force):
        refuse(~(np.abs(values.reshape(len(table), -1)) <= LARGEST_LENGTH), NOT_FINITE)
    refuse(np.isinf(table.quality), NOT_FINITE)
    # Of two clamps either may lift a locator; both together press all.
    refuse(table.null_vector <= 0, "has a peg whose force is not positive")
    refuse((table.pairs < 1) | (table.pairs > LARGEST_NUMBER), "stands for no pair of clamps")


def check_head(data: Any, path: Path) -> Head:
    """Return a head from its JSON object; raise InputError, naming the first key that is missing or wrong."""
    try:
        return Head.model_validate(data)
    except ValidationError as error:
        key, reason = describe_first_fault(error)
        if reason == MISSING:
            raise InputError(f"{path} is not a complete result file: the key {key} is missing.") from error
        raise InputError(f"{path}: {key or 'the head'} cannot be used: {reason}.") from error


def check_query(head: Head, path: Path) -> Query:
    """Return the query of a head.

    Raises InputError for an impossible query, and if a count of fixtures is not given for exactly the types
    of the toolkit.
    """
    try:
        query = head.to_query()
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    names = query.toolkit.types
    for key, counts in (("counts", head.counts), ("found", head.found), ("distinct", head.distinct)):
        if counts is not None and set(counts) != set(names):
            raise InputError(
                f"{path}: {key} does not give a number for each of the types {', '.join(names)} and no other."
            )
    return query


def make_result_from_counts(table: FixtureTable, head: Head, query: Query, path: Path) -> Result:
    """Return the result of a head and a table; raise InputError if the head's counts differ from those of the
    table.
    """
    for name, listed in query.toolkit.count_arrangements(table.arrangement).items():
        if head.counts[name] != listed:
            said = head.counts[name]
            raise InputError(f"{path}: counts say {said} fixtures of type {name}, but {listed} are listed.")
    return make_result(table, head, query, path)


def make_result(table: FixtureTable, head: Head, query: Query, path: Path) -> Result:
    """Return the result of a head and a table; raise InputError if the notes or the account of the search are
    impossible.
    """
    try:
        notes = read_notes(head, query)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return Result(
        query,
        table,
        found=head.found or head.counts,
        distinct=head.distinct or head.counts,
        complete=head.complete,
        notes=notes,
        statistics=head.statistics,
        proof=None if head.proof is None else check_proof(head.proof, query, path),
        pairs=head.pairs,
        seats=head.seats,
        least_effective_error=head.least_effective_error,
    )


def check_proof(part: ProofPart, query: Query, path: Path) -> ProofReport:
    """Return the account of the search.

    Raises InputError for counts that do not add up, and for an undecided candidate of an unknown type, with a
    wrong number of pegs, or on a segment that is not a face.
    """
    accounted = part.discarded_by_bound + part.verified + len(part.undecided)
    if accounted != part.candidates:
        raise InputError(
            f"{path}: the proof says {part.candidates} candidates, but {accounted} are discarded, verified "
            "or undecided."
        )
    faces = {face.number for face in query.workpiece.numbered.faces}
    # With two clamps also contacts of one of them may be undecided.
    toolkits = (query.toolkit, *query.toolkit.ways)
    types = list(dict.fromkeys(one.title for toolkit in toolkits for one in toolkit.arrangements))
    for number, item in enumerate(part.undecided, 1):
        if item.type not in types:
            raise InputError(
                f"{path}: undecided candidate {number} of the proof is not of type {' or '.join(types)}."
            )
        pegs = (4, query.toolkit.peg_count)
        for key in ("columns", "rows", "segments"):
            if len(getattr(item, key)) not in pegs:
                raise InputError(
                    f"{path}: proof.undecided.{number - 1}.{key} cannot be used: it needs one for each peg."
                )
        if not faces.issuperset(item.segments):
            raise InputError(
                f"{path}: undecided candidate {number} of the proof names a segment that is not a face."
            )
    return part.to_proof()


Taken = TypeVar("Taken")
Take = Callable[[Iterable[Any], Path], Taken]


class OtherLayoutError(Exception):
    """Raised when a file does not have one fixture on every line."""


def read_parts(path: Path, take: Take[Taken]) -> tuple[Head, Taken]:
    """Return (1) the head of a result file of any layout and (2) the result of ``take(fixtures, path)``.

    Parameters
    ----------
    take : gets the fixtures as an iterable of JSON objects; it may be called a second time from the start.

    Raises
    ------
    InputError
        When the file cannot be read, or is not a result file, and what ``take`` raises.
    """
    with explain_reading_errors(path):
        try:
            data, taken = read_lines(path, lambda texts, path: take(map(parse_fixture_text, texts), path))
        except OtherLayoutError:
            data, taken = read_whole(path, take)
    return check_head(data, path), taken


@contextmanager
def explain_reading_errors(path: Path) -> Iterator[None]:
    """Turn errors of reading a file as text that are raised in the block
    into an InputError that names the file.
    """
    try:
        if path.exists() and not path.is_file():
            raise InputError(f"{path} is not a file: give a result file.")
        yield
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}.") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is not a result file: it is not text.") from error
    except RecursionError as error:
        raise InputError(f"{path} is not a result file: its brackets are nested too deeply.") from error


def read_lines(path: Path, take: Take[Taken]) -> tuple[Any, Taken]:
    """Return (1) the head's JSON object of a file with one fixture per line
    and (2) the result of ``take(texts, path)``.

    ``take`` gets the fixtures as an iterable of bytes, which it must exhaust. Raises OtherLayoutError when
    the lines are not of that form, and InputError when a line, or the head, is too long.
    """
    with path.open("rb") as stream:
        before = stream.read(start_of_fixtures(stream))
        after: list[bytes] = []
        taken = take(split_fixture_texts(stream, after, path), path)
        rest = stream.read(MOST_AROUND - len(before) + 1)
        if len(before) + len(rest) > MOST_AROUND:
            raise InputError(
                f"{path}: what stands around the fixtures has more than the {MOST_AROUND / 1e6:g} MB that a "
                f"result file may have there: {LIMITS['result'].remedy}."
            )
        text = b"".join((before.removeprefix(BOM_UTF8), *after, rest)).decode()
        del before, rest
        try:
            data = parse_head(text)
        except ValueError as error:
            raise OtherLayoutError from error
    return data, taken


def start_of_fixtures(stream: BinaryIO) -> int:
    """Return the byte offset of the first fixture; the stream is at its start before and after.

    The file is searched in pieces that are not kept, because a file of any size may have no fixtures. Raises
    OtherLayoutError where there is no line that begins the fixtures.
    """
    at, kept = 0, b"\n"
    while at <= MOST_AROUND and (read := stream.read(CHUNK)):
        # Of the piece before, as much as such a line may have is looked at again.
        text = kept + read
        for found in FIRST_LINE.finditer(text):
            if not text[text.rfind(b"\n", 0, found.start()) + 1 : found.start()].strip():
                stream.seek(0)
                return at + found.end() - len(kept)
        at, kept = at + len(read), text[-LONGEST_FIRST_LINE:]
    raise OtherLayoutError


def split_fixture_texts(stream: BinaryIO, after: list[bytes], path: Path) -> Iterator[bytes]:
    """Yield the JSON text of each fixture from the stream;
    the line that ends the list is appended to ``after``.

    Raises OtherLayoutError where a line is not one fixture, and InputError for one that is too long.
    """
    last = False
    for number in count(1):
        line = stream.readline(MOST_LINE + 1)
        if len(line) > MOST_LINE:
            raise InputError(
                f"{path}: fixture {number} takes more than the {MOST_LINE / 1e6:g} MB that the line of a "
                f"fixture may have: {LIMITS['result'].remedy}."
            )
        text = line.strip()
        if text[:1] == b"]":
            after.append(line)
            return
        if last or not line:
            raise OtherLayoutError
        last = text[-1:] != b","
        yield text if last else text[:-1]


def parse_fixture_text(text: bytes) -> Any:
    """Return the JSON value in a fixture's line; raise OtherLayoutError if the line is not exactly one JSON
    value.
    """
    try:
        return parse_json(text.decode())
    except UnicodeDecodeError:
        raise
    except ValueError as error:
        raise OtherLayoutError from error


def read_whole(path: Path, take: Take[Taken]) -> tuple[Any, Taken]:
    """Read a file of any layout as a whole, and return (1) the head's JSON object and (2) the result of
    ``take(fixtures, path)``.
    """
    try:
        text = read_limited(path, LIMITS["result"]).decode("utf-8-sig")
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    if not text.strip():
        raise InputError(f"{path} is empty: it is not a result file.")
    try:
        data = parse_head(text)
    except InputError as error:
        raise InputError(f"{path} is not a result file: {error}") from error
    if not isinstance(data, dict) or not isinstance(data.get("fixtures"), list):
        raise InputError(f"{path} is not a result file: it has no list of fixtures.")
    return data, take(data["fixtures"], path)
