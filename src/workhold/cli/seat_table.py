"""The table of seats: where closing the vise or tightening the clamp can come to rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from workhold.cli.table import Table
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.model.seating import Seat
    from workhold.seating.clamping import Gauge

__all__ = ["seat_table"]

# What stands for kinds of seats in the table.
KINDS = {
    "corner": "four pegs, one on a corner",
    "pocket": "a peg in a corner of the part",
    "curved": "held by curvature",
    "loose": "not located",
    "unsettled": "not settled",
}


def seat_table(seats: list[Seat], gauge: Gauge, unit: Unit) -> Table:
    """Tabulates the seats: what is read, how the part lies, what touches, and how far it is held."""
    of, fixture = unit.abbreviation, gauge.fixture
    kinds = {**KINDS, "fixture": gauge.toolkit.setup_words.resting}
    table = Table(
        ("seat", f">reads {of}", f">differs {of}", ">turned by", "side", f">held {of}", "how it lies")
    )
    for k, one in enumerate(seats):
        turned = 0.0 if one.is_own else (one.pose.theta_deg - fixture.pose.theta_deg + 180.0) % 360.0 - 180.0
        pegs = ", ".join(f"{fixture.pegs[c.peg].hole} {c.words}" for c in one.contacts)
        words = "right" if one.is_own else "same place" if one.same_place else kinds[one.kind]
        table.add_row(
            str(k + 1),
            unit.number(gauge.at(one.jaw_separation)),
            unit.number(gauge.at(one.jaw_separation) - gauge.setting.length),
            f"{one.pose.theta_deg:.1f}" if one.mirrored else f"{turned:.1f}",
            "over" if one.mirrored else "up",
            "-" if one.depth is None else unit.number(one.depth),
            f"{words}{': ' if pegs else ''}{pegs}",
        )
    return table
