"""Names of tasks: hashes of all that an outcome depends on, so that the same work has the same name wherever it is done."""

from __future__ import annotations

import json
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from workhold.version import __version__

__all__ = ["name_of", "program"]

PACKAGE = Path(__file__).resolve().parents[1]
# What only shows or checks outcomes, or brings the work to where it is done.
WITHOUT_SAY = ("cli", "drawing", "verification", "web")
# Letters of a name: 128 bits, so that no two of any number of tasks share one.
LETTERS = 32


@cache
def program() -> str:
    """The version of the program, and a hash of its sources that have a say in an outcome: the same on every machine."""
    digest = sha256()
    for path in sorted(PACKAGE.rglob("*.py")):
        place = path.relative_to(PACKAGE)
        if place.parts[0] not in WITHOUT_SAY:
            digest.update(f"{place.as_posix()} ".encode() + sha256(path.read_bytes()).digest())
    return f"{__version__} {digest.hexdigest()[:LETTERS]}"


def name_of(*content: Any) -> str:
    """The name of a task of this program, from bytes and plain data.

    >>> name_of(b"part", {"best": 3}) == name_of(b"part", {"best": 3}), len(name_of())
    (True, 32)
    """
    digest = sha256(program().encode())
    for item in content:
        data = item if isinstance(item, bytes) else json.dumps(item, sort_keys=True).encode()
        # Its length in front, so that what belongs to one item cannot be taken for the next.
        digest.update(f"{len(data)}:".encode() + data)
    return digest.hexdigest()[:LETTERS]
