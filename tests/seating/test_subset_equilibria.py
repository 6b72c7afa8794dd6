"""What pegs do by themselves is found once for many patterns, and tells of each of them what it would tell of it alone."""

from __future__ import annotations

from functools import cache
from itertools import combinations
from math import pi, tau
from typing import Any

import numpy as np
import pytest
from attrs import evolve

import workhold
from seating_examples import STEP, equilibria_of
from workhold import Vise
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CONTACTS,
    FORCE,
    PEG,
    PIECE,
    PLACE_X,
    PLACE_Y,
    SEPARATION,
    THETA,
)
from workhold.kernels.seating.obstacles import write_clearances_of_points
from workhold.kernels.seating.slides import write_blocked_slides
from workhold.seating import two_contact_curves
from workhold.seating.closing import fill_rows
from workhold.seating.equilibria import Equilibria, SubsetCache, find_subset_equilibria
from workhold.seating.pattern import Pattern, PegSubset, list_subsets
from workhold.seating.solver import SeatingSolver

VISE = Vise(pitch=10, columns=2, peg_radius=3)
FIRST = 6


@cache
def patterns() -> list[Pattern]:
    """Patterns of one part that share pairs and triples, some with three pegs on a jaw."""
    fixtures = workhold.design(STEP, VISE, best=60)
    three, two = ([f for f in fixtures if f.type == kind][:FIRST] for kind in ("II", "I"))
    assert len(three) == len(two) == FIRST
    return [Pattern.from_fixture(fixture, VISE) for fixture in (*two, *three)]


def solve(solver: SeatingSolver, pattern: Pattern) -> tuple[Equilibria, Equilibria]:
    """What is found of a pattern, as drawn and turned over."""
    both = (solver.make_closing(pattern, turned_over) for turned_over in (False, True))
    one, two = (equilibria_of(closing) for closing in both)
    return one, two


def told(found: Equilibria) -> list[bytes]:
    """All of it, to the last bit."""
    loose = [part.tobytes() for part in found.loose]
    return [found.seats.tobytes(), found.passes.tobytes(), found.doubtful.tobytes(), *loose]


@cache
def by_themselves() -> list[list[bytes]]:
    """What is found of each pattern by a solver that has seen no other."""
    return [
        [byte for one in solve(SeatingSolver(STEP, VISE), pattern) for byte in told(one)]
        for pattern in patterns()
    ]


@pytest.mark.thorough
def test_nothing_depends_on_what_was_solved_before():
    """Not on the order of patterns: to the last bit."""
    solver, count = SeatingSolver(STEP, VISE), 0
    for number in reversed(range(len(patterns()))):
        assert [byte for one in solve(solver, patterns()[number]) for byte in told(one)] == by_themselves()[
            number
        ]
        count += len(list_subsets(patterns()[number]))
    [boundary] = solver.boundaries.values()
    assert (
        len(boundary.find_once(SubsetCache.make_empty).found) < 0.8 * count
        and len(boundary.find_once(two_contact_curves.make_curve_cache)) < count
    )


@pytest.mark.thorough
def test_what_is_forgotten_is_found_again(monkeypatch):
    """With room for three groups, which one pattern has more of, and the cells of one or two jaws, the same; and no more are
    kept than those of a pattern."""
    monkeypatch.setattr("workhold.seating.equilibria.MOST_KEPT", 3)
    monkeypatch.setattr(two_contact_curves, "MOST_KEPT", 1500)
    solver = SeatingSolver(STEP, VISE)
    for pattern, known in zip(patterns()[:2], by_themselves()[:2], strict=True):
        assert [byte for one in solve(solver, pattern) for byte in told(one)] == known
    for boundary in (one for drawn in solver.boundaries.values() for one in (drawn, drawn.turned_over)):
        assert 0 < len(boundary.find_once(SubsetCache.make_empty).found) <= len(list_subsets(patterns()[1]))
        assert (
            0
            < sum(len(one.cells) for one in boundary.find_once(two_contact_curves.make_curve_cache).values())
            <= 1500
        )


