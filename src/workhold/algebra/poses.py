"""Simultaneous contact poses: roots of resultants, then phi, the separation and the place (paper, section 4).

A resultant comes as coefficients of z^-d ... z^d, z = exp(i psi); real roots psi are the roots z on the unit
circle. Well-conditioned ones are solved as eigenvalues of companion matrices, many at a time. Others, whose
outermost coefficients nearly vanish or whose roots are crowded, go to ball arithmetic (python-flint). It
isolates every root at a precision raised until it can.

For each orientation the second peg's constraint, a trigonometric polynomial, gives up to two phi, and a right
peg's constraint up to two separations. Every combination that nearly meets all constraints is refined by
Newton's method on the contact equations themselves, and stays if it meets them to the last digits.
"""

from __future__ import annotations

from contextlib import suppress
from math import tau

import numpy as np
from attrs import define
from flint import acb, acb_poly, ctx
from numpy.typing import NDArray

from workhold.algebra.candidates import CENTERS, HALF_SECTOR, find_sector
from workhold.algebra.exact import find_exact_roots
from workhold.algebra.resultants import (
    ArrayTable,
    Complex,
    ContactSystems,
    TrigPolynomial,
    compute_circle_constraint,
    compute_line_constraint,
    compute_pair_constraint,
    compute_resultant_coefficients,
    have_no_separation,
)
from workhold.conventions import (
    COINCIDENT,
    CROWDED,
    DOUBLE,
    IDENTICALLY_ZERO,
    ILL_CONDITIONED,
    MET,
    NEAR_CIRCLE,
    NEARLY_MET,
    NEARLY_SLIDING,
    NEARLY_STRAIGHT,
    NOISE,
    POSE_REACH,
    REFINED,
    SECTOR_SLACK,
    SINGULAR,
    VANISHING,
)

__all__ = [
    "Poses",
    "find_hard_roots",
    "find_candidate_orientations",
    "locate_peg_centers",
    "find_poses_at",
]

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]

PRECISIONS = (64, 128, 256, 512)


