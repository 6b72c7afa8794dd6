"""Where a clamp on top stands on solids: judged by Open CASCADE, which sees the tip, its head and what is under it."""

from __future__ import annotations

import json
from collections.abc import Callable
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from shown_words import last_paragraph

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from attrs import evolve
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepGProp import BRepGProp
from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.gp import gp_Dir, gp_Lin, gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.IntCurvesFace import IntCurvesFace_ShapeIntersector
from step_shapes import box, cylinder, fused

import workhold
from solid_examples import EXAMPLES
from solid_truth import distance, segments_of
from top_examples import (
    bolted_plate,
    clevis,
    domed_cover,
    overhang,
    pillow_block,
    tee,
    webbed_cover,
)
from workhold import Plate, load
from workhold.drawing import SheetDetails
from workhold.drawing.sheet_writing import find_sheet_heights
from workhold.files.step.heights import stand_solid
from workhold.files.step.level_faces import LevelTop, find_open_level_tops
from workhold.files.step.library import turn_axis_up
from workhold.files.supports_file import read_supports, write_supports
from workhold.fixels.support_hardware import TopClamp
from workhold.geometry.segment import make_segment_rows
from workhold.kernels.base.distance import is_inside, measure_outline_distances
from workhold.model.support_request import find_pressed_heights
from workhold.model.support_triples import ChosenSupports, Supports
from workhold.supports.words import write_listing_notes
from workhold.units import MILLIMETRE
from workhold.verification.supports import verify_supports_file

# mm. Nearer to a border nobody says on which side a point is; polygons hold curves within so much.
NEAR = 0.05
TOOLKIT = Plate(pitch=10, peg_radius=3, top_clamp=TopClamp(tip_margin=1))
PARTS = (pillow_block, clevis, bolted_plate, webbed_cover, tee, overhang, domed_cover)


class Rays:
    """Upright lines through a solid, each as heights with whether the face there is level."""

    def __init__(self, shape: Any) -> None:
        self.meeting = IntCurvesFace_ShapeIntersector()
        self.meeting.Load(shape, 1e-7)

    def at(self, x: float, y: float) -> list[tuple[float, bool]]:
        """From the lowest up."""
        self.meeting.Perform(gp_Lin(gp_Pnt(x, y, -10.0), gp_Dir(0, 0, 1)), -1.0, 1e4)
        found: list[tuple[float, bool]] = []
        hits = [(self.meeting.Pnt(k).Z(), k) for k in range(1, self.meeting.NbPnt() + 1)]
        for z, k in sorted(hits):
            surface = BRepAdaptor_Surface(self.meeting.Face(k))
            is_level = (
                surface.GetType() == GeomAbs_SurfaceType.GeomAbs_Plane
                and abs(surface.Plane().Axis().Direction().Z()) > 1 - 1e-9
            )
            if not found or z - found[-1][0] > 1e-6:
                found.append((z, is_level))
        return found


def holds(loops: list[Any], x: float, y: float) -> bool:
    """Whether a region holds a point."""
    return bool(loops) and bool(is_inside(x, y, make_segment_rows(segments_of(loops))))


def sky_faults(shape: Any, tops: list[LevelTop], count: int, seed: int) -> list[str]:
    """Points at which the upper faces are not what upright lines through the solid meet.

    The highest face that a line meets is the only one that is open there. Above a height something rises where
    the line meets anything higher. A face hangs where the line leaves the solid between it and the plane.
    """
    rays, low, high = Rays(shape), np.full(2, np.inf), np.full(2, -np.inf)
    loops = [loop for top in tops for loop in (*top.open, *top.rising, *top.hanging)]
    for loop in loops:
        low, high = np.minimum(low, loop[:, :2].min(axis=0)), np.maximum(high, loop[:, :2].max(axis=0))
    points = np.random.default_rng(seed).uniform(low - 2.0, high + 2.0, (count, 2))
    rows = [make_segment_rows(segments_of([loop])) for loop in loops]
    away = np.min([measure_outline_distances(points, one) for one in rows], axis=0)
    faults = []
    for x, y in points[away > NEAR].tolist():
        met = rays.at(x, y)
        if len(met) % 2:
            continue
        seen = met[-1][0] if met and met[-1][1] else nan
        own = [top for top in tops if holds(top.open, x, y)]
        if len(own) != int(seen == seen) or any(abs(top.height - seen) > 1e-6 for top in own):
            faults.append(
                f"at ({x:.6g}, {y:.6g}) the sky is over {seen}, and {[top.height for top in own]} is open"
            )
        for top in tops:
            if any(z > top.height + 1e-5 for z, _ in met) != holds(top.rising, x, y):
                faults.append(f"what rises above {top.height:g} is wrong at ({x:.6g}, {y:.6g})")
        for top in own:
            if (len(met) > 2 or abs(met[0][0]) > 1e-6) != holds(top.hanging, x, y):
                faults.append(f"what hangs of {top.height:g} is wrong at ({x:.6g}, {y:.6g})")
    return faults


