"""Designs to measure: the rows of the paper's Table 1, parts that grow against the pitch, and the tasks that time them."""

from __future__ import annotations

from math import inf
from time import perf_counter, process_time
from typing import Any

from attrs import asdict, evolve, frozen

from report import measured

__all__ = [
    "LARGE",
    "PEG_RADIUS",
    "ROWS",
    "Design",
    "PaperRow",
    "counted",
    "grown",
    "larger_rows",
    "loaded",
    "timed",
    "warm",
]

PEG_RADIUS = 3.0
# A design is run again while all runs together took less than this many seconds, but not more often than this.
ENOUGH_SECONDS, ENOUGH_RUNS = 2.0, 5
# The larger rows have more simultaneous contacts than this.
LARGE = 40_000


@frozen
class Design:
    """A part, by built-in name or file, and a vise: pitch and peg radius in mm."""

    part: str
    pitch: float
    columns: int
    peg_radius: float = PEG_RADIUS

    @property
    def words(self) -> tuple[str, str, str]:
        """Part, pitch and columns for a table."""
        return self.part, f"{self.pitch:g}", str(self.columns)


@frozen
class PaperRow:
    """A row of Table 1: the design, and the paper's counts of type I and II and its seconds."""

    design: Design
    type_one: int
    type_two: int
    seconds: int


ROWS = (
    PaperRow(Design("thin4Handle", 10, 1), 208, 4, 792),
    PaperRow(Design("8Handle", 10, 1), 36, 0, 356),
    PaperRow(Design("small4Handle", 10, 1), 14, 0, 395),
    PaperRow(Design("small4Handle", 10, 10), 88, 123, 9195),
    PaperRow(Design("large4Handle", 10, 1), 40, 5, 949),
    PaperRow(Design("large4Handle", 10, 10), 492, 572, 38968),
    PaperRow(Design("oblongPart", 10, 1), 26, 0, 112),
    PaperRow(Design("oblongPart", 10, 10), 280, 198, 4217),
    PaperRow(Design("oblongPart", 8, 10), 801, 278, 13896),
    PaperRow(Design("widget", 10, 1), 305, 62, 8644),
    PaperRow(Design("widget", 8, 1), 636, 124, 8896),
    PaperRow(Design("flange", 10, 1), 60, 1, 1742),
)


def grown(design: Design, times: int) -> Design:
    """The part grown against the pitch: pitch and pegs made so many times smaller, which counts the same."""
    return evolve(design, pitch=design.pitch / times, peg_radius=design.peg_radius / times)


def timed(design: Design, threads: int = 1, best: int | None = None) -> dict[str, Any]:
    """Counts, seconds, statistics and memory of a design in a process of its own (see :func:`design_seconds`)."""
    arguments = design.part, design.pitch, design.columns, design.peg_radius, threads, best
    outcome: dict[str, Any] = measured("designs.design_seconds", *arguments)
    return outcome


def counted(design: Design) -> int:
    """Simultaneous contacts A of a design, counted in a process of its own."""
    outcome: int = measured(
        "designs.contact_count", design.part, design.pitch, design.columns, design.peg_radius
    )
    return outcome


def larger_rows(quick: bool) -> list[tuple[Design, int]]:
    """The larger rows of Table 1 with their simultaneous contacts; the first such row only in a quick trial."""
    found = []
    # Rows of one column have far fewer.
    for design in (row.design for row in ROWS if row.design.columns > 1):
        contacts = counted(design)
        if contacts > LARGE:
            found.append((design, contacts))
        if quick and found:
            break
    return found


def loaded(part: str, pitch: float, columns: int, peg_radius: float) -> tuple[Any, Any]:
    """Workpiece and vise."""
    import workhold

    return workhold.load(part), workhold.Vise(pitch=pitch, columns=columns, peg_radius=peg_radius)


def warm() -> None:
    """Load all kernels, compiling them where that has not been done."""
    import workhold

    workhold.design(*loaded("oblongPart", 10, 1, PEG_RADIUS), threads=1)


def contact_count(part: str, pitch: float, columns: int, peg_radius: float) -> int:
    """Task: simultaneous contacts, all four inside their features, before closure, jaw order and clamping."""
    from workhold.search.toolkit_search import count_contacts

    return count_contacts(*loaded(part, pitch, columns, peg_radius))


def design_seconds(
    part: str, pitch: float, columns: int, peg_radius: float, threads: int, best: int | None
) -> dict[str, Any]:
    """Task: a proven design, its kernels compiled and loaded.

    Returns
    -------
    counts of types I and II found and listed, statistics, undecided candidates, the account of the proof, and the seconds
    of the fastest of up to five runs (one, where a run takes more than two seconds), each from a part loaded anew to the
    finished result; beside them the least seconds of the processor, which what else the machine does changes little.
    """
    import workhold

    warm()
    fastest, least, spent, runs = inf, inf, 0.0, 0
    while runs == 0 or (runs < ENOUGH_RUNS and spent < ENOUGH_SECONDS):
        workpiece, vise = loaded(part, pitch, columns, peg_radius)
        start, before = perf_counter(), process_time()
        # Only the closure margin is bounded, so only a ranking by it leaves work out.
        rank_by = None if best is None else ["closure-margin"]
        result = workhold.design(workpiece, vise, rank_by=rank_by, best=best, threads=threads)
        seconds, least = perf_counter() - start, min(least, process_time() - before)
        fastest, spent, runs = min(fastest, seconds), spent + seconds, runs + 1
    proof = {} if result.proof is None else asdict(result.proof)
    proof["undecided"] = len(proof.get("undecided", ()))
    return {
        "found": dict(result.found),
        "listed": len(result),
        "undecided": proof["undecided"],
        "proof": proof,
        "statistics": dict(result.statistics),
        "seconds": fastest,
        "processor": least,
    }
