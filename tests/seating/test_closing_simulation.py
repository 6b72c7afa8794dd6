"""Closings from where a part was put: every ending there is, ways without gaps, and starts that cannot be."""

from __future__ import annotations

from itertools import pairwise
from math import hypot, radians

import numpy as np
import pytest
from attrs import evolve

import workhold
from seating_examples import LEFT, RIGHT, Obstacle, held, solved
from workhold import Fence, Fixture, InputError, OpeningVise, Plate, Pose, Vise, Workpiece
from workhold.model.quality import FIGURE_RANKING
from workhold.model.seating import Seat
from workhold.seating.closing_simulation import ENDINGS, ClosingSimulation, simulate_closing
from workhold.seating.solver import SeatingSolver

CASE = 1


def put(fixture: Fixture, part: Workpiece, turn: float, dx: float, dy: float) -> Pose:
    """The pose of a fixture, turned about the middle of the part's box and shifted."""
    x, y = fixture.pose.apply(*part.center)
    pose = Pose(fixture.pose.theta_deg + turn, 0.0, 0.0)
    u, v = pose.apply(*part.center)
    return Pose(pose.theta_deg, float(x - u) + dx, float(y - v) + dy)


def obstacle_of(solver: SeatingSolver, fixture: Fixture, turned_over: bool = False) -> Obstacle:
    """The part and the pegs, by elementary geometry."""
    part = solver.workpiece.turned_over if turned_over else solver.workpiece
    return Obstacle(part, fixture, solver.toolkit.carriers[0].peg_radius)


def config(obstacle: Obstacle, pose: Pose, separation: float) -> np.ndarray:
    """theta, x and y of the middle of the part's box, and S."""
    x, y = pose.apply(*obstacle.center)
    return np.array([radians(pose.theta_deg), x, y, separation])


def check_way(
    solver: SeatingSolver, fixture: Fixture, played: ClosingSimulation, turned_over: bool = False
) -> None:
    """All along the way no peg is in the part, S only falls, and the part never jumps."""
    assert played.ending in ENDINGS and len(played.poses) == len(played.travels) <= 500
    obstacle = obstacle_of(solver, fixture, turned_over)
    size = solver.outline.arm
    for pose, separation in zip(played.poses, played.travels, strict=True):
        assert obstacle.free(config(obstacle, pose, separation)) > -1e-6
    assert all(b <= a + 1e-9 for a, b in pairwise(played.travels))
    configs = [config(obstacle, pose, 0.0) for pose in played.poses]
    for one, other in pairwise(configs):
        turn = abs((other[0] - one[0] + np.pi) % (2 * np.pi) - np.pi)
        assert turn * size + hypot(*(other - one)[1:3]) < 0.1 * size


@pytest.mark.thorough
def test_what_is_put_nearer_than_placing_comes_home():
    """Jaws open by nearly the capture opening, or a peg is in the way."""
    solver, fixture, told = solved(CASE)
    opening, free = 0.9 * told.capture_opening, 0
    for k in range(16):
        turn, dx, dy = 0.1 * np.cos(k), 0.2 * told.placing * np.cos(2 * k), 0.2 * told.placing * np.sin(3 * k)
        try:
            played = simulate_closing(
                solver, fixture, told.seats, put(fixture, solver.workpiece, turn, dx, dy), opening
            )
        except InputError:
            continue
        free += 1
        assert played.ending == "right" and played.seat.is_own
        assert played.travels[-1] == pytest.approx(fixture.travel, abs=1e-4)
        check_way(solver, fixture, played)
    assert free >= 3


@pytest.mark.thorough
@pytest.mark.parametrize("turned_over", [False, True])
def test_each_seat_is_where_closing_from_just_above_it_ends(turned_over):
    """Every strict seat of both sides, told by its own name."""
    solver, fixture, told = solved(CASE)
    seen = 0
    for seat in told.seats:
        if seat.mirrored != turned_over or seat.kind not in ("fixture", "corner") or seat.depth is None:
            continue
        opening = seat.difference + min(0.2 * seat.depth, 0.05)
        if opening < 0.0:
            opening = seat.difference
            with_less = evolve(fixture, travel=fixture.travel + seat.difference)
            played = simulate_closing(
                solver, moved_right(with_less, seat.difference), told.seats, seat.pose, 0.01, turned_over
            )
        else:
            played = simulate_closing(solver, fixture, told.seats, seat.pose, opening, turned_over)
        seen += 1
        assert played.seat == seat
        assert played.ending == ("right" if seat.is_own else "same place" if seat.same_place else "wrong")
        check_way(solver, fixture, played, turned_over)
    assert seen >= 2


