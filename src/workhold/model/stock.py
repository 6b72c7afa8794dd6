"""The raw stock of a part, and the stretches of a program's moves on which a tool meets it.

A program also feeds through air: down to the work, and sideways into a cut. Only cutting counts. A tool cuts
while its disc, between its tip and the end of its flute, meets the stock. The stock is the part seen from
above without holes, grown sideways by an allowance, from the plane on which the part lies up to another
allowance above its top. A tool that merely touches the stock does not cut.

The disc of radius R meets the grown loops if its middle lies in the loops, or nearer than d = R + side to
their border. The distance from an edge is continuous along a move. It equals d only where the move meets a
parallel of the edge, a circle about the centre of a bent edge, or a circle about either end. On each part
between these points, distance minus d has the sign that it has at the part's middle. The parts that no edge
covers lie entirely inside or outside the loops. Height is linear in the share. So the ends of stretches are
exact.

Glossary
--------
edge : a piece of the border, with both ends and a bulge like a move.
share : position along a move from 0 to 1, see ``model.moves``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf, isfinite, pi
from typing import Any, Literal

import numpy as np
from attrs import field, frozen
from attrs.converters import optional
from numpy.typing import NDArray

from workhold.asking.program import StockQuestion
from workhold.errors import InputError
from workhold.limits import convert_real, name_fields_in_errors, refuse_long
from workhold.model.cutting_tool import Tool
from workhold.model.moves import Moves, MoveStretches, compute_path_points, find_shares_between_heights

__all__ = ["OUTLINE", "STOCK_SHAPES", "StockBorder", "Stock", "StockShape", "find_stretches_in_stock"]

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]
StockShape = Literal["outline", "block"]
OUTLINE: StockShape = "outline"
BLOCK: StockShape = "block"
STOCK_SHAPES = (OUTLINE, BLOCK)
# mm. By less a tool only touches; rounding of places is far below it.
TOUCHES = 1e-6
# Parts of a move that are no nearer than this in their shares are one.
SAME_SHARE = 1e-11
# Pairs of a move and an edge worked out together.
AT_ONCE = 1 << 19


@frozen(field_transformer=name_fields_in_errors)
class Stock(StockQuestion):
    """The raw stock that the part is cut from.

    Parameters
    ----------
    side : allowance beyond the part's outline in mm; 0 if the outline is already finished.
    top : allowance above the part's top in mm.
    shape : ``outline`` for the part's outline, ``block`` for the box around it.
    height : height of the part in mm; None if not known: then the stock has no top.

    Raises
    ------
    InputError
        For lengths below 0, and a shape that is not known.
    """

    height: float | None = field(default=None, converter=optional(convert_real))

    def __attrs_post_init__(self) -> None:
        for name, value in (("side", self.side), ("top", self.top), ("height", self.height or 0.0)):
            if not (isfinite(value) and value >= 0.0):
                raise InputError(f"the stock's {name} {value:g} is not a length: give 0 or more, in mm.")
            refuse_long(f"the stock's {name}", value)

    @property
    def upper(self) -> float:
        """Height of the stock's top in mm; inf if the part's height is not known."""
        return inf if self.height is None else self.height + self.top

    @classmethod
    def from_value(cls, value: Stock | Mapping[str, Any] | str | None, height: float | None) -> Stock:
        """Return a stock for a part of this height in mm (None where unknown).

        ``value`` may be: (a) a stock, whose own height is kept; (b) a mapping of field names to values; (c) a
        shape, such as "block"; (d) None, for the usual stock.

        Raises
        ------
        InputError
            For a name that is no field, and for values that the class refuses.
        """
        if isinstance(value, Stock):
            return cls(value.side, value.top, value.shape, height if value.height is None else value.height)
        given = {"shape": value} if isinstance(value, str) else dict(value or {})
        for name in given:
            if name not in ("side", "top", "shape"):
                raise InputError(f"the stock has no '{str(name)[:40]}': give side, top or shape.")
        return cls(**given, height=height)

    @classmethod
    def from_entries(cls, entries: Mapping[str, Any]) -> Stock:
        """Return the stock that a result file has, the inverse of :meth:`to_dict`."""
        return cls(**{name: entries[name] for name in FIELDS})

    def to_dict(self) -> dict[str, Any]:
        """Return plain data as in a result file."""
        return {name: getattr(self, name) for name in FIELDS}

    def make_border(self, loops: Sequence[Floats]) -> StockBorder:
        """Return the border that is grown sideways to the stock:
        the outer loops, or the box around them for a block.

        ``loops`` are (N, 3) vertices x, y in mm and bulge.
        """
        if self.shape == OUTLINE:
            return StockBorder.from_loops(loops)
        x0, y0, x1, y1 = compute_box(StockBorder.from_loops(loops))
        return StockBorder.from_loops(
            [np.array([[x0, y0, 0.0], [x1, y0, 0.0], [x1, y1, 0.0], [x0, y1, 0.0]])]
        )


FIELDS = ("side", "top", "shape", "height")


@frozen(eq=False)
class BorderCurves:
    """N lines and arcs.

    Parameters
    ----------
    start, end : (N, 2) in mm.
    bulge : (N,).
    center, radius, turn, sweep : of arcs, the centre (N, 2) and radius in mm, the angle of the start about
        the centre and the sweep in radians, (N,) each.
    is_arc : (N,).
    """

    start: Floats
    end: Floats
    bulge: Floats
    center: Floats
    radius: Floats
    turn: Floats
    sweep: Floats
    is_arc: Mask

    @classmethod
    def from_ends(cls, start: Floats, end: Floats, bulge: Floats) -> BorderCurves:
        """Return curves with centre, radius,
        start angle and sweep worked out from ends (N, 2) in mm and bulges (N,).
        """
        chord = end - start
        is_arc = (bulge != 0.0) & (chord != 0.0).any(axis=1)
        safe = np.where(is_arc, bulge, 1.0)
        left = np.stack([-chord[:, 1], chord[:, 0]], axis=1)
        # The tangent of half the half sweep is the bulge, so its cotangent places the centre.
        center = (start + end) / 2 + left * ((1.0 - safe * safe) / (4.0 * safe))[:, None]
        arm = start - center
        radius, turn = np.hypot(*arm.T), np.arctan2(arm[:, 1], arm[:, 0])
        return cls(start, end, bulge, center, radius, turn, 4.0 * np.arctan(bulge * is_arc), is_arc)

    def __len__(self) -> int:
        return len(self.bulge)

    def take(self, chosen: Integers) -> BorderCurves:
        """Return the curves with these indices."""
        return BorderCurves.from_ends(self.start[chosen], self.end[chosen], self.bulge[chosen])

    @property
    def length(self) -> Floats:
        """(N,) lengths in mm."""
        straight = np.hypot(*(self.end - self.start).T)
        return np.where(self.is_arc, self.radius * np.abs(self.sweep), straight)

    def compute_points(self, share: Floats) -> Floats:
        """Return the points (N, C, 2) in mm at shares (N, C) of the curves."""
        count = share.shape[1]
        start, end = (np.repeat(one, count, axis=0) for one in (self.start, self.end))
        bulge = np.repeat(np.where(self.is_arc, self.bulge, 0.0), count)
        return compute_path_points(start, end, bulge, share.ravel()).reshape(*share.shape, 2)

    def measure_distances(self, points: Floats) -> Floats:
        """Return the distances (N, C) in mm of points (N, C, 2) from N curves: row i of the points belongs to
        curve i.

        Points (1, C, 2) are used for all curves.
        """
        chord = self.end - self.start
        long = (chord * chord).sum(axis=1)
        arm = points - self.start[:, None]
        share = (arm * chord[:, None]).sum(axis=2) / np.where(long > 0.0, long, 1.0)[:, None]
        off = arm - np.clip(share, 0.0, 1.0)[..., None] * chord[:, None]
        straight = np.hypot(off[..., 0], off[..., 1])
        if not self.is_arc.any():
            return np.asarray(straight)
        out = points - self.center[:, None]
        angle = np.arctan2(out[..., 1], out[..., 0])
        sense = np.where(self.sweep < 0.0, -1.0, 1.0)
        turned = np.mod((angle - self.turn[:, None]) * sense[:, None], 2 * pi)
        to_rim = np.abs(np.hypot(out[..., 0], out[..., 1]) - self.radius[:, None])
        back = points - self.end[:, None]
        to_ends = np.minimum(np.hypot(arm[..., 0], arm[..., 1]), np.hypot(back[..., 0], back[..., 1]))
        bent = np.where(turned <= np.abs(self.sweep)[:, None], to_rim, to_ends)
        return np.where(self.is_arc[:, None], bent, straight)


@frozen(eq=False)
class StockBorder:
    """The edges of outer loops, loop by loop."""

    edges: BorderCurves
    loop: Integers

    @classmethod
    def from_loops(cls, loops: Sequence[Floats]) -> StockBorder:
        """Return the border made of loops (N, 3): vertices x, y in mm and bulge of the side to the next
        vertex.

        Each loop closes from its last to its first vertex.
        """
        start = np.concatenate([loop[:, :2] for loop in loops])
        end = np.concatenate([np.roll(loop[:, :2], -1, axis=0) for loop in loops])
        bulge = np.concatenate([loop[:, 2] for loop in loops])
        number = np.concatenate([np.full(len(loop), k) for k, loop in enumerate(loops)])
        return cls(BorderCurves.from_ends(start, end, bulge), number)

    def measure_distance(self, points: Floats) -> Floats:
        """Return the distances (N,) in mm of points (N, 2) from the nearest edge."""
        parts = make_row_slices(len(points), len(self.edges))
        found = [self.edges.measure_distances(points[None, part]).min(axis=0) for part in parts]
        return np.concatenate([np.zeros(0), *found])

    def encloses(self, points: Floats) -> Mask:
        """Return (N,) whether points (N, 2), none of them on an edge, lie within a loop.

        For each loop the angles that its chords subtend at the point are added, with a whole turn for each
        arc if the point lies between arc and chord. The sum is ±2 pi for a loop around the point, else 0.
        """
        edges, found = self.edges, [np.zeros(0, np.bool_)]
        side = np.where(edges.is_arc, np.sign(edges.bulge), 0.0)
        for part in make_row_slices(len(points), len(edges)):
            one, other = (ends[:, None] - points[None, part] for ends in (edges.start, edges.end))
            cross = one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0] + 0.0
            angle = np.arctan2(cross, (one * other).sum(axis=2))
            # A point on a chord lies on its left for both.
            beyond = np.where(side[:, None] > 0.0, cross < 0.0, cross >= 0.0)
            out = points[None, part] - edges.center[:, None]
            within = np.hypot(out[..., 0], out[..., 1]) < edges.radius[:, None]
            angle += 2 * pi * side[:, None] * (beyond & within)
            turns = np.stack([angle[self.loop == k].sum(axis=0) for k in range(int(self.loop[-1]) + 1)])
            found.append((np.abs(turns) > pi).any(axis=0))
        return np.concatenate(found)


def compute_box(border: StockBorder) -> tuple[float, float, float, float]:
    """Return x0, y0, x1, y1 in mm of the bounding box of a border."""
    edges = border.edges
    points = [edges.start, edges.end]
    for k in range(4):
        # The path runs along an axis where its angle is a multiple of a quarter turn.
        ahead = np.mod((k * pi / 2 - edges.turn) * np.sign(edges.sweep), 2 * pi)
        there = edges.is_arc & (ahead <= np.abs(edges.sweep))
        way = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][k])
        points.append(edges.center[there] + edges.radius[there, None] * way)
    every = np.concatenate(points)
    (x0, y0), (x1, y1) = every.min(axis=0).tolist(), every.max(axis=0).tolist()
    return x0, y0, x1, y1


def make_row_slices(count: int, width: int) -> list[slice]:
    """Return slices that cover ``count`` rows of ``width`` numbers,
    each of at most :data:`AT_ONCE` numbers or one row.
    """
    step = max(AT_ONCE // max(width, 1), 1)
    return [slice(k, k + step) for k in range(0, count, step)]


def find_stretches_in_stock(
    moves: Moves, tools: Mapping[int, Tool], stock: Stock, border: StockBorder | None, asked: Mask
) -> MoveStretches:
    """Return the stretches of the moves in the mask ``asked`` on which the flute of the move's tool meets the
    stock.

    Parameters
    ----------
    border : border of the shape that is grown sideways to the stock; None where only heights are known.
    asked : (M,) True for each move that counts.
    """
    rows = np.flatnonzero(asked)
    reach, flute = np.zeros(len(moves)), np.zeros(len(moves))
    for number, tool in tools.items():
        own = moves.tool == number
        reach[own], flute[own] = tool.diameter / 2 + stock.side - TOUCHES, tool.flute_end
    start, end = moves.start[rows, 2], moves.end[rows, 2]
    low = TOUCHES - flute[rows]
    first, last = find_shares_between_heights(start, end, low, np.full(len(rows), stock.upper - TOUCHES))
    kept = last > first
    rows, first, last = rows[kept], first[kept], last[kept]
    if border is None or not len(rows):
        return MoveStretches(rows, first, last)
    which, low, high = find_near_parts(
        BorderCurves.from_ends(moves.start[rows, :2], moves.end[rows, :2], moves.bulge[rows]),
        reach[rows],
        border,
    )
    low, high = np.maximum(low, first[which]), np.minimum(high, last[which])
    long = high > low
    return MoveStretches(rows[which[long]], low[long], high[long])


def find_near_parts(
    paths: BorderCurves, reach: Floats, border: StockBorder
) -> tuple[Integers, Floats, Floats]:
    """Return the parts of P paths that lie within a border or nearer to it than ``reach`` (P,) in mm.

    The result is (path indices (K,), ascending; shares (K,) at which each part begins; shares (K,) at which
    it ends).
    """
    half = paths.length / 2
    middle = paths.compute_points(np.full((len(paths), 1), 0.5))[:, 0]
    away = np.full(len(paths), inf)
    x0, y0, x1, y1 = compute_box(border)
    off = np.maximum([x0, y0] - middle, middle - [x1, y1])
    close = np.flatnonzero(np.hypot(*np.maximum(off, 0.0).T) <= reach + half)
    away[close] = border.measure_distance(middle[close])
    whole = away < reach - half
    # Of what lies deep enough on one side of the border the middle says which side that is.
    deep = np.flatnonzero(~whole & np.isfinite(away) & (away > half))
    whole[deep] = border.encloses(middle[deep])
    mixed = np.flatnonzero(~whole & (away <= reach + half))
    which, low, high = find_mixed_parts(paths, reach, border, mixed)
    sure = np.flatnonzero(whole)
    which = np.concatenate([sure, which])
    low, high = np.concatenate([np.zeros(len(sure)), low]), np.concatenate([np.ones(len(sure)), high])
    order = np.lexsort((low, which))
    return which[order], low[order], high[order]


def find_mixed_parts(
    paths: BorderCurves, reach: Floats, border: StockBorder, mixed: Integers
) -> tuple[Integers, Floats, Floats]:
    """Return the parts within reach, as :func:`find_near_parts` does, of only the paths whose indices are in
    ``mixed``.

    These indices ascend; such a path may be within reach in some parts and out of reach in others.
    """
    which, low, high = [np.zeros(0, np.int64)], [np.zeros(0)], [np.zeros(0)]
    half = paths.length / 2
    for part in make_row_slices(len(mixed), len(border.edges) * 16):
        rows = mixed[part]
        middle = paths.take(rows).compute_points(np.full((len(rows), 1), 0.5))[:, 0]
        distance = border.edges.measure_distances(middle[None])
        edge, own = np.nonzero(distance <= (reach + half)[rows])
        pairs = paths.take(rows[own])
        one, other, pair = find_covered_parts(pairs, border.edges.take(edge), reach[rows[own]])
        own, one, other = merge_parts(own[pair], one, other)
        gap, begin, finish = find_gaps(len(rows), own, one, other)
        between = paths.take(rows[gap]).compute_points(((begin + finish) / 2)[:, None])[:, 0]
        inside = border.encloses(between)
        own, one, other = merge_parts(
            np.concatenate([own, gap[inside]]),
            np.concatenate([one, begin[inside]]),
            np.concatenate([other, finish[inside]]),
        )
        which.append(rows[own])
        low.append(one)
        high.append(other)
    return np.concatenate(which), np.concatenate(low), np.concatenate(high)


def find_covered_parts(
    paths: BorderCurves, edges: BorderCurves, reach: Floats
) -> tuple[Floats, Floats, Integers]:
    """Return the parts of P paths that are nearer than ``reach`` (P,) mm to an edge; path i is compared with
    edge i only.

    They are given as first shares (K,), last shares (K,) and path indices (K,), ascending; parts of a path
    may adjoin.
    """
    chord = edges.end - edges.start
    size = np.hypot(*chord.T)
    normal = np.stack([-chord[:, 1], chord[:, 0]], axis=1) / np.where(size > 0.0, size, 1.0)[:, None]
    level = (normal * edges.start).sum(axis=1)
    straight = ~edges.is_arc & (size > 0.0)
    cuts = [
        intersect_with_circles(paths, edges.start, reach),
        intersect_with_circles(paths, edges.end, reach),
    ]
    cuts += [
        intersect_with_lines(paths, normal, np.where(straight, level + way * reach, np.nan))
        for way in (-1.0, 1.0)
    ]
    for radius in (edges.radius + reach, np.abs(edges.radius - reach)):
        cuts.append(intersect_with_circles(paths, edges.center, np.where(edges.is_arc, radius, np.nan)))
    found = np.hstack(cuts)
    found = np.where((found > 0.0) & (found < 1.0), found, 1.0)
    count = len(reach)
    shares = np.sort(np.hstack([np.zeros((count, 1)), found, np.ones((count, 1))]), axis=1)
    middle = (shares[:, 1:] + shares[:, :-1]) / 2
    inside = edges.measure_distances(paths.compute_points(middle)) < reach[:, None]
    pair, number = np.nonzero(inside & (shares[:, 1:] > shares[:, :-1]))
    return shares[pair, number], shares[pair, number + 1], pair


def intersect_with_circles(paths: BorderCurves, center: Floats, radius: Floats) -> Floats:
    """Return two shares (P, 2) at which each path's line or
    circle meets a circle, unordered; NaN where it does not.

    Shares outside [0, 1] lie off the path. ``center`` is (P, 2) and ``radius`` (P,), in mm.
    """
    chord, arm = paths.end - paths.start, paths.start - center
    long = (chord * chord).sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        # Measured from the foot of the centre, so that rounding stays that of the foot.
        foot = -(arm * chord).sum(axis=1) / long
        across = (chord[:, 0] * arm[:, 1] - chord[:, 1] * arm[:, 0]) / np.sqrt(long)
        half = np.sqrt((radius - np.abs(across)) * (radius + np.abs(across)) / long)
        straight = np.stack([foot - half, foot + half], axis=1)
        to = center - paths.center
        away = np.hypot(*to.T)
        size = ((paths.radius - radius) * (paths.radius + radius) / away + away) / (2 * paths.radius)
        spread, middle = np.arccos(size), np.arctan2(to[:, 1], to[:, 0])
    bent = compute_shares(paths, np.stack([middle - spread, middle + spread], axis=1))
    return np.where(paths.is_arc[:, None], bent, straight)


def intersect_with_lines(paths: BorderCurves, normal: Floats, level: Floats) -> Floats:
    """Return two shares (P, 2) at which each path's line or circle
    meets the line normal · x = level; NaN where it does not.

    Shares outside [0, 1] lie off the path; a straight path has one, and NaN beside it.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        place = (level - (normal * paths.start).sum(axis=1)) / (normal * (paths.end - paths.start)).sum(
            axis=1
        )
        spread = np.arccos((level - (normal * paths.center).sum(axis=1)) / paths.radius)
    straight = np.stack([place, np.full(len(place), np.nan)], axis=1)
    middle = np.arctan2(normal[:, 1], normal[:, 0])
    bent = compute_shares(paths, np.stack([middle - spread, middle + spread], axis=1))
    return np.where(paths.is_arc[:, None], bent, straight)


