"""How large a drawing is, and what to ask when it does not say in which unit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workhold.files.outline.chain import Chain
from workhold.files.questions import UNIT, UnitAskedError
from workhold.geometry.intersect import bounding_box
from workhold.geometry.segment import segment_from_bulge
from workhold.units import INCH

__all__ = ["size_of", "unit_asked"]


def size_of(chains: Sequence[Chain]) -> tuple[float, float] | None:
    """Width and height in mm of the smallest upright rectangle around chains; None without any."""
    boxes = [
        bounding_box(segment_from_bulge(start, end, bulge))
        for chain in chains
        for start, end, bulge in zip(chain.points, chain.points[1:], chain.bulges, strict=False)
        if start != end
    ]
    if not boxes:
        return None
    all_boxes = np.array(boxes)
    low, high = all_boxes[:, :2].min(axis=0), all_boxes[:, 2:].max(axis=0)
    return float(high[0] - low[0]), float(high[1] - low[1])


def unit_asked(lacking: str, chains: Sequence[Chain]) -> UnitAskedError:
    """The question for the unit of a drawing that lacks it, with what it would be in mm and in inches.

    Parameters
    ----------
    lacking : what is not known, up to the colon.
    chains : what is drawn, a unit of the drawing for a mm; nothing where that cannot be read.
    """
    size = size_of(chains)
    shown = ""
    if size is not None:
        wide = f"{size[0]:.5g}"
        shown = f"it is {wide} mm wide, or {wide} in = {size[0] * INCH.millimetres:,.4g} mm; "
        if size[0] * INCH.millimetres >= 1000:
            shown = f"it is {wide} mm wide, or {wide} in = {size[0] * INCH.millimetres:,.0f} mm; "
    return UnitAskedError(f"{lacking}: {shown}say which with {UNIT} mm (or inch, cm, m).")
