"""Fixtures of several parts for tests of statics, and their contacts worked out without the program's kernels."""

from __future__ import annotations

import json
from functools import cache
from math import cos, radians, sin
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import workhold
from workhold import Fixture, Peg, Pose, Result, Vise, Workpiece

Array = NDArray[np.float64]
COMPLETE = Path(__file__).parent / "data" / "complete"

# Part, pitch, columns, peg radius, and how many of the fixtures are looked at.
CASES = (
    ("widget", 8, 1, 3, 50),
    ("oblongPart", 10, 1, 3, 50),
    ("small4Handle", 10, 2, 3, 50),
    ("ring", 12, 2, 3, 30),
    ("triangle", 20, 2, 3, 30),
    ("rocker", 10, 2, 2, 50),
    ("channel", 8, 2, 2, 40),
)
# A plate with round ends of different size, a notch with a concave arc, and a round hole off the middle.
ROCKER = [
    [[-20, -9, 0], [25, -14, 1], [25, 14, 0], [6, 11, -0.5], [-6, 10, 0], [-20, 9, 1]],
    [[24, 0, -1], [30, 0, -1]],
]
# A channel with a nose that comes so near to its floor that no peg passes: the floor leaves two contact features.
CHANNEL = [
    [
        [*point, 0.0]
        for point in (
            (0, -9),
            (50, -11),
            (50, 0),
            (8, 0),
            (8, 16),
            (22, 16),
            (22, 3),
            (28, 3),
            (28, 15),
            (50, 15),
            (47, 26),
        )
    ]
    + [[0, 25, 0.1]],
]
DRAWN = {"rocker": ROCKER, "channel": CHANNEL}


def held_part(name: str) -> Workpiece:
    """One of the parts above, one of a complete set, or a built-in one."""
    if name in DRAWN:
        return Workpiece.from_loops(name, DRAWN[name])
    for path in COMPLETE.glob(f"{name}_*.json"):
        return Workpiece.from_loops(name, json.loads(path.read_text())["workpiece"]["loops"])
    return workhold.load(name)


@cache
def held(name: str, pitch: float, columns: int, radius: float, count: int) -> Result:
    """Some fixtures of a part, spread evenly over the ranking."""
    result = workhold.design(held_part(name), Vise(pitch=pitch, columns=columns, peg_radius=radius))
    chosen = np.unique(np.linspace(0, len(result) - 1, count).astype(int))
    object.__setattr__(result, "table", result.table.take(chosen))
    return result


def plate_fixture() -> tuple[Workpiece, Vise, Fixture]:
    """The worked example of docs/quality.md: a square plate with two pegs a side, in a pinwheel."""
    plate = Workpiece.from_loops("plate", [[[-17, -17, 0], [17, -17, 0], [17, 17, 0], [-17, 17, 0]]])
    pegs = (
        Peg("left", 0, 1, 0.0, 10.0, 3, 1.0),
        Peg("left", 1, 0, 10.0, 0.0, 0, 1.0),
        Peg("right", 0, 4, 30.0, 40.0, 2, 1.0),
        Peg("right", 1, 3, 40.0, 30.0, 1, 1.0),
    )
    return plate, Vise(pitch=10, columns=2, peg_radius=3), Fixture("I", pegs, Pose(0.0, 20.0, 20.0), 20.0, {})


def contacts(fixture: Fixture, workpiece: Workpiece, radius: float) -> tuple[Array, Array]:
    """Contact points and outward unit normals, each (4, 2), in the part's coordinates."""
    angle = radians(fixture.pose.theta_deg)
    segments = {face.number: face.segment for face in workpiece.faces}
    normals, points = [], []
    for peg in fixture.pegs:
        x, y = peg.x - fixture.pose.x, peg.y - fixture.pose.y
        center = (cos(angle) * x + sin(angle) * y, cos(angle) * y - sin(angle) * x)
        segment = segments[peg.face]
        normal = np.array(segment.compute_normal(segment.find_parameter(center)))
        normals.append(normal)
        points.append(np.array(center) - radius * normal)
    return np.array(points), np.array(normals)


def force_directions(
    fixture: Fixture, workpiece: Workpiece, radius: float, friction: float = 0.0
) -> tuple[Array, Array]:
    """Wrenches (K, 3) about the part's origin of unit forces of pegs on the part, and their share (K,) in the jaw force.

    Without friction K is 4, else 8: both edges of every cone.
    """
    points, normals = contacts(fixture, workpiece, radius)
    tangents = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    sides = (friction, -friction) if friction else (0.0,)
    directions = np.concatenate([-normals + side * tangents for side in sides])
    at = np.concatenate([points for _ in sides])
    right = np.array([peg.carrier == "right" for _ in sides for peg in fixture.pegs])
    angle = radians(fixture.pose.theta_deg)
    along = directions @ np.array([cos(angle), -sin(angle)])
    moments = at[:, 0] * directions[:, 1] - at[:, 1] * directions[:, 0]
    return np.column_stack([directions, moments]), -along * right


def load_wrench(force: float, point: tuple[float, float], direction: float, moment: float = 0.0) -> Array:
    """Force and moment (3,) about the part's origin of a load; the direction in degrees."""
    x, y = force * cos(radians(direction)), force * sin(radians(direction))
    return np.array([x, y, point[0] * y - point[1] * x + moment])
