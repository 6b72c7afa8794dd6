"""Four contacts on a box of unknowns in ball arithmetic: equations, Jacobian, wrenches, and the rules. A
*ball* is a midpoint with a radius and encloses an exact number; a box is a product of four balls.

A box is made smaller before it is cut: by the gap rule, and by contacts with parallel lines. The gap rule
(the smallest distance between the carriers' pegs) bounds the separation alone. Two contacts with parallel
lines make an equation of psi and the separation, because the part's place is not in their difference. It is
needed where both contacts are with one line and two pegs are in one row. Every separation meets all equations
there, so the box is as long as the jaws open. No turned box of the interval Newton method shows that psi is
one angle there.

Reference: F. Johansson, "Arb", IEEE Transactions on Computers 66 (2017) 1281-1292.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from math import inf, isfinite, nextafter, pi
from typing import Any

from attrs import evolve, frozen
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
from workhold.kernels.base.tables import Limits

__all__ = [
    "BoxContacts",
    "CandidateBox",
    "compute_contact_value",
    "compute_contact_values",
    "compute_end_slacks",
    "measure_extent",
    "measure_from_origin",
    "is_empty",
    "narrow_box",
    "place_contacts",
    "compute_slacks",
    "compute_wrench_minors",
]

# Newton steps of psi: each squares its error, so that these reach the precision in force.
STEPS = 4


@frozen
class CandidateBox:
    """A candidate: the features touched, the pegs' places, and bounds of its solution.

    Parameters
    ----------
    features : four rows of ``geometry.segment.make_segment_rows``, each with the slack of both ends.
    offsets : places (x, y) of the four pegs in mm relative to the first peg, without the separation.
    standing : number of pegs on the fixed carrier; these are the first ones.
    middle : psi in radians, tail x, tail y and separation in mm.
    reach : error bound of each.
    """

    features: Sequence[Sequence[float]]
    offsets: Sequence[tuple[float, float]]
    standing: int
    middle: tuple[float, float, float, float]
    reach: tuple[float, float, float, float]


def measure_from_origin(row: Sequence[float], point: tuple[Any, Any]) -> tuple[Any, Any]:
    """Return the vector in mm from a feature's origin (the middle of a line, the centre of an arc) to a
    point."""
    return point[0] - row[X] - row[REST_X], point[1] - row[Y] - row[REST_Y]


def compute_contact_value(row: Sequence[float], ray: tuple[Any, Any]) -> Any:
    """Return a contact equation's value in mm, 0 at contact: the distance from a line, or (distance² - R²) /
    2R for an arc, with the distance from its centre.

    ``ray`` is the peg's centre as :func:`measure_from_origin` returns it.
    """
    x, y = ray
    if row[IS_ARC] == 0.0:
        return (row[AXIS_Y] * x - row[AXIS_X] * y) / measure_axis_length(row)
    return (x * x + y * y - arb(row[RADIUS]) ** 2) / (2 * arb(row[RADIUS]))


def measure_axis_length(row: Sequence[float]) -> arb:
    """Return the length of a line's axis, which is 1 up to rounding, as a ball."""
    return (arb(row[AXIS_X]) ** 2 + arb(row[AXIS_Y]) ** 2).sqrt()


@frozen(eq=False)
class BoxContacts:
    """Four contacts on a box of unknowns, as balls; lengths in mm.

    Parameters
    ----------
    rows : of the features touched.
    centers : of the pegs, in the part's frame.
    rays : the same points from the features' origins, see :func:`measure_from_origin`.
    normals : outward unit normals.
    arms : from the first peg to each.
    values : contact equations.
    slopes : their Jacobian over (psi, tail x, tail y, separation), a row for each peg.
    axis : cosine and sine of psi.
    """

    rows: Sequence[Sequence[float]]
    centers: list[tuple[arb, arb]]
    rays: list[tuple[arb, arb]]
    normals: list[tuple[arb, arb]]
    arms: list[tuple[arb, arb]]
    values: list[arb]
    slopes: list[list[arb]]
    axis: tuple[arb, arb]


def list_turned_pegs(box: CandidateBox, unknowns: Sequence[Any]) -> Iterator[tuple[Any, Any]]:
    """Yield the axis of the pegs (cosine and sine of psi), and then
    each of the four pegs' arms (x, y) from the first peg.
    """
    psi, _, _, separation = unknowns
    cosine, sine = psi.cos(), psi.sin()
    yield cosine, sine
    for k, (dx, dy) in enumerate(box.offsets):
        across = dx + separation if k >= box.standing else arb(dx)
        if dy == 0.0:
            yield cosine * across, sine * across
        else:
            yield cosine * across - sine * arb(dy), sine * across + cosine * arb(dy)


