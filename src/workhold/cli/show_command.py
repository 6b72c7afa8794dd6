"""The command ``show``: how one fixture is set up, its quality, and what loads do to it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from attrs import frozen

from workhold.cli.commands import make_flag, make_option, print_remark, spread_option_groups
from workhold.cli.options import SHOWN_UNIT, RankArgument, ResultArgument, read_rank, read_result_with_rank
from workhold.cli.outputs import FORCE, JSON, print_json, read_picture_path, write_picture
from workhold.cli.search_options import LoadOptions
from workhold.cli.seat_command import describe_seating, describe_steps_by_hand
from workhold.cli.setup_sheets import BodyOptions, choose_best_supports, write_bodies
from workhold.cli.table import Table, print_tables
from workhold.cli.values import choose_printed_unit, read_optional_positive_length, read_unit
from workhold.errors import InputError
from workhold.units import MILLIMETRE, Unit

if TYPE_CHECKING:
    from pathlib import Path

    from workhold.fixels.toolkit import Toolkit
    from workhold.model.fixture import Fixture
    from workhold.model.part_bending import BendingFigures
    from workhold.model.result import Result
    from workhold.statics.bent_pegs import BentPegs
    from workhold.statics.loads import LoadCase

__all__ = ["tabulate_load_cases", "show"]


@frozen
class ShowTask:
    """A fixture to be shown.

    Parameters
    ----------
    pressed_by : the loads, jaw force, jaw and friction that were typed, see ``LoadOptions``.
    picture, models : files to write: a picture, and models in three dimensions.
    part : STEP file with the part's own shape, for the models.
    height : height of the part in mm in the models.
    on_supports : whether the models show the fixture on supports.
    freecad : the settings of FreeCAD's vise, by name; None where they were not asked for.
    unit, printed : unit of lengths typed, and of lengths shown.
    """

    result: Result
    rank: int
    pressed_by: Mapping[str, Any]
    picture: Path | None
    models: Sequence[Path]
    part: str | None
    height: float | None
    on_supports: bool
    freecad: Mapping[str, float] | None
    unit: Unit
    printed: Unit
    as_json: bool

    @property
    def fixture(self) -> Fixture:
        """The fixture of the rank."""
        return self.result[self.rank - 1]

    @property
    def closing(self) -> tuple[float | None, float]:
        """(jaw force in N as typed, or None; stiffness of the jaw)."""
        return self.pressed_by["jaw_force"], self.pressed_by["jaw"]


@spread_option_groups
def show(
    result_file: ResultArgument,
    number: RankArgument,
    *,
    draw: str | None = make_option(None, "FILE", "Draw it into this file, whose name ends in .svg or .png."),
    bodies: BodyOptions,
    freecad: bool = make_flag(
        None, "Also print the settings of a vise of FreeCAD's CAM workbench, for a plain vise.", "--freecad"
    ),
    force: bool = FORCE,
    words: LoadOptions,
    unit: str | None = SHOWN_UNIT,
    json_: bool = JSON,
) -> None:
    """Show how to set up fixture N of a result: the holes for the pegs, the opening and the part's pose.

    The output also has its quality, and what the loads do to it: the loads given here, or else those of the
    result. A hole is named by jaw, column letter and row number: L-B3 is in the left jaw, second column,
    third row from below.

    Example: workhold show part.json 1 --draw setup.png --glb setup.glb
    """
    asked = parse(result_file, read_rank(number), draw, bodies, freecad, force, words, unit, json_)
    report(asked, make_load_cases(asked))


def parse(
    result_file: str,
    rank: int,
    draw: str | None,
    bodies: BodyOptions,
    freecad: bool,
    force: bool,
    words: LoadOptions,
    unit: str | None,
    as_json: bool,
) -> ShowTask:
    """Return what was typed as a task, with the result read."""
    shown = read_unit(unit)
    pressed_by = words.read_arguments(shown)
    picture = read_picture_path(draw, (result_file, words.loads), force)
    models = bodies.list_given_model_files((result_file, words.loads), force)
    height = read_optional_positive_length("--thickness", bodies.thickness, shown)
    result = read_result_with_rank(result_file, rank)
    printed = choose_printed_unit(unit, result.toolkit)
    settings = None
    if freecad:
        from workhold.presenting.freecad_vise import make_freecad_settings

        settings = make_freecad_settings(result[rank - 1], result.toolkit.flat_jaws)
    return ShowTask(
        result,
        rank,
        pressed_by,
        picture,
        models,
        bodies.part,
        height,
        bodies.supports,
        settings,
        shown,
        printed,
        as_json,
    )


def make_load_cases(asked: ShowTask) -> tuple[LoadCase, ...]:
    """Return a load case for each load.

    It is () for a fixture that holds by friction, since the design has already checked the loads.
    """
    from workhold.statics.loads import compute_load_cases

    result, pressed_by = asked.result, asked.pressed_by
    if asked.fixture.hold is not None:
        if pressed_by["loads"]:
            raise InputError(
                "how hard flat jaws must press is found with the design: give it these loads, with --load or --loads."
            )
        return ()
    force, stiffness = asked.closing
    closed_with = result.query.jaw_force if force is None else force
    loads, friction = pressed_by["loads"] or result.query.loads, pressed_by["friction"]
    return compute_load_cases(
        asked.fixture, result.workpiece, result.toolkit, loads, closed_with, friction, stiffness
    )


def report(asked: ShowTask, cases: Sequence[LoadCase]) -> None:
    """Print the fixture, and write its picture and bodies."""
    result, rank = asked.result, asked.rank
    if not asked.as_json:
        print_fixture(result, rank, cases, asked.printed, asked.closing)
        if asked.freecad is not None:
            print_tables("", describe_freecad_settings(asked.freecad))
    if not result.complete:
        print_remark("the search for this result was interrupted; there may be better fixtures.")
    written = write(asked)
    if not asked.as_json:
        print_tables(*(f"Drawn in {path}." for path in written))
        return
    from workhold.presenting.data import describe_fixture, describe_load_case

    print_json(
        fixture=describe_fixture(asked.fixture, result.toolkit, rank),
        **list_program_clearances(result, rank, *asked.closing),
        **({} if asked.fixture.hold is not None else convert_bending_to_data(result, rank, asked.closing[0])),
        listed=len(result),
        complete=bool(result.complete),
        loads=[describe_load_case(case) for case in cases],
        written=[str(path) for path in written],
        **({} if asked.freecad is None else {"freecad": asked.freecad}),
    )


def describe_freecad_settings(settings: Mapping[str, float]) -> str:
    """Return a sentence with the settings of FreeCAD's vise, in mm and degrees."""
    said = ", ".join(f"{name} {value:g}" for name, value in settings.items())
    return f"FreeCAD's vise, in mm and degrees: {said}. X, Y and Z are where the drawing's origin lies."


