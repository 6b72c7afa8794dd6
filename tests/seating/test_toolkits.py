"""Seating of opening vises, plates and fences: the same theorems, by other arithmetic, and what must not change."""

from __future__ import annotations

from functools import cache
from math import hypot

import numpy as np
import pytest
from attrs import evolve

import workhold
from seating_examples import Obstacle, closed, equilibria_of
from workhold import Fence, Fixture, InputError, OpeningVise, Peg, Plate, Pose, Result, Vise, Workpiece
from workhold.fixels.toolkit import Toolkit
from workhold.kernels.base.distance import measure_outline_distances
from workhold.kernels.seating.columns import CONTACTS, SEPARATION
from workhold.model.seating import Seating
from workhold.seating.closing_simulation import simulate_closing
from workhold.seating.contact_forces import find_contact_normals
from workhold.seating.join_tree import JoinTree
from workhold.seating.pattern import ClosingFrame, Pattern
from workhold.seating.solver import SeatingSolver
from workhold.seating.wall_equilibria import WallEquilibria

WEDGE = Workpiece.from_loops("wedge", [[[0, 0, 0], [70, 0, 0], [25, 55, 0]]])
HOLED = Workpiece.from_loops(
    "holed",
    [[[0, 0, 0], [80, 0, 0], [80, 70, 0], [0, 70, 0]], [[20, 20, 0], [60, 14, 0], [62, 50, 0], [26, 52, 0]]],
)
ROUNDED = Workpiece.from_loops(
    "rounded",
    [[[0, 0, 0], [60, 8, 0.3], [60, 40, 0], [30, 50, 0], [0, 30, 0]], [[22, 22, -1.0], [38, 26, -1.0]]],
)
QUAD = Workpiece.from_loops("quad", [[[0, 0, 0], [70, 0, 0], [62, 30, 0], [12, 48, 0]]])
ALONG, DOWN = ({"pitch": 20, "peg_radius": 3, "wall_offset": 10, "directions": [way]} for way in ("+x", "-y"))
KITS: dict[str, tuple[Workpiece, Toolkit]] = {
    "along a fence": (QUAD, Fence(**ALONG, clamp_radius=4)),
    "onto a fence": (ROUNDED, Fence(**DOWN)),
    "opening": (HOLED, OpeningVise(pitch=15, columns=1, peg_radius=3, min_gap=6)),
    "left": (WEDGE, Plate(pitch=20, peg_radius=3, clamp_radius=5, directions=["-x"])),
    "right": (ROUNDED, Plate(pitch=20, peg_radius=3, clamp_radius=4, directions=["+x"])),
    "down": (ROUNDED, Plate(pitch=20, peg_radius=4, clamp_radius=2, directions=["-y"])),
    "up": (WEDGE, Plate(pitch=20, peg_radius=3, directions=["+y"], travel=(5, 40))),
}


@cache
def listed(name: str) -> tuple[Result, SeatingSolver]:
    """All fixtures of a part in a toolkit, and what solves their patterns."""
    part, toolkit = KITS[name]
    return workhold.design(part, toolkit), SeatingSolver(part, toolkit)


@cache
def told_of(name: str, rank: int) -> Seating:
    """The seating of a fixture, with its cage."""
    result, solver = listed(name)
    return solver.solve(result[rank])


