"""What a search on a grid misses: for every set the share of the complete list that a grid of poses meets, over its step.

    python benchmarks/grid_share.py        # writes docs/figures/grid-share.json and docs/figures/grid-share.svg

The grid steps through every unknown that nothing fixes. Of a plate these are the angle and the place of the part, of a vise
the opening besides. Beside a wall each hull edge lies flush, so there is the place along it, and of a flat jaw the opening.
A clamp comes until it touches. A peg counts as touching when its surface is within a tolerance of its face. So a fixture is
met where some point of the grid has all pegs that touch by chance within it. A program that does so for plates is
`examples/grid_search.py`; a test compares the two.

Glossary
--------
step : in mm; the step of the angle has as many degrees.
fixed : met where all pegs are within 0.1 mm, whatever the step.
half : met where all pegs are within half a step; what is met must then be made exact.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from line_plot import CALLED, Curve, line_plot
from workhold.benchmark.catalogue import SetEntry, load_sets, make_set_query
from workhold.fixels.contacts import CLAMP_TIP
from workhold.geometry.segment import make_segment_rows
from workhold.model.fixture_table import FixtureTable, compute_peg_places
from workhold.model.query import Query
from workhold.search.design import answer

ROOT = Path(__file__).resolve().parent.parent
DATA, PLOT = (ROOT / "docs" / "figures" / f"grid-share.{ending}" for ending in ("json", "svg"))
STEPS = (2.0, 1.0, 0.5, 0.2, 0.1, 0.05)
TOUCH = 0.1
# Fixtures of a set that are looked at, evenly through its list; the others are as they are.
MOST = 600
Array = Any


def main() -> None:
    """Measure every set, write the data and the plot."""
    rows = []
    for entry in load_sets():
        if entry.size:
            rows.append(measured(entry))
            sys.stdout.write(f"{entry.name}: {rows[-1]['fixed']}\n")
    kinds = sorted({row["kind"] for row in rows})
    means = {
        kind: {
            rule: mean_shares([row for row in rows if row["kind"] == kind], rule)
            for rule in ("fixed", "half")
        }
        for kind in kinds
    }
    content = {
        "command": "python benchmarks/grid_share.py",
        "steps": list(STEPS),
        "touch": TOUCH,
        "cpu_seconds": round(process_time()),
        "kinds": means,
        "sets": rows,
    }
    DATA.write_text(as_text(content), encoding="utf-8")
    curves = [
        Curve(kind, [(step, 100 * share) for step, share in zip(STEPS, shares["fixed"], strict=True)])
        for kind, shares in means.items()
    ]
    svg = line_plot(
        curves, "Share of the complete list that a grid meets", "step in mm and degrees", "share in %"
    )
    PLOT.write_text(svg, encoding="utf-8")


def as_text(content: Mapping[str, Any]) -> str:
    """JSON with one set in a line."""
    head = {key: value for key, value in content.items() if key != "sets"}
    lines = ",\n".join(json.dumps(row) for row in content["sets"])
    return json.dumps(head)[:-1] + f', "sets": [\n{lines}\n]}}\n'


def mean_shares(rows: Sequence[Mapping[str, Any]], rule: str) -> list[float]:
    """The mean over sets of the shares at each step."""
    return [round(float(share), 5) for share in np.mean([row[rule] for row in rows], axis=0)]


def measured(entry: SetEntry) -> dict[str, Any]:
    """The shares of a set at all steps, by both rules."""
    query = make_set_query(entry)
    table = answer(query, threads=1).table
    chosen = np.unique(np.linspace(0, len(table) - 1, min(MOST, len(table))).astype(int))
    part = table.take(chosen)
    return {
        "set": entry.name,
        "kind": CALLED[query.toolkit.kind],
        "fixtures": entry.size,
        "looked_at": len(part),
        "fixed": [share_met(query, part, step, TOUCH) for step in STEPS],
        "half": [share_met(query, part, step, step / 2) for step in STEPS],
    }


def share_met(query: Query, table: FixtureTable, step: float, touch: float) -> float:
    """The share of fixtures for which a point of the grid has all stepped pegs within a tolerance of their faces."""
    return round(float(met(query, table, step, touch).mean()), 5)


def met(query: Query, table: FixtureTable, step: float, touch: float) -> Array:
    """Which fixtures (N,) a grid meets; see :func:`share_met`."""
    toolkit = query.toolkit
    pegs, moved, walls = stepped_pegs(query, table)
    pitch = toolkit.carriers[0].pitch if not walls else None
    middle = np.concatenate([loop[:, :2] for loop in query.workpiece.loops]).mean(axis=0)
    theta = table.theta
    place = table.position + turned(theta, middle)
    # The nearest point of the grid to the exact pose, over one pitch, and its neighbours.
    phase = place if pitch is None else place % np.array(pitch)
    near = np.rint(phase / step) * step - phase
    turn = np.rint(np.degrees(theta) / step) * step - np.degrees(theta)
    travel = table.jaw_separation.reshape(len(table), -1)[:, 0]
    opened = np.rint(travel / step) * step - travel
    around = (-1, 0, 1)
    axes = (
        (around, (0,), (0,), around if moved.any() else (0,))
        if walls
        else (around, around, around, around if moved.any() else (0,))
    )
    found = np.zeros(len(table), bool)
    for i, j, k, m in product(*axes):
        shift = near + step * np.array([i, 0 if walls else j])
        if walls:
            shift = shift * np.array([1.0, 0.0])
        angle = theta + (0.0 if walls else 1.0) * np.radians(turn + step * k)
        further = (opened + step * m)[:, None, None] * moved[None]
        moved_place = place + shift - turned(angle, middle)
        found |= (np.abs(face_gaps(query, table, pegs, moved_place, angle, further)) <= touch).all(axis=1)
    return found


def turned(angle: Array, point: Array) -> Array:
    """A point turned by angles (N,) about the origin (N, 2)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * point[0] - s * point[1], s * point[0] + c * point[1]], -1)


