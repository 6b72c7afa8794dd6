"""The carriers of a toolkit drawn: plates with their holes, walls, and clamps that are bolted to a plate.

All is drawn from the description of what shows (``model.shown``). A clamp has its body, bolt and line, and an
arrow in the direction in which it pushes.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, cos, inf, pi, sin

from workhold.drawing.annotation import LabelPlacer
from workhold.drawing.scene import BLACK, GREY, Box, Scene, View
from workhold.geometry.segment import Point
from workhold.geometry.symmetry import rotate_vectors
from workhold.model.clamps import ShownClamp
from workhold.model.shown import ShownCarrier, ShownJaws, ShownSetUp, Side

__all__ = [
    "SLIDING",
    "avoid_clamp",
    "draw_block_arrow",
    "draw_clamp",
    "draw_flat_jaws",
    "draw_holes",
    "draw_jaw",
    "draw_plate",
    "draw_push",
    "draw_sign",
    "draw_wall",
    "choose_labelled",
    "limit_holes_drawn",
]

# Fill and edge of a plate that stands still, and of one that slides.
FENCE = "#cfd6dd", "#3d4a58"
STILL, SLIDING = ("#dbe4ee", "#7c8da1"), ("#f1e7d6", "#a8946f")

# With holes closer than this on the page, in page units, only those near the pegs are drawn.
CLOSEST_HOLES = 5.0


def limit_holes_drawn(view: View, shown: ShownSetUp) -> float:
    """Return the number of holes up to which all holes of a carrier are drawn.

    Of more holes, only those near the pegs are drawn. The number is inf if there is no limit, and 0 if the
    holes would be too close on the page.
    """
    return 0 if shown.pitch * view.scale < CLOSEST_HOLES else inf


def draw_plate(scene: Scene, shown: ShownCarrier, view: View, tooth: float = 5.0) -> None:
    """Draw a plate; sides where it is cut off are zigzags with teeth of ``tooth`` page units."""
    box = view.map_box(shown.plate)
    corners = [(box.x0, box.y1), (box.x1, box.y1), (box.x1, box.y0), (box.x0, box.y0)]
    sides: list[Side] = ["bottom", "right", "top", "left"]
    runs = [
        make_zigzag(corners[k], corners[(k + 1) % 4], tooth)
        if side in shown.broken
        else [corners[k], corners[(k + 1) % 4]]
        for k, side in enumerate(sides)
    ]
    fill, edge = STILL if shown.clamping is None else SLIDING
    scene.add_polygon([point for run in runs for point in run[:-1]], fill)
    for side, run in zip(sides, runs, strict=True):
        scene.add_line(run, edge, 0.8 if side in shown.broken else 2.0, stroke_linecap="round")


def draw_wall(scene: Scene, bar: Box, view: View, weight: float = 1.0, has_ends: bool = False) -> None:
    """Draw a wall, a bar in mm: hatched, with a bold line at its top where the
    part lies, and bold ends if it has ends.
    """
    box = view.map_box(bar)
    scene.add_rectangle(box, FENCE[0])
    high, step = box.height, max(box.height * 0.8, 6.0 * weight)
    for k in range(1, int((box.width + high) / step) + 1):
        # Strokes at 45 degrees, cut off at the bar's ends.
        foot = box.x0 - high + k * step
        low, top = max(foot, box.x0), min(foot + high, box.x1)
        if low < top:
            ends = [(low, box.y1 - (low - foot)), (top, box.y1 - (top - foot))]
            scene.add_line(ends, FENCE[1], 0.9 * weight, **{"class": "hatching"})
    scene.add_line([(box.x0, box.y0), (box.x1, box.y0)], FENCE[1], 2.6 * weight, **{"class": "fence"})
    for x in (box.x0, box.x1) if has_ends else ():
        scene.add_line([(x, box.y0), (x, box.y1)], FENCE[1], 2.6 * weight, **{"class": "end of fence"})


def draw_flat_jaws(scene: Scene, jaws: ShownJaws, view: View, weight: float = 1.0) -> None:
    """Draw two flat jaws from above, the parallels between them and the work stop."""
    for box in jaws.parallels:
        page = view.map_box(box)
        scene.add_rectangle(page, "#eef0f3")
        corners = [(page.x0, page.y0), (page.x1, page.y0), (page.x1, page.y1), (page.x0, page.y1)]
        scene.add_line([*corners, corners[0]], "#9aa1aa", 0.9 * weight, stroke_dasharray="6 4")
    for bar, is_lower in ((jaws.fixed, True), (jaws.moving, False)):
        draw_jaw(scene, view.map_box(bar), "top" if is_lower else "bottom", weight)
    if jaws.stop is not None:
        scene.add_rectangle(view.map_box(jaws.stop), "#cfd4db", BLACK, 1.2 * weight)


def draw_jaw(scene: Scene, box: Box, face: str, weight: float = 1.0) -> None:
    """Draw a jaw, a page box; ``face`` is the side ("top", "bottom", "left", "right") drawn bold."""
    scene.add_rectangle(box, "#dfe3e8", GREY, 1.0 * weight)
    ends = {
        "top": [(box.x0, box.y0), (box.x1, box.y0)],
        "bottom": [(box.x0, box.y1), (box.x1, box.y1)],
        "left": [(box.x0, box.y0), (box.x0, box.y1)],
        "right": [(box.x1, box.y0), (box.x1, box.y1)],
    }
    scene.add_line(ends[face], FENCE[1], 2.6 * weight, **{"class": "jaw face"})


def make_zigzag(start: Point, end: Point, tooth: float) -> list[Point]:
    """Return the points of a zigzag break line from ``start`` to ``end``, which have the same x or the same
    y.

    ``tooth`` is the size of its teeth in page units.
    """
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = abs(dx) + abs(dy)
    count = max(2, round(length / (2 * tooth)))
    points = [start]
    for k in range(count):
        out = tooth * 0.6 if k % 2 else -tooth * 0.6
        share = (k + 0.5) / count
        points.append((start[0] + share * dx - out * dy / length, start[1] + share * dy + out * dx / length))
    return [*points, end]


def draw_holes(scene: Scene, shown: ShownCarrier, view: View, most: float) -> None:
    """Draw the visible holes of a carrier.

    If there are more than ``most``, only those near the pegs are drawn; see :func:`limit_holes_drawn`.
    """
    radius = max(view.scale * shown.hole_radius, 0.4)
    for hole in shown.list_holes(most):
        scene.add_circle(view(hole.center), radius, "#ffffff", GREY, min(0.9, 0.3 * radius + 0.1))


def choose_labelled(
    names: Sequence[tuple[int, float]], pegs: set[int], spacing: float
) -> list[tuple[int, float, bool]]:
    """Return (index, page coordinate, has a peg) of the columns or rows to label, sorted by index.

    Those with pegs are chosen first, at least 0.8 ``spacing`` page units apart. Then every 1st, 2nd, 5th,
    10th ... of the others is added where it is ``spacing`` from all chosen.

    Parameters
    ----------
    names : (index, page coordinate) of every column or row.
    pegs : indices of the columns or rows with pegs.
    spacing : smallest distance between labels in page units.
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


