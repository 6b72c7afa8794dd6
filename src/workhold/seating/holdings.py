"""The holdings of both jaws of a pattern: chord curves of pairs of pegs, and pegs in pockets
(``kernels.seating.columns``)."""

from __future__ import annotations

from functools import cached_property
from itertools import combinations
from math import atan2, hypot, pi, tau
from typing import Any

import numpy as np
from attrs import define, frozen
from numpy.typing import NDArray

from workhold.kernels.chord.stretches import STRETCH_LENGTH
from workhold.kernels.curves.columns import (
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
from workhold.kernels.seating.columns import (
    ANGLE,
    CELL_LENGTH,
    FIRST_PEG,
    HIGH,
    HOLDING_LENGTH,
    KIND,
    LOW,
    PIVOT_X,
    PIVOT_Y,
    SECOND_PEG,
    SOURCE,
    Given,
    JawCells,
)
from workhold.kernels.seating.holdings import make_cells
from workhold.kernels.seating.middles import MIDDLE_LENGTH, write_middles
from workhold.kernels.seating.slides import SLIDE_FIRST, SLIDE_LENGTH, SLIDE_SECOND
from workhold.seating.groups import Group, jaw_groups
from workhold.seating.growing_rows import filled
from workhold.seating.locus import Locus
from workhold.seating.pattern import Pattern

__all__ = ["Holdings", "JawHoldings"]

Array = NDArray[np.float64]
# Cells of the holdings that are kept, of about 360 bytes with all that belongs to them; beyond, all are forgotten.
MOST_KEPT = 250_000
NO_HOLDINGS = np.zeros((0, HOLDING_LENGTH)), np.zeros((0, CURVE_INTEGERS), np.int64), np.zeros((0, CURVE_REALS))
NO_SLIDES = np.zeros((0, SLIDE_LENGTH))


@frozen(eq=False, slots=False)
class JawHoldings:
    """The holdings of the pegs of one jaw, in the frame of their group.

    Parameters
    ----------
    holdings, curves, reals : as of ``Given``, pegs and curves counted from 0.
    cells, middles : (C, 7) and (C, 19) of all holdings, those of one after each other, see ``kernels.seating.middles``.
    slides : (S, 7) what is no curve over the orientation: ``kernels.seating.slides``.
    """

    holdings: Array
    curves: NDArray[np.int64]
    reals: Array
    cells: Array
    middles: Array
    slides: Array

    @classmethod
    def of(cls, locus: Locus, pegs: Array, right: NDArray[np.int64]) -> JawHoldings:
        """The holdings of pegs (K, 2) of a jaw, the first at the origin."""
        holdings, slides = [pockets_held(locus, right)], list[tuple[float, ...]]()
        integers, reals, stretches = [np.zeros((0, CURVE_INTEGERS), np.int64)], [np.zeros((0, CURVE_REALS))], []
        stretches.append(np.zeros((0, STRETCH_LENGTH)))
        curves_before = stretches_before = 0
        for one, two in combinations(range(len(pegs)), 2):
            dx, dy = pegs[two] - pegs[one]
            table = locus.curves(hypot(dx, dy), int(right[one]))
            whole = np.array(table.curves.integers)
            whole[:, [FIRST_STRETCH, END_STRETCH]] += stretches_before
            for first, second, angle in ((one, two, atan2(dy, dx)), (two, one, atan2(dy, dx) + pi)):
                # Of a chord from a piece to itself all directions are told, so that its ends need no change of places.
                kept = np.flatnonzero((first == one) | (whole[:, TAIL] != whole[:, HEAD]))
                rows = np.zeros((len(kept), HOLDING_LENGTH))
                rows[:, SOURCE], rows[:, FIRST_PEG], rows[:, SECOND_PEG] = kept + curves_before, first, second
                rows[:, ANGLE] = angle
                holdings.append(rows)
                for pieces, real in zip(table.sliding_pairs.integers, table.sliding_pairs.reals, strict=True):
                    tail, head = int(pieces[TAIL]), int(pieces[HEAD])
                    if first == one or tail != head:
                        low, high, alpha = (float(real[k]) for k in (SLIDE_FROM, SLIDE_TO, DIRECTION))
                        slides.append((first, second, tail, head, low, high, alpha - angle))
            integers.append(whole)
            reals.append(table.curves.reals)
            stretches.append(table.curves.stretches)
            curves_before, stretches_before = curves_before + len(whole), stretches_before + len(stretches[-1])
        rows, curves = np.concatenate(holdings), (np.concatenate(integers), np.concatenate(reals))
        given, every = Given(rows, *curves, locus.loose, pegs, right, locus.parts), np.concatenate(stretches)
        cells = filled(CELL_LENGTH, 2 * len(every) + 64 * len(locus.pockets) + 64, make_cells, given, every)
        known = np.empty((len(cells), MIDDLE_LENGTH))
        write_middles(cells, given, known)
        return cls(rows, *curves, cells, known, np.array(slides).reshape(-1, SLIDE_LENGTH))

    def named(self, names: Array) -> tuple[Array, Array]:
        """The holdings and the slides with a pattern's numbers (K + 1,) of the pegs, last -1 of none."""
        rows, slid = np.array(self.holdings), np.array(self.slides)
        rows[:, FIRST_PEG : SECOND_PEG + 1] = names[self.pegs]
        slid[:, SLIDE_FIRST : SLIDE_SECOND + 1] = names[self.sliding_pegs]
        return rows, slid

    @cached_property
    def after_one(self) -> tuple[Array, Array]:
        """The same of two pegs that come after the only one of the other jaw."""
        return self.named(np.array([1.0, 2.0, -1.0]))

    @cached_property
    def pegs(self) -> NDArray[np.int64]:
        """The pegs (H, 2) of the holdings."""
        return self.holdings[:, FIRST_PEG : SECOND_PEG + 1].astype(np.int64)

    @cached_property
    def sliding_pegs(self) -> NDArray[np.int64]:
        """Those (S, 2) of the slides."""
        return self.slides[:, SLIDE_FIRST : SLIDE_SECOND + 1].astype(np.int64)

    @cached_property
    def pockets(self) -> int:
        """How many holdings are of a peg in a pocket: the first ones."""
        return int(self.holdings[:, KIND].sum())

    @cached_property
    def ordered(self) -> Array:
        """The cells ordered by their lowest orientation, those beyond a turn a second time."""
        again = np.array(self.cells[self.cells[:, HIGH] > tau])
        again[:, [LOW, HIGH]] -= tau
        every = np.concatenate([self.cells, again])
        return every[np.argsort(every[:, LOW], kind="stable")]

    @classmethod
    def known(cls, locus: Locus, group: Group) -> JawHoldings:
        """The same of a group of pegs of one jaw, worked out once for all that stand alike."""
        kept = locus.once(held_by_jaws)
        found = kept.get(group.key)
        if found is None:
            found = cls.of(locus, group.pattern.pegs, group.pattern.right)
            if len(found.cells) + sum(len(one.cells) for one in list(kept.values())) > MOST_KEPT:
                kept.clear()
            kept[group.key] = found
        return found


def held_by_jaws(_: Locus) -> dict[tuple[object, ...], JawHoldings]:
    """Room for the holdings of jaws on a part, by how their pegs stand."""
    return {}


@define(frozen=True, eq=False)
class Holdings:
    """All holdings of a pattern.

    Parameters
    ----------
    given : what kernels are given, with pieces as they are.
    sought : the same with pieces on which roots are sought: curves run past their ends by a hair, and so do these.
    slides : (S, 7) those that are no curve over the orientation.
    jaws : by what moves, those of each jaw, how many holdings stand before them and the height of their first peg in mm.
    """

    given: Given
    sought: Given
    slides: Array
    jaws: dict[int, tuple[JawHoldings, int, float]]

    @classmethod
    def of(cls, locus: Locus, pattern: Pattern) -> Holdings:
        """The holdings of a pattern on a part."""
        parts: list[tuple[NDArray[Any], ...]] = []
        jaws: dict[int, tuple[JawHoldings, int, float]] = {}
        before = curves_before = 0
        for side, group in jaw_groups(pattern).items():
            known = JawHoldings.known(locus, group)
            rows, slid = known.named(group.names)
            # Pockets, of which curves are none, come first.
            rows[known.pockets :, SOURCE] += curves_before
            parts.append((rows, known.curves, known.reals, slid))
            jaws[side] = known, before, float(group.shift[2])
            before, curves_before = before + len(rows), curves_before + len(known.curves)
        rows, curves, reals, slides = (np.concatenate(one) for one in zip(*parts, strict=True))
        return cls(*given_of(locus, pattern, rows, curves, reals), slides, jaws)

    @classmethod
    def of_jaw_alone(cls, locus: Locus, group: Group) -> Holdings:
        """Those of a group's pegs of one jaw, where the other has one or none; of a peg of each there are none."""
        if len(group.sides) == 2 and not group.is_of_a_jaw:
            return cls(*given_of(locus, group.pattern, *NO_HOLDINGS), NO_SLIDES, {})
        side = int(2 * sum(group.sides) > len(group.sides))
        own = group if group.is_of_a_jaw else group.of_jaw(side)
        known = JawHoldings.known(locus, own)
        rows, slides = (known.holdings, known.slides) if group.sides[0] == side else known.after_one
        given = given_of(locus, group.pattern, rows, known.curves, known.reals)
        return cls(*given, slides, {side: (known, 0, float(own.shift[2]))})

    def of_jaw(self, right: int) -> JawCells:
        """The cells of one jaw's holdings in order."""
        known, before, height = self.jaws[right]
        return JawCells(known.ordered, before, height)


def given_of(
    locus: Locus, pattern: Pattern, holdings: Array, curves: NDArray[np.int64], reals: Array
) -> tuple[Given, Given]:
    """What is given and what is sought as of ``Holdings``."""
    after = np.array(pattern.pegs), pattern.right, locus.parts
    return Given(holdings, curves, reals, locus.pieces, *after), Given(holdings, curves, reals, locus.loose, *after)


def pockets_held(locus: Locus, right: NDArray[np.int64]) -> Array:
    """The holdings of each peg in each pocket."""
    held = [
        (peg, pocket)
        for peg, side in enumerate(right.tolist())
        for pocket, (piece, _) in enumerate(locus.pocket_pieces.tolist())
        if locus.fits(side, piece)
    ]
    rows = np.zeros((len(held), HOLDING_LENGTH))
    rows[:, KIND], rows[:, SECOND_PEG] = 1.0, -1.0
    rows[:, [FIRST_PEG, SOURCE]] = np.array(held).reshape(-1, 2)
    rows[:, [PIVOT_X, PIVOT_Y]] = locus.pockets[rows[:, SOURCE].astype(np.int64), :2]
    return rows
