"""The setup sheet of a fixture of a result, with its quality and what the loads do to it."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import date
from typing import Any

from attrs import evolve

from workhold.drawing.scene import LengthUnit
from workhold.drawing.sheet import draw_sheet
from workhold.drawing.sheet_facts import Caution, SheetDetails, cautions_of, edge_distances
from workhold.drawing.sheet_writing import lift_of
from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.model.first_side import FirstSide
from workhold.model.fixture import Fixture
from workhold.model.program import Program
from workhold.model.requirements import Load
from workhold.model.result import Result
from workhold.model.setup import PartZero, part_zero
from workhold.model.support_triples import ChosenSupports
from workhold.seating.clamping import by_hand
from workhold.seating.solver import Solver
from workhold.statics.loads import load_cases
from workhold.statics.program_clearance import passing_of
from workhold.statics.program_forces import cutting_need_of
from workhold.statics.quality import measured_fixture
from workhold.units import MILLIMETRE, Unit
from workhold.version import __version__

__all__ = ["result_cautions", "result_details", "result_sheet"]


def result_sheet(result: Result, rank: int, **asked: Any) -> tuple[str, ...]:
    """The pages of the setup sheet of one fixture, as SVG text.

    Its arguments and errors are those of :func:`result_details`.
    """
    fixture, details = result_details(result, rank, **asked)
    return draw_sheet(fixture, result.workpiece, result.toolkit, details)


def result_cautions(result: Result, rank: int, **asked: Any) -> list[Caution]:
    """What the setup sheet of one fixture says to beware of; see :func:`result_details`."""
    fixture, details = result_details(result, rank, **asked)
    lengths = LengthUnit.suiting(details.unit, smallest_pitch(result.toolkit))
    distances = edge_distances(fixture, result.workpiece, result.toolkit)
    return cautions_of(fixture, result.toolkit, distances, details, lengths)


def smallest_pitch(toolkit: Toolkit) -> float:
    """The smallest distance between neighbouring holes, in mm."""
    return min(min(carrier.pitch) for carrier in toolkit.carriers)


def zero_of(program: Program) -> PartZero:
    """Where a program counts from, which is what the machinist sets."""
    return PartZero(program.zero, "place given" if any(program.zero) else "origin of the drawing")


def result_details(
    result: Result,
    rank: int,
    *,
    result_hash: str = "",
    day: date = date.min,
    paper: str = "a4",
    unit: Unit = MILLIMETRE,
    part_name: str | None = None,
    jaw_force: float | None = None,
    friction: float | None = None,
    jaw: str | float = "screw",
    loads: Sequence[Load] | None = None,
    zero: str | Sequence[float] | None = None,
    machine_position: tuple[float, float] | None = None,
    thickness: float | None = None,
    peg_length: float | None = None,
    peg_height: float | None = None,
    dowel: str | None = None,
    others: int | None = None,
    number: int | None = None,
    count: int | None = None,
    seating: bool | None = None,
    supports: ChosenSupports | None = None,
    support_height: float | None = None,
    plate_thickness: float | None = None,
    first_side: FirstSide | None = None,
    listed_as: str = "Fixture",
) -> tuple[Fixture, SheetDetails]:
    """One fixture with all figures of quality, and the further details of its setup sheet.

    Parameters
    ----------
    rank : of the fixture, from 1.
    loads : instead of those of the result, if given.
    jaw : what closes the vise, see :func:`workhold.statics.loads.jaw_stiffness`.
    zero : part zero, see :func:`workhold.model.setup.part_zero`; its numbers are in ``unit``.
    others : how many other fixtures use the same holes; counted in the result if None.
    number, count : the rank in a larger result and how many that lists, for a fixture taken out of it.
    seating : whether the sheet shows where else the pegs can hold the part; None shows it where the result
        has it.
    result_hash, day, paper, unit, part_name, jaw_force, friction, machine_position : see
        :class:`SheetDetails`.
    thickness, peg_length, peg_height, dowel : see :class:`SheetDetails`.
    supports, support_height, plate_thickness, first_side, listed_as : see :class:`SheetDetails`. With
        supports the sheet is of their fixture in holes that all have names.

    Raises
    ------
    InputError
        For a jaw force, a coefficient of friction or a part zero that cannot be.
    """
    asked = result.query.loads if loads is None else loads
    jaw_force = result.query.jaw_force if jaw_force is None else jaw_force
    fixture, workpiece, toolkit = (
        measured_fixture(result, rank - 1, asked, jaw_force),
        result.workpiece,
        result.toolkit,
    )
    known, not_seated = result[rank - 1].seating if seating is not False else None, ""
    if supports is not None and supports.recounted.fixture.pegs != fixture.pegs:
        # The readings of its seats would be those of other holes.
        seating, known = seating or known is not None, None
        fixture = evolve(supports.recounted.fixture, quality=fixture.quality)
    if seating is None and not toolkit.closes_at_once:
        seating = rank <= (result.query.seating or 0)
    put_in = None if not seating or toolkit.closes_at_once else by_hand(fixture, workpiece, toolkit)
    if seating and known is None and put_in is None:
        try:
            known = Solver(workpiece, toolkit).of(fixture)
        except InputError as error:
            not_seated = f"{str(error)[:1].upper()}{str(error)[1:]}"
    program, reach = result.query.program, result.query.peg_height
    if peg_height is None and reach is not None:
        # The query's height is above where the part lies, the sheet's above the plates.
        peg_height = reach + lift_of(supports, support_height)
    cutting = cutting_need_of(result, rank - 1, jaw_force, jaw)
    listed_holes = [peg.hole for peg in result[rank - 1].pegs]
    details = SheetDetails(
        number=rank if number is None else number,
        count=len(result) if count is None else count,
        day=day,
        result_hash=result_hash,
        version=__version__,
        paper=paper,
        unit=unit,
        part_name=part_name,
        tolerance=result.query.tolerance,
        jaw_force=jaw_force,
        friction=friction,
        loads=load_cases(fixture, workpiece, toolkit, asked, jaw_force, friction, jaw),
        zero=zero_of(program) if zero is None and program is not None else part_zero(workpiece, zero, unit),
        machine_position=machine_position,
        thickness=thickness,
        peg_length=peg_length,
        peg_height=peg_height,
        dowel=dowel,
        others=result.table.same_holes(rank - 1) if others is None else others,
        seating=known,
        by_hand=put_in,
        not_seated=not_seated,
        supports=supports,
        support_height=support_height,
        plate_thickness=plate_thickness,
        first_side=first_side,
        program=program,
        passing=passing_of(result, rank - 1),
        cutting=None
        if cutting is None
        else cutting.in_holes(listed_holes, [peg.hole for peg in fixture.pegs]),
        listed_as=listed_as,
    )
    return fixture, details
