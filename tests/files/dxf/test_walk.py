"""INSERT: placed, nested, mirrored, scaled and repeated blocks give the transformed outline, exactly."""

from __future__ import annotations

from math import cos, pi, radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from attrs import evolve
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from reading_helpers import area, new_dxf, perimeter, read_dxf, rectangle

from workhold import Workpiece, load
from workhold.errors import InputError
from workhold.files.budget import LIMITS
from workhold.files.part.load import read_workpiece

# A part without any symmetry, of lines, a convex and a concave arc; its arcs bulge by known amounts.
ROWS = [(0, 0, 0), (30, 0, 0.5), (30, 12, 0), (18, 20, -0.3), (8, 16, 0), (0, 16, 0.2)]


def draw_polyline(block: Any) -> None:
    block.add_lwpolyline(ROWS, format="xyb", close=True)


def draw_loose(block: Any) -> None:
    for entity in list(block.add_lwpolyline(ROWS, format="xyb", close=True).explode()):
        assert entity.dxftype() in ("LINE", "ARC")


def middles(part: Workpiece) -> np.ndarray[Any, Any]:
    """Start and middle points of all segments, sorted: they fix lines and arcs alike."""
    points = [s.start for s in part.segments] + [s.compute_point(0.0) for s in part.segments]
    return np.array(sorted((round(x, 6), round(y, 6)) for x, y in points))


def transformed(angle: float, scale: float, mirror: bool, shift: tuple[float, float]) -> Workpiece:
    """The part mirrored in y (if asked), scaled, turned and moved, computed on its vertices."""
    rows = []
    for x, y, bulge in ROWS:
        u, v = scale * x, scale * (-y if mirror else y)
        c, s = cos(radians(angle)), sin(radians(angle))
        rows.append((c * u - s * v + shift[0], s * u + c * v + shift[1], -bulge if mirror else bulge))
    return Workpiece.from_loops("expected", [rows])


@pytest.mark.thorough
@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    angle=st.floats(-360, 360),
    scale=st.floats(0.2, 5),
    mirror=st.booleans(),
    x=st.floats(-100, 100),
    y=st.floats(-100, 100),
    loose=st.booleans(),
    base=st.tuples(st.floats(-9, 9), st.floats(-9, 9)),
)
def test_an_insert_is_a_similarity(
    tmp_path: Path,
    angle: float,
    scale: float,
    mirror: bool,
    x: float,
    y: float,
    loose: bool,
    base: tuple[float, float],
) -> None:
    """Placing a block gives the outline mapped by q -> R S (q - base) + t, be it a polyline or loose lines and arcs."""
    document, space = new_dxf()
    block = document.blocks.new("PART", base_point=base)
    (draw_loose if loose else draw_polyline)(block)
    scales = {"xscale": scale, "yscale": -scale if mirror else scale, "rotation": angle}
    space.add_blockref("PART", (x, y), dxfattribs=scales)
    document.saveas(tmp_path / "part.dxf")
    part = load(tmp_path / "part.dxf")
    c, s = cos(radians(angle)), sin(radians(angle))
    bx, by = scale * base[0], scale * (-base[1] if mirror else base[1])
    expected = transformed(angle, scale, mirror, (x - c * bx + s * by, y - s * bx - c * by))
    assert area(part) == pytest.approx(area(expected), rel=1e-9)
    assert perimeter(part) == pytest.approx(perimeter(expected), rel=1e-9)
    assert np.allclose(middles(part), middles(expected), atol=1e-5)


@pytest.mark.parametrize("below", [False, True])
@pytest.mark.parametrize("loose", [False, True])
def test_nested_turned_and_mirrored_inserts(tmp_path: Path, loose: bool, below: bool) -> None:
    """Two INSERTs deep, the maps are composed; ezdxf's own explosion of the same file agrees on the points."""
    document, space = new_dxf()
    inner = document.blocks.new("INNER", base_point=(1, 2))
    (draw_loose if loose else draw_polyline)(inner)
    outer = document.blocks.new("OUTER", base_point=(-3, 4))
    extrusion = (0, 0, -1) if below else (0, 0, 1)
    outer.add_blockref(
        "INNER", (5, 6), dxfattribs={"xscale": -2, "yscale": 2, "rotation": 30, "extrusion": extrusion}
    )
    space.add_blockref(
        "OUTER", (70, -20), dxfattribs={"xscale": 1.5, "yscale": -1.5, "zscale": 1.5, "rotation": 110}
    )
    document.saveas(tmp_path / "part.dxf")
    part = load(tmp_path / "part.dxf")
    plain = Workpiece.from_loops("plain", [ROWS])
    assert area(part) == pytest.approx(9 * area(plain), rel=1e-12)
    assert perimeter(part) == pytest.approx(3 * perimeter(plain), rel=1e-12)
    for reference in list(space.query("INSERT")):
        for nested in reference.explode().query("INSERT"):
            nested.explode()
    ends = {
        (round(p.x, 6) + 0.0, round(p.y, 6) + 0.0)
        for e in space
        for piece in (e.virtual_entities() if e.dxftype() == "LWPOLYLINE" else [e])
        for p in (
            (piece.dxf.start, piece.dxf.end)
            if piece.dxftype() == "LINE"
            else (piece.start_point, piece.end_point)
        )
    }
    assert ends == {(round(x, 6) + 0.0, round(y, 6) + 0.0) for loop in part.loops for x, y, _ in loop}


