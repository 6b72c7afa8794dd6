"""Target 4: two threads against one, on designs that take one thread more than a fifth of a second.

Rows of Table 1 that are done sooner are left out, since starting threads is then part of what is measured; parts grown
against the pitch stand beside those that remain.
"""

from __future__ import annotations

from designs import ROWS, Design, grown, timed
from report import Column, Section, machine, run_alone

LEAST_TIMES = 1.7
LONG = 0.2
GROWN = (grown(Design("oblongPart", 8, 10), 2), grown(Design("widget", 8, 5), 2))

COLUMNS = (
    Column("part", 12, right=False),
    Column("pitch", 5),
    Column("columns", 7),
    Column("one thread s", 12),
    Column("two threads s", 13),
    Column("ratio", 6),
)


def run(quick: bool) -> Section:
    """Measure every design that takes long enough, or the first such."""
    section = Section("threads", "Two threads against one", COLUMNS).begin()
    ratios: list[float] = []
    for design in (*(row.design for row in ROWS if row.design.columns > 1), *GROWN):
        one = timed(design)["seconds"]
        if one <= LONG:
            continue
        two = timed(design, threads=2)["seconds"]
        ratios.append(one / two)
        section.row(*design.words, f"{one:.3f}", f"{two:.3f}", f"{ratios[-1]:.2f}")
        if quick:
            break
    if machine()["processors used"] == "1":
        section.remark("This machine has one processor: two threads cannot be faster than one.")
    words = f"two threads at least {LEAST_TIMES} times one on designs over {LONG} s"
    section.target(4, words, f"{min(ratios):.2f} times at least", min(ratios) >= LEAST_TIMES)
    return section


if __name__ == "__main__":
    run_alone(__doc__, run)
