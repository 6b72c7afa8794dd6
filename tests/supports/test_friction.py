"""What friction could add on supports, held against another formulation and another solver."""

from __future__ import annotations

from itertools import product
from math import cos, pi, radians, sin
from random import Random

import numpy as np
import pytest
from attrs import evolve
from numpy.typing import NDArray
from scipy.optimize import linprog

from supports.cases import NAMES, case
from supports.random_supports import convex_part, random_demand
from workhold import Vise, design
from workhold.errors import InputError
from workhold.model.support_request import SpatialLoad
from workhold.model.support_triples import Supports, Triple
from workhold.supports.friction import compute_clamp_force, yield_polygon_corners
from workhold.supports.listing import find_supports

Array = NDArray[np.float64]
VISE = Vise(pitch=15, columns=4, peg_radius=3)
SIDES = 8


def pegs_of(found: Supports) -> list[tuple[Array, Array]]:
    """Of each peg of a vise on a polygon where it touches and how it pushes, in the part's coordinates."""
    fixture, corners = found.fixture, np.array(found.query.workpiece.loops[0])[:, :2]
    out = []
    for peg in fixture.pegs:
        start, end = corners[peg.face], corners[(peg.face + 1) % len(corners)]
        along = (end - start) / np.hypot(*(end - start))
        push = np.array([-along[1], along[0]])
        out.append((np.array(fixture.pose.inverse.apply(peg.x, peg.y)) + VISE.peg_radius * push, push))
    return out


def least_clamp(
    found: Supports, triple: Triple, friction: float, heights: tuple[float, ...], wrench: Array
) -> float:
    """The least clamp force in N: tangential forces between the eight sides of each cone's pyramid.

    Unknowns are the forces of each contact in x, y and z; moments are about the origin of the part.
    """
    contacts = [
        (np.array([*at, height]), np.array([*push, 0.0]))
        for (at, push), height in zip(pegs_of(found), heights, strict=True)
    ]
    contacts += [(np.array([pad.x, pad.y, 0.0]), np.array([0.0, 0.0, 1.0])) for pad in triple.supports]
    contacts.append((np.array([*triple.clamp.at, found.request.thickness]), np.array([0.0, 0.0, -1.0])))
    inward = np.array(found.fixture.pose.inverse.turn(-1.0, 0.0))
    balance, limits = np.zeros((7, 3 * len(contacts))), []
    for number, (at, push) in enumerate(contacts):
        own = slice(3 * number, 3 * number + 3)
        balance[:3, own] = np.eye(3)
        balance[3:6, own] = np.array([[0, -at[2], at[1]], [at[2], 0, -at[0]], [-at[1], at[0], 0]])
        if number < len(found.fixture.pegs) and found.fixture.pegs[number].carrier == "right":
            balance[6, own] = [*inward, 0.0]
        across = np.cross(push, [0.0, 0.0, 1.0]) if push[2] == 0 else np.array([1.0, 0.0, 0.0])
        for k in range(SIDES):
            turn = 2 * pi * (k + 0.5) / SIDES
            outward = cos(turn) * across + sin(turn) * np.cross(push, across)
            row = np.zeros(3 * len(contacts))
            row[own] = outward - friction * cos(pi / SIDES) * push
            limits.append(row)
        row = np.zeros(3 * len(contacts))
        row[own] = -push
        limits.append(row)
    cost = np.zeros(3 * len(contacts))
    cost[-1] = -1.0
    answer = linprog(
        cost,
        A_ub=np.array(limits),
        b_ub=np.zeros(len(limits)),
        A_eq=balance,
        b_eq=[*-wrench, found.jaw_force],
        bounds=(None, None),
        method="highs",
    )
    assert answer.status == 0
    return float(answer.fun)


def wrenches(load: SpatialLoad) -> list[Array]:
    """Forces and moments about the origin of a load in one direction, at the ends of its ranges."""
    assert load.heights is not None
    turn, out = radians(load.directions[0]), []
    for (x, y), height, axial in product(load.points, load.heights, load.axial):
        force = np.array([load.force * cos(turn), load.force * sin(turn), -axial])
        moment = np.cross([x, y, height], force) + np.array([*load.tilt, load.moment])
        out.append(np.array([*force, *moment]))
    return out


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(5))
def test_the_clamp_force_with_friction_is_that_of_another_formulation(seed: int) -> None:
    """In a vise, for loads in one direction; with little friction and with much."""
    random = Random(seed)
    result, found = design(convex_part(random), VISE, best=30), None
    while found is None or not found.triples or not found.loads:
        request, loads = random_demand(random, result.workpiece)
        loads = tuple(evolve(load, directions=(load.directions[0],) * 2) for load in loads)
        request = evolve(request, bottom_zones=(), top_zones=(), point=None)
        found = find_supports(random.choice(list(result)), result.query, request, loads, best=1)
    triple, bands = found.triples[0], found.request.list_peg_bands(4).tolist()
    for friction in (0.05, 0.2):
        worst = max(
            least_clamp(found, triple, friction, heights, wrench)
            for load in found.loads
            for wrench in wrenches(load)
            for heights in product(*bands)
        )
        expected = min(max(worst, 0.0), triple.clamp.clamp_needed)
        assert found.bound_clamp_force(friction) == pytest.approx(expected, rel=1e-6, abs=1e-5)


def found_in(name: str, jaw_force: float | None = None) -> Supports:
    """The two best sets of a case."""
    one = case(name)
    return find_supports(one.fixture, one.query, one.request, one.loads, jaw_force or one.jaw_force, best=2)


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
def test_without_friction_it_is_what_the_clamp_needs_and_more_friction_never_asks_for_more(name: str) -> None:
    """At the worst heights of the bands and in all directions; what is needed is derived in another way."""
    found = found_in(name)
    for rank, triple in enumerate(found.triples, 1):
        forces = [found.bound_clamp_force(one, rank) for one in (0.0, 0.05, 0.1, 0.3)]
        assert forces[0] == pytest.approx(triple.clamp.clamp_needed, rel=1e-9)
        assert forces == sorted(forces, reverse=True) and forces[-1] < 0.5 * forces[0]


@pytest.mark.thorough
def test_corners_around_directions_leave_none_out_and_are_hardly_longer() -> None:
    """Each direction of a range is inside the hull of the corners, which are at most 0.5 % longer than 1."""
    for directions in ((0.0, 360.0), (20.0, 20.0), (-30.0, 100.0), (10.0, 14.0)):
        corners = np.array(list(yield_polygon_corners(directions)))
        assert np.hypot(*corners.T).max() <= 1.005
        for turn in np.radians(np.linspace(*directions, 400)):
            for look in np.radians(np.arange(0, 360, 7.5)):
                ahead = np.array([cos(look), sin(look)])
                assert (corners @ ahead).max() >= ahead @ [cos(turn), sin(turn)] - 1e-12


def test_what_is_no_friction_and_no_load_are_refused() -> None:
    """One sentence each."""
    found = found_in("bracketL")
    for wrong in (-0.1, float("nan"), float("inf"), 1e9):
        with pytest.raises(InputError, match="cannot be used: give a coefficient from 0 to"):
            found.bound_clamp_force(wrong)
    with pytest.raises(InputError, match="and there are none: give a load too"):
        compute_clamp_force(evolve(found, loads=()), found.triples[0], 0.1)
    with pytest.raises(InputError, match="there is no set 3 of supports"):
        found.bound_clamp_force(0.1, 3)
