"""How much contacts vary over a part of a box, and whether some rule is broken everywhere in the part.

How much numbers vary is bounded by norms. A peg's centre moves by at most its ``variation``. Its unit normal
turns by at most variation / (R - variation) on an arc and not at all on a line. Products vary by the sum of
what their factors do.
"""

from __future__ import annotations

from math import cos, hypot, inf, sin, sqrt

from workhold.conventions import GAP_SLACK, LEAST_CLAMPING, LEAST_CLOSURE, LEAST_PUSH, LEAST_SEAT, LEAST_SPAN
from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.feature import IS_ARC, RADIUS, SIGN, X, Y, compute_local_size, is_shallow
from workhold.kernels.base.tables import Setting
from workhold.kernels.contact.record import (
    FEATURES,
    MOVING,
    NEWTON,
    NULL,
    OFF,
    SLOPES,
    STEP_X,
    UNKNOWNS,
)
from workhold.kernels.contact.rules import ROUNDING, write_minors
from workhold.kernels.proof.newton_kantorovich import ROUNDINGS, measure_nearest_end

# Half a unit in the last place, and rounding in mm of ends and gaps.
HALF_UNIT = 1.2e-16
HAIR = 1e-12

# Rows of the numbers (10, 4) of a part, one for each peg: how far its centre moves, how much its normal
# turns, how much its arm from the first peg varies, its moment and how much that varies, the part of its
# normal along x and how much that varies, the error of its contact equation, and how much the minor without
# it varies. How much the turn and the separation vary comes last.
VARIATION, TILT, ARM_BAND, MOMENT, MOMENT_BAND, ALONG_X, FORCE_BAND, ERROR, MINOR_BAND, OTHERS = range(10)
NUMBERS = 10


@inner
def move_to_part_middle(z: Array, place: Array, frame: Array, length: float, w: Array) -> None:
    """Set the unknowns in ``w`` to the middle of a part of a box.

    The middle is ``z`` (4,), that of the whole box, plus ``frame[1]`` (4, 4) times ``place[0]`` (4,), in the
    units of the unknowns. The rounding error of this sum in mm goes to the row NEWTON of ``w``. ``length`` is
    L in mm, by which moments are divided. See ``contact.record`` for the layout of ``w``.
    """
    for i in range(4):
        step = 0.0
        for j in range(4):
            step += frame[1, i, j] * place[0, j]
        scale = length if i == 0 else 1.0
        step /= scale
        total = z[i] + step
        part = total - z[i]
        w[UNKNOWNS, i] = total
        w[NEWTON, i] = ((z[i] - (total - part)) + (step - part)) * scale


@inner
def write_variation(
    record: Array,
    features: Array,
    size: float,
    setting: Setting,
    place: Array,
    frame: Array,
    w: Array,
    pairs: Array,
    b: Array,
) -> None:
    """Write how much the contacts in place vary over a part to ``b`` (10, 4), all rows except MINOR_BAND.

    ``pairs[1]`` receives the arms from the first peg in mm, ``pairs[2]`` the outward unit normals;
    ``pairs[0]`` holds the centres. ``size`` is the size in mm of the numbers in the contact equations, see
    ``newton_kantorovich.measure_sizes``. See ``contact.record`` for the layout of ``record`` and ``w``,
    ``base.feature`` for that of ``features``, the comment at VARIATION for the rows of ``b``.
    """
    length, backward_error = setting.limits.wrench_length, setting.backward_error
    cosine, sine = cos(w[UNKNOWNS, 0]), sin(w[UNKNOWNS, 0])
    turn = separation = 0.0
    for j in range(4):
        turn += abs(frame[1, 0, j]) * place[1, j] / length
        separation += abs(frame[1, 3, j]) * place[1, j]
    b[OTHERS, 0], b[OTHERS, 1] = turn, separation
    for k in range(4):
        row = features[int(record[FEATURES + k])]
        moves = w[MOVING, k]
        x, y = pairs[0, k, 0] - w[UNKNOWNS, 1], pairs[0, k, 1] - w[UNKNOWNS, 2]
        arm = sqrt(x * x + y * y)
        variation = turn * (arm * turn + moves * separation) + ROUNDINGS * size
        for j in range(4):
            about = frame[1, 0, j] / length
            along = moves * frame[1, 3, j]
            away_x = frame[1, 1, j] + along * cosine - about * y
            away_y = frame[1, 2, j] + along * sine + about * x
            variation += place[1, j] * sqrt(away_x * away_x + away_y * away_y)
        tilt, sign = 0.0, 1.0
        ray = abs(pairs[0, k, 0]) + abs(pairs[0, k, 1])
        ray += compute_local_size(row) if is_shallow(row) else abs(row[X]) + abs(row[Y])
        # Seven roundings of each coordinate of the arm, one of the sum with the tail's, one of the difference
        # from the feature's middle, and four of products and root.
        b[ERROR, k] = HALF_UNIT * (10.0 * arm + 6.0 * ray) + backward_error
        if row[IS_ARC] != 0.0:
            ray = row[RADIUS] + w[OFF, k]
            tilt = variation / (ray - variation) + ROUNDING if 2.0 * variation < ray else 4.0
            sign = row[SIGN]
        b[VARIATION, k], b[TILT, k], b[ARM_BAND, k] = variation, tilt, arm * turn + moves * separation
        pairs[1, k, 0], pairs[1, k, 1] = x, y
        pairs[2, k, 0], pairs[2, k, 1] = sign * w[SLOPES + k, 1], sign * w[SLOPES + k, 2]
        moment = (x * pairs[2, k, 1] - y * pairs[2, k, 0]) / length
        b[MOMENT, k] = abs(moment)
        b[MOMENT_BAND, k] = ((arm + b[ARM_BAND, k]) * tilt + b[ARM_BAND, k] + ROUNDINGS * size) / length
        b[ALONG_X, k] = pairs[2, k, 0] * cosine + pairs[2, k, 1] * sine
        b[FORCE_BAND, k] = tilt + turn + ROUNDINGS


