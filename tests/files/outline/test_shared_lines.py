"""Drawings as people have them: neighbours that share a cut, lines drawn on each other, bad spots beside sound parts."""

from __future__ import annotations

from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any
from unittest.mock import patch

import pytest
from reading_helpers import area, read_dxf, rectangle

from workhold.errors import InputError
from workhold.files.budget import UNLIMITED, Budget
from workhold.files.outline.chain import Chain, Drawing
from workhold.files.outline.shared_lines import make_outlines, run_along_each_other
from workhold.files.part.load import read_workpiece
from workhold.geometry.segment import Line, make_segment_from_bulge


def sizes(loaded: Any) -> list[tuple[float, float, int]]:
    """Width, height and number of holes of each part."""
    return [
        (round(p.bounds[2] - p.bounds[0], 6), round(p.bounds[3] - p.bounds[1], 6), len(p.loops) - 1)
        for p in loaded.parts
    ]


def add_neighbour(space: Any, x: float, w: float, h: float = 50) -> None:
    """Three sides at the right of a line that is there."""
    for start, end in (((x, 0), (x + w, 0)), ((x + w, 0), (x + w, h)), ((x + w, h), (x, h))):
        space.add_line(start, end)


def test_neighbours_share_a_cut(tmp_path: Path) -> None:
    """A row of three parts with two common cuts, holes in two of them: each is a part, and the cuts are named."""

    def draw(space: Any) -> None:
        rectangle(space, 0, 0, 80, 50)
        add_neighbour(space, 80, 60)
        add_neighbour(space, 140, 40)
        space.add_circle((20, 20), 5)
        space.add_circle((110, 20), 4)

    loaded = read_dxf(tmp_path, draw)
    assert sizes(loaded) == [(80, 50, 1), (60, 50, 1), (40, 50, 0)]
    assert len(loaded.workpiece.faces) == 5
    assert (
        "3 outlines that share lines" in loaded.remarks[0] and "from (80, 0) to (80, 50)" in loaded.remarks[0]
    )
    assert area(read_dxf(tmp_path, draw, part_number=3).workpiece) == pytest.approx(2000)


def test_a_cut_may_end_in_the_middle_of_another(tmp_path: Path) -> None:
    """A long part over two short ones: its lower side is one line, on which the cut between them ends."""

    def draw(space: Any) -> None:
        rectangle(space, 0, 50, 140, 40)
        for start, end in (
            ((0, 50), (0, 0)),
            ((0, 0), (140, 0)),
            ((140, 0), (140, 50)),
            ((80, 0), (80, 50)),
        ):
            space.add_line(start, end)

    loaded = read_dxf(tmp_path, draw)
    assert sizes(loaded) == [(140, 40, 0), (80, 50, 0), (60, 50, 0)]
    assert len(loaded.workpiece.faces) == 4


def test_a_grid_of_cuts_is_many_parts(tmp_path: Path) -> None:
    """Six by six parts with a hole in each."""

    def draw(space: Any) -> None:
        for i in range(7):
            for j in range(6):
                space.add_line((30 * j, 20 * i), (30 * j + 30, 20 * i))
                space.add_line((30 * i, 20 * j), (30 * i, 20 * j + 20))
                if i < 6:
                    space.add_circle((30 * i + 15, 20 * j + 10), 4)

    assert sizes(read_dxf(tmp_path, draw)) == [(30, 20, 1)] * 36


def test_closed_outlines_may_lie_along_each_other(tmp_path: Path) -> None:
    """The shared side is drawn twice, once with each part; a part in the notch of another is none of its holes."""

    def draw(space: Any) -> None:
        space.add_lwpolyline([(0, 0), (100, 0), (100, 30), (40, 30), (40, 80), (0, 80)], close=True)
        space.add_lwpolyline([(40, 30), (100, 30), (100, 80), (40, 80)], close=True)

    loaded = read_dxf(tmp_path, draw)
    assert sizes(loaded) == [(100, 80, 0), (60, 50, 0)]
    assert area(loaded.workpiece) == pytest.approx(5000)

    def across(space: Any) -> None:
        space.add_lwpolyline([(0, 0), (80, 0), (80, 50), (0, 50)], close=True)
        space.add_lwpolyline([(60, 0), (120, 0), (120, 40), (60, 40)], close=True)

    with pytest.raises(InputError, match="cross or touch"):
        read_dxf(tmp_path, across)


