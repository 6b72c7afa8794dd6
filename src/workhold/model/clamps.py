"""Clamps that are bolted to a plate: their display and, for two clamps, the ratio of their forces and the
order of tightening.

Let the locators carry b1 f1 + b2 f2 when the clamps push with f1 and f2. All three are pressed if f2 / f1
lies in an open interval. The clamp freedom is atan(upper end) - atan(lower end); it says how much the two
forces may differ. If the interval begins at zero, the first clamp alone does not lift the part off any
locator; if it has no upper end, the second does not.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import atan2, ceil, floor, hypot, inf, log10, pi

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import NO_REACTION
from workhold.fixels.carrier import Carrier
from workhold.fixels.contacts import CLAMP_TIP
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Box, Line, Point, Segment
from workhold.model.fixture import Fixture, Peg

__all__ = [
    "LOCATORS",
    "ShownClamp",
    "name_clamps",
    "compute_clamp_shares",
    "find_clamping_direction",
    "name_first_clamps",
    "describe_clamp_freedom",
    "describe_tightening_order",
    "compute_force_ratios",
    "compute_clamp_force_ratio",
    "list_shown_clamps",
    "compute_working_forces",
]

Array = NDArray[np.float64]

LOCATORS = 3


def compute_force_ratios(reactions: Array) -> tuple[Array, Array]:
    """Return lower and upper ends (N,) of the open interval of f2 / f1 in which all locators are pressed.

    The lower end is at least 0, the upper may be inf. The interval is empty where low >= high.

    Parameters
    ----------
    reactions : (N, 3 or more, 2) forces of the locators, and of further pegs, per unit of f1 and of f2.

    Examples
    --------
    >>> low, high = compute_force_ratios(np.array([[[1.0, 0.0], [-0.5, 1.0], [0.5, 0.0]]]))
    >>> float(low[0]), float(high[0])
    (0.5, inf)
    """
    locators = np.where(np.abs(reactions[:, :LOCATORS]) < NO_REACTION, 0.0, reactions[:, :LOCATORS])
    one, two = locators[..., 0], locators[..., 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = -one / two
    low = np.where(two > 0.0, ends, 0.0).max(axis=1, initial=0.0)
    high = np.where(two < 0.0, ends, np.inf).min(axis=1, initial=np.inf)
    # Where no force of the second clamp reaches a locator, the first has to press it.
    high = np.where(((two == 0.0) & (one <= 0.0)).any(axis=1), 0.0, high)
    return low + 0.0, high + 0.0


def compute_working_forces(reactions: Array) -> Array:
    """Return the forces (N, P) of all pegs at each fixture's working ratio f2 / f1, divided by f1 + f2.

    The working ratio is the tangent of the mean of atan(low) and atan(high), where (low, high) is the
    interval of :func:`compute_force_ratios`.

    Parameters
    ----------
    reactions : (N, P, 2) forces per unit of f1 and of f2.
    """
    low, high = compute_force_ratios(reactions)
    angle = (np.arctan(low) + np.arctan(high)) / 2
    one, two = np.cos(angle), np.sin(angle)
    return np.asarray(
        (reactions[..., 0] * one[:, None] + reactions[..., 1] * two[:, None]) / (one + two)[:, None]
    )


@frozen
class ShownClamp:
    """A clamp that is bolted to a plate, as pictures show it; lengths in mm.

    Parameters
    ----------
    carrier : the clamp's carrier in the toolkit.
    tip : the peg that touches the part.
    hole : centre of the hole that the clamp is bolted in; None where only the line is known along which the
        tip moves.
    clamping : unit vector along which the clamp pushes.
    pitch : distance between holes along the clamping direction.
    """

    carrier: Carrier
    tip: Peg
    hole: Point | None
    clamping: Point
    pitch: float

    @property
    def pushes_along_column(self) -> bool:
        """Whether the clamp pushes along a column (parallel to y) rather than along a row."""
        return self.clamping[0] == 0

    @property
    def back(self) -> Point:
        """Point at which the body begins: the centre of the bolt's hole, or of the tip if no hole is known."""
        return self.hole or (self.tip.x, self.tip.y)

    def make_outline(self, more: float = 0.0) -> tuple[Segment, ...]:
        """Return the outline of the body, counter-clockwise:
        a capsule from hole to tip, or the tip's circle if there is no hole.

        Parameters
        ----------
        more : distance in mm by which the outline is offset outward from the body.
        """
        (ax, ay), (bx, by), radius = self.back, (self.tip.x, self.tip.y), self.carrier.peg_radius + more
        length = hypot(bx - ax, by - ay)
        if length == 0:
            return (Arc((bx, by), radius, 0.0, pi, 1.0),)
        along, (x, y) = atan2(by - ay, bx - ax), (radius * (bx - ax) / length, radius * (by - ay) / length)
        return (
            Line((ax + y, ay - x), (bx + y, by - x)),
            Arc((bx, by), radius, along, pi / 2, 1.0),
            Line((bx - y, by + x), (ax - y, ay + x)),
            Arc((ax, ay), radius, along + pi, pi / 2, 1.0),
        )

    @property
    def extent(self) -> Box:
        """Bounding box of the body."""
        one, other = (
            Box(x, y, x, y).grow(self.carrier.peg_radius) for x, y in (self.back, (self.tip.x, self.tip.y))
        )
        return one.unite(other)

    @property
    def room(self) -> Box:
        """Bounding box of the body and of the point one pitch behind it:
        space for a hand and for the arrow.
        """
        behind = self.compute_point_behind(self.pitch)
        return self.extent.unite(Box(*behind, *behind))

    def compute_point_behind(self, away: float, aside: float = 0.0) -> Point:
        """Return the point ``away`` mm behind the hole (or the tip)
        against the clamping direction, and ``aside`` mm to its left.
        """
        (x, y), (dx, dy) = self.back, self.clamping
        return x - away * dx - aside * dy, y - away * dy + aside * dx


