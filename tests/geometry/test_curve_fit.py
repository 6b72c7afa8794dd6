"""Curves as lines and arcs: exact disguises, biarcs within a tolerance, and bounds that hold everywhere."""

from __future__ import annotations

from itertools import pairwise
from math import atan2, cos, dist, hypot, pi, radians, sin, tan

import numpy as np
import pytest
from ezdxf.math import BSpline, open_uniform_knot_vector
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from workhold.errors import InputError
from workhold.geometry.curve_fit import FittedCurve, fit_biarcs, fit_curve
from workhold.geometry.rational import (
    Pieces,
    bound_departure,
    compute_direction,
    compute_end_curvatures,
    compute_point,
    cut_between_parameters,
    join_pieces,
    make_bezier_piece,
    sample_points,
    split_arc,
    split_ellipse,
    split_spline,
    transform_pieces,
)
from workhold.geometry.segment import Arc, Line, Point, Segment, make_segment_from_bulge

HANDLE = 4 / 3 * tan(pi / 8)


def bezier_circle(radius: float, handle: float = HANDLE, digits: int = 12) -> Pieces:
    """A circle as programs write it: four cubics."""
    corners = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
    curves = []
    for (px, py), (qx, qy) in zip(corners, corners[1:] + corners[:1], strict=True):
        rows = [
            (px, py),
            (px + handle * qx, py + handle * qy),
            (qx + handle * px, qy + handle * py),
            (qx, qy),
        ]
        curves.append(make_bezier_piece(np.round(radius * np.array(rows), digits)))
    return join_pieces(curves)


def wave(seed: int, count: int = 9) -> Pieces:
    """A smooth cubic spline through nowhere in particular, C2."""
    rng = np.random.default_rng(seed)
    points = np.column_stack([np.arange(count) * 12.0, rng.uniform(-20, 20, count)])
    return split_spline(points, None, open_uniform_knot_vector(count, 4), 3)


def segments_of(fitted: FittedCurve) -> list[Segment]:
    """The lines and arcs."""
    rows = zip(fitted.points, fitted.points[1:], fitted.bulges, strict=False)
    return [make_segment_from_bulge(p, q, bulge) for p, q, bulge in rows]


def away_from(points: NDArray[np.float64], segments: list[Segment]) -> NDArray[np.float64]:
    """Distance of each point from the nearest segment."""

    def distance(x: float, y: float, segment: Segment) -> float:
        parameter = segment.find_parameter((x, y))
        inside = abs(parameter) <= segment.half_extent
        foot = segment.compute_point(parameter if inside else np.copysign(segment.half_extent, parameter))
        return hypot(x - foot[0], y - foot[1])

    return np.array([min(distance(x, y, segment) for segment in segments) for x, y in points])


def sampled(segments: list[Segment], each: int) -> NDArray[np.float64]:
    """Points along segments."""
    return np.array(
        [s.compute_point(share * s.half_extent) for s in segments for share in np.linspace(-1, 1, each)]
    )


def test_a_spline_in_pieces_is_the_spline() -> None:
    """Points of a rational B-spline with uneven and repeated knots are those that ezdxf finds."""
    points = [(0, 0), (10, 30), (25, -5), (40, 20), (60, 25), (70, -10)]
    weights, knots = [1, 2, 0.5, 3, 1, 1], [0, 0, 0, 0, 0.3, 0.3, 1, 1, 1, 1]
    pieces = split_spline(points, weights, knots, 3)
    assert pieces.shape == (2, 4, 3)
    spline = BSpline(points, order=4, knots=knots, weights=weights)
    for number, (low, high) in enumerate([(0, 0.3), (0.3, 1)]):
        for share in (0, 0.2, 0.7, 0.999):
            x, y, _ = spline.point(low + share * (high - low))
            assert compute_point(pieces, number + share) == pytest.approx((x, y), abs=1e-12)


def test_an_unclamped_closed_spline_closes() -> None:
    """A periodic spline with uniform knots begins where it ends, in one direction and with one curvature."""
    corners = [(0.0, 0.0), (50.0, -10.0), (80.0, 20.0), (60.0, 60.0), (-10.0, 30.0)]
    pieces = split_spline(corners + corners[:3], None, range(12), 3)
    assert len(pieces) == 5
    assert compute_point(pieces, 0) == pytest.approx(compute_point(pieces, 5), abs=1e-12)
    assert compute_direction(pieces, 0, after=True) == pytest.approx(
        compute_direction(pieces, 5, after=False), abs=1e-12
    )
    begin, end = compute_end_curvatures(pieces)
    assert begin == pytest.approx(np.roll(end, 1), rel=1e-9)


