"""Two pegs that press a part along one line: on a common normal of two pieces, or in pockets. All in closed form.

With both pegs on one line and at a fixed height above each other, the jaw separation grows with their distance d on the
part, counted along the outward normal of what moves: below 0 where both press from between, as in a hole. So equilibria are
those of d over the places on both pieces. With curvatures kappa (of convex pieces above 0) the second derivatives of d are
1 / d - kappa along each piece, and -1 / d across.
"""

from __future__ import annotations

from functools import cached_property
from itertools import product
from math import asin, atan2, cos, hypot, nan, sin

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CONTACTS,
    MOTION,
    PEG,
    PIECE,
    PLACE_X,
    PLACE_Y,
    SECOND,
    SEPARATION,
    THETA,
)
from workhold.seating.locus import Locus, contains
from workhold.seating.pattern import Pattern

__all__ = ["CommonNormal", "common_normals", "squeezed"]

Array = NDArray[np.float64]
# mm. Shorter distances are none.
SHORTEST = 1e-6
# No unit. A force's share below this is none; normals with a smaller cross product make no cone.
LEAST_SHARE = 1e-9
# No unit. Second derivatives below this, times d, are flat.
FLAT = 1e-9


@frozen(slots=False)
class CommonNormal:
    """Two places on the boundary with opposite normals, each on the other's.

    Parameters
    ----------
    pieces : of each place what a peg there touches: one piece, or the two of a pocket.
    one, two : places about the centre, in mm.
    length : their distance along the outward normal of the second, below 0 where the normals point at each other.
    curvatures : of the pieces, in 1 / mm; None of a pocket.
    """

    pieces: tuple[tuple[int, ...], tuple[int, ...]]
    one: tuple[float, float]
    two: tuple[float, float]
    length: float
    curvatures: tuple[float | None, float | None]

    @cached_property
    def way_down(self) -> tuple[float, float, float]:
        """The least second derivative of d in 1 / mm, and the way along both pieces that has it; NaN where both are
        below 0."""
        d, (one, two) = self.length, self.curvatures
        if one is None or two is None:
            if one is None and two is None:
                return 0.0, 0.0, 0.0
            return 1.0 / d - (one or 0.0) - (two or 0.0), float(one is not None), float(two is not None)
        values, ways = np.linalg.eigh([[1.0 / d - one, -1.0 / d], [-1.0 / d, 1.0 / d - two]])
        return (float(values[0]) if values[1] * abs(d) > FLAT else nan), float(ways[0, 0]), float(ways[1, 0])

    @property
    def turned(self) -> CommonNormal:
        """The same with the places exchanged."""
        return CommonNormal(self.pieces[::-1], self.two, self.one, self.length, self.curvatures[::-1])


def common_normals(locus: Locus) -> list[CommonNormal]:
    """All common normals of a part from pegs that stand still to those that move; those of parallel lines and concentric
    arcs, which are many, left out."""
    standing, moving = range(*locus.parts[0]), range(*locus.parts[1])
    found = [normal for a, b in product(standing, moving) for normal in of_pieces(locus.rows, a, b)]
    for v, (piece, _) in enumerate(locus.pocket_pieces.tolist()):
        if piece in standing:
            found += [normal for b in moving for normal in of_pocket(locus, v, b)]
        if piece in moving:
            found += [normal.turned for a in standing for normal in of_pocket(locus, v, a)]
    for v, w in product(range(len(locus.pockets)), repeat=2):
        if locus.pocket_pieces[v, 0] not in standing or locus.pocket_pieces[w, 0] not in moving:
            continue
        (vx, vy), (wx, wy) = locus.pockets[v, :2], locus.pockets[w, :2]
        d = hypot(wx - vx, wy - vy)
        for signed in (d, -d) if d > SHORTEST else ():
            ux, uy = (wx - vx) / signed, (wy - vy) / signed
            if holds(locus.pockets[v], -ux, -uy) and holds(locus.pockets[w], ux, uy):
                pieces = pocket_pieces(locus, v), pocket_pieces(locus, w)
                found.append(CommonNormal(pieces, (vx, vy), (wx, wy), signed, (None, None)))
    return found


def pocket_pieces(locus: Locus, pocket: int) -> tuple[int, ...]:
    """The two pieces of a pocket."""
    return tuple(locus.pocket_pieces[pocket].tolist())


def holds(pocket: Array, x: float, y: float) -> bool:
    """Whether a direction lies between the two normals of a pocket."""
    ax, ay, bx, by = pocket[2:6].tolist()
    cross = ax * by - ay * bx
    if abs(cross) < LEAST_SHARE:
        return False
    return bool((x * by - y * bx) / cross > LEAST_SHARE and (ax * y - ay * x) / cross > LEAST_SHARE)


def bend(row: Array) -> float:
    """Curvature of a piece in 1 / mm, above 0 where it is convex."""
    return 0.0 if row[IS_ARC] == 0.0 else float(row[SIGN] / row[RADIUS])


