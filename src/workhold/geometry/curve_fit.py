"""Lines and arcs in place of curves: exact ones for curves that are lines or arcs in disguise, biarcs for
others.

Glossary
--------
disguise : a curve that is within rounding of a line or an arc, or the cubic with which programs write an arc.
break : a place of a curve where its direction or its curvature jumps. The lines and arcs of a disguise end at
    breaks only.
stretch : a part of a curve from one break to the next.
biarc : two arcs that leave two points in given directions and meet in a common one (K. M. Bolton, "Biarc
    curves", Computer-Aided Design 7 (1975) 89-92; D. S. Meek and D. J. Walton, "Approximation of discrete
    data by G1 arc splines", Computer-Aided Design 24 (1992) 301-306).
joint : the point in which the two arcs of a biarc meet.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import atan2, cos, dist, inf, isfinite, pi, sin, sqrt, tan

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.conventions import AS_ARC, CORNER, CURVATURE_JUMP, DISGUISE, SHORTEST
from workhold.geometry.rational import (
    Pieces,
    bound_departure,
    compute_direction,
    compute_end_curvatures,
    compute_end_directions,
    compute_point,
    cut_between_parameters,
    drop_point_pieces,
    sample_points,
)
from workhold.geometry.segment import Arc, Line, Point, make_segment_from_bulge
from workhold.limits import MOST_RADIUS

__all__ = ["FittedCurve", "fit_biarcs", "fit_circle", "find_corners", "fit_curve", "ignore_interrupt"]

# Relative precision to which the longest biarc is found, and the most lengths tried.
STEP, MOST_STEPS = 0.02, 60


@frozen
class FittedCurve:
    """A chain of lines and arcs that replaces a curve or a part of one.

    Parameters
    ----------
    points : the N + 1 ends (x, y) of the chain's N segments in mm; the last equals the first if the curve is
        closed.
    bulges : for each segment its bulge, tan(sweep / 4); 0 for a line.
    departure : upper bound in mm of the distance of any point of the chain from the curve, and of the curve
        from the chain.
    is_disguise : True if the curve itself consisted of lines and arcs within rounding, False if biarcs
        approximate it.
    """

    points: tuple[Point, ...]
    bulges: tuple[float, ...]
    departure: float
    is_disguise: bool = False


def ignore_interrupt() -> None:
    """Do nothing; the default of parameters named ``interrupt``."""


def fit_biarcs(
    pieces: Pieces, tolerance: float, interrupt: Callable[[], None] = ignore_interrupt
) -> list[FittedCurve]:
    """Return biarcs (pairs of tangent arcs) that replace a curve within a tolerance in mm, in order along it.

    Each is as long as possible, and tangent to the curve at both ends, so that corners of the curve stay
    corners. ``interrupt`` is called before each biarc and may raise an error to stop.
    """
    corners = [0, *find_corners(pieces)]
    found: list[FittedCurve] = []
    for first, last in zip(corners, [*corners[1:], len(pieces)], strict=True):
        found += fit_smooth_biarcs(pieces[first:last], tolerance, interrupt)
    return found


def fit_smooth_biarcs(
    pieces: Pieces, tolerance: float, interrupt: Callable[[], None]
) -> Iterator[FittedCurve]:
    """Yield the biarcs that replace a curve without corners within a tolerance in mm, in order along it.

    ``interrupt`` is called before each biarc and may raise an error to stop.
    """
    total = float(len(pieces))
    place, step = 0.0, total
    while place < total:
        interrupt()
        run, reach = fit_longest_biarc(pieces, place, step, tolerance)
        yield run
        step, place = 1.2 * (reach - place), reach


def fit_longest_biarc(
    pieces: Pieces, place: float, step: float, tolerance: float
) -> tuple[FittedCurve, float]:
    """Return (1) the longest biarc that starts at the parameter ``place`` of a smooth curve, (2) the
    parameter of its end.

    ``step`` is the first length to try, in the parameter. If the biarc would be smaller than the tolerance
    (mm), a line may be returned instead.
    """
    total = float(len(pieces))
    room = total - place
    best, low, high = None, 0.0, inf
    step = min(step, room)
    for _ in range(MOST_STEPS):
        reach = total if step == room else place + step
        run = fit_biarc(pieces, place, reach, tolerance) or fit_small_line(pieces, place, reach, tolerance)
        if run is None:
            high = step
        else:
            best, low = run, step
        if best is not None and (low == room or high - low < STEP * high):
            return best, total if low == room else place + low
        step = min(2.0 * step, room) if high == inf else (low + high) / 2
    line = fit_small_line(pieces, place, reach, inf)
    assert line is not None
    return line, reach


def fit_small_line(pieces: Pieces, first: float, last: float, tolerance: float) -> FittedCurve | None:
    """Return the line between the points of a curve at two parameters; None unless that part is smaller than
    the tolerance.

    The size is the diagonal of the control points' bounding box; the tolerance is in mm.
    """
    stretch = cut_between_parameters(pieces, first, last)
    places = (stretch[..., :2] / stretch[..., 2:]).reshape(-1, 2)
    size = float(np.hypot(*np.ptp(places, axis=0)))
    ends = compute_point(pieces, first), compute_point(pieces, last)
    return FittedCurve(ends, (0.0,), size) if size <= tolerance else None


def fit_biarc(pieces: Pieces, first: float, last: float, tolerance: float) -> FittedCurve | None:
    """Return the biarc that replaces a smooth curve between two parameters.

    None where the biarc departs from the curve by more than the tolerance in mm, or an arc turns by more than
    half a circle. Each of the two arcs is compared with its own part of the curve: the curve is divided where
    it crosses the normal at the joint of the arcs.
    """
    start, end = compute_point(pieces, first), compute_point(pieces, last)
    begins, ends = compute_direction(pieces, first, after=True), compute_direction(pieces, last, after=False)
    joint = find_biarc_joint(start, end, begins, ends)
    if joint is None or min(dist(start, joint), dist(joint, end)) < SHORTEST:
        return None
    one, other = (
        measure_turn(begins, subtract_points(joint, start)),
        measure_turn(subtract_points(end, joint), ends),
    )
    if max(abs(one), abs(other)) > pi / 2:
        return None
    c, s = cos(2 * one), sin(2 * one)
    middle = find_crossing(
        pieces, first, last, joint, (c * begins[0] - s * begins[1], s * begins[0] + c * begins[1])
    )
    if middle is None:
        return None
    bulges = tan(one / 2), tan(other / 2)
    away = 0.0
    for low, high, p, q, bulge in (
        (first, middle, start, joint, bulges[0]),
        (middle, last, joint, end, bulges[1]),
    ):
        away = max(
            away,
            bound_departure(
                cut_between_parameters(pieces, low, high), make_segment_from_bulge(p, q, bulge), tolerance
            ),
        )
        if away > tolerance:
            return None
    return FittedCurve((start, joint, end), bulges, away)


def subtract_points(p: Point, q: Point) -> Point:
    """Return the vector p - q."""
    return p[0] - q[0], p[1] - q[1]


def measure_turn(u: Point, v: Point) -> float:
    """Return the angle in radians, in [-pi, pi], from vector u to vector v, positive counter-clockwise."""
    return atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1])


def find_biarc_joint(start: Point, end: Point, begins: Point, ends: Point) -> Point | None:
    """Return the point at which the two arcs of a biarc meet; None where no such biarc exists.

    The biarc runs from ``start`` to ``end``, with the unit tangent ``begins`` at its start and ``ends`` at
    its end. There is a family of such biarcs; the one whose tangents have equal lengths d is taken: |end -
    start - d (begins + ends)| = 2 d.
    """
    vx, vy = subtract_points(end, start)
    tx, ty = begins[0] + ends[0], begins[1] + ends[1]
    along, square = vx * tx + vy * ty, vx * vx + vy * vy
    # 4 - |t|², which is 2 (1 - begins . ends), without cancellation.
    lacking = (begins[0] - ends[0]) ** 2 + (begins[1] - ends[1]) ** 2
    divisor = along + sqrt(along * along + lacking * square)
    if divisor <= 0.0:
        return None
    d = square / divisor
    # The middle of both corners.
    x = (start[0] + d * begins[0]) + (end[0] - d * ends[0])
    y = (start[1] + d * begins[1]) + (end[1] - d * ends[1])
    return x / 2, y / 2


def find_crossing(pieces: Pieces, first: float, last: float, joint: Point, across: Point) -> float | None:
    """Return the parameter between ``first`` and ``last`` at which a curve crosses the line through
    ``joint``.

    The line is perpendicular to the vector ``across``. None unless the curve is behind the line at ``first``
    and ahead of it, in the direction of ``across``, at ``last``. Found by the Illinois method.
    """

    def measure_height(parameter: float) -> float:
        """Return the signed distance of the curve from the line at a parameter."""
        x, y = subtract_points(compute_point(pieces, parameter), joint)
        return x * across[0] + y * across[1]

    low, high = measure_height(first), measure_height(last)
    if not low < 0.0 < high:
        return None
    size, side = high - low, 0
    middle = first
    for _ in range(100):
        middle = (first * high - last * low) / (high - low)
        value = measure_height(middle)
        if abs(value) <= 1e-12 * size or last - first <= 1e-14 * last:
            break
        if value > 0.0:
            last, high = middle, value
            low, side = (low / 2 if side == 1 else low), 1
        else:
            first, low = middle, value
            high, side = (high / 2 if side == -1 else high), -1
    return middle


def find_corners(pieces: Pieces) -> list[int]:
    """Return the indices of the pieces at whose start the curve has a corner (never 0).

    At a corner a piece starts in another direction than the one in which the previous piece ends.
    """
    leaving, entering = compute_end_directions(pieces)
    turned = np.hypot(*(entering[:-1] - leaving[1:]).T) > CORNER
    return [int(k) + 1 for k in np.flatnonzero(turned)]


def fit_curve(
    pieces: Pieces, tolerance: float, interrupt: Callable[[], None] = ignore_interrupt
) -> FittedCurve | None:
    """Return lines and arcs that replace a curve.

    Two cases: (a) the curve consists of lines and arcs within rounding, and these are returned; (b) it does
    not, and biarcs within ``tolerance`` mm replace the other parts.

    Parameters
    ----------
    interrupt : is called before every line or arc, and may raise an error.

    Returns
    -------
    FittedCurve or None
        None for a curve of no length.
    """
    pieces = drop_point_pieces(pieces, SHORTEST)
    if not len(pieces):
        return None
    whole = fit_whole_circle(pieces, DISGUISE)
    if whole is not None:
        return evolve(whole, is_disguise=True)
    runs = find_disguised_runs(pieces, [0, *find_breaks(pieces), len(pieces)], interrupt)
    if all(run is not None for _, _, run in runs):
        return join_fitted_curves([run for _, _, run in runs if run is not None], True)
    whole = fit_whole_circle(pieces, tolerance)
    if whole is not None:
        return whole
    fitted: list[FittedCurve] = []
    for first, last, run in runs:
        fitted += [run] if run is not None else fit_biarcs(pieces[first:last], tolerance, interrupt)
    return join_fitted_curves(fitted, False)


def join_fitted_curves(runs: list[FittedCurve], is_disguise: bool) -> FittedCurve:
    """Return several fitted curves as one; each must start where the one before it ends.

    The departure of the result is the largest of theirs.
    """
    points = [runs[0].points[0]]
    for run in runs:
        points += run.points[1:]
    bulges = tuple(bulge for run in runs for bulge in run.bulges)
    return FittedCurve(tuple(points), bulges, max(run.departure for run in runs), is_disguise)


def find_breaks(pieces: Pieces) -> list[int]:
    """Return the indices of the pieces at whose start the direction or the curvature jumps (never 0)."""
    begin, end = compute_end_curvatures(pieces)
    jump, most = np.abs(begin[1:] - end[:-1]), np.maximum(np.abs(begin[1:]), np.abs(end[:-1]))
    smooth = jump <= CURVATURE_JUMP * most
    corners = set(find_corners(pieces))
    return [k for k in range(1, len(pieces)) if k in corners or not smooth[k - 1]]


def find_disguised_runs(
    pieces: Pieces, places: list[int], interrupt: Callable[[], None]
) -> list[tuple[int, int, FittedCurve | None]]:
    """Return the parts of a curve that are one line or one arc within rounding: (first, end, fitted curve),
    in order.

    ``first`` and ``end`` are the indices of the first piece and of the piece after the last. ``places`` are
    the indices at which parts may start, and finally the number of pieces. Parts are as long as possible. The
    fitted curve is None between two neighbouring ``places`` if the curve there is neither a line nor an arc.
    """
    found: list[tuple[int, int, FittedCurve | None]] = []
    k = 0
    while k < len(places) - 1:
        interrupt()
        run, taken, step, growing = (
            fit_one_segment(pieces[places[k] : places[k + 1]], DISGUISE),
            k + 1,
            1,
            True,
        )
        # Steps that double and then halve find the largest number of stretches in one line or arc.
        while run is not None and step >= 1:
            further = min(taken + step, len(places) - 1)
            longer = (
                None if further == taken else fit_one_segment(pieces[places[k] : places[further]], DISGUISE)
            )
            if longer is None:
                growing, step = False, step // 2
            else:
                run, taken = longer, further
                step = 2 * step if growing else step
        found.append((places[k], places[taken], run))
        k = taken
    return found


def fit_one_segment(pieces: Pieces, tolerance: float) -> FittedCurve | None:
    """Return the line or arc from the start of a curve to its end that is within a tolerance in mm of it.

    None where neither a line nor an arc is.
    """
    start, end = compute_point(pieces, 0.0), compute_point(pieces, float(len(pieces)))
    chord = dist(start, end)
    if chord < SHORTEST:
        return None
    line = Line(start, end)
    away = bound_departure(pieces, line, tolerance)
    if isfinite(away):
        return FittedCurve((start, end), (0.0,), away)
    circle = fit_circle_to_curve(pieces)
    if circle is None:
        return None
    (cx, cy), _ = circle
    # The centre moves onto the axis of the ends.
    tx, ty = line.tangent
    off = (cx - line.middle[0]) * tx + (cy - line.middle[1]) * ty
    cx, cy = cx - off * tx, cy - off * ty
    radius = dist((cx, cy), start)
    sweep = measure_swept_angle(pieces, (cx, cy))
    if not 1e-9 < abs(sweep) < 2 * pi - 1e-3:
        return None
    mid_angle, sign = atan2(start[1] - cy, start[0] - cx) + sweep / 2, 1.0 if sweep > 0 else -1.0
    arc = Arc((cx, cy), radius, mid_angle, abs(sweep) / 2, sign)
    away = bound_departure(pieces, arc, max(tolerance, allow_for_written_arcs(pieces, arc)))
    return FittedCurve(*halve_arc((start, end), sweep, (cx, cy)), away) if isfinite(away) else None


def halve_arc(
    ends: tuple[Point, Point], sweep: float, center: Point
) -> tuple[tuple[Point, ...], tuple[float, ...]]:
    """Return (1) the points and (2) the bulges of an arc between two ``ends``.

    An arc that is nearly a whole circle is given as two halves, since one bulge would fix its centre badly.
    ``sweep`` is in radians, negative clockwise.
    """
    if abs(sweep) < 1.9 * pi:
        return ends, (tan(sweep / 4),)
    (x, y), (cx, cy) = ends[0], center
    c, s = cos(sweep / 2), sin(sweep / 2)
    middle = cx + c * (x - cx) - s * (y - cy), cy + s * (x - cx) + c * (y - cy)
    return (ends[0], middle, ends[1]), (tan(sweep / 8),) * 2


def fit_whole_circle(pieces: Pieces, tolerance: float) -> FittedCurve | None:
    """Return the whole circle, as two halves, that is within a tolerance in mm of a closed curve.

    None where the curve is not closed, or no circle is near enough.
    """
    start = compute_point(pieces, 0.0)
    if dist(start, compute_point(pieces, float(len(pieces)))) > SHORTEST:
        return None
    circle = fit_circle_to_curve(pieces)
    if circle is None:
        return None
    (cx, cy), radius = circle
    sweep = measure_swept_angle(pieces, (cx, cy))
    if abs(abs(sweep) - 2 * pi) > 1e-3:
        return None
    sign = 1.0 if sweep > 0 else -1.0
    angle = atan2(start[1] - cy, start[0] - cx)
    arc = Arc((cx, cy), radius, angle + pi, pi, sign)
    away = bound_departure(pieces, arc, max(tolerance, allow_for_written_arcs(pieces, arc)))
    if not isfinite(away):
        return None
    first, second = ((cx + radius * cos(t), cy + radius * sin(t)) for t in (angle, angle + pi))
    return FittedCurve((first, second, first), (sign, sign), away)


def allow_for_written_arcs(pieces: Pieces, arc: Arc) -> float:
    """Return the tolerance in mm within which cubic curves count as ``arc``; 0 for curves that are not cubic
    polynomials.

    Programs write an arc as a cubic with handles of length 4/3 tan(sweep / 4) radii. For a quarter turn this
    cubic departs from the arc by 2.73e-4 radii; for smaller arcs the departure falls with the sixth power of
    the sweep (M. Goldapp, "Approximation of circular arcs by cubic polynomials", Computer Aided Geometric
    Design 8 (1991) 227-238).
    """
    if pieces.shape[1] != 4 or float(np.ptp(pieces[..., 2])) > 0.0:
        return 0.0
    away = pieces[:, [0, -1], :2] / pieces[:, [0, -1], 2:] - np.array(arc.center)
    angles = np.arctan2(away[..., 1], away[..., 0])
    widest = float(np.abs((angles[:, 1] - angles[:, 0] + pi) % (2 * pi) - pi).max())
    if widest > 0.51 * pi:
        return 0.0
    return AS_ARC * arc.radius * (widest / (pi / 2)) ** 6


def fit_circle_to_curve(pieces: Pieces) -> tuple[Point, float] | None:
    """Return centre and radius in mm of the least-squares circle through points of a curve; None where it is
    straight.
    """
    each = 4 if pieces.shape[1] != 4 else 1 if len(pieces) > 2 else 2
    return fit_circle(sample_points(pieces, each))


def fit_circle(points: NDArray[np.float64]) -> tuple[Point, float] | None:
    """Return centre and radius of the least-squares circle through points (N, 2); None where these lie on a
    line or in a point.

    The method is that of Kasa (1976).
    """
    middle = points.mean(axis=0)
    x, y = (points - middle).T
    size = float(np.hypot(x, y).max())
    if size < SHORTEST:
        return None
    x, y = x / size, y / size
    (a, b, c), *_ = np.linalg.lstsq(np.column_stack([x, y, np.ones(len(x))]), x * x + y * y, rcond=None)
    radius = sqrt(max(c + (a * a + b * b) / 4, 0.0)) * size
    center = float(middle[0] + a / 2 * size), float(middle[1] + b / 2 * size)
    return (center, radius) if isfinite(radius) and 0 < radius < MOST_RADIUS else None


def measure_swept_angle(pieces: Pieces, center: Point) -> float:
    """Return the angle in radians by which a curve runs around a centre, positive counter-clockwise.

    It is summed over four steps per piece.
    """
    x, y = (sample_points(pieces, 4) - np.array(center)).T
    steps = np.diff(np.arctan2(y, x))
    return float(((steps + pi) % (2 * pi) - pi).sum())
