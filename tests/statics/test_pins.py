"""How far pegs bend is what beams do by hand, and moves the part as errors of the pegs would (docs/quality.md)."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import pytest
from attrs import evolve

from workhold import Plate, Query, Result, Vise, Workpiece, design
from workhold.errors import InputError
from workhold.fixels.support_hardware import PinLimits
from workhold.model.quality import (
    BEFORE_PINS,
    FIGURES,
    PIN_KEYS,
    PIN_STRESS,
    WARNINGS,
    list_figures_in_columns,
)
from workhold.model.solid import SolidOutline
from workhold.statics.bent_pegs import compute_bent_pegs
from workhold.statics.contact_matrix import TouchableFeatures
from workhold.statics.pins import compute_deflections, compute_stresses
from workhold.statics.quality import measure_quality
from workhold.units import INCH, MILLIMETRE

SQUARE = Workpiece.from_loops("square", [[[-17, -17, 0], [17, -17, 0], [17, 17, 0], [-17, 17, 0]]])
VISE = Vise(pitch=10, columns=2, peg_radius=3)
KITE = Workpiece.from_loops("kite", [[[0, 0, 0], [70, -8, 0.1], [88, 40, 0], [22, 66, 0]]])
PLATE = Plate(pitch=15, peg_radius=3)


@pytest.fixture(scope="module")
def bent() -> Result:
    """The square in pegs that touch it up to 76 mm, closed with 500 N."""
    return design(SQUARE, VISE, thickness=76, jaw_force=500)


def test_by_hand_a_pin_of_6_mm_gives_way_0_694_mm() -> None:
    """38 mm high under 500 N: 0.685 mm of bending, the rest shear, and 896 MPa at its root."""
    inertia, area = pi * 6**4 / 64, pi * 9
    bending, shear = 500 * 38**3 / (3 * 210_000 * inertia), 10 * 500 * 38 / (9 * 81_000 * area)
    assert (round(bending, 3), round(bending + shear, 3)) == (0.685, 0.694)
    assert compute_deflections(500.0, 38.0, 6.0) == pytest.approx(bending + shear, rel=1e-12)
    assert compute_stresses(500.0, 38.0, 6.0) == pytest.approx(500 * 38 / (inertia / 3), rel=1e-12)
    assert round(compute_stresses(500.0, 38.0, 6.0)) == 896


def test_the_pinwheel_by_hand(bent: Result) -> None:
    """Every peg presses with 500 N at 38 mm: the square turns by 2 w / 20 and shifts, as the manual's has it."""
    pinwheel = {"L-A2", "L-B1", "R-A5", "R-B4"}
    fixture = next(
        one for one in bent if {peg.hole for peg in one.pegs} == pinwheel and one.pose.theta_deg == 0
    )
    way = compute_deflections(500.0, 38.0, 6.0)
    assert fixture.quality["pin_deflection"] == pytest.approx(way, rel=1e-9)
    assert fixture.quality["pin_stress"] == pytest.approx(compute_stresses(500.0, 38.0, 6.0), rel=1e-9)
    # Pegs b and d give way by w each, so the part turns by w / 10, and a keeps 10 w / 10 + w of its side.
    corner = np.hypot(2 * way + 17 * way / 10, 17 * way / 10)
    assert fixture.quality["pin_movement"] == pytest.approx(corner, rel=1e-9)


def test_without_a_force_it_is_for_each_kn_and_warns_of_nothing(bent: Result) -> None:
    per_kn = design(SQUARE, VISE, thickness=76)
    known = {one.pegs: one.quality for one in bent}
    for fixture in per_kn:
        other = known[fixture.pegs]
        for key in PIN_KEYS:
            assert fixture.quality[key] == pytest.approx(2 * other[key], rel=1e-9)
        assert other["warnings"] == fixture.quality["warnings"] + 2
    found = compute_bent_pegs(per_kn[0], SQUARE, VISE, pressed_top=76)
    assert found is not None and found.list_cautions("jaw", MILLIMETRE) == []
    assert found.describe_bending("jaw", MILLIMETRE).startswith("For each kN of jaw force ")
    assert found.describe_bending("jaw", INCH).startswith("For each 225 lbf")


