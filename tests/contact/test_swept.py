"""What a program sweeps: the nearest piece is that of looking at all of them, one by one."""

from __future__ import annotations

from math import cos, hypot, inf, sin

import numpy as np
import pytest

from workhold.contact.swept import SweptSpans, bound_spans, make_span_rows
from workhold.geometry.segment import (
    Segment,
    compute_bounding_box,
    make_segment_from_bulge,
    measure_distance_to_segment,
)
from workhold.model.program import PathVertex, SweptPiece


def piece(line: int, path: tuple[PathVertex, ...], radius: float) -> SweptPiece:
    """A piece of a flat cut."""
    return SweptPiece(line, 1, "cut", path, (0.0, 0.0), radius, (0.0, 10.0))


def random_pieces(seed: int, count: int, reach: float = 40.0) -> list[SweptPiece]:
    """Points, segments and arcs, shallow ones and more than half circles among them."""
    random, out = np.random.default_rng(seed), []
    for k in range(count):
        x, y, to_x, to_y = random.uniform(-reach, reach, 4).tolist()
        bulge = random.choice([0.0, random.uniform(-1, 1), 1e-4, -2e-3, 1.0, 3.0])
        path = ((x, y, float(bulge)), (to_x, to_y, 0.0)) if k % 5 else ((x, y, 0.0),)
        out.append(piece(k + 1, path, float(random.choice([0.5, 1.0, 3.0]))))
    return out


def segment_of(one: SweptPiece) -> Segment | None:
    """The segment of a piece's path; None of a point."""
    if len(one.path) == 1:
        return None
    (x, y, bulge), (to_x, to_y, _) = one.path
    return make_segment_from_bulge((x, y), (to_x, to_y), bulge)


def slow_reach(pieces: list[SweptPiece], x: float, y: float) -> float:
    """The least distance less radius from a point to all pieces."""
    out = inf
    for one in pieces:
        segment = segment_of(one)
        px, py, _ = one.path[0]
        off = hypot(x - px, y - py) if segment is None else measure_distance_to_segment((x, y), segment)
        out = min(out, off - one.radius)
    return out


@pytest.mark.thinned(4)
@pytest.mark.parametrize("count", [0, 1, 3, 4, 5, 9, 200])
def test_the_nearest_piece_is_that_of_all(count: int) -> None:
    pieces = random_pieces(count, count)
    swept = SweptSpans.from_pieces(tuple(pieces))
    points = np.random.default_rng(7).uniform(-60, 60, (60, 2))
    least, which = swept.find_nearest_spans(points, points)
    for (x, y), reach, number in zip(points.tolist(), least.tolist(), which.tolist(), strict=True):
        assert reach == pytest.approx(slow_reach(pieces, x, y), abs=1e-9)
        if count:
            named = [one for one in pieces if one.line == swept.line[number]]
            assert slow_reach(named, x, y) == pytest.approx(reach, abs=1e-9)


def test_a_capsule_is_as_near_as_the_nearest_of_its_points() -> None:
    pieces = random_pieces(3, 30)
    swept, random = SweptSpans.from_pieces(tuple(pieces)), np.random.default_rng(1)
    for _ in range(20):
        start, end = random.uniform(-60, 60, (2, 2))
        end = start + (end - start) / 8
        along = start + np.linspace(0, 1, 4001)[:, None] * (end - start)
        reach = float(swept.find_nearest_spans(start[None], end[None])[0][0])
        points = float(swept.find_nearest_spans(along, along)[0].min())
        # Where it crosses a path, the walk may pass the place by half a step.
        assert reach <= points + 1e-9 and points - reach < np.hypot(*(end - start)) / 8000 + 1e-9


@pytest.mark.thorough
def test_the_least_height_over_a_line_is_that_of_a_walk() -> None:
    pieces = random_pieces(4, 25)
    swept = SweptSpans.from_pieces(tuple(pieces))
    for theta, height in ((0.0, -70.0), (0.4, -60.0), (2.5, -55.0), (4.0, 0.0), (5.5, -80.0)):
        walked = inf
        for one in pieces:
            segment = segment_of(one)
            half = 0.0 if segment is None else segment.half_extent
            places = (
                [one.path[0][:2]]
                if segment is None
                else map(segment.compute_point, np.linspace(-half, half, 2001))
            )
            low = min(sin(theta) * x + cos(theta) * y for x, y in places)
            walked = min(walked, max(low - height, 0.0) - one.radius)
        reach, number = swept.find_reach_below_line(theta, height)
        assert reach <= walked + 1e-9 and walked - reach < 1e-3 and swept.line[number] > 0


def test_rows_and_boxes_of_spans_are_those_of_segments() -> None:
    pieces = [one for one in random_pieces(5, 100) if len(one.path) > 1]
    spans = np.array([(*one.path[0][:2], *one.path[1][:2], one.path[0][2], one.radius) for one in pieces])
    rows = make_span_rows(spans)
    for row, box, one in zip(rows, bound_spans(rows), pieces, strict=True):
        segment = segment_of(one)
        assert segment is not None
        np.testing.assert_allclose(
            row[[0, 3, 4, 5, 6, 7]], np.array(segment.to_row())[[0, 3, 4, 5, 6, 7]], atol=1e-8
        )
        x0, y0, x1, y1 = compute_bounding_box(segment)
        assert (box[:2] <= [x0 + 1e-9, y0 + 1e-9]).all() and (box[2:] >= [x1 - 1e-9, y1 - 1e-9]).all()
        np.testing.assert_allclose(box, [x0, y0, x1, y1], atol=1e-6)


def test_of_one_path_the_largest_radius_counts_whichever_way_it_is_run() -> None:
    there, back = ((0.0, 0.0, 0.5), (9.0, 0.0, 0.0)), ((9.0, 0.0, -0.5), (0.0, 0.0, 0.0))
    swept = SweptSpans.from_pieces((piece(1, there, 1.0), piece(2, back, 4.0), piece(3, there, 4.0)))
    assert len(swept) == 1 and swept.find_nearest_spans(np.zeros((1, 2)), np.zeros((1, 2)))[0][0] == -4.0
    assert swept.line[swept.line > 0].tolist() == [2]


def test_a_shallow_arc_keeps_its_sagitta() -> None:
    # 60 mm with a sagitta of 0.01 mm: the centre is 45 m away.
    path = ((-30.0, 0.0, 0.01 / 30.0), (30.0, 0.0, 0.0))
    swept = SweptSpans.from_pieces((piece(1, path, 2.0),))
    at = np.array([[0.0, 5.0]])
    assert swept.find_nearest_spans(at, at)[0][0] == pytest.approx(5.01 - 2.0, abs=1e-12)
