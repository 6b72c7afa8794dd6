"""Places for straps and supports that the tools of a program do not hit.

A strap's bar is as wide as its tip. It reaches from the tip over its bolt to a heel, as far behind the bolt
as the bar is wide. All are obstacles up to the straps' standout above the face under the tip: the bar from
that face upward, bolt and heel from the plate upward. Pads are obstacles below the part, such as to a drill
that comes through.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.contact.swept import SweptSpans, find_swept_below, find_swept_between
from workhold.conventions import GAP_SLACK
from workhold.model.pose import Pose
from workhold.model.program import Program
from workhold.model.straps import StrapHardware

__all__ = ["are_clear", "keep_clear"]

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


def find_heels(tip: Array, bolt: Array, tip_radius: float) -> Array:
    """Return the points at which the bars of straps end behind their bolts, (N, 2) in mm.

    ``tip`` and ``bolt`` are (N, 2) in mm.
    """
    away = bolt - tip
    far = np.hypot(away[:, 0], away[:, 1])[:, None]
    return np.asarray(
        bolt + 2.0 * tip_radius * np.divide(away, far, out=np.zeros_like(away), where=far > 0.0)
    )


def are_clear(
    program: Program, pose: Pose, tip: Array, bolt: Array, heights: Array, straps: StrapHardware
) -> BoolArray:
    """Return a mask (N,): True for straps that all tools of a program clear.

    Parameters
    ----------
    pose : pose of the part on the plate.
    tip : (N, 2) points at which the straps press, in mm in the plate's frame.
    bolt : (N, 2) centres of the straps' bolts, in mm in the plate's frame.
    heights : (N,) heights of the faces under the tips, in mm above the part's lower side.
    """
    radius = straps.tip_radius
    heel = find_heels(tip, bolt, radius)
    tip, bolt, heel = (move_into_part(pose, one) for one in (tip, bolt, heel))
    out = np.ones(len(tip), np.bool_)
    for height in np.unique(heights).tolist():
        own, top = np.flatnonzero(heights == height), height + straps.standout
        below = find_swept_below(program, top)
        out[own] &= keep_clear(below, program, bolt[own], heel[own], radius)
        above = find_swept_between(program, height, top)
        out[own] &= keep_clear(above, program, tip[own], heel[own], radius)
    return out


def move_into_part(pose: Pose, points: Array) -> Array:
    """Return points (N, 2) of the plate's frame in the part's coordinates, in mm."""
    x, y = pose.inverse.apply(points[:, 0], points[:, 1])
    return np.column_stack([x, y])


def keep_clear(swept: SweptSpans, program: Program, starts: Array, ends: Array, radius: float) -> BoolArray:
    """Return a mask (N,): True for capsules that keep the program's clearance from the space that its tools
    sweep.

    A capsule is all points within ``radius`` mm of the segment from ``starts[k]`` to ``ends[k]``, (N, 2) in
    the part's coordinates.
    """
    if not len(starts):
        return np.zeros(0, np.bool_)
    reach, _ = swept.find_nearest_spans(starts, ends)
    out = reach >= program.clearance + radius - GAP_SLACK
    for x0, y0, x1, y1 in swept.filled.tolist():
        # Of a box the distance is that to its border, also from within.
        out &= ~((starts >= (x0, y0)) & (starts <= (x1, y1))).all(axis=1)
    return np.asarray(out)
