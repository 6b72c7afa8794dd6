"""Arguments and options of several commands: the part and how it is read, a result file, a rank, a unit.

Words that describe a toolkit stand in :mod:`workhold.cli.toolkit_options`, words of a search in
:mod:`workhold.cli.search_options`.
"""

from __future__ import annotations

import sys
from collections.abc import Collection, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from attrs import frozen

from workhold.cli.commands import option, print_remark
from workhold.cli.values import (
    choice,
    length,
    length_unit,
    optional_length,
    optional_positive_length,
    usual_unit,
    whole_number,
)
from workhold.errors import InputError
from workhold.model.solid import AXES

if TYPE_CHECKING:
    from workhold.files.part.loaded import Loaded
    from workhold.model.result import Result

__all__ = [
    "SHOWN_UNIT",
    "PartArgument",
    "PartWords",
    "RankArgument",
    "ResultArgument",
    "asked_rank",
    "result_with",
]

ResultArgument = Annotated[
    str, typer.Argument(metavar="RESULT", help="A result file (JSON or npz) written by workhold design.")
]
RankArgument = Annotated[str, typer.Argument(metavar="N", help="Which fixture, by rank: 1 is the best.")]


def asked_rank(text: str) -> int:
    """Reads a rank, counted from 1."""
    rank = whole_number("fixture", text)
    if rank < 1:
        raise InputError(f"there is no fixture {rank}: fixtures are counted from 1, the best one.")
    return rank


def result_with(path: str | Path, rank: int) -> Result:
    """Reads a result file for its fixture of a rank; refuses one that lists fewer."""
    from workhold.files.result.one_fixture import read_one

    return read_one(path, rank)


READING = "Reading the part"
# With its unit, so that it is the same whatever --unit says.
JOIN_TOLERANCE = "0.001mm"

# What the questions of a part's readers are called here.
CALLED = {
    "unit": "--unit",
    "drawing_unit": "--drawing-unit",
    "layers": "--layer",
    "part_number": "--part",
    "join_tolerance": "--join-tolerance",
    "fit": "--fit",
    "axis": "--axis",
    "section": "--section",
    "peg_height": "--peg-height",
    "head_room": "--head-room",
    "least_band": "--least-band",
    "heights": "the toolkit's own heights",
}

PartArgument = Annotated[
    str,
    typer.Argument(
        metavar="PART",
        help="The part: a DXF, SVG, JSON or STEP file, or a built-in name (see workhold parts).",
    ),
]
SHOWN_UNIT = option(
    None,
    "UNIT",
    "Unit of the lengths shown (mm, cm, m, inch); if not given, inch for holes a fraction of an inch apart, else mm.",
    "--unit",
)


def at_terminal() -> bool:
    """Whether a user at a terminal can be asked."""
    return sys.stdin.isatty() and sys.stderr.isatty()


@frozen
class PartWords:
    """The options of reading the part, as typed; None for those not given."""

    unit: str | None = option(
        None,
        "UNIT",
        "Unit of lengths given and shown (mm, cm, m, inch), and of a drawing that does not say its own; mm "
        "if not given. A length may also carry its unit: 0.5in. For an SVG drawing in pixels, how many make "
        "an inch: px72, px90, px96; lengths are then in mm.",
    )
    layer: list[str] | None = option(READING, "NAME", "Read only this layer; may be repeated.")
    part_number: str | None = option(
        READING,
        "N|NAME",
        "Which part, when a drawing holds several, or which solid of a STEP file, by its number or its name; "
        "the largest if not given.",
        "--part",
    )
    drawing_unit: str | None = option(
        READING,
        "UNIT",
        "Unit of the drawing, where it is not that of --unit, or where the file says a wrong one.",
    )
    axis: str | None = option(
        READING,
        "[-]x|y|z",
        "STEP files: the direction that points up, to which pegs are parallel; z if not given. With - the "
        "part lies on its other side.",
    )
    peg_height: str | None = option(
        READING,
        "HEIGHT",
        "STEP files: how far pegs reach above the plane on which the part lies. The outline is what they can "
        "meet there, and only upright faces are touched. If not given, no higher than dowels must stand out. "
        "Of a drawing it says how high the pegs are, for how far they bend.",
    )
    head_room: str | None = option(
        READING, "LENGTH", "With --peg-height: what is kept free above the pegs; 0.5mm if not given."
    )
    least_band: str | None = option(
        READING,
        "LENGTH",
        "With --peg-height: how high an upright face must be to be touched; 1mm if not given.",
    )
    section: str | None = option(
        READING,
        "HEIGHT",
        "STEP files: take the section at this height above the part's lowest point, not the silhouette.",
    )
    join_tolerance: str = option(
        READING, "LENGTH", "Largest gap between ends of lines that is closed.", default=JOIN_TOLERANCE
    )
    fit: str | None = option(
        READING,
        "LENGTH",
        "Put lines and arcs, nowhere farther off than this, in place of splines, ellipses and Bézier curves "
        "that are none.",
    )

    def options(self) -> dict[str, Any]:
        """Makes the keyword arguments of ``files.part.load.read_workpiece``."""
        from workhold.files.questions import number_or_name

        unit = length_unit(self.unit)
        return {
            "unit": self.drawing_unit,
            "usual_unit": self.unit or usual_unit(),
            "layers": self.layer or None,
            "part_number": number_or_name(self.part_number),
            "join_tolerance": length(CALLED["join_tolerance"], self.join_tolerance, unit),
            "fit": optional_positive_length(CALLED["fit"], self.fit, unit),
            "axis": None if self.axis is None else choice(CALLED["axis"], self.axis, AXES),
            "section": optional_length(CALLED["section"], self.section, unit),
            "peg_height": optional_positive_length(CALLED["peg_height"], self.peg_height, unit),
            "head_room": optional_length(CALLED["head_room"], self.head_room, unit),
            "least_band": optional_length(CALLED["least_band"], self.least_band, unit),
            "called": CALLED,
        }

    def load(
        self,
        part: str,
        heights: Mapping[str, Sequence[float]] | None = None,
        peg_diameter: float | None = None,
        said: Collection[str] = (),
    ) -> Loaded:
        """Reads a part and prints remarks about the drawing on stderr.

        Parameters
        ----------
        part : a file or a built-in name.
        heights, peg_diameter : as of ``files.part.load.read_workpiece``.
        said : remarks that are not printed once more.

        Raises
        ------
        InputError
            When the part cannot be used.
        """
        options = self.options()
        from workhold.files.part.load import read_workpiece
        from workhold.files.questions import UnitAskedError

        read = partial(read_workpiece, part, **options, heights=heights, peg_diameter=peg_diameter)
        try:
            loaded = read()
        except UnitAskedError as question:
            if not at_terminal():
                raise
            print_remark(str(question))
            pixels = "; px72, px90 or px96 for pixels" if "px72" in str(question) else ""
            loaded = read(unit=typer.prompt(f"Unit of the drawing (mm, inch, cm, m{pixels})", err=True))
        for remark in loaded.remarks:
            if remark not in said:
                print_remark(remark)
        return loaded