@pytest.mark.parametrize(
    ("points", "weights", "knots", "degree", "said"),
    [
        ([(0, 0), (1, 1)], None, [0, 0, 1, 1], 0, "degree 0"),
        ([(0, 0), (1, 1)], None, [0, 1, 1], 1, "do not agree in number"),
        ([(0, 0), (1, 1)], [1, -1], [0, 0, 1, 1], 1, "not positive"),
        ([(0, 0), (1, 1)], None, [0, 1, 0, 1], 1, "falling knots"),
        ([(0, 0), (1, np.inf)], None, [0, 0, 1, 1], 1, "not finite"),
        ([(0, 0), (1, 1)], None, [0, 0, 0, 0], 1, "without length"),
        ([(0, 0), (1, 1), (5, 5), (6, 6)], None, [0, 0, 1, 1, 2, 2], 1, "separate pieces"),
    ],
)
def test_numbers_that_are_no_spline_are_refused(
    points: list[Point], weights: list[float] | None, knots: list[float], degree: int, said: str
) -> None:
    """What is wrong is said in words that follow the entity's name."""
    with pytest.raises(
        InputError, match=f"^is a spline .*{said}|^is a spline of {said}|^is a spline in {said}"
    ):
        split_spline(points, weights, knots, degree)


def test_curvature_at_the_ends_is_that_of_an_ellipse() -> None:
    """a / b² at the ends of the long axis and b / a² at those of the short one."""
    begin, end = compute_end_curvatures(split_ellipse((3, 4), (30, 0), (0, 20), 0, 2 * pi))
    assert begin == pytest.approx([30 / 400, 20 / 900, 30 / 400, 20 / 900])
    assert end == pytest.approx(np.roll(begin, -1))


def test_a_cut_curve_is_the_curve_between() -> None:
    """Across a joint, within one piece, and to the very end."""
    pieces = wave(1)
    for first, last in ((0.3, 2.6), (1.2, 1.7), (3.0, 6.0), (5.5, 6.0)):
        part = cut_between_parameters(pieces, first, last)
        assert compute_point(part, 0) == pytest.approx(compute_point(pieces, first), abs=1e-12)
        assert compute_point(part, len(part)) == pytest.approx(compute_point(pieces, last), abs=1e-12)
    middle = cut_between_parameters(pieces, 1.2, 1.7)
    assert compute_point(middle, 0.5) == pytest.approx(compute_point(pieces, 1.45), abs=1e-12)


def test_an_ellipse_of_equal_axes_and_an_exact_spline_are_circles() -> None:
    """Rational quarters are on the circle to rounding; half of them is half a circle."""
    whole = fit_curve(split_ellipse((10, 5), (0, 20), (-20, 0), 0.3, 2 * pi), 0.01)
    assert whole is not None and whole.is_disguise and whole.departure < 1e-12
    assert [segment.center for segment in segments_of(whole)] == [pytest.approx((10, 5), abs=1e-12)] * 2  # type: ignore[union-attr]
    half = fit_curve(split_arc((0, 0), (8, 0), 1.0), 0.01)
    assert half is not None and half.bulges == (pytest.approx(1.0),) and half.departure < 1e-12


@pytest.mark.parametrize(
    ("handle", "digits"), [(HANDLE, 12), (HANDLE, 3), (0.5523, 12), (0.552, 12), (0.551915, 12)]
)
def test_cubics_by_which_programs_write_circles_are_circles(handle: float, digits: int) -> None:
    """With any of the handles in use and rounded numbers; the departure is what is known of them, 2.7e-4 radii."""
    fitted = fit_curve(bezier_circle(50, handle, digits), 0.01)
    assert fitted is not None and fitted.is_disguise and fitted.bulges == (1, 1)
    assert [hypot(x, y) for x, y in fitted.points] == pytest.approx([50] * 3, abs=0.005)
    assert 0.004 < fitted.departure < 0.0151
    if handle == HANDLE:
        assert fitted.departure == pytest.approx(2.7253e-4 * 50, rel=0.01)


