"""Patterns of four pegs in their closing frame, for which seating is solved once for all fixtures on them.

A toolkit is turned by quarter turns until its moving carrier opens along x and clamps as the separation S
falls. If a toolkit clamps by opening, S is minus the travel. So a vise that clamps by opening is turned by
half a turn, and a clamp that pushes along a column by a quarter.

A subset of two or three pegs has the same places, up to a shift, in many patterns of one lattice. While S is
free, its equilibria depend only on the relative places of the pegs of each jaw, and on the height of one
jaw's pegs above the other's. The pattern's other pegs only decide whether a pose is free.

Glossary
--------
closing frame : a task frame, chosen so that the task is described most easily: M. T. Mason, "Compliance and
    force control for computer controlled manipulators", IEEE Transactions on Systems, Man, and Cybernetics 11
    (1981).
stop : the smallest separation, at which the moving carrier stops without a part.
subset of contacts : two or three contacts of a grasp that balance without the others: E. Rimon and A. Blake,
    "Caging planar bodies by one-parameter two-fingered gripping systems", International Journal of Robotics
    Research 18 (1999).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache
from itertools import chain, combinations
from math import inf, sqrt
from typing import Any

import numpy as np
from attrs import define, evolve, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.fixels.carrier import Travel
from workhold.fixels.contacts import WALL_END
from workhold.fixels.toolkit import Carrier, Toolkit
from workhold.model.fixture import Fixture

__all__ = [
    "ClosingFrame",
    "CommonToPatterns",
    "Pattern",
    "PegSubset",
    "list_jaw_subsets",
    "refuse_unseated",
    "list_subsets",
]

Array = NDArray[np.float64]
# Carriers of which is kept what their patterns have in common.
TOOLKITS = 64
QUARTERS = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))


@frozen
class ClosingFrame:
    """The change from a toolkit's frame to the closing frame, in which jaws open along x, and back.

    Parameters
    ----------
    quarters : number of quarter turns counter-clockwise by which vectors are turned from the toolkit's frame
        to the closing frame.
    sign : 1 if the separation S is the travel, -1 if S is minus the travel.
    """

    quarters: int
    sign: float

    @classmethod
    def from_toolkit(cls, toolkit: Toolkit, carrier: Carrier) -> ClosingFrame:
        """Return the closing frame of a toolkit whose moving carrier is ``carrier``."""
        assert carrier.travel is not None
        x, y = (toolkit.clamping * part for part in carrier.travel.unit)
        return cls(-QUARTERS.index((round(x) + 0.0, round(y) + 0.0)) % 4, float(toolkit.clamping))

    def turn_points(self, points: Array, back: bool = False) -> Array:
        """Return points or directions (..., 2) given in the toolkit's frame, in the closing frame.

        With ``back``, the other way: from the closing frame to the toolkit's frame.
        """
        cosine, sine = QUARTERS[self.quarters]
        sine = -sine if back else sine
        return np.asarray(points @ np.array([[cosine, sine], [-sine, cosine]]) + 0.0)

    def map_from_toolkit(self, config: Array) -> Array:
        """Return a configuration (4,) in the closing frame: theta in radians, x, y and the separation S in
        mm.

        ``config`` is the configuration in the toolkit's frame: theta, x, y and travel.
        """
        return np.array(
            [config[0] + self.quarters * np.pi / 2, *self.turn_points(config[1:3]), self.sign * config[3]]
        )

    def map_to_toolkit(self, configs: Array) -> Array:
        """Return configurations (..., 4) in the toolkit's frame: theta in radians, x, y and travel in mm.

        ``configs`` are the configurations in the closing frame: theta, x, y and the separation S.
        """
        out = np.array(configs)
        out[..., 0] -= self.quarters * np.pi / 2
        out[..., 1:3] = self.turn_points(configs[..., 1:3], back=True)
        out[..., 3] *= self.sign
        return out


@frozen(eq=False)
class CommonToPatterns:
    """The common data of the patterns of all fixtures whose pegs are on the same carriers.

    Parameters
    ----------
    travel : range and direction of the carrier that moves.
    frame, right, radii, numbers, half_plane : as in ``Pattern``.
    """

    travel: Travel
    frame: ClosingFrame
    right: NDArray[np.int64]
    radii: tuple[float, float]
    numbers: tuple[int, ...]
    half_plane: tuple[float, float, float] | None

    @classmethod
    @lru_cache(maxsize=TOOLKITS)
    def from_toolkit(cls, toolkit: Toolkit, names: tuple[str, ...]) -> CommonToPatterns:
        """Return the common data of patterns.

        ``names`` are the names of the carriers on which the pegs stand, one for each peg.

        Raises
        ------
        InputError
            As :func:`refuse_unseated`.
        """
        refuse_unseated(toolkit)
        standing_on = [toolkit.find_carrier(name) for name in names]
        numbers = tuple(k for k, carrier in enumerate(standing_on) if carrier.contact.is_placed)
        carriers = [standing_on[k] for k in numbers]
        moving = next(carrier for carrier in carriers if carrier.travel is not None)
        standing = next(carrier for carrier in carriers if carrier.travel is None)
        frame = ClosingFrame.from_toolkit(toolkit, moving)
        right = np.array([int(carrier.travel is not None) for carrier in carriers], dtype=np.int64)
        half_plane = None
        if WALL_END in toolkit.contacts:
            # It runs along x at y = 0, the part above it.
            x, y = frame.turn_points(np.array([0.0, 1.0])).tolist()
            half_plane = x, y, 0.0
        assert moving.travel is not None
        radii = standing.peg_radius, moving.peg_radius
        return cls(moving.travel, frame, right, radii, numbers, half_plane)


def refuse_unseated(toolkit: Toolkit) -> None:
    """Raise InputError for a toolkit for which seats cannot be computed.

    Raises
    ------
    InputError
        For two clamps, straps or flat jaws; without a fixed peg; for pegs with a flat; for pegs of radius 0.
    """
    words = "the seating is worked out only"
    if toolkit.flat_jaws is not None:
        raise InputError(f"{words} for round pegs: flat jaws have none.")
    if toolkit.strap_set is not None:
        raise InputError(f"{words} where a jaw or a clamp closes: under straps a hand pushes the part home.")
    if not toolkit.closes_at_once:
        raise InputError(
            f"{words} for one clamp: with two clamps you push the part against its locators by hand."
        )
    if all(plate.travel is not None for plate in toolkit.plates):
        still = (
            "the flat jaw stands still, and both pegs move" if WALL_END in toolkit.contacts else "all move"
        )
        raise InputError(f"{words} if some pegs stand still; here {still}.")
    if toolkit.has_flats:
        raise InputError(f"{words} for round pegs: the pegs of this result have flats.")
    if min(carrier.peg_radius for carrier in toolkit.carriers if carrier.contact.is_placed) <= 0.0:
        raise InputError("pegs of radius 0 roll around no corner: give the pegs a radius, however small.")


# mm. Peg patterns that agree to this are one: places are whole steps of a lattice.
SAME_PATTERN = 1e-6
# mm. A clamp's tip may be in a locator by this much: rounding.
APART = 1e-6
# mm. How much farther apart than both could touch the part pegs are at the end of a descent without a stop.
BEYOND = 1.0


@define(frozen=True, eq=False)
class Pattern:
    """A fixture's pegs in the closing frame: four, or two and a wall. The pattern of a subset has two or
    three.

    Parameters
    ----------
    pegs : (K, 2) places of the pegs in mm at separation 0.
    right : (K,) 1 for moving pegs, such as those of the right jaw, 0 for fixed pegs.
    radii : radii in mm of the fixed pegs and of the moving ones.
    stop, widest : the least and the largest separation in mm; -inf and inf where there is no limit.
    frame : the change from the toolkit's frame to the closing frame.
    numbers : for each peg its index among the fixture's pegs.
    half_plane : (x, y, coordinate) of a wall: the unit vector from the wall to the part, along x or y, and
        the wall's coordinate along that vector in mm. None without a wall.
    gap : least distance in mm along x between pegs of the two jaws; None if none is prescribed.
    """

    pegs: Array
    right: NDArray[np.int64]
    radii: tuple[float, float]
    stop: float
    widest: float
    frame: ClosingFrame
    numbers: tuple[int, ...] = (0, 1, 2, 3)
    half_plane: tuple[float, float, float] | None = None
    gap: float | None = None

    @classmethod
    def from_fixture(cls, fixture: Fixture, toolkit: Toolkit) -> Pattern:
        """Return the pattern of a fixture's pegs.

        Raises
        ------
        InputError
            As :func:`refuse_unseated`.
        """
        common = CommonToPatterns.from_toolkit(toolkit, tuple([peg.carrier for peg in fixture.pegs]))
        frame, right, gap = common.frame, common.right, toolkit.gap
        pegs = frame.turn_points(
            np.array([[fixture.pegs[k].x, fixture.pegs[k].y] for k in common.numbers], float)
        )
        separation = frame.sign * fixture.travel
        pegs[:, 0] -= right * separation
        pattern = cls(pegs, right, common.radii, -inf, inf, frame, common.numbers, common.half_plane, gap)
        stop, widest = (
            pattern.find_locator_limits(separation) if gap is None else pattern.find_gap_limits(gap)
        )
        if frame.sign < 0.0:
            stop = stop if common.travel.most is None else max(stop, -common.travel.most)
        elif gap is None:
            stop = max(stop, common.travel.least)
        return evolve(pattern, stop=stop, widest=widest)

    def find_gap_limits(self, gap: float) -> tuple[float, float]:
        """Return (1) the least and (2) the largest separation in mm at which pegs of the two jaws keep a gap
        in mm.

        Jaws that clamp by closing have a least separation only, and the largest is inf. Jaws that clamp by
        opening have a largest separation only, and the least is -inf.
        """
        left, right = self.along_x
        if self.frame.sign > 0.0:
            return gap + max(left) - min(right), inf
        return -inf, min(left) - max(right) - gap

    def find_locator_limits(self, separation: float) -> tuple[float, float]:
        """Return the separations below and above ``separation`` (mm) at which a clamp's tip first meets a
        locator or the wall.

        They are -inf and inf if it meets none.
        """
        stop, widest = -inf, inf
        for tip in self.pegs[self.right == 1]:
            for locator in self.pegs[self.right == 0]:
                across, ahead = float(locator[1] - tip[1]), float(locator[0] - tip[0])
                square = sum(self.radii) ** 2 - across**2
                if square <= 0.0:
                    continue
                if ahead <= separation:
                    stop = max(stop, min(ahead + sqrt(square), separation + APART))
                else:
                    widest = min(widest, max(ahead - sqrt(square), separation - APART))
            if self.half_plane is not None and self.half_plane[0] != 0.0:
                # The tip moves toward the wall, or away from it.
                ahead = self.half_plane[0] * (self.half_plane[2] + self.radii[1]) - float(tip[0])
                if self.half_plane[0] > 0.0:
                    stop = max(stop, ahead)
                else:
                    widest = min(widest, ahead)
        return stop, widest

    def find_least_separation(self, diameter: float) -> float:
        """Return the smallest separation in mm down to which a descent is followed: the stop, if there is
        one.

        Without a stop it is so small that a part of this diameter (mm) cannot touch a moving and a fixed peg
        at once.
        """
        left, right = self.along_x
        return max(self.stop, min(left) - max(right) - diameter - sum(self.radii) - BEYOND)

    @property
    def along_x(self) -> tuple[list[float], list[float]]:
        """The x coordinates in mm of (1) the fixed pegs and (2) the moving pegs, at separation 0."""
        left, right = (self.pegs[self.right == side, 0].tolist() for side in (0, 1))
        return left, right

    @cached_property
    def order(self) -> NDArray[np.int64]:
        """The indices (K,) of the fixed pegs, then of the moving ones, both from left to right."""
        return np.lexsort((self.pegs[:, 1], self.pegs[:, 0], self.right))

    def make_key(self) -> tuple[object, ...]:
        """Return a key that is equal for patterns that differ only by a shift of all pegs or by the order of
        the pegs.
        """
        order, pegs = self.order.tolist(), self.pegs.tolist()
        (x, y), sides = pegs[order[0]], [int(self.right[k]) for k in order]
        # Where separations are counted from is of no account.
        apart = pegs[order[sides.index(1)]][0] - x
        moved = [
            (pegs[k][0] - x - side * apart, pegs[k][1] - y) for k, side in zip(order, sides, strict=True)
        ]
        ends = [self.stop + apart, self.widest + apart]
        if self.half_plane is not None:
            ux, uy, off = self.half_plane
            ends += [ux / SAME_PATTERN, uy / SAME_PATTERN, off - (x * ux + y * uy)]
        steps = np.rint(np.array([*ends, *chain(*moved)]) / SAME_PATTERN) + 0.0
        return (*self.radii, *sides, *steps.tolist())

    def is_reachable(self, separation: Any, slack: float = 0.0) -> Any:
        """Return whether a separation, or each of an array, is more than ``slack`` mm inside the range of
        separations.
        """
        return (separation > self.stop + slack) & (separation < self.widest - slack)

    def place_pegs(self, configs: Array) -> Array:
        """Return the places (N, K, 2) of the K pegs in the part's frame in mm, relative to the centre of the
        part's box.

        ``configs`` (N, 4) are theta in radians, x, y and the jaw separation S in mm.
        """
        x = self.pegs[:, 0] + self.right * configs[:, 3:4] - configs[:, 1:2]
        y = self.pegs[:, 1] - configs[:, 2:3]
        cosine, sine = np.cos(configs[:, :1]), np.sin(configs[:, :1])
        out = np.empty((*x.shape, 2))
        out[:, :, 0], out[:, :, 1] = cosine * x + sine * y, cosine * y - sine * x
        return out


# Decimals of a mm to which pegs of one subset stand alike: what differs less is rounding, and goes.
DECIMALS = 11
# Patterns whose subsets are kept, one or two for each thread that is at work on both sides of a part.
SIDES = 64
# mm. Separations this much below a gap still count: the pattern decides which of them do.
SLACK = 1e-6


@frozen(eq=False, slots=False)
class PegSubset:
    """Some pegs of a pattern, in their own frame.

    In this frame the first peg is at the origin, and the first moving peg is at x = 0 at separation 0.

    Parameters
    ----------
    whole : the pattern.
    numbers : indices of these pegs in the pattern.
    sides : for each peg 1 if it moves, else 0.
    places : of the pegs in mm.
    shift : (4,) is added to configurations of the subset to get those of the pattern.
    """

    whole: Pattern
    numbers: tuple[int, ...]
    sides: tuple[int, ...]
    places: tuple[tuple[float, float], ...]
    shift: Array

    @classmethod
    def from_pattern(cls, pattern: Pattern, numbers: Sequence[int]) -> PegSubset:
        """Return the subset of the pegs with the indices ``numbers``, in any order."""
        pegs, right, beside = list_peg_places(pattern)
        # Pegs of each jaw from left to right, those that stand still before those that move.
        start = {right[k]: k for k in reversed(numbers)}
        order = tuple(k for *_, k in sorted((right[k], *beside[start[right[k]]][k], k) for k in numbers))
        first, low = {right[k]: k for k in reversed(order)}, order[0]
        places = tuple((beside[first[right[k]]][k][0], beside[low][k][1]) for k in order)
        (x, y), apart = pegs[low], pegs[low][0] - pegs[first[1]][0] if len(first) > 1 else 0.0
        return cls(pattern, order, tuple(right[k] for k in order), places, np.array([0.0, x, y, apart]))

    @property
    def is_of_a_jaw(self) -> bool:
        """Whether all pegs belong to one jaw: all are moving, or all are fixed."""
        return self.sides[0] == self.sides[-1]

    @cached_property
    def key(self) -> tuple[object, ...]:
        """A key that is equal for subsets whose pegs have the same places, radii and gap, so that their
        patterns agree.
        """
        return self.whole.radii, self.whole.frame.sign, self.whole.gap, self.sides, self.places

    @cached_property
    def pattern(self) -> Pattern:
        """The pattern of these pegs alone. The gap limits its separations, but no other stop does."""
        whole, alone = self.whole, (np.array(self.places), np.array(self.sides, dtype=np.int64))
        made = Pattern(*alone, whole.radii, -inf, inf, whole.frame, self.numbers, None, whole.gap)
        if whole.gap is None or self.is_of_a_jaw:
            return made
        stop, widest = made.find_gap_limits(whole.gap)
        return evolve(made, stop=stop - SLACK, widest=widest + SLACK)

    @cached_property
    def numbers_and_shift(self) -> tuple[float, ...]:
        """The columns JAW, NAMES and SHIFT of ``kernels.seating.gathering``.

        These are the jaw (0 or 1, or -1 for pegs of both jaws), the pegs' indices filled up to four with -1,
        and x, y and S of the shift.
        """
        jaw = self.sides[0] if self.is_of_a_jaw else -1
        names = *self.numbers, *[-1] * (4 - len(self.numbers))
        return (jaw, *names, *self.shift[1:].tolist())


@lru_cache(maxsize=SIDES)
def list_peg_places(pattern: Pattern) -> tuple[list[list[float]], list[int], list[list[tuple[float, float]]]]:
    """Return for the pegs of a pattern (1) their places in mm, (2) 1 for each that moves, else 0, (3) their
    differences.

    The third result is beside[i][j] = (x, y) of peg j minus peg i, rounded to ``DECIMALS``.
    """
    pegs = pattern.pegs.tolist()
    return (
        pegs,
        pattern.right.tolist(),
        [[(round_length(x - left), round_length(y - low)) for x, y in pegs] for left, low in pegs],
    )


def round_length(x: float) -> float:
    """Return a length in mm rounded to ``DECIMALS``, with 0.0 for -0.0."""
    return round(x, DECIMALS) + 0.0


@lru_cache(maxsize=SIDES)
def list_subsets(pattern: Pattern) -> tuple[PegSubset, ...]:
    """Return the subsets of a pattern's pegs that can balance or fix a part. The result is cached.

    These are all pairs of one peg of each jaw, the two pegs of a jaw that has exactly two, and all sets of
    three pegs.
    """
    right, every = pattern.right.tolist(), range(len(pattern.right))
    two = [(i, j) for i, j in combinations(every, 2) if right[i] != right[j] or right.count(right[i]) == 2]
    return tuple(PegSubset.from_pattern(pattern, numbers) for numbers in (*two, *combinations(every, 3)))


@lru_cache(maxsize=SIDES)
def list_jaw_subsets(pattern: Pattern) -> dict[int, PegSubset]:
    """Return for each jaw (0 fixed, 1 moving) the subset of all its pegs. The result is cached."""
    sides = dict.fromkeys(pattern.right.tolist())
    return {
        side: PegSubset.from_pattern(pattern, np.flatnonzero(pattern.right == side).tolist())
        for side in sides
    }
