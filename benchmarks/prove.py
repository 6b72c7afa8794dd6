"""Both engines on many parts and vises: the chord curves and the paper's algebra must list the same fixtures.

Run by ``make prove``. Prints one line for each part and vise: what either engine lists, in how many fixtures the lists
differ (marginal ones apart: they may be listed or not), what the algebra left undecided, and the seconds of both. The last
line says whether all agree; the exit code is 1 if they do not. ``--quick`` takes a small part of it.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from random import Random
from time import perf_counter

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

import holdfast  # noqa: E402
from fixture_sets import Judge, listed, missing  # noqa: E402
from holdfast import Vise, Workpiece  # noqa: E402
from holdfast.algebra.engine import design_by_algebra  # noqa: E402
from holdfast.files.builtin import builtin_parts  # noqa: E402
from strategies import random_outline  # noqa: E402

RANDOM_PARTS = 200
Case = tuple[str, Workpiece, Vise]


def paper_parts() -> Iterator[Case]:
    """The models of the paper's parts, with one column and with two."""
    for columns in (1, 2):
        for part in builtin_parts():
            yield part.name, holdfast.load(part.name), Vise(pitch=10, columns=columns, peg_radius=3)


def complete_sets() -> Iterator[Case]:
    """Parts and vises of the complete sets found by an independent method."""
    for path in sorted((ROOT / "tests" / "data" / "complete").glob("*.json")):
        truth = json.loads(path.read_text())
        workpiece = Workpiece.from_loops(truth["workpiece"]["name"], truth["workpiece"]["loops"])
        yield path.stem, workpiece, Vise(**truth["vise"])


def random_parts(count: int) -> Iterator[Case]:
    """Random generalized polygons of 3 to 10 faces, with and without holes, in vises of one and two columns."""
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


def compare(name: str, workpiece: Workpiece, vise: Vise) -> tuple[int, int, float, float]:
    """Print one line; return differences, undecided systems and the seconds of both engines."""
    start = perf_counter()
    curves = holdfast.design(workpiece, vise)
    middle = perf_counter()
    algebra = design_by_algebra(workpiece, vise)
    end = perf_counter()
    judge = Judge(workpiece, vise)
    ours, theirs = listed(curves), listed(algebra)
    differences = len(missing(ours, theirs, judge)) + len(missing(theirs, ours, judge))
    undecided = algebra.statistics["undecided"]
    a, b = curves.counts, algebra.counts
    sys.stdout.write(
        f"{name:18} {len(workpiece.faces):5} {vise.columns:3} | {a['I']:6} {a['II']:6} | {b['I']:6} {b['II']:6} | "
        f"{differences:6} {undecided:6} | {middle - start:7.2f} {end - middle:8.2f}\n"
    )
    sys.stdout.flush()
    return differences, undecided, middle - start, end - middle


def main() -> None:
    """Run as a script."""
    quick = "--quick" in sys.argv[1:]
    cases = [*complete_sets(), *paper_parts(), *random_parts(20 if quick else RANDOM_PARTS)]
    if quick:
        cases = [case for case in cases if case[2].columns == 1]
    sys.stdout.write(f"{'part':18} {'faces':>5} {'c':>3} | {'chord curves':>13} | {'algebra':>13} | {'differ':>6} ")
    sys.stdout.write(f"{'undec.':>6} | {'seconds':>7} {'algebra':>8}\n")
    totals = [0.0] * 4
    for case in cases:
        totals = [sum(pair) for pair in zip(totals, compare(*case), strict=True)]
    differences, undecided = int(totals[0]), int(totals[1])
    verdict = "all agree" if differences == undecided == 0 else f"{differences} differ, {undecided} undecided"
    sys.stdout.write(f"{len(cases)} parts and vises, {totals[2]:.0f} s and {totals[3]:.0f} s: {verdict}\n")
    sys.exit(0 if verdict == "all agree" else 1)


if __name__ == "__main__":
    main()
