"""Free-form edges of a solid's sections as rational Bézier pieces, exactly: Open CASCADE's own poles, weights and knots."""

from __future__ import annotations

from typing import Any

from workhold.errors import InputError
from workhold.geometry.rational import Pieces, spline_pieces

__all__ = ["edge_curve"]


def edge_curve(edge: Any) -> Pieces:
    """The pieces of an edge's curve, seen from above, in its own direction.

    Raises
    ------
    InputError
        Where the library knows no curve of the edge, or the curve is no spline that can be used.
    """
    from OCP.BRep import BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.Geom import Geom_TrimmedCurve
    from OCP.GeomConvert import GeomConvert

    adaptor = BRepAdaptor_Curve(edge)
    first, last = adaptor.FirstParameter(), adaptor.LastParameter()
    curve = BRep_Tool.Curve_s(edge, first, last)
    if curve is None:
        raise InputError("the outline has an edge without a curve: repair the solid in the CAD program.")
    spline = GeomConvert.CurveToBSplineCurve_s(Geom_TrimmedCurve(curve, first, last))
    if spline.IsPeriodic():
        spline.SetNotPeriodic()
    numbers = range(1, spline.NbPoles() + 1)
    poles = [spline.Pole(k) for k in numbers]
    knots = [spline.Knot(k) for k in range(1, spline.NbKnots() + 1) for _ in range(spline.Multiplicity(k))]
    try:
        return spline_pieces(
            [(pole.X(), pole.Y()) for pole in poles], [spline.Weight(k) for k in numbers], knots, spline.Degree()
        )
    except InputError as error:
        raise InputError(f"an edge of the outline {error}") from error
