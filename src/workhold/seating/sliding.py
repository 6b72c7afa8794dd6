"""Equilibria of parts that slide on two pegs of one jaw, on parallel faces or equal arcs, until other pegs stop them."""

from __future__ import annotations

from functools import cached_property
from math import acos, atan2, cos, hypot, pi, sin, sqrt, tau

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.curves.columns import HEAD, TAIL
from workhold.kernels.seating.candidates import fourths
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CONTACTS,
    FIRST_PEG,
    KIND,
    MOTION,
    PEG,
    PIECE,
    PLACE_X,
    PLACE_Y,
    SECOND,
    SECOND_PEG,
    SEPARATION,
    SOURCE,
    THETA,
)
from workhold.kernels.seating.holdings import held_at
from workhold.seating.holdings import Holdings, Slide, filled
from workhold.seating.locus import Locus, contains
from workhold.seating.pattern import Pattern

__all__ = ["slid"]

Array = NDArray[np.float64]
# Rounding of parameters, in mm or radians; slopes below the second are level.
HAIR, LEVEL = 1e-12, 1e-12


@define(frozen=True, eq=False, slots=False)
class Track:
    """A slide as a curve: places of its first peg over the parameter.

    Parameters
    ----------
    slide : which.
    row : the piece that the first peg touches.
    """

    slide: Slide
    row: Array

    @cached_property
    def is_circle(self) -> bool:
        """Whether the part goes round rather than straight."""
        return bool(self.row[IS_ARC] != 0.0)

    @cached_property
    def up(self) -> tuple[float, float]:
        """The y axis of the vise in the part's frame."""
        return -sin(self.slide.psi), cos(self.slide.psi)

    @cached_property
    def middle(self) -> float:
        """Direction in radians of the middle of an arc."""
        return atan2(self.row[AXIS_Y], self.row[AXIS_X])

    def at(self, t: float) -> tuple[float, float]:
        """Place at a parameter."""
        row = self.row
        if self.is_circle:
            return row[X] + row[RADIUS] * cos(self.middle + t), row[Y] + row[RADIUS] * sin(self.middle + t)
        return row[X] + t * row[AXIS_X], row[Y] + t * row[AXIS_Y]

    def within(self, ts: list[float]) -> list[float]:
        """Those parameters that the slide has, on a circle up to whole turns."""
        if self.is_circle:
            ts = [(t + pi) % tau - pi + turn for t in ts for turn in (-tau, 0.0, tau)]
        return [t for t in ts if self.slide.low - HAIR <= t <= self.slide.high + HAIR]

    def crossing(self, nx: float, ny: float, level: float) -> list[float]:
        """Parameters at which n . u has a value, n a unit vector."""
        start = nx * self.row[X] + ny * self.row[Y]
        if self.is_circle:
            cosine = (level - start) / self.row[RADIUS]
            if abs(cosine) > 1.0:
                return []
            return self.within([atan2(ny, nx) - self.middle + side * acos(cosine) for side in (1.0, -1.0)])
        rise = nx * self.row[AXIS_X] + ny * self.row[AXIS_Y]
        return [] if abs(rise) < LEVEL else self.within([(level - start) / rise])

    def begun(self, t: float, pattern: Pattern, contacts: int) -> Array:
        """A candidate with the two contacts of the slide, its place that at separation 0."""
        c, s = cos(self.slide.psi), sin(self.slide.psi)
        x, y = self.at(t)
        row = np.zeros(CANDIDATE_LENGTH)
        peg = pattern.pegs[self.slide.first]
        row[THETA], row[CONTACTS] = -self.slide.psi, contacts
        row[PLACE_X], row[PLACE_Y] = peg[0] - (c * x + s * y), peg[1] - (c * y - s * x)
        row[PEG : PEG + 4] = self.slide.first, self.slide.second, -1, -1
        row[PIECE : PIECE + 4] = *self.slide.pieces, -1, -1
        return row


