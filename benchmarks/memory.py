"""Target 7: the best K of a part far too large to list, in bounded memory, with progress and a clean end on Ctrl-C.

A part of 100 faces, half of them arcs, in a vise of 40 columns whose pitch is a fortieth of the part's size. The search is
watched on a terminal and interrupted after a minute (``--seconds``); the file it leaves must say that it is incomplete,
list no more than K fixtures, and be read back. Then all fixtures of a gear of 400 faces are listed and interrupted: a
search that many symmetries, curves and fixtures give much to do after it ends, too.
"""

from __future__ import annotations

import json
import tempfile
from math import cos, pi, sin, tau
from pathlib import Path
from random import Random

from attrs import frozen

from report import Column, Section, measured, run_alone
from terminal import WORKHOLD, Watched, watch

SIZE = 200.0
MOST_MEMORY = 1024.0
# Of the seconds after which a search is interrupted: the gear is listed by then, but not to the end.
LISTING = 0.85
MOST_SECONDS_TO_STOP = 2.0
INTERRUPTED = 130
SECONDS, QUICK_SECONDS = 60.0, 10.0
# A bar on the terminal: its fraction in per cent, what was found, and the time that remains.
PER_CENT, REMAINING = r"(\d+)%", r"(\d+:\d\d:\d\d)"

COLUMNS = (
    Column("part", 6, right=False),
    Column("faces", 5),
    Column("columns", 7),
    Column("pitch", 5),
    Column("K", 5),
    Column("seconds", 8),
    Column("done", 6),
    Column("said to remain", 14),
    Column("listed", 7),
    Column("peak MiB", 8),
    Column("to stop s", 9),
)


@frozen
class Large:
    """A search too large to finish: faces of the part, columns, parts of its size that make a pitch, fixtures kept."""

    faces: int
    columns: int
    pitches: int
    best: int

    @property
    def pitch(self) -> float:
        """The pitch in mm."""
        return SIZE / self.pitches


FULL, QUICK = Large(100, 40, 40, 100), Large(40, 10, 20, 20)


def ragged_part(faces: int) -> list[tuple[float, float, float]]:
    """A star-shaped loop of lines and shallow arcs in turn, (x, y, bulge), whose larger side is ``SIZE`` mm."""
    random = Random(1996)
    loop = []
    for k in range(faces):
        radius, angle = random.uniform(0.9, 1.0), 2 * pi * (k + random.uniform(-0.2, 0.2)) / faces
        loop.append((radius * cos(angle), radius * sin(angle), 0.0 if k % 2 else random.uniform(0.05, 0.15)))
    xs, ys = [x for x, _, _ in loop], [y for _, y, _ in loop]
    scale = SIZE / max(max(xs) - min(xs), max(ys) - min(ys))
    return [(scale * x, scale * y, bulge) for x, y, bulge in loop]


def gear(teeth: int) -> list[tuple[float, float, float]]:
    """A gear with straight flanks, four faces to a tooth."""
    parts = ((0.0, 60.0), (0.3, 60.0), (0.5, 57.5), (0.8, 57.5))
    turns = [(tau * (tooth + part) / teeth, radius) for tooth in range(teeth) for part, radius in parts]
    return [(radius * cos(angle), radius * sin(angle), 0.0) for angle, radius in turns]


def face_count(path: str) -> int:
    """Task: how many faces a part has."""
    import workhold

    return len(workhold.load(path).faces)


def listed_in(path: str) -> dict[str, bool | int]:
    """Task: whether a result is complete, and how many fixtures it lists."""
    from workhold.files.result.reader import read_result

    result = read_result(path)
    return {"complete": result.complete, "listed": len(result)}


