"""The blocks of words beside a part between flat jaws: on its picture, and on its setup sheet."""

from __future__ import annotations

from math import inf

from workhold.drawing.jaw_side import draw_jaw_side
from workhold.drawing.panel import TextColumn
from workhold.drawing.scene import GREY, LengthUnit, format_degrees
from workhold.drawing.sheet_writing import BODY, NOTE, SetupSheet, Writer, write_fact_or_field, write_heading
from workhold.drawing.strap_blocks import draw_strap_panel, list_strap_writers
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.hold_words import (
    describe_coefficients,
    describe_parallel_places,
    describe_touched_faces,
    describe_work_stop,
    format_set_force,
    list_hold_reasons,
    round_force_up,
    write_setup_sentences,
    write_warnings,
)
from workhold.model.jaw_hold import JawHold
from workhold.model.query import Query
from workhold.model.raw_words import (
    SAWN,
    describe_block_size,
    describe_part_in_block,
    describe_uncut_sides,
    measure_zero_from_stop,
    measure_zero_height,
)
from workhold.model.shown import bound_placed_part
from workhold.model.straps import StrappedHold
from workhold.model.workpiece import Workpiece
from workhold.statics.jaw_clearance import list_vise_sentences
from workhold.statics.jaw_program import describe_asked_force
from workhold.units import format_times

__all__ = ["draw_hold_panel", "list_hold_blocks", "list_raw_zero_facts"]

# Loads beyond this are left to the command line; the hardest are shown.
MOST_LOADS = 6


def draw_hold_panel(
    column: TextColumn, fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, lengths: LengthUnit
) -> None:
    """Write the settings and figures of a part held by friction into a column.

    For flat jaws a view from the end of the jaws is drawn below them.
    """
    if isinstance(fixture.hold, StrappedHold):
        draw_strap_panel(column, fixture, lengths)
        return
    hold, jaws, query = fixture.hold, toolkit.flat_jaws, get_query(fixture)
    assert isinstance(hold, JawHold) and jaws is not None
    column.write_line("Opening S of the jaws", 13, fill=GREY, gap=0.8)
    column.write_line(lengths.format_length(hold.opening), 30, bold=True, gap=0.4)
    column.write_fact(
        "Parallels", lengths.format_short(hold.parallels) if hold.parallels else "none, on the bed"
    )
    if hold.has_moved_parallels:
        column.write_paragraph(
            f"{describe_parallel_places(hold, lengths.unit).capitalize()}.", 11.5, fill=GREY
        )
    column.write_fact("Fixed jaw on", describe_touched_faces(hold.fixed))
    column.write_fact("Moving jaw on", describe_touched_faces(hold.moving))
    column.write_fact("Work stop", describe_work_stop(hold.stop, jaws.stop_offset, lengths.unit) or "none")
    column.write_fact("Part turned by θ", format_degrees(fixture.pose.written_deg, 3))
    column.draw_rule()
    write_figures(column, fixture, lengths)
    height = None if query is None else query.part_height
    draw_jaw_side(column, fixture, jaws, height, lengths)
    for sentence in write_warnings(hold):
        column.write_item("▲", sentence, 12.5)
    if query is not None and query.loads:
        column.write_paragraph(describe_coefficients(query), 11.5, fill=GREY)
    column.draw_rule()


def write_figures(column: TextColumn, fixture: Fixture, lengths: LengthUnit) -> None:
    """Write the known figures of a part held by flat jaws, those about forces first."""
    hold, unit = fixture.hold, lengths.unit
    assert isinstance(hold, JawHold)
    if hold.clamp_needed is not None:
        column.write_fact("Jaw force needed", unit.format_force(hold.clamp_needed), bold=True)
    elif hold.clamp_needed_each:
        column.write_fact("Jaw force needed", "no force holds all loads", bold=True)
    if hold.slip_reserve is not None:
        column.write_fact(
            "Rated for", f"{unit.format_force(hold.max_force or 0.0)}, {format_times(hold.slip_reserve)} that"
        )
    if hold.safety_reached is not None:
        column.write_fact("With the jaw force given", f"{format_times(hold.safety_reached)} the loads")
    column.write_fact("Grip", lengths.format_short(hold.grip, 5))
    if hold.above is not None:
        column.write_fact("Stands above the jaws", lengths.format_short(hold.above, 5))
    area = f"{hold.contact_area / unit.millimetres**2:,.4g} {unit.abbreviation}²"
    column.write_fact("Contact area", area if hold.contact_area else "a line")
    if hold.max_pressure is not None:
        column.write_fact("Largest pressure, at least", format_pressure(hold.max_pressure, lengths))


def format_pressure(pressure: float, lengths: LengthUnit) -> str:
    """Return a pressure, given in MPa, as a number with the unit's sign; below 20 MPa with one decimal."""
    unit = lengths.unit
    return f"{pressure:.1f} MPa" if unit.pressure == "MPa" and pressure < 20 else unit.format_stress(pressure)


