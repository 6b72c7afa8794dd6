"""The largest stress on a bent part, against closed forms, and whom it warns of which wall."""

from __future__ import annotations

import numpy as np
import pytest
from attrs import evolve

import workhold
from bent_bodies import METAL, RATIO, block, bodies, even, need_elements, over, ring, shared
from workhold import Workpiece
from workhold.bending.asking import OF_STRESS, BendingQuestion, find_bendings, find_pressed
from workhold.bending.elastic import ElasticBody, PointForces, make_rigid_motions
from workhold.bending.figures import Bending
from workhold.bending.meshing import make_mesh
from workhold.bending.shape import PrismShape
from workhold.bending.stress import StressedSurface
from workhold.model.elastic_material import MATERIALS, find_material
from workhold.units import INCH, MILLIMETRE

need_elements()

FORCE = 1000.0


def stress_under(body: ElasticBody, loads: list[PointForces]) -> np.ndarray:
    """Von Mises' stress at the nodes of each face under some loads together."""
    moved = body.move_nodes(body.solve_loads([sum(body.compute_work(load) for load in loads)])[0])
    return StressedSurface(body.surface, METAL).compute_mises_stress(moved)


def test_a_bar_squeezed_is_stressed_alike_all_over() -> None:
    length, width, high = 60.0, 20.0, 15.0
    body = bodies(block, (length, width), high)[0]
    ends = [over(x, even(0, width), even(0, high)) for x in (0.0, length)]
    loads = [shared(ends[0], (FORCE, 0, 0), (-1, 0, 0)), shared(ends[1], (-FORCE, 0, 0), (1, 0, 0))]
    along = body.surface.nodes[body.surface.faces][..., 0]
    inside = (along > 20.0) & (along < 40.0)
    assert stress_under(body, loads)[inside] == pytest.approx(FORCE / (width * high), rel=0.02)


def test_a_strip_of_plate_bent_to_a_cylinder_is_stressed_by_six_moments_over_its_thickness_squared() -> None:
    length, width, high, moment = 80.0, 50.0, 3.0, 10.0
    heights = even(0, high)
    loads = []
    for axis, size, places, share in (
        (0, length, even(0, width, 40), 1.0),
        (1, width, even(0, length, 40), RATIO),
    ):
        for side in (0.0, 1.0):
            points = over(size * side, places, heights) if axis == 0 else over(places, size * side, heights)
            total = moment * share * (width if axis == 0 else length)
            forces = np.zeros_like(points)
            lever = (2 * side - 1) * (points[:, 2] - high / 2)
            forces[:, axis] = total * lever / ((heights - high / 2) ** 2).sum() / len(places)
            loads.append(PointForces(points, forces, (2 * side - 1) * np.eye(3)[axis]))
    body = ElasticBody(bodies(block, (length, width), high)[0].mesh, METAL, 3)
    places = body.surface.nodes[body.surface.faces]
    middle = (np.abs(places[..., 0] - 40.0) < 15.0) & (np.abs(places[..., 1] - 25.0) < 8.0)
    expected = 6 * moment / high**2 * np.sqrt(1 - RATIO + RATIO**2)
    assert stress_under(body, loads)[middle] == pytest.approx(expected, rel=0.03)


def test_round_a_bore_a_pulled_plate_is_stressed_three_times_as_much() -> None:
    """Of a strip of finite width, by R. B. Heywood: 2 + (1 - d / W)³ of the stress beside the bore."""
    length, width, high, radius = 120.0, 60.0, 6.0, 5.0
    hole = [[60 - radius, 30, 1], [60 + radius, 30, 1]]
    outline = [[0, 0, 0], [length, 0, 0], [length, width, 0], [0, width, 0]]
    part = Workpiece.from_loops("plate", [outline, hole])
    body = ElasticBody(make_mesh(PrismShape(part, high)), METAL, 3)
    ends = [over(x, even(0, width), even(0, high)) for x in (0.0, length)]
    loads = [shared(ends[0], (-FORCE, 0, 0), (-1, 0, 0)), shared(ends[1], (FORCE, 0, 0), (1, 0, 0))]
    found = stress_under(body, loads)
    at = body.surface.nodes[body.surface.faces].reshape(-1, 3)[found.argmax()]
    assert np.hypot(*(at[:2] - (60.0, 30.0))) == pytest.approx(radius, abs=0.1) and abs(at[1] - 30.0) > 4.5
    wide = 2 * radius / width
    expected = (2 + (1 - wide) ** 3) * FORCE / (high * width * (1 - wide))
    assert found.max() == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize("make, sizes", [(block, (60.0, 20.0)), (ring, (40.0, 3.0))])
