"""Units of length: what is written can be read again."""

from __future__ import annotations

from math import inf

import pytest
from hypothesis import given
from hypothesis import strategies as st

from workhold.errors import InputError
from workhold.units import INCH, MILLIMETRE, find_unit


@pytest.mark.parametrize(
    "unit", [MILLIMETRE, INCH, find_unit("cm"), find_unit("m")], ids=lambda unit: unit.name
)
@given(st.floats(-5000, 5000))
def test_numbers_are_right_to_half_their_last_digit(unit, length):
    """Every unit shows a length to 5 µm or better, as a fixed number of decimals or without its idle zeros."""
    for text in (unit.format_number(length), unit.format_short_length(length)):
        assert float(text) * unit.millimetres == pytest.approx(length, abs=0.005)
    assert len(unit.format_number(length).partition(".")[2]) == unit.decimals
    assert unit.format_length(length) == f"{unit.format_number(length)} {unit.abbreviation}"


def test_there_is_no_negative_zero():
    """A length that rounds to nothing has no sign."""
    assert INCH.format_number(-1e-9) == "0.0000"
    assert MILLIMETRE.format_short_length(-1e-9) == "0"


def test_figures_keep_zeros_that_count():
    """Only zeros behind a point are idle."""
    assert (
        MILLIMETRE.format_short_length(100.0),
        MILLIMETRE.format_short_length(100.0, 0),
        INCH.format_short_length(254.0),
    ) == ("100", "100", "10")


def test_names():
    """Any capitals, short and long; anything else is refused with what there is."""
    assert find_unit("Inch") == find_unit(" in ") == INCH
    with pytest.raises(InputError, match="Unit 'ell' is not known: use mm, cm, m or inch"):
        find_unit("ell")


def test_stresses_are_in_ksi_beside_pounds():
    """1000 lbf on a square inch is 6.894757 MPa (NIST SP 811); MPa stand beside it, not in columns."""
    assert INCH.format_stress(6.894757) == "1.0 ksi (7 MPa)"
    assert INCH.format_stress_number(896.0) == "130.0"
    assert MILLIMETRE.format_stress(896.0) == "896 MPa"


def test_moments_are_in_foot_pounds_beside_newton_metres():
    """A foot pound is 1.355818 N m (NIST SP 811), and -0.5 of it turns the other way."""
    assert INCH.format_moment(100 * 1355.818) == "100 ft lbf (136 N m)"
    assert INCH.format_moment(-0.5 * 1355.818) == "−0.5 ft lbf (−0.678 N m)"
    assert MILLIMETRE.format_moment(1355.818) == "1.36 N m"


def test_the_figure_of_stress_takes_the_unit_of_its_heading():
    """A column headed ksi has no MPa under it."""
    from workhold.model.quality import FIGURES, PIN_STRESS
    from workhold.presenting.figure_words import format_figure_number, make_heading

    stress = FIGURES[PIN_STRESS]
    assert make_heading(stress, INCH).endswith("ksi") and format_figure_number(stress, 896.0, INCH) == "130.0"
    assert (
        make_heading(stress, MILLIMETRE).endswith("MPa")
        and float(format_figure_number(stress, 896.0, MILLIMETRE)) == 896
    )


def test_forces_of_tables_are_pounds_with_inches():
    """A load reaction of 1000 N is 224.8 lbf; where it is ranked by, what is equal to two digits shows alike."""
    from workhold.model.quality import FIGURES
    from workhold.presenting.figure_words import (
        format_figure,
        format_figure_number,
        format_ranked_figure,
        make_heading,
    )

    force = next(figure for figure in FIGURES if figure.key == "load_reaction")
    assert make_heading(force, INCH).endswith(" lbf") and make_heading(force, MILLIMETRE).endswith(" N")
    assert (format_figure_number(force, 1000.0, INCH), format_figure_number(force, 1000.0, MILLIMETRE)) == (
        "224.8",
        "1000.0",
    )
    assert format_figure(force, 1000.0, INCH) == "224.8 lbf" and format_figure(force, inf, INCH) == "any"
    assert (format_ranked_figure(force, 1003.0, INCH), format_ranked_figure(force, 1003.0, MILLIMETRE)) == (
        "225",
        "1000",
    )
