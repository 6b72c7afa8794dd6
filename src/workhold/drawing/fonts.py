"""The bundled typeface: where its files are and how wide its text runs."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

__all__ = ["FAMILY", "font_files", "has_character", "shortened", "text_width", "wrapped"]

FAMILY = "DejaVu Sans, Verdana, Arial, sans-serif"

FOLDER = Path(__file__).resolve().parent.parent / "data" / "fonts"

# Width in ems given to a character the bundled typeface does not have.
UNKNOWN_WIDTH = 1.0


def font_files() -> list[str]:
    """Paths of the bundled fonts, regular and bold."""
    return [str(FOLDER / "DejaVuSans.ttf"), str(FOLDER / "DejaVuSans-Bold.ttf")]


@cache
def advance_widths() -> dict[str, dict[str, float]]:
    """Width in ems of every bundled character, by weight ("regular", "bold")."""
    widths: dict[str, dict[str, float]] = json.loads((FOLDER / "advance_widths.json").read_text(encoding="ascii"))
    return widths


def text_width(content: str, size: float, bold: bool = False) -> float:
    """Width of a line of text in page units, for a font size in page units.

    >>> text_width("i", 10) < text_width("W", 10) < text_width("W", 10, bold=True)
    True
    """
    widths = advance_widths()["bold" if bold else "regular"]
    return size * sum(widths.get(character, UNKNOWN_WIDTH) for character in content)


def has_character(character: str) -> bool:
    """Whether the bundled typeface has a character.

    >>> has_character("Ø"), has_character("樂")
    (True, False)
    """
    return character in advance_widths()["regular"]


def shortened(content: str, size: float, width: float, bold: bool = False) -> str:
    """The text itself, or its beginning and an ellipsis when it is wider than ``width`` page units.

    >>> shortened("a plate", 10, 200), shortened("a very long plate", 10, 50)
    ('a plate', 'a very l…')
    """
    if text_width(content, size, bold) <= width:
        return content
    while content and text_width(content + "…", size, bold) > width:
        content = content[:-1]
    return content.rstrip() + "…"


def wrapped(content: str, size: float, width: float, bold: bool = False) -> list[str]:
    """The text in lines no wider than ``width`` page units, broken at spaces, or inside words that are too long.

    >>> wrapped("a plate with holes", 10, 50)
    ['a plate', 'with', 'holes']
    """
    lines: list[str] = []
    for word in content.split():
        if lines and text_width(f"{lines[-1]} {word}", size, bold) <= width:
            lines[-1] += f" {word}"
            continue
        while len(word) > 1 and text_width(word, size, bold) > width:
            cut = next(k for k in range(len(word) - 1, 0, -1) if k == 1 or text_width(word[:k], size, bold) <= width)
            lines.append(word[:cut])
            word = word[cut:]
        lines.append(word)
    return lines
