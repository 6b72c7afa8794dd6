"""A fixture that was not found among the seats of its own pegs, as a candidate of four contacts.

That fixtures are seats is proven. So one that is missing shows that what looks for seats missed it, and
perhaps others.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CONFIG,
    CONTACTS,
    FORCE,
    PEG,
    PIECE,
)
from workhold.kernels.seating.pieces import clearances
from workhold.seating.contact_forces import forces_of
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.pattern import Pattern
from workhold.seating.wall_equilibria import ON_WALL, WallEquilibria

__all__ = ["OTHERS_MAY_BE", "WAS_NOT_FOUND", "as_candidate"]

Array = NDArray[np.float64]
WAS_NOT_FOUND = (
    "This fixture was not found among the seats of its own pegs, a fault of the program: from where on the part is caught "
    "is not known, and seats may be missing."
)
OTHERS_MAY_BE = (
    "A fixture on the same pegs was not found among their seats, a fault of the program: others may be missing."
)


def as_candidate(
    boundary: ObstacleBoundary, pattern: Pattern, config: Array, faces: Sequence[int], size: float
) -> Array:
    """The candidate (24,) of a fixture.

    Parameters
    ----------
    config : (4,) theta, x, y and S, in the frame of seating.
    faces : that the pegs touch, by their numbers.
    size : of the part in mm.
    """
    row, away = np.zeros(CANDIDATE_LENGTH), np.empty(1)
    row[CONFIG], row[PEG : PEG + 4], row[PIECE : PIECE + 4] = config, -1.0, -1.0
    contacts = []
    for peg, (at, side) in enumerate(zip(pattern.at(config[None])[0], pattern.right.tolist(), strict=True)):
        off = {}
        for number in range(*boundary.parts[side].tolist()):
            clearances(np.ascontiguousarray(at[None]), boundary.rows, number, number + 1, away)
            is_another = boundary.touches[number].corner or boundary.touches[number].face != faces[peg]
            off[number] = is_another, abs(float(away[0]))
        contacts.append((peg, min(off, key=off.__getitem__)))
    if pattern.half_plane is not None:
        wall = WallEquilibria(boundary, pattern)
        side = min(wall.sides, key=lambda one: 1.0 - np.cos(wall.outward() - one.angle - config[0]))
        contacts += [wall.on(piece, at > 0) for at, piece in zip(range(len(ON_WALL)), side.pieces, strict=True)]
    row[CONTACTS] = len(contacts)
    for k, (peg, piece) in enumerate(contacts):
        row[PEG + k], row[PIECE + k] = peg, piece
    row[FORCE : FORCE + 4] = forces_of(boundary, pattern, row, size)[0]
    return row
