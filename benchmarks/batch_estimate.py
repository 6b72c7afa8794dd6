"""How long a task of a batch takes, predicted and measured; ``--fit`` tells the constants of ``batch.durations`` instead.

Seconds are those of a processor, so that what else the machine does counts little. Which order is best is reckoned from the
measured times: longest first by the estimate, against the order of the catalogue and against longest first by the truth.
"""

from __future__ import annotations

import sys
from heapq import heapify, heapreplace
from math import log
from time import process_time
from typing import Any

from catalogue import catalogue
from report import Column, Section, run_alone

PRESETS = (
    *("plate-20mm", "plate-25mm", "plate-half-inch", "table-50mm", "gripper-two-columns"),
    *("clamp-plate-20mm", "clamp-plate-one-inch", "fence-20mm", "two-clamp-plate-20mm"),
)
LENGTH, QUICK_LENGTH = 32, 6
# Searches for two clamps take so long that only every so many-th part is one.
EVERY = {"two-clamp-plate-20mm": 4}
# Workers of a shop's machine, of a room of them, and of a cluster.
WORKERS = (2, 16, 64)

COLUMNS = (
    Column("searches", 12, right=False),
    Column("tasks", 6),
    Column("measured s", 11),
    Column("predicted s", 11),
    Column("rank correlation", 16),
    Column("within 2 times", 14),
    Column("within 4 times", 14),
)


def run(quick: bool) -> Section:
    """Measure a catalogue in presets of every kind, and hold the estimate against it."""
    section = Section("batch-estimate", "How long a task takes: the estimate and the truth", COLUMNS).begin()
    runs = measured_runs(QUICK_LENGTH if quick else LENGTH, PRESETS[::3] if quick else PRESETS)
    laws = sorted({law for law, *_ in runs})
    for name in (*laws, "all"):
        pairs = [(seconds, estimate) for law, _, _, seconds, estimate in runs if name in (law, "all")]
        off = [abs(log(estimate / seconds)) for seconds, estimate in pairs]
        shares = (f"{sum(one <= log(times) for one in off) / len(off):.0%}" for times in (2, 4))
        sums = (f"{sum(column):.1f}" for column in zip(*pairs, strict=True))
        section.row(name, str(len(pairs)), *sums, f"{rank_correlation(pairs):.2f}", *shares)
    seconds, estimates = [one[3] for one in runs], [one[4] for one in runs]
    for workers in WORKERS[: 1 if quick else None]:
        least = max(sum(seconds) / workers, max(seconds))
        ways = {
            "longest first by the estimate": ordered(seconds, estimates),
            "by the truth": ordered(seconds, seconds),
            "in the order of the catalogue": seconds,
        }
        told = ", ".join(f"{words} {makespan(order, workers) / least:.2f}" for words, order in ways.items())
        section.remark(f"On {workers} workers, times the least that any order could take: {told}.")
    section.data["seconds"] = [round(one, 4) for one in seconds]
    return section


def measured_runs(length: int, presets: tuple[str, ...]) -> list[tuple[str, float, float, float, float]]:
    """The law, logarithms of faces and steps, seconds measured and predicted of every part in every toolkit."""
    from workhold.batch.durations import compute_measures, predict_answering_seconds
    from workhold.batch.run import ANY_PART
    from workhold.batch.store import make_part_record
    from workhold.batch.tasks import QueryTask, run_task
    from workhold.files.toolkit_file import load_toolkit
    from workhold.model.query import Query

    runs = []
    for number, part in enumerate(catalogue(length)):
        record = make_part_record(part, ())
        x0, y0, x1, y1 = part.bounds
        for name in presets:
            if number % EVERY.get(name, 1):
                continue
            vise = load_toolkit(name)
            task = QueryTask("", "", record, Query(ANY_PART, vise.toolkit, tolerance=vise.tolerance), 10)
            if not runs:
                run_task(task)
            start = process_time()
            outcome = run_task(task)
            assert not outcome.failure, outcome.failure
            about = len(part.faces), (x1 - x0, y1 - y0), vise.toolkit
            runs.append(
                (*compute_measures(*about), process_time() - start, predict_answering_seconds(*about))
            )
    return runs


def rank_correlation(pairs: list[tuple[float, float]]) -> float:
    """Spearman's."""
    import numpy as np

    ranks = np.argsort(np.argsort(np.array(pairs), axis=0), axis=0)
    return float(np.corrcoef(ranks.T)[0, 1])


def ordered(seconds: list[float], keys: list[float]) -> list[float]:
    """Seconds of tasks, those with the largest key first."""
    return [seconds[k] for k in sorted(range(len(seconds)), key=keys.__getitem__, reverse=True)]


def makespan(seconds: list[float], workers: int) -> float:
    """When the last task is done, each given to the worker that is free first."""
    free = [0.0] * workers
    heapify(free)
    for one in seconds:
        heapreplace(free, free[0] + one)
    return max(free)


def fit(runs: list[tuple[str, float, float, float, float]]) -> dict[str, tuple[float, float, float]]:
    """The constants of each law, by least squares of logarithms; the constant so that the sums of seconds agree."""
    import numpy as np

    laws: dict[str, tuple[float, float, float]] = {}
    for name in sorted({law for law, *_ in runs}):
        rows: Any = np.array([one[1:4] for one in runs if one[0] == name])
        of_faces, of_steps, seconds = rows.T
        columns = np.column_stack([np.ones(len(rows)), of_faces, of_steps])
        constant, first, second = np.linalg.lstsq(columns, np.log(seconds), rcond=None)[0]
        predicted = np.exp(constant + first * of_faces + second * of_steps)
        laws[name] = (constant + log(seconds.sum() / predicted.sum()), first, second)
    return {name: tuple(round(float(number), 2) for number in law) for name, law in laws.items()}  # type: ignore[misc]


if __name__ == "__main__":
    if "--fit" in sys.argv:
        for law, numbers in fit(measured_runs(LENGTH, PRESETS)).items():
            sys.stdout.write(f'    "{law}": {numbers},\n')
    else:
        run_alone(__doc__, run)
