"""Tables of tools, jobs and fixtures, as spreadsheets write them and damage them."""

from __future__ import annotations

import random
from typing import Any

from hostile_files import as_toml, upset

__all__ = ["FILES"]

CELLS = (
    *("", " ", "n/a", "-", "0", "-1", "1e308", "1e999", "nan", "inf", "1e-320", "-0", "9" * 400, "10,5"),
    *('"', '""', '"a', 'a"b', "x" * 20_000, "\x00", "\x1b[2J", "a\u202eb", "#", "=1+1", "mm", "inch", "I"),
)
ENDS = ("\n", "\r\n", "\r", "\n\r", "\n\n")
TOOLS: list[list[Any]] = [
    ["tool", "name", "diameter", "flute_length", "stickout", "holder_diameter", "unit", "flutes"],
    [1, "end mill", 10, 22, 40, 40, "mm", 4],
    [2, "drill", 5.5, "", 30, "", "mm", "n/a"],
]
JOBS: list[list[Any]] = [
    ["part", "toolkit", "avoid", "load", "seating", "foolproof"],
    ["widget", "plate-20mm", "3|7", "force=200 at=1,0.5", 5, "yes"],
    ["plate.dxf", "fence-20mm", "", "", "", ""],
]
FIXTURES: list[list[Any]] = [
    ["theta_deg", "x", "y", *(f"peg{k}{end}" for k in range(1, 5) for end in ("", "_x", "_y"))],
    [93.01, 40.1, 2.6, "left", 0, 0, "left", 0, 25, "right", 51.2, 0, "right", 51.2, 25],
]


def table(rows: list[list[Any]], chance: random.Random) -> bytes:
    """A table with up to four cells replaced, moved or missing, in any of the forms of CSV."""
    cells = [[str(cell) for cell in row] for row in rows]
    for _ in range(chance.randrange(5)):
        row = chance.choice(cells)
        if not row:
            continue
        at = chance.randrange(len(row))
        match chance.randrange(5):
            case 0 | 1:
                row[at] = chance.choice(CELLS)
            case 2:
                row.insert(at, chance.choice(CELLS))
            case 3:
                del row[at]
            case _:
                cells.insert(chance.randrange(len(cells) + 1), list(chance.choice(cells)))
    mark = chance.choice((",", ",", ";", "\t"))
    lines = [mark.join(f'"{cell}"' if mark in cell else cell for cell in row) for row in cells]
    text = chance.choice(ENDS).join(lines) + chance.choice(("", "\n", "\r"))
    content = text.encode(chance.choice(("utf-8", "utf-8", "utf-8-sig", "utf-16")), errors="replace")
    if chance.random() < 0.05:
        content = content.replace(b"a", b"\xe4", 1)
    return content[: chance.randrange(len(content) + 1)] if chance.random() < 0.05 else content


def make_tools_csv(chance: random.Random) -> bytes:
    """A table of two tools."""
    return table(TOOLS, chance)


def make_tools_toml(chance: random.Random) -> bytes:
    """The same as TOML."""
    rows = [
        {key: value for key, value in zip(TOOLS[0], row, strict=True) if value not in ("", "n/a")}
        for row in TOOLS[1:]
    ]
    tools = {str(row.pop("tool")): row for row in rows}
    return as_toml(upset({"unit": "mm", "tool": tools}, chance), chance)


def make_tools_linuxcnc(chance: random.Random) -> bytes:
    """LinuxCNC's table, some of its words replaced."""
    words = [
        "T1",
        "P1",
        "D10",
        "Z50",
        ";end",
        "mill\nT2",
        "P2",
        "D5.5",
        "Z+0.5",
        ";drill\n;remark\nT12",
        "P3",
        "D.25",
    ]
    for _ in range(chance.randrange(4)):
        words[chance.randrange(len(words))] = chance.choice(
            ("T1", "T-1", "D1e5", "D-3", "D" + "9" * 400, "P", ";", "T1T1", "\x00", "D.", "hello", "T9999999")
        )
    return " ".join(words).replace("\n", chance.choice(ENDS)).encode()


def make_jobs_csv(chance: random.Random) -> bytes:
    """A table of two jobs."""
    return table(JOBS, chance)


def make_jobs_toml(chance: random.Random) -> bytes:
    """The same as TOML."""
    jobs = [
        {"part": "widget", "toolkit": ["plate-20mm"], "avoid": [3, 7], "load": ["force=200 at=1,0.5"]},
        {"part": "plate.dxf", "seating": 5, "opening": "0.1in", "foolproof": True},
    ]
    return as_toml(upset({"unit": "mm", "job": jobs}, chance), chance)


def make_list_csv(chance: random.Random) -> bytes:
    """Another program's list of fixtures."""
    return table(FIXTURES, chance)


FILES = {
    "tools.csv": make_tools_csv,
    "tools.toml": make_tools_toml,
    "tools.tbl": make_tools_linuxcnc,
    "jobs.csv": make_jobs_csv,
    "jobs.toml": make_jobs_toml,
    "list.csv": make_list_csv,
}
