"""Of all that trees tell, what is listed, what it is called and how deep it is."""

from __future__ import annotations

from collections import Counter
from math import inf
from typing import Any

import numpy as np
import pytest
from attrs import evolve

import workhold
from seating_examples import STEP, solved
from workhold import Fence, Fixture, Vise
from workhold.kernels.seating.columns import CANDIDATE_LENGTH, CONFIG, CONTACTS, PEG, PIECE, SEPARATION
from workhold.model.seating import SeatContact
from workhold.seating.join_tree import (
    FIXTURE,
    KINDS,
    LOOSE,
    SHALLOW,
    UNSETTLED,
    JoinTree,
    RestPoses,
    classify_seats,
)
from workhold.seating.pattern import Pattern
from workhold.seating.solver import SeatingSolver

CASES = ("sampled", "step", "fence")
Told = tuple[str, float, tuple[float, ...]]


def example(name: str) -> tuple[SeatingSolver, Fixture]:
    """A part on pegs."""
    if name == "sampled":
        return solved(2)[:2]
    toolkit = (
        Vise(20, 2, 3) if name == "step" else Fence(pitch=15, peg_radius=3, wall_offset=6, directions=["-x"])
    )
    return SeatingSolver(STEP, toolkit), workhold.design(STEP, toolkit, best=1)[0]


def kind(row: np.ndarray, boundary: Any, pattern: Pattern) -> str:
    """What a strict seat is called."""
    touches, count = boundary.touches + boundary.hull.touches, int(row[CONTACTS])
    pegs, pieces = (row[at : at + count].astype(int).tolist() for at in (PEG, PIECE))
    if count < 4:
        return "curved"
    if len(set(pegs)) < 4:
        return "pocket"
    at_corner = [
        touches[piece].corner and peg < len(pattern.pegs) for peg, piece in zip(pegs, pieces, strict=True)
    ]
    return "corner" if any(at_corner) else "fixture"


def listed(tree: JoinTree, boundary: Any, pattern: Pattern) -> list[Told]:
    """Kind, depth and configuration of what is listed of a tree, one after the other."""
    every = [(kind(row, boundary, pattern), row) for row in tree.seats] + [
        ("loose", row) for row in tree.loose
    ]
    out = []
    for place, (name, row) in enumerate(every):
        join = tree.find_first_join(place)
        depth = inf if join is None else join.separation - row[SEPARATION]
        if name in ("fixture", "loose") or depth >= 1e-3:
            out.append((name, depth, tuple(row[CONFIG])))
    out += [("loose", 0.0, tuple(row[CONFIG])) for row in tree.slack]
    return out + [("unsettled", inf, tuple(config)) for config in tree.doubtful]


@pytest.mark.parametrize("name", CASES)
def test_what_is_listed_is_what_the_trees_tell(name: str) -> None:
    """As drawn, then turned over; also where something is not settled, and where seats are shallow."""
    solver, fixture = example(name)
    pattern = Pattern.from_fixture(fixture, solver.toolkit)
    boundary = solver.make_closing(pattern, False).boundary
    first, other = solver.find_join_trees(pattern)
    tops = first.tops[: len(first.seats)]
    low = np.array(first.seats)
    # The first seat from which there is a way is next to none, the next just deep enough.
    shallow, deep = np.flatnonzero(tops < inf)[:2]
    low[shallow, SEPARATION], low[deep, SEPARATION] = (
        tops[shallow] - 0.99 * SHALLOW,
        tops[deep] - 1.01 * SHALLOW,
    )
    doubtful = np.array([[0.1, 2.0, 3.0, 4.0]])
    for trees in (
        (first, other),
        (evolve(first, seats=low), other),
        (first, evolve(other, doubtful=doubtful)),
    ):
        rests = RestPoses.from_join_trees(trees, boundary, len(pattern.pegs))
        told = [
            (KINDS[kind], depth, tuple(row))
            for kind, depth, row in zip(rests.kinds, rests.depths, rests.rows[:, CONFIG], strict=True)
        ]
        right = [listed(tree, boundary, pattern) for tree in trees]
        assert told == right[0] + right[1]
        assert rests.turned_over.tolist() == [False] * len(right[0]) + [True] * len(right[1])
    assert KINDS[FIXTURE] == "fixture" and (KINDS[LOOSE], KINDS[UNSETTLED]) == ("loose", "unsettled")


def test_a_peg_that_touches_twice_is_in_a_pocket_whatever_else_touches_a_corner() -> None:
    solver, fixture = example("step")
    boundary = solver.make_closing(Pattern.from_fixture(fixture, solver.toolkit), False).boundary
    corner, face = (
        next(k for k, touch in enumerate(boundary.touches) if touch.corner == is_one)
        for is_one in (True, False)
    )
    rows = np.zeros((4, CANDIDATE_LENGTH))
    rows[:, CONTACTS], rows[:, PEG : PEG + 4], rows[:, PIECE : PIECE + 4] = 4.0, [2, 0, 3, 1], face
    rows[0, PIECE + 2] = rows[1, PIECE + 3] = corner
    rows[1, PEG + 1] = 1.0
    rows[3, CONTACTS] = 3.0
    assert [KINDS[kind] for kind in classify_seats(rows, boundary, 4)] == [
        "corner",
        "pocket",
        "fixture",
        "curved",
    ]


def test_all_kinds_are_among_the_examples() -> None:
    counts = Counter[str]()
    for name in CASES:
        solver, fixture = example(name)
        counts.update(seat.kind for seat in solver.solve(fixture, with_cage=False).seats)
    assert {*KINDS} - {*counts} <= {"unsettled"}


@pytest.mark.parametrize("name", CASES)
def test_seats_have_the_contacts_and_forces_of_their_candidates(name: str) -> None:
    """By the numbers of the fixture's pegs, those on a wall last in candidates; ordered by reading. Also of pegs that are
    known by other numbers."""
    solver, fixture = example(name)
    solver.solve(fixture, with_cage=False)
    order = [0, 1, 2, 3] if name == "fence" else [2, 0, 3, 1]
    seats = solver.solve(evolve(fixture, pegs=tuple(fixture.pegs[k] for k in order)), with_cage=False).seats
    [(pattern, trees, _)] = solver.solved.values()
    boundary = solver.make_closing(pattern, False).boundary
    touches = boundary.touches + boundary.hull.touches
    on_wall = [k for k, peg in enumerate(fixture.pegs) if peg.is_on_wall]
    numbers = [order.index(k) for k in (*pattern.numbers, *on_wall)]
    right = set[object]()
    for turned_over, tree in zip((False, True), trees, strict=True):
        for row in (*tree.seats, *tree.loose, *tree.slack):
            count = int(row[CONTACTS])
            pegs, pieces = (row[at : at + count].astype(int).tolist() for at in (PEG, PIECE))
            pairs = zip(pegs, pieces, strict=True)
            told = tuple(SeatContact(numbers[peg], touches[at].face, touches[at].corner) for peg, at in pairs)
            # Of what is loose no force is known.
            forces = tuple(row[13 : 13 + count].tolist()) if row[13] != 0.0 else ()
            right.add((turned_over, pattern.frame.sign * row[SEPARATION], told, forces))
    for seat in seats:
        told = seat.contacts, seat.forces
        assert (
            (seat.mirrored, seat.jaw_separation, *told) in right
            if seat.kind != "unsettled"
            else told == ((), ())
        )
    keys = [(seat.jaw_separation, seat.mirrored, seat.pose.theta_deg) for seat in seats]
    assert keys == sorted(keys) and sum(seat.is_own for seat in seats) == 1
