"""What a machinist is told of two clamps: the order, a ratio that lies inside what holds, and the force of each."""

from __future__ import annotations

import re
from math import inf

import pytest
from hypothesis import given
from hypothesis import strategies as st

from workhold import Fixture, Peg, Pose
from workhold.model.clamps import (
    compute_clamp_shares,
    describe_clamp_freedom,
    describe_tightening_order,
    name_clamps,
)
from workhold.model.fixture import ClampPair

LOCATOR = Peg("plate", 0, 0, 0.0, 0.0, 1, 0.3)
NUMBER = re.compile(r"\d[\d,]*(?:\.\d+)?(?:e[-+]\d+)?(?= )")


def held(low: float, high: float, *tips: tuple[str, str, int]) -> Fixture:
    """A fixture whose clamps are pressed in a range of ratios; of each clamp its direction, place and face."""
    tips = tips or (("-x", "E2", 1), ("-y", "C5", 2))
    clamps = [Peg(f"clamp {way}", 4, 1, 66.0, 20.0, face, 0.5, f"clamp {place}") for way, place, face in tips]
    pair = ClampPair((-12.0, -12.0), (low, high), (), 1)
    return Fixture("clamp2", (LOCATOR, LOCATOR, LOCATOR, *clamps), Pose(0, 0, 0), 0.0, {}, "-x -y", pair)


def test_either_first() -> None:
    """Where no ratio lifts the part, nothing is said of one."""
    assert describe_tightening_order(held(0.0, inf)).startswith("Tighten either clamp first")


@given(st.floats(1e-3, 1e3))
def test_the_one_that_lifts_nothing_comes_first(end: float) -> None:
    """The clamp that alone presses all locators is named first; the other stays below a number that is inside the range."""
    for low, high, first, second, most in ((0.0, end, "E2", "C5", end), (end, inf, "C5", "E2", 1 / end)):
        words = describe_tightening_order(held(low, high))
        assert words.startswith(f"Tighten clamp {first} first. Then tighten clamp {second} with less than ")
        (number,) = (
            float(found.replace(",", "")) for found in NUMBER.findall(words.split("less than ")[1])[:1]
        )
        assert 0.9 * most - 1e-12 <= number <= most * (1 + 1e-9)


@given(st.floats(1e-2, 50.0), st.floats(1.3, 20.0))
def test_both_together_stay_inside(low: float, wide: float) -> None:
    """Where neither may be tightened alone both ends are told, each rounded into the range."""
    words = describe_tightening_order(held(low, low * wide))
    least, most = (float(found) for found in NUMBER.findall(words.split("clamp C5 with ")[1])[:2])
    assert words.startswith("Bring both clamps up together") and "Tighten neither alone" in words
    assert low * (1 - 1e-9) <= least <= 1.11 * low and 0.9 * low * wide <= most <= low * wide * (1 + 1e-9)


def test_other_fixtures_have_no_order() -> None:
    """One clamp needs no words."""
    assert describe_tightening_order(Fixture("clamp", (LOCATOR,), Pose(0, 0, 0), 0.0, {}, "-x")) == ""


@pytest.mark.parametrize(
    ("low", "high", "ratio"), [(0.0, inf, 1.0), (0.0, 0.0001, 0.00005), (1.0, inf, 1 + 2**0.5)]
)
def test_the_shares_are_in_the_working_ratio(low: float, high: float, ratio: float) -> None:
    """They make up the whole, in the ratio that is the middle of the range as an angle."""
    first, second = compute_clamp_shares(held(low, high))
    assert first + second == pytest.approx(1.0) and second / first == pytest.approx(ratio)


def test_two_clamps_are_told_apart() -> None:
    """By their places, on one line by their directions too, and where those are one by their faces."""
    assert name_clamps(held(0.0, 1.0)) == ("clamp E2", "clamp C5")
    opposed = held(0.0, 1.0, ("-x", "row 2", 1), ("+x", "row 2", 3))
    assert name_clamps(opposed) == ("clamp row 2 −x", "clamp row 2 +x")
    doubled = held(0.0, 1.0, ("-x", "row 2", 1), ("-x", "row 2", 3))
    assert name_clamps(doubled) == ("clamp row 2 on face 1", "clamp row 2 on face 3")


def test_how_exact_the_forces_have_to_be() -> None:
    """Ninety degrees are any forces; half of them and more a hand keeps; less takes a torque wrench."""
    assert [describe_clamp_freedom(value).split(" ")[0] for value in (90.0, 45.0, 44.9)] == [
        "the",
        "no",
        "both",
    ]
