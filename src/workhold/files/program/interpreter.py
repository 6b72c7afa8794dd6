"""A modal interpreter: from blocks to moves of the tip, in mm from the program's own zero.

A block's words take effect in one order, whatever order they are written in (NISTIR 6556, "Order of
execution"). Feed and speed come first, then the tool, modal codes, and the move.
"""

from __future__ import annotations

from math import isfinite

from attrs import define, field

from workhold.errors import InputError
from workhold.files.program.path import (
    AXES,
    PathWriter,
    Place,
    Reached,
    drill_holes,
    make_arc_about_center,
    make_arc_of_radius,
    refuse_unknown,
)
from workhold.files.program.words import (
    CANCEL,
    CYCLES,
    FUNCTIONS,
    GROUPS,
    LOOK_AHEAD,
    NOSE,
    NUMBERED,
    OTHER_UNITS,
    UNITS,
    VISITS,
    ControlState,
    ProgramBlock,
    is_spline,
    normalize_code,
    refuse_code,
    refuse_function,
)

__all__ = ["LAST_DIGIT", "Interpreter"]

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
# Axes that may stay where they are, and further straight ones.
ROTARY, OTHER_AXES = frozenset("ABC"), frozenset("ABCUVW")
# Letters of functions that are passed over.
OF_FUNCTIONS = frozenset("PQRELJ")
# Words that are lengths, of which a number without a decimal point may mean thousandths; K counts in a cycle, and
# is 0 in an arc about z.
LENGTHS = frozenset("XYZIJRQ")
# What the last digit of such a number is then, as a part of the unit.
LAST_DIGIT = {"mm": 1e-3, "inch": 1e-4}


