"""Two pegs on each carrier: crossings of the heights of two chords, modulo the row pitch (the paper's Type
I).

Glossary: a *role* is a piece of a chord curve with the numbers that matter when its two pegs are on a given
carrier (columns ROLE_... below). A *spot* is a short stretch of a feature on which a contact lies (see
``contact.location_bounds``).

Where a half turn swaps two equal carriers, half a turn of orientations is enough. Each fixture shows up once,
with one of its two chords on the carrier that stands still.

Before crossings are sought, three bounds of the pieces are compared, each by a few additions. The moving
chord must be able to stand the smallest gap to the right of the standing chord. Both must be able to push
against each other along x. The difference of their heights must be able to be a whole number of pitches.
"""

from __future__ import annotations

from math import ceil, cos, floor, sin

import numpy as np

from workhold.conventions import GAP_SLACK, LEAST_CLAMPING
from workhold.kernels.base.arrays import sort_rows
from workhold.kernels.base.compiling import Array, IntArray, IntVector, Vector, compiled, inner
from workhold.kernels.base.tables import (
    ACROSS_LEAST,
    ACROSS_MOST,
    CENTER,
    CURVE,
    HEAD,
    HIGH,
    LEFTWARD_LOW,
    LOW,
    RIGHTWARD_LOW,
    STEADY,
    TAIL,
    VALUE_LEAST,
    VALUE_MOST,
    X_MOVING,
    X_STANDING,
    Curves,
    Features,
    Lattice,
    Limits,
)
from workhold.kernels.chord.evaluation import HEIGHT
from workhold.kernels.contact.location_bounds import (
    BEYOND,
    CONTACT_LENGTH,
    SPOT_NX,
    SPOT_NY,
    bound_least_error_of_four,
    bound_normal_swing,
    find_most_allowed,
)
from workhold.kernels.contact.record import make_angle, write_given_up
from workhold.kernels.curves.block_work import (
    CROSSED,
    NO_ROOM_FOR_PIECES,
    NO_ROOM_FOR_RECORDS,
    PAIRS,
    STOPPED,
    BlockSpace,
    BlockWork,
    add_listed,
    is_among,
    limits_errors,
    make_block_work,
    place_chord,
)
from workhold.kernels.curves.near_spots import write_piece_spots
from workhold.kernels.curves.piece_bounds import HAIR, clear_edges
from workhold.kernels.curves.pieces import write_pieces
from workhold.kernels.curves.roots import MULTIPLE, ROOT_PSI, ROOT_RADIUS, may_meet, write_crossings

# Columns of a role: what the pairing of pieces looks at, one row for each piece that may be on that carrier.
ROLE_X, ROLE_FORCE_LOW, ROLE_FORCE_HIGH, ROLE_VALUE_LEAST = range(4)
ROLE_VALUE_MOST, ROLE_LOW, ROLE_HIGH, ROLE_PIECE = range(4, 8)
# How far the normals at both contacts may be off in radians, and both contacts as spots
# (``contact.location_bounds``).
ROLE_TAIL_SWING, ROLE_HEAD_SWING = 8, 9
ROLE_TAIL_SPOT, ROLE_HEAD_SPOT = 10, 10 + CONTACT_LENGTH


