"""Outlines of solids at the height of the pegs (docs/solids.md): what pegs can meet, and what they may touch."""

from __future__ import annotations

import json
from collections import defaultdict
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from workhold import load

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepFeat import BRepFeat_SplitShape
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCone, BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from step_shapes import at_height, box, chamfered, cut, cylinder, filleted, fused, upright, write_step
from typer.testing import CliRunner

from solid_examples import EXAMPLES
from workhold import Fence, Plate, Restrictions, Vise, Workpiece, design, save, verify
from workhold import open as workhold_open
from workhold.cli.main import app
from workhold.errors import InputError
from workhold.files.part.survey import survey_part_file
from workhold.files.step.heights import StandingSolid, stand_solid
from workhold.files.step.library import compute_bounding_box, list_sub_shapes, turn_axis_up
from workhold.files.step.regions import cut_solid_at_height, measure_area
from workhold.files.toolkit_file import load_toolkit
from workhold.geometry.loop import compute_signed_area, make_loop_segments
from workhold.geometry.segment import Line, make_segment_rows
from workhold.kernels.base.distance import is_inside
from workhold.model.solid import Band, SolidOutline


def standing_as_read(shape: Any) -> SolidOutline:
    """How a solid stands, with pegs as high as it."""
    solid = load(shape, axis="z").solid
    assert solid is not None
    return solid


def strips(shape: Any, *heights: float, **more: float) -> list[tuple[tuple[float, ...], Band | None]]:
    """Start, bulge and band of every segment of a solid's outline, rounded."""
    outline = stand_solid(shape).make_outline(*heights, **more)
    return [
        (
            tuple(round(value, 6) + 0.0 for value in (*strip.start, strip.bulge)),
            None if strip.band is None else (round(strip.band[0], 6), round(strip.band[1], 6)),
        )
        for loop in outline.loops
        for strip in loop
    ]


def bands(shape: Any, *heights: float, **more: float) -> list[Band | None]:
    """The bands of a solid's outline in running order."""
    return [band for _, band in strips(shape, *heights, **more)]


def area(solid: StandingSolid, low: float, high: float) -> float:
    """Area of U(low, high)."""
    loops = [[(*piece.start, piece.bulge) for piece in loop] for loop in solid.find_border(low, high)]
    return sum(compute_signed_area(make_loop_segments(np.array(loop))) for loop in loops)


PLATE = box(60, 40, 20)
FLANGED = fused(PLATE, box(80, 60, 5, (-10, -10, 20)))


def test_prism() -> None:
    """A prism has its drawing at every height, and pegs press on it as high as they reach."""
    assert strips(PLATE, 12.0) == [
        ((0, 40, 0), (0, 12)),
        ((0, 0, 0), (0, 12)),
        ((60, 0, 0), (0, 12)),
        ((60, 40, 0), (0, 12)),
    ]
    assert bands(PLATE) == [(0, 20)] * 4


def test_flange_is_met_from_its_underside_on() -> None:
    """Pegs that end level with the underside of a flange are not in its way; with head room they are."""
    solid = stand_solid(FLANGED)
    assert area(solid, -1, 20.0) == pytest.approx(2400)
    assert area(solid, -1, 20.1) == pytest.approx(4800)
    assert bands(FLANGED, 20.0, 0.0) == [(0, 20)] * 4
    # With room kept free, the flange is met, and over its border no wall reaches below 20.
    assert bands(FLANGED, 20.0, 0.5) == [None] * 4
    assert bands(FLANGED, 22.0, 0.5) == [(20, 22)] * 4
    assert bands(FLANGED) == [(20, 25)] * 4


def test_fillets_and_chamfers_are_not_touched() -> None:
    """Of a wall with a rounded foot and a broken upper edge, the flat part between is touched."""
    rounded = filleted(PLATE, 3.0, at_height(0.0))
    assert bands(rounded, 15.0) == [(3, 15)] * 4
    broken = chamfered(PLATE, 2.0, at_height(20.0))
    assert bands(broken, 20.0) == [(0, 18)] * 4
    corners = filleted(PLATE, 5.0, upright)
    assert bands(corners, 20.0) == [(0, 20)] * 8


def inner_edge(low: Any, high: Any) -> bool:
    """Whether an edge lies level at height 4, away from the plate's border."""
    return at_height(4.0)(low, high) and low[0] > 1 and high[0] < 59 and low[1] > 1 and high[1] < 39