def write(asked: ShowTask) -> list[Path]:
    """Write the picture and the bodies that were asked for; return their paths."""
    result, rank, fixture, picture = asked.result, asked.rank, asked.fixture, asked.picture
    if picture is not None:
        from workhold.drawing.fixture_pictures import draw_fixture
        from workhold.drawing.path_drawn import make_planned_path

        held, path = (fixture, result.workpiece, result.toolkit), make_planned_path(result, rank - 1)
        write_picture(picture, draw_fixture(*held, title=f"Fixture {rank}", unit=asked.printed, path=path))
    if asked.models:
        from workhold.presenting.assembly import Assembly, read_part_shape

        shape, chosen = read_part_shape(asked.part, result.workpiece), None
        if asked.on_supports:
            loads, force = asked.pressed_by["loads"] or None, asked.pressed_by["jaw_force"]
            chosen = choose_best_supports(result, rank, asked.height, loads, force)
        assembly = Assembly.from_fixture(fixture, result, {"thickness": asked.height}, chosen, shape)
        write_bodies(assembly, asked.models, asked.unit)
    return [*([] if picture is None else [picture]), *asked.models]


def print_fixture(
    result: Result, rank: int, cases: Sequence[LoadCase], unit: Unit, closing: tuple[float | None, float]
) -> None:
    """Print how to set up the fixture of a rank, its quality and what loads do to it.

    ``closing`` is the jaw force in N, None where it was not typed, and the stiffness of the jaw.
    """
    from workhold.cli.tables import (
        describe_part_overhang,
        explain_first_fixture,
        tabulate_fixture_setup,
        tabulate_quality,
    )
    from workhold.presenting.figure_words import find_edgeless_distance

    fixture, toolkit = result[rank - 1], result.toolkit
    bending = [] if fixture.bent is None else list_bending_sentences(fixture.bent, toolkit.moving.noun, unit)
    if fixture.hold is not None:
        print_tables(*tabulate_fixture_setup(fixture, toolkit, rank, len(result), unit), *bending)
        return
    force, longest = result.query.jaw_force, find_edgeless_distance(result.workpiece, toolkit)
    quality = tabulate_quality(fixture, toolkit.moving.noun, unit, force, longest)
    standing = describe_part_overhang(fixture, result, unit)
    print_tables(*tabulate_fixture_setup(fixture, toolkit, rank, len(result), unit), *standing, "", quality)
    if rank == 1 and (reason := explain_first_fixture(result, unit)):
        print_tables(reason)
    if fixture.seating is not None:
        print_tables(*describe_seating(fixture, result, unit))
    elif not toolkit.closes_at_once and rank <= (result.query.seating or 0):
        print_tables(*describe_steps_by_hand(rank, result, unit))
    print_tables(
        *describe_bending(result, rank, unit, closing[0]),
        *bending,
        *describe_program_clearances(result, rank, unit, *closing),
        *tabulate_load_cases(cases, fixture, toolkit, unit),
    )


