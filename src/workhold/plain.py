"""Text made fit to be shown: names from files, such as those of parts and layers, and lists in sentences."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["listed", "plain", "shortened"]

# Letters of a sentence: enough for any of the program's own.
LONGEST = 1000
CUT = " ... "


def plain(text: str) -> str:
    """Text without letters that steer a terminal, turn the direction of writing, or break a line or string.
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


def listed(words: Sequence[str]) -> str:
    """Words with commas and a last "and".

    >>> listed(["a"]), listed(["a", "b", "c"])
    ('a', 'a, b and c')
    """
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