def compute_shares(paths: BorderCurves, angle: Floats) -> Floats:
    """Return the shares (P, C) at which P arcs reach angles (P, C), in radians about their centres.

    A share above 1 means that the arc does not reach the angle.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        ahead = np.mod((angle - paths.turn[:, None]) * np.sign(paths.sweep)[:, None], 2 * pi)
        return np.asarray(ahead / np.abs(paths.sweep)[:, None])


def merge_parts(own: Integers, low: Floats, high: Floats) -> tuple[Integers, Floats, Floats]:
    """Return parts of paths, sorted by path and share, with overlapping or adjoining parts of a path joined
    into one.

    A part is a path index in ``own`` with its first and last share in ``low`` and ``high``.
    """
    order = np.lexsort((low, own))
    own, low, high = own[order], low[order], high[order]
    if not len(own):
        return own, low, high
    # Shares of one path are at most 1, so that what ends before says nothing of the next one.
    reached = np.maximum.accumulate(high + 2.0 * own) - 2.0 * own
    fresh = np.concatenate([[True], (own[1:] > own[:-1]) | (low[1:] > reached[:-1] + SAME_SHARE)])
    first = np.flatnonzero(fresh)
    return own[first], low[first], np.maximum.reduceat(high, first)


def find_gaps(count: int, own: Integers, low: Floats, high: Floats) -> tuple[Integers, Floats, Floats]:
    """Return the gaps between merged parts (:func:`merge_parts`) on ``count`` paths: path indices, first and
    last shares.
    """
    every = np.arange(count)
    ends = np.concatenate([every, own]), np.concatenate([np.zeros(count), high])
    begins = np.concatenate([own, every]), np.concatenate([low, np.ones(count)])
    order, other = np.lexsort(ends[::-1]), np.lexsort(begins[::-1])
    number, begin, finish = ends[0][order], ends[1][order], begins[1][other]
    wide = finish > begin + SAME_SHARE
    return number[wide], begin[wide], finish[wide]
