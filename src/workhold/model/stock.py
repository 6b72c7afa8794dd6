"""The raw stock of a part, and the stretches of a program's moves on which a tool meets it.

A program feeds through air as well: down to the work, and into a cut from beside it. Only what cuts counts. A
tool cuts while its disc, between its tip and the end of its flute, meets the stock: the outer loops of the
part seen from above, holes filled, grown sideways by an allowance, from the plane on which the part lies up to
as much above its top. What only touches the stock takes nothing off it.

The disc of radius R meets the grown loops where its middle lies in them, or nearer than d = R + side to their
border. Distance from an edge is continuous along a move. It is d only where the move meets a parallel of the
edge, a circle about the centre of a bent edge, or one about either end. Cut there, a move has parts on which
the distance less d has one sign, that of the part's middle. What all edges leave of a move lies wholly inside
or wholly outside. Height is linear in the share. So the ends of stretches are exact.

Glossary
--------
edge : a piece of the border, with both ends and a bulge like a move.
share : how far along a move a moment is, see ``model.moves``.
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
from workhold.limits import convert_real, name_number_fields, refuse_long
from workhold.model.cutting_tool import Tool
from workhold.model.moves import Moves, Stretches, along, find_shares_between_heights

__all__ = ["OUTLINE", "STOCK_SHAPES", "Border", "Stock", "StockShape", "find_stretches_in_stock"]

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


@frozen(field_transformer=name_number_fields)
class Stock(StockQuestion):
    """What the part is cut from.

    Parameters
    ----------
    side : how far it reaches beyond the part's outline, in mm; 0 where the part comes finished there.
    top : how far it reaches above the part's top, in mm.
    shape : ``outline`` of the part, or the ``block`` around it.
    height : of the part, in mm; None where nobody knows it, and the stock has no top then.

    Raises
    ------
    InputError
        For lengths below 0, and a shape that is not known.
    """

    height: float | None = field(default=None, converter=optional(convert_real))

    def __attrs_post_init__(self) -> None:
        for name, value in (("side", self.side), ("top", self.top), ("height", self.height or 0.0)):
            if not (isfinite(value) and value >= 0.0):
                raise InputError(f"the stock's {name} {value:g} is no length: give 0 or more, in mm.")
            refuse_long(f"the stock's {name}", value)

    @property
    def upper(self) -> float:
        """The height in mm up to which it reaches; infinite where nobody knows."""
        return inf if self.height is None else self.height + self.top

    @classmethod
    def of(cls, value: Stock | Mapping[str, Any] | str | None, height: float | None) -> Stock:
        """A stock on a part of a height in mm, of one or of its fields by name; None is the usual one.

        Raises
        ------
        InputError
            For a name that there is none of, and as the class.
        """
        if isinstance(value, Stock):
            return cls(value.side, value.top, value.shape, height if value.height is None else value.height)
        given = {"shape": value} if isinstance(value, str) else dict(value or {})
        for name in given:
            if name not in ("side", "top", "shape"):
                raise InputError(f"the stock has no '{str(name)[:40]}': give side, top or shape.")
        return cls(**given, height=height)

    @classmethod
    def of_entries(cls, entries: Mapping[str, Any]) -> Stock:
        return cls(**{name: entries[name] for name in FIELDS})

    def to_dict(self) -> dict[str, Any]:
        """Plain data as in a result file."""
        return {name: getattr(self, name) for name in FIELDS}

    def border(self, loops: Sequence[Floats]) -> Border:
        """What is grown to the stock: outer loops of (N, 3) vertices x, y and bulge, or the box around them."""
        if self.shape == OUTLINE:
            return Border.of(loops)
        x0, y0, x1, y1 = box_around(Border.of(loops))
        return Border.of([np.array([[x0, y0, 0.0], [x1, y0, 0.0], [x1, y1, 0.0], [x0, y1, 0.0]])])


FIELDS = ("side", "top", "shape", "height")


@frozen(eq=False)
class Curves:
    """N lines and arcs.

    Parameters
    ----------
    start, end : (N, 2) in mm.
    bulge : (N,).
    center, radius, turn, sweep : (N, 2) and (N,) of arcs: centre, radius, angle of the start about it, and
        how far it turns.
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
    def of(cls, start: Floats, end: Floats, bulge: Floats) -> Curves:
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

    def take(self, chosen: Integers) -> Curves:
        return Curves.of(self.start[chosen], self.end[chosen], self.bulge[chosen])

    @property
    def length(self) -> Floats:
        """(N,) in mm."""
        straight = np.hypot(*(self.end - self.start).T)
        return np.where(self.is_arc, self.radius * np.abs(self.sweep), straight)

    def at(self, share: Floats) -> Floats:
        """(N, C, 2) places at shares (N, C)."""
        count = share.shape[1]
        start, end = (np.repeat(one, count, axis=0) for one in (self.start, self.end))
        bulge = np.repeat(np.where(self.is_arc, self.bulge, 0.0), count)
        return along(start, end, bulge, share.ravel()).reshape(*share.shape, 2)

    def distances(self, points: Floats) -> Floats:
        """(N, C) distances in mm of points (N, C, 2), or of the same (1, C, 2) for all, from each."""
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
class Border:
    """The edges of outer loops, loop by loop."""

    edges: Curves
    loop: Integers

    @classmethod
    def of(cls, loops: Sequence[Floats]) -> Border:
        """The border of loops of (N, 3) vertices x, y and bulge."""
        start = np.concatenate([loop[:, :2] for loop in loops])
        end = np.concatenate([np.roll(loop[:, :2], -1, axis=0) for loop in loops])
        bulge = np.concatenate([loop[:, 2] for loop in loops])
        number = np.concatenate([np.full(len(loop), k) for k, loop in enumerate(loops)])
        return cls(Curves.of(start, end, bulge), number)

    def distance(self, points: Floats) -> Floats:
        """(N,) distances in mm of points (N, 2) from the nearest edge."""
        parts = split(len(points), len(self.edges))
        found = [self.edges.distances(points[None, part]).min(axis=0) for part in parts]
        return np.concatenate([np.zeros(0), *found])

    def encloses(self, points: Floats) -> Mask:
        """(N,) whether points (N, 2), none of them on an edge, lie within a loop.

        The angles that the chords turn around a point, and a whole turn for each arc between which and its
        chord the point lies, add up to a whole turn for each loop around it.
        """
        edges, found = self.edges, [np.zeros(0, np.bool_)]
        side = np.where(edges.is_arc, np.sign(edges.bulge), 0.0)
        for part in split(len(points), len(edges)):
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


