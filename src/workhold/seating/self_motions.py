"""Self-motions of a part between pegs, and equilibrium manifolds, along which the part rests anywhere.

Glossary
--------
self-motion : a motion of a mechanism that does not change its output; here a motion of the part at constant
    separation: J. W. Burdick, "On the inverse kinematics of redundant manipulators: characterization of the
    self-motion manifolds", IEEE International Conference on Robotics and Automation (1989).
equilibrium manifold : a continuum of equilibria at one separation, along the self-motions of the part: a
    nondegenerate critical manifold of R. Bott, "Nondegenerate critical manifolds", Annals of Mathematics 60
    (1954).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import combinations, product
from math import asin, atan2, cos, hypot, nan, sin, sqrt, tau

import numpy as np
from attrs import define, frozen
from numpy.typing import NDArray

from workhold.conventions import PARALLEL
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, X, Y
from workhold.kernels.seating.columns import HeldPart, Manifolds, Obstacles, SelfMotions
from workhold.kernels.seating.freedom import keep_free, write_free_runs
from workhold.kernels.seating.gathering import write_distinct_sets
from workhold.kernels.seating.parallel_and_concentric import (
    AT_HIGH,
    AT_LOW,
    AT_SEPARATION,
    AT_THETA,
    OF_SLIDE,
    ON_THIRD,
    THIRD,
    THREE_FACES,
    write_on_three_faces,
)
from workhold.kernels.seating.slides import SLIDE_FIRST, SLIDE_ONE, SLIDE_SECOND, SLIDE_TWO
from workhold.seating.closing import fill_rows
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.pattern import Pattern, PegSubset

__all__ = [
    "ManifoldFinder",
    "OpposedLines",
    "SelfMotion",
    "join_manifolds",
    "find_pattern_motions",
    "find_motions_on_one_center",
    "find_motions_on_one_line",
    "find_motions_on_parallel_lines",
    "make_turning_motion",
]

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
    """A motion of the part at constant separation during which some contacts are kept, as a sequence of
    configurations.

    Parameters
    ----------
    configs : (N, 4) theta, x, y, S along the motion.
    contacts : pairs (peg, piece) of the contacts that are kept.
    is_closed : whether the motion is a loop: the last configuration is next to the first.
    across : (2,) direction in x and y in which the part can leave the motion, to both sides, as the
        separation falls; None if there is none.
    """

    configs: Array
    contacts: list[PegOnPiece]
    is_closed: bool
    across: tuple[float, float] | None


@frozen
class OpposedLines:
    """Two parallel straight pieces with opposite outward normals.

    The first is for a fixed peg, the second for a moving one.

    Parameters
    ----------
    pieces : indices of the two pieces.
    width : distance in mm from the first to the second along the second's normal, negative where the normals
        point towards each other.
    angle : direction of the second's normal in radians.
    low, high : the two overlap between these parameters of the first piece, in mm; low > high if they do not
        overlap.
    """

    pieces: tuple[int, int]
    width: float
    angle: float
    low: float
    high: float


def list_opposed_lines(boundary: ObstacleBoundary) -> list[OpposedLines]:
    """Return all pairs of opposed lines of a boundary."""
    rows, found = boundary.rows.tolist(), list[OpposedLines]()
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
        found.append(OpposedLines((a, b), dx * ux + dy * uy, atan2(uy, ux), low, high))
    return found


def make_sliding_motion(
    pattern: Pattern,
    theta: float,
    start: Point,
    line: Array,
    low: float,
    high: float,
    s: float,
    contacts: list[PegOnPiece],
) -> list[SelfMotion]:
    """Return the motion of a part that slides along a straight piece on a peg, as a list with one element.

    The list is empty where the slide is too short, or the separation out of the pattern's range.

    Parameters
    ----------
    theta : orientation of the part in radians.
    start : place of the peg in the closing frame, in mm.
    line : row (10,) of the piece.
    low, high : parameters on the piece in mm between which the peg slides.
    s : separation in mm.
    contacts : pairs (peg, piece) of the contacts that are kept.
    """
    if high - low < SHORTEST or not pattern.is_reachable(s, SAME):
        return []
    t = EVEN * ((high - low) / EVEN[-1]) + low
    t[-1] = high
    x, y, c, d = line[X] + t * line[AXIS_X], line[Y] + t * line[AXIS_Y], cos(theta), sin(theta)
    configs = np.empty((SLIDE_STEPS, 4))
    configs[:, 0], configs[:, 3] = theta, s
    configs[:, 1], configs[:, 2] = start[0] - (c * x - d * y), start[1] - (d * x + c * y)
    return [SelfMotion(configs, contacts, False, None)]


def make_turning_motion(
    pattern: Pattern, row: Array, center: Point, s: float, contacts: list[PegOnPiece], across: Point | None
) -> list[SelfMotion]:
    """Return the motion of a part that turns a whole turn about the centre of an arc, as a list with one
    element.

    The list is empty where the separation is out of the pattern's range.

    Parameters
    ----------
    row : row (10,) of the arc.
    center : place of the arc's centre in the closing frame, in mm.
    s : separation in mm.
    contacts, across : see ``SelfMotion``.
    """
    if not pattern.is_reachable(s, SAME):
        return []
    theta = np.arange(TURN_STEPS) * tau / TURN_STEPS
    c, d = np.cos(theta), np.sin(theta)
    x, y = center[0] - (c * row[X] - d * row[Y]), center[1] - (d * row[X] + c * row[Y])
    return [SelfMotion(np.stack([theta, x, y, np.full(TURN_STEPS, s)], axis=1), contacts, True, across)]


def find_motions_on_one_line(boundary: ObstacleBoundary, pattern: Pattern) -> list[SelfMotion]:
    """Return the motions of a part at constant separation between two pegs, one of each jaw, that press along
    one line.

    The pegs touch parallel faces, along which the part slides, or arcs of one centre, about which it turns.
    """
    out, pegs, right = list[SelfMotion](), pattern.pegs.tolist(), pattern.right.tolist()
    for i, j in product(range(len(pegs)), repeat=2):
        if not right[i] < right[j]:
            continue
        run, rise = pegs[j][0] - pegs[i][0], pegs[j][1] - pegs[i][1]
        least = abs(rise) * (1.0 + 1e-12)
        for pair in boundary.find_once(list_opposed_lines):
            if abs(pair.width) > least:
                a, b = pair.pieces
                omega = asin(rise / pair.width)
                theta, s = omega - pair.angle, pair.width * cos(omega) - run
                out += make_sliding_motion(
                    pattern, theta, pegs[i], boundary.rows[a], pair.low, pair.high, s, [(i, a), (j, b)]
                )
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
                out += make_turning_motion(
                    pattern, boundary.rows[a], center, d * cos(omega) - run, [(i, a), (j, b)], across
                )
    return out


def find_motions_on_parallel_lines(
    boundary: ObstacleBoundary, pattern: Pattern, slides: Array, given: HeldPart
) -> list[SelfMotion]:
    """Return the motions of a part at constant separation between three pegs that touch parallel faces, along
    which it slides.

    The middle peg presses against the two outer ones. ``slides`` (S, 7) are pairs of contacts of two pegs of
    one jaw, see ``kernels.seating.slides``.
    """
    if not len(slides):
        return []
    out = list[SelfMotion]()
    for row in fill_rows(THREE_FACES, 64, write_on_three_faces, slides, given, pattern.stop, pattern.widest):
        slide = slides[int(row[OF_SLIDE])]
        first, a, s = int(slide[SLIDE_FIRST]), int(slide[SLIDE_ONE]), float(row[AT_SEPARATION])
        contacts = [
            (first, a),
            (int(slide[SLIDE_SECOND]), int(slide[SLIDE_TWO])),
            (int(row[THIRD]), int(row[ON_THIRD])),
        ]
        x, y = pattern.pegs[first].tolist()
        start = x + s * int(pattern.right[first]), y
        out += make_sliding_motion(
            pattern, row[AT_THETA], start, boundary.rows[a], row[AT_LOW], row[AT_HIGH], s, contacts
        )
    return out


def find_motions_on_one_center(boundary: ObstacleBoundary, pattern: Pattern) -> list[SelfMotion]:
    """Return the motions of a part at constant separation between three pegs on arcs of one centre, about
    which it turns.

    Two pegs belong to one jaw, one to the other.
    """
    out, pegs, right = list[SelfMotion](), pattern.pegs.tolist(), pattern.right.tolist()
    pairs = [(p, q) for p, q in combinations(range(len(right)), 2) if right[p] == right[q]]
    for ring, (p, q) in product(boundary.rings, pairs):
        side, others = right[p], [k for k in range(len(right)) if right[k] != right[p]]
        for (a, one), (b, two) in product(ring[side], repeat=2):
            for x, y in find_circle_crossings(pegs[p], abs(one), pegs[q], abs(two)):
                for (c, three), k in product(ring[1 - side], others):
                    square = abs(three) ** 2 - (y - pegs[k][1]) ** 2
                    for turn in (1.0, -1.0) if square >= 0.0 else ():
                        at = x + turn * sqrt(square)
                        s = at - pegs[k][0] if right[k] == 1 else pegs[k][0] - at
                        if not pattern.is_reachable(s, SAME):
                            continue
                        center = x + s * side, y
                        normals = [
                            (
                                (pegs[peg][0] + s * right[peg] - center[0]) / signed,
                                (pegs[peg][1] - y) / signed,
                            )
                            for peg, signed in ((p, one), (q, two), (k, three))
                        ]
                        if is_balanced(normals, [side, side, 1 - side]):
                            out += make_turning_motion(
                                pattern, boundary.rows[a], center, s, [(p, a), (q, b), (k, c)], None
                            )
    return out


def is_balanced(normals: list[Point], moves: list[int]) -> bool:
    """Return whether forces at three pegs, which can only press, can balance the jaw force.

    ``normals`` are the outward normals of the three contacts, whose lines meet in one point; their lengths do
    not matter. ``moves`` is 1 for a moving peg, else 0.
    """
    (ax, ay), (bx, by), (cx, cy) = normals
    # As much of each as the other two span, which leaves nothing over, per unit of what presses along x.
    forces = bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx
    total = sum(force * x * move for force, (x, _), move in zip(forces, normals, moves, strict=True))
    return abs(total) >= LEAST_SHARE and all(force / total > LEAST_SHARE for force in forces)


def find_circle_crossings(one: Point, r1: float, two: Point, r2: float) -> list[Point]:
    """Return the points where a circle around ``one`` with radius r1 meets a circle around ``two`` with
    radius r2, in mm.

    The list has two points (equal where the circles touch), or none.
    """
    dx, dy = two[0] - one[0], two[1] - one[1]
    d = hypot(dx, dy)
    along = (d * d + r1 * r1 - r2 * r2) / (2.0 * d)
    square = r1 * r1 - along * along
    if square < 0.0:
        return []
    ex, ey, half = dx / d, dy / d, sqrt(square)
    return [(one[0] + along * ex - t * half * ey, one[1] + along * ey + t * half * ex) for t in (1.0, -1.0)]


NO_MANIFOLDS = Manifolds.allocate(0, 0)
NO_MOTIONS = SelfMotions.allocate(0, 0)


def find_pattern_motions(found: Sequence[tuple[PegSubset, SelfMotions]]) -> SelfMotions:
    """Return the self-motions of all subsets of a pattern's pegs together.

    Their configurations and peg numbers are changed from those of the subsets to those of the pattern.
    """
    some = [(subset, motions) for subset, motions in found if len(motions.counts)]
    if not some:
        return NO_MOTIONS
    out = SelfMotions(*(np.concatenate(same) for same in zip(*(motions for _, motions in some), strict=True)))
    shifts = np.repeat(
        [subset.shift for subset, _ in some], [len(motions.configs) for _, motions in some], axis=0
    )
    np.add(out.configs, shifts, out=out.configs)
    numbers = [[*subset.numbers, -1, -1][:4] for subset, _ in some]
    return out._replace(pegs=np.repeat(numbers, [len(motions.counts) for _, motions in some], axis=0))


def join_manifolds(parts: Sequence[Manifolds]) -> Manifolds:
    """Return the sets of all ``parts`` in one ``Manifolds``, in the same order."""
    rows, configs, _, closed, across = (
        np.concatenate(same) for same in zip(NO_MANIFOLDS, *parts, strict=True)
    )
    counts = [np.diff(part.begins) for part in parts]
    return Manifolds(
        rows, configs, np.cumsum(np.concatenate([np.zeros(1, np.int64), *counts])), closed, across
    )


@define(frozen=True, eq=False, slots=False)
class ManifoldFinder:
    """A finder of loose sets: motions along which a part rests anywhere, for one pattern and one part.

    Parameters
    ----------
    boundary, pattern : boundary of the part, and pegs.
    """

    boundary: ObstacleBoundary
    pattern: Pattern

    @property
    def rows(self) -> Array:
        """The pieces (N, 10) of the boundary."""
        return self.boundary.rows

    @cached_property
    def lines(self) -> list[int]:
        """The indices of the straight pieces."""
        return np.flatnonzero(self.rows[:, IS_ARC] == 0.0).tolist()

    @cached_property
    def around(self) -> Obstacles:
        """The part and the pegs in the form that the kernels take; its size and stop are arbitrary and not
        used.
        """
        return self.boundary.make_obstacles(self.pattern, 1.0, 0.0)

    @property
    def obstacle_count(self) -> int:
        """The number of pegs, plus 1 for a wall."""
        return len(self.pattern.pegs) + (self.pattern.half_plane is not None)

    def find_free_motions(self, motions: Sequence[SelfMotion]) -> SelfMotions:
        """Return those motions on which the part is free in at least one configuration, with the pegs'
        clearances.

        The part is free if no peg enters it.
        """
        every = SelfMotions.allocate(len(motions), sum(len(motion.configs) for motion in motions))
        if not motions:
            return every
        np.concatenate([motion.configs for motion in motions], out=every.configs)
        every.pegs[:, : self.obstacle_count] = np.arange(self.obstacle_count)
        for k, motion in enumerate(motions):
            every.counts[k], every.closed[k] = len(motion.configs), motion.is_closed
            every.across[k] = motion.across or nan
            for peg, piece in motion.contacts:
                every.pieces[k, peg] = piece
        count = keep_free(every, self.around, np.empty((len(self.pattern.pegs) + 1, 4)))
        return every.take_first(count)

    def cut_into_manifolds(self, motions: SelfMotions) -> Manifolds:
        """Return the stretches of self-motions on which no peg enters the part, each as one set.

        Motions with a separation outside the pattern's range are left out.
        """
        if not len(motions.counts):
            return NO_MANIFOLDS
        # At least every second configuration hinders between runs; each has two ends besides.
        most, pegs = len(motions.configs) // 2 + len(motions.counts), len(self.pattern.pegs)
        out = Manifolds.allocate(most, len(motions.configs) + 2 * most)
        low, high = self.pattern.stop + SAME, self.pattern.widest - SAME
        clear, seen = np.empty((len(motions.configs), self.obstacle_count)), np.empty((pegs + 1, 4))
        touched, work = np.empty(pegs, np.int64), np.empty((4, 4))
        return out.take_first(
            write_free_runs(motions, low, high, self.around, clear, seen, touched, work, out)
        )

    def drop_contained(self, found: Manifolds) -> Manifolds:
        """Return the sets without those that are part of another set with as many contacts or more.

        They are in descending order of the number of contacts.
        """
        if not len(found.rows):
            return found
        out = Manifolds.allocate(len(found.rows), len(found.configs))
        return out.take_first(write_distinct_sets(found, 1.0, SAME, out))
