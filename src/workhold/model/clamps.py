"""Clamps that are bolted to a plate: what shows of them, and the ratio and order of the forces of two.

Let the locators carry b1 f1 + b2 f2 where the clamps push with f1 and f2. All three are pressed exactly for
an open interval of f2 / f1. How far apart its ends are as angles is the clamp freedom: by how much the two
forces may differ. Where the interval begins at zero the first clamp alone lifts the part off no locator;
where it has no upper end, the second does not.
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
    "order_words",
    "ratios",
    "compute_clamp_force_ratio",
    "list_shown_clamps",
    "compute_working_forces",
]

Array = NDArray[np.float64]

LOCATORS = 3


def ratios(reactions: Array) -> tuple[Array, Array]:
    """The ends (N,) of the open interval of f2 / f1 in which all locators are pressed; the upper may be
    infinite.

    Parameters
    ----------
    reactions : (N, 3 or more, 2) forces of the locators, and of further pegs, per unit of f1 and of f2.

    Examples
    --------
    >>> low, high = ratios(np.array([[[1.0, 0.0], [-0.5, 1.0], [0.5, 0.0]]]))
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
    """Forces (N, P) of all pegs per unit of f1 + f2 at the working ratio, the interval's middle angle.

    Parameters
    ----------
    reactions : (N, P, 2) forces per unit of f1 and of f2.
    """
    low, high = ratios(reactions)
    angle = (np.arctan(low) + np.arctan(high)) / 2
    one, two = np.cos(angle), np.sin(angle)
    return np.asarray(
        (reactions[..., 0] * one[:, None] + reactions[..., 1] * two[:, None]) / (one + two)[:, None]
    )


@frozen
class ShownClamp:
    """What shows of a clamp; lengths in mm.

    Parameters
    ----------
    carrier : the whole of it.
    tip : the peg that touches the part.
    hole : centre of the hole that it is bolted in; None where only the line is known that its tip moves
        along.
    clamping : unit vector along which it pushes.
    pitch : distance along that line between holes.
    """

    carrier: Carrier
    tip: Peg
    hole: Point | None
    clamping: Point
    pitch: float

    @property
    def is_upright(self) -> bool:
        """Whether it pushes along a column rather than a row."""
        return self.clamping[0] == 0

    @property
    def back(self) -> Point:
        """Where its body begins: the hole, or the tip where that is all that is known."""
        return self.hole or (self.tip.x, self.tip.y)

    def outline(self, more: float = 0.0) -> tuple[Segment, ...]:
        """The outline of the body, counter-clockwise: a capsule from hole to tip, or the tip's circle alone.

        Parameters
        ----------
        more : how much larger the outline is than the body, in mm.
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
        one, other = (
            Box(x, y, x, y).grown(self.carrier.peg_radius) for x, y in (self.back, (self.tip.x, self.tip.y))
        )
        return one.union(other)

    @property
    def room(self) -> Box:
        """The box of the body and one pitch behind it, for the hand that sets it and the arrow of its
        direction.
        """
        behind = self.behind(self.pitch)
        return self.extent.union(Box(*behind, *behind))

    def behind(self, away: float, aside: float = 0.0) -> Point:
        """A point so far behind the hole, or the tip, and beside its line."""
        (x, y), (dx, dy) = self.back, self.clamping
        return x - away * dx - aside * dy, y - away * dy + aside * dx


def list_shown_clamps(fixture: Fixture, toolkit: Toolkit) -> Iterator[ShownClamp]:
    for peg in fixture.pegs:
        carrier = toolkit.find_carrier(peg.carrier)
        clamping = find_clamping_direction(carrier, toolkit)
        if carrier.contact is CLAMP_TIP and clamping is not None:
            hole = carrier.place(peg.column, peg.row) if carrier.measure == "stroke" else None
            yield ShownClamp(carrier, peg, hole, clamping, carrier.pitch[0 if carrier.line == "row" else 1])


def find_clamping_direction(carrier: Carrier, toolkit: Toolkit) -> Point | None:
    """Along which a carrier slides when it clamps, a unit vector; None when it stands still."""
    if carrier.travel is None:
        return None
    x, y = carrier.travel.unit
    return (0.0 - toolkit.clamping * x, 0.0 - toolkit.clamping * y)


# Digits of a ratio on paper, rounded so that it lies inside the interval.
DIGITS = 2


def name_clamps(fixture: Fixture) -> tuple[str, ...]:
    """Names of a fixture's clamps: their holes or lines, with directions where both are on one line."""
    tips = fixture.pegs[-2:]
    holes = [tip.hole for tip in tips]
    if len(set(holes)) == len(holes):
        return tuple(holes)
    directions = [tip.carrier.rpartition(" ")[2].replace("-", "\N{MINUS SIGN}") for tip in tips]
    if len(set(directions)) == len(directions):
        return tuple(f"{hole} {direction}" for hole, direction in zip(holes, directions, strict=True))
    return tuple(f"{hole} on face {tip.face}" for hole, tip in zip(holes, tips, strict=True))


def name_first_clamps(fixture: Fixture) -> tuple[str, ...]:
    """Names of those of two clamps that may be tightened first, as they lift the part off no locator."""
    if fixture.pair is None:
        return ()
    low, high = fixture.pair.ratio
    return tuple(
        name for name, may in zip(name_clamps(fixture), (low == 0.0, high == inf), strict=True) if may
    )


def compute_clamp_force_ratio(fixture: Fixture) -> float:
    """The second clamp's force over the first's at the working ratio; 0 where one thing clamps."""
    return 0.0 if fixture.pair is None else fixture.pair.working_ratio


def compute_clamp_shares(fixture: Fixture) -> tuple[float, ...]:
    """The part of the clamp force, of two the sum of both, that each clamp has at the working ratio."""
    ratio = compute_clamp_force_ratio(fixture)
    return (1.0 / (1.0 + ratio), ratio / (1.0 + ratio))[: len(fixture.travels)]


def order_words(fixture: Fixture) -> str:
    """How to tighten the two clamps, one or two sentences; nothing for other fixtures.

    Examples
    --------
    >>> from workhold.model.fixture import Pair, Peg, Pose
    >>> where = ("-x", "E2"), ("-y", "C5")
    >>> tips = [Peg(f"clamp {d}", 4, 1, 66.0, 20.0, 2, 0.5, f"clamp {hole}") for d, hole in where]
    >>> def words(low, high):
    ...     pair = Pair((0, 0), (low, high), (), 1)
    ...     return order_words(Fixture("clamp2", tuple(tips), Pose(0, 0, 0), 0, {}, "-x -y", pair))
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
            f"Tighten {one} first. Then tighten {other} with less than {inside(most, floor)} times its "
            "force: more lifts the part off a locator."
        )
    return (
        f"Bring both clamps up together, in small turns: {second} with {inside(low, ceil)} to "
        f"{inside(high, floor)} times the force of {first}. Tighten neither alone: it lifts the "
        "part off a locator."
    )


def describe_clamp_freedom(degrees: float) -> str:
    """What a clamp freedom means.

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


def inside(ratio: float, towards: type[int] | object) -> str:
    """A ratio to two digits, rounded up by ``ceil`` or down by ``floor``."""
    step = 10.0 ** (floor(log10(ratio)) - DIGITS + 1)
    whole = floor(ratio / step) if towards is floor else ceil(ratio / step)
    return f"{whole * step:.{DIGITS}g}" if 1e-4 < ratio < 100 else f"{whole * step:,.4g}"