def list_shown_clamps(fixture: Fixture, toolkit: Toolkit) -> Iterator[ShownClamp]:
    """Yield the clamps of a fixture that have a tip and a clamping direction, in the order of its pegs."""
    for peg in fixture.pegs:
        carrier = toolkit.find_carrier(peg.carrier)
        clamping = find_clamping_direction(carrier, toolkit)
        if carrier.contact is CLAMP_TIP and clamping is not None:
            hole = carrier.compute_hole_center(peg.column, peg.row) if carrier.measure == "stroke" else None
            yield ShownClamp(carrier, peg, hole, clamping, carrier.pitch[0 if carrier.line == "row" else 1])


def find_clamping_direction(carrier: Carrier, toolkit: Toolkit) -> Point | None:
    """Return the unit vector along which a carrier pushes when it clamps; None if it does not move."""
    if carrier.travel is None:
        return None
    x, y = carrier.travel.unit
    return (0.0 - toolkit.clamping * x, 0.0 - toolkit.clamping * y)


# Digits of a ratio on paper, rounded so that it lies inside the interval.
DIGITS = 2


def name_clamps(fixture: Fixture) -> tuple[str, ...]:
    """Return one name for each of a fixture's last two pegs, its clamps: the name of the clamp's hole or
    line.

    Where both names are equal, "hole direction" is returned for each; where the directions are equal too,
    "hole on face N". Only for a fixture with a pair of clamps.
    """
    tips = fixture.pegs[-2:]
    holes = [tip.hole for tip in tips]
    if len(set(holes)) == len(holes):
        return tuple(holes)
    directions = [tip.carrier.rpartition(" ")[2].replace("-", "\N{MINUS SIGN}") for tip in tips]
    if len(set(directions)) == len(directions):
        return tuple(f"{hole} {direction}" for hole, direction in zip(holes, directions, strict=True))
    return tuple(f"{hole} on face {tip.face}" for hole, tip in zip(holes, tips, strict=True))