def test_foot_that_is_wider_below_the_pegs() -> None:
    """A foot keeps pegs away from the wall over it: its border is met, and touched as high as the foot is."""
    foot = filleted(fused(box(60, 40, 4), box(30, 20, 20, (15, 10, 4))), 3.0, inner_edge)
    assert bands(foot, 15.0) == [(0, 4)] * 4
    assert bands(foot, 15.0, least_band=5.0) == [None] * 4


def test_least_band_cuts_where_a_wall_slopes() -> None:
    """A wall whose upper edge rises from 4 to 16 is touched where 7 of it are over the plate."""
    slope = cut(
        box(60, 40, 16),
        BRepPrimAPI_MakeBox(
            gp_Ax2(gp_Pnt(0, -5, 4), gp_Dir(-0.2, 0, 1), gp_Dir(1, 0, 0.2)), 90, 60, 60
        ).Shape(),
    )
    found = dict(strips(slope, 16.0, least_band=7.0))
    assert found[(0, 0, 0)] is None
    assert found[(15, 0, 0)] == (0, 7)
    assert found[(60, 0, 0)] == (0, 16)
    # With a shorter least band the wall is one segment with what all of it has in common.
    assert dict(strips(slope, 16.0, least_band=2.0))[(0, 0, 0)] == (0, 4)


def test_leaning_strip_is_cut_in_pieces() -> None:
    """Of a wall between two parallel slopes, pieces as long as can be have the least band in common."""
    low = BRepPrimAPI_MakeBox(
        gp_Ax2(gp_Pnt(-10, -5, -2), gp_Dir(-0.2, 0, 1), gp_Dir(1, 0, 0.2)), 120, 60, 200
    ).Shape()
    high = BRepPrimAPI_MakeBox(
        gp_Ax2(gp_Pnt(-10, -5, 8), gp_Dir(-0.2, 0, 1), gp_Dir(1, 0, 0.2)), 120, 60, 200
    ).Shape()
    ramp = cut(BRepAlgoAPI_Common(box(60, 40, 40), low).Shape(), high)
    side = [(x, band) for (x, y, _), band in strips(ramp, 40.0, least_band=4.0) if y == 0 and x < 60 and band]
    assert len(side) >= 2
    for (x, band), (following, _) in zip(side, [*side[1:], (60.0, None)], strict=True):
        # Over all of the piece the wall is there: its lower edge at the far end, its upper at the near one.
        assert band[0] >= 0.2 * following - 1e-5
        assert band[1] <= 10 + 0.2 * x + 1e-5
        assert band[1] - band[0] >= 4 - 1e-4


def test_half_round_notch_from_below() -> None:
    """A wall is cut where a notch begins, upright or round, and beside that stands from the plate up."""
    notched = cut(PLATE, cylinder(10, 60, (30, -5, 0), (0, 1, 0)))
    found = dict(strips(notched, 15.0))
    assert (found[(0, 0, 0)], found[(40, 0, 0)]) == ((0, 15), (0, 15))
    assert [band for (x, y, _), band in found.items() if y == 0 and 20 <= x < 40 and band[1:] == (15,)]
    slotted = cut(PLATE, box(20, 60, 10, (20, -5, 0)))
    found = dict(strips(slotted, 15.0))
    assert (found[(0, 0, 0)], found[(20, 0, 0)], found[(40, 0, 0)]) == ((0, 15), (10, 15), (0, 15))


def test_holes() -> None:
    """Only a hole that is open over all heights of the pegs is one."""
    drilled = cut(
        PLATE,
        cylinder(6, 40, (15, 20, -5)),
        cylinder(4, 20, (40, 12, 8)),
        cylinder(4, 14, (40, 28, -1)),
        cylinder(3, 40, (55, 20, -5)),
    )
    outline = stand_solid(drilled).make_outline(10.0, 0.5)
    assert len(outline.loops) == 4  # through at 15, through at 55, blind from below with 12.5 > 10.5
    assert area(stand_solid(drilled), -1, 10.5) == pytest.approx(2400 - pi * (36 + 16 + 9), abs=1e-6)
    assert area(stand_solid(drilled), -1, 13.5) == pytest.approx(2400 - pi * (36 + 9), abs=1e-6)


