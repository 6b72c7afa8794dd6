"""Boxes with two, one, a double or no solution are decided, on the curve of their solutions and by cutting them."""

from __future__ import annotations

import numpy as np
import pytest
from flint import arb

import ladders
from exact_chords import exactly
from workhold.kernels.base.tables import Limits
from workhold.proof import interval_newton as settling
from workhold.proof.ball_contacts import CandidateBox
from workhold.proof.interval_newton import BoxOutcome, find_solutions
from workhold.proof.singular_frame import cut_in_thirds

# The ladders' moving pegs stand among the standing ones: any gap will do here.
LIMITS = Limits(-100.0, 0.0, 20.0, 9.0, 1.0, 0.0, 0.0)


@pytest.fixture(autouse=True, params=["curve", "boxes"])
def way(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """All outcomes are the same without the curve."""
    if request.param == "boxes":
        monkeypatch.setattr(settling, "find_roots_on_curve", lambda *_: None)
    return str(request.param)


def box(
    height: float, turn: float, reach: float, features: list[list[float]] = ladders.FEATURES
) -> CandidateBox:
    """The ladders with psi within ``reach`` of 45 degrees and a turn."""
    middle = ladders.near(np.pi / 4 + turn, height)
    return CandidateBox(
        features, ladders.offsets(height), 2, middle, (reach, 10 * reach, 10 * reach, 20 * reach)
    )


def solutions(height: float) -> list[float]:
    """The exact orientations, rounded."""
    with exactly():
        return sorted(float(psi) for psi in ladders.orientations(height))


@pytest.mark.parametrize("rest", [1e-2, 1e-4, 1e-6, 1e-9])
def test_of_two_solutions_in_a_box_the_one_that_clamps_is_found(rest: float) -> None:
    """Both solutions touch and close, and closing the vise clamps one and frees the other."""
    height = -2.5 + rest
    low, high = solutions(height)
    outcome = find_solutions(box(height, 0.0, 2.0 * (high - low)), LIMITS)
    assert outcome.reason == ""
    assert len(outcome.fixtures) == 1
    psi = outcome.fixtures[0][0]
    assert min(abs(psi - low), abs(psi - high)) < 1e-13
    # With the materials on the other sides it is the other one.
    turned = [[*row[:3], -row[3], -row[4], *row[5:]] for row in ladders.FEATURES]
    other = find_solutions(box(height, 0.0, 2.0 * (high - low), turned), LIMITS)
    assert len(other.fixtures) == 1
    assert abs(psi + other.fixtures[0][0] - np.pi / 2) < 1e-13
    assert abs(psi - other.fixtures[0][0]) > 0.9 * (high - low)


@pytest.mark.parametrize("rest", [1e-2, 1e-4, 1e-6])
def test_a_box_with_one_solution(rest: float) -> None:
    """Each solution alone in its box: one is a fixture, found to the last digits, the other is not."""
    height = -2.5 + rest
    low, high = solutions(height)
    found = []
    for psi in (low, high):
        outcome = find_solutions(
            box(height, psi - np.pi / 4 + 0.1 * (high - low), 0.3 * (high - low)), LIMITS
        )
        assert outcome.reason == ""
        found += outcome.fixtures
    assert len(found) == 1
    with exactly():
        exact = [ladders.unknowns(psi, height) for psi in ladders.orientations(height)]
        off = min(max(abs(float(v - w)) for v, w in zip(z, found[0], strict=True)) for z in exact)
    assert off < 1e-13


@pytest.mark.parametrize(("rest", "turn"), [(-1e-3, 0.0), (-1e-9, 0.0), (1e-4, 0.2), (1e-4, -0.2)])
def test_a_box_without_solutions_is_discarded(rest: float, turn: float) -> None:
    """Below the fold, or away from the solutions, nothing touches."""
    assert find_solutions(box(-2.5 + rest, turn, 1e-3), LIMITS) == BoxOutcome((), "")


@pytest.mark.parametrize("reach", [1e-8, 1e-6, 1e-4])
def test_an_exact_double_root_is_discarded(reach: float) -> None:
    """Its clamping force is 0: it is not a fixture, and nothing is left undecided."""
    assert find_solutions(box(-2.5, 0.0, reach), LIMITS) == BoxOutcome((), "")


def test_four_parallel_normals_take_few_boxes(monkeypatch: pytest.MonkeyPatch) -> None:
    """The double solution is the middle of the box, which is in one part of three and would be in both halves."""
    rest = [0.0, 0.0, 0.0, 0.0]
    floor, ceiling = [0.0, 0, -43, 1, 0, 60, 0, 1, *rest], [0.0, 46.5, -21, -1, 0, 90, 0, 1, *rest]
    eye, bore = [1.0, 60, -32, 1, 0, np.pi, 11, 1, *rest], [1.0, -60, -32, -1, 0, np.pi, 1, -1, *rest]
    places = [(0.0, 0.0), (0.0, -120.0), (0.0, -110.0), (-10.0, 0.0)]
    middle, reach = (np.pi / 2, -60.0, -43.0, 22.0), (1e-3, 1e-2, 1e-2, 2e-2)
    double = CandidateBox([floor, eye, ceiling, bore], places, 2, middle, reach)
    monkeypatch.setattr(settling, "MOST_BOXES", 75)
    assert find_solutions(double, LIMITS) == BoxOutcome((), "")


@pytest.mark.parametrize("center", [0.0, 3.0])
def test_three_parts_cover_a_place(center: float) -> None:
    """Neighbours overlap, and all are in the place but for a hair."""
    whole = arb(center, 2.0)
    parts = [part[1] for part in cut_in_thirds([arb(0, 1), whole, arb(0, 0.5)])]
    low, mid, high = sorted(parts, key=lambda part: float(part.mid()))
    assert low.overlaps(mid) and mid.overlaps(high)
    assert float(low.lower()) <= center - 2.0 and float(high.upper()) >= center + 2.0
    assert all(float(abs(part - center).upper()) < 2.001 for part in parts)


def large(half: float) -> CandidateBox:
    """Ladders of 25 and 50 mm, 12 mm apart in height: sin psi = 3/5 or 4/5 exactly, and the first peg 15 or 20 mm down the
    wall, which reaches ``half`` mm down and asks for no hair."""
    wall = [*ladders.LEFT_WALL[:5], half, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]
    floors = [[*row[:5], 90.0, *row[6:]] for row in ladders.FEATURES[1:]]
    places = [(0.0, 0.0), (25.0, 0.0), (0.0, -12.0), (50.0, -12.0)]
    return CandidateBox([wall, *floors], places, 2, (np.pi / 4, 0.0, -17.5, -12.0), (0.2, 5.0, 5.0, 9.0))


def test_a_rule_met_exactly_at_its_edge_is_undecided() -> None:
    """A contact exactly at the end of its face is neither inside nor outside, whatever the precision; a hair decides."""
    (fixture,) = find_solutions(large(90.0), LIMITS).fixtures
    tail = round(-fixture[2])
    assert tail in (15, 20)
    assert abs(fixture[2] + tail) < 1e-13
    assert find_solutions(large(float(tail)), LIMITS) == BoxOutcome((), "a rule is met exactly at its edge")
    assert find_solutions(large(tail - 1e-14), LIMITS) == BoxOutcome((), "")
    assert len(find_solutions(large(tail + 1e-14), LIMITS).fixtures) == 1


def test_what_takes_too_many_boxes_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(settling, "MOST_BOXES", 1)
    monkeypatch.setattr(settling, "find_roots_on_curve", lambda *_: None)
    outcome = find_solutions(box(-2.5 + 1e-6, 0.0, 1e-2), LIMITS)
    assert outcome.fixtures == ()
    assert outcome.reason


@pytest.mark.parametrize("rest", [1e-10, 1e-11])
@pytest.mark.parametrize("turn", [-3e-3, 1e-3])
def test_a_simple_solution_next_to_a_double_one_is_found_off_the_middle(rest: float, turn: float) -> None:
    """Where the Jacobian at the middle of the box does not separate the directions at the solutions, the one there does."""
    low, high = solutions(-2.5 + rest)
    outcome = find_solutions(box(-2.5 + rest, turn, 4e-3), LIMITS)
    assert outcome is not None and outcome.reason == ""
    found = [fixture[0] for fixture in outcome.fixtures]
    assert len(found) == 1
    assert min(abs(found[0] - low), abs(found[0] - high)) < 1e-13
