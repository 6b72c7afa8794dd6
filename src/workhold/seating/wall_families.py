"""Loose equilibria on a fence: a part that slides along the wall under the tip, or a round one that turns on it."""

from __future__ import annotations

from itertools import product
from math import cos, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import PARALLEL, SAME_CENTER
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import CONTACTS, PEG, PIECE, Families
from workhold.seating.families import SHORTEST, SLIDE_STEPS, Finder, Way
from workhold.seating.fence import LOCATOR, ON_WALL, TIP, Fence
from workhold.seating.hull import HullSide
from workhold.seating.loose_ways import turning

__all__ = ["on_wall"]

Array = NDArray[np.float64]


def on_wall(finder: Finder) -> list[Families]:
    """All of them."""
    fence = Fence(finder.locus, finder.pattern)
    return sliding_on_wall(finder, fence) + turning_on_wall(finder, fence)


def sliding_on_wall(finder: Finder, fence: Fence) -> list[Families]:
    """A hull edge on the wall and the tip on a face parallel to it, between the ends of the edge."""
    if fence.wall[0] <= 0.0:
        return []
    out, (tx, ty) = [], finder.pattern.pegs[TIP].tolist()
    for side, number in product(fence.sides, finder.lines):
        row, theta = finder.rows[number], fence.outward() - side.angle
        c, s = cos(theta), sin(theta)
        # Its normal is x.
        nx, ny = c * row[AXIS_Y] + s * row[AXIS_X], s * row[AXIS_Y] - c * row[AXIS_X]
        if nx < 0.0 or abs(ny) > PARALLEL or not finder.locus.fits(1, number):
            continue
        known = fence.resting(side.pieces[0], theta)
        ends = sorted(float(s * x + c * y) for x, y in finder.locus.hull.rows[list(side.pieces), :2])
        middle = s * row[X] + c * row[Y]
        low = max(ty - ends[1], ty - middle - row[HALF_EXTENT])
        high = min(ty - ends[0], ty - middle + row[HALF_EXTENT])
        separation = known + c * row[X] - s * row[Y] - tx
        if high - low > SHORTEST and finder.pattern.reaches(separation, SHORTEST):
            every = np.ones(SLIDE_STEPS)
            configs = np.stack(
                [theta * every, known * every, np.linspace(low, high, SLIDE_STEPS), separation * every], axis=1
            )
            families = finder.cut(finder.free([Way(configs, [(TIP, number)], False, None)]))
            for candidate in families.rows:
                with_both_ends(candidate, fence, side)
            out.append(families)
    return out


def with_both_ends(row: Array, fence: Fence, side: HullSide) -> None:
    """Tell both ends of a hull edge on the wall, of which a candidate names one piece."""
    count = int(row[CONTACTS])
    pegs = row[PEG : PEG + count].tolist()
    row[PIECE + pegs.index(ON_WALL[0])] = fence.on(side.pieces[0])[1]
    if count < 4:
        row[PEG + count], row[PIECE + count] = fence.on(side.pieces[1], True)
        row[CONTACTS] = count + 1


def turning_on_wall(finder: Finder, fence: Fence) -> list[Families]:
    """Arcs of one centre on the wall and on the tip, and on the locator where the tip is not square to the wall."""
    out, (ux, uy, off) = list[Families](), fence.wall
    (lx, ly), (tx, ty) = finder.pattern.pegs[LOCATOR].tolist(), finder.pattern.pegs[TIP].tolist()
    hull = finder.locus.hull.rows
    for group, piece in product(finder.locus.concentric, range(len(hull))):
        first = finder.rows[group[0]]
        if hull[piece, 2] == 0.0 or np.hypot(*(first[[X, Y]] - hull[piece, :2])) > SAME_CENTER:
            continue
        known = (ux + uy) * (off + hull[piece, 2])
        for tip in (k for k in group if finder.locus.fits(1, k)):
            signed = float(finder.rows[tip, SIGN] * finder.rows[tip, RADIUS])
            if ux > 0.0:
                across = (0.0, 1.0) if signed > 0.0 else None
                ways = turning(finder.pattern, first, (known, ty), known + signed - tx, [(TIP, tip)], across)
                out.append(finder.cut(finder.free(ways)))
            for locator in (k for k in group if finder.locus.fits(0, k)):
                radius = float(finder.rows[locator, RADIUS])
                square = radius**2 - ((known - lx) if ux else (known - ly)) ** 2
                for turn in (1.0, -1.0) if square > 0.0 else ():
                    center = (known, ly + turn * sqrt(square)) if ux else (lx + turn * sqrt(square), known)
                    reach = signed**2 - (ty - center[1]) ** 2
                    if reach <= 0.0:
                        continue
                    # The tip's normal is forward.
                    separation = center[0] + float(finder.rows[tip, SIGN]) * sqrt(reach) - tx
                    pressed = presses(fence, finder, center, (lx, ly), (tx + separation, ty), (locator, tip))
                    if pressed:
                        contacts = [(LOCATOR, locator), (TIP, tip)]
                        out.append(
                            finder.cut(finder.free(turning(finder.pattern, first, center, separation, contacts, None)))
                        )
    return out


def presses(
    fence: Fence,
    finder: Finder,
    center: tuple[float, float],
    locator: tuple[float, float],
    tip: tuple[float, float],
    pieces: tuple[int, int],
) -> bool:
    """Whether wall, locator and tip all press a round part."""
    normals = [np.array(fence.wall[:2]) * -1.0]
    for at, piece in zip((locator, tip), pieces, strict=True):
        away = (np.array(at) - center) * finder.rows[piece, SIGN] / finder.rows[piece, RADIUS]
        normals.append(away)
    matrix = np.stack(normals[:2], axis=1)
    if abs(np.linalg.det(matrix)) < 1e-9 or normals[2][0] <= 0.0:
        return False
    return bool((np.linalg.solve(matrix, -normals[2]) > 1e-9).all())
