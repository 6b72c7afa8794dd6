"""Newton's method on the four contact equations, to the last digits."""

from __future__ import annotations

import numpy as np
from attrs import define
from numpy.typing import NDArray

__all__ = ["Contacts", "contacts_at", "newton_step", "peg_points", "polish"]

Array = NDArray[np.float64]
ROUNDS = 3
# Determinants this small are singular; steps of more than this many mm lead to another contact.
SINGULAR = 1e-300
FARTHEST = 1.0


@define(frozen=True, eq=False)
class Contacts:
    """N sets of four pegs in the workpiece's frame.

    Parameters
    ----------
    rows : (N, 4, 8) rows of the features touched.
    psi : (N,) orientation of the pegs in radians.
    tail : (N, 2) centre of the first peg in mm.
    apart : (N,) x distance from the first left to the first right peg in mm.
    points : (N, 4, 2) peg centres in mm.
    off : (N, 4) signed distances in mm of the pegs' centres from their features' lines and circles.
    jacobian : (N, 4, 4) of those distances over (L psi, tail x, tail y, apart).
    """

    rows: Array
    psi: Array
    tail: Array
    apart: Array
    points: Array
    off: Array
    jacobian: Array


def peg_points(psi: Array, tail: Array, apart: Array, offsets: Array, slides: Array) -> tuple[Array, Array, Array]:
    """Peg centres and their derivatives over psi and over the sliding of the right jaw, each (N, 4, 2)."""
    reach = offsets.copy()
    reach[..., 0] += slides * apart[:, None]
    c, s = np.cos(psi)[:, None], np.sin(psi)[:, None]
    turned = np.stack([c * reach[..., 0] - s * reach[..., 1], s * reach[..., 0] + c * reach[..., 1]], axis=-1)
    by_psi = np.stack([-turned[..., 1], turned[..., 0]], axis=-1)
    by_apart = np.stack([c * slides, s * slides], axis=-1)
    return tail[:, None, :] + turned, by_psi, by_apart


def distances(rows: Array, points: Array) -> tuple[Array, Array]:
    """Signed distances (N, 4) of points from the features' lines or circles, and their gradients (N, 4, 2)."""
    delta = points - rows[..., 1:3]
    straight = np.stack([rows[..., 4], -rows[..., 3]], axis=-1)
    size = np.hypot(delta[..., 0], delta[..., 1])
    is_line = rows[..., 0] == 0.0
    gradient = np.where(is_line[..., None], straight, delta / np.where(size == 0.0, 1.0, size)[..., None])
    return np.where(is_line, (delta * straight).sum(axis=-1), size - rows[..., 6]), gradient


def contact_equations(
    rows: Array, psi: Array, tail: Array, apart: Array, offsets: Array, slides: Array, length: float
) -> tuple[Array, Array, Array]:
    """Peg centres (N, 4, 2), their distances off their features (N, 4), and the Jacobian (N, 4, 4) of those over
    (length psi, tail x, tail y, apart)."""
    points, by_psi, by_apart = peg_points(psi, tail, apart, offsets, slides)
    off, gradient = distances(rows, points)
    columns = [(gradient * by_psi).sum(axis=-1) / length, gradient[..., 0], gradient[..., 1]]
    return points, off, np.stack([*columns, (gradient * by_apart).sum(axis=-1)], axis=-1)


def polish(
    rows: Array, psi: Array, tail: Array, apart: Array, offsets: Array, slides: Array, length: float
) -> Contacts:
    """Solve the contact equations of N fixtures in (psi, tail, apart) from close starting values.

    Parameters
    ----------
    rows : (N, 4, 8) rows of the features touched.
    psi, tail, apart : starting values, see :class:`Contacts`.
    offsets : (N, 4, 2) peg positions in the vise frame from the first peg, with the right jaw at zero, in mm.
    slides : (N, 4) 1 for pegs that move with the right jaw, 0 for the others.
    length : L of the wrenches in mm, which brings the angle to the scale of the lengths.
    """
    for _ in range(ROUNDS):
        _, off, jacobian = contact_equations(rows, psi, tail, apart, offsets, slides, length)
        step = newton_step(jacobian, off)
        psi, tail, apart = psi - step[:, 0] / length, tail - step[:, 1:3], apart - step[:, 3]
    return contacts_at(rows, psi, tail, apart, offsets, slides, length)


def contacts_at(
    rows: Array, psi: Array, tail: Array, apart: Array, offsets: Array, slides: Array, length: float
) -> Contacts:
    """Four pegs in place; parameters as for :func:`polish`."""
    points, off, jacobian = contact_equations(rows, psi, tail, apart, offsets, slides, length)
    return Contacts(rows, psi, tail, apart, points, off, jacobian)


def newton_step(jacobian: Array, off: Array) -> Array:
    """Solutions (N, 4) of the linearized equations; 0 where they are singular or would lead far away."""
    with np.errstate(all="ignore"):
        usable = np.abs(np.linalg.det(jacobian)) > SINGULAR
    step = np.linalg.solve(np.where(usable[:, None, None], jacobian, np.eye(4)), off[..., None])[..., 0]
    near = np.abs(step).max(axis=1, initial=0.0) <= FARTHEST
    return np.asarray(np.where((usable & near)[:, None], step, 0.0))
