"""What a program sweeps at the heights of pegs: pieces of the plane that everything of a fixture keeps from.

An element of a fixture is clear where the axis of a tool's cylinder keeps the cylinder's radius and the
clearance from it. So a disc, a capsule and a half plane ask for the least distance less radius over all
pieces. Pieces of one path count once, with the largest radius. A tree of boxes finds the
nearest of thousands.

Glossary
--------
span : one segment or arc of a swept piece's path; a filled box has four, and its inside.
reach : distance less radius, in mm.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from math import inf, tan

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.conventions import STRAIGHT
from workhold.fixels.carrier import Carrier
from workhold.geometry.segment import find_row_ends
from workhold.geometry.symmetry import rotate_vectors
from workhold.kernels.base.distance import DEPTH, LEAF, SweptTree, nearest_swept
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    IS_ARC,
    RADIUS,
    REST_X,
    REST_Y,
    SEGMENT_LENGTH,
    SHALLOW,
    SIGN,
    X,
    Y,
)
from workhold.model.program import PathVertex, Program, SweptPiece
from workhold.model.query import Query

__all__ = [
    "Swept",
    "list_swept_clearances",
    "path_of",
    "bound_spans",
    "find_swept_below",
    "find_swept_between",
    "find_swept_beside_carrier",
    "find_swept_at_pegs",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# Columns of a span: both ends, the bulge between them, and the radius of the cylinder.
SPAN = 6
# Bits of each coordinate in the order of a tree's pieces (G. M. Morton 1966).
MORTON_BITS = 16


@define(frozen=True, eq=False)
class Swept:
    """The spans of what is swept, in the order of their tree; in mm, in the part's coordinates.

    Parameters
    ----------
    tree : of the spans, with rows that only fill leaves.
    line, tool : (N,) of the program, -1 of rows that fill.
    boxes : (N, 4) around each span.
    filled : (B, 4) boxes whose whole inside is swept, x0, y0, x1, y1.
    filled_line : (B,) of the program, of each filled box.
    """

    tree: SweptTree
    line: IntArray
    tool: IntArray
    boxes: Array
    filled: Array
    filled_line: IntArray

    def __len__(self) -> int:
        return int((self.line >= 0).sum())

    @classmethod
    def of(cls, pieces: Iterator[SweptPiece] | tuple[SweptPiece, ...]) -> Swept:
        """The spans of pieces."""
        spans, numbers, filled = list[tuple[float, ...]](), list[tuple[int, int]](), list[tuple[float, ...]]()
        filled_lines = []
        for piece in pieces:
            path = piece.path
            for (x, y, bulge), (to_x, to_y, _) in zip(path, path[1:] or path, strict=False):
                spans.append((x, y, to_x, to_y, bulge, piece.radius))
                numbers.append((piece.line, piece.tool))
            if piece.filled:
                xs, ys = [vertex[0] for vertex in path], [vertex[1] for vertex in path]
                filled.append((min(xs), min(ys), max(xs), max(ys)))
                filled_lines.append(piece.line)
        rows = np.array(spans).reshape(-1, SPAN)
        named = np.array(numbers, np.int64).reshape(-1, 2)
        return cls.of_spans(rows, named, np.array(filled).reshape(-1, 4), np.array(filled_lines, np.int64))

    @classmethod
    def below(cls, program: Program, height: float) -> Swept:
        """The spans of what a program sweeps at heights up to one in mm."""
        return cls.within(program, -inf, height)

    @classmethod
    def within(cls, program: Program, low: float, high: float) -> Swept:
        """The spans of what a program sweeps between two heights in mm."""
        if program.boxed().any():
            return cls.of(program.iter_swept(low, high))
        one = program.arrays_of(*program.pairs(), low, high)
        rows = np.column_stack([one.start, one.end, one.bulge, one.cylinder[:, 2]])
        named = np.column_stack([one.line, one.tool])
        return cls.of_spans(rows, named, np.zeros((0, 4)), np.zeros(0, np.int64))

    @classmethod
    def of_spans(cls, rows: Array, named: IntArray, inside: Array, filled_lines: IntArray) -> Swept:
        """Spans from rows (N, 6), with line and tool (N, 2) of each, and filled boxes (B, 4)."""
        kept = drop_repeated_paths(rows)
        rows, named = rows[kept], named[kept]
        order, boxes = order_tree_leaves(rows, (segments := make_span_rows(rows)))
        count = len(order)
        filling = order < 0
        out, radius = np.zeros((count, SEGMENT_LENGTH)), np.full(count, -inf)
        line, tool = np.full(count, -1), np.full(count, -1)
        around = np.tile([inf, inf, -inf, -inf], (count, 1))
        chosen = order[~filling]
        out[~filling], radius[~filling] = segments[chosen], rows[chosen, 5]
        line[~filling], tool[~filling] = named[chosen].T
        around[~filling] = boxes[chosen]
        out.setflags(write=False)
        tree = SweptTree(out, radius, make_tree_nodes(around, radius))
        return cls(tree, line, tool, around, inside, filled_lines)

    def nearest(self, starts: Array, ends: Array) -> tuple[Array, IntArray]:
        """Least reach (M,) of straight pieces between ends (M, 2), and the number (M,) of the span it is to.

        It is infinite, and the number -1, where nothing is swept. Inside a filled box it is that to its
        border.
        """
        least, which = np.full(len(starts), inf), np.full(len(starts), -1)
        starts, ends = (np.ascontiguousarray(points, np.float64) for points in (starts, ends))
        nearest_swept(starts, ends, self.tree, np.zeros(DEPTH, np.int64), least, which)
        return least, which

    def above(self, theta: float, height: float) -> tuple[float, int]:
        """Least reach to the half plane below a level line, once all is turned, and the span it is to.

        Parameters
        ----------
        theta : by which the part is turned about its origin, in radians.
        height : of the line in mm, from where the part's origin then lies.
        """
        if not len(self.line):
            return inf, -1
        rows, (sine, cosine) = self.tree.rows, (np.sin(theta), np.cos(theta))
        upward = sine * rows[:, X] + cosine * rows[:, Y] + (sine * rows[:, REST_X] + cosine * rows[:, REST_Y])
        axis = sine * rows[:, AXIS_X] + cosine * rows[:, AXIS_Y]
        across = cosine * rows[:, AXIS_X] - sine * rows[:, AXIS_Y]
        half, is_arc = rows[:, HALF_EXTENT], rows[:, IS_ARC] != 0.0
        # An arc is lowest where it faces down, or at an end; its middle has the direction of its axis.
        turn = np.abs(np.arctan2(across, -axis))
        dip = np.where(turn <= half, -1.0, -np.cos(turn - half))
        low = upward + np.where(is_arc, rows[:, RADIUS] * dip, -np.abs(axis) * half)
        reach = np.where(self.line < 0, inf, np.maximum(low - height, 0.0) - self.tree.radius)
        number = int(reach.argmin())
        return float(reach[number]), number if reach[number] < inf else -1

    def starts(self) -> Array:
        """A point (N, 2) of each span: where an arc or a line begins."""
        rows = self.tree.rows
        is_clockwise = (rows[:, IS_ARC] != 0.0) & (rows[:, SIGN] < 0.0)
        return np.asarray(find_row_ends(rows)[np.arange(len(rows)), is_clockwise.astype(np.int64)])

    def reach_of_box(self, corners: Array) -> tuple[float, int]:
        """Least reach to a box with corners (4, 2) counterclockwise, inside and out, and the line of the program.

        Where a path begins inside, or a filled box has a corner in it, they overlap, and it is minus infinity. It is
        infinite, and the line -1, where nothing is swept.
        """
        ahead = np.roll(corners, -1, axis=0)
        sides, off = ahead - corners, self.starts()[:, None] - corners
        inside = (sides[:, 0] * off[..., 1] - sides[:, 1] * off[..., 0] >= 0.0).all(axis=1) & (self.line >= 0)
        if inside.any():
            return -inf, int(self.line[inside].min())
        for (x0, y0, x1, y1), line in zip(self.filled, self.filled_line, strict=True):
            if ((corners >= (x0, y0)) & (corners <= (x1, y1))).all(axis=1).any():
                return -inf, int(line)
        reach, which = self.nearest(corners, ahead)
        side = int(reach.argmin())
        return float(reach[side]), int(self.line[which[side]]) if which[side] >= 0 else -1


@lru_cache(maxsize=16)
def find_swept_below(program: Program, height: float) -> Swept:
    """What a program sweeps at heights up to one in mm, above which nothing of a fixture reaches."""
    return Swept.below(program, height)


def drop_repeated_paths(spans: Array) -> IntArray:
    """The numbers of the spans (N, 6) to keep, in order: of those of one path the one of the largest radius.

    What a smaller cylinder sweeps on a path, the largest sweeps as well.
    """
    backward = (spans[:, 0] > spans[:, 2]) | ((spans[:, 0] == spans[:, 2]) & (spans[:, 1] > spans[:, 3]))
    ends = np.where(backward[:, None], spans[:, [2, 3, 0, 1]], spans[:, :4])
    bulge = np.where(backward, -spans[:, 4], spans[:, 4])
    keys = np.column_stack([ends, bulge]) + 0.0
    order = np.lexsort([-spans[:, 5], *keys.T])
    fresh = np.ones(len(order), np.bool_)
    fresh[1:] = (np.diff(keys[order], axis=0) != 0.0).any(axis=1)
    return np.sort(order[fresh])


def make_span_rows(spans: Array) -> Array:
    """Rows (N, 10) as kernels take them of spans (N, 6); a span of no length is a line of none.

    Formulas as in ``geometry.segment.make_segment_from_bulge``. The centres of shallow arcs are worked out with
    eleven bits more, and what is left of them stands beside them.
    """
    out = np.zeros((len(spans), SEGMENT_LENGTH))
    start, end, bulge = spans[:, :2], spans[:, 2:4], spans[:, 4]
    along = end - start
    chord = np.hypot(along[:, 0], along[:, 1])
    tangent = np.where(chord[:, None] > 0.0, along / np.where(chord > 0.0, chord, 1.0)[:, None], (1.0, 0.0))
    middle = (start + end) / 2
    is_arc = (np.abs(bulge) >= STRAIGHT) & (chord > 0.0)
    out[:, X], out[:, Y] = middle.T
    out[:, AXIS_X], out[:, AXIS_Y], out[:, HALF_EXTENT], out[:, SIGN] = *tangent.T, chord / 2, 1.0
    arcs = np.flatnonzero(is_arc)
    if len(arcs):
        bent, (tx, ty) = bulge[arcs], tangent[arcs].T
        half, sign = 2.0 * np.arctan(np.abs(bent)), np.sign(bent)
        radius = chord[arcs] / (2.0 * np.sin(half))
        axis = np.stack([sign * ty, -sign * tx], axis=1)
        center = middle[arcs] - axis * (radius * np.cos(half))[:, None]
        # Half a chord times the bulge beyond the chord lies the arc's own middle.
        wide = np.longdouble
        rim = middle[arcs].astype(wide) + axis.astype(wide) * (np.abs(bent) * chord[arcs] / 2)[:, None]
        exact = rim - radius[:, None].astype(wide) * axis.astype(wide)
        shallow = half < SHALLOW
        center[shallow] = exact[shallow].astype(np.float64)
        rest = np.where(shallow[:, None], (exact - center).astype(np.float64), 0.0)
        out[arcs, IS_ARC], out[arcs, RADIUS], out[arcs, SIGN] = 1.0, radius, sign
        out[arcs, HALF_EXTENT] = half
        columns = np.array([X, Y, AXIS_X, AXIS_Y, REST_X, REST_Y])
        out[np.ix_(arcs, columns)] = np.hstack([center, axis, rest])
    return out


def path_of(row: Array) -> tuple[PathVertex, ...]:
    """The vertices of a span's path, from its row (10,) as kernels take it; one where it has no length."""
    middle, axis, half = row[[X, Y]], row[[AXIS_X, AXIS_Y]], float(row[HALF_EXTENT])
    if row[IS_ARC]:
        ends = [
            middle + row[RADIUS] * np.array(rotate_vectors(axis[0], axis[1], way * float(row[SIGN]) * half))
            for way in (-1, 1)
        ]
        bulge = float(row[SIGN]) * tan(half / 2)
    else:
        ends, bulge = [middle - half * axis, middle + half * axis], 0.0
    (x, y), (to_x, to_y) = (end.tolist() for end in ends)
    return ((x, y, 0.0),) if half == 0.0 else ((x, y, bulge), (to_x, to_y, 0.0))


