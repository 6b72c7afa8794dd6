"""Resultants as polynomials over complex balls, for systems whose roots double precision cannot separate.

Nearly sliding pairs (equal arcs almost as far apart as their pegs) crowd up to eight roots together. The
formulas are those of ``algebra.resultants``, on Laurent polynomials in z whose coefficients are balls of
python-flint. Doubles are exact rationals, so at any precision the resultant is that of exactly the same
system, and its roots are isolated.
"""

from __future__ import annotations

from contextlib import suppress

import numpy as np
from attrs import frozen
from flint import acb, acb_poly, ctx
from numpy.typing import NDArray

from workhold.algebra.resultants import ContactSystems
from workhold.conventions import REFINED

__all__ = ["LaurentPolynomial", "compute_exact_resultant", "find_exact_roots"]

# Bits; roots are spread by half of them.
PRECISIONS = (512, 1024)


@frozen
class LaurentPolynomial:
    """A Laurent polynomial in z with balls as coefficients: ``polynomial`` times z^low."""

    polynomial: acb_poly
    low: int

    def __add__(self, other: LaurentPolynomial) -> LaurentPolynomial:
        low = min(self.low, other.low)
        return LaurentPolynomial(
            self.multiply_by_power(self.low - low) + other.multiply_by_power(other.low - low), low
        )

    def __neg__(self) -> LaurentPolynomial:
        return LaurentPolynomial(-self.polynomial, self.low)

    def __sub__(self, other: LaurentPolynomial) -> LaurentPolynomial:
        return self + -other

    def __mul__(self, other: LaurentPolynomial) -> LaurentPolynomial:
        return LaurentPolynomial(self.polynomial * other.polynomial, self.low + other.low)

    def scale(self, factor: int) -> LaurentPolynomial:
        """Return the polynomial times a whole number."""
        return LaurentPolynomial(self.polynomial * factor, self.low)

    def multiply_by_power(self, by: int) -> acb_poly:
        """Return ``polynomial`` (without z^low) times z^by, for by >= 0."""
        return self.polynomial.left_shift(by) if by else self.polynomial

    def list_powers(self, most: int) -> list[LaurentPolynomial]:
        """Return the powers 0 to ``most`` of this polynomial."""
        out = [make_constant(1.0)]
        for _ in range(most):
            out.append(out[-1] * self)
        return out


# Coefficients of up w + middle + down / w, Laurent polynomials in z: a trigonometric polynomial in phi.
LaurentTriple = tuple[LaurentPolynomial, LaurentPolynomial, LaurentPolynomial]


def to_ball(value: complex) -> acb:
    """Return a complex double as an exact ball."""
    return acb(float(value.real), float(value.imag))


def make_constant(value: complex) -> LaurentPolynomial:
    """Return a number as a constant Laurent polynomial."""
    return LaurentPolynomial(acb_poly([to_ball(complex(value))]), 0)


def make_binomial(one: complex, low: int, two: complex, high: int) -> LaurentPolynomial:
    """Return the Laurent polynomial one z^low + two z^high, for low < high."""
    return LaurentPolynomial(
        acb_poly([to_ball(complex(one))] + [acb(0)] * (high - low - 1) + [to_ball(complex(two))]), low
    )


