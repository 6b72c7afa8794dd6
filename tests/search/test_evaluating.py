"""A set-up of one's own is held in the poses that the whole list has for it, or the reason is said."""

from __future__ import annotations

import pytest
from test_sifted import TOOLKITS

import workhold
from workhold.model.fixture import Fixture

PART = workhold.load("widget")


def holes_of(fixture: Fixture) -> list[str]:
    """The holes of pegs and bolted clamps."""
    return [peg.hole for peg in fixture.pegs if not peg.is_on_wall]


@pytest.mark.thorough
@pytest.mark.parametrize("kind", TOOLKITS)
def test_a_set_up_has_every_pose_of_the_list(kind: str) -> None:
    """Of some fixtures of the list, each by its holes."""
    whole = workhold.design(PART, TOOLKITS[kind], **({"listing": "all"} if kind == "two clamps" else {}))
    for fixture in whole[:: len(whole) // 3]:
        mine = workhold.evaluate(PART, TOOLKITS[kind], holes_of(fixture))
        poses = {round(one.pose.theta_deg % 180.0, 6) for one in mine.result}
        same = [one for one in whole if set(holes_of(one)) == set(holes_of(fixture))]
        assert mine.holds and not mine.reason
        turned = {round(one.pose.theta_deg % 180.0, 6) for one in same}
        if kind == "vise":
            # What half a turn makes of a fixture is listed in other holes.
            assert turned <= poses
            assert all({peg.hole for peg in one.pegs} == set(mine.holes) for one in mine.result)
        else:
            assert turned == poses and len(same) == len(mine.result)


def test_a_set_up_farther_on_is_the_same() -> None:
    """On a plate and in jaws without an end."""
    plate = workhold.Plate(pitch=20, peg_radius=3)
    near, far = (workhold.evaluate(PART, plate, holes) for holes in (["A3", "B1", "C1"], ["D4", "E2", "F2"]))
    assert [one.pose for one in near.result] == [one.pose for one in far.result] and near.holds
    vise = TOOLKITS["vise"]
    near = workhold.evaluate(PART, vise, ["L-A2", "L-A4", "R-A1", "R-A2"])
    far = workhold.evaluate(PART, vise, ["L-A12", "L-A14", "R-A11", "R-A12"])
    assert len(near.result) == len(far.result) > 0
    assert {peg.hole for peg in far.result[0].pegs} == {"L-A12", "L-A14", "R-A11", "R-A12"}


def test_rows_count_from_a_fence() -> None:
    """One row farther from it the pegs are another set-up."""
    fence = TOOLKITS["fence"]
    first = workhold.design(PART, fence)[0]
    names = {"1": "2", "2": "3", "3": "4", "4": "5", "5": "6"}
    farther = [hole[:-1] + names[hole[-1]] for hole in holes_of(first)]
    other = workhold.evaluate(PART, fence, farther)
    assert first.pose.theta_deg not in [one.pose.theta_deg for one in other.result]


def test_why_a_set_up_holds_nothing_is_said() -> None:
    """A peg that is too far away, pegs that no pose touches, and pegs from which the part slips."""
    square = workhold.Workpiece.from_loops("square", [[[0, 0, 0], [40, 0, 0], [40, 40, 0], [0, 40, 0]]])
    far = workhold.evaluate(PART, TOOLKITS["vise"], ["L-A1", "L-A30", "R-A1", "R-A2"])
    assert far.reason.startswith("L-A1 and L-A30 are 232 mm apart")
    beside = workhold.evaluate(square, workhold.Plate(pitch=20, peg_radius=3), ["A1", "C1", "E1"])
    assert beside.reason.startswith("No pose of square touches A1, C1 and E1")
    loose = workhold.evaluate(square, workhold.Plate(pitch=20, peg_radius=3), ["A1", "B1", "C2"])
    assert "square touches A1, B1 and C2 in" in loose.reason and "would have to pull" in loose.reason
    for none in (far, beside, loose):
        assert not none.holds and none.reason in repr(none)


@pytest.mark.parametrize(
    ("holes", "words"),
    [
        (["L-A1", "L-A2", "R-A1"], "give the holes of 4 pegs"),
        (["L-A1", "L-A1", "R-A1", "R-A2"], "give the holes of 4 pegs"),
        (["L-A1", "L-A2", "R-A1", "X9"], "'X9' names no hole"),
        (["L-A1", "L-A2", "R-A1", "R-B1"], "there is no hole R-B1"),
        (["L-A1", "L-A2", "R-A1", "R-A"], "R-A is a column"),
        ([1, 2, 3, 4], "a hole cannot be 1"),
    ],
)
def test_what_is_no_set_up_is_refused(holes: list[str], words: str) -> None:
    with pytest.raises(workhold.InputError, match=words):
        workhold.evaluate(PART, TOOLKITS["vise"], holes)