def moved_right(fixture: Fixture, difference: float) -> Fixture:
    """The same pegs with the right jaw moved, so that a fixture's opening counts from there."""
    pegs = tuple(evolve(peg, x=peg.x + difference) if peg.carrier == RIGHT else peg for peg in fixture.pegs)
    return evolve(fixture, pegs=pegs)


@pytest.mark.parametrize(("off", "opening"), [((-78.0, -3.0, 8.0), 8.0), ((13.0, 5.0, 6.0), 9.0)])
def test_a_part_that_slips_is_seen_to_slip(off, opening):
    """Far on a few micrometres of the jaws' way, or beyond where another turn would have ended: it does not jump."""
    solver, fixture, told = solved(0)
    played = simulate_closing(solver, fixture, told.seats, put(fixture, solver.workpiece, *off), opening)
    check_way(solver, fixture, played)


def test_seats_are_told_by_place_and_side():
    """One with the same reading elsewhere, or at the same place turned over, is another."""
    solver, fixture, told = solved(CASE)
    own = next(seat for seat in told.seats if seat.is_own)
    over = evolve(own, mirrored=True, is_own=False)
    beside = evolve(own, pose=evolve(own.pose, x=own.pose.x + 1.0), is_own=False)
    assert simulate_closing(solver, fixture, [over, beside, own], fixture.pose, 0.01).seat == own
    assert simulate_closing(solver, fixture, [over, beside], fixture.pose, 0.01).ending == "elsewhere"


def test_a_part_beside_the_pegs_is_outside_and_one_between_them_at_the_stop():
    """A small square far above all pegs can be taken away; one with all four about it cannot, though none touches it."""
    square = Workpiece.from_points("square", [(0, 0), (6, 0), (6, 6), (0, 6)])
    vise = Vise(20, 2, 3)
    fixture = held(
        [(LEFT, 0.0, 0.0), (LEFT, 0.0, 20.0), (RIGHT, 40.0, 0.0), (RIGHT, 40.0, 20.0)], (0, 20, 7), 40.0
    )
    solver = SeatingSolver(square, vise)
    away = simulate_closing(solver, fixture, (), Pose(0.0, 20.0, 90.0), 5.0)
    assert (away.ending, away.seat) == ("outside", None)
    assert away.travels[-1] == pytest.approx(vise.gap) and away.poses[0] == away.poses[-1]
    larger = Workpiece.from_points("larger", [(0, 0), (8.5, 0), (8.5, 8.5), (0, 8.5)])
    about = held(
        [(LEFT, 0.0, 0.0), (LEFT, 0.0, 12.0), (RIGHT, 20.0, 0.0), (RIGHT, 20.0, 12.0)], (0, 3, 2), 20.0
    )
    shut = simulate_closing(
        SeatingSolver(larger, evolve(vise, min_gap=14.0)), about, (), Pose(0.0, 2.75, 1.75), 5.0
    )
    assert (shut.ending, shut.seat) == ("stop", None)
    assert shut.travels[-1] == pytest.approx(14.0)


def test_a_seat_that_is_not_given_is_elsewhere():
    solver, fixture, told = solved(CASE)
    played = simulate_closing(
        solver, fixture, [seat for seat in told.seats if not seat.is_own], fixture.pose, 0.01
    )
    assert (played.ending, played.seat) == ("elsewhere", None)


def test_a_loose_seat_is_known_by_its_reading():
    """A disc turns on its pegs: wherever it is let go, it ends in the loose seat that is told of all its turns."""
    disc = Workpiece.from_loops("disc", [[[-15, 0, 1], [15, 0, 1]]])
    fixture = held([(LEFT, 0, 0), (LEFT, 0, 20), (RIGHT, 25, 0), (RIGHT, 25, 20)], (0.0, 15.0, 10.0), 25.0)
    apart = 2.0 * np.sqrt(18.0**2 - 10.0**2)
    seat = Seat("loose", Pose(0.0, apart / 2, 10.0), apart, 0.0, False, False, (), (), None, False)
    fixture = evolve(moved_right(fixture, apart - 25.0), travel=apart)
    played = simulate_closing(
        SeatingSolver(disc, Vise(10, 2, 3)), fixture, (seat,), Pose(77.0, apart / 2 + 0.3, 10.4), 2.0
    )
    assert (played.ending, played.seat) == ("wrong", seat)
    assert played.travels[-1] == pytest.approx(apart, abs=1e-6)


