"""Tables in CSV, as spreadsheets and other programs write them.

RFC 4180 describes the usual form. Deviations that are common in practice are read as well: lines that end in
CR alone or in any mixture, a byte order mark, semicolons and tabs instead of commas, the line ``sep=;`` of
Excel, empty columns and rows. What could be read in two ways is refused with its line, row and column.

Glossary
--------
names : the cells of the first row, which are the names of the columns.
row : the cells in a line below the names, counted from 1; rows without any cell do not count.
line : of the text, as an editor counts. A cell in quotes may hold several.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from math import isfinite, nan
from typing import Any

from attrs import define, field, frozen

from workhold.errors import InputError
from workhold.files.budget import Budget
from workhold.limits import read_number

__all__ = ["MOST_COLUMNS", "MOST_LETTERS", "NOT_GIVEN", "SAVED", "CsvRow", "CsvTable", "read_table"]

# Letters of a cell, and columns: more than anything that is read from tables needs.
MOST_LETTERS, MOST_COLUMNS = 10_000, 1_000
# Letters of the first line in which is looked for what separates cells.
LONGEST_HEAD = 100_000
# What says in a cell that nothing is given, as people and spreadsheets write it.
NOT_GIVEN = frozenset(("", "-", "–", "—", "n/a", "#n/a", "n.a.", "na"))
# How a spreadsheet is told to write it in a form that can be read.
SAVED = 'save it as UTF-8 (in Excel as "CSV UTF-8")'
MARKS = (",", ";", "\t")
LINE_END = re.compile(r"\r\n?")
# Excel says in such a line how the cells are separated, and takes it for no row.
SEPARATOR = re.compile(r"sep=(.)[ \t]*\n", re.IGNORECASE)
QUOTED = re.compile(r'[ \t]*+"([^"]*+(?:""[^"]*+)*+)"[ \t]*+')
BARE = {mark: re.compile(rf"[^{mark}\n]*+") for mark in MARKS}
BLANK = re.compile(r"[ \t]*\n")


@frozen
class CsvRow:
    """A row of a table.

    Parameters
    ----------
    row, line : number of the row, and of the line where it begins, both from 1.
    cells : the cells that are not empty, by the names of their columns, without spaces around them.
    mark : the separator of cells.
    """

    row: int
    line: int
    cells: Mapping[str, str]
    mark: str = ","

    def __str__(self) -> str:
        return f"line {self.line}, row {self.row}"

    def read_number_cell(self, name: str) -> Any:
        """Return the text of a cell for a number; None where it is not given.

        A comma is replaced by a point unless commas separate the cells. Whether the text is a number is not
        checked.
        """
        cell = self.cells.get(name)
        if cell is None or cell.lower() in NOT_GIVEN:
            return None
        return cell if self.mark == "," else cell.replace(",", ".")

    def read_number(self, name: str) -> float:
        """Return the number in a column that each row must have.

        Raises
        ------
        InputError
            With line, row and column, where there is no finite number.
        """
        value = self.read_number_cell(name)
        number = nan if value is None else read_number(value)
        if not isfinite(number):
            said = "there is no number" if value is None else f"'{value[:40]}' is not a finite number"
            raise InputError(f"{self}, column {name}: {said}: write one, such as 12.5.")
        return number


@define(eq=False)
class CsvTable:
    """A table whose rows are read one by one.

    Parameters
    ----------
    text : text of the table, with lines that end in "\\n".
    mark : the separator of cells.
    remark : matches a line that is a remark; None where there are none.
    budget : spent for each row.
    at, line, number : position of the reader: offset in the text, number of the line there, and number of
        rows read so far.
    names : names of the columns; "" for a column without a name, which has no cells.
    """

    text: str = field(repr=False)
    mark: str
    remark: re.Pattern[str] | None
    budget: Budget = field(repr=False)
    at: int
    line: int
    number: int = field(default=0, init=False)
    names: tuple[str, ...] = field(default=(), init=False)

    def describe_place(self, column: int | None = None, line: int | None = None) -> str:
        """Return line, row and column of a cell in words; without ``column`` only line and row.

        ``column`` counts from 0. ``line`` is the current line if None.
        """
        words = f"line {self.line if line is None else line}"
        words += f", row {self.number}" if self.names else ""
        if column is None:
            return words
        name = self.names[column] if column < len(self.names) else ""
        return f"{words}, column {column + 1}" + (f" ({name[:40]})" if name else "")

    def iterate_rows(self) -> Iterator[CsvRow]:
        """Yield the rows that have a cell; a second call continues after the last row read.

        Raises
        ------
        InputError
            For a cell under no name, quotes that do not end, a cell or row that is too large, and NUL bytes.
        """
        while (read := self.read_next_row()) is not None:
            line, cells = read
            given = {k: cell for k, cell in enumerate(cells) if cell}
            last = max(given)
            if last >= len(self.names):
                raise InputError(
                    f"{self.describe_place(line=line)} has {last + 1} cells under {len(self.names)} names: put a cell "
                    f"with {name_separator(self.mark)} in double quotes, or leave out the cells that are too many."
                )
            for k in given:
                if not self.names[k]:
                    raise InputError(
                        f"{self.describe_place(k, line)} has a cell and no name: name the column."
                    )
            self.budget.spend()
            yield CsvRow(self.number, line, {self.names[k]: cell for k, cell in given.items()}, self.mark)

    def read_next_row(self) -> tuple[int, list[str]] | None:
        """Return the line and the cells of the next row that has a cell with content; None at the end."""
        self.number += bool(self.names)
        while self.at < len(self.text):
            if self.remark is not None and (found := self.remark.match(self.text, self.at)):
                self.at, self.line = found.end(), self.line + 1
                continue
            line = self.line
            cells = self.read_cells()
            if any(cells):
                return line, cells
        return None

    def read_cells(self) -> list[str]:
        """Return the cells up to the end of the line, "" for empty ones, without spaces around them."""
        cells = list[str]()
        while True:
            cells.append(self.read_next_cell(len(cells)))
            if len(cells) > MOST_COLUMNS:
                raise InputError(
                    f"{self.describe_place()} has more than {MOST_COLUMNS:,} cells: leave some out."
                )
            end = self.text[self.at : self.at + 1]
            self.at += 1
            if end != self.mark:
                self.line += 1
                return cells

    def read_next_cell(self, column: int) -> str:
        """Return the next cell, and leave the position at the separator or line end after it.

        ``column`` is its number from 0, for messages.
        """
        found = QUOTED.match(self.text, self.at)
        if found is not None:
            cell, end = found[1].replace('""', '"'), found.end()
            if self.text[end : end + 1] not in ("", "\n", self.mark):
                raise InputError(
                    f"{self.describe_place(column)} goes on after its closing quote: write a quote inside a cell twice, "
                    "and the cell in quotes."
                )
        else:
            found = BARE[self.mark].match(self.text, self.at)
            assert found is not None
            cell, end = found[0], found.end()
            if cell.lstrip().startswith('"'):
                raise InputError(
                    f"{self.describe_place(column)} begins with a quote that is not closed: close it."
                )
        if len(cell) > MOST_LETTERS:
            raise InputError(
                f"{self.describe_place(column)} has {len(cell):,} letters, more than the {MOST_LETTERS:,} of a cell: "
                "shorten it, or close a quote before it."
            )
        if "\0" in cell:
            raise InputError(
                f"{self.describe_place(column)} has a NUL byte: save the table as text in UTF-8."
            )
        self.at, self.line = end, self.line + found[0].count("\n")
        return cell.strip()


def name_separator(mark: str) -> str:
    """Return the name of a separator: "commas", "semicolons" or "tabs"."""
    return {",": "commas", ";": "semicolons"}.get(mark, "tabs")


def read_table(text: str, budget: Budget, remarks: str = "") -> CsvTable:
    """Return the table of a text: the names of its columns in small letters, and its rows.

    Parameters
    ----------
    budget : spent for each row.
    remarks : the beginning of lines that are remarks; if empty, no lines are.

    Raises
    ------
    InputError
        For a text without names, and names given twice; see :meth:`CsvTable.iterate_rows`.

    Examples
    --------
    >>> from workhold.files.budget import UNLIMITED
    >>> table = read_table("a; b\\r1;\\"x; y\\"\\r\\r2\\r", Budget(UNLIMITED))
    >>> table.names, [row.cells for row in table.iterate_rows()]
    (('a', 'b'), [{'a': '1', 'b': 'x; y'}, {'a': '2'}])
    """
    text = LINE_END.sub("\n", text)
    remark = re.compile(rf"[ \t]*{re.escape(remarks)}[^\n]*\n?") if remarks else None
    first = SEPARATOR.match(text)
    table = CsvTable(text, ",", remark, budget, *((0, 1) if first is None else (first.end(), 2)))
    table.mark = first[1] if first and first[1] in MARKS else find_separator(table)
    _, cells = table.read_next_row() or (0, [])
    names = [name.lower() for name in cells]
    while names and not names[-1]:
        names.pop()
    if not names:
        raise InputError("it is empty: write the names of the columns in its first line.")
    twice = next((name for k, name in enumerate(names) if name and name in names[:k]), None)
    if twice is not None:
        raise InputError(f"two columns have the name '{twice[:40]}': leave one of them out.")
    table.names = tuple(names)
    return table


def find_separator(table: CsvTable) -> str:
    """Return the separator of cells: comma, semicolon or tab, whichever is most frequent in the line with the
    names.
    """
    at = table.at
    while (found := BLANK.match(table.text, at)) or (
        table.remark and (found := table.remark.match(table.text, at))
    ):
        at = found.end()
    head = table.text[at : at + LONGEST_HEAD].partition("\n")[0]
    outside = "".join(head.split('"')[::2])
    return max(MARKS, key=outside.count)
