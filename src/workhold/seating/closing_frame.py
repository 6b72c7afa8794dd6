"""How a toolkit is turned for seating, and what its patterns of pegs have in common.

A toolkit is turned by quarters until what moves in it opens along x, and clamps as its separation S falls.
Where opening clamps, S is the travel with the other sign. So an opening vise is turned by half, and a clamp
along a column by a quarter.

Glossary
--------
closing frame : a task frame, which lies as the task is described most easily: M. T. Mason, "Compliance and
    force control for computer controlled manipulators", IEEE Transactions on Systems, Man, and Cybernetics 11
    (1981).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.fixels.carrier import Travel
from workhold.fixels.contacts import WALL_END
from workhold.fixels.toolkit import Carrier, Toolkit

__all__ = ["ClosingFrame", "CommonToPatterns", "refuse_unseated"]

Array = NDArray[np.float64]
# Carriers of which is kept what their patterns have in common.
TOOLKITS = 64
QUARTERS = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))


@frozen
class ClosingFrame:
    """A change from a toolkit's frame to that of seating, and back.

    Parameters
    ----------
    quarters : by how many quarter turns the toolkit is turned.
    sign : 1 where S is the travel, -1 where it is the travel with the other sign.
    """

    quarters: int
    sign: float

    @classmethod
    def of(cls, toolkit: Toolkit, carrier: Carrier) -> ClosingFrame:
        """The closing frame of a toolkit in which a carrier moves."""
        assert carrier.travel is not None
        x, y = (toolkit.clamping * part for part in carrier.travel.unit)
        return cls(-QUARTERS.index((round(x) + 0.0, round(y) + 0.0)) % 4, float(toolkit.clamping))

    def turned(self, points: Array, back: bool = False) -> Array:
        """Points or directions (..., 2) of the toolkit's frame as they lie in that of seating, or back."""
        cosine, sine = QUARTERS[self.quarters]
        sine = -sine if back else sine
        return np.asarray(points @ np.array([[cosine, sine], [-sine, cosine]]) + 0.0)

    def enter(self, config: Array) -> Array:
        """A configuration (4,) of theta, x, y and travel as one of theta, x, y and S."""
        return np.array(
            [config[0] + self.quarters * np.pi / 2, *self.turned(config[1:3]), self.sign * config[3]]
        )

    def leave(self, configs: Array) -> Array:
        """Configurations (..., 4) of theta, x, y and S as those of theta, x, y and travel."""
        out = np.array(configs)
        out[..., 0] -= self.quarters * np.pi / 2
        out[..., 1:3] = self.turned(configs[..., 1:3], back=True)
        out[..., 3] *= self.sign
        return out


@frozen(eq=False)
class CommonToPatterns:
    """What the patterns of all fixtures have in common whose pegs stand on the same carriers.

    Parameters
    ----------
    travel : of what moves.
    frame, right, radii, numbers, half_plane : as of ``Pattern``.
    """

    travel: Travel
    frame: ClosingFrame
    right: NDArray[np.int64]
    radii: tuple[float, float]
    numbers: tuple[int, ...]
    half_plane: tuple[float, float, float] | None

    @classmethod
    @lru_cache(maxsize=TOOLKITS)
    def of(cls, toolkit: Toolkit, names: tuple[str, ...]) -> CommonToPatterns:
        """What patterns on carriers of some names have in common.

        Raises
        ------
        InputError
            As ``Pattern.of``.
        """
        refuse_unseated(toolkit)
        standing_on = [toolkit.carrier(name) for name in names]
        numbers = tuple(k for k, carrier in enumerate(standing_on) if carrier.contact.is_placed)
        carriers = [standing_on[k] for k in numbers]
        moving = next(carrier for carrier in carriers if carrier.travel is not None)
        standing = next(carrier for carrier in carriers if carrier.travel is None)
        frame = ClosingFrame.of(toolkit, moving)
        right = np.array([int(carrier.travel is not None) for carrier in carriers], dtype=np.int64)
        half_plane = None
        if WALL_END in toolkit.contacts:
            # It runs along x at y = 0, the part above it.
            x, y = frame.turned(np.array([0.0, 1.0])).tolist()
            half_plane = x, y, 0.0
        assert moving.travel is not None
        radii = standing.peg_radius, moving.peg_radius
        return cls(moving.travel, frame, right, radii, numbers, half_plane)


def refuse_unseated(toolkit: Toolkit) -> None:
    """Refuses toolkits for which seats of closing are not sought.

    Raises
    ------
    InputError
        With two clamps, where no peg stands still, for pegs with a flat, and for pegs without a radius.
    """
    words = "what a part does while it is clamped is stated"
    if not toolkit.closes_at_once:
        raise InputError(f"{words} of one clamp: with two the part is put against its locators by hand.")
    if all(plate.travel is not None for plate in toolkit.plates):
        raise InputError(f"{words} where some pegs stand still, and no peg of this result stands still.")
    if toolkit.has_flats:
        raise InputError(f"{words} of round pegs: those of this result have flats.")
    if min(carrier.peg_radius for carrier in toolkit.carriers if carrier.contact.is_placed) <= 0.0:
        raise InputError("pegs of radius 0 roll around no corner: give the pegs a radius, however small.")
