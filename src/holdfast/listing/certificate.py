r"""A certificate for every fixture: that its contact equations have exactly one solution near the computed one, and that
the rules hold there.

Theorem (Newton-Kantorovich, in the form of radii polynomials): let F be the four contact equations in the unknowns
z = (L psi, tail x, tail y, apart), all in mm, A an approximate inverse of the Jacobian J at z, and

    Y >= \|A F(z)\|,   Z >= \|I - A J\|,   K >= \|A\| \|second derivatives of F\|      (largest absolute row sums).

When (1 - Z)^2 > 2 K Y there is exactly one solution within r+ = (1 - Z) / K of z, and it lies within
r = 2 Y / (1 - Z + sqrt((1 - Z)^2 - 2 K Y)).
Reference: J. B. van den Berg, J.-P. Lessard, "Rigorous numerics in dynamics", Notices of the AMS 62 (2015) 1057-1061.

The search tells how far the exact contacts may be from the computed ones. When that is within r+, the solution here is the
one the search isolated, and no other hides beside it.

Glossary
--------
verdict : PROVEN, DISCARDED or OPEN (to be settled in ball arithmetic).
"""

from __future__ import annotations

import numpy as np
from attrs import define
from numpy.typing import NDArray

from holdfast.kernels import vise_checks as rule
from holdfast.listing.polish import SINGULAR, Contacts
from holdfast.statics.wrenches import outward_normals, wrench_minors

__all__ = [
    "DISCARDED",
    "OPEN",
    "PROVEN",
    "ROUNDINGS",
    "Certificate",
    "Rules",
    "certificate",
    "coordinates",
    "judged",
    "slacks",
]

Array = NDArray[np.float64]
Verdicts = NDArray[np.int8]

DISCARDED, OPEN, PROVEN = -1, 0, 1
# Roundings of half a unit in the last place in a contact equation, generously counted, and relative to its terms.
ROUNDINGS = 16.0 * 1.2e-16


@define(frozen=True, eq=False)
class Certificate:
    """What is known of N solutions.

    Parameters
    ----------
    radius : (N,) in mm, how far the exact unknowns may be from the computed ones; infinite without a certificate.
    unique : (N,) in mm, within which there is no other solution.
    """

    radius: Array
    unique: Array


def second_derivatives(rows: Array, length: float) -> Array:
    r"""Bound (N,) of the second derivatives of the contact equations, in 1 / mm.

    A peg's centre moves by at most (sqrt 2 + 2 + 1) per unit of the unknowns, and its second derivative is at most 4 / L. A
    distance from a line has no curvature, one from a point about R away has at most 2 / R.
    """
    curvature = np.where(rows[..., 0] == 0.0, 0.0, 1.0 / np.where(rows[..., 6] == 0.0, 1.0, rows[..., 6]))
    return np.asarray((2.0 * 4.42**2 * curvature + 4.0 / length).max(axis=1))


def coordinates(contacts: Contacts) -> Array:
    """Size (N,) in mm of the numbers in the contact equations, which their rounding is relative to."""
    return np.asarray(
        np.abs(contacts.points).max(axis=(1, 2), initial=0.0) + np.abs(contacts.rows[..., [1, 2, 6]]).max(axis=(1, 2))
    )


def certificate(contacts: Contacts, length: float, error: Array) -> Certificate:
    """Certify N solutions of the contact equations.

    Parameters
    ----------
    contacts : polished solutions.
    length : L of the wrenches in mm.
    error : (N,) bound in mm of the error of the contact equations' values.
    """
    size = coordinates(contacts)
    with np.errstate(all="ignore"):
        regular = np.abs(np.linalg.det(np.where(np.isfinite(contacts.jacobian), contacts.jacobian, 0.0))) > SINGULAR
        safe = np.where(regular[:, None, None], contacts.jacobian, np.eye(4))
        inverse = np.linalg.inv(safe)
        norm = np.abs(inverse).sum(axis=2).max(axis=1)
        step = np.abs(np.einsum("nij,nj->ni", inverse, contacts.off)).max(axis=1) + norm * error
        defect = np.abs(np.eye(4) - inverse @ safe).sum(axis=2).max(axis=1)
        bend = second_derivatives(contacts.rows, length)
        # The computed Jacobian is off by rounding, and by the blur times the second derivatives.
        defect = defect + norm * 4.0 * (ROUNDINGS * (1.0 + size / length) + error * bend)
        rest, curve = 1.0 - defect, norm * bend
        inside = rest * rest - 2.0 * curve * step
        certified = regular & (rest > 0.0) & (inside > 0.0) & np.isfinite(step)
        radius = 1.01 * 2.0 * step / (rest + np.sqrt(np.where(certified, inside, 0.0)))
        unique = 0.99 * rest / curve
    # Points of the part's frame more than half a radius from an arc are outside the bound of the second derivatives.
    small = np.where(contacts.rows[..., 0] == 0.0, np.inf, contacts.rows[..., 6]).min(axis=1) / 16.0
    unique = np.minimum(unique, small)
    certified &= radius < unique
    return Certificate(np.where(certified, radius, np.inf), np.where(certified, unique, 0.0))


