"""Fixtures of a part that lies flush on a wall, with a locator and a clamp: each once, in the holes of the
plate.

Rows count from the wall, so no clamp is bolted below row 0.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import SAME_PLACE
from workhold.geometry.symmetry import rotate_vectors
from workhold.listing.canonical_form import RowArrays
from workhold.listing.clamp_placement import ClampPlacement, find_axis, find_last_holes, is_bolted
from workhold.model.fixture_table import FixtureTable, make_unknown_quality

__all__ = ["WallFixtures", "find_lowest_of_each", "place_on_wall", "turn_points", "make_wall_table"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@define(frozen=True, eq=False)
class WallFixtures(RowArrays):
    """N pairs of locator and clamp that press the part against the wall.

    Places are in the wall's frame, in mm: u along the hull edge from its start, v up from it.

    Parameters
    ----------
    edge : (N,) number of the hull edge that lies on the wall.
    row : (N,) row of the locator.
    line : (N,) row of the clamp or, if it moves along a column, its column counted from the locator's.
    locator, tip : (N, 2) centres of the locator and of the clamp's tip.
    feature : (N, 2) indices of the features touched by locator and clamp.
    null : (N, 4) null vectors: forces of the wall's two ends, locator and clamp, up to a common factor.
    push : (N,) force of the clamp along its line, divided by the force at its face.
    doubt : (N,) error bounds of the entries of ``null``; 0 unless there are two clamps.
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
    def make_zero_doubt(self) -> Array:
        """Return zeros (N,), for no doubt."""
        return np.zeros(len(self.edge))

    def list_each_once(self) -> WallFixtures:
        """Return the fixtures without repetitions.

        A contact at a tangent joint is found on both features that meet there; the lower one is kept.
        """
        place = self.locator[:, 0] + self.tip @ np.array([0.7548776662, 0.5698402910])
        return self.take(find_lowest_of_each((self.edge, self.row, self.line), place, self.feature))

    def make_clamp_placement(self, problem: Problem) -> ClampPlacement:
        """Return the data for placing the clamps of the fixtures; columns count from the locator's."""
        plate, clamp, flush = problem.toolkit.carriers[0], problem.toolkit.moving, problem.workpiece.flush
        assert clamp.travel is not None
        columns, rows = find_last_holes(plate)
        axis, theta, count = find_axis(clamp), flush.theta[self.edge], len(self)
        on_line = (np.abs(self.line) <= columns) if axis else (self.line <= rows)
        return ClampPlacement(
            clamp,
            axis,
            back=int(clamp.travel.unit[axis]),
            tip=self.tip,
            locators=self.locator[:, None],
            place=self.tip[:, 1] - plate.offset[1] if axis else self.tip[:, 0] - self.locator[:, 0],
            pitch=plate.pitch[axis],
            first=np.full(count, 0.0 if axis else -columns),
            last=np.full(count, rows if axis else columns),
            fits=on_line & (self.row <= rows),
            seen=flush.ends[self.edge, 0]
            - np.array(problem.workpiece.center)
            + turn_points(self.tip, -theta),
            theta=theta,
        )


def find_lowest_of_each(columns: Sequence[IntArray], place: Array, feature: IntArray) -> IntArray:
    """Return the index of one fixture of each set whose members agree in integers and place.

    The member with the lowest features is kept.

    Parameters
    ----------
    columns : arrays (N,) of integers that agree within a set.
    place : (N,) one number in mm that mixes all places, as in ``canonical_form.number_places``.
    feature : (N, 2) indices of the features touched.
    """
    order = np.lexsort([place, *columns[::-1]])
    new = np.ones(len(order), np.bool_)
    new[1:] = np.diff(place[order]) > SAME_PLACE
    new[1:] |= np.any([np.diff(values[order]) != 0 for values in columns], axis=0)
    run = np.cumsum(new)
    best = np.lexsort([feature[order, 1], feature[order, 0], run])
    return np.asarray(order[best[np.diff(run[best], prepend=0) > 0]])


def turn_points(points: Array, angle: Array) -> Array:
    """Return the points (N, 2) turned about the origin by angles (N,) in radians, counter-clockwise."""
    return np.stack(rotate_vectors(points[:, 0], points[:, 1], angle), axis=1)


def make_wall_table(found: WallFixtures, hole: IntArray, problem: Problem) -> FixtureTable:
    """Return the table of fixtures whose clamps are bolted in holes ``hole`` (N,) of their lines.

    Of the figures of quality only the closure margin is known, the others are NaN.
    """
    clamp, flush, count = problem.toolkit.moving, problem.workpiece.flush, len(found)
    column, row = np.zeros((count, 4), np.int32), np.zeros((count, 4), np.int32)
    row[:, 0] = found.row
    column[:, 3], row[:, 3] = (found.line, hole) if find_axis(clamp) else (hole, found.line)
    # The lowest column is 0; where the clamp has no hole, its place is counted from there.
    column[:, [0, 3]] -= np.minimum(column[:, [0]], column[:, [3]])
    if find_axis(clamp) == 0 and not is_bolted(clamp):
        column[:, 3] = 0
    across = column[:, 0] * clamp.pitch[0] - found.locator[:, 0]
    theta = flush.theta[found.edge]
    position = np.stack([across, np.zeros(count)], axis=1) - turn_points(flush.ends[found.edge, 0], theta)
    x, y = clamp.compute_hole_center(column[:, 3], row[:, 3])
    unit = clamp.travel.unit if clamp.travel is not None else (0.0, 0.0)
    # The locator is listed before the ends of the wall, the clamp after them.
    null = found.null[:, [2, 0, 1, 3]]
    share = null / null.sum(axis=1, keepdims=True)
    touched = problem.faces[found.feature]
    face = np.concatenate([touched[:, :1], flush.face[found.edge], touched[:, 1:]], axis=1)
    return FixtureTable(
        arrangement=np.zeros(count, np.int8),
        column=column,
        row=row,
        face=face.astype(np.int32),
        theta=theta,
        position=position,
        jaw_separation=(found.tip[:, 0] + across - x) * unit[0] + (found.tip[:, 1] - y) * unit[1],
        force=share / (share[:, 3] * found.push)[:, None],
        quality=make_unknown_quality(share.min(axis=1, initial=1.0)),
    )


def place_on_wall(found: WallFixtures, problem: Problem) -> FixtureTable:
    """Return the table of the fixtures whose clamps have a place, each fixture once."""
    found = found.list_each_once()
    hole, fits = found.make_clamp_placement(problem).find_nearest_holes(problem)
    return make_wall_table(found.take(fits), hole[fits], problem)
