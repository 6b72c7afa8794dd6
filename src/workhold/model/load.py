"""A load: what a cutter, a drill or a hand does to the workpiece while it is held."""

from __future__ import annotations

from collections.abc import Iterable
from math import hypot, isfinite

from attrs import field, frozen

from workhold.errors import InputError
from workhold.limits import refuse_long, refuse_strong
from workhold.real import real

__all__ = ["ANY_DIRECTION", "Load"]

ANY_DIRECTION = (0.0, 360.0)


def point_pairs(points: Iterable[Iterable[float]]) -> tuple[tuple[float, float], ...]:
    """Points as pairs of floats."""
    return tuple((real(x), real(y)) for x, y in points)


def direction_range(directions: Iterable[float]) -> tuple[float, float]:
    """A range of directions in degrees, from ``low`` counter-clockwise to ``high``, with low in [0, 360) and
    low <= high <= low + 360."""
    low, high = (real(value) for value in directions)
    if 0.0 <= low < 360.0 and low <= high <= low + 360.0:
        return ANY_DIRECTION if high - low == 360.0 else (low, high)
    if not (isfinite(low) and isfinite(high) and abs(high - low) <= 360.0):
        raise InputError(
            f"direction {low:g}..{high:g} is not a range of at most 360 degrees: give two angles, or any for all of them."
        )
    if abs(high - low) == 360.0:
        return ANY_DIRECTION
    # The rest of a tiny negative angle rounds up to the whole turn.
    start = low % 360.0 % 360.0
    return start, start + (high - low) % 360.0


@frozen
class Load:
    """A force and a moment that act ON the workpiece; pegs must push back.

    The force acts at one of the points, whichever is worst, in one of the directions, whichever is worst; the moment acts
    together with it. A cutter that runs along a polyline is a load with several points: between two of them nothing is
    worse than at the worse of the two.

    Parameters
    ----------
    points : where the force may act, (x, y) in mm in the part's coordinates; may be empty when there is no force.
    force : its size in N, 0 or more.
    directions : (low, high) in degrees in the part's frame, counter-clockwise from the part's x axis and from low to
        high; (0, 360) is any direction.
    moment : in N mm, positive counter-clockwise.
    name : what the user calls it.

    Raises
    ------
    InputError
        For numbers that are not finite or beyond the limits, a negative force, a force without a point, and a load that
        does nothing.

    Examples
    --------
    >>> from workhold.model.load import Load
    >>> Load(points=[(10, 5)], force=200, directions=(-30, 30)).directions
    (330.0, 390.0)
    """

    points: tuple[tuple[float, float], ...] = field(default=(), converter=point_pairs)
    force: float = field(default=0.0, converter=real)
    directions: tuple[float, float] = field(default=ANY_DIRECTION, converter=direction_range)
    moment: float = field(default=0.0, converter=real)
    name: str = ""

    def __attrs_post_init__(self) -> None:
        if not isfinite(self.force) or self.force < 0:
            raise InputError(
                f"force {self.force:g} is not a size in N: give 0 or more, and where it points as a direction."
            )
        if not isfinite(self.moment):
            raise InputError(f"moment {self.moment:g} is not a number: give it in N mm, positive counter-clockwise.")
        refuse_strong("force", self.force)
        refuse_strong("moment", self.moment, "N mm")
        for x, y in self.points:
            if not isfinite(hypot(x, y)):
                raise InputError(f"the point ({x:g}, {y:g}) of a load is not a place: give finite coordinates in mm.")
            refuse_long("a load's point", max(x, y, key=abs))
        if self.force > 0 and not self.points:
            raise InputError(f"a force of {self.force:g} N needs the point it acts at: give at=X,Y or path=X,Y;X,Y.")
        if self.force == 0 and self.moment == 0:
            raise InputError("a load with neither force nor moment does nothing: give force=... or moment=....")