def test_inches_scale_blocks_too(tmp_path: Path) -> None:
    """The file's unit applies to placed blocks once."""
    document, space = new_dxf(1)
    draw_polyline(document.blocks.new("PART"))
    space.add_blockref("PART", (1, 1))
    document.saveas(tmp_path / "part.dxf")
    assert area(load(tmp_path / "part.dxf")) == pytest.approx(
        25.4**2 * area(Workpiece.from_loops("p", [ROWS]))
    )


def test_an_array_of_holes(tmp_path: Path) -> None:
    """A MINSERT of 2 rows and 3 columns of a circle makes six holes; the grid turns with the INSERT."""
    document, space = new_dxf()
    rectangle(space, -100, -100, 200, 200)
    document.blocks.new("HOLE").add_circle((0, 0), 2)
    grid = {"row_count": 2, "column_count": 3, "row_spacing": 10, "column_spacing": 15, "rotation": 90}
    space.add_blockref("HOLE", (5, 5), dxfattribs=grid)
    document.saveas(tmp_path / "part.dxf")
    part = load(tmp_path / "part.dxf")
    assert len(part.loops) == 7
    centers = {tuple(np.round(loop[:, :2].mean(axis=0), 6).tolist()) for loop in part.loops[1:]}
    assert centers == {(5.0 - 10 * row, 5.0 + 15 * column) for row in range(2) for column in range(3)}


@pytest.mark.thorough
def test_unequal_scales_turn_arcs_into_ellipses(tmp_path: Path) -> None:
    """Lines stay lines under any affine map; arcs become ellipses, which need a fit."""
    document, space = new_dxf()
    rectangle(document.blocks.new("PLATE"))
    space.add_blockref("PLATE", (0, 0), dxfattribs={"xscale": 2, "yscale": 3, "rotation": 20})
    document.saveas(tmp_path / "part.dxf")
    assert area(load(tmp_path / "part.dxf")) == pytest.approx(2400 * 6)
    document.blocks.get("PLATE").add_circle((30, 20), 5)
    document.saveas(tmp_path / "part.dxf")
    with pytest.raises(InputError, match=r"CIRCLE \w+ of INSERT \w+ at \(.* is a true curve.*give fit 0\.01"):
        load(tmp_path / "part.dxf")
    part = load(tmp_path / "part.dxf", fit=0.001)
    assert area(part) == pytest.approx((2400 - 25 * pi) * 6, abs=0.001 * 80)


@pytest.mark.thorough
def test_a_block_turned_half_way_inside_an_unequal_scale_is_skewed(tmp_path: Path) -> None:
    """Turned by 45 degrees its axes come out equally long and not square to each other: circles become ellipses."""
    document, space = new_dxf()
    inner = document.blocks.new("INNER")
    inner.add_circle((0, 0), 5)
    document.blocks.new("OUTER").add_blockref("INNER", (0, 0), dxfattribs={"rotation": 45})
    space.add_blockref("OUTER", (0, 0), dxfattribs={"xscale": 2, "yscale": 3})
    document.saveas(tmp_path / "part.dxf")
    with pytest.raises(InputError, match="is a true curve"):
        load(tmp_path / "part.dxf")
    part = load(tmp_path / "part.dxf", fit=0.001)
    assert part.bounds == pytest.approx((-10, -15, 10, 15), abs=0.001)


def test_block_entities_on_layer_0_take_the_inserts_layer(tmp_path: Path) -> None:
    """Layer 0 inside a block means the INSERT's layer, through every level; other layers are kept."""
    document, space = new_dxf()
    inner = document.blocks.new("INNER")
    rectangle(inner)
    inner.add_circle((30, 20), 5, dxfattribs={"layer": "holes"})
    document.blocks.new("OUTER").add_blockref("INNER", (0, 0))
    space.add_blockref("OUTER", (0, 0), dxfattribs={"layer": "cut"})
    document.layers.add("cut").off()
    document.saveas(tmp_path / "part.dxf")
    assert area(load(tmp_path / "part.dxf", layers=["cut"])) == pytest.approx(2400)
    assert area(load(tmp_path / "part.dxf", layers=["cut", "holes"])) == pytest.approx(2400 - 25 * pi)
    with pytest.raises(InputError, match="layers with some are cut; holes"):
        load(tmp_path / "part.dxf", layers=["0"])


