"""Peg forces and jaw forces under loads agree with equilibrium, with linear programs, and with arithmetic by hand."""

from __future__ import annotations

import re
from math import hypot
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import linprog

import workhold
from held import force_directions, held, load_wrench, plate_fixture
from workhold import Fixture, Load, OpeningVise, Result, Vise, Workpiece
from workhold.errors import InputError
from workhold.model.fixture_table import FixtureTable
from workhold.model.quality import (
    CLAMP_AMPLIFICATION,
    CLOSURE_MARGIN,
    END_DISTANCE,
    LOAD_REACTION,
    LOCATION_ERROR,
)
from workhold.statics.loads import compute_load_cases
from workhold.statics.quality import measure_quality

Array = NDArray[np.float64]
PAGE = Path(__file__).parents[2] / "docs" / "quality.md"


def least_jaw_force(wrenches: Array, shares: Array, wrench: Array) -> float:
    """The least jaw force that lets forces within their cones balance a load: a linear program."""
    scale = np.array([1.0, 1.0, 0.05])
    answer = linprog(
        shares,
        A_eq=(wrenches * scale).T,
        b_eq=-wrench * scale,
        A_ub=[-shares],
        b_ub=[0.0],
        method="highs",
    )
    assert answer.status == 0
    return float(answer.fun)


