"""What holds a part as loads on an elastic body, and how far fixtures bend theirs."""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from attrs import evolve

import workhold
from bent_bodies import METAL, MODULUS, RATIO, need_elements, refine_mesh
from workhold import InputError, Load, Result
from workhold.bending import asking, library, meshing
from workhold.bending.asking import (
    BendingQuestion,
    HeldFixture,
    SolvedLoads,
    UnitLoads,
    find_bendings,
    find_pressed,
    measure_distances,
)
from workhold.bending.elastic import ElasticBody
from workhold.bending.holding import (
    ElasticHold,
    make_contact_strips,
    make_elastic_hold,
    sample_rectangle,
)
from workhold.bending.meshing import make_mesh
from workhold.bending.patches import (
    BESIDE,
    PEG_WIDTH,
    LoadPatch,
    find_foot_corners,
    make_disc,
    make_foot,
    make_strip,
)
from workhold.bending.shape import PrismShape
from workhold.model.elastic_material import MATERIALS, ElasticMaterial, find_material
from workhold.model.part_bending import PadsBelow, find_bending_figure
from workhold.statics.loads import find_touched_points
from workhold.statics.pins import compute_deflections
from workhold.units import INCH, MILLIMETRE

need_elements()

HIGH = 12.0


@pytest.fixture(autouse=True)
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Meshes of fewer elements than users have, since what must hold does so on every one."""
    monkeypatch.setattr(meshing, "TETRAHEDRA", 150)


CORNERS = [(0, 0), (80, 0), (80, 30), (50, 60), (0, 60)]
TOOLKITS = {
    "vise": workhold.Vise(pitch=10, columns=3, peg_radius=3),
    "plate": workhold.Plate(pitch=10, peg_radius=3, columns=12, rows=10),
    "two clamps": workhold.Plate(pitch=20, peg_radius=3, columns=8, rows=6, clamps=2),
    "fence": workhold.Fence(pitch=10, peg_radius=3, wall_offset=10),
    "plain vise": workhold.PlainVise(jaw_width=150, max_opening=120, jaw_height=40),
}


@cache
def result_in(name: str, high: float = HIGH, force: float = 3000.0) -> Result:
    """The best fixtures of a plate with a slanting corner, under a load."""
    part = workhold.Workpiece.from_points("plate", CORNERS)
    loads = [Load(points=[(60, 20)], force=150)]
    return workhold.design(part, TOOLKITS[name], best=3, thickness=high, loads=loads, jaw_force=force)


@cache
def body_of(high: float = HIGH) -> ElasticBody:
    part = workhold.Workpiece.from_points("plate", CORNERS)
    return ElasticBody(make_mesh(PrismShape(part, high)), METAL)


def foot_of(body: ElasticBody) -> LoadPatch:
    surface = body.surface
    foot = make_foot(find_foot_corners(surface.nodes, surface.triangles, surface.normals, 0.0))
    assert foot is not None
    return foot


def hold_in(name: str, **further: object) -> ElasticHold:
    result = result_in(name)
    return make_elastic_hold(
        result[0],
        result.workpiece,
        result.toolkit,
        foot_of(body_of()),
        jaw_force=3000.0,
        height=HIGH,
        **further,
    )


def bent(result: Result, high: float = HIGH, **asked: object) -> asking.Bending:
    question = BendingQuestion(METAL, high, **asked)
    return find_bendings(result, [0], PrismShape(result.workpiece, high), question)[0]


@pytest.mark.parametrize("name", TOOLKITS)
def test_clamping_balances_and_every_load_is_answered(name: str) -> None:
    hold = hold_in(name)
    wrenches = np.array([one.wrench for one in hold.columns]).T
    size = np.array([1.0, 1.0, 1.0, *[1.0 / hold.size] * 3])
    assert np.abs(size * (wrenches @ hold.clamping)).max() < 1e-6 * 3000.0
    unanswered = wrenches @ hold.answers + np.eye(6)
    assert np.abs(size[:, None] * unanswered / size).max() < 1e-9


@pytest.mark.parametrize("name", ["vise", "plate", "two clamps", "fence"])
def test_pegs_press_as_hard_as_the_fixture_says(name: str) -> None:
    result, hold = result_in(name), hold_in(name)
    pegs = result[0].pegs
    assert hold.clamping[: len(pegs)] == pytest.approx([3000.0 * peg.force for peg in pegs], rel=1e-6)


@pytest.mark.parametrize("name", TOOLKITS)
def test_a_rigid_motion_of_the_part_is_taken_out(name: str) -> None:
    """Whatever moves the whole part leaves its contacts where they were."""
    hold = hold_in(name)
    motion = np.array([0.01, -0.02, 0.03, 1e-4, -2e-4, 3e-4])
    readings = [np.array([read.wrench @ motion for read in level]) for level in hold.locating]
    found = hold.find_motion(readings, np.zeros(len(readings[0])))
    there = [np.array([read.wrench @ (motion + found) for read in level]) for level in hold.locating]
    moved = hold.movers @ np.linalg.lstsq(hold.movers, there[0], rcond=None)[0] if hold.movers.size else 0.0
    assert np.abs(there[0] - moved).max() < 1e-9
    scale = np.abs([read.wrench for read in hold.locating[1]]).max()
    assert np.abs(there[1]).max() < 1e-9 * scale


@pytest.mark.parametrize("name", ["vise", "plate", "two clamps", "fence"])
def test_a_clamped_part_touches_its_locators_and_what_closes_follows(name: str) -> None:
    result, hold = result_in(name), hold_in(name)
    solved = SolvedLoads(body_of(), UnitLoads(body_of().surface))
    numbers = solved.units.add(hold.columns)
    reads = [solved.units.add(level) for level in hold.locating]
    held = HeldFixture(hold, numbers, reads, 3000.0, False)
    _, motion = solved.compute_clamped_state(held)
    rigid = np.array([read.wrench @ motion for read in hold.locating[0]])
    there = solved.read(reads[0], numbers) @ hold.clamping + rigid
    carriers = [result.toolkit.find_carrier(peg.carrier) for peg in result[0].pegs]
    moves = np.array([one.travel is not None for one in carriers])
    assert np.abs(there[~moves]).max() < 1e-9
    follows = np.abs(hold.movers).sum(axis=1) > 0.0
    assert np.abs(there[moves]).max() > 1e-4 and follows[moves].any() and not follows[~moves].any()


@pytest.mark.parametrize("name", ["vise", "plate", "plain vise"])
def test_twice_the_force_bends_twice_as_far(name: str) -> None:
    once, twice = (bent(result_in(name), jaw_force=force) for force in (1000.0, 2000.0))
    assert twice.clamp_distortion.value == pytest.approx(2 * once.clamp_distortion.value, rel=1e-9)
    assert twice.give is not None and once.give is not None
    assert twice.give.value == pytest.approx(once.give.value, rel=1e-9)


def test_a_thicker_part_is_bent_less_and_gives_less() -> None:
    found = [bent(result_in("vise", 14.0), high, jaw_force=3000.0) for high in (6.0, 9.0, 14.0)]
    bends = [one.clamp_distortion.value for one in found]
    assert bends == sorted(bends, reverse=True)


def test_a_bar_between_flat_jaws_is_squeezed_as_the_formula_says() -> None:
    """Its far end moves by F L / (E A), less what is near to the jaw and not counted."""
    bar = workhold.Workpiece.from_points("bar", [(0, 0), (30, 0), (30, 80), (0, 80)])
    vise = workhold.PlainVise(jaw_width=150, max_opening=120, jaw_height=40)
    result = workhold.design(bar, vise, thickness=20, best=8)
    row = next(k for k, one in enumerate(result) if one.hold.opening == pytest.approx(80.0))
    question = BendingQuestion(METAL, 20.0, jaw_force=6000.0)
    found = find_bendings(result, [row], PrismShape(bar, 20.0), question)[0]
    shorter = 6000.0 * 80.0 / (MODULUS * 30 * 20)
    wider = 6000.0 * RATIO * 15.0 / (MODULUS * 30 * 20)
    assert shorter * 0.9 < found.clamp_distortion.value < np.hypot(shorter, 1.5 * wider) * 1.02


@pytest.mark.parametrize("order", [2, 3])
def test_solved_at_once_is_what_is_superposed(order: int) -> None:
    body, hold = ElasticBody(body_of().mesh, METAL, order), hold_in("vise")
    solved = SolvedLoads(body, UnitLoads(body.surface))
    numbers = solved.units.add(hold.columns)
    superposed = solved.add_up(numbers, hold.clamping)
    works = [
        factor * solved.compute_work(number) for number, factor in zip(numbers, hold.clamping, strict=True)
    ]
    at_once = body.solve_loads([sum(works)])[0]
    assert np.abs(at_once - superposed).max() <= 1e-10 * np.abs(at_once).max()
    summed = SolvedLoads(body, solved.units, is_summed=True)
    assert summed.add_up(numbers, hold.clamping) == pytest.approx(at_once, abs=1e-12)
    assert len(summed.responses) == 1 and len(solved.responses) == len(set(numbers))
    # The same unit loads with other factors are another sum.
    assert summed.add_up(numbers, 3.0 * hold.clamping) == pytest.approx(3.0 * at_once, abs=1e-12)


def test_a_part_gives_most_where_it_is_weakest() -> None:
    """Of loads alike in the middle and at the end of a thin tongue, that at the end."""
    tongue = [(0, 0), (40, 0), (40, 25), (90, 25), (90, 31), (40, 31), (40, 60), (0, 60)]
    part = workhold.Workpiece.from_points("tongue", tongue)
    loads = [Load(points=[(20, 30)], force=150), Load(points=[(88, 28)], force=150)]
    result = workhold.design(part, TOOLKITS["vise"], best=1, thickness=HIGH, loads=loads, jaw_force=3000.0)
    for given in (result, evolve(result, query=evolve(result.query, loads=loads[::-1]))):
        give = find_bendings(given, [0], PrismShape(part, HIGH), BendingQuestion(METAL, HIGH, 3000.0))[0].give
        assert give is not None and give.at == pytest.approx((88.0, 28.0, HIGH))
        assert give.load == 2 if given is result else give.load == 1


def test_unit_loads_that_fixtures_share_are_solved_once() -> None:
    hold, units = hold_in("vise"), UnitLoads(body_of().surface)
    assert units.add(hold.columns) == units.add(hold.columns) == list(range(len(hold.columns)))


def test_a_stiff_part_gives_as_its_pegs_bend() -> None:
    """Nothing is left but the pins' deflections, which move the part as the contacts say."""
    result = result_in("vise")
    stiff = BendingQuestion(ElasticMaterial("stiff", 1e7, 0.3, 1000.0), HIGH, 3000.0)
    own = find_bendings(result, [0], PrismShape(result.workpiece, HIGH), stiff)[0]
    softer = find_bendings(
        result, [0], PrismShape(result.workpiece, HIGH), BendingQuestion(METAL, HIGH, 3000.0)
    )[0]
    assert own.give is not None and softer.give is not None
    least = 150.0 * compute_deflections(1.0, HIGH / 2, 6.0) / 4
    assert least < own.give.value < softer.give.value
    rigid = hold_in("vise")
    load = np.array([150.0, 0, 0, 0, -150.0 * HIGH, -150.0 * 20])
    pegs = (rigid.answers @ load)[:4]
    assert rigid.gives[:, :4] @ pegs == pytest.approx(pegs * compute_deflections(1.0, HIGH / 2, 6.0))


