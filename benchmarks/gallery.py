"""The gallery: the first choice for each of the twenty parts of ``shop_parts`` in its vise, on a plate, and against a fence.

    python benchmarks/gallery.py                 docs/gallery.md, its pictures, and those of README and manual
    python benchmarks/gallery.py --only hinge    one part again; with bracket also those of README and manual

The pictures are those of ``workhold.drawing`` without lettering, small enough to stand side by side.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator
from datetime import date
from pathlib import Path
from tempfile import TemporaryDirectory

sys.path.insert(0, str(Path(__file__).parent))

import workhold
from shop_parts import PARTS, ShopPart
from workhold.drawing.bench import BenchDrawing, draw_bench, make_bench
from workhold.drawing.render import convert_svg_to_png
from workhold.drawing.scene import Box, Scene, View
from workhold.fixels.toolkit import Toolkit

ROOT = Path(__file__).parents[1]
PAGE, PICTURES = ROOT / "docs" / "gallery.md", ROOT / "docs" / "figures" / "gallery"
IMAGES = ROOT / "docs" / "images"
MARK = "<!-- gallery: what follows is written by benchmarks/gallery.py -->\n"
CARD = (360.0, 300.0)
EDGE = 10.0
# A lattice below this many millimetres is finer than those of plates.
FINE = 20.0
# Of the README's picture: a room for each way, and the words below.
ROOM, CAPTION, WIDTH = (380.0, 330.0), 40.0, 1500
IN_THREE_WAYS = ("four pegs in a vise", "three dowels and two clamps", "a fence, a stop and a clamp")


def ways(part: ShopPart) -> Iterator[tuple[str, Toolkit]]:
    """What a part is held by: its vise, and a plate and a fence with such pegs, on a lattice as coarse as plates have."""
    pitch, radius = max(part.vise.pitch), part.vise.peg_radius
    if pitch < FINE:
        pitch *= 2
    tip, travel = 5 / 3 * radius, (0.5 * pitch, 2.0 * pitch)
    yield "vise", part.vise
    yield "plate", workhold.Plate(pitch=pitch, peg_radius=radius, clamp_radius=tip, travel=travel, clamps=2)
    for clamps in (1, 2):
        yield (
            "fence",
            workhold.Fence(
                pitch=pitch,
                peg_radius=radius,
                wall_offset=0.5 * pitch,
                clamp_radius=tip,
                travel=travel,
                clamps=clamps,
            ),
        )


def first_choices(part: ShopPart) -> dict[str, BenchDrawing]:
    """The first choice in each way that holds the part; of a fence with one clamp and with two the better one."""
    made, found, best = part.make(), {}, {}
    for name, toolkit in ways(part):
        result = workhold.design(made, toolkit, restrictions=part.restrictions, best=1)
        if len(result):
            worth = result[0].quality["warnings"], result[0].quality["penalty"]
            if name not in found or worth < best[name]:
                found[name], best[name] = make_bench(result[0], result.workpiece, toolkit), worth
    return found


def card(bench: BenchDrawing, title: str) -> str:
    """A small picture as SVG text."""
    scene = Scene.make_page(CARD, title)
    draw_on(scene, bench, Box(EDGE, EDGE, CARD[0] - EDGE, CARD[1] - EDGE))
    return scene.to_svg()


def draw_on(scene: Scene, bench: BenchDrawing, room: Box) -> None:
    """Draw a fixture into a room, as large as it fits."""
    draw_bench(scene, bench, View.fit_box(bench.extent, room), weight=0.6, longest=34.0, axes=False)


def side_by_side(benches: dict[str, BenchDrawing]) -> str:
    """The picture at the head of the README."""
    width, height = ROOM
    scene = Scene.make_page((width * len(benches), height + CAPTION), "One part, held in three ways")
    for number, (bench, words) in enumerate(zip(benches.values(), IN_THREE_WAYS, strict=True)):
        x = number * width
        draw_on(scene, bench, Box(x + EDGE, EDGE, x + width - EDGE, height - EDGE))
        scene.add_text((x + width / 2, height + CAPTION / 2), words, 18, "middle", bold=True)
    return scene.to_svg()


def write_images(benches: dict[str, BenchDrawing]) -> None:
    """The pictures of the bracket in README and manual: in three ways, the sheet's first page, and with two clamps."""
    (IMAGES / "held-in-three-ways.png").write_bytes(convert_svg_to_png(side_by_side(benches), WIDTH))
    bracket = PARTS[0].make()
    plate = workhold.Plate.preset("two-clamp-plate-20mm")
    clamped = workhold.design(bracket, plate, best=1)[0].draw(title="Fixture 1")
    (IMAGES / "two-clamps.png").write_bytes(convert_svg_to_png(clamped, 1100))
    with TemporaryDirectory() as folder:
        sheet = Path(folder) / "sheet.svg"
        first = workhold.design(bracket, PARTS[0].vise)[0]
        first.save_sheet(sheet, jaw_force=3000, thickness=12.0, dowel="6 mm m6 in H7", day=date(2026, 11, 22))
        # The second page lies below the first, which is an A4 page of its own.
        pages = sheet.read_text(encoding="utf-8")
    first_page = re.sub(
        r'height="420mm" viewBox="0 0 1188 1680"', 'height="210mm" viewBox="0 0 1188 840"', pages, count=1
    )
    (IMAGES / "sheet.png").write_bytes(convert_svg_to_png(first_page, 1200))


def told(part: ShopPart, benches: dict[str, BenchDrawing]) -> str:
    """What the page shows of a part."""
    cells = [f"[{part.name}](first-choice.md#{part.name}): {part.words}"]
    for name in ("vise", "plate", "fence"):
        picture = f"![{part.name} by {name}](figures/gallery/{part.name}-{name}.svg)"
        cells.append(picture if name in benches else "none")
    return f"| {' | '.join(cells)} |\n"


def main() -> None:
    """Make the gallery."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", action="append", help="a part's name; the page is left as it is")
    asked = parser.parse_args()
    PICTURES.mkdir(parents=True, exist_ok=True)
    rows = []
    for part in PARTS:
        if asked.only and part.name not in asked.only:
            continue
        benches = first_choices(part)
        for name, bench in benches.items():
            picture = card(bench, f"{part.name}: first choice by {name}")
            (PICTURES / f"{part.name}-{name}.svg").write_text(picture, encoding="utf-8")
        if part is PARTS[0]:
            write_images(benches)
        rows.append(told(part, benches))
        sys.stdout.write(rows[-1])
        sys.stdout.flush()
    if not asked.only:
        words = PAGE.read_text(encoding="utf-8").partition(MARK)[0]
        table = "| part | its vise | plate, two clamps | fence |\n|---|---|---|---|\n"
        PAGE.write_text(words + MARK + "\n" + table + "".join(rows), encoding="utf-8")


if __name__ == "__main__":
    main()
