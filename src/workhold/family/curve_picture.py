"""The curve of a family drawn: set-ups to the right, the worst loss upward."""

from __future__ import annotations

from itertools import pairwise
from math import ceil, floor, isfinite, log10

from workhold.drawing.fonts import text_width
from workhold.drawing.panel import plural
from workhold.drawing.scene import BLACK, GREY, LANDSCAPE, Box, Scene
from workhold.family.curve import Point
from workhold.family.family import Family
from workhold.family.losses import loss_text

__all__ = ["draw_curve"]

EDGE, HEADER = 32.0, 84.0
LINE, CHOSEN, GRID = "#0b3a82", "#b3122a", "#d5d9de"
# Room for numbers and words at the axes, page units.
AT_LEFT, BELOW = 84.0, 70.0
# Losses that have a line, as far as the curve reaches.
MOST_LINES = 9


def draw_curve(family: Family, chosen: Point | None = None) -> str:
    """Draw the curve of a family on A4, as SVG text.

    Parameters
    ----------
    chosen : the point whose plan was picked, which is marked.
    """
    held = f"{plural(len(family.members), 'part')} {family.toolkit.wording.inside}"
    scene = Scene.page(LANDSCAPE, f"{held}: set-ups and loss")
    width, height = LANDSCAPE
    group = scene.group("heading")
    group.text((EDGE, EDGE + 12), held, 26, bold=True)
    words = (
        f"The loss is the {family.figure.words} over the best that each part has; at each point that of the worst part."
    )
    group.text((EDGE, EDGE + 44), words, 15, fill=GREY)
    room = Box(EDGE + AT_LEFT, EDGE + HEADER, width - EDGE - 30, height - EDGE - BELOW)
    points = [point for point in family.points if isfinite(point.loss)]
    if not points:
        group.text(room.center, "No number of set-ups has a loss that is finite.", 16, "middle")
        return scene.svg()
    draw_axes_and_points(scene, room, points, chosen)
    return scene.svg()


def draw_axes_and_points(scene: Scene, room: Box, points: list[Point], chosen: Point | None) -> None:
    """Draw the axes with their numbers, and the points with theirs."""
    last, most = points[-1].setups, points[0].loss
    step = nice_step(max(most - 1.0, 0.02) / MOST_LINES)
    top = 1.0 + step * max(ceil((most - 1.0) / step - 1e-9), 1)
    first = points[0].setups

    def at(setups: float, loss: float) -> tuple[float, float]:
        across = (setups - first + 0.5) / (last - first + 1)
        return room.x0 + across * room.width, room.y1 - (loss - 1.0) / (top - 1.0) * (room.height - 30)

    axes = scene.group("axes")
    decimals = max(0, -floor(log10(step) + 1e-9))
    for k in range(round((top - 1.0) / step) + 1):
        y = at(first, 1.0 + k * step)[1]
        axes.line([(room.x0, y), (room.x1, y)], GRID if k else BLACK, 1.0)
        axes.text((room.x0 - 10, y), f"{1.0 + k * step:.{max(decimals, 1)}f}", 14, "end")
    every = next(k for k in (1, 2, 5, 10, 20, 50, 100, 1000) if room.width / (last - first + 1) * k >= 26)
    for setups in range(first, last + 1):
        if (setups - first) % every == 0 or setups == last:
            x = at(setups, 1.0)[0]
            axes.line([(x, room.y1), (x, room.y1 + 6)], BLACK, 1.0)
            axes.text((x, room.y1 + 20), str(setups), 14, "middle")
    axes.text((room.center[0], room.y1 + 48), "set-ups", 15, "middle", bold=True)
    axes.text((room.x0 - 62, room.center[1]), "worst loss", 15, "middle", bold=True, turned=90)
    curve = scene.group("curve")
    for one, other in pairwise(points):
        # Numbers of set-ups in between lose as much as the smaller one.
        corner = at(other.setups, one.loss)
        curve.line([at(one.setups, one.loss), corner], LINE, 2.0)
        curve.line([corner, at(other.setups, other.loss)], LINE, 1.2, stroke_dasharray="3 4")
    taken: list[Box] = []
    for point in points:
        here, is_chosen = at(point.setups, point.loss), point == chosen
        proven = point.is_least and point.at_least == point.setups
        curve.circle(here, 8.0 if is_chosen else 5.5, CHOSEN if is_chosen else LINE if proven else "#ffffff", LINE, 1.6)
        words = loss_text(point.loss) + ("" if proven else " or less")
        box = Box(here[0] + 6, here[1] - 24, here[0] + 10 + text_width(words, 13, bold=is_chosen), here[1] - 8)
        if is_chosen or all(box.overlap(other) == 0 for other in taken):
            taken.append(box)
            curve.text((box.x0, here[1] - 16), words, 13, bold=is_chosen, halo=2.5)


def nice_step(least: float) -> float:
    """The smallest of 1, 2 or 5 times a power of ten that is not below ``least``.

    >>> nice_step(0.07), nice_step(0.2), nice_step(3)
    (0.1, 0.2, 5.0)
    """
    power = 10.0 ** floor(log10(least))
    return float(next(round(k * power, 12) for k in (1, 2, 5, 10) if k * power >= least * (1 - 1e-9)))
