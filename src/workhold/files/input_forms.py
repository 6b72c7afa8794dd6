"""The forms of files that users write, toolkits, workpieces and loads, as models of pydantic.

They are a module of their own because pydantic takes long to import. Loads files are read by
``files.loads_file``; their form serves its JSON Schema. Forms of toolkits are made from the tables of
``fixels.fields``, one for each table, and distinguished by the toolkit's kind.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from difflib import get_close_matches
from functools import reduce
from operator import or_
from typing import Annotated, Any

from pydantic import (
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    FiniteFloat,
    Tag,
    ValidationError,
    create_model,
)

from workhold.errors import InputError
from workhold.fixels.fields import OPTIONS
from workhold.fixels.kinds import TABLES, USUAL, find_table, resolve_kind
from workhold.fixels.support_hardware import HARDWARE
from workhold.fixels.table import Form, ToolkitField

__all__ = [
    "LONGEST_NAME",
    "TAGS",
    "LoadsFile",
    "check_toolkit_entries",
    "check_workpiece_entries",
    "make_forms_by_noun",
    "join_forms",
    "make_optional_entry",
]

# Letters of the name of a part or a load: more than any sheet has room for.
LONGEST_NAME = 10_000
# Figures of supports and of a clamp on top, whose names are checked where they are made.
HARDWARE_KEYS: Mapping[str, Any] = dict.fromkeys(
    HARDWARE, (dict[str, FiniteFloat | list[list[FiniteFloat]]] | None, None)
)
BY_NOUN = {table.noun: table for table in TABLES.values()}
# What distinguishes the forms in a place of pydantic's; they are not keys of a file.
TAGS = tuple(f"<{noun}>" for noun in BY_NOUN)


def make_forms_by_noun(
    base: type[BaseModel],
    name: str,
    entry: Callable[[ToolkitField], Any],
    kind: Callable[[tuple[str, ...]], Any] | None = None,
    summary: str = "{}.",
    hardware: Mapping[str, Any] | None = None,
) -> Mapping[str, Any]:
    """Return a pydantic model for each table of toolkits, by the table's noun.

    Parameters
    ----------
    base : base class of all of them.
    name : name of the forms; "{}" in it is replaced by the table's noun.
    entry : returns type and default of a field, as pydantic's ``create_model`` takes them.
    kind : returns type and default of the key ``kind`` from the kinds of a table; None if the forms do not
        get that key here.
    summary : docstring of the forms; "{}" in it is replaced by the summary of the table.
    hardware : type and default of supports and a clamp on top, by their names; the usual ones if None.
    """
    forms: dict[str, Any] = {}
    for noun, table in BY_NOUN.items():
        kinds = tuple(one for one, other in TABLES.items() if other is table)
        fields = {} if kind is None else {"kind": kind(kinds)}
        forms[noun] = create_model(
            name.format(re.sub(r"\W", "", noun.title())),
            __base__=base,
            __module__=base.__module__,
            __doc__=summary.format(table.summary),
            **fields,
            **{row.name: entry(row) for row in table.fields},
            **(HARDWARE_KEYS if hardware is None else hardware),
        )
    return forms


def make_optional_entry(kind: Any, row: ToolkitField) -> tuple[Any, Any]:
    """Return (type, default) of a form's field.

    A required field has no default; another one has the field's default, or None if the field has none.
    """
    if row.is_required:
        return kind, ...
    default = list(row.default) if isinstance(row.default, tuple) else row.default
    return (kind | None if default is None else kind), default


def join_forms(forms: Mapping[str, Any]) -> Any:
    """Return the union of forms as a type, discriminated by the toolkit's kind."""
    several = [Annotated[form, Tag(f"<{noun}>")] for noun, form in forms.items()]
    return Annotated[reduce(or_, several), Discriminator(find_form_tag)]


def find_form_tag(value: Any) -> str:
    """Return the tag by which pydantic chooses the form for a toolkit, given as a dict or a model; it follows
    from the toolkit's kind.
    """
    return (
        f"<{find_table(value.get('kind') if isinstance(value, dict) else getattr(value, 'kind', None)).noun}>"
    )


