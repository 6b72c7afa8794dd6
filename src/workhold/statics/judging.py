"""Warnings and penalty points of fixtures, the same for sheet, terminal, page and ranking.

Glossary
--------
warning : a contact near an edge (one for each), a weak closure, a strong peg, a large location error, a peg
    that lets go under a load. With a known jaw force, also a peg with too much bending stress, and pegs that
    give way too far.
unfit : a fixture is unfit for a workshop if it hardly determines the part's place or a peg hardly presses.
penalty : points against a fixture. One point stands for a location error that is 12 % larger (ISO 3, series
    R20). A tilt, a strong peg and a small face cost a number of points each.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import (
    FIGURE_DECIMALS,
    GENTLE_PEG,
    LARGE_LOCATION_ERROR,
    NEAR_EDGE,
    NO_FORCE,
    PIN_MOVEMENT_LIMIT,
    PIN_STRESS_LIMIT,
    POINTS_PER_DECADE,
    SMALL_FACE,
    SMALL_FACE_POINTS,
    STRONG_PEG,
    STRONG_POINTS,
    TILTED_POINTS,
    UNFIT_CLOSURE,
    UNFIT_LOCATION_ERROR,
    WEAK_CLOSURE,
)
from workhold.fixels.toolkit import Toolkit
from workhold.model.quality import (
    CLAMP_AMPLIFICATION,
    CLOSURE_MARGIN,
    JAW_FORCE_NEEDED,
    LOCATION_ERROR,
    PIN_MOVEMENT,
    PIN_STRESS,
    SMALLEST_FACE,
    TILT,
    list_figures_in_columns,
)
from workhold.model.requirements import Tolerance
from workhold.statics.pins import get_limits

__all__ = [
    "JudgingLimits",
    "is_astray",
    "is_beyond",
    "is_near_edge",
    "is_strong",
    "is_unfit",
    "is_weak",
    "lets_go",
    "are_unfit",
]

Array = NDArray[np.float64]


@frozen
class JudgingLimits:
    """Limits by which the fixtures of a query are judged.

    Parameters
    ----------
    off : sum of the tolerances of peg and face, in mm.
    small_face : size in mm below which a face is small.
    jaw_force : force in N that closes the vise; None if not given: then there are no warnings of pegs that
        let go or bend.
    bending : largest bending stress of a pin in MPa, and largest movement of the part by pins in mm.
    """

    off: float
    small_face: float
    jaw_force: float | None
    bending: tuple[float, float] = (PIN_STRESS_LIMIT, PIN_MOVEMENT_LIMIT)

    @classmethod
    def from_toolkit(
        cls, length: float, toolkit: Toolkit, tolerance: Tolerance, jaw_force: float | None = None
    ) -> JudgingLimits:
        """Return the limits for a toolkit, a tolerance, and a jaw force in N (None where not given).

        ``length`` is the length L in mm that moments are divided by: half the part's diameter plus the radius
        of the largest peg.
        """
        diameter = 2 * (length - max(carrier.peg_radius for carrier in toolkit.carriers))
        return cls(tolerance.peg + tolerance.face, SMALL_FACE * diameter, jaw_force, get_limits(toolkit))

    def count_warnings(self, quality: Array, edges: Array) -> Array:
        """Return the number of warnings of each fixture, (N,).

        ``quality`` (N, F) are figures of quality, ``edges`` (N, P) distances of the P contacts from edges, in
        mm.
        """
        count = is_near_edge(edges).sum(axis=1) + is_weak(quality[:, CLOSURE_MARGIN])
        count = (
            count
            + is_strong(quality[:, CLAMP_AMPLIFICATION])
            + is_astray(quality[:, LOCATION_ERROR], self.off)
        )
        if self.jaw_force is not None:
            count = count + lets_go(quality[:, JAW_FORCE_NEEDED], self.jaw_force)
            if len(list_figures_in_columns(quality.shape[1])) > PIN_MOVEMENT:
                stress, movement = self.bending
                count = count + is_beyond(quality[:, PIN_STRESS], stress)
                count = count + is_beyond(quality[:, PIN_MOVEMENT], movement)
        return np.asarray(count, np.float64)

    def compute_penalty(self, quality: Array) -> Array:
        """Return penalty points (N,) from figures of quality (N, F); NaN where the location error is NaN."""
        error = quality[:, LOCATION_ERROR]
        points = np.zeros(len(error))
        if self.off > 0.0:
            times = np.maximum(error / self.off, np.finfo(float).tiny)
            points = np.ceil(np.round(POINTS_PER_DECADE * np.log10(times), FIGURE_DECIMALS))
        strong, face = (
            np.round(quality[:, number], FIGURE_DECIMALS) for number in (CLAMP_AMPLIFICATION, SMALLEST_FACE)
        )
        points = points + TILTED_POINTS * (quality[:, TILT] > 0.0) + STRONG_POINTS * (strong > GENTLE_PEG)
        points = points + SMALL_FACE_POINTS * (face < np.round(self.small_face, FIGURE_DECIMALS))
        # No negative zero, which would be written as such.
        return np.asarray(np.where(np.isnan(error), np.nan, points + 0.0))


def is_near_edge(distance: Any) -> Any:
    """Return whether a contact is near an edge; ``distance`` in mm is a number or an array."""
    return np.round(distance, FIGURE_DECIMALS) < NEAR_EDGE


def is_weak(margin: Any) -> Any:
    """Return whether a closure is weak; the closure margin is a number or an array."""
    return np.round(margin, FIGURE_DECIMALS) < WEAK_CLOSURE


def is_strong(force: Any) -> Any:
    """Return whether a peg carries a large force; ``force`` per unit of jaw force is a number or an array."""
    return np.round(force, FIGURE_DECIMALS) > STRONG_PEG


def is_astray(error: Any, off: float) -> Any:
    """Return whether a location error is too large; ``error`` in mm is a number or an array.

    ``off`` is the sum of the tolerances of peg and face in mm.
    """
    return np.round(error, FIGURE_DECIMALS) > LARGE_LOCATION_ERROR * off


def lets_go(needed: Any, jaw_force: float) -> Any:
    """Return whether a peg lets go at a jaw force in N.

    ``needed`` is the jaw force in N below which the peg lets go, a number or an array.
    """
    return needed > jaw_force * (1.0 + NO_FORCE)


def is_beyond(value: Any, limit: float) -> Any:
    """Return whether a value is above its limit, by more than rounding.

    ``value`` is a bending stress, or a movement of the part by bent pegs; a number or an array.
    """
    return np.round(value, FIGURE_DECIMALS) > limit


def is_unfit(margin: Any, error: Any, off: float) -> Any:
    """Return whether a closure margin and a location error in mm make a fixture unfit for a workshop.

    Both are numbers or arrays; NaN is unfit. ``off`` is the sum of the tolerances of peg and face in mm.
    """
    closes = np.round(margin, FIGURE_DECIMALS) >= UNFIT_CLOSURE
    return np.logical_not(closes & (np.round(error, FIGURE_DECIMALS) <= UNFIT_LOCATION_ERROR * off))


def are_unfit(quality: Array, tolerance: Tolerance) -> NDArray[np.bool_]:
    """Return a mask (N,): True for fixtures unfit for a workshop, from figures of quality (N, F)."""
    off = tolerance.peg + tolerance.face
    return np.asarray(is_unfit(quality[:, CLOSURE_MARGIN], quality[:, LOCATION_ERROR], off))
