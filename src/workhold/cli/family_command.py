"""The command ``workhold family``: the fewest set-ups for many parts, and the loss in quality for each number
of set-ups.

The terminal shows the curve, the excluded parts, and the plan.
"""

from __future__ import annotations

from datetime import date
from math import isfinite
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any

import typer
from attrs import frozen

from workhold.cli.commands import (
    make_default_group,
    make_flag,
    make_option,
    print_remark,
    spread_option_groups,
)
from workhold.cli.ending import INTERRUPTED, set_event_on_interrupt
from workhold.cli.jobs import list_family_parts, make_family_queries
from workhold.cli.options import PartOptions
from workhold.cli.outputs import FORCE, JSON, OUTPUT, print_json, refuse_output
from workhold.cli.program_options import ProgramOptions
from workhold.cli.progress import show_search_progress
from workhold.cli.search_options import QueryOptions
from workhold.cli.table import Table, format_count, print_tables
from workhold.cli.toolkit_options import ToolkitOptions
from workhold.cli.values import (
    choose_printed_unit,
    read_choice,
    read_number,
    read_optional_count,
    read_picture_ending,
    read_positive_number,
    read_unit,
)
from workhold.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from workhold.family.family import ExcludedPart, Family, MemberRequest
    from workhold.family.members import FigureThreshold
    from workhold.family.plan import FamilyPlan, SetUp
    from workhold.units import Unit

__all__ = ["family"]

FAMILY = "The family"
EVERY_TYPE = "both"
SECONDS = "60"
SHEET_ENDINGS = (".pdf", ".svg", ".png")

PartsArgument = Annotated[
    list[str],
    typer.Argument(
        metavar="PARTS...",
        help="Parts: files, folders with drawings, built-in names; or files of jobs (.toml, .csv), each "
        "with its part, restrictions and loads.",
    ),
]


@frozen
class FamilyOptions:
    """The options that describe the wanted set-ups, as typed."""

    max_loss: str | None = make_option(
        FAMILY,
        "LOSS",
        "Accept no larger loss than this, such as 1.25; the plan then has the fewest set-ups.",
    )
    setups: str | None = make_option(
        FAMILY, "K", "The plan has at most K set-ups, and the least loss that so few allow."
    )
    limit: list[str] | None = make_option(
        FAMILY,
        "FIGURE=VALUE",
        "Use no fixture with a worse figure than this, such as location-error=0.05, or grip=6 in a plain "
        "vise (mm, N or degrees). May be repeated.",
    )
    unfit: bool = make_flag(FAMILY, "Also use fixtures that no workshop can use.", "--unfit")
    both_sides: bool = make_flag(
        FAMILY, "Also hold every part turned over, for the second operation.", "--both-sides"
    )
    zero: str | None = make_option(
        FAMILY,
        "POINT",
        "The parts' zero: corner (lower left, as drawn), centre, hole N, or X,Y of the drawing. "
        "If not given, the origin of the drawing if that lies on the part, else the corner.",
    )
    same_zero: bool = make_flag(
        FAMILY, "All parts of a set-up have their zero at the same place and the same turn.", "--same-zero"
    )
    time_limit: str = make_option(
        FAMILY,
        "SECONDS",
        "Longest time to prove that no fewer set-ups do; then the results so far are reported.",
        default=SECONDS,
    )
    thickness: str | None = make_option(
        FAMILY,
        "LENGTH",
        "For a plain vise: thickness of the parts that are drawings; a file of jobs has that of each part.",
    )
    type_: str = make_option(
        FAMILY, "I|II|both", "For a vise: the arrangements of pegs to use.", "--type", default=EVERY_TYPE
    )
    threads: str | None = make_option(FAMILY, "N", "Threads to use; all processors if not given.")

    @property
    def ask_for_plan(self) -> bool:
        """Whether a plan is asked for, by a number of set-ups or a largest loss."""
        return self.setups is not None or self.max_loss is not None

    def read_arguments(self) -> dict[str, Any]:
        """Return keyword arguments of ``family.family.make_family`` from the options as typed."""
        return {
            "most_loss": None if self.max_loss is None else read_largest_loss(self.max_loss),
            "seconds": read_positive_number("--time-limit", self.time_limit),
            "threads": read_optional_count("--threads", self.threads),
            "thresholds": [read_threshold(text) for text in self.limit or ()],
            "unfit": self.unfit,
            "same_zero": self.same_zero,
        }