TwoNumbers = Annotated[list[FiniteFloat], Field(min_length=2, max_length=2)]
Ways = Annotated[list[str], Field(min_length=2, max_length=2)]
# What a file gives for each form of field.
TYPES: Mapping[Form, Any] = {
    "count": int,
    "length": FiniteFloat,
    "pitch": FiniteFloat | TwoNumbers,
    "span": TwoNumbers,
    "flat": FiniteFloat | TwoNumbers,
    "heights": TwoNumbers,
    "holes": list[str],
    "directions": list[str] | list[Ways],
    "lengths": list[FiniteFloat],
    "choice": str,
    "force": FiniteFloat,
}


class ToolkitForm(BaseModel):
    """The entries that the file of any toolkit may have; the constructors of the toolkit and the dowel check
    the values.
    """

    model_config = ConfigDict(strict=True, extra="forbid")

    unit: str
    kind: str | None = None
    title: str | None = None
    source: str | None = None
    assumed: list[str] | None = None
    dowel: str | None = None
    pin_diameter: TwoNumbers | None = None
    hole_diameter: TwoNumbers | None = None
    hole_position: FiniteFloat | None = None
    peg_tolerance: FiniteFloat | None = None
    face_tolerance: FiniteFloat | None = None


def make_toolkit_entry(row: ToolkitField) -> tuple[Any, Any]:
    """Return (type, default) of a field in a toolkit's file.

    The default is None, which keeps the field's own default, unless the field is required.
    """
    return (TYPES[row.form], ...) if row.is_required else (TYPES[row.form] | None, None)


# By the noun of their tables.
FORMS = make_forms_by_noun(
    ToolkitForm,
    "{}Form",
    make_toolkit_entry,
    summary="{}, as its file describes it.",
    hardware={
        name: (kind, Field(default=None, alias=name.replace("_", "-")))
        for name, (kind, _) in HARDWARE_KEYS.items()
    },
)

WANTED = {
    "unit": 'write unit = "mm" or unit = "inch"',
    "assumed": 'write a list of the entries that no source gives, such as ["travel"]',
    "pin_diameter": "write the smallest and the largest diameter, such as [5.982, 6.0]",
    "hole_diameter": "write the smallest and the largest diameter, such as [6.0, 6.012]",
    "supports": "write a table of numbers, such as [supports] and below it pad_radius = 4",
    "pins": "write a table of numbers, such as [pins] and below it movement_limit = 0.03",
    "top-clamp": "write a table, such as [top-clamp] and below it tip_radius = 5, reach = [[0, 0, 10, 90]]",
} | {row.name: row.entry for row in OPTIONS if row.entry}