def solids() -> list[tuple[str, Any]]:
    """Solids with steps, flanges, fillets, chamfers, draft, blind holes, slanted faces and balls."""
    cone = BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(30, 20, 5), gp_Dir(0, 0, 1)), 14, 6, 25).Shape()
    ball = BRepPrimAPI_MakeSphere(gp_Pnt(58, 20, 10), 9).Shape()
    stepped = fused(box(60, 40, 6), box(30, 20, 14, (10, 10, 6)), cylinder(6, 12, (48, 20, 6)))
    return [
        ("stepped", stepped),
        ("flanged", FLANGED),
        ("rounded", filleted(PLATE, 3.0, at_height(0.0))),
        ("all rounded", filleted(PLATE, 4.0, lambda low, high: True)),
        ("broken", chamfered(box(60, 40, 14), 1.5, lambda low, high: True)),
        ("cone on a plate", fused(box(60, 40, 8), cone)),
        ("cone below", fused(box(60, 40, 8, (0, 0, 25)), cone)),
        ("ball at the end", fused(PLATE, ball)),
        ("lying cylinder", fused(PLATE, cylinder(7, 80, (-10, 20, 10), (1, 0, 0)))),
        ("cross hole", cut(PLATE, cylinder(5, 80, (-10, 20, 0), (1, 0, 0)))),
    ]


@pytest.mark.parametrize(("name", "shape"), solids(), ids=[name for name, _ in solids()])
def test_sections_lie_within_and_fill(name: str, shape: Any) -> None:
    """Every section below the pegs lies in the outline, and the outline is no larger than they make it.

    The sections are Open CASCADE's; the areas that they cover are counted on a grid of points.
    """
    solid = stand_solid(shape)
    highest = solid.height
    points = np.stack(np.meshgrid(np.arange(-14.31, 75, 1.713), np.arange(-14.13, 60, 1.317)), -1).reshape(
        -1, 2
    )
    before = 0.0
    for high in (0.31 * highest, 0.66 * highest, highest):
        rows = make_segment_rows(
            [
                segment
                for loop in solid.find_border(-1.0, high)
                for segment in make_loop_segments(np.array([(*piece.start, piece.bulge) for piece in loop]))
            ]
        )
        within = np.array([bool(is_inside(x, y, rows)) for x, y in points])
        covered = np.array(solid.material.lies_between([(float(x), float(y)) for x, y in points], -1.0, high))
        assert (within == covered).all()
        size = area(solid, -1.0, high)
        assert size >= before - 1e-9
        before = size
        for z in np.linspace(0.02, high - 0.02, 7):
            assert measure_area(cut_solid_at_height(solid.shape, float(z))) <= size * (1 + 1e-9)


def test_solid_turned_over_twice() -> None:
    """Turned over twice the part lies as before, and U(H) is the same from both sides but mirrored."""
    shape = dict(solids())["stepped"]
    twice = turn_axis_up(turn_axis_up(shape, "-z"), "-z")
    assert strips(twice, 9.0) == strips(shape, 9.0)
    assert area(stand_solid(turn_axis_up(shape, "-z")), -1, 40) == pytest.approx(
        area(stand_solid(shape), -1, 40)
    )


def test_axes_are_right_handed() -> None:
    """The six axes turn the part and never mirror it: the corner cut off stays on the same side."""
    marked = cut(box(30, 20, 10), box(5, 4, 3))
    for axis in ("x", "y", "z", "-x", "-y", "-z"):
        solid = load(marked, axis=axis, head_room=0.0).solid
        assert solid is not None and solid.axis == axis
        assert solid.height == pytest.approx({"x": 30, "y": 20, "z": 10}[axis[-1]])
    over = load(marked, axis="-z", peg_height=3.0, head_room=0.0).loops[0]
    assert over[:, 0].min() == pytest.approx(-30)
    under = load(marked, axis="z", peg_height=3.0, head_room=0.0).loops[0]
    assert [5.0, 4.0] in np.round(under[:, :2], 6).tolist()


