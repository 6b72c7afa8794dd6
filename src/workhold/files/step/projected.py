"""The curves of a solid that can bound its projection along the axis, as lines and arcs in the plane.

A point on the border of a slab's projection lies on an edge, on a fold of a face, or on the cut at either end
of the slab. Further curves do no harm, because only pieces with material on one side are taken. So curves are
taken whole where that is simple. A curve of the border that is neither line nor arc is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import acos, atan2, cos, hypot, sin, sqrt
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import ALIGNED, SAME_HEIGHT, SHORTEST
from workhold.errors import InputError
from workhold.files.step.edge_curves import EdgeCurve, Found, curve_of
from workhold.files.step.faces import SLOPING, SolidFace, surface_of
from workhold.files.step.folds import is_upright, turned_cuts, whole_circle
from workhold.files.step.library import occ, sub_shapes
from workhold.geometry.segment import Arc, Line, Point, Segment

__all__ = [
    "FLAT",
    "Other",
    "OtherCurveError",
    "ProjectedCurves",
    "level_cuts",
    "other_curve",
    "projected_curves",
    "refuse_others",
]

# A face's index with points (N, 2) in mm of a curve of its.
Other = tuple[int, NDArray[np.float64]]
# How far beside a curve its two sides are looked at, in mm. All have to show that it is the border, because a
# curve may cross the border near one of its points.
BESIDE = (4e-4, 4e-5, 4e-6)
# Of how many points along a curve one is looked at first.
FEW = 10
# What flat faces are called.
FLAT = ("level plane", "wall", SLOPING)


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
    faces: Sequence[SolidFace],
    edges: Sequence[EdgeCurve],
    low: float,
    high: float,
    folds_of: Callable[[int], Sequence[Found]],
) -> ProjectedCurves:
    """Every curve that can bound the projection of the slab between two z in mm.

    Parameters
    ----------
    folds_of : the folds of the face of a number, see ``files.step.folds``; they are the same for all slabs.
    """
    segments: list[Segment] = []
    cuts: list[tuple[Segment, Point]] = []
    others: list[tuple[int, NDArray[np.float64]]] = []
    for edge in edges:
        # A wall that reaches up into the slab stands on edges below it.
        reaches_up = faces[edge.face].lie == "upright" and faces[edge.face].high > low + SAME_HEIGHT
        if (edge.high < low - SAME_HEIGHT and not reaches_up) or edge.low > high + SAME_HEIGHT:
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
        for found in (*folds_of(index), *(one for z in levels for one in level_cuts(face, z))):
            if isinstance(found, Line | Arc):
                segments.append(found)
            else:
                others.append((index, found))
    return ProjectedCurves(tuple(segments), tuple(cuts), tuple(others))


def level_cuts(face: SolidFace, z: float) -> list[Found]:
    """The curves in which a level plane meets a leaning face's surface, seen from above."""
    surface = surface_of(face.shape)
    kind = surface.GetType()
    if kind == occ.GeomAbs_Plane:
        return plane_cut(surface.Plane(), face, z)
    if kind == occ.GeomAbs_Sphere:
        ball = surface.Sphere()
        square = ball.Radius() ** 2 - (z - ball.Location().Z()) ** 2
        return [whole_circle(ball.Location(), sqrt(square))] if square > SHORTEST**2 else []
    if kind == occ.GeomAbs_Cylinder:
        cylinder = surface.Cylinder()
        axis = cylinder.Axis().Direction()
        if abs(axis.Z()) <= ALIGNED:
            return lying_cut(surface, cylinder, z)
    if kind == occ.GeomAbs_Cone:
        cone = surface.Cone()
        axis = cone.Axis().Direction()
        if hypot(axis.X(), axis.Y()) <= ALIGNED:
            apex = cone.Apex()
            radius = abs((z - apex.Z()) * sin(cone.SemiAngle()) / cos(cone.SemiAngle()))
            return [whole_circle(apex, radius)] if radius > SHORTEST else []
    if kind == occ.GeomAbs_Torus:
        ring = surface.Torus()
        axis = ring.Axis().Direction()
        if hypot(axis.X(), axis.Y()) <= ALIGNED:
            square = ring.MinorRadius() ** 2 - (z - ring.Location().Z()) ** 2
            reach = sqrt(max(square, 0.0))
            radii = {ring.MajorRadius() + reach, ring.MajorRadius() - reach} if square >= 0 else set()
            return [whole_circle(ring.Location(), radius) for radius in radii if radius > SHORTEST]
    if kind == occ.GeomAbs_SurfaceOfRevolution and is_upright(surface.AxeOfRevolution()):
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
    cut = occ.BRepAlgoAPI_Section(shape, occ.gp_Pln(occ.gp_Pnt(0.0, 0.0, z), occ.gp_Dir(0.0, 0.0, 1.0)))
    found: list[Found] = []
    for edge in sub_shapes(cut.Shape(), "EDGE"):
        curve = curve_of(0, occ.BRepAdaptor_Curve(edge))
        if curve.segment is not None:
            found.append(curve.segment)
        elif curve.is_other:
            found.append(curve.points[:, :2])
    return found


class OtherCurveError(InputError):
    """An outline that has a curve which is neither line nor arc."""


def refuse_others(
    others: Sequence[Other], faces: Sequence[SolidFace], inside: Callable[[Point], bool]
) -> None:
    """Refuses a curve that is neither line nor arc where material lies on one side of it only.

    The points farthest out are looked at first: where there is such a curve, it is most likely there.

    Parameters
    ----------
    inside : whether a point (x, y) belongs to the outline's region.

    Raises
    ------
    OtherCurveError
        Naming the face.
    """
    if not others:
        return
    every = np.concatenate([points for _, points in others])
    middle = (every.min(axis=0) + every.max(axis=0)) / 2

    def place(one: Other) -> tuple[bool, float]:
        # The face that makes the curve rather than the flat one that it cuts.
        return faces[one[0]].kind in FLAT, -float(np.hypot(*(one[1] - middle).T).max())

    ordered = sorted(others, key=place)
    # A curve of the border is there along much of it: few points of every curve find it before all are asked.
    for each in (FEW, 1):
        for index, points in ordered:
            away = np.hypot(*(points[1:-1] - middle).T)
            looked = np.argsort(-away, kind="stable")[::each].tolist()
            if any(is_border(points, k + 1, inside) for k in looked):
                raise other_curve(faces[index])


def is_border(points: NDArray[np.float64], k: int, inside: Callable[[Point], bool]) -> bool:
    """Whether a curve has the region on one side only at its point of a number, which is no end of it."""
    dx, dy = points[k + 1] - points[k - 1]
    size = float(np.hypot(dx, dy))
    if size < 10 * BESIDE[0]:
        return False
    x, y = points[k]
    nx, ny = float(-dy / size), float(dx / size)
    return all(
        inside((float(x + beside * nx), float(y + beside * ny)))
        != inside((float(x - beside * nx), float(y - beside * ny)))
        for beside in BESIDE
    )


def other_curve(face: SolidFace) -> OtherCurveError:
    """The refusal of a face whose border in the outline is neither line nor arc."""
    return OtherCurveError(
        f"the outline has a curve that is neither line nor arc: a {face.kind} at heights "
        f"{max(round(face.low, 6), 0):.6g} to {face.high:.6g} mm"
    )
