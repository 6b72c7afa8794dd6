"""The friction below which a part cannot stick near its seat, in a vise, under one clamp or under two.

In a vise, and under one clamp, that is where three of the four contacts balance the jaw inside their cones.
Contact i presses with h (-n + s mu t), |s| <= 1. Three forces balance where the determinant of their wrenches
is zero. Of three unknown ratios the least largest has all three equal, or one of the contacts without force.
A determinant of signs is a cubic in mu. Where less friction does, the jaw's share of the forces vanishes at
the least: the three lock whatever its force. Halving finds that. Reference: V.-D. Nguyen, "Constructing
force-closure grasps", International Journal of Robotics Research 7 (1988).

Of two clamps the forces are given, in a ratio. Near the pose both tips touch, and a part that is not in it is
off some locator. So what is sought is the least mu at which contacts without one of the three locators
balance the clamps inside their cones. As cones grow with mu, halving finds it. Contacts of poses that come
ever nearer to the fixture's end in its contacts, and forces of sum 1 have a limit. So below that mu there is
nothing to stick in near the pose.
"""

from __future__ import annotations

from itertools import combinations
from math import inf

import numpy as np
from numpy.typing import NDArray

from workhold.fixels.toolkit import Toolkit
from workhold.kernels.seating.sticking import least_friction
from workhold.limits import MOST_FRICTION
from workhold.model.fixture import Fixture
from workhold.model.workpiece import Workpiece
from workhold.statics.contact_matrix import LOCATORS, Touched
from workhold.statics.friction import cone_edges, contacts_on_part

__all__ = ["sticking_friction", "sticking_friction_of_two"]

Array = NDArray[np.float64]
# mm. Contacts are counted in parts of how far they are apart, but of this at least.
SMALLEST = 1e-9
# By how much forces of sum 1 may miss their balance, or be below 0, for rounding.
BALANCED = 1e-10
# A coefficient of friction is known to this part of it.
PRECISION = 1e-9


def sticking_friction(points: Array, normals: Array, right: Array) -> float:
    """The least friction at which three of four contacts, or two, balance the jaw; infinite if there is none.

    Parameters
    ----------
    points : (4, 2) contact points in mm, in the vise frame.
    normals : (4, 2) outward unit normals there.
    right : (4,) 1 for contacts of the right jaw's pegs, 0 for others.
    """
    size = max(float((points.max(axis=0) - points.min(axis=0)).max()), SMALLEST)
    contacts = (
        (points - points.sum(axis=0) / len(points)) / size,
        np.ascontiguousarray(normals),
        np.asarray(right, dtype=np.int64),
    )
    return float(least_friction(*contacts, np.empty((4, 3)), np.empty((4, 3)), np.empty((4, 4)), np.empty((4, 4))))


def sticking_friction_of_two(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit) -> float:
    """The least friction at which two clamps, in their working ratio, balance without one of the locators.

    It is infinite where they balance at none up to ``MOST_FRICTION``.
    """
    assert fixture.pair is not None
    ratio = fixture.pair.working_ratio
    touched = Touched.of(workpiece, toolkit)
    contacts = contacts_on_part(fixture, workpiece, toolkit, touched, touched.of_fixture(fixture, toolkit))
    low, high = 0.0, MOST_FRICTION

    def sticks(friction: float) -> bool:
        edges, share = cone_edges(*contacts, friction, touched.length)
        return balances_without_a_locator(edges, share, ratio)

    if not sticks(high):
        return inf
    while high - low > PRECISION * high:
        middle = (low + high) / 2
        low, high = (low, middle) if sticks(middle) else (middle, high)
    return high


def balances_without_a_locator(edges: Array, share: Array, ratio: float) -> bool:
    """Whether forces balance two clamps that push in a ratio, without one of three locators.

    If there is a solution that is not negative, one has no more entries above zero than there are equations
    (V. Chvatal, *Linear Programming*, 1983, chapter 3). So all choices of so many entries are tried.

    Parameters
    ----------
    edges, share : of five pegs, the clamps last: see ``statics.friction.cone_edges``.
    ratio : the second clamp's force over the first's.
    """
    count = len(edges) // 2
    clamps = [np.isin(np.arange(2 * count) % count, [k]) * share for k in (LOCATORS, LOCATORS + 1)]
    # Balance, what the clamps push with in parts of an unknown force, and the sum of all.
    rows = np.vstack([edges.T, *clamps, np.ones(2 * count)])
    force = np.array([0.0, 0.0, 0.0, -1.0, -ratio, 0.0]) / (1.0 + ratio)
    wanted = np.eye(len(rows))[-1]
    for left_out in range(LOCATORS):
        columns = np.column_stack([rows[:, np.arange(2 * count) % count != left_out], force])
        chosen = columns[:, list(combinations(range(columns.shape[1]), len(rows)))].transpose(1, 0, 2)
        chosen = chosen[np.linalg.det(chosen) != 0.0]
        forces = np.linalg.solve(chosen, np.broadcast_to(wanted, (len(chosen), len(rows)))[..., None])
        missed = np.abs(chosen @ forces - wanted[:, None]).max(axis=(1, 2))
        if ((forces.min(axis=(1, 2)) > -BALANCED) & (missed < BALANCED)).any():
            return True
    return False
