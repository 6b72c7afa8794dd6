"""Placing fixtures in the holes of the jaws (MODEL.md, "written out"), and which of them cannot be placed.

Pegs stand in the columns nearest the opening, moved outward only as far as the largest opening or a blocked hole demands,
first on the left jaw, then on the right. Rows are shifted so that the lowest is 0, or centred where the jaws have an end;
a blocked hole shifts them no farther than it must.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from attrs import define, evolve, fields
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import ANGLE_SLACK
from workhold.kernels.contact.rules import GAP_SLACK
from workhold.listing.canonical_form import Candidates
from workhold.model.result import FixtureTable, unknown_quality
from workhold.model.vise import Vise
from workhold.proof.deciding import is_left

__all__ = ["Arranged", "arranged", "placed"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@define(frozen=True, eq=False)
class Arranged:
    """N fixtures as they stand in the vise.

    Parameters
    ----------
    candidates : the fixtures, those of Type I turned half way round where only that fits.
    left, right : (N,) columns that each jaw's pegs stand outward from the opening.
    lift : (N,) rows that all pegs are shifted up.
    fits : (N,) whether there is such a place at all.
    """

    candidates: Candidates
    left: IntArray
    right: IntArray
    lift: IntArray
    fits: BoolArray

    def separation(self, vise: Vise) -> Array:
        """Jaw separations (N,) in mm."""
        return np.asarray(self.candidates.opening - (self.left + self.right) * vise.pitch[0])


def arranged(c: Candidates, problem: Problem) -> Arranged:
    """Find every fixture's place in the vise."""
    angles = problem.restrictions.angles
    found = placed_as_is(c, problem.vise)
    found = evolve(found, fits=found.fits & bodies_clear(c, problem.vise) & at_angle(c.theta, angles))
    if not (angles or problem.vise.blocked):
        return found
    # What does not fit may fit after the half turn that swaps the jaws; only Type I is written either way.
    again = np.flatnonzero(~found.fits & (c.kind == 1) & bodies_clear(c, problem.vise))
    turned = half_turned(c.take(again))
    other = placed_as_is(turned, problem.vise)
    good = other.fits & at_angle(turned.theta, angles)
    return with_rows(found, again[good], other, good)


def with_rows(one: Arranged, rows: IntArray, other: Arranged, chosen: BoolArray) -> Arranged:
    """Some rows of an arrangement replaced by the chosen ones of another."""
    names = [a.name for a in fields(Candidates)]
    candidates = {name: getattr(one.candidates, name).copy() for name in names}
    for name, values in candidates.items():
        values[rows] = getattr(other.candidates, name)[chosen]
    moves = {name: getattr(one, name).copy() for name in ("left", "right", "lift", "fits")}
    for name, values in moves.items():
        values[rows] = getattr(other, name)[chosen]
    return Arranged(Candidates(**candidates), **moves)


def half_turned(c: Candidates) -> Candidates:
    """Fixtures of Type I after half a turn of everything, which swaps the jaws."""
    column = c.column.copy()
    for jaw in (slice(0, 2), slice(2, 4)):
        column[:, jaw] = column[:, jaw].max(axis=1, keepdims=True, initial=0) - column[:, jaw]
    row = c.row.max(axis=1, keepdims=True, initial=0) - c.row
    backward = [np.ascontiguousarray(values[:, ::-1]) for values in (c.feature, column, row, c.point, c.null, c.force)]
    feature, column, row, point, null, force = backward
    return Candidates(c.kind, feature, column, row, c.theta + np.pi, point, c.opening, null, force)


def bodies_clear(c: Candidates, vise: Vise) -> BoolArray:
    """Which fixtures' pegs (N,) stand far enough apart for their bodies."""
    clear = np.ones(len(c.kind), np.bool_)
    if vise.body_radius == vise.peg_radius:
        # Neighbouring holes are far enough apart for the pegs themselves.
        return clear
    for a in range(4):
        for b in range(a):
            apart = np.hypot(*(c.point[:, a] - c.point[:, b]).T)
            clear &= apart >= 2.0 * vise.body_radius - GAP_SLACK
    return clear


def at_angle(theta: Array, angles: tuple[tuple[float, float], ...]) -> BoolArray:
    """Which orientations (N,) in radians lie in one of some ranges in degrees; in any when there are none."""
    if not angles:
        return np.ones(len(theta), np.bool_)
    degrees = np.degrees(theta)
    inside = np.zeros(len(theta), np.bool_)
    for low, high in angles:
        inside |= (degrees - low + ANGLE_SLACK) % 360.0 <= high - low + 2 * ANGLE_SLACK
    return inside