@pytest.mark.parametrize("height", [None, 8.0])
def test_what_other_heights_offer_is_listed_whoever_names_one(tmp_path: Path, height: float | None) -> None:
    """A flange over a foot: the table has a row below and one above the foot's top."""
    flanged = fused(box(50, 30, 10), box(50, 40, 6, (0, -5, 10)))
    path = write_step(tmp_path / "flanged.step", flanged)
    loaded = survey_part_file(path, peg_height=height).loaded
    assert loaded is not None and len({row.touchable for row in loaded.heights}) >= 2


def pegs_touch(
    solid: StandingSolid, workpiece: Workpiece, peg: Any, radius: float, pose: Any, room: float
) -> None:
    """Holds that a peg touches the solid over its band, and that with the room above it does not enter."""
    heights = workpiece.solid
    assert heights is not None
    low, high = heights.bands[peg.face] or (0.0, 0.0)
    x, y = pose.inverse.apply(peg.x, peg.y)
    whole = cylinder(radius, heights.peg_height + room, (x, y, 0.0))
    common = BRepAlgoAPI_Common(solid.shape, whole).Shape()
    assert volume(common) < 1e-3
    for z in (low, high - 1e-3):
        thin = cylinder(radius, 1e-3, (x, y, z))
        assert BRepExtrema_DistShapeShape(solid.shape, thin).Value() < 1e-6


def volume(shape: Any) -> float:
    """Volume in mm³."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    return abs(float(properties.Mass()))


def test_fixtures_hold_the_solid(tmp_path: Path) -> None:
    """Every listed peg touches the solid over its band and nothing else, by Open CASCADE's distances."""
    shape = filleted(fused(box(60, 40, 14), box(24, 20, 10, (20, 10, 14))), 3.0, at_height(0.0))
    part = load(write_step(tmp_path / "part.step", shape), peg_height=9.0)
    assert part.solid is not None
    assert [band and (round(band[0], 9), band[1]) for band in part.solid.bands] == [(3.0, 9.0)] * 4
    toolkit = load_toolkit("clamp-plate-20mm").toolkit
    result = design(part, toolkit, best=6)
    assert len(result) > 0
    solid = stand_solid(shape)
    for fixture in list(result)[:3]:
        for peg in fixture.pegs:
            carrier = toolkit.find_carrier(peg.carrier)
            pegs_touch(solid, part, peg, carrier.peg_radius, fixture.pose, 0.5)


@pytest.mark.parametrize(
    "toolkit",
    [
        Vise(pitch=10, columns=2, peg_radius=3),
        Fence(pitch=20, peg_radius=3, wall_offset=10),
        Plate(pitch=15, peg_radius=3),
    ],
    ids=lambda toolkit: type(toolkit).__name__,
)
def test_list_is_that_of_the_outline_with_faces_avoided(tmp_path: Path, toolkit: Any) -> None:
    """A solid's list is the one of its outline with the faces that nothing may touch left alone."""
    corner = gp_Ax2(gp_Pnt(40, 50, -1), gp_Dir(0, 0, 1), gp_Dir(1, -1, 0))
    body = cut(box(70, 50, 14), BRepPrimAPI_MakeBox(corner, 100, 100, 40).Shape())
    shape = fused(body, box(20, 3, 3, (10, -3, 0)))
    part = load(write_step(tmp_path / "part.step", shape), peg_height=10.0, least_band=4.0)
    assert part.solid is not None and None in part.solid.bands and any(part.solid.bands)
    flat = Workpiece.from_loops(part.name, part.loops)
    avoid = tuple(number for number, band in enumerate(part.solid.bands) if band is None)
    own = design(part, toolkit)
    other = design(flat, toolkit, restrictions=Restrictions(avoid=avoid))
    assert 0 < len(own) < len(design(flat, toolkit))
    assert own.counts == other.counts
    assert [fixture.pose for fixture in own] == [fixture.pose for fixture in other]


def test_pieces_of_one_line_with_other_bands_are_other_faces(tmp_path: Path) -> None:
    """A wall over a slot is three faces, though it is one line; where bands agree it is one."""
    slotted = cut(PLATE, box(20, 60, 10, (20, -5, 0)))
    part = load(write_step(tmp_path / "part.step", slotted), peg_height=15.0)
    assert len(part.faces) == 8
    above = load(write_step(tmp_path / "part.step", turn_axis_up(slotted, "-z")), peg_height=8.0)
    assert len(above.faces) == 4


