"""Two pegs of one lattice that touch a part flush on a wall: their places, and whether they press the part.

On a hull edge the part's orientation and height are fixed. A lattice that slides toward the wall has two
unknowns, its place along the wall and its distance from it. Each pair of pegs gives two equations. The first
peg's centre lies on the offset curve of the face it touches. It also lies on the offset curve of the second
peg's face, moved back by the step from the first peg's hole to the second's. So pairs are the crossings of
one curve with another curve that is moved by a step of the lattice. Two lines have one crossing; a line and a
circle, or two circles, have two.

Where two curves have a common stretch (parallel lines, equal arcs about one centre) or only graze each other,
both normals are parallel there. Then the wrenches of wall and pegs do not span the space, and there is no
closure (``compute_pair_closure``).

Bounds of the error. Places in the wall's frame are exact to ``off`` mm and directions to ``turn`` radians
(``PartOnWall``). The error of a crossing is ``off`` divided by the sine of the angle between both normals, as
long as this error turns neither normal by more than a tenth of the angle. Otherwise there is no bound, and
the pair is decided in ball arithmetic.
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
from workhold.listing.canonical_form import RowArrays
from workhold.proof.flush import LatticePair, decide_pair
from workhold.search.flush_search import PartOnWall

__all__ = ["LatticePairs", "select_pressed_pairs", "find_pairs_on_edge"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Number of pairs of features and lattice steps that are computed together.
TOGETHER = 1 << 19
# mm. Contacts without a known error bound are off by less: the square root of rounding times the size of a
# part.
GRAZING = 1e-2
# The sine of the angle between two normals must exceed their error bound by this factor.
STEEP = 10.0


@frozen(eq=False)
class LatticePairs(RowArrays):
    """N pairs of pegs of one lattice that touch a part on a wall.

    Parameters
    ----------
    feature : (N, 2) features touched by the first and the second peg. The first peg's hole has the lower
        column or, in the same column, the lower row.
    step : (N, 2) columns and rows from the first peg's hole to the second's.
    branch : (N,) -1 or 1 for the first or second of two crossings; 1 for two lines.
    point : (N, 2, 2) centres of both pegs, in mm along the hull edge from its start and above it.
    normal : (N, 2, 2) outward unit normals of the part there.
    slack : (N,) distance in mm from the nearest end of a feature, for the peg where it is smaller; negative
        beyond the end, inf on whole circles.
    reach : (N,) error bounds of ``point`` in mm; inf where not known.
    swing : (N,) error bounds of ``normal`` in radians; inf where not known.
    null : (N, 4) null vector of the wrenches: forces of the wall's two ends and of both pegs, up to a common
        factor; 0 where not yet computed.
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
    def make_unknown_null(self) -> Array:
        """Return zeros (N, 4), for forces that are not computed yet."""
        return np.zeros((len(self.branch), 4))

    def make_candidate(self, number: int, edge: int) -> LatticePair:
        """Return pair number ``number``, on hull edge ``edge``, in the form that ball arithmetic decides."""
        features, step = (tuple(values[number].tolist()) for values in (self.feature, self.step))
        return LatticePair(edge, features, step, int(self.branch[number]))


def find_pairs_on_edge(
    lying: PartOnWall, pitch: tuple[float, float], most: tuple[float, float], margin: float
) -> Iterator[LatticePairs]:
    """Yield, in batches, the pairs of pegs that touch a part on a wall
    at least ``margin`` inside their features.

    Pairs are left out only where the error bounds exclude them. Also left out are pairs whose normals cannot
    have opposed components along the wall.

    Parameters
    ----------
    pitch : distances in mm between neighbouring columns and rows.
    most : largest numbers of columns and of rows from one peg to the other; inf where unbounded.
    margin : smallest distance in mm from the end of a feature.
    """
    rows = lying.rows
    low, high = bound_features(rows)
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
        for part in find_crossings(lying, feature, step, np.array(pitch)):
            yield part.take(part.slack - margin > -(1.2 * np.minimum(part.reach, GRAZING) + LOOSE))


