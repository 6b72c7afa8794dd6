"""What lies in loose sets, which of them are one, and where ways off them begin."""

from __future__ import annotations

import numpy as np
import pytest

from loose_sets import NOWHERE, laid_out, straight
from workhold.kernels.seating.columns import Manifolds
from workhold.kernels.seating.gathering import (
    BESIDE,
    write_distinct_sets,
    write_first_manifolds,
    write_starts_beyond_ends,
)

STEP = 0.01


def beyond(families: Manifolds, size: float) -> list[np.ndarray]:
    """Where ways off each set begin."""
    count = len(families.rows)
    configs, whose = np.empty((2 * count, 4)), np.empty(2 * count, np.int64)
    end = write_starts_beyond_ends(families, size, STEP, configs, whose)
    return [configs[:end][whose[:end] == number] for number in range(count)]


def first_of(configs: np.ndarray, families: Manifolds, asked: list[int]) -> list[int]:
    """The first of some sets that each configuration lies in."""
    out = np.empty(len(configs), np.int64)
    write_first_manifolds(configs, families, np.array(asked, dtype=np.int64), 10.0, 1e-3, out)
    return out.tolist()


def once(families: Manifolds) -> Manifolds:
    """Each set once."""
    out = Manifolds.allocate(len(families.rows), len(families.configs))
    return out.take_first(write_distinct_sets(families, 1.0, 1e-6, out))


def test_ways_off_a_bent_set_begin_where_its_ends_lead():
    """Beyond both ends, on from the last steps; to both sides of a middle that gives way, and nowhere of a whole turn."""
    turn = np.linspace(0.0, 1.5, 40)
    configs = np.stack([turn, 20.0 * np.cos(turn), 20.0 * np.sin(turn), np.full(40, 7.0)], axis=1)
    families = laid_out([configs] * 3, None, [False, True, False], [NOWHERE, NOWHERE, (0.0, 1.0)])
    begun, none, across = beyond(families, 10.0)
    assert len(none) == 0 and across.tolist() == [[0.0, 20.0, STEP, 7.0], [0.0, 20.0, -STEP, 7.0]]
    for start, end, before in ((begun[0], configs[0], configs[1]), (begun[1], configs[-1], configs[-2])):
        step, last = start - end, end - before
        assert abs(step[0]) * 10.0 + np.hypot(*step[1:3]) == pytest.approx(STEP, rel=1e-6)
        assert step[:3] @ last[:3] > 0.99 * np.linalg.norm(step[:3]) * np.linalg.norm(last[:3])


def test_an_end_that_stands_twice_leads_on_as_the_way_before_it():
    """Where the part is free up to a step, the end is that step once more; what does not move leads nowhere."""
    configs, still = np.zeros((5, 4)), np.zeros((5, 4))
    configs[:, 1], still[3:, 1] = [0.0, 0.0, 1.0, 2.0, 2.0], [1.0, 2.0]
    begun, one, short = beyond(laid_out([configs, still, configs[:2]]), 10.0)
    assert begun[:, 1] == pytest.approx([-STEP, 2.0 + STEP])
    assert one[:, 1] == pytest.approx([2.0 + STEP]) and len(short) == 0


def test_what_lies_in_a_set_is_as_near_to_its_steps_as_these_are_to_each_other():
    """By turn, place and separation, of all sets at once; of a set of one step, what is beside it."""
    families = laid_out([straight(7.0, 4.0), straight(7.0, 0.0, 1), straight(9.0, 4.0), straight(7.0, 40.0)])
    # Steps are a millimetre long, none, a millimetre and ten.
    edge, off = 5.0 + BESIDE - 1e-6, 5.0 + BESIDE + 1e-6
    places = np.array(
        [
            [0.0, 0.3, 0.0, 7.0],
            [0.0, edge, 0.0, 7.0],
            [0.0, off, 0.0, 7.0],
            [0.0, 0.0, edge - 4.0, 9.0],
            [0.0, 0.0, off - 4.0, 9.0],
            [2.0 * np.pi + 0.1, 0.0, 0.0, 7.0],
            [0.11, 0.0, 0.0, 7.0],
            [0.0, 0.0, BESIDE / 2.0, 7.0005],
            [0.0, 0.0, 0.0, 7.002],
        ]
    )
    expected = [
        [1, 1, 0, 0, 0, 1, 0, 1, 0],
        [0, 0, 0, 0, 0, 0, 0, 1, 0],
        [0, 0, 0, 1] + [0] * 5,
        [1, 1, 1, 0, 0, 1, 1, 1, 0],
    ]
    for number, told in enumerate(expected):
        assert first_of(places, families, [number]) == [inside - 1 for inside in told]
    assert first_of(places, families, [0, 1, 2, 3]) == [0, 0, 3, 2, -1, 0, 3, 0, -1]
    assert first_of(places, families, [3, 0]) == [0, 0, 0, -1, -1, 0, 0, 0, -1]
    # Of a set that turns in one place, a step is as long as the part turns.
    turning = straight(7.0, 0.0, 3)
    turning[:, 0] = [0.0, 0.2, 0.4]
    beside = np.array([[0.3, 0.9, 0.0, 7.0], [0.3, 1.1, 0.0, 7.0]])
    assert first_of(beside, laid_out([turning]), [0]) == [0, -1]
    assert first_of(places, laid_out([]), []) == [-1] * 9 and first_of(places[:0], families, [0]) == []


def test_of_sets_that_lie_in_each_other_the_one_with_the_most_contacts_is_told():
    """What has another separation, or lies elsewhere, stays; so does the first of those with as many contacts."""

    def numbers(parts, contacts):
        families = laid_out(
            parts, contacts, [k % 2 == 0 for k in range(len(parts))], [(k, 0.0) for k in range(len(parts))]
        )
        kept = once(families)
        out = kept.across[:, 0].astype(np.int64).tolist()
        # All of each is handed on.
        assert np.array_equal(kept.rows, families.rows[out]) and np.array_equal(
            kept.closed, families.closed[out]
        )
        every = np.split(kept.configs, kept.begins[1:-1]) if out else []
        assert all(np.array_equal(one, parts[number]) for one, number in zip(every, out, strict=True))
        return out

    same, elsewhere, other = straight(7.0, 4.0), straight(7.0, 4.0, 7, (0.0, 50.0)), straight(8.0, 4.0, 9)
    assert numbers([same, other, same, elsewhere, same], [2.0, 2.0, 3.0, 2.0, 2.0]) == [2, 1, 3]
    assert numbers([same, same], [2.0, 2.0]) == [0]
    # What lies only in a set that is left out itself stays.
    beside, beyond_it = straight(7.0, 4.0, 5, (3.0, 0.0)), straight(7.0, 4.0, 5, (6.0, 0.0))
    assert numbers([beyond_it, beside, same], [1.0, 2.0, 3.0]) == [2, 0]
    assert numbers([], []) == []
