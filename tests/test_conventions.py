"""The table of conventions in docs/belief.md, the module they stand in, and the copies of it say the same numbers."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from workhold import conventions
from workhold.verification import tolerances as rules

BELIEF = Path(__file__).parent.parent / "docs" / "belief.md"
# Of each row of the table, by its first words: the numbers in it, and what verification calls them where it uses them.
ROWS = {
    "lines this near to parallel": (["PARALLEL"], []),
    "centres this near": (["SAME_CENTER"], []),
    "lengths this near to a coincidence": (["EXACT"], []),
    "normals that exact lengths": (["DEPENDENT"], []),
    "a chord between concentric arcs": (["EXACT"], []),
    "a gap, an opening": (["GAP_SLACK"], ["HAIR"]),
    "the body of a clamp may enter": (["BODY_SLACK"], ["BODY_SLACK"]),
    "past the end at a tangent joint": (["END_SLACK"], ["HAIR"]),
    "inside any other end": (["END_SLACK"], ["HAIR"]),
    "a contact margin asked for": (["END_SLACK"], ["HAIR"]),
    "a straight piece of the convex hull": (["LEAST_HULL_EDGE"], ["LEAST_FLUSH"]),
    "an arc this near to its chord": (["READING"], []),
    "an arc of a bulge below this": (["STRAIGHT"], ["STRAIGHT"]),
    "a tangent joint": (["JOINT", "TANGENT"], [None, "TANGENT"]),
    "features shorter": (["CLEARANCE"], []),
    "a hollow arc whose radius": (["FILLED"], ["FILLED"]),
    "closure margin": (["LEAST_CLOSURE"], ["LEAST_SHARE"]),
    "clamping force": (["LEAST_CLAMPING"], ["LEAST_CLAMPING"]),
    "of two clamps each pushes": (["LEAST_PUSH", "LEAST_SEAT"], ["LEAST_PUSH", "LEAST_SEAT"]),
    "no peg is pressed": (["MOST_FORCE"], ["MOST_FORCE"]),
    "a locator's force per unit": (["NO_REACTION"], ["NO_REACTION"]),
    "sizes of the four minors": (["LEAST_SPAN"], ["LEAST_SPAN"]),
    "same holes, orientation and place": (["SAME_POSE", "SAME_PLACE"], ["SAME", "SAME"]),
}


def table() -> list[tuple[str, list[float]]]:
    """What each row of the table is about, and its numbers."""
    text = BELIEF.read_text().partition("| what | number | why |\n|---|---|---|\n")[2].partition("\n\n")[0]
    cells = [[cell.strip() for cell in line.split("|")[1:3]] for line in text.splitlines()]
    return [
        (what, [float(number) for number in re.findall(r"\d+e-?\d+", numbers)]) for what, numbers in cells
    ]


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


def other_rows() -> list[str]:
    """What the manual's table of the other numbers has to say: a row for each comment of the module, below its group's name.

    Numbers that stand below one comment share a row.
    """
    groups = Path(conventions.__file__).read_text().split("\n# == ")[2:]
    rows = []
    for title, _, body in (group.partition(" ==\n") for group in groups):
        rows.append(f"| **{title}** | | |")
        for comment, numbers in re.findall(r"((?:^# .*\n)+)((?:^[A-Z].* = .*\n)+)", body, flags=re.M):
            names = ", ".join(f"`{name}`" for name in re.findall(r"\b[A-Z_]{2,}\b", numbers))
            values = ", ".join(line.partition(" = ")[2] for line in numbers.splitlines())
            rows.append(f"| {names} | {values} | {' '.join(comment.replace('# ', '').splitlines())} |")
    return rows


def test_every_other_number_has_its_row() -> None:
    """A table beside that of the claim says of every group what the module says; the message is what it should be."""
    head = "| name | number | what it measures, and why it is what it is |\n|---|---|---|\n"
    text = BELIEF.read_text().partition(head)[2].partition("\n\n")[0].rstrip("\n")
    assert text.splitlines() == other_rows(), "\n".join(other_rows())


def test_no_number_of_the_module_is_without_a_row() -> None:
    rows = "".join(other_rows())
    claimed = {name for names, _ in ROWS.values() for name in names}
    numbers = {name for name, value in vars(conventions).items() if isinstance(value, int | float)}
    assert {name for name in numbers if f"`{name}`" not in rows} == claimed


def test_the_verification_reads_outlines_as_the_geometry_does() -> None:
    assert (rules.STRAIGHT, rules.WHOLE) == (conventions.STRAIGHT, conventions.WHOLE)


# Of the sizes of dowels and of supports, which no figure of a fixture rests on, and of rounding.
NOT_JUDGED = {"FIGURE_DECIMALS", "DOWEL_DEPTH", "DOWEL_STANDOUT", "STEADY"}


def test_the_verification_judges_by_the_numbers_of_the_order() -> None:
    """What is warned of and what counts against a fixture, each written twice."""
    group = Path(conventions.__file__).read_text().partition("# == What is warned of")[2]
    names = set(re.findall(r"\b([A-Z_]{4,})\b(?=[A-Z_, ]* = )", group)) - NOT_JUDGED
    assert len(names) == 19
    assert {name: getattr(rules, name) for name in names} == {
        name: getattr(conventions, name) for name in names
    }