def bound_features(rows: Array) -> tuple[Array, Array]:
    """Return (1) the least and (2) the largest coordinates in mm of F features, each (F, 2).

    ``rows`` are their kernel rows (F, 12). Arcs are taken ``LOOSE`` mm longer at each end.
    """
    center, axis, is_arc = rows[:, [X, Y]], rows[:, [AXIS_X, AXIS_Y]], rows[:, IS_ARC] != 0.0
    along = np.abs(axis) * rows[:, [HALF_EXTENT]]
    radius = np.where(is_arc, rows[:, RADIUS], 1.0)
    middle = np.arctan2(rows[:, AXIS_Y], rows[:, AXIS_X])
    half = rows[:, HALF_EXTENT] + LOOSE / radius

    def compute_reach(direction: float) -> Array:
        """Return how far in mm each arc reaches from its centre in a direction given in radians, (F,)."""
        away = np.abs((middle - direction + np.pi) % (2.0 * np.pi) - np.pi)
        return np.asarray(radius * np.cos(np.clip(away - half, 0.0, np.pi)))

    back = np.stack([compute_reach(np.pi), compute_reach(-np.pi / 2.0)], axis=1)
    ahead = np.stack([compute_reach(0.0), compute_reach(np.pi / 2.0)], axis=1)
    arcs = is_arc[:, None]
    return center - np.where(arcs, back, along), center + np.where(arcs, ahead, along)


