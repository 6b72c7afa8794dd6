"""Bands of solids against upright lines of Open CASCADE: covered throughout, and alike however the part lies."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from itertools import pairwise
from math import cos, hypot, pi, radians, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from workhold import load

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRep import BRep_Builder
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeSphere, BRepPrimAPI_MakeTorus
from OCP.GC import GC_MakeArcOfCircle, GC_MakeSegment
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.TopoDS import TopoDS_Solid
from step_shapes import box, cut, cylinder, fused, prism, write_step
from typer.testing import CliRunner

from band_truth import band_faults, mirrored, placed, runs_beside, unlike
from solid_examples import cone, cross_drilled, polygon, tilted
from workhold import Vise, design
from workhold.cli.main import app
from workhold.errors import InputError
from workhold.files.step.bands import split_into_branches
from workhold.files.step.heights import (
    HeightOutline,
    find_longest_row,
    measure_outline,
    stand_solid,
    tabulate_peg_heights,
)
from workhold.files.step.library import list_sub_shapes, occ, turn_axis_up
from workhold.files.step.projected import OtherCurveError, ProjectedCurves
from workhold.geometry.loop import make_loop_segments
from workhold.geometry.segment import Arc, Line, cross_carrying_line_and_circle, make_segment_from_bulge
from workhold.geometry.subdivision import BorderPiece, CutCurve
from workhold.model.solid import HeightRow, interpolate_run


def sloped(body: Any, z: float, rise: float, across: float = 0.0) -> Any:
    """A body below a plane that passes a height at x = y = 0 and rises along x and y."""
    return cut(body, tilted((0, 0, z), (-rise, -across, 1), (1, 0, rise)))


def ball(radius: float, at: tuple[float, float, float]) -> Any:
    """A ball."""
    return BRepPrimAPI_MakeSphere(gp_Pnt(*at), radius).Shape()


def ring(at: tuple[float, float, float], major: float, minor: float) -> Any:
    """A ring about an upright axis."""
    return BRepPrimAPI_MakeTorus(gp_Ax2(gp_Pnt(*at), gp_Dir(0, 0, 1)), major, minor).Shape()


def across(x: float, z: float, radius: float) -> Any:
    """A bore along y."""
    return cylinder(radius, 200, (x, -50, z), (0, 1, 0))


def eye() -> Any:
    """A bored eye that stands on a base, flush with nothing."""
    standing_ring = cut(cylinder(15, 18, (35, 12, 26), (0, 1, 0)), cylinder(6, 30, (35, 5, 26), (0, 1, 0)))
    return fused(box(70, 12, 20), standing_ring)


def ramp() -> Any:
    """A plate of 8 mm that climbs as a ramp between two parallel slopes."""
    return cut(
        sloped(box(60, 40, 60), 12, 0.5),
        cut(box(200, 60, 90, (-10, -5, -60)), tilted((0, 0, 2), (-0.5, 0, 1), (1, 0, 0.5))),
    )


def profile(*points: tuple[float, float]) -> Any:
    """A body 40 mm wide over a polygon of places along it and heights; it runs along y."""
    return turn_axis_up(polygon(points, 40), "y")


def pad(corners: Sequence[tuple[float, float]], arc: Arc) -> Any:
    """A body 42 mm wide over places along it and heights, whose last corner an arc joins to the one before."""
    ends = [gp_Pnt(x, z, 0) for x, z in corners]
    sides = [GC_MakeSegment(a, b).Value() for a, b in pairwise([ends[-1], *ends[:-1]])]
    round_side = GC_MakeArcOfCircle(ends[-2], gp_Pnt(*arc.middle, 0), ends[-1]).Value()
    return turn_axis_up(prism([*sides, round_side], 42), "y")


SOLIDS: dict[str, Callable[[], Any]] = {
    "sloping top over a bore": lambda: cut(sloped(box(60, 40, 40), 20, 0.2), cylinder(10, 60, (30, 20, -5))),
    "steep top over a bore": lambda: cut(sloped(box(60, 40, 60), -10, 1.2), cylinder(10, 80, (30, 20, -5))),
    "sloping boss": lambda: fused(box(60, 60, 5), sloped(cylinder(14, 60, (30, 30, 0)), 3, 0.5, 0.3)),
    "domed top over a bore": lambda: cut(
        BRepAlgoAPI_Common(box(60, 40, 40), ball(45, (30, 20, -10))).Shape(), cylinder(9, 90, (22, 18, -20))
    ),
    "saddle": lambda: cut(cylinder(20, 40, (0, 0, 0)), cylinder(14, 100, (-50, 0, 40), (1, 0, 0))),
    "bore across a shaft": lambda: cut(
        cylinder(20, 40, (0, 0, 0)), cylinder(8, 100, (-50, 3, 22), (1, 0, 0))
    ),
    "aslant bore": lambda: cut(box(60, 40, 30), cylinder(6, 100, (30, -10, 2), (0, 1, 0.3))),
    "tunnel": lambda: cut(box(70, 40, 30), across(28, 0, 18)),
    "arch on legs": lambda: cut(box(70, 40, 40), across(28, 10, 12), box(24, 100, 10, (16, -10, 0))),
    "notches above": lambda: cut(box(70, 40, 30), across(30, 30, 10), across(60, 32, 6)),
    "bores of all heights": lambda: cut(
        box(90, 30, 60),
        *(across(*one) for one in ((15, 10, 5), (22, 28, 4), (50, 20, 7), (54, 34, 3), (72, 45, 4))),
    ),
    "slots": lambda: cut(
        box(80, 40, 30),
        box(10, 60, 8, (10, -5, -1)),
        box(10, 60, 8, (30, -5, 11)),
        box(10, 60, 10, (50, -5, 24)),
    ),
    "eye": eye,
    "ramp": ramp,
    "cone into a side": lambda: cut(box(60, 40, 30), cone(20, 2, 25, (30, -3, 5))),
    "ring into the top": lambda: cut(box(60, 40, 30), ring((30, 0, 30), 14, 5)),
}
CASES = [
    (name, axis, share)
    for name in SOLIDS
    for axis, share in (("z", 1.0), ("z", 0.83), ("z", 0.41), ("-z", 0.67), ("x", 0.73), ("-y", 0.57))
]


def outline_at(shape: Any, height: float) -> HeightOutline | str:
    """The outline of a standing solid, or why there is none."""
    try:
        return stand_solid(shape).make_outline(height)
    except InputError as error:
        return str(error)


@pytest.mark.parametrize(("name", "axis", "share"), CASES)
def test_bands_are_covered_and_no_longer_run_is_passed_over(name: str, axis: str, share: float) -> None:
    """A peg touches over all of its band, half as much as it can, and the moved part has the moved bands."""
    solid = stand_solid(turn_axis_up(SOLIDS[name](), axis))
    height = round(share * solid.height, 3)
    outline = outline_at(solid.shape, height)
    if isinstance(outline, str):
        assert "neither line nor arc" in outline
        return
    assert list(band_faults(solid.shape, outline, count=3)) == []
    for moved in (placed(solid.shape, 37.3, 11.1, -5.7), placed(mirrored(solid.shape), -71.9)):
        other = outline_at(moved, height)
        assert isinstance(other, HeightOutline) and unlike(outline, other) == ""


@pytest.mark.parametrize("height", [24.5, 26.0, 27.9])
@pytest.mark.parametrize("degrees", [0.0, 176.0, 180.0, 184.0, 233.0])
def test_a_closed_edge_may_be_lowest_where_it_begins(height: float, degrees: float) -> None:
    """Of a bore through a sloping top pegs touch up to the lowest point of the rim, wherever the rim begins."""
    start = gp_Dir(cos(radians(degrees)), sin(radians(degrees)), 0)
    frame = gp_Ax2(gp_Pnt(30, 20, -5), gp_Dir(0, 0, 1), start)
    bore = BRepPrimAPI_MakeCylinder(frame, 10, 80).Shape()
    outline = stand_solid(cut(sloped(box(60, 40, 40), 20, 0.2), bore)).make_outline(height)
    walls = [strip.band for loop in outline.loops for strip in loop if strip.bulge]
    assert walls and all(band == (0.0, pytest.approx(24.0, abs=1e-6)) for band in walls)


def test_a_rim_that_rises_far_is_halved_alike_from_its_lowest_point() -> None:
    """A whole circle has no joint of its own: it is halved from where its wall is lowest."""
    bore = cylinder(10, 80, (30, 20, -5))
    strips = [
        strip
        for loop in stand_solid(cut(sloped(box(60, 40, 60), -10, 1.2), bore)).make_outline().loops
        for strip in loop
        if strip.bulge
    ]
    assert all(strip.band and strip.band[0] == 0.0 for strip in strips)
    assert sorted(strip.band[1] for strip in strips if strip.band) == pytest.approx([14, 14, 26])
    # The lowest point of the rim, and the wall there, is that at (20, 20).
    assert any(strip.start == pytest.approx((20.0, 20.0), abs=1e-6) for strip in strips)


def test_what_is_steep_all_along_is_a_jump() -> None:
    """A step of 20 mm that leans by 0.02 mm: walls end where it begins, and are not halved on towards it."""
    solid = stand_solid(profile((0, 0), (60, 0), (60, 10), (17.02, 10), (17, 30), (0, 30)))
    sides = [strip for strip in solid.make_outline().loops[0] if strip.start[0] == strip.end[0]]
    found = sorted((*sorted((strip.start[1], strip.end[1])), *(strip.band or ())) for strip in sides)
    expected = [(0, 17, 0, 30)] * 2 + [(17, 17.02, 0, 10)] * 2 + [(17.02, 60, 0, 10)] * 2
    assert found == [pytest.approx(one, abs=1e-6) for one in expected]


def test_a_bore_above_the_pegs_cuts_nothing() -> None:
    """Its upright tangents are jumps where pegs reach them, and none below."""
    bored = stand_solid(cut(box(60, 40, 50), across(30, 30, 10)))
    assert [strip.band for strip in bored.make_outline(15.0, 25.0).loops[0]] == [(0.0, 15.0)] * 4
    assert len(bored.make_outline(31.0).loops[0]) > 4


def test_a_wall_over_a_sloping_underside_is_touched_as_far_as_pegs_reach_up_to_it() -> None:
    """Its edge passes the height of the pegs well before that of what is kept free above them."""
    lid = cut(box(60, 40, 40), tilted((0, 0, 5), (1 / 3, 0, -1), (1, 0, 1 / 3)))
    solid = stand_solid(fused(box(60, 30, 40, (0, 10, 0)), lid))
    touched = [
        (*sorted((strip.start[0], strip.end[0])), strip.band)
        for strip in solid.make_outline(12.0, 30.0).loops[0]
        if strip.band and max(abs(strip.start[1]), abs(strip.end[1])) < 1e-6
    ]
    assert min(low for low, _, _ in touched) == pytest.approx(0.0, abs=1e-6)
    # Wherever at least 1 mm of the wall is lower than 12 mm: where its edge is below 11.
    assert max(high for _, high, _ in touched) == pytest.approx(18.0, abs=1e-6)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_wall_that_is_just_long_enough_between_the_points_of_its_edge(sign: float) -> None:
    """Between a rising line and an arc over it, farthest or nearest at no point of the arc that is looked at."""
    arc = make_segment_from_bulge((40.0, 12.0), (10.0, 12.0), 0.15 * sign)
    assert isinstance(arc, Arc)
    body = fused(box(40, 60, 30), pad([(10, 5), (40, 5.3), (40, 12), (10, 12)], arc))
    # The arc runs along the line where it has its slope.
    across, up = 0.01 / hypot(1.0, 0.01), 1.0 / hypot(1.0, 0.01)
    x, z = arc.center[0] - sign * arc.radius * across, arc.center[1] + sign * arc.radius * up
    apart = z - (5 + 0.01 * (x - 10))
    least = apart - 5e-4 * sign
    outline = stand_solid(body).make_outline(least_band=least)
    for place, is_touched in ((x, sign > 0), (x - 3, sign < 0), (x + 3, sign < 0)):
        (strip,) = (
            strip
            for strip in outline.loops[0]
            if strip.start[0] == strip.end[0] == 42.0
            and min(strip.start[1], strip.end[1]) < place < max(strip.start[1], strip.end[1])
        )
        assert (strip.band is not None) == is_touched, place
    if sign < 0:
        # What is long enough up to there is halved at its middle.
        line = Line((10.0, 5.0 + least), (40.0, 5.3 + least))
        end = min(y for y, _ in cross_carrying_line_and_circle(line, arc.center, arc.radius))
        middles = [strip.start[1] for strip in outline.loops[0] if strip.start[0] == 42.0]
        assert min(y for y in middles if y > 10.0) == pytest.approx((10.0 + end) / 2, abs=1e-6)


def test_a_step_back_that_is_rounding_ends_no_branch() -> None:
    """Points beside a turn of an edge may come in the other order."""
    assert list(split_into_branches(np.array([0.0, 1.0, 1.0 - 1e-12, 2.0]), ())) == [(0, 3)]
    assert list(split_into_branches(np.array([0.0, 1.0, 0.9, 2.0]), ())) == [(0, 1), (1, 2), (2, 3)]


@pytest.mark.parametrize(("gap", "band"), [(8e-7, (0.0, 30.0)), (2e-6, (10.000002, 30.0))])
def test_a_gap_of_a_wall_counts_from_a_millionth_on(gap: float, band: tuple[float, float]) -> None:
    """A slot that is narrower than 1e-6 mm leaves one run."""
    solid = stand_solid(cut(box(60, 40, 30), box(20, 6, gap, (20, -1, 10))))
    (found,) = {
        strip.band
        for strip in solid.make_outline().loops[0]
        if strip.start[1] == strip.end[1] == 0.0 and strip.start[0] < 30 < strip.end[0]
    }
    assert found == pytest.approx(band, abs=1e-9)


def test_a_face_that_lies_on_a_wall_takes_nothing_off_its_run() -> None:
    """As in files with a shell too many: it reaches from 5 to 15, the wall under it up to 30."""
    builder, solid = BRep_Builder(), TopoDS_Solid()
    builder.MakeSolid(solid)
    for body in (box(60, 40, 30), box(20, 10, 10, (20, 0, 5))):
        shells = occ.TopExp_Explorer(body, occ.TopAbs_SHELL)
        builder.Add(solid, shells.Current())
    assert set(stand_solid(solid).make_outline().bands) == {(0.0, 30.0)}


@pytest.mark.parametrize(
    ("block", "touching"),
    [
        (box(60, 40, 30), cylinder(5, 20, (20, 35, 12), (1, 0, 0))),
        (box(70, 50, 12), cylinder(6, 50, (35, 25, 6), (1, 0, 0))),
    ],
)
def test_a_line_within_a_face_ends_no_run(block: Any, touching: Any) -> None:
    """Of a body that touches a face from within, an edge is left on that which bounds nothing."""
    marked = fused(block, touching)
    assert any(edge.Orientation() == occ.TopAbs_INTERNAL for edge in list_sub_shapes(marked, "EDGE"))
    solid = stand_solid(marked)
    walls = {strip.band for strip in solid.make_outline().loops[0] if not strip.bulge and strip.band}
    assert (0.0, solid.height) in walls and list(band_faults(marked, solid.make_outline())) == []


def test_of_neighbours_with_the_same_band_but_for_rounding_both_are_covered() -> None:
    """A ridge that is off the middle by 5e-6 mm: the halves beside it are one segment, as high as the lower."""
    solid = stand_solid(profile((0, 0), (64, 0), (64, 10), (32.000005, 30), (0, 10)))
    lower = 10 + 16 * 20 / 32.000005
    found = [strip.band for strip in solid.make_outline().loops[0] if strip.start[0] == strip.end[0]]
    assert [band for band in found if band and abs(band[1] - lower) < 1e-4] == [
        (0.0, pytest.approx(lower, abs=1e-8))
    ] * 2


def test_no_band_bridges_a_bore() -> None:
    """Over a bore a peg touches below it and above, and the band is one of both, covered throughout."""
    solid = stand_solid(eye())
    outline = solid.make_outline()
    for strip in outline.loops[0]:
        if strip.start[1] == strip.end[1] == 30.0 and min(strip.start[0], strip.end[0]) < 35 < max(
            strip.start[0], strip.end[0]
        ):
            assert strip.band == (pytest.approx(26 - sqrt(189), abs=1e-6), pytest.approx(20.0, abs=1e-6))
            break
    else:
        pytest.fail("nothing is touched over the bore")
    # Beside the bore the ring is touched as far as its wall is long enough.
    touched = sum(
        abs(strip.end[0] - strip.start[0])
        for strip in outline.loops[0]
        if strip.band and strip.start[1] == 30.0
    )
    assert touched == pytest.approx(2 * sqrt(15**2 - 0.5**2), abs=1e-3)


def test_walls_beside_an_arch_that_is_higher_than_the_pegs_are_touched() -> None:
    """Over an arch of 18 mm pegs of 12 mm touch its sides up to where the arch has risen to 11 mm."""
    outline = stand_solid(SOLIDS["tunnel"]()).make_outline(12.0, 8.0)
    side = [strip for strip in outline.loops[0] if strip.start[1] == strip.end[1] == 0.0 and strip.band]
    size = sum(abs(strip.end[0] - strip.start[0]) for strip in side)
    assert size == pytest.approx(70 - 2 * sqrt(18**2 - 11**2), abs=1e-3)


def test_both_sides_of_a_tunnel_are_cut_alike() -> None:
    """The upright tangent of an arch is where the walls beside it end, whatever rounding makes of it."""
    for degrees in (0.0, 37.3, 52.7, 141.0):
        solid = stand_solid(placed(SOLIDS["tunnel"](), degrees, 3.1, 0.7))
        strips = [strip for strip in solid.make_outline(29.5).loops[0] if strip.band]
        long = sorted(
            (round(hypot(*sub(strip)), 4), strip.band) for strip in strips if strip.band == (0.0, 29.5)
        )
        assert [size for size, _ in long] == [10.0, 10.0, 24.0, 24.0, 40.0, 40.0]


def sub(strip: Any) -> tuple[float, float]:
    """The vector from a strip's start to its end."""
    return strip.end[0] - strip.start[0], strip.end[1] - strip.start[1]


