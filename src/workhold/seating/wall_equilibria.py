"""Equilibria between a straight wall, a locator and a clamp's tip.

The wall is along x or y. If a piece of the part's hull lies on it, the orientation determines one coordinate
of the part's place. The locator's contact determines the other coordinate, and the tip's contact the
separation. So a part that stands on one piece of its hull and touches all three has one degree of freedom. It
balances if the normals of locator, tip and wall meet in one point; there S is stationary over the
orientation. All such poses are isolated (``kernels.seating.wall_equilibria``). Four contacts are in closed
form, or roots of polynomials (``kernels.seating.tip_in_pocket``).

Reference: E. Rimon and J. W. Burdick, "Mobility of bodies in contact, part I", IEEE Transactions on Robotics
and Automation 14 (1998), where three frictionless contacts balance on concurrent normals.
"""

from __future__ import annotations

from functools import cached_property
from math import acos, atan2, ceil, cos, hypot, pi, sin, tau

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.base.tables import CURVE_INTEGERS, CURVE_REALS
from workhold.kernels.seating.candidates import write_fourths
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    DEPTH,
    MOTION,
    PAIR_LENGTH,
    PEG,
    PIECE,
    PLACE_X,
    PLACE_Y,
    SECOND,
    THETA,
    HeldPart,
)
from workhold.kernels.seating.tip_in_pocket import write_tip_in_pocket
from workhold.kernels.seating.turning import SHAPE_LENGTH
from workhold.kernels.seating.wall_equilibria import LOCATOR, TIP, StandingPart, write_equilibria
from workhold.kernels.seating.wall_equilibria import ON_WALL as FIRST_ON_WALL
from workhold.seating.closing import fill_rows, make_candidate
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.part_features import HullSide
from workhold.seating.pattern import Pattern

__all__ = ["LOCATOR", "ON_WALL", "TIP", "WallEquilibria", "find_wall_candidates"]

Array = NDArray[np.float64]
# The first and the second contact with the wall, beside the two pegs of a pattern.
ON_WALL = FIRST_ON_WALL, FIRST_ON_WALL + 1
# Radians by which runs of neighbouring pieces overlap or are apart; mm by which places of one point differ.
BESIDE, SAME_PLACE = 1e-9, 1e-9
# Orientations that one polynomial is zero at.
MOST_ZEROS = 64
Contact = tuple[int, int]


