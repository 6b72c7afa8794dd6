"""Chords and contacts at 200 bits (python-flint), straight from their definition, to hold the kernels' bounds against.

Features, lengths and orientations are the rational numbers that their floats are; a line's direction is scaled to one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from attrs import frozen
from flint import arb, arb_mat, ctx

__all__ = [
    "BITS",
    "ExactChord",
    "exact_chord",
    "exact_distance",
    "exact_solution",
    "exact_speed",
    "exactly",
    "within",
]

BITS = 200
Row = Sequence[float]
Point = tuple[arb, arb]


@contextmanager
def exactly(bits: int = BITS) -> Iterator[None]:
    """Work at a precision of so many bits."""
    with ctx.workprec(bits):
        yield


def within(one: Any, two: Any, bound: float) -> bool:
    """Whether two numbers certainly differ by no more than a bound."""
    return bool(abs(arb(one) - arb(two)) <= arb(bound))


def cross(a: Point, b: Point) -> arb:
    """Cross product of two vectors."""
    return a[0] * b[1] - a[1] * b[0]


def dot(a: Point, b: Point) -> arb:
    """Inner product of two vectors."""
    return a[0] * b[0] + a[1] * b[1]


def tangent(row: Row) -> Point:
    """Unit tangent of a line, or the unit vector to the middle of an arc."""
    x, y = arb(float(row[3])), arb(float(row[4]))
    size = (x * x + y * y).sqrt()
    return x / size, y / size


def middle(row: Row) -> Point:
    """Middle of a line or centre of an arc."""
    return arb(float(row[1])) + float(row[8]), arb(float(row[2])) + float(row[9])


def minus(a: Point, b: Point) -> Point:
    """Difference of two vectors."""
    return a[0] - b[0], a[1] - b[1]


def plus(a: Point, b: Point, scale: Any = 1) -> Point:
    """a + scale b."""
    return a[0] + scale * b[0], a[1] + scale * b[1]


@frozen(eq=False)
class ExactChord:
    """A chord: tail, both contact directions, the step from tail to head, and the tail's feature."""

    tail: Point
    along_a: Point
    along_b: Point
    step: Point
    row: Row

    def height(self, psi: arb) -> tuple[arb, arb]:
        """h = y . u and h' = -x . P."""
        x = (psi.cos(), psi.sin())
        return cross(x, self.tail), -dot(x, self.center())

    def position(self) -> tuple[arb, arb]:
        """The tail's parameter s on its feature, and s' = -p (over R on an arc)."""
        delta, t = minus(self.tail, middle(self.row)), tangent(self.row)
        if self.row[0] == 0.0:
            return dot(delta, t), -self.tail_distance()
        return arb.atan2(cross(t, delta), dot(t, delta)), -self.tail_distance() / float(self.row[6])

    def center(self) -> Point:
        """P, the instant centre."""
        return plus(self.tail, self.along_a, self.tail_distance())

    def turn(self) -> arb:
        """X, the cross product of the contact directions."""
        return cross(self.along_a, self.along_b)

    def tail_distance(self) -> arb:
        """p, from the tail to the instant centre."""
        return cross(self.step, self.along_b) / self.turn()


