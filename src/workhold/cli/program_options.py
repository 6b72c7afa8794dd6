"""Options of a program: where its zero is, how its tools cut, and that fixtures are to let it pass.

How tools cut is asked where the table of tools does not say it.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from attrs import evolve, fields, frozen

from workhold.cli.commands import option, print_remark, untyped
from workhold.cli.options import PartWords
from workhold.cli.values import (
    choice,
    in_unit,
    length,
    optional_force,
    optional_positive_length,
    three_lengths,
    two_lengths,
    whole_number,
)
from workhold.errors import InputError
from workhold.units import MILLIMETRE, Unit

if TYPE_CHECKING:
    from workhold.model.cutting_tool import CuttingData
    from workhold.model.program import Program
    from workhold.model.workpiece import Workpiece

__all__ = [
    "CUTTING_DIRECTION",
    "CUTTING_FORCE",
    "CUT_DEPTH",
    "CUT_WIDTH",
    "MATERIAL",
    "POWER",
    "SOLIDS",
    "ProgramWords",
    "START_WORDS",
    "STOCK",
    "TEETH",
    "asked_reading",
    "asked_zero",
    "WHOLE_NUMBERS_WORDS",
]

FORCES = "Cutting forces"
CUTTING_FORCE = option(
    FORCES, "FORCE", "Force at the periphery of every tool whose own the table does not give, in N or 1.5kN."
)
POWER = option(FORCES, "KW", "Power at the spindle, from which the force follows by S; also 3hp.")
MATERIAL = option(
    FORCES,
    "NAME|KC,MC",
    "What is cut, such as steel, stainless, cast-iron, aluminium, brass or titanium, or kc1.1 in N/mm2 and "
    "mc: the force follows from F, S, teeth and the cut.",
)
TEETH = option(FORCES, "N", "Teeth of every tool whose own the table does not give.")
CUT_DEPTH = option(FORCES, "LENGTH", "How deep tools cut at most at once, along their axes.")
CUT_WIDTH = option(FORCES, "LENGTH", "How broad they cut, across the feed; the tool's diameter if not given.")
CUTTING_DIRECTION = option(
    FORCES,
    "any|feed",
    "Whether a force may act in any direction, or within 60 degrees of against the feed; any if not given.",
)
STOCK = option(
    FORCES,
    "SHAPE,SIDE,TOP",
    "What the part is cut from, on which alone tools press: its outline, or the block around it, with so much "
    "around and on top; outline,5,5 if not given. Give block, 0,0 or block,2,1.",
)
POWER_WORDS = re.compile(r"\s*(?P<number>.*?)\s*(?P<unit>kW|hp)?\s*", re.IGNORECASE | re.DOTALL)
# kW in a unit; 550 foot-pounds a second.
POWERS = {"kw": 1.0, "hp": 0.7456998715822702}
PROGRAM = "The program"
START_WORDS = "Where the tip is at its start, from its own zero, where the program does not say it."
WHOLE_NUMBERS_WORDS = (
    "What its lengths without a decimal point count; thousandths are 0.001 mm or 0.0001 inch."
)
# What the questions of a program's reader are called here.
CALLED = {"start": "--start X,Y,Z"}
SOLIDS = (".step", ".stp")


@frozen
class ProgramWords:
    """The options of a program, as typed; None for those not given."""

    program: str | None = option(
        PROGRAM,
        "FILE",
        "List only fixtures that the tools of this program (G-code) keep clear of; see workhold program.",
    )
    tools: str | None = option(
        PROGRAM,
        "FILE",
        "Table of its tools: TOML, CSV, or LinuxCNC's; what the program's comments say if not given.",
    )
    zero: str = option(
        PROGRAM,
        "PLACE",
        "Where its X0 Y0 is on the part: corner (lower left, as drawn), centre, hole N, or X,Y of the drawing.",
        default="0,0",
    )
    z_zero: str = option(
        PROGRAM, "top|bottom|LENGTH", "Where its Z0 is: a side of the part, or a height.", default="top"
    )
    program_clearance: str = option(
        PROGRAM, "LENGTH", "What tools keep from pegs, clamps and walls.", default="1mm"
    )
    rapid: str = option(
        PROGRAM,
        "straight|box",
        "Whether its rapid moves are straight, or may go anywhere in the box of their ends.",
        default="straight",
    )
    program_unit: str | None = option(PROGRAM, "mm|inch", "Unit of a program without G20 and G21.")
    start: str | None = option(PROGRAM, "X,Y,Z", START_WORDS)
    whole_numbers: str = option(PROGRAM, "units|thousandths", WHOLE_NUMBERS_WORDS, default="units")
    cutting_force: str | None = CUTTING_FORCE
    power: str | None = POWER
    material: str | None = MATERIAL
    teeth: str | None = TEETH
    cut_depth: str | None = CUT_DEPTH
    cut_width: str | None = CUT_WIDTH
    cutting_direction: str | None = CUTTING_DIRECTION
    stock: str | None = STOCK
    thickness: str | None = option(
        PROGRAM,
        "LENGTH",
        "How thick the part is; that of its solid if not given. Pegs are as high, or as --peg-height says.",
    )

    @property
    def files(self) -> tuple[str | None, ...]:
        return self.program, self.tools

    @property
    def has_forces(self) -> bool:
        """Whether the forces of the tools are asked for, of all or in their table."""
        if self.program is None:
            return False
        if any(word is not None for word in (self.cutting_force, self.power, self.material)):
            return True
        if self.tools is None:
            return False
        from workhold.files.program.tool_tables import read_tools

        tools, _ = read_tools(self.tools, MILLIMETRE)
        return any(tool.cutting.asks_for_forces for tool in tools.values())

    def reading(self, part: str, reading: PartWords) -> PartWords:
        """How a part is read: of a drawing the peg height is no question of the reader but of the fixtures."""
        is_drawing = Path(part).suffix.lower() not in SOLIDS
        return evolve(reading, peg_height=None) if is_drawing else reading

    def asked(self, unit: Unit, peg_height: str | None, workpiece: Workpiece | None = None) -> dict[str, Any]:
        """Keyword arguments of a query; reads the program, and prints remarks on it on stderr.

        Parameters
        ----------
        peg_height : as typed.
        workpiece : for the heights of its solid; None where it is not known yet.

        Raises
        ------
        InputError
            For words that mean nothing, a program that cannot be read, and heights that are needed and not
            given; for words about a program without one.
        """
        if self.program is None:
            # Of a thickness other options make use as well.
            usual = untyped(ProgramWords, thickness=self.thickness)
            given = [
                one.name
                for one in fields(ProgramWords)
                if getattr(self, one.name) != getattr(usual, one.name)
            ]
            if given:
                raise InputError(
                    f"--{given[0].replace('_', '-')} says something of a program: name it with --program."
                )
        solid = None if workpiece is None else workpiece.solid
        if self.program is None:
            # Of a part that is read later nobody knows yet whether it has heights of its own.
            return self.heights(unit, peg_height) if workpiece is not None and solid is None else {}
        thick, high = self.heights(unit, peg_height).values()
        if solid is not None:
            thick, high = thick or solid.height, solid.peg_height
        if thick is None and (self.z_zero == "top" or high is None):
            raise InputError(
                "the part is an outline without heights, so nobody knows what of --program passes over the "
                "pegs: give its --thickness, and --peg-height where pegs are not as high."
            )
        zero = zero_on(workpiece, self.zero, unit)
        heights = {"thickness": None if solid is not None else thick, "peg_height": high or thick}
        return {"program": read_once(self, unit, thick, zero), **heights}

    def heights(self, unit: Unit, peg_height: str | None) -> dict[str, float | None]:
        """The thickness of a drawn part and the height of the pegs in mm, None where they are not given.

        Raises
        ------
        InputError
            For what is no length above 0.
        """
        return {
            "thickness": optional_positive_length("--thickness", self.thickness, unit),
            "peg_height": optional_positive_length("--peg-height", peg_height, unit),
        }


def asked_cutting(typed: ProgramWords, unit: Unit) -> CuttingData:
    from workhold.model.cutting_tool import CuttingData

    given: dict[str, Any] = {
        "cutting_force": no_force(typed.cutting_force),
        "power": asked_power(typed.power),
        "material": typed.material,
        "teeth": None if typed.teeth is None else whole_number("--teeth", typed.teeth),
        "cut_depth": optional_positive_length("--cut-depth", typed.cut_depth, unit),
        "cut_width": optional_positive_length("--cut-width", typed.cut_width, unit),
        "direction": None,
    }
    if typed.cutting_direction is not None:
        given["direction"] = choice("--cutting-direction", typed.cutting_direction, ("any", "feed"))
    return CuttingData(**given)


def asked_stock(text: str, unit: Unit) -> dict[str, Any]:
    """What the part is cut from, as ``model.stock.Stock.of`` takes it.

    Examples
    --------
    >>> asked_stock("block", MILLIMETRE), asked_stock("0,2", MILLIMETRE)
    ({'shape': 'block'}, {'side': 0.0, 'top': 2.0})
    """
    first, *rest = (word.strip() for word in text.split(","))
    given: dict[str, Any] = {}
    if first[:1].isalpha():
        given["shape"] = choice("--stock", first, ("outline", "block"))
        if not rest:
            return given
    else:
        rest = [first, *rest]
    remedy = "the stock: give outline or block, what it has around and on top, such as 0,2, or block,0,2."
    side, top = two_lengths("--stock", ",".join(rest), unit, remedy)
    return given | {"side": side, "top": top}


def no_force(text: str | None) -> float | None:
    """A cutting force in N, 0 included; None where it is not given."""
    return 0.0 if text is not None and text.strip() == "0" else optional_force("--cutting-force", text)


def asked_power(text: str | None) -> float | None:
    """A power in kW, or None where it is not given.

    Examples
    --------
    >>> asked_power("2.2"), round(asked_power("3 hp"), 3)
    (2.2, 2.237)
    """
    if text is None:
        return None
    remedy = "a power above 0: give it in kW, such as 2.2, or as 3hp."
    return in_unit("--power", text, POWER_WORDS, POWERS, "kw", remedy)


def asked_zero(text: str, unit: Unit) -> tuple[float, float]:
    """The place of the program's zero on the part, in mm."""
    return two_lengths("--zero", text, unit, "a place here: give two lengths, such as 10,5.")


