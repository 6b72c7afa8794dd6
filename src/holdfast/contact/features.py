"""Contact features: where a peg's centre may lie while the peg touches a face (paper, section 2.3).

Glossary
--------
peg-centre locus : boundary of (part + disc of the peg radius).
contact feature : a straight or circular piece of the locus that faces a face; one face may leave several.
"""

from __future__ import annotations

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from holdfast.geometry.offset import trimmed_offsets
from holdfast.geometry.segment import Segment, segment_rows
from holdfast.model.workpiece import Workpiece

__all__ = ["ContactFeature", "contact_features", "end_slacks", "feature_rows"]

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
