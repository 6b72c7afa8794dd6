"""The commands ``show`` and ``seat``: how one fixture is set up, and whether the part ends up in its pose.

The first also shows what loads do to the fixture, the second where else the part can come to rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING

from workhold.cli.commands import option, print_remark
from workhold.cli.options import SHOWN_UNIT, RankArgument, ResultArgument, asked_rank, result_with
from workhold.cli.outputs import ForceOption, JsonOption, asked_picture, print_json, write_picture
from workhold.cli.program_options import passing_data, passing_words
from workhold.cli.search_options import FRICTION, JAW, JAW_FORCE, LOAD, LOADS_FILE, asked_loads
from workhold.cli.seat_table import seat_table
from workhold.cli.setup_sheets import (
    BODY_THICKNESS,
    GLB,
    PART_FILE,
    STEP,
    SupportedOption,
    asked_models,
    write_fixture,
)
from workhold.cli.table import Table, print_tables
from workhold.cli.values import (
    choice,
    length_unit,
    optional_force,
    optional_positive_length,
    positive_number,
)
from workhold.units import MILLIMETRE, Unit

if TYPE_CHECKING:
    from workhold.fixels.toolkit import Toolkit
    from workhold.model.fixture import Fixture
    from workhold.model.result import Result
    from workhold.model.seating import Seat, Seating
    from workhold.seating.clamping import Gauge
    from workhold.statics.loads import LoadCase

__all__ = ["load_tables", "seat", "show"]


def load_tables(
    cases: Sequence[LoadCase], fixture: Fixture, toolkit: Toolkit, unit: Unit = MILLIMETRE
) -> tuple[Table | str, ...]:
    """Tabulates the force that each load needs, and each peg's forces at the closing force that is used."""
    if not cases:
        return ()
    from workhold.statics.loads import jaw_words

    noun = toolkit.moving.noun
    with_friction = cases[0].needed_with_friction is not None
    columns = [
        "load",
        f">{noun} force needed N",
        "peg that lets go first",
        f">worst at {unit.abbreviation}",
        ">direction deg",
    ]
    table = Table((*columns, *([">needed with friction N"] if with_friction else [])))
    for number, case in enumerate(cases, 1):
        worst = case.needed
        row = [
            case.load.name or f"load {number}",
            f"{worst.value:.1f}",
            fixture.pegs[worst.peg].hole,
            f"({unit.number(worst.point[0])}, {unit.number(worst.point[1])})",
            f"{worst.direction:.1f}",
        ]
        table.add_row(*row, *([f"{case.needed_with_friction:.1f}"] if with_friction else []))
    forces = Table(("load", *(f">{peg.hole} N" for peg in fixture.pegs), "every peg presses"))
    for number, case in enumerate(cases, 1):
        ranges = (f"{low:.1f} to {high:.1f}" for low, high in zip(case.smallest, case.largest, strict=True))
        holds = "yes" if case.keeps_contact else "no: the part can move"
        forces.add_row(case.load.name or f"load {number}", *ranges, holds)
    notes = []
    if with_friction:
        notes.append(
            "With friction the forces are not determined; what is needed with it is the best to be hoped for."
        )
    note = (
        f"For {jaw_words(cases[0].jaw_stiffness, toolkit)}, without friction; docs/quality.md explains both."
    )
    return (
        "",
        table,
        *notes,
        "",
        f"Forces on the part at a {noun} force of {cases[0].jaw_force:.1f} N:",
        forces,
        note,
    )


SIDES = ("both", "drawn", "turned-over")


