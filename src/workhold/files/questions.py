"""Questions that the readers of parts and programs leave to the user, with names that each interface replaces
by its own.

A sentence names a question by its mark, such as ``<axis>``. Where a part is read
(``files.part.load.read_workpiece``) the mark is replaced by the caller's name of the question: an option of
the command line, a field of the page, an argument in Python.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

from workhold.errors import InputError, quote_value

__all__ = [
    "AXIS",
    "DRAWING_UNIT",
    "FIT",
    "HEAD_ROOM",
    "HEIGHTS",
    "JOIN_TOLERANCE",
    "LAYERS",
    "LEAST_BAND",
    "MARK",
    "PART_NUMBER",
    "PEG_HEIGHT",
    "SECTION",
    "START",
    "UNIT",
    "UnitAskedError",
    "is_read_by_height",
    "check_layer_names",
    "read_number_or_name",
    "refuse_axis",
    "refuse_fit",
    "refuse_layers",
    "name_questions",
]

# The unit of a drawing that does not say its own, and the one that counts whatever it says.
UNIT, DRAWING_UNIT = "<unit>", "<drawing_unit>"
PART_NUMBER, LAYERS, JOIN_TOLERANCE, FIT = "<part_number>", "<layers>", "<join_tolerance>", "<fit>"
# How a solid is looked at.
AXIS, SECTION, PEG_HEIGHT, HEAD_ROOM, LEAST_BAND, HEIGHTS = (
    "<axis>",
    "<section>",
    "<peg_height>",
    "<head_room>",
    "<least_band>",
    "<heights>",
)
# Where the tip of a program is at its start.
START = "<start>"
OF_SOLIDS = (AXIS, SECTION, PEG_HEIGHT, HEAD_ROOM, LEAST_BAND)
OTHERS = (UNIT, DRAWING_UNIT, PART_NUMBER, LAYERS, JOIN_TOLERANCE, FIT)
MARK = re.compile("|".join((*OTHERS, *OF_SOLIDS, HEIGHTS, START)))
# The arguments of ``workhold.load``, which knows one unit, and of ``Program.read``.
IN_PYTHON = {"drawing_unit": "unit", "start": "start=(x, y, z)"}


class UnitAskedError(InputError):
    """The error for a drawing whose unit is not known.

    An interface that can ask the user may read the drawing again with the unit.
    """


def name_questions(sentence: str, called: Mapping[str, str] | None) -> str:
    """Return a sentence with marks such as ``<axis>`` replaced by the caller's names of the questions.

    Parameters
    ----------
    called : the caller's names by mark, without its brackets. A question that is not among them has the name
        of Python's argument, as all have if None.

    Examples
    --------
    >>> name_questions(f"choose another with {PART_NUMBER}.", {"part_number": "--part"})
    'choose another with --part.'
    >>> name_questions(f"leave {DRAWING_UNIT} out.", None)
    'leave unit out.'
    """
    names = IN_PYTHON | dict(called or {})
    if not names.get("layers", "").startswith("--"):
        # Only a command takes a question as often as there are answers.
        first, mark, rest = sentence.partition(LAYERS)
        sentence = first + mark + rest.replace(f" {LAYERS} ", ", ")
    return MARK.sub(lambda mark: names.get(mark[0][1:-1], mark[0][1:-1]), sentence)


def read_number_or_name(part: int | str | None) -> int | str | None:
    """Return an int for a part's number written in digits; a name, an int or None is returned unchanged.

    Examples
    --------
    >>> read_number_or_name("2"), read_number_or_name("base plate"), read_number_or_name(None)
    (2, 'base plate', None)
    """
    text = part.strip() if isinstance(part, str) else ""
    return int(text) if text.isascii() and text.isdigit() and len(text) < 10 else part


def check_layer_names(layers: Sequence[str] | str | None) -> Sequence[str] | None:
    """Return the names of layers as a list, also for a single name; None for None.

    Raises InputError for anything else.
    """
    names = [layers] if isinstance(layers, str) else layers
    if names is not None and not (isinstance(names, Iterable) and all(isinstance(one, str) for one in names)):
        raise InputError(f"layers cannot be {quote_value(layers)}: give their names in a list.")
    return names if names is None else list(names)


def refuse_layers(layers: Sequence[str] | None) -> None:
    """Raise InputError unless ``layers`` is None: the file is of a kind without layers."""
    if layers is not None:
        raise InputError(f"layers can be chosen in DXF files only: leave {LAYERS} out.")


def refuse_fit(fit: float | None) -> None:
    """Raise InputError unless ``fit`` is None; for use with built-in parts, and with solids in result files,
    whose outlines are not fitted.
    """
    if fit is not None:
        raise InputError(f"its outline has no chords for arcs: leave {FIT} out.")


def refuse_axis(options: Mapping[str, object]) -> None:
    """Raise InputError if an option for solids, such as an axis or a section, is given; for use with flat
    drawings.
    """
    for question in OF_SOLIDS:
        if options.get(question[1:-1]) is not None:
            raise InputError(f"only a STEP file can be looked at along an axis: leave {question} out.")


def is_read_by_height(options: Mapping[str, object], fit: float | None) -> bool:
    """Return whether the options ask for a solid's outline at the height of the pegs.

    Raises InputError if they ask for a section or a fit besides.
    """
    usual: tuple[object, ...] = (None, {})
    asked = [
        mark for mark in (PEG_HEIGHT, HEAD_ROOM, LEAST_BAND, HEIGHTS) if options.get(mark[1:-1]) not in usual
    ]
    for mark, value in ((SECTION, options.get("section")), (FIT, fit)):
        if asked and value is not None:
            raise InputError(f"an outline by height takes no {mark}: leave {mark} or {asked[0]} out.")
    return bool(asked)