def get_query(fixture: Fixture) -> Query | None:
    """Return the query of the result that lists a fixture; None for a fixture of no result."""
    return None if fixture.listed is None else fixture.listed.result.query


def list_hold_blocks(sheet: SetupSheet) -> tuple[list[Writer], list[Writer]]:
    """Return (blocks that must be beside the plan, other blocks) of a sheet of flat jaws or straps."""
    if isinstance(sheet.fixture.hold, StrappedHold):
        return list_strap_writers()
    needed: list[Writer] = [write_setting, write_side, write_force]
    if find_sheet_query(sheet).raw is not None:
        needed.insert(0, write_raw_block)
    return needed, [write_hold_steps, write_hold_loads, write_hold_quality]


def find_sheet_query(sheet: SetupSheet) -> Query:
    """Return the query of the result that lists the sheet's fixture; the fixture must belong to a result."""
    query = get_query(sheet.fixture)
    assert query is not None
    return query


def write_setting(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the block of settings: parallels, opening, touched faces, work stop, and place of the part along
    the jaws.
    """
    hold, jaws, lengths = sheet.fixture.hold, sheet.toolkit.flat_jaws, sheet.lengths
    assert isinstance(hold, JawHold) and jaws is not None
    write_heading(column, "Set up")
    column.write_fact(
        "parallels",
        lengths.format_short(hold.parallels) if hold.parallels else "none, on the bed",
        20,
        bold=True,
    )
    if hold.has_moved_parallels:
        column.write_paragraph(
            f"{describe_parallel_places(hold, lengths.unit).capitalize()}, clear of what comes through the part.",
            BODY,
            bold=True,
        )
    column.write_fact("opening S", lengths.format_length(hold.opening), 20, bold=True)
    column.write_fact("on the fixed jaw", describe_touched_faces(hold.fixed), bold=True)
    column.write_fact("the moving jaw presses", describe_touched_faces(hold.moving), bold=True)
    column.write_fact(
        "work stop", describe_work_stop(hold.stop, jaws.stop_offset, lengths.unit) or "none", bold=True
    )
    ends = min(hold.fixed.ends[0], hold.moving.ends[0]), max(hold.fixed.ends[1], hold.moving.ends[1])
    column.write_fact(
        "gripped along the jaws",
        f"{lengths.format_short_number(ends[0], 5)} to {lengths.format_short(ends[1], 5)}",
        bold=True,
    )
    column.write_paragraph(f"From the left end of jaws {lengths.format_short(jaws.width)} wide.", NOTE)


def write_raw_block(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the block of the raw block: its size, the part inside, and the sides to be cut in this set-up."""
    query, jaws, unit = find_sheet_query(sheet), sheet.toolkit.flat_jaws, sheet.lengths.unit
    hold = sheet.fixture.hold
    assert isinstance(hold, JawHold) and jaws is not None
    write_heading(column, "Raw block")
    column.write_line(describe_block_size(query, unit), 20, bold=True, gap=0.4)
    column.write_paragraph(describe_part_in_block(query, unit), NOTE)
    column.write_paragraph(describe_uncut_sides(hold, query, jaws, unit), NOTE)


def list_raw_zero_facts(sheet: SetupSheet) -> list[tuple[str, float]]:
    """Return the distances for touching off a raw block: names of the distances of part zero, and these in
    mm.

    X is measured from the work stop or, without one, from the block's left end, Y from the fixed jaw, and Z0
    from the block's rest and from its top. [] without a raw block.
    """
    fixture, jaws = sheet.fixture, sheet.toolkit.flat_jaws
    query, hold = get_query(fixture), fixture.hold
    if query is None or query.raw is None or jaws is None or not isinstance(hold, JawHold):
        return []
    (x, y), z, height = sheet.zero_place, measure_zero_height(query), query.thickness or 0.0
    from_stop = measure_zero_from_stop(fixture, jaws, x)
    if from_stop is None:
        along = "x from the block's left end", x - bound_placed_part(sheet.workpiece, fixture.pose).x0
    else:
        along = f"x {'right' if hold.stop == 'left' else 'left'} of the work stop", from_stop
    lying = "the parallels" if hold.parallels else "the bed"
    return [
        along,
        ("y from the fixed jaw", y),
        (f"Z0 above {lying}", z),
        ("Z0 below the raw top", height - z),
    ]


def write_side(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the block with the view from the end of the vise; nothing if the part's height is unknown."""
    query, jaws = find_sheet_query(sheet), sheet.toolkit.flat_jaws
    if query.part_height is None or jaws is None:
        return
    write_heading(column, "From the end of the vise")
    draw_jaw_side(column, sheet.fixture, jaws, query.part_height, sheet.lengths)
    hold = sheet.fixture.hold
    if isinstance(hold, JawHold) and hold.above is not None and jaws.height is not None:
        top = "the top" if query.raw is None else "the raw top"
        free = f"Cut no deeper than {sheet.lengths.format_short(hold.above, 5)} below {top} beside a jaw."
        column.write_paragraph(
            free if hold.above else "Nothing stands above the jaws: a tool beside them runs into one.", NOTE
        )
    for sentence in list_vise_sentences(sheet.fixture, query, sheet.lengths.unit):
        column.write_paragraph(sentence, NOTE)


def write_force(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the block of the jaw force: needed, torque on the screw, reserve and pressure."""
    hold, unit, jaws = sheet.fixture.hold, sheet.lengths.unit, sheet.toolkit.flat_jaws
    assert isinstance(hold, JawHold) and jaws is not None
    write_heading(column, "Jaw force")
    needed = hold.clamp_needed
    if needed is None:
        if hold.forces_needed:
            column.write_paragraph("No jaw force holds all that acts in this set-up.", BODY, bold=True)
        write_fact_or_field(column, "close with", None)
        return
    column.write_line(f"{format_set_force(needed, unit)} or more", 22, bold=True, gap=0.4)
    torque = jaws.compute_torque(round_force_up(needed))
    if torque is not None:
        column.write_fact("on the screw, about", unit.format_moment(torque * 1000.0), bold=True)
        column.write_paragraph(
            "Three tenths of the torque move the jaw; friction in the thread takes the rest.", NOTE
        )
    if hold.slip_reserve is not None:
        column.write_fact("the vise is rated for", unit.format_force(hold.max_force or 0.0))
    if hold.safety_reached is not None:
        given = unit.format_force(find_sheet_query(sheet).jaw_force or 0.0)
        column.write_fact(f"closed with {given}", f"{format_times(hold.safety_reached)} the loads")
    if hold.max_pressure is not None:
        column.write_fact("largest pressure, at least", format_pressure(hold.max_pressure, sheet.lengths))
    query = find_sheet_query(sheet)
    if hold.program_need is not None and query.program is not None:
        column.write_paragraph(describe_asked_force(hold.program_need, query.program, unit), NOTE)
    column.write_paragraph(describe_coefficients(query), NOTE)


def write_hold_steps(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the numbered steps of setting up."""
    write_heading(column, "Setting up")
    hold = sheet.fixture.hold
    assert isinstance(hold, JawHold)
    steps = list(write_setup_sentences(sheet.fixture, find_sheet_query(sheet), sheet.lengths.unit))
    raw = find_sheet_query(sheet).raw
    if raw is None:
        steps.insert(0, "Clean jaws, parallels and part; break the edges that lie on them")
        steps.append("Tap the part down until no parallel slides, and close again")
        steps.append(f"Set the machine's zero, G54, from {sheet.datum.point} as given under part zero X0 Y0")
    else:
        steps.insert(0, "Clean jaws and parallels; file the burrs of the saw off the block")
        if raw.side > 0.0:
            steps.insert(-1, SAWN)
        steps.append("Tap the block down, and close again; a sawn face may not bring both parallels to rest")
        stop = "the block's left end" if hold.stop is None else "the work stop"
        steps.append(
            f"Touch off {stop}, the fixed jaw and the parallels, and set G54 as given under part zero"
        )
    for number, step in enumerate(steps, 1):
        column.write_item(f"{number}.", f"{step}.", BODY)


def write_hold_loads(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the loads with the jaw force that each needs, the hardest first, at most ``MOST_LOADS``."""
    query, hold, unit = find_sheet_query(sheet), sheet.fixture.hold, sheet.lengths.unit
    assert isinstance(hold, JawHold)
    if not query.loads:
        return
    write_heading(column, f"Jaw force that each load asks for, {unit.force}")
    pairs = list(enumerate(zip(query.loads, hold.clamp_needed_each, strict=True), 1))
    pairs.sort(key=lambda one: -inf if one[1][1] is None else -one[1][1])
    for number, (load, need) in pairs[:MOST_LOADS]:
        sizes = [unit.format_force(load.force)] if load.force else []
        if load.upward:
            sizes.append(f"{unit.format_force(abs(load.upward))} {'up' if load.upward > 0 else 'down'}")
        name = ": ".join((load.name or f"load {number}", *filter(None, [", ".join(sizes)])))
        words = "none holds it" if need is None else unit.format_force_number(need, 0)
        if need is not None and hold.safety_each:
            words += f", held {format_times(hold.safety_each[number - 1])}"
        column.write_fact(name, words, bold=True)
    if hold.safety_each and query.jaw_force is not None:
        column.write_paragraph(
            f"How many times each load is held: closed with {unit.format_force(query.jaw_force)}.", NOTE
        )
    if len(pairs) > MOST_LOADS:
        column.write_paragraph(f"The hardest {MOST_LOADS} of {len(pairs)} loads.", NOTE)


def write_hold_quality(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the block on why this fixture is the first choice, with its figures of quality."""
    write_heading(column, "Why this one")
    if sheet.details.why_first:
        column.write_paragraph(sheet.details.why_first, NOTE)
    else:
        words = "; ".join(list_hold_reasons(sheet.fixture, sheet.lengths.unit))
        column.write_paragraph(f"{words[:1].upper()}{words[1:]}.", NOTE)
    write_figures(column, sheet.fixture, sheet.lengths)
