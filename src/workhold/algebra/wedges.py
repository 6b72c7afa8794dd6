"""Where two pegs of one jaw can touch two features (paper, sections 3.2 to 3.4).

Glossary
--------
orientation : psi in radians, by which the pegs turn in the workpiece's frame. Section 4 maps the points onto the features
    and inverts the map; the workpiece's own orientation is -psi.
sector : one of 360 equal parts of the circle of orientations. Sets of orientations are sets of sectors, always too large
    rather than too small.
piece : a short stretch of a feature inside a disc. The vectors between points of two pieces lie in a disc, hence in an
    annulus wedge: a range of distances and a range of directions (section 3.3). Wedges between pieces bound the vectors
    between two features far more closely than one wedge for the whole features would.
peg pair : two pegs of one jaw a lattice step apart, the first (lower, or level and further left) on one feature and the
    second on another.
"""

from __future__ import annotations

from math import ceil, hypot, pi, sin, tau

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.contact.frame import Frame
from workhold.conventions import WEDGE_SLACK
from workhold.errors import InputError
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.limits import MOST_PEG_PAIRS

__all__ = ["SECTORS", "PegPairs", "FeaturePieces", "facing", "lattice_steps", "peg_pairs", "pieces_of", "sector_of"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

SECTORS = 360
HALF_SECTOR = pi / SECTORS
CENTERS = (np.arange(SECTORS) + 0.5) * tau / SECTORS
# A piece is about this part of the largest distance on the part.
PIECE = 1 / 16


def sector_of(psi: Array) -> IntArray:
    """Sectors of orientations in radians."""
    return np.floor(np.mod(psi, tau) * SECTORS / tau).astype(np.int64) % SECTORS


def facing(rows: Array, spread: float) -> BoolArray:
    """Whether a feature has a normal within ``spread`` radians of the middle of a sector, (F, SECTORS).

    Parameters
    ----------
    rows : (F, 10) feature rows.
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
    """Pieces of one feature.

    Parameters
    ----------
    middle : (P,) centres of the discs as complex numbers, in mm.
    radius : (P,) radii of the discs in mm.
    """

    middle: NDArray[np.complex128]
    radius: Array


def pieces_of(row: Array, size: float) -> FeaturePieces:
    """Cuts a feature into pieces of about ``size`` mm."""
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


def lattice_steps(frame: Frame, longest: float) -> list[tuple[int, int]]:
    """Steps (columns, rows) from the first peg of a pair to the second, up to ``longest`` mm."""
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
    tails : (N, P, SECTORS) whether the first peg can be on a piece of its feature at an orientation; P is the largest
        number of pieces of a feature.
    low, high : (N, SECTORS, 2) bounds in mm on where the first peg is along the frame's x and y.
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
        """Orientations that each pair allows, (N, SECTORS)."""
        return np.asarray(self.tails.any(axis=1))


def wedge_sectors(one: FeaturePieces, two: FeaturePieces, distance: float, direction: float) -> BoolArray | None:
    """Orientations at which a peg pair fits each piece of the first feature (sections 3.3 and 3.4).

    Parameters
    ----------
    distance, direction : of the step from the first peg to the second, in mm and radians.

    Returns
    -------
    (P, SECTORS) array, or None where no wedge holds the step's length
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


def tail_bounds(one: FeaturePieces, tails: BoolArray) -> tuple[Array, Array]:
    """Bounds (SECTORS, 2) on the first peg along x and y at each orientation, inf and -inf where there is none."""
    seen = one.middle[:, None] * np.exp(-1j * CENTERS)
    slack = (one.radius + np.abs(one.middle) * HALF_SECTOR + WEDGE_SLACK)[:, None]
    low, high = np.empty((SECTORS, 2)), np.empty((SECTORS, 2))
    for axis, value in enumerate((seen.real, seen.imag)):
        low[:, axis] = np.where(tails, value - slack, np.inf).min(axis=0)
        high[:, axis] = np.where(tails, value + slack, -np.inf).max(axis=0)
    return low, high


def peg_pairs(rows: Array, frame: Frame, diameter: float) -> PegPairs:
    """Every peg pair that its annulus wedges allow (section 3.4).

    Parameters
    ----------
    rows : (F, 10) contact features about the centre of the part.
    diameter : largest distance in mm between two peg centres.

    Raises
    ------
    InputError
        When there are too many.
    """
    pieces = [pieces_of(row, diameter * PIECE) for row in rows]
    most = max(len(p.middle) for p in pieces)
    whole: list[tuple[int, int, int, int]] = []
    tails, lows, highs = [], [], []
    for column, row in lattice_steps(frame, diameter + WEDGE_SLACK):
        step = complex(column * frame.lattice.pitch_x, row * frame.lattice.pitch_y)
        for a, one in enumerate(pieces):
            for b, two in enumerate(pieces):
                found = wedge_sectors(one, two, abs(step), float(np.angle(step)))
                if found is None:
                    continue
                if len(whole) == MOST_PEG_PAIRS:
                    raise InputError(
                        f"two pegs fit the part in more than {MOST_PEG_PAIRS:,} ways, too many for the paper's algebra: use "
                        "a larger pitch, or the other engine."
                    )
                low, high = tail_bounds(one, found)
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
