"""The paper's Table 2: degrees of the resultants, found on random data, and the least possible.

The degree in t = tan(psi / 2) is read off the coefficients, of which more are computed than the formulas
allow to differ from 0. A resultant whose degree equals the number of complex solutions of a general system
has no spurious root: no elimination can be of lower degree. Those numbers (``resultants.TRUE_DEGREES``) are
known from Groebner bases over finite fields. Every complex root is isolated in ball arithmetic, and every
real one must lead to one pose.
"""

from __future__ import annotations

from math import tau

import numpy as np
from attrs import frozen

from workhold.algebra.poses import Poses, find_hard_roots, find_poses_at
from workhold.algebra.resultants import (
    PAPER_DEGREES,
    TRUE_DEGREES,
    ContactSystems,
    compute_resultant_coefficients,
)
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    IS_ARC,
    RADIUS,
    SEGMENT_LENGTH,
    SIGN,
    X,
    Y,
)

__all__ = ["CaseRow", "make_random_contacts", "tabulate_root_counts"]

# Spans of coefficients, and what of the largest counts as nothing.
SPAN = 12
NOTHING = 1e-11
# Roots this near to the unit circle are real.
REAL = 1e-9
# Poses nearer than this are one.
SAME = 1e-6


@frozen
class CaseRow:
    """One row of the table.

    Parameters
    ----------
    type : "I" or "II".
    left, right : arcs on each jaw, of two and two pegs, or of three (right is 0).
    paper : the paper's degree.
    ours : the largest degree found.
    general : number of complex solutions of general systems.
    systems : number of random systems; the next three numbers are sums over all of them.
    roots : isolated complex roots of the resultants,
    real : real roots among them,
    poses : poses that the real roots lead to.
    """

    type: str
    left: int
    right: int
    paper: int
    ours: int
    general: int
    systems: int
    roots: int
    real: int
    poses: int


def make_random_contacts(case: tuple[int, int], count: int, seed: int) -> ContactSystems:
    """Return ``count`` random systems of a case, each with a real pose; ``seed`` seeds the random numbers.

    The case is described at ``resultants.compute_resultant``; on each jaw arcs come before lines.
    """
    random = np.random.default_rng(seed)
    left, right = case
    pegs = 3 if right < 0 else 4
    arcs = np.array(
        [1.0] * left + [0.0] * ((3 if right < 0 else 2) - left) + [1.0] * right + [0.0] * (2 - right)
    )[:pegs]
    rows = np.zeros((count, pegs, SEGMENT_LENGTH))
    angle = random.uniform(0.0, tau, (count, pegs))
    rows[..., IS_ARC], rows[..., HALF_EXTENT], rows[..., SIGN] = arcs, 1.0, 1.0
    rows[..., AXIS_X], rows[..., AXIS_Y] = np.cos(angle), np.sin(angle)
    rows[..., RADIUS] = arcs * random.uniform(0.2, 1.0, (count, pegs))
    point = random.normal(size=(count, pegs)) + 1j * random.normal(size=(count, pegs))
    point[:, 0] = 0.0
    turn = np.exp(1j * random.uniform(0.0, tau, (count, 1)))
    place = random.normal(size=(count, 1)) + 1j * random.normal(size=(count, 1))
    touch = place + turn * (point + random.normal(size=(count, 1)) * (np.arange(pegs) >= 2) * (pegs == 4))
    # A circle passes through its peg at the drawn angle; a line through it in the drawn direction.
    middle = touch - rows[..., RADIUS] * np.exp(1j * angle)
    rows[..., X], rows[..., Y] = middle.real, middle.imag
    return ContactSystems(rows, point)


def count_distinct_poses(poses: Poses) -> int:
    """Return the number of different poses; a pose reached from several starting values counts once."""
    place = [poses.place.real, poses.place.imag, poses.separation]
    values = np.stack([poses.owner, np.cos(poses.psi), np.sin(poses.psi), *place], axis=1)
    same = (np.abs(values[:, None] - values[None]) <= SAME).all(axis=2)
    return int((same.argmax(axis=1) == np.arange(len(values))).sum())


def tabulate_root_counts(count: int = 20, seed: int = 1996) -> list[CaseRow]:
    """Return a row for each case of the table, with degrees and
    numbers of roots from ``count`` random systems each.
    """
    rows = []
    for case in PAPER_DEGREES:
        contacts = make_random_contacts(case, count, seed)
        wide = np.abs(compute_resultant_coefficients(contacts, case, SPAN)[0])
        filled = (wide > NOTHING * wide.max(axis=1, keepdims=True)).any(axis=0)
        values = compute_resultant_coefficients(contacts, case)[0]
        found = [find_hard_roots(contacts.take(np.array([k])), case, values[k]) for k in range(count)]
        roots = [np.zeros(0, np.complex128) if several is None else several for several in found]
        root, owner = np.concatenate(roots), np.repeat(np.arange(count), [len(several) for several in roots])
        real = np.abs(np.abs(root) - 1.0) <= REAL
        rows.append(
            CaseRow(
                type="II" if case[1] < 0 else "I",
                left=case[0],
                right=max(case[1], 0),
                paper=PAPER_DEGREES[case],
                ours=int(np.flatnonzero(filled).max() - np.flatnonzero(filled).min()),
                general=TRUE_DEGREES[case],
                systems=count,
                roots=len(root),
                real=int(real.sum()),
                poses=count_distinct_poses(find_poses_at(contacts, case, owner[real], np.angle(root[real]))),
            )
        )
    return rows
