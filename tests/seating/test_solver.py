"""Seating: values of another method, the theorems, what must not change, and parts whose seats are known beforehand."""

from __future__ import annotations

from math import cos, degrees, hypot, radians, sin, sqrt

import numpy as np
import pytest

import workhold
from seating_examples import (
    LEFT,
    RIGHT,
    SAMPLED,
    Obstacle,
    case_fixture,
    closed,
    equilibria_of,
    held,
    moved,
    solved,
)
from workhold import Fixture, Peg, Pose, Vise, Workpiece
from workhold.model.seating import Seating
from workhold.seating.join_tree import JoinTree
from workhold.seating.pattern import Pattern
from workhold.seating.solver import SeatingSolver

# Digits of the sampled values.
DIGITS = 6e-7
CASES = range(len(SAMPLED))


def figures(told: Seating) -> tuple[float, ...]:
    """What must not depend on how the drawing and the pegs lie."""
    known = (
        told.capture_opening,
        told.way_out,
        told.room_factor,
        told.sticking_friction,
        told.find_least_reading(),
    )
    return tuple(-1.0 if value is None else value for value in known)


def separations(told: Seating, mirrored: bool) -> list[float]:
    """Jaw separations of one side's seats."""
    return [seat.jaw_separation for seat in told.seats if seat.mirrored == mirrored]


@pytest.mark.parametrize("number", CASES)
def test_values_are_those_of_another_method(number):
    """Capture opening and pass, forces, friction, and every strict seat that sampling is sure of."""
    case, (_, _, told) = SAMPLED[number], solved(number)
    assert told.room_factor == pytest.approx(case["room_factor"], abs=DIGITS)
    assert told.sticking_friction == pytest.approx(case["sticking_friction"], abs=6e-6)
    assert told.capture_opening == pytest.approx(case["capture_opening"], abs=DIGITS)
    assert told.lowest_pass.jaw_separation == pytest.approx(case["pass_separation"], abs=DIGITS)
    for name, (low, high) in (case["cage"] or {}).items():
        least, most = getattr(told.cage, name)
        # Rounded to three decimals there.
        assert least <= low + 1e-3 and most >= high - 1e-3, name
    for kind, theta, separation, mirrored in case["seats"]:
        near = [
            seat
            for seat in told.seats
            if abs(seat.jaw_separation - separation) < 2e-6
            and abs((seat.pose.theta_deg - theta + 180.0) % 360.0 - 180.0) < 2e-5
            and (seat.kind, seat.mirrored) == (kind, mirrored)
        ]
        assert len(near) == 1, (kind, theta, separation)


@pytest.mark.parametrize("number", CASES)
def test_passes_and_seats_are_equilibria(number):
    """Forces balance to 1e-9 with the jaw's; a pass has two or three contacts and is above its seats."""
    solver, fixture, _ = solved(number)
    pattern = Pattern.from_fixture(fixture, solver.toolkit)
    part = solver.workpiece
    obstacle = Obstacle(part, fixture, solver.toolkit.peg_radius)
    closing = solver.make_closing(pattern, False)
    found = equilibria_of(closing)
    for row in [*found.seats, *found.passes]:
        config = row[[0, 1, 2, 3]]
        near = obstacle.near(config, np.inf)
        assert min(d for d, _ in near) > -1e-7
        slopes = np.array([g for d, g in near if abs(d) < 1e-7])
        # The slope of S is a sum of the slopes of clearances, with forces above 0.
        forces, rest = nonnegative(slopes.T, np.array([0.0, 0.0, 0.0, 1.0]))
        assert rest < 1e-9
        assert forces.sum() == pytest.approx(row[13:17].sum(), abs=1e-6)
    assert {int(row[4]) for row in found.passes} <= {2, 3}
    tree = JoinTree.from_equilibria(found, closing)
    for row, places in zip(tree.passes, tree.joined.tolist(), strict=True):
        assert all(row[3] > tree.seats[place, 3] for place in places if 0 <= place < len(tree.seats))


def nonnegative(matrix, target):
    """The least squares solution without negative numbers, and how far it is off."""
    from scipy.optimize import nnls

    return nnls(matrix, target)


