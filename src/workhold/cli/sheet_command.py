"""The command ``sheet``: one fixture on paper or for a CAM system."""

from __future__ import annotations

from datetime import date
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Annotated, Any

import typer
from attrs import frozen

from workhold.asking.declaring import list_declarations
from workhold.asking.sheet import SUPPORTS, SheetQuestion
from workhold.cli.commands import make_flag, make_option, spread_option_groups
from workhold.cli.declared import (
    make_flag_attribute,
    make_list_attribute,
    make_option_attributes,
    make_word_attribute,
    read_words,
)
from workhold.cli.options import SHOWN_UNIT, read_rank, read_result_with_rank
from workhold.cli.outputs import FORCE, JSON, print_written, refuse_output
from workhold.cli.search_options import LOAD, LOADS_FILE, read_asked_loads
from workhold.cli.setup_sheets import (
    PART_FILE,
    choose_best_supports,
    choose_supports_from_file,
    compare_with_earlier_result,
)
from workhold.cli.values import choose_printed_unit, read_unit
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.model.requirements import Load
    from workhold.model.result import Result
    from workhold.units import Unit

__all__ = ["sheet"]

OF_SHEET = list_declarations(SheetQuestion)
WITH_SUPPORTS = make_flag(
    SUPPORTS,
    "Show the best three supports under the part and a clamp on top, of the usual sizes.",
    "--supports",
)
FIRST_SETUP = make_option(
    SUPPORTS,
    "RESULT",
    "For a solid's second side: the result of the first; the sheet then names the faces that "
    "the first set-up cuts and locates on.",
)


@frozen(
    these=make_option_attributes(
        OF_SHEET,
        clearance={"part": make_word_attribute(PART_FILE)},
        support_height={"supports": make_flag_attribute(WITH_SUPPORTS)},
        seating={"first_setup": make_word_attribute(FIRST_SETUP)},
        jaw_force={"load": make_list_attribute(LOAD), "loads": make_word_attribute(LOADS_FILE)},
    )
)
class SheetOptions:
    """The options that choose the contents of a sheet, as typed; None for those not given."""

    if TYPE_CHECKING:
        support_height: str | None
        supports: bool
        first_setup: str | None
        part: str | None
        material: str | None
        seating: bool
        load: list[str] | None
        loads: str | None


@frozen
class SheetTask:
    """A sheet to write.

    Parameters
    ----------
    path, result_file, rank : file to write, file of the result, and rank of the fixture in it.
    settings : contents of the sheet, by fields of ``SheetQuestion``.
    loads : loads used instead of the result's; empty for the result's.
    unit : of lengths, as typed.
    on_supports : whether ``result_file`` is a file of supports, so that the rank is that of a set of three.
    """

    path: Path
    result_file: str
    rank: int
    settings: dict[str, Any]
    loads: tuple[Load, ...]
    words: SheetOptions
    unit: str | None
    on_supports: bool

    @property
    def is_for_cam(self) -> bool:
        """Whether the file is a set-up for CAM or a list of pins, not a sheet."""
        from workhold.presenting.papers import MODEL_ENDINGS

        return self.path.suffix.lower() in MODEL_ENDINGS


@spread_option_groups
def sheet(
    result_file: Annotated[
        str,
        typer.Argument(
            metavar="RESULT", help="A result file of workhold design, or a file of workhold supports --out."
        ),
    ],
    number: Annotated[
        str,
        typer.Argument(
            metavar="N",
            help="Rank of the fixture; 1 is the best. In a file of supports it is the number of the set "
            "of three.",
        ),
    ],
    out: Annotated[
        str,
        typer.Option(
            "--out",
            "-o",
            metavar="FILE",
            help="The file to write; its name ends in .pdf, .svg, .png, .dxf, .step or .csv.",
        ),
    ],
    *,
    force: bool = FORCE,
    unit: str | None = SHOWN_UNIT,
    words: SheetOptions,
    json_: bool = JSON,
) -> None:
    """Write the setup sheet of fixture N of a result: plan to scale, pegs, opening, part zero, quality,
    loads, cautions.

    Loads given here replace those in the result. The paper sizes are A4 and Letter. If the part's thickness
    is known, a view from the side shows the heights. A .dxf or .step file holds the set-up itself, in mm, for
    a CAM system; a .csv file lists the pins.

    Example: workhold sheet part.json 1 -o setup.pdf --jaw-force 3000
    """
    asked = parse(result_file, read_rank(number), Path(out), words, unit)
    refuse_output(asked.path, (result_file, words.loads, words.first_setup, words.part), force)
    write(asked)
    print_written(json_, f"Written to {asked.path}.", asked.path)


