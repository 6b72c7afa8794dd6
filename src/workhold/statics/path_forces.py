"""The place along a program where the force of a tool makes a linear function of the load largest.

A contact's force is linear in the load, and so is the jaw force that keeps it: a g_x + b g_y + c m. A tool at
p presses with F in a direction phi at its periphery. Its moment is that of F at p and a torque between -T and
T. The largest value there is

    V = F ((a - p_y c) cos phi + (b + p_x c) sin phi) + T |c|.

*A straight move.* For a fixed phi, V is linear in p, so it is greatest at an end. The range of directions is
the same all along the move. So the maximum over phi is greatest at an end, too. Each end becomes a point with
a range of directions.

*An arc*, p = m + r (cos alpha, sin alpha), run with the sense s = 1 (counter-clockwise) or -1. The direction
is delta from against the feed: phi = alpha + s pi / 2 + pi + delta, |delta| <= h. Let A and phi0 be size and
angle of (a - m_y c, b + m_x c). The moment of r turns with phi, and

    V = F (A cos(phi - phi0) - s c r cos delta) + T |c|.

On the rectangle of alpha and delta, the maximum is at an end of alpha, which is a point as above, or where
the derivative in alpha vanishes, sin(phi - phi0) = 0. Of its two solutions, cos = 1 gives the greater value.
The remaining term -s c r cos delta is greatest at delta = 0 or at |delta| = h. So an arc has two ends and at
most three inner places to examine. If all directions are possible, h = pi, there are two: V - T |c| is F |c|
times the distance of p from the point where V = T |c|, so it is greatest straight beyond the centre.

*Blocks.* Pieces are evaluated in blocks. For a block with a circle around it, an upper bound of V is the
value at the circle's centre with the block's largest F and T, plus F |c| times the circle's radius. Blocks
that cannot contain the largest value are skipped.

*Hulls.* For one range of directions V = F v(p), with v convex in p, as T is F times the tool's radius. Take
the convex hull of points of the path with at least as large a force and the same directions. A point inside
or on it can exceed all of these only if V < 0, and then the idle tool, V = 0, which always counts, exceeds
it. An arc lies inside if a polygon around it does. So hulls are built from the largest forces down, and
pieces inside the hull of earlier ones are left out.

References: G. B. Dantzig, *Linear Programming and Extensions*, 1963, for extremes at corners; A. H. Land and
A. G. Doig, Econometrica 28 (1960), for the blocks.
"""

from __future__ import annotations

from functools import lru_cache
from math import pi

import numpy as np
from attrs import evolve, field, frozen
from numpy.typing import NDArray

from workhold.geometry.hull import compute_convex_hull, compute_half_hull
from workhold.model.cutting_tool import ANY
from workhold.model.moves import MoveStretches
from workhold.model.program import Program