def test_only_faces_to_be_cut_count() -> None:
    result = result_in("vise")
    whole, top = bent(result, jaw_force=3000.0), bent(result, jaw_force=3000.0, faces=("top",))
    face = bent(result, jaw_force=3000.0, faces=(3, "bottom"))
    assert max(top.clamp_distortion.value, face.clamp_distortion.value) <= whole.clamp_distortion.value
    assert top.clamp_distortion.at[2] == pytest.approx(HIGH)
    low = bent(result, jaw_force=3000.0, faces=("bottom",))
    assert low.clamp_distortion.at[2] == pytest.approx(0.0)
    assert (whole.faces, top.faces, face.faces) == ((), ("top",), (3, "bottom"))
    with pytest.raises(InputError, match="face 9 of plate does not exist"):
        bent(result, faces=(9,))
    other = workhold.Workpiece.from_points("other", [(200, 0), (300, 0), (300, 50)])
    with pytest.raises(InputError, match=r"nothing of other lies on what is to be cut \(faces 2\)"):
        asking.find_cut_nodes(body_of().surface, (2,), other, HIGH)


def test_only_faces_that_are_cut_all_over_are_searched_between_nodes() -> None:
    """What a cut edge's neighbours do beside it is not told."""
    result = result_in("vise")
    for name, high in (("top", HIGH), ("bottom", 0.0)):
        assert bent(result, jaw_force=3000.0, faces=(name,)).clamp_distortion.at[2] == pytest.approx(high)
    side = bent(result, jaw_force=3000.0, faces=(0,)).clamp_distortion.at
    assert side[1] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("name", ["vise", "plate", "fence", "plain vise"])
