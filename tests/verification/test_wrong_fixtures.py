"""Neighbours of fixtures: pegs in other holes or on other faces, with the pose solved anew. The verification and the
independent checker, which shares nothing with it, must say the same of each."""

from __future__ import annotations

from collections import Counter
from math import cos, sin
from random import Random
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from closing_forces import clamping_force, null_vectors
from fixture_sets import Judge, listed, near_an_end
from workhold import Fixture, Peg, Pose, Result, Vise, Workpiece, design, load
from workhold.geometry.segment import Line
from workhold.verification import verify_fixture

pytestmark = pytest.mark.thorough

Array = NDArray[np.float64]
Hole = tuple[str, int, int, int]


def contact(workpiece: Workpiece, vise: Vise, holes: list[Hole], z: Array) -> tuple[Array, Array, Array]:
    """Gaps (4,) beyond the peg radius, places (4, 2) and outward normals (4, 2) in the part for theta, x, y, separation."""
    segments = {face.number: face.segment for face in workpiece.faces}
    turn = np.array([[cos(z[0]), sin(z[0])], [-sin(z[0]), cos(z[0])]])
    gaps, points, normals = [], [], []
    for jaw, column, row, face in holes:
        point = turn @ (
            np.array(vise.carriers[int(jaw == "right")].compute_hole_center(column, row, z[3])) - z[1:3]
        )
        segment = segments[face]
        if isinstance(segment, Line):
            normal = np.array(segment.compute_normal())
            gap = (point - segment.start) @ normal
        else:
            ray = point - segment.center
            normal = segment.sign * ray / np.hypot(*ray)
            gap = segment.sign * (np.hypot(*ray) - segment.radius)
        gaps.append(gap - vise.peg_radius)
        points.append(point)
        normals.append(normal)
    return np.array(gaps), np.array(points), np.array(normals)


def solved(workpiece: Workpiece, vise: Vise, holes: list[Hole], z: Array) -> Array | None:
    """Newton's method with differences for the slopes."""
    for _ in range(30):
        gaps = contact(workpiece, vise, holes, z)[0]
        slopes = np.stack(
            [
                (contact(workpiece, vise, holes, z + h)[0] - contact(workpiece, vise, holes, z - h)[0]) / 2e-5
                for h in 1e-5 * np.eye(4)
            ],
            axis=1,
        )
        if np.linalg.cond(slopes) > 1e6 or np.abs(z).max() > 1e4:
            return None
        z = z - np.linalg.solve(slopes, gaps)
        if np.abs(gaps).max() < 1e-12:
            return z
    return None


def fixture_of(workpiece: Workpiece, vise: Vise, holes: list[Hole], z: Array) -> Fixture:
    """The fixture, or what would be one, of four pegs and a pose, with the forces that belong to it."""
    _, points, normals = contact(workpiece, vise, holes, z)
    left = np.array([jaw == "left" for jaw, *_ in holes])
    with np.errstate(all="ignore"):
        null = null_vectors(points[None], normals[None], 10.0)
        force = np.nan_to_num(null / clamping_force(null, normals[None], z[:1], left[None]))
    pegs = []
    for (jaw, column, row, face), push in zip(holes, force[0], strict=True):
        x, y = vise.carriers[int(jaw == "right")].compute_hole_center(column, row, z[3])
        pegs.append(Peg(jaw, column, row, float(x), float(y), face, float(push)))  # type: ignore[arg-type]
    pose = Pose(float(np.degrees(z[0])), float(z[1]), float(z[2]))
    quality = {"closure_margin": float(null.min())}
    return Fixture("I" if left.sum() == 2 else "II", tuple(pegs), pose, float(z[3]), quality)  # type: ignore[arg-type]


def neighbour(random: Random, fixture: Fixture, vise: Vise, faces: list[int]) -> list[Hole] | None:
    """The holes and faces of a fixture with one or two of them changed."""
    holes: list[Any] = [[peg.carrier, peg.column, peg.row, peg.face] for peg in fixture.pegs]
    for _ in range(random.randint(1, 2)):
        hole = random.choice(holes)
        change = random.choice(["row", "column", "face"])
        if change == "row":
            hole[2] = max(0, hole[2] + random.choice([-1, 1]))
        elif change == "column":
            hole[1] = random.randrange(vise.columns)
        else:
            hole[3] = random.choice(faces)
    return [tuple(hole) for hole in holes] if len({tuple(hole[:3]) for hole in holes}) == 4 else None


def ring() -> Workpiece:
    """A disc with a square hole, which can be held from inside and outside."""
    hole = [[-20.0, -9.0, 0.0], [-20.0, 9.0, 0.0], [4.0, 9.0, -1.0], [4.0, -9.0, 0.0]]
    return Workpiece.from_loops("ring", [[[30.0, 0.0, 1.0], [-30.0, 0.0, 1.0]], hole])


CASES = {
    "widget": lambda: design(load("widget"), Vise(pitch=8, columns=2, peg_radius=3)),
    "ring": lambda: design(ring(), Vise(pitch=12, columns=2, peg_radius=2)),
    "flange": lambda: design(
        load("flange"), Vise(pitch=(8, 9.5), columns=3, peg_radius=2, row_offset=3, max_opening=40)
    ),
}


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", CASES)
def test_neighbours_of_fixtures(name: str) -> None:
    result: Result = CASES[name]()
    workpiece, vise = result.workpiece, result.toolkit
    judge, random = Judge(workpiece, vise), Random(7)
    faces = [face.number for face in workpiece.faces]
    seen: Counter[str] = Counter()
    for _ in range(300):
        before = result[random.randrange(len(result))]
        holes = neighbour(random, before, vise, faces)
        start = np.array([np.radians(before.pose.theta_deg), before.pose.x, before.pose.y, before.travel])
        z = None if holes is None else solved(workpiece, vise, holes, start)
        if holes is None or z is None:
            continue
        fixture = fixture_of(workpiece, vise, holes, z)
        written = listed_one(fixture)
        faults, marginal = judge.check(written)
        # The checker calls what is within 1e-6 of an edge marginal, and does not look at the separation as written.
        edge = marginal or near_an_end(judge, written) or fixture.travel < vise.min_gap
        if edge and not faults:
            continue
        ruling = verify_fixture(fixture, workpiece, vise)
        assert ruling.verdict == ("refuted" if faults else "proven"), (fixture, faults, ruling)
        seen[ruling.verdict] += 1
        seen.update(
            word
            for word in ("past the end", "enters", "do not hold", "does not clamp")
            if word in ruling.reason
        )
    assert seen["proven"] >= 10
    assert seen["refuted"] >= 40
    assert seen["past the end"] >= 3
    assert seen["do not hold"] >= 3


def listed_one(fixture: Fixture) -> dict[str, Any]:
    """One fixture in the form of the result file."""
    one: dict[str, Any] = listed([fixture])[0]
    return one