def list_bending_sentences(bent: BendingFigures, mover: str, unit: Unit) -> list[str]:
    """Return sentences on how far a fixture bends its part, with a warning where the part would yield."""
    said = f"How far the part, of {bent.material.words}, is bent:"
    cautions = (f"Beware: {sentence}" for sentence in bent.list_warnings(None, unit))
    return ["", said, *bent.list_sentences(mover, unit), *cautions]


def compute_peg_bending(result: Result, rank: int, jaw_force: float | None) -> BentPegs | None:
    """Return how far the pegs of a fixture bend; None if the heights at which they press are not known.

    ``jaw_force`` in N replaces that of the result unless None.
    """
    from workhold.statics.bent_pegs import compute_bent_pegs

    query = result.query
    return compute_bent_pegs(
        result[rank - 1],
        result.workpiece,
        result.toolkit,
        pressed_top=query.pressed_top,
        jaw_force=query.jaw_force if jaw_force is None else jaw_force,
    )


def describe_bending(result: Result, rank: int, unit: Unit, jaw_force: float | None) -> list[Table | str]:
    """Return a table and sentences on how far pegs bend and how far that moves the part.

    It is [] if the heights at which pegs press are not known. ``jaw_force`` in N replaces the result's unless
    None.
    """
    bent = compute_peg_bending(result, rank, jaw_force)
    if bent is None:
        return []
    of, mover = unit.abbreviation, result.toolkit.moving.noun
    force, pressure = unit.force, unit.pressure
    table = Table(
        (
            "peg",
            f">Ø {of}",
            f">pressed at {of}",
            f">force {force}",
            f">gives way {of}",
            f">at worst {of}",
            f">stress {pressure}",
            f">at worst {pressure}",
        )
    )
    for peg in bent.pegs:
        table.add_row(
            peg.hole,
            unit.format_short_length(peg.diameter),
            unit.format_number(peg.height, unit.decimals - 1),
            f"{peg.force / unit.newtons:.0f}",
            unit.format_number(peg.deflection),
            unit.format_number(peg.worst_deflection),
            unit.format_stress_number(peg.stress),
            unit.format_stress_number(peg.worst_stress),
        )
    error = result[rank - 1].figures.get("location_error")
    return [
        "",
        f"Pegs bend as follows, {bent.describe_force(mover, unit)}, if they are built in at the plate; "
        "in a real hole they give way more:",
        table,
        bent.describe_bending(mover, unit, error),
        *(f"Beware: {sentence}" for sentence in bent.list_cautions(mover, unit)),
    ]