def test_the_place_of_the_most_is_outside_of_dents(name: str) -> None:
    one = bent(result_in(name), jaw_force=3000.0)
    away = np.linalg.norm(hold_in(name).pressed - np.array(one.clamp_distortion.at), axis=1)
    assert away.min() > 1.999


def test_the_dent_of_a_clamp_on_top_does_not_count() -> None:
    below = PadsBelow(
        np.array([(10.0, 10.0), (70.0, 10.0), (20.0, 50.0)]), 4.0, np.array([40.0, 25.0, HIGH]), 3.0, 500.0
    )
    hold = hold_in("vise", below=below)
    away = np.linalg.norm(hold.pressed - below.clamp, axis=1)
    assert (away < 3.0).sum() >= 16 and hold.clamping[4] == 500.0
    assert hold.clamping[5:].sum() == pytest.approx(500.0)


def test_places_of_which_one_is_pressed_are_pressed() -> None:
    nodes = np.array([(0.0, 0, 0), (10.0, 0, 0), (30.0, 0, 0)])
    points = np.array([(0.5, 0, 0), (10.0, 1.0, 0)])
    assert find_pressed(nodes, points).tolist() == [True, True, False]


def test_jaws_press_as_hard_as_loads_need_where_nobody_says() -> None:
    part = workhold.Workpiece.from_points("plate", CORNERS)
    for name in ("vise", "plain vise"):
        loads = [Load(points=[(60, 20)], force=150)]
        first = workhold.design(part, TOOLKITS[name], best=1, thickness=HIGH, loads=loads)[0]
        one = first.bending()
        needed = first.quality.get("jaw_force_needed", first.quality.get("clamp_needed"))
        assert one.jaw_force == needed and not one.is_assumed


