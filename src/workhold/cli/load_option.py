"""``--load "force=200 at=10,5 direction=30..60"``: a load typed by a user."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.model.load import Load

__all__ = ["LOAD_HELP", "parse_load"]

LOAD_HELP = (
    "A load on the part, such as 'force=200 at=10,5 direction=30..60', in N, degrees and part coordinates; "
    "path=X,Y;X,Y for a cutter's path, any direction if none is given, moment=5000 in N mm. May be repeated."
)


def parse_load(text: str, unit_scale: float = 1.0) -> Load:
    """A load from the text of ``--load``.

    Parameters
    ----------
    text : words key=value, see ``files.loads_file``; a value with spaces stands in quotes.
    unit_scale : millimetres in one unit of length.

    Raises
    ------
    InputError
        When it cannot be used.

    Examples
    --------
    >>> parse_load("force=150 path=0,0;40,0;40,20").points
    ((0.0, 0.0), (40.0, 0.0), (40.0, 20.0))
    """
    place = f'--load "{text}"'
    from workhold.files.loads_file import load_from_words

    try:
        words = shlex.split(text)
    except ValueError:
        raise InputError(f"{place} has a quote that is not closed: close it.") from None
    values: dict[str, str] = {}
    for word in words:
        key, equals, value = word.partition("=")
        if not equals:
            raise InputError(
                f"{place} cannot be used at '{word}': give words like force=200 at=10,5 direction=30..60, without spaces "
                "inside a value."
            )
        if key in values:
            raise InputError(f"{place} has {key} twice: give it once, and another --load for another load.")
        values[key] = value
    return load_from_words(values, place, unit_scale)