@inner
def write_roles(
    pieces: Array,
    integers: IntArray,
    touched: tuple[int, int],
    x_column: int,
    force_column: int,
    counting: bool,
    out: Array,
) -> int:
    """Write the roles of those pieces whose pegs may be on one carrier to ``out`` (N, 20); return their
    number.

    The columns that :func:`write_role_spots` writes are left out.

    Parameters
    ----------
    pieces : (P, 24) pieces of a cell, see ``base.tables``.
    integers : (C, 7) whole numbers of the curves.
    touched : first and past-the-last number of the features that pegs of the carrier touch.
    x_column : column of the pieces with the bound of the pegs' place along x: X_STANDING or X_MOVING.
    force_column : first of two columns with the range of force directions: RIGHTWARD_LOW or LEFTWARD_LOW.
    counting : whether to keep pieces whose pegs cannot push together as well.
    """
    count = int(np.int64(0))
    for k in range(pieces.shape[0]):
        row = pieces[k]
        if row[force_column] > row[force_column + 1] and not counting:
            continue
        if not is_among(integers[int(row[CURVE]), TAIL], touched):
            continue
        role = out[count]
        role[ROLE_X], role[ROLE_FORCE_LOW] = row[x_column], row[force_column]
        role[ROLE_FORCE_HIGH] = row[force_column + 1]
        role[ROLE_VALUE_LEAST], role[ROLE_VALUE_MOST] = row[VALUE_LEAST], row[VALUE_MOST]
        role[ROLE_LOW], role[ROLE_HIGH], role[ROLE_PIECE] = row[LOW], row[HIGH], k
        count += 1
    return count


@inner
def write_role_spots(roles: Array, pieces: Array, work: BlockWork) -> None:
    """Write the spots of both contacts, and how far their normals may be off in radians, to (N, 20) roles in
    place."""
    loose, curves, length = work.features.loose, work.curves, work.limits.wrench_length
    for k in range(roles.shape[0]):
        role = roles[k]
        piece = pieces[int(role[ROLE_PIECE])]
        number = int(piece[CURVE])
        tail_spot, head_spot = role[ROLE_TAIL_SPOT:ROLE_HEAD_SPOT], role[ROLE_HEAD_SPOT:]
        tail, head = write_piece_spots(piece, tail_spot, head_spot, work.features, curves, length)
        role[ROLE_TAIL_SWING] = bound_normal_swing(loose[curves.integers[number, TAIL]], tail.radius)
        role[ROLE_HEAD_SWING] = bound_normal_swing(loose[curves.integers[number, HEAD]], head.radius)


@inner
def is_still_beyond(still: Array, moving: Array, work: BlockWork) -> bool:
    """Return whether every fixture of two roles has too large a location error, ``still`` being the standing
    one.

    ``still`` and ``moving`` are rows (20,). False where this is not certain.
    """
    low, high = max(still[ROLE_LOW], moving[ROLE_LOW]), min(still[ROLE_HIGH], moving[ROLE_HIGH])
    psi, half = (low + high) / 2.0, (high - low) / 2.0
    ahead, aside = cos(psi), sin(psi)
    tail, head = moving[ROLE_TAIL_SPOT:ROLE_HEAD_SPOT], moving[ROLE_HEAD_SPOT:]
    one = tail[SPOT_NX] * ahead + tail[SPOT_NY] * aside
    two = head[SPOT_NX] * ahead + head[SPOT_NY] * aside
    off, other_off = moving[ROLE_TAIL_SWING] + half, moving[ROLE_HEAD_SWING] + half
    larger = max(abs(one) - off, abs(two) - other_off)
    if larger <= 0.0:
        return False
    given = work.features.precision
    most = BEYOND * find_most_allowed(low, high, given)
    first, second = still[ROLE_TAIL_SPOT:ROLE_HEAD_SPOT], still[ROLE_HEAD_SPOT:]
    extra = (2.0 * off / larger, 2.0 * other_off / larger)
    least = bound_least_error_of_four(
        first, second, tail, head, (one, two), extra, given, work.triple, work.null, most
    )
    return least > most


@inner
def are_beyond(standing: Array, moving: Array, work: BlockWork) -> bool:
    """Return whether every fixture of two roles has too large a location error, whichever of them stands
    still.

    False where this is not certain.
    """
    return is_still_beyond(standing, moving, work) and is_still_beyond(moving, standing, work)


@inner
def find_flat_slope(first: Array, second: Array) -> float:
    """Return the slope, in mm per radian, of the difference of heights below which two pieces clamp too
    weakly everywhere.

    The joint forces of the pegs of both carriers act along the line through the chords' instant centres P_A
    and P_B. Of such a force of size 1, x . (P_B - P_A) / |P_B - P_A| clamps, and x . (P_B - P_A) is minus the
    slope.
    """
    across = max(first[ACROSS_LEAST] - second[ACROSS_MOST], second[ACROSS_LEAST] - first[ACROSS_MOST])
    return 0.9 * LEAST_CLAMPING * max(across, 0.0)


