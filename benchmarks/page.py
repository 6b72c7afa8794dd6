"""Writing the figures kept into docs/benchmarks.md and drawing its plot; the words between them are written by hand.

A place for figures begins with the comment ``<!-- figures: NAME -->`` and ends with ``<!-- end of figures -->``; what stands
between is replaced. NAME is a section of the figures, or ``machine``, ``targets`` or ``plot``.
"""

from __future__ import annotations

import argparse
import re
import sys
from typing import Any

from large import BEST
from large_plot import draw_large
from plot import drawn
from report import FIGURES, ROOT, kept_figures

__all__ = ["write_page"]

PAGE = ROOT / "docs" / "benchmarks.md"
PLOT = FIGURES.with_name("time-against-contacts.svg")
LARGE_PLOT = FIGURES.with_name("large-parts.svg")
PLACE = re.compile(r"(<!-- figures: (\S+) -->\n).*?(<!-- end of figures -->)", flags=re.S)


def write_page() -> None:
    """Draw the plot, and fill every place of the page for which there are figures."""
    figures = kept_figures()
    if {"table-one", "growth"} <= figures["sections"].keys():
        rows, growing = (figures["sections"][name]["data"] for name in ("table-one", "growth"))
        PLOT.write_text(drawn(rows["points"], growing["points"], growing["part"]), encoding="utf-8")
    if (large := figures["sections"].get("large")) is not None:
        LARGE_PLOT.write_text(draw_large(large["data"], BEST), encoding="utf-8")
    PAGE.write_text(filled(PAGE.read_text(encoding="utf-8"), figures), encoding="utf-8")


def filled(page: str, figures: dict[str, Any]) -> str:
    """The page with the figures in their places."""

    def place(found: re.Match[str]) -> str:
        content = content_of(found[2], figures)
        return found[0] if content is None else f"{found[1]}\n{content}\n{found[3]}"

    return PLACE.sub(place, page)


def content_of(name: str, figures: dict[str, Any]) -> str | None:
    """What belongs into a place; None where nothing was measured yet."""
    if name == "machine":
        return "".join(f"- {key}: {value}\n" for key, value in figures["machine"].items()) or None
    if name == "targets":
        return all_targets(figures["sections"]) or None
    if name == "plot":
        return (
            f"![Time against simultaneous contacts, both logarithmic](figures/{PLOT.name})\n"
            if PLOT.exists()
            else None
        )
    section = figures["sections"].get(name)
    return None if section is None else section_text(section)


def section_text(section: dict[str, Any]) -> str:
    """A section's table, its remarks and its targets."""
    columns = section["columns"]
    lines = [
        table_line([column["heading"] for column in columns]),
        "|" + "|".join("---:" if column["right"] else "---" for column in columns) + "|",
        *(table_line(row) for row in section["rows"]),
        "",
        *(f"{remark}\n" for remark in section["remarks"]),
        *(
            f"- target {t['number']}, {t['words']}: {t['value']}, **{verdict(t)}**"
            for t in section["targets"]
        ),
    ]
    return "\n".join(lines) + "\n"


def all_targets(sections: dict[str, Any]) -> str:
    """One table of all targets in their order."""
    targets = sorted(
        (t for section in sections.values() for t in section["targets"]), key=lambda t: t["number"]
    )
    if not targets:
        return ""
    rows = [table_line([str(t["number"]), t["words"], t["value"], verdict(t)]) for t in targets]
    return "\n".join([table_line(["", "target", "measured", ""]), "|---|---|---|---|", *rows]) + "\n"


def verdict(target: dict[str, Any]) -> str:
    """``pass`` or ``short``."""
    return "pass" if target["met"] else "short"


def table_line(cells: list[str]) -> str:
    """A line of a Markdown table."""
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def main() -> None:
    """Run as a script."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument(
        "--check", action="store_true", help="write nothing; exit code 1 if the page has other figures"
    )
    if parser.parse_args().check:
        page = PAGE.read_text(encoding="utf-8")
        sys.exit(0 if filled(page, kept_figures()) == page else 1)
    write_page()
    sys.stdout.write(f"{PAGE.relative_to(ROOT)} is written.\n")


if __name__ == "__main__":
    main()