def seat(
    result_file: ResultArgument,
    number: RankArgument,
    side: str = option(
        None, "WORD", "Which side of the part may lie up: drawn, turned-over, or both.", default="both"
    ),
    opening: str | None = option(
        None,
        "LENGTH",
        "Open the jaws, or draw the clamp back, by this much to put the part in; as far as they go if not "
        "given.",
    ),
    draw: str | None = option(None, "FILE", "Draw how the part can rest into this file, .svg or .png."),
    force: ForceOption = False,
    unit: str | None = SHOWN_UNIT,
    json_: JsonOption = False,
) -> None:
    """Report whether the part ends up in the pose of fixture N when the vise or the clamp is tightened.

    It says how wide open that may be when the part is let go, and how far off the part may lie. It lists
    where else the part can come to rest, and what is read then. Of two clamps it says how the part is put in
    by hand and in which order they are tightened.

    Example: workhold seat part.json 1 --draw seats.svg
    """
    rank = asked_rank(number)
    shown_unit = length_unit(unit)
    shown_side = choice("--side", side, SIDES)
    opened = optional_positive_length("--opening", opening, shown_unit)
    picture = asked_picture(draw, (result_file,), force)
    result = result_with(result_file, rank)
    fixture = result[rank - 1]

    from workhold.seating.clamping import Gauge

    if not result.toolkit.closes_at_once:
        print_by_hand(result, rank, picture, shown_unit, json_)
        return
    gauge, seating = Gauge(fixture, result.toolkit), fixture.seating
    if seating is None:
        from workhold.cli.warming import compile_seating
        from workhold.seating.pattern import refuse_unseated
        from workhold.seating.solver import Solver

        refuse_unseated(result.toolkit)
        compile_seating(Event())
        seating = Solver(result.workpiece, result.toolkit).of(fixture)
    seats = shown_seats(seating, shown_side, opened, result)
    if not json_:
        print_tables(
            f"Seating of fixture {rank} of {len(result)}: {result.workpiece.name}",
            "",
            *setting_words(seating, gauge, shown_unit),
            "",
            *wrong_words(seating, seats, opened, gauge, shown_unit),
            seat_table(seats, gauge, shown_unit),
        )
    for words in seating.unsettled:
        print_remark(words)
    if picture is not None:
        from workhold.drawing.seats import draw_seats

        svg = draw_seats(
            seats, fixture, result.workpiece, result.toolkit, title=f"Fixture {rank}", unit=shown_unit
        )
        write_picture(picture, svg)
        if not json_:
            print_tables(f"Drawn in {picture}.")
    if json_:
        print_json(rank=rank, seating=seating.as_fields(), written=[] if picture is None else [str(picture)])


def print_by_hand(result: Result, rank: int, picture: Path | None, unit: Unit, json_: bool) -> None:
    """Prints how the part gets into its place under two clamps, and draws how it lies there."""
    from workhold.drawing.fixture_pictures import draw_fixture
    from workhold.seating.clamping import by_hand

    fixture, written = result[rank - 1], [] if picture is None else [str(picture)]
    if picture is not None:
        svg = draw_fixture(fixture, result.workpiece, result.toolkit, title=f"Fixture {rank}", unit=unit)
        write_picture(picture, svg)
    if json_:
        steps = by_hand(fixture, result.workpiece, result.toolkit)
        print_json(rank=rank, seating=None, by_hand=steps.as_fields(unit.text), written=written)
        return
    print_tables(
        f"Seating of fixture {rank} of {len(result)}: {result.workpiece.name}",
        *by_hand_words(rank, result, unit),
    )
    print_tables(*(f"Drawn in {path}." for path in written))


def by_hand_words(rank: int, result: Result, unit: Unit) -> list[str]:
    """Lists in numbered steps how to put in a part that two clamps hold."""
    from workhold.seating.clamping import WHY, by_hand

    steps = by_hand(result[rank - 1], result.workpiece, result.toolkit).steps(unit.text)
    return ["", WHY, "", *(f"{number}. {step}" for number, step in enumerate(steps, 1))]


def shown_seats(seating: Seating, side: str, opened: float | None, result: Result) -> list[Seat]:
    """Lists the seats that can be reached; the fixture's own is first."""
    own = [one for one in seating.seats if one.is_own]
    rest = [
        one
        for one in seating.seats
        if not one.is_own and (side == "both" or one.mirrored == (side == "turned-over"))
    ]
    if opened is not None:
        rest = [one for one in rest if seating.clamping * one.difference < opened]
    most = result.toolkit.moving.travel.most if result.toolkit.moving.travel else None
    return own + [one for one in rest if most is None or one.jaw_separation <= most]