@pytest.mark.parametrize("make", PARTS)
@pytest.mark.parametrize("axis", ["z", "-z", "x"])
def test_faces_count_as_far_as_they_are_open_to_the_sky(make: Callable[[], Any], axis: str) -> None:
    """Nothing of them is dropped, and nothing is taken that has anything above it or is not flat."""
    solid = stand_solid(turn_axis_up(make(), axis))
    tops = find_open_level_tops(solid)
    assert tops and sky_faults(solid.shape, tops, 150, 3) == []


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda one: one.name)
def test_so_do_those_of_all_solids(example: Any) -> None:
    """Fillets that run out into a face, cones, lying bores and slots among them."""
    solid = stand_solid(example.make())
    tops = find_open_level_tops(solid)
    assert tops or example.name in ("slanted", "lying shaft")
    assert not tops or sky_faults(solid.shape, tops, 100, 5) == []


def test_half_of_a_foot_under_a_round_arm_is_half_open() -> None:
    """By hand: the foot less the post, the arm and the half disc at its end."""
    solid = stand_solid(overhang())
    (foot,) = [top for top in find_open_level_tops(solid) if top.height == 15.0]
    size = sum(abs_area(loop) for loop in foot.open[:1]) - sum(abs_area(loop) for loop in foot.open[1:])
    assert size == pytest.approx(100 * 60 - 20 * 60 - 20 * 30 - np.pi * 15**2 / 2, abs=1e-6)


def abs_area(loop: Any) -> float:
    """The area within a loop of lines and arcs."""
    from workhold.geometry.loop import compute_signed_area, make_loop_segments

    return abs(compute_signed_area(make_loop_segments(np.asarray(loop))))


def test_what_a_pipe_aslant_covers_is_off_within_a_hair() -> None:
    """Its ends over the plate are ellipses: the enclosure takes nothing that is farther away, and leaves none."""
    shape = fused(box(90, 60, 10), box(10, 60, 50), cylinder(7, 60, (5, 30, 20), (1, 0.2, 0.5)))
    solid = stand_solid(shape)
    tops = find_open_level_tops(solid)
    assert {top.height for top in tops} >= {10.0, 50.0}
    assert sky_faults(solid.shape, tops, 300, 7) == []


def supported(make: Callable[[], Any], peg_height: float, **asked: Any) -> Supports:
    """The supports under the first fixture of a part."""
    part = load(make(), name=make.__name__, peg_height=peg_height)
    return workhold.design(part, TOOLKIT, best=1)[0].supports(best=3, **asked)


def volume(shape: Any) -> float:
    """In mm³."""
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, found)
    return abs(found.Mass())


def solid_share(shape: Any, body: Any) -> float:
    """How much of a body lies in a solid."""
    return volume(BRepAlgoAPI_Common(shape, body).Shape()) / volume(body)


HEIGHTS = {
    "pillow_block": 13.0,
    "clevis": 18.0,
    "bolted_plate": 11.0,
    "webbed_cover": 14.0,
    "tee": 28.0,
    "overhang": 14.0,
}


