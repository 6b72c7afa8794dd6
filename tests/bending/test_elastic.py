"""An elastic body against closed forms, and what must hold of every one."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, pi, radians, sin

import numpy as np
import pytest
from numpy.typing import NDArray

from bent_bodies import (
    METAL,
    MODULUS,
    RATIO,
    UP,
    block,
    bodies,
    even,
    moved,
    need_elements,
    over,
    ring,
    shared,
)
from workhold import InputError, Load, Plate, Workpiece, design
from workhold.bending import meshing
from workhold.bending.elastic import ElasticBody, PointForces, make_rigid_motions
from workhold.bending.laying import Constraints, find_rigid_motion
from workhold.bending.meshing import OF_SHEET, PER_SQUARE, choose_size, make_mesh
from workhold.bending.patches import find_foot_corners, make_foot
from workhold.bending.shape import PrismShape
from workhold.bending.surface import LATTICE
from workhold.model.elastic_material import ElasticMaterial

need_elements()

SHEAR = MODULUS / (2 * (1 + RATIO))
FORCE = 100.0
CLOSE = 0.02


def test_a_cantilever_gives_way_as_timoshenko_says() -> None:
    length, width, high = 100.0, 10.0, 8.0
    body = bodies(block, (length, width), high)[1]
    root, tip = (over(x, even(0, width), even(0, high)) for x in (0.0, length))
    lever = root[:, 2] - high / 2
    bent = np.column_stack([-FORCE * length * lever / (lever**2).sum(), 0 * lever, 0 * lever])
    loads = [
        shared(tip, (0, 0, -FORCE), (1, 0, 0)),
        shared(root, (0, 0, FORCE), (-1, 0, 0)),
        PointForces(root, bent, np.array([-1.0, 0, 0])),
    ]
    slope = np.column_stack([lever / (lever**2).sum(), 0 * lever, 0 * lever])
    at_tip, at_root, turned = moved(
        body,
        loads,
        [
            shared(tip, (0, 0, 1), (1, 0, 0)),
            shared(root, (0, 0, 1), (-1, 0, 0)),
            PointForces(root, slope, np.array([-1.0, 0, 0])),
        ],
    )
    inertia, area = width * high**3 / 12, width * high
    expected = FORCE * length**3 / (3 * MODULUS * inertia) + 6 * FORCE * length / (5 * SHEAR * area)
    assert at_root - at_tip - turned * length == pytest.approx(expected, rel=CLOSE)


def pressed_between(length: float, width: float, high: float) -> tuple[list[PointForces], list[PointForces]]:
    """Three-point bending: pressed down in the middle, up at both ends; and how far the middle sinks."""
    across = even(0, width)
    lines = [over(x, across, high) for x in (length / 2, 0.0, length)]
    below = [over(x, across, 0.0) for x in (length / 2, 0.0, length)]
    loads = [
        shared(lines[0], (0, 0, -FORCE), (0, 0, 1)),
        *(shared(below[k], (0, 0, FORCE / 2), (0, 0, -1)) for k in (1, 2)),
    ]
    reads = [
        shared(below[0], (0, 0, -1), (0, 0, -1)),
        *(shared(lines[k], (0, 0, 0.5), (0, 0, 1)) for k in (1, 2)),
    ]
    return loads, reads


def test_a_beam_on_two_supports_sinks_in_its_middle() -> None:
    length, width, high = 160.0, 10.0, 8.0
    loads, reads = pressed_between(length, width, high)
    sunk = sum(moved(bodies(block, (length, width), high)[1], loads, reads))
    inertia, area = width * high**3 / 12, width * high
    expected = FORCE * length**3 / (48 * MODULUS * inertia) + 6 * FORCE * length / (20 * SHEAR * area)
    assert sunk == pytest.approx(expected, rel=CLOSE)


def test_a_strip_of_plate_bent_to_a_cylinder_has_the_stiffness_of_a_plate() -> None:
    """Moments along its ends, and Poisson's part of them along its sides, which keeps it from curling across."""
    length, width, high, moment = 80.0, 50.0, 3.0, 10.0
    heights = even(0, high)
    lever = heights - high / 2
    along, across = even(0, length, 40), even(0, width, 40)
    loads = []
    for axis, size, places, share in ((0, length, across, 1.0), (1, width, along, RATIO)):
        for side in (0.0, 1.0):
            points = over(size * side, places, heights) if axis == 0 else over(places, size * side, heights)
            pull = (2 * side - 1) * (points[:, 2] - high / 2)
            total = moment * share * (width if axis == 0 else length)
            forces = np.zeros_like(points)
            forces[:, axis] = total * pull / (lever**2).sum() / len(places)
            loads.append(PointForces(points, forces, (2 * side - 1) * np.eye(3)[axis]))
    spots = [over(x, even(20, 30, 4), high) for x in (length / 2, 0.0, length)]
    reads = [
        shared(spots[0], (0, 0, 1), (0, 0, 1)),
        *(shared(spots[k], (0, 0, -0.5), (0, 0, 1)) for k in (1, 2)),
    ]
    stiffness = MODULUS * high**3 / (12 * (1 - RATIO**2))
    risen = sum(moved(bodies(block, (length, width), high)[1], loads, reads))
    assert risen == pytest.approx(moment * length**2 / (8 * stiffness), rel=CLOSE)


