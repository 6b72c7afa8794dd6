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
    """Return triangles, counter-clockwise, as indices of vertices counted through all loops.

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
    """Return twice the signed area of a triangle, positive when it is counter-clockwise."""
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])


@define
class SweepLine:
    """A horizontal line that moves down over a polygon and finds diagonals that cut it into monotone pieces.

    Parameters
    ----------
    points : the vertices.
    after, before : index of each vertex's next and previous neighbour.
    sides : downward sides that the line crosses, from left to right, each as the index of its upper vertex.
    helpers : index of the helper vertex of each side.
    merges : indices of merge vertices above the line.
    diagonals : for a vertex, the other ends of its diagonals.
    """

    points: Sequence[Point]
    after: list[int] = field(factory=list)
    before: list[int] = field(factory=list)
    sides: list[int] = field(factory=list)
    helpers: dict[int, int] = field(factory=dict)
    merges: set[int] = field(factory=set)
    diagonals: dict[int, list[int]] = field(factory=dict)

    def run(self) -> None:
        """Move the line over all vertices from the top, and collect the diagonals."""
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
        """Insert the downward side that begins at a vertex, with that as its helper."""
        self.sides.insert(self.count_left_of(v), v)
        self.helpers[v] = v

    def end_side(self, side: int, v: int) -> None:
        """Remove a side that ends at vertex ``v``; join that to the helper if this is a merge vertex."""
        if self.helpers[side] in self.merges:
            self.add_diagonal(v, self.helpers[side])
        self.sides.remove(side)

    def help_left(self, v: int, is_split: bool) -> None:
        """Make a vertex the helper of the side to its left; join it to the old helper if needed."""
        side = self.sides[self.count_left_of(v) - 1]
        if is_split or self.helpers[side] in self.merges:
            self.add_diagonal(v, self.helpers[side])
        self.helpers[side] = v

    def count_left_of(self, v: int) -> int:
        """Return how many crossed sides are to the left of a vertex."""
        points, after = self.points, self.after
        return bisect_right(
            self.sides, 0, key=lambda side: compute_turn(points[side], points[after[side]], points[v]) <= 0
        )

    def add_diagonal(self, v: int, other: int) -> None:
        """Add a diagonal between two vertices."""
        self.diagonals.setdefault(v, []).append(other)
        self.diagonals.setdefault(other, []).append(v)

    def collect_pieces(self) -> list[list[int]]:
        """Return the monotone pieces, each as indices of vertices in running order."""
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
        """Return the vertex that follows v, reached from u, on the border of the piece to the left."""
        others = self.diagonals.get(v)
        if not others:
            return self.after[v]
        (x, y), points = self.points[v], self.points
        back = atan2(points[u][1] - y, points[u][0] - x)

        def clockwise(w: int) -> float:
            """Return the clockwise angle from the way back to a neighbour, in (0, 2 pi]."""
            return (back - atan2(points[w][1] - y, points[w][0] - x)) % tau or tau

        return min((w for w in (self.after[v], *others) if w != u), key=clockwise)


def triangulate_monotone_piece(piece: Sequence[int], points: Sequence[Point]) -> list[Triangle]:
    """Return triangles, counter-clockwise, of a polygon that every horizontal line meets in one span.

    ``piece`` are the indices of its vertices, counter-clockwise.
    """
    count = len(piece)
    order = sorted(range(count), key=lambda k: (-points[piece[k]][1], points[piece[k]][0], piece[k]))
    top, bottom = order[0], order[-1]
    # From the top counter-clockwise the left border comes first.
    length = (bottom - top) % count
    is_left = [(k - top) % count < length for k in range(count)]
    out: list[Triangle] = []

    def add(a: int, b: int, c: int, left: bool) -> None:
        """Add a triangle, oriented by the border that its first two vertices are on."""
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
