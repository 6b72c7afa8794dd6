"""The curves of a solid that can bound its projection along the axis, as lines and arcs in the plane.

A point on the border of a slab's projection lies on an edge, on a fold of a face, or on the cut at either end
of the slab. Extra curves do no harm, because only pieces with material on exactly one side are used. So whole
curves are taken if that is simpler. A curve of the border that is neither line nor arc is refused.

Folds and level cuts of a surface turned about an upright axis are circles, whatever curve is turned.

Glossary
--------
slab : the part of a solid between two heights.
leaning : said of a face that is neither level nor upright.
fold : curve along which a leaning face is upright, so that the curve may bound the face's projection. It is
    the contour generator of computer vision (Cipolla and Giblin, "Visual Motion of Curves and Surfaces",
    2000).
turned surface : a curve turned about an axis, as of a part from the lathe.
ring : a torus; a lying ring has a level axis.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import acos, atan2, cos, hypot, pi, sin, sqrt, tau
from typing import Any

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.conventions import ALIGNED, SAME_HEIGHT, SHORTEST
from workhold.errors import InputError
from workhold.files.step.edge_curves import (
    EdgeCurve,
    Found,
    Point3,
    compute_curve_point,
    find_extremes,
    find_zero_crossing,
    flatten_points,
    get_height,
    make_arc_between_angles,
    make_edge_curve,
)
from workhold.files.step.faces import SLOPING, SolidFace, find_surface, is_level, is_parallel_to_z
from workhold.files.step.library import list_sub_shapes, occ
from workhold.geometry.segment import (
    Arc,
    Line,
    Point,
    Segment,
    make_segment_rows,
    measure_distance_to_segment,
)
from workhold.geometry.subdivision import Inside
from workhold.kernels.base.distance import measure_outline_distances

__all__ = [
    "FLAT",
    "Other",
    "OtherCurveError",
    "PlainCurves",
    "ProjectedCurves",
    "list_bounding_edges",
    "find_folds",
    "has_plain_cuts",
    "list_leaning_faces_between",
    "cut_face_at_height",
    "compute_normal_height",
    "list_projected_curves",
    "refuse_others",
]

# A face's index with points (N, 2) in mm of a curve of its.
Other = tuple[int, NDArray[np.float64]]
# How far beside a curve its two sides are looked at, in mm. All have to show that it is the border, because a
# curve may cross the border near one of its points.
BESIDE = (4e-4, 4e-5, 4e-6)
# mm. Curves that are no farther apart are one; up to the second a cut runs beside a fold.
ONE_CURVE, BESIDE_FOLD = 1e-6, 1e-5
# Of how many points along a curve one is looked at first.
FEW = 10
# Points along the curve that is turned, and along a cut of a lying ring.
SAMPLES, CUT_SAMPLES = 65, 33
# What flat faces are called.
FLAT = ("level plane", "wall", SLOPING)


@frozen
class ProjectedCurves:
    """All curves that can bound the projection of a slab.

    Parameters
    ----------
    segments : lines and arcs.
    cuts : (segment, point) for points at which segments must be cut besides where they cross.
    others : (face index, points (N, 2) in mm) of curves that are neither line nor arc.
    """

    segments: tuple[Segment, ...]
    cuts: tuple[tuple[Segment, Point], ...]
    others: tuple[tuple[int, NDArray[np.float64]], ...]


def list_projected_curves(
    faces: Sequence[SolidFace],
    edges: Sequence[EdgeCurve],
    low: float,
    high: float,
    folds_of: Callable[[int], Sequence[Found]],
) -> ProjectedCurves:
    """Return every curve that can bound the projection along z of the solid between two z in mm.

    ``folds_of`` returns the folds of the face with an index, see :func:`find_folds`; they are the same for
    all heights.
    """
    segments: list[Segment] = []
    cuts: list[tuple[Segment, Point]] = []
    others: list[tuple[int, NDArray[np.float64]]] = []
    for edge in list_bounding_edges(faces, edges, low, high):
        if edge.segment is not None:
            segments.append(edge.segment)
            cuts += [
                (edge.segment, point) for z in (low, high) for point in edge.find_crossings_with_height(z)
            ]
        elif edge.is_other:
            others.append((edge.face, edge.points[:, :2]))
    for index in list_leaning_faces_between(faces, low, high):
        face = faces[index]
        levels = [z for z in (low, high) if face.low - SAME_HEIGHT <= z <= face.high + SAME_HEIGHT]
        for found in (*folds_of(index), *(one for z in levels for one in cut_face_at_height(face, z))):
            if isinstance(found, Line | Arc):
                segments.append(found)
            else:
                others.append((index, found))
    return ProjectedCurves(tuple(segments), tuple(cuts), tuple(others))


def list_bounding_edges(
    faces: Sequence[SolidFace], edges: Sequence[EdgeCurve], low: float, high: float
) -> Iterator[EdgeCurve]:
    """Yield the edges that can bound the projection along z of the solid between two z in mm.

    These are the edges that reach between the heights, and all edges of each upright face that reaches
    between them.
    """
    for edge in edges:
        # A wall that reaches up into the slab stands on edges below it.
        reaches_up = faces[edge.face].lie == "upright" and faces[edge.face].high > low + SAME_HEIGHT
        if (edge.high >= low - SAME_HEIGHT or reaches_up) and edge.low <= high + SAME_HEIGHT:
            yield edge


def list_leaning_faces_between(faces: Sequence[SolidFace], low: float, high: float) -> Iterator[int]:
    """Yield the indices of faces, neither level nor upright,
    whose heights reach into the range between two z in mm.
    """
    for index, face in enumerate(faces):
        if face.lie == "leaning" and face.high >= low - SAME_HEIGHT and face.low <= high + SAME_HEIGHT:
            yield index


def cut_face_at_height(face: SolidFace, z: float) -> list[Found]:
    """Return the curves in which the level plane at z meets
    the surface of a sloping or curved face, seen from above.

    Lines and arcs may go on beyond the face.
    """
    surface = find_surface(face.shape)
    kind = surface.GetType()
    if kind == occ.GeomAbs_Plane:
        return cut_plane_at_height(surface.Plane(), face, z)
    if kind == occ.GeomAbs_Sphere:
        ball = surface.Sphere()
        square = ball.Radius() ** 2 - (z - ball.Location().Z()) ** 2
        return make_circles(ball.Location(), sqrt(max(square, 0.0)))
    if kind == occ.GeomAbs_Cylinder and is_level(surface.Cylinder().Axis()):
        return cut_lying_cylinder(surface, surface.Cylinder(), z)
    if kind == occ.GeomAbs_Cone and is_parallel_to_z(surface.Cone().Axis()):
        half, apex = surface.Cone().SemiAngle(), surface.Cone().Apex()
        return make_circles(apex, abs((z - apex.Z()) * sin(half) / cos(half)))
    if kind == occ.GeomAbs_Torus and is_parallel_to_z(surface.Torus().Axis()):
        ring = surface.Torus()
        square = ring.MinorRadius() ** 2 - (z - ring.Location().Z()) ** 2
        reach = sqrt(max(square, 0.0))
        radii = {ring.MajorRadius() + reach, ring.MajorRadius() - reach} if square >= 0 else ()
        return make_circles(ring.Location(), *radii)
    if kind == occ.GeomAbs_Torus and is_level(surface.Torus().Axis()) and is_open(surface.Torus()):
        return cut_lying_ring(surface, z)
    if kind == occ.GeomAbs_SurfaceOfRevolution and is_parallel_to_z(surface.AxeOfRevolution()):
        return cut_turned_surface(surface, z)
    return cut_edges(face.shape, z)


def has_plain_cuts(face: SolidFace) -> bool:
    """Return whether level planes at all heights cut a sloping or curved face in lines and circles only."""
    surface = find_surface(face.shape)
    kind = surface.GetType()
    upright = {
        occ.GeomAbs_Cone: lambda: surface.Cone().Axis(),
        occ.GeomAbs_Torus: lambda: surface.Torus().Axis(),
        occ.GeomAbs_SurfaceOfRevolution: lambda: surface.AxeOfRevolution(),
    }
    if kind in upright:
        return is_parallel_to_z(upright[kind]())
    if kind == occ.GeomAbs_Cylinder:
        return is_level(surface.Cylinder().Axis())
    return bool(kind in (occ.GeomAbs_Plane, occ.GeomAbs_Sphere))


def cut_plane_at_height(plane: Any, face: SolidFace, z: float) -> list[Found]:
    """Return the line in which a sloping plane meets the level plane at z.

    It is as long as the extent of the face's box in the line's direction, and may lie beside the box; []
    where that extent is 0.
    """
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


def cut_lying_cylinder(surface: Any, cylinder: Any, z: float) -> list[Found]:
    """Return the two straight lines in which a cylinder with a level axis meets the level plane at z.

    One line where the plane touches the cylinder, none where it passes by.
    """
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


def is_open(ring: Any) -> bool:
    """Return whether a torus has a hole, so that its tube does not run through itself."""
    return bool(ring.MajorRadius() > ring.MinorRadius())


def cut_lying_ring(surface: Any, z: float) -> list[Found]:
    """Return the curves in which a torus with a level axis meets the level plane at z, within the range of
    tube angles that the face covers.

    With the axis d, the upward direction e, and b across both, a point of the torus is c + (R + r cos v) (cos
    u b + sin u e) + r sin v d, so at a height h above c it is sin u = h / (R + r cos v). A cut that coincides
    with the fold of the torus is left out. Near the fold a cut is returned as points even if an arc fits it,
    because two such arcs would cross.
    """
    ring = surface.Torus()
    major, minor = ring.MajorRadius(), ring.MinorRadius()
    center, axis = ring.Location(), ring.Axis().Direction()
    up = z - center.Z()
    first, last = surface.FirstVParameter(), surface.LastVParameter()
    # Where the tube no longer reaches the height both curves end in one point.
    share = (abs(up) - major) / minor
    ends = [turn * acos(share) + k * tau for turn in (1, -1) for k in (-1, 0, 1)] if abs(share) <= 1 else []
    v = np.unique([*np.linspace(first, last, CUT_SAMPLES), *(end for end in ends if first < end < last)])
    square = (major + minor * np.cos(v)) ** 2 - up * up
    is_there = square >= -SHORTEST * major
    away, along = np.sqrt(np.maximum(square, 0.0)), minor * np.sin(v)
    from_fold = major + minor * np.cos(v) - away
    found: list[Found] = []
    for across in (away, -away):
        x = center.X() + along * axis.X() - across * axis.Y()
        y = center.Y() + along * axis.Y() + across * axis.X()
        runs = np.split(np.arange(len(v)), np.flatnonzero(np.diff(is_there)) + 1)
        for run in (run for run in runs if len(run) > 2 and is_there[run[0]]):
            points = np.column_stack([x[run], y[run]])
            off = float(from_fold[run].max())
            segment = flatten_points(points) if off > BESIDE_FOLD else None
            if segment is not None or (off > ONE_CURVE and np.ptp(points, axis=0).max() > SHORTEST):
                found.append(points if segment is None else segment)
    return found


def cut_edges(shape: Any, z: float) -> list[Found]:
    """Return the curves in which the level plane at z
    cuts a face of any surface, computed by Open CASCADE.
    """
    cut = occ.BRepAlgoAPI_Section(shape, occ.gp_Pln(occ.gp_Pnt(0.0, 0.0, z), occ.gp_Dir(0.0, 0.0, 1.0)))
    found: list[Found] = []
    for edge in list_sub_shapes(cut.Shape(), "EDGE"):
        curve = make_edge_curve(0, occ.BRepAdaptor_Curve(edge))
        if curve.segment is not None:
            found.append(curve.segment)
        elif curve.is_other:
            found.append(curve.points[:, :2])
    return found


def find_folds(face: SolidFace) -> list[Found]:
    """Return the curves on a curved face along which its normal is level, seen from above.

    The curves may extend beyond the face.
    """
    surface = find_surface(face.shape)
    kind = surface.GetType()
    if kind == occ.GeomAbs_Plane:
        return []
    if kind == occ.GeomAbs_Sphere:
        return make_circles(surface.Sphere().Location(), surface.Sphere().Radius())
    if kind in (occ.GeomAbs_Cylinder, occ.GeomAbs_Cone):
        return list(find_ruled_folds(surface, kind == occ.GeomAbs_Cylinder))
    if kind == occ.GeomAbs_Torus:
        ring = surface.Torus()
        if is_parallel_to_z(ring.Axis()):
            major, minor = ring.MajorRadius(), ring.MinorRadius()
            return make_circles(ring.Location(), major + minor, major - minor)
        if is_level(ring.Axis()):
            return find_lying_ring_folds(surface)
    if kind == occ.GeomAbs_SurfaceOfRevolution and is_parallel_to_z(surface.AxeOfRevolution()):
        return find_folds_of_turned_surface(surface)
    return find_free_form_folds(surface)


def find_lying_ring_folds(surface: Any) -> list[Found]:
    """Return the curves along which a torus with a level axis stands upright, seen from above.

    They are limited to the range of tube angles that the face covers. With the axis d and the radial
    direction r(u), the normal at the angle v of the tube is cos v r(u) + sin v d. It is level at cos v = 0, a
    line, and where r is level: at b and -b, across the axis, an arc. An arc beyond the face's angles would
    run beside the arc of the neighbouring face.
    """
    ring = surface.Torus()
    center, axis = ring.Location(), ring.Axis().Direction()
    x, y, major, minor = center.X(), center.Y(), ring.MajorRadius(), ring.MinorRadius()
    dx, dy = axis.X(), axis.Y()
    first, last = surface.FirstVParameter(), surface.LastVParameter()
    found: list[Found] = []
    for side in (-1.0, 1.0):
        across = atan2(side * dx, -side * dy)
        low, high = sorted((-side * first, -side * last))
        arc = make_arc_between_angles((x - side * major * dy, y + side * major * dx), minor, low, high)
        found.append(evolve(arc, mid_angle=arc.mid_angle + across))
        px, py = x + side * minor * dx, y + side * minor * dy
        turns = (side * pi / 2 + k * tau for k in (-1, 0, 1))
        if any(first - ALIGNED <= v <= last + ALIGNED for v in turns):
            found.append(Line((px + major * dy, py - major * dx), (px - major * dy, py + major * dx)))
    return found


def find_ruled_folds(surface: Any, is_cylinder: bool) -> Iterator[Line]:
    """Yield the straight lines on a cylinder or a cone along which the normal is level, seen from above.

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


