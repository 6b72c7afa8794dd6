"""Self-motions of a part between pegs: it slides on parallel faces, or turns on concentric arcs.

Glossary
-------- self-motion : a motion of a mechanism that leaves its output as it is, here of the part while the
separation stays: J. W.
    Burdick, "On the inverse kinematics of redundant manipulators: characterization of the self-motion
    manifolds", IEEE International Conference on Robotics and Automation (1989).
"""

from __future__ import annotations

from itertools import combinations, product
from math import asin, atan2, cos, hypot, sin, sqrt, tau

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import PARALLEL
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, X, Y
from workhold.kernels.seating.columns import Given
from workhold.kernels.seating.parallel import (
    AT_HIGH,
    AT_LOW,
    AT_SEPARATION,
    AT_THETA,
    OF_SLIDE,
    ON_THIRD,
    THIRD,
    THREE_FACES,
    on_three_faces,
)
from workhold.kernels.seating.slides import SLIDE_FIRST, SLIDE_ONE, SLIDE_SECOND, SLIDE_TWO
from workhold.seating.growing_rows import filled
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.pattern import Pattern

__all__ = ["Opposed", "SelfMotion", "on_one_center", "on_one_line", "on_parallel_lines", "turning"]

Array = NDArray[np.float64]
Point = tuple[float, float]
PegOnPiece = tuple[int, int]
# Configurations along a slide, and along a turn.
SLIDE_STEPS, TURN_STEPS = 144, 384
# mm. Shorter slides are none; separations this near are one.
SHORTEST, SAME = 1e-6, 1e-6
# Numbers of the configurations of a slide.
EVEN = np.arange(SLIDE_STEPS, dtype=np.float64)
# A force's share below this is none.
LEAST_SHARE = 1e-9


@frozen(eq=False)
class SelfMotion:
    """Configurations of one separation through which the part can move while some contacts stay.

    Parameters
    ----------
    configs : (N, 4) along it.
    contacts : pegs and the pieces that they touch all along.
    is_closed : whether the last one is beside the first.
    across : (2,) direction in which the part gives way to both sides, or None where it does not.
    """

    configs: Array
    contacts: list[PegOnPiece]
    is_closed: bool
    across: tuple[float, float] | None


@frozen
class Opposed:
    """Two straight pieces that face away from each other, of a peg that stands still and of one that moves.

    Parameters
    ----------
    pieces : their numbers.
    width : from the first to the second in mm along the second's normal, below 0 where they face each other.
    angle : of that normal in radians.
    low, high : parameters of the first between which both are beside each other.
    """

    pieces: tuple[int, int]
    width: float
    angle: float
    low: float
    high: float


def opposed_lines(boundary: ObstacleBoundary) -> list[Opposed]:
    """All pairs of opposed straight pieces of a part."""
    rows, found = boundary.rows.tolist(), list[Opposed]()
    standing, moving = (
        [k for k in range(first, end) if rows[k][IS_ARC] == 0.0] for first, end in boundary.parts.tolist()
    )
    for a, b in product(standing, moving):
        one, two = rows[a], rows[b]
        if abs(one[AXIS_X] + two[AXIS_X]) + abs(one[AXIS_Y] + two[AXIS_Y]) > PARALLEL:
            continue
        ux, uy, dx, dy = -one[AXIS_Y], one[AXIS_X], two[X] - one[X], two[Y] - one[Y]
        shift = dx * one[AXIS_X] + dy * one[AXIS_Y]
        low = max(-one[HALF_EXTENT], shift - two[HALF_EXTENT])
        high = min(one[HALF_EXTENT], shift + two[HALF_EXTENT])
        found.append(Opposed((a, b), dx * ux + dy * uy, atan2(uy, ux), low, high))
    return found


def sliding(
    pattern: Pattern,
    theta: float,
    start: Point,
    line: Array,
    low: float,
    high: float,
    s: float,
    contacts: list[PegOnPiece],
) -> list[SelfMotion]:
    """The motion of a part that slides on a peg at ``start`` along a line, from one parameter to another."""
    if high - low < SHORTEST or not pattern.reaches(s, SAME):
        return []
    t = EVEN * ((high - low) / EVEN[-1]) + low
    t[-1] = high
    x, y, c, d = line[X] + t * line[AXIS_X], line[Y] + t * line[AXIS_Y], cos(theta), sin(theta)
    configs = np.empty((SLIDE_STEPS, 4))
    configs[:, 0], configs[:, 3] = theta, s
    configs[:, 1], configs[:, 2] = start[0] - (c * x - d * y), start[1] - (d * x + c * y)
    return [SelfMotion(configs, contacts, False, None)]


def turning(
    pattern: Pattern, row: Array, center: Point, s: float, contacts: list[PegOnPiece], across: Point | None
) -> list[SelfMotion]:
    """The motion of a part that turns about an arc's centre, which is at a place in the closing frame."""
    if not pattern.reaches(s, SAME):
        return []
    theta = np.arange(TURN_STEPS) * tau / TURN_STEPS
    c, d = np.cos(theta), np.sin(theta)
    x, y = center[0] - (c * row[X] - d * row[Y]), center[1] - (d * row[X] + c * row[Y])
    return [SelfMotion(np.stack([theta, x, y, np.full(TURN_STEPS, s)], axis=1), contacts, True, across)]


