"""Which spots contacts may touch that are known to a disc, and whether locators of interest touch them."""

from __future__ import annotations

from math import cos, floor, sin

from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.feature import HALF_EXTENT, IS_ARC, RADIUS
from workhold.kernels.base.tables import (
    CURVE,
    HEAD,
    HIGH,
    LENGTH,
    LOW,
    SHIFT,
    TAIL,
    Curves,
    Features,
    NearSpots,
)
from workhold.kernels.chord.evaluation import parameter_on
from workhold.kernels.contact.location_bounds import write_spot
from workhold.kernels.curves.piece_bounds import tail_disc

# A disc that holds a contact: its middle and its radius in mm.
Disc = tuple[float, float, float]

# Rounding of distances in mm, generously counted.
ROUNDING = 1e-9
# Half sweep in radians from which the seam of a circle may be anywhere.
NEARLY_WHOLE = 3.0


@inner
def spots_of(row: Array, feature: int, near: NearSpots, x: float, y: float, radius: float) -> tuple[int, int]:
    """First and past-the-last spot of a feature that a contact within ``radius`` mm of a place may touch."""
    first, end, half = near.starts[feature], near.starts[feature + 1], row[HALF_EXTENT]
    s, off = parameter_on(row, x, y), radius + ROUNDING
    if row[IS_ARC] != 0.0:
        # From an arc's centre a disc of up to half its radius R is seen under 1.1 radius / R to either side.
        if not off <= 0.5 * row[RADIUS] or half > NEARLY_WHOLE:
            return (first, end)
        off = 1.1 * off / row[RADIUS]
    if not off < half:
        return (first, end)
    size = 2.0 * half / (end - first)
    low, high = floor((s - off + half) / size), floor((s + off + half) / size)
    return (first + int(max(low, 0.0)), first + 1 + int(min(high, end - first - 1.0)))


@inner
def write_piece_spots(
    piece: Array, tail_spot: Array, head_spot: Array, features: Features, curves: Curves, length: float
) -> tuple[Disc, Disc]:
    """Write the spots of both contacts of a piece, and return the discs that hold them."""
    number, given = int(piece[CURVE]), features.precision
    curve, tail, head = curves.reals[number], curves.integers[number, TAIL], curves.integers[number, HEAD]
    a, b = features.loose[tail], features.loose[head]
    psi, half = (piece[LOW] + piece[HIGH]) / 2.0, (piece[HIGH] - piece[LOW]) / 2.0
    x, y, radius = tail_disc(a, b, curve, psi, half)
    alpha, d = psi + curve[SHIFT], curve[LENGTH]
    at_x, at_y, off = x + d * cos(alpha), y + d * sin(alpha), radius + d * half
    write_spot(a, tail, x, y, radius, given, length, tail_spot)
    write_spot(b, head, at_x, at_y, off, given, length, head_spot)
    return (x, y, radius), (at_x, at_y, off)


@inner
def may_join(
    a: Array,
    b: Array,
    ends: tuple[int, int],
    near: NearSpots,
    tail: Disc,
    head: Disc,
) -> bool:
    """Whether contacts in two discs, on the features of ``ends``, may be those of locators of interest."""
    first, end = spots_of(a, ends[0], near, tail[0], tail[1], tail[2])
    begin, last = spots_of(b, ends[1], near, head[0], head[1], head[2])
    return is_any_joined(near, first, end, begin, last)


@inner
def may_be_three(near: NearSpots, tail: int, head: int, third: int) -> bool:
    """Whether three spots, the tail's first, may be those of locators of interest."""
    if near.triples.shape[0] > 0:
        return near.triples[tail, head, third] != 0
    return near.joined[tail, head] != 0 and near.joined[tail, third] != 0


@inner
def is_any_joined(near: NearSpots, first: int, end: int, begin: int, last: int) -> bool:
    """Whether any two spots of two ranges may be those of locators of interest."""
    for i in range(first, end):
        for j in range(begin, last):
            if near.joined[i, j] != 0:
                return True
    return False
