"""Loose chains become loops: shuffled, reversed, with gaps, doubled, branching, open."""

from __future__ import annotations

import random
import re
from math import dist, hypot, pi, tan
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from reading_helpers import area, read_dxf, rectangle

from workhold.errors import InputError
from workhold.files.outline.chain import Chain, compute_moved_bulge
from workhold.files.outline.joining import close_pairs, group_by_pairs, join
from workhold.geometry.loop import compute_signed_area, make_loop_segments
from workhold.geometry.segment import Arc, make_segment_from_bulge


def exploded(rows: np.ndarray[Any, Any]) -> list[Chain]:
    """One chain for every segment of a loop."""
    ends = np.roll(rows, -1, axis=0)
    return [
        Chain(((a[0], a[1]), (b[0], b[1])), (a[2],), (f"SEGMENT {k}",))
        for k, (a, b) in enumerate(zip(rows.tolist(), ends.tolist(), strict=True))
    ]


def star(radii: list[float], bulges: list[float]) -> np.ndarray[Any, Any]:
    """A star-shaped loop: vertices at equal angles about the origin."""
    angles = np.arange(len(radii)) * 2 * pi / len(radii)
    return np.column_stack((np.array(radii) * np.cos(angles), np.array(radii) * np.sin(angles), bulges))


bulges = st.just(0.0) | st.floats(0.01, 0.3) | st.floats(-0.3, -0.01)
loops = st.integers(3, 12).flatmap(
    lambda n: st.tuples(
        st.lists(st.floats(10, 50), min_size=n, max_size=n), st.lists(bulges, min_size=n, max_size=n)
    )
)


@pytest.mark.thorough
@settings(max_examples=60, deadline=None)
@given(shape=loops, seed=st.integers(0, 10**6), gap=st.sampled_from([0.0, 1e-12, 1e-4]))
@example(shape=([10.0, 45.0, 10.0], [-0.25, -0.25, 0.0]), seed=0, gap=0.0)
def test_exploding_shuffling_and_joining_gives_the_loop_back(
    shape: tuple[list[float], list[float]], seed: int, gap: float
) -> None:
    """Area and number of segments survive; with gaps the area changes by no more than gap times perimeter.

    Hollow sides may cross where a corner is narrow, so either sense may be that of the greater area.
    """
    rows = star(*shape)
    randomly = random.Random(seed)
    chains = []
    for chain in exploded(rows):
        moved = tuple(
            (x + randomly.uniform(-gap, gap) / 3, y + randomly.uniform(-gap, gap) / 3)
            for x, y in chain.points
        )
        moved_chain = Chain(moved, chain.bulges, chain.labels)
        chains.append(moved_chain.reverse() if randomly.random() < 0.5 else moved_chain)
    randomly.shuffle(chains)
    joined = join(chains, 1e-3)
    assert len(joined.loops) == 1
    assert not joined.strays
    assert len(joined.loops[0].labels) == len(rows)
    expected = abs(compute_signed_area(make_loop_segments(rows)))
    assert abs(compute_signed_area(make_loop_segments(joined.loops[0].vertices))) == pytest.approx(
        expected, abs=1e-6 + 1500 * gap
    )
    assert bool(joined.remarks) == (gap > 1e-9)


def test_joints_keep_the_drawn_coordinates() -> None:
    """Ends that agree exactly are not moved by a single bit."""
    rows = star([10.1, 20.2, 30.3, 17.7], [0, 0.1, 0, -0.2])
    joined = join(exploded(rows), 1e-3)
    assert set(map(tuple, joined.loops[0].vertices[:, :2].tolist())) == set(map(tuple, rows[:, :2].tolist()))


@settings(max_examples=100, deadline=None)
@given(
    bulge=st.floats(-8, 8).filter(lambda b: abs(b) > 0.05),
    moves=st.lists(st.floats(-1e-4, 1e-4), min_size=4, max_size=4),
)
def test_moving_an_arcs_ends_moves_centre_and_radius_no_more(bulge: float, moves: list[float]) -> None:
    """Centre and radius change by the order of the movement (times centre distance over chord)."""
    start, end = (3.0, 4.0), (13.0, 9.0)
    new_start, new_end = (3.0 + moves[0], 4.0 + moves[1]), (13.0 + moves[2], 9.0 + moves[3])
    before = make_segment_from_bulge(start, end, bulge)
    after = make_segment_from_bulge(
        new_start, new_end, compute_moved_bulge(start, end, bulge, new_start, new_end)
    )
    assert isinstance(before, Arc)
    assert isinstance(after, Arc)
    movement = hypot(*moves)
    bound = 3 * movement * (1 + before.radius / dist(start, end)) + 1e-9
    assert dist(before.center, after.center) <= bound
    assert abs(before.radius - after.radius) <= bound
    assert before.sign == after.sign


