"""Folds of leaning faces: where a face stands upright, and so may bound what is seen of it from above.

Folds and level cuts of a surface turned about an upright axis are circles, whatever is turned.

Glossary
--------
fold : the contour generator of computer vision (Cipolla and Giblin, "Visual Motion of Curves and Surfaces",
    2000).
turned surface : a curve turned about an axis, as of a part from the lathe.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import acos, atan2, cos, hypot, pi, sin
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import ALIGNED, SHORTEST
from workhold.files.step.edge_curves import Found, Point3, crossing, curve_point, extremes, height
from workhold.files.step.faces import SolidFace, surface_of
from workhold.files.step.library import occ
from workhold.geometry.segment import Arc, Line

__all__ = ["folds", "is_upright", "turned_cuts", "turned_folds", "whole_circle"]

# Points along the curve that is turned.
SAMPLES = 65
Array = NDArray[np.float64]


def folds(face: SolidFace) -> list[Found]:
    """Where a leaning face stands upright, seen from above; more of it than the face has does no harm."""
    surface = surface_of(face.shape)
    kind = surface.GetType()
    if kind == occ.GeomAbs_Plane:
        return []
    if kind == occ.GeomAbs_Sphere:
        ball = surface.Sphere()
        return [whole_circle(ball.Location(), ball.Radius())]
    if kind in (occ.GeomAbs_Cylinder, occ.GeomAbs_Cone):
        return list(ruled_folds(surface, kind == occ.GeomAbs_Cylinder))
    if kind == occ.GeomAbs_Torus:
        ring = surface.Torus()
        axis = ring.Axis().Direction()
        if hypot(axis.X(), axis.Y()) <= ALIGNED:
            radii = (ring.MajorRadius() + ring.MinorRadius(), ring.MajorRadius() - ring.MinorRadius())
            return [whole_circle(ring.Location(), radius) for radius in radii if radius > SHORTEST]
        if abs(axis.Z()) <= ALIGNED:
            return lying_ring_folds(ring)
    if kind == occ.GeomAbs_SurfaceOfRevolution and is_upright(surface.AxeOfRevolution()):
        return turned_folds(surface)
    return free_folds(surface)


def lying_ring_folds(ring: Any) -> list[Found]:
    """Where a ring with a level axis stands upright, seen from above: two circles and two lines.

    With the axis d and the radial direction r(u), the normal at the angle v of the tube is
    cos v r(u) + sin v d. It is level at cos v = 0, and where r is level: at b and -b, across the axis.
    """
    center, axis = ring.Location(), ring.Axis().Direction()
    x, y, major, minor = center.X(), center.Y(), ring.MajorRadius(), ring.MinorRadius()
    dx, dy = axis.X(), axis.Y()
    found: list[Found] = []
    for side in (-1.0, 1.0):
        px, py = x + side * minor * dx, y + side * minor * dy
        found.append(Arc((x - side * major * dy, y + side * major * dx), minor, 0.0, pi, 1.0))
        found.append(Line((px + major * dy, py - major * dx), (px - major * dy, py + major * dx)))
    return found


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
    point, along_u, along_v = occ.gp_Pnt(), occ.gp_Vec(), occ.gp_Vec()
    surface.D1(float(u), float(v), point, along_u, along_v)
    return float(along_u.X() * along_v.Y() - along_u.Y() * along_v.X())


def is_upright(axis: Any) -> bool:
    """Whether an axis of the library is parallel to z."""
    direction = axis.Direction()
    return hypot(direction.X(), direction.Y()) <= ALIGNED


def whole_circle(center: Any, radius: float) -> Arc:
    """A circle about a point of the library, seen from above."""
    return Arc((center.X(), center.Y()), radius, 0.0, pi, 1.0)


@frozen
class Meridian:
    """The curve that a surface turns about an upright axis, asked as the library's curves are.

    Parameters
    ----------
    surface : Open CASCADE's.
    """

    surface: Any

    def Value(self, parameter: float) -> Any:
        """The point at a parameter."""
        return self.surface.Value(self.surface.FirstUParameter(), parameter)

    @property
    def axis(self) -> Any:
        """A point of the axis."""
        return self.surface.AxeOfRevolution().Location()

    def radius(self, point: Point3) -> float:
        """The distance in mm of a point from the axis."""
        return hypot(point[0] - self.axis.X(), point[1] - self.axis.Y())

    def samples(self) -> tuple[Array, list[Point3]]:
        """Parameters (N,) from end to end, and the points there in mm."""
        parameters = np.linspace(self.surface.FirstVParameter(), self.surface.LastVParameter(), SAMPLES)
        return parameters, [curve_point(self, float(t)) for t in parameters]

    def circles(self, parameters: Sequence[float]) -> list[Found]:
        """The circles that some of its points run through."""
        radii = [self.radius(curve_point(self, t)) for t in parameters]
        return [whole_circle(self.axis, radius) for radius in radii if radius > SHORTEST]


def turned_folds(surface: Any) -> list[Found]:
    """The circles at which a turned surface is widest or narrowest around."""
    curve = Meridian(surface)
    parameters, points = curve.samples()
    return curve.circles(extremes(curve, parameters, [curve.radius(point) for point in points], curve.radius))


def turned_cuts(surface: Any, z: float) -> list[Found]:
    """The circles in which a turned surface passes a height."""
    curve = Meridian(surface)
    parameters, points = curve.samples()
    away = np.array([height(point) - z for point in points])

    def passed(k: int) -> float:
        sign = 1.0 if away[k] < 0 else -1.0
        low, high = ((float(parameters[m]), sign * float(away[m])) for m in (k, k + 1))
        return crossing(lambda t: sign * (height(curve_point(curve, t)) - z), low, high)

    return curve.circles([passed(int(k)) for k in np.flatnonzero((away[:-1] < 0) != (away[1:] < 0))])
