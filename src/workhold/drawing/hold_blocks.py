"""The blocks of words beside a part between flat jaws: on its picture, and on its setup sheet."""

from __future__ import annotations

from math import inf

from workhold.drawing.jaw_side import draw_jaw_side
from workhold.drawing.panel import TextColumn
from workhold.drawing.scene import GREY, LengthUnit, degrees_text
from workhold.drawing.sheet_writing import BODY, NOTE, Sheet, Writer, fact_or_field, heading
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.hold_words import (
    describe_coefficients,
    describe_touched_faces,
    describe_work_stop,
    force_words,
    hold_reasons,
    set_force,
    write_setup_sentences,
    write_warnings,
)
from workhold.model.query import Query
from workhold.model.workpiece import Workpiece
from workhold.statics.jaw_program import asked_words

__all__ = ["draw_hold_panel", "hold_writers"]

# Loads beyond this are left to the command line; the hardest are shown.
MOST_LOADS = 6


def draw_hold_panel(
    column: TextColumn, fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, lengths: LengthUnit
) -> None:
    """Writes what to set and what follows, for a picture, with a view from the end of the jaws."""
    hold, jaws, query = fixture.hold, toolkit.flat_jaws, asked_of(fixture)
    assert hold is not None and jaws is not None
    column.words("Opening S of the jaws", 13, fill=GREY, gap=0.8)
    column.words(lengths.words(hold.opening), 30, bold=True, gap=0.4)
    column.fact("Parallels", lengths.short(hold.parallels) if hold.parallels else "none, on the bed")
    column.fact("Fixed jaw on", describe_touched_faces(hold.fixed))
    column.fact("Moving jaw on", describe_touched_faces(hold.moving))
    column.fact("Work stop", describe_work_stop(hold, jaws.stop_offset, lengths.unit) or "none")
    column.fact("Part turned by θ", degrees_text(fixture.pose.written_deg, 3))
    column.rule()
    write_figures(column, fixture, lengths)
    height = None if query is None else query.part_height
    draw_jaw_side(column, fixture, jaws, height, lengths)
    for sentence in write_warnings(hold):
        column.item("▲", sentence, 12.5)
    if query is not None and query.loads:
        column.paragraph(describe_coefficients(query), 11.5, fill=GREY)
    column.rule()


def write_figures(column: TextColumn, fixture: Fixture, lengths: LengthUnit) -> None:
    """Writes the figures that are known, those of forces first."""
    hold, unit = fixture.hold, lengths.unit
    assert hold is not None
    if hold.clamp_needed is not None:
        column.fact("Jaw force needed", unit.force_words(hold.clamp_needed), bold=True)
    elif hold.clamp_needed_each:
        column.fact("Jaw force needed", "no force holds all loads", bold=True)
    if hold.slip_reserve is not None:
        column.fact(
            "Rated for", f"{unit.force_words(hold.max_force or 0.0)}, {hold.slip_reserve:.2f} times that"
        )
    if hold.safety_reached is not None:
        column.fact("With the jaw force given", f"{hold.safety_reached:.2f} times the loads")
    column.fact("Grip", lengths.short(hold.grip, 5))
    if hold.above is not None:
        column.fact("Stands above the jaws", lengths.short(hold.above, 5))
    area = f"{hold.contact_area / unit.millimetres**2:,.4g} {unit.abbreviation}²"
    column.fact("Contact area", area if hold.contact_area else "a line")
    if hold.max_pressure is not None:
        column.fact("Largest pressure, at least", pressure_words(hold.max_pressure, lengths))


def pressure_words(pressure: float, lengths: LengthUnit) -> str:
    """A pressure in MPa, small ones with a decimal."""
    unit = lengths.unit
    return f"{pressure:.1f} MPa" if unit.pressure == "MPa" and pressure < 20 else unit.stress_words(pressure)


def asked_of(fixture: Fixture) -> Query | None:
    """The query that a fixture is listed for."""
    return None if fixture.listed is None else fixture.listed.result.query


def hold_writers(sheet: Sheet) -> tuple[list[Writer], list[Writer]]:
    """The blocks that a sheet of flat jaws needs beside the plan, and the others."""
    needed: list[Writer] = [write_setting, write_side, write_force]
    return needed, [write_hold_steps, write_hold_loads, write_hold_quality]


def query_of(sheet: Sheet) -> Query:
    query = asked_of(sheet.fixture)
    assert query is not None
    return query


