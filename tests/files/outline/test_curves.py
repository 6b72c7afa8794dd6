"""Lines and arcs in disguise, and true curves, in drawings as programs write them."""

from __future__ import annotations

import json
import pickle
from math import cos, pi, sin, tan
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest
from ezdxf.math import (
    ConstructionEllipse,
    closed_uniform_bspline,
    fit_points_to_cad_cv,
    rational_bspline_from_ellipse,
)
from reading_helpers import area, read_dxf, read_svg, rectangle

import workhold
from workhold import Tolerance, Workpiece
from workhold.drawing.part_pictures import compute_first_parameter
from workhold.errors import InputError
from workhold.files.part.load import read_workpiece
from workhold.files.result.writer import make_notes_entry
from workhold.geometry.segment import Arc
from workhold.model.notes import FittedOutline

MM = 'width="200mm" height="200mm" viewBox="0 0 200 200"'
HANDLE = 4 / 3 * tan(pi / 8)
CORNERS = [(0, 0), (50, -10), (80, 20), (60, 60), (20, 50), (-10, 30)]


def circle_path(x: float, y: float, r: float, digits: int = 4) -> str:
    """A circle as drawing programs export it: four cubics, with rounded numbers."""
    ends = [(1, 0), (0, 1), (-1, 0), (0, -1)]
    words = [f"M{x + r:.{digits}f} {y:.{digits}f}"]
    for (px, py), (qx, qy) in zip(ends, ends[1:] + ends[:1], strict=True):
        rows = [(px + HANDLE * qx, py + HANDLE * qy), (qx + HANDLE * px, qy + HANDLE * py), (qx, qy)]
        words.append("C" + " ".join(f"{x + r * u:.{digits}f},{y + r * v:.{digits}f}" for u, v in rows))
    return f'<path d="{" ".join(words)} Z"/>'


def circles(part: Workpiece) -> list[float]:
    """Radii of the faces that are whole circles."""
    return [
        face.segment.radius for face in part.faces if isinstance(face.segment, Arc) and face.segment.is_full
    ]


def test_circles_as_beziers_are_circles(tmp_path: Path) -> None:
    """A disc with a hole, both four cubics: two faces of the radii drawn; how far off they are is told and counts."""
    loaded = read_svg(tmp_path, circle_path(60, 60, 50) + circle_path(60, 60, 10), MM)
    assert circles(loaded.workpiece) == [pytest.approx(50, abs=1e-4), pytest.approx(10, abs=1e-4)]
    assert loaded.workpiece.departure == pytest.approx(2.725e-4 * 50, rel=0.02)
    assert (
        "Read 2 curves as the lines and arcs that they stand for, nowhere farther than 0.014 mm off."
        in loaded.remarks
    )


def test_round_corners_as_beziers_are_arcs(tmp_path: Path) -> None:
    """A rectangle with round corners made a path, as Inkscape does it."""
    r, k = 8.0, 8 * (1 - HANDLE)
    d = (
        f"M8 0 H52 C{60 - k} 0 60 {k} 60 8 V32 C60 {40 - k} {60 - k} 40 52 40 H8 "
        f"C{k} 40 0 {40 - k} 0 32 V8 C0 {k} {k} 0 8 0 Z"
    )
    part = read_svg(tmp_path, f'<path d="{d}"/>', MM).workpiece
    arcs = [face.segment for face in part.faces if isinstance(face.segment, Arc)]
    assert [arc.radius for arc in arcs] == pytest.approx([r] * 4, abs=1e-3)
    assert area(part) == pytest.approx(2400 - (4 - pi) * r * r, abs=0.01)


