"""Discs that hold the tails of a chord when its orientation is known to a radius only, tangencies included.

Let w be known to e = d reach + eta. Between a line and an arc of radius R, the head's distance from the line's direction
through the arc's centre, ``across``, is known to e; its square from R^2 to q = e (2 R + e); the root of that, ``half``, to
min(sqrt q, q / half). Between two arcs, g = |c - w| is known to e, and with D = R_a^2 - R_b^2

    along = (g + D / g) / 2   to  t = e / 2 (1 + |D| / (g (g - e))),
    half = sqrt(R_a^2 - along^2)  to  min(sqrt q, q / half),  q = t (2 R_a + t),
    the direction of c - w  to  1.6 e / g.

Near a coincidence the tail moves at no more than d + R + 3.2 sqrt(d R) < 2.6 (d + R) (see ``chord.coincidences``: there
d sin(gamma / 2) <= 0.7 R between arcs, d (1 - cos gamma) <= R between a line and an arc).
"""

from __future__ import annotations

from math import cos, hypot, inf, isfinite, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import EXACT
from workhold.kernels.base.compiling import inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, X, Y
from workhold.kernels.base.interval import TURN
from workhold.kernels.base.shallow import is_shallow
from workhold.kernels.chord.coincidences import CONCENTRIC, NONE, from_coincidence, is_regular
from workhold.kernels.chord.evaluation import HEIGHT, State, chord_state, parameter_on, regular_error
from workhold.kernels.chord.shallow import shallow_half
from workhold.kernels.curves.columns import BACKWARD_ERROR, COINCIDENCE, KAPPA, LENGTH, MIDDLE, SHIFT

Array = NDArray[np.float64]


@inner
def tail_radius(curve: Array, state: State, reach: float) -> float:
    """How far in mm the exact tail may be from a computed one when the orientation may be ``reach`` radians off.

    The tail moves at a speed of at most d / |X|, and X^2 changes at a rate of at most 4 d kappa, here by no more than a
    quarter of itself: so the speed stays below 1.16 d / |X|, and the theorem of ``chord.evaluation`` holds with h <= 1 / 3,
    by which the tail is off by no more than 3 eta / |X|. Infinite where this does not bound it, too near a tangency.
    """
    eta, d = curve[BACKWARD_ERROR], curve[LENGTH]
    kappa = curve[KAPPA]
    turn = abs(state[2] * state[5] - state[3] * state[4])
    square = turn * turn
    if square < 16.0 * kappa * eta or square < 16.0 * d * kappa * reach or turn == 0.0:
        return inf
    return 5.0 * eta / turn + 1.3 * d / turn * reach


@inner
def root_error(square: float, doubt: float) -> float:
    """Error of a root of a number that may be ``doubt`` off (negative ones count as 0)."""
    if square <= 0.0:
        return sqrt(doubt)
    return min(sqrt(doubt), doubt / sqrt(square))


@inner
def arcs_radius(a: Array, b: Array, state: State, e: float, eta: float) -> float:
    """How far in mm a tail on an arc may be from a computed one when the chord, to another arc, is known to ``e``."""
    gap = hypot(a[RADIUS] * state[2] - b[RADIUS] * state[4], a[RADIUS] * state[3] - b[RADIUS] * state[5])
    if gap <= 2.0 * e:
        return 2.2 * a[RADIUS]
    difference = abs(a[RADIUS] - b[RADIUS]) * (a[RADIUS] + b[RADIUS])
    shift = e / 2.0 * (1.0 + difference / (gap * (gap - e)))
    along = (gap + (a[RADIUS] - b[RADIUS]) * (a[RADIUS] + b[RADIUS]) / gap) / 2.0
    square = (a[RADIUS] - along) * (a[RADIUS] + along)
    if is_shallow(a) or is_shallow(b):
        square = shallow_half(a, b, state[2] * state[5] - state[3] * state[4], gap) ** 2
    return shift + eta + 1.01 * root_error(square, shift * (2.0 * a[RADIUS] + shift)) + 1.6 * a[RADIUS] * e / gap


