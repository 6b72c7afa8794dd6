"""A set-up in the vise frame: the part in its pose, and as much of the two plates as part and pegs reach over.

The frame is the vise's: millimetres, x to the right, the origin at the left jaw's hole L-A1.
"""

from __future__ import annotations

from math import ceil, cos, floor, inf, radians, sin

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.geometry.segment import Point
from workhold.model.fixture import Fixture, Jaw, Pose
from workhold.model.result import LEFT, RIGHT, hole_position
from workhold.model.vise import Vise
from workhold.model.workpiece import Workpiece

__all__ = ["Plate", "plate_of", "posed", "posed_workpiece"]

# Of the jaw separation, how much a plate may cover from either side: the two do not touch.
SHARE_OF_GAP = 0.48
# With more holes than this a plate shows only those between its pegs and the opening.
MOST_HOLES = 2_000
# Relative to the pitch: a hole this little beyond reach is in it.
ROUNDING = 1e-6


@frozen
class Plate:
    """A jaw's plate in mm in the vise frame.

    Parameters
    ----------
    low, high : lower left and upper right corner.
    holes : (column, row) and centre of each hole.
    """

    low: Point
    high: Point
    holes: tuple[tuple[tuple[int, int], Point], ...]


def posed(points: NDArray[np.float64], pose: Pose) -> NDArray[np.float64]:
    """Workpiece points (N, 2) in the vise frame."""
    c, s = cos(radians(pose.theta_deg)), sin(radians(pose.theta_deg))
    return np.asarray(points @ np.array([[c, s], [-s, c]]) + np.array([pose.x, pose.y]))


def posed_workpiece(workpiece: Workpiece, pose: Pose) -> Workpiece:
    """The workpiece as it lies in the vise; turning and moving it keep its bulges."""
    loops = tuple(np.column_stack([posed(loop[:, :2], pose), loop[:, 2]]) for loop in workpiece.loops)
    return Workpiece(workpiece.name, loops)


def plate_of(jaw: Jaw, fixture: Fixture, part: Workpiece, vise: Vise) -> Plate:
    """The plate of one jaw; ``part`` is the workpiece in its pose."""
    index = LEFT if jaw == "left" else RIGHT
    origin = hole_position(vise, index, 0, 0, fixture.jaw_separation)
    pegs = [peg for peg in fixture.pegs if peg.jaw == jaw]
    columns, rows = [peg.column for peg in pegs], [peg.row for peg in pegs]
    # The column next to the opening belongs to it: the jaw separation is measured from there.
    columns.append(vise.columns - 1 if jaw == "left" else 0)
    x0, y0, x1, y1 = part.bounds
    wide = columns + reached(x0 - origin[0], x1 - origin[0], vise.pitch[0], vise.columns)
    high = rows + reached(y0 - origin[1], y1 - origin[1], vise.pitch[1], vise.rows)
    if (max(wide) - min(wide) + 1) * (max(high) - min(high) + 1) > MOST_HOLES:
        wide, high = columns, rows
    holes = tuple(
        ((column, row), hole_position(vise, index, column, row, fixture.jaw_separation))
        for column in range(min(wide), max(wide) + 1)
        for row in range(min(high), max(high) + 1)
    )
    half_x, half_y = vise.pitch[0] / 2, vise.pitch[1] / 2
    inner = min(half_x, SHARE_OF_GAP * fixture.jaw_separation)
    left, right = (half_x, inner) if jaw == "left" else (inner, half_x)
    (first_x, first_y), (last_x, last_y) = holes[0][1], holes[-1][1]
    return Plate((first_x - left, first_y - half_y), (last_x + right, last_y + half_y), holes)


def reached(low: float, high: float, pitch: float, limit: int | None) -> list[int]:
    """First and last column or row between two distances in mm from the first one; none when they lie off the jaw."""
    last = (inf if limit is None else limit) - 1
    first_reached = max(ceil(low / pitch - ROUNDING), 0)
    last_reached = min(floor(high / pitch + ROUNDING), last)
    return [first_reached, int(last_reached)] if first_reached <= last_reached else []
