"""A line that explains why a fixture is the first choice, by the keys that the usual ranking compares before
any figure.
"""

from __future__ import annotations

from math import inf, isfinite

import numpy as np

from workhold.model.first_choice import FACTORS
from workhold.model.quality import LOCATION_ERROR, WARNINGS
from workhold.model.result import Result
from workhold.statics.effective_error import EffectiveErrors, classify_angles
from workhold.statics.judging import are_unfit
from workhold.units import MILLIMETRE, Unit

__all__ = ["explain_why_first"]


def explain_why_first(result: Result, unit: Unit = MILLIMETRE) -> str:
    """Return a line on why the first fixture of a result is ranked first.

    Empty for a result without fixtures and for any ranking but the usual one. Of a result in an order of bending
    the line says so.

    Examples
    --------
    >>> import workhold
    >>> part = workhold.Workpiece.from_loops("block", [[[0, 0, 0], [100, 0, 0], [100, 60, 0], [0, 60, 0]]])
    >>> explain_why_first(workhold.design(part, workhold.Plate(pitch=20, peg_radius=3, clamps=2), best=5))
    'First: no warning; location error 0.0392 mm, within a tenth of the least; as drawn.'
    """

    def format_length(mm: float) -> str:
        """Return a length in mm as text in the unit, with as many decimals as figures have."""
        return f"{unit.format_number(mm, unit.decimals + 1)} {unit.abbreviation}"

    if result.bent_by is not None:
        return describe_least_bent(result)
    least, query = result.least_effective_error, result.query
    if not query.has_house_order or least is None or len(result) == 0:
        return ""
    row = result.table.take(slice(0, 1))
    effective = EffectiveErrors.from_query(query)
    holds = effective.find_factors(row)[0]
    error, counted = float(row.quality[0, LOCATION_ERROR]), float(effective.compute_errors(row)[0])
    if not isfinite(error):
        return ""
    warned, angle = bool(row.quality[0, WARNINGS] > 0), int(classify_angles(row.theta)[0])
    if are_unfit(row.quality, query.tolerance)[0]:
        said = "none is fit for a workshop"
    else:
        said = "all that are fit have a warning" if warned else "no warning"
    turned = f"turned by {round(float(np.degrees(row.theta[0])))}°"
    against = [
        turned if factor.key == "quarter_turn" else factor.words
        for factor, holding in zip(FACTORS, holds, strict=True)
        if holding
    ]
    size = f"location error {format_length(error)}"
    if against:
        size += f", counted as {format_length(counted)} ({', '.join(against)})"
    if np.round(counted, 9) >= 1.1 * least:
        # This happens where its seating changed the order.
        near = f"the least is {format_length(least)}"
    elif np.round(counted, 9) <= least:
        near = "the least of all"
    else:
        near = "within a tenth of the least"
    return f"First: {said}; {size}, {near}; {describe_first_position(result, angle)}."


def describe_least_bent(result: Result) -> str:
    """Return a line on why the first fixture of a result in an order of bending is first."""
    does = (
        "is bent least by its clamps" if result.bent_by == "clamp_distortion" else "gives least at the cutter"
    )
    return f"First: of the fixtures whose bending was computed, its part {does}."


def describe_first_position(result: Result, angle: int) -> str:
    """Return a phrase on the first fixture's angle, and the reason why no fixture of a better angle class is
    first.

    ``angle`` is the class of the first fixture's angle, see :mod:`workhold.statics.effective_error`.
    """
    if angle == 0:
        return "as drawn"
    straight = "as drawn" if angle == 1 else "square to the drawing"
    table, best = result.table, result.query.best
    less = table.take(np.flatnonzero(classify_angles(table.theta) < angle))
    if not len(less):
        whole = result.complete and len(table) == sum(result.found.values()) and (best or inf) > len(table)
        near = f"no fixture that lies {straight} comes within a tenth"
        return (
            f"no fixture lies {straight}"
            if whole
            else near + (", and none is listed" if len(table) > 1 else "")
        )
    bad = are_unfit(less.quality, result.query.tolerance)
    first = table.take(slice(0, 1))
    if bad.all() and not are_unfit(first.quality, result.query.tolerance)[0]:
        return f"those that lie {straight} are not fit for a workshop"
    if (bad | (less.quality[:, WARNINGS] > 0)).all() and not first.quality[0, WARNINGS] > 0:
        return f"those that lie {straight} have a warning"
    return f"no fixture that lies {straight} comes within a tenth"
