"""The commands ``copies`` and ``drill``: copies of a part on one plate, and the plates of a vise's jaws."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from workhold.cli.commands import option, spread
from workhold.cli.options import SHOWN_UNIT, RankArgument, ResultArgument, asked_rank, result_with
from workhold.cli.outputs import (
    FORCE,
    JSON,
    asked_picture,
    print_json,
    print_written,
    refuse_output,
    write_picture,
)
from workhold.cli.table import Table, print_tables
from workhold.cli.toolkit_options import ToolkitWords
from workhold.cli.values import (
    length,
    length_from_zero,
    length_unit,
    optional_count,
    optional_positive_length,
    positive_number,
)
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.family.copies import Packing
    from workhold.model.dowels import Bolts
    from workhold.model.fixture import Fixture
    from workhold.model.result import Result
    from workhold.units import Unit

__all__ = ["copies", "drill"]


def copies(
    result_file: ResultArgument,
    number: RankArgument,
    columns: str | None = option(
        None, "N", "Columns of holes of the plate; must be given where the result does not say."
    ),
    rows: str | None = option(
        None, "N", "Rows of holes of the plate; must be given where the result does not say."
    ),
    gap: str = option(
        None, "LENGTH", "Smallest distance between a part and anything of another copy.", default="1mm"
    ),
    time_limit: str = option(None, "SECONDS", "How long to prove that no more fit.", default="60"),
    draw: str | None = option(
        None, "FILE", "Draw the plate into this file, whose name ends in .svg or .png."
    ),
    force: bool = FORCE,
    unit: str | None = SHOWN_UNIT,
    json_: bool = JSON,
) -> None:
    """Report how many copies of fixture N a plate holds at once, and where each stands.

    The fixture is repeated by whole columns and rows, so that parts, pegs and clamps of the copies are clear
    of each other.

    Example: workhold copies part.json 1 --columns 20 --rows 15 --draw plate.png
    """
    rank = asked_rank(number)
    shown = length_unit(unit)
    asked = optional_count("--columns", columns), optional_count("--rows", rows)
    apart = length_from_zero("--gap", gap, shown)
    seconds = positive_number("--time-limit", time_limit)
    picture = asked_picture(draw, (result_file,), force)
    from workhold.family.copies import copies_of, draw_copies, packing_of
    from workhold.fixels.making import refuse_many_holes

    result = result_with(result_file, rank)
    size = plate_size(result, asked)
    refuse_many_holes(*size, result.toolkit.noun)
    packing = packing_of(result[rank - 1], result.workpiece, result.toolkit, *size, apart, seconds)
    row = result.table.take(slice(rank - 1, rank))
    found = copies_of(row, result.toolkit, result.workpiece, packing)
    if picture is not None:
        write_picture(picture, draw_copies(found, result.workpiece, result.toolkit, size, unit=shown))
    written = [] if draw is None else [draw]
    if json_:
        places = [{"columns": i, "rows": j} for i, j in packing.shifts]
        print_json(copies=len(found), at_most=packing.at_most, shifts=places, written=written)
        return
    print_copies(found, packing, result, size, shown)
    if written:
        print_tables(f"Written to {draw}.")


def plate_size(result: Result, asked: tuple[int | None, int | None]) -> tuple[int, int]:
    """Returns columns and rows of the plate: those asked for, or those of the result."""
    plate = result.toolkit.carriers[0]
    columns, rows = asked[0] or plate.columns, asked[1] or plate.rows
    if columns is None or rows is None:
        missing = "columns" if columns is None else "rows"
        raise InputError(f"how large the plate is, is not known: give --{missing}.")
    return columns, rows


def print_copies(
    found: list[Fixture], packing: Packing, result: Result, size: tuple[int, int], unit: Unit
) -> None:
    from workhold.model.setup import part_zero

    zero = part_zero(result.workpiece)
    table = Table((">copy", f">X0 at x {unit.abbreviation}", f">Y0 at y {unit.abbreviation}", "holes"))
    for number, fixture in enumerate(found, 1):
        x, y = fixture.pose.apply(*zero.point)
        holes = ", ".join(peg.hole for peg in fixture.placed)
        table.add_row(str(number), unit.number(x), unit.number(y), holes)
    proven = "no more fit" if packing.at_most == len(found) else f"at most {packing.at_most} fit"
    count = "1 copy" if len(found) == 1 else f"{len(found)} copies"
    sentence = (
        f"{count} on a plate of {size[0]} columns and {size[1]} rows; {proven} by repeating this fixture."
    )
    print_tables(table, sentence, f"X0 Y0 is the {zero.words}.")


PLATES = "The plates"
ENDINGS = (".dxf", ".step", ".stp")


@spread
def drill(
    *,
    out: Annotated[
        str,
        typer.Option(
            "--out", "-o", metavar="FILE", help="The file to write; its name ends in .dxf or .step."
        ),
    ],
    force: bool = FORCE,
    held_in: ToolkitWords,
    bolts: str | None = option(
        PLATES, "X,Y;X,Y", "Where bolts hold each plate, from the centre of its hole A1: 5,-12;5,112."
    ),
    bolt_diameter: str | None = option(PLATES, "LENGTH", "Diameter of the holes for the bolts."),
    hole_diameter: str | None = option(
        PLATES,
        "LENGTH",
        "Diameter of the dowel holes; the middle of what --vise says, or that of the pegs, if not given.",
    ),
    edge: str | None = option(
        PLATES, "LENGTH", "From the outermost dowel holes to the plate's edges; half a pitch if not given."
    ),
    thickness: str | None = option(
        PLATES, "LENGTH", "Thickness of the plates in a .step file; 10 mm if not given."
    ),
    unit: str | None = SHOWN_UNIT,
    json_: bool = JSON,
) -> None:
    """Write the plates of a vise's jaws with their dowel holes and bolt holes, to drill them from.

    Holes that are blocked are not drilled. The file is in mm, the plates side by side.

    Example: workhold drill --vise plate-20mm --rows 6 --bolts '10,10;10,90' --bolt-diameter 6.6 -o plates.dxf
    """
    path, shown = Path(out), length_unit(unit)
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise InputError(f"-o {path} names no drawing of plates: let the name end in .dxf or .step.")
    bolted = asked_bolts(bolts, bolt_diameter, shown)
    diameter = optional_positive_length("--hole-diameter", hole_diameter, shown)
    distance = optional_positive_length("--edge", edge, shown)
    thick = optional_positive_length("--thickness", thickness, shown)
    refuse_output(path, (held_in.vise,), force)
    toolkit, tolerance = held_in.asked(shown)
    if any(carrier.rows is None or carrier.columns is None for carrier in toolkit.carriers):
        raise InputError(
            "how many columns and rows of holes the plates have is not given: add --columns and --rows."
        )
    if diameter is None and tolerance is not None and tolerance.fit is not None:
        diameter = sum(tolerance.fit.hole) / 2
    from workhold.model.dowels import jaw_plates

    made = jaw_plates(toolkit, hole_diameter=diameter, edge=distance, bolts=bolted, unit=shown)
    if ending == ".dxf":
        from workhold.files.dxf.writer import plates_dxf

        content = plates_dxf(made)
    else:
        from workhold.files.step.writer import plates_step

        content = plates_step(made, thick)
    from workhold.files.atomic import write_bytes

    write_bytes(path, content)
    print_written(json_, f"Written to {path}.", path)


def asked_bolts(places: str | None, diameter: str | None, unit: Unit) -> Bolts | None:
    """Reads the bolts asked for; None where there are none, and refuses one of the two options alone."""
    if places is None and diameter is None:
        return None
    size = optional_positive_length("--bolt-diameter", diameter, unit)
    if places is None or size is None:
        raise InputError("bolts need --bolts and --bolt-diameter: give both, or neither.")
    from workhold.model.dowels import Bolts

    points = []
    for words in places.split(";"):
        numbers = words.split(",")
        if len(numbers) != 2:
            raise InputError(f"--bolts {places!r} is no list of places: give X,Y;X,Y, such as 5,-12;5,112.")
        x, y = (length("--bolts", number, unit) for number in numbers)
        points.append((x, y))
    return Bolts(size, tuple(points))