def find_free_form_folds(surface: Any, steps: int = 25) -> list[Found]:
    """Return points (N, 2) of a surface at which its normal
    is level, as one array in a list; [] where there are none.

    They are found between neighbours of a grid of ``steps`` by ``steps`` parameters, by bisection, and are
    ordered by grid line, not along the folds.
    """
    us = np.linspace(surface.FirstUParameter(), surface.LastUParameter(), steps)
    vs = np.linspace(surface.FirstVParameter(), surface.LastVParameter(), steps)
    values = np.array([[compute_normal_height(surface, u, v) for v in vs] for u in us])
    points = []
    for i, j in zip(*np.nonzero(values[:, :-1] * values[:, 1:] < 0), strict=True):
        a, b = vs[j], vs[j + 1]
        below = values[i, j] < 0
        for _ in range(40):
            middle = (a + b) / 2
            a, b = (
                (middle, b) if (compute_normal_height(surface, us[i], middle) < 0) == below else (a, middle)
            )
        point = surface.Value(float(us[i]), float(a))
        points.append((point.X(), point.Y()))
    return [np.array(points)] if points else []


def compute_normal_height(surface: Any, u: float, v: float) -> float:
    """Return the z component of a surface's normal at its
    parameters u and v; the normal is not a unit vector.
    """
    point, along_u, along_v = occ.gp_Pnt(), occ.gp_Vec(), occ.gp_Vec()
    surface.D1(float(u), float(v), point, along_u, along_v)
    return float(along_u.X() * along_v.Y() - along_u.Y() * along_v.X())


