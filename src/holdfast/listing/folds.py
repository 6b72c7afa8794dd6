r"""Nearly double solutions of the contact equations: how near to each other all solutions of a box are.

Where two solutions merge, the Jacobian J = U diag(sigma) V' has one small singular value, and Newton's method tells little.
But the equations are smooth, so along the worst determined direction they bend like a parabola. With F the contact
equations at z (squared distances, so that they are polynomials in the pegs' centres), g = U' F, and solutions at z + V s,

    sigma_k \|s_k\| <= \|g_k\| + e + h \|s\|^2 / 2                     for the three well determined directions,
    q s_4^2 / 2 + sigma_4 s_4 + g_4 + E = 0                        for the other,

where the values of F are computed in ball arithmetic, e bounds what rounding is left, h the second and T the third
derivatives, q = u_4 . F''[v_4, v_4] and \|E\| <= e + h (\|s_4\| r + r^2 / 2) + T \|s\|^3 / 6 with r the length of the first
three coordinates. So s_4 is within sqrt(sigma_4^2 - 2 q g_4 + 2 \|q E\|) / \|q\| of -sigma_4 / q: all solutions lie in a
ball about that point, the smaller the nearer they are to merging, and a rule that is broken everywhere in it discards them
all. (Taylor's theorem; the singular value decomposition as in G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed.,
2013, section 2.4.)
"""

from __future__ import annotations

import numpy as np
from attrs import define, evolve
from flint import arb, ctx
from numpy.typing import NDArray

from holdfast.listing.polish import Contacts, contacts_at, newton_step, peg_points
from holdfast.listing.settling import contact_value

__all__ = ["Fold", "exactly_polished", "fold"]

Array = NDArray[np.float64]
ROUNDS = 10
# Bits of the ball arithmetic, and the rounding of everything else in double precision.
PRECISION = 128
ROUNDING = 1e-14


@define(frozen=True, eq=False)
class Fold:
    """Where all solutions of N boxes are: within ``radius`` of the segment from ``low`` to ``high``.

    Parameters
    ----------
    low, high : the ends of the segments.
    radius : (N,) in mm, in the unknowns (L psi, tail x, tail y, apart); infinite where nothing is known.
    apart : (N,) whether the solutions are near the ends only, no more than one at each.
    near : (N,) how near in mm they then are.
    at_low, at_high : (N,) whether there may be one at that end, inside the box.
    """

    low: Contacts
    high: Contacts
    radius: Array
    apart: NDArray[np.bool_]
    near: Array
    at_low: NDArray[np.bool_]
    at_high: NDArray[np.bool_]


def squared_slopes(contacts: Contacts) -> Array:
    """Jacobian (N, 4, 4) of the squared contact equations: that of the signed distances, times the distance over R."""
    is_line = contacts.rows[..., 0] == 0.0
    away = np.where(is_line, 1.0, 1.0 + contacts.off / np.where(is_line, 1.0, contacts.rows[..., 6]))
    return np.asarray(contacts.jacobian * away[..., None])


def exact_values(contacts: Contacts, offsets: Array, slides: Array, which: NDArray[np.bool_]) -> Array:
    """Values (N, 4) of the squared contact equations where ``which``, computed in ball arithmetic and rounded once."""
    out = np.zeros((len(contacts.psi), 4))
    with ctx.workprec(PRECISION):
        for n in np.flatnonzero(which):
            unknowns = (contacts.psi[n], *contacts.tail[n], contacts.apart[n])
            values = contact_values(contacts.rows[n], offsets[n], slides[n], unknowns)
            out[n] = [float(value.mid()) for value in values]
    return out


def contact_values(rows: Array, offsets: Array, slides: Array, unknowns: tuple[float, ...]) -> list[arb]:
    """Values of the four squared contact equations at exact unknowns."""
    psi, x, y, apart = (arb(float(u)) for u in unknowns)
    sine, cosine = psi.sin_cos()
    out = []
    for row, (dx, dy), slide in zip(rows.tolist(), offsets.tolist(), slides.tolist(), strict=True):
        across, along = dx + slide * apart, arb(dy)
        center = x + cosine * across - sine * along, y + sine * across + cosine * along
        out.append(contact_value(row, center))
    return out


