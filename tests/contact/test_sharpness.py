"""How far rounding may put features off the drawing is counted as sharply as the rest of the proof. See ``sharpness``."""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import Any

import numpy as np
import pytest
from flint import arb

from exact_chords import exactly
from sharpness import Constant, check_sharpness
from strategies import random_outline
from workhold import Query, Vise, Workpiece
from workhold.contact.problem import Problem
from workhold.verification.ball_geometry import LineSide, Point, compute_norm, make_side_at_vertex


def features_off(random: Random, kernel: Callable[..., Any]) -> float:
    """How far features are off lines and circles made of the drawing's numbers, over how far they may be by the program."""
    shift, radius = np.array([random.uniform(-60, 60), random.uniform(-60, 60), 0.0]), random.uniform(0.5, 3)
    part = Workpiece.from_loops("part", [(loop + shift).tolist() for loop in random_outline(random, 5).loops])
    problem = Problem.from_query(Query(part, Vise(pitch=10.0, columns=2, peg_radius=radius)))
    vertices = [
        (vertex, loop[(k + 1) % len(loop)]) for loop in part.loops for k, vertex in enumerate(loop.tolist())
    ]
    faces, worst = {face.number: face for face in part.faces}, 0.0
    with exactly():
        for row, face in zip(problem.rows.tolist(), problem.faces.tolist(), strict=True):
            # Faces of several segments are joined by a tolerance of their own.
            if len(faces[face].segments) == 1:
                one, other = vertices[face]
                side = make_side_at_vertex(tuple(one), tuple(other))
                at: Point = (arb(row[1]) + part.center[0], arb(row[2]) + part.center[1])
                if isinstance(side, LineSide):
                    ends = ((at[0] + s * row[5] * row[3], at[1] + s * row[5] * row[4]) for s in (-1, 1))
                    off = [abs(side.compute_gap(end) - radius) for end in ends]
                else:
                    grown = side.radius + side.sign * radius - row[6]
                    off = [compute_norm((at[0] - side.center[0], at[1] - side.center[1])) + abs(grown)]
                worst = max(worst, *(float(v.upper()) for v in off))
    return worst / float(kernel(problem))


CONSTANT = Constant(
    "features, 16 half units",
    vars(Problem)["backward_error"].fget,
    features_off,
    symbol="ROUNDINGS",
    draws=60,
)
CONSTANTS = [CONSTANT]


@pytest.mark.prove
def test_a_tenth_of_the_constant_would_not_do() -> None:
    """The bound holds on every part, and with a tenth of the constant it does not."""
    check_sharpness(CONSTANT)
