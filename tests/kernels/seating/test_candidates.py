"""What groups of pegs do is told as what their pattern does: moved, renamed, and no more of it than is reached."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest

from seating_examples import solved, two_contacts_of
from workhold.kernels.seating.candidates import (
    DOUBTFUL,
    IN_BALANCE,
    NO_BALANCE,
    judge_balance,
    write_fourths,
)
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CLEAR,
    CONTACTS,
    DOUBT,
    FORCE,
    PEG,
    PIECE,
    PLACE_X,
    PLACE_Y,
    RESIDUAL,
    SEPARATION,
    THETA,
)
from workhold.kernels.seating.gathering import GATHERED_LENGTH, SUBSET, write_gathered
from workhold.seating.closing import fill_rows
from workhold.seating.pattern import Pattern, list_subsets

STOP, WIDEST = -20.0, 60.0


@pytest.fixture(scope="module")
def given():
    """What kernels are given of a pattern, and its groups."""
    solver, fixture, _ = solved(0)
    pattern = Pattern.from_fixture(fixture, solver.toolkit)
    return two_contacts_of(solver.make_closing(pattern, False)).given, list_subsets(pattern)


def rows_of(random, count, pegs):
    """Candidates of so many pegs, some of them beyond what is reached."""
    rows = random.uniform(0.0, 80.0, (count, CANDIDATE_LENGTH))
    rows[:, CONTACTS], rows[:, PEG:FORCE] = min(pegs, 3), -1.0
    rows[:, PEG : PEG + pegs], rows[:, PIECE : PIECE + pegs] = np.arange(pegs), 0.0
    return rows


def as_of_pattern(group, rows):
    """Candidates of a group as those of its pattern."""
    out = np.array(rows)
    out[:, PLACE_X : SEPARATION + 1] += group.shift[1:]
    for row in out:
        row[PEG:PIECE] = [group.numbers[int(peg)] if peg >= 0 else -1.0 for peg in row[PEG:PIECE]]
    return out


def reached(rows):
    """Those at separations that are reached."""
    return rows[(rows[:, SEPARATION] > STOP) & (rows[:, SEPARATION] < WIDEST)]


def test_all_are_told_in_order_from_where_they_are(given):
    """Before and after the groups' what is of none; of pegs of one jaw what each fourth contact makes of it."""
    given, groups = given
    random, told, kept, wanted, whose, fixed = (
        np.random.default_rng(4),
        [],
        [np.zeros((7, CANDIDATE_LENGTH))],
        [],
        [],
        0,
    )
    before, after = rows_of(random, 5, 4), rows_of(random, 6, 4)
    for number, group in enumerate(groups):
        rows, first = rows_of(random, 9 + number % 3, len(group.sides)), sum(map(len, kept))
        if group.is_of_a_jaw:
            rows[:, THETA], rows[:, PLACE_X : PLACE_Y + 1] = random.uniform(0.0, 6.0, len(rows)), 3.0
        told.append((first, first + len(rows), 1000 + first, *group.numbers_and_shift))
        kept.append(rows)
        own = as_of_pattern(group, rows)
        if group.is_of_a_jaw:
            own = reached(fill_rows(CANDIDATE_LENGTH, 4096, write_fourths, own, group.sides[0], given))
            fixed += len(own)
            whose += [(-1, -1)] * len(own)
        else:
            numbers = np.flatnonzero((own[:, SEPARATION] > STOP) & (own[:, SEPARATION] < WIDEST))
            whose += [(number, 1000 + first + k) for k in numbers.tolist()]
            own = own[numbers]
        wanted.append(own)
    assert {group.is_of_a_jaw for group in groups} == {True, False}
    work = np.empty(CANDIDATE_LENGTH)
    among = np.array(told, dtype=np.float64), np.concatenate(kept), before, after, STOP, WIDEST, given, work
    every, room = fill_rows(GATHERED_LENGTH, 4096, write_gathered, *among), 1
    wanted = np.concatenate([reached(before), *wanted, reached(after)])
    assert fixed > 10 and len(wanted) > fixed + 20 and np.array_equal(every[:, :SUBSET], wanted)
    whose = [(-1, -1)] * len(reached(before)) + whose + [(-1, -1)] * len(reached(after))
    assert every[:, SUBSET:].astype(int).tolist() == [list(one) for one in whose]
    # With any room the same, or none.
    while room < 3 * len(every):
        assert np.array_equal(fill_rows(GATHERED_LENGTH, room, write_gathered, *among), every)
        room = room * 5 // 4 + 1


def test_balance_is_told_of_what_presses():
    """As by NumPy, of random candidates near all that decides."""
    random = np.random.default_rng(2)
    rows = np.zeros((4000, CANDIDATE_LENGTH))
    rows[:, CONTACTS], rows[:, DOUBT] = random.integers(2, 5, len(rows)), random.integers(0, 2, len(rows))
    rows[:, FORCE : FORCE + 4] = random.choice(
        [1.0, 2e-9, 5e-10, -0.5, np.nan], (len(rows), 4), p=[0.7, 0.1, 0.1, 0.05, 0.05]
    )
    rows[:, RESIDUAL] = random.choice([0.0, 5e-8, 2e-7, 5e-4, 2e-3, inf, np.nan], len(rows))
    rows[:, CLEAR] = random.choice([inf, 0.0, -5e-8, -5e-6, -1.0], len(rows))
    used = np.arange(4) < rows[:, CONTACTS, None]
    pressed = np.where(used, rows[:, FORCE : FORCE + 4], 1.0).min(axis=1) > 1e-9
    doubt, off, clear = rows[:, DOUBT] != 0.0, rows[:, RESIDUAL], rows[:, CLEAR]
    for slack, slack_in_doubt in ((1e-7, 1e-5), (inf, inf)):
        told, wanted = np.empty(len(rows), np.int8), np.full(len(rows), NO_BALANCE)
        judge_balance(rows, slack, slack_in_doubt, told)
        wanted[pressed & ~doubt & (off < 1e-7) & (clear > -slack)] = IN_BALANCE
        wanted[pressed & doubt & (off < 1e-3) & (clear > -slack_in_doubt)] = DOUBTFUL
        assert np.array_equal(told, wanted) and len(set(told.tolist())) == 3
