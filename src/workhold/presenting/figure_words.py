"""Figures, holes and counts as text, for the tables of the command line and of a notebook."""

from __future__ import annotations

from math import inf, isfinite, isnan
from typing import TYPE_CHECKING

from workhold.fixels.contacts import CLAMP_TIP
from workhold.units import Unit, format_rounded_down

if TYPE_CHECKING:
    from collections.abc import Mapping

    from workhold.fixels.toolkit import Toolkit
    from workhold.model.fixture import Fixture, Peg
    from workhold.model.quality import Figure
    from workhold.model.result import Result
    from workhold.model.workpiece import Workpiece

__all__ = [
    "ROUNDED_DOWN",
    "format_ranked_figure",
    "mark_edgeless",
    "is_edgeless",
    "format_figure_number",
    "format_figure",
    "list_shown_figures",
    "make_fixture_title",
    "make_heading",
    "find_edgeless_distance",
    "group_peg_columns",
    "name_peg_place",
    "format_rounded",
    "make_short_heading",
    "find_figure_unit",
]

# Columns of which the figure's name is too wide: how far open the part is caught, by what a wrong seat reads
# otherwise.
SHORT = {"capture_opening": "caught", "reading": "reads"}
# The figure for which a length stands where the part has no edge; by what share such lengths may differ.
# Numbers of times, of which one too many would be a promise.
ROUNDED_DOWN = ("slip_reserve", "safety_reached")
EDGE, SAME_SHARE = "edge_distance", 1e-9


def list_shown_figures(result: Result) -> tuple[list[Figure], list[Figure]]:
    """Return (figures that a result's table has columns for, figures that its fixtures are ranked by).

    The first list holds the known ones of the second list; then, where known, the location error and the
    program's clearance; with seating also the capture opening and the reading.
    """
    from workhold.model.quality import (
        FIGURES,
        JAW_FORCE_NEEDED,
        LOCATION_ERROR,
        PROGRAM_FIGURE,
        RANKED,
        SEATING_FIGURES,
    )

    ranked = [figure for key in result.query.rank_by for figure in RANKED if figure.key == key]
    others = [] if FIGURES[LOCATION_ERROR] in ranked else [FIGURES[LOCATION_ERROR]]
    others += [] if PROGRAM_FIGURE in ranked else [PROGRAM_FIGURE]
    program, needed = result.query.program, FIGURES[JAW_FORCE_NEEDED]
    if program is not None and program.forces is not None and needed not in ranked:
        others.insert(0, needed)
    figures = [f for f in [*ranked, *others] if len(result) and f.key in result[0].figures]
    if result.seating:
        # First what it is ranked by, then how wide open the part is caught, and what a reading must show.
        others = [f for f in SEATING_FIGURES if f.key in ("capture_opening", "reading") and f not in figures]
        figures[1:1] = others
    return figures, ranked


def make_fixture_title(fixture: Fixture) -> str:
    """Return the title of a listed fixture, such as "Fixture 2 of 40 of bracket"."""
    listed = fixture.listing
    return f"Fixture {listed.rank:,} of {listed.count:,} of {listed.result.workpiece.name}"


def make_short_heading(figure: Figure, unit: Unit) -> str:
    """Return a column heading: a figure's name, shortened if it is too wide, and the unit's sign."""
    return f"{SHORT.get(figure.key, figure.words)} {find_figure_unit(figure, unit)}".rstrip()


def group_peg_columns(toolkit: Toolkit) -> dict[str, list[str]]:
    """Return the columns of a table that hold pegs: by heading, the names of the carriers whose pegs stand in
    the column.

    All clamps share one column.

    >>> from workhold import Plate, Vise
    >>> group_peg_columns(Vise(pitch=10, columns=2, peg_radius=3))
    {'left holes': ['left'], 'right holes': ['right']}
    >>> group_peg_columns(Plate(pitch=20, peg_radius=5, columns=8, rows=6))
    {'locators': ['plate'], 'clamp': ['clamp -x', 'clamp -y']}
    """
    groups: dict[str, list[str]] = {}
    for carrier in toolkit.carriers:
        is_alone = carrier.contact is CLAMP_TIP and toolkit.closes_at_once
        pegs = carrier.peg if is_alone else f"{carrier.peg}s"
        if carrier.contact.is_placed:
            groups.setdefault(f"{carrier.name} holes" if len(toolkit.plates) > 1 else pegs, []).append(
                carrier.name
            )
    return groups


