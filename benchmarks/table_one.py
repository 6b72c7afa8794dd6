"""Target 1: the twelve rows of Table 1 of Wallack and Canny (1996), proven, on one thread.

The parts are models of the paper's, whose dimensions were never published, so counts can only be of the same order. Every
row runs in a process of its own; its seconds are those of the fastest of up to five runs, with kernels compiled and loaded.
Simultaneous contacts are counted in another run.
"""

from __future__ import annotations

from designs import ROWS, counted, timed
from report import Column, Section, run_alone

TOGETHER = 0.45

COLUMNS = (
    Column("part", 12, right=False),
    Column("pitch", 5),
    Column("columns", 7),
    Column("I", 6),
    Column("II", 6),
    Column("contacts A", 10),
    Column("seconds", 8),
    Column("paper I", 7),
    Column("paper II", 8),
    Column("paper s", 7),
    Column("times faster", 12),
)


def run(quick: bool) -> Section:
    """Measure every row, or the first three and the last three."""
    section = Section("table-one", "The rows of Table 1, proven, one thread", COLUMNS).begin()
    rows = ROWS[:3] + ROWS[-3:] if quick else ROWS
    seconds, paper_seconds, undecided, points = 0.0, 0, 0, []
    for row in rows:
        contacts, ours = counted(row.design), timed(row.design)
        seconds, paper_seconds = seconds + ours["seconds"], paper_seconds + row.seconds
        undecided += ours["undecided"]
        points.append({"name": " ".join(row.design.words), "contacts": contacts, "seconds": ours["seconds"]})
        section.row(
            *row.design.words,
            *(f"{ours['found'][kind]:,}" for kind in ("I", "II")),
            f"{contacts:,}",
            f"{ours['seconds']:.4f}",
            f"{row.type_one}",
            f"{row.type_two}",
            f"{row.seconds:,}",
            f"{row.seconds / ours['seconds']:,.0f}",
        )
    ratio = f"{paper_seconds / seconds:,.0f}"
    section.row("together", *[""] * 5, f"{seconds:.4f}", "", "", f"{paper_seconds:,}", ratio)
    section.data["points"] = points
    words = f"{len(rows)} rows of Table 1, one thread, proven, under {TOGETHER:g} s together"
    section.target(1, words, f"{seconds:.3f} s, {undecided} undecided", seconds < TOGETHER and undecided == 0)
    return section


if __name__ == "__main__":
    run_alone(__doc__, run)
