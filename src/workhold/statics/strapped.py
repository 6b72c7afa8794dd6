"""The strap force that loads ask for, of a part that locators place and straps press down.

Each tip presses with the same force F and bears friction at a point, at most the coefficient times F. Below, the part
bears on supports, points that press upward with friction, or with its foot on the plate: a pressure that is affine on
it, with friction in each of its cells. Locators push inward without friction, at any height of their bands, and each
may let go. What F is, and why it is safe, says :mod:`workhold.statics.friction`.
"""

from __future__ import annotations

from functools import cached_property
from math import pi

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.statics.friction import DIRECTIONS
from workhold.statics.patches import PressedPolygon

__all__ = ["StrappedPart", "StrapsOnPart"]

Array = NDArray[np.float64]


@frozen(eq=False)
class StrappedPart:
    """A part against locators, before any strap presses; in the plate's frame, z 0 at the part's lower side.

    Parameters
    ----------
    touched : (L, 2) in mm, where the locators touch it.
    inward : (L, 2) unit vectors, in which they push.
    bands : (L, 2) the heights in mm between which each may push.
    below : the part's foot, or points (S, 2) in mm on supports.
    friction : of what is below.
    """

    touched: Array
    inward: Array
    bands: Array
    below: PressedPolygon | Array
    friction: float

    @cached_property
    def centre(self) -> Array:
        """What moments are taken about, in mm."""
        return np.array([*self.touched.mean(axis=0), float(self.bands.max()) / 2])

    @cached_property
    def length(self) -> float:
        """What moments are divided by, in mm."""
        return float(max(np.ptp(self.touched, axis=0).max(), self.bands.max(), 1.0) / 2)

    def compute_wrenches(self, points: Array, forces: Array) -> Array:
        """Return wrenches (N, 6) of forces (N, 3) at points (N, 3) in mm, moments over the length."""
        return np.hstack([forces, np.cross(points - self.centre, forces) / self.length])

    def compute_level_wrenches(
        self, points: Array, height: float | Array, force: tuple[float, float, float]
    ) -> Array:
        """Return wrenches (N, 6) of one force at points (N, 2), all of a height or each of its own (N,), in mm."""
        places = np.column_stack([points, np.broadcast_to(height, len(points))])
        return self.compute_wrenches(places, np.tile(force, (len(points), 1)))

    def compute_friction_wrenches(self, points: Array, height: float | Array) -> Array:
        """Return wrenches (N, 16, 6) of friction of 1 N in each direction; points as of
        :meth:`compute_level_wrenches`.
        """
        turns = 2 * pi / DIRECTIONS * np.arange(DIRECTIONS)
        rows = [
            self.compute_level_wrenches(points, height, (np.cos(turn), np.sin(turn), 0.0)) for turn in turns
        ]
        return np.stack(rows, axis=1)

    @cached_property
    def pushing(self) -> Array:
        """Wrenches (2 L, 6) of unit forces of the locators, at the ends of their bands."""
        ways = np.column_stack([self.inward, np.zeros(len(self.inward))])
        ends = [np.column_stack([self.touched, self.bands[:, k]]) for k in (0, 1)]
        return np.vstack([self.compute_wrenches(points, ways) for points in ends])

    @cached_property
    def pressing_below(self) -> Array:
        """Wrenches (R, 6) of unit pressures from below."""
        points = self.below.centres if isinstance(self.below, PressedPolygon) else self.below
        return self.compute_level_wrenches(points, 0.0, (0.0, 0.0, 1.0))

    @cached_property
    def rubbing_below(self) -> Array:
        """Wrenches (C, 16, 6) of unit forces of friction below."""
        points = self.below.cells.centre if isinstance(self.below, PressedPolygon) else self.below
        return self.compute_friction_wrenches(points, 0.0)

    @cached_property
    def bearing_below(self) -> Array:
        """The friction (C, R) that each cell below bears per unit of each pressure."""
        if not isinstance(self.below, PressedPolygon):
            return self.friction * np.eye(len(self.below))
        cells = self.below.cells
        return np.asarray(self.friction * (self.below.compute_pressures(cells.centre) * cells.area).T)


@frozen(eq=False)
class StrapsOnPart:
    """A part with straps, ready for the linear programs of its loads (``statics.friction.HeldByFriction``).

    Parameters
    ----------
    part : below the straps.
    down : (K, 6) wrenches of the unit force of each tip.
    tip_friction : (K, 16, 6) wrenches of unit forces of friction at each tip.
    friction : of the tips.
    """

    part: StrappedPart
    down: Array
    tip_friction: Array
    friction: float

    @property
    def centre(self) -> Array:
        """What moments are taken about, in mm."""
        return self.part.centre

    @property
    def length(self) -> float:
        """What moments are divided by, in mm."""
        return self.part.length

    def compute_wrenches(self, points: Array, forces: Array) -> Array:
        """Wrenches (N, 6) of forces (N, 3) at points (N, 3) in mm."""
        return self.part.compute_wrenches(points, forces)

    @property
    def pushing(self) -> Array:
        """Wrenches (2 L, 6) of the locators."""
        return self.part.pushing

    @cached_property
    def pressing(self) -> Array:
        """Wrenches (R + 1, 6) of the pressures below, then of all tips together."""
        return np.vstack([self.part.pressing_below, self.down.sum(axis=0)])

    @cached_property
    def rubbing(self) -> Array:
        """Wrenches (C + K, 16, 6) of friction below, then at the tips."""
        return np.concatenate([self.part.rubbing_below, self.tip_friction])

    @cached_property
    def bearing(self) -> Array:
        """The friction (C + K, R + 1) that each cell and tip bears per unit of each pressure."""
        below = self.part.bearing_below
        out = np.zeros((len(below) + len(self.down), below.shape[1] + 1))
        out[: len(below), :-1], out[len(below) :, -1] = below, self.friction
        return out

    @cached_property
    def most_work(self) -> Array:
        """(R + 1,) 1 of the tips, which press with F each, else 0."""
        return np.asarray(np.eye(1, len(self.pressing), len(self.pressing) - 1)[0])
