"""Counting fixtures that a rotation of the part onto itself carries into each other as one."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import SAME_POSE
from workhold.geometry.symmetry import Rotation, rotations_onto_itself
from workhold.kernels.contact.canonical_form import to_canonical_form
from workhold.listing.canonical_form import MOST_PEGS, Candidates, changes, packed

__all__ = ["count_distinct"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def keys_and_pose(
    c: Candidates, face: IntArray, largest: int, swapped: int, angle: float, size: float
) -> tuple[list[IntArray], Array]:
    """Fixtures after the part is turned onto itself by an angle in radians: (N,) packed arrangements, faces and holes, and
    (N,) a number for the pose.

    ``face`` (N, 4) are the faces that they then touch, none of a number above ``largest``; ``size`` in mm brings lengths to
    the scale of angles.
    """
    theta, column, row = c.theta - angle, c.column.copy(), c.row.copy()
    order = np.empty((len(face), 4), np.int64)
    to_canonical_form(c.standing, theta, column, row, order, swapped, SAME_POSE)
    face = np.ravel(face)[4 * np.arange(len(face))[:, None] + order]
    # Same faces, holes and orientation still leave a choice of places; the gap tells those apart.
    holes = ((column, column.max()), (row, row.max()))
    return packed((c.standing[:, None], MOST_PEGS), (face, largest), *holes), theta + c.gap / size


def precedes(a: list[IntArray], a_pose: Array, b: list[IntArray], b_pose: Array) -> NDArray[np.bool_]:
    """Which of some packed keys and poses come before others in lexicographic order."""
    before = a_pose < b_pose - SAME_POSE
    for one, other in zip(reversed(a), reversed(b), strict=True):
        before = (one < other) | ((one == other) & before)
    return before


def count_distinct(c: Candidates, problem: Problem, threads: int = 1) -> dict[str, int]:
    """How many sets of each arrangement the fixtures form when those equivalent under the part's rotations count once.

    Parameters
    ----------
    c : the fixtures, each listed once.
    problem : what was searched.
    threads : how many threads share the work.
    """
    workpiece, face = problem.workpiece, problem.faces[c.feature]
    toolkit, swapped = problem.vise, problem.frame.swapped
    faces = workpiece.faces
    rotations = rotations_onto_itself([f.segment for f in faces])
    if len(face) == 0 or len(rotations) == 1:
        # Only the part as it lies; every fixture is a set of its own.
        return toolkit.arrangements_counted(toolkit.arrangement_numbers(c.standing))
    numbers = np.array([f.number for f in faces])
    x0, y0, x1, y1 = workpiece.bounds

    def turned(rotation: Rotation) -> tuple[list[IntArray], Array]:
        image = np.zeros(int(numbers.max()) + 1, np.int64)
        image[numbers] = numbers[rotation.image]
        return keys_and_pose(c, image[face], len(image), swapped, rotation.angle, x1 - x0 + y1 - y0)

    best = turned(rotations[0])
    with ThreadPoolExecutor(max_workers=threads) as pool:
        # A few at a time: each is as large as all the fixtures' holes.
        for first in range(1, len(rotations), threads):
            for key, pose in pool.map(turned, rotations[first : first + threads]):
                better = precedes(key, pose, *best)
                smallest = [np.where(better, new, old) for new, old in zip(key, best[0], strict=True)]
                best = smallest, np.where(better, pose, best[1])
    key, pose = best
    order = np.lexsort([pose, *reversed(key)])
    fresh = changes([word[order] for word in key])
    fresh[1:] |= np.diff(pose[order]) > 2 * SAME_POSE
    return toolkit.arrangements_counted(toolkit.arrangement_numbers(c.standing[order[fresh]]))
