"""Curves as lines and arcs: what is a line or an arc in disguise, and biarcs for what is not.

Glossary
--------
disguise : a curve that is nowhere farther than a hair from a line or an arc, or the cubic by which programs
    write an arc.
break : a place of a curve where its direction or its curvature jumps: where one line or arc of a disguise may
    end.
stretch : a part of a curve from one break to the next.
biarc : two arcs that leave two points in given directions and meet in a common one (K. M. Bolton, "Biarc
    curves", Computer-Aided Design 7 (1975) 89-92; D. S. Meek and D. J. Walton, "Approximation of discrete
    data by G1 arc splines", Computer-Aided Design 24 (1992) 301-306).
joint : where the two arcs of a biarc meet.
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
    compute_end_curvatures,
    compute_end_directions,
    cut,
    departure,
    direction_at,
    drop_point_pieces,
    point_at,
    points_along,
)
from workhold.geometry.segment import Arc, Line, Point, make_segment_from_bulge
from workhold.limits import MOST_RADIUS

__all__ = ["FittedCurve", "biarcs", "fit_circle", "corners_of", "fit_curve", "never_interrupt"]

# A biarc is as long as it can be but for this share, and so many lengths are tried.
STEP, MOST_STEPS = 0.02, 60


@frozen
class FittedCurve:
    """Lines and arcs in place of a curve or a part of one.

    Parameters
    ----------
    points : N + 1 points (x, y) in mm; the last is the first where the curve is closed.
    bulges : N bulges.
    departure : bound of the distance between them and the curve, either way, in mm.
    is_disguise : whether the curve is lines and arcs but for hairs; otherwise biarcs may stand in its place.
    """

    points: tuple[Point, ...]
    bulges: tuple[float, ...]
    departure: float
    is_disguise: bool = False


def never_interrupt() -> None:
    """Interrupt nothing."""


def biarcs(
    pieces: Pieces, tolerance: float, interrupt: Callable[[], None] = never_interrupt
) -> list[FittedCurve]:
    """Biarcs in place of a curve, each as long as the tolerance allows, tangent to the curve where they meet.

    Corners of the curve stay corners.
    """
    corners = [0, *corners_of(pieces)]
    found: list[FittedCurve] = []
    for first, last in zip(corners, [*corners[1:], len(pieces)], strict=True):
        found += fit_smooth_biarcs(pieces[first:last], tolerance, interrupt)
    return found


def fit_smooth_biarcs(
    pieces: Pieces, tolerance: float, interrupt: Callable[[], None]
) -> Iterator[FittedCurve]:
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
    """The biarc that reaches farthest from a place of a curve, to a share of ``STEP``, and its end.

    ``step`` is the first length tried. What is smaller than the tolerance may be a line instead.
    """
    total = float(len(pieces))
    room = total - place
    best, low, high = None, 0.0, inf
    step = min(step, room)
    for _ in range(MOST_STEPS):
        reach = total if step == room else place + step
        run = biarc(pieces, place, reach, tolerance) or fit_small_line(pieces, place, reach, tolerance)
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
    """The line for a stretch of a curve smaller than the tolerance, such as a cusp; None for others."""
    stretch = cut(pieces, first, last)
    places = (stretch[..., :2] / stretch[..., 2:]).reshape(-1, 2)
    size = float(np.hypot(*np.ptp(places, axis=0)))
    ends = point_at(pieces, first), point_at(pieces, last)
    return FittedCurve(ends, (0.0,), size) if size <= tolerance else None


def biarc(pieces: Pieces, first: float, last: float, tolerance: float) -> FittedCurve | None:
    """The biarc in place of a stretch of a smooth curve; None where it departs by more than the tolerance.

    Each arc is compared with the part of the curve between its ends. Both centres lie on the normal at the
    joint, so the curve changes from one arc to the other where it crosses that.
    """
    start, end = point_at(pieces, first), point_at(pieces, last)
    begins, ends = direction_at(pieces, first, after=True), direction_at(pieces, last, after=False)
    joint = find_biarc_joint(start, end, begins, ends)
    if joint is None or min(dist(start, joint), dist(joint, end)) < SHORTEST:
        return None
    one, other = turn(begins, less(joint, start)), turn(less(end, joint), ends)
    if max(abs(one), abs(other)) > pi / 2:
        return None
    c, s = cos(2 * one), sin(2 * one)
    middle = crossing(
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
        away = max(away, departure(cut(pieces, low, high), make_segment_from_bulge(p, q, bulge), tolerance))
        if away > tolerance:
            return None
    return FittedCurve((start, joint, end), bulges, away)


def less(p: Point, q: Point) -> Point:
    return p[0] - q[0], p[1] - q[1]


def turn(u: Point, v: Point) -> float:
    """Signed angle from one vector to another."""
    return atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1])


def find_biarc_joint(start: Point, end: Point, begins: Point, ends: Point) -> Point | None:
    """The joint of a biarc with equally long tangents up to their corners; None where there is none.

    The length d solves |end - start - d (begins + ends)| = 2 d.
    """
    vx, vy = less(end, start)
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


def crossing(pieces: Pieces, first: float, last: float, joint: Point, across: Point) -> float | None:
    """Parameter at which a curve crosses the line through a point, square to a direction (Illinois)."""

    def height(parameter: float) -> float:
        x, y = less(point_at(pieces, parameter), joint)
        return x * across[0] + y * across[1]

    low, high = height(first), height(last)
    if not low < 0.0 < high:
        return None
    size, side = high - low, 0
    middle = first
    for _ in range(100):
        middle = (first * high - last * low) / (high - low)
        value = height(middle)
        if abs(value) <= 1e-12 * size or last - first <= 1e-14 * last:
            break
        if value > 0.0:
            last, high = middle, value
            low, side = (low / 2 if side == 1 else low), 1
        else:
            first, low = middle, value
            high, side = (high / 2 if side == -1 else high), -1
    return middle


def corners_of(pieces: Pieces) -> list[int]:
    """Numbers of the pieces that begin in another direction than the piece before ends in."""
    leaving, entering = compute_end_directions(pieces)
    turned = np.hypot(*(entering[:-1] - leaving[1:]).T) > CORNER
    return [int(k) + 1 for k in np.flatnonzero(turned)]


def fit_curve(
    pieces: Pieces, tolerance: float, interrupt: Callable[[], None] = never_interrupt
) -> FittedCurve | None:
    """Lines and arcs for a curve: its own where it is a disguise, else biarcs within a tolerance in mm.

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
    whole = whole_circle(pieces, DISGUISE)
    if whole is not None:
        return evolve(whole, is_disguise=True)
    runs = disguised(pieces, [0, *find_breaks(pieces), len(pieces)], interrupt)
    if all(run is not None for _, _, run in runs):
        return join_fitted_curves([run for _, _, run in runs if run is not None], True)
    whole = whole_circle(pieces, tolerance)
    if whole is not None:
        return whole
    fitted: list[FittedCurve] = []
    for first, last, run in runs:
        fitted += [run] if run is not None else biarcs(pieces[first:last], tolerance, interrupt)
    return join_fitted_curves(fitted, False)


