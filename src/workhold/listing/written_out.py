"""Fixtures written out as holes of their toolkit, once it is known which."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.geometry.rotation import rotated
from workhold.listing.canonical_form import Candidates
from workhold.model.result import FixtureTable, unknown_quality
from workhold.rowwise import smallest

__all__ = ["written_out"]


def written_out(
    c: Candidates, problem: Problem, column: NDArray[np.int64], row: NDArray[np.int64], travel: NDArray[np.float64]
) -> FixtureTable:
    """The table of candidates in holes of the toolkit, columns and rows (N, 4), with a travel (N,) in mm; of their quality
    only the closure margin is known yet."""
    frame = problem.frame
    theta = c.theta if frame.quarters == 0 else (c.theta + frame.quarters * np.pi / 2) % (2 * np.pi)
    anchor = c.point[:, 0] + np.asarray(problem.workpiece.center)
    anchor = np.stack(rotated(anchor[:, 0], anchor[:, 1], theta), axis=1)
    hole = frame.toolkit.carriers[0].place(column[:, 0], row[:, 0])
    return FixtureTable(
        arrangement=frame.toolkit.arrangement_numbers(c.standing).astype(np.int8),
        column=column.astype(np.int32),
        row=row.astype(np.int32),
        face=problem.faces.astype(np.int32).take(c.feature),
        theta=theta,
        position=np.stack(hole, axis=1) - anchor,
        jaw_separation=travel,
        force=c.force,
        quality=unknown_quality(smallest(c.null)),
    )