def test_a_gap_is_closed_at_its_middle_and_reported(tmp_path: Any) -> None:
    """A 0.0008 mm gap closes with the default tolerance; both ends move to the mean point."""

    def draw(space: Any) -> None:
        space.add_line((0, 0), (40, 0))
        space.add_line((0, 20), (40, 20))
        space.add_line((0, 0), (0, 20))
        space.add_arc((40, 10.0008), 10, -90, 90)

    loaded = read_dxf(tmp_path, draw)
    assert area(loaded.workpiece) == pytest.approx(800 + 50 * pi, abs=0.02)
    assert "Closed 2 gaps between ends: 0.0008 mm at (40, " in loaded.remarks[0]
    assert any(y == pytest.approx(0.0004, abs=1e-12) for _, y in loaded.workpiece.loops[0][:, :2].tolist())
    arc = next(s for s in loaded.workpiece.segments if isinstance(s, Arc))
    # Both of its ends moved by half the gap in the same direction, so the circle moved as a whole.
    assert arc.radius == pytest.approx(10, abs=1e-7)
    assert arc.center == pytest.approx((40, 10.0004), abs=1e-7)


def test_the_tolerance_decides(tmp_path: Any) -> None:
    """A 0.05 mm gap is refused with both ends' places, and closes when the tolerance allows it."""

    def draw(space: Any) -> None:
        space.add_lwpolyline([(0, 0), (60, 0), (60, 40), (0, 40), (0, 0.05)])

    with pytest.raises(
        InputError,
        match=r"no outline is closed: LWPOLYLINE \w+ ends at \(0, 0\), 0.05 mm from the nearest other end.*"
        r"\(0, 0.05\).*give a larger join_tolerance, above 0.05",
    ):
        read_dxf(tmp_path, draw)
    loaded = read_dxf(tmp_path, draw, join_tolerance=0.06)
    assert area(loaded.workpiece) == pytest.approx(2400, abs=2)
    assert "Closed 1 gap between ends: 0.05 mm at (0, 0.025)" in loaded.remarks[0]


def test_many_gaps_are_counted_and_ten_named(tmp_path: Any) -> None:
    """Twelve gaps: ten places and a count."""

    def draw(space: Any) -> None:
        corners = [(10 * k, 0) for k in range(12)] + [(110, 50)]
        for p, q in zip(corners, corners[1:] + corners[:1], strict=True):
            space.add_line(p, (q[0], q[1] + 5e-4))

    loaded = read_dxf(tmp_path, draw)
    assert "Closed 13 gaps" in loaded.remarks[0]
    assert "and 3 more" in loaded.remarks[0]
    assert loaded.remarks[0].count("mm at") == 10


def test_a_large_tolerance_swallows_no_drawn_edges(tmp_path: Any) -> None:
    """Edges shorter than the tolerance stay when their ends agree exactly."""

    def draw(space: Any) -> None:
        corners = [(0, 0), (60, 0), (60, 39.9), (59.9, 40), (0, 40)]
        for p, q in zip(corners, corners[1:] + corners[:1], strict=True):
            space.add_line(p, q)

    loaded = read_dxf(tmp_path, draw, join_tolerance=1.0)
    assert len(loaded.workpiece.segments) == 5
    assert loaded.remarks == ()


def test_junctions_are_refused_with_place_and_entities(tmp_path: Any) -> None:
    """Three ends at one corner: which way the outline goes on is not for the program to say."""

    def draw(space: Any) -> None:
        rectangle(space)
        space.add_line((60, 40), (90, 40))

    with pytest.raises(InputError, match=r"3 ends meet at \(60, 40\) \(LINE \w+; LINE \w+; LINE \w+\)"):
        read_dxf(tmp_path, draw)

    def nearly(space: Any) -> None:
        rectangle(space)
        space.add_lwpolyline([(100, 0), (110, 0), (110, 9), (100.0004, 0)])
        space.add_line((100, 0.0003), (70, 3))

    # The rectangle beside it is sound.
    (said,) = [remark for remark in read_dxf(tmp_path, nearly).remarks if "ends meet" in remark]
    assert "3 ends meet within 0.001 mm at (100, " in said


