"""Entities, units, layers and refusals of DXF drawings."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, nan, pi
from pathlib import Path
from typing import Any

import pytest
from reading_helpers import RECTANGLE, area, new_dxf, perimeter, read_dxf, rectangle

from workhold import load
from workhold.errors import InputError
from workhold.files.part.load import read_workpiece


def test_loose_lines_and_arcs_make_an_outline(tmp_path: Path) -> None:
    """A stadium of two lines and two half circles has area 2 r l + pi r² and perimeter 2 l + 2 pi r."""

    def draw(space: Any) -> None:
        space.add_line((0, 0), (40, 0))
        space.add_line((0, 20), (40, 20))
        space.add_arc((40, 10), 10, -90, 90)
        space.add_arc((0, 10), 10, 90, 270)

    loaded = read_dxf(tmp_path, draw)
    assert area(loaded.workpiece) == pytest.approx(800 + 100 * pi, rel=1e-12)
    assert perimeter(loaded.workpiece) == pytest.approx(80 + 20 * pi, rel=1e-12)
    assert len(loaded.workpiece.segments) == 4
    assert loaded.remarks == ()


@pytest.mark.parametrize("kind", ["lwpolyline", "polyline"])
@pytest.mark.parametrize("flagged", [True, False])
def test_polylines_with_bulges(tmp_path: Path, kind: str, flagged: bool) -> None:
    """Closed by flag or by its ends, a polyline is a loop; the stadium again."""
    rows = [(0, 0, 0), (40, 0, 1), (40, 20, 0), (0, 20, 1)]
    rows += [] if flagged else [(0, 0, 0)]

    def draw(space: Any) -> None:
        if kind == "lwpolyline":
            space.add_lwpolyline(rows, format="xyb", close=flagged)
        else:
            space.add_polyline2d([(x, y, 0, 0, b) for x, y, b in rows], format="xyseb", close=flagged)

    loaded = read_dxf(tmp_path, draw)
    assert area(loaded.workpiece) == pytest.approx(800 + 100 * pi, rel=1e-12)
    assert loaded.remarks == ()


def test_a_flat_3d_polyline_is_lines(tmp_path: Path) -> None:
    """A 3D polyline that lies level is as good as lines."""
    loaded = read_dxf(
        tmp_path, lambda space: space.add_polyline3d([(x, y, 5) for x, y in RECTANGLE], close=True)
    )
    assert area(loaded.workpiece) == pytest.approx(2400)


def test_circles_and_full_arcs_are_loops(tmp_path: Path) -> None:
    """CIRCLE, ARC 0..360, an ARC whose angles are equal, and two half ARCs are circles; negative angles are fine."""

    def draw(space: Any) -> None:
        space.add_circle((0, 0), 50)
        space.add_arc((-20, 0), 5, 0, 360)
        space.add_arc((0, 0), 5, 30, 30)
        space.add_arc((20, 0), 5, -90, 90)
        space.add_arc((20, 0), 5, 90, -90)

    part = read_dxf(tmp_path, draw).workpiece
    assert len(part.loops) == 4
    assert area(part) == pytest.approx(2500 * pi - 75 * pi, rel=1e-12)
    assert all(face.segment.is_full for face in part.faces)  # type: ignore[union-attr]


def test_a_nearly_full_arc_keeps_its_centre(tmp_path: Path) -> None:
    """A 359.9 degree arc and the chord that closes it: the centre survives to 1e-9 mm."""
    from math import cos, radians, sin

    end = (10 * cos(radians(359.9)), 10 * sin(radians(359.9)))

    def draw(space: Any) -> None:
        space.add_arc((0, 0), 10, 0, 359.9)
        space.add_line((10, 0), end)

    part = read_dxf(tmp_path, draw).workpiece
    for segment in part.segments[:2]:
        assert segment.center == pytest.approx((0, 0), abs=1e-9)  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("insunits", "mm"),
    [(1, 25.4), (2, 304.8), (4, 1), (5, 10), (6, 1000), (9, 0.0254), (13, 0.001), (14, 100)],
)
def test_units_of_the_header(tmp_path: Path, insunits: int, mm: float) -> None:
    """A 60 x 40 unit plate is as large as its unit says."""
    part = read_dxf(tmp_path, rectangle, insunits).workpiece
    assert area(part) == pytest.approx(2400 * mm**2)


@pytest.mark.parametrize(("unit", "mm"), [("mm", 1), ("inch", 25.4), ("in", 25.4), ("cm", 10), ("M", 1000)])
def test_a_given_unit_overrides(tmp_path: Path, unit: str, mm: float) -> None:
    """``unit`` serves files without one and overrules the others, which is said."""
    assert area(read_dxf(tmp_path, rectangle, 0, unit=unit).workpiece) == pytest.approx(2400 * mm**2)
    loaded = read_dxf(tmp_path, rectangle, 2, unit=unit)
    assert area(loaded.workpiece) == pytest.approx(2400 * mm**2)
    assert "unit is feet" in loaded.remarks[0]


def test_unknown_units_are_refused(tmp_path: Path) -> None:
    """Nobody guesses a unit: unitless, absent ($MEASUREMENT does not count) and parsecs are refused."""
    with pytest.raises(
        InputError,
        match=r"drawn\.dxf: the drawing's unit is not said: it is 60 mm wide, or 60 in = 1,524 mm; say which with unit mm",
    ):
        read_dxf(tmp_path, rectangle, 0)
    with pytest.raises(InputError, match=r"INSUNITS 20\).*say which with unit mm"):
        read_dxf(tmp_path, rectangle, 20)
    document, space = new_dxf(None, "R12")
    document.header["$MEASUREMENT"] = 1
    rectangle(space)
    document.saveas(tmp_path / "old.dxf")
    with pytest.raises(InputError, match="unit is not said"):
        load(tmp_path / "old.dxf")


def layered(space: Any) -> None:
    """An outline and a hole on layers of their own, and a larger frame on a third."""
    space.doc.layers.add("Frame")
    rectangle(space, layer="Outline")
    space.add_circle((30, 20), 5, dxfattribs={"layer": "Holes"})
    rectangle(space, -10, -10, 100, 80, layer="Frame")


def test_layers_are_chosen_in_any_capitals(tmp_path: Path) -> None:
    """Only the chosen layers count."""
    assert area(read_dxf(tmp_path, layered, layers=["OUTLINE"]).workpiece) == pytest.approx(2400)
    part = read_dxf(tmp_path, layered, layers=["outline", " holes"]).workpiece
    assert area(part) == pytest.approx(2400 - 25 * pi)


def test_a_layer_without_outline_is_refused(tmp_path: Path) -> None:
    """The layers that could have been meant are listed."""
    with pytest.raises(
        InputError, match="no line or arc is on layer 'Cut': layers with some are Frame; Holes; Outline"
    ):
        read_dxf(tmp_path, layered, layers=["Cut"])
    with pytest.raises(InputError, match="no layer was chosen"):
        read_dxf(tmp_path, layered, layers=[])


@pytest.mark.parametrize("how", ["freeze", "off", "defpoints", "invisible"])
def test_hidden_entities_are_left_out_with_a_remark(tmp_path: Path, how: str) -> None:
    """Frozen and switched-off layers, Defpoints and invisible entities do not count, unless the layer is named."""
    name = "Defpoints" if how == "defpoints" else "Frame"

    def draw(space: Any) -> None:
        rectangle(space)
        layer = space.doc.layers.get(name) if name in space.doc.layers else space.doc.layers.add(name)
        if how in ("freeze", "off"):
            getattr(layer, how)()
        rectangle(space, -10, -10, 100, 80, layer=name, invisible=int(how == "invisible"))

    loaded = read_dxf(tmp_path, draw)
    assert area(loaded.workpiece) == pytest.approx(2400)
    assert "Left out 4 hidden entities" in loaded.remarks[0]
    if how != "invisible":
        assert area(read_dxf(tmp_path, draw, layers=[name]).workpiece) == pytest.approx(8000)


def test_annotations_are_ignored_and_counted(tmp_path: Path) -> None:
    """Text, points, dimensions, hatches, leaders and solids are not an outline."""

    def draw(space: Any) -> None:
        rectangle(space)
        space.add_text("PLATE")
        space.add_mtext("PLATE")
        space.add_point((1, 1))
        space.add_point((2, 2))
        space.add_linear_dim(base=(0, -5), p1=(0, 0), p2=(60, 0)).render()
        space.add_hatch().paths.add_polyline_path(RECTANGLE)
        space.add_solid([(0, 0), (1, 0), (0, 1)])

    loaded = read_dxf(tmp_path, draw)
    assert area(loaded.workpiece) == pytest.approx(2400)
    assert loaded.remarks == (
        "Ignored entities that are not an outline: 1 DIMENSION, 1 HATCH, 1 MTEXT, 2 POINT, 1 SOLID, 1 TEXT.",
    )


def test_zero_length_entities_and_doubled_vertices_are_dropped(tmp_path: Path) -> None:
    """A line of no length, a circle of no radius and a doubled vertex change nothing but the remarks."""

    def draw(space: Any) -> None:
        space.add_line((5, 5), (5, 5))
        space.add_circle((6, 6), 0)
        space.add_lwpolyline([*RECTANGLE[:2], RECTANGLE[1], *RECTANGLE[2:], RECTANGLE[0]], close=True)

    loaded = read_dxf(tmp_path, draw)
    assert len(loaded.workpiece.segments) == 4
    assert "2 entities of zero length: LINE" in loaded.remarks[0]
    assert "doubled vertices of 1 polyline: LWPOLYLINE" in loaded.remarks[1]


def smoothed(space: Any) -> None:
    """A POLYLINE that holds chords of a spline, not the drawn curve."""
    space.add_polyline2d(RECTANGLE, close=True).dxf.flags |= 4


def beside_a_plate(draw: Callable[[Any], object]) -> Callable[[Any], None]:
    """What draws a sound outline first."""

    def both(space: Any) -> None:
        rectangle(space)
        draw(space)

    return both


CURVE = r"which is not made of lines and arcs"
# What is drawn, and what is said of it: never is anything replaced by chords, taken for another thing or left out.
REFUSED: dict[str, tuple[Callable[[Any], object], str]] = {
    "an outline that crosses itself": (
        lambda s: s.add_lwpolyline([(0, 0), (20, 20), (20, 0), (0, 30)], close=True),
        r".*\(LWPOLYLINE \w+ segment 0\) and .*segment 2\) cross",
    ),
    "a face in space": (
        beside_a_plate(lambda s: s.add_3dface([(0, 0), (1, 0), (1, 1), (0, 1)])),
        rf"3DFACE \w+ at \(.*{CURVE}",
    ),
    "a line of several": (
        beside_a_plate(lambda s: s.add_mline([(0, 0), (5, 5)])),
        rf"MLINE \w+ at \(.*{CURVE}",
    ),
    "a polyline smoothed into a spline": (smoothed, r".*POLYLINE \w+ is smoothed into a spline"),
    "a mesh": (lambda s: s.add_polymesh((3, 3)), r".*POLYLINE \w+ is a 3D mesh"),
    "a line that rises": (
        lambda s: s.add_line((0, 0, 0), (1, 0, 5)),
        r".*LINE \w+ reaches the height z = 5 mm, but itself lies at z = 0 mm",
    ),
    "a circle at another height": (
        beside_a_plate(lambda s: s.add_circle((30, 20, 3), 5)),
        r".*CIRCLE \w+ reaches the height z = 3 mm, but LINE \w+ lies at z = 0 mm",
    ),
    "a tilted circle": (
        lambda s: s.add_circle((0, 0), 5, dxfattribs={"extrusion": (0, 0.6, 0.8)}),
        r".*CIRCLE \w+ is tilted out of the drawing plane",
    ),
    "no number": (lambda s: s.add_line((0, 0), (nan, 0)), r".*LINE \w+ "),
    "an infinite number": (lambda s: s.add_line((0, 0), (inf, 0)), r".*LINE \w+ "),
    "an astronomical number": (lambda s: s.add_line((0, 0), (1e12, 0)), ".*1 km"),
    "a radius below 0": (lambda s: s.add_circle((0, 0), -3), r".*CIRCLE \w+ has the radius -3"),
    "text alone": (
        lambda s: s.add_text("PLATE"),
        r".*no lines or arcs that could be an outline \(.*1 TEXT",
    ),
}


@pytest.mark.parametrize(("draw", "said"), REFUSED.values(), ids=REFUSED)
def test_what_is_no_outline_is_refused_by_entity(
    tmp_path: Path, draw: Callable[[Any], object], said: str
) -> None:
    """In a sentence with the file, the entity's handle and its place."""
    with pytest.raises(InputError, match=rf"drawn\.dxf: {said}"):
        read_dxf(tmp_path, draw)


