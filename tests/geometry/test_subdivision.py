"""The border of a union of shapes, found on the subdivision by their outlines, has the union's area."""

from __future__ import annotations

from collections.abc import Callable
from math import acos, hypot, pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from workhold.errors import InputError
from workhold.geometry.loop import compute_signed_area, make_loop_segments
from workhold.geometry.segment import Arc, Line, Point, Segment
from workhold.geometry.subdivision import (
    BorderPiece,
    Inside,
    find_border_pieces,
    join_border_loops,
    subdivide,
)

Box = tuple[float, float, float, float]
Circle = tuple[float, float, float]


def sides(box: Box) -> list[Segment]:
    """The four sides of a box (x0, y0, x1, y1)."""
    x0, y0, x1, y1 = box
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    return [Line(corners[k - 1], corners[k]) for k in range(4)]


def round_side(circle: Circle) -> Segment:
    """The outline of a circle (x, y, radius)."""
    x, y, radius = circle
    return Arc((x, y), radius, 0.3, pi, 1.0)


def each(inside: Callable[[Point], bool]) -> Inside:
    """A test of one point as one of many."""
    return lambda points: [inside(point) for point in points]


def area(loops: list[list[BorderPiece]]) -> float:
    """The area that loops enclose, holes taken away."""
    vertices = [np.array([(*piece.start, piece.bulge) for piece in loop]) for loop in loops]
    return sum(compute_signed_area(make_loop_segments(loop)) for loop in vertices)


def union_loops(boxes: list[Box], circles: list[Circle]) -> list[list[BorderPiece]]:
    """The border of the union of boxes and circles."""

    def inside(point: Point) -> bool:
        x, y = point
        return any(x0 < x < x1 and y0 < y < y1 for x0, y0, x1, y1 in boxes) or any(
            hypot(x - cx, y - cy) < radius for cx, cy, radius in circles
        )

    segments = [side for box in boxes for side in sides(box)] + [round_side(circle) for circle in circles]
    return join_border_loops(find_border_pieces(subdivide(segments), each(inside)))


WHOLE = st.integers(0, 12)


@given(st.lists(st.tuples(WHOLE, WHOLE, st.integers(1, 6), st.integers(1, 6)), min_size=1, max_size=6))
def test_boxes_of_whole_numbers(corners: list[tuple[int, int, int, int]]) -> None:
    """The area of a union of boxes on a grid is the number of cells that one of them holds.

    Sides overlap, and corners touch, in most of these.
    """
    boxes = [(float(x), float(y), float(x + w), float(y + h)) for x, y, w, h in corners]
    cells = {(a, b) for x, y, w, h in corners for a in range(x, x + w) for b in range(y, y + h)}
    assert area(union_loops(boxes, [])) == pytest.approx(len(cells), abs=1e-9)


@given(st.floats(0.3, 3.8), st.floats(0.5, 2.0), st.floats(0, 6))
def test_two_circles(apart: float, radius: float, turn: float) -> None:
    """Two circles cover the sum of their areas less that of the lens (Weisstein, "Circle-Circle Intersection")."""
    other = (apart * np.cos(turn), apart * np.sin(turn), 2.0)
    expected = pi * (radius**2 + 4.0)
    if apart <= 2.0 - radius:
        expected = 4.0 * pi
    elif apart < 2.0 + radius:
        a = radius**2 * acos((apart**2 + radius**2 - 4.0) / (2 * apart * radius))
        b = 4.0 * acos((apart**2 + 4.0 - radius**2) / (4 * apart))
        root = (-apart + radius + 2) * (apart + radius - 2) * (apart - radius + 2) * (apart + radius + 2)
        expected -= a + b - sqrt(max(root, 0.0)) / 2
    assert area(union_loops([], [(0.0, 0.0, radius), other])) == pytest.approx(expected, abs=2e-5)


