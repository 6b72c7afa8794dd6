"""Proofs of zeros."""

from __future__ import annotations

import pytest
from flint import arb, arb_mat, ctx

from workhold.verification.placing import enclose_zero


def circle_and_line(z: arb_mat) -> tuple[arb_mat, arb_mat]:
    """x² + y² = 25 and 3x = 4y meet at (4, 3) and (-4, -3)."""
    x, y = z.entries()
    return arb_mat([[x * x + y * y - 25], [3 * x - 4 * y]]), arb_mat([[2 * x, 2 * y], [arb(3), arb(-4)]])


def circle_and_tangent(z: arb_mat) -> tuple[arb_mat, arb_mat]:
    """x² + y² = 25 and 4x + 3y = 25 touch at (4, 3): a double zero."""
    x, y = z.entries()
    return arb_mat([[x * x + y * y - 25], [4 * x + 3 * y - 25]]), arb_mat([[2 * x, 2 * y], [arb(4), arb(3)]])


@pytest.mark.parametrize("bits", [64, 128, 256, 512])
@pytest.mark.parametrize(("start", "expected"), [((4.2, 2.7), (4, 3)), ((-3.0, -3.0), (-4, -3))])
def test_a_zero_is_enclosed_to_the_precision(
    bits: int, start: tuple[float, float], expected: tuple[int, int]
) -> None:
    with ctx.workprec(bits):
        zero = enclose_zero(circle_and_line, start)
        assert zero is not None
        assert all(ball.contains(value) for ball, value in zip(zero, expected, strict=True))
        assert all(float(ball.rad()) < 2.0 ** (8 - bits) for ball in zero)


@pytest.mark.parametrize("bits", [64, 128, 256])
def test_a_double_zero_is_never_proven(bits: int) -> None:
    with ctx.workprec(bits):
        assert enclose_zero(circle_and_tangent, (4.0, 3.0)) is None
        assert enclose_zero(circle_and_tangent, (4.1, 2.95)) is None


def test_no_zero_is_never_proven() -> None:
    """x² = -1e-12 has no zero, however near the start."""

    def system(z: arb_mat) -> tuple[arb_mat, arb_mat]:
        (x,) = z.entries()
        return arb_mat([[x * x + arb("1e-12")]]), arb_mat([[2 * x]])

    for bits in (64, 128, 512):
        with ctx.workprec(bits):
            assert enclose_zero(system, (1e-7,)) is None
