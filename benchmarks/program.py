"""From drawing and program to a sheet whose first choice lets every tool pass; and 100,000 lines: time and memory.

Every command runs in a process of its own, as at a prompt; its time is what passes until it ends, its memory the largest
resident set. The kernels are compiled beforehand.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from math import cos, pi, sin
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

from report import ROOT, Column, Section

EXAMPLES = ROOT / "examples"
LINES, MOST_SECONDS, MOST_LONG_SECONDS, MOST_MEGABYTES = 100_000, 3.0, 10.0, 500.0
NUMBERS = (13, 14)
VISE = ("--pitch", "10", "--columns", "2", "--peg-radius", "3")
HEIGHTS = ("--thickness", "12", "--peg-height", "6")
TOOL = 'unit = "mm"\n[tool.1]\ndiameter = 6\nflute_length = 12\nshank_diameter = 8\nstickout = 30\n'
TOOL += "holder_diameter = 30\nholder_length = 50\n"


def timed(*words: str) -> tuple[float, float]:
    """Seconds and megabytes of a command of workhold.

    Raises
    ------
    RuntimeError
        When it fails.
    """
    begun = perf_counter()
    process = subprocess.Popen(
        [sys.executable, "-m", "workhold", *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = status
    if status:
        raise RuntimeError(f"workhold {' '.join(words)} ended with {status}")
    return perf_counter() - begun, usage.ru_maxrss / 1024.0


def long_program(path: Path, lines: int) -> None:
    """Writes a program of short moves that spiral down in a pocket, at the height of pegs."""
    head = ["%", "G21 G90 G17", "T1 M6", "S8000 M3", "G0 X26 Y35 Z15", "G0 Z2", "G1 Z-8 F500"]
    tail = ["G0 Z15", "M5", "M30", "%"]
    count, body = lines - len(head) - len(tail), []
    for k in range(count):
        share = k / count
        turn = 80 * pi * share
        reach = 6 + 8 * share + 0.5 * sin(37 * turn)
        body.append(f"X{20 + reach * cos(turn):.4f} Y{35 + reach * sin(turn):.4f} Z{-8 - 2 * share:.4f}")
    path.write_text("\n".join([*head, *body, *tail]) + "\n", encoding="ascii")


def run(quick: bool = False) -> Section:
    """Measure, and tell what was measured."""
    section = Section(
        "program",
        "From drawing and program to the sheet",
        (
            Column("program", 12, right=False),
            Column("lines", 7),
            Column("what is done", 24, right=False),
            Column("seconds", 7),
            Column("MB", 5),
        ),
    ).begin()
    with TemporaryDirectory() as name:
        folder = Path(name)
        table = folder / "tools.toml"
        table.write_text(TOOL, encoding="ascii")
        lines = LINES // 20 if quick else LINES
        long = folder / "long.nc"
        long_program(long, lines)
        drawing, result, sheet = (
            str(path) for path in (EXAMPLES / "bracket.dxf", folder / "a.json", folder / "a.pdf")
        )
        least, largest, slowest = float("inf"), 0.0, 0.0
        for title, program, tools in (
            ("bracket.nc", EXAMPLES / "bracket.nc", EXAMPLES / "tools.toml"),
            ("long.nc", long, table),
        ):
            count = str(len(program.read_text(encoding="ascii").splitlines()))
            asked = (drawing, *VISE, "--program", str(program), "--tools", str(tools), *HEIGHTS)
            best = ("--best", "100") if title == "long.nc" else ()
            for what, words in (
                ("design with its sheet", ("design", *asked, *best, "--sheet", sheet, "--force")),
                ("design, all to a file", ("design", *asked, "--out", result, "--force")),
                ("show from the file", ("show", result, "1")),
                ("sheet from the file", ("sheet", result, "1", "-o", sheet, "--force")),
            ):
                seconds, megabytes = min(timed(*words) for _ in range(1 if quick else 3))
                section.row(title, count, what, f"{seconds:.1f}", f"{megabytes:.0f}")
                if title == "long.nc":
                    largest, slowest = max(largest, megabytes), max(slowest, seconds)
                elif what.endswith("its sheet"):
                    least = seconds
    section.target(
        NUMBERS[0],
        f"the bracket from drawing and program to a sheet in {MOST_SECONDS:.0f} s",
        f"{least:.1f} s",
        least < MOST_SECONDS,
    )
    section.target(
        NUMBERS[1],
        f"{LINES:,} lines in {MOST_LONG_SECONDS:.0f} s and {MOST_MEGABYTES:.0f} MB",
        f"{slowest:.1f} s, {largest:.0f} MB",
        slowest < MOST_LONG_SECONDS and largest < MOST_MEGABYTES,
    )
    return section


def main() -> None:
    """Run as a script."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="a short program; no figures are kept")
    options = parser.parse_args()
    section = run(options.quick)
    if not options.quick:
        section.keep()


if __name__ == "__main__":
    main()
