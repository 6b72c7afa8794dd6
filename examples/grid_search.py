"""A naive search of fixtures on a plate with one clamp, as somebody would write it in an afternoon: a grid of poses.

    python examples/grid_search.py SET.json [--step MM] [--degrees DEG] [--touch MM] > mine.json
    workhold benchmark check mine.json --tolerance 1

The part is tried in steps of an angle and of x and y over one pitch. At each pose a hole counts as touching where its peg's
surface is within ``--touch`` of the outline. Of every three holes that touch, the clamp comes along every row until it
touches, and where the four close, that is a fixture. What lies between two steps is never seen. Needs NumPy only, and is
made for the sets whose name ends in "-plate".
"""

from __future__ import annotations

import argparse
import json
import sys
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

Array = Any


def segments(loops: list[list[list[float]]]) -> list[tuple[Array, Array, float]]:
    """Ends and bulge of every segment."""
    return [
        (np.array(loop[k][:2]), np.array(loop[(k + 1) % len(loop)][:2]), loop[k][2])
        for loop in loops
        for k in range(len(loop))
    ]


def gaps(points: Array, parts: list[tuple[Array, Array, float]]) -> tuple[Array, Array]:
    """Distance (M,) of points from the outline, negative inside, and the outward normal (M, 2) there."""
    best, sign, normal = np.full(len(points), np.inf), np.ones(len(points)), np.zeros((len(points), 2))
    for a, b, bulge in parts:
        length = np.hypot(*(b - a))
        t = (b - a) / length
        n = np.array([t[1], -t[0]])
        if bulge == 0:
            foot = a + np.clip((points - a) @ t, 0, length)[:, None] * t
            outward = np.broadcast_to(n, points.shape)
        else:
            half = 2 * np.arctan(bulge)
            r = length / (2 * np.sin(half))
            centre = (a + b) / 2 - n * r * np.cos(half)
            v, start = points - centre, np.arctan2(*(a - centre)[::-1])
            turn = ((np.arctan2(v[:, 1], v[:, 0]) - start) * np.sign(half)) % (2 * np.pi)
            angle = start + np.sign(half) * np.clip(turn, 0, abs(2 * half))
            foot = centre + abs(r) * np.stack([np.cos(angle), np.sin(angle)], -1)
            outward = (foot - centre) / r
        distance = np.hypot(*(points - foot).T)
        nearer = distance < best
        best = np.where(nearer, distance, best)
        sign = np.where(nearer, np.where(((points - foot) * outward).sum(1) < 0, -1.0, 1.0), sign)
        normal[nearer] = outward[nearer]
    return best * sign, normal


def closes(points: Array, normals: Array) -> bool:
    """Whether four contacts close: their one null vector has one sign."""
    w = np.column_stack([normals, points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0]])
    lam = np.array([(-1) ** k * np.linalg.det(np.delete(w, k, 0)) for k in range(4)])
    return bool((lam > 1e-9).all() or (lam < -1e-9).all())


def search(content: dict[str, Any], step: float, degrees: float, touch: float) -> list[dict[str, Any]]:
    """All fixtures that the grid meets."""
    kit, parts = content["toolkit"], segments(content["workpiece"]["loops"])
    pitch, rho = np.array(kit["pitch"]), kit["peg_radius"]
    corners = np.array([a for a, _, _ in parts])
    reach = np.hypot(*(corners - corners.mean(0)).T).max() + np.hypot(*pitch) + rho
    most = np.ceil(reach / pitch).astype(int)
    holes = np.array([(i, j) for i in range(-most[0], most[0] + 1) for j in range(-most[1], most[1] + 1)])
    middle, found = corners.mean(0), []
    shifts = [np.arange(0, p, step) for p in pitch]
    for theta in np.radians(np.arange(0, 360, degrees)):
        R = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
        for x in shifts[0]:
            moved = np.stack([np.full(len(shifts[1]), x), shifts[1]], -1) - R @ middle
            q = ((holes * pitch)[None] - moved[:, None]) @ R
            gap, normal = gaps(q.reshape(-1, 2), parts)
            gap, normal = gap.reshape(q.shape[:2]), normal.reshape(q.shape)
            for k in range(len(moved)):
                near = np.flatnonzero(np.abs(gap[k] - rho) <= touch)
                for three in combinations(near, 3):
                    which, pose = list(three), (R, moved[k], theta)
                    found += clamped(holes[which], q[k, which], normal[k, which], pose, kit, parts)
    return found


def clamped(holes: Array, q: Array, n: Array, pose: Any, kit: Any, parts: Any) -> list[dict[str, Any]]:
    """The fixtures of three locators: the clamp comes from the right along every row."""
    (R, shift, theta), limits = pose, (kit["columns"], kit["rows"])
    pitch, rho = np.array(kit["pitch"]), kit["peg_radius"]
    low = holes.min(0)
    if (np.ptp(holes, axis=0) >= limits).any():
        return []
    found = []
    for row in range(holes[:, 1].max() - limits[1] + 1, low[1] + limits[1]):
        xs = np.arange(holes[:, 0].max() * pitch[0] + 200, holes[:, 0].min() * pitch[0] - 200, -0.25)
        line = np.stack([xs, np.full(len(xs), row * pitch[1])], -1)
        gap, normal = gaps((line - shift) @ R, parts)
        hit = np.flatnonzero(gap < rho)
        if len(hit) == 0:
            continue
        tip, m = line[hit[0]], normal[hit[0]]
        points = np.vstack([q, (tip - shift) @ R])
        if (R @ m)[0] > 0 and closes(points - points.mean(0), np.vstack([n, m])):
            pegs = [{"role": "locator", "x": float(x), "y": float(y)} for x, y in holes * pitch]
            pegs.append({"role": "clamp", "direction": "-x", "x": float(tip[0]), "y": float(tip[1])})
            at = {"theta_deg": float(np.degrees(theta)), "x": float(shift[0]), "y": float(shift[1])}
            found.append({"pegs": pegs, "pose": at})
    return found


def main() -> None:
    """Read the question of a set, and write the entry."""
    words = argparse.ArgumentParser(description="A naive grid search, to be compared with a complete list.")
    words.add_argument("set", type=Path)
    words.add_argument("--step", type=float, default=1.0, help="mm")
    words.add_argument("--degrees", type=float, default=1.0)
    words.add_argument("--touch", type=float, default=0.1, help="mm: how near counts as touching")
    asked = words.parse_args()
    content = json.loads(asked.set.read_text(encoding="utf-8"))
    found = search(content, asked.step, asked.degrees, asked.touch)
    json.dump({"format": "workhold-entry/1", "set": content["set"], "fixtures": found}, sys.stdout)


if __name__ == "__main__":
    main()
