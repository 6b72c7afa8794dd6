r"""A certificate for every fixture: that its contact equations have exactly one solution near the computed
one, and that the rules hold there.

Theorem (Newton-Kantorovich, in the form of radii polynomials): let F be the four contact equations in the
unknowns z = (L psi, tail x, tail y, separation), all in mm. Let A be an approximate inverse of the Jacobian J
at z, and

    Y >= \|A F(z)\|,   Z >= \|I - A J\|,   K >= \|A\| \|second derivatives of F\|

Norms are largest absolute row sums. When (1 - Z)^2 > 2 K Y there is exactly one solution within
r+ = (1 - Z) / K of z. It lies within r = 2 Y / (1 - Z + sqrt((1 - Z)^2 - 2 K Y)).

Reference: J. B. van den Berg, J.-P. Lessard, "Rigorous numerics in dynamics", Notices of the AMS 62 (2015)
1057-1061.

The search states how far the exact contacts may be from the computed ones. When that is within r+, the
solution here is the one the search isolated, and no other hides beside it.

Glossary
--------
verdict : PROVEN, DISCARDED or OPEN (left to other means).
radius : how far in mm the exact unknowns may be from the computed ones; infinite without a certificate.
unique : in mm, within which there is no other solution.
"""

from __future__ import annotations

from math import cos, inf, pi, sin, sqrt

import numpy as np

from workhold.conventions import (
    GAP_SLACK,
    LEAST_CLAMPING,
    LEAST_CLOSURE,
    LEAST_PUSH,
    LEAST_SEAT,
    LEAST_SPAN,
    TOUCHING,
)
from workhold.kernels.base.compiling import (
    Array,
    ByteVector,
    Matrix,
    Stack,
    compiled,
    inner,
)
from workhold.kernels.base.distance import measure_segment_distance
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    IS_ARC,
    RADIUS,
    X,
    Y,
    find_largest_number,
)
from workhold.kernels.base.tables import Setting
from workhold.kernels.chord.evaluation import measure_end_slack
from workhold.kernels.contact.record import (
    FEATURES,
    INVERSE,
    LARGEST_RADIUS,
    MOVING,
    NEWTON,
    NULL,
    PSI,
    REACH,
    SLOPES,
    UNKNOWNS,
    invert_jacobian,
    read_record,
    write_contact_equations,
)
from workhold.kernels.contact.rules import bound_minor_error, compute_outward_normal, write_minors

DISCARDED, OPEN, PROVEN = -1, 0, 1
ROUNDS = 3
# Determinants this small are singular; steps of more than this many mm lead to another contact.
SINGULAR = 1e-300
FARTHEST = 1.0
# Roundings of half a unit in the last place in a contact equation, relative to its terms, on the safe side.
ROUNDINGS = 16.0 * 1.2e-16
# Where an engine states nothing better, the exact contact is this near, in mm.
LEAST_REACH = 1e-9


@inner
def polish_unknowns(record: Array, features: Array, length: float, w: Array, points: Array) -> None:
    """Improve the unknowns in ``w`` in place by Newton's method to
    the last digits, and compute the contacts there.

    The contacts are written to ``w`` and ``points`` as by ``contact.record.write_contact_equations``. A step
    that is singular or longer than ``FARTHEST`` mm is not taken. See ``base.feature`` for the layout of
    ``features``.
    """
    for _ in range(ROUNDS):
        write_contact_equations(record, features, length, w, points)
        if invert_jacobian(w) > SINGULAR:
            largest = 0.0
            for k in range(4):
                largest = max(largest, abs(w[NEWTON, k]))
            if largest <= FARTHEST:
                w[UNKNOWNS, 0] -= w[NEWTON, 0] / length
                for k in range(1, 4):
                    w[UNKNOWNS, k] -= w[NEWTON, k]
    write_contact_equations(record, features, length, w, points)


