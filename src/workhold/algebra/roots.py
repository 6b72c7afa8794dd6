"""All orientations at which a real trigonometric polynomial vanishes.

The polynomials come as coefficients of z^-d ... z^d, z = exp(i psi); real roots psi are the roots z on the unit circle.
Well-conditioned ones are solved as eigenvalues of companion matrices, many at a time. Others, whose outermost coefficients
nearly vanish or whose roots are crowded, go to ball arithmetic (python-flint). It isolates every root at a precision raised
until it can.
"""

from __future__ import annotations

from math import tau

import numpy as np
from flint import acb, acb_poly, ctx
from numpy.typing import NDArray

from workhold.algebra.constraints import ContactSystems
from workhold.algebra.exact import exact_roots
from workhold.algebra.resultants import coefficients, have_no_separation
from workhold.algebra.wedges import CENTERS, HALF_SECTOR, sector_of
from workhold.conventions import (
    COINCIDENT,
    CROWDED,
    IDENTICALLY_ZERO,
    ILL_CONDITIONED,
    NEAR_CIRCLE,
    NEARLY_SLIDING,
    NEARLY_STRAIGHT,
    NOISE,
    REFINED,
    SECTOR_SLACK,
    VANISHING,
)

__all__ = ["ball_roots", "near_circle", "orientations", "sectors_with_roots"]

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]

PRECISIONS = (64, 128, 256, 512)


def sectors_with_roots(values: Complex, size: Array) -> tuple[BoolArray, BoolArray]:
    """Sectors of orientations in which roots cannot be excluded, and those where rounding may hide them.

    By Taylor's theorem \\|f(c + h) - f(c) - h f'(c)\\| <= h^2 / 2 max \\|f''\\|, and max \\|f''\\| is at most the sum of the
    sizes of its coefficients. Far more than rounding is allowed for. Where the polynomial and its first derivatives are
    tiny, roots are crowded, and rounding moves them far.

    Parameters
    ----------
    values : (N, 2 d + 1) of z^-d ... z^d.
    size : (N,) size of the terms that the values were summed from.

    Returns
    -------
    two (N, SECTORS) arrays
    """
    bound = values.shape[1] // 2
    exponents = np.arange(-bound, bound + 1)
    waves = np.exp(1j * CENTERS[None, :] * exponents[:, None])
    value = np.abs((values @ waves).real)
    slope = np.abs(((values * (1j * exponents)) @ waves).real) * HALF_SECTOR
    second = np.abs(((values * exponents**2) @ waves).real) * HALF_SECTOR**2 / 2.0
    curve = np.abs(values) @ (exponents**2).astype(np.float64) * HALF_SECTOR**2 / 2.0
    largest = np.abs(values).max(axis=1)
    possible = value <= slope + curve[:, None] + SECTOR_SLACK * largest[:, None]
    crowded = value + slope + second <= np.maximum(CROWDED * largest, NOISE * size)[:, None]
    return possible, possible & crowded


def ball_roots(values: Complex) -> Complex:
    """All roots of a polynomial, coefficients from the constant up, isolated in ball arithmetic."""
    before = ctx.prec
    polynomial = acb_poly([acb(c.real, c.imag) for c in values])
    try:
        for precision in PRECISIONS:
            ctx.prec = precision
            try:
                return np.array([complex(root) for root in polynomial.roots(REFINED)], np.complex128)
            except ValueError:
                continue
    finally:
        ctx.prec = before
    # Roots that no precision separates are equal; their derivative's root is as good.
    return np.asarray(np.roots(values[::-1]), np.complex128)


def companion_roots(values: Complex) -> Complex:
    """Roots (N, 2 d) of N polynomials with well-conditioned outermost coefficients, (N, 2 d + 1)."""
    degree = values.shape[1] - 1
    matrix = np.zeros((len(values), degree, degree), np.complex128)
    matrix[:, np.arange(1, degree), np.arange(degree - 1)] = 1.0
    matrix[:, :, -1] = -values[:, :-1] / values[:, -1:]
    return np.asarray(np.linalg.eigvals(matrix))


