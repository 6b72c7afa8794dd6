"""The least friction at which three of four contacts balance a jaw, see ``seating.clamping``.

A contact's wrench is a force and its moment, along the normal into the part (straight) and along the tangent
(across): (4, 3) of each. With signs s of its tangents, three contacts at the edges of their cones balance
where det(straight + mu s across) = 0, a cubic in mu.
"""

from __future__ import annotations

from math import copysign, hypot, inf, sqrt

from workhold.kernels.base.arrays import write_inverse
from workhold.kernels.base.compiling import (
    Array,
    IntArray,
    IntVector,
    Matrix,
    compiled,
    inner,
)

Cubic = tuple[float, float, float, float]

# No unit. Coefficients of a cubic, per the largest, that are none, and all of them; and how far, per 1 +
# |root|, two complex roots are apart that are counted as one that is real.
NO_COEFFICIENT, NO_CUBIC, APART = 1e-13, 1e-14, 1e-7
# No unit. Forces are above minus the first, none on the jaw; vectors below the second have no direction.
PULLS, NO_FORCE = 1e-9, 1e-12
# Determinants that are none. A share by which less friction is less, and how often it is halved.
SINGULAR, LESS, HALVINGS = 1e-14, 1e-7, 60
# How often a range with a root is cut at most.
MOST_CUTS = 200


@inner
def compute_determinant(a: Array, b: Array, c: Array) -> float:
    """Return the determinant of the 3x3 matrix with rows a, b and c."""
    return (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )


@inner
def make_cubic(
    straight: Array, across: Array, i: int, j: int, k: int, si: float, sj: float, sk: float
) -> Cubic:
    """Return the coefficients of det(straight + mu s across) of
    contacts i, j, k as a cubic in mu, the constant first.

    ``si``, ``sj``, ``sk`` are the signs s. Coefficients within rounding of 0 are set to 0.
    """
    a, b, c, d, e, f = straight[i], straight[j], straight[k], across[i], across[j], across[k]
    zero, three = compute_determinant(a, b, c), si * sj * sk * compute_determinant(d, e, f)
    one = (
        si * compute_determinant(d, b, c)
        + sj * compute_determinant(a, e, c)
        + sk * compute_determinant(a, b, f)
    )
    two = (
        si * sj * compute_determinant(d, e, c)
        + si * sk * compute_determinant(d, b, f)
        + sj * sk * compute_determinant(a, e, f)
    )
    size = max(abs(zero), abs(one), abs(two), abs(three))
    least = NO_COEFFICIENT * size if size >= NO_CUBIC else inf
    return (
        zero if abs(zero) >= least else 0.0,
        one if abs(one) >= least else 0.0,
        two if abs(two) >= least else 0.0,
        three if abs(three) >= least else 0.0,
    )


@inner
def evaluate_cubic(p: Cubic, x: float) -> float:
    """Return the value of a cubic at x; coefficients begin with the constant."""
    return p[0] + x * (p[1] + x * (p[2] + x * p[3]))


@inner
def find_turning_points(p: Cubic) -> tuple[float, float]:
    """Return the two zeros of a cubic's derivative in ascending order, inf for those that do not exist."""
    a, b, c = 3.0 * p[3], 2.0 * p[2], p[1]
    if a == 0.0:
        return (-c / b, inf) if b != 0.0 else (inf, inf)
    square = b * b - 4.0 * a * c
    if square < 0.0:
        return (inf, inf)
    q = -(b + copysign(sqrt(square), b)) / 2.0
    one, two = q / a, c / q if q != 0.0 else 0.0
    return (min(one, two), max(one, two))


@inner
def find_root_between(p: Cubic, low: float, high: float) -> float:
    """Return the root of a cubic in [low, high], where it must be monotone and change its sign."""
    falls = evaluate_cubic(p, low) > 0.0
    x = (low + high) / 2.0
    for _ in range(MOST_CUTS):
        value = evaluate_cubic(p, x)
        if (value > 0.0) == falls:
            low = x
        else:
            high = x
        slope = p[1] + x * (2.0 * p[2] + 3.0 * x * p[3])
        before = x
        x = x - value / slope if slope != 0.0 else low
        if not low < x < high:
            x = (low + high) / 2.0
        if abs(x - before) <= 1e-16 * (1.0 + abs(x)) or value == 0.0:
            return before
    return x


