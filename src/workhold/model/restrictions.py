"""What a user rules out: faces not to touch, places where no peg may stand, and angles the part may not lie at."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isfinite
from typing import Any

import numpy as np
from attrs import field, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.geometry.loop import (
    LoopShape,
    checked_vertices,
    loop_segments,
    refuse_self_crossing,
    reversed_vertices,
    signed_area,
)
from workhold.geometry.segment import Segment
from workhold.real import real

__all__ = ["Restrictions", "Zone", "circle_zone", "polygon_zone"]

Angles = tuple[float, float]


@frozen
class Zone:
    """A keep-out zone: no part of a peg's body may stand over it.

    Parameters
    ----------
    loop : (N, 3) read-only vertices x, y (mm, in the part's frame) and bulge, counter-clockwise.
    """

    loop: NDArray[np.float64] = field(eq=lambda loop: loop.tolist(), hash=False)

    def __attrs_post_init__(self) -> None:
        self.loop.setflags(write=False)

    def __reduce__(self) -> tuple[Any, ...]:
        # So that the array is read-only again on the other side.
        return Zone, (self.loop,)

    @property
    def segments(self) -> tuple[Segment, ...]:
        """Its boundary, the zone on the left."""
        return tuple(loop_segments(self.loop))


def circle_zone(x: float, y: float, radius: float) -> Zone:
    """A round zone; lengths in mm.

    Raises
    ------
    InputError
        When it has no size.
    """
    x, y, radius = real(x), real(y), real(radius)
    if not (isfinite(x) and isfinite(y) and isfinite(radius) and radius > 0):
        raise InputError(
            f"a keep-out circle of radius {radius:g} at ({x:g}, {y:g}) is no circle: give a positive radius."
        )
    return zone_of([[x - radius, y, 1.0], [x + radius, y, 1.0]])


def polygon_zone(points: Sequence[Sequence[float]]) -> Zone:
    """A zone with straight sides; points (x, y) in mm, either way round.

    Raises
    ------
    InputError
        For fewer than three points and for a boundary that crosses itself.
    """
    if len(points) < 3:
        raise InputError(f"a keep-out polygon has {len(points)} corners: give three or more.")
    return zone_of([[x, y, 0.0] for x, y in points])


def zone_of(vertices: Sequence[Sequence[float]]) -> Zone:
    """A zone of (x, y, bulge) vertices in mm, run either way.

    Raises
    ------
    InputError
        For a boundary that crosses itself, and numbers that are not finite.
    """

    def place(k: int) -> str:
        return f"keep-out zone: side {k}"

    checked = checked_vertices(vertices, "keep-out zone", place)
    shape = LoopShape.of(loop_segments(checked))
    refuse_self_crossing(shape, place)
    if signed_area(shape.segments) < 0:
        checked = reversed_vertices(checked)
    return Zone(checked)


def angle_pairs(ranges: Iterable[Iterable[float]]) -> tuple[Angles, ...]:
    """Ranges of angles as pairs of floats."""
    return tuple((float(low), float(high)) for low, high in ranges)


def all_zones(zones: Iterable[Zone]) -> tuple[Zone, ...]:
    """Zones as a tuple."""
    return tuple(zones)


def ascending(numbers: Iterable[int]) -> tuple[int, ...]:
    """Numbers in order, each once."""
    return tuple(sorted(set(numbers)))


@frozen
class Restrictions:
    """What fixtures must keep clear of.

    Parameters
    ----------
    avoid : numbers of faces that no peg may touch.
    zones : places in the part's frame where no peg may stand.
    angles : ranges (from, to) of the part's angle in the vise, in degrees, ends included; empty for any angle.

    Raises
    ------
    InputError
        For a range of angles that is not one.
    """

    avoid: tuple[int, ...] = field(default=(), converter=ascending)
    zones: tuple[Zone, ...] = field(default=(), converter=all_zones)
    angles: tuple[Angles, ...] = field(default=(), converter=angle_pairs)

    def __attrs_post_init__(self) -> None:
        for low, high in ((real(low), real(high)) for low, high in self.angles):
            if not (isfinite(low) and isfinite(high) and low <= high):
                raise InputError(
                    f"angles {low:g} to {high:g} are not a range in degrees: give the smaller first, such as -10..10."
                )

    def __bool__(self) -> bool:
        """Whether anything is ruled out."""
        return bool(self.avoid or self.zones or self.angles)