@frozen
class FamilyOutputOptions:
    """The options that choose where curve and plans go, as typed."""

    out: str | None = make_option(OUTPUT, "FILE", "Write curve and plans to this JSON file.")
    draw: str | None = make_option(
        OUTPUT, "FILE", "Draw the curve into this file; its name ends in .svg or .png."
    )
    sheets: str | None = make_option(
        OUTPUT,
        "FILE",
        "Write the sheets of the plan, one for each set-up, to this file; its name ends in .pdf, .svg or "
        ".png.",
    )
    force: bool = FORCE
    json_: bool = JSON

    def refuse(self, inputs: Sequence[str | Path | None], has_plan: bool) -> None:
        """Raise InputError for outputs that cannot be written, before anything is searched."""
        if self.draw is not None:
            read_picture_ending(Path(self.draw))
        if self.sheets is not None and Path(self.sheets).suffix.lower() not in SHEET_ENDINGS:
            raise InputError(
                f"--sheets {self.sheets} names no kind of sheet: let the name end in .pdf, .svg or .png."
            )
        if self.sheets is not None and not has_plan:
            raise InputError("--sheets needs a plan: choose one with --setups or --max-loss.")
        outputs = [name for name in (self.out, self.draw, self.sheets) if name is not None]
        resolved = [Path(name).resolve() for name in outputs]
        for place, name in enumerate(outputs):
            if resolved[place] in resolved[:place]:
                raise InputError(f"{name} is named for two outputs: give each a name of its own.")
        for name in outputs:
            refuse_output(name, inputs, self.force)


@frozen
class FamilyTask:
    """A family of parts, and the form of the answer.

    Parameters
    ----------
    rules : keyword arguments of ``family.family.make_family``.
    setups : largest number of set-ups in the plan; None for as many as keep within the largest loss.
    has_plan : whether a plan is asked for.
    unit : of lengths shown.
    """

    members: Sequence[MemberRequest]
    left_out: Sequence[ExcludedPart]
    rules: Mapping[str, Any]
    setups: int | None
    has_plan: bool
    written: FamilyOutputOptions
    unit: Unit


@frozen
class FamilyAnswer:
    """The family that was found, the plan that was asked for, and the time it took in words."""

    found: Family
    plan: FamilyPlan | None
    spent: str


@spread_option_groups
def family(
    parts: PartsArgument,
    *,
    held_in: ToolkitOptions,
    planned: FamilyOptions,
    words: QueryOptions,
    written: FamilyOutputOptions,
    reading: PartOptions,
) -> None:
    """Report which peg patterns hold many of PARTS, and how much quality is lost with fewer set-ups.

    The loss of a fixture is its location error, or the first figure of --rank-by, divided by the best that
    the part has in this toolkit: 1 is the best, 2 is twice as bad. For each number of set-ups the report
    gives the smallest loss within which all parts can be held. Give --setups or --max-loss to see the holes
    of the pegs and the position of each part.

    Example: workhold family drawings --vise plate-20mm --max-loss 1.25
    """
    asked = parse(parts, held_in, planned, words, written, reading)
    report(asked, find_asked_family(asked))


def parse(
    parts: list[str],
    held_in: ToolkitOptions,
    planned: FamilyOptions,
    words: QueryOptions,
    written: FamilyOutputOptions,
    reading: PartOptions,
) -> FamilyTask:
    """Return what was typed as a task, with the parts read."""
    shown = read_unit(reading.unit)
    setups = read_optional_count("--setups", planned.setups)
    rules = planned.read_arguments()
    toolkit, tolerance = held_in.read_toolkit(shown)
    words.read_arguments(shown)
    type_ = read_choice("--type", planned.type_, (*toolkit.types, EVERY_TYPE))
    types = None if type_ == EVERY_TYPE else type_
    from workhold.family.solver import load_solver

    load_solver()
    machined = make_default_group(ProgramOptions, thickness=planned.thickness)
    jobs = list_family_parts(parts, words, reading, machined, toolkit)
    files = [name for job in jobs for name in (job.listed.path, job.words.loads, *job.machined.files)]
    written.refuse((*parts, *files, held_in.vise, held_in.toolkit), planned.ask_for_plan)
    members, left_out = make_family_queries(
        jobs, toolkit, tolerance, types, planned.zero, both_sides=planned.both_sides
    )
    if not members:
        raise InputError(f"none of the parts can be used: {left_out[0].name}: {left_out[0].reason}")
    unit = choose_printed_unit(reading.unit, toolkit)
    return FamilyTask(members, left_out, rules, setups, planned.ask_for_plan, written, unit)


