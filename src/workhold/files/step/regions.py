"""Flat regions: sections of a solid, their union, and their borders as chains of lines and arcs.

A region is an Open CASCADE shape of one or more flat faces at z = 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, dist, hypot, pi
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import SAME_CURVE, SHORTEST
from workhold.errors import InputError
from workhold.files.outline.chain import Chain, arc_bulges, at, rebulged
from workhold.files.questions import AXIS, SECTION
from workhold.files.step.solids import bounding_box, sub_shapes
from workhold.geometry.segment import Point

__all__ = ["Borders", "area_of", "borders", "level_region", "section", "union"]

# Points by which a free-form edge is compared with a line and a circle.
CURVE_POINTS = 33


@frozen
class Borders:
    """The borders of a region.

    Parameters
    ----------
    chains : closed chains in mm.
    recognised : how many edges were free-form curves that are lines or circles to within 1e-6 mm.
    gap : largest gap between consecutive edges, in mm, that was closed.
    """

    chains: tuple[Chain, ...]
    recognised: int
    gap: float


def section(solid: Any, z: float) -> Any:
    """The region in which the plane at height z cuts a solid.

    Raises
    ------
    InputError
        When the library finds none, though the solid reaches from below z to above.
    """
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.gp import gp_Dir, gp_Pln, gp_Pnt, gp_Trsf, gp_Vec
    from OCP.TopLoc import TopLoc_Location

    (x0, y0, _), (x1, y1, _) = bounding_box(solid)
    more = max(x1 - x0, y1 - y0)
    plane = gp_Pln(gp_Pnt(0.0, 0.0, z), gp_Dir(0.0, 0.0, 1.0))
    sheet = BRepBuilderAPI_MakeFace(plane, x0 - more, x1 + more, y0 - more, y1 + more).Face()
    cut = BRepAlgoAPI_Common(sheet, solid).Shape()
    if not sub_shapes(cut, "FACE"):
        raise InputError("the solid cannot be cut by a plane: repair it in the CAD program and export it again.")
    move = gp_Trsf()
    move.SetTranslation(gp_Vec(0.0, 0.0, -z))
    return cut.Moved(TopLoc_Location(move))


def level_region(face: Any, z: float, upward: bool) -> Any:
    """A level face at height z as a region: the section of the prism over it.

    The face itself would not do. Faces that look different ways do not become one in a union.

    Raises
    ------
    InputError
        As :func:`section`.
    """
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Vec

    height = 1.0 if upward else -1.0
    return section(BRepPrimAPI_MakePrism(face, gp_Vec(0.0, 0.0, height)).Shape(), z + height / 2)


def area_of(region: Any) -> float:
    """Area in mm²."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.SurfaceProperties_s(region, properties)
    return abs(float(properties.Mass()))


def union(regions: Sequence[Any]) -> Any:
    """The union of regions. A region that holds all others is returned as it is, so that its curves stay untouched.

    Raises
    ------
    InputError
        When the areas do not add up, so that the library's union cannot be right.
    """
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse

    ordered = sorted(regions, key=area_of, reverse=True)
    whole = ordered[0]
    for region in ordered[1:]:
        more = area_of(BRepAlgoAPI_Cut(region, whole).Shape())
        size = area_of(whole)
        if more <= 1e-9 * size:
            continue
        fuse = BRepAlgoAPI_Fuse(whole, region)
        fuse.SimplifyResult()
        whole = fuse.Shape()
        if abs(area_of(whole) - size - more) > 1e-6 * size:
            raise InputError(
                f"the sections of the solid cannot be united: repair it in the CAD program, or give {SECTION}."
            )
    return whole


def borders(region: Any) -> Borders:
    """The borders of a region as closed chains of lines and arcs.

    Raises
    ------
    InputError
        For a curve that is neither a line nor a circle, naming its ends.
    """
    chains: list[Chain] = []
    recognised, gap = 0, 0.0
    for wire in sub_shapes(region, "WIRE"):
        pieces = []
        for edge in wire_edges(wire):
            piece, was_free = edge_piece(edge)
            if piece is not None:
                pieces.append(piece)
                recognised += was_free
        chain, chain_gap = closed(pieces, len(chains))
        chains.append(chain)
        gap = max(gap, chain_gap)
    return Borders(tuple(chains), recognised, gap)


def wire_edges(wire: Any) -> list[Any]:
    """The edges of a wire in running order."""
    from OCP.BRepTools import BRepTools_WireExplorer

    explorer = BRepTools_WireExplorer(wire)
    edges = []
    while explorer.More():
        edges.append(explorer.Current())
        explorer.Next()
    return edges


Piece = tuple[list[Point], list[float]]


