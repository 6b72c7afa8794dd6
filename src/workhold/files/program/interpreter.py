"""A modal interpreter: from blocks to moves of the tip, in mm from the program's own zero.

A block's words take effect in one order, whatever order they are written in (NISTIR 6556, "Order of
execution"). Feed and speed come first, then the tool, what stays in force, and the move.
"""

from __future__ import annotations

from math import isfinite

from attrs import define, field

from workhold.errors import InputError
from workhold.files.program.path import AXES, PathWriter, Reached, arc_about, arc_of_radius, drill
from workhold.files.program.words import (
    CANCEL,
    FUNCTIONS,
    GROUPS,
    UNITS,
    Modes,
    ProgramBlock,
    code_of,
    refuse_code,
    refuse_function,
)

__all__ = ["Interpreter"]

MOST_TURNS = 1000
# The words that only some codes give a meaning, and codes of which one has to be there or in force.
NEEDING = {
    "I": "an arc (G2 or G3)",
    "J": "an arc (G2 or G3)",
    "K": "an arc (G2 or G3) or a drill cycle",
    "R": "an arc (G2 or G3) or a drill cycle",
    "P": "a dwell, an arc or a drill cycle",
    "Q": "a drill cycle",
    "L": "a drill cycle",
    "H": "G43",
    "D": "G41, which is not read",
    "E": "a code that is read",
}
ROTARY = "ABCUVW"