def test_prism_file_is_its_drawing(tmp_path: Path) -> None:
    """A prism read by height is the silhouette, with bands as high as the pegs reach."""
    shape = cut(filleted(PLATE, 5.0, upright), cylinder(6, 40, (30, 20, -5)))
    path = write_step(tmp_path / "part.step", shape)
    by_height, silhouette = load(path, peg_height=15.0), load(path)
    assert by_height.solid is not None and set(by_height.solid.bands) == {(0.0, 15.0)}
    assert len(by_height.faces) == len(silhouette.faces)
    assert by_height.bounds == pytest.approx(silhouette.bounds)


REFUSED = [
    ("no wall", BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, 0), 9).Shape(), {"peg_height": 9.0}, "no upright face"),
    ("far below", box(20, 20, 20, (0, 0, 5)), {"peg_height": -1.0}, "peg_height cannot be -1 mm"),
    ("unknown axis", PLATE, {"axis": "w", "peg_height": 5.0}, "the axis 'w' is not known"),
    ("room", PLATE, {"head_room": -2.0}, "head_room cannot be -2 mm: give 0 or more"),
    (
        "section too",
        PLATE,
        {"section": 4.0, "peg_height": 5.0},
        "takes no section: leave section or peg_height out",
    ),
    ("fit too", PLATE, {"fit": 0.1, "peg_height": 5.0}, "takes no fit: leave fit or peg_height out"),
]


@pytest.mark.parametrize(("name", "shape", "view", "sentence"), REFUSED, ids=[one[0] for one in REFUSED])
def test_refusals(tmp_path: Path, name: str, shape: Any, view: dict[str, Any], sentence: str) -> None:
    """What cannot be read is refused in one sentence that says what helps."""
    with pytest.raises(InputError, match=sentence) as refused:
        load(write_step(tmp_path / "part.step", shape), **view)
    assert str(refused.value).count(". ") == 0


def test_tilted_ring_is_refused_with_its_name(tmp_path: Path) -> None:
    """A border that is neither line nor arc is refused with the face, and with a height that helps."""
    ball = fused(box(60, 40, 10), cylinder(9, 30, (50, 20, 5), (1, 0, 1)))
    with pytest.raises(InputError, match="neither line nor arc: a cylinder of radius 9 mm aslant") as refused:
        load(write_step(tmp_path / "part.step", ball), peg_height=30.0)
    assert "give peg_height" in str(refused.value)


def test_silhouette_has_its_bands(tmp_path: Path) -> None:
    """Without a height of the pegs the outline is the silhouette with the bands of a part seen as high as it is."""
    part = load(write_step(tmp_path / "flanged.step", FLANGED))
    assert part.solid is not None
    assert (part.solid.peg_height, set(part.solid.bands)) == (25.0, {(20.0, 25.0)})
    # Of a lying shaft only the ends are walls, over almost all of their width.
    lying = load(write_step(tmp_path / "lying.step", cylinder(7, 80, (0, 0, 0), (1, 0, 0))))
    assert lying.solid is not None
    touched = [face.segment for face in lying.faces if lying.solid.bands[face.number] is not None]
    for end in (0, 80):
        assert sum(one.length for one in touched if one.middle[0] == end) == pytest.approx(13.964, abs=1e-3)
    ball = BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, 0), 9).Shape()
    assert load(write_step(tmp_path / "ball.step", ball)).solid is None
    assert load(write_step(tmp_path / "section.step", FLANGED), section=10.0).solid is None


def test_a_wall_that_ends_in_a_point_is_touched_up_to_there_whichever_way_it_runs(tmp_path: Path) -> None:
    """The round ends of two lugs leave no height at their tips; the sides before them are touched all the same."""
    lug = fused(box(35, 10, 40, (30, 0, 0)), cylinder(20, 10, (65, 0, 20), (0, 1, 0)))
    other = fused(box(35, 10, 40, (30, 30, 0)), cylinder(20, 10, (65, 30, 20), (0, 1, 0)))
    part = load(write_step(tmp_path / "clevis.step", fused(fused(box(30, 40, 40), lug), other)))
    assert part.solid is not None
    sides = defaultdict[float, float](float)
    for segment, band in zip(part.segments, part.solid.bands, strict=True):
        if isinstance(segment, Line) and abs(segment.tangent[0]) == 1.0 and band is not None:
            sides[round(segment.start[1], 9)] += segment.length
    # At a height of 1 mm the tip begins 20 - sqrt(20² - 0.5²) mm before the end.
    tip = 85.0 - (20.0 - (400.0 - 0.25) ** 0.5)
    assert sides == pytest.approx({0.0: tip, 10.0: tip - 30.0, 30.0: tip - 30.0, 40.0: tip}, abs=1e-6)


