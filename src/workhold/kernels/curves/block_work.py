"""What the kernels of one block of a search are given and work in, and how they list what they find.

A work space is made once for a block, so that no inner kernel makes an array. Kernels that list fixtures go
on until all is done or their output is full. They record where in their pairs they stopped in ``at``; what
they began there is taken back, and begun anew when the caller has made room.
"""

from __future__ import annotations

from math import cos, inf, sin
from typing import NamedTuple

import numpy as np

from workhold.kernels.base.compiling import Array, IntArray, inner, inner_making_arrays
from workhold.kernels.base.feature import IS_ARC, RADIUS
from workhold.kernels.base.tables import (
    COLUMN_STEP,
    HEAD,
    LENGTH,
    ROW_STEP,
    SHIFT,
    TAIL,
    Curves,
    Features,
    Lattice,
    Limits,
)
from workhold.kernels.contact.location_bounds import two_and_two_beyond
from workhold.kernels.contact.record import (
    PEG_FEATURE,
    PEG_LENGTH,
    PEG_RADIUS,
    PEG_ROW,
    PEG_X,
    PEG_Y,
    Angle,
    place_peg,
    write_record,
)
from workhold.kernels.contact.rules import is_fixture, is_listed, minor_band
from workhold.kernels.curves.piece_bounds import chord_tail
from workhold.kernels.curves.roots import MOST_ROOTS, STACK_DEPTH, STACK_LENGTH

# Columns of the statistics a block returns: pairs of pieces looked at, pairs whose crossings were sought,
# four contacts examined, and those that may be inside their features.
PAIRS, CROSSED, CANDIDATES, CONTACTS = range(4)
# Beside these is what another thread asks for: any number but 0 at STOPPED ends the work soon.
STOPPED = 4
STATISTICS = 5
# Rows of what moving pegs need of three standing ones.
TRIPLE_ROWS = 8
# mm. A tail known no better than this is looked for on its other curve, too.
BADLY = 1e-3


class BlockWork(NamedTuple):
    """What a block is given, and its work space.

    Parameters
    ----------
    counting : count all simultaneous contacts instead of looking for fixtures only.
    stats : (5,) counts to add to.
    at : (2,) where among its pairs a kernel stopped.
    stack, roots : see ``roots.crossings``.
    pegs : (4, 6) places, see ``kernels.contact.record``.
    contacts, null : see ``contact.rules.is_fixture``.
    triple : see ``moving_pegs.write_triple``.
    """

    features: Features
    curves: Curves
    lattice: Lattice
    limits: Limits
    counting: bool
    stats: IntArray
    at: IntArray
    stack: Array
    roots: Array
    pegs: Array
    contacts: Array
    null: Array
    triple: Array


@inner_making_arrays
def block_work(
    features: Features, curves: Curves, lattice: Lattice, limits: Limits, counting: bool, stats: IntArray
) -> BlockWork:
    """The work of a block with an empty work space."""
    return BlockWork(
        features,
        curves,
        lattice,
        limits,
        counting,
        stats,
        np.zeros(2, np.int64),
        np.empty((STACK_DEPTH, STACK_LENGTH)),
        np.empty((MOST_ROOTS, 3)),
        np.empty((4, PEG_LENGTH)),
        np.empty((8, 2)),
        np.empty(4),
        np.empty((TRIPLE_ROWS, 3)),
    )


@inner
def is_among(feature: int, touched: tuple[int, int]) -> bool:
    """Whether a feature is among those that the pegs of a carrier touch."""
    return touched[0] <= feature < touched[1]


@inner
def place_tail(
    pegs: Array, curve: int, angle: Angle, reach: float, line: float, features: Array, curves: Curves
) -> None:
    """Writes the tail of a curve's chord to the first of some places, in row ``line`` of column 0.

    ``reach`` is how far in radians psi may be off; the peg's radius follows from it.
    """
    step = curves.integers[curve]
    tail, head = step[TAIL], step[HEAD]
    x, y, radius = chord_tail(features[tail], features[head], curves.reals[curve], *angle, reach)
    place_peg(pegs[0], x, y, tail, 0.0, line, radius)


