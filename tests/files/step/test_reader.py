"""Parts from STEP files: outlines are exact, departures from a prism are told, and what cannot be used is refused."""

from __future__ import annotations

import re
import subprocess
import sys
from itertools import pairwise
from math import pi, sqrt, tan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_NurbsConvert, BRepBuilderAPI_Transform
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone, BRepPrimAPI_MakeSphere, BRepPrimAPI_MakeTorus
from OCP.collections import Array1_gp_Pnt
from OCP.GC import GC_MakeSegment
from OCP.Geom import Geom_BezierCurve
from OCP.gp import gp_Ax1, gp_Ax2, gp_Circ, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from reading_helpers import area, perimeter
from step_shapes import (
    at_height,
    box,
    chamfered,
    cut,
    cylinder,
    filleted,
    fused,
    list_sub_shapes,
    prism,
    upright,
    write_step,
)

from workhold import Workpiece
from workhold.errors import InputError
from workhold.files.outline.curves import CurveReader
from workhold.files.part.load import LoadedPart, read_workpiece
from workhold.files.part.loaded import from_drawing
from workhold.files.step.reader import read_step_apart, refuse_missing_volume
from workhold.files.step.regions import make_edge_piece
from workhold.geometry.segment import Arc, Line


def read(tmp_path: Path, *shapes: Any, **options: Any) -> LoadedPart:
    """What is read from a STEP file of some shapes."""
    return read_workpiece(write_step(tmp_path / "part.step", *shapes), **options)


def silhouette(tmp_path: Path, *shapes: Any, **options: Any) -> LoadedPart:
    """The silhouette of a STEP file of some shapes, which is read where no outline by height is found."""
    path = write_step(tmp_path / "part.step", *shapes)
    return from_drawing(path, read_step_apart(path.read_bytes(), **options), None, 0.0, None)


def refusal(tmp_path: Path, *shapes: Any, **options: Any) -> str:
    """The one sentence by which a STEP file of some shapes is refused."""
    with pytest.raises(InputError) as caught:
        read(tmp_path, *shapes, **options)
    return str(caught.value)


def plate() -> Any:
    """A plate 60 x 40 x 20 with corners rounded by 5."""
    return filleted(box(60, 40, 20), 5, upright)


def lines_and_circles(workpiece: Workpiece) -> tuple[set[tuple[float, ...]], set[tuple[float, ...]]]:
    """The ends of all lines, and centre, radius and sign of all arcs, rounded to 1e-9 mm."""
    lines, circles = set(), set()
    for segment in workpiece.segments:
        if isinstance(segment, Line):
            lines.add(tuple(round(v, 9) + 0.0 for v in (*segment.start, *segment.end)))
        else:
            circles.add(tuple(round(v, 9) + 0.0 for v in (*segment.center, segment.radius, segment.sign)))
    return lines, circles


PLATE_LINES = {(5, 0, 55, 0), (60, 5, 60, 35), (55, 40, 5, 40), (0, 35, 0, 5)}
PLATE_CIRCLES = {(x, y, 5, 1) for x in (5, 55) for y in (5, 35)}


def test_a_plate_with_rounded_corners_and_holes_is_exact(tmp_path: Path) -> None:
    """Lines end where they should and arcs have their centres and radii, all to 1e-9 mm; a prism needs no remark."""
    loaded = read(tmp_path, cut(plate(), cylinder(6, 40, (20, 20, -5)), cylinder(2.5, 40, (45, 12, -5))))
    lines, circles = lines_and_circles(loaded.workpiece)
    assert lines == PLATE_LINES
    assert circles == PLATE_CIRCLES | {(20, 20, 6, -1), (45, 12, 2.5, -1)}
    assert len(loaded.workpiece.loops) == 3
    assert loaded.remarks == ()


@pytest.mark.parametrize(
    ("tool", "kind"),
    [
        (cylinder(4, 30, (45, 20, 12)), "round wall of radius 4 mm at heights 12 to 20 mm, up to 19 mm"),
        (
            cylinder(3, 60, (30, -5, 8), (0, 1, 0)),
            "cylinder of radius 3 mm across at heights 5 to 11 mm, up to 20 mm",
        ),
        (box(20, 10, 10, (20, 15, 15)), "wall at heights 15 to 20 mm (4 of them), up to 20 mm"),
    ],
)
def test_what_is_cut_within_the_silhouette_leaves_it_alone(tmp_path: Path, tool: Any, kind: str) -> None:
    """A blind hole, a hole across and a pocket are told with heights and depth, and are not holes of the outline."""
    loaded = silhouette(tmp_path, cut(plate(), tool))
    assert lines_and_circles(loaded.workpiece) == (PLATE_LINES, PLATE_CIRCLES)
    assert kind in loaded.remarks[0]


