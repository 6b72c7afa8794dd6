"""The shape of a toolkit's TOML file, checked by pydantic; a module of its own because pydantic takes long to import."""

from __future__ import annotations

from collections.abc import Mapping
from difflib import get_close_matches
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, ValidationError

from workhold.errors import InputError
from workhold.model.fence import Fence
from workhold.model.kinds import USUAL, kind_of
from workhold.model.plate import Plate

__all__ = ["checked"]

Pair = Annotated[list[FiniteFloat], Field(min_length=2, max_length=2)]
Ways = Annotated[list[str], Field(min_length=2, max_length=2)]


class ToolkitForm(BaseModel):
    """What the file of any toolkit may say; what the numbers mean is checked by the toolkit and the dowel."""

    model_config = ConfigDict(strict=True, extra="forbid")

    unit: str
    kind: str | None = None
    pitch: FiniteFloat | Pair
    peg_radius: FiniteFloat
    title: str | None = None
    source: str | None = None
    assumed: list[str] | None = None
    rows: int | None = None
    dowel: str | None = None
    pin_diameter: Pair | None = None
    hole_diameter: Pair | None = None
    hole_position: FiniteFloat | None = None
    peg_tolerance: FiniteFloat | None = None
    face_tolerance: FiniteFloat | None = None
    flat: FiniteFloat | Pair | None = None


class ViseForm(ToolkitForm):
    """The file of a vise."""

    columns: int
    min_gap: FiniteFloat | None = None
    max_opening: FiniteFloat | None = None
    row_offset: FiniteFloat | None = None
    body_radius: FiniteFloat | None = None
    blocked: list[str] | None = None


class PlateForm(ToolkitForm):
    """The file of a plate with a clamp."""

    columns: int | None = None
    clamp_radius: FiniteFloat | None = None
    travel: Pair | None = None
    clamps: int | None = None
    directions: list[str] | list[Ways] | None = None


class FenceForm(PlateForm):
    """The file of a fence with a locator and a clamp."""

    wall_offset: FiniteFloat


# The form of each kind's file; that of a vise is any other's.
FORMS: Mapping[str, type[ToolkitForm]] = {Plate.kind: PlateForm, Fence.kind: FenceForm}
NOUNS = {PlateForm: "plate", FenceForm: "fence"}

WANTED = {
    "unit": 'write unit = "mm" or unit = "inch"',
    "pitch": "write the distance between holes as one number, or [x, y]",
    "columns": "write how many columns of holes each jaw has, such as columns = 2",
    "peg_radius": "write the radius of the pegs as a number",
    "wall_offset": "write the distance from the fence to the first row of holes",
    "travel": "write the least and the most from the clamp's hole to its tip, such as [10, 35]",
    "directions": 'write a list of "-x", "+x", "-y" and "+y", or of two clamps a list of pairs such as ["-x", "-y"]',
    "clamps": "write 1 or 2",
    "assumed": 'write a list of the entries that no source gives, such as ["travel"]',
    "flat": "write its distance from a peg's centre, or that and half its width, such as [2.5, 1.5]",
    "blocked": 'write a list of holes and columns by name, such as ["L-B3", "R-A"]',
    "pin_diameter": "write the smallest and the largest diameter, such as [5.982, 6.0]",
    "hole_diameter": "write the smallest and the largest diameter, such as [6.0, 6.012]",
}


def checked(content: Mapping[str, Any]) -> dict[str, Any]:
    """The entries of a toolkit's file that are given, each of the type it should have.

    Raises
    ------
    InputError
        Naming the first entry that is not of this shape.
    """
    kind = content.get("kind", USUAL)
    form = FORMS.get(kind_of(kind)[0], ViseForm) if isinstance(kind, str) else ViseForm
    try:
        return form.model_validate(content).model_dump(exclude_none=True)
    except ValidationError as error:
        raise InputError(in_words(error, form)) from error


def in_words(error: ValidationError, form: type[ToolkitForm]) -> str:
    """The first thing wrong with the shape, as one sentence."""
    first = error.errors(include_url=False, include_context=False)[0]
    name, kind = str(first["loc"][0]), first["type"]
    if kind == "extra_forbidden":
        known = get_close_matches(name, form.model_fields, n=1)
        meant = f"did you mean {known[0]}?" if known else f"the entries are {', '.join(form.model_fields)}."
        return f'"{name[:40]}" is no entry of a {NOUNS.get(form, "vise")}: {meant}'
    if kind == "missing":
        return f"{name} is missing: {WANTED[name]}."
    field = form.model_fields[name].annotation
    usual = "write text in quotes" if field == str | None else "write a finite number"
    if field == int | None:
        usual = "write a whole number"
    return f"{name} is not what it should be: {WANTED.get(name, usual)}."
