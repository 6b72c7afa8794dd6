"""The table of conventions in docs/belief.md, the module they stand in, and the copies of it say the same numbers."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from workhold import conventions
from workhold.verification import rules

BELIEF = Path(__file__).parent.parent / "docs" / "belief.md"
# Of each row of the table, by its first words: the numbers in it, and what verification calls them where it uses them.
ROWS = {
    "lines this near to parallel": (["PARALLEL"], []),
    "centres this near": (["SAME_CENTER"], []),
    "lengths this near to a coincidence": (["EXACT"], []),
    "a chord between concentric arcs": (["EXACT"], []),
    "a gap or an opening": (["GAP_SLACK"], ["HAIR"]),
    "past the end at a tangent joint": (["END_SLACK"], ["HAIR"]),
    "inside any other end": (["END_SLACK"], ["HAIR"]),
    "a tangent joint": (["JOINT", "TANGENT"], [None, "TANGENT"]),
    "features shorter": (["CLEARANCE"], []),
    "closure margin": (["LEAST_CLOSURE"], ["LEAST_SHARE"]),
    "clamping force": (["LEAST_CLAMPING"], ["LEAST_CLAMPING"]),
    "sizes of the four minors": (["LEAST_SPAN"], ["LEAST_SPAN"]),
    "same holes, orientation and place": (["SAME_POSE", "SAME_PLACE"], ["SAME", "SAME"]),
}


def table() -> list[tuple[str, list[float]]]:
    """What each row of the table is about, and its numbers."""
    text = BELIEF.read_text().partition("| what | number | why |\n|---|---|---|\n")[2].partition("\n\n")[0]
    cells = [[cell.strip() for cell in line.split("|")[1:3]] for line in text.splitlines()]
    return [(what, [float(number) for number in re.findall(r"\d+e-\d+", numbers)]) for what, numbers in cells]


def test_every_row_is_known_once() -> None:
    found = [[start for start in ROWS if what.startswith(start)] for what, _ in table()]
    assert all(len(starts) == 1 for starts in found), found
    assert sorted(starts[0] for starts in found) == sorted(ROWS)


@pytest.mark.parametrize("start", ROWS)
def test_a_row_has_the_numbers_of_the_program_and_of_the_verification(start: str) -> None:
    names, copies = ROWS[start]
    numbers = next(numbers for what, numbers in table() if what.startswith(start))
    assert numbers == [getattr(conventions, name) for name in names]
    assert all(getattr(rules, copy) == number for copy, number in zip(copies, numbers, strict=False) if copy)


def test_every_number_of_the_claim_has_a_row() -> None:
    """The group of the module is the table."""
    group = Path(conventions.__file__).read_text().partition("# == Part of the claim")[2].partition("# ==")[0]
    assert set(re.findall(r"^([A-Z_]+) = ", group, flags=re.M)) == {
        name for names, _ in ROWS.values() for name in names
    }


def test_the_verification_reads_outlines_as_the_geometry_does() -> None:
    assert (rules.STRAIGHT, rules.WHOLE) == (conventions.STRAIGHT, conventions.WHOLE)
