"""Tables of tools: TOML, CSV, LinuxCNC's, and comments of the program itself.

A TOML file has a table for each tool; without a unit, lengths are in the program's::

    unit = "mm"

    [tool.1]
    name = "end mill"
    diameter = 10
    flute_length = 22
    stickout = 40               # from the tip to the holder
    holder_diameter = 40
    holder_length = 50

A CSV file has the same names at its head, with ``tool`` before them. A line of LinuxCNC's table is
``T1 P1 D10 Z50 ;end mill``; its Z is an offset and says nothing of the tool's shape.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Mapping, Sequence
from io import StringIO
from pathlib import Path
from typing import Any

from workhold.errors import InputError
from workhold.files.program.tool_fields import FIELDS, SHAPE, tool_of_fields
from workhold.files.text import read_text, toml_table
from workhold.model.cutting_tool import Tool
from workhold.units import Unit, unit_named

__all__ = ["commented_tools", "read_tools"]

# Bytes; a tool takes a hundred.
LARGEST_FILE = 1_000_000
MOST_TOOLS = 10_000
LINUXCNC = re.compile(r"\s*T\s*\d+", re.IGNORECASE)
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


def read_tools(path: str | Path, unit: Unit) -> tuple[dict[int, Tool], bool]:
    """Reads a table of tools.

    Parameters
    ----------
    path : a file in one of the three forms; a name ending in .toml or .csv says which, else its content does.
    unit : of lengths, where the file does not say.

    Returns
    -------
    tuple
        Tools by their numbers, and whether every length stands in a unit that the file itself says.

    Raises
    ------
    InputError
        Naming the first tool that cannot be used.
    """
    path = Path(path)
    try:
        text = read_text(path, LARGEST_FILE, "tools")
        ending = path.suffix.lower()
        if ending == ".toml":
            return of_toml(toml_table(text), unit)
        if ending != ".csv" and is_linuxcnc(text):
            return of_linuxcnc(text, unit), False
        return of_csv(text, unit)
    except InputError as error:
        raise InputError(f"{path} is not a table of tools: {error}") from error


def described(text: str) -> tuple[int | None, dict[str, str]] | None:
    """The tool that a comment describes and its fields, None for its number where it is the one in use."""
    if match := COMMENT.match(text):
        before, after = match[2].strip(" -"), match[4].rpartition(" - ")[2].strip()
        return int(match[1]), {"diameter": match[3], "name": before or ("" if "=" in after else after)}
    if match := LONG_COMMENT.match(text):
        unit = {"unit": match[4].lower()} if match[4] else {}
        return int(match[1]), {"diameter": match[3], "name": match[2].strip(" ,-"), **unit}
    if match := COMPENSATED.match(text):
        return None, {"diameter": match[1], "unit": "mm"}
    return None


def checked_number(text: Any, place: str) -> int:
    """The number of a tool.

    Raises
    ------
    InputError
        For anything but a whole number from 0.
    """
    word = str(text).strip()
    word = word[1:] if word[:1] in ("T", "t") else word
    if not (word.isascii() and word.isdigit() and len(word) <= 6):
        raise InputError(
            f"{place} '{str(text)[:20]}' is not the number of a tool: give a whole one, such as 3."
        )
    return int(word)


def collected(rows: Iterable[tuple[int, Mapping[str, Any], str]], unit: Unit) -> dict[int, Tool]:
    """Tools of rows of number, fields and place.

    Raises
    ------
    InputError
        For a tool that is given twice, and none.
    """
    tools: dict[int, Tool] = {}
    for number, fields, place in rows:
        if number in tools:
            raise InputError(f"T{number} is given twice: leave one of them out.")
        tools[number] = tool_of_fields(number, fields, place, unit)
        if len(tools) > MOST_TOOLS:
            raise InputError(f"there are more than {MOST_TOOLS:,} tools: give those of the program.")
    if not tools:
        raise InputError(
            f"there are no tools in it: write a line for each, such as {SHAPE.format(number=1)}."
        )
    return tools


def of_toml(content: Mapping[str, Any], unit: Unit) -> tuple[dict[int, Tool], bool]:
    """Tools of TOML.

    Raises
    ------
    InputError
        For another form.
    """
    for key in content:
        if key not in ("unit", "tool"):
            raise InputError(
                f"the key '{key[:40]}' is not known: give unit, and a table [tool.3] for tool 3."
            )
    said = "unit" in content
    unit = unit_named(str(content["unit"])) if said else unit
    tables = content.get("tool", {})
    if not isinstance(tables, dict) or not all(isinstance(one, dict) for one in tables.values()):
        raise InputError(f"its tools are no tables: write a line for each, such as {SHAPE.format(number=1)}.")
    rows = [(checked_number(key, "tool"), fields, f"tool.{key}") for key, fields in tables.items()]
    return collected(rows, unit), said or all("unit" in one for one in tables.values())


def of_csv(text: str, unit: Unit) -> tuple[dict[int, Tool], bool]:
    """Tools of a table with a head, separated by commas, semicolons or tabs.

    Raises
    ------
    InputError
        For another form.
    """
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    head = lines[0] if lines else ""
    mark = next((one for one in (";", "\t") if one in head), ",")
    names = [name.strip().lower().replace(" ", "_") for name in head.split(mark)]
    known = ("tool", *FIELDS)
    if "tool" not in names or not set(names) <= set(known) or len(set(names)) < len(names):
        raise InputError(
            f"its first line names no columns: write tool,diameter and others of {', '.join(known)}."
        )
    rows = []
    for place, cells in enumerate(csv.reader(StringIO("\n".join(lines[1:])), delimiter=mark), 1):
        if len(cells) > len(names):
            raise InputError(f"row {place} has {len(cells)} cells under {len(names)} names: correct it.")
        fields: dict[str, Any] = {
            name: cell.strip() for name, cell in zip(names, cells, strict=False) if cell.strip()
        }
        if mark == ";":
            fields = {
                key: fields[key] if key in ("name", "unit") else fields[key].replace(",", ".")
                for key in fields
            }
        number = checked_number(fields.pop("tool", ""), f"row {place}:")
        rows.append((number, fields, f"T{number}"))
    return collected(rows, unit), all("unit" in fields for _, fields, _ in rows)


def is_linuxcnc(text: str) -> bool:
    """Whether the first line that is no remark begins with a tool's number."""
    lines = (line for line in text.splitlines() if line.split(";")[0].strip())
    return LINUXCNC.match(next(lines, "")) is not None


