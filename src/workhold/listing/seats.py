"""Seats: three locators, the faces they touch and the pose, with all the clamps that may push there.

The search of each direction finds contacts of three locators and one clamp. Those that share their locators and the pose are
one seat; a clamp that holds the part by itself is left out, for it needs no second.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from math import inf, tau
from typing import TYPE_CHECKING, Any

import numpy as np
from attrs import define, fields
from numpy.typing import NDArray

from workhold.contact.frame import QUARTERS
from workhold.contact.problem import ROUNDINGS, Problem
from workhold.conventions import FORCES_OFF, MOST_FORCE, NO_REACTION, SAME_PLACE, SAME_POSE
from workhold.fixels.directions import DIRECTIONS
from workhold.geometry.rotation import rotated
from workhold.kernels.base.feature import IS_ARC, RADIUS, X, Y
from workhold.kernels.contact.clamp_pairs import Clamps
from workhold.listing.canonical_form import Candidates, changes, clusters, packed
from workhold.listing.on_plate import clear_holes
from workhold.model.toolkit import Travel
from workhold.proof.deciding import BALLS
from workhold.statics.wrenches import outward_normals, wrenches

if TYPE_CHECKING:
    from workhold.proof.interval_newton import CandidateBox

__all__ = ["ALONG", "NAMES", "Seats", "box_beside", "seats_of"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

LOCATORS = slice(0, 3)
TIP = 3
# mm. Proven contacts are this near to where they are said to be.
BESIDE = 1e-8
NAMES = tuple(DIRECTIONS)
# Unit vectors along which the travel of clamps in each direction is counted.
ALONG = np.array([Travel(angle, 0.0, None).unit for angle in DIRECTIONS.values()])


@define(frozen=True, eq=False)
class Contacts:
    """M contacts of three locators and a clamp, on the plate; columns and rows count from the locators' lowest.

    Parameters
    ----------
    direction : (M,) number of the clamp's.
    feature, column, row : (M, 3) of the locators, in the order of columns and rows.
    theta : (M,) orientation of the workpiece on the plate in radians.
    point : (M, 3, 2) centres of the locators in the part's frame about its centre, in mm.
    clamp_feature, line : (M,) of the clamp.
    tip : (M, 2) place of the tip on the plate in mm.
    taken : (M, 3) forces of the locators per unit of the clamp's on its face.
    push : (M,) share of the clamp's own force that a unit on its face is.
    doubt : (M,) how far ``taken`` may be off.
    holes : (H, 2) in which clamps may be bolted, and which of them: (H,) numbers of contacts.
    hole_of : (H,) number of the contact.
    """

    direction: IntArray
    feature: IntArray
    column: IntArray
    row: IntArray
    theta: Array
    point: Array
    clamp_feature: IntArray
    line: IntArray
    tip: Array
    taken: Array
    push: Array
    doubt: Array
    holes: IntArray
    hole_of: IntArray


@define(frozen=True, eq=False)
class Seats:
    """S seats and their clamps.

    Parameters
    ----------
    feature, column, row : (S, 3) of the locators, in the order of columns and rows, which count from the lowest.
    theta : (S,) orientation of the workpiece on the plate in radians, in [0, 2 pi) up to a hair.
    point : (S, 3, 2) centres of the locators in the part's frame about its centre, in mm.
    clamps : all clamps that may push there, but those that hold the part alone.
    clamp_feature : (M,) of each clamp.
    """

    feature: IntArray
    column: IntArray
    row: IntArray
    theta: Array
    point: Array
    clamps: Clamps
    clamp_feature: IntArray

    def __len__(self) -> int:
        return len(self.theta)

    @property
    def spans(self) -> IntArray:
        """The largest columns and rows (S, 2) of the locators."""
        return np.stack([self.column.max(axis=1, initial=0), self.row.max(axis=1, initial=0)], axis=1)


def contacts_on_plate(c: Candidates, problem: Problem, direction: str) -> Contacts:
    """Contacts that the search of one direction proved, without clamps that hold the part alone, press a locator with more
    than ``MOST_FORCE`` times their own force, or have no hole."""
    frame = problem.frame
    rows = problem.rows[c.feature]
    wrench = wrenches(c.point, outward_normals(rows, c.point), problem.wrench_length)
    inverse = np.asarray(np.linalg.inv(np.swapaxes(wrench[:, LOCATORS], 1, 2)), np.float64)
    taken = -(inverse @ wrench[:, TIP, :, None])[..., 0]
    axis = np.array(frame.toolkit.moving_axis) * frame.toolkit.clamping
    turned = np.stack(rotated(axis[0], axis[1], -(c.theta + frame.quarters * np.pi / 2)), axis=1)
    push = (turned * wrench[:, TIP, :2]).sum(axis=1)
    taken, push, doubt = sharpened(c, taken, push, *doubts(inverse, taken, rows, push, problem), problem)
    left_out = (taken.min(axis=1, initial=np.inf) > NO_REACTION * (1.0 + np.abs(taken).sum(axis=1))) | presses_too_much(
        taken, push
    )
    column, row = frame.step_back(c.column[:, LOCATORS], c.row[:, LOCATORS])
    lowest = np.stack([column.min(axis=1, initial=1 << 30), row.min(axis=1, initial=1 << 30)], axis=1)
    column, row = column - lowest[:, :1], row - lowest[:, 1:]
    along, index, hole = clear_holes(c, problem, every=True)
    pitch = np.array(frame.toolkit.carriers[0].pitch)
    cosine, sine = QUARTERS[frame.quarters]
    height = c.row[:, TIP] * frame.lattice.pitch_y
    tip = np.stack([cosine * along - sine * height, sine * along + cosine * height], axis=1) - lowest * pitch
    across = 1 if frame.quarters % 2 == 0 else 0
    line = np.stack(frame.step_back(np.zeros(len(along), np.int64), c.row[:, TIP]), axis=1)[:, across]
    holes = np.stack(frame.step_back(hole, c.row[index, TIP]), axis=1) - lowest[index]
    kept = ~left_out
    kept[np.setdiff1d(np.arange(len(kept)), index)] = False
    number = np.cumsum(kept) - 1
    order = np.lexsort((row, column), axis=1)
    feature, column, row = (
        np.take_along_axis(values, order, axis=1)[kept] for values in (c.feature[:, LOCATORS], column, row)
    )
    point = np.take_along_axis(c.point[:, LOCATORS], order[..., None], axis=1)[kept]
    taken = np.take_along_axis(taken, order, axis=1)[kept]
    there = kept[index]
    return Contacts(
        direction=np.full(kept.sum(), NAMES.index(direction)),
        feature=feature,
        column=column,
        row=row,
        theta=(c.theta[kept] + frame.quarters * np.pi / 2 + SAME_POSE) % tau - SAME_POSE,
        point=point,
        clamp_feature=c.feature[kept, TIP],
        line=(line - lowest[:, across])[kept],
        tip=tip[kept],
        taken=taken,
        push=push[kept],
        doubt=doubt[kept],
        holes=holes[there],
        hole_of=number[index[there]],
    )


def sharpened(
    c: Candidates, taken: Array, push: Array, push_off: Array, doubt: Array, problem: Problem
) -> tuple[Array, Array, Array]:
    """Forces of the locators (N, 3), pushes and doubts (N,) of contacts, told by balls where doubles leave forces in doubt.

    Parameters
    ----------
    push_off, doubt : (N,) how far pushes and forces may be off.
    """
    from workhold.proof.clamp_reactions import sharp_reactions

    taken, push, doubt = taken.copy(), push.copy(), doubt.copy()
    # Per unit of the clamp's own force, as parts of one and the largest force.
    most = np.abs(taken).max(axis=1, initial=0.0)
    off = (doubt + most * push_off / push) / (push + most) + push_off / push
    chosen = np.flatnonzero(off > FORCES_OFF).tolist()
    with BALLS if chosen else nullcontext():
        for k in chosen:
            sharp = sharp_reactions(box_of(c, k, problem), problem.limits)
            if sharp is not None:
                taken[k], push[k], doubt[k] = sharp.taken, sharp.push, sharp.doubt
    return taken, push, doubt


def box_of(c: Candidates, number: int, problem: Problem) -> CandidateBox:
    """A contact of three locators and a clamp in the frame of the search."""
    column, row, lattice = c.column[number], c.row[number], problem.frame.lattice
    x, y = (column[LOCATORS] - column[0]) * lattice.pitch_x, (row - row[0]) * lattice.pitch_y
    separation = float(x.max() + c.gap[number])
    offsets = list(zip([*x.tolist(), 0.0], y.tolist(), strict=True))
    middle = -float(c.theta[number]), *c.point[number, 0].tolist(), separation
    return box_beside(c.feature[number].tolist(), offsets, middle, problem)


def box_beside(
    features: Sequence[int],
    offsets: Sequence[tuple[float, float]],
    middle: tuple[float, float, float, float],
    problem: Problem,
) -> CandidateBox:
    """A box about a proven contact of three locators and a clamp, as drawn, see ``proof.interval_newton.CandidateBox``."""
    from flint import ctx

    from workhold.proof.exact_rows import exact_rows
    from workhold.proof.interval_newton import PRECISIONS, CandidateBox

    frame, reach = problem.frame, (BESIDE / problem.wrench_length, BESIDE, BESIDE, 2 * BESIDE)
    radii = [frame.standing.peg_radius] * TIP + [frame.moving.peg_radius]
    with ctx.workprec(PRECISIONS[-1]):
        rows = exact_rows(features, radii, problem)
    return CandidateBox(rows, offsets, TIP, middle, reach)


def presses_too_much(taken: Array, push: Array) -> NDArray[np.bool_]:
    """Which clamps (N,) press a locator with more than ``MOST_FORCE`` times their own force.

    Parameters
    ----------
    taken : (N, 3) forces of the locators per unit of that on the clamp's face.
    push : (N,) force of the clamp per unit of that on its face.
    """
    return np.asarray(np.abs(taken).max(axis=1, initial=0.0) > MOST_FORCE * push)


def doubts(inverse: Array, taken: Array, rows: Array, push: Array, problem: Problem) -> tuple[Array, Array]:
    """How far clamps' pushes (N,) and forces of the locators (N, 3) may be off by the rounding of places and products.

    A polished place is off by the inverse of the contact equations times their rounding, and a tip along its line by that
    over its push; by so much over its radius a normal is turned, and by so much over L moments are off. First-order, and
    doubled.
    """
    size = float(np.abs(problem.rows[:, [X, Y, RADIUS]]).max()) + problem.wrench_length
    norm = np.abs(inverse).sum(axis=2).max(axis=1, initial=0.0)
    curved = 1.0 / np.where(rows[..., IS_ARC] != 0.0, rows[..., RADIUS], inf)
    off = 4.0 * norm * (ROUNDINGS * size + problem.backward_error)
    swing = 2.5 * off * (curved[:, TIP] / push + 1.0 / problem.wrench_length) + ROUNDINGS
    wrench = off * (2.5 * curved.max(axis=1) + 2.5 / problem.wrench_length) + ROUNDINGS
    at_tip = np.maximum(wrench, swing + 2.5 * off / (push * problem.wrench_length))
    return swing, 2.0 * norm * (at_tip + wrench * np.abs(taken).sum(axis=1))


def joined_contacts(parts: Sequence[Contacts]) -> Contacts:
    """The contacts of several directions as one."""
    names = [one.name for one in fields(Contacts) if one.name != "hole_of"]
    starts = np.cumsum([0, *(len(part.theta) for part in parts)])
    hole_of = np.concatenate([part.hole_of + start for part, start in zip(parts, starts, strict=False)])
    return Contacts(
        **{name: np.concatenate([getattr(part, name) for part in parts]) for name in names}, hole_of=hole_of
    )


def seats_of(parts: Sequence[tuple[Candidates, Problem, str]], within: tuple[float, float] | None = None) -> Seats:
    """The seats of the contacts that the searches of some directions proved.

    Parameters
    ----------
    parts : candidates of each direction, with its problem and name.
    within : orientations in radians, from and up to but without the second, of the seats that are wanted; others are left
        out, whole.
    """
    found = joined_contacts([contacts_on_plate(*part) for part in parts])
    columns = [(found.column, found.column.max(initial=0)), (found.row, found.row.max(initial=0))]
    words = packed(*columns)
    order = np.lexsort(words[::-1])
    place = found.point[:, 0] @ np.array([1.0, 0.7548776662])
    order, fresh = clusters(
        order, changes([word[order] for word in words]), (found.theta, SAME_POSE), (place, SAME_PLACE)
    )
    seat = np.empty(len(order), np.int64)
    seat[order] = np.cumsum(fresh) - 1
    count = int(fresh.sum())
    # A contact at a tangent joint is found on both features: the seat has those of the lowest numbers.
    by_seat = np.lexsort([*found.feature.T[::-1], seat])
    first = by_seat[np.concatenate([[True], np.diff(seat[by_seat]) > 0])] if count else by_seat
    theta = np.full(count, inf)
    np.minimum.at(theta, seat, found.theta)
    low, high = within or (-inf, inf)
    wanted = (theta >= low) & (theta < high)
    number = np.where(wanted, np.cumsum(wanted) - 1, -1)
    return Seats(
        feature=found.feature[first][wanted],
        column=found.column[first][wanted],
        row=found.row[first][wanted],
        theta=theta[wanted],
        point=found.point[first][wanted],
        **clamps_of(found, number[seat], int(wanted.sum()), parts[0][1]),
    )


def clamps_of(found: Contacts, seat: IntArray, count: int, problem: Problem) -> dict[str, Any]:
    """The clamps of seats, each once, in the order of seats, directions, lines and features; ``seat`` (M,) is -1 for
    contacts that are left out."""
    chosen = np.flatnonzero(seat >= 0)
    words = packed(
        (seat[chosen, None], max(count, 1)),
        (found.direction[chosen, None], len(NAMES)),
        (found.line[chosen, None] - found.line.min(initial=0), int(np.ptp(found.line)) if len(found.line) else 0),
    )
    along = np.where(found.direction < NAMES.index("-y"), found.tip[:, 0], found.tip[:, 1])[chosen]
    order = np.lexsort(words[::-1])
    order, fresh = clusters(order, changes([word[order] for word in words]), (along, SAME_PLACE))
    clamp = np.empty(len(order), np.int64)
    clamp[order] = np.cumsum(fresh) - 1
    # Of a tip at a joint the feature of the lowest number; then clamps by their features, and where they touch them.
    lowest = np.lexsort([found.clamp_feature[chosen], clamp])
    first = lowest[np.concatenate([[True], np.diff(clamp[lowest]) > 0])] if len(order) else lowest
    listed = np.lexsort([along[first], found.clamp_feature[chosen[first]], *(word[first] for word in words[::-1])])
    kept = chosen[first[listed]]
    rank = np.full(len(seat), -1)
    rank[kept] = np.arange(len(kept))
    there = np.flatnonzero(rank[found.hole_of] >= 0)
    there = there[np.argsort(rank[found.hole_of[there]], kind="stable")]
    clamp_of, hole = rank[found.hole_of[there]], found.holes[there]
    tip = found.tip[kept][clamp_of]
    place = hole * np.array(problem.toolkit.carriers[0].pitch) if problem.toolkit.moving.has_a_hole else tip
    ends = np.searchsorted(clamp_of, np.arange(len(kept) + 1))
    clamps = Clamps(
        starts=np.searchsorted(seat[kept], np.arange(count + 1)).astype(np.int64),
        integers=np.stack([found.direction[kept], found.line[kept], ends[:-1], ends[1:]], axis=1).astype(np.int64),
        reals=np.column_stack([found.taken[kept], found.push[kept], found.doubt[kept], found.tip[kept]]),
        holes=np.column_stack([hole, place, np.hypot(*(tip - place).T)]).astype(np.float64),
    )
    return {"clamps": clamps, "clamp_feature": found.clamp_feature[kept]}
