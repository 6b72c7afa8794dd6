"""Rows of contact features and reactions of locators in ball arithmetic, for cases in which doubles are too
coarse.

A *ball* is a number of python-flint given as a midpoint and a radius: it encloses the exact number.

Rows are made from the drawing's vertices and bulges. In doubles, the last digit of a row's radius or
direction is uncertain. If a peg nearly grazes an arc, only a share p of its normal force pushes: the error
divided by p turns the normal, and divided by p squared it changes forces per unit of the clamp's own force.

Whether two clamps close often depends on an exact zero, for example if a clamp's line of force passes through
the point in which the lines of two locators meet. Another rounding of a drawing's numbers changes such a zero
by far less than the decision threshold. The place of a clamp that nearly grazes an arc, and so the share of
its force that pushes, has an error of rounding divided by that share.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import Any

from attrs import frozen
from flint import arb, arb_mat, ctx

from workhold.contact.problem import Problem
from workhold.conventions import STRAIGHT
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, REST_X, REST_Y, SIGN, X, Y
from workhold.kernels.base.tables import Limits
from workhold.model.clamps import LOCATORS
from workhold.model.workpiece import Workpiece
from workhold.proof.ball_contacts import BoxContacts, CandidateBox, place_contacts
from workhold.proof.interval_newton import PRECISIONS, refine_solution
from workhold.proof.singular_frame import SingularFrame

__all__ = [
    "SharpReactions",
    "find_drawn_circle",
    "make_exact_rows",
    "round_reactions",
    "bound_reactions",
    "find_drawn_segment",
]

Vertex = tuple[float, float, float]
Side = tuple[Vertex, Vertex]
# mm and no unit. A row farther from the drawing is not of that face as it is drawn, such as that of a flat.
SAME_ROW = 1e-9


def make_exact_rows(features: Sequence[int], radii: Sequence[float], problem: Problem) -> list[list[Any]]:
    """Return rows (P, 12) of features for pegs of these radii in mm, with numbers as balls at the precision
    in force.

    ``features`` are P indices into ``problem.rows``, ``radii`` the P radii of the pegs. A ball is a midpoint
    with a radius. See ``kernels.base.feature`` for the layout of rows.
    """
    workpiece, out = problem.workpiece, []
    for feature, radius in zip(features, radii, strict=True):
        number = int(problem.faces[feature])
        run = next(face.segments for face in workpiece.numbered.faces if face.number == number)
        first, last = find_drawn_segment(workpiece, run[0]), find_drawn_segment(workpiece, run[-1])
        out.append(make_exact_row(problem.rows[feature].tolist(), first, last, radius, workpiece.center))
    return out


def find_drawn_segment(workpiece: Workpiece, number: int) -> Side:
    """Return the vertices (x, y, bulge) at both ends of a segment of a workpiece's outlines.

    ``number`` counts segments through all outlines and loops.

    Raises
    ------
    IndexError
        When there is no such segment.
    """
    for loop in (loop for outline in workpiece.every_outline for loop in outline.loops):
        if number < len(loop):
            (x, y, bulge), (x1, y1, other) = loop[[number, (number + 1) % len(loop)]].tolist()
            return (x, y, bulge), (x1, y1, other)
        number -= len(loop)
    raise IndexError(number)


def find_drawn_circle(side: Side) -> tuple[arb, arb, arb]:
    """Return (centre x, centre y, radius) in mm, as balls, of the arc between two vertices, from its
    bulge."""
    start, end = side
    bulge = arb(start[2])
    dx, dy = arb(end[0]) - start[0], arb(end[1]) - start[1]
    aside = (1 - bulge * bulge) / (4 * bulge)
    x, y = (arb(start[0]) + end[0]) / 2 - dy * aside, (arb(start[1]) + end[1]) / 2 + dx * aside
    return x, y, (dx * dx + dy * dy).sqrt() * (1 + bulge * bulge) / (4 * abs(bulge))


def make_exact_row(
    row: list[Any], first: Side, last: Side, radius: float, center: tuple[float, float]
) -> list[Any]:
    """Return the row of a peg's feature on a face of one or several segments, with balls for numbers.

    The face is the line from the first segment's start to the last segment's end, or the first segment's
    circle; ``first`` and ``last`` are the vertices at the ends of these segments, ``radius`` is the peg's in
    mm. Return ``row``, the row in doubles, itself where it is off the drawn face by more than ``SAME_ROW``,
    or of another kind.
    """
    (start, _), (_, end) = first, last
    is_arc = row[IS_ARC] != 0.0
    if is_arc != (abs(start[2]) >= STRAIGHT):
        return row
    made = list(row)
    made[REST_X] = made[REST_Y] = 0.0
    if is_arc:
        x, y, drawn = find_drawn_circle(first)
        made[X], made[Y], made[RADIUS] = x - center[0], y - center[1], drawn + row[SIGN] * arb(radius)
        pairs = [(made[X], row[X]), (made[Y], row[Y]), (made[RADIUS], row[RADIUS])]
    else:
        dx, dy = arb(end[0]) - start[0], arb(end[1]) - start[1]
        chord = (dx * dx + dy * dy).sqrt()
        made[AXIS_X], made[AXIS_Y] = dx / chord, dy / chord
        along = made[AXIS_X] * (row[X] + arb(center[0]) - start[0]) + made[AXIS_Y] * (
            row[Y] + arb(center[1]) - start[1]
        )
        made[X] = start[0] + made[AXIS_X] * along + made[AXIS_Y] * radius - center[0]
        made[Y] = start[1] + made[AXIS_Y] * along - made[AXIS_X] * radius - center[1]
        pairs = [(made[k], row[k]) for k in (X, Y, AXIS_X, AXIS_Y)]
    return made if all(abs(one - other) < SAME_ROW for one, other in pairs) else row


# Steps in which a box shrinks to one solution, if it ever does.
MOST_STEPS = 24
# Half units in the last place of a double.
ROUNDING = 2.3e-16
# Reactions that are off by no more than this part of the largest are known as well as doubles can be.
LAST_DIGIT = 1.001 * ROUNDING


@frozen
class SharpReactions:
    """Forces at a clamped part, with errors of the size of the rounding of a double.

    Parameters
    ----------
    taken : forces of three locators per unit of the clamp's force on its face.
    doubt : how far these may be off.
    push : component along the clamp's travel of its force on its face, per unit of that force.
    """

    taken: tuple[float, float, float]
    doubt: float
    push: float


def bound_reactions(box: CandidateBox, limits: Limits) -> SharpReactions | None:
    """Return the reactions at the one solution of a box of three locators and a clamp.

    Return None if it is not proven that the box has exactly one solution. Precision rises until the reactions
    are known to the last digit of a double; the lowest precision is usually enough.
    """
    sharp = None
    for bits in PRECISIONS:
        with ctx.workprec(bits):
            sharp = find_reactions(box, limits)
        if sharp is not None and sharp.doubt <= LAST_DIGIT * max(map(abs, sharp.taken)):
            break
    return sharp


def find_reactions(box: CandidateBox, limits: Limits) -> SharpReactions | None:
    """Return the reactions at the one solution of a box at the precision in force; see
    :func:`bound_reactions`.

    Return None where it is not proven that the box has exactly one solution.
    """
    frame = SingularFrame.from_box(box, limits)
    place: list[arb] | None = frame.make_start_box()
    for _ in range(MOST_STEPS):
        assert place is not None
        place, unique = frame.narrow(place, frame.compute_contacts(place))
        if place is None:
            return None
        if unique:
            here = place_contacts(box, frame.compute_unknowns(refine_solution(frame, place)))
            (x, y), (along, across) = here.normals[LOCATORS], here.axis
            return round_reactions(compute_reactions(here), int(limits.clamping) * (x * along + y * across))
    return None


def compute_reactions(here: BoxContacts) -> list[arb]:
    """Return the three forces a, as balls, with w_1 a_1 + w_2 a_2 + w_3 a_3 = -w, by Cramer's rule.

    w_1 to w_3 are the wrenches of the locators and w that of the clamp, all about peg 1.
    """
    wrenches = [(n[0], n[1], q[0] * n[1] - q[1] * n[0]) for q, n in zip(here.arms, here.normals, strict=True)]
    whole = arb_mat(wrenches[:LOCATORS]).det()
    out = []
    for k in range(LOCATORS):
        columns = list(wrenches[:LOCATORS])
        columns[k] = wrenches[LOCATORS]
        out.append(-arb_mat(columns).det() / whole)
    return out


def round_reactions(values: Sequence[arb], push: arb) -> SharpReactions:
    """Return the midpoints of balls of three reactions and of the push as doubles, with an error bound of the
    reactions.

    The error bound is inf where a ball is not finite.
    """
    a, b, c = (float(value.mid()) for value in values)
    doubt = max(float(value.rad()) + ROUNDING * abs(float(value.mid())) for value in values)
    return SharpReactions((a, b, c), doubt if doubt == doubt else inf, float(push.mid()))
