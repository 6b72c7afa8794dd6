"""Spots (numbered stretches of features) that contacts known to a disc may touch, and whether two or three
locators may touch them together.

Pairs and triples of spots are ruled out beforehand where every seat with contacts there would have too large
a location error (``contact.location_bounds``).
"""

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
from workhold.kernels.chord.evaluation import find_parameter
from workhold.kernels.contact.location_bounds import write_spot
from workhold.kernels.curves.piece_bounds import Disc, enclose_tail

# Rounding of distances in mm, generously counted.
ROUNDING = 1e-9
# Half sweep in radians from which the seam of a circle may be anywhere.
NEARLY_WHOLE = 3.0


@inner
def find_spots(
    row: Array, feature: int, near: NearSpots, x: float, y: float, radius: float
) -> tuple[int, int]:
    """Return the first and past-the-last spot of a feature that a
    contact within ``radius`` mm of (x, y) may touch.

    ``row`` is the feature numbered ``feature``. Spots are numbered through all features, see ``NearSpots``.
    See ``base.feature`` for the layout of ``row``.
    """
    first, end, half = near.starts[feature], near.starts[feature + 1], row[HALF_EXTENT]
    s, off = find_parameter(row, x, y), radius + ROUNDING
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
    """Write the contacts of a piece's tail and head as spots to ``tail_spot`` and ``head_spot``; return their
    discs.

    The first returned disc holds the tail over the whole piece, the second holds the
    head. The first five columns of a spot are written, see ``contact.location_bounds.write_spot``. ``length``
    is L in mm, by which moments are divided. See ``base.tables`` for the layout of ``piece``.
    """
    number, given = int(piece[CURVE]), features.precision
    curve, tail, head = curves.reals[number], curves.integers[number, TAIL], curves.integers[number, HEAD]
    a, b = features.loose[tail], features.loose[head]
    psi, half = (piece[LOW] + piece[HIGH]) / 2.0, (piece[HIGH] - piece[LOW]) / 2.0
    x, y, radius = enclose_tail(a, b, curve, psi, half)
    alpha, d = psi + curve[SHIFT], curve[LENGTH]
    at_x, at_y, off = x + d * cos(alpha), y + d * sin(alpha), radius + d * half
    write_spot(a, tail, x, y, radius, given, length, tail_spot)
    write_spot(b, head, at_x, at_y, off, given, length, head_spot)
    return Disc(x, y, radius), Disc(at_x, at_y, off)


@inner
def may_join(
    a: Array,
    b: Array,
    ends: tuple[int, int],
    near: NearSpots,
    tail: Disc,
    head: Disc,
) -> bool:
    """Return whether two locators with contacts in the discs ``tail`` and ``head`` are not ruled out by
    ``near``.

    The tail touches the feature ``a``, whose number is ``ends[0]``, the head ``b``, whose number is
    ``ends[1]``. See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    first, end = find_spots(a, ends[0], near, tail.x, tail.y, tail.radius)
    begin, last = find_spots(b, ends[1], near, head.x, head.y, head.radius)
    return is_any_joined(near, first, end, begin, last)


@inner
def may_be_three(near: NearSpots, tail: int, head: int, third: int) -> bool:
    """Return whether three locators on the spots numbered ``tail``, ``head`` and ``third`` are not ruled out
    by ``near``.

    Where ``near`` has no triples, only the pairs (tail, head) and (tail, third) are looked up.
    """
    if near.triples.shape[0] > 0:
        return near.triples[tail, head, third] != 0
    return near.joined[tail, head] != 0 and near.joined[tail, third] != 0


@inner
def is_any_joined(near: NearSpots, first: int, end: int, begin: int, last: int) -> bool:
    """Return whether ``near`` allows two locators on a spot in [first, end) and a spot in [begin, last)."""
    for i in range(first, end):
        for j in range(begin, last):
            if near.joined[i, j] != 0:
                return True
    return False
