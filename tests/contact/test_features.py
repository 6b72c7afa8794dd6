"""Contact features: where a peg's centre may lie."""

from __future__ import annotations

from math import hypot, pi, sqrt, tan

import numpy as np
import pytest
from flint import arb
from hypothesis import given, settings

from exact_chords import exactly
from strategies import outlines, vises
from workhold import Query, Restrictions, Vise, Workpiece, load, polygon_zone
from workhold.contact import features
from workhold.contact.features import (
    find_allowed_features,
    list_contact_features,
    make_feature_rows,
    measure_end_slacks,
)
from workhold.contact.problem import Problem
from workhold.geometry.segment import Arc, make_segment_rows
from workhold.kernels.base.distance import (
    measure_outline_distance,
    measure_outline_distances,
    measure_segment_distance,
)
from workhold.model.own_outlines import measure_outline_diameter, measure_segments_diameter
from workhold.proof.ball_contacts import compute_contact_value, measure_from_origin
from workhold.statics.contact_matrix import compute_outward_normals
from workhold.verification.ball_geometry import BallOutline


@pytest.mark.thorough
@given(outlines(), vises())
def test_a_peg_on_a_feature_touches_its_face_and_nothing_else(part, vise):
    """At every point of a feature the face is at distance rho, along the feature's normal, and no face is nearer."""
    outline = make_segment_rows(part.segments)
    faces = {face.number: face for face in part.faces}
    for feature in list_contact_features(part, vise.peg_radius):
        face = faces[feature.face].segment
        row = make_segment_rows([face])[0]
        for t in np.linspace(-1, 1, 9) * feature.segment.half_extent:
            (x, y), (nx, ny) = feature.segment.compute_point(t), feature.segment.compute_normal(t)
            assert measure_segment_distance(x, y, row) == pytest.approx(vise.peg_radius, abs=2e-9)
            assert measure_outline_distance(x, y, outline) == pytest.approx(vise.peg_radius, abs=2e-9)
            foot = (x - vise.peg_radius * nx, y - vise.peg_radius * ny)
            assert measure_segment_distance(*foot, row) < 2e-9


@pytest.mark.thorough
@given(outlines(), vises())
def test_features_are_ordered_by_face_and_carry_outward_normals(part, vise):
    """Faces ascend; a feature is of its face's kind; its row gives the same normals as the segment."""
    features = list_contact_features(part, vise.peg_radius)
    assert [f.face for f in features] == sorted(f.face for f in features)
    faces = {face.number: face.segment for face in part.faces}
    rows = make_feature_rows(features)
    for feature, row in zip(features, rows, strict=True):
        face = faces[feature.face]
        assert type(feature.segment) is type(face)
        if isinstance(face, Arc):
            assert feature.segment.radius == pytest.approx(face.radius + face.sign * vise.peg_radius)
        t = 0.4 * feature.segment.half_extent
        normal = compute_outward_normals(row, np.array(feature.segment.compute_point(t)))
        assert normal == pytest.approx(feature.segment.compute_normal(t), abs=1e-9)


@pytest.mark.thorough
@settings(max_examples=80)
@given(outlines())
def test_the_diameter_is_the_largest_distance_of_a_sampling(part):
    """The diameter is at least every sampled distance and no more than the finest one plus the sampling's error."""
    points = np.array(
        [s.compute_point(t * s.half_extent) for s in part.loop_segments[0] for t in np.linspace(-1, 1, 81)]
    )
    farthest = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1)).max()
    diameter = measure_outline_diameter(part)
    longest = max(s.length for s in part.loop_segments[0])
    assert farthest - 1e-9 <= diameter <= farthest + longest / 80 * 0.2 + 1e-9


@pytest.mark.thorough
@settings(max_examples=80)
@given(outlines())
def test_the_diameter_is_that_of_the_two_faces_farthest_apart(part):
    """To the last digit the largest over all pairs, whatever pairs are passed over."""
    outer = [face.segment for face in part.faces if face.number < len(part.loops[0])]
    assert measure_outline_diameter(part) == max(
        measure_segments_diameter(a, b) for a in outer for b in outer
    )


