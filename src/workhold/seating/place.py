"""Whether a part in one pose covers the place that it covers in another, also turned over."""

from __future__ import annotations

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.contact.problem import centered
from workhold.geometry.segment import segment_rows
from workhold.kernels.base.distance import outline_distances
from workhold.model.workpiece import Workpiece

__all__ = ["Silhouette"]

Array = NDArray[np.float64]
# mm. Silhouettes that agree to this cover the same place.
SAME_PLACE = 1e-3
# Points looked at on each face.
POINTS = 9


@define(frozen=True, eq=False)
class Silhouette:
    """A part's outline about the centre of its box.

    Parameters
    ----------
    rows : (S, 10) faces.
    points : (M, 2) on them.
    """

    rows: Array
    points: Array

    @classmethod
    def of(cls, workpiece: Workpiece) -> Silhouette:
        """The outline of a part."""
        segments = [face.segment for face in workpiece.faces]
        rows = centered(segment_rows(segments), workpiece.center)
        points = [s.at(t) for s in segments for t in np.linspace(-s.half_extent, s.half_extent, POINTS)]
        return cls(rows, np.array(points) - workpiece.center)

    @property
    def arm(self) -> float:
        """Largest distance in mm of one of its points from the centre."""
        return float(np.hypot(*self.points.T).max())

    def covers_same(self, one: Array, other: Array, turned_over: bool) -> bool:
        """Whether the part in a configuration, and in another in which it may be turned over, covers one place."""
        points = self.points * ([-1.0, 1.0] if turned_over else [1.0, 1.0])
        c, s = np.cos(other[0] - one[0]), np.sin(other[0] - one[0])
        x, y = c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]
        c, s = np.cos(one[0]), np.sin(one[0])
        dx, dy = other[1] - one[1], other[2] - one[2]
        moved = np.stack([x + c * dx + s * dy, y + c * dy - s * dx], axis=1)
        return bool(outline_distances(moved, self.rows).max() <= SAME_PLACE)
