"""Target 12: the best 20 of some hundred parts as they come out of CAD, on every preset: how long the worst of them takes.

The parts are those of the tests (``tests/cad_parts.py``: plates, tees, ells, channels, flanges, rods, slots, links, ears,
wedges and crosses) and gears of arcs, rounded polygons, slotted plates and combs, which have more faces. All are about 60 to
140 mm wide. Seconds are those of one processor, and of one thread, kernels compiled and loaded.

    python benchmarks/survey.py                      all parts and presets, some twenty minutes
    python benchmarks/survey.py --parts 15           the first fifteen, one of each shape
    python benchmarks/survey.py --preset NAME        that preset alone
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from math import cos, pi, sin, tan, tau
from pathlib import Path
from random import Random
from time import process_time

from attrs import frozen

from report import Column, Section

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

import workhold
from cad_parts import SHAPES, Loop, circle, rounded, size
from workhold.files.toolkit_file import list_preset_names, load_toolkit

__all__ = ["Searched", "run", "surveyed"]

PARTS, BEST, MOST_SECONDS = 300, 20, 1.0
# The slowest that are shown.
SHOWN = 12

COLUMNS = (
    Column("part", 20, right=False),
    Column("toolkit", 22, right=False),
    Column("faces", 5),
    Column("undecided", 9),
    Column("seconds", 8),
)


def gear(random: Random) -> list[Loop]:
    """A gear of arcs: round heads and round roots, a bore with holes about it."""
    teeth, r, high = random.choice([8, 10, 12, 16, 20, 24]), size(random, 30, 60), size(random, 4, 8)
    inner, loop = r - high, list[tuple[float, float, float]]()
    for k in range(teeth):
        # Root, flank, head and flank; roots and heads are arcs about the middle.
        for share, radius, bulge in ((0.0, inner, 1), (0.3, inner, 0), (0.42, r, 1), (0.88, r, 0)):
            angle = tau * (k + share) / teeth
            sweep = tau * (0.3 if share == 0.0 else 0.46) / teeth
            loop.append((radius * cos(angle), radius * sin(angle), bulge * tan(sweep / 4)))
    return [loop, circle(0.0, 0.0, random.choice([5.0, 8.0, 10.0]))]


def rounded_polygon(random: Random) -> list[Loop]:
    """A regular polygon with rounded corners, and a bore."""
    sides, r = random.randint(3, 9), size(random, 34, 68)
    corners = [(r * cos(tau * k / sides), r * sin(tau * k / sides)) for k in range(sides)]
    length = 2 * r * sin(pi / sides)
    radius = min(random.choice([2.0, 5.0, 8.0]), 0.4 * length / tan(pi / sides))
    return [rounded(corners, [radius] * sides), circle(0.0, 0.0, size(random, 6, 14))]


def slotted_plate(random: Random) -> list[Loop]:
    """A rectangular plate with slots along it and a row of holes."""
    a, b = size(random, 80, 140), size(random, 60, 100)
    half, r = a / 2 - size(random, 16, 24), random.choice([4.0, 5.0, 6.0])
    slots: list[Loop] = [
        [
            (a / 2 - half, y - r, 0.0),
            (a / 2 + half, y - r, 1.0),
            (a / 2 + half, y + r, 0.0),
            (a / 2 - half, y + r, 1.0),
        ]
        for y in (b / 4, 3 * b / 4)
    ]
    holes = [circle(x, b / 2, 3.3) for x in (a / 2 - 20.0, a / 2, a / 2 + 20.0)]
    corner = random.choice([0.0, 4.0, 10.0])
    return [rounded([(0.0, 0.0), (a, 0.0), (a, b), (0.0, b)], [corner] * 4), *slots, *holes]


def comb(random: Random) -> list[Loop]:
    """A bar with equal teeth along one side, their corners sharp or with fillets at the root."""
    teeth, pitch = random.randint(4, 7), size(random, 14, 20)
    foot, high, r = size(random, 14, 24), size(random, 12, 30), random.choice([0.0, 2.0])
    corners, radii = [(0.0, 0.0), (teeth * pitch - pitch / 2, 0.0)], [0.0, 0.0]
    for k in reversed(range(teeth)):
        left, right = k * pitch, k * pitch + pitch / 2
        corners += [(right, foot + high), (left, foot + high)]
        radii += [0.0, 0.0]
        if k:
            corners += [(left, foot), (left - pitch / 2, foot)]
            radii += [r, r]
    return [rounded(corners, radii), circle(pitch, foot / 2, 3.3)]


MORE_SHAPES: dict[str, Callable[[Random], list[Loop]]] = {
    shape.__name__: shape for shape in (gear, rounded_polygon, slotted_plate, comb)
}


def parts(count: int) -> Iterator[workhold.Workpiece]:
    """So many parts; shapes come in turn."""
    shapes = list((SHAPES | MORE_SHAPES).items())
    for seed in range(count):
        name, shape = shapes[seed % len(shapes)]
        yield workhold.Workpiece.from_loops(f"{name}-{seed}", shape(Random(seed)))


@frozen
class Searched:
    """What a search for the best of a part took.

    Parameters
    ----------
    part, toolkit : their names.
    faces, undecided : how many there are.
    seconds : of a processor.
    """

    part: str
    toolkit: str
    faces: int
    undecided: int
    seconds: float


def surveyed(count: int, presets: Sequence[str]) -> Iterator[Searched]:
    """Searches of so many parts on each of some presets."""
    for part in parts(count):
        for preset in presets:
            toolkit = load_toolkit(preset).toolkit
            start = process_time()
            try:
                result = workhold.design(part, toolkit, best=BEST, threads=1)
            except workhold.InputError:
                # Such as a part that is smaller than a pitch allows.
                yield Searched(part.name, preset, len(part.faces), 0, process_time() - start)
                continue
            undecided = 0 if result.proof is None else len(result.proof.undecided)
            yield Searched(part.name, preset, len(part.faces), undecided, process_time() - start)


def told(section: Section, searched: Searched) -> None:
    """Tell a search as a row of the table."""
    counts = f"{searched.faces}", f"{searched.undecided}"
    section.row(searched.part, searched.toolkit, *counts, f"{searched.seconds:.2f}")


def run(quick: bool, count: int = PARTS, presets: Sequence[str] = ()) -> Section:
    """Search the best of all parts on all presets, and tell the slowest, or of a few parts."""
    section = Section("survey", f"The best {BEST} of parts as they come out of CAD, one thread", COLUMNS)
    # The first search loads kernels.
    for _ in surveyed(1, list_preset_names()):
        pass
    searches = list[Searched]()
    for searched in surveyed(len(SHAPES | MORE_SHAPES) if quick else count, presets or list_preset_names()):
        searches.append(searched)
        if searched.seconds > MOST_SECONDS:
            sys.stderr.write(f"{searched.part} {searched.toolkit} {searched.seconds:.2f} s\n")
    searches.sort(key=lambda searched: -searched.seconds)
    section.begin()
    for searched in searches[:SHOWN]:
        told(section, searched)
    seconds = [searched.seconds for searched in searches]
    over = sum(second > MOST_SECONDS for second in seconds)
    middle, late = seconds[len(seconds) // 2], seconds[len(seconds) // 100]
    section.remark(
        f"{len(seconds):,} searches, {sum(seconds):.0f} s together: half under {middle:.2f} s, 99 of a hundred under "
        f"{late:.2f} s, {over} over {MOST_SECONDS:g} s; {sum(s.undecided for s in searches)} undecided."
    )
    section.target(
        12,
        f"the best {BEST} of any of {len(seconds):,} parts and presets in under {MOST_SECONDS:g} s",
        f"{seconds[0]:.2f} s at most",
        seconds[0] < MOST_SECONDS,
    )
    return section


def main() -> None:
    """Run as a script."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--parts", type=int, help="so many parts; no figures are kept")
    parser.add_argument("--preset", action="append", help="this toolkit alone; no figures are kept")
    asked = parser.parse_args()
    section = run(False, asked.parts or PARTS, asked.preset or ())
    if not (asked.parts or asked.preset):
        section.keep()


if __name__ == "__main__":
    main()
