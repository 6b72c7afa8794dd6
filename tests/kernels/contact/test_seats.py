"""Bounds of the pairs of clamps at a seat: no pair whose forces are off by no more than is said exceeds them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from workhold.kernels.contact.clamp_pairs import CLAMP_LENGTH, PUSH, write_closures
from workhold.kernels.contact.seats import (
    AMPLIFICATION,
    BOUND_LENGTH,
    FACE,
    FORCE_LENGTH,
    FREEDOM,
    MARGIN,
    OFF,
    write_pair_bounds,
)
from workhold.model.clamps import compute_working_forces

Array = NDArray[np.float64]

# Of one direction and another.
ASKED = np.zeros((4, 4), np.int64)
ASKED[0, 2] = 1


def bounds(forces: Array, directions: list[int], wants_margin: bool = True) -> Array:
    """What bounds the pairs of one seat (3,)."""
    out, starts = np.empty((1, BOUND_LENGTH)), np.array([0, len(forces)])
    write_pair_bounds(starts, np.array(directions), forces, ASKED, wants_margin, out, np.empty((2, 3)))
    return out[0]


def random_forces(random: np.random.Generator, off: float) -> Array:
    """Forces (2, 5) of a clamp of either direction, with entries that are zero, and zero of both."""
    out = np.empty((2, FORCE_LENGTH))
    out[:, :3] = random.normal(size=(2, 3)) * random.choice([0.0, 0.3, 1.0, 5.0], size=(2, 3))
    out[:, FACE] = random.choice([1.0, 1.1, 3.0], size=2)
    out[:, OFF] = off
    return out


def figures(forces: Array) -> tuple[float, float, float] | None:
    """Clamp freedom, closure margin and clamp amplification of a pair of forces (2, 4); None where they do not close."""
    clamps, out = np.zeros((1, 2, CLAMP_LENGTH)), np.empty((1, 2))
    clamps[0, :, :3], clamps[0, :, PUSH] = forces[:, :3] / forces[:, FACE, None], 1.0 / forces[:, FACE]
    write_closures(clamps, out)
    margin, freedom = out[0].tolist()
    if margin <= 0.0 or freedom <= 0.0:
        return None
    reactions = np.zeros((1, 5, 2))
    reactions[0, :3], reactions[0, 3, 0], reactions[0, 4, 1] = forces[:, :3].T, *forces[:, FACE]
    return freedom, margin, float(compute_working_forces(reactions).max())


@pytest.mark.thorough
@pytest.mark.parametrize("off", [1e-6, 1e-3, 0.1])
def test_no_pair_exceeds_the_bounds(off: float) -> None:
    """Of forces as they are, and moved by as much as they may be off."""
    random, closing = np.random.default_rng(7), 0
    for _ in range(2000):
        said = random_forces(random, off)
        freedom, margin, amplification = bounds(said, [0, 2])
        for size in (0.0, 0.5, 1.0):
            moved = said[:, :4].copy()
            moved[:, :3] += size * off * random.choice([-1.0, 1.0], size=(2, 3))
            found = figures(moved)
            if found is not None:
                closing += 1
                assert found[0] <= freedom + 1e-9
                assert found[1] <= margin + 1e-12
                assert found[2] >= amplification - 1e-12
    assert closing > 500


def test_bounds_of_forces_that_are_known_are_figures() -> None:
    """Where next to nothing is off, they are those of the one pair that there is."""
    random, closing = np.random.default_rng(8), 0
    for _ in range(500):
        said = random_forces(random, 1e-12)
        said[:, :3] += 0.2
        found = figures(said[:, :4])
        if found is not None and found[0] > 1.0:
            closing += 1
            freedom, margin, amplification = bounds(said, [0, 2])
            assert (freedom, margin) == pytest.approx(found[:2], abs=1e-6)
            assert amplification == pytest.approx(found[2], abs=1e-6)
    assert closing > 100


def test_the_best_of_pairs_counts_and_directions_that_nobody_asks_for_do_not() -> None:
    free = np.array([[1.0, 0.0, 0.0, 1.0, 1e-9], [0.0, 0.5, 0.5, 1.0, 1e-9]])
    tight = np.array([[1.0, -0.5, 0.1, 1.0, 1e-9]])
    assert bounds(free, [0, 2])[FREEDOM] == pytest.approx(90.0)
    # A clamp of a second direction comes before the first, and another one closes less well.
    assert bounds(np.concatenate([free[1:], free[:1], tight]), [2, 0, 0])[FREEDOM] == pytest.approx(90.0)
    assert bounds(np.concatenate([tight, free[1:]]), [0, 2])[FREEDOM] == pytest.approx(45.0, abs=1e-6)
    for directions in ([0, 0], [0, 1], [1, 3]):
        assert bounds(free, directions).tolist() == [-np.inf, -np.inf, np.inf]


def test_unknown_forces_bound_nothing_and_margins_only_where_they_are_wanted() -> None:
    said = np.array([[1.0, 0.0, 0.0, 1.0, np.inf], [0.0, 0.5, 0.5, 1.0, 1e-9]])
    out = bounds(said, [0, 2])
    assert (out[FREEDOM], out[MARGIN], out[AMPLIFICATION]) == (90.0, 0.2, 0.0)
    said[:, OFF] = 1e-9
    assert bounds(said, [0, 2], wants_margin=False)[MARGIN] == 0.2
    assert bounds(said, [0, 2])[MARGIN] < 0.2 + 1e-8
