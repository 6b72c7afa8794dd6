"""Rows of contact features as the drawing's vertices and bulges make them, in balls.

A row in doubles is off by the last digit of a radius or a direction. Where a peg nearly grazes an arc at a share p of its
normal, that error over p turns the normal. Over p squared it changes forces per unit of the clamp's own.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from flint import arb

from workhold.contact.problem import Problem
from workhold.conventions import STRAIGHT
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, REST_X, REST_Y, SIGN, X, Y

__all__ = ["exact_rows"]

Vertex = tuple[float, float, float]
# mm and no unit. A row farther from the drawing is not of that face as it is drawn, such as that of a flat.
SAME_ROW = 1e-9


def exact_rows(features: Sequence[int], radii: Sequence[float], problem: Problem) -> list[list[Any]]:
    """Rows (P, 12) of contact features of pegs of some radii in mm, with balls in them, at the precision in force."""
    sides: list[tuple[Vertex, Vertex]] = []
    for loop in problem.workpiece.loops:
        vertices = [(float(x), float(y), float(bulge)) for x, y, bulge in loop]
        sides += zip(vertices, vertices[1:] + vertices[:1], strict=True)
    runs = {face.number: face.segments for face in problem.workpiece.faces}
    out = []
    for feature, radius in zip(features, radii, strict=True):
        row, run = problem.rows[feature].tolist(), runs[int(problem.faces[feature])]
        out.append(exact_row(row, [sides[number] for number in run], radius, problem.workpiece.center))
    return out


def exact_row(
    row: list[Any], run: Sequence[tuple[Vertex, Vertex]], radius: float, center: tuple[float, float]
) -> list[Any]:
    """The row of a face that is a run of sides: a line from the first start to the last end, or the first arc's circle."""
    (start, following), end = run[0], run[-1][1]
    bulge, is_arc = start[2], row[IS_ARC] != 0.0
    if is_arc != (abs(bulge) >= STRAIGHT):
        return row
    end = following if is_arc else end
    dx, dy = arb(end[0]) - start[0], arb(end[1]) - start[1]
    chord, made = (dx * dx + dy * dy).sqrt(), list(row)
    made[REST_X] = made[REST_Y] = 0.0
    if is_arc:
        square = arb(bulge) * bulge
        aside = (1 - square) / (4 * arb(bulge))
        made[X] = (arb(start[0]) + end[0]) / 2 - dy * aside - center[0]
        made[Y] = (arb(start[1]) + end[1]) / 2 + dx * aside - center[1]
        made[RADIUS] = chord * (1 + square) / (4 * abs(arb(bulge))) + row[SIGN] * arb(radius)
        pairs = [(made[X], row[X]), (made[Y], row[Y]), (made[RADIUS], row[RADIUS])]
    else:
        made[AXIS_X], made[AXIS_Y] = dx / chord, dy / chord
        along = made[AXIS_X] * (row[X] + arb(center[0]) - start[0]) + made[AXIS_Y] * (
            row[Y] + arb(center[1]) - start[1]
        )
        made[X] = start[0] + made[AXIS_X] * along + made[AXIS_Y] * radius - center[0]
        made[Y] = start[1] + made[AXIS_Y] * along - made[AXIS_X] * radius - center[1]
        pairs = [(made[k], row[k]) for k in (X, Y, AXIS_X, AXIS_Y)]
    return made if all(abs(one - other) < SAME_ROW for one, other in pairs) else row
