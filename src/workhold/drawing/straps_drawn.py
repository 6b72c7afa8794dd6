"""Straps over a part on its plan: bars from the bolts' holes to the tips, and the push by hand."""

from __future__ import annotations

from math import cos, hypot, radians, sin

from workhold.drawing.annotation import LabelPlacer
from workhold.drawing.scene import BLACK, GREY, Box, Scene, View
from workhold.drawing.support_signs import draw_pad
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Point
from workhold.model.straps import HandPush, Strap, StrappedHold
from workhold.model.support_request import find_usual_pad_radius

__all__ = ["avoid_straps", "draw_straps"]

BAR_FILL, HAND = "#8a93a3", "#0b3a82"
# A hand's arrow in page units.
ARROW_LENGTH = 46.0
# Half the size of a strap's number, and half the length of the hand's word, page units.
NUMBER_REACH, WORD_REACH = 8.0, 16.0


def draw_straps(scene: Scene, hold: StrappedHold, toolkit: Toolkit, view: View, weight: float) -> None:
    """Draw the straps and supports of a seat, and the push by hand.

    Where straps are bolted in holes of their own, these holes are drawn too.
    """
    straps = toolkit.strap_set
    assert straps is not None
    radius = max(straps.tip_radius * view.scale, 3.0)
    plate = toolkit.plates[0]
    bolt = max(plate.peg_radius * view.scale, 2.5)
    pad = max(find_usual_pad_radius(toolkit) * view.scale, 4.0)
    for place in hold.supports:
        x, y = plate.compute_hole_center(*place)
        draw_pad(scene.group("supports"), view((float(x), float(y))), pad)
    for number, one in enumerate(hold.straps, 1):
        group = scene.group("strap")
        hole = straps.bolts.compute_hole_center(*one.hole)
        start, tip = view((float(hole[0]), float(hole[1]))), view(one.at)
        far = locate_heel(start, tip, radius)
        group.add_line([far, tip], BAR_FILL, 1.5 * radius, stroke_linecap="round", stroke_opacity="0.55")
        group.add_circle(tip, radius, "none", BLACK, 1.2 * weight)
        group.add_circle(start, bolt, "#ffffff", BLACK, 1.6 * weight)
        size = 0.6 * bolt
        for way in (1.0, -1.0):
            ends = [(start[0] - size, start[1] - way * size), (start[0] + size, start[1] + way * size)]
            group.add_line(ends, BLACK, 1.0 * weight)
        if weight >= 1.0:
            x, y = locate_number(one, start, tip)
            group.add_text((x, y + 4), str(number), 11, "middle", bold=True)
    if hold.push is not None:
        turn = radians(hold.push.direction_deg)
        x, y = view(hold.push.at)
        start = locate_hand(hold.push, view, weight)
        hand = scene.group("push")
        hand.add_arrow(start, (x, y), HAND, 2.4 * weight, 11 * weight)
        if weight >= 1.0:
            beyond = start[0] - 9 * cos(turn), start[1] + 9 * sin(turn) + 4
            hand.add_text(beyond, "hand", 11, "middle", fill=GREY, halo=3.0)


def locate_number(strap: Strap, start: Point, tip: Point) -> Point:
    """Return the page point of a strap's number: its tip, and over a support, whose sign is below the tip, the middle
    of its bar. ``start`` and ``tip`` are the page points of bolt and tip.
    """
    return tip if strap.over is None else ((start[0] + tip[0]) / 2, (start[1] + tip[1]) / 2)


def locate_hand(push: HandPush, view: View, weight: float) -> Point:
    """Return the page point at which the arrow of a hand's push begins."""
    turn, (x, y), long = radians(push.direction_deg), view(push.at), ARROW_LENGTH * weight
    return x - long * cos(turn), y + long * sin(turn)


def avoid_straps(placer: LabelPlacer, hold: StrappedHold, toolkit: Toolkit, view: View) -> None:
    """Mark straps with their numbers, and the push by hand, for the label placer to avoid."""
    straps = toolkit.strap_set
    assert straps is not None
    radius = max(straps.tip_radius * view.scale, NUMBER_REACH)
    for one in hold.straps:
        hole = straps.bolts.compute_hole_center(*one.hole)
        start, tip = view((float(hole[0]), float(hole[1]))), view(one.at)
        x, y = locate_number(one, start, tip)
        placer.avoid_box(Box(*tip, *tip).grow(radius))
        placer.avoid_box(Box(x, y, x, y).grow(NUMBER_REACH))
        placer.avoid_box(Box(*start, *start).grow(radius / 2))
        placer.avoid_line(start, tip, 8.0)
    if hold.push is not None:
        x, y = locate_hand(hold.push, view, 1.0)
        placer.avoid_line((x, y), view(hold.push.at), 8.0)
        placer.avoid_box(Box(x, y, x, y).grow(WORD_REACH))


def locate_heel(start: Point, tip: Point, radius: float) -> Point:
    """Return the page point at which a strap's bar ends behind its bolt.

    ``start`` is the bolt, ``tip`` the strap's tip, ``radius`` the half width of the bar, in page units.
    """
    far = hypot(start[0] - tip[0], start[1] - tip[1]) or 1.0
    behind = 1.0 + 2.0 * radius / far
    return tip[0] + (start[0] - tip[0]) * behind, tip[1] + (start[1] - tip[1]) * behind
