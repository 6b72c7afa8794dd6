"""Pieces tile their curves and bound their slopes."""

from __future__ import annotations

from math import inf, isfinite, isinf, tau
from random import Random

import numpy as np
import pytest
from flint import arb

from chord_examples import arc_row
from curve_examples import HEIGHT, POSITION, pieces_of, random_table, sampled
from exact_chords import exact_chord, exactly
from workhold.contact.curves import LatticeSteps, make_curve_table
from workhold.kernels.base.interval import enclose_slope
from workhold.kernels.base.tables import (
    BRANCH,
    CURVE,
    FROM,
    HEAD,
    HIGH,
    LENGTH,
    LOW,
    SECOND_DERIVATIVE_HIGH,
    SECOND_DERIVATIVE_LOW,
    SHIFT,
    SLOPE_ERROR_HIGH,
    SLOPE_ERROR_LOW,
    SLOPE_HIGH,
    SLOPE_LOW,
    TAIL,
    TANGENT_FROM,
    TANGENT_TO,
    TO,
    VALUE_ERROR_HIGH,
    VALUE_ERROR_LOW,
    VALUE_HIGH,
    VALUE_LOW,
)
from workhold.kernels.chord.coincidences import NONE, find_coincidence


def parts_in_cell(reals: np.ndarray, low: float, high: float) -> list[tuple[float, float]]:
    """The parts of a curve's range of orientations, moved by whole turns, inside a cell."""
    base, span = reals[FROM] - reals[SHIFT], reals[TO] - reals[FROM]
    parts = []
    for lap in range(-5, 6):
        left, right = max(base + lap * tau, low), min(base + lap * tau + span, high)
        if right - left > 1e-9:
            if parts and left - parts[-1][1] < 1e-9:
                left = parts.pop()[0]
            parts.append((left, right))
    return parts


@pytest.mark.thorough
@pytest.mark.thinned(4)
@pytest.mark.parametrize("mode", [HEIGHT, POSITION])
@pytest.mark.parametrize("width", [0.03, 0.5, 3.0, 6.2])
def test_pieces_tile_the_curves_in_a_cell(mode, width):
    """The pieces of a curve follow each other without gap or overlap and cover its range in the cell exactly."""
    random = Random(31)
    for _ in range(6):
        features, table = random_table(random)
        low = random.uniform(-4, 4)
        pieces = pieces_of(features, table, low, low + width, mode)
        for curve in range(len(table)):
            mine = pieces[pieces[:, CURVE] == curve]
            mine = mine[np.argsort(mine[:, LOW])]
            expected = parts_in_cell(table.curves.reals[curve], low, low + width)
            runs = []
            for piece in mine:
                if runs and abs(piece[LOW] - runs[-1][1]) < 4e-15:
                    runs[-1][1] = piece[HIGH]
                else:
                    runs.append([piece[LOW], piece[HIGH]])
            runs = [run for run in runs if run[1] - run[0] > 1e-9]
            assert np.allclose(runs, expected, atol=1e-12)