def bent(contacts: Contacts, offsets: Array, slides: Array, direction: Array, length: float) -> Array:
    """Second derivatives (N, 4) of the squared contact equations along directions (N, 4) of the unknowns."""
    _, quarter, along = peg_points(contacts.psi, contacts.tail, contacts.apart, offsets, slides)
    arm = np.stack([quarter[..., 1], -quarter[..., 0]], axis=-1)
    sideways = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    turn = (direction[:, 0] / length)[:, None, None]
    glide = direction[:, 3][:, None, None]
    speed = direction[:, None, 1:3] + quarter * turn + along * glide
    bend = -arm * turn**2 + 2.0 * sideways * turn * glide
    is_line = contacts.rows[..., 0] == 0.0
    normal = np.stack([contacts.rows[..., 4], -contacts.rows[..., 3]], axis=-1)
    ray = contacts.points - contacts.rows[..., 1:3]
    radius = np.where(is_line, 1.0, contacts.rows[..., 6])
    round_off = ((speed * speed).sum(axis=-1) + (ray * bend).sum(axis=-1)) / radius
    return np.asarray(np.where(is_line, (normal * bend).sum(axis=-1), round_off))


def derivative_bounds(rows: Array, length: float) -> tuple[Array, Array]:
    r"""Bounds (N,) of the second and third derivatives of combinations u . F of the squared equations along v, where
    \|u\| = \|v\| = 1.

    A peg's centre moves by at most sqrt 6 per unit of the unknowns (it is at most 2 L from the tail), and its second and
    third derivatives are at most 4 / L and 6 / L^2.
    """
    is_line = rows[..., 0] == 0.0
    curvature = np.where(is_line, 0.0, 1.0 / np.where(is_line, 1.0, rows[..., 6]))
    second, third = 6.0 * curvature + 4.0 / length, 30.0 * curvature / length + 6.0 / length**2
    return np.asarray(np.sqrt((second**2).sum(axis=1))), np.asarray(np.sqrt((third**2).sum(axis=1)))


def moved(contacts: Contacts, step: Array, offsets: Array, slides: Array, length: float) -> Contacts:
    """Contacts at unknowns moved by steps (N, 4) in mm."""
    psi, tail = contacts.psi + step[:, 0] / length, contacts.tail + step[:, 1:3]
    apart = contacts.apart + step[:, 3]
    return contacts_at(contacts.rows, psi, tail, apart, offsets, slides, length)


def exactly_polished(contacts: Contacts, offsets: Array, slides: Array, length: float) -> Contacts:
    """Contacts improved by Newton's method with exactly computed values, in the form of squared equations."""
    everywhere = np.ones(len(contacts.psi), np.bool_)
    for last in (False, False, True):
        values = exact_values(contacts, offsets, slides, everywhere)
        if last:
            return evolve(contacts, off=values, jacobian=squared_slopes(contacts))
        step = newton_step(squared_slopes(contacts), values)
        contacts = moved(contacts, -step, offsets, slides, length)
    return contacts