BOLT = "#c3c9d1"
# An arrow to the left about its middle, its length and its width, page units.
ARROW = [(-29.0, 0.0), (-11.0, -11.0), (-11.0, -5.0), (29.0, -5.0), (29.0, 5.0), (-11.0, 5.0), (-11.0, 11.0)]
LENGTH, WIDTH = 58.0, 22.0
# Of the pitch behind the body, how much the arrow may take, and how far it stays off the body.
SHARE, OFF = 0.95, 2.0
# A body thinner than this, page units, is drawn this thick.
THINNEST = 7.0


def draw_block_arrow(
    scene: Scene, middle: Point, direction: Point, size: float = 1.0, weight: float = 1.0
) -> None:
    """Draw an outlined arrow centred at a page point.

    ``direction`` is a vector of the plan, whose y runs up. ``size`` is a factor on its length and width,
    ``weight`` on its line width.
    """
    turn = atan2(direction[1], -direction[0])
    corners = [rotate_vectors(size * x, size * y, turn) for x, y in ARROW]
    scene.add_polygon(
        [(middle[0] + dx, middle[1] + dy) for dx, dy in corners], "#ffffff", BLACK, 1.4 * weight
    )


def compute_clamp_arrow(clamp: ShownClamp, view: View, weight: float = 1.0) -> tuple[Point, float]:
    """Return (page point of its middle, size) of the arrow behind a clamp; the size is a factor on
    ``LENGTH``.
    """
    start = max(clamp.carrier.peg_radius * view.scale, THINNEST * weight / 2) + OFF * weight
    length = min(LENGTH * weight, max(SHARE * clamp.pitch * view.scale - start, 0.3 * LENGTH * weight))
    return view(clamp.compute_point_behind((start + length / 2) / view.scale)), length / LENGTH


