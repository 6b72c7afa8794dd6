"""Tables of words, and printing of tables and sentences in the width of the terminal."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from textwrap import wrap
from typing import TextIO

import typer
from attrs import define, field, frozen

from workhold.errors import make_printable, shorten_middle

__all__ = ["Table", "format_count", "print_tables", "wrap_sentence", "find_terminal_width"]

# Between two columns where there is room, and where there is little.
GAP, NARROW_GAP = 3, 2
# A column of words is wrapped down to this many letters.
LEAST_WRAPPED = 20
# A word in such a column that is longer is broken where there is no room for it.
LONGEST_WORD = 32
# What to do for the columns that are left out.
MORE = "A wider terminal or a pipe shows them; --json has all."


@frozen
class FittedTable:
    """A table as lines of text; ``red`` has the indices of the lines that a terminal shows in red."""

    headings: list[str]
    lines: list[str]
    red: set[int]


@define
class Table:
    """Rows of words under a line of headings.

    Parameters
    ----------
    columns : headings; the content of a column is aligned right where its heading begins with ``>``.
    rows : the words, one for each column.
    red : indices of the rows that a terminal shows in red.
    spare : number of the last columns that may be left out, one by one, where a terminal has no room.
    """

    columns: tuple[str, ...]
    rows: list[tuple[str, ...]] = field(factory=list)
    red: set[int] = field(factory=set)
    spare: int = 0

    def add_row(self, *words: str) -> None:
        """Add a row, one word for each column."""
        self.rows.append(words)

    def format_lines(self) -> list[str]:
        """Return the lines of the table without a limit of width: headings, a rule, and the rows."""
        fitted = self.fit_to_width(None)
        return [*fitted.headings, *fitted.lines]

    def fit_to_width(self, width: int | None) -> FittedTable:
        """Return the table as lines of at most ``width`` characters; None means no limit.

        A table that is too wide is narrowed in this order: wrap headings; leave out spare columns and say so
        in a last line; wrap columns of words, the widest first; leave out columns from the right, but never
        the first. No number is cut.
        """
        right = [column.startswith(">") for column in self.columns]
        headings = [column.lstrip(">") for column in self.columns]
        columns = list(zip(*self.rows, strict=True)) or [()] * len(headings)
        content = [max(map(len, column), default=0) for column in columns]
        widths = [max(len(heading), most) for heading, most in zip(headings, content, strict=True)]
        tops, gap, kept = [[heading] for heading in headings], GAP, len(headings)
        rows, left_out = [[[word] for word in row] for row in self.rows], ""
        if width is not None and sum_widths(widths, gap) > width:
            gap = NARROW_GAP
            widths = [
                max(most, *map(len, heading.split() or [""]))
                for heading, most in zip(headings, content, strict=True)
            ]
            least = [
                room
                if at_right
                else min(
                    room, max(min(measure_longest_word((heading, *column)), LONGEST_WORD), LEAST_WRAPPED)
                )
                for heading, column, room, at_right in zip(headings, columns, widths, right, strict=True)
            ]
            while sum_widths(widths[:kept], gap) > width and kept > len(headings) - self.spare:
                kept -= 1
            while sum_widths(least[:kept], gap) > width and kept > 1:
                kept -= 1
            widths = narrow_columns(widths[:kept], least[:kept], sum_widths(widths[:kept], gap) - width)
            tops = [wrap(heading, room) for heading, room in zip(headings, widths, strict=False)]
            rows = [
                [
                    [word] if at_right or len(word) <= room else wrap(word, room, break_on_hyphens=False)
                    for word, room, at_right in zip(row, widths, right, strict=False)
                ]
                for row in self.rows
            ]
            if kept < len(headings):
                left_out = f"No room for: {', '.join(headings[kept:])}. {MORE}"

        def make_lines(cells: list[list[str]], low: bool) -> list[str]:
            """Return the lines of one row; shorter cells are padded above if ``low``, else below."""
            high = max(map(len, cells[:kept]))
            filled = [
                [""] * (high - len(cell)) + cell if low else cell + [""] * (high - len(cell))
                for cell in cells[:kept]
            ]
            return [
                (" " * gap)
                .join(
                    f"{word:>{room}}" if at_right else f"{word:<{room}}"
                    for word, room, at_right in zip(words, widths, right, strict=False)
                )
                .rstrip()
                for words in zip(*filled, strict=True)
            ]

        lines = ["─" * sum_widths(widths[:kept], gap)]
        red: set[int] = set()
        for number, row in enumerate(rows):
            written = make_lines(row, low=False)
            if number in self.red:
                red.update(range(len(lines), len(lines) + len(written)))
            lines += written
        return FittedTable(
            make_lines(tops, low=True),
            lines + wrap(left_out, max(width or 0, 1), break_long_words=False),
            red,
        )


def measure_longest_word(texts: Iterable[str]) -> int:
    """Return the length of the longest word in the texts; 0 without words."""
    return max((len(word) for text in texts for word in text.split()), default=0)


def narrow_columns(widths: list[int], least: list[int], over: int) -> list[int]:
    """Return column widths reduced by ``over`` characters in all.

    Each character is taken from the column that is widest at that moment, and no column gets narrower than
    its ``least`` width. Where all have their least width, less than ``over`` is taken.

    >>> narrow_columns([30, 10, 40], [24, 10, 24], 14)
    [28, 10, 28]
    """
    made = list(widths)
    for _ in range(max(over, 0)):
        able = [k for k, room in enumerate(made) if room > least[k]]
        if not able:
            break
        made[max(able, key=lambda k: (made[k], k))] -= 1
    return made


def sum_widths(widths: list[int], gap: int) -> int:
    """Return the width of a table with columns of these widths and gaps between them."""
    return sum(widths) + gap * (len(widths) - 1)


def format_count(count: int, word: str) -> str:
    """Return a number and its noun, with an s unless the number is 1.

    >>> format_count(1, "fixture"), format_count(2, "fixture")
    ('1 fixture', '2 fixtures')
    """
    return f"{count} {word}" if count == 1 else f"{count} {word}s"


def print_tables(*parts: Table | str, stream: TextIO | None = None) -> None:
    """Print tables and sentences to a stream, stdout by default.

    On a terminal headings are bold, and lines are no longer than it is wide unless a single word is.
    """
    stream = stream or sys.stdout
    width = find_terminal_width(stream)
    for part in parts:
        if isinstance(part, Table):
            fitted = part.fit_to_width(width)
            headings, lines, red = fitted.headings, fitted.lines, fitted.red
        else:
            headings, lines, red = wrap_sentence(shorten_middle(part), width), [], set()
        headings, lines = list(map(make_printable, headings)), list(map(make_printable, lines))
        if lines and stream.isatty():
            headings = [typer.style(line, bold=True) for line in headings]
            lines = [typer.style(line, fg="red") if row in red else line for row, line in enumerate(lines)]
        stream.write("\n".join([*headings, *lines]) + "\n")
    stream.flush()


def wrap_sentence(sentence: str, width: int | None) -> list[str]:
    """Return a sentence as lines of at most ``width`` characters
    (None: no limit), all indented as the sentence is.

    >>> wrap_sentence("  one two three", 10)
    ['  one two', '  three']
    """
    words = sentence.lstrip(" ")
    indent = " " * (len(sentence) - len(words))
    if width is None or len(sentence) <= width or not words:
        return [sentence]
    return wrap(
        words,
        width,
        initial_indent=indent,
        subsequent_indent=indent,
        break_long_words=False,
        break_on_hyphens=False,
    )


def find_terminal_width(stream: TextIO) -> int | None:
    """Return the width in characters of a stream's terminal; None where there is no limit, as in a file.

    The environment variable COLUMNS takes precedence.
    """
    given = os.environ.get("COLUMNS", "")
    if given.isascii() and given.isdigit() and int(given[:6]):
        return int(given[:6])
    try:
        # A terminal that does not know its size says 0.
        return os.get_terminal_size(stream.fileno()).columns or None if stream.isatty() else None
    except (OSError, ValueError):
        return None
