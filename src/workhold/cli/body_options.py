"""Options about a fixture in three dimensions, and the GLB file that they ask for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from workhold.cli.commands import option, print_remark
from workhold.cli.outputs import refuse_output
from workhold.errors import InputError
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.model.result import Result

__all__ = ["GLB", "GLB_THICKNESS", "asked_model", "write_bodies"]

GLB = option(None, "FILE", "Write it in three dimensions into this file, whose name ends in .glb.")
GLB_THICKNESS = option(
    None, "LENGTH", "Height of the part in the GLB; that of its solid, or 10 mm, if not given."
)


def asked_model(
    glb: str | None, thickness: str | None, inputs: Sequence[str | None], force: bool
) -> Path | None:
    """Returns the path of the GLB file asked for; None where none is.

    Raises
    ------
    InputError
        For another ending, a thickness without a file, and see :func:`refuse_output`.
    """
    if glb is None:
        if thickness is not None:
            raise InputError("--thickness is the part's height in a file: give --glb too.")
        return None
    path = Path(glb)
    if path.suffix.lower() != ".glb":
        raise InputError(f"--glb {glb} names no GLB file: let the name end in .glb.")
    refuse_output(path, inputs, force)
    return path


def write_bodies(result: Result, rank: int, path: Path, thickness: float | None, unit: Unit) -> None:
    """Writes the fixture of a rank as a GLB file, and says how high the part was taken to be."""
    from workhold.files.glb.writer import write_fixture_glb
    from workhold.model.bodies import BodySizes

    sizes = BodySizes.of(result.workpiece, thickness)
    write_fixture_glb(result[rank - 1], result.workpiece, result.toolkit, path, sizes)
    if sizes.is_assumed:
        print_remark(
            f"in {path} the part is {unit.text(sizes.thickness)} high, as nobody said; give --thickness."
        )
