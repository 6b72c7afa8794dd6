"""Tables of tools: TOML, CSV, LinuxCNC's, and comments of the program; each tool is a stack of cylinders.

A TOML file has a table for each tool; without a unit, lengths are in the program's::

    unit = "mm"

[tool.1] name = "end mill" type = "mill" # or "drill"; the word in the name is enough diameter = 10
flute_length = 22 stickout = 40 # from the tip to the holder holder_diameter = 40 holder_length = 50

A CSV file has the same names at its head, with ``tool`` before them. A line of LinuxCNC's table is
``T1 P1 D10 Z50 ;end mill``; its Z is an offset and says nothing of the tool's shape.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import Any

from workhold.errors import InputError
from workhold.files.budget import LIMITS, Budget
from workhold.files.tables import SAVED, read_table
from workhold.files.text import parse_toml, read_text
from workhold.limits import read_number
from workhold.model.cutting_tool import CuttingData, Cylinder, Tool
from workhold.units import Unit, find_unit

__all__ = ["FIELDS", "SHAPE", "read_tools_in_comments", "read_tools", "make_tool_from_fields"]

LENGTHS = ("diameter", "flute_length", "shank_diameter", "stickout", "holder_diameter", "holder_length")
# How it cuts; flutes are teeth. A corner or a point is inside the flat end as which every tool is taken.
CUTTING = (
    "cutting_force",
    "power",
    "material",
    "teeth",
    "cut_depth",
    "cut_width",
    "point_angle",
    "helix_angle",
)
OTHERS = ("corner_radius", "flutes")
FIELDS = ("name", "unit", "type", *LENGTHS, *CUTTING, *OTHERS)
UNSURE = ("teeth", "point_angle")
# What of them is not a number.
WORDS = {"material", "direction"}
SHAPE = (
    "tool.{number} = {{diameter = 10, flute_length = 22, stickout = 40, holder_diameter = 40, "
    "holder_length = 50}}"
)
# mm. As far up as a tool is taken to go where nobody says: past everything that holds a part.
ENDLESS = 1000.0
LINUXCNC_WORD = re.compile(r"([A-Z])\s*([-+]?(?:\d+\.?\d*|\.\d+))\s*", re.IGNORECASE | re.ASCII)
# Fusion, and posts like its own, write (T3 D=6. CR=0. - ZMIN=-5. - flat end mill).
COMMENT = re.compile(
    r"T\s*(\d{1,6})\b(.*?)\bD\s*=\s*(\d+\.?\d*|\.\d+)(?![\d.])(.*)", re.IGNORECASE | re.ASCII
)

# OpenBuilds' posts write (Tool 5: Spot Drill 3 Flutes, Diam = 5mm, Len = 20.00mm).
LONG_COMMENT = re.compile(
    r"TOOL\s+(\d{1,6})\s*:(.*?)\bDIAM\s*=\s*(\d+\.?\d*|\.\d+)\s*(mm|in)?\b", re.IGNORECASE | re.ASCII
)
# FreeCAD writes this before the paths of a tool, whose diameter it reckons in mm.
COMPENSATED = re.compile(
    r"Compensated Tool Path\. Diameter:\s*(\d+\.?\d*|\.\d+)\s*$", re.IGNORECASE | re.ASCII
)


def make_tool_from_fields(number: int, fields: Mapping[str, Any], place: str, unit: Unit) -> Tool:
    """Return a tool as a flute, a shank above it and a holder.

    Parameters
    ----------
    fields : lengths by their names; the diameter is needed. A tool without a stickout is ``ENDLESS`` mm long.
    place : name of their source, for messages.
    unit : unit of lengths, where the fields do not give one.

    Raises
    ------
    InputError
        For a field that is not known, or whose value is impossible.

    Examples
    --------
    >>> from workhold.units import MILLIMETRE
    >>> fields = {"diameter": 10, "stickout": 40, "holder_diameter": 40, "holder_length": 50}
    >>> [(one.low, one.high, one.radius) for one in make_tool_from_fields(1, fields, "T1", MILLIMETRE).cylinders]
    [(0.0, 40.0, 5.0), (40.0, 90.0, 20.0)]
    """
    for key in fields:
        if key not in FIELDS:
            raise InputError(f"{place} has an unknown key '{str(key)[:40]}': give {', '.join(FIELDS)}.")
    unit = unit if fields.get("unit") is None else find_unit(str(fields["unit"]))
    lengths = {}
    for key in LENGTHS:
        if fields.get(key) is not None:
            value = read_number(fields[key])
            if isinstance(fields[key], bool) or not (isfinite(value) and value > 0):
                raise InputError(f"{place}: {key} is not a length above 0: give a number.")
            lengths[key] = unit.to_mm(value)
    if "diameter" not in lengths:
        raise InputError(f"{place} has no diameter: give one.")
    try:
        cutting = make_cutting_data(fields, unit)
        name = str(fields.get("name") or "")
        flute, kind = lengths.get("flute_length"), str(fields.get("type") or "")
        cylinders, has_holder = stack_cylinders(lengths, place), "holder_diameter" in lengths
        return Tool(number, cylinders, lengths["diameter"], name, cutting, flute, kind, has_holder)
    except InputError as error:
        raise InputError(str(error) if str(error).startswith(place) else f"{place}: {error}") from error


def make_cutting_data(fields: Mapping[str, Any], unit: Unit) -> CuttingData:
    """Return the cutting data of a tool from its fields, with lengths in ``unit``.

    A table written for another program may have a number of teeth or a point angle that is impossible here.
    That raises InputError only if the fields ask for a cutting force; otherwise these two are left out.
    """
    given = {key: fields[key] for key in CUTTING if fields.get(key) is not None}
    if fields.get("flutes") is not None:
        given.setdefault("teeth", fields["flutes"])
    for key in given.keys() - WORDS:
        number = read_number(given[key])
        given[key] = unit.to_mm(number) if key in ("cut_depth", "cut_width") else number
    if not given.keys() & {"cutting_force", "power", "material"}:
        given = {key: value for key, value in given.items() if key not in UNSURE or is_usable(key, value)}
    return CuttingData(**given)


def is_usable(key: str, value: Any) -> bool:
    """Return whether the class of cutting data accepts a value for a field."""
    try:
        CuttingData(**{key: value})
    except InputError:
        return False
    return True


def stack_cylinders(lengths: Mapping[str, float], place: str) -> list[Cylinder]:
    """Return the cylinders of a tool from its lengths in mm, from the tip up.

    Raises InputError for a shank without flute length, a holder without stickout, or a holder length without
    a holder diameter.
    """
    flute, reach = lengths.get("flute_length"), lengths.get("stickout")
    radius, shank = lengths["diameter"] / 2, lengths.get("shank_diameter")
    top = ENDLESS if reach is None else reach
    if "holder_diameter" in lengths and reach is None:
        raise InputError(f"{place} has a holder and no stickout: give how far the tool stands out of it.")
    if "holder_length" in lengths and "holder_diameter" not in lengths:
        raise InputError(f"{place} has a holder_length and no holder_diameter: give both.")
    if shank is None:
        found = [Cylinder(0.0, top, radius)]
    elif flute is None:
        raise InputError(f"{place} has a shank and no flute_length: give where the shank begins.")
    elif flute < top:
        found = [Cylinder(0.0, flute, radius), Cylinder(flute, top, shank / 2)]
    else:
        found = [Cylinder(0.0, top, radius)]
    if "holder_diameter" in lengths and reach is not None:
        end = reach + lengths.get("holder_length", ENDLESS)
        found.append(Cylinder(reach, end, lengths["holder_diameter"] / 2))
    return found


def read_tools(path: str | Path, unit: Unit) -> tuple[dict[int, Tool], bool]:
    """Return the tools in a table.

    Parameters
    ----------
    path : a file in one of the three forms: TOML or CSV if its name ends in .toml or .csv, otherwise its
        content decides.
    unit : unit of lengths, where the file does not give one.

    Returns
    -------
    tuple
        Tools by their numbers, and whether the file itself gives the unit of every length.

    Raises
    ------
    InputError
        Naming the first tool that cannot be used.
    """
    path = Path(path)
    try:
        text = read_text(path, LIMITS["tools"], SAVED)
        ending = path.suffix.lower()
        if ending == ".toml":
            return read_toml_tools(parse_toml(text), unit)
        if ending != ".csv" and is_linuxcnc(text):
            return read_linuxcnc_tools(text, unit), False
        return read_csv_tools(text, unit)
    except InputError as error:
        raise InputError(f"{path} is not a table of tools: {error}") from error


def parse_tool_comment(text: str) -> tuple[int | None, dict[str, str]] | None:
    """Return the number and the fields of the tool that a comment describes; None if it describes none.

    The number is None where the comment means the tool in the spindle.
    """
    if match := COMMENT.match(text):
        before, after = match[2].strip(" -"), match[4].rpartition(" - ")[2].strip()
        return int(match[1]), {"diameter": match[3], "name": before or ("" if "=" in after else after)}
    if match := LONG_COMMENT.match(text):
        unit = {"unit": match[4].lower()} if match[4] else {}
        return int(match[1]), {"diameter": match[3], "name": match[2].strip(" ,-"), **unit}
    if match := COMPENSATED.match(text):
        return None, {"diameter": match[1], "unit": "mm"}
    return None


def read_tool_number(text: Any, place: str) -> int:
    """Return the number of a tool, written with or without T;
    raise InputError for anything but a whole number from 0.
    """
    word = str(text).strip()
    word = word[1:] if word[:1] in ("T", "t") else word
    if not (word.isascii() and word.isdigit() and len(word) <= 6):
        raise InputError(
            f"{place} '{str(text)[:20]}' is not the number of a tool: give a whole one, such as 3."
        )
    return int(word)


def collect_tools(rows: Iterable[tuple[int, Mapping[str, Any], str]], unit: Unit) -> dict[int, Tool]:
    """Return tools by number from rows (number, fields, place); raise InputError for a tool that is given
    twice, and if there are no rows.
    """
    tools: dict[int, Tool] = {}
    budget = Budget(LIMITS["tools"])
    for number, fields, place in rows:
        if number in tools:
            raise InputError(f"T{number} is given twice: leave one of them out.")
        tools[number] = make_tool_from_fields(number, fields, place, unit)
        budget.spend()
    if not tools:
        raise InputError(
            f"there are no tools in it: write a line for each, such as {SHAPE.format(number=1)}."
        )
    return tools


def read_toml_tools(content: Mapping[str, Any], unit: Unit) -> tuple[dict[int, Tool], bool]:
    """Return (1) the tools of parsed TOML by number, and (2) whether the
    content gives the unit of every tool.

    Raises InputError for content of another form.
    """
    for key in content:
        if key not in ("unit", "tool"):
            raise InputError(
                f"the key '{key[:40]}' is not known: give unit, and a table [tool.3] for tool 3."
            )
    said = "unit" in content
    unit = find_unit(str(content["unit"])) if said else unit
    tables = content.get("tool", {})
    if not isinstance(tables, dict) or not all(isinstance(one, dict) for one in tables.values()):
        raise InputError(
            f"its tools are not tables: write a line for each, such as {SHAPE.format(number=1)}."
        )
    rows = [(read_tool_number(key, "tool"), fields, f"tool.{key}") for key, fields in tables.items()]
    return collect_tools(rows, unit), said or all("unit" in one for one in tables.values())


def read_csv_tools(text: str, unit: Unit) -> tuple[dict[int, Tool], bool]:
    """Return (1) the tools of a CSV table with column names, by number,
    and (2) whether every tool has a unit.

    Cells are separated by commas, semicolons or tabs. Raises InputError for text of another form.
    """
    known = ("tool", *FIELDS)
    wanted = f"write tool,diameter and others of {', '.join(known)}"
    if not text.strip():
        raise InputError(f"its first line names no columns: {wanted}.")
    table = read_table(text, Budget(LIMITS["tools"], len(text)), remarks="#")
    table.names = tuple(name.replace(" ", "_") for name in table.names)
    if "tool" not in table.names or not {*table.names} <= {"", *known}:
        raise InputError(f"its first line names no columns: {wanted}.")
    rows = []
    for row in table.iterate_rows():
        # A cell in which nothing is given is none; of a name only an empty one.
        cells = {
            name: cell if name == "name" else row.read_number_cell(name) for name, cell in row.cells.items()
        }
        fields = {name: cell for name, cell in cells.items() if cell is not None}
        number = read_tool_number(fields.pop("tool", ""), f"{row}:")
        rows.append((number, fields, f"{row}, T{number}"))
    return collect_tools(rows, unit), all("unit" in fields for _, fields, _ in rows)


def is_linuxcnc(text: str) -> bool:
    """Return whether a text looks like LinuxCNC's tool table.

    It does if its first line with more than a comment begins with the word T, or consists of words (a letter
    and a number each) of which one is T.
    """
    codes = (line.partition(";")[0].strip() for line in text.splitlines())
    code = next((code for code in codes if code), "")
    letters = [letter.upper() for letter, _ in LINUXCNC_WORD.findall(code)]
    return letters[:1] == ["T"] or ("T" in letters and not LINUXCNC_WORD.sub("", code).strip())


def read_linuxcnc_tools(text: str, unit: Unit) -> dict[int, Tool]:
    """Return the tools of LinuxCNC's table by number, leaving out those without a diameter.

    Raises InputError for a line of another form.
    """
    rows = []
    for place, line in enumerate(text.splitlines(), 1):
        code, _, remark = line.partition(";")
        if not code.strip():
            continue
        words = {letter.upper(): number for letter, number in LINUXCNC_WORD.findall(code)}
        if LINUXCNC_WORD.sub("", code).strip() or "T" not in words:
            raise InputError(
                f"line {place} is not one of LinuxCNC's: write T1 P1 D10 Z50 and a remark after ;."
            )
        if float(words.get("D", 0.0)) > 0.0:
            number = read_tool_number(words["T"].removeprefix("+"), f"line {place}:")
            rows.append((number, {"diameter": float(words["D"]), "name": remark.strip()}, f"T{number}"))
    return collect_tools(rows, unit)


def read_tools_in_comments(
    comments: Iterable[tuple[int, str]], unit: Unit, calls: Sequence[tuple[int, int]] = ()
) -> dict[int, Tool]:
    """Return the tools that a program describes in its comments, by number.

    Parameters
    ----------
    comments : (line, text) of each.
    unit : unit of diameters in comments that do not give one, which is the program's unit.
    calls : (line, number) of the tools that come into the spindle, for comments about the tool in use.

    Raises
    ------
    InputError
        For a tool with two diameters.

    Examples
    --------
    >>> from workhold.units import INCH
    >>> found = read_tools_in_comments([(3, "T4 D=0.5 CR=0. - ZMIN=-0.25 - flat end mill")], INCH)
    >>> found[4].diameter, found[4].name
    (12.7, 'flat end mill')
    """
    tools: dict[int, Tool] = {}
    for line, text in comments:
        found = parse_tool_comment(text)
        if found is None or not float(found[1]["diameter"]) > 0.0:
            continue
        place = f"line {line}"
        number = found[0]
        if number is None:
            number = next((one for called, one in reversed(calls) if called <= line), 0)
        tool = make_tool_from_fields(number, found[1], place, unit)
        if number in tools and tools[number].diameter != tool.diameter:
            raise InputError(
                f"{place}: the comments give T{number} two diameters: correct them, or give tools."
            )
        tools.setdefault(number, tool)
    return tools
