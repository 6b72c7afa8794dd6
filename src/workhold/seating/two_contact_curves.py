"""Poses in which pegs of one jaw touch the part in two places: chord curves of pairs of pegs, and pockets.

Glossary
--------
two-contact curve : all poses, up to the shift along x, in which two contacts of one jaw touch; a row of
    ``PAIR_LENGTH`` numbers, see ``kernels.seating.columns``. The contact space of two fingers: T. F. Allen,
    J. W. Burdick and E. Rimon, "Two-finger caging of polygonal objects using contact space search", IEEE
    Transactions on Robotics 31 (2015).
slide : two contacts on parallel faces. They fix the orientation, so they are not a curve over it.
"""

from __future__ import annotations

from functools import cached_property
from itertools import combinations
from math import atan2, hypot, pi, tau
from typing import Any

import numpy as np
from attrs import define, frozen
from numpy.typing import NDArray

from workhold.kernels.base.tables import (
    CURVE_INTEGERS,
    CURVE_REALS,
    DIRECTION,
    END_STRETCH,
    FIRST_STRETCH,
    HEAD,
    SLIDE_FROM,
    SLIDE_TO,
    TAIL,
)
from workhold.kernels.chord.stretches import STRETCH_LENGTH
from workhold.kernels.seating.columns import (
    ANGLE,
    CELL_LENGTH,
    FIRST_PEG,
    HIGH,
    KIND,
    LOW,
    PAIR_LENGTH,
    PIVOT_X,
    PIVOT_Y,
    SECOND_PEG,
    SOURCE,
    HeldPart,
    JawCells,
)
from workhold.kernels.seating.slides import SLIDE_FIRST, SLIDE_LENGTH, SLIDE_SECOND
from workhold.kernels.seating.two_contact_curves import MIDDLE_LENGTH, make_cells, write_middles
from workhold.seating.closing import fill_rows
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.pattern import Pattern, PegSubset, list_jaw_subsets

__all__ = ["JawCurves", "TwoContactCurves"]

Array = NDArray[np.float64]
# Cells of the curves that are kept, of about 360 bytes with all that belongs to them; with more, all are
# forgotten.
MOST_KEPT = 250_000
NO_CURVES = np.zeros((0, PAIR_LENGTH)), np.zeros((0, CURVE_INTEGERS), np.int64), np.zeros((0, CURVE_REALS))
NO_SLIDES = np.zeros((0, SLIDE_LENGTH))


