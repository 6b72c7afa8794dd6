"""The figures of quality agree with their definitions, worked out by other means on hundreds of fixtures."""

from __future__ import annotations

from itertools import product
from math import cos, pi, radians, sin

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import linprog, root
from scipy.spatial import ConvexHull

from held import contacts, force_directions, held, load_wrench
from workhold import Fixture, Load, Plate, Result, Tolerance, Workpiece, design
from workhold.geometry.segment import Arc, make_segment_rows
from workhold.kernels.base.distance import measure_outline_distances
from workhold.model.fixture_table import FixtureTable
from workhold.model.own_outlines import measure_outline_diameter
from workhold.model.quality import (
    BEFORE_PINS,
    CLAMP_AMPLIFICATION,
    CLOSURE_MARGIN,
    END_DISTANCE,
    LOAD_REACTION,
    LOCATION_ERROR,
    WRENCH_RADIUS,
)
from workhold.statics.loads import compute_load_cases
from workhold.statics.quality import measure_quality

Array = NDArray[np.float64]


class TestHeld:
    """Properties of each part's fixtures."""

    def test_forces_and_closure_margin_are_those_of_the_search(self, result: Result) -> None:
        """The smallest entry of the null vector and the largest force per unit of jaw force, as found with the fixture."""
        quality = measure_quality(result.table, result.workpiece, result.toolkit)
        assert quality[:, CLOSURE_MARGIN] == pytest.approx(result.table.null_vector.min(axis=1), abs=1e-9)
        assert quality[:, CLAMP_AMPLIFICATION] == pytest.approx(result.table.force.max(axis=1), rel=1e-6)

    def test_wrench_radius_is_that_of_the_convex_hull(self, result: Result) -> None:
        """Qhull's nearest facet of the wrenches (n, (q - c) x n / L) is as far."""
        quality = measure_quality(result.table, result.workpiece, result.toolkit)
        radius = result.toolkit.peg_radius
        length = measure_outline_diameter(result.workpiece) / 2 + radius
        for fixture, found in zip(result, quality[:, WRENCH_RADIUS], strict=True):
            points, normals = contacts(fixture, result.workpiece, radius)
            points = points - result.workpiece.center
            moments = (points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0]) / length
            hull = ConvexHull(np.column_stack([normals, moments]))
            assert found == pytest.approx(-hull.equations[:, 3].max(), rel=1e-6, abs=1e-12)

    @pytest.mark.thorough
    def test_a_peg_can_walk_the_end_distance_and_no_farther(self, result: Result) -> None:
        """Along its face, either way, a peg stays clear of the rest of the part for that long; one of the four no longer."""
        quality = measure_quality(result.table, result.workpiece, result.toolkit)
        radius = result.toolkit.peg_radius
        for fixture, found in list(zip(result, quality[:, END_DISTANCE], strict=True))[::3]:
            points, normals = contacts(fixture, result.workpiece, radius)
            centers = points + radius * normals
            walks = [
                walk(result.workpiece, radius, peg.face, center)
                for peg, center in zip(fixture.pegs, centers, strict=True)
            ]
            assert found == pytest.approx(min(walks), abs=1e-5)

    @pytest.mark.thinned(4)
    def test_location_error_is_that_of_the_pose_solved_anew(self, result: Result) -> None:
        """The pose's derivatives, by solving the contact equations with one error at a time, give it over all corners."""
        tolerance = Tolerance(peg=0.012, face=0.03)
        quality = measure_quality(result.table, result.workpiece, result.toolkit, tolerance)
        points = silhouette(result.workpiece)
        for fixture, found in list(zip(result, quality[:, LOCATION_ERROR], strict=True))[::2]:
            moves = np.array([movement(fixture, result, points, peg) for peg in range(4)])
            faces = sorted({peg.face for peg in fixture.pegs})
            shares = np.array([[peg.face == face for peg in fixture.pegs] for face in faces], float)
            generators = np.concatenate(
                [tolerance.peg * moves, tolerance.face * np.tensordot(shares, moves, axes=1)]
            )
            corners = np.array(list(product((-1.0, 1.0), repeat=len(generators))))
            worst = np.linalg.norm(np.tensordot(corners, generators, axes=1), axis=2).max()
            assert found == pytest.approx(worst, rel=2e-4)

    @pytest.mark.thorough
    def test_load_reaction_is_the_worst_of_the_linear_programs(self, result: Result) -> None:
        """Least clamping by HiGHS: no sampled point and direction needs a larger peg force, and the one named needs it."""
        box = result.workpiece.bounds
        low, high = np.array(box[:2]), np.array(box[2:])
        random = np.random.default_rng(5)
        path = [tuple(random.uniform(low, high)) for _ in range(4)]
        loads = [
            Load(points=path[:1], force=120.0),
            Load(points=path, force=80.0, directions=(-50, 40), moment=300.0),
            Load(moment=-700.0),
        ]
        together = measure_quality(result.table, result.workpiece, result.toolkit, loads=loads)[
            :, LOAD_REACTION
        ]
        single = [
            measure_quality(result.table, result.workpiece, result.toolkit, loads=[load])[:, LOAD_REACTION]
            for load in loads
        ]
        assert together == pytest.approx(np.max(single, axis=0), rel=1e-12)
        for k, fixture in enumerate(result):
            wrenches, _ = force_directions(fixture, result.workpiece, result.toolkit.peg_radius)
            cases = compute_load_cases(fixture, result.workpiece, result.toolkit, loads)
            for load, case, figures in zip(loads, cases, single, strict=True):
                worst = case.reaction
                assert worst.value == pytest.approx(figures[k], rel=1e-6)
                wrench = load_wrench(load.force, worst.point, worst.direction, load.moment)
                assert least_clamping(wrenches, wrench)[worst.peg] == pytest.approx(figures[k], rel=1e-6)
            start, share = random.integers(0, 3), random.uniform()
            point = (1 - share) * np.array(path[start]) + share * np.array(path[start + 1])
            wrench = load_wrench(80.0, (point[0], point[1]), random.uniform(-50, 40), 300.0)
            assert least_clamping(wrenches, wrench).max() <= single[1][k] * (1 + 1e-6)
            wrench = load_wrench(120.0, path[0], random.uniform(0, 360))
            assert least_clamping(wrenches, wrench).max() <= single[0][k] * (1 + 1e-6)


