"""The force of straps by a linear program that shares nothing with the search: other cells, pressures and solver."""

from __future__ import annotations

from math import cos, pi, sin
from pathlib import Path

import numpy as np
from scipy.optimize import linprog

from workhold import Program


def force_by_other_program(fixture, loops, tips, forces, friction=0.1, sides=32, cell=2.5, thick=25.0):
    """The least force for (point, force) pairs, with a grid of small cells and pressures by their values at corners."""
    from shapely import Polygon, box

    foot = Polygon(loops[0], loops[1:])
    columns, costs, rows = [], [], []

    def column(point, force, cost=0.0):
        columns.append(np.concatenate([force, np.cross(point, force) / 50.0]))
        costs.append(cost)
        return len(columns) - 1

    still = [k for k, peg in enumerate(fixture.pegs) if peg.carrier == "plate"]
    for k in still:
        for z in (0.0, thick):
            column([*fixture.contact_points[k], z], [*-fixture.normals[k], 0.0])
    pieces = []
    x0, y0, x1, y1 = foot.bounds
    for x in np.arange(x0, x1, cell):
        for y in np.arange(y0, y1, cell):
            piece = foot.intersection(box(x, y, x + cell, y + cell))
            if piece.area > 1e-9:
                pieces.append((piece.centroid.x, piece.centroid.y, piece.area))
    first = len(columns)
    at = np.array(pieces)
    # p = a + b x + c y, each of any sign, and not negative at the hull's corners.
    for power in range(3):
        value = (np.ones(len(at)), at[:, 0], at[:, 1])[power] * at[:, 2]
        columns.append(
            np.array([0, 0, value.sum(), (value * at[:, 1]).sum() / 50, -(value * at[:, 0]).sum() / 50, 0])
        )
        costs.append(0.0)
    press = len(columns)
    total = sum(np.concatenate([[0, 0, -1.0], np.cross([*tip, thick], [0, 0, -1.0]) / 50]) for tip in tips)
    columns.append(total)
    costs.append(1.0)
    upper = [({first: -1.0, first + 1: -x, first + 2: -y}) for x, y in foot.convex_hull.exterior.coords[:-1]]
    # Friction in a coarse grid of the same cells, summed.
    groups = {}
    for x, y, area in pieces:
        groups.setdefault((int((x - x0) // 7.5), int((y - y0) // 7.5)), []).append((x, y, area))
    for group in groups.values():
        some = np.array(group)
        area = some[:, 2].sum()
        x, y = (some[:, :2] * some[:, 2:]).sum(axis=0) / area
        own = [
            column([x, y, 0.0], [cos(2 * pi * k / sides), sin(2 * pi * k / sides), 0.0]) for k in range(sides)
        ]
        rows.append(
            {
                **dict.fromkeys(own, 1.0),
                first: -friction * area,
                first + 1: -friction * area * x,
                first + 2: -friction * area * y,
            }
        )
    for tip in tips:
        own = [
            column([*tip, thick], [cos(2 * pi * k / sides), sin(2 * pi * k / sides), 0.0])
            for k in range(sides)
        ]
        rows.append({**dict.fromkeys(own, 1.0), press: -friction})
    matrix = np.zeros((len(upper) + len(rows), len(columns)))
    for number, row in enumerate([*upper, *rows]):
        matrix[number, list(row)] = list(row.values())
    bounds = [(None, None) if first <= k < first + 3 else (0, None) for k in range(len(columns))]
    load = sum(np.concatenate([f, np.cross(p, f) / 50]) for p, f in forces)
    size = np.abs(load).max()
    found = linprog(
        costs, matrix, np.zeros(len(matrix)), np.array(columns).T, -load / size, bounds, method="highs-ipm"
    )
    return found.fun * size if found.status == 0 else None


def read_slot_program(folder: Path) -> Program:
    """Return a program that cuts a slot into the top of a block 25 mm high, written into ``folder``."""
    (folder / "p.nc").write_text(
        "G21 G90\nG0 X30. Y30. Z70.\nT1 M6\nZ5.\nG1 Z-3. F200\nX70. F600\nG0 Z70.\nM30\n"
    )
    (folder / "tools.toml").write_text(
        "tool.1 = {diameter = 10, flute_length = 30, stickout = 40, cutting_force = 180}\n"
    )
    return Program.read(folder / "p.nc", folder / "tools.toml", thickness=25, start=(30, 30, 70))
