"""The two jaws: which holes are in reach of the part, and how the plates look.

Glossary
--------
reach : the extent of part and pegs in the vise frame, and one pitch or a fourteenth of the extent more.
broken side : a side where the plate goes on beyond the picture; it is drawn as a break line.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, floor

from attrs import frozen

from workhold.drawing.scene import GREY, Box, Scene, View
from workhold.geometry.segment import Point
from workhold.model.fixture import Fixture, Jaw
from workhold.model.result import LEFT, RIGHT, hole_position
from workhold.model.vise import Vise

__all__ = ["CLOSEST_HOLES", "JawView", "draw_holes", "draw_plate", "hole_radius", "jaw_views", "labelled"]

PLATE_FILL = {"left": "#dbe4ee", "right": "#f1e7d6"}
PLATE_EDGE = {"left": "#7c8da1", "right": "#a8946f"}

# With holes closer than this on the page, in page units, only those near the pegs are drawn.
CLOSEST_HOLES = 5.0


@frozen
class JawView:
    """What the picture shows of one jaw.

    Parameters
    ----------
    jaw : "left" or "right".
    columns, rows : the holes in reach.
    plate : the plate, in mm.
    broken : sides that are break lines, of "left", "right", "bottom", "top".
    x, y : x of each column and y of each row, in mm.
    """

    jaw: Jaw
    columns: range
    rows: range
    plate: Box
    broken: frozenset[str]
    x: tuple[float, ...]
    y: tuple[float, ...]


def jaw_views(fixture: Fixture, vise: Vise, part: Box) -> tuple[JawView, JawView]:
    """Both jaws as far as a part with the extent ``part`` (mm, vise frame) reaches over them."""
    reach = part
    for peg in fixture.pegs:
        reach = reach.union(Box(peg.x, peg.y, peg.x, peg.y))
    more = max(reach.width, reach.height) / 14
    more_x, more_y = max(more, vise.pitch[0]), max(more, vise.pitch[1])
    reach = Box(reach.x0 - more_x, reach.y0 - more_y, reach.x1 + more_x, reach.y1 + more_y)
    return jaw_view("left", fixture, vise, reach), jaw_view("right", fixture, vise, reach)


def jaw_view(jaw: Jaw, fixture: Fixture, vise: Vise, reach: Box) -> JawView:
    """One jaw; see :func:`jaw_views`. ``reach`` is in mm in the vise frame."""
    index = LEFT if jaw == "left" else RIGHT
    x0, y0 = hole_position(vise, index, 0, 0, fixture.jaw_separation)
    pitch_x, pitch_y = vise.pitch
    columns = in_reach(reach.x0 - x0, reach.x1 - x0, pitch_x, vise.columns)
    # The columns next to the opening always show: the jaw separation is measured from there.
    columns = range(columns.start, vise.columns) if jaw == "left" else range(columns.stop)
    rows = in_reach(reach.y0 - y0, reach.y1 - y0, pitch_y, vise.rows)
    x = tuple(x0 + column * pitch_x for column in columns)
    y = tuple(y0 + row * pitch_y for row in rows)
    broken = {
        "left": columns.start > 0,
        "right": columns.stop < vise.columns,
        "bottom": rows.start > 0,
        "top": vise.rows is None or rows.stop < vise.rows,
    }
    inner = min(pitch_x / 2, max(1.25 * vise.peg_radius, 0.48 * fixture.jaw_separation))
    left, right = (pitch_x / 2, inner) if jaw == "left" else (inner, pitch_x / 2)
    plate = Box(x[0] - left, y[0] - pitch_y / 2, x[-1] + right, y[-1] + pitch_y / 2)
    return JawView(jaw, columns, rows, plate, frozenset(side for side in broken if broken[side]), x, y)


def in_reach(low: float, high: float, pitch: float, count: int | None) -> range:
    """Columns or rows between two distances in mm from the first one; at least one."""
    last, first = floor(high / pitch + 1e-6), ceil(low / pitch - 1e-6)
    if count is not None:
        last, first = min(last, count - 1), min(first, count - 1)
    return range(max(first, 0), max(last, 0) + 1)


def hole_radius(vise: Vise, scale: float) -> float:
    """Radius of the holes on the page: that of the pegs, or a seventh of the pitch for pegs without a size."""
    pitch = min(vise.pitch)
    return scale * (min(vise.peg_radius, 0.42 * pitch) if vise.peg_radius > 0.05 * pitch else pitch / 7)


def draw_plate(scene: Scene, jaw: JawView, view: View, tooth: float = 5.0) -> None:
    """Draw the plate of a jaw; broken sides are zigzags with teeth of ``tooth`` page units."""
    box = view.box(jaw.plate)
    corners = [(box.x0, box.y1), (box.x1, box.y1), (box.x1, box.y0), (box.x0, box.y0)]
    sides = ["bottom", "right", "top", "left"]
    runs = [
        zigzag(corners[k], corners[(k + 1) % 4], tooth) if side in jaw.broken else [corners[k], corners[(k + 1) % 4]]
        for k, side in enumerate(sides)
    ]
    scene.polygon([point for run in runs for point in run[:-1]], PLATE_FILL[jaw.jaw])
    for side, run in zip(sides, runs, strict=True):
        scene.line(run, PLATE_EDGE[jaw.jaw], 0.8 if side in jaw.broken else 2.0, stroke_linecap="round")


def zigzag(start: Point, end: Point, tooth: float) -> list[Point]:
    """A break line between two page points along an axis."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = abs(dx) + abs(dy)
    count = max(2, round(length / (2 * tooth)))
    points = [start]
    for k in range(count):
        out = tooth * 0.6 if k % 2 else -tooth * 0.6
        share = (k + 0.5) / count
        points.append((start[0] + share * dx - out * dy / length, start[1] + share * dy + out * dx / length))
    return [*points, end]


