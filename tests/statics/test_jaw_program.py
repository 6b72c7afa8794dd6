"""The jaw force that a program asks for, against loads that are tried one by one."""

import numpy as np
import pytest

from workhold.model.cutting_forces import CuttingForces
from workhold.model.cutting_tool import Tool
from workhold.model.jaw_hold import JawPatch
from workhold.model.moves import Moves
from workhold.model.program import Program
from workhold.statics.friction import FrictionHold, MotionProgram
from workhold.statics.jaw_program import GAP, CuttingPieces, PressedPart, find_worst_move

WIDE, DEEP, GRIP, HIGH, SAFETY = 100.0, 60.0, 18.0, 25.0, 2.0


def block(friction=0.1, stop=()):
    face = JawPatch(((0.0, WIDE, 0.0, GRIP),), (0,))
    return FrictionHold.from_patches(face, face, DEEP, friction, stop)


def program_of(points, bulges=None, force=400.0, torque=2000.0, axial=(-200.0, 0.0), direction="any"):
    """A program that cuts from point to point."""
    start, end = np.array(points[:-1], float), np.array(points[1:], float)
    count = len(start)
    moves = Moves(
        line=np.arange(1, count + 1),
        tool=np.ones(count, int),
        cutting=np.ones(count, bool),
        start=start,
        end=end,
        bulge=np.zeros(count) if bulges is None else np.array(bulges, float),
        feed=np.full(count, 500.0),
        spindle=np.full(count, 4000.0),
    )
    forces = CuttingForces(
        np.full(count, force), np.full(count, torque), np.tile(axial, (count, 1)), np.zeros(count), direction
    )
    return Program(
        "p",
        "0" * 64,
        "mm",
        (0.0, 0.0),
        HIGH,
        tools={1: Tool(1, [(0.0, 40.0, 5.0)], 10.0)},
        moves=moves,
        forces=forces,
    )


def tried(grip, program, steps=33, ways=64, spread=np.pi):
    """The hardest of loads at many places and directions, with the moves' numbers."""
    forces, moves, found = program.forces, program.moves, []
    for move in range(len(moves)):
        bulge = moves.bulge[move]
        chord = moves.end[move] - moves.start[move]
        for share in np.linspace(0, 1, steps):
            point = moves.start[move] + share * chord
            heading = np.arctan2(chord[1], chord[0])
            if bulge:
                turn = 4 * np.arctan(bulge)
                radius = np.hypot(*chord[:2]) / (2 * np.sin(turn / 2))
                first = heading - turn / 2
                along = first + share * turn / 2
                point = point.copy()
                point[:2] = moves.start[move, :2] + 2 * radius * np.sin(share * turn / 2) * np.array(
                    [np.cos(along), np.sin(along)]
                )
                heading = first + share * turn
            for angle in heading + np.pi + spread * np.linspace(-1, 1, ways + 1):
                for pull in forces.axial[move]:
                    force = [forces.force[move] * np.cos(angle), forces.force[move] * np.sin(angle), -pull]
                    for sign in (-1.0, 1.0):
                        row = grip.compute_wrenches(point[None], np.array([force]))[0]
                        row[5] += sign * forces.torque[move] / grip.length
                        found.append((move, row * SAFETY))
    loads = np.array([row for _, row in found])
    return MotionProgram(grip).find_least_forces(loads).max()


def asked(grip, program, theta=0.0, position=(0.0, 0.0)):
    return find_worst_move(grip, CuttingPieces.from_program(program, HIGH), program, theta, position, SAFETY)


PATHS = {
    "pocket": ([(30, 25, 22), (70, 25, 22), (70, 35, 22), (30, 35, 19), (30, 25, 19)], None),
    "arc": ([(20, 30, 20), (50, 30, 20), (80, 30, 24)], [0.8, -0.5]),
    "helix": ([(40, 30, 25), (60, 30, 20), (40, 30, 15)], [1.0, 1.0]),
}


@pytest.mark.thorough
@pytest.mark.parametrize("direction", ["any", "feed"])
@pytest.mark.parametrize("name", PATHS)
def test_force_is_the_hardest_of_loads_tried_one_by_one(name, direction):
    """It is none below, and above by less than 1 %."""
    points, bulges = PATHS[name]
    program, grip = program_of(points, bulges, direction=direction), block()
    most = tried(grip, program, 9, 32, np.pi if direction == "any" else np.pi / 3)
    need = asked(grip, program).force
    assert most * (1 - 1e-9) <= need <= most * 1.012


