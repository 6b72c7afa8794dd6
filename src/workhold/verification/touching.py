"""Check that a peg at its proven place touches its face, far enough inside the face's ends, and no other face
of the part.

Rules, with the hair of ``tolerances``:

- ends: a contact lies at least margin - hair inside the ends of the face. At an end that is not a tangent
  joint it lies more than a hair inside, so even without a margin a contact exactly at such an end does not
  count;
- elsewhere: as far as that along its feature to both sides the peg, as if it had no flat, keeps clear of
  every other segment. So where the feature is trimmed, because the peg comes to touch a second face across
  its own, the contact lies so far inside too.

Theorem: let a peg's centre p be at distance rho on the outer side of the line or circle of its face, with its
foot inside the face. Let every other segment be farther than rho, or with a flat farther than the peg radius,
which is no less. Then p lies on the trimmed contact feature, off its ends, and outside the workpiece. For the
open segment from the foot to p starts on the outer side and meets no part of the outline, so it never enters
the material.

Along its way a peg enters a side where its centre is nearer to it than the peg's radius. That changes only
where the way meets the boundary of (side + disc): lines beside a straight side, circles inside and outside an
arc, and about both ends. A peg may enter a side by a hair. So a barrier is one of pegs that are smaller by a
hair, and begins somewhere between the places where the clearance passes from a hair to minus a hair. The ball
of its edge holds both.

Glossary
--------
place : arc length in mm along the peg's way on a face, from the untrimmed start of the face's contact
    feature.
barrier : a range of places at which the peg would enter another side; a contact feature ends where one
    begins.
clearance : distance in mm from a side to the peg, negative when the peg enters it.
alongside : of a side at which the clearance changes so slowly while the peg slides that face and side point
    the same way, or opposite ways. So it is beside a tangent joint, and in a slot exactly as wide as the peg.
clear : of a side whose clearance is positive, or above minus a hair where it runs alongside.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

from flint import arb

from workhold.verification.ball_geometry import (
    ArcSide,
    BallOutline,
    LineSide,
    Point,
    Side,
    compute_dot_product,
    compute_norm,
    compute_square_root,
    cross,
    turn_vector,
)
from workhold.verification.contacts import BallContact, BallPose
from workhold.verification.tolerances import HAIR, TANGENT, Finding, format_middle, judge_slack

__all__ = [
    "Barrier",
    "find_barriers",
    "measure_edge_distances",
    "measure_feature",
    "find_points_on_circle",
    "find_points_on_line",
    "judge_touching",
]

Barrier = tuple[arb, arb]


def measure_edge_distances(
    side: Side, radius: arb, beside: Iterable[Barrier], center: Point, smooth: tuple[bool, bool]
) -> list[arb]:
    """Return the distances in mm along a peg's path from the peg's centre to every barrier and end of the
    path.

    The path runs ``radius`` mm from the side; ``beside`` are its barriers, the ranges in which the peg would
    enter another side. ``smooth`` tells whether the start and the end are tangent joints; such ends are left
    out. Distances are negative within a barrier or beyond an end. Returns [] for a whole circle: no side
    trims its path, since all other sides lie beyond the material behind it.
    """
    if isinstance(side, ArcSide) and side.whole:
        return []
    slacks = side.compute_slacks(center, radius)
    place = slacks[0]
    ways = [low - place if place.mid() < low.mid() else place - high for low, high in beside]
    return ways + [slack for slack, joined in zip(slacks, smooth, strict=True) if not joined]


def find_barriers(side: Side, radius: arb, body: arb, others: Iterable[Side]) -> list[Barrier]:
    """Return the ranges (from, to) of places along a side in which a peg would
    enter one of the sides ``others``.

    A place is the arc length in mm along the path of the peg's centre, ``radius`` mm from the side. ``body``
    is the peg's own radius in mm, larger than ``radius`` if its flat lies on the side. Returns [] on a whole
    circle.
    """
    if (isinstance(side, ArcSide) and side.whole) or not body > HAIR:
        return []
    extent = measure_feature(side, radius)
    middle = compute_way_point(side, radius, extent / 2)
    found = []
    for other in others:
        # The distance from a side changes no faster than the place.
        if other.compute_distance(middle) > extent / 2 + body + HAIR:
            continue
        wide = find_entered_ranges(side, radius, other, body + HAIR)
        for low, high in find_entered_ranges(side, radius, other, body - HAIR):
            around = [pair for pair in wide if pair[0].mid() <= low.mid() and high.mid() <= pair[1].mid()]
            before, behind = around[0] if around else (low, high)
            found.append((before.union(low), high.union(behind)))
    return found


def measure_feature(side: Side, radius: arb) -> arb:
    """Return the length in mm of the path of a peg's centre along a whole side, ``radius`` mm from it."""
    return (
        side.length
        if isinstance(side, LineSide)
        else 2 * side.half_sweep * side.compute_offset_radius(radius)
    )


