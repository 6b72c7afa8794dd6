"""Contact features: where a peg's centre may lie while the peg touches a face (paper, section 2.3).

Glossary
--------
peg-centre locus : boundary of (part + disc of the peg radius).
contact feature : a straight or circular piece of the locus that faces a face; one face may leave several.
"""

from __future__ import annotations

from math import hypot, pi, tau

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from holdfast.geometry.offset import trimmed_offsets
from holdfast.geometry.segment import Arc, Segment, segment_rows
from holdfast.model.workpiece import Workpiece

__all__ = ["ContactFeature", "contact_features", "end_slacks", "feature_rows", "outline_diameter"]

# A contact this near to the end of its feature, in mm, is at the end.
ROUNDING = 1e-9
# Ends this near, in mm, with normals this near, are a tangent joint.
JOINT = 1e-6
TANGENT = 1e-5


@frozen
class ContactFeature:
    """A piece of the peg-centre locus.

    Parameters
    ----------
    face : number of the face that the peg touches.
    segment : where the peg's centre may lie; its normals are those of the contact.
    """

    face: int
    segment: Segment


def contact_features(workpiece: Workpiece, peg_radius: float) -> list[ContactFeature]:
    """The contact features of a workpiece for pegs of a radius in mm, ordered by face."""
    faces = workpiece.faces
    pieces = trimmed_offsets([face.segment for face in faces], peg_radius)
    return [ContactFeature(faces[index].number, piece) for index, piece in pieces]


def feature_rows(features: list[ContactFeature]) -> NDArray[np.float64]:
    """Kernel rows (N, 8) of contact features."""
    return segment_rows([feature.segment for feature in features])


def end_slacks(features: list[ContactFeature]) -> NDArray[np.float64]:
    """How far in mm a contact may lie past each feature's low and high end, shape (F, 2).

    Where two features join tangentially a contact exactly at the joint counts (for both, and is listed once), so rounding
    is forgiven. Any other end does not count: there the peg also touches a second face or stands on a corner.
    """
    ends = np.array([[f.segment.at(-f.segment.half_extent), f.segment.at(f.segment.half_extent)] for f in features])
    normals = np.array(
        [[f.segment.normal(-f.segment.half_extent), f.segment.normal(f.segment.half_extent)] for f in features]
    )
    points, directions = ends.reshape(-1, 2), normals.reshape(-1, 2)
    owner = np.repeat(np.arange(len(features)), 2)
    slack = np.full(len(points), -ROUNDING)
    for k in range(len(points)):
        near = np.abs(points - points[k]).max(axis=1) <= JOINT
        smooth = np.abs(directions - directions[k]).max(axis=1) <= TANGENT
        if (near & smooth & (owner != owner[k])).any():
            slack[k] = ROUNDING
    return slack.reshape(-1, 2)


def outline_diameter(workpiece: Workpiece) -> float:
    """Largest distance in mm between two points of the silhouette.

    It is reached between two joints, between a joint and the far side of an arc, or between the far sides of two arcs;
    far sides lie on the line through the arcs' centres.
    """
    outer = [face.segment for face in workpiece.faces if face.number < len(workpiece.loops[0])]
    best = 0.0
    for index, a in enumerate(outer):
        for b in outer[index:]:
            best = max(best, segments_diameter(a, b))
    return best


def segments_diameter(a: Segment, b: Segment) -> float:
    """Largest distance in mm between a point of one segment and a point of another."""
    best = max(hypot(p[0] - q[0], p[1] - q[1]) for p in (a.start, a.end) for q in (b.start, b.end))
    for arc, other in ((a, b), (b, a)):
        if isinstance(arc, Arc):
            for q in (other.start, other.end):
                best = max(best, far_side(arc, q))
    if isinstance(a, Arc) and isinstance(b, Arc):
        far_a, far_b = far_point(a, b.center), far_point(b, a.center)
        if far_a is not None and far_b is not None:
            best = max(best, hypot(far_a[0] - far_b[0], far_a[1] - far_b[1]))
        opposite = abs((a.mid_angle - b.mid_angle) % tau - pi)
        if a.center == b.center and opposite <= a.half_sweep + b.half_sweep:
            best = max(best, a.radius + b.radius)
    return best


def far_point(arc: Arc, point: tuple[float, float]) -> tuple[float, float] | None:
    """The point of an arc's circle farthest from a point, if it lies on the arc."""
    dx, dy = arc.center[0] - point[0], arc.center[1] - point[1]
    distance = hypot(dx, dy)
    if distance == 0.0:
        return None
    far = (arc.center[0] + arc.radius * dx / distance, arc.center[1] + arc.radius * dy / distance)
    return far if abs(arc.parameter(far)) <= arc.half_sweep else None


def far_side(arc: Arc, point: tuple[float, float]) -> float:
    """Distance in mm from a point to the far side of an arc, 0 if that is not on the arc."""
    far = far_point(arc, point)
    return 0.0 if far is None else hypot(far[0] - point[0], far[1] - point[1])
