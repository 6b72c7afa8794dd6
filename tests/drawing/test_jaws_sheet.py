"""The setup sheet of a part between two flat jaws."""

from __future__ import annotations

from datetime import date

import pytest
from sheet_reading import words_of

from jaw_examples import LOADS, held, vise
from workhold.drawing import SheetDetails, draw_fixture, draw_sheet
from workhold.model.jaw_hold import HOLD_FIGURES
from workhold.presenting.figure_words import format_figure_number
from workhold.units import MILLIMETRE
from workhold.web.answers import describe_hold

SETTINGS = (
    "opening S",
    "on the fixed jaw",
    "the moving jaw presses",
    "work stop",
    "gripped along the jaws",
)


@pytest.mark.parametrize("loads", [(), LOADS[:1]])
def test_each_setting_stands_on_the_sheet_once(loads: tuple[object, ...]) -> None:
    """The opening, what both jaws touch, the stop, and where the part is gripped."""
    result = held(loads=loads)
    details = SheetDetails(number=1, count=len(result), day=date(2026, 11, 30), result_hash="", version="1")
    pages = draw_sheet(result[0], result.workpiece, result.toolkit, details)
    words = [text for page in pages for text, _ in words_of(page)]
    assert [words.count(name) for name in SETTINGS] == [1] * len(SETTINGS)


@pytest.mark.thorough
def test_numbers_of_times_are_rounded_down_everywhere() -> None:
    """On sheet, picture, terminal and page, and in the warning: 1.99 times for a hair less than twice."""
    need = held(loads=LOADS[:2])[0].hold.clamp_needed
    result = held(
        loads=LOADS[:2], jaw_force=0.99995 * need, toolkit=vise(max_force=0.99995 * need, jaw_height=44)
    )
    first = next(one for one in result if one.hold.clamp_needed == need)
    details = SheetDetails(number=1, count=len(result), day=date(2026, 11, 30), result_hash="", version="1")
    pages = [
        *draw_sheet(first, result.workpiece, result.toolkit, details),
        draw_fixture(first, result.workpiece, result.toolkit),
    ]
    words = [text for page in pages for text, _ in words_of(page)]
    assert words.count("1.99 times the loads") >= 2 and any("held 1.99 times" in text for text in words)
    assert not any("2.00 times" in text or "1.00 times" in text for text in words)
    assert any(text.endswith("0.99 times that") for text in words)
    reached = next(figure for figure in HOLD_FIGURES if figure.key == "safety_reached")
    assert format_figure_number(reached, first.hold.safety_reached, MILLIMETRE) == "1.99"
    assert min(describe_hold(first)["safety_each"]) == 1.99
    assert any("hold the loads 1.99 times" in sentence for sentence in first.hold.warnings)
