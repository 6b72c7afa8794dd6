"""What is warned of in a fixture and what counts against it, in balls (docs/quality.md).

A count is a ball, too: where a figure may be on either side of the number that decides, by what the file's numbers may be
off, the ball holds both counts.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from itertools import accumulate
from math import atan2, ceil, degrees

from flint import arb

from workhold.verification.contacts import BallPose
from workhold.verification.sides import LineSide, Side
from workhold.verification.tolerances import (
    GENTLE_PEG,
    HAIR,
    LARGE_LOCATION_ERROR,
    MAIN_DIRECTION,
    NEAR_EDGE,
    POINTS_PER_DECADE,
    SMALL_FACE,
    SMALL_FACE_POINTS,
    SQUARE_TILT,
    STRONG_PEG,
    STRONG_POINTS,
    TILTED_POINTS,
    WEAK_CLOSURE,
)

__all__ = ["main_direction", "penalty", "tilt", "warnings"]


def main_direction(faces: Sequence[Side]) -> arb:
    """Direction in degrees of the straight faces that, with those along or square to them, have the most length.

    The longest of them counts, the first of equally long ones. Which they are is asked in doubles. The drawing's own x
    where there are none, or others have about as much.
    """
    lines = [side for side in faces if isinstance(side, LineSide)]
    if not lines:
        return arb(0)
    rough = [degrees(atan2(float(s.tangent[1].mid()), float(s.tangent[0].mid()))) % 90.0 for s in lines]
    lengths = [float(line.length.mid()) for line in lines]
    # Once more a quarter turn below and above, so that 0 and 90 degrees are neighbours.
    around = sorted(
        (angle + turn, length) for angle, length in zip(rough, lengths, strict=True) for turn in (-90.0, 0.0, 90.0)
    )
    places, sums = [angle for angle, _ in around], [0.0, *accumulate(length for _, length in around)]

    def total(angle: float) -> float:
        return sums[bisect_right(places, angle + SQUARE_TILT)] - sums[bisect_left(places, angle - SQUARE_TILT)]

    totals = [total(angle) for angle in rough]
    rivals = [k for k, sum_ in enumerate(totals) if sum_ >= MAIN_DIRECTION * max(totals)]
    first = max(rivals, key=lambda k: round(lengths[k], 9))
    if any(abs((rough[k] - rough[first] + 45.0) % 90.0 - 45.0) >= 2 * SQUARE_TILT for k in rivals):
        return arb(0)
    along = lines[first].tangent
    return arb.atan2(along[1], along[0]) * 180 / arb.pi()


def tilt(pose: BallPose, direction: arb) -> arb:
    """Angle in degrees between the main direction and the nearest of the jaws' two; 0 where that counts as square."""
    angle = pose.theta * 180 / arb.pi() + direction
    off = abs(angle - 90 * round(float(angle.mid()) / 90))
    within = SQUARE_TILT - off
    return off if within < -HAIR else arb(0) if within > HAIR else off.union(arb(0))


def counted(low: int, high: int) -> arb:
    """A count between two whole numbers."""
    return arb(low).union(arb(high)) if low < high else arb(low)


def over(value: arb, limit: arb | float, part: arb) -> tuple[int, int]:
    """Whether a value is above a limit, at least and at most, when it may be off by a part of itself and a hair."""
    spare = HAIR + part * abs(value)
    above = value - limit
    return int(bool(above > spare)), int(not above < -spare)


def within_sum(pairs: Sequence[tuple[int, int]]) -> arb:
    """The count of several things."""
    return counted(sum(low for low, _ in pairs), sum(high for _, high in pairs))


def warnings(figures: Mapping[str, arb], edges: Sequence[arb], off: arb, jaw_force: float | None, part: arb) -> arb:
    """How many warnings there are: contacts near an edge, a weak closure, a strong peg, a large location error, a peg that
    lets go; ``off`` is the sum of the tolerances in mm and ``part`` how far the file's figures may be off."""
    pairs = [over(-edge, -NEAR_EDGE, part) for edge in edges]
    pairs.append(over(-figures["closure_margin"], -WEAK_CLOSURE, part))
    pairs.append(over(figures["clamp_amplification"], STRONG_PEG, part))
    pairs.append(over(figures["location_error"], LARGE_LOCATION_ERROR * off, part))
    if jaw_force is not None and "jaw_force_needed" in figures:
        pairs.append(over(figures["jaw_force_needed"], arb(jaw_force) * (1 + arb(HAIR)), part))
    return within_sum(pairs)


def penalty(figures: Mapping[str, arb], off: arb, diameter: float, part: arb) -> arb:
    """Points for the location error, rounded up, and for a tilt (which is 0 or more than the square one), a strong peg and a
    small face."""
    points = [(0, 0)]
    if off > 0:
        steps = POINTS_PER_DECADE * (figures["location_error"] / off).log() / arb(10).log()
        # A step is worth ten times its share of the error, and a little.
        spare = 2 * HAIR + 10 * float(part.mid())
        points = [(ceil(float(steps.lower()) - spare), ceil(float(steps.upper()) + spare - 2 * HAIR))]
    weights = (
        (over(figures["tilt"], SQUARE_TILT / 2, part), TILTED_POINTS),
        (over(figures["clamp_amplification"], GENTLE_PEG, part), STRONG_POINTS),
        (over(-figures["smallest_face"], -SMALL_FACE * arb(diameter), part), SMALL_FACE_POINTS),
    )
    return within_sum([*points, *((weight * low, weight * high) for (low, high), weight in weights)])
