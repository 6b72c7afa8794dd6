"""The edges of a solid seen from above: the line or arc that each projects to, its heights, and its
crossings.

Each point of a curve is a call of the library. So a bracket of a zero of a function along the curve is
narrowed by false position first, and bisection then evaluates the function only within the narrower bracket.

Reference: M. Dowell and P. Jarratt, *A modified regula falsi method for computing the root of an equation*,
BIT 11 (1971).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import count
from math import atan2, dist, hypot, pi, sqrt
from typing import Any

import numpy as np
from attrs import evolve, field, frozen
from numpy.typing import NDArray

from workhold.conventions import ALIGNED, DISGUISE, SHORTEST
from workhold.files.step.faces import SolidFace, find_surface
from workhold.files.step.library import list_sub_shapes, occ
from workhold.geometry.segment import Arc, Line, Point, Segment

__all__ = [
    "EdgeCurve",
    "Found",
    "ONE_HEIGHT",
    "Point3",
    "make_arc_between_angles",
    "bisect_condition",
    "find_zero_crossing",
    "make_edge_curve",
    "compute_curve_point",
    "list_edge_curves",
    "find_extremes",
    "flatten_points",
    "get_height",
]

# Points along a curve that is neither a line nor an arc in the plane, at which its two sides are looked at.
SAMPLES = 33
# Heights that differ by less in mm are one.
ONE_HEIGHT = 1e-9
# mm. An edge nearer to its wall is on it as it is. Radians. Arcs that lack less are circles. mm. A straight edge
# off its wall by no more runs along it.
EXACT_ON, WHOLE_TURN, ROUNDED = 1e-7, 1e-9, 1e-11
GOLDEN = (sqrt(5.0) - 1.0) / 2.0
Point3 = tuple[float, float, float]
# What a curve is seen from above: a line or an arc, or points (N, 2) of any other curve.
Found = Segment | NDArray[np.float64]
Function = Callable[[float], float]
# A place with the value there.
Known = tuple[float, float]
# Steps of false position, at most, and of those that move the same end before the bracket is halved; half the
# width of the last bracket, as a share of the first.
STEPS, MOST_RUN, NARROW = 16, 3, 1e-12
# Steps of the bisection after it.
BISECTIONS = 60


@frozen
class EdgeCurve:
    """An edge of a face, seen from above.

    Parameters
    ----------
    face : index of the face.
    segment : the line or arc that it projects to; None for an upright edge and for any other curve.
    parameters : (N,) parameters of Open CASCADE's curve, rising; between two of them the position along the
        segment and the height are both monotonic.
    points : (N, 3) the points there in mm.
    is_other : whether it projects to a curve that is neither line nor arc.
    curve : Open CASCADE's curve.
    """

    face: int
    segment: Segment | None
    parameters: NDArray[np.float64]
    points: NDArray[np.float64]
    is_other: bool
    curve: Any
    # What :meth:`find_point_where` found, by its arguments: outlines of all heights ask for the same points.
    known: dict[tuple[int, float, bool], Point3] = field(init=False, factory=dict, eq=False, repr=False)

    @property
    def low(self) -> float:
        """Lowest z of its points in mm."""
        return float(self.points[:, 2].min())

    @property
    def high(self) -> float:
        """Highest z of its points in mm."""
        return float(self.points[:, 2].max())

    def find_point_where(self, k: int, value: Callable[[Point3], float], wanted: float) -> Point3:
        """Return the point (x, y, z) between the points k and
        k + 1 at which a function equals ``wanted``; cached.

        Parameters
        ----------
        value : the height, or the position along the edge's own segment; monotonic between the two points.
        """
        key = k, wanted, value is get_height
        if key not in self.known:
            self.known[key] = self.search_point_where(k, value, wanted)
        return self.known[key]

    def search_point_where(self, k: int, value: Callable[[Point3], float], wanted: float) -> Point3:
        """Return what :meth:`find_point_where` returns, without the cache."""
        a, b = float(self.parameters[k]), float(self.parameters[k + 1])
        first, last = value(make_point3(self.points[k])), value(make_point3(self.points[k + 1]))
        if len(self.points) == 2:
            share = (wanted - first) / (last - first)
            return make_point3(self.points[0] + share * (self.points[1] - self.points[0]))
        sign = 1.0 if first < wanted else -1.0
        return compute_curve_point(
            self.curve,
            find_zero_crossing(
                lambda t: sign * (value(compute_curve_point(self.curve, t)) - wanted),
                (a, sign * (first - wanted)),
                (b, sign * (last - wanted)),
            ),
        )

    def find_crossings_with_height(self, z: float) -> list[Point]:
        """Return the points (x, y) at which the edge crosses the height ``z``; its ends, and points where it
        only touches, are left out.
        """
        heights = self.points[:, 2] - z
        passes = np.flatnonzero(heights[:-1] * heights[1:] < 0)
        at_points = 1 + np.flatnonzero((heights[1:-1] == 0.0) & (heights[:-2] * heights[2:] < 0))
        return [
            *(self.find_point_where(int(k), get_height, z)[:2] for k in passes),
            *(make_point3(self.points[k])[:2] for k in at_points),
        ]


def list_edge_curves(faces: Sequence[SolidFace]) -> list[EdgeCurve]:
    """Return the edges of all faces, in the order of the faces. An edge
    between two faces comes twice, once for each face.

    Both entries share one curve and its points; ``face`` is the index in ``faces``. Degenerate edges, and
    edges inside a face that bound nothing, are left out.
    """
    # Edges that are the same whichever way a face runs them, by hash: the library's own map of shapes has
    # another name in every version.
    known: dict[int, list[tuple[Any, int]]] = {}
    fresh = count()

    def number_of(edge: Any) -> int:
        """Return a number that identifies an edge, the same for both directions of the edge."""
        same = known.setdefault(hash(edge), [])
        for other, number in same:
            if other.IsSame(edge):
                return number
        same.append((edge, next(fresh)))
        return same[-1][1]

    # Where another body touched a face from within the library leaves an edge on it that bounds nothing.
    borders = occ.TopAbs_FORWARD, occ.TopAbs_REVERSED
    edges = [
        (index, edge, number_of(edge))
        for index, face in enumerate(faces)
        for edge in list_sub_shapes(face.shape, "EDGE")
        if not occ.BRep_Tool.Degenerated_s(edge) and edge.Orientation() in borders
    ]
    carriers = {index: find_wall_carrier(face) for index, face in enumerate(faces) if face.lie == "upright"}
    walls = {number: carriers[index] for index, _, number in edges if carriers.get(index) is not None}
    # Two faces have an edge, and it is the same curve for both.
    curves: dict[int, EdgeCurve] = {}
    for index, edge, number in edges:
        if number not in curves:
            curves[number] = put_edge_on_wall(
                make_edge_curve(index, occ.BRepAdaptor_Curve(edge)), walls.get(number)
            )
    return [evolve(curves[number], face=index) for index, _, number in edges]


def find_wall_carrier(face: SolidFace) -> Segment | None:
    """Return a segment of the line or circle over which an upright face stands; None for a free-form face."""
    surface = find_surface(face.shape)
    if surface.GetType() == occ.GeomAbs_Plane:
        place, normal = surface.Plane().Location(), surface.Plane().Axis().Direction()
        return Line((place.X(), place.Y()), (place.X() - normal.Y(), place.Y() + normal.X()))
    if surface.GetType() == occ.GeomAbs_Cylinder:
        place = surface.Cylinder().Location()
        return Arc((place.X(), place.Y()), surface.Cylinder().Radius(), 0.0, pi, 1.0)
    return None


def put_edge_on_wall(edge: EdgeCurve, carrier: Segment | None) -> EdgeCurve:
    """Return an edge with its projection replaced by a segment of the wall's line or circle, if the edge lies
    nearly on that line or circle.

    Edges farther than ``DISGUISE`` from the line or circle are returned unchanged. Where a leaning face meets
    a wall, programs write a spline off by up to 0.001 mm. And the circle that best fits a short arc is not
    the wall's within rounding, so that edges of one wall would lie on different circles.

    Parameters
    ----------
    carrier : the wall's segment from :func:`find_wall_carrier`; None for an edge of no wall.
    """
    if carrier is None or (edge.segment is None and not edge.is_other):
        return edge
    x, y = edge.points[:, 0], edge.points[:, 1]
    if isinstance(carrier, Line):
        (px, py), (tx, ty) = carrier.start, carrier.tangent
        along, off = (x - px) * tx + (y - py) * ty, (x - px) * ty - (y - py) * tx
    else:
        cx, cy = carrier.center
        along, off = np.unwrap(np.arctan2(y - cy, x - cx)), np.hypot(x - cx, y - cy) - carrier.radius
    most = float(np.abs(off).max())
    if most > DISGUISE or (most <= EXACT_ON and is_on_wall_curve(edge.segment, carrier, most)):
        return edge
    low, high = float(along.min()), float(along.max())
    if isinstance(carrier, Line):
        segment: Segment = Line((px + low * tx, py + low * ty), (px + high * tx, py + high * ty))
    else:
        segment = make_arc_between_angles(carrier.center, carrier.radius, low, high)
    if segment.length < SHORTEST:
        return evolve(edge, segment=None, is_other=False)
    if most <= EXACT_ON and edge.segment is not None:
        return evolve(edge, segment=segment)
    values = [(make_position_function(segment), along.tolist()), (get_height, edge.points[:, 2].tolist())]
    more = [
        one for value, known in values for one in find_extremes(edge.curve, edge.parameters, known, value)
    ]
    parameters = np.unique(np.concatenate([edge.parameters, more]))
    points = compute_points_along(edge.curve, parameters)
    return evolve(edge, segment=segment, is_other=False, parameters=parameters, points=points)


def is_on_wall_curve(segment: Segment | None, carrier: Segment, off: float) -> bool:
    """Return whether a segment has the same line or circle as a wall within rounding.

    ``carrier`` is a segment of the wall's line or circle; ``off`` is the distance in mm of the edge from that
    line or circle.
    """
    if isinstance(segment, Arc) and isinstance(carrier, Arc):
        away = max(dist(segment.center, carrier.center), abs(segment.radius - carrier.radius))
        return away <= ONE_HEIGHT
    return isinstance(segment, Line) and off <= ROUNDED


def make_edge_curve(face: int, curve: Any) -> EdgeCurve:
    """Return the :class:`EdgeCurve` of an edge from Open CASCADE's curve of it, for the face with index
    ``face``.
    """
    first, last = curve.FirstParameter(), curve.LastParameter()
    kind = curve.GetType()
    if kind == occ.GeomAbs_Line:
        parameters = np.array([first, last])
        points = compute_points_along(curve, parameters)
        (x0, y0, _), (x1, y1, _) = points.tolist()
        line = Line((x0, y0), (x1, y1)) if hypot(x1 - x0, y1 - y0) >= SHORTEST else None
        return EdgeCurve(face, line, parameters, points, False, curve)
    parameters = np.linspace(first, last, SAMPLES)
    points = compute_points_along(curve, parameters)
    if kind == occ.GeomAbs_Circle:
        circle = curve.Circle()
        normal = circle.Axis().Direction()
        if hypot(normal.X(), normal.Y()) <= ALIGNED:
            arc = make_level_arc(circle, first, last, points)
            return EdgeCurve(face, arc, parameters, points, False, curve)
    segment = flatten_points(points[:, :2])
    if segment is None:
        # An upright edge is a single point.
        is_wide = bool(np.ptp(points[:, :2], axis=0).max() > SHORTEST)
        return EdgeCurve(face, None, parameters, points, is_wide, curve)
    more = [
        one
        for value in (make_position_function(segment), get_height)
        for one in find_extremes(curve, parameters, [value(make_point3(point)) for point in points], value)
    ]
    if more:
        parameters = np.unique(np.concatenate([parameters, more]))
        points = compute_points_along(curve, parameters)
        segment = flatten_points(points[:, :2]) or segment
    return EdgeCurve(face, segment, parameters, points, False, curve)


def get_height(point: Point3) -> float:
    """Return the z of a point."""
    return point[2]


def make_position_function(segment: Segment) -> Callable[[Point3], float]:
    """Return a function that gives the position along a segment
    (mm or radians) of a point (x, y, z) seen from above.
    """
    return lambda point: segment.find_parameter((point[0], point[1]))


def find_extremes(
    curve: Any,
    parameters: NDArray[np.float64],
    values: Sequence[float],
    value: Callable[[Point3], float],
) -> list[float]:
    """Return the parameters of the local maxima and minima
    of a function along a curve, by golden section search.

    Parameters
    ----------
    parameters : (N,) rising; an extreme is looked for around each at which the values change direction.
    values : N values of the function there.
    value : the function, of a point (x, y, z).
    """
    found = []
    rises = np.diff(np.array(values))
    for k in np.flatnonzero(rises[:-1] * rises[1:] < 0):
        sign = 1.0 if rises[k] > 0 else -1.0
        a, b = float(parameters[k]), float(parameters[k + 2])
        for _ in range(60):
            c, d = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
            if sign * value(compute_curve_point(curve, c)) > sign * value(compute_curve_point(curve, d)):
                b = d
            else:
                a = c
        found.append((a + b) / 2)
    return found


def compute_curve_point(curve: Any, parameter: float) -> Point3:
    """Return the point (x, y, z) in mm of Open CASCADE's curve at a parameter."""
    value = curve.Value(parameter)
    return value.X(), value.Y(), value.Z()