def find_sectors_with_roots(values: Complex, size: Array) -> tuple[BoolArray, BoolArray]:
    r"""Return (sectors that may have roots, sectors where rounding may hide roots), (N, SECTORS) of bool
    each.

    By Taylor's theorem \|f(c + h) - f(c) - h f'(c)\| <= h^2 / 2 max \|f''\|, and max \|f''\| is at most the
    sum of the sizes of its coefficients. Errors far larger than rounding are allowed for. Where the
    polynomial and its first derivatives are tiny, roots are crowded, and rounding moves them far.

    Parameters
    ----------
    values : (N, 2 d + 1) coefficients of z^-d ... z^d.
    size : (N,) size of the terms that the coefficients were summed from.
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


def isolate_roots_in_balls(values: Complex) -> Complex:
    """Return all roots of a polynomial, isolated in ball arithmetic; coefficients begin with the constant."""
    polynomial = acb_poly([acb(c.real, c.imag) for c in values])
    for bits in PRECISIONS:
        with ctx.workprec(bits), suppress(ValueError):
            return np.array([complex(root) for root in polynomial.roots(REFINED)], np.complex128)
    # Roots that no precision separates are equal; their derivative's root is as good.
    return np.asarray(np.roots(values[::-1]), np.complex128)


def find_companion_roots(values: Complex) -> Complex:
    """Return the roots (N, 2 d) of N polynomials with coefficients (N, 2 d + 1), whose first and last
    coefficients must not be small.
    """
    degree = values.shape[1] - 1
    matrix = np.zeros((len(values), degree, degree), np.complex128)
    matrix[:, np.arange(1, degree), np.arange(degree - 1)] = 1.0
    matrix[:, :, -1] = -values[:, :-1] / values[:, -1:]
    return np.asarray(np.linalg.eigvals(matrix))


def count_vanishing_ends(values: Complex, largest: Array) -> IntArray:
    """Return for each polynomial (N, 2 d + 1) the number of negligible coefficients to cut off at either end.

    The number is the same for both ends. ``largest`` (N,) is the size of the largest coefficient.
    """
    bound = values.shape[1] // 2
    size = np.maximum(np.abs(values), np.abs(values[:, ::-1]))[:, :bound]
    return np.asarray((np.maximum.accumulate(size, axis=1) <= VANISHING * largest[:, None]).sum(axis=1))


def find_hard_roots(contacts: ContactSystems, case: tuple[int, int], values: Complex) -> Complex | None:
    """Return the roots z of one system's resultant, computed in ball arithmetic; None if they cannot be
    isolated.

    ``contacts`` holds only this system, ``values`` are its coefficients; see ``resultants.compute_resultant``
    for the case.
    """
    if case[0] == 0:
        kept = np.flatnonzero(np.abs(values) > VANISHING * np.abs(values).max())
        return isolate_roots_in_balls(values[kept[0] : kept[-1] + 1])
    return find_exact_roots(contacts, case, case[1] == 2 and bool(have_no_separation(contacts)[0]))


def are_nearly_sliding(contacts: ContactSystems) -> BoolArray:
    """Return, for each system, whether pairs of arcs on one jaw nearly slide, which crowds the roots."""
    product = np.ones(len(contacts.rows))
    for k, m in ((0, 1), (2, 3)) if contacts.rows.shape[1] == 4 else ((0, 1), (0, 2), (1, 2)):
        misfit = contacts.compute_arc_misfit(k, m)
        product *= np.where(misfit <= COINCIDENT, 1.0, np.minimum(misfit, 1.0))
    return np.asarray(product <= NEARLY_SLIDING)


def find_candidate_orientations(
    contacts: ContactSystems, case: tuple[int, int], sectors: BoolArray
) -> tuple[IntArray, Array, IntArray]:
    """Return candidates for the orientations that solve N systems of one case, in the wanted ``sectors`` (N,
    SECTORS).

    Return (indices (M,) of systems, orientations (M,) in radians, indices of systems that their resultants
    leave undecided). For systems and case see ``resultants.compute_resultant``.
    """
    values, size = compute_resultant_coefficients(contacts, case)
    largest = np.abs(values).max(axis=1)
    vanishing = largest <= IDENTICALLY_ZERO * size
    possible, crowded = find_sectors_with_roots(values, size)
    index = np.flatnonzero(~vanishing & (sectors & possible).any(axis=1))
    trimmed = count_vanishing_ends(values[index], largest[index])
    outermost = np.abs(values[index, values.shape[1] - 1 - trimmed])
    flat = contacts.rows[index][..., 6].max(axis=1, initial=0.0) > NEARLY_STRAIGHT
    hard = (outermost <= ILL_CONDITIONED * largest[index]) | (sectors & crowded)[index].any(axis=1) | flat
    hard |= are_nearly_sliding(contacts.take(index))
    owners, found = [], []
    for cut in np.unique(trimmed[~hard]):
        steady = index[~hard & (trimmed == cut)]
        roots = find_companion_roots(values[steady, cut : values.shape[1] - cut])
        owners.append(np.repeat(steady, roots.shape[1]))
        found.append(roots.ravel())
    undecided: list[int] = []
    for k in [*np.flatnonzero(vanishing), *index[hard]]:
        # Without arcs there is no exact form: what vanishes in double precision is left.
        unknown = vanishing[k] and case[0] == 0
        several = None if unknown else find_hard_roots(contacts.take(np.array([k])), case, values[k])
        if several is None:
            undecided.append(int(k))
            continue
        owners.append(np.full(len(several), k))
        found.append(several)
    owner = np.concatenate([np.zeros(0, np.int64), *owners])
    root = np.concatenate([np.zeros(0, np.complex128), *found])
    # A real orientation is a root on the unit circle.
    keep = np.abs(np.abs(root) - 1.0) <= NEAR_CIRCLE
    owner, psi = owner[keep], np.mod(np.angle(root[keep]), tau)
    # A root may have been moved across the edge of a sector.
    wide = sectors | np.roll(sectors, 1, axis=1) | np.roll(sectors, -1, axis=1)
    inside = wide[owner, find_sector(psi)]
    return owner[inside], psi[inside], np.array(undecided, np.int64)


ROUNDS = 24
# A refined pose may be off by this many of the last steps. At a double solution steps halve and are all that
# is left; elsewhere the last ones are rounding.
LAST_STEPS = 16.0


@define(frozen=True, eq=False)
class Poses(ArrayTable):
    """N poses of systems.

    Parameters
    ----------
    owner : (N,) index of the system that a pose solves.
    psi : (N,) orientation in radians.
    place : (N,) the first peg in the workpiece's frame, a complex number; lengths are fractions of the part's
        size.
    separation : (N,) x distance from the first left to the first right peg (0 for three left pegs).
    reach : (N,) error bound of psi in radians, and of place and separation as fractions of the part's size.
    """

    owner: IntArray
    psi: Array
    place: Complex
    separation: Array
    reach: Array


def locate_peg_centers(contacts: ContactSystems, poses: Poses) -> Complex:
    """Return the peg centres (N, K) in the workpiece's frame as complex numbers."""
    moving = np.arange(contacts.rows.shape[1]) >= 2 if contacts.rows.shape[1] == 4 else np.zeros(3)
    reach = contacts.point[poses.owner] + poses.separation[:, None] * moving
    return np.asarray(poses.place[:, None] + np.exp(1j * poses.psi)[:, None] * reach)


