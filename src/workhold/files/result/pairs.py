"""Fixtures with two clamps as lines of JSON (MODEL, "Result file").

The forces of a peg are those per unit of the first clamp's force and of the second's.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from math import isnan
from typing import Any

import numpy as np

from workhold.files.result.rounding import LENGTH_STEPS, as_told, known_figures, rounded, significant
from workhold.model.force_ratio import ratios
from workhold.model.quality import FIGURES
from workhold.model.result import FixtureTable, flat_angles, peg_places
from workhold.model.toolkit import Toolkit
from workhold.model.workpiece import Workpiece

__all__ = ["pair_lines"]

BLOCK = 4096


def pair_lines(table: FixtureTable, toolkit: Toolkit, workpiece: Workpiece) -> Iterator[list[str]]:
    """The lines of fixtures with two clamps, block by block; ``pairs`` is given where a fixture stands for its seat."""
    figures = [(figure.key, FIGURES.index(figure)) for figure in known_figures(table)]
    for start in range(0, len(table), BLOCK):
        block = table.take(slice(start, start + BLOCK))
        theta, told = as_told(block)
        places = rounded(np.stack(peg_places(told, toolkit, workpiece), axis=2), LENGTH_STEPS).tolist()
        poses = np.column_stack([theta, told.position]).tolist()
        # The ratio is that of the forces as they are written, so that reading and writing changes nothing.
        force = significant(block.force) + 0.0
        low, high = ratios(force)
        ends = zip(significant(low).tolist(), significant(high).tolist(), strict=True)
        holes, faces = np.stack([block.column, block.row], axis=2).tolist(), block.face.tolist()
        forces, quality = force.tolist(), (significant(block.quality) + 0.0).tolist()
        kinds, pairs = block.arrangement.tolist(), block.pairs.tolist()
        each = zip(kinds, places, poses, ends, holes, faces, forces, quality, pairs, strict=True)
        entries = [fixture_entry(toolkit, figures, *numbers) for numbers in each]
        if toolkit.has_flats:
            flats = flats_told(block, toolkit, workpiece)
            entries = [entry | {"flats": told} for entry, told in zip(entries, flats, strict=True)]
        yield [json.dumps(entry) for entry in entries]


def flats_told(table: FixtureTable, toolkit: Toolkit, workpiece: Workpiece) -> list[list[float | None]]:
    """Which way the flats of a table's pegs look, in degrees, of all but the ends of a wall; None for no flat."""
    on_wall = {k for one in toolkit.arrangements for k, n in enumerate(one.carriers) if toolkit.carriers[n].is_wall}
    angles = flat_angles(table, toolkit, workpiece)
    return [[angle for k, angle in enumerate(row) if k not in on_wall] for row in angles]


def fixture_entry(
    toolkit: Toolkit,
    figures: list[tuple[str, int]],
    kind: int,
    places: list[list[float]],
    pose: list[float],
    ends: tuple[float, float],
    holes: list[list[int]],
    faces: list[int],
    forces: list[list[float]],
    quality: list[float],
    pairs: int,
) -> dict[str, Any]:
    """One fixture as it is written."""
    arrangement = toolkit.arrangements[kind]
    pegs: list[dict[str, Any]] = []
    wall: list[dict[str, Any]] = []
    for number, hole, (x, y), face, (one, other) in zip(
        arrangement.carriers, holes, places, faces, forces, strict=True
    ):
        carrier = toolkit.carriers[number]
        contact = {"x": x, "y": y, "segment": face, "force": [one, other]}
        if carrier.is_wall:
            wall.append(contact)
            continue
        if carrier.on is None:
            pegs.append({"role": "locator", "column": hole[0], "row": hole[1], **contact})
            continue
        line = {"row": hole[1]} if carrier.is_along_x else {"column": hole[0]}
        bolted = hole if carrier.has_a_hole else None
        direction = carrier.name.rpartition(" ")[2]
        pegs.append({"role": "clamp", "direction": direction, "hole": bolted, **line, **contact})
    low, high = ends
    return {
        "type": arrangement.name,
        "directions": (arrangement.direction or "").split(),
        **({"wall": wall_entry(*wall)} if wall else {}),
        "ratio": [low, None if isnan(high) else high],
        "pegs": pegs,
        "pose": {"theta_deg": pose[0], "x": pose[1], "y": pose[2]},
        "pairs": pairs,
        "quality": {key: quality[number] for key, number in figures},
    }


def wall_entry(one: dict[str, Any], other: dict[str, Any]) -> dict[str, Any]:
    """What is written of the contact with a wall, from its two ends."""
    ends = {name: [end["x"], end["y"]] for name, end in (("from", one), ("to", other))}
    return ends | {"segments": [one["segment"], other["segment"]], "forces": [one["force"], other["force"]]}
