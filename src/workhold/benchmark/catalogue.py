"""The sets of the benchmark, read from the manifest that comes with the program.

The manifest names every workpiece with family, reason, source, licence and checksum, and every set with its
toolkit, the counts of its complete list and the checksums of it. Lists themselves are not shipped: a search
makes them, and the checksums say whether they are the ones meant.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from functools import cache
from hashlib import sha256
from importlib.resources import files
from typing import Any

from attrs import frozen

from workhold.errors import InputError
from workhold.fixels.kinds import toolkit_of
from workhold.model.query import Query
from workhold.model.workpiece import Workpiece

__all__ = ["SetEntry", "data_bytes", "data_names", "manifest", "parts_of", "query_of", "set_named", "sets"]

HOME = "benchmark"
MANIFEST = "manifest.json"


@frozen
class SetEntry:
    """What the manifest says of a set.

    Parameters
    ----------
    name : of the set, by which files and commands name it.
    part : name of the workpiece.
    toolkit : its kind and the fields that differ from what is usual, as :func:`toolkit_of` takes them.
    listing : of two clamps, "all"; None for other toolkits.
    reason : why it is in the benchmark.
    counts : how many fixtures of each type the complete list has.
    sums : checksums, see ``benchmark.form.sums_of``.
    """

    name: str
    part: str
    toolkit: Mapping[str, Any]
    listing: str | None
    reason: str
    counts: Mapping[str, int]
    sums: Mapping[str, str]

    @property
    def size(self) -> int:
        """How many fixtures the complete list has."""
        return sum(self.counts.values())


def data_bytes(name: str) -> bytes:
    """The content of a file of the benchmark, such as ``check.py`` or ``parts/kite.json``."""
    return (files("workhold") / "data" / HOME).joinpath(*name.split("/")).read_bytes()


def data_names() -> tuple[str, ...]:
    """The names of the files that belong to every copy of the benchmark, beside the workpieces."""
    return (MANIFEST, "check.py", "set.schema.json", "entry.schema.json")


@cache
def manifest() -> Mapping[str, Any]:
    """The manifest as it is written."""
    content: dict[str, Any] = json.loads(data_bytes(MANIFEST))
    return content


@cache
def sets() -> tuple[SetEntry, ...]:
    """All sets, in the order of the manifest."""
    return tuple(
        SetEntry(
            name=one["name"],
            part=one["workpiece"],
            toolkit=one["toolkit"],
            listing=one["listing"],
            reason=one["reason"],
            counts=one["counts"],
            sums=one["sums"],
        )
        for one in manifest()["sets"]
    )


def parts_of(chosen: Sequence[SetEntry]) -> tuple[str, ...]:
    """The names of the workpieces of some sets, each once."""
    return tuple(dict.fromkeys(one.part for one in chosen))


def set_named(name: str) -> SetEntry:
    """The set of a name.

    Raises
    ------
    InputError
        For a name that no set has, with those that are close.
    """
    by_name = {one.name: one for one in sets()}
    if name in by_name:
        return by_name[name]
    close = get_close_matches(name, by_name, n=3, cutoff=0.4)
    remedy = f"did you mean {' or '.join(close)}?" if close else "workhold benchmark list names them all."
    raise InputError(f"no set of the benchmark has the name {name[:80]!r}: {remedy}")


def workpiece_of(part: str) -> Workpiece:
    """A workpiece of the benchmark.

    Raises
    ------
    InputError
        When its file is not the one that the manifest knows.
    """
    content = data_bytes(f"parts/{part}.json")
    if sha256(content).hexdigest() != manifest()["workpieces"][part]["sha256"]:
        raise InputError(f"the benchmark's workpiece {part} has been changed: install workhold anew.")
    entries = json.loads(content)
    return Workpiece.from_loops(entries["name"], entries["loops"])


def query_of(entry: SetEntry) -> Query:
    """What is asked to make the list of a set.

    Raises
    ------
    InputError
        When the workpiece's file is not the one that the manifest knows.
    """
    given = dict(entry.toolkit)
    toolkit = toolkit_of(given.pop("kind"), given)
    return Query(workpiece_of(entry.part), toolkit, listing=entry.listing)
