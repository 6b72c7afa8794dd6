"""Four pegs of which those that move slide along x: what is solved once for all fixtures on them.

Glossary
--------
stop : the smallest separation, at which what moves is stopped without the part.
"""

from __future__ import annotations

from functools import cached_property
from math import inf, sqrt
from typing import Any

import numpy as np
from attrs import define, evolve
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.seating.closing_frame import ClosingFrame

__all__ = ["Pattern", "refuse_unseated"]

Array = NDArray[np.float64]
# mm. Peg patterns that agree to this are one: places are whole steps of a lattice.
SAME_PATTERN = 1e-6
# mm. A clamp's tip may be in a locator by this much: rounding.
APART = 1e-6
# mm. How much farther apart than both could touch the part pegs are at the end of a descent without a stop.
BEYOND = 1.0


@define(frozen=True, eq=False)
class Pattern:
    """Four pegs, in their closing frame.

    Parameters
    ----------
    pegs : (4, 2) their places in mm at separation 0.
    right : (4,) 1 for those that move, such as pegs of the right jaw, 0 for others.
    radii : in mm, of the pegs that stand still and of those that move.
    stop, widest : the smallest and the largest separation in mm, infinite where nothing stops what moves.
    frame : leads to the toolkit's frame and back.
    numbers : their places (4,) in the fixture's pegs.
    half_plane : what a wall leaves free, with two pegs: the unit vector into it, along x or y, and how far in
        mm along it the wall is. None without a wall.
    gap : least distance in mm along x that pegs of both jaws keep, None where none is asked for.
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
    def of(cls, fixture: Fixture, toolkit: Toolkit) -> Pattern:
        """The pattern of a fixture's pegs.

        Raises
        ------
        InputError
            With two clamps, for pegs with a flat, and for pegs without a radius.
        """
        refuse_unseated(toolkit)
        numbers = tuple(k for k, peg in enumerate(fixture.pegs) if not peg.is_on_wall)
        carriers = [toolkit.carrier(fixture.pegs[k].carrier) for k in numbers]
        moving = next(carrier for carrier in carriers if carrier.travel is not None)
        standing = next(carrier for carrier in carriers if carrier.travel is None)
        frame = ClosingFrame.of(toolkit, moving)
        right = np.array([int(carrier.travel is not None) for carrier in carriers], dtype=np.int64)
        pegs = frame.turned(np.array([[fixture.pegs[k].x, fixture.pegs[k].y] for k in numbers], dtype=np.float64))
        half_plane = None
        if toolkit.wall is not None:
            # It runs along x at y = 0, the part above it.
            x, y = frame.turned(np.array([0.0, 1.0])).tolist()
            half_plane = x, y, 0.0
        pegs[:, 0] -= right * (frame.sign * fixture.jaw_separation)
        pattern = cls(
            pegs, right, (standing.peg_radius, moving.peg_radius), -inf, inf, frame, numbers, half_plane, toolkit.gap
        )
        stop, widest = pattern.free_of_locators(frame.sign * fixture.jaw_separation)
        if toolkit.gap is not None:
            stop, widest = pattern.gap_kept(toolkit.gap)
        assert moving.travel is not None
        if frame.sign < 0.0:
            stop = stop if moving.travel.most is None else max(stop, -moving.travel.most)
        elif toolkit.gap is None:
            stop = max(stop, moving.travel.least)
        return evolve(pattern, stop=stop, widest=widest)

    def gap_kept(self, gap: float) -> tuple[float, float]:
        """The stop and the widest separation that a gap between pegs of both jaws leaves.

        Jaws that close have a stop, and jaws that clamp by opening a widest separation.
        """
        left, right = self.pegs[self.right == 0, 0], self.pegs[self.right == 1, 0]
        if self.frame.sign > 0.0:
            return float(gap + left.max() - right.min()), inf
        return -inf, float(left.min() - right.max() - gap)

    def free_of_locators(self, separation: float) -> tuple[float, float]:
        """The separations, about a given one, at which a clamp's tip meets a locator before or behind it."""
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

    def end(self, diameter: float) -> float:
        """The smallest separation in mm that a descent leads to: the stop, if there is one.

        Without a stop no peg that moves touches a part of the diameter together with one that stands still.
        """
        left, right = self.pegs[self.right == 0, 0], self.pegs[self.right == 1, 0]
        return max(self.stop, float(left.min() - right.max()) - diameter - sum(self.radii) - BEYOND)

    @cached_property
    def order(self) -> NDArray[np.int64]:
        """(4,) the pegs from left to right, those that stand still before those that move."""
        return np.lexsort((self.pegs[:, 1], self.pegs[:, 0], self.right))

    def key(self) -> tuple[object, ...]:
        """A key that patterns share if they differ by a shift of all pegs and by their order."""
        moved = self.pegs[self.order] - self.pegs[self.order[0]]
        # Where separations are counted from is of no account.
        first = -int(self.right.sum())
        apart = moved[first, 0]
        moved[first:, 0] -= apart
        ends = [self.stop + apart, self.widest + apart]
        if self.half_plane is not None:
            ux, uy, off = self.half_plane
            ends += [ux / SAME_PATTERN, uy / SAME_PATTERN, off - float(self.pegs[self.order[0]] @ [ux, uy])]
        steps = np.rint(np.array(ends + moved.ravel().tolist()) / SAME_PATTERN) + 0.0
        return (*self.radii, *self.right[self.order].tolist(), *steps.tolist())

    def reaches(self, separation: Any, slack: float = 0.0) -> Any:
        """Whether separations, a number or many, are between the stop and the widest."""
        return (separation > self.stop + slack) & (separation < self.widest - slack)

    def at(self, configs: Array) -> Array:
        """Places (N, 4, 2) of the pegs on the part, in configurations (N, 4) of theta, x, y and S."""
        x = self.pegs[:, 0] + self.right * configs[:, 3:4] - configs[:, 1:2]
        y = self.pegs[:, 1] - configs[:, 2:3]
        cosine, sine = np.cos(configs[:, :1]), np.sin(configs[:, :1])
        out = np.empty((*x.shape, 2))
        out[:, :, 0], out[:, :, 1] = cosine * x + sine * y, cosine * y - sine * x
        return out


def refuse_unseated(toolkit: Toolkit) -> None:
    """Refuses toolkits for which seats of closing are not sought.

    Raises
    ------
    InputError
        With two clamps, where no peg stands still, for pegs with a flat, and for pegs without a radius.
    """
    words = "what a part does while it is clamped is told"
    if toolkit.needs_pairs:
        raise InputError(f"{words} of one clamp: with two the part is put against its locators by hand.")
    if all(plate.travel is not None for plate in toolkit.plates):
        raise InputError(f"{words} where some pegs stand still, and no peg of this result stands still.")
    if toolkit.has_flats:
        raise InputError(f"{words} of round pegs: those of this result have flats.")
    if min(carrier.peg_radius for carrier in toolkit.carriers if not carrier.is_wall) <= 0.0:
        raise InputError("pegs of radius 0 roll around no corner: give the pegs a radius, however small.")
