"""Turning vectors of the plane."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["rotated"]


def rotated(x: Any, y: Any, angle: Any) -> tuple[Any, Any]:
    """Vectors turned counter-clockwise by an angle in radians; numbers or arrays of them, of shapes that go together.

    >>> [round(float(v), 12) for v in rotated(3.0, 1.0, np.pi / 2)]
    [-1.0, 3.0]
    """
    cosine, sine = np.cos(angle), np.sin(angle)
    return cosine * x - sine * y, sine * x + cosine * y