@pytest.mark.parametrize("name", ["eye", "bores of all heights"])
def test_the_run_at_a_contact_is_the_walls_own(name: str) -> None:
    """What a file keeps along a segment is the run that an upright line finds there, below a bore or above it."""
    solid = stand_solid(SOLIDS[name]())
    outline = solid.make_outline()
    segments = [segment for loop in outline.vertices for segment in make_loop_segments(loop)]
    looked = 0
    for segment, band, rows in zip(segments, outline.bands, outline.runs, strict=True):
        if not rows:
            continue
        assert band is not None
        for share in (0.1, 0.37, 0.5, 0.92):
            (x, y), (nx, ny) = (
                function(segment.half_extent * (2 * share - 1))
                for function in (segment.compute_point, segment.compute_normal)
            )
            runs = runs_beside(solid.shape, (x - 1e-5 * nx, y - 1e-5 * ny), 0.0, 60.0)
            (run,) = (one for one in runs if one[0] <= band[0] + 1e-4 and band[1] <= one[1] + 1e-4)
            assert interpolate_run(rows, share) == pytest.approx(run, abs=1e-4)
            looked += 1
    assert looked > 20


def test_supports_hold_for_all_that_a_peg_can_press_on(tmp_path: Path) -> None:
    """The worst heights of a peg are the run where it touches, not what its whole segment has in common."""
    path = write_step(tmp_path / "sloping.step", sloped(box(60, 40, 22), 14, 0.2))
    vise = Vise(pitch=10, columns=6, peg_radius=3)
    result = design(load(path, peg_height=20.0), vise, best=3)
    part = result.workpiece
    assert part.solid is not None and any(part.solid.runs)
    for found in result.supports(best=1, inside=1, tip_radius=3):
        fixture = found.fixture
        assert found.request.bands is not None
        for peg, run in zip(fixture.pegs, found.request.bands, strict=True):
            x, y = fixture.pose.inverse.apply(peg.x, peg.y)
            face = next(one for one in part.faces if peg.face in one.segments)
            px, _ = face.segment.compute_point(face.segment.find_parameter((x, y)))
            assert run == (0.0, pytest.approx(min(20.0, 14 + 0.2 * px), abs=1e-6))