def walk(workpiece: Workpiece, radius: float, number: int, center: Array) -> float:
    """How far in mm a peg can go along its face until it leaves the face or comes nearer than its radius to the part."""
    face = next(face.segment for face in workpiece.faces if face.number == number)
    rows = make_segment_rows([other.segment for other in workpiece.faces])
    scale = face.radius + face.sign * radius if isinstance(face, Arc) else 1.0
    if isinstance(face, Arc) and face.is_full:
        return pi * scale
    start = face.find_parameter((float(center[0]), float(center[1])))
    best = np.inf
    for way in (-1.0, 1.0):

        def clear(distances: Array, way: float = way) -> NDArray[np.bool_]:
            parameters = start + way * distances / scale
            at = np.array(
                [
                    np.add(face.compute_point(s), np.multiply(radius, face.compute_normal(s)))
                    for s in parameters
                ]
            )
            apart = measure_outline_distances(at, rows) >= radius - 1e-9
            return np.asarray((np.abs(parameters) <= face.half_extent) & apart)

        steps = np.arange(0.0, 120.0, 0.05) + 1e-7
        low = float(steps[np.argmin(clear(steps))]) - 0.05
        high = low + 0.05
        for _ in range(30):
            middle = (low + high) / 2
            low, high = (middle, high) if clear(np.array([middle]))[0] else (low, middle)
        best = min(best, max(low, 0.0))
    return best


def silhouette(workpiece: Workpiece) -> Array:
    """Points (N, 2) of the outline, the ends of lines and every hundredth of a radian of arcs."""
    points = []
    for face in workpiece.faces:
        half = face.segment.half_extent
        count = 2 + int(100 * half) if isinstance(face.segment, Arc) else 2
        points += [face.segment.compute_point(s) for s in np.linspace(-half, half, count)]
    return np.array(points)


def movement(fixture: Fixture, result: Result, points: Array, peg: int) -> Array:
    """How far points (N, 2) move per mm that one peg and its face are off, by solving for the pose twice."""
    step = 1e-4
    ahead, behind = (placed(solved(fixture, result, peg, error), points) for error in (step, -step))
    return (ahead - behind) / (2 * step)


def placed(pose: Array, points: Array) -> Array:
    """Points (N, 2) of the part in the vise frame."""
    turn = np.array([[cos(pose[0]), -sin(pose[0])], [sin(pose[0]), cos(pose[0])]])
    return np.asarray(points @ turn.T + pose[1:3])