def slid(locus: Locus, pattern: Pattern, holdings: Holdings) -> list[Array]:
    """Candidates of all slides of a pattern."""
    out: list[Array] = []
    for slide in holdings.slides:
        track = Track(slide, locus.rows[slide.pieces[0]])
        out += [one for peg in other_jaw(pattern, slide) for one in three_contacts(track, locus, pattern, peg)]
        out += two_and_two(track, locus, pattern, holdings)
        out += three_and_one(track, locus, pattern, holdings)
    return out


def other_jaw(pattern: Pattern, slide: Slide) -> list[int]:
    """The pegs of the jaw that a slide is not of."""
    return [k for k in range(4) if pattern.right[k] != pattern.right[slide.first]]


def three_contacts(track: Track, locus: Locus, pattern: Pattern, peg: int) -> list[Array]:
    """Where a third peg of the other jaw has a parallel normal: on an arc or, of a part that goes round, on a line too."""
    out: list[Array] = []
    row, (ux, uy) = track.row, track.up
    above = pattern.pegs[peg, 1] - pattern.pegs[track.slide.first, 1]
    for number in range(*locus.parts[pattern.right[peg]]):
        piece = locus.rows[number]
        found: list[tuple[float, float, float]] = []
        curved = piece[IS_ARC] != 0.0
        if not (curved or track.is_circle):
            continue
        bend = piece[SIGN] * piece[RADIUS] if curved else 0.0
        for side in (1.0, -1.0):
            if not track.is_circle and curved:
                x = piece[X] + side * piece[RADIUS] * row[AXIS_Y]
                y = piece[Y] - side * piece[RADIUS] * row[AXIS_X]
                found += [(t, x, y) for t in track.crossing(ux, uy, ux * x + uy * y - above)]
            elif track.is_circle and not curved:
                for t in track.within([atan2(-side * piece[AXIS_X], side * piece[AXIS_Y]) - track.middle]):
                    x, y = track.at(t)
                    rise = ux * piece[AXIS_X] + uy * piece[AXIS_Y]
                    if abs(rise) > LEVEL:
                        along = (ux * (x - piece[X]) + uy * (y - piece[Y]) + above) / rise
                        found.append((t, piece[X] + along * piece[AXIS_X], piece[Y] + along * piece[AXIS_Y]))
            elif track.is_circle and abs(side * piece[RADIUS] - row[RADIUS]) > HAIR:
                level = (above - ux * (piece[X] - row[X]) - uy * (piece[Y] - row[Y])) / (
                    side * piece[RADIUS] - row[RADIUS]
                )
                for t in track.crossing(ux, uy, ux * row[X] + uy * row[Y] + row[RADIUS] * level):
                    ex, ey = cos(track.middle + t), sin(track.middle + t)
                    found.append((t, piece[X] + side * piece[RADIUS] * ex, piece[Y] + side * piece[RADIUS] * ey))
        # The part moves on a circle of one radius while the peg stays on one of the other: their sum tells the curvature.
        total = bend + (row[SIGN] * row[RADIUS] if track.is_circle else 0.0)
        for t, x, y in found:
            if contains(piece, x, y):
                one = track.begun(t, pattern, 3)
                one[PEG + 2], one[PIECE + 2], one[SECOND] = peg, number, -1.0 / total if abs(total) > HAIR else 0.0
                c, s = cos(track.slide.psi), sin(track.slide.psi)
                place_other(one, c * x + s * y, peg, pattern)
                angle = track.middle + t
                mx, my = (-sin(angle), cos(angle)) if track.is_circle else (row[AXIS_X], row[AXIS_Y])
                one[MOTION + 1], one[MOTION + 2] = c * mx + s * my, c * my - s * mx
                out.append(one)
    return out


def place_other(row: Array, along: float, peg: int, pattern: Pattern) -> None:
    """Write the separation at which a peg of the other jaw is at x ``along`` from the part's place, written for 0."""
    if pattern.right[peg] == 1:
        row[SEPARATION] = row[PLACE_X] + along - pattern.pegs[peg, 0]
    else:
        row[SEPARATION] = pattern.pegs[peg, 0] - (row[PLACE_X] + along)
        row[PLACE_X] += row[SEPARATION]


