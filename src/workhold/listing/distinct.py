"""Counting fixtures that a rotation of the part onto itself carries into each other as one.

Each fixture is told by its smallest image: whole numbers for its holes, and the pose, which says what is touched. Faces are
left out, since a contact at a tangent joint is on two of them and only one is named.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import SAME_IMAGE, SAME_POSE
from workhold.geometry.rotation import rotated
from workhold.geometry.symmetry import Rotation, centroid_of_joints, rotations_onto_itself
from workhold.kernels.contact.canonical_form import to_canonical_form
from workhold.listing.canonical_form import (
    MOST_PEGS,
    Candidates,
    changes,
    clusters,
    most_holes,
    packed,
    place_number,
)
from workhold.model.workpiece import Workpiece

__all__ = ["Turns", "kept_point", "one_of_each_set", "precedes", "rotations_of"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def rotations_of(part: Workpiece) -> tuple[Rotation, ...]:
    """The rotations of a part onto itself, the identity first."""
    return tuple(rotations_onto_itself([face.segment for face in part.faces]))


def kept_point(part: Workpiece) -> Array:
    """The point (2,) that all rotations of a part onto itself keep, in mm in its frame."""
    return np.array(centroid_of_joints([face.segment for face in part.faces]))


def precedes(
    words: Sequence[IntArray], pose: Array, others: Sequence[IntArray], other_pose: Array
) -> NDArray[np.bool_]:
    """Which (N,) of some whole numbers (N,) each and poses (N, P) come before others in lexicographic order."""
    before = np.zeros(len(pose), np.bool_)
    for one, other in zip(pose.T[::-1], other_pose.T[::-1], strict=True):
        before = (one < other - SAME_IMAGE) | ((one <= other + SAME_IMAGE) & before)
    for word, other_word in zip(reversed(words), reversed(others), strict=True):
        before = (word < other_word) | ((word == other_word) & before)
    return before


def one_of_each_set(words: Sequence[IntArray], pose: Array) -> IntArray:
    """Which (S,) fixtures stand for the sets of those that have whole numbers (N,) and, to a hair, the pose (N, P) in
    common."""
    order = np.lexsort(words[::-1])
    order, fresh = clusters(
        order, changes([word[order] for word in words]), *((numbers, SAME_IMAGE) for numbers in pose.T)
    )
    return order[fresh]


def orientation_after(theta: Array, rotation: Rotation, period: Array) -> Array:
    """Orientations (N,) in the listed form, up to a hair, after the part is turned onto itself."""
    return np.asarray((theta - rotation.angle + SAME_POSE) % period - SAME_POSE)


@define(frozen=True, eq=False)
class Turns:
    """The rotations of a part onto itself, and what they make of fixtures.

    Parameters
    ----------
    problem : what was searched.
    rotations : the identity first.
    kept : (2,) the point that they keep, in mm in the frame of contacts.
    """

    problem: Problem
    rotations: tuple[Rotation, ...]
    kept: Array

    @classmethod
    def of(cls, problem: Problem) -> Turns:
        """The rotations of a problem's part."""
        part = problem.workpiece
        return cls(problem, rotations_of(part), kept_point(part) - part.center)

    @property
    def is_symmetric(self) -> bool:
        """Whether there is more than the part as it lies, so that a fixture need not be a set of its own."""
        return len(self.rotations) > 1

    def smallest(self, c: Candidates) -> tuple[list[IntArray], Array, IntArray]:
        """The smallest form of fixtures among those they are carried into: (N,) packed arrangements and holes, (N, 2)
        orientations and numbers for the place; and (N,) the numbers of the arrangements."""
        # Of a part of many rotations only those are tried that make the orientation the least.
        period = np.where(c.standing == self.problem.frame.swapped, np.pi, 2 * np.pi)
        least = np.min([orientation_after(c.theta, rotation, period) for rotation in self.rotations], axis=0)
        words, pose = list[IntArray](), np.full((len(least), 2), np.inf)
        for rotation in self.rotations:
            chosen = np.flatnonzero(orientation_after(c.theta, rotation, period) <= least + SAME_POSE)
            turned, turned_pose = self.carried(c.take(chosen), rotation.angle)
            words = words or [np.full(len(least), np.iinfo(np.int64).max) for _ in turned]
            better = precedes(turned, turned_pose, [word[chosen] for word in words], pose[chosen])
            pose[chosen[better]] = turned_pose[better]
            for word, new in zip(words, turned, strict=True):
                word[chosen[better]] = new[better]
        return words, pose, self.problem.query.toolkit.arrangement_numbers(c.standing)

    def carried(self, c: Candidates, angle: float) -> tuple[list[IntArray], Array]:
        """What :meth:`smallest` chooses from: fixtures after the part is turned onto itself by an angle in radians."""
        theta, column, row = c.theta - angle, c.column.copy(), c.row.copy()
        order = np.empty((len(theta), 4), np.int64)
        to_canonical_form(c.standing, theta, column, row, order, self.problem.frame.swapped, SAME_POSE)
        first = c.point[np.arange(len(theta)), order[:, 0]] - self.kept
        place = place_number(np.stack(rotated(first[:, 0], first[:, 1], angle), axis=1), c.gap)
        holes = zip((column, row), most_holes(self.problem), strict=True)
        return packed((c.standing[:, None], MOST_PEGS), *holes), np.stack([theta, place], axis=1)

    def count(self, columns: Sequence[NDArray[Any]]) -> IntArray:
        """How many sets of each arrangement there are among all fixtures of some packed numbers: (N,) columns as
        :meth:`smallest` gives them, the pose in two."""
        *words, theta, place, kind = columns
        chosen = one_of_each_set(words, np.stack([theta, place], axis=1))
        return np.bincount(kind[chosen], minlength=len(self.problem.query.toolkit.arrangements))