def tabulate_load_cases(
    cases: Sequence[LoadCase], fixture: Fixture, toolkit: Toolkit, unit: Unit = MILLIMETRE
) -> tuple[Table | str, ...]:
    """Return tables and sentences on the jaw force that each load needs and the peg forces; () without load
    cases.
    """
    if not cases:
        return ()
    from workhold.statics.loads import describe_jaw

    noun = toolkit.moving.noun
    with_friction = cases[0].needed_with_friction is not None
    columns = [
        "load",
        f">{noun} force needed {unit.force}",
        "peg that lets go first",
        f">worst at {unit.abbreviation}",
        ">direction deg",
    ]
    table = Table((*columns, *([f">needed with friction {unit.force}"] if with_friction else [])))
    for number, case in enumerate(cases, 1):
        worst = case.needed
        row = [
            case.load.name or f"load {number}",
            unit.format_force_number(worst.value),
            fixture.pegs[worst.peg].hole,
            f"({unit.format_number(worst.point[0])}, {unit.format_number(worst.point[1])})",
            f"{worst.direction:.1f}",
        ]
        table.add_row(
            *row, *([unit.format_force_number(case.needed_with_friction or 0.0)] if with_friction else [])
        )
    forces = Table(("load", *(f">{peg.hole} {unit.force}" for peg in fixture.pegs), "every peg presses"))
    for number, case in enumerate(cases, 1):
        extremes = zip(case.smallest, case.largest, strict=True)
        ranges = (" to ".join(map(unit.format_force_number, both)) for both in extremes)
        holds = "yes" if case.keeps_contact else "no: the part can move"
        forces.add_row(case.load.name or f"load {number}", *ranges, holds)
    notes = []
    if with_friction:
        notes.append(
            "With friction the forces are not determined; the force that is then needed is the least "
            "to be hoped for."
        )
    note = f"For {describe_jaw(cases[0].jaw_stiffness, toolkit)}, without friction; docs/quality.md explains both."
    return (
        "",
        table,
        *notes,
        "",
        f"Forces on the part at a {noun} force of {unit.format_force(cases[0].jaw_force)}:",
        forces,
        note,
    )


def list_program_clearances(
    result: Result, rank: int, jaw_force: float | None = None, jaw: str | float = "screw"
) -> dict[str, Any]:
    """Return "program_clearance" and "program_forces" as plain data; unknown ones are left out.

    The first says where the program's tools come nearest to the fixture, the second which clamping forces
    their cuts need. Jaw force and jaw are as for :func:`describe_program_clearances`.
    """
    from workhold.statics.program_clearance import find_nearest_passing
    from workhold.statics.program_forces import find_cutting_need

    near, need = find_nearest_passing(result, rank - 1), find_cutting_need(result, rank - 1, jaw_force, jaw)
    names = ("distance", "line", "tool", "element")
    passing = {} if near is None else {name: getattr(near, name) for name in names}
    data = {"program_clearance": passing} if passing else {}
    return data if need is None else data | {"program_forces": need.to_dict()}


def convert_bending_to_data(result: Result, rank: int, jaw_force: float | None = None) -> dict[str, Any]:
    """Return {"pins": how far pegs bend, as plain data}; {} if the heights at which pegs press are not known."""
    bent = compute_peg_bending(result, rank, jaw_force)
    return {} if bent is None else {"pins": bent.to_dict()}


def describe_program_clearances(
    result: Result, rank: int, unit: Unit, jaw_force: float | None = None, jaw: str | float = "screw"
) -> list[str]:
    """Return sentences on how near the program's tools come to a fixture and which clamping forces their cuts
    need.

    The list is empty without a program. ``jaw_force`` in N replaces the result's. For ``jaw`` see
    :func:`workhold.statics.loads.jaw_stiffness`.
    """
    from workhold.statics.program_clearance import find_nearest_passing
    from workhold.statics.program_forces import find_cutting_need

    program = result.query.program
    if program is None:
        return []
    near, need = find_nearest_passing(result, rank - 1), find_cutting_need(result, rank - 1, jaw_force, jaw)
    forces = (
        []
        if need is None
        else need.list_sentences(result.toolkit.moving.noun, unit, result.toolkit.travel_count)
    )
    if near is None:
        return [
            f"No tool of {program.name} comes down to the height of anything that holds the part.",
            *forces,
        ]
    return [
        f"The tools of {program.name} keep {unit.format_length(near.distance)} from all that holds the part; "
        f"T{near.tool} comes nearest in line {near.line}, to the {near.element}.",
        *forces,
    ]