def test_the_smallest_section_is_told(tmp_path: Path) -> None:
    """A blind hole of radius 4 takes 16 pi = 50.3 mm² from the sections above its floor."""
    loaded = silhouette(tmp_path, cut(plate(), cylinder(4, 30, (45, 20, 12))))
    assert (
        "section at heights 0 to 12 mm (the section at height 16 mm has 50.3 mm² (2.1 %) less)"
        in loaded.remarks[1]
    )


@pytest.mark.parametrize("maker", [chamfered, filleted])
def test_broken_edges_leave_the_outline_and_are_told(tmp_path: Path, maker: Any) -> None:
    """Chamfers and fillets of 1 mm at the top and bottom recede by 1 mm; between them the outline is the section."""
    both = lambda low, high: at_height(0)(low, high) or at_height(20)(low, high)  # noqa: E731
    loaded = silhouette(tmp_path, maker(plate(), 1, both))
    assert lines_and_circles(loaded.workpiece) == (PLATE_LINES, PLATE_CIRCLES)
    assert "heights 19 to 20 mm (4 of them), up to 1 mm from the outline" in loaded.remarks[0]
    assert "which is the section at heights 1 to 19 mm (" in loaded.remarks[1]


def test_the_silhouette_of_steps_is_their_union(tmp_path: Path) -> None:
    """Two blocks that overlap by 10 x 20 seen from above have area 60 x 40 + 20 x 20 - 10 x 20."""
    loaded = silhouette(tmp_path, fused(box(60, 40, 10), box(20, 20, 20, (50, 10, 5))))
    assert area(loaded.workpiece) == pytest.approx(2600, rel=1e-12)
    assert perimeter(loaded.workpiece) == pytest.approx(220, rel=1e-12)
    assert "is the section at heights 5 to 10 mm" in loaded.remarks[1]


def test_no_one_height_has_all_of_a_silhouette(tmp_path: Path) -> None:
    """Crossed bars one above the other: the silhouette is a cross, each section a bar."""
    loaded = silhouette(tmp_path, fused(box(60, 10, 5), box(10, 60, 5, (25, -25, 5))))
    assert area(loaded.workpiece) == pytest.approx(60 * 10 + 60 * 10 - 100)
    assert "no range of heights has all of it" in loaded.remarks[1]


def test_a_countersunk_hole_is_as_wide_as_its_narrowest(tmp_path: Path) -> None:
    """A peg in a hole with a cone touches the cylinder of radius 3 below it."""
    cone = BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(20, 20, 15), gp_Dir(0, 0, 1)), 3, 8, 5).Solid()
    loaded = read(tmp_path, cut(box(60, 40, 20), cylinder(3, 30, (20, 20, -5)), cone))
    assert lines_and_circles(loaded.workpiece)[1] == {(20, 20, 3, -1)}


@pytest.mark.parametrize(
    ("solid", "circles"),
    [
        (lambda: BRepPrimAPI_MakeSphere(10).Solid(), {(0, 0, 10, 1)}),
        (lambda: BRepPrimAPI_MakeTorus(20, 5).Solid(), {(0, 0, 25, 1), (0, 0, 15, -1)}),
        (lambda: BRepPrimAPI_MakeCone(10, 5, 8).Solid(), {(0, 0, 10, 1)}),
        (
            lambda: fused(
                BRepPrimAPI_MakeCone(10, 12, 5).Solid(),
                BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(0, 0, 5), gp_Dir(0, 0, 1)), 12, 9, 5).Solid(),
            ),
            {(0, 0, 12, 1)},
        ),
    ],
    ids=["sphere", "torus", "draft to the base", "draft both ways"],
)
def test_the_silhouette_may_lie_where_no_layer_is(
    tmp_path: Path, solid: Any, circles: set[tuple[float, ...]]
) -> None:
    """Equators, bases and parting lines are found exactly."""
    assert lines_and_circles(read(tmp_path, solid()).workpiece) == (set(), circles)


