"""Pegs that press a part along one line or along parallel lines: equilibria in closed form.

Two pegs press along one line if that line is a common normal of the two boundary pieces that they touch, or
if they sit in pockets. Let one peg be at a fixed height above the other, and let d be the distance between
their places on the part. It is measured along the outward normal at the moving peg, and is negative if both
pegs press outward from inside the part, as in a hole. The jaw separation grows with d. So equilibria are the
critical points of d over the places on both pieces. With the pieces' curvatures kappa (positive where convex)
the second derivatives of d are 1 / d - kappa along each piece, and the mixed one is -1 / d.

Three contacts with parallel normals also balance: two pegs of one jaw on a line and an arc, and a third peg
on a line parallel to the first. Then the chord between the two pegs of the jaw is at a tangency, and its
instant centre is at infinity. The jaw separation S then depends on the orientation alone, because two of the
three contacts lie on parallel lines. The orientation has an extremum along the chord's curve, so S has one
too.

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
    """Two places on a part's boundary whose outward normals are opposite and lie on the line through both
    places.

    Parameters
    ----------
    pieces : for each of the two places, the numbers of the boundary pieces that a peg there touches: one
        number, or two in a pocket (a corner where two pieces meet).
    one, two : the places in mm, relative to the centre of the part's bounding box, in the part's frame.
    length : distance d in mm from the first place to the second, along the second's outward normal; negative
        where the normals point at each other.
    curvatures : curvature of the piece at each place in 1 / mm, positive where convex; None for a pocket.
    """

    pieces: tuple[tuple[int, ...], tuple[int, ...]]
    one: tuple[float, float]
    two: tuple[float, float]
    length: float
    curvatures: tuple[float | None, float | None]

    @cached_property
    def descent_direction(self) -> tuple[float, float, float]:
        """The direction in which the distance d falls fastest as the two contacts move along their pieces.

        Three numbers: the least second derivative of d in 1 / mm, and the components of the unit vector that
        belongs to it, along the first and along the second piece. The derivative is NaN where d falls in all
        directions, and the result is (0, 0, 0) for two pockets, in which nothing can move.
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
        """The same contacts with the first and the second place exchanged."""
        return AntipodalContacts(self.pieces[::-1], self.two, self.one, self.length, self.curvatures[::-1])


def find_antipodal_contacts(boundary: ObstacleBoundary) -> list[AntipodalContacts]:
    """Return all antipodal contacts of a part.

    A fixed peg can stand at the first place, and a peg of the moving jaw or clamp at the second. Two parallel
    lines and two concentric arcs have infinitely many antipodal contacts; those are left out.
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
            if is_direction_in_pocket(boundary.pockets[v], -ux, -uy) and is_direction_in_pocket(
                boundary.pockets[w], ux, uy
            ):
                pieces = list_pocket_pieces(boundary, v), list_pocket_pieces(boundary, w)
                found.append(AntipodalContacts(pieces, (vx, vy), (wx, wy), signed, (None, None)))
    return found


def list_pocket_pieces(boundary: ObstacleBoundary, pocket: int) -> tuple[int, ...]:
    """Return the numbers of the two pieces of a pocket."""
    return tuple(boundary.pocket_pieces[pocket].tolist())


def is_direction_in_pocket(pocket: Array, x: float, y: float) -> bool:
    """Return whether the direction (x, y) lies strictly between the outward normals of a pocket's two pieces.

    ``pocket`` (6,) is a row of ``ObstacleBoundary.pockets``: place, first normal, second normal.
    """
    ax, ay, bx, by = pocket[2:6].tolist()
    cross = ax * by - ay * bx
    if abs(cross) < LEAST_SHARE:
        return False
    return bool((x * by - y * bx) / cross > LEAST_SHARE and (ax * y - ay * x) / cross > LEAST_SHARE)


def compute_curvature(row: Array) -> float:
    """Return the curvature of a piece (10,) in 1 / mm: positive where convex, 0 for a straight piece."""
    return 0.0 if row[IS_ARC] == 0.0 else float(row[SIGN] / row[RADIUS])


def find_place_with_normal(row: Array, ux: float, uy: float, x: float, y: float) -> tuple[float, float]:
    """Return the point (in mm) on the line or circle of a piece at which the outward normal is (ux, uy).

    All points of a line have the same normal: on a line the result is the foot of the perpendicular from (x,
    y). For an arc (x, y) is ignored.
    """
    if row[IS_ARC] != 0.0:
        return row[X] + row[SIGN] * row[RADIUS] * ux, row[Y] + row[SIGN] * row[RADIUS] * uy
    d = (row[X] - x) * ux + (row[Y] - y) * uy
    return x + d * ux, y + d * uy


def pair_antipodal_pieces(rows: Array, a: int, b: int) -> list[AntipodalContacts]:
    """Return the antipodal contacts with the first place on piece a and the second on b; none for two
    lines.
    """
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
            found.append(
                AntipodalContacts(((a,), (b,)), p, q, d, (compute_curvature(one), compute_curvature(two)))
            )
    return found


def find_antipodal_in_pocket(boundary: ObstacleBoundary, pocket: int, b: int) -> list[AntipodalContacts]:
    """Return the antipodal contacts with the first place in a pocket, given by its number, and the second on
    piece b.
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
        if (
            abs(d) > SHORTEST
            and contains(row, *q)
            and is_direction_in_pocket(boundary.pockets[pocket], -ux, -uy)
        ):
            found.append(
                AntipodalContacts(
                    (list_pocket_pieces(boundary, pocket), (b,)), (x, y), q, d, (None, compute_curvature(row))
                )
            )
    return found


