"""All benchmarks one after the other, their targets with ``pass`` or ``short``, and docs/benchmarks.md from the figures.

Run by ``make bench``, on a machine with nothing else to do. The longest parts are the rows given to the paper's algebra,
up to ten minutes each (``--budget``). ``--quick`` tries a small part of everything and keeps no figures.
"""

from __future__ import annotations

import argparse
import sys

import algebra
import batch
import batch_estimate
import batch_queue
import batch_simulation
import floor
import growth
import in_space
import large
import many
import memory
import processes
import program
import pruning
import seating
import solids
import survey
import table_one
import threads
import toolkits
from page import write_page
from report import Section, machine


def main() -> None:
    """Run as a script."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument(
        "--quick", action="store_true", help="a small part of everything; no figures are kept"
    )
    parser.add_argument(
        "--budget", type=float, metavar="SECONDS", help="seconds for each row of the paper's algebra"
    )
    parser.add_argument(
        "--only",
        metavar="MODULE",
        help="one module of the benchmarks, such as large; the others keep their figures",
    )
    options = parser.parse_args()
    for key, value in machine().items():
        sys.stdout.write(f"{key}: {value}\n")
    sections: list[Section] = []
    for run in (
        table_one.run,
        growth.run,
        floor.run,
        threads.run,
        processes.run,
        lambda quick: algebra.run(quick, options.budget),
        memory.run,
        many.run,
        large.run,
        toolkits.run,
        survey.run,
        pruning.run,
        seating.run,
        solids.run,
        in_space.run,
        program.run,
        batch.run,
        batch_queue.run,
        batch_estimate.run,
        batch_simulation.run,
    ):
        if options.only not in (None, getattr(run, "__module__", None)):
            continue
        sections.append(run(options.quick))
        if not options.quick:
            sections[-1].keep()
    sys.stdout.write("\nAll targets\n\n")
    targets = [target for section in sections for target in section.targets]
    for target in sorted(targets, key=lambda target: target.number):
        sys.stdout.write(f"target {target.number}  {target.verdict:5}  {target.words}: {target.value}\n")
    if not options.quick:
        write_page()


if __name__ == "__main__":
    main()
