"""Workpieces in JSON: ``{"name": ..., "units": "mm" | "inch", "loops": [[[x, y, bulge], ...], ...]}``.

A result file is read too: its ``workpiece`` has the same form.
"""

from __future__ import annotations

import json
from typing import Any, NoReturn

from attrs import frozen

from workhold.errors import InputError
from workhold.model.units import unit_named

__all__ = ["JsonWorkpiece", "read_json"]


@frozen
class JsonWorkpiece:
    """Name (None when the file gives none) and loops as rows x, y (mm) and bulge."""

    name: str | None
    loops: list[list[tuple[float, float, float]]]


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
    content = parsed(text)
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
    return JsonWorkpiece(content.get("name"), loops)


def parsed(text: str) -> Any:
    """The content of JSON text.

    Raises
    ------
    InputError
        Naming line and column, or the constant JSON does not have.
    """

    def refuse_constant(name: str) -> NoReturn:
        raise InputError(f"{name} is not a number a workpiece can have: correct that coordinate or bulge.")

    try:
        return json.loads(text, parse_constant=refuse_constant)
    except json.JSONDecodeError as error:
        raise InputError(
            f"The file is not valid JSON: {error.msg.lower()} at line {error.lineno}, column {error.colno}."
        ) from error
    except (RecursionError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        kind = "is nested too deeply" if isinstance(error, RecursionError) else "holds a number with too many digits"
        raise InputError(f"The file {kind}: it must be a list of loops of [x, y, bulge].") from error
