"""Flat regions: sections of a solid, their union, and their borders as chains of lines and arcs.

A region is an Open CASCADE shape of one or more flat faces at z = 0. Free-form edges are rational Bézier
pieces, exactly: Open CASCADE's own poles, weights and knots.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import dist
from typing import Any

import numpy as np
from attrs import frozen

from workhold.conventions import EDGE_GAP, SHORTEST
from workhold.errors import InputError
from workhold.files.outline.chain import Chain, CurveReading, compute_moved_bulge, list_arc_bulges
from workhold.files.outline.curves import CurveReader
from workhold.files.questions import SECTION
from workhold.files.step.library import compute_bounding_box, list_sub_shapes, occ, raise_shape
from workhold.geometry.rational import Pieces, split_spline
from workhold.geometry.segment import Point

__all__ = [
    "RegionBorders",
    "measure_area",
    "trace_borders",
    "convert_edge_to_pieces",
    "make_level_region",
    "cut_solid_at_height",
    "unite_regions",
]


def convert_edge_to_pieces(edge: Any) -> Pieces:
    """Return an edge's curve, seen from above, as rational Bézier pieces in the direction of the curve.

    Raises InputError where the library has no curve of the edge, or none that can be used as a spline.
    """
    adaptor = occ.BRepAdaptor_Curve(edge)
    first, last = adaptor.FirstParameter(), adaptor.LastParameter()
    curve = occ.BRep_Tool.Curve_s(edge, first, last)
    if curve is None:
        raise InputError("the outline has an edge without a curve: repair the solid in the CAD program.")
    spline = occ.GeomConvert.CurveToBSplineCurve_s(occ.Geom_TrimmedCurve(curve, first, last))
    if spline.IsPeriodic():
        spline.SetNotPeriodic()
    numbers = range(1, spline.NbPoles() + 1)
    poles = [spline.Pole(k) for k in numbers]
    knots = [spline.Knot(k) for k in range(1, spline.NbKnots() + 1) for _ in range(spline.Multiplicity(k))]
    try:
        return split_spline(
            [(pole.X(), pole.Y()) for pole in poles],
            [spline.Weight(k) for k in numbers],
            knots,
            spline.Degree(),
        )
    except InputError as error:
        raise InputError(f"an edge of the outline {error}") from error


@frozen
class RegionBorders:
    """The borders of a region.

    Parameters
    ----------
    chains : closed chains in mm.
    curves : readings of the edges that are neither line nor arc, by their labels in the chains.
    gap : largest gap between consecutive edges, in mm, that was closed.
    """

    chains: tuple[Chain, ...]
    curves: Mapping[str, CurveReading]
    gap: float

    @property
    def departure(self) -> float:
        """Largest distance in mm between the chains and the region's border."""
        return max((one.departure for one in self.curves.values()), default=0.0)

    @property
    def remarks(self) -> tuple[str, ...]:
        """A sentence for the user about closed gaps, if they are more than rounding."""
        closed = f"Closed gaps of up to {self.gap:.2g} mm between edges of the outline."
        return (closed,) if self.gap > EDGE_GAP else ()


def cut_solid_at_height(solid: Any, z: float) -> Any:
    """Return the region in which the plane at height z cuts
    a solid, moved to z = 0; raise InputError if it is empty.
    """
    (x0, y0, _), (x1, y1, _) = compute_bounding_box(solid)
    more = max(x1 - x0, y1 - y0)
    plane = occ.gp_Pln(occ.gp_Pnt(0.0, 0.0, z), occ.gp_Dir(0.0, 0.0, 1.0))
    sheet = occ.BRepBuilderAPI_MakeFace(plane, x0 - more, x1 + more, y0 - more, y1 + more).Face()
    cut = occ.BRepAlgoAPI_Common(sheet, solid).Shape()
    if not list_sub_shapes(cut, "FACE"):
        raise InputError(
            "the solid cannot be cut by a plane: repair it in the CAD program and export it again."
        )
    return raise_shape(cut, -z)


def make_level_region(face: Any, z: float, upward: bool) -> Any:
    """Return a level face at height z as a region at z = 0: the section of the prism over it, or under it.

    The face itself would not do: faces that look in different directions are not merged in a union.
    """
    height = 1.0 if upward else -1.0
    return cut_solid_at_height(
        occ.BRepPrimAPI_MakePrism(face, occ.gp_Vec(0.0, 0.0, height)).Shape(), z + height / 2
    )


def measure_area(region: Any) -> float:
    """Return the area of a region in mm²."""
    properties = occ.GProp_GProps()
    occ.BRepGProp.SurfaceProperties_s(region, properties)
    return abs(float(properties.Mass()))