def of_linuxcnc(text: str, unit: Unit) -> dict[int, Tool]:
    """Tools of LinuxCNC's table; those without a diameter are left out.

    Raises
    ------
    InputError
        For a line of another form.
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
            number = checked_number(words["T"], f"line {place}:")
            rows.append((number, {"diameter": float(words["D"]), "name": remark.strip()}, f"T{number}"))
    return collected(rows, unit)


def commented_tools(
    comments: Iterable[tuple[int, str]], unit: Unit, calls: Sequence[tuple[int, int]] = ()
) -> dict[int, Tool]:
    """Tools that a program describes in its comments, with a diameter in the program's unit.

    Parameters
    ----------
    comments : (line, text) of each.
    unit : the program's.
    calls : (line, number) of the tools that come into the spindle, of which some comments speak.

    Raises
    ------
    InputError
        For a tool with two diameters.

    Examples
    --------
    >>> from workhold.units import INCH
    >>> found = commented_tools([(3, "T4 D=0.5 CR=0. - ZMIN=-0.25 - flat end mill")], INCH)
    >>> found[4].diameter, found[4].name
    (12.7, 'flat end mill')
    """
    tools: dict[int, Tool] = {}
    for line, text in comments:
        found = described(text)
        if found is None or not float(found[1]["diameter"]) > 0.0:
            continue
        place = f"line {line}"
        number = found[0]
        if number is None:
            number = next((one for called, one in reversed(calls) if called <= line), 0)
        tool = tool_of_fields(number, found[1], place, unit)
        if number in tools and tools[number].diameter != tool.diameter:
            raise InputError(
                f"{place}: the comments give T{number} two diameters: correct them, or give tools."
            )
        tools.setdefault(number, tool)
    return tools
