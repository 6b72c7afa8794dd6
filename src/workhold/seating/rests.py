"""Where a part can rest on pegs, as drawn and turned over, as rows: what seats of all fixtures on them are told from."""

from __future__ import annotations

from math import inf

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.kernels.seating.columns import CANDIDATE_LENGTH, CONFIG, CONTACTS, PEG, PIECE, SEPARATION
from workhold.seating.locus import Locus
from workhold.seating.tree import Tree

__all__ = ["CURVED", "KINDS", "LOOSE", "POCKET", "UNSETTLED", "Rests"]

Array = NDArray[np.float64]
# mm. Seats from which a part is out again with less are not listed: they may be or not.
SHALLOW = 1e-3
# What seats are called, and the numbers of that.
KINDS = "curved", "corner", "pocket", "fixture", "loose", "unsettled"
CURVED, CORNER, POCKET, FIXTURE, LOOSE, UNSETTLED = range(len(KINDS))
# Those from here on are listed all the same: they are fixtures of a complete list, or nothing is known of their depth.
ALWAYS = FIXTURE


@frozen(eq=False)
class Rests:
    """All that is listed.

    Parameters
    ----------
    rows : (N, 24) candidates, of what is not settled the configuration alone.
    kinds : (N,) what each is called, by numbers in ``KINDS``.
    depths : (N,) how far in mm the jaws open before the part can get elsewhere; infinite where it never can, or that was not
        asked.
    turned_over : (N,) whether the part is.
    """

    rows: Array
    kinds: NDArray[np.int64]
    depths: Array
    turned_over: NDArray[np.bool_]

    @classmethod
    def of(cls, trees: tuple[Tree, Tree], locus: Locus, pegs: int) -> Rests:
        """Those of the part as drawn, and then turned over, on so many pegs besides a wall."""
        parts, tops = list[Array](), list[Array]()
        for tree in trees:
            unknown = np.zeros((len(tree.doubtful), CANDIDATE_LENGTH))
            unknown[:, CONFIG] = tree.doubtful
            parts += [tree.seats, tree.loose, tree.slack, unknown]
            tops += [tree.tops, tree.slack[:, SEPARATION], np.full(len(unknown), inf)]
        counts = [len(part) for part in parts]
        rows = np.concatenate(parts)
        kinds = np.repeat([FIXTURE, LOOSE, LOOSE, UNSETTLED] * 2, counts)
        kinds[kinds == FIXTURE] = kinds_of(rows[kinds == FIXTURE], locus, pegs)
        depths = np.concatenate(tops) - rows[:, SEPARATION]
        listed = (kinds >= ALWAYS) | (depths >= SHALLOW)
        turned_over = np.arange(len(rows)) >= sum(counts[:4])
        return cls(rows[listed], kinds[listed], depths[listed], turned_over[listed])


def kinds_of(rows: Array, locus: Locus, pegs: int) -> NDArray[np.int64]:
    """What strict seats (N, 24) are called: with four contacts as a fixture or by what they touch."""
    who, where = (rows[:, at : at + 4].astype(np.int64) for at in (PEG, PIECE))
    ordered = np.sort(who, axis=1)
    twice = (ordered[:, 1:] == ordered[:, :-1]).any(axis=1)
    # Corners on a wall are none that a peg has to keep to.
    corner = (locus.corners[where] & (who < pegs)).any(axis=1)
    four = np.where(twice, POCKET, np.where(corner, CORNER, FIXTURE))
    return np.where(rows[:, CONTACTS] < 4.0, CURVED, four)
