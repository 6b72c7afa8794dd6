"""Ways down that fall off a flat face and end just below it, where ways off loose sets begin, and what lies in them."""

from __future__ import annotations

import numpy as np
import pytest

from workhold.kernels.seating.closing import AT_REST, AT_THE_STOP
from workhold.kernels.seating.columns import CANDIDATE_LENGTH, CONTACTS, SEPARATION
from workhold.kernels.seating.freedom import BESIDE as BESIDE_STEPS
from workhold.seating.families import Families, Family, Finder
from workhold.seating.tree import OUTSIDE, STOP, Builder, ends_of, first_of
from workhold.seating.ways_down import BESIDE


class Jaws:
    """Jaws that close by less than a thousandth of a millimetre, wherever the part lies."""

    size = 10.0

    def run(self, configs: np.ndarray, first: float) -> tuple[np.ndarray, np.ndarray]:
        return configs - [0.0, 0.0, 0.0, 5e-4], np.array([AT_REST], np.int8)

    def escape(self, configs: np.ndarray) -> np.ndarray:
        return np.zeros(len(configs), np.bool_)


def test_a_way_that_ends_just_below_its_flat_comes_to_an_end():
    configs = np.zeros((5, 4))
    configs[:, 1] = np.arange(5.0)
    flat = Family(np.zeros(CANDIDATE_LENGTH), configs, False, None)
    none = np.zeros((0, CANDIDATE_LENGTH))
    builder = Builder(
        Jaws(), none, [], [(flat, configs[0], configs[0] - [0.0, 0.0, 0.0, 5e-4], AT_REST)], [], np.ones(0, np.bool_)
    )
    assert builder.places(configs[:1], configs[2:3], np.array([AT_REST], np.int8)) == [0]
    assert builder.doubtful[0][3] == -5e-4


def test_ways_off_a_bent_set_begin_where_its_ends_lead():
    """Beyond both ends, on from the last steps; to both sides of a middle that gives way, and nowhere of a whole turn."""
    turn = np.linspace(0.0, 1.5, 40)
    configs = np.stack([turn, 20.0 * np.cos(turn), 20.0 * np.sin(turn), np.full(40, 7.0)], axis=1)
    row = np.zeros(CANDIDATE_LENGTH)
    bent, whole = Family(row, configs, False, None), Family(row, configs, True, None)
    gives = Family(row, configs, False, (0.0, 1.0))
    begun, none, across = ends_of(Families.of([bent, whole, gives]), 10.0)
    assert len(none) == 0 and across[:, 2].tolist() == [BESIDE, -BESIDE]
    for start, end, before in ((begun[0], configs[0], configs[1]), (begun[1], configs[-1], configs[-2])):
        step, last = start - end, end - before
        assert abs(step[0]) * 10.0 + np.hypot(*step[1:3]) == pytest.approx(BESIDE, rel=1e-6)
        assert step[:3] @ last[:3] > 0.99 * np.linalg.norm(step[:3]) * np.linalg.norm(last[:3])


def test_an_end_that_stands_twice_leads_on_as_the_way_before_it():
    """Where the part is free up to a step, the end is that step once more."""
    configs = np.zeros((5, 4))
    configs[:, 1] = [0.0, 0.0, 1.0, 2.0, 2.0]
    row = np.zeros(CANDIDATE_LENGTH)
    family = Family(row, configs, False, None)
    [begun] = ends_of(Families.of([family]), 10.0)
    assert begun[:, 1] == pytest.approx([-BESIDE, 2.0 + BESIDE])


def straight(level: float, length: float, steps: int = 5, contacts: float = 2.0) -> Family:
    """A set along x from the origin on."""
    configs = np.zeros((steps, 4))
    configs[:, 1], configs[:, 3] = np.linspace(0.0, length, steps), level
    row = np.zeros(CANDIDATE_LENGTH)
    row[SEPARATION], row[CONTACTS] = level, contacts
    return Family(row, configs, False, None)


