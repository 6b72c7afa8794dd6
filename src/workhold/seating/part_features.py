"""The features of a part that pegs and a straight wall may touch, and whether the part covers the same area
in two poses.

The boundary of (part + disc of the peg radius), on which a peg's centre lies, consists of offset faces and
arcs around convex corners, and has pockets. A wall is touched by corners, arcs and edges of the convex hull.
The silhouette tells whether the part covers the same area in two poses, even if it is turned over in one.

Reference: T. Lozano-Perez, "Spatial planning: a configuration space approach", IEEE Transactions on Computers
C-32 (1983).
"""

from __future__ import annotations

from functools import cached_property
from math import acos, atan2, cos, dist, hypot, pi, sin, tau

import numpy as np
from attrs import define, frozen
from numpy.typing import NDArray

from workhold.contact.problem import move_rows_to_origin
from workhold.conventions import CLEARANCE, JOINT, LEAST_HULL_EDGE, SAME_POSE, TANGENT, TOUCHING
from workhold.errors import InputError
from workhold.geometry.hull import HullPieces
from workhold.geometry.offset import keep_clear_parts, list_trimmed_offsets, make_joint_circle, offset_segment
from workhold.geometry.segment import Arc, Point, Segment, make_segment_rows
from workhold.kernels.base.distance import measure_outline_distances
from workhold.kernels.base.feature import X, Y
from workhold.kernels.seating.obstacles import SUPPORTS, write_same_cover
from workhold.model.workpiece import Workpiece

__all__ = [
    "PartHull",
    "HullSide",
    "Silhouette",
    "TouchedFeature",
    "find_pockets",
    "refuse_own_outlines",
    "list_touched_pieces",
]

Array = NDArray[np.float64]
# Corners that turn by less, in radians, are rounding.
STRAIGHT_ON = 1e-7


@frozen
class TouchedFeature:
    """A face or a corner of a part that a peg touches.

    Parameters
    ----------
    face : number of the face; for a corner, of the face that begins there.
    corner : True for the corner, False for the face.
    """

    face: int
    corner: bool


def list_touched_pieces(workpiece: Workpiece, radius: float) -> list[tuple[TouchedFeature, Segment]]:
    """Return the pieces of the boundary for pegs of a radius in mm, each with the feature that a peg there
    touches.

    The offsets of faces come first, then the arcs around convex corners.
    """
    faces = workpiece.faces
    segments = [face.segment for face in faces]
    pieces = [
        (TouchedFeature(faces[k].number, False), piece) for k, piece in list_trimmed_offsets(segments, radius)
    ]
    number = {segment.start: face.number for face, segment in zip(faces, segments, strict=True)}
    return pieces + [
        (TouchedFeature(number[corner], True), arc) for corner, arc in make_rolled_corners(segments, radius)
    ]


def make_rolled_corners(segments: list[Segment], radius: float) -> list[tuple[Point, Arc]]:
    """Return the arcs on which the centre of a disc moves around convex corners, as pairs (corner, arc).

    Parts of an arc where the disc would enter another segment are cut off; a corner may have several arcs.
    ``radius`` is the disc's in mm.
    """
    rows, out = make_segment_rows(segments), []
    raw = [piece for piece in (offset_segment(segment, radius) for segment in segments) if piece is not None]
    before = {segment.end: segment for segment in segments if not is_full(segment)}
    joints = [segment.start for segment in segments if not is_full(segment)]

    def is_clear(points: Array) -> NDArray[np.bool_]:
        """Return for each point (M, 2) whether it is at least the radius away from the outline (M,)."""
        return np.asarray(measure_outline_distances(points, rows) >= radius - CLEARANCE)

    for segment in segments:
        if is_full(segment):
            continue
        previous = before.get(segment.start) or min(before.values(), key=lambda s: dist(s.end, segment.start))
        low, high = compute_end_angle(previous, 1.0), compute_end_angle(segment, -1.0)
        turn = (high - low + pi) % (2 * pi) - pi
        if turn <= STRAIGHT_ON:
            continue
        arc = Arc(segment.start, radius, low + turn / 2, turn / 2, 1.0)
        near = [joint for joint in joints if 0.0 < dist(joint, segment.start) <= 2 * radius + CLEARANCE]
        others = [*raw, *(make_joint_circle(joint, radius) for joint in near)]
        out += [(segment.start, kept) for kept in keep_clear_parts(arc, others, is_clear)]
    return [(corner, arc) for corner, arc in out if isinstance(arc, Arc)]


