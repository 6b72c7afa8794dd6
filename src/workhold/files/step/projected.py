"""The curves of a solid that can bound its projection along the axis, as lines and arcs in the plane.

A point on the border of a slab's projection lies on an edge, on a fold of a face, or on the cut at either end
of the slab. Further curves do no harm, because only pieces with material on one side are
taken. So curves are taken whole where that is simple.

Glossary
--------
fold : where a leaning face stands upright: the contour generator of computer vision (Cipolla and Giblin,
    "Visual Motion of Curves and Surfaces", 2000).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import acos, atan2, cos, hypot, pi, sin, sqrt
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import ALIGNED, SAME_HEIGHT, SHORTEST
from workhold.files.step.edge_curves import EdgeCurve, curve_of
from workhold.files.step.faces import SolidFace, surface_of
from workhold.files.step.solids import sub_shapes
from workhold.geometry.segment import Arc, Line, Point, Segment

__all__ = ["ProjectedCurves", "projected_curves"]


@frozen
class ProjectedCurves:
    """All curves that can bound the projection of a slab.

    Parameters
    ----------
    segments : lines and arcs.
    cuts : segments with points at which they are to be cut besides.
    others : of curves that are neither, the face's index and (N, 2) points in mm.
    """

    segments: tuple[Segment, ...]
    cuts: tuple[tuple[Segment, Point], ...]
    others: tuple[tuple[int, NDArray[np.float64]], ...]


def projected_curves(
    faces: Sequence[SolidFace], edges: Sequence[EdgeCurve], low: float, high: float
) -> ProjectedCurves:
    """Every curve that can bound the projection of the slab between two z in mm."""
    segments: list[Segment] = []
    cuts: list[tuple[Segment, Point]] = []
    others: list[tuple[int, NDArray[np.float64]]] = []
    for edge in edges:
        if edge.high < low - SAME_HEIGHT or edge.low > high + SAME_HEIGHT:
            continue
        if edge.segment is not None:
            segments.append(edge.segment)
            cuts += [(edge.segment, point) for z in (low, high) for point in edge.crossings(z)]
        elif edge.is_other:
            others.append((edge.face, edge.points[:, :2]))
    for index, face in enumerate(faces):
        if face.lie != "leaning" or face.high < low - SAME_HEIGHT or face.low > high + SAME_HEIGHT:
            continue
        levels = [z for z in (low, high) if face.low - SAME_HEIGHT <= z <= face.high + SAME_HEIGHT]
        for found in (*folds(face), *(one for z in levels for one in level_cuts(face, z))):
            if isinstance(found, Line | Arc):
                segments.append(found)
            else:
                others.append((index, found))
    return ProjectedCurves(tuple(segments), tuple(cuts), tuple(others))


Found = Segment | NDArray[np.float64]


def folds(face: SolidFace) -> list[Found]:
    """Where a leaning face stands upright, seen from above; more of it than the face has does no harm."""
    from OCP.GeomAbs import GeomAbs_SurfaceType as Type

    surface = surface_of(face.shape)
    kind = surface.GetType()
    if kind == Type.GeomAbs_Plane:
        return []
    if kind == Type.GeomAbs_Sphere:
        ball = surface.Sphere()
        return [whole_circle(ball.Location(), ball.Radius())]
    if kind in (Type.GeomAbs_Cylinder, Type.GeomAbs_Cone):
        return list(ruled_folds(surface, kind == Type.GeomAbs_Cylinder))
    if kind == Type.GeomAbs_Torus:
        ring = surface.Torus()
        axis = ring.Axis().Direction()
        if hypot(axis.X(), axis.Y()) <= ALIGNED:
            radii = (ring.MajorRadius() + ring.MinorRadius(), ring.MajorRadius() - ring.MinorRadius())
            return [whole_circle(ring.Location(), radius) for radius in radii if radius > SHORTEST]
    return free_folds(surface)


def whole_circle(center: Any, radius: float) -> Arc:
    """A circle about a point, seen from above."""
    return Arc((center.X(), center.Y()), radius, 0.0, pi, 1.0)


def ruled_folds(surface: Any, is_cylinder: bool) -> Iterator[Line]:
    """The rulings of a cylinder or a cone along which the normal is level.

    The radial direction is r(u) = X cos u + Y sin u. With the axis d and half the cone's angle h, 0 of a
    cylinder, the normal is r(u) cos h - d sin h. It is level where r(u)_z cos h = d_z sin h.
    """
    shape = surface.Cylinder() if is_cylinder else surface.Cone()
    half = 0.0 if is_cylinder else shape.SemiAngle()
    position = shape.Position()
    x, y, d = position.XDirection().Z(), position.YDirection().Z(), position.Direction().Z()
    size = hypot(x, y)
    if size <= ALIGNED:
        return
    value = d * sin(half) / (cos(half) * size)
    if abs(value) > 1:
        return
    low, high = surface.FirstVParameter(), surface.LastVParameter()
    for turn in {acos(value), -acos(value)}:
        u = atan2(y, x) + turn
        a, b = surface.Value(u, low), surface.Value(u, high)
        if hypot(b.X() - a.X(), b.Y() - a.Y()) >= SHORTEST:
            yield Line((a.X(), a.Y()), (b.X(), b.Y()))


def free_folds(surface: Any, steps: int = 25) -> list[Found]:
    """Points (N, 2) of a free-form face, or a tilted ring, at which its normal is level, found on a grid."""
    us = np.linspace(surface.FirstUParameter(), surface.LastUParameter(), steps)
    vs = np.linspace(surface.FirstVParameter(), surface.LastVParameter(), steps)
    values = np.array([[normal_height(surface, u, v) for v in vs] for u in us])
    points = []
    for i, j in zip(*np.nonzero(values[:, :-1] * values[:, 1:] < 0), strict=True):
        a, b = vs[j], vs[j + 1]
        below = values[i, j] < 0
        for _ in range(40):
            middle = (a + b) / 2
            a, b = (middle, b) if (normal_height(surface, us[i], middle) < 0) == below else (a, middle)
        point = surface.Value(float(us[i]), float(a))
        points.append((point.X(), point.Y()))
    return [np.array(points)] if points else []


def normal_height(surface: Any, u: float, v: float) -> float:
    """The z of a surface's normal, of any length."""
    from OCP.gp import gp_Pnt, gp_Vec

    point, along_u, along_v = gp_Pnt(), gp_Vec(), gp_Vec()
    surface.D1(float(u), float(v), point, along_u, along_v)
    return float(along_u.X() * along_v.Y() - along_u.Y() * along_v.X())


