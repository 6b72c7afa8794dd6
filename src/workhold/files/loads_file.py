"""Loads from a file, and the words that describe a load there and on the command line.

A file is TOML, or JSON if its name ends in .json, with a table for each load. Without units, forces are in N,
and moments, positive counter-clockwise, in N mm. Other units are kN, lbf, N.m and lbf.in. Directions are in
degrees in the part's frame; a force without a direction may act in any::

unit = "mm" # of at and path: mm, cm, m or inch; if not given, the caller's unit

    [[load]]
    name = "side milling"
    path = [[0, 0], [40, 0]]    # or at = [10, 5]
    force = 200                 # or "0.2 kN"
    direction = [30, 60]        # or 30, or "any"
    moment = 5000               # or "5 N.m"

    [[load]]
    name = "end mill, helix pulls"
    force = [300, -200, 80]     # along x, y and z of the part, z up
    at = [20, 5]
    z = 12                      # above the part's lower side; its top if not given
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import atan2, degrees, hypot, isfinite
from pathlib import Path
from typing import Any

from workhold.errors import InputError
from workhold.files.budget import LIMITS
from workhold.files.text import parse_json, parse_toml, read_text
from workhold.model.requirements import ANY_DIRECTION, Load
from workhold.units import find_unit

__all__ = ["parse_load", "read_loads"]

KEYS = ("name", "force", "at", "path", "z", "direction", "moment")
# Exact: 0.45359237 kg (international pound, 1959) times 9.80665 m/s^2 (standard gravity, 1901).
POUND_FORCE = 4.4482216152605
FORCE_UNITS = {"": 1.0, "n": 1.0, "kn": 1000.0, "lbf": POUND_FORCE}
INCH_POUND = 25.4 * POUND_FORCE
MOMENT_UNITS = {
    "": 1.0,
    **dict.fromkeys(("n.mm", "nmm"), 1.0),
    **dict.fromkeys(("n.m", "nm"), 1000.0),
    **dict.fromkeys(("lbf.in", "in.lbf"), INCH_POUND),
    **dict.fromkeys(("lbf.ft", "ft.lbf"), 12 * INCH_POUND),
}
QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([a-zA-Z.*·]*)\s*", re.ASCII)


def read_loads(path: str | Path, unit_scale: float = 1.0) -> tuple[Load, ...]:
    """Return the loads of a file, in its order.

    Parameters
    ----------
    path : a TOML file, or JSON if its name ends in .json.
    unit_scale : millimetres in one unit of length, where the file does not name its unit.

    Raises
    ------
    InputError
        When the file cannot be read or holds no loads, naming the first load that cannot be used.
    """
    path = Path(path)
    content = parse_loads_file(path)
    for key in content:
        if key not in ("unit", "load"):
            raise InputError(
                f"{path} has an unknown key '{key}': give unit, and a table [[load]] for each load."
            )
    if "unit" in content:
        try:
            unit_scale = find_unit(str(content["unit"])).millimetres
        except InputError as error:
            raise InputError(f"{path}: {error}") from None
    tables = content.get("load")
    if not isinstance(tables, list) or not tables or not all(isinstance(table, dict) for table in tables):
        raise InputError(
            f"{path} has no loads: write a table [[load]] for each, with force and at, path or moment."
        )
    return tuple(parse_load(table, f"{path}: load {n}", unit_scale) for n, table in enumerate(tables, 1))


def parse_loads_file(path: Path) -> dict[str, Any]:
    """Return the content of a TOML or JSON file; raise InputError for one that cannot be read."""
    try:
        text = read_text(path, LIMITS["loads"])
        content = parse_json(text) if path.suffix.lower() == ".json" else parse_toml(text)
    except InputError as error:
        raise InputError(f"{path} is not a loads file: {error}") from error
    if not isinstance(content, dict):
        raise InputError(f"{path} is not a loads file: it must have a list of loads under the key load.")
    return content


def parse_load(words: Mapping[str, Any], place: str, unit_scale: float) -> Load:
    """Return a load from the values of its keys.

    Parameters
    ----------
    words : values of name, force, at, path, z, direction and moment, as text (as in ``--load``), numbers or
        lists.
    place : name of their source, for messages.
    unit_scale : millimetres in one unit of ``at``, ``path`` and ``z``.

    Raises
    ------
    InputError
        For a key or value that cannot be used.

    Examples
    --------
    >>> parse_load({"force": "200", "at": "10,5", "direction": "30..60"}, "here", 1.0).directions
    (30.0, 60.0)
    """
    for key in words:
        if key not in KEYS:
            raise InputError(
                f"{place} has an unknown key '{key}': give {', '.join(KEYS[:-1])} or {KEYS[-1]}."
            )
    if "at" in words and "path" in words:
        raise InputError(f"{place} has both at and path: a force acts at a point or along a path.")
    if "force" not in words:
        for key in ("at", "path", "z", "direction"):
            if key in words:
                raise InputError(f"{place} has {key} but no force: give its size in N, such as force=200.")
    points: list[tuple[float, float]] = []
    height = None
    if "z" in words:
        height = parse_plain_number(words["z"])
        if height is None:
            raise InputError(
                f"{place}: z {quote_shortened(words['z'])} is not a height: give a number, such as 12."
            )
    vector = read_force_components(words, place)
    if "at" in words:
        points = [read_point(words["at"], f"{place}: at")]
    elif "path" in words:
        points = read_path_points(words["path"], f"{place}: path")
    try:
        return Load(
            points=[(x * unit_scale, y * unit_scale) for x, y in points],
            force=hypot(vector[0], vector[1])
            if vector
            else read_quantity(
                words.get("force", 0), f"{place}: force", FORCE_UNITS, "200, 200N, 0.2kN or 45lbf"
            ),
            directions=degrees(atan2(vector[1], vector[0]))
            if vector
            else read_direction_range(words["direction"], f"{place}: direction")
            if "direction" in words
            else ANY_DIRECTION,
            upward=vector[2] if vector else 0.0,
            height=None if height is None else height * unit_scale,
            moment=read_quantity(
                words.get("moment", 0), f"{place}: moment", MOMENT_UNITS, "5000, 5000N.mm, 5N.m or 40lbf.in"
            ),
            name=str(words.get("name", "")),
        )
    except InputError as error:
        raise InputError(str(error) if str(error).startswith(place) else f"{place}: {error}") from None


def read_force_components(words: Mapping[str, Any], place: str) -> tuple[float, float, float] | None:
    """Return a force along x, y and z in N; None if only the force's size is given.

    Raises InputError for a list that does not have three numbers, and for a direction given besides the
    three.
    """
    given = words.get("force")
    parts = given.split(",") if isinstance(given, str) and "," in given else given
    if not isinstance(parts, list | tuple):
        return None
    if len(parts) != 3:
        raise InputError(
            f"{place}: force {quote_shortened(given)} is not a force along x, y and z: give three numbers, such as "
            "[300, -200, 80], or its size."
        )
    if "direction" in words:
        raise InputError(
            f"{place} has a force along x, y and z, and a direction: give the size alone with that."
        )
    x, y, z = (
        read_quantity(one, f"{place}: force", FORCE_UNITS, "200, 200N, 0.2kN or 45lbf") for one in parts
    )
    return x, y, z


def is_number(value: Any) -> bool:
    """Return whether a value is a finite int or float, and not a bool."""
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


def read_quantity(value: Any, place: str, units: Mapping[str, float], such_as: str) -> float:
    """Return a number multiplied by the factor that ``units`` has for its unit (1 without a unit); raise
    InputError for anything else.

    ``such_as`` has examples for the message.
    """
    if is_number(value):
        return float(value)
    found = QUANTITY.fullmatch(value) if isinstance(value, str) else None
    unit = found[2].lower().replace("·", ".").replace("*", ".") if found else ""
    if found is None or unit not in units:
        raise InputError(
            f"{place} {quote_shortened(value)} cannot be used: give a number, such as {such_as}."
        )
    return float(found[1]) * units[unit]


def parse_plain_number(value: Any) -> float | None:
    """Return a finite number, given as a number or as text without a unit; None for anything else."""
    if isinstance(value, str):
        found = QUANTITY.fullmatch(value)
        value = float(found[1]) if found and not found[2] else None
    return float(value) if is_number(value) else None


def read_point(value: Any, place: str) -> tuple[float, float]:
    """Return the two numbers of a point given as ``X,Y`` or [x, y], in the same unit; raise InputError for
    anything else.
    """
    parts = value.split(",") if isinstance(value, str) else value
    if isinstance(parts, list | tuple) and len(parts) == 2:
        x, y = parse_plain_number(parts[0]), parse_plain_number(parts[1])
        if x is not None and y is not None:
            return x, y
    raise InputError(f"{place} {quote_shortened(value)} is not a point: give two numbers, such as 10,5.")


def read_path_points(value: Any, place: str) -> list[tuple[float, float]]:
    """Return the corners (two or more) of a path given as ``X,Y;X,Y`` or as a list of points; the unit of the
    numbers is kept.

    Raises InputError for anything else.
    """
    parts = value.split(";") if isinstance(value, str) else value
    if not isinstance(parts, list | tuple) or len(parts) < 2:
        raise InputError(
            f"{place} {quote_shortened(value)} is not a path: give two points or more, such as 0,0;40,0;40,20."
        )
    return [read_point(part, place) for part in parts]


def read_direction_range(value: Any, place: str) -> tuple[float, float]:
    """Return a range (low, high) of directions in degrees
    from an angle, ``LOW..HIGH``, [low, high] or ``any``.

    A single angle gives a range from it to itself. Raises InputError for anything else.
    """
    if isinstance(value, str) and value.strip().lower() == "any":
        return ANY_DIRECTION
    parts = value.split("..") if isinstance(value, str) else value
    if not isinstance(parts, list | tuple):
        parts = [parts]
    angles = [parse_plain_number(part) for part in parts]
    low, high = angles[0] if angles else None, angles[-1] if angles else None
    if len(angles) > 2 or low is None or high is None:
        raise InputError(
            f"{place} {quote_shortened(value)} cannot be used: give an angle in degrees such as 30, a range such as "
            "30..60, or any."
        )
    return low, high


def quote_shortened(value: Any) -> str:
    """Return a value as shown in a message: text in quotes, and all cut to 60 characters."""
    text = f"'{value}'" if isinstance(value, str) else str(value)
    return text if len(text) <= 60 else text[:57] + "..."