@frozen(eq=False, slots=False)
class JawCurves:
    """The two-contact curves of the pegs of one jaw: all poses in which two contacts with these pegs touch.

    Parameters
    ----------
    rows, curves, reals : ``pairs``, ``curves`` and ``reals`` of ``HeldPart``; pegs and curves are numbered
        from 0.
    cells, middles : (C, 7) and (C, 19) tables of the C cells of all curves, one curve after the other, see
        ``kernels.seating.two_contact_curves``.
    slides : (S, 7) pairs of contacts on parallel faces, which are possible at one orientation only, see
        ``kernels.seating.slides``.
    """

    rows: Array
    curves: NDArray[np.int64]
    reals: Array
    cells: Array
    middles: Array
    slides: Array

    @classmethod
    def from_boundary(cls, boundary: ObstacleBoundary, pegs: Array, right: NDArray[np.int64]) -> JawCurves:
        """Return the two-contact curves of K pegs of a jaw at places (K, 2) in mm, the first at the origin.

        ``right`` (K,) is 1 for moving pegs, else 0; all entries are equal.
        """
        made, slides = [make_pocket_rows(boundary, right)], list[tuple[float, ...]]()
        integers, reals, stretches = (
            [np.zeros((0, CURVE_INTEGERS), np.int64)],
            [np.zeros((0, CURVE_REALS))],
            [],
        )
        stretches.append(np.zeros((0, STRETCH_LENGTH)))
        curves_before = stretches_before = 0
        for one, two in combinations(range(len(pegs)), 2):
            dx, dy = pegs[two] - pegs[one]
            table = boundary.find_chord_curves(hypot(dx, dy), int(right[one]))
            whole = np.array(table.curves.integers)
            whole[:, [FIRST_STRETCH, END_STRETCH]] += stretches_before
            for first, second, angle in ((one, two, atan2(dy, dx)), (two, one, atan2(dy, dx) + pi)):
                # A chord from a piece to itself has all directions already, so its ends need no change of
                # places.
                kept = np.flatnonzero((first == one) | (whole[:, TAIL] != whole[:, HEAD]))
                rows = np.zeros((len(kept), PAIR_LENGTH))
                rows[:, SOURCE], rows[:, FIRST_PEG], rows[:, SECOND_PEG] = kept + curves_before, first, second
                rows[:, ANGLE] = angle
                made.append(rows)
                for pieces, real in zip(table.sliding_pairs.integers, table.sliding_pairs.reals, strict=True):
                    tail, head = int(pieces[TAIL]), int(pieces[HEAD])
                    if first == one or tail != head:
                        low, high, alpha = (float(real[k]) for k in (SLIDE_FROM, SLIDE_TO, DIRECTION))
                        slides.append((first, second, tail, head, low, high, alpha - angle))
            integers.append(whole)
            reals.append(table.curves.reals)
            stretches.append(table.curves.stretches)
            curves_before, stretches_before = (
                curves_before + len(whole),
                stretches_before + len(stretches[-1]),
            )
        rows, curves = np.concatenate(made), (np.concatenate(integers), np.concatenate(reals))
        given, every = (
            HeldPart(rows, *curves, boundary.loose, pegs, right, boundary.parts),
            np.concatenate(stretches),
        )
        cells = fill_rows(
            CELL_LENGTH, 2 * len(every) + 64 * len(boundary.pockets) + 64, make_cells, given, every
        )
        known = np.empty((len(cells), MIDDLE_LENGTH))
        write_middles(cells, given, known)
        return cls(rows, *curves, cells, known, np.array(slides).reshape(-1, SLIDE_LENGTH))

    def number_rows_by_pegs(self, names: Array) -> tuple[Array, Array]:
        """Return copies of (1) ``rows`` and (2) ``slides`` in which peg k has the number ``names[k]``.

        ``names`` (K + 1,) has -1 as its last entry, since -1 stands for no peg.
        """
        rows, slid = np.array(self.rows), np.array(self.slides)
        rows[:, FIRST_PEG : SECOND_PEG + 1] = names[self.pegs]
        slid[:, SLIDE_FIRST : SLIDE_SECOND + 1] = names[self.sliding_pegs]
        return rows, slid

    @cached_property
    def two_peg_rows(self) -> tuple[Array, Array]:
        """The rows and the slides of two pegs, numbered 1 and 2; number 0 is for the single peg of the other
        jaw.
        """
        return self.number_rows_by_pegs(np.array([1.0, 2.0, -1.0]))

    @cached_property
    def pegs(self) -> NDArray[np.int64]:
        """The numbers of both touching pegs of each row (H, 2); the second is -1 for a peg in a pocket."""
        return self.rows[:, FIRST_PEG : SECOND_PEG + 1].astype(np.int64)

    @cached_property
    def sliding_pegs(self) -> NDArray[np.int64]:
        """The numbers of both touching pegs of each slide (S, 2)."""
        return self.slides[:, SLIDE_FIRST : SLIDE_SECOND + 1].astype(np.int64)

    @cached_property
    def pocket_count(self) -> int:
        """Number of rows in which one peg sits in a pocket; these rows come before all others."""
        return int(self.rows[:, KIND].sum())

    @cached_property
    def ordered(self) -> Array:
        """The cells in ascending order of LOW, the orientation at which they begin.

        A cell that extends beyond a whole turn is listed twice, the second time shifted down by a turn.
        """
        again = np.array(self.cells[self.cells[:, HIGH] > tau])
        again[:, [LOW, HIGH]] -= tau
        every = np.concatenate([self.cells, again])
        return every[np.argsort(every[:, LOW], kind="stable")]

    @classmethod
    def find_known(cls, boundary: ObstacleBoundary, subset: PegSubset) -> JawCurves:
        """Return the curves of a subset of pegs of one jaw; they are computed once and cached with the part."""
        kept = boundary.find_once(make_curve_cache)
        found = kept.get(subset.key)
        if found is None:
            found = cls.from_boundary(boundary, subset.pattern.pegs, subset.pattern.right)
            if len(found.cells) + sum(len(one.cells) for one in list(kept.values())) > MOST_KEPT:
                kept.clear()
            kept[subset.key] = found
        return found


def make_curve_cache(_: ObstacleBoundary) -> dict[tuple[object, ...], JawCurves]:
    """Return an empty cache of the curves of jaws on a part; its keys are ``PegSubset.key``. The argument is
    ignored.
    """
    return {}