@inner
def bound_cross_product(
    record: Array, features: Array, i: int, j: int, pairs: Array, w: Array, b: Array
) -> tuple[float, float]:
    """Return (absolute cross product of the normals of pegs i and j, how much it varies over a part).

    ``pairs`` and ``b`` are those of :func:`write_variation`. See ``contact.record`` for the layout of
    ``record`` and ``w``, ``base.feature`` for that of ``features``, ``proof.variation`` for that of ``b``.
    """
    one, other = pairs[2, i, 0] * pairs[2, j, 1], pairs[2, i, 1] * pairs[2, j, 0]
    cross = one - other
    band = b[TILT, i] + b[TILT, j] + b[TILT, i] * b[TILT, j]
    if (
        abs(pairs[2, i, 0]) != abs(pairs[2, j, 0])
        or abs(pairs[2, i, 1]) != abs(pairs[2, j, 1])
        or cross != 0.0
    ):
        # Normals of exactly the same or opposite direction, as lines have, are parallel without error.
        band += ROUNDINGS * (abs(one) + abs(other))
    return (abs(cross), min(band, bound_arcs_cross_product(record, features, i, j, pairs, w, b)))


@inner
def bound_arcs_cross_product(
    record: Array, features: Array, i: int, j: int, pairs: Array, w: Array, b: Array
) -> float:
    """Return how much the cross product of the normals of pegs i and j varies over a part; inf unless both
    are on arcs.

    Only the difference of the rays from their centres counts, which depends on the orientation alone where
    both pegs are on one carrier. Parallel normals stay parallel wherever the part slides. ``pairs`` and ``b``
    are those of :func:`write_variation`. See ``contact.record`` for the layout of ``record`` and ``w``,
    ``base.feature`` for that of ``features``, ``proof.variation`` for that of ``b``.
    """
    one, two = features[int(record[FEATURES + i])], features[int(record[FEATURES + j])]
    if one[IS_ARC] == 0.0 or two[IS_ARC] == 0.0:
        return inf
    x, y = pairs[1, j, 0] - pairs[1, i, 0], pairs[1, j, 1] - pairs[1, i, 1]
    varies = hypot(x, y) * b[OTHERS, 0] + abs(w[MOVING, i] - w[MOVING, j]) * b[OTHERS, 1]
    apart = hypot(x - two[X] + one[X], y - two[Y] + one[Y])
    return (b[TILT, i] * (apart + varies) + varies) / two[RADIUS] + ROUNDING


