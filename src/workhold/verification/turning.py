"""Which rotations carry a workpiece onto itself, told from the marks of its faces alone.

The rotations of order n carry the faces that are not about the kept point in cycles of n, so n divides their number; and the
mean of the faces' middles is that point. Each such part of a turn is tried, the smallest first. What a drawing has to
``SAME`` is taken for symmetric, so of one that misses it by about as much it cannot be told.
"""

from __future__ import annotations

from math import pi, tau

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.geometry.segment import Arc, Point, Segment
from workhold.model.workpiece import Workpiece
from workhold.verification.rules import SAME

__all__ = ["Turning"]

# By how many times SAME faces may miss their images where it is certain, and at most, that they are meant to meet them.
CERTAIN, PERHAPS = 0.25, 4.0


@frozen
class Turning:
    """The rotations of a workpiece onto itself.

    Parameters
    ----------
    order : how many there are at most, the identity included; 1 for concentric circles, which turn at every angle.
    center : the point in mm that they keep.
    is_certain : whether there certainly are as many.
    """

    order: int
    center: Point
    is_certain: bool

    @classmethod
    def of(cls, workpiece: Workpiece) -> Turning:
        """Those of a workpiece."""
        marks = np.array([marks_of(face.segment) for face in workpiece.faces])
        center = marks[:, 0].mean()
        marks[:, :3] -= center
        most = order_of(marks, PERHAPS * SAME)
        least = most if most == 1 else order_of(marks, CERTAIN * SAME)
        return cls(most, (float(center.real), float(center.imag)), least == most)

    @property
    def angles(self) -> list[float]:
        """In radians, the identity left out."""
        return [tau * k / self.order for k in range(1, self.order)]


def marks_of(face: Segment) -> list[complex]:
    """Middle, start and end of a face, or three times the centre of a whole circle; and its radius, below 0 in a hollow."""
    radius = face.sign * face.radius if isinstance(face, Arc) else 0.0
    points = [face.center] * 3 if isinstance(face, Arc) and face.is_full else [face.at(0.0), face.start, face.end]
    return [*(complex(*point) for point in points), complex(radius)]


def order_of(marks: NDArray[np.complex128], off: float) -> int:
    """The most rotations that carry each of the marks (N, 4) about 0 to within so many mm of others."""
    outer = marks[np.abs(marks[:, 0]) > off]
    orders = (n for n in range(len(outer), 1, -1) if len(outer) % n == 0)
    return next((n for n in orders if all(has_image(one, n, outer, off) for one in outer)), 1)


def has_image(one: NDArray[np.complex128], order: int, marks: NDArray[np.complex128], off: float) -> bool:
    """Whether one of the marks (N, 4) is where a part of a turn carries some (4,)."""
    turned = one * np.array([*[np.exp(2j * pi / order)] * 3, 1.0])
    return bool((np.abs(marks - turned).max(axis=1) <= off).any())