def compute_way_point(side: Side, radius: arb, place: arb) -> Point:
    """Return the centre of a peg at a place on its path, which runs ``radius`` mm from a side.

    ``place`` is the arc length in mm along the path, from the start of the side.
    """
    if isinstance(side, LineSide):
        (x, y), (nx, ny) = side.start, side.normal
        return x + place * side.tangent[0] + radius * nx, y + place * side.tangent[1] + radius * ny
    reach = side.compute_offset_radius(radius)
    angle = side.sign * (place / reach - side.half_sweep)
    ray = turn_vector(side.middle, angle.cos(), angle.sin())
    return side.center[0] + reach * ray[0], side.center[1] + reach * ray[1]


def find_entered_ranges(side: Side, radius: arb, other: Side, near: arb) -> list[Barrier]:
    """Return the ranges (from, to) of places at which the peg's centre is
    nearer than ``near`` mm to another side.

    They are in order and do not overlap.
    """
    extent = measure_feature(side, radius)
    crossings = []
    for point in find_crossing_points(side, radius, other, near):
        if isinstance(side, ArcSide) and side.measure_within(side.measure_from_center(point)) < 0:
            continue
        place = side.compute_slacks(point, radius)[0]
        if not (place < 0 or place > extent):
            crossings.append(place)
    crossings.sort(key=lambda place: float(place.mid()))
    ranges: list[Barrier] = []
    for low, high in pairwise([arb(0), *crossings, extent]):
        if other.compute_distance(compute_way_point(side, radius, ((low + high) / 2).mid())) < near:
            joins = bool(ranges) and ranges[-1][1] is low
            ranges = [*ranges[:-1], (ranges[-1][0], high)] if joins else [*ranges, (low, high)]
    return ranges


def find_crossing_points(side: Side, radius: arb, other: Side, near: arb) -> Iterator[Point]:
    """Yield the points where the path of the peg's centre may be exactly ``near`` mm from another side."""
    circles = [(other.start, near), (other.end, near)]
    if isinstance(other, ArcSide):
        circles += [(other.center, other.radius + near), (other.center, other.radius - near)]
    else:
        for level in (other.level + near, other.level - near):
            yield from find_points_on_line(side, radius, other.normal, level)
    for center, size in circles:
        if size > 0:
            yield from find_points_on_circle(side, radius, center, size)


def find_points_on_line(side: Side, radius: arb, normal: Point, level: arb) -> Iterator[Point]:
    """Yield the points p of the peg centre's path with ``normal`` · p = ``level``.

    The path is not cut off at the side's ends. Yields nothing where line and path may be parallel.
    """
    if isinstance(side, ArcSide):
        yield from find_points_on_ring(
            side,
            radius,
            normal,
            (level - compute_dot_product(normal, side.center)) / side.compute_offset_radius(radius),
        )
        return
    slope, origin = compute_dot_product(normal, side.tangent), compute_way_point(side, radius, arb(0))
    if slope > 0 or slope < 0:
        yield compute_way_point(side, radius, (level - compute_dot_product(normal, origin)) / slope)


def find_points_on_circle(side: Side, radius: arb, center: Point, size: arb) -> Iterator[Point]:
    """Yield the points of the peg centre's path on a circle of radius ``size`` mm.

    The path is not cut off at the side's ends. Yields nothing where circle and path may be concentric.
    """
    if isinstance(side, ArcSide):
        reach = side.compute_offset_radius(radius)
        apart = center[0] - side.center[0], center[1] - side.center[1]
        far = compute_norm(apart)
        if far > 0:
            axis = apart[0] / far, apart[1] / far
            yield from find_points_on_ring(
                side, radius, axis, (far * far + reach * reach - size * size) / (2 * far * reach)
            )
        return
    origin = compute_way_point(side, radius, arb(0))
    ray = center[0] - origin[0], center[1] - origin[1]
    across = cross(side.tangent, ray)
    square = size * size - across * across
    if not square < 0:
        along, half = compute_dot_product(side.tangent, ray), compute_square_root(square)
        for place in (along - half, along + half):
            yield compute_way_point(side, radius, place)


def find_points_on_ring(side: ArcSide, radius: arb, axis: Point, cosine: arb) -> Iterator[Point]:
    """Yield the points of an arc's path of centres whose direction from the arc's centre makes a given angle
    with ``axis``.

    ``axis`` is a unit vector and ``cosine`` the cosine of the angle. The path is taken as a full circle, so
    there are two points. Yields nothing if the cosine is certainly above 1 in absolute value.
    """
    square = 1 - cosine * cosine
    if not square < 0:
        sine, reach = compute_square_root(square), side.compute_offset_radius(radius)
        for sign in (1, -1):
            ray = turn_vector(axis, cosine, sign * sine)
            yield side.center[0] + reach * ray[0], side.center[1] + reach * ray[1]


# Pieces of a feature looked at before it is left undecided, and half the length in mm of the shortest.
MOST_PIECES = 1 << 14
SHORTEST = HAIR / 1024