@define(frozen=True, eq=False)
class WallEquilibria:
    """The equilibria of a part between a straight wall, a locator and a clamp's tip.

    Parameters
    ----------
    boundary, pattern : boundary of the part, and pegs: the first peg is the locator, the second the tip.
    """

    boundary: ObstacleBoundary
    pattern: Pattern

    @property
    def half_plane(self) -> tuple[float, float, float]:
        """The wall as (x, y, coordinate): the unit vector from the wall to the part, and the wall's
        coordinate along it in mm.
        """
        assert self.pattern.half_plane is not None
        return self.pattern.half_plane

    @property
    def runs_along_y(self) -> bool:
        """Whether the wall runs along y, perpendicular to the tip's travel."""
        return self.half_plane[0] != 0.0

    @property
    def sides(self) -> list[HullSide]:
        """The part's hull edges, in ascending order of their angles."""
        return self.boundary.hull.sides

    def compute_outward_direction(self) -> float:
        """Return the direction in radians from the part into the wall."""
        return atan2(-self.half_plane[1], -self.half_plane[0])

    def find_resting_place(self, piece: int, theta: float) -> float:
        """Return the coordinate in mm, perpendicular to the wall, of the centre of a part that stands on the
        wall.

        The part stands on the hull piece with the index ``piece`` and is turned by ``theta`` (radians). The
        coordinate is x for an upright wall, y for a wall along x.
        """
        ux, uy, off = self.half_plane
        x, y, radius = self.boundary.hull.rows[piece, :3].tolist()
        c, s = cos(theta), sin(theta)
        return float((ux + uy) * (off + radius) - (c * x - s * y if self.runs_along_y else s * x + c * y))

    @cached_property
    def runs(self) -> list[tuple[int, float, float]]:
        """The ranges of orientations in which the part stands on one hull piece: (piece, first, last), in
        radians.

        Ranges overlap slightly at orientations where the part rolls from one piece to the next, so that none
        is missed. They end slightly before orientations in which the part stands on a hull edge, because the
        edge's other end touches there too.
        """
        edges = np.array([side.angle for side in self.sides])
        angles = np.sort(np.concatenate([edges, self.boundary.hull.limits]))
        if not len(angles):
            # A disc stands on its one arc in every orientation.
            return [(k, 0.0, tau) for k in range(len(self.boundary.hull.rows))]
        apart = np.abs((angles[:, None] - edges + pi) % tau - pi).min(axis=1, initial=pi)
        over, ends = np.where(apart < 2.0 * BESIDE, -BESIDE, BESIDE), np.append(angles, angles[0] + tau)
        pieces = self.boundary.hull.compute_reach((ends[1:] + ends[:-1]) / 2.0).argmax(axis=1)
        # The part's normal on the wall turns with the part.
        lows, highs = (
            self.compute_outward_direction() - ends[1:] - np.roll(over, -1),
            self.compute_outward_direction() - ends[:-1] + over,
        )
        runs = zip(pieces.tolist(), lows.tolist(), highs.tolist(), ends[1:] - ends[:-1], strict=True)
        return [(piece, low, high) for piece, low, high, width in runs if width > 4.0 * BESIDE]

    @cached_property
    def standing_part(self) -> StandingPart:
        """The part on the wall, in the form that the kernels take."""
        boundary, pegs = self.boundary, np.array(self.pattern.pegs)
        runs = np.array(self.runs, dtype=np.float64).reshape(-1, 3)
        return StandingPart(
            np.array(boundary.rows),
            boundary.discs,
            boundary.parts,
            np.array(boundary.hull.rows),
            runs,
            pegs,
            np.array(self.half_plane),
        )

    def make_held_part(self, pegs: Array) -> HeldPart:
        """Return the part and pegs at places (2, 2), without two-contact curves, in the form that the kernels
        take.
        """
        none = np.zeros((0, PAIR_LENGTH)), np.zeros((0, CURVE_INTEGERS), np.int64), np.zeros((0, CURVE_REALS))
        return HeldPart(*none, self.standing_part.rows, pegs, self.pattern.right, self.boundary.parts)

    def make_wall_contact(self, piece: int, second: bool = False) -> Contact:
        """Return the contact of a hull piece with the wall, as numbers (peg, piece) for a candidate.

        A candidate can have two such contacts; ``second`` selects which of the two this is.
        """
        return ON_WALL[second], len(self.boundary.rows) + piece

    def add_tip_contacts(self, fixed: Array) -> Array:
        """Return candidates (M, 24) with four contacts: each in ``fixed`` (N, 24), with each piece that the
        tip can touch.

        The three contacts of a candidate in ``fixed`` fix the part's pose; the tip's contact fixes the
        separation. A candidate is a configuration with contacts and forces that may be an equilibrium, see
        ``kernels.seating.columns``.
        """
        return fill_rows(
            CANDIDATE_LENGTH, 64, write_fourths, fixed, 0, self.make_held_part(self.standing_part.pegs)
        )

    def add_locator_contacts(self, fixed: Array) -> Array:
        """Return candidates (M, 24) with one more contact: each in ``fixed`` (N, 24), with each piece that
        the locator can touch.

        A part in ``fixed`` can slide along the wall, and the locator's contact stops it. This contact is
        written before the others, and the separation is adjusted. A candidate is a configuration with
        contacts and forces that may be an equilibrium, see ``kernels.seating.columns``.
        """
        fixed, pegs = fixed.copy(), self.standing_part.pegs
        if self.runs_along_y:
            # Seen a quarter turn further, where the wall is level.
            fixed[:, THETA] += pi / 2.0
            fixed[:, PLACE_Y], fixed[:, PLACE_X] = fixed[:, PLACE_X].copy(), 0.0
            pegs = np.stack([-pegs[:, 1], pegs[:, 0]], axis=1)
        met = fill_rows(CANDIDATE_LENGTH, 64, write_fourths, fixed, 1, self.make_held_part(pegs))
        if self.runs_along_y:
            met[:, THETA] -= pi / 2.0
            met[:, PLACE_X], met[:, PLACE_Y] = met[:, PLACE_Y].copy(), -met[:, PLACE_X]
        for first in (PEG, PIECE):
            met[:, first : first + 4] = np.roll(met[:, first : first + 4], 1, axis=1)
        return met

    def find_flush(self) -> Array:
        """Return candidates (N, 24) with a hull edge flat on the wall, which is two contacts.

        The other two contacts are (a) those of the locator and the tip, or (b) two of the tip in a pocket. A
        candidate is a configuration with contacts and forces that may be an equilibrium, see
        ``kernels.seating.columns``.
        """
        fixed, out = [], []
        for side in self.sides:
            theta = self.compute_outward_direction() - side.angle
            ends, known = (
                [self.make_wall_contact(side.pieces[0]), self.make_wall_contact(side.pieces[1], True)],
                self.find_resting_place(side.pieces[0], theta),
            )
            fixed.append(
                make_candidate((theta, *((known, 0.0) if self.runs_along_y else (0.0, known)), 0.0), ends)
            )
            for ahead, up, held in self.list_tip_pockets(theta) if self.runs_along_y else ():
                place = known, float(self.pattern.pegs[TIP, 1]) - up
                out.append(
                    make_candidate((theta, *place, known + ahead - self.pattern.pegs[TIP, 0]), ends + held)
                )
        return np.concatenate(
            [self.add_tip_contacts(self.add_locator_contacts(stack_candidates(fixed))), stack_candidates(out)]
        )

    def list_tip_pockets(self, theta: float) -> list[tuple[float, float, list[Contact]]]:
        """Return for each pocket that the tip can touch (x, y, contacts).

        (x, y) is the pocket's place in mm relative to the part's centre, for a part turned by ``theta``
        (radians); the contacts are two pairs (peg, piece).
        """
        c, s, out = cos(theta), sin(theta), []
        for (x, y), pieces in zip(*self.list_pockets(1), strict=True):
            out.append((c * x - s * y, s * x + c * y, [(TIP, piece) for piece in pieces.tolist()]))
        return out

    def list_pockets(self, jaw: int) -> tuple[Array, NDArray[np.int64]]:
        """Return the pockets that a peg can touch: (1) places (V, 2) on the part in mm, (2) indices of the
        pieces (V, 2).

        ``jaw`` is 0 for the locator, 1 for the tip.
        """
        first, end = self.boundary.parts[jaw]
        own = (self.boundary.pocket_pieces[:, 0] >= first) & (self.boundary.pocket_pieces[:, 0] < end)
        return np.ascontiguousarray(self.boundary.pockets[own, :2]), self.boundary.pocket_pieces[own]

    def find_locator_in_pocket(self) -> Array:
        """Return candidates (N, 24) with the locator in a pocket (two contacts), a hull piece on the wall,
        and the tip.

        A candidate is a configuration with contacts and forces that may be an equilibrium, see
        ``kernels.seating.columns``.
        """
        out = []
        ux, uy, off = self.half_plane
        lx, ly = self.pattern.pegs[LOCATOR].tolist()
        for (vx, vy), (one, two) in zip(*(values.tolist() for values in self.list_pockets(0)), strict=True):
            for piece, low, high in self.runs:
                x, y, radius = self.boundary.hull.rows[piece, :3].tolist()
                dx, dy = vx - x, vy - y
                size, level = hypot(dx, dy), lx * ux + ly * uy - off - radius
                if abs(level) >= size:
                    continue
                for turn in (1.0, -1.0):
                    theta = raise_by_whole_turns(
                        low, atan2(uy, ux) - atan2(dy, dx) + turn * acos(level / size)
                    )
                    if theta <= high:
                        c, s = cos(theta), sin(theta)
                        contacts = [(LOCATOR, one), (LOCATOR, two), self.make_wall_contact(piece)]
                        out.append(
                            make_candidate((theta, lx - c * vx + s * vy, ly - s * vx - c * vy, 0.0), contacts)
                        )
        return self.add_tip_contacts(stack_candidates(out))

    def find_tip_in_pocket(self) -> Array:
        """Return candidates (N, 24) with the tip in a pocket (two contacts), a hull piece on the wall, and
        the locator.

        On an upright wall, also candidates with three contacts, without the locator. A candidate is a
        configuration with contacts and forces that may be an equilibrium, see ``kernels.seating.columns``.
        """
        places, pieces = self.list_pockets(1)
        work = np.empty((DEPTH, 2)), np.empty((MOST_ZEROS, 2))
        found = fill_rows(
            CANDIDATE_LENGTH, 64, write_tip_in_pocket, self.standing_part, places, pieces, *work
        )
        if not self.runs_along_y:
            return self.add_locator_contacts(found)
        out = []
        for piece, low, high in self.runs:
            x, y = self.boundary.hull.rows[piece, :2].tolist()
            for (vx, vy), held in zip(places.tolist(), pieces.tolist(), strict=True):
                theta = raise_by_whole_turns(low, atan2(0.0, self.half_plane[0]) - atan2(vy - y, vx - x))
                if hypot(vx - x, vy - y) <= SAME_PLACE or theta > high:
                    continue
                c, s = cos(theta), sin(theta)
                ahead, place = (
                    c * vx - s * vy,
                    (self.find_resting_place(piece, theta), self.pattern.pegs[TIP, 1] - (s * vx + c * vy)),
                )
                contacts = [self.make_wall_contact(piece), *((TIP, k) for k in held)]
                row = make_candidate((theta, *place, place[0] + ahead - self.pattern.pegs[TIP, 0]), contacts)
                row[SECOND], row[MOTION], row[MOTION + 1], row[MOTION + 2] = -1.0, 1.0, s * x + c * y, -ahead
                out.append(row)
        return np.concatenate([found, stack_candidates(out)])

    def find_three_contacts(self) -> Array:
        """Return candidates (N, 24) with one contact each of wall, locator and tip, whose normals meet in one
        point.

        A candidate is a configuration with contacts and forces that may be an equilibrium, see
        ``kernels.seating.columns``.
        """
        work = np.empty((len(self.boundary.rows), SHAPE_LENGTH)), np.empty((DEPTH, 2))
        return fill_rows(CANDIDATE_LENGTH, 64, write_equilibria, self.standing_part, *work)

    def find_tip_against_wall(self) -> Array:
        """Return candidates (N, 24) in which the tip alone presses the part against the wall.

        The tip's normal must meet the wall where a hull piece or a hull edge touches it. There are none
        unless the tip pushes towards the wall. A candidate is a configuration with contacts and forces that
        may be an equilibrium, see ``kernels.seating.columns``.
        """
        if self.half_plane[0] <= 0.0:
            return stack_candidates([])
        out = []
        tx, ty = self.pattern.pegs[TIP].tolist()
        for number in range(*self.boundary.parts[1]):
            row = self.boundary.rows[number]
            is_arc = row[IS_ARC] != 0.0
            signed = row[SIGN] * row[RADIUS]
            for side in self.sides if is_arc else ():
                theta = self.compute_outward_direction() - side.angle
                c, s = cos(theta), sin(theta)
                place = self.find_resting_place(side.pieces[0], theta), ty - (s * row[X] + c * row[Y])
                contacts = [
                    (TIP, number),
                    self.make_wall_contact(side.pieces[0]),
                    self.make_wall_contact(side.pieces[1], True),
                ]
                one = make_candidate(
                    (theta, *place, place[0] + c * row[X] - s * row[Y] + signed - tx), contacts
                )
                one[SECOND], one[MOTION + 2] = -1.0 / signed, 1.0
                out.append(one)
            for piece, low, high in self.runs:
                hull = self.boundary.hull.rows[piece]
                dx, dy = row[X] - hull[0], row[Y] - hull[1]
                if is_arc and hypot(dx, dy) < SAME_PLACE:
                    continue
                # Normals along x: of an arc its centre is level with the hull's piece, ahead or behind.
                angles = (
                    [-atan2(dy, dx), pi - atan2(dy, dx)] if is_arc else [-atan2(-row[AXIS_X], row[AXIS_Y])]
                )
                for theta in (raise_by_whole_turns(low, angle) for angle in angles):
                    if theta > high:
                        continue
                    c, s = cos(theta), sin(theta)
                    place = self.find_resting_place(piece, theta), ty - (s * hull[0] + c * hull[1])
                    ahead = c * dx - s * dy + (signed if is_arc else 0.0)
                    separation = place[0] + c * hull[0] - s * hull[1] + ahead - tx
                    one = make_candidate(
                        (theta, *place, separation), [(TIP, number), self.make_wall_contact(piece)]
                    )
                    # Over the turn, and the rise of the tip above the piece: see ``compute_least_curvature``.
                    second, turn, rise = compute_least_curvature(ahead, signed if is_arc else None)
                    one[SECOND], one[MOTION] = second, turn
                    # The piece stays on the wall.
                    one[MOTION + 1] = turn * (s * hull[0] + c * hull[1])
                    one[MOTION + 2] = -turn * (c * hull[0] - s * hull[1]) - rise
                    out.append(one)
        return stack_candidates(out)


