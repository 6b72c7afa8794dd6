"""The cage of a fixture by flooding a grid of orientations and heights, from the outline alone.

At one orientation and height the places of a part along the way of what moves, off the pegs that stand still and off those
that move, are intervals. A cell of the grid is a pair of them; two beside each other are joined where some place and opening
below the largest are in both.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from math import atan2, ceil, cos, inf, sin, sqrt

import numpy as np
from attrs import define
from numpy.typing import NDArray

from seating_examples import Obstacle
from workhold import Fixture, Workpiece
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Line

Array = NDArray[np.float64]
Interval = tuple[float, float]
Cell = tuple[int, int, Interval, Interval]
# Straight pieces that stand for an arc: they lie less than this part of the opening off it.
CHORD_ERROR = 3e-3


@define(slots=False)
class Flood:
    """A grid about a fixture's pose.

    Parameters
    ----------
    part, fixture, toolkit : what is held where.
    opening : below which what moves stays, in mm from the fixture's pose.
    inside : (N, 4) where it begins, of turn, shifts along the way and across it, and opening: a cage may begin in its seat
        as a cone that no cell is in.
    steps, lean : of the grid in radians and mm, and by how many mm per radian its rows rise with the orientation.
    rows : how many there are above the pose's, and below it.
    """

    part: Workpiece
    fixture: Fixture
    toolkit: Toolkit
    opening: float
    inside: Array
    steps: tuple[float, float]
    lean: float = 0.0
    rows: int = 150

    @cached_property
    def obstacle(self) -> Obstacle:
        """Pegs and part in the toolkit's frame."""
        return Obstacle.about(self.part, self.fixture, self.toolkit)

    @cached_property
    def way(self) -> Array:
        """Along which what moves opens."""
        moving = np.abs(self.obstacle.ways).sum(axis=1) > 0.0
        return np.asarray(self.obstacle.clamping * self.obstacle.ways[moving][0])

    def turned(self, points: Array) -> Array:
        """Points (..., 2) in a frame of which the first axis is the way."""
        along, across = self.way
        return points @ np.array([[along, -across], [across, along]])

    def chords(self, arc: Arc) -> int:
        """How many straight pieces stand for an arc."""
        return ceil(arc.half_sweep * sqrt(arc.radius / (2.0 * CHORD_ERROR * self.opening)))

    @cached_property
    def outline(self) -> tuple[Array, Array]:
        """Ends (M, 2) of straight pieces about the middle of the part's box."""
        starts, ends = [], []
        for face in self.obstacle.faces:
            half, count = (
                (face.half_extent, 1) if isinstance(face, Line) else (face.half_sweep, self.chords(face))
            )
            points = np.array([face.compute_point(t) for t in np.linspace(-half, half, count + 1)])
            starts.append(points[:-1] - self.obstacle.center)
            ends.append(points[1:] - self.obstacle.center)
        return np.vstack(starts), np.vstack(ends)

    @cached_property
    def start(self) -> Array:
        """The pose in the frame of the way: theta, along, across."""
        theta, x, y, _ = self.obstacle.start(self.fixture)
        return np.array([theta - atan2(self.way[1], self.way[0]), *self.turned(np.array([x, y]))])

    def blocked(self, theta: float, levels: Array, radius: float) -> tuple[Array, Array]:
        """Ends (N, K) of what a peg on levels (N,) of the turned part may not be in, along it; empty ones are reversed."""
        turn = np.array([[cos(theta), sin(theta)], [-sin(theta), cos(theta)]])
        a, b = (points @ turn for points in self.outline)
        way = (b - a) / np.hypot(*(b - a).T)[:, None]
        up = levels[:, None]
        low, high = np.full((2, len(levels), len(a)), inf)
        high = -high
        with np.errstate(invalid="ignore", divide="ignore"):
            for end in (a, b):
                half = np.sqrt(radius**2 - (up - end[:, 1]) ** 2)
                low = np.fmin(low, end[:, 0] - half)
                high = np.fmax(high, end[:, 0] + half)
            for side in (radius, -radius):
                share = (up - a[:, 1] - side * way[:, 0]) / (b - a)[:, 1]
                at = a[:, 0] - side * way[:, 1] + share * (b - a)[:, 0]
                at = np.where((share >= 0.0) & (share <= 1.0), at, np.nan)
                low, high = np.fmin(low, at), np.fmax(high, at)
            share = (up - a[:, 1]) / (b - a)[:, 1]
            crossed = np.where((a[:, 1] <= up) != (b[:, 1] <= up), a[:, 0] + share * (b - a)[:, 0], inf)
        crossed = np.sort(crossed, axis=1)[:, : 2 * (len(a) // 2)]
        inner_low, inner_high = crossed[:, ::2], np.where(crossed[:, 1::2] < inf, crossed[:, 1::2], -inf)
        return np.hstack([low, inner_low]), np.hstack([high, inner_high])

    def gaps(self, theta: float, heights: Array, moving: bool) -> list[list[Interval]]:
        """The places along the way that are free of the pegs that move, or of the others, at each height (N,)."""
        lows, highs = [], []
        pegs = self.turned(self.obstacle.pegs + self.obstacle.ways * self.fixture.travel)
        for peg, way, radius in zip(pegs, self.obstacle.ways, self.obstacle.radii, strict=True):
            if bool(np.abs(way).sum() > 0.0) == moving:
                low, high = self.blocked(theta, peg[1] - heights, radius)
                lows.append(peg[0] - high)
                highs.append(peg[0] - low)
        if self.obstacle.has_wall and not moving:
            self.block_by_wall(theta, heights, lows, highs)
        low, high = np.hstack(lows), np.hstack(highs)
        order = np.argsort(np.where(low < high, low, inf), axis=1)
        low, high = (np.take_along_axis(ends, order, axis=1) for ends in (low, high))
        out = []
        for one, other in zip(low, high, strict=True):
            known = one < other
            begins, so_far = one[known], np.append(-inf, np.maximum.accumulate(other[known]))
            begins = np.append(begins, inf)
            out.append([(float(so_far[k]), float(begins[k])) for k in np.flatnonzero(begins > so_far)])
        return out

    def block_by_wall(self, theta: float, heights: Array, lows: list[Array], highs: list[Array]) -> None:
        """Add what the fence at y = 0 of the toolkit's frame keeps the part from."""
        turn = np.array([[cos(theta), sin(theta)], [-sin(theta), cos(theta)]])
        ux, uy = self.turned(np.array([0.0, 1.0])).round(12).tolist()
        least = -float((self.outline[0] @ turn @ np.array([ux, uy])).min())
        column = np.ones((len(heights), 1))
        if uy != 0.0:
            inside = (uy * heights < least)[:, None]
            lows.append(np.where(inside, -inf, inf))
            highs.append(np.where(inside, inf, -inf))
        else:
            lows.append((-inf if ux > 0.0 else -least) * column)
            highs.append((least if ux > 0.0 else inf) * column)

    def heights(self, number: int) -> Array:
        """Those at an orientation, across the way."""
        rows = np.arange(-self.rows, self.rows + 1)
        return np.asarray(self.start[2] + self.lean * number * self.steps[0] + rows * self.steps[1])

    def row(self, known: dict[int, list[list[Cell]]], number: int) -> list[list[Cell]]:
        """The cells at one orientation, for each height."""
        if number not in known:
            theta = self.start[0] + number * self.steps[0]
            still, moving = (self.gaps(theta, self.heights(number), moves) for moves in (False, True))
            known[number] = [
                [
                    (number, k, one, other)
                    for one in ones
                    for other in others
                    if one[0] - other[1] < self.opening
                ]
                for k, (ones, others) in enumerate(zip(still, moving, strict=True))
            ]
        return known[number]

    def cells_with(
        self, known: dict[int, list[list[Cell]]], turn: float, along: float, up: float, s: float
    ) -> list[Cell]:
        """The cell of a configuration, told from the fixture's."""
        number, x = round(turn / self.steps[0]), self.start[1] + along
        k = self.rows + round((up - self.lean * number * self.steps[0]) / self.steps[1])
        here = self.row(known, number)[k] if 0 <= k <= 2 * self.rows else []
        # It lies off the cell's middle by half a step each way at most.
        off = self.steps[1] + self.steps[0] * float(np.abs(self.outline[0]).max())
        return [
            cell
            for cell in here
            if cell[2][0] - off <= x <= cell[2][1] + off and cell[3][0] - off <= x - s <= cell[3][1] + off
        ]

    def cells(self) -> Iterator[Cell]:
        """What the flood reaches."""
        known: dict[int, list[list[Cell]]] = {}
        first = [cell for off in self.inside for cell in self.cells_with(known, *off)]
        assert first
        seen, waiting = set(first), list(first)
        while waiting:
            cell = waiting.pop()
            yield cell
            number, k, one, other = cell
            assert 0 < k < 2 * self.rows, "the grid is too small"
            for i, j in ((number - 1, k), (number + 1, k), (number, k - 1), (number, k + 1)):
                for beside in self.row(known, i)[j]:
                    if beside not in seen and self.joined(one, other, beside[2], beside[3]):
                        seen.add(beside)
                        waiting.append(beside)

    def joined(self, one: Interval, other: Interval, two: Interval, further: Interval) -> bool:
        """Whether two cells share a place at an opening."""
        low, high = max(one[0], two[0]), min(one[1], two[1])
        least, most = max(other[0], further[0]), min(other[1], further[1])
        return low <= high and least <= most and low - most < self.opening

    @cached_property
    def extents(self) -> Array:
        """Least and largest turn, and shifts along and across the way: (3, 2)."""
        told = np.array(
            [
                (
                    i * self.steps[0],
                    self.heights(i)[k] - self.start[2],
                    one[0],
                    min(one[1], other[1] + self.opening),
                )
                for i, k, one, other in self.cells()
            ]
        )
        lows, highs = told.min(axis=0), told.max(axis=0)
        x = lows[2] - self.start[1], highs[3] - self.start[1]
        return np.array([(lows[0], highs[0]), x, (lows[1], highs[1])])