@pytest.mark.thinned(2)
@pytest.mark.parametrize(
    ("limits", "more"),
    [
        ({"stress_limit": 1e5, "movement_limit": 1e5}, 0),
        ({"stress_limit": 1e5}, 1),
        ({"movement_limit": 1e5}, 1),
        ({}, 2),
    ],
)
def test_limits_are_those_of_the_toolkit(limits: dict[str, float], more: int) -> None:
    """421 MPa, a third of the yield of HRC 47, and 0.05 mm where it says nothing."""
    base = design(SQUARE, VISE, best=1, thickness=76)[0].quality["warnings"]
    result = design(SQUARE, evolve(VISE, pins=PinLimits(**limits)), best=1, thickness=76, jaw_force=500)
    assert result[0].quality["warnings"] == base + more
    found = compute_bent_pegs(result[0], SQUARE, result.toolkit, pressed_top=76, jaw_force=500)
    assert found is not None and len(found.list_cautions("jaw", MILLIMETRE)) == more


def test_the_usual_limit_is_a_third_of_the_yield_of_hrc_47() -> None:
    """HRC 47 is HV 471 (ASTM E140), which yields at 2.876 HV - 90.7 MPa (Pavlina and Van Tyne, 2008)."""
    found = compute_bent_pegs(design(SQUARE, VISE, best=1)[0], SQUARE, VISE, pressed_top=10, jaw_force=1)
    assert found is not None
    assert found.stress_limit == round((2.876 * 471 - 90.7) / 3)
    assert found.movement_limit == 0.05


def test_the_worst_is_at_the_top_and_supports_make_the_lever_longer() -> None:
    fixture = design(SQUARE, VISE, best=1)[0]
    low, high = (
        compute_bent_pegs(fixture, SQUARE, VISE, pressed_top=20, jaw_force=500, lift=lift)
        for lift in (0.0, 8.0)
    )
    assert low is not None and high is not None
    for peg, lifted in zip(low.pegs, high.pegs, strict=True):
        assert (peg.height, peg.top, lifted.height, lifted.top) == (10.0, 20.0, 18.0, 28.0)
        assert peg.worst_deflection == pytest.approx(compute_deflections(peg.force, 20.0, 6.0))
        assert lifted.stress == pytest.approx(compute_stresses(peg.force, 18.0, 6.0))
    assert low.movement < low.worst_movement < high.worst_movement


def test_where_no_height_is_known_nothing_is_said() -> None:
    result = design(SQUARE, VISE, jaw_force=500)
    assert compute_bent_pegs(result[0], SQUARE, VISE) is None
    assert not set(PIN_KEYS) & set(result[0].quality)
    assert list_figures_in_columns(result.table.quality.shape[1]) == FIGURES[:BEFORE_PINS]
    with pytest.raises(InputError, match="give the part's thickness, or the height of the pegs"):
        design(SQUARE, VISE, rank_by="pin-stress")


def test_of_two_heights_the_lower_one_is_pressed() -> None:
    """A peg presses neither above its own end nor above the part."""
    asked = ((None, 6.0), (10.0, 6.0), (6.0, 10.0), (6.0, None))
    assert {Query(SQUARE, VISE, thickness=t, peg_height=p).pressed_top for t, p in asked} == {6.0}
    assert Query(SQUARE, VISE).pressed_top is None
    with pytest.raises(InputError, match="thickness -1"):
        Query(SQUARE, VISE, thickness=-1)