def make_point3(row: NDArray[np.float64]) -> Point3:
    """Return a row of an array (N, 3) as a tuple of floats."""
    return float(row[0]), float(row[1]), float(row[2])


def compute_points_along(curve: Any, parameters: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the points (N, 3) in mm of Open CASCADE's curve at N parameters."""
    return np.array([compute_curve_point(curve, float(t)) for t in parameters])


def make_arc_between_angles(center: Point, radius: float, low: float, high: float) -> Arc:
    """Return the counter-clockwise arc between two angles in
    radians, low < high; a full circle within rounding of a turn.
    """
    half = (high - low) / 2
    return Arc(center, radius, (low + high) / 2, pi if half > pi - WHOLE_TURN else half, 1.0)


def make_level_arc(circle: Any, first: float, last: float, points: NDArray[np.float64]) -> Arc:
    """Return the arc that a level circle of Open CASCADE has between two parameters, seen from above.

    ``points`` (N, 3) lie along the arc at equal steps; the middle one fixes the arc's middle angle.
    """
    center = circle.Location()
    x, y, _ = points[len(points) // 2]
    middle, half = atan2(y - center.Y(), x - center.X()), (last - first) / 2
    arc = make_arc_between_angles((center.X(), center.Y()), circle.Radius(), -half, half)
    return evolve(arc, mid_angle=middle)


def flatten_points(points: NDArray[np.float64]) -> Segment | None:
    """Return the line or the counter-clockwise arc on which
    points (N, 2) in running order lie, within 1e-7 mm.

    None where they lie on neither, all in one place, or on an arc of a radius above 1e5 mm.
    """
    middle = points.mean(axis=0)
    _, sizes, axes = np.linalg.svd(points - middle, full_matrices=False)
    if sizes[1] <= 1e-7 * sqrt(len(points)):
        along = (points - middle) @ axes[0]
        start, end = middle + along.min() * axes[0], middle + along.max() * axes[0]
        if hypot(*(end - start)) < SHORTEST:
            return None
        return Line((float(start[0]), float(start[1])), (float(end[0]), float(end[1])))
    matrix = np.column_stack([2 * points, np.ones(len(points))])
    solution = np.linalg.lstsq(matrix, (points**2).sum(axis=1), rcond=None)[0]
    center = solution[:2]
    radii = np.hypot(*(points - center).T)
    radius = float(radii.mean())
    if np.abs(radii - radius).max() > 1e-7 or radius > 1e5:
        return None
    angles = np.unwrap(np.arctan2(points[:, 1] - center[1], points[:, 0] - center[0]))
    return make_arc_between_angles(
        (float(center[0]), float(center[1])), radius, float(angles.min()), float(angles.max())
    )


def find_zero_crossing(value: Function, low: Known, high: Known) -> float:
    """Return the argument at which a function changes from below 0 to 0 or more.

    ``low`` is (argument, value) at the end where the value is below 0, ``high`` at the end where it is not.
    The argument of ``low`` may be greater than that of ``high``.
    """
    a, b = low[0], high[0]
    first, last = narrow_zero_crossing(value, low, high)
    return sum(bisect_condition(a, b, lambda t: value(t) >= 0.0, (first, last), BISECTIONS)) / 2


def bisect_condition(
    low: float, high: float, holds: Callable[[float], bool], known: tuple[float, float], steps: int
) -> tuple[float, float]:
    """Return the last interval (low, high) of a bisection for the place at which a condition begins to hold.

    The condition does not hold at ``low`` and holds at ``high``; ``low`` may be the greater number.

    Parameters
    ----------
    known : two places between ``low`` and ``high``. The condition does not hold from ``low`` to the first
        place, and it holds from the second place to ``high``. So it is evaluated only between these places.
    steps : most halvings.
    """
    turn = 1.0 if high >= low else -1.0
    before, after = turn * known[0], turn * known[1]
    for _ in range(steps):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        place = turn * middle
        if place >= after:
            high = middle
        elif place <= before or not holds(middle):
            low = middle
        else:
            high = middle
    return low, high


def narrow_zero_crossing(value: Function, low: Known, high: Known) -> tuple[float, float]:
    """Return two near arguments (a, b) with the function below 0 at a and 0 or more at b, by false position.

    ``low`` and ``high`` are as in :func:`find_zero_crossing`. If the value of ``low`` is not below 0, or that
    of ``high`` is below 0, their arguments are returned.
    """
    (a, fa), (b, fb) = low, high
    beside = NARROW * (b - a)
    if not (fa < 0.0 <= fb):
        return a, b
    run = 0
    for _ in range(STEPS):
        if abs(b - a) <= 2 * abs(beside):
            break
        # A step beside the estimate, to the side that lies farther, soon brings in the other end.
        t = b - fb * (b - a) / (fb - fa)
        share = (t - a) / (b - a)
        t += beside if share < 0.5 else -beside
        if abs(run) > MOST_RUN or not 0.0 < (t - a) / (b - a) < 1.0:
            t, run = (a + b) / 2, 0
        found = value(t)
        if found < 0.0:
            a, fa, run = t, found, min(run, 0) - 1
            fb = fb / 2 if run < -1 else fb
        else:
            b, fb, run = t, found, max(run, 0) + 1
            fa = fa / 2 if run > 1 else fa
    return a, b
