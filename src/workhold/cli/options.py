"""Arguments and options of several commands: the part and how it is read, a result file, a rank, a unit.

Options of a toolkit are in :mod:`workhold.cli.toolkit_options`, options of a search in
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

from workhold.asking.declaring import list_declarations
from workhold.asking.reading import ReadingQuestion
from workhold.cli.commands import make_option, print_remark
from workhold.cli.declared import make_option_attributes, make_word_attribute, read_words
from workhold.cli.values import read_unit, read_usual_unit, read_whole_number
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.files.part.loaded import LoadedPart
    from workhold.model.result import Result

__all__ = [
    "SHOWN_UNIT",
    "PartArgument",
    "PartOptions",
    "RankArgument",
    "ResultArgument",
    "read_rank",
    "read_result_with_rank",
]

ResultArgument = Annotated[
    str, typer.Argument(metavar="RESULT", help="A result file (JSON or npz) written by workhold design.")
]
RankArgument = Annotated[str, typer.Argument(metavar="N", help="Rank of the fixture; 1 is the best.")]


def read_rank(text: str) -> int:
    """Return a rank of 1 or more; raise InputError for anything else."""
    rank = read_whole_number("fixture", text)
    if rank < 1:
        raise InputError(f"there is no fixture {rank}: fixtures are counted from 1, the best one.")
    return rank


def read_result_with_rank(path: str | Path, rank: int) -> Result:
    """Return the result of a file that lists a fixture of this rank;
    raise InputError where it lists fewer.
    """
    from workhold.files.result.one_fixture import read_one

    return read_one(path, rank)


OF_READING = list_declarations(ReadingQuestion)
# What the questions of a part's readers are called here.
CALLED = {row.name: row.option for row in OF_READING} | {
    "unit": "--unit",
    "drawing_unit": "--drawing-unit",
    "heights": "the toolkit's own heights",
}
LENGTHS_UNIT = make_option(
    None,
    "UNIT",
    "Unit of the lengths that you type and see (mm, cm, m, inch), and of a drawing that does "
    "not give its own; mm if not given. A length may also carry its unit: 0.5in. For an SVG "
    "drawing in pixels it is the number of pixels in an inch: px72, px90, px96; lengths are "
    "then in mm.",
)

PartArgument = Annotated[
    str,
    typer.Argument(
        metavar="PART",
        help="The part: a DXF, SVG, JSON or STEP file, or a built-in name (see workhold parts).",
    ),
]
SHOWN_UNIT = make_option(
    None,
    "UNIT",
    "Unit of the lengths shown (mm, cm, m, inch); if not given, inch for holes a fraction of an inch apart, else mm.",
    "--unit",
)


def is_at_terminal() -> bool:
    """Return whether both stdin and stderr are a terminal, so that the user can be asked."""
    return sys.stdin.isatty() and sys.stderr.isatty()


@frozen(these=make_option_attributes(OF_READING, layers={"unit": make_word_attribute(LENGTHS_UNIT)}))
class PartOptions:
    """The options of reading the part, as typed; None for those not given."""

    if TYPE_CHECKING:
        unit: str | None
        drawing_unit: str | None
        peg_height: str | None

    def to_read_arguments(self) -> dict[str, Any]:
        """Return the keyword arguments of ``files.part.load.read_workpiece``, without the part."""
        from workhold.files.questions import read_number_or_name

        rows = [row for row in OF_READING if row.name != "unit"]
        asked = read_words(rows, self, read_unit(self.unit)) | {"unit": self.drawing_unit}
        asked["part_number"] = read_number_or_name(asked["part_number"])
        return asked | {"usual_unit": self.unit or read_usual_unit(), "called": CALLED}

    def load(
        self,
        part: str,
        heights: Mapping[str, Sequence[float]] | None = None,
        peg_diameter: float | None = None,
        said: Collection[str] = (),
    ) -> LoadedPart:
        """Return the part that is read, after printing remarks on the drawing on stderr.

        At a terminal the user is asked for the unit of a drawing that does not give it.

        Parameters
        ----------
        part : a file or a built-in name.
        heights, peg_diameter : as for ``files.part.load.read_workpiece``.
        said : remarks already printed; they are not printed again.

        Raises
        ------
        InputError
            When the part cannot be used.
        """
        options = self.to_read_arguments()
        from workhold.files.part.load import read_workpiece
        from workhold.files.questions import UnitAskedError

        read = partial(read_workpiece, part, **options, heights=heights, peg_diameter=peg_diameter)
        try:
            loaded = read()
        except UnitAskedError as question:
            if not is_at_terminal():
                raise
            print_remark(str(question))
            pixels = "; px72, px90 or px96 for pixels" if "px72" in str(question) else ""
            loaded = read(unit=typer.prompt(f"Unit of the drawing (mm, inch, cm, m{pixels})", err=True))
        for remark in loaded.remarks:
            if remark not in said:
                print_remark(remark)
        return loaded