def test_geometry_errors_inside_blocks_name_both(tmp_path: Path) -> None:
    """A crossing is named by the entity's handle and the INSERT's."""
    document, space = new_dxf()
    document.blocks.new("BAD").add_lwpolyline([(0, 0), (20, 20), (20, 0), (0, 30)], close=True)
    space.add_blockref("BAD", (0, 0))
    document.saveas(tmp_path / "part.dxf")
    with pytest.raises(InputError, match=r"\(LWPOLYLINE \w+ segment 0 of INSERT \w+\) and .*cross"):
        load(tmp_path / "part.dxf")


def test_blocks_that_cannot_be_placed_are_refused(tmp_path: Path) -> None:
    """A block that contains itself, a tilted one, one of scale zero and one repeated a million times."""
    document, space = new_dxf()
    rectangle(document.blocks.new("A"))
    document.blocks.new("B").add_blockref("A", (0, 0))
    document.blocks.get("A").add_blockref("B", (0, 0))
    space.add_blockref("A", (0, 0))
    document.saveas(tmp_path / "loop.dxf")
    with pytest.raises(
        InputError, match=r"INSERT \w+ of INSERT \w+ of INSERT \w+ inserts block 'A', which contains itself"
    ):
        load(tmp_path / "loop.dxf")

    for attributes, words in [
        ({"extrusion": (1, 0, 0)}, r"INSERT \w+ is tilted"),
        (
            {"row_count": 30000, "column_count": 30000, "row_spacing": 1, "column_spacing": 1},
            "repeats its block",
        ),
    ]:
        document, space = new_dxf()
        rectangle(document.blocks.new("A"))
        space.add_blockref("A", (0, 0), dxfattribs=attributes)
        document.saveas(tmp_path / "part.dxf")
        with pytest.raises(InputError, match=words):
            load(tmp_path / "part.dxf")


def test_blocks_that_multiply_without_end_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ten levels of ten INSERTs would be ten thousand million lines; the walk stops at its limit."""
    monkeypatch.setitem(LIMITS, "dxf", evolve(LIMITS["dxf"], most_elements=1000))
    document, space = new_dxf()
    rectangle(document.blocks.new("B0"))
    for level in range(1, 11):
        block = document.blocks.new(f"B{level}")
        for k in range(10):
            block.add_blockref(f"B{level - 1}", (k, 0))
    space.add_blockref("B10", (0, 0))
    document.saveas(tmp_path / "part.dxf")
    with pytest.raises(InputError, match=r"part\.dxf: the file has more than the 1,000 entities"):
        load(tmp_path / "part.dxf")


def test_a_missing_block_is_remarked(tmp_path: Path) -> None:
    """An unbound external reference does not stop the rest."""

    def draw(space: Any) -> None:
        rectangle(space)
        space.add_blockref("GONE", (0, 0))

    loaded = read_dxf(tmp_path, draw)
    assert "blocks that the file does not contain: GONE" in loaded.remarks[0]
    assert read_workpiece(tmp_path / "drawn.dxf").workpiece.name == "drawn"


@pytest.mark.parametrize("bulge", [float("inf"), float("nan"), 1e300, -1e20])
def test_a_bulge_that_is_none_is_refused_where_its_arc_becomes_an_ellipse_too(
    tmp_path: Path, bulge: float
) -> None:
    """In the sentence of any other arc, and before a curve without end is fitted."""
    document, space = new_dxf()
    block = document.blocks.new("B")
    block.add_lwpolyline([(0, 0, 0.2), (50, 0, bulge), (50, 40, 0)], format="xyb", close=True)
    space.add_blockref("B", (7, 7), dxfattribs={"xscale": 2.0, "yscale": 3.0, "rotation": 30.0})
    document.saveas(tmp_path / "part.dxf")
    with pytest.raises(
        InputError, match=r"segment 1 of INSERT .* (is not a finite number|is an arc that bulges by)"
    ):
        load(tmp_path / "part.dxf")


def test_a_curve_far_from_the_drawing_is_refused(tmp_path: Path) -> None:
    """As a line there is."""
    with pytest.raises(InputError, match="lies more than 1 km from the origin"):
        read_dxf(tmp_path, lambda space: space.add_ellipse((0, 0), (1e9, 0), 0.5))
