"""Surfaces turned about an upright axis: their folds and level cuts are circles, whatever is turned."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, pi
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import ALIGNED, SHORTEST
from workhold.files.step.crossings import crossing
from workhold.files.step.edge_curves import Found, Point3, curve_point, extremes, height
from workhold.geometry.segment import Arc

__all__ = ["is_upright", "turned_cuts", "turned_folds", "whole_circle"]

# Points along the curve that is turned.
SAMPLES = 65
Array = NDArray[np.float64]


def is_upright(axis: Any) -> bool:
    """Whether an axis of the library is parallel to z."""
    direction = axis.Direction()
    return hypot(direction.X(), direction.Y()) <= ALIGNED


def whole_circle(center: Any, radius: float) -> Arc:
    """A circle about a point of the library, seen from above."""
    return Arc((center.X(), center.Y()), radius, 0.0, pi, 1.0)


@frozen
class Meridian:
    """The curve that a surface turns about an upright axis, asked as the library's curves are.

    Parameters
    ----------
    surface : Open CASCADE's.
    """

    surface: Any

    def Value(self, parameter: float) -> Any:
        """The point at a parameter."""
        return self.surface.Value(self.surface.FirstUParameter(), parameter)

    @property
    def axis(self) -> Any:
        """A point of the axis."""
        return self.surface.AxeOfRevolution().Location()

    def radius(self, point: Point3) -> float:
        """The distance in mm of a point from the axis."""
        return hypot(point[0] - self.axis.X(), point[1] - self.axis.Y())

    def samples(self) -> tuple[Array, list[Point3]]:
        """Parameters (N,) from end to end, and the points there in mm."""
        parameters = np.linspace(self.surface.FirstVParameter(), self.surface.LastVParameter(), SAMPLES)
        return parameters, [curve_point(self, float(t)) for t in parameters]

    def circles(self, parameters: Sequence[float]) -> list[Found]:
        """The circles that some of its points run through."""
        radii = [self.radius(curve_point(self, t)) for t in parameters]
        return [whole_circle(self.axis, radius) for radius in radii if radius > SHORTEST]


def turned_folds(surface: Any) -> list[Found]:
    """The circles at which a turned surface is widest or narrowest around."""
    curve = Meridian(surface)
    parameters, points = curve.samples()
    return curve.circles(extremes(curve, parameters, [curve.radius(point) for point in points], curve.radius))


def turned_cuts(surface: Any, z: float) -> list[Found]:
    """The circles in which a turned surface passes a height."""
    curve = Meridian(surface)
    parameters, points = curve.samples()
    away = np.array([height(point) - z for point in points])

    def passed(k: int) -> float:
        sign = 1.0 if away[k] < 0 else -1.0
        low, high = ((float(parameters[m]), sign * float(away[m])) for m in (k, k + 1))
        return crossing(lambda t: sign * (height(curve_point(curve, t)) - z), low, high)

    return curve.circles([passed(int(k)) for k in np.flatnonzero((away[:-1] < 0) != (away[1:] < 0))])
