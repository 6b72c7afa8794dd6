"""Undecided entries of a proof that are real places: fixtures as if they had not been decided."""

from __future__ import annotations

from typing import Any

from workhold import Fixture
from workhold.fixels.toolkit import Toolkit
from workhold.listing.seats import list_undecided_pairs
from workhold.model.fixture_table import FixtureTable
from workhold.model.search_report import AT_AN_EDGE, UndecidedCandidate

__all__ = ["as_undecided", "pairs_undecided"]


def as_undecided(fixture: Fixture) -> UndecidedCandidate:
    """A fixture as if it had not been decided: holes count from each jaw's first peg and from the first left peg; of a clamp
    its line from the first locator's."""
    first = {peg.carrier: peg for peg in reversed(fixture.pegs)}
    columns = [peg.column - first[peg.carrier].column for peg in fixture.pegs]
    rows = [peg.row - fixture.pegs[0].row for peg in fixture.pegs]
    kind = fixture.type
    if fixture.direction is not None:
        kind = f"{kind} {fixture.direction}"
        if fixture.direction.endswith("y"):
            columns[3], rows[3] = fixture.pegs[3].column - fixture.pegs[0].column, 0
    faces = [peg.face for peg in fixture.pegs]
    quartets: list[Any] = [tuple(faces), tuple(columns), tuple(rows)]
    return UndecidedCandidate(kind, *quartets, fixture.pose.theta_deg, AT_AN_EDGE, 1e-8)


def pairs_undecided(table: FixtureTable, toolkit: Toolkit) -> list[UndecidedCandidate]:
    """Fixtures with two clamps as a search names them where it cannot decide them."""
    return list(list_undecided_pairs(table, toolkit))