def test_a_ring_pinched_across_its_diameter_gives_way_as_roark_says() -> None:
    radius, wall, high = 40.0, 3.0, 10.0
    body = bodies(ring, (radius, wall), high)[1]
    sides = [
        (1.0, over(radius + wall / 2, 0.0, even(0, high))),
        (-1.0, over(-radius - wall / 2, 0.0, even(0, high))),
    ]
    loads = [shared(points, (-side * FORCE, 0, 0), (side, 0, 0)) for side, points in sides]
    inner = [
        (1.0, over(radius - wall / 2, 0.0, even(0, high))),
        (-1.0, over(-radius + wall / 2, 0.0, even(0, high))),
    ]
    nearer = sum(moved(body, loads, [shared(points, (-side, 0, 0), (-side, 0, 0)) for side, points in inner]))
    inertia, area = high * wall**3 / 12, high * wall
    hoop = inertia / (area * radius**2)
    sheared = 1.2 * MODULUS * hoop / SHEAR
    # W. C. Young, R. G. Budynas, Roark's Formulas for Stress and Strain, table 9.2, case 1.
    share = pi * (1 - hoop + sheared) / 4 - 2 * (1 - hoop) ** 2 / pi
    assert nearer == pytest.approx(FORCE * radius**3 / (MODULUS * inertia) * share, rel=CLOSE)


def test_a_bar_squeezed_between_jaws_gets_shorter_and_thicker() -> None:
    length, width, high = 60.0, 20.0, 15.0
    body = bodies(block, (length, width), high)[0]
    ends = [over(x, even(0, width), even(0, high)) for x in (0.0, length)]
    loads = [shared(ends[0], (FORCE, 0, 0), (-1, 0, 0)), shared(ends[1], (-FORCE, 0, 0), (1, 0, 0))]
    sides = [over(even(20, 40), y, even(0, high)) for y in (0.0, width)]
    first, last, low, far = moved(
        body,
        loads,
        [
            shared(ends[0], (1, 0, 0), (-1, 0, 0)),
            shared(ends[1], (1, 0, 0), (1, 0, 0)),
            shared(sides[0], (0, 1, 0), (0, -1, 0)),
            shared(sides[1], (0, 1, 0), (0, 1, 0)),
        ],
    )
    strain = FORCE / (width * high) / MODULUS
    assert first - last == pytest.approx(strain * length, rel=CLOSE)
    assert far - low == pytest.approx(RATIO * strain * width, rel=CLOSE)


def some_loads(body: ElasticBody, count: int = 6) -> list[PointForces]:
    """Forces anywhere on the surface, in any direction."""
    random = np.random.default_rng(7)
    nodes = body.surface.nodes
    return [
        PointForces(nodes[random.integers(len(nodes), size=9)], random.normal(size=(9, 3)))
        for _ in range(count)
    ]


@pytest.mark.parametrize("make, sizes", [(block, (60.0, 20.0)), (ring, (40.0, 3.0))])
def test_what_one_load_moves_another_by_is_what_that_moves_the_first_by(
    make: Callable[..., Workpiece], sizes: tuple[float, ...]
) -> None:
    """Maxwell and Betti, also of loads that do not balance, and on curved elements."""
    body = bodies(make, sizes, 15.0)[0]
    works = np.array([body.compute_work(load) for load in some_loads(body)])
    compliance = np.einsum("ank,bnk->ab", works, body.solve_loads(works))
    assert np.abs(compliance - compliance.T).max() <= 1e-8 * np.abs(compliance).max()
    assert np.linalg.eigvalsh(compliance).min() > 0.0


