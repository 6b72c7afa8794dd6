"""Four contacts on a box of unknowns in ball arithmetic: equations, Jacobian, wrenches, and the rules.

Reference: F. Johansson, "Arb", IEEE Transactions on Computers 66 (2017) 1281-1292.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, pi

from attrs import frozen
from flint import arb

from workhold.conventions import GAP_SLACK, LEAST_CLAMPING, LEAST_CLOSURE, LEAST_PUSH, LEAST_SEAT, LEAST_SPAN
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    HIGH_SLACK,
    IS_ARC,
    LOW_SLACK,
    RADIUS,
    REST_X,
    REST_Y,
    SIGN,
    X,
    Y,
)
from workhold.kernels.base.given import Limits
from workhold.proof.narrowing import CandidateBox, contact_value, from_origin

__all__ = ["BoxContacts", "end_slacks", "is_empty", "places", "slacks", "wrench_minors"]


@frozen(eq=False)
class BoxContacts:
    """Contacts on a box of unknowns, as balls.

    They are centres, unit normals (outward), arms from the first peg to each, equations and their Jacobian.
    """

    rows: Sequence[Sequence[float]]
    centers: list[tuple[arb, arb]]
    normals: list[tuple[arb, arb]]
    arms: list[tuple[arb, arb]]
    values: list[arb]
    slopes: list[list[arb]]
    axis: tuple[arb, arb]


def places(box: CandidateBox, unknowns: Sequence[arb]) -> BoxContacts:
    """Everything about the four contacts on a box of unknowns."""
    psi, x, y, separation = unknowns
    cosine, sine = psi.cos(), psi.sin()
    centers, normals, arms, values, slopes = [], [], [], [], []
    for k, (row, (dx, dy)) in enumerate(zip(box.features, box.offsets, strict=True)):
        moves = int(k >= box.standing)
        reach = (dx + moves * separation, arb(dy))
        turned = (cosine * reach[0] - sine * reach[1], sine * reach[0] + cosine * reach[1])
        center = (x + turned[0], y + turned[1])
        if row[IS_ARC] == 0.0:
            size = (arb(row[AXIS_X]) ** 2 + arb(row[AXIS_Y]) ** 2).sqrt()
            gradient = (row[AXIS_Y] / size, -row[AXIS_X] / size)
            normal = gradient
        else:
            ray = from_origin(row, center)
            gradient = (ray[0] / row[RADIUS], ray[1] / row[RADIUS])
            normal = (row[SIGN] * gradient[0], row[SIGN] * gradient[1])
        slope = [gradient[1] * turned[0] - gradient[0] * turned[1], gradient[0], gradient[1]]
        slope.append((gradient[0] * cosine + gradient[1] * sine) * moves)
        centers.append(center)
        normals.append(normal)
        arms.append(turned)
        values.append(contact_value(row, center))
        slopes.append(slope)
    return BoxContacts(box.features, centers, normals, arms, values, slopes, (cosine, sine))


def slacks(box: CandidateBox, here: BoxContacts, minors: Sequence[arb], limits: Limits) -> list[arb]:
    """Numbers that are positive for a fixture: ends, gap, span, closure, clamping (for the better sign).

    Of one of two clamps they are ends, the determinant of the standing pegs' wrenches, and its push.
    """
    out = [
        slack
        for row, center in zip(box.features, here.centers, strict=True)
        for slack in end_slacks(row, center, limits.contact_margin)
    ]
    along = [here.axis[0] * x + here.axis[1] * y for x, y in here.centers]
    if isfinite(limits.gap):
        for one in along[: box.standing]:
            out += [other - one - (arb(limits.gap) - GAP_SLACK) for other in along[box.standing :]]
    if limits.pairing:
        x, y = here.normals[3]
        facing = int(limits.clamping) * (x * here.axis[0] + y * here.axis[1])
        return [*out, abs(minors[3]) - LEAST_SEAT, facing - LEAST_PUSH]
    size = sum((abs(minor) for minor in minors), arb(0))
    out.append(size - LEAST_SPAN)
    sign = 1 if sum(float(minor.mid()) for minor in minors) >= 0 else -1
    if any(sign * minor < 0 for minor in minors) and not any(sign * minor > 0 for minor in minors):
        sign = -sign
    for minor in minors:
        out.append(sign * minor - LEAST_CLOSURE * size)
    sign *= int(limits.clamping)
    push = [
        sign * minor * (n[0] * here.axis[0] + n[1] * here.axis[1])
        for minor, n in zip(minors, here.normals, strict=True)
    ]
    # The force is the push of the standing pegs, and as well what the moving pegs take up.
    out.append(-sum(push[: box.standing], arb(0)) - LEAST_CLAMPING * size)
    out.append(sum(push[box.standing :], arb(0)) - LEAST_CLAMPING * size)
    return out


def end_slacks(row: Sequence[float], center: tuple[arb, arb], margin: float) -> list[arb]:
    """Distances in mm of a contact from breaking the rule of ends at both ends of its feature, in balls."""
    dx, dy = from_origin(row, center)
    along, across = dx * row[AXIS_X] + dy * row[AXIS_Y], dy * row[AXIS_X] - dx * row[AXIS_Y]
    place, scale, half = along, 1.0, row[HALF_EXTENT]
    if row[IS_ARC] != 0.0:
        if half >= pi:
            return []
        place, scale = arb.atan2(across, along), row[RADIUS]
    return [
        (half - place) * scale - margin + row[HIGH_SLACK],
        (half + place) * scale - margin + row[LOW_SLACK],
    ]


def wrench_minors(here: BoxContacts, length: float) -> list[arb]:
    """Signed 3 x 3 minors of the wrenches (n, q x n / L); in balls, as no kernel is."""
    n = here.normals
    # The minors do not depend on the point that moments are taken about; from the first peg the others are
    # known best.
    t = [(q[0] * m[1] - q[1] * m[0]) / length for q, m in zip(here.arms, n, strict=True)]

    def cross(i: int, j: int) -> arb:
        one, two = here.rows[i], here.rows[j]
        if one[IS_ARC] == 0.0 or two[IS_ARC] == 0.0:
            return n[i][0] * n[j][1] - n[i][1] * n[j][0]
        # Between arcs only the difference of the rays from their centres counts, which depends on the
        # orientation alone where both pegs are on one carrier: parallel normals stay so wherever the part
        # slides.
        x = here.arms[j][0] - here.arms[i][0] - (arb(two[X]) - one[X]) - (arb(two[REST_X]) - one[REST_X])
        y = here.arms[j][1] - here.arms[i][1] - (arb(two[Y]) - one[Y]) - (arb(two[REST_Y]) - one[REST_Y])
        return (n[i][0] * y - n[i][1] * x) * (two[SIGN] / arb(two[RADIUS]))

    out = []
    for k in range(4):
        a, b, c = (i for i in range(4) if i != k)
        minor = t[a] * cross(b, c) - t[b] * cross(a, c) + t[c] * cross(a, b)
        out.append(-minor if k % 2 else minor)
    return out


def is_empty(box: CandidateBox, here: BoxContacts, limits: Limits) -> bool:
    """Whether some contact equation has no zero, or some rule is broken, everywhere in a place."""
    if any(value > 0 or value < 0 for value in here.values):
        return True
    minors = wrench_minors(here, limits.wrench_length)
    if not limits.pairing and any(minor > 0 for minor in minors) and any(minor < 0 for minor in minors):
        # Of opposite signs, so that nothing closes.
        return True
    return any(slack < 0 for slack in slacks(box, here, minors, limits))