@frozen
class ExactSystem:
    """One system of K contacts as plain numbers, for exact arithmetic.

    Parameters
    ----------
    straight : whether each feature is a line.
    middle : a point of each line, or the centre of each circle.
    normal : unit normals of lines; without meaning for circles.
    radius : 0 for lines.
    point : places of the pegs from the first peg; for right pegs without the separation.
    sliding : pairs of contact numbers on one jaw that are sliding pairs of arcs.
    """

    straight: tuple[bool, ...]
    middle: tuple[complex, ...]
    normal: tuple[complex, ...]
    radius: tuple[float, ...]
    point: tuple[complex, ...]
    sliding: frozenset[tuple[int, int]]

    @classmethod
    def from_contact_systems(cls, contacts: ContactSystems) -> ExactSystem:
        """Return the system of ``contacts``, which must hold exactly one."""
        count = contacts.rows.shape[1]
        pairs = [(0, 1), (2, 3)] if count == 4 else [(0, 1), (0, 2)]
        return cls(
            tuple((contacts.rows[0, :, 0] == 0.0).tolist()),
            tuple(contacts.middle[0].tolist()),
            tuple(contacts.normal[0].tolist()),
            tuple(contacts.radius[0].tolist()),
            tuple(contacts.point[0].tolist()),
            frozenset(pair for pair in pairs if contacts.find_sliding_pairs(*pair)[0]),
        )

    def form_offset(self, k: int) -> tuple[LaurentPolynomial, LaurentPolynomial]:
        """Return E, the vector from feature k to peg k when the first peg is in the middle of the
        characteristic circle, and its conjugate E*.

        Symbols are those of ``algebra.resultants``.
        """
        between = self.middle[0] - self.middle[k]
        e = make_binomial(between, 0, self.point[k], 1)
        return e, make_binomial(self.point[k].conjugate(), -1, between.conjugate(), 0)

    def form_offset_difference(self, k: int, m: int) -> tuple[LaurentPolynomial, LaurentPolynomial]:
        """Return E of peg m minus E of peg k, and its conjugate; both divided by z - z0 if the two arcs
        slide.

        Symbols are those of ``algebra.resultants``.
        """
        step, between = self.point[m] - self.point[k], self.middle[k] - self.middle[m]
        if (k, m) not in self.sliding:
            return make_binomial(between, 0, step, 1), make_binomial(
                step.conjugate(), -1, between.conjugate(), 0
            )
        # E = step (z - z0), and 1 / z - 1 / z0 = -(z - z0) / (z z0).
        zero = -between / step
        return make_constant(step), LaurentPolynomial(
            acb_poly([to_ball(-step.conjugate() * zero.conjugate())]), -1
        )

    def form_line_equation(self, k: int) -> tuple[LaurentPolynomial, LaurentTriple]:
        """Return the constraint h or h_sigma of peg k on a line, as (factor of the separation, other terms).

        Symbols are those of ``algebra.resultants``.
        """
        n, half = self.normal[k], make_constant(0.5)
        e, e_bar = self.form_offset(k)
        first = self.radius[0] / 2.0
        middle = half * (make_constant(n.conjugate()) * e + make_constant(n) * e_bar)
        factor = half * make_binomial(n, -1, n.conjugate(), 1)
        return factor, (make_constant(n.conjugate() * first), middle, make_constant(n * first))

    def form_circle_equation(self, k: int) -> tuple[LaurentTriple, LaurentTriple]:
        """Return the constraint g or g_sigma of peg k on a circle, as (factor of the separation, other
        terms).

        Symbols are those of ``algebra.resultants``.
        """
        e, e_bar = self.form_offset(k)
        radius, other = make_constant(self.radius[0]), make_constant(self.radius[k])
        z, inverse = make_binomial(0.0, 0, 1.0, 1), make_binomial(1.0, -1, 0.0, 0)
        square = e * e_bar + radius * radius - other * other
        return (radius * inverse, inverse * e + z * e_bar, radius * z), (radius * e_bar, square, radius * e)

    def form_pair_equation(self, k: int) -> LaurentTriple:
        """Return the contact constraint of peg k, which is on the first peg's jaw: h for a line, g for an
        arc.

        It is divided by z - z0 if the arcs slide. Symbols are those of ``algebra.resultants``.
        """
        if self.straight[k]:
            return self.form_line_equation(k)[1]
        if (0, k) not in self.sliding:
            return self.form_circle_equation(k)[1]
        radius = make_constant(self.radius[0])
        e, e_bar = self.form_offset_difference(0, k)
        return radius * e_bar, self.form_offset(k)[0] * e_bar, radius * e

    def form_circle_difference(self, k: int, m: int) -> tuple[LaurentPolynomial, LaurentTriple]:
        """Return g_sigma of peg m minus g_sigma of peg k, as (factor of the separation, other terms).

        Both are divided by z - z0 if the arcs slide. Symbols are those of ``algebra.resultants``.
        """
        e, e_bar = self.form_offset_difference(k, m)
        (one, one_bar), (two, two_bar) = self.form_offset(k), self.form_offset(m)
        middle = make_constant(0.5) * (e * (one_bar + two_bar) + e_bar * (one + two))
        if (k, m) not in self.sliding:
            one_radius, two_radius = make_constant(self.radius[k]), make_constant(self.radius[m])
            middle = middle + one_radius * one_radius - two_radius * two_radius
        radius = make_constant(self.radius[0])
        z, inverse = make_binomial(0.0, 0, 1.0, 1), make_binomial(1.0, -1, 0.0, 0)
        return inverse * e + z * e_bar, (radius * e_bar, middle, radius * e)


