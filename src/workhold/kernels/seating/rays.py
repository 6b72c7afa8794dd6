"""The ray of a pair: from its first contact along the normal there, on which the instant centre P lies.

With r_a and r_b the unit normals at both contacts, w from the first contact u to the second, of length d,

    P = u + p r_a,    p = cross(w, r_b) / cross(r_a, r_b).

Beside a tangency P runs off, and its speed is of little use. But both cross products change no faster than
the directions in them turn. So p is bounded by their quotient from below, and from above where the divisor
cannot vanish. Seen from the part, what is far off is in a direction that hardly changes. To either side of
its middle a range moves u by max(p) times half its width at most.

What rounding does to a computed chord is bounded in ``chord.evaluation``.
"""

from __future__ import annotations

from math import inf, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.chord.coincidences import NONE
from workhold.kernels.curves.columns import BACKWARD_ERROR, COINCIDENCE, KAPPA, LENGTH
from workhold.kernels.seating.pieces import angle_from_middle, length
from workhold.kernels.seating.two_contact_curves import END, PairState

__all__ = ["Ray", "foot_is_off", "ray_of"]

Array = NDArray[np.float64]
# Least and largest distance of P from the first contact in mm, the ray's unit vector in the middle of the
# range, how far the contact moves to either side of its place there in mm, and by how much the normals at
# both contacts turn, in radians.
Ray = tuple[float, float, float, float, float, float, float]
# No unit. Rounding of a unit vector; and of quotients and products of bounds, generously counted.
OF_DIRECTION, OF_BOUND = 1e-15, 1e-9


@inner
def ray_of(curve: Array, a: Array, b: Array, s: PairState, speed: float, reach: float) -> Ray:
    """The ray over a range in whose middle the pair is ``s``.

    Its distances are 0 and inf where nothing is known.

    Parameters
    ----------
    curve : row of the curve table.
    a, b : rows of the pieces that are touched.
    speed : no less than that of P, in mm per radian.
    reach : half of the range in radians.
    """
    eta, kappa, d = curve[BACKWARD_ERROR], curve[KAPPA], curve[LENGTH]
    px, py, across = s[6] - s[0], s[7] - s[1], abs(s[2] * s[5] - s[3] * s[4])
    size = length(px, py)
    is_known = curve[COINCIDENCE] == NONE and across * across > 64.0 * kappa * eta
    # How far off rounding puts the contacts, and P.
    off, move = 0.0, speed * reach
    if is_known:
        off = 6.0 * eta / across
        move += 8.0 * eta / (across * across) * (1.0 + kappa * (d + 2.0 * size))
    # Normals of arcs turn with the contacts, which move about P.
    way, turn_a = reach * (1.0 + 2.0 * reach), off * kappa + OF_DIRECTION
    turn_b = turn_a
    if a[IS_ARC] != 0.0:
        turn_a += (size + move) * way / a[RADIUS]
    if b[IS_ARC] != 0.0:
        turn_b += (length(s[8] - s[6], s[9] - s[7]) + move) * way / b[RADIUS]
    if not is_known:
        return (0.0, inf, s[2], s[3], 0.0, turn_a, turn_b)
    lever, change = size * across, d * (reach + turn_b)
    least = max((lever - change) / (across + turn_a + turn_b), size - move) * (1.0 - OF_BOUND)
    most = size + move
    if across > turn_a + turn_b:
        most = min(most, (lever + change) / (across - turn_a - turn_b))
    most *= 1.0 + OF_BOUND
    sign = 1.0 if px * s[2] + py * s[3] >= 0.0 else -1.0
    return (max(least, 0.0), most, sign * s[2], sign * s[3], most * reach + off, turn_a, turn_b)


@inner
def foot_is_off(
    piece: Array,
    side: float,
    push: float,
    above: float,
    cosine: float,
    sine: float,
    s: PairState,
    ray: Ray,
    reach: float,
) -> bool:
    """Whether over a range the foot of P is off a piece, off the third peg's level, or without balance.

    There is no balance where the force there cannot balance the other two; see ``three_contacts``.
    """
    least, most, rx, ry, drift, turn_a, turn_b = ray
    if least <= 0.0:
        return False
    gx, gy = s[0] - piece[X], s[1] - piece[Y]
    if piece[IS_ARC] == 0.0:
        along, at = rx * piece[AXIS_X] + ry * piece[AXIS_Y], gx * piece[AXIS_X] + gy * piece[AXIS_Y]
        if along < 0.0:
            along, at = -along, -at
        beyond = piece[HALF_EXTENT] + END + drift
        return at + most * (along + turn_a) < -beyond or (along > turn_a and at + least * (along - turn_a) > beyond)
    # P from the arc's centre, in the frame of the ray: the contact moves across it.
    ahead, across = rx * gx + ry * gy, rx * gy - ry * gx
    slack = turn_a * (abs(ahead) + abs(across) + drift) + END
    near, far = least + ahead - slack, most + ahead + slack
    if near <= 0.0:
        return False
    low, high = across - drift - slack, across + drift + slack
    low, high = low / (near if low < 0.0 else far), high / (near if high > 0.0 else far)
    tangent, turn = (low + high) / 2.0, (high - low) / 2.0 + turn_a
    size = side / sqrt(1.0 + tangent * tangent)
    ex, ey = (rx - tangent * ry) * size, (ry + tangent * rx) * size
    nx, ny = piece[SIGN] * ex, piece[SIGN] * ey
    if push * (nx * cosine + ny * sine) < -(turn + reach):
        return True
    # The force balances two that press along their normals, so it is against the sum of those.
    if nx * (s[2] + s[4]) + ny * (s[3] + s[5]) > 2.0 * turn + turn_a + turn_b:
        return True
    fx, fy = piece[RADIUS] * ex - gx, piece[RADIUS] * ey - gy
    play = piece[RADIUS] * turn + drift
    if abs(cosine * fy - sine * fx - above) > play + reach * (abs(fx) + abs(fy) + play) + END:
        return True
    beyond = piece[HALF_EXTENT] + turn + END / piece[RADIUS]
    return beyond < pi and abs(angle_from_middle(piece, ex, ey)) > beyond
