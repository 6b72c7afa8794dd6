"""Tables and sentences for the terminal about parts that friction holds, between flat jaws or under
straps."""

from __future__ import annotations

from typing import TYPE_CHECKING

from workhold.cli.need_table import format_safety, tabulate_needs
from workhold.cli.strap_tables import describe_completeness, tabulate_strapped_fixture, tabulate_straps
from workhold.cli.table import Table
from workhold.presenting.figure_words import format_figure_number, format_rounded, make_short_heading
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.listing.identity import ShownEntries
    from workhold.model.fixture import Fixture
    from workhold.model.result import Result

__all__ = ["explain_first_hold", "tabulate_hold_setup", "tabulate_holds"]

# Figures that a table has where all else fits.
SHOWN = ("clamp_needed", "slip_reserve", "safety_reached", "grip", "above", "contact_area")


def tabulate_holds(result: Result, entries: ShownEntries, count: int, unit: Unit) -> Table:
    """Return a table of the first ``count`` entries: faces on the fixed jaw, parallels, stop, opening and
    figures.

    For a toolkit with straps it is the table of :func:`tabulate_straps`.
    """
    from workhold.model.hold_words import describe_touched_faces
    from workhold.model.jaw_hold import HOLD_FIGURES, JawHold

    if result.toolkit.strap_set is not None:
        return tabulate_straps(result, entries, count, unit)
    known = {key for hold in result.holds for key in hold.figures}
    figures = [figure for figure in HOLD_FIGURES if figure.key in SHOWN and figure.key in known]
    short = unit.abbreviation
    has_stop = any(isinstance(hold, JawHold) and hold.stop for hold in result.holds)
    columns = (
        ">rank",
        "fixed jaw on",
        f">parallels {short}",
        *(("stop",) if has_stop else ()),
        f">opening {short}",
        ">angle deg",
        *(f">{make_short_heading(figure, unit)}" for figure in figures),
    )
    table = Table(columns, spare=len(figures) - 1)
    for index in entries.index[:count].tolist():
        fixture = result[index]
        hold = fixture.hold
        assert isinstance(hold, JawHold)
        if hold.is_unfit or not hold.full_contact:
            table.red.add(len(table.rows))
        table.add_row(
            str(index + 1),
            describe_touched_faces(hold.fixed),
            unit.format_number(hold.parallels, 1) if hold.parallels else "bed",
            *((hold.stop or "",) if has_stop else ()),
            unit.format_number(hold.opening),
            format_rounded(fixture.pose.written_deg, 3),
            *(
                format_figure_number(figure, hold.figures[figure.key], unit)
                if figure.key in hold.figures
                else "-"
                for figure in figures
            ),
        )
    return table


def explain_first_hold(result: Result, unit: Unit) -> str:
    """Return a sentence on why the first hold is ranked first.

    With loads it also says which coefficients of friction the forces are stated with.
    """
    from workhold.model.hold_words import describe_coefficients, list_hold_reasons

    first = result[0]
    if result.toolkit.strap_set is not None:
        return describe_completeness(result, unit)
    said = f"First: {'; '.join(list_hold_reasons(first, unit))}."
    return f"{said} {describe_coefficients(result.query)}" if result.query.is_loaded else said


def tabulate_hold_setup(fixture: Fixture, rank: int, total: int, unit: Unit) -> tuple[Table | str, ...]:
    """Return sentences and tables on how to set up one hold, the force that each load needs, and its
    warnings.

    ``rank`` counts from 1, ``total`` is the number of fixtures listed, and lengths are shown in ``unit``.
    """
    from workhold.model.hold_words import describe_coefficients, write_setup_sentences, write_warnings
    from workhold.model.jaw_hold import JawHold
    from workhold.model.raw_words import list_raw_sentences
    from workhold.statics.jaw_clearance import list_vise_sentences
    from workhold.statics.jaw_program import describe_asked_force

    hold, query = fixture.hold, fixture.listing.result.query
    if not isinstance(hold, JawHold):
        return tabulate_strapped_fixture(fixture, rank, total, unit)
    steps = (f"{step}." for step in write_setup_sentences(fixture, query, unit))
    tables: list[Table | str] = [
        f"Fixture {rank} of {total}",
        *list_raw_sentences(fixture, query, unit),
        *steps,
    ]
    if query.is_loaded:
        tables.append(describe_coefficients(query))
    if hold.program_need is not None and query.program is not None:
        tables.append(describe_asked_force(hold.program_need, query.program, unit))
        if hold.safety_each and query.jaw_force is not None:
            often = format_safety(hold.safety_each[-1])
            closed = unit.format_force(query.jaw_force)
            tables.append(f"Closed with {closed}, its tools may press {often} times as hard.")
    tables += list_vise_sentences(fixture, query, unit)
    if hold.clamp_needed_each:
        tables.append(
            tabulate_needs(
                (load.name for load in query.loads),
                hold.clamp_needed_each,
                "jaw force needed",
                unit,
                hold.safety_each[: len(query.loads)],
                query.jaw_force,
            )
        )
    return (*tables, *write_warnings(hold))
