"""The ways of a part between some pegs: they touch all along what they are said to touch, and the forces balance."""

from __future__ import annotations

from math import cos, hypot, pi, sin, sqrt

import numpy as np
import pytest
from attrs import evolve

from seating_examples import LEFT, RIGHT, held, two_contacts_of
from workhold import Vise, Workpiece
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import CONTACTS, SEPARATION
from workhold.seating.pattern import Pattern, PegSubset
from workhold.seating.self_motions import (
    find_circle_crossings,
    find_motions_on_one_center,
    find_motions_on_one_line,
    find_motions_on_parallel_lines,
    is_balanced,
)
from workhold.seating.solver import SeatingSolver

VISE = Vise(pitch=10, columns=2, peg_radius=3)
# Parallel faces at three depths, a round end, and an arc about the same centre that bends in; none along x or y.
DRAWN = [
    [[0, 0, 0], [60, 0, 1], [60, 50, 0], [20, 50, 0], [20, 40, 0], [0, 40, 0]],
    [[72, 25, -1], [48, 25, -1]],
]
PART = Workpiece.from_loops(
    "handle", [[[0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y, bulge] for x, y, bulge in loop] for loop in DRAWN]
)
DISC = Workpiece.from_loops("disc", [[[-20, 0, 1], [20, 0, 1]]])
SOLVERS = {id(part): SeatingSolver(part, VISE) for part in (PART, DISC)}


def ways_of(part, pegs, right):
    """The ways of pegs by themselves, with the boundary and the pattern."""
    placed = [
        ("right" if side else "left", x + 100.0 * side, y) for side, (x, y) in zip(right, pegs, strict=True)
    ]
    whole = Pattern.from_fixture(held([*placed, ("left", -300.0, 300.0)], (0.0, 0.0, 0.0), 100.0), VISE)
    pattern = evolve(PegSubset.from_pattern(whole, range(len(pegs))).pattern, stop=-np.inf)
    closing = SOLVERS[id(part)].make_closing(pattern, False)
    boundary, held_by = closing.boundary, two_contacts_of(closing)
    three = find_motions_on_parallel_lines(boundary, pattern, held_by.slides, held_by.given)
    return (
        boundary,
        pattern,
        [
            *find_motions_on_one_line(boundary, pattern),
            *three,
            *find_motions_on_one_center(boundary, pattern),
        ],
    )


def random_pegs(count):
    """Triples of pegs, and pairs, of both jaws."""
    random = np.random.default_rng(3)
    for number in range(count):
        right = ([0, 0, 1], [0, 1, 1], [0, 1])[number % 3]
        yield random.integers((0, 0), (3, 9), (len(right), 2)) * 10.0 + random.integers(0, 2, (1, 2)), right


def test_pegs_touch_and_press_all_along():
    """On lines and arcs, two pegs and three; where a line slides, between its ends."""
    kinds = set()
    for pegs, right in random_pegs(60):
        boundary, pattern, ways = ways_of(PART, pegs, right)
        for way in ways:
            kinds.add((len(way.contacts), way.is_closed))
            assert np.ptp(way.configs[:, 3]) == 0.0
            places, matrix = pattern.place_pegs(way.configs), np.zeros((3, len(way.contacts)))
            for at, (peg, piece) in enumerate(way.contacts):
                row = boundary.rows[piece]
                d = places[:, peg] - row[[X, Y]]
                if row[IS_ARC] != 0.0:
                    assert np.abs(np.hypot(*d.T) - row[RADIUS]).max() < 1e-9
                    nx, ny = row[SIGN] * d[0] / row[RADIUS]
                else:
                    nx, ny = row[AXIS_Y], -row[AXIS_X]
                    assert np.abs(d @ [nx, ny]).max() < 1e-9
                    assert np.abs(d @ row[[AXIS_X, AXIS_Y]]).max() < row[HALF_EXTENT] + 1e-5
                c, s = cos(way.configs[0, 0]), sin(way.configs[0, 0])
                matrix[:, at] = c * nx - s * ny, s * nx + c * ny, (c * nx - s * ny) * pattern.right[peg]
            if way.is_closed:
                forces, *_ = np.linalg.lstsq(matrix, np.array([0.0, 0.0, 1.0]), rcond=None)
                assert np.abs(matrix @ forces - [0.0, 0.0, 1.0]).max() < 1e-9 and forces.min() > 0.0
    assert kinds == {(2, False), (2, True), (3, False), (3, True)}


