"""Target 2: what a simultaneous contact costs, and how time grows with their number A when the part grows.

A part that grows against the pitch is the same as a pitch that shrinks with its pegs, which is how it is done here: all
pegs still fit into their holes. The exponent is the slope of a straight line through log time against log A, by least
squares. The largest design would list some ten million fixtures; it keeps the best thousand, so that memory stays what it
is. What pruning leaves unexamined then makes it faster, so the exponent is given without that design as well, and both
must meet the target.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from designs import LARGE, Design, counted, grown, larger_rows, timed
from report import Column, Section, run_alone

MOST_NANOSECONDS = 500.0
MOST_EXPONENT = 1.08
LARGEST = 100_000_000
GROWING = Design("widget", 8, 5)
# More fixtures than fit into memory comfortably are not kept.
MOST_CONTACTS_LISTED = 30_000_000
BEST = 1000
TIMES = (1, 2, 4, 8)

COLUMNS = (
    Column("part", 12, right=False),
    Column("pitch", 6),
    Column("columns", 7),
    Column("times", 5),
    Column("listed", 10),
    Column("contacts A", 12),
    Column("seconds", 9),
    Column("ns each", 8),
)


def exponent(points: list[dict[str, Any]]) -> float:
    """Slope of log time against log A by least squares."""
    logs = np.log([[point["contacts"], point["seconds"]] for point in points])
    return float(np.polyfit(logs[:, 0], logs[:, 1], 1)[0])


def measure(section: Section, design: Design, times: int, contacts: int) -> dict[str, Any]:
    """Measure one design and tell its row; a point of the plot."""
    best = BEST if contacts > MOST_CONTACTS_LISTED else None
    outcome = timed(design, best=best)
    each = 1e9 * outcome["seconds"] / contacts
    listed = "all" if best is None else f"best {best:,}"
    numbers = f"{contacts:,}", f"{outcome['seconds']:.3f}", f"{each:.0f}"
    section.row(*design.words, str(times), listed, *numbers)
    return {"contacts": contacts, "seconds": outcome["seconds"], "each": each, "all": best is None}


def run(quick: bool) -> Section:
    """Measure the larger rows of Table 1, then the part as it grows."""
    section = Section("growth", "Cost of a simultaneous contact, one thread", COLUMNS).begin()
    larger = [measure(section, design, 1, contacts) for design, contacts in larger_rows(quick)]
    points = []
    for times in TIMES[:2] if quick else TIMES:
        design = grown(GROWING, times)
        points.append(measure(section, design, times, counted(design)))
    section.data |= {"points": points, "part": GROWING.part}
    worst = max(point["each"] for point in larger)
    words = f"at most {MOST_NANOSECONDS:g} ns a contact on rows with more than {LARGE:,}"
    section.target(2, words, f"{worst:.0f} ns at most", worst <= MOST_NANOSECONDS)
    exponents = [exponent(points)]
    unpruned = [point for point in points if point["all"]]
    if 1 < len(unpruned) < len(points):
        exponents.append(exponent(unpruned))
    steepest = max(exponent(list(pair)) for pair in pairwise(points))
    most = max(point["contacts"] for point in points)
    section.data["exponent"] = max(exponents)
    value = f"A^{exponents[0]:.3f}" + "".join(f", A^{e:.3f} without pruned designs" for e in exponents[1:])
    section.target(
        2,
        f"time grows no faster than A^{MOST_EXPONENT} up to {LARGEST:,} contacts",
        f"{value}, the steepest step A^{steepest:.3f}, up to {most:,}",
        max(exponents) <= MOST_EXPONENT and most >= LARGEST,
    )
    return section


if __name__ == "__main__":
    run_alone(__doc__, run)
