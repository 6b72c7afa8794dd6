"""Solids that pegs meet in several pieces, such as a bridge on its feet: each piece is an outer loop."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

import numpy as np
from step_shapes import box, cut, cylinder, fused, write_step

from slow_fence import slow_fence
from slow_plate import seen, slow_plate
from solid_examples import bell_crank, bridge
from solid_truth import fixture_faults
from workhold import (
    Fence,
    Fixture,
    FlatJaw,
    Plate,
    Query,
    Vise,
    Workpiece,
    answer,
    design,
    load,
    save,
    verify,
)
from workhold import open as workhold_open
from workhold.algebra import find_fixtures_by_algebra
from workhold.cli.tables import tabulate_faces
from workhold.errors import InputError
from workhold.files.part.load import read_workpiece
from workhold.files.step.heights import stand_solid
from workhold.files.step.writer import make_setup_step
from workhold.model.bodies import list_fixture_bodies
from workhold.model.own_outlines import measure_outline_diameter
from workhold.model.setup import find_hole_centers
from workhold.model.solid import SolidOutline


@pytest.fixture(scope="module")
def feet(tmp_path_factory: pytest.TempPathFactory) -> Workpiece:
    """A bridge on two feet, one of them with a hole, seen below its deck."""
    return load(write_step(tmp_path_factory.mktemp("step") / "bridge.step", bridge()), peg_height=13.0)


@pytest.fixture(scope="module")
def eyes(tmp_path_factory: pytest.TempPathFactory) -> Workpiece:
    """A bell crank seen below its arms: three rings."""
    return load(write_step(tmp_path_factory.mktemp("step") / "crank.step", bell_crank()), peg_height=3.0)


KITS = [
    Vise(pitch=10, columns=2, peg_radius=3),
    Fence(pitch=20, peg_radius=3, wall_offset=10),
    Plate(pitch=15, peg_radius=3),
    Plate(pitch=20, peg_radius=3, clamps=2, directions=[("-x", "-y")]),
    FlatJaw(pitch=20, peg_radius=3),
]


def test_outer_loops_come_first(feet: Workpiece, eyes: Workpiece) -> None:
    """The larger foot first, then the other one, then the hole; extent and hull are those of both together."""
    assert (feet.pieces, [len(loop) for loop in feet.loops]) == (2, [4, 4, 2])
    assert feet.bounds == pytest.approx((0, 0, 80, 46))
    assert measure_outline_diameter(feet) == pytest.approx(np.hypot(80, 46))
    assert find_hole_centers(feet) == [pytest.approx((10, 23))]
    assert (eyes.pieces, len(eyes.loops), eyes.outer_count) == (3, 6, 6)
    # The long sides of the hull run from foot to foot.
    lengths = sorted(round(edge.length, 6) for edge in feet.hull_edges)
    assert lengths == [46, 46, 80, 80]
    faces = feet.outer_faces
    for edge in feet.hull_edges:
        for end in (edge.start, edge.end):
            ends = [point for k in end.faces for point in (faces[k].segment.start, faces[k].segment.end)]
            assert sum(point == pytest.approx(end.point) for point in ends) == len(end.faces)
    assert all(
        edge.measure_height(segment.start) > -1e-9 for edge in eyes.hull_edges for segment in eyes.segments
    )


@pytest.mark.parametrize("toolkit", KITS, ids=lambda kit: f"{type(kit).__name__}{getattr(kit, 'clamps', '')}")
def test_fixtures_hold_pieces(feet: Workpiece, eyes: Workpiece, toolkit: Any, tmp_path: Path) -> None:
    """Pegs touch the solid and do not enter it, every fixture is proven, and files say the same when read."""
    listed = 0
    for shape, part in ((bridge(), feet), (bell_crank(), eyes)):
        result = design(part, toolkit, best=6)
        solid = stand_solid(shape).shape
        assert [fault for one in result for fault in fixture_faults(solid, part, one, toolkit)] == []
        save(result, tmp_path / "result.json")
        again = workhold_open(tmp_path / "result.json")
        assert again.workpiece == part and names(again) == names(result)
        report = verify(again)
        assert (report.proven, report.faults) == (len(result), ())
        listed += len(result)
    assert listed > 0


def test_other_searches_find_the_same(feet: Workpiece, eyes: Workpiece) -> None:
    """The algebra, and slow searches of a plate and a fence, list the same fixtures of pieces."""
    for part in (feet, eyes):
        query = Query(part, Vise(pitch=20, columns=1, peg_radius=4))
        assert names(answer(query)) == names(find_fixtures_by_algebra(query))
    plate = Plate(pitch=30, columns=2, rows=3, peg_radius=4, clamp_radius=5, directions=["-x"])
    found = seen(design(feet, plate))
    assert found == slow_plate(feet, plate) and len(found) > 10
    fence = Fence(pitch=30, columns=4, rows=3, peg_radius=4, wall_offset=10, clamp_radius=5)
    assert len(design(eyes, fence)) == len(slow_fence(eyes, fence)) > 10


@pytest.mark.prove
def test_a_slow_search_of_a_larger_plate_finds_the_same(feet: Workpiece, eyes: Workpiece) -> None:
    for part in (feet, eyes):
        plate = Plate(pitch=30, columns=3, rows=3, peg_radius=4, clamp_radius=5, directions=["-x"])
        found = seen(design(part, plate))
        assert found == slow_plate(part, plate) and len(found) > 20


def names(result: Any) -> set[tuple[Any, ...]]:
    """Holes and faces of all fixtures with their orientations."""

    def name(fixture: Fixture) -> tuple[Any, ...]:
        pegs = sorted((peg.hole, peg.face) for peg in fixture.pegs)
        return (*pegs, round(fixture.pose.theta_deg, 5))

    return {name(fixture) for fixture in result}


def test_pegs_stand_between_the_feet(feet: Workpiece) -> None:
    """Some fixture has a peg under the deck: it touches the inner side of a foot."""
    result = design(feet, Plate(pitch=10, peg_radius=3))
    inner = {face.number for face in feet.faces if abs(abs(face.segment.middle[0] - 38) - 18) < 1e-6}
    assert len(inner) == 2
    assert any(peg.face in inner for fixture in result for peg in fixture.pegs)


def test_bodies_of_pieces(feet: Workpiece) -> None:
    """The part is a body of two prisms, the hole in its foot; a set-up for CAM has a body for each."""
    toolkit = Vise(pitch=10, columns=2, peg_radius=3)
    fixture = design(feet, toolkit, best=1)[0]
    slabs = list_fixture_bodies(fixture, feet, toolkit)[0].slabs
    assert sorted(len(slab.holes) for slab in slabs) == [0, 1]
    written = make_setup_step(fixture, feet, toolkit)
    assert written.count(b"MANIFOLD_SOLID_BREP(") == 2 + 4 + 2
    assert b"bridge piece 2" in written


def test_island_in_a_hole_is_a_piece_of_its_own(tmp_path: Path) -> None:
    """A post in a ring, joined above the pegs: the ring, the post, then the hole of the ring."""
    ring = cut(cylinder(30, 12, (0, 0, 0)), cylinder(20, 30, (0, 0, -1)))
    shape = fused(ring, box(10, 10, 12, (-5, -5, 0)), cylinder(30, 5, (0, 0, 12)))
    part = load(write_step(tmp_path / "part.step", shape), peg_height=11.0)
    assert [len(loop) for loop in part.loops] == [2, 4, 2]
    assert (part.pieces, len(part.hole_segments)) == (2, 1)
    assert design(part, Plate(pitch=10, peg_radius=3), best=2)


def outline(*loops: list[tuple[float, float]]) -> SolidOutline:
    """A solid's outline of bands as high as the pegs."""
    return SolidOutline("z", 20, 10, 0.5, 1, [(0, 10)] * sum(len(loop) for loop in loops))


