"""When two fixtures are the same, and how many sets fixtures form under the rotations of a part onto itself.

A fixture is named by whole numbers for its holes and lines, and by the pose, which says what is touched. Faces are left out,
since a contact at a tangent joint is on two of them and only one is listed. Fixtures that a rotation of the part, or half a
turn of the toolkit, carries into each other share the smallest of their images, which stands for the set.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, tau
from typing import Any

import numpy as np
from attrs import define, field
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
from workhold.listing.clamp_placement import DIRECTION_NAMES, FAR, OPENING, is_upright
from workhold.model.result import FixtureTable
from workhold.model.toolkit import Toolkit
from workhold.model.workpiece import Workpiece

__all__ = ["PartRotations", "SetCount", "identity_order", "smallest_images"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


def rotations_of(part: Workpiece) -> tuple[Rotation, ...]:
    """The rotations of a part onto itself, the identity first."""
    return tuple(rotations_onto_itself([face.segment for face in part.faces]))


def kept_point(part: Workpiece) -> Array:
    """The point (2,) that all rotations of a part onto itself keep, in mm in its frame."""
    return np.array(centroid_of_joints([face.segment for face in part.faces]))


def precedes(words: Sequence[IntArray], pose: Array, others: Sequence[IntArray], other_pose: Array) -> BoolArray:
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
class PartRotations:
    """The rotations of a part onto itself, and what they make of candidates.

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
    def of(cls, problem: Problem) -> PartRotations:
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


@define(eq=False)
class SetCount:
    """How many fixtures of plates and walls there are, and how many sets they form under the rotations of the part.

    Parameters
    ----------
    toolkit, part : what holds, and what is held.
    every : whether each choice of clamps is a fixture; else one stands for all choices of one pair of directions.
    found : (A,) fixtures of each arrangement so far.
    """

    toolkit: Toolkit
    part: Workpiece
    every: bool
    found: IntArray = field(init=False)
    rotations: tuple[Rotation, ...] = field(init=False)
    images: list[tuple[IntArray, Array]] = field(factory=list, init=False)

    def __attrs_post_init__(self) -> None:
        self.found = np.zeros(len(self.toolkit.arrangements), np.int64)
        self.rotations = rotations_of(self.part)

    def add(self, table: FixtureTable) -> None:
        """Count further fixtures."""
        self.found += np.bincount(table.arrangement, minlength=len(self.found))
        if len(self.rotations) > 1:
            self.images.append(smallest_images(table, self.toolkit, self.part, self.rotations, self.every))

    @property
    def distinct(self) -> IntArray:
        """Sets (A,) of each arrangement so far."""
        if not self.images:
            return self.found
        key, pose = (np.concatenate(values) for values in zip(*self.images, strict=True))
        chosen = one_of_each_set(packed((key, int(key.max(initial=0)))), pose)
        return np.bincount(key[chosen, 0], minlength=len(self.found))

    def by_type(self, counts: IntArray) -> dict[str, int]:
        """Counts (A,) of arrangements, summed by their names."""
        each = list(zip(self.toolkit.arrangements, counts.tolist(), strict=True))
        return {name: sum(count for one, count in each if one.name == name) for name in self.toolkit.types}


def opposed_arrangements(toolkit: Toolkit) -> BoolArray:
    """Which arrangements (A,) half a turn of everything makes the same again, with the clamps swapped: those of two clamps
    in opposite directions, unless a wall stays where it is."""
    pairs = [(one.direction or "").split() for one in toolkit.arrangements]
    swaps = [len(set(pair)) == 2 and pair[0][1] == pair[1][1] for pair in pairs]
    return np.array(swaps) & (toolkit.wall is None)


def smallest_images(
    table: FixtureTable, toolkit: Toolkit, part: Workpiece, rotations: Sequence[Rotation], every: bool
) -> tuple[IntArray, Array]:
    """The first of the forms that a part's rotations give each fixture: whole numbers (N, K), and orientations and places
    (N, P); of its clamps their directions alone, unless ``every`` choice of them is a fixture."""
    upright, tips = clamps_of(table, toolkit)
    plate, locators = toolkit.carriers[0], toolkit.arrangements[0].pegs[0]
    opposed, kept = opposed_arrangements(toolkit)[table.arrangement], kept_point(part)
    holes = np.stack([table.column, table.row], axis=2)[:, [0, locators - 1]]
    anchors = holes * np.array(plate.pitch) + np.array(plate.offset)
    best = np.zeros((0, 0), np.int64), np.zeros((0, 0))
    for rotation in rotations:
        theta = (table.theta - rotation.angle + SAME_POSE) % tau - SAME_POSE
        turned = opposed & (theta >= pi - SAME_POSE)
        key = identity_numbers(table, locators, upright, turned)
        anchor = np.where(turned[:, None], anchors[:, 1], anchors[:, 0])
        x, y = rotated(anchor[:, 0] - table.position[:, 0], anchor[:, 1] - table.position[:, 1], -table.theta)
        places = [np.where(turned, theta - pi, theta), *rotated(x - kept[0], y - kept[1], rotation.angle)]
        if every:
            ahead = tips - np.where(upright, anchor[:, [1]], anchor[:, [0]])
            places += [*np.where(turned[:, None], -ahead[:, ::-1], ahead).T]
        key, pose = key if every else key[:, : 1 + 2 * locators], np.stack(places, axis=1)
        best = best if len(best[0]) else (key, pose)
        before = precedes([*key.T], pose, [*best[0].T], best[1])[:, None]
        best = np.where(before, key, best[0]), np.where(before, pose, best[1])
    return best


def clamps_of(table: FixtureTable, toolkit: Toolkit) -> tuple[BoolArray, Array]:
    """Which clamps (N, C) of fixtures push along columns, and where (N, C) on their lines their tips are, in mm."""
    directions = [
        [DIRECTION_NAMES.index(name) for name in (one.direction or "").split()] for one in toolkit.arrangements
    ]
    direction, plate = np.array(directions, np.int64)[table.arrangement], toolkit.carriers[0]
    upright = is_upright(direction)
    if upright.shape[1] == 0:
        return upright, np.zeros(upright.shape)
    columns, rows = (
        values[:, 3:] * pitch + first
        for values, pitch, first in zip((table.column, table.row), plate.pitch, plate.offset, strict=True)
    )
    travelled = OPENING[direction].sum(axis=2) * table.jaw_separation.reshape(direction.shape)
    return upright, np.where(upright, rows, columns) + travelled


def identity_numbers(table: FixtureTable, locators: int, upright: BoolArray, turned: BoolArray) -> IntArray:
    """Directions (N, 1), the columns and then the rows of so many locators, and the lines of clamps (N, C), all counted from
    the locators' lowest hole.

    Parameters
    ----------
    upright : (N, C) which clamps push along columns.
    turned : (N,) which fixtures are meant after half a turn of everything, which swaps the clamps.
    """
    standing = [values[:, :locators] for values in (table.column, table.row)]
    first = [values.min(axis=1, keepdims=True) for values in standing]
    column, row = (values - lowest for values, lowest in zip(standing, first, strict=True))
    clamped = slice(table.column.shape[1] - upright.shape[1], None)
    line = np.where(upright, table.column[:, clamped] - first[0], table.row[:, clamped] - first[1])
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