@define(frozen=True, eq=False)
class Rules:
    """What N contacts are judged by; lengths in mm.

    Parameters
    ----------
    features : (N, 4, 10) feature rows with the slack of their ends.
    lefts : (N, 4) which pegs are on the left jaw.
    margin, min_gap, length : contact margin, smallest gap and L.
    """

    features: Array
    lefts: NDArray[np.bool_]
    margin: float
    min_gap: float
    length: float


def slacks(contacts: Contacts, radius: Array, rules: Rules) -> tuple[Array, Array]:
    """Lower and upper bounds, each (R, N), of R numbers that must all be positive: ends, gap, span, closure, clamping.

    ``radius`` (N,) tells how far in mm the exact unknowns may be from the computed ones.
    """
    length = rules.length
    reach = 4.5 * radius
    normals = outward_normals(contacts.rows, contacts.points)
    minors = wrench_minors(contacts.points, normals, length)
    along = (
        contacts.points[..., 0] * np.cos(contacts.psi)[:, None]
        + contacts.points[..., 1] * np.sin(contacts.psi)[:, None]
    )
    gap = np.where(rules.lefts, np.inf, along).min(axis=1) - np.where(rules.lefts, along, -np.inf).max(axis=1)
    push = normals[..., 0] * np.cos(contacts.psi)[:, None] + normals[..., 1] * np.sin(contacts.psi)[:, None]
    curved = rules.features[..., 0] != 0.0
    swing = (reach[:, None] * np.where(curved, 1.0 / np.where(curved, rules.features[..., 6], 1.0), 0.0)).max(axis=1)
    # Normals are off by at most the swing, moments by reach / L + 2 swing, products of two normals by 2 swing.
    band = 20.0 * swing + 4.0 * reach / length + rule.ROUNDING
    size = np.abs(minors).sum(axis=1)
    sign = np.where(minors.max(axis=1) >= -minors.min(axis=1), 1.0, -1.0)
    clamp = -(sign[:, None] * minors * push * rules.lefts).sum(axis=1)
    middle = [
        end_slack(rules.features, contacts.points, rules.margin),
        gap - (rules.min_gap - rule.GAP_SLACK),
        size - rule.LEAST_SPAN,
        (sign[:, None] * minors).min(axis=1) - rule.LEAST_CLOSURE * size,
        clamp - rule.LEAST_CLAMPING * size,
    ]
    doubt = [
        1.2 * reach + 1e-12,
        3.0 * reach + 1e-12,
        4.0 * band,
        2.0 * band,
        4.0 * band + size * (swing + radius / length),
    ]
    values, spread = np.stack(middle), np.stack(doubt)
    return values - spread, values + spread


def judged(contacts: Contacts, certified: Certificate, rules: Rules) -> Verdicts:
    """Decide N certified solutions by the signs of enclosures, (N,) verdicts."""
    with np.errstate(all="ignore"):
        lower, upper = slacks(contacts, certified.radius, rules)
    known = np.isfinite(certified.radius)
    proven, broken = known & (lower > 0.0).all(axis=0), known & (upper < 0.0).any(axis=0)
    return np.where(proven, PROVEN, np.where(broken, DISCARDED, OPEN)).astype(np.int8)


def end_slack(features: Array, points: Array, margin: float) -> Array:
    """How far in mm (N,) the contact nearest to an end of its feature is from breaking the rule of ends."""
    delta = points - features[..., 1:3]
    along = delta[..., 0] * features[..., 3] + delta[..., 1] * features[..., 4]
    across = features[..., 3] * delta[..., 1] - features[..., 4] * delta[..., 0]
    line = features[..., 0] == 0.0
    position = np.where(line, along, np.arctan2(across, along))
    forgiven = np.where(position > 0.0, features[..., 9], features[..., 8])
    slack = (features[..., 5] - np.abs(position)) * np.where(line, 1.0, features[..., 6]) - margin + forgiven
    whole = ~line & (features[..., 5] >= np.pi)
    return np.asarray(np.where(whole, np.inf, slack).min(axis=1))