__all__ = ["COLUMNS", "EVERY", "WITHIN", "PathForces", "WorstPlace", "list_all_pieces", "list_path_forces"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Mask = NDArray[np.bool_]

# Radians. Half the range of directions about that opposite to the feed, and half a turn for any direction.
WITHIN, EVERY = pi / 3, pi
# Number of pieces in a block, and of numbers that are computed together.
BLOCK, AT_ONCE = 32, 1 << 20
# Relative rounding error of a bound, at most.
SURELY = 1e-12
COLUMNS = ("move", "force", "torque", "x", "y", "radius", "start", "sweep", "against")


@frozen(eq=False)
class WorstPlace:
    """The place along a program where each of N quantities is largest.

    Parameters
    ----------
    value : (N,) the largest value, at least 0, since the tool may be idle.
    which : (N,) index of the function of the row that is largest there; -1 where 0 is the largest.
    move : (N,) index of the program's move; -1 where 0 is the largest.
    """

    value: Array
    which: IntArray
    move: IntArray


@frozen(eq=False)
class PathForces:
    """The K pieces of a path at which a linear function of the load can be largest.

    A piece is a point, or an arc without its ends.

    Parameters
    ----------
    move : (K,) index of the program's move; of equal pieces the first.
    force : (K,) size of the tool's force in the plane, in N.
    torque : (K,) size of the tool's torque, in N mm.
    x, y : (K,) the point, or the centre of the arc, relative to the point that moments are taken about, in
        mm.
    radius : (K,) radius of the arc, in mm; 0 for a point.
    start, sweep : (K,) angle at which the arc starts, and signed angle by which it turns, in radians.
    against : (K,) direction opposite to the feed at a point, in radians.
    spread : half width of the range of directions about it, in radians; pi for any direction.
    """

    move: IntArray
    force: Array
    torque: Array
    x: Array
    y: Array
    radius: Array
    start: Array
    sweep: Array
    against: Array
    spread: float
    blocks: PieceBlocks = field(init=False)

    def __attrs_post_init__(self) -> None:
        object.__setattr__(self, "blocks", PieceBlocks.from_pieces(self))

    def __len__(self) -> int:
        return len(self.move)

    def take(self, chosen: Mask | IntArray) -> PathForces:
        """Return the pieces that a mask or an index array selects."""
        return evolve(self, **{name: getattr(self, name)[chosen] for name in COLUMNS})

    def find_worst(self, functions: Array) -> WorstPlace:
        """Return the largest value along the path of each row of linear functions of the load, and its place.

        Parameters
        ----------
        functions : (N, J, 3) coefficients a, b, c of J functions a g_x + b g_y + c m in each row.
        """
        rows, each = functions.shape[:2]
        found = WorstPlace(np.zeros(rows), *(np.full(rows, -1) for _ in range(2)))
        count = len(self.blocks.first)
        step = max(AT_ONCE // max(each * count, 1), 1)
        for first in range(0, rows if count else 0, step):
            part = slice(first, min(first + step, rows))
            self.search_rows(functions[part], found, first)
        return found

    def search_rows(self, functions: Array, found: WorstPlace, first: int) -> None:
        """Write the worst places of rows of functions (R, J, 3) into ``found``, from its row ``first`` on."""
        rows, each = functions.shape[:2]
        bounds = self.blocks.compute_bounds(functions.reshape(-1, 3), self.spread).reshape(rows, -1)
        bounds *= 1.0 + SURELY
        blocks = bounds.shape[1] // each
        # The most promising block of each row first; then all that may still hold more.
        likely = bounds.argmax(axis=1)
        self.search_blocks(functions, np.arange(rows), likely, blocks, found, first)
        known = found.value[first : first + rows]
        bounds[np.arange(rows), likely] = -np.inf
        row, place = np.nonzero(bounds > known[:, None])
        # The order is by bounds, so that ties go to the same place whatever the number of rows.
        for begin in range(0, len(row), step := max(AT_ONCE // BLOCK, 1)):
            part = slice(begin, begin + step)
            self.search_blocks(functions, row[part], place[part], blocks, found, first)

    def search_blocks(
        self, functions: Array, row: IntArray, place: IntArray, blocks: int, found: WorstPlace, first: int
    ) -> None:
        """Evaluate one block of pieces for each of Q queries, and write
        values larger than those in ``found`` into it.

        Parameters
        ----------
        row : (Q,) row of ``functions``.
        place : (Q,) index of the function in its row, times ``blocks``, plus the index of the block in which
            to search.
        blocks : number of blocks.
        first : row of ``found`` that row 0 of ``functions`` belongs to.
        """
        which, block = np.divmod(place, blocks)
        values, piece = self.blocks.find_greatest(self, functions[row, which], block)
        # Of one row the worst; of several that tie, the first function and the first move.
        order = np.lexsort((self.move[piece], which, -values, row))
        leading = order[np.concatenate([[True], np.diff(row[order]) > 0])] if len(order) else order
        at = first + row[leading]
        better = values[leading] > found.value[at]
        leading, at = leading[better], at[better]
        found.value[at], found.which[at] = values[leading], which[leading]
        found.move[at] = self.move[piece[leading]]

    def evaluate(self, a: Array, b: Array, c: Array, piece: IntArray) -> Array:
        """Return the largest V at each piece for coefficients a, b, c;
        -inf in an arc without an inner extreme.

        All arrays have the same shape (...); ``piece`` are indices. V is the function of the module's head.
        """
        force, torque, radius = self.force[piece], self.torque[piece], self.radius[piece]
        x, y = a - self.y[piece] * c, b + self.x[piece] * c
        size = np.hypot(x, y)
        straight = radius == 0.0
        if self.spread >= EVERY:
            largest = size
        else:
            largest = find_largest_within(x, y, size, self.against[piece], self.spread)
        out = np.where(straight, force * largest, -np.inf)
        # Only arcs are left.
        arc = np.nonzero(~straight)
        if len(arc[0]):
            out[arc] = force[arc] * self.evaluate_within_arcs(x[arc], y[arc], size[arc], c[arc], piece[arc])
        return np.asarray(out + torque * np.abs(c))

    def evaluate_within_arcs(self, x: Array, y: Array, size: Array, c: Array, piece: IntArray) -> Array:
        """Return the largest value of V at the inner extremes of each of Q arcs, (Q,); -inf if an arc has
        none.

        V is the value of the module, here per unit of the tool's force (F = 1) and without a torque (T = 0).

        Parameters
        ----------
        x, y : (Q,) a - m_y c and b + m_x c, where (m_x, m_y) is the arc's centre.
        size : (Q,) length of the vector (x, y).
        """
        sweep = self.sweep[piece]
        sense = np.sign(sweep)
        peak, best = np.arctan2(y, x), np.full(len(x), -np.inf)
        for delta in (0.0, EVERY) if self.spread >= EVERY else (0.0, -self.spread, self.spread):
            # The angle of the point at which the force is along the peak.
            alpha = peak - sense * pi / 2 - pi - delta
            inside = np.mod((alpha - self.start[piece]) * sense, 2 * pi) <= np.abs(sweep)
            value = size - sense * c * self.radius[piece] * np.cos(delta)
            best = np.where(inside, np.maximum(best, value), best)
        return best


def find_largest_within(x: Array, y: Array, size: Array, middle: Array, half: Array | float) -> Array:
    """Return the largest x cos t + y sin t for t within ``half`` of ``middle``, in radians, elementwise.

    ``size`` is hypot(x, y).
    """
    along = x * np.cos(middle) + y * np.sin(middle)
    across = np.abs(y * np.cos(middle) - x * np.sin(middle))
    at_end = along * np.cos(half) + across * np.sin(half)
    return np.where(along >= size * np.cos(half), size, at_end)


@frozen(eq=False)
class PieceBlocks:
    """Blocks of consecutive pieces, each with a circle around it, for upper bounds; see :class:`PathForces`.

    Parameters
    ----------
    first : (B,) index of the first piece of each of B blocks.
    x, y, reach : (B,) centre and radius in mm of a circle that contains the block's points.
    force, torque : (B,) largest force and largest torque in the block.
    against, half : (B,) middle and half width of the range of the force's directions in the block, in
        radians.
    """

    first: IntArray
    x: Array
    y: Array
    reach: Array
    force: Array
    torque: Array
    against: Array
    half: Array

    @classmethod
    def from_pieces(cls, pieces: PathForces) -> PieceBlocks:
        """Return the blocks of :data:`BLOCK` consecutive pieces each."""
        first = np.arange(0, len(pieces), BLOCK)
        if not len(first):
            return cls(first, *(np.zeros(0) for _ in range(7)))
        size = np.diff(np.append(first, len(pieces)))
        block = np.repeat(np.arange(len(first)), size)
        low, high = (
            [ends.reduceat(sign * one + pieces.radius, first) for one in (pieces.x, pieces.y)]
            for ends, sign in ((np.maximum, -1.0), (np.maximum, 1.0))
        )
        x, y = ((high[k] - low[k]) / 2 for k in range(2))
        off = np.hypot(pieces.x - x[block], pieces.y - y[block]) + pieces.radius
        turned = pieces.sweep != 0.0
        sense = np.sign(pieces.sweep)
        middle = np.where(turned, pieces.start + pieces.sweep / 2 + sense * pi / 2 + pi, pieces.against)
        against = middle[first]
        apart = np.abs((middle - against[block] + pi) % (2 * pi) - pi) + np.abs(pieces.sweep) / 2
        return cls(
            first,
            x,
            y,
            np.maximum.reduceat(off, first),
            np.maximum.reduceat(pieces.force, first),
            np.maximum.reduceat(pieces.torque, first),
            against,
            np.minimum(np.maximum.reduceat(apart, first) + pieces.spread, pi),
        )

    def compute_bounds(self, functions: Array, spread: float) -> Array:
        """Return upper bounds of N linear functions (N, 3) of the load
        over the pieces of each of B blocks, (N, B).
        """
        a, b, c = (functions[:, k, None] for k in range(3))
        x, y = a - self.y * c, b + self.x * c
        largest = np.hypot(x, y)
        if spread < EVERY:
            narrow = find_largest_within(x, y, largest, self.against, self.half)
            largest = np.where(self.half < EVERY, narrow, largest)
        # Where the value is negative, no force is larger.
        largest = np.maximum(largest + self.reach * np.abs(c), 0.0)
        return np.asarray(self.force * largest + self.torque * np.abs(c))

    def find_greatest(self, pieces: PathForces, functions: Array, block: IntArray) -> tuple[Array, IntArray]:
        """Return (1) the largest value of each function (Q, 3) in its block
        (Q,), and (2) the index of the piece, (Q,).
        """
        piece = np.minimum(self.first[block][:, None] + np.arange(BLOCK), len(pieces) - 1)
        a, b, c = (np.broadcast_to(functions[:, k, None], piece.shape) for k in range(3))
        values = pieces.evaluate(a, b, c, piece)
        best = values.argmax(axis=1)
        rows = np.arange(len(block))
        return values[rows, best], piece[rows, best]


# Number of points in the first run and hull, and the most different forces that have a run of their own.
FIRST, MOST_LEVELS = 256, 64


@lru_cache(maxsize=8)
def list_path_forces(program: Program, center: tuple[float, float]) -> PathForces:
    """Return the pieces of a program where forces can be worst; none without cutting forces. The result is
    cached.

    Moments are taken about ``center`` in mm.
    """
    pieces = list_all_pieces(program, center)
    return drop_inner_pieces(drop_lesser_torques(pieces))


def list_all_pieces(program: Program, center: tuple[float, float]) -> PathForces:
    """Return both ends of every stretch of path with a force, and the
    insides of arcs, in the order of moves.
    """
    forces = program.forces
    stretches = MoveStretches((), (), ()) if forces is None else forces.stretches
    does, moves = stretches.move, program.moves.cut_into_stretches(stretches)
    start, end = (one[:, :2] - np.array(center) for one in (moves.start, moves.end))
    chord, bulge = end - start, moves.bulge
    round_ = (bulge != 0.0) & (chord != 0.0).any(axis=1)
    turn = np.where(round_, 4.0 * np.arctan(bulge), 0.0)
    heading = np.arctan2(chord[:, 1], chord[:, 0]) + pi
    arcs = np.flatnonzero(round_)
    # The half sweep's cotangent places the centre on the left of the chord.
    safe = bulge[arcs]
    left = np.stack([-chord[arcs, 1], chord[arcs, 0]], axis=1)
    middle = (start[arcs] + end[arcs]) / 2 + left * ((1.0 - safe * safe) / (4.0 * safe))[:, None]
    arm = start[arcs] - middle
    every = np.concatenate([does, does, does[arcs]])
    none, zeros = np.zeros(2 * len(does)), np.zeros(len(arcs))
    force, torque = (
        (np.zeros(0), np.zeros(0)) if forces is None else (forces.force[every], forces.torque[every])
    )
    x, y = np.concatenate([start, end, middle]).T
    pieces = PathForces(
        every,
        force,
        torque,
        x,
        y,
        np.concatenate([none, np.hypot(*arm.T)]),
        np.concatenate([none, np.arctan2(arm[:, 1], arm[:, 0])]),
        np.concatenate([none, turn[arcs]]),
        np.concatenate([heading - turn / 2, heading + turn / 2, zeros]),
        EVERY if forces is None or forces.direction == ANY else WITHIN,
    )
    return pieces.take(np.argsort(every, kind="stable"))


def drop_lesser_torques(pieces: PathForces) -> PathForces:
    """Return the pieces with a force and, of the pieces with a torque
    alone, only the one with the largest torque.
    """
    alone = np.flatnonzero(pieces.force == 0.0)
    kept = pieces.force > 0.0
    if len(alone):
        kept[alone[pieces.torque[alone].argmax()]] = True
    return pieces.take(kept)


def drop_inner_pieces(pieces: PathForces) -> PathForces:
    """Return the pieces without those inside the hull of other pieces with at least as large a force.

    Only pieces with the same ratio of torque to force and the same directions are compared; see the head of
    this module.
    """
    pushing = np.flatnonzero(pieces.force > 0.0)
    # Of one tool the torque is in proportion to the force.
    rows = np.round(np.stack([pieces.torque / np.where(pieces.force > 0.0, pieces.force, 1.0)] * 2), 9)[
        :, pushing
    ]
    kept = [np.flatnonzero(pieces.force == 0.0)]
    if pieces.spread >= EVERY:
        rows[1] = 0.0
    else:
        # Directions of parallel moves are equal but for the last digits. Along an arc they change.
        rows[1] = np.round(pieces.against[pushing] % (2 * pi), 12)
        kept.append(pushing[pieces.radius[pushing] > 0.0])
        straight = pieces.radius[pushing] == 0.0
        pushing, rows = pushing[straight], rows[:, straight]
    _, group, size = np.unique(rows, axis=1, return_inverse=True, return_counts=True)
    group = group.ravel()
    kept.append(pushing[size[group] <= 2])
    several = np.flatnonzero(size[group] > 2)
    order = several[np.lexsort((-pieces.force[pushing[several]], group[several]))]
    groups = np.split(pushing[order], np.flatnonzero(np.diff(group[order])) + 1)
    for members in groups if len(order) else ():
        kept.append(select_outer_pieces(pieces, members))
    chosen = np.concatenate(kept)
    # Neighbours are put in one block: by angle around the middle for points of hulls, else by their order in
    # the program.
    x, y = pieces.x[chosen], pieces.y[chosen]
    around = np.arctan2(y - y.sum() / max(len(y), 1), x - x.sum() / max(len(x), 1))
    return pieces.take(chosen[np.lexsort((chosen, around))] if pieces.spread >= EVERY else np.sort(chosen))


def select_outer_pieces(pieces: PathForces, order: IntArray) -> IntArray:
    """Return the indices of those pieces that are not inside the hull of pieces before them in ``order``.

    ``order`` are indices of one tool's pieces, by descending force.
    """
    levels = np.flatnonzero(np.diff(pieces.force[order])) + 1
    # Many forces are taken in runs that double in length.
    runs = levels if len(levels) <= MOST_LEVELS else FIRST << np.arange(24)
    is_point = pieces.radius == 0.0
    kept, hull = list[IntArray](), np.zeros((0, 2))
    for run in np.split(order, runs[runs < len(order)]):
        points, arcs = run[is_point[run]], run[~is_point[run]]
        alike = pieces.force[run[0]] == pieces.force[run[-1]]
        points = points[~are_inside_hull(hull, pieces.x[points], pieces.y[points])]
        arcs = arcs[~are_inside_hull(hull, *enclose_arcs(pieces, arcs)).all(axis=1)]
        points = select_hull_corners(pieces, points) if alike else points
        places = np.stack([pieces.x[points], pieces.y[points]], axis=1)
        hull = compute_hull(np.concatenate([hull, places, sample_arcs(pieces, arcs)]))
        if alike:
            # What is a corner of the hull is needed; an arc that has one is not inside.
            corners = {(x, y) for x, y in hull.tolist()}
            corner = np.array([place in corners for place in map(tuple, places.tolist())], np.bool_)
            points = points[corner | ~are_inside_hull(hull, *places.T)]
            arcs = arcs[~are_inside_hull(hull, *enclose_arcs(pieces, arcs)).all(axis=1)]
        kept += [points, arcs]
    return np.concatenate([*kept, np.zeros(0, np.int64)])


def sample_arcs(pieces: PathForces, arcs: IntArray) -> Array:
    """Return 15 points on each of some arcs, given by index, all together (Q, 2) in mm."""
    share = np.linspace(0.0, 1.0, 17)[1:-1]
    angle = pieces.start[arcs][:, None] + pieces.sweep[arcs][:, None] * share
    far = pieces.radius[arcs][:, None]
    x, y = pieces.x[arcs][:, None] + far * np.cos(angle), pieces.y[arcs][:, None] + far * np.sin(angle)
    return np.stack([x.ravel(), y.ravel()], axis=1)


def enclose_arcs(pieces: PathForces, arcs: IntArray) -> tuple[Array, Array]:
    """Return x and y in mm of the six corners of a polygon around each arc, (Q, 6) each.

    Each of the Q arcs, given by index, must be half a turn or less. The corners are its ends and the points
    where tangents meet.
    """
    start, sweep, radius = pieces.start[arcs], pieces.sweep[arcs], pieces.radius[arcs]
    share = np.array([0.0, 1 / 8, 3 / 8, 5 / 8, 7 / 8, 1.0])
    angle = start[:, None] + sweep[:, None] * share
    far = radius[:, None] * np.ones(6)
    far[:, 1:5] /= np.cos(sweep / 8)[:, None]
    return pieces.x[arcs][:, None] + far * np.cos(angle), pieces.y[arcs][:, None] + far * np.sin(angle)


def select_hull_corners(pieces: PathForces, members: IntArray) -> IntArray:
    """Return those of the indices ``members`` whose points are corners of the convex hull of all of them.

    Of coincident points the first is returned.
    """
    if len(members) <= 2:
        return members
    points = np.stack([pieces.x[members], pieces.y[members]], axis=1)
    corners = {(x, y) for x, y in compute_hull(points).tolist()}
    first: dict[tuple[float, float], int] = {}
    for number, (x, y) in enumerate(points.tolist()):
        if (x, y) in corners:
            first.setdefault((x, y), number)
    return members[sorted(first.values())]


def compute_hull(points: Array) -> Array:
    """Return the corners (H, 2) of the convex hull of points (N, 2), counter-clockwise."""
    if len(points) > FIRST:
        angle = np.arange(64) * (2 * pi / 64)
        ways = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        around = compute_hull(points[np.unique([int((points @ way).argmax()) for way in ways])])
        points = np.concatenate([around, points[~are_inside_hull(around, *points.T)]])
    return np.array(compute_convex_hull(map(tuple, points.tolist()))).reshape(-1, 2)


def are_inside_hull(hull: Array, x: Array, y: Array) -> Mask:
    """Return a mask (...): True for points inside or on a convex
    hull with corners (H, 2); all False if H < 3.
    """
    if len(hull) < 3:
        return np.zeros(x.shape, np.bool_)
    ordered = sorted(map(tuple, hull.tolist()))
    low, high = np.array(compute_half_hull(ordered)), np.array(compute_half_hull(ordered[::-1]))[::-1]
    # Upright sides are left out, as ``interp`` needs different x: the last point of the lower chain, the
    # first of the upper.
    low, high = low[: len(low) - (low[-1, 0] == low[-2, 0])], high[int(high[0, 0] == high[1, 0]) :]
    within = (x >= ordered[0][0]) & (x <= ordered[-1][0])
    return np.asarray(within & (y >= np.interp(x, *low.T)) & (y <= np.interp(x, *high.T)))