def test_ends_of_a_lying_cylinder_are_touched(tmp_path: Path) -> None:
    """Its two flat ends are upright, and as high as half a circle leaves them; its sides lean."""
    part = load(write_step(tmp_path / "lying.step", cylinder(7, 80, (0, 0, 0), (1, 0, 0))))
    assert part.solid is not None
    ends = {
        round(segment.start[0], 9)
        for segment, band in zip(part.segments, part.solid.bands, strict=True)
        if band
    }
    assert ends == {0.0, 80.0}


def test_sections_that_the_library_cannot_unite_do_no_harm(tmp_path: Path) -> None:
    """A block with all edges broken and holes up to its chamfers is read by height, as are its wholes from solids."""
    block = chamfered(box(90, 60, 40), 2, lambda low, high: True)
    block = cut(
        block,
        cylinder(8, 20, (20, 15, 25)),
        cylinder(5, 20, (70, 45, -1)),
        cylinder(7, 50, (-1, 30, 20), (1, 0, 0)),
    )
    block = cut(block, cylinder(4.2, 60, (20, 45, -1)))
    path = write_step(tmp_path / "manifold.step", block)
    for part in (load(path), load(block)):
        assert part.solid is not None
        assert part.bounds == pytest.approx((0.0, 0.0, 90.0, 60.0))
        # The hole across opens one side.
        assert [len(loop) for loop in part.loops] == [10, 2]
        assert {tuple(round(z, 9) for z in band or ()) for band in part.solid.bands} == {
            (2, 38),
            (2, 13),
            (0, 40),
        }


def test_bands_in_files(tmp_path: Path) -> None:
    """A result file has the solid, the bands, and each peg's band; reading and writing changes nothing."""
    shape = fused(box(60, 40, 14), box(30, 20, 3, (15, 40, 0)))
    part = load(write_step(tmp_path / "part.step", shape), peg_height=10.0, least_band=4.0)
    vise = Vise(pitch=10, columns=2, peg_radius=3)
    result = design(part, vise, best=4)
    save(result, tmp_path / "result.json")
    written = json.loads((tmp_path / "result.json").read_text())
    assert written["solid"] == {
        "axis": "z",
        "height": 14.0,
        "peg_height": 10.0,
        "head_room": 0.5,
        "least_band": 4.0,
    }
    bands = written["workpiece"]["bands"]
    assert bands.count(None) == 3
    for fixture in written["fixtures"]:
        assert all(peg["band"] == bands[peg["segment"]] != None for peg in fixture["pegs"])  # noqa: E711
    again = workhold_open(tmp_path / "result.json")
    assert again.workpiece == part
    save(again, tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == (tmp_path / "result.json").read_bytes()
    assert load(tmp_path / "result.json") == part


def test_verification_refuses_a_peg_on_a_face_without_band(tmp_path: Path) -> None:
    """A fixture of the same outline that touches what no upright face stands over is refused by the judge."""
    shape = fused(box(60, 40, 14), box(30, 20, 3, (15, 40, 0)))
    part = load(write_step(tmp_path / "part.step", shape), peg_height=10.0, least_band=4.0)
    vise = Vise(pitch=10, columns=2, peg_radius=3)
    flat = design(Workpiece.from_loops(part.name, part.loops), vise)
    save(flat, tmp_path / "flat.json")
    forged = json.loads((tmp_path / "flat.json").read_text())
    save(design(part, vise, best=1), tmp_path / "solid.json")
    own = json.loads((tmp_path / "solid.json").read_text())
    forged |= {"solid": own["solid"], "workpiece": own["workpiece"]}
    (tmp_path / "forged.json").write_text(json.dumps(forged))
    report = verify(workhold_open(tmp_path / "forged.json"))
    assert (report.proven, report.undecided) == (len(design(part, vise)), 0)
    reasons = {one.reason.partition(",")[2] for one in report.unproven}
    assert reasons == {" over which no upright face of the solid stands"}


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"solid": {"axis": "w"}}, "the axis 'w' is not known"),
        ({"bands": [[3, 1]] * 8}, "the band 3 to 1 mm cannot be used"),
        ({"bands": [[0, 1]]}, "8 segments and 1 bands"),
        ({"bands": None}, "has a solid, but the workpiece has no bands"),
    ],
)
def test_damaged_bands(tmp_path: Path, change: dict[str, Any], sentence: str) -> None:
    """Bands of a file that cannot be are refused in one sentence."""
    shape = fused(box(60, 40, 14), box(30, 20, 3, (15, 40, 0)))
    part = load(write_step(tmp_path / "part.step", shape), peg_height=10.0)
    save(design(part, Vise(pitch=10, columns=2, peg_radius=3), best=1), tmp_path / "result.json")
    data = json.loads((tmp_path / "result.json").read_text())
    data["solid"] |= change.get("solid", {})
    if "bands" in change:
        data["workpiece"]["bands"] = change["bands"]
    (tmp_path / "result.json").write_text(json.dumps(data))
    with pytest.raises(InputError, match=sentence):
        workhold_open(tmp_path / "result.json")


