"""Plots of some curves over a logarithmic axis, and of rows of bars, as SVG that the manual shows."""

from __future__ import annotations

from collections.abc import Sequence
from math import log10

from attrs import frozen

from workhold.drawing.scene import GREY, Box, Scene

__all__ = ["CALLED", "Bar", "Curve", "bar_plot", "line_plot"]

PAGE = (960.0, 600.0)
FRAME = Box(110.0, 40.0, 700.0, 510.0)
SMALL, TEXT = 18.0, 20.0
PALE = "#d8dce2"
# The kinds of toolkits as plots and tables call them.
CALLED = {
    "vise": "vise",
    "opening-vise": "opening vise",
    "translating-clamp": "plate",
    "edge": "fence",
    "flat-jaw": "flat jaw",
}
COLOURS = ("#1f6fb5", "#c2410c", "#15803d", "#7e22ce", "#b45309", "#0f766e")


@frozen
class Curve:
    """A curve: what it is called, and its points."""

    name: str
    points: Sequence[tuple[float, float]]


@frozen
class Bar:
    """A row of a plot of bars: its name, the value, the range about it, and what is written behind it."""

    name: str
    value: float
    low: float
    high: float
    words: str


def line_plot(curves: Sequence[Curve], title: str, across: str, up: str) -> str:
    """Curves over a logarithmic axis, from 0 to 100 upwards."""
    scene = Scene.make_page(PAGE, title)
    xs = sorted({x for curve in curves for x, _ in curve.points})
    low, high = log10(xs[0]), log10(xs[-1])

    def place(x: float, y: float) -> tuple[float, float]:
        share = (log10(x) - low) / (high - low)
        return FRAME.x0 + share * FRAME.width, FRAME.y1 - y / 100 * FRAME.height

    for x in xs:
        at = place(x, 0)[0]
        scene.add_line([(at, FRAME.y0), (at, FRAME.y1)], PALE, 1.0)
        scene.add_text((at, FRAME.y1 + 26), f"{x:g}", SMALL, "middle", fill=GREY)
    for y in range(0, 101, 20):
        at = place(xs[0], y)[1]
        scene.add_line([(FRAME.x0, at), (FRAME.x1, at)], PALE, 1.0)
        scene.add_text((FRAME.x0 - 12, at), f"{y}", SMALL, "end", fill=GREY)
    scene.add_rectangle(FRAME, "none", GREY, 1.5)
    scene.add_text((FRAME.center[0], PAGE[1] - 30), across, TEXT, "middle")
    scene.add_text((30, FRAME.center[1]), up, TEXT, "middle", turned=90.0)
    for number, curve in enumerate(curves):
        colour = COLOURS[number % len(COLOURS)]
        points = [place(x, y) for x, y in sorted(curve.points)]
        scene.add_line(points, colour, 2.5)
        for point in points:
            scene.add_circle(point, 4.5, colour, colour, 1.0)
        at = FRAME.y0 + 20 + 30 * number
        scene.add_line([(FRAME.x1 + 20, at), (FRAME.x1 + 50, at)], colour, 3.0)
        scene.add_text((FRAME.x1 + 58, at), curve.name, SMALL, "start")
    return scene.to_svg()


def bar_plot(bars: Sequence[Bar], title: str, across: str, most: float) -> str:
    """Bars from 1 to the right on a logarithmic axis, each with the range about it as a thin line."""
    high = 60.0 + 30.0 * len(bars) + 70.0
    scene = Scene.make_page((PAGE[0], high), title)
    left, right, top = 250.0, 830.0, 30.0

    def place(x: float) -> float:
        return left + log10(min(max(x, 1.0), most)) / log10(most) * (right - left)

    bottom = top + 30.0 * len(bars)
    for x in (1, 1.5, 2, 3, 5, 10, 20, 50, 100):
        if x <= most:
            scene.add_line([(place(x), top), (place(x), bottom)], PALE, 1.0)
            scene.add_text((place(x), bottom + 20), f"{x:g}", SMALL, "middle", fill=GREY)
    for number, bar in enumerate(bars):
        y = top + 30.0 * number + 15.0
        scene.add_text((left - 12, y), bar.name, SMALL, "end")
        scene.add_line([(place(bar.low), y), (place(bar.high), y)], GREY, 1.5)
        if bar.value > 1:
            scene.add_rectangle(Box(left, y - 8, place(bar.value), y + 8), COLOURS[0], COLOURS[0], 1.0)
        scene.add_text((right + 16, y), bar.words, SMALL, "start", fill=GREY)
    scene.add_line([(left, top), (left, bottom)], GREY, 1.5)
    scene.add_text(((left + right) / 2, bottom + 52), across, TEXT, "middle")
    return scene.to_svg()