def find_asked_family(asked: FamilyTask) -> FamilyAnswer:
    """Return the family of peg patterns that hold the parts, and the plan if one was asked for.

    Exits with INTERRUPTED after Ctrl-C while kernels are compiled.
    """
    from workhold.cli.warming import compile_kernels

    start = perf_counter()
    with set_event_on_interrupt("nothing is found yet") as cancel:
        compiled = ", compiling on this first run included" if compile_kernels(cancel) else ""
    if cancel.is_set():
        raise typer.Exit(INTERRUPTED)
    from workhold.family.family import make_family

    with show_search_progress(keeps=False) as progress:
        found = make_family(asked.members, left_out=asked.left_out, progress=progress, **asked.rules)
    plan = found.plan(asked.setups) if found.members and asked.has_plan else None
    return FamilyAnswer(found, plan, f"{perf_counter() - start:.1f} s{compiled}")


def report(asked: FamilyTask, answer: FamilyAnswer) -> None:
    """Write the files, and print curve and plan, or JSON."""
    written = write_files(asked, answer)
    if asked.written.json_:
        from json import loads

        from workhold.family.family import format_family_json

        print_json(**loads(format_family_json(answer.found)), written=written)
        return
    print_family(answer, asked.unit)
    if written:
        print_tables(f"Written to {', '.join(written)}.")


def write_files(asked: FamilyTask, answer: FamilyAnswer) -> list[str]:
    """Write the files that were asked for and can be made; return their names."""
    from workhold.files.atomic import write_bytes

    found, plan, names, contents = answer.found, answer.plan, asked.written, dict[str, bytes]()
    if names.out is not None:
        from workhold.family.family import format_family_json

        contents[names.out] = format_family_json(found).encode("utf-8")
    if names.draw is not None and found.members:
        from workhold.drawing.render import render
        from workhold.family.pages import draw_curve

        curve = draw_curve(found, None if plan is None else plan.point)
        contents[names.draw] = render(curve, Path(names.draw).suffix)
    if names.sheets is not None and plan is not None:
        from workhold.family.pages import draw_setups
        from workhold.presenting.papers import make_pages_file

        day = date.today()
        pages = draw_setups(plan, found.figure, day, asked.unit)
        contents[names.sheets] = make_pages_file(pages, Path(names.sheets).suffix.lower(), day)
    for name, content in contents.items():
        write_bytes(name, content)
    return list(contents)


def print_family(answer: FamilyAnswer, unit: Unit) -> None:
    """Print the excluded parts, the curve and the plan, each if there is one."""
    found, plan, spent = answer.found, answer.plan, answer.spent
    toolkit = found.toolkit
    for part in found.left_out:
        print_remark(f"{part.name} is left out: {part.reason}.")
    if not found.members:
        print_tables(f"No {found.setup_noun} holds any of the parts {toolkit.wording.inside}; {spent}.")
        return
    from workhold.family.members import describe_loss

    assert found.table is not None
    print_tables(tabulate_family_curve(found, unit))
    sentences = [
        f"{format_count(len(found.members), 'part')}, {format_count(found.setup_count, found.setup_noun)} that hold at "
        f"least one of them; {spent}.",
        describe_loss(found.figure, toolkit.wording.inside),
    ]
    if not all(plan.point.is_least and plan.point.at_least == plan.point.setups for plan in found.plans):
        sentences.append("The time was up before all of it was proven: a longer --time-limit may show less.")
    print_tables(*sentences)
    if plan is None:
        print_tables(
            "Show the plan of a line with --setups K, or of the fewest set-ups within a loss with --max-loss."
        )
        return
    print_plan(plan, found, unit)