def measure_distances(contacts: ContactSystems, poses: Poses) -> tuple[Array, Complex, Complex]:
    """Return signed distances (N, K) of pegs from their lines or
    circles, unit directions of increase, and peg centres.
    """
    center = locate_peg_centers(contacts, poses)
    off = center - contacts.middle[poses.owner]
    straight = contacts.rows[poses.owner][..., 0] == 0.0
    size = np.abs(off)
    across = np.where(straight, contacts.normal[poses.owner], off / np.where(size == 0.0, 1.0, size))
    along = np.where(straight, (np.conj(across) * off).real, size - contacts.radius[poses.owner])
    return along, across, center


def refine_poses(contacts: ContactSystems, poses: Poses) -> Poses:
    """Return poses refined by Newton's method on the contact
    equations, without divergent poses and double solutions.

    Lengths are fractions of the part's size.
    """
    pegs = contacts.rows.shape[1]
    for _ in range(ROUNDS):
        off, matrix = linearize_contacts(contacts, poses)
        regular = np.abs(np.linalg.det(matrix)) > SINGULAR
        poses, off, matrix = poses.take(regular), off[regular], matrix[regular]
        step = np.linalg.solve(matrix, off[..., None])[..., 0]
        step = np.clip(step, -0.25, 0.25)
        separation = poses.separation - step[:, 3] if pegs == 4 else poses.separation
        place = poses.place - step[:, 1] - 1j * step[:, 2]
        reach = LAST_STEPS * np.abs(step).max(axis=1, initial=0.0) + POSE_REACH
        poses = Poses(poses.owner, poses.psi - step[:, 0], place, separation, reach)
    off, matrix = linearize_contacts(contacts, poses)
    return poses.take(
        (np.abs(off).max(axis=1, initial=0.0) <= MET) & (np.abs(np.linalg.det(matrix)) > DOUBLE)
    )


def linearize_contacts(contacts: ContactSystems, poses: Poses) -> tuple[Array, Array]:
    """Return the signed distances (N, K) of pegs from lines or circles, and their Jacobian (N, K, K).

    Columns of the Jacobian: psi, place x, place y and, for four pegs, separation.
    """
    pegs = contacts.rows.shape[1]
    off, across, center = measure_distances(contacts, poses)
    columns = [(np.conj(across) * 1j * (center - poses.place[:, None])).real, across.real, across.imag]
    if pegs == 4:
        columns.append((np.conj(across) * np.exp(1j * poses.psi)[:, None]).real * (np.arange(4) >= 2))
    return off, np.stack(columns, axis=-1)


