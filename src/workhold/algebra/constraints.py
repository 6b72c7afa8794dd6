r"""Contact constraints h, g, h_sigma and g_sigma (paper, sections 4.1 to 4.4).

The points (pegs) are mapped onto the features. They are turned by the orientation psi and moved so that the characteristic
point, the first peg, stays on the characteristic circle, the first feature, at the angle phi. The paper writes this with
t = tan(psi / 2) and u = tan(phi / 2). Here the same is written with

    z = exp(i psi) = (1 + i t) / (1 - i t),    w = exp(i phi) = (1 + i u) / (1 - i u):

a change of variables of degree one, so polynomials keep their degrees and their real roots, which move from the line to
the unit circle. Nothing is at infinity there (psi = pi is z = -1). The factors 1 + t^2 and 1 + u^2 that the
paper's denominators leave behind are z = 0 and z = infinity, which drop out of a Laurent polynomial by themselves.

A point x maps to C + R w + z x, with C, R the characteristic circle. A point of the right jaw maps to C + R w + z (x + s),
with s the separation, the paper's sigma. At a fixed z a constraint is a polynomial in w and s, real when \|w\| = 1:

    w_0 + 2 Re(w_1 w)                                   a trigonometric polynomial in phi.
    s^2 square + s linear(w) + constant(w)              a constraint with such polynomials as coefficients.
"""

from __future__ import annotations

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.conventions import COINCIDENT
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, RADIUS, X, Y

__all__ = [
    "ContactSystems",
    "TrigPolynomial",
    "circle_constraint",
    "circle_difference",
    "line_constraint",
    "pair_constraint",
]

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
BoolArray = NDArray[np.bool_]


@define(frozen=True, eq=False)
class TrigPolynomial:
    """middle + 2 Re(first w): a trigonometric polynomial of degree one in phi, one at each of (N, M) values of z."""

    middle: Array
    first: Complex

    def at(self, w: Complex) -> Array:
        """The values at points w of the unit circle."""
        return np.asarray(self.middle + 2.0 * (self.first * w).real)


@define(frozen=True, eq=False)
class ContactSystems:
    """N systems of pegs and features in the form the constraints use.

    Parameters
    ----------
    rows : (N, K, 10) feature rows.
    point : (N, K) pegs as complex numbers from the first peg, right pegs with the separation left out, in mm.
    """

    rows: Array
    point: Complex

    @property
    def middle(self) -> Complex:
        """A point of each line, or the centre of each circle, (N, K)."""
        return np.asarray(self.rows[..., X] + 1j * self.rows[..., Y])

    @property
    def normal(self) -> Complex:
        """Unit normals of lines (N, K); without meaning for circles."""
        return np.asarray(self.rows[..., AXIS_Y] - 1j * self.rows[..., AXIS_X])

    @property
    def radius(self) -> Array:
        """Radii (N, K), 0 for lines."""
        return np.asarray(self.rows[..., RADIUS])

    def take(self, which: NDArray[np.int64] | BoolArray) -> ContactSystems:
        """The systems of an index array or mask."""
        return ContactSystems(self.rows[which], self.point[which])

    def misfit(self, k: int, m: int) -> Array:
        """How far arcs k and m are from sliding, (N,); infinite where one of them is a line.

        It is by how much their radii differ, or by how much their centres' distance differs from their pegs' distance.
        """
        arcs = (self.rows[:, k, 0] != 0.0) & (self.rows[:, m, 0] != 0.0)
        apart = np.abs(self.middle[:, m] - self.middle[:, k])
        step = np.abs(self.point[:, m] - self.point[:, k])
        off = np.maximum(np.abs(self.radius[:, k] - self.radius[:, m]), np.abs(apart - step))
        return np.where(arcs, off, np.inf)

    def sliding_pairs(self, k: int, m: int) -> BoolArray:
        """Which systems have equal arcs k and m whose centres are exactly as far apart as their pegs, (N,).

        There is one orientation, z0, at which one of the two contacts implies the other. Both sides of the constraint
        between them then have the factor z - z0.
        """
        return np.asarray(self.misfit(k, m) <= COINCIDENT)

    def centers_apart(self, k: int, m: int, psi: Array) -> tuple[Array, Complex]:
        """z x + D of pegs k and m, as length (N, M) times direction: x the step from k to m, D from centre m to centre k.

        Where the arcs slide, the length (with a sign) and the direction are exact right through the coincidence.
        There z x + D = x (z - z0), and z - z0 = 2 i sin((psi - psi0) / 2) exp(i (psi + psi0) / 2).
        """
        step = (self.point[:, m] - self.point[:, k])[:, None]
        between = (self.middle[:, k] - self.middle[:, m])[:, None]
        plain = np.exp(1j * psi) * step + between
        zero = np.angle(-between * np.conj(step))
        length = np.where(self.sliding_pairs(k, m)[:, None], 2.0 * np.abs(step) * np.sin((psi - zero) / 2.0), 1.0)
        along = 1j * step / np.abs(step) * np.exp(0.5j * (psi + zero))
        return length, np.where(self.sliding_pairs(k, m)[:, None], along, plain)


