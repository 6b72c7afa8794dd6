"""Two flat jaws seen from the end of the vise, with parallels and part: the grip, and the height above the
jaws.
"""

from __future__ import annotations

from math import inf

from workhold.drawing.annotation import draw_dimension
from workhold.drawing.bench import PART_FILL, RAW_FILL, TOUCHED
from workhold.drawing.carriers import draw_jaw
from workhold.drawing.panel import TextColumn
from workhold.drawing.scene import BLACK, GREY, Box, LengthUnit, Scene, View
from workhold.fixels.jaw_pair import JawPair
from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import JawHold
from workhold.model.shown import bound_placed_part
from workhold.model.vise_bodies import list_parallel_boxes

__all__ = ["draw_jaw_side"]

# Room for dimensions at the right and below, and the largest height of the view, page units.
BESIDE, BELOW, HIGHEST = 74.0, 30.0, 190.0
# From the words of one height to those of the next, page units.
LABEL_ROOM = 24.0
# Of the opening: how wide jaws are drawn.
JAW_SHARE = 0.28


def draw_jaw_side(
    column: TextColumn, fixture: Fixture, jaws: JawPair, height: float | None, lengths: LengthUnit
) -> None:
    """Draw the view from the left end of the jaws into a text column, the fixed jaw at the left.

    The column continues below the view. ``height`` is the part's in mm. Nothing is drawn if it is None, or if
    the part is not held by flat jaws.
    """
    hold = fixture.hold
    if not isinstance(hold, JawHold) or height is None:
        return
    opening, low = hold.opening, -hold.parallels
    top = height if jaws.height is None else jaws.compute_top(hold.parallels)
    thick = JAW_SHARE * opening
    bed = 0.12 * (height - low)
    extent = Box(-thick, low - bed, opening + thick, max(height, top))
    room = Box(column.x, column.y + 14, column.x + column.width - BESIDE, column.y + HIGHEST)
    view = View.fit_box(extent, room)
    # The view stands at the upper left of its room.
    (x, y), left = view((extent.x0, extent.y1)), view.left
    view = View(view.scale, left - (x - room.x0), view.top - (y - room.y0))
    foot = view((0.0, extent.y0))[1]
    scene = column.scene.group("side-view")
    draw_bodies(scene, view, jaws, hold, top, thick, bed)
    draw_part_side(scene, view, fixture, height)
    draw_heights(scene, view, fixture, top, height, lengths)
    start, end = view((0.0, extent.y0)), view((opening, extent.y0))
    draw_dimension(
        scene,
        (start[0], foot + 22),
        (end[0], foot + 22),
        f"S = {lengths.format_length(opening)}",
        12,
        bold=True,
    )
    for x in (start[0], end[0]):
        scene.add_line([(x, foot + 2), (x, foot + 25)], GREY, 0.6)
    scene.add_text((view((-thick / 2, 0))[0], foot + 10), "fixed", 10, "middle", fill=GREY)
    scene.add_text((view((opening + thick / 2, 0))[0], foot + 10), "moving", 10, "middle", fill=GREY)
    column.y = foot + BELOW + 4


def draw_bodies(
    scene: Scene,
    view: View,
    jaws: JawPair,
    hold: JawHold,
    top: float,
    thick: float,
    bed: float,
) -> None:
    """Draw the bed, both jaws and the parallels; all lengths are in mm, heights from the part's lower side.

    ``top`` is the height of the jaws' upper side, ``thick`` their drawn thickness, and ``bed`` that of the
    bed.
    """
    opening, low = hold.opening, 0.0 - hold.parallels
    scene.add_rectangle(view.map_box(Box(-thick, low - bed, opening + thick, low)), "#dfe3e8", GREY, 1.0)
    draw_jaw(scene, view.map_box(Box(-thick, low, 0.0, top)), "right")
    draw_jaw(scene, view.map_box(Box(opening, low, opening + thick, top)), "left")
    for box in list_parallel_boxes(jaws, hold):
        scene.add_rectangle(view.map_box(Box(box.y0, low, box.y1, 0.0)), "#eef0f3", GREY, 1.0)


def draw_part_side(scene: Scene, view: View, fixture: Fixture, height: float) -> None:
    """Draw the part from the side, and the heights at which the jaws touch it."""
    hold = fixture.hold
    assert isinstance(hold, JawHold)
    block = view.map_box(Box(0.0, 0.0, hold.opening, height))
    query = fixture.listing.result.query
    raw, finished = query.raw, query.workpiece.finished
    if raw is None or finished is None:
        scene.add_rectangle(block, PART_FILL, BLACK, 1.6)
    else:
        scene.add_rectangle(block, RAW_FILL, BLACK, 1.6)
        placed = bound_placed_part(finished, fixture.pose)
        inside = Box(placed.y0, raw.bottom, placed.y1, height - raw.top)
        scene.add_rectangle(view.map_box(inside), PART_FILL, BLACK, 1.2)
    for patch, y in ((hold.fixed, 0.0), (hold.moving, hold.opening)):
        low, high = min(one[2] for one in patch.rectangles), max(one[3] for one in patch.rectangles)
        scene.add_line([view((y, low)), view((y, high))], TOUCHED, 6.0)


def draw_heights(
    scene: Scene, view: View, fixture: Fixture, top: float, height: float, lengths: LengthUnit
) -> None:
    """Draw dimensions at the right: the height of the part above the jaws, the grip, and the height of the
    parallels.
    """
    hold = fixture.hold
    assert isinstance(hold, JawHold)
    edge = view((hold.opening * 1.28, 0.0))[0]
    spans = [("above", top, height)] if height > top else []
    if hold.grip > 0:
        foot = max(hold.fixed.band[0], hold.moving.band[0])
        spans.append(("grip", foot, foot + hold.grip))
    if hold.parallels:
        spans.append(("parallels", -hold.parallels, 0.0))
    x, lowest = edge + 12, -inf
    for name, low, high in spans:
        (_, y0), (_, y1) = view((0.0, low)), view((0.0, high))
        for y in (y0, y1):
            scene.add_line([(edge + 2, y), (x + 5, y)], GREY, 0.6)
        scene.add_line([(x, y0), (x, y1)], BLACK, 1.0)
        # Words of what is low give way downward, so that none covers another.
        middle = lowest = max((y0 + y1) / 2, lowest + LABEL_ROOM)
        scene.add_text((x + 8, middle - 5.5), name, 10, fill=GREY)
        scene.add_text((x + 8, middle + 5.5), lengths.format_short(high - low, 4), 11, bold=True)
