"""Contact features lose the places where a tool comes too near, and no other."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from workhold.contact.features import ContactFeature, trim_to_clear_features
from workhold.contact.swept import SweptSpans
from workhold.contact.trimming import (
    LEAST_PART,
    find_covered_parts,
    find_line_most_in_the_way,
    subtract_covered_ranges,
)
from workhold.geometry.segment import Arc, Line, Segment, make_segment_from_bulge
from workhold.model.program import SweptPiece

BEYOND = 0.5


def piece(line: int, path: tuple[tuple[float, float, float], ...], radius: float) -> SweptPiece:
    """A piece of a flat cut."""
    return SweptPiece(line, 1, "cut", path, (0.0, 0.0), radius, (0.0, 10.0))


def random_case(seed: int) -> tuple[Segment, SweptSpans]:
    """A feature of any form among swept pieces of any form."""
    random, pieces = np.random.default_rng(seed), []
    for k in range(random.integers(1, 6)):
        x, y, to_x, to_y = random.uniform(-10, 10, 4).tolist()
        bulge = float(random.choice([0.0, random.uniform(-1, 1), 1e-3, -1.0, 3.0]))
        form = random.integers(4)
        path = ((x, y, bulge), (to_x, to_y, 0.0))
        if form == 0:
            path = ((x, y, 0.0),)
        if form == 1:
            path = ((x, y, 0.0), (to_x, y, 0.0), (to_x, to_y, 0.0), (x, to_y, 0.0), (x, y, 0.0))
        pieces.append(piece(k + 1, path, float(random.choice([0.2, 1.0, 2.0]))))
    start, end = (tuple(point) for point in random.uniform(-15, 15, (2, 2)).tolist())
    bulge = float(random.choice([0.0, 0.3, -0.9, 2.0, 1e-3, -1e-2]))
    feature: Segment = make_segment_from_bulge(start, end, bulge)
    if random.random() < 0.2:
        feature = Arc((1.0, -2.0), float(random.uniform(1, 9)), 1.0, pi, 1.0)
    return feature, SweptSpans.from_pieces(tuple(pieces))


def parameter_range(part: Segment, whole: Segment) -> tuple[float, float]:
    """Where a part of a segment begins and ends on it."""
    if isinstance(part, Arc) and isinstance(whole, Arc):
        middle = part.mid_angle - whole.mid_angle
    else:
        middle = whole.find_parameter(part.middle)
    return middle - part.half_extent, middle + part.half_extent


@pytest.mark.thinned(6)
@pytest.mark.parametrize("seed", range(60))
def test_what_is_left_is_what_a_walk_finds_clear(seed: int) -> None:
    feature, swept = random_case(seed)
    places = np.linspace(-feature.half_extent, feature.half_extent, 1501)
    points = np.array([feature.compute_point(place) for place in places])
    reach, _ = swept.find_nearest_spans(points, points)
    for x0, y0, x1, y1 in swept.filled:
        inside = (points[:, 0] > x0) & (points[:, 0] < x1) & (points[:, 1] > y0) & (points[:, 1] < y1)
        reach[inside] = -1.0
    kept = np.zeros(len(places), np.bool_)
    for part in subtract_covered_ranges(feature, find_covered_parts(feature, swept, BEYOND)[0]):
        low, high = parameter_range(part, feature)
        kept |= (places >= low - 1e-9) & (places <= high + 1e-9)
    marginal = np.abs(reach - BEYOND) < 1e-6
    assert ((reach >= BEYOND) == kept)[~marginal].all()


def test_a_place_exactly_at_the_distance_stays_and_the_feature_is_cut_from_the_whole_one() -> None:
    whole = ContactFeature(4, Line((0.0, 0.0), (20.0, 0.0)))
    swept = SweptSpans.from_pieces((piece(9, ((10.0, 3.0, 0.0),), 2.0),))
    (left, right) = trim_to_clear_features(whole, swept, 3.0)
    assert left.segment.end == pytest.approx((6.0, 0.0)) and right.segment.start == pytest.approx((14.0, 0.0))
    assert left.cut_from is whole.segment and right.face == 4
    assert trim_to_clear_features(whole, swept, 1.0) == [whole]


def test_a_sliver_between_two_passes_is_no_place() -> None:
    feature = Line((0.0, 0.0), (40.0, 0.0))
    passes = [piece(k, ((5.0 + k, 0.0, 0.0),), 0.5 - 1e-9) for k in range(31)]
    left = subtract_covered_ranges(
        feature, find_covered_parts(feature, SweptSpans.from_pieces(tuple(passes)), 0.0)[0]
    )
    assert [part.middle for part in left] == [pytest.approx((2.25, 0.0)), pytest.approx((37.75, 0.0))]
    assert LEAST_PART < 2e-6


def test_the_line_that_is_most_in_the_way_is_the_one_that_covers_most() -> None:
    features = [Line((0.0, 0.0), (20.0, 0.0))]
    swept = SweptSpans.from_pieces((piece(3, ((1.0, 0.0, 0.0),), 1.0), piece(5, ((12.0, 0.0, 0.0),), 4.0)))
    assert find_line_most_in_the_way(features, swept, 0.5) == 5
    assert find_line_most_in_the_way(features, SweptSpans.from_pieces(()), 0.5) is None
