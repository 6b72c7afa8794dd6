"""The report as a PDF of A4 pages: a column of text, tables with rules, pictures as vectors.

Every number carries a link to its place in the data file, so that a program finds it on the page as a reader does.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from datetime import UTC, date, datetime, time

from attrs import define, field
from fpdf import FPDF

from paper.document import Block, Heading, Line, Listing, Marked, Paragraph, Picture, Table, typographic
from paper.typesetting import SPACE, Word, broken, natural_width, words_of
from workhold.drawing.pdf import FONT, POINTS_PER_UNIT, draw_children
from workhold.drawing.scene import BLACK, GREY, PORTRAIT, list_font_files, measure_text

__all__ = ["pdf_pages"]

WIDTH, HEIGHT = PORTRAIT
LEFT, RIGHT, TOP, BOTTOM = 92.0, 748.0, 88.0, 1090.0
COLUMN = RIGHT - LEFT
TITLE, HEADINGS, BODY, SMALL, TABLE, LEAST_TABLE = 25.0, (17.5, 14.2), 12.6, 11.0, 11.0, 8.2
LEADING = 1.42
# Between blocks, and between the columns of a table.
GAP, GUTTER = 9.0, 9.0
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
COMMAND = re.compile(r"([A-Za-z])([^A-Za-z]*)")
LENGTHS = ("width", "height", "r", "rx", "font-size", "stroke-width")


def pdf_pages(title: str, blocks: Sequence[Block], created: date) -> bytes:
    """The PDF; its bytes depend on title, blocks and date alone."""
    pages = Pages.begin(title, created)
    for place, block in enumerate(blocks):
        following = blocks[place + 1] if place + 1 < len(blocks) else None
        match block:
            case Heading():
                pages.heading(block, following)
            case Paragraph():
                pages.paragraph(block.line)
            case Listing():
                pages.listing(block)
            case Table():
                pages.table(block)
            case Picture():
                pages.picture(block)
    return pages.finished()


@define(eq=False)
class Pages:
    """Pages that grow downward.

    Parameters
    ----------
    y : where the next line begins.
    """

    pdf: FPDF
    title: str
    y: float = field(default=TOP)

    @classmethod
    def begin(cls, title: str, created: date) -> Pages:
        """The first page, with the title."""
        pdf = FPDF(unit=POINTS_PER_UNIT)
        pdf.set_margin(0.0)
        pdf.set_auto_page_break(False)
        pdf.set_creation_date(datetime.combine(created, time(), UTC))
        pdf.set_producer("workhold")
        pdf.set_title(title)
        pdf.set_lang("en")
        for weight, path in zip(("", "B"), list_font_files(), strict=True):
            pdf.add_font(FONT, weight, path)
        pages = cls(pdf, title)
        pages.turn()
        for words in broken(words_of((title,), bold=True), TITLE, 0.86 * COLUMN):
            middle = (LEFT + RIGHT - natural_width(words, TITLE)) / 2
            pages.write(words, middle, pages.y + TITLE, TITLE)
            pages.y += 1.25 * TITLE
        pages.y += 10.0
        return pages

    def turn(self) -> None:
        """Begin a page."""
        self.pdf.add_page(format=(WIDTH, HEIGHT))
        self.y = TOP
        # The first page has the title.
        number = self.pdf.page_no()
        if number > 1:
            self.plain(typographic(self.title), LEFT, 60.0, SMALL, GREY)
            self.plain(str(number), RIGHT - measure_text(str(number), SMALL), 60.0, SMALL, GREY)

    def need(self, height: float) -> None:
        """Begin a page unless so much is free on this one."""
        if self.y + height > BOTTOM and self.y > TOP:
            self.turn()

    def finished(self) -> bytes:
        """The bytes of all pages."""
        return bytes(self.pdf.output())

    def plain(self, text: str, x: float, y: float, size: float, colour: str) -> None:
        """Write words without a link."""
        self.pdf.set_font(FONT, "", size * POINTS_PER_UNIT)
        self.pdf.set_text_color(colour)
        self.pdf.text(x, y, text)

    def write(
        self, words: Sequence[Word], x: float, y: float, size: float, extra: float = 0.0, colour: str = BLACK
    ) -> None:
        """Write words on a baseline, with so much more than a space between them."""
        for word in words:
            for piece in word.pieces:
                self.pdf.set_font(FONT, "B" if piece.bold else "", size * POINTS_PER_UNIT)
                self.pdf.set_text_color("#3d4a5c" if piece.code and colour == BLACK else colour)
                self.pdf.text(x, y, piece.text)
                width = piece.width(size)
                if piece.link:
                    self.pdf.link(x, y - 0.8 * size, width, size, piece.link)
                x += width
            x += SPACE * size + extra

    def lines(
        self, line: Line, size: float, left: float = LEFT, right: float = RIGHT, colour: str = BLACK
    ) -> None:
        """Write words in justified lines, page after page."""
        rows = broken(words_of(line), size, right - left)
        for number, words in enumerate(rows):
            # No first or last line stands alone on a page.
            alone = number == 0 or number == len(rows) - 2
            self.need(LEADING * size * (2.0 if alone and len(rows) > 1 else 1.0))
            self.y += LEADING * size
            spare = right - left - natural_width(words, size)
            # Lines that are far from full stay ragged.
            is_full = number < len(rows) - 1 and len(words) > 1 and spare < 0.12 * (right - left)
            self.write(words, left, self.y, size, spare / (len(words) - 1) if is_full else 0.0, colour)

    def heading(self, block: Heading, following: Block | None) -> None:
        """Write a heading; it stays with what follows."""
        size = HEADINGS[block.depth - 1]
        height = 2.0 * size + 4 * LEADING * BODY
        if isinstance(following, (Table, Picture)):
            height = 2.0 * size + min(self.height_of(following), BOTTOM - TOP - 2.0 * size)
        self.need(height)
        self.y += 0.0 if self.y == TOP else 1.1 * size
        self.write(words_of((block.text,), bold=True), LEFT, self.y + size, size)
        self.y += 1.35 * size

    def paragraph(self, line: Line) -> None:
        """Write sentences."""
        self.lines(line, BODY)
        self.y += GAP

    def listing(self, block: Listing) -> None:
        """Write points, or numbered references."""
        size = SMALL if block.kind == "references" else BODY
        for number, point in enumerate(block.points, 1):
            self.need(2.0 * LEADING * size)
            sign = f"[{number}]" if block.kind == "references" else "•"
            self.plain(sign, LEFT, self.y + LEADING * size, size, BLACK)
            self.lines(point, size, LEFT + (30.0 if block.kind == "references" else 16.0))
            self.y += 0.3 * GAP
        self.y += 0.7 * GAP

    def caption(self, label: str, line: Line) -> None:
        """Write what a table or a picture shows."""
        self.lines((Marked("label", f"{label}."), " ", *line), SMALL, colour=GREY)

    def caption_height(self, block: Table | Picture) -> float:
        """How high a caption is."""
        words = words_of((Marked("label", f"{block.label}."), " ", *block.caption))
        return LEADING * SMALL * len(broken(words, SMALL, COLUMN))

    def height_of(self, block: Table | Picture) -> float:
        """How high a table or a row of pictures is."""
        if isinstance(block, Table):
            layout = TableLayout.of(block)
            rows = sum(layout.height(row) for row in [block.headings, *block.rows])
            return self.caption_height(block) + rows + (6 if block.groups else 4) * GAP
        return sum(map(self.row_height, rows_of_pictures(block))) + self.caption_height(block) + 3 * GAP

    def table(self, block: Table) -> None:
        """Write a table; where it does not fit, its headings stand on each page."""
        layout = TableLayout.of(block)
        self.need(min(self.height_of(block), 0.5 * (BOTTOM - TOP)))
        self.y += 0.5 * GAP
        self.caption(block.label, block.caption)
        self.y += 0.6 * GAP
        self.headings(block, layout)
        for number, row in enumerate(block.rows):
            if self.y + layout.height(row) > BOTTOM:
                self.rule(1.4)
                self.turn()
                self.headings(block, layout)
            if block.bold_last and number == len(block.rows) - 1:
                self.rule(0.5)
            self.row(layout, row)
        self.rule(1.4)
        self.y += 1.8 * GAP

    def headings(self, block: Table, layout: TableLayout) -> None:
        """Write the headings of a table between two rules."""
        self.rule(1.4)
        if block.groups:
            self.groups(block, layout)
        self.row(layout, block.headings, bold=True)
        self.rule(0.8)

    def groups(self, block: Table, layout: TableLayout) -> None:
        """Write what columns have in common, with a rule below each."""
        size, x, first = layout.size, LEFT, 0
        self.y += 1.35 * size
        for words, span in block.groups:
            width = sum(layout.widths[first : first + span]) + layout.gutter * (span - 1)
            if words:
                middle = x + (width - measure_text(words, size, bold=True)) / 2
                self.write(words_of((words,), bold=True), middle, self.y, size)
                self.pdf.set_line_width(0.5)
                self.pdf.set_draw_color(BLACK)
                self.pdf.line(x, self.y + 3.5, x + width, self.y + 3.5)
            x += width + layout.gutter
            first += span
        self.y += 3.0

    def rule(self, width: float) -> None:
        """Draw a line across the column."""
        self.pdf.set_draw_color(BLACK)
        self.pdf.set_line_width(width)
        self.pdf.line(LEFT, self.y + 2.0, RIGHT, self.y + 2.0)
        self.y += 2.0

    def row(self, layout: TableLayout, row: Sequence[Line], bold: bool = False) -> None:
        """Write a row; headings of several lines end on one baseline, other cells begin on one."""
        size, x = layout.size, LEFT
        most = layout.line_count(row, bold)
        for number, (cell, width) in enumerate(zip(row, layout.widths, strict=True)):
            lines = layout.lines(cell, number, bold)
            first = most - len(lines) if bold else 0
            for place, words in enumerate(lines, first):
                spare = width - natural_width(words, size) if number not in layout.left else 0.0
                self.write(words, x + spare, self.y + 1.3 * size * (place + 1), size)
            x += width + layout.gutter
        self.y += layout.height(row, bold)

    def row_height(self, parts: Sequence[tuple[str, str]]) -> float:
        """How high a row of pictures is, with the words below."""
        return max(picture_height(svg, self.part_width) for svg, _ in parts) + LEADING * SMALL + GAP

    part_width: float = field(default=COLUMN, init=False)

    def picture(self, block: Picture) -> None:
        """Draw pictures side by side."""
        self.part_width = (COLUMN - GUTTER * (block.across - 1)) / block.across
        rows = rows_of_pictures(block)
        self.need(min(self.height_of(block), BOTTOM - TOP))
        for parts in rows:
            self.need(self.row_height(parts))
            height = self.row_height(parts)
            for number, (svg, words) in enumerate(parts):
                x = LEFT + number * (self.part_width + GUTTER)
                draw_children(self.pdf, placed(svg, x, self.y, self.part_width))
                middle = x + (self.part_width - measure_text(words, SMALL)) / 2
                self.plain(words, middle, self.y + height - GAP - 3.0, SMALL, GREY)
            self.y += height
        self.caption(block.label, block.caption)
        self.y += 1.8 * GAP


def rows_of_pictures(block: Picture) -> list[tuple[tuple[str, str], ...]]:
    """The pictures of each row."""
    return [block.parts[k : k + block.across] for k in range(0, len(block.parts), block.across)]


@define(eq=False)
class TableLayout:
    """How a table is set.

    Parameters
    ----------
    size : of its letters.
    widths : of its columns.
    left : the columns that stand on the left.
    gutter : between two columns.
    """

    size: float
    widths: list[float]
    left: tuple[int, ...]
    gutter: float

    @classmethod
    def of(cls, table: Table) -> TableLayout:
        """As large as it fits: letters become smaller first, then words of the widest are broken."""
        size = TABLE
        while True:
            widths = [
                max(
                    *(natural_width(words_of(row[k]), size) for row in table.rows or [table.headings]),
                    max((w.width(size) for w in words_of(table.headings[k], bold=True)), default=0.0),
                )
                for k in range(len(table.headings))
            ]
            spare = COLUMN - sum(widths) - GUTTER * (len(widths) - 1)
            if spare >= 0.0 or size <= LEAST_TABLE:
                break
            size -= 0.2
        if spare < 0.0:
            widest = max(table.left or range(len(widths)), key=widths.__getitem__)
            widths[widest] += spare
            spare = 0.0
        return cls(size, widths, table.left, GUTTER + spare / max(len(widths) - 1, 1))

    def lines(self, cell: Line, number: int, bold: bool) -> list[list[Word]]:
        """The lines of a cell; numbers stay in one."""
        words = words_of(cell, bold)
        return broken(words, self.size, self.widths[number] + 1e-6) if words else []

    def line_count(self, row: Sequence[Line], bold: bool = False) -> int:
        """How many lines a row takes."""
        return max([1, *(len(self.lines(cell, k, bold)) for k, cell in enumerate(row))])

    def height(self, row: Sequence[Line], bold: bool = False) -> float:
        """How high a row is."""
        return 1.3 * self.size * self.line_count(row, bold) + 0.35 * self.size


def picture_height(svg: str, width: float) -> float:
    """How high a picture of a width is."""
    _, _, across, up = view_box(ET.fromstring(svg.encode("utf-8")))
    return width * up / across


def view_box(root: ET.Element) -> list[float]:
    """The numbers of the view box."""
    return [float(word) for word in root.attrib["viewBox"].split()]


def placed(svg: str, x: float, y: float, width: float) -> ET.Element:
    """A picture moved to a place on the page and made as wide as its room; its title is left out."""
    root = ET.fromstring(svg.encode("utf-8"))
    scale = width / view_box(root)[2]
    for title in root.findall("{*}title"):
        root.remove(title)
    for element in root.iter():
        if element.tag.rpartition("}")[2] == "rect":
            # A rectangle may leave out where it begins.
            element.attrib.setdefault("x", "0")
            element.attrib.setdefault("y", "0")
        move(element.attrib, x, y, scale)
    return root


def move(attributes: dict[str, str], x: float, y: float, scale: float) -> None:
    """Scale and move the numbers of an element's attributes."""
    for name, shift in (("x", x), ("y", y), ("cx", x), ("cy", y)):
        if name in attributes:
            attributes[name] = f"{float(attributes[name]) * scale + shift:.4f}"
    for name in LENGTHS:
        if name in attributes and NUMBER.fullmatch(attributes[name]):
            attributes[name] = f"{float(attributes[name]) * scale:.4f}"
    if "stroke-dasharray" in attributes:
        dashes = attributes["stroke-dasharray"].split()
        attributes["stroke-dasharray"] = " ".join(f"{float(one) * scale:.4f}" for one in dashes)
    if "transform" in attributes:
        turn, cx, cy = (float(one) for one in NUMBER.findall(attributes["transform"]))
        attributes["transform"] = f"rotate({turn} {cx * scale + x:.4f} {cy * scale + y:.4f})"
    if "d" in attributes:
        attributes["d"] = "".join(
            letter + moved_points(letter, [float(one) for one in NUMBER.findall(numbers)], x, y, scale)
            for letter, numbers in COMMAND.findall(attributes["d"])
        )


def moved_points(letter: str, values: list[float], x: float, y: float, scale: float) -> str:
    """The numbers of a path's command, moved: M, L and A have one place each, at their end."""
    if not values:
        return ""
    head = [values[0] * scale, values[1] * scale, *values[2:5]] if letter == "A" else []
    end_x, end_y = values[-2:]
    return " ".join(f"{one:.4f}" for one in [*head, end_x * scale + x, end_y * scale + y])
