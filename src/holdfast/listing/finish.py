"""From the kernels' records to a table of fixtures: polished, written out as holes, listed once, ranked."""

from __future__ import annotations

from collections.abc import Iterator
from threading import Event
from typing import Any

import numpy as np
from attrs import define
from numpy.typing import NDArray

from holdfast.kernels import vise_checks as record
from holdfast.kernels.standing import contacts_of, stand
from holdfast.listing.deciding import Account, Course, decided, is_left, peg_integers, setting_of
from holdfast.listing.problem import Problem, Progress
from holdfast.model.result import FixtureTable
from holdfast.model.vise import Vise

__all__ = ["Candidates", "changes", "finish", "listed_once", "packed", "placed", "standing", "twins"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Orientations nearer than this, in radians, are one pose.
SAME_POSE = 1e-6
# Places nearer than this, in mm, are one.
SAME_PLACE = 1e-6
BLOCK = 1 << 16
# Bits of a packed number.
WORD = 63


@define(frozen=True, eq=False)
class Candidates:
    """N fixtures on their way to a table; pegs of the left jaw first, (N, 4) unless said otherwise.

    Parameters
    ----------
    kind : (N,) 1 or 2.
    feature, column, row : touched feature and lattice place; columns count on each jaw, rows on both alike.
    theta : (N,) orientation of the workpiece in radians.
    point : (N, 4, 2) peg centres in the workpiece's frame about the centre of the part, in mm.
    opening : (N,) x distance in mm from the rightmost left peg to the leftmost right peg.
    null, force : null vector and forces per unit of clamping force.
    """

    kind: IntArray
    feature: IntArray
    column: IntArray
    row: IntArray
    theta: Array
    point: Array
    opening: Array
    null: Array
    force: Array

    def take(self, order: NDArray[np.int64] | NDArray[np.bool_]) -> Candidates:
        """The candidates of an index array or mask, in its order."""
        return Candidates(*(getattr(self, name)[order] for name in CANDIDATE_FIELDS))


CANDIDATE_FIELDS = ("kind", "feature", "column", "row", "theta", "point", "opening", "null", "force")


def candidates_of(records: Array, problem: Problem) -> Candidates:
    """Proven records as candidates."""
    count = len(records)
    feature, column, row = peg_integers(records)
    point, opening, null, force = (np.empty((count, *shape)) for shape in ((4, 2), (), (4,), (4,)))
    contacts_of(records, problem.rows, setting_of(problem), point, opening, null, force)
    kind = records[:, record.KIND].astype(np.int64)
    return Candidates(kind, feature, column, row, -records[:, record.PSI], point, opening, null, force)


def joined(parts: list[Candidates]) -> Candidates:
    """All candidates of several lists as one."""
    return Candidates(*(np.concatenate([getattr(p, name) for p in parts]) for name in CANDIDATE_FIELDS))


def standing(c: Candidates) -> Candidates:
    """Bring candidates to the one form each fixture is listed in (``kernels.standing.stand``)."""
    theta, column, row = c.theta.copy(), c.column.copy(), c.row.copy()
    order = np.empty((len(c.kind), 4), np.int64)
    stand(c.kind, theta, column, row, order, SAME_POSE)
    place = 4 * np.arange(len(order))[:, None] + order
    point = c.point.reshape(-1, 2)[place]
    feature, null, force = (np.ravel(values)[place] for values in (c.feature, c.null, c.force))
    return Candidates(c.kind, feature, column, row, theta, point, c.opening, null, force)


def packed(*columns: tuple[NDArray[np.integer[Any]], int]) -> list[IntArray]:
    """Whole numbers packed into as few numbers (N,) as hold them, in lexicographic order.

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


def packed_holes(c: Candidates) -> list[IntArray]:
    """Types and holes of candidates, packed."""
    return packed((c.kind[:, None], 2), *((numbers, numbers.max(initial=0)) for numbers in (c.column, c.row)))


def changes(words: list[IntArray]) -> NDArray[np.bool_]:
    """Which entries (N,) of packed numbers differ from the one before; the first does."""
    fresh = np.zeros(len(words[0]), np.bool_)
    fresh[:1] = True
    for word in words:
        fresh[1:] |= word[1:] != word[:-1]
    return fresh


def same_holes_first(c: Candidates) -> tuple[IntArray, IntArray]:
    """Order (N,) by type, holes and orientation, and in that order the number (N,) of each set that agrees in all these."""
    words = packed_holes(c)
    order = np.lexsort([c.theta, *reversed(words)])
    fresh = changes([word[order] for word in words])
    fresh[1:] |= np.diff(c.theta[order]) > SAME_POSE
    return order, np.cumsum(fresh)


def listed_once(c: Candidates) -> Candidates:
    """Sort by type, holes, orientation and place, and drop repetitions: same holes, same pose.

    A contact exactly at a tangent joint is found on both faces that meet there. Two fixtures with the same holes and the
    same orientation may still differ in where the workpiece lies; one number that mixes all that tells them apart.
    """
    if len(c.kind) == 0:
        return c
    first, group = same_holes_first(c)
    place = (c.point[:, 0] @ np.array([1.0, 0.7548776662]) + 0.5698402910 * c.opening)[first]
    order = np.lexsort([place, group])
    new = np.ones(len(order), np.bool_)
    new[1:] = (group[order][1:] != group[order][:-1]) | (np.diff(place[order]) >= SAME_PLACE)
    # Of the same fixture on several faces, the one on the lowest is kept, whatever rounding makes of its place.
    run = np.empty(len(order), np.int64)
    run[order] = np.cumsum(new)
    order = np.lexsort([*reversed(packed((run[:, None], len(run)), (c.feature[first], c.feature.max())))])
    return c.take(first[order[np.concatenate([[True], np.diff(run[order]) > 0])]])


def twins(c: Candidates, face: IntArray) -> tuple[IntArray, IntArray]:
    """Split fixtures with the same faces, holes and orientation that differ only in where the workpiece lies.

    Returns
    -------
    (the one of each set with the best closure margin, the others), as indices; both in an order by type, holes,
    orientation and faces.
    """
    if len(c.kind) == 0:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    order, sets = same_holes_first(c)
    group = np.empty(len(order), np.int64)
    group[order] = sets
    words = packed((group[:, None], len(group)), (face, face.max()))
    margin = -np.round(c.null.min(axis=1), 9)
    order = np.lexsort([c.point[:, 0, 1], c.point[:, 0, 0], margin, *reversed(words)])
    first = changes([word[order] for word in words])
    return order[first], order[~first]


def finish(
    records: list[Array], problem: Problem, progress: Progress | None = None, cancel: Event | None = None
) -> tuple[Candidates, Account]:
    """Polish, decide, bring to the listed form and list once.

    Parameters
    ----------
    records : (N, 19) arrays from the kernels.
    progress : called as ``progress(fraction done, records that still may be fixtures)``.
    cancel : when set, only what needs no ball arithmetic and the like is decided.

    Returns
    -------
    (the fixtures, an account of all records)
    """
    course = Course(sum(map(len, records)), progress, cancel)
    parts: list[Candidates] = []
    accounts: list[Account] = []
    for block in blocks_of(records):
        proven, account = decided(block, problem, course)
        parts.append(standing(candidates_of(proven, problem)))
        accounts.append(account)
    everything = joined(parts)
    vise = problem.vise
    fits = placement(everything, vise)[3]
    if vise.rows is not None:
        fits &= everything.row.max(axis=1, initial=0) < vise.rows
    if not fits.all():
        everything = everything.take(fits)
    return listed_once(everything), Account.together(accounts)


def blocks_of(records: list[Array]) -> Iterator[Array]:
    """Arrays of records put together and cut into blocks, for fewer steps of array arithmetic; at least one, if empty."""
    waiting: list[Array] = [np.zeros((0, record.RECORD_LENGTH))]
    count = 0
    for array in records:
        waiting.append(array)
        count += len(array)
        if count >= BLOCK:
            together = np.concatenate(waiting)
            waiting, count = [together[:0]], 0
            yield from (together[k : k + BLOCK] for k in range(0, len(together), BLOCK))
    yield np.concatenate(waiting)


def placement(c: Candidates, vise: Vise) -> tuple[IntArray, IntArray, IntArray, NDArray[np.bool_]]:
    """Columns each jaw's pegs stand outward from the opening (left, right), columns free on the left, and what fits.

    Pegs stand in the columns nearest the opening; when that opens the vise too far they move outward, first on the left
    jaw, then on the right (model: "written out").
    """
    left = is_left(c.kind)
    free_left = vise.columns - 1 - np.where(left, c.column, 0).max(axis=1, initial=0)
    free_right = vise.columns - 1 - np.where(left, 0, c.column).max(axis=1, initial=0)
    outward = np.zeros(len(c.kind), np.int64)
    if vise.max_opening is not None:
        too_far = c.opening - vise.max_opening - record.GAP_SLACK
        outward = np.maximum(np.ceil(too_far / vise.pitch[0]).astype(np.int64), 0)
    separation = c.opening - outward * vise.pitch[0]
    fits = (outward <= free_left + free_right) & (separation >= vise.min_gap - record.GAP_SLACK)
    move_left = np.minimum(outward, free_left)
    return move_left, outward - move_left, free_left, fits


def placed(c: Candidates, faces: IntArray, vise: Vise, center: tuple[float, float]) -> FixtureTable:
    """Write candidates that fit out as holes of the jaws."""
    left = is_left(c.kind)
    move_left, move_right, free_left, _ = placement(c, vise)
    column = np.where(left, c.column + (free_left - move_left)[:, None], c.column + move_right[:, None])
    row = c.row
    if vise.rows is not None:
        row = row + ((vise.rows - 1 - row.max(axis=1)) // 2)[:, None]
    cosine, sine = np.cos(c.theta), np.sin(c.theta)
    anchor = c.point[:, 0] + np.asarray(center)
    x = column[:, 0] * vise.pitch[0] - (cosine * anchor[:, 0] - sine * anchor[:, 1])
    y = row[:, 0] * vise.pitch[1] - (sine * anchor[:, 0] + cosine * anchor[:, 1])
    return FixtureTable(
        type=c.kind.astype(np.int8),
        jaw=(~left).astype(np.int8),
        column=column.astype(np.int32),
        row=row.astype(np.int32),
        segment=faces[c.feature].astype(np.int32),
        theta=c.theta,
        position=np.stack([x, y], axis=1),
        jaw_separation=c.opening - (move_left + move_right) * vise.pitch[0],
        null_vector=c.null,
        force=c.force,
    )