@pytest.mark.thinned(7)
@pytest.mark.parametrize("name", KITS)
def test_all_fixtures_of_a_pattern_are_among_its_seats(name):
    """With S to 1e-6, each in its own pose; and no seat on four faces is missing from the complete list."""
    result, solver = listed(name)
    by_pattern: dict[object, list[Fixture]] = {}
    for fixture in result:
        by_pattern.setdefault(Pattern.from_fixture(fixture, result.toolkit).make_key(), []).append(fixture)
    most = sorted(by_pattern.values(), key=len)[-2:]
    for fixtures in most:
        pattern = Pattern.from_fixture(fixtures[0], result.toolkit)
        turned = (
            evolve(pattern, pegs=-pattern.pegs, right=1 - pattern.right).make_key()
            if name == "opening"
            else None
        )
        told = [solver.solve(fixture, with_cage=False) for fixture in fixtures]
        for fixture, one in zip(fixtures, told, strict=True):
            [own] = [seat for seat in one.seats if seat.is_own]
            assert (
                own.jaw_separation == pytest.approx(fixture.travel, abs=1e-6) and abs(own.difference) < 1e-9
            )
            assert abs((own.pose.theta_deg - fixture.pose.theta_deg + 180.0) % 360.0 - 180.0) < 1e-6
            assert (own.pose.x, own.pose.y) == pytest.approx((fixture.pose.x, fixture.pose.y), abs=1e-6)
            faces = [contact.face for contact in sorted(own.contacts, key=lambda c: c.peg)]
            told_faces = zip(faces, fixture.pegs, strict=True)
            assert all(face == peg.face for face, peg in told_faces if not peg.is_on_wall)
        # Those that hold by less than a micrometre of opening are fixtures all the same.
        touches = solver.make_closing(pattern, False).boundary.touches
        there = [
            row
            for row in solver.find_join_trees(pattern)[0].seats
            if len(set(row[5:9])) == 4
            and not any(touches[int(k)].corner for k in row[9:13] if k < len(touches))
        ]
        assert len(there) == len(fixtures) + len(by_pattern.get(turned, ()))


@pytest.mark.thorough
@pytest.mark.parametrize("name", KITS)
def test_every_seat_lies_free_where_its_pose_says(name):
    """Told from the outline, in the toolkit's own frame and with each peg's own radius: what touches does, and forces
    balance the clamp's."""
    result, _ = listed(name)
    fixture, told = result[0], told_of(name, 0)
    assert len(told.seats) > 1 and any(seat.mirrored for seat in told.seats)
    # What is reached with what moves open by a millimetre.
    rises = [told.clamping * (seat.jaw_separation - fixture.travel) for seat in told.seats if seat.is_wrong]
    assert len(told.list_wrong_seats(1.0)) == sum(rise < 1.0 for rise in rises)
    for seat in told.seats:
        assert seat.difference == pytest.approx(seat.jaw_separation - fixture.travel, abs=1e-9)
        part = result.workpiece.turned_over if seat.mirrored else result.workpiece
        obstacle = Obstacle.about(part, fixture, result.toolkit)
        config = np.array(
            [np.radians(seat.pose.theta_deg), *seat.pose.apply(*part.center), seat.jaw_separation]
        )
        near = obstacle.near(config, np.inf)
        assert min(d for d, _ in near) > -1e-6
        slopes = np.array([g for d, g in near if abs(d) < 1e-6])
        assert len(slopes) >= len(seat.contacts) >= 2
        from scipy.optimize import nnls

        if seat.kind != "unsettled":
            assert nnls(slopes.T, np.array([0.0, 0.0, 0.0, float(obstacle.clamping)]))[1] < 1e-5


def comes_home(name: str, rank: int, seed: int, share: float, steps: int) -> bool:
    """Whether a walk through free configurations below a share of the capture opening, and then closing by linear programs
    of another hand, ends in the fixture's pose."""
    result, solver = listed(name)
    fixture, told = result[rank], told_of(name, rank)
    obstacle = Obstacle.about(result.workpiece, fixture, result.toolkit)
    size, seat, sign = solver.outline.arm, obstacle.start(fixture), obstacle.clamping
    generator, config = np.random.default_rng(seed), seat.copy()
    config[3] += 0.5 * sign * share * told.capture_opening
    # So short that no step leaps over what bounds the cage.
    step = min(0.3 * told.drop_room, 0.1)
    for _ in range(steps):
        after = config + generator.normal(size=4) * step * np.array([1.0 / size, 1.0, 1.0, 1.0])
        if sign * (after[3] - seat[3]) < share * told.capture_opening and obstacle.free(after) >= 0.0:
            config = after
    end = closed(obstacle, config, size, -np.inf if told.stop is None else told.stop)
    return bool(
        abs(end[3] - seat[3]) < 1e-4 and abs(end[0] - seat[0]) * size + hypot(*(end - seat)[1:3]) < 0.02
    )


@pytest.mark.thorough
@pytest.mark.thinned(3)
@pytest.mark.parametrize("name", KITS)
def test_what_is_let_go_in_the_cage_comes_home(name):
    assert comes_home(name, 0, 0, 0.97, 100)


