"""A verification derives what flat jaws hold, and sees a fault in each rule."""

import json

import numpy as np
import pytest
from attrs import evolve

import workhold
from jaw_examples import DISC, ELL, LOADS, TRIANGLE, held, rectangle, vise
from workhold import InputError, Load, Restrictions, Workpiece
from workhold.model.jaw_hold import JawPatch
from workhold.verification import verify, verify_file
from workhold.verification.jaw_forces import HeldBetweenJaws

STEPPED = Workpiece.from_points(
    "stepped", [(0, 0), (30, 0), (30, 8), (50, 8), (50, 0), (90, 0), (90, 40), (0, 40)]
)
OBLONG = Workpiece.from_loops("oblong", [[[0, 0, 0], [50, 0, 1], [50, 20, 0], [0, 20, 1]]])


@pytest.mark.thorough
@pytest.mark.parametrize("part", [rectangle(), ELL, TRIANGLE, DISC, STEPPED, OBLONG, rectangle(300, 60)])
@pytest.mark.parametrize("stop", [None, "both"])
def test_every_fixture_is_proven(part, stop):
    outcome = verify(held(part, vise(stop=stop, stop_offset=2), loads=LOADS))
    assert outcome.holds and outcome.proven == outcome.fixtures > 0, outcome.unproven[:2] or outcome.faults


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(6))
def test_forces_are_those_of_the_other_method(seed):
    rng = np.random.default_rng(seed)
    loads = [
        Load(
            points=rng.uniform(0, 60, 2),
            force=rng.uniform(50, 800),
            directions=(turn := rng.uniform(0, 300), turn + rng.choice([0, 40])),
            height=rng.uniform(0, 25),
            upward=rng.normal() * 200,
            moment=rng.normal() * 4000,
        )
        for _ in range(3)
    ]
    corners = [(0, 0), (60 + 40 * rng.random(), 0), (70, 50), (5, 50)]
    result = held(Workpiece.from_points("part", corners), vise(parallels=[30]), loads=loads)
    outcome = verify(result)
    assert outcome.holds, outcome.unproven[:2]


def result_with(change):
    """A result whose first fixture is changed."""
    result = held(loads=LOADS, toolkit=vise(stop="left"))
    fixtures = list(result)
    fixtures[0] = change(fixtures[0])
    holds = tuple(one.hold for one in fixtures)
    theta = np.array([np.radians(one.pose.theta_deg) for one in fixtures])
    position = np.array([(one.pose.x, one.pose.y) for one in fixtures])
    return evolve(result, holds=holds, table=evolve(result.table, theta=theta, position=position))


def hold_with(**changes):
    return lambda fixture: evolve(fixture, hold=evolve(fixture.hold, **changes))


def moved(**by):
    return lambda fixture: evolve(
        fixture,
        pose=evolve(fixture.pose, **{key: getattr(fixture.pose, key) + value for key, value in by.items()}),
    )


def shrunk(fixture):
    ((x0, x1, z0, z1),) = fixture.hold.fixed.rectangles
    patch = evolve(fixture.hold.fixed, rectangles=((x0, x1 - 1e-4, z0, z1),))
    return evolve(fixture, hold=evolve(fixture.hold, fixed=patch))


def on_another_face(fixture):
    return evolve(fixture, hold=evolve(fixture.hold, moving=evolve(fixture.hold.moving, segments=(1,))))


def forced(factor):
    def change(fixture):
        *others, last = fixture.hold.clamp_needed_each
        assert last > 0
        return evolve(fixture, hold=evolve(fixture.hold, clamp_needed_each=(*others, last * factor)))

    return change


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("change", "words"),
    [
        (hold_with(parallels=21.0), "no parallels of 21"),
        (hold_with(stop="right"), "none of those asked for"),
        (hold_with(opening=60.1), "not from 0 to 60.1"),
        (moved(y=0.1), "the part reaches"),
        (moved(x=0.1), "from where the stop is"),
        (moved(theta_deg=3.0), "the part reaches"),
        (shrunk, "what the fixed jaw touches"),
        (on_another_face, "the moving jaw touches faces"),
        (hold_with(full_contact=False), "all over what they touch"),
        (hold_with(warnings=("unfit: so",)), "unfit where a jaw touches corners alone"),
        (hold_with(above=9.0), "what stands above"),
        (forced(1.01), "load 3 asks for"),
        (forced(0.99), "load 3 asks for"),
        (hold_with(clamp_needed_each=(None, 1.0, 1.0)), "none is written"),
        (hold_with(clamp_needed_each=(1.0,)), "forces for 1 loads"),
    ],
)
def test_a_fault_is_refuted(change, words):
    outcome = verify(result_with(change))
    assert not outcome.holds
    assert words in outcome.unproven[0].reason