def test_clamps_and_points_do_not_bend() -> None:
    """Of a plate the three locators alone, and pegs of radius 0 have no section."""
    result = design(KITE, PLATE, best=3, thickness=12)
    for fixture in result:
        found = compute_bent_pegs(fixture, KITE, PLATE, pressed_top=12)
        assert found is not None
        assert [peg.hole for peg in found.pegs] == [p.hole for p in fixture.pegs if p.carrier == "plate"]
        assert found.most.deflection == pytest.approx(fixture.quality["pin_deflection"], rel=1e-9)
        assert found.hardest.stress == pytest.approx(fixture.quality["pin_stress"], rel=1e-9)
    points = design(SQUARE, Vise(pitch=10, columns=2, peg_radius=0), best=1, thickness=12)
    assert "pin_stress" not in points[0].quality


def test_pegs_move_the_part_as_errors_of_their_places_would() -> None:
    """The derivative is that of the location error: tried on every corner of the part."""
    result = design(KITE, PLATE, best=5, thickness=30, jaw_force=900)
    touched = TouchableFeatures.from_workpiece(KITE, PLATE)
    for fixture in result:
        contacts = touched.compute_for_fixture(fixture, PLATE)
        found = compute_bent_pegs(fixture, KITE, PLATE, pressed_top=30, jaw_force=900)
        assert found is not None
        ways = np.array([*[peg.deflection for peg in found.pegs], 0.0])
        moved = contacts.inverses[0, :3] @ ways
        turn = moved[2] / touched.length
        corners = np.array([s.start for s in KITE.segments]) - KITE.center
        reach = np.hypot(moved[0] - turn * corners[:, 1], moved[1] + turn * corners[:, 0]).max()
        assert found.movement >= reach * (1 - 1e-12)
        assert found.movement <= reach * 1.1


def with_bands(bands: list[Any], runs: list[Any]) -> Workpiece:
    """The square as a solid of 40 mm with pegs of 30 mm."""
    solid = SolidOutline("z", 40.0, 30.0, 0.5, 1.0, bands, runs=runs)
    loops = [[[-17, -17, 0], [17, -17, 0], [17, 17, 0], [-17, 17, 0]]]
    return Workpiece.from_loops("square", loops, solid=solid)


@pytest.mark.thorough
def test_of_a_solid_each_peg_is_pressed_in_the_middle_of_its_run() -> None:
    """That of the face, and where runs slide along it, the run where the peg touches."""
    slides = [[0.0, 0.0, 10.0], [1 / 3, 0.0, 16.0], [2 / 3, 0.0, 22.0], [1.0, 0.0, 28.0]]
    part = with_bands([[0, 10], [4, 20], [0, 30], [0, 6]], [slides, [], [], []])
    heights: dict[int, set[float]] = {}
    result = design(part, VISE)
    for fixture in result:
        found = compute_bent_pegs(fixture, part, VISE)
        assert found is not None
        for peg, bent_peg in zip(fixture.pegs, found.pegs, strict=True):
            run = part.numbered.find_pressed_band(peg.face, fixture.pose.inverse.apply(peg.x, peg.y))
            assert run is not None
            assert (bent_peg.height, bent_peg.top) == pytest.approx((sum(run) / 2, run[1]), abs=1e-9)
            heights.setdefault(peg.face, set()).add(round(bent_peg.height, 6))
        assert found.most.deflection == pytest.approx(fixture.quality["pin_deflection"], rel=1e-9)
    assert (heights[1], heights[2], heights[3]) == ({12.0}, {15.0}, {3.0})
    assert len(heights[0]) > 1


def test_warnings_of_bending_are_counted_of_whole_tables(bent: Result) -> None:
    """The column of warnings is that of its figures, and never less than without heights."""
    plain = measure_quality(bent.table, SQUARE, VISE, jaw_force=500)
    tall = measure_quality(bent.table, SQUARE, VISE, jaw_force=500, pressed_top=76)
    assert (tall[:, WARNINGS] >= plain[:, WARNINGS]).all()
    assert (tall[:, PIN_STRESS] > 421).all()
