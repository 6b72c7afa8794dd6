"""Where along a program the force of a tool is worst for something that depends on it linearly.

A contact's force is linear in the load, and so is the jaw force that keeps it: a g_x + b g_y + c m. A tool at
p presses with F in a direction phi at its periphery. Its moment is that of F at p and a torque between -T
and T. What is worst there is

    V = F ((a - p_y c) cos phi + (b + p_x c) sin phi) + T |c|.

*A straight move.* For one phi, V is linear in p, and so is greatest at an end. The directions are the same
all along the move. So the greatest over phi is greatest at an end, too. Each end is a point with a range.

*An arc*, p = m + r (cos alpha, sin alpha), run with the sense s = 1 (counter-clockwise) or -1. The direction
is delta from against the feed: phi = alpha + s pi / 2 + pi + delta, |delta| <= h. Let A and phi0 be size and
angle of (a - m_y c, b + m_x c). The moment of r turns with phi, and

    V = F (A cos(phi - phi0) - s c r cos delta) + T |c|.

On the rectangle of alpha and delta this is greatest at an end of alpha, which is a point as above. Or it is
where its derivative in alpha vanishes, sin(phi - phi0) = 0. Of the two solutions cos = 1 is the greater.
Left is -s c r cos delta, which is greatest at delta = 0 or at |delta| = h. So an arc has its two ends and at
most three places within it. With any direction, h = pi, there are two: V is F |c| times the distance of p
from the point where V is T |c|, greatest straight beyond the centre.

*Blocks.* Pieces are looked at in blocks. No point of a block exceeds V at the middle of its circle, with the
largest F and T, and F |c| times its radius more. Blocks that cannot hold the greatest value are passed over.

*Hulls.* For one range of directions V = F v(p), with v convex in p, as T is F times the tool's radius. Take
points of the path with as large a force and the same directions, and their hull. What lies inside it, or on
it, exceeds all of them nowhere but where V < 0. There not cutting is worse, V = 0, which counts along with
the path. An arc lies inside where a polygon around it does. So hulls are built, the largest forces first, and
what lies inside what came before is left out.

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
from workhold.model.moves import Stretches
from workhold.model.program import Program

__all__ = ["COLUMNS", "EVERY", "WITHIN", "PathForces", "WorstPlace", "list_all_pieces", "path_forces"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Mask = NDArray[np.bool_]

# Radians: half the range of directions about against the feed, and of any.
WITHIN, EVERY = pi / 3, pi
# Pieces of a block, and numbers that are worked out together.
BLOCK, AT_ONCE = 32, 1 << 20
# A bound is rounded by less than this part of it.
SURELY = 1e-12
COLUMNS = ("move", "force", "torque", "x", "y", "radius", "start", "sweep", "against")


@frozen(eq=False)
class WorstPlace:
    """Where each of N quantities is worst.

    Parameters
    ----------
    value : (N,) the greatest, 0 or more: the tool may do nothing as well.
    which, move : (N,) number of the function of each row that is greatest there, and of the program's move;
        -1 where it is worst to do nothing.
    """

    value: Array
    which: IntArray
    move: IntArray


@frozen(eq=False)
class PathForces:
    """The K pieces of a path that can be worst: points, and arcs without their ends.

    Parameters
    ----------
    move : (K,) number of the program's move, of several that do the same the first.
    force, torque : (K,) in N and N mm.
    x, y : (K,) the point, or the centre of the arc, about the point that moments are taken about, in mm.
    radius : (K,) of the arc; 0 of a point.
    start, sweep : (K,) angle of the arc's start, and by how much it turns, in radians.
    against : (K,) direction against the feed at a point, in radians.
    spread : half the range of directions about it, in radians; pi for any.
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
    blocks: Blocks = field(init=False)

    def __attrs_post_init__(self) -> None:
        object.__setattr__(self, "blocks", Blocks.of(self))

    def __len__(self) -> int:
        return len(self.move)

    def take(self, chosen: Mask | IntArray) -> PathForces:
        """Some of the pieces, in the order given."""
        return evolve(self, **{name: getattr(self, name)[chosen] for name in COLUMNS})

    def worst(self, functions: Array) -> WorstPlace:
        """Where the greatest of some functions of the load is greatest, and which of them it is.

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
            self.search(functions[part], found, first)
        return found

    def search(self, functions: Array, found: WorstPlace, first: int) -> None:
        """Looks for the worst of some rows of functions (N, J, 3), and writes it from row ``first`` on."""
        rows, each = functions.shape[:2]
        bounds = self.blocks.bounds(functions.reshape(-1, 3), self.spread).reshape(rows, -1)
        bounds *= 1.0 + SURELY
        blocks = bounds.shape[1] // each
        # The most promising block of each row first; then all that may still hold more.
        likely = bounds.argmax(axis=1)
        self.look(functions, np.arange(rows), likely, blocks, found, first)
        known = found.value[first : first + rows]
        bounds[np.arange(rows), likely] = -np.inf
        row, place = np.nonzero(bounds > known[:, None])
        # Those that promise more come first, so that ties go to the same place however many rows there are.
        for begin in range(0, len(row), step := max(AT_ONCE // BLOCK, 1)):
            part = slice(begin, begin + step)
            self.look(functions, row[part], place[part], blocks, found, first)

    def look(
        self, functions: Array, row: IntArray, place: IntArray, blocks: int, found: WorstPlace, first: int
    ) -> None:
        """Works out blocks (Q,) of rows (Q,) of functions, and keeps what is worse than what was found."""
        which, block = np.divmod(place, blocks)
        values, piece = self.blocks.values(self, functions[row, which], block)
        # Of one row the worst; of several that tie, the first function and the first move.
        order = np.lexsort((self.move[piece], which, -values, row))
        leading = order[np.concatenate([[True], np.diff(row[order]) > 0])] if len(order) else order
        at = first + row[leading]
        better = values[leading] > found.value[at]
        leading, at = leading[better], at[better]
        found.value[at], found.which[at] = values[leading], which[leading]
        found.move[at] = self.move[piece[leading]]

    def at(self, a: Array, b: Array, c: Array, piece: IntArray) -> Array:
        """V of pieces (...) for coefficients (...), minus infinite within an arc that holds no extreme."""
        force, torque, radius = self.force[piece], self.torque[piece], self.radius[piece]
        x, y = a - self.y[piece] * c, b + self.x[piece] * c
        size = np.hypot(x, y)
        straight = radius == 0.0
        if self.spread >= EVERY:
            largest = size
        else:
            largest = largest_within(x, y, size, self.against[piece], self.spread)
        out = np.where(straight, force * largest, -np.inf)
        # Only arcs are left.
        arc = np.nonzero(~straight)
        if len(arc[0]):
            out[arc] = force[arc] * self.within(x[arc], y[arc], size[arc], c[arc], piece[arc])
        return np.asarray(out + torque * np.abs(c))

    def within(self, x: Array, y: Array, size: Array, c: Array, piece: IntArray) -> Array:
        """The greatest value (Q,) for F = 1 and T = 0 within arcs."""
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


def largest_within(x: Array, y: Array, size: Array, middle: Array, half: Array | float) -> Array:
    """Largest x cos + y sin (...) over directions within half of the middle; ``size`` is that over all."""
    along = x * np.cos(middle) + y * np.sin(middle)
    across = np.abs(y * np.cos(middle) - x * np.sin(middle))
    at_end = along * np.cos(half) + across * np.sin(half)
    return np.where(along >= size * np.cos(half), size, at_end)


@frozen(eq=False)
class Blocks:
    """Runs of pieces, each in a circle; see :class:`PathForces`.

    Parameters
    ----------
    first : (B,) first piece of each.
    x, y, reach : (B,) circle that all of the block's points are in.
    force, torque : (B,) the largest.
    against, half : (B,) middle of the directions against the feed and half their range, in radians.
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
    def of(cls, pieces: PathForces) -> Blocks:
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

    def bounds(self, functions: Array, spread: float) -> Array:
        """What no piece of a block exceeds, (N, B), for functions (N, 3)."""
        a, b, c = (functions[:, k, None] for k in range(3))
        x, y = a - self.y * c, b + self.x * c
        largest = np.hypot(x, y)
        if spread < EVERY:
            narrow = largest_within(x, y, largest, self.against, self.half)
            largest = np.where(self.half < EVERY, narrow, largest)
        # A force that can be smaller helps where the value is negative.
        largest = np.maximum(largest + self.reach * np.abs(c), 0.0)
        return np.asarray(self.force * largest + self.torque * np.abs(c))

    def values(self, pieces: PathForces, functions: Array, block: IntArray) -> tuple[Array, IntArray]:
        """The greatest value in blocks (Q,) for functions (Q, 3), and at which piece."""
        piece = np.minimum(self.first[block][:, None] + np.arange(BLOCK), len(pieces) - 1)
        a, b, c = (np.broadcast_to(functions[:, k, None], piece.shape) for k in range(3))
        values = pieces.at(a, b, c, piece)
        best = values.argmax(axis=1)
        rows = np.arange(len(block))
        return values[rows, best], piece[rows, best]


