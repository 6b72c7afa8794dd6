"""The head of a result file: what it says of the columns, and its program, written and read piece by piece.

A long program is never all objects at once.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from itertools import islice
from typing import Any

from workhold.archive import Column, Columns
from workhold.errors import InputError
from workhold.files.text import json_value
from workhold.fixels.fields import CLAMPS
from workhold.model.moves import PIECE_KEYS, packed_piece
from workhold.model.program import Program
from workhold.model.quality import FIGURES

__all__ = [
    "COLUMNS",
    "COLUMNS_OF",
    "HEAD",
    "PAIR_COLUMNS",
    "columns_of",
    "columns_said",
    "head_texts",
    "head_value",
    "piece_or_entries",
    "program_text",
]

HEAD = "result.json"
# What each column holds, N fixtures: see docs/columns.md and ``model.result.FixtureTable``.
COLUMNS = {
    "arrangement": Column("|i1"),
    "column": Column("<i4", (4,)),
    "row": Column("<i4", (4,)),
    "face": Column("<i4", (4,)),
    "theta": Column("<f8"),
    "position": Column("<f8", (2,)),
    "jaw_separation": Column("<f8"),
    "force": Column("<f8", (4,)),
    "quality": Column("<f8", (len(FIGURES),)),
}
# What each column holds of fixtures with two clamps.
PAIR_COLUMNS = COLUMNS | {
    "column": Column("<i4", (5,)),
    "row": Column("<i4", (5,)),
    "face": Column("<i4", (5,)),
    "jaw_separation": Column("<f8", (2,)),
    "force": Column("<f8", (5, 2)),
    "pairs": Column("<i4"),
}
# By how many things move in a fixture.
COLUMNS_OF = {1: COLUMNS, 2: PAIR_COLUMNS}
# Pieces of which the text is made at a time.
AT_ONCE = 2000


def columns_of(travels: int, has_program: bool) -> Columns:
    """What the columns hold, by how many things move in a fixture; with a program its clearance, too."""
    columns = COLUMNS_OF[travels]
    return columns | {"quality": Column("<f8", (len(FIGURES) + 1,))} if has_program else columns


def without_piece(entries: dict[str, Any]) -> dict[str, Any] | None:
    """Entries as they are, but for those of a swept piece, which are many."""
    return None if entries.keys() == PIECE_KEYS else entries


def columns_said(head: str) -> Columns:
    """What the columns hold beside a head, which may be of any kind of file."""
    try:
        said = json.loads(head, object_hook=without_piece)
        toolkit = said.get("toolkit")
        travels = 2 if toolkit is not None and toolkit.get(CLAMPS.name) == 2 else 1
        return columns_of(travels, said.get("program") is not None)
    except (ValueError, AttributeError, RecursionError):
        return COLUMNS


def program_text(program: Program) -> Iterator[str]:
    """The JSON of a program as ``Program.to_dict`` has it, in parts."""
    start = json.dumps(program.head())
    yield f'{start[:-1]}, "pieces": ['
    separator, pieces = "", program.iter_entries()
    while some := [json.dumps(piece) for piece in islice(pieces, AT_ONCE)]:
        yield separator + ", ".join(some)
        separator = ", "
    yield "]}"


def head_texts(head: dict[str, Any], program: Program | None) -> Iterator[str]:
    """The JSON of a head in one line, in parts, with all that a program sweeps."""
    separator = "{"
    for key, value in head.items():
        yield f"{separator}{json.dumps(key)}: "
        if key == "program" and program is not None:
            yield from program_text(program)
        else:
            yield json.dumps(value, ensure_ascii=False)
        separator = ", "
    yield "}"


def piece_or_entries(entries: dict[str, Any]) -> Any:
    """A swept piece packed, where entries are those of one; all others as they are."""
    if entries.keys() != PIECE_KEYS:
        return entries
    try:
        return packed_piece(entries)
    except (InputError, LookupError, TypeError, ValueError, struct.error):
        # Whoever makes the program says what is wrong.
        return entries


def head_value(text: str) -> Any:
    """The content of a head's JSON, its swept pieces packed.

    Raises
    ------
    InputError
        As :func:`workhold.files.text.json_value`.
    """
    return json_value(text, piece_or_entries)