@pytest.mark.parametrize("number", CASES)
def test_figures_keep_their_order(number):
    """The way out is no nearer than the capture opening, placing no farther than the pass, and room opens by the forces."""
    solver, fixture, told = solved(number)
    assert told.way_out is None or told.way_out >= told.capture_opening - 1e-12
    assert told.room_factor > 0.0
    top, own = told.lowest_pass.pose, fixture.pose
    center = solver.workpiece.center
    (x, y), (u, v) = top.apply(*center), own.apply(*center)
    turn = abs((top.theta_deg - own.theta_deg + 180.0) % 360.0 - 180.0)
    assert told.placing <= hypot(x - u, y - v) + 2.0 * solver.outline.arm * sin(radians(turn) / 2.0) + 1e-9
    lows, highs = zip(told.cage.theta_deg, told.cage.x, told.cage.y, strict=True)
    assert max(lows) <= 0.0 <= min(highs)
    assert sum(seat.is_own for seat in told.seats) == 1
    assert [seat.jaw_separation for seat in told.seats] == sorted(seat.jaw_separation for seat in told.seats)
    assert told.seats[0].jaw_separation > told.stop


def walk(
    number: int, seed: int, share: float, steps: int
) -> tuple[Obstacle, np.ndarray, np.ndarray, float, float]:
    """A random walk from a seat through free configurations below a share of the capture opening."""
    solver, fixture, told = solved(number)
    obstacle = Obstacle(solver.workpiece, fixture, solver.toolkit.peg_radius)
    size, seat = solver.outline.arm, obstacle.start(fixture)
    generator = np.random.default_rng(seed)
    # As far down as the seat and as far up as the share.
    config, top = seat.copy(), seat[3] + share * told.capture_opening
    config[3] = seat[3] + 0.5 * share * told.capture_opening
    reach = 0.3 * told.drop_room
    for _ in range(steps):
        step = generator.normal(size=4) * reach * np.array([1.0 / size, 1.0, 1.0, 1.0])
        after = config + step
        if after[3] < top and obstacle.free(after) >= 0.0:
            config = after
    return obstacle, config, seat, size, told.stop


def ends_at_home(number: int, seed: int, share: float, steps: int) -> bool:
    """Whether closing by linear programs of another hand leads home from the end of a walk."""
    obstacle, config, seat, size, stop = walk(number, seed, share, steps)
    end = closed(obstacle, config, size, stop)
    return bool(
        abs(end[3] - seat[3]) < 1e-4 and abs(end[0] - seat[0]) * size + hypot(*(end - seat)[1:3]) < 0.02
    )


@pytest.mark.thorough
@pytest.mark.parametrize("number", CASES)
def test_what_is_let_go_in_the_cage_comes_home(number):
    """Inside the cage nothing can go wrong: random walks below the pass do not leave it, and closing leads home."""
    assert all(ends_at_home(number, seed, 0.97, 150) for seed in range(2))


@pytest.mark.prove
@pytest.mark.parametrize("number", CASES)
def test_a_thousand_walks_come_home(number):
    assert all(ends_at_home(number, seed, 0.99, 400) for seed in range(400))


@pytest.mark.parametrize("number", CASES)
def test_beyond_the_pass_lies_another_place(number):
    """Both ways down from the pass end lower, one in the seat and one elsewhere."""
    solver, fixture, told = solved(number)
    pattern = Pattern.from_fixture(fixture, solver.toolkit)
    tree = solver.find_join_trees(pattern)[0]
    place = next(k for k, row in enumerate(tree.seats) if abs(row[3] - fixture.travel) < 1e-6)
    join = tree.find_first_join(place)
    assert join.separation == pytest.approx(told.lowest_pass.jaw_separation, abs=1e-12)
    assert place in join.places and len(set(join.places)) == 2
    # No pass below it leads from the seat to elsewhere.
    lower = tree.joined[tree.passes[:, 3] < join.separation]
    assert all(one == [place, place] for one in lower.tolist() if place in one)


