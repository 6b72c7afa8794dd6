"""How far a way down of some pegs of a pattern is free of the others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.seating.columns import Obstacles
from workhold.kernels.seating.pieces import place_on_part
from workhold.kernels.seating.squeezing import is_peg_free

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# mm. A way that ends less above the stop may end at it.
ABOVE = 1e-6
# Parts of a step that is longer than most, at whose ends it is looked at.
PARTS = 3


@inner
def keeps_off(
    config: Array, peg: int, is_first: bool, most: float, obstacles: Obstacles, seen: Array, known: Array
) -> bool:
    """Whether a peg is not in the part in a configuration, nor on a long way to it from where it was seen last."""
    x, y = place_on_part(config, obstacles, peg)
    dx, dy = x - seen[peg, 0], y - seen[peg, 1]
    if not is_first and dx * dx + dy * dy > most * most:
        for part in range(1, PARTS):
            if not is_peg_free(
                seen[peg, 0] + part / PARTS * dx, seen[peg, 1] + part / PARTS * dy, peg, obstacles, known
            ):
                return False
    seen[peg, 0], seen[peg, 1] = x, y
    return is_peg_free(x, y, peg, obstacles, known)


@compiled
def free_until(
    chosen: IntArray,
    nodes: Array,
    begins: IntArray,
    shift: Array,
    others: IntArray,
    most: float,
    obstacles: Obstacles,
    config: Array,
    seen: Array,
    known: Array,
    lasts: IntArray,
) -> None:
    """The number of the last node of ways at which none of other pegs is in the part, nor before it; the one before their
    first where that is not free.

    Parameters
    ----------
    chosen : (N,) numbers of ways.
    nodes, begins : of all ways, as of ``closing.close_jaws``.
    shift : (4,) to be added to their configurations.
    others : (K,) numbers of the pegs.
    most : how long a step of a peg on the part is that is looked at only where it ends, in mm.
    config, seen, known : (4,), (4, 2) and (4, 3) work space.
    lasts : (N,) written here.
    """
    for peg in range(obstacles.pegs.shape[0]):
        known[peg, 2] = -1.0
    for n in range(chosen.shape[0]):
        first, end = begins[chosen[n]], begins[chosen[n] + 1]
        last = first
        while last < end:
            for j in range(4):
                config[j] = nodes[last, j] + shift[j]
            free = config[3] > obstacles.stop + ABOVE
            for k in range(others.shape[0]):
                free = free and keeps_off(config, others[k], last == first, most, obstacles, seen, known)
            if not free:
                break
            last += 1
        lasts[n] = last - 1
