"""Makes a candidate's box smaller before it is cut: by the gap rule, and by contacts with parallel lines.

The gap rule bounds the separation alone. Two contacts with parallel lines make an equation of psi and the
separation, because the part's place is not in their difference. It is needed where both lines are one and two
pegs are in one row. Every separation meets all equations there, so the box is as long as the jaws open. No
turned box of the interval Newton method shows that psi is one angle there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf, isfinite, nextafter

from attrs import evolve, frozen
from flint import arb

from workhold.conventions import GAP_SLACK
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, REST_X, REST_Y, X, Y
from workhold.kernels.base.tables import Limits

__all__ = ["CandidateBox", "axis_length", "contact_value", "from_origin", "narrowed", "value_of_ray"]

# Newton steps of psi: each squares its error, so that these reach the precision in force.
STEPS = 4


@frozen
class CandidateBox:
    """A candidate: features touched, pegs' places, and where its solution may be.

    Parameters
    ----------
    features : four rows of ``geometry.segment.segment_rows``, each with the slack of both ends.
    offsets : four pegs' places in mm from the first peg, without the separation.
    standing : how many of the pegs, the first ones, are on the carrier that stands still.
    middle : psi in radians, tail x, tail y and separation in mm.
    reach : how far each may be off.
    """

    features: Sequence[Sequence[float]]
    offsets: Sequence[tuple[float, float]]
    standing: int
    middle: tuple[float, float, float, float]
    reach: tuple[float, float, float, float]


def from_origin(row: Sequence[float], point: tuple[arb, arb]) -> tuple[arb, arb]:
    """A point in mm from the middle of a line, or from the centre of an arc."""
    return point[0] - row[X] - row[REST_X], point[1] - row[Y] - row[REST_Y]


def contact_value(row: Sequence[float], center: tuple[arb, arb]) -> arb:
    """Contact equation in mm: distance from a line, or (distance² - R²) / 2R from an arc's centre."""
    return value_of_ray(row, from_origin(row, center))


def value_of_ray(row: Sequence[float], ray: tuple[arb, arb]) -> arb:
    """``contact_value`` of a place as ``from_origin`` gives it."""
    x, y = ray
    if row[IS_ARC] == 0.0:
        return (row[AXIS_Y] * x - row[AXIS_X] * y) / axis_length(row)
    return (x * x + y * y - arb(row[RADIUS]) ** 2) / (2 * arb(row[RADIUS]))


def axis_length(row: Sequence[float]) -> arb:
    """The length of a line's axis, which rounding makes other than 1."""
    return (arb(row[AXIS_X]) ** 2 + arb(row[AXIS_Y]) ** 2).sqrt()


def narrowed(box: CandidateBox, limits: Limits) -> CandidateBox | None:
    """The part of a box that meets the gap rule and all pairs of parallel lines; None where nothing does."""
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
    for one, other in parallel_lines(box):
        for _ in range(STEPS):
            closer = turned_onto(box, one, other, psi, separation)
            if closer is None:
                return None
            if not closer.rad() < psi.rad():
                break
            psi = closer
    turn, along = extent(psi), extent(separation)
    if turn[1] >= box.reach[0] and along[1] >= box.reach[3]:
        return box
    return evolve(
        box,
        middle=(turn[0], *box.middle[1:3], along[0]),
        reach=(turn[1], *box.reach[1:3], along[1]),
    )


def extent(ball: arb) -> tuple[float, float]:
    """The middle of a ball as a double, and how far around it the ball reaches at most."""
    middle = float(ball.mid())
    reach = float((abs(ball - middle)).upper())
    return middle, nextafter(reach, inf)


def parallel_lines(box: CandidateBox) -> Iterator[tuple[int, int]]:
    """Pairs of contacts whose features are lines of exactly one direction."""
    lines = [k for k, row in enumerate(box.features) if row[IS_ARC] == 0.0]
    for n, one in enumerate(lines):
        for other in lines[n + 1 :]:
            a, b = box.features[one], box.features[other]
            if arb(a[AXIS_X]) * b[AXIS_Y] - arb(a[AXIS_Y]) * b[AXIS_X] == 0:
                yield one, other


def turned_onto(box: CandidateBox, one: int, other: int, psi: arb, separation: arb) -> arb | None:
    """The part of psi at which two contacts with parallel lines may both touch; None where none is.

    Their difference is n R(psi) a - c. The arm a leads from one peg to the other, and c is the distance of
    their lines along the normal n = (cos phi, sin phi). Divided by a_x it is cos u - (a_y / a_x) sin u -
    c / a_x with u = psi - phi. So the separation in a_x does not count where a_y and c are 0. A step of the
    interval Newton method in u makes psi smaller.
    """
    first, second = box.features[one], box.features[other]
    size = (arb(first[AXIS_X]) ** 2 + arb(first[AXIS_Y]) ** 2).sqrt()
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
