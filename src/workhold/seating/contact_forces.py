"""Forces of the contacts of candidates, how well they balance, how near all else is, and a check of it.

The check is independent of how equilibria are found: contacts touch, and press, and balance. Every pass is
checked before a capture opening follows from it, with nothing but its pose and contacts.

That fixtures are seats is proven. So one that is missing among the seats of its own pegs shows that what
looks for seats missed it, and perhaps others. It is made a candidate of four contacts.

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
    "settle_on_wall",
    "judge_candidates",
    "complete_with_forces",
]

Array = NDArray[np.float64]


def complete_with_forces(candidates: Array, given: HeldPart, size: float) -> Array:
    """Write the forces and clearances of candidates (N, 24) in place, and return the same array.

    See ``kernels.seating.columns`` for the layout of candidates.
    """
    write_forces_and_clearance(candidates, given, size, np.empty((4, 4)), np.empty((4, 5)))
    return candidates


def judge_candidates(candidates: Array, slack: float, slack_in_doubt: float) -> NDArray[np.int8]:
    """Return the verdicts (N,) on candidates (N, 24): NO_BALANCE, IN_BALANCE or DOUBTFUL.

    See ``kernels.seating.candidates.judge_balance``, also for the slacks in mm. See
    ``kernels.seating.columns`` for the layout of candidates.
    """
    out = np.empty(len(candidates), np.int8)
    judge_balance(candidates, slack, slack_in_doubt, out)
    return out


def find_contact_normals(
    boundary: ObstacleBoundary, pattern: Pattern, row: Array
) -> tuple[Array, Array, Array]:
    """Return the n contacts of a candidate in directions of the closing frame.

    They are places (n, 2) in mm from the part's place, outward unit normals (n, 2), and 1 where the touching
    peg moves, else 0, (n,).
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


def settle_on_wall(candidates: Array, boundary: ObstacleBoundary, pattern: Pattern, size: float) -> None:
    """Write the columns FORCE, RESIDUAL and CLEAR of candidates (N, 24) on a wall in place.

    RESIDUAL stays inf where contacts do not touch, S is out of reach, or forces are not determined. Without a
    wall use :func:`complete_with_forces`. S is the jaw separation in mm. See ``kernels.seating.columns`` for the
    layout of candidates.
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
    """Return the forces (n,) of the contacts of a candidate per unit of jaw force, by least squares.

    Return also the largest error of the balance (moments divided by ``size`` in mm), and the number of
    contacts that are independent.
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
    """Return whether all contacts of a candidate (24,) touch, and two or three of them balance.

    See ``kernels.seating.columns`` for the layout of candidates.
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
    """Return whether two or three wrenches (4,) of force (2), moment
    and force on the jaw balance it without pulling.
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
    """Return the cross product of two vectors of three."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def find_largest(vector: Sequence[float]) -> float:
    """Return the largest absolute value of a vector's components."""
    return max(map(abs, vector))


def measure_carrier_distance(row: Array, x: float, y: float) -> float:
    """Return the signed distance in mm of a point from the line or circle of a piece.

    It is positive on a line's outward side, and outside an arc's circle, convex or concave.
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
    """Return the candidate (24,) of a fixture whose pegs touch faces with given numbers.

    The configuration (4,) is theta, x, y and the jaw separation S in the frame of seating, ``faces`` has a
    number for each peg, and ``size`` is the part's in mm. See ``kernels.seating.columns`` for the layout of
    candidates.
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
