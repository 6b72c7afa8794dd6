"""The command ``straps``: where strap clamps hold the part of a fixture down with the least force."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer
from attrs import frozen

from workhold.cli.commands import make_option, print_remark, spread_option_groups
from workhold.cli.declared import read_coefficients, read_separated_lengths, read_zone
from workhold.cli.ending import INTERRUPTED, set_event_on_interrupt
from workhold.cli.options import SHOWN_UNIT, RankArgument, ResultArgument, read_rank, read_result_with_rank
from workhold.cli.outputs import JSON, print_json
from workhold.cli.program_options import ProgramOptions
from workhold.cli.support_words import read_spatial_load
from workhold.cli.supports_command import read_asked_thickness
from workhold.cli.table import Table, print_tables
from workhold.cli.values import (
    choose_printed_unit,
    read_choice,
    read_optional_count,
    read_optional_force,
    read_optional_length,
    read_positive_number,
    read_unit,
)
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.model.fixture import Fixture
    from workhold.model.straps import StrappedHold
    from workhold.supports.straps import StrapQuestion
    from workhold.units import Unit

__all__ = ["straps"]

STRAPS, PART, LOADS = "Straps", "Heights of the part", "Loads"


@frozen
class StrapOptions:
    """The options of straps and of the loads on the part, as typed; None for those not given."""

    count: str = make_option(STRAPS, "K", "Number of straps, 1 to 4.", default="2")
    tip_radius: str = make_option(STRAPS, "LENGTH", "Radius of a strap's round tip.", default="6mm")
    reach: str = make_option(
        STRAPS, "LEAST:MOST", "Distance of the tip from the middle of the bolt's hole.", default="20mm:60mm"
    )
    strap_force: str | None = make_option(
        STRAPS, "FORCE", "Rated force of each strap; a larger force gives a warning."
    )
    keep_out_above: list[str] | None = make_option(
        STRAPS, "ZONE", "A place on which no tip may stand, circle=X,Y,RADIUS or polygon=X,Y;X,Y;X,Y."
    )
    strap_height: str | None = make_option(
        STRAPS,
        "LENGTH",
        "How high a strap stands above the face that it presses on, with nut and stud, for the tools of a program; six "
        "radii of its tip if not given.",
    )
    over: str = make_option(
        STRAPS, "plate|supports", "What the part lies on: the plate, or three supports.", default="plate"
    )
    pad_radius: str | None = make_option(
        STRAPS, "LENGTH", "Radius of the supports' pads; the toolkit's, or a usual one, if not given."
    )
    pad_margin: str | None = make_option(
        STRAPS, "LENGTH", "Smallest distance of a pad from the border of the face that it supports."
    )
    support_height: str | None = make_option(
        STRAPS, "LENGTH", "How high the supports carry the part above the plate."
    )
    keep_out_below: list[str] | None = make_option(
        STRAPS, "ZONE", "A place that no pad may stand under, given as for --keep-out-above."
    )
    peg_height: str | None = make_option(
        PART,
        "LENGTH",
        "Height of the locators, which a tool of --program may hit; as high as the part if not given.",
    )
    load: list[str] | None = make_option(
        LOADS,
        "LOAD",
        "A load in space, written as for supports. If not given, the loads of the result act at the part's upper side.",
    )
    friction: str | None = make_option(
        LOADS,
        "NAME=NUMBER",
        "Coefficients of friction of tip and plate, such as tip=0.15,plate=0.15; else usual ones.",
    )
    safety: str | None = make_option(LOADS, "NUMBER", "Safety factor on the loads; 2 if not given.")
    weight: str | None = make_option(
        LOADS, "FORCE", "Weight of the part; if given, it helps to hold the part."
    )
    jaw_force: str | None = make_option(
        LOADS,
        "FORCE",
        "Force with which you tighten each strap, at its tip: the report says how many times it holds the loads. "
        "That of the result if not given.",
    )


@spread_option_groups
def straps(
    result_file: ResultArgument,
    number: RankArgument,
    *,
    words: StrapOptions,
    machined: ProgramOptions,
    unit: str | None = SHOWN_UNIT,
    json_: bool = JSON,
) -> None:
    """Report where strap clamps hold the part of fixture N down against its three locators, with the least force.

    The side clamps of the fixture are left out. A hand pushes the part against the locators until the straps
    are tight. Then friction under the tips and on the plate holds it. The report gives the force of each
    strap that the loads need, with the coefficients and the safety factor. The straps are the best of a
    finite set of places. The tools of the result's program, or of --program, keep clear of them. Their
    cutting forces, if known, count as loads.

    Example: workhold straps part.json 1 --thickness 25 --count 2 --load "force=300 at=50,30"
    """
    from workhold.supports.straps import find_straps
    from workhold.supports.words_of_straps import list_warnings

    rank, shown = read_rank(number), read_unit(unit)
    result = read_result_with_rank(result_file, rank)
    fixture, asked = result[rank - 1], read_question(words, machined, result, shown)
    with set_event_on_interrupt("the best straps so far are kept") as cancel:
        found = find_straps(fixture, result.query, asked, cancel)
    printed = choose_printed_unit(unit, result.toolkit)
    if json_:
        print_json(rank=rank, **describe(found, fixture, asked))
    else:
        print_tables(*tabulate(found, fixture, rank, asked, printed))
    for said in list_warnings(found, fixture, asked, printed):
        print_remark(said)
    if cancel.is_set():
        raise typer.Exit(INTERRUPTED)


def read_question(words: StrapOptions, machined: ProgramOptions, result: Any, unit: Unit) -> StrapQuestion:
    """Return the question of straps from the options as typed; lengths without a unit are in ``unit``.

    Raises InputError if nothing loads the part: no load, typed or in the result, and no program with forces.
    """
    from workhold.model.friction import SAFETY, to_coefficients
    from workhold.model.straps import StrapHardware
    from workhold.model.support_request import SpatialLoad
    from workhold.supports.straps import (
        NO_LOADS,
        PadSizes,
        StrapQuestion,
        choose_support_height,
        find_given_force,
        make_pads_request,
        make_usual_request,
    )

    count, tip = (
        read_optional_count("--count", words.count),
        read_optional_length("--tip-radius", words.tip_radius, unit),
    )
    assert count is not None
    assert tip is not None
    least, most = read_separated_lengths("--reach", words.reach, ":", 2, unit)
    hardware = StrapHardware(
        count,
        tip,
        (least, most),
        read_optional_force("--strap-force", words.strap_force),
        read_optional_length("--strap-height", words.strap_height, unit),
    )
    query = result.query
    cut = machined.read_query_arguments(unit, words.peg_height, query.workpiece)
    high = query.part_height if machined.thickness is None else None
    high = high or read_asked_thickness(True, machined.thickness, query.workpiece, unit)
    assert high is not None
    typed = cut.get("program")
    program = query.program if typed is None else typed.keep_forces_on(query.workpiece.outer_loops)
    zones = [read_zone("--keep-out-above", text, unit) for text in words.keep_out_above or ()]
    loads = (
        [read_spatial_load(text, high, unit) for text in words.load]
        if words.load
        else [SpatialLoad.from_planar_load(load) for load in query.loads]
    )
    if not loads and (program is None or program.forces is None):
        raise InputError(NO_LOADS)
    request, pads = make_usual_request(query, high, tip, zones), None
    if read_choice("--over", words.over, ("plate", "supports")) == "supports":
        sizes = (
            read_optional_length(f"--{name.replace('_', '-')}", getattr(words, name), unit)
            for name in ("pad_radius", "pad_margin", "support_height")
        )
        pads = PadSizes(*sizes)
        below = [read_zone("--keep-out-below", text, unit) for text in words.keep_out_below or ()]
        request = make_pads_request(query, request, below, pads)
    given = read_optional_force("--jaw-force", words.jaw_force)
    return StrapQuestion(
        hardware,
        request,
        tuple(loads),
        to_coefficients(None if words.friction is None else read_coefficients("--friction", words.friction)),
        SAFETY if words.safety is None else read_positive_number("--safety", words.safety),
        read_optional_force("--weight", words.weight) or 0.0,
        is_over_supports=pads is not None,
        program=program,
        given_force=find_given_force(query) if given is None else given,
        support_height=choose_support_height(query, pads),
        peg_height=None if typed is None else cut["peg_height"] or high,
    )


def describe(found: StrappedHold, fixture: Fixture, asked: StrapQuestion) -> dict[str, Any]:
    """Return the straps found as plain data for JSON: pegs, pose, straps, friction, safety factor and weight."""
    from workhold.files.result.strapped_text import make_strap_need_entry
    from workhold.model.friction import find_friction_coefficient

    return {
        "type": "strapped",
        "pegs": [
            {"column": peg.column, "row": peg.row, "x": peg.x, "y": peg.y, "segment": peg.face}
            for peg in asked.list_locators(fixture)
        ],
        "pose": {"theta_deg": fixture.pose.theta_deg, "x": fixture.pose.x, "y": fixture.pose.y},
        **found.to_data(),
        "friction": {name: find_friction_coefficient(asked.friction, name) for name in asked.counted},
        "safety": asked.safety,
        "weight": asked.weight,
        **({} if asked.given_force is None else {"jaw_force": asked.given_force}),
        **({} if found.program_need is None else {"program_force": make_strap_need_entry(found)}),
    }


def tabulate(
    found: StrappedHold, fixture: Fixture, rank: int, asked: StrapQuestion, unit: Unit
) -> list[Table | str]:
    """Return sentences and tables on how to set the straps up, and the force that each load needs."""
    from workhold.cli.strap_tables import list_strap_forces
    from workhold.supports.words_of_straps import list_remarks, list_steps

    short = unit.abbreviation
    out: list[Table | str] = [f"Straps over the locators of fixture {rank}", ""]
    out += [f"{step}." for step in list_steps(found, fixture, asked, unit)] + list_remarks(found)
    if found.straps:
        table = Table(("strap", "bolt in", f">tip at x {short}", f">tip at y {short}"))
        plate = asked.get_bolt_holes(fixture)
        for number, one in enumerate(found.straps, 1):
            table.add_row(
                str(number), plate.name_place(*one.hole), *(unit.format_number(value) for value in one.at)
            )
        out += ["", table]
    return out + list_strap_forces(found, asked, unit)
