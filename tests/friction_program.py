"""A second linear program of a part between two flat jaws, to hold the first against.

It has cells of its own, finer ones, friction as two components within a polygon of 24 sides, pressures by their values
at the corners, and scipy's interior point method. It takes rectangles alone.
"""

from __future__ import annotations

from math import cos, pi

import numpy as np
from scipy.optimize import linprog

ALONG, UP, SIDES = 12, 8, 24


def force_needed(fixed, moving, opening, friction, loads, stop=(), way=1.0):
    """The least jaw force for a list of (point, force), summed to one load; None where none holds it."""
    columns, costs, bounds, inequalities = [], [], [], []

    def column(point, force, cost=0.0, low=0.0):
        moment = np.cross(point, force)
        columns.append(np.concatenate([force, moment / opening]))
        costs.append(cost)
        bounds.append((low, None))
        return len(columns) - 1

    blocks = []
    for rectangles, y, normal, cost in ((fixed, 0.0, 1.0, 0.0), (moving, opening, -1.0, 1.0)):
        # p = a + b u + c v, whose integrals are of rectangles, by their midpoints and squares of sizes.
        first = len(columns)
        for power in range(3):
            total, moment_x, moment_z = 0.0, 0.0, 0.0
            for x0, x1, z0, z1 in rectangles:
                u, v, area = (x0 + x1) / 2, (z0 + z1) / 2, (x1 - x0) * (z1 - z0)
                value = (1.0, u, v)[power]
                total += area * value
                moment_x += area * (u * value + (x1 - x0) ** 2 / 12 * (power == 1))
                moment_z += area * (v * value + (z1 - z0) ** 2 / 12 * (power == 2))
            # A force along y at (u, y, v): its moments about x and z are -v f and u f.
            wrench = [0.0, normal * total, 0.0, -moment_z * normal, 0.0, moment_x * normal]
            columns.append(np.array(wrench) / [1, 1, 1, opening, opening, opening])
            costs.append(cost * total)
            bounds.append((None, None))
        for x0, x1, z0, z1 in rectangles:
            inequalities += [
                ({first: -1.0, first + 1: -u, first + 2: -v}, 0.0) for u in (x0, x1) for v in (z0, z1)
            ]
            width, height = (x1 - x0) / ALONG, (z1 - z0) / UP
            for i in range(ALONG):
                for j in range(UP):
                    u, v = x0 + (i + 0.5) * width, z0 + (j + 0.5) * height
                    point = np.array([u, y, v])
                    tx = column(point, np.array([1.0, 0.0, 0.0]), low=None)
                    tz = column(point, np.array([0.0, 0.0, 1.0]), low=None)
                    most = friction * width * height * cos(pi / SIDES)
                    blocks.append((tx, tz, first, u, v, most))
        ends = min(one[0] for one in rectangles), max(one[1] for one in rectangles)
        for x in ends:
            column(np.array([x, y, 0.0]), np.array([0.0, 0.0, 1.0]))
    for point in stop:
        column(np.array(point, float), np.array([way, 0.0, 0.0]))
    for tx, tz, first, u, v, most in blocks:
        for side in range(SIDES):
            turn = 2 * pi * (side + 0.5) / SIDES
            row = {
                tx: np.cos(turn),
                tz: np.sin(turn),
                first: -most,
                first + 1: -most * u,
                first + 2: -most * v,
            }
            inequalities.append((row, 0.0))
    size = max(float(np.abs(force).max()) for _, force in loads)
    asked = sum(np.concatenate([f, np.cross(p, f) / opening]) for p, f in loads) / size
    upper = np.zeros((len(inequalities), len(columns)))
    for row, (entries, _) in enumerate(inequalities):
        upper[row, list(entries)] = list(entries.values())
    found = linprog(
        costs,
        A_ub=upper,
        b_ub=np.zeros(len(upper)),
        A_eq=np.array(columns).T,
        b_eq=-asked,
        bounds=bounds,
        method="highs-ipm",
    )
    return found.fun * size if found.status == 0 else None