@pytest.mark.parametrize("order", [[0, 1, 2, 3], [3, 1, 0, 2]])
def test_pegs_that_stand_alike_are_one_group(order):
    """Moved, renamed, counted from another separation and off by rounding; and the stop is none of a group's own."""
    for pattern in (patterns()[0], patterns()[-1]):
        places = (
            pattern.pegs[order]
            + [17.3, -8.1]
            + 1e-13 * np.array([[1.0, -1.0], [-1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
        )
        right = pattern.right[order]
        places[:, 0] += 5.7 * right
        other = evolve(pattern, pegs=places, right=right, stop=pattern.stop - 5.7)
        assert {group.key for group in list_subsets(other)} == {group.key for group in list_subsets(pattern)}
        for group in list_subsets(other):
            # Back in the pattern each peg stands where it stands.
            own, config = group.pattern, np.array([[0.0, 0.0, 0.0, 12.0]])
            back = own.place_pegs(config) - other.place_pegs(config + group.shift)[:, list(group.numbers)]
            assert np.abs(back).max() < 1e-10
            assert own.stop <= other.stop - group.shift[3]


def test_groups_that_stand_otherwise_are_others():
    """By where a peg stands, which jaw it is of and the gap that is kept."""
    pattern = patterns()[0]
    known = PegSubset.from_pattern(pattern, (0, 1, 2)).key
    lifted = pattern.pegs + np.array([[0.0, 0.0], [0.0, 0.0], [0.0, 1e-6], [0.0, 0.0]])
    for other in (
        evolve(pattern, pegs=lifted),
        evolve(pattern, right=1 - pattern.right),
        evolve(pattern, gap=pattern.gap + 1.0),
    ):
        assert PegSubset.from_pattern(other, (0, 1, 2)).key != known


def touch(row: np.ndarray, pattern: Pattern, boundary: Any) -> None:
    """See that each peg of a candidate is on the piece it is said to touch."""
    places, out = pattern.place_pegs(row[None, :4])[0], np.empty(1)
    for peg, piece in zip(row[PEG:PIECE].astype(int), row[PIECE:FORCE].astype(int), strict=True):
        if peg >= 0:
            write_clearances_of_points(places[[peg]], boundary.loose, piece, piece + 1, out)
            assert abs(out[0]) < 1e-7


def slides_on(row: np.ndarray, pattern: Pattern, boundary: Any) -> int:
    """How many pegs of one jaw touch in a candidate, two of them on parallel faces on which the part slides; 0 of none."""
    touching = [(int(row[PEG + k]), boundary.rows[int(row[PIECE + k])]) for k in range(int(row[CONTACTS]))]
    for (p, one), (q, two) in combinations(touching, 2):
        across = abs(one[AXIS_X] * two[AXIS_Y] - one[AXIS_Y] * two[AXIS_X])
        if (
            p != q
            and pattern.right[p] == pattern.right[q]
            and one[IS_ARC] == two[IS_ARC] == 0.0
            and across < 1e-9
        ):
            return len({peg for peg, _ in touching if pattern.right[peg] == pattern.right[p]})
    return 0


@pytest.mark.thorough
def test_parts_that_slide_are_stopped_and_clamped():
    """Two pegs of a jaw on parallel faces: clamped by one of the other on an arc, by two, or stopped by a third of their
    own; and in each all that touches does."""
    told = set()
    for pattern in patterns():
        solver = SeatingSolver(STEP, VISE)
        closing = solver.make_closing(pattern, False)
        found = solve(solver, pattern)[0]
        for row in np.concatenate([found.seats, found.passes]):
            touch(row, pattern, closing.boundary)
            told.add((int(row[CONTACTS]), slides_on(row, pattern, closing.boundary)))
    assert told >= {(3, 2), (4, 2), (4, 3)}


def test_slides_end_where_a_third_peg_of_the_jaw_touches():
    """As three pegs in three places are found, which they are too where no two of them slide."""
    pattern, solver = patterns()[-1], SeatingSolver(STEP, VISE)
    boundary, size = solver.make_closing(pattern, False).boundary, solver.outline.arm
    [group] = (group for group in list_subsets(pattern) if group.is_of_a_jaw and len(group.sides) == 3)
    held = two_contact_curves.TwoContactCurves.from_pattern(boundary, group.pattern)
    stopped = fill_rows(CANDIDATE_LENGTH, 256, write_blocked_slides, held.slides, held.given)
    assert len(stopped) > 2
    kept = SubsetCache()
    own = find_subset_equilibria(kept, boundary, group, size)
    every, told = np.split(kept.candidates[own.first : own.end], [-len(stopped)])
    assert np.array_equal(told, stopped)
    for row in stopped:
        touch(row, group.pattern, boundary)
        turn = np.abs((every[:, THETA] - row[THETA] + pi) % tau - pi)
        assert (
            turn + np.abs(every[:, PLACE_X : PLACE_Y + 1] - row[PLACE_X : PLACE_Y + 1]).sum(axis=1)
        ).min() < 1e-6


@pytest.mark.thorough
def test_all_kinds_of_groups_have_their_part():
    """Two, three and four pegs touch in what is found, a peg in a corner among them, none at less than the stop."""
    pegs, pockets, loose = set(), 0, 0
    for pattern in patterns():
        found = solve(SeatingSolver(STEP, VISE), pattern)[0]
        rows = np.concatenate([found.seats, found.passes])
        assert (rows[:, SEPARATION] > pattern.stop).all()
        assert pattern.is_reachable(found.loose.rows[:, SEPARATION]).all()
        for row in rows:
            touching = [int(peg) for peg in row[PEG:PIECE] if peg >= 0]
            pegs.add(len(set(touching)))
            pockets += len(set(touching)) < len(touching)
        loose += len(found.loose.rows)
    assert pegs == {2, 3, 4} and pockets > 0 and loose > 0
