"""Another program's list for a set, and whether it has the same fixtures: by places of pegs on the part.

A list says no more than which fixtures are meant. In JSON it is an object with the ``set`` and its
``fixtures``; each has ``pegs`` with role and place, and the ``pose``. A file of the benchmark and a result
file say all that too, and are read as well. In CSV each fixture is a row: ``theta_deg,x,y`` of the pose, then
``peg1,peg1_x,peg1_y,peg2,...``; the set is the file's name.

A fixture is where its pegs touch the part, which way each is pushed, and how the lattice lies about it. All
of this is seen from the part. So names of pegs, whole steps of the lattice, and the half turn that swaps two
jaws make no difference. Rotations of the part onto itself are applied where they are asked for.

Glossary
--------
place : of a fixture, (P, 6): of each peg x and y on the part in mm, the direction it is pushed in, and the
    axis of the lattice. The direction is zero for a peg that stands still. Directions and axes have the
    length of half the part's extent.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from math import isfinite, nan
from pathlib import Path
from typing import Any

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.files.budget import LIMITS, Budget
from workhold.files.tables import SAVED, CsvRow, read_table
from workhold.files.text import parse_json, read_text
from workhold.geometry.symmetry import (
    compute_centroid_of_segments,
    find_rotations_onto_itself,
    rotate_vectors,
)
from workhold.limits import read_number, refuse_long
from workhold.model.workpiece import Workpiece

__all__ = [
    "Comparison",
    "SubmittedFixture",
    "SubmittedPeg",
    "Submission",
    "ListedPlaces",
    "compare_places",
    "read_entered_fixture",
    "read_entry",
]

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
Array = NDArray[np.float64]


@frozen
class SubmittedPeg:
    """A peg in another program's list: its role, and its centre in the toolkit's frame in mm."""

    role: str
    x: float
    y: float

    @property
    def push(self) -> tuple[float, float]:
        """The unit vector in which the peg pushes the part, in the toolkit's frame; (0,
        0) for a fixed peg.
        """
        return PUSHES[self.role]


@frozen
class SubmittedFixture:
    """A fixture of another program: its pegs and the pose of the part, in degrees and mm."""

    pegs: tuple[SubmittedPeg, ...]
    theta_deg: float
    x: float
    y: float


@frozen
class Submission:
    """Another program's list for a set."""

    set_name: str
    fixtures: tuple[SubmittedFixture, ...]


def read_entry(path: Path, set_name: str | None = None) -> Submission:
    """Return another program's list from a file in JSON or CSV.

    Parameters
    ----------
    set_name : name of the set that the list is for, where the file does not name it.

    Raises
    ------
    InputError
        For a file that cannot be read; the message names the fixture and the fault.
    """
    try:
        text = read_text(path, LIMITS["list"], SAVED if path.suffix.lower() == ".csv" else "save it as UTF-8")
        if path.suffix.lower() == ".csv":
            return Submission(set_name or path.stem, read_csv_rows(text))
        return parse_entry(text, set_name or path.stem)
    except InputError as error:
        raise InputError(f"{path.name}: {error}") from error


def parse_entry(text: str, usual: str) -> Submission:
    """Return the list in a JSON text.

    ``usual`` is the name of its set where the text does not give one.
    """
    try:
        content = parse_json(text)
    except InputError as error:
        raise InputError(f"this JSON does not have the form in docs/benchmark.md: {error}") from error
    if not isinstance(content, dict) or not isinstance(content.get("fixtures"), list):
        raise InputError("there is no list of fixtures in it: give an object with the key fixtures.")
    name = content.get("set", usual)
    if not isinstance(name, str):
        raise InputError("the set is not a name: give it as a text.")
    return Submission(
        name, tuple(read_numbered_fixture(n, one) for n, one in enumerate(content["fixtures"], 1))
    )


def read_numbered_fixture(number: int, fixture: Any) -> SubmittedFixture:
    """Return a fixture of a list from its JSON object.

    ``number`` names the fixture in the InputError that is raised for an object of a wrong form.
    """
    try:
        return read_entered_fixture(fixture)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        words = f"{error} is missing" if isinstance(error, KeyError) else str(error)
        raise InputError(f"fixture {number}: {words}; give pegs with role, x and y, and the pose.") from error