def name_first_clamps(fixture: Fixture) -> tuple[str, ...]:
    """Return the names of those clamps of a pair that may be tightened first without lifting the part: none,
    one or both.

    Return an empty tuple for a fixture without a pair of clamps.
    """
    if fixture.pair is None:
        return ()
    low, high = fixture.pair.ratio
    return tuple(
        name for name, may in zip(name_clamps(fixture), (low == 0.0, high == inf), strict=True) if may
    )


def compute_clamp_force_ratio(fixture: Fixture) -> float:
    """Return f2 / f1 of a pair of clamps at the working ratio; 0.0 for a fixture without two clamps."""
    return 0.0 if fixture.pair is None else fixture.pair.working_ratio


def compute_clamp_shares(fixture: Fixture) -> tuple[float, ...]:
    """Return each clamp's share of the sum of the clamp forces at the working ratio:
    (1.0,) for one, two for a pair.
    """
    ratio = compute_clamp_force_ratio(fixture)
    return (1.0 / (1.0 + ratio), ratio / (1.0 + ratio))[: len(fixture.travels)]


def describe_tightening_order(fixture: Fixture) -> str:
    """Return one or two sentences on how to tighten a pair of clamps; "" for a fixture without a pair.

    Examples
    --------
    >>> from workhold.model.fixture import ClampPair, Peg, Pose
    >>> where = ("-x", "E2"), ("-y", "C5")
    >>> tips = [Peg(f"clamp {d}", 4, 1, 66.0, 20.0, 2, 0.5, f"clamp {hole}") for d, hole in where]
    >>> def words(low, high):
    ...     pair = ClampPair((0, 0), (low, high), (), 1)
    ...     return describe_tightening_order(Fixture("clamp2", tuple(tips), Pose(0, 0, 0), 0, {}, "-x -y", pair))
    >>> words(0.0, float("inf"))
    'Tighten either clamp first, each as hard as it needs: neither lifts the part off a locator.'
    >>> words(0.0, 2.468).split(": ")  # doctest: +NORMALIZE_WHITESPACE
    ['Tighten clamp E2 first. Then tighten clamp C5 with less than 2.4 times its force',
     'more lifts the part off a locator.']
    """
    if fixture.pair is None:
        return ""
    (low, high), (first, second) = fixture.pair.ratio, name_clamps(fixture)
    if low == 0.0 and high == inf:
        return "Tighten either clamp first, each as hard as it needs: neither lifts the part off a locator."
    if low == 0.0 or high == inf:
        one, other, most = (first, second, high) if low == 0.0 else (second, first, 1.0 / low)
        return (
            f"Tighten {one} first. Then tighten {other} with less than {round_ratio_inward(most, floor)} times its "
            "force: more lifts the part off a locator."
        )
    return (
        f"Bring both clamps up together, in small turns: {second} with {round_ratio_inward(low, ceil)} to "
        f"{round_ratio_inward(high, floor)} times the force of {first}. Tighten neither alone: it lifts the "
        "part off a locator."
    )


def describe_clamp_freedom(degrees: float) -> str:
    """Return a phrase that says how to tighten clamps with a clamp freedom in degrees.

    >>> describe_clamp_freedom(90.0)
    'the part is held whatever the two forces are'
    >>> describe_clamp_freedom(71.5), describe_clamp_freedom(4.0)
    ('no torque wrench is needed', 'both forces have to be right: use a torque wrench')
    """
    if degrees >= 90.0 - 1e-9:
        return "the part is held whatever the two forces are"
    return (
        "no torque wrench is needed"
        if degrees >= EASY
        else "both forces have to be right: use a torque wrench"
    )


# Degrees of clamp freedom from which a hand tightens well enough: forces may be off by a factor of two to
# either side.
EASY = 45.0


def round_ratio_inward(ratio: float, towards: type[int] | object) -> str:
    """Return a positive ratio as text with two digits, rounded down if ``towards`` is ``floor`` and up
    otherwise.
    """
    step = 10.0 ** (floor(log10(ratio)) - DIGITS + 1)
    whole = floor(ratio / step) if towards is floor else ceil(ratio / step)
    return f"{whole * step:.{DIGITS}g}" if 1e-4 < ratio < 100 else f"{whole * step:,.4g}"
