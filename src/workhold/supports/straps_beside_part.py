"""Places for straps beside material of a solid that rises above the face on which they press.

A strap's bar is at the height of the face under its tip. It extends from the tip over its bolt to a heel; the
heel is as far behind the bolt as the bar is wide. Material of the part above that face must be clear of the
bar. A bolt stands beside the whole part, also beside material that overhangs above the locators. A part from
a drawing has no material above its upper face.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import GAP_SLACK
from workhold.model.pose import Pose
from workhold.model.support_request import SupportRequest
from workhold.model.workpiece import Workpiece
from workhold.supports.faces import LevelRegions
from workhold.supports.straps_past_tools import find_heels, move_into_part

__all__ = ["are_beside_part", "are_beside_rising"]

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
# In mm, what bars keep clear; no shorter half of a piece of a bar's axis is looked at by itself.
KEPT = 0.01


def are_beside_rising(
    request: SupportRequest, pose: Pose, tip: Array, bolt: Array, heights: Array, tip_radius: float
) -> BoolArray:
    """Return a mask (N,): True for straps whose bars are clear of all material above the face under their
    tips.

    Parameters
    ----------
    request : faces of the part, and the regions that rise above them.
    pose : pose of the part on the plate.
    tip, bolt : (N, 2) points at which the straps press, and centres of their bolts, in mm in the plate's
        frame.
    heights : (N,) heights of the faces under the tips, in mm above the part's lower side.
    tip_radius : radius of the tips, and half the width of the bars, in mm.
    """
    out = np.ones(len(tip), np.bool_)
    if not request.rising:
        return out
    rising = LevelRegions.from_loops(request.rising, request.rising_heights)
    ends = find_heels(tip, bolt, tip_radius)
    starts, ends = move_into_part(pose, tip), move_into_part(pose, ends)
    for height in np.unique(heights).tolist():
        own = np.flatnonzero(heights == height)
        out[own] = keep_clear_of_regions(rising, height, starts[own], ends[own], tip_radius)
    return out


def keep_clear_of_regions(
    regions: LevelRegions, height: float, starts: Array, ends: Array, radius: float
) -> BoolArray:
    """Return a mask (N,): True for capsules that keep 0.01 mm, or a little less, from the regions at a height.

    A capsule is all points within ``radius`` mm of the segment from ``starts[k]`` to ``ends[k]``, (N, 2). A
    piece of a capsule is clear if its middle is farther from the regions than the radius plus half the
    piece's length; other pieces are halved.
    """
    out = np.ones(len(starts), np.bool_)
    number, first, last = np.arange(len(starts)), starts, ends
    while len(number):
        middle = (first + last) / 2
        half = np.hypot(*(last - first).T) / 2
        room = regions.measure_distances(height, middle) - radius
        out[number[room < KEPT]] = False
        open_ = out[number] & (room < half) & (half > KEPT)
        number, first, middle, last = number[open_], first[open_], middle[open_], last[open_]
        number = np.concatenate([number, number])
        first, last = np.concatenate([first, middle]), np.concatenate([middle, last])
    return out


def are_beside_part(workpiece: Workpiece, points: Array, radius: float) -> BoolArray:
    """Return a mask (N,): True for round bolts that are clear of a solid at all heights.

    ``points`` (N, 2) are their centres in mm in the part's coordinates. All are True for a part from a
    drawing.
    """
    out = np.ones(len(points), np.bool_)
    for regions in list_regions_above(workpiece):
        for height in regions.borders:
            out &= regions.measure_distances(height, points) >= radius - GAP_SLACK
    return out


def list_regions_above(workpiece: Workpiece) -> Iterator[LevelRegions]:
    """Yield the regions of a solid that are visible from above: its upper faces, and the regions that rise
    above them.
    """
    solid = workpiece.solid
    if solid is None:
        return
    top = solid.top or ()
    groups = (top, solid.top_heights or (solid.height,) * len(top)), (solid.rising, solid.rising_heights)
    for loops, heights in groups:
        yield LevelRegions.from_loops([np.array(loop) for loop in loops], heights)
