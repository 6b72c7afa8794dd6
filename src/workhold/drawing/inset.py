"""A small picture of the part as it was drawn, so that the turn in the vise can be told from it."""

from __future__ import annotations

from workhold.conventions import AGREEMENT
from workhold.drawing.bench import ARROW, PART_FILL, TOUCHED
from workhold.drawing.part import contact_of, face_of, outline_path, segment_path
from workhold.drawing.scene import BLACK, GREY, Box, Scene, View, number
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.intersect import bounding_box
from workhold.geometry.segment import Point
from workhold.model.fixture import Fixture
from workhold.model.part_zero import hole_centers
from workhold.model.workpiece import Workpiece

__all__ = ["draw_inset", "draw_zero"]

# Flatter than this, in page units, there is no room for a picture.
LOWEST = 90.0
# Size of the number of a hole.
NUMBER = 10.0


def draw_inset(
    scene: Scene, box: Box, workpiece: Workpiece, fixture: Fixture, toolkit: Toolkit, zero: Point | None = None
) -> None:
    """Draw the unturned part with its touched faces and contacts into a page box.

    Parameters
    ----------
    zero : part zero in the part's coordinates, mm, to mark where it lies within the part's extent; holes are numbered too.
    """
    if box.height < LOWEST:
        return
    group = scene.group("part-as-drawn")
    group.text((box.x0, box.y0 + 8), "The part as drawn (θ = 0°)", 13, fill=GREY)
    room = Box(box.x0 + 40, box.y0 + 30, box.x1 - 10, box.y1 - 24)
    bounds = Box(*workpiece.bounds)
    view = View.fitting(bounds, room)
    d = outline_path(workpiece.loop_segments, view)
    group.path(d, fill=PART_FILL, fill_rule="evenodd")
    for face in dict.fromkeys(peg.face for peg in fixture.pegs if peg.beside is None):
        group.path(segment_path(face_of(workpiece, face), view), TOUCHED, 5.0)
    group.path(d, BLACK, 1.4)
    for point in contacts(workpiece, fixture, toolkit):
        group.circle(view(point), 3.0, ARROW, "#ffffff", 1.0)
    if zero is not None:
        number_holes(group, view, workpiece)
        if bounds.grown(AGREEMENT).contains(Box(*zero, *zero)):
            draw_zero(group, view(zero))
    corner = (box.x0 + 4, box.y1 - 4)
    group.arrow(corner, (corner[0] + 30, corner[1]), GREY, 1.2, 8)
    group.arrow(corner, (corner[0], corner[1] - 30), GREY, 1.2, 8)
    group.text((corner[0] + 34, corner[1] - 1), "x", 12, fill=GREY)
    group.text((corner[0] + 5, corner[1] - 33), "y", 12, fill=GREY)


def number_holes(scene: Scene, view: View, workpiece: Workpiece) -> None:
    """Write the number of each hole at its centre, where it has room for it."""
    for count, (loop, center) in enumerate(zip(workpiece.loop_segments[1:], hole_centers(workpiece), strict=True), 1):
        boxes = [bounding_box(segment) for segment in loop]
        room = min(max(box[k + 2] for box in boxes) - min(box[k] for box in boxes) for k in (0, 1)) * view.scale
        if room >= NUMBER + 2:
            scene.text(view(center), str(count), NUMBER, "middle", fill=GREY)


def draw_zero(scene: Scene, at: Point, radius: float = 5.0) -> None:
    """Draw the sign of a zero point, a disc with two black quarters."""
    x, y = at
    r = number(radius)
    scene.circle(at, radius, "#ffffff", BLACK, 1.0)
    for way in (1, -1):
        start, end = f"{number(x + way * radius)} {number(y)}", f"{number(x)} {number(y - way * radius)}"
        scene.path(f"M{number(x)} {number(y)}L{start}A{r} {r} 0 0 0 {end}Z", fill=BLACK)


def contacts(workpiece: Workpiece, fixture: Fixture, toolkit: Toolkit) -> list[Point]:
    """The contact points in the workpiece's own frame, mm."""
    back = fixture.pose.inverse
    return [
        contact_of(toolkit.carrier(peg.carrier).contact, back.apply(peg.x, peg.y), face_of(workpiece, peg.face))[0]
        for peg in fixture.pegs
    ]
