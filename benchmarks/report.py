"""What the benchmarks share: measuring in processes of their own, tables, targets that pass or fall short, figures kept.

Glossary
--------
target : a number the project sets itself; ``pass`` when it is met, ``short`` when it is not.
section : one benchmark's table, targets and remarks; printed as they come, and kept for docs/benchmarks.md.
task : a function of a benchmark, named ``module.function``, that is called in a process of its own and whose outcome JSON
    can hold.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from attrs import asdict, define, field, frozen

__all__ = ["Column", "Section", "Target", "kept_figures", "machine", "measured", "run_alone"]

ROOT = Path(__file__).resolve().parent.parent
FIGURES = ROOT / "docs" / "figures" / "benchmarks.json"
MIB = 1024.0
INTERRUPTED = 130


@frozen
class Column:
    """A column of a table: its heading, its width on the terminal, and whether its content stands on the right."""

    heading: str
    width: int
    right: bool = True

    def fitted(self, words: str) -> str:
        """Words as wide as the column."""
        return f"{words:>{self.width}}" if self.right else f"{words:<{self.width}}"


@frozen
class Target:
    """A target and what was measured of it.

    Parameters
    ----------
    number : the target's number, from 1.
    words : what is asked for.
    value : what was measured, in words.
    met : whether it is met.
    """

    number: int
    words: str
    value: str
    met: bool

    @property
    def verdict(self) -> str:
        """``pass`` or ``short``."""
        return "pass" if self.met else "short"


@define
class Section:
    """One benchmark's outcome, told on stdout as it comes.

    Parameters
    ----------
    name : what it is kept under.
    title : the heading of its table.
    columns : of its table.
    rows, targets, remarks : what was told.
    data : numbers for the plot, by name.
    """

    name: str
    title: str
    columns: tuple[Column, ...]
    rows: list[tuple[str, ...]] = field(factory=list)
    targets: list[Target] = field(factory=list)
    remarks: list[str] = field(factory=list)
    data: dict[str, Any] = field(factory=dict)

    def begin(self) -> Section:
        """Tell the title and the headings."""
        say(f"\n{self.title}\n\n")
        say("  ".join(column.fitted(column.heading) for column in self.columns) + "\n")
        return self

    def row(self, *words: str) -> None:
        """Tell and keep a row of the table."""
        self.rows.append(words)
        say("  ".join(c.fitted(w) for c, w in zip(self.columns, words, strict=True)).rstrip() + "\n")

    def remark(self, sentence: str) -> None:
        """Tell and keep a sentence about how it was measured."""
        self.remarks.append(sentence)
        say(f"{sentence}\n")

    def target(self, number: int, words: str, value: str, met: bool) -> None:
        """Tell and keep whether a target is met."""
        target = Target(number, words, value, bool(met))
        self.targets.append(target)
        say(f"target {number}  {target.verdict:5}  {words}: {value}\n")

    def keep(self) -> None:
        """Write the section into the file of figures, in place of an earlier one of its name."""
        figures = kept_figures()
        figures["machine"] = machine()
        figures["sections"][self.name] = asdict(self)
        FIGURES.parent.mkdir(parents=True, exist_ok=True)
        FIGURES.write_text(json.dumps(figures, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def say(words: str) -> None:
    """Write to stdout at once, so that a long run can be watched."""
    sys.stdout.write(words)
    sys.stdout.flush()


def kept_figures() -> dict[str, Any]:
    """The figures kept: the ``machine`` they come from, and the ``sections`` by name."""
    if FIGURES.exists():
        figures: dict[str, Any] = json.loads(FIGURES.read_text(encoding="utf-8"))
        return figures
    return {"machine": {}, "sections": {}}


def machine() -> dict[str, str]:
    """What the figures depend on: processor, memory, system, and the versions that compile and compute."""
    return {
        "processor": first_value("/proc/cpuinfo", "model name") or platform.processor() or platform.machine(),
        "load when it was asked": f"{os.getloadavg()[0]:.1f}",
        "processors used": str(
            len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
        ),
        "memory": f"{int((first_value('/proc/meminfo', 'MemTotal') or '0').split()[0]) / MIB**2:.1f} GiB",
        "system": f"{platform.system()} {platform.release()}, {platform.machine()}",
        "Python": platform.python_version(),
        **{name: version(name) for name in ("numpy", "numba", "llvmlite") if find_spec(name)},
    }


def first_value(path: str, key: str) -> str:
    """The value behind ``key :`` in a file of the system, or nothing."""
    try:
        lines = Path(path).read_text(encoding="utf-8").splitlines()
    except OSError:
        return ""
    return next((line.partition(":")[2].strip() for line in lines if line.startswith(key)), "")


def measured(task: str, *arguments: Any, limit: float | None = None, **environment: str) -> Any:
    """Call a task in a process of its own.

    Parameters
    ----------
    task : ``module.function`` of a benchmark.
    arguments : what to call it with; JSON must hold them.
    limit : seconds after which it is given up; None for never.
    environment : variables to set.

    Returns
    -------
    What the task returned, with the process's peak memory in MiB under ``memory`` if it is a dictionary; None beyond
    the limit.
    """
    command = [sys.executable, __file__, task, json.dumps(arguments)]
    try:
        done = subprocess.run(
            command,
            stdout=subprocess.PIPE,
            check=True,
            text=True,
            timeout=limit,
            env=child_environment(**environment),
        )
    except subprocess.TimeoutExpired:
        return None
    return json.loads(done.stdout.splitlines()[-1])


def child_environment(**changes: str) -> dict[str, str]:
    """The environment of a measured process: this one's, with byte code kept as in any installation."""
    return {key: v for key, v in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"} | changes


def perform(task: str, arguments: str) -> None:
    """Call a task in this process and write its outcome to stdout."""
    module, _, function = task.rpartition(".")
    outcome = getattr(import_module(module), function)(*json.loads(arguments))
    if isinstance(outcome, dict):
        outcome["memory"] = float(first_value("/proc/self/status", "VmHWM").split()[0]) / MIB
    say(json.dumps(outcome) + "\n")


def run_alone(description: str | None, run: Callable[..., Section], **numbers: str) -> None:
    """Run one benchmark as a script; its figures are kept unless it is a quick trial.

    Parameters
    ----------
    description : whose first line ``--help`` tells.
    run : called with ``quick`` and the numbers.
    numbers : options that take a number, and what ``--help`` tells of them; None where not given.
    """
    parser = argparse.ArgumentParser(description=(description or "").split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="a small part of it, whose figures are not kept")
    for name, words in numbers.items():
        parser.add_argument(f"--{name}", type=float, help=words)
    options = parser.parse_args()
    section = run(**vars(options))
    if not options.quick:
        section.keep()


if __name__ == "__main__":
    try:
        perform(*sys.argv[1:])
    except (BrokenPipeError, KeyboardInterrupt):
        # Nobody waits for the outcome any more.
        os._exit(INTERRUPTED)