def test_a_jaw_that_touches_a_line_presses_on_a_strip_about_it() -> None:
    points, areas = sample_rectangle((20.0, 20.0, 0.0, 99.0), 5.0, 12.0)
    assert points[:, 0].mean() == pytest.approx(20.0) and np.ptp(points[:, 0]) < PEG_WIDTH
    assert points[:, 2].max() < 12.0 and areas.sum() == pytest.approx(12.0 * PEG_WIDTH)


def test_movements_are_read_beside_what_presses() -> None:
    strip = make_strip((10.0, 0.0), (0.0, -1.0), 0.0, 8.0)
    assert np.abs(strip.points[:, 0] - 10.0).max() < PEG_WIDTH / 2
    assert sorted(set(strip.beside[:, 0].round(9))) == [
        10 - PEG_WIDTH / 2 - BESIDE,
        10 + PEG_WIDTH / 2 + BESIDE,
    ]
    disc = make_disc(np.array([5.0, 5.0, 8.0]), 3.0, None)
    assert np.hypot(*(disc.beside[:, :2] - 5.0).T) == pytest.approx(3.0 + BESIDE)
    assert np.hypot(*(disc.points[:, :2] - 5.0).T).max() < 3.0


def test_a_part_between_flat_jaws_is_laid_against_the_fixed_one() -> None:
    result, hold = result_in("plain vise"), hold_in("plain vise")
    pose = result[0].pose
    for read in hold.locating[0]:
        there = pose.apply(read.points[:, :2])
        assert np.abs(there[:, 1]).max() < 1e-9


def test_pegs_on_a_solid_press_no_higher_than_its_faces(tmp_path: Path) -> None:
    """The bracket's foot is 10 mm high, its wall 42."""
    pytest.importorskip("OCP")
    from step_shapes import write_step

    from bent_solids import SOLIDS

    part = workhold.load(write_step(tmp_path / "bracket.step", SOLIDS["bracket"]()))
    result = workhold.design(part, workhold.Vise(pitch=10, columns=4, peg_radius=3), best=1, jaw_force=3000)
    points, normals = find_touched_points(result[0], part, result.toolkit)
    strips = make_contact_strips(result[0], part, points, normals, 42.0, None)
    tops = [float(one.points[:, 2].max()) for one in strips]
    assert min(tops) < 10.0 and max(tops) < 42.0


def test_distances_from_lines_and_arcs() -> None:
    from workhold.geometry.segment import Arc, Line

    points = np.array([(3.0, 4.0), (12.0, 0.0), (0.0, -6.0)])
    assert measure_distances(Line((0.0, 0.0), (10.0, 0.0)), points) == pytest.approx([4.0, 2.0, 6.0])
    quarter = Arc((0.0, 0.0), 5.0, np.pi / 4, np.pi / 4, 1.0)
    assert measure_distances(quarter, points)[:2] == pytest.approx([0.0, 7.0])
    assert measure_distances(quarter, points)[2] > 5.0


