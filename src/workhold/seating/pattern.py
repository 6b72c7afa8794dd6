"""Four pegs on two jaws of which the right one slides along x: what is solved once for all fixtures on them."""

from __future__ import annotations

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.model.fixture import Fixture
from workhold.model.toolkit import Toolkit
from workhold.model.vise import OpeningVise, Vise

__all__ = ["Pattern", "refuse_unseated"]

Array = NDArray[np.float64]
# mm. Peg patterns that agree to this are one: places are whole steps of a lattice.
SAME_PATTERN = 1e-6


@define(frozen=True, eq=False)
class Pattern:
    """Four pegs.

    Parameters
    ----------
    pegs : (4, 2) their places in mm at jaw separation 0.
    right : (4,) 1 for those of the right jaw, 0 for others.
    radii : in mm, of the pegs that stand still and of those that move.
    gap : smallest distance in mm along x from a left peg to a right one.
    """

    pegs: Array
    right: NDArray[np.int64]
    radii: tuple[float, float]
    gap: float

    @classmethod
    def of(cls, fixture: Fixture, toolkit: Toolkit) -> Pattern:
        """The pegs of a fixture in a vise.

        Raises
        ------
        InputError
            In another toolkit, and for pegs without a radius.
        """
        refuse_unseated(toolkit)
        assert isinstance(toolkit, Vise)
        right = np.array([int(peg.carrier == "right") for peg in fixture.pegs], dtype=np.int64)
        places = np.array([[peg.x, peg.y] for peg in fixture.pegs], dtype=np.float64)
        places[:, 0] -= right * fixture.jaw_separation
        return cls(places, right, (toolkit.peg_radius, toolkit.peg_radius), toolkit.gap)

    @property
    def stop(self) -> float:
        """The smallest jaw separation in mm."""
        left, right = self.pegs[self.right == 0, 0], self.pegs[self.right == 1, 0]
        return float(self.gap + left.max() - right.min())

    def key(self) -> tuple[object, ...]:
        """What patterns share that differ by a shift of all pegs and by their order."""
        order = np.lexsort((self.pegs[:, 1], self.pegs[:, 0], self.right))
        moved = np.rint((self.pegs[order] - self.pegs[order[0]]) / SAME_PATTERN)
        return (*self.radii, self.gap, *self.right[order].tolist(), *(moved + 0.0).ravel().tolist())

    def at(self, configs: Array) -> Array:
        """Places (N, 4, 2) of the pegs on the part, in configurations (N, 4) of theta, x, y and S."""
        x = self.pegs[:, 0] + self.right * configs[:, 3:4] - configs[:, 1:2]
        y = self.pegs[:, 1] - configs[:, 2:3]
        cosine, sine = np.cos(configs[:, :1]), np.sin(configs[:, :1])
        return np.stack([cosine * x + sine * y, cosine * y - sine * x], axis=2)


def refuse_unseated(toolkit: Toolkit) -> None:
    """Refuse a toolkit of which no seating is worked out.

    Raises
    ------
    InputError
        For another one than a vise that closes, and for pegs without a radius.
    """
    if not isinstance(toolkit, Vise) or isinstance(toolkit, OpeningVise):
        raise InputError(
            "what a part does while it is clamped is told for a vise that closes: this result has another toolkit."
        )
    if toolkit.peg_radius <= 0.0:
        raise InputError("pegs of radius 0 roll around no corner: give the pegs a radius, however small.")