def fold(contacts: Contacts, reach: Array, offsets: Array, slides: Array, length: float) -> Fold:
    """Balls that hold all solutions of boxes about N contacts.

    Parameters
    ----------
    contacts : the middles of the boxes.
    reach : (N,) how far in mm the solutions may be from them.
    offsets, slides : the pegs' places, as for ``polish``.
    length : L in mm.
    """
    second, third = derivative_bounds(contacts.rows, length)
    ball, active = np.array(reach), np.ones(len(reach), np.bool_)
    shape: Parabola | None = None
    with np.errstate(all="ignore"):
        for _ in range(ROUNDS):
            values = exact_values(contacts, offsets, slides, active)
            now = parabola(contacts, values, ball, offsets, slides, length, second, third)
            shape = now if shape is None else shape.updated(now, active)
            # While the vertex is near and the ball gets smaller, look again from there.
            smaller = 1.01 * (now.reached + now.lane)
            active = active & (np.abs(now.center) <= 2.0 * ball) & (smaller < 0.7 * ball)
            if not active.any():
                break
            step = np.where(active[:, None], now.to_vertex, 0.0)
            contacts = moved(contacts, step, offsets, slides, length)
            ball = np.where(active, smaller, ball)
        assert shape is not None
        known = np.isfinite(shape.center) & np.isfinite(shape.reached) & np.isfinite(shape.lane)
        # The last shape is that seen from the last middle.
        vertex = np.where(known[:, None], shape.to_vertex, 0.0)
        span = np.where(known, shape.reached, 0.0)[:, None] * shape.axis
        low = moved(contacts, vertex - span, offsets, slides, length)
        high = moved(contacts, vertex + span, offsets, slides, length)
        near = 1.01 * (shape.reached - shape.inner + shape.lane)
        far = shape.lane + shape.off
        at_low = ~known | (shape.most >= 0.0) & (np.abs(shape.center - shape.reached) <= ball + near + far)
        at_high = ~known | (shape.most >= 0.0) & (np.abs(shape.center + shape.reached) <= ball + near + far)
        apart = known & (shape.inner > 0.0)
        return Fold(low, high, np.where(known, 1.01 * shape.lane, np.inf), apart, near, at_low, at_high)


@define(frozen=True, eq=False)
class Parabola:
    """The fold lemma at N points: coordinates along the worst determined direction, in mm.

    Parameters
    ----------
    axis : (N, 4) that direction.
    center : (N,) the vertex.
    to_vertex : (N, 4) the step to the vertex, with a Newton step in the other directions, ``off`` long.
    reached, inner : (N,) solutions are no farther from the vertex, and (where positive) no nearer.
    lane : (N,) how far to the side they may be.
    most : (N,) negative where there are none.
    """

    axis: Array
    center: Array
    to_vertex: Array
    off: Array
    reached: Array
    inner: Array
    lane: Array
    most: Array

    def updated(self, now: Parabola, which: NDArray[np.bool_]) -> Parabola:
        """This one, replaced where ``which``."""
        pairs = {a.name: (getattr(self, a.name), getattr(now, a.name)) for a in self.__attrs_attrs__}
        return Parabola(
            **{n: np.where(which[:, None] if old.ndim == 2 else which, new, old) for n, (old, new) in pairs.items()}
        )


def parabola(
    contacts: Contacts,
    values: Array,
    ball: Array,
    offsets: Array,
    slides: Array,
    length: float,
    second: Array,
    third: Array,
) -> Parabola:
    """The fold lemma for solutions within ``ball`` (N,) mm of contacts."""
    slopes = squared_slopes(contacts)
    left, sigma, right = np.linalg.svd(np.where(np.isfinite(slopes), slopes, 0.0))
    g = np.einsum("nij,ni->nj", left, values)
    newton = -g[:, :3] / sigma[:, :3]
    off = np.sqrt((newton**2).sum(axis=1))
    # Rounding of the Jacobian's directions, and of the values.
    doubt = ROUNDING * (ball + np.abs(values).sum(axis=1))
    good = (doubt + second * ball**2 / 2.0)[:, None] / sigma[:, :3]
    lane = np.sqrt((good**2).sum(axis=1))
    q = (left[:, :, 3] * bent(contacts, offsets, slides, right[:, 3], length)).sum(axis=1)
    side = np.minimum(lane + off, ball)
    rest = doubt + second * (ball * side + side**2 / 2.0) + third * ball**3 / 6.0 + ROUNDING * second * ball**2
    square = sigma[:, 3] ** 2 - 2.0 * q * g[:, 3]
    most, least = square + 2.0 * np.abs(q) * rest, square - 2.0 * np.abs(q) * rest
    center = -sigma[:, 3] / q
    to_vertex = np.einsum("nkj,nk->nj", right, np.concatenate([newton, center[:, None]], axis=1))
    reached, inner = np.sqrt(np.maximum(most, 0.0)) / np.abs(q), np.sqrt(np.maximum(least, 0.0)) / np.abs(q)
    return Parabola(right[:, 3], center, to_vertex, off, reached, inner, lane, most)
