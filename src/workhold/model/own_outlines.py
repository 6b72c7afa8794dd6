"""Outlines of carriers with heights of their own, in addition to the outline that all other pegs meet.

A peg that extends from height a to p meets a solid in the outline U(a, p + head room). So a clamp whose tip
begins above a flange, or a wall lower than the pegs, meets a separate outline, with separate bands. This is
handled as follows:

- A workpiece keeps the outline of each such carrier as a workpiece of its own, without remarks. Numbers of
  segments continue: after those of the workpiece come those of the first outline, and so on, in the order of
  the toolkit's carriers. So a face's number determines its outline, and code that only passes numbers on need
  not know about outlines.
- Carriers of the same heights share one outline and its numbers.
- Contacts of a carrier lie on the touchable faces of its outline, trimmed by that outline alone. The search,
  the engines and the proof already take separate rows of features for two carriers. The second test of
  clearance, and the test of a clamp's body, use the carrier's outline.
- The part lies flush on a wall with the hull of the wall's outline.
- A face that is avoided stands for the faces of the solid over it, which are avoided in every outline.
- The diameter, by which moments are scaled and chords are bounded, is that of all outlines together. The
  centre that moments are about stays that of the workpiece.
- A rotation of the part counts where it carries every outline onto itself.
- Half a turn does not swap jaws of different heights.

A drawing without heights is the same at all of them, and so has no such outlines.

Glossary
--------
role : the name that carriers of the same heights share, such as "clamp" for the clamps of all directions.
own outline : the outline that carriers of a role meet.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import hypot, pi, sin, tau
from typing import Any

import numpy as np
from attrs import evolve

from workhold.errors import InputError
from workhold.fixels.carrier import Heights
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Segment
from workhold.model.solid import NO_LEVELS, SolidOutline
from workhold.model.workpiece import Workpiece

__all__ = [
    "adapt_outlines_to_toolkit",
    "number_solid",
    "measure_outline_diameter",
    "name_outline",
    "measure_segments_diameter",
    "add_own_outlines",
]

# Distances that differ by less in proportion may be equal but for rounding.
ROUNDED = 1e-9


def name_outline(heights: Heights) -> str:
    """Return the name of the outline between two heights in mm,
    the same for all carriers with these heights.
    """
    return f"outline from {heights[0]:g} to {heights[1]:g} mm"


def number_solid(workpiece: Workpiece) -> SolidOutline | None:
    """Return a part's solid with bands, faces and runs for
    the segments of all outlines; None without a solid.

    Segments of own outlines have the numbers that follow those of the part.
    """
    if workpiece.solid is None or not workpiece.outlines:
        return workpiece.solid
    every = workpiece.numbered
    return evolve(workpiece.solid, bands=every.bands, faces=every.over, runs=every.runs)


def adapt_outlines_to_toolkit(workpiece: Workpiece, toolkit: Toolkit) -> Workpiece:
    """Return the workpiece with only those own outlines that the toolkit's carriers meet, in the order of
    ``toolkit.heights``.

    Raises InputError where the solid was read without the heights of a carrier.
    """
    wanted = {} if workpiece.solid is None else toolkit.heights
    if not wanted and not workpiece.outlines:
        return workpiece
    known, chosen = dict(workpiece.outlines), list[tuple[str, Workpiece]]()
    for role, (low, high) in wanted.items():
        own = known.get(role)
        if own is None or own.solid is None or (own.solid.low, own.solid.peg_height) != (low, high):
            raise InputError(
                f"the {role} of this {toolkit.noun} touches from {low:g} to {high:g} mm, but "
                f"{workpiece.name} was read without these heights: read the file of the solid with them, "
                "as workhold design does, or in Python load(..., heights=toolkit.heights)."
            )
        chosen.append((role, own))
    outlines = tuple(chosen)
    return workpiece if outlines == workpiece.outlines else evolve(workpiece, outlines=outlines)


def add_own_outlines(
    workpiece: Workpiece, entries: Mapping[str, Mapping[str, Any]], heights: Mapping[str, Heights]
) -> Workpiece:
    """Return the workpiece with the own outlines in the entry ``outlines`` of a result file.

    Parameters
    ----------
    entries : by role, the outline's loops and bands and, where known, the solid's faces.
    heights : by role, the heights in the file's toolkit, in its order.

    Raises
    ------
    InputError
        For a workpiece without a solid, impossible outlines, and roles without heights.
    """
    if workpiece.solid is None:
        raise InputError("it has outlines of carriers, but no solid: leave them out.")
    others = [role for role in entries if role not in heights]
    if others:
        raise InputError(f"it has an outline of the {others[0][:40]}, which has no heights of its own.")
    own = []
    for role, (low, high) in heights.items():
        if role in entries:
            bands, faces = entries[role]["bands"], entries[role].get("solid_faces") or ()
            runs = entries[role].get("runs") or ()
            changed = {"bands": bands, "runs": runs, "faces": faces, **NO_LEVELS}
            solid = evolve(workpiece.solid, low=low, peg_height=high, **changed)
            outline = workpiece.from_loops(name_outline((low, high)), entries[role]["loops"], solid=solid)
            own.append((role, outline))
    return evolve(workpiece, outlines=tuple(own))


def measure_outline_diameter(workpiece: Workpiece) -> float:
    """Return the largest distance in mm between two points of the outer loops of the part and its carriers'
    outlines.

    The two points are two joints, a joint and the far side of an arc, or the far sides of two arcs: points of
    an arc's circle on the line through both centres, or through centre and joint.
    """
    outer = [face.segment for one in workpiece.every_outline for face in one.outer_faces]
    middle = np.array([segment.compute_point(0.0) for segment in outer])
    reach = np.array([measure_reach_from_middle(segment) for segment in outer])
    apart = [np.hypot(*(middle[index:] - middle[index]).T) for index in range(len(outer))]
    best, least = 0.0, max(float(distances.max()) for distances in apart)
    for index, distances in enumerate(apart):
        # Only pairs that are far enough apart are looked at closely.
        most = (distances + reach[index] + reach[index:]) * (1.0 + ROUNDED)
        for other in index + np.flatnonzero(most >= max(best, least)):
            best = max(best, measure_segments_diameter(outer[index], outer[other]))
    return best


def measure_reach_from_middle(segment: Segment) -> float:
    """Return the largest distance in mm between the middle of a segment and a point of it."""
    if isinstance(segment, Arc):
        return 2.0 * segment.radius * sin(min(segment.half_sweep, pi) / 2.0)
    return segment.half_extent


def measure_segments_diameter(a: Segment, b: Segment) -> float:
    """Return the largest distance in mm between a point of segment a and a point of segment b."""
    best = max(hypot(p[0] - q[0], p[1] - q[1]) for p in (a.start, a.end) for q in (b.start, b.end))
    for arc, other in ((a, b), (b, a)):
        if isinstance(arc, Arc):
            for q in (other.start, other.end):
                if (far := find_far_point(arc, q)) is not None:
                    best = max(best, hypot(far[0] - q[0], far[1] - q[1]))
    if isinstance(a, Arc) and isinstance(b, Arc):
        far_a, far_b = find_far_point(a, b.center), find_far_point(b, a.center)
        if far_a is not None and far_b is not None:
            best = max(best, hypot(far_a[0] - far_b[0], far_a[1] - far_b[1]))
        opposite = abs((a.mid_angle - b.mid_angle) % tau - pi)
        if a.center == b.center and opposite <= a.half_sweep + b.half_sweep:
            best = max(best, a.radius + b.radius)
    return best


def find_far_point(arc: Arc, point: tuple[float, float]) -> tuple[float, float] | None:
    """Return the point farthest from ``point`` on an arc's circle.

    Return None where that point is not on the arc, or is not unique.
    """
    dx, dy = arc.center[0] - point[0], arc.center[1] - point[1]
    distance = hypot(dx, dy)
    if distance == 0.0:
        return None
    far = (arc.center[0] + arc.radius * dx / distance, arc.center[1] + arc.radius * dy / distance)
    return far if abs(arc.find_parameter(far)) <= arc.half_sweep else None
