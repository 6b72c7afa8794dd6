"""The jaw force that loads ask for, between two flat jaws."""

from math import sqrt

import numpy as np
import pytest
from attrs import evolve

from friction_program import force_needed
from workhold.model.jaw_hold import JawPatch
from workhold.statics.friction import (
    FrictionHold,
    enclose_directions,
    find_least_peak_pressure,
    is_pressed_all_over,
)
from workhold.statics.patches import PressedPatch, hulls_meet

MU, WIDE, DEEP = 0.15, 100.0, 60.0


def block(grip=20.0, friction=MU, width=WIDE, opening=DEEP, stop=(), way=1.0):
    """A block of a width between jaws that are an opening apart."""
    face = JawPatch(((0.0, width, 0.0, grip),), (0,))
    return FrictionHold.from_patches(face, face, opening, friction, stop, way)


def needed(grip, *loads):
    """The force for point loads (point, force) that act together."""
    points, forces = (np.array(each, float) for each in zip(*loads, strict=True))
    return grip.compute_forces_needed(grip.compute_wrenches(points, forces).sum(axis=0)[None])[0]


@pytest.mark.parametrize("way", [(300.0, 0.0, 0.0), (-300.0, 0.0, 0.0), (0.0, 0.0, 300.0)])
def test_block_slips_at_twice_the_friction_of_a_jaw(way):
    assert needed(block(), ((50, 30, 10), way)) == pytest.approx(300 / (2 * MU), rel=1e-9)


def test_what_presses_down_rests_on_the_parallels():
    assert needed(block(), ((60, 30, 25), (0, 0, -2000.0))) == pytest.approx(0.0, abs=1e-6)


def test_push_at_the_fixed_jaw_asks_for_nothing_at_mid_height():
    assert needed(block(), ((50, 60, 10), (0, -500.0, 0))) == pytest.approx(0.0, abs=1e-6)


def test_push_at_the_moving_jaw_asks_for_itself():
    # F is what that jaw presses with, and the fixed one presses with the rest, at least nothing.
    assert needed(block(), ((50, 0, 10), (0, 500.0, 0))) == pytest.approx(500.0, rel=1e-9)


@pytest.mark.parametrize("grip", [12.0, 20.0, 40.0])
def test_part_tips_where_its_push_leaves_the_kern(grip):
    """Without friction a jaw bears a push within the middle third of its height; each moment beyond costs 6 M / g."""
    held, push, above = block(grip=grip, friction=1e-4), 100.0, 7.0
    height = grip / 2 + above
    load = np.array([50.0, 60.0, height]), np.array([0.0, -push, 0.0])
    face = [(0.0, WIDE, 0.0, grip)]
    need = needed(held, load)
    assert need == pytest.approx(force_needed(face, face, DEEP, 1e-4, [load]), rel=1e-3)
    # With the parallels' help it is at most what both jaws alone ask for: (2 F + push) g / 6 = push * above.
    assert need <= max((push * above - push * grip / 6) / (grip / 3), 0.0) * (1 + 1e-6)


def test_cells_turn_as_the_integral_does():
    """The moment of the friction of a rectangle about its middle, by cells and by a fine sum."""
    for width, height in ((100.0, 20.0), (30.0, 30.0), (12.0, 60.0)):
        cells = PressedPatch(JawPatch(((0.0, width, 0.0, height),), ())).cells
        arms = np.hypot(*(cells.centre - [width / 2, height / 2]).T)
        x, z = (np.arange(2000) + 0.5) / 2000 * width, (np.arange(1000) + 0.5) / 1000 * height
        exact = np.hypot(x[:, None] - width / 2, z - height / 2).mean() * width * height
        assert (arms * cells.area).sum() == pytest.approx(exact, rel=0.03)


RNG = np.random.default_rng(7)
RANDOM = [
    (
        RNG.uniform(5, 40),
        RNG.uniform(20, 150),
        RNG.uniform(15, 120),
        RNG.uniform(0.05, 0.4),
        RNG.normal(size=3) * 300,
        RNG.uniform(0, 1, size=3),
    )
    for _ in range(24)
]


@pytest.mark.parametrize("case", RANDOM[:8])
def test_more_of_everything_that_holds_never_asks_for_more(case):
    height, width, opening, friction, force, share = case
    point = share * [width, opening, height]
    held = block(height, friction, width, opening)
    need = needed(held, (point, force))
    assert needed(held, (point, 2 * force)) == pytest.approx(2 * need, rel=1e-7)
    assert needed(evolve(held, friction=1.2 * friction), (point, force)) <= need * (1 + 1e-7) + 1e-9
    mirrored = needed(held, (point * [-1, 1, 1] + [width, 0, 0], force * [-1, 1, 1]))
    assert mirrored == pytest.approx(need, rel=1e-7, abs=1e-6)
    wider = block(height, friction, width * 1.3, opening)
    assert needed(wider, (point + np.array([0.15 * width, 0, 0]), force)) <= need * (1 + 1e-7) + 1e-6
    with_stop = block(
        height, friction, width, opening, [(0, y, z) for y in (0, opening) for z in (0, height)]
    )
    assert needed(with_stop, (point, force)) <= need * (1 + 1e-7) + 1e-6