def test_what_lies_in_a_set_is_as_near_to_its_steps_as_these_are_to_each_other():
    """By turn, place and separation, of all sets at once; of a set of one step, what is beside it."""
    sets = [straight(7.0, 4.0), straight(7.0, 0.0, 1), straight(9.0, 4.0), straight(7.0, 40.0)]
    # Steps are a millimetre long, none, a millimetre and ten.
    edge, off = 5.0 + BESIDE_STEPS - 1e-6, 5.0 + BESIDE_STEPS + 1e-6
    places = np.array(
        [
            [0.0, 0.3, 0.0, 7.0],
            [0.0, edge, 0.0, 7.0],
            [0.0, off, 0.0, 7.0],
            [0.0, 0.0, edge - 4.0, 9.0],
            [0.0, 0.0, off - 4.0, 9.0],
            [2.0 * np.pi + 0.1, 0.0, 0.0, 7.0],
            [0.11, 0.0, 0.0, 7.0],
            [0.0, 0.0, BESIDE_STEPS / 2.0, 7.0005],
            [0.0, 0.0, 0.0, 7.002],
        ]
    )
    told = Families.of(sets).hold(places, 10.0, 1e-3)
    assert told.astype(int).tolist() == [
        [1, 0, 0, 1],
        [1, 0, 0, 1],
        [0, 0, 0, 1],
        [0, 0, 1, 0],
        [0, 0, 0, 0],
        [1, 0, 0, 1],
        [0, 0, 0, 1],
        [1, 1, 0, 1],
        [0, 0, 0, 0],
    ]
    assert first_of(told).tolist() == [0, 0, 3, 2, -1, 0, 3, 0, -1]
    # Of a set that turns in one place, a step is as long as the part turns.
    turning = straight(7.0, 0.0, 3)
    turning.configs[:, 0] = [0.0, 0.2, 0.4]
    beside = np.array([[0.3, 0.9, 0.0, 7.0], [0.3, 1.1, 0.0, 7.0]])
    assert Families.of([turning]).hold(beside, 10.0, 1e-3).tolist() == [[True], [False]]
    none = Families.of([]).hold(places, 10.0, 1e-3)
    assert none.shape == (9, 0) and first_of(none).tolist() == [-1] * 9
    assert Families.of(sets).hold(places[:0], 10.0, 1e-3).shape == (0, 4)


def test_of_sets_that_lie_in_each_other_the_one_with_the_most_contacts_is_told():
    """What has another separation, or lies elsewhere, stays; so does the first of those with as many contacts."""
    finder = Finder.__new__(Finder)
    elsewhere = straight(7.0, 4.0)
    elsewhere.configs[:, 2] = 50.0
    elsewhere.candidate[2] = 50.0
    two, three, same, other = (
        straight(7.0, 4.0),
        straight(7.0, 4.0, contacts=3.0),
        straight(7.0, 4.0),
        straight(8.0, 4.0),
    )
    assert finder.families([two, other, three, elsewhere, same]) == [three, other, elsewhere]
    assert finder.families([two, same]) == [two]
    # What lies only in a set that is left out itself stays.
    beside, beyond = straight(7.0, 4.0), straight(7.0, 4.0, contacts=1.0)
    for family, shift in ((beside, 3.0), (beyond, 6.0)):
        family.configs[:, 1] += shift
        family.candidate[1] = shift
    assert finder.families([beyond, beside, three]) == [three, beyond]
    assert finder.families([]) == []


def test_where_ways_end_is_told_by_what_lies_there():
    """A seat before a loose set, a set off which a way leads on before both; what is neither once for all that is near."""
    seats = np.zeros((2, CANDIDATE_LENGTH))
    seats[:, 1], seats[:, SEPARATION] = [100.0, 2.0], [5.0, 7.0]
    rest = straight(7.0, 4.0)
    upper, lower = straight(9.0, 4.0), straight(8.0, 4.0)
    below = np.array([0.0, 1.0, 0.0, 8.0]), np.array([0.0, 3.0, 0.0, 7.0])
    falling = [(upper, upper.configs[0], below[0], AT_REST), (lower, lower.configs[0], below[1], AT_REST)]
    builder = Builder(Jaws(), seats, [rest], falling, [], np.ones(2, np.bool_))
    ends = np.array(
        [
            [0.0, 100.0, 0.0, 5.0],
            [0.0, 2.0, 0.0, 7.0],
            [0.0, 3.0, 0.0, 7.0],
            [0.0, 1.0, 0.0, 9.0],
            [0.0, 1.0, 0.0, 8.0],
            [0.0, 60.0, 0.0, 9.0],
            [0.0, 60.1, 0.0, 9.0],
            [0.0, 2.0, 0.0, 7.0],
            [0.0, 100.0, 0.0, 5.0],
        ]
    )
    how = np.array([AT_REST] * 7 + [AT_THE_STOP, 77], np.int8)
    # Off the upper set it goes to the lower one, and from there to the rest, whose place follows those of the seats.
    assert builder.places(ends, ends, how) == [0, 1, 2, 2, 2, 3, 3, STOP, 4]
    assert [config[1] for config in builder.doubtful] == [60.0, 100.0]
    builder.closing.escape = lambda configs: np.ones(len(configs), np.bool_)
    assert builder.places(ends[-2:], ends[-2:], how[-2:]) == [OUTSIDE, 4]
    # What is lower than a set by more than rounding has fallen off it.
    assert builder.places(ends[:1], np.array([[0.0, 1.0, 0.0, 8.9999]]), how[:1]) == [5]