class TestHeld:
    """Properties of each part's fixtures."""

    @pytest.mark.thorough
    def test_forces_balance_the_load_and_the_jaw(self, result: Result) -> None:
        """Under one load in one direction: sums of forces and moments are 0, and the right jaw feels the jaw force."""
        random = np.random.default_rng(1)
        for fixture in result:
            point, direction = tuple(random.uniform(-20, 20, 2)), random.uniform(0, 360)
            load = Load(
                points=[point], force=90, directions=(direction, direction), moment=random.uniform(-500, 500)
            )
            (case,) = compute_load_cases(
                fixture, result.workpiece, result.toolkit, [load], jaw_force=250, jaw="constant"
            )
            assert case.smallest == pytest.approx(case.largest, rel=1e-9, abs=1e-9)
            wrenches, shares = force_directions(fixture, result.workpiece, result.toolkit.peg_radius)
            wrench = load_wrench(90, point, direction, load.moment)
            size = max(case.largest) * np.array([1, 1, 100])
            assert (np.abs(wrenches.T @ case.largest + wrench) < 1e-7 * size).all()
            assert shares @ case.largest == pytest.approx(250, rel=1e-7)

    @pytest.mark.thorough
    def test_a_range_holds_the_forces_of_its_directions_and_points(self, result: Result) -> None:
        """Smallest and largest forces over a range and a path are never passed, and nearly met by fine steps."""
        path = [(-10.0, 3.0), (12.0, -4.0), (5.0, 9.0)]
        for fixture in list(result)[::5]:
            load = Load(points=path, force=90, directions=(200, 290), moment=-200)
            (case,) = compute_load_cases(
                fixture, result.workpiece, result.toolkit, [load], jaw_force=100, jaw="constant"
            )
            singles = [
                Load(points=[point], force=90, directions=(angle, angle), moment=-200)
                for point in (*path, (1.0, -0.5))
                for angle in np.linspace(200, 290, 46)
            ]
            cases = compute_load_cases(
                fixture, result.workpiece, result.toolkit, singles, jaw_force=100, jaw="constant"
            )
            forces = np.array([single.largest for single in cases])
            # Half a step of 2 degrees takes 1 - cos(1 degree) off a sinusoid, which is as large at most as the forces and
            # those that do not turn with the load, of the jaws and the moment.
            (still,) = compute_load_cases(
                fixture, result.workpiece, result.toolkit, [Load(moment=-200)], jaw_force=100
            )
            slack = 1.6e-4 * (np.abs(forces).max() + np.abs(still.largest).max())
            assert (forces.max(axis=0) <= np.array(case.largest) + 1e-9 * slack).all()
            assert (forces.max(axis=0) >= np.array(case.largest) - slack).all()
            assert (forces.min(axis=0) >= np.array(case.smallest) - 1e-9 * slack).all()
            assert (forces.min(axis=0) <= np.array(case.smallest) + slack).all()

    @pytest.mark.thorough
    def test_jaw_force_needed_is_the_linear_programs(self, result: Result) -> None:
        """Without friction the least jaw force of the program; met where the case says, not passed elsewhere."""
        random = np.random.default_rng(2)
        for fixture in result:
            load = Load(points=[(4.0, 7.0), (-9.0, 1.0)], force=60, directions=(20, 200), moment=90)
            (case,) = compute_load_cases(fixture, result.workpiece, result.toolkit, [load], jaw="constant")
            wrenches, shares = force_directions(fixture, result.workpiece, result.toolkit.peg_radius)
            there = load_wrench(60, case.needed.point, case.needed.direction, 90)
            assert least_jaw_force(wrenches, shares, there) == pytest.approx(
                case.needed.value, rel=1e-6, abs=1e-6
            )
            other = load_wrench(60, load.points[random.integers(0, 2)], random.uniform(20, 200), 90)
            assert least_jaw_force(wrenches, shares, other) <= case.needed.value * (1 + 1e-6) + 1e-6
            # Told for just this jaw force, one peg is about to let go and all still touch.
            assert case.jaw_force == case.needed.value and case.keeps_contact
            if case.needed.value > 0:
                assert min(case.smallest) == pytest.approx(0.0, abs=1e-9 * max(case.largest))
                (less,) = compute_load_cases(
                    fixture,
                    result.workpiece,
                    result.toolkit,
                    [load],
                    jaw_force=0.99 * case.jaw_force,
                    jaw="constant",
                )
                assert not less.keeps_contact and less.smallest[case.needed.peg] < 0

    @pytest.mark.thorough
    @pytest.mark.parametrize("friction", [0.1, 0.4])
    def test_jaw_force_with_friction_is_the_linear_programs(self, result: Result, friction: float) -> None:
        """For one direction the least jaw force over all forces in the cones; over a range the worst of its directions."""
        random = np.random.default_rng(3)
        for fixture in list(result)[::2]:
            angle, point = random.uniform(0, 360), (random.uniform(-9, 9), random.uniform(-9, 9))
            load = Load(points=[point], force=60, directions=(angle, angle), moment=90)
            (case,) = compute_load_cases(
                fixture, result.workpiece, result.toolkit, [load], friction=friction, jaw="constant"
            )
            wrenches, shares = force_directions(
                fixture, result.workpiece, result.toolkit.peg_radius, friction
            )
            least = least_jaw_force(wrenches, shares, load_wrench(60, point, angle, 90))
            assert case.needed_with_friction == pytest.approx(least, rel=1e-6, abs=1e-4)
            assert case.needed_with_friction <= case.needed.value + 1e-6

    @pytest.mark.thorough
    def test_friction_over_a_range_is_its_worst_direction(self, result: Result) -> None:
        """Fine steps through the range nearly meet the figure and never pass it."""
        for fixture in list(result)[::10]:
            load = Load(points=[(4.0, 7.0)], force=60, directions=(20, 200))
            steps = [
                Load(points=[(4.0, 7.0)], force=60, directions=(a, a)) for a in np.linspace(20, 200, 181)
            ]
            case, *singles = compute_load_cases(
                fixture, result.workpiece, result.toolkit, [load, *steps], friction=0.15, jaw="constant"
            )
            worst = max(single.needed_with_friction or 0.0 for single in singles)
            assert case.needed_with_friction is not None
            assert (
                worst <= case.needed_with_friction + 1e-9 and worst >= case.needed_with_friction * 0.998 - 0.1
            )


def test_little_friction_adds_little_in_a_vise_that_opens() -> None:
    """As the coefficient goes to 0 the jaw force needed goes to the one without friction, whichever way the vise clamps."""
    outer = [[0, 0, 0], [60, 0, 0], [60, 46, 0], [3, 44, 0]]
    part = Workpiece.from_loops("window", [outer, [[11, 12, 0], [14, 35, 0], [44, 36, -0.4], [42, 9, 0]]])
    result = workhold.design(part, OpeningVise(pitch=14, columns=1, peg_radius=3, min_gap=9), best=3)
    assert len(result) > 0
    load = Load(points=[(4.0, 7.0)], force=60, directions=(0, 360))
    for fixture in result:
        (case,) = compute_load_cases(fixture, part, result.toolkit, [load], friction=1e-7, jaw="constant")
        assert case.needed_with_friction == pytest.approx(case.needed.value, rel=1e-3)