def solved(fixture: Fixture, result: Result, off: int, error: float) -> Array:
    """Orientation, place and opening of the jaws (4,) when one peg stands off by an error in mm, without first order."""
    segments = {face.number: face.segment for face in result.workpiece.faces}
    pegs = [
        (peg.x, peg.y, peg.carrier == "right", segments[peg.face], error * (k == off))
        for k, peg in enumerate(fixture.pegs)
    ]
    radius = result.toolkit.peg_radius

    def gaps(z: Array) -> list[float]:
        c, s = cos(z[0]), sin(z[0])
        out = []
        for px, py, slides, segment, wrong in pegs:
            x, y = px + slides * z[3] - z[1], py - z[2]
            qx, qy = c * x + s * y, c * y - s * x
            if isinstance(segment, Arc):
                away = segment.sign * (
                    np.hypot(qx - segment.center[0], qy - segment.center[1]) - segment.radius
                )
            else:
                nx, ny = segment.compute_normal()
                away = (qx - segment.middle[0]) * nx + (qy - segment.middle[1]) * ny
            out.append(away - radius - wrong)
        return out

    pose = fixture.pose
    found = root(gaps, [radians(pose.theta_deg), pose.x, pose.y, 0.0], tol=1e-13, options={"xtol": 1e-14})
    assert np.abs(gaps(found.x)).max() < 1e-10
    return np.asarray(found.x)


def least_clamping(wrenches: Array, wrench: Array) -> Array:
    """Peg forces (4,) that balance a load with the least clamping, by a linear program."""
    scale = np.array([1.0, 1.0, 0.05])
    answer = linprog(np.ones(4), A_eq=(wrenches * scale).T, b_eq=-wrench * scale, method="highs")
    assert answer.status == 0
    return np.asarray(answer.x)


def test_pegs_that_share_a_face_share_its_error() -> None:
    """Every fixture of a triangle has two pegs on one face, so faces that are off move it no more than pegs that are."""
    result = held("triangle", 20, 2, 3, 30)
    apart, together = (
        measure_quality(result.table, result.workpiece, result.toolkit, Tolerance(peg, face))[
            :, LOCATION_ERROR
        ]
        for peg, face in ((0.02, 0.0), (0.0, 0.02))
    )
    assert (together <= apart * (1 + 1e-9)).all() and (together < 0.99 * apart).mean() > 0.5


def test_location_error_grows_with_the_tolerances_in_proportion() -> None:
    """First order: twice the tolerances, twice the error; none, none."""
    result = held("widget", 8, 1, 3, 50)
    one, two, none = (
        measure_quality(result.table, result.workpiece, result.toolkit, Tolerance(t, t))[:, LOCATION_ERROR]
        for t in (0.01, 0.02, 0)
    )
    assert two == pytest.approx(2 * one, rel=1e-12)
    assert none.max() == 0.0


def test_blocks_do_not_show(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut into blocks of any size the figures are the same, bit for bit."""
    result = held("widget", 8, 1, 3, 50)
    loads = [Load(points=[(3, 4)], force=10)]
    whole = measure_quality(result.table, result.workpiece, result.toolkit, loads=loads)
    monkeypatch.setattr("workhold.statics.quality.BLOCK", 7)
    again = measure_quality(result.table, result.workpiece, result.toolkit, loads=loads)
    assert np.array_equal(again, whole, equal_nan=True)


def test_no_fixtures_no_figures() -> None:
    """An empty table gives an empty array; without loads the load reaction is not known."""
    result = held("widget", 8, 1, 3, 50)
    assert measure_quality(FixtureTable.make_empty(), result.workpiece, result.toolkit).shape == (
        0,
        BEFORE_PINS,
    )
    quality = measure_quality(result.table, result.workpiece, result.toolkit)
    assert np.isnan(quality[:, LOAD_REACTION]).all() and not np.isnan(quality[:, :LOAD_REACTION]).any()


def test_figures_take_the_direction_of_the_fixtures_own_clamp() -> None:
    """Of a plate that was asked for several directions each fixture is measured as if its own had been the only one."""
    part = Workpiece.from_loops(
        "part", [[[0, 0, 0], [58, 0, 0], [58, 26, 0], [44, 40, 0], [20, 40, 0.3], [0, 40, 0]]]
    )
    plate = Plate((20, 16), 3, directions=["-y", "-x", "+y"])
    result = design(part, plate, best=40)
    assert {fixture.direction for fixture in result} == {"-x", "-y"}
    again = measure_quality(result.table, part, plate)
    known = ~np.isnan(again)
    assert np.allclose(again[known], result.table.quality[known], rtol=1e-9, atol=1e-12)