def placed_as_is(c: Candidates, vise: Vise) -> Arranged:
    """The place in the vise of fixtures in the form they have."""
    left = is_left(c.kind)
    free_left = vise.columns - 1 - np.where(left, c.column, 0).max(axis=1, initial=0)
    free_right = vise.columns - 1 - np.where(left, 0, c.column).max(axis=1, initial=0)
    least = np.zeros(len(c.kind), np.int64)
    if vise.max_opening is not None:
        too_far = c.opening - vise.max_opening - GAP_SLACK
        least = np.maximum(np.ceil(too_far / vise.pitch[0]).astype(np.int64), 0)
    most = np.minimum(free_left + free_right, np.floor((c.opening - vise.min_gap + GAP_SLACK) / vise.pitch[0]))
    spare = np.zeros(len(c.kind), np.int64)
    if vise.rows is not None:
        spare = vise.rows - 1 - c.row.max(axis=1, initial=0)
    fits = (least <= most) & (spare >= 0)
    move_left = np.minimum(least, free_left)
    found = Arranged(c, move_left, least - move_left, spare // 2, fits)
    if not vise.blocked or len(c.kind) == 0:
        return found
    return clear_of_blocked(found, vise, np.stack([least, most.astype(np.int64), free_left, free_right], axis=1), spare)


def clear_of_blocked(found: Arranged, vise: Vise, room: IntArray, spare: IntArray) -> Arranged:
    """Move fixtures on until no peg stands in a blocked hole.

    Parameters
    ----------
    room : (N, 4) fewest and most columns outward in all, and columns free on the left and on the right jaw.
    spare : (N,) rows free above the topmost peg, where the jaws have an end.
    """
    c = found.candidates
    left = is_left(c.kind)
    open_ = np.flatnonzero(found.fits)
    out = {name: getattr(found, name).copy() for name in ("left", "right", "lift")}
    fits = np.zeros(len(c.kind), np.bool_)
    for to_left, to_right in outward_moves(vise.columns):
        if len(open_) == 0:
            break
        least, most, free_left, free_right = room[open_].T
        total = to_left + to_right
        may = (least <= total) & (total <= most) & (to_left <= free_left) & (to_right <= free_right)
        for offset in offsets(vise, spare):
            lift = found.lift[open_] + offset
            if vise.rows is not None:
                inside = may & (lift >= 0) & (lift <= spare[open_])
            else:
                inside = may
            index, lift = open_[inside], lift[inside]
            shift = np.where(left[index], (room[index, 2] - to_left)[:, None], to_right)
            free = ~in_blocked(c.column[index] + shift, c.row[index] + lift[:, None], left[index], vise)
            good = index[free]
            out["left"][good], out["right"][good], out["lift"][good] = to_left, to_right, lift[free]
            fits[good] = True
            kept = ~fits[open_]
            open_, may = open_[kept], may[kept]
    return Arranged(c, out["left"], out["right"], out["lift"], fits)


def outward_moves(columns: int) -> Iterator[tuple[int, int]]:
    """Columns to move outward on the left and on the right jaw, the fewest in all first, then the most on the left."""
    for total in range(2 * columns - 1):
        for right in range(max(0, total - columns + 1), min(total, columns - 1) + 1):
            yield total - right, right


def offsets(vise: Vise, spare: IntArray) -> list[int]:
    """Row shifts beyond the one without blocked holes, in the order they are tried: the smallest first."""
    if vise.rows is None:
        return list(range(max((holes.row for holes in vise.blocked if holes.row is not None), default=-1) + 2))
    most = int(spare.max(initial=0))
    return sorted(range(-most, most + 1), key=lambda shift: (abs(shift), shift))


def in_blocked(column: IntArray, row: IntArray, left: BoolArray, vise: Vise) -> BoolArray:
    """Which fixtures (N,) have a peg in a blocked hole; column, row and left are (N, 4)."""
    hit = np.zeros(column.shape, np.bool_)
    for holes in vise.blocked:
        there = (left == (holes.jaw == "left")) & (column == holes.column)
        hit |= there if holes.row is None else there & (row == holes.row)
    return np.asarray(hit.any(axis=1))


def placed(c: Candidates, problem: Problem) -> FixtureTable:
    """Write candidates that fit out as holes of the jaws; of their quality only the closure margin is known yet."""
    found = arranged(c, problem)
    c, vise, center = found.candidates, problem.vise, problem.workpiece.center
    left = is_left(c.kind)
    free_left = vise.columns - 1 - np.where(left, c.column, 0).max(axis=1, initial=0)
    column = c.column + np.where(left, (free_left - found.left)[:, None], found.right[:, None])
    row = c.row + found.lift[:, None]
    cosine, sine = np.cos(c.theta), np.sin(c.theta)
    anchor = c.point[:, 0] + np.asarray(center)
    x = column[:, 0] * vise.pitch[0] - (cosine * anchor[:, 0] - sine * anchor[:, 1])
    y = row[:, 0] * vise.pitch[1] - (sine * anchor[:, 0] + cosine * anchor[:, 1])
    return FixtureTable(
        arrangement=(c.kind - 1).astype(np.int8),
        column=column.astype(np.int32),
        row=row.astype(np.int32),
        face=problem.faces[c.feature].astype(np.int32),
        theta=c.theta,
        position=np.stack([x, y], axis=1),
        jaw_separation=found.separation(vise),
        null_vector=c.null,
        force=c.force,
        quality=unknown_quality(c.null),
    )
