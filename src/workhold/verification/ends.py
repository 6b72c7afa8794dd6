"""How far a contact is from the ends of its contact feature, in balls and from the outline alone.

Glossary
--------
place : arc length in mm along the peg's way on a face, from the untrimmed start of the face's contact feature.
barrier : a range of places at which the peg would enter another side; a contact feature ends where one begins.

Along its way a peg enters a side where its centre is nearer to it than the peg's radius. That changes only where the way
meets the boundary of (side + disc): lines beside a straight side, circles inside and outside an arc, and about both ends.

A peg may enter a side by a hair (``verification.tolerances``). So a barrier is one of pegs that are smaller by a hair, and
begins somewhere between the places where the clearance passes from a hair to minus a hair: the ball of its edge holds both.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise

from flint import arb

from workhold.verification.balls import Point, cross, dot, norm, root, turned
from workhold.verification.sides import ArcSide, LineSide, Side
from workhold.verification.tolerances import HAIR

__all__ = ["Barrier", "barriers", "edge_distances", "end_distance", "length_of", "on_circle", "on_line"]

Barrier = tuple[arb, arb]


def end_distance(side: Side, radius: arb, beside: Iterable[Barrier], center: Point) -> arb:
    """Distance in mm along its contact feature from a peg's centre to the nearer end.

    A whole circle has no end; half its circumference counts. Nothing trims it: whatever else there is lies beyond the
    material behind it.
    """
    if isinstance(side, ArcSide) and side.whole:
        return arb.pi() * side.reach(radius)
    slacks = side.slacks(center, radius)
    place, nearest = slacks[0], slacks[0].min(slacks[1])
    for low, high in beside:
        nearest = nearest.min(low - place if place.mid() < low.mid() else place - high)
    return nearest


def edge_distances(
    side: Side, radius: arb, beside: Iterable[Barrier], center: Point, smooth: tuple[bool, bool]
) -> list[arb]:
    """Distances to every barrier and to the ends of the side that are no tangent joints, as ``smooth`` says of its two."""
    if isinstance(side, ArcSide) and side.whole:
        return []
    slacks = side.slacks(center, radius)
    place = slacks[0]
    ways = [low - place if place.mid() < low.mid() else place - high for low, high in beside]
    return ways + [slack for slack, joined in zip(slacks, smooth, strict=True) if not joined]


def barriers(side: Side, radius: arb, body: arb, others: Iterable[Side]) -> list[Barrier]:
    """The barriers on the way along a side of a peg whose centre is ``radius`` mm from it; none on a whole circle.

    ``body`` is the peg's own radius in mm, more than that where its flat lies on the side.
    """
    if (isinstance(side, ArcSide) and side.whole) or not body > HAIR:
        return []
    extent = length_of(side, radius)
    middle = way_point(side, radius, extent / 2)
    found = []
    for other in others:
        # The distance from a side changes no faster than the place.
        if other.distance(middle) > extent / 2 + body + HAIR:
            continue
        wide = entered(side, radius, other, body + HAIR)
        for low, high in entered(side, radius, other, body - HAIR):
            around = [pair for pair in wide if pair[0].mid() <= low.mid() and high.mid() <= pair[1].mid()]
            before, behind = around[0] if around else (low, high)
            found.append((before.union(low), high.union(behind)))
    return found


def length_of(side: Side, radius: arb) -> arb:
    """Length in mm of the untrimmed contact feature of a side."""
    return side.length if isinstance(side, LineSide) else 2 * side.half_sweep * side.reach(radius)


def way_point(side: Side, radius: arb, place: arb) -> Point:
    """The peg's centre at a place."""
    if isinstance(side, LineSide):
        (x, y), (nx, ny) = side.start, side.normal
        return x + place * side.tangent[0] + radius * nx, y + place * side.tangent[1] + radius * ny
    reach = side.reach(radius)
    angle = side.sign * (place / reach - side.half_sweep)
    ray = turned(side.middle, angle.cos(), angle.sin())
    return side.center[0] + reach * ray[0], side.center[1] + reach * ray[1]


def entered(side: Side, radius: arb, other: Side, near: arb) -> list[Barrier]:
    """Ranges of places on the way along a side whose points are nearer than ``near`` mm to another side, in order."""
    extent = length_of(side, radius)
    crossings = []
    for point in crossing_points(side, radius, other, near):
        if isinstance(side, ArcSide) and side.within(side.from_center(point)) < 0:
            continue
        place = side.slacks(point, radius)[0]
        if not (place < 0 or place > extent):
            crossings.append(place)
    crossings.sort(key=lambda place: float(place.mid()))
    ranges: list[Barrier] = []
    for low, high in pairwise([arb(0), *crossings, extent]):
        if other.distance(way_point(side, radius, ((low + high) / 2).mid())) < near:
            joins = bool(ranges) and ranges[-1][1] is low
            ranges = [*ranges[:-1], (ranges[-1][0], high)] if joins else [*ranges, (low, high)]
    return ranges


def crossing_points(side: Side, radius: arb, other: Side, near: arb) -> Iterator[Point]:
    """Where the line or circle of a peg's way meets the lines and circles at ``near`` mm from another side."""
    circles = [(other.start, near), (other.end, near)]
    if isinstance(other, ArcSide):
        circles += [(other.center, other.radius + near), (other.center, other.radius - near)]
    else:
        for level in (other.level + near, other.level - near):
            yield from on_line(side, radius, other.normal, level)
    for center, size in circles:
        if size > 0:
            yield from on_circle(side, radius, center, size)


def on_line(side: Side, radius: arb, normal: Point, level: arb) -> Iterator[Point]:
    """Points of the way on the line of all x with normal . x = level; none when it may be parallel to a straight way."""
    if isinstance(side, ArcSide):
        yield from on_ring(side, radius, normal, (level - dot(normal, side.center)) / side.reach(radius))
        return
    slope, origin = dot(normal, side.tangent), way_point(side, radius, arb(0))
    if slope > 0 or slope < 0:
        yield way_point(side, radius, (level - dot(normal, origin)) / slope)


def on_circle(side: Side, radius: arb, center: Point, size: arb) -> Iterator[Point]:
    """Points of the way on a circle; none when it may be concentric to a round way."""
    if isinstance(side, ArcSide):
        reach = side.reach(radius)
        apart = center[0] - side.center[0], center[1] - side.center[1]
        far = norm(apart)
        if far > 0:
            axis = apart[0] / far, apart[1] / far
            yield from on_ring(side, radius, axis, (far * far + reach * reach - size * size) / (2 * far * reach))
        return
    origin = way_point(side, radius, arb(0))
    ray = center[0] - origin[0], center[1] - origin[1]
    across = cross(side.tangent, ray)
    square = size * size - across * across
    if not square < 0:
        along, half = dot(side.tangent, ray), root(square)
        for place in (along - half, along + half):
            yield way_point(side, radius, place)


def on_ring(side: ArcSide, radius: arb, axis: Point, cosine: arb) -> Iterator[Point]:
    """Points of a round way whose direction from the centre has a cosine with an axis, a unit vector."""
    square = 1 - cosine * cosine
    if not square < 0:
        sine, reach = root(square), side.reach(radius)
        for sign in (1, -1):
            ray = turned(axis, cosine, sign * sine)
            yield side.center[0] + reach * ray[0], side.center[1] + reach * ray[1]
