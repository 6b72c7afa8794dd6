"""Tools of a program keep clear of flat jaws: by a walk along its moves, and by the verification."""

from itertools import pairwise
from math import cos, inf, radians, sin
from random import Random

import numpy as np
import pytest
from attrs import evolve

from jaw_examples import ELL, TRIANGLE, held, rectangle, vise
from slow_program import OFF, THICKNESS, low_points, program_of, random_program
from workhold.search.explaining import explain
from workhold.verification import verify

LOW = vise(parallels=[32, 40], jaw_thickness=18)


def slow_reach(fixture, toolkit, program):
    """The least distance less radius of a walk from both jaws, in mm; inside them it is less than nothing."""
    angle, hold = radians(fixture.pose.theta_deg), fixture.hold
    least = inf
    for points, radius in low_points(program, toolkit.jaw_height - hold.parallels):
        x = cos(angle) * points[:, 0] - sin(angle) * points[:, 1] + fixture.pose.x
        y = sin(angle) * points[:, 0] + cos(angle) * points[:, 1] + fixture.pose.y
        beside = np.maximum(np.maximum(-x, x - toolkit.jaw_width), 0.0)
        for low in (-toolkit.jaw_thickness, hold.opening):
            across = np.maximum(np.maximum(low - y, y - low - toolkit.jaw_thickness), 0.0)
            least = min(least, float(np.hypot(beside, across).min()) - radius)
    return least


def keys(result):
    return {(round(one.pose.theta_deg, 6), one.hold.parallels) for one in result}


@pytest.mark.parametrize("seed", range(24))
def test_fixtures_are_those_that_a_walk_finds_clear(seed):
    random = Random(seed)
    part = random.choice([rectangle(70, 40), ELL, TRIANGLE])
    program = random_program(random, part, random.choice([0.0, 1.0, 3.0]))
    every = held(part, LOW, thickness=THICKNESS)
    found = held(part, LOW, thickness=THICKNESS, program=program)
    assert keys(found) <= keys(every)
    for one in every:
        reach = slow_reach(one, LOW, program)
        if abs(reach - program.clearance) > OFF:
            is_there = (round(one.pose.theta_deg, 6), one.hold.parallels) in keys(found)
            assert is_there == (reach > program.clearance), (one.pose, one.hold.parallels, reach)
    assert verify(found).holds


def test_walk_rules_some_out_and_leaves_some():
    left = taken = 0
    for seed in range(24):
        random = Random(seed)
        part = random.choice([rectangle(70, 40), ELL, TRIANGLE])
        program = random_program(random, part, random.choice([0.0, 1.0, 3.0]))
        found = sum(held(part, LOW, thickness=THICKNESS, program=program).counts.values())
        left += found
        taken += sum(held(part, LOW, thickness=THICKNESS).counts.values()) - found
    assert left > 20 and taken > 20


def cut_along(y, z, clearance=1.0):
    """A cut of an end mill of 6 mm along x."""
    return program_of([(1, True, (-10.0, y, z), (80.0, y, z), 0.0)], clearance)


def test_jaws_end_where_they_are_thick():
    """A cut beyond a thin jaw is clear of it, and beneath an endless one it is not."""
    program = cut_along(-20.0, 2.0)
    part = rectangle(70, 40)
    thin, thick, endless = (
        held(part, vise(parallels=[32], jaw_thickness=size), thickness=THICKNESS, program=program)
        for size in (15.9, 16.1, None)
    )
    assert (0.0, 32.0) in keys(thin) and (0.0, 32.0) not in keys(thick) | keys(endless)


@pytest.mark.parametrize(("z", "is_clear"), [(12.01, True), (12.0, False), (11.99, False)])
def test_what_passes_above_the_jaws_is_clear(z, is_clear):
    found = held(rectangle(70, 40), vise(parallels=[32]), thickness=THICKNESS, program=cut_along(0.0, z))
    assert ((0.0, 32.0) in keys(found)) == is_clear


def test_a_rapid_move_by_any_way_goes_through_a_jaw():
    """Its box has the jaw inside, though no end of it is there."""
    rows = [(1, False, (-500.0, -300.0, 2.0), (500.0, -8.0, 2.0), 0.0)]
    part, toolkit = rectangle(70, 40), vise(parallels=[32], jaw_thickness=18)
    straight, boxed = (
        held(part, toolkit, thickness=THICKNESS, program=program_of(rows, rapid=way))
        for way in ("straight", "box")
    )
    assert (0.0, 32.0) not in keys(boxed)
    assert len(straight) >= len(boxed)
    assert verify(boxed).holds


def test_verification_sees_a_tool_in_a_jaw():
    clear = held(
        rectangle(70, 40), vise(parallels=[32, 40]), thickness=THICKNESS, program=cut_along(0.0, 6.0)
    )
    assert keys(clear) == {(90.0, 40.0), (270.0, 40.0), (0.0, 40.0), (180.0, 40.0)}
    low = evolve(clear, query=evolve(clear.query, program=cut_along(0.0, 3.0)))
    outcome = verify(low)
    assert not outcome.holds
    assert any("of the program brings a tool within" in one.reason for one in outcome.unproven)


def test_reason_names_the_line_and_what_would_help():
    result = held(rectangle(70, 40), vise(parallels=[32]), thickness=THICKNESS, program=facing_all())
    assert not len(result)
    assert result.notes[0].words == (
        "Both jaws would press the part, but line 3 of the program brings a tool too near a jaw."
    )
    explanation = explain(result.query)
    assert explanation.removals[-1].rule == "jaws clear of the program"
    assert [one.change for one in explanation.helps] == ["without the program"]


def facing_all():
    """A border around the part, low."""
    ring = [(0.0, 0.0, 3.0), (70.0, 0.0, 3.0), (70.0, 40.0, 3.0), (0.0, 40.0, 3.0), (0.0, 0.0, 3.0)]
    return program_of([(1, True, a, b, 0.0) for a, b in pairwise(ring)])
