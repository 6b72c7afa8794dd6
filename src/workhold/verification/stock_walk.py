"""Check that a program's forces act exactly on those stretches of its moves where its tools meet the stock.

A file states the stretches. The tool's disc must meet the stock all along each of them, and nowhere else.
Moves are cut into pieces, and for each piece bounds of the distance from the stock's border are computed. A
piece lies within its sagitta of its chord. Its distance from a straight edge of the border is at most that of
the chord's ends and at least that of the chord. Its distance from an arc of the border is that of the piece's
middle, plus or minus half the piece's length. Pieces that the bounds do not decide are halved, until all
undecided pieces are within ``OFF`` of touching.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf, pi

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.model.program import Program
from workhold.model.query import Query
from workhold.verification.tool_walk import (
    ToolWalk,
    are_crossing,
    make_walk,
    measure_pieces_to_point,
    measure_points_to_piece,
)

__all__ = ["find_stock_faults"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Mask = NDArray[np.bool_]
# mm. By so much a stretch may be longer or shorter than it is.
OFF = 1e-3
MOST_HALVINGS = 60
AT_ONCE = 1 << 12


@frozen(eq=False)
class BorderEdge:
    """An edge of the border that is offset to the stock: a line (bulge 0) or an arc with centre and
    radius.
    """

    start: Array
    end: Array
    bulge: float
    center: Array
    radius: float

    @classmethod
    def from_ends(cls, start: Array, end: Array, bulge: float) -> BorderEdge:
        """Return the edge from start (2,) to end (2,); ``bulge`` is the
        tangent of a quarter of an arc's angle.
        """
        (x, y), half = end - start, 2.0 * np.arctan(bulge)
        if bulge == 0.0:
            return cls(start, end, bulge, start, 0.0)
        # The apothem, on the left of the chord, over half the chord is the cotangent of half the sweep.
        center = (start + end) / 2 + np.array([-y, x]) / (2.0 * np.tan(half))
        return cls(start, end, bulge, center, float(np.hypot(*(start - center))))

    def measure_distance(self, points: Array) -> Array:
        """Return the distances (N,) in mm of points (N, 2) from the edge."""
        if self.bulge == 0.0:
            return measure_points_to_piece(points, self.start, self.end)
        way = np.angle(np.exp(1j * self.measure_angle(points)))
        on_rim = np.abs(np.hypot(*(points - self.center).T) - self.radius)
        ends = np.minimum(np.hypot(*(points - self.start).T), np.hypot(*(points - self.end).T))
        return np.asarray(np.where(np.abs(way) <= 2.0 * np.arctan(abs(self.bulge)), on_rim, ends))

    def measure_angle(self, points: Array) -> Array:
        """Return the angles (N,) in radians, seen from the arc's centre, of points (N, 2) from the middle of
        the arc.

        They are not wrapped to one turn.
        """
        chord = self.end - self.start
        # The middle of the arc is on the right of its chord where it runs counter-clockwise.
        right = np.array([chord[1], -chord[0]]) * np.sign(self.bulge)
        arm = points - self.center
        return np.asarray(np.arctan2(arm[:, 1], arm[:, 0]) - np.arctan2(right[1], right[0]))

    def measure_turns(self, points: Array) -> Array:
        """Return the angle (N,) in radians by which the edge turns around each of the points (N, 2)."""
        one, other = self.start - points, self.end - points
        cross = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0] + 0.0
        angle = np.arctan2(cross, (one * other).sum(axis=1))
        if self.bulge == 0.0:
            return np.asarray(angle)
        beyond = cross < 0.0 if self.bulge > 0.0 else cross >= 0.0
        between = beyond & (np.hypot(*(points - self.center).T) < self.radius)
        return np.asarray(angle + 2 * pi * np.sign(self.bulge) * between)


@frozen(eq=False)
class StockGround:
    """The outline whose offset is the stock: its loops, edge by edge."""

    loops: tuple[tuple[BorderEdge, ...], ...]

    @classmethod
    def from_loops(cls, loops: Sequence[Array], is_block: bool) -> StockGround:
        """Return the outline of outer loops (N, 3) with rows x, y, bulge; with ``is_block`` their bounding
        box instead.
        """
        found = []
        for loop in loops:
            ends = np.roll(loop[:, :2], -1, axis=0)
            rows = zip(loop[:, :2], ends, loop[:, 2].tolist(), strict=True)
            found.append(tuple(BorderEdge.from_ends(*row) for row in rows))
        if not is_block:
            return cls(tuple(found))
        edges = [edge for loop in found for edge in loop]
        points = [np.array([edge.start for edge in edges])]
        for edge in edges:
            if edge.bulge:
                far = edge.center + edge.radius * np.array([(1, 0), (0, 1), (-1, 0), (0, -1)])
                points.append(far[edge.measure_distance(far) <= 1e-9 * edge.radius])
        (x0, y0), (x1, y1) = np.concatenate(points).min(axis=0), np.concatenate(points).max(axis=0)
        return cls.from_loops([np.array([[x0, y0, 0], [x1, y0, 0], [x1, y1, 0], [x0, y1, 0.0]])], False)

    def contains(self, points: Array) -> Mask:
        """Return (N,) whether points (N, 2) lie within a loop."""
        each = [np.abs(sum(edge.measure_turns(points) for edge in loop)) > pi for loop in self.loops]
        return np.asarray(np.logical_or.reduce(each))

    def bound_distances(
        self, one: Array, other: Array, middle: Array, half: Array, sagitta: Array
    ) -> tuple[Array, Array]:
        """Return (lower, upper) bounds (N,) in mm of the distance from the border of every point of each of N
        path pieces.

        Parameters
        ----------
        one, other, middle : (N, 2) both ends and the middle of each piece.
        half, sagitta : (N,) half the length of each piece, and its largest distance from its chord.
        """
        low, high = np.full(len(half), inf), np.full(len(half), inf)
        for loop in self.loops:
            for edge in loop:
                if edge.bulge:
                    away = edge.measure_distance(middle)
                    near, far = away - half, away + half
                else:
                    ends = [edge.measure_distance(one), edge.measure_distance(other)]
                    others = [
                        measure_pieces_to_point(one, other, edge.start),
                        measure_pieces_to_point(one, other, edge.end),
                    ]
                    apart = np.minimum.reduce(ends + others)
                    near = np.where(are_crossing(one, other, edge.start, edge.end), 0.0, apart) - sagitta
                    far = np.maximum(*ends) + sagitta
                low, high = np.minimum(low, near), np.minimum(high, far)
        return low, high


def find_stock_faults(query: Query) -> Iterator[str]:
    """Yield one sentence for the first move whose stretches with forces disagree with the places where its
    tool meets the stock.

    Yields nothing if the file does not give the stock.
    """
    program = query.program
    if program is None or program.forces is None or program.stock is None:
        return
    forces, line = program.forces, program.moves.line
    ground = StockGround.from_loops(query.workpiece.outer_loops, program.stock.shape == "block")
    acts = np.flatnonzero((forces.force != 0.0) | (forces.torque != 0.0))
    missing = np.setdiff1d(acts, forces.stretches.move)
    if len(missing):
        yield f"line {line[missing[0]]} of the program has a force, and no stretch on which it acts"
        return
    rows = list(list_acting_ranges(program, acts))
    for begin in range(0, len(rows), AT_ONCE):
        move, first, last, within = (
            np.array(one) for one in zip(*rows[begin : begin + AT_ONCE], strict=True)
        )
        at = find_wrong_piece(make_walk(program), ground, move, first, last, within)
        if at >= 0:
            yield f"the tool in line {line[at]} of the program meets the stock elsewhere than is said"
            return


def list_acting_ranges(program: Program, acts: IntArray) -> Iterator[tuple[int, float, float, bool]]:
    """Yield (move, first share, last share, meets) for the ranges of the moves ``acts`` that are to be
    checked.

    ``meets`` is True if the tool meets the stock according to the file. It is False for the other ranges in
    which the tool's height would allow that.
    """
    forces, stock, moves = program.forces, program.stock, program.moves
    assert forces is not None and stock is not None
    top, long = inf if stock.height is None else stock.height + stock.top, moves.length
    for move in acts.tolist():
        tool = program.tools[int(moves.tool[move])]
        begin, rise = moves.start[move, 2], moves.end[move, 2] - moves.start[move, 2]
        low, high = 0.0, 1.0
        if rise == 0.0:
            high = 1.0 if begin < top and begin + tool.flute_end > 0.0 else 0.0
        else:
            cuts = sorted(((top - begin) / rise, (-tool.flute_end - begin) / rise))
            low, high = max(0.0, cuts[0]), min(1.0, cuts[1])
        at, least = low, OFF / max(float(long[move]), OFF)
        for first, last in forces.stretches.list_shares(move):
            yield move, first, last, True
            if max(low - first, last - high) * abs(rise) > OFF or high <= low:
                # At these heights nothing can be cut.
                yield move, first, last, False
            if first > at + least:
                yield move, at, first, False
            at = max(at, last)
        if high > at + least:
            yield move, at, high, False


def find_wrong_piece(
    walk: ToolWalk, ground: StockGround, move: IntArray, first: Array, last: Array, within: Mask
) -> int:
    """Return the number of a move that contradicts ``within``; -1 if none does.

    Each of the N ranges runs from share ``first`` to share ``last`` of ``move``. ``within`` (N,) tells
    whether the tool should meet the stock all along the range or nowhere in it. Ranges too short to halve
    count as right, ranges still undecided after ``MOST_HALVINGS`` halvings as wrong.
    """
    program = walk.program
    stock, moves = program.stock, program.moves
    assert stock is not None
    reach = np.array([program.tools[int(n)].diameter / 2 + stock.side for n in moves.tool[move]])
    long = np.hypot(*(moves.end - moves.start)[:, :2].T)
    long = np.where(walk.is_round, walk.radius * np.abs(walk.sweep), long)
    for _ in range(MOST_HALVINGS):
        middle = walk.compute_places_at(move, (first + last) / 2)
        one, other = walk.compute_places_at(move, first), walk.compute_places_at(move, last)
        half = long[move] * (last - first) / 2
        turned = np.minimum(np.abs(walk.sweep[move]) * (last - first), 2 * pi)
        sagitta = np.where(walk.is_round[move], walk.radius[move] * (1.0 - np.cos(turned / 2)), 0.0)
        low, high = ground.bound_distances(one, other, middle, half, sagitta)
        inside = ground.contains(middle)
        sure = np.where(
            within, (high <= reach + OFF) | (inside & (low > 0.0)), ~inside & (low >= reach - OFF)
        )
        left = np.flatnonzero(~sure)
        if not len(left):
            return -1
        # What is wrong in the middle is wrong.
        point = middle[left]
        away = np.min([edge.measure_distance(point) for loop in ground.loops for edge in loop], axis=0)
        meets = inside[left] | (away < reach[left])
        wrong = (meets != within[left]) & (inside[left] | (np.abs(away - reach[left]) > OFF))
        if wrong.any():
            return int(move[left[np.argmax(wrong)]])
        middles = (first[left] + last[left]) / 2
        first, last = np.concatenate([first[left], middles]), np.concatenate([middles, last[left]])
        left = np.concatenate([left, left])
        # What cannot be halved any more only touches.
        long_enough = last - first >= 1e-13
        first, last, left = first[long_enough], last[long_enough], left[long_enough]
        move, within, reach = move[left], within[left], reach[left]
        if not len(move):
            return -1
    return int(move[0])
