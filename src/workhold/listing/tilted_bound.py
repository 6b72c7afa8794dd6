"""A bound of the rank of all tilted fixtures.

A tilt costs points, and no location error is small. Pegs are off by p and faces by f, so that a contact is
off by t = p + f along its normal. Along the tangent it is off by p or more as well, and by t where no arc is
touched by two pegs. So the location error is no less than sqrt(t^2 + p^2), or t sqrt 2 (theorem "tilted
fixtures" of docs/method-theorems.md).
"""

from __future__ import annotations

from math import hypot, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import SQUARE_TILT
from workhold.geometry.segment import Arc
from workhold.listing.ranking import best_possible, ranking_keys
from workhold.model.quality import LOCATION_ERROR, PENALTY, SMALLEST_FACE, TILT
from workhold.model.query import Query
from workhold.statics.judging import Judging
from workhold.statics.quality import face_sizes, main_direction

__all__ = ["square_angles", "tilted_keys"]

Array = NDArray[np.float64]

# Degrees beside square orientations that count as such: far more than any orientation is off.
BESIDE = 1e-3
# Location errors are rounded by less than this part.
SHARE = 1e-6


def square_angles(query: Query) -> list[tuple[float, float]]:
    """Ranges in degrees of the part's angle in which it may lie square."""
    direction, beside = main_direction(query.workpiece), SQUARE_TILT + BESIDE
    middles = [90.0 * k - direction for k in range(4)]
    return [(middle - beside, middle + beside) for middle in middles]


def tilted_keys(query: Query, problem: Problem) -> Array | None:
    """Keys (R,) that no tilted fixture ranks before; None where tilt has no say, or nothing is bounded.

    Parameters
    ----------
    query : what is asked.
    problem : the search of it, or of one of its directions.
    """
    toolkit, part = query.toolkit, query.workpiece
    if toolkit.has_flats or part.outlines:
        return None
    tilted, square = (least_keys(query, problem, tilt) for tilt in (SQUARE_TILT, 0.0))
    return None if (tilted == square).all() else tilted


def least_keys(query: Query, problem: Problem, tilt: float) -> Array:
    """Keys (R,) that no fixture of a tilt in degrees or more ranks before."""
    part, tolerance = query.workpiece, query.tolerance
    sizes, off = face_sizes(part), tolerance.peg + tolerance.face
    arcs = [face.number for face in part.numbered.faces if isinstance(face.segment, Arc)]
    # Whether two pegs share an arc or not.
    cases = [(sqrt(2.0) * off, np.nanmax(sizes))]
    if arcs:
        cases.append((hypot(off, tolerance.peg), sizes[arcs].max()))
    quality = best_possible(len(cases), query)
    quality[:, LOCATION_ERROR], quality[:, SMALLEST_FACE] = np.transpose(cases)
    quality[:, LOCATION_ERROR] *= 1.0 - SHARE
    quality[:, TILT] = tilt
    quality[:, PENALTY] = Judging.of(problem.wrench_length, query.toolkit, tolerance).penalty(quality)
    keys = np.stack(ranking_keys(quality, query.ranking, tolerance), axis=1)
    return np.asarray(keys[np.lexsort(keys.T[::-1])[0]])
