"""The twelve rows of Table 1 of Wallack and Canny (1996): our counts, time and memory beside theirs.

The parts are models of the paper's, whose dimensions were never published, so counts can only be of the same order.
Every row runs in a process of its own, so that its memory is its own; the seconds are those of the search alone, with
kernels compiled and loaded. With ``--unproven``, also what the proof costs: the same code with the errors of chords and
crossings set to zero and candidates taken at their word, measured beside the proven run. With ``--first-run``, also how long
a first run takes, compilation included.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
from time import perf_counter

PEG_RADIUS = 3
# Part, pitch in mm, columns; the paper's counts of type I and II and its seconds.
ROWS = (
    ("thin4Handle", 10, 1, 208, 4, 792),
    ("8Handle", 10, 1, 36, 0, 356),
    ("small4Handle", 10, 1, 14, 0, 395),
    ("small4Handle", 10, 10, 88, 123, 9195),
    ("large4Handle", 10, 1, 40, 5, 949),
    ("large4Handle", 10, 10, 492, 572, 38968),
    ("oblongPart", 10, 1, 26, 0, 112),
    ("oblongPart", 10, 10, 280, 198, 4217),
    ("oblongPart", 8, 10, 801, 278, 13896),
    ("widget", 10, 1, 305, 62, 8644),
    ("widget", 8, 1, 636, 124, 8896),
    ("flange", 10, 1, 60, 1, 1742),
)


def without_proof() -> None:
    """Take the proof out of the search of this process, before its kernels are compiled."""
    import numpy as np

    from holdfast.kernels import certifying, chord, contacts, crossing
    from holdfast.kernels.compiling import compiled
    from holdfast.listing import deciding, finish

    for module in (chord, crossing):
        module.ROUNDINGS = 0.0

    @compiled
    def kept(records: np.ndarray, features: np.ndarray, setting: np.ndarray) -> np.ndarray:
        """Which records keep all rules at their middles, polished in place."""
        out = np.zeros(len(records), np.bool_)
        w, pairs, null = np.empty((contacts.WORK_LENGTH, 4)), np.empty((2, 4, 2)), np.empty(4)
        for n in range(len(records)):
            contacts.take_pegs(records[n], setting, w)
            certifying.polish(records[n], features, setting[contacts.WRENCH_LENGTH], w, pairs[0])
            out[n] = certifying.judged(records[n], features, setting, 0.0, np.inf, w, pairs, null) == certifying.PROVEN
            for k in range(4):
                records[n, 13 + k] = w[contacts.UNKNOWNS, k]
        return out

    def taken(
        records: np.ndarray, problem: deciding.Problem, _: deciding.Course
    ) -> tuple[np.ndarray, deciding.Account]:
        """Polished records whose middles keep all rules."""
        records = records[records[:, 0] > 0.0]
        chosen = records[kept(records, problem.rows, deciding.setting_of(problem))]
        return chosen, deciding.Account(len(records), len(chosen), 0, 0, ())

    finish.decided = taken


def measure(part: str, pitch: float, columns: int, warm: bool = True, proven: bool = True) -> dict[str, float]:
    """Counts, seconds and peak memory in MiB of one design in this process."""
    import holdfast

    if not proven:
        without_proof()
    if warm:
        holdfast.design(holdfast.load("oblongPart"), holdfast.Vise(pitch=10, columns=1, peg_radius=PEG_RADIUS))
    workpiece = holdfast.load(part)
    start = perf_counter()
    result = holdfast.design(workpiece, holdfast.Vise(pitch=pitch, columns=columns, peg_radius=PEG_RADIUS))
    seconds = perf_counter() - start
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {**result.counts, "seconds": seconds, "memory": memory}


def apart(
    part: str, pitch: float, columns: int, warm: bool = True, proven: bool = True, **environment: str
) -> dict[str, float]:
    """Measure one design in a process of its own."""
    command = [sys.executable, __file__, "--measure", part, str(pitch), str(columns), str(int(warm)), str(int(proven))]
    done = subprocess.run(command, stdout=subprocess.PIPE, check=True, text=True, env={**os.environ, **environment})
    figures: dict[str, float] = json.loads(done.stdout)
    return figures


def table() -> None:
    """Print the table row by row."""
    say = sys.stdout.write
    say(f"{'':12} {'':>5} {'':>3} | {'holdfast':^33} | {'paper':^22} |\n")
    say(f"{'part':12} {'pitch':>5} {'c':>3} | {'I':>6} {'II':>6} {'seconds':>8} {'MiB':>6}    | ")
    say(f"{'I':>5} {'II':>5} {'seconds':>8}   | times faster\n")
    total, paper_total = 0.0, 0
    for part, pitch, columns, type_one, type_two, paper_seconds in ROWS:
        ours = apart(part, pitch, columns)
        total, paper_total = total + ours["seconds"], paper_total + paper_seconds
        say(f"{part:12} {pitch:5} {columns:3} | {ours['I']:6} {ours['II']:6} ")
        say(f"{ours['seconds']:8.2f} {ours['memory']:6.0f}    | {type_one:5} {type_two:5} {paper_seconds:8}   | ")
        say(f"{paper_seconds / ours['seconds']:12,.0f}\n")
        sys.stdout.flush()
    say(f"{'together':12} {'':5} {'':3} | {'':6} {'':6} {total:8.2f} {'':6}    | {'':5} {'':5} {paper_total:8}   | ")
    say(f"{paper_total / total:12,.0f}\n")


def cost_of_proof() -> None:
    """Print what the proof costs, row by row: best of two proven and two unproven runs, in turn."""
    say = sys.stdout.write
    say(
        f"\n{'part':12} {'pitch':>5} {'c':>3} | {'unproven':>8} {'proven':>8} {'ratio':>6} | {'I':>6} {'II':>6} unproven\n"
    )
    totals = [0.0, 0.0]
    with tempfile.TemporaryDirectory() as folder:
        apart("oblongPart", 10, 1, proven=False, HOLDFAST_CACHE_DIR=folder)
        for part, pitch, columns, *_ in ROWS:
            plain, proven = [], []
            for _ in range(2):
                plain.append(apart(part, pitch, columns, proven=False, HOLDFAST_CACHE_DIR=folder))
                proven.append(apart(part, pitch, columns))
            best = [min(run["seconds"] for run in runs) for runs in (plain, proven)]
            totals = [total + seconds for total, seconds in zip(totals, best, strict=True)]
            say(f"{part:12} {pitch:5} {columns:3} | {best[0]:8.2f} {best[1]:8.2f} {best[1] / best[0]:6.2f} | ")
            say(f"{plain[0]['I']:6} {plain[0]['II']:6}\n")
            sys.stdout.flush()
    say(f"{'together':12} {'':5} {'':3} | {totals[0]:8.2f} {totals[1]:8.2f} {totals[1] / totals[0]:6.2f} |\n")


def main() -> None:
    """Run as a script."""
    if sys.argv[1:2] == ["--measure"]:
        part, pitch, columns, warm, proven = sys.argv[2:]
        sys.stdout.write(json.dumps(measure(part, float(pitch), int(columns), warm == "1", proven == "1")))
        return
    table()
    if "--unproven" in sys.argv[1:]:
        cost_of_proof()
    if "--first-run" in sys.argv[1:]:
        with tempfile.TemporaryDirectory() as folder:
            first = apart("oblongPart", 10, 1, warm=False, HOLDFAST_CACHE_DIR=folder)
        sys.stdout.write(f"first run, kernels compiled: {first['seconds']:.1f} s\n")


if __name__ == "__main__":
    main()
