"""Contact forces of candidates, the residual of their balance, the clearance of all other pegs, and an
independent check.

The check does not depend on how equilibria are found: it tests that contacts touch, press and balance, from a
pose and its contacts alone. Every pass is checked before a capture opening is derived from it.

Fixtures are proven to be seats. So if a fixture is missing among the seats found for its own pegs, the search
for seats has missed it, and perhaps others. The fixture is then added as a candidate with four contacts.

Reference: E. Rimon and J. W. Burdick, "Mobility of bodies in contact, part I", IEEE Transactions on Robotics
and Automation 14 (1998).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from math import cos, hypot, inf, sin
from operator import mul

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, X, Y
from workhold.kernels.seating.candidates import MISFIT, judge_balance, write_forces_and_clearance
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
    HeldPart,
)
from workhold.kernels.seating.obstacles import write_clearances_of_points
from workhold.seating.closing import ClosingMotion, make_candidate
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.pattern import Pattern
from workhold.seating.wall_equilibria import ON_WALL, WallEquilibria

__all__ = [
    "OTHERS_MAY_BE",
    "WAS_NOT_FOUND",
    "to_candidate",
    "find_contact_normals",
    "solve_contact_forces",
    "is_equilibrium",
    "write_forces_on_wall",
    "judge_candidates",
    "complete_with_forces",
]

Array = NDArray[np.float64]


def complete_with_forces(candidates: Array, given: HeldPart, size: float) -> Array:
    """Write the contact forces and clearances of candidates (N, 24) in place, and return the same array.

    ``size`` is the part's in mm, by which moments are divided. A candidate is a configuration with contacts
    and forces that may be an equilibrium, see ``kernels.seating.columns``.
    """
    write_forces_and_clearance(candidates, given, size, np.empty((4, 4)), np.empty((4, 5)))
    return candidates


def judge_candidates(candidates: Array, slack: float, slack_in_doubt: float) -> NDArray[np.int8]:
    """Return for each candidate (N, 24) whether its contact forces balance: NO_BALANCE, IN_BALANCE or
    DOUBTFUL (N,).

    ``slack`` and ``slack_in_doubt`` are depths in mm to which other pegs may enter the part, see
    ``kernels.seating.candidates.judge_balance``. A candidate is a configuration with contacts and forces that
    may be an equilibrium, see ``kernels.seating.columns``.
    """
    out = np.empty(len(candidates), np.int8)
    judge_balance(candidates, slack, slack_in_doubt, out)
    return out


def find_contact_normals(
    boundary: ObstacleBoundary, pattern: Pattern, row: Array
) -> tuple[Array, Array, Array]:
    """Return the places and normals of the n contacts of a candidate ``row`` (24,), along the closing frame's
    axes.

    Three arrays: places (n, 2) in mm relative to the centre of the part's box, unit normals (n, 2) out of the
    part, and (n,) 1.0 where the touching peg moves, else 0.0. A candidate is a configuration with contacts
    and forces that may be an equilibrium, see ``kernels.seating.columns``.
    """
    c, s, count = cos(row[THETA]), sin(row[THETA]), int(row[CONTACTS])
    pegs, right = pattern.place_pegs(row[CONFIG][None])[0].tolist(), pattern.right.tolist()
    touching, touched = (row[at : at + count].astype(int).tolist() for at in (PEG, PIECE))
    places, normals, moves = [], [], []
    for peg, piece in zip(touching, touched, strict=True):
        if peg >= len(pegs):
            assert pattern.half_plane is not None
            hull, (ux, uy, _) = boundary.hull.rows[piece - len(boundary.rows)], pattern.half_plane
            places.append(
                (c * hull[0] - s * hull[1] - hull[2] * ux, s * hull[0] + c * hull[1] - hull[2] * uy)
            )
            normals.append((-ux, -uy))
            moves.append(0)
            continue
        (x, y), radius = pegs[peg], pattern.radii[right[peg]]
        nx, ny = boundary.compute_normal(piece, x, y)
        x, y = x - radius * nx, y - radius * ny
        places.append((c * x - s * y, s * x + c * y))
        normals.append((c * nx - s * ny, s * nx + c * ny))
        moves.append(right[peg])
    return np.array(places), np.array(normals), np.array(moves, dtype=np.float64)


def write_forces_on_wall(
    candidates: Array, boundary: ObstacleBoundary, pattern: Pattern, size: float
) -> None:
    """Write the columns FORCE, RESIDUAL and CLEAR of candidates (N, 24) of a pattern with a wall, in place.

    RESIDUAL is inf where the contacts do not touch, the jaw separation is out of reach, or the forces are not
    unique. For patterns without a wall use :func:`complete_with_forces`. ``size`` is the part's in mm. A
    candidate is a configuration with contacts and forces that may be an equilibrium, see
    ``kernels.seating.columns``.
    """
    assert pattern.half_plane is not None
    touched = np.empty(1)
    for row in candidates:
        count, config = int(row[CONTACTS]), row[[0, 1, 2, 3]]
        row[RESIDUAL], row[CLEAR] = (
            inf,
            float(boundary.hull.compute_wall_clearance(config[None], pattern.half_plane)[0]),
        )
        pegs = pattern.place_pegs(config[None])[0]
        if not np.isfinite(config).all() or not pattern.is_reachable(row[SEPARATION]) or row[CLEAR] < -MISFIT:
            continue
        touching = dict(
            zip(row[PEG : PEG + count].astype(int), row[PIECE : PIECE + count].astype(int), strict=True)
        )
        # The part is off the wall where a piece that should touch it does not support.
        misfit = row[CLEAR] if max(touching) >= len(pegs) else 0.0
        for peg, piece in zip(
            row[PEG : PEG + count].astype(int), row[PIECE : PIECE + count].astype(int), strict=True
        ):
            if peg < len(pegs):
                write_clearances_of_points(
                    pegs[peg : peg + 1], boundary.loose, int(piece), int(piece) + 1, touched
                )
                misfit = max(misfit, abs(float(touched[0])))
        if misfit > MISFIT:
            continue
        for peg, side in enumerate(pattern.right.tolist()):
            if peg not in touching:
                first, end = boundary.parts[side].tolist()
                write_clearances_of_points(pegs[peg : peg + 1], boundary.rows, first, end, touched)
                row[CLEAR] = min(row[CLEAR], float(touched[0]))
        forces, residual, rank = solve_contact_forces(boundary, pattern, row, size)
        if rank == count:
            row[FORCE : FORCE + count], row[RESIDUAL] = forces, residual


def solve_contact_forces(
    boundary: ObstacleBoundary, pattern: Pattern, row: Array, size: float
) -> tuple[Array, float, int]:
    """Return the contact forces of a candidate ``row`` (24,), and the residual of their balance.

    Three results: (1) the forces (n,) of the n contacts per unit of jaw force, by least squares; (2) the
    largest error of the equations of balance, in which moments are divided by ``size`` (mm); (3) the rank of
    these equations, which is n where the forces are unique. A candidate is a configuration with contacts and
    forces that may be an equilibrium, see ``kernels.seating.columns``.
    """
    places, normals, moves = find_contact_normals(boundary, pattern, row)
    moments = (places[:, 0] * normals[:, 1] - places[:, 1] * normals[:, 0]) / size
    balance, target = (
        np.stack([normals[:, 0], normals[:, 1], moments, normals[:, 0] * moves]),
        [0.0, 0.0, 0.0, 1.0],
    )
    forces, _, rank, _ = np.linalg.lstsq(balance, np.array(target), rcond=1e-10)
    return forces, float(np.abs(balance @ forces - target).max()), int(rank)


# No unit, and mm: forces, per unit of the jaw's and with moments over the part's size, balance to this, and
# contacts touch.
SETTLED = 1e-9
# No unit. A force above minus this does not pull.
PULLS = 1e-9


def is_equilibrium(row: Array, closing: ClosingMotion) -> bool:
    """Return whether each contact of a candidate (24,) touches the part, and forces at two or three of them
    balance.

    A candidate is a configuration with contacts and forces that may be an equilibrium, see
    ``kernels.seating.columns``.
    """
    pegs = closing.pattern.place_pegs(row[CONFIG][None])[0].tolist()
    for k in range(int(row[CONTACTS])):
        peg, piece = int(row[PEG + k]), int(row[PIECE + k])
        # Where a wall is touched follows from the pose.
        if peg < len(pegs) and abs(
            measure_carrier_distance(closing.boundary.rows[piece], *pegs[peg])
        ) > SETTLED * max(1.0, closing.size):
            return False
    places, normals, moves = find_contact_normals(closing.boundary, closing.pattern, row)
    moments = (places[:, 0] * normals[:, 1] - places[:, 1] * normals[:, 0]) / closing.size
    wrenches = np.stack([normals[:, 0], normals[:, 1], moments, normals[:, 0] * moves], axis=1).tolist()
    # Loose rest may touch with more than three: some of them do.
    return any(map(is_balanced, combinations(wrenches, 3))) or any(
        map(is_balanced, combinations(wrenches, 2))
    )


def is_balanced(wrenches: Sequence[Sequence[float]]) -> bool:
    """Return whether a unit of jaw force can be balanced by forces at two or three contacts that can only
    press.

    Each wrench (4,) is that of a unit force at a contact: force in x and y, moment, and force on the moving
    jaw.
    """
    across, along, moments, on_jaw = zip(*wrenches, strict=True)
    equations = across, along, moments
    # Two forces that balance differ in their sense alone; three are square to the equations, of which two
    # suffice.
    forces: tuple[float, ...] = (1.0, 1.0)
    if len(wrenches) == 3:
        forces = max((cross(*two) for two in combinations(equations, 2)), key=find_largest)
    jaw = sum(map(mul, forces, on_jaw))
    if abs(jaw) <= PULLS * find_largest(forces):
        return False
    forces = tuple(force / jaw for force in forces)
    most = SETTLED * (1.0 + sum(map(abs, forces)))
    return min(forces) > -PULLS and all(abs(sum(map(mul, forces, one))) < most for one in equations)


def cross(a: Sequence[float], b: Sequence[float]) -> tuple[float, ...]:
    """Return the cross product of two vectors with three components."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def find_largest(vector: Sequence[float]) -> float:
    """Return the largest absolute value of a vector's components."""
    return max(map(abs, vector))


