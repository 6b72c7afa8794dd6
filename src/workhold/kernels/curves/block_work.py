"""Inputs and work space of the kernels of one block (a share of a search), and how the kernels list fixtures.

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
from workhold.kernels.contact.location_bounds import is_two_and_two_beyond
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
from workhold.kernels.contact.rules import bound_minor_error, is_fixture, is_to_be_listed
from workhold.kernels.curves.piece_bounds import compute_tail
from workhold.kernels.curves.roots import MOST_ROOTS, STACK_DEPTH, STACK_LENGTH

# Columns of the statistics a block returns: pairs of pieces looked at, pairs whose crossings were sought,
# four contacts examined, and those that may be inside their features.
PAIRS, CROSSED, CANDIDATES, CONTACTS = range(4)
# The column STOPPED is written by another thread: any number but 0 there ends the work soon.
STOPPED = 4
STATISTICS = 5
# What a kernel returns instead of a number of records where its memory did not suffice.
NO_ROOM_FOR_RECORDS, NO_ROOM_FOR_PIECES = -1, -2
# Columns of roles in ``two_and_two`` and of limbs in ``three_and_one``, and the number of parts into which
# ``sliding_pairs`` cuts the range of a sliding pair.
ROLE_LENGTH, LIMB_LENGTH, SLIDE_PARTS = 20, 20, 8
# Rows of the array of three standing pegs, see ``moving_pegs.write_triple``.
TRIPLE_ROWS = 8
# mm. A tail that one curve determines no better than this is computed from its other curve, too.
BADLY = 1e-3


class BlockSpace(NamedTuple):
    """The memory that kernels of blocks work in, made by
    :func:`make_block_space` and used by one block after another.

    Parameters
    ----------
    stack, roots : see ``roots.write_crossings``.
    pegs : (4, 6) pegs in place, see ``kernels.contact.record``.
    contacts, null : see ``contact.rules.is_fixture``.
    triple : (8, 3), see ``moving_pegs.write_triple``.
    edges : (2, 14) ends of a piece, see ``base.tables``.
    out : (R, 19) receives the records, see ``kernels.contact.record``.
    pieces : (P, 24) the pieces of a cell, see ``base.tables``.
    standing, moving, unordered : (P, 20) roles, see ``two_and_two``.
    limbs, unordered_limbs : (P, 20), see ``three_and_one``.
    keys, order : (P,) work space for sorting.
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
    """Return memory, not initialized, for blocks with these numbers of
    records, of pieces in a cell, and of member curves.
    """
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
    """The inputs of a block, and the memory that it works in.

    Parameters
    ----------
    counting : whether to count all simultaneous contacts instead of looking for fixtures only.
    stats : (5,) counts to add to: PAIRS of pieces examined, CROSSED pairs whose crossings were sought,
        CANDIDATES (four contacts examined) and CONTACTS (those that may be inside their features). Any number
        but 0 at STOPPED ends the work soon.
    stack, roots, pegs, contacts, null, triple : see :class:`BlockSpace`.
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
def make_block_work(
    features: Features,
    curves: Curves,
    lattice: Lattice,
    limits: Limits,
    counting: bool,
    stats: IntArray,
    space: BlockSpace,
) -> BlockWork:
    """Return a :class:`BlockWork` of these inputs with memory from ``space``."""
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
    """Return whether ``touched[0] <= feature < touched[1]``: whether a feature is in the range ``touched`` of
    a carrier."""
    return touched[0] <= feature < touched[1]


@inner
def place_tail(
    pegs: Array, curve: int, angle: Angle, reach: float, line: float, features: Array, curves: Curves
) -> None:
    """Write the tail of a curve's chord to ``pegs[0]`` (6,), in lattice row ``line`` and column 0.

    ``curve`` is the curve's index. ``angle`` is an orientation psi in the curve's range, off by up to
    ``reach`` radians; the peg's error radius in mm follows from that. See ``contact.record`` for the layout
    of ``pegs``, ``base.feature`` for that of ``features``.
    """
    step = curves.integers[curve]
    tail, head = step[TAIL], step[HEAD]
    x, y, radius = compute_tail(
        features[tail], features[head], curves.reals[curve], angle.psi, angle.cosine, angle.sine, reach
    )
    place_peg(pegs[0], x, y, tail, 0.0, line, radius)


@inner
def place_head(pegs: Array, place: int, curve: int, angle: Angle, reach: float, curves: Curves) -> None:
    """Write the head of a curve's chord to ``pegs[place]``, starting
    from the tail in ``pegs[0]``; see :func:`place_tail`.

    See ``contact.record`` for the layout of ``pegs``.
    """
    step, reals = curves.integers[curve], curves.reals[curve]
    d, alpha = reals[LENGTH], angle.psi + reals[SHIFT]
    x, y = pegs[0, PEG_X] + d * cos(alpha), pegs[0, PEG_Y] + d * sin(alpha)
    radius = pegs[0, PEG_RADIUS] + d * reach
    line = pegs[0, PEG_ROW] + float(step[ROW_STEP])
    place_peg(pegs[place], x, y, step[HEAD], float(step[COLUMN_STEP]), line, radius)


@inner
def place_chord(
    pegs: Array, curve: int, angle: Angle, reach: float, line: float, features: Array, curves: Curves
) -> None:
    """Write the tail and head of a curve's chord to ``pegs[0]`` and ``pegs[1]``; see :func:`place_tail`.

    See ``contact.record`` for the layout of ``pegs``, ``base.feature`` for that of ``features``.
    """
    place_tail(pegs, curve, angle, reach, line, features, curves)
    place_head(pegs, 1, curve, angle, reach, curves)


@inner
def place_triple(
    pegs: Array, one: int, two: int, angle: Angle, reach: float, features: Array, curves: Curves
) -> None:
    """Write the three standing pegs of curves ``one`` and ``two``, which share their tail, to ``pegs[:3]``.

    They are the tail and the heads of ``one`` and ``two``; see :func:`place_tail`. Where curve ``one``
    determines the tail only to more than ``BADLY`` mm, as beside two arcs that are nearly one chord apart,
    the tail is taken from the curve that determines it better. See ``contact.record`` for the layout of
    ``pegs``, ``base.feature`` for that of ``features``.
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
    """Return whether only fixtures up to a given location error are sought, and contacts are not just
    counted."""
    return not work.counting and work.features.precision.most < inf


