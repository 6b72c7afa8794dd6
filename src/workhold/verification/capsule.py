"""How far a straight piece is from a side, in balls: a clamp's body is all that is within its radius of such a piece.

The distance is least at an end of either, where they cross, or, from an arc's outside, at the foot of the perpendicular from
its centre. From inside a circle the distance to it has no minimum between the ends of a piece.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from flint import arb

from workhold.verification.balls import Point, cross, dot, root
from workhold.verification.sides import ArcSide, LineSide, Side, line_side

__all__ = ["clearance"]


def clearance(start: Point, end: Point, radius: arb, sides: Iterable[Side], enough: float) -> arb:
    """Distance in mm between a capsule and the nearest of some sides, negative where it enters one; ``enough`` where none is
    nearer than that. The ends of its middle line are apart."""
    piece = line_side(start, end)
    middle = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
    nearest = arb(enough)
    for side in sides:
        if side.distance(middle) - piece.length / 2 - radius > enough:
            continue
        nearest = nearest.min(piece_distance(piece, side) - radius)
    return nearest


def piece_distance(piece: LineSide, side: Side) -> arb:
    """Distance in mm between a straight piece and a side."""
    nearest = side.distance(piece.start).min(side.distance(piece.end))
    nearest = nearest.min(piece.distance(side.start)).min(piece.distance(side.end))
    for place, distance in between(piece, side):
        outside = place < 0 or place > piece.length
        inside = place > 0 and place < piece.length
        if not outside:
            nearest = nearest.min(distance) if inside else nearest.union(nearest.min(distance))
    return nearest


def between(piece: LineSide, side: Side) -> Iterator[tuple[arb, arb]]:
    """Places along a piece's line, in mm from its start, where it may be nearest to a side, with the distance there."""
    if isinstance(side, ArcSide):
        ray = side.from_center(piece.start)
        foot, off = -dot(ray, piece.tangent), cross(ray, piece.tangent)
        square = side.radius * side.radius - off * off
        half = arb(0) if square < 0 else root(square)
        for place in (foot - half, foot + half):
            yield place, side.distance(along(piece, place))
        return
    slope = cross(piece.tangent, side.tangent)
    if slope > 0 or slope < 0:
        place = cross((side.start[0] - piece.start[0], side.start[1] - piece.start[1]), side.tangent) / slope
        yield place, side.distance(along(piece, place))


def along(piece: LineSide, place: arb) -> Point:
    """The point of a piece's line at a place."""
    return piece.start[0] + place * piece.tangent[0], piece.start[1] + place * piece.tangent[1]