def on_one_line(boundary: ObstacleBoundary, pattern: Pattern) -> list[SelfMotion]:
    """Self-motions on two pegs that press parallel faces, or arcs of one centre, along one line."""
    out, pegs, right = list[SelfMotion](), pattern.pegs.tolist(), pattern.right.tolist()
    for i, j in product(range(len(pegs)), repeat=2):
        if not right[i] < right[j]:
            continue
        run, rise = pegs[j][0] - pegs[i][0], pegs[j][1] - pegs[i][1]
        least = abs(rise) * (1.0 + 1e-12)
        for pair in boundary.once(opposed_lines):
            if abs(pair.width) > least:
                a, b = pair.pieces
                omega = asin(rise / pair.width)
                theta, s = omega - pair.angle, pair.width * cos(omega) - run
                out += sliding(pattern, theta, pegs[i], boundary.rows[a], pair.low, pair.high, s, [(i, a), (j, b)])
        for standing, moving in boundary.rings:
            for (a, one), (b, two) in product(standing, moving):
                d = one + two
                if abs(d) <= max(least, SHORTEST):
                    continue
                omega = asin(rise / d)
                center = pegs[i][0] + one * cos(omega), pegs[i][1] + one * sin(omega)
                # Square to the line the centre gives way where both arcs bend away.
                falls = 2.0 / d < 1.0 / one + 1.0 / two - 1e-12
                across = (-sin(omega), cos(omega)) if falls else None
                out += turning(pattern, boundary.rows[a], center, d * cos(omega) - run, [(i, a), (j, b)], across)
    return out


def on_parallel_lines(boundary: ObstacleBoundary, pattern: Pattern, slides: Array, given: Given) -> list[SelfMotion]:
    """Self-motions on parallel faces: the middle one of three pegs presses against the outer two.

    Parameters
    ----------
    slides : (S, 7) of the two pegs of one jaw.
    """
    if not len(slides):
        return []
    out = list[SelfMotion]()
    for row in filled(THREE_FACES, 64, on_three_faces, slides, given, pattern.stop, pattern.widest):
        slide = slides[int(row[OF_SLIDE])]
        first, a, s = int(slide[SLIDE_FIRST]), int(slide[SLIDE_ONE]), float(row[AT_SEPARATION])
        contacts = [
            (first, a),
            (int(slide[SLIDE_SECOND]), int(slide[SLIDE_TWO])),
            (int(row[THIRD]), int(row[ON_THIRD])),
        ]
        x, y = pattern.pegs[first].tolist()
        start = x + s * int(pattern.right[first]), y
        out += sliding(pattern, row[AT_THETA], start, boundary.rows[a], row[AT_LOW], row[AT_HIGH], s, contacts)
    return out


def on_one_center(boundary: ObstacleBoundary, pattern: Pattern) -> list[SelfMotion]:
    """Self-motions on two pegs of one jaw and one of the other, all on arcs of one centre."""
    out, pegs, right = list[SelfMotion](), pattern.pegs.tolist(), pattern.right.tolist()
    pairs = [(p, q) for p, q in combinations(range(len(right)), 2) if right[p] == right[q]]
    for ring, (p, q) in product(boundary.rings, pairs):
        side, others = right[p], [k for k in range(len(right)) if right[k] != right[p]]
        for (a, one), (b, two) in product(ring[side], repeat=2):
            for x, y in circles_meet(pegs[p], abs(one), pegs[q], abs(two)):
                for (c, three), k in product(ring[1 - side], others):
                    square = abs(three) ** 2 - (y - pegs[k][1]) ** 2
                    for turn in (1.0, -1.0) if square >= 0.0 else ():
                        at = x + turn * sqrt(square)
                        s = at - pegs[k][0] if right[k] == 1 else pegs[k][0] - at
                        if not pattern.reaches(s, SAME):
                            continue
                        center = x + s * side, y
                        normals = [
                            ((pegs[peg][0] + s * right[peg] - center[0]) / signed, (pegs[peg][1] - y) / signed)
                            for peg, signed in ((p, one), (q, two), (k, three))
                        ]
                        if balance(normals, [side, side, 1 - side]):
                            out += turning(pattern, boundary.rows[a], center, s, [(p, a), (q, b), (k, c)], None)
    return out


def balance(normals: list[Point], moves: list[int]) -> bool:
    """Whether forces of three pegs through one centre balance the jaw's; ``moves`` is 1 for pegs that move."""
    (ax, ay), (bx, by), (cx, cy) = normals
    # As much of each as the other two span, which leaves nothing over, per unit of what presses along x.
    forces = bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx
    total = sum(force * x * move for force, (x, _), move in zip(forces, normals, moves, strict=True))
    return abs(total) >= LEAST_SHARE and all(force / total > LEAST_SHARE for force in forces)


def circles_meet(one: Point, r1: float, two: Point, r2: float) -> list[Point]:
    """The points at given distances from two places."""
    dx, dy = two[0] - one[0], two[1] - one[1]
    d = hypot(dx, dy)
    along = (d * d + r1 * r1 - r2 * r2) / (2.0 * d)
    square = r1 * r1 - along * along
    if square < 0.0:
        return []
    ex, ey, half = dx / d, dy / d, sqrt(square)
    return [(one[0] + along * ex - t * half * ey, one[1] + along * ey + t * half * ex) for t in (1.0, -1.0)]
