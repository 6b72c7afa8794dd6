"""Contact features: where a peg's centre may lie while the peg touches a face (paper, section 2.3).

Glossary
--------
peg-centre locus : boundary of (part + disc of the peg radius).
contact feature : a straight or circular piece of the locus that faces a face; one face may leave several.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from attrs import evolve, field, frozen
from numpy.typing import NDArray

from workhold.contact.swept import SweptSpans
from workhold.contact.trimming import find_line_most_in_the_way, trim_to_clear_parts
from workhold.conventions import END_SLACK, JOINT, TANGENT
from workhold.errors import InputError
from workhold.fixels.carrier import Carrier
from workhold.fixels.pegs import PegFlat
from workhold.geometry.offset import find_clear_parts, list_trimmed_offsets
from workhold.geometry.segment import Segment, make_segment_rows
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, X, Y
from workhold.model.requirements import Restrictions
from workhold.model.workpiece import Workpiece

__all__ = [
    "ContactFeature",
    "find_allowed_features",
    "list_avoided_faces",
    "list_contact_features",
    "measure_end_distances",
    "measure_end_slacks",
    "find_face_of_segment",
    "make_feature_rows",
    "list_features_met",
    "find_meeting_ends",
]

# Pairs of ends looked at together.
TOGETHER = 1 << 20


@frozen
class ContactFeature:
    """A piece of the peg-centre locus.

    Parameters
    ----------
    face : number of the face that the peg touches.
    segment : places of the peg's centre; its normals are those of the contact.
    cut_from : the piece of the locus from which keep-out zones or tools cut the segment; the segment itself
        if none was cut.
    """

    face: int
    segment: Segment
    cut_from: Segment = field()

    @cut_from.default
    def take_own_segment(self) -> Segment:
        """Return the segment itself: the default of ``cut_from``, for a feature that nothing was cut from."""
        return self.segment


def list_contact_features(
    workpiece: Workpiece, peg_radius: float, flat: PegFlat | None = None
) -> list[ContactFeature]:
    """Return the contact features of a workpiece for pegs of a radius in mm, in the order of faces.

    ``flat`` is the flat that such pegs have, None for round pegs.
    """
    faces = workpiece.faces
    pieces = list_trimmed_offsets(
        [face.segment for face in faces], peg_radius, None if flat is None else flat.distance
    )
    return [ContactFeature(faces[index].number, piece) for index, piece in pieces]


def list_features_met(workpiece: Workpiece, carrier: Carrier) -> list[ContactFeature]:
    """Return the contact features for the pegs of a carrier, in the order of faces.

    They lie on the outline of the workpiece that the carrier meets. Faces are numbered through all outlines.
    """
    own, first = workpiece.find_outline(carrier.role)
    features = list_contact_features(own, carrier.peg_radius, carrier.flat)
    return [evolve(one, face=first + one.face) for one in features] if first else features


def list_avoided_faces(workpiece: Workpiece, restrictions: Restrictions) -> set[int]:
    """Return the numbers of the faces that pegs must not touch: those to be avoided, and those that cannot be
    touched.

    If carriers have outlines of their own, the number of a segment to avoid denotes the faces of the solid
    above it. Then the segments under these faces of the solid are avoided in every outline.

    Raises
    ------
    InputError
        For a face that does not exist.
    """
    avoided = {
        find_face_of_segment(workpiece, number) for number in restrictions.avoid
    } | workpiece.untouchable
    if not workpiece.outlines:
        return avoided
    every = workpiece.numbered
    ruled_out = {k for k, band in enumerate(every.bands) if band is None}
    ruled_out.update(every.list_segments_under(every.list_faces_over(restrictions.avoid)))
    return avoided | {face.number for face in every.faces if not ruled_out.isdisjoint(face.segments)}


def find_allowed_features(
    features: list[ContactFeature],
    workpiece: Workpiece,
    restrictions: Restrictions,
    body_radius: float,
    swept: Sequence[tuple[SweptSpans, float]] = (),
) -> list[ContactFeature]:
    """Return contact features without avoided faces and without places at which a peg's body would collide.

    A body collides over a keep-out zone, and if it comes too near to the space that a program sweeps.

    Parameters
    ----------
    body_radius : radius of the pegs' bodies, in mm.
    swept : pairs (swept spans, distance in mm that a peg's centre keeps from them in addition to the tool's
        radius); the pair for the peg itself comes first, one for its shoulder may follow.

    Raises
    ------
    InputError
        For a face that does not exist, and when nothing is left.
    """
    avoided = list_avoided_faces(workpiece, restrictions)
    touched = [feature for feature in features if feature.face not in avoided]
    if not touched:
        raise InputError(
            f"every face of {workpiece.name} that a peg could touch is to be avoided: leave some faces to "
            "hold it by."
        )
    left = touched
    for zone in restrictions.zones:
        left = [
            evolve(feature, segment=part)
            for feature in left
            for part in find_clear_parts(feature.segment, zone.segments, body_radius)
        ]
    if not left:
        other, avoid = (" on another face", ", or avoid fewer faces") if avoided else ("", "")
        raise InputError(
            f"the keep-out zones cover every place along {workpiece.name} where a peg could stand{other}: "
            f"make them smaller{avoid}."
        )
    clear = left
    for pieces, beyond in swept:
        clear = [kept for feature in clear for kept in trim_to_clear_features(feature, pieces, beyond)]
    if not clear:
        line = find_line_most_in_the_way([feature.segment for feature in left], *swept[0])
        raise InputError(
            f"the program's tools pass every place along {workpiece.name} where a peg could stand, line "
            f"{line} most of them: lower the pegs, machine less in this set-up, or ask for less clearance."
        )
    return clear


def find_face_of_segment(workpiece: Workpiece, number: int) -> int:
    """Return the number of the face that segment ``number`` (through all outlines) belongs to.

    Raises
    ------
    InputError
        When there is no such segment.
    """
    faces = workpiece.numbered.faces
    for face in faces:
        if number in face.segments:
            return face.number
    last = faces[-1].number
    raise InputError(
        f"{workpiece.name} has no face {number}: the last one is {last}; look at the picture of its faces."
    )


def trim_to_clear_features(feature: ContactFeature, swept: SweptSpans, beyond: float) -> list[ContactFeature]:
    """Return the parts of a contact feature where peg centres keep
    the tools' radius plus ``beyond`` mm from tool paths.
    """
    return [evolve(feature, segment=part) for part in trim_to_clear_parts(feature.segment, swept, beyond)]


def make_feature_rows(features: list[ContactFeature]) -> NDArray[np.float64]:
    """Return the kernel rows (N, 10) of contact features, see ``kernels.base.feature``."""
    return make_segment_rows([feature.segment for feature in features])


def measure_end_distances(rows: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return distances (..., 2) in mm along features from the feet of points to the low and to the high end.

    Negative past an end, inf on a whole circle, which has no ends.
    ``kernels.chord.evaluation.measure_end_distance`` is its compiled form for one point; verification, the
    algebra and the proof in balls have their own on purpose.

    Parameters
    ----------
    rows : (..., 10 or more) kernel rows of the features.
    points : (..., 2) in mm.
    """
    dx, dy = points[..., 0] - rows[..., X], points[..., 1] - rows[..., Y]
    along = dx * rows[..., AXIS_X] + dy * rows[..., AXIS_Y]
    across = rows[..., AXIS_X] * dy - rows[..., AXIS_Y] * dx
    is_arc = rows[..., IS_ARC] != 0.0
    place, unit = np.where(is_arc, np.arctan2(across, along), along), np.where(is_arc, rows[..., RADIUS], 1.0)
    half = rows[..., HALF_EXTENT]
    ends = np.stack([half + place, half - place], axis=-1) * unit[..., None]
    return np.where((is_arc & (half >= np.pi))[..., None], np.inf, ends)


