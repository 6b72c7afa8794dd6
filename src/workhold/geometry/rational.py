"""Rational Bézier pieces, which represent all curves of drawings exactly, and bounds of their distance from
lines and arcs.

Glossary
--------
piece : a rational Bézier curve of degree n, given by n + 1 rows (x w, y w, w) with weights w > 0; parameter 0
    to 1.
pieces : (P, n + 1, 3) array of pieces of one degree, each beginning where the one before ends: a curve.
parameter : of a curve of P pieces, from 0 to P; its whole part is the number of the piece.
blossom : the symmetric function of n arguments that a polynomial of degree n is the diagonal of. The control
    points of any stretch are its values (Ramshaw, "Blossoms are polar forms", Computer Aided Geometric Design
    6 (1989) 323-358).
forward : a curve runs along a line without turning back, or around a centre in one sense. Between common ends
    it then has a point at each place of the line or arc, so that either is as far from the other as the
    curve's points are.

Distances are bounded by control points, without sampling. A rational function with Bernstein coefficients a
in its numerator and b > 0 in its denominator lies between the smallest and the largest a / b, since it is a
mean of them with positive weights. Distances from a line are such a function, and so are squares of distances
from a point. Halving the pieces makes the excess of the bound four times smaller.
"""

from __future__ import annotations

from functools import lru_cache
from math import ceil, comb, cos, inf, pi, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from workhold.errors import InputError
from workhold.geometry.segment import Arc, Point, Segment, make_segment_from_bulge

__all__ = [
    "Pieces",
    "split_arc",
    "cut_between_parameters",
    "bound_departure",
    "compute_direction",
    "split_ellipse",
    "compute_end_curvatures",
    "compute_end_directions",
    "halve_pieces",
    "join_pieces",
    "transform_pieces",
    "compute_point",
    "sample_points",
    "make_bezier_piece",
    "split_spline",
    "drop_point_pieces",
]

Pieces = NDArray[np.float64]
# Largest degree; drawings have none above, and bounds would cost too much.
MOST_DEGREE = 12


def split_spline(points: ArrayLike, weights: ArrayLike | None, knots: ArrayLike, degree: int) -> Pieces:
    """Return the Bézier pieces of a B-spline, one for each interval between distinct knots.

    Parameters
    ----------
    points : (N, 2) control points.
    weights : (N,) weights; None for ones.
    knots : (N + degree + 1,) knots, not falling.
    degree : at least 1.

    Raises
    ------
    InputError
        For numbers that do not make a spline. The message continues a sentence that
            begins with an entity's name.
    """
    control, knot = np.asarray(points, dtype=np.float64), np.asarray(knots, dtype=np.float64)
    weight = np.ones(len(control)) if weights is None else np.asarray(weights, dtype=np.float64)
    count = len(control)
    if not 1 <= degree <= MOST_DEGREE:
        raise InputError(f"is a spline of degree {degree}: draw it with one of 1 to {MOST_DEGREE}.")
    if count <= degree or len(knot) != count + degree + 1 or len(weight) != count:
        raise InputError(
            "is a spline whose control points, weights and knots do not agree in number: draw it again."
        )
    if not (np.isfinite(control).all() and np.isfinite(knot).all() and np.isfinite(weight).all()):
        raise InputError("is a spline with a number that is not finite: draw it again.")
    if (np.diff(knot) < 0).any() or (weight <= 0).any():
        raise InputError("is a spline with falling knots, or weights that are not positive: draw it again.")
    rows = np.column_stack([control * weight[:, None], weight])
    spans = np.flatnonzero(knot[degree:count] < knot[degree + 1 : count + 1]) + degree
    if not len(spans):
        raise InputError("is a spline without length: delete it.")
    low, high = knot[spans], knot[spans + 1]
    near = spans[:, None] + np.arange(-degree, 1)
    found = np.empty((len(spans), degree + 1, 3))
    for number in range(degree + 1):
        # De Boor's algorithm with the arguments of the blossom instead of one parameter.
        values = rows[near]
        for level in range(1, degree + 1):
            at = (low if level <= degree - number else high)[:, None]
            first, last = knot[near[:, level:]], knot[near[:, level:] + degree + 1 - level]
            share = ((at - first) / (last - first))[:, :, None]
            values = (1 - share) * values[:, :-1] + share * values[:, 1:]
        found[:, number] = values[:, 0]
    ends, starts = found[:-1, -1], found[1:, 0]
    gaps = np.abs(ends[:, :2] / ends[:, 2:] - starts[:, :2] / starts[:, 2:])
    if gaps.size and gaps.max() > 1e-9 * (1.0 + np.abs(control).max()):
        raise InputError("is a spline in separate pieces: explode it.")
    found[1:, 0, :] = found[:-1, -1, :]
    return found


