"""Ways down that fall off a flat face and end just below it."""

from __future__ import annotations

import numpy as np

from workhold.kernels.seating.closing import AT_REST
from workhold.kernels.seating.columns import CANDIDATE_LENGTH
from workhold.seating.families import Family
from workhold.seating.tree import Builder


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