def test_repeated_fixture_and_wrong_order_are_faults():
    result = held(ELL, vise(parallels=[20]))
    twice = evolve(
        result,
        holds=(result.holds[0], *result.holds[:-1]),
        table=result.table.take(np.array([0, 0, 1, 2, 3])),
    )
    assert "same as fixture 1" in verify(twice).unproven[0].reason
    back = np.arange(len(result))[::-1]
    turned = evolve(result, holds=result.holds[::-1], table=result.table.take(back))
    assert any("better than the one before" in fault for fault in verify(turned).faults)


def test_opening_beyond_the_vise_and_angles_not_asked_for():
    result = held()
    narrow = evolve(result, query=evolve(result.query, toolkit=vise(max_opening=70)))
    assert any("would open 100" in one.reason for one in verify(narrow).unproven)
    turned = evolve(result, query=evolve(result.query, restrictions=Restrictions(angles=[(0, 0)])))
    assert any("not asked for" in one.reason for one in verify(turned).unproven)


def test_load_that_no_force_holds_is_none_in_both():
    point = JawPatch(((0.0, 0.0, 0.0, 20.0),), (0,))
    held_by_lines = HeldBetweenJaws.from_patches(point, point, 40.0, 0.1, [], 1.0)
    assert held_by_lines.compute_needed_force((0.0, 20.0, 10.0), (50.0, 0.0, 0.0), 0.0) == pytest.approx(
        250.0, rel=1e-6
    )
    assert held_by_lines.compute_needed_force((0.0, 20.0, 0.0), (0.0, 0.0, -50.0), 0.0) == pytest.approx(
        0.0, abs=1e-6
    )


@pytest.fixture
def written(tmp_path):
    path = tmp_path / "result.json"
    workhold.save(held(loads=LOADS), path)
    return path


@pytest.mark.thorough
def test_file_is_read_back_and_verified(written, tmp_path):
    result = workhold.open(written)
    again = tmp_path / "again.json"
    workhold.save(result, again)
    assert again.read_bytes() == written.read_bytes()
    assert verify_file(written).holds
    assert workhold.verify(written, complete=True).holds


@pytest.mark.thorough
def test_search_sees_what_a_file_leaves_out(written):
    data = json.loads(written.read_text())
    del data["fixtures"][-1]
    for key in ("counts", "found"):
        data[key]["plain"] -= 1
    written.write_text(json.dumps(data))
    assert verify_file(written).holds
    outcome = workhold.verify(written, complete=True)
    assert any("does not list" in fault for fault in outcome.faults)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda one: one.pop("parallels"), "parallels: it is missing"),
        (lambda one: one["fixed"].update(rectangles=[]), "fixed.rectangles"),
        (lambda one: one.update(stop="top"), "stop"),
        (lambda one: one["moving"].update(segments=[99]), "does not name a face"),
        (lambda one: one.update(type="I"), "its type is not plain"),
    ],
)
def test_file_that_cannot_be_used_is_refused(written, change, words):
    data = json.loads(written.read_text())
    change(data["fixtures"][0])
    written.write_text(json.dumps(data))
    with pytest.raises(InputError, match=words):
        workhold.open(written)


@pytest.mark.thorough
def test_pegs_in_a_file_of_flat_jaws_are_refused(written):
    data = json.loads(written.read_text())
    data["fixtures"] = [{"type": "I", "pegs": [], "pose": {"theta_deg": 0, "x": 0, "y": 0}}]
    data["counts"] = data["found"] = data["distinct"] = {"plain": 1}
    written.write_text(json.dumps(data))
    for read in (workhold.open, verify_file):
        with pytest.raises(InputError):
            read(written)


@pytest.mark.thorough
def test_spreadsheet_has_a_row_for_each_and_columns_are_refused(tmp_path):
    result = held(loads=LOADS)
    workhold.save(result, tmp_path / "r.csv")
    lines = (tmp_path / "r.csv").read_text().splitlines()
    assert len(lines) == 1 + len(result) and lines[0].startswith("number,type,theta_deg")
    with pytest.raises(InputError, match="a file in columns is of pegs"):
        workhold.save(result, tmp_path / "r.npz")


@pytest.mark.thorough
@pytest.mark.parametrize("key", ["grip", "contact_area", "slip_reserve", "safety_reached"])
def test_figure_changed_in_a_file_is_refuted(key, tmp_path):
    result = held(loads=LOADS, jaw_force=5000, toolkit=vise(max_force=9000))
    path = tmp_path / "result.json"
    workhold.save(result, path)
    data = json.loads(path.read_text())
    data["fixtures"][0]["quality"][key] *= 1.01
    path.write_text(json.dumps(data))
    outcome = verify_file(path)
    assert [one.index for one in outcome.unproven] == [0]
    assert key.replace("_", " ") in outcome.unproven[0].reason