@inner
def place_head(pegs: Array, place: int, curve: int, angle: Angle, reach: float, curves: Curves) -> None:
    """Writes the head of a curve's chord to a place, from the tail in the first; see ``place_tail``."""
    step, reals = curves.integers[curve], curves.reals[curve]
    d, alpha = reals[LENGTH], angle[0] + reals[SHIFT]
    x, y = pegs[0, PEG_X] + d * cos(alpha), pegs[0, PEG_Y] + d * sin(alpha)
    radius = pegs[0, PEG_RADIUS] + d * reach
    line = pegs[0, PEG_ROW] + float(step[ROW_STEP])
    place_peg(pegs[place], x, y, step[HEAD], float(step[COLUMN_STEP]), line, radius)


@inner
def place_chord(
    pegs: Array, curve: int, angle: Angle, reach: float, line: float, features: Array, curves: Curves
) -> None:
    """Writes the pegs of a curve's chord to (2, 6) places; see ``place_tail``."""
    place_tail(pegs, curve, angle, reach, line, features, curves)
    place_head(pegs, 1, curve, angle, reach, curves)


@inner
def place_triple(
    pegs: Array, one: int, two: int, angle: Angle, reach: float, features: Array, curves: Curves
) -> None:
    """Writes the three standing pegs of two curves with a common tail; see ``place_tail``.

    Where one curve says badly where the tail is, as beside two arcs that are nearly one chord apart, the
    other one may say it well.
    """
    place_tail(pegs, one, angle, reach, 0.0, features, curves)
    radius = pegs[0, PEG_RADIUS]
    if radius > BADLY:
        place_tail(pegs, two, angle, reach, 0.0, features, curves)
        if pegs[0, PEG_RADIUS] >= radius:
            place_tail(pegs, one, angle, reach, 0.0, features, curves)
    place_head(pegs, 1, one, angle, reach, curves)
    place_head(pegs, 2, two, angle, reach, curves)


@inner
def is_far_off(angle: Angle, work: BlockWork) -> bool:
    """Whether two and two pegs in place, just found to be a fixture, have too large a location error.

    Where a half turn swaps the carriers, either may turn out to be the one that stands still.
    """
    features, pegs = work.features, work.pegs
    if features.precision.most == inf or work.counting:
        return False
    radius = swing = 0.0
    numbers = work.null
    for k in range(4):
        row = features.rows[int(pegs[k, PEG_FEATURE])]
        radius = max(radius, pegs[k, PEG_RADIUS])
        if row[IS_ARC] != 0.0:
            swing = max(swing, pegs[k, PEG_RADIUS] / row[RADIUS])
        numbers[k] = pegs[k, PEG_FEATURE]
    length = work.limits.wrench_length
    band, points, normals = minor_band(swing, radius, length), work.contacts[:4], work.contacts[4:]
    given = features.precision
    return two_and_two_beyond(
        points, normals, numbers, angle, length, band, 0, given, work.triple
    ) and two_and_two_beyond(points, normals, numbers, angle, length, band, 2, given, work.triple)


@inner
def add_listed(
    out: Array, count: int, standing: float, angle: Angle, reach: float, once: bool, work: BlockWork
) -> int:
    """Examines the four pegs in place, and appends their record to ``out`` where it is listed.

    Parameters
    ----------
    standing : how many pegs, the first ones, are on the carrier that stands still.
    angle, reach : the orientation, and how far in radians it may be off.
    once : whether the contacts count, where other pegs in place are the same ones.

    Returns
    -------
    how many records there are, -1 when there is no room for another
    """
    pegs, limits, stats = work.pegs, work.limits, work.stats
    verdict, separation = is_fixture(
        pegs, standing, angle, reach, work.features, limits, work.contacts, work.null
    )
    stats[CANDIDATES] += 1
    if verdict > 0 and once:
        stats[CONTACTS] += 1
    if not is_listed(verdict, work.counting, count, limits):
        return count
    if standing == 2.0 and is_far_off(angle, work):
        return count
    if count == out.shape[0]:
        return -1
    write_record(out[count], standing, pegs, angle[0], separation, reach)
    return count + 1
