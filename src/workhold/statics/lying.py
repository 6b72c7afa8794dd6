"""How a part lies in the jaws, and how large the faces are that it is held by.

Glossary
--------
main direction : in degrees in [0, 90): of all directions of straight faces, those a quarter turn apart counted as one, that
    with the most length of faces, told by the longest of them (the first of equally long ones). Where no face is straight,
    or another direction has about as much, the drawing's own x.
tilt : angle between the main direction and the nearest of the directions of the jaws, x and y.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import FIGURE_DECIMALS, MAIN_DIRECTION, SQUARE_TILT
from workhold.geometry.segment import Arc, Line
from workhold.model.workpiece import Workpiece

__all__ = ["face_sizes", "main_direction", "tilts"]

Array = NDArray[np.float64]


def main_direction(workpiece: Workpiece) -> float:
    """The main direction of a part, in the frame of its drawing."""
    lines = [face.segment for face in workpiece.faces if isinstance(face.segment, Line)]
    if not lines:
        return 0.0
    ends = np.array([(*line.start, *line.end) for line in lines])
    along = ends[:, 2:] - ends[:, :2]
    angle, length = np.degrees(np.arctan2(along[:, 1], along[:, 0])) % 90.0, np.hypot(*along.T)
    order = np.argsort(angle)
    # Once more a quarter turn below and above, so that 0 and 90 degrees are neighbours.
    around = np.concatenate([angle[order] + turn for turn in (-90.0, 0.0, 90.0)])
    sums = np.concatenate([[0.0], np.cumsum(np.tile(length[order], 3))])
    low, high = np.searchsorted(around, angle - SQUARE_TILT), np.searchsorted(around, angle + SQUARE_TILT)
    total = sums[high] - sums[low]
    rivals = total >= MAIN_DIRECTION * total.max()
    chosen = angle[rivals][np.round(length[rivals], FIGURE_DECIMALS).argmax()]
    alone = (np.abs((angle[rivals] - chosen + 45.0) % 90.0 - 45.0) < 2 * SQUARE_TILT).all()
    return float(chosen) if alone else 0.0


def tilts(theta: Array, direction: float) -> Array:
    """Tilts (N,) in degrees, from 0 to 45, of a part turned by theta (N,) in radians; 0 where it lies square."""
    off = np.abs((np.degrees(theta) + direction + 45.0) % 90.0 - 45.0)
    return np.where(off < SQUARE_TILT, 0.0, off)


def face_sizes(workpiece: Workpiece) -> Array:
    """Size (S,) in mm of the face of each number, NaN where there is none: the length of a straight one, an arc's radius."""
    sizes = np.full(len(workpiece.segments), np.nan)
    for face in workpiece.faces:
        sizes[face.number] = face.segment.radius if isinstance(face.segment, Arc) else face.segment.length
    return sizes