@inner
def measure_sizes(record: Array, features: Array, points: Array) -> tuple[float, float]:
    """Return (size in mm of the numbers in the contact equations, radius in mm of the smallest arc touched).

    Rounding errors of the contact equations are relative to the first, their second derivatives to the
    second, which is inf where only lines are touched. ``points`` are the pegs' centres. See
    ``contact.record`` for the layout of ``record``, ``base.feature`` for that of ``features``.
    """
    place = carrier = 0.0
    smallest = inf
    for k in range(4):
        row = features[int(record[FEATURES + k])]
        place = max(place, max(abs(points[k, 0]), abs(points[k, 1])))
        carrier = max(carrier, find_largest_number(row))
        if row[IS_ARC] != 0.0:
            smallest = min(smallest, row[RADIUS])
    return (place + carrier, smallest)


@inner
def certify_contacts(
    w: Array, size: float, smallest: float, length: float, backward_error: float
) -> tuple[float, float]:
    """Return the Newton-Kantorovich bounds for the contacts in ``w``.

    The second derivatives of the contact equations are bounded as follows. A peg's centre moves by at most
    (sqrt 2 + 2 + 1) per unit of the unknowns, and its second derivative is at most 4 / L. A distance from a
    line has no curvature, one from a point about R away has at most 2 / R.

    Parameters
    ----------
    w : as ``contact.record.write_contact_equations`` fills it in; its inverse and Newton step are
        overwritten.
    size, smallest : see :func:`measure_sizes`.
    length : L in mm, by which moments are divided.
    backward_error : error in mm of the equations' values besides rounding.

    Returns
    -------
    (radius: within this distance in mm a solution exists; unique: within this distance there is no other),
        inf and 0 without a certificate
    """
    if not invert_jacobian(w) > SINGULAR:
        return (inf, 0.0)
    error = ROUNDINGS * size + backward_error
    norm = step = defect = 0.0
    for i in range(4):
        row = rest = 0.0
        for j in range(4):
            row += abs(w[INVERSE + i, j])
            entry = 1.0 if i == j else 0.0
            for k in range(4):
                entry -= w[INVERSE + i, k] * w[SLOPES + k, j]
            rest += abs(entry)
        norm, defect, step = max(norm, row), max(defect, rest), max(step, abs(w[NEWTON, i]))
    step += norm * error
    second_derivative = 2.0 * 4.42**2 / smallest + 4.0 / length
    # The computed Jacobian is off by the rounding of a row's four entries, by eight half units of an arm over
    # L and six of a direction, and by that of the places times the second derivatives.
    defect += norm * (ROUNDINGS * (1.0 + size / length) + error * second_derivative)
    rest, curve = 1.0 - defect, norm * second_derivative
    inside = rest * rest - 2.0 * curve * step
    if not (rest > 0.0 and inside > 0.0):
        return (inf, 0.0)
    radius = 1.01 * 2.0 * step / (rest + sqrt(inside))
    # More than half a radius from an arc the second derivatives are not bounded.
    unique = min(0.99 * rest / curve, smallest / 16.0)
    return (radius, unique) if radius < unique else (inf, 0.0)


@inner
def measure_nearest_end(record: Array, features: Array, points: Array) -> float:
    """Return the least distance in mm, over the four contacts, from a contact to an end of its feature, plus
    that end's slack.

    Distances are along the features; a contact beyond an end counts as negative. See
    ``chord.evaluation.measure_end_slack``, ``contact.record`` for the layout of ``record``, ``base.feature``
    for that of ``features``.
    """
    least = inf
    for k in range(4):
        least = min(least, measure_end_slack(features[int(record[FEATURES + k])], points[k, 0], points[k, 1]))
    return least


@inner
def compute_clamping(w: Array, pairs: Array) -> tuple[float, float]:
    """Return (1) the gap between the carriers and (2) the force with which the standing pegs push, for
    contacts in place.

    ``pairs`` (2, 4, 2) holds centres and outward normals; the null vector in ``w`` stands for the forces. See
    ``contact.record`` for the layout of ``w``.

    Returns
    -------
    (x distance in mm from the rightmost standing to the leftmost moving peg; force of the standing pegs on
        the part along +x, in the null vector's unit)
    """
    cosine, sine = cos(w[UNKNOWNS, 0]), sin(w[UNKNOWNS, 0])
    points, normals, null = pairs[0], pairs[1], w[NULL]
    standing, moving, push = -inf, inf, 0.0
    for k in range(4):
        along = points[k, 0] * cosine + points[k, 1] * sine
        if w[MOVING, k] == 0.0:
            standing = max(standing, along)
            push -= null[k] * (normals[k, 0] * cosine + normals[k, 1] * sine)
        else:
            moving = min(moving, along)
    return (moving - standing, push)