def name_peg_place(peg: Peg, toolkit: Toolkit) -> str:
    """Return the name of a peg's hole or line; a clamp's name is without its noun."""
    carrier = toolkit.find_carrier(peg.carrier)
    return peg.hole.removeprefix(f"{carrier.noun} ") if carrier.contact is CLAMP_TIP else peg.hole


def make_heading(figure: Figure, unit: Unit) -> str:
    """Return a figure's name followed by its unit, if any."""
    return f"{figure.words} {find_figure_unit(figure, unit)}".rstrip()


def find_figure_unit(figure: Figure, unit: Unit) -> str:
    """Return the sign of the unit in which a figure is shown, "" for none."""
    shown = {"mm": unit.abbreviation, "mm²": f"{unit.abbreviation}²", "MPa": unit.pressure, "N": unit.force}
    return shown.get(figure.unit, figure.unit)


def format_rounded(value: float, decimals: int) -> str:
    """Return a number with ``decimals`` decimals as text, zero without a sign.

    >>> format_rounded(-1e-15, 3), format_rounded(-0.5, 1)
    ('0.000', '-0.5')
    """
    text = f"{value:.{decimals}f}"
    return text.removeprefix("-") if float(text) == 0 else text


def find_edgeless_distance(workpiece: Workpiece, toolkit: Toolkit) -> float:
    """Return the length in mm that the figure ``edge_distance`` has when no contact has an edge."""
    from workhold.statics.contact_matrix import compute_wrench_length

    return compute_wrench_length(workpiece, toolkit)


def mark_edgeless(figures: Mapping[str, float], longest: float) -> dict[str, float]:
    """Return the figures by key, with inf as the edge distance if no contact has an edge.

    Parameters
    ----------
    longest : the length in mm that denotes no edge, see :func:`find_edgeless_distance`; no true distance is
        as long.
    """
    return {**figures, EDGE: inf} if is_edgeless(figures, longest) else dict(figures)


def is_edgeless(figures: Mapping[str, float], longest: float) -> bool:
    """Return whether the edge distance among ``figures`` is ``longest``, the length in mm that stands for no
    edge.

    See :func:`find_edgeless_distance`.
    """
    return EDGE in figures and figures[EDGE] >= longest * (1 - SAME_SHARE)


def format_figure_number(figure: Figure, value: float, unit: Unit) -> str:
    """Return a figure's value as text in a unit, without the unit's sign.

    NaN gives "-". Infinity gives "none" for a reading or an edge distance, otherwise "any".
    """
    if not isfinite(value):
        return "-" if isnan(value) else "none" if figure.key in ("reading", EDGE) else "any"
    if figure.unit == "MPa":
        return unit.format_stress_number(value)
    # A caliper reads hundredths of a millimetre.
    decimals = unit.decimals - 1 if figure.key in SHORT else unit.decimals + 1
    if figure.unit == "mm":
        return unit.format_number(value, decimals)
    if figure.key in ROUNDED_DOWN:
        return format_rounded_down(value)
    return format_rounded(value / find_unit_size(figure, unit), figure.decimals)


def find_unit_size(figure: Figure, unit: Unit) -> float:
    """Return the size, in mm, mm² or N, of the unit in which a figure is shown; 1 for a figure without such a
    unit.
    """
    return {"mm": unit.millimetres, "mm²": unit.millimetres**2, "N": unit.newtons}.get(figure.unit, 1.0)


def format_figure(figure: Figure, value: float, unit: Unit) -> str:
    """Return a figure's value as text with its unit, such as "0.031 mm"; inf and NaN are words without a unit."""
    behind = find_figure_unit(figure, unit) if isfinite(value) else ""
    return f"{format_figure_number(figure, value, unit)} {behind}".rstrip()


def format_ranked_figure(figure: Figure, value: float, unit: Unit) -> str:
    """Return a figure's value as text in a unit, rounded as the ranking rounds it: two significant digits in
    mm or N.
    """
    from math import floor, log10

    if not isfinite(value):
        return format_figure_number(figure, value, unit)
    counts = float(f"{round(value, 9):.1e}")
    size = find_unit_size(figure, unit)
    shown = counts / size
    if figure.decimals == 0 or shown == 0:
        return format_rounded(shown, 0)
    # In mm and N two digits are all there is to show; in another unit one more keeps what differs apart.
    digits = 2 if size == 1 else 3
    return format_rounded(shown, max(digits - 1 - floor(log10(abs(shown))), 0))
