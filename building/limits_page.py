"""The tables of ``docs/limits.md`` that the code decides, written from the code: ``python building/limits_page.py``.

They stand between ``<!-- limits: NAME -->`` and ``<!-- end of limits -->``; a test compares them with the code.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from workhold import errors, limits
from workhold.archive import MOST_DIRECTORY, MOST_TEXT
from workhold.files import tables, text
from workhold.files.budget import LIMITS, FileLimits
from workhold.files.input_forms import LONGEST_NAME
from workhold.files.result.parts import MOST_AROUND, MOST_LINE

PAGE = Path(__file__).resolve().parent.parent / "docs" / "limits.md"
# What would be taken for markup of the page stands in backquotes.
MARKUP, QUOTED = re.compile(r"<\w+>"), r"`\g<0>`"
PLACE = re.compile(r"(<!-- limits: (\w+) -->\n).*?(<!-- end of limits -->)", flags=re.S)


def count(number: float | None) -> str:
    """A count in figures, millions in words."""
    if number is None:
        return "any number"
    if number >= 1_000_000 and number % 100_000 == 0:
        return f"{number / 1e6:,g} million"
    return f"{number:,.10g}"


def format_power(number: float) -> str:
    """A number as the sources write it, such as 1e6."""
    return f"{number:g}".replace("e+0", "e")


def make_reader_row(one: FileLimits) -> str:
    """The row of a kind of file."""
    elements = (
        "none"
        if one.most_elements is None
        else f"{count(one.most_elements)} {MARKUP.sub(QUOTED, one.elements)}"
    )
    deepest = "" if one.deepest is None else f", {one.deepest} deep"
    seconds = "none"
    if one.seconds is not None:
        seconds = f"{one.seconds:g} s"
        if one.seconds_per_million:
            seconds += f", and {one.seconds_per_million:g} s for every million bytes"
    size = "none" if one.most_bytes is None else f"{count(one.most_bytes)} bytes"
    return f"| {one.what} | {size} | {elements}{deepest} | {seconds} |"


def tabulate_readers() -> str:
    """What a file of every kind may ask for."""
    head = "| file | size | elements | processor time |\n|---|---|---|---|\n"
    return head + "".join(f"{make_reader_row(one)}\n" for one in LIMITS.values())


def tabulate_numbers() -> str:
    """How large numbers may be, and how long what is read."""
    rows = (
        ("coordinates and lengths", f"{format_power(limits.MOST_LENGTH)} mm"),
        ("the radius of an arc", f"{format_power(limits.MOST_RADIUS)} mm"),
        ("a force; a moment", f"{format_power(limits.MOST_FORCE)} N; {format_power(limits.MOST_FORCE)} N mm"),
        ("a coefficient of friction", count(limits.MOST_FRICTION)),
        ("holes of a jaw or plate (columns times rows)", count(limits.MOST_HOLES)),
        ("holes and columns that are blocked", count(limits.MOST_BLOCKED)),
        (
            "ways in which two pegs of one jaw or plate can stand; the same times the part's faces",
            f"{count(limits.MOST_STEPS)}; {count(limits.MOST_CHORDS)}",
        ),
        ("ways in which two pairs of contacts go together", count(limits.MOST_WAYS)),
        ("pairs of pegs and faces of the paper's algebra", count(limits.MOST_PEG_PAIRS)),
        ("threads of a search", count(limits.MOST_THREADS)),
        ("letters of the name of a part or a load", count(LONGEST_NAME)),
        ("letters of a message", count(errors.LONGEST)),
        (
            "letters of a cell of CSV; columns",
            f"{count(tables.MOST_LETTERS)}; {count(tables.MOST_COLUMNS)}",
        ),
        ("digits of a whole number", count(text.MOST_DIGITS)),
        (
            "lists and objects of a file in JSON; its values",
            f"{count(text.MOST_BRACKETS)}; {count(text.MOST_COMMAS)}",
        ),
        ("a result file with one fixture on every line", "none; it is read in blocks"),
        (
            "the line of a fixture in it; all that stands around the fixtures",
            f"{count(MOST_LINE)} bytes; {count(MOST_AROUND)} bytes",
        ),
        (
            "a result file in columns",
            f"none; its head {count(MOST_TEXT)} bytes, its directory {count(MOST_DIRECTORY)}",
        ),
    )
    return "| what | limit |\n|---|---|\n" + "".join(f"| {what} | {limit} |\n" for what, limit in rows)


def fill_page(page: str) -> str:
    """A page with its places filled."""
    made = {"readers": tabulate_readers, "numbers": tabulate_numbers}
    return PLACE.sub(lambda found: found[1] + made[found[2]]() + found[3], page)


if __name__ == "__main__":
    PAGE.write_text(fill_page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    sys.stdout.write(f"{PAGE} is written.\n")
