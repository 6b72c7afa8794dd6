"""How far a part may lie off and still come home: no less than a flood reaches, and no more than comes home."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from math import pi, radians, tau
from typing import Any

import numpy as np
import pytest
from attrs import evolve

import workhold
from flooded_cage import Flood
from seating_examples import SAMPLED, Obstacle, case_fixture, closed, solved
from workhold import Fence, Fixture, OpeningVise, Plate, Vise, Workpiece, load
from workhold.fixels.toolkit import Toolkit
from workhold.kernels.seating.columns import CONFIG
from workhold.model.seating import CAGE_SHORT
from workhold.seating.caging_set import CagingSet
from workhold.seating.pattern import Pattern
from workhold.seating.solver import FixtureInPattern, SeatingSolver

BRACKET = Workpiece.from_loops(
    "bracket", [[[0, 0, 0], [80, 0, 0], [80, 20, 0], [28, 20, -0.41], [20, 28, 0], [20, 60, 0], [0, 60, 0]]]
)
QUAD = Workpiece.from_loops("quad", [[[0, 0, 0], [70, 0, 0], [62, 30, 0], [12, 48, 0]]])
HOLED = Workpiece.from_loops(
    "holed",
    [[[0, 0, 0], [80, 0, 0], [80, 70, 0], [0, 70, 0]], [[20, 20, 0], [60, 14, 0], [62, 50, 0], [26, 52, 0]]],
)
KITS: dict[str, tuple[Workpiece, Toolkit]] = {
    "oblong": (load("oblongPart"), Vise(pitch=10, columns=1, peg_radius=3)),
    "widget": (load("widget"), Vise(pitch=8, columns=2, peg_radius=2)),
    "bracket": (BRACKET, Plate(pitch=20, peg_radius=3)),
    "fence": (QUAD, Fence(pitch=20, peg_radius=3, clamp_radius=4, wall_offset=10, directions=["-y"])),
    "opening": (HOLED, OpeningVise(pitch=15, columns=1, peg_radius=3, min_gap=6)),
}
# Steps of a grid across a cage.
STEPS = 24
# How often closing by small steps is taken up where it ended after so many.
TAKEN_UP = 5


@cache
def listed(name: str) -> tuple[Workpiece, Toolkit, list[Fixture]]:
    """The first fixtures of a part in a toolkit, or a sampled one."""
    if name.isdigit():
        part, vise, fixture = case_fixture(SAMPLED[int(name)])
        return part, vise, [fixture]
    part, toolkit = KITS[name]
    return part, toolkit, list(workhold.design(part, toolkit, best=60))


@cache
def reading_of(name: str, rank: int) -> FixtureInPattern:
    """What is told of one of them, in the frame of its own pegs."""
    part, toolkit, fixtures = listed(name)
    solver = SeatingSolver(part, toolkit)
    return solver.place_in_pattern(fixtures[rank], Pattern.from_fixture(fixtures[rank], toolkit))


def around(name: str, rank: int, share: float) -> CagingSet:
    """What lies around it with what moves opened by a share of the capture opening."""
    reading = reading_of(name, rank)
    join = reading.trees[0].find_first_join(reading.place)
    told = reading.make_caging_set(reading.trees[0].seats[reading.place][CONFIG], join)
    # The pass does not belong to what is reached by less.
    return told if share == 1.0 else evolve(told, opening=share * told.opening, to_pass=np.zeros(3))


def differences(name: str, rank: int, share: float, count: int = STEPS) -> np.ndarray:
    """By how much each extreme goes farther than a flood does, in steps of its grid: (3, 2)."""
    part, toolkit, fixtures = listed(name)
    told = around(name, rank, share)
    found = told.extents
    width, (turn, _, up, _) = np.ptp(found.reach, axis=1), (found.ends - told.seat).T
    # Cages lean: a grid that does, too, has the more rows in them.
    lean = float(turn @ up / (turn @ turn))
    steps = width[0] / count, float(np.ptp(up - lean * turn)) / count
    # Ends lie on the edge: between two of them the cage is wide, where it comes home from there.
    between = [(found.ends + np.roll(found.ends, k, axis=0)) / 2.0 for k in range(1, 20)]
    inside = np.vstack([found.ends, *(some[told.find_homecoming(some)] for some in between)]) - told.seat
    flood = Flood(part, fixtures[rank], toolkit, told.opening, inside, steps, lean, rows=8 * count)
    size = np.array([[steps[0]], [width[1] / count], [steps[1] + abs(lean) * steps[0]]])
    return (flood.extents - found.reach) * [1.0, -1.0] / size


def end_at_home(name: str, rank: int, share: float, which: list[int]) -> bool:
    """Whether closing by linear programs of another hand leads home from some of the six extreme places."""
    part, toolkit, fixtures = listed(name)
    reading, told = reading_of(name, rank), around(name, rank, share)
    obstacle = Obstacle.about(part, fixtures[rank], toolkit)
    own, size = obstacle.start(fixtures[rank]), told.arm
    stop = reading.pattern.frame.sign * reading.pattern.stop
    for config in reading.pattern.frame.map_to_toolkit(told.extents.farthest[which] + reading.shift):
        assert obstacle.free(config) > -1e-7
        assert obstacle.clamping * (config[3] - own[3]) <= told.opening + 1e-7
        for _ in range(TAKEN_UP):
            config = closed(obstacle, config, size, stop)
            off = np.abs(config - own)
            off[0] = abs((off[0] + pi) % tau - pi)
            home = off[3] < 1e-3 and off[0] * size + off[1] + off[2] < 0.05
            # Between two parallel faces the part slides at one S, until it goes on down: that is not a rest.
            slides = len(obstacle.near(config, 1e-6)) == 2
            if home or slides:
                break
        if not (home or slides):
            return False
    return True


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "rank"),
    [
        *(("0", 0), ("bracket", 1), ("fence", 0)),
        *(pytest.param(name, 0, marks=pytest.mark.prove) for name in ("1", "2", "oblong", "opening")),
    ],
)
def test_the_extremes_are_those_of_a_flood(name, rank):
    """Nowhere short of it, and beyond it by no more than the rows that step over a narrow end."""
    beyond = differences(name, rank, 0.8)
    assert beyond.min() > -0.15 and beyond.max() < 5.0


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["1", "opening"])
def test_a_part_comes_home_from_the_largest_turns(name):
    """From as far off as is told, opened by a hair less than the whole capture opening."""
    assert end_at_home(name, 0, 0.98, [0, 3])


@pytest.mark.thinned(7)
@pytest.mark.parametrize(
    ("name", "rank"),
    [
        ("0", 0),
        ("1", 0),
        ("2", 0),
        ("oblong", 0),
        ("oblong", 40),
        ("bracket", 2),
        ("bracket", 34),
        ("fence", 0),
        ("opening", 0),
    ],
)
def test_no_extreme_lies_outside_the_cage(name, rank):
    """Paths end where pegs touch and what moves is open by no more than is asked, and closing leads home from all ends."""
    part, toolkit, fixtures = listed(name)
    reading, told = reading_of(name, rank), around(name, rank, 1.0)
    obstacle, found = Obstacle.about(part, fixtures[rank], toolkit), told.extents
    assert (
        told.find_homecoming(found.ends).all()
        and found.ends[:, 3].max() <= told.seat[3] + told.opening + 1e-8
    )
    off = found.ends[:, :3] - told.seat[:3]
    assert (found.reach[:, 0] >= np.minimum(off.min(axis=0), told.to_pass) - 1e-12).all()
    assert (found.reach[:, 1] <= np.maximum(off.max(axis=0), told.to_pass) + 1e-12).all()
    for config in reading.pattern.frame.map_to_toolkit(found.farthest + reading.shift):
        assert -1e-7 < obstacle.free(config) < 1e-6


def test_the_oblong_part_comes_home_turned_by_twelve_degrees():
    """Poses on a grid told 9.29 degrees and 2.75 mm."""
    part, toolkit, fixtures = listed("oblong")
    told = SeatingSolver(part, toolkit).solve(fixtures[0])
    assert told.cage.theta_deg[0] < -12.0 and told.cage.theta_deg[1] > 12.0 and told.cage.y[0] < -3.63
    assert told.to_fields()["cage_short"] == CAGE_SHORT


@pytest.mark.prove
@pytest.mark.parametrize("name", KITS)
def test_extremes_of_many_fixtures_are_those_of_a_flood(name):
    """Nowhere short of it, at two openings. A flood steps over narrow ends, of some by many rows."""
    for rank in range(0, len(listed(name)[2]), 6):
        if reading_of(name, rank).trees[0].find_first_join(reading_of(name, rank).place) is None:
            continue
        for share in (0.6, 0.9):
            beyond = differences(name, rank, share, 2 * STEPS)
            assert beyond.min() > -0.15, (rank, share, beyond)


@pytest.mark.prove
@pytest.mark.parametrize("name", KITS)
def test_parts_come_home_from_the_extremes_of_many_fixtures(name):
    """Of every sixth, all six extremes."""
    for rank in range(0, len(listed(name)[2]), 6):
        if reading_of(name, rank).trees[0].find_first_join(reading_of(name, rank).place) is not None:
            assert end_at_home(name, rank, 0.97, list(range(6))), rank


# theta in degrees, x and y of the middle of the part's box: a way past the notched part's lowest pass, with the jaws three
# thousandths of a millimetre further open. Found by sampling with arithmetic of its own.
CHANNEL = [
    (3.00236, 46.16847, 30.79864),
    (2.40236, 46.26659, 30.72204),
    (1.80236, 46.30824, 30.65244),
    (1.50236, 46.30009, 30.62089),
    (1.20236, 46.26533, 30.5919),
    (1.05236, 46.23513, 30.57847),
    (0.98236, 46.21745, 30.57246),
    (0.91236, 46.19718, 30.56662),
    (0.84236, 46.17402, 30.56096),
    (0.77236, 46.14763, 30.55548),
    (0.71236, 46.12211, 30.55092),
    (0.60236, 46.06721, 30.54291),
    (0.51236, 46.0128, 30.5367),
    (0.38236, 45.91397, 30.52821),
    (0.24236, 45.76667, 30.51956),
]


def way() -> Any:
    """The channel's configurations."""
    opened = solved(2)[1].jaw_separation + 2.6705 + 0.003
    return np.array([(radians(theta), x, y, opened) for theta, x, y in CHANNEL])


@pytest.mark.thorough
def test_the_notched_part_leaves_its_cage_by_a_narrow_channel():
    """A peg in its hole and one below it pinch the web between them: within a degree of turn the channel is hundredths of a
    millimetre wide and narrower. A grid of half a degree steps over it, to a pass half a millimetre higher."""
    solver, fixture, told = solved(2)
    assert told.capture_opening < 2.6705
    obstacle = Obstacle(solver.workpiece, fixture, solver.toolkit.peg_radius)
    for one, two in pairwise(way()):
        assert min(obstacle.free(one + t * (two - one)) for t in np.linspace(0.0, 1.0, 12)) > 1e-4
    home = closed(obstacle, way()[0], solver.outline.arm, told.stop)
    assert np.abs(home - obstacle.start(fixture)).max() < 1e-4


@pytest.mark.prove
def test_beyond_the_channel_closing_leads_elsewhere():
    """Down, but not back."""
    solver, fixture, told = solved(2)
    obstacle = Obstacle(solver.workpiece, fixture, solver.toolkit.peg_radius)
    away = closed(obstacle, way()[-1], solver.outline.arm, told.stop)
    assert away[3] < way()[-1, 3] - 0.1
    assert away[0] < radians(0.25)