def exact_chord(a: Row, b: Row, d: float, alpha: arb, branch: float) -> ExactChord | None:
    """The chord of length d and direction alpha on a branch; None where there is none, or none can be told from one."""
    step = (d * alpha.cos(), d * alpha.sin())
    center_a, center_b, t_a, t_b = middle(a), middle(b), tangent(a), tangent(b)
    if a[0] == 0.0 and b[0] == 0.0:
        n = (t_b[1], -t_b[0])
        s = dot(n, minus(minus(center_b, center_a), step)) / dot(n, t_a)
        return ExactChord(plus(center_a, t_a, s), (t_a[1], -t_a[0]), n, step, a)
    if a[0] != 0.0 and b[0] != 0.0:
        radius, other = arb(float(a[6])), arb(float(b[6]))
        gap = minus(minus(center_b, center_a), step)
        size = dot(gap, gap).sqrt()
        if not size > 0:
            return None
        way = (gap[0] / size, gap[1] / size)
        reach = (size + (radius * radius - other * other) / size) / 2
        square = radius * radius - reach * reach
        if not square > 0:
            return None
        r = plus((reach * way[0], reach * way[1]), (-way[1], way[0]), branch * square.sqrt())
        q = minus(r, gap)
        return ExactChord(
            plus(center_a, r), (r[0] / radius, r[1] / radius), (q[0] / other, q[1] / other), step, a
        )
    # The line's peg, moved onto the arc's, lies where a line cuts the arc's circle.
    line_first = a[0] == 0.0
    start, t, center, radius = (
        (plus(center_a, step), t_a, center_b, arb(float(b[6])))
        if line_first
        else (minus(center_b, step), t_b, center_a, arb(float(a[6])))
    )
    n = (t[1], -t[0])
    across = dot(n, minus(start, center))
    square = radius * radius - across * across
    if not square > 0:
        return None
    r = plus((across * n[0], across * n[1]), t, branch * square.sqrt())
    on_arc, touched = plus(center, r), (r[0] / radius, r[1] / radius)
    if line_first:
        return ExactChord(minus(on_arc, step), n, touched, step, a)
    return ExactChord(on_arc, touched, n, step, a)


def exact_distance(row: Row, point: Point) -> arb:
    """Distance of a point from the line or circle that carries a feature."""
    delta, t = minus(point, middle(row)), tangent(row)
    if row[0] == 0.0:
        return abs(cross(t, delta))
    return abs(dot(delta, delta).sqrt() - float(row[6]))


def exact_speed(a: Row, b: Row, d: float, alpha: arb, branch: float) -> Point | None:
    """P', the instant centre's derivative over the direction, by a central difference; None where there is no chord.

    The step is 2^-100, of chords at 400 bits: the difference is exact to 60 bits even 1e-12 radians from a tangency.
    """
    step = arb(2) ** -100
    with exactly(400):
        one, two = (exact_chord(a, b, d, alpha + sign * step, branch) for sign in (-1, 1))
        if one is None or two is None:
            return None
        rise = minus(two.center(), one.center())
        return rise[0] / (2 * step), rise[1] / (2 * step)


def exact_solution(
    rows: Sequence[Row], offsets: Sequence[Sequence[float]], slides: Sequence[float], start: Sequence[float]
) -> list[arb] | None:
    """Newton's method on the four contact equations in (psi, tail x, tail y, apart); None if it does not converge."""
    z = [arb(float(v)) for v in start]
    for _ in range(60):
        values, slopes = equations(rows, offsets, slides, z)
        try:
            step = arb_mat(slopes).solve(arb_mat(4, 1, values))
        except ZeroDivisionError:
            return None
        z = [(v - step[k, 0]).mid() for k, v in enumerate(z)]
        if all(abs(step[k, 0]) < arb(2) ** (-BITS // 2) for k in range(4)):
            return z
    return None


def equations(
    rows: Sequence[Row], offsets: Sequence[Sequence[float]], slides: Sequence[float], z: Sequence[arb]
) -> tuple[list[arb], list[list[arb]]]:
    """Signed distances of the pegs' centres from their features, and the derivatives over (psi, x, y, apart)."""
    psi, x, y, apart = z
    c, s = psi.cos(), psi.sin()
    values, slopes = [], []
    for row, offset, slide in zip(rows, offsets, slides, strict=True):
        reach = (float(offset[0]) + float(slide) * apart, arb(float(offset[1])))
        turned = (c * reach[0] - s * reach[1], s * reach[0] + c * reach[1])
        delta = minus((x + turned[0], y + turned[1]), middle(row))
        if row[0] == 0.0:
            t = tangent(row)
            n = (t[1], -t[0])
            values.append(dot(n, delta))
        else:
            size = dot(delta, delta).sqrt()
            n = (delta[0] / size, delta[1] / size)
            values.append(size - float(row[6]))
        slopes.append([n[1] * turned[0] - n[0] * turned[1], n[0], n[1], float(slide) * (n[0] * c + n[1] * s)])
    return values, slopes