@pytest.mark.parametrize(
    ("order", "half_turn", "shift"),
    [
        ([2, 0, 3, 1], False, (0.0, 0.0)),
        ([0, 1, 2, 3], False, (8.0, -24.0)),
        ([0, 1, 2, 3], True, (90.0, 40.0)),
    ],
    ids=["renamed", "moved", "half turn"],
)
def test_pegs_named_moved_or_turned_say_the_same(order, half_turn, shift):
    solver, fixture, told = solved(1)
    other = SeatingSolver(solver.workpiece, solver.toolkit).solve(
        moved(fixture, order, half_turn, shift), with_cage=False
    )
    assert figures(other) == pytest.approx(figures(told), abs=1e-8)
    for mirrored in (False, True):
        assert separations(other, mirrored) == pytest.approx(separations(told, mirrored), abs=1e-8)
    assert [seat.kind for seat in other.seats] == [seat.kind for seat in told.seats]


def test_a_solved_pattern_answers_for_all_its_fixtures():
    """Moved and renamed pegs are the pattern that is known already; contacts are told by their own names."""
    solver, fixture, told = solved(1)
    again = moved(fixture, [1, 2, 3, 0], False, (16.0, 8.0))
    before = len(solver.solved)
    other = solver.solve(again, with_cage=False)
    assert len(solver.solved) == before
    assert figures(other) == pytest.approx(figures(told), abs=1e-9)
    own, mine = (next(seat for seat in one.seats if seat.is_own) for one in (told, other))
    assert {(contact.face, fixture.pegs[contact.peg].x + 16.0) for contact in own.contacts} == {
        (contact.face, again.pegs[contact.peg].x) for contact in mine.contacts
    }


def test_another_drawing_of_the_part_says_the_same():
    """The part turned and moved in its own frame, and turned over together with the pegs."""
    solver, fixture, told = solved(1)
    part, vise = solver.workpiece, solver.toolkit
    drawn = Pose(35.0, 12.0, -7.0)
    lying = part.apply_pose(drawn)
    c, s = cos(radians(-35.0)), sin(radians(-35.0))
    theta = radians(fixture.pose.theta_deg - 35.0)
    x, y = -(c * 12.0 + s * 7.0), -(s * 12.0 - c * 7.0)
    u, v = fixture.pose.apply(x, y)
    same = Fixture("I", fixture.pegs, Pose(degrees(theta), float(u), float(v)), fixture.travel, {})
    other = SeatingSolver(lying, vise).solve(same, with_cage=False)
    assert figures(other) == pytest.approx(figures(told), abs=1e-8)
    # Turned over about a line along the jaws' way, so that the jaws stay where they are: y to -y.
    pegs = tuple(Peg(peg.carrier, 0, 0, peg.x, -peg.y, 0, 0.0) for peg in fixture.pegs)
    flipped = Pose(180.0 - fixture.pose.theta_deg, fixture.pose.x, -fixture.pose.y)
    over = SeatingSolver(part.turned_over, vise).solve(
        Fixture("I", pegs, flipped, fixture.travel, {}), with_cage=False
    )
    assert figures(over) == pytest.approx(figures(told), abs=1e-8)
    for mirrored in (False, True):
        assert separations(over, mirrored) == pytest.approx(separations(told, mirrored), abs=1e-8)


def seats_of(part: Workpiece, pegs: list[tuple[str, float, float]], vise: Vise) -> JoinTree:
    """What can be reached from where, on pegs at separation 0."""
    solver = SeatingSolver(part, vise)
    return solver.find_join_trees(Pattern.from_fixture(held(pegs, (0.0, 0.0, 0.0), 0.0), vise))[0]


def test_a_disc_is_nowhere_located():
    """Whatever the pegs, a disc turns on them: every seat is loose."""
    disc = Workpiece.from_loops("disc", [[[-15, 0, 1], [15, 0, 1]]])
    tree = seats_of(disc, [(LEFT, 0, 0), (LEFT, 0, 20), (RIGHT, 10, 0), (RIGHT, 10, 20)], Vise(10, 2, 3))
    assert len(tree.seats) == 0
    assert len(tree.loose) > 0
    # Between two and two pegs, its centre midway in height and 15 + 3 from all four.
    apart = 2.0 * sqrt(18.0**2 - 10.0**2)
    assert any(row[3] == pytest.approx(apart - 10.0, abs=1e-9) for row in tree.loose)