def test_runs_survive_a_file(tmp_path: Path) -> None:
    """A result file keeps the runs, and is read back as it was; a prism's file says nothing of them."""
    path = write_step(tmp_path / "sloping.step", sloped(box(60, 40, 40), 14, 0.2))
    out = tmp_path / "result.json"
    options = ["--pitch", "10", "--columns", "2", "--peg-radius", "3", "--peg-height", "30", "--best", "2"]
    done = CliRunner().invoke(app, ["design", str(path), *options, "--out", str(out)])
    assert done.exit_code == 0, done.output
    written = json.loads(out.read_text())["workpiece"]
    assert any(written["runs"]) and len(written["runs"]) == len(written["bands"])
    done = CliRunner().invoke(app, ["verify", str(out)])
    assert done.exit_code == 0, done.output
    plain = write_step(tmp_path / "plain.step", box(60, 40, 40))
    done = CliRunner().invoke(app, ["design", str(plain), *options, "--out", str(out)])
    assert done.exit_code == 0 and "runs" not in json.loads(out.read_text())["workpiece"]


def lid_on_a_leaning_post() -> Any:
    """A plate, and a lid over it on a post that leans and reaches out between them."""
    post = cut(cylinder(10, 60, (40, 30, 0), (0.6, 0, 1)), box(300, 300, 100, (-50, -50, 25)))
    return fused(box(60, 60, 6), cut(post, box(300, 300, 6, (-50, -50, -1))), box(80, 60, 10, (0, 0, 25)))


