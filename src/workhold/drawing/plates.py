"""The plates of a toolkit with their holes, drawn from the description of what shows (``model.shown``)."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from workhold.drawing.scene import GREY, Box, Scene, View
from workhold.geometry.segment import Point
from workhold.model.shown import Shown, ShownCarrier, Side

__all__ = ["SLIDING", "draw_holes", "draw_plate", "draw_wall", "labelled", "most_holes"]

# Fill and edge of a plate that stands still, and of one that slides.
FENCE = "#cfd6dd", "#3d4a58"
STILL, SLIDING = ("#dbe4ee", "#7c8da1"), ("#f1e7d6", "#a8946f")

# With holes closer than this on the page, in page units, only those near the pegs are drawn.
CLOSEST_HOLES = 5.0


def most_holes(view: View, shown: Shown) -> float:
    """More holes than this are drawn near the pegs only: none of a lattice too fine for the page, else all."""
    return 0 if shown.pitch * view.scale < CLOSEST_HOLES else inf


def draw_plate(scene: Scene, shown: ShownCarrier, view: View, tooth: float = 5.0) -> None:
    """Draw a plate; broken sides are zigzags with teeth of ``tooth`` page units."""
    box = view.box(shown.plate)
    corners = [(box.x0, box.y1), (box.x1, box.y1), (box.x1, box.y0), (box.x0, box.y0)]
    sides: list[Side] = ["bottom", "right", "top", "left"]
    runs = [
        zigzag(corners[k], corners[(k + 1) % 4], tooth) if side in shown.broken else [corners[k], corners[(k + 1) % 4]]
        for k, side in enumerate(sides)
    ]
    fill, edge = STILL if shown.clamping is None else SLIDING
    scene.polygon([point for run in runs for point in run[:-1]], fill)
    for side, run in zip(sides, runs, strict=True):
        scene.line(run, edge, 0.8 if side in shown.broken else 2.0, stroke_linecap="round")


def draw_wall(scene: Scene, bar: Box, view: View, weight: float = 1.0) -> None:
    """Draw a wall, a bar in mm: hatched below the line that the part lies on."""
    box = view.box(bar)
    scene.rectangle(box, FENCE[0])
    high, step = box.height, max(box.height * 0.8, 6.0 * weight)
    for k in range(1, int((box.width + high) / step) + 1):
        # Strokes at 45 degrees, cut off at the bar's ends.
        foot = box.x0 - high + k * step
        low, top = max(foot, box.x0), min(foot + high, box.x1)
        if low < top:
            ends = [(low, box.y1 - (low - foot)), (top, box.y1 - (top - foot))]
            scene.line(ends, FENCE[1], 0.9 * weight, **{"class": "hatching"})
    scene.line([(box.x0, box.y0), (box.x1, box.y0)], FENCE[1], 2.6 * weight, **{"class": "fence"})


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


def draw_holes(scene: Scene, shown: ShownCarrier, view: View, most: float) -> None:
    """Draw the holes that show; of more than ``most`` those near the pegs."""
    radius = max(view.scale * shown.hole_radius, 0.4)
    for hole in shown.holes(most):
        scene.circle(view(hole.center), radius, "#ffffff", GREY, min(0.9, 0.3 * radius + 0.1))


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
