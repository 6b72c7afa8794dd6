"""Planted fixtures are found: a part is built around pegs, so one of its fixtures is known beforehand."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count, islice
from math import pi

import numpy as np
import pytest
from attrs import frozen
from planting import Array, Plant, all_sides, drawn, half_plane_polygon, plant

from fixture_sets import Judge, listed, missing
from workhold import Fence, Fixture, Plate, Workpiece, design


def valid_plants(first_seed: int) -> Iterator[tuple[Plant, Judge]]:
    """Plants that the independent checker accepts and that are not marginal."""
    for seed in count(first_seed):
        planted = plant(seed)
        if planted is not None:
            judge = Judge(planted.workpiece, planted.vise)
            faults, marginal = judge.check(planted.fixture)
            if not faults and not marginal:
                yield planted, judge


def assert_found(first_seed: int, plants: int) -> set[str]:
    """The search lists each of some planted fixtures; return their types."""
    kinds = set()
    for planted, judge in islice(valid_plants(first_seed), plants):
        result = design(planted.workpiece, planted.vise, types=[planted.fixture["type"]])
        assert missing(listed(result), [planted.fixture], judge) == []
        assert result.proof is not None
        assert result.proof.undecided == ()
        kinds.add(planted.fixture["type"])
    return kinds


@pytest.mark.thorough
@pytest.mark.parametrize("plants", [7, pytest.param(12, marks=pytest.mark.prove)])
def test_planted_fixtures_are_found(plants: int) -> None:
    """Each of some planted fixtures is listed, over lines, convex and concave arcs and both types."""
    assert assert_found(10_000, plants) == {"I", "II"}


@pytest.mark.prove
@pytest.mark.parametrize("batch", range(15))
def test_thousands_of_planted_fixtures_are_found(batch: int) -> None:
    """Each of 1,500 planted fixtures is listed."""
    assert_found(1_000_000 + 10_000 * batch, 100)


# How far a place may be off that is the planted one, in mm and degrees.
NEAR = 1e-6


def relative(fixture: Fixture) -> list[tuple[int, ...]]:
    """Columns and rows of the locators, from the lowest, with their faces, and the clamp's row and face."""
    *locators, clamp = fixture.pegs
    column, row = min(peg.column for peg in locators), min(peg.row for peg in locators)
    places = sorted((peg.column - column, peg.row - row, peg.face) for peg in locators)
    return [*places, (clamp.row - row, clamp.face)]


def on_plates(first_seed: int) -> Iterator[tuple[Workpiece, Plate, list[tuple[int, ...]], float]]:
    """Parts planted in a vise with three pegs on its left jaw and one on its right, which is a clamp that moves in -x."""
    for seed in count(first_seed):
        planted = plant(seed)
        if planted is None or planted.fixture["type"] != "II" or planted.vise.row_offset:
            continue
        faults, marginal = Judge(planted.workpiece, planted.vise).check(planted.fixture)
        if faults or marginal:
            continue
        *locators, clamp = planted.fixture["pegs"]
        column, row = (min(peg[name] for peg in locators) for name in ("column", "row"))
        places = sorted((peg["column"] - column, peg["row"] - row, peg["segment"]) for peg in locators)
        wanted = [*places, (clamp["row"] - row, clamp["segment"])]
        plate = Plate(planted.vise.pitch, planted.vise.peg_radius, columns=4, rows=8, directions=("-x",))
        yield planted.workpiece, plate, wanted, planted.fixture["pose"]["theta_deg"]


def assert_found_on_plates(first_seed: int, plants: int) -> None:
    """The search lists each of some planted fixtures."""
    for workpiece, plate, wanted, theta in islice(on_plates(first_seed), plants):
        result = design(workpiece, plate)
        assert result.proof is not None and result.proof.undecided == ()
        turns = [
            abs((one.pose.theta_deg - theta + 180) % 360 - 180) for one in result if relative(one) == wanted
        ]
        assert turns and min(turns) < NEAR, (workpiece.loops, plate, wanted)