@pytest.mark.thorough
@pytest.mark.parametrize("mode", [HEIGHT, POSITION])
def test_slopes_stay_in_the_enclosure_of_a_piece(mode):
    """Over any part [s, t] of a piece, slope_range(f'(s), f'(t), second derivative, t - s) contains the slope everywhere."""
    random = Random(32)
    for _ in range(25):
        features, table = random_table(random)
        low = random.uniform(-4, 4)
        pieces = pieces_of(features, table, low, low + random.choice([0.03, 0.5, 2.0]), mode)
        for piece in pieces[:: max(1, len(pieces) // 60)]:
            curve, span = int(piece[CURVE]), piece[HIGH] - piece[LOW]
            if span < 1e-6:
                continue
            s, t = sorted(piece[LOW] + span * random.random() for _ in range(2))
            psis = np.concatenate([[s, t], np.linspace(s, t, 25)[1:-1]])
            slopes = sampled(psis, curve, features, table.curves, mode)[:, 1]
            lowest, highest = enclose_slope(
                slopes[0], slopes[1], piece[SECOND_DERIVATIVE_LOW], piece[SECOND_DERIVATIVE_HIGH], t - s
            )
            away = min(s - piece[LOW], piece[HIGH] - t, 1.0)
            slack = 1e-13 * (100 + np.abs(slopes)) / max(away, 1e-9)
            assert (slopes >= lowest - slack).all() and (slopes <= highest + slack).all()
            whole = enclose_slope(
                piece[SLOPE_LOW],
                piece[SLOPE_HIGH],
                piece[SECOND_DERIVATIVE_LOW],
                piece[SECOND_DERIVATIVE_HIGH],
                span,
            )
            spread = max(piece[SLOPE_ERROR_LOW], piece[SLOPE_ERROR_HIGH])
            slack = np.where(np.isfinite(spread), slack, inf)
            assert (slopes >= whole[0] - slack).all() and (slopes <= whole[1] + slack).all()


@pytest.mark.thorough
@pytest.mark.parametrize("mode", [HEIGHT, POSITION])
def test_values_at_the_ends_of_pieces_are_the_curves(mode):
    """VALUE and SLOPE are limits of the curve; only at a tangency is the slope infinite, and of the right sign."""
    random = Random(33)
    tangencies = 0
    for _ in range(25):
        features, table = random_table(random)
        low = random.uniform(-4, 4)
        for piece in pieces_of(features, table, low, low + 1.5, mode):
            curve, span = int(piece[CURVE]), piece[HIGH] - piece[LOW]
            for end, inward, value, slope, tangent in (
                (
                    piece[LOW],
                    1e-9,
                    piece[VALUE_LOW],
                    piece[SLOPE_LOW],
                    table.curves.reals[curve, TANGENT_FROM],
                ),
                (
                    piece[HIGH],
                    -1e-9,
                    piece[VALUE_HIGH],
                    piece[SLOPE_HIGH],
                    table.curves.reals[curve, TANGENT_TO],
                ),
            ):
                if span < 1e-8:
                    continue
                inside = sampled(np.array([end + inward]), curve, features, table.curves, mode)[0]
                off = inside[0] - value
                if mode == POSITION and features[table.curves.integers[curve, TAIL], 0] != 0.0:
                    off = (off + np.pi) % tau - np.pi
                if isinf(slope):
                    assert tangent
                    tangencies += 1
                    assert abs(off) < 1e-2
                    assert np.sign(inside[1]) == np.sign(slope)
                elif isfinite(slope):
                    assert abs(off) < 1e-8 * (10 + abs(slope) + abs(inside[1]))
    assert tangencies > 50


@pytest.mark.thorough
def test_two_branches_agree_at_their_tangency():
    """Where two branches meet their values agree within the errors told, which are small, so no crossing slips between."""
    random = Random(34)
    joined = 0
    for _ in range(25):
        features, table = random_table(random)
        pieces = pieces_of(features, table, -3.0, 3.0, HEIGHT)
        at_tangency = {}
        for piece in pieces:
            key = tuple(table.curves.integers[int(piece[CURVE]), :4])
            for end, value, error, slope in (
                (piece[LOW], piece[VALUE_LOW], piece[VALUE_ERROR_LOW], piece[SLOPE_LOW]),
                (piece[HIGH], piece[VALUE_HIGH], piece[VALUE_ERROR_HIGH], piece[SLOPE_HIGH]),
            ):
                if isinf(slope):
                    at_tangency.setdefault((*key, round(end, 9)), []).append((end, value, error))
        for ends in at_tangency.values():
            if len(ends) == 2:
                joined += 1
                assert abs(ends[0][0] - ends[1][0]) < 1e-14
                assert abs(ends[0][1] - ends[1][1]) <= ends[0][2] + ends[1][2] < 1e-3
    assert joined > 20


@pytest.mark.thorough
def test_values_at_the_ends_of_pieces_are_within_their_errors():
    """The exact value at both ends of a piece, by 200 bits, lies within the error told; beside a tangency no less."""
    random = Random(35)
    checked = 0
    for mode in (HEIGHT, POSITION):
        for _ in range(8):
            features, table = random_table(random)
            pieces = pieces_of(features, table, -1.0, 1.0, mode)
            for piece in pieces[:: max(1, len(pieces) // 40)]:
                curve = int(piece[CURVE])
                a, b = (features[k] for k in table.curves.integers[curve, [TAIL, HEAD]])
                d, branch, shift = (float(table.curves.reals[curve, k]) for k in (LENGTH, BRANCH, SHIFT))
                if find_coincidence(a, b, d)[0] != NONE:
                    continue
                for end, value, error in (
                    (piece[LOW], piece[VALUE_LOW], piece[VALUE_ERROR_LOW]),
                    (piece[HIGH], piece[VALUE_HIGH], piece[VALUE_ERROR_HIGH]),
                ):
                    with exactly():
                        psi = arb(float(end))
                        exact = exact_chord(a, b, d, psi + shift, branch)
                        if exact is None or not isfinite(error):
                            continue
                        off = (exact.height(psi) if mode == HEIGHT else exact.position())[0] - float(value)
                        if mode == POSITION and a[0] != 0.0:
                            off -= 2 * round(float(off.mid()) / tau) * arb.pi()
                        assert abs(off) <= float(error), (
                            a.tolist(),
                            b.tolist(),
                            d,
                            float(end),
                            shift,
                            branch,
                        )
                        checked += 1
    assert checked > 300


def test_slope_range_is_exact_for_parabolas():
    """For f' with f'' = m the enclosure from its end values is [min, max] of f' at the ends."""
    assert enclose_slope(1.0, 3.0, 2.0, 2.0, 1.0) == (1.0, 3.0)
    assert enclose_slope(3.0, 1.0, -2.0, -2.0, 1.0) == (1.0, 3.0)
    assert enclose_slope(0.0, 0.0, -inf, inf, 1.0) == (-inf, inf)
    # With |f''| <= 1 over width 2 and f' = 0 at both ends, f' reaches at most 1 in the middle.
    assert enclose_slope(0.0, 0.0, -1.0, 1.0, 2.0) == pytest.approx((-1.0, 1.0))


@pytest.mark.parametrize("gap", [3.0, 1e-2, 1e-4])
@pytest.mark.parametrize("mode", [HEIGHT, POSITION])
def test_a_chord_of_one_circle_takes_few_pieces_however_near_it_is_to_the_diameter(gap, mode):
    """Both pegs on one circle turn about its centre: s'' = 0 and h'' = -y . centre, so nothing needs cutting.

    The lines of action are nearly parallel (X is small, and constant) when the chord is nearly a diameter.
    """
    features = np.array([arc_row(3, 4, 8.0)])
    steps = LatticeSteps(np.array([16 - gap]), np.array([0, 1]), np.array([[1, 0]]), np.array([0.0]))
    table = make_curve_table(features, steps)
    assert len(table) >= 2
    assert len(pieces_of(features, table, 0.1, 0.13, mode)) <= 8 * len(table)
