"""Records: what came of a task, as the bytes that are kept.

The record of an answer is a result file (``files.result.writer``) of the best fixtures, which every command that takes one
can open. That of a drawing holds the part in the form that ``files.part.json`` reads, and what there is to tell about it.
What cannot be read or asked is a record too: it would be refused again.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from workhold.files.result.writer import workpiece_entry
from workhold.model.workpiece import Workpiece

__all__ = ["PART_NAME", "is_whole", "part_record", "plain_record", "refusal_record", "workpiece_of"]

PART, REFUSAL = "workhold-part/1", "workhold-refusal/1"
# In records a part has this name, so that files of one content, whatever they are called, are one part.
PART_NAME = "part"
FIRST, LAST = b'{"format": "workhold-', b"]}\n"


def part_record(workpiece: Workpiece, remarks: Sequence[str]) -> bytes:
    """The record of a drawing that was read."""
    about = {"format": PART, **workpiece_entry(workpiece), "name": PART_NAME}
    x0, y0, x1, y1 = workpiece.bounds
    return ended(about | {"faces": len(workpiece.faces), "size": [x1 - x0, y1 - y0], "remarks": list(remarks)})


def refusal_record(sentence: str) -> bytes:
    """The record of what cannot be read or asked, with the reason."""
    return ended({"format": REFUSAL, "refusal": [sentence]})


def ended(content: dict[str, Any]) -> bytes:
    """A record whose last entry is a list, so that it ends as every record does."""
    return json.dumps(content).encode() + b"\n"


def is_whole(content: bytes) -> bool:
    """Whether bytes begin and end as a record does: a file that lost its end with the power is none.

    >>> is_whole(refusal_record("no")), is_whole(refusal_record("no")[:-1]), is_whole(b"")
    (True, False, False)
    """
    return content.startswith(FIRST) and content.endswith(LAST)


def plain_record(content: bytes) -> dict[str, Any]:
    """A record as plain data; the sentence of a refusal is under ``refusal``, of all others that is empty."""
    data: dict[str, Any] = json.loads(content)
    data["refusal"] = data["refusal"][0] if data["format"] == REFUSAL else ""
    return data


def workpiece_of(record: dict[str, Any]) -> Workpiece:
    """The part of a drawing's record."""
    return Workpiece.from_loops(PART_NAME, record["loops"], None, record["departure"])
