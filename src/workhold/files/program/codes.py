"""The codes of a program: to which group each belongs, why others are refused, and what they leave in force.

A group holds codes of which one is in force, or stands in a block: T. R. Kramer, F. M. Proctor, E. Messina,
"The NIST RS274NGC interpreter, version 3", NISTIR 6556, 2000, "Modal groups". Cycles are a group of their own
here, as on Fanuc and Haas.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from attrs import define, field

from workhold.errors import InputError
from workhold.units import INCH, MILLIMETRE, Unit

__all__ = [
    "CANCEL",
    "CYCLES",
    "FUNCTIONS",
    "GROUPS",
    "UNITS",
    "Modes",
    "code_of",
    "refuse_code",
    "refuse_function",
]

CYCLES = ("73", "81", "82", "83")
MOTIONS = ("0", "1", "2", "3")
# Cancels the cycle in force; the motion before it goes on, as on Fanuc and Haas.
CANCEL = "80"
OFFSETS = ("54", "55", "56", "57", "58", "59", "59.1", "59.2", "59.3")
GROUPS: Mapping[str, str] = {
    **dict.fromkeys(MOTIONS, "motion"),
    **dict.fromkeys((CANCEL, *CYCLES), "cycle"),
    **dict.fromkeys(("17", "18", "19"), "plane"),
    **dict.fromkeys(("20", "21"), "unit"),
    **dict.fromkeys(("90", "91"), "distance"),
    **dict.fromkeys(("90.1", "91.1"), "centre"),
    **dict.fromkeys(("93", "94", "95"), "feed"),
    **dict.fromkeys(("98", "99"), "return"),
    **dict.fromkeys(("43", "49"), "length"),
    **dict.fromkeys(OFFSETS, "offset"),
    **dict.fromkeys(("61", "61.1", "64"), "path"),
    **dict.fromkeys(("4", "28", "30", "53"), "once"),
    "40": "compensation",
    "15": "polar",
    "50": "scale",
    "69": "rotation",
    "97": "speed",
}
# M0 to M9 and M30; none moves the tool but for M6.
FUNCTIONS = (*(str(number) for number in range(10)), "30")

COMPENSATION = (
    "offsets the path by a radius that only the control knows: post the program with the compensation made "
    "by the computer"
)
CYCLE = "is a cycle that is not read: post the program with its moves written out"
ZERO = "sets another zero: post the program with one zero, and give it where it lies on the part"
TURNED = "turns, mirrors or scales the axes: post the program without"
MACRO = "calls a subprogram: post the program with its moves written out"
REASONS: Mapping[str, str] = {
    **dict.fromkeys(("41", "42", "41.1", "42.1"), COMPENSATION),
    **dict.fromkeys(("74", "76", "84", "84.2", "84.3", "85", "86", "87", "88", "89", "81.2"), CYCLE),
    **dict.fromkeys(("10", "52", "92", "92.1", "92.2", "92.3", "54.1"), ZERO),
    **dict.fromkeys(("16", "51", "51.1", "50.1", "68", "68.2"), TURNED),
    **dict.fromkeys(("65", "66", "67"), MACRO),
    **dict.fromkeys(
        ("43.1", "43.2", "43.4", "44"), "shifts the tool's length in a way that is not read: use G43"
    ),
    **dict.fromkeys(
        ("70", "71", "72"), "means other things on other controls: write G20 or G21 for the unit"
    ),
    **dict.fromkeys(
        ("38.2", "38.3", "38.4", "38.5", "31"), "probes, so that the path is not known: take it out"
    ),
    **dict.fromkeys(("5", "5.1", "5.2", "5.3", "6.2"), "is a spline: post the program with lines and arcs"),
}
UNITS = {"20": INCH, "21": MILLIMETRE, "inch": INCH, "mm": MILLIMETRE}


@cache
def code_of(text: str) -> str:
    """The number of a code without zeros that say nothing.

    Examples
    --------
    >>> code_of("01"), code_of("91.1"), code_of("28.")
    ('1', '91.1', '28')
    """
    return f"{float(text):.10g}"


def refuse_code(code: str) -> None:
    """Refuses a code of letter G.

    Raises
    ------
    InputError
        With its reason; for every code.
    """
    reason = REASONS.get(code, "is not known: take it out, or write the moves that it makes")
    raise InputError(f"G{code} {reason}.")


def refuse_function(code: str) -> None:
    """Refuses a code of letter M.

    Raises
    ------
    InputError
        With its reason; for every code.
    """
    reason = MACRO if code in ("97", "98", "99") else "is not known: take it out if it moves nothing"
    raise InputError(f"M{code} {reason}.")


@define
class Modes:
    """The state of a control, as far as the path follows from it; lengths in mm, from the program's own zero.

    Parameters
    ----------
    unit : of lengths; None until the program says.
    motion : code of the motion in force, None before the first.
    cycle : code of the drill cycle in force, None outside one.
    plane, distance, centre, feed_kind, back : codes in force.
    offset : code of the zero in force.
    place : x, y and z of the tip, None where it is not known.
    called, tool : number that T named last, and that of the tool in the spindle; None before the first.
    feed, spindle : as they are written.
    sticky : values of the cycle in force by their letters, in mm; Z and R are heights.
    initial : height at which the cycle in force began.
    """

    unit: Unit | None = None
    motion: str | None = None
    cycle: str | None = None
    plane: str = "17"
    distance: str = "90"
    centre: str = "91.1"
    feed_kind: str = "94"
    back: str = "98"
    offset: str = "54"
    place: list[float | None] = field(factory=lambda: [None, None, None])
    called: int | None = None
    tool: int | None = None
    feed: float = 0.0
    spindle: float = 0.0
    sticky: dict[str, float] = field(factory=dict)
    initial: float | None = None