def aslant_post() -> Any:
    """A post that leans out over its foot, and a head over it whose slanted underside hides it from above."""
    post = cut(cylinder(8, 80, (48, 30, 0), (0.5, 0, 1)), box(300, 300, 100, (-50, -50, 35)))
    post = cut(post, box(300, 300, 13, (-50, -50, -10)))
    head = cut(box(100, 60, 20, (0, 0, 20)), tilted((0, 0, 30), (-0.1, 0, -1), (1, 0, -0.1)))
    return fused(fused(box(60, 60, 6), post), head)


@pytest.mark.parametrize("name", ["post", "aslant post", "flange", "chamfer", "eye", "sloping boss"])
def test_a_row_of_heights_holds_all_through(name: str) -> None:
    """Within a row no height is refused, and where touchability jumps there is another row."""
    made = {
        "post": lid_on_a_leaning_post,
        "aslant post": aslant_post,
        "flange": lambda: fused(box(60, 40, 20), box(80, 60, 5, (-10, -10, 20))),
        "chamfer": lambda: cut(fused(box(60, 40, 12), cone(14, 10, 4, (30, 20, 12))), across(20, 0, 3)),
        **SOLIDS,
    }
    solid = stand_solid(made[name]())
    rows = tabulate_peg_heights(solid, 0.5, 1.0)
    assert rows and all(row.low < row.high for row in rows)
    for row in rows:
        touched = []
        for share in (0.02, 0.21, 0.48, 0.77, 0.998):
            outline = solid.make_outline(row.low + share * (row.high - row.low))
            touched.append(sum(length_of(strip) for loop in outline.loops for strip in loop if strip.band))
        if row.touchable == 0.0:
            assert max(touched) == 0.0
        else:
            assert min(touched) > 0.0


