"""The signs for a support and for the tip of a clamp on top, seen from above."""

from __future__ import annotations

from math import cos, pi, sin

from workhold.drawing.scene import Scene
from workhold.geometry.segment import Point

__all__ = ["SUPPORT", "draw_pad", "draw_tip"]

SUPPORT = "#1b6e3c"


def draw_pad(scene: Scene, at: Point, radius: float = 7.0) -> None:
    """Draw a support seen from above about a page point: a disc with a triangle."""
    scene.add_circle(at, radius, "#ffffff", SUPPORT, 1.6, **{"class": "support"})
    corners = [
        (at[0] + 0.72 * radius * sin(2 * pi * k / 3), at[1] - 0.72 * radius * cos(2 * pi * k / 3))
        for k in range(3)
    ]
    scene.add_polygon(corners, SUPPORT)


def draw_tip(scene: Scene, at: Point, radius: float = 7.0) -> None:
    """Draw the tip of a clamp that presses down about a page point: a disc with a cross."""
    scene.add_circle(at, radius, "#ffffff", SUPPORT, 2.2, **{"class": "top-clamp"})
    reach = radius * cos(pi / 4)
    for way in (1, -1):
        scene.add_line(
            [(at[0] - reach, at[1] - way * reach), (at[0] + reach, at[1] + way * reach)], SUPPORT, 1.8
        )