def make_circles(center: Any, *radii: float) -> list[Found]:
    """Return the full circles about Open CASCADE's point,
    seen from above, one for each radius above ``SHORTEST``.
    """
    return [Arc((center.X(), center.Y()), radius, 0.0, pi, 1.0) for radius in radii if radius > SHORTEST]


@frozen
class Meridian:
    """The curve that a surface turns about an upright axis, with the interface of a library's curve.

    Parameters
    ----------
    surface : Open CASCADE's surface of revolution.
    """

    surface: Any

    def Value(self, parameter: float) -> Any:
        """Return Open CASCADE's point of the curve at a parameter."""
        return self.surface.Value(self.surface.FirstUParameter(), parameter)

    @property
    def axis(self) -> Any:
        """Open CASCADE's point on the axis."""
        return self.surface.AxeOfRevolution().Location()

    def measure_radius(self, point: Point3) -> float:
        """Return the distance in mm of a point from the axis."""
        return hypot(point[0] - self.axis.X(), point[1] - self.axis.Y())

    def sample_points(self) -> tuple[NDArray[np.float64], list[Point3]]:
        """Return ``SAMPLES`` evenly spaced parameters (N,)
        from end to end, and the points (x, y, z) there in mm.
        """
        parameters = np.linspace(self.surface.FirstVParameter(), self.surface.LastVParameter(), SAMPLES)
        return parameters, [compute_curve_point(self, float(t)) for t in parameters]

    def make_circles(self, parameters: Sequence[float]) -> list[Found]:
        """Return the circles, seen from above, that the points at some parameters of the curve run along."""
        return make_circles(
            self.axis, *(self.measure_radius(compute_curve_point(self, t)) for t in parameters)
        )