@pytest.mark.parametrize("upside_down", [False, True])
def test_a_level_face_counts_on_the_side_of_its_material(tmp_path: Path, upside_down: bool) -> None:
    """A cone that widens to radius 10, with a boss of radius 3 on its wide end: the rim of the boss is the widest."""
    up = gp_Dir(0, 0, -1 if upside_down else 1)
    cone = BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(0, 0, 0), up), 5, 10, 5).Solid()
    boss = cylinder(3, 4, (0, 0, -5 if upside_down else 5), (0, 0, up.Z()))
    assert lines_and_circles(read(tmp_path, fused(cone, boss)).workpiece) == (set(), {(0, 0, 10, 1)})


def test_a_rounded_rib_reaches_out_by_its_radius(tmp_path: Path) -> None:
    """A cylinder of radius 3 lying in the side of a block, 4 mm up, adds 3 mm between layers that lack it."""
    loaded = read(tmp_path, fused(box(60, 40, 10), cylinder(3, 40, (60, 0, 4), (0, 1, 0))))
    assert loaded.workpiece.bounds == pytest.approx((0, 0, 63, 40), abs=1e-9)
    assert area(loaded.workpiece) == pytest.approx(63 * 40, rel=1e-12)


@pytest.mark.parametrize("up", [1, -1])
def test_a_circle_may_look_either_way(up: int) -> None:
    """A quarter circle about an axis that points down runs clockwise seen from above."""
    circle = gp_Circ(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, up), gp_Dir(1, 0, 0)), 5)
    piece = make_edge_piece(BRepBuilderAPI_MakeEdge(circle, 0, pi / 2).Edge(), CurveReader(None), "edge")
    assert piece is not None
    assert piece[1] == pytest.approx([up * tan(pi / 8)])
    assert np.array(piece[0]) == pytest.approx(np.array([(5, 0), (0, 5 * up)]), abs=1e-12)
    assert piece[2] is None


def test_a_lying_cylinder_is_a_rectangle_seen_from_above_and_a_circle_along_its_axis(tmp_path: Path) -> None:
    """The rectangle's long sides are folds; the hint names the axis along which the part is a prism."""
    rod = cylinder(5, 30, (0, 0, 0), (1, 0, 0))
    loaded = read(tmp_path, rod)
    assert area(loaded.workpiece) == pytest.approx(300, rel=1e-12)
    assert loaded.remarks[-1].startswith("Along x no face leans: give axis x")
    along_x = read(tmp_path, rod, axis="x")
    assert lines_and_circles(along_x.workpiece) == (set(), {(0, 0, 5, 1)})
    assert along_x.remarks == ()


@pytest.mark.parametrize(("axis", "corner"), [("x", (2, 3)), ("y", (3, 1)), ("z", (1, 2))])
def test_an_axis_is_looked_at_from_its_far_end(
    tmp_path: Path, axis: str, corner: tuple[float, float]
) -> None:
    """The box from (1, 2, 3) to (11, 22, 33): x and y of the outline are y, z of the file, or z, x, or x, y."""
    sizes = {"x": (20, 30), "y": (30, 10), "z": (10, 20)}[axis]
    loaded = read(tmp_path, box(10, 20, 30, (1, 2, 3)), axis=axis)
    x, y = corner
    assert loaded.workpiece.bounds == pytest.approx((x, y, x + sizes[0], y + sizes[1]), abs=1e-12)


def test_the_view_is_not_mirrored(tmp_path: Path) -> None:
    """A hole on one side of a plate that lies across x stays on that side seen from the end of x."""
    loaded = read(tmp_path, cut(box(10, 60, 40), cylinder(4, 30, (-5, 45, 10), (1, 0, 0))), axis="x")
    assert (45, 10, 4, -1) in lines_and_circles(loaded.workpiece)[1]


def test_a_section_at_a_height_is_the_outline_there(tmp_path: Path) -> None:
    """Halfway up a chamfer of 1 mm the plate is 0.5 mm narrower; how far it reaches out elsewhere is told."""
    loaded = read(tmp_path, chamfered(box(60, 40, 20), 1, at_height(20)), section=19.5)
    assert loaded.workpiece.bounds == pytest.approx((0.5, 0.5, 59.5, 39.5), abs=1e-9)
    assert "at other heights the part reaches up to 0.707 mm out of it" in loaded.remarks[-1]


@pytest.mark.parametrize(
    ("height", "said"),
    [
        (0.0, "is not within the part, which is 20 mm high"),
        (20.5, "is not within"),
        (12.0, "lies a level face"),
    ],
)
def test_heights_without_a_section_are_refused(tmp_path: Path, height: float, said: str) -> None:
    """Outside the part, and at a level face."""
    assert said in refusal(tmp_path, cut(plate(), cylinder(4, 30, (45, 20, 12))), section=height)


