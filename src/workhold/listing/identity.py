"""Identity of fixtures: when two are the same or near duplicates, and the number of sets that they form under
rotations of a part.

A fixture is identified by integers for its holes and lines, and by the pose, which determines the contacts.
Faces are not part of the identity, since a contact at a tangent joint is on two faces and only one is listed.
Fixtures that a rotation of the part, or half a turn of the toolkit, carries into each other have the same
smallest image, which identifies the set.

Glossary
--------
near duplicates : fixtures that a machinist would regard as one way to hold the part. They have the same
    arrangement, are all square or all tilted, and the pegs of each carrier touch the same faces. Rotations
    and mirror images of the part onto itself, and the half turn that swaps the carriers, are ignored. Such
    fixtures differ by a row or a column more or less, or by the part's symmetry.
entry : the first of some near duplicates, with the number of the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.conventions import SAME_IMAGE, SAME_POSE
from workhold.fixels.contacts import WALL_END
from workhold.fixels.toolkit import Arrangement, Toolkit
from workhold.geometry.symmetry import (
    Rotation,
    compute_centroid_of_segments,
    find_rotations_onto_itself,
    find_symmetries,
    rotate_vectors,
)
from workhold.listing.canonical_form import mark_changes, pack_integers, split_into_clusters
from workhold.listing.clamp_placement import find_axis
from workhold.model.fixture_table import FixtureTable
from workhold.model.quality import TILT
from workhold.model.result import Result
from workhold.model.workpiece import Workpiece
from workhold.statics.judging import are_unfit

__all__ = [
    "ShownEntries",
    "FixtureIdentity",
    "SetCounter",
    "make_entries",
    "find_first_of_each",
    "allows_half_turns",
    "order_by_identity",
    "number_near_duplicates",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Upper bound of columns and rows counted from the lowest of a fixture, and of lines to either side.
MOST_HOLES = (1 << 20) - 1


@frozen(eq=False)
class FixtureIdentity:
    """The identities of a toolkit's fixtures of a part.

    Parameters
    ----------
    toolkit, part : the toolkit, and the part that it holds.
    every : whether each choice of clamps is a separate fixture; if False, one fixture represents all clamps
        with its directions.
    rotations : rotations of the part onto itself, the identity first.
    """

    toolkit: Toolkit
    part: Workpiece
    every: bool = True
    rotations: tuple[Rotation, ...] = field(init=False)

    @rotations.default
    def find_own_rotations(self) -> tuple[Rotation, ...]:
        """Return the rotations that carry the part onto itself, the identity first."""
        every = self.part.numbered
        return tuple(find_rotations_onto_itself([face.segment for face in every.faces], every.marks))

    @property
    def is_symmetric(self) -> bool:
        """Whether some rotation, apart from the identity, carries the part onto itself."""
        return len(self.rotations) > 1

    def find_smallest_images(self, table: FixtureTable) -> tuple[list[IntArray], Array]:
        """Return the smallest image of each of N fixtures under the
        part's rotations and the toolkit's half turns.

        It is given as packed integers, each (N,), and poses (N, P): orientation in radians and places in mm.
        Fixtures with the same image are the same up to symmetry.
        """
        x, y = self.toolkit.compute_hole_places(
            table.arrangement, table.column, table.row, table.jaw_separation
        )
        forms = [self.make_form(table, x, y, sign) for sign in (1, -1)]
        halves = np.array([turns_into_itself(one, self.toolkit) for one in self.toolkit.arrangements])[
            table.arrangement
        ]
        period = np.where(halves, np.pi, 2.0 * np.pi)
        kept = np.array(compute_centroid_of_segments([face.segment for face in self.part.numbered.faces]))
        after = [table.theta - rotation.angle + SAME_POSE for rotation in self.rotations]
        least = np.min([theta % period for theta in after], axis=0)
        words, pose = list[IntArray](), np.zeros((0, 0))
        for rotation, theta in zip(self.rotations, after, strict=True):
            # Only the images of the least orientation can be the smallest.
            chosen = np.flatnonzero(theta % period <= least + SAME_POSE)
            turned = halves & (theta % (2.0 * np.pi) >= np.pi)
            numbers = [
                np.where(turned, two, one)[chosen] for one, two in zip(forms[0][0], forms[1][0], strict=True)
            ]
            anchor, ahead = (
                np.where(turned[:, None], two, one)[chosen]
                for one, two in zip(forms[0][1:], forms[1][1:], strict=True)
            )
            away = anchor - table.position[chosen]
            seen = rotate_vectors(away[:, 0], away[:, 1], -table.theta[chosen])
            place = rotate_vectors(seen[0] - kept[0], seen[1] - kept[1], rotation.angle)
            image = np.column_stack([(theta % period)[chosen] - SAME_POSE, *place, ahead])
            if not words:
                words = [np.full(len(table), np.iinfo(np.int64).max) for _ in numbers]
                pose = np.full((len(table), image.shape[1]), np.inf)
            better = precedes(numbers, image, [word[chosen] for word in words], pose[chosen])
            pose[chosen[better]] = image[better]
            for word, number in zip(words, numbers, strict=True):
                word[chosen[better]] = number[better]
        return words, pose

    def make_form(
        self, table: FixtureTable, x: Array, y: Array, sign: int
    ) -> tuple[list[IntArray], Array, Array]:
        """Return the identity of N fixtures without their pose: (integers, places, offsets).

        They are packed integers, each (N,), for holes and lines; the place of the first peg in mm, (N, 2);
        and how far in mm moving pegs or clamps are from the first peg along their direction, (N, M).

        Parameters
        ----------
        x, y : (N, K) places of pegs in mm.
        sign : 1, or -1 for the fixtures after half a turn of everything, which reverses the order of pegs.
        """
        carriers, on = self.toolkit.carriers, self.toolkit.find_peg_carriers(table.arrangement)
        pegs = [carriers[number] for number in self.toolkit.arrangements[0].carriers][::sign]
        # Indices of contacts: in holes of their own, of clamps, and of what moves.
        places = np.arange(len(pegs))[::sign]
        clamps = places[[peg.on is not None for peg in pegs]]
        own = places[[peg.has_lattice for peg in pegs]]
        movers = clamps if len(clamps) else own[-1:]
        column, row = sign * table.column.astype(np.int64), sign * table.row.astype(np.int64)
        each = [
            np.where(on[:, own] == k, column[:, own], MOST_HOLES).min(axis=1) for k in range(len(carriers))
        ]
        first, lowest = np.stack(each, axis=1), row[:, own].min(axis=1, keepdims=True)
        numbers = [
            (table.arrangement[:, None], len(self.toolkit.arrangements)),
            (column[:, own] - np.take_along_axis(first, on[:, own], axis=1), MOST_HOLES),
            (row[:, own] - lowest, MOST_HOLES),
        ]
        upright = np.array([find_axis(carrier) == 1 for carrier in carriers])[on[:, movers]]
        if self.every:
            # A clamp is named by its line; jaws have holes of their own.
            line = np.where(upright, column[:, movers] - first[:, :1], row[:, movers] - lowest)
            numbers.append((line[:, : len(clamps)] + MOST_HOLES, 2 * MOST_HOLES + 1))
        away = np.where(upright, y[:, movers] - y[:, own[:1]], x[:, movers] - x[:, own[:1]])
        anchor = np.stack([x[:, own[0]], y[:, own[0]]], axis=1)
        return pack_integers(*numbers), anchor, sign * away[:, : None if self.every else 0]

    def count_sets(self, words: Sequence[IntArray], pose: Array, arrangement: IntArray) -> IntArray:
        """Return the number of distinct fixtures of each arrangement, (A,). Fixtures with the same image
        count once.

        ``words`` and ``pose`` are the two results of :meth:`find_smallest_face_images`; ``arrangement`` (N,) is
        that of each fixture.
        """
        order = np.lexsort(words[::-1])
        fresh = mark_changes([word[order] for word in words])
        order, fresh = split_into_clusters(order, fresh, *((numbers, SAME_IMAGE) for numbers in pose.T))
        return np.bincount(arrangement[order[fresh]], minlength=len(self.toolkit.arrangements))


def allows_half_turns(toolkit: Toolkit) -> bool:
    """Return whether half a turn of pegs and part together gives a set-up of the same toolkit.

    It does unless the toolkit has a wall.
    """
    return WALL_END not in toolkit.contacts


def turns_into_itself(arrangement: Arrangement, toolkit: Toolkit) -> bool:
    """Return whether half a turn of pegs and part together maps an arrangement to itself.

    It does for two jaws with equally many pegs that a half turn may exchange, and for two clamps in opposite
    directions on a plate without a wall.
    """
    ways = [
        toolkit.carriers[number].travel
        for number in arrangement.carriers
        if toolkit.carriers[number].on is not None
    ]
    if not ways:
        swaps = any(one.half_turns % 2 and one.carriers == (1, 0) for one in toolkit.symmetries)
        return swaps and arrangement.pegs == arrangement.pegs[::-1]
    units = np.array([way.unit for way in ways if way is not None])
    return allows_half_turns(toolkit) and len(units) == 2 and not units.sum(axis=0).any()


def precedes(
    words: Sequence[IntArray], pose: Array, others: Sequence[IntArray], other_pose: Array
) -> BoolArray:
    """Return a mask (N,): True for rows of ``words`` and ``pose`` that
    come lexicographically before the others' row.

    Row k is compared with row k of ``others`` and ``other_pose``. Poses that differ by at most ``SAME_IMAGE``
    count as equal.
    """
    before = np.zeros(len(pose), np.bool_)
    for one, other in zip(pose.T[::-1], other_pose.T[::-1], strict=True):
        before = (one < other - SAME_IMAGE) | ((one <= other + SAME_IMAGE) & before)
    for word, other_word in zip(reversed(words), reversed(others), strict=True):
        before = (word < other_word) | ((word == other_word) & before)
    return before


@define(eq=False)
class SetCounter:
    """A running count of fixtures, and of fixtures that are distinct under the part's symmetry.

    Parameters
    ----------
    identity : decides which fixtures are the same up to symmetry.
    found : (A,) number of fixtures of each arrangement so far.
    """

    identity: FixtureIdentity
    found: IntArray = field(init=False)
    images: list[tuple[NDArray[np.generic], ...]] = field(factory=list, init=False)

    def __attrs_post_init__(self) -> None:
        self.found = np.zeros(len(self.identity.toolkit.arrangements), np.int64)

    def add(self, table: FixtureTable) -> None:
        """Count the fixtures of a table."""
        self.found += np.bincount(table.arrangement, minlength=len(self.found))
        if self.identity.is_symmetric and len(table):
            words, pose = self.identity.find_smallest_images(table)
            self.images.append((table.arrangement, pose, *words))

    @property
    def distinct(self) -> IntArray:
        """Number of distinct fixtures of each arrangement so far, (A,). Fixtures that symmetry makes equal
        count once.
        """
        if not self.images:
            return self.found
        arrangement, pose, *words = (np.concatenate(values) for values in zip(*self.images, strict=True))
        return self.identity.count_sets(words, pose, arrangement)

    def count_by_type(self, counts: IntArray) -> dict[str, int]:
        """Return counts (A,) of arrangements as a dict by name of the
        type, summed over the type's arrangements.
        """
        toolkit = self.identity.toolkit
        each = list(zip(toolkit.arrangements, counts.tolist(), strict=True))
        return {name: sum(count for one, count in each if one.name == name) for name in toolkit.types}


def order_by_identity(table: FixtureTable, toolkit: Toolkit | None = None) -> NDArray[np.intp]:
    """Return the indices (N,) that sort fixtures by type, holes, orientation, faces and place.

    Give the toolkit if it may have a wall with ends; columns are then counted from the first peg's.
    """
    position, column = table.position, table.column
    if toolkit is not None and toolkit.wall_with_ends is not None:
        (ends,) = toolkit.ends_on_walls
        pegs = np.delete(np.arange(column.shape[1]), ends)
        first = column[:, pegs].min(axis=1, keepdims=True, initial=1 << 30)
        column = np.where(np.isin(np.arange(column.shape[1]), pegs), column - first, column)
        position = position - np.hstack([first * toolkit.wall_with_ends.pitch[0], 0 * first])
    place = position @ np.array([1.0, 0.7548776662])
    columns = [*column.T, *table.row.T, np.round(table.theta / SAME_POSE), *table.face.T, place]
    return np.lexsort([*reversed(columns), table.arrangement])


# Number of fixtures judged together, and of the best fixtures among which near duplicates are sought.
BLOCK, MOST_LOOKED_AT = 1 << 14, 200_000


@frozen(eq=False)
class ShownEntries:
    """The entries to show of a list of fixtures, without near duplicates.

    Parameters
    ----------
    index : (E,) index of the fixture that represents each entry, ascending.
    like : (E,) number of near duplicates of each entry that are left out.
    unfit : number of fixtures left out as unfit for a workshop.
    """

    index: IntArray
    like: IntArray
    unfit: int


def make_entries(result: Result, with_unfit: bool = False) -> ShownEntries:
    """Return the entries of a result: the first of each group of near duplicates among its best fixtures.

    Fixtures unfit for a workshop are left out, unless ``with_unfit`` or all are unfit. Only the first
    :data:`MOST_LOOKED_AT` fixtures are compared.
    """
    table = result.table
    if result.toolkit.holds_by_friction:
        return make_entries_of_holds(result, with_unfit)
    blocks = (table.take(slice(start, start + BLOCK)) for start in range(0, len(table), BLOCK))
    bad = np.concatenate(
        [np.zeros(0, np.bool_), *(are_unfit(block.quality, result.query.tolerance) for block in blocks)]
    )
    shown = np.arange(len(bad)) if with_unfit or bad.all() else np.flatnonzero(~bad)
    looked_at = shown[:MOST_LOOKED_AT]
    index, like = find_first_of_each(
        number_near_duplicates(table.take(looked_at), result.workpiece, result.toolkit)
    )
    return ShownEntries(shown[index], like, len(bad) - len(shown))


def make_entries_of_holds(result: Result, with_unfit: bool) -> ShownEntries:
    """Return the entries of a result that holds by friction, where no two fixtures are near duplicates.

    See :func:`make_entries`.
    """
    bad = np.array([hold.is_unfit for hold in result.holds], np.bool_)
    shown = np.arange(len(bad)) if with_unfit or bad.all() else np.flatnonzero(~bad)
    return ShownEntries(shown, np.zeros(len(shown), np.int64), len(bad) - len(shown))


def find_first_of_each(groups: IntArray) -> tuple[IntArray, IntArray]:
    """Return (1) the indices of the first member of each group,
    ascending, and (2) how many more members it has.

    Both are (E,) for E groups. ``groups`` (N,) has the group number of each item.
    """
    _, first, count = np.unique(groups, return_index=True, return_counts=True)
    order = np.argsort(first)
    return first[order], count[order] - 1


def number_near_duplicates(table: FixtureTable, workpiece: Workpiece, toolkit: Toolkit) -> IntArray:
    """Return a group number for each fixture, (N,), equal for near duplicates.

    Fixtures without pegs (flat jaws) are a group each.
    """
    if len(table) == 0 or table.column.shape[1] == 0:
        # Fixtures of flat jaws differ in side, parallels or stop.
        return np.arange(len(table), dtype=np.int64)
    carriers = toolkit.find_peg_carriers(table.arrangement)
    # The faces of each carrier's pegs, sorted, the first carrier's in front; so pegs of each carrier keep
    # their columns.
    order = np.lexsort((table.face, carriers), axis=-1)
    faces = np.take_along_axis(table.face.astype(np.int64), order, axis=1)
    tilted = (table.quality[:, TILT] > 0.0).astype(np.int64)
    keys = np.column_stack([table.arrangement, tilted, faces])
    first, member = find_distinct_rows(keys)
    _, group = find_distinct_rows(find_smallest_face_images(keys[first], workpiece, toolkit))
    return np.asarray(group[member])


def find_distinct_rows(keys: IntArray) -> tuple[IntArray, IntArray]:
    """Return (1) the index of the first occurrence of each distinct
    row, and (2) the number of each row, (N,).

    Distinct rows are numbered in lexicographic order. ``keys`` (N, K) are integers from 0 up.
    """
    words = np.column_stack(pack_integers((keys, int(keys.max()))))
    # One word, which is enough for most parts, is sorted far sooner than rows.
    _, first, member = np.unique(
        words.ravel() if words.shape[1] == 1 else words, axis=0, return_index=True, return_inverse=True
    )
    return first, member.ravel()


def find_smallest_face_images(keys: IntArray, workpiece: Workpiece, toolkit: Toolkit) -> IntArray:
    """Return the lexicographically smallest image of each row of ``keys``, (K, 2 + P).

    The columns of a row are arrangement, tilt (0 or 1), and the faces that its P pegs touch. The images are
    those under the part's rotations and mirror images, and under a half turn that swaps the carriers, where
    it is a symmetry of the toolkit.
    """
    every = workpiece.numbered
    numbers = np.array([face.number for face in every.faces])
    carriers = toolkit.find_peg_carriers(keys[:, 0].astype(np.int8))
    # Type I of a vise: as many pegs on either carrier, which a half turn swaps.
    swaps = ((carriers.max(axis=1) == 1) & ((carriers == 1).sum(axis=1) * 2 == carriers.shape[1]))[:, None]
    # Jaws whose pegs have different heights are not images of each other.
    swaps &= len({carrier.heights for carrier in toolkit.carriers}) == 1
    images = np.array(find_symmetries([face.segment for face in every.faces], every.marks))
    to = np.zeros((len(images), int(numbers.max()) + 1), np.int64)
    to[:, numbers] = numbers[images]
    # The smallest image begins with the lowest number that a face can get, so only symmetries are tried that
    # give one of the faces its lowest.
    lowest = to == to.min(axis=0)
    few = np.argsort(~lowest, axis=0, kind="stable")[: lowest[:, numbers].sum(axis=0).max()]
    tried = few[:, keys[:, 2:]].transpose(0, 2, 1).reshape(-1, len(keys))
    if len(tried) >= len(images):
        tried = np.repeat(np.arange(len(images))[:, None], len(keys), axis=1)
    best = keys
    for symmetry, turned in product(tried, (False, True) if swaps.any() else (False,)):
        there = to[symmetry[:, None], keys[:, 2:]]
        if turned:
            there = np.where(swaps, there[:, [2, 3, 0, 1]], there)
        there = np.take_along_axis(there, np.lexsort((there, carriers), axis=-1), axis=1)
        candidate = np.column_stack([keys[:, :2], there])
        differs = candidate != best
        place = differs.argmax(axis=1)
        rows = np.arange(len(keys))
        better = differs.any(axis=1) & (candidate[rows, place] < best[rows, place])
        best = np.where(better[:, None], candidate, best)
    return best