def box_around(border: Border) -> tuple[float, float, float, float]:
    """The smallest and the largest x and y of a border, in mm."""
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


def split(count: int, width: int) -> list[slice]:
    """Slices of so many rows that each has no more than some numbers."""
    step = max(AT_ONCE // max(width, 1), 1)
    return [slice(k, k + step) for k in range(0, count, step)]


def find_stretches_in_stock(
    moves: Moves, tools: Mapping[int, Tool], stock: Stock, border: Border | None, asked: Mask
) -> Stretches:
    """The stretches of some moves on which their tools meet the stock.

    Parameters
    ----------
    border : of what is grown to the stock; None where only heights are known.
    asked : (M,) which moves.
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
        return Stretches(rows, first, last)
    which, low, high = near(
        Curves.of(moves.start[rows, :2], moves.end[rows, :2], moves.bulge[rows]), reach[rows], border
    )
    low, high = np.maximum(low, first[which]), np.minimum(high, last[which])
    long = high > low
    return Stretches(rows[which[long]], low[long], high[long])


def near(paths: Curves, reach: Floats, border: Border) -> tuple[Integers, Floats, Floats]:
    """The parts of paths within a border or nearer to it than some reach (N,) each.

    Numbers (K,) of the paths, rising, and the shares (K,) at which each part begins and ends.
    """
    half = paths.length / 2
    middle = paths.at(np.full((len(paths), 1), 0.5))[:, 0]
    away = np.full(len(paths), inf)
    x0, y0, x1, y1 = box_around(border)
    off = np.maximum([x0, y0] - middle, middle - [x1, y1])
    close = np.flatnonzero(np.hypot(*np.maximum(off, 0.0).T) <= reach + half)
    away[close] = border.distance(middle[close])
    whole = away < reach - half
    # Of what lies deep enough on one side of the border the middle says which side that is.
    deep = np.flatnonzero(~whole & np.isfinite(away) & (away > half))
    whole[deep] = border.encloses(middle[deep])
    mixed = np.flatnonzero(~whole & (away <= reach + half))
    which, low, high = parts_of(paths, reach, border, mixed)
    sure = np.flatnonzero(whole)
    which = np.concatenate([sure, which])
    low, high = np.concatenate([np.zeros(len(sure)), low]), np.concatenate([np.ones(len(sure)), high])
    order = np.lexsort((low, which))
    return which[order], low[order], high[order]


def parts_of(
    paths: Curves, reach: Floats, border: Border, mixed: Integers
) -> tuple[Integers, Floats, Floats]:
    """The parts of those paths of which one may be within reach and another not, see :func:`near`."""
    which, low, high = [np.zeros(0, np.int64)], [np.zeros(0)], [np.zeros(0)]
    half = paths.length / 2
    for part in split(len(mixed), len(border.edges) * 16):
        rows = mixed[part]
        middle = paths.take(rows).at(np.full((len(rows), 1), 0.5))[:, 0]
        distance = border.edges.distances(middle[None])
        edge, own = np.nonzero(distance <= (reach + half)[rows])
        pairs = paths.take(rows[own])
        one, other, pair = covered(pairs, border.edges.take(edge), reach[rows[own]])
        own, one, other = merged(own[pair], one, other)
        gap, begin, finish = gaps(len(rows), own, one, other)
        between = paths.take(rows[gap]).at(((begin + finish) / 2)[:, None])[:, 0]
        inside = border.encloses(between)
        own, one, other = merged(
            np.concatenate([own, gap[inside]]),
            np.concatenate([one, begin[inside]]),
            np.concatenate([other, finish[inside]]),
        )
        which.append(rows[own])
        low.append(one)
        high.append(other)
    return np.concatenate(which), np.concatenate(low), np.concatenate(high)


def covered(paths: Curves, edges: Curves, reach: Floats) -> tuple[Floats, Floats, Integers]:
    """The parts of paths (P,) nearer to an edge of their own than a reach (P,): shares of their ends (K,), and
    of which pair (K,) each is."""
    chord = edges.end - edges.start
    size = np.hypot(*chord.T)
    normal = np.stack([-chord[:, 1], chord[:, 0]], axis=1) / np.where(size > 0.0, size, 1.0)[:, None]
    level = (normal * edges.start).sum(axis=1)
    straight = ~edges.is_arc & (size > 0.0)
    cuts = [on_circle(paths, edges.start, reach), on_circle(paths, edges.end, reach)]
    cuts += [on_line(paths, normal, np.where(straight, level + way * reach, np.nan)) for way in (-1.0, 1.0)]
    for radius in (edges.radius + reach, np.abs(edges.radius - reach)):
        cuts.append(on_circle(paths, edges.center, np.where(edges.is_arc, radius, np.nan)))
    found = np.hstack(cuts)
    found = np.where((found > 0.0) & (found < 1.0), found, 1.0)
    count = len(reach)
    shares = np.sort(np.hstack([np.zeros((count, 1)), found, np.ones((count, 1))]), axis=1)
    middle = (shares[:, 1:] + shares[:, :-1]) / 2
    inside = edges.distances(paths.at(middle)) < reach[:, None]
    pair, number = np.nonzero(inside & (shares[:, 1:] > shares[:, :-1]))
    return shares[pair, number], shares[pair, number + 1], pair


def on_circle(paths: Curves, center: Floats, radius: Floats) -> Floats:
    """Shares (P, 2) at which paths meet circles; NaN where they do not."""
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
    bent = share_of(paths, np.stack([middle - spread, middle + spread], axis=1))
    return np.where(paths.is_arc[:, None], bent, straight)


def on_line(paths: Curves, normal: Floats, level: Floats) -> Floats:
    """Shares (P, 2) at which paths meet lines normal · x = level; NaN where they do not."""
    with np.errstate(invalid="ignore", divide="ignore"):
        place = (level - (normal * paths.start).sum(axis=1)) / (normal * (paths.end - paths.start)).sum(
            axis=1
        )
        spread = np.arccos((level - (normal * paths.center).sum(axis=1)) / paths.radius)
    straight = np.stack([place, np.full(len(place), np.nan)], axis=1)
    middle = np.arctan2(normal[:, 1], normal[:, 0])
    bent = share_of(paths, np.stack([middle - spread, middle + spread], axis=1))
    return np.where(paths.is_arc[:, None], bent, straight)


def share_of(paths: Curves, angle: Floats) -> Floats:
    """Shares (P, C) of arcs at which they are at angles (P, C) about their centres; more than 1 where never."""
    with np.errstate(invalid="ignore", divide="ignore"):
        ahead = np.mod((angle - paths.turn[:, None]) * np.sign(paths.sweep)[:, None], 2 * pi)
        return np.asarray(ahead / np.abs(paths.sweep)[:, None])


def merged(own: Integers, low: Floats, high: Floats) -> tuple[Integers, Floats, Floats]:
    """Parts of paths, those of one path that meet as one, in the order of paths and along them."""
    order = np.lexsort((low, own))
    own, low, high = own[order], low[order], high[order]
    if not len(own):
        return own, low, high
    # Shares of one path are at most 1, so that what ends before says nothing of the next one.
    reached = np.maximum.accumulate(high + 2.0 * own) - 2.0 * own
    fresh = np.concatenate([[True], (own[1:] > own[:-1]) | (low[1:] > reached[:-1] + SAME_SHARE)])
    first = np.flatnonzero(fresh)
    return own[first], low[first], np.maximum.reduceat(high, first)


def gaps(count: int, own: Integers, low: Floats, high: Floats) -> tuple[Integers, Floats, Floats]:
    """What merged parts leave of so many paths: their numbers, and where each gap begins and ends."""
    every = np.arange(count)
    ends = np.concatenate([every, own]), np.concatenate([np.zeros(count), high])
    begins = np.concatenate([own, every]), np.concatenate([low, np.ones(count)])
    order, other = np.lexsort(ends[::-1]), np.lexsort(begins[::-1])
    number, begin, finish = ends[0][order], ends[1][order], begins[1][other]
    wide = finish > begin + SAME_SHARE
    return number[wide], begin[wide], finish[wide]
