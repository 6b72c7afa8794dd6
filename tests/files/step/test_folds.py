"""Folds of leaning faces, and cuts through them, that are lines and circles: their outlines are exact."""

from __future__ import annotations

from itertools import pairwise
from math import cos, floor, hypot, pi, sin, sqrt
from typing import Any

import numpy as np
import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeWire,
    BRepBuilderAPI_NurbsConvert,
)
from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol, BRepPrimAPI_MakeTorus
from OCP.collections import Array1_gp_Pnt
from OCP.GC import GC_MakeSegment
from OCP.Geom import Geom_BezierCurve
from OCP.gp import gp_Ax1, gp_Ax2, gp_Dir, gp_Pnt
from step_shapes import box, cut, cylinder, fused

from workhold.files.step.edge_curves import bisect_condition, find_zero_crossing
from workhold.files.step.enclosing import Enclosure, find_fold_squares, list_fold_boxes
from workhold.files.step.faces import find_surface
from workhold.files.step.heights import measure_outline, stand_solid
from workhold.files.step.library import list_sub_shapes
from workhold.files.step.projected import OtherCurveError, compute_normal_height


def area_at(shape: Any, high: float) -> float:
    """Area in mm² of the outline of pegs as high as told, with no head room."""
    return measure_outline(stand_solid(shape).make_outline(high, 0.0))[0]


def test_lying_ring_is_seen_as_circles_and_lines() -> None:
    """A ring with a level axis, turned by any angle, is seen as two half circles with lines between: 4 R r + pi r^2."""
    for angle in (0.0, 0.3, 2.0):
        axis = gp_Ax2(gp_Pnt(3, -2, 7), gp_Dir(np.cos(angle), np.sin(angle), 0))
        ring = BRepPrimAPI_MakeTorus(axis, 20, 5).Solid()
        assert area_at(ring, 60.0) == pytest.approx(4 * 20 * 5 + pi * 25, rel=1e-7)


def spun(waist: float) -> Any:
    """A spline from (10, 0) over (waist, 10) to (10, 20), closed by lines, turned about z."""
    poles = Array1_gp_Pnt(1, 3)
    for k, (x, z) in enumerate([(10, 0), (waist, 10), (10, 20)], start=1):
        poles.SetValue(k, gp_Pnt(x, 0, z))
    corners = [gp_Pnt(10, 0, 20), gp_Pnt(0, 0, 20), gp_Pnt(0, 0, 0), gp_Pnt(10, 0, 0)]
    wire = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(Geom_BezierCurve(poles)).Edge())
    for a, b in pairwise(corners):
        wire.Add(BRepBuilderAPI_MakeEdge(GC_MakeSegment(a, b).Value()).Edge())
    axis = gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))
    return BRepPrimAPI_MakeRevol(BRepBuilderAPI_MakeFace(wire.Wire()).Face(), axis).Shape()


@pytest.mark.parametrize(("high", "radius"), [(60.0, 13.0), (5.0, 10.0 + 12 * 0.25 * 0.75), (15.0, 13.0)])
def test_turned_spline_is_seen_as_circles(high: float, radius: float) -> None:
    """The Bezier curve is x = 10 + 12 t (1 - t), z = 20 t: widest at t = 1/2, and at t = z / 20 below that."""
    assert area_at(spun(16.0), high) == pytest.approx(pi * radius**2, rel=1e-9)


def test_curve_of_the_border_is_found_where_it_reaches_out_little() -> None:
    """A slanted hole's ellipse is refused, also where it is a small part of what is there; one out of sight is not."""
    slanted = cylinder(4, 80, (30, 20, -20), (0.3, 0, 1))
    with pytest.raises(OtherCurveError, match="a cylinder of radius 4 mm aslant"):
        stand_solid(cut(box(60, 40, 20), slanted)).make_outline()
    hidden = fused(cut(box(60, 40, 20), slanted), box(60, 40, 5, (0, 0, -5)))
    assert measure_outline(stand_solid(hidden).make_outline())[0] == pytest.approx(2400)


@pytest.mark.parametrize("root", [0.1, 1 / 3, sqrt(0.5), 0.999])
@pytest.mark.parametrize("power", [1, 3])
def test_crossing_is_that_of_bisection(root: float, power: int) -> None:
    """Where a value passes 0 is found to the last digit that bisection alone would give, and sooner."""
    asked: list[float] = []

    def value(t: float) -> float:
        asked.append(t)
        return float(t**power - root**power)

    ends = (0.0, value(0.0)), (1.0, value(1.0))
    plain = sum(bisect_condition(0.0, 1.0, lambda t: value(t) >= 0.0, (0.0, 1.0), 60)) / 2
    asked.clear()
    assert find_zero_crossing(value, *ends) == plain
    assert len(asked) <= (25 if power == 1 else 80)


def test_crossing_of_a_value_that_falls() -> None:
    """The end with the value below 0 may be the greater one."""
    assert find_zero_crossing(lambda t: 0.25 - t, (1.0, -0.75), (0.0, 0.25)) == pytest.approx(0.25, abs=1e-15)


def test_squares_hold_a_fold_with_room_beside_it() -> None:
    """Where a free-form face stands upright lies in a square, as far inside that no rounding leads out of it."""
    ring = BRepPrimAPI_MakeTorus(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0.3, 0.2, 0.9)), 10.0, 3.0).Shape()
    (face,) = list_sub_shapes(BRepBuilderAPI_NurbsConvert(ring).Shape(), "FACE")
    surface, size, room = find_surface(face), 0.5, 0.02
    squares = find_fold_squares(surface, size)
    u = np.linspace(surface.FirstUParameter(), surface.LastUParameter(), 241)
    v = np.linspace(surface.FirstVParameter(), surface.LastVParameter(), 241)
    missed = found = 0
    for a in u:
        leans = [compute_normal_height(surface, float(a), float(b)) for b in v]
        for k in range(len(v) - 1):
            if (leans[k] > 0.0) == (leans[k + 1] > 0.0):
                continue
            share = leans[k] / (leans[k] - leans[k + 1])
            place = surface.Value(float(a), float(v[k] + share * (v[k + 1] - v[k])))
            found += 1
            for dx, dy in ((room, 0.0), (-room, 0.0), (0.0, room), (0.0, -room)):
                at = int(np.floor((place.X() + dx) / size)), int(np.floor((place.Y() + dy) / size))
                missed += at not in squares
    assert found > 400 and missed == 0


def test_boxes_hold_the_outline_where_two_folds_cross() -> None:
    """Of two discs that overlap all of the border is held, also in the gaps beside where it crosses itself."""
    size, reach = 0.5, 10.0
    circles = [
        [(x + reach * cos(k / 500), y + reach * sin(k / 500)) for k in range(3142)]
        for x, y in ((0.0, 0.0), (19.0, 4.0))
    ]

    def is_there(point: tuple[float, float]) -> bool:
        return any(hypot(point[0] - x, point[1] - y) < reach - 1e-9 for x, y in ((0.0, 0.0), (19.0, 4.0)))

    squares = {(floor(x / size), floor(y / size)) for circle in circles for x, y in circle}
    held = Enclosure(polygons=list_fold_boxes(squares, size, is_there))
    border = [place for circle in circles for place in circle if not is_there(place)]
    assert len(border) > 3000 and all(map(held.may_hold, border))
    # A fold at which there is nothing, as it lies below the heights that are asked about, is left out.
    assert list_fold_boxes({(100, 100)}, size, is_there) == []
