"""The commands ``copies`` and ``drill``: copies of a part on one plate, and the plates of a vise's jaws."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from attrs import frozen

from workhold.cli.commands import make_option, spread_option_groups
from workhold.cli.options import SHOWN_UNIT, RankArgument, ResultArgument, read_rank, read_result_with_rank
from workhold.cli.outputs import (
    FORCE,
    JSON,
    print_json,
    print_written,
    read_picture_path,
    refuse_output,
    write_picture,
)
from workhold.cli.table import Table, print_tables
from workhold.cli.toolkit_options import ToolkitOptions
from workhold.cli.values import (
    read_length,
    read_length_from_zero,
    read_optional_count,
    read_optional_positive_length,
    read_positive_number,
    read_unit,
)
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.family.copies import PackedCopies
    from workhold.model.dowels import Bolts, JawPlate
    from workhold.model.fixture import Fixture
    from workhold.model.result import Result
    from workhold.units import Unit

__all__ = ["copies", "drill"]


@frozen
class CopiesOptions:
    """The options of a plate with copies of a fixture, as typed."""

    columns: str | None = make_option(
        None, "N", "Columns of holes of the plate; must be given where the result does not say."
    )
    rows: str | None = make_option(
        None, "N", "Rows of holes of the plate; must be given where the result does not say."
    )
    gap: str = make_option(
        None, "LENGTH", "Smallest distance between a part and anything of another copy.", default="1mm"
    )
    time_limit: str = make_option(None, "SECONDS", "How long to prove that no more fit.", default="60")
    draw: str | None = make_option(
        None, "FILE", "Draw the plate into this file, whose name ends in .svg or .png."
    )
    force: bool = FORCE
    unit: str | None = SHOWN_UNIT
    json_: bool = JSON


@frozen
class CopiesTask:
    """A plate to be filled with copies of a fixture.

    Parameters
    ----------
    size : columns and rows of the plate.
    gap : least distance between the copies, in mm.
    seconds : time limit for the proof that no more copies fit.
    unit : of lengths shown.
    """

    result: Result
    rank: int
    size: tuple[int, int]
    gap: float
    seconds: float
    picture: Path | None
    words: CopiesOptions
    unit: Unit


@spread_option_groups
def copies(result_file: ResultArgument, number: RankArgument, *, words: CopiesOptions) -> None:
    """Report how many copies of fixture N a plate holds at once, and the place of each.

    The command repeats the fixture by whole columns and rows, so that the parts, pegs and clamps of the
    copies keep clear of each other.

    Example: workhold copies part.json 1 --columns 20 --rows 15 --draw plate.png
    """
    asked = parse_copies(result_file, read_rank(number), words)
    report_copies(asked, *ask_copies(asked))


def parse_copies(result_file: str, rank: int, words: CopiesOptions) -> CopiesTask:
    """Return what was typed as a task, with the result read."""
    shown = read_unit(words.unit)
    size = read_optional_count("--columns", words.columns), read_optional_count("--rows", words.rows)
    gap = read_length_from_zero("--gap", words.gap, shown)
    seconds = read_positive_number("--time-limit", words.time_limit)
    picture = read_picture_path(words.draw, (result_file,), words.force)
    result = read_result_with_rank(result_file, rank)
    return CopiesTask(result, rank, choose_plate_size(result, size), gap, seconds, picture, words, shown)


def ask_copies(asked: CopiesTask) -> tuple[list[Fixture], PackedCopies]:
    """Return the copies of a fixture that fit on the plate, and the packing, which says what is proven."""
    from workhold.family.copies import make_copies, pack_copies

    result, rank = asked.result, asked.rank
    held = result.workpiece, result.toolkit
    packing = pack_copies(result[rank - 1], *held, *asked.size, asked.gap, asked.seconds)
    row = result.table.take(slice(rank - 1, rank))
    return make_copies(row, result.toolkit, result.workpiece, packing), packing


def report_copies(asked: CopiesTask, found: list[Fixture], packing: PackedCopies) -> None:
    """Print where the copies stand, and draw the plate if asked."""
    result, draw = asked.result, asked.words.draw
    if asked.picture is not None:
        from workhold.family.copies import draw_copies

        svg = draw_copies(found, result.workpiece, result.toolkit, asked.size, unit=asked.unit)
        write_picture(asked.picture, svg)
    if asked.words.json_:
        places = [{"columns": i, "rows": j} for i, j in packing.shifts]
        written = [] if draw is None else [draw]
        print_json(copies=len(found), at_most=packing.at_most, shifts=places, written=written)
        return
    print_copies(found, packing, result, asked.size, asked.unit)
    if draw is not None:
        print_tables(f"Written to {draw}.")


def choose_plate_size(result: Result, asked: tuple[int | None, int | None]) -> tuple[int, int]:
    """Return columns and rows of the plate as typed, else those of the result;
    raise InputError where neither is known.
    """
    from workhold.fixels.making import refuse_many_holes

    plate = result.toolkit.carriers[0]
    columns, rows = asked[0] or plate.columns, asked[1] or plate.rows
    if columns is None or rows is None:
        missing = "columns" if columns is None else "rows"
        raise InputError(f"how large the plate is, is not known: give --{missing}.")
    refuse_many_holes(columns, rows, result.toolkit.noun)
    return columns, rows


def print_copies(
    found: list[Fixture], packing: PackedCopies, result: Result, size: tuple[int, int], unit: Unit
) -> None:
    """Print a table of the copies and whether more could fit."""
    from workhold.model.setup import choose_part_zero

    zero = choose_part_zero(result.workpiece)
    table = Table((">copy", f">X0 at x {unit.abbreviation}", f">Y0 at y {unit.abbreviation}", "holes"))
    for number, fixture in enumerate(found, 1):
        x, y = fixture.pose.apply(*zero.point)
        holes = ", ".join(peg.hole for peg in fixture.placed)
        table.add_row(str(number), unit.format_number(x), unit.format_number(y), holes)
    proven = "no more fit" if packing.at_most == len(found) else f"at most {packing.at_most} fit"
    count = "1 copy" if len(found) == 1 else f"{len(found)} copies"
    sentence = (
        f"{count} on a plate of {size[0]} columns and {size[1]} rows; {proven} by repeating this fixture."
    )
    print_tables(table, sentence, f"X0 Y0 is the {zero.words}.")


PLATES = "The plates"
ENDINGS = (".dxf", ".step", ".stp")


@frozen
class DrillOptions:
    """The options of the plates, as typed; None for those not given."""

    bolts: str | None = make_option(
        PLATES, "X,Y;X,Y", "Where bolts hold each plate, from the centre of its hole A1: 5,-12;5,112."
    )
    bolt_diameter: str | None = make_option(PLATES, "LENGTH", "Diameter of the holes for the bolts.")
    hole_diameter: str | None = make_option(
        PLATES,
        "LENGTH",
        "Diameter of the dowel holes; the middle of what --vise says, or that of the pegs, if not given.",
    )
    edge: str | None = make_option(
        PLATES, "LENGTH", "From the outermost dowel holes to the plate's edges; half a pitch if not given."
    )
    thickness: str | None = make_option(
        PLATES, "LENGTH", "Thickness of the plates in a .step file; 10 mm if not given."
    )


@spread_option_groups
def drill(
    *,
    out: Annotated[
        str,
        typer.Option(
            "--out", "-o", metavar="FILE", help="The file to write; its name ends in .dxf or .step."
        ),
    ],
    force: bool = FORCE,
    held_in: ToolkitOptions,
    words: DrillOptions,
    unit: str | None = SHOWN_UNIT,
    json_: bool = JSON,
) -> None:
    """Write drawings of a vise's jaw plates with their dowel holes and bolt holes, to drill them by.

    Blocked holes are left out. The file is in mm, and the plates lie side by side.

    Example: workhold drill --vise plate-20mm --rows 6 --bolts '10,10;10,90' --bolt-diameter 6.6 -o plates.dxf
    """
    path, shown = Path(out), read_unit(unit)
    if path.suffix.lower() not in ENDINGS:
        raise InputError(f"-o {path} names no drawing of plates: let the name end in .dxf or .step.")
    thickness = read_optional_positive_length("--thickness", words.thickness, shown)
    refuse_output(path, (held_in.vise,), force)
    write_plates(path, make_asked_plates(held_in, words, shown), thickness)
    print_written(json_, f"Written to {path}.", path)


def make_asked_plates(held_in: ToolkitOptions, words: DrillOptions, unit: Unit) -> tuple[JawPlate, ...]:
    """Return the plates of the toolkit that was typed;
    raise InputError where columns or rows are not known.
    """
    bolts = read_bolts(words.bolts, words.bolt_diameter, unit)
    diameter = read_optional_positive_length("--hole-diameter", words.hole_diameter, unit)
    edge = read_optional_positive_length("--edge", words.edge, unit)
    toolkit, tolerance = held_in.read_toolkit(unit)
    if any(carrier.rows is None or carrier.columns is None for carrier in toolkit.carriers):
        raise InputError(
            "how many columns and rows of holes the plates have is not given: add --columns and --rows."
        )
    if diameter is None and tolerance is not None and tolerance.fit is not None:
        diameter = sum(tolerance.fit.hole) / 2
    from workhold.model.dowels import list_jaw_plates

    return list_jaw_plates(toolkit, hole_diameter=diameter, edge=edge, bolts=bolts, unit=unit)


def write_plates(path: Path, plates: tuple[JawPlate, ...], thickness: float | None) -> None:
    """Write plates as DXF or STEP by the path's ending; ``thickness`` in mm counts in STEP only."""
    from workhold.files.atomic import write_bytes

    if path.suffix.lower() == ".dxf":
        from workhold.files.dxf.writer import make_plates_dxf

        write_bytes(path, make_plates_dxf(plates))
    else:
        from workhold.files.step.writer import make_plates_step

        write_bytes(path, make_plates_step(plates, thickness))


def read_bolts(places: str | None, diameter: str | None, unit: Unit) -> Bolts | None:
    """Return the bolts asked for, in mm; None where neither option is given.
    Raise InputError for one option without the other.
    """
    if places is None and diameter is None:
        return None
    size = read_optional_positive_length("--bolt-diameter", diameter, unit)
    if places is None or size is None:
        raise InputError("bolts need --bolts and --bolt-diameter: give both, or neither.")
    from workhold.model.dowels import Bolts

    points = []
    for words in places.split(";"):
        numbers = words.split(",")
        if len(numbers) != 2:
            raise InputError(
                f"--bolts {places!r} is not a list of places: give X,Y;X,Y, such as 5,-12;5,112."
            )
        x, y = (read_length("--bolts", number, unit) for number in numbers)
        points.append((x, y))
    return Bolts(size, tuple(points))
