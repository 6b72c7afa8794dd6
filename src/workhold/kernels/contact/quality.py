"""Figures of quality of whole tables of fixtures (model: "Quality"), and peg forces under loads.

A load row (11,) holds the force in N, the point it acts at (x, y) about c in mm, and the moment in N mm. Then
follow cosine and sine of the first and last direction and of the middle one, and the cosine of half the range
(-1 for any direction).

Forces are linear in (cosine, sine) of the load's direction, so each is a sinusoid. Its largest value over a
range is its amplitude if the peak lies in the range, and the larger of the values at the ends if not.

See ``contact_matrix`` for the matrices.
"""

from __future__ import annotations

from math import hypot, inf, sqrt

import numpy as np

from workhold.kernels.base.compiling import (
    Array,
    IntArray,
    IntMatrix,
    Matrix,
    Stack,
    Vector,
    compiled,
    inner,
)

FORCE, POINT_X, POINT_Y, MOMENT, LOW_X, LOW_Y, HIGH_X, HIGH_Y, MIDDLE_X, MIDDLE_Y, HALF = range(11)
LOAD_LENGTH = 11


@inner
def find_largest_value(x: float, y: float, load: Array) -> float:
    """Return the largest value of x cos t + y sin t over the range of directions t of a load row (11,).

    See ``contact.quality`` for the layout of ``load``.
    """
    size = hypot(x, y)
    if x * load[MIDDLE_X] + y * load[MIDDLE_Y] >= size * load[HALF]:
        return size
    return max(x * load[LOW_X] + y * load[LOW_Y], x * load[HIGH_X] + y * load[HIGH_Y])


@inner
def find_largest_reaction(inverse: Array, length: float, loads: Array) -> float:
    """Return the largest peg force in N over all loads, each resisted with the least clamping force that
    suffices.

    Clamping suffices when no peg force is negative. Forces that balance a load are f = f0 + k lambda for any
    k. The smallest k without a negative force is the largest of -f0_i / lambda_i, so f_j is the largest over
    i of f0_j - f0_i lambda_j / lambda_i. This is a sinusoid in the load's direction for each i. Ranking by
    this force: R. C. Brost, K. Y. Goldberg, *A complete algorithm for designing planar fixtures using modular
    components*, IEEE Transactions on Robotics and Automation 12 (1996). See ``contact.quality`` for the
    layout of ``loads``.

    Parameters
    ----------
    inverse : (4, P) of the contact matrix, see ``kernels.contact.contact_matrix``.
    length : L in mm, by which moments are divided.
    loads : (M, 11) rows; the result is 0 where M is 0.
    """
    most = 0.0
    for m in range(len(loads)):
        load = loads[m]
        force, moment = load[FORCE], load[MOMENT] / length
        px, py = load[POINT_X] / length, load[POINT_Y] / length
        for j in range(inverse.shape[1]):
            for i in range(inverse.shape[1]):
                if i != j:
                    ratio = inverse[3, j] / inverse[3, i]
                    a = inverse[0, j] - ratio * inverse[0, i]
                    b = inverse[1, j] - ratio * inverse[1, i]
                    c = inverse[2, j] - ratio * inverse[2, i]
                    most = max(most, moment * c + force * find_largest_value(a - py * c, b + px * c, load))
    return most


# No unit. Wrenches nearer than this to a plane are on it; three with a smaller cross product are on a line.
FLAT = 1e-12
# A bound of a movement is rounded by less than this.
SURELY = 1.0 + 1e-12


@inner
def compute_moment(points: Array, normals: Array, k: int, length: float) -> float:
    """Return the third component of wrench k: the moment of normal k
    at point k about the part's centre, over L; no unit.

    ``points`` (4 or 5, 2) are about the centre in mm, ``length`` is L in mm, by which moments are divided.
    """
    return (points[k, 0] * normals[k, 1] - points[k, 1] * normals[k, 0]) / length


@inner
def measure_plane_distance(points: Array, normals: Array, length: float, a: int, b: int, c: int) -> float:
    """Return the distance from the origin to the plane through wrenches a, b and c, if a facet of their hull
    lies in it.

    The hull is the convex hull of all five wrenches. Return inf where no facet lies in the plane, or where
    the three wrenches lie on a line. ``points`` and ``normals`` are (5, 2), a, b and c are indices.
    """
    ax, ay, az = normals[a, 0], normals[a, 1], compute_moment(points, normals, a, length)
    ux, uy, uz = normals[b, 0] - ax, normals[b, 1] - ay, compute_moment(points, normals, b, length) - az
    vx, vy, vz = normals[c, 0] - ax, normals[c, 1] - ay, compute_moment(points, normals, c, length) - az
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    size = sqrt(nx * nx + ny * ny + nz * nz)
    if size < FLAT:
        return inf
    low, high = 0.0, 0.0
    for k in range(5):
        if k != a and k != b and k != c:
            dx, dy, dz = (
                normals[k, 0] - ax,
                normals[k, 1] - ay,
                compute_moment(points, normals, k, length) - az,
            )
            side = (nx * dx + ny * dy + nz * dz) / size
            low, high = min(low, side), max(high, side)
    return abs(nx * ax + ny * ay + nz * az) / size if low > -FLAT or high < FLAT else inf


