"""Trimmed offsets: exactly the points at distance r that face a segment."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strategies import outlines
from workhold import Workpiece
from workhold.geometry.offset import list_trimmed_offsets, offset_segment
from workhold.geometry.segment import Arc, make_segment_rows
from workhold.kernels.base.distance import is_inside, measure_outline_distances

radii = st.one_of(st.sampled_from([0.0, 1.0, 3.0]), st.floats(0.05, 12.0).map(lambda r: round(r, 3)))


def points_of(segment, count: int) -> np.ndarray:
    """Points all along a segment, ends included."""
    return np.array([segment.compute_point(t) for t in np.linspace(-1, 1, count) * segment.half_extent])


@pytest.mark.thorough
@settings(max_examples=120)
@given(outlines(), radii)
def test_every_kept_point_is_at_exactly_the_radius(part, radius):
    """dist(p, outline) = r to 1e-9 for p on a kept piece, and p is outside the material."""
    segments = [face.segment for face in part.faces]
    rows = make_segment_rows(segments)
    for _, piece in list_trimmed_offsets(segments, radius):
        points = points_of(piece, 25)
        assert np.abs(measure_outline_distances(points, rows) - radius).max() < 2e-9
        if radius > 1e-3:
            assert not any(is_inside(x, y, rows) for x, y in points)


@pytest.mark.thorough
@settings(max_examples=120)
@given(outlines(), radii)
def test_every_point_at_the_radius_is_kept(part, radius):
    """A point of a raw offset that is no nearer than r to the outline lies on a kept piece of the same face."""
    segments = [face.segment for face in part.faces]
    rows = make_segment_rows(segments)
    kept = list_trimmed_offsets(segments, radius)
    for index, segment in enumerate(segments):
        raw = offset_segment(segment, radius)
        if raw is None:
            continue
        parameters = np.linspace(-0.9999, 0.9999, 60) * raw.half_extent
        points = np.array([raw.compute_point(t) for t in parameters])
        clear = measure_outline_distances(points, rows) >= radius - 1e-10
        pieces = [piece for k, piece in kept if k == index]
        for point in points[clear]:
            scale = 1.0 if not isinstance(raw, Arc) else raw.radius
            past = [(abs(p.find_parameter(tuple(point))) - p.half_extent) * scale for p in pieces]
            assert past and min(past) < 1e-6, (part.loops, radius, point)


@pytest.mark.thorough
@settings(max_examples=60)
@given(outlines())
def test_a_point_peg_sees_every_face_whole(part):
    """With r = 0 the trimmed offset is the outline itself."""
    segments = [face.segment for face in part.faces]
    kept = list_trimmed_offsets(segments, 0.0)
    assert [k for k, _ in kept] == list(range(len(segments)))
    for (_, piece), segment in zip(kept, segments, strict=True):
        assert piece.length == pytest.approx(segment.length, abs=1e-6)


def test_a_concave_arc_as_small_as_the_peg_vanishes():
    """A round notch of radius 4 leaves an arc of radius 4 - r, and nothing from r = 4 on."""
    notched = [[0, 0, 0], [60, 0, 0], [60, 30, 0], [34, 30, -1], [26, 30, 0], [0, 30, 0]]
    segments = Workpiece.from_loops("notched", [notched]).segments
    for radius in (0.0, 1.0, 3.9):
        arcs = [piece for _, piece in list_trimmed_offsets(segments, radius) if isinstance(piece, Arc)]
        assert len(arcs) == 1 and arcs[0].radius == pytest.approx(4 - radius) and arcs[0].sign == -1.0
    for radius in (4.0, 4.1, 9.0):
        assert not any(isinstance(piece, Arc) for _, piece in list_trimmed_offsets(segments, radius))


def test_a_boss_near_a_long_edge_splits_its_offset():
    """A tooth that leans over a long face hides the middle of it: the face leaves two features, ends where known.

    The face is y = 0 from x = 0 to 100 (material below); a beam above it carries a tooth down to y = 4 between x = 45
    and x = 55. A disc of radius 3 on the face keeps |x - 50| >= 5 + sqrt(3^2 - (4 - 3)^2).
    """
    outline = [
        [0, 0, 0], [0, -20, 0], [130, -20, 0], [130, 40, 0], [0, 40, 0], [0, 30, 0], [45, 30, 0], [45, 4, 0],
        [55, 4, 0], [55, 30, 0], [100, 30, 0], [100, 0, 0],
    ]  # fmt: skip
    part = Workpiece.from_loops("tooth", [outline])
    floor = next(k for k, s in enumerate(part.segments) if {s.start, s.end} == {(0.0, 0.0), (100.0, 0.0)})
    pieces = [piece for k, piece in list_trimmed_offsets(part.segments, 3.0) if k == floor]
    reach = 5 + 8**0.5
    spans = sorted(tuple(sorted((p.start[0], p.end[0]))) for p in pieces)
    assert np.array(spans) == pytest.approx(np.array([[0, 50 - reach], [50 + reach, 97]]))


def test_inner_corners_cut_and_outer_corners_do_not():
    """In an L the two faces of the inner corner lose r each; all others keep their length."""
    part = Workpiece.from_loops(
        "L", [[[0, 0, 0], [40, 0, 0], [40, 20, 0], [20, 20, 0], [20, 50, 0], [0, 50, 0]]]
    )
    lengths = {k: piece.length for k, piece in list_trimmed_offsets(part.segments, 3.0)}
    assert lengths == pytest.approx({0: 40, 1: 20, 2: 17, 3: 27, 4: 20, 5: 50})


def test_a_slot_as_narrow_as_the_peg_hides_its_walls():
    """Walls 6 apart leave features for r < 3 and none for r > 3."""
    slot = [
        [0, 0, 0],
        [60, 0, 0],
        [60, 40, 0],
        [33, 40, 0],
        [33, 10, 0],
        [27, 10, 0],
        [27, 40, 0],
        [0, 40, 0],
    ]
    part = Workpiece.from_loops("slot", [slot])
    assert {k for k, _ in list_trimmed_offsets(part.segments, 2.9)} == set(range(8))
    assert {k for k, _ in list_trimmed_offsets(part.segments, 3.1)} == {0, 1, 2, 6, 7}
