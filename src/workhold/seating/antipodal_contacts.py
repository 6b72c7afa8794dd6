"""Pegs that press a part along one line or along parallel lines: equilibria in closed form.

Two pegs are on one line: on a common normal of two pieces, or in pockets. With one at a fixed height above
the other the jaw separation grows with their distance d on the part. It is counted along the outward normal
of what moves, and is below 0 where both press from between, as in a hole. So equilibria are the critical
points of d over the places on both pieces. With curvatures kappa (of convex pieces above 0) the second
derivatives of d are 1 / d - kappa along each piece, and -1 / d across.

Of three parallel forces two are of pegs of one jaw on a line and an arc, and the third is on a parallel line.
There the chord of the two is a tangency, and its instant centre infinitely far. S depends on the orientation
alone, because two of the three lie on parallel lines. The orientation has an extremum along the chord's
curve: so S has one too.

Glossary
--------
antipodal contacts : two places with opposite normals, each on the other's: I.-M. Chen and J. W. Burdick,
    "Finding antipodal point grasps on irregularly shaped objects", IEEE Transactions on Robotics and
    Automation 9 (1993).
"""

from __future__ import annotations

from functools import cached_property
from itertools import permutations, product
from math import asin, atan2, cos, hypot, nan, sin

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    MOTION,
    SECOND,
    HeldPart,
)
from workhold.kernels.seating.parallel_and_concentric import ALPHA, write_at_tangencies, write_tangent_chords
from workhold.seating.closing import fill_rows, make_candidate
from workhold.seating.obstacle_boundary import ObstacleBoundary, contains
from workhold.seating.pattern import Pattern

__all__ = [
    "AntipodalContacts",
    "find_antipodal_candidates",
    "find_antipodal_contacts",
    "find_parallel_candidates",
]

Array = NDArray[np.float64]
# mm. Shorter distances are none.
SHORTEST = 1e-6
# No unit. A force's share below this is none; normals with a smaller cross product make no cone.
LEAST_SHARE = 1e-9
# No unit. Second derivatives below this, times d, are flat.
FLAT = 1e-9


@frozen(slots=False)
class AntipodalContacts:
    """Two places on the boundary with opposite normals, each on the other's.

    Parameters
    ----------
    pieces : for each place the numbers of the pieces that a peg there touches: one piece, or the two of a
        pocket.
    one, two : places about the part's centre, in mm.
    length : distance d from the first place to the second along the second's outward normal in mm, negative
        where the normals point at each other.
    curvatures : of the pieces in 1 / mm, positive where convex; None for a pocket.
    """

    pieces: tuple[tuple[int, ...], tuple[int, ...]]
    one: tuple[float, float]
    two: tuple[float, float]
    length: float
    curvatures: tuple[float | None, float | None]

    @cached_property
    def descent_direction(self) -> tuple[float, float, float]:
        """The least second derivative of d in 1 / mm, and the components of its direction along both pieces.

        The derivative is NaN where both principal ones are negative.
        """
        d, (one, two) = self.length, self.curvatures
        if one is None or two is None:
            if one is None and two is None:
                return 0.0, 0.0, 0.0
            return 1.0 / d - (one or 0.0) - (two or 0.0), float(one is not None), float(two is not None)
        values, ways = np.linalg.eigh([[1.0 / d - one, -1.0 / d], [-1.0 / d, 1.0 / d - two]])
        return (float(values[0]) if values[1] * abs(d) > FLAT else nan), float(ways[0, 0]), float(ways[1, 0])

    @property
    def turned(self) -> AntipodalContacts:
        """The contacts with the two places exchanged."""
        return AntipodalContacts(self.pieces[::-1], self.two, self.one, self.length, self.curvatures[::-1])


