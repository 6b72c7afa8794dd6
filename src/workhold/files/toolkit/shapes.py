"""Pydantic's forms of the tables of ``fixels.fields``: one for each table, told apart by the toolkit's kind."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Mapping
from functools import reduce
from operator import or_
from typing import Annotated, Any

from pydantic import BaseModel, Discriminator, Tag, create_model

from workhold.fixels.kinds import TABLES, table_of
from workhold.fixels.table import ToolkitField

__all__ = ["TAGS", "forms_by_noun", "one_of", "optional"]

BY_NOUN = {table.noun: table for table in TABLES.values()}
# What tells the forms apart in a place of pydantic's; they are no keys of a file.
TAGS = tuple(f"<{noun}>" for noun in BY_NOUN)


def forms_by_noun(
    base: type[BaseModel],
    name: str,
    entry: Callable[[ToolkitField], Any],
    kind: Callable[[tuple[str, ...]], Any] | None = None,
    summary: str = "{}.",
) -> Mapping[str, Any]:
    """Make a form for each table, by the table's noun.

    Parameters
    ----------
    base : what all of them have in common.
    name : of the forms; "{}" in it stands for the table's noun.
    entry : type and default of a field, as pydantic's ``create_model`` takes them.
    kind : type and default of the key ``kind`` for the kinds of a table; None where no form has one of its own.
    summary : of the forms, in which "{}" stands for what the table describes.
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
        )
        # Another process finds a form that it is handed by module and name.
        setattr(sys.modules[base.__module__], forms[noun].__name__, forms[noun])
    return forms


def optional(kind: Any, row: ToolkitField) -> tuple[Any, Any]:
    """Type and default of a field of which None means that it is left out, unless it has another default."""
    if row.is_required:
        return kind, ...
    default = list(row.default) if isinstance(row.default, tuple) else row.default
    return (kind | None if default is None else kind), default


def one_of(forms: Mapping[str, Any]) -> Any:
    """The type of a value that has one of the forms, by its kind."""
    several = [Annotated[form, Tag(f"<{noun}>")] for noun, form in forms.items()]
    return Annotated[reduce(or_, several), Discriminator(tag_of)]


def tag_of(value: Any) -> str:
    """Which form a toolkit's keys have."""
    return f"<{table_of(value.get('kind') if isinstance(value, dict) else getattr(value, 'kind', None)).noun}>"
