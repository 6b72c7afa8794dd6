"""Placing fixtures of a plate with a clamp: where the clamp is bolted, and which of them cannot be placed.

The clamp slides along a line of the plate's own holes. With a travel it is bolted in a hole of that line behind its tip, in
the nearest one from which its body, a capsule from the hole to the tip, clears locators and part, and that is still on the
plate. Without one it is its tip alone, which then is counted from the locators' first column.
"""

from __future__ import annotations

from math import inf

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.contact.frame import Frame
from workhold.contact.problem import Problem
from workhold.conventions import BODY_SLACK, GAP_SLACK
from workhold.geometry.rotation import rotated
from workhold.kernels.base.capsule import piece_distances
from workhold.listing.canonical_form import Candidates
from workhold.listing.written_out import written_out
from workhold.model.result import FixtureTable

__all__ = ["Bolted", "bolted", "clear_holes", "placed_on_plate"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

LOCATORS = slice(0, 3)
TIP = 3


@define(frozen=True, eq=False)
class Bolted:
    """Where the clamps of N fixtures are bolted, in the frame of the search.

    Parameters
    ----------
    tip : (N,) place in mm of the tip along x, from the locators' first column.
    column : (N,) of the clamp's hole, counted from the locators' first; without a travel 0.
    fits : (N,) whether everything has a place on the plate, clear of the rest.
    """

    tip: Array
    column: IntArray
    fits: BoolArray


def spans(frame: Frame) -> tuple[float, float]:
    """The most columns and rows, in the frame, that holes on the plate may be apart."""
    plate = frame.toolkit.carriers[0]
    counts = (plate.columns, plate.rows)[:: -1 if frame.quarters % 2 else 1]
    columns, rows = (inf if count is None else count - 1.0 for count in counts)
    return columns, rows


def bolted(c: Candidates, problem: Problem) -> Bolted:
    """Find the hole of every fixture's clamp, the nearest that will do."""
    tip, index, hole = clear_holes(c, problem, every=False)
    column, fits = np.zeros(len(tip), np.int64), np.zeros(len(tip), np.bool_)
    column[index], fits[index] = hole, True
    return Bolted(tip, column, fits)


def clear_holes(c: Candidates, problem: Problem, every: bool) -> tuple[Array, IntArray, IntArray]:
    """The holes in which fixtures' clamps may be bolted, the nearest of each first.

    Parameters
    ----------
    every : all of them, or of each fixture the nearest.

    Returns
    -------
    (N,) places in mm of the tips along x from the locators' first column; numbers (M,) of fixtures, and (M,) the columns of
    their holes counted from that one, 0 where a clamp is its tip alone
    """
    frame = problem.frame
    pitch, travel = frame.lattice.pitch_x, frame.moving.travel
    assert travel is not None
    most_columns, most_rows = spans(frame)
    last = c.column[:, LOCATORS].max(axis=1, initial=0)
    tip = last * pitch + c.gap
    waiting = np.flatnonzero((c.row.max(axis=1, initial=0) <= most_rows) & (last <= most_columns))
    if travel.most is None:
        waiting = waiting[is_clear(c, waiting, tip[waiting], tip[waiting], problem)]
        return tip, waiting, np.zeros(len(waiting), np.int64)
    least, most = -travel.most, -travel.least
    first = np.ceil((tip + least - GAP_SLACK) / pitch).astype(np.int64)
    found = [np.zeros((2, 0), np.int64)]
    for step in range(int((most - least) / pitch) + 2):
        hole = first[waiting] + step
        on_plate = np.maximum(hole, last[waiting]) - np.minimum(hole, 0) <= most_columns
        near = np.flatnonzero(on_plate & (hole * pitch - tip[waiting] <= most + GAP_SLACK))
        chosen = waiting[near]
        good = is_clear(c, chosen, tip[chosen], hole[near] * pitch, problem)
        found.append(np.stack([chosen[good], hole[near][good]]))
        waiting = waiting if every else np.setdiff1d(waiting, chosen[good], assume_unique=True)
    index, column = np.concatenate(found, axis=1)
    order = np.argsort(index, kind="stable")
    return tip, index[order], column[order]


def is_clear(c: Candidates, index: IntArray, tip: Array, hole: Array, problem: Problem) -> BoolArray:
    """Which clamps of the fixtures of an index (N,), from tip to hole along x in mm (N,) in the frame, clear the locators
    and the part."""
    frame = problem.frame
    pitch, radius = frame.lattice[:2], frame.moving.peg_radius
    x, row = c.column[index, LOCATORS] * pitch[0], c.row[index]
    beyond = x - np.clip(x, tip[:, None], hole[:, None])
    apart = np.hypot(beyond, (row[:, LOCATORS] - row[:, TIP:]) * pitch[1])
    clear = np.asarray((apart >= frame.standing.peg_radius + radius - GAP_SLACK).all(axis=1))
    chosen = np.flatnonzero(clear & (hole > tip))
    if len(chosen):
        starts, length = c.point[index[chosen], TIP], (hole - tip)[chosen]
        ends = starts + np.stack(rotated(length, np.zeros(len(length)), -c.theta[index[chosen]]), axis=1)
        distances = np.empty(len(chosen))
        piece_distances(starts, ends, problem.outline, distances)
        clear[chosen] = distances >= radius - BODY_SLACK
    return clear


def placed_on_plate(c: Candidates, problem: Problem) -> FixtureTable:
    """Write candidates that fit out as holes of the plate; of their quality only the closure margin is known yet."""
    frame, found = problem.frame, bolted(c, problem)
    column = np.concatenate([c.column[:, LOCATORS], found.column[:, None]], axis=1)
    column, row = lowest_zero(*frame.step_back(column, c.row))
    travelled = found.tip - found.column * frame.lattice.pitch_x
    clamp = frame.toolkit.moving
    if not clamp.has_a_hole:
        # The tip is counted from the first column, or row, of the plate.
        across, along = frame.toolkit.moving_axis
        x, y = clamp.place(column[:, TIP], row[:, TIP])
        travelled += x * across + y * along
        (column if clamp.is_along_x else row)[:, TIP] = 0
    return written_out(c, problem, column, row, travelled)


def lowest_zero(column: IntArray, row: IntArray) -> tuple[IntArray, IntArray]:
    """Columns and rows (N, 4) counted from the lowest of each."""
    column, row = (numbers - numbers.min(axis=1, keepdims=True, initial=1 << 30) for numbers in (column, row))
    return column, row
