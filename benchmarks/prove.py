"""Both engines on many parts and vises: the chord curves and the paper's algebra must list the same fixtures.

Run by ``make prove``. First prints the paper's Table 2: degrees of the resultants, the paper's and ours. Then one line for
each part and vise: what either engine lists, in how many fixtures the lists differ (marginal ones apart: they may be listed
or not), what either leaves undecided, and the seconds of both, on one processor each. The last line says whether all agree;
the exit code is 1 if they do not. ``--quick`` takes a small part of it, ``--processes`` says how many cases run at a time.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from random import Random
from time import perf_counter

from attrs import frozen

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

import workhold  # noqa: E402
from fixture_sets import Judge, Listed, listed, missing, vise_of  # noqa: E402
from strategies import random_outline  # noqa: E402
from workhold import Query, Result, Vise, Workpiece  # noqa: E402
from workhold.algebra import find_fixtures_by_algebra  # noqa: E402
from workhold.algebra.table_two import tabulate_root_counts  # noqa: E402
from workhold.files.part.finding import list_builtin_parts  # noqa: E402
from workhold.model.notes import MoreSystems, UndecidedSystem  # noqa: E402

RANDOM_PARTS = 200
# Differing fixtures shown of each case.
MOST_SHOWN = 5

Case = tuple[str, Workpiece, Vise]


def paper_parts() -> Iterator[Case]:
    """The models of the paper's parts, with one column and with two."""
    for columns in (1, 2):
        for part in list_builtin_parts():
            yield part.name, workhold.load(part.name), Vise(pitch=10, columns=columns, peg_radius=3)


def complete_sets() -> Iterator[Case]:
    """Parts and vises of the complete sets found by an independent method."""
    for path in sorted((ROOT / "tests" / "data" / "complete").glob("*.json")):
        truth = json.loads(path.read_text())
        workpiece = Workpiece.from_loops(truth["workpiece"]["name"], truth["workpiece"]["loops"])
        yield path.stem, workpiece, vise_of(truth)


def random_parts(count: int) -> Iterator[Case]:
    """Random generalized polygons of 3 to 10 sides, with and without holes, in vises of one and two columns."""
    for seed in range(count):
        random = Random(seed)
        workpiece = random_outline(random, 3 + seed % 8)
        pitch = random.choice([12.0, 15.0, 20.0])
        vise = Vise(
            pitch=pitch,
            columns=1 + seed % 2,
            peg_radius=random.choice([0.0, 2.0, 3.5]),
            row_offset=random.choice([0.0, 0.0, pitch / 2, 3.0]),
        )
        yield f"random {seed}", workpiece, vise


@frozen
class Outcome:
    """What came of one case: a line to print, how many fixtures differ, what is undecided, and seconds."""

    line: str
    differences: int
    undecided: int
    seconds: tuple[float, float]


def undecided(result: Result) -> int:
    """How many places of its search an engine leaves undecided."""
    named = () if result.proof is None else result.proof.undecided
    return result.statistics.get("undecided", 0) + len(named)


def described(words: str, fixture: Listed) -> str:
    """One differing fixture."""
    pegs = [f"{p['jaw'][0].upper()}({p['column']},{p['row']}) on {p['segment']}" for p in fixture["pegs"]]
    return (
        f"    {words}: {fixture['type']} {', '.join(pegs)}, {fixture['pose']}, {fixture['jaw_separation']}\n"
    )


