"""Values of options, as text."""

from __future__ import annotations

import re
from math import inf

import pytest
from attrs import fields

from workhold import Plate
from workhold.cli.toolkit_options import ToolkitWords
from workhold.cli.values import number, positive_number
from workhold.errors import InputError
from workhold.units import MILLIMETRE


def test_a_positive_number_is_above_zero_and_finite() -> None:
    assert positive_number("--jaw-force", " 1e-3 ") == 0.001
    for text in ("0", "-5", "inf", "nan", "much", ""):
        with pytest.raises(InputError, match="is not a positive number"):
            positive_number("--jaw-force", text)


def test_fractions_have_signs() -> None:
    """Of the whole of them."""
    assert [number(text) for text in ("-1/2", "-1-1/2", "+1 1/4", "1/0")] == [-0.5, -1.5, 1.25, inf]


def typed_words(**typed: str) -> ToolkitWords:
    """What was typed of a plate with two clamps."""
    plate = {"toolkit": "plate", "pitch": "20", "peg_radius": "3", "clamps": "2"}
    return ToolkitWords(**{field.name: None for field in fields(ToolkitWords)} | plate | typed)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("-x", (("-x", "-x"),)),
        ("-x,-y", (("-x", "-x"), ("-x", "-y"), ("-y", "-y"))),
        ("-x:-y", (("-x", "-y"),)),
        (" -y : -x , -x:+y", (("-x", "-y"), ("-x", "+y"))),
    ],
)
def test_pairs_of_directions(words: str, told: tuple[tuple[str, str], ...]) -> None:
    """Pairs are joined by a colon, in any order; single directions stand for all pairs of them."""
    toolkit, _ = typed_words(directions=words).asked(MILLIMETRE)
    assert isinstance(toolkit, Plate) and (toolkit.clamps, toolkit.directions) == (2, told)


@pytest.mark.parametrize(
    ("typed", "message"),
    [
        ({"directions": "-x:-y,-x"}, "pairs and single directions"),
        ({"directions": "-x:-z"}, "direction '-z'"),
        ({"clamps": "1", "directions": "-x:-y"}, "one clamp"),
        ({"clamps": "3"}, "1 or 2"),
        ({"clamps": "two"}, "--clamps"),
        ({"toolkit": "vise", "columns": "2"}, "--clamps is of plates"),
    ],
)
def test_words_about_two_clamps_that_mean_nothing(typed: dict[str, str], message: str) -> None:
    """Each is refused in one sentence."""
    with pytest.raises(InputError, match=re.escape(message)):
        typed_words(**typed).asked(MILLIMETRE)
