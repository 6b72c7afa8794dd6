"""The packing of copies on a plate drawn: every hole of the plate, and every copy with its pegs and clamps."""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce

from workhold.drawing.bench import Bench, bench_of, draw_part, draw_pegs
from workhold.drawing.clamps import draw_clamp, draw_push
from workhold.drawing.dimensions import scale_bar
from workhold.drawing.fonts import shortened
from workhold.drawing.length_unit import LengthUnit
from workhold.drawing.plates import STILL, draw_wall, labelled
from workhold.drawing.scene import GREY, LANDSCAPE, PORTRAIT, Box, Scene, View
from workhold.family.copies import Packing
from workhold.family.holding import shifted
from workhold.fixels.carrier import Carrier
from workhold.fixels.holes import column_letters
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.result import FixtureTable, fixture_at
from workhold.model.workpiece import Workpiece
from workhold.units import MILLIMETRE, Unit

__all__ = ["copies_of", "draw_copies"]

EDGE, HEADER, FOOTER, NAMES = 32.0, 74.0, 34.0, 34.0
# Factor on line widths.
WEIGHT = 0.6


def copies_of(row: FixtureTable, toolkit: Toolkit, workpiece: Workpiece, packing: Packing) -> list[Fixture]:
    """Every copy of a fixture, a table of one row, where it stands."""
    moved = (shifted(row, toolkit, {0: columns}, rows) for columns, rows in packing.shifts)
    return [fixture_at(one, toolkit, 0, workpiece) for one in moved]


def draw_copies(
    copies: list[Fixture],
    workpiece: Workpiece,
    toolkit: Toolkit,
    size: tuple[int, int],
    *,
    unit: Unit = MILLIMETRE,
) -> str:
    """Draw copies on a plate of so many columns and rows, on A4, as SVG text."""
    plate, (columns, rows) = toolkit.carriers[0], size
    benches = [bench_of(fixture, workpiece, toolkit) for fixture in copies]
    holes = Box(*plate.place(0, 0), *plate.place(columns - 1, rows - 1)).grown(max(plate.pitch) / 2)
    extent = reduce(Box.union, (box for bench in benches for box in taken_up(bench)), holes)
    walls = [Box(holes.x0, wall.bar.y0, holes.x1, wall.bar.y1) for wall in benches[0].shown.walls]
    extent = reduce(Box.union, walls, extent)
    page = LANDSCAPE if extent.width >= 0.8 * extent.height else PORTRAIT
    count = "1 copy" if len(copies) == 1 else f"{len(copies)} copies"
    heading = shortened(f"{workpiece.name}: {count}", 26, page[0] - 2 * EDGE, bold=True)
    scene = Scene.page(page, heading)
    scene.text((EDGE, EDGE + 12), heading, 26, bold=True)
    scene.text((EDGE, EDGE + 42), f"On a plate of {columns} columns and {rows} rows of holes.", 15, fill=GREY)
    view = View.fitting(extent, Box(EDGE + NAMES, EDGE + HEADER, page[0] - EDGE, page[1] - EDGE - FOOTER - NAMES))
    draw_whole_plate(scene, holes, plate, size, view)
    for wall in walls:
        draw_wall(scene.group("wall"), wall, view)
    for number, bench in enumerate(benches, 1):
        group = scene.group("copy")
        for clamp in bench.shown.clamps:
            draw_clamp(group, clamp, bench.shown.carriers[0], view, WEIGHT)
        draw_part(group, bench, view, WEIGHT)
        for clamp in bench.shown.clamps:
            draw_push(group, clamp, view, WEIGHT)
        draw_pegs(group, bench, view, WEIGHT)
        group.text(view(bench.fixture.pose.apply(*workpiece.center)), str(number), 16, "middle", bold=True, halo=3)
    scale_bar(scene, (EDGE, page[1] - EDGE), view.scale, LengthUnit.suiting(unit, min(plate.pitch)))
    return scene.svg()


def taken_up(bench: Bench) -> Iterator[Box]:
    """What a copy takes up: the boxes of its outline and of its clamps with their arrows."""
    yield bench.shown.part
    for clamp in bench.shown.clamps:
        yield clamp.room


def draw_whole_plate(scene: Scene, holes: Box, plate: Carrier, size: tuple[int, int], view: View) -> None:
    """Draw a plate with all its holes and the names of its columns and rows."""
    box, (columns, rows) = view.box(holes), size
    fill, edge = STILL
    scene.group("plate").rectangle(box, fill, edge, 2.0)
    group = scene.group("holes")
    radius = max(0.28 * min(plate.pitch) * view.scale if plate.peg_radius == 0 else plate.peg_radius * view.scale, 0.5)
    for column in range(columns):
        for row in range(rows):
            group.circle(view(plate.place(column, row)), radius, "#ffffff", GREY, min(0.7, 0.3 * radius))
    names = scene.group("hole-names")
    across = [(column, view(plate.place(column, 0))[0]) for column in range(columns)]
    along = [(row, view(plate.place(0, row))[1]) for row in range(rows)]
    for column, x, _ in labelled(across, set(), 22.0):
        names.text((x, box.y1 + 14), column_letters(column), 12, "middle", fill=GREY)
    for row, y, _ in labelled(along, set(), 15.0):
        names.text((box.x0 - 8, y), str(row + 1), 12, "end", fill=GREY)
