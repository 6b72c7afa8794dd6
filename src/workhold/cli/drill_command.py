"""``workhold drill``: the plates of a vise's jaws, to drill them from."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from workhold.cli.commands import option, spread
from workhold.cli.json_output import JsonOption, print_written
from workhold.cli.options import SHOWN_UNIT
from workhold.cli.outputs import ForceOption, refuse_output
from workhold.cli.toolkit_options import ToolkitWords
from workhold.cli.values import length, length_unit, optional_positive_length
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.model.jaw_plate import Bolts
    from workhold.units import Unit

__all__ = ["drill"]

PLATES = "The plates"
ENDINGS = (".dxf", ".step", ".stp")


@spread
def drill(
    *,
    out: Annotated[
        str, typer.Option("--out", "-o", metavar="FILE", help="The file to write; its name ends in .dxf or .step.")
    ],
    force: ForceOption = False,
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
    thickness: str | None = option(PLATES, "LENGTH", "Thickness of the plates in a .step file; 10 mm if not given."),
    unit: str | None = SHOWN_UNIT,
    json_: JsonOption = False,
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
        raise InputError("how many columns and rows of holes the plates have is not given: add --columns and --rows.")
    if diameter is None and tolerance is not None and tolerance.fit is not None:
        diameter = sum(tolerance.fit.hole) / 2
    from workhold.model.jaw_plate import jaw_plates

    made = jaw_plates(toolkit, hole_diameter=diameter, edge=distance, bolts=bolted, unit=shown)
    if ending == ".dxf":
        from workhold.files.dxf.plates import write_plates_dxf

        write_plates_dxf(made, path)
    else:
        from workhold.files.step.plates import write_plates_step

        write_plates_step(made, path, thick)
    print_written(json_, f"Written to {path}.", path)


def asked_bolts(places: str | None, diameter: str | None, unit: Unit) -> Bolts | None:
    """The bolts asked for; None where there are none.

    Raises
    ------
    InputError
        For words that mean nothing, and one of the two options without the other.
    """
    if places is None and diameter is None:
        return None
    size = optional_positive_length("--bolt-diameter", diameter, unit)
    if places is None or size is None:
        raise InputError("bolts need --bolts and --bolt-diameter: give both, or neither.")
    from workhold.model.jaw_plate import Bolts

    points = []
    for words in places.split(";"):
        numbers = words.split(",")
        if len(numbers) != 2:
            raise InputError(f"--bolts {places!r} is no list of places: give X,Y;X,Y, such as 5,-12;5,112.")
        x, y = (length("--bolts", number, unit) for number in numbers)
        points.append((x, y))
    return Bolts(size, tuple(points))
