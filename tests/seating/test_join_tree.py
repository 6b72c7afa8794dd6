"""What leads down off loose sets, and which passes join which places."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from loose_sets import NOWHERE, laid_out, straight
from workhold.kernels.seating.closing import AT_REST, AT_THE_STOP
from workhold.kernels.seating.columns import CANDIDATE_LENGTH, SEPARATION
from workhold.kernels.seating.descent_paths import BESIDE, OUTSIDE, STOP
from workhold.seating.join_tree import JoinTree, ManifoldDescents, measure_distances


class Slope:
    """Jaws that close by a millimetre to the right of x = 0 and by two of them to the left of x = -100, to a stop."""

    size = 10.0

    def close_from(
        self, configs: np.ndarray, first: float, seats: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        x = configs[:, 1]
        fall = np.where(x > 0.0, 1.0, np.where(x < -100.0, 2.0, 1e-7))
        return configs - fall[:, None] * [0.0, 0.0, 0.0, 1.0], np.where(
            x < -100.0, AT_THE_STOP, AT_REST
        ).astype(np.int8)


def test_what_leads_down_off_loose_sets():
    """On none, one or both sides; a part on three pegs lies there a while, unless it gives way in the middle."""
    still, one, both = (
        straight(7.0, 4.0, 5, (-9.0, 0.0)),
        straight(8.0, 4.0),
        straight(9.0, 200.0, 5, (-150.0, 0.0)),
    )
    gives = straight(6.0, 0.0, 5, (30.0, 0.0))
    families = laid_out(
        [still, one, both, gives, one], [3.0, 3.0, 2.0, 3.0, 2.0], None, [NOWHERE] * 3 + [(1.0, 0.0), NOWHERE]
    )
    off = ManifoldDescents.from_manifolds(families, Slope(), np.zeros((0, 4)))
    assert off.lying.tolist() == [0] and off.falling.tolist() == [1, 2, 3, 4]
    assert off.slack.tolist() == [1] and off.dividing.tolist() == [2, 3]
    starts, ends, how = off.both
    across = [30.0 + BESIDE, 30.0 - BESIDE]
    assert starts[:, 1] == pytest.approx([-150.0 - BESIDE, 50.0 + BESIDE, *across], abs=1e-12)
    assert ends[:, 3].tolist() == [7.0, 8.0, 5.0, 5.0] and how.tolist() == [AT_THE_STOP, *[AT_REST] * 3]
    starts, ends, how = off.one
    assert starts[:, 1] == pytest.approx([4.0 + BESIDE, -150.0 - BESIDE, across[0], 4.0 + BESIDE], abs=1e-12)
    assert ends[:, 3].tolist() == [7.0, 7.0, 5.0, 7.0] and how.tolist() == [
        AT_REST,
        AT_THE_STOP,
        AT_REST,
        AT_REST,
    ]
    none = ManifoldDescents.from_manifolds(laid_out([]), Slope(), np.zeros((0, 4)))
    assert [len(part) for part in (none.lying, none.falling, none.slack, none.dividing)] == [0] * 4


def test_the_first_pass_that_leads_elsewhere_is_the_one_at_which_a_cage_opens():
    """Of two seats, a loose set with a third on it, and something not settled."""
    seats, loose = np.zeros((3, CANDIDATE_LENGTH)), np.zeros((1, CANDIDATE_LENGTH))
    passes, joined = np.zeros((5, CANDIDATE_LENGTH)), np.array([[0, 0], [0, 4], [3, 3], [4, 3], [3, OUTSIDE]])
    passes[:, SEPARATION] = [1.0, 2.0, 3.0, 4.0, 5.0]
    own = np.array([0, 1, 3, 3])
    tree = JoinTree(seats, loose, loose[:0], np.zeros((1, 4)), passes, joined, own)
    assert tree.first_joins.tolist() == [1, -1, -1, 3, 1, -1, 4]
    joins = [tree.find_first_join(place) for place in range(4)]
    assert [join and join.separation for join in joins] == [2.0, None, 4.0, 4.0]
    assert (
        joins[0].places == (0, 4)
        and joins[0].candidate is not None
        and joins[2] == joins[3] == tree.make_join(3)
    )
    assert [tree.find_escape_separation(place) for place in range(4)] == [5.0, None, 5.0, 5.0]
    stopped = JoinTree(seats, loose, loose[:0], np.zeros((1, 4)), passes[:1], np.array([[1, STOP]]), own)
    assert stopped.find_first_join(1) == stopped.make_join(0) and stopped.find_escape_separation(1) is None


def test_turns_count_by_the_shorter_way():
    apart = measure_distances(
        np.array([[pi - 0.1, 3.0, 4.0, 9.0]]), np.array([0.1 - pi, 0.0, 0.0, 1.0]), 10.0
    )
    assert apart == pytest.approx([2.0 + 5.0])
