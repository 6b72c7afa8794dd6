"""The boxes in which the exact contacts of records are, and the ends of features that decide them in balls."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest
from flint import arb

from chord_examples import arc_row, line_row
from workhold import Query, Vise, load
from workhold.contact.problem import Problem
from workhold.conventions import END_SLACK
from workhold.kernels.contact import record
from workhold.proof.deciding import box_reach, interval_newton_in_doubles
from workhold.proof.interval_newton import end_slacks


def test_the_separation_is_known_to_what_both_pegs_and_the_turn_allow() -> None:
    """Two pegs 2 L apart across the travel, each off by the radius, in a frame off by the reach, are off by both radii and
    2 L times the reach along it; the box holds that."""
    row, length, radius, reach = np.zeros((1, record.RECORD_LENGTH)), 30.0, 1e-3, 1e-4
    row[0, [record.REACH, record.LARGEST_RADIUS]] = reach, radius
    off = 2 * radius * cos(reach) + 2 * length * sin(reach)
    assert off <= box_reach(row, length)[0, 3] <= 1.01 * off


@pytest.mark.parametrize("row", [line_row(0, 0, 0, 5.0), arc_row(0, 0, 5.0, 0.0, 1.0)], ids=["line", "arc"])
@pytest.mark.parametrize("side", [-1, 1])
def test_a_contact_past_an_end_counts_at_a_tangent_joint_alone(row: np.ndarray, side: int) -> None:
    """Half a hair past an end the rule is kept where the joint is tangent and broken where it is not, at either end, and the
    margin comes on top."""
    past = row[5] + 0.5 * END_SLACK / (row[6] or 1.0)
    place = (side * past, 0.0) if row[6] == 0.0 else (row[6] * cos(side * past), row[6] * sin(side * past))
    for smooth in (-1, 1):
        ends = [-END_SLACK, -END_SLACK]
        ends[(side + 1) // 2] *= -smooth
        slacks = end_slacks([*row, *ends], (arb(place[0]), arb(place[1])), 0.0)
        nearest = min(slacks, key=lambda slack: float(slack.mid()))
        assert (nearest > 0) == (smooth == 1) and (nearest < 0) == (smooth == -1)
        assert (
            min(
                float(slack.mid()) for slack in end_slacks([*row, *ends], (arb(place[0]), arb(place[1])), 1.0)
            )
            < -0.9
        )
    assert end_slacks([*arc_row(0, 0, 5.0, 0.0, pi), 0.0, 0.0], (arb(5), arb(0)), 9.0) == []


def test_a_wide_box_is_decided_in_doubles() -> None:
    """Three pegs whose curves touch, and a fourth whose row grazes its face: where it stands is known to some 9 mm only.
    Balls take 1.5 s for it and give it up; doubles take as many parts as it needs, and find that no fixture is there."""
    problem = Problem.of(Query(load("widget"), Vise(pitch=2, columns=5, peg_radius=0.75)))
    row = np.zeros((1, record.RECORD_LENGTH))
    row[0, : record.PSI] = 3, 12, 14, 13, 2, 0, -4, -1, 0, 0, -4, -1, -2
    row[0, record.PSI :] = -0.4988108, -15.43876, 4.146501, 47.99848, 4.116907e-4, 8.815414
    proven, still_open = interval_newton_in_doubles(
        row, problem, problem.setting._replace(backward_error=0.0)
    )
    assert len(proven) == len(still_open) == 0