def zero_on(workpiece: Workpiece | None, text: str, unit: Unit) -> tuple[float, float]:
    """The place of the program's zero in mm, which the part's own places may name as on the setup sheet.

    Refuses a place that the part does not have, or that is named where no part is known.
    """
    if workpiece is None or not text.strip()[:1].isalpha():
        return asked_zero(text, unit)
    from workhold.model.setup import part_zero

    return part_zero(workpiece, text, unit).point


def asked_reading(
    words: ProgramWords, unit: Unit, thickness: float | None, zero: tuple[float, float]
) -> dict[str, Any]:
    """Keyword arguments of ``files.program.reader.read_program``; ``thickness`` and ``zero`` are in mm."""
    named, height = words.program_unit, words.z_zero
    if height == "top" and thickness is None:
        # Of a part that nobody knows the top is where the program begins to count.
        height = "0"
    place = "a place: give three lengths, such as 0,0,50."
    return {
        "unit": None if named is None else choice("--program-unit", named, ("mm", "inch")),
        "zero": zero,
        "z_zero": height if height in ("top", "bottom") else length("--z-zero", height, unit),
        "thickness": thickness,
        "rapid": choice("--rapid", words.rapid, ("straight", "box")),
        "start": None if words.start is None else three_lengths("--start", words.start, unit, place),
        "whole_numbers": choice("--whole-numbers", words.whole_numbers, ("units", "thousandths")),
        "called": CALLED,
        "cutting": asked_cutting(words, unit),
        "stock": None if words.stock is None else asked_stock(words.stock, unit),
    }


@cache
def read_once(words: ProgramWords, unit: Unit, thickness: float | None, zero: tuple[float, float]) -> Program:
    """Reads the program, and prints remarks on it; ``thickness`` of the part and ``zero`` in mm."""
    assert words.program is not None
    kept = length("--program-clearance", words.program_clearance, unit)
    asked = asked_reading(words, unit, thickness, zero)
    from workhold.files.program.reader import read_program

    program = read_program(words.program, words.tools, clearance=kept, **asked)
    for note in program.notes:
        print_remark(note)
    return program
