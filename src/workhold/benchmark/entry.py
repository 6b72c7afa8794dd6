"""Another program's list for a set: as little as says which fixtures are meant, in JSON or CSV.

In JSON an object with the ``set`` and its ``fixtures``; each has ``pegs`` with role and place, and the
``pose``. A file of the benchmark and a result file say all that too, and are read as well. In CSV each
fixture is a row: ``theta_deg,x,y`` of the pose, then ``peg1,peg1_x,peg1_y,peg2,...``; the set is the file's
name.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from math import isfinite
from pathlib import Path
from typing import Any

from attrs import frozen

from workhold.errors import InputError
from workhold.files.text import read_text

__all__ = ["Entered", "EnteredPeg", "Entry", "entered_fixture", "read_entry"]

# Bytes; the largest complete list takes twenty million.
LARGEST_ENTRY = 200_000_000
# The direction in which a peg of a role pushes as jaws close; a clamp is named with its own.
PUSHES: Mapping[str, tuple[float, float]] = {
    "left": (1.0, 0.0),
    "right": (-1.0, 0.0),
    "jaw": (0.0, -1.0),
    "locator": (0.0, 0.0),
    "clamp -x": (-1.0, 0.0),
    "clamp +x": (1.0, 0.0),
    "clamp -y": (0.0, -1.0),
    "clamp +y": (0.0, 1.0),
}


@frozen
class EnteredPeg:
    """A peg of another program: its role, and the place of its centre in the toolkit's frame in mm."""

    role: str
    x: float
    y: float

    @property
    def push(self) -> tuple[float, float]:
        """The direction in which it pushes."""
        return PUSHES[self.role]


@frozen
class Entered:
    """A fixture of another program: its pegs and the pose of the part, in degrees and mm."""

    pegs: tuple[EnteredPeg, ...]
    theta_deg: float
    x: float
    y: float


@frozen
class Entry:
    """Another program's list for a set."""

    set_name: str
    fixtures: tuple[Entered, ...]


def read_entry(path: Path, set_name: str | None = None) -> Entry:
    """Reads another program's list.

    Parameters
    ----------
    set_name : the set it is for, where the file does not say.

    Raises
    ------
    InputError
        For a file that cannot be read, naming the fixture and what is wrong with it.
    """
    try:
        text = read_text(path, LARGEST_ENTRY, "a list of fixtures")
        if path.suffix.lower() == ".csv":
            return Entry(set_name or path.stem, rows_of(text))
        return entry_of(text, set_name or path.stem)
    except InputError as error:
        raise InputError(f"{path.name}: {error}") from error


def entry_of(text: str, usual: str) -> Entry:
    """The list of a text in JSON; ``usual`` is the set it is for where it does not say."""
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"this is no JSON ({error}): see docs/benchmark.md for the form.") from error
    if not isinstance(content, dict) or not isinstance(content.get("fixtures"), list):
        raise InputError("there is no list of fixtures in it: give an object with the key fixtures.")
    name = content.get("set", usual)
    if not isinstance(name, str):
        raise InputError("the set is no name: give it as a text.")
    return Entry(name, tuple(numbered(n, one) for n, one in enumerate(content["fixtures"], 1)))


def numbered(number: int, fixture: Any) -> Entered:
    """A fixture of a list, whose number stands in the complaint."""
    try:
        return entered_fixture(fixture)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        words = f"{error} is missing" if isinstance(error, KeyError) else str(error)
        raise InputError(f"fixture {number}: {words}; give pegs with role, x and y, and the pose.") from error


def entered_fixture(fixture: Mapping[str, Any]) -> Entered:
    """A fixture of an object of JSON.

    Raises
    ------
    KeyError, TypeError, ValueError
        Where it has not the form.
    """
    pose = fixture["pose"]
    pegs = tuple(
        EnteredPeg(role_of(peg, fixture.get("direction")), finite(peg["x"]), finite(peg["y"]))
        for peg in fixture["pegs"]
    )
    if not pegs:
        raise ValueError("it has no pegs")
    return Entered(pegs, finite(pose["theta_deg"]), finite(pose["x"]), finite(pose["y"]))


def role_of(peg: Mapping[str, Any], direction: str | None) -> str:
    """The role of a peg; of a clamp with the direction, which the peg says or the whole fixture."""
    role = peg["jaw"] if "jaw" in peg else peg["role"]
    role = f"clamp {peg.get('direction', direction)}" if role == "clamp" else role
    if role not in PUSHES:
        raise ValueError(f"the role {str(role)[:40]!r} is not known, but {', '.join(PUSHES)} are")
    return str(role)


def finite(value: Any) -> float:
    """A finite number."""
    if isinstance(value, bool) or not isfinite(float(value)):
        raise ValueError(f"{value!r} is no number")
    return float(value)


def rows_of(text: str) -> tuple[Entered, ...]:
    """The fixtures of a text in CSV."""
    rows = csv.DictReader(text.splitlines())
    names = rows.fieldnames or []
    count = sum(name.startswith("peg") and name[3:].isdigit() for name in names)
    if not {"theta_deg", "x", "y"} <= set(names) or count == 0:
        raise InputError("the columns are not theta_deg, x, y, peg1, peg1_x, peg1_y and so on: name them so.")
    return tuple(numbered(n, as_object(row, count)) for n, row in enumerate(rows, 1))


def as_object(row: Mapping[str, Any], count: int) -> dict[str, Any]:
    """A row of CSV as an object of JSON."""
    pegs = [
        {"role": row[f"peg{k}"], "x": row[f"peg{k}_x"], "y": row[f"peg{k}_y"]} for k in range(1, count + 1)
    ]
    return {"pegs": pegs, "pose": {key: row[key] for key in ("theta_deg", "x", "y")}}