def test_a_rigid_motion_stresses_nothing(make, sizes) -> None:
    surface = bodies(make, sizes, 15.0)[0].surface
    moved = make_rigid_motions(surface.nodes) @ np.array([1.0, -2.0, 3.0, 1e-3, -2e-3, 3e-3])
    assert StressedSurface(surface, METAL).compute_mises_stress(moved).max() < 1e-4
    stretched = surface.nodes * 1e-3
    alike = StressedSurface(surface, METAL).compute_mises_stress(stretched)
    flat = METAL.elastic_modulus * 1e-3 / (1 - RATIO)
    assert np.median(alike) == pytest.approx(flat, rel=1e-6)


def test_sharp_inner_edges_are_found_and_no_others() -> None:
    corner = Workpiece.from_points("L", [(0, 0), (50, 0), (50, 20), (20, 20), (20, 50), (0, 50)])
    surface = make_mesh(PrismShape(corner, 10.0)).surface
    points = StressedSurface(surface, METAL).inner_edges
    assert points[:, :2] == pytest.approx(np.tile([20.0, 20.0], (len(points), 1)))
    assert points[:, 2].min() == 0.0 and points[:, 2].max() == pytest.approx(10.0)
    assert np.diff(np.sort(points[:, 2])).max() <= 0.5 + 1e-9
    for make, sizes in ((block, (60.0, 20.0)), (ring, (40.0, 3.0))):
        assert not len(StressedSurface(bodies(make, sizes, 10.0)[0].surface, METAL).inner_edges)


def bend_channel(force: float, material: str = "aluminium-6061", jaw_force: float | None = None) -> Bending:
    """A channel pinched at its walls of 5 mm, 60 mm deep, between flat jaws."""
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
    question = BendingQuestion(find_material(material), high, force)
    return find_bendings(result, [row], PrismShape(channel, high), question)[0]


def test_the_wall_that_would_yield_is_named_at_its_root() -> None:
    """6 M / h t² of a cantilever under even pressure, a millimetre from its root."""
    bent = bend_channel(1600.0)
    x, y, _ = bent.stress.at
    assert 20.5 < y < 30.0 and (x < 5.01 or x > 54.99)
    nominal = 6 * (1600.0 / 80) * 59.0**2 / 2 / (20.0 * 5.0**2)
    assert bent.stress.value == pytest.approx(nominal, rel=0.15)
    assert bent.yields and bent.stress.error > OF_STRESS * bent.stress.value
    (warning,) = bent.list_warnings(None, MILLIMETRE)
    assert warning.startswith("The part would yield: clamping stresses it by ") and "bear 276 MPa" in warning
    assert "ksi" in bent.list_warnings(None, INCH)[0]
    assert "reckoned to yield at 276 MPa" in " ".join(bent.list_sentences("jaw", MILLIMETRE))
    assert (
        bent.to_data()["stress"]["at"] == pytest.approx(list(bent.stress.at), abs=1e-6)
        and bent.to_data()["yields"]
    )


def test_less_force_a_stronger_material_or_an_unknown_one_warns_nobody() -> None:
    light = bend_channel(400.0)
    assert light.stress.value == pytest.approx(bend_channel(1600.0).stress.value / 4, rel=1e-6)
    assert not light.yields and light.list_warnings(None, MILLIMETRE) == []
    assert not bend_channel(800.0, "aluminium-7075").yields
    unknown = bend_channel(1600.0, "69000,0.33")
    assert unknown.yields is None and unknown.list_warnings(None, MILLIMETRE) == []
    assert "yield" not in " ".join(unknown.list_sentences("jaw", MILLIMETRE))
    assert bend_channel(1600.0, "69000,0.33,300").yields


def test_what_is_nearly_as_strong_might_yield() -> None:
    bent = bend_channel(1600.0)
    for side in (0.5, -0.5):
        between = bent.stress.value + side * bent.stress.error
        (warning,) = bend_channel(1600.0, f"68900,0.33,{between}").list_warnings(None, MILLIMETRE)
        assert warning.startswith("The part might yield")


def test_without_a_force_nobody_is_warned() -> None:
    bent = bend_channel(1600.0)
    stated = evolve(bent, jaw_force=1000.0, is_assumed=True)
    assert stated.yields is None and stated.list_warnings(None, MILLIMETRE) == []


def test_what_presses_does_not_count() -> None:
    bent = bend_channel(1600.0)
    away = np.linalg.norm(bent.surface.nodes[bent.pressed] - np.array(bent.stress.at), axis=1)
    assert away.min() > 0.0
    assert not find_pressed(np.array([bent.stress.at]), bent.surface.nodes[bent.pressed], 0.01).any()


@pytest.mark.parametrize("name", MATERIALS)
def test_strengths_have_a_source(name: str) -> None:
    one = find_material(name)
    assert one.strength is not None and 20 < one.strength < 600 and len(one.strength_source) > 5
