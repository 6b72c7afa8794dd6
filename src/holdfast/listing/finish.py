"""From the kernels' records to a table of fixtures: polished, written out as holes, listed once, ranked."""

from __future__ import annotations

from math import pi, tau
from typing import Any

import numpy as np
from attrs import define, evolve
from numpy.typing import NDArray

from holdfast.kernels import vise_checks as record
from holdfast.listing.deciding import Account, contacts_of, decided, is_left, peg_integers
from holdfast.listing.problem import Problem
from holdfast.model.result import FixtureTable
from holdfast.model.vise import Vise
from holdfast.statics.wrenches import clamping_force, null_vectors, outward_normals

__all__ = ["Candidates", "finish", "placed", "standing", "twins"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Orientations nearer than this, in radians, are one pose.
SAME_POSE = 1e-6
# Places nearer than this, in mm, are one.
SAME_PLACE = 1e-6
BLOCK = 1 << 16


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
PEG_FIELDS = ("feature", "column", "row", "point", "null", "force")


def candidates_of(records: Array, problem: Problem) -> Candidates:
    """Proven records as candidates."""
    feature, column, row = peg_integers(records)
    contacts = contacts_of(records, problem)
    kind = records[:, record.KIND].astype(np.int64)
    left, theta = is_left(kind), -contacts.psi
    normals = outward_normals(contacts.rows, contacts.points)
    null = null_vectors(contacts.points, normals, problem.wrench_length)
    clamp = clamping_force(null, normals, theta, left)
    along = np.cos(theta)[:, None] * contacts.points[..., 0] - np.sin(theta)[:, None] * contacts.points[..., 1]
    opening = np.where(left, np.inf, along).min(axis=1) - np.where(left, along, -np.inf).max(axis=1)
    return Candidates(kind, feature, column, row, theta, contacts.points, opening, null, null / clamp[:, None])


def joined(parts: list[Candidates]) -> Candidates:
    """All candidates of several lists as one."""
    return Candidates(*(np.concatenate([getattr(p, name) for p in parts]) for name in CANDIDATE_FIELDS))


def with_pegs_in(c: Candidates, order: IntArray) -> Candidates:
    """The same fixtures with their pegs in another order, (N, 4) indices."""

    def sorted_pegs(values: NDArray[Any]) -> NDArray[Any]:
        return np.take_along_axis(values, order if values.ndim == 2 else order[..., None], axis=1)

    return evolve(c, **{name: sorted_pegs(getattr(c, name)) for name in PEG_FIELDS})


def half_turned(c: Candidates, which: NDArray[np.bool_]) -> Candidates:
    """Turn the vise half way round under some Type I candidates: the jaws swap, rows and columns run the other way."""
    sign = np.where(which, -1, 1)[:, None]
    theta = np.where(which, c.theta - pi, c.theta)
    moved = with_pegs_in(c, np.where(which[:, None], np.array([3, 2, 1, 0]), np.arange(4)))
    return evolve(moved, column=sign * moved.column, row=sign * moved.row, theta=theta)


def standing(c: Candidates) -> Candidates:
    """Bring candidates to the one form each fixture is listed in.

    Orientations are in [0, 2 pi), for Type I in [0, pi); columns count from the leftmost peg of each jaw, rows from the
    lowest of all; pegs of a jaw are in the order of columns and rows.
    """
    c = evolve(c, theta=(c.theta + SAME_POSE) % tau - SAME_POSE)
    c = half_turned(c, (c.kind == 1) & (c.theta >= pi - SAME_POSE))
    left = is_left(c.kind)
    far = np.int64(1) << 40
    left_base = np.where(left, c.column, far).min(axis=1, keepdims=True)
    right_base = np.where(left, far, c.column).min(axis=1, keepdims=True)
    c = evolve(c, column=c.column - np.where(left, left_base, right_base), row=c.row - c.row.min(axis=1, keepdims=True))
    key = np.where(left, 0, far) + c.column * (1 << 20) + c.row
    return with_pegs_in(c, np.argsort(key, axis=1, kind="stable"))


def same_holes_first(c: Candidates) -> IntArray:
    """Order (N,) by type, holes and orientation."""
    keys = [c.theta, *(c.row[:, k] for k in range(3, -1, -1)), *(c.column[:, k] for k in range(3, -1, -1)), c.kind]
    return np.lexsort(keys)


def listed_once(c: Candidates) -> Candidates:
    """Sort by type, holes, orientation and place, and drop repetitions: same holes, same pose.

    A contact exactly at a tangent joint is found on both faces that meet there. Two fixtures with the same holes and the
    same orientation may still differ in where the workpiece lies; one number that mixes all that tells them apart.
    """
    if len(c.kind) == 0:
        return c
    c = c.take(same_holes_first(c))
    holes = np.concatenate([c.kind[:, None], c.column, c.row], axis=1)
    fresh = np.ones(len(holes), np.bool_)
    fresh[1:] = (holes[1:] != holes[:-1]).any(axis=1) | (np.diff(c.theta) > SAME_POSE)
    group = np.cumsum(fresh)
    place = c.point[:, 0] @ np.array([1.0, 0.7548776662]) + 0.5698402910 * c.opening
    order = np.lexsort([place, group])
    new = np.ones(len(order), np.bool_)
    new[1:] = (group[order][1:] != group[order][:-1]) | (np.diff(place[order]) >= SAME_PLACE)
    # Of the same fixture on several faces, the one on the lowest is kept, whatever rounding makes of its place.
    run = np.empty(len(order), np.int64)
    run[order] = np.cumsum(new)
    order = np.lexsort([*(c.feature[:, k] for k in range(3, -1, -1)), run])
    return c.take(order[np.concatenate([[True], np.diff(run[order]) > 0])])


def twins(c: Candidates, face: IntArray) -> tuple[IntArray, IntArray]:
    """Split fixtures with the same faces, holes and orientation that differ only in where the workpiece lies.

    Returns
    -------
    (the one of each set with the best closure margin, the others), as indices; both in an order by type, holes,
    orientation and faces.
    """
    if len(c.kind) == 0:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    order = same_holes_first(c)
    label = np.concatenate([c.kind[:, None], c.column, c.row], axis=1)[order]
    fresh = np.ones(len(order), np.bool_)
    fresh[1:] = (label[1:] != label[:-1]).any(axis=1) | (np.diff(c.theta[order]) > SAME_POSE)
    group = np.empty(len(order), np.int64)
    group[order] = np.cumsum(fresh)
    margin = -np.round(c.null.min(axis=1), 9)
    order = np.lexsort([c.point[:, 0, 1], c.point[:, 0, 0], margin, *(face[:, k] for k in range(3, -1, -1)), group])
    label = np.concatenate([group[:, None], face], axis=1)[order]
    other = np.zeros(len(order), np.bool_)
    other[1:] = (label[1:] == label[:-1]).all(axis=1)
    return order[~other], order[other]


def finish(records: list[Array], problem: Problem) -> tuple[Candidates, Account]:
    """Polish, decide, bring to the listed form and list once.

    Parameters
    ----------
    records : (N, 19) arrays from the kernels.

    Returns
    -------
    (the fixtures, an account of all records)
    """
    parts: list[Candidates] = []
    accounts: list[Account] = []
    for block in merged_blocks(records) or [np.zeros((0, record.RECORD_LENGTH))]:
        for k in range(0, max(len(block), 1), BLOCK):
            proven, account = decided(block[k : k + BLOCK], problem)
            parts.append(standing(candidates_of(proven, problem)))
            accounts.append(account)
    everything = joined(parts)
    vise = problem.vise
    if vise.rows is not None:
        everything = everything.take(everything.row.max(axis=1, initial=0) < vise.rows)
    return listed_once(everything.take(placement(everything, vise)[3])), Account.together(accounts)


def merged_blocks(records: list[Array]) -> list[Array]:
    """Small arrays of records put together, for fewer and larger steps of array arithmetic."""
    blocks: list[Array] = []
    waiting: list[Array] = []
    for array in records:
        waiting.append(array)
        if sum(map(len, waiting)) >= BLOCK:
            blocks.append(np.concatenate(waiting))
            waiting = []
    return blocks + ([np.concatenate(waiting)] if waiting and sum(map(len, waiting)) else [])


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