@inner
def may_cross(standing: Array, moving: Array, lattice: Lattice, counting: bool) -> bool:
    """Return whether the chords of two roles may make a fixture, by their force directions, ranges of psi and
    heights.

    The gap between the carriers is not examined. When ``counting``, the force directions are not examined
    either.
    """
    if not counting and (
        moving[ROLE_FORCE_LOW] > standing[ROLE_FORCE_HIGH]
        or moving[ROLE_FORCE_HIGH] < standing[ROLE_FORCE_LOW]
    ):
        return False
    if moving[ROLE_LOW] >= standing[ROLE_HIGH] or standing[ROLE_LOW] >= moving[ROLE_HIGH]:
        return False
    lowest = moving[ROLE_VALUE_LEAST] - standing[ROLE_VALUE_MOST] - lattice.row_offset - HAIR
    highest = moving[ROLE_VALUE_MOST] - standing[ROLE_VALUE_LEAST] - lattice.row_offset + HAIR
    return ceil(lowest / lattice.pitch_y) * lattice.pitch_y <= highest


@inner
def counts_once(features: Features, lattice: Lattice) -> bool:
    """Return whether exchanging the carriers of two chords makes no other simultaneous contact.

    That is so where pegs of both carriers touch the same features, and twice the row offset is a whole number
    of pitches.
    """
    offsets = 2.0 * lattice.row_offset / lattice.pitch_y
    return features.standing[0] == features.moving[0] and abs(floor(offsets + 0.5) - offsets) <= 1e-12


@inner
def add_crossings(out: Array, count: int, number: int, one: int, two: int, work: BlockWork) -> int:
    """Examine the four contacts at each crossing of two curves, and append those that are to be listed to
    ``out``.

    The crossings are the first ``number`` rows of ``work.roots``; ``one`` (standing) and ``two`` (moving) are
    the indices of the curves. ``count`` records are written already. ``out`` must have room for ``number``
    more. Return the new number of records.
    """
    pegs, roots, rows, curves = work.pegs, work.roots, work.features.rows, work.curves
    for root in range(number):
        psi, reach = roots[root, ROOT_PSI], roots[root, ROOT_RADIUS]
        # The height of the moving chord over the standing one is the row offset and so many pitches.
        angle = make_angle(psi)
        place_chord(pegs[:2], one, angle, reach, 0.0, rows, curves)
        place_chord(pegs[2:], two, angle, reach, roots[root, MULTIPLE], rows, curves)
        count = add_listed(out, count, 2.0, angle, reach, True, work)
    return count


@inner
def add_pairs(out: Array, count: int, standing: Array, moving: Array, pieces: Array, work: BlockWork) -> int:
    """Append the records of all pairs of a standing and a moving role to ``out``, and pairs given up.

    ``count`` records are written already. Return the new number, or NO_ROOM_FOR_RECORDS (-1).

    Parameters
    ----------
    standing, moving : (N, 20) and (M, 20) roles; the moving ones in descending order of ROLE_X.
    pieces : (P, 24) that the roles refer to.
    """
    stats, counting = work.stats, work.counting
    features, curves, lattice, limits = work.features, work.curves, work.lattice, work.limits
    integers, offset, pitch_y = curves.integers, lattice.row_offset, lattice.pitch_y
    gap, asks_errors = limits.gap - GAP_SLACK - HAIR, limits_errors(work)
    once = counting and limits.most_listed == 0.0 and counts_once(features, lattice)
    for i in range(standing.shape[0]):
        if stats[STOPPED] != 0:
            break
        role = standing[i]
        first = pieces[int(role[ROLE_PIECE])]
        one = int(first[CURVE])
        for j in range(moving.shape[0]):
            other = moving[j]
            if not counting and other[ROLE_X] - role[ROLE_X] < gap:
                break
            stats[PAIRS] += 1
            if not may_cross(role, other, lattice, counting):
                continue
            second = pieces[int(other[ROLE_PIECE])]
            two = int(second[CURVE])
            if one == two or (integers[one, CENTER] >= 0 and integers[one, CENTER] == integers[two, CENTER]):
                continue
            if once and one > two:
                continue
            steady = first[STEADY] * second[STEADY] == 1.0
            if steady and not may_meet(first, second, offset, pitch_y):
                continue
            if asks_errors and are_beyond(role, other, work):
                continue
            if stats[STOPPED] != 0:
                break
            flat = 0.0 if counting else find_flat_slope(first, second)
            number = write_crossings(
                first, second, features.loose, curves, HEIGHT, offset, pitch_y, flat, work.stack, work.roots
            )
            if count + max(number, 1) > out.shape[0]:
                return NO_ROOM_FOR_RECORDS
            stats[CROSSED] += 1
            if number < 0:
                write_given_up(out[count], 2.0, first, second, integers)
                count += 1
            count = add_crossings(out, count, number, one, two, work)
    return count


