"""What a setup sheet says besides the fixture: paper, unit, names, dates, and what the loads do."""

from __future__ import annotations

from datetime import date

from attrs import field, frozen

from workhold.model.part_zero import PartZero
from workhold.model.seating import Seating
from workhold.model.tolerance import Tolerance
from workhold.seating.by_hand import ByHand
from workhold.statics.loads import LoadCase
from workhold.units import MILLIMETRE, Unit

__all__ = ["PAPERS", "SheetDetails"]

# Width and height in mm, upright: ISO 216 and ANSI/ASME Y14.1.
PAPERS = {"a4": (210.0, 297.0), "letter": (215.9, 279.4)}


@frozen
class SheetDetails:
    """Everything on a setup sheet that the fixture does not tell.

    Parameters
    ----------
    number, count : the fixture's rank in its result and how many there are.
    day : the date written on the sheet.
    result_hash : SHA-256 of the result file in hexadecimal; empty for a result of no file.
    version : of the program.
    paper : "a4" or "letter".
    unit : of lengths.
    part_name : written instead of the workpiece's own name.
    tolerance : how far pegs and faces may be off, which the location error is for.
    jaw_force : in N; None when it is left open.
    friction : coefficient of friction that was asked for with the loads.
    loads : what acts on the part, and the peg forces that answer it.
    zero : what the machinist programs from; the drawing's origin if None.
    machine_position : of the hole that places are told from, in mm in the machine's own coordinates; None when not known.
    thickness : of the part, in mm; None where it is to be written on the paper, as are the next three.
    peg_length, peg_height : of the pegs, and how far they stand out of the jaws, in mm.
    dowel : what the pegs are and how they fit their holes, in the user's words instead of the tolerance's.
    others : how many other fixtures of the result use the same holes.
    seating : what else the pegs can do with the part; None where the sheet does not tell.
    by_hand : how the part is put into two clamps; None where the sheet does not tell.
    not_seated : why seating is not told though it was asked for, in a sentence.
    """

    number: int
    count: int
    day: date
    result_hash: str
    version: str
    paper: str = "a4"
    unit: Unit = MILLIMETRE
    part_name: str | None = None
    tolerance: Tolerance = field(factory=Tolerance)
    jaw_force: float | None = None
    friction: float | None = None
    loads: tuple[LoadCase, ...] = ()
    zero: PartZero | None = None
    machine_position: tuple[float, float] | None = None
    thickness: float | None = None
    peg_length: float | None = None
    peg_height: float | None = None
    dowel: str | None = None
    others: int = 0
    seating: Seating | None = None
    by_hand: ByHand | None = None
    not_seated: str = ""