def line_constraint(contacts: ContactSystems, k: int, psi: Array) -> tuple[Array, TrigPolynomial]:
    """h (equation 2) or h_sigma (equation 4) of peg k on a line: (factor of the separation, the rest).

    Parameters
    ----------
    psi : (N, M) orientations in radians.
    """
    z, normal = np.exp(1j * psi), contacts.normal[:, k, None]
    start = (contacts.middle[:, 0] - contacts.middle[:, k])[:, None] + z * contacts.point[:, k, None]
    first = np.conj(normal) * contacts.radius[:, 0, None] / 2.0
    return (np.conj(normal) * z).real, TrigPolynomial((np.conj(normal) * start).real, np.broadcast_to(first, z.shape))


def circle_constraint(contacts: ContactSystems, k: int, psi: Array) -> tuple[TrigPolynomial, TrigPolynomial]:
    """g (equation 3) or g_sigma (equation 5) of peg k on a circle: (factor of the separation, the rest); its square: 1."""
    z, radius = np.exp(1j * psi), contacts.radius[:, 0, None]
    start = (contacts.middle[:, 0] - contacts.middle[:, k])[:, None] + z * contacts.point[:, k, None]
    linear = TrigPolynomial(2.0 * (np.conj(z) * start).real, radius * np.conj(z))
    square = np.abs(start) ** 2 + (radius - contacts.radius[:, k, None]) * (radius + contacts.radius[:, k, None])
    return linear, TrigPolynomial(square, radius * np.conj(start))


def pair_constraint(contacts: ContactSystems, k: int, psi: Array) -> TrigPolynomial:
    """h or g of peg k of the first peg's jaw, where all N features k are of one kind; z - z0 is divided out of g."""
    if contacts.rows[0, k, 0] == 0.0:
        return line_constraint(contacts, k, psi)[1]
    length, apart = contacts.centers_apart(0, k, psi)
    sliding_pairs = contacts.sliding_pairs(0, k)[:, None]
    radius, other = contacts.radius[:, 0, None], contacts.radius[:, k, None]
    plain = np.abs(apart) ** 2 + (radius - other) * (radius + other)
    return TrigPolynomial(np.where(sliding_pairs, length, plain), np.asarray(radius * np.conj(apart), np.complex128))


def circle_difference(contacts: ContactSystems, k: int, m: int, psi: Array) -> tuple[Array, TrigPolynomial]:
    """g_sigma of peg m less that of peg k: the square of the separation cancels, so that it is linear in it like h_sigma.

    Returns
    -------
    (factor of the separation, the rest), with z - z0 divided out where the arcs slide
    """
    z, radius = np.exp(1j * psi), contacts.radius[:, 0, None]
    _, apart = contacts.centers_apart(k, m, psi)
    one = (contacts.middle[:, 0] - contacts.middle[:, k])[:, None] + z * contacts.point[:, k, None]
    two = (contacts.middle[:, 0] - contacts.middle[:, m])[:, None] + z * contacts.point[:, m, None]
    radius_k, radius_m = contacts.radius[:, k, None], contacts.radius[:, m, None]
    middle = (apart * np.conj(one + two)).real + (radius_k - radius_m) * (radius_k + radius_m)
    return 2.0 * (np.conj(z) * apart).real, TrigPolynomial(middle, np.asarray(radius * np.conj(apart), np.complex128))
