"""What the report is made of: blocks of words in which every number is tagged with its key.

A sentence may not hold a digit of its own, see :func:`words`. So no number can come into print but from a data file, or
as a label, a quotation, a command or a reference, each of which is marked as such.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from math import floor, isfinite, log10
from typing import Any, Literal

from attrs import field, frozen

__all__ = [
    "Block",
    "Figures",
    "Heading",
    "Inline",
    "Line",
    "Listing",
    "Marked",
    "Number",
    "Paragraph",
    "Picture",
    "Table",
    "line_of",
    "typographic",
]

DIGIT = re.compile(r"\d")
# What stands for a number that was not measured.
NOTHING = "–"


@frozen
class Number:
    """A number of a data file as it is printed.

    Parameters
    ----------
    key : its place, ``section/name/0/name``.
    text : as printed; the value is the text times ``scale``, to half a unit of its last digit.
    scale : what the printed number counts in, such as 0.001 for seconds printed in ms.
    """

    key: str
    text: str
    scale: float = 1.0


@frozen
class Marked:
    """Words that may hold digits because they are not results."""

    kind: Literal["code", "quote", "label", "reference", "formula"]
    text: str


def typographic(text: str) -> str:
    """Words with the apostrophe of print."""
    return text.replace("'", "’")


def is_free_of_digits(_: object, __: object, value: Sequence[Inline]) -> None:
    """Refuse digits without a key.

    Raises
    ------
    ValueError
        Naming the words.
    """
    for one in value:
        if isinstance(one, str) and DIGIT.search(one):
            raise ValueError(f"a number without a key in {one!r}")


Inline = str | Number | Marked
Line = tuple[Inline, ...]


def line_of(content: Inline | Sequence[Inline]) -> Line:
    """A line of one thing, or of several."""
    return (content,) if isinstance(content, (str, Number, Marked)) else tuple(content)


def lines_of(cells: Sequence[Inline | Sequence[Inline]]) -> tuple[Line, ...]:
    """A line for each cell."""
    return tuple(line_of(cell) for cell in cells)


def rows_of(rows: Sequence[Sequence[Inline | Sequence[Inline]]]) -> tuple[tuple[Line, ...], ...]:
    """The lines of each row."""
    return tuple(lines_of(row) for row in rows)


def are_free_of_digits(instance: object, attribute: object, value: Sequence[Line]) -> None:
    """Refuse digits without a key in any of some lines."""
    for one in value:
        is_free_of_digits(instance, attribute, one)


@frozen
class Heading:
    """The heading of a section, or of a part of one (depth 2)."""

    text: str
    depth: int = 1


@frozen
class Paragraph:
    """Sentences."""

    line: Line = field(converter=line_of, validator=is_free_of_digits)


@frozen
class Listing:
    """Points, one below the other."""

    points: tuple[Line, ...] = field(converter=lines_of, validator=are_free_of_digits)
    kind: Literal["points", "references"] = "points"


@frozen
class Table:
    """A table.

    Parameters
    ----------
    label : such as "Table 1".
    caption : what it shows.
    headings : of the columns, with units.
    rows : lines of cells.
    left : the columns that hold words, which stand on the left.
    bold_last : whether the last row sums up.
    groups : what stands over columns that belong together, and over how many; empty words for nothing.
    """

    label: str
    caption: Line = field(converter=line_of, validator=is_free_of_digits)
    headings: tuple[Line, ...] = field(converter=lines_of, validator=are_free_of_digits)
    rows: tuple[tuple[Line, ...], ...] = field(converter=rows_of)
    left: tuple[int, ...] = (0,)
    bold_last: bool = False
    groups: tuple[tuple[str, int], ...] = ()

    @rows.validator
    def check_rows(self, attribute: object, rows: tuple[tuple[Line, ...], ...]) -> None:
        """Refuse rows of another length, and digits without a key."""
        for row in rows:
            if len(row) != len(self.headings):
                raise ValueError(f"{self.label}: {len(row)} cells below {len(self.headings)} headings")
            are_free_of_digits(self, attribute, row)


@frozen
class Picture:
    """Pictures side by side, each an SVG text of ``workhold.drawing.scene``, under one caption.

    Parameters
    ----------
    label : such as "Figure 1".
    parts : SVG texts, and what stands below each.
    across : how many stand in a row.
    """

    label: str
    caption: Line = field(converter=line_of, validator=is_free_of_digits)
    parts: tuple[tuple[str, str], ...]
    across: int = 2


Block = Heading | Paragraph | Listing | Table | Picture


@frozen
class Figures:
    """The data file of a section, read as numbers for print.

    Parameters
    ----------
    section : its name.
    data : what was measured.
    complete : whether all of it was.
    """

    section: str
    data: Mapping[str, Any]
    complete: bool = True

    def value(self, path: str) -> Any:
        """What stands at a path such as ``rows/0/seconds``; None where nothing does."""
        found: Any = self.data
        for name in path.split("/"):
            try:
                found = found[int(name)] if isinstance(found, list) else found[name]
            except (KeyError, IndexError):
                return None
            if found is None:
                return None
        return found

    def printed(self, path: str, text: str, scale: float = 1.0) -> Number:
        """A number with its key."""
        return Number(f"{self.section}/{path}", text.replace("-", "−"), scale)

    def count(self, path: str) -> Inline:
        """A whole number, thousands apart."""
        value = self.value(path)
        return NOTHING if value is None else self.printed(path, f"{value:,}")

    def fixed(self, path: str, decimals: int, scale: float = 1.0) -> Inline:
        """A number with so many decimals, in a unit of ``scale``."""
        value = self.value(path)
        if value is None:
            return NOTHING
        return self.printed(path, f"{value / scale:,.{decimals}f}", scale) if isfinite(value) else "∞"

    def significant(self, path: str, digits: int = 3, scale: float = 1.0) -> Inline:
        """A number with so many digits that count; larger ones are whole."""
        value = self.value(path)
        if value is None:
            return NOTHING
        size = abs(value / scale)
        decimals = max(digits - 1 - floor(log10(size)), 0) if size else 0
        return self.fixed(path, decimals, scale)

    def power(self, path: str) -> Inline:
        """A power of ten, such as 1e−6."""
        value = self.value(path)
        return NOTHING if value is None else self.printed(path, f"{value:.0e}".replace("e-0", "e-"))

    def percent(self, path: str, decimals: int = 0) -> Inline:
        """A share in percent; the sign belongs to it."""
        value = self.value(path)
        if value is None:
            return NOTHING
        return self.printed(path, f"{100.0 * value:.{decimals}f} %", 0.01)

    def every(self, path: str) -> range:
        """The indices of a list, none where it is not there."""
        found = self.value(path)
        return range(len(found or ()))
