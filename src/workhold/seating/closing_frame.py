"""The frame in which seating is computed: what moves goes along x, and clamps as its separation S falls.

A toolkit is turned by quarters until what moves in it opens along x. Where opening clamps, S is the travel
with the other sign. So an opening vise is turned by half, and a clamp along a column by a quarter.

Glossary
--------
closing frame : a task frame, which lies as the task is described most easily: M. T. Mason, "Compliance and
    force control for computer controlled manipulators", IEEE Transactions on Systems, Man, and Cybernetics 11
    (1981).
"""

from __future__ import annotations

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.fixels.toolkit import Carrier, Toolkit

__all__ = ["ClosingFrame"]

Array = NDArray[np.float64]
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
        return np.array([config[0] + self.quarters * np.pi / 2, *self.turned(config[1:3]), self.sign * config[3]])

    def leave(self, configs: Array) -> Array:
        """Configurations (..., 4) of theta, x, y and S as those of theta, x, y and travel."""
        out = np.array(configs)
        out[..., 0] -= self.quarters * np.pi / 2
        out[..., 1:3] = self.turned(configs[..., 1:3], back=True)
        out[..., 3] *= self.sign
        return out