# Points of the first run and of a first hull, and forces that are taken by themselves.
FIRST, MOST_LEVELS = 256, 64


@lru_cache(maxsize=8)
def path_forces(program: Program, center: tuple[float, float]) -> PathForces:
    """The pieces of a program that can be worst, about a point in mm; none without forces."""
    pieces = list_all_pieces(program, center)
    return drop_inner_pieces(drop_lesser_torques(pieces))


def list_all_pieces(program: Program, center: tuple[float, float]) -> PathForces:
    """Both ends of every stretch with a force, and the insides of arcs."""
    forces = program.forces
    stretches = Stretches((), (), ()) if forces is None else forces.stretches
    does, moves = stretches.move, program.moves.cut_to(stretches)
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
    """The pieces, of those that have a torque alone only the first with the largest."""
    alone = np.flatnonzero(pieces.force == 0.0)
    kept = pieces.force > 0.0
    if len(alone):
        kept[alone[pieces.torque[alone].argmax()]] = True
    return pieces.take(kept)


def drop_inner_pieces(pieces: PathForces) -> PathForces:
    """The pieces without those that lie inside the hull of others as strong, see the head of this module."""
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
    # Neighbours stand in one block: on the hull by where they are, of others by when they come.
    x, y = pieces.x[chosen], pieces.y[chosen]
    around = np.arctan2(y - y.sum() / max(len(y), 1), x - x.sum() / max(len(x), 1))
    return pieces.take(chosen[np.lexsort((chosen, around))] if pieces.spread >= EVERY else np.sort(chosen))


