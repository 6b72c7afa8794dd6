"""Tables and sentences for the terminal of seats under straps."""

from __future__ import annotations

from typing import TYPE_CHECKING

from workhold.cli.need_table import format_safety, tabulate_needs
from workhold.cli.table import Table
from workhold.presenting.figure_words import format_rounded
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.listing.identity import ShownEntries
    from workhold.model.fixture import Fixture
    from workhold.model.result import Result
    from workhold.model.straps import StrappedHold
    from workhold.supports.straps import StrapQuestion

__all__ = ["describe_completeness", "list_strap_forces", "tabulate_straps", "tabulate_strapped_fixture"]


def tabulate_straps(result: Result, entries: ShownEntries, count: int, unit: Unit) -> Table:
    """Return a table of the first ``count`` entries: locators, bolts, force of each strap, and figures of the
    seat.
    """
    from workhold.model.straps import StrappedHold

    straps = result.toolkit.strap_set
    assert straps is not None
    short, has_loads = unit.abbreviation, result.query.is_loaded
    needs = [f">each strap {unit.force}", "bolts in"] if has_loads else []
    given = result.query.jaw_force if has_loads else None
    if given is not None:
        needs.insert(1, f">times at {unit.format_force_alone(given)}")
    columns = (
        ">rank",
        "locators",
        ">angle deg",
        *needs,
        "push",
        f">location error {short}",
        f">edge distance {short}",
    )
    table = Table(columns, spare=1)
    for index in entries.index[:count].tolist():
        fixture = result[index]
        hold = fixture.hold
        assert isinstance(hold, StrappedHold)
        if hold.is_unfit or hold.holds_nothing:
            table.red.add(len(table.rows))
        need, reached = hold.clamp_needed, hold.safety_reached
        force = "-" if need is None else format_rounded(need / unit.newtons, 0)
        times = () if given is None else ("-" if reached is None else format_safety(reached),)
        bolts = " ".join(straps.bolts.name_place(*one.hole) for one in hold.straps) or "-"
        push = (
            "?" if not hold.is_looked_at else "none" if hold.push is None else f"{hold.push.direction_deg:g}°"
        )
        quality = fixture.quality
        table.add_row(
            str(index + 1),
            " ".join(peg.hole for peg in fixture.pegs),
            format_rounded(fixture.pose.written_deg, 3),
            *((force, *times, bolts) if has_loads else ()),
            push,
            unit.format_number(quality["location_error"]),
            unit.format_number(quality["edge_distance"], 1),
        )
    return table


def describe_completeness(result: Result, unit: Unit) -> str:
    """Return sentences that say which parts of the list are complete and, with loads, which coefficients of
    friction the forces assume.
    """
    from workhold.model.straps import StrappedHold
    from workhold.supports.straps import make_question
    from workhold.supports.words_of_straps import describe_assumptions

    looked_at = sum(isinstance(hold, StrappedHold) and hold.is_looked_at for hold in result.holds)
    said = f"All seats are listed; a push by hand was looked for at {looked_at} of them"
    if not result.query.is_loaded:
        return f"{said}."
    places = "straps, the best of a finite set of places, too"
    return f"{said}, and {places}. {describe_assumptions(make_question(result.query))}"


def tabulate_strapped_fixture(fixture: Fixture, rank: int, total: int, unit: Unit) -> tuple[Table | str, ...]:
    """Return sentences and tables on how to set up one seat with its straps, and the force that each load
    needs.

    ``rank`` counts from 1, ``total`` is the number of fixtures listed, and lengths are shown in ``unit``.
    """
    from workhold.model.straps import StrappedHold
    from workhold.supports.straps import make_question
    from workhold.supports.words_of_straps import list_remarks, list_steps, list_warnings

    hold, query = fixture.hold, fixture.listing.result.query
    assert isinstance(hold, StrappedHold)
    asked, short = make_question(query), unit.abbreviation
    pegs = Table(("hole", f">x {short}", f">y {short}", ">face"))
    for peg in fixture.pegs:
        pegs.add_row(peg.hole, unit.format_number(peg.x), unit.format_number(peg.y), str(peg.face))
    angle = format_rounded(fixture.pose.written_deg, 6)
    tables: list[Table | str] = [
        f"Fixture {rank} of {total}: part turned by {angle} degrees",
        *(f"{step}." for step in list_steps(hold, fixture, asked, unit)),
        *list_remarks(hold),
        "",
        pegs,
    ]
    if hold.straps:
        straps = Table(
            ("strap", "bolt in", f">tip at x {short}", f">tip at y {short}", f">heel {short} high")
        )
        for number, one in enumerate(hold.straps, 1):
            where = asked.get_bolt_holes(fixture).name_place(*one.hole)
            straps.add_row(
                str(number), where, *(unit.format_number(value) for value in (*one.at, one.height))
            )
        tables += ["", straps]
    tables += list_strap_forces(hold, asked, unit)
    quality = fixture.quality
    error, edge = (unit.format_length(quality[key]) for key in ("location_error", "edge_distance"))
    tables.append(f"Location error {error}; nearest edge {edge}.")
    said = list_warnings(hold, fixture, asked, unit)
    return (*tables, *(f"{words[:1].upper()}{words[1:]}" for words in said))


def list_strap_forces(hold: StrappedHold, asked: StrapQuestion, unit: Unit) -> list[Table | str]:
    """Return a table and sentences: the force of each strap that each load and the program need, and the
    assumptions.
    """
    from workhold.supports.words_of_straps import (
        describe_assumptions,
        describe_program_need,
        describe_program_safety,
    )

    out: list[Table | str] = []
    if hold.clamp_needed_each:
        needs = tabulate_needs(
            (load.name for load in asked.loads),
            hold.clamp_needed_each,
            "force of each strap",
            unit,
            hold.safety_each[: len(asked.loads)],
            asked.given_force,
        )
        out += ["", describe_assumptions(asked), needs]
    if hold.program_need is not None and asked.program is not None:
        out += ["", describe_program_need(hold.program_need, asked.program, unit)]
        out += [words for words in [describe_program_safety(hold, asked, unit)] if words]
        out += [] if hold.clamp_needed_each else [describe_assumptions(asked)]
    return out
