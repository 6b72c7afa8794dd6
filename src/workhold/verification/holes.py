"""What a fixture's file says about holes: whether they exist, and whether all the numbers that name them agree."""

from __future__ import annotations

from collections.abc import Iterator

from flint import arb

from workhold.model.fixture import Fixture, Peg
from workhold.model.vise import Vise
from workhold.verification.balls import Point
from workhold.verification.findings import Finding, number, rule
from workhold.verification.rules import AGREEMENT, HAIR

__all__ = ["hole_findings", "hole_place", "jaw_findings"]

LEFT_PEGS = {"I": 2, "II": 3}


def hole_place(peg: Peg, vise: Vise) -> Point:
    """Centre of a peg's hole in the vise frame for a jaw separation of 0, in mm (model: "Vise")."""
    pitch_x, pitch_y = vise.pitch
    if peg.jaw == "left":
        return arb(pitch_x) * peg.column, arb(pitch_y) * peg.row
    return arb(pitch_x) * (vise.columns - 1 + peg.column), arb(pitch_y) * peg.row + vise.row_offset


def hole_findings(fixture: Fixture, vise: Vise) -> Iterator[Finding]:
    """What is wrong with jaws, columns, rows and the places x, y written for them."""
    lefts = sum(peg.jaw == "left" for peg in fixture.pegs)
    if len(fixture.pegs) != 4 or LEFT_PEGS.get(fixture.type) != lefts:
        yield Finding(
            True, f"{lefts} of its {len(fixture.pegs)} pegs are on the left jaw, which is not type {fixture.type}"
        )
    if len({(peg.jaw, peg.column, peg.row) for peg in fixture.pegs}) < len(fixture.pegs):
        yield Finding(True, "two pegs are in the same hole")
    for position, peg in enumerate(fixture.pegs, 1):
        if not 0 <= peg.column < vise.columns:
            yield Finding(True, f"peg {position} is in column {peg.column} of a jaw with {vise.columns}")
        if peg.row < 0 or (vise.rows is not None and peg.row >= vise.rows):
            rows = "rows from 0 upward" if vise.rows is None else f"{vise.rows} rows"
            yield Finding(True, f"peg {position} is in row {peg.row} of a jaw with {rows}")
        x, y = hole_place(peg, vise)
        if peg.jaw == "right":
            x += fixture.jaw_separation
        for name, written, derived in (("x", peg.x, x), ("y", peg.y, y)):
            off = abs(derived - written)
            if not off < AGREEMENT:
                words = f"the {name} of peg {position} is {number(off)} mm from that of its hole"
                yield from rule(AGREEMENT - off, words, words)


def jaw_findings(fixture: Fixture, vise: Vise, separation: arb) -> Iterator[Finding]:
    """Whether the jaws can stand at a proven separation in mm, met to a hair (see ``findings``).

    The separation is the gap between the columns next to the opening, so no right peg is nearer to a left one.
    """
    gap, limit = arb(vise.min_gap), vise.max_opening
    yield from rule(
        separation - gap + HAIR,
        f"the jaw separation of {number(separation)} mm is below the smallest gap of {vise.min_gap:g} mm",
        "the jaw separation is exactly at the edge of the smallest gap",
    )
    if limit is not None:
        yield from rule(
            limit - separation + HAIR,
            f"the jaw separation of {number(separation)} mm is above the largest opening of {limit:g} mm",
            "the jaw separation is exactly at the edge of the largest opening",
        )