def find_antipodal_contacts(boundary: ObstacleBoundary) -> list[AntipodalContacts]:
    """Return all antipodal contacts of a part, the first place for a
    peg that stands still, the second for one that moves.

    Those on parallel lines and on concentric arcs, which are whole families, are left out.
    """
    standing, moving = range(*boundary.parts[0]), range(*boundary.parts[1])
    found = [
        normal for a, b in product(standing, moving) for normal in pair_antipodal_pieces(boundary.rows, a, b)
    ]
    for v, (piece, _) in enumerate(boundary.pocket_pieces.tolist()):
        if piece in standing:
            found += [normal for b in moving for normal in find_antipodal_in_pocket(boundary, v, b)]
        if piece in moving:
            found += [normal.turned for a in standing for normal in find_antipodal_in_pocket(boundary, v, a)]
    for v, w in product(range(len(boundary.pockets)), repeat=2):
        if boundary.pocket_pieces[v, 0] not in standing or boundary.pocket_pieces[w, 0] not in moving:
            continue
        (vx, vy), (wx, wy) = boundary.pockets[v, :2], boundary.pockets[w, :2]
        d = hypot(wx - vx, wy - vy)
        for signed in (d, -d) if d > SHORTEST else ():
            ux, uy = (wx - vx) / signed, (wy - vy) / signed
            if holds(boundary.pockets[v], -ux, -uy) and holds(boundary.pockets[w], ux, uy):
                pieces = list_pocket_pieces(boundary, v), list_pocket_pieces(boundary, w)
                found.append(AntipodalContacts(pieces, (vx, vy), (wx, wy), signed, (None, None)))
    return found


def list_pocket_pieces(boundary: ObstacleBoundary, pocket: int) -> tuple[int, ...]:
    """Return the numbers of the two pieces of a pocket."""
    return tuple(boundary.pocket_pieces[pocket].tolist())


def holds(pocket: Array, x: float, y: float) -> bool:
    """Return whether the direction (x, y) lies strictly between the two normals of a pocket, a row (6,)."""
    ax, ay, bx, by = pocket[2:6].tolist()
    cross = ax * by - ay * bx
    if abs(cross) < LEAST_SHARE:
        return False
    return bool((x * by - y * bx) / cross > LEAST_SHARE and (ax * y - ay * x) / cross > LEAST_SHARE)


def bend(row: Array) -> float:
    """Return the curvature of a piece in 1 / mm, positive where it is convex."""
    return 0.0 if row[IS_ARC] == 0.0 else float(row[SIGN] / row[RADIUS])


def find_place_with_normal(row: Array, ux: float, uy: float, x: float, y: float) -> tuple[float, float]:
    """Return the point of a piece's line or circle with outward
    normal u; on a line it is the foot of the point (x, y).
    """
    if row[IS_ARC] != 0.0:
        return row[X] + row[SIGN] * row[RADIUS] * ux, row[Y] + row[SIGN] * row[RADIUS] * uy
    d = (row[X] - x) * ux + (row[Y] - y) * uy
    return x + d * ux, y + d * uy


def pair_antipodal_pieces(rows: Array, a: int, b: int) -> list[AntipodalContacts]:
    """Return the antipodal contacts of the pieces a and b; none for two lines."""
    one, two = rows[a], rows[b]
    if one[IS_ARC] == 0.0 and two[IS_ARC] == 0.0:
        return []
    if one[IS_ARC] == 0.0:
        ways = [(-one[AXIS_Y], one[AXIS_X])]
    elif two[IS_ARC] == 0.0:
        ways = [(two[AXIS_Y], -two[AXIS_X])]
    else:
        ways = list_directions_between(two[X] - one[X], two[Y] - one[Y])
    found = []
    for ux, uy in ways:
        if one[IS_ARC] != 0.0:
            p = find_place_with_normal(one, -ux, -uy, 0.0, 0.0)
            q = find_place_with_normal(two, ux, uy, *p)
        else:
            q = find_place_with_normal(two, ux, uy, 0.0, 0.0)
            p = find_place_with_normal(one, ux, uy, *q)
        d = (q[0] - p[0]) * ux + (q[1] - p[1]) * uy
        if abs(d) > SHORTEST and contains(one, *p) and contains(two, *q):
            found.append(AntipodalContacts(((a,), (b,)), p, q, d, (bend(one), bend(two))))
    return found


def find_antipodal_in_pocket(boundary: ObstacleBoundary, pocket: int, b: int) -> list[AntipodalContacts]:
    """Return the antipodal contacts of a pocket and piece b: normals of b that press a peg into the
    pocket.
    """
    row, (x, y) = boundary.rows[b], boundary.pockets[pocket, :2].tolist()
    ways = (
        [(row[AXIS_Y], -row[AXIS_X])]
        if row[IS_ARC] == 0.0
        else list_directions_between(row[X] - x, row[Y] - y)
    )
    found = []
    for ux, uy in ways:
        q = find_place_with_normal(row, ux, uy, x, y)
        d = (q[0] - x) * ux + (q[1] - y) * uy
        if abs(d) > SHORTEST and contains(row, *q) and holds(boundary.pockets[pocket], -ux, -uy):
            found.append(
                AntipodalContacts(
                    (list_pocket_pieces(boundary, pocket), (b,)), (x, y), q, d, (None, bend(row))
                )
            )
    return found


