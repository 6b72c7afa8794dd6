"""Forces of the contacts of candidates, how well they balance, and how near everything else is.

Reference: E. Rimon and J. W. Burdick, "Mobility of bodies in contact, part I", IEEE Transactions on Robotics
and Automation 14 (1998).
"""

from __future__ import annotations

from math import cos, inf, sin

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.seating.candidates import MISFIT, judge_balance, settle
from workhold.kernels.seating.columns import (
    CLEAR,
    CONFIG,
    CONTACTS,
    FORCE,
    PEG,
    PIECE,
    RESIDUAL,
    SEPARATION,
    THETA,
    Given,
)
from workhold.kernels.seating.pieces import clearances
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.pattern import Pattern

__all__ = ["contact_normals", "forces_of", "settle_on_wall", "verdicts", "with_forces"]

Array = NDArray[np.float64]


def with_forces(candidates: Array, given: Given, size: float) -> Array:
    """Candidates (N, 24), after their forces and clearances are written into them."""
    settle(candidates, given, size, np.empty((4, 4)), np.empty((4, 5)))
    return candidates


def verdicts(candidates: Array, slack: float, slack_in_doubt: float) -> NDArray[np.int8]:
    """Whether all contacts of candidates (N, 24) press and balance, as ``kernels.seating.candidates`` has it."""
    out = np.empty(len(candidates), np.int8)
    judge_balance(candidates, slack, slack_in_doubt, out)
    return out


def contact_normals(boundary: ObstacleBoundary, pattern: Pattern, row: Array) -> tuple[Array, Array, Array]:
    """The contacts of a candidate, in directions of the closing frame.

    Returns
    -------
    tuple
        Places (n, 2) from the part's, outward normals (n, 2), and 1 where what touches moves (n,).
    """
    c, s, count = cos(row[THETA]), sin(row[THETA]), int(row[CONTACTS])
    pegs, right = pattern.at(row[CONFIG][None])[0].tolist(), pattern.right.tolist()
    touching, touched = (row[at : at + count].astype(int).tolist() for at in (PEG, PIECE))
    places, normals, moves = [], [], []
    for peg, piece in zip(touching, touched, strict=True):
        if peg >= len(pegs):
            assert pattern.half_plane is not None
            hull, (ux, uy, _) = boundary.hull.rows[piece - len(boundary.rows)], pattern.half_plane
            places.append((c * hull[0] - s * hull[1] - hull[2] * ux, s * hull[0] + c * hull[1] - hull[2] * uy))
            normals.append((-ux, -uy))
            moves.append(0)
            continue
        (x, y), radius = pegs[peg], pattern.radii[right[peg]]
        nx, ny = boundary.normal(piece, x, y)
        x, y = x - radius * nx, y - radius * ny
        places.append((c * x - s * y, s * x + c * y))
        normals.append((c * nx - s * ny, s * nx + c * ny))
        moves.append(right[peg])
    return np.array(places), np.array(normals), np.array(moves, dtype=np.float64)


def settle_on_wall(candidates: Array, boundary: ObstacleBoundary, pattern: Pattern, size: float) -> None:
    """Writes the forces of candidates (N, 24) on a wall, how well they balance, and clearances.

    Without a wall ``with_forces`` does that.
    """
    assert pattern.half_plane is not None
    touched = np.empty(1)
    for row in candidates:
        count, config = int(row[CONTACTS]), row[[0, 1, 2, 3]]
        row[RESIDUAL], row[CLEAR] = inf, float(boundary.hull.clearance(config[None], pattern.half_plane)[0])
        pegs = pattern.at(config[None])[0]
        if not np.isfinite(config).all() or not pattern.reaches(row[SEPARATION]) or row[CLEAR] < -MISFIT:
            continue
        touching = dict(zip(row[PEG : PEG + count].astype(int), row[PIECE : PIECE + count].astype(int), strict=True))
        # The part is off the wall where a piece that should touch it does not support.
        misfit = row[CLEAR] if max(touching) >= len(pegs) else 0.0
        for peg, piece in zip(row[PEG : PEG + count].astype(int), row[PIECE : PIECE + count].astype(int), strict=True):
            if peg < len(pegs):
                clearances(pegs[peg : peg + 1], boundary.loose, int(piece), int(piece) + 1, touched)
                misfit = max(misfit, abs(float(touched[0])))
        if misfit > MISFIT:
            continue
        for peg, side in enumerate(pattern.right.tolist()):
            if peg not in touching:
                first, end = boundary.parts[side].tolist()
                clearances(pegs[peg : peg + 1], boundary.rows, first, end, touched)
                row[CLEAR] = min(row[CLEAR], float(touched[0]))
        forces, residual, rank = forces_of(boundary, pattern, row, size)
        if rank == count:
            row[FORCE : FORCE + count], row[RESIDUAL] = forces, residual


def forces_of(boundary: ObstacleBoundary, pattern: Pattern, row: Array, size: float) -> tuple[Array, float, int]:
    """The forces of the contacts of a candidate, per unit of the force on what moves.

    Parameters
    ----------
    size : in mm, by which moments are divided.

    Returns
    -------
    tuple
        Forces (n,), how well they balance, and how many of the contacts are independent.
    """
    places, normals, moves = contact_normals(boundary, pattern, row)
    moments = (places[:, 0] * normals[:, 1] - places[:, 1] * normals[:, 0]) / size
    balance, target = np.stack([normals[:, 0], normals[:, 1], moments, normals[:, 0] * moves]), [0.0, 0.0, 0.0, 1.0]
    forces, _, rank, _ = np.linalg.lstsq(balance, np.array(target), rcond=1e-10)
    return forces, float(np.abs(balance @ forces - target).max()), int(rank)
