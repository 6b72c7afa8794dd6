"""Plane geometry in ball arithmetic: numbers, points, and the outline of a workpiece by lines and arcs.

A ball is a midpoint and a radius within which a number is known to lie (python-flint's ``arb``). Every
operation rounds outward, so that a comparison that holds for a ball holds for the number inside. ``a > b`` is
true only when it is certain. Where both ``a > b`` and ``a <= b`` are false, the precision does not decide.

Sides are derived from vertices and bulges alone. A bulge b is a rational number, so cosine and sine of half
the sweep 4 atan(b) are the rational numbers (1 - b²)/(1 + b²) and 2b/(1 + b²). Centre and radius of an arc
then need no trigonometry.

Glossary
--------
exact : a float is a rational number, and a ball of radius 0 holds it.
hull : the smallest ball around two balls; it also holds every number between them.
side : one segment of the outline, or a whole face of several, with material on its left.
gap : distance of a point from the line or circle that carries a side, positive on the outer side.
slacks : distances along a contact feature from its untrimmed start and end, negative beyond that end.

References
----------
F. Johansson, "Arb: efficient arbitrary-precision midpoint-radius interval arithmetic", IEEE Transactions on
Computers 66 (2017) 1281-1292.
S. M. Rump, "Verification methods: rigorous results using floating-point arithmetic", Acta Numerica 19 (2010)
287-449.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import reduce
from itertools import product
from typing import Any

import numpy as np
from attrs import frozen
from flint import arb
from numpy.typing import NDArray

from workhold.model.workpiece import Workpiece
from workhold.verification.tolerances import STRAIGHT, TANGENT, WHOLE

__all__ = [
    "PRECISIONS",
    "ArcSide",
    "BallOutline",
    "LineSide",
    "Point",
    "Side",
    "make_arc_side",
    "cross",
    "compute_dot_product",
    "make_exact_point",
    "compute_box_center",
    "find_largest",
    "find_least",
    "make_line_side",
    "make_loop_sides",
    "subtract",
    "compute_norm",
    "compute_square_root",
    "turn_vector",
    "make_side_at_vertex",
]

Point = tuple[arb, arb]

# Bits of the midpoints; the next is tried when one leaves something undecided.
PRECISIONS = (128, 256, 512)


def make_exact_point(x: float, y: float) -> Point:
    """Return the point (x, y), in mm, with an exact ball (radius 0) for each coordinate."""
    return arb(x), arb(y)


def subtract(a: Point, b: Point) -> Point:
    return a[0] - b[0], a[1] - b[1]


def compute_dot_product(a: Point, b: Point) -> arb:
    return a[0] * b[0] + a[1] * b[1]


def cross(a: Point, b: Point) -> arb:
    """Return the z component of the vector product a x b."""
    return a[0] * b[1] - a[1] * b[0]


def compute_square_root(square: arb) -> arb:
    """Return the square root of a number known to be 0 or more, even if its ball reaches below 0."""
    return square.sqrt() if square > 0 else arb(0).union(square.abs_upper().sqrt())


def compute_norm(a: Point) -> arb:
    """Return the length of a vector; its ball may contain the null vector."""
    return compute_square_root(compute_dot_product(a, a))


def turn_vector(a: Point, cosine: arb, sine: arb) -> Point:
    """Return a vector turned counter-clockwise by the angle with this cosine and sine."""
    return cosine * a[0] - sine * a[1], sine * a[0] + cosine * a[1]


def find_least(values: Sequence[arb]) -> arb:
    """Return the least of some numbers, at least one."""
    return reduce(arb.min, values)


def find_largest(values: Sequence[arb]) -> arb:
    """Return the largest of some numbers, at least one."""
    return reduce(arb.max, values)


Vertex = tuple[float, float, float]


@frozen(eq=False)
class LineSide:
    """A straight side.

    Parameters
    ----------
    start, end : in mm.
    tangent : unit vector from start to end.
    length : in mm.
    level : scalar product in mm of the outward normal with any point of the side.
    """

    start: Point
    end: Point
    tangent: Point
    length: arb
    level: arb

    @property
    def normal(self) -> Point:
        """Outward unit normal."""
        return self.tangent[1], -self.tangent[0]

    def compute_gap(self, point: Point) -> arb:
        """Return the signed distance in mm of a point from the infinite line, positive on the outer side."""
        return compute_dot_product(self.normal, point) - self.level

    def compute_distance(self, point: Point) -> arb:
        """Return the distance in mm of a point from the side with its ends, 0 or more."""
        from_start = subtract(point, self.start)
        along = compute_dot_product(from_start, self.tangent)
        if along > 0 and along < self.length:
            return abs(cross(self.tangent, from_start))
        if along < 0:
            return compute_norm(from_start)
        from_end = subtract(point, self.end)
        if along > self.length:
            return compute_norm(from_end)
        return abs(cross(self.tangent, from_start)).union(
            compute_norm(from_start).min(compute_norm(from_end))
        )

    def find_vector_away(self, point: Point) -> Point | None:
        """Return a vector, not of unit length, along the line from the nearest point of the side through
        ``point``.

        On the side's interior it is the outward normal, else it points from the nearer end to ``point``.
        Returns None where it is uncertain which point of the side is nearest.
        """
        along = compute_dot_product(subtract(point, self.start), self.tangent)
        if along > 0 and along < self.length:
            return self.normal
        end = self.start if along < 0 else self.end if along > self.length else None
        return None if end is None else subtract(point, end)

    def compute_slacks(self, point: Point, offset: arb) -> tuple[arb, ...]:
        """Return (from the start, from the end): distances in mm along the side to the foot of ``point``.

        A distance is negative if the foot lies beyond that end. ``offset`` is ignored: it matters on arcs
        only.
        """
        along = compute_dot_product(subtract(point, self.start), self.tangent)
        return along, self.length - along

    def compute_outward_normal(self, point: Point) -> Point:
        """Return the outward unit normal, the same for every point."""
        return self.normal


@frozen(eq=False)
class ArcSide:
    """A circular side.

    Parameters
    ----------
    start, end : in mm.
    center, radius : in mm.
    sign : 1 for a convex arc, -1 for a concave one.
    middle : unit vector from the centre to the middle of the arc.
    half_sweep : half the angle covered, in radians.
    whole : whether it is a whole circle, which has no ends.
    """

    start: Point
    end: Point
    center: Point
    radius: arb
    sign: int
    middle: Point
    half_sweep: arb
    whole: bool

    def compute_offset_radius(self, offset: arb) -> arb:
        """Return the radius in mm of the arc offset outward by ``offset`` mm."""
        return self.radius + self.sign * offset

    def measure_from_center(self, point: Point) -> Point:
        """Return the vector from the centre to a point."""
        return subtract(point, self.center)

    def compute_gap(self, point: Point) -> arb:
        """Return the signed distance in mm of a point from the full circle, positive outside the material."""
        return self.sign * (compute_norm(self.measure_from_center(point)) - self.radius)

    def compute_distance(self, point: Point) -> arb:
        """Return the distance in mm of a point from the arc with its ends, 0 or more."""
        ray = self.measure_from_center(point)
        from_circle = abs(compute_norm(ray) - self.radius)
        within = self.measure_within(ray)
        if self.whole or within > 0:
            return from_circle
        from_ends = compute_norm(subtract(point, self.start)).min(compute_norm(subtract(point, self.end)))
        return from_ends if within < 0 else from_circle.union(from_ends)

    def find_vector_away(self, point: Point) -> Point | None:
        """Return a vector, not of unit length, along the line from the nearest point of the arc through
        ``point``.

        It points from the arc's centre to ``point``, or where an end of the arc is nearest, from that end to
        ``point``. Returns None where it is uncertain which point of the arc is nearest.
        """
        ray = self.measure_from_center(point)
        within = self.measure_within(ray)
        if self.whole or within > 0:
            return ray
        ways = [subtract(point, end) for end in (self.start, self.end)]
        one, two = (compute_dot_product(way, way) for way in ways)
        if not within < 0:
            return None
        return ways[0] if one < two else ways[1] if two < one else None

    def measure_within(self, ray: Point) -> arb:
        """Return a number whose sign tells whether the ray from the centre along the vector ``ray`` meets the
        arc.

        It is positive if the ray meets the arc and negative if it misses it. Its size has no meaning.
        """
        return compute_dot_product(self.middle, ray) - compute_norm(ray) * self.half_sweep.cos()

    def compute_slacks(self, point: Point, offset: arb) -> tuple[arb, ...]:
        """Return (from the start, from the end): arc lengths in mm to ``point``, a peg's centre.

        They are measured along the arc offset outward by ``offset`` mm, and negative where ``point`` lies
        beyond that end. Returns () for a whole circle.
        """
        if self.whole:
            return ()
        ray = self.measure_from_center(point)
        angle = self.sign * arb.atan2(cross(self.middle, ray), compute_dot_product(self.middle, ray))
        reach = self.compute_offset_radius(offset)
        return (self.half_sweep + angle) * reach, (self.half_sweep - angle) * reach

    def compute_outward_normal(self, point: Point) -> Point:
        """Return the outward unit normal of the arc at its point nearest to a point."""
        ray = self.measure_from_center(point)
        far = compute_norm(ray)
        return self.sign * ray[0] / far, self.sign * ray[1] / far


Side = LineSide | ArcSide


def make_line_side(start: Point, end: Point) -> LineSide:
    """Return the straight side from start to end with material on its left."""
    step = subtract(end, start)
    length = compute_norm(step)
    tangent = step[0] / length, step[1] / length
    return LineSide(start, end, tangent, length, tangent[1] * start[0] - tangent[0] * start[1])


def make_arc_side(start: Point, end: Point, bulge: float) -> ArcSide:
    """Return the arc from start to end with a bulge that is not 0; it is convex for a positive bulge.

    With chord (dx, dy) the centre lies (1 - b²)/(4b) chords to the left of the chord's middle, and the radius
    is (1 + b²)/(4|b|) chords (from r = c / (2 sin(half sweep))).
    """
    b = arb(bulge)
    dx, dy = subtract(end, start)
    left = (1 - b * b) / (4 * b)
    center = (start[0] + end[0]) / 2 - dy * left, (start[1] + end[1]) / 2 + dx * left
    chord = compute_norm((dx, dy))
    sign = 1 if bulge > 0 else -1
    middle = sign * dy / chord, -sign * dx / chord
    radius = chord * (1 + b * b) / (4 * abs(b))
    return ArcSide(start, end, center, radius, sign, middle, 2 * abs(b).atan(), False)


def make_side_at_vertex(vertex: Vertex, following: Vertex) -> Side:
    """Return the side from one vertex (x, y, bulge) to the following vertex: a line if the bulge is about 0."""
    start, end = make_exact_point(*vertex[:2]), make_exact_point(*following[:2])
    return make_line_side(start, end) if abs(vertex[2]) < STRAIGHT else make_arc_side(start, end, vertex[2])


def make_loop_sides(loop: NDArray[np.float64]) -> list[Side]:
    """Return the N sides of a closed loop of vertices (N, 3) with rows x, y,
    bulge, side k from vertex k to k + 1.
    """
    vertices = [(float(x), float(y), float(bulge)) for x, y, bulge in loop]
    return [make_side_at_vertex(a, b) for a, b in zip(vertices, vertices[1:] + vertices[:1], strict=True)]


def join_sides_to_face(run: Sequence[Side]) -> Side:
    """Return a single side that replaces successive sides of the same line or circle.

    The sides of ``run`` are equal to rounding only. A line is drawn from the first start to the last end. An
    arc takes centre and radius of the first arc.
    """
    first, last = run[0], run[-1]
    if len(run) == 1:
        return first
    if isinstance(first, LineSide):
        return make_line_side(first.start, last.end)
    half_sweep = sum((side.half_sweep for side in run if isinstance(side, ArcSide)), arb(0))
    whole = bool(half_sweep > arb.pi() - WHOLE)
    ray = first.measure_from_center(first.start)
    far = compute_norm(ray)
    middle = turn_vector((ray[0] / far, ray[1] / far), half_sweep.cos(), first.sign * half_sweep.sin())
    return ArcSide(first.start, last.end, first.center, first.radius, first.sign, middle, half_sweep, whole)


@frozen(eq=False)
class BallOutline:
    """All sides of a workpiece.

    Parameters
    ----------
    segments : all segments, in the order of their numbers.
    faces : by face number, the whole face as one side.
    others : by face number, (number, side) of every segment that is not part of the face.
    neighbours : by face number, the segments (before the face's start, after its end).
    turns : by face number, the turns of the outline at the joints with the neighbours (before, after); see
        :func:`measure_turn_at`.
    own : outlines by role of the carriers that touch the part at heights of their own; under the empty role,
        the outline of all other carriers. Empty if all carriers touch the same outline
        (``verification.contacts``).
    """

    segments: tuple[Side, ...]
    faces: Mapping[int, Side]
    others: Mapping[int, tuple[tuple[int, Side], ...]]
    neighbours: Mapping[int, tuple[Side, Side]]
    turns: Mapping[int, tuple[arb, arb]]
    own: Mapping[str, BallOutline] = {}

    @classmethod
    def from_workpiece(cls, workpiece: Workpiece, number: int = 0) -> BallOutline:
        """Return the outline of a workpiece at the current precision (``ctx.prec``).

        Its segments and faces are numbered from ``number`` on.
        """
        segments, before = list[Side](), list[int]()
        for loop in workpiece.loops:
            first, count = len(segments), len(loop)
            segments += make_loop_sides(loop)
            before += [first + (k - 1) % count for k in range(count)]
        after = {neighbour: k for k, neighbour in enumerate(before)}
        faces, others, neighbours, turns = (dict[int, Any]() for _ in range(4))
        for face in workpiece.faces:
            key, run = number + face.number, face.segments
            faces[key] = side = join_sides_to_face([segments[k] for k in run])
            others[key] = tuple((number + k, other) for k, other in enumerate(segments) if k not in run)
            neighbours[key] = one, two = segments[before[run[0]]], segments[after[run[-1]]]
            turns[key] = measure_turn_at(one, side, side.start), measure_turn_at(side, two, side.end)
        return cls(tuple(segments), faces, others, neighbours, turns)

    def find_smooth_ends(self, face: int, has_flat: bool) -> tuple[bool, bool]:
        """Return (start, end): whether a face joins its neighbour tangentially at its start, and at its end.

        With ``has_flat`` (a peg with a flat) only a joint of two arcs counts, because at a joint of line and
        arc the contact changes between the flat and the round body.
        """
        one, other = (bool(turn < TANGENT) for turn in self.turns[face])
        if not has_flat:
            return one, other
        first, last = (
            isinstance(side, ArcSide) and isinstance(self.faces[face], ArcSide)
            for side in self.neighbours[face]
        )
        return one and first, other and last


def measure_turn_at(one: Side, two: Side, joint: Point) -> arb:
    """Return the larger absolute component of the difference of two sides' unit normals at a joint.

    The sides meet tangentially where it is below ``TANGENT``.
    """
    x, y = subtract(one.compute_outward_normal(joint), two.compute_outward_normal(joint))
    return abs(x).max(abs(y))


def compute_box_center(outline: BallOutline) -> Point:
    """Return the centre in mm of the bounding box of a workpiece.

    The box is computed from the joints, and from the points of arcs whose tangent is along x or y.
    """
    places = [side.start for side in outline.segments]
    arcs = [side for side in outline.segments if isinstance(side, ArcSide)]
    for side, way in product(arcs, ((1, 0), (-1, 0), (0, 1), (0, -1))):
        if not side.measure_within(make_exact_point(*way)) < 0:
            (x, y), radius = side.center, side.radius
            places.append((x + way[0] * radius, y + way[1] * radius))
    xs, ys = zip(*places, strict=True)
    return (find_least(xs) + find_largest(xs)) / 2, (find_least(ys) + find_largest(ys)) / 2