def test_known_diameters():
    """A disc's is 2 R, an obround's its length, a rectangle's its diagonal, a half disc's 2 R."""

    def diameter(*loops):
        return measure_outline_diameter(Workpiece.from_loops("part", loops))

    assert diameter([[-5, 3, 1], [5, 3, 1]]) == pytest.approx(10)
    assert diameter([[0, 0, 0], [30, 0, 1], [30, 10, 0], [0, 10, 1]]) == pytest.approx(40)
    assert diameter([[0, 0, 0], [30, 0, 0], [30, 40, 0], [0, 40, 0]]) == pytest.approx(50)
    assert diameter([[-5, 0, 0], [5, 0, 1]]) == pytest.approx(10)
    three_quarters = [[10, 0, tan(3 * pi / 8)], [0, -10, 0], [0, 0, 0]]
    assert diameter(three_quarters) == pytest.approx(20)


def test_tangent_joints_forgive_rounding_and_corners_do_not():
    """Ends of features joined tangentially have a positive slack, all others a negative one; a whole circle has none."""
    obround = Workpiece.from_loops("obround", [[[0, 0, 0], [30, 0, 1], [30, 10, 0], [0, 10, 1]]])
    assert (measure_end_slacks(list_contact_features(obround, 2.0)) > 0).all()
    square = Workpiece.from_loops("square", [[[0, 0, 0], [30, 0, 0], [30, 30, 0], [0, 30, 0]]])
    assert (measure_end_slacks(list_contact_features(square, 2.0)) < 0).all()
    # With rho = 0 features join at corners, but not tangentially.
    assert (measure_end_slacks(list_contact_features(square, 0.0)) < 0).all()
    half = Workpiece.from_loops("half", [[[0, 0, 0], [30, 0, 0], [30, 10, 1], [0, 10, 0]]])
    features = list_contact_features(half, 2.0)
    slack = measure_end_slacks(features)
    for feature, (low, high) in zip(features, slack, strict=True):
        ends = [
            feature.segment.compute_point(-feature.segment.half_extent),
            feature.segment.compute_point(feature.segment.half_extent),
        ]
        for (x, y), value in zip(ends, (low, high), strict=True):
            assert (value > 0) == (min(hypot(x - 32, y - 10), hypot(x + 2, y - 10)) < 1e-9)


def test_ends_are_compared_alike_however_many_at_a_time(monkeypatch):
    """All at once, one by one, or five by five."""
    locus = list_contact_features(load("widget"), 3.0)
    slack = measure_end_slacks(locus)
    assert (slack > 0).any() and (slack < 0).any()
    for together in (1, 10 * len(locus)):
        monkeypatch.setattr(features, "TOGETHER", together)
        assert (measure_end_slacks(locus) == slack).all()


def test_a_peg_too_fat_for_every_corner_leaves_no_feature_there():
    """A round hole smaller than the peg has no feature; a larger one has a whole circle of radius r - rho."""
    plate = [[0, 0, 0], [60, 0, 0], [60, 60, 0], [0, 60, 0]]
    for radius, expected in ((2.0, []), (3.0, []), (5.0, [2.0])):
        part = Workpiece.from_loops("plate", [plate, [[30 - radius, 30, 1], [30 + radius, 30, 1]]])
        inside = [f.segment for f in list_contact_features(part, 3.0) if f.face >= 4]
        assert [s.radius for s in inside] == pytest.approx(expected)
        assert all(s.is_full and s.sign == -1.0 for s in inside)


@pytest.mark.parametrize(("excess", "count"), [(0.0, 0), (2e-8, 0), (4.9e-7, 0), (5.1e-7, 1), (1e-3, 1)])
def test_a_hollow_that_the_peg_fills_has_no_feature(excess: float, count: int) -> None:
    """A fillet or a hole of the peg's radius and a little more, as bulges of few digits leave it, is a corner to the peg."""
    radius, quarter = 5.0 + excess, 1.0 - sqrt(2.0)
    angle = [
        [0, 0, 0],
        [60, 0, 0],
        [60, 20, 0],
        [20 + radius, 20, quarter],
        [20, 20 + radius, 0],
        [20, 60, 0],
        [0, 60, 0],
    ]
    part = Workpiece.from_loops("angle", [angle, [[40 - radius, 10, 1], [40 + radius, 10, 1]]])
    arcs = [f.segment for f in list_contact_features(part, 5.0) if isinstance(f.segment, Arc)]
    assert len(arcs) == 2 * count
    assert [arc.radius for arc in arcs] == pytest.approx([excess] * len(arcs), abs=1e-9)


