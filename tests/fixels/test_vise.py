"""Vises: defaults, refusals, and where their holes are."""

from __future__ import annotations

from math import inf, nan

import pytest
from attrs import evolve
from hypothesis import given
from hypothesis import strategies as st

from strategies import vises
from workhold import Peg, Vise
from workhold.errors import InputError
from workhold.fixels.carrier import HoleSelection, make_column_letters, parse_hole_name
from workhold.units import MILLIMETRE

VALID = {"pitch": 10, "columns": 2, "peg_radius": 3}


def test_defaults():
    """One pitch serves both directions; min_gap is the x pitch; rows and opening have no limit; no row offset."""
    vise = Vise(pitch=(10, 12), columns=2, peg_radius=3)
    assert (vise.pitch, vise.min_gap, vise.rows, vise.max_opening, vise.row_offset) == (
        (10, 12),
        10,
        None,
        None,
        0,
    )
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
    assert vise.carriers[0].compute_hole_center(0, 0, separation) == (0, 0)
    left = vise.carriers[0].compute_hole_center(column, row, separation)
    assert left == pytest.approx((column * vise.pitch[0], row * vise.pitch[1]))
    last = vise.carriers[0].compute_hole_center(vise.columns - 1, row, separation)
    first = vise.carriers[1].compute_hole_center(0, row, separation)
    assert first[0] - last[0] == pytest.approx(separation)
    assert first[1] - last[1] == pytest.approx(vise.row_offset)
    right = vise.carriers[1].compute_hole_center(column, row, separation)
    assert right[0] - first[0] == pytest.approx(left[0]) and right[1] == pytest.approx(
        left[1] + vise.row_offset
    )


def test_hole_names():
    """Jaw, column letter, row from 1."""
    assert Peg("left", 1, 2, 0.0, 0.0, 5, 0.3).hole == "L-B3"
    assert Peg("right", 26, 0, 0.0, 0.0, 5, 0.3).hole == "R-AA1"


@given(st.sampled_from(["left", "right"]), st.integers(0, 18_000), st.none() | st.integers(0, 999_999))
def test_a_hole_is_found_again_by_its_name(carrier: str, column: int, row: int | None) -> None:
    """Of carriers of any names, also in small letters and without the hyphen."""
    holes = HoleSelection(carrier, column, row)
    assert parse_hole_name(holes.name, ("left", "right"), "jaw") == holes
    assert parse_hole_name(f" {holes.name.lower().replace('-', '')}", ("left", "right"), "jaw") == holes
    plates = {"left": "wall", "right": "floor"}
    on_plate = HoleSelection(plates[carrier], column, row)
    assert parse_hole_name(on_plate.name, plates.values(), "plate") == on_plate
    with pytest.raises(InputError, match="give plate, column letter and row"):
        parse_hole_name(holes.name, ("wall", "floor"), "plate")


def test_column_letters_count_without_a_zero():
    """A..Z, AA..ZZ, AAA: all different, in order of length and then of the alphabet."""
    names = [make_column_letters(k) for k in range(26 + 26**2 + 1)]
    assert names == sorted(names, key=lambda name: (len(name), name)) and len(set(names)) == len(names)
    assert (names[0], names[25], names[26], names[-2], names[-1]) == ("A", "Z", "AA", "ZZ", "AAA")


def test_further_changes_are_what_their_words_say() -> None:
    """Lengths in the words are those of the changed vise; half the pitch is offered where pegs fit it both ways."""
    vise = Vise(pitch=(16, 20), columns=2, peg_radius=4, min_gap=12)
    assert {one.words: vise.with_fields(one.fields) for one in vise.list_further_changes(MILLIMETRE)} == {
        "with a smallest gap of 8 mm": evolve(vise, min_gap=8.0),
        "with one more column on each jaw": evolve(vise, columns=3),
        "with the right jaw's rows offset by 10 mm": evolve(vise, row_offset=10.0),
        "with half the pitch": evolve(vise, pitch=(8.0, 10.0), min_gap=8.0),
    }
    narrow = evolve(vise, pitch=(15.0, 20.0), min_gap=8.0, row_offset=1.0)
    assert [one.words for one in narrow.list_further_changes(MILLIMETRE)] == [
        "with one more column on each jaw"
    ]


def test_limits_are_lifted_one_by_one() -> None:
    """A vise without limits has none to lift; each that is lifted leaves the others."""
    plain = Vise(**VALID)
    assert plain.limits == ()
    vise = Vise(**VALID, body_radius=4, max_opening=50, rows=4, blocked=["L-A"])
    assert [limit.bounds for limit in vise.limits] == ["bodies", "travel", "holes", "holes"]
    for limit in vise.limits:
        left = vise.with_fields(limit.lifted.fields).limits
        assert [one.rule for one in left] == [one.rule for one in vise.limits if one != limit]
    assert vise.without_limits(vise.limits) == plain