def draw_holes(scene: Scene, jaw: JawView, view: View, fixture: Fixture, vise: Vise) -> None:
    """Draw the holes in reach; of a very fine lattice only those within three pitches of a peg."""
    radius = max(hole_radius(vise, view.scale), 0.4)
    if min(vise.pitch) * view.scale >= CLOSEST_HOLES:
        holes = [(column, row) for row in jaw.rows for column in jaw.columns]
    else:
        near = {
            (peg.column + i, peg.row + j)
            for peg in fixture.pegs
            if peg.jaw == jaw.jaw
            for i in range(-3, 4)
            for j in range(-3, 4)
        }
        holes = sorted((column, row) for column, row in near if column in jaw.columns and row in jaw.rows)
    for column, row in holes:
        center = view((jaw.x[column - jaw.columns.start], jaw.y[row - jaw.rows.start]))
        scene.circle(center, radius, "#ffffff", GREY, min(0.9, 0.3 * radius + 0.1))


def labelled(names: Sequence[tuple[int, float]], pegs: set[int], spacing: float) -> list[tuple[int, float, bool]]:
    """Which columns or rows to label so that labels stand at least ``spacing`` page units apart.

    Those of the pegs come first (their flag is True), then as many of the rest as there is room for, evenly.

    Parameters
    ----------
    names : index and page coordinate of every column or row.
    """
    chosen: list[tuple[int, float, bool]] = []
    for index, at in names:
        if index in pegs and all(abs(at - other) >= 0.8 * spacing for _, other, _ in chosen):
            chosen.append((index, at, True))
    step = 1
    if len(names) > 1:
        distance = abs(names[1][1] - names[0][1])
        step = next(k for k in (1, 2, 5, 10, 20, 50, 100, 10**9) if k * distance >= spacing)
    for index, at in names:
        wanted = (index + 1) % step == 0 if step > 1 else True
        if wanted and index not in pegs and all(abs(at - other) >= spacing for _, other, _ in chosen):
            chosen.append((index, at, False))
    return sorted(chosen)
