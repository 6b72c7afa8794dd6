"""What stays in force from block to block, and where the tool is."""

from __future__ import annotations

from attrs import define, field

from workhold.units import INCH, MILLIMETRE, Unit

__all__ = ["Modes", "UNITS"]

UNITS = {"20": INCH, "21": MILLIMETRE, "inch": INCH, "mm": MILLIMETRE}


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
