"""The holdings of both jaws of a pattern: chord curves of pairs of pegs, and pegs in pockets
(``kernels.seating.columns``)."""

from __future__ import annotations

from collections.abc import Callable
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
    FROM,
    HEAD,
    SLIDE_FROM,
    SLIDE_TO,
    TAIL,
    TO,
)
from workhold.kernels.seating.columns import (
    ANGLE,
    CELL_LENGTH,
    FIRST_PEG,
    HIGH,
    HOLDING,
    HOLDING_LENGTH,
    KIND,
    LOW,
    PIVOT_X,
    PIVOT_Y,
    SECOND_PEG,
    SOURCE,
    Given,
)
from workhold.kernels.seating.holdings import make_cells
from workhold.seating.locus import Locus
from workhold.seating.pattern import Pattern

__all__ = ["Holdings", "Slide", "filled"]

Array = NDArray[np.float64]


@frozen
class Slide:
    """Two pegs of one jaw on parallel lines, or equal arcs one chord apart, along which the part slides.

    Parameters
    ----------
    first, second : the pegs.
    pieces : what they touch.
    low, high : parameters of the first on its piece.
    psi : orientation of the pegs seen from the part, in radians.
    """

    first: int
    second: int
    pieces: tuple[int, int]
    low: float
    high: float
    psi: float


@define(frozen=True, eq=False)
class Holdings:
    """All holdings of a pattern.

    Parameters
    ----------
    given : what kernels are given, with pieces as they are.
    cells : (C, 7) of all holdings.
    slides : those that are no curve over the orientation.
    """

    given: Given
    cells: Array
    slides: tuple[Slide, ...]

    @classmethod
    def of(cls, locus: Locus, pattern: Pattern) -> Holdings:
        """The holdings of a pattern on a part."""
        holdings, slides = [pockets_held(locus, pattern.right)], list[Slide]()
        integers, reals, stretches = [np.zeros((0, CURVE_INTEGERS), np.int64)], [np.zeros((0, CURVE_REALS))], []
        stretches.append(np.zeros((0, STRETCH_LENGTH)))
        curves_before = stretches_before = 0
        for one, two in combinations(range(4), 2):
            if pattern.right[one] != pattern.right[two]:
                continue
            dx, dy = pattern.pegs[two] - pattern.pegs[one]
            table = locus.curves(hypot(dx, dy), int(pattern.right[one]))
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
                        slides.append(Slide(first, second, (tail, head), low, high, alpha - angle))
            integers.append(whole)
            reals.append(table.curves.reals)
            stretches.append(table.curves.stretches)
            curves_before, stretches_before = curves_before + len(whole), stretches_before + len(stretches[-1])
        given = Given(
            np.concatenate(holdings),
            np.concatenate(integers),
            np.concatenate(reals),
            np.array(locus.loose),
            np.array(pattern.pegs),
            pattern.right,
            locus.parts,
        )
        every = np.concatenate(stretches)
        cells = filled(CELL_LENGTH, 2 * len(every) + 64 * len(locus.pockets) + 64, make_cells, given, every)
        return cls(given._replace(rows=np.array(locus.rows)), cells, tuple(slides))

    def of_jaw(self, right: int) -> Array:
        """The cells of one jaw's holdings, ordered by their lowest orientation, those beyond a turn a second time."""
        cells = self.cells[self.given.right[self.holder(self.cells)] == right]
        again = np.array(cells[cells[:, HIGH] > tau])
        again[:, [LOW, HIGH]] -= tau
        cells = np.concatenate([cells, again])
        return np.ascontiguousarray(cells[np.argsort(cells[:, LOW], kind="stable")])

    def holder(self, cells: Array) -> NDArray[np.int64]:
        """The first pegs (N,) of the holdings of some cells."""
        return np.asarray(self.given.holdings[cells[:, HOLDING].astype(np.int64), FIRST_PEG], np.int64)

    def there(self, psi: float, right: int) -> NDArray[np.int64]:
        """Numbers of a jaw's holdings that may exist at an orientation."""
        within = psi % tau
        held = np.zeros(len(self.cells), np.bool_)
        for at in (within, within + tau):
            held |= (self.cells[:, LOW] <= at + 1e-9) & (self.cells[:, HIGH] >= at - 1e-9)
        held &= self.given.right[self.holder(self.cells)] == right
        return np.unique(self.cells[held, HOLDING].astype(np.int64))

    def inside(self, number: int, psi: float) -> float:
        """An orientation moved by whole turns into the range of a holding."""
        holding = self.given.holdings[number]
        if holding[KIND] == 1.0:
            return psi
        low, high = self.given.reals[int(holding[SOURCE]), [FROM, TO]] - holding[ANGLE]
        return float(min(max(psi + tau * np.ceil((low - 1e-9 - psi) / tau), low), high))


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


def filled(width: int, room: int, kernel: Callable[..., int], *arguments: Any) -> Array:
    """What a kernel writes into its last argument, an array of rows that is made larger until it has room."""
    while True:
        out = np.empty((room, width))
        count = kernel(*arguments, out)
        if count >= 0:
            return out[:count]
        room *= 4