def test_the_half_turn_that_swaps_the_jaws_leaves_all_ways():
    found = 0
    for pegs, right in random_pegs(30):
        one, two = (
            sorted(way.configs[0, 3] + pattern.pegs[-1, 0] - pattern.pegs[0, 0] for way in ways)
            for _, pattern, ways in (
                ways_of(PART, pegs, right),
                ways_of(PART, -pegs, [1 - side for side in right]),
            )
        )
        found += len(one)
        assert one == pytest.approx(two, abs=1e-6)
    assert found > 50


@pytest.mark.parametrize(
    ("height", "is_held"), [(10.0, True), (1.0, True), (19.0, True), (21.0, False), (-5.0, False)]
)
def test_a_disc_turns_between_three_pegs(height, is_held):
    """Two 20 mm above each other and one of the other jaw, which has to press between them."""
    _, pattern, ways = ways_of(DISC, [(0.0, 0.0), (0.0, 20.0), (0.0, height)], [0, 0, 1])
    turns = [way for way in ways if len(way.contacts) == 3]
    apart = sqrt(23.0**2 - 10.0**2) + sqrt(23.0**2 - (height - 10.0) ** 2)
    reached = [way.configs[0, 3] + pattern.pegs[-1, 0] for way in turns]
    assert reached == pytest.approx([apart] if is_held else [], abs=1e-9)
    for way in turns:
        assert np.ptp(way.configs[:, 1:3], axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_forces_balance_as_by_elimination():
    random, seen = np.random.default_rng(5), set()
    for _ in range(400):
        normals, moves = [(cos(a), sin(a)) for a in random.uniform(0.0, 2.0 * pi, 3)], [0, 0, 1]
        matrix = np.array([[x, y, x * move] for (x, y), move in zip(normals, moves, strict=True)]).T
        told = is_balanced(normals, moves)
        assert told == bool((np.linalg.solve(matrix, [0.0, 0.0, 1.0]) > 1e-9).all())
        seen.add(told)
    assert seen == {True, False} and not is_balanced([(1.0, 0.0), (1.0, 0.0), (-1.0, 0.0)], [0, 0, 1])


def test_circles_meet_in_points_of_both():
    for two in ((3.0, 4.0), (-8.0, 0.5)):
        met = find_circle_crossings((1.0, 2.0), 6.0, two, 5.0)
        assert len(met) == 2 and met[0] != met[1]
        for x, y in met:
            assert (hypot(x - 1.0, y - 2.0), hypot(x - two[0], y - two[1])) == pytest.approx((6.0, 5.0))
    assert (
        find_circle_crossings((0.0, 0.0), 1.0, (5.0, 0.0), 3.0)
        == find_circle_crossings((0.0, 0.0), 1.0, (1.0, 0.0), 3.0)
        == []
    )


# Three parallel forces balance only with the middle one against the outer two.
PLATE = Workpiece.from_loops("plate", [[[0, 0, 0], [40, 0, 0], [40, 90, 0], [0, 90, 0]]])


@pytest.mark.parametrize(
    ("heights", "is_held"),
    [((10.0, -40.0), True), ((30.0, -40.0), False), ((-10.0, -40.0), False), ((19.0, -70.0), True)],
)
def test_a_plate_lies_square_only_against_a_peg_between(heights, is_held):
    """Two left pegs 20 apart and one of two right ones, the other of which touches nothing or lies beside them too."""
    vise = Vise(10, 2, 3)
    pegs = [(LEFT, 0.0, 0.0), (LEFT, 0.0, 20.0), (RIGHT, 10.0, heights[0]), (RIGHT, 20.0, heights[1])]
    pattern = Pattern.from_fixture(held(pegs, (0.0, 0.0, 0.0), 0.0), vise)
    tree = SeatingSolver(PLATE, vise).find_join_trees(pattern)[0]
    # Its two long faces are 40 + 2 * 3 apart, the jaws' pegs 10 nearer.
    square = [
        one
        for one in (*tree.loose, *tree.slack)
        if abs(one[SEPARATION] - 36.0) < 1e-9 and one[CONTACTS] >= 3.0
    ]
    assert bool(square) == is_held