def make_bezier_piece(points: ArrayLike) -> Pieces:
    """Return the Bézier curve of (n + 1, 2) control points as one piece, (1, n + 1, 3)."""
    control = np.asarray(points, dtype=np.float64)
    return np.column_stack([control, np.ones(len(control))])[None]


def split_ellipse(center: Point, major: Point, minor: Point, start: float, sweep: float) -> Pieces:
    """Return exact pieces of the arc of an ellipse center + major cos t + minor sin t.

    The angle t runs from ``start`` over ``sweep`` (radians, negative for falling t). Each piece covers an
    equal part of at most a quarter turn; its middle weight is the cosine of half of that (Piegl and Tiller,
    The NURBS Book, 1997, section 7.3).
    """
    count = max(1, ceil(abs(sweep) / (pi / 2) - 1e-9))
    step = sweep / count
    half = cos(step / 2)

    def make_control_point(angle: float, weight: float) -> tuple[float, float, float]:
        """Return the row (x w, y w, w) of the control point at an angle."""
        c, s = cos(angle) / weight, sin(angle) / weight
        x, y = center[0] + major[0] * c + minor[0] * s, center[1] + major[1] * c + minor[1] * s
        return x * weight, y * weight, weight

    places = [start + k * step for k in range(count)]
    rows = [
        [
            make_control_point(t, 1.0),
            make_control_point(t + step / 2, half),
            make_control_point(t + step, 1.0),
        ]
        for t in places
    ]
    found = np.array(rows)
    found[1:, 0] = found[:-1, -1]
    if abs(abs(sweep) - 2 * pi) < 1e-9:
        found[-1, -1] = found[0, 0]
    return found


def split_arc(start: Point, end: Point, bulge: float) -> Pieces:
    """Return exact pieces of the arc from ``start`` to ``end`` with a bulge (tan(sweep / 4)).

    For a bulge of 0 it is one piece of degree 1.
    """
    segment = make_segment_from_bulge(start, end, bulge)
    if not isinstance(segment, Arc):
        return make_bezier_piece([start, end])
    radius, first = segment.radius, segment.mid_angle - segment.sign * segment.half_sweep
    found = split_ellipse(
        segment.center, (radius, 0.0), (0.0, radius), first, segment.sign * 2 * segment.half_sweep
    )
    found[0, 0], found[-1, -1] = (*start, 1.0), (*end, 1.0)
    return found


def raise_degree(pieces: Pieces, degree: int) -> Pieces:
    """Return the same curves as pieces of the higher degree ``degree`` (Farin, Curves and Surfaces for CAGD,
    section 6.1).
    """
    while pieces.shape[1] <= degree:
        n = pieces.shape[1]
        share = (np.arange(n + 1) / n)[:, None]
        before = np.concatenate([pieces[:, :1], pieces], axis=1)
        after = np.concatenate([pieces, pieces[:, -1:]], axis=1)
        pieces = share * before + (1 - share) * after
    return pieces


