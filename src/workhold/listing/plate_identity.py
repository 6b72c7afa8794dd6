"""What names a fixture on a plate: holes, lines and places; not faces, of which a contact at a joint is on two."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, tau

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import SAME_POSE
from workhold.geometry.rotation import rotated
from workhold.geometry.symmetry import Rotation
from workhold.listing.distinct import kept_point, precedes
from workhold.listing.seats import ALONG, NAMES
from workhold.model.plate import Plate
from workhold.model.result import FixtureTable
from workhold.model.workpiece import Workpiece

__all__ = ["FAR", "clamps_of", "identity_order", "smallest_images"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Farther than any hole.
FAR = 1 << 30


def smallest_images(
    table: FixtureTable, toolkit: Plate, part: Workpiece, rotations: Sequence[Rotation], every: bool
) -> tuple[IntArray, Array]:
    """Of each fixture the first of the forms that a part's rotations give it: whole numbers (N, K), and orientations and
    places (N, P); of its clamps their directions alone, unless ``every`` choice of them is a fixture."""
    upright, tips = clamps_of(table, toolkit)
    pairs = [(one.direction or "").split() for one in toolkit.arrangements]
    opposed = np.array([len(set(pair)) == 2 and pair[0][1] == pair[1][1] for pair in pairs])[table.arrangement]
    kept, anchors = kept_point(part), np.stack([table.column, table.row], axis=2)[:, [0, 2]] * np.array(toolkit.pitch)
    best = np.zeros((0, 0), np.int64), np.zeros((0, 0))
    for rotation in rotations:
        theta = (table.theta - rotation.angle + SAME_POSE) % tau - SAME_POSE
        # Half a turn of everything makes a pair of opposite directions the same again, with the clamps swapped.
        turned = opposed & (theta >= pi - SAME_POSE)
        key, anchor = identity_numbers(table, upright, turned), np.where(turned[:, None], anchors[:, 1], anchors[:, 0])
        x, y = rotated(anchor[:, 0] - table.position[:, 0], anchor[:, 1] - table.position[:, 1], -table.theta)
        places = [np.where(turned, theta - pi, theta), *rotated(x - kept[0], y - kept[1], rotation.angle)]
        if every:
            ahead = tips - np.where(upright, anchor[:, [1]], anchor[:, [0]])
            places += [*np.where(turned[:, None], -ahead[:, ::-1], ahead).T]
        key, pose = key if every else key[:, :7], np.stack(places, axis=1)
        best = best if len(best[0]) else (key, pose)
        before = precedes([*key.T], pose, [*best[0].T], best[1])[:, None]
        best = np.where(before, key, best[0]), np.where(before, pose, best[1])
    return best


def clamps_of(table: FixtureTable, toolkit: Plate) -> tuple[BoolArray, Array]:
    """Which clamps (N, C) of fixtures push along columns, and where (N, C) on their lines their tips are, in mm."""
    directions = [[NAMES.index(name) for name in (one.direction or "").split()] for one in toolkit.arrangements]
    direction, plate = np.array(directions)[table.arrangement], toolkit.carriers[0]
    upright = direction >= NAMES.index("-y")
    columns, rows = (
        values[:, 3:] * pitch + first
        for values, pitch, first in zip((table.column, table.row), plate.pitch, plate.offset, strict=True)
    )
    travelled = ALONG[direction].sum(axis=2) * table.jaw_separation.reshape(direction.shape)
    return upright, np.where(upright, rows, columns) + travelled


def identity_numbers(table: FixtureTable, upright: BoolArray, turned: BoolArray) -> IntArray:
    """Directions (N, 1), locators' columns and rows (N, 6) and the lines of clamps (N, C), from the locators' lowest hole.

    Parameters
    ----------
    upright : (N, C) which clamps push along columns.
    turned : (N,) which fixtures are meant after half a turn of everything, which swaps the clamps.
    """
    first = [values[:, :3].min(axis=1, keepdims=True) for values in (table.column, table.row)]
    column, row = table.column[:, :3] - first[0], table.row[:, :3] - first[1]
    line = np.where(upright, table.column[:, 3:] - first[0], table.row[:, 3:] - first[1])
    width, height = column.max(axis=1, keepdims=True), row.max(axis=1, keepdims=True)
    back = turned[:, None]
    out = [
        table.arrangement[:, None],
        np.where(back, (width - column)[:, ::-1], column),
        np.where(back, (height - row)[:, ::-1], row),
        np.where(back, (np.where(upright, width, height) - line)[:, ::-1], line) + FAR,
    ]
    return np.hstack(out).astype(np.int64)


def identity_order(table: FixtureTable) -> NDArray[np.intp]:
    """The order of fixtures by type, holes, orientation, faces and place."""
    place = table.position @ np.array([1.0, 0.7548776662])
    columns = [*table.column.T, *table.row.T, np.round(table.theta / SAME_POSE), *table.face.T, place]
    return np.lexsort([*reversed(columns), table.arrangement])
