"""The question of a setup sheet: what is asked of it besides the fixture, its loads and the unit of its lengths."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import date
from typing import Any

from attrs import frozen

from workhold.asking.declaring import Choice, PageLabel, check_fields, declare
from workhold.asking.search import LOADS

__all__ = ["BODIES", "ON_PAPER", "SUPPORTS", "SheetQuestion"]

# Sections of the command's help.
ON_PAPER, BODIES, SUPPORTS = "On the paper", "Part and pegs", "Supports and the other side"
# What stands in a field of the page that is empty, where the sheet then has a line to write on.
LINE = "a line for it"
PAPERS = Choice("a4", "A4"), Choice("letter", "Letter")


@frozen(field_transformer=check_fields, kw_only=True)
class SheetQuestion:
    """What stands on a setup sheet; lengths in mm, forces in N, None for what nobody said.

    Parameters
    ----------
    paper : "a4" or "letter".
    part_name : name of the part on the sheet, instead of the workpiece's own.
    day : date on the sheet; None is today.
    zero : part zero: "corner", "centre", "hole 2", or x and y of the drawing in the unit of the sheet.
    at : the hole in which the lowest column and the lowest row of the set-up meet, such as "D4".
    machine_position : (x, y), in the machine's coordinates, of the hole from which places are measured.
    thickness : thickness of the part.
    peg_length, peg_height : length of the pegs, and how far they stand out of the jaws.
    dowel : words on the pegs and how they fit their holes.
    material : material of the part, with which the sheet shows how far clamping bends it; None to leave that
        out.
    bend : length above which the sheet warns that the part bends or gives.
    clearance : distance that the cutter keeps from the pegs.
    plate_thickness : of the plates that pegs stand through.
    support_height : of supports under the part.
    seating : whether the sheet shows where else the pegs can hold the part; None for yes where that is known.
    jaw_force : force with which the vise or the clamps are closed.
    jaw : "screw", "constant", or how many times as stiff as a contact the closed jaw is.
    friction : coefficient of friction, to show what friction could add.

    Raises
    ------
    InputError
        For an impossible value.
    """

    paper: str | None = declare(
        "choice",
        "a4 or letter; letter for lengths in inches if not given, else a4.",
        choices=tuple(one.value for one in PAPERS),
        section=ON_PAPER,
        metavar="SIZE",
    )
    part_name: str | None = declare(
        "text",
        "Name of the part on the sheet; the part's own name if not given.",
        PageLabel("Part’s name", ""),
        section=ON_PAPER,
        metavar="NAME",
    )
    day: date | None = declare(
        "day", "The date of the sheet; today if not given.", section=ON_PAPER, word="date"
    )
    zero: str | Sequence[float] | None = declare(
        "text",
        "Part zero: corner (lower left, as drawn), centre, hole N, or X,Y of the drawing. If not "
        "given, the origin of the drawing if that lies on the part, else the corner.",
        PageLabel("X0 Y0", "origin or corner"),
        metavar="POINT",
    )
    at: str | None = declare(
        "text",
        "Hole of the plate, such as D4, in which the set-up's lowest column and row meet. If not "
        "given, the set-up stands in the middle of the plate.",
        PageLabel("Lowest hole", "middle of the plate"),
        metavar="HOLE",
    )
    machine_position: Sequence[float] | None = declare(
        "place",
        "Machine position over the first hole; with it the sheet has the lines G10 L2 and G68.",
        PageLabel("Machine over the first hole,", "not known"),
        section=ON_PAPER,
        typed="Machine position over hole A1 of the fixed jaw; with it the sheet has the lines G10 L2 "
        "and G68.",
    )
    thickness: float | None = declare(
        "length",
        "Thickness of the part; if not given, that of its solid, or a line to write it on.",
        PageLabel("Part thickness", LINE),
        section=BODIES,
    )
    peg_length: float | None = declare(
        "length", "Length of the pegs.", PageLabel("Pegs’ length", LINE), section=BODIES
    )
    peg_height: float | None = declare(
        "length",
        "Standout of the pegs.",
        PageLabel("Standout", LINE),
        section=BODIES,
        typed="Standout of the pegs above the jaws.",
    )
    dowel: str | None = declare(
        "text",
        "Dowels and their fit, such as '6 mm m6 in H7'; if not given, the dowels of the toolkit.",
        PageLabel("Dowel and fit", "6 mm m6 in H7"),
        section=BODIES,
        typed="Dowels and their fit, such as '6 mm m6 in H7'; if not given, the dowels of --vise.",
    )
    material: str | None = declare(
        "text",
        "Material of the part, such as aluminium-6061 or mild-steel: the sheet then shows how far clamping "
        "bends it. This takes the extra bending, and some seconds.",
        PageLabel("Material, to see it bend", "not bent"),
        section=BODIES,
        metavar="NAME",
    )
    bend: float | None = declare(
        "length",
        "Warn of a part that clamping bends by more, or that gives by more at the cutter.",
        PageLabel("Warn of bending above", "no warning"),
        section=BODIES,
    )
    clearance: float | None = declare(
        "length",
        "Distance that the cutter keeps from the pegs, on the layer KEEP_OUT of a .dxf; 1 mm if not given.",
        PageLabel("Cutter keeps off", "1 mm in the DXF"),
        least="0",
        section=BODIES,
        typed="Distance that the cutter keeps from the pegs, on the layer KEEP_OUT of a .dxf.",
        typed_default="1mm",
    )
    plate_thickness: float | None = declare(
        "length",
        "Depth that pegs go into the plate; 10 mm is assumed if not given.",
        PageLabel("Into the plate", "10 mm"),
        section=BODIES,
    )
    support_height: float | None = declare(
        "length",
        "Height by which the supports lift the part; 10 mm is assumed if not given.",
        section=SUPPORTS,
    )
    seating: bool | None = declare(
        "flag",
        "Show whether the part ends up in its place: how far to open what clamps it, and what a wrong "
        "place looks like.",
        PageLabel("Does the part end up there?"),
        section=ON_PAPER,
    )
    jaw_force: float | None = declare(
        "force",
        "Force that closes the vise or tightens the clamp, in N or with its unit (3kN, 700lbf); "
        "for two clamps the sum of both. If not given, the force that is needed so that no peg "
        "lets go.",
        section=LOADS,
    )
    jaw: Any = declare(
        "text",
        "What the closed jaw does under load: screw: it is locked, as a vise is; constant: it "
        "keeps its force (hydraulic, pneumatic); a number: it is locked, and this many times as stiff as one contact.",
        default="screw",
        section=LOADS,
        metavar="KIND",
    )
    friction: float | None = declare(
        "number",
        "Coefficient of friction, to report what friction could add; all other figures count none.",
        PageLabel("Friction", "none"),
        section=LOADS,
        metavar="MU",
    )
