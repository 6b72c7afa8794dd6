"""Chains of DXF entities: points, bulges and curves in the coordinates of their layout or block.

Glossary
--------
OCS : object coordinate system. Flat entities carry an extrusion direction (DXF reference, "arbitrary axis
    algorithm"). (0, 0, 1) is the drawing plane seen from above, (0, 0, -1) the same plane seen from below,
    whose x runs the other way. Any other direction is tilted and refused.
raw chain : points (x, y, z) and bulges before units and block placements.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from math import cos, dist, isfinite, pi, radians, sin, tau
from typing import Any

from attrs import field, frozen
from ezdxf.math import fit_points_to_cad_cv

from workhold.conventions import SAME_POINT, TILT
from workhold.errors import InputError
from workhold.files.outline.chain import list_arc_bulges
from workhold.geometry.rational import Pieces, compute_point, split_ellipse, split_spline
from workhold.limits import MOST_LENGTH

__all__ = ["REFUSED", "SHAPES", "RawChain"]

Point3 = tuple[float, float, float]

# Fit points of one spline: the library takes seconds for as many.
MOST_FIT_POINTS = 5_000
# What is refused, and what messages call it.
REFUSED = {
    "HELIX": "a helix",
    "MLINE": "a multiline",
    "REGION": "a region",
    "3DFACE": "a 3D face",
    "3DSOLID": "a 3D solid",
    "BODY": "a 3D body",
    "MESH": "a 3D mesh",
}
SURFACES = ("SURFACE", "EXTRUDEDSURFACE", "LOFTEDSURFACE", "REVOLVEDSURFACE", "SWEPTSURFACE")
REFUSED |= dict.fromkeys(SURFACES, "a 3D surface")


@frozen
class RawChain:
    """N + 1 points (x, y, z) and N bulges, in drawing units.

    Parameters
    ----------
    numbered : whether labels number its segments.
    curved : curves of segments that are neither lines nor arcs, by their index.
    heights : z of the further points that define such curves; they must all be equal, too.
    """

    points: Sequence[Point3]
    bulges: Sequence[float]
    numbered: bool = False
    curved: Mapping[int, Pieces] = field(factory=dict)
    heights: Sequence[float] = ()


def is_seen_from_below(entity: Any) -> bool:
    """Return whether an entity's extrusion is (0, 0, -1); raise InputError when it is tilted."""
    x, y, z = entity.dxf.extrusion
    if z == 0 or abs(x) > TILT * abs(z) or abs(y) > TILT * abs(z):
        raise InputError(
            f"is tilted out of the drawing plane (extrusion {x:.4g}, {y:.4g}, {z:.4g}): "
            "draw the part flat, in the XY plane."
        )
    return bool(z < 0)


def place_chain_in_layout(
    entity: Any, points: Sequence[Point3], bulges: Sequence[float], numbered: bool = False
) -> RawChain:
    """Return a chain, given in an entity's OCS, in the coordinates of its layout or block.

    Raises InputError when the entity is tilted.
    """
    if is_seen_from_below(entity):
        points = [(-x, y, -z) for x, y, z in points]
        bulges = [-b for b in bulges]
    return RawChain(points, bulges, numbered)


def read_line(entity: Any) -> RawChain:
    """Return the chain of a LINE; its ends are never in OCS."""
    return RawChain([tuple(entity.dxf.start), tuple(entity.dxf.end)], [0.0])


def read_circle(entity: Any) -> RawChain:
    """Return the chain of a CIRCLE, two half circles."""
    x, y, z = entity.dxf.center
    radius = read_radius(entity)
    right, left = (x + radius, y, z), (x - radius, y, z)
    return place_chain_in_layout(entity, [right, left, right], [1.0, 1.0])


def read_arc(entity: Any) -> RawChain:
    """Return the chain of an ARC, counter-clockwise in its OCS; if its start and end angle are equal or a
    full turn apart, it is a full circle.
    """
    start, end = float(entity.dxf.start_angle), float(entity.dxf.end_angle)
    sweep = radians((end - start) % 360.0)
    if min(sweep, tau - sweep) < 1e-9:
        return read_circle(entity)
    x, y, z = entity.dxf.center
    radius = read_radius(entity)
    bulges = list_arc_bulges(sweep)
    angles = [radians(start), radians(end)]
    if len(bulges) == 2:
        angles.insert(1, radians(start) + sweep / 2)
    return place_chain_in_layout(
        entity, [(x + radius * cos(t), y + radius * sin(t), z) for t in angles], bulges
    )


def read_radius(entity: Any) -> float:
    """Return the radius in drawing units; raise InputError for a negative one or NaN.

    A radius of zero is allowed: it gives a chain of zero length, which is dropped later.
    """
    radius = float(entity.dxf.radius)
    if not radius >= 0:
        raise InputError(f"has the radius {radius:g}: correct it.")
    return radius


def read_lwpolyline(entity: Any) -> RawChain:
    """Return the chain of an LWPOLYLINE, with its bulges."""
    height = float(entity.dxf.elevation)
    rows = [((float(x), float(y), height), float(bulge)) for x, y, bulge in entity.get_points("xyb")]
    return place_chain_in_layout(entity, *collect_polyline_points(rows, bool(entity.closed)), numbered=True)