def seating_words(fixture: Fixture, result: Result, unit: Unit) -> list[str]:
    """Says of the seating of a fixture what to do, what to read, and what to beware of."""
    from workhold.seating.clamping import Gauge

    seating: Seating = fixture.seating
    gauge = Gauge(fixture, result.toolkit)
    beware = [f"Beware: {words}." for words in seating.warnings]
    seats = shown_seats(seating, SIDES[0], seating.opening, result)
    return [
        "",
        *setting_words(seating, gauge, unit),
        *wrong_words(seating, seats, seating.opening, gauge, unit),
        *beware,
    ]


def setting_words(seating: Seating, gauge: Gauge, unit: Unit) -> list[str]:
    """Says what to do to seat the part, and what to read when it went right."""
    from workhold.model.seating import DRY_STEEL

    setting, carrier, ways = gauge.setting, gauge.carrier, gauge.ways
    named = "" if setting.tip is None else f"a {setting.name} of "
    more, less = ("more", "less") if gauge.grows else ("less", "more")
    if seating.is_untold:
        words = [
            "From where on it is caught is not known: put the part in its place, hold it there and "
            f"{ways.close}."
        ]
    elif seating.capture_opening is None:
        words = [f"However {ways.far}, the part cannot get to another place: put it in and {ways.close}."]
    else:
        wide = gauge.at(gauge.fixture.jaw_separation + seating.clamping * seating.capture_opening)
        words = [
            f"{ways.open} to {named}{less} than {unit.text(wide)}, which is "
            f"{unit.text(seating.capture_opening)} from where {ways.hold} the part. Put the part in its "
            f"place and {ways.close}: on the way it cannot leave for another place."
        ]
    words.append(
        f"When it has come home the {setting.name} is {unit.text(setting.length)}. While that is {more}, "
        "the part is stuck short of its pose."
    )
    if seating.drop_room is not None and not seating.is_untold:
        words.append(
            f"{ways.done} so far, there is about {unit.text(seating.drop_room)} of room at every peg at once."
        )
    if seating.cage is not None and seating.placing is not None:
        low, high = seating.cage.theta_deg
        shifts = (
            (seating.cage.x, seating.cage.y) if carrier.line == "row" else (seating.cage.y, seating.cage.x)
        )
        along, across = (" to ".join(unit.number(end) for end in ends) for ends in shifts)
        words += [
            f"It may lie off by {low:.2f} to {high:.2f} degrees and by {along} {unit.abbreviation} along "
            f"the {ways.whose} way, {across} {unit.abbreviation} across it, as far as the pegs let it.",
            f"Put so that every point is nearer than {unit.text(seating.placing)} to its place, it comes "
            "home.",
        ]
    tap = "." if seating.sticking_friction >= DRY_STEEL else "; dry steel has 0.1 to 0.2, so tap it home."
    words.append(f"With a friction below {seating.sticking_friction:.3f} it cannot stick near its pose{tap}")
    return words


def wrong_words(
    seating: Seating, seats: list[Seat], opened: float | None, gauge: Gauge, unit: Unit
) -> list[str]:
    """Says how many wrong seats there are, and whether a reading shows them."""
    wrong = [one for one in seats if one.is_wrong]
    alike = sum(one.same_place and not one.is_own for one in seats)
    words = []
    if seating.capture_opening is not None and opened is not None and opened < seating.capture_opening:
        far = f"{gauge.ways.done} by {unit.text(opened)}"
        words.append(f"{far}, a part let go in its cage reaches no other place; let go elsewhere it may.")
    if not wrong:
        words.append("There is no wrong place where it can come to rest.")
    else:
        near = min(wrong, key=lambda one: abs(one.difference))
        more = gauge.at(near.jaw_separation) > gauge.setting.length
        places = "one wrong place" if len(wrong) == 1 else f"{len(wrong)} wrong places"
        words.append(
            f"It can come to rest in {places}; the reading nearest to the right one is "
            f"{unit.text(abs(near.difference))} {'more' if more else 'less'}."
        )
    if alike:
        words.append(
            f"In {alike} more it covers its place all the same, which no reading shows: mark the part."
        )
    return words