@pytest.mark.parametrize("make", PARTS[:-1])
def test_tip_head_and_column_are_what_the_library_sees(make: Callable[[], Any], tmp_path: Path) -> None:
    """The tip with its margin lies on material, its head meets nothing, and under it the part is or is not."""
    shape, found = make(), supported(make, HEIGHTS[make.__name__])
    request = found.request
    assert found.triples and request.tip_margin == 1.0 and request.head_radius == 1.5 * request.tip_radius
    for triple in found.triples:
        for clamp in (triple.best.at, triple.arm_at):
            z, wide = request.find_clamped_height(clamp), request.tip_radius + request.tip_margin - 1e-5
            assert solid_share(shape, cylinder(wide, 0.5, (*clamp, z - 0.5))) == pytest.approx(1.0, abs=1e-6)
            above = cylinder(request.head_radius - 1e-5, 200, (*clamp, z + 1e-3))
            assert distance(above, shape) > 1e-6
        met = Rays(shape).at(*triple.best.at)
        assert triple.best.hangs == (len(met) != 2)
    write_supports(found, tmp_path / "s.json")
    judged = verify_supports_file(tmp_path / "s.json")
    assert (judged.refuted, judged.faults) == (0, ()) and judged.proven == len(found.triples)
    again = read_supports(tmp_path / "s.json")
    assert [one.best for one in again.triples] == [one.best for one in found.triples]
    assert again.request == found.request


def test_a_pillow_block_is_clamped_on_its_feet_or_nowhere() -> None:
    """At 14, beside the body; feet too short for the head leave no top clamp, and the sentence says so."""
    found = supported(pillow_block, 13.0)
    for triple in found.triples:
        x, _ = triple.clamp.at
        assert found.request.find_clamped_height(triple.clamp.at) == 14.0 and abs(x) >= 36 + 7.5 - 1e-6
    part = load(pillow_block(12.0), name="pillow block", peg_height=13)
    none = workhold.design(part, TOOLKIT, best=1)[0].supports(best=3)
    words = last_paragraph(none)
    assert (
        not none.triples
        and none.count == 0
        and "no clamp can press from above" in words
        and "7.500 mm" in words
    )


def test_a_head_does_not_stand_in_a_narrow_slot() -> None:
    """A clevis with a slot of 14: the tip fits in it, its head of 15 across does not."""
    part = load(clevis(14.0), name="clevis", peg_height=18)
    fixture = workhold.design(part, TOOLKIT, best=1)[0]
    for head, fits in ((7.5, False), (7.0, True)):
        found = fixture.supports(best=1, head_radius=head, tip_radius=5.0, inside=1.0)
        on_base = [one for one in found.triples if found.request.find_clamped_height(one.clamp.at) == 20.0]
        assert bool(on_base) is fits, head


def test_a_web_over_air_comes_after_what_reaches_down() -> None:
    """On the rim, in part at least, before any place over the web; a tip too wide for the rim hangs, and it is said."""
    found = supported(webbed_cover, 14.0)
    assert not any(triple.clamp.hangs for triple in found.triples)
    assert not any(over_web(triple.clamp.at) for triple in found.triples)
    wide = supported(webbed_cover, 14.0, tip_radius=8.0)
    assert all(triple.clamp.hangs and over_web(triple.clamp.at) for triple in wide.triples)
    notes = " ".join(write_listing_notes(wide, wide.triples, MILLIMETRE, ("a", "b")))
    assert "Over each the clamp presses where there is air below the part" in notes


def over_web(place: tuple[float, float]) -> bool:
    """Whether a place of the cover is over its web."""
    return 12 < place[0] < 88 and 12 < place[1] < 58


def test_a_tip_keeps_off_bolt_holes() -> None:
    """At least its radius and margin from every hole's edge."""
    found = supported(bolted_plate, 11.0, top_zones=[workhold.circle_zone(60, 30, 40)], inside=2.0)
    for triple in found.triples:
        x, y = triple.clamp.at
        assert min(np.hypot(x - a, y - b) for a in (14, 106) for b in (14, 46)) >= 5 + 5 + 1 - 1e-6


def test_triples_from_which_the_part_falls_come_last() -> None:
    """Of a whole list, and the checker minds."""
    found = supported(webbed_cover, 14.0)
    every = workhold.design(found.query.workpiece, TOOLKIT, best=1)[0].supports(best=None)
    falls = [triple.standing < -1e-9 for triple in every.triples]
    assert any(falls) and not all(falls) and falls == sorted(falls)
    assert [one.supports for one in every.triples[:3]] == [one.supports for one in found.triples]