def test_refused_entities_on_other_layers_do_not_matter(tmp_path: Path) -> None:
    """A spline on a layer that is not chosen is never looked at, also one that cannot be read."""

    def draw(space: Any) -> None:
        rectangle(space, layer="cut")
        space.add_spline([(0, 0), (1, 2), (3, 1)])

    assert area(read_dxf(tmp_path, draw, layers=["cut"]).workpiece) == pytest.approx(2400)


def test_extrusion_from_below_mirrors_x(tmp_path: Path) -> None:
    """With extrusion (0, 0, -1) a flat entity's OCS x runs towards -x; arcs then run clockwise."""
    below = {"extrusion": (0, 0, -1)}

    def draw(space: Any) -> None:
        space.add_arc((-40, 10), 10, 90, 270, dxfattribs=below)  # right end: centre (40, 10)
        space.add_arc((0, 10), 10, -90, 90, dxfattribs=below)  # left end: centre (0, 10)
        space.add_line((0, 0), (40, 0))
        space.add_line((0, 20), (40, 20))
        space.add_circle((-20, 10), 4, dxfattribs=below)
        space.add_lwpolyline([(-33, 5, 1), (-33, 12, 0)], format="xyb", close=True, dxfattribs=below)

    part = read_dxf(tmp_path, draw).workpiece
    assert part.bounds == pytest.approx((-10, 0, 50, 20))
    assert area(part) == pytest.approx(800 + 100 * pi - 16 * pi - pi * 3.5**2 / 2, rel=1e-12)
    # Half a circle from (33, 5) to (33, 12), bulging right in OCS, so left in the drawing.
    half = next(s for s in part.segments if getattr(s, "radius", 0) == pytest.approx(3.5))
    assert half.compute_point(0.0) == pytest.approx((29.5, 8.5))