def read_entered_fixture(fixture: Mapping[str, Any]) -> SubmittedFixture:
    """Return a fixture from a JSON object.

    Raises KeyError, TypeError, AttributeError or ValueError where it does not have the form.
    """
    pose = fixture["pose"]
    pegs = tuple(
        SubmittedPeg(
            find_peg_role(peg, fixture.get("direction")), read_finite(peg["x"]), read_finite(peg["y"])
        )
        for peg in fixture["pegs"]
    )
    if not pegs:
        raise ValueError("it has no pegs")
    return SubmittedFixture(
        pegs, read_finite(pose["theta_deg"]), read_finite(pose["x"]), read_finite(pose["y"])
    )


def find_peg_role(peg: Mapping[str, Any], direction: str | None) -> str:
    """Return the role of a peg; for a clamp with its direction, such as "clamp -x".

    The direction is the peg's own, or if it has none ``direction``, the fixture's. Raises KeyError without a
    role, ValueError for an unknown one.
    """
    role = peg["jaw"] if "jaw" in peg else peg["role"]
    role = f"clamp {peg.get('direction', direction)}" if role == "clamp" else role
    if role not in PUSHES:
        raise ValueError(f"the role {str(role)[:40]!r} is not known, but {', '.join(PUSHES)} are")
    return str(role)


def read_finite(value: Any) -> float:
    """Return a number from JSON or CSV as a float; ValueError for anything that is not a finite number."""
    number = nan if isinstance(value, bool) else read_number(value)
    if not isfinite(number):
        raise ValueError(f"{str(value)[:40]!r} is not a number")
    refuse_long("the number", number)
    return number


def read_csv_rows(text: str) -> tuple[SubmittedFixture, ...]:
    """Return the fixtures of a CSV text, one from each row."""
    table = read_table(text, Budget(LIMITS["list"], len(text))) if text.strip() else None
    names = {*table.names} if table is not None else set[str]()
    pegs = sorted(
        (name for name in names if re.fullmatch(r"peg[1-9]\d?", name)), key=lambda name: int(name[3:])
    )
    if table is None or not {"theta_deg", "x", "y"} <= names or not pegs:
        raise InputError("the columns must be named theta_deg, x, y, peg1, peg1_x, peg1_y and so on.")
    for name in (f"{peg}_{axis}" for peg in pegs for axis in "xy"):
        if name not in names:
            raise InputError(f"the column {name} is missing: add a column of this name for each peg.")
    return tuple(
        read_numbered_fixture(row.row, convert_row_to_object(row, pegs)) for row in table.iterate_rows()
    )


def convert_row_to_object(row: CsvRow, pegs: Sequence[str]) -> dict[str, Any]:
    """Return a CSV row as the JSON object of a fixture.

    ``pegs`` are the names of the columns of pegs; pegs of which all cells are empty are left out.
    """
    given = [peg for peg in pegs if not row.cells.keys().isdisjoint((peg, f"{peg}_x", f"{peg}_y"))]
    return {
        "pegs": [
            {
                "role": row.cells.get(peg, ""),
                "x": row.read_number(f"{peg}_x"),
                "y": row.read_number(f"{peg}_y"),
            }
            for peg in given
        ],
        "pose": {key: row.read_number(key) for key in ("theta_deg", "x", "y")},
    }


@define(frozen=True, eq=False)
class ListedPlaces:
    """The fixtures of a list with their places on the part.

    Parameters
    ----------
    part : the workpiece.
    entered : the fixtures.
    places : the place (P, 6) of each, see the glossary.
    """

    part: Workpiece
    entered: Sequence[SubmittedFixture]
    places: list[Array] = field(init=False)

    @places.default
    def compute_all_places(self) -> list[Array]:
        """Return the place (P, 6) of each fixture, in the list's order."""
        points = np.concatenate([loop[:, :2] for loop in self.part.loops])
        scale = float(np.hypot(*np.ptp(points, axis=0)) / 2)
        return [compute_fixture_place(one, scale) for one in self.entered]

    def list_images(self, place: Array) -> list[Array]:
        """Return the images of a place (P, 6) under all rotations of the part onto itself, the place itself
        first.
        """
        every = self.part.numbered
        faces = [face.segment for face in every.faces]
        kept = compute_centroid_of_segments(faces)
        out = []
        for rotation in find_rotations_onto_itself(faces, every.marks):
            x, y = rotate_vectors(place[:, 0] - kept[0], place[:, 1] - kept[1], rotation.angle)
            pushed = rotate_vectors(place[:, 2], place[:, 3], rotation.angle)
            axis = rotate_vectors(place[:, 4], place[:, 5], 2 * rotation.angle)
            out.append(np.column_stack([x + kept[0], y + kept[1], *pushed, *axis]))
        return out