def length_of(strip: Any) -> float:
    """Length of the chord of a strip in mm."""
    return hypot(*sub(strip))


def test_a_row_begins_where_a_growing_band_is_long_enough() -> None:
    """A flange from 20 up is met from 19.5, and touched once a band of 1 mm is below the pegs' ends."""
    rows = tabulate_peg_heights(stand_solid(fused(box(60, 40, 20), box(80, 60, 5, (-10, -10, 20)))), 0.5, 1.0)
    assert [(row.low, row.high, row.touchable) for row in rows] == [
        (1.0, 19.5, pytest.approx(200.0)),
        (19.5, 21.0, 0.0),
        (21.0, 25.0, pytest.approx(280.0)),
    ]


def test_a_row_begins_where_walls_over_an_arch_are_long_enough() -> None:
    """An arch of 18 mm: from 19 on the wall over it is touched all along."""
    rows = tabulate_peg_heights(stand_solid(SOLIDS["tunnel"]()), 0.5, 1.0)
    assert (rows[-1].low, rows[-1].high, rows[-1].touchable) == (19.0, 30.0, pytest.approx(220.0))
    assert rows[-2].high == 19.0 and rows[-2].touchable < 219.9


def test_of_rows_that_touch_as_much_the_highest_pegs_are_named() -> None:
    rows = [
        HeightRow(low, low + 5.0, 10.0, 20.0, touch, 1.0) for low, touch in ((0, 7), (5, 9), (10, 9), (15, 8))
    ]
    assert find_longest_row(rows) == rows[2] == find_longest_row(rows[::-1])


