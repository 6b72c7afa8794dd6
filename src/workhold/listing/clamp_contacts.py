"""Contacts of locators with one of two clamps: the locators' shares of its force, and the holes in which it
may be bolted.

The search of each direction proves contacts of locators, or of a wall and a locator, with a clamp. A clamp
that holds the part by itself is left out, because it needs no second one.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from math import inf, tau
from typing import TYPE_CHECKING

import numpy as np
from attrs import define, fields
from numpy.typing import NDArray

from workhold.contact.problem import QUARTERS, ROUNDINGS, Problem
from workhold.conventions import FORCES_OFF, MOST_FORCE, NO_REACTION, SAME_POSE
from workhold.geometry.symmetry import rotate_vectors
from workhold.kernels.base.feature import IS_ARC, RADIUS, X, Y
from workhold.listing.canonical_form import CandidateFixtures
from workhold.listing.clamp_placement import find_axis, find_direction_number
from workhold.listing.placing import LOCATOR_CONTACTS, TIP, make_clamp_placement
from workhold.listing.wall_fixtures import WallFixtures
from workhold.proof.deciding import BALLS
from workhold.statics.contact_matrix import compute_outward_normals, compute_wrenches

if TYPE_CHECKING:
    from workhold.proof.ball_contacts import CandidateBox

__all__ = ["ClampContacts", "make_box_beside", "make_contacts_of_candidates", "make_contacts_on_wall"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# mm. Proven contacts are this near to their computed places.
BESIDE = 1e-8


@define(frozen=True, eq=False)
class ClampContacts:
    """M contacts of L locators and one clamp.

    Columns and rows count from the locators' lowest ones; beside a wall, rows count from the wall.

    Parameters
    ----------
    direction : (M,) number of the clamp's direction in ``DIRECTION_NAMES``.
    feature, column, row : (M, L) feature touched and hole of each locator; sorted by column, then by row.
    face : (M, 3) numbers of the faces that locators and wall touch; faces on the wall come last.
    theta : (M,) orientation of the part on the plate in radians.
    point : (M, 2) a point of the part in the coordinates of its drawing, in mm.
    start : (M, 2) vector on the plate from that point to the first locator's centre.
    clamp_feature : (M,) index of the feature that the clamp touches.
    line : (M,) row or column along which the clamp moves.
    tip : (M, 2) centre of the tip on the plate in mm; beside a wall x counts from the locator.
    taken : (M, 3) forces of locators and wall, divided by the force at the clamp's face.
    push : (M,) force of the clamp along its line, divided by the force at the face that it touches.
    doubt : (M,) error bound of ``taken``.
    holes : (H, 2) column and row of every hole in which one of the clamps may be bolted.
    hole_of : (H,) index of the contact whose clamp may be bolted there.
    """

    direction: IntArray
    feature: IntArray
    column: IntArray
    row: IntArray
    face: IntArray
    theta: Array
    point: Array
    start: Array
    clamp_feature: IntArray
    line: IntArray
    tip: Array
    taken: Array
    push: Array
    doubt: Array
    holes: IntArray
    hole_of: IntArray

    @classmethod
    def concatenate(cls, parts: Sequence[ClampContacts]) -> ClampContacts:
        """Return the contacts of several objects in order, with ``hole_of`` renumbered."""
        names = [one.name for one in fields(ClampContacts) if one.name != "hole_of"]
        starts = np.cumsum([0, *(len(part.theta) for part in parts)])
        hole_of = np.concatenate([part.hole_of + start for part, start in zip(parts, starts, strict=False)])
        return cls(
            **{name: np.concatenate([getattr(part, name) for part in parts]) for name in names},
            hole_of=hole_of,
        )


def make_contacts_on_wall(found: WallFixtures, problem: Problem) -> ClampContacts:
    """Return, each once, the contacts with a wall and a locator whose clamp can be bolted and may be one of
    two.

    ``found`` are the proven pairs of locator and clamp of one direction.
    """
    found = found.list_each_once()
    found = found.take(may_hold_in_pair(found.null[:, :3], found.push))
    index, hole = found.make_clamp_placement(problem).choose_holes(problem, every=True)
    kept = np.unique(index)
    found, hole_of = found.take(kept), np.searchsorted(kept, index)
    flush, plate, line = problem.workpiece.flush, problem.toolkit.carriers[0], found.line[hole_of]
    height = found.row * plate.pitch[1] + plate.offset[1]
    return ClampContacts(
        direction=np.full(len(found), find_direction_number(problem.toolkit)),
        feature=found.feature[:, :1],
        column=np.zeros((len(found), 1), np.int64),
        row=found.row[:, None],
        face=np.hstack([problem.faces[found.feature[:, :1]], flush.face[found.edge]]),
        theta=flush.theta[found.edge],
        point=flush.ends[found.edge, 0],
        start=np.stack([found.locator[:, 0], height], axis=1),
        clamp_feature=found.feature[:, 1],
        line=found.line,
        tip=np.stack([found.tip[:, 0] - found.locator[:, 0], found.tip[:, 1]], axis=1),
        # The wall's ends are listed after the locator.
        taken=found.null[:, [2, 0, 1]],
        push=found.push,
        doubt=found.doubt,
        holes=np.stack([line, hole] if find_axis(problem.toolkit.moving) else [hole, line], axis=1),
        hole_of=hole_of,
    )


def make_contacts_of_candidates(c: CandidateFixtures, problem: Problem) -> ClampContacts:
    """Return the contacts of three locators and a clamp that can be bolted and may be one of two.

    ``c`` are the proven candidates of one direction of the clamp.
    """
    frame = problem.frame
    rows = problem.rows[c.feature]
    wrench = compute_wrenches(c.point, compute_outward_normals(rows, c.point), problem.wrench_length)
    inverse = np.asarray(np.linalg.inv(np.swapaxes(wrench[:, LOCATOR_CONTACTS], 1, 2)), np.float64)
    taken = -(inverse @ wrench[:, TIP, :, None])[..., 0]
    axis = np.array(frame.toolkit.moving_axis) * frame.toolkit.clamping
    turned = np.stack(rotate_vectors(axis[0], axis[1], -(c.theta + frame.quarters * np.pi / 2)), axis=1)
    push = (turned * wrench[:, TIP, :2]).sum(axis=1)
    taken, push, doubt = sharpen_reactions(
        c, taken, push, *bound_rounding_doubts(inverse, taken, rows, push, problem), problem
    )
    column, row = frame.map_step_to_toolkit(c.column[:, LOCATOR_CONTACTS], c.row[:, LOCATOR_CONTACTS])
    lowest = np.stack([column.min(axis=1, initial=1 << 30), row.min(axis=1, initial=1 << 30)], axis=1)
    column, row = column - lowest[:, :1], row - lowest[:, 1:]
    placement = make_clamp_placement(c, problem)
    index, hole = placement.choose_holes(problem, every=True)
    pitch = np.array(frame.toolkit.carriers[0].pitch)
    cosine, sine = QUARTERS[frame.quarters]
    along, height = placement.tip.T
    tip = np.stack([cosine * along - sine * height, sine * along + cosine * height], axis=1) - lowest * pitch
    across = 1 if frame.quarters % 2 == 0 else 0
    line = np.stack(frame.map_step_to_toolkit(np.zeros(len(along), np.int64), c.row[:, TIP]), axis=1)[
        :, across
    ]
    holes = np.stack(frame.map_step_to_toolkit(hole, c.row[index, TIP]), axis=1) - lowest[index]
    is_bolted = np.zeros(len(push), np.bool_)
    is_bolted[index] = True
    kept = may_hold_in_pair(taken, push) & is_bolted
    number = np.cumsum(kept) - 1
    order = np.lexsort((row, column), axis=1)
    feature, column, row = (
        np.take_along_axis(values, order, axis=1)[kept]
        for values in (c.feature[:, LOCATOR_CONTACTS], column, row)
    )
    point = np.take_along_axis(c.point[:, LOCATOR_CONTACTS], order[:, :1, None], axis=1)[kept, 0]
    taken = np.take_along_axis(taken, order, axis=1)[kept]
    there = kept[index]
    return ClampContacts(
        direction=np.full(kept.sum(), find_direction_number(problem.toolkit)),
        feature=feature,
        column=column,
        row=row,
        face=problem.faces[feature],
        theta=(c.theta[kept] + frame.quarters * np.pi / 2 + SAME_POSE) % tau - SAME_POSE,
        point=point + np.array(problem.workpiece.center),
        start=np.zeros((len(point), 2)),
        clamp_feature=c.feature[kept, TIP],
        line=(line - lowest[:, across])[kept],
        tip=tip[kept],
        taken=taken,
        push=push[kept],
        doubt=doubt[kept],
        holes=holes[there],
        hole_of=number[index[there]],
    )


def sharpen_reactions(
    c: CandidateFixtures, taken: Array, push: Array, push_off: Array, doubt: Array, problem: Problem
) -> tuple[Array, Array, Array]:
    """Return (taken, push, doubt) of N contacts, computed in ball arithmetic where doubles are too coarse.

    They are the locators' forces (N, 3), the clamp's pushes (N,) and error bounds of the forces (N,), see
    :class:`ClampContacts`. ``push_off`` (N,) are error bounds of the given pushes.
    """
    from workhold.proof.exact_contacts import bound_reactions

    taken, push, doubt = taken.copy(), push.copy(), doubt.copy()
    # Errors per unit of the clamp's own force, relative to one plus the largest force.
    most = np.abs(taken).max(axis=1, initial=0.0)
    off = (doubt + most * push_off / push) / (push + most) + push_off / push
    chosen = np.flatnonzero(off > FORCES_OFF).tolist()
    with BALLS if chosen else nullcontext():
        for k in chosen:
            sharp = bound_reactions(make_candidate_box(c, k, problem), problem.limits)
            if sharp is not None:
                taken[k], push[k], doubt[k] = sharp.taken, sharp.push, sharp.doubt
    return taken, push, doubt


def make_candidate_box(c: CandidateFixtures, number: int, problem: Problem) -> CandidateBox:
    """Return candidate ``number``, three locators and a clamp, as a box about its solution.

    The box is in the frame of the search.
    """
    column, row, lattice = c.column[number], c.row[number], problem.frame.lattice
    x, y = (column[LOCATOR_CONTACTS] - column[0]) * lattice.pitch_x, (row - row[0]) * lattice.pitch_y
    separation = float(x.max() + c.gap[number])
    offsets = list(zip([*x.tolist(), 0.0], y.tolist(), strict=True))
    middle = -float(c.theta[number]), *c.point[number, 0].tolist(), separation
    return make_box_beside(c.feature[number].tolist(), offsets, middle, problem)


def make_box_beside(
    features: Sequence[int],
    offsets: Sequence[tuple[float, float]],
    middle: tuple[float, float, float, float],
    problem: Problem,
) -> CandidateBox:
    """Return a box about a proven contact of three locators
    and a clamp, see ``proof.ball_contacts.CandidateBox``.

    Parameters
    ----------
    features : indices of the four features, the clamp's last.
    offsets : (x, y) in mm of each peg from the first peg; x of the clamp is 0, since its position is unknown.
    middle : approximate solution: psi in radians; x and y of the first peg in the part's frame, and the
        separation, in mm.
    """
    from flint import ctx

    from workhold.proof.ball_contacts import CandidateBox
    from workhold.proof.exact_contacts import make_exact_rows
    from workhold.proof.interval_newton import PRECISIONS

    frame, reach = problem.frame, (BESIDE / problem.wrench_length, BESIDE, BESIDE, 2 * BESIDE)
    radii = [frame.standing.peg_radius] * TIP + [frame.moving.peg_radius]
    with ctx.workprec(PRECISIONS[-1]):
        rows = make_exact_rows(features, radii, problem)
    return CandidateBox(rows, offsets, TIP, middle, reach)


def may_hold_in_pair(taken: Array, push: Array) -> BoolArray:
    """Return a mask (N,): True for clamps that neither hold the part alone nor overload a locator.

    A locator is overloaded beyond ``MOST_FORCE`` times the clamp's own force. ``taken`` (N, 3) are the
    locators' forces and ``push`` (N,) is the clamp's force along its line, each divided by the force at the
    clamp's face.
    """
    needs_another = taken.min(axis=1, initial=inf) <= NO_REACTION * (1.0 + np.abs(taken).sum(axis=1))
    return np.asarray(needs_another & (np.abs(taken).max(axis=1, initial=0.0) <= MOST_FORCE * push))


def bound_rounding_doubts(
    inverse: Array, taken: Array, rows: Array, push: Array, problem: Problem
) -> tuple[Array, Array]:
    """Return error bounds due to rounding: (of the clamp's push (N,), of the locators' forces (N,)).

    The error of a place is the error of the contact equations times their inverse; along a clamp's line it is
    divided by the push. An error of place e turns a normal by e over the arc's radius, and changes a moment
    by e / L. The bounds are to first order, doubled.

    Parameters
    ----------
    inverse : (N, 3, 3) inverses of the matrices of the locators' wrenches.
    taken, push : see :func:`may_hold_in_pair`.
    rows : (N, 4, 12) kernel rows of the features touched.
    """
    size = float(np.abs(problem.rows[:, [X, Y, RADIUS]]).max()) + problem.wrench_length
    norm = np.abs(inverse).sum(axis=2).max(axis=1, initial=0.0)
    curved = 1.0 / np.where(rows[..., IS_ARC] != 0.0, rows[..., RADIUS], inf)
    off = 4.0 * norm * (ROUNDINGS * size + problem.backward_error)
    swing = 2.5 * off * (curved[:, TIP] / push + 1.0 / problem.wrench_length) + ROUNDINGS
    wrench = off * (2.5 * curved.max(axis=1) + 2.5 / problem.wrench_length) + ROUNDINGS
    at_tip = np.maximum(wrench, swing + 2.5 * off / (push * problem.wrench_length))
    return swing, 2.0 * norm * (at_tip + wrench * np.abs(taken).sum(axis=1))