def reached(row: Array, ux: float, uy: float, x: float, y: float) -> tuple[float, float]:
    """The place of a piece's carrier with normal u: of an arc its own, of a line the one that a point has on it."""
    if row[IS_ARC] != 0.0:
        return row[X] + row[SIGN] * row[RADIUS] * ux, row[Y] + row[SIGN] * row[RADIUS] * uy
    d = (row[X] - x) * ux + (row[Y] - y) * uy
    return x + d * ux, y + d * uy


def of_pieces(rows: Array, a: int, b: int) -> list[CommonNormal]:
    """The common normals from piece a to piece b."""
    one, two = rows[a], rows[b]
    if one[IS_ARC] == 0.0 and two[IS_ARC] == 0.0:
        return []
    if one[IS_ARC] == 0.0:
        ways = [(-one[AXIS_Y], one[AXIS_X])]
    elif two[IS_ARC] == 0.0:
        ways = [(two[AXIS_Y], -two[AXIS_X])]
    else:
        ways = between(two[X] - one[X], two[Y] - one[Y])
    found = []
    for ux, uy in ways:
        if one[IS_ARC] != 0.0:
            p = reached(one, -ux, -uy, 0.0, 0.0)
            q = reached(two, ux, uy, *p)
        else:
            q = reached(two, ux, uy, 0.0, 0.0)
            p = reached(one, ux, uy, *q)
        d = (q[0] - p[0]) * ux + (q[1] - p[1]) * uy
        if abs(d) > SHORTEST and contains(one, *p) and contains(two, *q):
            found.append(CommonNormal(((a,), (b,)), p, q, d, (bend(one), bend(two))))
    return found


def of_pocket(locus: Locus, pocket: int, b: int) -> list[CommonNormal]:
    """The normals of piece b through a pocket that press a peg into it."""
    row, (x, y) = locus.rows[b], locus.pockets[pocket, :2].tolist()
    ways = [(row[AXIS_Y], -row[AXIS_X])] if row[IS_ARC] == 0.0 else between(row[X] - x, row[Y] - y)
    found = []
    for ux, uy in ways:
        q = reached(row, ux, uy, x, y)
        d = (q[0] - x) * ux + (q[1] - y) * uy
        if abs(d) > SHORTEST and contains(row, *q) and holds(locus.pockets[pocket], -ux, -uy):
            found.append(CommonNormal((pocket_pieces(locus, pocket), (b,)), (x, y), q, d, (None, bend(row))))
    return found


def between(x: float, y: float) -> list[tuple[float, float]]:
    """Both directions of a line between two points, none of one point."""
    size = hypot(x, y)
    return [] if size < SHORTEST / 10.0 else [(x / size, y / size), (-x / size, -y / size)]


def squeezed(locus: Locus, pattern: Pattern) -> list[Array]:
    """Candidates of a left and a right peg on a common normal, with the direction in which the separation falls, if there is
    one; where there are two, the second derivative is not told."""
    out, pegs, right = [], pattern.pegs.tolist(), pattern.right.tolist()
    for i, j in product(range(len(pegs)), repeat=2):
        if not right[i] < right[j]:
            continue
        run, rise = pegs[j][0] - pegs[i][0], pegs[j][1] - pegs[i][1]
        least = abs(rise) * (1.0 + 1e-12)
        for normal in locus.once(common_normals):
            if abs(normal.length) <= least:
                continue
            omega = asin(rise / normal.length)
            separation = normal.length * cos(omega) - run
            if pattern.reaches(separation):
                out.append(pressed(pattern, normal, i, j, omega, separation))
    return out


def pressed(pattern: Pattern, normal: CommonNormal, i: int, j: int, omega: float, separation: float) -> Array:
    """The candidate of one common normal, pressed by peg i and peg j in direction omega."""
    (px, py), (qx, qy), d = normal.one, normal.two, normal.length
    theta = omega - atan2((qy - py) / d, (qx - px) / d)
    c, s = cos(theta), sin(theta)
    rx, ry = c * px - s * py, s * px + c * py
    row = np.zeros(CANDIDATE_LENGTH)
    row[THETA], row[PLACE_X], row[PLACE_Y] = theta, pattern.pegs[i, 0] - rx, pattern.pegs[i, 1] - ry
    row[SEPARATION] = separation
    contacts = [(peg, piece) for peg, pieces in zip((i, j), normal.pieces, strict=True) for piece in pieces]
    row[CONTACTS] = len(contacts)
    row[PEG : PEG + 4], row[PIECE : PIECE + 4] = -1.0, -1.0
    for at, (peg, piece) in enumerate(contacts):
        row[PEG + at], row[PIECE + at] = peg, piece
    second, along_one, along_two = normal.way_down
    row[SECOND] = second
    # Both places go along the same way, square to the line; the part turns against the chord.
    turn = -(along_two - along_one) / d
    wx, wy = -sin(omega) * along_one, cos(omega) * along_one
    row[MOTION], row[MOTION + 1], row[MOTION + 2] = turn, turn * ry - wx, -turn * rx - wy
    return row
