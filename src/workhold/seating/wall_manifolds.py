"""Equilibrium manifolds on a wall: a part that slides along it, or a round one that turns on it."""

from __future__ import annotations

from itertools import product
from math import cos, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import PARALLEL, SAME_CENTER
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import CONTACTS, PEG, PIECE, Manifolds
from workhold.seating.equilibrium_manifolds import ManifoldFinder
from workhold.seating.hull import HullSide
from workhold.seating.self_motions import SHORTEST, SLIDE_STEPS, SelfMotion, turning
from workhold.seating.wall_equilibria import LOCATOR, ON_WALL, TIP, WallEquilibria

__all__ = ["wall_manifolds"]

Array = NDArray[np.float64]


def wall_manifolds(finder: ManifoldFinder) -> list[Manifolds]:
    """All equilibrium manifolds on a wall."""
    wall = WallEquilibria(finder.boundary, finder.pattern)
    return sliding_on_wall(finder, wall) + turning_on_wall(finder, wall)


def sliding_on_wall(finder: ManifoldFinder, wall: WallEquilibria) -> list[Manifolds]:
    """A hull edge on the wall and the tip on a face parallel to it, between the ends of the edge."""
    if wall.half_plane[0] <= 0.0:
        return []
    out, (tx, ty) = [], finder.pattern.pegs[TIP].tolist()
    for side, number in product(wall.sides, finder.lines):
        row, theta = finder.rows[number], wall.outward() - side.angle
        c, s = cos(theta), sin(theta)
        # Its normal is x.
        nx, ny = c * row[AXIS_Y] + s * row[AXIS_X], s * row[AXIS_Y] - c * row[AXIS_X]
        if nx < 0.0 or abs(ny) > PARALLEL or not finder.boundary.fits(1, number):
            continue
        known = wall.resting(side.pieces[0], theta)
        ends = sorted(float(s * x + c * y) for x, y in finder.boundary.hull.rows[list(side.pieces), :2])
        middle = s * row[X] + c * row[Y]
        low = max(ty - ends[1], ty - middle - row[HALF_EXTENT])
        high = min(ty - ends[0], ty - middle + row[HALF_EXTENT])
        separation = known + c * row[X] - s * row[Y] - tx
        if high - low > SHORTEST and finder.pattern.reaches(separation, SHORTEST):
            every = np.ones(SLIDE_STEPS)
            configs = np.stack(
                [theta * every, known * every, np.linspace(low, high, SLIDE_STEPS), separation * every], axis=1
            )
            manifolds = finder.cut(finder.free([SelfMotion(configs, [(TIP, number)], False, None)]))
            for candidate in manifolds.rows:
                with_both_ends(candidate, wall, side)
            out.append(manifolds)
    return out


def with_both_ends(row: Array, wall: WallEquilibria, side: HullSide) -> None:
    """Names both ends of a hull edge on the wall, of which a candidate has one piece, in the candidate."""
    count = int(row[CONTACTS])
    pegs = row[PEG : PEG + count].tolist()
    row[PIECE + pegs.index(ON_WALL[0])] = wall.on(side.pieces[0])[1]
    if count < 4:
        row[PEG + count], row[PIECE + count] = wall.on(side.pieces[1], True)
        row[CONTACTS] = count + 1


def turning_on_wall(finder: ManifoldFinder, wall: WallEquilibria) -> list[Manifolds]:
    """Arcs of one centre on the wall and the tip, and on the locator if the tip is not square to the wall."""
    out, (ux, uy, off) = list[Manifolds](), wall.half_plane
    (lx, ly), (tx, ty) = finder.pattern.pegs[LOCATOR].tolist(), finder.pattern.pegs[TIP].tolist()
    hull = finder.boundary.hull.rows
    for group, piece in product(finder.boundary.concentric, range(len(hull))):
        first = finder.rows[group[0]]
        if hull[piece, 2] == 0.0 or np.hypot(*(first[[X, Y]] - hull[piece, :2])) > SAME_CENTER:
            continue
        known = (ux + uy) * (off + hull[piece, 2])
        for tip in (k for k in group if finder.boundary.fits(1, k)):
            signed = float(finder.rows[tip, SIGN] * finder.rows[tip, RADIUS])
            if ux > 0.0:
                across = (0.0, 1.0) if signed > 0.0 else None
                motions = turning(finder.pattern, first, (known, ty), known + signed - tx, [(TIP, tip)], across)
                out.append(finder.cut(finder.free(motions)))
            for locator in (k for k in group if finder.boundary.fits(0, k)):
                radius = float(finder.rows[locator, RADIUS])
                square = radius**2 - ((known - lx) if ux else (known - ly)) ** 2
                for turn in (1.0, -1.0) if square > 0.0 else ():
                    center = (known, ly + turn * sqrt(square)) if ux else (lx + turn * sqrt(square), known)
                    reach = signed**2 - (ty - center[1]) ** 2
                    if reach <= 0.0:
                        continue
                    # The tip's normal is forward.
                    separation = center[0] + float(finder.rows[tip, SIGN]) * sqrt(reach) - tx
                    pressed = presses(wall, finder, center, (lx, ly), (tx + separation, ty), (locator, tip))
                    if pressed:
                        contacts = [(LOCATOR, locator), (TIP, tip)]
                        out.append(
                            finder.cut(finder.free(turning(finder.pattern, first, center, separation, contacts, None)))
                        )
    return out


def presses(
    wall: WallEquilibria,
    finder: ManifoldFinder,
    center: tuple[float, float],
    locator: tuple[float, float],
    tip: tuple[float, float],
    pieces: tuple[int, int],
) -> bool:
    """Whether wall, locator and tip all press a round part."""
    normals = [np.array(wall.half_plane[:2]) * -1.0]
    for at, piece in zip((locator, tip), pieces, strict=True):
        away = (np.array(at) - center) * finder.rows[piece, SIGN] / finder.rows[piece, RADIUS]
        normals.append(away)
    matrix = np.stack(normals[:2], axis=1)
    if abs(np.linalg.det(matrix)) < 1e-9 or normals[2][0] <= 0.0:
        return False
    return bool((np.linalg.solve(matrix, -normals[2]) > 1e-9).all())
