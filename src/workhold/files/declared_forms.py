"""Pydantic forms for declared fields: those of requests, of agents and of files.

They are a module of their own because pydantic takes long to import.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from datetime import date
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, Field, create_model

from workhold.asking.declaring import Declaration, Form

__all__ = ["collect_given_values", "add_declared_fields"]

Kind = TypeVar("Kind", bound=BaseModel)
NUMBERS: Mapping[Form, type] = {
    "count": int,
    "length": float,
    "force": float,
    "power": float,
    "number": float,
}
TYPES: Mapping[Form, Any] = {
    "flag": bool,
    "text": str,
    "names": list[str],
    "coefficients": dict[str, float],
    "margins": dict[str, float],
    "day": date,
    "place": Annotated[list[float], Field(min_length=2, max_length=2)],
    "point": Annotated[list[float], Field(min_length=3, max_length=3)],
}
LIMITS = {"above 0": {"gt": 0}, "0": {"ge": 0}, "any": {}}


def add_declared_fields(
    rows: Iterable[Declaration], largest: float | None = None, *, bounded: bool = True
) -> Callable[[type[Kind]], type[Kind]]:
    """Return a decorator that adds the declared fields to a form, except
    for fields that the form already has.

    Parameters
    ----------
    largest : limit of numbers, for a server; None for no limit besides the declared bounds.
    bounded : whether the form refuses values beyond the declared bounds; False leaves that to the
        constructor, as files do.
    """

    def add_fields(form: type[Kind]) -> type[Kind]:
        """Return the form with the declared fields added."""
        entries: dict[str, Any] = {
            row.name: make_form_field(row, largest, bounded)
            for row in rows
            if row.name not in form.model_fields
        }
        return create_model(
            form.__name__, __base__=form, __module__=form.__module__, __doc__=form.__doc__, **entries
        )

    return add_fields


def make_form_field(row: Declaration, largest: float | None, bounded: bool) -> tuple[Any, Any]:
    """Return the type and the pydantic field, with default and description, of a declared field."""
    kind: Any = str
    if row.form == "choice" and bounded:
        kind = Literal[row.choices]
    elif row.form in NUMBERS:
        bounds: dict[str, Any] = list_field_limits(row, largest) if bounded else {}
        kind = Annotated[NUMBERS[row.form], Field(**bounds)] if bounds else NUMBERS[row.form]
    elif row.form != "choice":
        kind = TYPES[row.form]
    if row.default is None:
        kind = kind | None
    return kind, Field(default=row.default, description=row.help)


def list_field_limits(row: Declaration, largest: float | None) -> dict[str, Any]:
    """Return the bounds of a declared number as keyword arguments of pydantic's ``Field``.

    If ``largest`` is given, it limits numbers that are not counts, and counts are limited by their own
    declared maximum.
    """
    if row.form == "count":
        return {"ge": 1} | ({} if largest is None or row.most is None else {"le": row.most})
    ends = {} if largest is None else {"le": largest} | ({"ge": -largest} if row.least == "any" else {})
    return LIMITS[row.least] | ends


def collect_given_values(form: BaseModel, rows: Iterable[Declaration]) -> dict[str, Any]:
    """Return the values of declared fields in a form, by name."""
    return {row.name: getattr(form, row.name) for row in rows}
