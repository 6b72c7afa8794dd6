"""Target 11: what it costs to say where else pegs can hold a part, and from how wide open the vise catches it.

A pattern of pegs is solved once for all fixtures on it, both sides of the part. Cage and placing are told of few fixtures
and measured by themselves. Seconds are of two threads for the hundred, and for each pattern those of the processor for one
thread, which what else the machine does changes little. Both are of the fastest of some runs, which solve all anew.
"""

from __future__ import annotations

from math import inf
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

from report import Column, Section, measured, run_alone

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"
NOTCH = [
    [[0, 0, 0], [70, 0, 0], [70, 22, 0], [40, 26, 0], [30, 55, 0], [0, 55, 0]],
    [[30, 12, -1], [14, 12, -1]],
]
# Name, pitch, columns, peg radius.
PARTS = (("widget", 8, 2, 2), ("notch", 10, 2, 3), ("oblongPart", 10, 2, 3), ("bracket", 10, 2, 3))
MOST_MILLISECONDS, MOST_SECONDS = 10.0, 2.0
FEW, MANY = 5, 100
RUNS = 3

COLUMNS = (
    Column("part", 12, right=False),
    Column("pitch", 6),
    Column("patterns", 8),
    Column("seats", 6),
    Column("ms a pattern", 12),
    Column("ms cage and placing", 19),
    Column("best 100 s", 10),
)


def run(quick: bool) -> Section:
    """Measure the patterns of each part's best fixtures."""
    section = Section("seating", "Where a part ends up", COLUMNS).begin()
    worst = hundred = 0.0
    for part in PARTS[2:3] if quick else PARTS:
        outcome = measured("seating.seconds", *part, FEW if quick else MANY)
        each = 1e3 * outcome["alone"] / outcome["patterns"]
        worst, hundred = max(worst, each), outcome["together"]
        numbers = f"{part[1]}", f"{outcome['patterns']}", f"{outcome['seats']:.0f}", f"{each:.1f}"
        section.row(part[0], *numbers, f"{1e3 * outcome['cage']:.0f}", f"{hundred:.2f}")
    section.target(
        11,
        f"a pattern of an ordinary part in under {MOST_MILLISECONDS:g} ms",
        f"{worst:.1f} ms at most",
        worst < MOST_MILLISECONDS,
    )
    if not quick:
        words = f"the best {MANY} of a bracket with seating, without cage and placing, in under {MOST_SECONDS:g} s"
        section.target(11, words, f"{hundred:.2f} s", hundred < MOST_SECONDS)
    return section


def seconds(name: str, pitch: float, columns: int, peg_radius: float, many: int) -> dict[str, Any]:
    """Task: the best fixtures' seatings, kernels compiled and loaded: the processor's seconds of one thread, seconds of two,
    those of cage and placing of one fixture, the number of patterns and of seats on average."""
    import workhold
    from workhold.seating.solver import SeatingSolver

    part = workhold.Workpiece.from_loops(name, NOTCH) if name == "notch" else workhold.load(source(name))
    vise = workhold.Vise(pitch=pitch, columns=columns, peg_radius=peg_radius)
    fixtures = list(workhold.design(part, vise, best=many))
    SeatingSolver(part, vise).solve(fixtures[0])
    out: dict[str, Any] = {}
    for key, threads, clock in (("alone", 1, process_time), ("together", 2, perf_counter)) * RUNS:
        solver = SeatingSolver(part, vise)
        start = clock()
        told = solver.solve_all(fixtures, False, threads)
        out[key] = min(clock() - start, out.get(key, inf))
    start = perf_counter()
    for fixture in fixtures[:FEW]:
        solver.solve(fixture)
    cage = (perf_counter() - start) / len(fixtures[:FEW])
    return {
        **out,
        "cage": cage,
        "patterns": len(solver.solved),
        "seats": sum(len(one.seats) for one in told) / len(told),
    }


def source(name: str) -> str:
    """What a part is loaded from: its built-in name, or an example's file."""
    drawing = EXAMPLES / f"{name}.dxf"
    return str(drawing) if drawing.exists() else name


if __name__ == "__main__":
    run_alone(__doc__, run)
