"""The shape of a workpiece in JSON, checked by pydantic; a module of its own because pydantic takes long to import."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, ValidationError

from workhold.errors import InputError

__all__ = ["checked"]

COLUMNS = ("x", "y", "bulge")


class WorkpieceForm(BaseModel):
    """The shape of the file; what the loops mean is checked by the workpiece."""

    model_config = ConfigDict(strict=True)

    name: str | None = None
    units: str
    departure: FiniteFloat | None = Field(default=None, ge=0)
    loops: list[list[Annotated[list[FiniteFloat], Field(min_length=3, max_length=3)]]] = Field(min_length=1)


def checked(content: dict[str, Any]) -> dict[str, Any]:
    """Name (None when there is none), units and loops of a workpiece, each of the type it should have.

    Raises
    ------
    InputError
        Naming the place of the first thing that is not of this shape.
    """
    try:
        return WorkpieceForm.model_validate(content).model_dump()
    except ValidationError as error:
        raise InputError(in_words(error)) from error


def in_words(error: ValidationError) -> str:
    """The first thing wrong with the shape, as one sentence."""
    first = error.errors(include_url=False, include_context=False)[0]
    place, kind = list(first["loc"]), first["type"]
    if place == ["units"]:
        return 'The workpiece gives no units: write "units": "mm" or "units": "inch".'
    if place == ["loops"]:
        return 'The workpiece has no loops: write "loops": [[[x, y, bulge], ...], ...], the outer loop first.'
    if place == ["departure"]:
        return 'The workpiece\'s "departure" must be a length, 0 or more.'
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
