"""The types and widths of a result file's columns, and the name of its head among them."""

from __future__ import annotations

import json
from typing import Any

from workhold.archive import Column, Columns
from workhold.fixels.fields import CLAMPS
from workhold.model.quality import FIGURES
from workhold.model.swept_piece import PIECE_KEYS

__all__ = ["COLUMNS", "COLUMNS_OF", "HEAD", "PAIR_COLUMNS", "columns_of", "columns_said"]

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