def test_lines_that_lie_partly_on_each_other_are_one(tmp_path: Path) -> None:
    """A line and a line, arcs of one circle, and a polyline and a line."""

    def lines(space: Any) -> None:
        for start, end in (
            ((0, 0), (60, 0)),
            ((40, 0), (100, 0)),
            ((100, 0), (100, 60)),
            ((100, 60), (0, 60)),
            ((0, 60), (0, 0)),
        ):
            space.add_line(start, end)
        space.add_circle((30, 30), 8)

    loaded = read_dxf(tmp_path, lines)
    assert sizes(loaded) == [(100, 60, 1)] and len(loaded.workpiece.faces) == 5
    assert "lie on each other as one" in loaded.remarks[0] and "(40, 0)" in loaded.remarks[0]

    def arcs(space: Any) -> None:
        for start, end in (((-20, 0), (-20, -40)), ((-20, -40), (20, -40)), ((20, -40), (20, 0))):
            space.add_line(start, end)
        space.add_arc((0, 0), 20, 0, 120)
        space.add_arc((0, 0), 20, 80, 180)

    loaded = read_dxf(tmp_path, arcs)
    assert len(loaded.workpiece.faces) == 4 and sizes(loaded) == [(40, 60, 0)]

    def mixed(space: Any) -> None:
        space.add_lwpolyline([(0, 0), (100, 0), (100, 60), (30, 60)])
        space.add_line((50, 60), (0, 60))
        space.add_line((0, 60), (0, 0))

    assert area(read_dxf(tmp_path, mixed).workpiece) == pytest.approx(6000)


def test_what_overlaps_is_found_by_its_line_or_circle() -> None:
    """Lines in a row and arcs of other circles do not lie on each other."""
    one, row, other = (
        Line((0.0, 0.0), (10.0, 0.0)),
        Line((10.0, 0.0), (20.0, 0.0)),
        Line((9.0, 0.0), (4.0, 0.0)),
    )
    assert not run_along_each_other([one, row], 1e-3) and run_along_each_other([one, row, other], 1e-3)
    assert not run_along_each_other([one, Line((0.0, 1.0), (10.0, 1.0))], 1e-3)
    arc = make_segment_from_bulge((0.0, 0.0), (10.0, 0.0), 1.0)
    assert run_along_each_other(
        [arc, make_segment_from_bulge((0.0, 0.0), (5.0, -5.0), 0.41421356237309503)], 1e-3
    )
    assert not run_along_each_other([arc, make_segment_from_bulge((10.0, 0.0), (0.0, 0.0), 1.0)], 1e-3)


def add_bad_spot(space: Any, x: float, y: float, layer: str = "0") -> None:
    """A square with an arc over one side: it could be either."""
    rectangle(space, x, y, 10, 10, layer=layer)
    space.add_arc((x + 5, y + 10), 5, 0, 180, dxfattribs={"layer": layer})


def test_a_sound_part_is_read_beside_a_bad_spot(tmp_path: Path) -> None:
    """Its place and layer are named; what it lies in is not read."""

    def draw(space: Any) -> None:
        rectangle(space, 0, 0, 80, 50)
        space.add_circle((20, 25), 6)
        rectangle(space, 100, 0, 50, 40)
        add_bad_spot(space, 120, 10, "ENGRAVE")

    loaded = read_dxf(tmp_path, draw)
    assert loaded.number == 1 and len(loaded.workpiece.loops) == 2
    said = " ".join(loaded.remarks)
    assert "3 ends meet at (130, 20)" in said and "on layer 'ENGRAVE'" in said and "part 2 around" in said
    with pytest.raises(InputError, match=r"3 ends meet at \(130, 20\)"):
        read_dxf(tmp_path, draw, part_number=2)


def test_a_larger_part_with_a_bad_spot_is_passed_over(tmp_path: Path) -> None:
    """The sound one is read; a small ring beside a large outline is not taken for the part."""

    def draw(space: Any) -> None:
        rectangle(space, 0, 0, 80, 50)
        rectangle(space, 100, 0, 90, 70)
        add_bad_spot(space, 120, 10)

    assert read_dxf(tmp_path, draw).workpiece.bounds == pytest.approx((0, 0, 80, 50))

    def detail(space: Any) -> None:
        space.add_circle((-20, 0), 4)
        rectangle(space, 100, 0, 90, 70)
        add_bad_spot(space, 120, 10)

    with pytest.raises(InputError, match=r"give part_number 2: part 2 is 8 x 8 mm"):
        read_dxf(tmp_path, detail)