def stepped_pegs(query: Query, table: FixtureTable) -> tuple[list[int], Array, bool]:
    """Numbers of the pegs that touch by chance, which way (P, 2) each moves with the opening, and if there are walls."""
    toolkit = query.toolkit
    carriers = [toolkit.carriers[k] for k in toolkit.arrangements[0].carriers]
    pegs = [k for k, one in enumerate(carriers) if one.contact.is_placed and one.contact is not CLAMP_TIP]
    walls = any(not one.contact.is_placed for one in carriers)
    moved = np.array([(0.0, 0.0) if carriers[k].travel is None else carriers[k].travel.unit for k in pegs])
    return pegs, moved, walls


def face_gaps(
    query: Query, table: FixtureTable, pegs: list[int], place: Array, angle: Array, further: Array
) -> Array:
    """How far (N, P) the surfaces of pegs are from their faces in other poses, in mm; faces are taken without ends."""
    x, y = compute_peg_places(table, query.toolkit, query.workpiece)
    centres = np.stack([x[:, pegs], y[:, pegs]], -1) + further
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    away = centres - place[:, None]
    q = np.stack([c * away[..., 0] + s * away[..., 1], c * away[..., 1] - s * away[..., 0]], -1)
    rows = make_segment_rows([face.segment for face in query.workpiece.numbered.faces])
    number = {face.number: k for k, face in enumerate(query.workpiece.numbered.faces)}
    row = rows[np.vectorize(number.__getitem__)(table.face[:, pegs])]
    return (
        signed_gap(row, q)
        - query.toolkit.carriers[query.toolkit.arrangements[0].carriers[pegs[0]]].peg_radius
    )


def signed_gap(row: Array, q: Array) -> Array:
    """Distances of points from the lines or circles of segment rows, positive outside the material."""
    is_arc, x, y, radius, axis_x, axis_y, sign = columns_of(row)
    v = q - np.stack([x, y], -1)
    return np.where(
        is_arc != 0, sign * (np.hypot(v[..., 0], v[..., 1]) - radius), v[..., 0] * axis_y - v[..., 1] * axis_x
    )


def columns_of(row: Array) -> tuple[Array, ...]:
    """The columns of segment rows that say which line or circle it is."""
    from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, SIGN, X, Y

    return tuple(row[..., k] for k in (IS_ARC, X, Y, RADIUS, AXIS_X, AXIS_Y, SIGN))


if __name__ == "__main__":
    main()