def test_a_part_is_as_high_as_its_level_face() -> None:
    """The library's boxes of other faces are higher by 1e-7 mm."""
    solid = stand_solid(cross_drilled())
    assert solid.height == 20.0 < max(face.high for face in solid.faces)


def test_outlines_that_are_kept_are_those_of_all_that_was_asked() -> None:
    """Other heights, head rooms and lower ends make others, and so does what is told of the silhouette."""
    body = fused(box(60, 40, 8), box(84, 60, 2, (-12, -10, 8)), box(44, 26, 12, (6, 8, 10)))
    solid = stand_solid(body)
    foot, flange, stem = 60 * 40, 84 * 60, 44 * 26
    for _ in range(2):
        for expected, asked in (
            (foot, (5.0, 0.5, 1.0)),
            (flange, (18.0, 0.5, 1.0)),
            (stem, (18.0, 0.5, 1.0, 11.0)),
            (flange, (7.75, 0.5, 1.0)),
            (foot, (7.75, 0.0, 1.0)),
        ):
            assert measure_outline(solid.make_outline(*asked))[0] == pytest.approx(expected), asked
    assert any(solid.make_outline(5.0, 0.5, 1.0).bands) and not any(solid.make_outline(5.0, 0.5, 6.0).bands)
    feet = stand_solid(cut(box(60, 40, 20), box(20, 60, 10, (20, -5, 0))))
    first = [strip.covered[0].piece.carrier.segment for strip in feet.make_outline(6.0).loops[0]]
    for _ in range(2):
        assert len(feet.make_outline(5.0, silhouette=first).loops) == 1
        assert len(feet.make_outline(5.0).loops) == 2