def vanishing_ends(values: Complex, largest: Array) -> IntArray:
    """How many coefficients vanish at either end of polynomials (N, 2 d + 1), (N,); both ends are conjugates."""
    bound = values.shape[1] // 2
    size = np.maximum(np.abs(values), np.abs(values[:, ::-1]))[:, :bound]
    return np.asarray((np.maximum.accumulate(size, axis=1) <= VANISHING * largest[:, None]).sum(axis=1))


def near_circle(roots: Complex) -> BoolArray:
    """Which roots may be on the unit circle."""
    return np.asarray(np.abs(np.abs(roots) - 1.0) <= NEAR_CIRCLE)


def hard_roots(contacts: ContactSystems, case: tuple[int, int], values: Complex) -> Complex | None:
    """Roots of the resultant of one system (a set of one) in ball arithmetic, None if they cannot be isolated."""
    if case[0] == 0:
        kept = np.flatnonzero(np.abs(values) > VANISHING * np.abs(values).max())
        return ball_roots(values[kept[0] : kept[-1] + 1])
    return exact_roots(contacts, case, case[1] == 2 and bool(have_no_separation(contacts)[0]))


def nearly_sliding(contacts: ContactSystems) -> BoolArray:
    """Which systems have pairs of arcs on one jaw that nearly slide, but do not, so that roots are crowded."""
    product = np.ones(len(contacts.rows))
    for k, m in ((0, 1), (2, 3)) if contacts.rows.shape[1] == 4 else ((0, 1), (0, 2), (1, 2)):
        misfit = contacts.misfit(k, m)
        product *= np.where(misfit <= COINCIDENT, 1.0, np.minimum(misfit, 1.0))
    return np.asarray(product <= NEARLY_SLIDING)


def orientations(
    contacts: ContactSystems, case: tuple[int, int], sectors: BoolArray
) -> tuple[IntArray, Array, IntArray]:
    """Candidates for the orientations of N systems of one case.

    Parameters
    ----------
    contacts, case : see ``resultants.resultant``.
    sectors : (N, SECTORS) where orientations are wanted.

    Returns
    -------
    (indices of systems, orientations in radians, indices of systems that their resultants leave undecided)
    """
    values, size = coefficients(contacts, case)
    largest = np.abs(values).max(axis=1)
    vanishing = largest <= IDENTICALLY_ZERO * size
    possible, crowded = sectors_with_roots(values, size)
    index = np.flatnonzero(~vanishing & (sectors & possible).any(axis=1))
    trimmed = vanishing_ends(values[index], largest[index])
    outermost = np.abs(values[index, values.shape[1] - 1 - trimmed])
    flat = contacts.rows[index][..., 6].max(axis=1, initial=0.0) > NEARLY_STRAIGHT
    hard = (outermost <= ILL_CONDITIONED * largest[index]) | (sectors & crowded)[index].any(axis=1) | flat
    hard |= nearly_sliding(contacts.take(index))
    owners, found = [], []
    for cut in np.unique(trimmed[~hard]):
        steady = index[~hard & (trimmed == cut)]
        roots = companion_roots(values[steady, cut : values.shape[1] - cut])
        owners.append(np.repeat(steady, roots.shape[1]))
        found.append(roots.ravel())
    undecided: list[int] = []
    for k in [*np.flatnonzero(vanishing), *index[hard]]:
        # Without arcs there is no exact form: what vanishes in double precision is left.
        unknown = vanishing[k] and case[0] == 0
        several = None if unknown else hard_roots(contacts.take(np.array([k])), case, values[k])
        if several is None:
            undecided.append(int(k))
            continue
        owners.append(np.full(len(several), k))
        found.append(several)
    owner = np.concatenate([np.zeros(0, np.int64), *owners])
    root = np.concatenate([np.zeros(0, np.complex128), *found])
    keep = near_circle(root)
    owner, psi = owner[keep], np.mod(np.angle(root[keep]), tau)
    # A root may have been moved across the edge of a sector.
    wide = sectors | np.roll(sectors, 1, axis=1) | np.roll(sectors, -1, axis=1)
    inside = wide[owner, sector_of(psi)]
    return owner[inside], psi[inside], np.array(undecided, np.int64)
