"""Counting fixtures that a rotation of the part onto itself carries into each other as one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import SAME_POSE
from workhold.geometry.symmetry import Rotation, rotations_onto_itself
from workhold.kernels.contact.canonical_form import to_canonical_form
from workhold.listing.canonical_form import MOST_PEGS, Candidates, changes, most_holes, packed

__all__ = ["Turns"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def keys_and_pose(
    c: Candidates, face: IntArray, problem: Problem, swapped: int, angle: float, size: float
) -> tuple[list[IntArray], Array]:
    """Fixtures after the part is turned onto itself by an angle in radians: (N,) packed arrangements, faces and holes, and
    (N,) a number for the pose.

    ``face`` (N, 4) are the faces that they then touch; ``size`` in mm brings lengths to the scale of angles.
    """
    theta, column, row = c.theta - angle, c.column.copy(), c.row.copy()
    order = np.empty((len(face), 4), np.int64)
    to_canonical_form(c.standing, theta, column, row, order, swapped, SAME_POSE)
    face = face.take(4 * np.arange(len(face))[:, None] + order)
    # Same faces, holes and orientation still leave a choice of places; the gap tells those apart.
    holes = zip((column, row), most_holes(problem), strict=True)
    largest = max(f.number for f in problem.workpiece.faces)
    return packed((c.standing[:, None], MOST_PEGS), (face, largest), *holes), theta + c.gap / size


def orientation_after(theta: Array, rotation: Rotation, period: Array) -> Array:
    """Orientations (N,) in the listed form, up to a hair, after the part is turned onto itself."""
    return np.asarray((theta - rotation.angle + SAME_POSE) % period - SAME_POSE)


def precedes(a: list[IntArray], a_pose: Array, b: list[IntArray], b_pose: Array) -> NDArray[np.bool_]:
    """Which of some packed keys and poses come before others in lexicographic order."""
    before = a_pose < b_pose - SAME_POSE
    for one, other in zip(reversed(a), reversed(b), strict=True):
        before = (one < other) | ((one == other) & before)
    return before


@define(frozen=True, eq=False)
class Turns:
    """The rotations of a part onto itself, and what they make of fixtures.

    Parameters
    ----------
    problem : what was searched.
    rotations : the identity first.
    """

    problem: Problem
    rotations: tuple[Rotation, ...]

    @classmethod
    def of(cls, problem: Problem) -> Turns:
        """The rotations of a problem's part."""
        return cls(problem, tuple(rotations_onto_itself([face.segment for face in problem.workpiece.faces])))

    @property
    def is_symmetric(self) -> bool:
        """Whether there is more than the part as it lies, so that a fixture need not be a set of its own."""
        return len(self.rotations) > 1

    def smallest(self, c: Candidates) -> tuple[list[IntArray], Array, IntArray]:
        """The smallest form of fixtures among those they are carried into: (N,) packed arrangements, faces and holes, (N,) a
        number for the pose; and (N,) the numbers of the arrangements."""
        problem, swapped = self.problem, self.problem.frame.swapped
        numbers, face = np.array([f.number for f in problem.workpiece.faces]), problem.faces[c.feature]
        x0, y0, x1, y1 = problem.workpiece.bounds
        image = np.zeros(int(numbers.max()) + 1, np.int64)
        # Of a part of many rotations only those are tried that make the orientation the least.
        period = np.where(c.standing == swapped, np.pi, 2 * np.pi)
        least = np.min([orientation_after(c.theta, rotation, period) for rotation in self.rotations], axis=0)
        words, pose = list[IntArray](), np.full(len(least), np.inf)
        for rotation in self.rotations:
            image[numbers] = numbers[rotation.image]
            chosen = np.flatnonzero(orientation_after(c.theta, rotation, period) <= least + SAME_POSE)
            turned, turned_pose = keys_and_pose(
                c.take(chosen), image[face[chosen]], problem, swapped, rotation.angle, x1 - x0 + y1 - y0
            )
            words = words or [np.full(len(least), np.iinfo(np.int64).max) for _ in turned]
            better = precedes(turned, turned_pose, [word[chosen] for word in words], pose[chosen])
            pose[chosen[better]] = turned_pose[better]
            for word, new in zip(words, turned, strict=True):
                word[chosen[better]] = new[better]
        return words, pose, problem.query.toolkit.arrangement_numbers(c.standing)

    def count(self, columns: Sequence[NDArray[Any]]) -> IntArray:
        """How many sets of each arrangement there are among all fixtures of some packed numbers: (N,) columns as
        :meth:`smallest` gives them."""
        *key, pose, kind = columns
        order = np.lexsort([pose, *reversed(key)])
        fresh = changes([word[order] for word in key])
        fresh[1:] |= np.diff(pose[order]) > 2 * SAME_POSE
        return np.bincount(kind[order[fresh]], minlength=len(self.problem.query.toolkit.arrangements))
