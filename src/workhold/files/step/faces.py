"""The faces of a solid, classified by their position relative to the upward axis.

Glossary
--------
height : z above the solid's lowest point, in mm.
level : a flat face perpendicular to the axis.
upright : a face parallel to the axis everywhere; only such faces can be the outline.
leaning : any other face, such as a chamfer, a fillet along a horizontal edge, a draft, a hole across the
    axis.
layer : a range of heights with no level face inside it. Without a leaning face inside, the section is the
    same at all its heights.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise, product
from math import hypot, tau
from typing import Any, Literal

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import ALIGNED, SAME_HEIGHT
from workhold.files.step.library import compute_bounding_box, list_sub_shapes, occ
from workhold.geometry.subdivision import sort_distinct

__all__ = [
    "SLOPING",
    "HeightRange",
    "SolidFace",
    "is_level",
    "is_parallel_to_z",
    "make_layers",
    "classify_lie",
    "compute_plane_height",
    "list_solid_faces",
    "find_surface",
    "sample_surface_points",
]

# Points along an edge, and along each direction of a curved face, by which a departure is measured.
EDGE_POINTS, GRID_POINTS = 17, 15

# A spline nowhere farther from a plane or a quadric, in mm, is one.
AS_QUADRIC = 1e-6
Lie = Literal["level", "upright", "leaning"]
# What a flat face that leans is called.
SLOPING = "sloping plane"


@frozen
class SolidFace:
    """One face of a solid.

    Parameters
    ----------
    shape : Open CASCADE's face.
    lie : "level", "upright" or "leaning" relative to the axis.
    kind : its kind in words, such as ``sloping plane``.
    low, high : its lowest and highest z in mm.
    fold : z of a horizontal curve along which a leaning face is upright and may reach farthest out; None
        without such a curve.
    upward : whether a level face looks up.
    box : (x0, y0, x1, y1) around it, seen from above, in mm.
    is_free : whether the file gives its surface as a spline, an extruded curve or a turned curve, even if it
        is in truth a plane or a quadric. The library computes volumes of solids with such walls only roughly.
    """

    shape: Any
    lie: Lie
    kind: str
    low: float
    high: float
    fold: float | None = None
    upward: bool = False
    box: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    is_free: bool = False


@frozen
class HeightRange:
    """A range of z in mm; ``prismatic`` tells that no leaning face is in it."""

    low: float
    high: float
    prismatic: bool

    @property
    def middle(self) -> float:
        """z in mm halfway between low and high."""
        return (self.low + self.high) / 2


def list_solid_faces(shape: Any) -> list[SolidFace]:
    """Return all faces of a solid whose axis points along z, in the library's order."""
    return [make_solid_face(face) for face in list_sub_shapes(shape, "FACE")]


def make_solid_face(face: Any) -> SolidFace:
    """Return the description of Open CASCADE's face."""
    low, high = compute_bounding_box(face)
    written, surface = occ.BRepAdaptor_Surface(face), find_surface(face)
    lie = classify_lie(surface, 2)
    bottom, top = low[2], high[2]
    if (z := compute_plane_height(surface)) is not None:
        bottom = top = z
    fold = find_fold_height(surface) if lie == "leaning" else None
    upward = False
    if lie == "level":
        turned = face.Orientation() == occ.TopAbs_REVERSED
        upward = (sample_normals(written)[0].Z() > 0) != turned
    return SolidFace(
        face,
        lie,
        describe_face_kind(surface, lie),
        bottom,
        top,
        fold,
        upward,
        (low[0], low[1], high[0], high[1]),
        written.GetType()
        not in (
            occ.GeomAbs_Plane,
            occ.GeomAbs_Cylinder,
            occ.GeomAbs_Cone,
            occ.GeomAbs_Sphere,
            occ.GeomAbs_Torus,
        ),
    )