def test_loads_superposed_are_loads_at_once() -> None:
    body = bodies(block, (60.0, 20.0), 15.0)[0]
    works = np.array([body.compute_work(load) for load in some_loads(body)])
    factors = np.array([1.0, -2.0, 0.3, 5.0, -0.7, 1.1])
    superposed = np.tensordot(factors, body.solve_loads(works), axes=1)
    at_once = body.solve_loads([np.tensordot(factors, works, axes=1)])[0]
    assert np.abs(superposed - at_once).max() <= 1e-10 * np.abs(at_once).max()


@pytest.mark.parametrize("order", [2, 3])
def test_work_is_that_of_the_forces_on_every_motion_that_elements_know(order: int) -> None:
    """Rigid motions, stretches and curved ones of the second order; nodes move as far as these say."""
    from ngsolve import CoefficientFunction, GridFunction, x, y, z

    body = ElasticBody(bodies(block, (60.0, 20.0), 15.0)[0].mesh, METAL, order)
    probe = GridFunction(body.space)
    for of in (lambda x, y, z: (y, -x, 1 + z), lambda x, y, z: (x * y, z * z, x * x - y)):
        probe.Set(CoefficientFunction(of(x, y, z)))
        own = probe.vec.FV().NumPy().reshape(-1, 3)[body.surface_unknowns[0]]
        assert body.move_nodes(own) == pytest.approx(field_at(of, body.surface.nodes), abs=1e-9)
        for load in some_loads(body):
            expected = (load.forces * field_at(of, load.points)).sum()
            assert (body.compute_work(load) * own).sum() == pytest.approx(expected, abs=1e-6)


def field_at(
    of: Callable[..., tuple[NDArray[np.float64], ...]], points: NDArray[np.float64]
) -> NDArray[np.float64]:
    """A movement (M, 3) at points (M, 3)."""
    return np.stack([np.broadcast_to(one, len(points)) for one in of(*points.T)], axis=1)


def test_every_node_of_the_surface_is_there_once() -> None:
    surface = bodies(ring, (40.0, 3.0), 10.0)[0].surface
    assert len(np.unique(np.round(surface.nodes, 6), axis=0)) == len(surface.nodes)
    everywhere = surface.interpolate_points(np.arange(len(surface.faces)), LATTICE)
    assert surface.nodes[surface.faces] == pytest.approx(everywhere, abs=1e-9)
    corners = surface.nodes[surface.triangles[:, :3]]
    area = (
        np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
        / 2
    )
    level, round_ = 4 * pi * 40.0 * 3.0, 2 * pi * 80.0 * 10.0
    assert area == pytest.approx(level + round_, rel=2e-3)
    middles = corners.mean(axis=1) + 1e-3 * surface.normals
    far = np.abs(np.hypot(*middles[:, :2].T) - 40.0)
    assert ((far > 1.49) | (np.abs(middles[:, 2] - 5.0) > 5.0)).all()


def test_a_turn_of_part_and_forces_turns_the_movement() -> None:
    angle = radians(33.0)
    turn = np.array([[cos(angle), -sin(angle), 0], [sin(angle), cos(angle), 0], [0, 0, 1]])
    corners = [(0, 0), (60, 0), (60, 20), (25, 20), (0, 12)]
    there = [tuple(turn[:2, :2] @ corner) for corner in corners]
    found = []
    for points, carry in ((corners, np.eye(3)), (there, turn)):
        body = ElasticBody(make_mesh(PrismShape(Workpiece.from_points("part", points), 6.0)), METAL)
        ends = [over(0.0, even(1, 11), even(0, 6)), over(60.0, even(1, 11), even(0, 6))]
        loads = [
            PointForces(
                end @ carry.T,
                np.tile(np.array([side * FORCE / len(end), 0, 0]) @ carry.T, (len(end), 1)),
                carry @ [-side, 0, 0],
            )
            for side, end in zip((1.0, -1.0), ends, strict=True)
        ]
        read = over(42.0, 20.0, even(0, 6))
        reads = [
            PointForces(
                read @ carry.T, np.tile(carry @ along, (len(read), 1)) / len(read), carry @ [0, 1.0, 0]
            )
            for along in np.eye(3)[:2]
        ]
        reads.append(
            PointForces(
                ends[0] @ carry.T,
                np.tile(carry @ [1.0, 0, 0], (len(ends[0]), 1)) / len(ends[0]),
                carry @ [-1.0, 0, 0],
            )
        )
        found.append(moved(body, loads, reads))
    assert found[1] == pytest.approx(found[0], rel=1e-2, abs=1e-7)