def test_truncated_files_are_refused(tmp_path: Path) -> None:
    """Cut anywhere, a DXF file is refused: half an outline may still look like a part."""
    document, space = new_dxf()
    rectangle(space)
    document.saveas(tmp_path / "whole.dxf")
    content = (tmp_path / "whole.dxf").read_bytes()
    for share in (0.05, 0.3, 0.6, 0.9, 0.9999):
        (tmp_path / "cut.dxf").write_bytes(content[: int(len(content) * share)])
        with pytest.raises(InputError, match=r"cut\.dxf: .*(cut short|not a DXF)"):
            load(tmp_path / "cut.dxf")


@pytest.mark.thorough
def test_damaged_files_give_one_sentence(tmp_path: Path) -> None:
    """Random bytes replaced in a DXF file never lead to anything but a part or an input error."""
    import random

    document, space = new_dxf()
    rectangle(space)
    document.saveas(tmp_path / "whole.dxf")
    content = (tmp_path / "whole.dxf").read_bytes()
    randomly = random.Random(5)
    start = content.index(b"ENTITIES") - 20
    for _ in range(25):
        damaged = bytearray(content)
        for _ in range(3):
            damaged[randomly.randrange(start, start + 600)] = randomly.randrange(256)
        (tmp_path / "bad.dxf").write_bytes(damaged)
        try:
            load(tmp_path / "bad.dxf")
        except InputError as error:
            assert "\n" not in str(error)


