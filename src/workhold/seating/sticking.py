"""Below which friction a part cannot stick near its seat: where three of the four contacts balance the jaw inside their
cones.

Contact i presses with h (-n + s mu t), |s| <= 1. Three forces balance where the determinant of their wrenches is zero; with
three unknown ratios, one of them up to scale, the least largest ratio has all three equal, or one of the contacts without
force (V.-D. Nguyen, International Journal of Robotics Research 7, 1988). A determinant of signs is a cubic in mu. Where less
friction does, the jaw's share of the forces vanishes at the least: the three lock whatever its force. Halving finds that.
"""

from __future__ import annotations

from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

__all__ = ["sticking_friction"]

Array = NDArray[np.float64]
TRIPLES = np.array(list(combinations(range(4), 3)))
SIGNS = np.array(list(product((1.0, -1.0), repeat=3)))
# Points at which a cubic is told by its values, and back.
AT = np.array([0.0, 1.0, -1.0, 2.0])
TO_CUBIC = np.linalg.inv(np.vander(AT, 4))
# Sets of four of the six edges of three cones.
FOURS = np.array(list(combinations(range(6), 4)))
# No unit. A share by which less friction is less, how often it is halved, and determinants that are none.
LESS, HALVINGS, SINGULAR = 1e-7, 60, 1e-14


def sticking_friction(points: Array, normals: Array, right: Array) -> float:
    """The least coefficient of friction at which three of four contacts (two included) balance the jaw, or infinity.

    Parameters
    ----------
    points : (4, 2) contact points in mm, in the vise frame.
    normals : (4, 2) outward unit normals there.
    right : (4,) 1 for contacts of the right jaw's pegs, 0 for others.
    """
    tangents = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    size = max(float(np.ptp(points, axis=0).max()), 1e-9)
    points = (points - points.mean(axis=0)) / size

    def wrench(forces: Array, at: Array) -> Array:
        return np.concatenate([forces, (at[..., 0] * forces[..., 1] - at[..., 1] * forces[..., 0])[..., None]], axis=-1)

    straight, across = wrench(-normals, points), wrench(tangents, points)
    least = np.inf
    one = straight[TRIPLES][:, None, None]
    two = SIGNS[None, :, None, :, None] * across[TRIPLES][:, None, None]
    values = np.linalg.det(one + AT[None, None, :, None, None] * two)
    cubics = values @ TO_CUBIC.T
    pairs = [(triple, signs) for triple in TRIPLES for signs in SIGNS]
    for (triple, signs), roots in zip(pairs, real_roots(cubics.reshape(-1, 4)), strict=True):
        for root in roots:
            if not 0.0 <= root < least:
                continue
            w = straight[triple] + root * signs[:, None] * across[triple]
            if presses(w, right[triple]):
                least = root
    for i, j in combinations(range(4), 2):
        if right[i] == right[j]:
            continue
        line = points[j] - points[i]
        span = np.hypot(*line)
        if span < 1e-12:
            continue
        ratios = []
        for k, toward in ((i, line / span), (j, -line / span)):
            along = float(-normals[k] @ toward)
            if along <= 1e-12:
                break
            ratios.append(abs(float(tangents[k] @ toward)) / along)
        # The force of the right peg on the part points to the left.
        moving = line / span if right[i] == 1 else -line / span
        if len(ratios) == 2 and moving[0] < -1e-12:
            least = min(least, max(ratios))
    low, high = 0.0, float(least)
    if high == np.inf or not balance(straight, across, right, high * (1.0 - LESS)):
        return high
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        low, high = (low, middle) if balance(straight, across, right, middle) else (middle, high)
    return high


def balance(straight: Array, across: Array, right: Array, friction: float) -> bool:
    """Whether three of four contacts balance the jaw inside cones of a friction: some four of their six edges do, then.

    Parameters
    ----------
    straight, across : (4, 3) wrenches along the normals into the part, and along the tangents.
    """
    edges = np.concatenate(
        [straight[TRIPLES] + friction * across[TRIPLES], straight[TRIPLES] - friction * across[TRIPLES]], 1
    )
    on_jaw = edges[..., 0] * np.tile(right[TRIPLES], 2)
    matrices = np.swapaxes(np.concatenate([edges, on_jaw[..., None]], axis=2)[:, FOURS], 2, 3).reshape(-1, 4, 4)
    matrices = matrices[np.abs(np.linalg.det(matrices)) > SINGULAR]
    forces = np.linalg.solve(matrices, np.array([0.0, 0.0, 0.0, -1.0])[:, None])[..., 0]
    return bool((forces >= 0.0).all(axis=1).any())


def real_roots(cubics: Array) -> list[list[float]]:
    """The real roots of polynomials (N, 4), highest power first, which may begin with zeros."""
    scale = np.abs(cubics).max(axis=1)
    told = np.where(np.abs(cubics) < 1e-13 * scale[:, None], 0.0, cubics)
    # Of those that begin and end with numbers all at once, as ``np.roots`` has them one by one.
    whole = (told[:, 0] != 0.0) & (told[:, 3] != 0.0)
    companions = np.zeros((int(whole.sum()), 3, 3))
    companions[:, [1, 2], [0, 1]] = 1.0
    companions[:, 0] = -told[whole, 1:] / told[whole, :1]
    every = iter(np.linalg.eigvals(companions))
    out = []
    for cubic, size, at_once in zip(told, scale.tolist(), whole.tolist(), strict=True):
        roots = next(every) if at_once else np.roots(cubic)
        real = np.abs(roots.imag) < 1e-7 * (1.0 + np.abs(roots))
        out.append([] if size < 1e-14 else roots.real[real].tolist())
    return out


def presses(wrenches: Array, right: Array) -> bool:
    """Whether three dependent wrenches (3, 3) balance with forces of one sign that close the right jaw."""
    crosses = np.cross(wrenches.T[[0, 1, 0]], wrenches.T[[1, 2, 2]])
    null = crosses[np.abs(crosses).max(axis=1).argmax()]
    size = np.abs(null).max()
    if size < 1e-12:
        return False
    null = null / size
    if (null < 0.0).sum() > (null > 0.0).sum():
        null = -null
    return bool((null >= -1e-9).all() and (null * wrenches[:, 0] * right).sum() < -1e-9)
