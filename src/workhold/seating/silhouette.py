"""Whether a part in one pose covers the place that it covers in another, also turned over."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.contact.problem import centered
from workhold.geometry.segment import segment_rows
from workhold.kernels.seating.silhouettes import cover_same
from workhold.model.workpiece import Workpiece

__all__ = ["Silhouette"]

Array = NDArray[np.float64]
# mm. Silhouettes that agree to this cover the same place.
SAME_PLACE = 1e-3
# Points looked at on each face.
POINTS = 9


@define(frozen=True, eq=False, slots=False)
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

    @cached_property
    def arm(self) -> float:
        """Largest distance in mm of one of its points from the centre."""
        return float(np.hypot(*self.points.T).max())

    def cover_same(self, one: Array, others: Array, turned_over: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether a part, perhaps turned over (N,), covers in configurations (N, 4) the place that it covers in one."""
        out = np.empty(len(others), np.int8)
        cover_same(one, others, turned_over.astype(np.int8), self.rows, self.points, SAME_PLACE, out)
        return out.astype(np.bool_)