def test_a_rectangle_on_level_pegs_slides():
    plate = Workpiece.from_loops("plate", [[[0, 0, 0], [40, 0, 0], [40, 60, 0], [0, 60, 0]]])
    pegs = [(LEFT, 0.0, 0.0), (LEFT, 0.0, 20.0), (RIGHT, 10.0, 0.0), (RIGHT, 10.0, 20.0)]
    solver = SeatingSolver(plate, Vise(10, 2, 3))
    pattern = Pattern.from_fixture(held(pegs, (0.0, 0.0, 0.0), 0.0), solver.toolkit)
    tree = solver.find_join_trees(pattern)[0]
    square = [row for row in (*tree.loose, *tree.slack) if abs(row[3] - 36.0) < 1e-9]
    # Both ways up: the part is its own half turn. All four pegs touch.
    assert sorted(round(degrees(row[0])) % 360 for row in square) == [0, 180]
    assert all(row[4] == 4.0 for row in square)


def pinwheel(size: float = 30.0, arm: float = 12.0) -> Workpiece:
    """A square with a step on each side, the same after a quarter turn and unlike its mirror image."""
    corners: list[tuple[float, float]] = []
    for k in range(4):
        c, s = round(cos(k * np.pi / 2)), round(sin(k * np.pi / 2))
        for x, y in (
            (size / 2, -size / 2),
            (size / 2, 3.0),
            (size / 2 + arm, 3.0),
            (size / 2 + arm, size / 2),
        ):
            corners.append((c * x - s * y, s * x + c * y))
    return Workpiece.from_points("pinwheel", corners)


def test_a_square_pinwheel_sits_four_ways_at_one_reading():
    """Seats come in fours of one separation, which no reading tells apart; turned over it is another part."""
    part, vise = pinwheel(), Vise(20, 2, 3)
    fixture = workhold.design(part, vise, types="I", best=1)[0]
    told = SeatingSolver(part, vise).solve(fixture, with_cage=False)
    alike = [seat for seat in told.seats if abs(seat.difference) < 1e-7]
    assert len(alike) >= 4 and all(seat.kind == "fixture" for seat in alike)
    turns = sorted(
        (seat.pose.theta_deg - fixture.pose.theta_deg) % 360.0 for seat in alike if not seat.mirrored
    )
    assert {round(turn) % 90 for turn in turns} == {0}
    assert sum(seat.same_place for seat in told.seats) >= 4
    assert not any(seat.same_place and seat.mirrored for seat in told.seats)


def test_all_fixtures_of_a_pattern_are_among_its_seats():
    """And no seat on four faces is missing from the complete list, each fixture also found after its half turn."""
    wedge = Workpiece.from_loops("wedge", [[[0, 0, 0], [70, 0, 0], [25, 55, 0]]])
    result = workhold.design(wedge, Vise(pitch=20, columns=2, peg_radius=3), types="I")
    by_pattern: dict[object, list[Fixture]] = {}
    for fixture in result:
        by_pattern.setdefault(Pattern.from_fixture(fixture, result.toolkit).make_key(), []).append(fixture)
    solver = SeatingSolver(wedge, result.toolkit)
    for fixtures in list(by_pattern.values())[:6]:
        turned = Pattern.from_fixture(
            moved(fixtures[0], [0, 1, 2, 3], True, (0.0, 0.0)), result.toolkit
        ).make_key()
        told = [solver.solve(fixture, with_cage=False) for fixture in fixtures]
        assert all(sum(seat.is_own for seat in one.seats) == 1 for one in told)
        there = [seat for seat in told[0].seats if seat.kind == "fixture" and not seat.mirrored]
        assert len(there) == len(fixtures) + len(by_pattern.get(turned, ()))


def test_case_fixtures_have_a_part():
    """The data tell what they are of."""
    assert [case_fixture(case)[0].name for case in SAMPLED] == ["widget", "widget", "notch"]


