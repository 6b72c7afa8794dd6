"""Counting fixtures that a rotation of the part onto itself carries into each other as one."""

from __future__ import annotations

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from holdfast.geometry.symmetry import rotations_onto_itself
from holdfast.listing.finish import SAME_POSE, Candidates, standing
from holdfast.model.workpiece import Workpiece

__all__ = ["count_distinct"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def keys_and_pose(c: Candidates, angle: float, image: IntArray, size: float) -> tuple[IntArray, Array]:
    """Fixtures after the part is turned onto itself: (N, 13) type, faces and holes, and (N,) a number for the pose.

    ``image`` maps the faces that ``c.feature`` holds; ``size`` in mm brings lengths to the scale of angles.
    """
    moved = standing(evolve(c, feature=image[c.feature], theta=c.theta - angle))
    # Same faces, holes and orientation still leave a choice of places; the opening tells those apart.
    return np.concatenate(
        [moved.kind[:, None], moved.feature, moved.column, moved.row], axis=1
    ), moved.theta + moved.opening / size


def precedes(a: IntArray, a_pose: Array, b: IntArray, b_pose: Array) -> NDArray[np.bool_]:
    """Which rows of (key, pose) come before others in lexicographic order."""
    before = np.zeros(len(a), np.bool_)
    level = np.ones(len(a), np.bool_)
    for k in range(a.shape[1]):
        before |= level & (a[:, k] < b[:, k])
        level &= a[:, k] == b[:, k]
    return before | (level & (a_pose < b_pose - SAME_POSE))


def count_distinct(c: Candidates, face: IntArray, workpiece: Workpiece) -> dict[str, int]:
    """How many sets of each type the fixtures form when those equivalent under the part's rotations count once.

    Parameters
    ----------
    c : the fixtures, each listed once.
    face : (N, 4) numbers of the faces their pegs touch.
    """
    if len(face) == 0:
        return {"I": 0, "II": 0}
    faces = workpiece.faces
    numbers = np.array([f.number for f in faces])
    x0, y0, x1, y1 = workpiece.bounds
    named = evolve(c, feature=face)
    best: tuple[IntArray, Array] | None = None
    for rotation in rotations_onto_itself([f.segment for f in faces]):
        image = np.zeros(int(numbers.max()) + 1, np.int64)
        image[numbers] = numbers[rotation.image]
        key, pose = keys_and_pose(named, rotation.angle, image, x1 - x0 + y1 - y0)
        if best is not None:
            better = precedes(key, pose, *best)
            key, pose = np.where(better[:, None], key, best[0]), np.where(better, pose, best[1])
        best = key, pose
    assert best is not None
    key, pose = best
    order = np.lexsort([pose, *(key[:, k] for k in range(key.shape[1] - 1, -1, -1))])
    key, pose = key[order], pose[order]
    fresh = np.ones(len(key), np.bool_)
    fresh[1:] = (key[1:] != key[:-1]).any(axis=1) | (np.diff(pose) > 2 * SAME_POSE)
    return {name: int((fresh & (key[:, 0] == k + 1)).sum()) for k, name in enumerate(("I", "II"))}
