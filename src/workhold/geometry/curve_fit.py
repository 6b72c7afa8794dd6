"""Curves as lines and arcs: what is a line or an arc in disguise, and biarcs for what is not.

Glossary
--------
disguise : a curve that is nowhere farther than a hair from a line or an arc, or the cubic by which programs write an arc.
break : a place of a curve where its direction or its curvature jumps: where one line or arc of a disguise may end.
stretch : a part of a curve from one break to the next.
"""

from __future__ import annotations

from math import atan2, cos, dist, isfinite, pi, sin, sqrt, tan

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import AS_ARC, CURVATURE_JUMP, DISGUISE, SHORTEST
from workhold.geometry.biarc import FittedRun, biarcs, corners_of
from workhold.geometry.curve_bounds import departure
from workhold.geometry.rational import (
    Pieces,
    end_curvatures,
    point_at,
    points_along,
    without_points,
)
from workhold.geometry.segment import Arc, Line, Point
from workhold.limits import MOST_RADIUS

__all__ = ["FittedCurve", "circle_of_points", "fitted_curve"]


@frozen
class FittedCurve:
    """Lines and arcs in place of a curve.

    Parameters
    ----------
    points : N + 1 points (x, y) in mm; the last is the first where the curve is closed.
    bulges : N bulges.
    departure : bound of the distance between them and the curve, either way, in mm.
    is_disguise : whether the curve is lines and arcs but for hairs; otherwise biarcs stand in its place.
    """

    points: tuple[Point, ...]
    bulges: tuple[float, ...]
    departure: float
    is_disguise: bool


def fitted_curve(pieces: Pieces, tolerance: float) -> FittedCurve | None:
    """Lines and arcs in place of a curve: as they are where it is a disguise, else biarcs within a tolerance in mm.

    Returns
    -------
    FittedCurve or None
        None for a curve of no length.
    """
    pieces = without_points(pieces, SHORTEST)
    if not len(pieces):
        return None
    whole = whole_circle(pieces, DISGUISE)
    if whole is not None:
        return FittedCurve(whole.points, whole.bulges, whole.departure, True)
    breaks = breaks_of(pieces)
    runs = disguised(pieces, [0, *breaks, len(pieces)])
    if all(run is not None for _, _, run in runs):
        return put_together([run for _, _, run in runs if run is not None], True)
    whole = whole_circle(pieces, tolerance)
    if whole is not None:
        return put_together([whole], False)
    fitted: list[FittedRun] = []
    for first, last, run in runs:
        fitted += [run] if run is not None else biarcs(pieces[first:last], tolerance)
    return put_together(fitted, False)


def put_together(runs: list[FittedRun], is_disguise: bool) -> FittedCurve:
    """One curve of runs that follow each other."""
    points = [runs[0].points[0]]
    for run in runs:
        points += run.points[1:]
    bulges = tuple(bulge for run in runs for bulge in run.bulges)
    return FittedCurve(tuple(points), bulges, max(run.departure for run in runs), is_disguise)


def breaks_of(pieces: Pieces) -> list[int]:
    """Numbers of the pieces that begin with another direction or curvature than the piece before ends with."""
    begin, end = end_curvatures(pieces)
    jump, most = np.abs(begin[1:] - end[:-1]), np.maximum(np.abs(begin[1:]), np.abs(end[:-1]))
    smooth = jump <= CURVATURE_JUMP * most
    corners = set(corners_of(pieces))
    return [k for k in range(1, len(pieces)) if k in corners or not smooth[k - 1]]


def disguised(pieces: Pieces, places: list[int]) -> list[tuple[int, int, FittedRun | None]]:
    """Longest rows of stretches between places that are one line or arc, as (first piece, last piece + 1, run).

    Stretches that are none come alone, with None.
    """
    found: list[tuple[int, int, FittedRun | None]] = []
    k = 0
    while k < len(places) - 1:
        run, taken, step = one_segment(pieces[places[k] : places[k + 1]], DISGUISE), k + 1, 1
        # Steps that double and then halve: as many stretches as one line or arc takes in.
        growing = True
        while run is not None and step >= 1:
            further = min(taken + step, len(places) - 1)
            longer = None if further == taken else one_segment(pieces[places[k] : places[further]], DISGUISE)
            if longer is not None:
                run, taken = longer, further
                step = 2 * step if growing else step
            else:
                growing = False
                step //= 2
        found.append((places[k], places[taken], run))
        k = taken
    return found


