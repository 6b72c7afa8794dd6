"""``workhold copies``: how many of one part a plate holds at once."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from workhold.cli.commands import option
from workhold.cli.json_output import JsonOption, print_json
from workhold.cli.options import SHOWN_UNIT
from workhold.cli.outputs import ForceOption, refuse_output
from workhold.cli.ranked import RankArgument, ResultArgument, asked_rank, result_with
from workhold.cli.values import length, length_unit, optional_count, picture_ending, positive_number
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.family.copies import Packing
    from workhold.model.fixture import Fixture
    from workhold.model.result import Result
    from workhold.units import Unit

__all__ = ["copies"]


def copies(
    result_file: ResultArgument,
    number: RankArgument,
    columns: str | None = option(
        None, "N", "Columns of holes of the plate; must be given where the result does not say."
    ),
    rows: str | None = option(None, "N", "Rows of holes of the plate; must be given where the result does not say."),
    gap: str = option(None, "LENGTH", "Smallest distance between a part and anything of another copy.", default="1mm"),
    time_limit: str = option(None, "SECONDS", "How long to prove that no more fit.", default="60"),
    draw: str | None = option(None, "FILE", "Draw the plate into this file, whose name ends in .svg or .png."),
    force: ForceOption = False,
    unit: str | None = SHOWN_UNIT,
    json_: JsonOption = False,
) -> None:
    """Tell how many copies of fixture N a plate holds at once, and where each stands.

    The fixture is repeated by whole columns and rows, so that parts, pegs and clamps of the copies are clear of each other.

    Example: workhold copies part.json 1 --columns 20 --rows 15 --draw plate.png
    """
    rank = asked_rank(number)
    shown = length_unit(unit)
    asked = optional_count("--columns", columns), optional_count("--rows", rows)
    apart = length("--gap", gap, shown)
    if apart < 0:
        raise InputError(f"--gap {gap} is negative: give 0 or more.")
    seconds = positive_number("--time-limit", time_limit)
    if draw is not None:
        picture_ending(Path(draw))
        refuse_output(draw, (result_file,), force)
    from workhold.family.copies import packing_of
    from workhold.family.copies_picture import copies_of, draw_copies
    from workhold.fixels.lattice import refuse_many_holes

    result = result_with(result_file, rank)
    size = plate_size(result, asked)
    refuse_many_holes(*size, result.toolkit.noun)
    packing = packing_of(result[rank - 1], result.workpiece, result.toolkit, *size, apart, seconds)
    row = result.table.take(slice(rank - 1, rank))
    found = copies_of(row, result.toolkit, result.workpiece, packing)
    if draw is not None:
        from workhold.drawing.render import render
        from workhold.files.atomic import write_bytes

        svg = draw_copies(found, result.workpiece, result.toolkit, size, unit=shown)
        write_bytes(draw, render(svg, Path(draw).suffix))
    written = [] if draw is None else [draw]
    if json_:
        places = [{"columns": i, "rows": j} for i, j in packing.shifts]
        print_json(copies=len(found), at_most=packing.at_most, shifts=places, written=written)
        return
    tell_copies(found, packing, result, size, shown)
    if written:
        from workhold.cli.tables import print_tables

        print_tables(f"Written to {draw}.")


def plate_size(result: Result, asked: tuple[int | None, int | None]) -> tuple[int, int]:
    """Columns and rows of the plate: those asked for, or those of the result.

    Raises
    ------
    InputError
        Where neither says.
    """
    plate = result.toolkit.carriers[0]
    size = [one if one is not None else own for one, own in zip(asked, (plate.columns, plate.rows), strict=True)]
    for name, count in zip(("columns", "rows"), size, strict=True):
        if count is None:
            raise InputError(f"how large the plate is, is not known: give --{name}.")
    return size[0] or 0, size[1] or 0


def tell_copies(found: list[Fixture], packing: Packing, result: Result, size: tuple[int, int], unit: Unit) -> None:
    """Tell how many copies there are, and where each stands."""
    from workhold.cli.tables import Table, print_tables
    from workhold.model.part_zero import part_zero

    zero = part_zero(result.workpiece)
    table = Table((">copy", f">X0 at x {unit.abbreviation}", f">Y0 at y {unit.abbreviation}", "holes"))
    for number, fixture in enumerate(found, 1):
        x, y = fixture.pose.apply(*zero.point)
        holes = ", ".join(peg.hole for peg in fixture.placed)
        table.add_row(str(number), unit.number(x), unit.number(y), holes)
    proven = "no more fit" if packing.at_most == len(found) else f"at most {packing.at_most} fit"
    count = "1 copy" if len(found) == 1 else f"{len(found)} copies"
    sentence = f"{count} on a plate of {size[0]} columns and {size[1]} rows; {proven} by repeating this fixture."
    print_tables(table, sentence, f"X0 Y0 is the {zero.words}.")
