"""Fixtures of a result file, read from their JSON objects number for number.

All functions below ``make_fixtures`` raise an ``UnusableError`` that says which entry is missing or of a
wrong kind.

Glossary
--------
role : kind of peg: a "locator" in a hole of a plate, a "clamp" bolted to it, a "jaw" peg; pegs without a role
    name their jaw.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import inf, isfinite
from pathlib import Path
from typing import Any

from attrs import evolve

from workhold.errors import InputError
from workhold.fixels.carrier import WALL
from workhold.model.fixture import ClampPair, Fixture, Peg
from workhold.model.pose import Pose
from workhold.model.quality import FIGURES, PROGRAM_FIGURE
from workhold.verification.rules.travel import WAYS, name_clamp_place

__all__ = ["read_fixtures", "add_working_forces"]

# What locators stand on.
PLATE = "plate"
NUMBERS = {3: "three", 5: "five"}


class UnusableError(Exception):
    """A value of the wrong kind; its message is appended to the place in the file."""

    @classmethod
    def from_entry(cls, item: Mapping[str, Any], key: str, kind: str) -> UnusableError:
        """Return the error for a key of a JSON object that is missing, or not of the wanted ``kind``."""
        return cls(f"{key} is {item[key]!r}, not {kind}" if key in item else f"the key {key} is missing")


def read_fixtures(items: Iterable[Any], path: Path) -> list[Fixture]:
    """Return the fixtures from their JSON objects.

    Raises
    ------
    InputError
        At the first one that cannot be used; its message counts from 1.
    """
    fixtures = []
    for number, item in enumerate(items, 1):
        try:
            fixtures.append(read_fixture(item))
        except UnusableError as error:
            raise InputError(f"{path} cannot be verified: number {number} in fixtures: {error}.") from error
    return fixtures


def read_fixture(item: Any) -> Fixture:
    """Return a fixture from its JSON object, its seating still as fields."""
    if not isinstance(item, dict):
        raise UnusableError("it is not a fixture")
    is_pair, has_wall = "directions" in item, "wall" in item
    directions = read_directions(item)
    on_wall = read_wall_pegs(item["wall"], is_pair) if has_wall else ()
    count = (5 if is_pair else 4) - 2 * has_wall
    pegs = item.get("pegs")
    if not isinstance(pegs, list) or len(pegs) != count or not all(isinstance(peg, dict) for peg in pegs):
        raise UnusableError(f"it does not have {NUMBERS[count] if is_pair else 'four'} pegs")
    forces = [read_two_numbers(peg, "force") for peg in pegs] if is_pair else []
    if is_pair and has_wall:
        forces[1:1] = read_wall_reactions(item["wall"])
    taken = [read_peg({**peg, "force": 0.0} if is_pair else peg, directions) for peg in pegs]
    # The ends on a wall stand behind what stands still in holes.
    first = sum(peg.get("role") != "jaw" for peg in pegs[:1])
    fixture = Fixture(
        read_word(item, "type"),
        (*taken[:first], *on_wall, *taken[first:]),
        read_pose(item),
        # How far a clamp has travelled follows from its place.
        0.0 if directions else read_real(item, "jaw_separation"),
        read_quality(item),
        " ".join(directions) or None,
        passing=item.get(PROGRAM_FIGURE.key),
        asking=item.get("program_forces"),
    )
    if is_pair:
        low, high = read_two_numbers(item, "ratio", least=1)
        pair = ClampPair((0.0, 0.0), (low, high), tuple(forces), read_whole_number(item, "pairs"))
        fixture = add_working_forces(fixture, pair)
    fixture = add_flat_directions(fixture, item["flats"]) if "flats" in item else fixture
    # What its fields say is looked at where the query is known.
    fixture = evolve(fixture, seating=item["seating"]) if "seating" in item else fixture
    return evolve(fixture, bent=item["bending"]) if item.get("bending") is not None else fixture


def add_flat_directions(fixture: Fixture, flats: Any) -> Fixture:
    """Return a fixture with the directions of its pegs' flats added.

    ``flats`` holds one direction in degrees per peg in a hole, None for a peg without a flat.
    """
    standing = [place for place, peg in enumerate(fixture.pegs) if not peg.is_on_wall]
    if not isinstance(flats, list) or len(flats) != len(standing):
        raise UnusableError("flats is not one number or null for each peg")
    pegs = list(fixture.pegs)
    for place, angle in zip(standing, flats, strict=True):
        looks = None if angle is None else read_real({"number in flats": angle}, "number in flats")
        pegs[place] = evolve(pegs[place], flat_deg=looks)
    return evolve(fixture, pegs=tuple(pegs))


def add_working_forces(fixture: Fixture, pair: ClampPair) -> Fixture:
    """Return a fixture with its pair of clamps and its peg forces added.

    The forces are those at the working ratio of the clamps' forces, per unit of the sum of both.
    """
    ratio = pair.working_ratio
    forces = [(one + ratio * other) / (1 + ratio) for one, other in pair.reactions]
    pegs = tuple(evolve(p, force=f) for p, f in zip(fixture.pegs, forces, strict=True))
    return evolve(fixture, pegs=pegs, pair=pair)


def read_directions(item: Mapping[str, Any]) -> list[str]:
    """Return the clamp directions of a fixture ("+x" and the like): none, one or two."""
    if "directions" in item:
        directions: Any = item["directions"]
        is_two = isinstance(directions, list) and len(directions) == 2
        if not is_two or any(one not in list(WAYS) for one in directions):
            raise UnusableError(f"its directions are not two of {', '.join(WAYS)}")
        return list(directions)
    direction = None if item.get("direction") is None else read_word(item, "direction")
    if direction not in (None, *WAYS):
        raise UnusableError(f"its direction is not {' or '.join(WAYS)}")
    return [] if direction is None else [direction]


def read_pose(item: Mapping[str, Any]) -> Pose:
    """Return the pose of a fixture: degrees and mm."""
    pose = item.get("pose")
    if not isinstance(pose, dict):
        raise UnusableError("it has no pose")
    return Pose(read_real(pose, "theta_deg"), read_real(pose, "x"), read_real(pose, "y"))


def read_quality(item: Mapping[str, Any]) -> dict[str, float]:
    """Return those known figures of quality that the object has, by key."""
    quality = item.get("quality")
    if not isinstance(quality, dict):
        raise UnusableError("it has no quality")
    known = (*FIGURES, PROGRAM_FIGURE)
    return {figure.key: read_real(quality, figure.key) for figure in known if figure.key in quality}


def read_two_numbers(item: Mapping[str, Any], key: str, least: int = 2) -> tuple[float, float]:
    """Return the two numbers of a JSON list under ``key``; from index ``least`` on, null stands for inf.

    The default of ``least`` allows no null.
    """
    values = item.get(key)
    if not isinstance(values, list) or len(values) != 2:
        raise UnusableError.from_entry(item, key, "two numbers")
    one, other = (
        inf if place >= least and value is None else read_real({key: value}, key)
        for place, value in enumerate(values)
    )
    return one, other


def read_wall_reactions(wall: Mapping[str, Any]) -> list[tuple[float, float]]:
    """Return two pairs, one for each end of the contact with a wall: (force per unit of clamp 1, force per
    unit of clamp 2).
    """
    forces = wall.get("forces")
    if not isinstance(forces, list) or len(forces) != 2:
        raise UnusableError("the forces of its wall are not two pairs of numbers")
    return [read_two_numbers({"forces of its wall": pair}, "forces of its wall") for pair in forces]


def read_wall_pegs(item: Any, is_pair: bool) -> tuple[Peg, ...]:
    """Return the two ends of the contact with a wall as pegs.

    With two clamps (``is_pair``) their forces are 0, because they follow from the reactions.
    """
    if not isinstance(item, dict):
        raise UnusableError("its wall is not given by places, segments and forces")
    pairs = []
    for key in ("from", "to", "segments", "forces"):
        value = [0.0, 0.0] if key == "forces" and is_pair else item.get(key)
        if not isinstance(value, list) or len(value) != 2:
            raise UnusableError(f"the {key} of its wall is not two numbers")
        pairs.append({"first": value[0], "second": value[1]})
    *places, faces, shares = pairs
    ends = zip(places, ("first", "second"), strict=True)
    return tuple(
        Peg(
            WALL,
            0,
            0,
            read_real(at, "first"),
            read_real(at, "second"),
            read_whole_number(faces, k),
            read_real(shares, k),
        )
        for at, k in ends
    )


def read_peg(item: Mapping[str, Any], directions: list[str]) -> Peg:
    """Return a peg from its JSON object.

    ``directions`` are the fixture's clamp directions. There are none for jaws. With one direction it is that
    of the clamp; with two, the object of each clamp states its own.
    """
    if not directions:
        column, row, segment = (read_whole_number(item, key) for key in ("column", "row", "segment"))
        x, y, force = (read_real(item, key) for key in ("x", "y", "force"))
        jaw = "jaw" if item.get("role") == "jaw" else read_word(item, "jaw")
        return Peg(jaw, column, row, x, y, segment, force)
    direction = (
        read_word(item, "direction") if len(directions) > 1 and item.get("role") == "clamp" else directions[0]
    )
    if direction not in WAYS:
        raise UnusableError(f"the direction of a clamp is not {' or '.join(WAYS)}")
    role, line = read_word(item, "role"), "row" if direction.endswith("x") else "column"
    contact = (
        read_real(item, "x"),
        read_real(item, "y"),
        read_whole_number(item, "segment"),
        read_real(item, "force"),
    )
    if role == "locator":
        return Peg(PLATE, read_whole_number(item, "column"), read_whole_number(item, "row"), *contact)
    if role != "clamp":
        raise UnusableError("the role of a peg is neither locator nor clamp")
    if "hole" not in item:
        raise UnusableError("the key hole is missing")
    hole, place = item["hole"], {"column": 0, "row": 0}
    if hole is not None:
        if not isinstance(hole, list) or len(hole) != 2:
            raise UnusableError("the hole of its clamp is not a column and a row")
        numbers = {"column": hole[0], "row": hole[1]}
        place = {name: read_whole_number(numbers, name) for name in numbers}
    if hole is not None and place[line] != read_whole_number(item, line):
        raise UnusableError(f"the {line} of its clamp is not that of its hole")
    place[line] = read_whole_number(item, line)
    column, row = place["column"], place["row"]
    called = (
        name_clamp_place(PLATE, direction, column, row, hole is not None) if min(column, row) >= 0 else None
    )
    return Peg(f"clamp {direction}", column, row, *contact, called)


def read_word(item: Mapping[str, Any], key: str) -> str:
    """Return a string of a JSON object."""
    value = item.get(key)
    if not isinstance(value, str):
        raise UnusableError.from_entry(item, key, "a word")
    return value


def read_real(item: Mapping[str, Any], key: str) -> float:
    """Return a finite number of a JSON object, of at most 1e300 in size."""
    value: Any = item.get(key)
    if type(value) not in (int, float) or abs(value) > 1e300 or not isfinite(value):
        raise UnusableError.from_entry(item, key, "a number")
    return float(value)


def read_whole_number(item: Mapping[str, Any], key: str) -> int:
    """Return an integer of a JSON object, of at most 2^31 in size."""
    value = item.get(key)
    if type(value) is not int or abs(value) > 2**31:
        raise UnusableError.from_entry(item, key, "a whole number")
    return value
