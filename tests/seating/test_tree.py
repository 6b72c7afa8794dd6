"""Ways down that fall off a flat face and end just below it, and where ways off loose sets begin."""

from __future__ import annotations

import numpy as np
import pytest

from workhold.kernels.seating.closing import AT_REST
from workhold.kernels.seating.columns import CANDIDATE_LENGTH
from workhold.seating.families import Family
from workhold.seating.tree import Builder, ends_of
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
    begun, none, across = ends_of([bent, whole, gives], 10.0)
    assert len(none) == 0 and across[:, 2].tolist() == [BESIDE, -BESIDE]
    for start, end, before in ((begun[0], configs[0], configs[1]), (begun[1], configs[-1], configs[-2])):
        step, last = start - end, end - before
        assert abs(step[0]) * 10.0 + np.hypot(*step[1:3]) == pytest.approx(BESIDE, rel=1e-6)
        assert step[:3] @ last[:3] > 0.99 * np.linalg.norm(step[:3]) * np.linalg.norm(last[:3])
