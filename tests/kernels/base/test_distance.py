"""Distance and inside test of an outline against a slow computation on a fine polygon."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

from strategies import outlines, seeds
from workhold.geometry.segment import make_segment_rows
from workhold.kernels.base.distance import (
    is_inside,
    measure_outline_distance,
    measure_outline_distances,
    measure_segment_distance,
)

STEPS = 400


def polygon(segments) -> list[np.ndarray]:
    """Points along every segment, ends included, close enough that the chords are within 1e-3 mm of arcs."""
    return [
        np.array([s.compute_point(t) for t in np.linspace(-s.half_extent, s.half_extent, STEPS)])
        for s in segments
    ]


def distance_to_chains(point, chains) -> float:
    """Distance from a point to polylines, segment by segment."""
    best = np.inf
    for chain in chains:
        a, b = chain[:-1], chain[1:]
        along = np.einsum("ij,ij->i", point - a, b - a) / np.einsum("ij,ij->i", b - a, b - a)
        feet = a + np.clip(along, 0, 1)[:, None] * (b - a)
        best = min(best, np.hypot(*(feet - point).T).min())
    return best


def crossings_of_a_ray(point, chains) -> int:
    """How often a ray along +x from a point crosses polylines (Jordan: odd means inside)."""
    count = 0
    for chain in chains:
        a, b = chain[:-1], chain[1:]
        spans = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
        a, b = a[spans], b[spans]
        x = a[:, 0] + (point[1] - a[:, 1]) * (b - a)[:, 0] / (b - a)[:, 1]
        count += int((x > point[0]).sum())
    return count


@pytest.mark.thorough
@given(outlines(), seeds)
def test_distance_and_inside_agree_with_a_fine_polygon(part, seed):
    """min over segments is the distance to the outline (to the sagitta), and the winding test is the parity of a ray."""
    rows = make_segment_rows(part.segments)
    chains = polygon(part.segments)
    random = np.random.default_rng(seed)
    sagitta = max(
        (s.length**2 / STEPS**2 / 8 / max(getattr(s, "radius", 1e9), 1e-9) for s in part.segments), default=0
    )
    slack = 2 * sagitta + 1e-9
    points = random.uniform(-70, 70, (12, 2))
    distances = measure_outline_distances(points, rows)
    for point, distance in zip(points, distances, strict=True):
        assert abs(distance - distance_to_chains(point, chains)) <= slack
        assert distance == measure_outline_distance(*point, rows)
        if distance > 10 * slack:
            assert is_inside(*point, rows) == (crossings_of_a_ray(point, chains) % 2 == 1)


@settings(max_examples=40)
@given(outlines(holes=True))
def test_material_is_on_the_left_of_every_segment(part):
    """A step to the left of a segment's middle is inside, a step to the right is outside."""
    rows = make_segment_rows(part.segments)
    for segment in part.segments:
        (x, y), (nx, ny) = segment.compute_point(0.0), segment.compute_normal(0.0)
        step = 1e-4
        assert is_inside(x - step * nx, y - step * ny, rows)
        assert not is_inside(x + step * nx, y + step * ny, rows)


@pytest.mark.thorough
@settings(max_examples=40)
@given(outlines(), seeds)
def test_points_of_a_segment_have_distance_zero_and_offsets_their_offset(part, seed):
    """|at(t) + r n(t)| is at distance |r| from its own segment, for r short of an arc's centre."""
    random = np.random.default_rng(seed)
    for segment, row in zip(part.segments, make_segment_rows(part.segments), strict=True):
        t = random.uniform(-1, 1) * segment.half_extent
        limit = row[6] if row[0] else 9.0
        r = random.uniform(-1, 1) * limit
        (x, y), (nx, ny) = segment.compute_point(t), segment.compute_normal(t)
        assert abs(measure_segment_distance(x + r * nx, y + r * ny, row) - abs(r)) < 1e-9 * (1 + limit)
