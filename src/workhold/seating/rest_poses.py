"""Where a part can rest on pegs, as drawn and turned over: rows for the seats of all fixtures on them.

Glossary
--------
rest pose : a pose in which a part comes to rest by itself: K. Goldberg, B. Mirtich, Y. Zhuang, J. Craig, B.
    Carlisle and J. Canny, "Part pose statistics: estimators and experiments", IEEE Transactions on Robotics
    and Automation 15 (1999).
"""

from __future__ import annotations

from math import inf

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.kernels.seating.columns import CANDIDATE_LENGTH, CONFIG, CONTACTS, PEG, PIECE, SEPARATION
from workhold.seating.join_tree import JoinTree
from workhold.seating.obstacle_boundary import ObstacleBoundary

__all__ = ["CURVED", "KINDS", "LOOSE", "POCKET", "UNSETTLED", "RestPoses"]

Array = NDArray[np.float64]
# mm. Seats from which a part is out again with less are not listed: they may be or not.
SHALLOW = 1e-3
# The kinds of seats, and their numbers.
KINDS = "curved", "corner", "pocket", "fixture", "loose", "unsettled"
CURVED, CORNER, POCKET, FIXTURE, LOOSE, UNSETTLED = range(len(KINDS))
# Kinds from here on are listed whatever their depth: they are fixtures of a complete list, or their depth is
# not known.
ALWAYS = FIXTURE


@frozen(eq=False)
class RestPoses:
    """All rest poses that are listed.

    Parameters
    ----------
    rows : (N, 24) candidates; of what is not settled only the configuration is known.
    kinds : (N,) numbers of the kinds in ``KINDS``.
    depths : (N,) how far in mm the jaws open before the part can get elsewhere; infinite where it never can,
        or where that is not known.
    turned_over : (N,) whether the part is.
    """

    rows: Array
    kinds: NDArray[np.int64]
    depths: Array
    turned_over: NDArray[np.bool_]

    @classmethod
    def of(cls, trees: tuple[JoinTree, JoinTree], boundary: ObstacleBoundary, pegs: int) -> RestPoses:
        """The rest poses of a part as drawn, and then turned over, on so many pegs besides a wall."""
        parts, tops = list[Array](), list[Array]()
        for tree in trees:
            unknown = np.zeros((len(tree.doubtful), CANDIDATE_LENGTH))
            unknown[:, CONFIG] = tree.doubtful
            parts += [tree.seats, tree.loose, tree.slack, unknown]
            tops += [tree.tops, tree.slack[:, SEPARATION], np.full(len(unknown), inf)]
        counts = [len(part) for part in parts]
        rows = np.concatenate(parts)
        kinds = np.repeat([FIXTURE, LOOSE, LOOSE, UNSETTLED] * 2, counts)
        kinds[kinds == FIXTURE] = kinds_of(rows[kinds == FIXTURE], boundary, pegs)
        depths = np.concatenate(tops) - rows[:, SEPARATION]
        listed = (kinds >= ALWAYS) | (depths >= SHALLOW)
        turned_over = np.arange(len(rows)) >= sum(counts[:4])
        return cls(rows[listed], kinds[listed], depths[listed], turned_over[listed])


def kinds_of(rows: Array, boundary: ObstacleBoundary, pegs: int) -> NDArray[np.int64]:
    """The kinds (N,) of strict seats (N, 24), by the number of contacts and by what they touch."""
    who, where = (rows[:, at : at + 4].astype(np.int64) for at in (PEG, PIECE))
    ordered = np.sort(who, axis=1)
    twice = (ordered[:, 1:] == ordered[:, :-1]).any(axis=1)
    # A corner on a wall is not one that a peg has to keep to.
    corner = (boundary.corners[where] & (who < pegs)).any(axis=1)
    four = np.where(twice, POCKET, np.where(corner, CORNER, FIXTURE))
    return np.where(rows[:, CONTACTS] < 4.0, CURVED, four)
