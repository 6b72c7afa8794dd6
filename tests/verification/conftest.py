"""A result of a real search, as objects and as the JSON of its file."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest

from toolkit_results import verify_edited
from workhold import Result, Vise, design, load
from workhold.files.result.writer import write_result_text
from workhold.model.quality import TILT
from workhold.verification import Verification

Data = dict[str, Any]


@pytest.fixture(scope="session")
def widget_result() -> Result:
    """Twelve fixtures of the widget in a vise with two columns, of both types, as if twelve had been asked for."""
    figures = ("location-error", "clamp-amplification", "closure-margin")
    result = design(load("widget"), Vise(pitch=8, columns=2, peg_radius=3), rank_by=figures)
    table = result.table
    # None that lies square: there two pegs on one face slide, and hold with a row or a column more as well.
    tilted = table.quality[:, TILT] > 0
    of_types = [np.flatnonzero(tilted & (table.arrangement == kind)) for kind in (0, 1)]
    chosen = np.concatenate([found[:: len(found) // 6][:6] for found in of_types])
    query = attrs.evolve(result.query, best=len(chosen))
    return attrs.evolve(result, query=query, table=table.take(np.sort(chosen)))


@pytest.fixture(scope="session")
def widget_data(widget_result: Result) -> Data:
    """The JSON of that result's file."""
    stream = io.StringIO()
    stream.writelines(write_result_text(widget_result))
    data: Data = json.loads(stream.getvalue())
    return data


@pytest.fixture
def verified(widget_data: Data, tmp_path: Path) -> Callable[[Callable[[Data], object]], Verification]:
    """Verify that file after an edit of its JSON."""

    return lambda edit: verify_edited(widget_data, edit, tmp_path)
