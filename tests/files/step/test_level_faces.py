"""Level faces: where supports and a clamp on top may touch a solid, and how safe lines stand for curves of their borders."""

from __future__ import annotations

import json
from collections.abc import Sequence
from math import cos, pi, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from attrs import evolve

from shown_words import last_paragraph

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepPrimAPI import BRepPrimAPI_MakeTorus
from OCP.BRepTools import BRepTools_WireExplorer
from OCP.collections import Array1_gp_Pnt
from OCP.GC import GC_MakeSegment
from OCP.GeomAPI import GeomAPI_PointsToBSpline
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.TopAbs import TopAbs_Orientation
from step_shapes import box, cut, cylinder, filleted, fused, prism

import workhold
from workhold import Plate, load
from workhold.files.budget import LIMITS
from workhold.files.step.heights import stand_solid
from workhold.files.step.level_faces import find_bottom_loops, find_open_level_tops, trace_region
from workhold.files.step.library import list_sub_shapes, turn_axis_up
from workhold.files.supports_file import read_supports, write_supports
from workhold.geometry.loop import compute_signed_area, make_loop_segments
from workhold.geometry.segment import make_segment_rows
from workhold.kernels.base.distance import is_inside
from workhold.supports.faces import TouchableFace
from workhold.supports.words import write_flat_faces_notes
from workhold.verification.supports import verify_supports_file
from workhold.web.request_forms import WorkpieceForm

BELOW = 0.02


def area(loops: Sequence[Any]) -> float:
    """The area within loops, openings taken off."""
    return sum(compute_signed_area(make_loop_segments(np.asarray(loop))) for loop in loops)


def bored_aslant(x: float, degrees: float, radius: float = 6.0) -> Any:
    """A plate of 80 x 50 x 16 mm with a bore aslant, whose axis passes (x, 25) halfway up."""
    lean = degrees * pi / 180
    along = (sin(lean), 0.0, cos(lean))
    at = [x - 60 * along[0], 25.0, 8 - 60 * along[2]]
    return cut(box(80, 50, 16), cylinder(radius, 120, at, along))


def spline_pocket(deep: float) -> Any:
    """A plate of 80 x 50 x 16 mm with a pocket that has a wavy spline on one side, with bends both ways."""
    wave = [(20 + 4 * k, 20 + 1.5 * sin(0.8 * k)) for k in range(11)]
    points = Array1_gp_Pnt(1, len(wave))
    for k, (x, y) in enumerate(wave, 1):
        points.SetValue(k, gp_Pnt(x, y, 16 - deep))
    ends = [
        gp_Pnt(*wave[0], 16 - deep),
        gp_Pnt(20, 42, 16 - deep),
        gp_Pnt(60, 42, 16 - deep),
        gp_Pnt(*wave[-1], 16 - deep),
    ]
    sides = [GC_MakeSegment(ends[k + 1], ends[k]).Value() for k in (2, 1, 0)]
    return cut(box(80, 50, 16), prism([GeomAPI_PointsToBSpline(points).Curve(), *sides], 30))


@pytest.mark.parametrize(
    ("shape", "openings"),
    [
        (bored_aslant(40, 35), 1),
        (bored_aslant(40, 12), 1),
        (bored_aslant(4, 30), 0),  # the mouth breaks through a side
        (bored_aslant(75, -40), 0),
        (spline_pocket(5), 1),
        (spline_pocket(16), 1),
    ],
)
@pytest.mark.parametrize("axis", [False, True])
def test_a_face_with_a_free_border_is_kept_and_none_of_it_is_over_air(
    shape: Any, openings: int, axis: bool
) -> None:
    """Beside the border of a face there is material under it; what is lost is no wider than a hair."""
    solid = stand_solid(turn_axis_up(shape, "-z" if axis else "z"))
    for loops, z, below in (
        (find_bottom_loops(solid), 0.0, BELOW),
        (
            [loop for top in find_open_level_tops(solid) if top.height == 16.0 for loop in top.open],
            16.0,
            -BELOW,
        ),
    ):
        assert loops
        exact = sum(
            area_of_face(face.shape)
            for face in solid.faces
            if face.lie == "level" and face.low == z and face.upward == (z > 0)
        )
        border = sum(segment.length for loop in loops for segment in make_loop_segments(loop))
        assert exact - 0.02 * border <= area(loops) <= exact + 1e-4
        for loop in loops:
            for segment in make_loop_segments(loop):
                for share in (-0.9, -0.4, 0.0, 0.5, 0.95):
                    (x, y), (nx, ny) = (
                        segment.compute_point(share * segment.half_extent),
                        segment.compute_normal(),
                    )
                    # As far below the face as beside its border, where that is: the bore leans by 45 degrees.
                    inner = x - abs(below) / 10 * nx, y - abs(below) / 10 * ny
                    deep = solid.material.find_material_intervals(inner)
                    assert any(low <= z + below / 20 <= high for low, high in deep), (z, inner, deep)


