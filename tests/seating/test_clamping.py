"""A part in two clamps: the friction below which both bring it home, what each alone presses, and what there is to do."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf

import numpy as np
import pytest
from attrs import evolve
from scipy.optimize import linprog

import workhold
from workhold import Fence, Fixture, Plate, Result, Workpiece
from workhold.model.clamps import compute_working_forces, describe_tightening_order
from workhold.seating.clamping import WHY, find_sticking_friction_of_two, plan_hand_loading

RECTANGLE = Workpiece.from_loops("rectangle", [[[0, 0, 0], [100, 0, 0], [100, 60, 0], [0, 60, 0]]])
BOWED = Workpiece.from_loops("bowed", [[[0, 0, 0], [70, 0, 0], [70, 45, 0.2], [20, 50, 0.3], [0, 40, 0]]])
PLATE = Plate(pitch=20, peg_radius=3, clamps=2, columns=6, rows=6)
FENCE = Fence(pitch=20, peg_radius=3, wall_offset=10, clamps=2, columns=6, rows=4)
OPPOSED = Plate(pitch=20, peg_radius=3, clamps=2, columns=8, rows=6, directions=[["-x", "+x"]])


@pytest.fixture(scope="module", params=[(BOWED, PLATE), (BOWED, FENCE)], ids=["plate", "fence"])
def result(request: pytest.FixtureRequest) -> Result:
    """Fixtures of a part with slanted and round sides."""
    return workhold.design(*request.param)


def of_every_kind(result: Result) -> Iterator[Fixture]:
    """Fixtures of which either clamp may be first, one of them, or none, as far as there are some."""
    seen = set()
    for fixture in result:
        if (kind := (fixture.pair.ratio[0] == 0.0, fixture.pair.ratio[1] == inf)) not in seen:
            seen.add(kind)
            yield fixture


def balances(
    fixture: Fixture, part: Workpiece, toolkit: Plate | Fence, friction: float, without: int
) -> bool:
    """Whether both clamps at their working ratio balance within friction cones without a locator: forces and moments from
    holes, faces and the pose alone."""
    columns, pushes = [], []
    for number, peg in enumerate(fixture.pegs):
        if number == without:
            continue
        face = next(one for one in part.faces if one.number == peg.face).segment
        radius = 0.0 if peg.is_on_wall else toolkit.find_carrier(peg.carrier).peg_radius
        x, y = fixture.pose.inverse.apply(peg.x, peg.y)
        if hasattr(face, "center"):
            normal = np.array([x - face.center[0], y - face.center[1]]) * face.sign
        else:
            along = np.subtract(face.end, face.start)
            normal = np.array([along[1], -along[0]])
        normal = np.array(fixture.pose.turn(*(normal / np.hypot(*normal))))
        at, tangent = np.array([peg.x, peg.y]) - radius * normal, np.array([-normal[1], normal[0]])
        for side in (-friction, friction):
            force = side * tangent - normal
            columns.append([*force, (at[0] * force[1] - at[1] * force[0]) / 50.0])
            name = fixture.direction.split()[number - 3] if number > 2 else ""
            way = {"-x": (-1, 0), "+x": (1, 0), "-y": (0, -1), "+y": (0, 1)}.get(name, (0, 0))
            pushes.append([float(force @ way) * (number == 3), float(force @ way) * (number == 4)])
    share = np.array([1.0, fixture.pair.working_ratio])
    rows = np.column_stack([np.hstack([columns, pushes]).T, [0.0, 0.0, 0.0, *-share]])
    rows = np.vstack([rows, [1.0] * len(columns) + [0.0]])
    return linprog(np.zeros(rows.shape[1]), A_eq=rows, b_eq=[0.0] * 5 + [1.0], bounds=(0, None)).status == 0


def test_on_a_fence_a_rectangle_sticks_from_a_friction_found_by_hand() -> None:
    """Fence below, locator and clamp at mid-height, equal forces 1. Off its left end the part turns about the right one,
    where the clamp from above has a lever of 43 mm: fence and clamp above resist along x with mu at 60 / 2 mm each, and the
    locator upward with mu at 100 mm, so that 43 = 160 mu; off the right end the lever is 57 mm."""
    result = workhold.design(RECTANGLE, Fence(pitch=20, peg_radius=3, wall_offset=10, clamps=2), best=1)
    [fixture] = result
    assert sorted(round(peg.x) for peg in fixture.pegs) == [0, 3, 60, 103, 106] and fixture.pegs[0].y == 30.0
    assert find_sticking_friction_of_two(fixture, RECTANGLE, result.toolkit) == pytest.approx(
        43 / 160, rel=1e-8
    )


@pytest.mark.thorough
def test_below_the_friction_told_no_locator_can_be_spared(result: Result) -> None:
    """By linear programs from the drawing: none balance just below it, and some do just above; of each kind of order."""
    for fixture in of_every_kind(result):
        told = plan_hand_loading(fixture, result.workpiece, result.toolkit).sticking_friction
        assert told is not None and 0.0 < told < inf
        sticks = [
            any(
                balances(fixture, result.workpiece, result.toolkit, told * by, without)
                for without in range(3)
            )
            for by in (1.0 - 1e-5, 1.0 + 1e-5)
        ]
        assert sticks == [False, True]


@pytest.mark.thorough
def test_what_a_clamp_alone_does_not_press_is_told(result: Result) -> None:
    """In balance of that clamp alone those locators have no force, or would have to pull; of a clamp that may be first none
    pulls, and at the working ratio none is without force."""
    for fixture in of_every_kind(result):
        told, reactions = (
            plan_hand_loading(fixture, result.workpiece, result.toolkit),
            np.array([fixture.pair.reactions]),
        )
        for k, pegs in enumerate(told.unpressed):
            pressed = [
                peg for peg, one in zip(fixture.pegs[:3], reactions[0, :, k], strict=False) if one > 1e-9
            ]
            assert sorted((*pegs, *pressed), key=repr) == sorted(fixture.pegs[:3], key=repr) and pegs
            may_be_first = fixture.pair.ratio[k] == (0.0, inf)[k]
            assert may_be_first == bool((reactions[0, :3, k] > -1e-9).all())
        assert (compute_working_forces(reactions)[0] > 0.0).all()


@pytest.mark.thorough
def test_steps_tell_what_to_push_hold_tighten_and_look_at(result: Result) -> None:
    """Each locator and face is named to push against and to look at, the order is that told elsewhere, and for each clamp
    that may be first what it leaves without force; names of fences and clamps, and no option of a command."""
    kinds = 0
    for fixture in of_every_kind(result):
        told = plan_hand_loading(fixture, result.workpiece, result.toolkit)
        push, touch, order, friction, after = told.list_steps()
        locators = [peg for peg in fixture.pegs[:3] if not peg.is_on_wall]
        assert all(peg.hole in push and f"{peg.touching} at {peg.hole}" in touch for peg in locators)
        on_wall = [peg for peg in fixture.pegs if peg.is_on_wall]
        assert ("the fence, flush, and against the locator" in push) == bool(on_wall)
        assert all(f"at the fence on the {peg.hole.split()[1]}" in touch for peg in on_wall)
        towards = [
            {"-x": "left", "+x": "right", "-y": "downward", "+y": "upward"}[d]
            for d in fixture.direction.split()
        ]
        assert all(word in push for word in towards)
        assert order.startswith(describe_tightening_order(fixture)) and "until both clamps are tight" in order
        first = [fixture.pair.ratio[0] == 0.0, fixture.pair.ratio[1] == inf]
        for tip, may, pegs in zip(fixture.pegs[3:], first, told.unpressed, strict=True):
            assert (f"{tip.hole} alone does not press it on" in order) == may
            if may:
                rest = order.partition(f"{tip.hole} alone does not press it on")[2]
                assert all(peg.is_on_wall or peg.hole in rest for peg in pegs)
                assert ("the fence" in rest.partition(", and")[0]) >= any(peg.is_on_wall for peg in pegs)
        assert (
            fixture.pair.working_ratio < 0.1
            or f"{fixture.pair.working_ratio:.2f} times the force of {fixture.pegs[3].hole}" in friction
        )
        assert told.list_steps(with_order=False)[2] == order.removeprefix(
            describe_tightening_order(fixture) + " "
        )
        assert all(f"at {tip.hole}" in after for tip in fixture.pegs[3:])
        assert not any("--" in step for step in (*told.list_steps(), WHY))
        kinds += 1
    assert kinds >= 3


def test_friction_is_told_rounded_down_and_against_that_of_steel(result: Result) -> None:
    told = plan_hand_loading(result[0], result.workpiece, result.toolkit)
    [high] = evolve(told, sticking_friction=0.41279).describe_friction()
    assert "while friction is below 0.412;" in high and "tap" not in high
    [low] = evolve(told, sticking_friction=0.19999).describe_friction()
    assert low.startswith("If the friction is 0.199 or more") and low.endswith(
        "so tap it home as you tighten."
    )
    [never] = evolve(told, sticking_friction=inf).describe_friction()
    assert never.endswith("whatever the friction.")
    fixture = evolve(told.fixture, pair=evolve(told.pair, ratio=(0.0, 0.008)))
    assert "with 0.004 times the force of" in evolve(told, fixture=fixture).describe_friction()[0]
    assert evolve(told, sticking_friction=inf).to_fields()["sticking_friction"] is None
    assert "0.413" in repr(evolve(told, sticking_friction=0.41279))


def test_opposed_clamps_do_not_show_where_to_push() -> None:
    result = workhold.design(BOWED, OPPOSED)
    assert len(result)
    push = plan_hand_loading(result[0], result.workpiece, OPPOSED).describe_push()
    assert "push the part by hand until" in push


def test_of_pegs_with_a_flat_no_friction_is_told() -> None:
    """Their contact does not stay near one point as the part turns; all else is said."""
    plate = evolve(PLATE, flat=2.5)
    [told] = workhold.seatings(workhold.design(RECTANGLE, plate, best=1))
    assert told.sticking_friction is None and len(told.list_steps()) == 4
    assert "friction" not in " ".join(told.list_steps()) and "sticks" not in repr(told)
