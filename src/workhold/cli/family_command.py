"""``workhold family``: the fewest set-ups for many parts, and what each fewer one costs."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any

import typer

from workhold.cli.commands import option, spread
from workhold.cli.json_output import JsonOption, print_json
from workhold.cli.options import PartWords
from workhold.cli.outputs import ForceOption, refuse_output
from workhold.cli.progress import search_progress
from workhold.cli.saying import tell
from workhold.cli.search_options import QueryWords, with_fit_of
from workhold.cli.values import choice, length_unit, number, optional_count, picture_ending, positive_number
from workhold.cli.vise_options import ViseWords
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.cli.table import Table
    from workhold.family.family import Asked, Family, LeftOut
    from workhold.family.losses import Threshold
    from workhold.family.plan import Plan, SetUp
    from workhold.model.toolkit import Toolkit
    from workhold.model.units import Unit

__all__ = ["family"]

FAMILY, OUTPUT = "The family", "Results"
EVERY_TYPE = "both"
SECONDS = "60"
SHEET_ENDINGS = (".pdf", ".svg", ".png")
# A PNG is so many pixels wide; every set-up makes it higher.
PNG_WIDTH = 2400

UnfitOption = Annotated[
    bool,
    typer.Option("--unfit", help="Use also what is no fixture for a workshop.", rich_help_panel=FAMILY),
]
PartsArgument = Annotated[
    list[str],
    typer.Argument(
        metavar="PARTS...",
        help="The parts: DXF, SVG, JSON or STEP files, folders with such files, or built-in names.",
    ),
]


@spread
def family(
    parts: PartsArgument,
    *,
    held_in: ViseWords,
    max_loss: str | None = option(
        FAMILY, "LOSS", "Accept no larger loss than this, such as 1.25; the plan is then that of the fewest set-ups."
    ),
    setups: str | None = option(FAMILY, "K", "The plan is that of at most K set-ups, as good as those can be."),
    limit: list[str] | None = option(
        FAMILY,
        "FIGURE=VALUE",
        "Use no fixture whose figure is worse, such as location-error=0.05 (mm, N or degrees). May be repeated.",
    ),
    unfit: UnfitOption = False,
    time_limit: str = option(
        FAMILY,
        "SECONDS",
        "How long to prove that there are no fewer set-ups; then what is known is told.",
        default=SECONDS,
    ),
    words: QueryWords,
    type_: str = option(
        FAMILY, "I|II|both", "Of a vise: which arrangements of pegs to use.", "--type", default=EVERY_TYPE
    ),
    threads: str | None = option(FAMILY, "N", "Threads to use; all processors if not given."),
    out: str | None = option(OUTPUT, "FILE", "Write curve and plans to this JSON file."),
    draw: str | None = option(OUTPUT, "FILE", "Draw the curve into this file; its name ends in .svg or .png."),
    sheets: str | None = option(
        OUTPUT,
        "FILE",
        "Write the sheets of the plan, one for each set-up, to this file; its name ends in .pdf, .svg or .png.",
    ),
    force: ForceOption = False,
    json_: JsonOption = False,
    reading: PartWords,
) -> None:
    """Tell which peg patterns hold many of PARTS, and what each fewer set-up costs in quality.

    A loss is a fixture's location error, or the first figure of --rank-by, over the best that the part has in this vise
    or on this plate: 1 is the best, 2 is twice as bad. For each number of set-ups the least worst loss is told. Give
    --setups or --max-loss to see which pegs stand where and how each part lies.

    Example: workhold family drawings --vise plate-20mm --max-loss 1.25
    """
    shown = length_unit(reading.unit)
    loss = None if max_loss is None else loss_of(max_loss)
    most = optional_count("--setups", setups)
    seconds = positive_number("--time-limit", time_limit)
    workers = optional_count("--threads", threads)
    toolkit, tolerance = held_in.asked(shown)
    asked = words.asked(shown)
    asked["tolerance"] = with_fit_of(asked["tolerance"], tolerance)
    type_ = choice("--type", type_, (*toolkit.types, EVERY_TYPE))
    from workhold.family.covering import load_solver
    from workhold.files.part_list import part_list

    thresholds = [threshold_of(text) for text in limit or ()]
    load_solver()
    listed = part_list(parts)
    inputs = [*(one.path for one in listed), held_in.vise, held_in.toolkit, words.loads]
    if draw is not None:
        picture_ending(Path(draw))
    if sheets is not None and Path(sheets).suffix.lower() not in SHEET_ENDINGS:
        raise InputError(f"--sheets {sheets} names no kind of sheet: let the name end in .pdf, .svg or .png.")
    if sheets is not None and most is None and loss is None:
        raise InputError("--sheets needs a plan: say which with --setups or --max-loss.")
    outputs = [name for name in (out, draw, sheets) if name is not None]
    refuse_one_name_twice(outputs)
    for name in outputs:
        refuse_output(name, inputs, force)
    asked["arrangements"] = None if type_ == EVERY_TYPE else type_
    members, left_out = queries_of(listed, toolkit, asked, reading.options())
    if not members:
        raise InputError(f"none of the parts can be used: {left_out[0].name}: {left_out[0].reason}")
    start = perf_counter()
    from workhold.kernels.base.compiling import is_first_run

    first_run = is_first_run()
    if first_run:
        from workhold.cli.ending import ask_to_stop
        from workhold.cli.warming import compile_kernels

        with ask_to_stop("nothing is found yet") as cancel:
            compile_kernels(cancel)
    from workhold.family.family import family_of

    with search_progress(keeps=False) as progress:
        found = family_of(
            members,
            thresholds=thresholds,
            unfit=unfit,
            most_loss=loss,
            seconds=seconds,
            threads=workers,
            left_out=left_out,
            progress=progress,
        )
    plan = found.plan(most) if found.members and (most is not None or loss is not None) else None
    spent = f"{perf_counter() - start:.1f} s" + (", compiling on this first run included" if first_run else "")
    written = write_all(found, plan, out, draw, sheets, shown)
    if json_:
        from json import loads

        from workhold.family.file import family_text

        print_json(**loads(family_text(found)), written=written)
        return
    report(found, plan, spent, shown)
    if written:
        from workhold.cli.tables import print_tables

        print_tables(f"Written to {', '.join(written)}.")


def refuse_one_name_twice(names: list[str]) -> None:
    """Refuse outputs that would replace each other.

    Raises
    ------
    InputError
        Naming the file.
    """
    resolved = [Path(name).resolve() for name in names]
    for place, path in enumerate(resolved):
        if path in resolved[:place]:
            raise InputError(f"{names[place]} is named for two outputs: give each a name of its own.")


def write_all(
    found: Family, plan: Plan | None, out: str | None, draw: str | None, sheets: str | None, unit: Unit
) -> list[str]:
    """Write what was asked for; the names of the files written."""
    from workhold.files.atomic import write_bytes

    contents: dict[str, bytes] = {}
    if out is not None:
        from workhold.family.file import family_text

        contents[out] = family_text(found).encode("utf-8")
    if draw is not None and found.members:
        from workhold.drawing.render import render
        from workhold.family.curve_picture import draw_curve

        contents[draw] = render(draw_curve(found, None if plan is None else plan.point), Path(draw).suffix)
    if sheets is not None and plan is not None:
        contents[sheets] = sheets_bytes(found, plan, Path(sheets).suffix.lower(), unit)
    for name, content in contents.items():
        write_bytes(name, content)
    return list(contents)


def sheets_bytes(found: Family, plan: Plan, ending: str, unit: Unit) -> bytes:
    """The sheets of a plan as the bytes of a file."""
    from datetime import date

    from workhold.drawing.pdf import svg_to_pdf
    from workhold.drawing.render import svg_to_png
    from workhold.drawing.scene import stacked
    from workhold.family.setup_pages import draw_setups

    day = date.today()
    pages = draw_setups(plan, found.figure, day, unit)
    if ending == ".pdf":
        return svg_to_pdf(pages, day)
    return stacked(pages).encode("utf-8") if ending == ".svg" else svg_to_png(stacked(pages), PNG_WIDTH)


def loss_of(text: str) -> float:
    """A largest loss.

    Raises
    ------
    InputError
        For what is no number from 1 upward.
    """
    value = number(text)
    if not (isfinite(value) and value >= 1.0):
        raise InputError(f"--max-loss {text!r} is no loss: give 1 (the best each part has) or more, such as 1.25.")
    return value


def threshold_of(text: str) -> Threshold:
    """A threshold from words such as ``location-error=0.05``.

    Raises
    ------
    InputError
        For anything else.
    """
    from workhold.family.losses import threshold

    name, equals, value = text.partition("=")
    if not equals or not isfinite(number(value)):
        raise InputError(f"--limit {text!r} is no limit: give a figure and its value, such as location-error=0.05.")
    return threshold(name, number(value))


def queries_of(
    listed: Any, toolkit: Toolkit, asked: dict[str, Any], options: dict[str, Any]
) -> tuple[list[Asked], list[LeftOut]]:
    """What is asked for each part that can be read, and the parts that cannot."""
    from hashlib import sha256

    from workhold.family.family import Asked, LeftOut
    from workhold.family.losses import FAMILY_RANKING, PAIR_FAMILY_RANKING
    from workhold.files.part_list import read_listed
    from workhold.model.query import Query

    ranking = asked["ranking"] or (PAIR_FAMILY_RANKING if toolkit.needs_pairs else FAMILY_RANKING)
    members, left_out = [], []
    for one in listed:
        read = read_listed(one, **options)
        if read.loaded is None:
            left_out.append(LeftOut(one.name, str(one.path), read.refusal.rstrip(".")))
            continue
        for remark in read.loaded.remarks:
            tell(f"{one.name}: {remark}")
        digest = sha256(Path(one.path).read_bytes()).hexdigest() if Path(one.path).is_file() else ""
        query = Query(read.loaded.workpiece, toolkit, **{**asked, "ranking": ranking})
        members.append(Asked(one.name, query, str(one.path), digest))
    return members, left_out


def report(found: Family, plan: Plan | None, spent: str, unit: Unit) -> None:
    """Tell the curve, what was left out, and the plan."""
    from workhold.cli.tables import plural, print_tables

    toolkit = found.toolkit
    for part in found.left_out:
        tell(f"{part.name} is left out: {part.reason}.")
    if not found.members:
        print_tables(f"No pattern holds any of the parts {toolkit.wording.inside}; {spent}.")
        return
    assert found.table is not None
    print_tables(curve_table(found, unit))
    sentences = [
        f"{plural(len(found.members), 'part')}, {plural(len(found.table.words), 'pattern')} that hold at least one of them; "
        f"{spent}.",
        f"The loss is the {found.figure.words} over the best that each part has {toolkit.wording.inside}.",
    ]
    if not all(plan.point.is_least and plan.point.at_least == plan.point.setups for plan in found.plans):
        sentences.append("Time was over before all of it was proven: a longer --time-limit may show less.")
    print_tables(*sentences)
    if plan is None:
        print_tables("See the plan of a line with --setups K, or of the fewest set-ups within a loss with --max-loss.")
        return
    for number_, setup in enumerate(plan.setups, 1):
        heading = f"Set-up {number_} of {len(plan.setups)}: {pegs_words(setup, toolkit)}"
        place = "" if number_ == 1 else f" ({setup.moved} to place, the rest stands)"
        print_tables("", f"{heading}{place}", setup_table(setup, found, unit))
        if any(one.turned for one in setup.holdings):
            print_tables("A number with ' is that of the list after half a turn of everything, which swaps the jaws.")
        for one in setup.holdings:
            if not one.in_place:
                holes = ", ".join(peg.hole for peg in one.fixture.pegs)
                print_tables(f"{one.member.name} needs the same pegs in other columns: {holes}.")


def curve_table(found: Family, unit: Unit) -> Table:
    """The curve: set-ups, the worst loss and on which part, and how many pegs are moved."""
    from workhold.cli.tables import Table, figure_text, heading
    from workhold.family.losses import loss_text

    table = Table((">set-ups", ">worst loss", ">pegs moved", f">{heading(found.figure, unit)}", "worst part"))
    for plan in found.plans:
        point = plan.point
        worst = max((one for setup in plan.setups for one in setup.holdings), key=lambda one: one.loss)
        count = f"{point.setups}" if point.at_least == point.setups else f"{point.at_least} to {point.setups}"
        table.add_row(
            count,
            loss_text(point.loss),
            str(plan.moved),
            figure_text(found.figure, worst.figure, unit),
            worst.member.name,
        )
    return table


def pegs_words(setup: SetUp, toolkit: Toolkit) -> str:
    """The holes of a set-up."""
    return ", ".join(peg.hole for peg in setup.standing.fixture.pegs if not peg.is_on_wall)


def setup_table(setup: SetUp, found: Family, unit: Unit) -> Table:
    """The parts of a set-up and how each lies."""
    from workhold.cli.tables import Table, figure_text, heading
    from workhold.family.losses import loss_text
    from workhold.model.setting import settings_of

    settings = settings_of(setup.standing.fixture, found.toolkit)
    names = [f">{setting.sign} {unit.abbreviation}" for setting in settings]
    columns = ("part", ">fixture", ">angle", f">x {unit.abbreviation}", f">y {unit.abbreviation}", *names, ">loss")
    # With two clamps there are lengths enough for a terminal.
    with_figure = len(settings) < 2
    table = Table((*columns, f">{heading(found.figure, unit)}") if with_figure else columns)
    for one in setup.holdings:
        fixture = one.fixture
        pose = fixture.pose
        lengths = [unit.number(setting.length) for setting in settings_of(fixture, found.toolkit)]
        table.add_row(
            one.member.name,
            f"{one.number:,}" + ("'" if one.turned else ""),
            f"{pose.theta_deg:.3f}",
            unit.number(pose.x),
            unit.number(pose.y),
            *lengths,
            loss_text(one.loss),
            *([figure_text(found.figure, one.figure, unit)] if with_figure else []),
        )
    return table
