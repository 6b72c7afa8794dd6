"""The command ``program``: shows how workhold has read a program for the machine, as tables and as a picture."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Annotated, Any

import typer
from attrs import asdict, evolve, frozen

from workhold.cli.commands import make_option, spread_option_groups
from workhold.cli.declared import make_option_attributes, make_word_attribute
from workhold.cli.options import SHOWN_UNIT
from workhold.cli.outputs import FORCE, JSON, print_json, read_picture_path, write_picture
from workhold.cli.program_options import (
    OF_CUTTING,
    OF_PROGRAM,
    STOCK,
    make_reader_arguments,
    read_program_zero,
)
from workhold.cli.table import Table, print_tables
from workhold.cli.values import read_optional_positive_length, read_unit

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from workhold.files.program.reader import ReadProgram
    from workhold.model.cutting_forces import CuttingForces
    from workhold.model.program import Program
    from workhold.units import Unit

__all__ = ["program"]

PLACE, READING = "Where it runs", "How to read it"


# What is asked beside a part, in the words and sections of a program alone.
OWN: dict[str, dict[str, Any]] = {
    "zero": {
        "section": PLACE,
        "typed": "Point of the part at which the program has X0 Y0.",
        "metavar": "X,Y",
    },
    "z_zero": {"section": PLACE},
    "rapid": {
        "typed": "Path of rapid moves: straight, or anywhere in the box between their ends.",
        "section": READING,
    },
}
ORDER = ("unit", "rapid", "start", "whole_numbers", "zero", "z_zero")
OF_RUN = [
    evolve(row, **{"section": READING} | OWN.get(row.name, {}))
    for row in sorted((row for row in OF_PROGRAM if row.name in ORDER), key=lambda row: ORDER.index(row.name))
]
RUN_TOOLS = make_option(
    READING, "FILE", "Table of tools: TOML, CSV, or LinuxCNC's; the program's comments if not given."
)
RUN_THICKNESS = make_option(
    PLACE, "LENGTH", "Thickness of the part. Without it, heights count from the program's zero."
)


@frozen(
    these=make_option_attributes(
        (*OF_RUN, *OF_CUTTING),
        unit={"tools": make_word_attribute(RUN_TOOLS)},
        cutting_force={"thickness": make_word_attribute(RUN_THICKNESS)},
        stock=make_word_attribute(STOCK),
    )
)
class ProgramViewOptions:
    """The options of a program that is shown by itself, as typed."""

    if TYPE_CHECKING:
        tools: str | None
        thickness: str | None
        zero: str
        z_zero: str
        stock: str | None


@spread_option_groups
def program(
    program_file: Annotated[
        str, typer.Argument(metavar="PROGRAM", help="A program of RS-274 (G-code), for the mill.")
    ],
    *,
    words: ProgramViewOptions,
    draw: str | None = make_option(None, "FILE", "Draw the paths of the tools (.svg or .png)."),
    force: bool = FORCE,
    unit: str | None = SHOWN_UNIT,
    json_: bool = JSON,
) -> None:
    """Report how workhold reads a program for the mill: tools, lengths, heights, time, lines left out.

    A program that cannot be read is refused with the line. The command does not search, and needs no part.

    Example: workhold program bracket.nc --tools tools.toml --draw bracket.png
    """
    shown = read_unit(unit)
    picture = read_picture_path(draw, (program_file, words.tools), force)
    height = read_optional_positive_length("--thickness", words.thickness, shown)
    asked = make_reader_arguments(words, shown, height, read_program_zero(words.zero, shown))
    from workhold.files.program.reader import read_program_with_calls

    read = read_program_with_calls(program_file, words.tools, **asked)
    if picture is not None:
        from workhold.drawing.program_picture import draw_program

        write_picture(picture, draw_program(read.program, unit=shown))
    if json_:
        print_json(**convert_program_to_data(read), written=[str(picture)] if picture else [])
        return
    report(read, shown, from_z_zero=words.z_zero == "top" and height is None)
    if picture is not None:
        print_tables(f"Written to {picture}.")


def convert_program_to_data(read: ReadProgram) -> dict[str, Any]:
    """Return the program as it was read, as plain data; lengths in mm."""
    from workhold.model.program_figures import bound_tip, measure_tools

    program = read.program
    low, high = bound_tip(program.moves)
    return {
        **program.make_head(),
        "lines": read.lines,
        "moves": len(program.moves),
        "calls": [{"line": line, "tool": number} for line, number in read.calls],
        "tip": {"low": low.tolist(), "high": high.tolist()},
        "figures": [asdict(one) for one in measure_tools(program)],
        **(
            {}
            if program.forces is None
            else {"cutting": list_tool_forces(program.forces, program.moves.tool)}
        ),
    }


def list_tool_forces(forces: CuttingForces, tool: NDArray[np.int64]) -> list[dict[str, Any]]:
    """Return for each tool, in order of first use, its largest force and torque and its least and largest
    axial force.

    ``tool`` (M,) has the tool's number for each of the program's M moves; forces are in N, torques in N mm.
    """
    return [
        {
            "tool": number,
            "force": float(forces.force[tool == number].max()),
            "torque": float(forces.torque[tool == number].max()),
            "axial": [
                float(forces.axial[tool == number, 0].min()),
                float(forces.axial[tool == number, 1].max()),
            ],
        }
        for number in dict.fromkeys(tool.tolist())
    ]


def tabulate_tool_forces(program: Program, unit: Unit) -> list[Table | str]:
    """Return a table of the forces of each tool and sentences about them; [] where no forces are known."""
    forces = program.forces
    if forces is None:
        return []
    table = Table(("tool", f">across {unit.force}", ">torque", f">down {unit.force}", f">up {unit.force}"))
    for one in list_tool_forces(forces, program.moves.tool):
        up, down = -min(one["axial"][0], 0.0), max(one["axial"][1], 0.0)
        table.add_row(
            f"T{one['tool']}",
            unit.format_force_rounded_up(one["force"]),
            unit.format_moment(one["torque"]),
            unit.format_force_rounded_up(down),
            unit.format_force_rounded_up(up),
        )
    where = "in any direction" if forces.direction == "any" else "within 60 degrees of against the feed"
    said = forces.describe_tools(program.moves, program.tools).values()
    return [
        "",
        table,
        f"Forces on the part act {where}, at the tool's periphery.",
        *said,
        describe_stock(program, unit),
    ]


def describe_stock(program: Program, unit: Unit) -> str:
    """Return a sentence on the stock; tools press only where they meet it."""
    stock = program.stock
    assert stock is not None
    shape = "the part's outline" if stock.shape == "outline" else "the block around the part"
    around = f"{shape} with {unit.format_length(stock.side)} around"
    if stock.height is None:
        return f"Only cuts that meet the stock count: {around}."
    return f"Only cuts that meet the stock count: {around} and {unit.format_length(stock.top)} on top."


def report(read: ReadProgram, unit: Unit, from_z_zero: bool) -> None:
    """Print the figures of each tool and a summary.

    ``from_z_zero`` tells that heights are measured from the program's Z0.
    """
    from workhold.model.program_figures import bound_tip, measure_tools

    program = read.program
    figures = measure_tools(program)
    calls = Counter(number for _, number in read.calls)
    short = unit.abbreviation
    table = Table(
        (
            "tool",
            f">Ø {short}",
            "name",
            ">calls",
            ">first line",
            f">cutting {short}",
            f">rapid {short}",
            ">time cutting",
            f">lowest cut {short}",
        )
    )
    for one in figures:
        tool = program.tools[one.tool]
        table.add_row(
            f"T{one.tool}",
            unit.format_number(tool.diameter),
            tool.name,
            str(calls[one.tool]),
            str(one.first_line),
            unit.format_number(one.cutting, 0 if unit.millimetres == 1 else 1),
            unit.format_number(one.rapid, 0 if unit.millimetres == 1 else 1),
            # A plus sign stands behind a time where some moves have no feed.
            format_time(one.seconds) + ("+" if one.untimed else ""),
            "" if one.lowest_cut is None else unit.format_number(one.lowest_cut),
        )
    low, high = bound_tip(program.moves)
    spans = ", ".join(
        f"{axis} {unit.format_number(one)} to {unit.format_number(other)}"
        for axis, one, other in zip("XYZ", low.tolist(), high.tolist(), strict=True)
    )
    above = "the program's Z0" if from_z_zero else "the part's lower side"
    total = sum(one.seconds for one in figures)
    print_tables(
        f"{program.name}: {read.lines:,} lines in {program.unit}, {len(program.moves):,} moves.",
        table,
        f"The tips go from {spans} {short}; heights are above {above}.",
        f"Cutting takes {format_time(total)} at the program's feeds; rapid moves, dwells and tool "
        "changes come on top.",
        *program.notes,
        *tabulate_tool_forces(program, unit),
    )


def format_time(seconds: float) -> str:
    """Return seconds as text, "minutes:seconds" or "hours:minutes:seconds".

    >>> format_time(75.4), format_time(3675)
    ('1:15', '1:01:15')
    """
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"