def find_crossings(
    lying: PartOnWall, feature: IntArray, step: IntArray, pitch: Array
) -> Iterator[LatticePairs]:
    """Yield the pairs of pegs for given features and lattice steps, without regard to the ends of features.

    For each of M pairs of ``feature`` (M, 2) the first peg stands where the first curve meets the second
    curve moved back by the step. ``step`` (M, 2) is in holes, ``pitch`` (2,) in mm. There is one batch for
    each combination of lines and arcs. Crossings beyond the ends of features have negative slack.
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
        yield make_touching_pairs(
            lying, feature[chosen], step[chosen], branch, np.stack([point, point + shift[chosen]], axis=1)
        )


def cross_two_lines(between: Array, axes: Array) -> tuple[IntArray, Array, Array]:
    """Return the crossings of M pairs of infinite lines: indices, branches, places.

    They are: indices (K,) of the pairs whose lines are not parallel; branches (K,), all 1; places (K, 2) in
    mm from the middle of the first line.

    Parameters
    ----------
    between : (M, 2) from the middle of the first line to that of the second, in mm.
    axes : (M, 2, 2) unit vectors along the first and the second line.
    """
    sine = cross(axes[:, 0], axes[:, 1])
    which = np.flatnonzero(np.abs(sine) > PARALLEL)
    along = cross(between[which], axes[which, 1]) / sine[which]
    return which, np.ones(len(which)), along[:, None] * axes[which, 0]


def cross_line_and_circle(
    between: Array, axis: Array, radius: Array, off: float
) -> tuple[IntArray, Array, Array]:
    """Return the crossings of M pairs of an infinite line and a circle: indices, branches, places.

    They are: indices (K,) of the pairs that cross, each twice; branches (K,), -1 for the crossing farther
    back along the line's axis and 1 for the other; places (K, 2) in mm from the line's middle, along its
    axis.

    Parameters
    ----------
    between : (M, 2) from the middle of the line to that of the circle, in mm.
    axis : (M, 2) unit vector along the line.
    radius : (M,) radius of the circle, in mm.
    off : error bound of distances, in mm.
    """
    away, foot = cross(axis, between), (axis * between).sum(axis=1)
    return solve_both_branches((radius - away) * (radius + away), radius, off, foot, axis)


def cross_two_circles(between: Array, radius: Array, off: float) -> tuple[IntArray, Array, Array]:
    """Return the crossings of M pairs of circles: indices, branches, places.

    They are: indices (K,) of the pairs that cross, each twice; branches (K,), -1 for the crossing right of
    the line from the first centre to the second and 1 for the crossing left of it; places (K, 2) in mm from
    the first circle's centre.

    Parameters
    ----------
    between : (M, 2) from the centre of the first circle to that of the second, in mm.
    radius : (M, 2) radii of the first and the second circle, in mm.
    off : error bound of distances, in mm.
    """
    apart = np.hypot(between[:, 0], between[:, 1])
    one, other = radius.T
    away = ((one - other) * (one + other) / apart + apart) / 2.0
    square = np.where(apart > SAME_PLACE, (one - away) * (one + away), -inf)
    unit = between / apart[:, None]
    which, branch, beside = solve_both_branches(
        square, np.maximum(one, apart), off * (1.0 + one / apart), 0.0, turn_by_quarter(unit)
    )
    return which, branch, beside + away[which, None] * unit[which]


def solve_both_branches(
    square: Array, size: Array, off: Array | float, foot: Array | float, axis: Array
) -> tuple[IntArray, Array, Array]:
    """Return the ends of M chords, ``(foot - half) axis`` and ``(foot + half) axis``: indices, branches, places.

    ``square`` (M,) is the square of the half chord in mm². Chords where it is negative beyond rounding are
    left out; where rounding makes it negative, the half chord is 0. The error of ``square`` is at most about
    ``off`` times ``size``, both in mm. ``foot`` is in mm along ``axis`` (M, 2).

    The result is: indices (K,) of the chords; branches (K,), -1 for ``foot - half`` and 1 for ``foot +
    half``; places (K, 2) in mm. All of branch -1 come first.
    """
    met = np.flatnonzero(square > -16.0 * off * size)
    half = np.sqrt(np.maximum(square[met], 0.0))
    foot = np.broadcast_to(foot, square.shape)[met]
    which, branch = np.concatenate([met, met]), np.repeat([-1.0, 1.0], len(met))
    along = np.concatenate([foot - half, foot + half])
    return which, branch, along[:, None] * axis[which]


def make_touching_pairs(
    lying: PartOnWall, feature: IntArray, step: IntArray, branch: Array, point: Array
) -> LatticePairs:
    """Return N pairs of pegs with normals, slack and error bounds; their forces are not yet known (0).

    ``feature`` (N, 2) are the features touched, ``point`` (N, 2, 2) the centres of the pegs. Error bounds are
    inf where both normals are nearly parallel.
    """
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
            is_arc[:, :, None], rows[:, :, [SIGN]] * ray / radius[:, :, None], -turn_by_quarter(axis)
        )
        sine = np.abs(cross(normal[:, 0], normal[:, 1]))
        reach = 16.0 * (lying.off + lying.turn * np.abs(ray).max(axis=(1, 2))) / sine
        swing = 2.0 * (lying.turn + np.where(is_arc, (reach[:, None] + lying.off) / radius, 0.0).max(axis=1))
        open_ = ~(sine > STEEP * swing)
    reach[open_], swing[open_] = np.inf, np.inf
    return LatticePairs(feature, step, branch, point, normal, slack.min(axis=1), reach, swing)


def cross(one: Array, other: Array) -> Array:
    """Return the cross products of plane vectors: (..., 2) and (..., 2) give (...)."""
    return np.asarray(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0])


def turn_by_quarter(vectors: Array) -> Array:
    """Return vectors (..., 2) turned by a quarter turn counter-clockwise."""
    return np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)


def compute_pair_closure(
    pairs: LatticePairs, lying: PartOnWall, problem: Problem
) -> tuple[LatticePairs, BoolArray, BoolArray]:
    """Return (the pairs with their forces, which pairs press the part on the wall, which are undecided).

    The last two are masks (N,) from double arithmetic. The formula, with lengths divided by the
    characteristic length: a and b are the normals of the part at the first and the second peg, m and M the
    moments of these normals about the start of the hull edge, l the length of the hull edge. The index u
    marks components along the edge, v components up from it. Let p = -b_u sign a_u, q = |a_u| and t = p m + q
    M. The null vector of the four wrenches (both ends of the wall, both pegs) is then (l (p a_v + q b_v) - t,
    t, p l, q l). Its first two entries add up to l times the sine of the angle between the normals.
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
    # Contacts far beyond an end, or forces far from closing, are surely rejected, whatever else is unknown.
    hopeless = (worst < -1.1) | (pairs.slack < problem.contact_margin - 1.0)
    return evolve(pairs, null=null), held, ~held & ~hopeless


def select_pressed_pairs(
    pairs: LatticePairs, edge: int, lying: PartOnWall, problem: Problem
) -> tuple[LatticePairs, IntArray, int]:
    """Return (the pairs that press the part, indices of undecided pairs, number of pairs that took ball
    arithmetic).

    The indices refer to the ``pairs`` given. Places and forces come from ball arithmetic where double
    arithmetic is too coarse. ``edge`` is the index of the hull edge on the wall.
    """
    pairs, held, open_ = compute_pair_closure(pairs, lying, problem)
    point, null, undecided = pairs.point.copy(), pairs.null.copy(), []
    sharpened = np.flatnonzero(open_ | (held & (pairs.reach > SAME_PLACE / 2)))
    for k in sharpened.tolist():
        verdict, sharp = decide_pair(pairs.make_candidate(k, edge), problem)
        held[k] = verdict is True
        if verdict is None:
            undecided.append(k)
        if sharp is not None:
            point[k], null[k] = sharp.points, sharp.null
    return evolve(pairs, point=point, null=null).take(held), np.array(undecided, np.int64), len(sharpened)