def test_a_section_in_pieces_is_refused(tmp_path: Path) -> None:
    """Two towers on a plate are two pieces above it."""
    towers = fused(box(60, 40, 5), box(10, 40, 20), box(10, 40, 20, (50, 0, 0)))
    assert "falls into 2 pieces" in refusal(tmp_path, towers, section=10)
    assert area(read(tmp_path, towers).workpiece) == pytest.approx(2400)


def test_the_largest_solid_is_taken_or_the_one_asked_for(tmp_path: Path) -> None:
    """Solids are numbered by decreasing volume and listed."""
    shapes = box(10, 10, 10, (100, 0, 0)), plate()
    first = read(tmp_path, *shapes)
    assert area(first.workpiece) == pytest.approx(2400 - (4 - pi) * 25)
    assert "2 solids: solid 1 is 60 x 40 x 20 mm at (0, 0, 0); solid 2 is 10 x 10 x 10" in first.remarks[0]
    assert area(read(tmp_path, *shapes, part_number=2).workpiece) == pytest.approx(100)
    assert "There is no part 3: the file holds solids 1 to 2" in refusal(tmp_path, *shapes, part_number=3)


def test_solids_that_lie_above_one_another_stay_apart(tmp_path: Path) -> None:
    """A smaller block above a plate adds nothing to the plate's outline, though they overlap seen from above."""
    loaded = read(tmp_path, box(60, 40, 5), box(100, 10, 5, (-20, 15, 6)))
    assert loaded.workpiece.bounds == pytest.approx((0, 0, 60, 40))
    assert len(loaded.workpiece.segments) == 4


def test_placements_of_assemblies_count(tmp_path: Path) -> None:
    """A turned and moved plate is read where it is placed."""
    turn = gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), pi / 6)
    turn.SetTranslationPart(gp_Vec(100, 50, 7))
    moved = BRepBuilderAPI_Transform(plate(), turn, False).Shape()
    loaded = read(tmp_path, moved)
    centers = {
        (round(a.center[0], 9), round(a.center[1], 9))
        for a in loaded.workpiece.segments
        if isinstance(a, Arc)
    }
    c, s = sqrt(3) / 2, 0.5
    expected = {
        (round(100 + c * x - s * y, 9), round(50 + s * x + c * y, 9)) for x in (5, 55) for y in (5, 35)
    }
    assert centers == expected
    assert loaded.remarks == ()


def test_units_of_the_file_are_converted(tmp_path: Path) -> None:
    """The same file with inches in the place of millimetres is 25.4 times as large."""
    path = write_step(tmp_path / "part.step", plate())
    text = path.read_text()
    unit = re.search(r"#(\d+) = \( LENGTH_UNIT\(\) NAMED_UNIT\(\*\) SI_UNIT\(\.MILLI\.,\.METRE\.\) \);", text)
    assert unit is not None
    inch = (
        f"#{unit[1]} = ( CONVERSION_BASED_UNIT('INCH',#9001) LENGTH_UNIT() NAMED_UNIT(#9002) );\n"
        "#9001 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#9003);\n"
        "#9002 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n"
        "#9003 = ( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) );"
    )
    path.write_text(text.replace(unit[0], inch))
    assert read_workpiece(path).workpiece.bounds == pytest.approx((0, 0, 60 * 25.4, 40 * 25.4), rel=1e-12)
    path.write_text(text.replace("LENGTH_UNIT() NAMED_UNIT(*)", "NAMED_UNIT(*)"))
    with pytest.raises(InputError, match="does not give its unit of length"):
        read_workpiece(path)


def bezier_wall(depth: float = 15.0) -> Any:
    """A plate one of whose sides is a free-form curve, whose control points lie ``depth`` off a line."""
    poles = Array1_gp_Pnt(1, 4)
    for k, point in enumerate([(60, 0), (60 + depth, 15), (60 - depth, 30), (60, 40)], start=1):
        poles.SetValue(k, gp_Pnt(*point, 0))
    corners = [gp_Pnt(60, 40, 0), gp_Pnt(0, 40, 0), gp_Pnt(0, 0, 0), gp_Pnt(60, 0, 0)]
    straight = [GC_MakeSegment(p, q).Value() for p, q in pairwise(corners)]
    return prism([Geom_BezierCurve(poles), *straight], 10)


