"""Simultaneous contact poses: from orientations back to phi, the separation and the place (paper, section 4).

For each orientation the second peg's constraint, a trigonometric polynomial, gives up to two phi, and a right peg's
constraint up to two separations. Every combination that nearly meets all constraints is refined by Newton's method on the
contact equations themselves, and stays if it meets them to the last digits.
"""

from __future__ import annotations

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.algebra.constraints import (
    Complex,
    ContactSystems,
    TrigPolynomial,
    circle_constraint,
    line_constraint,
    pair_constraint,
)
from workhold.conventions import DOUBLE, MET, NEARLY_MET, POSE_REACH, SINGULAR

__all__ = ["Poses", "poses_at", "refined", "residuals"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

ROUNDS = 24
# A refined pose may be off by this many of the last steps. At a double solution steps halve and are all that is left;
# elsewhere the last ones are rounding.
LAST_STEPS = 16.0


@define(frozen=True, eq=False)
class Poses:
    """N poses.

    Parameters
    ----------
    owner : (N,) index of the system that a pose solves.
    psi : (N,) orientation in radians.
    place : (N,) where the first peg is in the workpiece's frame, a complex number in mm.
    separation : (N,) x distance in mm from the first left to the first right peg (0 for three left pegs).
    reach : (N,) how far off the others may be, in radians and in parts of the part's size.
    """

    owner: IntArray
    psi: Array
    place: Complex
    separation: Array
    reach: Array

    def take(self, which: NDArray[np.bool_] | IntArray) -> Poses:
        """The poses of an index array or mask."""
        return Poses(self.owner[which], self.psi[which], self.place[which], self.separation[which], self.reach[which])


def peg_centers(contacts: ContactSystems, poses: Poses) -> Complex:
    """Peg centres (N, K) in the workpiece's frame."""
    moving = np.arange(contacts.rows.shape[1]) >= 2 if contacts.rows.shape[1] == 4 else np.zeros(3)
    reach = contacts.point[poses.owner] + poses.separation[:, None] * moving
    return np.asarray(poses.place[:, None] + np.exp(1j * poses.psi)[:, None] * reach)


def distances(contacts: ContactSystems, poses: Poses) -> tuple[Array, Complex, Complex]:
    """Signed distances (N, K) of the pegs from their lines or circles, the directions across, and the peg centres."""
    center = peg_centers(contacts, poses)
    off = center - contacts.middle[poses.owner]
    straight = contacts.rows[poses.owner][..., 0] == 0.0
    size = np.abs(off)
    across = np.where(straight, contacts.normal[poses.owner], off / np.where(size == 0.0, 1.0, size))
    along = np.where(straight, (np.conj(across) * off).real, size - contacts.radius[poses.owner])
    return along, across, center


def residuals(contacts: ContactSystems, poses: Poses) -> Array:
    """Largest distance in mm of a peg's centre from its line or circle, (N,)."""
    return np.asarray(np.abs(distances(contacts, poses)[0]).max(axis=1, initial=0.0))


def refined(contacts: ContactSystems, poses: Poses) -> Poses:
    """Newton's method on the contact equations; poses that do not converge, and double solutions, are dropped.

    Lengths are in parts of the part's size.
    """
    pegs = contacts.rows.shape[1]
    for _ in range(ROUNDS):
        off, matrix = linearized(contacts, poses)
        regular = np.abs(np.linalg.det(matrix)) > SINGULAR
        poses, off, matrix = poses.take(regular), off[regular], matrix[regular]
        step = np.linalg.solve(matrix, off[..., None])[..., 0]
        step = np.clip(step, -0.25, 0.25)
        separation = poses.separation - step[:, 3] if pegs == 4 else poses.separation
        place = poses.place - step[:, 1] - 1j * step[:, 2]
        reach = LAST_STEPS * np.abs(step).max(axis=1, initial=0.0) + POSE_REACH
        poses = Poses(poses.owner, poses.psi - step[:, 0], place, separation, reach)
    off, matrix = linearized(contacts, poses)
    return poses.take((np.abs(off).max(axis=1, initial=0.0) <= MET) & (np.abs(np.linalg.det(matrix)) > DOUBLE))


def linearized(contacts: ContactSystems, poses: Poses) -> tuple[Array, Array]:
    """Distances (N, K) of the pegs from their lines or circles, and their Jacobian over psi, place and separation."""
    pegs = contacts.rows.shape[1]
    off, across, center = distances(contacts, poses)
    columns = [(np.conj(across) * 1j * (center - poses.place[:, None])).real, across.real, across.imag]
    if pegs == 4:
        columns.append((np.conj(across) * np.exp(1j * poses.psi)[:, None]).real * (np.arange(4) >= 2))
    return off, np.stack(columns, axis=-1)


def angles_of(ring: TrigPolynomial) -> tuple[Complex, Complex]:
    """The two points w of the unit circle where trigonometric polynomials vanish or come nearest to it."""
    size = 2.0 * np.abs(ring.first)
    cosine = -ring.middle / np.where(size == 0.0, 1.0, size)
    spread = np.arccos(np.clip(cosine, -1.0, 1.0))
    turn = -np.angle(ring.first)
    return np.exp(1j * (turn + spread)), np.exp(1j * (turn - spread))


def separations(contacts: ContactSystems, case: tuple[int, int], psi: Array, w: Complex) -> list[Array]:
    """The values that the separation may have at orientations (N, 1) and phi (N, 1), from the right pegs' constraints."""
    if case[1] == -1:
        return [np.zeros(w.shape)]
    if case[1] == 0:
        (one, rest_one), (two, rest_two) = line_constraint(contacts, 2, psi), line_constraint(contacts, 3, psi)
        steep = np.abs(one) >= np.abs(two)
        factor = np.where(steep, one, two)
        return [-np.where(steep, rest_one.at(w), rest_two.at(w)) / np.where(factor == 0.0, 1.0, factor)]
    linear, constant = (ring.at(w) for ring in circle_constraint(contacts, 2, psi))
    root = np.sqrt(np.maximum(linear**2 / 4.0 - constant, 0.0))
    return [-linear / 2.0 + root, -linear / 2.0 - root]


def straight_poses(contacts: ContactSystems, owner: IntArray, psi: Array) -> Poses:
    """Poses on lines alone: at an orientation the place and the separation solve linear equations (straight-line form)."""
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


def poses_at(contacts: ContactSystems, case: tuple[int, int], owner: IntArray, psi: Array) -> Poses:
    """All poses of systems at, or very near to, orientations.

    Parameters
    ----------
    contacts : systems of one case, lengths in parts of the part's size.
    owner, psi : (M,) which system and which orientation in radians.
    """
    if len(owner) == 0:
        return Poses(owner, psi, np.zeros(0, np.complex128), np.zeros(0), np.zeros(0))
    if case[0] == 0:
        return refined(contacts, straight_poses(contacts, owner, psi))
    chosen, column = contacts.take(owner), psi[:, None]
    found = []
    for w in angles_of(pair_constraint(chosen, 1, column)):
        place = chosen.middle[:, :1] + chosen.radius[:, :1] * w
        for separation in separations(chosen, case, column, w):
            found.append(Poses(owner, psi, place[:, 0], separation[:, 0], np.zeros(len(owner))))
    names = ("owner", "psi", "place", "separation", "reach")
    everything = Poses(*(np.concatenate([getattr(one, name) for one in found]) for name in names))
    return refined(contacts, everything.take(residuals(contacts, everything) <= NEARLY_MET))
