"""Clamps that are bolted to a plate: their bodies, bolts and lines, and an arrow in the direction in which each pushes."""

from __future__ import annotations

from math import atan2, cos, pi, sin

from workhold.drawing.labels import LabelPlacer
from workhold.drawing.plates import SLIDING
from workhold.drawing.scene import BLACK, GREY, Box, Scene, View
from workhold.geometry.rotation import rotated
from workhold.geometry.segment import Point
from workhold.model.clamp import ShownClamp
from workhold.model.shown import ShownCarrier

__all__ = ["avoid_clamp", "block_arrow", "draw_clamp", "draw_push", "draw_sign"]

BOLT = "#c3c9d1"
# An arrow to the left about its middle, its length and its width, page units.
ARROW = [(-29.0, 0.0), (-11.0, -11.0), (-11.0, -5.0), (29.0, -5.0), (29.0, 5.0), (-11.0, 5.0), (-11.0, 11.0)]
LENGTH, WIDTH = 58.0, 22.0
# Of the pitch behind the body, how much the arrow may take, and how far it stays off the body.
SHARE, OFF = 0.95, 2.0
# A body thinner than this, page units, is drawn this thick.
THINNEST = 7.0


def block_arrow(scene: Scene, middle: Point, direction: Point, size: float = 1.0, weight: float = 1.0) -> None:
    """Draw an outlined arrow about a page point in a direction of the plan, whose y runs up."""
    turn = atan2(direction[1], -direction[0])
    corners = [rotated(size * x, size * y, turn) for x, y in ARROW]
    scene.polygon([(middle[0] + dx, middle[1] + dy) for dx, dy in corners], "#ffffff", BLACK, 1.4 * weight)


def clamp_arrow(clamp: ShownClamp, view: View, weight: float = 1.0) -> tuple[Point, float]:
    """Middle of the arrow behind a clamp on the page, and its size beside that of a plate that slides."""
    start = max(clamp.carrier.peg_radius * view.scale, THINNEST * weight / 2) + OFF * weight
    length = min(LENGTH * weight, max(SHARE * clamp.pitch * view.scale - start, 0.3 * LENGTH * weight))
    return view(clamp.behind((start + length / 2) / view.scale)), length / LENGTH


def avoid_clamp(placer: LabelPlacer, clamp: ShownClamp, view: View) -> None:
    """Tell where a clamp is drawn, so that labels keep off."""
    (x, y), size = clamp_arrow(clamp, view)
    along, across = size * LENGTH / 2, size * WIDTH / 2
    half_x, half_y = (across, along) if clamp.is_upright else (along, across)
    placer.avoid_box(Box(x - half_x, y - half_y, x + half_x, y + half_y))
    placer.avoid_box(view.box(clamp.extent))


def draw_clamp(scene: Scene, clamp: ShownClamp, plate: ShownCarrier, view: View, weight: float) -> None:
    """Draw a clamp: its body with the bolt, or where the hole is not known the line of holes its tip is on."""
    group = scene.group("clamp")
    tip = view((clamp.tip.x, clamp.tip.y))
    if clamp.hole is None:
        box = view.box(plate.plate)
        ends = [(tip[0], box.y1), (tip[0], box.y0)] if clamp.is_upright else [(box.x0, tip[1]), (box.x1, tip[1])]
        group.line(ends, BLACK, 1.0 * weight, stroke_dasharray="7 4", **{"class": "clamp-line"})
    else:
        hole, width = view(clamp.hole), max(2 * clamp.carrier.peg_radius * view.scale, THINNEST * weight)
        fill, edge = SLIDING
        group.line([hole, tip], edge, width, stroke_linecap="round", **{"class": "clamp-body"})
        group.line([hole, tip], fill, max(width - 3.0 * weight, 0.6 * width), stroke_linecap="round")
        draw_bolt(group, hole, min(view.scale * plate.hole_radius, 0.8 * width / 2), weight)


def draw_push(scene: Scene, clamp: ShownClamp, view: View, weight: float) -> None:
    """Draw the arrow behind a clamp that tells which way it pushes; over the part, as it may stand in a hole of it."""
    middle, size = clamp_arrow(clamp, view, weight)
    block_arrow(scene.group("clamp-push"), middle, clamp.clamping, size, weight)


def draw_bolt(scene: Scene, at: Point, radius: float, weight: float = 1.0) -> None:
    """Draw the head of a bolt with its hexagonal socket about a page point."""
    scene.circle(at, radius, BOLT, BLACK, 1.1 * weight, **{"class": "bolt"})
    corners = [(at[0] + 0.55 * radius * cos(k * pi / 3), at[1] + 0.55 * radius * sin(k * pi / 3)) for k in range(6)]
    scene.polygon(corners, "#ffffff", GREY, 0.8 * weight)


def draw_sign(scene: Scene, at: Point) -> None:
    """Draw the sign of a clamp for a legend about a page point."""
    fill, edge = SLIDING
    ends = [(at[0] + 9, at[1]), (at[0] - 9, at[1])]
    scene.line(ends, edge, 14, stroke_linecap="round")
    scene.line(ends, fill, 11, stroke_linecap="round")
    draw_bolt(scene, ends[0], 4.5)