def select_outer_pieces(pieces: PathForces, order: IntArray) -> IntArray:
    """Pieces of one tool, the largest force first, without those inside the hull of what is before them."""
    levels = np.flatnonzero(np.diff(pieces.force[order])) + 1
    # Many forces are taken in runs that double in length.
    runs = levels if len(levels) <= MOST_LEVELS else FIRST << np.arange(24)
    is_point = pieces.radius == 0.0
    kept, hull = list[IntArray](), np.zeros((0, 2))
    for run in np.split(order, runs[runs < len(order)]):
        points, arcs = run[is_point[run]], run[~is_point[run]]
        alike = pieces.force[run[0]] == pieces.force[run[-1]]
        points = points[~inside(hull, pieces.x[points], pieces.y[points])]
        arcs = arcs[~inside(hull, *enclose_arcs(pieces, arcs)).all(axis=1)]
        points = corners_of(pieces, points) if alike else points
        places = np.stack([pieces.x[points], pieces.y[points]], axis=1)
        hull = hull_of(np.concatenate([hull, places, on_arcs(pieces, arcs)]))
        if alike:
            # What is a corner of the hull is needed; an arc that has one is not inside.
            corners = {(x, y) for x, y in hull.tolist()}
            corner = np.array([place in corners for place in map(tuple, places.tolist())], np.bool_)
            points = points[corner | ~inside(hull, *places.T)]
            arcs = arcs[~inside(hull, *enclose_arcs(pieces, arcs)).all(axis=1)]
        kept += [points, arcs]
    return np.concatenate([*kept, np.zeros(0, np.int64)])


