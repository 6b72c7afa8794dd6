"""The worst place of a path is where a dense walk over places and directions finds it, whatever is left out."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from numpy.typing import NDArray

from workhold import Program
from workhold.model.cutting_forces import CuttingForces
from workhold.model.cutting_tool import CuttingDirection, Cylinder, Tool
from workhold.model.moves import Moves, compute_path_points
from workhold.statics import path_forces as module
from workhold.statics.path_forces import (
    PathForces,
    are_inside_hull,
    drop_lesser_torques,
    list_all_pieces,
    list_path_forces,
)

Array = NDArray[np.float64]
CENTER = (7.0, -3.0)


def random_program(
    seed: int, direction: CuttingDirection, levels: int, count: int = 60, arcs: bool = True
) -> Program:
    """A path of lines, arcs, helices and holes of two tools, with so many different forces."""
    random = np.random.default_rng(seed)
    places = np.column_stack([random.uniform(-60, 60, (count + 1, 2)), random.uniform(-9, 0, count + 1)])
    bulge = random.uniform(-1, 1, count) * (random.random(count) < 0.5) * arcs
    drilling = random.random(count) < 0.15
    tool = random.integers(1, 3, count)
    force = random.uniform(100, 900, levels)[random.integers(0, levels, count)]
    torque = force * np.where(tool == 1, 5.0, 10.0)
    start, end = places[:-1].copy(), places[1:].copy()
    end[drilling, :2] = start[drilling, :2]
    bulge[drilling] = 0.0
    ones = np.ones(count)
    moves = Moves(np.arange(count) + 1, tool, ones > 0, start, end, bulge, 300 * ones, 1000 * ones)
    forces = CuttingForces(np.where(drilling, 0.0, force), torque, np.zeros((count, 2)), 0 * ones, direction)
    tools = {number: Tool(number, [Cylinder(0, 40, 5.0 * number)], 10.0 * number) for number in (1, 2)}
    return Program("p.nc", "0", "mm", (0.0, 0.0), 0.0, tools=tools, moves=moves, forces=forces)


def functions_of(seed: int, rows: int, each: int) -> Array:
    """Random linear functions of the load."""
    found = np.random.default_rng(seed).normal(size=(rows, each, 3))
    found[..., 2] /= 50.0
    return found


def walked(program: Program, functions: Array, places: int = 200, ways: int = 120) -> tuple[Array, Array]:
    """The largest value of each function (N, J) and the number of its move, at many places and directions."""
    moves, forces = program.moves, program.forces
    assert forces is not None
    half = pi if forces.direction == "any" else pi / 3
    best = np.zeros(functions.shape[:2])
    where = np.full(best.shape, -1)
    a, b, c = (functions[..., k, None, None] for k in range(3))
    for k in range(len(moves)):
        share = np.linspace(0, 1, places if moves.bulge[k] else 2)
        ones = np.ones(len(share))
        ends = (np.outer(ones, one[k, :2]) for one in (moves.start, moves.end))
        at = compute_path_points(*ends, moves.bulge[k] * ones, share) - np.array(CENTER)
        chord, sweep = (moves.end - moves.start)[k], 4 * np.arctan(moves.bulge[k])
        against = np.arctan2(chord[1], chord[0]) + sweep * (share - 0.5) + pi
        phi = against[:, None] + np.linspace(-half, half, ways)
        x, y = at[:, 0, None], at[:, 1, None]
        value = (a - y * c) * np.cos(phi) + (b + x * c) * np.sin(phi)
        most = (forces.force[k] * value + forces.torque[k] * np.abs(c)).max(axis=(2, 3))
        where, best = np.where(most > best, k, where), np.maximum(best, most)
    return best, where


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("direction", ["any", "feed"])
@pytest.mark.parametrize("levels", [1, 3, 200])
@pytest.mark.parametrize("seed", range(4))
def test_the_worst_is_that_of_a_dense_walk(seed: int, levels: int, direction: CuttingDirection) -> None:
    program, functions = random_program(seed, direction, levels), functions_of(seed, 9, 4)
    found, (dense, _) = list_path_forces(program, CENTER).find_worst(functions), walked(program, functions)
    assert (found.value >= dense.max(axis=1) * (1 - 1e-12)).all()
    assert found.value == pytest.approx(dense.max(axis=1), rel=2e-3)
    certain = np.sort(dense, axis=1)[:, -1] > 1.01 * np.sort(dense, axis=1)[:, -2]
    rows = np.flatnonzero(certain)
    assert len(rows) and (found.which[rows] == dense.argmax(axis=1)[rows]).all()
    # The move that is named reaches what is claimed of it.
    chosen = functions[np.arange(9), found.which][:, None]
    alone = [
        walked_alone(program, chosen[k : k + 1], int(found.move[k])) for k in range(9) if found.move[k] >= 0
    ]
    assert alone == pytest.approx(found.value[found.move >= 0].tolist(), rel=2e-3)


def walked_alone(program: Program, functions: Array, move: int) -> float:
    """The largest value of one function on one move."""
    moves, forces = program.moves, program.forces
    assert forces is not None
    one = [move]
    part = Moves(*(getattr(moves, name)[one] for name in COLUMNS))
    rest = CuttingForces(
        forces.force[one], forces.torque[one], forces.axial[one], forces.height[one], forces.direction
    )
    alone = Program("p.nc", "0", "mm", (0.0, 0.0), 0.0, tools=program.tools, moves=part, forces=rest)
    return float(walked(alone, functions)[0].max())


COLUMNS = ("line", "tool", "cutting", "start", "end", "bulge", "feed", "spindle")


@pytest.mark.parametrize("direction", ["any", "feed"])
@pytest.mark.parametrize("levels", [1, 5, 400])
def test_what_is_left_out_is_never_worst(levels: int, direction: CuttingDirection) -> None:
    program, functions = random_program(11, direction, levels, 900), functions_of(3, 60, 2)
    whole, some = list_all_pieces(program, CENTER), list_path_forces(program, CENTER)
    assert len(some) < len(whole) / (3 if direction == "any" else 1.1)
    every = whole.find_worst(functions)
    assert some.find_worst(functions).value == pytest.approx(every.value, rel=1e-12)


def test_blocks_are_passed_over_only_where_they_hold_less(monkeypatch: pytest.MonkeyPatch) -> None:
    program, functions = random_program(5, "feed", 30, 400), functions_of(9, 40, 3)
    pieces = drop_lesser_torques(list_all_pieces(program, CENTER))
    found = pieces.find_worst(functions)
    monkeypatch.setattr(module, "BLOCK", len(pieces))
    whole = PathForces(*(getattr(pieces, name) for name in module.COLUMNS), spread=pieces.spread).find_worst(
        functions
    )
    assert found.value == pytest.approx(whole.value, rel=1e-13)
    assert (found.move == whole.move).all() and (found.which == whole.which).all()


def test_a_straight_push_by_hand() -> None:
    # 200 N anywhere on a line from (0, 0) to (30, 0), the tool's radius 5 mm: at (30, 0) the moment about the
    # origin is 200 * 30 + 200 * 5 N mm.
    ones = np.ones(1)
    moves = Moves([7], [1], [True], [[0, 0, -1]], [[30, 0, -1]], [0], ones, ones)
    forces = CuttingForces([200], [1000], [[0, 0]], [0])
    tool = Tool(1, [Cylinder(0, 40, 5)], 10)
    program = Program("p.nc", "0", "mm", (0.0, 0.0), 0.0, tools={1: tool}, moves=moves, forces=forces)
    found = list_path_forces(program, (0.0, 0.0)).find_worst(
        np.array([[[0, 0, 1.0]], [[0, 0, -2.0]], [[3.0, 4, 0]]])
    )
    assert found.value.tolist() == pytest.approx([7000, 14000, 1000])
    against = CuttingForces([200], [1000], [[0, 0]], [0], "feed")
    found = list_path_forces(
        Program("p.nc", "0", "mm", (0.0, 0.0), 0.0, tools={1: tool}, moves=moves, forces=against),
        (0.0, 0.0),
    ).find_worst(np.array([[[1.0, 0, 0]], [[-1.0, 0, 0]], [[0, 1.0, 0]]]))
    # Within 60 degrees of -x: never to the right, and across with the sine of 60 degrees.
    assert found.value.tolist() == pytest.approx([0, 200, 200 * 3**0.5 / 2])
    assert found.move.tolist() == [-1, 0, 0]


def test_inside_a_hull_with_upright_sides() -> None:
    square = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
    x, y = np.array([0.0, 2, 0, 2, 1, -0.1, 2.1, 1, 0]), np.array([1.0, 1, 0, 2, 2, 1, 1, 2.1, -0.1])
    assert are_inside_hull(square, x, y).tolist() == [True] * 5 + [False] * 4
    assert not are_inside_hull(square[:2], x, y).any()
