"""Dimensions, scale bars and angles in the manner of ISO 129: thin lines, text on top, arrows outside when tight."""

from __future__ import annotations

from math import cos, floor, hypot, log10, pi, radians, sin
from typing import Literal

from workhold.drawing.fonts import text_width
from workhold.drawing.length_unit import LengthUnit
from workhold.drawing.scene import BLACK, GREY, Box, Scene, number
from workhold.geometry.segment import Point

__all__ = ["BEYOND", "angle_mark", "dimension", "round_length", "scale_bar"]

TIGHT = 34.0
# How far beyond the end of a line a text too long for it stands, page units.
BEYOND = 8.0


def dimension(
    scene: Scene,
    start: Point,
    end: Point,
    text: str,
    size: float = 15.0,
    bold: bool = False,
    beyond: Literal["upper", "lower"] | None = None,
) -> Box:
    """Draw a dimension line between two page points, its text above it, readable from below or the right.

    Parameters
    ----------
    beyond : which end of an upright line a text that is longer than it is written beyond.

    Returns the box of the text.
    """
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = hypot(dx, dy)
    ux, uy = (dx / length, dy / length) if length > 0 else (1.0, 0.0)
    if length >= TIGHT:
        scene.arrow(((start[0] + end[0]) / 2, (start[1] + end[1]) / 2), start, BLACK, 1.0, 11)
        scene.arrow(((start[0] + end[0]) / 2, (start[1] + end[1]) / 2), end, BLACK, 1.0, 11)
    else:
        scene.line([start, end], BLACK, 1.0)
        scene.arrow((start[0] - 24 * ux, start[1] - 24 * uy), start, BLACK, 1.0, 11)
        scene.arrow((end[0] + 24 * ux, end[1] + 24 * uy), end, BLACK, 1.0, 11)
    middle = ((start[0] + end[0]) / 2 + 0.75 * size * uy, (start[1] + end[1]) / 2 - 0.85 * size * abs(ux))
    if abs(ux) < abs(uy):
        middle = (min(start[0], end[0]) - 0.75 * size, (start[1] + end[1]) / 2)
        if beyond is not None and text_width(text, size, bold) > length:
            away = text_width(text, size, bold) / 2 + BEYOND
            y = min(start[1], end[1]) - away if beyond == "upper" else max(start[1], end[1]) + away
            middle = (middle[0], y)
        scene.text(middle, text, size, "middle", bold, halo=3, turned=90)
        return Box.about(middle, size, text_width(text, size, bold))
    scene.text(middle, text, size, "middle", bold, halo=3)
    return Box.about(middle, text_width(text, size, bold), size)


def round_length(length: float) -> float:
    """The largest of 1, 2 or 5 times a power of ten that is not above ``length``.

    >>> round_length(37.0), round_length(0.9)
    (20.0, 0.5)
    """
    power = 10.0 ** floor(log10(length))
    return float(next(k * power for k in (5, 2, 1) if k * power <= length * (1 + 1e-9)))


def scale_bar(
    scene: Scene,
    at: Point,
    scale: float,
    lengths: LengthUnit,
    longest: float = 150.0,
    size: float = 12.0,
    more: str = "",
) -> float:
    """Draw a bar of a round length with its lower left corner at a page point; return its total width.

    Parameters
    ----------
    scale : page units for a mm.
    lengths : the unit in which the length is round.
    longest : page units the bar may take.
    more : words behind the length.
    """
    scale *= lengths.unit.millimetres
    length = round_length(longest / scale)
    x, y = at
    part = length * scale / 4
    bar = scene.group("scale")
    for k in range(4):
        corners = [(x + k * part, y - 6), (x + (k + 1) * part, y - 6), (x + (k + 1) * part, y), (x + k * part, y)]
        bar.polygon(corners, BLACK if k % 2 == 0 else "#ffffff", BLACK, 0.8)
    text = f"{length:g} {lengths.sign}{more}"
    bar.text((x + 4 * part + 8, y - 3), text, size)
    return 4 * part + 8 + text_width(text, size)


def angle_mark(scene: Scene, center: Point, theta_deg: float, radius: float, reach: float) -> None:
    """Draw the turn from the vise's x axis (a dashed line) to the part's (an arrow) around a page point."""
    x, y = center
    theta = radians(theta_deg % 360.0)
    mark = scene.group("pose")
    mark.line([(x, y), (x + reach, y)], GREY, 1.0, stroke_dasharray="5 3")
    mark.arrow((x, y), (x + reach * cos(theta), y - reach * sin(theta)), GREY, 1.4, 9)
    mark.circle(center, 2.2, GREY)
    if theta * radius < 10.0:
        return
    end = theta - 7.0 / radius  # leave room for the head
    pieces = max(1, floor(end / (pi / 2)) + 1)
    d = f"M{number(x + radius)} {number(y)}"
    for k in range(1, pieces + 1):
        a = end * k / pieces
        d += f"A{number(radius)} {number(radius)} 0 0 0 {number(x + radius * cos(a))} {number(y - radius * sin(a))}"
    mark.path(d, GREY, 1.0)
    tip = (x + radius * cos(theta), y - radius * sin(theta))
    mark.arrow_head(tip, -(theta + pi / 2) + 3.5 / radius, GREY, 7.5)
