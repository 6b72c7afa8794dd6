"""How far a pin's surface may be off, against every pin in every hole."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from workhold.errors import InputError
from workhold.model.dowels import peg_error, refuse_limits

DEVIATION = st.floats(-0.05, 0.05)


@given(DEVIATION, DEVIATION, DEVIATION, DEVIATION, st.floats(0, 0.05), st.floats(0.5, 15))
def test_no_pin_in_no_hole_is_off_by_more_and_one_is_by_as_much(a, b, c, d, position, radius):
    """p + max(0, D - d)/2 + |d - 2 rho|/2 over a grid of pins d and holes D: the worst is the bound."""
    pin = (2 * radius + min(a, b), 2 * radius + max(a, b))
    hole = (2 * radius + min(c, d), 2 * radius + max(c, d))
    off = [
        position + max(0.0, bore - diameter) / 2 + abs(diameter - 2 * radius) / 2
        for diameter, bore in product(np.linspace(*pin, 7), np.linspace(*hole, 7))
    ]
    assert peg_error(radius, pin, hole, position) == pytest.approx(max(off), abs=1e-12)


def test_a_pin_of_just_the_size_pressed_into_its_place_is_not_off():
    """No clearance, no difference in size, no error of position: nothing is left."""
    assert peg_error(3.0, (6.0, 6.0), (5.987, 6.0), 0.0) == 0


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        ((6.009, 6.003), "wrong way round"),
        ((0.0, 6.0), "two positive lengths"),
        ((float("nan"), 6.0), "two positive lengths"),
        ((3.0, 3.01), "a diameter, the other a radius"),
        ((12.0, 12.01), "a diameter, the other a radius"),
    ],
)
def test_limits_that_are_not_those_of_the_peg_are_refused(limits, words):
    """The usual slips: largest first, nothing, a radius for a diameter."""
    with pytest.raises(InputError, match=words):
        refuse_limits("pin_diameter", limits, 3.0)
