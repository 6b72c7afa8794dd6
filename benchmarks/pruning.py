"""Target 8: the best K are the first K of all, and how much of the work a search for them leaves unexamined.

The work is counted in simultaneous contacts examined: of a full run, and of the run that keeps the best K.
"""

from __future__ import annotations

from time import perf_counter
from typing import Any

from designs import ROWS, Design, grown, loaded, warm
from report import Column, Section, measured, run_alone

KEPT = (1, 10, 100)
# The only ranking that bounds can be given for.
RANKING = ("closure-margin",)
DESIGNS = (
    *(row.design for row in ROWS if row.design.columns > 1),
    ROWS[10].design,
    grown(ROWS[10].design, 4),
)

COLUMNS = (
    Column("part", 12, right=False),
    Column("pitch", 5),
    Column("columns", 7),
    Column("K", 4),
    Column("same", 5),
    Column("examined", 10),
    Column("of", 10),
    Column("unexamined", 10),
    Column("seconds", 8),
    Column("all s", 8),
)


def compared(part: str, pitch: float, columns: int, peg_radius: float) -> list[dict[str, Any]]:
    """Task: for every K whether the best K are the first K of the full run, contacts examined by both, and seconds."""
    import workhold

    warm()
    workpiece, vise = loaded(part, pitch, columns, peg_radius)
    start = perf_counter()
    everything = workhold.design(workpiece, vise, rank_by=RANKING, threads=1)
    middle = perf_counter()
    outcomes = []
    for kept in KEPT:
        start_best = perf_counter()
        best = workhold.design(workpiece, vise, rank_by=RANKING, best=kept, threads=1)
        seconds = perf_counter() - start_best
        outcomes.append(
            {
                "kept": kept,
                "same": list(best) == list(everything)[:kept],
                "examined": best.statistics["contacts_examined"],
                "all": everything.statistics["contacts_examined"],
                "seconds": seconds,
                "seconds_all": middle - start,
            }
        )
    return outcomes


def measure(design: Design) -> list[dict[str, Any]]:
    """The comparison of a design in a process of its own."""
    arguments = design.part, design.pitch, design.columns, design.peg_radius
    outcomes: list[dict[str, Any]] = measured("pruning.compared", *arguments)
    return outcomes


def run(quick: bool) -> Section:
    """Compare the designs with many fixtures, or the last two."""
    section = Section(
        "pruning", "The best K of a search that leaves out what cannot be among them, one thread", COLUMNS
    )
    section.begin()
    same = True
    shares: list[float] = []
    for design in DESIGNS[-2:-1] if quick else DESIGNS:
        for outcome in measure(design):
            share = 1.0 - outcome["examined"] / outcome["all"]
            same, shares = same and outcome["same"], [*shares, share]
            section.row(
                *design.words,
                str(outcome["kept"]),
                "yes" if outcome["same"] else "no",
                f"{outcome['examined']:,}",
                f"{outcome['all']:,}",
                f"{100 * share:.1f} %",
                f"{outcome['seconds']:.4f}",
                f"{outcome['seconds_all']:.4f}",
            )
    value = f"{'the same' if same else 'not the same'}, {100 * min(shares):.0f} to {100 * max(shares):.0f} % unexamined"
    section.target(
        8, "the best K are the first K of all, and work is left out", value, same and max(shares) > 0.0
    )
    return section


if __name__ == "__main__":
    run_alone(__doc__, run)
