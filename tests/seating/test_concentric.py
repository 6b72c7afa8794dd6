"""Equilibria in which a peg of each jaw touches arcs of one centre, and the normal of a third goes through it."""

from __future__ import annotations

from collections import Counter
from math import atan2, cos, hypot, sin
from pathlib import Path

import numpy as np
import pytest

from seating_examples import at_angle, equilibria_of, held, on_pieces, touching, two_contacts_of
from workhold import Vise, Workpiece, load
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, X, Y
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CLEAR,
    CONFIG,
    MOTION,
    PEG,
    PIECE,
    SECOND,
    SEPARATION,
)
from workhold.kernels.seating.parallel_and_concentric import write_about_one_center
from workhold.seating.closing import fill_rows
from workhold.seating.equilibria import balance_candidates
from workhold.seating.join_tree import JoinTree
from workhold.seating.pattern import Pattern
from workhold.seating.solver import SeatingSolver

VISE = Vise(pitch=10, columns=2, peg_radius=3)
# A plate with a rounded end, a round notch, a slanted side and a small hole.
PLATE = Workpiece.from_loops(
    "plate",
    [
        [[0, 0, 0], [60, 0, 1], [60, 50, 0], [40, 50, -0.6], [20, 50, 0], [5, 45, 0]],
        [[30, 20, -1], [22, 20, -1]],
    ],
)


def beyond_ends(row, given):
    """How far the three pegs of a candidate are past the ends of their pieces, in mm, at most."""
    out = []
    for piece, dx, dy in on_pieces(row, given, row[CONFIG]):
        along, across = dx * piece[AXIS_X] + dy * piece[AXIS_Y], dy * piece[AXIS_X] - dx * piece[AXIS_Y]
        at, scale = (along, 1.0) if piece[IS_ARC] == 0.0 else (atan2(across, along), piece[RADIUS])
        out.append((abs(at) - piece[HALF_EXTENT]) * scale)
    return max(out)


@pytest.fixture(scope="module")
def found():
    """Of pegs at random heights what the kernel writes, with what it is given; two of the left jaw and two of the right."""
    random, solver, out = np.random.default_rng(7), SeatingSolver(PLATE, VISE), []
    for _ in range(60):
        places = random.uniform((0.0, 0.0), (25.0, 60.0), (4, 2))
        pegs = [
            ("left" if k < 2 else "right", x + 100.0 * (k >= 2), y)
            for k, (x, y) in enumerate(places.tolist())
        ]
        pattern = Pattern.from_fixture(held(pegs, (0.0, 0.0, 0.0), 100.0), VISE)
        closing = solver.make_closing(pattern, False)
        given = two_contacts_of(closing).given
        rows = fill_rows(CANDIDATE_LENGTH, 4, write_about_one_center, given, -1e3, 1e3)
        out.append((closing, given, rows, balance_candidates(rows.copy(), given, closing.size)))
    return out


@pytest.mark.thorough
def test_three_pegs_touch_and_the_separation_is_stationary(found):
    """Its second derivative is what is written, by differences of what three contacts leave free."""
    kinds = Counter()
    for _, given, rows, _ in found:
        for row in rows[:: max(len(rows) // 6, 1)]:
            assert np.abs(touching(row, given, row[CONFIG])).max() < 1e-9 and beyond_ends(row, given) < 1e-8
            step = 2e-4
            before, after = (at_angle(row, given, row[0] + off) for off in (-step, step))
            second = (before + after - 2.0 * row[SEPARATION]) / step**2
            assert abs(after - before) / (2 * step) < 1e-4 * (1.0 + abs(row[SECOND]))
            assert second == pytest.approx(row[SECOND], rel=2e-2, abs=1e-2)
            # The part turns about the centre, where it is.
            center, (c, s) = given.rows[int(row[PIECE]), [X, Y]], (cos(row[0]), sin(row[0]))
            assert row[MOTION : MOTION + 3] == pytest.approx(
                [1.0, s * center[0] + c * center[1], s * center[1] - c * center[0]]
            )
            one, other = (given.rows[int(row[PIECE + k])] for k in (1, 2))
            kinds[bool(one[IS_ARC]), bool(given.right[int(row[PEG])]), bool(row[SECOND] > 0)] += 1
            assert hypot(*(other[[X, Y]] - center)) < 1e-9
    # The third on lines and on arcs, of both jaws, least and greatest separations.
    assert len(kinds) == 8, kinds


@pytest.mark.thorough
def test_ways_down_end_nowhere_that_is_not_known(found):
    """Where a part comes to rest so, ways down end there: in a seat, and in none that is unsettled."""
    looked_at = 0
    for closing, _, _, balanced in found:
        known = equilibria_of(closing)
        free = balanced[(balanced[:, SECOND] > 0.0) & (balanced[:, CLEAR] > 0.0)][:, 1:4]
        resting = [row for row in free if (np.abs(known.seats[:, 1:4] - row).max(axis=1) < 1e-6).any()]
        if resting:
            looked_at += 1
            assert len(JoinTree.from_equilibria(known, closing).doubtful) == 0
        if looked_at == 4:
            break
    assert looked_at == 4


def test_a_bracket_that_rests_on_its_rounded_end_is_seated():
    """A peg of each jaw on the rounded end, and one of the left in a rounded inner corner: it was told as unsettled."""
    part = load(Path(__file__).parents[2] / "examples" / "bracket.dxf")
    pegs = [
        ("left", 10, 0),
        ("left", 10, 60),
        ("right", 65.09828112125015, 20),
        ("right", 65.09828112125015, 100),
    ]
    fixture = held(pegs, (90.0, 62.098281121250174, 3.0), 55.09828112125016)
    closing = SeatingSolver(part, VISE).make_closing(Pattern.from_fixture(fixture, VISE), True)
    tree = JoinTree.from_equilibria(equilibria_of(closing), closing)
    assert len(tree.doubtful) == 0
    [seat] = [row for row in tree.seats if abs(row[SEPARATION] - 26.2451) < 1e-4]
    assert np.degrees(seat[0]) % 360.0 == pytest.approx(96.1725, abs=1e-4)
