"""Workpieces in JSON: ``{"name": ..., "units": "mm" | "inch", "loops": [[[x, y, bulge], ...], ...]}``.

A result file is read too: its ``workpiece`` has the same form.
"""

from __future__ import annotations

import json
from typing import Annotated, Any, NoReturn

from attrs import frozen
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, ValidationError

from holdfast.errors import InputError
from holdfast.files.units import millimetres_per

__all__ = ["JsonWorkpiece", "read_json"]

COLUMNS = ("x", "y", "bulge")


class WorkpieceForm(BaseModel):
    """The shape of the file; what the loops mean is checked by the workpiece."""

    model_config = ConfigDict(strict=True)

    name: str | None = None
    units: str
    loops: list[list[Annotated[list[FiniteFloat], Field(min_length=3, max_length=3)]]] = Field(min_length=1)


@frozen
class JsonWorkpiece:
    """Name (None when the file gives none) and loops as rows x, y (mm) and bulge."""

    name: str | None
    loops: list[list[tuple[float, float, float]]]


def read_json(text: str) -> JsonWorkpiece:
    """Read a workpiece, or the workpiece of a result file.

    Raises
    ------
    InputError
        For text that is not JSON, or not of this shape, naming the place.
    """
    content = parsed(text)
    if isinstance(content, dict) and str(content.get("format", "")).startswith("holdfast-result"):
        content = content.get("workpiece")
    if not isinstance(content, dict):
        raise InputError('The file holds no workpiece: it must be {"name": ..., "units": "mm", "loops": [...]}.')
    try:
        form = WorkpieceForm.model_validate(content)
    except ValidationError as error:
        raise InputError(in_words(error)) from error
    if form.units not in ("mm", "inch"):
        raise InputError(f'The units "{form.units[:40]}" are not known: write "mm" or "inch".')
    scale = millimetres_per(form.units)
    loops = [[(x * scale, y * scale, bulge) for x, y, bulge in loop] for loop in form.loops]
    return JsonWorkpiece(form.name, loops)


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


def in_words(error: ValidationError) -> str:
    """The first thing wrong with the shape, as one sentence."""
    first = error.errors(include_url=False, include_context=False)[0]
    place, kind = list(first["loc"]), first["type"]
    if place == ["units"]:
        return 'The workpiece gives no units: write "units": "mm" or "units": "inch".'
    if place == ["loops"]:
        return 'The workpiece has no loops: write "loops": [[[x, y, bulge], ...], ...], the outer loop first.'
    if place == ["name"]:
        return 'The workpiece\'s "name" must be text.'
    # Numbers in messages are those of the file: loops and vertices count from 0.
    words = f"Loop {place[1]}" if len(place) > 1 else "The workpiece"
    if len(place) > 2:
        words += f", vertex {place[2]}"
    if kind in ("too_short", "too_long") or len(place) == 3:
        return f"{words} must be three numbers [x, y, bulge]."
    if len(place) > 3:
        return f"{words} has a {COLUMNS[int(place[3])]} that is not a finite number: correct it."
    return f"{words} must be a list of vertices [x, y, bulge]."