def edge_piece(edge: Any) -> tuple[Piece | None, bool]:
    """An edge as points and bulges in the direction its wire runs, and whether it was a free-form curve.

    None for an edge of zero length.

    Raises
    ------
    InputError
        For a curve that is neither a line nor a circle.
    """
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.GeomAbs import GeomAbs_CurveType
    from OCP.TopAbs import TopAbs_Orientation

    curve = BRepAdaptor_Curve(edge)
    first, last = curve.FirstParameter(), curve.LastParameter()
    kind = curve.GetType()
    free = False
    if kind == GeomAbs_CurveType.GeomAbs_Line:
        piece = line_piece(points_of(curve, [first, last]))
    elif kind == GeomAbs_CurveType.GeomAbs_Circle:
        up = curve.Circle().Axis().Direction().Z()
        bulges = arc_bulges((last - first) * (1.0 if up > 0 else -1.0))
        piece = points_of(curve, list(np.linspace(first, last, len(bulges) + 1))), bulges
    else:
        free = True
        piece = recognised_piece(points_of(curve, list(np.linspace(first, last, CURVE_POINTS))), str(kind.name))
    if piece is None:
        return None, False
    if edge.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
        piece = piece[0][::-1], [-bulge if bulge else 0.0 for bulge in reversed(piece[1])]
    return piece, free


def points_of(curve: Any, parameters: Sequence[float]) -> list[Point]:
    """Points (x, y) of a curve."""
    values = [curve.Value(float(t)) for t in parameters]
    return [(value.X(), value.Y()) for value in values]


def line_piece(points: list[Point]) -> Piece | None:
    """A straight piece, or None when it has no length."""
    return (points, [0.0]) if dist(points[0], points[-1]) >= SHORTEST else None


def recognised_piece(points: list[Point], name: str) -> Piece | None:
    """The line or circle that a free-form curve is.

    Raises
    ------
    InputError
        When it is neither.
    """
    array = np.array(points)
    if float(np.hypot(*(array - array[0]).T).max()) < SHORTEST:
        return None
    if is_straight(array):
        return line_piece([points[0], points[-1]])
    arc = arc_through(array)
    if arc is not None:
        return arc
    what = "an ellipse" if name.endswith("Ellipse") else "a free-form curve"
    raise InputError(
        f"the outline has {what} from {at(points[0])} over {at(points[len(points) // 2])} to {at(points[-1])}, which is "
        f"neither a line nor a circle: replace it by lines and arcs in the CAD program, or look along another {AXIS}."
    )


def is_straight(points: NDArray[np.float64]) -> bool:
    """Whether (N, 2) points lie on the line from the first to the last, in order."""
    chord = points[-1] - points[0]
    length = float(np.hypot(*chord))
    if length < SHORTEST:
        return False
    away = points - points[0]
    off = np.abs(away[:, 0] * chord[1] - away[:, 1] * chord[0]) / length
    return bool(off.max() <= SAME_CURVE and (np.diff(away @ chord) > 0).all())


def arc_through(points: NDArray[np.float64]) -> Piece | None:
    """The circular arc through (N, 2) points in order, or None when they lie on none."""
    third = len(points) // 3
    a, b, c = points[0], points[third], points[2 * third]
    (bx, by), (cx, cy) = b - a, c - a
    twice = 2 * (bx * cy - by * cx)
    if twice == 0:
        return None
    center = (
        a
        + np.array([cy * (b - a) @ (b - a) - by * (c - a) @ (c - a), bx * (c - a) @ (c - a) - cx * (b - a) @ (b - a)])
        / twice
    )
    radii = np.hypot(*(points - center).T)
    if float(np.ptp(radii)) > SAME_CURVE:
        return None
    angles = [atan2(y - center[1], x - center[0]) for x, y in points]
    steps = np.diff(angles)
    steps = (steps + pi) % (2 * pi) - pi
    if not ((steps > 0).all() or (steps < 0).all()):
        return None
    bulges = arc_bulges(float(steps.sum()))
    middle = [points[len(points) // 2]] if len(bulges) == 2 else []
    ends = [(float(x), float(y)) for x, y in (points[0], *middle, points[-1])]
    if len(bulges) == 2:
        half = float(steps[: len(points) // 2].sum())
        bulges = [arc_bulges(half)[0], arc_bulges(float(steps.sum()) - half)[0]]
    return ends, bulges


def closed(pieces: Sequence[Piece], number: int) -> tuple[Chain, float]:
    """One closed chain of pieces in running order, and the largest gap closed; arcs keep their centres."""
    points: list[Point] = []
    bulges: list[float] = []
    gap = 0.0
    for k, (own, own_bulges) in enumerate(pieces):
        following = pieces[(k + 1) % len(pieces)][0][0]
        end = own[-1]
        step = hypot(following[0] - end[0], following[1] - end[1])
        gap = max(gap, step)
        points += own[:-1]
        last = own_bulges[-1] if step == 0 else rebulged(own[-2], end, own_bulges[-1], own[-2], following)
        bulges += [*own_bulges[:-1], last]
    labels = tuple(f"edge {k} of border {number}" for k in range(len(bulges)))
    return Chain((*points, points[0]), tuple(bulges), labels), gap