def is_full(segment: Segment) -> bool:
    """Return whether a segment is a whole circle."""
    return isinstance(segment, Arc) and segment.is_full


def compute_end_angle(segment: Segment, end: float) -> float:
    """Return the direction in radians of a segment's outward normal at its end (``end`` 1) or its start
    (-1).
    """
    along = end * segment.half_extent * (segment.sign if isinstance(segment, Arc) else 1.0)
    x, y = segment.compute_normal(along)
    return atan2(y, x)


def find_pockets(pieces: list[Segment], rows: Array) -> tuple[Array, NDArray[np.int64]]:
    """Return the pockets: points at which two pieces end with different normals.

    ``rows`` (N, 10) are the same pieces relative to the centre of the part's box.

    Returns
    -------
    tuple
        Places and both outward normals (V, 6) in the coordinates of ``rows``, and the indices of both pieces
        (V, 2).
    """
    ends = [(k, s) for k, piece in enumerate(pieces) if not is_full(piece) for s in (-1.0, 1.0)]
    if not ends:
        return np.zeros((0, 6)), np.zeros((0, 2), np.int64)
    points = np.array([pieces[k].compute_point(s * pieces[k].half_extent) for k, s in ends])
    normals = np.array([pieces[k].compute_normal(s * pieces[k].half_extent) for k, s in ends])
    shift = rows[0, [X, Y]] - np.array(
        pieces[0].center if isinstance(pieces[0], Arc) else pieces[0].middle  # the same point before centring
    )
    found, whose = [], []
    for i in range(len(ends)):
        for j in range(i + 1, len(ends)):
            if np.abs(points[i] - points[j]).max() > JOINT or ends[i][0] == ends[j][0]:
                continue
            if np.abs(normals[i] - normals[j]).max() <= TANGENT:
                continue
            place = (points[i] + points[j]) / 2 + shift
            found.append([*place, *normals[i], *normals[j]])
            whose.append([ends[i][0], ends[j][0]])
    return np.array(found).reshape(-1, 6), np.array(whose, dtype=np.int64).reshape(-1, 2)


@frozen
class HullSide:
    """An edge of a part's convex hull, which can lie flat on a wall.

    Parameters
    ----------
    angle : direction of the edge's outward normal in the part's frame, in radians.
    pieces : indices in ``PartHull.rows`` of the pieces at the edge's start and end, with the part on the
        left.
    """

    angle: float
    pieces: tuple[int, int]