def find_surface(face: Any) -> Any:
    """Return the surface of a face as the library's adaptor. A spline that is in truth a plane or a quadric
    is converted to that plane or quadric.

    Some programs write every surface as a spline. The parameter ranges of a converted surface may reach
    beyond the face, which does no harm where folds and cuts are looked for.
    """
    surface = occ.BRepAdaptor_Surface(face)
    if surface.GetType() not in (occ.GeomAbs_BSplineSurface, occ.GeomAbs_BezierSurface):
        return surface
    whole = occ.BRep_Tool.Surface_s(face)
    if isinstance(whole, occ.Geom_RectangularTrimmedSurface):
        # The converter fails over a closed surface that the library has cut open at a seam.
        whole = whole.BasisSurface()
    converter = occ.GeomConvert_SurfToAnaSurf(whole)
    found = converter.ConvertToAnalytical(AS_QUADRIC)
    if found is None or converter.Gap() > AS_QUADRIC:
        return surface
    quadric = occ.GeomAdaptor_Surface(found)
    kind = quadric.GetType()
    if kind == occ.GeomAbs_Plane:
        place = quadric.Plane().Position()
        across = measure_span_along(place, place.XDirection(), face)
        return occ.GeomAdaptor_Surface(found, *across, *measure_span_along(place, place.YDirection(), face))
    if kind in (occ.GeomAbs_Cylinder, occ.GeomAbs_Cone):
        place = (quadric.Cylinder() if kind == occ.GeomAbs_Cylinder else quadric.Cone()).Position()
        return occ.GeomAdaptor_Surface(found, 0.0, tau, *measure_span_along(place, place.Direction(), face))
    return quadric


def measure_span_along(place: Any, direction: Any, face: Any) -> tuple[float, float]:
    """Return the least and greatest coordinate in mm of a face's bounding box along ``direction``.

    Coordinates are measured from the location of ``place``, Open CASCADE's position of a surface.
    """
    start = place.Location()
    along = [
        (x - start.X()) * direction.X() + (y - start.Y()) * direction.Y() + (z - start.Z()) * direction.Z()
        for x, y, z in product(*zip(*compute_bounding_box(face), strict=True))
    ]
    return min(along), max(along)


def compute_plane_height(surface: Any) -> float | None:
    """Return the z in mm of a level plane; None for any other surface. Unlike the z of a bounding box, it
    contains no tolerance.
    """
    if surface.GetType() != occ.GeomAbs_Plane or classify_lie(surface, 2) != "level":
        return None
    # The middle of the face, because a plane that is level but for rounding is higher far from it.
    u, v = (surface.FirstUParameter() + surface.LastUParameter()) / 2, surface.FirstVParameter()
    return float(surface.Value(u, (v + surface.LastVParameter()) / 2).Z())


def classify_lie(surface: Any, axis: int) -> Lie:
    """Return "level", "upright" (parallel to the axis everywhere) or "leaning" for a surface.

    ``axis`` is the index of the upward axis: 0 (x), 1 (y) or 2 (z).
    """
    kind = surface.GetType()
    if kind == occ.GeomAbs_Plane:
        inward, across = split_direction(surface.Plane().Axis().Direction(), axis)
        return "level" if across <= ALIGNED else "upright" if inward <= ALIGNED else "leaning"
    if kind == occ.GeomAbs_Cylinder:
        _, across = split_direction(surface.Cylinder().Axis().Direction(), axis)
        return "upright" if across <= ALIGNED else "leaning"
    if kind in (occ.GeomAbs_Cone, occ.GeomAbs_Sphere, occ.GeomAbs_Torus):
        return "leaning"
    slopes = [split_direction(normal, axis) for normal in sample_normals(surface)]
    if not slopes:
        return "leaning"
    inward, across = (max(values) for values in zip(*slopes, strict=True))
    return "level" if across <= ALIGNED else "upright" if inward <= ALIGNED else "leaning"


def split_direction(direction: Any, axis: int) -> tuple[float, float]:
    """Return the lengths of a unit vector's components along an axis (0 to 2) and across it."""
    values = [direction.X(), direction.Y(), direction.Z()]
    inward = values.pop(axis)
    return abs(inward), hypot(*values)


def make_parameter_grid(surface: Any) -> Iterator[tuple[float, float]]:
    """Yield the parameters (u, v) of a grid of ``GRID_POINTS`` by ``GRID_POINTS`` points over a surface."""
    us = np.linspace(surface.FirstUParameter(), surface.LastUParameter(), GRID_POINTS)
    vs = np.linspace(surface.FirstVParameter(), surface.LastVParameter(), GRID_POINTS)
    return product(us.tolist(), vs.tolist())