@compiled
def write_two_and_two(
    edges: Vector,
    members: IntVector,
    features: Features,
    curves: Curves,
    lattice: Lattice,
    limits: Limits,
    counting: bool,
    stats: IntVector,
    space: BlockSpace,
) -> int:
    """Write the fixtures of two and two pegs with psi in some neighbouring cells to ``space.out``.

    Those that rest on a sliding pair are left out.

    Parameters
    ----------
    edges : (K + 1,) edges of the K cells, psi in radians, ascending.
    members : (M,) indices, ascending, of the curves that exist in some of the cells.
    counting : whether to count all simultaneous contacts (in ``stats``) instead of looking for fixtures only.
        Those that are listed, if any, are listed with either chord on the carrier that stands still.
    stats : (5,) counts to add to, see :class:`BlockWork`; once its entry ``STOPPED`` is not 0, what was found
        so far is returned.

    Returns
    -------
    Number of records, or NO_ROOM_FOR_RECORDS or NO_ROOM_FOR_PIECES (both negative).
    """
    count = int(np.int64(0))
    work = make_block_work(features, curves, lattice, limits, counting, stats, space)
    kept = space.kept[: members.shape[0]]
    clear_edges(kept)
    pitch_x, least_margin = lattice.pitch_x, limits.least_margin
    # Where closing clamps, standing pegs push to the right; where opening does, to the left.
    standing_force, moving_force = RIGHTWARD_LOW, LEFTWARD_LOW
    if limits.clamping < 0.0:
        standing_force, moving_force = LEFTWARD_LOW, RIGHTWARD_LOW
    for cell in range(edges.shape[0] - 1):
        if stats[STOPPED] != 0:
            break
        number = write_pieces(
            edges[cell],
            edges[cell + 1],
            members,
            features.loose,
            curves,
            pitch_x,
            least_margin,
            HEIGHT,
            np.inf,
            kept,
            space.edges,
            space.pieces,
        )
        if number < 0:
            return NO_ROOM_FOR_PIECES
        pieces, integers = space.pieces[:number], curves.integers
        standing = write_roles(
            pieces, integers, features.standing, X_STANDING, standing_force, counting, space.standing
        )
        moving = write_roles(
            pieces, integers, features.moving, X_MOVING, moving_force, counting, space.unordered
        )
        if limits_errors(work):
            write_role_spots(space.standing[:standing], pieces, work)
            write_role_spots(space.unordered[:moving], pieces, work)
        # The rightmost first.
        sort_rows(
            space.unordered[:moving],
            ROLE_X,
            -1.0,
            space.keys[:moving],
            space.order[:moving],
            space.moving[:moving],
        )
        count = add_pairs(space.out, count, space.standing[:standing], space.moving[:moving], pieces, work)
        if count < 0:
            return NO_ROOM_FOR_RECORDS
    return count