def avoid_clamp(placer: LabelPlacer, clamp: ShownClamp, view: View) -> None:
    """Mark a clamp's drawing and its arrow for the label placer to avoid."""
    (x, y), size = compute_clamp_arrow(clamp, view)
    along, across = size * LENGTH / 2, size * WIDTH / 2
    half_x, half_y = (across, along) if clamp.pushes_along_column else (along, across)
    placer.avoid_box(Box(x - half_x, y - half_y, x + half_x, y + half_y))
    placer.avoid_box(view.map_box(clamp.extent))


def draw_clamp(scene: Scene, clamp: ShownClamp, plate: ShownCarrier, view: View, weight: float) -> None:
    """Draw a clamp: in a known hole its body and bolt, otherwise the dashed line of holes along which its tip
    moves.
    """
    group = scene.group("clamp")
    tip = view((clamp.tip.x, clamp.tip.y))
    if clamp.hole is None:
        box = view.map_box(plate.plate)
        ends = (
            [(tip[0], box.y1), (tip[0], box.y0)]
            if clamp.pushes_along_column
            else [(box.x0, tip[1]), (box.x1, tip[1])]
        )
        group.add_line(ends, BLACK, 1.0 * weight, stroke_dasharray="7 4", **{"class": "clamp-line"})
    else:
        hole, width = view(clamp.hole), max(2 * clamp.carrier.peg_radius * view.scale, THINNEST * weight)
        fill, edge = SLIDING
        group.add_line([hole, tip], edge, width, stroke_linecap="round", **{"class": "clamp-body"})
        group.add_line([hole, tip], fill, max(width - 3.0 * weight, 0.6 * width), stroke_linecap="round")
        draw_bolt(group, hole, min(view.scale * plate.hole_radius, 0.8 * width / 2), weight)


def draw_push(scene: Scene, clamp: ShownClamp, view: View, weight: float) -> None:
    """Draw the arrow that shows a clamp's push, behind the clamp and above everything drawn so far."""
    middle, size = compute_clamp_arrow(clamp, view, weight)
    draw_block_arrow(scene.group("clamp-push"), middle, clamp.clamping, size, weight)


def draw_bolt(scene: Scene, at: Point, radius: float, weight: float = 1.0) -> None:
    """Draw a hexagon bolt of a radius in page units."""
    scene.add_circle(at, radius, BOLT, BLACK, 1.1 * weight, **{"class": "bolt"})
    corners = [
        (at[0] + 0.55 * radius * cos(k * pi / 3), at[1] + 0.55 * radius * sin(k * pi / 3)) for k in range(6)
    ]
    scene.add_polygon(corners, "#ffffff", GREY, 0.8 * weight)


def draw_sign(scene: Scene, at: Point) -> None:
    """Draw the legend's clamp sign centred at a page point."""
    fill, edge = SLIDING
    ends = [(at[0] + 9, at[1]), (at[0] - 9, at[1])]
    scene.add_line(ends, edge, 14, stroke_linecap="round")
    scene.add_line(ends, fill, 11, stroke_linecap="round")
    draw_bolt(scene, ends[0], 4.5)
