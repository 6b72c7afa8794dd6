"""Straps over a part on its plan: bars from the bolts' holes to the tips, and the push by hand."""

from __future__ import annotations

from math import cos, hypot, radians, sin

from workhold.drawing.scene import BLACK, GREY, Scene, View
from workhold.drawing.support_signs import draw_pad
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Point
from workhold.model.straps import StrappedHold
from workhold.model.support_request import find_usual_pad_radius

__all__ = ["draw_straps"]

BAR_FILL, HAND = "#8a93a3", "#0b3a82"
# A hand's arrow in page units.
ARROW_LENGTH = 46.0


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
            # Over a support its sign is below the tip: the number stands on the bar.
            x, y = tip if one.over is None else ((start[0] + tip[0]) / 2, (start[1] + tip[1]) / 2)
            group.add_text((x, y + 4), str(number), 11, "middle", bold=True)
    if hold.push is not None:
        turn = radians(hold.push.direction_deg)
        x, y = view(hold.push.at)
        long = ARROW_LENGTH * weight
        start = x - long * cos(turn), y + long * sin(turn)
        hand = scene.group("push")
        hand.add_arrow(start, (x, y), HAND, 2.4 * weight, 11 * weight)
        if weight >= 1.0:
            beyond = start[0] - 9 * cos(turn), start[1] + 9 * sin(turn) + 4
            hand.add_text(beyond, "hand", 11, "middle", fill=GREY, halo=3.0)


def locate_heel(start: Point, tip: Point, radius: float) -> Point:
    """Return the page point at which a strap's bar ends behind its bolt.

    ``start`` is the bolt, ``tip`` the strap's tip, ``radius`` the half width of the bar, in page units.
    """
    far = hypot(start[0] - tip[0], start[1] - tip[1]) or 1.0
    behind = 1.0 + 2.0 * radius / far
    return tip[0] + (start[0] - tip[0]) * behind, tip[1] + (start[1] - tip[1]) * behind
