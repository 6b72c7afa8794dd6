"""The figures of quality of whole tables of fixtures (MODEL.md, "Quality")."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from holdfast.model.load import Load
from holdfast.model.quality import CLAMP_AMPLIFICATION
from holdfast.model.result import FixtureTable, unknown_quality
from holdfast.model.tolerance import Tolerance
from holdfast.model.vise import Vise
from holdfast.model.workpiece import Workpiece

__all__ = ["quality_of"]


def quality_of(
    table: FixtureTable,
    workpiece: Workpiece,
    vise: Vise,
    tolerance: Tolerance | None = None,
    loads: Sequence[Load] = (),
) -> NDArray[np.float64]:
    """Figures of quality (N, 6) in the order of ``model.quality.FIGURES``."""
    quality = unknown_quality(table.null_vector)
    quality[:, CLAMP_AMPLIFICATION] = table.force.max(axis=1, initial=0.0)
    return quality
