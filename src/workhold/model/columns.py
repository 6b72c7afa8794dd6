"""What a result file in columns holds: its columns, and the name of its head."""

from __future__ import annotations

import json

from workhold.archive import Column, Columns
from workhold.fixels.fields import CLAMPS
from workhold.model.quality import FIGURES

__all__ = ["COLUMNS", "COLUMNS_OF", "HEAD", "PAIR_COLUMNS", "columns_said"]

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


def columns_said(head: str) -> Columns:
    """What the columns hold beside a head, which may be of any kind of file."""
    try:
        toolkit = json.loads(head).get("toolkit")
        return PAIR_COLUMNS if toolkit is not None and toolkit.get(CLAMPS.name) == 2 else COLUMNS
    except (ValueError, AttributeError, RecursionError):
        return COLUMNS