def test_free_form_walls_are_refused_without_a_fit(tmp_path: Path) -> None:
    """The message names the curve and a fit that would do."""
    said = refusal(tmp_path, bezier_wall())
    assert re.search(
        r"curved edge 0 of border 0 at \(60, 40\) is a true curve.*give fit 0\.01 to put \d+ lines and arcs",
        said,
    )
    assert "layer" not in said


def test_free_form_walls_are_fitted(tmp_path: Path) -> None:
    """With a fit the area is that under the Bézier curve, and how far it departs is told.

    x = 60 + 45 t (1 - t) (1 - 2 t) and y = 45 t - 5 t³, so that the wall adds the integral of (x - 60) (45 - 15 t²).
    """
    t = np.polynomial.Polynomial([0, 1])
    wall = (45 * t * (1 - t) * (1 - 2 * t) * (45 - 15 * t**2)).integ()
    loaded = read(tmp_path, bezier_wall(), fit=0.02)
    part = loaded.workpiece
    assert 0.001 < part.departure <= 0.02
    assert area(part) == pytest.approx(2400 + wall(1) - wall(0), abs=part.departure * 50)
    assert any("in place of 1 curve" in remark for remark in loaded.remarks)
    assert not any("Not prismatic" in remark for remark in loaded.remarks)


def test_free_form_walls_that_are_flat_are_lines(tmp_path: Path) -> None:
    """Control points 0.1 µm off a line: a line in disguise, whose departure is less than a drawing can mean."""
    loaded = read(tmp_path, bezier_wall(1e-7))
    assert len(loaded.workpiece.segments) == 4 and loaded.workpiece.departure == 0
    assert 1e-5 < read(tmp_path, bezier_wall(1e-4)).workpiece.departure < 1e-4


def test_free_form_walls_out_of_sight_do_no_harm(tmp_path: Path) -> None:
    """On a larger plate the same walls are inside the silhouette, and told."""
    loaded = silhouette(tmp_path, fused(box(100, 60, 5, (-10, -10, -5)), bezier_wall()))
    assert area(loaded.workpiece) == pytest.approx(6000, rel=1e-12)
    assert "free-form wall at heights 5 to 15 mm" in loaded.remarks[0]


def test_lines_and_circles_saved_as_splines_are_recognised(tmp_path: Path) -> None:
    """A plate whose every surface is a NURBS is read as the plate, and that is told."""
    solid = BRepBuilderAPI_NurbsConvert(cut(plate(), cylinder(6, 40, (20, 20, -5))), True).Shape()
    loaded = silhouette(tmp_path, solid)
    assert area(loaded.workpiece) == pytest.approx(2400 - (4 - pi) * 25 - 36 * pi, rel=1e-9)
    radii = sorted({round(s.radius, 6) for s in loaded.workpiece.segments if isinstance(s, Arc)})
    assert radii == [5, 6]
    assert loaded.remarks == ("Read 9 curves as the lines and arcs that they stand for.",)


def test_a_silhouette_of_ellipses_is_refused_with_a_remedy(tmp_path: Path) -> None:
    """An oblique cylinder has none of lines and circles; a ring that stands reaches out of its sections."""
    said = refusal(tmp_path, cylinder(5, 30, (0, 0, 0), (1, 0, 1)))
    assert re.search(
        r"nor arc: a cylinder of radius 5 mm aslant at heights .*; give another axis, or section", said
    )
    said = refusal(tmp_path, BRepPrimAPI_MakeTorus(20, 5).Solid(), axis="x")
    assert re.search(r"a rounded rim at heights 0 to 50 mm reaches [\d.]+ mm out of", said)
    assert "give section, the height" in said


def test_surfaces_without_a_solid_are_refused(tmp_path: Path) -> None:
    """The faces of a box are not part."""
    assert "surfaces (6) but no solid" in refusal(tmp_path, list_sub_shapes(box(1, 1, 1), "SHELL")[0])


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (lambda text: text[: len(text) // 2], "cut short"),
        (lambda text: text.replace("ISO-10303-21;", "ISO", 1), "not a STEP file"),
        (lambda text: text.replace("#20 = ", "#20 ((", 1), "damaged|no solid"),
        (lambda text: re.sub(r"DATA;.*ENDSEC;", "DATA;\nENDSEC;", text, flags=re.S), "damaged|no solid"),
        (lambda text: text.replace("CLOSED_SHELL", "CLOSED_SHAPE"), "damaged|no solid"),
    ],
    ids=["cut short", "no STEP", "syntax", "empty", "unknown entity"],
)
def test_broken_files_are_refused_in_one_sentence(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], damage: Any, said: str
) -> None:
    """And nothing of the library's own talk reaches the terminal."""
    path = write_step(tmp_path / "part.step", plate())
    path.write_text(damage(path.read_text()))
    capfd.readouterr()
    with pytest.raises(InputError, match=said) as caught:
        read_workpiece(path)
    assert "\n" not in str(caught.value)
    assert capfd.readouterr() == ("", "")