def on_arcs(pieces: PathForces, arcs: IntArray) -> Array:
    """Points (Q, 2) of arcs."""
    share = np.linspace(0.0, 1.0, 17)[1:-1]
    angle = pieces.start[arcs][:, None] + pieces.sweep[arcs][:, None] * share
    far = pieces.radius[arcs][:, None]
    x, y = pieces.x[arcs][:, None] + far * np.cos(angle), pieces.y[arcs][:, None] + far * np.sin(angle)
    return np.stack([x.ravel(), y.ravel()], axis=1)


def enclose_arcs(pieces: PathForces, arcs: IntArray) -> tuple[Array, Array]:
    """Corners (Q, 6) of polygons around arcs of half a turn or less: their ends and where tangents meet."""
    start, sweep, radius = pieces.start[arcs], pieces.sweep[arcs], pieces.radius[arcs]
    share = np.array([0.0, 1 / 8, 3 / 8, 5 / 8, 7 / 8, 1.0])
    angle = start[:, None] + sweep[:, None] * share
    far = radius[:, None] * np.ones(6)
    far[:, 1:5] /= np.cos(sweep / 8)[:, None]
    return pieces.x[arcs][:, None] + far * np.cos(angle), pieces.y[arcs][:, None] + far * np.sin(angle)


def corners_of(pieces: PathForces, members: IntArray) -> IntArray:
    """The points that are corners of their hull; of several in one place the first."""
    if len(members) <= 2:
        return members
    points = np.stack([pieces.x[members], pieces.y[members]], axis=1)
    corners = {(x, y) for x, y in hull_of(points).tolist()}
    first: dict[tuple[float, float], int] = {}
    for number, (x, y) in enumerate(points.tolist()):
        if (x, y) in corners:
            first.setdefault((x, y), number)
    return members[sorted(first.values())]


def hull_of(points: Array) -> Array:
    """The corners (H, 2) of the hull of points."""
    if len(points) > FIRST:
        angle = np.arange(64) * (2 * pi / 64)
        ways = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        around = hull_of(points[np.unique([int((points @ way).argmax()) for way in ways])])
        points = np.concatenate([around, points[~inside(around, *points.T)]])
    return np.array(compute_convex_hull(map(tuple, points.tolist()))).reshape(-1, 2)


def inside(hull: Array, x: Array, y: Array) -> Mask:
    """Which points (...) lie inside a hull of corners (H, 2), or on its border."""
    if len(hull) < 3:
        return np.zeros(x.shape, np.bool_)
    ordered = sorted(map(tuple, hull.tolist()))
    low, high = np.array(compute_half_hull(ordered)), np.array(compute_half_hull(ordered[::-1]))[::-1]
    # Upright sides are ends of one of the two: the first of the upper one, the last of the lower one.
    low, high = low[: len(low) - (low[-1, 0] == low[-2, 0])], high[int(high[0, 0] == high[1, 0]) :]
    within = (x >= ordered[0][0]) & (x <= ordered[-1][0])
    return np.asarray(within & (y >= np.interp(x, *low.T)) & (y <= np.interp(x, *high.T)))
