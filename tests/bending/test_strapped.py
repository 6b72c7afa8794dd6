"""Straps that press a part down on a plate or on supports, and flat jaws that pinch its walls."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from attrs import evolve

import workhold
from bent_bodies import METAL, MODULUS, RATIO, block, need_elements, refine_mesh
from workhold import InputError, Load, Result
from workhold.bending import asking, meshing
from workhold.bending.asking import (
    BendingQuestion,
    HeldFixture,
    SolvedLoads,
    UnitLoads,
    find_bendings,
    find_pressed_places,
)
from workhold.bending.elastic import ElasticBody, make_rigid_motions
from workhold.bending.figures import Bending
from workhold.bending.holding import BELOW, make_elastic_hold
from workhold.bending.meshing import make_mesh
from workhold.bending.patches import RestingFaces, find_foot_corners, make_foot
from workhold.bending.places import list_cutter_loads
from workhold.bending.resting import find_rest
from workhold.bending.shape import PrismShape
from workhold.fixels.support_hardware import SupportPads
from workhold.model.straps import Strap, StrappedHold

need_elements()

SIZE, HIGH, FORCE = (80.0, 50.0), 6.0, 2000.0
LOAD = Load(points=[(40, 25)], force=200)


@pytest.fixture(autouse=True)
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(meshing, "TETRAHEDRA", 150)


@cache
def strapped(over: str, high: float = HIGH, straps: int = 2) -> Result:
    """Seats of a plate under straps over the plate, or over three supports."""
    plate = workhold.StrapPlate(
        pitch=10, peg_radius=3, columns=14, rows=10, straps=straps, tip_radius=4, over=over
    )
    return workhold.design(block(*SIZE), plate, loads=[LOAD], thickness=high, strapped=1, best=2)


def bend(result: Result, high: float = HIGH, force: float | None = FORCE, row: int = 0) -> Bending:
    shape = PrismShape(result.workpiece, high)
    return find_bendings(result, [row], shape, BendingQuestion(METAL, high, force))[0]


def hold_part(result: Result, hold: StrappedHold, high: float) -> tuple[SolvedLoads, HeldFixture]:
    """What holds a part that is strapped as told, and its unit loads."""
    body = ElasticBody(make_mesh(PrismShape(result.workpiece, high)), METAL)
    surface = body.surface
    corners = find_foot_corners(surface.nodes, surface.triangles, surface.normals, 0.0)
    foot = make_foot(corners)
    assert foot is not None
    own = make_elastic_hold(
        evolve(result[0], hold=hold), result.workpiece, result.toolkit, foot,
        jaw_force=FORCE, height=high, faces=RestingFaces.from_corners(corners),
    )  # fmt: skip
    solved = SolvedLoads(body, UnitLoads(surface))
    numbers = solved.units.add(own.columns)
    reads = [solved.units.add(level) for level in own.locating]
    return solved, solved.add_plate_forces(HeldFixture(own, numbers, reads, FORCE, False))


def test_cells_that_pull_let_go_and_those_that_sink_touch() -> None:
    """The conditions of contact hold on parts of any softness."""
    random = np.random.default_rng(5)
    for count in (4, 9, 30):
        for _ in range(8):
            half = random.normal(size=(count, count))
            compliance = half @ half.T / count + 0.1 * np.eye(count)
            places = random.uniform(-10, 10, size=(count, 2))
            wrenches = np.column_stack([np.ones(count), places[:, 1], -places[:, 0]])
            rise = random.normal(size=count)
            load = -30.0 * wrenches.mean(axis=0)
            rest = find_rest(compliance, wrenches, rise, load)
            assert (rest.pressures >= 0.0).all()
            assert wrenches.T @ rest.pressures == pytest.approx(-load, abs=1e-6)
            free = compliance @ rest.pressures + rise
            own = rest.touching
            motion = np.linalg.lstsq(wrenches[own], -free[own], rcond=None)[0]
            gaps = free + wrenches @ motion
            assert np.abs(gaps[own]).max() < 1e-7 and gaps.min() > -1e-7
            further = rest.compute_bearing_forces(rise[own, None], load[:, None])
            assert wrenches[own].T @ further == pytest.approx(-load[:, None], abs=1e-6)


def test_what_tips_the_part_is_refused_in_a_sentence() -> None:
    row = np.array([[1.0, 0.0, 10.0], [1.0, 5.0, 0.0], [1.0, 0.0, -10.0]])
    with pytest.raises(InputError, match="tips it off the plate"):
        find_rest(np.eye(3), row, np.zeros(3), np.array([-30.0, 600.0, 0.0]))
    line = np.array([[1.0, 0.0, 10.0], [1.0, 0.0, -10.0]])
    with pytest.raises(InputError, match="tips it off the plate"):
        find_rest(np.eye(2), line, np.zeros(2), np.array([-30.0, 50.0, 0.0]))


def test_a_tip_stands_over_a_disc_and_three_rings_of_six_sectors() -> None:
    square = np.array(
        [[(0, 0, 0), (0, 90, 0), (90, 0, 0)], [(90, 90, 0), (90, 0, 0), (0, 90, 0)]], np.float64
    )
    cells = RestingFaces.from_corners(square).make_cells_under((50.0, 40.0), 5.0, 8.0)
    away = [np.hypot(*(cell.points[:, :2] - (50.0, 40.0)).T) for cell in cells]
    assert len(cells) == 19 and away[0].max() < 2.5
    ends = np.array([2.5, 5.0, 5.0 + 0.7 * 8.0, 5.0 + 2.0 * 8.0])
    for number, one in enumerate(away[1:]):
        ring = number // 6
        assert ends[ring] < one.min() and one.max() <= ends[ring + 1]
    middles = np.array([cell.middle[:2] - (50.0, 40.0) for cell in cells[1:]]).reshape(3, 6, 2)
    assert np.abs(middles.sum(axis=1)).max() < 0.5 and np.hypot(*middles[0].T).min() > 2.5


@pytest.mark.parametrize("over", ["plate", "supports"])
def test_straps_balance_and_every_load_is_answered(over: str) -> None:
    result = strapped(over)
    hold = result[0].hold
    assert isinstance(hold, StrappedHold)
    solved, held = hold_part(result, hold, HIGH)
    wrenches = np.array([one.wrench for one in held.hold.columns]).T
    assert np.abs(wrenches @ held.hold.clamping).max() < 1e-6 * FORCE * SIZE[0]
    assert held.hold.clamping[:2] == pytest.approx([FORCE, FORCE])
    answered = wrenches @ held.hold.answers + np.eye(6)
    level = [0, 1, 5] if over == "plate" else list(range(6))
    assert np.abs(answered[level]).max() < 1e-7
    if held.rest is None:
        return
    resting = list(held.hold.resting)
    rise = solved.read([held.numbers[k] for k in resting], held.numbers) @ held.hold.answers[:, :1]
    load = (wrenches @ held.hold.answers + np.eye(6))[BELOW][:, :1]
    more = held.rest.compute_bearing_forces(rise, load)
    assert wrenches[BELOW][:, resting] @ more == pytest.approx(-load, abs=1e-6)


def test_no_cell_sinks_into_the_plate_and_none_is_pulled() -> None:
    result = strapped("plate")
    hold = result[0].hold
    assert isinstance(hold, StrappedHold)
    solved, held = hold_part(result, hold, HIGH)
    assert held.rest is not None
    values, motion = solved.compute_clamped_state(held)
    first = len(held.numbers) - len(held.rest.pressures)
    rigid = np.array([one.wrench @ motion for one in held.hold.columns])[first:]
    gaps = solved.read(held.numbers[first:], held.numbers) @ held.hold.clamping + rigid
    assert gaps.min() > -1e-3 * np.abs(gaps).max()
    assert np.abs(gaps[held.rest.touching]).max() < 1e-6 * np.abs(gaps).max()
    assert held.rest.pressures.min() >= 0.0
    assert held.rest.pressures.sum() == pytest.approx(2 * FORCE, rel=1e-6)
    assert values.shape[1] == 3


def test_a_plate_that_lies_flat_is_hardly_bent_by_straps() -> None:
    """An even pressure from below would bend it; the plate presses where the straps do."""
    result = strapped("plate")
    hold = result[0].hold
    assert isinstance(hold, StrappedHold)
    solved, held = hold_part(result, hold, HIGH)
    assert held.rest is not None
    moved = solved.solve_clamping(held)
    tips = np.array(result[0].pose.inverse.apply(np.array([one.at for one in hold.straps])))
    nodes = solved.body.surface.nodes
    far = np.min([np.hypot(*(nodes[:, :2] - tip).T) for tip in tips], axis=0) > 15.0
    assert np.abs(moved[far, 2]).max() < 0.02
    squares = np.array([one.wrench for one in held.hold.columns])[-len(held.rest.pressures) :]
    places = np.column_stack([-squares[:, 4], squares[:, 3]]) / squares[:, 2:3]
    away = np.min([np.hypot(*(places - tip).T) for tip in tips], axis=0)
    assert held.rest.pressures[away < 16.0].sum() > 0.95 * 2 * FORCE


def test_a_strip_under_a_strap_between_two_supports_sinks_as_a_beam() -> None:
    length, width, high, span = 160.0, 20.0, 8.0, 140.0
    plate = workhold.StrapPlate(
        pitch=10, peg_radius=2, columns=20, rows=8, straps=1, tip_radius=2, over="supports",
        supports=SupportPads(pad_radius=2.0, pad_margin=0.0),
    )  # fmt: skip
    result = workhold.design(block(length, width), plate, thickness=high, best=1)
    pose = result[0].pose
    # The holes below its ends, and the middle, where the strap presses.
    ends = [(10.0, 5.0), (10.0, 15.0), (10.0 + span, 10.0)]
    at = tuple(np.asarray(pose.apply(80.0, 10.0)).ravel().tolist())
    hold = StrappedHold((Strap((0, 0), at, high),), None, 1, supports=((0, 0), (0, 1), (1, 0)))
    toolkit = evolve(plate)
    centres = dict(zip(hold.supports, (np.asarray(pose.apply(*end)).ravel() for end in ends), strict=True))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(type(toolkit.carriers[0]), "compute_hole_center", lambda _, *hole: centres[hole])
        solved, held = hold_part(result, hold, high)
    sunk = solved.solve_clamping(held)
    nodes = solved.body.surface.nodes
    middle = (np.abs(nodes[:, 0] - 80.0) < 4.0) & (nodes[:, 2] < 1e-6)
    inertia, shear = width * high**3 / 12, MODULUS / (2 * (1 + RATIO))
    expected = FORCE * span**3 / (48 * MODULUS * inertia) + 6 * FORCE * span / (20 * shear * width * high)
    assert -sunk[middle, 2].mean() == pytest.approx(expected, rel=0.02)


def test_walls_pinched_between_flat_jaws_bend_as_cantilevers() -> None:
    """A channel is held at its two walls, over all of which the jaws press: w = q l⁴ / 8 E I, with shear.

    Their roots turn by 16.67 M / (π E t²) for each mm of width (W. J. O'Donnell, Journal of Applied Mechanics 27, 1960),
    and the floor bends as a beam.
    """
    deep, wall, floor, across, high = 60.0, 5.0, 20.0, 60.0, 20.0
    channel = workhold.Workpiece.from_points(
        "channel",
        [(0, 0), (across, 0), (across, deep + floor), (across - wall, deep + floor), (across - wall, floor),
         (wall, floor), (wall, deep + floor), (0, deep + floor)],
    )  # fmt: skip
    vise = workhold.PlainVise(jaw_width=150, max_opening=120, jaw_height=40)
    result = workhold.design(channel, vise, thickness=high, best=12)
    row = next(
        k for k, one in enumerate(result)
        if one.hold.opening == pytest.approx(across) and one.hold.contact_area == pytest.approx((deep + floor) * high)
    )  # fmt: skip
    force = 1600.0
    found = find_bendings(result, [row], PrismShape(channel, high), BendingQuestion(METAL, high, force))[0]
    # Between the two tips: the pressure of the jaws bends both walls, and turns the floor's ends.
    load, span = force / (deep + floor), across - wall
    inertia, area = high * wall**3 / 12, high * wall
    shear = MODULUS / (2 * (1 + RATIO))
    bent = load * deep**4 / (8 * MODULUS * inertia) + 1.2 * load * deep**2 / (2 * shear * area)
    moment = load * deep**2 / 2 + load * deep * floor / 2
    turned = moment * span / (2 * MODULUS * high * floor**3 / 12)
    bent += 16.67 * load * deep**2 / 2 / (np.pi * MODULUS * wall**2 * high) * deep
    nodes, moved = found.surface.nodes, found.moved
    tips = nodes[:, 1] > deep + floor - 0.5
    left, right = (moved[tips & side, 0].mean() for side in (nodes[:, 0] < wall, nodes[:, 0] > across - wall))
    roots = (nodes[:, 1] < floor / 2) & (np.abs(nodes[:, 1] - floor / 2) < 4.0)
    low, far = (moved[roots & side, 0].mean() for side in (nodes[:, 0] < 1e-3, nodes[:, 0] > across - 1e-3))
    closer = (left - right) - (low - far)
    expected = 2 * (bent + turned * (deep + floor / 2))
    assert closer == pytest.approx(expected, rel=0.02)


def test_twice_the_force_of_straps_bends_twice_as_far() -> None:
    once, twice = (bend(strapped("plate"), force=force) for force in (1000.0, 2000.0))
    assert twice.clamp_distortion.value == pytest.approx(2 * once.clamp_distortion.value, rel=1e-6)
    assert once.give is not None and twice.give is not None
    assert twice.give.value == pytest.approx(once.give.value, rel=1e-6)


def test_straps_press_as_hard_as_loads_need_where_nobody_says() -> None:
    result = strapped("plate")
    hold, bent = result[0].hold, bend(result, force=None)
    assert isinstance(hold, StrappedHold)
    assert bent.jaw_force == hold.clamp_needed and not bent.is_assumed


def test_a_seat_without_straps_bends_nothing() -> None:
    with pytest.raises(InputError, match="a fixture has no straps"):
        bend(strapped("plate"), row=1)


@pytest.mark.thorough
@pytest.mark.parametrize("over", ["plate", "supports"])
def test_straps_on_a_finer_mesh_agree_within_the_error_that_is_told(
    over: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = bend(strapped(over))
    monkeypatch.setattr(asking, "make_mesh", lambda shape: refine_mesh(make_mesh(shape)))
    finer = bend(strapped(over))
    assert told.give is not None and finer.give is not None
    for one, other in ((told.clamp_distortion, finer.clamp_distortion), (told.give, finer.give)):
        assert abs(one.value - other.value) <= one.error
    assert make_rigid_motions(told.surface.nodes).shape[2] == 6


def test_friction_bears_loads_along_the_plate_alike() -> None:
    """A force that turns nothing is borne by half below, and a quarter under each of two tips."""
    result = strapped("plate")
    hold = result[0].hold
    assert isinstance(hold, StrappedHold)
    _, held = hold_part(result, hold, HIGH)
    limits = np.array([1.0, 1.0, 2.0]) / 4
    tips = [one.points.mean(axis=0)[:2] for one in held.hold.columns[:2]]
    x, y = limits @ np.array([*tips, (SIZE[0] / 2, SIZE[1] / 2)])
    for axis, turning in ((0, -y), (1, x)):
        load = np.zeros(6)
        load[[axis, 5]] = 1.0, turning
        borne = -(held.hold.answers @ load)[2:11].reshape(3, 3)
        assert borne[:, axis] == pytest.approx(limits, abs=1e-3)
        assert np.abs(borne[:, 1 - axis]).max() < 1e-3


def test_a_load_on_a_plate_gives_no_more_than_it_is_pressed_in() -> None:
    """What is loaded downward over the plate is borne right below it, and sinks by no more than a column would."""
    down = Load(points=[(40, 25)], force=0, upward=-400.0)
    plate = workhold.StrapPlate(pitch=10, peg_radius=3, columns=14, rows=10, straps=2, tip_radius=4)
    result = workhold.design(block(*SIZE), plate, loads=[down], thickness=HIGH, strapped=1, best=1)
    give = bend(result).give
    assert give is not None
    column = 400.0 * HIGH / (MODULUS * np.pi * asking.CUTTER_RADIUS**2)
    assert 0.0 < give.value < 2.0 * column


def test_a_load_and_what_bears_it_balance_on_a_plate() -> None:
    result = strapped("plate")
    hold = result[0].hold
    assert isinstance(hold, StrappedHold)
    solved, held = hold_part(result, hold, HIGH)
    loads = list_cutter_loads(result.query, HIGH)
    assert loads is not None
    place = find_pressed_places(loads, solved.units)[0]
    factors = solved.find_factors(held, place, np.eye(4))
    wrenches = np.array([one.wrench for one in held.hold.columns]).T
    assert np.abs(place.wrenches + wrenches @ factors[4:]).max() < 1e-6 * SIZE[0]


def test_cells_count_in_the_error_on_a_plate_alone() -> None:
    on_plate, on_supports = (bend(strapped(over)) for over in ("plate", "supports"))
    assert on_plate.clamp_distortion.error > asking.OF_CELLS * on_plate.clamp_distortion.value
    assert on_plate.give is not None and on_plate.give.error > asking.OF_CELLS * on_plate.give.value
    told = on_supports.clamp_distortion
    assert told.error != pytest.approx(told.error + asking.OF_CELLS * told.value)


def test_straps_beside_their_supports_tip_the_part() -> None:
    result = strapped("supports")
    hold = result[0].hold
    assert isinstance(hold, StrappedHold)
    at = tuple(np.asarray(result[0].pose.apply(*SIZE)).ravel().tolist())
    beside = evolve(hold, straps=(evolve(hold.straps[0], at=at),))
    with pytest.raises(InputError, match="tip the part off its supports"):
        hold_part(result, beside, HIGH)


def test_the_height_of_a_strap_on_a_solid_is_that_of_its_face(tmp_path: Path) -> None:
    """Heels stand on the plate, and the part on supports of 20 mm."""
    pytest.importorskip("OCP")
    from step_shapes import box, write_step

    part = workhold.load(write_step(tmp_path / "box.step", box(*SIZE, HIGH)))
    plate = workhold.StrapPlate(
        pitch=10, peg_radius=3, columns=14, rows=10, straps=1, tip_radius=4, over="supports",
        supports=SupportPads(height=20.0),
    )  # fmt: skip
    result = workhold.design(part, plate, loads=[LOAD], strapped=1, best=1)
    hold = result[0].hold
    assert isinstance(hold, StrappedHold) and hold.straps[0].height == pytest.approx(HIGH + 20.0)
    _, held = hold_part(result, hold, HIGH)
    assert held.hold.columns[0].points[:, 2] == pytest.approx(HIGH)


def test_straps_in_place_of_side_clamps_bend_like_a_fixtures_own() -> None:
    own = strapped("plate")
    radius = own.toolkit.strap_set.tip_radius  # type: ignore[union-attr]
    hold = own[0].hold
    assert isinstance(hold, StrappedHold)
    told = own[0].bending(thickness=HIGH, jaw_force=FORCE)
    same = own[0].bending(thickness=HIGH, jaw_force=FORCE, straps=evolve(hold, tip_radius=radius))
    assert same.clamp_distortion == told.clamp_distortion and same.stress == told.stress
    with pytest.raises(InputError, match="have no room in a result file"):
        same.to_figures()


@pytest.mark.parametrize("over", ["plate", "supports"])
def test_a_fixture_with_clamps_is_bent_under_straps_alone(over: str) -> None:
    block = workhold.Workpiece.from_points("block", [(0, 0), (100, 0), (100, 60), (0, 60)])
    load = Load(points=[(50, 30)], force=300)
    plate = workhold.Plate(pitch=20, peg_radius=3, columns=8, rows=6)
    first = workhold.design(block, plate, best=1, loads=[load], jaw_force=90.0)[0]
    held = first.straps(5, count=2 if over == "plate" else 3, over=over)
    told = first.bending(thickness=5, straps=held)
    assert told.jaw_force == pytest.approx(held.clamp_needed) and not told.is_assumed
    twice = first.bending(thickness=5, straps=held, jaw_force=2 * told.jaw_force)
    assert twice.clamp_distortion.value == pytest.approx(2 * told.clamp_distortion.value, rel=1e-6)
    # No side clamp presses: far from the straps nothing is stressed.
    sides = first.bending(thickness=5)
    assert sides.clamp_distortion.at != told.clamp_distortion.at and sides.jaw_force == 90.0
    with pytest.raises(InputError, match="leave one of straps and supports out"):
        first.bending(thickness=5, straps=held, supports=first.supports(5))


def test_only_locators_lay_a_part_under_straps() -> None:
    block = workhold.Workpiece.from_points("block", [(0, 0), (100, 0), (100, 60), (0, 60)])
    plate = workhold.Plate(pitch=20, peg_radius=3, columns=8, rows=6, clamps=2)
    result = workhold.design(block, plate, best=1)
    held = result[0].straps(5, count=2, loads=[Load(points=[(50, 30)], force=300)])
    _, one = hold_part(result, held, 5.0)
    assert len(one.hold.locating[0]) == len(one.reads[0]) == 3