def two_and_two(track: Track, locus: Locus, pattern: Pattern, holdings: Holdings) -> list[Array]:
    """Four contacts: the height at which the other jaw holds the part at the slide's orientation."""
    slide, given = track.slide, holdings.given
    numbers = holdings.there(slide.psi, 1 - int(pattern.right[slide.first]))
    if not len(numbers):
        return []
    places = np.empty((len(numbers), 4))
    held_at(numbers, np.array([holdings.inside(int(k), slide.psi) for k in numbers]), given, places)
    c, s = cos(slide.psi), sin(slide.psi)
    out = []
    for number, (x, y, level, there) in zip(numbers, places, strict=True):
        holding = given.holdings[number]
        for t in track.crossing(*track.up, level + pattern.pegs[slide.first, 1]) if there else ():
            one = track.begun(t, pattern, 4)
            place_other(one, c * x + s * y, int(holding[FIRST_PEG]), pattern)
            source = int(holding[SOURCE])
            if holding[KIND] == 1.0:
                one[PEG + 2 : PEG + 4] = holding[FIRST_PEG]
                one[PIECE + 2 : PIECE + 4] = locus.pocket_pieces[source]
            else:
                one[PEG + 2 : PEG + 4] = holding[[FIRST_PEG, SECOND_PEG]]
                one[PIECE + 2 : PIECE + 4] = given.curves[source, [TAIL, HEAD]]
            out.append(one)
    return out


def three_and_one(track: Track, locus: Locus, pattern: Pattern, holdings: Holdings) -> list[Array]:
    """Four contacts: where another peg of the slide's own jaw stops it, and one of the other clamps."""
    slide, out = track.slide, list[Array]()
    jaw = int(pattern.right[slide.first])
    c, s = cos(slide.psi), sin(slide.psi)
    for third in range(4):
        if pattern.right[third] != jaw or third in (slide.first, slide.second):
            continue
        dx, dy = pattern.pegs[third] - pattern.pegs[slide.first]
        ox, oy = c * dx - s * dy, s * dx + c * dy
        for number in range(*locus.parts[jaw]):
            piece = locus.rows[number]
            for t in stopped(track, piece, ox, oy):
                x, y = track.at(t)
                if contains(piece, x + ox, y + oy):
                    fixed = track.begun(t, pattern, 3)
                    fixed[PEG + 2], fixed[PIECE + 2] = third, number
                    out += list(filled(CANDIDATE_LENGTH, 64, fourths, fixed, jaw, holdings.given))
    return out


def stopped(track: Track, piece: Array, ox: float, oy: float) -> list[float]:
    """Parameters at which a peg (ox, oy) from the first is on the carrier of a piece."""
    row = track.row
    if piece[IS_ARC] == 0.0:
        nx, ny = piece[AXIS_Y], -piece[AXIS_X]
        return track.crossing(nx, ny, nx * (piece[X] - ox) + ny * (piece[Y] - oy))
    gx, gy = piece[X] - ox - row[X], piece[Y] - oy - row[Y]
    if not track.is_circle:
        along, across = gx * row[AXIS_X] + gy * row[AXIS_Y], gx * row[AXIS_Y] - gy * row[AXIS_X]
        square = (piece[RADIUS] - across) * (piece[RADIUS] + across)
        return track.within([along + side * sqrt(square) for side in (1.0, -1.0)]) if square >= 0.0 else []
    size = hypot(gx, gy)
    if size < HAIR:
        return []
    cosine = (size * size + row[RADIUS] ** 2 - piece[RADIUS] ** 2) / (2.0 * size * row[RADIUS])
    if abs(cosine) > 1.0:
        return []
    return track.within([atan2(gy, gx) - track.middle + side * acos(cosine) for side in (1.0, -1.0)])
