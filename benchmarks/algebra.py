"""Target 6: against the paper's own way on this machine, by its polynomials (``--engine algebra``), on one thread.

Every row runs in a process of its own and is given up after a budget of seconds (``--budget``). The polynomial step is
what that engine spends on resultants and their roots alone: no choice of faces and holes, no test of what was found.
"""

from __future__ import annotations

from time import perf_counter, process_time
from typing import Any

from designs import ROWS, loaded, timed
from report import Column, Section, measured, run_alone

BUDGET, QUICK_BUDGET = 600.0, 30.0

COLUMNS = (
    Column("part", 12, right=False),
    Column("pitch", 5),
    Column("columns", 7),
    Column("systems", 10),
    Column("polynomials s", 13),
    Column("us a system", 11),
    Column("algebra s", 9),
    Column("curves s", 8),
    Column("ratio", 8),
    Column("same counts", 11),
)


def algebra_seconds(part: str, pitch: float, columns: int, peg_radius: float) -> dict[str, Any]:
    """Task: counts and seconds of a design by algebra, and the seconds of its polynomial step."""
    return algebra_result(part, pitch, columns, peg_radius)[1]


def algebra_result(part: str, pitch: float, columns: int, peg_radius: float) -> tuple[Any, dict[str, Any]]:
    """A design by algebra, with what :func:`algebra_seconds` tells of it."""
    from workhold import Query
    from workhold.algebra import engine

    solve, spent = vars(engine)["find_candidate_orientations"], [0.0, 0.0]

    def orientations(*arguments: Any) -> Any:
        """Orientations of systems, with the time they take."""
        begun, before = perf_counter(), process_time()
        outcome = solve(*arguments)
        spent[0] += perf_counter() - begun
        spent[1] += process_time() - before
        return outcome

    vars(engine)["find_candidate_orientations"] = orientations
    workpiece, vise = loaded(part, pitch, columns, peg_radius)
    start, before = perf_counter(), process_time()
    result = engine.find_fixtures_by_algebra(Query(workpiece, vise))
    seconds, processor = perf_counter() - start, process_time() - before
    vars(engine)["find_candidate_orientations"] = solve
    return result, {
        "found": dict(result.found),
        "systems": result.statistics["systems"],
        "seconds": seconds,
        "polynomials": spent[0],
        "processor": processor,
        "polynomials_processor": spent[1],
    }


def run(quick: bool, budget: float | None = None) -> Section:
    """Measure every row that the engine finishes within the budget; the rows with one column, in a quick trial."""
    budget = budget or (QUICK_BUDGET if quick else BUDGET)
    section = Section(
        "algebra", f"Against the paper's algebra, given up after {budget:g} s a row", COLUMNS
    ).begin()
    ratios, agree = [], True
    for row in ROWS:
        design = row.design
        if quick and design.columns > 1:
            continue
        arguments = design.part, design.pitch, design.columns, design.peg_radius
        theirs = measured("algebra.algebra_seconds", *arguments, limit=budget, OPENBLAS_NUM_THREADS="1")
        ours = timed(design)
        if theirs is None:
            least = f"{budget / ours['seconds']:,.0f}"
            section.row(
                *design.words, "", "", "", f"> {budget:g}", f"{ours['seconds']:.4f}", f"> {least}", ""
            )
            continue
        same = theirs["found"] == ours["found"]
        ratios.append(theirs["seconds"] / ours["seconds"])
        agree = agree and same
        section.row(
            *design.words,
            f"{theirs['systems']:,}",
            f"{theirs['polynomials']:.2f}",
            f"{1e6 * theirs['polynomials'] / max(theirs['systems'], 1):.1f}",
            f"{theirs['seconds']:.2f}",
            f"{ours['seconds']:.4f}",
            f"{ratios[-1]:,.0f}",
            "yes" if same else "no",
        )
    words = f"the ratio to the paper's algebra on the rows it finishes in {budget:g} s, with the same counts"
    value = (
        f"{len(ratios)} rows, {min(ratios):,.0f} to {max(ratios):,.0f} times faster"
        if ratios
        else "no row finished"
    )
    section.target(6, words, value, bool(ratios) and agree)
    return section


if __name__ == "__main__":
    run_alone(__doc__, run, budget="give a row up after so many seconds")