def print_plan(plan: FamilyPlan, found: Family, unit: Unit) -> None:
    """Print for each set-up the holes of its pegs, and the position of each part in it."""
    from workhold.family.jaw_setups import describe_changes, describe_jaw_setup

    before: SetUp | None = None
    for count, setup in enumerate(plan.setups, 1):
        heading = f"Set-up {count} of {len(plan.setups)}: "
        if setup.jaws is None:
            heading += ", ".join(peg.hole for peg in setup.standing.fixture.placed)
            place = "" if count == 1 else f" ({setup.moved} to place, the others stay)"
        else:
            heading += describe_jaw_setup(setup.jaws, found.toolkit, unit)
            place = "" if before is None else f" ({describe_changes(setup.jaws, before.jaws)})"
        before = setup
        print_tables("", f"{heading}{place}", tabulate_setup(setup, found, unit))
        for one in setup.holdings:
            if not one.in_place:
                holes = ", ".join(peg.hole for peg in one.fixture.pegs)
                print_tables(f"{one.member.name} needs the same pegs in other columns: {holes}.")

    if any(one.turned for setup in plan.setups for one in setup.holdings):
        print_tables(
            "",
            "A number with ' is the fixture's number in the list after half a turn of everything, "
            "which swaps the jaws.",
        )


def tabulate_family_curve(found: Family, unit: Unit) -> Table:
    """Return a table with a row for each number of set-ups: loss, pegs moved, figure and worst part."""
    from workhold.family.members import format_loss
    from workhold.presenting.figure_words import format_figure_number, make_heading

    moved = ">pegs moved" if found.toolkit.flat_jaws is None else ">changes"
    table = Table((">set-ups", ">worst loss", moved, f">{make_heading(found.figure, unit)}", "worst part"))
    for plan in found.plans:
        point = plan.point
        worst = max((one for setup in plan.setups for one in setup.holdings), key=lambda one: one.loss)
        count = f"{point.setups}" if point.at_least == point.setups else f"{point.at_least} to {point.setups}"
        table.add_row(
            count,
            format_loss(point.loss),
            str(plan.moved),
            format_figure_number(found.figure, worst.figure, unit),
            worst.member.name,
        )
    return table


def tabulate_setup(setup: SetUp, found: Family, unit: Unit) -> Table:
    """Return a table with a row for each part that a set-up holds:
    fixture, pose, lengths to set, loss and figure.
    """
    from workhold.family.members import format_loss
    from workhold.model.hold_words import describe_touched_faces
    from workhold.model.setup import list_length_settings
    from workhold.presenting.figure_words import format_figure_number, make_heading

    settings = list_length_settings(setup.standing.fixture, found.toolkit)
    names = [f">{setting.short} {unit.abbreviation}" for setting in settings]
    is_held_by_jaws = setup.jaws is not None
    places = ("x", "y") if not is_held_by_jaws else ("X0", "Y0")
    columns = (
        "part",
        ">fixture",
        *(["on the fixed jaw"] if is_held_by_jaws else []),
        ">angle",
        *(f">{place} {unit.abbreviation}" for place in places),
        *names,
        ">loss",
    )
    table = Table((*columns, f">{make_heading(found.figure, unit)}"), spare=1)
    for one in setup.holdings:
        fixture = one.fixture
        pose = fixture.pose
        lengths = [
            unit.format_number(setting.length) for setting in list_length_settings(fixture, found.toolkit)
        ]
        x, y = pose.apply(*one.member.zero.point) if is_held_by_jaws else (pose.x, pose.y)
        table.add_row(
            one.member.name,
            f"{one.number:,}" + ("'" if one.turned else ""),
            *([] if one.hold is None else [describe_touched_faces(one.hold.fixed)]),
            f"{pose.written_deg:.3f}",
            unit.format_number(x),
            unit.format_number(y),
            *lengths,
            format_loss(one.loss),
            format_figure_number(found.figure, one.figure, unit),
        )
    return table


def read_largest_loss(text: str) -> float:
    """Return a largest loss; raise InputError for what is not a number of 1 or more."""
    value = read_number(text)
    if not (isfinite(value) and value >= 1.0):
        raise InputError(
            f"--max-loss {text!r} is not a loss: give 1 (the best each part has) or more, such as 1.25."
        )
    return value


def read_threshold(text: str) -> FigureThreshold:
    """Return a threshold of a figure from words such as ``location-error=0.05``;
    raise InputError for anything else.
    """
    from workhold.family.members import make_threshold

    name, equals, value = text.partition("=")
    if not equals or not isfinite(read_number(value)):
        raise InputError(
            f"--limit {text!r} is not a limit: give a figure and its value, such as location-error=0.05."
        )
    return make_threshold(name, read_number(value))