def find_folds_of_turned_surface(surface: Any) -> list[Found]:
    """Return the circles at which the radius of a turned surface has a local maximum or minimum."""
    curve = Meridian(surface)
    parameters, points = curve.sample_points()
    return curve.make_circles(
        find_extremes(
            curve, parameters, [curve.measure_radius(point) for point in points], curve.measure_radius
        )
    )


def cut_turned_surface(surface: Any, z: float) -> list[Found]:
    """Return the circles in which a turned surface with an upright axis meets the level plane at z."""
    curve = Meridian(surface)
    parameters, points = curve.sample_points()
    away = np.array([get_height(point) - z for point in points])

    def find_crossing(k: int) -> float:
        """Return the parameter at which the curve crosses z between the samples k and k + 1."""
        sign = 1.0 if away[k] < 0 else -1.0
        low, high = ((float(parameters[m]), sign * float(away[m])) for m in (k, k + 1))
        return find_zero_crossing(lambda t: sign * (get_height(compute_curve_point(curve, t)) - z), low, high)

    return curve.make_circles(
        [find_crossing(int(k)) for k in np.flatnonzero((away[:-1] < 0) != (away[1:] < 0))]
    )


class OtherCurveError(InputError):
    """The refusal of an outline because a face's border in it is neither line nor arc.

    Parameters
    ----------
    face : the face that makes the curve.
    """

    def __init__(self, face: SolidFace) -> None:
        super().__init__(
            f"the outline has a curve that is neither line nor arc: a {face.kind} at heights "
            f"{max(round(face.low, 6), 0.0) + 0.0:.6g} to {face.high:.6g} mm"
        )
        self.face = face


