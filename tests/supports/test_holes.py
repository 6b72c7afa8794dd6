"""Whether jaws have room for supports beside their pegs: all ways to shift columns and rows are tried."""

from __future__ import annotations

from itertools import combinations
from random import Random

import numpy as np
import pytest

from supports.random_supports import convex_part
from workhold import Fixture, Vise, design
from workhold.model.support_request import SupportRequest
from workhold.supports.faces import TouchableFace
from workhold.supports.holes import CarrierRoom, find_holes_under_face

pytestmark = pytest.mark.thorough

VISES = (
    Vise(pitch=12, columns=6, peg_radius=2, rows=7, max_opening=50, row_offset=4, blocked=("L-C2", "R-A")),
    Vise(pitch=(10, 8), columns=9, peg_radius=2, rows=6),
    Vise(pitch=10, columns=4, peg_radius=2, max_opening=13),
)
Standing = tuple[int, int, int]


def widest(vise: Vise, fixture: Fixture, standing: list[Standing]) -> float | None:
    """The widest opening of all ways to write pegs and supports out: jaw 0 or 1, column and row of each.

    A left jaw whose holes are counted ``left`` columns further stands so many columns to the left.
    """
    columns, rows = vise.columns, vise.rows or 12
    shifts = np.arange(-3 * columns, 3 * columns + 1)
    left, right, lift = np.meshgrid(shifts, shifts, np.arange(-rows, rows + 1), indexing="ij")
    opening = fixture.travel + (left - right) * vise.pitch[0]
    may = (opening >= vise.min_gap - 1e-9) & (opening <= (vise.max_opening or 1e9) + 1e-9)
    for jaw, own_column, own_row in standing:
        column, row = own_column + (left, right)[jaw], own_row + lift
        may &= (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        for hole in vise.carriers[jaw].blocked:
            may &= (column != hole.column) | ((hole.row is not None) & (row != hole.row))
    return float(opening[may].max()) if may.any() else None


@pytest.mark.sampled(2)
@pytest.mark.parametrize("vise", VISES, ids=("blocked", "rows", "opening"))
def test_sets_fit_where_some_way_to_write_them_out_does(vise: Vise) -> None:
    """They stand nearest the opening, which makes it the widest of all that are possible."""
    random = Random(7)
    fitting = refused = 0
    for _ in range(5):
        part = convex_part(random)
        result = design(part, vise, best=20)
        fixture = random.choice(list(result))
        request = SupportRequest.from_workpiece(part, 12, pad_radius=1.0)
        holes = find_holes_under_face(fixture, vise, TouchableFace.from_loops(part.loops), request)
        room = CarrierRoom.from_fixture(fixture, vise, holes)
        sets = np.array(list(combinations(range(len(holes.row)), 3)), np.int64)
        fits = room.place_sets(sets).fits
        # Some of both answers: in tight vises few sets fit.
        chosen = list[int]()
        for one in (True, False):
            alike = np.flatnonzero(fits == one).tolist()
            chosen += random.sample(alike, min(len(alike), 150))
        sets = sets[chosen]
        found, pairs = room.place_sets(sets), room.find_compatible_pairs()
        pegs = [(int(peg.carrier == "right"), peg.column, peg.row) for peg in fixture.pegs]
        for row, own in enumerate(sets.tolist()):
            pads = [(int(holes.carrier[k]), int(holes.column[k]), int(holes.row[k])) for k in own]
            own_widest = widest(vise, fixture, [*pegs, *pads])
            assert found.fits[row] == (own_widest is not None), (fixture, pads)
            if own_widest is None:
                refused += 1
            else:
                fitting += 1
                assert found.travel[row] == pytest.approx(own_widest, abs=1e-9)
                assert all(pairs[a, b] for a, b in combinations(own, 2))
    assert fitting > 10 and refused > 10
