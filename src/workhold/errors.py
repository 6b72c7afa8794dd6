"""The errors that workhold raises on purpose, and the preparation of text for messages.

Every message is one plain sentence that names the place and the remedy, because the command line prints it as
it is. What it quotes, such as names of parts and layers from files, is made fit for a terminal.
"""

from __future__ import annotations

import errno
import re
from collections.abc import Iterator, Sequence

__all__ = [
    "NO_ROOM",
    "InputError",
    "WorkholdError",
    "list_causes",
    "make_encodable",
    "lacks_memory",
    "join_words",
    "make_printable",
    "quote_value",
    "refuse_kind",
    "shorten_middle",
]

# Letters of a sentence: enough for any of the program's own.
LONGEST = 1000
# Letters of a value that is shown in one.
LONGEST_VALUE = 100
CUT = " ... "


def make_printable(text: str) -> str:
    """Return the text with each whitespace character replaced
    by a space, and each other unprintable one by "?".

    Escape sequences, changes of writing direction and line breaks thus do not reach a terminal.

    Examples
    --------
    >>> make_printable("a\\x1b]0;b\\u202ec\\td")
    'a?]0;b?c d'
    """
    if text.isprintable():
        return text
    return "".join(letter if letter.isprintable() else " " if letter.isspace() else "?" for letter in text)


# What Python makes of bytes in a file's name that are not UTF-8, and other halves of letters.
HALVES = re.compile("[\ud800-\udfff]")
FIRST_BYTE = 0xDC00


def make_encodable(text: str) -> str:
    """Return the text with lone surrogates, which UTF-8 cannot hold, replaced by visible escapes.

    Python has such surrogates for bytes of a file's name that are not UTF-8; these become ``\\xfc`` and the
    like, all others ``\\ufffd``.

    Examples
    --------
    >>> print(make_encodable("Fl\\udcfcgel"))
    Fl\\xfcgel
    """
    if text.isascii():
        return text
    return HALVES.sub(
        lambda half: (
            f"\\x{ord(half[0]) - FIRST_BYTE:02x}" if 0x80 <= ord(half[0]) - FIRST_BYTE < 0x100 else "\\ufffd"
        ),
        text,
    )


def shorten_middle(text: str, most: int = LONGEST) -> str:
    """Return the text, with its middle replaced by " ... " where it is longer than ``most`` characters.

    Examples
    --------
    >>> shorten_middle("a" * 30, 15)
    'aaaaa ... aaaaa'
    """
    if len(text) <= most:
        return text
    half = (most - len(CUT)) // 2
    return text[: most - len(CUT) - half] + CUT + text[len(text) - half :]


def join_words(words: Sequence[str]) -> str:
    """Return one or more words in one string, joined by commas and a last "and".

    >>> join_words(["a"]), join_words(["a", "b", "c"])
    ('a', 'a, b and c')
    """
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


# A full disk, a used up quota, a limit of the size of files.
NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
# What the system's loader, libraries and threads say where there is no memory for them.
NO_MEMORY = ("failed to map segment", "annot allocate memory", "can't start new thread")


class WorkholdError(Exception):
    """Base of every error workhold raises on purpose."""


class InputError(WorkholdError, ValueError):
    """A file, a flag or a value given by the user cannot be used; the command line exits with code 2.

    The message is cut in its middle to ``LONGEST`` characters, and unprintable characters are replaced.
    """

    def __init__(self, message: str) -> None:
        super().__init__(make_printable(shorten_middle(message)))


def list_causes(error: BaseException | None, *, or_context: bool = False) -> Iterator[BaseException]:
    """Yield an error, then the error that it was raised from (``__cause__``), and so on; each error once.

    Parameters
    ----------
    or_context : whether to follow ``__context__`` (the error that was being handled) where there is no
        ``__cause__``.
    """
    # An error that was raised from itself is its own cause.
    passed: list[BaseException] = []
    while error is not None and not any(error is one for one in passed):
        yield error
        passed.append(error)
        error = error.__cause__ or (error.__context__ if or_context else None)


def lacks_memory(error: BaseException | None) -> bool:
    """Return whether an error, or one of its causes, says that memory was lacking.

    That is so for a MemoryError, for the error number ENOMEM, and for a message with one of the texts in
    ``NO_MEMORY``.
    """
    return any(
        isinstance(one, MemoryError)
        or getattr(one, "errno", None) == errno.ENOMEM
        or any(words in str(one) for words in NO_MEMORY)
        for one in list_causes(error, or_context=True)
    )


def quote_value(value: object) -> str:
    """Return a value as shown in a message: numbers as written, all else as its ``repr``.

    Texts longer than ``LONGEST_VALUE`` characters are shortened to that length in the middle.

    >>> quote_value("12"), quote_value(2.5)
    ("'12'", '2.5')
    """
    plainly = isinstance(value, int | float) or type(value).__module__ == "numpy"
    return shorten_middle(str(value) if plainly else repr(value), LONGEST_VALUE)


def refuse_kind(value: object, kind: type, name: str, remedy: str) -> None:
    """Raise InputError unless a value is an instance of the type ``kind``.

    Parameters
    ----------
    name : name of the value, for the beginning of the error message.
    remedy : advice on what to give instead, for the end of the error message.

    Raises
    ------
    InputError
        When it is not.

    Examples
    --------
    >>> refuse_kind("x", float, "the length", "give a number")
    Traceback (most recent call last):
        ...
    workhold.errors.InputError: the length cannot be 'x': give a number.
    """
    if not isinstance(value, kind):
        raise InputError(f"{name} cannot be {quote_value(value)}: {remedy}.")