def test_cubics_with_other_handles_are_no_circle() -> None:
    """Handles 1 % too long are off by 2.4e-3 radii: another curve, unless it is so small that nobody could see it."""
    blown = fit_curve(bezier_circle(50, 1.01 * HANDLE), 0.01)
    assert blown is not None and not blown.is_disguise
    small = fit_curve(bezier_circle(0.2, 1.01 * HANDLE), 0.01)
    assert small is not None and small.is_disguise


def test_a_slot_in_one_curve_is_two_lines_and_two_arcs() -> None:
    """Stretches end where the curvature jumps, though the direction does not; the ends are where they were drawn."""
    slot = join_pieces(
        [
            make_bezier_piece([(0, 0), (13, 0), (26, 0), (40, 0)]),
            split_arc((40, 0), (40, 20), 1.0),
            make_bezier_piece([(40, 20), (0, 20)]),
            split_arc((0, 20), (0, 0), 1.0),
        ]
    )
    fitted = fit_curve(slot, 0.01)
    assert fitted is not None and fitted.is_disguise
    assert np.array(fitted.points) == pytest.approx(
        np.array([(0, 0), (40, 0), (40, 20), (0, 20), (0, 0)]), abs=1e-12
    )
    assert fitted.bulges == pytest.approx([0, 1, 0, 1], abs=1e-12)


def test_a_line_that_turns_back_is_no_line() -> None:
    """Handles beyond the end make a curve overshoot; ones on the ends do not."""
    there = fit_curve(make_bezier_piece([(0, 0), (0, 0), (30, 0), (30, 0)]), 0.01)
    assert there is not None and there.bulges == (0.0,)
    line = Line((0.0, 0.0), (30.0, 0.0))
    assert bound_departure(make_bezier_piece([(0, 0), (60, 0), (60, 0), (30, 0)]), line, 1.0) == np.inf


@pytest.mark.thorough
@pytest.mark.thinned(8)
@pytest.mark.sampled(2)
@pytest.mark.parametrize("fit", [0.2, 0.01, 0.001])
@pytest.mark.parametrize("shape", ["ellipse", "wave 1", "wave 2", "rational", "closed"])
def test_biarcs_are_smooth_and_as_near_as_said(fit: float, shape: str) -> None:
    """Either way no point is farther off than the bound, which points nearly reach; neighbours meet in one direction."""
    closed = [(0.0, 0.0), (50.0, -10.0), (80.0, 20.0), (60.0, 60.0), (-10.0, 30.0)]
    pieces = {
        "ellipse": split_ellipse((0, 0), (24, 18), (-9, 12), 0.0, 2 * pi),
        "wave 1": wave(1),
        "wave 2": transform_pieces(wave(2), [(0, -1, 3), (1, 0.2, 5)]),
        "rational": split_spline(
            [(0, 0), (10, 40), (30, -30), (60, 10)], [1, 4, 0.3, 1], [0] * 4 + [1] * 4, 3
        ),
        "closed": split_spline(closed + closed[:3], None, range(12), 3),
    }[shape]
    fitted = fit_curve(pieces, fit)
    assert fitted is not None and not fitted.is_disguise and fitted.departure <= fit
    segments = segments_of(fitted)
    curve = sample_points(pieces, 400 if fit > 0.001 else 100)
    off = away_from(curve, segments)
    assert off.max() <= fitted.departure + 1e-9
    assert off.max() >= 0.8 * fitted.departure
    # The other way: the nearest of many points of the curve is half a step from the foot at most.
    fine = sample_points(pieces, 4000)
    half_step = float(np.hypot(*np.diff(fine, axis=0).T).max()) / 2
    back = float(cKDTree(fine).query(sampled(segments, 5))[0].max())
    assert back <= hypot(fitted.departure, half_step) + 1e-6
    for one, other in pairwise(segments):
        (ax, ay), (bx, by) = one.compute_normal(edge(one, 1)), other.compute_normal(edge(other, -1))
        assert hypot(ax - bx, ay - by) < 1e-6


def edge(segment: Segment, end: int) -> float:
    """Parameter of a segment's end, or of its start."""
    return end * (segment.sign if isinstance(segment, Arc) else 1.0) * segment.half_extent


@pytest.mark.thorough
def test_a_finer_fit_takes_more_arcs() -> None:
    """Biarcs are of third order: an eighth of the tolerance takes twice as many."""
    counts = []
    for fit in (0.08, 0.01, 0.00125):
        fitted = fit_curve(wave(3), fit)
        assert fitted is not None
        counts.append(len(fitted.bulges))
    assert counts[0] < 0.7 * counts[1] < 0.49 * counts[2]