def one_segment(pieces: Pieces, tolerance: float) -> FittedRun | None:
    """The line or arc, through both ends, that a curve is to within a tolerance; None where there is none."""
    start, end = point_at(pieces, 0.0), point_at(pieces, float(len(pieces)))
    chord = dist(start, end)
    if chord < SHORTEST:
        return None
    line = Line(start, end)
    away = departure(pieces, line, tolerance)
    if isfinite(away):
        return FittedRun((start, end), (0.0,), away)
    circle = circle_near(pieces)
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
    arc = Arc(
        (cx, cy), radius, atan2(start[1] - cy, start[0] - cx) + sweep / 2, abs(sweep) / 2, 1.0 if sweep > 0 else -1.0
    )
    away = departure(pieces, arc, max(tolerance, as_arcs_are_written(pieces, arc)))
    if not isfinite(away):
        return None
    return FittedRun(*halves((start, end), sweep, (cx, cy)), away)


def halves(ends: tuple[Point, Point], sweep: float, center: Point) -> tuple[tuple[Point, ...], tuple[float, ...]]:
    """Points and bulges of an arc, in two halves where it is nearly a circle: one bulge would fix its centre badly."""
    if abs(sweep) < 1.9 * pi:
        return ends, (tan(sweep / 4),)
    (x, y), (cx, cy) = ends[0], center
    c, s = cos(sweep / 2), sin(sweep / 2)
    middle = cx + c * (x - cx) - s * (y - cy), cy + s * (x - cx) + c * (y - cy)
    return (ends[0], middle, ends[1]), (tan(sweep / 8),) * 2


def whole_circle(pieces: Pieces, tolerance: float) -> FittedRun | None:
    """The circle that a closed curve is to within a tolerance; None where it is none."""
    start = point_at(pieces, 0.0)
    if dist(start, point_at(pieces, float(len(pieces)))) > SHORTEST:
        return None
    circle = circle_near(pieces)
    if circle is None:
        return None
    (cx, cy), radius = circle
    sweep = swept(pieces, (cx, cy))
    if abs(abs(sweep) - 2 * pi) > 1e-3:
        return None
    sign = 1.0 if sweep > 0 else -1.0
    angle = atan2(start[1] - cy, start[0] - cx)
    arc = Arc((cx, cy), radius, angle + pi, pi, sign)
    away = departure(pieces, arc, max(tolerance, as_arcs_are_written(pieces, arc)))
    if not isfinite(away):
        return None
    first, second = ((cx + radius * cos(t), cy + radius * sin(t)) for t in (angle, angle + pi))
    return FittedRun((first, second, first), (sign, sign), away)


def as_arcs_are_written(pieces: Pieces, arc: Arc) -> float:
    """How far cubics may be from an arc when they are how programs write it, in mm; 0 where they are not.

    The cubic whose handles are 4/3 tan(sweep / 4) radii long is off by 2.73e-4 radii for a quarter turn, and by the sixth
    power of the sweep for less (M. Goldapp, "Approximation of circular arcs by cubic polynomials", Computer Aided Geometric
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


def circle_near(pieces: Pieces) -> tuple[Point, float] | None:
    """Centre and radius of the circle of least squares through points of a curve; None for a line.

    They are the ends of cubics, where those that stand for arcs meet them, with one or two their middles too; and
    quarters of other pieces.
    """
    each = 4 if pieces.shape[1] != 4 else 1 if len(pieces) > 2 else 2
    return circle_of_points(points_along(pieces, each))


def circle_of_points(points: NDArray[np.float64]) -> tuple[Point, float] | None:
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