@inner
def are_normals_one_sided(pairs: Array, b: Array) -> bool:
    """Return whether all normals have a positive component along the first one everywhere in a part.

    No non-negative forces at such contacts add up to zero. This occurs where pegs in one row of holes touch a
    line and the arcs beside it at tangent joints, along which the workpiece seems to slide. These contacts
    hardly determine the part's place, but they do determine the directions of the normals. ``pairs`` and
    ``b`` are those of :func:`write_variation`. See ``proof.variation`` for the layout of ``b``.
    """
    for k in range(4):
        along = pairs[2, 0, 0] * pairs[2, k, 0] + pairs[2, 0, 1] * pairs[2, k, 1]
        if along <= b[TILT, k] + ROUNDINGS:
            return False
    return True


@inner
def is_broken(record: Array, features: Array, setting: Setting, w: Array, pairs: Array, b: Array) -> bool:
    """Return whether some rule of a fixture is broken everywhere in a part, see ``contact.rules``.

    ``pairs`` and ``b`` are those of :func:`write_variation`; the null vector in ``w`` and MINOR_BAND in ``b``
    are overwritten. See ``contact.record`` for the layout of ``record`` and ``w``, ``base.feature`` for that
    of ``features``, ``proof.variation`` for that of ``b``.
    """
    reach, null = 0.0, w[NULL]
    moving, standing = inf, -inf
    for k in range(4):
        row = features[int(record[FEATURES + k])]
        reach = max(reach, b[VARIATION, k] if row[IS_ARC] == 0.0 else row[RADIUS] * b[TILT, k])
        if w[MOVING, k] == 0.0:
            standing = max(standing, w[STEP_X, k])
        else:
            moving = min(moving, w[STEP_X, k] + w[UNKNOWNS, 3])
    if moving - standing + b[OTHERS, 1] + HAIR < setting.limits.gap - GAP_SLACK:
        return True
    if measure_nearest_end(record, features, pairs[0]) - setting.limits.contact_margin + reach + HAIR < 0.0:
        return True
    size = write_minors(pairs[1], pairs[2], setting.limits.wrench_length, null)
    for k in range(4):
        b[MINOR_BAND, k] = 0.0
    for i in range(4):
        for j in range(i + 1, 4):
            cross, band = bound_cross_product(record, features, i, j, pairs, w, b)
            for a in range(4):
                if a != i and a != j:
                    moment = b[MOMENT_BAND, a] + ROUNDINGS * b[MOMENT, a]
                    b[MINOR_BAND, 6 - i - j - a] += b[MOMENT, a] * band + cross * moment + band * moment
    if setting.limits.pairing != 0.0:
        pushes = setting.limits.clamping * b[ALONG_X, 3] + b[FORCE_BAND, 3] >= LEAST_PUSH
        return not (pushes and abs(null[3]) + b[MINOR_BAND, 3] >= LEAST_SEAT)
    if are_normals_one_sided(pairs, b):
        return True
    doubt = b[MINOR_BAND, 0] + b[MINOR_BAND, 1] + b[MINOR_BAND, 2] + b[MINOR_BAND, 3]
    if size + doubt < LEAST_SPAN:
        return True
    size = max(size - doubt, 0.0)
    clamping = setting.limits.clamping
    return not (may_clamp(1.0, clamping, size, w, b) or may_clamp(-1.0, clamping, size, w, b))


@inner
def may_clamp(sign: float, clamping: float, size: float, w: Array, b: Array) -> bool:
    """Return whether forces with the sign ``sign`` (1 or -1) may close and clamp somewhere in a part of a
    box.

    Both the push of the standing pegs and that of the moving pegs must reach the least clamping force.
    ``clamping`` is 1 or -1 as in ``Limits``, ``size`` a lower bound of the sum of the minors' absolute
    values. ``b`` is that of :func:`write_variation`, with MINOR_BAND written; the minors are at NULL in
    ``w``. See ``contact.record`` for the layout of ``w``, ``proof.variation`` for that of ``b``.
    """
    null = w[NULL]
    standing = moving = 0.0
    for k in range(4):
        band = b[MINOR_BAND, k]
        if sign * null[k] + band < LEAST_CLOSURE * size:
            return False
        push = sign * clamping * null[k] * b[ALONG_X, k]
        doubt = abs(null[k]) * b[FORCE_BAND, k] + band * abs(b[ALONG_X, k]) + band * b[FORCE_BAND, k]
        if w[MOVING, k] == 0.0:
            standing += doubt - push
        else:
            moving += doubt + push
    return standing >= LEAST_CLAMPING * size and moving >= LEAST_CLAMPING * size
