"""The plot of docs/benchmarks.md: time against simultaneous contacts, both logarithmic, drawn from the figures kept."""

from __future__ import annotations

from math import ceil, exp, floor, log, log10
from typing import Any

from attrs import frozen

from workhold.drawing.scene import BLACK, GREY, Box, Scene
from workhold.geometry.segment import Point

__all__ = ["drawn"]

PAGE = (960.0, 640.0)
FRAME = Box(120.0, 40.0, 920.0, 550.0)
SMALL, TEXT, LINE = 20.0, 22.0, 30.0
BLUE, PALE = "#1f6fb5", "#d8dce2"
# A line of so many seconds a contact, to read the points by.
REFERENCE = 200e-9

Points = list[dict[str, Any]]


@frozen
class Axes:
    """Powers of ten at the ends of both axes."""

    x0: int
    x1: int
    y0: int
    y1: int

    @classmethod
    def around(cls, points: Points) -> Axes:
        """The least whole powers of ten around some points."""
        xs = [log10(point["contacts"]) for point in points]
        ys = [log10(point["seconds"]) for point in points]
        return cls(floor(min(xs)), ceil(max(xs)), floor(min(ys)), ceil(max(ys)))

    def place(self, contacts: float, seconds: float) -> Point:
        """A point on the page."""
        x = (log10(contacts) - self.x0) / (self.x1 - self.x0)
        y = (log10(seconds) - self.y0) / (self.y1 - self.y0)
        return FRAME.x0 + x * FRAME.width, FRAME.y1 - y * FRAME.height


def drawn(rows: Points, growing: Points, part: str) -> str:
    """The plot as SVG text.

    Parameters
    ----------
    rows : ``contacts`` and ``seconds`` of the rows of Table 1.
    growing : the same of the part that grows, in order, and whether ``all`` fixtures were listed.
    part : what that part is called.
    """
    axes = Axes.around([point for point in rows + growing if point["contacts"] > 0])
    scene = Scene.page(PAGE, "Time of a proven search against its simultaneous contacts, one thread")
    draw_grid(scene, axes)
    draw_reference(scene, axes)
    fit = fitted(growing)
    if fit is not None:
        ends = [growing[0]["contacts"], growing[-1]["contacts"]]
        line = [axes.place(contacts, exp(fit[1]) * contacts ** fit[0]) for contacts in ends]
        scene.line(line, BLUE, 2.0)
    for point in rows:
        if point["contacts"] > 0:
            scene.circle(axes.place(point["contacts"], point["seconds"]), 6.0, "#ffffff", BLACK, 2.0)
    for point in growing:
        fill = BLUE if point["all"] else "#ffffff"
        scene.circle(axes.place(point["contacts"], point["seconds"]), 7.0, fill, BLUE, 2.0)
    draw_legend(scene, part, fit, all(point["all"] for point in growing))
    return scene.svg()


def fitted(points: Points) -> tuple[float, float] | None:
    """Slope and height at A = 1 of log time against log A, by least squares; None for fewer than two points."""
    if len(points) < 2:
        return None
    xs, ys = [log(point["contacts"]) for point in points], [log(point["seconds"]) for point in points]
    x, y = sum(xs) / len(xs), sum(ys) / len(ys)
    slope = sum((a - x) * (b - y) for a, b in zip(xs, ys, strict=True)) / sum((a - x) ** 2 for a in xs)
    return slope, y - slope * x


def draw_grid(scene: Scene, axes: Axes) -> None:
    """Lines at the powers of ten, what they are, and what the axes are."""
    for power in range(axes.x0, axes.x1 + 1):
        x, _ = axes.place(10.0**power, 10.0**axes.y0)
        scene.line([(x, FRAME.y0), (x, FRAME.y1)], PALE, 1.0)
        draw_power(scene, (x - 4.0, FRAME.y1 + 26.0), power, "middle")
    for power in range(axes.y0, axes.y1 + 1):
        _, y = axes.place(10.0**axes.x0, 10.0**power)
        scene.line([(FRAME.x0, y), (FRAME.x1, y)], PALE, 1.0)
        draw_power(scene, (FRAME.x0 - 30.0, y), power, "end")
    scene.rectangle(FRAME, "none", GREY, 1.5)
    scene.text((FRAME.center[0], PAGE[1] - 28.0), "simultaneous contacts A", TEXT, "middle")
    scene.text((28.0, FRAME.center[1]), "seconds, one thread", TEXT, "middle", turned=90.0)


def draw_power(scene: Scene, at: Point, power: int, anchor: str) -> None:
    """A power of ten with its exponent raised, without signs that typefaces lack."""
    scene.text(at, "10", SMALL, anchor, fill=GREY)
    shift = 12.0 if anchor == "middle" else 1.0
    scene.text((at[0] + shift, at[1] - 9.0), str(power).replace("-", "−"), 0.7 * SMALL, fill=GREY)


def draw_reference(scene: Scene, axes: Axes) -> None:
    """The line of so many seconds a contact, as far as it lies in the frame."""
    low = max(10.0**axes.x0, 10.0**axes.y0 / REFERENCE)
    high = min(10.0**axes.x1, 10.0**axes.y1 / REFERENCE)
    if low < high:
        ends = [axes.place(contacts, REFERENCE * contacts) for contacts in (low, high)]
        scene.line(ends, GREY, 2.0, stroke_dasharray="9 7")


def draw_legend(scene: Scene, part: str, fit: tuple[float, float] | None, lists_all: bool) -> None:
    """What the signs mean."""
    x, y = FRAME.x0 + 24.0, FRAME.y0 + 28.0
    scene.circle((x, y), 6.0, "#ffffff", BLACK, 2.0)
    scene.text((x + 24.0, y), "rows of Table 1", SMALL)
    y += LINE
    scene.circle((x, y), 7.0, BLUE, BLUE, 2.0)
    scene.text((x + 24.0, y), f"{part}, grown against the pitch", SMALL)
    if not lists_all:
        y += LINE
        scene.circle((x, y), 7.0, "#ffffff", BLUE, 2.0)
        scene.text((x + 24.0, y), "the same, the best kept", SMALL)
    if fit is not None:
        y += LINE
        scene.line([(x - 14.0, y), (x + 14.0, y)], BLUE, 2.0)
        scene.text((x + 24.0, y), f"A to the power {fit[0]:.2f}, fitted", SMALL)
    y += LINE
    scene.line([(x - 14.0, y), (x + 14.0, y)], GREY, 2.0, stroke_dasharray="9 7")
    scene.text((x + 24.0, y), f"{1e9 * REFERENCE:.0f} ns for each contact", SMALL)