def tampered(found: Supports, path: Path, change: Callable[[dict[str, Any]], None]) -> list[str]:
    """What the checker says of a file of supports in which something was changed."""
    write_supports(found, path, overwrite=True)
    entry = json.loads(path.read_text())
    change(entry)
    path.write_text(json.dumps(entry))
    judged = verify_supports_file(path)
    return [*judged.faults, *(one.reason for one in judged.unproven)]


def test_the_checker_minds_margin_head_hanging_and_order(tmp_path: Path) -> None:
    """Each rule is judged from the file alone, by arithmetic of its own."""
    found, path = supported(pillow_block, 13.0), tmp_path / "s.json"
    assert tampered(found, path, lambda entry: None) == []
    for key, value in (("tip_margin", 3.0), ("head_radius", 8.0)):
        said = tampered(found, path, lambda entry, key=key, value=value: entry["clamp"].update({key: value}))
        assert any("may not stand at the best point" in one for one in said), key
    cover = supported(webbed_cover, 14.0)

    def falls(entry: dict[str, Any]) -> None:
        entry["triples"][0]["standing"] = -1.0

    def hides(entry: dict[str, Any]) -> None:
        entry["triples"][0]["best"]["hangs"] = True

    def unhang(entry: dict[str, Any]) -> None:
        loop = [[12.0, 12.0, 0.0], [88.0, 12.0, 0.0], [88.0, 60.0, 0.0], [12.0, 60.0, 0.0]]
        entry["clamp"]["hanging"] = [loop]

    def reverse(entry: dict[str, Any]) -> None:
        entry["triples"] = entry["triples"][::-1]

    assert any("standing is" in one for one in tampered(cover, path, falls))
    assert any("over air" in one for one in tampered(cover, path, hides))
    assert any("better placed" in one or "over air" in one for one in tampered(cover, path, unhang))
    part = cover.query.workpiece
    every = workhold.design(part, TOOLKIT, best=1)[0].supports(best=None)
    kinds = [(one.standing < 0, one.clamp.hangs) for one in every.triples]
    cuts = [k for k in range(1, len(kinds)) if kinds[k] != kinds[k - 1]]
    assert cuts
    few = evolve(every, triples=tuple(every.triples[k] for k in (cuts[0] - 1, cuts[0])), count=None)
    assert tampered(few, path, lambda entry: None) == []
    assert any("comes after" in one for one in tampered(few, path, reverse))


def test_an_empty_top_is_written_as_a_face_around_nothing(tmp_path: Path) -> None:
    """No reader can take it for all of the outline, as some take an empty list."""
    crown = BRepAlgoAPI_Common(box(60, 40, 60), cylinder(80, 60, (30, -10, -40), (0, 1, 0))).Shape()
    part = load(crown, name="crown", peg_height=9)
    none = workhold.design(part, TOOLKIT, best=1)[0].supports(best=3, pad_radius=2, tip_radius=2)
    write_supports(none, tmp_path / "s.json")
    entry = json.loads((tmp_path / "s.json").read_text())
    assert entry["clamp"]["top"] == [[]] and entry["triples"] == []
    assert read_supports(tmp_path / "s.json").request.top == ()


def test_pegs_press_over_their_own_runs_with_supports_and_without() -> None:
    """The sheet's heights are the whole run at each contact, up to the top of the pegs."""
    found = supported(clevis, 18.0)
    fixture, part = found.fixture, found.query.workpiece
    chosen = ChosenSupports.from_supports(found)
    plain = SheetDetails(number=1, count=1, day="", result_hash="", version="")
    for details in (plain, evolve(plain, supports=chosen)):
        heights = find_sheet_heights(fixture, part, TOOLKIT, details)
        assert heights is not None
        own = [find_pressed_heights(peg, fixture, part.numbered) for peg in fixture.pegs]
        assert list(heights.bands) == own and all(band == (0.0, 18.0) for band in own)
    low = find_sheet_heights(
        fixture, part, TOOLKIT, evolve(plain, supports=chosen, peg_height=22.0, support_height=10.0)
    )
    assert low is not None and all(band == (0.0, 12.0) for band in low.bands)