def compute_contact_values(box: CandidateBox, unknowns: Sequence[Any]) -> list[Any]:
    """Return the four contact equations' values in mm at unknowns (psi, tail x, tail y, separation).

    The unknowns are balls, or power series with balls as coefficients; so are the values.
    """
    _, x, y, _ = unknowns
    _, *arms = list_turned_pegs(box, unknowns)
    return [
        compute_contact_value(row, measure_from_origin(row, (x + arm[0], y + arm[1])))
        for row, arm in zip(box.features, arms, strict=True)
    ]


def place_contacts(box: CandidateBox, unknowns: Sequence[arb]) -> BoxContacts:
    """Return the contacts of a candidate at balls of the unknowns (psi, tail x, tail y, separation)."""
    _, x, y, _ = unknowns
    (cosine, sine), *arms = list_turned_pegs(box, unknowns)
    centers, rays, normals, values, slopes = [], [], [], [], []
    for k, (row, turned) in enumerate(zip(box.features, arms, strict=True)):
        center = (x + turned[0], y + turned[1])
        ray = measure_from_origin(row, center)
        if row[IS_ARC] == 0.0:
            size = measure_axis_length(row)
            gradient = (row[AXIS_Y] / size, -row[AXIS_X] / size)
            normal = gradient
        else:
            gradient = (ray[0] / row[RADIUS], ray[1] / row[RADIUS])
            normal = gradient if row[SIGN] > 0.0 else (-gradient[0], -gradient[1])
        slope = [gradient[1] * turned[0] - gradient[0] * turned[1], gradient[0], gradient[1]]
        slope.append(gradient[0] * cosine + gradient[1] * sine if k >= box.standing else arb(0))
        centers.append(center)
        rays.append(ray)
        normals.append(normal)
        values.append(compute_contact_value(row, ray))
        slopes.append(slope)
    return BoxContacts(box.features, centers, rays, normals, arms, values, slopes, (cosine, sine))


