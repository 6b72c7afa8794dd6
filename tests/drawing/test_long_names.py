"""Names of any length and of any letters are broken and cut as ever, in a time that follows their length."""

from __future__ import annotations

import random
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

import workhold
from workhold.drawing import scene
from workhold.drawing.scene import count_fitting_letters, measure_text, shorten_text, wrap_text
from workhold.errors import InputError
from workhold.files.part.load import read_workpiece

LONGEST = 10_000

HOSTILE = Path(__file__).parents[1] / "data" / "hostile"
LETTERS = "abcWi .-Ø樂\u202e\x07\u0301🔩"


def cut_letter_by_letter(content: str, size: float, width: float, behind: str) -> int:
    """The most letters that fit, tried one after the other."""
    count = 0
    while count < len(content) and measure_text(content[: count + 1] + behind, size) <= width:
        count += 1
    return count


@pytest.mark.parametrize("behind", ["", "…"])
def test_as_much_is_kept_as_fits(behind: str) -> None:
    """Not a letter more or less, of random texts in random widths."""
    chance = random.Random(5)
    for _ in range(300):
        text = "".join(chance.choices(LETTERS, k=chance.randrange(1, 60)))
        width = chance.uniform(0, 300)
        expected = cut_letter_by_letter(text, 10.0, width, behind)
        assert count_fitting_letters(text, 10.0, width, False, behind) == expected
        if behind and measure_text(text, 10.0) > width:
            assert shorten_text(text, 10.0, width) == text[:expected].rstrip() + "…"


def test_a_word_is_broken_where_it_no_longer_fits() -> None:
    """Each line is as long as can be, a letter at least, and nothing is lost."""
    chance = random.Random(6)
    for _ in range(100):
        word = "".join(chance.choices("abcWiØ樂", k=chance.randrange(2, 80)))
        width = chance.uniform(0, 120)
        lines = wrap_text(word, 10.0, width)
        assert "".join(lines) == word
        for line, after in pairwise(lines):
            assert len(line) == 1 or measure_text(line, 10.0) <= width
            assert measure_text(line + after[0], 10.0) > width or after == lines[-1][:1] == after


@pytest.mark.parametrize("cut", [wrap_text, shorten_text])
def test_long_words_are_measured_about_as_often_as_they_have_lines(
    cut: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Letters looked at, not seconds: ten times the word may ask for some ten times as many."""
    looked = [0]

    def counted(content: str, size: float, bold: bool = False) -> float:
        looked[0] += min(len(content), 200)
        return measure_text(content, size, bold)

    monkeypatch.setattr(scene, "measure_text", counted)
    counts = []
    for length in (1_000, 10_000):
        looked[0] = 0
        cut("abcdefgh?" * (length // 9), 20.0, 300.0)
        counts.append(looked[0])
    assert counts[1] < 15 * counts[0]


def test_a_name_of_thousands_of_letters_is_read() -> None:
    """One that came in; above the limit a part is refused in a sentence."""
    assert len(workhold.open(HOSTILE / "longname.json").workpiece.name) == 3600


def test_a_name_longer_than_any_sheet_is_refused(tmp_path: Path) -> None:
    """With the limit."""
    path = tmp_path / "p.json"
    text = '{"name": "%s", "units": "mm", "loops": [[[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]]}'
    path.write_text(text % ("x" * LONGEST))
    assert len(read_workpiece(path).workpiece.name) == LONGEST
    path.write_text(text % ("x" * (LONGEST + 1)))
    with pytest.raises(InputError, match='"name" must be text of 10,000 letters at most'):
        read_workpiece(path)
