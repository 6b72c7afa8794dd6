"""A push by hand that presses a part against all of its locators.

A push along a line makes three locators without friction press with forces that are linear in the push. For a
push in a fixed direction at a point q + t e of a straight side, each of these forces is linear in t. So the
places on the side at which the push presses all three locators form an interval. Directions are tried every
half degree, within 60 degrees of the inward normal; points on arcs every two degrees, and corners.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import atan2, ceil, cos, degrees, pi, radians, sin

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import PARALLEL
from workhold.geometry.segment import Arc, Point, Segment
from workhold.model.straps import HandPush

__all__ = ["find_hand_push"]

Array = NDArray[np.float64]
# Degrees. Largest angle of a push from the inward normal, and the steps of directions and of points on arcs.
MOST_ASLANT, STEP, ARC_STEP = 60.0, 0.5, 2.0
# The least share of the push by which each locator must be pressed.
LEAST_SHARE = 1e-6
# Another push replaces a squarer one only if it presses the weakest locator harder by this part.
HARDER = 0.02


def find_hand_push(segments: Sequence[Segment], touched: Array, inward: Array) -> HandPush | None:
    """Return the push by hand that makes the least of the three locators' forces as large as possible.

    None where no push presses the part against all three.

    Parameters
    ----------
    segments : segments of the part's outer outline, in the plate's frame.
    touched : (3, 2) points in mm at which the locators touch the part.
    inward : (3, 2) unit vectors along which the locators push.
    """
    matrix = np.vstack([inward.T, touched[:, 0] * inward[:, 1] - touched[:, 1] * inward[:, 0]])
    size = np.array([1.0, 1.0, max(float(np.ptp(touched, axis=0).max()), 1.0)])
    if abs(np.linalg.det(matrix / size[:, None])) < PARALLEL:
        return None
    answers = -np.linalg.inv(matrix)
    best: HandPush | None = None
    least = LEAST_SHARE
    for start, along, turns in list_pushed_places(segments):
        for turn, how_far, shares in list_best_places(np.asarray(answers), start, along, turns):
            share = float(shares.min())
            if share > least * (1.0 + HARDER) or (best is None and share > least):
                least = share
                at = float(start[0] + how_far * along[0]), float(start[1] + how_far * along[1])
                best = HandPush(at, round(degrees(turn), 9) % 360.0, tuple(shares.tolist()))
    return best


def list_pushed_places(segments: Sequence[Segment]) -> Iterator[tuple[Point, Point, Array]]:
    """Yield (start, vector to the end, directions in radians (D,)) for
    each place on the outline at which to try a push.

    Sides are stretches; points on arcs and corners have a zero vector. On sides and arcs the direction
    nearest to the inward normal comes first.
    """
    steps = np.arange(0.0, MOST_ASLANT + STEP / 2, STEP)
    fan = np.radians(np.unique(np.concatenate([-steps, steps])))
    fan = fan[np.argsort(np.abs(fan), kind="stable")]
    for one in segments:
        if isinstance(one, Arc):
            count = max(ceil(degrees(2 * one.half_sweep) / ARC_STEP), 1)
            parameters = np.linspace(-one.half_sweep, one.half_sweep, count + 1)
            for angle in parameters + one.mid_angle:
                x, y = cos(angle), sin(angle)
                inside = atan2(-one.sign * y, -one.sign * x)
                point = one.center[0] + one.radius * x, one.center[1] + one.radius * y
                yield point, (0.0, 0.0), inside + fan
        else:
            nx, ny = one.compute_normal()
            (x0, y0), (x1, y1) = one.start, one.end
            yield (x0, y0), (x1 - x0, y1 - y0), atan2(-ny, -nx) + fan
    yield from list_corners(segments)


def list_corners(segments: Sequence[Segment]) -> Iterator[tuple[Point, Point, Array]]:
    """Yield convex corners in the form of :func:`list_pushed_places`.

    Their directions lie between the inward normals of both sides.
    """
    ends = {one.end: one for one in segments}
    for one in segments:
        before = ends.get(one.start)
        if before is None or before is one:
            continue
        half, other_half = before.half_extent, one.half_extent
        (ax, ay), (bx, by) = before.compute_normal(half), one.compute_normal(-other_half)
        turn = atan2(ax * by - ay * bx, ax * bx + ay * by)
        if turn > radians(STEP):
            first = atan2(-ay, -ax)
            yield one.start, (0.0, 0.0), np.arange(first, first + turn, radians(STEP))


def list_best_places(
    answers: Array, start: Point, along: Point, turns: Array
) -> Iterator[tuple[float, float, Array]]:
    """Yield (direction in radians, position on the stretch, the locators' shares (3,)) for pushes that press
    all three locators.

    There is at most one for each direction: the position, from 0 to 1, at which the least share is largest.

    Parameters
    ----------
    answers : (3, 3) the locators' forces for a unit force along x, a unit force along y, and a unit moment.
    start, along : start of the stretch, and the vector to its end, in mm.
    turns : (D,) directions in radians.
    """
    ways = np.column_stack([np.cos(turns), np.sin(turns)])
    moment, grows = (point[0] * ways[:, 1] - point[1] * ways[:, 0] for point in (start, along))
    fixed = np.column_stack([ways, moment]) @ answers.T
    slope = grows[:, None] * answers[:, 2]
    # The least of three lines is greatest at an end, or where two of them cross.
    places = [np.zeros(len(turns)), np.ones(len(turns)), np.full(len(turns), 0.5)]
    for k, m in ((0, 1), (0, 2), (1, 2)):
        off = slope[:, k] - slope[:, m]
        places.append(
            np.clip((fixed[:, m] - fixed[:, k]) / np.where(np.abs(off) < 1e-12, np.inf, off), 0.0, 1.0)
        )
    shares = fixed[:, None, :] + np.column_stack(places)[:, :, None] * slope[:, None, :]
    least = shares.min(axis=2)
    # Where all places are equally good the middle is chosen.
    chosen = np.where(least[:, 2] >= least.max(axis=1) - 1e-9, 2, least.argmax(axis=1))
    for number in np.flatnonzero(least.max(axis=1) > LEAST_SHARE):
        place = int(chosen[number])
        yield float(turns[number] % (2 * pi)), float(places[place][number]), shares[number, place]