def compute_slacks(box: CandidateBox, here: BoxContacts, minors: Sequence[arb], limits: Limits) -> list[arb]:
    """Return the numbers that must all be positive for a fixture, as balls.

    They belong to ends, gap, span, closure and clamping, with the sign of the forces that makes them larger.
    For one of two clamps (``limits.pairing``) they belong to ends and gap, the determinant of the fixed pegs'
    wrenches, and the clamp's push. ``minors`` are those of :func:`compute_wrench_minors`.
    """
    out = [
        slack
        for row, ray in zip(box.features, here.rays, strict=True)
        for slack in compute_end_slacks(row, ray, limits.contact_margin)
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


def compute_end_slacks(row: Sequence[float], ray: tuple[arb, arb], margin: float) -> list[arb]:
    """Return how far in mm, as balls, a contact is inside the high and the low end of its feature, beyond
    ``margin``.

    Negative if it breaks the rule of ends. Return an empty list for a whole circle. ``ray`` is the peg's
    centre as :func:`measure_from_origin` returns it.
    """
    dx, dy = ray
    along = dx * row[AXIS_X] + dy * row[AXIS_Y]
    to_high, to_low = row[HALF_EXTENT] - along, row[HALF_EXTENT] + along
    if row[IS_ARC] != 0.0:
        if row[HALF_EXTENT] >= pi:
            return []
        angle = arb.atan2(dy * row[AXIS_X] - dx * row[AXIS_Y], along)
        to_high, to_low = ((row[HALF_EXTENT] + way) * row[RADIUS] for way in (-angle, angle))
    return [to_high - margin + row[HIGH_SLACK], to_low - margin + row[LOW_SLACK]]


def compute_wrench_minors(here: BoxContacts, length: float) -> list[arb]:
    """Return the four signed 3 x 3 minors of the wrenches
    (n, q x n / L) as balls; minor k is that without contact k.
    """
    n = here.normals
    # The minors do not depend on the point that moments are taken about; from the first peg the others are
    # known best.
    t = [(q[0] * m[1] - q[1] * m[0]) / length for q, m in zip(here.arms, n, strict=True)]

    def cross(i: int, j: int) -> arb:
        """Return the cross product of the normals of contacts i and j as a ball."""
        one, two = here.rows[i], here.rows[j]
        if one[IS_ARC] == 0.0 or two[IS_ARC] == 0.0:
            return n[i][0] * n[j][1] - n[i][1] * n[j][0]
        # Between arcs only the difference of the rays from their centres counts, which depends on the
        # orientation alone where both pegs are on one carrier: parallel normals stay so wherever the part
        # slides.
        x = here.arms[j][0] - here.arms[i][0] - (arb(two[X]) - one[X]) - (arb(two[REST_X]) - one[REST_X])
        y = here.arms[j][1] - here.arms[i][1] - (arb(two[Y]) - one[Y]) - (arb(two[REST_Y]) - one[REST_Y])
        return (n[i][0] * y - n[i][1] * x) * (two[SIGN] / arb(two[RADIUS]))

    out, crossed = [], {pair: cross(*pair) for pair in combinations(range(4), 2)}
    for k in range(4):
        a, b, c = (i for i in range(4) if i != k)
        minor = t[a] * crossed[b, c] - t[b] * crossed[a, c] + t[c] * crossed[a, b]
        out.append(-minor if k % 2 else minor)
    return out


def is_empty(box: CandidateBox, here: BoxContacts, limits: Limits) -> bool:
    """Return whether a box certainly has no fixture: a contact equation has no zero in the box, or a rule is
    broken.

    ``here`` are the contacts on the box.
    """
    if any(value > 0 or value < 0 for value in here.values):
        return True
    minors = compute_wrench_minors(here, limits.wrench_length)
    if not limits.pairing and any(minor > 0 for minor in minors) and any(minor < 0 for minor in minors):
        # Of opposite signs, so that nothing closes.
        return True
    return any(slack < 0 for slack in compute_slacks(box, here, minors, limits))


def narrow_box(box: CandidateBox, limits: Limits) -> CandidateBox | None:
    """Return the part of a box that may meet the gap rule and all pairs of contacts with parallel lines; None
    for no part.

    The box itself is returned where neither psi nor the separation becomes narrower.
    """
    psi, separation = arb(box.middle[0], box.reach[0]), arb(box.middle[3], box.reach[3])
    if isfinite(limits.gap):
        left = max(x for x, _ in box.offsets[: box.standing])
        right = min(x for x, _ in box.offsets[box.standing :])
        least = arb(left) - right + limits.gap - GAP_SLACK
        high = separation.upper()
        if high < least:
            return None
        if separation.lower() < least:
            separation = least.lower().union(high)
    for one, other in find_parallel_lines(box):
        for _ in range(STEPS):
            closer = find_common_orientation(box, one, other, psi, separation)
            if closer is None:
                return None
            if not closer.rad() < psi.rad():
                break
            psi = closer
    turn, along = measure_extent(psi), measure_extent(separation)
    if turn[1] >= box.reach[0] and along[1] >= box.reach[3]:
        return box
    middle, reach = (
        (one, *rest[1:3], two) for one, rest, two in zip(turn, (box.middle, box.reach), along, strict=True)
    )
    return evolve(box, middle=middle, reach=reach)


def measure_extent(ball: arb) -> tuple[float, float]:
    """Return the middle of a ball as a double, and an upper bound of
    the distance from it to any point of the ball.
    """
    middle = float(ball.mid())
    reach = float((abs(ball - middle)).upper())
    return middle, nextafter(reach, inf)


def find_parallel_lines(box: CandidateBox) -> Iterator[tuple[int, int]]:
    """Yield pairs of contact numbers whose features are lines of exactly the same or opposite direction."""
    lines = [k for k, row in enumerate(box.features) if row[IS_ARC] == 0.0]
    for one, other in combinations(lines, 2):
        a, b = box.features[one], box.features[other]
        if arb(a[AXIS_X]) * b[AXIS_Y] - arb(a[AXIS_Y]) * b[AXIS_X] == 0:
            yield one, other


def find_common_orientation(box: CandidateBox, one: int, other: int, psi: arb, separation: arb) -> arb | None:
    """Return the part of the ball ``psi`` in which contacts ``one`` and ``other``, with parallel lines, may
    both touch; None for no part.

    Their difference is n R(psi) a - c. The arm a leads from one peg to the other, and c is the distance of
    their lines along the normal n = (cos phi, sin phi). Divided by a_x it is cos u - (a_y / a_x) sin u - c /
    a_x with u = psi - phi. ``separation`` enters through a_x alone, so it drops out where a_y and c are 0. A step of the
    interval Newton method in u makes psi smaller.
    """
    first, second = box.features[one], box.features[other]
    size = measure_axis_length(first)
    across, up = first[AXIS_Y] / size, -first[AXIS_X] / size
    moves = int(other >= box.standing) - int(one >= box.standing)
    (x, y), (far_x, far_y) = box.offsets[one], box.offsets[other]
    arm_x, arm_y = arb(far_x) - x + moves * separation, arb(far_y) - y
    if arm_x.contains(0):
        return psi
    apart = [
        arb(second[place]) - first[place] + second[rest] - first[rest]
        for place, rest in ((X, REST_X), (Y, REST_Y))
    ]
    slant, share = arm_y / arm_x, (across * apart[0] + up * apart[1]) / arm_x
    middle = arb(psi.mid())
    (cosine, sine), (mid_cosine, mid_sine) = (
        (across * angle.cos() + up * angle.sin(), across * angle.sin() - up * angle.cos())
        for angle in (psi, middle)
    )
    slope = -sine - slant * cosine
    if slope.contains(0):
        return psi if (cosine - slant * sine - share).contains(0) else None
    image = middle - (mid_cosine - slant * mid_sine - share) / slope
    return image.intersection(psi) if image.overlaps(psi) else None
