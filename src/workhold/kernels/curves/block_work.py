"""What the kernels of one block of a search are given and work in, and how they list what they find.

Memory is made by the caller, once for many blocks. A kernel that lists fixtures and has no room for all of
them says so, and is called again with more: :data:`NO_ROOM_FOR_RECORDS`, :data:`NO_ROOM_FOR_PIECES`.
"""

from __future__ import annotations

from math import cos, inf, sin
from typing import NamedTuple

import numpy as np

from workhold.kernels.base.compiling import Array, IntArray, IntMatrix, IntVector, Matrix, Vector, inner
from workhold.kernels.base.feature import IS_ARC, RADIUS
from workhold.kernels.base.tables import (
    COLUMN_STEP,
    EDGE_LENGTH,
    HEAD,
    LENGTH,
    PIECE_LENGTH,
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
    RECORD_LENGTH,
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
# What a kernel returns instead of a number of records where its memory did not suffice.
NO_ROOM_FOR_RECORDS, NO_ROOM_FOR_PIECES = -1, -2
# Columns of roles in ``two_and_two`` and of limbs in ``three_and_one``, and how many parts ``sliding_pairs``
# cuts the range of a sliding pair to.
ROLE_LENGTH, LIMB_LENGTH, SLIDE_PARTS = 20, 20, 8
# Rows of what moving pegs need of three standing ones.
TRIPLE_ROWS = 8
# mm. A tail known no better than this is looked for on its other curve, too.
BADLY = 1e-3


class BlockSpace(NamedTuple):
    """The memory that kernels of blocks work in, one after the other; see :func:`make_block_space`.

    Parameters
    ----------
    stack, roots : see ``roots.crossings``.
    pegs : (4, 6) places, see ``kernels.contact.record``.
    contacts, null : see ``contact.rules.is_fixture``.
    triple : see ``moving_pegs.write_triple``.
    edges : (2, 14) ends of a piece.
    out : (R, 19) receives the records.
    pieces : (P, 24) the pieces of a cell.
    standing, moving, unordered : (P, 20) roles, see ``two_and_two``.
    limbs, unordered_limbs : (P, 20), see ``three_and_one``.
    keys, order : (P,) of what is sorted.
    kept : (M, 15), see ``piece_bounds.clear_edges``.
    spots, slides : (M, 4) and (SLIDE_PARTS, 4), see ``sliding_pairs``.
    """

    stack: Matrix
    roots: Matrix
    pegs: Matrix
    contacts: Matrix
    null: Vector
    triple: Matrix
    edges: Matrix
    out: Matrix
    pieces: Matrix
    standing: Matrix
    moving: Matrix
    unordered: Matrix
    limbs: Matrix
    unordered_limbs: Matrix
    keys: Vector
    order: IntVector
    kept: Matrix
    spots: IntMatrix
    slides: IntMatrix


def make_block_space(records: int, pieces: int, members: int) -> BlockSpace:
    """Return memory for blocks with so many records, pieces in a cell, and curves."""
    return BlockSpace(
        stack=np.empty((STACK_DEPTH, STACK_LENGTH)),
        roots=np.empty((MOST_ROOTS, 3)),
        pegs=np.empty((4, PEG_LENGTH)),
        contacts=np.empty((8, 2)),
        null=np.empty(4),
        triple=np.empty((TRIPLE_ROWS, 3)),
        edges=np.empty((2, EDGE_LENGTH)),
        out=np.empty((records, RECORD_LENGTH)),
        pieces=np.empty((pieces, PIECE_LENGTH)),
        standing=np.empty((pieces, ROLE_LENGTH)),
        moving=np.empty((pieces, ROLE_LENGTH)),
        unordered=np.empty((pieces, ROLE_LENGTH)),
        limbs=np.empty((pieces, LIMB_LENGTH)),
        unordered_limbs=np.empty((pieces, LIMB_LENGTH)),
        keys=np.empty(pieces),
        order=np.empty(pieces, np.int64),
        kept=np.empty((members, EDGE_LENGTH + 1)),
        spots=np.empty((members, 4), np.int64),
        slides=np.empty((SLIDE_PARTS, 4), np.int64),
    )


class BlockWork(NamedTuple):
    """What a block is given, and the memory that it works in.

    Parameters
    ----------
    counting : count all simultaneous contacts instead of looking for fixtures only.
    stats : (5,) counts to add to.
    """

    features: Features
    curves: Curves
    lattice: Lattice
    limits: Limits
    counting: bool
    stats: IntArray
    stack: Array
    roots: Array
    pegs: Array
    contacts: Array
    null: Array
    triple: Array


@inner
def block_work(
    features: Features,
    curves: Curves,
    lattice: Lattice,
    limits: Limits,
    counting: bool,
    stats: IntArray,
    space: BlockSpace,
) -> BlockWork:
    """Return the work of a block in some memory."""
    return BlockWork(
        features,
        curves,
        lattice,
        limits,
        counting,
        stats,
        space.stack,
        space.roots,
        space.pegs,
        space.contacts,
        space.null,
        space.triple,
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
def limits_errors(work: BlockWork) -> bool:
    """Whether only fixtures up to some location error are of interest."""
    return not work.counting and work.features.precision.most < inf


@inner
def is_far_off(angle: Angle, work: BlockWork) -> bool:
    """Whether two and two pegs in place, just found to be a fixture, have too large a location error.

    Where a half turn swaps the carriers, either may turn out to be the one that stands still.
    """
    features, pegs = work.features, work.pegs
    if not limits_errors(work):
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
    how many records there are, or that there is no room for another
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
        return NO_ROOM_FOR_RECORDS
    write_record(out[count], standing, pegs, angle[0], separation, reach)
    return count + 1


@inner
def add_seat(out: Array, count: int, angle: Angle, reach: float, work: BlockWork) -> int:
    """Appends the record of three standing pegs in place, for a search in which nothing moves.

    The place of a fourth peg repeats the first one. Result as for :func:`add_listed`.
    """
    pegs = work.pegs
    work.stats[CANDIDATES] += 1
    if count == out.shape[0]:
        return NO_ROOM_FOR_RECORDS
    place_peg(pegs[3], pegs[0, PEG_X], pegs[0, PEG_Y], int(pegs[0, PEG_FEATURE]), 0.0, 0.0, 0.0)
    write_record(out[count], 3.0, pegs, angle[0], 0.0, reach)
    return count + 1


@inner
def moves_nothing(features: Features) -> bool:
    """Whether three standing pegs are sought alone, and no moving one."""
    return features.moving[0] == features.moving[1]