def bound_spans(rows: Array) -> Array:
    """Boxes (N, 4) around rows (N, 10), x0, y0, x1, y1, a hair too wide."""
    is_arc, half = rows[:, IS_ARC] != 0.0, rows[:, HALF_EXTENT]
    out = np.empty((len(rows), 4))
    for k, (center, axis, other) in enumerate(((X, AXIS_X, AXIS_Y), (Y, AXIS_Y, AXIS_X))):
        for side in (-1.0, 1.0):
            # How far an arc's axis looks away from this side of the box.
            turn = np.abs(np.arctan2(rows[:, other], side * rows[:, axis]))
            farthest = np.where(turn <= half, 1.0, np.cos(turn - half)) * rows[:, RADIUS]
            extent = np.where(is_arc, farthest, np.abs(rows[:, axis]) * half)
            hair = 1e-12 * (np.abs(rows[:, center]) + rows[:, RADIUS] + half)
            out[:, k + (side > 0) * 2] = rows[:, center] + side * (extent + hair)
    return out


def order_tree_leaves(spans: Array, rows: Array) -> tuple[IntArray, Array]:
    """Numbers of spans in the order of the leaves, -1 for places left over, and the boxes (N, 4) of all."""
    boxes = bound_spans(rows)
    leaves = 1
    while leaves * LEAF < len(spans):
        leaves *= 2
    order = np.full(leaves * LEAF, -1)
    if len(spans):
        middle = (boxes[:, :2] + boxes[:, 2:]) / 2
        low, size = middle.min(axis=0), np.ptp(middle, axis=0).max() or 1.0
        cells = ((middle - low) / size * ((1 << MORTON_BITS) - 1)).astype(np.int64)
        code = np.zeros(len(spans), np.int64)
        for bit in range(MORTON_BITS):
            code |= ((cells[:, 0] >> bit) & 1) << (2 * bit) | ((cells[:, 1] >> bit) & 1) << (2 * bit + 1)
        order[: len(spans)] = np.argsort(code, kind="stable")
    return order, boxes


