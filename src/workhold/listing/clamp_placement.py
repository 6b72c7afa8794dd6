"""The hole in which a clamp is bolted: a hole of its line, behind its tip.

A clamp slides along a line of the plate's holes. A clamp with a longest travel is bolted in the nearest hole
behind its tip for which its body, a capsule from the hole to the tip, is clear of locators and part. A clamp
without a longest travel is treated as its tip alone, without a hole.

The body for a farther hole contains the body for a nearer one. So if a program's tool comes too near to the
body for the nearest hole that the other rules allow, it does so for all holes.
"""

from __future__ import annotations

from math import inf

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import BODY_SLACK, GAP_SLACK
from workhold.fixels.contacts import DIRECTIONS
from workhold.fixels.toolkit import Carrier, Toolkit, Travel
from workhold.geometry.symmetry import rotate_vectors
from workhold.kernels.base.distance import write_piece_distances

__all__ = [
    "DIRECTION_NAMES",
    "FAR",
    "OPENING",
    "ClampPlacement",
    "find_axis",
    "find_direction_number",
    "is_bolted",
    "is_along_columns",
    "find_last_holes",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# A hole number larger than any.
FAR = 1 << 30
# Names of directions in the order in which clamps are listed, and unit vectors along which the travel of each
# is counted.
DIRECTION_NAMES = tuple(DIRECTIONS)
OPENING = np.array([Travel(angle, 0.0, None).unit for angle in DIRECTIONS.values()])


def find_direction_number(toolkit: Toolkit) -> int:
    """Return the index in :data:`DIRECTION_NAMES` of a toolkit's
    direction; the toolkit must have a single one.
    """
    return DIRECTION_NAMES.index(toolkit.arrangements[0].direction or "")


def is_along_columns(direction: IntArray) -> BoolArray:
    """Return a mask: True for directions along columns (y), given by
    their index in :data:`DIRECTION_NAMES`.
    """
    return np.asarray(direction >= DIRECTION_NAMES.index("-y"))


def find_axis(carrier: Carrier) -> int:
    """Return the axis along which a carrier slides: 0 for x, 1 for y; 0 if it stands still."""
    return 0 if carrier.travel is None or carrier.travel.unit[0] != 0.0 else 1


def is_bolted(clamp: Carrier) -> bool:
    """Return whether a clamp is bolted in a hole; a clamp without a longest travel is its tip alone."""
    return clamp.travel is not None and clamp.travel.most is not None


def find_last_holes(plate: Carrier) -> tuple[float, float]:
    """Return (last column, last row) of a plate, counted from 0; inf where the plate has no end."""
    columns, rows = (inf if count is None else count - 1.0 for count in (plate.columns, plate.rows))
    return columns, rows


@frozen(eq=False)
class ClampPlacement:
    """The clamps of N fixtures, in a frame with axes along the rows and columns of holes; lengths in mm.

    Parameters
    ----------
    clamp : the carrier that slides, with its radius and its travel.
    axis : 0 where the clamp slides along x, 1 where along y.
    back : 1 where the clamp opens toward larger coordinates, -1 where toward smaller ones.
    tip : (N, 2) centres of the clamps' tips.
    locators : (N, K, 2) centres of the K locators.
    place : (N,) coordinate of the tip along its line, from hole 0.
    pitch : distance of holes along the lines.
    first, last : (N,) the lowest and the highest hole of the plate on the line.
    fits : (N,) whether the plate has the locators' holes and the clamp's line.
    seen : (N, 2) centres of the tips in the part's frame, relative to the part's centre.
    theta : (N,) orientations of the part in radians.
    """

    clamp: Carrier
    axis: int
    back: int
    tip: Array
    locators: Array
    place: Array
    pitch: float
    first: Array
    last: Array
    fits: BoolArray
    seen: Array
    theta: Array

    def find_nearest_holes(self, problem: Problem) -> tuple[IntArray, BoolArray]:
        """Return (the nearest permitted hole on each clamp's line, whether there is one), (N,) each.

        The hole is 0 for a clamp without longest travel, and where none is permitted.
        """
        index, number = self.choose_holes(problem, every=False)
        hole, fits = np.zeros(len(self.tip), np.int64), np.zeros(len(self.tip), np.bool_)
        hole[index], fits[index] = number, True
        return hole, fits

    def choose_holes(self, problem: Problem, every: bool) -> tuple[IntArray, IntArray]:
        """Return the holes in which clamps may be bolted.

        Parameters
        ----------
        every : True for all permitted holes of each clamp, nearest first; False for the nearest alone.

        Returns
        -------
        (indices (M,) of fixtures, ascending; numbers (M,) of holes on their lines, 0 for a clamp without
        longest travel)
        """
        travel, waiting = self.clamp.travel, np.flatnonzero(self.fits)
        assert travel is not None
        if travel.most is None:
            waiting = waiting[self.is_clear(waiting, np.zeros(len(waiting)), problem)]
            return waiting, np.zeros(len(waiting), np.int64)
        # Travel grows as a clamp opens, so from its hole to its tip it is below zero.
        nearest = np.ceil((self.back * self.place - travel.most - GAP_SLACK) / self.pitch).astype(np.int64)
        found = [np.zeros((2, 0), np.int64)]
        for step in range(int((travel.most - travel.least) / self.pitch) + 2):
            number = (nearest[waiting] + step) * self.back
            stroke = self.back * (number * self.pitch - self.place[waiting])
            there = (self.first[waiting] <= number) & (number <= self.last[waiting])
            near = np.flatnonzero(there & (stroke <= -travel.least + GAP_SLACK))
            chosen = waiting[near]
            good = self.is_clear(chosen, stroke[near], problem)
            found.append(np.stack([chosen[good], number[near][good]]))
            waiting = waiting if every else np.delete(waiting, near[good])
        index, numbers = np.concatenate(found, axis=1)
        order = np.argsort(index, kind="stable")
        return index[order], numbers[order]

    def is_clear(self, index: IntArray, stroke: Array, problem: Problem) -> BoolArray:
        """Return a mask (M,): True for clamps whose bodies are clear of
        locators, part, and the program's tools.

        The body extends from the tip to the hole. ``index`` (M,) selects fixtures, ``stroke`` (M,) is the
        distance in mm from tip to hole.
        """
        radius, behind = self.clamp.peg_radius, np.zeros((len(index), 2))
        behind[:, self.axis] = self.back * stroke
        one, other = self.tip[index], self.tip[index] + behind
        low, high = (ends[:, None] for ends in (np.minimum(one, other), np.maximum(one, other)))
        beside = self.locators[index] - np.clip(self.locators[index], low, high)
        least = problem.frame.standing.peg_radius + radius - GAP_SLACK
        clear = np.asarray((np.hypot(beside[..., 0], beside[..., 1]) >= least).all(axis=1))
        chosen = np.flatnonzero(clear & (stroke > 0.0))
        if len(chosen):
            starts = self.seen[index[chosen]]
            x, y = behind[chosen].T
            ends = starts + np.stack(rotate_vectors(x, y, -self.theta[index[chosen]]), axis=1)
            distances = np.empty(len(chosen))
            write_piece_distances(starts, ends, problem.outlines[1], distances)
            clear[chosen] = distances >= radius - BODY_SLACK
            passing = problem.find_swept_spans(self.clamp)
            if passing is not None:
                swept, clearance = passing
                reach, _ = swept.find_nearest_spans(
                    starts + problem.workpiece.center, ends + problem.workpiece.center
                )
                clear[chosen] &= reach >= clearance + radius - GAP_SLACK
        return clear