@inner
def is_far_off(angle: Angle, work: BlockWork) -> bool:
    """Return whether the fixture of the two and two pegs in place certainly has too large a location error.

    The error must be too large whichever carrier stands still, as a half turn may swap the carriers.
    ``work.contacts`` must hold what ``is_fixture`` has just written there. False where location errors are
    not limited.
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
    band, points, normals = bound_minor_error(swing, radius, length), work.contacts[:4], work.contacts[4:]
    given = features.precision
    return is_two_and_two_beyond(
        points, normals, numbers, angle, length, band, 0, given, work.triple
    ) and is_two_and_two_beyond(points, normals, numbers, angle, length, band, 2, given, work.triple)


@inner
def add_listed(
    out: Array, count: int, standing: float, angle: Angle, reach: float, once: bool, work: BlockWork
) -> int:
    """Examine the four pegs in ``work.pegs``; append their record to ``out`` if it is to be listed.

    Parameters
    ----------
    out, count : (R, 19) records, of which the first ``count`` are written.
    standing : how many pegs, the first ones, are on the carrier that stands still.
    angle, reach : the orientation, and how far in radians it may be off.
    once : whether to add the contacts to ``stats[CONTACTS]``; False where the same contacts are examined
        twice.

    Returns
    -------
    New number of records, or NO_ROOM_FOR_RECORDS (-1)
    """
    pegs, limits, stats = work.pegs, work.limits, work.stats
    verdict, separation = is_fixture(
        pegs, standing, angle, reach, work.features, limits, work.contacts, work.null
    )
    stats[CANDIDATES] += 1
    if verdict > 0 and once:
        stats[CONTACTS] += 1
    if not is_to_be_listed(verdict, work.counting, count, limits):
        return count
    if standing == 2.0 and is_far_off(angle, work):
        return count
    if count == out.shape[0]:
        return NO_ROOM_FOR_RECORDS
    write_record(out[count], standing, pegs, angle.psi, separation, reach)
    return count + 1


@inner
def add_seat(out: Array, count: int, angle: Angle, reach: float, work: BlockWork) -> int:
    """Append the record of the three standing pegs in ``work.pegs``
    to ``out``, for a search without moving pegs.

    The fourth peg of the record repeats the first one. Return the new number of records, or
    NO_ROOM_FOR_RECORDS (-1).
    """
    pegs = work.pegs
    work.stats[CANDIDATES] += 1
    if count == out.shape[0]:
        return NO_ROOM_FOR_RECORDS
    place_peg(pegs[3], pegs[0, PEG_X], pegs[0, PEG_Y], int(pegs[0, PEG_FEATURE]), 0.0, 0.0, 0.0)
    write_record(out[count], 3.0, pegs, angle.psi, 0.0, reach)
    return count + 1


@inner
def has_no_moving_peg(features: Features) -> bool:
    """Return whether only three standing pegs are sought: no feature is touched by moving pegs."""
    return features.moving[0] == features.moving[1]
