"""The pieces of a program's path at which its forces can be worst; see ``statics.path_forces``.

For one range of directions V = F v(p), with v convex in p, as T is F times the tool's radius. Take points of
the path with as large a force and the same directions, and their hull. What lies inside it, or on it, exceeds
all of them nowhere but where V < 0. There not cutting is worse, V = 0, which counts along with the path. An
arc lies inside where a polygon around it does. So hulls are built, the largest forces first, and what lies
inside what came before is left out.
"""

from __future__ import annotations

from functools import lru_cache
from math import pi

import numpy as np
from numpy.typing import NDArray

from workhold.geometry.hull import convex_hull, half_hull
from workhold.model.cutting_tool import ANY
from workhold.model.moves import Stretches
from workhold.model.program import Program
from workhold.statics.path_forces import EVERY, WITHIN, PathForces

__all__ = ["path_forces"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Mask = NDArray[np.bool_]

# Points of the first run and of a first hull, and forces that are taken by themselves.
FIRST, MOST_LEVELS = 256, 64


@lru_cache(maxsize=8)
def path_forces(program: Program, center: tuple[float, float]) -> PathForces:
    """The pieces of a program that can be worst, about a point in mm; none without forces."""
    pieces = all_pieces(program, center)
    return without_inner(without_torques(pieces))


def all_pieces(program: Program, center: tuple[float, float]) -> PathForces:
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


def without_torques(pieces: PathForces) -> PathForces:
    """The pieces, of those that have a torque alone only the first with the largest."""
    alone = np.flatnonzero(pieces.force == 0.0)
    kept = pieces.force > 0.0
    if len(alone):
        kept[alone[pieces.torque[alone].argmax()]] = True
    return pieces.take(kept)


def without_inner(pieces: PathForces) -> PathForces:
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
        kept.append(outer_of(pieces, members))
    chosen = np.concatenate(kept)
    # Neighbours stand in one block: on the hull by where they are, of others by when they come.
    x, y = pieces.x[chosen], pieces.y[chosen]
    around = np.arctan2(y - y.sum() / max(len(y), 1), x - x.sum() / max(len(x), 1))
    return pieces.take(chosen[np.lexsort((chosen, around))] if pieces.spread >= EVERY else np.sort(chosen))


def outer_of(pieces: PathForces, order: IntArray) -> IntArray:
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
        arcs = arcs[~inside(hull, *around_arcs(pieces, arcs)).all(axis=1)]
        points = corners_of(pieces, points) if alike else points
        places = np.stack([pieces.x[points], pieces.y[points]], axis=1)
        hull = hull_of(np.concatenate([hull, places, on_arcs(pieces, arcs)]))
        if alike:
            # What is a corner of the hull is needed; an arc that has one is not inside.
            corners = {(x, y) for x, y in hull.tolist()}
            corner = np.array([place in corners for place in map(tuple, places.tolist())], np.bool_)
            points = points[corner | ~inside(hull, *places.T)]
            arcs = arcs[~inside(hull, *around_arcs(pieces, arcs)).all(axis=1)]
        kept += [points, arcs]
    return np.concatenate([*kept, np.zeros(0, np.int64)])


def on_arcs(pieces: PathForces, arcs: IntArray) -> Array:
    """Points (Q, 2) of arcs."""
    share = np.linspace(0.0, 1.0, 17)[1:-1]
    angle = pieces.start[arcs][:, None] + pieces.sweep[arcs][:, None] * share
    far = pieces.radius[arcs][:, None]
    x, y = pieces.x[arcs][:, None] + far * np.cos(angle), pieces.y[arcs][:, None] + far * np.sin(angle)
    return np.stack([x.ravel(), y.ravel()], axis=1)


def around_arcs(pieces: PathForces, arcs: IntArray) -> tuple[Array, Array]:
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
    return np.array(convex_hull(map(tuple, points.tolist()))).reshape(-1, 2)


def inside(hull: Array, x: Array, y: Array) -> Mask:
    """Which points (...) lie inside a hull of corners (H, 2), or on its border."""
    if len(hull) < 3:
        return np.zeros(x.shape, np.bool_)
    ordered = sorted(map(tuple, hull.tolist()))
    low, high = np.array(half_hull(ordered)), np.array(half_hull(ordered[::-1]))[::-1]
    # Upright sides are ends of one of the two: the first of the upper one, the last of the lower one.
    low, high = low[: len(low) - (low[-1, 0] == low[-2, 0])], high[int(high[0, 0] == high[1, 0]) :]
    within = (x >= ordered[0][0]) & (x <= ordered[-1][0])
    return np.asarray(within & (y >= np.interp(x, *low.T)) & (y <= np.interp(x, *high.T)))