@frozen(eq=False)
class PlainCurves:
    """Lines and arcs that may be the border of an outline.

    Parameters
    ----------
    segments : may contain duplicates.
    rows : (N, 10) of the segments for the kernels.
    """

    segments: Sequence[Segment]
    rows: NDArray[np.float64]

    @classmethod
    def from_segments(cls, segments: Sequence[Segment]) -> PlainCurves:
        """Make the curves with their kernel rows; there may be no segments."""
        return cls(segments, make_segment_rows(segments) if segments else np.zeros((0, 10)))

    def are_all_on_border(self, places: NDArray[np.float64], inside: Inside) -> bool:
        """Return whether all places (N, 2) of another curve are so near to these lines and arcs that the
        border is these, not the other curve.

        This happens where a torus or a sphere is cut just beside its widest place: the cut is then too near
        to the line or arc there for points in between to be tested. A place farther than ``ONE_CURVE`` from
        every line or arc passes only if the point halfway between is inside the region.

        Parameters
        ----------
        inside : returns which of some points (x, y) belong to the outline's region.
        """
        if len(self.rows) == 0 or measure_outline_distances(places, self.rows).max() > BESIDE[-1]:
            return False
        middles = []
        for x, y in places.tolist():
            own = min(self.segments, key=lambda one: measure_distance_to_segment((x, y), one))
            fx, fy = own.compute_point(own.find_parameter((x, y)))
            if hypot(fx - x, fy - y) > ONE_CURVE:
                middles.append(((x + fx) / 2, (y + fy) / 2))
        return not middles or all(inside(middles))