@inner
def compute_wrench_radius_of_five(points: Array, normals: Array, length: float) -> float:
    """Return the distance from the origin to the nearest facet plane of the convex hull of five wrenches; no
    unit.

    Arguments are those of :func:`compute_wrench_radius` with five rows.
    """
    least = inf
    for a in range(5):
        for b in range(a + 1, 5):
            for c in range(b + 1, 5):
                least = min(least, measure_plane_distance(points, normals, length, a, b, c))
    return least


@inner
def compute_wrench_radius(points: Array, normals: Array, length: float) -> float:
    """Return the distance from the origin to the nearest facet plane
    of the tetrahedron of four wrenches; no unit.

    A wrench is (n, q x n / L). For pegs in force closure the distance is the largest norm up to which every
    load is resisted by peg forces with sum 1; elsewhere it has no such meaning.

    Reference: C. Ferrari, J. Canny, *Planning optimal grasps*, IEEE ICRA (1992).

    Parameters
    ----------
    points : (4, 2) peg centres or contact points about c in mm (both lie on the lines of action).
    normals : (4, 2) outward unit normals.
    length : L in mm, by which moments are divided.
    """
    least = inf
    for k in range(4):
        a, b, c = (k + 1) % 4, (k + 2) % 4, (k + 3) % 4
        ax, ay = normals[a, 0], normals[a, 1]
        az = (points[a, 0] * ay - points[a, 1] * ax) / length
        ux, uy = normals[b, 0] - ax, normals[b, 1] - ay
        uz = (points[b, 0] * normals[b, 1] - points[b, 1] * normals[b, 0]) / length - az
        vx, vy = normals[c, 0] - ax, normals[c, 1] - ay
        vz = (points[c, 0] * normals[c, 1] - points[c, 1] * normals[c, 0]) / length - az
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        least = min(least, abs(nx * ax + ny * ay + nz * az) / sqrt(nx * nx + ny * ny + nz * nz))
    return least


@inner
def write_generators(inverse: Array, faces: IntArray, peg: float, face: float, out: Array) -> int:
    """Write the part's movement for each independent error, as large as its tolerance, to ``out``; return
    their number.

    ``out`` (10, 3) has the columns x and y in mm and turn times L. Each movement may have either sign. A face
    that one peg touches adds its tolerance to the peg's; a face that several pegs touch moves them alike, as
    one error.

    Parameters
    ----------
    inverse : (4, P) of the contact matrix.
    faces : (P,) number of the face that each peg touches.
    peg, face : tolerances in mm.
    """
    count = 0
    pegs = inverse.shape[1]
    for i in range(pegs):
        sharing, first = 0, True
        for j in range(pegs):
            if faces[j] == faces[i]:
                sharing += 1
                first = first and j >= i
        if sharing > 1 and first:
            for m in range(3):
                out[count, m] = 0.0
                for j in range(pegs):
                    if faces[j] == faces[i]:
                        out[count, m] += face * inverse[m, j]
            count += 1
        own = peg if sharing > 1 else peg + face
        for m in range(3):
            out[count, m] = own * inverse[m, i]
        count += 1
    return count


@inner
def find_farthest_movement(vx: float, vy: float, turn: float, corners: Array, arcs: Array) -> float:
    """Return the largest movement in mm of a point of the silhouette, to first order.

    A point q about c moves by v + turn (-q_y, q_x). On an arc with centre m and radius r the point that moves
    most lies in the direction in which the turn adds to the centre's movement. It moves by |v(m)| + r |turn|.

    Parameters
    ----------
    vx, vy : movement of c in mm.
    turn : in radians.
    corners : (C, 2) corners of the silhouette about c, in mm.
    arcs : (A, 6) its convex arcs: centre about c (x, y) and radius in mm, unit vector from the centre to the
        middle (x, y), cosine of half the sweep.
    """
    most = 0.0
    for k in range(len(corners)):
        x, y = vx - turn * corners[k, 1], vy + turn * corners[k, 0]
        most = max(most, x * x + y * y)
    most = sqrt(most)
    for k in range(len(arcs)):
        x, y = vx - turn * arcs[k, 1], vy + turn * arcs[k, 0]
        speed = hypot(x, y)
        moved = speed + abs(turn) * arcs[k, 2]
        if moved > most:
            # The direction d with turn (-d_y, d_x) along (x, y), of length ``speed``.
            side = 1.0 if turn > 0.0 else -1.0
            if side * (y * arcs[k, 3] - x * arcs[k, 4]) >= speed * arcs[k, 5]:
                most = moved
    return most


