"""Triangulation of a polygon with holes, without additional vertices.

The polygon is cut by diagonals into pieces that are monotone in y, and these into triangles (de Berg et al.,
"Computational Geometry", chapter 3). Every side of the polygon is a side of one triangle and every diagonal
one of two, whatever rounding does.

Glossary
--------
split, merge : a vertex whose interior angle is more than a half turn with both neighbours below it, above it.
helper : of a side, the lowest vertex above that sees the side along a horizontal.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from itertools import pairwise
from math import atan2, tau

from attrs import define, field

from workhold.geometry.segment import Point

__all__ = ["triangulate"]

Triangle = tuple[int, int, int]


def triangulate(loops: Sequence[Sequence[Point]]) -> list[Triangle]:
    """Return counter-clockwise triangles that fill a polygon with holes, as triples of vertex indices.

    Vertices are numbered through all loops.

    Parameters
    ----------
    loops : vertices of the border in running order with the material on the left: outer loops
        counter-clockwise, holes clockwise; they meet nowhere.

    Examples
    --------
    >>> triangulate([[(0, 0), (2, 0), (2, 1), (0, 1)]])
    [(3, 0, 2), (2, 0, 1)]
    """
    sweep = SweepLine([point for loop in loops for point in loop])
    first = 0
    for loop in loops:
        count = len(loop)
        for k in range(count):
            sweep.after.append(first + (k + 1) % count)
            sweep.before.append(first + (k - 1) % count)
        first += count
    sweep.run()
    return [
        triangle
        for piece in sweep.collect_pieces()
        for triangle in triangulate_monotone_piece(piece, sweep.points)
    ]


def compute_turn(p: Point, q: Point, r: Point) -> float:
    """Return twice the signed area of the triangle p, q, r: positive for a counter-clockwise turn."""
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])


@define
class SweepLine:
    """A horizontal line that moves down over a polygon and finds diagonals that cut it into pieces monotone
    in y.

    Parameters
    ----------
    points : the vertices.
    after, before : for each vertex the index of the next and of the previous vertex on its loop.
    sides : the downward sides that the line crosses, from left to right, each given by the index of its upper
        vertex.
    helpers : for each of ``sides`` the lowest vertex above the line that sees the side along a horizontal.
    merges : indices of vertices passed whose interior angle is above a half turn, with both neighbours above
        them.
    diagonals : for each vertex, the other ends of its diagonals.
    """

    points: Sequence[Point]
    after: list[int] = field(factory=list)
    before: list[int] = field(factory=list)
    sides: list[int] = field(factory=list)
    helpers: dict[int, int] = field(factory=dict)
    merges: set[int] = field(factory=set)
    diagonals: dict[int, list[int]] = field(factory=dict)

    def run(self) -> None:
        """Move the line over all vertices from top to bottom, and collect the diagonals in ``diagonals``."""
        points = self.points
        order = sorted(range(len(points)), key=lambda k: (-points[k][1], points[k][0], k))
        place = {vertex: k for k, vertex in enumerate(order)}
        for v in order:
            before, after = self.before[v], self.after[v]
            comes_up, goes_down = place[before] > place[v], place[after] > place[v]
            is_reflex = compute_turn(points[before], points[v], points[after]) <= 0
            if not comes_up:
                self.end_side(before, v)
            if comes_up != goes_down:
                if comes_up:
                    self.help_left(v, is_split=False)
            elif is_reflex:
                self.help_left(v, is_split=goes_down)
                if not goes_down:
                    self.merges.add(v)
            if goes_down:
                self.begin_side(v)

    def begin_side(self, v: int) -> None:
        """Insert the side that runs down from vertex v into ``sides``; its helper is v."""
        self.sides.insert(self.count_left_of(v), v)
        self.helpers[v] = v

    def end_side(self, side: int, v: int) -> None:
        """Remove from ``sides`` a side that ends at vertex v.

        Where the side's helper is a merge vertex, add a diagonal from v to the helper.
        """
        if self.helpers[side] in self.merges:
            self.add_diagonal(v, self.helpers[side])
        self.sides.remove(side)

    def help_left(self, v: int, is_split: bool) -> None:
        """Make vertex v the helper of the side to its left.

        Where v is a split vertex or the old helper is a merge vertex, add a diagonal from v to the old
        helper.
        """
        side = self.sides[self.count_left_of(v) - 1]
        if is_split or self.helpers[side] in self.merges:
            self.add_diagonal(v, self.helpers[side])
        self.helpers[side] = v

    def count_left_of(self, v: int) -> int:
        """Return the number of ``sides`` to the left of vertex v."""
        points, after = self.points, self.after
        return bisect_right(
            self.sides, 0, key=lambda side: compute_turn(points[side], points[after[side]], points[v]) <= 0
        )

    def add_diagonal(self, v: int, other: int) -> None:
        """Add a diagonal between two vertices."""
        self.diagonals.setdefault(v, []).append(other)
        self.diagonals.setdefault(other, []).append(v)

    def collect_pieces(self) -> list[list[int]]:
        """Return the pieces into which the diagonals cut the polygon, each as vertex indices with the piece
        on the left.
        """
        ways = {(v, after) for v, after in enumerate(self.after)}
        ways |= {(v, other) for v, others in self.diagonals.items() for other in others}
        out: list[list[int]] = []
        for start in sorted(ways):
            if start not in ways:
                continue
            piece, way = [], start
            while way in ways:
                ways.discard(way)
                piece.append(way[0])
                way = (way[1], self.find_next_vertex(*way))
            out.append(piece)
        return out

    def find_next_vertex(self, u: int, v: int) -> int:
        """Return the vertex after v on the border of the piece that lies to the left of the way from u to
        v.
        """
        others = self.diagonals.get(v)
        if not others:
            return self.after[v]
        (x, y), points = self.points[v], self.points
        back = atan2(points[u][1] - y, points[u][0] - x)

        def measure_angle(w: int) -> float:
            """Return the clockwise angle in radians, in (0, 2 pi], from the direction v to u to the direction
            v to w.
            """
            return (back - atan2(points[w][1] - y, points[w][0] - x)) % tau or tau

        return min((w for w in (self.after[v], *others) if w != u), key=measure_angle)


def triangulate_monotone_piece(piece: Sequence[int], points: Sequence[Point]) -> list[Triangle]:
    """Return counter-clockwise triangles that fill a polygon monotone in y, as triples of vertex indices.

    Each horizontal line meets such a polygon in one stretch. ``piece`` are the indices of its vertices,
    counter-clockwise.
    """
    count = len(piece)
    order = sorted(range(count), key=lambda k: (-points[piece[k]][1], points[piece[k]][0], piece[k]))
    top, bottom = order[0], order[-1]
    # From the top counter-clockwise the left border comes first.
    length = (bottom - top) % count
    is_left = [(k - top) % count < length for k in range(count)]
    out: list[Triangle] = []

    def add(a: int, b: int, c: int, left: bool) -> None:
        """Add the triangle of the vertices at positions a, b, c of ``piece``.

        ``left`` says whether a and b are on the left border, which decides the order that is
        counter-clockwise.
        """
        ends = (piece[a], piece[b], piece[c])
        out.append(ends if left else (ends[0], ends[2], ends[1]))

    stack = order[:2]
    for j in range(2, count):
        k = order[j]
        if j == count - 1 or is_left[k] != is_left[stack[-1]]:
            # A vertex on the other border, or the last one, sees the whole stack.
            side = is_left[stack[-1]]
            for a, b in pairwise(stack):
                add(a, b, k, side)
            stack = [stack[-1], k]
            continue
        last = stack.pop()
        sign = 1.0 if is_left[k] else -1.0
        while (
            stack and sign * compute_turn(points[piece[stack[-1]]], points[piece[last]], points[piece[k]]) > 0
        ):
            add(stack[-1], last, k, is_left[k])
            last = stack.pop()
        stack += [last, k]
    return out
