"""The blocks of words beside a part under straps: on its picture, and on its setup sheet."""

from __future__ import annotations

from workhold.drawing.panel import TextColumn
from workhold.drawing.scene import GREY, LengthUnit, format_degrees
from workhold.drawing.sheet_writing import BODY, NOTE, SetupSheet, Writer, write_heading
from workhold.model.fixture import Fixture
from workhold.model.hold_words import round_force_up
from workhold.model.straps import StrappedHold
from workhold.supports.straps import StrapQuestion, make_question
from workhold.supports.words_of_straps import (
    describe_assumptions,
    describe_program_need,
    describe_program_safety,
    list_remarks,
    list_steps,
    list_warnings,
)
from workhold.units import format_times

__all__ = ["draw_strap_panel", "list_strap_writers"]

# Loads beyond this are left to the command line; the hardest are shown.
MOST_LOADS = 6


def get_hold(fixture: Fixture) -> tuple[StrappedHold, StrapQuestion]:
    """Return (the straps of a result's fixture, the request for straps)."""
    hold = fixture.hold
    assert isinstance(hold, StrappedHold)
    return hold, make_question(fixture.listing.result.query)


def draw_strap_panel(column: TextColumn, fixture: Fixture, lengths: LengthUnit) -> None:
    """Write the settings and figures of a part under straps into a column, for a picture."""
    hold, asked = get_hold(fixture)
    write_force_needed(column, fixture, lengths, 30)
    column.write_fact("Locators in", ", ".join(peg.hole for peg in fixture.pegs), bold=True)
    column.write_fact("on faces", ", ".join(str(peg.face) for peg in fixture.pegs))
    column.write_fact("Part turned by θ", format_degrees(fixture.pose.written_deg, 3))
    column.draw_rule()
    write_strap_table(column, fixture, lengths)
    write_push(column, hold, lengths)
    for sentence in list_warnings(hold, fixture, asked, lengths.unit):
        column.write_item("▲", f"{sentence[:1].upper()}{sentence[1:]}", 12.5)
    write_program_need(column, fixture, lengths, 11.5)
    if hold.needs:
        column.write_paragraph(describe_assumptions(asked), 11.5, fill=GREY)
    column.draw_rule()


def write_force_needed(column: TextColumn, fixture: Fixture, lengths: LengthUnit, size: float) -> None:
    """Write the force that each strap needs, in large type, and how it compares with the rated and the given
    force, as far as known.
    """
    (hold, asked), unit = get_hold(fixture), lengths.unit
    if hold.clamp_needed is not None:
        column.write_line("Force of each strap at its tip", 13, fill=GREY, gap=0.8)
        words = f"{unit.format_force(round_force_up(hold.clamp_needed))} or more"
        column.write_line(words, size, bold=True, gap=0.4)
    elif hold.needs:
        column.write_line("No force of the straps holds all loads", 15, bold=True, gap=0.6)
    if hold.slip_reserve is not None:
        column.write_fact(
            "A strap is rated for",
            f"{unit.format_force(hold.max_force or 0.0)}, {format_times(hold.slip_reserve)} that",
        )
    given = asked.given_force
    if given is not None and hold.safety_reached is not None:
        column.write_fact(
            f"With {unit.format_force(given)} at each tip", f"{format_times(hold.safety_reached)} the loads"
        )


def write_program_need(column: TextColumn, fixture: Fixture, lengths: LengthUnit, size: float) -> None:
    """Write the force of each strap that the program's tools need; nothing if they need none."""
    hold, asked = get_hold(fixture)
    program = fixture.listing.result.query.program
    if hold.program_need is not None and program is not None:
        words = describe_program_need(hold.program_need, program, lengths.unit)
        often = describe_program_safety(hold, asked, lengths.unit)
        column.write_paragraph(f"{words} {often}".rstrip(), size)


def write_strap_table(column: TextColumn, fixture: Fixture, lengths: LengthUnit) -> None:
    """Write the table of the straps: where each is bolted, where its tip presses, and
    the height of its heel.
    """
    hold, asked = get_hold(fixture)
    if not hold.straps:
        return
    sign, bolts = lengths.sign, asked.get_bolt_holes(fixture)
    rows = [
        [bolts.name_place(*one.hole), *(lengths.format_number(value) for value in (*one.at, one.height))]
        for one in hold.straps
    ]
    column.write_table(["bolt in", f"tip x {sign}", f"tip y {sign}", f"heel {sign}"], rows, BODY)


