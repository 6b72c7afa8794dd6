"""The share that a grid of steps finds, from the data file of the benchmark set where there is one.

This is a hook. The benchmark set writes ``FILE``, JSON of the form

    {"format": "workhold-grid-shares/1", "step_mm": 1.0, "step_deg": 1.0,
     "sets": [{"name": "...", "fixtures": 306, "found": 21}, ...]}

with one entry for each of its sets: how many fixtures there are, and how many of them the naive search over a grid of
``step_mm`` and ``step_deg`` finds. Nothing is measured here; without the file the section is left out.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from paper.document import Block, Figures, Heading, Marked, Paragraph, Table

NAME, TITLE = "benchmark-set", "What a grid finds of the benchmark set"
SECONDS, QUICK_SECONDS = 0.1, 0.1

FILE = Path(__file__).resolve().parents[2] / "docs" / "figures" / "grid-shares.json"
FORMAT = "workhold-grid-shares/1"


def measure(data: dict[str, Any], quick: bool) -> Iterator[tuple[float, str]]:
    """Read the file, if it is there."""
    yield 0.0, "the grid's shares"
    if not FILE.exists():
        return
    told = json.loads(FILE.read_text(encoding="utf-8"))
    if told.get("format") != FORMAT:
        raise ValueError(f"{FILE.name} is no {FORMAT} file: write it anew")
    data |= {"step_mm": told["step_mm"], "step_deg": told["step_deg"], "sets": told["sets"]}
    for one in data["sets"]:
        one["share"] = one["found"] / one["fixtures"] if one["fixtures"] else None
    there = sum(one["fixtures"] for one in data["sets"])
    data["share"] = sum(one["found"] for one in data["sets"]) / there if there else None


def render(figures: Figures) -> list[Block]:
    """A table of all sets, or nothing."""
    if not figures.value("sets"):
        return []
    rows = [
        (
            Marked("label", figures.value(f"sets/{k}/name")),
            figures.count(f"sets/{k}/fixtures"),
            figures.count(f"sets/{k}/found"),
            figures.percent(f"sets/{k}/share"),
        )
        for k in figures.every("sets")
    ]
    words = (
        "A program that tries every pose on a grid of ",
        figures.fixed("step_mm", 0),
        " mm and ",
        figures.fixed("step_deg", 0),
        "° finds ",
        figures.percent("share"),
        " of the fixtures of the benchmark set.",
    )
    return [
        Heading(TITLE),
        Paragraph(words),
        Table(
            "Table 15",
            "Fixtures found by the grid, set by set.",
            ("set", "fixtures", "found", "share"),
            rows,
        ),
    ]