def unite_regions(regions: Sequence[Any]) -> Any:
    """Return the union of one or more regions.

    A region that contains all others is returned as it is, so that its curves stay untouched. Raises
    InputError where the union's area is not that of its parts, because then the library's union is wrong.
    """
    ordered = sorted(regions, key=measure_area, reverse=True)
    whole = ordered[0]
    for region in ordered[1:]:
        more = measure_area(occ.BRepAlgoAPI_Cut(region, whole).Shape())
        size = measure_area(whole)
        if more <= 1e-9 * size:
            continue
        fuse = occ.BRepAlgoAPI_Fuse(whole, region)
        fuse.SimplifyResult()
        whole = fuse.Shape()
        if abs(measure_area(whole) - size - more) > 1e-6 * size:
            raise InputError(
                "the sections of the solid cannot be united: repair it in the CAD program, or give "
                f"{SECTION}."
            )
    return whole


def trace_borders(region: Any, fit: float | None = None) -> RegionBorders:
    """Return the borders of a region as closed chains of lines and arcs.

    ``fit`` is the largest distance in mm from curves that are neither, see ``files.outline.curves``.
    """
    chains: list[Chain] = []
    curves = CurveReader(fit)
    gap = 0.0
    for wire in list_sub_shapes(region, "WIRE"):
        pieces: list[Piece] = []
        edges = occ.BRepTools_WireExplorer(wire)
        while edges.More():
            label = f"curved edge {len(pieces)} of border {len(chains)}"
            piece = make_edge_piece(edges.Current(), curves, label)
            if piece is not None:
                pieces.append(piece)
            edges.Next()
        if not pieces:
            # A line on which something else touches the face from within bounds nothing.
            continue
        chain, chain_gap = close_pieces(pieces, len(chains))
        chains.append(chain)
        gap = max(gap, chain_gap)
    return RegionBorders(tuple(chains), curves.found, gap)


# Points, bulges and what messages call the curve that they stand for; None for a line and an arc.
Piece = tuple[list[Point], list[float], str | None]


def make_edge_piece(edge: Any, curves: CurveReader, label: str) -> Piece | None:
    """Return an edge in the direction its wire runs; None for an edge of zero length.

    ``label`` is the name that messages have for the edge, if it is neither line nor arc. Raises InputError
    for a curve that cannot be read.
    """
    curve = occ.BRepAdaptor_Curve(edge)
    first, last = curve.FirstParameter(), curve.LastParameter()
    kind = curve.GetType()
    name = None
    if kind == occ.GeomAbs_Line:
        points, bulges = compute_curve_points(curve, [first, last]), [0.0]
        if dist(points[0], points[-1]) < SHORTEST:
            return None
    elif kind == occ.GeomAbs_Circle:
        up = curve.Circle().Axis().Direction().Z()
        bulges = list_arc_bulges((last - first) * (1.0 if up > 0 else -1.0))
        points = compute_curve_points(curve, list(np.linspace(first, last, len(bulges) + 1)))
    else:
        read = curves.read(convert_edge_to_pieces(edge), label)
        if read is None:
            return None
        name, points, bulges = label, list(read.points), list(read.bulges)
    if edge.Orientation() == occ.TopAbs_REVERSED:
        points, bulges = points[::-1], [-bulge if bulge else 0.0 for bulge in reversed(bulges)]
    return points, bulges, name


def compute_curve_points(curve: Any, parameters: Sequence[float]) -> list[Point]:
    """Return the points (x, y) in mm of Open CASCADE's curve at some parameters."""
    values = [curve.Value(float(t)) for t in parameters]
    return [(value.X(), value.Y()) for value in values]


def close_pieces(pieces: Sequence[Piece], number: int) -> tuple[Chain, float]:
    """Return one closed chain of pieces in running order, and the largest gap in mm between two of them.

    The end of each piece is moved onto the start of the next; arcs keep their centres. ``number`` is the
    border's, for labels.
    """
    points: list[Point] = []
    bulges: list[float] = []
    labels: list[str] = []
    gap = 0.0
    for k, (own, own_bulges, name) in enumerate(pieces):
        following, end = pieces[(k + 1) % len(pieces)][0][0], own[-1]
        step = dist(following, end)
        gap = max(gap, step)
        last = (
            own_bulges[-1]
            if step == 0
            else compute_moved_bulge(own[-2], end, own_bulges[-1], own[-2], following)
        )
        labels += [name or f"edge {len(bulges)} of border {number}"] * len(own_bulges)
        points += own[:-1]
        bulges += [*own_bulges[:-1], last]
    return Chain((*points, points[0]), tuple(bulges), tuple(labels)), gap
