"""Results made up for tests of what happens after a search: consistent in form, not fixtures of anything."""

from __future__ import annotations

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from workhold import Query, Result, Vise, Workpiece
from workhold.model.fixture_table import FixtureTable
from workhold.model.quality import (
    BEFORE_PINS,
    CLOSURE_MARGIN,
    JAW_CONTACT,
    JAW_FORCE_NEEDED,
    LOAD_REACTION,
    LOCATION_ERROR,
    PENALTY,
    WARNINGS,
)
from workhold.model.search_report import ProofReport, UndecidedCandidate

PLATE = [[[0, 0, 0], [60, 0, 0.1], [60, 40, 0], [0, 40, -0.2]], [[20, 20, -1], [30, 20, -1]]]


def plate() -> Workpiece:
    """A plate with two curved sides and a round hole."""
    return Workpiece.from_loops("plate", PLATE)


def fake_result(count: int, seed: int = 0, **changes: object) -> Result:
    """A result of ``count`` made-up fixtures, about a third of them of type II, ranked by closure margin."""
    random = np.random.default_rng(seed)
    vise = Vise(pitch=(10, 12.7), columns=3, peg_radius=3, row_offset=1 / 3)
    arrangement = random.choice([0, 0, 1], count).astype(np.int8)
    null_vector = random.dirichlet([2, 2, 2, 2], count).reshape(count, 4)
    null_vector = null_vector[np.argsort(-null_vector.min(axis=1))]
    table = FixtureTable(
        arrangement=arrangement,
        column=random.integers(0, 3, (count, 4)).astype(np.int32),
        row=random.integers(0, 30, (count, 4)).astype(np.int32),
        face=random.choice([face.number for face in plate().faces], (count, 4)).astype(np.int32),
        theta=random.uniform(0, 2 * np.pi, count),
        position=random.uniform(-100, 100, (count, 2)),
        jaw_separation=random.uniform(10, 80, count),
        force=null_vector / random.uniform(0.1, 0.5, (count, 1)),
        quality=fake_quality(null_vector, random),
    )
    counts = vise.count_arrangements(arrangement)
    result = Result(
        Query(plate(), vise, rank_by="closure_margin"),
        table,
        counts,
        {"I": counts["I"] // 2, "II": counts["II"] // 2},
    )
    return evolve(result, **changes)  # type: ignore[arg-type]


def fake_quality(null_vector: NDArray[np.float64], random: np.random.Generator) -> NDArray[np.float64]:
    """Made-up figures of quality, but for the closure margin; without loads."""
    quality = random.uniform(0.01, 2.0, (len(null_vector), BEFORE_PINS))
    quality[:, CLOSURE_MARGIN] = null_vector.min(axis=1, initial=1.0)
    # Nearly all of them are for a workshop.
    quality[:, LOCATION_ERROR] /= 4
    quality[:, [LOAD_REACTION, JAW_FORCE_NEEDED, JAW_CONTACT]] = np.nan
    quality[:, [WARNINGS, PENALTY]] = random.integers(0, 9, (len(null_vector), 2))
    return quality


def fake_proof(undecided: int, **changes: int) -> ProofReport:
    """An account that adds up, with so many undecided candidates on faces of the plate."""
    lost = tuple(
        UndecidedCandidate(
            "II" if k % 2 else "I", (0, 1, 2, 4), (0, 1, 0, -k), (0, -3, 1, k), 7.25 * k, f"reason {k}"
        )
        for k in range(undecided)
    )
    counts = {
        "cells": 288,
        "discarded_by_bound": 81_440,
        "verified": 1324,
        "escalated": 32 + undecided,
    } | changes
    candidates = counts["discarded_by_bound"] + counts["verified"] + undecided
    return ProofReport(candidates=candidates, undecided=lost, **counts)
