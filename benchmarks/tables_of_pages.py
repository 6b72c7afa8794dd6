"""Writes the tables of docs/benchmark-entries.md and docs/how-good.md from the data files beside their plots.

python benchmarks/tables_of_pages.py
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from how_good import CAPTURE_ALWAYS

__all__ = ["filled", "grid_tables", "good_tables"]

DOCS = Path(__file__).resolve().parent.parent / "docs"
PAGES = {"benchmark-entries.md": "grid-share.json", "how-good.md": "how-good.json"}


def main() -> None:
    """Fill both pages."""
    for name in PAGES:
        path = DOCS / name
        path.write_text(filled(name, path.read_text(encoding="utf-8")), encoding="utf-8")


def filled(page: str, text: str) -> str:
    """The text of a page with its tables made anew."""
    data = json.loads((DOCS / "figures" / PAGES[page]).read_text(encoding="utf-8"))
    tables = grid_tables(data) if page == "benchmark-entries.md" else good_tables(data)
    for name, table in tables.items():
        begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
        before, _, rest = text.partition(begin)
        _, _, after = rest.partition(end)
        text = f"{before}{begin}{table}{end}{after}"
    return text


def table_of(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table of Markdown, the first column on the left."""
    rule = "|".join(["---"] + ["--:"] * (len(headings) - 1))
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(["", f"| {' | '.join(headings)} |", f"|{rule}|", *lines, ""])


def percent(share: float) -> str:
    """A share in percent, which is 0 or 100 only where it is exactly so."""
    shown = f"{100 * share:.1f}"
    return {"0.0": "0" if share == 0 else "< 0.1", "100.0": "100" if share == 1 else "> 99.9"}.get(
        shown, shown
    )


def grid_tables(data: Mapping[str, Any]) -> dict[str, str]:
    """The tables of what a grid meets: by kind over the step, and every set at 1 mm and 1 degree."""
    steps = [f"{step:g}" for step in data["steps"]]
    at = data["steps"].index(1.0)
    kinds = [
        [f"{kind}, {words}", *map(percent, shares[rule])]
        for kind, shares in data["kinds"].items()
        for rule, words in (("fixed", f"within {data['touch']:g} mm"), ("half", "within half a step"))
    ]
    sets = [
        [row["set"], f"{row['fixtures']:,}", percent(row["fixed"][at]), percent(row["half"][at])]
        for row in data["sets"]
    ]
    return {
        "shares by kind": table_of(["mean share in % at a step of", *steps], kinds),
        "shares by set": table_of(["set", "fixtures", "within 0.1 mm, %", "within half a step, %"], sets),
    }


def good_tables(data: Mapping[str, Any]) -> dict[str, str]:
    """The tables of gains: by kind and by family."""
    headings = [
        "",
        "sets",
        "rule finds none",
        "location error",
        "no gain",
        "force",
        "no gain",
        "beaten in both",
    ]
    out = {}
    for name in ("kinds", "families"):
        rows = [good_row(group, one) for group, one in {**data[name], "all": data["all"]}.items()]
        out[f"gains by {name}"] = table_of(headings, rows)
    families = dict.fromkeys(row["family"] for row in data["seating"])
    seated = [(name, [row for row in data["seating"] if row["family"] == name]) for name in families]
    out["capture openings"] = table_of(
        [
            "",
            "sets",
            "by the rule, mm",
            "widest of the precise, mm",
            "wider by the list",
            "wider by the rule",
        ],
        [seated_row(name, rows) for name, rows in (*seated, ("all", data["seating"]))],
    )
    return out


def seated_row(name: str, rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """The row of a group of sets: medians in mm, and in how many either is wider by a twentieth."""
    pairs = [(row["by_rule"], row["widest_of_the_precise"]) for row in rows]
    middles = [median(each) for each in zip(*pairs, strict=True)]
    medians = [f"{one:.2f}" if one < CAPTURE_ALWAYS else "any" for one in middles]
    wider = sum(best > 1.05 * rule for rule, best in pairs), sum(rule > 1.05 * best for rule, best in pairs)
    return [name, str(len(rows)), *medians, *map(str, wider)]


def good_row(name: str, group: Mapping[str, Any]) -> list[str]:
    """The row of a group of sets."""
    found = group["sets"] - group["rule_finds_none"]
    gains = [
        f"{group[key][1]:.2f} ({group[key][0]:.2f}–{group[key][2]:.2f})"
        for key in ("gain_location", "gain_force")
    ]
    numbers = [f"{group[key]} of {found}" for key in ("no_gain_location", "no_gain_force", "dominated")]
    return [
        name,
        str(group["sets"]),
        str(group["rule_finds_none"]),
        gains[0],
        numbers[0],
        gains[1],
        *numbers[1:],
    ]


if __name__ == "__main__":
    main()
