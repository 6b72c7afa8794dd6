"""The setup sheet of a fixture of a result, with its quality and what the loads do to it."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import date

from workhold.drawing.sheet import draw_sheet
from workhold.drawing.sheet_details import SheetDetails
from workhold.drawing.sheet_facts import same_holes
from workhold.model.load import Load
from workhold.model.result import Result
from workhold.model.units import Unit
from workhold.statics.loads import load_cases
from workhold.statics.quality import measured_fixture
from workhold.version import __version__

__all__ = ["result_sheet"]


def result_sheet(
    result: Result,
    rank: int,
    *,
    result_hash: str,
    day: date,
    paper: str,
    unit: Unit,
    part_name: str | None = None,
    jaw_force: float | None = None,
    friction: float | None = None,
    loads: Sequence[Load] | None = None,
) -> tuple[str, ...]:
    """The pages of the setup sheet of one fixture, as SVG text.

    Parameters
    ----------
    rank : of the fixture, from 1.
    loads : instead of those of the result, if given.
    result_hash, day, paper, unit, part_name, jaw_force, friction : see :class:`SheetDetails`.

    Raises
    ------
    InputError
        For a jaw force or a coefficient of friction that cannot be.
    """
    asked = result.query.loads if loads is None else loads
    fixture, workpiece, vise = measured_fixture(result, rank - 1, asked), result.workpiece, result.vise
    details = SheetDetails(
        number=rank,
        count=len(result),
        day=day,
        result_hash=result_hash,
        version=__version__,
        paper=paper,
        unit=unit,
        part_name=part_name,
        tolerance=result.query.tolerance,
        jaw_force=jaw_force,
        friction=friction,
        loads=load_cases(fixture, workpiece, vise, asked, jaw_force, friction),
        others=same_holes(result.table, rank - 1),
    )
    return draw_sheet(fixture, workpiece, vise, details)
