"""Contracted boxes keep every solution that may be a fixture; nothing decided is decided otherwise in ball arithmetic."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import ladders
from exact_chords import exactly
from sharpness import interpreted
from workhold.kernels.base.tables import Lattice, Limits, Setting
from workhold.kernels.contact.record import LARGEST_RADIUS, PSI, RECORD_LENGTH, SEPARATION, TAIL_X, TAIL_Y
from workhold.kernels.proof import interval_newton as in_doubles
from workhold.kernels.proof import variation as variations
from workhold.kernels.proof.newton_kantorovich import DISCARDED, OPEN
from workhold.proof.ball_contacts import CandidateBox
from workhold.proof.interval_newton import find_solutions

LENGTH = 20.0
LIMITS = Limits(-100.0, 0.0, LENGTH, 9.0, 1.0, 0.0, 0.0)
# Pitches of 1 mm, no row offset, any gap; the columns and rows of a record are then millimetres.
SETTING = Setting(Lattice(1.0, 1.0, 0.0), LIMITS, 0.0, 0.0, 0.0)
FEATURES = np.array(ladders.FEATURES)


def record(height: float, turn: float, reach: float) -> NDArray[np.float64]:
    """The ladders with psi within ``reach`` of 45 degrees and a turn, as one record."""
    out = np.zeros((1, RECORD_LENGTH))
    out[0, :5] = 2.0, *range(4)
    places = np.array(ladders.offsets(height))
    out[0, 5:9], out[0, 9:13] = places[:, 0], places[:, 1]
    out[0, PSI:] = *ladders.near(np.pi / 4 + turn, height), reach, 10.0 * reach
    return out


def interval_newton(
    row: NDArray[np.float64], features: NDArray[np.float64] = FEATURES
) -> tuple[int, NDArray[np.float64]]:
    """The verdict on one record, and its roots."""
    left, _, right = np.linalg.svd(in_doubles.compute_jacobians(row, features, SETTING))
    frames = np.stack([left, right.transpose(0, 2, 1)], axis=1)
    verdicts, roots = in_doubles.contract_boxes(row, features, SETTING, frames)
    return int(verdicts[0]), roots


def decided(row: NDArray[np.float64]) -> list[float]:
    """Orientations of the fixtures of the same box in ball arithmetic."""
    reach, radius = float(row[0, 17]) + 1e-9 / LENGTH, float(row[0, LARGEST_RADIUS]) + 1e-9
    places = list(zip(row[0, 5:9].tolist(), row[0, 9:13].tolist(), strict=True))
    middle = (float(row[0, PSI]), float(row[0, TAIL_X]), float(row[0, TAIL_Y]), float(row[0, SEPARATION]))
    widths = (reach, radius, radius, 2.0 * (radius + LENGTH * reach))
    outcome = find_solutions(CandidateBox(ladders.FEATURES, places, 2, middle, widths), LIMITS)
    assert outcome is not None and outcome.reason == ""
    return [fixture[0] for fixture in outcome.fixtures]


@pytest.mark.parametrize("rest", [1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("aside", [0.0, 0.7, -0.7])
def test_the_solution_that_clamps_is_kept(rest: float, aside: float) -> None:
    """Of two solutions in a box one clamps: it is within the radius of a root, or the box is given up."""
    height = -2.5 + rest
    with exactly():
        low, high = (float(psi) for psi in ladders.orientations(height))
    row = record(height, aside * (high - low) / 2.0, 2.0 * (high - low))
    verdict, roots = interval_newton(row)
    fixtures = decided(row)
    assert len(fixtures) == 1
    assert verdict == OPEN or (np.abs(roots[:, PSI] - fixtures[0]) <= roots[:, 17] + 1e-15).any()
    if rest > 1e-9:
        assert verdict == DISCARDED


@pytest.mark.parametrize("rest", [-1e-3, -1e-6, -1e-9])
def test_a_box_without_solutions_is_dropped(rest: float) -> None:
    verdict, roots = interval_newton(record(-2.5 + rest, 0.0, 1e-3))
    assert verdict == DISCARDED
    assert len(roots) == 0


@pytest.mark.parametrize("reach", [1e-8, 1e-6, 1e-4])
def test_an_exact_double_root_is_dropped(reach: float) -> None:
    """Its clamping force is 0, up to the rounding of its place."""
    verdict, roots = interval_newton(record(-2.5, 0.0, reach))
    assert verdict == DISCARDED
    assert len(roots) == 0


def test_roots_hold_the_solution_and_are_small() -> None:
    """A box about one solution becomes a root that holds it, known to 1e-9 mm."""
    for k in range(40):
        height = -2.5 + 1e-2 + 2e-3 * k
        with exactly():
            low, high = ladders.orientations(height)
            both = [[float(v) for v in ladders.unknowns(psi, height)] for psi in (low, high)]
        for z in both:
            verdict, roots = interval_newton(record(height, z[0] - np.pi / 4 + 1e-4, 2e-3))
            assert verdict == DISCARDED
            for root in roots:
                assert root[LARGEST_RADIUS] < 1e-9
                assert abs(root[PSI] - z[0]) <= root[17] + 1e-15
                assert np.abs(root[TAIL_X : TAIL_Y + 1] - z[1:3]).max() <= root[LARGEST_RADIUS] + 1e-14


@pytest.mark.thorough
def test_a_bound_that_is_wrong_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the variation of normals and moments over a part solutions are lost, and the comparison above sees it."""

    spread = in_doubles.write_variation

    def still(*arguments: object) -> None:
        spread(*arguments)
        arguments[-1][variations.TILT] = 0.0  # type: ignore[index]
        arguments[-1][variations.ARM_BAND] = 0.0  # type: ignore[index]
        arguments[-1][variations.MOMENT_BAND] = 0.0  # type: ignore[index]
        arguments[-1][variations.FORCE_BAND] = 0.0  # type: ignore[index]

    height = -2.5 + 1e-2
    with exactly():
        low, high = (float(psi) for psi in ladders.orientations(height))
    row = record(height, 0.0, 2.0 * (high - low))
    (fixture,) = decided(row)
    left, _, right = np.linalg.svd(in_doubles.compute_jacobians(row, FEATURES, SETTING))
    frame = np.stack([left[0], right[0].T])
    roots, space = np.empty((4, RECORD_LENGTH)), in_doubles.make_newton_space()
    found = interpreted(in_doubles.find_solutions)(row[0], FEATURES, SETTING, frame, space, roots)
    assert found > 0 and (np.abs(roots[:found, PSI] - fixture) <= roots[:found, 17] + 1e-15).any()
    monkeypatch.setattr(in_doubles, "write_variation", still)
    found = interpreted(in_doubles.find_solutions)(row[0], FEATURES, SETTING, frame, space, roots)
    assert not (np.abs(roots[: max(found, 0), PSI] - fixture) <= roots[: max(found, 0), 17] + 1e-15).any()
