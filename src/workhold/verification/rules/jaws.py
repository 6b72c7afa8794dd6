"""Jaws: carriers with holes of their own that slide, and how far they may open and close.

The separation is counted from the column of the other jaw that is next to the opening, or from a wall, so
that no peg is nearer to what stands still.
"""

from __future__ import annotations

from collections.abc import Iterator

from flint import arb

from workhold.fixels.toolkit import Carrier
from workhold.verification.findings import Finding, number, rule
from workhold.verification.tolerances import HAIR

__all__ = ["nearest_row_findings", "opening_findings"]


def opening_findings(jaw: Carrier, separation: arb) -> Iterator[Finding]:
    """Whether a jaw can stand at a proven separation, in mm; met to a hair (see ``findings``)."""
    assert jaw.travel is not None
    gap, limit = jaw.travel.least, jaw.travel.most
    yield from rule(
        separation - gap + HAIR,
        f"the opening of {number(separation)} mm is below the smallest gap of {gap:g} mm",
        "the opening is exactly at the edge of the smallest gap",
    )
    if limit is not None:
        yield from rule(
            limit - separation + HAIR,
            f"the opening of {number(separation)} mm is above the largest opening of {limit:g} mm",
            "the opening is exactly at the edge of the largest opening",
        )


def nearest_row_findings(jaw: Carrier, lowest: int, separation: arb) -> Iterator[Finding]:
    """Whether a jaw that slides along its rows has its pegs in the nearest ones that the opening allows.

    ``lowest`` is the first row in use. One row nearer, the jaw is one pitch farther from the wall.
    """
    assert jaw.travel is not None
    if lowest > 0:
        limit, wider = jaw.travel.most, separation + jaw.pitch[1]
        words = f"its lowest row is {lowest}, and an opening of {number(wider)} mm would take one nearer"
        if limit is None:
            yield Finding(True, words)
        else:
            yield from rule(wider - limit - HAIR, words, "one row nearer the opening would be exactly at its edge")
