"""Bounds of the ray on which an instant centre lies, and that nothing is left out by them that balances."""

from __future__ import annotations

from itertools import product
from math import cos, hypot, sin

import numpy as np
import pytest

from seating_examples import cells_by_pair, solved, two_contacts_of
from workhold.kernels.base.feature import IS_ARC
from workhold.kernels.base.tables import HEAD, TAIL
from workhold.kernels.seating.columns import DEPTH, FIRST_PEG, HIGH, KIND, LOW, PAIR, SOURCE, VAGUE
from workhold.kernels.seating.obstacles import find_foot, is_on_piece, share_normals
from workhold.kernels.seating.three_contacts import (
    ROOT_LENGTH,
    ROOT_PEG,
    ROOT_PIECE,
    ROOT_PSI,
    ROOT_SIDE,
    may_balance,
    write_three_contacts,
)
from workhold.kernels.seating.two_contact_curves import Ray, compute_pair_state, read_pair_state, read_ray
from workhold.seating.closing import fill_rows
from workhold.seating.pattern import Pattern

# mm, and a share. Rounding of an instant centre, which may be a kilometre off.
ROUNDING, SHARE = 1e-6, 1e-6
STILL = Ray(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def cells_of(number):
    """An example's part and curves, and every cell over which its ray is known, with its middle."""
    solver, fixture, _ = solved(number)
    pattern = Pattern.from_fixture(fixture, solver.toolkit)
    closing = solver.make_closing(pattern, False)
    boundary, curves = closing.boundary, two_contacts_of(closing)
    kinds = curves.given.pairs[:, KIND]
    kept = [
        (cell, middle)
        for side in curves.jaws
        for cell, middle in zip(*cells_by_pair(curves, side), strict=True)
        if cell[VAGUE] == 0.0 and kinds[int(cell[PAIR])] == 0.0 and read_ray(middle)[0] > 0.0
    ]
    assert len(kept) > 200
    return boundary, curves, kept


@pytest.mark.thorough
@pytest.mark.parametrize("number", range(3))
def test_instant_centers_are_on_their_ray(number):
    """As far off as told, in about its direction, the first contact no farther from its place in the middle than told."""
    _, curves, kept = cells_of(number)
    given = curves.sought
    for cell, middle in kept:
        (least, most, rx, ry, drift, turn, _), known = read_ray(middle), read_pair_state(middle)
        for psi in np.linspace(cell[LOW], cell[HIGH], 7)[1:-1]:
            s = compute_pair_state(given.pairs[int(cell[PAIR])], given, psi)
            px, py = s[6] - s[0], s[7] - s[1]
            far = hypot(px, py)
            assert least * (1.0 - SHARE) - ROUNDING <= far <= most * (1.0 + SHARE) + ROUNDING
            assert hypot(px / far - rx, py / far - ry) <= turn + SHARE
            assert hypot(s[0] - known[0], s[1] - known[1]) <= drift + ROUNDING


@pytest.mark.thorough
@pytest.mark.parametrize("number", range(3))
def test_where_a_third_peg_balances_it_is_found(number):
    """Pegs of the other jaw are put level with the foot of P at an orientation in a cell, if the three forces balance."""
    boundary, curves, kept = cells_of(number)
    given, random, count = curves.sought, np.random.default_rng(number), 0
    work = np.empty((DEPTH, 2)), np.empty((5, len(boundary.discs)))
    for cell, middle in kept:
        pair, psi = given.pairs[int(cell[PAIR])], random.uniform(cell[LOW], cell[HIGH])
        tail, curve, s = int(pair[FIRST_PEG]), int(pair[SOURCE]), compute_pair_state(pair, given, psi)
        others, (x, y) = given.right != given.right[tail], (cos(psi), sin(psi))
        push = 1.0 if given.right[tail] == 0 else -1.0
        for piece, side in product(range(len(given.rows)), (1.0, -1.0)):
            row = given.rows[piece]
            fx, fy, nx, ny, _ = find_foot(row, s[6], s[7], side)
            balances = push * (nx * x + ny * y) > 0.0 and may_balance(s, nx, ny, STILL, -2e-9)
            if not (balances and is_on_piece(row, fx, fy, 0.0)) or (row[IS_ARC] == 0.0 and side < 0.0):
                continue
            if any(share_normals(given.rows[given.curves[curve, end]], row) for end in (TAIL, HEAD)):
                continue
            pegs = np.array(given.pegs)
            pegs[others, 1] = pegs[tail, 1] + x * (fy - s[1]) - y * (fx - s[0])
            one = cell[None, :], middle[None, :], given._replace(pegs=pegs), boundary.discs, -1e4
            roots = fill_rows(ROOT_LENGTH, 64, write_three_contacts, *one, *work)
            here = (
                (roots[:, ROOT_PIECE] == piece)
                & (roots[:, ROOT_SIDE] == side)
                & (abs(roots[:, ROOT_PSI] - psi) < 1e-7)
            )
            assert set(roots[here, ROOT_PEG]) == set(np.flatnonzero(others))
            count += 1
    assert count > 200
