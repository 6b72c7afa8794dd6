"""Reading of a program from its file: text, blocks, moves, tools, and notes on how it was read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from hashlib import sha256
from math import isfinite
from pathlib import Path
from typing import Any, Literal

import numpy as np
from attrs import evolve, frozen

from workhold.errors import InputError, join_words
from workhold.files.budget import LIMITS
from workhold.files.program.interpreter import LAST_DIGIT, Interpreter
from workhold.files.program.path import PathWriter, Place
from workhold.files.program.subprograms import expand_calls
from workhold.files.program.tool_tables import (
    SHAPE,
    make_tool_from_fields,
    read_tools,
    read_tools_in_comments,
)
from workhold.files.program.words import (
    UNITS,
    VISITS,
    ProgramBlock,
    ProgramText,
    normalize_code,
    parse_program_text,
)
from workhold.files.questions import START, name_questions
from workhold.files.text import read_limited
from workhold.limits import convert_real, refuse_long
from workhold.model.cutting_forces import compute_cutting_forces
from workhold.model.cutting_tool import CuttingData, Tool
from workhold.model.moves import Moves
from workhold.model.program import Program
from workhold.model.stock import Stock, find_stretches_in_stock
from workhold.units import Unit

__all__ = ["ReadProgram", "read_program", "read_program_with_calls"]

# How many lines a note names.
NAMED = 5
ToolsGiven = str | Path | Mapping[int, Any] | None
ZZero = float | Literal["top", "bottom"]
WholeNumbers = Literal["units", "thousandths"]


@frozen
class ReadProgram:
    """A program, and the tools that come into the spindle.

    Parameters
    ----------
    program : what was read.
    calls : (line, number of the tool) of every tool that comes into the spindle, in their order.
    lines : number of lines of the file.
    """

    program: Program
    calls: tuple[tuple[int, int], ...]
    lines: int


def read_program(path: str | Path, tools: ToolsGiven = None, **how: Any) -> Program:
    """Return the program in a file, see :meth:`workhold.model.program.Program.read`.

    Parameters
    ----------
    ``how`` : the other parameters of :func:`read_program_with_calls`.

    Raises
    ------
    InputError
        Naming the file and the line of what cannot be read.
    """
    return read_program_with_calls(path, tools, **how).program


def read_program_with_calls(
    path: str | Path,
    tools: ToolsGiven = None,
    *,
    zero: tuple[float, float] = (0.0, 0.0),
    z_zero: ZZero = "top",
    thickness: float | None = None,
    clearance: float = 1.0,
    rapid: Literal["straight", "box"] = "straight",
    unit: str | None = None,
    cutting: CuttingData | Mapping[str, Any] | None = None,
    start: Sequence[float] | None = None,
    whole_numbers: WholeNumbers = "units",
    stock: Stock | Mapping[str, Any] | str | None = None,
    called: Mapping[str, str] | None = None,
) -> ReadProgram:
    """Return the program in a file, with the tools that it calls.

    Parameters
    ----------
    called : names of the questions of ``files.questions`` at the caller; None gives those of Python's
        arguments. The other parameters are those of :meth:`workhold.model.program.Program.read`.

    Raises
    ------
    InputError
        Naming the file and the line of what cannot be read.
    """
    path = Path(path)
    height, origin = (
        compute_height_of_zero(z_zero, thickness),
        (convert_real(zero[0], "zero"), convert_real(zero[1], "zero")),
    )
    convert_real(clearance, "clearance")
    if unit is not None and unit not in ("mm", "inch"):
        raise InputError(f"the unit '{unit[:20]}' of the program is not known: give mm or inch.")
    if whole_numbers not in ("units", "thousandths"):
        raise InputError(
            f"whole numbers of a program count units or thousandths, and not '{str(whole_numbers)[:20]}': give "
            "one of them."
        )
    begin = None if start is None else read_start_place(start)
    cut_from = Stock.from_value(stock, None if thickness is None else convert_real(thickness, "thickness"))
    try:
        content = read_limited(path, LIMITS["program"])
        listing = expand_calls(parse_program_text(decode_program(content)))
        control = interpret_program(
            listing,
            None if unit is None else UNITS[unit],
            begin,
            in_thousandths=whole_numbers == "thousandths",
        )
    except InputError as error:
        raise InputError(f"{path}: {name_questions(str(error), called)}") from error
    first = find_first_unit(listing, unit)
    found, notes = list_tools_used(path, control, listing, tools, first)
    if begin is not None:
        notes.append("The tip starts at X{:g} Y{:g} Z{:g} mm, as given.".format(*begin))
    program = Program(
        name=path.name,
        sha256=sha256(content).hexdigest(),
        unit="inch" if first is UNITS["20"] else "mm",
        zero=origin,
        z_zero=height,
        clearance=clearance,
        rapid=rapid,
        tools=found,
        skipped=sorted({*control.skipped, *control.path.unplaced, *control.path.nose}),
        notes=[*describe_reading(control, listing), *notes],
        stock=cut_from,
    )
    # Where it runs is checked by now.
    moves = make_moves(control, found, np.array([*program.zero, height]))
    try:
        # Beside the part no tool is known to be before the part is.
        within = find_stretches_in_stock(moves, found, cut_from, None, moves.cutting)
        forces = compute_cutting_forces(moves, found, CuttingData.from_value(cutting), within)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    program = evolve(program, moves=moves, forces=forces)
    return ReadProgram(program, tuple(control.calls), content.count(b"\n") + 1)


def compute_height_of_zero(z_zero: ZZero, thickness: float | None) -> float:
    """Return the height of the program's Z0 in mm above the plane on which the part lies.

    Raises InputError for "top" where the part's thickness is not known, and for anything that is not a
    height.
    """
    if z_zero == "bottom":
        return 0.0
    if z_zero == "top":
        if thickness is None or not (isfinite(convert_real(thickness, "thickness")) and thickness > 0):
            raise InputError(
                "the program's Z0 is the top of the part, and the part's thickness is not known: give "
                "its thickness, or z_zero as a height."
            )
        return convert_real(thickness)
    other: object = z_zero
    if isinstance(other, str) or not isfinite(height := convert_real(other, "z_zero")):
        raise InputError("z_zero is not a height: give top, bottom, or a length above the part's lower side.")
    return height


def read_start_place(start: Sequence[float]) -> Place:
    """Return the position (x, y, z) of the tip at the start in mm; raise InputError for anything else."""
    values = tuple(convert_real(value, "the start of the program") for value in start)
    if len(values) != 3 or not all(isfinite(value) for value in values):
        raise InputError("the start of the program is not a place: give X, Y and Z in mm, from its own zero.")
    for value in values:
        refuse_long("the start of the program", value)
    return values[0], values[1], values[2]


def decode_program(content: bytes) -> str:
    """Return the text of a program from UTF-8, or else from Latin-1, in which comments may be written; raise
    InputError if it is not text.
    """
    if b"\0" in content:
        raise InputError("the file is not text: give a program of RS-274 (G-code).")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")


def interpret_program(
    listing: ProgramText, unit: Unit | None, start: Place | None = None, in_thousandths: bool = False
) -> Interpreter:
    """Return the interpreter after it has read all blocks.

    Raises InputError for the first block that cannot be read, with its line, and for a program that moves
    nothing.

    Parameters
    ----------
    unit : unit of lengths until the program says its own; None if not known.
    start : position of the tip at the start in mm; None if not known.
    in_thousandths : see :class:`Interpreter`.
    """
    changes = any(
        letter == "M" and normalize_code(text) == "6"
        for block in listing.blocks
        for letter, text in block.words
    )
    has_heights = any(map(gives_height, listing.blocks))
    path = PathWriter(has_heights=has_heights or start is not None)
    control = Interpreter(changes, any(map(has_length, listing.blocks)), in_thousandths, path)
    control.modes.unit = unit
    if start is not None:
        control.modes.place = list(start)
    for block in listing.blocks:
        try:
            control.run_block(block)
        except InputError as error:
            raise InputError(f"line {block.line}: {error}") from error
    if not path.rows:
        if path.adrift and not has_heights:
            raise InputError(
                "there is no move in it whose height is known, as no height (Z) is given anywhere: give a program with "
                f"heights, or where the tip is at the start with {START}."
            )
        raise InputError(
            "there is no move in it (G0 to G3, or a drill cycle): give a program of RS-274 (G-code)."
        )
    return control


def gives_height(block: ProgramBlock) -> bool:
    """Return whether a block gives a height of the tip that is not a machine position."""
    return any(letter == "Z" for letter, _ in block.words) and not any(
        letter == "G" and normalize_code(text) in VISITS for letter, text in block.words
    )


def has_length(block: ProgramBlock) -> bool:
    """Return whether a block puts a tool length in force (G43 without H0)."""
    if not any(letter == "G" and normalize_code(text) == "43" for letter, text in block.words):
        return False
    return not any(letter == "H" and float(text) == 0.0 for letter, text in block.words)


def find_first_unit(listing: ProgramText, unit: str | None) -> Unit:
    """Return the unit in which a program begins; lengths of tools in its comments have the same unit.

    ``unit`` is taken where the program names no unit; mm if ``unit`` is None, too.
    """
    codes = (
        normalize_code(text) for block in listing.blocks for letter, text in block.words if letter == "G"
    )
    return UNITS[next((code for code in codes if code in ("20", "21")), unit or "mm")]


def make_moves(control: Interpreter, tools: Mapping[int, Tool], shift: np.ndarray[Any, Any]) -> Moves:
    """Return the moves in the part's coordinates: shifted by ``shift`` (x, y, z) in mm.

    Moves before any tool call get the lowest number among ``tools``.
    """
    moves = Moves.from_rows(control.path.rows)
    tool = np.where(moves.tool < 0, min(tools), moves.tool)
    return evolve(moves, tool=tool, start=moves.start + shift, end=moves.end + shift)


def list_tools_used(
    path: Path, control: Interpreter, listing: ProgramText, given: ToolsGiven, unit: Unit
) -> tuple[dict[int, Tool], list[str]]:
    """Return (1) the tools with which the program moves, by number, and (2)
    notes on what is not known of these tools.

    Rapid moves before any tool is called may be removed from ``control``, see :func:`drop_moves_without_tool`. Raises
    InputError for a tool without a known diameter.

    Parameters
    ----------
    given : tools by number, or a table's path; None for those in the program's comments.
    unit : unit of lengths that are given without a unit.
    """
    notes: list[str] = []
    if given is None:
        try:
            known = read_tools_in_comments(listing.comments, unit, control.calls)
        except InputError as error:
            raise InputError(f"{path}: {error}") from error
    elif isinstance(given, Mapping):
        known = {number: make_tool_from_value(number, value, unit) for number, value in given.items()}
    else:
        known, said = read_tools(given, unit)
        if not said:
            notes.append(
                f"The table of tools does not say its unit, so it is read in {unit.name} like the program."
            )
    notes += drop_moves_without_tool(path, control, known)
    used = sorted({row[1] for row in control.path.rows})
    if used[0] < 0:
        # Nothing is called before the first move: the tool in the spindle is the table's 0, or its only one.
        if len(used) == 1 and len(known) == 1:
            number = next(iter(known))
            notes.append(
                f"The program calls no tool before it moves; T{number}, the only one given, is taken."
            )
        else:
            number = 0
        used[0] = number
    missing = sorted(set(used) - set(known))
    if missing:
        raise InputError(f"{path}: {describe_missing_tools(sorted(set(used)), missing)}")
    bare = [f"T{number}" for number in sorted(set(used)) if not known[number].has_holder]
    if bare:
        notes.append(f"The holder of {join_words(bare)} is not known, so it is not checked.")
    return {number: known[number] for number in sorted(set(used))}, notes


def drop_moves_without_tool(path: Path, control: Interpreter, known: Mapping[int, Tool]) -> list[str]:
    """Remove rapid moves without a tool, before any call or with
    T0, from ``control``; return a list with a note on them.

    They are kept if ``known`` has a tool 0, or the program has no other moves. Raises InputError for a cut
    without a tool.
    """
    rows = control.path.rows
    early = [row for row in rows if row[1] <= 0]
    if not early or len(early) == len(rows) or 0 in known:
        return []
    cut = next((row for row in early if row[2]), None)
    if cut is not None:
        before = "T0 is in the spindle" if cut[1] == 0 else "no tool has been called"
        raise InputError(
            f"{path}: line {cut[0]}: the tool cuts while {before}, so it is not known which tool cuts "
            "there: call it by T and M6, or give it in the file of tools as number 0, such as "
            f"{SHAPE.format(number=0)}."
        )
    lines = {row[0] for row in early}
    control.path.rows = [row for row in rows if row[1] > 0]
    control.path.arrivals = [line for line in control.path.arrivals if line not in lines]
    return [f"{format_line_numbers(sorted(lines))}: a rapid move before any tool is called is left out."]


def make_tool_from_value(number: int, value: Any, unit: Unit) -> Tool:
    """Return a tool from a Tool, a diameter in the program's unit, or a mapping
    of fields; raise InputError for other values.
    """
    if isinstance(value, Tool):
        return value
    fields = value if isinstance(value, Mapping) else {"diameter": value}
    return make_tool_from_fields(int(number), fields, f"T{number}", unit)


def describe_missing_tools(used: Sequence[int], missing: Sequence[int]) -> str:
    """Return the error message for tools without a known diameter."""
    names = [f"T{number}" for number in missing]
    if used == [0]:
        called = "the program moves without calling a tool, and what is in the spindle (T0)"
    else:
        called = f"the program calls {join_words([f'T{number}' for number in used])}, and the diameter of "
        called += join_words(names)
    return (
        f"{called} is not known: give a file of tools with a line for each, such as "
        f"{SHAPE.format(number=missing[0])}."
    )


def format_line_numbers(lines: Sequence[int]) -> str:
    """Return text such as "Line 3": the first few line numbers, and how many more there are.

    >>> format_line_numbers([3]), format_line_numbers([1, 2, 3, 4, 5, 6, 7])
    ('Line 3', 'Lines 1, 2, 3, 4, 5 and 2 more')
    """
    unlike = list(dict.fromkeys(lines))
    if len(unlike) == 1:
        return f"Line {unlike[0]}"
    shown = [str(line) for line in unlike[:NAMED]]
    more = len(unlike) - NAMED
    return f"Lines {join_words([*shown, f'{more} more']) if more > 0 else join_words(shown)}"


def describe_reading(control: Interpreter, listing: ProgramText) -> list[str]:
    """Return notes, in sentences, on how the program was read."""
    notes = []
    if control.path.arrivals:
        notes.append(
            f"{format_line_numbers(control.path.arrivals)}: the tool comes from a place that the program does not "
            "say, and only where it arrives counts."
        )
    if control.skipped:
        notes.append(
            f"{format_line_numbers(control.skipped)}: a move to a place of the machine's own (G28, G30, G53, $H) is left "
            "out."
        )
    if control.path.unplaced:
        notes.append(
            f"{format_line_numbers(control.path.unplaced)}: a rapid move in increments (G91) begins at a place that "
            "the program does not say, and is left out."
        )
    path = control.path
    if path.nose:
        notes.append(
            f"{format_line_numbers(path.nose)}: after G49 a height is that of the spindle's nose and not of the tip, and "
            "the move is left out."
        )
    said = {*control.skipped, *path.unplaced, *path.nose}
    adrift = [line for line in path.adrift if line not in said]
    if adrift:
        notes.append(
            f"{format_line_numbers(adrift)}: a rapid move while X, Y or Z is not known is left out; the axes "
            "that it names are known from then on."
        )
    if not control.distance_said:
        notes.append("The program does not say G90 or G91; its places are read as after G90.")
    if not control.changes and control.calls:
        notes.append("The program has no M6; T alone is read as the change to that tool.")
    if control.other_lengths:
        notes.append(f"{format_line_numbers(control.other_lengths)}: G43 takes the length of another tool.")
    if path.unpecked:
        notes.append(
            f"{format_line_numbers(path.unpecked)}: peck drilling has no depth of a peck (Q); the hole is the same, and "
            "some controls refuse it."
        )
    if listing.asked:
        notes.append(
            f"{format_line_numbers(listing.asked)}: a question to the control ($ or ?) is passed over, as it moves nothing."
        )
    if listing.optional:
        notes.append(
            f"{format_line_numbers(listing.optional)}: a line that a switch can leave out (/) is read."
        )
    unfed = [row[0] for row in control.path.rows if row[2] and row[6] <= 0.0]
    if unfed:
        notes.append(
            f"{format_line_numbers(unfed)}: a cutting move has no feed, and its time is not counted."
        )
    if control.presets:
        notes.append(
            f"{format_line_numbers(control.presets)}: G92 says where the tip stands from the program's zero."
        )
    if control.angles:
        axes = join_words([f"{letter} at {angle:g}" for letter, angle in sorted(control.angles.items())])
        notes.append(f"A fourth axis stays where it is all through ({axes}), and turns nothing.")
    if control.passed:
        lines = sorted({line for lines in control.passed.values() for line in lines})
        codes = join_words(sorted(control.passed, key=lambda code: (code[0], float(code[1:]))))
        are, they = ("is", "it tells") if len(control.passed) == 1 else ("are", "they tell")
        notes.append(
            f"{format_line_numbers(lines)}: {codes} {are} passed over, as {they} nothing of the path."
        )
    notes += describe_whole_program(control)
    if listing.behind:
        notes.append(
            f"{format_line_numbers(listing.behind)}: the lines behind the end of the program are not read."
        )
    return notes


def describe_whole_program(control: Interpreter) -> list[str]:
    """Return a list with a note on lengths without a decimal point; [] if there are none."""
    unit = control.modes.unit
    if not control.whole or unit is None:
        return []
    digit = f"{LAST_DIGIT[unit.name]:g} {unit.name}"
    what = (
        f"{format_line_numbers(control.whole)}: lengths without a decimal point, where others have one, are"
    )
    if not control.pointed:
        what = "No length of the program has a decimal point; they are"
    if control.in_thousandths:
        return [f"{what} read as multiples of {digit}, as asked."]
    whole = "mm" if unit.name == "mm" else "inches"
    return [f"{what} read as whole {whole}, which some controls take for {digit}."]