def write_push(column: TextColumn, hold: StrappedHold, lengths: LengthUnit) -> None:
    """Write the point and the direction of the push by hand that presses the part against the locators."""
    if hold.push is None:
        return
    x, y = (lengths.format_number(value) for value in hold.push.at)
    column.write_fact("Push by hand at", f"({x}, {y}) {lengths.sign}")
    column.write_fact("towards", f"{format_degrees(hold.push.direction_deg, 1)} from x")


def list_strap_writers() -> tuple[list[Writer], list[Writer]]:
    """Return (functions that write the blocks needed beside the plan, functions for the other blocks) of a
    sheet of straps.
    """
    return [write_places, write_straps, write_strap_force], [write_strap_steps, write_strap_loads, write_seat]


def write_places(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the block of the locators: hole, x, y and touched face of each, and the part's turn."""
    write_heading(column, "Locators")
    sign = sheet.lengths.sign
    rows = [
        [peg.hole, sheet.lengths.format_number(peg.x), sheet.lengths.format_number(peg.y), str(peg.face)]
        for peg in sheet.fixture.pegs
    ]
    column.write_table(["hole", f"x {sign}", f"y {sign}", "face"], rows, BODY)
    column.write_fact("part turned by θ", format_degrees(sheet.fixture.pose.written_deg, 3))


def write_straps(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the block of the straps and of the push by hand."""
    hold, _ = get_hold(sheet.fixture)
    write_heading(column, "Straps")
    if hold.straps:
        write_strap_table(column, sheet.fixture, sheet.lengths)
    else:
        column.write_paragraph("None were chosen.", BODY)
    write_push(column, hold, sheet.lengths)


def write_strap_force(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the block of the force of each strap."""
    hold, asked = get_hold(sheet.fixture)
    if not hold.needs:
        return
    write_heading(column, "Force")
    write_force_needed(column, sheet.fixture, sheet.lengths, 20)
    write_program_need(column, sheet.fixture, sheet.lengths, NOTE)
    column.write_paragraph("The bolt carries more than the tip: the heel takes its share.", NOTE)
    column.write_paragraph(describe_assumptions(asked), NOTE)


def write_strap_steps(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the numbered steps of setting up."""
    hold, asked = get_hold(sheet.fixture)
    write_heading(column, "Setting up")
    steps = ["Clean plate, locators and part", *list_steps(hold, sheet.fixture, asked, sheet.lengths.unit)]
    steps.append(f"Set the machine's zero, G54, from {sheet.datum.point} as given under part zero X0 Y0")
    for number, step in enumerate(steps, 1):
        column.write_item(f"{number}.", f"{step}.", BODY)
    for remark in list_remarks(hold):
        column.write_paragraph(remark, NOTE)


def write_strap_loads(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the table of loads with the force of each strap that each load needs.

    If a force of the straps is given, it also has the safety of that force against each load.
    """
    hold, asked = get_hold(sheet.fixture)
    query, unit = sheet.fixture.listing.result.query, sheet.lengths.unit
    if not hold.clamp_needed_each:
        return
    write_heading(column, f"Force of each strap by load, {unit.force}")
    pairs = list(enumerate(zip(query.loads, hold.clamp_needed_each, strict=True), 1))
    pairs.sort(key=lambda one: (one[1][1] is not None, -(one[1][1] or 0.0)))
    for number, (load, need) in pairs[:MOST_LOADS]:
        size = f": {unit.format_force(load.force)}" if load.force else ""
        name = f"{load.name or f'load {number}'}{size}"
        words = "none holds it" if need is None else unit.format_force_number(need, 0)
        if need is not None and hold.safety_each:
            words += f", held {format_times(hold.safety_each[number - 1])}"
        column.write_fact(name, words, bold=True)
    if asked.given_force is not None and hold.safety_each:
        column.write_paragraph(
            f"How many times each load is held: with {unit.format_force(asked.given_force)} at each tip.",
            NOTE,
        )
    if len(pairs) > MOST_LOADS:
        column.write_paragraph(f"The hardest {MOST_LOADS} of {len(pairs)} loads.", NOTE)


def write_seat(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the block of the seat: location error and distance of the nearest edge."""
    quality, lengths = sheet.fixture.quality, sheet.lengths
    write_heading(column, "The seat")
    column.write_fact("location error", lengths.format_length(quality["location_error"]))
    column.write_fact("nearest edge", lengths.format_short(quality["edge_distance"], 5))