@define
class Interpreter:
    """A control that reads blocks one after the other.

    Parameters
    ----------
    changes : whether the program changes tools by M6; where it never does, T alone names the tool.
    path : writes the moves.
    skipped : lines with a move to the machine's own places.
    calls : (line, number) of every tool that comes into the spindle.
    other_lengths : lines with G43 for another tool than the one in the spindle.
    """

    changes: bool
    path: PathWriter = field(factory=PathWriter)
    skipped: list[int] = field(factory=list)
    calls: list[tuple[int, int]] = field(factory=list)
    other_lengths: list[int] = field(factory=list)
    distance_said: bool = False

    @property
    def modes(self) -> Modes:
        """What is in force."""
        return self.path.modes

    def read(self, block: ProgramBlock) -> None:
        """Takes a block.

        Raises
        ------
        InputError
            For what is not read, without the line's number.
        """
        self.path.line = block.line
        codes: dict[str, str] = {}
        functions: list[str] = []
        values: dict[str, float] = {}
        for letter, text in block.words:
            if letter == "G":
                self.add_code(codes, code_of(text))
            elif letter == "M":
                functions.append(code_of(text))
            elif letter in values:
                raise InputError(f"{letter} stands twice: leave one of them out.")
            else:
                values[letter] = float(text)
                if not isfinite(values[letter]):
                    raise InputError(f"the number of {letter} is too large: correct it.")
        if values.keys() & ROTARY:
            raise InputError(
                f"{min(values.keys() & set(ROTARY))} moves a fourth axis, of which nothing is known: post "
                "the program for three axes."
            )
        self.set_up(codes, functions, values)
        used = self.move(codes, values)
        for letter in sorted(values.keys() - used):
            raise InputError(
                f"{letter} is of {NEEDING[letter]}, and there is none: take it out."
                if letter in NEEDING
                else f"{letter} is not a word that is read: take it out."
            )

    def add_code(self, codes: dict[str, str], code: str) -> None:
        """Adds a code to those of the block by its group.

        Raises
        ------
        InputError
            For one that is not read, and two of one group.
        """
        group = GROUPS.get(code)
        if group is None:
            refuse_code(code)
        assert group is not None
        if codes.get(group, code) != code:
            raise InputError(
                f"G{codes[group]} and G{code} stand in one block, where only one can be: take one of them "
                "out."
            )
        codes[group] = code

    def set_up(self, codes: dict[str, str], functions: list[str], values: dict[str, float]) -> None:
        """Takes what stays in force: feed and speed, the tool, unit, plane, zero and how places are written.

        Raises
        ------
        InputError
            For functions that are not read, and a change to no tool.
        """
        modes = self.modes
        for function in functions:
            if function not in FUNCTIONS:
                refuse_function(function)
        modes.unit = UNITS[codes["unit"]] if "unit" in codes else modes.unit
        modes.feed_kind = codes.get("feed", modes.feed_kind)
        if "F" in values:
            modes.feed = values["F"]
        if "S" in values:
            modes.spindle = values["S"]
        if modes.feed < 0 or modes.spindle < 0:
            raise InputError("a feed or a speed is below 0: correct it.")
        if "T" in values:
            if values["T"] != int(values["T"]) or values["T"] < 0:
                raise InputError(f"T{values['T']:g} is not a tool: write a whole number.")
            modes.called = int(values["T"])
            if not self.changes:
                self.change_tool()
        if "6" in functions:
            if modes.called is None:
                raise InputError("M6 changes to a tool that no T has named: write T and its number before.")
            self.change_tool()
        modes.plane = codes.get("plane", modes.plane)
        modes.offset = codes.get("offset", modes.offset)
        modes.distance = codes.get("distance", modes.distance)
        modes.centre = codes.get("centre", modes.centre)
        modes.back = codes.get("return", modes.back)
        self.distance_said = self.distance_said or "distance" in codes
        if "H" in values and codes.get("length") == "43" and modes.tool not in (None, values["H"]):
            self.other_lengths.append(self.path.line)

    def change_tool(self) -> None:
        """Puts the tool that was called into the spindle; where it is then is not known."""
        modes = self.modes
        if modes.called != modes.tool:
            modes.tool = modes.called
            modes.place = [None, None, None]
            modes.initial = None
            assert modes.called is not None
            self.calls.append((self.path.line, modes.called))

    def move(self, codes: dict[str, str], values: dict[str, float]) -> set[str]:
        """Makes the move of a block, if it has one, and returns the letters that have a meaning.

        Raises
        ------
        InputError
            For a move that is not known, or not read.
        """
        used = {"N", "F", "S", "T"}
        if "length" in codes:
            used |= {"H"}
        if codes.get("path") == "64":
            used |= {"P", "Q"}
        once = codes.get("once")
        if once == "4":
            used |= {"P"}
            if "motion" not in codes:
                return used | {"X"}
            if "P" not in values or codes["motion"] not in ("0", "1") or "cycle" in codes:
                raise InputError("a dwell (G4) and a move stand in one block: write them in two.")
        elif once is not None:
            return used | self.move_once(codes, values)
        self.change_motion(codes)
        motion, cycle = self.modes.motion, self.modes.cycle
        if cycle is not None:
            if values.keys() & {"X", "Y", "Z", "R"}:
                return used | drill(self.path, values)
            return used | ({"P", "Q"} if "cycle" in codes else set())
        wanted = values.keys() & {"X", "Y", "Z"}
        if motion in ("2", "3") and values.keys() & {"X", "Y", "Z", "I", "J"}:
            return used | self.move_along_arc(motion == "2", values)
        if not wanted:
            return used
        if motion is None:
            raise InputError("a place stands without G0, G1, G2 or G3 in force: write which of them it is.")
        self.path.move_to(self.path.target(values, motion == "0"), motion != "0")
        return used | wanted

    def change_motion(self, codes: dict[str, str]) -> None:
        """Puts the motion of a block in force, or its cycle, which begins anew after any other motion.

        Raises
        ------
        InputError
            For both.
        """
        modes, motion, cycle = self.modes, codes.get("motion"), codes.get("cycle")
        if motion is not None and cycle not in (None, CANCEL):
            raise InputError(f"G{motion} and G{cycle} stand in one block: write them in two.")
        if motion is not None or cycle == CANCEL:
            modes.cycle = None
        modes.motion = motion or modes.motion
        if cycle is not None and cycle not in (CANCEL, modes.cycle):
            modes.initial = modes.place[2] if modes.cycle is None else modes.initial
            modes.cycle, modes.sticky = cycle, {}

    def move_once(self, codes: dict[str, str], values: dict[str, float]) -> set[str]:
        """Takes a move to a place of the machine's own, after which the tool comes from nowhere.

        Raises
        ------
        InputError
            For G53 with an arc, and a place that is passed and not known.
        """
        once, axes = codes["once"], values.keys() & {"X", "Y", "Z"}
        self.change_motion(codes)
        place: Reached
        if once == "53":
            if self.modes.motion not in ("0", "1"):
                raise InputError("G53 stands without G0 or G1: write one of them with it.")
            place = list(self.modes.place)
        else:
            # G28 and G30 pass a place on their way to the machine's own.
            passed = {
                letter: values[letter]
                for axis, letter in enumerate(AXES)
                if letter in values and not (self.modes.distance == "91" and self.modes.place[axis] is None)
            }
            if passed:
                self.path.move_to(self.path.target(passed), cutting=False)
            place = list(self.modes.place)
        for axis, letter in enumerate(AXES):
            if letter in axes or (once != "53" and not axes):
                place[axis] = None
        self.modes.place = place
        self.skipped.append(self.path.line)
        return set(axes)

    def move_along_arc(self, clockwise: bool, values: dict[str, float]) -> set[str]:
        """Moves along an arc or a helix about z.

        Raises
        ------
        InputError
            For an arc that is not known, or stands in another plane.
        """
        modes = self.modes
        if modes.plane != "17":
            raise InputError(
                f"an arc stands in the plane G{modes.plane}: post the program with arcs in the plane G17 "
                "only, and with a vertical lead-in of radius 0."
            )
        if values.get("K", 0.0) != 0.0:
            raise InputError("K is of arcs in another plane than G17: take it out.")
        start, end = known(modes.place), known(self.path.target(values))
        turns = self.turns_of(values)
        if "R" in values:
            if values.keys() & {"I", "J"} or turns != 1:
                raise InputError("an arc has R, and I, J or P besides: write R alone, or I and J.")
            arc = arc_of_radius(self.path.length(values["R"]), start, end, clockwise)
        else:
            arc = arc_about(self.centre_of(values), start, end, clockwise, turns)
        for place, bulge in arc.spans(start, end):
            self.path.move_to(list(place), True, bulge)
        return {"X", "Y", "Z", "I", "J", "K", "R", "P"}

    def centre_of(self, values: dict[str, float]) -> tuple[float, float]:
        """Where I and J say that an arc's centre is.

        Raises
        ------
        InputError
            For an arc without them.
        """
        given = values.keys() & {"I", "J"}
        if not given or (self.modes.centre == "90.1" and len(given) < 2):
            raise InputError(
                "an arc has no centre: write I and J, or R."
                if not given
                else "after G90.1 an arc's centre needs both I and J: write both."
            )
        x, y = (self.path.length(values.get(letter, 0.0)) for letter in "IJ")
        if self.modes.centre == "90.1":
            return x, y
        from_x, from_y, _ = self.modes.place
        assert from_x is not None and from_y is not None
        return from_x + x, from_y + y

    def turns_of(self, values: dict[str, float]) -> int:
        """How many turns an arc makes at most, P.

        Raises
        ------
        InputError
            For a number that is none.
        """
        turns = values.get("P", 1.0)
        if turns != int(turns) or not 1 <= turns <= MOST_TURNS:
            raise InputError(
                f"P{turns:g} is not a number of turns: write a whole one from 1 to {MOST_TURNS}."
            )
        return int(turns)


def known(place: Reached) -> tuple[float, float, float]:
    """A place of which all is known; refuses one of which something is not."""
    x, y, z = place
    if x is None or y is None or z is None:
        raise InputError(
            "an arc begins at a place that the program does not say: write where the tool goes before it."
        )
    return x, y, z