@inner
def judge_sign(middle: float, doubt: float) -> int:
    """Return PROVEN when every number within ``doubt`` of ``middle`` is
    positive, DISCARDED when all are negative, else OPEN.
    """
    if middle - doubt > 0.0:
        return PROVEN
    return DISCARDED if middle + doubt < 0.0 else OPEN


@inner
def write_wrenches(record: Array, features: Array, length: float, w: Array, pairs: Array) -> float:
    """Write the outward unit normals of four contacts to ``pairs[1]``, and a null vector of their wrenches to
    ``w``.

    The null vector is not scaled; return the sum of its absolute values. ``pairs[0]`` holds the peg centres.
    See ``contact.record`` for the layout of ``record`` and ``w``, ``base.feature`` for that of ``features``.
    """
    for k in range(4):
        row = features[int(record[FEATURES + k])]
        pairs[1, k, 0], pairs[1, k, 1] = compute_outward_normal(row, pairs[0, k, 0], pairs[0, k, 1])
    return write_minors(pairs[0], pairs[1], length, w[NULL])


@inner
def judge_contacts(
    record: Array,
    features: Array,
    setting: Setting,
    radius: float,
    smallest: float,
    w: Array,
    pairs: Array,
) -> int:
    """Return PROVEN, DISCARDED or OPEN for four contacts in place, by enclosures of numbers that must all be
    positive.

    Two cases: (a) in general there are five numbers, of ends, gap, span, closure and clamping; (b) where the
    moving peg is one of two clamps (``limits.pairing``), there are three: of ends, the determinant of the
    standing pegs' wrenches, and the clamp's push. ``w`` and ``pairs[0]`` hold the contacts, see
    ``contact.record.write_contact_equations``; ``pairs[1]`` receives the outward normals. See
    ``base.feature`` for the layout of ``features``.

    Parameters
    ----------
    radius : how far in mm the exact unknowns may be from those in place.
    smallest : radius in mm of the smallest arc touched, inf where only lines are.
    """
    length, null = setting.limits.wrench_length, w[NULL]
    size = write_wrenches(record, features, length, w, pairs)
    gap, push = compute_clamping(w, pairs)
    reach = 4.5 * radius
    swing = reach / smallest
    band = bound_minor_error(swing, reach, length)
    verdict = judge_sign(
        measure_nearest_end(record, features, pairs[0]) - setting.limits.contact_margin, 1.2 * reach + 1e-12
    )
    if setting.limits.pairing != 0.0:
        verdict = min(verdict, judge_sign(abs(null[3]) - LEAST_SEAT, band))
        facing = pairs[1, 3, 0] * cos(w[UNKNOWNS, 0]) + pairs[1, 3, 1] * sin(w[UNKNOWNS, 0])
        return min(
            verdict, judge_sign(setting.limits.clamping * facing - LEAST_PUSH, swing + radius / length)
        )
    low = min(min(null[0], null[1]), min(null[2], null[3]))
    high = max(max(null[0], null[1]), max(null[2], null[3]))
    sign = 1.0 if high >= -low else -1.0
    closure = low if sign > 0.0 else -high
    # The pegs stand in their holes: the gap is as far off as the fourth unknown, whatever the part does.
    verdict = min(verdict, judge_sign(gap - (setting.limits.gap - GAP_SLACK), 1.5 * radius + 1e-12))
    verdict = min(verdict, judge_sign(size - LEAST_SPAN, 4.0 * band))
    # Besides its own band that of the size, of four minors, counts by 1e-9 and 1e-6; up to three forces push.
    verdict = min(verdict, judge_sign(closure - LEAST_CLOSURE * size, 1.1 * band))
    doubt = 3.1 * band + size * (swing + radius / length)
    return min(verdict, judge_sign(sign * setting.limits.clamping * push - LEAST_CLAMPING * size, doubt))