def test_hole_and_touching_arcs() -> None:
    """A ring of four bars leaves a hole; a circle that touches a side from inside changes nothing."""
    bars: list[Box] = [(0, 0, 10, 2), (0, 8, 10, 10), (0, 0, 2, 10), (8, 0, 10, 10)]
    loops = union_loops(bars, [(1.0, 5.0, 1.0)])
    assert len(loops) == 2
    assert area(loops) == pytest.approx(64.0)


def test_corners_that_touch_stay_loops_of_their_own() -> None:
    """Two boxes that touch at a corner are two loops, and a hole that touches another is its own loop."""
    assert sorted(len(loop) for loop in union_loops([(0, 0, 4, 4), (4, 4, 8, 8)], [])) == [4, 4]


def test_equal_carriers_are_one() -> None:
    """Segments on one line, however they are run, are pieces of one carrier."""
    found = subdivide([Line((0, 0), (4, 0)), Line((6, 0), (2, 0)), Line((1, -1), (1, 1))])
    assert [len(carrier.list_covered_pieces()) for carrier in found] == [4, 2]


def test_carriers_are_cut_only_where_both_are_covered() -> None:
    """A line that ends before another cuts nothing of it, on either side."""
    found = subdivide([Line((0, 0), (10, 0)), Line((5, 3), (5, 9)), Arc((5, 0), 2, pi / 2, 0.5, 1.0)])
    assert [len(carrier.list_covered_pieces()) for carrier in found] == [1, 1, 1]


def test_pieces_of_rounding_are_left_out() -> None:
    """Between two cuts that lie as near to each other as rounding puts them, on a line and on a circle."""
    side, circle = Line((0, 0), (10, 0)), Arc((20, 0), 5, 0.0, pi, 1.0)
    cuts = [
        (one, one.compute_point(parameter)) for one in (side, circle) for parameter in (1.0, 1.0 + 4e-6 / 5)
    ]
    cuts.append((side, side.compute_point(1.0 + 5e-6)))
    assert [len(carrier.list_covered_pieces()) for carrier in subdivide([side, circle], cuts)] == [2, 2]


@pytest.mark.parametrize("chord", [6e-5, 2e-4])
def test_two_points_within_a_gap_are_one_in_the_middle(chord: float) -> None:
    """Where a circle reaches over a line by so little; two that are farther apart stay two."""
    circle = Arc((0, 0), 1, 0.0, pi, 1.0)
    height = sqrt(1 - chord**2 / 4)
    line, _ = subdivide([Line((-5, height), (5, height)), circle])
    ends = sorted(
        line.compute_point(position)[0] for piece in line.list_covered_pieces() for position in piece
    )
    assert len(ends) == (4 if chord < 1e-4 else 6)
    assert abs(ends[1]) == pytest.approx(0 if chord < 1e-4 else chord / 2, abs=2e-6)


@pytest.mark.parametrize("first", range(5))
def test_a_short_piece_of_a_border_is_not_passed_over(first: int) -> None:
    """Though the one behind it begins within a gap as well."""
    corners = [(0.0, 0.0), (10 - 5e-5, 0.0), (10.0, 5e-5), (10.0, 10.0), (0.0, 10.0)]
    segments = [Line(corners[k - 1], corners[k]) for k in range(5)]
    pieces = find_border_pieces(
        subdivide(segments),
        each(lambda at: 0 < at[0] < 10 and 0 < at[1] < 10 and at[0] - at[1] < 10 - 5e-5),
    )
    (loop,) = join_border_loops([*pieces[first:], *pieces[:first]])
    assert len(loop) == 5


def test_of_twins_the_outer_one_is_the_border() -> None:
    """A circle that reaches over the side of a box by less than its points are known: its cap is as thin."""
    over = 1e-6
    for turn in (0.0, 1.0, 2.5):
        box: list[Segment] = sides((-5, -5, 5, 1 - over))
        if turn:
            box = [
                Line(one.compute_point(-one.half_extent), one.compute_point(one.half_extent))
                for one in box[::-1]
            ]
        carriers = subdivide([*box, Arc((0, 0), 1, turn, pi, 1.0)])

        def inside(at: Point) -> bool:
            return (abs(at[0]) < 5 and -5 < at[1] < 1 - over) or hypot(*at) < 1

        (loop,) = join_border_loops(find_border_pieces(carriers, each(inside)))
        kinds = [type(piece.carrier.segment) for piece in loop]
        assert kinds.count(Arc) == 1 and len(loop) == 6
        assert all(
            abs(a.end[0] - b.start[0]) + abs(a.end[1] - b.start[1]) < 1e-5
            for a, b in zip(loop, [*loop[1:], loop[0]], strict=True)
        )


