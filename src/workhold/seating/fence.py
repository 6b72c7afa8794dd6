"""Equilibria on a fence: a straight wall, a locator and a clamp's tip.

The wall is along x or y. Where a piece of the part's hull lies on it, the orientation tells one coordinate of the part's
place; the locator on a piece tells the other, and the tip on a piece the separation. So a part that stands on one piece of
its hull and touches all three has one freedom, and balances where the normals of locator and tip and that of the wall go
through one point P: where S is stationary, as a function of the orientation.

That function is looked at in steps of the orientation, between hull edges; where it changes its sign it is solved.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property, partial
from math import acos, atan2, cos, hypot, pi, sin, tau

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CONTACTS,
    MOTION,
    PEG,
    PIECE,
    PLACE_X,
    SECOND,
    SEPARATION,
    THETA,
)
from workhold.kernels.seating.standing import BEFORE, CHANGE_LENGTH, OF_LOCATOR, OF_TIP, stationary
from workhold.seating.crossings import LEVEL, Crossing, crossing, off_piece, roots, solved
from workhold.seating.filled import filled
from workhold.seating.hull import HullSide
from workhold.seating.locus import Locus
from workhold.seating.pattern import Pattern

__all__ = ["LOCATOR", "ON_WALL", "TIP", "fence_candidates"]

Array = NDArray[np.float64]
# The pegs of a pattern on a fence, and the first and second contact with the wall.
LOCATOR, TIP, ON_WALL = 0, 1, (2, 3)
# Steps of a turn, and radians from a hull edge within which the step before it ends.
STEPS, BESIDE = 1440, 1e-9
# Radians to either side by which a derivative is told from two values.
DIFFERENCE = 1e-5
Contact = tuple[int, int]


@define(frozen=True, eq=False)
class Standing:
    """A part that touches wall, locator and tip, over orientations (N,) in which it can; see ``kernels.seating.standing``.

    Parameters
    ----------
    place : (2, N) of the part, in mm.
    separation : (N,) in mm.
    slope : (N,) the derivative of S, times normals that do not vanish where it does.
    steepness : (N,) those normals.
    center : (2, N) P, about which the part turns.
    """

    place: Array
    separation: Array
    slope: Array
    steepness: Array
    center: Array


@define(frozen=True, eq=False)
class Fence:
    """A part between a wall, a locator and a tip.

    Parameters
    ----------
    locus, pattern : of the part and the pegs.
    """

    locus: Locus
    pattern: Pattern

    @property
    def wall(self) -> tuple[float, float, float]:
        """Unit vector from the wall to the part, and how far along it the wall is."""
        assert self.pattern.wall is not None
        return self.pattern.wall

    @property
    def is_upright(self) -> bool:
        """Whether the wall is along y, square to the tip's way."""
        return self.wall[0] != 0.0

    @property
    def sides(self) -> list[HullSide]:
        """The part's hull edges."""
        return self.locus.hull.sides

    def branches(self, jaw: int) -> Iterator[tuple[int, float]]:
        """The pieces that the locator (0) or the tip (1) may touch, and the sides of an arc on which a line crosses it."""
        for number in range(*self.locus.parts[jaw]):
            for side in (1.0, -1.0) if self.locus.rows[number, IS_ARC] != 0.0 else (1.0,):
                yield number, side

    def outward(self) -> float:
        """Direction in radians of the wall's inward normal: that of the part's outward one on it."""
        return atan2(-self.wall[1], -self.wall[0])

    def resting(self, piece: int, theta: Array) -> Array:
        """The coordinate (N,) of the part's place square to the wall, in mm, while it stands on a piece of its hull."""
        ux, uy, off = self.wall
        row = self.locus.hull.rows[piece]
        c, s = np.cos(theta), np.sin(theta)
        across = c * row[0] - s * row[1] if self.is_upright else s * row[0] + c * row[1]
        return np.asarray((ux + uy) * (off + row[2]) - across)

    def center(self, piece: int, theta: Array, place: Array) -> Array:
        """Where (2, N) the centre of a piece of the hull is, in mm."""
        row, c, s = self.locus.hull.rows[piece], np.cos(theta), np.sin(theta)
        return np.stack([place[0] + c * row[0] - s * row[1], place[1] + s * row[0] + c * row[1]])

    def placed(self, piece: int, locator: tuple[int, float], theta: Array) -> tuple[Array, Crossing]:
        """The part's place (2, N) while it stands on a piece and the locator touches another, and how that touches."""
        (x, y), number = self.pattern.pegs[LOCATOR], locator[0]
        known, row = self.resting(piece, theta), self.locus.rows[number]
        if self.is_upright:
            at = crossing(row, locator[1], theta, x - known, True)
            return np.stack([known, y - at.along]), at
        at = crossing(row, locator[1], theta, y - known, False)
        return np.stack([x - at.along, known]), at

    def met(self, tip: tuple[int, float], theta: Array, place: Array) -> tuple[Array, Crossing]:
        """S (N,) at which the tip touches a piece of a part at places (2, N), and how."""
        x, y = self.pattern.pegs[TIP]
        at = crossing(self.locus.rows[tip[0]], tip[1], theta, y - place[1], False)
        return place[0] + at.along - x, at

    def standing(self, piece: int, locator: tuple[int, float], tip: tuple[int, float], theta: Array) -> Standing:
        """The part on a piece of its hull, with the locator and the tip on pieces."""
        place, one = self.placed(piece, locator, theta)
        separation, two = self.met(tip, theta, place)
        px, py = self.center(piece, theta, place)
        (lx, ly), (tx, ty) = self.pattern.pegs[LOCATOR], self.pattern.pegs[TIP]
        (ax, ay), (bx, by) = one.normal, two.normal
        with np.errstate(divide="ignore", invalid="ignore"):
            if self.is_upright:
                steep, cx, cy = ay, lx + (py - ly) * ax / ay, py
            else:
                steep, cx, cy = ax, px, ly + (px - lx) * ay / ax
            slope = (by * (tx + separation - cx) - bx * (ty - cy)) * steep
        return Standing(place, separation, slope, bx * steep, np.stack([cx, cy]))

    @cached_property
    def runs(self) -> list[tuple[int, Array]]:
        """Pieces of the hull, and orientations, between hull edges and ends of arcs, in which the part stands on them."""
        count = len(self.locus.hull.rows)
        angles = np.sort(np.concatenate([[side.angle for side in self.sides], self.locus.hull.limits]))
        if not len(angles):
            # A disc stands on its one arc in every orientation.
            return [(k, np.linspace(0.0, tau, STEPS + 1)) for k in range(count)]
        out = []
        for first, last in zip(angles, np.append(angles[1:], angles[0] + tau), strict=True):
            if last - first < 4.0 * BESIDE:
                continue
            steps = max(int((last - first) / tau * STEPS), 4)
            normals = np.linspace(first + BESIDE, last - BESIDE, steps + 1)
            piece = int(self.locus.hull.reach(normals[[steps // 2]])[0].argmax())
            # The part's normal on the wall turns with the part.
            out.append((piece, (self.outward() - normals)[::-1]))
        return out

    def begun(self, theta: float, place: Array, separation: float, contacts: list[Contact]) -> Array:
        """A candidate."""
        row = np.zeros(CANDIDATE_LENGTH)
        row[THETA], row[PLACE_X : PLACE_X + 2], row[SEPARATION] = theta, place, separation
        row[CONTACTS], row[PEG : PEG + 4], row[PIECE : PIECE + 4] = len(contacts), -1.0, -1.0
        for at, (peg, piece) in enumerate(contacts):
            row[PEG + at], row[PIECE + at] = peg, piece
        return row

    def on(self, piece: int, second: bool = False) -> Contact:
        """The contact of a piece of the hull with the wall."""
        return ON_WALL[second], len(self.locus.rows) + piece

    def flush(self) -> list[Array]:
        """Four contacts: a hull edge on the wall, and locator and tip, or the tip in a pocket."""
        out = []
        for side in self.sides:
            theta = np.array([self.outward() - side.angle])
            ends = [self.on(side.pieces[0]), self.on(side.pieces[1], True)]
            for locator in self.branches(0):
                place, at = self.placed(side.pieces[0], locator, theta)
                if at.there[0]:
                    out += self.with_tip(theta, place, [(LOCATOR, locator[0]), *ends])
            if self.is_upright:
                for v, (px, py) in self.pockets(1):
                    c, s = cos(theta[0]), sin(theta[0])
                    place = np.array(
                        [self.resting(side.pieces[0], theta)[0], self.pattern.pegs[TIP, 1] - (s * px + c * py)]
                    )
                    separation = place[0] + c * px - s * py - self.pattern.pegs[TIP, 0]
                    one, two = self.locus.pocket_pieces[v].tolist()
                    out.append(self.begun(theta[0], place, separation, [*ends, (TIP, one), (TIP, two)]))
        return out

    def with_tip(self, theta: Array, place: Array, contacts: list[Contact]) -> list[Array]:
        """Candidates of a part that three contacts fix, with each piece that the tip meets."""
        out = []
        for tip in self.branches(1):
            separation, at = self.met(tip, theta, place)
            if at.there[0]:
                out.append(self.begun(theta[0], place[:, 0], separation[0], [*contacts, (TIP, tip[0])]))
        return out

    def pockets(self, jaw: int) -> list[tuple[int, tuple[float, float]]]:
        """The pockets of the locator (0) or the tip (1), and their places on the part."""
        return [
            (v, (float(self.locus.pockets[v, 0]), float(self.locus.pockets[v, 1])))
            for v, (piece, _) in enumerate(self.locus.pocket_pieces.tolist())
            if self.locus.fits(jaw, piece)
        ]

    def locator_in_pocket(self) -> list[Array]:
        """Four contacts: the locator in a pocket, a piece of the hull on the wall, and the tip."""
        out = []
        ux, uy, off = self.wall
        for v, (vx, vy) in self.pockets(0):
            height = float(self.pattern.pegs[LOCATOR] @ [ux, uy]) - off
            for piece, thetas in self.runs:
                row = self.locus.hull.rows[piece]
                dx, dy = vx - row[0], vy - row[1]
                size, level = hypot(dx, dy), height - row[2]
                if abs(level) >= size:
                    continue
                for turn in (1.0, -1.0):
                    theta = within(atan2(uy, ux) - atan2(dy, dx) + turn * acos(level / size), thetas)
                    if theta > thetas[-1]:
                        continue
                    c, s = cos(theta), sin(theta)
                    place = self.pattern.pegs[LOCATOR] - [c * vx - s * vy, s * vx + c * vy]
                    one, two = self.locus.pocket_pieces[v].tolist()
                    contacts = [(LOCATOR, one), (LOCATOR, two), self.on(piece)]
                    out += self.with_tip(np.array([theta]), place[:, None], contacts)
        return out

    def tip_in_pocket(self) -> list[Array]:
        """Four contacts: the tip in a pocket, a piece of the hull on the wall, and the locator; and three where the wall
        alone is against the tip."""
        out = []
        ux, uy, _ = self.wall
        tx, ty = self.pattern.pegs[TIP]
        for v, at in self.pockets(1):
            held = [(TIP, int(piece)) for piece in self.locus.pocket_pieces[v]]
            for piece, thetas in self.runs:
                for number, side in self.branches(0):
                    for theta in roots(partial(self.unmet, piece, number, at), thetas):
                        every = np.array([theta])
                        place, _ = self.placed(piece, (number, side), every)
                        if self.is_upright:
                            place[1] = ty - (sin(theta) * at[0] + cos(theta) * at[1])
                        separation = place[0, 0] + cos(theta) * at[0] - sin(theta) * at[1] - tx
                        out.append(
                            self.begun(theta, place[:, 0], separation, [(LOCATOR, number), self.on(piece), *held])
                        )
                row = self.locus.hull.rows[piece]
                dx, dy = at[0] - row[0], at[1] - row[1]
                theta = within(atan2(uy, ux) - atan2(dy, dx), thetas)
                if self.is_upright and hypot(dx, dy) > LEVEL and theta <= thetas[-1]:
                    c, s = cos(theta), sin(theta)
                    place = np.array([self.resting(piece, np.array([theta]))[0], ty - (s * at[0] + c * at[1])])
                    one = self.begun(theta, place, place[0] + c * at[0] - s * at[1] - tx, [self.on(piece), *held])
                    one[SECOND], one[MOTION], one[MOTION + 2] = -1.0, 1.0, -(c * at[0] - s * at[1])
                    out.append(self.moving(one, piece))
        return out

    def unmet(self, piece: int, number: int, at: tuple[float, float], theta: Array) -> Array:
        """How far (N,) in mm the locator is from a piece, or the part from the height of the tip, while the part stands on a
        piece of its hull with the tip at a place on it."""
        up, known = np.sin(theta) * at[0] + np.cos(theta) * at[1], self.resting(piece, theta)
        height = self.pattern.pegs[TIP, 1]
        if not self.is_upright:
            return np.asarray(known + up - height)
        away = self.pattern.pegs[LOCATOR][:, None] - np.stack([known, height - up])
        return off_piece(self.locus.rows[number], theta, away)

    def moving(self, row: Array, piece: int) -> Array:
        """A candidate whose motion keeps a piece of the hull on the wall: the part's place square to it follows the turn."""
        theta = row[THETA]
        after, before = self.resting(piece, np.array([theta + DIFFERENCE, theta - DIFFERENCE]))
        row[MOTION + (1 if self.is_upright else 2)] = row[MOTION] * (after - before) / (2.0 * DIFFERENCE)
        return row

    def three_contacts(self) -> list[Array]:
        """A piece of the hull on the wall, and locator and tip, their normals through one point."""
        out = []
        locators, tips = list(self.branches(0)), list(self.branches(1))
        pegs, wall, rows = np.array(self.pattern.pegs), np.array(self.wall), np.array(self.locus.rows)
        branches, before = (np.array(locators), np.array(tips)), np.empty((len(locators) * len(tips), 2))
        for piece, thetas in self.runs:
            standing = np.ascontiguousarray(thetas), np.array(self.locus.hull.rows[piece]), wall, pegs, rows
            found = filled(CHANGE_LENGTH, 256, stationary, *standing, *branches, before).astype(np.int64)
            for i, j, k in found[np.lexsort((found[:, BEFORE], found[:, OF_TIP], found[:, OF_LOCATOR]))]:
                theta = solved(partial(self.slope, piece, locators[i], tips[j]), thetas[k], thetas[k + 1])
                out.append(self.balanced(piece, locators[i], tips[j], theta))
        return out

    def slope(self, piece: int, locator: tuple[int, float], tip: tuple[int, float], theta: Array) -> Array:
        """See :class:`Standing`."""
        return self.standing(piece, locator, tip, theta).slope

    def balanced(self, piece: int, locator: tuple[int, float], tip: tuple[int, float], theta: float) -> Array:
        """The candidate of three contacts in balance."""
        told = self.standing(piece, locator, tip, theta + np.array([0.0, DIFFERENCE, -DIFFERENCE]))
        contacts = [(LOCATOR, locator[0]), (TIP, tip[0]), self.on(piece)]
        row = self.begun(theta, told.place[:, 0], told.separation[0], contacts)
        slopes = told.slope / told.steepness
        row[SECOND] = (slopes[1] - slopes[2]) / (2.0 * DIFFERENCE)
        x, y = told.place[:, 0] - told.center[:, 0]
        row[MOTION : MOTION + 3] = 1.0, -y, x
        return row

    def against_wall(self) -> list[Array]:
        """The tip alone against the wall: a hull edge and an arc, or a piece of the hull and a piece, on one normal."""
        if self.wall[0] <= 0.0:
            return []
        out = []
        tx, ty = self.pattern.pegs[TIP]
        for number in range(*self.locus.parts[1]):
            row = self.locus.rows[number]
            is_arc = row[IS_ARC] != 0.0
            signed = row[SIGN] * row[RADIUS]
            for side in self.sides if is_arc else ():
                theta = self.outward() - side.angle
                c, s = cos(theta), sin(theta)
                place = np.array([self.resting(side.pieces[0], np.array([theta]))[0], ty - (s * row[X] + c * row[Y])])
                contacts = [(TIP, number), self.on(side.pieces[0]), self.on(side.pieces[1], True)]
                one = self.begun(theta, place, place[0] + c * row[X] - s * row[Y] + signed - tx, contacts)
                one[SECOND], one[MOTION + 2] = -1.0 / signed, 1.0
                out.append(one)
            for piece, thetas in self.runs:
                hull = self.locus.hull.rows[piece]
                dx, dy = row[X] - hull[0], row[Y] - hull[1]
                if is_arc and hypot(dx, dy) < LEVEL:
                    continue
                # Normals along x: of an arc its centre is level with the hull's piece, ahead or behind.
                angles = [-atan2(dy, dx), pi - atan2(dy, dx)] if is_arc else [-atan2(-row[AXIS_X], row[AXIS_Y])]
                for theta in (within(angle, thetas) for angle in angles):
                    if theta > thetas[-1]:
                        continue
                    c, s = cos(theta), sin(theta)
                    place = np.array([self.resting(piece, np.array([theta]))[0], ty - (s * hull[0] + c * hull[1])])
                    ahead = c * dx - s * dy + (signed if is_arc else 0.0)
                    separation = place[0] + c * hull[0] - s * hull[1] + ahead - tx
                    one = self.begun(theta, place, separation, [(TIP, number), self.on(piece)])
                    # Over the turn and the rise of the tip above the piece: see the text of ``curvature``.
                    second, turn, rise = curvature(ahead, signed if is_arc else None)
                    one[SECOND], one[MOTION] = second, turn
                    one[MOTION + 2] = -turn * (c * hull[0] - s * hull[1]) - rise
                    out.append(self.moving(one, piece))
        return out


def curvature(ahead: float, signed: float | None) -> tuple[float, float, float]:
    """The least second derivative of S, NaN where both are below 0, over the part's turn and the tip's rise above the piece
    on the wall, and the way that has it.

    The tip is ahead of the piece's centre by d, on an arc of signed radius r, or a line. At a turn f and a rise e it is
    ahead by (d - r) cos f + sqrt(r^2 - (e - (d - r) sin f)^2), or (d - e sin f) / cos f.
    """
    if signed is None:
        matrix = np.array([[ahead, -1.0], [-1.0, 0.0]])
    else:
        apart = ahead - signed
        matrix = np.array([[-apart - apart * apart / signed, apart / signed], [apart / signed, -1.0 / signed]])
    values, ways = np.linalg.eigh(matrix)
    return (float(values[0]) if values[1] > 0.0 else np.nan), float(ways[0, 0]), float(ways[1, 0])


def within(theta: float, thetas: Array) -> float:
    """An orientation moved by whole turns to the first that is not before a range."""
    return float(theta + tau * np.ceil((thetas[0] - theta) / tau))


def fence_candidates(locus: Locus, pattern: Pattern) -> list[Array]:
    """Candidates of all equilibria in which a part touches a wall, locator and tip being the first and the second peg."""
    fence = Fence(locus, pattern)
    return [
        *fence.flush(),
        *fence.locator_in_pocket(),
        *fence.tip_in_pocket(),
        *fence.three_contacts(),
        *fence.against_wall(),
    ]