def test_a_thicker_part_never_bends_more() -> None:
    sunk = []
    for high in (4.0, 5.0, 6.0, 8.0, 11.0):
        loads, reads = pressed_between(80.0, 20.0, high)
        sunk.append(sum(moved(bodies(block, (80.0, 20.0), high)[0], loads, reads)))
    assert sunk == sorted(sunk, reverse=True)


def test_a_finer_body_is_no_stiffer_and_keeps_to_round_faces() -> None:
    coarse, fine = bodies(ring, (40.0, 3.0), 10.0)
    higher = ElasticBody(coarse.mesh, METAL, 3)
    assert fine.elements == 8 * coarse.elements
    for body in (coarse, fine):
        far = np.hypot(*body.surface.nodes[:, :2].T)
        level = np.abs(body.surface.nodes[:, 2] - 5.0) < 4.99
        assert np.abs(np.abs(far[level] - 40.0) - 1.5).max() < 1e-3
    loads = [
        shared(over(side * 41.5, 0.0, even(0, 10)), (-side * FORCE, 0, 0), (side, 0, 0))
        for side in (1.0, -1.0)
    ]
    works = [[sum(body.compute_work(load) for load in loads)] for body in (coarse, higher, fine)]
    energy = [
        float((work[0] * body.solve_loads(work)[0]).sum())
        for body, work in zip((coarse, higher, fine), works, strict=True)
    ]
    assert energy[0] <= min(energy[1:]) and max(energy[1:]) <= 1.02 * energy[0]


def test_twice_as_stiff_bends_half_as_far() -> None:
    mesh = make_mesh(PrismShape(block(80.0, 20.0), 6.0))
    loads, reads = pressed_between(80.0, 20.0, 6.0)
    once, twice = (
        sum(moved(ElasticBody(mesh, ElasticMaterial("own", modulus, 0.3, 1000.0)), loads, reads))
        for modulus in (1e5, 2e5)
    )
    assert once == pytest.approx(2 * twice, rel=1e-9)


def test_a_force_on_a_thin_wall_lands_on_the_side_that_it_presses_on() -> None:
    body = bodies(ring, (40.0, 3.0), 10.0)[0]
    for far, side in ((41.5, 1.0), (38.5, -1.0)):
        # Half through the wall, both sides are as near.
        footing = body.surface.find_footing(over(40.0, 0.0, even(2, 8)), np.array([side, 0, 0]))
        nodes = body.surface.nodes[body.surface.faces[footing.faces]].reshape(-1, 3)
        assert np.hypot(*nodes[:, :2].T) == pytest.approx(far, abs=1e-3)


def test_a_body_that_is_laid_against_three_points_and_a_floor_is_where_they_are() -> None:
    random = np.random.default_rng(3)
    motion = random.normal(size=6)
    points, normals = random.normal(size=(6, 3)), np.vstack([np.eye(3)[[0, 0, 1]], np.tile(UP, (3, 1))])
    rows = np.einsum("nk,nkj->nj", normals, make_rigid_motions(points))
    levels = [Constraints(rows[part], rows[part] @ motion) for part in (slice(0, 3), slice(3, 6))]
    assert find_rigid_motion(levels) == pytest.approx(motion)