def square(x: float, size: float) -> list[tuple[float, float, float]]:
    """A square of a size beside the y axis."""
    return [(x, 0, 0), (x + size, 0, 0), (x + size, size, 0), (x, size, 0)]


def test_outer_loops_only_of_solids_and_before_holes() -> None:
    """A drawing has one outer loop as before; holes before an outer loop are refused."""
    two = [square(0, 10), square(20, 10)]
    assert Workpiece.from_loops("two", two, solid=outline(*two)).pieces == 2
    with pytest.raises(InputError, match="lies outside the outer loop"):
        Workpiece.from_loops("two", two)
    inside = [(x + 2, y + 2, b) for x, y, b in square(0, 5)]
    mixed = [two[0], inside, two[1]]
    with pytest.raises(InputError, match="loop 1 is a hole before an outer loop: give all outer loops first"):
        Workpiece.from_loops("two", mixed, solid=outline(*mixed))


def test_loops_run_the_other_way_keep_their_bands() -> None:
    """Outer loops and holes given in the wrong direction are turned with their bands."""
    loops = [square(0, 10), square(20, 10)[::-1]]
    bands = [(0.0, float(k + 1)) for k in range(8)]
    part = Workpiece.from_loops("two", loops, solid=SolidOutline("z", 20, 10, 0.5, 1, bands))
    assert part.solid is not None
    top = {face.segment.middle: part.solid.bands[face.number] for face in part.faces}
    assert top[20.0, 5.0] == (0.0, 8.0) and top[25.0, 10.0] == (0.0, 5.0)


def test_remark_names_the_pieces(tmp_path: Path) -> None:
    """The reader is told that there are pieces, and JSON keeps them as one part."""
    path = write_step(tmp_path / "bridge.step", bridge())
    loaded = read_workpiece(path, peg_height=13.0)
    assert "It has 2 separate pieces, between which pegs may stand." in loaded.remarks
    assert len(loaded.parts) == 1 and loaded.parts[0].area == pytest.approx(20 * 46 + 24 * 46 - 16 * np.pi)
    save(design(loaded.workpiece, KITS[0], best=1), tmp_path / "result.json")
    loops = json.loads((tmp_path / "result.json").read_text())["workpiece"]["loops"]
    assert [len(loop) for loop in loops] == [4, 4, 2]
    again = read_workpiece(tmp_path / "result.json")
    assert again.workpiece.pieces == 2 and again.parts[0].area == pytest.approx(loaded.parts[0].area)


def test_the_table_of_faces_names_pieces_and_holes(feet: Workpiece) -> None:
    """Of a part in pieces each outer loop is a piece; holes are counted from 1 after these."""
    where = {row[3] for row in tabulate_faces(feet).rows}
    assert where == {"piece 1", "piece 2", "hole 1"}