def test_second_side_avoids_what_the_first_had_cut(tmp_path: Path) -> None:
    """The faces to avoid of the first set-up are found again, by the solid's faces, with the other side up."""
    marked = cut(box(60, 40, 14), box(8, 5, 20, (-1, -1, -1)))
    path = write_step(tmp_path / "part.step", marked)
    first, second = tmp_path / "op10.json", tmp_path / "op20.json"
    words = ["design", str(path), "--toolkit", "plate", "--pitch", "10", "--peg-radius", "3", "--best", "2"]
    assert CliRunner().invoke(app, [*words, "--avoid", "1", "--out", str(first)]).exit_code == 0
    over = [*words, "--axis", "-z", "--not-on-faces-cut-in", str(first), "--out", str(second)]
    assert CliRunner().invoke(app, over).exit_code == 0
    one, other = (json.loads(file.read_text()) for file in (first, second))
    cut_faces = [one["workpiece"]["solid_faces"][k] for k in one["restrictions"]["avoid"]]
    avoided = [other["workpiece"]["solid_faces"][k] for k in other["restrictions"]["avoid"]]
    assert len(cut_faces) == 1 and avoided == cut_faces
    assert other["restrictions"]["avoid"] != one["restrictions"]["avoid"]


def test_supports_of_a_solid_without_a_level_face_on_top(tmp_path: Path) -> None:
    """Of a solid without a level face on top the command for supports says so; else it has nothing to say."""
    warned = []
    leaning = BRepPrimAPI_MakeBox(
        gp_Ax2(gp_Pnt(0, -5, 10), gp_Dir(-0.1, 0, 1), gp_Dir(1, 0, 0.1)), 90, 60, 60
    )
    for name, shape in (("prism", PLATE), ("slope", cut(PLATE, leaning.Shape()))):
        part, result = write_step(tmp_path / f"{name}.step", shape), tmp_path / f"{name}.json"
        save(design(load(part), Plate(pitch=15, peg_radius=3), best=1), result)
        shown = CliRunner().invoke(app, ["supports", str(result), "1", "--pad-radius", "3"])
        assert shown.exit_code == 0
        warned.append(
            "no clamp can press from above, because no level face of the part"
            in " ".join(shown.output.split())
        )
    assert warned == [False, True]


def rounded_loops(loops: Any) -> list[list[tuple[float, ...]]]:
    """Loops with their numbers rounded, each beginning at its least vertex."""
    found = []
    for loop in loops:
        vertices = [tuple(round(one, 6) + 0.0 for one in vertex) for vertex in loop]
        first = vertices.index(min(vertices))
        found.append(vertices[first:] + vertices[:first])
    return sorted(found)


