"""The share that a grid of steps finds of each set of the benchmark, from the data file of the benchmark set.

This is a hook: nothing is measured here, and without ``FILE`` the section is left out. The file is JSON. Of it are read
``command``, which makes it; ``steps`` in mm, with as many degrees of the angle; ``touch`` in mm; ``kinds``, the mean shares
of the sets of each kind of toolkit; and ``sets``, each with ``set``, ``kind``, ``fixtures`` and the shares found at each
step. Of these ``fixed`` is where all pegs are within ``touch`` of their faces at a point of the grid, and ``half`` where
they are within half a step.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from paper.document import Block, Figures, Heading, Inline, Marked, Paragraph, Table

NAME, TITLE = "benchmark-set", "What a grid finds of the benchmark set"
SECONDS, QUICK_SECONDS = 0.1, 0.1

FILE = Path(__file__).resolve().parents[2] / "docs" / "figures" / "grid-share.json"
# mm, and degrees: the step that the report is about.
STEP = 1.0
# Sets beside each other in the table of all.
BESIDE = 2
SHARES = "fixed", "half"


def measure(data: dict[str, Any], quick: bool) -> Iterator[tuple[float, str]]:
    """Read the file, if it is there."""
    yield 0.0, "the grid's shares"
    if not FILE.exists():
        return
    told = json.loads(FILE.read_text(encoding="utf-8"))
    place = told["steps"].index(STEP)
    data |= {"step": STEP, "touch": told["touch"], "made_by": told["command"], "kinds": [], "sets": []}
    for row in told["sets"]:
        shares = {name: row[name][place] for name in SHARES}
        data["sets"].append({"set": row["set"], "kind": row["kind"], "fixtures": row["fixtures"], **shares})
    for kind, means in told["kinds"].items():
        mine = [row for row in data["sets"] if row["kind"] == kind]
        counts = {"sets": len(mine), "fixtures": sum(row["fixtures"] for row in mine)}
        data["kinds"].append({"kind": kind, **counts, **{name: means[name][place] for name in SHARES}})


def render(figures: Figures) -> list[Block]:
    """A table of the kinds and one of all sets, or nothing."""
    if not figures.value("sets"):
        return []
    kinds: list[list[Inline]] = [
        [
            figures.value(f"kinds/{k}/kind"),
            figures.count(f"kinds/{k}/sets"),
            figures.count(f"kinds/{k}/fixtures"),
            *(figures.percent(f"kinds/{k}/{name}", 1) for name in SHARES),
        ]
        for k in figures.every("kinds")
    ]
    return [
        Heading(TITLE),
        Paragraph(
            (
                "A plain program tries every pose on a grid of ",
                figures.fixed("step", 0),
                " mm and ",
                figures.fixed("step", 0),
                "° and takes a pose where every peg is within ",
                figures.fixed("touch", 1),
                " mm of its face. The first share is what it meets of the complete lists. The second is what it meets "
                "where half a step is near enough, and every pose that it takes must then be made exact. Made by ",
                Marked("code", figures.value("made_by")),
                ", which is part of the benchmark set.",
            )
        ),
        Table(
            "Table 14",
            "What the grid finds, the mean over the sets of each kind of toolkit.",
            ("kind", "sets", "fixtures", "within the tolerance", "within half a step"),
            kinds,
        ),
        Table(
            "Table 15",
            "What the grid finds of each set: within the tolerance, and within half a step.",
            ("set", "fixtures", "found", "half") * BESIDE,
            set_rows(figures),
            left=tuple(range(0, 4 * BESIDE, 4)),
        ),
    ]


def set_rows(figures: Figures) -> list[list[Inline]]:
    """All sets in columns, one below the other and then beside each other."""
    count = len(figures.every("sets"))
    lines = -(-count // BESIDE)
    rows: list[list[Inline]] = []
    for line in range(lines):
        cells: list[Inline] = []
        for k in range(line, lines * BESIDE, lines):
            name = figures.value(f"sets/{k}/set")
            if name is None:
                cells += [""] * 4
                continue
            cells += [Marked("reference", name), figures.count(f"sets/{k}/fixtures")]
            cells += [figures.percent(f"sets/{k}/{share}", 1) for share in SHARES]
        rows.append(cells)
    return rows
