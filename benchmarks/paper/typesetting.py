"""Words set in lines for the PDF: pieces with their widths, broken at spaces, each number with its link.

Lengths are page units of ``workhold.drawing.scene``, a quarter of a millimetre; y runs down the page.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Literal

from attrs import evolve, field, frozen

from paper.document import Inline, Marked, Number, typographic
from workhold.drawing.scene import has_character, measure_text

__all__ = ["Piece", "Word", "broken", "natural_width", "words_of"]

# Between two words, in ems.
SPACE = 0.3
# What is printed for a character that the typeface lacks.
UNKNOWN = "?"
# Long words, such as paths, are broken behind one of these.
JOINTS = re.compile(r"(?<=[/_=.,-])(?=.)")
QUOTES = "“", "”"


@frozen
class Piece:
    """Letters in one look.

    Parameters
    ----------
    link : where a click leads, empty for nowhere.
    """

    text: str
    bold: bool = False
    code: bool = False
    link: str = ""

    def width(self, size: float) -> float:
        """How wide it is in a font size."""
        return measure_text(self.text, size, self.bold)


@frozen
class Word:
    """Pieces that are not parted at the end of a line."""

    pieces: tuple[Piece, ...] = field(converter=tuple)

    def width(self, size: float) -> float:
        """How wide it is in a font size."""
        return sum(piece.width(size) for piece in self.pieces)


def piece_of(one: Inline) -> Piece:
    """The look of a piece of a line."""
    if isinstance(one, Number):
        section, _, path = one.key.partition("/")
        return Piece(one.text, link=f"data/{section}.json#{path}")
    if isinstance(one, Marked):
        text = one.text.join(QUOTES) if one.kind == "quote" else one.text
        text = text if one.kind == "code" else typographic(text)
        return Piece(text, bold=one.kind == "label", code=one.kind == "code")
    return Piece(typographic(one))


def words_of(line: Sequence[Inline], bold: bool = False) -> list[Word]:
    """The words of a line; a number stays in one piece, whatever spaces it has."""
    words: list[list[Piece]] = [[]]
    for one in line:
        piece = piece_of(one)
        piece = evolve(
            piece,
            text="".join(c if has_character(c) else UNKNOWN for c in piece.text),
            bold=piece.bold or bold,
        )
        if piece.link:
            words[-1].append(piece)
            continue
        for number, text in enumerate(piece.text.split(" ")):
            if number:
                words.append([])
            if text:
                words[-1].append(evolve(piece, text=text))
    return [Word(pieces) for pieces in words if pieces]


def broken(
    words: Sequence[Word], size: float, width: float, breaking: Literal["words", "never"] = "words"
) -> list[list[Word]]:
    """Words in lines no wider than a width; what is longer by itself is broken at a joint, but no number is."""
    lines: list[list[Word]] = [[]]
    room = width
    for word in split_long(words, size, width) if breaking == "words" else words:
        needed = word.width(size) + (SPACE * size if lines[-1] else 0.0)
        if lines[-1] and needed > room + 1e-6:
            lines.append([])
            room, needed = width, word.width(size)
        lines[-1].append(word)
        room -= needed
    return lines


def split_long(words: Sequence[Word], size: float, width: float) -> list[Word]:
    """Words with those that are wider than a line parted at their joints."""
    out: list[Word] = []
    for word in words:
        if word.width(size) <= width or any(piece.link for piece in word.pieces):
            out.append(word)
            continue
        parts = [
            evolve(piece, text=text) for piece in word.pieces for text in JOINTS.split(piece.text) if text
        ]
        line: list[Piece] = []
        for part in parts:
            if line and Word([*line, part]).width(size) > width:
                out.append(Word(line))
                line = []
            line.append(part)
        out.append(Word(line))
    return out


def natural_width(words: Sequence[Word], size: float) -> float:
    """How wide words are in one line."""
    return sum(word.width(size) for word in words) + SPACE * size * max(len(words) - 1, 0)
