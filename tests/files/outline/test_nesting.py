"""Closed loops become parts: outer loops, holes, islands; which part is chosen, and what is said."""

from __future__ import annotations

from math import pi
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from reading_helpers import area, read_dxf, read_svg, rectangle

from workhold.errors import InputError

PAGE = 'width="200mm" height="200mm" viewBox="-100 -100 200 200"'


@pytest.mark.thorough
@settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(depth=st.integers(1, 9), order=st.randoms(use_true_random=False))
def test_concentric_circles_alternate(tmp_path: Path, depth: int, order: Any) -> None:
    """Rings 1, 2 ... n: every second pair is a part, an outer loop with one hole, area pi (R² - r²)."""
    radii = [2.0 * k + 1 for k in range(depth)]
    rings = [f'<circle cx="3" cy="4" r="{radius}"/>' for radius in radii]
    order.shuffle(rings)
    parts = read_svg(tmp_path, "".join(rings), PAGE).parts
    outer = radii[::-1][::2]
    inner = [*radii[::-1][1::2], 0.0][: len(outer)]
    expected = sorted((pi * (R * R - r * r) for R, r in zip(outer, inner, strict=True)), reverse=True)
    assert [part.area for part in parts] == pytest.approx(expected)
    assert [part.number for part in parts] == list(range(1, len(parts) + 1))


def test_holes_belong_to_the_loop_around_them(tmp_path: Path) -> None:
    """Two plates side by side, each with its own holes."""

    def draw(space: Any) -> None:
        for x, radius in ((0, 10), (3, 1), (-3, 1), (50, 8), (52, 2)):
            space.add_circle((x, 0), radius)

    parts = read_dxf(tmp_path, draw).parts
    assert [len(part.loops) for part in parts] == [3, 2]
    assert str(parts[1]) == "part 2 is 16 x 16 mm at (42, -8) with 1 hole"


def several(space: Any) -> None:
    """A plate with a hole, in the hole an island with a hole of its own, and a small plate beside it."""
    rectangle(space)
    space.add_circle((30, 20), 15)
    space.add_circle((30, 20), 10)
    space.add_circle((30, 20), 3)
    rectangle(space, 100, 0, 9, 9)


def test_the_largest_part_is_used_and_named(tmp_path: Path) -> None:
    """Parts are numbered by decreasing area; the remark lists them all with size and place."""
    loaded = read_dxf(tmp_path, several)
    assert area(loaded.workpiece) == pytest.approx(2400 - 225 * pi)
    assert loaded.remarks == (
        "The file holds 3 separate parts: part 1 is 60 x 40 mm at (0, 0) with 1 hole; part 2 is 20 x 20 mm at (20, 10) "
        "with 1 hole; part 3 is 9 x 9 mm at (100, 0) with no holes. Part 1 is used, the largest (choose another with "
        "part_number).",
    )
    assert [part.area for part in loaded.parts] == pytest.approx([2400 - 225 * pi, 91 * pi, 81])


def test_a_part_can_be_chosen(tmp_path: Path) -> None:
    """``part_number`` counts from 1; other numbers are refused."""
    assert area(read_dxf(tmp_path, several, part_number=2).workpiece) == pytest.approx(91 * pi)
    assert area(read_dxf(tmp_path, several, part_number=3).workpiece) == pytest.approx(81)
    for number in (0, 4, -1):
        with pytest.raises(InputError, match=rf"no part {number}: the file holds parts 1 to 3"):
            read_dxf(tmp_path, several, part_number=number)


def test_a_loop_across_the_outline_is_refused(tmp_path: Path) -> None:
    """A hole drawn half outside is not a separate part to be left out in silence."""

    def draw(space: Any) -> None:
        rectangle(space)
        space.add_circle((62, 20), 5)

    with pytest.raises(InputError, match=r"LINE \w+ and CIRCLE \w+ cross or touch at \(60, "):
        read_dxf(tmp_path, draw)


def test_touching_holes_are_refused_by_entity(tmp_path: Path) -> None:
    """Two holes that cross are named by their handles."""

    def draw(space: Any) -> None:
        rectangle(space)
        space.add_circle((20, 20), 5)
        space.add_circle((28, 20), 5)

    with pytest.raises(InputError, match=r"\(CIRCLE \w+\) and .*\(CIRCLE \w+\) cross or touch"):
        read_dxf(tmp_path, draw)


def test_an_outline_that_hangs_at_a_corner_of_another_is_a_part_beside_it(tmp_path: Path) -> None:
    """All its lines border both, so it is not a hole of the other: half of 30 x 30 - 10 x 20 mm² can be chosen."""

    def draw(space: Any) -> None:
        for corners in ([(0, 0), (80, 0), (80, 50), (0, 50)], [(80, 50), (50, 40), (60, 20)]):
            for start, end in zip(corners, corners[1:] + corners[:1], strict=True):
                space.add_line(start, end)

    chosen = read_dxf(tmp_path, draw, part_number=2)
    assert [len(part.loops) for part in chosen.parts] == [1, 1]
    assert area(chosen.workpiece) == pytest.approx(350)


def test_trouble_in_other_parts_does_not_matter(tmp_path: Path) -> None:
    """Only the chosen part's loops are checked."""

    def draw(space: Any) -> None:
        rectangle(space)
        space.add_lwpolyline([(100, 0), (120, 20), (120, 0), (100, 30)], close=True)

    assert area(read_dxf(tmp_path, draw).workpiece) == pytest.approx(2400)


def test_too_many_segments_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A scan of short chords is refused before anything slow begins."""
    monkeypatch.setattr("workhold.files.part.loaded.MOST_SEGMENTS", 3)
    with pytest.raises(InputError, match="the part has 4 segments, more than the 3"):
        read_dxf(tmp_path, rectangle)
