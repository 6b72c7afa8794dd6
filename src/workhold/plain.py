"""Text of others, such as the name of a part or a layer, made fit to be shown."""

from __future__ import annotations

__all__ = ["plain", "shortened"]

# Letters of a sentence: enough for any of the program's own.
LONGEST = 1000
CUT = " ... "


def plain(text: str) -> str:
    """Text without what could steer a terminal, turn the direction of writing or break a line or a file's string.

    Examples
    --------
    >>> plain("a\\x1b]0;b\\u202ec\\td")
    'a?]0;b?c d'
    """
    return "".join(letter if letter.isprintable() else " " if letter.isspace() else "?" for letter in text)


def shortened(text: str, most: int = LONGEST) -> str:
    """Text of at most so many letters, its middle left out.

    Examples
    --------
    >>> shortened("a" * 30, 15)
    'aaaaa ... aaaaa'
    """
    if len(text) <= most:
        return text
    half = (most - len(CUT)) // 2
    return text[: most - len(CUT) - half] + CUT + text[len(text) - half :]
