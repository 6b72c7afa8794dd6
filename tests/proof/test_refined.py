"""A proven solution is made sharper as long as a step finds a binary digit or more, and no longer than is of use."""

from __future__ import annotations

from typing import cast

import pytest
from flint import arb, ctx

from workhold.proof.interval_newton import SHARP, refine_solution
from workhold.proof.singular_frame import SingularFrame

# A solution whose place is known to a hundredth of a mm in one direction, and better in the others.
ROOT = [arb(3, 1e-2), arb(-2, 1e-3), arb(0, 1e-5), arb(8, 1e-3)]


class Steps:
    """Stands for a frame whose steps leave a share of a place: given steps, and those that are regular."""

    def __init__(self, share: float | None, regular: float | None = None) -> None:
        self.share, self.regular = share, regular
        self.taken = list[bool]()

    def compute_contacts(self, place: list[arb]) -> list[arb]:
        """The place itself."""
        return place

    def narrow(
        self, place: list[arb], here: list[arb], regular: bool = False
    ) -> tuple[list[arb] | None, bool]:
        """What a step leaves of a place."""
        assert here is place
        self.taken.append(regular)
        share = self.regular if regular else self.share
        return (None if share is None else [arb(p.mid(), p.rad() * share) for p in place], True)


def sharp(steps: Steps, root: list[arb] = ROOT) -> float:
    """The largest radius of a solution after the steps."""
    made = refine_solution(cast(SingularFrame, steps), root)
    assert all(one.mid() == p.mid() for one, p in zip(made, root, strict=True))
    return max(float(p.rad()) for p in made)


@pytest.mark.parametrize(("bits", "taken"), [(53, 2), (128, 7), (160, 10)])
def test_steps_end_where_the_solution_is_as_sharp_as_is_of_use(bits: int, taken: int) -> None:
    """With the precision in force, and no step is taken after that."""
    steps = Steps(2.0**-14)
    with ctx.workprec(bits):
        radius = sharp(steps)
    assert len(steps.taken) == taken
    assert radius < SHARP * 0.5**bits <= radius * 2.0**14


def test_a_solution_that_is_sharp_takes_no_step() -> None:
    """As most do that are found by the curve."""
    steps = Steps(0.5)
    root = [arb(1, 1e-12)] * 4
    assert sharp(steps, root) == pytest.approx(1e-12)
    assert steps.taken == []


def test_no_more_than_twelve_steps_are_taken() -> None:
    """Though each finds a digit."""
    steps = Steps(0.49)
    with ctx.workprec(512):
        assert sharp(steps) == pytest.approx(1e-2 * 0.49**12, rel=1e-6)
    assert steps.taken == [False] * 12


def test_where_a_step_finds_less_than_a_digit_a_regular_one_is_tried() -> None:
    """It may find more, and where it does not either, the solution stays as it was."""
    steps = Steps(0.6, regular=1e-12)
    assert sharp(steps) == pytest.approx(1e-14, rel=1e-6)
    assert steps.taken == [False, True]
    for nothing in (Steps(0.6, regular=0.51), Steps(0.6, regular=None)):
        assert sharp(nothing) == pytest.approx(1e-2)
        assert nothing.taken == [False, True]
    lost = Steps(None)
    assert sharp(lost) == pytest.approx(1e-2)
    assert lost.taken == [False]
