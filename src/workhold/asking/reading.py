"""The question of a part's file: how it is to be read."""

from __future__ import annotations

from collections.abc import Sequence

from attrs import frozen

from workhold.asking.declaring import check_fields, declare

__all__ = ["AXES", "READING", "ReadingQuestion"]

# A section of the command's help.
READING = "Reading the part"
# The directions of a file that can point up.
AXES = ("x", "y", "z", "-x", "-y", "-z")
UNITS = ("mm", "cm", "m", "inch", "px72", "px90", "px96")


@frozen(field_transformer=check_fields, kw_only=True)
class ReadingQuestion:
    """How a part is read; :func:`workhold.load` explains the fields."""

    layers: Sequence[str] | None = declare(
        "names",
        "DXF layers to read; all visible ones if not given.",
        section=READING,
        word="layer",
        typed="Read only this layer; may be repeated.",
    )
    part_number: int | str | None = declare(
        "text",
        "The part to read if a drawing holds several, or the solid of a STEP file: its number or "
        "its name; the largest if not given.",
        section=READING,
        spelled="--part",
        metavar="N|NAME",
    )
    unit: str | None = declare(
        "choice",
        "Unit of a drawing that does not give its own, or gives a wrong one; for an SVG drawing "
        "in pixels, the number of pixels in an inch.",
        choices=UNITS,
        section=READING,
        word="drawing_unit",
        typed="Unit of the drawing, if it is not that of --unit or if the file gives a wrong one.",
        metavar="UNIT",
    )
    axis: str | None = declare(
        "choice",
        "STEP files: the direction of the file that points up, parallel to the pegs; z if not "
        "given. A minus sign lays the part on its other side.",
        choices=AXES,
        section=READING,
        metavar="[-]x|y|z",
    )
    peg_height: float | None = declare(
        "length",
        "STEP files: height that pegs reach above the plane on which the part lies. The outline "
        "is everything that such pegs can meet, and pegs touch only upright faces. If not given, "
        "pegs stand out no farther than dowels must.",
        section=READING,
        typed="STEP files: height that pegs reach above the plane on which the part lies. The outline "
        "is everything that such pegs can meet, and pegs touch only upright faces. If not given, "
        "pegs stand out no farther than dowels must. For a drawing it is the height of the pegs, "
        "which decides how far they bend.",
        metavar="HEIGHT",
    )
    head_room: float | None = declare(
        "length",
        "With a height of the pegs: clearance that is kept free above them; 0.5 mm if not given.",
        least="0",
        section=READING,
        typed="With --peg-height: clearance that is kept free above the pegs; 0.5mm if not given.",
    )
    least_band: float | None = declare(
        "length",
        "With a height of the pegs: least height of an upright face that a peg may touch; 1 mm if not given.",
        least="0",
        section=READING,
        typed="With --peg-height: least height of an upright face that a peg may touch; 1mm if not given.",
    )
    section: float | None = declare(
        "length",
        "STEP files: height above the part's lowest point at which the outline is the section, "
        "instead of the silhouette.",
        least="any",
        section=READING,
        metavar="HEIGHT",
    )
    join_tolerance: float = declare(
        "length",
        "Largest gap between line ends that is closed.",
        default=1e-3,
        least="0",
        section=READING,
        # With its unit, so that it is the same whatever --unit says.
        typed_default="0.001mm",
    )
    fit: float | None = declare(
        "length",
        "Largest distance at which lines and arcs may stand in place of splines, ellipses and "
        "Bézier curves; without it such true curves are refused.",
        section=READING,
    )
