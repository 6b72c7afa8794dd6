"""The features of a part that pegs and a straight wall may touch, and whether it covers its place in others.

The boundary of (part + disc of the peg radius) has offset faces, arcs around convex corners, and pockets. A
wall is touched by corners, arcs and edges of the convex hull. The silhouette distinguishes poses, also turned
over, in which the part covers the same place.

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
from workhold.geometry.segment import Arc, Point, Segment, segment_rows
from workhold.kernels.base.distance import outline_distances
from workhold.kernels.base.feature import X, Y
from workhold.kernels.seating.obstacles import SUPPORTS, cover_same
from workhold.model.workpiece import Workpiece

__all__ = ["Hull", "HullSide", "Silhouette", "Touch", "find_pockets", "refuse_own_outlines", "touched_pieces"]

Array = NDArray[np.float64]
# Corners that turn by less, in radians, are rounding.
STRAIGHT_ON = 1e-7


@frozen
class Touch:
    """A face or a corner.

    Parameters
    ----------
    face : number of the face, or of the face that begins at the corner.
    corner : whether it is the corner rather than the face.
    """

    face: int
    corner: bool


def touched_pieces(workpiece: Workpiece, radius: float) -> list[tuple[Touch, Segment]]:
    """The boundary for pegs of a radius in mm, and what they touch on each piece."""
    faces = workpiece.faces
    segments = [face.segment for face in faces]
    pieces = [(Touch(faces[k].number, False), piece) for k, piece in list_trimmed_offsets(segments, radius)]
    number = {segment.start: face.number for face, segment in zip(faces, segments, strict=True)}
    return pieces + [
        (Touch(number[corner], True), arc) for corner, arc in make_rolled_corners(segments, radius)
    ]


def make_rolled_corners(segments: list[Segment], radius: float) -> list[tuple[Point, Arc]]:
    """The arcs on which a disc rolls around convex corners of an outline, where nothing else is nearer."""
    rows, out = segment_rows(segments), []
    raw = [piece for piece in (offset_segment(segment, radius) for segment in segments) if piece is not None]
    before = {segment.end: segment for segment in segments if not is_full(segment)}
    joints = [segment.start for segment in segments if not is_full(segment)]

    def is_clear(points: Array) -> NDArray[np.bool_]:
        return np.asarray(outline_distances(points, rows) >= radius - CLEARANCE)

    for segment in segments:
        if is_full(segment):
            continue
        previous = before.get(segment.start) or min(before.values(), key=lambda s: dist(s.end, segment.start))
        low, high = end_angle(previous, 1.0), end_angle(segment, -1.0)
        turn = (high - low + pi) % (2 * pi) - pi
        if turn <= STRAIGHT_ON:
            continue
        arc = Arc(segment.start, radius, low + turn / 2, turn / 2, 1.0)
        near = [joint for joint in joints if 0.0 < dist(joint, segment.start) <= 2 * radius + CLEARANCE]
        others = [*raw, *(make_joint_circle(joint, radius) for joint in near)]
        out += [(segment.start, kept) for kept in keep_clear_parts(arc, others, is_clear)]
    return [(corner, arc) for corner, arc in out if isinstance(arc, Arc)]


def is_full(segment: Segment) -> bool:
    """Whether a segment is a whole circle."""
    return isinstance(segment, Arc) and segment.is_full


def end_angle(segment: Segment, end: float) -> float:
    """Direction in radians of the outward normal at the end (1) or the start (-1) of a segment."""
    along = end * segment.half_extent * (segment.sign if isinstance(segment, Arc) else 1.0)
    x, y = segment.normal(along)
    return atan2(y, x)


def find_pockets(pieces: list[Segment], rows: Array) -> tuple[Array, NDArray[np.int64]]:
    """The pockets, in which two pieces end with different normals: places, normals and numbers of pieces."""
    ends = [(k, s) for k, piece in enumerate(pieces) if not is_full(piece) for s in (-1.0, 1.0)]
    if not ends:
        return np.zeros((0, 6)), np.zeros((0, 2), np.int64)
    points = np.array([pieces[k].at(s * pieces[k].half_extent) for k, s in ends])
    normals = np.array([pieces[k].normal(s * pieces[k].half_extent) for k, s in ends])
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
    """A hull edge that lies on a wall.

    Parameters
    ----------
    angle : of its outward normal on the part, in radians.
    pieces : at its start and its end, run through with the part on its left.
    """

    angle: float
    pieces: tuple[int, int]


@define(frozen=True, eq=False)
class Hull:
    """The pieces of a part's hull.

    Parameters
    ----------
    rows : (H, 6) see ``kernels.seating.obstacles``.
    touches : what of the part each is.
    """

    rows: Array
    touches: tuple[Touch, ...]

    @classmethod
    def of(cls, workpiece: Workpiece) -> Hull:
        """The hull of a part, about the centre of its box."""
        outer = workpiece.outer_faces
        pieces = HullPieces.of([face.segment for face in outer], workpiece.outer_face_counts)
        rows = np.concatenate(
            [
                pieces.center - np.array(workpiece.center),
                pieces.radius[:, None],
                pieces.middle,
                pieces.cosine[:, None],
            ],
            axis=1,
        )
        return cls(rows, tuple(Touch(outer[faces[-1]].number, len(faces) > 1) for faces in pieces.faces))

    @property
    def turned_over(self) -> Hull:
        """The hull of the part turned over, x to -x."""
        return Hull(self.rows * np.array([-1.0, 1.0, 1.0, -1.0, 1.0, 1.0]), self.touches)

    @property
    def limits(self) -> Array:
        """Directions in radians in which arcs that are no whole circles cease to support."""
        arcs = self.rows[(self.rows[:, 2] > 0.0) & (self.rows[:, 5] > -1.0)]
        middle, half = np.arctan2(arcs[:, 4], arcs[:, 3]), np.arccos(arcs[:, 5])
        return np.concatenate([middle - half, middle + half]) % tau

    def reach(self, angles: Array) -> Array:
        """The reach (N, H) in mm of the pieces in directions (N,), -inf where they do not support."""
        normal = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        there = normal @ self.rows[:, 3:5].T >= self.rows[:, 5] - SUPPORTS
        return np.asarray(np.where(there, normal @ self.rows[:, :2].T + self.rows[:, 2], -np.inf))

    def clearance(self, configs: Array, wall: tuple[float, float, float]) -> Array:
        """Distances (N,) in mm of the part from a wall in configurations (N, 4); see ``Pattern.wall``."""
        ux, uy, off = wall
        reach = self.reach(atan2(-uy, -ux) - configs[:, 0]).max(axis=1)
        return np.asarray(configs[:, 1] * ux + configs[:, 2] * uy - off - reach)

    @cached_property
    def sides(self) -> list[HullSide]:
        """The hull edges, by their angles."""
        found: list[tuple[float, int]] = []
        for i, one in enumerate(self.rows):
            for j, other in enumerate(self.rows[:i]):
                dx, dy = other[:2] - one[:2]
                size, across = hypot(dx, dy), one[2] - other[2]
                if size * size - across * across < LEAST_HULL_EDGE**2:
                    continue
                for turn in (1.0, -1.0):
                    angle = (atan2(dy, dx) + turn * acos(across / size)) % tau
                    reach = self.reach(np.array([angle]))[0]
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
    """A part's outline about the centre of its box.

    Parameters
    ----------
    rows : (S, 10) faces.
    points : (M, 2) on them.
    """

    rows: Array
    points: Array

    @classmethod
    def of(cls, workpiece: Workpiece) -> Silhouette:
        refuse_own_outlines(workpiece)
        segments = [face.segment for face in workpiece.faces]
        rows = move_rows_to_origin(segment_rows(segments), workpiece.center)
        points = [s.at(t) for s in segments for t in np.linspace(-s.half_extent, s.half_extent, POINTS)]
        return cls(rows, np.array(points) - workpiece.center)

    @cached_property
    def arm(self) -> float:
        """Largest distance in mm of one of its points from the centre."""
        return float(np.hypot(*self.points.T).max())

    def cover_same(self, one: Array, others: Array, turned_over: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether a part, perhaps turned over (N,), covers in configurations (N, 4) what it does in one."""
        out = np.empty(len(others), np.int8)
        cover_same(one, others, turned_over.astype(np.int8), self.rows, self.points, SAME_PLACE, out)
        return out.astype(np.bool_)


def refuse_own_outlines(workpiece: Workpiece) -> None:
    """Refuses a part of which some carriers meet another outline than others."""
    if workpiece.outlines:
        role, _ = workpiece.outlines[0]
        raise InputError(
            "the seating is worked out only if everything meets the same outline of the part, and "
            f"the {role} has heights of its own: leave the seating out, or these heights."
        )
