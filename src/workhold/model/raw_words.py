"""Words about a raw block in a vise: its size, the part of the workpiece above the jaws, and the sides to
touch off.
"""

from __future__ import annotations

from workhold.fixels.jaw_pair import JawPair
from workhold.model.fixture import Fixture
from workhold.model.hold_words import format_short_length
from workhold.model.jaw_hold import JawHold
from workhold.model.query import Query
from workhold.model.raw_block import measure_jaws_over_part
from workhold.units import Unit

__all__ = [
    "SAWN",
    "describe_block_size",
    "describe_part_in_block",
    "describe_uncut_sides",
    "describe_zero_height",
    "list_raw_sentences",
    "measure_zero_from_stop",
    "measure_zero_height",
]

SAWN = (
    "Saw-cut sides are neither flat nor square, and forces are reckoned for flat ones: lay the flattest side on the "
    "fixed jaw, and a round rod or soft strip between the moving jaw and a rough one"
)


def format_sizes(sizes: tuple[float, float, float], unit: Unit) -> str:
    """Return three lengths in mm as text such as "86 × 56 × 32 mm"."""
    numbers = [f"{round(size / unit.millimetres, 4):g}" for size in sizes]
    return f"{' × '.join(numbers)} {unit.abbreviation}"


def measure_box(bounds: tuple[float, float, float, float], height: float) -> tuple[float, float, float]:
    """Return the sizes of a box along x, y and z, in mm."""
    x0, y0, x1, y1 = bounds
    return x1 - x0, y1 - y0, height


def describe_block_size(query: Query, unit: Unit) -> str:
    """Return the size of a query's raw block along x, y and z of the drawing; "" without a raw block."""
    if query.raw is None or query.thickness is None:
        return ""
    return format_sizes(measure_box(query.workpiece.bounds, query.thickness), unit)


def describe_part_in_block(query: Query, unit: Unit) -> str:
    """Return a sentence on the size of the finished part and the allowances to be cut off around it; ""
    without a raw block.
    """
    raw = query.raw
    if raw is None or query.thickness is None:
        return ""
    height = query.thickness - raw.top - raw.bottom
    part = format_sizes(measure_box(query.workpiece.as_finished.bounds, height), unit)
    off = (format_short_length(one, unit) if one else "nothing" for one in (raw.side, raw.top, raw.bottom))
    return "The part inside is {}: {} to cut off on each side, {} on top, {} below.".format(part, *off)


def describe_uncut_sides(hold: JawHold, query: Query, jaws: JawPair, unit: Unit) -> str:
    """Return a sentence on how far down the part's sides can be cut in this set-up; "" without a raw block,
    and for jaws of any height.
    """
    raw = query.raw
    if raw is None or jaws.height is None:
        return ""
    over = measure_jaws_over_part(hold, raw, jaws)
    if over == 0.0:
        under = raw.bottom - jaws.compute_top(hold.parallels)
        where = f"{format_short_length(under, unit)} above" if under > 0.0 else "level with"
        return f"The part's lower side is {where} the jaws' top: its sides can be cut all the way down."
    left = format_short_length(over, unit)
    return (
        f"The jaws reach {left} over the part's lower side: beside them the lowest {left} of its sides are left "
        "for the next set-up."
    )


def measure_zero_height(query: Query) -> float:
    """Return the height of Z0 above the lower side of a query's raw block, in mm.

    Z0 is the program's; without a program it is the top of the finished part.
    """
    if query.program is not None:
        return query.program.z_zero
    return (query.thickness or 0.0) - (0.0 if query.raw is None else query.raw.top)


def describe_zero_height(query: Query, unit: Unit) -> str:
    """Return a phrase on the height of Z0 above the parallels' top, and from the raw top; "" without a raw
    block.
    """
    if query.raw is None or query.thickness is None:
        return ""
    zero = measure_zero_height(query)
    below = query.thickness - zero
    under = f"{unit.format_length(abs(below))} {'below' if below >= 0 else 'above'} the raw top"
    return f"{unit.format_length(zero)} above what the block lies on, {under}"


def measure_zero_from_stop(fixture: Fixture, jaws: JawPair, x: float) -> float | None:
    """Return the distance in mm, inward from the work stop, of a place ``x`` of the jaws' frame; None without
    a stop.
    """
    hold = fixture.hold
    if not isinstance(hold, JawHold) or hold.stop is None:
        return None
    return x - jaws.stop_offset if hold.stop == "left" else jaws.width - jaws.stop_offset - x


def list_raw_sentences(fixture: Fixture, query: Query, unit: Unit) -> list[str]:
    """Return sentences on a raw block in a fixture between flat jaws; [] without a raw block."""
    hold, jaws = fixture.hold, query.toolkit.flat_jaws
    if query.raw is None or jaws is None or not isinstance(hold, JawHold):
        return []
    return [
        f"Raw block of {describe_block_size(query, unit)}. {describe_part_in_block(query, unit)}",
        *filter(None, [describe_uncut_sides(hold, query, jaws, unit)]),
        f"Z0 is {describe_zero_height(query, unit)}.",
        *([f"{SAWN}."] if query.raw.side > 0.0 else []),
    ]