def judge_touching(
    name: str, contact: BallContact, face: int, pose: BallPose, outline: BallOutline, margin: float
) -> Iterator[Finding]:
    """Yield a finding if a peg enters the part, or touches a face too near to an end of its path.

    Too near is less than ``margin`` mm inside the end. ``face`` is the number of the face touched;
    ``outline`` is the outline that the peg must keep clear of.
    """
    center = contact.compute_center_in_part(pose)
    close = f"{name} is nearer than {margin:g} mm to the end of its feature on face {face}"
    edge = f"{name} is exactly {margin:g} mm from the end of its feature on face {face}"
    joined = outline.find_smooth_ends(face, contact.body is not None)
    # A margin below two hairs asks for no less than none does.
    reach = max(margin - HAIR, HAIR)
    for slack, smooth in zip(contact.side.compute_slacks(center, contact.radius), joined, strict=False):
        inside = slack - margin + HAIR if smooth else slack - reach
        if inside > 0:
            continue
        past = f"{name} lies {format_middle(-slack)} mm past the end of face {face}"
        at = f"{name} touches face {face} exactly at its end"
        broken = past if slack < -HAIR else at if slack < HAIR else close
        yield from judge_slack(inside, broken, edge if margin else at)
    near = []
    for index, side in outline.others[face]:
        clearance = side.compute_distance(center) - contact.clear_radius
        if clearance > reach:
            continue
        near.append(side)
        if clearance < -HAIR:
            yield Finding(
                True, f"{name} enters the workpiece at segment {index} by {format_middle(-clearance)} mm"
            )
        elif margin == 0.0:
            words = f"{name} touches face {face} and segment {index} at the same time"
            clear = is_clear_within(contact, center, [side], reach)
            if clear is not True:
                yield Finding(clear is False, words)
    if near and margin > 0.0:
        clear = is_clear_within(contact, center, near, reach)
        if clear is not True:
            yield Finding(clear is False, close if clear is False else edge)


def move_along_feature(contact: BallContact, center: Point, step: arb) -> Point:
    """Return the peg's centre moved by ``step`` mm along its path beside the touched side."""
    side = contact.side
    if isinstance(side, LineSide):
        return center[0] + step * side.tangent[0], center[1] + step * side.tangent[1]
    angle = step / side.compute_offset_radius(contact.radius)
    x, y = turn_vector(side.measure_from_center(center), angle.cos(), angle.sin())
    return side.center[0] + x, side.center[1] + y


def runs_alongside(contact: BallContact, center: Point, side: Side) -> bool:
    """Return whether the peg's clearance from a side barely changes as the peg
    slides (see "alongside" in the glossary).
    """
    one, two = (
        side.compute_distance(move_along_feature(contact, center, arb(step))) for step in (-HAIR, HAIR)
    )
    return bool(abs(one - two) < 2 * HAIR * TANGENT)


def is_clear_within(contact: BallContact, center: Point, sides: Sequence[Side], reach: float) -> bool | None:
    """Return whether a peg stays clear of all ``sides`` while it slides up to ``reach`` mm either way along
    its face.

    Returns None where the precision does not decide it. Pieces of the path that are not shown to be clear are
    halved.
    """
    pieces = [(arb(0), arb(reach))]
    looked_at = 0
    decided = True
    while pieces and looked_at < MOST_PIECES:
        middle, half = pieces.pop()
        looked_at += 1
        point = move_along_feature(contact, center, middle)
        around = move_along_feature(contact, center, middle + arb(0, half))
        doubtful = False
        for side in sides:
            clearance = side.compute_distance(point) - contact.clear_radius
            loss = half * bound_steepness(contact, side, around)
            if clearance > loss:
                continue
            close = clearance < 0 or clearance + HAIR > loss
            allowed = HAIR if close and runs_alongside(contact, point, side) else 0.0
            if clearance < -allowed:
                return False
            doubtful = doubtful or not clearance + allowed > loss
        if doubtful and half < SHORTEST:
            decided = False
        elif doubtful:
            pieces += [(middle - half / 2, half / 2), (middle + half / 2, half / 2)]
    return True if decided and not pieces else None


def bound_steepness(contact: BallContact, side: Side, around: Point) -> arb:
    """Return an upper bound, at most 1, of how much a side's clearance changes per mm that the peg slides
    along its face.

    The bound holds while the peg's centre is in the box ``around``. It is the cosine of the angle between the
    direction of sliding and the vector from the side's nearest point to the peg's centre.
    """
    away = side.find_vector_away(around)
    if away is None:
        return arb(1)
    if isinstance(contact.side, LineSide):
        along = contact.side.tangent
    else:
        ray = contact.side.measure_from_center(around)
        along = -ray[1], ray[0]
    size = compute_norm(away) * compute_norm(along)
    return (abs(compute_dot_product(along, away)) / size).min(arb(1)) if size > 0 else arb(1)