def compute_least_curvature(ahead: float, signed: float | None) -> tuple[float, float, float]:
    """Return the least second derivative of the separation S for a tip opposite a wall, and its direction
    (turn, rise).

    The variables are the turn f of the part and the rise e of the tip above the hull piece on the wall. The
    derivative is NaN if S falls in all directions.

    The tip is ahead of the piece's centre by d = ``ahead`` (mm). Two cases: (a) it touches an arc of signed
    radius r = ``signed`` (mm, positive where convex), and is ahead by (d - r) cos f + sqrt(r^2 - (e - (d - r)
    sin f)^2) after a turn and a rise; (b) it touches a line (``signed`` None), and is ahead by (d - e sin f)
    / cos f.
    """
    if signed is None:
        matrix = np.array([[ahead, -1.0], [-1.0, 0.0]])
    else:
        apart = ahead - signed
        matrix = np.array(
            [[-apart - apart * apart / signed, apart / signed], [apart / signed, -1.0 / signed]]
        )
    values, ways = np.linalg.eigh(matrix)
    return (float(values[0]) if values[1] > 0.0 else np.nan), float(ways[0, 0]), float(ways[1, 0])


def raise_by_whole_turns(low: float, theta: float) -> float:
    """Return the smallest angle in radians that is at least ``low`` and differs from ``theta`` by whole turns
    (2 pi).
    """
    return theta + tau * ceil((low - theta) / tau)


def stack_candidates(candidates: list[Array]) -> Array:
    """Return a list of candidates (24,) as an array (N, 24); (0, 24) for an empty list.

    A candidate is a configuration with contacts and forces that may be an equilibrium, see
    ``kernels.seating.columns``.
    """
    return np.array(candidates).reshape(-1, CANDIDATE_LENGTH)


def find_wall_candidates(boundary: ObstacleBoundary, pattern: Pattern) -> Array:
    """Return candidates (N, 24) of all equilibria in which a part touches the wall.

    The pattern's first peg is the locator, the second the tip. A candidate is a configuration with contacts
    and forces that may be an equilibrium, see ``kernels.seating.columns``.
    """
    wall = WallEquilibria(boundary, pattern)
    pockets = wall.find_locator_in_pocket(), wall.find_tip_in_pocket()
    return np.concatenate(
        [wall.find_flush(), *pockets, wall.find_three_contacts(), wall.find_tip_against_wall()]
    )
