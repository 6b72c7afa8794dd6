"""Jaw plates: the lattice's holes, none of them blocked, apart from one another and within the plate."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from attrs import evolve
from hypothesis import given
from hypothesis import strategies as st

from workhold import Plate, Vise
from workhold.errors import InputError
from workhold.fixels.carrier import HoleSelection
from workhold.model.dowels import Bolts, compute_peg_error, list_jaw_plates, refuse_limits
from workhold.units import INCH

VISE = Vise(pitch=(10, 12), columns=3, peg_radius=3, rows=4, row_offset=5.0)


def test_holes_are_those_of_the_jaws() -> None:
    """Every hole's name and its place from the jaw's own A1; what is blocked is missing from its jaw alone."""
    left, right = list_jaw_plates(
        evolve(VISE, blocked=(HoleSelection("left", 1), HoleSelection("right", 0, 0)))
    )
    assert [len(left.holes), len(right.holes)] == [8, 11]
    vise = list_jaw_plates(VISE)
    for plate, carrier in zip(vise, VISE.carriers, strict=True):
        zero = carrier.compute_hole_center(0, 0)
        for name, (x, y) in plate.holes:
            column, row = "ABC".index(name[2]), int(name[3:]) - 1
            assert carrier.compute_hole_center(column, row) == pytest.approx((x + zero[0], y + zero[1]))
    assert {name for name, _ in vise[0].holes} - {name for name, _ in left.holes} == {
        "L-B1",
        "L-B2",
        "L-B3",
        "L-B4",
    }


def test_the_edge_is_as_far_as_asked_for() -> None:
    """Half a pitch each way, or what is given."""
    box = list_jaw_plates(VISE)[0].outline
    assert (box.x0, box.y0, box.x1, box.y1) == (-5, -6, 25, 42)
    box = list_jaw_plates(VISE, edge=15.0)[1].outline
    assert (box.x0, box.y0, box.x1, box.y1) == (-15, -15, 35, 51)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"bolts": Bolts(5.0, ((5.0, 6.0), (22.6, 6.0)))}, "bolt 2 at 22.6,6 leaves the left jaw's plate"),
        ({"bolts": Bolts(5.0, ((10.0, 5.4),))}, "bolt 1 at 10,5.4 runs into dowel hole L-B1"),
        ({"bolts": Bolts(4.0, ((5.0, 6.0), (5.0, 9.9)))}, "bolt 2 at 5,9.9 runs into bolt 1"),
        ({"bolts": Bolts(0.0, ((5.0, 6.0),))}, "bolt holes of 0 mm cannot be drilled"),
        ({"hole_diameter": 10.0}, "dowel holes of 10 mm do not fit"),
        ({"hole_diameter": 0.0}, "dowel holes of 0 mm do not fit"),
        ({"edge": 3.0}, "the plate's edge would cut its outermost dowel holes"),
        ({"hole_diameter": 25.4, "unit": INCH}, "dowel holes of 1 in do not fit"),
    ],
)
def test_what_cannot_be_drilled_is_refused(changes: dict, said: str) -> None:
    """Holes that meet, or leave the plate."""
    with pytest.raises(InputError, match=said):
        list_jaw_plates(VISE, **changes)


def test_bolts_that_just_miss_are_allowed() -> None:
    """A tenth of a millimetre from a dowel hole, an edge and another bolt."""
    bolts = Bolts(4.0, ((5.0, 6.0), (5.0, 10.1), (22.9, 6.0), (10.0, 5.1)))
    assert all(plate.bolts == bolts for plate in list_jaw_plates(VISE, bolts=bolts))


def test_plates_need_a_number_of_rows() -> None:
    """As many as needed is none."""
    with pytest.raises(InputError, match="how many columns and rows"):
        list_jaw_plates(evolve(VISE, rows=None))


def test_a_clamp_has_no_plate_to_drill() -> None:
    """Of a plate with a clamp only the plate is drilled, with all its holes."""
    (plate,) = list_jaw_plates(Plate(pitch=20, peg_radius=5, columns=8, rows=6, directions=("-x", "-y")))
    assert (plate.title, len(plate.holes)) == ("plate", 48) and plate.holes[0][0] == "A1"


# How far a pin's surface may be off, against every pin in every hole.
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
    assert compute_peg_error(radius, pin, hole, position) == pytest.approx(max(off), abs=1e-12)


def test_a_pin_of_just_the_size_pressed_into_its_place_is_not_off():
    """No clearance, no difference in size, no error of position: nothing is left."""
    assert compute_peg_error(3.0, (6.0, 6.0), (5.987, 6.0), 0.0) == 0


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
