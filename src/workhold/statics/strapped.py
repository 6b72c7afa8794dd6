"""The strap force that loads require, for a part that locators place and straps press down.

Each strap's tip presses with the same force F; its friction acts at a point and is at most the coefficient
times F. Below, the part lies (a) on supports, which are points that press upward with friction, or (b) with
its foot on the plate, which presses with a pressure that is affine over the foot, with friction in each of
its cells. Locators push inward without friction, at any height of their bands, and each may let go. How F is
computed, and why it is safe, is in :mod:`workhold.statics.friction`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import pi

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.statics.friction import DIRECTIONS
from workhold.statics.patches import PressedPolygon

__all__ = ["PressingTips", "StrappedPart", "StrapsOnPart"]

Array = NDArray[np.float64]


@frozen(eq=False)
class StrappedPart:
    """A part against locators, without any straps yet; in the plate's
    frame, with z = 0 at the part's lower side.

    Parameters
    ----------
    touched : (L, 2) points in mm at which the L locators touch the part.
    inward : (L, 2) unit vectors along which the locators push.
    bands : (L, 2) lowest and highest height in mm at which each locator may push.
    below : the part's foot, or the points (S, 2) in mm of the S supports under it.
    friction : coefficient of friction between the part and its rest below.
    """

    touched: Array
    inward: Array
    bands: Array
    below: PressedPolygon | Array
    friction: float

    @cached_property
    def centre(self) -> Array:
        """Point (3,) in mm that moments are taken about."""
        return np.array([*self.touched.mean(axis=0), float(self.bands.max()) / 2])

    @cached_property
    def length(self) -> float:
        """Length in mm that moments are divided by."""
        return float(max(np.ptp(self.touched, axis=0).max(), self.bands.max(), 1.0) / 2)

    def compute_wrenches(self, points: Array, forces: Array) -> Array:
        """Return wrenches (N, 6) of forces (N, 3) in N at points (N, 3) in mm.

        A wrench is the force, then its moment about ``centre``, divided by ``length``.
        """
        return np.hstack([forces, np.cross(points - self.centre, forces) / self.length])

    def compute_level_wrenches(
        self, points: Array, height: float | Array, force: tuple[float, float, float]
    ) -> Array:
        """Return wrenches (N, 6) of the same force (3,) at N points.

        ``points`` (N, 2) are x and y in mm; ``height`` in mm is one for all, or one for each (N,).
        """
        places = np.column_stack([points, np.broadcast_to(height, len(points))])
        return self.compute_wrenches(places, np.tile(force, (len(points), 1)))

    def compute_friction_wrenches(self, points: Array, height: float | Array) -> Array:
        """Return wrenches (N, 16, 6) of a horizontal force of 1 N at N points, in 16 directions.

        ``points`` and ``height`` are as in :meth:`compute_level_wrenches`.
        """
        turns = 2 * pi / DIRECTIONS * np.arange(DIRECTIONS)
        rows = [
            self.compute_level_wrenches(points, height, (np.cos(turn), np.sin(turn), 0.0)) for turn in turns
        ]
        return np.stack(rows, axis=1)

    @cached_property
    def pushing(self) -> Array:
        """Wrenches (2 L, 6) of unit forces of the L locators, at both ends of their bands."""
        ways = np.column_stack([self.inward, np.zeros(len(self.inward))])
        ends = [np.column_stack([self.touched, self.bands[:, k]]) for k in (0, 1)]
        return np.vstack([self.compute_wrenches(points, ways) for points in ends])

    @cached_property
    def pressure_wrenches_below(self) -> Array:
        """Wrenches (R, 6) of the R unit pressures from below."""
        points = self.below.centres if isinstance(self.below, PressedPolygon) else self.below
        return self.compute_level_wrenches(points, 0.0, (0.0, 0.0, 1.0))

    @cached_property
    def friction_wrenches_below(self) -> Array:
        """Wrenches (C, 16, 6) of unit friction forces from below: in each
        of C cells or supports, in 16 directions.
        """
        points = self.below.cells.centre if isinstance(self.below, PressedPolygon) else self.below
        return self.compute_friction_wrenches(points, 0.0)

    @cached_property
    def bearing_below(self) -> Array:
        """Largest friction force (C, R) of each of the C cells or supports below, per unit of each of the R
        pressures.
        """
        if not isinstance(self.below, PressedPolygon):
            return self.friction * np.eye(len(self.below))
        cells = self.below.cells
        return np.asarray(self.friction * (self.below.compute_pressures(cells.centre) * cells.area).T)


@frozen(eq=False)
class PressingTips:
    """The N places at which tips may press on a part, and the forces of a tip there.

    Parameters
    ----------
    part : the part without straps.
    at : (N, 2) points of the tips in mm.
    heights : (N,) heights of the faces under them in mm, above the part's lower side.
    coefficient : coefficient of friction between a tip and the part.
    """

    part: StrappedPart
    at: Array
    heights: Array
    coefficient: float

    @cached_property
    def down(self) -> Array:
        """Wrenches (N, 6) of a tip that presses down with 1 N at each place."""
        return self.part.compute_level_wrenches(self.at, self.heights, (0.0, 0.0, -1.0))

    @cached_property
    def friction(self) -> Array:
        """Wrenches (N, 16, 6) of a friction force of 1 N on the part at each place, in 16 directions."""
        return self.part.compute_friction_wrenches(self.at, self.heights)

    def press(self, chosen: Sequence[int], part: StrappedPart | None = None) -> StrapsOnPart:
        """Return a part with straps at the places of these indices; ``part`` None stands for this object's
        own part.
        """
        numbers = list(chosen)
        return StrapsOnPart(part or self.part, self.down[numbers], self.friction[numbers], self.coefficient)

    def compute_work(self, motion: Array) -> Array:
        """Return the work (N,) that a tip at each place does on a motion (6,), friction included, per N of
        force.
        """
        rubbed = (self.friction @ motion).max(axis=1, initial=0.0)
        return np.asarray(self.down @ motion + self.coefficient * rubbed)


@frozen(eq=False)
class StrapsOnPart:
    """A part with straps, ready for the linear programs of its loads (``statics.friction.HeldByFriction``).

    Parameters
    ----------
    part : the part without the straps.
    down : (K, 6) wrenches of the unit forces with which the K tips press down.
    tip_friction : (K, 16, 6) wrenches of unit friction forces at each tip, in 16 directions.
    friction : coefficient of friction between tips and part.
    """

    part: StrappedPart
    down: Array
    tip_friction: Array
    friction: float

    @property
    def centre(self) -> Array:
        """Point (3,) in mm that moments are taken about."""
        return self.part.centre

    @property
    def length(self) -> float:
        """Length in mm that moments are divided by."""
        return self.part.length

    def compute_wrenches(self, points: Array, forces: Array) -> Array:
        """Return wrenches (N, 6) of forces (N, 3) in N at points (N, 3) in
        mm; see :meth:`StrappedPart.compute_wrenches`.
        """
        return self.part.compute_wrenches(points, forces)

    @property
    def pushing(self) -> Array:
        """Wrenches (2 L, 6) of unit forces of the L locators."""
        return self.part.pushing

    @cached_property
    def pressing(self) -> Array:
        """Wrenches (R + 1, 6): of the R unit pressures below, then of
        all tips together pressing with 1 N each.
        """
        return np.vstack([self.part.pressure_wrenches_below, self.down.sum(axis=0)])

    @cached_property
    def rubbing(self) -> Array:
        """Wrenches (C + K, 16, 6) of unit friction forces in 16
        directions: in the C cells below, then at the K tips.
        """
        return np.concatenate([self.part.friction_wrenches_below, self.tip_friction])

    @cached_property
    def bearing(self) -> Array:
        """Largest friction force (C + K, R + 1) of each cell below and each tip, per unit of each row of
        ``pressing``.
        """
        below = self.part.bearing_below
        out = np.zeros((len(below) + len(self.down), below.shape[1] + 1))
        out[: len(below), :-1], out[len(below) :, -1] = below, self.friction
        return out

    @cached_property
    def clamp_force_per_pressure(self) -> Array:
        """Force of each strap, (R + 1,), per unit of each row of ``pressing``: 1 for the tips, else 0."""
        return np.asarray(np.eye(1, len(self.pressing), len(self.pressing) - 1)[0])
