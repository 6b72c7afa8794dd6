"""Places where tools and loads press on a part, and their forces; used to compute how far the part moves
there.
"""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
from attrs import field, frozen
from numpy.typing import NDArray

from workhold.model.query import Query
from workhold.statics.jaw_program import CuttingPieces

__all__ = ["CutterLoads", "list_cutter_loads"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# How far apart places along a path are looked at, in mm, and directions of a range.
APART, DIRECTIONS = 5.0, 24
# Places at which the part is loaded, at most; what presses elsewhere is looked at at the nearest of them.
MOST_PLACES = 16


@frozen(eq=False)
class CutterLoads:
    """Forces and moments that tools and loads exert on the part at N places.

    Parameters
    ----------
    points : (N, 3) in mm, in the part's coordinates.
    force, torque : (N,) force in the plane in N, and moment about z in N mm; a tool's moment may have either
        sign.
    axial : (N, 2) least and greatest force downward, in N.
    middle, half : (N,) directions of the force in the plane: from middle - half to middle + half, in radians.
    row : (N,) index of the program's move; for a load, minus its number from 1.
    chosen : (P,) indices of places far from each other, at which the part is loaded.
    owner : (N,) index into ``chosen`` of the chosen place nearest to each place.
    """

    points: Array
    force: Array
    torque: Array
    axial: Array
    middle: Array
    half: Array
    row: IntArray
    chosen: IntArray = field(init=False)
    owner: IntArray = field(init=False)

    def __attrs_post_init__(self) -> None:
        chosen, owner = self.choose_places()
        object.__setattr__(self, "chosen", chosen)
        object.__setattr__(self, "owner", owner)

    def __len__(self) -> int:
        return len(self.row)

    def list_vectors(self, number: int) -> Array:
        """Return the extreme loads (V, 4) at place ``number``: forces along x, y and z in N, and the moment
        about z in N mm.
        """
        span = np.linspace(-1.0, 1.0, DIRECTIONS) if self.half[number] > 0.0 else np.zeros(1)
        angles = self.middle[number] + self.half[number] * span
        torque, own = float(self.torque[number]), self.force[number]
        turns = (torque, -torque) if self.row[number] >= 0 and torque else (torque,)
        return np.array(
            [
                (own * np.cos(angle), own * np.sin(angle), -axial, turn)
                for angle in angles
                for axial in np.unique(self.axial[number])
                for turn in turns
            ]
        )

    def choose_places(self) -> tuple[IntArray, IntArray]:
        """Return (chosen, owner) as described at the class: places far from each other, and for each place
        the nearest of these.
        """
        chosen = [int(np.hypot(self.force, np.abs(self.axial).max(axis=1)).argmax())]
        nearest = np.linalg.norm(self.points - self.points[chosen[0]], axis=1)
        owner = np.zeros(len(self), np.int64)
        while len(chosen) < min(MOST_PLACES, len(self)) and nearest.max() > 1e-9:
            farthest = int(nearest.argmax())
            away = np.linalg.norm(self.points - self.points[farthest], axis=1)
            owner[away < nearest] = len(chosen)
            nearest = np.minimum(nearest, away)
            chosen.append(farthest)
        return np.array(chosen, np.int64), owner


def list_cutter_loads(query: Query, height: float) -> CutterLoads | None:
    """Return the forces that the query's program and its loads exert on the part; None when it has neither.

    ``height`` is the part's height in mm.
    """
    rows = [*list_program_rows(query, height), *list_load_rows(query, height)]
    if not rows:
        return None
    points, force, torque, least, most, middle, half, row = (np.array(one) for one in zip(*rows, strict=True))
    return CutterLoads(
        points, force, torque, np.column_stack([least, most]), middle, half, row.astype(np.int64)
    )


def list_program_rows(query: Query, height: float) -> list[tuple[Any, ...]]:
    """Return rows (point, force, torque, least axial, greatest axial, middle, half, move) at places along
    each cut.

    The fields are those of :class:`CutterLoads`; the list is empty without a program. ``height`` is the
    part's height in mm.
    """
    if query.program is None:
        return []
    pieces = CuttingPieces.from_program(query.program, height)
    rows: list[tuple[Any, ...]] = []
    for k in range(len(pieces)):
        start, end = pieces.start[k], pieces.end[k]
        count = int(np.ceil(np.linalg.norm(end - start) / APART)) + 1
        low, high = pieces.axial[k]
        rows += [
            (
                start + share * (end - start),
                pieces.force[k],
                pieces.torque[k],
                low,
                high,
                pieces.middle[k],
                pieces.half[k],
                pieces.move[k],
            )
            for share in np.linspace(0.0, 1.0, max(count, 2))
        ]
    return rows


def list_load_rows(query: Query, height: float) -> list[tuple[Any, ...]]:
    """Return a row as :func:`list_program_rows` does for each point of each load. The last field is minus the
    load's number, counted from 1.
    """
    rows: list[tuple[Any, ...]] = []
    for number, load in enumerate(query.loads):
        low, high = np.radians(load.directions)
        top = height if load.height is None else min(max(load.height, 0.0), height)
        for point in load.points or (query.workpiece.center,):
            there = np.array([*point, top])
            half = min(float(high - low) / 2, pi)
            rows.append(
                (
                    there,
                    load.force,
                    load.moment,
                    -load.upward,
                    -load.upward,
                    (low + high) / 2,
                    half,
                    -1 - number,
                )
            )
    return rows