def make_tree_nodes(boxes: Array, radius: Array) -> Array:
    """The nodes (2 L, 5) of a tree with leaves of ``LEAF`` boxes (N, 4) and radii (N,) each."""
    level = np.column_stack(
        [
            boxes[:, :2].reshape(-1, LEAF, 2).min(axis=1),
            boxes[:, 2:].reshape(-1, LEAF, 2).max(axis=1),
            radius.reshape(-1, LEAF).max(axis=1),
        ]
    )
    levels = [level]
    while len(level) > 1:
        low, high = level[::2], level[1::2]
        level = np.column_stack(
            [
                np.minimum(low[:, :2], high[:, :2]),
                np.maximum(low[:, 2:4], high[:, 2:4]),
                np.maximum(low[:, 4], high[:, 4]),
            ]
        )
        levels.append(level)
    return np.ascontiguousarray(np.concatenate([np.full((1, 5), -inf), *levels[::-1]]))


def list_swept_clearances(query: Query, carrier: Carrier) -> list[tuple[Swept, float]]:
    """What a query's program sweeps at the heights of a carrier's pegs, and what their centres keep besides.

    Where pegs have a shoulder below the part, what is swept there follows, with what that keeps.
    """
    swept = find_swept_at_pegs(query, carrier)
    if swept is None or query.program is None:
        return []
    pieces, clearance = swept
    keeps = [(pieces, clearance + carrier.peg_radius)]
    if carrier.body_radius > carrier.peg_radius:
        keeps.append((find_swept_below(query.program, 0.0), clearance + carrier.body_radius))
    return keeps


def find_swept_at_pegs(query: Query, carrier: Carrier) -> tuple[Swept, float] | None:
    """What a query's program sweeps at the heights of a carrier's pegs, and the clearance in mm.

    None without a program.
    """
    if query.passed is None:
        return None
    program, height = query.passed
    return find_swept_beside_carrier(program, height, carrier), program.clearance


def find_swept_beside_carrier(program: Program, peg_height: float, carrier: Carrier) -> Swept:
    """What a program sweeps at the heights of what stands on a carrier.

    Parameters
    ----------
    peg_height : up to which a carrier without heights of its own reaches, in mm.
    """
    low, high = carrier.heights or (0.0, peg_height)
    return find_swept_between(program, low, high) if low > 0.0 else find_swept_below(program, high)


@lru_cache(maxsize=16)
def find_swept_between(program: Program, low: float, high: float) -> Swept:
    """What a program sweeps between two heights in mm."""
    return Swept.within(program, low, high)
