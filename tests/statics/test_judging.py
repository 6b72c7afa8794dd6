"""Warnings, penalty, tilt and the main direction agree with what docs/quality.md says of them."""

from __future__ import annotations

from math import ceil, log10

import numpy as np
import pytest

from workhold import Load, Result, Workpiece
from workhold.conventions import GENTLE_PEG, SMALL_FACE_POINTS, STRONG_POINTS, TILTED_POINTS
from workhold.drawing import SheetDetails
from workhold.drawing.scene import LengthUnit
from workhold.drawing.sheet_facts import list_cautions, measure_edge_distances
from workhold.model.own_outlines import measure_outline_diameter
from workhold.model.quality import (
    CLAMP_AMPLIFICATION,
    JAW_FORCE_NEEDED,
    LOCATION_ERROR,
    PENALTY,
    SMALLEST_FACE,
    TILT,
    WARNINGS,
)
from workhold.statics.judging import JudgingLimits
from workhold.statics.loads import compute_load_cases
from workhold.statics.quality import compute_tilts, find_main_direction, measure_quality

SHEET = {"number": 1, "count": 1, "day": None, "result_hash": "", "version": ""}


@pytest.mark.thorough
def test_the_sheet_warns_as_often_as_the_table_counts(result: Result) -> None:
    """Of every kind, with a load and a jaw force that some fixtures need more than."""
    loads = [Load(((5.0, 5.0),), 100.0), Load((), 0.0, moment=500.0)]
    quality = measure_quality(result.table, result.workpiece, result.toolkit, loads=loads)
    force = float(np.median(quality[:, JAW_FORCE_NEEDED]))
    counts = measure_quality(result.table, result.workpiece, result.toolkit, loads=loads, jaw_force=force)[
        :, WARNINGS
    ]
    for fixture, count in zip(result, counts, strict=True):
        cases = compute_load_cases(fixture, result.workpiece, result.toolkit, loads, force)
        details = SheetDetails(**SHEET, jaw_force=force, loads=cases)  # type: ignore[arg-type]
        distances = measure_edge_distances(fixture, result.workpiece, result.toolkit)
        kinds = [
            caution.kind
            for caution in list_cautions(fixture, result.toolkit, distances, details, LengthUnit.in_mm())
        ]
        assert len([kind for kind in kinds if kind not in ("unfit", "pose")]) == count


@pytest.mark.thorough
def test_the_jaw_force_needed_is_that_of_the_load_cases(result: Result) -> None:
    """The largest over the loads."""
    loads = [Load(((5.0, 5.0),), 100.0, (20.0, 70.0)), Load((), 0.0, moment=-500.0)]
    needed = measure_quality(result.table, result.workpiece, result.toolkit, loads=loads)[:, JAW_FORCE_NEEDED]
    for fixture, found in zip(result, needed, strict=True):
        cases = compute_load_cases(fixture, result.workpiece, result.toolkit, loads)
        assert found == pytest.approx(max(case.needed.value for case in cases), rel=1e-6, abs=1e-9)


def test_the_penalty_is_the_sum_of_its_points(result: Result) -> None:
    """20 for ten times the location error, 9 for a tilt, 4 above 1.5, 2 for a face below a tenth of the diameter."""
    small = measure_outline_diameter(result.workpiece) / 10
    for fixture in result:
        figures = fixture.quality
        points = ceil(20 * log10(figures["location_error"] / 0.02) - 1e-9)
        points += 9 * (figures["tilt"] > 0) + 4 * (figures["clamp_amplification"] > 1.5)
        assert figures["penalty"] == points + 2 * (figures["smallest_face"] < small)
    assert PENALTY != TILT


@pytest.mark.parametrize(
    ("figure", "edge", "beyond", "points"),
    [
        (CLAMP_AMPLIFICATION, GENTLE_PEG, 1e-8, STRONG_POINTS),
        (SMALLEST_FACE, 5.0, -1e-8, SMALL_FACE_POINTS),
        (TILT, 0.0, 1e-8, TILTED_POINTS),
        (LOCATION_ERROR, 0.02, 1e-8, 1),
    ],
)
def test_a_figure_exactly_on_the_edge_costs_nothing(
    figure: int, edge: float, beyond: float, points: int
) -> None:
    """Points begin behind the edge; rounding in the tenth decimal does not count."""
    quality = np.zeros((4, 12))
    quality[:, [LOCATION_ERROR, SMALLEST_FACE]] = 0.02, 50.0
    quality[:, figure] = edge, edge + beyond, edge - beyond, edge + beyond / 1000
    penalty = JudgingLimits(0.02, 5.0, None).compute_penalty(quality)
    assert penalty[:2].tolist() == [0, points]
    assert figure in (TILT, LOCATION_ERROR) or penalty[2:].tolist() == [0, 0]


@pytest.mark.parametrize("turn", [0.0, 17.0, 89.999])
def test_the_main_direction_turns_with_the_part(turn: float) -> None:
    """A long bar's, also where rounding puts its sides about 0 and 90 degrees."""
    corners = np.array([0, 60, 60 + 20j, 20j]) * np.exp(1j * np.radians(turn))
    part = Workpiece.from_loops("bar", [[[z.real, z.imag, 0] for z in corners]])
    off = (find_main_direction(part) - turn + 45) % 90 - 45
    assert abs(off) < 1e-9
    assert compute_tilts(
        np.radians([-turn, 90 - turn, 30 - turn, -turn - 0.009]), find_main_direction(part)
    ) == pytest.approx([0.0, 0.0, 30.0, 0.0], abs=1e-9)


def test_without_one_main_direction_the_drawing_decides() -> None:
    """A triangle of equal sides has three, a disc none."""
    triangle = Workpiece.from_loops(
        "triangle", [[[0, 0, 0], [40, 10, 0], [20 - 5 * 3**0.5, 5 + 20 * 3**0.5, 0]]]
    )
    disc = Workpiece.from_loops("disc", [[[-10, 0, 1], [10, 0, 1]]])
    assert find_main_direction(triangle) == find_main_direction(disc) == 0.0


def test_of_faces_that_are_nearly_square_the_longest_tells_the_main_direction() -> None:
    """Two sides a hair off square count as one direction, whichever comes first; of equally long ones the first tells it."""
    along = 40 * np.exp(1j * np.radians(30))
    for stretch, side in ((0.9, 0), (1.1, 3), (1.0, 0)):
        across = 1j * along * np.exp(1j * np.radians(0.006)) * stretch
        corners = (0, along, along * 1.2 + across * 0.9, across)
        part = Workpiece.from_loops("bracket", [[[z.real, z.imag, 0] for z in map(complex, corners)]])
        (x, y), (u, v) = part.segments[side].start, part.segments[side].end
        assert find_main_direction(part) == pytest.approx(np.degrees(np.arctan2(v - y, u - x)) % 90, abs=1e-9)
