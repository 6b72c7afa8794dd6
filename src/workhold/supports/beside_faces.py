"""What keeps the clamp on top away from places on its face: regions that have a height of such a face.

A head keeps off what rises above the face. A tip presses better where it keeps off what of the face hangs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.geometry.loop import loop_segments, signed_area
from workhold.supports.faces import Curve, FaceBorders, offset_curves

__all__ = ["LevelRegions"]

Array = NDArray[np.float64]


@define(frozen=True, eq=False)
class LevelRegions:
    """Regions by height in mm, each as its borders with the region on their left.

    Parameters
    ----------
    borders : of each height.
    turns : of each height (B,) 1 for borders around a region, -1 for its openings.
    """

    borders: dict[float, FaceBorders]
    turns: dict[float, Array]

    @classmethod
    def of(cls, loops: Sequence[Array], heights: Sequence[float]) -> LevelRegions:
        """The regions within loops of (x, y, bulge) vertices, each with its height."""
        borders, turns = {}, {}
        for height in dict.fromkeys(heights):
            own = [
                tuple(loop_segments(np.asarray(loop)))
                for loop, z in zip(loops, heights, strict=True)
                if z == height
            ]
            borders[height] = FaceBorders(tuple(own))
            turns[height] = np.array([1.0 if signed_area(loop) > 0.0 else -1.0 for loop in own])
        return cls(borders, turns)

    def apart(self, height: float | None, points: Array) -> Array:
        """Distances (N,) in mm of points (N, 2) from the region of a height, negative in it."""
        if height is None or height not in self.borders:
            return np.full(len(points), np.inf)
        signed = self.borders[height].inside(points)
        is_in = (signed > 0.0) @ self.turns[height] > 0.5
        return np.asarray(np.where(is_in, -1.0, 1.0) * np.abs(signed).min(axis=1, initial=np.inf))

    def offset_curves(self, height: float | None, radius: float) -> Iterator[tuple[list[Curve], list[Curve]]]:
        """Lines and circles of :func:`offset_curves` on which the middle of a disc beside a region is."""
        if height is not None and height in self.borders:
            for loop in self.borders[height].loops:
                yield offset_curves(loop, radius, left=False)