def measure_end_slacks(
    features: list[ContactFeature], margin: float = 0.0, locus: list[ContactFeature] | None = None
) -> NDArray[np.float64]:
    """Return the tolerance (F, 2) in mm by which a contact may lie past the point ``margin`` mm inside the
    low and the high end.

    Where two features join tangentially, a contact exactly at the joint counts as on both and is listed once,
    so rounding is tolerated there. A contact at any other end does not count: there the peg also touches a
    second face or a corner. A distance of exactly ``margin`` is enough. A keep-out zone cuts a feature where
    the peg's body touches it, which is allowed: the margin counts from the ends that the feature has without
    zones.

    Parameters
    ----------
    margin : smallest distance in mm from a contact to the end of its feature.
    locus : all features, including those that are ruled out, so that joints with these count as well; None
        where nothing is ruled out.
    """
    everything = [feature.segment for feature in (features if locus is None else locus)]
    ends = dict(
        zip(
            map(id, everything), np.minimum(measure_joint_slacks(everything) + margin, END_SLACK), strict=True
        )
    )
    slack = np.array([ends[id(feature.cut_from)] for feature in features]).reshape(-1, 2)
    for index, feature in enumerate(features):
        piece = feature.cut_from
        if feature.segment is not piece:
            half = feature.segment.half_extent
            points = np.array([feature.segment.compute_point(-half), feature.segment.compute_point(half)])
            to_ends = measure_end_distances(make_segment_rows([piece]), points)[[0, 1], [0, 1]]
            slack[index] = np.minimum(slack[index] + to_ends, margin + END_SLACK)
    return slack


def measure_joint_slacks(pieces: list[Segment]) -> NDArray[np.float64]:
    """Return the tolerance in mm, (F, 2), by which a contact may lie past the low and the high end of pieces
    of the locus.

    It is ``END_SLACK`` at an end that joins another piece tangentially, else ``-END_SLACK``.
    """
    ends = np.array(
        [
            [piece.compute_point(-piece.half_extent), piece.compute_point(piece.half_extent)]
            for piece in pieces
        ]
    )
    normals = np.array(
        [
            [piece.compute_normal(-piece.half_extent), piece.compute_normal(piece.half_extent)]
            for piece in pieces
        ]
    )
    points, directions = ends.reshape(-1, 2), normals.reshape(-1, 2)
    slack = np.full(len(points), -END_SLACK)
    one, other = find_meeting_ends(points)
    smooth = (np.abs(directions[one] - directions[other]) <= TANGENT).all(axis=1)
    slack[one[smooth]] = END_SLACK
    return slack.reshape(-1, 2)


def find_meeting_ends(
    points: NDArray[np.float64], within: float = JOINT
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the indices (M,) and (M,) of pairs of ends of different
    features that are within ``within`` mm in x and y.

    ``points`` (2 F, 2) are the ends: low and high end of feature k are numbers 2 k and 2 k + 1. Every pair
    occurs in both orders.
    """
    out, together = [np.zeros((0, 2), np.int64)], max(TOGETHER // max(len(points), 1), 1)
    for start in range(0, len(points), together):
        x, y = points[start : start + together].T
        beside = (np.abs(points[:, 0] - x[:, None]) <= within) & (np.abs(points[:, 1] - y[:, None]) <= within)
        out.append(np.argwhere(beside) + np.array([start, 0]))
    one, other = np.concatenate(out).T
    return one[one // 2 != other // 2], other[one // 2 != other // 2]
