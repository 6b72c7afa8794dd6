"""What the fixtures of a result file are held to, in whatever form they are written."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.model.query import Query
from workhold.model.result import FixtureTable

__all__ = ["LARGEST_LENGTH", "LARGEST_NUMBER", "refuse_faulty", "refuse_unknown_types"]

LARGEST_NUMBER = 2**31 - 1
LARGEST_LENGTH = 1e300
NOT_FINITE = "cannot be used: a length, an angle or a force is not a finite number"


def refuse_unknown_types(arrangement: NDArray[np.integer[Any]], toolkit: Toolkit, path: Path) -> None:
    """Refuse indices (N,) of arrangements that a toolkit does not have.

    Raises
    ------
    InputError
        Naming the first fixture.
    """
    names = [one.title for one in toolkit.arrangements]
    if arrangement.min(initial=0) < 0 or arrangement.max(initial=0) >= len(names):
        number = int(np.argmax((arrangement < 0) | (arrangement >= len(names)))) + 1
        raise InputError(f"{path}: fixture {number} cannot be used: its type is not {' or '.join(names)}.")


def refuse_faulty(table: FixtureTable, query: Query, path: Path, places: Sequence[int]) -> None:
    """Refuse fixtures of known types that contradict the toolkit, the workpiece or themselves.

    Parameters
    ----------
    places : where in the file they stand, from 0.

    Raises
    ------
    InputError
        Naming the first of them.
    """
    if len(table) == 0:
        return
    toolkit = query.toolkit

    def refuse(faulty: NDArray[np.bool_], reason: str) -> None:
        if faulty.any():
            where = np.flatnonzero(faulty if faulty.ndim == 1 else faulty.any(axis=1))
            raise InputError(f"{path}: fixture {places[int(where[0])] + 1} {reason}.")

    asked = [number for number, one in enumerate(toolkit.arrangements) if one.name in query.arrangements]
    refuse(~np.isin(table.arrangement, asked), "is of a type that was not asked for")
    jaw = toolkit.peg_carriers(table.arrangement)
    for number, carrier in enumerate(toolkit.carriers):
        for what, places_on, most in (("column", table.column, carrier.columns), ("row", table.row, carrier.rows)):
            beyond = (jaw == number) & ((places_on < 0) | (places_on >= (LARGEST_NUMBER if most is None else most)))
            refuse(beyond, f"has a peg in a {what} beyond the {most} of the {carrier.title}")
    faces = [face.number for face in query.workpiece.faces]
    refuse(~np.isin(table.face, faces), "has a peg on a segment that does not name a face of the workpiece")
    for values in (table.theta, table.position, table.jaw_separation, table.force):
        refuse(~(np.abs(values.reshape(len(table), -1)) <= LARGEST_LENGTH), NOT_FINITE)
    refuse(np.isinf(table.quality), NOT_FINITE)
    # Of two clamps either may lift a locator; both together press all.
    refuse(table.null_vector <= 0, "has a peg whose force is not positive")
    refuse((table.pairs < 1) | (table.pairs > LARGEST_NUMBER), "stands for no pair of clamps")
