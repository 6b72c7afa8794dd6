"""Values of options, as text: what was typed reaches the search."""

from __future__ import annotations

from math import isclose
from typing import Any

import pytest

from workhold import Plate

VISE = ("design", "widget", "--pitch", "10", "--columns", "2", "--peg-radius", "3")


@pytest.mark.thinned(3)
@pytest.mark.parametrize(
    ("text", "millimetres", "inches"),
    [
        ("2", 2, 50.8),
        ("1/2", 0.5, 12.7),
        ("-1-1/2", -1.5, -38.1),
        ("1 1/4", 1.25, 31.75),
        ("1e-1", 0.1, 2.54),
        ("0.5in", 12.7, 12.7),
        ('1/2"', 12.7, 12.7),
        ("12.7 mm", 12.7, 12.7),
        ("1INCH", 25.4, 25.4),
        ("-3cm", -30, -30),
        ("1m", 1000, 1000),
    ],
)
def test_lengths_carry_their_unit_or_take_the_one_asked(
    run: Any, searched: dict[str, Any], text: str, millimetres: float, inches: float
) -> None:
    """Of the centre of a zone, which may be on either side of zero."""
    words = (*VISE[:2], "--vise", "plate-20mm", "--keep-out", f"circle={text},0mm,1mm")
    for unit, told in (("mm", millimetres), ("inch", inches)):
        assert run(*words, "--unit", unit).exit_code == 0
        assert isclose(searched["asked"].restrictions.zones[0].loop[:, 0].mean(), told)


@pytest.mark.parametrize(
    "text", ["", "mm", "in", "1/0", "1/2/3", "/2", "1_0", "inf", "nanmm", "5 ft", "1,5", "--1"]
)
def test_what_is_no_length_is_refused_in_the_unit_asked(
    run: Any, searched: dict[str, Any], text: str
) -> None:
    for unit, told in ((), "a plain number in mm"), (("--unit", "inch"), "a plain number in in, such as"):
        refused = run(*VISE, f"--min-opening={text}", *unit)
        assert refused.exit_code == 2 and searched["asked"] is None
        assert f"give {told}" in refused.stderr


def test_a_pitch_may_mix_units(run: Any, searched: dict[str, Any]) -> None:
    for text, unit, told in (("1/2in,20", "mm", (12.7, 20)), ("1,20mm", "inch", (25.4, 20))):
        words = ("--pitch", text, "--columns", "2", "--peg-radius", "3mm", "--unit", unit)
        assert run(*VISE[:2], *words).exit_code == 0
        assert searched["asked"].toolkit.pitch == told


def test_fractions_have_signs(run: Any, searched: dict[str, Any]) -> None:
    """Of the whole of them; a division by zero is not a number."""
    assert run(*VISE, "--angle=-1-1/2..+1 1/4", "--angle=-1/2").exit_code == 0
    assert searched["asked"].restrictions.angles == ((-1.5, 1.25), (-0.5, -0.5))
    assert "is not a range of angles" in run(*VISE, "--angle", "1/0").stderr


def test_a_positive_number_is_above_zero_and_finite(run: Any) -> None:
    family = ("family", "widget", "--vise", "plate-20mm", "--time-limit")
    for text in ("0", "-5", "inf", "nan", "much", ""):
        refused = run(*family, text)
        assert refused.exit_code == 2 and f"--time-limit {text!r} is not a positive number" in refused.stderr


PLATE = ("--toolkit", "plate", "--pitch", "20", "--peg-radius", "3")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("-x", (("-x", "-x"),)),
        ("-x,-y", (("-x", "-x"), ("-x", "-y"), ("-y", "-y"))),
        ("-x:-y", (("-x", "-y"),)),
        (" -y : -x , -x:+y", (("-x", "-y"), ("-x", "+y"))),
    ],
)
def test_pairs_of_directions(
    run: Any, searched: dict[str, Any], words: str, told: tuple[tuple[str, str], ...]
) -> None:
    """Pairs are joined by a colon, in any order; single directions stand for all pairs of them."""
    assert run(*VISE[:2], *PLATE, "--clamps", "2", f"--direction={words}").exit_code == 0
    toolkit = searched["asked"].toolkit
    assert isinstance(toolkit, Plate) and (toolkit.clamps, toolkit.directions) == (2, told)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((*PLATE, "--clamps", "2", "--direction=-x:-y,-x"), "pairs and single directions"),
        ((*PLATE, "--clamps", "2", "--direction=-x:-z"), "direction '-z'"),
        ((*PLATE, "--clamps", "1", "--direction=-x:-y"), "one clamp"),
        ((*PLATE, "--clamps", "3"), "1 or 2"),
        ((*PLATE, "--clamps", "two"), "--clamps"),
        ((*PLATE, "--toolkit", "vise", "--columns", "2", "--clamps", "2"), "--clamps is of plates"),
    ],
)
def test_words_about_two_clamps_that_mean_nothing(
    run: Any, searched: dict[str, Any], words: tuple[str, ...], message: str
) -> None:
    """Each is refused in one sentence."""
    refused = run(*VISE[:2], *words)
    assert refused.exit_code == 2 and message in refused.stderr and refused.stderr.count("\n") == 1
