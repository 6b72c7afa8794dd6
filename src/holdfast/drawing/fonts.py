"""The bundled typeface: where its files are and how wide its text runs."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

__all__ = ["FAMILY", "font_files", "shortened", "text_width"]

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