@inner
def are_pressing(
    straight: Array, across: Array, right: IntArray, i: int, j: int, k: int, fi: float, fj: float, fk: float
) -> bool:
    """Return whether three contacts i, j, k balance with non-negative forces that close the jaw, at edges of
    their cones.

    ``fi``, ``fj``, ``fk`` are signed friction coefficients, which must make the three wrenches linearly
    dependent. See ``seating.sticking`` for ``straight`` and ``across``; ``right`` is 1 for contacts of the
    jaw that moves.
    """
    h0, h1, h2, size = 0.0, 0.0, 0.0, 0.0
    for way in range(3):
        # Forces are square to two of the three components, of the two that are largest.
        m, n = (0 if way != 1 else 1), (1 if way == 0 else 2)
        ai, bi = straight[i, m] + fi * across[i, m], straight[i, n] + fi * across[i, n]
        aj, bj = straight[j, m] + fj * across[j, m], straight[j, n] + fj * across[j, n]
        ak, bk = straight[k, m] + fk * across[k, m], straight[k, n] + fk * across[k, n]
        ci, cj, ck = aj * bk - ak * bj, ak * bi - ai * bk, ai * bj - aj * bi
        most = max(abs(ci), abs(cj), abs(ck))
        if most > size:
            h0, h1, h2, size = ci, cj, ck, most
    if size < NO_FORCE:
        return False
    if (h0 < 0.0) + (h1 < 0.0) + (h2 < 0.0) > (h0 > 0.0) + (h1 > 0.0) + (h2 > 0.0):
        size = -size
    h0, h1, h2 = h0 / size, h1 / size, h2 / size
    on_jaw = h0 * right[i] * (straight[i, 0] + fi * across[i, 0])
    on_jaw += h1 * right[j] * (straight[j, 0] + fj * across[j, 0])
    on_jaw += h2 * right[k] * (straight[k, 0] + fk * across[k, 0])
    return min(h0, h1, h2) >= -PULLS and on_jaw < -PULLS


@inner
def find_friction_of_three(
    straight: Array, across: Array, right: IntArray, left_out: int, least: float
) -> float:
    """Return the least friction coefficient at which all contacts except ``left_out`` balance, each at an
    edge of its cone.

    Return ``least`` where there is none below ``least``.
    """
    i, j, k = (1 if left_out == 0 else 0), (2 if left_out <= 1 else 1), (3 if left_out <= 2 else 2)
    for signs in range(8):
        si, sj, sk = 1.0 - 2.0 * (signs & 1), 1.0 - 2.0 * (signs >> 1 & 1), 1.0 - 2.0 * (signs >> 2)
        p = make_cubic(straight, across, i, j, k, si, sj, sk)
        if p[0] == 0.0 and p[1] == 0.0 and p[2] == 0.0 and p[3] == 0.0:
            continue
        one, two = find_turning_points(p)
        low = 0.0
        for part in range(3):
            end = one if part == 0 else two if part == 1 else inf
            high = min(end, least)
            if high <= low:
                continue
            if high == inf:
                # No root is beyond (A.-L. Cauchy).
                lead = p[3] if p[3] != 0.0 else p[2] if p[2] != 0.0 else p[1]
                if lead == 0.0:
                    break
                high = max(low, 1.0 + max(abs(p[0]), abs(p[1]), abs(p[2])) / abs(lead))
            f_low, f_high, root = evaluate_cubic(p, low), evaluate_cubic(p, high), inf
            if f_low == 0.0:
                root = low
            elif f_low * f_high < 0.0:
                root = find_root_between(p, low, high)
            elif high == end:
                bend = abs(p[2] + 3.0 * p[3] * end)
                if abs(f_high) <= bend * (APART * (1.0 + end)) ** 2:
                    root = end
            if root < least and are_pressing(
                straight, across, right, i, j, k, si * root, sj * root, sk * root
            ):
                least = root
            low = high
    return least