def join_fitted_curves(runs: list[FittedCurve], is_disguise: bool) -> FittedCurve:
    points = [runs[0].points[0]]
    for run in runs:
        points += run.points[1:]
    bulges = tuple(bulge for run in runs for bulge in run.bulges)
    return FittedCurve(tuple(points), bulges, max(run.departure for run in runs), is_disguise)


def find_breaks(pieces: Pieces) -> list[int]:
    """Numbers of the pieces that begin with another direction or curvature than the last ends with."""
    begin, end = compute_end_curvatures(pieces)
    jump, most = np.abs(begin[1:] - end[:-1]), np.maximum(np.abs(begin[1:]), np.abs(end[:-1]))
    smooth = jump <= CURVATURE_JUMP * most
    corners = set(corners_of(pieces))
    return [k for k in range(1, len(pieces)) if k in corners or not smooth[k - 1]]


def disguised(
    pieces: Pieces, places: list[int], interrupt: Callable[[], None]
) -> list[tuple[int, int, FittedCurve | None]]:
    """Longest rows of stretches that are one line or arc, as (first piece, last piece + 1, run).

    Stretches that are none come alone, with None.
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
        # Steps that double and then halve: as many stretches as one line or arc takes in.
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
    """The line or arc, through both ends, that a curve is to within a tolerance; None where there is none."""
    start, end = point_at(pieces, 0.0), point_at(pieces, float(len(pieces)))
    chord = dist(start, end)
    if chord < SHORTEST:
        return None
    line = Line(start, end)
    away = departure(pieces, line, tolerance)
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
    sweep = swept(pieces, (cx, cy))
    if not 1e-9 < abs(sweep) < 2 * pi - 1e-3:
        return None
    mid_angle, sign = atan2(start[1] - cy, start[0] - cx) + sweep / 2, 1.0 if sweep > 0 else -1.0
    arc = Arc((cx, cy), radius, mid_angle, abs(sweep) / 2, sign)
    away = departure(pieces, arc, max(tolerance, allow_for_written_arcs(pieces, arc)))
    return FittedCurve(*halves((start, end), sweep, (cx, cy)), away) if isfinite(away) else None


def halves(
    ends: tuple[Point, Point], sweep: float, center: Point
) -> tuple[tuple[Point, ...], tuple[float, ...]]:
    """Points and bulges of an arc, halved where it is nearly a circle: one bulge fixes its centre badly."""
    if abs(sweep) < 1.9 * pi:
        return ends, (tan(sweep / 4),)
    (x, y), (cx, cy) = ends[0], center
    c, s = cos(sweep / 2), sin(sweep / 2)
    middle = cx + c * (x - cx) - s * (y - cy), cy + s * (x - cx) + c * (y - cy)
    return (ends[0], middle, ends[1]), (tan(sweep / 8),) * 2


def whole_circle(pieces: Pieces, tolerance: float) -> FittedCurve | None:
    """The circle that a closed curve is to within a tolerance; None where it is none."""
    start = point_at(pieces, 0.0)
    if dist(start, point_at(pieces, float(len(pieces)))) > SHORTEST:
        return None
    circle = fit_circle_to_curve(pieces)
    if circle is None:
        return None
    (cx, cy), radius = circle
    sweep = swept(pieces, (cx, cy))
    if abs(abs(sweep) - 2 * pi) > 1e-3:
        return None
    sign = 1.0 if sweep > 0 else -1.0
    angle = atan2(start[1] - cy, start[0] - cx)
    arc = Arc((cx, cy), radius, angle + pi, pi, sign)
    away = departure(pieces, arc, max(tolerance, allow_for_written_arcs(pieces, arc)))
    if not isfinite(away):
        return None
    first, second = ((cx + radius * cos(t), cy + radius * sin(t)) for t in (angle, angle + pi))
    return FittedCurve((first, second, first), (sign, sign), away)


def allow_for_written_arcs(pieces: Pieces, arc: Arc) -> float:
    """How far cubics may be from an arc when they are how programs write it, in mm; 0 where they are not.

    The cubic whose handles are 4/3 tan(sweep / 4) radii long is off by 2.73e-4 radii for a quarter turn, and
    by the sixth power of the sweep for less (M. Goldapp, "Approximation of circular arcs by cubic
    polynomials", Computer Aided Geometric Design 8 (1991) 227-238).
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
    """Centre and radius of the circle of least squares through points of a curve; None for a line.

    They are the ends of cubics, where those that stand for arcs meet them, with one or two their middles too;
    and quarters of other pieces.
    """
    each = 4 if pieces.shape[1] != 4 else 1 if len(pieces) > 2 else 2
    return fit_circle(points_along(pieces, each))


def fit_circle(points: NDArray[np.float64]) -> tuple[Point, float] | None:
    """Centre and radius of the circle of least squares through (N, 2) points (Kasa 1976); None for a line."""
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


def swept(pieces: Pieces, center: Point) -> float:
    """Signed angle that a curve covers about a centre, from quarters of its pieces."""
    x, y = (points_along(pieces, 4) - np.array(center)).T
    steps = np.diff(np.arctan2(y, x))
    return float(((steps + pi) % (2 * pi) - pi).sum())
