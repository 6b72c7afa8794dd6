"""How far ways down of some pegs of a pattern are free of the others."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.seating.columns import COSINE, MOVED, SINE, TURNED, Obstacles
from workhold.kernels.seating.squeezing import is_peg_free

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# mm. A way that ends less above the stop may end at it.
ABOVE = 1e-6
# Parts of a step that is longer than most, at whose ends it is looked at.
PARTS = 3


@inner
def place_at(node: Array, shift: Array, peg: int, obstacles: Obstacles) -> tuple[float, float]:
    """Place of a peg's centre on the part at a node, which is shifted but not turned."""
    x = obstacles.pegs[peg, 0] + obstacles.right[peg] * (node[3] + shift[3]) - (node[1] + shift[1])
    y = obstacles.pegs[peg, 1] - (node[2] + shift[2])
    return (node[COSINE] * x + node[SINE] * y, node[COSINE] * y - node[SINE] * x)


@inner
def is_step_free(
    from_x: float, from_y: float, to_x: float, to_y: float, peg: int, most: float, obstacles: Obstacles, known: Array
) -> bool:
    """Whether a peg is not in the part on a step on it, at places no farther apart than most but for a few."""
    dx, dy = to_x - from_x, to_y - from_y
    if dx * dx + dy * dy > most * most:
        for part in range(1, PARTS):
            if not is_peg_free(from_x + part / PARTS * dx, from_y + part / PARTS * dy, peg, obstacles, known):
                return False
    return True


@inner
def last_near(nodes: Array, at: int, end: int, x: float, y: float, peg: int, known: Array) -> int:
    """The last node up to which, from one where a peg is at a place of the part, it surely stays within the disc in which it
    is known to be free: no place on the part that is as far from its centre moves faster than the part turns and moves."""
    dx, dy = x - known[peg, 0], y - known[peg, 1]
    left = known[peg, 2] - sqrt(dx * dx + dy * dy)
    if left > 0.0:
        arm = sqrt(x * x + y * y) + left
        turned, moved = nodes[at, TURNED], nodes[at, MOVED]
        while at + 1 < end and (nodes[at + 1, TURNED] - turned) * arm + nodes[at + 1, MOVED] - moved < left:
            at += 1
    return at


@inner
def end_of_free(
    nodes: Array, first: int, end: int, shift: Array, peg: int, most: float, obstacles: Obstacles, known: Array
) -> int:
    """The first of some nodes of a way at which a peg is in the part, or on the step to it; their end where there is
    none."""
    at, from_x, from_y = first, 0.0, 0.0
    while at < end:
        x, y = place_at(nodes[at], shift, peg, obstacles)
        if at > first and not is_step_free(from_x, from_y, x, y, peg, most, obstacles, known):
            return at
        if not is_peg_free(x, y, peg, obstacles, known):
            return at
        last = last_near(nodes, at, end, x, y, peg, known)
        from_x, from_y = (x, y) if last == at else place_at(nodes[last], shift, peg, obstacles)
        at = last + 1
    return end


@compiled
def free_until(
    chosen: IntArray,
    whose: IntArray,
    nodes: Array,
    begins: IntArray,
    shifts: Array,
    others: NDArray[np.int8],
    most: float,
    obstacles: Obstacles,
    known: Array,
    lasts: IntArray,
) -> None:
    """The number of the last node of ways at which none of other pegs is in the part, nor before it; the one before their
    first where that is not free.

    Parameters
    ----------
    chosen, whose : (N,) numbers of ways, and of the groups of pegs whose they are.
    nodes, begins : of all ways, as of ``closing.close_jaws``.
    shifts : (G, 4) to be added to the configurations of each group.
    others : (G, K) 1 for the pegs that are not in each group.
    most : how long a step of a peg on the part is that is looked at only where it ends, in mm.
    known : (4, 4) work space.
    lasts : (N,) written here.
    """
    for peg in range(obstacles.pegs.shape[0]):
        known[peg, 2], known[peg, 3] = -1.0, 0.0
    for n in range(chosen.shape[0]):
        group, first, end = whose[n], begins[chosen[n]], begins[chosen[n] + 1]
        # On a way S only falls.
        while end > first and nodes[end - 1, 3] + shifts[group, 3] <= obstacles.stop + ABOVE:
            end -= 1
        for peg in range(obstacles.pegs.shape[0]):
            if others[group, peg] != 0:
                end = end_of_free(nodes, first, end, shifts[group], peg, most, obstacles, known)
        lasts[n] = end - 1