def sample_normals(surface: Any) -> list[Any]:
    """Return Open CASCADE's unit normals of a surface on a grid, leaving out points without a normal."""
    normals = []
    for u, v in make_parameter_grid(surface):
        point, along_u, along_v = occ.gp_Pnt(), occ.gp_Vec(), occ.gp_Vec()
        surface.D1(u, v, point, along_u, along_v)
        normal = along_u.Crossed(along_v)
        if normal.Magnitude() > 1e-12:
            normals.append(occ.gp_Dir(normal))
    return normals


def describe_face_kind(surface: Any, lie: Lie) -> str:
    """Return a face's kind in words, in the singular and without an article."""
    kind = surface.GetType()
    if kind == occ.GeomAbs_Plane:
        return {"level": "level plane", "upright": "wall", "leaning": SLOPING}[lie]
    if lie == "upright":
        round_wall = kind == occ.GeomAbs_Cylinder
        return (
            f"round wall of radius {surface.Cylinder().Radius():.6g} mm" if round_wall else "free-form wall"
        )
    if kind == occ.GeomAbs_Cylinder:
        along_axis, _ = split_direction(surface.Cylinder().Axis().Direction(), 2)
        lies = "across" if along_axis < 1e-6 else "aslant"
        return f"cylinder of radius {surface.Cylinder().Radius():.6g} mm {lies}"
    names = {occ.GeomAbs_Cone: "cone", occ.GeomAbs_Sphere: "sphere", occ.GeomAbs_Torus: "rounded rim"}
    return names.get(kind, "free-form surface")


def is_parallel_to_z(axis: Any) -> bool:
    """Return whether Open CASCADE's axis is parallel to z."""
    return split_direction(axis.Direction(), 2)[1] <= ALIGNED


def is_level(axis: Any) -> bool:
    """Return whether Open CASCADE's axis is perpendicular to z."""
    return split_direction(axis.Direction(), 2)[0] <= ALIGNED


def find_fold_height(surface: Any) -> float | None:
    """Return the z in mm at which a curved surface stands
    upright all along a horizontal curve; None if there is none.

    It is the equator of a sphere or of a torus with an upright axis, or the level of a lying cylinder's axis.
    """
    kind = surface.GetType()
    if kind == occ.GeomAbs_Sphere:
        return float(surface.Sphere().Location().Z())
    if kind == occ.GeomAbs_Torus and is_parallel_to_z(surface.Torus().Axis()):
        return float(surface.Torus().Location().Z())
    if kind == occ.GeomAbs_Cylinder and is_level(surface.Cylinder().Axis()):
        return float(surface.Cylinder().Location().Z())
    return None


def make_layers(faces: Sequence[SolidFace]) -> list[HeightRange]:
    """Return the ranges of height between neighbouring heights at which level and leaning faces begin or end,
    from the lowest up.

    A leaning face is neither level nor upright; a range without one inside is prismatic.
    """
    leaning = np.array([(face.low, face.high) for face in faces if face.lie == "leaning"]).reshape(-1, 2)
    ends = [z for face in faces if face.lie != "upright" for z in (face.low, face.high)]
    levels = sort_distinct(np.array(ends), SAME_HEIGHT)
    layers = []
    for low, high in pairwise(levels):
        inside = (leaning[:, 0] < high - SAME_HEIGHT) & (leaning[:, 1] > low + SAME_HEIGHT)
        layers.append(HeightRange(low, high, not inside.any()))
    return layers


def sample_surface_points(face: SolidFace) -> NDArray[np.float64]:
    """Return points (N, 2), x and y in mm, along the edges of a face and, for a curved leaning face, all over
    the face.
    """
    points = []
    for edge in list_sub_shapes(face.shape, "EDGE"):
        curve = occ.BRepAdaptor_Curve(edge)
        points += [
            curve.Value(float(t))
            for t in np.linspace(curve.FirstParameter(), curve.LastParameter(), EDGE_POINTS)
        ]
    surface = occ.BRepAdaptor_Surface(face.shape)
    if face.lie == "leaning" and surface.GetType() != occ.GeomAbs_Plane:
        points += [
            surface.Value(u, v)
            for u, v in make_parameter_grid(surface)
            if occ.BRepClass_FaceClassifier(face.shape, occ.gp_Pnt2d(u, v), 1e-7).State() == occ.TopAbs_IN
        ]
    return np.array([(point.X(), point.Y()) for point in points]).reshape(-1, 2)
