"""Placing fixtures of a fence: where the clamp is bolted, and which of them cannot be placed.

As on a plate (``listing.on_plate``) a clamp with a travel is bolted in the nearest hole behind its tip from which its body
clears locator and part, and that is still on the plate; here rows count from the wall, so none lies below row 0.
"""

from __future__ import annotations

from math import inf

import numpy as np
from attrs import define, field, fields
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import BODY_SLACK, GAP_SLACK, SAME_PLACE
from workhold.geometry.rotation import rotated
from workhold.kernels.base.capsule import piece_distances
from workhold.model.result import FixtureTable, unknown_quality

__all__ = ["Pressed", "clear_holes", "listed_on_fence", "listed_once", "listing_order", "turned"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@define(frozen=True, eq=False)
class Pressed:
    """N pairs of locator and clamp that press the part against the wall.

    Places are in the wall's frame, in mm: u along the hull edge from its start, v up from it.

    Parameters
    ----------
    edge : (N,) number of the hull edge that lies on the wall.
    row, line : (N,) row of the locator; row of the clamp, or its column counted from the locator's.
    locator, tip : (N, 2) centres.
    feature : (N, 2) touched by locator and clamp.
    null : (N, 4) null vectors of the wall's two ends, locator and clamp, not scaled.
    push : (N,) part of its force that the clamp passes on along its direction.
    doubt : (N,) by how much entries of the null vector may be off, where that matters: of one of two clamps.
    """

    edge: IntArray
    row: IntArray
    line: IntArray
    locator: Array
    tip: Array
    feature: IntArray
    null: Array
    push: Array
    doubt: Array = field()

    @doubt.default
    def none(self) -> Array:
        """No doubt."""
        return np.zeros(len(self.edge))

    def __len__(self) -> int:
        return len(self.edge)

    def take(self, order: NDArray[np.int64] | BoolArray) -> Pressed:
        """The pairs of an index array or mask, in its order."""
        return Pressed(*(getattr(self, one.name)[order] for one in fields(Pressed)))

    @classmethod
    def joined(cls, parts: list[Pressed]) -> Pressed:
        """All pairs of several, at least one."""
        return cls(*(np.concatenate([getattr(part, one.name) for part in parts]) for one in fields(Pressed)))


def listed_once(pressed: Pressed) -> Pressed:
    """One of the pairs that are the same: a contact at a tangent joint is found on both features that meet there."""
    # One number that mixes all places tells them apart, as in ``canonical_form.listed_once``.
    place = pressed.locator[:, 0] + pressed.tip @ np.array([0.7548776662, 0.5698402910])
    columns = (pressed.edge, pressed.row, pressed.line)
    order = np.lexsort([place, *columns[::-1]])
    new = np.ones(len(order), np.bool_)
    new[1:] = (np.diff(place[order]) > SAME_PLACE) | np.any([np.diff(values[order]) != 0 for values in columns], axis=0)
    run = np.cumsum(new)
    best = np.lexsort([pressed.feature[order, 1], pressed.feature[order, 0], run])
    return pressed.take(order[best[np.diff(run[best], prepend=0) > 0]])


def holes_of(pressed: Pressed, problem: Problem) -> tuple[IntArray, BoolArray]:
    """The clamp's hole (N,), its column from the locator's or its row, 0 without a travel; and whether (N,) everything has a
    place on the plate, clear of the rest."""
    index, number = clear_holes(pressed, problem, every=False)
    hole, fits = np.zeros(len(pressed), np.int64), np.zeros(len(pressed), np.bool_)
    hole[index], fits[index] = number, True
    return hole, fits


def clear_holes(pressed: Pressed, problem: Problem, every: bool) -> tuple[IntArray, IntArray]:
    """Numbers (M,) of pairs and their clamps' holes (M,), as of :func:`holes_of`, the nearest of each first; ``every`` hole
    that will do, or the nearest alone."""
    plate, clamp = problem.toolkit.carriers[0], problem.toolkit.moving
    along_x, travel = clamp.is_along_x, clamp.travel
    assert travel is not None
    columns = inf if plate.columns is None else plate.columns - 1
    rows = inf if plate.rows is None else plate.rows - 1
    on_line = (pressed.line <= rows) if along_x else (np.abs(pressed.line) <= columns)
    waiting = np.flatnonzero(on_line & (pressed.row <= rows))
    if travel.most is None:
        waiting = waiting[is_clear(pressed.take(waiting), pressed.tip[waiting], problem)]
        return waiting, np.zeros(len(waiting), np.int64)
    pitch, axis = plate.pitch[0 if along_x else 1], 0 if along_x else 1
    back = travel.unit[axis]
    # Place of the tip along the clamp's line, from the locator's column or from row 0.
    tip = pressed.tip[:, 0] - pressed.locator[:, 0] if along_x else pressed.tip[:, 1] - plate.offset[1]
    first = np.ceil((back * tip - travel.most - GAP_SLACK) / pitch).astype(np.int64)
    found = [np.zeros((2, 0), np.int64)]
    for step in range(int((travel.most - travel.least) / pitch) + 2):
        number = (first[waiting] + step) * int(back)
        stroke = back * (number * pitch - tip[waiting])
        on_plate = np.abs(number) <= columns if along_x else (number >= 0) & (number <= rows)
        near = np.flatnonzero(on_plate & (stroke <= -travel.least + GAP_SLACK))
        chosen = waiting[near]
        ends = pressed.tip[chosen].copy()
        ends[:, axis] += back * stroke[near]
        good = is_clear(pressed.take(chosen), ends, problem)
        found.append(np.stack([chosen[good], number[near][good]]))
        waiting = waiting if every else np.setdiff1d(waiting, chosen[good], assume_unique=True)
    index, numbers = np.concatenate(found, axis=1)
    order = np.argsort(index, kind="stable")
    return index[order], numbers[order].astype(np.int64)


def turned(points: Array, angle: Array) -> Array:
    """Points (N, 2) turned by angles (N,)."""
    return np.stack(rotated(points[:, 0], points[:, 1], angle), axis=1)


def is_clear(pressed: Pressed, back: Array, problem: Problem) -> BoolArray:
    """Which clamps (N,), from their tips to a place (N, 2) behind them, clear the locator and the part."""
    plate, clamp = problem.toolkit.carriers[0], problem.toolkit.moving
    low, high = np.minimum(pressed.tip, back), np.maximum(pressed.tip, back)
    beyond = pressed.locator - np.clip(pressed.locator, low, high)
    clear = np.asarray(np.hypot(*beyond.T) >= plate.peg_radius + clamp.peg_radius - GAP_SLACK)
    chosen = np.flatnonzero(clear & (back != pressed.tip).any(axis=1))
    if len(chosen):
        flush = problem.workpiece.flush
        theta = flush.theta[pressed.edge[chosen]]
        start = flush.ends[pressed.edge[chosen], 0] - np.array(problem.workpiece.center)
        one, other = (start + turned(points[chosen], -theta) for points in (pressed.tip, back))
        distances = np.empty(len(chosen))
        piece_distances(one, other, problem.outline, distances)
        clear[chosen] = distances >= clamp.peg_radius - BODY_SLACK
    return clear


def listed_on_fence(pressed: Pressed, problem: Problem) -> tuple[FixtureTable, Pressed]:
    """The pairs that have a place, each once, as holes of the toolkit, and as they are; of their quality only the closure
    margin is known yet."""
    pressed = listed_once(pressed)
    hole, fits = holes_of(pressed, problem)
    pressed = pressed.take(fits)
    return written_out(pressed, hole[fits], problem), pressed


def listing_order(table: FixtureTable) -> IntArray:
    """The order (N,) in which fixtures are listed that are equally good: of directions, holes, orientations and faces."""
    words = [table.arrangement, *table.column.T, *table.row.T, table.theta, *table.face.T]
    return np.lexsort(words[::-1]).astype(np.int64)


def written_out(pressed: Pressed, hole: IntArray, problem: Problem) -> FixtureTable:
    """The table of pairs whose clamps are in these holes (N,)."""
    clamp, flush, count = problem.toolkit.moving, problem.workpiece.flush, len(pressed)
    pitch_x = clamp.pitch[0]
    column, row = np.zeros((count, 4), np.int32), np.zeros((count, 4), np.int32)
    row[:, 0] = pressed.row
    column[:, 3], row[:, 3] = (hole, pressed.line) if clamp.is_along_x else (pressed.line, hole)
    # The lowest column is 0; where the clamp has no hole, its place is counted from there.
    column[:, [0, 3]] -= np.minimum(column[:, [0]], column[:, [3]])
    if clamp.is_along_x and not clamp.has_a_hole:
        column[:, 3] = 0
    across = column[:, 0] * pitch_x - pressed.locator[:, 0]
    theta = flush.theta[pressed.edge]
    start = flush.ends[pressed.edge, 0]
    position = np.stack([across, np.zeros(count)], axis=1) - turned(start, theta)
    x, y = clamp.place(column[:, 3], row[:, 3])
    unit = clamp.travel.unit if clamp.travel is not None else (0.0, 0.0)
    travelled = (pressed.tip[:, 0] + across - x) * unit[0] + (pressed.tip[:, 1] - y) * unit[1]
    # The locator is listed before the ends of the wall, the clamp after them.
    null = pressed.null[:, [2, 0, 1, 3]]
    share = null / null.sum(axis=1, keepdims=True)
    touched = problem.faces[pressed.feature]
    face = np.concatenate([touched[:, :1], flush.face[pressed.edge], touched[:, 1:]], axis=1)
    return FixtureTable(
        arrangement=np.zeros(count, np.int8),
        column=column,
        row=row,
        face=face.astype(np.int32),
        theta=theta,
        position=position,
        jaw_separation=travelled,
        force=share / (share[:, 3] * pressed.push)[:, None],
        quality=unknown_quality(share.min(axis=1, initial=1.0)),
    )