def test_a_thin_part_has_elements_about_as_large_as_twice_its_thickness(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(meshing, "TETRAHEDRA", 100)
    corners = make_mesh(PrismShape(block(80.0, 60.0), 2.0)).surface.corners
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()
    assert longest < 1.5 * 2.0 * meshing.OF_LEAST_EXTENT


def test_a_prism_has_its_holes_and_may_run_either_way_round() -> None:
    """Arcs, too: a slot in a disc."""
    slot = [[-10, -4, 0], [10, -4, 1], [10, 4, 0], [-10, 4, 1]]
    turned = [[-10, 4, 0], [10, 4, -1], [10, -4, 0], [-10, -4, -1]]
    expected = 5.0 * (pi * 900.0 - 160.0 - pi * 16.0)
    for hole in (slot, turned):
        disc = Workpiece.from_loops("disc", [[[-30, 0, 1], [30, 0, 1]], hole])
        assert PrismShape(disc, 5.0).build().mass == pytest.approx(expected, rel=1e-6)


def test_the_foot_is_weighted_by_its_area() -> None:
    """Elements are smaller round a bore, and no heavier for it."""
    hole = [[48, 10, 1], [54, 10, 1]]
    part = Workpiece.from_loops("part", [[[0, 0, 0], [60, 0, 0], [60, 20, 0], [0, 20, 0]], hole])
    surface = make_mesh(PrismShape(part, 4.0)).surface
    foot = make_foot(find_foot_corners(surface.nodes, surface.triangles, surface.normals, 0.0))
    assert foot is not None
    area, bore = 1200.0, pi * 9.0
    middle = (area * 30.0 - bore * 51.0) / (area - bore)
    assert foot.middle == pytest.approx([middle, 10.0, 0.0], abs=0.02)
    assert foot.make_force(UP).wrench[[2, 4]] == pytest.approx([1.0, -middle], abs=0.02)
    turning = foot.make_unit_moment().wrench
    assert np.abs(turning[:3]).max() < 1e-12 and turning[5] == pytest.approx(1.0)


def test_a_part_that_is_no_solid_is_refused_in_a_sentence() -> None:
    class Nothing:
        def build(self):
            from netgen import occ

            box = occ.Box((0, 0, 0), (1, 1, 1))
            return box - occ.Box((-1, -1, -1), (2, 2, 2))

    with pytest.raises(InputError, match="cannot be meshed"):
        make_mesh(Nothing())


def block_with_bores() -> PrismShape:
    """A block that the mesher does not fill where it is asked for few elements round a bore."""
    bores = [[[x - 3, y, 1], [x + 3, y, 1]] for x in range(12, 90, 15) for y in (12, 30)]
    outline = [[0, 0, 0], [100, 0, 0], [100, 42, 0], [0, 42, 0]]
    return PrismShape(Workpiece.from_loops("block", [outline, *bores]), 10.0)


FAILING = {"grading": 1.0, "curvaturesafety": 0.3}


def test_a_part_that_few_elements_do_not_fill_is_filled_with_more(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """The mesher says pages then, which nobody is shown."""
    monkeypatch.setattr(meshing, "FEW", FAILING)
    assert make_mesh(block_with_bores()).made.ne > 0
    said = capfd.readouterr()
    assert said.out == said.err == ""


def test_a_part_that_nothing_fills_is_refused_in_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(meshing, "FEW", FAILING)
    monkeypatch.setattr(meshing, "MORE", (FAILING,))
    with pytest.raises(InputError, match="cannot be meshed"):
        make_mesh(block_with_bores())


def test_a_wide_sheet_takes_larger_elements_and_a_wider_one_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert choose_size(60 * 40 * 30, 30) == pytest.approx((60 * 40 * 30 / 170) ** (1 / 3))
    for thick, wide in ((6.0, 600.0), (3.0, 600.0), (3.0, 1000.0)):
        size = choose_size(0.7 * wide * wide * thick, thick)
        assert size <= OF_SHEET * thick and PER_SQUARE * 0.7 * wide**2 / size**2 <= meshing.MOST_TETRAHEDRA
    with pytest.raises(
        InputError, match=r"the part is a sheet that needs about 203,125 elements.*smaller piece of it"
    ):
        choose_size(2e6 * 1.0, 1.0)
    # Long before anything is meshed.
    with pytest.raises(InputError, match="the part is a sheet"):
        make_mesh(PrismShape(block(80.0, 60.0), 1e-3))
    monkeypatch.setattr(meshing, "TETRAHEDRA", 150)
    monkeypatch.setattr(meshing, "MOST_TETRAHEDRA", 1500)
    sheet = PrismShape(block(200.0, 130.0), 3.0)
    coarse = make_mesh(sheet)
    monkeypatch.setattr(meshing, "MOST_TETRAHEDRA", 12000)
    fine = make_mesh(sheet)
    assert coarse.made.ne < 1500 < fine.made.ne


@pytest.mark.thorough
def test_a_coarse_sheet_bends_as_a_fine_one_within_its_error(monkeypatch: pytest.MonkeyPatch) -> None:
    plate = Plate(pitch=25, peg_radius=4, columns=12, rows=8)
    result = design(block(200.0, 130.0), plate, best=2, loads=[Load(points=[(80, 70)], force=80)])
    monkeypatch.setattr(meshing, "TETRAHEDRA", 150)
    fine = result.bend(thickness=3.0, jaw_force=300.0)
    monkeypatch.setattr(meshing, "MOST_TETRAHEDRA", 1500)
    for one, other in zip(result.bend(thickness=3.0, jaw_force=300.0), fine, strict=True):
        assert one.bent is not None and other.bent is not None and one.bent.give is not None
        assert one.bent.elements < 1500 < other.bent.elements and other.bent.give is not None
        for coarse, exact in (
            (one.bent.clamp_distortion, other.bent.clamp_distortion),
            (one.bent.give, other.bent.give),
        ):
            assert abs(coarse.value - exact.value) <= coarse.error + exact.error