def test_a_frame_around_the_part_is_left_out(tmp_path: Path) -> None:
    """A sheet's border whose title block shares corners with it holds the part and its hole."""

    def draw(space: Any) -> None:
        corners = [(-50, -50), (150, -50), (247, -50), (247, -20), (247, 160), (-50, 160)]
        for start, end in zip(corners, corners[1:] + corners[:1], strict=True):
            space.add_line(start, end)
        space.add_line((150, -50), (150, -20))
        space.add_line((150, -20), (247, -20))
        rectangle(space, 0, 0, 80, 50)
        space.add_circle((20, 20), 5)

    loaded = read_dxf(tmp_path, draw)
    assert sizes(loaded) == [(80, 50, 1)] and "frame" in loaded.remarks[0]


def test_ends_of_dimensions_share_a_side_of_the_part(tmp_path: Path) -> None:
    """A dimension that was exploded hangs on two corners: the part is the part all the same."""

    def draw(space: Any) -> None:
        rectangle(space, 0, 0, 80, 50)
        space.add_line((0, 0), (0, -12))
        space.add_line((80, 0), (80, -12))
        space.add_line((0, -10), (80, -10))

    assert read_dxf(tmp_path, draw).workpiece.bounds == pytest.approx((0, 0, 80, 50))


def test_a_bend_line_that_looks_like_one_is_no_cut(tmp_path: Path) -> None:
    """A line in another colour or another kind of line between corners of the outline divides nothing; a cut that
    looks like the outline does, also where each part has its own colour."""

    def draw(space: Any, **look: Any) -> None:
        corners = [(0, 0), (30, 0), (100, 0), (100, 60), (30, 60), (0, 60)]
        for start, end in zip(corners, corners[1:] + corners[:1], strict=True):
            space.add_line(start, end)
        space.add_line((30, 0), (30, 60), dxfattribs=look)

    for look in ({"color": 3}, {"linetype": "CENTER"}, {"color": 1, "linetype": "CONTINUOUS"}):
        with pytest.raises(InputError, match=r"3 ends meet at \(30, 0\)"):
            read_dxf(tmp_path, partial(draw, **look))
    loaded = read_dxf(tmp_path, draw)
    assert sizes(loaded) == [(70, 60, 0), (30, 60, 0)] and "a bend or a marking" in loaded.remarks[0]

    def coloured(space: Any) -> None:
        rectangle(space, 0, 0, 80, 50, color=1)
        for start, end in (((80, 0), (140, 0)), ((140, 0), (140, 50)), ((140, 50), (80, 50))):
            space.add_line(start, end, dxfattribs={"color": 5})

    assert sizes(read_dxf(tmp_path, coloured)) == [(80, 50, 0), (60, 50, 0)]


@pytest.mark.parametrize("look", ['stroke="red"', 'style="stroke-dasharray:3 1"', 'stroke="#000"'])
def test_a_bend_line_of_an_svg_drawing_is_no_cut(tmp_path: Path, look: str) -> None:
    """Nor there; the same colour written in another way asks rather than guesses."""
    path = tmp_path / "bend.svg"
    text = (
        '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60">'
        '<g fill="none" stroke="black"><path d="M0 0H30M30 0H100V60H30M30 60H0V0"/><path d="M30 0V60"/></g></svg>'
    )
    path.write_text(text)
    assert sizes(read_workpiece(path)) == [(70, 60, 0), (30, 60, 0)]
    path.write_text(text.replace('d="M30 0V60"', f'd="M30 0V60" {look}'))
    with pytest.raises(InputError, match="3 ends meet"):
        read_workpiece(path)


def test_many_ends_at_one_place_are_told_once() -> None:
    """Every junction is looked at once, however many pieces end there."""
    looked = list[str]()

    class Layers(dict[str, str]):
        def get(self, label: str, other: Any = None) -> Any:
            looked.append(label)
            return super().get(label, other)

    size = 40.0
    corners = [(0.0, 0.0), (size, 0.0), (size, size), (0.0, size), (0.0, 0.0)]
    chains = [Chain((p, q), (0.0,), (f"side {k}",)) for k, (p, q) in enumerate(pairwise(corners))]
    rays = [Chain(((0.0, 0.0), (-1.0 - k, 7.0)), (0.0,), (f"ray {k}",)) for k in range(60)]
    # What stands for the limit of the map of the plane: more than it looks at.
    with patch("workhold.files.outline.plane_map.MOST_SEGMENTS", 10):
        found = make_outlines([*chains, *rays], 1e-3, Drawing((), layers=Layers()), Budget(UNLIMITED))
    assert len(found.spots) == 1 and found.spots[0].junction.point == (0.0, 0.0)
    assert len(looked) == 62