def test_an_outline_that_does_not_close_is_laid_to_the_face_that_leans() -> None:
    """And not to the flat one that it cuts."""
    solid = stand_solid(SOLIDS["cone into a side"]())
    kinds = [face.kind for face in solid.faces]
    carrier = CutCurve(Line((0.0, 0.0), (9.0, 0.0)), [(-4.5, 4.5)])
    pieces = [BorderPiece(carrier, -4.5, 4.5, True)]
    points = np.zeros((3, 2))
    flat, leaning = next(k for k, kind in enumerate(kinds) if kind == "wall"), kinds.index("cone")
    others = ((flat, points), (leaning, points))
    with pytest.raises(OtherCurveError, match="neither line nor arc: a cone at heights"):
        solid.close_loops(pieces, ProjectedCurves((), (), others))
    with pytest.raises(InputError, match="does not close at"):
        solid.close_loops(pieces, ProjectedCurves((), (), ()))


@pytest.mark.parametrize("aside", [2e-5, 1e-6, 3e-4, -2e-5, 0.0])
def test_a_slot_that_all_but_touches_a_hole(aside: float) -> None:
    """A blind slot from below as wide as a hole through, but for rounding, leaves the hole as it is."""
    body = cut(box(20, 16, 4, (-10, -8, 0)), cylinder(1.7, 10, (0, 0, -1)))
    for degrees in (0.0, 45.0):
        slot = box(2 * (1.7 + aside), 6, 2.5, (-1.7 - aside, -3, -1))
        part = load(placed(cut(body, slot), degrees), peg_height=5.0)
        assert len(part.loops) == 2
        hole = part.loop_segments[1]
        assert all(segment.radius == pytest.approx(1.7, abs=1e-6) for segment in hole)
        assert sum(segment.length for segment in hole) == pytest.approx(2 * pi * 1.7, abs=1e-3)


@pytest.mark.parametrize("radius", [0.7, 1.5, 3.0, 5.5])
@pytest.mark.parametrize("turn", [0.0, 37.3])
def test_a_small_bore_across_a_shaft_is_not_pressed_on(radius: float, turn: float) -> None:
    """Its short rims lie on the shaft's circle, and not on the circles that fit them best."""
    solid = stand_solid(
        placed(cut(cylinder(20, 40, (0, 0, 0)), cylinder(radius, 60, (-30, 0, 20), (1, 0, 0))), turn)
    )
    outline = solid.make_outline(30.0)
    assert list(band_faults(solid.shape, outline)) == []
    beside = [band for band in outline.bands if band and band[1] < 25]
    assert beside == [(0.0, pytest.approx(20 - radius, abs=1e-6))] * len(beside) and len(beside) >= 2
    # Pegs that end below it know nothing of it.
    for height in (20 - radius - 0.6, 20 - radius - 0.5):
        assert set(solid.make_outline(height).bands) == {(0.0, height)}