@pytest.mark.prove
@pytest.mark.parametrize("name", KITS)
@pytest.mark.parametrize("rank", range(4))
def test_hundreds_of_walks_come_home(name, rank):
    if told_of(name, rank).capture_opening is not None:
        assert all(comes_home(name, rank, seed, 0.99, 300) for seed in range(50))


@pytest.mark.thorough
@pytest.mark.parametrize("name", KITS)
def test_the_cage_is_told_in_the_frame_of_the_toolkit(name):
    """Closing from its corners of y and of the turn shows which is which: the pass lies in it, as does the pose."""
    result, _ = listed(name)
    fixture, told, center = result[0], told_of(name, 0), result.workpiece.center
    (x, y), (u, v) = told.lowest_pass.pose.apply(*center), fixture.pose.apply(*center)
    for (low, high), at in zip((told.cage.x, told.cage.y), (x - u, y - v), strict=True):
        assert low - 1e-9 <= min(0.0, at) and max(0.0, at) <= high + 1e-9
    assert told.way_out is None or told.way_out >= told.capture_opening - 1e-12
    rise = told.lowest_pass.jaw_separation - fixture.travel
    assert rise == pytest.approx(told.clamping * told.capture_opening, abs=1e-9)


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


def differences(told: Seating, mirrored: bool) -> list[float]:
    """How much further open each seat of one side is than the fixture's, in order."""
    return sorted(told.clamping * seat.difference for seat in told.seats if seat.mirrored == mirrored)


def same(one: Seating, other: Seating) -> None:
    """Whether two seatings tell the same."""
    assert figures(one) == pytest.approx(figures(other), abs=1e-8)
    for mirrored in (False, True):
        assert differences(one, mirrored) == pytest.approx(differences(other, mirrored), abs=1e-8)


def quarter_turned(fixture: Fixture, names: dict[str, str], quarters: int) -> Fixture:
    """A fixture and its plate turned by quarters."""
    c, s = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarters % 4]
    pegs = tuple(
        Peg(
            names.get(peg.carrier, peg.carrier),
            0,
            0,
            c * peg.x - s * peg.y,
            s * peg.x + c * peg.y,
            peg.face,
            0.0,
        )
        for peg in fixture.pegs
    )
    at = fixture.pose
    pose = Pose(at.theta_deg + 90.0 * quarters, c * at.x - s * at.y, s * at.x + c * at.y)
    return Fixture("clamp", pegs, pose, fixture.travel, {})


@pytest.mark.parametrize(("direction", "quarters"), [("-y", 1), ("+x", 2), ("+y", 3)])
def test_a_plate_turned_says_the_same(direction, quarters):
    result, _ = listed("left")
    plate = evolve(result.toolkit, directions=(direction,))
    other = SeatingSolver(WEDGE, plate).solve(
        quarter_turned(result[0], {"clamp -x": f"clamp {direction}"}, quarters)
    )
    told = told_of("left", 0)
    same(other, told)
    ways = [told.cage.x, told.cage.y]
    for _ in range(quarters):
        ways = [(-ways[1][1], -ways[1][0]), ways[0]]
    for found, way in zip((other.cage.x, other.cage.y), ways, strict=True):
        assert found == pytest.approx(way, abs=1e-9)
    assert other.placing == pytest.approx(told.placing, abs=1e-9)


def test_part_and_plate_turned_over_say_the_same():
    """Mirrored along the clamp's way: the part turned over is then as it was drawn."""
    result, _ = listed("left")
    fixture = result[0]
    pegs = tuple(Peg(peg.carrier, 0, 0, peg.x, -peg.y, 0, 0.0) for peg in fixture.pegs)
    pose = Pose(180.0 - fixture.pose.theta_deg, fixture.pose.x, -fixture.pose.y)
    over = Fixture("clamp", pegs, pose, fixture.travel, {})
    same(SeatingSolver(WEDGE.turned_over, result.toolkit).solve(over, with_cage=False), told_of("left", 0))