def test_a_part_that_enters_a_peg_a_little_is_pushed_out():
    """As hands put it; the jaws stand as they stood."""
    solver, fixture, told = solved(CASE)
    enters = 0.4 * solver.toolkit.peg_radius
    played = simulate_closing(
        solver, fixture, told.seats, put(fixture, solver.workpiece, 0.0, -enters, 0.0), 3.0 + enters
    )
    assert played.travels[0] == pytest.approx(fixture.travel + 3.0 + enters)
    check_way(solver, fixture, played)


def test_starts_that_cannot_be_are_refused_in_a_sentence():
    solver, fixture, told = solved(CASE)
    with pytest.raises(InputError, match=r"^the peg in .* stands in the part there: put the part elsewhere"):
        simulate_closing(solver, fixture, told.seats, put(fixture, solver.workpiece, 0.0, -15.0, 0.0), 1.0)
    with pytest.raises(InputError, match=r"^pegs meet before the jaw or clamp gets there"):
        simulate_closing(solver, fixture, told.seats, Pose(0.0, 0.0, 500.0), told.stop - fixture.travel - 1.0)


def test_a_way_that_nobody_wants_any_more_ends():
    solver, fixture, told = solved(CASE)
    asked = iter([False, False, True])
    pose, opening = put(fixture, solver.workpiece, 0.0, 0.5, 0.0), 1.0
    played = simulate_closing(
        solver, fixture, told.seats, pose, opening, is_cancelled=lambda: next(asked, True)
    )
    assert len(played.poses) <= 4


WEDGE = Workpiece.from_points("wedge", [(0, 0), (70, 0), (25, 55)])
FENCE = Fence(pitch=20, peg_radius=3, wall_offset=10, travel=(1, 60))


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("part", "toolkit"),
    [
        (WEDGE, Plate(pitch=20, peg_radius=3, directions=["-x"], travel=(1, 40))),
        (WEDGE, Plate(pitch=20, peg_radius=3, directions=["+y"], travel=(1, 40))),
        (WEDGE, FENCE),
        (workhold.load("thin4Handle"), OpeningVise(pitch=8, columns=2, peg_radius=3)),
    ],
    ids=["along a row", "along a column", "fence", "opening vise"],
)
def test_whatever_clamps_leads_home(part, toolkit):
    """A clamp along a row and along a column, and jaws that open; the travel told is the toolkit's own."""
    result = workhold.design(part, toolkit, best=1, rank_by=FIGURE_RANKING)
    fixture, (told,) = result[0], workhold.seatings(result, with_cage=False)
    opening = 0.5 * min(told.capture_opening or 2.0, 2.0)
    if toolkit.moving.travel.most is not None and toolkit.clamping > 0:
        opening = min(opening, toolkit.moving.travel.most - fixture.travel)
    assert opening > 0.05
    played = simulate_closing(SeatingSolver(part, toolkit), fixture, told.seats, fixture.pose, opening)
    assert played.ending == "right"
    assert played.travels[0] == pytest.approx(fixture.travel + toolkit.clamping * opening)
    assert played.travels[-1] == pytest.approx(fixture.travel, abs=1e-4)
    assert played.poses[-1].theta_deg == pytest.approx(fixture.pose.theta_deg, abs=1e-4)
    assert (played.poses[-1].x, played.poses[-1].y) == pytest.approx(
        (fixture.pose.x, fixture.pose.y), abs=1e-3
    )


def test_jaws_are_opened_no_farther_than_they_go():
    """Up to the largest opening, and a clamp to the end of its stroke; by more it is refused."""
    for toolkit, farther in ((Vise(20, 2, 3, max_opening=60), 1), (FENCE, 2)):
        result = workhold.design(WEDGE, toolkit, best=1)
        fixture, solver = result[0], SeatingSolver(WEDGE, toolkit)
        most = toolkit.moving.travel.most - fixture.travel
        away = Pose(0.0, 500.0, 500.0)
        assert simulate_closing(solver, fixture, (), away, most).ending == "outside"
        with pytest.raises(InputError, match="does not open so far: open it by less"):
            simulate_closing(solver, fixture, (), away, most + farther)
