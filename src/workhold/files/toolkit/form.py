"""The shape of a toolkit's TOML file, checked by pydantic; a module of its own because pydantic takes long to import."""

from __future__ import annotations

from collections.abc import Mapping
from difflib import get_close_matches
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, ValidationError

from workhold.errors import InputError
from workhold.files.toolkit.shapes import forms_by_noun
from workhold.fixels.fields import OPTIONS
from workhold.fixels.kinds import USUAL, kind_of, table_of
from workhold.fixels.table import Form, ToolkitField

__all__ = ["checked"]

Pair = Annotated[list[FiniteFloat], Field(min_length=2, max_length=2)]
Ways = Annotated[list[str], Field(min_length=2, max_length=2)]
# What a file gives for each form of field.
TYPES: Mapping[Form, Any] = {
    "count": int,
    "length": FiniteFloat,
    "pitch": FiniteFloat | Pair,
    "span": Pair,
    "flat": FiniteFloat | Pair,
    "holes": list[str],
    "directions": list[str] | list[Ways],
}


class ToolkitForm(BaseModel):
    """What the file of any toolkit may say; what the numbers mean is checked by the toolkit and the dowel."""

    model_config = ConfigDict(strict=True, extra="forbid")

    unit: str
    kind: str | None = None
    title: str | None = None
    source: str | None = None
    assumed: list[str] | None = None
    dowel: str | None = None
    pin_diameter: Pair | None = None
    hole_diameter: Pair | None = None
    hole_position: FiniteFloat | None = None
    peg_tolerance: FiniteFloat | None = None
    face_tolerance: FiniteFloat | None = None


def entry_of(row: ToolkitField) -> tuple[Any, Any]:
    """Type and default of a field in a file, in which what is left out keeps its default."""
    return (TYPES[row.form], ...) if row.is_required else (TYPES[row.form] | None, None)


# By the noun of their tables.
FORMS = forms_by_noun(ToolkitForm, "{}Form", entry_of, summary="{}, as its file describes it.")

WANTED = {
    "unit": 'write unit = "mm" or unit = "inch"',
    "assumed": 'write a list of the entries that no source gives, such as ["travel"]',
    "pin_diameter": "write the smallest and the largest diameter, such as [5.982, 6.0]",
    "hole_diameter": "write the smallest and the largest diameter, such as [6.0, 6.012]",
} | {row.name: row.entry for row in OPTIONS if row.entry}


def checked(content: Mapping[str, Any]) -> dict[str, Any]:
    """The entries of a toolkit's file that are given, each of the type it should have.

    Raises
    ------
    InputError
        Naming the first entry that is not of this shape.
    """
    kind = content.get("kind", USUAL)
    noun = table_of(kind_of(kind)[0] if isinstance(kind, str) else None).noun
    try:
        given: dict[str, Any] = FORMS[noun].model_validate(content).model_dump(exclude_none=True)
    except ValidationError as error:
        raise InputError(in_words(error, FORMS[noun], noun)) from error
    return given


def in_words(error: ValidationError, form: type[ToolkitForm], noun: str) -> str:
    """The first thing wrong with the shape, as one sentence."""
    first = error.errors(include_url=False, include_context=False)[0]
    name, kind = str(first["loc"][0]), first["type"]
    if kind == "extra_forbidden":
        known = get_close_matches(name, form.model_fields, n=1)
        # The fields of the toolkit stand right after what it is.
        first_ones = ["unit", "kind", *(field for field in form.model_fields if field not in ToolkitForm.model_fields)]
        entries = dict.fromkeys([*first_ones, *form.model_fields])
        meant = f"did you mean {known[0]}?" if known else f"the entries are {', '.join(entries)}."
        return f'"{name[:40]}" is no entry of a {noun}: {meant}'
    if kind == "missing":
        return f"{name} is missing: {WANTED[name]}."
    field = form.model_fields[name].annotation
    usual = "write text in quotes" if field == str | None else "write a finite number"
    if field == int | None:
        usual = "write a whole number"
    return f"{name} is not what it should be: {WANTED.get(name, usual)}."