@pytest.mark.parametrize(
    ("turn", "tangent"), [(0.0, True), (3e-6, True), (3e-5, False), (1e-3, False), (0.05, False)]
)
def test_a_joint_is_tangent_to_within_a_few_digits_of_a_bulge(turn, tangent):
    """A half disc whose flat side's neighbours meet the arc under ``turn`` radians. Up to 1e-5 is the rounding of a bulge,
    and a contact at the joint counts; from there on the joint is a corner, also one that the eye does not see."""
    half = Workpiece.from_loops(
        "half", [[[0, 0, 0], [30, 0, 0], [30, 10, tan(pi / 4 + turn / 2)], [0, 10, 0]]]
    )
    # Point pegs: their features end at the corners themselves.
    assert (measure_end_slacks(list_contact_features(half, 0.0)) > 0).any() == tangent
    with exactly():
        outline = BallOutline.from_workpiece(half)
    assert outline.find_smooth_ends(2, has_flat=False) == (tangent, tangent)


@pytest.mark.parametrize("bulge", [2e-6, -2.1e-6, 1e-5, -3e-4, 4e-3])
@pytest.mark.parametrize("aside", [(0.0, 0.0), (-30.3, 1234.7)])
def test_a_shallow_arc_stays_where_it_is_drawn_however_far_its_centre_is(
    bulge: float, aside: tuple[float, float]
) -> None:
    """The middle of each crowned edge, moved out by the peg radius, is on the feature in doubles and in balls: wherever the
    part is drawn, to the rounding of its own coordinates and not of a centre kilometres away."""
    corners = [(aside[0] + x, aside[1] + y) for x, y in ((0.0, 0.1), (61.3, 0.0), (58.9, 41.7), (-1.2, 39.3))]
    part = Workpiece.from_loops("crowned", [[[x, y, bulge] for x, y in corners]])
    problem = Problem.from_query(Query(part, Vise(pitch=10, columns=2, peg_radius=3)))
    size = 3e-14 * (100 + max(map(abs, aside)))
    for row, (x, y), (to_x, to_y) in zip(problem.rows, corners, corners[1:] + corners[:1], strict=True):
        dx, dy = to_x - x, to_y - y
        out = 3.0 / np.hypot(dx, dy)
        middle = ((x + to_x) / 2 + bulge * dy / 2 + out * dy, (y + to_y) / 2 - bulge * dx / 2 - out * dx)
        place = np.array(middle) - part.center
        assert measure_outline_distances(place[None], row[None])[0] < size
        with exactly():
            assert (
                abs(
                    compute_contact_value(
                        row.tolist(), measure_from_origin(row.tolist(), (arb(place[0]), arb(place[1])))
                    )
                )
                < size
            )


def test_the_axis_of_a_line_counts_with_its_length() -> None:
    """Rounding makes it other than 1, and the distance from the line is none the less in mm."""
    row = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 0.0, 1.0, 0.0, 0.0]
    assert compute_contact_value(row, measure_from_origin(row, (arb(1.0 + 4.0), arb(2.0 - 3.0)))).contains(5)
    assert compute_contact_value(row, measure_from_origin(row, (arb(1.0 - 8.0), arb(2.0 + 6.0)))).contains(
        -10
    )


@pytest.mark.parametrize(("margin", "beyond"), [(0.0, 0.0), (20.0, 20.0), (50.0, 43.0)])
def test_a_zone_may_be_touched_and_the_margin_counts_from_the_ends_of_the_uncut_feature(
    margin: float, beyond: float
) -> None:
    """A box cuts the feature of a side from 0 to 60 at 17 and 33: a peg may stand there if it is so far from 0 and 60."""
    square = Workpiece.from_loops("square", [[[0, 0, 0], [60, 0, 0], [60, 60, 0], [0, 60, 0]]])
    locus = list_contact_features(square, 3.0)
    box = polygon_zone([(20, -10), (30, -10), (30, -2), (20, -2)])
    left = find_allowed_features(locus, square, Restrictions(zones=(box,)), 3.0)
    slack = measure_end_slacks(left, margin, locus)[:2]
    assert slack[0, 1] == pytest.approx(beyond + 1e-9, abs=1e-11)
    assert slack[0, 0] == slack[1, 1] == (1e-9 if margin else -1e-9)
