"""``workhold show``: how to set up one fixture of a result file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from workhold.cli.commands import option
from workhold.cli.json_output import JsonOption, print_json
from workhold.cli.options import SHOWN_UNIT
from workhold.cli.outputs import ForceOption, refuse_output
from workhold.cli.ranked import RankArgument, ResultArgument, asked_rank, result_with
from workhold.cli.saying import tell
from workhold.cli.search_options import FRICTION, JAW, JAW_FORCE, LOAD, LOADS_FILE, asked_loads
from workhold.cli.values import length_unit, optional_force, picture_ending, positive_number

if TYPE_CHECKING:
    from workhold.model.result import Result
    from workhold.statics.loads import LoadCase
    from workhold.units import Unit

__all__ = ["show"]


def show(
    result_file: ResultArgument,
    number: RankArgument,
    draw: str | None = option(None, "FILE", "Draw it into this file, whose name ends in .svg or .png."),
    force: ForceOption = False,
    load: list[str] | None = LOAD,
    loads: str | None = LOADS_FILE,
    jaw_force: str | None = JAW_FORCE,
    jaw: str = JAW,
    friction: str | None = FRICTION,
    unit: str | None = SHOWN_UNIT,
    json_: JsonOption = False,
) -> None:
    """Show how to set up fixture N of a result: the holes for the pegs, the opening, the part's pose, its quality, and what
    loads do to it (those of the result, if none are given here).

    A hole is named by jaw, column letter and row number: L-B3 is the left jaw's second column, third row from below.

    Example: workhold show part.json 1 --draw setup.png
    """
    from workhold.files.atomic import write_bytes

    rank = asked_rank(number)
    shown_unit = length_unit(unit)
    closing_force = optional_force("--jaw-force", jaw_force)
    coefficient = positive_number("--friction", friction)
    asked = asked_loads(load, loads, shown_unit)
    picture = None if draw is None else Path(draw)
    ending = None
    if picture is not None:
        ending = picture_ending(picture)
        refuse_output(picture, (result_file, loads), force)

    from workhold.statics.jaw import jaw_stiffness

    stiffness = jaw_stiffness(jaw)
    result = result_with(result_file, rank)
    fixture = result[rank - 1]

    from workhold.statics.loads import load_cases

    loads_asked = asked or result.query.loads
    cases = load_cases(fixture, result.workpiece, result.toolkit, loads_asked, closing_force, coefficient, stiffness)
    if not json_:
        print_fixture(result, rank, cases, shown_unit)
    if not result.complete:
        tell("the search for this result was interrupted; there may be better fixtures.")
    if picture is not None and ending is not None:
        from workhold.drawing.fixture_picture import draw_fixture
        from workhold.drawing.render import render

        svg = draw_fixture(fixture, result.workpiece, result.toolkit, title=f"Fixture {rank}", unit=shown_unit)
        write_bytes(picture, render(svg, ending))
    if json_:
        from workhold.presenting.data import fixture_data, load_case_data

        print_json(
            fixture=fixture_data(fixture, result.toolkit, rank),
            listed=len(result),
            complete=bool(result.complete),
            loads=[load_case_data(case) for case in cases],
            written=[] if picture is None else [str(picture)],
        )
    elif picture is not None:
        from workhold.cli.tables import print_tables

        print_tables(f"Drawn in {picture}.")


def print_fixture(result: Result, rank: int, cases: Sequence[LoadCase], unit: Unit) -> None:
    """Print how to set up the fixture of a rank, its quality and what loads do to it."""
    from workhold.cli.load_tables import load_tables
    from workhold.cli.tables import fixture_tables, print_tables, quality_table

    fixture, toolkit = result[rank - 1], result.toolkit
    quality = quality_table(fixture, toolkit.moving.noun, unit)
    print_tables(*fixture_tables(fixture, toolkit, rank, len(result), unit), "", quality)
    if fixture.seating is not None:
        from workhold.cli.seat_command import seating_words

        print_tables(*seating_words(fixture, result, unit))
    elif not toolkit.closes_at_once and rank <= (result.query.seating or 0):
        from workhold.cli.seat_command import by_hand_words

        print_tables(*by_hand_words(rank, result, unit))
    print_tables(*load_tables(cases, fixture, toolkit, unit))
