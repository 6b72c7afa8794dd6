"""Whether a part in one pose covers the place that it covers in another, also turned over."""

from __future__ import annotations

from functools import cached_property

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

    def cover_same(self, one: Array, others: Array, turned_over: bool) -> NDArray[np.bool_]:
        """Whether a part covers in configurations (N, 4), where it may be turned over, the place that it covers in one."""
        points = self.points * ([-1.0, 1.0] if turned_over else [1.0, 1.0])
        out = np.ones(len(others), np.bool_)
        # One point tells of most that they do not.
        for some in (points[:1], points):
            moved = seen_from(one, others[out], some)
            away = outline_distances(moved.reshape(-1, 2), self.rows).reshape(-1, len(some))
            out[out] = away.max(axis=1, initial=0.0) <= SAME_PLACE
        return out


def seen_from(one: Array, others: Array, points: Array) -> Array:
    """Points (M, 2) of the part in configurations (N, 4) as they lie on the part in one configuration: (N, M, 2)."""
    turn = others[:, :1] - one[0]
    c, s = np.cos(turn), np.sin(turn)
    x, y = c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]
    c, s = np.cos(one[0]), np.sin(one[0])
    dx, dy = others[:, 1:2] - one[1], others[:, 2:3] - one[2]
    return np.stack([x + c * dx + s * dy, y + c * dy - s * dx], axis=2)