def test_level_faces_below_and_on_top() -> None:
    """Pads touch what the part lies on, without fillets and pockets; the tip what nothing stands over."""
    shape = fused(box(60, 40, 10), box(20, 40, 10, (0, 0, 10)), box(10, 40, 4, (20, 0, 16)))
    shape = cut(shape, box(10, 10, 3, (40, 15, -1)))
    rounded = filleted(shape, 2.0, lambda low, high: at_height(0.0)(low, high) and low[0] > 59)
    solid = standing_as_read(rounded)
    assert rounded_loops(solid.bottom) == [
        [(0, 0, 0), (58, 0, 0), (58, 40, 0), (0, 40, 0)],
        [(40, 15, 0), (40, 25, 0), (50, 25, 0), (50, 15, 0)],
    ]
    # What stands over the lower step from x = 20 to 30 takes that much of the face away.
    # Two faces side by side at one height are one.
    assert sorted(rounded_loops(solid.top)) == [
        [(0, 0, 0), (30, 0, 0), (30, 40, 0), (0, 40, 0)],
        [(30, 0, 0), (60, 0, 0), (60, 40, 0), (30, 40, 0)],
    ]
    feet = fused(box(10, 40, 10), box(10, 40, 10, (50, 0, 0)), box(60, 40, 5, (0, 0, 10)))
    assert len(standing_as_read(feet).bottom) == 2


def split(shape: Any, z: float, *ends: tuple[float, float]) -> Any:
    """A solid with a line imprinted on its level face at a height."""
    (ax, ay), (bx, by) = ends
    line = BRepBuilderAPI_MakeEdge(gp_Pnt(ax, ay, z), gp_Pnt(bx, by, z)).Edge()
    maker = BRepFeat_SplitShape(shape)
    maker.Add(line, next(f for f in list_sub_shapes(shape, "FACE") if at_height(z)(*compute_bounding_box(f))))
    maker.Build()
    return maker.Shape()


def test_faces_split_by_an_imprinted_line_are_one() -> None:
    """Faces of one height that lie side by side are one for pads and tip; those of other heights are not."""
    disc = cut(cylinder(20, 10, (0, 0, 0)), cylinder(5, 30, (0, 0, -1)))
    halves = split(split(PLATE, 0.0, (30, 0), (30, 40)), 20.0, (0, 20), (60, 20))
    solid = standing_as_read(halves)
    whole = [[(0, 0, 0), (60, 0, 0), (60, 40, 0), (0, 40, 0)]]
    assert rounded_loops(solid.bottom) == rounded_loops(solid.top) == whole
    lying = split(disc, 0.0, (0, 5), (0, 20))
    lying = split(lying, 0.0, (0, -20), (0, -5))
    assert len([f for f in stand_solid(lying).faces if f.lie == "level" and not f.upward]) == 2
    found = standing_as_read(lying).bottom
    areas = sorted(compute_signed_area(make_loop_segments(np.array(loop))) for loop in found)
    assert areas == pytest.approx([-25 * pi, 400 * pi])
    # A step beside a face of another height stays a face of its own.
    stepped = standing_as_read(fused(PLATE, box(20, 40, 4, (0, 0, 20))))
    assert len(stepped.top) == 2
    widths = {
        height: max(x for x, *_ in loop)
        for loop, height in zip(stepped.top, stepped.top_heights, strict=True)
    }
    assert widths == {20.0: 60.0, 24.0: 20.0}


@pytest.mark.parametrize("name", ["casting", "counterbored", "overlapped", "slanted", "valve body"])
def test_upright_lines_run_inside_where_the_library_says(name: str) -> None:
    """Over random points the intervals are those that Open CASCADE's classifier finds at random heights."""
    solid = stand_solid(next(one for one in EXAMPLES if one.name == name).make())
    chance = np.random.default_rng(5)
    boxes = solid.edge_boxes
    low, high = (*boxes[:, :2].min(axis=0), 0.0), (*boxes[:, 2:4].max(axis=0), solid.height)
    found = []
    for x, y, z in chance.uniform(low, high, (300, 3)).tolist():
        inside = any(start < z < end for start, end in solid.material.find_material_intervals((x, y)))
        assert inside == solid.material.is_inside((x, y), z), (x, y, z)
        found.append(inside)
    assert 20 < sum(found) < 280


def test_upright_lines_on_an_edge_of_two_faces_meet_them_once() -> None:
    """Through an imprinted line on both sides an upright line runs inside from the bottom to the top."""
    halves = split(split(PLATE, 0.0, (30, 0), (30, 40)), 20.0, (30, 0), (30, 40))
    ((low, high),) = stand_solid(halves).material.find_material_intervals((30.0, 12.0))
    assert (low, high) == pytest.approx((0.0, 20.0))