def join_pieces(curves: list[Pieces]) -> Pieces:
    """Return the pieces of several curves in order, all raised to the largest degree among them."""
    degree = max(pieces.shape[1] for pieces in curves) - 1
    return np.concatenate([raise_degree(pieces, degree) for pieces in curves])


def transform_pieces(pieces: Pieces, matrix: ArrayLike) -> Pieces:
    """Return pieces mapped exactly by an affine map: x' = a x + c y + e, y' = b x + d y + f.

    ``matrix`` (2, 3) is ((a, c, e), (b, d, f)).
    """
    out = np.empty_like(pieces)
    out[..., :2] = pieces @ np.asarray(matrix, dtype=np.float64).T
    out[..., 2] = pieces[..., 2]
    return out


def drop_point_pieces(pieces: Pieces, shortest: float) -> Pieces:
    """Return the pieces of a curve without those smaller than ``shortest`` mm.

    Each remaining piece starts exactly where the remaining piece before it ends.
    """
    places = pieces[..., :2] / pieces[..., 2:]
    kept: Pieces = pieces[np.ptp(places, axis=1).max(axis=1) >= shortest].copy()
    if len(kept) > 1:
        kept[1:, 0] = kept[:-1, -1] / kept[:-1, -1, 2:] * kept[1:, 0, 2:]
    return kept


def halve_pieces(pieces: Pieces) -> Pieces:
    """Return the two halves of each of P pieces, in order along the curve: (2 P, n + 1, 3)."""
    left, right = split_at_parameter(pieces, 0.5)
    return np.stack([left, right], axis=1).reshape(-1, *pieces.shape[1:])


def split_at_parameter(pieces: Pieces, at: float) -> tuple[Pieces, Pieces]:
    """Return two arrays: the first and the second part of every piece, split at one parameter.

    The parameter ``at`` of each piece is between 0 and 1. The method is de Casteljau's.
    """
    n = pieces.shape[1]
    left, right = np.empty_like(pieces), np.empty_like(pieces)
    values = pieces
    for k in range(n):
        left[:, k], right[:, n - 1 - k] = values[:, 0], values[:, -1]
        values = (1 - at) * values[:, :-1] + at * values[:, 1:]
    return left, right


def cut_between_parameters(pieces: Pieces, first: float, last: float) -> Pieces:
    """Return the pieces of the part of a curve between parameters ``first`` < ``last`` (0 to P for a curve of
    P pieces).
    """
    low, high = min(int(first), len(pieces) - 1), min(int(ceil(last)), len(pieces))
    stretch = pieces[low : max(high, low + 1)]
    begin, end = first - low, last - (low + len(stretch) - 1)
    if end < 1.0:
        stretch = np.concatenate([stretch[:-1], split_at_parameter(stretch[-1:], end)[0]])
        begin = begin / end if len(stretch) == 1 else begin
    if begin > 0.0:
        stretch = np.concatenate([split_at_parameter(stretch[:1], begin)[1], stretch[1:]])
    return stretch


def compute_point(pieces: Pieces, parameter: float) -> Point:
    """Return the point (x, y) in mm of a curve of P pieces at a parameter from 0 to P."""
    number = min(int(parameter), len(pieces) - 1)
    t = parameter - number
    n = pieces.shape[1] - 1
    basis = np.array([comb(n, k) * t**k * (1 - t) ** (n - k) for k in range(n + 1)])
    x, y, w = basis @ pieces[number]
    return float(x / w), float(y / w)


def compute_direction(pieces: Pieces, parameter: float, after: bool) -> Point:
    """Return the unit tangent of a curve of P pieces at a parameter from 0 to P.

    Where two pieces meet, it is the tangent of the piece after that point if ``after``, else of the piece
    before. Where the derivative vanishes (a control point given twice), it points to the next different
    control point.
    """
    number = min(int(parameter), len(pieces) - 1)
    if parameter == number and not after and number > 0:
        number -= 1
    one, t = pieces[number : number + 1], parameter - number
    if 0.0 < t < 1.0:
        one = split_at_parameter(one, t)[1 if after else 0]
    leaving, entering = compute_end_directions(one)
    x, y = (leaving if after else entering)[0]
    return float(x), float(y)