def area_of_face(face: Any) -> float:
    """The area of a face by many points along each of its edges; the library finds it roughly with splines."""
    sizes = []
    for wire in list_sub_shapes(face, "WIRE"):
        points = []
        edges = BRepTools_WireExplorer(wire)
        while edges.More():
            edge = edges.Current()
            curve = BRepAdaptor_Curve(edge)
            at = np.linspace(curve.FirstParameter(), curve.LastParameter(), 8001)[:-1]
            if edge.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
                at = np.linspace(curve.LastParameter(), curve.FirstParameter(), 8001)[:-1]
            points += [(value.X(), value.Y()) for value in (curve.Value(float(t)) for t in at)]
            edges.Next()
        x, y = np.array(points).T
        sizes.append(abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))) / 2)
    return 2 * max(sizes) - sum(sizes)


def crown() -> Any:
    """A block of 60 x 40 mm under a crown of R 80."""
    return BRepAlgoAPI_Common(box(60, 40, 60), cylinder(80, 60, (30, -10, -40), (0, 1, 0))).Shape()


def lying() -> Any:
    """A cylinder that lies, with its flat below."""
    return cut(cylinder(20, 70, (0, 20, 12), (1, 0, 0)), box(200, 200, 100, (-50, -50, -100)))


@pytest.mark.parametrize("shape", [crown(), lying()])
def test_crowns_are_not_taken_for_flat(shape: Any) -> None:
    """There is no level face on top, and it is known that there is none."""
    part = load(shape, name="round", peg_height=11)
    assert part.solid is not None and part.solid.has_no_top and part.solid.bottom


def test_no_level_face_on_top_is_no_top_clamp(tmp_path: Path) -> None:
    """In Python, files and requests alike: none, not all of the outline; and a sentence says so."""
    part = load(crown(), name="crown", peg_height=9)
    assert part.solid is not None and part.solid.top == () and part.solid.bottom and part.solid.has_no_top
    result = workhold.design(part, Plate(pitch=10, peg_radius=3), best=1)
    found = result[0].supports(best=3, pad_radius=2, tip_radius=2)
    assert found.request.top == () and found.triples == () and found.positions > 2
    why = last_paragraph(found)
    assert "no clamp can press from above" in why and "another side up would help" in why
    (note,) = write_flat_faces_notes(part, ("a", "b"))
    assert "no clamp can press on it from above" in note
    write_supports(found, tmp_path / "s.json")
    again = read_supports(tmp_path / "s.json")
    assert again.request.top == () and again.query.workpiece.solid == part.solid
    judged = verify_supports_file(tmp_path / "s.json")
    assert judged.faults == () and judged.proven == 0
    workhold.save(result, tmp_path / "r.json")
    kept = workhold.open(tmp_path / "r.json").workpiece.solid
    assert kept is not None and kept.top == () and kept.bottom == part.solid.bottom
    form = WorkpieceForm.model_validate(workpiece_request(part))
    asked = form.to_workpiece(1000).solid
    assert asked is not None and asked.top == ()


def workpiece_request(part: Any) -> dict[str, Any]:
    """A part as the page sends it."""
    from workhold.presenting.data import describe_solid

    sent = {"name": part.name, "loops": [loop.tolist() for loop in part.loops], **describe_solid(part.solid)}
    asked: dict[str, Any] = json.loads(json.dumps(sent))
    return asked


def test_without_a_face_there_is_room_nowhere() -> None:
    """Nor with keep-out zones beside."""
    zone = np.array([(0.0, 0.0, 1.0), (4.0, 0.0, 1.0)])
    points = np.array([(0.0, 0.0), (2.0, 0.5)])
    for zones in ((), (zone,)):
        assert (TouchableFace.from_loops((), zones).measure_room(points) == -np.inf).all()


def test_a_tangent_polygon_holds_its_ellipse() -> None:
    """No vertex of an opening lies within the ellipse that it stands for, and none far from it."""
    lean = 35 * pi / 180
    solid = stand_solid(bored_aslant(40, 35))
    (top,) = find_open_level_tops(solid)
    (opening,) = [loop for loop in top.open if compute_signed_area(make_loop_segments(loop)) < 0]
    middle = 40 + 8 * sin(lean) / cos(lean)
    for x, y, bulge in opening.tolist():
        size = sqrt(((x - middle) * cos(lean) / 6) ** 2 + ((y - 25) / 6) ** 2)
        assert bulge == 0.0 and 1 - 1e-9 <= size < 1.005