def test_a_grid_of_lines_is_refused_at_once(tmp_path: Any) -> None:
    """Graph paper has no outline but thousands of loops; the first junction is named."""

    def draw(space: Any) -> None:
        for i in range(5):
            for j in range(4):
                space.add_line((i, j), (i, j + 1))
                space.add_line((j, i), (j + 1, i))

    with pytest.raises(InputError, match="ends meet at"):
        read_dxf(tmp_path, draw)


def test_what_is_drawn_twice_counts_once(tmp_path: Any) -> None:
    """Repeated lines (either way round), arcs, circles, polylines and lines over a polyline are dropped and reported."""

    def draw(space: Any) -> None:
        rectangle(space)
        space.add_line((60, 0), (0, 0))
        rectangle(space)
        space.add_lwpolyline([(0, 40), (0, 0), (60, 0), (60, 40)], close=True)
        for _ in range(3):
            space.add_circle((30, 20), 5)
        for _ in range(2):
            space.add_arc((10, 10), 4, 0, 180)
            space.add_line((6, 10), (14, 10))

    loaded = read_dxf(tmp_path, draw)
    assert area(loaded.workpiece) == pytest.approx(2400 - 25 * pi - 8 * pi)
    assert "Left out 10 entities drawn twice" in loaded.remarks[0]
    assert " repeats LINE " in loaded.remarks[0]


def test_a_line_and_an_arc_between_the_same_ends_are_no_repeats(tmp_path: Any) -> None:
    """A half disc is a loop of two segments."""

    def draw(space: Any) -> None:
        space.add_arc((0, 0), 10, 0, 180)
        space.add_line((-10, 0), (10, 0))

    assert area(read_dxf(tmp_path, draw).workpiece) == pytest.approx(50 * pi)


def test_strays_are_left_out_with_a_remark(tmp_path: Any) -> None:
    """A centre line across the part stays out of the outline."""

    def draw(space: Any) -> None:
        rectangle(space)
        space.add_line((-5, 20), (65, 20))

    loaded = read_dxf(tmp_path, draw)
    assert area(loaded.workpiece) == pytest.approx(2400)
    assert "Left out 1 open piece outside any closed outline: LINE" in loaded.remarks[0]
    assert "(-5, 20)" in loaded.remarks[0]


def test_a_hole_is_never_taken_for_a_part_whose_outline_is_open(tmp_path: Any) -> None:
    """An outline with a 0.05 mm gap around a closed hole: refused, unless the inner part is asked for."""

    def draw(space: Any) -> None:
        space.add_lwpolyline([(0, 0), (60, 0), (60, 40), (0, 40), (0, 0.05)])
        space.add_circle((30, 20), 5)

    with pytest.raises(InputError, match=r"the outline around part 1 .*is not closed: LWPOLYLINE .*0\.05 mm"):
        read_dxf(tmp_path, draw)
    assert area(read_dxf(tmp_path, draw, part_number=1).workpiece) == pytest.approx(25 * pi)


@pytest.mark.parametrize(("gap", "rest"), [(0.05, 0.0), (0.4, 0.02)])
def test_a_hole_is_never_taken_for_a_part_whose_outline_has_several_gaps(
    gap: float, rest: float, tmp_path: Any
) -> None:
    """Lines that each stop short, and an arc around the hole: the gap that the sentence names closes them all."""

    def draw(space: Any) -> None:
        space.add_line((0, 0), (60 - gap, 0))
        space.add_arc((60, 20), 20, -90, 90)
        space.add_line((60, 40), (rest, 40))
        space.add_line((0, 40), (0, rest))
        space.add_circle((65, 20), 12)
        space.add_line((-30, 20), (120, 20))

    with pytest.raises(
        InputError, match=r"the outline around part 1 .*is not closed: .*part_number 1\."
    ) as refused:
        read_dxf(tmp_path, draw)
    enough = float(re.findall(r"above ([\d.]+) mm", str(refused.value))[0])
    assert gap <= enough < 1.1 * gap
    assert area(read_dxf(tmp_path, draw, join_tolerance=enough).workpiece) == pytest.approx(
        2400 + 200 * pi - 144 * pi, abs=60 * gap
    )
    assert area(read_dxf(tmp_path, draw, part_number=1).workpiece) == pytest.approx(144 * pi)


