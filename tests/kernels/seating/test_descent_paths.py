"""The places that ways down end in: seats, loose sets, what lies below those off which ways lead, and the unsettled."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from loose_sets import laid_out, straight
from workhold.kernels.seating.closing import AT_REST, AT_THE_STOP, GAVE_UP
from workhold.kernels.seating.columns import Manifolds
from workhold.kernels.seating.descent_paths import OUTSIDE, STOP, find_pass_to_outside, write_places

NO_SEATS = np.zeros((0, 4))


def told(
    ends: np.ndarray,
    how: list[int],
    families: Manifolds,
    falling: list[tuple[int, np.ndarray]] = (),
    seats: np.ndarray = NO_SEATS,
    numbers: list[int] = (),
    leaves: list[int] | None = None,
    known: np.ndarray = NO_SEATS,
    first: int | None = None,
) -> tuple[list[int], np.ndarray]:
    """The places of ends, and what is not settled then; ways lead down off some sets to configurations."""
    off = [number for number, _ in falling]
    lying = np.array([k for k in range(len(families.rows)) if k not in off], dtype=np.int64)
    every = np.concatenate([ends, *(below[None] for _, below in falling)])
    ended = np.array([*how, *[AT_REST] * len(off)], np.int8)
    away = np.array([*(leaves or [0] * len(how)), *[0] * len(off)], np.int8)
    doubtful, out = np.concatenate([known, np.empty((len(every), 4))]), np.empty(len(ends), np.int64)
    given = (
        every,
        ended,
        away,
        families,
        lying,
        np.array(off, dtype=np.int64),
        seats,
        np.array(numbers, dtype=np.int64),
    )
    first = len(seats) + len(lying) if first is None else first
    count = write_places(*given, first, 10.0, doubtful, len(known), np.empty(len(off), np.int64), out)
    return out.tolist(), doubtful[:count]


def at(x: float, level: float) -> np.ndarray:
    """A configuration."""
    return np.array([0.0, x, 0.0, level])


def test_where_ways_end_is_told_by_what_lies_there():
    """A seat before a loose set, a set off which a way leads on before both; what is neither once for all that is near."""
    # A set at rest, and two off which ways lead: off the upper one to the lower one, and from there to the rest.
    families = laid_out([straight(7.0, 4.0), straight(9.0, 4.0), straight(8.0, 4.0)])
    falling, seats = [(1, at(1.0, 8.0)), (2, at(3.0, 7.0))], np.array([at(100.0, 5.0), at(2.0, 7.0)])
    where = [(100, 5), (2, 7), (3, 7), (1, 9), (1, 8), (60, 9), (60.1, 9), (2, 7), (100, 5)]
    ends, how = np.array([at(*one) for one in where]), [AT_REST] * 7 + [AT_THE_STOP, GAVE_UP]
    places, doubtful = told(ends, how, families, falling, seats, [0, 1])
    assert places == [0, 1, 2, 2, 2, 3, 3, STOP, 4]
    assert doubtful[:, 1].tolist() == [60.0, 100.0]
    assert told(ends[-2:], how[-2:], families, falling, seats, [0, 1], [1, 1])[0] == [OUTSIDE, 3]
    # What was not settled before comes first.
    assert told(ends[5:7], how[5:7], families, falling, seats, [0, 1], None, ends[-1:])[0] == [4, 4]
    assert told(ends[5:7], how[5:7], families, falling, seats, [0, 1], None, ends[[8, 6]])[0] == [4, 4]
    # What is lower than a set by more than rounding has fallen off it.
    assert told(np.array([at(1.0, 8.9999)]), [AT_REST], families, falling, seats, [0, 1])[0] == [3]
    assert told(np.array([at(1.0, 9.0 - 5e-7)]), [AT_REST], families, falling, seats, [0, 1])[0] == [2]


def test_a_way_that_ends_just_below_its_flat_comes_to_an_end():
    """It is not settled, and one place however many ways lead there."""
    families = laid_out([straight(0.0, 4.0)])
    ends = np.array([at(2.0, 0.0), at(4.0, 0.0)])
    places, doubtful = told(ends, [AT_REST] * 2, families, [(0, at(0.0, -5e-4))])
    assert places == [0, 0] and doubtful[:, 3].tolist() == [-5e-4]


def test_all_that_fall_on_one_way_end_where_it_ends():
    """Also those in the middle of it that are met later."""
    families = laid_out([straight(level, 4.0) for level in (9.0, 8.0, 7.0)])
    falling = [(0, at(1.0, 8.0)), (1, at(1.0, 7.0)), (2, at(50.0, 6.0))]
    ends = np.array([at(3.0, level) for level in (9.0, 8.0, 7.0)])
    places, doubtful = told(ends, [AT_REST] * 3, families, falling)
    assert places == [0, 0, 0] and doubtful[:, 1].tolist() == [50.0]
    # As they did before, though what is not settled is found nearer to there.
    nearer = np.array([at(3.0, 9.0), at(49.8, 6.0), at(3.0, 8.0), at(3.0, 9.0)])
    places, doubtful = told(
        nearer, [AT_REST] * 4, families, falling, NO_SEATS, (), None, np.array([at(50.4, 6.0)])
    )
    assert places == [0, 1, 0, 0] and doubtful[:, 1].tolist() == [50.4, 49.8]


def test_of_two_seats_in_one_pose_the_level_one_is_the_nearest():
    """The jaw may press from within and from without: then only S tells them apart."""
    seats = np.array([at(0.0, 5.0), at(0.0, 9.0)])
    configs = np.array([at(0.0, level) for level in (9.0, 5.0004, 7.0, 9.0, 9.0, 5.0)])
    configs[3:5, 0], configs[5, 1] = [pi, 0.004], 0.06
    places, doubtful = told(configs, [AT_REST] * 6, laid_out([]), (), seats, [3, 0], None, NO_SEATS, 5)
    assert places == [0, 3, 5, 6, 0, 5] and len(doubtful) == 2
    near = np.array([at(0.0, 9.0), at(0.03, 9.0)])
    assert told(near[[0, 1]] + [0.0, 0.001, 0.0, 0.0], [AT_REST] * 2, laid_out([]), (), near, [0, 1])[0] == [
        0,
        1,
    ]


def test_the_first_pass_that_joins_a_place_with_the_outside():
    """Through other places, of which some are joined among themselves only; and none where there is no way."""
    joins = np.array([[0, 1], [2, STOP], [3, OUTSIDE], [1, 0], [STOP, 3], [4, 0], [1, 2]])
    out = {place: find_pass_to_outside(joins, place, np.empty(8, np.int64)) for place in range(6)}
    assert out == {0: 6, 1: 6, 2: 4, 3: 2, 4: 6, 5: -1}
    assert find_pass_to_outside(joins[:0], 0, np.empty(8, np.int64)) == -1


@pytest.mark.parametrize("level", [0.0, 12.5])
def test_a_part_lies_anywhere_in_a_loose_set_but_on_its_level(level):
    families = laid_out([straight(level, 40.0, 41)])
    ends = np.array([at(17.3, level), at(17.3, level + 0.002)])
    assert told(ends, [AT_REST] * 2, families)[0] == [0, 1]
