"""Target 5: whole processes, as a person at a terminal waits for them; and the demo's part in processor time.

Each is run several times and judged by the median, with the kernels of the wheel where it is installed. The first run on a
machine is the first with an empty cache folder; where kernels are compiled on first use, that is part of it.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median
from time import perf_counter

from report import Column, Section, child_environment, run_alone
from terminal import WORKHOLD, watch

DESIGN = [*WORKHOLD, "design", "widget", "--pitch", "8", "--columns", "1", "--peg-radius", "3", "--out"]
RUNS = 7
BRACKET = str(Path(__file__).parent.parent / "examples" / "bracket.dxf")
DEMO = [*WORKHOLD, "design", BRACKET, "--pitch", "10", "--columns", "2", "--peg-radius", "3", "--out"]
FIRST_ANSWER = 1.0
# Of the processor, for the demo's part from the drawing to the file.
DEMO_SECONDS = 1.0
FIRST_RUN = 30.0
WORD = "first run"

COLUMNS = (
    Column("process", 42, right=False),
    Column("fastest s", 9),
    Column("median s", 8),
    Column("at most s", 9),
)


def process_seconds(command: list[str], runs: int) -> list[float]:
    """Seconds of each of some runs of a command, in increasing order; one more run before them is not counted."""
    seconds = []
    for _ in range(runs + 1):
        start = perf_counter()
        subprocess.run(command, stdout=subprocess.DEVNULL, check=True, env=child_environment())
        seconds.append(perf_counter() - start)
    return sorted(seconds[1:])


def processor_seconds(command: list[str], runs: int) -> float:
    """The median of the processor's seconds, of the user and of the system, that a command takes."""
    taken = []
    for _ in range(runs):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, stdout=subprocess.DEVNULL, check=True, env=child_environment())
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        taken.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return median(taken)


def run(quick: bool) -> Section:
    """Measure the processes; a quick trial leaves out first runs on a machine."""
    section = Section("processes", "Whole processes", COLUMNS).begin()
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "r.json")
        for name, command, limit in (
            ("design widget, pitch 8, run before", [*DESIGN, out, "--force"], 0.35),
            ("workhold --help", [*WORKHOLD, "--help"], 0.1),
            ("import workhold", [sys.executable, "-c", "import workhold"], 0.15),
        ):
            seconds = process_seconds(command, 3 if quick else RUNS)
            middle = median(seconds)
            section.row(name, f"{seconds[0]:.3f}", f"{middle:.3f}", f"{limit:g}")
            section.target(5, f"{name} under {limit:g} s", f"{middle:.3f} s", middle < limit)
        spent = processor_seconds([*DEMO, out, "--force"], 3 if quick else RUNS)
        name = "the demo's part, processor time"
        section.row(name, "", f"{spent:.3f}", f"{DEMO_SECONDS:g}")
        section.target(5, f"{name}, under {DEMO_SECONDS:g} s", f"{spent:.3f} s", spent < DEMO_SECONDS)
        if not quick:
            cache = str(Path(folder) / "cache")
            first = watch([*DESIGN, out, "--force"], WORKHOLD_CACHE_DIR=cache)
            name = "the first run on a machine, from the wheel"
            if WORD in first.shown:
                section.remark("The wheel is not installed here, so its first run is not measured.")
            else:
                section.row(name, f"{first.seconds:.2f}", f"{first.seconds:.2f}", f"{FIRST_ANSWER:g}")
                met = first.seconds < FIRST_ANSWER and first.code == 0
                section.target(5, f"{name} under {FIRST_ANSWER:g} s", f"{first.seconds:.2f} s", met)
            compiling = watch([*DESIGN, out, "--force"], WORKHOLD_CACHE_DIR=cache, WORKHOLD_KERNELS="cache")
            is_told = WORD in compiling.shown
            told = (
                f"the user is told after {compiling.first_shown:.1f} s" if is_told else "the user is not told"
            )
            name = "the first run, compiling on first use"
            section.row(name, f"{compiling.seconds:.1f}", f"{compiling.seconds:.1f}", f"{FIRST_RUN:g}")
            section.target(
                5,
                f"{name} under {FIRST_RUN:g} s, with a word to the user",
                f"{compiling.seconds:.1f} s, {told}",
                compiling.seconds < FIRST_RUN and is_told and compiling.code == 0,
            )
    return section


if __name__ == "__main__":
    run_alone(__doc__, run)
