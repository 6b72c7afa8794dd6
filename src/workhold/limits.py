"""Conversion of numbers from outside, and upper limits for them.

A number of a few bytes must not ask for all memory, or for arithmetic that says nothing. The limits hold
alike for files, Python and the page. Limits of a file or a request in bytes, segments and seconds stand where
these are read (``files.part.loaded``, ``web.guard``).
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from math import ceil, inf, nan, sqrt
from typing import TYPE_CHECKING, Any

from workhold.errors import InputError, quote_value

if TYPE_CHECKING:
    import numpy as np
    from attrs import Attribute
    from numpy.typing import NDArray

__all__ = [
    "MOST_BLOCKED",
    "MOST_COMPARED",
    "MOST_FORCE",
    "MOST_FRICTION",
    "MOST_HOLES",
    "MOST_LENGTHS",
    "MOST_LENGTH",
    "MOST_PEG_PAIRS",
    "MOST_RADIUS",
    "MOST_STEPS",
    "MOST_WAYS",
    "check_count",
    "read_number",
    "convert_real",
    "make_real_array",
    "refuse_little_space",
    "refuse_long",
    "refuse_many_steps",
    "refuse_long_search",
    "refuse_strong",
    "choose_thread_count",
    "name_fields_in_errors",
]


def convert_real(value: Any, name: str = "a number") -> float:
    """Return a number as a float; inf or -inf for a whole number too large for a float.

    Anything with ``__float__`` and no dimensions counts as a number, also NumPy scalars, NaN and inf. These
    are not numbers: text (also of digits), bytes, bool, None, and arrays that have a dimension.

    Parameters
    ----------
    name : name of the value, for the beginning of the error message.

    Raises
    ------
    InputError
        For what is not a number.

    Examples
    --------
    >>> convert_real(3), convert_real(-(10**400))
    (3.0, -inf)
    >>> convert_real("12", "the force")
    Traceback (most recent call last):
        ...
    workhold.errors.InputError: the force cannot be '12': give a number.
    """
    if isinstance(value, int | float) and not isinstance(value, bool):
        try:
            return float(value)
        except OverflowError:
            return inf if value > 0 else -inf
    is_one = not isinstance(value, str | bytes | bool) and getattr(value, "ndim", 0) == 0
    try:
        number = float(value) if is_one else None
    except (TypeError, ValueError):
        number = None
    if number is None:
        raise InputError(f"{name} cannot be {quote_value(value)}: give a number.")
    return number


def name_fields_in_errors(cls: type, fields: list[Attribute[Any]]) -> list[Attribute[Any]]:
    """Return the fields of an attrs class, changed so that errors of :func:`convert_real` name the field.

    For the argument ``field_transformer`` of ``attrs.define``. Fields with another converter stay as they
    are.
    """
    numbers: Any = convert_real
    return [
        one.evolve(converter=partial(convert_real, name=one.name.replace("_", " ")))
        if one.converter is numbers
        else one
        for one in fields
    ]


def read_number(text: Any) -> float:
    """Return the float that a number, or text written as Python writes numbers, stands for.

    NaN for anything else; inf or -inf for a whole number too large for a float.

    >>> read_number("12.5"), read_number("three")
    (12.5, nan)
    """
    try:
        return float(text)
    except OverflowError:
        return inf if text > 0 else -inf
    except (TypeError, ValueError):
        return nan


def make_real_array(values: Any, name: str) -> NDArray[np.float64]:
    """Return a float64 copy of an array or of nested sequences of numbers.

    Parameters
    ----------
    name : name of a value, for the beginning of an error message.

    Raises
    ------
    InputError
        For text and other elements that :func:`convert_real` refuses.
    TypeError
        For a single value.
    ValueError, OverflowError
        For rows of unlike lengths, and for whole numbers too large for a float.
    """
    import numpy as np

    array = np.array(values)
    if array.ndim == 0:
        raise TypeError("one value is not an array of numbers")
    if array.dtype.kind not in "iuf":
        for value in np.array(values, dtype=object).flat:
            convert_real(value, name)
    return np.array(values, dtype=np.float64)


def check_count(name: str, value: Any) -> int | None:
    """Return a whole number of at least 1 as an int, or None for None.

    Parameters
    ----------
    name : name of what is counted, for the beginning of the error message.

    Raises
    ------
    InputError
        For any other value.
    """
    if value is None:
        return None
    try:
        if value == int(value) and value >= 1:
            return int(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(f"{name} {quote_value(value)} is not a positive whole number: give 1 or more.")


# Coordinates and lengths in mm: a double of this size is known to 1e-10 mm, a tenth of the width of a rule's
# edge.
MOST_LENGTH = 1e6
# Radii in mm: the centre of such an arc, and so each point reckoned from it, is known to no better than
# points that touch.
MOST_RADIUS = 1e9
# Forces in N and moments in N mm: more than any machine has, and far from where products of them are no
# numbers.
MOST_FORCE = 1e9
# Coefficients of friction.
MOST_FRICTION = 100.0
# Pairs of segments of one part that come near each other, as bounding boxes go, and are compared: some 10 s.
# Ordinary outlines have a few for each segment.
MOST_COMPARED = 1_000_000
# Holes of one carrier, rows without end counted once: what is drawn, and looked through for pairs of free
# holes.
MOST_HOLES = 25_000
# Holes and columns that are blocked, which every fixture is held against.
MOST_BLOCKED = 20_000
# Parallels, each of which makes one set-up for every side of the part and every stop.
MOST_LENGTHS = 40
# Lattice steps between two pegs of one carrier, and these times the features: from each feature a step
# reaches some ten, and each chord takes some 200 bytes. The largest search measured (100 faces, 40 columns)
# has 650,000, and takes under 1 GiB.
MOST_STEPS = 250_000
MOST_CHORDS = 5_000_000
# Ways in which two pairs of contacts go together, of which one in six to one in fifty is a contact of three
# locators and a clamp: to list all fixtures of so many takes some minutes, and gigabytes.
MOST_WAYS = 1e8
# Peg pairs of the paper's algebra, each with 360 sectors of orientation for each piece of a feature: some
# 6,000 bytes.
MOST_PEG_PAIRS = 500_000
# Threads of one search.
MOST_THREADS = 1_000
# Bytes of address space that each takes, with its stack.
THREAD_SPACE = 8 << 20


def refuse_little_space(needed: int, what: str, remedy: str) -> None:
    """Raise InputError when this process is limited to less address space than some work needs.

    Otherwise libraries would end the process without a message. Without a limit, or where the system has
    none, nothing is refused.

    Parameters
    ----------
    needed : bytes.
    what : the work, for the beginning of the error message.
    remedy : advice on what to do instead, for the end of the error message.

    Raises
    ------
    InputError
        With the limit, what the work takes and the remedy.
    """
    try:
        import resource
    except ImportError:
        return
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    if limit != resource.RLIM_INFINITY and limit < needed:
        # Rounded up, so that a limit of just so much is enough.
        raise InputError(
            f"{what} takes {ceil(needed / 1e6):,} MB of address space, and this process is limited to "
            f"{limit / 1e6:,.0f} MB (ulimit -v): {remedy}."
        )


def refuse_long(name: str, value: float) -> None:
    """Raise InputError when a length in mm is greater in absolute value than ``MOST_LENGTH``; NaN passes."""
    if abs(value) > MOST_LENGTH:
        raise InputError(f"{name} {value:g} is beyond {MOST_LENGTH:g} mm: check the number and its unit.")


def refuse_strong(name: str, value: float, unit: str = "N") -> None:
    """Raise InputError when a force in N or a moment in N·mm is greater in
    absolute value than ``MOST_FORCE``; NaN passes.

    ``unit`` is only shown in the message; the value is not converted.
    """
    if abs(value) > MOST_FORCE:
        raise InputError(f"{name} {value:g} is beyond {MOST_FORCE:g} {unit}: check the number and its unit.")


def refuse_many_steps(
    pitch: tuple[float, float], columns: int | None, rows: int | None, diameter: float, features: int
) -> None:
    """Raise InputError when a pair of pegs can stand on a lattice in too many ways.

    The ways are counted as lattice steps from one peg to the other, at most ``diameter`` in each axis. The
    limit is ``MOST_STEPS`` or, if that is less, ``MOST_CHORDS`` divided by the number of features.

    Parameters
    ----------
    pitch, columns, rows : pitch in mm (x, y) and size of the lattice, see ``fixels.toolkit.Carrier``; None
        for an unbounded number of columns or rows.
    diameter : largest distance in mm between two pegs that touch the part.
    features : number of features they can touch, 1 or more.

    Raises
    ------
    InputError
        With the number and its limit.
    """
    across, along = (
        diameter / apart // 1 if count is None else min(count - 1.0, diameter / apart // 1)
        for apart, count in zip(pitch, (columns, rows), strict=True)
    )
    steps = (2.0 * across + 1.0) * (2.0 * along + 1.0)
    most = min(MOST_STEPS, MOST_CHORDS // features)
    if steps > most:
        raise InputError(
            f"two pegs {diameter:.6g} mm apart or less, on a pitch of {pitch[0]:g} x {pitch[1]:g} mm, can "
            f"stand in {steps:.3g} ways, more than the {most:,} this program takes for a part of {features} "
            "faces: use a larger pitch, or fewer columns and rows."
        )


def choose_thread_count(threads: int | None) -> int:
    """Return ``threads``, or for None the number of processors that this process may use.

    Raises
    ------
    InputError
        For more than ``MOST_THREADS``, or more than the process's address space has room for.
    """
    if threads is not None:
        if threads > MOST_THREADS:
            raise InputError(
                f"{threads:,} threads are more than the {MOST_THREADS:,} this program starts: leave them out."
            )
        refuse_little_space(threads * THREAD_SPACE, f"a search in {threads:,} threads", "ask for fewer")
        return threads
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def refuse_long_search(
    ways: float, extent: tuple[float, float], pitch: tuple[float, float], ways_at: Callable[[float], float]
) -> None:
    """Raise InputError when a search for two clamps on a lattice would take hours and too much memory.

    Parameters
    ----------
    ways : number of ways to combine two pairs of contacts; above ``MOST_WAYS`` the error is raised.
    extent : width and height of the part in mm.
    pitch : pitch of the lattice in mm, along x and y.
    ways_at : function that returns ``ways`` for another pitch in mm, the same along x and y.

    Raises
    ------
    InputError
        With a pitch for which the ways are few enough.
    """
    if ways > MOST_WAYS:
        enough, left = sqrt(pitch[0] * pitch[1]), ways
        while left > MOST_WAYS:
            # As many holes less lie along the part as the pitch is larger, and four contacts stand in them.
            enough = max(ceil(enough * (left / MOST_WAYS) ** 0.25 / 5) * 5, enough // 5 * 5 + 5)
            left = ways_at(enough)
        raise InputError(
            f"the part is {extent[0]:.6g} x {extent[1]:.6g} mm large, too large for two clamps on holes "
            f"{pitch[0]:g} x {pitch[1]:g} mm apart, which leave {ways:.1g} ways to look at: use a pitch of "
            f"{enough:g} mm or more, fewer columns and rows, a small range of angles, or ask for the best alone, "
            "in the usual order."
        )