def interrupted(large: Large, part: Path, out: Path, seconds: float) -> Watched:
    """Run the search on a terminal and interrupt it."""
    vise = [
        "--pitch",
        f"{large.pitch:g}",
        "--columns",
        str(large.columns),
        "--peg-radius",
        f"{0.4 * large.pitch:g}",
    ]
    command = [*WORKHOLD, "design", str(part), *vise, "--best", str(large.best), "--out", str(out)]
    return watch(command, interrupt_after=seconds)


def run(quick: bool, seconds: float | None = None) -> Section:
    """Interrupt the large search after some seconds; a much smaller one in a quick trial."""
    large, seconds = QUICK if quick else FULL, seconds or (QUICK_SECONDS if quick else SECONDS)
    section = Section(
        "memory", f"A search too large to list, interrupted after {seconds:g} s", COLUMNS
    ).begin()
    # Compiling is not part of what is watched.
    measured("designs.warm")
    with tempfile.TemporaryDirectory() as folder:
        part, out = Path(folder) / "ragged.json", Path(folder) / "r.json"
        part.write_text(json.dumps({"name": "ragged", "units": "mm", "loops": [ragged_part(large.faces)]}))
        faces = measured("memory.face_count", str(part))
        seen = interrupted(large, part, out, seconds)
        kept = measured("memory.listed_in", str(out)) if out.exists() else None
    done, remaining = seen.last(PER_CENT), seen.last(REMAINING)
    listed = kept["listed"] if kept else None
    section.row(
        "ragged",
        str(faces),
        str(large.columns),
        f"{large.pitch:g}",
        str(large.best),
        f"{seen.seconds:.1f}",
        f"{done} %" if done else "none",
        remaining or "none",
        "no file" if listed is None else f"{listed}",
        f"{seen.memory:.0f}",
        f"{seen.stopping:.1f}",
    )
    words = f"a part of {faces} faces in {large.columns} columns keeps the best {large.best} in under {MOST_MEMORY:g} MiB"
    section.target(
        7, words, f"{seen.memory:.0f} MiB at most", faces == large.faces and seen.memory < MOST_MEMORY
    )
    shown = f"{done or 'no'} % done, {remaining or 'nothing'} said to remain"
    section.target(7, "progress and an estimate of the rest are shown", shown, bool(done and remaining))
    finished = seen.code == 0 and kept is not None and kept["complete"]
    partial = seen.code == INTERRUPTED and kept is not None and not kept["complete"]
    clean = (finished or partial) and listed is not None and listed <= large.best
    value = f"exit code {seen.code}, {'no file' if listed is None else f'{listed} fixtures'}, {seen.stopping:.1f} s to stop"
    section.target(
        7, "Ctrl-C leaves a clean partial result", value + (", finished before" if finished else ""), clean
    )
    longest = max(seen.stopping, gear_stopped(section, 20 if quick else 100, LISTING * seconds))
    words = f"a search stops within {MOST_SECONDS_TO_STOP:g} s of Ctrl-C"
    section.target(7, words, f"{longest:.1f} s at most", longest <= MOST_SECONDS_TO_STOP)
    return section


def gear_stopped(section: Section, teeth: int, seconds: float) -> float:
    """Interrupt the listing of all fixtures of a gear; how long it takes to stop."""
    with tempfile.TemporaryDirectory() as folder:
        part = Path(folder) / "gear.json"
        part.write_text(json.dumps({"name": "gear", "units": "mm", "loops": [gear(teeth)]}))
        command = [*WORKHOLD, "design", str(part), "--pitch", "5", "--columns", "4", "--peg-radius", "0.5"]
        seen = watch(command, interrupt_after=seconds)
    done = seen.last(PER_CENT)
    numbers = f"{seen.seconds:.1f}", f"{done} %" if done else "none", seen.last(REMAINING) or "none", ""
    section.row(
        "gear", str(4 * teeth), "4", "5", "all", *numbers, f"{seen.memory:.0f}", f"{seen.stopping:.1f}"
    )
    return seen.stopping


if __name__ == "__main__":
    run_alone(__doc__, run, seconds="interrupt after so many seconds")