def read_polyline(entity: Any) -> RawChain:
    """Return the chain of an old-style POLYLINE: a flat one with bulges, a 3D one as lines.

    A 3D polyline that is not level is refused later. Raises InputError for meshes, and for polylines smoothed
    into splines.
    """
    if entity.is_poly_face_mesh or entity.is_polygon_mesh:
        raise InputError("is a 3D mesh, which has no outline: draw the part flat, with lines and arcs.")
    if entity.dxf.flags & 4:
        raise InputError(
            "is smoothed into a spline, which is not made of lines and arcs: redraw it with lines and arcs."
        )
    if entity.is_3d_polyline:
        rows = [(tuple(vertex.dxf.location), 0.0) for vertex in entity.vertices]
        return RawChain(*collect_polyline_points(rows, bool(entity.is_closed)), numbered=True)
    height = float(entity.dxf.elevation[2])
    places = [(vertex.dxf.location, float(vertex.dxf.get("bulge", 0.0))) for vertex in entity.vertices]
    rows = [((float(place[0]), float(place[1]), height), bulge) for place, bulge in places]
    return place_chain_in_layout(
        entity, *collect_polyline_points(rows, bool(entity.is_closed)), numbered=True
    )


def collect_polyline_points(
    rows: Sequence[tuple[Point3, float]], closed: bool
) -> tuple[list[Point3], list[float]]:
    """Return the points and bulges of a polyline from rows (point, bulge).

    A closed one repeats its first point at the end; an open one drops the bulge of its last vertex.
    """
    points, bulges = [point for point, _ in rows], [bulge for _, bulge in rows]
    if closed and points:
        points.append(points[0])
    return points, bulges[: max(len(points) - 1, 0)]


def read_spline(entity: Any) -> RawChain:
    """Return the chain of a SPLINE by its control points,
    or else through its fit points; these are never in OCS.

    Raises InputError where the counts of control points, knots and weights do not agree.
    """
    control = [tuple(map(float, point)) for point in entity.control_points]
    if not control:
        return read_spline_through_fit_points(entity)
    weights = list(entity.weights) or None
    pieces = split_spline(
        [point[:2] for point in control], weights, list(entity.knots), int(entity.dxf.degree)
    )
    return make_curve_chain(pieces, [z for _, _, z in control])


def read_spline_through_fit_points(entity: Any) -> RawChain:
    """Return the chain of a SPLINE that has only fit points, as CAD programs draw it.

    It is the cubic spline with continuous curvature through them whose parameter grows by the chord lengths.
    At its ends it has the tangents given, or else no curvature; where it is closed, it is periodic. Raises
    InputError for fewer than two different points, and for coordinates that are not finite.
    """
    every = [(float(x), float(y), float(z)) for x, y, z in entity.fit_points]
    if not all(isfinite(value) and abs(value) <= MOST_LENGTH for point in every for value in point):
        raise InputError("has a fit point that is not a place: repair the drawing.")
    points = every[:1] + [q for p, q in pairwise(every) if dist(p, q) > SAME_POINT]
    closed = bool(entity.closed)
    if closed and len(points) > 1 and dist(points[0], points[-1]) > SAME_POINT:
        points.append(points[0])
    count = len(points) - 1
    if count < (2 if closed else 1):
        raise InputError("has neither control points nor enough fit points: delete it.")
    if count > MOST_FIT_POINTS:
        raise InputError(
            f"has {count} fit points and no control points, more than the {MOST_FIT_POINTS:,} that are read: "
            "save it with control points."
        )
    ends = [entity.dxf.get(name) for name in ("start_tangent", "end_tangent")]
    tangents = ends if not closed and all(one is not None and abs(one) > 0 for one in ends) else None
    # Once around before and once after, a closed one has forgotten that it has ends.
    fitted = fit_points_to_cad_cv(2 * points[:-1] + points if closed else points, tangents)
    # Its ends are those drawn, without the rounding of the equations.
    control = [every[0], *((p.x, p.y) for p in fitted.control_points[1:-1]), points[-1]]
    pieces = split_spline([point[:2] for point in control], None, list(fitted.knots()), 3)
    return make_curve_chain(pieces[count : 2 * count] if closed else pieces, [z for _, _, z in points])


def read_ellipse(entity: Any) -> RawChain:
    """Return the chain of an ELLIPSE or a part of one; its coordinates are never in OCS.

    Raises InputError for an axis of zero length.
    """
    is_seen_from_below(entity)
    center, major = entity.dxf.center, entity.dxf.major_axis
    minor = entity.dxf.extrusion.normalize().cross(major) * float(entity.dxf.ratio)
    if not (abs(minor) > 0 and abs(major) > 0):
        raise InputError("has an axis without length: delete it, or draw a line.")
    start = float(entity.dxf.start_param)
    sweep = (float(entity.dxf.end_param) - start) % tau
    if min(sweep, tau - sweep) < 1e-9:
        sweep = 2 * pi
    pieces = split_ellipse((center.x, center.y), (major.x, major.y), (minor.x, minor.y), start, sweep)
    return make_curve_chain(pieces, [center.z, center.z + major.z, center.z + minor.z])


def make_curve_chain(pieces: Pieces, heights: Sequence[float]) -> RawChain:
    """Return the chain of one segment that is a curve; ``heights`` are the z of the points that define it."""
    ends = compute_point(pieces, 0.0), compute_point(pieces, float(len(pieces)))
    return RawChain([(x, y, heights[0]) for x, y in ends], [0.0], curved={0: pieces}, heights=heights)


SHAPES: dict[str, Callable[[Any], RawChain]] = {
    "LINE": read_line,
    "ARC": read_arc,
    "CIRCLE": read_circle,
    "LWPOLYLINE": read_lwpolyline,
    "POLYLINE": read_polyline,
    "SPLINE": read_spline,
    "ELLIPSE": read_ellipse,
}