def test_an_opening_vise_is_a_closing_one_seen_from_its_other_jaw():
    """Seen from the right jaw the left one comes nearer as S grows: with -S for S it closes."""
    result, solver = listed("opening")
    for fixture in result[:2]:
        opening = Pattern.from_fixture(fixture, result.toolkit)
        places = np.array([[peg.x, peg.y] for peg in fixture.pegs])
        right = np.array([int(peg.carrier == "right") for peg in fixture.pegs])
        places[:, 0] -= right * fixture.travel
        closing = Pattern(
            places, 1 - right, opening.radii, opening.stop, opening.widest, ClosingFrame(0, 1.0)
        )
        for one, other in zip(solver.find_join_trees(opening), solver.find_join_trees(closing), strict=True):
            assert len(one.seats) > 0
            assert one.seats[:, 3] == pytest.approx(other.seats[:, 3], abs=1e-8)
            assert one.passes[:, SEPARATION] == pytest.approx(other.passes[:, SEPARATION], abs=1e-8)
            assert (one.joined[:, 0] != one.joined[:, 1]).any()


@pytest.mark.thorough
def test_a_plate_with_the_pegs_of_a_vise_says_the_same():
    """Three pegs and one: jaws and clamp differ in their stop alone, which no seat here is near."""
    vise = Vise(pitch=20, columns=2, peg_radius=3)
    result = workhold.design(WEDGE, vise, types="II", best=2)
    plate = Plate(pitch=20, peg_radius=3, directions=["-x"])
    for fixture in result:
        pegs = tuple(
            evolve(peg, carrier="plate" if peg.carrier == "left" else "clamp -x") for peg in fixture.pegs
        )
        onto = SeatingSolver(WEDGE, plate).solve(evolve(fixture, pegs=pegs), with_cage=False)
        told = SeatingSolver(WEDGE, vise).solve(fixture, with_cage=False)
        assert [told.capture_opening, told.way_out] == pytest.approx(
            [onto.capture_opening, onto.way_out], abs=1e-9
        )
        there = {round(seat.jaw_separation, 6) for seat in onto.seats}
        assert {round(seat.jaw_separation, 6) for seat in told.seats} <= there
        assert onto.stop is None or onto.stop < told.stop


def test_a_clamp_stops_where_its_tip_meets_a_locator():
    """Before it, or behind it; and at the end of its stroke."""
    at = (("plate", 0, 0), ("plate", 40, 3), ("plate", 0, 40), ("clamp -x", 20, 0))
    fixture = Fixture(
        "clamp", tuple(Peg(name, 0, 0, x, y, 0, 0.0) for name, x, y in at), Pose(0, 0, 0), 20.0, {}
    )
    pattern = Pattern.from_fixture(fixture, Plate(pitch=20, peg_radius=3, clamp_radius=4))
    assert (pattern.stop, pattern.widest) == pytest.approx((7.0, 40.0 - np.sqrt(49.0 - 9.0)))
    stroke = evolve(fixture, travel=-30.0)
    short = Pattern.from_fixture(stroke, Plate(pitch=20, peg_radius=3, clamp_radius=4, travel=(5, 35)))
    assert short.stop == -35.0
    assert (
        short.make_key()
        == Pattern.from_fixture(
            stroke, Plate(pitch=20, peg_radius=3, clamp_radius=4, travel=(7, 35))
        ).make_key()
    )


def test_a_disc_is_nowhere_located_by_a_clamp():
    disc = Workpiece.from_loops("disc", [[[-15, 0, 1], [15, 0, 1]]])
    plate = Plate(pitch=20, peg_radius=3, clamp_radius=5)
    at = (("plate", 0, 0), ("plate", 0, 20), ("plate", 40, 60), ("clamp -x", 40, 10))
    fixture = Fixture(
        "clamp", tuple(Peg(name, 0, 0, x, y, 0, 0.0) for name, x, y in at), Pose(0, 0, 0), 0.0, {}
    )
    tree = SeatingSolver(disc, plate).find_join_trees(Pattern.from_fixture(fixture, plate))[0]
    assert len(tree.seats) == 0
    # Between two locators, its centre 15 + 3 from both; the tip 15 + 5 from it.
    assert any(
        row[SEPARATION] == pytest.approx(np.sqrt(18.0**2 - 10.0**2) + 20.0 - 40.0) for row in tree.loose
    )