def table_of(fixture: Fixture, workpiece: Workpiece, vise: Vise) -> FixtureTable:
    """The one row of the search's own table with a fixture's holes and orientation."""
    result = workhold.design(workpiece, vise)
    holes = [peg.hole for peg in fixture.pegs]
    (k,) = (
        k
        for k, other in enumerate(result)
        if [peg.hole for peg in other.pegs] == holes and other.pose.theta_deg == fixture.pose.theta_deg
    )
    return result.table.take(slice(k, k + 1))


def test_worked_example() -> None:
    """What docs/quality.md works out by hand: a = F - 200, b = d = F - 250, c = F, and the figures that follow."""
    plate, vise, fixture = plate_fixture()
    push = Load(points=[(0, 15)], force=200, directions=(0, 0))
    (case,) = compute_load_cases(fixture, plate, vise, [push], jaw_force=600, jaw="constant")
    assert case.largest == pytest.approx((400, 350, 350, 600)) and case.keeps_contact
    assert case.needed.value == pytest.approx(250) and case.reaction.value == pytest.approx(250)
    (case,) = compute_load_cases(
        fixture, plate, vise, [Load(points=[(0, 15)], force=200)], jaw_force=600, jaw="constant"
    )
    assert case.needed.value == pytest.approx(200 * hypot(1.25, 0.5)) == pytest.approx(269.26, abs=0.005)
    assert min(case.needed.direction, 360 - case.needed.direction) == pytest.approx(21.80, abs=0.005)
    table = table_of(fixture, plate, vise)
    quality = measure_quality(table, plate, vise, loads=[push])[0]
    assert quality[CLOSURE_MARGIN] == pytest.approx(0.25) and quality[CLAMP_AMPLIFICATION] == pytest.approx(
        1.0
    )
    assert quality[END_DISTANCE] == pytest.approx(7.0) and quality[LOAD_REACTION] == pytest.approx(250)
    assert quality[LOCATION_ERROR] == pytest.approx(hypot(0.074, 0.034)) == pytest.approx(0.081, abs=0.0005)
    text = re.sub(r"\s+", " ", PAGE.read_text())
    for said in (
        "400 N, 350 N, 350 N and 600 N",
        "needed is 250 N",
        "269.26 N",
        "21.80°",
        "distance is 7 mm",
        "0.081 mm",
    ):
        assert said in text


def test_the_sign_of_loads() -> None:
    """A load is what acts on the part: pushed to the right, the right peg presses harder than the left one."""
    plate, vise, fixture = plate_fixture()
    (case,) = compute_load_cases(
        fixture,
        plate,
        vise,
        [Load(points=[(0, 0)], force=100, directions=(0, 0))],
        jaw_force=500,
        jaw="constant",
    )
    left, _, _, right = case.largest
    assert right - left == pytest.approx(100)
    # A moment counter-clockwise is resisted by the pegs below and above, whose forces turn the part clockwise.
    (case,) = compute_load_cases(fixture, plate, vise, [Load(moment=1000)], jaw_force=500, jaw="constant")
    assert case.largest == pytest.approx((500, 550, 550, 500))


def test_a_load_that_closes_a_vise_that_keeps_its_force_needs_none() -> None:
    """The jaw force needed is never negative."""
    plate, vise, fixture = plate_fixture()
    (case,) = compute_load_cases(
        fixture,
        plate,
        vise,
        [Load(points=[(0, 0)], force=100, directions=(180, 180))],
        friction=0.1,
        jaw="constant",
    )
    assert case.needed.value == 0 and case.needed_with_friction == 0 and case.keeps_contact


@pytest.mark.parametrize("option", ["jaw_force", "friction"])
@pytest.mark.parametrize("value", [-1.0, float("nan"), float("inf")])
def test_bad_numbers_are_refused(option: str, value: float) -> None:
    """One sentence for a jaw force or a coefficient of friction that cannot be."""
    plate, vise, fixture = plate_fixture()
    with pytest.raises(InputError, match=r"cannot be used: give 0 or more\."):
        compute_load_cases(fixture, plate, vise, [Load(moment=1)], **{option: value})


def test_no_loads_no_cases() -> None:
    """Nothing acts, nothing is told."""
    result = held("widget", 8, 1, 3, 50)
    assert compute_load_cases(result[0], result.workpiece, result.toolkit, []) == ()