def test_border_that_does_not_close() -> None:
    """A border of which a piece is missing is refused with the place."""
    open_sides = sides((0, 0, 4, 4))[:3]
    pieces = find_border_pieces(subdivide(open_sides), each(lambda p: 0 < p[0] < 4 and 0 < p[1] < 4))
    with pytest.raises(InputError, match=r"the outline does not close at \("):
        join_border_loops(pieces)


@pytest.mark.parametrize("apart", [2e-5, 6e-5])
@pytest.mark.parametrize("side", range(4))
def test_cuts_beside_a_corner_leave_one_loop(side: int, apart: float) -> None:
    """Pieces shorter than the gaps that are closed are not loops, wherever they come first."""
    square = sides((0, 0, 4, 4))
    cut = square[side]
    points = [cut.compute_point(sign * (cut.half_extent - apart)) for sign in (-1.0, 1.0)]
    carriers = subdivide(square, [(cut, point) for point in points])
    pieces = find_border_pieces(carriers, each(lambda p: 0 < p[0] < 4 and 0 < p[1] < 4))
    assert len(pieces) == 6
    for first in range(6):
        loops = join_border_loops([*pieces[first:], *pieces[:first]])
        assert len(loops) == 1
        assert area(loops) == pytest.approx(16, abs=1e-3)


GAPS = [0.0, *(sign * 3.3 * 10.0**-power for power in range(3, 13) for sign in (1.0, -1.0))]


@pytest.mark.thinned(3)
@pytest.mark.parametrize("gap", GAPS)
@pytest.mark.parametrize("corners", [4, 6])
def test_a_circle_that_nearly_touches_a_polygon(corners: int, gap: float) -> None:
    """A circle inside, on, or just over the sides of a polygon, which are cut where it touches.

    Held against the circle less the caps beyond the sides (Weisstein, "Circular Segment").
    """
    apothem = 20.0
    radius, size = apothem + gap, apothem / np.cos(pi / corners)
    angles = [0.3 + 2 * pi * k / corners for k in range(corners)]
    points = [(7.0 + float(size * np.cos(a)), -3.0 + float(size * np.sin(a))) for a in angles]
    polygon: list[Segment] = [Line(points[k - 1], points[k]) for k in range(corners)]
    circle = Arc((7.0, -3.0), radius, 0.2, pi, 1.0)
    normals = [segment.compute_normal() for segment in polygon]

    def in_polygon(at: Point) -> bool:
        return all((at[0] - 7) * nx + (at[1] + 3) * ny < apothem for nx, ny in normals)

    def in_circle(at: Point) -> bool:
        return hypot(at[0] - 7, at[1] + 3) < radius

    half = acos(min(1.0, apothem / radius))
    caps = corners * radius**2 * (half - np.sin(half) * np.cos(half))
    of_polygon, of_circle = corners * apothem**2 * np.tan(pi / corners), pi * radius**2
    both = of_circle - caps
    carriers = subdivide([*polygon, circle], [(side, side.middle) for side in polygon])
    for inside, expected in (
        (in_polygon, of_polygon),
        (in_circle, of_circle),
        (lambda at: in_polygon(at) and in_circle(at), both),
        (lambda at: in_polygon(at) or in_circle(at), of_polygon + of_circle - both),
    ):
        loops = join_border_loops(find_border_pieces(carriers, each(inside)))
        assert len(loops) == 1
        assert area(loops) == pytest.approx(float(expected), abs=2e-4)