def compute_end_directions(pieces: Pieces) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the unit tangents (P, 2) of P pieces (1) at their starts and (2) at their ends, both in running
    direction.

    See :func:`compute_direction` for vanishing derivatives.
    """

    def compute_start_tangents(rows: Pieces) -> NDArray[np.float64]:
        """Return the unit tangents (P, 2) at the starts of pieces."""
        places = rows[..., :2] / rows[..., 2:]
        steps = places[:, 1:] - places[:, :1]
        sizes = np.hypot(steps[..., 0], steps[..., 1])
        far = np.argmax(sizes > 1e-9 * sizes.max(axis=1, keepdims=True), axis=1)
        every = np.arange(len(rows))
        found: NDArray[np.float64] = steps[every, far] / np.maximum(sizes[every, far], 1e-300)[:, None]
        return found

    return compute_start_tangents(pieces), -compute_start_tangents(pieces[:, ::-1])


def sample_points(pieces: Pieces, each: int) -> NDArray[np.float64]:
    """Return points (each * P + 1, 2) in mm of a curve of P pieces, with ``each`` equal parameter steps per
    piece.
    """
    n = pieces.shape[1] - 1
    t = (np.arange(each) / each)[:, None]
    k = np.arange(n + 1)
    basis = np.array([comb(n, j) for j in k]) * t**k * (1 - t) ** (n - k)
    rows = np.concatenate([(basis @ pieces).reshape(-1, 3), pieces[-1:, -1]])
    found: NDArray[np.float64] = rows[:, :2] / rows[:, 2:]
    return found


def compute_end_curvatures(pieces: Pieces) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the curvatures (P,) in 1/mm of P pieces (1) at their starts and (2) at their ends, positive to
    the left.

    NaN where the derivative vanishes. With control points p and weights w the curvature at the start is (n -
    1) / n * w0 w2 / w1² * cross(p1 - p0, p2 - p1) / |p1 - p0|³ (Farin, section 12.5).
    """

    def compute_start_curvatures(rows: Pieces) -> NDArray[np.float64]:
        """Return the curvatures (P,) at the starts of pieces, positive to the left."""
        n = rows.shape[1] - 1
        if n < 2:
            return np.zeros(len(rows))
        places, w = rows[:, :3, :2] / rows[:, :3, 2:], rows[:, :3, 2]
        a, b = places[:, 1] - places[:, 0], places[:, 2] - places[:, 1]
        size = np.hypot(*a.T)
        flat = size <= 1e-9 * np.ptp(rows[..., :2] / rows[..., 2:], axis=1).max(axis=1)
        cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        factor = (n - 1) / n * w[:, 0] * w[:, 2] / w[:, 1] ** 2
        found: NDArray[np.float64] = np.where(flat, np.nan, factor * cross / np.where(flat, 1.0, size) ** 3)
        return found

    return compute_start_curvatures(pieces), -compute_start_curvatures(pieces[:, ::-1])


Array = NDArray[np.float64]

# Number of halvings, after which a bound is near enough: the excess is about a thousandth of the curve's
# size, squared.
MOST_HALVINGS = 7
# With more pieces than this no further halving is done where bounds suffice.
MOST_HALVED = 4096
# A bound within this factor of a distance that is reached suffices.
NEAR_ENOUGH = 1.03
# Relative to the coefficients: a derivative above minus this counts as not negative.
ROUNDING = 1e-11


@lru_cache(maxsize=64)
def make_product_weights(n: int, m: int) -> Array:
    """Return the matrix with which two polynomials of degrees n and m in Bernstein form are multiplied.

    The matrix (n + m + 1, (n + 1) (m + 1)) maps all products of their coefficients to the coefficients of the
    product.
    """
    i, j = np.arange(n + 1)[:, None], np.arange(m + 1)[None, :]
    weights = np.array(
        [[comb(n, a) * comb(m, b) / comb(n + m, a + b) for b in range(m + 1)] for a in range(n + 1)]
    )
    place = np.zeros((n + m + 1, n + 1, m + 1))
    place[i + j, i, j] = weights
    return place.reshape(n + m + 1, -1)


