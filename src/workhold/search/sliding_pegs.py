"""Where two round pegs of a lattice that slides towards a wall touch a part that lies flush on it.

The hull edge on the wall fixes the angle and the height of the part. What is left is where the first peg's
centre is, u along the wall and v above it. It is at a crossing of its offset curve with that of the second
peg, moved back by the difference of their holes. Two lines have one crossing at most, a line and an arc or
two arcs two. Where the curves run along each other both pegs have one normal, and with the wall's they never
close.

Bounds of the error are as in ``search.pin_contacts``: curves are off by a few ``off`` mm, a crossing by that
over the sine of the angle at which they cross, and a normal by ``turn`` and, on an arc, by that over the
radius.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import GAP_SLACK, LOOSE, PARALLEL
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
from workhold.model.toolkit import Carrier
from workhold.search.pin_contacts import PartOnWall, PinContacts

__all__ = ["SlidingPegs", "outward_rows", "sliding_pegs", "steps_between"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Pairs of curves looked at together.
TOGETHER = 1 << 18


@frozen(eq=False)
class SlidingPegs:
    """M pairs of contacts of two pegs.

    Parameters
    ----------
    one, two : contacts of the first and of the second peg, whose lines are the number of the difference of
        holes.
    step : (M, 2) columns and rows from the first peg's hole to the second's.
    """

    one: PinContacts
    two: PinContacts
    step: IntArray

    @property
    def height(self) -> Array:
        """How high (M,) the lower peg is above the wall, in mm."""
        return np.asarray(np.minimum(self.one.point[:, 1], self.two.point[:, 1]))


def steps_between(jaw: Carrier, longest: float) -> IntArray:
    """Differences (K, 2) of columns and rows between two holes of a carrier, up to a length in mm, one
    direction of each."""
    pitch_x, pitch_y = jaw.pitch
    columns, rows = (
        int(longest / pitch) if count is None else min(count - 1, int(longest / pitch))
        for pitch, count in ((pitch_x, jaw.columns), (pitch_y, jaw.rows))
    )
    column, row = (v.ravel() for v in np.meshgrid(np.arange(columns + 1), np.arange(-rows, rows + 1), indexing="ij"))
    kept = ((column > 0) | (row > 0)) & (np.hypot(column * pitch_x, row * pitch_y) <= longest)
    return np.stack([column[kept], row[kept]], axis=1).astype(np.int64)


def sliding_pegs(
    lying: PartOnWall, chosen: tuple[int, int], jaw: Carrier, steps: IntArray, margin: float
) -> Iterator[SlidingPegs]:
    """Contacts of two pegs in holes of a jaw, some at a time; at a tangent joint with both features.

    They are at least nearly ``margin`` mm inside the ends of their features, and at least nearly as far from
    the wall as the jaw may come.

    Parameters
    ----------
    chosen : first and past-the-last number of the features.
    steps : (K, 2) differences of holes, see :func:`steps_between`.
    """
    assert jaw.travel is not None
    count = chosen[1] - chosen[0]
    first, second = (numbers.ravel() + chosen[0] for numbers in np.indices((count, count)))
    for step in np.array_split(np.arange(len(steps)), max(len(steps) * count * count // TOGETHER, 1)):
        line = np.repeat(step, len(first))
        pairs = np.tile(first, len(step)), np.tile(second, len(step))
        away = steps[line] * np.array(jaw.pitch)
        which, point, reach = crossings(lying, *pairs, away)
        one = contacts_at(lying, line[which], pairs[0][which], point, reach)
        two = contacts_at(lying, line[which], pairs[1][which], point + away[which], reach)
        spare = 1.2 * reach + LOOSE
        lowest = np.minimum(one.point[:, 1], two.point[:, 1])
        kept = (np.minimum(one.slack, two.slack) - margin > -spare) & (lowest >= jaw.travel.least - GAP_SLACK - spare)
        yield SlidingPegs(one.take(kept), two.take(kept), steps[line[which[kept]]])


def crossings(lying: PartOnWall, first: IntArray, second: IntArray, away: Array) -> tuple[IntArray, Array, Array]:
    """Where curves cross others that are moved back: numbers (M,) of pairs, places (M, 2), and by how many mm
    (M,) they may be off.

    Parameters
    ----------
    first, second : (N,) features of the first and of the second peg.
    away : (N, 2) in mm from the first peg to the second.
    """
    rows = lying.rows
    arcs = rows[:, IS_ARC] != 0.0
    middle, other = rows[first][:, [X, Y]], rows[second][:, [X, Y]] - away
    out = []
    for one_arc, other_arc, kind in ((False, False, lines), (False, True, line_and_arc), (True, True, two_arcs)):
        index = np.flatnonzero((arcs[first] == one_arc) & (arcs[second] == other_arc))
        places = kind(rows[first[index]], middle[index], rows[second[index]], other[index], lying.off)
        out.append((index, *places))
    index = np.flatnonzero(arcs[first] & ~arcs[second])
    out.append((index, *line_and_arc(rows[second[index]], other[index], rows[first[index]], middle[index], lying.off)))
    which, point, reach = (
        np.concatenate(values) for values in zip(*((index[k], place, off) for index, k, place, off in out), strict=True)
    )
    order = np.argsort(which, kind="stable")
    return which[order], point[order], reach[order]


Crossings = tuple[IntArray, Array, Array]


def lines(one: Array, middle: Array, two: Array, other: Array, off: float) -> Crossings:
    """Crossings of lines (N, 12) through points (N, 2) with others."""
    (ax, ay), (bx, by) = one[:, [AXIS_X, AXIS_Y]].T, two[:, [AXIS_X, AXIS_Y]].T
    sine = ax * by - ay * bx
    k = np.flatnonzero(np.abs(sine) > PARALLEL)
    dx, dy = (other - middle)[k].T
    s = (dx * by[k] - dy * bx[k]) / sine[k]
    near = np.abs(s) <= 1.01 * one[k, HALF_EXTENT] + 8.0 * off / np.abs(sine[k]) + LOOSE
    k, s = k[near], s[near]
    return k, middle[k] + s[:, None] * one[k][:, [AXIS_X, AXIS_Y]], 8.0 * off / np.abs(sine[k])


def line_and_arc(one: Array, middle: Array, two: Array, other: Array, off: float) -> Crossings:
    """Crossings of lines (N, 12) through points (N, 2) with circles about others."""
    axis, radius, (dx, dy) = one[:, [AXIS_X, AXIS_Y]], two[:, RADIUS], (other - middle).T
    ahead, beside = dx * axis[:, 0] + dy * axis[:, 1], axis[:, 0] * dy - axis[:, 1] * dx
    half, reach = half_chords(beside, radius, off)
    k = np.repeat(np.flatnonzero(half >= 0.0), 2)
    s = ahead[k] + half[k] * np.tile([-1.0, 1.0], len(k) // 2)
    return k, middle[k] + s[:, None] * axis[k], reach[k]


def two_arcs(one: Array, middle: Array, two: Array, other: Array, off: float) -> Crossings:
    """Crossings of circles (N, 12) about points (N, 2) with others; circles about one centre have none, or
    are the same."""
    step = other - middle
    apart = np.hypot(*step.T)
    with np.errstate(divide="ignore", invalid="ignore"):
        along = step / apart[:, None]
        ahead = (apart + (one[:, RADIUS] - two[:, RADIUS]) * (one[:, RADIUS] + two[:, RADIUS]) / apart) / 2.0
        # Where centres are near each other, so is what they are off by to their distance.
        off_here = off * (1.0 + (one[:, RADIUS] + two[:, RADIUS]) / apart)
    half, reach = half_chords(ahead, one[:, RADIUS], off_here)
    k = np.repeat(np.flatnonzero((half >= 0.0) & (apart > LOOSE)), 2)
    across = half[k] * np.tile([-1.0, 1.0], len(k) // 2)
    x, y = along[k].T
    return k, middle[k] + np.stack([ahead[k] * x - across * y, ahead[k] * y + across * x], axis=1), reach[k]


def half_chords(beside: Array, radius: Array, off: float | Array) -> tuple[Array, Array]:
    """Half the chords (N,) of circles at distances (N,) from their centres, -1 where the line surely misses;
    and by how many mm their ends may be off, which near a grazing line is what its root may be."""
    square = (radius - beside) * (radius + beside)
    least = 16.0 * np.asarray(off) * radius
    half = np.where(square >= -least, np.sqrt(np.maximum(square, 0.0)), -1.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = np.where(square > least, 8.0 * np.asarray(off) * radius / half, half + np.sqrt(2.0 * least))
    return np.where(np.isnan(half), -1.0, half), reach


def contacts_at(lying: PartOnWall, line: IntArray, feature: IntArray, point: Array, reach: Array) -> PinContacts:
    """Contacts of pegs at places (M, 2) with features (M,) that pass through them."""
    part = lying.rows[feature].T
    round_ = part[IS_ARC] != 0.0
    ray = point - np.stack([part[X], part[Y]], axis=1)
    ahead = part[AXIS_X] * ray[:, 0] + part[AXIS_Y] * ray[:, 1]
    angle = np.arctan2(part[AXIS_X] * ray[:, 1] - part[AXIS_Y] * ray[:, 0], ahead)
    along, size = np.where(round_, angle, ahead), np.where(round_, part[RADIUS], 1.0)
    slack = np.minimum(
        (part[HALF_EXTENT] - along) * size + part[HIGH_SLACK], (part[HALF_EXTENT] + along) * size + part[LOW_SLACK]
    )
    slack[round_ & (part[HALF_EXTENT] >= np.pi)] = np.inf
    normal = np.where(
        round_[:, None],
        part[SIGN][:, None] * ray / size[:, None],
        np.stack([part[AXIS_Y], -part[AXIS_X]], axis=1),
    )
    swing = 2.0 * (lying.turn + np.where(round_, (reach + lying.off) / size, 0.0))
    # Which of two crossings it is counts for balls alone: the one that lies ahead of the middle of its
    # feature, or not.
    return PinContacts(line, feature, point, normal, slack, reach, swing, np.where(along >= 0.0, 1.0, -1.0))


def outward_rows(height: Array, step: IntArray, jaw: Carrier) -> tuple[IntArray, BoolArray]:
    """How many rows (M,) both pegs must stand back so that the jaw opens no farther than it can, and whether
    (M,) there is such a place.

    Parameters
    ----------
    height : (M,) of the lower peg above the wall in mm.
    step : (M, 2) columns and rows between the pegs.
    """
    travel, pitch = jaw.travel, jaw.pitch[1]
    assert travel is not None
    rows = np.zeros(len(height), np.int64)
    if travel.most is not None:
        rows = np.maximum(np.ceil((height - travel.most - GAP_SLACK) / pitch), 0.0).astype(np.int64)
    fits = height - rows * pitch >= travel.least - GAP_SLACK
    if jaw.rows is not None:
        fits &= rows + np.abs(step[:, 1]) < jaw.rows
    return rows, fits