@pytest.mark.parametrize("name", ["vise", "plate", "two clamps", "fence", "plain vise"])
def test_a_finer_mesh_agrees_within_the_error_that_is_told(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The usual mesh against the same refined once."""
    result = result_in(name)
    told = bent(result, jaw_force=3000.0)
    monkeypatch.setattr(asking, "make_mesh", lambda shape: refine_mesh(make_mesh(shape)))
    finer = bent(result, jaw_force=3000.0)
    assert told.give is not None and finer.give is not None
    for one, other in ((told.clamp_distortion, finer.clamp_distortion), (told.give, finer.give)):
        assert abs(one.value - other.value) <= one.error + 0.002 * one.value


def test_pads_and_a_clamp_on_top_bear_the_part() -> None:
    plate = workhold.Workpiece.from_points("plate", [(0, 0), (120, 0), (120, 80), (0, 80)])
    vise = workhold.Vise(pitch=10, columns=8, peg_radius=3)
    first = workhold.design(plate, vise, best=1, jaw_force=2000, thickness=6)[0]
    pads = first.supports(6, best=1, pad_radius=3, loads=[])
    flat, light, hard = (
        first.bending("69000,0.33", thickness=6, supports=supports, clamp_force=force)
        for supports, force in ((None, None), (pads, 100.0), (pads, 2000.0))
    )
    assert flat.give is None and flat.figures.keys() == {"clamp_distortion"}
    assert light.clamp_distortion.value < hard.clamp_distortion.value
    middle = pads.triples[0].clamp.at
    away = np.hypot(hard.surface.nodes[:, 0] - middle[0], hard.surface.nodes[:, 1] - middle[1])
    assert hard.moved[away < 12.0, 2].mean() < -0.001


@pytest.mark.parametrize("name", MATERIALS)
def test_materials_have_numbers_with_a_source(name: str) -> None:
    one = find_material(name.upper().replace("-", " "))
    assert one.name == name and len(one.source) > 5
    assert 1000 < one.elastic_modulus < 250_000 and 0.2 < one.poisson < 0.45 and 1000 < one.density < 9000


@pytest.mark.parametrize("text", ["cheese", "69000", "69000,x", "69000,0.6", "-1,0.3", "1,2,3"])
def test_what_is_no_material_is_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"[Pp]oisson|Young"):
        find_material(text)


def test_what_is_not_known_is_asked_for_in_a_sentence() -> None:
    part = workhold.Workpiece.from_points("plate", CORNERS)
    bare = workhold.design(part, TOOLKITS["vise"], best=1)[0]
    with pytest.raises(InputError, match="depends on how thick it is: give its thickness"):
        bare.bending()
    with pytest.raises(
        InputError, match="not a figure of bending to rank by: choose clamp-distortion or give"
    ):
        find_bending_figure("tilt")


def test_without_the_library_it_is_said_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    library.load_elements.cache_clear()
    monkeypatch.setitem(sys.modules, "ngsolve", None)
    try:
        with pytest.raises(InputError, match=r"not installed: pip install 'ngsolve>=6\.2\.2608'\.$"):
            library.load_elements()
    finally:
        library.load_elements.cache_clear()


def test_what_is_told_has_its_error_its_place_and_its_remedy() -> None:
    one = bent(result_in("vise"), jaw_force=3000.0)
    clamping, give, stress = one.list_sentences("jaw", MILLIMETRE)
    assert stress.startswith("Clamping stresses it by up to ") and "MPa" in stress
    assert clamping.startswith("At a jaw force of 3000 N clamping bends the part by ")
    assert "give or take" in clamping and clamping.endswith("that springs back.")
    assert "under load 1" in give
    assert "thou" in one.list_sentences("jaw", INCH)[0]
    assert one.list_warnings(None, MILLIMETRE) == one.list_warnings(1.0, MILLIMETRE) == []
    assert len(one.list_warnings(1e-6, MILLIMETRE)) == 2
    assert one.give is not None and one.give.value != one.clamp_distortion.value
    between = (one.give.value + one.clamp_distortion.value) / 2
    (only,) = one.list_warnings(between, MILLIMETRE)
    assert ("at the cutter" in only) == (one.give.value > between)
    data = one.to_data()
    assert data["clamp_distortion"]["value"] == pytest.approx(one.figures["clamp_distortion"], rel=1e-5)
    assert data["give"]["load"] == 1 and data["elements"] == one.elements


def test_without_a_force_all_is_for_a_thousand_newtons() -> None:
    part = workhold.Workpiece.from_points("plate", CORNERS)
    first = workhold.design(part, TOOLKITS["vise"], best=1, thickness=HIGH)[0]
    one = first.bending()
    assert one.is_assumed and one.jaw_force == 1000.0
    assert one.list_sentences("jaw", MILLIMETRE)[0].startswith("For each 1000 N of jaw force clamping bends")
