"""Target 15: what it costs to see a solid at the height of the pegs.

The part is a plate of about 200 faces with pockets, islands, counterbored holes, round corners and a chamfer. Seconds are of
the processor: of the outline at one height once the solid is read, with its bands, and of the whole file with the table of
heights and level faces. It needs the extra ``step``; without it nothing is measured.
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

from report import Column, Section, measured

HEIGHTS = (5.0, 12.0, 18.0, 20.0)
MOST_SECONDS = 0.5

COLUMNS = (
    Column("pegs mm", 8, right=False),
    Column("faces", 6),
    Column("segments", 9),
    Column("ms", 8),
)


def run(quick: bool) -> Section:
    """Measure the outline at some heights, and the reading of the file."""
    section = Section("solids", "Solids at the height of the pegs", COLUMNS).begin()
    outcome = measured("solids.seconds", quick)
    if not outcome:
        return section
    worst = 0.0
    for high, segments, taken in outcome["outlines"]:
        worst = max(worst, taken)
        section.row(f"{high:g}", f"{outcome['faces']}", f"{segments}", f"{1e3 * taken:.0f}")
    words = f"the outline of {outcome['faces']} faces at one height after reading in under {MOST_SECONDS:g} s"
    whole = f"{worst:.3f} s at most, {outcome['whole']:.2f} s with the table of heights and level faces"
    section.target(15, words, whole, worst < MOST_SECONDS)
    return section


def seconds(quick: bool) -> dict[str, Any]:
    """Task: seconds of outlines at some heights, each with its segments; of the whole; and the number of faces."""
    try:
        import OCP  # noqa: F401
    except ImportError:
        return {}
    sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "tests" / "files")]
    from step_shapes import write_step

    from workhold.files.step.by_height import HeightView, read_by_height
    from workhold.files.step.heights import standing
    from workhold.files.step.solids import read_solids

    with TemporaryDirectory() as folder:
        content = write_step(Path(folder) / "plate.step", plate()).read_bytes()
    shape = read_solids(content)[0].shape
    outlines, faces = [], 0
    for high in HEIGHTS[:1] if quick else HEIGHTS:
        solid = standing(shape)
        faces, begin = len(solid.faces), process_time()
        found = solid.outline(high)
        outlines.append((high, sum(map(len, found.loops)), process_time() - begin))
    begin = process_time()
    read_by_height(content, HeightView(peg_height=HEIGHTS[1]))
    return {"outlines": outlines, "faces": faces, "whole": process_time() - begin}


def plate() -> Any:
    """A plate with twelve pockets, an island in each, counterbored holes, round corners and a chamfer."""
    from step_shapes import at_height, box, chamfered, cut, cylinder, filleted, fused, upright

    def outside(low: Any, high: Any) -> bool:
        reach = low[0] < 1 or high[0] > 239 or low[1] < 1 or high[1] > 159
        return bool(at_height(20.0)(low, high) and reach)

    holes = [(15 + 21 * k, y) for k in range(11) for y in (12, 148)]
    pockets = [(20 + 52 * i, 30 + 40 * j, 8 + 2 * j) for i in range(4) for j in range(3)]
    tools = [cylinder(3.3, 60, (x, y, -1)) for x, y in holes] + [
        cylinder(5.5, 60, (x, y, 10)) for x, y in holes
    ]
    tools += [filleted(box(40, 30, 30, place), 5.0, upright) for place in pockets]
    body = cut(filleted(box(240, 160, 20), 10.0, upright), *tools)
    body = fused(body, *(cylinder(6, 12, (x + 20, y + 15, 4)) for x, y, _ in pockets))
    return chamfered(body, 1.0, outside)
