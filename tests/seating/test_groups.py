"""What pegs do by themselves is found once for many patterns, and tells of each of them what it would tell of it alone."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from attrs import evolve

import workhold
from workhold import Vise, Workpiece
from workhold.kernels.seating.columns import PEG, PIECE, SEPARATION
from workhold.seating import alone, holdings
from workhold.seating.equilibria import Equilibria, equilibria
from workhold.seating.groups import Group, groups_of
from workhold.seating.pattern import Pattern
from workhold.seating.seating import Solver

# Two parallel faces, two corners in which a peg has room, and a bore: pairs, triples, slides and pockets.
STEP = Workpiece.from_loops("step", [[[0, 0, 0], [50, 0, 0], [50, 20, 0], [28, 20, 0], [28, 44, 0], [0, 36, 0]]])
VISE = Vise(pitch=10, columns=2, peg_radius=3)
FIRST = 6


@cache
def patterns() -> list[Pattern]:
    """Patterns of one part that share pairs and triples, some with three pegs on a jaw."""
    fixtures = workhold.design(STEP, VISE, best=60)
    three, two = ([f for f in fixtures if f.type == kind][:FIRST] for kind in ("II", "I"))
    assert len(three) == len(two) == FIRST
    return [Pattern.of(fixture, VISE) for fixture in (*two, *three)]


def solve(solver: Solver, pattern: Pattern) -> tuple[Equilibria, Equilibria]:
    """What is found of a pattern, as drawn and turned over."""
    both = (solver.closing(pattern, turned_over) for turned_over in (False, True))
    one, two = (equilibria(closing.locus, pattern, closing.size) for closing in both)
    return one, two


def told(found: Equilibria) -> list[bytes]:
    """All of it, to the last bit."""
    loose = [part.tobytes() for family in found.loose for part in (family.candidate, family.configs)]
    return [found.seats.tobytes(), found.passes.tobytes(), found.doubtful.tobytes(), *loose]


@cache
def by_themselves() -> list[list[bytes]]:
    """What is found of each pattern by a solver that has seen no other."""
    return [[byte for one in solve(Solver(STEP, VISE), pattern) for byte in told(one)] for pattern in patterns()]


def test_nothing_depends_on_what_was_solved_before():
    """Not on the order of patterns: to the last bit."""
    solver, count = Solver(STEP, VISE), 0
    for number in reversed(range(len(patterns()))):
        assert [byte for one in solve(solver, patterns()[number]) for byte in told(one)] == by_themselves()[number]
        count += len(groups_of(patterns()[number]))
    [locus] = solver.loci.values()
    assert len(locus.alone) < 0.8 * count and len(locus.held) < count


def test_what_is_forgotten_is_found_again(monkeypatch):
    """With room for three groups and the cells of one or two jaws, the same; and no more are kept."""
    monkeypatch.setattr(alone, "MOST_KEPT", 3)
    monkeypatch.setattr(holdings, "MOST_KEPT", 1500)
    solver = Solver(STEP, VISE)
    for pattern, known in zip(patterns()[:2], by_themselves()[:2], strict=True):
        assert [byte for one in solve(solver, pattern) for byte in told(one)] == known
    for locus in (one for drawn in solver.loci.values() for one in (drawn, drawn.turned_over)):
        assert 0 < len(locus.alone) <= 3
        assert 0 < sum(len(one.cells) for one in locus.held.values()) <= 1500


@pytest.mark.parametrize("order", [[0, 1, 2, 3], [3, 1, 0, 2]])
def test_pegs_that_stand_alike_are_one_group(order):
    """Moved, renamed, counted from another separation and off by rounding; and the stop is none of a group's own."""
    for pattern in (patterns()[0], patterns()[-1]):
        places = (
            pattern.pegs[order] + [17.3, -8.1] + 1e-13 * np.array([[1.0, -1.0], [-1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
        )
        right = pattern.right[order]
        places[:, 0] += 5.7 * right
        other = evolve(pattern, pegs=places, right=right, stop=pattern.stop - 5.7)
        assert {group.key for group in groups_of(other)} == {group.key for group in groups_of(pattern)}
        for group in groups_of(other):
            # Back in the pattern each peg stands where it stands.
            own, config = group.pattern, np.array([[0.0, 0.0, 0.0, 12.0]])
            back = own.at(config) - other.at(config + group.shift)[:, list(group.numbers)]
            assert np.abs(back).max() < 1e-10
            assert own.stop <= other.stop - group.shift[3]


def test_groups_that_stand_otherwise_are_others():
    """By where a peg stands, which jaw it is of and the gap that is kept."""
    pattern = patterns()[0]
    known = Group.of(pattern, (0, 1, 2)).key
    lifted = pattern.pegs + np.array([[0.0, 0.0], [0.0, 0.0], [0.0, 1e-6], [0.0, 0.0]])
    for other in (
        evolve(pattern, pegs=lifted),
        evolve(pattern, right=1 - pattern.right),
        evolve(pattern, gap=pattern.gap + 1.0),
    ):
        assert Group.of(other, (0, 1, 2)).key != known


def test_all_kinds_of_groups_have_their_part():
    """Two, three and four pegs touch in what is found, a peg in a corner among them, none at less than the stop."""
    pegs, pockets, loose = set(), 0, 0
    for pattern in patterns():
        found = solve(Solver(STEP, VISE), pattern)[0]
        rows = np.concatenate([found.seats, found.passes])
        assert (rows[:, SEPARATION] > pattern.stop).all()
        assert all(pattern.reaches(family.middle[3]) for family in found.loose)
        for row in rows:
            touching = [int(peg) for peg in row[PEG:PIECE] if peg >= 0]
            pegs.add(len(set(touching)))
            pockets += len(set(touching)) < len(touching)
        loose += len(found.loose)
    assert pegs == {2, 3, 4} and pockets > 0 and loose > 0
