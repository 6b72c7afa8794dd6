"""Candidates for fixtures, as arrays: their canonical form, and removal of repetitions, before they become a
table.
"""

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
from workhold.kernels.proof.canonical_form import to_canonical_form, write_contacts
from workhold.listing.runs import make_keys, sort_keys
from workhold.proof.deciding import read_peg_integers

__all__ = [
    "NEAR_END",
    "CandidateFixtures",
    "RowArrays",
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
    "number_places",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Bits of a packed number.
WORD = 63
MOST_PEGS = 4
# mm. Contacts this near to an end may be at a joint, and be listed on the face beside it.
NEAR_END = 1e-4


@define(frozen=True, eq=False)
class RowArrays:
    """A base for classes whose fields are arrays with the same number of rows; its length is that number."""

    def __len__(self) -> int:
        return len(getattr(self, fields(type(self))[0].name))

    def take(self, order: NDArray[np.int64] | NDArray[np.bool_]) -> Self:
        """Return the rows that an index array or a mask selects, as a new object."""
        indices = np.flatnonzero(order) if order.dtype == np.bool_ else order
        return type(self)(*(getattr(self, one.name).take(indices, axis=0) for one in fields(type(self))))

    @classmethod
    def concatenate(cls, parts: Sequence[Self]) -> Self:
        """Return the rows of several objects in order, as one object; there must be at least one."""
        return cls(*(np.concatenate([getattr(part, one.name) for part in parts]) for one in fields(cls)))


@define(frozen=True, eq=False)
class CandidateFixtures(RowArrays):
    """N fixtures not yet in a table; arrays are (N, 4), fixed pegs first, unless noted otherwise.

    Parameters
    ----------
    standing : (N,) number of pegs on the fixed carrier; these are the first ones.
    feature : index of the feature that each peg touches.
    column, row : each peg's hole; columns are counted on each carrier separately, rows on both carriers
        together.
    theta : (N,) orientation of the workpiece in radians.
    point : (N, 4, 2) centres of pegs in the part's frame, relative to the centre of the part, in mm.
    gap : (N,) x distance in mm from the rightmost standing to the leftmost moving peg.
    null : null vector of the pegs' wrenches.
    force : forces of the pegs, divided by the clamping force.
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


def make_candidates(records: Array, problem: Problem) -> CandidateFixtures:
    """Return the candidates that kernel records (N, 19) describe, in the same order.

    Columns of a record: see ``kernels.contact.record``.
    """
    count = len(records)
    feature, column, row = read_peg_integers(records)
    point, gap, null, force = (np.empty((count, *shape)) for shape in ((4, 2), (), (4,), (4,)))
    work = np.empty((WORK_LENGTH, 4)), np.empty((2, 4, 2))
    write_contacts(records, problem.rows, problem.setting, point, gap, null, force, *work)
    standing = records[:, record.STANDING].astype(np.int64)
    return CandidateFixtures(standing, feature, column, row, -records[:, record.PSI], point, gap, null, force)


def make_canonical(c: CandidateFixtures, swapped: int) -> CandidateFixtures:
    """Return each candidate in its canonical form, in the same order; see ``kernels.proof.canonical_form``.

    ``swapped`` is the number of pegs on each carrier at which a half turn exchanges the two carriers; 0 if
    none does.
    """
    theta, column, row = c.theta.copy(), c.column.copy(), c.row.copy()
    order = np.empty((len(c.standing), 4), np.int64)
    to_canonical_form(c.standing, theta, column, row, order, swapped, SAME_POSE)
    place = 4 * np.arange(len(order))[:, None] + order
    point = c.point.reshape(-1, 2).take(place, axis=0)
    feature, null, force = c.feature.take(place), c.null.take(place), c.force.take(place)
    return CandidateFixtures(c.standing, feature, column, row, theta, point, c.gap, null, force)


def assign_contacts_to_faces(records: Array, problem: Problem, pegs: int) -> tuple[IntArray, Array]:
    """Return a copy of each record for every way to assign its contacts near joints to the features that meet
    there.

    The result is (1) for each new record the index (M,) of the record it comes from, ascending, and (2) the
    records (M, 19), the original ones included. Only the first ``pegs`` contacts of a record are varied.
    """
    ends = find_row_ends(problem.rows)
    # Features shorter than this have neighbours that do not begin where they end.
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
    """Return a mask (N,): True where every contact at a joint is on the feature with the lowest index there.

    ``feature`` (N, P) and ``point`` (N, P, 2), in mm from the part's centre, describe P contacts each. With a
    limit of the location error, a contact may be found only on another feature; on the lowest feature its
    error is then beyond the limit.
    """
    one, other = find_joints(problem, JOINT)
    is_lowest = np.ones((len(problem.rows), 2), np.bool_)
    is_lowest.reshape(-1)[one[other // 2 < one // 2]] = False
    at_end = np.abs(point[:, :, None] - find_row_ends(problem.rows)[feature]).max(axis=3) <= END_SLACK
    return np.asarray((is_lowest[feature] | ~at_end).all(axis=(1, 2)))


def find_joints(problem: Problem, within: float) -> tuple[IntArray, IntArray]:
    """Return two arrays (J,) of ends of features that meet each other within ``within`` mm.

    Entry j of the one meets entry j of the other; each pair comes in both orders. Only ends that the same
    pegs can touch are paired. Feature f has the ends 2·f and 2·f + 1.
    """
    one, other = find_meeting_ends(find_row_ends(problem.rows).reshape(-1, 2), within)
    begin, last = problem.moving
    alike = ((one // 2 >= begin) & (one // 2 < last)) == ((other // 2 >= begin) & (other // 2 < last))
    return one[alike], other[alike]


def pack_integers(*columns: tuple[NDArray[np.integer[Any]], int]) -> list[IntArray]:
    """Return as few int64 arrays (N,) as possible that sort lexicographically as the given columns do.

    Parameters
    ----------
    columns : pairs of (1) an array (N, K) of integers from 0 up, and (2) the largest value that they may
        have.
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
    """Return upper bounds (column, row) of the holes of candidates in
    canonical form, from the width of the part.
    """
    lattice = problem.frame.lattice
    reach = problem.diameter + abs(lattice.row_offset)
    return int(reach / lattice.pitch_x) + 2, int(reach / lattice.pitch_y) + 2


def pack_holes(c: CandidateFixtures, most: tuple[int, int] | None = None) -> list[IntArray]:
    """Return packed integers, each (N,), that are equal for candidates of equal arrangement and holes.

    ``most`` is (largest column, largest row); give it if the integers of several calls are compared. None
    takes the largest ones of these candidates.
    """
    column, row = (c.column.max(initial=0), c.row.max(initial=0)) if most is None else most
    return pack_integers((c.standing[:, None], MOST_PEGS), (c.column, column), (c.row, row))


def mark_changes(words: list[IntArray]) -> NDArray[np.bool_]:
    """Return a mask (N,): True for rows that differ from the row before
    in any of the arrays; True for the first row.
    """
    fresh = np.zeros(len(words[0]), np.bool_)
    fresh[:1] = True
    for word in words:
        fresh[1:] |= word[1:] != word[:-1]
    return fresh


def split_into_clusters(
    order: IntArray, fresh: NDArray[np.bool_], *values: tuple[Array, float]
) -> tuple[IntArray, NDArray[np.bool_]]:
    """Return (order (N,), mask (N,) of group starts) in which each group is split where values leap.

    Parameters
    ----------
    order : (N,) indices of items, group by group.
    fresh : (N,) mask of the positions in ``order`` at which a group begins.
    values : pairs of (1) a number (N,) for each item and (2) a leap. With each pair in turn, every group is
        sorted by the numbers, and split where neighbours differ by more than the leap.
    """
    for numbers, leap in values:
        group = np.cumsum(fresh)
        again = np.lexsort([numbers[order], group])
        order, group = order[again], group[again]
        fresh = np.ones(len(order), np.bool_)
        fresh[1:] = (np.diff(group) > 0) | (np.diff(numbers[order]) > leap)
    return order, fresh


def order_by_same_holes(c: CandidateFixtures) -> tuple[IntArray, IntArray]:
    """Return (1) the order (N,) of candidates by type, holes and
    orientation; (2) in that order the group numbers (N,).

    Groups are numbered from 1. Members have the same type and holes, and each an orientation within
    ``SAME_POSE`` of its neighbour's.
    """
    words = pack_holes(c)
    order = sort_keys(make_keys(*words, c.theta))
    fresh = mark_changes([word[order] for word in words])
    fresh[1:] |= np.diff(c.theta[order]) > SAME_POSE
    return order, np.cumsum(fresh)


def list_each_once(c: CandidateFixtures) -> CandidateFixtures:
    """Return the candidates without repetitions, sorted by type, holes, orientation, faces and place.

    A contact at a tangent joint is found on both features that meet there; the one on the lower feature is
    kept. Candidates with the same holes and orientation, but with different places of the part, are all kept.
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


def number_places(point: Array, gap: Array) -> Array:
    """Return one number in mm per candidate, (N,), that distinguishes places of the part at equal holes and
    orientation.

    It mixes the centre of a peg in the part's frame, ``point`` (N, 2), and ``gap`` (N,), both in mm, with
    fixed irrational factors.
    """
    return np.asarray(point @ np.array([1.0, 0.7548776662]) + 0.5698402910 * gap)


def are_at_different_places(c: CandidateFixtures, first: IntArray, group: IntArray) -> IntArray:
    """Return positions in ``first`` of one candidate for each place,
    in the order of group, features and place.

    ``first`` (K,) are indices of candidates; ``group`` (K,) are their groups of equal holes and orientation,
    ascending. Of several candidates at the same place the one with the lowest features is kept.
    """
    place = number_places(c.point[first, 0], c.gap[first])
    order = np.lexsort([place, group])
    new = np.ones(len(order), np.bool_)
    new[1:] = (group[order][1:] != group[order][:-1]) | (np.diff(place[order]) >= SAME_PLACE)
    # Of the same fixture on several faces, the one on the lowest is kept, whichever way its place is rounded.
    run = np.empty(len(order), np.int64)
    run[order] = np.cumsum(new)
    features = (c.feature[first], c.feature.max())
    order = np.lexsort([*reversed(pack_integers((run[:, None], len(run)), features))])
    once = order[np.concatenate([[True], np.diff(run[order]) > 0])]
    words = [place, *reversed(pack_integers((group[:, None], int(group[-1])), features))]
    return np.asarray(once[np.lexsort([word[once] for word in words])])
