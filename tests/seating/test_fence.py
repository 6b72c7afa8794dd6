"""Where a part on a fence is in balance: what is looked at in kernels against the formulas over whole ranges."""

from __future__ import annotations

import numpy as np
import pytest

import workhold
from workhold import Fence, Workpiece
from workhold.kernels.seating.columns import CONTACTS, FORCE, PEG, PIECE, RESIDUAL, THETA
from workhold.seating.balance import settle_on_wall
from workhold.seating.fence import LOCATOR, TIP
from workhold.seating.fence import Fence as OnFence
from workhold.seating.pattern import Pattern
from workhold.seating.seating import Solver

PART = Workpiece.from_loops(
    "rounded", [[[0, 0, 0], [60, 8, 0.3], [60, 40, 0], [30, 50, 0], [0, 30, 0]], [[22, 22, -1.0], [38, 26, -1.0]]]
)


@pytest.mark.parametrize("way", ["+x", "-y"])
def test_every_change_of_the_slope_is_found_or_presses_nothing(way):
    """Wherever the separation's slope changes its sign while wall, locator and tip touch, told by numpy."""
    toolkit = Fence(pitch=20, peg_radius=3, wall_offset=10, directions=[way])
    fixture = workhold.design(PART, toolkit, best=1)[0]
    closing = Solver(PART, toolkit).closing(Pattern.of(fixture, toolkit), False)
    fence = OnFence(closing.locus, closing.pattern)
    found = np.array(fence.three_contacts())
    assert len(found) > 1 and (found[:, CONTACTS] == 3.0).all()
    missing = []
    for piece, thetas in fence.runs:
        for locator in fence.branches(0):
            place, one = fence.placed(piece, locator, thetas)
            if not one.there.any():
                continue
            for tip in fence.branches(1):
                there = one.there & fence.met(tip, thetas, place)[1].there
                if not there.any():
                    continue
                slope = np.where(there, fence.slope(piece, locator, tip, thetas), np.nan)
                steep = np.maximum(np.abs(slope[1:]), np.abs(slope[:-1])) > 1e-6
                for k in np.flatnonzero(steep & (slope[1:] * slope[:-1] < 0.0)):
                    same = (found[:, PEG : PEG + 2] == (LOCATOR, TIP)).all(axis=1)
                    same &= (found[:, PIECE : PIECE + 2] == (locator[0], tip[0])).all(axis=1)
                    if not (same & (found[:, THETA] >= thetas[k]) & (found[:, THETA] <= thetas[k + 1])).any():
                        missing.append(fence.balanced(piece, locator, tip, float(thetas[k : k + 2].mean())))
    assert missing
    for rows, some_press in ((np.array(missing), False), (found, True)):
        settle_on_wall(rows, closing.locus, closing.pattern, closing.size)
        pressing = rows[np.isfinite(rows[:, RESIDUAL]), FORCE : FORCE + 3].min(axis=1) > 0.0
        assert pressing.any() == some_press