def test_a_spline_that_is_a_circle_is_one(tmp_path: Path) -> None:
    """The exact rational spline of a circle: one face, no departure."""

    def draw(space: Any) -> None:
        rectangle(space, w=80, h=60)
        circle = rational_bspline_from_ellipse(ConstructionEllipse((40, 30), (0, 20), (0, 0, 1), 1.0))
        space.add_spline().apply_construction_tool(circle)

    loaded = read_dxf(tmp_path, draw)
    assert circles(loaded.workpiece) == [pytest.approx(20, abs=1e-9)]
    assert loaded.workpiece.departure == 0
    assert loaded.remarks == ("Read 1 curve as the lines and arcs that they stand for.",)


@pytest.mark.parametrize("extrusion", [(0, 0, 1), (0, 0, -1)])
def test_ellipses_of_equal_axes_are_arcs(tmp_path: Path, extrusion: tuple[float, float, float]) -> None:
    """A half ellipse of ratio 1 closes a line; seen from below it runs the other way round."""

    def draw(space: Any) -> None:
        space.add_line((-10, 0), (10, 0))
        space.add_ellipse((0, 0), (10, 0), 1.0, 0, pi, dxfattribs={"extrusion": extrusion})

    part = read_dxf(tmp_path, draw).workpiece
    assert area(part) == pytest.approx(50 * pi, rel=1e-12)
    side = extrusion[2]
    assert part.bounds == pytest.approx((-10, min(0, 10 * side), 10, max(0, 10 * side)), abs=1e-9)


@pytest.mark.thorough
def test_an_elliptical_slot_is_refused_and_fitted(tmp_path: Path) -> None:
    """A slot whose ends are half ellipses 20 high and 6 wide: refused with a fit that does, and read with it."""

    def draw(space: Any) -> None:
        rectangle(space, -40, -30, 140, 80)
        space.add_line((0, 0), (60, 0))
        space.add_line((0, 20), (60, 20))
        space.add_ellipse((60, 10), (0, 10), 0.6, pi, 2 * pi)
        space.add_ellipse((0, 10), (0, 10), 0.6, 0, pi)

    with pytest.raises(
        InputError, match=r"ELLIPSE \w+ at \(60, 0\); ELLIPSE \w+ at .* are true curves.*give fit 0\.01"
    ):
        read_dxf(tmp_path, draw)
    with pytest.raises(
        InputError, match=r"nowhere farther than 0\.0\d+ mm off, or leave their layers out with --layer"
    ):
        read_dxf(tmp_path, draw, called={"layers": "--layer", "fit": "--fit"})
    loaded = read_dxf(tmp_path, draw, fit=0.005)
    part = loaded.workpiece
    assert 0.002 < part.departure <= 0.005
    assert area(part) == pytest.approx(140 * 80 - 60 * 20 - pi * 60, abs=0.005 * 60)
    assert any(
        "in place of 2 curves, nowhere farther than 0.005 mm off" in remark for remark in loaded.remarks
    )


@pytest.mark.thorough
def test_a_closed_spline_is_fitted(tmp_path: Path) -> None:
    """A free-form outline of one periodic spline."""

    def draw(space: Any) -> None:
        space.add_spline().apply_construction_tool(closed_uniform_bspline(CORNERS))

    with pytest.raises(InputError, match=r"SPLINE \w+ at .* is a true curve"):
        read_dxf(tmp_path, draw)
    coarse, fine = (read_dxf(tmp_path, draw, fit=fit).workpiece for fit in (0.1, 0.001))
    assert len(coarse.segments) < 0.4 * len(fine.segments)
    assert area(coarse) == pytest.approx(area(fine), abs=(coarse.departure + fine.departure) * 220)


