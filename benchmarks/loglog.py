"""A plot with both axes logarithmic: the frame, its grid at the powers of ten, and the straight line fitted."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, floor, log, log10

from attrs import frozen

from workhold.drawing.scene import GREY, Box, Scene
from workhold.geometry.segment import Point

__all__ = ["FRAME", "PAGE", "SMALL", "Axes", "draw_grid", "fitted"]

PAGE = (960.0, 640.0)
FRAME = Box(120.0, 40.0, 920.0, 550.0)
SMALL, TEXT = 20.0, 22.0
PALE = "#d8dce2"

Pair = tuple[float, float]


@frozen
class Axes:
    """Powers of ten at the ends of both axes."""

    x0: int
    x1: int
    y0: int
    y1: int

    @classmethod
    def around(cls, points: Sequence[Pair]) -> Axes:
        """The least whole powers of ten around some points."""
        xs, ys = [log10(x) for x, _ in points], [log10(y) for _, y in points]
        return cls(floor(min(xs)), ceil(max(xs)), floor(min(ys)), ceil(max(ys)))

    def place(self, x: float, y: float) -> Point:
        """A point on the page."""
        across = (log10(x) - self.x0) / (self.x1 - self.x0)
        up = (log10(y) - self.y0) / (self.y1 - self.y0)
        return FRAME.x0 + across * FRAME.width, FRAME.y1 - up * FRAME.height


def fitted(points: Sequence[Pair]) -> Pair | None:
    """Slope and height at 1 of log y against log x, by least squares; None for fewer than two points."""
    if len(points) < 2:
        return None
    xs, ys = [log(x) for x, _ in points], [log(y) for _, y in points]
    x, y = sum(xs) / len(xs), sum(ys) / len(ys)
    slope = sum((a - x) * (b - y) for a, b in zip(xs, ys, strict=True)) / sum((a - x) ** 2 for a in xs)
    return slope, y - slope * x


def draw_grid(scene: Scene, axes: Axes, across: str, up: str) -> None:
    """Lines at the powers of ten, what they are, and what the axes are."""
    for power in range(axes.x0, axes.x1 + 1):
        x, _ = axes.place(10.0**power, 10.0**axes.y0)
        scene.add_line([(x, FRAME.y0), (x, FRAME.y1)], PALE, 1.0)
        draw_power(scene, (x - 4.0, FRAME.y1 + 26.0), power, "middle")
    for power in range(axes.y0, axes.y1 + 1):
        _, y = axes.place(10.0**axes.x0, 10.0**power)
        scene.add_line([(FRAME.x0, y), (FRAME.x1, y)], PALE, 1.0)
        draw_power(scene, (FRAME.x0 - 30.0, y), power, "end")
    scene.add_rectangle(FRAME, "none", GREY, 1.5)
    scene.add_text((FRAME.center[0], PAGE[1] - 28.0), across, TEXT, "middle")
    scene.add_text((28.0, FRAME.center[1]), up, TEXT, "middle", turned=90.0)


def draw_power(scene: Scene, at: Point, power: int, anchor: str) -> None:
    """A power of ten with its exponent raised, without signs that typefaces lack."""
    scene.add_text(at, "10", SMALL, anchor, fill=GREY)
    shift = 12.0 if anchor == "middle" else 1.0
    scene.add_text((at[0] + shift, at[1] - 9.0), str(power).replace("-", "−"), 0.7 * SMALL, fill=GREY)
