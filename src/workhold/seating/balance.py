"""Forces of candidates, how well they balance and, on a fence, how near everything else is."""

from __future__ import annotations

from math import cos, inf, sin

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.seating.candidates import MISFIT
from workhold.kernels.seating.columns import CLEAR, CONFIG, CONTACTS, FORCE, PEG, PIECE, RESIDUAL, SEPARATION, THETA
from workhold.kernels.seating.pieces import clearances
from workhold.seating.locus import Locus
from workhold.seating.pattern import Pattern

__all__ = ["contact_normals", "forces_of", "settle_on_wall"]

Array = NDArray[np.float64]


def contact_normals(locus: Locus, pattern: Pattern, row: Array) -> tuple[Array, Array, Array]:
    """Places (n, 2) of the contacts of a candidate on the part, outward normals (n, 2) and 1 where what touches moves (n,),
    in the frame of seating, places from the part's."""
    c, s, count = cos(row[THETA]), sin(row[THETA]), int(row[CONTACTS])
    pegs, right = pattern.at(row[CONFIG][None])[0].tolist(), pattern.right.tolist()
    touching, touched = (row[at : at + count].astype(int).tolist() for at in (PEG, PIECE))
    places, normals, moves = [], [], []
    for peg, piece in zip(touching, touched, strict=True):
        if peg >= len(pegs):
            assert pattern.wall is not None
            hull, (ux, uy, _) = locus.hull.rows[piece - len(locus.rows)], pattern.wall
            places.append((c * hull[0] - s * hull[1] - hull[2] * ux, s * hull[0] + c * hull[1] - hull[2] * uy))
            normals.append((-ux, -uy))
            moves.append(0)
            continue
        (x, y), radius = pegs[peg], pattern.radii[right[peg]]
        nx, ny = locus.normal(piece, x, y)
        x, y = x - radius * nx, y - radius * ny
        places.append((c * x - s * y, s * x + c * y))
        normals.append((c * nx - s * ny, s * nx + c * ny))
        moves.append(right[peg])
    return np.array(places), np.array(normals), np.array(moves, dtype=np.float64)


def settle_on_wall(candidates: Array, locus: Locus, pattern: Pattern, size: float) -> None:
    """Write the forces of candidates (N, 24), how well they balance, and the clearance of what does not touch, as
    ``kernels.seating.candidates.settle`` does where there is no wall."""
    assert pattern.wall is not None
    touched = np.empty(1)
    for row in candidates:
        count, config = int(row[CONTACTS]), row[[0, 1, 2, 3]]
        row[RESIDUAL], row[CLEAR] = inf, float(locus.hull.clearance(config[None], pattern.wall)[0])
        pegs = pattern.at(config[None])[0]
        if not np.isfinite(config).all() or not pattern.reaches(row[SEPARATION]) or row[CLEAR] < -MISFIT:
            continue
        touching = dict(zip(row[PEG : PEG + count].astype(int), row[PIECE : PIECE + count].astype(int), strict=True))
        # The part is off the wall where a piece does not support that is said to touch it.
        misfit = row[CLEAR] if max(touching) >= len(pegs) else 0.0
        for peg, piece in zip(row[PEG : PEG + count].astype(int), row[PIECE : PIECE + count].astype(int), strict=True):
            if peg < len(pegs):
                clearances(pegs[peg : peg + 1], locus.loose, int(piece), int(piece) + 1, touched)
                misfit = max(misfit, abs(float(touched[0])))
        if misfit > MISFIT:
            continue
        for peg, side in enumerate(pattern.right.tolist()):
            if peg not in touching:
                first, end = locus.parts[side].tolist()
                clearances(pegs[peg : peg + 1], locus.rows, first, end, touched)
                row[CLEAR] = min(row[CLEAR], float(touched[0]))
        forces, residual, rank = forces_of(locus, pattern, row, size)
        if rank == count:
            row[FORCE : FORCE + count], row[RESIDUAL] = forces, residual


def forces_of(locus: Locus, pattern: Pattern, row: Array, size: float) -> tuple[Array, float, int]:
    """Forces (n,) of the contacts of a candidate, per unit of that on what moves, how well they balance, and how many of
    the contacts are independent; moments are divided by a size in mm."""
    places, normals, moves = contact_normals(locus, pattern, row)
    moments = (places[:, 0] * normals[:, 1] - places[:, 1] * normals[:, 0]) / size
    balance, target = np.stack([normals[:, 0], normals[:, 1], moments, normals[:, 0] * moves]), [0.0, 0.0, 0.0, 1.0]
    forces, _, rank, _ = np.linalg.lstsq(balance, np.array(target), rcond=1e-10)
    return forces, float(np.abs(balance @ forces - target).max()), int(rank)
