"""Near duplicates among fixtures: what a machinist would call one way to hold the part.

Glossary
--------
near duplicates : fixtures of one arrangement, all square or all tilted, whose pegs touch the same faces for
    each carrier. Rotations and mirror images of the part onto itself and the half turn that swaps the
    carriers make no difference. Such fixtures differ by a row or a column more or less, or by the part's
    symmetry.
entry : the first of some near duplicates, and how many come after it.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.fixels.toolkit import Toolkit
from workhold.geometry.symmetry import symmetries
from workhold.listing.canonical_form import packed
from workhold.model.quality import TILT
from workhold.model.result import FixtureTable, Result
from workhold.model.workpiece import Workpiece
from workhold.statics.judging import unfit

__all__ = ["Entries", "entries", "first_of_each", "near_duplicates"]

IntArray = NDArray[np.int64]

# Fixtures judged together, and those, from the best on, among which near duplicates are sought.
BLOCK, MOST_LOOKED_AT = 1 << 14, 200_000


@frozen(eq=False)
class Entries:
    """What to show of a list of fixtures.

    Parameters
    ----------
    index : (E,) of the fixture that stands for each entry, in the order of the list.
    like : (E,) how many near duplicates come after it.
    unfit : how many fixtures are left out because they are none for a workshop.
    """

    index: IntArray
    like: IntArray
    unfit: int


def entries(result: Result, with_unfit: bool = False) -> Entries:
    """The entries of the best of a result; fixtures that are none for a workshop make entries only if asked
    for, or if there are no others."""
    table = result.table
    blocks = (table.take(slice(start, start + BLOCK)) for start in range(0, len(table), BLOCK))
    bad = np.concatenate([np.zeros(0, np.bool_), *(unfit(block.quality, result.query.tolerance) for block in blocks)])
    shown = np.arange(len(bad)) if with_unfit or bad.all() else np.flatnonzero(~bad)
    looked_at = shown[:MOST_LOOKED_AT]
    index, like = first_of_each(near_duplicates(table.take(looked_at), result.workpiece, result.toolkit))
    return Entries(shown[index], like, len(bad) - len(shown))


def first_of_each(groups: IntArray) -> tuple[IntArray, IntArray]:
    """Places (E,) of the first member of each group, in order, and how many more members (E,) it has."""
    _, first, count = np.unique(groups, return_index=True, return_counts=True)
    order = np.argsort(first)
    return first[order], count[order] - 1


def near_duplicates(table: FixtureTable, workpiece: Workpiece, toolkit: Toolkit) -> IntArray:
    """A number (N,) for each fixture, the same for near duplicates."""
    if len(table) == 0:
        return np.zeros(0, np.int64)
    carriers = toolkit.peg_carriers(table.arrangement)
    # Faces of each carrier's pegs in order, the first carrier's in front; with the pegs of each type where
    # they belong.
    order = np.lexsort((table.face, carriers), axis=-1)
    faces = np.take_along_axis(table.face.astype(np.int64), order, axis=1)
    tilted = (table.quality[:, TILT] > 0.0).astype(np.int64)
    keys = np.column_stack([table.arrangement, tilted, faces])
    first, member = distinct_rows(keys)
    _, group = distinct_rows(smallest_images(keys[first], workpiece, toolkit))
    return np.asarray(group[member])


def distinct_rows(keys: IntArray) -> tuple[IntArray, IntArray]:
    """Where each distinct row of whole numbers (N, 6) from 0 upward comes first, in their order, and which
    (N,) each is."""
    words = np.column_stack(packed((keys, int(keys.max()))))
    # One word, which is enough for most parts, is sorted far sooner than rows.
    _, first, member = np.unique(
        words.ravel() if words.shape[1] == 1 else words, axis=0, return_index=True, return_inverse=True
    )
    return first, member.ravel()


def smallest_images(keys: IntArray, workpiece: Workpiece, toolkit: Toolkit) -> IntArray:
    """The first image of each row (K, 6) of arrangement, tilt and faces under the symmetries of the part."""
    numbers = np.array([face.number for face in workpiece.faces])
    carriers = toolkit.peg_carriers(keys[:, 0].astype(np.int8))
    # Type I of a vise: as many pegs on either carrier, which a half turn swaps.
    swaps = ((carriers.max(axis=1) == 1) & ((carriers == 1).sum(axis=1) * 2 == carriers.shape[1]))[:, None]
    images = np.array(symmetries([face.segment for face in workpiece.faces]))
    to = np.zeros((len(images), int(numbers.max()) + 1), np.int64)
    to[:, numbers] = numbers[images]
    # The first image begins with the lowest number that one of the faces can have, so of many symmetries only
    # those are tried that give one of them its lowest.
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
