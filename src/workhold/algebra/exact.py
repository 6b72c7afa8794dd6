"""Resultants as polynomials over complex balls, for systems whose roots double precision cannot separate.

Nearly sliding pairs (equal arcs almost as far apart as their pegs) crowd up to eight roots together. The
formulas are those of ``constraints`` and ``resultants``, on Laurent polynomials in z whose coefficients are
balls of python-flint. Doubles are exact rationals, so the resultant belongs to the very same system at any
precision, and its roots are isolated.
"""

from __future__ import annotations

from contextlib import suppress

import numpy as np
from attrs import frozen
from flint import acb, acb_poly, ctx
from numpy.typing import NDArray

from workhold.algebra.resultants import ContactSystems
from workhold.conventions import REFINED

__all__ = ["Laurent", "compute_exact_resultant", "find_exact_roots"]

# Bits; roots are spread by half of them.
PRECISIONS = (512, 1024)


@frozen
class Laurent:
    """A Laurent polynomial: ``polynomial`` times z^low."""

    polynomial: acb_poly
    low: int

    def __add__(self, other: Laurent) -> Laurent:
        low = min(self.low, other.low)
        return Laurent(self.raised(self.low - low) + other.raised(other.low - low), low)

    def __neg__(self) -> Laurent:
        return Laurent(-self.polynomial, self.low)

    def __sub__(self, other: Laurent) -> Laurent:
        return self + -other

    def __mul__(self, other: Laurent) -> Laurent:
        return Laurent(self.polynomial * other.polynomial, self.low + other.low)

    def times(self, factor: int) -> Laurent:
        return Laurent(self.polynomial * factor, self.low)

    def raised(self, by: int) -> acb_poly:
        """The polynomial times z^by, by >= 0."""
        return self.polynomial.left_shift(by) if by else self.polynomial

    def powers(self, most: int) -> list[Laurent]:
        out = [constant(1.0)]
        for _ in range(most):
            out.append(out[-1] * self)
        return out


# Coefficients of up w + middle + down / w, Laurent polynomials in z: a trigonometric polynomial in phi.
LaurentTriple = tuple[Laurent, Laurent, Laurent]


def ball(value: complex) -> acb:
    """A double as an exact ball."""
    return acb(float(value.real), float(value.imag))


def constant(value: complex) -> Laurent:
    return Laurent(acb_poly([ball(complex(value))]), 0)


def binomial(one: complex, low: int, two: complex, high: int) -> Laurent:
    """one z^low + two z^high, low < high."""
    return Laurent(acb_poly([ball(complex(one))] + [acb(0)] * (high - low - 1) + [ball(complex(two))]), low)


@frozen
class System:
    """One system of contacts: points, lines' normals, circles' centres and radii as plain numbers."""

    straight: tuple[bool, ...]
    middle: tuple[complex, ...]
    normal: tuple[complex, ...]
    radius: tuple[float, ...]
    point: tuple[complex, ...]
    sliding: frozenset[tuple[int, int]]

    @classmethod
    def of(cls, contacts: ContactSystems) -> System:
        """The only system of a set of one."""
        count = contacts.rows.shape[1]
        pairs = [(0, 1), (2, 3)] if count == 4 else [(0, 1), (0, 2)]
        return cls(
            tuple((contacts.rows[0, :, 0] == 0.0).tolist()),
            tuple(contacts.middle[0].tolist()),
            tuple(contacts.normal[0].tolist()),
            tuple(contacts.radius[0].tolist()),
            tuple(contacts.point[0].tolist()),
            frozenset(pair for pair in pairs if contacts.sliding_pairs(*pair)[0]),
        )

    def start(self, k: int) -> tuple[Laurent, Laurent]:
        """E, from feature k to peg k with the first peg in the characteristic circle's middle, and E*."""
        between = self.middle[0] - self.middle[k]
        e = binomial(between, 0, self.point[k], 1)
        return e, binomial(self.point[k].conjugate(), -1, between.conjugate(), 0)

    def apart(self, k: int, m: int) -> tuple[Laurent, Laurent]:
        """E of m less E of k, and its conjugate; both over z - z0 where the two arcs slide."""
        step, between = self.point[m] - self.point[k], self.middle[k] - self.middle[m]
        if (k, m) not in self.sliding:
            return binomial(between, 0, step, 1), binomial(step.conjugate(), -1, between.conjugate(), 0)
        # E = step (z - z0), and 1 / z - 1 / z0 = -(z - z0) / (z z0).
        zero = -between / step
        return constant(step), Laurent(acb_poly([ball(-step.conjugate() * zero.conjugate())]), -1)

    def line(self, k: int) -> tuple[Laurent, LaurentTriple]:
        """h or h_sigma: factor of the separation and the rest."""
        n, half = self.normal[k], constant(0.5)
        e, e_bar = self.start(k)
        first = self.radius[0] / 2.0
        middle = half * (constant(n.conjugate()) * e + constant(n) * e_bar)
        factor = half * binomial(n, -1, n.conjugate(), 1)
        return factor, (constant(n.conjugate() * first), middle, constant(n * first))

    def circle(self, k: int) -> tuple[LaurentTriple, LaurentTriple]:
        """g or g_sigma: factor of the separation and the rest."""
        e, e_bar = self.start(k)
        radius, other = constant(self.radius[0]), constant(self.radius[k])
        z, inverse = binomial(0.0, 0, 1.0, 1), binomial(1.0, -1, 0.0, 0)
        square = e * e_bar + radius * radius - other * other
        return (radius * inverse, inverse * e + z * e_bar, radius * z), (radius * e_bar, square, radius * e)

    def pair(self, k: int) -> LaurentTriple:
        """h or g of peg k on the first peg's jaw."""
        if self.straight[k]:
            return self.line(k)[1]
        if (0, k) not in self.sliding:
            return self.circle(k)[1]
        radius = constant(self.radius[0])
        e, e_bar = self.apart(0, k)
        return radius * e_bar, self.start(k)[0] * e_bar, radius * e

    def difference(self, k: int, m: int) -> tuple[Laurent, LaurentTriple]:
        """g_sigma of m less that of k: factor of the separation and the rest."""
        e, e_bar = self.apart(k, m)
        (one, one_bar), (two, two_bar) = self.start(k), self.start(m)
        middle = constant(0.5) * (e * (one_bar + two_bar) + e_bar * (one + two))
        if (k, m) not in self.sliding:
            one_radius, two_radius = constant(self.radius[k]), constant(self.radius[m])
            middle = middle + one_radius * one_radius - two_radius * two_radius
        radius = constant(self.radius[0])
        z, inverse = binomial(0.0, 0, 1.0, 1), binomial(1.0, -1, 0.0, 0)
        return inverse * e + z * e_bar, (radius * e_bar, middle, radius * e)


