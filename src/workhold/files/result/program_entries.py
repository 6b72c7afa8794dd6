"""The program of a result file, written and read piece by piece: a long one is never all objects at once."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from itertools import islice
from typing import Any

from workhold.errors import InputError
from workhold.files.text import json_value
from workhold.model.program import Program
from workhold.model.swept_piece import PIECE_KEYS, packed_piece

__all__ = ["head_texts", "head_value", "piece_or_entries", "program_text"]

# Pieces of which the text is made at a time.
AT_ONCE = 2000


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