@inner
def disc_radius(a: Array, b: Array, curve: Array, state: State, psi: float, reach: float) -> float:
    """How far in mm tails of a curve within ``reach`` of an orientation may be from the computed one there."""
    d, eta, kind = curve[LENGTH], curve[BACKWARD_ERROR], curve[COINCIDENCE]
    if kind == CONCENTRIC:
        # The chord turns about the centre as it is; nearly along a diameter its place is known less well than its length.
        return a[RADIUS] * reach + arcs_radius(a, b, state, eta, eta)
    radius = a[RADIUS] if a[IS_ARC] != 0.0 else b[RADIUS]
    gamma = from_coincidence(psi + curve[SHIFT], curve[MIDDLE])
    if is_regular(kind, radius, d, gamma - reach) and is_regular(kind, radius, d, gamma + reach):
        return regular_error(curve) + 2.6 * (d + radius) * reach
    e = d * reach + eta
    if is_regular(kind, radius, d, gamma):
        # The computed chord is that of a part with exactly the lengths of the coincidence, others within reach are not.
        e += EXACT
        eta += regular_error(curve)
    if a[IS_ARC] == 0.0 and b[IS_ARC] == 0.0:
        return 1.1 * e / abs(state[2] * state[5] - state[3] * state[4])
    if a[IS_ARC] == 0.0:
        half = b[RADIUS] * (a[AXIS_X] * state[4] + a[AXIS_Y] * state[5])
        return 2.0 * e + eta + 1.01 * root_error(half * half, e * (2.0 * b[RADIUS] + e))
    if b[IS_ARC] == 0.0:
        half = a[RADIUS] * (b[AXIS_X] * state[2] + b[AXIS_Y] * state[3])
        return 2.0 * e + eta + 1.01 * root_error(half * half, e * (2.0 * a[RADIUS] + e))
    if is_shallow(a) and a[RADIUS] > b[RADIUS]:
        # Seen from the smaller circle, the contact on the larger one is known better.
        seen = (0.0, 0.0, state[4], state[5], state[2], state[3], 0.0, 0.0, 0.0, 0.0)
        return e + arcs_radius(b, a, seen, e, eta)
    return arcs_radius(a, b, state, e, eta)


@inner
def tail_disc(a: Array, b: Array, curve: Array, psi: float, reach: float) -> tuple[float, float, float]:
    """A disc (x, y, radius in mm) that holds the tails of a curve for all orientations within ``reach`` of psi."""
    state = chord_state(a, b, curve, psi, cos(psi), sin(psi))
    return (state[0], state[1], disc_radius(a, b, curve, state, psi, reach + 1e-15))


@inner
def chord_tail(a: Array, b: Array, curve: Array, psi: float, reach: float) -> tuple[float, float, float]:
    """The tail of a chord, and how far in mm the exact one may be from it when psi is off by up to ``reach``."""
    state = chord_state(a, b, curve, psi, cos(psi), sin(psi))
    radius = tail_radius(curve, state, reach)
    coincides = curve[COINCIDENCE] != NONE
    if coincides:
        radius += regular_error(curve)
    if coincides or not isfinite(radius):
        radius = min(radius, disc_radius(a, b, curve, state, psi, reach + 1e-15))
    # A tail that counts is on its feature.
    if a[IS_ARC] != 0.0:
        return (state[0], state[1], min(radius, 2.2 * a[RADIUS]))
    if radius <= 2.2 * a[HALF_EXTENT]:
        return (state[0], state[1], radius)
    return (a[X], a[Y], 1.1 * a[HALF_EXTENT])


@inner
def value_disc(a: Array, b: Array, curve: Array, psi: float, reach: float, mode: float) -> tuple[float, float]:
    """A middle value of a curve for orientations within ``reach`` of psi, and how far its values may be from it."""
    x, y, radius = tail_disc(a, b, curve, psi, reach)
    if mode == HEIGHT:
        return (cos(psi) * y - sin(psi) * x, radius + (abs(x) + abs(y) + radius) * reach)
    if a[IS_ARC] == 0.0:
        return (parameter_on(a, x, y), radius)
    # A disc of up to half the arc's radius is seen from its centre under at most 1.1 radius / R to either side.
    return (parameter_on(a, x, y), 1.1 * radius / a[RADIUS] if radius <= 0.5 * a[RADIUS] else TURN)
