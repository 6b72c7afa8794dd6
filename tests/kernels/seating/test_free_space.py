"""The directions in which a peg meets a piece, against rays that are cut with the piece one by one."""

from __future__ import annotations

from math import atan2, cos, hypot, inf, pi, sin, sqrt, tau
from typing import Any

import numpy as np
import pytest

from sharpness import changed
from workhold.kernels.seating import free_space, obstacles, two_contact_curves
from workhold.kernels.seating.free_space import find_free_direction

# Columns of a piece: arc, place, axis, half its extent, radius, sign.
LINE = np.array([0.0, 3.0, -2.0, 0.8, 0.6, 4.0, 0.0, 1.0, 0.0, 0.0])
ARC = (1.0, 3.0, -2.0, cos(2.0), sin(2.0))
ARCS = [np.array([*ARC, half, 5.0, sign, 0.0, 0.0]) for half in (0.4, 1.5, 2.6, pi) for sign in (1.0, -1.0)]
# Each with those before it in their Python form.
INNER: dict[str, Any] = {}
for module, names in (
    (obstacles, ("compute_length", "compute_angle_from_middle", "is_on_piece", "compute_normal")),
    (two_contact_curves, ("measure_gap",)),
    (
        free_space,
        (
            "add_range",
            "is_touched",
            "add_line",
            "compute_angle_from_outside",
            "compute_angle_from_inside",
            "add_side",
        ),
    ),
    (free_space, ("add_concave", "add_piece", "add_peg")),
):
    for name in names:
        INNER[name] = changed(getattr(module, name), **INNER)


def meets(row, x, y, angle):
    """Whether a ray from a point crosses a piece from its outer side to the part's."""
    wx, wy = cos(angle), sin(angle)
    _, cx, cy, ax, ay, half, radius, sign, *_ = row
    dx, dy = x - cx, y - cy
    if row[0] == 0.0:
        entering = wx * ay - wy * ax
        if entering >= 0.0:
            return False
        t = -(dx * ay - dy * ax) / entering
        return t > 0.0 and abs((dx + t * wx) * ax + (dy + t * wy) * ay) <= half
    middle = wx * dx + wy * dy
    square = middle * middle - dx * dx - dy * dy + radius * radius
    if square <= 0.0:
        return False
    # Into the circle of a convex arc, out of that of a concave one.
    t = -middle - sign * sqrt(square)
    px, py = dx + t * wx, dy + t * wy
    return t > 0.0 and (half >= pi or px * ax + py * ay >= radius * cos(half))


def is_within(angle, ranges):
    """Whether a direction is in one of some ranges, told with how far it is from the nearest end."""
    ahead = [(angle - low) % tau for low, _ in ranges]
    near = [min(abs((angle - end + pi) % tau - pi) for end in (low, low + sweep)) for low, sweep in ranges]
    return any(a < sweep for a, (_, sweep) in zip(ahead, ranges, strict=True)), min(near, default=inf)


@pytest.mark.thinned(2)
@pytest.mark.parametrize("row", [LINE, *ARCS])
def test_directions_that_meet_a_piece_are_its_ranges(row):
    rng, seen = np.random.default_rng(3), set()
    for x, y in rng.uniform(-9.0, 9.0, (60, 2)) + row[1:3]:
        if abs(hypot(x - row[1], y - row[2]) - row[6]) < 0.01:
            continue
        ranges = np.empty((free_space.RANGES, 2))
        told = ranges[: INNER["add_piece"](row, atan2(row[4], row[3]), x, y, ranges, 0)]
        for angle in rng.uniform(-pi, pi, 60):
            found, near = is_within(angle, told)
            assert near < 1e-6 or found == meets(row, x, y, angle), (x, y, angle, told)
            seen.add(found)
    assert seen == {True, False}


def test_a_peg_goes_along_what_it_touches_and_not_into_it():
    """Along a line, past which a corner is rolled around or another line goes on, and along a convex arc, but along no
    concave one."""
    corner = np.array([1.0, 4.0, 3.0, cos(-pi / 4.0), sin(-pi / 4.0), pi / 4.0, 3.0, 1.0, 0.0, 0.0])
    line = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 4.0, 0.0, 1.0, 0.0, 0.0])
    further = np.array([0.0, 8.0, 0.0, 1.0, 0.0, 4.0, 0.0, 1.0, 0.0, 0.0])
    cup = np.array([1.0, 0.0, 5.0, 0.0, -1.0, 1.0, 5.0, -1.0, 0.0, 0.0])
    for rows, x, y, free, met in (
        # The outer side of a line is on the right of its axis: below.
        ([line, corner], 1.0, 0.0, (0.0, pi, -1.0), (1e-3, 1.0, pi - 1e-3)),
        ([line, further], 1.0, -1e-10, (0.0, pi), (1e-3, 1.0)),
        ([line, corner], 1.0, 0.005, (0.0, pi), (1e-3, 1.0)),
        (
            [corner],
            4.0 + 3.0 * cos(-0.5),
            3.0 + 3.0 * sin(-0.5),
            (-0.5, -0.5 + pi / 2.0),
            (pi - 0.5, -0.5 + pi / 2.0 + 1e-3),
        ),
        ([cup], 0.0, 0.0, (pi / 2.0, 0.6), (0.0, pi, 0.4, -1.0)),
    ):
        ranges = np.empty((8, 2))
        axes = np.array([atan2(row[4], row[3]) for row in rows])
        count = INNER["add_peg"](x, y, np.array(rows), axes, 0, len(rows), ranges, 0)
        assert [is_within(angle, ranges[:count])[0] for angle in (*free, *met)] == [False] * len(free) + [
            True
        ] * len(met)


@pytest.mark.thorough
def test_what_ranges_leave_is_found():
    """And nothing where they leave nothing: against many directions."""
    rng, seen, left = np.random.default_rng(5), [], changed(find_free_direction)
    every = np.linspace(-pi, pi, 20_001)
    for _ in range(300):
        ranges = np.stack([rng.uniform(-9.0, 9.0, 12), rng.uniform(0.0, 2.4, 12)], axis=1)
        told = left(ranges, len(ranges))
        free = ~((every[:, None] - ranges[:, 0]) % tau < ranges[:, 1]).any(axis=1)
        seen.append(not np.isnan(told))
        if np.isnan(told):
            assert not free.any()
        else:
            ahead = (told - ranges[:, 0]) % tau
            assert not ((ahead > 1e-9) & (ahead < ranges[:, 1] - 1e-9)).any()
    assert 50 < sum(seen) < 250
    assert left(np.empty((0, 2)), 0) == 0.0
    # What is all around leaves nothing, wherever it is said to begin.
    assert np.isnan(left(np.array([[-3.0, 3.0], [0.0, tau]]), 2))
    # Two half turns leave the directions between them.
    assert left(np.array([[0.0, pi], [pi, pi]]), 2) % pi == pytest.approx(0.0, abs=1e-12)
