"""The areas of the plane that a program sweeps at the heights of pegs; every element of a fixture keeps clear
of them.

A swept piece is the path of a cylinder's axis with the cylinder's radius. An element of a fixture is clear if
its distance from each path is at least the radius plus the clearance. So for a disc, a capsule or a half
plane, the least value of distance minus radius over all pieces decides. Pieces of one path count once, with
the largest radius. A tree of boxes finds the nearest of thousands.

Glossary
--------
span : one segment or arc of a swept piece's path; a filled box has four, and its inside.
reach : distance minus radius, in mm.
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
from workhold.kernels.base.distance import DEPTH, LEAF, SweptTree, write_nearest_swept
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
from workhold.model.pose import Pose
from workhold.model.program import PathVertex, Program, SweptPiece
from workhold.model.query import Query

__all__ = [
    "SweptSpans",
    "list_swept_clearances",
    "find_span_path",
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
class SweptSpans:
    """The spans of swept pieces (segments and arcs of their paths) in the order of their tree; in mm, in the
    part's coordinates.

    Parameters
    ----------
    tree : of the spans, with rows that only fill leaves.
    line, tool : (N,) numbers of the program's line and of the tool, -1 for rows that only fill leaves.
    boxes : (N, 4) box x0, y0, x1, y1 around each span.
    filled : (B, 4) boxes x0, y0, x1, y1 whose whole inside is swept.
    filled_by : (B, 2) line of the program and tool of each filled box.
    """

    tree: SweptTree
    line: IntArray
    tool: IntArray
    boxes: Array
    filled: Array
    filled_by: IntArray

    def __len__(self) -> int:
        return int((self.line >= 0).sum())

    @classmethod
    def from_pieces(cls, pieces: Iterator[SweptPiece] | tuple[SweptPiece, ...]) -> SweptSpans:
        """Return the spans of swept pieces."""
        spans, numbers, filled = list[tuple[float, ...]](), list[tuple[int, int]](), list[tuple[float, ...]]()
        filled_by = list[tuple[int, int]]()
        for piece in pieces:
            path = piece.path
            for (x, y, bulge), (to_x, to_y, _) in zip(path, path[1:] or path, strict=False):
                spans.append((x, y, to_x, to_y, bulge, piece.radius))
                numbers.append((piece.line, piece.tool))
            if piece.filled:
                xs, ys = [vertex[0] for vertex in path], [vertex[1] for vertex in path]
                filled.append((min(xs), min(ys), max(xs), max(ys)))
                filled_by.append((piece.line, piece.tool))
        rows = np.array(spans).reshape(-1, SPAN)
        named = np.array(numbers, np.int64).reshape(-1, 2)
        return cls.from_span_rows(
            rows, named, np.array(filled).reshape(-1, 4), np.array(filled_by, np.int64).reshape(-1, 2)
        )

    @classmethod
    def from_program(cls, program: Program, height: float) -> SweptSpans:
        """Return the spans that a program sweeps at heights up to ``height`` in mm."""
        return cls.from_height_range(program, -inf, height)

    @classmethod
    def from_height_range(cls, program: Program, low: float, high: float) -> SweptSpans:
        """Return the spans that a program sweeps between the heights ``low`` and ``high`` in mm."""
        if program.find_boxed_moves().any():
            return cls.from_pieces(program.iterate_swept_pieces(low, high))
        one = program.make_arrays(*program.pair_moves_with_cylinders(), low, high)
        rows = np.column_stack([one.start, one.end, one.bulge, one.cylinder[:, 2]])
        named = np.column_stack([one.line, one.tool])
        return cls.from_span_rows(rows, named, np.zeros((0, 4)), np.zeros((0, 2), np.int64))

    @classmethod
    def from_span_rows(cls, rows: Array, named: IntArray, inside: Array, filled_by: IntArray) -> SweptSpans:
        """Return spans from rows (N, 6): both ends (x, y each), bulge, cylinder radius.

        ``named`` (N, 2) has line and tool of each row, ``inside`` (B, 4) the filled boxes, ``filled_by``
        (B, 2) their lines and tools.
        """
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
        return cls(tree, line, tool, around, inside, filled_by)

    def find_nearest_spans(self, starts: Array, ends: Array) -> tuple[Array, IntArray]:
        """Return (least reach (M,) in mm from each straight piece to the spans, number (M,) of the nearest
        span).

        The reach is distance minus cylinder radius. Pieces go from ``starts`` to ``ends`` (M, 2). The reach
        is inf, and the number -1, where nothing is swept. Inside a filled box it is the reach to the border
        of the box.
        """
        least, which = np.full(len(starts), inf), np.full(len(starts), -1)
        starts, ends = (np.ascontiguousarray(points, np.float64) for points in (starts, ends))
        write_nearest_swept(starts, ends, self.tree, np.zeros(DEPTH, np.int64), least, which)
        return least, which

    def find_reach_below_line(self, theta: float, height: float) -> tuple[float, int]:
        """Return (least reach in mm from the half plane below a level line to the spans of the turned part,
        nearest span).

        The reach is distance minus cylinder radius. Return (inf, -1) if nothing is swept.

        Parameters
        ----------
        theta : angle by which the part is turned about its origin, in radians.
        height : height of the line in mm above the part's origin.
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

    def compute_start_points(self) -> Array:
        """Return the first point (N, 2) of each span's path in mm."""
        rows = self.tree.rows
        is_clockwise = (rows[:, IS_ARC] != 0.0) & (rows[:, SIGN] < 0.0)
        return np.asarray(find_row_ends(rows)[np.arange(len(rows)), is_clockwise.astype(np.int64)])

    def find_reach_to_box(self, corners: Array) -> tuple[float, int, int]:
        """Return (least reach in mm from a filled box to the spans, line of the program that comes nearest,
        its tool).

        The reach is distance minus cylinder radius. ``corners`` (4, 2) of the box are counter-clockwise. The
        reach is -inf if a path begins inside the box, or a filled box contains one of its corners. It is inf,
        and line and tool are -1, if nothing is swept.
        """
        ahead = np.roll(corners, -1, axis=0)
        sides, off = ahead - corners, self.compute_start_points()[:, None] - corners
        inside = (sides[:, 0] * off[..., 1] - sides[:, 1] * off[..., 0] >= 0.0).all(axis=1) & (self.line >= 0)
        if inside.any():
            first = int(np.where(inside, self.line, self.line.max() + 1).argmin())
            return -inf, int(self.line[first]), int(self.tool[first])
        for (x0, y0, x1, y1), (line, tool) in zip(self.filled, self.filled_by.tolist(), strict=True):
            if ((corners >= (x0, y0)) & (corners <= (x1, y1))).all(axis=1).any():
                return -inf, line, tool
        reach, which = self.find_nearest_spans(corners, ahead)
        side = int(reach.argmin())
        span = int(which[side])
        if span < 0:
            return float(reach[side]), -1, -1
        return float(reach[side]), int(self.line[span]), int(self.tool[span])

    def bound_strip(self, pose: Pose, left: float, right: float, margin: float) -> tuple[Array, Array, Array]:
        """Return (least y (N,), greatest y (N,), reach (N,)) in mm of the swept spans near an upright strip.

        The strip lies between x = ``left`` and ``right`` in the frame of ``pose``, in which y is given, too.
        The reach is a cylinder's radius plus ``margin``; spans and filled boxes farther from the strip than
        this are left out. Straight spans are cut off at the strip, arcs are not.
        """
        rows = self.tree.rows[self.line >= 0]
        radius = self.tree.radius[self.line >= 0] + margin
        ends = find_row_ends(rows)
        x, y = pose.apply(ends[..., 0], ends[..., 1])
        turned = rows.copy()
        turned[:, X], turned[:, Y] = pose.apply(rows[:, X], rows[:, Y])
        turned[:, AXIS_X], turned[:, AXIS_Y] = pose.turn(rows[:, AXIS_X], rows[:, AXIS_Y])
        boxes = bound_spans(turned)
        near = (boxes[:, 2] > left - radius) & (boxes[:, 0] < right + radius)
        reach = x[:, 1] - x[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            shares = np.sort([(left - radius - x[:, 0]) / reach, (right + radius - x[:, 0]) / reach], axis=0)
        shares = np.where(reach == 0.0, np.array([[0.0], [1.0]]), np.clip(shares, 0.0, 1.0))
        cut = np.sort(y[:, 0] + shares * (y[:, 1] - y[:, 0]), axis=0)
        is_arc = rows[:, IS_ARC] != 0.0
        low, high = np.where(is_arc, boxes[:, 1], cut[0]), np.where(is_arc, boxes[:, 3], cut[1])
        inner = self.filled[:, [0, 1, 2, 1, 2, 3, 0, 3]].reshape(-1, 4, 2)
        inner_x, inner_y = pose.apply(inner[..., 0], inner[..., 1])
        beside = (inner_x.max(axis=1) > left) & (inner_x.min(axis=1) < right)
        return (
            np.concatenate([low[near], inner_y.min(axis=1)[beside]]),
            np.concatenate([high[near], inner_y.max(axis=1)[beside]]),
            np.concatenate([radius[near], np.full(int(beside.sum()), margin)]),
        )


@lru_cache(maxsize=16)
def find_swept_below(program: Program, height: float) -> SweptSpans:
    """Return the spans that a program sweeps at heights up to ``height`` in mm."""
    return SweptSpans.from_program(program, height)


def drop_repeated_paths(spans: Array) -> IntArray:
    """Return the indices, ascending, of the spans (N, 6) to keep: for each path the span with the largest
    radius.

    Paths run in either direction are the same. On the same path, the largest cylinder sweeps everything that
    a smaller one sweeps.
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
    """Return kernel rows (N, 10) of spans (N, 6); a span of no length becomes a line of no length.

    Formulas as in ``geometry.segment.make_segment_from_bulge``. The centres of shallow arcs are computed with
    eleven more bits, and their rounding errors stand in the columns REST_X and REST_Y. See
    ``kernels.base.feature`` for the layout of rows.
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


def find_span_path(row: Array) -> tuple[PathVertex, ...]:
    """Return the vertices (x, y, bulge) of a span's path, from its kernel row (10,): two vertices, or one if
    it has no length.
    """
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
    """Return boxes (N, 4) around kernel rows (N, 10): columns x0, y0, x1, y1 in mm, slightly too wide.

    See ``kernels.base.feature`` for the layout of rows.
    """
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
    """Return (indices of spans in the order of the tree's leaves, -1 for places left over; boxes (N, 4)
    around the spans).

    ``spans`` (N, 6) are given with their kernel rows (N, 10). Indices fill L leaves of ``LEAF`` places each,
    where L is a power of 2. See ``kernels.base.feature`` for the layout of rows.
    """
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
    """Return the nodes (2 L, 5) of a tree with L leaves: x0, y0, x1,
    y1 and the largest radius of each; row 0 is unused.

    ``boxes`` (N, 4) and ``radius`` (N,) are those of the spans in the order of the leaves, ``LEAF`` spans in
    each leaf.
    """
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


def list_swept_clearances(query: Query, carrier: Carrier) -> list[tuple[SweptSpans, float]]:
    """Return pairs (swept spans, distance in mm that peg centres of a carrier keep from the paths in addition
    to the tools' radius).

    The first pair is for the heights of the pegs. Where pegs have a shoulder below the part, a second pair is
    for the heights and the radius of the shoulder. Return an empty list without a program.
    """
    swept = find_swept_at_pegs(query, carrier)
    if swept is None or query.program is None:
        return []
    pieces, clearance = swept
    keeps = [(pieces, clearance + carrier.peg_radius)]
    if carrier.body_radius > carrier.peg_radius:
        keeps.append((find_swept_below(query.program, 0.0), clearance + carrier.body_radius))
    return keeps


def find_swept_at_pegs(query: Query, carrier: Carrier) -> tuple[SweptSpans, float] | None:
    """Return (spans that a query's program sweeps at the heights of a carrier's pegs, clearance to keep from
    them in mm).

    Return None without a program.
    """
    if query.program_to_clear is None:
        return None
    program, height = query.program_to_clear
    return find_swept_beside_carrier(program, height, carrier), program.clearance


def find_swept_beside_carrier(program: Program, peg_height: float, carrier: Carrier) -> SweptSpans:
    """Return the spans that a program sweeps at the heights of a carrier's elements.

    Parameters
    ----------
    peg_height : height in mm of a carrier without heights of its own.
    """
    low, high = carrier.heights or (0.0, peg_height)
    return find_swept_between(program, low, high) if low > 0.0 else find_swept_below(program, high)


@lru_cache(maxsize=16)
def find_swept_between(program: Program, low: float, high: float) -> SweptSpans:
    """Return the spans that a program sweeps between the heights ``low`` and ``high`` in mm."""
    return SweptSpans.from_height_range(program, low, high)