def multiply_bernstein(a: Array, b: Array) -> Array:
    """Return the Bernstein coefficients (P, n + m + 1) of the products of P pairs of polynomials.

    ``a`` (P, n + 1) and ``b`` (P, m + 1) are the coefficients of the factors.
    """
    outer: Array = (a[:, :, None] * b[:, None, :]).reshape(len(a), -1)
    return outer @ make_product_weights(a.shape[1] - 1, b.shape[1] - 1).T


def compute_turning_coefficients(u: Array, v: Array) -> Array:
    """Return the Bernstein coefficients of u v' - u' v for P pairs of polynomials u and v.

    ``u`` and ``v`` (P, n + 1) are the polynomials' coefficients. The result has the sign of the derivative of v / u.
    """
    n = u.shape[1] - 1
    return multiply_bernstein(u, n * np.diff(v)) - multiply_bernstein(n * np.diff(u), v)


def bound_departure(pieces: Pieces, segment: Segment, limit: float) -> float:
    """Return an upper bound in mm of the distance of any point of a curve from a line or arc, and of any
    point of that from the curve.

    Both must have the same ends. The result is inf where the distance cannot be shown to be at most ``limit``
    mm, or where the curve turns back along the segment. The segment may be a full circle.
    """
    for halving in range(MOST_HALVINGS + 1):
        reached, bound, forward = measure_departure(pieces, segment)
        if reached > limit:
            return inf
        is_last = halving == MOST_HALVINGS or len(pieces) > MOST_HALVED
        if bound <= limit and forward and (is_last or bound <= NEAR_ENOUGH * reached + 1e-9):
            return bound
        if halving < MOST_HALVINGS:
            pieces = halve_pieces(pieces)
    return inf


def measure_departure(pieces: Pieces, segment: Segment) -> tuple[float, float, bool]:
    """Return (lower bound, upper bound) in mm of the distance of a curve from a line or arc, and whether the
    curve runs forward.

    The lower bound is the largest distance of an end of a piece. A curve runs forward if it never turns back
    along the segment.
    """
    w = pieces[..., 2]
    if isinstance(segment, Arc):
        x, y = (pieces[..., k] - segment.center[k] * w for k in (0, 1))
        radius = segment.radius
        # Squared distance from the centre minus the squared radius.
        off = multiply_bernstein(x, x) + multiply_bernstein(y, y) - radius * radius * multiply_bernstein(w, w)
        ratio = off / multiply_bernstein(w, w)
        away = np.abs(ratio) / (radius + np.sqrt(np.maximum(radius * radius + ratio, 0.0)))
        around = segment.sign * (multiply_bernstein(x, np.diff(y)) - multiply_bernstein(y, np.diff(x)))
        # Pieces that cover half a turn or more are distinguished from their complements when they are halved.
        (ax, bx), (ay, by) = (one[:, [0, -1]].T for one in (x, y))
        covered = segment.sign * np.arctan2(ax * by - ay * bx, ax * bx + ay * by).sum()
        forward = (around >= -ROUNDING * radius * radius).all() and abs(
            covered - 2 * segment.half_sweep
        ) < 1e-3
        return float(away[:, [0, -1]].max()), float(away.max()), bool(forward)
    (x0, y0), (tx, ty) = segment.start, segment.tangent
    x, y = pieces[..., 0] - x0 * w, pieces[..., 1] - y0 * w
    away = np.abs(x * ty - y * tx) / w
    along = compute_turning_coefficients(w, x * tx + y * ty)
    forward = bool((along >= -ROUNDING * segment.length).all())
    return float(away[:, [0, -1]].max()), float(away.max()), forward