def make_discs(outline: Array, margin: float) -> Array:
    """Return discs, one for each of (S, 10) segments, that hold the
    segment and all points within ``margin`` mm of it.

    Columns (S, 3): centre x and y in mm, squared radius in mm^2. See ``base.feature`` for the layout of
    ``outline``.
    """
    half, radius = outline[:, HALF_EXTENT], outline[:, RADIUS]
    # The disc on the chord, for an arc up to a half circle.
    short = np.where(outline[:, IS_ARC] == 0.0, 0.0, np.minimum(half, pi / 2.0))
    wide = np.where(half < pi / 2.0, radius * np.cos(short), 0.0)
    reach = np.where(outline[:, IS_ARC] == 0.0, half, radius * np.sin(short)) + margin
    return np.stack(
        [
            outline[:, X] + wide * outline[:, AXIS_X],
            outline[:, Y] + wide * outline[:, AXIS_Y],
            1.001 * reach**2,
        ],
        axis=1,
    )


@inner
def is_clear(points: Array, moves: Array, outline: Array, discs: Array, setting: Setting) -> bool:
    """Return whether four pegs with centres ``points`` (4, 2) are clear of all of (S, 10) segments, to within
    ``TOUCHING``.

    ``moves`` (4,) is 0 for a peg that has the standing pegs' radius, 1 for one that has the moving pegs'
    radius. ``discs`` (S, 3) are those of :func:`make_discs`. See ``base.feature`` for the layout of
    ``outline``.
    """
    for k in range(4):
        x, y = points[k, 0], points[k, 1]
        least = (setting.standing_radius if moves[k] == 0.0 else setting.moving_radius) - TOUCHING
        for n in range(discs.shape[0]):
            dx, dy = x - discs[n, 0], y - discs[n, 1]
            if dx * dx + dy * dy < discs[n, 2] and measure_segment_distance(x, y, outline[n]) < least:
                return False
    return True


@compiled
def certify_records(
    records: Matrix,
    features: Matrix,
    outline: Matrix,
    discs: Matrix,
    setting: Setting,
    solutions: Matrix,
    verdicts: ByteVector,
    w: Matrix,
    pairs: Stack,
) -> None:
    """Write a solution and a verdict for each record.

    See ``base.feature`` for the layout of ``features`` and ``outline``.

    Parameters
    ----------
    records : (N, 19), see ``kernels.contact.record``; none of them given up.
    features : (F, 12) rows with the slack of their ends.
    outline : (S, 10) the part's faces.
    discs : (S, 3) result of :func:`make_discs` for the outline, with the pegs' largest radius or more as
        margin.
    solutions : (N, 4) receives the polished unknowns (psi, tail x, tail y, separation).
    verdicts : (N,) receives PROVEN, DISCARDED or OPEN; OPEN also where another solution may be in the
        record's box.
    w, pairs : (19, 4) and (2, 4, 2) work space, see ``contact.record``.
    """
    length, points = setting.limits.wrench_length, pairs[0]
    for n in range(records.shape[0]):
        record = records[n]
        read_record(record, setting.lattice, w)
        polish_unknowns(record, features, length, w, points)
        size, smallest = measure_sizes(record, features, points)
        radius, unique = certify_contacts(w, size, smallest, length, setting.backward_error)
        away, verdicts[n] = 0.0, OPEN
        for k in range(4):
            solutions[n, k] = w[UNKNOWNS, k]
            away = max(away, abs(w[UNKNOWNS, k] - record[PSI + k]) * (length if k == 0 else 1.0))
        # The exact contact may be this far, where the separation is the worst known.
        box = 2.0 * (record[LARGEST_RADIUS] + LEAST_REACH + length * record[REACH] + LEAST_REACH)
        if radius < inf and away + box <= unique:
            verdicts[n] = judge_contacts(record, features, setting, radius, smallest, w, pairs)
            # The trimmed features keep a peg clear of the rest of the part; this is looked at once more.
            if verdicts[n] == PROVEN and not is_clear(points, w[MOVING], outline, discs, setting):
                verdicts[n] = DISCARDED