def list_directions_between(x: float, y: float) -> list[tuple[float, float]]:
    """Return two unit vectors, along (x, y) and opposite; an empty list where (x, y) is about (0, 0)."""
    size = hypot(x, y)
    return [] if size < SHORTEST / 10.0 else [(x / size, y / size), (-x / size, -y / size)]


def find_antipodal_candidates(boundary: ObstacleBoundary, pattern: Pattern) -> Array:
    """Return candidates (N, 24) in which one peg of each jaw presses on antipodal contacts.

    Each has the least second derivative of the jaw separation S (NaN where S falls in two independent
    directions) and the direction in which S falls. A candidate is a configuration with contacts and forces
    that may be an equilibrium, see ``kernels.seating.columns``.
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
    """Return the candidate (24,) in which pegs i and j touch the two places of antipodal contacts ``normal``.

    ``omega`` is the angle in radians of the line through both places in the closing frame, and ``separation``
    the jaw separation S in mm. A candidate is a configuration with contacts and forces that may be an
    equilibrium, see ``kernels.seating.columns``.
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
    """Return candidates in which all three contact normals are parallel, as a list of arrays (N, 24).

    Two pegs of one jaw touch a line and an arc; a third peg touches a line parallel to that line, or the same
    line. The list has one array for each ordered pair of pegs of a jaw that fits the part. A candidate is a
    configuration with contacts and forces that may be an equilibrium, see ``kernels.seating.columns``.
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
    """Return the tangencies (C, 5) of chords of length d mm between two pegs of jaw 0 (fixed) or 1 (moving).

    At a tangency a chord from a line to an arc has the same normal at both ends. The table is computed once
    and kept with the boundary. See ``kernels.seating.parallel_and_concentric`` for the columns.
    """
    known, key = boundary.find_once(make_tangency_cache), (round(d, 9), jaw)
    if key not in known:
        first, end = boundary.parts[jaw].tolist()
        known[key] = fill_rows(ALPHA + 1, 256, write_tangent_chords, boundary.pieces, first, end, d)
    return known[key]


def make_tangency_cache(_: ObstacleBoundary) -> dict[tuple[float, int], Array]:
    """Return an empty cache of tangencies on a part; its keys are (chord length in mm, jaw). The argument is
    ignored.
    """
    return {}