def find_unit_circle_roots(ring: TrigPolynomial) -> tuple[Complex, Complex]:
    """Return for each polynomial the two points w of the unit circle at which it vanishes or, failing that,
    comes nearest to 0.
    """
    size = 2.0 * np.abs(ring.first)
    cosine = -ring.middle / np.where(size == 0.0, 1.0, size)
    spread = np.arccos(np.clip(cosine, -1.0, 1.0))
    turn = -np.angle(ring.first)
    return np.exp(1j * (turn + spread)), np.exp(1j * (turn - spread))


def list_possible_separations(
    contacts: ContactSystems, case: tuple[int, int], psi: Array, w: Complex
) -> list[Array]:
    """Return one or two arrays of possible separations at orientations (N, 1) and w = exp(i phi) (N, 1).

    They follow from the right pegs' constraints; zeros for three left pegs.
    """
    if case[1] == -1:
        return [np.zeros(w.shape)]
    if case[1] == 0:
        (one, rest_one), (two, rest_two) = (
            compute_line_constraint(contacts, 2, psi),
            compute_line_constraint(contacts, 3, psi),
        )
        steep = np.abs(one) >= np.abs(two)
        factor = np.where(steep, one, two)
        return [
            -np.where(steep, rest_one.evaluate(w), rest_two.evaluate(w))
            / np.where(factor == 0.0, 1.0, factor)
        ]
    linear, constant = (ring.evaluate(w) for ring in compute_circle_constraint(contacts, 2, psi))
    root = np.sqrt(np.maximum(linear**2 / 4.0 - constant, 0.0))
    return [-linear / 2.0 + root, -linear / 2.0 - root]


def solve_straight_poses(contacts: ContactSystems, owner: IntArray, psi: Array) -> Poses:
    """Return the poses of systems that have lines only: linear
    equations for place and separation at each orientation.
    """
    pegs = contacts.rows.shape[1]
    normal = contacts.normal[owner]
    z = np.exp(1j * psi)[:, None]
    rest = (np.conj(normal) * (z * contacts.point[owner] - contacts.middle[owner])).real
    columns = [normal.real, normal.imag]
    if pegs == 4:
        columns.append((np.conj(normal) * z).real * (np.arange(4) >= 2))
    matrix = np.stack(columns, axis=-1)
    solution = -(np.linalg.pinv(matrix) @ rest[..., None])[..., 0]
    separation = solution[:, 2] if pegs == 4 else np.zeros(len(owner))
    return Poses(owner, psi, solution[:, 0] + 1j * solution[:, 1], separation, np.zeros(len(owner)))


def find_poses_at(contacts: ContactSystems, case: tuple[int, int], owner: IntArray, psi: Array) -> Poses:
    """Return all poses of systems at, or very near to, orientations.

    The systems are of one case, with lengths as fractions of the part's size. ``owner`` (M,) are indices of
    systems, ``psi`` (M,) orientations in radians.
    """
    if len(owner) == 0:
        return Poses(owner, psi, np.zeros(0, np.complex128), np.zeros(0), np.zeros(0))
    if case[0] == 0:
        return refine_poses(contacts, solve_straight_poses(contacts, owner, psi))
    chosen, column = contacts.take(owner), psi[:, None]
    found = []
    for w in find_unit_circle_roots(compute_pair_constraint(chosen, 1, column)):
        place = chosen.middle[:, :1] + chosen.radius[:, :1] * w
        for separation in list_possible_separations(chosen, case, column, w):
            found.append(Poses(owner, psi, place[:, 0], separation[:, 0], np.zeros(len(owner))))
    everything = Poses.concatenate(found)
    off, _, _ = measure_distances(contacts, everything)
    return refine_poses(contacts, everything.take(np.abs(off).max(axis=1, initial=0.0) <= NEARLY_MET))
