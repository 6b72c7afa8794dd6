"""Target 9: a result that scales: a million fixtures opened and one shown, many listed on the disk, a part of many faces.

The part that grows against the pitch is the one of ``growth``. Fixtures of the file that is opened are those of a smaller
part, repeated: what they are does not matter for the time. All is measured on one thread, in processes of their own.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from time import perf_counter
from typing import Any

from designs import Design, counted, grown, loaded, warm
from growth import GROWING
from memory import gear
from report import Column, Section, measured, run_alone

MILLION = 1_000_000
MOST_SECONDS_TO_SHOW = 0.1
MOST_NANOSECONDS = 800.0
MOST_MEMORY = 1024.0
MOST_GEAR_SECONDS = 4.0
TEETH, QUICK_TEETH = 120, 20

COLUMNS = (
    Column("what", 34, right=False),
    Column("contacts A", 12),
    Column("fixtures", 11),
    Column("file MB", 8),
    Column("seconds", 9),
    Column("peak MiB", 8),
)


def run(quick: bool) -> Section:
    """Open and show, list on the disk, and design for a gear."""
    section = Section("many", "A great many fixtures, one thread", COLUMNS).begin()
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "many.npz")
        count = MILLION // 100 if quick else MILLION
        size = measured("many.repeated", path, count)
        shown = measured("many.opened", path)
        section.row(
            "open, show one",
            "",
            f"{count:,}",
            f"{size:.0f}",
            f"{shown['seconds']:.4f}",
            f"{shown['memory']:.0f}",
        )
        words = f"one of {MILLION:,} fixtures is shown in under {MOST_SECONDS_TO_SHOW} s"
        section.target(9, words, f"{shown['seconds']:.4f} s", shown["seconds"] < MOST_SECONDS_TO_SHOW)
        for times in (1,) if quick else (4, 8):
            design = grown(GROWING, times)
            contacts, outcome = counted(design), streamed(design, path)
            each = 1e9 * outcome["seconds"] / contacts
            name = f"{design.part} {times} times, on the disk"
            numbers = f"{contacts:,}", f"{outcome['fixtures']:,}", f"{outcome['size']:.0f}"
            section.row(name, *numbers, f"{outcome['seconds']:.1f}", f"{outcome['memory']:.0f}")
            if times == 4:
                words = f"{contacts:,} contacts, all fixtures listed, at most {MOST_NANOSECONDS:g} ns each"
                section.target(9, words, f"{each:.0f} ns", each <= MOST_NANOSECONDS)
            if times == 8:
                words = f"{contacts:,} contacts, all fixtures listed, in under {MOST_MEMORY:g} MiB"
                section.target(9, words, f"{outcome['memory']:.0f} MiB", outcome["memory"] < MOST_MEMORY)
    teeth = QUICK_TEETH if quick else TEETH
    cut = measured("many.gear_seconds", teeth)
    section.row(
        f"gear of {4 * teeth} faces",
        "",
        f"{cut['fixtures']:,}",
        "",
        f"{cut['seconds']:.2f}",
        f"{cut['memory']:.0f}",
    )
    words = f"a gear of {4 * TEETH} faces takes at most {MOST_GEAR_SECONDS:g} s"
    section.target(9, words, f"{cut['seconds']:.2f} s", cut["seconds"] <= MOST_GEAR_SECONDS)
    return section


def streamed(design: Design, path: str) -> dict[str, Any]:
    """All fixtures of a design written to a file in columns, in a process of its own."""
    arguments = design.part, design.pitch, design.columns, design.peg_radius, path
    outcome: dict[str, Any] = measured("many.streamed_seconds", *arguments)
    return outcome


def repeated(path: str, count: int) -> float:
    """Task: write so many fixtures; the megabytes of the file."""
    import numpy as np
    from attrs import evolve

    import workhold

    result = workhold.design(*loaded("widget", 8, 5, 3.0), threads=1)
    table = result.table.take(np.arange(count) % len(result))
    workhold.save(evolve(result, table=table), path)
    return Path(path).stat().st_size / 1e6


def opened(path: str) -> dict[str, float]:
    """Task: the seconds of opening a result and making one of its fixtures, all modules loaded."""
    import workhold
    from workhold.files.result.reader import read_result

    del read_result
    start = perf_counter()
    result = workhold.open(path)
    fixture = result[len(result) * 3 // 4]
    assert len(fixture.pegs) == 4
    return {"seconds": perf_counter() - start}


def streamed_seconds(part: str, pitch: float, columns: int, peg_radius: float, path: str) -> dict[str, float]:
    """Task: the seconds of a design that is written in columns on its way."""
    import workhold

    warm()
    query = workhold.Query(*loaded(part, pitch, columns, peg_radius))
    start = perf_counter()
    result = workhold.answer_to_file(query, path, threads=1)
    seconds = perf_counter() - start
    return {"seconds": seconds, "fixtures": len(result), "size": Path(path).stat().st_size / 1e6}


def gear_seconds(teeth: int) -> dict[str, float]:
    """Task: the seconds of a design for a gear with straight flanks, four faces to a tooth."""
    import workhold

    warm()
    start = perf_counter()
    part = workhold.Workpiece.from_loops("gear", [gear(teeth)])
    result = workhold.design(part, workhold.Vise(pitch=20, columns=2, peg_radius=0.5), threads=1)
    return {"seconds": perf_counter() - start, "fixtures": len(result)}


if __name__ == "__main__":
    run_alone(__doc__, run)
