"""The path of the tip as rows of moves, in mm from the program's own zero."""

from __future__ import annotations

from typing import Any

from attrs import define, field

from workhold.errors import InputError
from workhold.files.program.modes import Modes
from workhold.limits import MOST_LENGTH

__all__ = ["AXES", "PathWriter", "Place", "Reached"]

AXES = "XYZ"
# Digits in mm to which places are rounded, so that sums of increments are the places that they mean.
DIGITS = 9
MOST_MOVES = 2_000_000
Place = tuple[float, float, float]
# A place of which not every coordinate needs to be known.
Reached = list[float | None]


@define
class PathWriter:
    """Writes the moves that blocks make.

    Parameters
    ----------
    modes : what is in force.
    line : of the block that is read.
    rows : of the moves, see ``model.moves.Moves.of_rows``; the tool is -1 before any is called.
    arrivals : lines at which the tool comes from a place that is not known.
    unplaced : lines of rapid moves in increments that begin at a place that is not known.
    offset_used : code of the zero in which the moves are.
    """

    modes: Modes = field(factory=Modes)
    line: int = 0
    rows: list[tuple[Any, ...]] = field(factory=list)
    arrivals: list[int] = field(factory=list)
    unplaced: list[int] = field(factory=list)
    offset_used: str | None = None

    def scale(self) -> float:
        """Millimetres in the unit in force.

        Raises
        ------
        InputError
            Before the program says its unit.
        """
        if self.modes.unit is None:
            raise InputError(
                "a length stands before G20 (inch) or G21 (mm), so that its unit is not known: write one of "
                "them, or give the program's unit."
            )
        return self.modes.unit.millimetres

    def length(self, value: float) -> float:
        """A length in mm from its number.

        Raises
        ------
        InputError
            For one without a unit, and one that is too long.
        """
        found = round(value * self.scale(), DIGITS)
        if abs(found) > MOST_LENGTH:
            raise InputError(f"the length {value:g} is beyond {MOST_LENGTH:g} mm: correct it.")
        return found

    def target(self, values: dict[str, float], rapid: bool = False) -> Reached:
        """Where the axis words of a block lead.

        Parameters
        ----------
        rapid : whether the move may be left out as long as nobody knows where it begins.

        Raises
        ------
        InputError
            For an increment from a place that is not known.
        """
        place = list(self.modes.place)
        for axis, letter in enumerate(AXES):
            if letter not in values:
                continue
            value = self.length(values[letter])
            if self.modes.distance == "91":
                before = place[axis]
                if before is None and rapid:
                    self.unplaced.append(self.line)
                    continue
                if before is None:
                    raise InputError(
                        f"{letter} is an increment (G91) from a place that the program does not say: write "
                        "where the tool goes first after G90."
                    )
                value = round(before + value, DIGITS)
                if abs(value) > MOST_LENGTH:
                    raise InputError(f"increments lead beyond {MOST_LENGTH:g} mm: correct them.")
            place[axis] = value
        return place

    def move_to(self, place: Reached, cutting: bool, bulge: float = 0.0) -> None:
        """Moves the tip; from a place that is not known, only where it arrives counts."""
        before = self.modes.place
        self.modes.place = place
        x, y, z = place
        if x is None or y is None or z is None:
            return
        end = (x, y, z)
        from_x, from_y, from_z = before
        if from_x is None or from_y is None or from_z is None:
            self.arrivals.append(self.line)
            self.add(cutting, end, end, 0.0)
        elif before != place:
            self.add(cutting, (from_x, from_y, from_z), end, bulge)

    def add(self, cutting: bool, start: Place, end: Place, bulge: float) -> None:
        """Adds a move.

        Raises
        ------
        InputError
            For a second zero, and one move too many.
        """
        modes = self.modes
        if self.offset_used not in (None, modes.offset):
            raise InputError(
                f"G{modes.offset} comes after moves in G{self.offset_used}, and how the two zeros lie to "
                "each other is not said by the program: give one program for each."
            )
        self.offset_used = modes.offset
        feed = 0.0
        if cutting:
            feed = modes.feed * (1.0 if modes.unit is None else modes.unit.millimetres)
            # The inverse time of G93 counts for a block, not for its spans.
            feed *= {"94": 1.0, "95": modes.spindle, "93": 0.0}[modes.feed_kind]
        if len(self.rows) >= MOST_MOVES:
            raise InputError(f"the program has more than {MOST_MOVES:,} moves: split it.")
        tool = -1 if modes.tool is None else modes.tool
        self.rows.append((self.line, tool, cutting, start, end, bulge, feed, modes.spindle))
