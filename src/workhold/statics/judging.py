"""What to beware of in a fixture, and what counts against it: for sheet, terminal, page and order alike.

Glossary
--------
warning : a contact near an edge (one for each), a weak closure, a strong peg, a large location error, a peg
    that lets go under a load. At a jaw force that is known also a peg that is bent too hard, and pegs that give
    way too far.
unfit : of a fixture that is none for a workshop, because the part lies anywhere or one peg hardly holds.
penalty : points against a fixture. One stands for a location error 12 % larger (ISO 3, series R20). Tilt, a
    strong peg and a small face cost so many points each.
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
from workhold.statics.pins import limits_of

__all__ = [
    "Judging",
    "is_astray",
    "is_beyond",
    "is_near_edge",
    "is_strong",
    "is_unfit",
    "is_weak",
    "lets_go",
    "unfit",
]

Array = NDArray[np.float64]


@frozen
class Judging:
    """What fixtures of one query are judged by.

    Parameters
    ----------
    off : sum of the tolerances of peg and face in mm.
    small_face : in mm; a face is small below it.
    jaw_force : that the vise is closed with, in N; None where it is not known, and no peg is warned of that
        lets go, or bends.
    bending : largest bending stress of a pin in MPa, and farthest that pins may move the part in mm.
    """

    off: float
    small_face: float
    jaw_force: float | None
    bending: tuple[float, float] = (PIN_STRESS_LIMIT, PIN_MOVEMENT_LIMIT)

    @classmethod
    def of(
        cls, length: float, toolkit: Toolkit, tolerance: Tolerance, jaw_force: float | None = None
    ) -> Judging:
        """Limits for a toolkit, a tolerance, and a jaw force in N if it is known.

        The length L of the wrenches in mm is half the part's diameter and the radius of the largest peg.
        """
        diameter = 2 * (length - max(carrier.peg_radius for carrier in toolkit.carriers))
        return cls(tolerance.peg + tolerance.face, SMALL_FACE * diameter, jaw_force, limits_of(toolkit))

    def warnings(self, quality: Array, edges: Array) -> Array:
        """Numbers of warnings (N,) from figures (N, 12) and contacts' distances from edges (N, 4)."""
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

    def penalty(self, quality: Array) -> Array:
        """Points (N,) against fixtures, from figures of quality (N, 12)."""
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
    """Whether a contact is near an edge, from its distance in mm or an array of them."""
    return np.round(distance, FIGURE_DECIMALS) < NEAR_EDGE


def is_weak(margin: Any) -> Any:
    """Whether a closure is weak, from its margin or an array of them."""
    return np.round(margin, FIGURE_DECIMALS) < WEAK_CLOSURE


def is_strong(force: Any) -> Any:
    """Whether a peg is strong, from its force per unit of jaw force or an array of them."""
    return np.round(force, FIGURE_DECIMALS) > STRONG_PEG


def is_astray(error: Any, off: float) -> Any:
    """Whether location errors in mm, one or an array, are large; ``off`` sums the tolerances in mm."""
    return np.round(error, FIGURE_DECIMALS) > LARGE_LOCATION_ERROR * off


def lets_go(needed: Any, jaw_force: float) -> Any:
    """Whether a peg lets go at a jaw force, from the one needed or an array of them, all in N."""
    return needed > jaw_force * (1.0 + NO_FORCE)


def is_beyond(value: Any, limit: float) -> Any:
    """Whether a bending stress or a movement by bent pegs, or an array of them, is beyond its limit."""
    return np.round(value, FIGURE_DECIMALS) > limit


def is_unfit(margin: Any, error: Any, off: float) -> Any:
    """Whether closure margin and location error (mm), or arrays of them, rule a fixture out of a workshop.

    ``off`` is the sum of the tolerances of peg and face in mm. What is no number is unfit.
    """
    closes = np.round(margin, FIGURE_DECIMALS) >= UNFIT_CLOSURE
    return np.logical_not(closes & (np.round(error, FIGURE_DECIMALS) <= UNFIT_LOCATION_ERROR * off))


def unfit(quality: Array, tolerance: Tolerance) -> NDArray[np.bool_]:
    """Which fixtures (N,) are none for a workshop, from figures of quality (N, 12)."""
    off = tolerance.peg + tolerance.face
    return np.asarray(is_unfit(quality[:, CLOSURE_MARGIN], quality[:, LOCATION_ERROR], off))
