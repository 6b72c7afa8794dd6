"""The plot of docs/benchmarks.md: time against simultaneous contacts, both logarithmic, drawn from the figures kept."""

from __future__ import annotations

from math import exp
from typing import Any

from loglog import FRAME, PAGE, SMALL, Axes, draw_grid, fitted
from workhold.drawing.scene import BLACK, GREY, Scene

__all__ = ["drawn"]

LINE = 30.0
BLUE = "#1f6fb5"
# A line of so many seconds a contact, to read the points by.
REFERENCE = 200e-9

Points = list[dict[str, Any]]


def pair(point: dict[str, Any]) -> tuple[float, float]:
    """Contacts and seconds."""
    return point["contacts"], point["seconds"]


def drawn(rows: Points, growing: Points, part: str) -> str:
    """The plot as SVG text.

    Parameters
    ----------
    rows : ``contacts`` and ``seconds`` of the rows of Table 1.
    growing : the same of the part that grows, in order, and whether ``all`` fixtures were listed.
    part : what that part is called.
    """
    axes = Axes.around([pair(point) for point in rows + growing if point["contacts"] > 0])
    scene = Scene.make_page(PAGE, "Time of a proven search against its simultaneous contacts, one thread")
    draw_grid(scene, axes, "simultaneous contacts A", "seconds, one thread")
    draw_reference(scene, axes)
    fit = fitted([pair(point) for point in growing])
    if fit is not None:
        ends = [growing[0]["contacts"], growing[-1]["contacts"]]
        line = [axes.place(contacts, exp(fit[1]) * contacts ** fit[0]) for contacts in ends]
        scene.add_line(line, BLUE, 2.0)
    for point in rows:
        if point["contacts"] > 0:
            scene.add_circle(axes.place(*pair(point)), 6.0, "#ffffff", BLACK, 2.0)
    for point in growing:
        fill = BLUE if point["all"] else "#ffffff"
        scene.add_circle(axes.place(*pair(point)), 7.0, fill, BLUE, 2.0)
    draw_legend(scene, part, fit, all(point["all"] for point in growing))
    return scene.to_svg()


def draw_reference(scene: Scene, axes: Axes) -> None:
    """The line of so many seconds a contact, as far as it lies in the frame."""
    low = max(10.0**axes.x0, 10.0**axes.y0 / REFERENCE)
    high = min(10.0**axes.x1, 10.0**axes.y1 / REFERENCE)
    if low < high:
        ends = [axes.place(contacts, REFERENCE * contacts) for contacts in (low, high)]
        scene.add_line(ends, GREY, 2.0, stroke_dasharray="9 7")


def draw_legend(scene: Scene, part: str, fit: tuple[float, float] | None, lists_all: bool) -> None:
    """What the signs mean."""
    x, y = FRAME.x0 + 24.0, FRAME.y0 + 28.0
    scene.add_circle((x, y), 6.0, "#ffffff", BLACK, 2.0)
    scene.add_text((x + 24.0, y), "rows of Table 1", SMALL)
    y += LINE
    scene.add_circle((x, y), 7.0, BLUE, BLUE, 2.0)
    scene.add_text((x + 24.0, y), f"{part}, grown against the pitch", SMALL)
    if not lists_all:
        y += LINE
        scene.add_circle((x, y), 7.0, "#ffffff", BLUE, 2.0)
        scene.add_text((x + 24.0, y), "the same, the best kept", SMALL)
    if fit is not None:
        y += LINE
        scene.add_line([(x - 14.0, y), (x + 14.0, y)], BLUE, 2.0)
        scene.add_text((x + 24.0, y), f"A to the power {fit[0]:.2f}, fitted", SMALL)
    y += LINE
    scene.add_line([(x - 14.0, y), (x + 14.0, y)], GREY, 2.0, stroke_dasharray="9 7")
    scene.add_text((x + 24.0, y), f"{1e9 * REFERENCE:.0f} ns for each contact", SMALL)