def level_cuts(face: SolidFace, z: float) -> list[Found]:
    """The curves in which a level plane meets a leaning face's surface, seen from above."""
    from OCP.GeomAbs import GeomAbs_SurfaceType as Type

    surface = surface_of(face.shape)
    kind = surface.GetType()
    if kind == Type.GeomAbs_Plane:
        return plane_cut(surface.Plane(), face, z)
    if kind == Type.GeomAbs_Sphere:
        ball = surface.Sphere()
        square = ball.Radius() ** 2 - (z - ball.Location().Z()) ** 2
        return [whole_circle(ball.Location(), sqrt(square))] if square > SHORTEST**2 else []
    if kind == Type.GeomAbs_Cylinder:
        cylinder = surface.Cylinder()
        axis = cylinder.Axis().Direction()
        if abs(axis.Z()) <= ALIGNED:
            return lying_cut(surface, cylinder, z)
    if kind == Type.GeomAbs_Cone:
        cone = surface.Cone()
        axis = cone.Axis().Direction()
        if hypot(axis.X(), axis.Y()) <= ALIGNED:
            apex = cone.Apex()
            radius = abs((z - apex.Z()) * sin(cone.SemiAngle()) / cos(cone.SemiAngle()))
            return [whole_circle(apex, radius)] if radius > SHORTEST else []
    if kind == Type.GeomAbs_Torus:
        ring = surface.Torus()
        axis = ring.Axis().Direction()
        if hypot(axis.X(), axis.Y()) <= ALIGNED:
            square = ring.MinorRadius() ** 2 - (z - ring.Location().Z()) ** 2
            reach = sqrt(max(square, 0.0))
            radii = {ring.MajorRadius() + reach, ring.MajorRadius() - reach} if square >= 0 else set()
            return [whole_circle(ring.Location(), radius) for radius in radii if radius > SHORTEST]
    return cut_edges(face.shape, z)


def plane_cut(plane: Any, face: SolidFace, z: float) -> list[Found]:
    """The line in which a sloping plane passes a height, as long as the face is wide."""
    normal, place = plane.Axis().Direction(), plane.Location()
    across = hypot(normal.X(), normal.Y())
    nx, ny = normal.X() / across, normal.Y() / across
    # The point of the line nearest to the plane's location: n . (q - place) = 0 at z.
    away = -(z - place.Z()) * normal.Z() / across
    x, y = place.X() + away * nx, place.Y() + away * ny
    corners = np.array([(px, py) for px in face.box[0::2] for py in face.box[1::2]])
    along = (corners - (x, y)) @ np.array([-ny, nx])
    low, high = float(along.min()), float(along.max())
    if high - low < SHORTEST:
        return []
    return [Line((x - low * ny, y + low * nx), (x - high * ny, y + high * nx))]


def lying_cut(surface: Any, cylinder: Any, z: float) -> list[Found]:
    """The two rulings in which a lying cylinder passes a height."""
    position = cylinder.Position()
    center = cylinder.Location()
    share = (z - center.Z()) / cylinder.Radius()
    if abs(share) > 1:
        return []
    # The radial direction at u rises by X_z cos u + Y_z sin u, which has amplitude 1 on a lying cylinder.
    top = atan2(position.YDirection().Z(), position.XDirection().Z())
    low, high = surface.FirstVParameter(), surface.LastVParameter()
    found: list[Found] = []
    for turn in {acos(share), -acos(share)}:
        a, b = surface.Value(top + turn, low), surface.Value(top + turn, high)
        found.append(Line((a.X(), a.Y()), (b.X(), b.Y())))
    return found


def cut_edges(shape: Any, z: float) -> list[Found]:
    """The curves in which a level plane cuts a face of any surface, by Open CASCADE."""
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Section
    from OCP.gp import gp_Dir, gp_Pln, gp_Pnt

    cut = BRepAlgoAPI_Section(shape, gp_Pln(gp_Pnt(0.0, 0.0, z), gp_Dir(0.0, 0.0, 1.0)))
    found: list[Found] = []
    for edge in sub_shapes(cut.Shape(), "EDGE"):
        curve = curve_of(0, BRepAdaptor_Curve(edge))
        if curve.segment is not None:
            found.append(curve.segment)
        elif curve.is_other:
            found.append(curve.points[:, :2])
    return found