@frozen(eq=False)
class OnFence:
    """A part above a fence, with what locator and clamp touch, the clamp's line and how far its tip is from the locator."""

    workpiece: Workpiece
    fence: Fence
    faces: tuple[int, int]
    rows: tuple[int, int]
    ahead: float
    theta_deg: float


def plant_on_fence(seed: int) -> OnFence | None:
    """Try to build a part that lies flush on a fence, touched by a locator and a clamp that moves in -x."""
    random = np.random.default_rng(seed)
    pitch, radius = float(random.integers(8, 16)), float(random.choice([0.0, 1.0, 2.5]))
    fence = Fence(pitch, radius, wall_offset=float(radius + random.uniform(0.5, 8)), directions=("-x",))
    rows = int(random.integers(0, 5)), int(random.integers(0, 5))
    ahead = float(random.uniform(25, 70))
    points = np.array(
        [[x, fence.wall_offset + row * pitch] for x, row in zip((0.0, ahead), rows, strict=True)]
    )
    angles = np.array([pi, 0.0]) + random.uniform(-1.2, 1.2, 2)
    normals = np.array([[0.0, -1.0], *np.stack([np.cos(angles), np.sin(angles)], axis=1)])
    touches = np.array([[0.0, 0.0], *(points - radius * normals[1:])])
    corners = half_plane_polygon(normals, (touches * normals).sum(axis=1))
    if corners is None or not presses(normals, touches, corners):
        return None
    sides = all_sides(random, normals, touches, corners, radius, plain=0)
    # Around a peg in a hollow the part reaches out, and may reach below the fence.
    if sides is None or sides[0][:, 1].min() < -1e-9:
        return None
    part = drawn(random, sides[0])
    if part is None:
        return None
    workpiece, theta, _ = part
    return OnFence(workpiece, fence, (sides[1][1], sides[1][2]), rows, ahead, float(np.degrees(theta)))


def presses(normals: Array, touches: Array, corners: Array) -> bool:
    """Whether the forces of the bottom's ends, locator and clamp balance, each with a fair share, and the clamp pushes."""
    bottom = corners[np.abs(corners[:, 1]) < 1e-9]
    if len(bottom) != 2 or corners[:, 1].min() < -1e-9:
        return False
    at = np.array([*bottom, *touches[1:]])
    across = np.array([normals[0], normals[0], *normals[1:]])
    moments = (at[:, 0] * across[:, 1] - at[:, 1] * across[:, 0]) / 50
    null = np.linalg.svd(np.column_stack([across, moments]).T)[2][-1]
    share = null / null.sum()
    return bool(share.min() > 1e-3 and normals[2, 0] > 0.01)


def assert_found_on_fences(first_seed: int, plants: int) -> None:
    """The search lists each of some planted fixtures."""
    parts = filter(None, map(plant_on_fence, count(first_seed)))
    for planted in islice(parts, plants):
        result = design(planted.workpiece, planted.fence)
        assert result.proof is not None and result.proof.undecided == ()
        assert any(is_planted(fixture, planted) for fixture in result), (
            planted.workpiece.loops,
            planted.fence,
        )


def is_planted(fixture: Fixture, planted: OnFence) -> bool:
    """Whether a fixture is the planted one."""
    locator, _, _, clamp = fixture.pegs
    turn = (fixture.pose.theta_deg - planted.theta_deg + 180) % 360 - 180
    return (
        (locator.face, clamp.face) == planted.faces
        and (locator.row, clamp.row) == planted.rows
        and abs(turn) < NEAR
        and abs(clamp.x - locator.x - planted.ahead) < NEAR
    )


@pytest.mark.thorough
def test_planted_fixtures_on_fences_are_found() -> None:
    """Each of a hundred."""
    assert_found_on_fences(0, 100)


@pytest.mark.prove
@pytest.mark.parametrize("batch", range(10))
def test_more_planted_fixtures_are_found(batch: int) -> None:
    """Each of 100 on plates and 3,000 on fences."""
    assert_found_on_plates(2_000_000 + 100_000 * batch, 10)
    assert_found_on_fences(2_000_000 + 100_000 * batch, 300)
