"""A load that acts on the part while it is held: a cutting force, a weight, a moment."""

from __future__ import annotations

from math import isfinite

from attrs import field, frozen

from holdfast.errors import InputError
from holdfast.geometry.segment import Point

__all__ = ["ANY_DIRECTION", "Load"]

ANY_DIRECTION = (0.0, 360.0)


@frozen
class Load:
    """A force at a point, or along a path, from a range of directions; or a moment; or both.

    Parameters
    ----------
    points : where the force may act, (x, y) in mm in the part's frame; the corners of a path stand for all of it.
    force : in N.
    directions : from, to in degrees counter-clockwise in the part's frame; (0, 360) is any direction.
    moment : in N mm, positive counter-clockwise.
    name : what the user calls it.

    Raises
    ------
    InputError
        For numbers that are not finite, a negative force, a force without a point, and a load of nothing.
    """

    points: tuple[Point, ...] = ()
    force: float = field(default=0.0, converter=float)
    directions: tuple[float, float] = ANY_DIRECTION
    moment: float = field(default=0.0, converter=float)
    name: str = ""

    def __attrs_post_init__(self) -> None:
        called = f"load {self.name}" if self.name else "a load"
        numbers = [self.force, self.moment, *self.directions, *(value for point in self.points for value in point)]
        if not all(isfinite(value) for value in numbers):
            raise InputError(f"{called} has a number that is not finite: correct it.")
        if self.force < 0:
            raise InputError(f"{called} has a force of {self.force:g} N: give 0 or more, and the direction it acts in.")
        if self.force > 0 and not self.points:
            raise InputError(f"{called} has a force but no point: say where it acts.")
        if self.force == 0 and self.moment == 0:
            raise InputError(f"{called} has neither a force nor a moment: give one of them.")
        if self.directions[1] < self.directions[0]:
            raise InputError(
                f"{called} has directions from {self.directions[0]:g} down to {self.directions[1]:g} degrees: give the "
                "smaller first, or add 360 to the second."
            )
