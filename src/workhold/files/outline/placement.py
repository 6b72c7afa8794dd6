"""Plane affine maps that place a block or a group in its drawing."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot

from attrs import frozen

from workhold.conventions import CIRCULAR
from workhold.geometry.segment import Point

__all__ = ["Placement"]


@frozen
class Placement:
    """The map x' = a x + c y + e, y' = b x + d y + f, z' = height_scale z + height (the letters of an SVG matrix)."""

    a: float = 1.0
    b: float = 0.0
    c: float = 0.0
    d: float = 1.0
    e: float = 0.0
    f: float = 0.0
    height_scale: float = 1.0
    height: float = 0.0

    def __call__(self, point: Sequence[float]) -> Point:
        """The image of the x and y of a point."""
        x, y = point[0], point[1]
        return (self.a * x + self.c * y + self.e, self.b * x + self.d * y + self.f)

    def after(self, inner: Placement) -> Placement:
        """The map that applies ``inner`` first and then this one."""
        e, f = self((inner.e, inner.f))
        return Placement(
            self.a * inner.a + self.c * inner.b,
            self.b * inner.a + self.d * inner.b,
            self.a * inner.c + self.c * inner.d,
            self.b * inner.c + self.d * inner.d,
            e,
            f,
            self.height_scale * inner.height_scale,
            self.height_scale * inner.height + self.height,
        )

    @property
    def determinant(self) -> float:
        """Factor on areas; negative for a mirror image."""
        return self.a * self.d - self.b * self.c

    @property
    def flat(self) -> bool:
        """Whether the map crushes the plane onto a line or a point."""
        first, second = hypot(self.a, self.b), hypot(self.c, self.d)
        return not abs(self.determinant) > 1e-12 * max(first, second) ** 2

    @property
    def keeps_circles(self) -> bool:
        """Whether circles stay circles."""
        first, second = hypot(self.a, self.b), hypot(self.c, self.d)
        slack = CIRCULAR * max(first, second)
        return abs(first - second) <= slack and abs(self.a * self.c + self.b * self.d) <= slack * max(first, second)

    def bulges(self, bulges: Sequence[float]) -> tuple[float, ...]:
        """Bulges of the image of a chain: a mirror image turns every arc's sense."""
        return tuple(-b if b else 0.0 for b in bulges) if self.determinant < 0 else tuple(bulges)
