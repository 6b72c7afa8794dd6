"""Options of a program that the fixtures keep clear of: its zero, and cutting data for tools that the table
of tools does not describe.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from attrs import evolve, fields, frozen

from workhold.asking.declaring import list_declarations
from workhold.asking.program import FORCES, PROGRAM, CuttingQuestion, ProgramQuestion
from workhold.cli.commands import make_default_group, make_option, print_remark
from workhold.cli.declared import make_option_attributes, make_word_attribute, read_words
from workhold.cli.options import PartOptions
from workhold.cli.values import (
    read_choice,
    read_length,
    read_optional_positive_length,
    read_two_lengths,
)
from workhold.errors import InputError
from workhold.units import MILLIMETRE, Unit

if TYPE_CHECKING:
    from workhold.model.program import Program
    from workhold.model.workpiece import Workpiece

__all__ = [
    "OF_CUTTING",
    "OF_PROGRAM",
    "SOLIDS",
    "STOCK",
    "ProgramOptions",
    "make_reader_arguments",
    "read_program_zero",
]

OF_PROGRAM, OF_CUTTING = list_declarations(ProgramQuestion), list_declarations(CuttingQuestion)
# What is asked by words of its own, read with the part.
BY_WORDS = ("zero", "z_zero")
STOCK = make_option(
    FORCES,
    "SHAPE,SIDE,TOP",
    "Raw stock, on which alone tools press: the part's outline, or the block around it, with "
    "stock around it and on top; outline,5,5 if not given. Give block, 0,0 or block,2,1.",
)
PROGRAM_FILE = make_option(
    PROGRAM,
    "FILE",
    "List only fixtures that the tools of this program (G-code) keep clear of; see workhold program.",
)
TOOLS = make_option(
    PROGRAM,
    "FILE",
    "Table of the program's tools: TOML, CSV, or LinuxCNC's; the program's comments if not given.",
)
THICKNESS = make_option(
    PROGRAM,
    "LENGTH",
    "Thickness of the part; that of its solid if not given. Pegs are as high as the part, or "
    "as --peg-height says.",
)
# What the questions of a program's reader are called here.
CALLED = {"start": "--start X,Y,Z"}
SOLIDS = (".step", ".stp")
NO_HEIGHT: dict[str, Any] = {"peg_height": None}


@frozen(
    these=make_option_attributes(
        (*OF_PROGRAM, *OF_CUTTING),
        zero={"program": make_word_attribute(PROGRAM_FILE), "tools": make_word_attribute(TOOLS)},
        stock=make_word_attribute(STOCK),
        thickness=make_word_attribute(THICKNESS),
    )
)
class ProgramOptions:
    """The options of a program, as typed; None for those not given."""

    if TYPE_CHECKING:
        program: str | None
        tools: str | None
        zero: str
        z_zero: str
        stock: str | None
        thickness: str | None

    @property
    def files(self) -> tuple[str | None, ...]:
        """Paths of the program and of the table of tools; None for those not given."""
        return self.program, self.tools

    @property
    def has_forces(self) -> bool:
        """Whether cutting forces are asked for, by an option or in the table of tools (a file that is read
        here).
        """
        if self.program is None:
            return False
        if any(getattr(self, name) is not None for name in ("cutting_force", "power", "material")):
            return True
        if self.tools is None:
            return False
        from workhold.files.program.tool_tables import read_tools

        tools, _ = read_tools(self.tools, MILLIMETRE)
        return any(tool.cutting.asks_for_forces for tool in tools.values())

    def adapt_part_options(self, part: str, reading: PartOptions) -> PartOptions:
        """Return the options for reading a part.

        For a drawing the peg height is removed: it concerns the fixtures only.
        """
        is_drawing = Path(part).suffix.lower() not in SOLIDS
        return evolve(reading, **NO_HEIGHT) if is_drawing else reading

    def read_query_arguments(
        self, unit: Unit, peg_height: str | None, workpiece: Workpiece | None = None
    ) -> dict[str, Any]:
        """Return "program", "thickness" and "peg_height" (mm) of a query as keyword arguments.

        Without a program it has only the heights; it is {} for a solid and for a part that is not read yet.
        Remarks on the program are printed.

        Parameters
        ----------
        peg_height : as typed.
        workpiece : for the heights of its solid; None where it is not known yet.

        Raises
        ------
        InputError
            For options or a program that cannot be read, for missing heights that are needed, and for options
            of a program without a program.
        """
        if self.program is None:
            # Of a thickness other options make use as well.
            usual = make_default_group(ProgramOptions, thickness=self.thickness)
            given = [
                one.name
                for one in fields(ProgramOptions)
                if getattr(self, one.name) != getattr(usual, one.name)
            ]
            if given:
                raise InputError(
                    f"--{given[0].replace('_', '-')} belongs to a program: name the program with --program."
                )
        solid = None if workpiece is None else workpiece.solid
        if self.program is None:
            # Of a part that is read later nobody knows yet whether it has heights of its own.
            return self.read_heights(unit, peg_height) if workpiece is not None and solid is None else {}
        thick, high = self.read_heights(unit, peg_height).values()
        if solid is not None:
            thick, high = thick or solid.height, solid.peg_height
        if thick is None and (self.z_zero == "top" or high is None):
            raise InputError(
                "the part is an outline without heights, so it is not known which moves of --program "
                "pass over the pegs: give its --thickness, and --peg-height where pegs are not as high."
            )
        zero = read_program_zero_on_part(workpiece, self.zero, unit)
        heights = {"thickness": None if solid is not None else thick, "peg_height": high or thick}
        return {"program": read_program_once(self, unit, thick, zero), **heights}

    def read_heights(self, unit: Unit, peg_height: str | None) -> dict[str, float | None]:
        """Return "thickness" of a part from a drawing, and "peg_height", in mm; None for those not given.

        Raises
        ------
        InputError
            For anything but lengths above 0.
        """
        return {
            "thickness": read_optional_positive_length("--thickness", self.thickness, unit),
            "peg_height": read_optional_positive_length("--peg-height", peg_height, unit),
        }


def read_stock_arguments(text: str, unit: Unit) -> dict[str, Any]:
    """Return the fields of the stock that the text gives, by name, lengths in mm.

    :meth:`workhold.model.stock.Stock.from_value` takes them.

    Examples
    --------
    >>> read_stock_arguments("block", MILLIMETRE), read_stock_arguments("0,2", MILLIMETRE)
    ({'shape': 'block'}, {'side': 0.0, 'top': 2.0})
    """
    first, *rest = (word.strip() for word in text.split(","))
    given: dict[str, Any] = {}
    if first[:1].isalpha():
        given["shape"] = read_choice("--stock", first, ("outline", "block"))
        if not rest:
            return given
    else:
        rest = [first, *rest]
    remedy = "the stock: give outline or block, the stock around and on top, such as 0,2, or block,0,2."
    side, top = read_two_lengths("--stock", ",".join(rest), unit, remedy)
    return given | {"side": side, "top": top}


def read_program_zero(text: str, unit: Unit) -> tuple[float, float]:
    """Return the point (x, y) in mm of the part at which the program has X0 Y0, from two lengths."""
    return read_two_lengths("--zero", text, unit, "a place here: give two lengths, such as 10,5.")


def read_program_zero_on_part(workpiece: Workpiece | None, text: str, unit: Unit) -> tuple[float, float]:
    """Return the point (x, y) in mm on the part where the program has X0 Y0, from two lengths or a place's
    name.

    Places are named as on the setup sheet, such as "corner" or "hole 2". Raises InputError for a place that
    the part does not have, and for a named place where ``workpiece`` is None.
    """
    if workpiece is None or not text.strip()[:1].isalpha():
        return read_program_zero(text, unit)
    from workhold.model.setup import choose_part_zero

    return choose_part_zero(workpiece, text, unit).point


def make_reader_arguments(
    words: Any, unit: Unit, thickness: float | None, zero: tuple[float, float]
) -> dict[str, Any]:
    """Return keyword arguments of ``files.program.reader.read_program``.

    ``thickness`` and the part's point ``zero`` at X0 Y0 are in mm.

    Parameters
    ----------
    words : options of a program as attributes; an option without an attribute has its default.
    """
    from workhold.model.cutting_tool import CuttingData

    height = words.z_zero
    if height == "top" and thickness is None:
        # Of a part that nobody knows the top is where the program begins to count.
        height = "0"
    rows = [row for row in OF_PROGRAM if row.name not in BY_WORDS and hasattr(words, row.argument)]
    return read_words(rows, words, unit) | {
        "zero": zero,
        "z_zero": height if height in ("top", "bottom") else read_length("--z-zero", height, unit),
        "thickness": thickness,
        "called": CALLED,
        "cutting": CuttingData(**read_words(OF_CUTTING, words, unit)),
        "stock": None if words.stock is None else read_stock_arguments(words.stock, unit),
    }


@cache
def read_program_once(
    words: ProgramOptions, unit: Unit, thickness: float | None, zero: tuple[float, float]
) -> Program:
    """Return the program, read from its file and cached, after printing remarks.

    ``thickness`` and the part's point ``zero`` at X0 Y0 are in mm.
    """
    assert words.program is not None
    asked = make_reader_arguments(words, unit, thickness, zero)
    from workhold.files.program.reader import read_program

    program = read_program(words.program, words.tools, **asked)
    for note in program.notes:
        print_remark(note)
    return program