@pytest.mark.parametrize(
    ("toolkit", "message"),
    [
        (Vise(8, 2, 0), "radius 0"),
        (Plate(pitch=8, peg_radius=2, clamp_radius=0), "radius 0"),
        (Vise(8, 2, 2, flat=(1, 1)), "round pegs"),
        (
            Plate(pitch=8, peg_radius=2, clamps=2),
            "for one clamp: with two clamps you push the part against its locators",
        ),
    ],
)
def test_what_is_not_told_is_refused_in_a_sentence(toolkit, message):
    fixture = Fixture("I", (), Pose(0, 0, 0), 0.0, {})
    with pytest.raises(InputError, match=message):
        SeatingSolver(WEDGE, toolkit).solve(fixture)


def test_a_part_put_above_a_fence_comes_home_and_none_is_put_into_it():
    """Put in from a little off its pose, the tip drawn back by half of what catches; never in the fence on the way."""
    name = "onto a fence"
    (result, solver), told = listed(name), told_of(name, 0)
    fixture, at = result[0], result[0].pose
    off = min(0.3 * told.drop_room, 0.5)
    played = simulate_closing(
        solver, fixture, told.seats, evolve(at, y=at.y + off), 0.5 * told.capture_opening
    )
    assert played.ending == "right"
    obstacle = Obstacle.about(result.workpiece, fixture, result.toolkit)
    for pose, travelled in zip(played.poses, played.travels, strict=True):
        config = np.array([np.radians(pose.theta_deg), *pose.apply(*result.workpiece.center), travelled])
        assert obstacle.free(config) > -1e-6
    with pytest.raises(InputError, match="lies in the fence"):
        simulate_closing(solver, fixture, told.seats, evolve(at, y=at.y - 5.0), 0.5 * told.capture_opening)


def test_a_part_slides_along_a_fence_under_the_clamp():
    """A rectangle that the tip presses flat against the fence, away from the locator: loose, between its edge's ends."""
    plate = Workpiece.from_loops("plate", [[[0, 0, 0], [60, 0, 0], [60, 30, 0], [0, 30, 0]]])
    fence = Fence(**DOWN)
    at = (("plate", -100.0, 10.0), ("wall", 0.0, 0.0), ("wall", 1.0, 0.0), ("clamp -y", 0.0, 40.0))
    fixture = Fixture(
        "edge", tuple(Peg(name, 0, 0, x, y, 0, 0.0) for name, x, y in at), Pose(0, 0, 0), 0.0, {}
    )
    pattern = Pattern.from_fixture(fixture, fence)
    closing = SeatingSolver(plate, fence).make_closing(pattern, False)
    found = equilibria_of(closing)
    tree = JoinTree.from_equilibria(found, closing)
    assert len(tree.seats) == 0
    flat = [row for row in (*tree.loose, *tree.slack) if row[CONTACTS] >= 3.0]
    # On each of its four sides, as high as the part; the tip goes from one end of the edge to the other.
    assert sorted(round(row[SEPARATION], 6) for row in flat) == [-7.0, -7.0, 23.0, 23.0]
    every = np.split(found.loose.configs, found.loose.begins[1:-1])
    spans = [
        (row[3], np.ptp(configs[:, 2]))
        for row, configs in zip(found.loose.rows, every, strict=True)
        if row[4] >= 3.0
    ]
    assert len(spans) == 4
    assert all(span == pytest.approx(60.0 if level < 0 else 30.0) for level, span in spans)


