"""Target 15: what it costs to see a solid at the height of the pegs.

The first part is a plate of about 200 faces with pockets, islands, counterbored holes, round corners and a chamfer. Then
come a wheel whose many teeth are round and end in a cone, and a block with rounded rims and bosses that lie. Seconds are of
the processor: of the outline at one height once the solid is read, with its bands, and of the whole file with the table of
heights and level faces. It needs the extra ``step``; without it nothing is measured.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from math import cos, sin, tau
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

from report import Column, Section, measured, run_alone

MOST_SECONDS = 0.5

COLUMNS = (
    Column("part", 14, right=False),
    Column("pegs mm", 8),
    Column("faces", 6),
    Column("segments", 9),
    Column("ms", 8),
)


def run(quick: bool) -> Section:
    """Measure the outline at some heights, and the reading of the file."""
    section = Section("solids", "Solids at the height of the pegs", COLUMNS).begin()
    outcome = dict(measured("solids.seconds", quick))
    if not outcome:
        return section
    for name, one in outcome.items():
        for high, segments, taken in one["outlines"]:
            section.row(name, f"{high:g}", f"{one['faces']}", f"{segments}", f"{1e3 * taken:.0f}")
    worst = max(taken for one in outcome.values() for *_, taken in one["outlines"])
    most = max(one["faces"] for one in outcome.values())
    words = f"the outline of up to {most} faces at one height after reading in under {MOST_SECONDS:g} s"
    whole = ", ".join(f"{one['whole']:.2f} s ({name})" for name, one in outcome.items())
    said = f"{worst:.3f} s at most; with the table of heights and level faces {whole}"
    section.target(15, words, said, worst < MOST_SECONDS)
    return section


def seconds(quick: bool) -> list[tuple[str, dict[str, Any]]]:
    """Task: of each part seconds of outlines at some heights, with their segments, of the whole, and how many faces."""
    try:
        import OCP  # noqa: F401
    except ImportError:
        return []
    sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "tests" / "files")]
    return [
        (name, seconds_of(make(), heights[:1] if quick else heights))
        for name, (make, heights) in PARTS.items()
    ]


def seconds_of(part: Any, heights: Sequence[float]) -> dict[str, Any]:
    """Seconds of one part, see :func:`seconds`."""
    from step_shapes import write_step

    from workhold.files.step.by_height import HeightView, read_by_height
    from workhold.files.step.heights import stand_solid
    from workhold.files.step.solids import read_solids

    with TemporaryDirectory() as folder:
        content = write_step(Path(folder) / "part.step", part).read_bytes()
    shape = read_solids(content)[0].shape
    outlines, faces = [], 0
    for high in heights:
        solid = stand_solid(shape)
        faces, begin = len(solid.faces), process_time()
        found = solid.make_outline(high)
        outlines.append((high, sum(map(len, found.loops)), process_time() - begin))
    begin = process_time()
    read_by_height(content, HeightView(peg_height=heights[-1]))
    return {"outlines": outlines, "faces": faces, "whole": process_time() - begin}


def toothed_wheel() -> Any:
    """A wheel with 48 round gaps between its teeth, which end in a cone above and below."""
    from step_shapes import at_height, chamfered, cut, cylinder

    angles = [tau * k / 48 for k in range(48)]
    gaps = [cylinder(1.1, 30, (40 * cos(angle), 40 * sin(angle), -5)) for angle in angles]
    blank = chamfered(chamfered(cylinder(40, 20, (0, 0, 0)), 4.0, at_height(20.0)), 4.0, at_height(0.0))
    return cut(blank, cylinder(6, 30, (0, 0, -5)), *gaps)


def rounded_block() -> Any:
    """A block with round corners and bosses that lie, with rounded rims."""
    from step_shapes import box, cylinder, filleted, fused, upright

    bosses = [cylinder(7, 12, (x, 60, 10), (0, 1, 0)) for x in range(15, 200, 22)]
    bosses = [filleted(boss, 1.5, lambda low, high: low[1] > 71.9) for boss in bosses]
    return fused(filleted(box(200, 60, 20), 6.0, upright), *bosses)


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


# Each part with the heights of pegs in mm. Below the top of a rim its cut is neither line nor arc.
PARTS: dict[str, tuple[Callable[[], Any], tuple[float, ...]]] = {
    "plate": (plate, (5.0, 12.0, 18.0, 20.0)),
    "toothed wheel": (toothed_wheel, (2.0, 10.0, 18.0, 20.0)),
    "rounded block": (rounded_block, (18.0, 20.0)),
}


if __name__ == "__main__":
    run_alone(__doc__, run)
