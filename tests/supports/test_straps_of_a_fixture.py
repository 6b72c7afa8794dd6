"""Straps for a fixture that is listed: past a program's tools, held against them, over supports."""

from __future__ import annotations

import pytest

import workhold
from strap_program import read_slot_program
from workhold import InputError, Load, Plate, StrapPlate, Workpiece, circle_zone

BLOCK = Workpiece.from_points("block", [(0, 0), (100, 0), (100, 60), (0, 60)])
LOADS = (Load(points=(50, 30), force=300, name="slot"),)
SUPPORTS = {"pad_radius": 5, "pad_margin": 1, "height": 12}


@pytest.fixture(scope="module")
def slot(tmp_path_factory):
    return read_slot_program(tmp_path_factory.mktemp("slot"))


@pytest.fixture(scope="module")
def clamped():
    """A fixture with a clamp, of a query that knows no program."""
    return workhold.design(BLOCK, Plate(20, 3, 8, 6, clamps=2), best=1)[0]


@pytest.mark.thorough
@pytest.mark.parametrize("over", ["plate", "supports"])
@pytest.mark.parametrize("loads", [LOADS, ()], ids=["loaded", "tools alone"])
def test_the_answer_is_that_of_a_plate_with_straps(over, loads, slot):
    """The same straps, supports and forces, as the query's program, or one that is given, says."""
    plate = StrapPlate(20, 3, 8, 6, over=over, supports=SUPPORTS, strap_height=22)
    asked = {"thickness": 25, "loads": loads, "strapped": 1, "best": 1, "weight": 12.0}
    first = workhold.design(BLOCK, plate, program=slot, peg_height=15, **asked)[0]
    sizes = {"over": over, "strap_height": 22, "weight": 12.0}
    assert first.hold.program_need.force > 100
    for further in ({}, {"program": slot}):
        found = first.straps(25, **sizes, **further)
        assert found.straps == first.hold.straps and found.supports == first.hold.supports
        assert found.needs == pytest.approx(first.hold.needs)
    # Tools alone load no part of a query without a program.
    if loads:
        bare = workhold.design(BLOCK, plate, **asked)[0].straps(25, **sizes)
        assert bare.program_need is None


@pytest.mark.thorough
def test_fewer_places_are_free_beside_a_program(clamped, slot):
    counts = [
        clamped.straps(25, loads=LOADS, program=slot, strap_height=height).places for height in (1, 200)
    ]
    free = clamped.straps(25, loads=LOADS).places
    assert free > counts[0] > 0 and counts[0] >= counts[1]


@pytest.mark.thorough
def test_pads_have_the_sizes_given_and_keep_off_zones(clamped):
    def held(**sizes):
        return clamped.straps(25, loads=LOADS, over="supports", **sizes)

    usual, wide = held(), held(pad_margin=14)
    assert len(usual.supports) == 3 and wide.places < usual.places
    assert held(support_height=15).straps[0].height == usual.straps[0].height + 15
    assert held(bottom_zones=[circle_zone(50, 30, 20)]).places < usual.places
    with pytest.raises(InputError, match="would overlap"):
        held(pad_radius=11)
    with pytest.raises(InputError, match="cannot press over 'air'"):
        clamped.straps(25, loads=LOADS, over="air")
    with pytest.raises(InputError, match="straps -1 mm high"):
        clamped.straps(25, loads=LOADS, strap_height=-1)
    with pytest.raises(InputError, match="give one load or more"):
        clamped.straps(25)
