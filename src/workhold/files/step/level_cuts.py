"""The curves in which a level plane meets a leaning face's surface, seen from above."""

from __future__ import annotations

from math import acos, atan2, cos, hypot, sin, sqrt
from typing import Any

import numpy as np

from workhold.conventions import ALIGNED, SHORTEST
from workhold.files.step.edge_curves import Found, curve_of
from workhold.files.step.faces import SolidFace, surface_of
from workhold.files.step.solids import sub_shapes
from workhold.files.step.turned import is_upright, turned_cuts, whole_circle
from workhold.geometry.segment import Line

__all__ = ["level_cuts"]


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
    if kind == Type.GeomAbs_SurfaceOfRevolution and is_upright(surface.AxeOfRevolution()):
        return turned_cuts(surface, z)
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
