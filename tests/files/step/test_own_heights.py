"""Carriers with heights of their own on solids: their outlines, bands, and fixtures as bodies against the solid."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from step_shapes import box, cut, cylinder, fused, write_step

import workhold
from glb_reading import fixture_glb, read_glb
from solid_truth import fixture_faults, off_region, section_points, segments_of
from workhold import Fence, FlatJaw, InputError, Plate, Vise, design, load
from workhold.files.step.heights import stand_solid
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import make_segment_rows

TIP = (11.0, 18.0)


def flanged() -> Any:
    """A foot, a flange over it from 8 to 10, and above that a stem with a slanted side and a blind bore."""
    foot, flange = box(60, 40, 8), box(84, 60, 2, (-12, -10, 8))
    stem = fused(box(44, 26, 12, (6, 8, 10)), cylinder(10, 12, (50, 21, 10)))
    return cut(fused(foot, flange, stem), cylinder(5, 6, (20, 20, 16)))


SOLID = flanged()
HELD: dict[str, Toolkit] = {
    "plate": Plate(pitch=(16, 14), peg_radius=3, clamp_radius=4, directions=("-x",), clamp_heights=TIP),
    "fence": Fence(
        pitch=(16, 14), peg_radius=3, wall_offset=8, clamps=2, directions=(("-x", "-y"),), wall_heights=(0, 4)
    ),
    "vise": Vise(pitch=(14, 12), columns=2, peg_radius=3, left_heights=(0, 7), right_heights=TIP),
    "flat jaw": FlatJaw(pitch=(14, 12), peg_radius=3, wall_heights=(0, 5), jaw_heights=TIP),
}


def test_the_tip_above_the_flange_touches_the_upper_wall() -> None:
    """And the pegs below it the lower one; neither meets the flange, the bore does not open the tip's outline."""
    part = load(SOLID, peg_height=7, heights={"clamp": TIP})
    ((role, own),) = part.outlines
    assert role == "clamp" and own.bounds == pytest.approx((6, 8, 60, 34))
    assert part.bounds == pytest.approx((0, 0, 60, 40)) and len(own.loops) == 1
    assert own.solid is not None and set(own.solid.bands) == {(11.0, 18.0)}
    assert load(SOLID, peg_height=7, heights={"clamp": (9, 18)}).outlines[0][1].bounds == pytest.approx(
        (-12, -10, 72, 50)
    )


@pytest.mark.parametrize(
    "low, high", [(0.5, 7.0), (2.0, 9.0), (9.0, 12.0), (10.0, 14.0), (11.0, 21.0), (17, 30)]
)
def test_sections_between_the_heights_lie_in_the_outline_and_its_border_is_theirs(
    low: float, high: float
) -> None:
    """At a hundred heights between a and p with the head room; nothing of the border is off all of them."""
    ((_, own),) = load(SOLID, peg_height=7, heights={"clamp": (low, high)}).outlines
    rows = make_segment_rows(segments_of(own.loops))
    top = min(high + 0.5, 22.0)
    for k in range(100):
        points = section_points(SOLID, low + (top - low) * (k + 0.5) / 100)
        assert off_region(points, rows).max() < 1e-6


@pytest.mark.parametrize("name", HELD)
def test_every_fixture_holds_as_bodies_between_the_heights(name: str, tmp_path: Path) -> None:
    """Each peg touches the solid over its own heights and enters it nowhere up to the head room above."""
    toolkit = HELD[name]
    part = load(SOLID, peg_height=7, heights=toolkit.heights)
    result = design(part, toolkit)
    faults = [
        fault for one in list(result)[:12] for fault in fixture_faults(SOLID, result.workpiece, one, toolkit)
    ]
    assert len(result) > 0 and faults == []
    workhold.save(result, tmp_path / "held.json")
    again = workhold.verify(tmp_path / "held.json")
    assert again.proven == len(result) and again.faults == ()


def test_a_fixture_of_other_heights_is_none_of_these() -> None:
    """The truth sees a tip that would have to reach down past the flange."""
    toolkit = HELD["plate"]
    result = design(load(SOLID, peg_height=7, heights=toolkit.heights), toolkit)
    lower = Plate(pitch=(16, 14), peg_radius=3, clamp_radius=4, directions=("-x",), clamp_heights=(9.0, 18.0))
    assert any(list(fixture_faults(SOLID, result.workpiece, one, lower)) for one in result)


def test_the_picture_in_space_shows_pegs_from_their_lower_to_their_upper_end() -> None:
    """The tip hangs above the plate; locators begin in it."""
    toolkit = HELD["plate"]
    result = design(load(SOLID, peg_height=7, heights=toolkit.heights), toolkit)
    _, bodies = read_glb(fixture_glb(result[0], result.workpiece, toolkit))
    clamp = next(body for body in bodies if body.kind == "clamp")
    assert clamp.heights == pytest.approx(TIP)
    assert all(body.heights == pytest.approx((-10, 7)) for body in bodies if body.kind == "peg")


def test_what_cannot_be_met_is_refused_with_the_carrier(tmp_path: Path) -> None:
    """Heights above the part, with nothing upright, and with another reading of the solid."""
    path = write_step(tmp_path / "part.step", SOLID)
    for heights, words in (
        ((25, 30), "the clamp reaches, there is nothing of the part, which is 22 mm high"),
        ((21.5, 30), "no upright face of the part is at least 1 mm high: give other heights of the clamp"),
    ):
        with pytest.raises(InputError, match=words):
            load(path, peg_height=7, heights={"clamp": heights})
    for other in ({"section": 3.0}, {"fit": 0.1}):
        with pytest.raises(InputError, match=r"leave .* or heights out"):
            load(path, heights={"clamp": TIP}, **other)
    whole = load(path, heights={"clamp": TIP})
    assert whole.solid is not None and whole.solid.peg_height == 22


def test_the_band_jumps_where_an_opening_reaches_below_the_carrier() -> None:
    """Beside a hole across a wall a tip presses over all of the wall, and over the hole above it."""
    solid = stand_solid(cut(box(60, 30, 30), cylinder(4, 60, (30, -5, 10), (0, 1, 0))))
    strips = solid.make_outline(20.0, low=8.0).loops[0]
    wall = sorted((strip.start[0], strip.band) for strip in strips if strip.start[1] == strip.end[1] == 0.0)
    assert wall == [
        (pytest.approx(0.0), pytest.approx((8.0, 20.0), abs=1e-6)),
        (pytest.approx(26.0), pytest.approx((14.0, 20.0), abs=1e-6)),
        (pytest.approx(34.0), pytest.approx((8.0, 20.0), abs=1e-6)),
    ]


def test_a_part_that_was_given_a_name_is_read_back_as_it_was(tmp_path: Path) -> None:
    """The outlines of its carriers are called by their heights alone, so its own name makes no difference."""
    toolkit = HELD["vise"]
    part = load(SOLID, name="mine", peg_height=7, heights=toolkit.heights)
    result = design(part, toolkit, best=1)
    workhold.save(result, tmp_path / "result.json")
    assert workhold.open(tmp_path / "result.json").workpiece == part
