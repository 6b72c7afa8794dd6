"""Two pegs of one lattice that touch a part flush on a wall: where they stand, and whether they press it.

On a hull edge the part's orientation and height are fixed. A lattice that slides toward the wall leaves two
unknowns, its place along the wall and its distance. Each pair of pegs gives two equations. The first peg's
centre lies on the offset curve of the face it touches. It also lies on that of the second peg's face, moved
back by the difference of their holes. So pairs are the crossings of one curve with the other, moved by a step
of the lattice. Two lines have one crossing; a line and a circle, or two circles, have two.

Where two curves have a common stretch (parallel lines, equal arcs about one centre) or only graze each other,
both normals are parallel there. With the wall's they then span no space, so nothing closes (``compute_pair_closure``).

Bounds of the error. Places in the wall's frame are exact to ``off`` mm and directions to ``turn`` radians
(``PartOnWall``). A crossing is off by ``off`` over the sine of the angle between both normals. This holds as
long as that turns no normal by a tenth of the angle. Elsewhere there is no bound, and the pair is decided in
balls.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import inf

import numpy as np
from attrs import evolve, field, frozen
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import LEAST_CLAMPING, LEAST_CLOSURE, LEAST_SPAN, LOOSE, PARALLEL, SAME_PLACE
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    HIGH_SLACK,
    IS_ARC,
    LOW_SLACK,
    RADIUS,
    SIGN,
    X,
    Y,
)
from workhold.kernels.contact.rules import ROUNDING
from workhold.listing.canonical_form import Rows
from workhold.proof.flush import LatticePair, decide_pair
from workhold.search.flush_search import PartOnWall

__all__ = ["LatticePairs", "select_pressed_pairs", "find_pairs_on_edge"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Pairs of features and steps of the lattice looked at together.
TOGETHER = 1 << 19
# mm. Contacts of which no bound is known are off by less: the root of roundings times the size of a part.
GRAZING = 1e-2
# Sine of the angle between two normals over the angle by which an error may turn one, at least.
STEEP = 10.0


@frozen(eq=False)
class LatticePairs(Rows):
    """N pairs of pegs of one lattice that touch a part on a wall.

    Parameters
    ----------
    feature : (N, 2) touched by the first peg, whose hole has the lower column or, in one column, row, and by
        the second.
    step : (N, 2) columns and rows from the first peg's hole to the second's.
    branch : (N,) -1 or 1, which of two crossings it is; 1 of two lines.
    point : (N, 2, 2) centres of both pegs, in mm along the hull edge from its start and above it.
    normal : (N, 2, 2) outward unit normals of the part there.
    slack : (N,) by how many mm the contact nearer to an end of its feature is inside it; infinite on whole
        circles.
    reach, swing : (N,) by how many mm places and by how many radians normals may be off; infinite where that
        is not known.
    null : (N, 4) forces of the wall's two ends and both pegs, not scaled.
    """

    feature: IntArray
    step: IntArray
    branch: Array
    point: Array
    normal: Array
    slack: Array
    reach: Array
    swing: Array
    null: Array = field()

    @null.default
    def _unknown(self) -> Array:
        return np.zeros((len(self.branch), 4))

    def candidate(self, number: int, edge: int) -> LatticePair:
        """A pair on a hull edge as balls decide it."""
        features, step = (tuple(values[number].tolist()) for values in (self.feature, self.step))
        return LatticePair(edge, features, step, int(self.branch[number]))


def find_pairs_on_edge(
    lying: PartOnWall, pitch: tuple[float, float], most: tuple[float, float], margin: float
) -> Iterator[LatticePairs]:
    """The pairs of pegs that touch a part on a wall, nearly ``margin`` mm inside their features or farther.

    Parameters
    ----------
    pitch : distances in mm between neighbouring columns and rows.
    most : the most columns and rows from one peg to the other; infinite where nothing bounds them.
    margin : smallest distance in mm from the end of a feature.
    """
    rows = lying.rows
    low, high = extents(rows)
    # Normals must have opposed parts along the wall, which arcs may have either way and level lines have not.
    ahead = rows[:, AXIS_Y]
    across = np.where(np.abs(ahead) > 4.0 * lying.turn, np.sign(ahead), np.nan)
    across[rows[:, IS_ARC] != 0.0] = 0.0
    one, other = np.nonzero(across[:, None] * across[None, :] <= 0.0)
    nearest = low[other] - high[one] - LOOSE
    farthest = high[other] - low[one] + LOOSE
    first = np.ceil(nearest / pitch).astype(np.int64)
    last = np.floor(farthest / pitch).astype(np.int64)
    bound = np.minimum(np.array(most), 1 << 40).astype(np.int64)
    # The second peg's hole is the one with the higher column or, in one column, row.
    first = np.maximum(first, [0, -bound[1]])
    last = np.minimum(last, bound)
    counts = np.maximum(last - first + 1, 0)
    counts[(counts == 0).any(axis=1)] = 0
    total = np.cumsum(counts[:, 0] * counts[:, 1])
    for start in range(0, int(total[-1]) if len(total) else 0, TOGETHER):
        number = np.arange(start, min(start + TOGETHER, int(total[-1])))
        which = np.searchsorted(total, number, side="right")
        inside = number - (total[which] - counts[which, 0] * counts[which, 1])
        step = first[which] + np.stack([inside // counts[which, 1], inside % counts[which, 1]], axis=1)
        forward = (step[:, 0] > 0) | (step[:, 1] > 0)
        which, step = which[forward], step[forward]
        feature = np.stack([one[which], other[which]], axis=1)
        for part in crossings(lying, feature, step, np.array(pitch)):
            yield part.take(part.slack - margin > -(1.2 * np.minimum(part.reach, GRAZING) + LOOSE))


def extents(rows: Array) -> tuple[Array, Array]:
    """Least and largest coordinates (F, 2) in mm of features (F, 12), and of ``LOOSE`` past ends of arcs."""
    center, axis, is_arc = rows[:, [X, Y]], rows[:, [AXIS_X, AXIS_Y]], rows[:, IS_ARC] != 0.0
    along = np.abs(axis) * rows[:, [HALF_EXTENT]]
    radius = np.where(is_arc, rows[:, RADIUS], 1.0)
    middle = np.arctan2(rows[:, AXIS_Y], rows[:, AXIS_X])
    half = rows[:, HALF_EXTENT] + LOOSE / radius

    def reach(direction: float) -> Array:
        """How far (F,) arcs reach from their centres in a direction in radians."""
        away = np.abs((middle - direction + np.pi) % (2.0 * np.pi) - np.pi)
        return np.asarray(radius * np.cos(np.clip(away - half, 0.0, np.pi)))

    back = np.stack([reach(np.pi), reach(-np.pi / 2.0)], axis=1)
    ahead = np.stack([reach(0.0), reach(np.pi / 2.0)], axis=1)
    arcs = is_arc[:, None]
    return center - np.where(arcs, back, along), center + np.where(arcs, ahead, along)


def crossings(lying: PartOnWall, feature: IntArray, step: IntArray, pitch: Array) -> Iterator[LatticePairs]:
    """Where the first features of pairs (M, 2) cross the second ones.

    The second ones are moved back by steps (M, 2) of a lattice.
    """
    rows = lying.rows
    is_arc = rows[feature, IS_ARC] != 0.0
    shift = step * pitch
    between = rows[feature[:, 1]][:, [X, Y]] - shift - rows[feature[:, 0]][:, [X, Y]]
    axes = rows[feature][:, :, [AXIS_X, AXIS_Y]]
    radius = rows[feature, RADIUS]
    kind = is_arc[:, 0] * 2 + is_arc[:, 1]
    for number in range(4):
        chosen = np.flatnonzero(kind == number)
        if len(chosen) == 0:
            continue
        with np.errstate(divide="ignore", invalid="ignore"):
            if number == 0:
                which, branch, offset = cross_two_lines(between[chosen], axes[chosen])
            elif number == 1:
                which, branch, offset = cross_line_and_circle(
                    between[chosen], axes[chosen, 0], radius[chosen, 1], lying.off
                )
            elif number == 2:
                which, branch, offset = cross_line_and_circle(
                    -between[chosen], axes[chosen, 1], radius[chosen, 0], lying.off
                )
                offset = offset + between[chosen[which]]
            else:
                which, branch, offset = cross_two_circles(between[chosen], radius[chosen], lying.off)
        chosen = chosen[which]
        point = rows[feature[chosen, 0]][:, [X, Y]] + offset
        yield touching(
            lying, feature[chosen], step[chosen], branch, np.stack([point, point + shift[chosen]], axis=1)
        )


def cross_two_lines(between: Array, axes: Array) -> tuple[IntArray, Array, Array]:
    """Which pairs (M,) of lines cross, the branch, and the place (K, 2) from the middle of the first.

    Parameters
    ----------
    between : (M, 2) from the middle of the first to that of the second, in mm.
    axes : (M, 2, 2) unit vectors along both.
    """
    sine = cross(axes[:, 0], axes[:, 1])
    which = np.flatnonzero(np.abs(sine) > PARALLEL)
    along = cross(between[which], axes[which, 1]) / sine[which]
    return which, np.ones(len(which)), along[:, None] * axes[which, 0]


def cross_line_and_circle(
    between: Array, axis: Array, radius: Array, off: float
) -> tuple[IntArray, Array, Array]:
    """Which pairs (M,) of a line and a circle cross, at which branch, and the place (K, 2) in mm.

    The place is from the line's middle.

    Parameters
    ----------
    between : (M, 2) from the middle of the line to that of the circle, in mm.
    axis : (M, 2) unit vector along the line.
    radius : (M,) of the circle.
    off : by how many mm distances may be off.
    """
    away, foot = cross(axis, between), (axis * between).sum(axis=1)
    return both_of((radius - away) * (radius + away), radius, off, foot, axis)


def cross_two_circles(between: Array, radius: Array, off: float) -> tuple[IntArray, Array, Array]:
    """Which pairs (M,) of circles cross, at which branch, and the place (K, 2) from the middle of the first.

    Parameters
    ----------
    between : (M, 2) from the middle of the first to that of the second, in mm.
    radius : (M, 2) of both.
    off : by how many mm distances may be off.
    """
    apart = np.hypot(between[:, 0], between[:, 1])
    one, other = radius.T
    away = ((one - other) * (one + other) / apart + apart) / 2.0
    square = np.where(apart > SAME_PLACE, (one - away) * (one + away), -inf)
    unit = between / apart[:, None]
    which, branch, beside = both_of(
        square, np.maximum(one, apart), off * (1.0 + one / apart), 0.0, perpendicular(unit)
    )
    return which, branch, beside + away[which, None] * unit[which]


def both_of(
    square: Array, size: Array, off: Array | float, foot: Array | float, axis: Array
) -> tuple[IntArray, Array, Array]:
    """The pairs (M,) whose half chord has a square (M,) that may be positive.

    Each comes twice, with its branch and its place (K, 2).
    """
    met = np.flatnonzero(square > -16.0 * off * size)
    half = np.sqrt(np.maximum(square[met], 0.0))
    foot = np.broadcast_to(foot, square.shape)[met]
    which, branch = np.concatenate([met, met]), np.repeat([-1.0, 1.0], len(met))
    along = np.concatenate([foot - half, foot + half])
    return which, branch, along[:, None] * axis[which]


def touching(
    lying: PartOnWall, feature: IntArray, step: IntArray, branch: Array, point: Array
) -> LatticePairs:
    """Pairs of pegs with centres (N, 2, 2), which touch features (N, 2), as far as these reach."""
    rows = lying.rows[feature]
    is_arc, radius, half = (rows[:, :, k] for k in (IS_ARC, RADIUS, HALF_EXTENT))
    is_arc = is_arc != 0.0
    axis, ray = rows[:, :, [AXIS_X, AXIS_Y]], point - rows[:, :, [X, Y]]
    along = (axis * ray).sum(axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        turned = np.where(is_arc, np.arctan2(cross(axis, ray), along), along)
        scale = np.where(is_arc, radius, 1.0)
        slack = np.minimum(
            (half - turned) * scale + rows[:, :, HIGH_SLACK], (half + turned) * scale + rows[:, :, LOW_SLACK]
        )
        slack[is_arc & (half >= np.pi)] = np.inf
        normal = np.where(
            is_arc[:, :, None], rows[:, :, [SIGN]] * ray / radius[:, :, None], -perpendicular(axis)
        )
        sine = np.abs(cross(normal[:, 0], normal[:, 1]))
        reach = 16.0 * (lying.off + lying.turn * np.abs(ray).max(axis=(1, 2))) / sine
        swing = 2.0 * (lying.turn + np.where(is_arc, (reach[:, None] + lying.off) / radius, 0.0).max(axis=1))
        open_ = ~(sine > STEEP * swing)
    reach[open_], swing[open_] = np.inf, np.inf
    return LatticePairs(feature, step, branch, point, normal, slack.min(axis=1), reach, swing)


def cross(one: Array, other: Array) -> Array:
    """Cross products of vectors (..., 2)."""
    return np.asarray(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0])


def perpendicular(vectors: Array) -> Array:
    """Vectors (..., 2) turned by a quarter turn, counter-clockwise."""
    return np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)


def compute_pair_closure(
    pairs: LatticePairs, lying: PartOnWall, problem: Problem
) -> tuple[LatticePairs, BoolArray, BoolArray]:
    """Pairs with the forces of wall and pegs, which (N,) press the part on the wall, and of which it is open.

    Let a, b be the normals of the part at the pegs, and m, M their moments about the start of the hull edge
    of length l. Let p = -b_u sign a_u, q = |a_u| and t = p m + q M. The null vector of the four wrenches is
    then (l (p a_v + q b_v) - t, t, p l, q l). Its first two add up to l times the sine of the angle between
    both normals.
    """
    length = problem.wrench_length
    a, b = pairs.normal[:, 0], pairs.normal[:, 1]
    wall = lying.length / length
    ahead, across = -b[:, 0] * np.copysign(1.0, a[:, 0]), np.abs(a[:, 0])
    one, other = (cross(pairs.point[:, k] / length, pairs.normal[:, k]) for k in (0, 1))
    last = ahead * one + across * other
    both = wall * (ahead * a[:, 1] + across * b[:, 1])
    null = np.stack([both - last, last, ahead * wall, across * wall], axis=1)
    size = np.abs(null).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        band = 20.0 * pairs.swing + 4.0 * (pairs.reach + lying.off) / length + ROUNDING
        least = np.minimum(null.min(axis=1) - LEAST_CLOSURE * size, size - LEAST_SPAN)
        least = np.minimum(least, both - LEAST_CLAMPING * size)
        ends = (pairs.slack - problem.contact_margin) / np.maximum(1.2 * pairs.reach, 1e-300)
        worst = np.nan_to_num(np.minimum(least / band, ends), nan=0.0)
    held = worst > 1.1
    # Contacts far beyond an end, or forces far from closing, need no balls whatever is not known of the rest.
    hopeless = (worst < -1.1) | (pairs.slack < problem.contact_margin - 1.0)
    return evolve(pairs, null=null), held, ~held & ~hopeless


def select_pressed_pairs(
    pairs: LatticePairs, edge: int, lying: PartOnWall, problem: Problem
) -> tuple[LatticePairs, IntArray, int]:
    """Pairs that press the part on a hull edge, the numbers of those left open, and how many needed balls.

    Pairs whose doubles are too coarse are decided in balls, and their places and forces taken from there.
    """
    pairs, held, open_ = compute_pair_closure(pairs, lying, problem)
    point, null, undecided = pairs.point.copy(), pairs.null.copy(), []
    sharpened = np.flatnonzero(open_ | (held & (pairs.reach > SAME_PLACE / 2)))
    for k in sharpened.tolist():
        verdict, sharp = decide_pair(pairs.candidate(k, edge), problem)
        held[k] = verdict is True
        if verdict is None:
            undecided.append(k)
        if sharp is not None:
            point[k], null[k] = sharp.points, sharp.null
    return evolve(pairs, point=point, null=null).take(held), np.array(undecided, np.int64), len(sharpened)