def test_line_within_a_face_bounds_nothing() -> None:
    touching = fused(box(70, 50, 12), cylinder(6, 50, (35, 25, 6), (1, 0, 0)))
    (top,) = [one for one in find_open_level_tops(stand_solid(touching)) if one.height == 12.0]
    assert area(top.open) == pytest.approx(3500.0)


def test_faces_that_are_level_with_each_other_but_for_rounding_hide_nothing_of_each_other() -> None:
    """Beside a boss one half of a plate is higher by 4e-6 mm: both are open, and neither rises above the other."""
    stepped = cut(box(60, 40, 20 + 4e-6), box(40, 60, 5, (-10, -5, 20)))
    plate = fused(stepped, box(10, 10, 30, (5, 5, 0)))
    tops = find_open_level_tops(stand_solid(plate))
    assert [(round(top.height, 4), area(top.open), area(top.rising)) for top in tops] == [
        (20.0, pytest.approx(2300.0), pytest.approx(100.0)),
        (30.0, pytest.approx(100.0), 0.0),
    ]


def test_what_lies_but_for_rounding_hangs_not_and_what_only_runs_into_the_plane_does() -> None:
    """One half of a foot is 4e-6 mm up and lies; over a bore across, and a fillet that ends in the foot, it hangs."""
    uneven = cut(
        box(60, 40, 20), box(30, 40, 10, (0, 0, 4e-6 - 10)), cylinder(4, 100, (45, -20, 10), (0, 1, 0))
    )
    (top,) = find_open_level_tops(stand_solid(uneven))
    assert (area(top.open), area(top.hanging)) == (pytest.approx(2400.0), pytest.approx(8 * 40.0))
    rounded = filleted(box(60, 40, 20), 5, lambda low, high: max(high[0], high[2]) < 1e-6)
    (top,) = find_open_level_tops(stand_solid(rounded))
    assert (area(top.open), area(top.hanging)) == (pytest.approx(2400.0), pytest.approx(5 * 40.0))


def test_a_loop_around_nearly_nothing_is_no_part_of_a_region() -> None:
    """As polygons beside each other may leave it: less than anything stands on, a millionth of a square millimetre."""
    square = [
        make_loop_segments(np.array([(x, y, 0.0) for x, y in corners]))
        for corners in (
            [(0, 0), (10, 0), (10, 10), (0, 10)],
            [(20, 0), (20 + 5e-4, 0), (20 + 5e-4, 5e-4), (20, 5e-4)],
            [(30, 0), (30.01, 0), (30.01, 0.01), (30, 0.01)],
        )
    ]
    rows = make_segment_rows([segment for one in square for segment in one])
    loops = trace_region(
        [segment for one in square for segment in one], lambda point: bool(is_inside(*point, rows))
    )
    assert [area([loop]) for loop in loops] == pytest.approx([100.0, 1e-4])


def tilted_rings(count: int) -> Any:
    """A plate of 100 x 60 x 20 mm that some tilted rings of 3 mm stick out of."""
    rings = [
        BRepPrimAPI_MakeTorus(
            gp_Ax2(gp_Pnt(20.0 + 30.0 * k, 30.0, 24.0), gp_Dir(sin(0.3 + 0.2 * k), 0.2, cos(0.3 + 0.2 * k))),
            10.0,
            3.0,
        ).Shape()
        for k in range(count)
    ]
    return fused(box(100, 60, 20), *rings)


def test_what_rises_over_a_plate_is_no_part_of_its_top_however_it_is_shaped() -> None:
    """By the library's own measure: over no place of the open part is there anything, with rings in many pieces."""
    shape = tilted_rings(2)
    (top,) = (one for one in find_open_level_tops(stand_solid(shape)) if one.height == pytest.approx(20.0))
    assert 0.5 * 100 * 60 < area(top.open) < 100 * 60
    rows = make_segment_rows([segment for loop in top.open for segment in make_loop_segments(loop)])
    taken = 0
    for x, y in np.random.default_rng(3).uniform((0, 0), (100, 60), (60, 2)).tolist():
        if is_inside(x, y, rows):
            common = BRepAlgoAPI_Common(box(0.002, 0.002, 20, at=(x, y, 20.001)), shape)
            taken += list_sub_shapes(common.Shape(), "SOLID") != []
    assert taken == 0


def test_places_asked_are_bounded_and_nothing_is_open_beyond(monkeypatch: pytest.MonkeyPatch) -> None:
    """A count and no clock, so that every machine finds the same; what is not decided is not a place for a clamp."""
    solid = stand_solid(tilted_rings(1))
    assert find_open_level_tops(solid)
    monkeypatch.setitem(LIMITS, "tops", evolve(LIMITS["tops"], most_elements=50))
    assert find_open_level_tops(solid) == []
