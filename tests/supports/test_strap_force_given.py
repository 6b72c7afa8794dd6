"""How many times the loads a given force of the straps holds: each load and a program, with and without a weight."""

from __future__ import annotations

import json
from math import inf

import numpy as np
import pytest
from attrs import evolve

import workhold
from strap_program import read_slot_program
from workhold import InputError, Load, Plate, StrapPlate, Workpiece
from workhold.model.straps import bound_safety
from workhold.supports.straps import StrapSearch, make_question
from workhold.verification import verify, verify_file

BLOCK = Workpiece.from_points("block", [(0, 0), (100, 0), (100, 60), (0, 60)])
LOADS = (
    Load(points=(50, 30), force=300, name="slot"),
    Load(points=(20, 20), force=100, directions=(0, 60), upward=40, height=20),
    Load(points=(50, 30), upward=-40),
)
PLATES = {
    "plate": StrapPlate(20, 3, 8, 6, max_force=4000),
    "supports": StrapPlate(20, 3, 8, 6, over="supports", supports={"pad_radius": 5, "height": 12}),
}
FORCE = 3000.0


@pytest.fixture(scope="module")
def slot(tmp_path_factory):
    return read_slot_program(tmp_path_factory.mktemp("slot"))


def held(over="plate", program=None, **asked):
    asked = {"loads": LOADS, "jaw_force": FORCE, "strapped": 1, "best": 1, **asked}
    with_program = {} if program is None else {"program": program, "peg_height": 15}
    return workhold.design(BLOCK, PLATES[over], thickness=25, **asked, **with_program)


@pytest.mark.thorough
@pytest.mark.parametrize("over", PLATES)
def test_without_a_weight_twice_the_force_holds_twice_the_loads(over, slot):
    """The number of times is exact: so many times the loads need just the force given."""
    hold = held(over, slot)[0].hold
    for need, times in zip(hold.needs, hold.safety_each, strict=True):
        assert times == (pytest.approx(2 * FORCE / need) if need > 1e-6 else inf)
    assert hold.safety_reached == min(hold.safety_each) == hold.figures["safety_reached"]
    twice = held(over, slot, jaw_force=2 * FORCE)[0].hold
    assert twice.safety_reached == pytest.approx(2 * hold.safety_reached)
    assert twice.clamp_needed == pytest.approx(hold.clamp_needed)


@pytest.mark.thorough
@pytest.mark.parametrize("share", [0.3, 2.0])
@pytest.mark.parametrize("over", PLATES)
def test_beside_a_weight_it_is_never_too_much_and_not_far_off(over, share, slot):
    """So many times the loads need at most the force given, and 12 % more need more than that."""
    force = share * held(over, slot, weight=400.0)[0].hold.clamp_needed
    result = held(over, slot, jaw_force=force, weight=400.0)
    hold, asked = result[0].hold, make_question(result.query)
    assert (hold.safety_reached < 2) == (share < 1)
    for number, times in enumerate(hold.safety_each):
        if times in (0.0, inf):
            continue
        needs = []
        for more in (1.0, 1.12):
            search = StrapSearch(result[0], result.query, evolve(asked, safety=more * times))
            straps = [[one.at[0], one.at[1]] for one in hold.straps]
            below = search.part
            if over == "supports":
                plate = result.toolkit.plates[0]
                below = search.make_part_on(
                    list_points(plate.compute_hole_center(*one) for one in hold.supports)
                )
            grip = search.make_tips(below, list_points(straps)).press(range(len(straps)))
            needs.append((*search.compute_needs_of(grip), search.find_program_need(grip).force)[number])
        assert needs[0] <= force * 1.0001
        assert share < 1 or needs[1] > force * 0.99


def list_points(points):
    return np.array([[float(x), float(y)] for x, y in points])


def test_bounds_at_the_force_needed_and_beyond():
    assert bound_safety(1500, 2, 1500, 1700, 0) == 2.0
    assert bound_safety(1499.9, 2, 1500, 1700, 0) == pytest.approx(2.0, rel=1e-3)
    assert bound_safety(900, 2, 1500, 1400, 300) == 1.0
    assert bound_safety(200, 2, 1500, 1400, 300) == 0.0
    assert bound_safety(5000, 2, None, None, 0) == bound_safety(5000, 2, 100, 100, None) == 0.0
    assert bound_safety(5000, 2, 100, None, 0) == 2.0
    assert bound_safety(5000, 2, 0, 0, 0) == bound_safety(5000, 2, 1e-6, 1e-6, 0) == inf


@pytest.mark.thorough
@pytest.mark.parametrize("weight", [None, 400.0])
@pytest.mark.parametrize("over", PLATES)
def test_a_file_says_it_and_a_verification_derives_it(over, weight, slot, tmp_path):
    result = held(over, slot, weight=weight, best=3)
    assert verify(result).holds
    workhold.save(result, tmp_path / "made.json")
    again = workhold.open(tmp_path / "made.json")
    workhold.save(again, tmp_path / "again.json")
    assert (tmp_path / "made.json").read_bytes() == (tmp_path / "again.json").read_bytes()
    assert again[0].hold.safety_each == pytest.approx(result[0].hold.safety_each, rel=1e-9)
    data = json.loads((tmp_path / "made.json").read_text())
    first = data["fixtures"][0]
    assert first["quality"]["safety_reached_each"][2] is None
    assert first["quality"]["safety_reached"] == min(
        first["quality"]["safety_reached_each"][0], first["program_force"]["safety_reached"]
    )
    for where in (first["quality"]["safety_reached_each"], first["program_force"]):
        key = 0 if isinstance(where, list) else "safety_reached"
        right = where[key]
        where[key] = right * 1.1
        (tmp_path / "faulty.json").write_text(json.dumps(data))
        assert [one.index for one in verify_file(tmp_path / "faulty.json").unproven] == [0]
        where[key] = right
    del first["quality"]["safety_reached_each"]
    (tmp_path / "faulty.json").write_text(json.dumps(data))
    assert "how often the given force holds them" in verify_file(tmp_path / "faulty.json").unproven[0].reason


@pytest.mark.thorough
def test_a_spreadsheet_has_it_where_a_force_is_given(tmp_path):
    for force in (FORCE, None):
        workhold.save(held(jaw_force=force), tmp_path / "rows.csv", overwrite=True)
        head, row = ((tmp_path / "rows.csv").read_text().splitlines())[:2]
        assert ("safety_reached" in head) == (force is not None)
        assert len(head.split(",")) == len(row.split(","))


@pytest.mark.thorough
def test_a_report_on_a_fixture_with_clamps_says_it():
    first = workhold.design(BLOCK, Plate(20, 3, 8, 6, clamps=2), best=1, jaw_force=77.0)[0]
    found = first.straps(25, loads=LOADS[:1], jaw_force=FORCE)
    assert found.safety_each == (pytest.approx(2 * FORCE / found.clamp_needed),)
    # The clamps' force says nothing of straps.
    assert first.straps(25, loads=LOADS[:1]).safety_each == ()
    with pytest.raises(InputError, match="force -1 of each strap"):
        first.straps(25, loads=LOADS[:1], jaw_force=-1.0)