@define(frozen=True, eq=False)
class TwoContactCurves:
    """The two-contact curves of both jaws of a pattern.

    Parameters
    ----------
    given : the held part in the form that the kernels take.
    sought : the same with pieces slightly longer at both ends, for finding roots, so that none is missed at
        an end.
    slides : (S, 7) pairs of contacts on parallel faces, see ``kernels.seating.slides``.
    jaws : for each jaw (0 fixed, 1 moving): its curves, the number of rows before its own rows, and the
        height (y) of its first peg in mm.
    """

    given: HeldPart
    sought: HeldPart
    slides: Array
    jaws: dict[int, tuple[JawCurves, int, float]]

    @classmethod
    def from_pattern(cls, boundary: ObstacleBoundary, pattern: Pattern) -> TwoContactCurves:
        """Return the curves of both jaws of a pattern."""
        parts: list[tuple[NDArray[Any], ...]] = []
        jaws: dict[int, tuple[JawCurves, int, float]] = {}
        before = curves_before = 0
        for side, subset in list_jaw_subsets(pattern).items():
            known = JawCurves.find_known(boundary, subset)
            rows, slid = known.number_rows_by_pegs(np.array([*subset.numbers, -1.0]))
            # Pockets, of which curves are none, come first.
            rows[known.pocket_count :, SOURCE] += curves_before
            parts.append((rows, known.curves, known.reals, slid))
            jaws[side] = known, before, float(subset.shift[2])
            before, curves_before = before + len(rows), curves_before + len(known.curves)
        rows, curves, reals, slides = (np.concatenate(one) for one in zip(*parts, strict=True))
        return cls(*make_held_parts(boundary, pattern, rows, curves, reals), slides, jaws)

    @classmethod
    def from_one_jaw(cls, boundary: ObstacleBoundary, subset: PegSubset) -> TwoContactCurves:
        """Return the curves of the jaw of a subset that has two or more pegs.

        There are no curves for a subset of one peg of each jaw.
        """
        if len(subset.sides) == 2 and not subset.is_of_a_jaw:
            return cls(*make_held_parts(boundary, subset.pattern, *NO_CURVES), NO_SLIDES, {})
        side = int(2 * sum(subset.sides) > len(subset.sides))
        own = subset
        if not subset.is_of_a_jaw:
            own = PegSubset.from_pattern(
                subset.pattern, np.flatnonzero(np.equal(subset.sides, side)).tolist()
            )
        known = JawCurves.find_known(boundary, own)
        rows, slides = (known.rows, known.slides) if subset.sides[0] == side else known.two_peg_rows
        given = make_held_parts(boundary, subset.pattern, rows, known.curves, known.reals)
        return cls(*given, slides, {side: (known, 0, float(own.shift[2]))})

    def make_jaw_cells(self, right: int) -> JawCells:
        """Return the cells of a jaw (``right`` is 0 for the fixed jaw, 1 for the moving one) in the form that
        the kernels take.
        """
        known, before, height = self.jaws[right]
        return JawCells(known.ordered, before, height)


def make_held_parts(
    boundary: ObstacleBoundary, pattern: Pattern, rows: Array, curves: NDArray[np.int64], reals: Array
) -> tuple[HeldPart, HeldPart]:
    """Return the fields ``given`` and ``sought`` of ``TwoContactCurves``."""
    after = np.array(pattern.pegs), pattern.right, boundary.parts
    return HeldPart(rows, curves, reals, boundary.pieces, *after), HeldPart(
        rows, curves, reals, boundary.loose, *after
    )


def make_pocket_rows(boundary: ObstacleBoundary, right: NDArray[np.int64]) -> Array:
    """Return a row of ``HeldPart.pairs`` for each peg in each pocket that it can touch (H, 7).

    ``right`` (K,) is 1 for moving pegs, else 0.
    """
    held = [
        (peg, pocket)
        for peg, side in enumerate(right.tolist())
        for pocket, (piece, _) in enumerate(boundary.pocket_pieces.tolist())
        if boundary.can_touch(side, piece)
    ]
    rows = np.zeros((len(held), PAIR_LENGTH))
    rows[:, KIND], rows[:, SECOND_PEG] = 1.0, -1.0
    rows[:, [FIRST_PEG, SOURCE]] = np.array(held).reshape(-1, 2)
    rows[:, [PIVOT_X, PIVOT_Y]] = boundary.pockets[rows[:, SOURCE].astype(np.int64), :2]
    return rows