def test_corners_of_a_curve_stay_corners() -> None:
    """Two curves that meet at an angle keep the point where they do."""
    pieces = join_pieces(
        [
            make_bezier_piece([(0, 0), (10, 15), (20, -15), (30, 0)]),
            make_bezier_piece([(30, 0), (30, 20), (10, 20), (0, 40)]),
        ]
    )
    fitted = fit_curve(pieces, 0.05)
    assert fitted is not None
    assert min(dist(point, (30, 0)) for point in fitted.points) < 1e-12
    # Straight on either side of the corner, so that nothing else shows it.
    ahead = make_bezier_piece([(0, 0), (5, 20), (15, 20), (20, 10), (25, 0)])
    aside = make_bezier_piece([(25, 0), (30, -1), (35, -2), (50, 10), (50, 30)])
    straight = fit_curve(join_pieces([ahead, aside]), 0.05)
    assert straight is not None and not straight.is_disguise
    assert min(dist(point, (25, 0)) for point in straight.points) < 1e-12


def test_a_bound_is_never_below_the_distance() -> None:
    """An arc through the ends of a random cubic, a little off: the bound is above what samples show, and not by much."""
    rng = np.random.default_rng(7)
    bounded = 0
    for _ in range(60):
        sweep, radius = rng.uniform(0.2, 1.5), rng.uniform(5, 50)
        handle = 4 / 3 * tan(sweep / 4) * radius
        ends = [(radius, 0.0), (radius * cos(sweep), radius * sin(sweep))]
        rows = np.array(
            [
                ends[0],
                (radius, handle),
                (ends[1][0] + handle * sin(sweep), ends[1][1] - handle * cos(sweep)),
                ends[1],
            ]
        )
        rows[1:3] += rng.normal(size=(2, 2)) * 0.01 * radius
        pieces = make_bezier_piece(rows)
        arc = Arc((0.0, 0.0), radius, sweep / 2, sweep / 2, 1.0)
        bound = bound_departure(pieces, arc, 0.05 * radius)
        if not np.isfinite(bound):
            continue
        bounded += 1
        reached = np.abs(np.hypot(*sample_points(pieces, 2000).T) - radius).max()
        assert reached <= bound <= 1.05 * reached + 1e-8
    assert bounded > 40


def test_a_curve_that_goes_round_once_more_is_not_the_arc() -> None:
    """Five quarters of a circle end where one quarter does."""
    turns = split_ellipse((0, 0), (10, 0), (0, 10), 0, 2.5 * pi)
    assert bound_departure(turns, Arc((0.0, 0.0), 10.0, pi / 4, pi / 4, 1.0), 1.0) == np.inf


def test_a_curve_that_turns_back_on_its_circle_is_not_the_arc() -> None:
    """Forward by 60 degrees, back by 20, and on to 90: on the circle everywhere, and past some places three times."""
    steps = [(0, 60), (60, -20), (40, 50)]
    pieces = join_pieces([split_ellipse((0, 0), (10, 0), (0, 10), radians(a), radians(b)) for a, b in steps])
    arc = Arc((0.0, 0.0), 10.0, pi / 4, pi / 4, 1.0)
    assert bound_departure(pieces, arc, 1.0) == np.inf
    assert bound_departure(split_ellipse((0, 0), (10, 0), (0, 10), 0, pi / 2), arc, 1.0) < 1e-12


@pytest.mark.thorough
def test_a_cusp_does_not_end_the_fit() -> None:
    """A curve with a cusp, and one whose handles vanish, are fitted within the tolerance, or their distance is said."""
    for rows in ([(0, 0), (30, 20), (0, 20), (30, 0)], [(0, 0), (0, 0), (20, 30), (40, 0)]):
        fitted = fit_curve(make_bezier_piece(rows), 0.01)
        assert fitted is not None and fitted.departure < 0.02
        assert (
            away_from(sample_points(make_bezier_piece(rows), 300), segments_of(fitted)).max()
            <= fitted.departure + 1e-9
        )
    runs = fit_biarcs(make_bezier_piece([(0, 0), (1, 0), (2, 0), (3, 0.0)]), 0.01)
    assert [atan2(run.points[-1][1], run.points[-1][0]) for run in runs] == [pytest.approx(0.0, abs=1e-12)]
