"""The bodies of a vise with flat jaws that tools must not run into: jaws, work stop, parallels and bed.

The frame is the vise's in mm: x along the jaws from their left end, y from the fixed jaw's face, z = 0 at the
lower side of what is held.
"""

from __future__ import annotations

from attrs import frozen

from workhold.fixels.jaw_pair import JawPair
from workhold.geometry.segment import Arc, Box, Line, Segment
from workhold.model.jaw_hold import JawHold
from workhold.model.pose import Pose
from workhold.model.workpiece import Workpiece

__all__ = ["ViseBody", "find_stop_level", "find_stop_stretch", "list_parallel_boxes", "list_vise_bodies"]

# mm. How far outward a jaw whose thickness is not given, and what carries the work stop, reach.
ENDLESS = 1e4
# mm. What lies so near to the outermost point of a part is as far out.
OUTERMOST = 1e-6


@frozen
class ViseBody:
    """A body of a vise: a box seen from above, with all that is below it.

    Parameters
    ----------
    name : such as "fixed jaw".
    box : in mm, from above.
    top : height of its upper side in mm; inf for a jaw of any height.
    """

    name: str
    box: Box
    top: float


def find_stop_level(workpiece: Workpiece, jaws: JawPair, hold: JawHold, pose: Pose) -> float:
    """Return y in mm at which the work stop touches a part: the middle of the longest straight face at that
    end.

    Where only points of the part are farthest out, it is the lowest of them. Without a stop it is the middle
    of the opening.
    """
    low, high = find_stop_stretch(workpiece, jaws, hold, pose)
    return (low + high) / 2


def find_stop_stretch(workpiece: Workpiece, jaws: JawPair, hold: JawHold, pose: Pose) -> tuple[float, float]:
    """Return the least and the greatest y in mm of the face of a part that the work stop touches.

    It is the longest straight face at that end. Where only points of the part are farthest out, both are the y
    of the lowest of them; without a stop, both are the middle of the opening.
    """
    if hold.stop is None:
        return hold.opening / 2, hold.opening / 2
    outline, _ = workpiece.find_outline(jaws.name_outline_role(hold.parallels))
    placed = [pose.carry(segment) for segment in outline.segments[: outline.outer_count]]
    points = [point for segment in placed for point in list_far_points(segment)]
    xs = [x for x, _ in points]
    x = min(xs) if hold.stop == "left" else max(xs)
    faces = [
        sorted((one.start[1], one.end[1]))
        for one in placed
        if isinstance(one, Line) and max(abs(one.start[0] - x), abs(one.end[0] - x)) < OUTERMOST
    ]
    if faces:
        low, high = min(faces, key=lambda face: (round(face[0] - face[1], 6), face[0]))
        return low, high
    lowest = min(y for at, y in points if abs(at - x) < OUTERMOST)
    return lowest, lowest


def list_far_points(segment: Segment) -> list[tuple[float, float]]:
    """Return the ends of a segment; for an arc also its leftmost and rightmost points."""
    points = [segment.start, segment.end]
    if isinstance(segment, Arc):
        (x, y), radius = segment.center, segment.radius
        sides = [(x - radius, y), (x + radius, y)]
        points += [side for side in sides if abs(segment.find_parameter(side)) <= segment.half_sweep]
    return points


def list_parallel_boxes(jaws: JawPair, hold: JawHold) -> list[Box]:
    """Return the parallel on the side of the fixed jaw and that on the side of the moving one, in mm; [] on
    the bed.
    """
    if not hold.parallels:
        return []
    thick, (near, far) = jaws.compute_parallel_thickness(hold.opening), hold.parallel_offsets
    rows = (near, near + thick), (hold.opening - far - thick, hold.opening - far)
    return [Box(0.0, low, jaws.width, high) for low, high in rows]


def list_vise_bodies(jaws: JawPair, hold: JawHold, height: float | None, stop_level: float) -> list[ViseBody]:
    """Return both jaws, the work stop, the two parallels and the bed, those that are there.

    Parameters
    ----------
    height : of the part in mm; None where not known.
    stop_level : y in mm at which the work stop touches, as of :func:`find_stop_level`.
    """
    top, width, opening = jaws.compute_top(hold.parallels), jaws.width, hold.opening
    depth = ENDLESS if jaws.thickness is None else jaws.thickness
    bodies = [
        ViseBody("fixed jaw", Box(0.0, -depth, width, 0.0), top),
        ViseBody("moving jaw", Box(0.0, opening, width, opening + depth), top),
    ]
    if hold.stop is not None:
        low, high = (
            (-ENDLESS, jaws.stop_offset)
            if hold.stop == "left"
            else (width - jaws.stop_offset, width + ENDLESS)
        )
        half = jaws.stop_width / 2
        box = Box(low, stop_level - half, high, stop_level + half)
        bodies.append(ViseBody("work stop", box, top if height is None else min(top, height)))
    for box in list_parallel_boxes(jaws, hold):
        bodies.append(ViseBody("parallel", box, 0.0))
    return [*bodies, ViseBody("bed of the vise", Box(0.0, 0.0, width, opening), 0.0 - hold.parallels)]