def parse(result_file: str, rank: int, path: Path, words: SheetOptions, unit: str | None) -> SheetTask:
    """Return what was typed as a task; raise InputError for options that the kind of file cannot have."""
    from workhold.presenting.assembly import STEP_ENDINGS
    from workhold.presenting.papers import MODEL_ENDINGS, PAPER_ENDINGS
    from workhold.statics.loads import read_jaw_stiffness
    from workhold.verification.supports import is_supports_file

    ending = path.suffix.lower()
    if ending not in PAPER_ENDINGS + MODEL_ENDINGS:
        raise InputError(
            f"-o {path} names no kind of setup sheet: let the name end in .pdf, .svg, .png, .dxf, .step or "
            ".csv."
        )
    shown = read_unit(unit)
    settings = read_words(OF_SHEET, words, shown)
    settings["jaw"] = read_jaw_stiffness(settings["jaw"])
    settings["day"] = settings["day"] or date.today()
    given = read_asked_loads(words.load, words.loads, shown)
    on_supports = is_supports_file(result_file)
    for_cam = ending in MODEL_ENDINGS
    has_room = not for_cam or ending in STEP_ENDINGS
    supported = words.supports or on_supports
    refuse_options_of_other_files(for_cam, has_room, path, supported, words.support_height, words.first_setup)
    return SheetTask(path, result_file, rank, settings, given, words, unit, on_supports)


def write(asked: SheetTask) -> None:
    """Write the sheet, or the set-up for a CAM system."""
    from workhold.presenting.assembly import STEP_ENDINGS
    from workhold.presenting.papers import write_model, write_paper

    result, rank, beside, loads = read_sheet_content(asked)
    settings, words = asked.settings | beside, asked.words
    is_bent = words.material is not None or result[rank - 1].bent is not None
    if words.part is not None and not is_bent and asked.path.suffix.lower() not in STEP_ENDINGS:
        raise InputError(
            "--part is for the part's shape in a .step, and for how far it bends: give --material, or leave it "
            "out."
        )
    if words.part is not None:
        from workhold.presenting.assembly import read_part_shape

        settings["shape"] = read_part_shape(words.part, result.workpiece)
    if words.first_setup is not None:
        settings["first_side"] = compare_with_earlier_result(result, rank, words.first_setup)
    if words.seating and result[rank - 1].seating is None and result.toolkit.closes_at_once:
        from workhold.cli.warming import compile_seating

        compile_seating(Event())
    if asked.is_for_cam:
        write_model(asked.path, result, rank, settings | {"unit": read_unit(asked.unit)})
        return
    unit: Unit = choose_printed_unit(asked.unit, result.toolkit)
    settings |= {"loads": loads or result.query.loads, "unit": unit}
    write_paper(asked.path, result, rank, asked.result_file, settings)


def read_sheet_content(asked: SheetTask) -> tuple[Result, int, dict[str, Any], tuple[Load, ...]]:
    """Return (result, rank of the fixture, further settings of the sheet such as its supports, loads)."""
    settings, loads = asked.settings, asked.loads
    if asked.on_supports:
        chosen = choose_supports_from_file(asked.result_file, asked.rank, settings, loads)
        beside = {
            "supports": chosen,
            "listed_as": "Supports",
            "number": chosen.number,
            "count": len(chosen.supports.triples),
        }
        flat = tuple(one for load in chosen.supports.loads if (one := load.planar) is not None)
        return chosen.supports.fixture.listing.result, 1, beside, flat
    result = read_result_with_rank(asked.result_file, asked.rank)
    if not asked.words.supports:
        return result, asked.rank, {}, loads
    chosen = choose_best_supports(
        result, asked.rank, settings["thickness"], loads or None, settings["jaw_force"]
    )
    return result, asked.rank, {"supports": chosen}, loads


def refuse_options_of_other_files(
    for_cam: bool,
    shows_supports: bool,
    path: Path,
    supported: bool,
    support_height: str | None,
    first_setup: str | None,
) -> None:
    """Raise InputError for options that the kind of file cannot have.

    A file for CAM (``for_cam``) cannot show contents that only paper can show. It shows supports
    (``supported``) only if ``shows_supports``. A support height needs supports.
    """
    if for_cam and first_setup is not None:
        raise InputError(
            f"--first-setup belongs to a sheet on paper, not to {path}: let the name end in .pdf, "
            ".svg or .png."
        )
    if supported and not shows_supports:
        raise InputError(
            f"{path} has no supports: let the name end in .pdf, .svg, .png or .step, or leave --supports out."
        )
    if support_height is not None and not supported:
        raise InputError("--support-height belongs to supports: give --supports, or leave it out.")