def test_an_edge_of_a_wall_runs_along_the_wall() -> None:
    """Of every bore across a shaft, however short its rims: on one line or circle with all other edges of the wall."""
    bores = [cylinder(0.4 + 0.3 * k, 60, (-30, 0, 5 + 5 * k), (1, 0.2 * k, 0)) for k in range(6)]
    solid = stand_solid(cut(cylinder(20, 40, (0, 0, 0)), *bores))
    arcs = [
        edge.segment
        for edge in solid.edges
        if solid.faces[edge.face].lie == "upright" and edge.segment is not None
    ]
    assert len(arcs) == 14 and all(isinstance(one, Arc) for one in arcs)
    for one in arcs:
        assert isinstance(one, Arc)
        assert (*one.center, one.radius) == pytest.approx((0.0, 0.0, 20.0), abs=1e-9)


@pytest.mark.parametrize("below", [5.0, 0.1, 5e-3, 3e-3, 1e-3, 1e-4, 1e-5])
def test_a_tunnel_is_open_up_to_its_crown(below: float) -> None:
    """Where it is cut just below that, the two sides rise by next to nothing from the cut."""
    bored = stand_solid(placed(cut(box(70, 40, 30), across(28, 0, 18)), 37.3))
    high = 18.0 - below
    area, _, _, _ = measure_outline(bored.make_outline(high - 0.5))
    assert area == pytest.approx(40 * (70 - 2 * sqrt(18**2 - high**2)), abs=2e-4)


@pytest.mark.parametrize("rise", [0.1, 0.01, 0.002])
def test_an_underside_that_hardly_rises_is_cut_where_pegs_end(rise: float) -> None:
    """What lies beyond the cut is over the pegs, however little."""
    wedge = stand_solid(cut(box(60, 40, 40), tilted((0, 0, 0), (rise, 0, -1), (1, 0, rise))))
    area, _, _, _ = measure_outline(wedge.make_outline(24 * rise, 6 * rise, least_band=1e-3))
    assert area == pytest.approx(40 * 30, abs=1e-3)


@pytest.mark.parametrize("aslant", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("height", [10.0, 10.0 - 1e-9, 10.0 + 1e-9])
def test_pegs_may_end_level_with_the_crown_of_a_tunnel(aslant: float, height: float) -> None:
    """Over the crown nothing is left to touch, but beside it there is, from the tunnel's wall up."""
    bored = stand_solid(cut(box(70, 50, 30), cylinder(10, 120, (20, -10, 0), (aslant, 1, 0))))
    outline = bored.make_outline(height)
    assert list(band_faults(bored.shape, outline, count=7)) == []
    assert measure_outline(outline)[2] == pytest.approx(
        measure_outline(bored.make_outline(height + 1e-3))[2], abs=0.05
    )


@pytest.mark.parametrize("aslant", [0.0, 0.4])
@pytest.mark.parametrize("above", [1e-6, 3e-6, 8e-6, 1.2e-5])
def test_what_bridges_a_tunnel_may_be_as_thin_as_rounding(aslant: float, above: float) -> None:
    """Over the middle of the opening too little of it to be seen lies below the end of the pegs, and more beside."""
    bored = stand_solid(cut(box(70, 50, 30), cylinder(10, 120, (20, -10, 0), (aslant, 1, 0))))
    area, border, _, _ = measure_outline(bored.make_outline(9.5 + above))
    assert (area, border) == pytest.approx((70 * 50, 2 * (70 + 50)), abs=1e-6)


@pytest.mark.parametrize("off", [0.0, *(s * k for k in (1e-6, 2e-6, 5e-6, 8e-6, 2e-5) for s in (1, -1))])
def test_pegs_may_end_next_to_a_corner_of_a_slope(off: float) -> None:
    """Its height is that of a corner to five digits: the sides of the cut are too near to the edge to be seen."""
    ridge = cut(sloped(box(60, 40, 40), 14, 0.5), tilted((60, 0, 22), (0.4, 0, 1), (-1, 0, 0.4)))
    solid = stand_solid(turn_axis_up(cut(ridge, cylinder(8, 80, (31, 20, -5))), "-z"))
    (corner,) = {round(z, 9) for face in solid.faces for z in (face.low, face.high) if 15 < z < 20}
    area, _, _, _ = measure_outline(solid.make_outline(corner + off - 0.5))
    assert area == pytest.approx(60 * 40 - 64 * pi, abs=5e-3)