def check_toolkit_entries(content: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entries given in a toolkit's file, after checking that all are known and of the right type.

    Raises InputError for the first entry that is not.
    """
    kind = content.get("kind", USUAL)
    noun = find_table(resolve_kind(kind)[0] if isinstance(kind, str) else None).noun
    try:
        given: dict[str, Any] = FORMS[noun].model_validate(content).model_dump(exclude_none=True)
    except ValidationError as error:
        raise InputError(describe_toolkit_fault(error, FORMS[noun], noun)) from error
    return given


def describe_toolkit_fault(error: ValidationError, form: type[ToolkitForm], noun: str) -> str:
    """Return a sentence on the first error of a toolkit's form, with a remedy."""
    first = error.errors(include_url=False, include_context=False)[0]
    name, kind = str(first["loc"][0]), first["type"]
    if kind == "extra_forbidden":
        # The fields of the toolkit stand right after what it is.
        own = [field for field in form.model_fields if field not in ToolkitForm.model_fields]
        order = dict.fromkeys(("unit", "kind", *own, *form.model_fields))
        entries = [form.model_fields[one].alias or one for one in order]
        known = get_close_matches(name, entries, n=1)
        meant = f"did you mean {known[0]}?" if known else f"the entries are {', '.join(entries)}."
        return f'"{name[:40]}" is not an entry of a {noun}: {meant}'
    if kind == "missing":
        return f"{name} is missing: {WANTED[name]}."
    if name in WANTED:
        return f"{name} is not what it should be: {WANTED[name]}."
    field = form.model_fields[name].annotation
    usual = "write text in quotes" if field == str | None else "write a finite number"
    if field == int | None:
        usual = "write a whole number"
    return f"{name} is not what it should be: {usual}."


COLUMNS = ("x", "y", "bulge")


class WorkpieceFile(BaseModel):
    """The form of a workpiece in JSON; the loops themselves are checked by the workpiece."""

    model_config = ConfigDict(strict=True)

    name: str | None = Field(default=None, max_length=LONGEST_NAME)
    units: str
    departure: FiniteFloat | None = Field(default=None, ge=0)
    loops: list[list[Annotated[list[FiniteFloat], Field(min_length=3, max_length=3)]]] = Field(min_length=1)


def check_workpiece_entries(content: dict[str, Any]) -> dict[str, Any]:
    """Return name (or None), units, departure and loops of a workpiece, after checking their types.

    Raises InputError for the first value of a wrong type.
    """
    try:
        return WorkpieceFile.model_validate(content).model_dump()
    except ValidationError as error:
        raise InputError(describe_workpiece_fault(error)) from error


def describe_workpiece_fault(error: ValidationError) -> str:
    """Return a sentence on the first error of a workpiece's form, with a remedy."""
    first = error.errors(include_url=False, include_context=False)[0]
    place, kind = list(first["loc"]), first["type"]
    if place == ["units"]:
        return 'The workpiece gives no units: write "units": "mm" or "units": "inch".'
    if place == ["loops"]:
        return 'The workpiece has no loops: write "loops": [[[x, y, bulge], ...], ...], the outer loop first.'
    if place == ["departure"]:
        return 'The workpiece\'s "departure" must be a length, 0 or more.'
    if place == ["name"]:
        return f'The workpiece\'s "name" must be text of {LONGEST_NAME:,} letters at most.'
    # Numbers in messages are those of the file: loops and vertices count from 0.
    words = f"Loop {place[1]}" if len(place) > 1 else "The workpiece"
    if len(place) > 2:
        words += f", vertex {place[2]}"
    if kind in ("too_short", "too_long") or len(place) == 3:
        return f"{words} must be three numbers [x, y, bulge]."
    if len(place) > 3:
        return f"{words} has a {COLUMNS[int(place[3])]} that is not a finite number: correct it."
    return f"{words} must be a list of vertices [x, y, bulge]."


Point = Annotated[list[float | str], Field(min_length=2, max_length=2)] | str
Vector = Annotated[list[float | str], Field(min_length=3, max_length=3)]
Angles = Annotated[list[float | str], Field(min_length=2, max_length=2)]


class LoadTable(BaseModel):
    """One load: a force at a point or along a path, a moment, or both."""

    model_config = ConfigDict(extra="forbid")

    name: str = Field(default="", max_length=LONGEST_NAME)
    force: float | str | Vector = Field(
        default=0.0, description="in N, or with a unit: 0.2 kN, 45 lbf; or along x, y and z of the part, z up"
    )
    at: Point | None = Field(default=None, description="where the force acts; or path")
    z: float | str | None = Field(
        default=None, description="its height above the part's lower side; the part's top if not given"
    )
    path: Annotated[list[Point], Field(min_length=2)] | str | None = Field(
        default=None, description="the points it runs along"
    )
    direction: float | str | Angles = Field(
        default="any", description="degrees in the part's frame: 30, 30..60, [30, 60] or any"
    )
    moment: float | str = Field(default=0.0, description="in N mm, or with a unit: 5 N.m, 40 lbf.in")


class LoadsFile(BaseModel):
    """The loads of a cutter, a drill or a hand on the part."""

    model_config = ConfigDict(extra="forbid")

    unit: str | None = Field(default=None, description="of at and path: mm, cm, m or inch")
    load: list[LoadTable] = Field(min_length=1)