def of_rings(one: LaurentTriple, two: LaurentTriple) -> Laurent:
    """Resultant in w of two trigonometric polynomials."""
    (a, b, c), (d, e, f) = one, two
    across = a * f - c * d
    return across * across - (a * e - b * d) * (b * f - c * e)


def product(one: LaurentTriple, two: LaurentTriple) -> list[Laurent]:
    """Product of two trigonometric polynomials: coefficients of w^2 ... w^-2."""
    (a, b, c), (d, e, f) = one, two
    return [a * d, a * e + b * d, a * f + b * e + c * d, b * f + c * e, c * f]


def without_separation(
    factor: Laurent, rest: LaurentTriple, linear: LaurentTriple, last: LaurentTriple
) -> list[Laurent]:
    """rest^2 - factor rest linear + factor^2 last: coefficients of w^2 ... w^-2."""
    squares, mixed = product(rest, rest), product(rest, linear)
    out = [square - factor * other for square, other in zip(squares, mixed, strict=True)]
    for k in range(3):
        out[k + 1] = out[k + 1] + factor * factor * last[k]
    return out


def with_square(ring: LaurentTriple, double: list[Laurent]) -> Laurent:
    """Resultant in w of a trigonometric polynomial and coefficients of w^2 ... w^-2 (see ``resultants``)."""
    a, b, low = ring
    both, square = a * low, b * b
    powers = [
        -b,
        square - both.times(2),
        (both.times(3) - square) * b,
        square * (square - both.times(4)) + both * both.times(2),
    ]
    ups, downs = a.powers(4), low.powers(4)
    total = constant(0.0)
    for j in range(-2, 3):
        for k in range(-2, j + 1):
            term = double[2 - j] * double[2 - k] * (ups[2 - j] * downs[2 + k])
            total = total + (term if j == k else term * powers[j - k - 1])
    return total


def compute_exact_resultant(
    contacts: ContactSystems, case: tuple[int, int], free_of_separation: bool = False
) -> acb_poly:
    """The resultant of one system that has an arc, times a power of z, at the precision of ``flint.ctx``."""
    system = System.of(contacts)
    second = system.pair(1)
    left, right = case
    assert left > 0
    if right == -1:
        return of_rings(second, system.pair(2)).polynomial
    if right == 0:
        (one, (a, b, c)), (two, (d, e, f)) = system.line(2), system.line(3)
        return of_rings(second, (one * d - two * a, one * e - two * b, one * f - two * c)).polynomial
    factor, rest = system.difference(2, 3) if right == 2 else system.line(3)
    if free_of_separation:
        return of_rings(second, rest).polynomial
    return with_square(second, without_separation(factor, rest, *system.circle(2))).polynomial


def spread(polynomial: acb_poly, precision: int) -> acb_poly:
    """A polynomial without vanishing outermost coefficients, later binary digits of the others changed.

    It is empty when all coefficients may vanish.

    Symmetric parts have poses in pairs at one orientation: double roots, which no precision isolates.
    Coefficients changed by a part 2^(-precision / 2) of the largest have single roots, and even eightfold
    ones move by no more than some 2^-32.
    """
    values = list(polynomial.coeffs())
    if not any(value.abs_lower() > 0 for value in values):
        return acb_poly([])
    sizes = [float(value.abs_upper()) for value in values]
    change = max(sizes) * 2.0 ** (-precision / 2)
    kept = [k for k, size in enumerate(sizes) if size > change]
    return acb_poly(
        [values[k] + acb(change / (k + 1.7), change / (k + 2.3)) for k in range(kept[0], kept[-1] + 1)]
    )


def find_exact_roots(
    contacts: ContactSystems, case: tuple[int, int], free_of_separation: bool = False
) -> NDArray[np.complex128] | None:
    """Roots z of the resultant of one system that has an arc, None if it vanishes identically."""
    for bits in PRECISIONS:
        with ctx.workprec(bits), suppress(ValueError):
            polynomial = spread(compute_exact_resultant(contacts, case, free_of_separation), bits)
            if polynomial.degree() < 1:
                return None
            return np.array([complex(root) for root in polynomial.roots(REFINED)], np.complex128)
    return None
