"""Fixtures on their way to a table: in the form they are listed in, listed once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Self

import numpy as np
from attrs import define, fields
from numpy.typing import NDArray

from workhold.contact.features import find_meeting_ends
from workhold.contact.problem import Problem
from workhold.conventions import END_SLACK, JOINT, SAME_PLACE, SAME_POSE
from workhold.geometry.segment import find_row_ends
from workhold.kernels.contact import record
from workhold.kernels.contact.record import WORK_LENGTH
from workhold.kernels.proof.canonical_form import contacts_of, to_canonical_form
from workhold.listing.runs import make_keys, order_of
from workhold.proof.deciding import read_peg_integers

__all__ = [
    "NEAR_END",
    "Candidates",
    "Rows",
    "are_lowest",
    "make_candidates",
    "make_canonical",
    "mark_changes",
    "split_into_clusters",
    "list_each_once",
    "bound_holes",
    "assign_contacts_to_faces",
    "pack_integers",
    "pack_holes",
    "place_number",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Bits of a packed number.
WORD = 63
MOST_PEGS = 4
# mm. Contacts this near to an end may be at a joint, and be listed on the face beside it.
NEAR_END = 1e-4


@define(frozen=True, eq=False)
class Rows:
    """Arrays of as many rows each: the fields of a class."""

    def __len__(self) -> int:
        return len(getattr(self, fields(type(self))[0].name))

    def take(self, order: NDArray[np.int64] | NDArray[np.bool_]) -> Self:
        indices = np.flatnonzero(order) if order.dtype == np.bool_ else order
        return type(self)(*(getattr(self, one.name).take(indices, axis=0) for one in fields(type(self))))

    @classmethod
    def concatenate(cls, parts: Sequence[Self]) -> Self:
        """Return the rows of several, at least one."""
        return cls(*(np.concatenate([getattr(part, one.name) for part in parts]) for one in fields(cls)))


@define(frozen=True, eq=False)
class Candidates(Rows):
    """N fixtures on their way to a table; standing pegs first, (N, 4) unless said otherwise.

    Parameters
    ----------
    standing : (N,) how many of the pegs stand on the carrier that stands still.
    feature, column, row : touched feature and lattice place; columns count on each carrier, rows on both
        alike.
    theta : (N,) orientation of the workpiece in radians.
    point : (N, 4, 2) peg centres in the workpiece's frame about the centre of the part, in mm.
    gap : (N,) x distance in mm from the rightmost standing to the leftmost moving peg.
    null, force : null vector and forces per unit of clamping force.
    """

    standing: IntArray
    feature: IntArray
    column: IntArray
    row: IntArray
    theta: Array
    point: Array
    gap: Array
    null: Array
    force: Array


def make_candidates(records: Array, problem: Problem) -> Candidates:
    count = len(records)
    feature, column, row = read_peg_integers(records)
    point, gap, null, force = (np.empty((count, *shape)) for shape in ((4, 2), (), (4,), (4,)))
    work = np.empty((WORK_LENGTH, 4)), np.empty((2, 4, 2))
    contacts_of(records, problem.rows, problem.setting, point, gap, null, force, *work)
    standing = records[:, record.STANDING].astype(np.int64)
    return Candidates(standing, feature, column, row, -records[:, record.PSI], point, gap, null, force)


def make_canonical(c: Candidates, swapped: int) -> Candidates:
    """Return the candidates in the one form each fixture is listed in, see ``kernels.proof.canonical_form``."""
    theta, column, row = c.theta.copy(), c.column.copy(), c.row.copy()
    order = np.empty((len(c.standing), 4), np.int64)
    to_canonical_form(c.standing, theta, column, row, order, swapped, SAME_POSE)
    place = 4 * np.arange(len(order))[:, None] + order
    point = c.point.reshape(-1, 2).take(place, axis=0)
    feature, null, force = c.feature.take(place), c.null.take(place), c.force.take(place)
    return Candidates(c.standing, feature, column, row, theta, point, c.gap, null, force)


def assign_contacts_to_faces(records: Array, problem: Problem, pegs: int) -> tuple[IntArray, Array]:
    """Return which contacts (N, 19) may be listed on which faces: numbers (M,) in order, and contacts (M,
    19).

    Of the first ``pegs`` those at a joint may touch either feature.
    """
    ends = find_row_ends(problem.rows)
    # A feature shorter than that has others beside it that do not begin where it ends.
    one, other = find_joints(problem, 4.0 * NEAR_END)
    points, numbers = make_candidates(records, problem).point, np.arange(len(records))
    for k in range(pegs):
        feature = records[:, record.FEATURES + k].astype(np.int64)
        beside = np.abs(points[numbers, k, None] - ends[feature]).max(axis=2) <= NEAR_END
        near = np.flatnonzero(beside.any(axis=1) & (records[:, record.STANDING] > 0.0))
        place, joint = np.nonzero((feature[near, None] == one // 2) & beside[near][:, one % 2])
        more = records[near[place]]
        more[:, record.FEATURES + k] = other[joint] // 2
        records, numbers = np.concatenate([records, more]), np.concatenate([numbers, numbers[near[place]]])
    order = np.argsort(numbers, kind="stable")
    return numbers[order], records[order]


def are_lowest(feature: IntArray, point: Array, problem: Problem) -> NDArray[np.bool_]:
    """Return whether contacts (N, P) at joints are on the features of the lowest numbers there, where they
    are listed.

    Up to a limit of the location error the contact on another feature alone may be found, where fewer or more
    contacts share a face. The one that is listed is beyond the limit then.
    """
    one, other = find_joints(problem, JOINT)
    is_lowest = np.ones((len(problem.rows), 2), np.bool_)
    is_lowest.reshape(-1)[one[other // 2 < one // 2]] = False
    at_end = np.abs(point[:, :, None] - find_row_ends(problem.rows)[feature]).max(axis=3) <= END_SLACK
    return np.asarray((is_lowest[feature] | ~at_end).all(axis=(1, 2)))


def find_joints(problem: Problem, within: float) -> tuple[IntArray, IntArray]:
    """Return pairs of feature ends (two numbers each) that meet within ``within`` mm and that the same pegs touch."""
    one, other = find_meeting_ends(find_row_ends(problem.rows).reshape(-1, 2), within)
    begin, last = problem.moving
    alike = ((one // 2 >= begin) & (one // 2 < last)) == ((other // 2 >= begin) & (other // 2 < last))
    return one[alike], other[alike]


def pack_integers(*columns: tuple[NDArray[np.integer[Any]], int]) -> list[IntArray]:
    """Return the whole numbers packed into as few numbers (N,) as hold them, in lexicographic order.

    Parameters
    ----------
    columns : (N, K) numbers from 0 upward, each time with the largest there may be.
    """
    words: list[IntArray] = []
    free = 0
    for numbers, largest in columns:
        bits = int(largest).bit_length()
        for k in range(numbers.shape[1]):
            if free < bits or not words:
                words.append(np.zeros(len(numbers), np.int64))
                free = WORD
            words[-1] = (words[-1] << bits) | numbers[:, k]
            free -= bits
    return words


def bound_holes(problem: Problem) -> tuple[int, int]:
    """Return the largest column and row that candidates in the listed form can have: no two pegs are farther
    apart than the part is wide.
    """
    lattice = problem.frame.lattice
    reach = problem.diameter + abs(lattice.row_offset)
    return int(reach / lattice.pitch_x) + 2, int(reach / lattice.pitch_y) + 2


def pack_holes(c: Candidates, most: tuple[int, int] | None = None) -> list[IntArray]:
    """Return the arrangements and holes of candidates, packed; ``most`` are the largest column and row that
    may be packed alike.
    """
    column, row = (c.column.max(initial=0), c.row.max(initial=0)) if most is None else most
    return pack_integers((c.standing[:, None], MOST_PEGS), (c.column, column), (c.row, row))


def mark_changes(words: list[IntArray]) -> NDArray[np.bool_]:
    """Return which entries (N,) of packed numbers differ from the one before; the first does."""
    fresh = np.zeros(len(words[0]), np.bool_)
    fresh[:1] = True
    for word in words:
        fresh[1:] |= word[1:] != word[:-1]
    return fresh


def split_into_clusters(
    order: IntArray, fresh: NDArray[np.bool_], *values: tuple[Array, float]
) -> tuple[IntArray, NDArray[np.bool_]]:
    """Return the groups (N,) in an order, beginning where ``fresh``, split where one value after the other leaps."""
    for numbers, leap in values:
        group = np.cumsum(fresh)
        again = np.lexsort([numbers[order], group])
        order, group = order[again], group[again]
        fresh = np.ones(len(order), np.bool_)
        fresh[1:] = (np.diff(group) > 0) | (np.diff(numbers[order]) > leap)
    return order, fresh


def order_by_same_holes(c: Candidates) -> tuple[IntArray, IntArray]:
    """Return the order (N,) by type, holes and orientation, and in that order the number (N,) of each set that agrees in
    all these."""
    words = pack_holes(c)
    order = order_of(make_keys(*words, c.theta))
    fresh = mark_changes([word[order] for word in words])
    fresh[1:] |= np.diff(c.theta[order]) > SAME_POSE
    return order, np.cumsum(fresh)


def list_each_once(c: Candidates) -> Candidates:
    """Return the candidates sorted by type, holes, orientation, faces and place, without those of the same
    holes and pose.

    A contact exactly at a tangent joint is found on both faces that meet there. Two fixtures with the same
    holes and the same orientation may still differ in where the workpiece lies; one number that mixes all
    that distinguishes them.
    """
    if len(c.standing) == 0:
        return c
    first, group = order_by_same_holes(c)
    fresh = mark_changes([group])
    alone = fresh & np.append(fresh[1:], True)
    if alone.all():
        return c.take(first)
    shared = np.flatnonzero(~alone)
    kept = np.concatenate(
        [np.flatnonzero(alone), shared[are_at_different_places(c, first[shared], group[shared])]]
    )
    return c.take(first[kept[np.argsort(group[kept], kind="stable")]])


def place_number(point: Array, gap: Array) -> Array:
    """Return a number (N,) that distinguishes places of the workpiece.

    It mixes a peg's centre (N, 2) in the workpiece's frame and gaps (N,), both in mm.
    """
    return np.asarray(point @ np.array([1.0, 0.7548776662]) + 0.5698402910 * gap)


def are_at_different_places(c: Candidates, first: IntArray, group: IntArray) -> IntArray:
    """Return which of candidates ``first`` (K,), in ``group`` (K,) by their holes and orientations, are no
    repetitions, in the order of group, faces and place; see :func:`list_each_once`."""
    place = place_number(c.point[first, 0], c.gap[first])
    order = np.lexsort([place, group])
    new = np.ones(len(order), np.bool_)
    new[1:] = (group[order][1:] != group[order][:-1]) | (np.diff(place[order]) >= SAME_PLACE)
    # Of the same fixture on several faces, the one on the lowest is kept, whatever rounding makes of its
    # place.
    run = np.empty(len(order), np.int64)
    run[order] = np.cumsum(new)
    features = (c.feature[first], c.feature.max())
    order = np.lexsort([*reversed(pack_integers((run[:, None], len(run)), features))])
    once = order[np.concatenate([[True], np.diff(run[order]) > 0])]
    words = [place, *reversed(pack_integers((group[:, None], int(group[-1])), features))]
    return np.asarray(once[np.lexsort([word[once] for word in words])])