def write_setting(column: TextColumn, sheet: Sheet) -> None:
    hold, jaws, lengths = sheet.fixture.hold, sheet.toolkit.flat_jaws, sheet.lengths
    assert hold is not None and jaws is not None
    heading(column, "Set up")
    column.fact(
        "parallels", lengths.short(hold.parallels) if hold.parallels else "none, on the bed", 20, bold=True
    )
    column.fact("opening S", lengths.words(hold.opening), 20, bold=True)
    column.fact("on the fixed jaw", describe_touched_faces(hold.fixed), bold=True)
    column.fact("the moving jaw presses", describe_touched_faces(hold.moving), bold=True)
    column.fact("work stop", describe_work_stop(hold, jaws.stop_offset, lengths.unit) or "none", bold=True)
    ends = min(hold.fixed.ends[0], hold.moving.ends[0]), max(hold.fixed.ends[1], hold.moving.ends[1])
    column.fact(
        "gripped along the jaws",
        f"{lengths.short_number(ends[0], 5)} to {lengths.short(ends[1], 5)}",
        bold=True,
    )
    column.paragraph(f"From the left end of jaws {lengths.short(jaws.width)} wide.", NOTE)


def write_side(column: TextColumn, sheet: Sheet) -> None:
    query, jaws = query_of(sheet), sheet.toolkit.flat_jaws
    if query.part_height is None or jaws is None:
        return
    heading(column, "From the end of the vise")
    draw_jaw_side(column, sheet.fixture, jaws, query.part_height, sheet.lengths)
    hold = sheet.fixture.hold
    if hold is not None and hold.above is not None and jaws.height is not None:
        free = f"Cut no deeper than {sheet.lengths.short(hold.above, 5)} below the top beside a jaw."
        column.paragraph(
            free if hold.above else "Nothing stands above the jaws: a tool beside them runs into one.", NOTE
        )


def write_force(column: TextColumn, sheet: Sheet) -> None:
    hold, unit, jaws = sheet.fixture.hold, sheet.lengths.unit, sheet.toolkit.flat_jaws
    assert hold is not None and jaws is not None
    heading(column, "Jaw force")
    needed = hold.clamp_needed
    if needed is None:
        if hold.forces_needed:
            column.paragraph("No jaw force holds all that acts in this set-up.", BODY, bold=True)
        fact_or_field(column, "close with", None)
        return
    column.words(f"{force_words(needed, unit)} or more", 22, bold=True, gap=0.4)
    torque = jaws.torque(set_force(needed))
    if torque is not None:
        column.fact("on the screw, about", unit.moment_words(torque * 1000.0), bold=True)
        column.paragraph("Of the torque three tenths move the jaw, the rest is friction in the thread.", NOTE)
    if hold.slip_reserve is not None:
        column.fact("the vise is rated for", unit.force_words(hold.max_force or 0.0))
    if hold.safety_reached is not None:
        given = unit.force_words(query_of(sheet).jaw_force or 0.0)
        column.fact(f"closed with {given}", f"{hold.safety_reached:.2f} times the loads")
    if hold.max_pressure is not None:
        column.fact("largest pressure, at least", pressure_words(hold.max_pressure, sheet.lengths))
    query = query_of(sheet)
    if hold.program_need is not None and query.program is not None:
        column.paragraph(asked_words(hold.program_need, query.program, unit), NOTE)
    column.paragraph(describe_coefficients(query), NOTE)


def write_hold_steps(column: TextColumn, sheet: Sheet) -> None:
    heading(column, "Setting up")
    steps = list(write_setup_sentences(sheet.fixture, query_of(sheet), sheet.lengths.unit))
    steps.insert(0, "Clean jaws, parallels and part; break the edges that lie on them")
    steps.append("Tap the part down until no parallel slides, and close again")
    steps.append(f"Set the machine's zero, G54, from {sheet.datum.point} as given under part zero X0 Y0")
    for number, step in enumerate(steps, 1):
        column.item(f"{number}.", f"{step}.", BODY)


def write_hold_loads(column: TextColumn, sheet: Sheet) -> None:
    query, hold, unit = query_of(sheet), sheet.fixture.hold, sheet.lengths.unit
    assert hold is not None
    if not query.loads:
        return
    heading(column, f"Loads, and the jaw force that each asks for, {unit.force}")
    pairs = list(enumerate(zip(query.loads, hold.clamp_needed_each, strict=True), 1))
    pairs.sort(key=lambda one: -inf if one[1][1] is None else -one[1][1])
    for number, (load, need) in pairs[:MOST_LOADS]:
        sizes = [unit.force_words(load.force)] if load.force else []
        if load.upward:
            sizes.append(f"{unit.force_words(abs(load.upward))} {'up' if load.upward > 0 else 'down'}")
        name = ": ".join((load.name or f"load {number}", *filter(None, [", ".join(sizes)])))
        column.fact(name, "none holds it" if need is None else unit.force_number(need, 0), bold=True)
    if len(pairs) > MOST_LOADS:
        column.paragraph(f"The hardest {MOST_LOADS} of {len(pairs)} loads.", NOTE)


def write_hold_quality(column: TextColumn, sheet: Sheet) -> None:
    heading(column, "Why this one")
    if sheet.details.why_first:
        column.paragraph(sheet.details.why_first, NOTE)
    else:
        words = "; ".join(hold_reasons(sheet.fixture, sheet.lengths.unit))
        column.paragraph(f"{words[:1].upper()}{words[1:]}.", NOTE)
    write_figures(column, sheet.fixture, sheet.lengths)
