"""The setup sheet of a part between two flat jaws."""

from __future__ import annotations

from datetime import date

import pytest
from sheet_reading import words_of

from jaw_examples import LOADS, held
from workhold.drawing import SheetDetails, draw_sheet

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
