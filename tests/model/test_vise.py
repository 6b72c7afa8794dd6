"""Vises: defaults, refusals, and where their holes are."""

from __future__ import annotations

from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from strategies import vises
from workhold.errors import InputError
from workhold.model.fixture import Peg
from workhold.model.holes import column_letters
from workhold.model.vise import Vise

VALID = {"pitch": 10, "columns": 2, "peg_radius": 3}


def test_defaults():
    """One pitch serves both directions; min_gap is the x pitch; rows and opening have no limit; no row offset."""
    vise = Vise(pitch=(10, 12), columns=2, peg_radius=3)
    assert (vise.pitch, vise.min_gap, vise.rows, vise.max_opening, vise.row_offset) == ((10, 12), 10, None, None, 0)
    assert Vise(pitch=8, columns=1, peg_radius=0).pitch == (8, 8)
    assert Vise(**VALID, min_gap=0).min_gap == 0


REFUSED = [
    ({"pitch": 0}, "pitch"),
    ({"pitch": -1}, "pitch"),
    ({"pitch": nan}, "pitch"),
    ({"pitch": (10, inf)}, "pitch"),
    ({"pitch": (10, 10, 10)}, "pitch"),
    ({"columns": 0}, "columns"),
    ({"columns": -2}, "columns"),
    ({"columns": 1.5}, "columns"),
    ({"rows": 0}, "rows"),
    ({"rows": 2.5}, "rows"),
    ({"peg_radius": -0.1}, "peg radius"),
    ({"peg_radius": nan}, "peg radius"),
    ({"peg_radius": inf}, "peg radius"),
    ({"peg_radius": 5.01}, "overlap"),
    ({"pitch": (10, 5.9)}, "overlap"),
    ({"min_gap": -1}, "min gap"),
    ({"min_gap": inf}, "min gap"),
    ({"min_gap": nan}, "min gap"),
    ({"max_opening": 0}, "max opening"),
    ({"max_opening": nan}, "max opening"),
    ({"max_opening": inf}, "max opening"),
    ({"max_opening": 9}, "below the min gap"),
    ({"row_offset": nan}, "row offset"),
    ({"row_offset": inf}, "row offset"),
]


@pytest.mark.parametrize(("change", "words"), REFUSED)
def test_refused(change, words):
    """Numbers that are not finite and positive, and pegs too fat for neighbouring holes, each by its own name."""
    with pytest.raises(InputError, match=words):
        Vise(**(VALID | change))


def test_pegs_that_just_fit_are_accepted():
    """2 rho = pitch is allowed, rho = 0 as well, and an opening that is exactly the gap."""
    assert Vise(pitch=10, columns=1, peg_radius=5).peg_radius == 5
    assert Vise(**VALID, max_opening=10).max_opening == 10


@given(vises(), st.integers(0, 5), st.integers(0, 9), st.floats(0, 100))
def test_holes_follow_the_lattice(vise, column, row, separation):
    """Left (i, j) is at (i lx, j ly); right (0, 0) is S to the right of the left jaw's last column, row_offset up."""
    assert vise.carriers[0].place(0, 0, separation) == (0, 0)
    left = vise.carriers[0].place(column, row, separation)
    assert left == pytest.approx((column * vise.pitch[0], row * vise.pitch[1]))
    last = vise.carriers[0].place(vise.columns - 1, row, separation)
    first = vise.carriers[1].place(0, row, separation)
    assert first[0] - last[0] == pytest.approx(separation)
    assert first[1] - last[1] == pytest.approx(vise.row_offset)
    right = vise.carriers[1].place(column, row, separation)
    assert right[0] - first[0] == pytest.approx(left[0]) and right[1] == pytest.approx(left[1] + vise.row_offset)


def test_hole_names():
    """Jaw, column letter, row from 1."""
    assert Peg("left", 1, 2, 0.0, 0.0, 5, 0.3).hole == "L-B3"
    assert Peg("right", 26, 0, 0.0, 0.0, 5, 0.3).hole == "R-AA1"


def test_column_letters_count_without_a_zero():
    """A..Z, AA..ZZ, AAA: all different, in order of length and then of the alphabet."""
    names = [column_letters(k) for k in range(26 + 26**2 + 1)]
    assert names == sorted(names, key=lambda name: (len(name), name)) and len(set(names)) == len(names)
    assert (names[0], names[25], names[26], names[-2], names[-1]) == ("A", "Z", "AA", "ZZ", "AAA")