def compute_resultant_of_rings(one: LaurentTriple, two: LaurentTriple) -> LaurentPolynomial:
    """Return the resultant in w = exp(i phi) of two trigonometric polynomials in phi."""
    (a, b, c), (d, e, f) = one, two
    across = a * f - c * d
    return across * across - (a * e - b * d) * (b * f - c * e)


def multiply_trig_polynomials(one: LaurentTriple, two: LaurentTriple) -> list[LaurentPolynomial]:
    """Return the product of two trigonometric polynomials: the coefficients of w^2, w, 1, 1 / w, w^-2."""
    (a, b, c), (d, e, f) = one, two
    return [a * d, a * e + b * d, a * f + b * e + c * d, b * f + c * e, c * f]


def eliminate_separation(
    factor: LaurentPolynomial, rest: LaurentTriple, linear: LaurentTriple, last: LaurentTriple
) -> list[LaurentPolynomial]:
    """Return the resultant in the separation s of factor s + rest and s^2 + linear s + last.

    It is rest^2 - factor rest linear + factor^2 last, returned as its coefficients of w^2, w, 1, 1 / w, w^-2;
    see ``resultants.eliminate_separation``.
    """
    squares, mixed = multiply_trig_polynomials(rest, rest), multiply_trig_polynomials(rest, linear)
    out = [square - factor * other for square, other in zip(squares, mixed, strict=True)]
    for k in range(3):
        out[k + 1] = out[k + 1] + factor * factor * last[k]
    return out


def compute_resultant_with_square(ring: LaurentTriple, double: list[LaurentPolynomial]) -> LaurentPolynomial:
    """Return the resultant in w of a trigonometric polynomial and one of degree two (see ``resultants``).

    ``double`` are the latter's coefficients of w^2, w, 1, 1 / w, w^-2.
    """
    a, b, low = ring
    both, square = a * low, b * b
    powers = [
        -b,
        square - both.scale(2),
        (both.scale(3) - square) * b,
        square * (square - both.scale(4)) + both * both.scale(2),
    ]
    ups, downs = a.list_powers(4), low.list_powers(4)
    total = make_constant(0.0)
    for j in range(-2, 3):
        for k in range(-2, j + 1):
            term = double[2 - j] * double[2 - k] * (ups[2 - j] * downs[2 + k])
            total = total + (term if j == k else term * powers[j - k - 1])
    return total


def compute_exact_resultant(
    contacts: ContactSystems, case: tuple[int, int], free_of_separation: bool = False
) -> acb_poly:
    """Return the resultant of one system that has an arc, times a
    power of z, at the precision of ``flint.ctx``.

    ``contacts`` holds only this system; see ``resultants.compute_resultant`` for the case. With
    ``free_of_separation``, the difference of the right pegs' constraints takes the place of the resultant in
    the separation.
    """
    system = ExactSystem.from_contact_systems(contacts)
    second = system.form_pair_equation(1)
    left, right = case
    assert left > 0
    if right == -1:
        return compute_resultant_of_rings(second, system.form_pair_equation(2)).polynomial
    if right == 0:
        (one, (a, b, c)), (two, (d, e, f)) = system.form_line_equation(2), system.form_line_equation(3)
        return compute_resultant_of_rings(
            second, (one * d - two * a, one * e - two * b, one * f - two * c)
        ).polynomial
    factor, rest = system.form_circle_difference(2, 3) if right == 2 else system.form_line_equation(3)
    if free_of_separation:
        return compute_resultant_of_rings(second, rest).polynomial
    return compute_resultant_with_square(
        second, eliminate_separation(factor, rest, *system.form_circle_equation(2))
    ).polynomial


def trim_coefficients(polynomial: acb_poly, precision: int) -> acb_poly:
    """Return a polynomial without vanishing outermost coefficients; the last binary digits of the others are
    changed.

    Return an empty polynomial when all coefficients may vanish.

    Symmetric parts have poses in pairs at one orientation: double roots, which no precision isolates.
    Coefficients are changed by a part 2^(-precision / 2) of the largest. Then all roots are single, and even
    eightfold roots move by no more than some 2^-32.
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
    """Return the complex roots z of the resultant of one system that has an arc.

    Return None if the resultant vanishes identically, or no precision isolates its roots. Parameters are
    those of :func:`compute_exact_resultant`.
    """
    for bits in PRECISIONS:
        with ctx.workprec(bits), suppress(ValueError):
            polynomial = trim_coefficients(compute_exact_resultant(contacts, case, free_of_separation), bits)
            if polynomial.degree() < 1:
                return None
            return np.array([complex(root) for root in polynomial.roots(REFINED)], np.complex128)
    return None