def test_a_solid_that_cannot_be_read_is_told(tmp_path: Path) -> None:
    """With one of two shells broken the other solid is used, and nobody takes it for all there was."""
    path = write_step(tmp_path / "part.step", box(10, 10, 10, (100, 0, 0)), plate())
    text = path.read_text()
    path.write_text(text.replace("CLOSED_SHELL", "CLOSED_SHAPE", 1))
    loaded = read_workpiece(path)
    assert area(loaded.workpiece) == pytest.approx(2400 - (4 - pi) * 25)
    assert loaded.remarks[0].startswith("The file names 2 solids, but only 1 could be read")
    path.write_text(text.replace("CLOSED_SHELL", "CLOSED_SHAPE"))
    with pytest.raises(InputError, match="no solid of the STEP file can be read"):
        read_workpiece(path)


@pytest.mark.parametrize("digits", [7, 5, 4])
def test_files_with_few_digits_are_read(tmp_path: Path, digits: int) -> None:
    """Rounded coordinates, as some programs write them, move the outline by about as much."""
    turn = gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), 0.5)
    path = write_step(tmp_path / "part.step", BRepBuilderAPI_Transform(plate(), turn, False).Shape())

    def rounded(entity: re.Match[str]) -> str:
        numbers = r"(?<=[(,])-?\d+\.\d*(E[+-]\d+)?(?=[),])"
        kept = digits + 2 if entity[1] == "DIRECTION" else digits
        return re.sub(numbers, lambda number: f"{float(number[0]):.{kept}f}", entity[0])

    path.write_text(re.sub(r"(CARTESIAN_POINT|DIRECTION|CIRCLE)\([^;]*;", rounded, path.read_text()))
    loaded = read_workpiece(path)
    assert len(loaded.workpiece.segments) == 8
    assert area(loaded.workpiece) == pytest.approx(2400 - (4 - pi) * 25, abs=500 * 10**-digits)


def test_sections_that_do_not_fill_the_solid_are_refused() -> None:
    """The volume is known twice; a solid of which one is wrong is not used."""
    refuse_missing_volume(1000.0, 1000.001, 1e-5)
    with pytest.raises(InputError, match=r"fill 1000 mm³, but it says to have 1100 mm³"):
        refuse_missing_volume(1000.0, 1100.0, 1e-2)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"unit": "mm"}, "leave unit out"),
        ({"layers": ["0"]}, "leave layers out"),
        ({"axis": "w"}, "give x, y or z"),
    ],
)
def test_options_that_do_not_fit_are_refused(tmp_path: Path, options: dict[str, Any], said: str) -> None:
    """Units and layers are for drawings; there are three axes."""
    assert said in refusal(tmp_path, plate(), **options)


def test_a_step_file_is_known_by_its_content_too(tmp_path: Path) -> None:
    """Any ending will do when the file begins with ISO-10303-21."""
    path = write_step(tmp_path / "part.step", plate()).rename(tmp_path / "part.txt")
    assert area(read_workpiece(path).workpiece) == pytest.approx(2400 - (4 - pi) * 25)


def test_the_command_line_reads_step_files(tmp_path: Path) -> None:
    """Remarks go to stderr, faces to stdout, and nothing else."""
    path = write_step(tmp_path / "part.stp", cut(plate(), cylinder(4, 30, (45, 20, 12))))
    done = subprocess.run(
        [sys.executable, "-m", "workhold", "features", str(path), "--axis", "z"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "60.000 x 40.000 mm, 8 faces" in done.stdout
    assert [line.split(":")[0] for line in done.stderr.splitlines()] == ["workhold"]


def test_all_outlines_are_plain_numbers(tmp_path: Path) -> None:
    """No negative zeros, which would show in result files."""
    loops = read(tmp_path, box(60, 40, 20)).workpiece.loops
    assert not any(np.signbit(loop[loop == 0]).any() for loop in loops)