@define
class Interpreter:
    """A control that reads blocks one after the other.

    Parameters
    ----------
    changes : whether the program changes tools by M6; where it never does, T alone changes the tool.
    has_lengths : whether it activates a tool length anywhere (G43).
    in_thousandths : whether a length without a decimal point counts 0.001 mm or 0.0001 inch.
    path : writer of the moves.
    skipped : lines with a move to a machine position (G28, G30, G53).
    calls : (line, number) of every tool that comes into the spindle.
    other_lengths : lines with G43 for the length of a tool that is not in the spindle.
    passed : lines with codes that do not affect the path, by code.
    whole, pointed : lines with lengths without a decimal point; whether other lengths have one.
    angles : angles of rotary axes by their letters; ``away`` for an axis at a machine position.
    presets : lines with G92 at the start.
    distance_said : whether G90 or G91 has been read.
    """

    changes: bool
    has_lengths: bool = False
    in_thousandths: bool = False
    path: PathWriter = field(factory=PathWriter)
    skipped: list[int] = field(factory=list)
    calls: list[tuple[int, int]] = field(factory=list)
    other_lengths: list[int] = field(factory=list)
    passed: dict[str, list[int]] = field(factory=dict)
    whole: list[int] = field(factory=list)
    pointed: bool = False
    angles: dict[str, float] = field(factory=dict)
    away: set[str] = field(factory=set)
    presets: list[int] = field(factory=list)
    distance_said: bool = False

    @property
    def modes(self) -> ControlState:
        """State of the control."""
        return self.path.modes

    def run_block(self, block: ProgramBlock) -> None:
        """Execute a block: update the state and add its moves to ``path``.

        Raises
        ------
        InputError
            For what is not supported, without the line's number.
        """
        self.path.line = block.line
        codes: dict[str, str] = {}
        functions: list[str] = []
        values: dict[str, float] = {}
        whole: list[str] = []
        pointed = False
        for letter, text in block.words:
            if letter == "G":
                self.add_code(codes, normalize_code(text))
            elif letter == "M":
                functions.append(normalize_code(text))
            elif letter in values:
                raise InputError(f"{letter} stands twice: leave one of them out.")
            else:
                values[letter] = float(text)
                if not isfinite(values[letter]):
                    raise InputError(f"the number of {letter} is too large: correct it.")
                if letter in LENGTHS and values[letter]:
                    if "." in text:
                        pointed = True
                    else:
                        whole.append(letter)
        once = codes.get("once")
        if values.keys() & OTHER_AXES:
            self.drop_further_axes(codes, values)
        if (whole or pointed) and once != "4" and not (codes and self.has_look_ahead_code(codes)):
            self.pointed = self.pointed or pointed
            if whole:
                self.count_whole(whole, codes, values)
        count = len(self.path.rows)
        used = self.update_modal_state(codes, functions, values)
        used |= self.run_block_move(codes, values)
        if self.away and any(row[2] for row in self.path.rows[count:]):
            raise InputError(
                f"the tool cuts while {min(self.away)} is at a place of the machine's own: write where it turns "
                "to before."
            )
        for letter in sorted(values.keys() - used):
            raise InputError(
                f"{letter} belongs to {NEEDING[letter]}, and there is none: take it out."
                if letter in NEEDING
                else f"{letter} is not a word that is read: take it out."
            )

    def add_code(self, codes: dict[str, str], code: str) -> None:
        """Add a G code to ``codes`` under its group; raise InputError for an
        unsupported code, and for two codes of one group.
        """
        group = GROUPS.get(code)
        if group is None:
            refuse_code(code)
        if codes.get(group, code) != code:
            raise InputError(
                f"G{codes[group]} and G{code} stand in one block, where only one can be: take one of them "
                "out."
            )
        codes[group] = code

    def drop_further_axes(self, codes: dict[str, str], values: dict[str, float]) -> None:
        """Remove the words of axes other than X, Y and Z from
        ``values``; raise InputError if one of them moves.
        """
        once, distance = codes.get("once"), codes.get("distance", self.modes.distance)
        if once == "4":
            # U is the time of a dwell.
            values.pop("U", None)
        for letter in sorted(values.keys() & OTHER_AXES):
            value = values.pop(letter)
            if letter in ROTARY and once in VISITS:
                self.away.add(letter)
                values[letter] = value
                continue
            if distance == "91":
                at = 0.0
            else:
                # What is not named before the first move stands at 0 until then.
                at = self.angles.setdefault(letter, 0.0 if self.path.rows else value)
                self.away.discard(letter)
            if letter not in ROTARY or value != at:
                raise InputError(
                    f"{letter} moves a fourth axis, about which workhold knows nothing: post the program for "
                    "three axes."
                )

    def has_look_ahead_code(self, codes: dict[str, str]) -> bool:
        """Return whether a block has a code for look-ahead or smoothing, so that
        numbers in the block may belong to that code.
        """
        return any(code in LOOK_AHEAD for code in codes.values())

    def count_whole(self, letters: list[str], codes: dict[str, str], values: dict[str, float]) -> None:
        """Append the block's line to ``whole``, and scale its lengths without a
        decimal point in ``values`` if they count thousandths.

        ``letters`` are the words with such lengths.
        """
        self.whole.append(self.path.line)
        unit = UNITS[codes["unit"]] if "unit" in codes else self.modes.unit
        if self.in_thousandths and unit is not None:
            for letter in letters:
                values[letter] *= LAST_DIGIT[unit.name]

    def update_modal_state(
        self, codes: dict[str, str], functions: list[str], values: dict[str, float]
    ) -> set[str]:
        """Update everything modal except the motion: feed, speed, tool, its length, unit, plane, zero, and
        distance mode.

        Return the letters that have a meaning in the block. Raises InputError for functions that are not
        supported, and for M6 before any T.
        """
        modes, used = self.modes, {"N", "F", "S", "T"}
        for function in functions:
            if function not in FUNCTIONS:
                refuse_function(function)
                self.passed.setdefault(f"M{function}", []).append(self.path.line)
                used |= OF_FUNCTIONS
        if codes:
            used |= self.apply_modal_codes(codes, values)
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
                self.mount_called_tool()
        if "6" in functions:
            if modes.called is None:
                raise InputError("M6 changes to a tool that no T has named: write T and its number before.")
            self.mount_called_tool()
        if "length" in codes:
            used.add("H")
            self.change_length_offset(codes["length"], values.get("H"))
        return used

    def apply_modal_codes(self, codes: dict[str, str], values: dict[str, float]) -> set[str]:
        """Put the modal codes of a block in force, and note the codes that do not affect the path.

        Return the letters of the words that belong to these codes. Raises InputError for a spline, and for a
        zero with a wrong number.
        """
        modes, used = self.modes, set()
        for code in codes.values():
            if code in LOOK_AHEAD:
                if is_spline(code, values.keys(), values.get("P", 0.0)):
                    refuse_code(code)
                self.passed.setdefault(f"G{code}", []).append(self.path.line)
                used |= set(LOOK_AHEAD[code])
        modes.unit = UNITS[codes["unit"]] if "unit" in codes else modes.unit
        if "other unit" in codes:
            # Among other codes, as Vectric's posts write it at the head, it repeats the unit that is in force.
            repeats = OTHER_UNITS[codes["other unit"]] is modes.unit and len(codes) > 1
            if not repeats or values.keys() & set("IJKL"):
                refuse_code(codes["other unit"])
        modes.feed_kind = codes.get("feed", modes.feed_kind)
        modes.plane = codes.get("plane", modes.plane)
        if "offset" in codes:
            zero = codes["offset"]
            if zero in NUMBERED and "P" in values.keys() - used and "once" not in codes:
                if values["P"] != int(values["P"]) or values["P"] < 1:
                    raise InputError(
                        f"P{values['P']:g} is not the number of a zero: write a whole one from 1."
                    )
                used.add("P")
                zero += f" P{values['P']:g}"
            self.path.set_zero_offset(zero)
        modes.distance = codes.get("distance", modes.distance)
        modes.centre = codes.get("centre", modes.centre)
        modes.back = codes.get("return", modes.back)
        self.distance_said = self.distance_said or "distance" in codes
        return used

    def mount_called_tool(self) -> None:
        """Put the tool that was called into the spindle; X,
        Y and Z stay what they were (NISTIR 6556, 3.6.3).
        """
        modes = self.modes
        if modes.called != modes.tool:
            modes.tool = modes.called
            assert modes.called is not None
            self.calls.append((self.path.line, modes.called))

    def change_length_offset(self, code: str, number: float | None) -> None:
        """Put a tool's length in force (G43), or cancel it
        (G49); the tip's height becomes unknown if it changes.

        ``number`` is the value of the word H, the number of the length. 0 cancels the length; None takes the
        length of the tool in the spindle.
        """
        modes = self.modes
        if code == "49" or number == 0:
            length = NOSE if self.has_lengths else None
        else:
            # Without a number it is the length of the tool in the spindle, whichever that is before any is called.
            length = f"H{modes.tool}" if number is None else f"H{number:g}"
            if number is not None and modes.tool not in (None, number):
                self.other_lengths.append(self.path.line)
        if length != modes.length:
            why = NOSE if length == NOSE else f"line {self.path.line} changes the tool's length (G{code})"
            self.path.forget_position([2], why)
            modes.length = length

    def run_block_move(self, codes: dict[str, str], values: dict[str, float]) -> set[str]:
        """Make the move of a block, if it has one, and return the letters that have a meaning."""
        used: set[str] = set()
        once = codes.get("once")
        if once == "4":
            self.passed.setdefault("G4", []).append(self.path.line)
            used |= {"P"}
            if "motion" not in codes:
                return used | {"X"}
            if "P" not in values or codes["motion"] not in ("0", "1") or "cycle" in codes:
                raise InputError("a dwell (G4) and a move stand in one block: write them in two.")
        elif once in VISITS:
            return used | self.move_once(codes, values)
        elif once is not None:
            return used | self.handle_zero_shift(codes, values)
        self.change_motion(codes)
        motion, cycle = self.modes.motion, self.modes.cycle
        if cycle is not None:
            if values.keys() & {"X", "Y", "Z", "R"}:
                return used | drill_holes(self.path, values)
            if codes.get("cycle") in CYCLES:
                raise InputError(
                    f"G{cycle} stands without X, Y, Z or R, where one control drills and another does not: write "
                    "the X and Y of its hole, with Z and R, or take it out."
                )
            return used
        wanted = values.keys() & {"X", "Y", "Z"}
        if motion in ("2", "3") and values.keys() & {"X", "Y", "Z", "I", "J"}:
            return used | self.move_along_arc(motion == "2", values)
        if not wanted:
            return used
        if motion is None:
            raise InputError("a place stands without G0, G1, G2 or G3 in force: write which of them it is.")
        self.path.move_to(self.path.compute_target_position(values, motion == "0"), motion != "0")
        return used | wanted

    def change_motion(self, codes: dict[str, str]) -> None:
        """Put the motion or the drill cycle of a block in force; a cycle that was not in force starts without
        values from an earlier cycle.

        Raises InputError for both together.
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
        """Handle G28, G30 or G53, a move to a machine position; afterwards the positions of the axes are
        unknown.

        Return the letters that have a meaning. Raises InputError for G53 with anything but G0, and if the
        intermediate point is not known.
        """
        once, axes = codes["once"], values.keys() & {"X", "Y", "Z"}
        self.change_motion(codes)
        if once == "53":
            if self.modes.motion not in ("0", "1"):
                raise InputError("G53 stands without G0 or G1: write one of them with it.")
            if self.modes.motion == "1" and axes:
                raise InputError(
                    "G53 with G1 cuts its way to a place of the machine's own, which is not known: write G0 with it."
                )
        else:
            # G28 and G30 pass a place on their way to the machine's own.
            passed = {
                letter: values[letter]
                for axis, letter in enumerate(AXES)
                if letter in values and not (self.modes.distance == "91" and self.modes.place[axis] is None)
            }
            if passed:
                self.path.move_to(self.path.compute_target_position(passed), cutting=False)
        # G28 and G30 alone move all axes.
        alone = once != "53" and not axes and not values.keys() & ROTARY
        lost = [axis for axis, letter in enumerate(AXES) if letter in axes or alone]
        self.path.forget_position(lost, f"line {self.path.line} goes to a place of the machine's own")
        self.skipped.append(self.path.line)
        # P numbers the places of G30.
        return axes | ROTARY | ({"P"} if once == "30" else set())

    def handle_zero_shift(self, codes: dict[str, str], values: dict[str, float]) -> set[str]:
        """Handle G52, G92, G92.1 or G92.2, and return the axis letters used.

        Only codes that leave the zero as it is are accepted: G52 with zeros, G92.1 and G92.2 where no offset
        was set, and a G92 before all motion, which gives the position of the tip. Raises InputError for the
        others.
        """
        modes, axes, code = self.modes, values.keys() & {"X", "Y", "Z"}, codes["once"]
        self.change_motion(codes)
        if code in ("92.1", "92.2"):
            if self.presets:
                refuse_code(code)
            if axes:
                raise InputError(f"G{code} and a place stand in one block: write them in two.")
        elif code == "52":
            if any(values[letter] for letter in axes):
                refuse_code(code)
        else:
            if modes.named or self.path.rows or not axes:
                refuse_code(code)
            for axis, letter in enumerate(AXES):
                if letter in axes:
                    modes.place[axis] = self.path.convert_to_mm(values[letter])
            modes.named = True
            self.presets.append(self.path.line)
        return set(axes)

    def move_along_arc(self, clockwise: bool, values: dict[str, float]) -> set[str]:
        """Move along an arc or a helix about z, and return the letters that have a meaning.

        Raises InputError for an arc with unknown ends or centre, and for one in another plane.
        """
        modes = self.modes
        if modes.plane != "17":
            raise InputError(
                f"an arc stands in the plane G{modes.plane}: post the program with arcs in the plane G17 "
                "only, and with a vertical lead-in of radius 0."
            )
        if values.get("K", 0.0) != 0.0:
            raise InputError("K belongs to arcs in another plane than G17: take it out.")
        start, end = (
            self.require_known_place(modes.place),
            self.require_known_place(self.path.compute_target_position(values)),
        )
        turns = self.read_arc_turns(values)
        if "R" in values:
            if values.keys() & {"I", "J"} or turns != 1:
                raise InputError("an arc has R, and I, J or P besides: write R alone, or I and J.")
            arc = make_arc_of_radius(self.path.convert_to_mm(values["R"]), start, end, clockwise)
        else:
            arc = make_arc_about_center(self.find_arc_centre(values), start, end, clockwise, turns)
        for place, bulge in arc.iterate_spans(start, end):
            self.path.move_to(list(place), True, bulge)
        return {"X", "Y", "Z", "I", "J", "K", "R", "P"}

    def find_arc_centre(self, values: dict[str, float]) -> tuple[float, float]:
        """Return the centre (x, y) in mm of an arc given by
        I and J; raise InputError for an arc without them.
        """
        given = values.keys() & {"I", "J"}
        if not given or (self.modes.centre == "90.1" and len(given) < 2):
            raise InputError(
                "an arc has no centre: write I and J, or R."
                if not given
                else "after G90.1 an arc's centre needs both I and J: write both."
            )
        x, y = (self.path.convert_to_mm(values.get(letter, 0.0)) for letter in "IJ")
        if self.modes.centre == "90.1":
            return x, y
        from_x, from_y, _ = self.modes.place
        assert from_x is not None and from_y is not None
        return from_x + x, from_y + y

    def read_arc_turns(self, values: dict[str, float]) -> int:
        """Return the number of turns of an arc (the word P), in which the last turn may be a part of one; 1
        without P.

        Raises InputError for a P that is not such a number.
        """
        turns = values.get("P", 1.0)
        if turns != int(turns) or not 1 <= turns <= MOST_TURNS:
            raise InputError(
                f"P{turns:g} is not a number of turns: write a whole one from 1 to {MOST_TURNS}."
            )
        return int(turns)

    def require_known_place(self, place: Reached) -> Place:
        """Return the end of an arc unchanged; raise InputError if one of its coordinates is None."""
        x, y, z = place
        if x is None or y is None or z is None:
            refuse_unknown(self.path, place, "an arc begins at a place")
        return x, y, z
