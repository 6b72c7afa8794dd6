"""Options about a fixture in three dimensions, and the GLB and STEP files that they ask for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from workhold.cli.commands import option, print_remark
from workhold.cli.outputs import refuse_output
from workhold.errors import InputError
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.model.requirements import Load
    from workhold.model.result import Result
    from workhold.presenting.assembly import Assembly

__all__ = [
    "BODY_THICKNESS",
    "GLB",
    "PART_FILE",
    "STEP",
    "SupportedOption",
    "asked_models",
    "write_bodies",
    "write_fixture",
]

GLB = option(None, "FILE", "Write it in three dimensions into this file, whose name ends in .glb.")
STEP = option(None, "FILE", "The same as a STEP assembly, for CAD and CAM; its name ends in .step.")
BODY_THICKNESS = option(
    None,
    "LENGTH",
    "Height of the part in the GLB and STEP; that of its solid, or 10 mm, if not given.",
)
PART_FILE = option(
    None,
    "FILE",
    "The STEP file that the result was designed from, so that the GLB and STEP show the part's own shape, "
    "not a prism.",
    "--part",
)
SupportedOption = Annotated[
    bool,
    typer.Option(
        "--supports",
        help="In the GLB and STEP also the best three supports under the part and a clamp on top, of the "
        "usual sizes.",
    ),
]


def asked_models(
    glb: str | None, step: str | None, inputs: Sequence[str | None], force: bool, **of_files: object
) -> list[Path]:
    """Returns the paths of the GLB and STEP files asked for.

    Parameters
    ----------
    of_files : options that only these files have, by name; none is given where a value is None or False.

    Raises
    ------
    InputError
        For another ending, an option without a file, and see :func:`refuse_output`.
    """
    paths = []
    for name, given, endings in (("--glb", glb, (".glb",)), ("--step", step, (".step", ".stp"))):
        if given is None:
            continue
        path = Path(given)
        if path.suffix.lower() not in endings:
            raise InputError(
                f"{name} {given} is not the name of such a file: let the name end in {endings[0]}."
            )
        refuse_output(path, inputs, force)
        paths.append(path)
    for option_name, value in of_files.items():
        if not paths and value is not None and value is not False:
            words = option_name.replace("_", "-")
            raise InputError(f"--{words} is of a file in three dimensions: give --glb or --step too.")
    return paths


def write_fixture(
    result: Result,
    rank: int,
    paths: Sequence[Path],
    wishes: tuple[float | None, Sequence[Load] | None, float | None],
    part: str | None,
    *,
    supported: bool,
    unit: Unit,
) -> None:
    """Writes the fixture of a rank as GLB and STEP files, on the best supports if wanted.

    Parameters
    ----------
    wishes : thickness of the part in mm, loads on it and jaw force in N; None where nobody says.
    part : the STEP file of its own shape.
    """
    from workhold.cli.setup_sheets import chosen_supports
    from workhold.presenting.assembly import Assembly, shape_in

    shape = shape_in(part, result.workpiece)
    chosen = chosen_supports(result, rank, *wishes) if supported else None
    write_bodies(Assembly.of(result[rank - 1], result, {"thickness": wishes[0]}, chosen, shape), paths, unit)


def write_bodies(assembly: Assembly, paths: Sequence[Path], unit: Unit) -> None:
    """Writes a set-up as GLB and STEP files, and says what the part was taken to be."""
    for path in paths:
        assembly.write(path)
    if not paths:
        return
    files, sizes = " and ".join(map(str, paths)), assembly.sizes
    if sizes.is_assumed:
        print_remark(
            f"in {files} the part is {unit.text(sizes.thickness)} high, as nobody said; give --thickness."
        )
    if assembly.is_simplified:
        print_remark(
            f"in {files} the part is drawn as a prism of its outline; for its own shape give --part with the "
            "STEP file that it was read from."
        )
