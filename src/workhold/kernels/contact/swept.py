"""What a tool sweeps that comes nearest to a straight piece, found in a tree of boxes.

Swept pieces are segments or arcs along which an axis runs, each with the radius of its cylinder. The tree is
a heap: node k has the nodes 2 k and 2 k + 1, and the last half of the nodes are leaves with a few pieces
each.

References
----------
J. Goldsmith and J. Salmon, "Automatic Creation of Object Hierarchies for Ray Tracing", IEEE Computer Graphics
and Applications 7 (1987), for bounds of boxes that hold boxes.
"""

from __future__ import annotations

from math import hypot, inf
from typing import NamedTuple

from workhold.kernels.base.compiling import Array, IntArray, compiled, inner
from workhold.kernels.base.distance import piece_distance

__all__ = ["LEAF", "SweptTree", "nearest_swept"]


# Pieces in a leaf, and the nodes that wait at most: a tree is less deep.
LEAF, DEPTH = 4, 64


class SweptTree(NamedTuple):
    """Swept pieces in the order of their tree.

    Parameters
    ----------
    rows : (N, 10) segments and arcs, see ``base.feature``; N is a multiple of the leaves.
    radius : (N,) of the cylinders in mm; -inf for a row that only fills a leaf.
    nodes : (2 L, 5) of each node x0, y0, x1, y1 and the largest radius; the first is none.
    """

    rows: Array
    radius: Array
    nodes: Array


@inner
def node_bound(x0: float, y0: float, x1: float, y1: float, node: Array) -> float:
    """Least clearance in mm that anything in a box has to what a node holds."""
    dx = max(max(node[0] - x1, x0 - node[2]), 0.0)
    dy = max(max(node[1] - y1, y0 - node[3]), 0.0)
    return hypot(dx, dy) - node[4]


@compiled
def nearest_swept(
    starts: Array,
    ends: Array,
    tree: SweptTree,
    waiting: IntArray,
    least: Array,
    which: IntArray,
) -> None:
    """The least distance less radius in mm, and the piece it is to, from straight pieces to what is swept.

    Parameters
    ----------
    starts, ends : (M, 2) ends in mm; equal for a point.
    waiting : (DEPTH,) room for the numbers of nodes.
    least, which : (M,) receive the distances and the numbers of rows.
    """
    rows, radius, nodes = tree.rows, tree.radius, tree.nodes
    leaves = nodes.shape[0] // 2
    for k in range(starts.shape[0]):
        x0, x1 = min(starts[k, 0], ends[k, 0]), max(starts[k, 0], ends[k, 0])
        y0, y1 = min(starts[k, 1], ends[k, 1]), max(starts[k, 1], ends[k, 1])
        best, found, count = inf, -1, 1
        waiting[0] = 1
        while count > 0:
            count -= 1
            node = waiting[count]
            if node_bound(x0, y0, x1, y1, nodes[node]) >= best:
                continue
            if node < leaves:
                one, other = 2 * node, 2 * node + 1
                if node_bound(x0, y0, x1, y1, nodes[one]) < node_bound(x0, y0, x1, y1, nodes[other]):
                    one, other = other, one
                # The nearer one is looked at first.
                waiting[count], waiting[count + 1] = one, other
                count += 2
                continue
            first = (node - leaves) * LEAF
            for row in range(first, first + LEAF):
                if radius[row] == -inf:
                    continue
                off = piece_distance(starts[k], ends[k], rows[row]) - radius[row]
                if off < best:
                    best, found = off, row
        least[k], which[k] = best, found
