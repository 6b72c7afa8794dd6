"""A locked jaw: what it does to peg forces agrees with springs that may let go, solved by trying every set of contacts."""

from __future__ import annotations

from itertools import combinations
from math import inf

import numpy as np
import pytest
from numpy.typing import NDArray

from held import force_directions, held, load_wrench, plate_fixture
from workhold import Load, Result
from workhold.errors import InputError
from workhold.statics.loads import compute_forces_with_jaw_stiffness, compute_load_cases, read_jaw_stiffness

Array = NDArray[np.float64]


def springs(wrenches: Array, shares: Array, load: Array, jaw_force: float, stiffness: float) -> Array | None:
    """Forces of four springs of stiffness 1 that only press, the moving ones on a jaw that is a spring too.

    The jaw is closed until it pushes with the jaw force and its far end then fixed; the load moves part and jaw by y (4,). A
    spring is pressed by what it was before and by the movement; the set of those that press is found by trying all.
    Nothing balances where the part escapes: None.

    Parameters
    ----------
    wrenches : (4, 3) of each peg's push on the part. shares : (4,) of it in pushing the jaw back. load : (3,).
    """
    scale = np.array([1.0, 1.0, 0.05])
    rows = np.column_stack([wrenches * scale, -shares])
    before = np.linalg.solve(rows.T, [0.0, 0.0, 0.0, -jaw_force])
    jaw = np.array([0.0, 0.0, 0.0, stiffness])
    for count in (4, 3, 2, 1):
        for pressing in map(list, combinations(range(4), count)):
            # Balance: sum of rows f = (-load, -jaw_force - stiffness * y_jaw), f = before - rows y on those that press.
            chosen = rows[pressing]
            matrix = chosen.T @ chosen + np.diag(jaw)
            if np.linalg.matrix_rank(matrix, tol=1e-9) < 4:
                continue
            given = np.append(load * scale, jaw_force) + chosen.T @ before[pressing]
            y = np.linalg.solve(matrix, given)
            forces = before - rows @ y
            others = [k for k in range(4) if k not in pressing]
            if (forces[pressing] >= -1e-9).all() and (forces[others] <= 1e-9).all():
                out = np.zeros(4)
                out[pressing] = forces[pressing]
                return out
    return None


@pytest.fixture(scope="module", params=[("widget", 8, 1, 3, 50)], ids=["widget"])
def result(request: pytest.FixtureRequest) -> Result:
    """Fixtures of a part."""
    return held(*request.param)


@pytest.mark.thorough
@pytest.mark.parametrize("stiffness", [0.3, 4.0, 1e9])
def test_locked_forces_are_those_of_springs(result: Result, stiffness: float) -> None:
    """Above the jaw force needed every spring presses with the force told; below it one has let go."""
    random = np.random.default_rng(5)
    jaw = inf if stiffness == 1e9 else stiffness
    for fixture in list(result)[:12]:
        point, angle = tuple(random.uniform(-20, 20, 2)), float(random.uniform(0, 360))
        load = Load(
            points=[point], force=90, directions=(angle, angle), moment=float(random.uniform(-500, 500))
        )
        wrenches, shares = force_directions(fixture, result.workpiece, result.toolkit.peg_radius)
        wrench = load_wrench(90, point, angle, load.moment)
        (case,) = compute_load_cases(fixture, result.workpiece, result.toolkit, [load], jaw=jaw)
        (more,) = compute_load_cases(
            fixture, result.workpiece, result.toolkit, [load], jaw_force=1.1 * case.jaw_force, jaw=jaw
        )
        assert more.keeps_contact
        pressed = springs(wrenches, shares, wrench, more.jaw_force, stiffness)
        assert pressed == pytest.approx(more.largest, rel=1e-5, abs=1e-5 * max(more.largest))
        lost = springs(wrenches, shares, wrench, 0.99 * case.needed.value, stiffness)
        assert lost is None or lost[case.needed.peg] == 0


def test_the_manuals_plate() -> None:
    """200 N against one peg of a pinwheel: 100 N either way when locked; 200 and 0 where the jaw keeps its force."""
    plate, vise, fixture = plate_fixture()
    for direction, constant in ((0, 200), (180, 0)):
        push = Load(points=[(0, 0)], force=200, directions=(direction, direction))
        assert compute_load_cases(fixture, plate, vise, [push])[0].needed.value == pytest.approx(100)
        assert compute_load_cases(fixture, plate, vise, [push], jaw="constant")[
            0
        ].needed.value == pytest.approx(constant)


def test_a_jaw_that_gives_way_is_between_the_two(result: Result) -> None:
    """A very soft jaw keeps its force and a very stiff one is locked; the load reaction is the same for all."""
    load = Load(points=[(3.0, 4.0)], force=50)
    fixture = result[0]

    def case(jaw: str | float) -> tuple[float, float]:
        (told,) = compute_load_cases(fixture, result.workpiece, result.toolkit, [load], jaw=jaw)
        return told.needed.value, told.reaction.value

    (soft, one), (constant, other) = case(1e-9), case("constant")
    assert soft == pytest.approx(constant, rel=1e-6) and one == pytest.approx(other)
    (stiff, one), (screw, other) = case(1e9), case("screw")
    assert stiff == pytest.approx(screw, rel=1e-6) and one == pytest.approx(other) == pytest.approx(
        case("constant")[1]
    )


def test_friction_never_asks_for_more() -> None:
    """With friction a locked jaw needs no more than without."""
    plate, vise, fixture = plate_fixture()
    (case,) = compute_load_cases(
        fixture, plate, vise, [Load(points=[(0, 15)], force=200, directions=(0, 0))], friction=0.1
    )
    assert case.needed_with_friction == pytest.approx(75) == pytest.approx(case.needed.value)


def test_a_rigid_jaw_takes_its_share_and_one_that_keeps_its_force_none() -> None:
    """Behind a rigid jaw the forces are at right angles to those of closing."""
    forces, closing = np.split(np.random.default_rng(1).normal(size=(4, 4)), [3], axis=1)
    assert (compute_forces_with_jaw_stiffness(forces, closing, 0.0) == forces).all()
    assert closing[:, 0] @ compute_forces_with_jaw_stiffness(forces, closing, inf) == pytest.approx(
        0, abs=1e-12
    )


def test_two_clamps_that_are_locked_share_as_springs_do() -> None:
    """Of all forces that balance a load those with the least energy, found by least squares."""
    random = np.random.default_rng(2)
    forces, closing = random.normal(size=(5, 3)), random.normal(size=(5, 2))
    out = compute_forces_with_jaw_stiffness(forces, closing, 2.0)
    for k in range(3):
        # Contacts of stiffness 1, clamps of stiffness 2: minimize sum f^2 + sum k^2 / 2 over f = f0 + H k.
        system = np.vstack([closing, np.eye(2) / np.sqrt(2.0)])
        moves, *_ = np.linalg.lstsq(system, -np.append(forces[:, k], [0.0, 0.0]), rcond=None)
        assert out[:, k] == pytest.approx(forces[:, k] + closing @ moves)


@pytest.mark.parametrize("jaw", ["", "hydraulic", "-1", -1.0, "nan", float("nan")])
def test_other_jaws_are_refused(jaw: str | float) -> None:
    """One sentence that names what can be given."""
    with pytest.raises(InputError, match="give screw, constant, or how many times"):
        read_jaw_stiffness(jaw)