@pytest.mark.parametrize(
    "lines",
    [
        [((-9, -9), (39, -9)), ((39, 34), (-9, 34)), ((-9, 30), (-9, -5)), ((39, -5), (39, 30))],
        [((40, 0), (60, 0)), ((60, 0.5), (50, 20)), ((50, 20.5), (40, 0.5))],
    ],
    ids=["too far apart", "around nothing"],
)
def test_loose_lines_are_no_outline_around_a_part(lines: Any, tmp_path: Any) -> None:
    """A frame whose lines are far from each other, and lines that nearly close beside the part."""

    def draw(space: Any) -> None:
        rectangle(space, w=30, h=25)
        for line in lines:
            space.add_line(*line)

    assert area(read_dxf(tmp_path, draw).workpiece) == pytest.approx(750)


def test_a_crowd_of_ends_asks_for_a_smaller_tolerance(tmp_path: Any) -> None:
    """When a tolerance spans dozens of ends it cannot be meant."""

    def draw(space: Any) -> None:
        for k in range(100):
            space.add_line((0, k * 0.01), (50 + k, k * 3))

    with pytest.raises(InputError, match="smaller join_tolerance"):
        read_dxf(tmp_path, draw, join_tolerance=5)


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 10**6), count=st.integers(0, 60), tolerance=st.sampled_from([0.1, 0.5, 1.0]))
def test_close_pairs_are_those_of_brute_force(seed: int, count: int, tolerance: float) -> None:
    """All pairs of distinct points within the tolerance, none else; equal points end up in one group."""
    points = np.round(np.random.default_rng(seed).uniform(-2, 2, (count, 2)), 1)
    pairs = {tuple(pair) for pair in close_pairs(points, tolerance).tolist()}
    for i in range(count):
        for j in range(i + 1, count):
            apart = hypot(*(points[i] - points[j]))
            if apart > 0 and (i, j) in pairs:
                assert apart <= tolerance
    group = group_by_pairs(count, close_pairs(points, tolerance))
    for i in range(count):
        for j in range(i + 1, count):
            if hypot(*(points[i] - points[j])) <= tolerance - 1e-9:
                assert group[i] == group[j]


@pytest.mark.thorough
def test_two_hundred_thousand_ends_pair_quickly() -> None:
    """Near-linear time: a column of points with equal x must not be compared all with all."""
    points = np.column_stack((np.zeros(200_000), np.arange(200_000) * 1.0))
    points = np.concatenate((points, points + 1e-4))
    assert len(close_pairs(points, 1e-3)) == 200_000


def test_bulge_of_a_quarter() -> None:
    """The helper's own ground: an unmoved arc keeps its bulge, tan(sweep / 4)."""
    quarter = tan(pi / 8)
    assert compute_moved_bulge((1, 0), (0, 1), quarter, (1, 0), (0, 1)) == pytest.approx(quarter, rel=1e-14)


@pytest.mark.parametrize("backwards", [False, True])
def test_an_arc_shifted_as_a_whole_shifts_back_by_half(tmp_path: Any, backwards: bool) -> None:
    """A corner radius drawn 0.0006 mm off in x and y keeps its radius, and its centre moves by half of that."""

    def draw(space: Any) -> None:
        space.add_lwpolyline([(40, 10), (40, 30), (0, 30), (0, 0), (30, 0)][:: -1 if backwards else 1])
        space.add_arc((30.0006, 10.0006), 10, -90, 0)

    part = read_dxf(tmp_path, draw).workpiece
    arc = next(s for s in part.segments if isinstance(s, Arc))
    assert arc.radius == pytest.approx(10, abs=1e-7)
    assert arc.center == pytest.approx((30.0003, 10.0003), abs=1e-7)


@pytest.mark.parametrize(("times", "closes"), [(2.0, False), (2.9, False), (3.1, True), (10.0, True)])
def test_a_chain_closes_on_itself_only_over_a_gap_much_shorter_than_it_is(times: float, closes: bool) -> None:
    """A triangle open at a corner, its sides together 2 to 10 times as long as the opening, within the tolerance: a chain
    less than three times as long as its opening is a hook that somebody drew, and stays open."""
    gap = 0.5
    height = gap / 2 * (times * times - 1) ** 0.5
    hook = Chain(
        ((0.0, 0.0), (gap / 2, height), (gap, 0.0)), (0.0, 0.2), ("HOOK segment 0", "HOOK segment 1")
    )
    joined = join([hook], 2 * gap)
    assert (len(joined.loops), len(joined.strays)) == ((1, 0) if closes else (0, 1))
