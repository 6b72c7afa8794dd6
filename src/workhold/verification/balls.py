"""Ball arithmetic: numbers known to lie within a radius of a midpoint (python-flint's ``arb``).

Every operation rounds outward, so that a comparison that holds for a ball holds for the number inside. ``a > b`` is true
only when it is certain; that ``a > b`` and ``a <= b`` are both false means "undecided at this precision".

Glossary
--------
exact : a float is a rational number, and a ball of radius 0 holds it.
hull : the smallest ball around two balls; it also holds every number between them.

References
----------
F. Johansson, "Arb: efficient arbitrary-precision midpoint-radius interval arithmetic", IEEE Transactions on Computers 66
(2017) 1281-1292. S. M. Rump, "Verification methods: rigorous results using floating-point arithmetic", Acta Numerica 19
(2010) 287-449.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb

__all__ = ["PRECISIONS", "Point", "cross", "dot", "exact_point", "largest", "least", "norm", "root", "turned"]

Point = tuple[arb, arb]

# Bits of the midpoints; the next is tried when one leaves something undecided.
PRECISIONS = (128, 256, 512)


def exact_point(x: float, y: float) -> Point:
    """A point given by floats."""
    return arb(x), arb(y)


def dot(a: Point, b: Point) -> arb:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1]


def cross(a: Point, b: Point) -> arb:
    """Third component of the vector product."""
    return a[0] * b[1] - a[1] * b[0]


def root(square: arb) -> arb:
    """Square root of a number that is not negative, though its ball may reach below 0."""
    return square.sqrt() if square > 0 else arb(0).union(square.abs_upper().sqrt())


def norm(a: Point) -> arb:
    """Length of a vector, also where the ball holds the null vector."""
    return root(dot(a, a))


def turned(a: Point, cosine: arb, sine: arb) -> Point:
    """A vector turned counter-clockwise."""
    return cosine * a[0] - sine * a[1], sine * a[0] + cosine * a[1]


def least(values: Sequence[arb]) -> arb:
    """The smallest of some numbers."""
    found = values[0]
    for value in values[1:]:
        found = found.min(value)
    return found


def largest(values: Sequence[arb]) -> arb:
    """The largest of some numbers."""
    return -least([-value for value in values])
