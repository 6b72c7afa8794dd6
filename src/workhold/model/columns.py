"""What a result file in columns holds: its columns, and the name of its head."""

from __future__ import annotations

from workhold.archive import Column
from workhold.model.quality import FIGURES

__all__ = ["COLUMNS", "HEAD"]

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
