"""Candidate peg pairs and quartets of jaw-specified features with their pegs (paper, sections 3 to 3.5.1).

A candidate is four features, the pegs that touch them, and the sectors of orientations at which they may do
so. This module only computes bounds; candidates that no bound excludes are passed on.

Glossary
--------
orientation : psi in radians, by which the pegs turn in the workpiece's frame. Section 4 maps the points onto
    the features and inverts the map; the workpiece's own orientation is -psi.
sector : one of 360 equal parts of the circle of orientations. Sets of orientations are represented by sets of
    sectors that contain them.
piece : a short stretch of a feature inside a disc. The vectors between points of two pieces lie in a disc,
    hence in an annulus wedge: a range of distances and a range of directions (section 3.3). Wedges between
    pieces bound the vectors between two features far more closely than one wedge for the whole features
    would.
peg pair : two pegs of one jaw a lattice step apart, the first (lower, or level and further left) on one
    feature and the second on another.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, floor, hypot, pi, sin, tau

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.algebra.resultants import ArrayTable
from workhold.contact.problem import SearchFrame
from workhold.conventions import PARALLEL, WEDGE_SLACK
from workhold.errors import InputError
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.limits import MOST_PEG_PAIRS

__all__ = [
    "SECTORS",
    "PegPairs",
    "EquationSystems",
    "are_facing_sectors",
    "list_lattice_steps",
    "list_peg_pairs",
    "cut_into_pieces",
    "find_sector",
    "list_type_one_systems",
    "list_type_two_systems",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

SECTORS = 360
HALF_SECTOR = pi / SECTORS
CENTERS = (np.arange(SECTORS) + 0.5) * tau / SECTORS
# A piece is about this part of the largest distance on the part.
PIECE = 1 / 16


def find_sector(psi: Array) -> IntArray:
    """Return the sector numbers (0 to SECTORS - 1) of orientations in radians, of any shape."""
    return np.floor(np.mod(psi, tau) * SECTORS / tau).astype(np.int64) % SECTORS


def are_facing_sectors(rows: Array, spread: float) -> BoolArray:
    """Return a mask (F, SECTORS): whether a feature of (F, 10) has an outward normal within ``spread``
    radians of the middle of a sector.

    See ``kernels.base.feature`` for the layout of rows.
    """
    straight = rows[:, IS_ARC] == 0.0
    x, y = rows[:, AXIS_X], rows[:, AXIS_Y]
    middle = np.where(straight, np.arctan2(-x, y), np.arctan2(y, x))
    middle = np.where(rows[:, SIGN] < 0.0, middle + pi, middle)
    half = np.where(straight, 0.0, rows[:, HALF_EXTENT])
    off = np.abs((CENTERS - middle[:, None] + pi) % tau - pi)
    return np.asarray(off <= half[:, None] + spread + WEDGE_SLACK)


@define(frozen=True, eq=False)
class FeaturePieces:
    """The pieces of one feature.

    Parameters
    ----------
    middle : (P,) centres of the discs as complex numbers x + i y, in mm.
    radius : (P,) radii of the discs in mm.
    """

    middle: NDArray[np.complex128]
    radius: Array


def cut_into_pieces(row: Array, size: float) -> FeaturePieces:
    """Return the pieces of a feature row, cut to lengths of at most about ``size`` mm."""
    straight = row[IS_ARC] == 0.0
    length = 2.0 * row[HALF_EXTENT] * (1.0 if straight else row[RADIUS])
    count = max(2 if straight else 4, ceil(length / size))
    parameter = row[HALF_EXTENT] * (2.0 * np.arange(count) + 1.0 - count) / count
    half = row[HALF_EXTENT] / count
    if straight:
        middle = row[X] + 1j * row[Y] + parameter * (row[AXIS_X] + 1j * row[AXIS_Y])
        return FeaturePieces(middle, np.full(count, half))
    middle = row[X] + 1j * row[Y] + row[RADIUS] * (row[AXIS_X] + 1j * row[AXIS_Y]) * np.exp(1j * parameter)
    return FeaturePieces(middle, np.full(count, 2.0 * row[RADIUS] * sin(half / 2.0)))


def list_lattice_steps(frame: SearchFrame, longest: float) -> list[tuple[int, int]]:
    """Return the steps (columns, rows) from the first peg of a pair
    to the second, of lengths up to ``longest`` mm.

    Rows are positive, or 0 with positive columns.
    """
    most_rows = int(longest / frame.lattice.pitch_y)
    if frame.standing.rows is not None:
        most_rows = min(most_rows, frame.standing.rows - 1)
    most_columns = min(frame.standing.column_count - 1, int(longest / frame.lattice.pitch_x))
    steps = [
        (column, row)
        for row in range(most_rows + 1)
        for column in range(-most_columns, most_columns + 1)
        if row > 0 or column > 0
    ]
    return [s for s in steps if hypot(s[0] * frame.lattice.pitch_x, s[1] * frame.lattice.pitch_y) <= longest]


@define(frozen=True, eq=False)
class PegPairs:
    """N peg pairs with the orientations they allow.

    Parameters
    ----------
    tail, head : (N,) features of the first and the second peg.
    column, row : (N,) the step between them.
    tails : (N, P, SECTORS) whether the first peg can be on a piece of its feature at an orientation; P is the
        largest number of pieces of a feature.
    low, high : (N, SECTORS, 2) bounds in mm of the first peg's place along the frame's x and y; inf and -inf
        at orientations without one.
    """

    tail: IntArray
    head: IntArray
    column: IntArray
    row: IntArray
    tails: BoolArray
    low: Array
    high: Array

    def __len__(self) -> int:
        return len(self.tail)

    @property
    def sectors(self) -> BoolArray:
        """Whether each pair allows an orientation, (N, SECTORS)."""
        return np.asarray(self.tails.any(axis=1))


def find_wedge_sectors(
    one: FeaturePieces, two: FeaturePieces, distance: float, direction: float
) -> BoolArray | None:
    """Return the sectors at which a peg pair may fit each of P pieces
    of the first feature, (P, SECTORS) of bool.

    See sections 3.3 and 3.4. The step from the first peg to the second has a length (``distance``) in mm and
    a direction in radians. Return None if no annulus wedge between two pieces contains a vector of this
    length.
    """
    between = two.middle[None, :] - one.middle[:, None]
    spread = one.radius[:, None] + two.radius[None, :] + WEDGE_SLACK
    size = np.abs(between)
    i, j = np.nonzero((size - spread <= distance) & (distance <= size + spread))
    if len(i) == 0:
        return None
    between, spread, size = between[i, j], spread[i, j], size[i, j]
    # A vector x with |x| = distance and |x - between| <= spread: law of cosines.
    cosine = (distance**2 + size**2 - spread**2) / np.maximum(2.0 * distance * size, 1e-300)
    reach = np.arccos(np.clip(cosine, -1.0, 1.0)) + HALF_SECTOR + WEDGE_SLACK
    psi = np.angle(between) - direction
    inside = np.abs((CENTERS - psi[:, None] + pi) % tau - pi) <= reach[:, None]
    out = np.zeros((len(one.middle), SECTORS), np.bool_)
    np.logical_or.at(out, i, inside)
    return out


def bound_first_peg(one: FeaturePieces, tails: BoolArray) -> tuple[Array, Array]:
    """Return lower and upper bounds, (SECTORS, 2) each, of the first
    peg's x and y in mm in the frame of the pegs.

    ``tails`` (P, SECTORS) tells on which pieces the peg can be; bounds are inf and -inf at orientations
    without such a piece.
    """
    seen = one.middle[:, None] * np.exp(-1j * CENTERS)
    slack = (one.radius + np.abs(one.middle) * HALF_SECTOR + WEDGE_SLACK)[:, None]
    low, high = np.empty((SECTORS, 2)), np.empty((SECTORS, 2))
    for axis, value in enumerate((seen.real, seen.imag)):
        low[:, axis] = np.where(tails, value - slack, np.inf).min(axis=0)
        high[:, axis] = np.where(tails, value + slack, -np.inf).max(axis=0)
    return low, high


def list_peg_pairs(rows: Array, frame: SearchFrame, diameter: float) -> PegPairs:
    """Return all peg pairs that their annulus wedges allow (section 3.4).

    See ``kernels.base.feature`` for the layout of rows.

    Parameters
    ----------
    rows : (F, 10) features about the centre of the part.
    diameter : largest distance in mm between two peg centres.

    Raises
    ------
    InputError
        When there are more than ``MOST_PEG_PAIRS``.
    """
    pieces = [cut_into_pieces(row, diameter * PIECE) for row in rows]
    most = max(len(p.middle) for p in pieces)
    whole: list[tuple[int, int, int, int]] = []
    tails, lows, highs = [], [], []
    for column, row in list_lattice_steps(frame, diameter + WEDGE_SLACK):
        step = complex(column * frame.lattice.pitch_x, row * frame.lattice.pitch_y)
        for a, one in enumerate(pieces):
            for b, two in enumerate(pieces):
                found = find_wedge_sectors(one, two, abs(step), float(np.angle(step)))
                if found is None:
                    continue
                if len(whole) == MOST_PEG_PAIRS:
                    raise InputError(
                        f"two pegs fit the part in more than {MOST_PEG_PAIRS:,} ways, too many for the "
                        "paper's algebra: use a larger pitch, or the other engine."
                    )
                low, high = bound_first_peg(one, found)
                whole.append((a, b, column, row))
                tails.append(np.pad(found, ((0, most - len(found)), (0, 0))))
                lows.append(low)
                highs.append(high)
    table = np.array(whole, np.int64).reshape(-1, 4)
    return PegPairs(
        table[:, 0],
        table[:, 1],
        table[:, 2],
        table[:, 3],
        np.array(tails, np.bool_).reshape(-1, most, SECTORS),
        np.array(lows).reshape(-1, SECTORS, 2),
        np.array(highs).reshape(-1, SECTORS, 2),
    )


@define(frozen=True, eq=False)
class EquationSystems(ArrayTable):
    """N systems of contact equations: for Type I four pegs, for Type II the three on the left jaw.

    Parameters
    ----------
    feature, column, row : (N, 4) or (N, 3); rows are counted from the first peg, columns from the first peg
        of the same jaw. The left pegs come first.
    sectors : (N, SECTORS) whether orientations in the sector are still possible.
    """

    feature: IntArray
    column: IntArray
    row: IntArray
    sectors: BoolArray

    def __len__(self) -> int:
        return len(self.feature)


@define(frozen=True, eq=False)
class FacingDirections:
    """The directions that features face.

    Parameters
    ----------
    left, right : (F, SECTORS) whether a left peg, or a right peg, can push on the feature in a clamping
        direction at an orientation. These are the two parts of the valid orientations (section 3.2).
    resists : (F, SECTORS) whether a feature has a normal within a quarter turn of a direction. Four features
        can close only if every direction is resisted by one of them (section 3).
    """

    left: BoolArray
    right: BoolArray
    resists: BoolArray

    @classmethod
    def from_features(cls, rows: Array, clamping: int) -> FacingDirections:
        """Return the directions of feature rows (F, 10), where right pegs clamp by pushing left
        (``clamping`` 1) or right (-1).

        See ``kernels.base.feature`` for the layout of rows.
        """
        right = are_facing_sectors(rows, pi / 2 + HALF_SECTOR)
        left, right = (np.roll(right, -SECTORS // 2, axis=1), right)[::clamping]
        return cls(left, right, are_facing_sectors(rows, pi / 2))


def are_parallel(rows: Array, a: IntArray, b: IntArray) -> BoolArray:
    """Return, for each pair of feature indices in a and b, whether both are lines, and parallel."""
    turn = rows[a, 3] * rows[b, 4] - rows[a, 4] * rows[b, 3]
    return np.asarray((rows[a, 0] == 0.0) & (rows[b, 0] == 0.0) & (np.abs(turn) <= PARALLEL))


def rank_peg_pairs(pairs: PegPairs, rows: Array) -> IntArray:
    """Return a rank (N,) of each peg pair, higher for more arcs; exchanging a pair's features does not change
    the rank.

    Half a turn of the toolkit exchanges the jaws and each pair's features. So it is enough to examine
    quartets whose left pair ranks at least as high as the right one.
    """
    arcs = (rows[pairs.tail, 0] != 0.0).astype(np.int64) + (rows[pairs.head, 0] != 0.0)
    first, second = np.minimum(pairs.tail, pairs.head), np.maximum(pairs.tail, pairs.head)
    order = np.lexsort([pairs.column, pairs.row, second, first, arcs])
    keys = np.stack([arcs, first, second, pairs.row, pairs.column], axis=1)[order]
    fresh = np.ones(len(order), np.int64)
    fresh[1:] = (keys[1:] != keys[:-1]).any(axis=1)
    rank = np.empty(len(order), np.int64)
    rank[order] = np.cumsum(fresh)
    return rank


def list_type_one_systems(pairs: PegPairs, rows: Array, frame: SearchFrame) -> Iterator[EquationSystems]:
    """Yield the systems with two pegs on each jaw, except those with
    parallel lines on one jaw (section 3.5.1).

    Two systems that a half turn, which exchanges the jaws, maps to each other are listed once.
    """
    facings = FacingDirections.from_features(rows, frame.toolkit.clamping)
    generic = np.flatnonzero(~are_parallel(rows, pairs.tail, pairs.head))
    rank, sectors = rank_peg_pairs(pairs, rows), pairs.sectors
    resists = facings.resists[pairs.tail] | facings.resists[pairs.head]
    as_left = sectors & (facings.left[pairs.tail] | facings.left[pairs.head])
    as_right = sectors & (facings.right[pairs.tail] | facings.right[pairs.head])
    # From the first peg to the rightmost of a left pair and to the leftmost of a right pair.
    rightward = np.maximum(pairs.column, 0) * frame.lattice.pitch_x
    leftward = np.minimum(pairs.column, 0) * frame.lattice.pitch_x
    for one in generic:
        two = generic[rank[generic] <= rank[one]]
        two = two[(resists[one] | resists[two]).all(axis=1)]
        room = pairs.high[two, :, 0] + leftward[two, None] - pairs.low[one, :, 0] - rightward[one]
        shared = as_left[one] & as_right[two] & (room >= frame.gap - WEDGE_SLACK)
        keep = shared.any(axis=1)
        if keep.any():
            yield from pair_with_rows(pairs, int(one), two[keep], shared[keep], frame)


def pair_with_rows(
    pairs: PegPairs, one: int, two: IntArray, shared: BoolArray, frame: SearchFrame
) -> Iterator[EquationSystems]:
    """Yield the systems made of the left pair ``one`` and the right pairs ``two``, row by row of the right
    jaw.

    A right pair occurs in the rows in which its first peg may be, by the bounds of the pegs' heights.
    ``shared`` (len(two), SECTORS) are the orientations that both pairs allow.
    """
    pitch, offset = frame.lattice.pitch_y, frame.lattice.row_offset
    low = np.where(shared, (pairs.low[two, :, 1] - pairs.high[one, :, 1] - offset) / pitch, np.inf)
    high = np.where(shared, (pairs.high[two, :, 1] - pairs.low[one, :, 1] - offset) / pitch, -np.inf)
    for line in range(ceil(low.min()), floor(high.max()) + 1):
        inside = (low <= line) & (line <= high)
        keep = inside.any(axis=1)
        if not keep.any():
            continue
        right = two[keep]
        zero = np.zeros(len(right), np.int64)
        feature = np.stack(
            [zero + pairs.tail[one], zero + pairs.head[one], pairs.tail[right], pairs.head[right]], axis=1
        )
        column = np.stack([zero, zero + pairs.column[one], zero, pairs.column[right]], axis=1)
        row = np.stack([zero, zero + pairs.row[one], zero + line, pairs.row[right] + line], axis=1)
        yield EquationSystems(feature, column, row, inside[keep])


def list_type_two_systems(pairs: PegPairs, rows: Array, frame: SearchFrame) -> Iterator[EquationSystems]:
    """Yield the systems of three left pegs, also on parallel lines;
    the fourth peg follows from the pose (section 3.5).

    The third peg lies in the wedges from the first and from the second peg.
    """
    facings = FacingDirections.from_features(rows, frame.toolkit.clamping)
    count = len(rows)
    names = (pairs.tail, pairs.head, pairs.column, pairs.row)
    number = {key: k for k, key in enumerate(zip(*(name.tolist() for name in names), strict=True))}
    sectors = pairs.sectors
    place = pairs.row * (1 << 20) + pairs.column
    right = facings.right.any(axis=0)
    for one in range(len(pairs)):
        two = np.flatnonzero((pairs.tail == pairs.tail[one]) & (place > place[one]))
        a, b = int(pairs.tail[one]), int(pairs.head[one])
        steps = pairs.column[two] - pairs.column[one], pairs.row[two] - pairs.row[one]
        keys = zip(pairs.head[two].tolist(), *(step.tolist() for step in steps), strict=True)
        across = np.array([number.get((b, *key), -1) for key in keys], np.int64)
        two, across = two[across >= 0], across[across >= 0]
        if not len(two):
            continue
        shared = (pairs.tails[one] & pairs.tails[two]).any(axis=1) & sectors[across] & right
        pushed = facings.left[a] | facings.left[b] | facings.left[pairs.head[two]]
        resists = facings.resists[a] | facings.resists[b] | facings.resists[pairs.head[two]]
        closes = np.any([(resists | facings.resists[e]).all(axis=1) for e in range(count)], axis=0)
        shared &= pushed & closes[:, None]
        keep = shared.any(axis=1)
        two = two[keep]
        zero = np.zeros(len(two), np.int64)
        yield EquationSystems(
            np.stack([zero + a, zero + b, pairs.head[two]], axis=1),
            np.stack([zero, zero + pairs.column[one], pairs.column[two]], axis=1),
            np.stack([zero, zero + pairs.row[one], pairs.row[two]], axis=1),
            shared[keep],
        )