@pytest.mark.parametrize("direction", ["-x", "-y"])
def test_a_disc_turns_on_a_fence(direction):
    disc = Workpiece.from_loops("disc", [[[-15, 0, 1], [15, 0, 1]]])
    fence = Fence(**{**DOWN, "directions": [direction]})
    tip = (40.0, 15.0) if direction == "-x" else (20.0, 40.0)
    at = (("plate", 0.0, 20.0), ("wall", 0.0, 0.0), ("wall", 1.0, 0.0), (f"clamp {direction}", *tip))
    fixture = Fixture(
        "edge", tuple(Peg(name, 0, 0, x, y, 0, 0.0) for name, x, y in at), Pose(0, 0, 0), 0.0, {}
    )
    tree = SeatingSolver(disc, fence).find_join_trees(Pattern.from_fixture(fixture, fence))[0]
    assert len(tree.seats) == 0 and len(tree.loose) >= 1
    ahead = np.sqrt(18.0**2 - 5.0**2)
    # Its centre 15 above the fence and 18 from the locator; the tip straight ahead, or above and to one side.
    expected = (
        ahead + 18.0 - 40.0 if direction == "-x" else 15.0 + np.sqrt(18.0**2 - (20.0 - ahead) ** 2) - 40.0
    )
    assert any(row[SEPARATION] == pytest.approx(expected) for row in tree.loose)


def test_pegs_pressed_apart_in_a_slot_rest_at_its_ends():
    """Two contacts whose normals point at each other: S is largest with both pegs at the ends of the slot's middle line."""
    slotted = Workpiece.from_loops(
        "slotted",
        [
            [[0, 0, 0], [100, 0, 0], [100, 60, 0], [0, 60, 0]],
            [[35, 20, 0], [65, 20, 1], [65, 40, 0], [35, 40, 1]],
        ],
    )
    vise = OpeningVise(pitch=10, columns=2, peg_radius=3, min_gap=6)
    at = (("left", 0, 0), ("left", 0, -200), ("right", 10, 0), ("right", 10, 200))
    fixture = Fixture("I", tuple(Peg(name, 0, 0, x, y, 0, 0.0) for name, x, y in at), Pose(0, 0, 0), 0.0, {})
    seats = SeatingSolver(slotted, vise).find_join_trees(Pattern.from_fixture(fixture, vise))[0].seats
    # 30 between the ends' centres and 10 - 3 beyond each, less the 10 by which the right peg stands ahead.
    assert [row[4] for row in seats if abs(row[3] + 30.0 + 14.0 - 10.0) < 1e-9] == [2.0, 2.0]


def test_the_tip_stops_at_the_fence_and_touches_with_its_own_radius():
    at = (("plate", -100.0, 10.0), ("wall", 0.0, 0.0), ("wall", 1.0, 0.0))
    for way, stop, widest in (("-y", -36.0, np.inf), ("+y", -np.inf, 36.0)):
        pegs = tuple(Peg(name, 0, 0, x, y, 0, 0.0) for name, x, y in (*at, (f"clamp {way}", 0.0, 40.0)))
        fence = Fence(**{**DOWN, "directions": [way]}, clamp_radius=4)
        pattern = Pattern.from_fixture(Fixture("edge", pegs, Pose(0, 0, 0), 0.0, {}), fence)
        assert (pattern.stop, pattern.widest) == (stop, widest)
    for name in ("left", "along a fence"):
        result, solver = listed(name)
        pattern, outline = Pattern.from_fixture(result[0], result.toolkit), solver.outline
        boundary = solver.make_closing(pattern, False).boundary
        for row in solver.find_join_trees(pattern)[0].seats:
            places, _, _ = find_contact_normals(boundary, pattern, row)
            c, s = np.cos(row[0]), np.sin(row[0])
            assert measure_outline_distances(places @ np.array([[c, -s], [s, c]]), outline.rows).max() < 1e-7


def test_between_hull_edges_and_ends_of_arcs_a_part_stands_on_one_piece():
    result, solver = listed("onto a fence")
    pattern = Pattern.from_fixture(result[0], result.toolkit)
    fence = WallEquilibria(solver.make_closing(pattern, False).boundary, pattern)
    for piece, low, high in fence.runs:
        # But for where runs overlap.
        reach = fence.boundary.hull.compute_reach(
            fence.compute_outward_direction() - np.linspace(low + 3e-9, high - 3e-9, 9)
        )
        assert reach[:, piece] == pytest.approx(reach.max(axis=1), abs=1e-7)
    # All of a turn but next to nothing, and each piece's turn once.
    assert sum(high - low for _, low, high in fence.runs) == pytest.approx(2 * np.pi, abs=1e-6)
    assert len({piece for piece, _, _ in fence.runs}) == len(fence.runs)