@pytest.mark.thorough
def test_line_that_asks_most_is_named():
    program = program_of([(50, 30, 12), (52, 30, 12), (52, 30, 12), (99, 59, 25), (97, 59, 25)])
    need = asked(block(), program)
    ends = np.array([(50, 30, 12), (52, 30, 12), (52, 30, 12), (99, 59, 25), (97, 59, 25)], float)
    only = [asked(block(), program_of(ends[k : k + 2])).force for k in range(4)]
    assert need.line == int(np.argmax(only)) + 1
    assert need.force == pytest.approx(max(only), rel=GAP)


@pytest.mark.thorough
def test_part_and_path_turned_together_ask_for_the_same():
    points, bulges = PATHS["arc"]
    program, grip = program_of(points, bulges), block()
    turned = [(DEEP - y, x, z) for x, y, z in points]
    other = asked(grip, program_of(turned, bulges), -np.pi / 2, (0.0, DEEP))
    assert other.force == pytest.approx(asked(grip, program).force, rel=2 * GAP)


@pytest.mark.thorough
def test_more_force_or_safety_asks_for_more_and_none_for_nothing():
    points, _ = PATHS["pocket"]
    need = asked(block(), program_of(points)).force
    assert asked(
        block(), program_of(points, force=800.0, torque=4000.0, axial=(-400.0, 0.0))
    ).force == pytest.approx(2 * need, rel=2 * GAP)
    assert asked(block(0.2), program_of(points)).force < need
    idle = program_of(points, force=0.0, torque=0.0, axial=(0.0, 0.0))
    assert asked(block(), idle) is None


def test_drill_that_presses_on_the_parallels_asks_for_its_torque_alone():
    program = program_of([(50, 30, 25), (50, 30, 5)], force=0.0, torque=3000.0, axial=(0.0, 500.0))
    need, grip = asked(block(), program), block()
    row = np.zeros((1, 6))
    row[0, 5] = 3000.0 * SAFETY / grip.length
    assert need.force >= MotionProgram(grip).find_least_forces(row)[0] * (1 - 1e-9) > 0


def test_corners_have_both_torques_and_both_ends_of_the_axial_force():
    grip = block()
    program = program_of([(50, 30, 25), (50, 30, 5)], force=0.0, torque=3000.0, axial=(-100.0, 500.0))
    part = PressedPart(
        CuttingPieces.from_program(program, HIGH), grip, MotionProgram(grip), 0.0, (0.0, 0.0), SAFETY
    )
    rows = part.make_loads(np.array([0]), 0.0, 0.0)
    assert set(np.round(rows[:, 5] * grip.length)) == {-6000.0, 6000.0}
    assert set(rows[:, 2]) == {200.0, -1000.0}


@pytest.mark.thorough
def test_loads_in_one_cone_are_answered_by_one_motion():
    rng, grip = np.random.default_rng(3), block()
    loads = grip.compute_wrenches(
        rng.uniform(0, 1, (150, 3)) * [WIDE, DEEP, HIGH], rng.normal(size=(150, 3)) * 300
    )
    each = np.array([need if need is not None else np.inf for need in grip.compute_forces_needed(loads)])
    together = MotionProgram(grip).find_least_forces(loads)
    assert together == pytest.approx(each, rel=1e-8, abs=1e-6)


@pytest.mark.thorough
def test_what_suffices_does_not_stand_for_the_least():
    rng, grip = np.random.default_rng(5), block()
    loads = grip.compute_wrenches(
        rng.uniform(0, 1, (40, 3)) * [WIDE, DEEP, HIGH], rng.normal(size=(40, 3)) * 300
    )
    each, motions = MotionProgram(grip).find_least_forces(loads), MotionProgram(grip)
    enough = motions.find_least_forces(loads, 1.2 * each.max())
    assert (enough >= each * (1 - 1e-9)).all() and (enough <= 1.2 * each.max()).all()
    assert motions.find_least_forces(loads) == pytest.approx(each, rel=1e-8, abs=1e-6)