def compute_fixture_place(entered: SubmittedFixture, scale: float) -> Array:
    """Return the place (P, 6) of a fixture with P pegs, see the glossary.

    Vectors of directions and axes have the length ``scale`` in mm.
    """
    theta = np.radians(entered.theta_deg)
    rows = []
    for peg in entered.pegs:
        x, y = rotate_vectors(peg.x - entered.x, peg.y - entered.y, -theta)
        push = rotate_vectors(scale * peg.push[0], scale * peg.push[1], -theta)
        rows.append((x, y, *push, scale * np.cos(2 * theta), -scale * np.sin(2 * theta)))
    return np.array(rows, np.float64).reshape(-1, 6)


@frozen
class Comparison:
    """Another program's list compared with the complete list.

    Parameters
    ----------
    listed, theirs : numbers of fixtures in the complete list, and in the other list.
    found, missed : indices, from 0, of the fixtures of the complete list that the other list has, and has
        not.
    extra : indices, from 0, of the fixtures of the other list that are not in the complete list.
    repeated : indices, from 0, of the fixtures of the other list that occur earlier in it.
    """

    listed: int
    theirs: int
    found: tuple[int, ...]
    missed: tuple[int, ...]
    extra: tuple[int, ...]
    repeated: tuple[int, ...]

    @property
    def share(self) -> float:
        """The share of the complete list that is found; 1 where that list is empty."""
        return len(self.found) / self.listed if self.listed else 1.0


def compare_places(
    complete: ListedPlaces, theirs: ListedPlaces, tolerance: float, symmetric: bool
) -> Comparison:
    """Return how another program's list (``theirs``) compares with the complete one.

    ``tolerance`` is the largest difference in mm of pegs' coordinates, and of directions taken as vectors of
    half the part's extent. ``symmetric`` says whether a fixture also stands for its images under rotations of
    the part onto itself.
    """
    index = PlaceIndex.from_places(complete.places, tolerance)
    hits, met = set[int](), set[int]()
    extra, repeated = list[int](), list[int]()
    for number, place in enumerate(theirs.places):
        own = index.find_nearest(place)
        images = complete.list_images(place)[1:] if symmetric else []
        known = {one for one in (own, *map(index.find_nearest, images)) if one is not None}
        if not known:
            extra.append(number)
        elif own in met:
            repeated.append(number)
        hits |= known
        if own is not None:
            met.add(own)
    return Comparison(
        listed=len(complete.places),
        theirs=len(theirs.places),
        found=tuple(sorted(hits)),
        missed=tuple(number for number in range(len(complete.places)) if number not in hits),
        extra=tuple(extra),
        repeated=tuple(repeated),
    )


@frozen(eq=False)
class PlaceIndex:
    """N places, sorted by the sum of their pegs' x so that near ones are found fast.

    Parameters
    ----------
    places : in their given order.
    sums : (N, 2) sums of their pegs' x and y.
    order : (N,) indices sorted by the sum of x.
    tolerance : in mm.
    """

    places: Sequence[Array]
    sums: Array
    order: NDArray[np.intp]
    tolerance: float

    @classmethod
    def from_places(cls, places: Sequence[Array], tolerance: float) -> PlaceIndex:
        """Return the index of places, in their given order."""
        sums = np.array([place[:, :2].sum(axis=0) for place in places]).reshape(-1, 2)
        return cls(places, sums, np.argsort(sums[:, 0], kind="stable"), tolerance)

    def find_nearest(self, place: Array) -> int | None:
        """Return the index of the place nearest to ``place`` (P, 6); None where none is within the tolerance.

        Pegs are matched in any order. The distance of two places is the largest difference of any coordinate.
        """
        x, y = place[:, :2].sum(axis=0)
        room = self.tolerance * len(place)
        low, high = np.searchsorted(self.sums[self.order, 0], [x - room, x + room])
        best, found = self.tolerance, None
        for number in self.order[low:high].tolist():
            other = self.places[number]
            if abs(self.sums[number, 1] - y) > room or other.shape != place.shape:
                continue
            apart = np.abs(other[:, None] - place[None]).max(axis=-1)
            worst = float(max(apart.min(axis=0).max(), apart.min(axis=1).max()))
            if worst <= best:
                best, found = worst, number
        return found