@pytest.mark.thorough
@pytest.mark.parametrize("case", RANDOM)
def test_force_is_that_of_another_program(case):
    height, width, opening, friction, force, share = case
    face, load = [(0.0, width, 0.0, height)], (share * [width, opening, 1.3 * height], force)
    need = needed(block(height, friction, width, opening), load)
    other = force_needed(face, face, opening, friction, [load])
    assert need == pytest.approx(other, rel=0.03, abs=1.0)


@pytest.mark.thorough
@pytest.mark.parametrize("case", RANDOM[:6])
def test_force_on_a_step_is_that_of_another_program(case):
    height, width, opening, friction, force, share = case
    fixed = [(0.0, width / 3, 0.0, height), (width / 2, width, 0.0, 0.6 * height)]
    moving = [(0.1 * width, 0.9 * width, 0.2 * height, height)]
    held = FrictionHold.from_patches(
        JawPatch(tuple(fixed), ()), JawPatch(tuple(moving), ()), opening, friction
    )
    load = share * [width, opening, height], force
    assert needed(held, load) == pytest.approx(
        force_needed(fixed, moving, opening, friction, [load]), rel=0.03, abs=1.0
    )


def test_disc_held_along_two_lines_turns_about_them():
    line = JawPatch(((0.0, 0.0, 0.0, 20.0),), (0,))
    held = FrictionHold.from_patches(line, line, 50.0, MU)
    assert needed(held, ((0, 25, 10), (0, 0, 100.0))) == pytest.approx(100 / (2 * MU), rel=1e-9)
    # About the upright axis through the disc both lines slide at half the opening.
    turning = needed(held, ((10, 25, 10), (0, 100.0, 0)), ((-10, 25, 10), (0, -100.0, 0)))
    assert turning == pytest.approx(2000 / (2 * MU * 25), rel=1e-9)
    # About the line across the jaws, friction along the jaws at two heights turns it back.
    assert needed(held, ((30, 25, 10), (0, 0, 100.0)), ((-30, 25, 10), (0, 0, -100.0))) is not None


def test_jaws_that_cannot_press_all_over():
    wide, short = JawPatch(((0.0, 60.0, 0.0, 20.0),), ()), JawPatch(((0.0, 22.0, 0.0, 20.0),), ())
    assert not is_pressed_all_over(wide, short)
    assert is_pressed_all_over(wide, JawPatch(((0.0, 40.0, 0.0, 20.0),), ()))
    assert find_least_peak_pressure(wide, short, 1.0) is None


def test_pressure_is_even_where_both_faces_are_alike():
    face = JawPatch(((0.0, 50.0, 0.0, 20.0),), ())
    assert find_least_peak_pressure(face, face, 3000.0) == pytest.approx(3.0, rel=1e-9)
    # Off the middle by a tenth of the width, the edge bears 1.6 times the mean.
    moved = JawPatch(((10.0, 60.0, 0.0, 20.0),), ())
    assert find_least_peak_pressure(face, moved, 3000.0) == pytest.approx(4.8, rel=1e-6)


def test_corners_about_a_range_of_directions_hold_all_of_them():
    for low, high in ((0.0, 2 * np.pi), (0.3, 0.9), (-1.0, 2.0)):
        corners = enclose_directions(low, high)
        for turn in np.linspace(low, high, 50):
            way = np.array([np.cos(turn), np.sin(turn)])
            for normal in np.linspace(0, 2 * np.pi, 64):
                facing = np.array([np.cos(normal), np.sin(normal)])
                assert (corners @ facing).max() >= way @ facing - 1e-12
        assert np.hypot(*corners.T).max() <= 1.005


@pytest.mark.parametrize(
    ("one", "other", "meet"),
    [
        ([(0, 0), (2, 0), (0, 2)], [(1.5, 1.5), (1.5, 3)], False),
        ([(0, 0), (2, 0), (0, 2)], [(0.5, 0.5), (1.5, 3)], True),
        ([(0, 0), (1, 0)], [(2, 0), (3, 0)], False),
        ([(0, 0), (2, 0)], [(1, -1), (1, 1)], True),
        ([(0, 0)], [(0, 0)], True),
        ([(0, 0)], [(sqrt(2), 0)], False),
    ],
)
def test_hulls_meet(one, other, meet):
    first, second = (np.array(points, float) for points in (one, other))
    assert hulls_meet(first, second, 1e-9) is meet
    assert hulls_meet(second, first, 1e-9) is meet
