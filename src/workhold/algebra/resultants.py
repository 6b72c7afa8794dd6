"""Contact constraints and their resultants, whose roots are the orientations (sections 4 to 4.4 and 5.2).

The points (pegs) are mapped onto the features. They are turned by the orientation psi and moved so that the
characteristic point, the first peg, stays on the characteristic circle, the first feature, at the angle phi.
The paper writes this with t = tan(psi / 2) and u = tan(phi / 2). Here the same is written with

    z = exp(i psi) = (1 + i t) / (1 - i t),    w = exp(i phi) = (1 + i u) / (1 - i u):

a change of variables of degree one, so polynomials keep their degrees and their real roots, which move from
the line to the unit circle. There no root is at infinity (psi = pi is z = -1). The factors 1 + t^2 and 1 +
u^2 from the paper's denominators correspond to z = 0 and z = infinity, which drop out of a Laurent
polynomial.

A point x maps to C + R w + z x, with C, R the characteristic circle. A point of the right jaw maps to C + R w
+ z (x + s), with s the separation, the paper's sigma. At a fixed z a constraint is a polynomial in w and s,
real when |w| = 1:

    w_0 + 2 Re(w_1 w)                                   a trigonometric polynomial in phi.
    s^2 square + s linear(w) + constant(w)              a constraint with such polynomials as coefficients.

The separation and phi are eliminated by resultants. A resultant is never written out as a polynomial of
symbols. It is evaluated at as many orientations as it has coefficients, from closed formulas for the small
resultants in w. Its coefficients follow by a discrete Fourier transform. They make a Laurent polynomial in z
= exp(i psi) of span -d ... d, a polynomial of degree 2 d in t = tan(psi / 2).

Ranges of the exponents of z, from the constraints' formulas, bound d (Newton polygons; D. Bernstein 1975).
They give the numbers of complex solutions of general systems, below the degrees of the paper's Table 2:

    lines | lines 4,  line arc | lines 8,  arcs | lines 10,
    line arc | line arc 14,  arcs | line arc 16,  arcs | arcs 16.

    Three left pegs: 2, 4, 6, 6 with 0, 1, 2, 3 arcs.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import tau
from typing import Any, Self

import numpy as np
from attrs import define, evolve, fields
from numpy.typing import NDArray

from workhold.conventions import COINCIDENT
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, RADIUS, X, Y

__all__ = [
    "PAPER_DEGREES",
    "TRUE_DEGREES",
    "ContactSystems",
    "ArrayTable",
    "TrigPolynomial",
    "compute_circle_constraint",
    "compute_resultant_coefficients",
    "have_no_separation",
    "compute_line_constraint",
    "compute_pair_constraint",
    "compute_resultant",
]

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
BoolArray = NDArray[np.bool_]


@define(frozen=True, eq=False)
class ArrayTable:
    """N items stored in arrays with a row for every item; other fields are common to all items."""

    @property
    def arrays(self) -> dict[str, NDArray[Any]]:
        """The fields that are arrays, by their names."""
        values = {one.name: getattr(self, one.name) for one in fields(type(self))}
        return {name: value for name, value in values.items() if isinstance(value, np.ndarray)}

    def take(self, which: NDArray[np.int64] | BoolArray) -> Self:
        """Return the chosen items, by indices or a mask."""
        return evolve(self, **{name: array[which] for name, array in self.arrays.items()})

    @classmethod
    def concatenate(cls, parts: Sequence[Self]) -> Self:
        """Return the items of several tables, at least one, in one table;
        other fields are those of the first.
        """
        arrays = {name: np.concatenate([part.arrays[name] for part in parts]) for name in parts[0].arrays}
        return evolve(parts[0], **arrays)


@define(frozen=True, eq=False)
class TrigPolynomial:
    """Trigonometric polynomials middle + 2 Re(first w) of degree one
    in phi, w = exp(i phi), at (N, M) values of z.
    """

    middle: Array
    first: Complex

    def evaluate(self, w: Complex) -> Array:
        """Return the values at points w of the unit circle.

        Symbols are those of ``algebra.resultants``.
        """
        return np.asarray(self.middle + 2.0 * (self.first * w).real)


@define(frozen=True, eq=False)
class ContactSystems(ArrayTable):
    """N systems of K pegs and features in the form that the constraints use.

    Parameters
    ----------
    rows : (N, K, 10) feature rows.
    point : (N, K) places of the pegs from the first peg as complex numbers, in the rows' unit of length; the
        separation is not added for right pegs.
    """

    rows: Array
    point: Complex

    @property
    def middle(self) -> Complex:
        """A point of each line, or the centre of each circle, (N, K) complex numbers."""
        return np.asarray(self.rows[..., X] + 1j * self.rows[..., Y])

    @property
    def normal(self) -> Complex:
        """The outward unit normals of lines (N, K) as complex numbers; without meaning for circles."""
        return np.asarray(self.rows[..., AXIS_Y] - 1j * self.rows[..., AXIS_X])

    @property
    def radius(self) -> Array:
        """The radii (N, K), 0 for lines."""
        return np.asarray(self.rows[..., RADIUS])

    def compute_arc_misfit(self, k: int, m: int) -> Array:
        """Return the deviation (N,) of arcs k and m from a sliding pair; inf if one of them is a line.

        It is the larger of two differences: between their radii, and between the distance of their centres
        and the distance of their pegs.
        """
        arcs = (self.rows[:, k, 0] != 0.0) & (self.rows[:, m, 0] != 0.0)
        apart = np.abs(self.middle[:, m] - self.middle[:, k])
        step = np.abs(self.point[:, m] - self.point[:, k])
        off = np.maximum(np.abs(self.radius[:, k] - self.radius[:, m]), np.abs(apart - step))
        return np.where(arcs, off, np.inf)

    def find_sliding_pairs(self, k: int, m: int) -> BoolArray:
        """Return, for each system, whether arcs k and m are equal with
        centres exactly as far apart as their pegs, (N,).

        There is one orientation, z0, at which one of the two contacts implies the other. Both sides of the
        constraint between them then have the factor z - z0. Symbols are those of ``algebra.resultants``.
        """
        return np.asarray(self.compute_arc_misfit(k, m) <= COINCIDENT)

    def compute_center_difference(self, k: int, m: int, psi: Array) -> tuple[Array, Complex]:
        """Return z x + D for pegs k and m as (length, direction), (N, M) each, so that z x + D is their
        product.

        x is the step from k to m, D the vector from centre m to centre k. If the arcs do not slide, the
        length is 1.

        If the arcs slide, the length (with a sign) and the direction are exact even at the coincidence. Then
        z x + D = x (z - z0), and z - z0 = 2 i sin((psi - psi0) / 2) exp(i (psi + psi0) / 2). Symbols are
        those of ``algebra.resultants``.
        """
        step = (self.point[:, m] - self.point[:, k])[:, None]
        between = (self.middle[:, k] - self.middle[:, m])[:, None]
        plain = np.exp(1j * psi) * step + between
        zero = np.angle(-between * np.conj(step))
        length = np.where(
            self.find_sliding_pairs(k, m)[:, None], 2.0 * np.abs(step) * np.sin((psi - zero) / 2.0), 1.0
        )
        along = 1j * step / np.abs(step) * np.exp(0.5j * (psi + zero))
        return length, np.where(self.find_sliding_pairs(k, m)[:, None], along, plain)


def compute_line_constraint(contacts: ContactSystems, k: int, psi: Array) -> tuple[Array, TrigPolynomial]:
    """Return (factor (N, M) of the separation, other terms) of the constraint of peg k on a line, at
    orientations (N, M).

    The constraint is h (equation 2) for a left peg, h_sigma (equation 4) for a right one; psi is in radians.
    Symbols are those of ``algebra.resultants``.
    """
    z, normal = np.exp(1j * psi), contacts.normal[:, k, None]
    start = (contacts.middle[:, 0] - contacts.middle[:, k])[:, None] + z * contacts.point[:, k, None]
    first = np.conj(normal) * contacts.radius[:, 0, None] / 2.0
    return (np.conj(normal) * z).real, TrigPolynomial(
        (np.conj(normal) * start).real, np.broadcast_to(first, z.shape)
    )


def compute_circle_constraint(
    contacts: ContactSystems, k: int, psi: Array
) -> tuple[TrigPolynomial, TrigPolynomial]:
    """Return (factor of the separation, other terms) of the constraint of peg k on a circle, at orientations
    (N, M).

    The constraint is g (equation 3) for a left peg, g_sigma (equation 5) for a right one, in which the
    separation's square has the factor 1; psi is in radians. Symbols are those of ``algebra.resultants``.
    """
    z, radius = np.exp(1j * psi), contacts.radius[:, 0, None]
    start = (contacts.middle[:, 0] - contacts.middle[:, k])[:, None] + z * contacts.point[:, k, None]
    linear = TrigPolynomial(2.0 * (np.conj(z) * start).real, radius * np.conj(z))
    square = np.abs(start) ** 2 + (radius - contacts.radius[:, k, None]) * (
        radius + contacts.radius[:, k, None]
    )
    return linear, TrigPolynomial(square, radius * np.conj(start))


def compute_pair_constraint(contacts: ContactSystems, k: int, psi: Array) -> TrigPolynomial:
    """Return the constraint h or g of peg k, which is on the first peg's jaw; g is divided by z - z0 if the
    arcs slide.

    All N systems must have the same kind of feature k. Symbols are those of ``algebra.resultants``.
    """
    if contacts.rows[0, k, 0] == 0.0:
        return compute_line_constraint(contacts, k, psi)[1]
    length, apart = contacts.compute_center_difference(0, k, psi)
    sliding_pairs = contacts.find_sliding_pairs(0, k)[:, None]
    radius, other = contacts.radius[:, 0, None], contacts.radius[:, k, None]
    plain = np.abs(apart) ** 2 + (radius - other) * (radius + other)
    return TrigPolynomial(
        np.where(sliding_pairs, length, plain), np.asarray(radius * np.conj(apart), np.complex128)
    )


def subtract_circles(contacts: ContactSystems, k: int, m: int, psi: Array) -> tuple[Array, TrigPolynomial]:
    """Return (factor (N, M) of the separation, other terms) of g_sigma of peg m minus g_sigma of peg k.

    The difference is linear in the separation, as its square cancels. It is divided by z - z0 if the arcs
    slide. Symbols are those of ``algebra.resultants``.
    """
    z, radius = np.exp(1j * psi), contacts.radius[:, 0, None]
    _, apart = contacts.compute_center_difference(k, m, psi)
    one = (contacts.middle[:, 0] - contacts.middle[:, k])[:, None] + z * contacts.point[:, k, None]
    two = (contacts.middle[:, 0] - contacts.middle[:, m])[:, None] + z * contacts.point[:, m, None]
    radius_k, radius_m = contacts.radius[:, k, None], contacts.radius[:, m, None]
    middle = (apart * np.conj(one + two)).real + (radius_k - radius_m) * (radius_k + radius_m)
    return 2.0 * (np.conj(z) * apart).real, TrigPolynomial(
        middle, np.asarray(radius * np.conj(apart), np.complex128)
    )


# (arcs on the left, arcs on the right) of Type I; (arcs on the left, -1) of Type II.
PAPER_DEGREES = {
    (0, 0): 4,
    (1, 0): 12,
    (2, 0): 12,
    (1, 1): 24,
    (2, 1): 24,
    (2, 2): 24,
    (0, -1): 2,
    (1, -1): 4,
    (2, -1): 6,
    (3, -1): 8,
}
TRUE_DEGREES = PAPER_DEGREES | {(1, 0): 8, (2, 0): 10, (1, 1): 14, (2, 1): 16, (2, 2): 16, (3, -1): 6}

# The grid of orientations starts here, away from the symmetric ones.
GRID_START = 0.1234


def compute_resultant_of_rings(one: TrigPolynomial, two: TrigPolynomial) -> tuple[Array, Array]:
    """Return (resultant in w of two trigonometric polynomials, sum of the absolute values of its terms), (N,
    M) each.

    For a w + b + a* / w and c w + d + c* / w it is |a d - c b|^2 - 4 Im(a c*)^2. Symbols are those of
    ``algebra.resultants``.
    """
    left, right = one.first * two.middle, two.first * one.middle
    across = one.first * np.conj(two.first)
    value = np.abs(left - right) ** 2 - 4.0 * across.imag**2
    return value, (np.abs(left) + np.abs(right)) ** 2 + 4.0 * np.abs(across) ** 2


def multiply_trig_polynomials(one: TrigPolynomial, two: TrigPolynomial) -> tuple[Array, Complex, Complex]:
    """Return the product of two trigonometric polynomials as (c0, c1, c2): c0 + 2 Re(c1 w + c2 w^2).

    Symbols are those of ``algebra.resultants``.
    """
    return (
        one.middle * two.middle + 2.0 * (one.first * np.conj(two.first)).real,
        one.middle * two.first + two.middle * one.first,
        one.first * two.first,
    )


def eliminate_separation(
    factor: Array, rest: TrigPolynomial, linear: TrigPolynomial, constant: TrigPolynomial
) -> tuple[Array, Complex, Complex]:
    """Return the resultant in the separation s of factor s + rest and
    s^2 + linear s + constant, of degree two in w.

    It is rest^2 - factor rest linear + factor^2 constant, returned as (c0, c1, c2): c0 + 2 Re(c1 w + c2 w^2).
    Symbols are those of ``algebra.resultants``.
    """
    a, b = multiply_trig_polynomials(rest, rest), multiply_trig_polynomials(rest, linear)
    square = factor**2
    return (
        a[0] - factor * b[0] + square * constant.middle,
        a[1] - factor * b[1] + square * constant.first,
        a[2] - factor * b[2],
    )


def compute_resultant_with_square(
    ring: TrigPolynomial, double: tuple[Array, Complex, Complex]
) -> tuple[Array, Array]:
    """Return (1) the resultant in w of ``ring`` and c0 + 2 Re(c1 w + c2 w^2), and (2) the sum of the absolute
    values of its terms.

    ``double`` is (c0, c1, c2). The resultant is |a|^4 times the product of the second polynomial over the two
    roots of the first, a w + b + a* / w, without division. The roots' product is a* / a, and a^n times the
    sum of their n-th powers is the n-th of ``powers`` below. Symbols are those of ``algebra.resultants``.
    """
    a, b = ring.first, ring.middle
    low = np.conj(a)
    both = a * low
    powers = [
        None,
        -b,
        b**2 - 2.0 * both,
        -(b**3) + 3.0 * b * both,
        b**4 - 4.0 * b**2 * both + 2.0 * both**2,
    ]
    c = {0: double[0], 1: double[1], 2: double[2], -1: np.conj(double[1]), -2: np.conj(double[2])}
    value = np.zeros(a.shape, np.complex128)
    size = np.zeros(a.shape)
    for j in range(-2, 3):
        for k in range(-2, j + 1):
            term = c[j] * c[k] * a ** (2 - j) * low ** (2 + k)
            if j == k:
                term = c[j] ** 2 * a ** (2 - j) * low ** (2 + j)
            else:
                term = term * powers[j - k]
            value += term
            size += np.abs(term)
    return value.real, size


def compute_straight_line_form(contacts: ContactSystems, psi: Array) -> tuple[Array, Array]:
    """Return (determinant of the equations of contacts with lines only, size of its terms), (N, M) each.

    The equations are linear in the place and the separation. Rows of the matrix: normal, factor of the
    separation on the right jaw, rest; three rows without that factor for Type II.
    """
    z = np.exp(1j * psi)[..., None]
    normal = np.broadcast_to(contacts.normal[:, None, :], (*psi.shape, contacts.rows.shape[1]))
    rest = (np.conj(normal) * (z * contacts.point[:, None, :] - contacts.middle[:, None, :])).real
    columns = [normal.real, normal.imag, rest]
    if contacts.rows.shape[1] == 4:
        factor = (np.conj(normal) * z).real * (np.arange(4) >= 2)
        columns.insert(2, factor)
    matrix = np.stack(columns, axis=-1)
    return np.linalg.det(matrix), np.abs(rest).max(axis=-1)


def compute_resultant(contacts: ContactSystems, case: tuple[int, int], psi: Array) -> tuple[Array, Array]:
    """Return (resultants of N systems of one case at (N, M) orientations in radians, size of their terms),
    (N, M) each.

    Contacts have arcs before lines on each jaw, and the left jaw no fewer arcs than the right one. The case
    is (arcs on the left, arcs on the right), or (arcs on the left, -1) for the three left pegs of Type II.
    """
    left, right = case
    if left == 0:
        return compute_straight_line_form(contacts, psi)
    second = compute_pair_constraint(contacts, 1, psi)
    if right == -1:
        return compute_triple_resultant(contacts, second, psi)
    if right == 0:
        return compute_resultant_of_rings(second, eliminate_separation_of_lines(contacts, psi))
    factor, rest = (
        subtract_circles(contacts, 2, 3, psi) if right == 2 else compute_line_constraint(contacts, 3, psi)
    )
    value, size = compute_resultant_with_square(
        second, eliminate_separation(factor, rest, *compute_circle_constraint(contacts, 2, psi))
    )
    free = have_no_separation(contacts)[:, None] & (right == 2)
    # Where the separation is not in the difference at all, the difference alone takes the place of the
    # resultant in it.
    plain_value, plain_size = compute_resultant_of_rings(second, rest)
    return np.where(free, plain_value, value), np.where(free, plain_size, size)


def compute_triple_resultant(
    contacts: ContactSystems, second: TrigPolynomial, psi: Array
) -> tuple[Array, Array]:
    """Return (resultant of three left pegs, size of its terms), (N, M) each; ``second`` is the second peg's
    constraint.

    If the arcs of the second and the third peg slide, both are divided by the square of the length that
    ``ContactSystems.compute_center_difference`` returns.
    """
    value, size = compute_resultant_of_rings(second, compute_pair_constraint(contacts, 2, psi))
    sliding_pairs = contacts.find_sliding_pairs(1, 2)[:, None]
    length = np.where(sliding_pairs, contacts.compute_center_difference(1, 2, psi)[0], 1.0)
    return value / length**2, size / length**2


def eliminate_separation_of_lines(contacts: ContactSystems, psi: Array) -> TrigPolynomial:
    """Return the constraint h_sigma of pegs 3 and 4, both on lines, with the separation eliminated.

    Symbols are those of ``algebra.resultants``.
    """
    (one, rest_one), (two, rest_two) = (
        compute_line_constraint(contacts, 2, psi),
        compute_line_constraint(contacts, 3, psi),
    )
    return TrigPolynomial(
        one * rest_two.middle - two * rest_one.middle, one * rest_two.first - two * rest_one.first
    )


def have_no_separation(contacts: ContactSystems) -> NDArray[np.bool_]:
    """Return, for each system, whether its right pegs, one above the other, are on concentric arcs, (N,)."""
    concentric = np.abs(contacts.middle[:, 2] - contacts.middle[:, 3]) <= COINCIDENT
    return np.asarray(concentric & (np.abs((contacts.point[:, 2] - contacts.point[:, 3]).real) <= COINCIDENT))


def compute_resultant_coefficients(
    contacts: ContactSystems, case: tuple[int, int], bound: int | None = None
) -> tuple[Complex, Array]:
    """Return (coefficients (N, 2 d + 1) of z^-d ... z^d of the resultants, sizes (N,) of the terms they are
    sums of).

    ``bound`` is d; if None, it is half the largest degree in t of the case's resultant.
    """
    bound = TRUE_DEGREES[case] // 2 if bound is None else bound
    count = 2 * bound + 1
    psi = GRID_START + tau * np.arange(count) / count
    value, size = compute_resultant(contacts, case, np.broadcast_to(psi, (len(contacts.rows), count)))
    exponents = np.arange(-bound, bound + 1)
    transform = np.exp(-1j * psi[:, None] * exponents[None, :]) / count
    return value @ transform, size.max(axis=1)