def test_other_formats_are_named(tmp_path: Path) -> None:
    """A DWG file under a wrong name is called what it is."""
    (tmp_path / "part.dxf").write_bytes(b"AC1032\0\0\0" + bytes(1000))
    with pytest.raises(InputError, match="DWG drawing"):
        load(tmp_path / "part.dxf")


def test_binary_dxf_is_read(tmp_path: Path) -> None:
    """The binary form holds the same drawing; cut short it is refused."""
    document, space = new_dxf()
    rectangle(space)
    document.saveas(tmp_path / "part.dxf", fmt="bin")
    assert area(load(tmp_path / "part.dxf")) == pytest.approx(2400)
    content = (tmp_path / "part.dxf").read_bytes()
    (tmp_path / "part.dxf").write_bytes(content[: len(content) // 2])
    with pytest.raises(InputError, match=r"damaged|cut short"):
        load(tmp_path / "part.dxf")


def test_part_keeps_the_files_stem_as_name(tmp_path: Path) -> None:
    """A drawing has no name but the file's."""
    assert read_dxf(tmp_path, rectangle).workpiece.name == "drawn"
    assert len(read_workpiece(tmp_path / "drawn.dxf").parts) == 1


def test_a_file_without_a_header_says_no_unit(tmp_path: Path) -> None:
    """Entities alone are a valid DXF file; nothing in it says a unit, so none is assumed."""
    corners = [(0, 0), (40, 0), (40, 30), (0, 30)]
    lines = ["0", "SECTION", "2", "ENTITIES"]
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1], strict=True):
        lines += ["0", "LINE", "8", "0", "10", str(x0), "20", str(y0), "11", str(x1), "21", str(y1)]
    path = tmp_path / "bare.dxf"
    path.write_text("\n".join([*lines, "0", "ENDSEC", "0", "EOF", ""]))
    with pytest.raises(InputError, match="unit"):
        load(path)
    assert load(path, unit="mm").bounds == (0.0, 0.0, 40.0, 30.0)