def compare(case: Case) -> Outcome:
    """Run both engines on one case."""
    name, workpiece, vise = case
    start = perf_counter()
    curves = workhold.design(workpiece, vise, threads=1)
    middle = perf_counter()
    algebra = find_fixtures_by_algebra(Query(workpiece, vise))
    seconds = middle - start, perf_counter() - middle
    judge = Judge(workpiece, vise)
    ours, theirs = listed(curves), listed(algebra)
    only_ours, only_theirs = missing(theirs, ours, judge), missing(ours, theirs, judge)
    differences = len(only_ours) + len(only_theirs)
    a, b, doubts = curves.counts, algebra.counts, (undecided(curves), undecided(algebra))
    line = (
        f"{name:18} {len(workpiece.faces):5} {vise.columns:3} | {a['I']:6} {a['II']:6} | {b['I']:6} {b['II']:6} | "
        f"{differences:6} {doubts[0]:6} {doubts[1]:6} | {seconds[0]:7.2f} {seconds[1]:8.2f}\n"
    )
    line += "".join(described("only chord curves", fixture) for fixture in only_ours[:MOST_SHOWN])
    line += "".join(described("only algebra", fixture) for fixture in only_theirs[:MOST_SHOWN])
    line += "".join(
        f"    {note}\n" for note in algebra.notes if isinstance(note, UndecidedSystem | MoreSystems)
    )
    return Outcome(line, differences, sum(doubts), seconds)


def print_table_two() -> bool:
    """Print Table 2; whether no resultant has a spurious root and every real root is a pose."""
    rows = tabulate_root_counts(count=100)
    sys.stdout.write(
        "The paper's Table 2: degrees of the resultants in t, and roots of 100 random systems a row\n"
    )
    sys.stdout.write(f"{'type':4} {'arcs':>7} | {'paper':>5} {'ours':>4} {'true':>4} | ")
    sys.stdout.write(f"{'complex roots':>13} {'real':>4} {'poses':>5}\n")
    for row in rows:
        arcs = f"{row.left} | {row.right}" if row.type == "I" else f"{row.left}"
        sys.stdout.write(f"{row.type:4} {arcs:>7} | {row.paper:5} {row.ours:4} {row.general:4} | ")
        sys.stdout.write(f"{row.roots:13} {row.real:4} {row.poses:5}\n")
    good = all(r.ours == r.general and r.roots == r.systems * r.general and r.poses == r.real for r in rows)
    sys.stdout.write(
        f"{'no spurious root, every real root is a pose' if good else 'roots and poses differ'}\n\n"
    )
    return good


def print_comparison(cases: list[Case], processes: int) -> bool:
    """Print a line for each case, in their order, and the verdict; whether all agree."""
    sys.stdout.write(
        f"{'part':18} {'faces':>5} {'c':>3} | {'chord curves':>13} | {'algebra':>13} | {'differ':>6} "
    )
    sys.stdout.write(f"{'undecided':>13} | {'seconds':>7} {'algebra':>8}\n")
    outcomes = []
    # The first design compiles the kernels; every process finds them on disk, and is to use one processor.
    workhold.design(*cases[0][1:])
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        for outcome in pool.imap(compare, cases):
            sys.stdout.write(outcome.line)
            sys.stdout.flush()
            outcomes.append(outcome)
    differences, doubts = sum(o.differences for o in outcomes), sum(o.undecided for o in outcomes)
    ours, theirs = sum(o.seconds[0] for o in outcomes), sum(o.seconds[1] for o in outcomes)
    agree = differences == doubts == 0
    verdict = "all agree" if agree else f"{differences} differ, {doubts} undecided"
    sys.stdout.write(f"{len(cases)} parts and vises, {ours:.0f} s and {theirs:.0f} s: {verdict}\n")
    return agree


def main() -> None:
    """Run as a script."""
    parser = argparse.ArgumentParser(description="Compare both engines on many parts and vises.")
    parser.add_argument("--quick", action="store_true", help="20 random parts, and one column only")
    parser.add_argument("--processes", type=int, default=2, metavar="N", help="cases that run at a time")
    options = parser.parse_args()
    cases = [*complete_sets(), *paper_parts(), *random_parts(20 if options.quick else RANDOM_PARTS)]
    if options.quick:
        cases = [case for case in cases if case[2].columns == 1]
    good = print_table_two()
    sys.exit(0 if print_comparison(cases, options.processes) and good else 1)


if __name__ == "__main__":
    main()
