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
        "Which part, when a drawing holds several, or which solid of a STEP file, by its number or its "
        "name; the largest if not "
        "given.",
        section=READING,
        spelled="--part",
        metavar="N|NAME",
    )
    unit: str | None = declare(
        "choice",
        "Unit of a drawing that does not say its own, or says a wrong one; of an SVG drawing in pixels, "
        "how many make an inch.",
        choices=UNITS,
        section=READING,
        word="drawing_unit",
        typed="Unit of the drawing, where it is not that of --unit, or where the file says a wrong one.",
        metavar="UNIT",
    )
    axis: str | None = declare(
        "choice",
        "STEP files: the direction that points up, to which pegs are parallel; z if not given. With - the "
        "part lies on its other "
        "side.",
        choices=AXES,
        section=READING,
        metavar="[-]x|y|z",
    )
    peg_height: float | None = declare(
        "length",
        "STEP files: how far pegs reach above the plane on which the part lies. The outline is what they "
        "can meet there, and "
        "only upright faces are touched. If not given, no higher than dowels must stand out.",
        section=READING,
        typed="STEP files: how far pegs reach above the plane on which the part lies. The outline is what "
        "they can meet there, "
        "and only upright faces are touched. If not given, no higher than dowels must stand out. Of a "
        "drawing it says how high "
        "the pegs are, for how far they bend.",
        metavar="HEIGHT",
    )
    head_room: float | None = declare(
        "length",
        "With a height of the pegs: what is kept free above them; 0.5 mm if not given.",
        least="0",
        section=READING,
        typed="With --peg-height: what is kept free above the pegs; 0.5mm if not given.",
    )
    least_band: float | None = declare(
        "length",
        "With a height of the pegs: how high an upright face must be to be touched; 1 mm if not given.",
        least="0",
        section=READING,
        typed="With --peg-height: how high an upright face must be to be touched; 1mm if not given.",
    )
    section: float | None = declare(
        "length",
        "STEP files: take the section at this height above the part's lowest point, not the silhouette.",
        least="any",
        section=READING,
        metavar="HEIGHT",
    )
    join_tolerance: float = declare(
        "length",
        "Largest gap between ends of lines that is closed.",
        default=1e-3,
        least="0",
        section=READING,
        # With its unit, so that it is the same whatever --unit says.
        typed_default="0.001mm",
    )
    fit: float | None = declare(
        "length",
        "Put lines and arcs, nowhere farther off than this, in place of splines, ellipses and Bézier "
        "curves that are none.",
        section=READING,
    )