def list_directions_between(x: float, y: float) -> list[tuple[float, float]]:
    """Return the unit vectors along (x, y) and against it; an empty list where its length is about 0."""
    size = hypot(x, y)
    return [] if size < SHORTEST / 10.0 else [(x / size, y / size), (-x / size, -y / size)]


def find_antipodal_candidates(boundary: ObstacleBoundary, pattern: Pattern) -> Array:
    """Return candidates (N, 24) of one peg of each jaw on antipodal
    contacts, with the direction in which S falls.

    Where S falls in two directions, the second derivative is NaN. S is the jaw separation in mm. See
    ``kernels.seating.columns`` for the layout of candidates.
    """
    out, pegs, right = [], pattern.pegs.tolist(), pattern.right.tolist()
    for i, j in product(range(len(pegs)), repeat=2):
        if not right[i] < right[j]:
            continue
        run, rise = pegs[j][0] - pegs[i][0], pegs[j][1] - pegs[i][1]
        least = abs(rise) * (1.0 + 1e-12)
        for normal in boundary.find_once(find_antipodal_contacts):
            if abs(normal.length) <= least:
                continue
            omega = asin(rise / normal.length)
            separation = normal.length * cos(omega) - run
            if pattern.is_reachable(separation):
                out.append(make_pressed_candidate(pattern, normal, i, j, omega, separation))
    return np.array(out).reshape(-1, CANDIDATE_LENGTH)


def make_pressed_candidate(
    pattern: Pattern, normal: AntipodalContacts, i: int, j: int, omega: float, separation: float
) -> Array:
    """Return the candidate (24,) of pegs i and j on antipodal contacts.

    ``omega`` is the angle in radians of the line of contacts in the closing frame, ``separation`` S in mm.
    See ``kernels.seating.columns`` for the layout of candidates.
    """
    (px, py), (qx, qy), d = normal.one, normal.two, normal.length
    theta = omega - atan2((qy - py) / d, (qx - px) / d)
    c, s = cos(theta), sin(theta)
    rx, ry = c * px - s * py, s * px + c * py
    contacts = [(peg, piece) for peg, pieces in zip((i, j), normal.pieces, strict=True) for piece in pieces]
    place = pattern.pegs[i, 0] - rx, pattern.pegs[i, 1] - ry
    row = make_candidate((theta, *place, separation), contacts)
    second, along_one, along_two = normal.descent_direction
    row[SECOND] = second
    # Both places go along the same way, square to the line; the part turns against the chord.
    turn = -(along_two - along_one) / d
    wx, wy = -sin(omega) * along_one, cos(omega) * along_one
    row[MOTION], row[MOTION + 1], row[MOTION + 2] = turn, turn * ry - wx, -turn * rx - wy
    return row


def find_parallel_candidates(boundary: ObstacleBoundary, pattern: Pattern, given: HeldPart) -> list[Array]:
    """Return arrays of candidates (N, 24) of two pegs of a jaw on a
    line and an arc, with a third peg on a parallel line.

    There is an array for each ordered pair of pegs with such candidates. The third line may be the first line
    itself. See ``kernels.seating.columns`` for the layout of candidates.
    """
    out, pegs, right = [], pattern.pegs.tolist(), pattern.right.tolist()
    for i, j in permutations(range(len(pegs)), 2):
        if right[i] != right[j]:
            continue
        chords = find_chord_tangencies(
            boundary, hypot(pegs[j][0] - pegs[i][0], pegs[j][1] - pegs[i][1]), right[i]
        )
        if len(chords):
            reach = chords, pattern.stop, pattern.widest, given
            out.append(fill_rows(CANDIDATE_LENGTH, 256, write_at_tangencies, i, j, *reach))
    return out


def find_chord_tangencies(boundary: ObstacleBoundary, d: float, jaw: int) -> Array:
    """Return the tangencies (C, 5) of chords of length d mm, for pegs of a jaw; kept with the boundary.

    See ``kernels.seating.parallel_and_concentric`` for the columns.
    """
    known, key = boundary.find_once(make_tangency_cache), (round(d, 9), jaw)
    if key not in known:
        first, end = boundary.parts[jaw].tolist()
        known[key] = fill_rows(ALPHA + 1, 256, write_tangent_chords, boundary.pieces, first, end, d)
    return known[key]


def make_tangency_cache(_: ObstacleBoundary) -> dict[tuple[float, int], Array]:
    """Return an empty cache of the tangencies on a part, by length of the chord and jaw."""
    return {}
