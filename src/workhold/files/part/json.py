"""Workpieces in JSON: ``{"name": ..., "units": "mm" | "inch", "loops": [[[x, y, bulge], ...], ...]}``.

A result file is read too: its ``workpiece`` has the same form.
"""

from __future__ import annotations

from attrs import frozen

from workhold.errors import InputError
from workhold.files.text import json_value
from workhold.units import unit_named

__all__ = ["JsonWorkpiece", "read_json"]


@frozen
class JsonWorkpiece:
    """Name (None when the file gives none), loops as rows x, y (mm) and bulge, how far these depart from a drawing in mm."""

    name: str | None
    loops: list[list[tuple[float, float, float]]]
    departure: float = 0.0


def read_json(text: str, *, own: bool = False) -> JsonWorkpiece:
    """Read a workpiece, or the workpiece of a result file.

    Parameters
    ----------
    text : the JSON.
    own : whether it is a file of workhold's own, whose shape needs no check.

    Raises
    ------
    InputError
        For text that is not JSON, or not of this shape, naming the place.
    """
    content = json_value(text)
    if isinstance(content, dict) and str(content.get("format", "")).startswith("workhold-result"):
        content = content.get("workpiece")
    if not isinstance(content, dict):
        raise InputError('The file holds no workpiece: it must be {"name": ..., "units": "mm", "loops": [...]}.')
    if not own:
        from workhold.files.part.form import checked

        content = checked(content)
    units: str = content["units"]
    if units not in ("mm", "inch"):
        raise InputError(f'The units "{units[:40]}" are not known: write "mm" or "inch".')
    scale = unit_named(units).millimetres
    loops = [[(x * scale, y * scale, bulge) for x, y, bulge in loop] for loop in content["loops"]]
    return JsonWorkpiece(content.get("name"), loops, scale * (content.get("departure") or 0.0))