@define(frozen=True, eq=False)
class PartHull:
    """The corners and arcs of a part's convex hull, on which it can stand against a wall.

    Parameters
    ----------
    rows : (H, 6) hull pieces: centre x, y, radius (0 for a corner), middle direction x, y, and the cosine of
        half the range of normals; see ``kernels.seating.obstacles``.
    touches : for each hull piece, the part's face or corner.
    """

    rows: Array
    touches: tuple[TouchedFeature, ...]

    @classmethod
    def from_workpiece(cls, workpiece: Workpiece) -> PartHull:
        """Return the convex hull of a part, relative to the centre of its bounding box."""
        outer = workpiece.outer_faces
        pieces = HullPieces.from_segments([face.segment for face in outer], workpiece.outer_face_counts)
        rows = np.concatenate(
            [
                pieces.center - np.array(workpiece.center),
                pieces.radius[:, None],
                pieces.middle,
                pieces.cosine[:, None],
            ],
            axis=1,
        )
        return cls(
            rows, tuple(TouchedFeature(outer[faces[-1]].number, len(faces) > 1) for faces in pieces.faces)
        )

    @property
    def turned_over(self) -> PartHull:
        """The hull of the part turned over: x becomes -x."""
        return PartHull(self.rows * np.array([-1.0, 1.0, 1.0, -1.0, 1.0, 1.0]), self.touches)

    @property
    def limits(self) -> Array:
        """The directions in radians, in [0, 2 pi), at which the hull's arcs begin and end; whole circles are
        left out.
        """
        arcs = self.rows[(self.rows[:, 2] > 0.0) & (self.rows[:, 5] > -1.0)]
        middle, half = np.arctan2(arcs[:, 4], arcs[:, 3]), np.arccos(arcs[:, 5])
        return np.concatenate([middle - half, middle + half]) % tau

    def compute_reach(self, angles: Array) -> Array:
        """Return the extent in mm of each hull piece in each direction: (N, H) for N angles in radians.

        It is -inf if the direction is outside the piece's range of normals.
        """
        normal = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        there = normal @ self.rows[:, 3:5].T >= self.rows[:, 5] - SUPPORTS
        return np.asarray(np.where(there, normal @ self.rows[:, :2].T + self.rows[:, 2], -np.inf))

    def compute_wall_clearance(self, configs: Array, wall: tuple[float, float, float]) -> Array:
        """Return the distance (N,) in mm of the part from a wall in configurations (N, 4), negative where it
        enters the wall.

        ``wall`` is (x, y, coordinate): the unit vector from the wall to the part, and the wall's coordinate
        along it in mm.
        """
        ux, uy, off = wall
        reach = self.compute_reach(atan2(-uy, -ux) - configs[:, 0]).max(axis=1)
        return np.asarray(configs[:, 1] * ux + configs[:, 2] * uy - off - reach)

    @cached_property
    def sides(self) -> list[HullSide]:
        """The hull edges, in ascending order of their angles."""
        found: list[tuple[float, int]] = []
        for i, one in enumerate(self.rows):
            for j, other in enumerate(self.rows[:i]):
                dx, dy = other[:2] - one[:2]
                size, across = hypot(dx, dy), one[2] - other[2]
                if size * size - across * across < LEAST_HULL_EDGE**2:
                    continue
                for turn in (1.0, -1.0):
                    angle = (atan2(dy, dx) + turn * acos(across / size)) % tau
                    reach = self.compute_reach(np.array([angle]))[0]
                    if min(reach[i], reach[j]) > reach.max() - 2 * TOUCHING:
                        found += [(angle, i), (angle, j)]
        sides: list[HullSide] = []
        for angle, _ in found:
            near = [k for other, k in found if abs((other - angle + 1.0) % tau - 1.0) < SAME_POSE]
            along = self.rows[near, :2] @ [-sin(angle), cos(angle)]
            pieces = near[int(np.argmin(along))], near[int(np.argmax(along))]
            if all(abs((side.angle - angle + 1.0) % tau - 1.0) >= SAME_POSE for side in sides):
                sides.append(HullSide(angle, pieces))
        return sorted(sides, key=lambda side: side.angle)


# mm. Silhouettes that agree to this cover the same place.
SAME_PLACE = 1e-3
# Points looked at on each face.
POINTS = 9


@define(frozen=True, eq=False, slots=False)
class Silhouette:
    """A part's outline, relative to the centre of its bounding box.

    Parameters
    ----------
    rows : (S, 10) segments of the outline.
    points : (M, 2) points on these segments, in mm.
    """

    rows: Array
    points: Array

    @classmethod
    def from_workpiece(cls, workpiece: Workpiece) -> Silhouette:
        """Return the silhouette of a part.

        Raises
        ------
        InputError
            In the case of :func:`refuse_own_outlines`.
        """
        refuse_own_outlines(workpiece)
        segments = [face.segment for face in workpiece.faces]
        rows = move_rows_to_origin(make_segment_rows(segments), workpiece.center)
        points = [
            s.compute_point(t) for s in segments for t in np.linspace(-s.half_extent, s.half_extent, POINTS)
        ]
        return cls(rows, np.array(points) - workpiece.center)

    @cached_property
    def arm(self) -> float:
        """The largest distance in mm of the points from the centre of the box."""
        return float(np.hypot(*self.points.T).max())

    def find_same_cover(self, one: Array, others: Array, turned_over: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return for each configuration in ``others`` (N, 4) whether the part covers the same area there as
        in ``one`` (4,).

        ``turned_over`` (N,) is True for configurations in which the part is turned over.
        """
        out = np.empty(len(others), np.int8)
        write_same_cover(one, others, turned_over.astype(np.int8), self.rows, self.points, SAME_PLACE, out)
        return out.astype(np.bool_)


def refuse_own_outlines(workpiece: Workpiece) -> None:
    """Raise InputError for a part that has different outlines at different heights."""
    if workpiece.outlines:
        role, _ = workpiece.outlines[0]
        raise InputError(
            "the seating is worked out only if everything meets the same outline of the part, and "
            f"the {role} has heights of its own: leave the seating out, or these heights."
        )