@pytest.mark.thorough
@pytest.mark.parametrize("tangents", [None, [(1, 2, 0), (0, -1, 0)]])
def test_a_spline_of_fit_points_is_the_cubic_that_cad_programs_draw(tangents: Any, tmp_path: Path) -> None:
    """Through the points, with the tangents given or straight at its ends; that it is a guess is told."""
    points = [(60, 0), (58, 14), (44, 22), (30, 40), (0, 40)]

    def draw(space: Any) -> None:
        space.add_lwpolyline([(0, 40), (0, 0), (60, 0)])
        spline = space.add_spline(points)
        if tangents:
            spline.dxf.start_tangent, spline.dxf.end_tangent = tangents

    with pytest.raises(InputError, match=r"SPLINE \w+ at \(60, 0\) is a true curve.*give fit 0.01"):
        read_dxf(tmp_path, draw)
    loaded = read_dxf(tmp_path, draw, fit=0.001)
    fitted = fit_points_to_cad_cv(points, tangents)
    segments = np.array([(*s.start, *s.end) for s in loaded.workpiece.segments])
    for place in [*fitted.approximate(40)]:
        # Ends of arcs are that near together; what is between them is bounded elsewhere.
        assert np.hypot(segments[:, 0] - place.x, segments[:, 1] - place.y).min() < 3.0
    ends = {(round(float(x), 6), round(float(y), 6)) for x, y in segments[:, :2]}
    assert {(60.0, 0.0), (0.0, 40.0)} <= ends
    exact = area(loaded.workpiece)
    outline = [(0.0, 40.0), (0.0, 0.0), *((p.x, p.y) for p in fitted.approximate(4000))]
    assert exact == pytest.approx(polygon_area(outline), abs=0.001 * 120)
    assert any("of fit points alone as the cubic through them" in remark for remark in loaded.remarks)


def polygon_area(points: list[tuple[float, float]]) -> float:
    """The area within corners."""
    x, y = np.array(points).T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2


@pytest.mark.thorough
def test_a_closed_spline_of_fit_points_has_no_corner(tmp_path: Path) -> None:
    """Points on a circle make a curve near it, the same wherever it begins."""
    areas = []
    for first in (0, 3):
        points = [(30 * cos(pi / 6 * k), 30 * sin(pi / 6 * k)) for k in range(first, first + 12)]

        def draw(space: Any, points: Any = points) -> None:
            space.add_spline(points).closed = True

        part = read_dxf(tmp_path, draw, fit=0.005).workpiece
        assert all(abs(turn) < 0.02 for turn in joint_turns(part)) and part.bounds[2] == pytest.approx(
            30, abs=0.01
        )
        areas.append(area(part))
    assert areas[0] == pytest.approx(areas[1], abs=0.005 * 200) == pytest.approx(pi * 900, rel=1e-3)


def joint_turns(part: Workpiece) -> list[float]:
    """By how much, in radians, the outline turns at each joint."""
    turns = []
    for one, other in zip(part.segments, part.segments[1:] + part.segments[:1], strict=True):
        (ax, ay), (bx, by) = (
            s.compute_normal(compute_first_parameter(s) * sign) for s, sign in ((one, -1.0), (other, 1.0))
        )
        turns.append(float(np.arctan2(ax * by - ay * bx, ax * bx + ay * by)))
    return turns