@inner
def find_friction_of_two(points: Array, normals: Array, right: IntArray, least: float) -> float:
    """Return the least friction coefficient at which two of four contacts, one of each jaw, balance alone.

    The line through both contacts then lies in both friction cones. Return ``least`` where there is none
    below ``least``. ``points`` and ``normals`` are (4, 2).
    """
    for i in range(4):
        for j in range(i + 1, 4):
            dx, dy = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
            span = hypot(dx, dy)
            if right[i] == right[j] or span < NO_FORCE:
                continue
            dx, dy = dx / span, dy / span
            along_i = -(normals[i, 0] * dx + normals[i, 1] * dy)
            along_j = normals[j, 0] * dx + normals[j, 1] * dy
            # The force of the right peg on the part points to the left.
            if along_i <= NO_FORCE or along_j <= NO_FORCE or (dx if right[i] == 1 else -dx) >= -NO_FORCE:
                continue
            across_i = abs(normals[i, 0] * dy - normals[i, 1] * dx)
            across_j = abs(normals[j, 0] * dy - normals[j, 1] * dx)
            least = min(least, max(across_i / along_i, across_j / along_j))
    return least


@inner
def are_all_pushing(matrix: Array, inverse: Array) -> bool:
    """Return whether four forces balance with none negative.

    The forces are those whose wrenches add up to zero and that close the jaw with force 1. ``matrix`` (4, 4)
    holds the equations and is overwritten, as is ``inverse``.
    """
    if not write_inverse(matrix, inverse) > SINGULAR:
        return False
    # The right-hand side is (0, 0, 0, -1).
    return max(inverse[0, 3], inverse[1, 3], inverse[2, 3], inverse[3, 3]) <= 0.0


@inner
def is_balanced(
    straight: Array, across: Array, right: IntArray, friction: float, matrix: Array, inverse: Array
) -> bool:
    """Return whether some three of four contacts balance the jaw inside their friction cones.

    ``friction`` is the friction coefficient. It is enough to try four of the six edges of three cones at a
    time. ``matrix`` and ``inverse`` are (4, 4) work space.
    """
    # Edges no longer than about 1, so that their determinant shows whether they are independent.
    along = 1.0 / max(1.0, friction)
    for left_out in range(4):
        # Of six edges, two are not used.
        for one in range(6):
            for two in range(one + 1, 6):
                count = 0
                for edge in range(6):
                    if edge in (one, two):
                        continue
                    contact = edge // 2 if edge // 2 < left_out else edge // 2 + 1
                    beside = along * friction if edge % 2 == 0 else -along * friction
                    for e in range(3):
                        matrix[e, count] = along * straight[contact, e] + beside * across[contact, e]
                    matrix[3, count] = matrix[0, count] * right[contact]
                    count += 1
                if are_all_pushing(matrix, inverse):
                    return True
    return False


@compiled
def find_least_friction(
    points: Matrix,
    normals: Matrix,
    right: IntVector,
    straight: Matrix,
    across: Matrix,
    matrix: Matrix,
    inverse: Matrix,
) -> float:
    """Return the least friction coefficient at which two or three of
    four contacts balance a jaw, inf for none.

    Parameters
    ----------
    points : (4, 2) contacts about their middle, divided by the distance that they are apart.
    normals : (4, 2) outward unit normals.
    right : (4,) 1 for contacts of the jaw that moves, else 0.
    straight, across, matrix, inverse : (4, 3), (4, 3), (4, 4) and (4, 4) work space.
    """
    for i in range(4):
        (x, y), (nx, ny) = (points[i, 0], points[i, 1]), (normals[i, 0], normals[i, 1])
        straight[i, 0], straight[i, 1], straight[i, 2] = -nx, -ny, y * nx - x * ny
        across[i, 0], across[i, 1], across[i, 2] = -ny, nx, x * nx + y * ny
    least = inf
    for left_out in range(4):
        least = find_friction_of_three(straight, across, right, left_out, least)
    high = find_friction_of_two(points, normals, right, least)
    if high == inf or not is_balanced(straight, across, right, high * (1.0 - LESS), matrix, inverse):
        return high
    low = 0.0
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        if is_balanced(straight, across, right, middle, matrix, inverse):
            high = middle
        else:
            low = middle
    return high