def measure_carrier_distance(row: Array, x: float, y: float) -> float:
    """Return the signed distance in mm of the point (x, y) from the whole line or circle that a piece is part
    of.

    It is positive on the outward side of a line, and outside a circle, whether the arc is convex or concave.
    """
    piece = row.tolist()
    dx, dy = x - piece[X], y - piece[Y]
    if piece[IS_ARC] == 0.0:
        return float(dx * piece[AXIS_Y] - dy * piece[AXIS_X])
    return float(hypot(dx, dy) - piece[RADIUS])


WAS_NOT_FOUND = (
    "This fixture was not found among the seats of its own pegs, a fault of the program: from where on the "
    "part is caught is not known, and seats may be missing."
)
OTHERS_MAY_BE = (
    "A fixture on the same pegs was not found among their seats, a fault of the program: others may be "
    "missing."
)


def to_candidate(
    boundary: ObstacleBoundary, pattern: Pattern, config: Array, faces: Sequence[int], size: float
) -> Array:
    """Return the candidate (24,) of a fixture, whose contacts are known.

    A candidate is a configuration with contacts and forces that may be an equilibrium, see
    ``kernels.seating.columns``.

    Parameters
    ----------
    config : (4,) theta, x, y and the jaw separation S in the closing frame, in radians and mm.
    faces : number of the face that each peg touches.
    size : the part's size in mm.
    """
    contacts, away = [], np.empty(1)
    for peg, (at, side) in enumerate(
        zip(pattern.place_pegs(config[None])[0], pattern.right.tolist(), strict=True)
    ):
        off = {}
        for number in range(*boundary.parts[side].tolist()):
            write_clearances_of_points(
                np.ascontiguousarray(at[None]), boundary.rows, number, number + 1, away
            )
            is_another = boundary.touches[number].corner or boundary.touches[number].face != faces[peg]
            off[number] = is_another, abs(float(away[0]))
        contacts.append((peg, min(off, key=off.__getitem__)))
    if pattern.half_plane is not None:
        wall = WallEquilibria(boundary, pattern)
        side = min(
            wall.sides, key=lambda one: 1.0 - np.cos(wall.compute_outward_direction() - one.angle - config[0])
        )
        contacts += [
            wall.make_wall_contact(piece, at > 0)
            for at, piece in zip(range(len(ON_WALL)), side.pieces, strict=True)
        ]
    row = make_candidate(config, contacts)
    row[FORCE : FORCE + 4] = solve_contact_forces(boundary, pattern, row, size)[0]
    return row