@inner
def compute_location_error(
    inverse: Array,
    faces: IntArray,
    length: float,
    tolerances: Array,
    corners: Array,
    arcs: Array,
    farthest: float,
    work: Array,
) -> float:
    """Return the largest movement in mm of a point of the silhouette
    when pegs and faces are off by their tolerances.

    Movement is a convex function of the errors, so it is largest at a corner of their box, and opposite
    corners move alike. No point moves farther than c does plus the turn times the point's distance from c.
    That excludes most corners of the box, once the corner at which all errors turn the part the same way has
    been evaluated.

    Parameters
    ----------
    inverse : (4, P) of the contact matrix.
    faces : (P,) number of the face that each peg touches.
    length : L in mm, by which moments are divided.
    tolerances : (2,) of a peg and of a face, in mm.
    corners, arcs : see :func:`find_farthest_movement`.
    farthest : see :func:`measure_farthest_point`.
    work : (10, 3) work space.
    """
    count = write_generators(inverse, faces, tolerances[0], tolerances[1], work)
    first = int(np.int64(0))
    for m in range(count - 1):
        if work[m, 2] * work[count - 1, 2] > 0.0:
            first |= 1 << m
    worst = 0.0
    for number in range(1 << (count - 1)):
        signs = number ^ first
        x, y, turn = work[count - 1, 0], work[count - 1, 1], work[count - 1, 2]
        for m in range(count - 1):
            sign = 1.0 if (signs >> m) & 1 else -1.0
            x += sign * work[m, 0]
            y += sign * work[m, 1]
            turn += sign * work[m, 2]
        turn /= length
        if not SURELY * (sqrt(x * x + y * y) + abs(turn) * farthest) <= worst:
            worst = max(worst, find_farthest_movement(x, y, turn, corners, arcs))
    return worst


@inner
def measure_farthest_point(corners: Array, arcs: Array) -> float:
    """Return an upper bound in mm of the distance from c to any point of the silhouette.

    See :func:`find_farthest_movement` for ``corners`` and ``arcs``.
    """
    most = 0.0
    for k in range(len(corners)):
        most = max(most, hypot(corners[k, 0], corners[k, 1]))
    for k in range(len(arcs)):
        most = max(most, hypot(arcs[k, 0], arcs[k, 1]) + arcs[k, 2])
    return most


@compiled
def write_figures(
    points: Stack,
    normals: Stack,
    ends: Matrix,
    edges: Matrix,
    inverses: Stack,
    faces: IntMatrix,
    length: float,
    tolerances: Vector,
    corners: Matrix,
    arcs: Matrix,
    loads: Matrix,
    out: Matrix,
    work: Matrix,
) -> None:
    """Write the figures of quality of N fixtures to the first seven columns of ``out``.

    Columns: closure margin, clamp amplification (largest peg force per unit of clamping force), wrench
    radius, location error in mm, end distance in mm, load reaction in N, edge distance in mm (``length`` at
    most).

    Parameters
    ----------
    points, normals, ends, edges, inverses : see ``kernels.contact.contact_matrix.write_contact_matrices``.
    faces : (N, P) number of the face that each peg touches; P is 4, or 5 with two clamps.
    length, tolerances, corners, arcs : see :func:`compute_location_error`.
    loads : (M, 11) rows, see ``kernels.contact.quality``.
    out : (N, 7 or more) receives the figures; NaN for the load reaction without loads, and for all where the
        contact matrix has no inverse.
    work : (10, 3) work space.
    """
    farthest = measure_farthest_point(corners, arcs)
    for k in range(len(points)):
        inverse = inverses[k]
        # The last row of the inverse: peg forces per unit of clamping force, as in the null vector.
        total, least, most = 0.0, inf, 0.0
        nearest, edge = inf, length
        for i in range(inverse.shape[1]):
            force = inverse[3, i]
            total += force
            least, most = min(least, force), max(most, force)
            nearest, edge = min(nearest, ends[k, i]), min(edge, edges[k, i])
        known = total == total
        out[k, 0] = least / total if known else np.nan
        out[k, 1] = most if known else np.nan
        out[k, 2] = np.nan
        if known and inverse.shape[1] == 4:
            out[k, 2] = compute_wrench_radius(points[k], normals[k], length)
        elif known:
            out[k, 2] = compute_wrench_radius_of_five(points[k], normals[k], length)
        out[k, 3] = np.nan
        if known:
            out[k, 3] = compute_location_error(
                inverse, faces[k], length, tolerances, corners, arcs, farthest, work
            )
        out[k, 4] = nearest if known else np.nan
        out[k, 5] = find_largest_reaction(inverse, length, loads) if known and len(loads) > 0 else np.nan
        out[k, 6] = edge if known else np.nan