def test_three_parallel_forces_are_found():
    """A round on one end of a bar, pressed beside its flat: the two pegs of a jaw have parallel normals at the seat or
    pass."""
    bar = Workpiece.from_loops(
        "bar", [[[0, 0, 0], [60, 0, 0], [60, 12, 0], [50, 12, 0], [34, 12, -0.5], [0, 12, 0]]]
    )
    vise = Vise(10, 2, 2)
    pegs = [(LEFT, 0.0, 0.0), (LEFT, 0.0, 30.0), (RIGHT, 10.0, 10.0), (RIGHT, 20.0, 20.0)]
    solver = SeatingSolver(bar, vise)
    pattern = Pattern.from_fixture(held(pegs, (0.0, 0.0, 0.0), 0.0), vise)
    closing = solver.make_closing(pattern, False)
    found = equilibria_of(closing)
    rows = [row for row in [*found.seats, *found.passes] if row[4] == 3.0]
    obstacle = Obstacle(bar, held(pegs, (0.0, 0.0, 0.0), 0.0), 2.0)
    parallel = []
    for row in rows:
        normals = np.array([g[1:3] for d, g in obstacle.near(row[[0, 1, 2, 3]], 1e-6) if abs(d) < 1e-7])
        cross = normals[:, 0] * normals[0, 1] - normals[:, 1] * normals[0, 0]
        parallel.append(len(normals) == 3 and np.abs(cross).max() < 1e-7)
    assert any(parallel)
    # S is stationary along the part's only freedom: a step along it changes S by its square.
    for row in (row for row, level in zip(rows, parallel, strict=True) if level):
        slopes = np.array([g for d, g in obstacle.near(row[[0, 1, 2, 3]], 1e-6) if abs(d) < 1e-7])
        assert nonnegative(slopes.T, np.array([0.0, 0.0, 0.0, 1.0]))[1] < 1e-9


@pytest.mark.parametrize("number", CASES)
def test_every_seat_lies_free_where_its_pose_says(number):
    """Also turned over: pegs that touch are on the outline, no other is in the part, and none is below the stop."""
    solver, fixture, told = solved(number)
    for seat in told.seats:
        part = solver.workpiece.turned_over if seat.mirrored else solver.workpiece
        obstacle = Obstacle(part, fixture, solver.toolkit.peg_radius)
        x, y = seat.pose.apply(*part.center)
        config = np.array([radians(seat.pose.theta_deg), x, y, seat.jaw_separation])
        assert obstacle.free(config) > -1e-6
        if seat.kind != "unsettled":
            assert sum(abs(d) < 1e-6 for d, _ in obstacle.near(config, 1e-3)) >= len(seat.contacts) >= 2
    rights, lefts = (
        obstacle.pegs[obstacle.right == 1.0, 0] + told.stop,
        obstacle.pegs[obstacle.right == 0.0, 0],
    )
    assert min(b - a for a in lefts for b in rights) == pytest.approx(solver.toolkit.gap, abs=1e-9)


@pytest.mark.parametrize("number", CASES)
def test_curved_seats_hold_and_passes_let_go(number):
    """Beside a seat of three contacts closing leads back; beside a pass down, but where a flat face begins."""
    solver, fixture, _ = solved(number)
    pattern = Pattern.from_fixture(fixture, solver.toolkit)
    closing = solver.make_closing(pattern, False)
    found = equilibria_of(closing)
    for rows, holds in ((found.seats, True), (found.passes, False)):
        for row in (row for row in rows if row[4] < 4.0):
            motion = np.append(row[18:21], 0.0)
            step = 0.01 * motion / (abs(motion[0]) * closing.size + hypot(*motion[1:3]))
            ended, _ = closing.close_from(row[:4] + np.stack([step, -step]), 0.005)
            rises = ended[:, 3] - row[3]
            assert (np.abs(rises) < 1e-6).all() if holds else rises.min() < -1e-7 and rises.max() < 1e-9


def test_a_part_like_its_mirror_image_covers_its_place_turned_over():
    kite = Workpiece.from_loops("kite", [[[0, 0, 0], [70, 30, 0], [0, 60, 0]]])
    vise = Vise(20, 2, 3)
    fixture = workhold.design(kite, vise, types="I", best=1)[0]
    told = SeatingSolver(kite, vise).solve(fixture, with_cage=False)
    assert any(seat.mirrored and seat.same_place and abs(seat.difference) < 1e-7 for seat in told.seats)