@pytest.mark.parametrize("points", [[(5, 5)], [(5, 5), (5, 5)], [(1e9, 0), (0, 1e9)]])
def test_fit_points_that_make_no_curve_are_refused(points: Any, tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        rectangle(space)
        space.add_spline(points)

    with pytest.raises(InputError, match=r"SPLINE \w+ has"):
        read_dxf(tmp_path, draw, fit=0.01)


def test_splines_off_the_plane_are_refused(tmp_path: Path) -> None:
    """A 3D sketch: one control point is higher than the rest."""

    def draw(space: Any) -> None:
        rectangle(space)
        space.add_open_spline([(5, 5, 0), (20, 30, 0), (30, 10, 4), (40, 10, 0)])

    with pytest.raises(InputError, match=r"SPLINE \w+ reaches the height z = 4 mm"):
        read_dxf(tmp_path, draw, fit=0.01)


def test_open_curves_beside_the_outline_are_left_out(tmp_path: Path) -> None:
    """A spline that is not part of an outline asks for no fit."""

    def draw(space: Any) -> None:
        rectangle(space)
        space.add_open_spline([(5, 5), (20, 30), (30, 10), (40, 10)])

    loaded = read_dxf(tmp_path, draw)
    assert area(loaded.workpiece) == pytest.approx(2400) and loaded.workpiece.departure == 0
    assert "Left out 1 open piece" in loaded.remarks[0]


def test_curves_of_another_part_ask_for_no_fit(tmp_path: Path) -> None:
    """An ellipse beside the part that is used."""

    def draw(space: Any) -> None:
        rectangle(space)
        space.add_ellipse((200, 0), (20, 0), 0.5)

    assert read_dxf(tmp_path, draw).workpiece.departure == 0
    with pytest.raises(InputError, match="true curve"):
        read_dxf(tmp_path, draw, part_number=2)


@pytest.mark.thorough
def test_elliptical_arcs_of_a_path_lie_where_they_are_drawn(tmp_path: Path) -> None:
    """Half an ellipse with radii 30 and 20, turned by 90 degrees and large or small as its flags say."""
    half = '<path d="M20 50 A30 20 90 0 {} 60 50 Z"/>'
    for sweep, low, high in ((1, 150, 180), (0, 120, 150)):
        part = read_svg(tmp_path, half.format(sweep), MM, fit=0.001).workpiece
        assert area(part) == pytest.approx(300 * pi, abs=0.001 * 120)
        assert part.bounds == pytest.approx((20, low, 60, high), abs=0.002)


@pytest.mark.parametrize("fit", [0.0, -1.0, 1e-6, float("nan"), float("inf")])
def test_a_fit_is_a_length(tmp_path: Path, fit: float) -> None:
    """Too small and no number at all."""
    with pytest.raises(InputError, match=r"The fit \S+ is not usable: give a length of 0\.0001 mm or more"):
        read_dxf(tmp_path, rectangle, fit=fit)


def test_a_fit_is_for_drawings(tmp_path: Path) -> None:
    """JSON has lines and arcs only."""
    with pytest.raises(InputError, match="leave fit out"):
        workhold.load("widget", fit=0.01)


def test_the_departure_stays_with_the_part(tmp_path: Path) -> None:
    """It is in the tolerance of the faces and so in the location error, in the result file, and in what is read from it."""

    def draw(space: Any) -> None:
        space.add_lwpolyline([(0, 0, 0), (60, 0, 0), (60, 25, 0)], format="xyb")
        space.add_open_spline([(60, 25), (45, 46), (15, 44), (0, 35)])
        space.add_line((0, 35), (0, 0))

    part = read_dxf(tmp_path, draw, fit=0.05).workpiece
    bare = Workpiece.from_loops(part.name, part.loops)
    assert part.departure > 0.02 and part != bare
    assert (
        pickle.loads(pickle.dumps(part)) == part
        and attrs.evolve(part, name="another").departure == part.departure
    )
    vise = workhold.Vise(pitch=10, columns=1, peg_radius=3)
    result = workhold.design(part, vise, best=5)
    added = workhold.design(bare, vise, best=5, tolerance=Tolerance(0.01, 0.01 + part.departure))
    assert result.query.tolerance == Tolerance(0.01, 0.01 + part.departure, departure=part.departure)
    assert len(result)
    np.testing.assert_array_equal(result.table.quality, added.table.quality)
    for name in ("result.json", "result.npz"):
        workhold.save(result, tmp_path / name)
        again = workhold.open(tmp_path / name)
        assert again.query.tolerance == result.query.tolerance
        assert again.workpiece.departure == part.departure
    written = json.loads((tmp_path / "result.json").read_text())
    assert written["workpiece"]["departure"] == part.departure
    assert written["tolerance"] == {
        "peg": 0.01,
        "face": 0.01 + part.departure,
        "fit": None,
        "departure": part.departure,
    }
    assert read_workpiece(tmp_path / "result.json").workpiece == part
    note = FittedOutline(part.departure)
    assert result.notes[-1] == again.notes[-1] == note and note not in added.notes
    assert f"up to {part.departure:.2g} mm off the drawn one" in str(note)
    assert workhold.verify(tmp_path / "result.json").holds
    silent = written | make_notes_entry([one for one in result.notes if one != note])
    (tmp_path / "result.json").write_text(json.dumps(silent))
    assert workhold.verify(tmp_path / "result.json").faults == (f'the note is missing that says "{note}"',)


def test_why_there_is_no_fixture_is_said_of_a_fitted_outline_too() -> None:
    """Before the note on what the claim is for."""
    corners = [[0, 0, 0], [41, 0, 0], [13, 37, 0]]
    for vise in (
        workhold.Vise(pitch=99, columns=1, peg_radius=2),
        workhold.Plate(pitch=99, peg_radius=2, clamps=2),
    ):
        plain, fitted = (
            workhold.design(Workpiece.from_loops("wedge", [corners], departure=departure), vise)
            for departure in (0.0, 0.01)
        )
        assert len(plain) == 0 and len(plain.notes) == 1
        assert fitted.notes == (*plain.notes, FittedOutline(0.01)) and fitted.reasons == plain.notes


def test_a_circle_of_720_chords_is_a_circle(tmp_path: Path) -> None:
    """Chords of 0.44 mm are off a circle of 50 mm by its sagitta, 0.48 µm; in single lines as well as in a polyline."""
    points = [(50 * cos(k * pi / 360), 50 * sin(k * pi / 360)) for k in range(720)]
    loaded = read_dxf(tmp_path, lambda space: space.add_lwpolyline(points, close=True))
    assert circles(loaded.workpiece) == [pytest.approx(50, abs=1e-6)]
    assert loaded.workpiece.departure == pytest.approx(50 * (1 - cos(pi / 720)), rel=1e-3)
    read, told = loaded.remarks
    assert read.startswith(
        "Read 720 segments as the longer lines and arcs that they are part of, nowhere farther than 0.00048"
    )
    assert read.endswith("mm off: the outline has 2 segments.")
    assert told.startswith(
        "Fixtures are found for this outline, which is up to 0.00048 mm off the drawing; that counts"
    )

    def loose(space: Any) -> None:
        for k in range(720):
            space.add_line(points[k - 1], points[k])

    assert circles(read_dxf(tmp_path, loose).workpiece) == [pytest.approx(50, abs=1e-6)]


def test_coarse_chords_become_arcs_with_a_fit(tmp_path: Path) -> None:
    """A plate with a slot whose ends are 12 chords each: 26 faces as drawn, four with a fit above the sagitta."""

    def draw(space: Any) -> None:
        rectangle(space, -20, -20, 100, 60)
        ends = [(40 + 10 * sin(k * pi / 12), 10 - 10 * cos(k * pi / 12)) for k in range(13)]
        space.add_lwpolyline([*ends, *((40 - x, 20 - y) for x, y in ends)], close=True)

    assert len(read_dxf(tmp_path, draw).workpiece.faces) == 4 + 26
    part = read_dxf(tmp_path, draw, fit=0.1).workpiece
    assert len(part.faces) == 4 + 4
    assert part.departure == pytest.approx(10 * (1 - cos(pi / 24)), rel=1e-6)
    assert area(part) == pytest.approx(6000 - 800 - 100 * pi, rel=1e-9)


def test_a_fine_polyline_is_exactly_what_it_was(tmp_path: Path) -> None:
    """Chords farther than a micrometre from any arc stay the polygon that was drawn."""
    points = [(30 * cos(k * pi / 8), 30 * sin(k * pi / 8)) for k in range(16)]
    loaded = read_dxf(tmp_path, lambda space: space.add_lwpolyline(points, close=True))
    assert len(loaded.workpiece.segments) == 16 and loaded.remarks == ()
