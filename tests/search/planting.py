"""Planted fixtures: parts built around chosen pegs, so that one fixture of them is known beforehand."""

from __future__ import annotations

from math import cos, pi, sin, sqrt
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold import InputError, Vise, Workpiece

Array = NDArray[np.float64]


@frozen(eq=False)
class Plant:
    """A part, a vise and a fixture that must be found.

    The fixture is in the form of the result file, with faces named by the part's segments.
    """

    workpiece: Workpiece
    vise: Vise
    fixture: dict[str, Any]


def choose_pegs(
    random: np.random.Generator, vise: Vise, lefts: int
) -> tuple[Array, list[dict[str, Any]], float]:
    """Four pegs in different holes (4, 2), their places, and a jaw separation."""
    lattice = np.array(vise.pitch)
    separation = float(random.uniform(1.2, 4.0) * vise.pitch[0])
    pegs: list[dict[str, Any]] = []
    points = []
    for k in range(4):
        left = k < lefts
        column, row = int(random.integers(vise.columns)), int(random.integers(0, 6))
        x, y = column * lattice[0], row * lattice[1]
        if not left:
            x, y = x + (vise.columns - 1) * lattice[0] + separation, y + vise.row_offset
        pegs.append({"jaw": "left" if left else "right", "column": column, "row": row, "x": x, "y": y})
        points.append((x, y))
    return np.array(points), pegs, separation


def chosen_normals(random: np.random.Generator, lefts: int) -> Array:
    """Directions (4,) of outward normals: mostly towards each peg's own jaw, one in ten anywhere."""
    toward_jaw = np.where(np.arange(4) < lefts, pi, 0.0) + random.uniform(-1.7, 1.7, 4)
    return np.where(random.uniform(size=4) < 0.1, random.uniform(0, 2 * pi, 4), toward_jaw)


def half_plane_polygon(normals: Array, offsets: Array) -> Array | None:
    """Corners of the bounded polygon n . q <= offset, one edge for each half plane in the order of angles, or None."""
    order = np.argsort(np.arctan2(normals[:, 1], normals[:, 0]))
    n, d = normals[order], offsets[order]
    corners = []
    for k in range(len(n)):
        a, b = n[k], n[(k + 1) % len(n)]
        turn = a[0] * b[1] - a[1] * b[0]
        if turn < 0.1:
            return None
        corners.append(
            [
                (d[k] * b[1] - d[(k + 1) % len(n)] * a[1]) / turn,
                (a[0] * d[(k + 1) % len(n)] - b[0] * d[k]) / turn,
            ]
        )
    return np.array(corners)


def side(
    random: np.random.Generator, start: Array, end: Array, touch: Array, normal: Array, radius: float
) -> list[list[float]]:
    """Vertices of one side of the part, from ``start`` to ``end`` (left out); it touches at ``touch``, a line or an arc."""
    tangent = np.array([-normal[1], normal[0]])
    kind = random.integers(3)
    if kind == 0:
        return [[*start, 0.0]]
    # An arc tangent to the side at the contact: it bends away from the peg (convex) or around it (concave).
    reach = min((touch - start) @ tangent, (end - touch) @ tangent) * random.uniform(0.3, 0.9)
    if kind == 1:
        arc_radius = reach * random.uniform(1.1, 4.0)
        depth = arc_radius - sqrt(arc_radius**2 - reach**2)
        low, high = touch - reach * tangent - depth * normal, touch + reach * tangent - depth * normal
        bulge = depth / reach
    else:
        arc_radius = max(reach, radius) * random.uniform(1.2, 4.0)
        depth = arc_radius - sqrt(arc_radius**2 - reach**2)
        low, high = touch - reach * tangent + depth * normal, touch + reach * tangent + depth * normal
        bulge = -depth / reach
    return [[*start, 0.0], [*low, bulge], [*high, 0.0]]


def plant(seed: int) -> Plant | None:
    """Try to build a part around four random pegs; None when this seed gives none."""
    random = np.random.default_rng(seed)
    pitch = float(random.integers(8, 16))
    vise = Vise(
        pitch=pitch,
        columns=int(random.integers(1, 4)),
        peg_radius=float(random.choice([0.0, 1.0, 2.5])),
        row_offset=float(random.choice([0.0, 0.0, pitch / 2, 3.0])),
    )
    lefts = int(random.integers(2, 4))
    points, pegs, separation = choose_pegs(random, vise, lefts)
    normals_angle = chosen_normals(random, lefts)
    normals = np.stack([np.cos(normals_angle), np.sin(normals_angle)], axis=1)
    touches = points - vise.peg_radius * normals
    corners = half_plane_polygon(normals, (touches * normals).sum(axis=1))
    if corners is None:
        return None
    sides = all_sides(random, normals, touches, corners, vise.peg_radius)
    part = None if sides is None else drawn(random, sides[0])
    if sides is None or part is None:
        return None
    workpiece, theta, shift = part
    for k, peg in enumerate(pegs):
        peg["segment"] = sides[1][k]
    fixture = {
        "type": "I" if lefts == 2 else "II",
        "pegs": pegs,
        "pose": {"theta_deg": float(np.degrees(theta)), "x": float(shift[0]), "y": float(shift[1])},
        "jaw_separation": separation,
    }
    return Plant(workpiece, vise, fixture)


def all_sides(
    random: np.random.Generator,
    normals: Array,
    touches: Array,
    corners: Array,
    radius: float,
    plain: int = -1,
) -> tuple[Array, dict[int, int]] | None:
    """Vertices of a part within the corners of half planes, and the segment that touches at each of the touches; that of the
    number ``errors`` is the whole line. None where a touch is at a corner."""
    vertices: list[list[float]] = []
    names = {}
    for k, number in enumerate(np.argsort(np.arctan2(normals[:, 1], normals[:, 0])).tolist()):
        start, end, touch, normal = corners[k - 1], corners[k], touches[number], normals[number]
        if number == plain:
            vertices.append([*start, 0.0])
            continue
        tangent = np.array([-normal[1], normal[0]])
        if (touch - start) @ tangent < 0.5 or (end - touch) @ tangent < 0.5:
            return None
        of_side = side(random, start, end, touch, normal, radius)
        names[number] = len(vertices) + (1 if len(of_side) == 3 else 0)
        vertices += of_side
    return np.array(vertices), names


def drawn(random: np.random.Generator, vertices: Array) -> tuple[Workpiece, float, Array] | None:
    """The part in a frame of its own, with the orientation in radians and the place at which it lies as it was; or None."""
    theta, shift = float(random.uniform(0, 2 * pi)), random.uniform(-50, 50, 2)
    c, s = cos(theta), sin(theta)
    # The pose maps q to R(theta) q + shift, so the drawing is R(-theta) (p - shift).
    moved = (vertices[:, :2] - shift) @ np.array([[c, -s], [s, c]])
    try:
        return Workpiece.from_loops("planted", [np.column_stack([moved, vertices[:, 2]])]), theta, shift
    except InputError:
        return None