def show(
    result_file: ResultArgument,
    number: RankArgument,
    draw: str | None = option(None, "FILE", "Draw it into this file, whose name ends in .svg or .png."),
    glb: str | None = GLB,
    step: str | None = STEP,
    supports: SupportedOption = False,
    thickness: str | None = BODY_THICKNESS,
    part: str | None = PART_FILE,
    force: ForceOption = False,
    load: list[str] | None = LOAD,
    loads: str | None = LOADS_FILE,
    jaw_force: str | None = JAW_FORCE,
    jaw: str = JAW,
    friction: str | None = FRICTION,
    unit: str | None = SHOWN_UNIT,
    json_: JsonOption = False,
) -> None:
    """Show how to set up fixture N of a result: the holes for the pegs, the opening and the part's pose.

    Its quality is shown as well, and what loads do to it: those of the result, if none are given here. A hole
    is named by jaw, column letter and row number: L-B3 is the left jaw's second column, third row from below.

    Example: workhold show part.json 1 --draw setup.png --glb setup.glb
    """
    from workhold.statics.loads import jaw_stiffness, load_cases

    rank = asked_rank(number)
    shown_unit = length_unit(unit)
    closing_force = optional_force("--jaw-force", jaw_force)
    coefficient = positive_number("--friction", friction)
    asked = asked_loads(load, loads, shown_unit)
    picture = asked_picture(draw, (result_file, loads), force)
    models = asked_models(
        glb, step, (result_file, loads, part), force, thickness=thickness, supports=supports, part=part
    )
    height = optional_positive_length("--thickness", thickness, shown_unit)
    stiffness = jaw_stiffness(jaw)
    result = result_with(result_file, rank)
    fixture = result[rank - 1]
    loads_asked = asked or result.query.loads
    cases = load_cases(
        fixture, result.workpiece, result.toolkit, loads_asked, closing_force, coefficient, stiffness
    )
    if not json_:
        print_fixture(result, rank, cases, shown_unit, (closing_force, stiffness))
    if not result.complete:
        print_remark("the search for this result was interrupted; there may be better fixtures.")
    if picture is not None:
        from workhold.drawing.fixture_pictures import draw_fixture
        from workhold.drawing.path_drawn import planned_path

        path = planned_path(result, rank - 1)
        held = (fixture, result.workpiece, result.toolkit)
        svg = draw_fixture(*held, title=f"Fixture {rank}", unit=shown_unit, path=path)
        write_picture(picture, svg)
    if models:
        wishes = (height, asked or None, closing_force)
        write_fixture(result, rank, models, wishes, part, supported=supports, unit=shown_unit)
    written = [*([] if picture is None else [picture]), *models]
    if json_:
        from workhold.presenting.data import fixture_data, load_case_data

        print_json(
            fixture=fixture_data(fixture, result.toolkit, rank),
            **passing_data(result, rank, closing_force, stiffness),
            listed=len(result),
            complete=bool(result.complete),
            loads=[load_case_data(case) for case in cases],
            written=[str(path) for path in written],
        )
    else:
        print_tables(*(f"Drawn in {path}." for path in written))


def print_fixture(
    result: Result, rank: int, cases: Sequence[LoadCase], unit: Unit, closing: tuple[float | None, float]
) -> None:
    """Prints how to set up the fixture of a rank, its quality and what loads do to it.

    Parameters
    ----------
    closing : the jaw force in N, None where it is open, and how stiff the jaw is.
    """
    from workhold.cli.tables import fixture_tables, quality_table

    fixture, toolkit = result[rank - 1], result.toolkit
    quality = quality_table(fixture, toolkit.moving.noun, unit)
    print_tables(*fixture_tables(fixture, toolkit, rank, len(result), unit), "", quality)
    if fixture.seating is not None:
        print_tables(*seating_words(fixture, result, unit))
    elif not toolkit.closes_at_once and rank <= (result.query.seating or 0):
        print_tables(*by_hand_words(rank, result, unit))
    print_tables(*passing_words(result, rank, unit, *closing), *load_tables(cases, fixture, toolkit, unit))