def refuse_others(
    others: Sequence[Other], faces: Sequence[SolidFace], inside: Inside, plain: PlainCurves | None = None
) -> None:
    """Raise OtherCurveError for a curve that is neither line nor arc and has material on exactly one side.

    Such a curve is part of the border. The points farthest out are tested first: there it is most likely
    found.

    Parameters
    ----------
    others : (face index, points (N, 2)) of such curves.
    inside : returns which of some points (x, y) belong to the outline's region.
    plain : lines and arcs that may be the border instead of a curve that runs along them.
    """
    if not others:
        return
    every = np.concatenate([points for _, points in others])
    middle = (every.min(axis=0) + every.max(axis=0)) / 2

    def place(one: Other) -> tuple[bool, float]:
        """Return a sort key that puts curves of curved faces first, and among these the curves that reach
        farthest out.
        """
        # The face that makes the curve rather than the flat one that it cuts.
        return faces[one[0]].kind in FLAT, -float(np.hypot(*(one[1] - middle).T).max())

    # Two faces have an edge, and it is asked once.
    ordered: dict[bytes, Other] = {}
    for one in sorted(others, key=place):
        ordered.setdefault(one[1].tobytes(), one)
    # A curve of the border is there along much of it: few points of every curve find it before all are asked.
    for each in (FEW, 1):
        for index, points in ordered.values():
            away = np.hypot(*(points[1:-1] - middle).T)
            found = find_border_places(points, np.argsort(-away, kind="stable")[::each] + 1, inside)
            if len(found) and not (plain is not None and plain.are_all_on_border(found, inside)):
                raise OtherCurveError(faces[index])


def find_border_places(
    points: NDArray[np.float64], looked: NDArray[np.intp], inside: Inside
) -> NDArray[np.float64]:
    """Return those points (N, 2) of a curve that have the region on exactly one side.

    Parameters
    ----------
    points : (N, 2) along the curve, in mm.
    looked : indices of the points to test; the first and the last point must not be among them.
    inside : returns which of some points (x, y) belong to the region.
    """
    steps = points[looked + 1] - points[looked - 1]
    sizes = np.hypot(*steps.T)
    wide = sizes >= 10 * BESIDE[0]
    places: NDArray[np.float64] = points[looked[wide]]
    across = steps[wide][:, ::-1] * (-1.0, 1.0) / sizes[wide][:, None]
    for beside in BESIDE:
        both = np.concatenate([places + beside * across, places - beside * across])
        found = np.array(inside([(x, y) for x, y in both.tolist()]), dtype=bool)
        is_border = found[: len(places)] != found[len(places) :]
        places, across = places[is_border], across[is_border]
        if not len(places):
            break
    return places
