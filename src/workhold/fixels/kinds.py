"""The kinds of toolkits, by the names that files and users give them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from attrs import NOTHING, fields_dict

from workhold.errors import InputError
from workhold.fixels.fence import Fence
from workhold.fixels.flat_jaw import FlatJaw
from workhold.fixels.plain_vise import PlainVise
from workhold.fixels.plate import Plate
from workhold.fixels.setup_words import PageWords
from workhold.fixels.strapped import StrapPlate
from workhold.fixels.table import FieldTable, ToolkitField
from workhold.fixels.toolkit import Toolkit
from workhold.fixels.vise import OpeningVise, Vise

__all__ = [
    "ALIASES",
    "KINDS",
    "PAGES",
    "TABLES",
    "USUAL",
    "resolve_kind",
    "find_owner",
    "find_table",
    "make_toolkit",
]

KINDS: Mapping[str, type[Toolkit]] = {
    one.kind: one for one in (Vise, OpeningVise, Plate, Fence, FlatJaw, PlainVise, StrapPlate)
}
# The fields of each kind; kinds that differ in no field share a table.
TABLES: Mapping[str, FieldTable] = {name: kind.table for name, kind in KINDS.items()}
# The default kind.
USUAL = Vise.kind
# Other names, each with its kind and the fields that it sets.
ALIASES: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    "gripper": (Vise.kind, {"columns": 1}),
    "plate": (Plate.kind, {}),
    "fence": (Fence.kind, {}),
}


# The kinds on the page by name, in its order, with an alias that sets some fields.
PAGES: Mapping[str, PageWords] = {
    **{one.kind: one.page for one in (Plate, Fence, Vise, OpeningVise, FlatJaw, PlainVise, StrapPlate)},
    "gripper": PageWords("Gripper, one column a jaw", "Close gripper", {**Vise.page.start, "columns": 1}),
}


def resolve_kind(name: str) -> tuple[str, Mapping[str, Any]]:
    """Return (1) the kind of toolkit that a name or an alias stands for, and (2) the values of fields that an
    alias sets.

    Raises
    ------
    InputError
        For a name that is not known.

    Examples
    --------
    >>> resolve_kind("gripper")
    ('vise', {'columns': 1})
    """
    if name in ALIASES:
        return ALIASES[name]
    if name not in KINDS:
        raise InputError(f"toolkit {name[:40]!r} is not known: choose among {', '.join((*KINDS, *ALIASES))}.")
    return name, {}


def find_table(kind: object) -> FieldTable:
    """Return the table of fields of a kind, given by its name.

    For any other value, also for an alias, it is the table of the default kind.
    """
    return TABLES.get(str(kind), TABLES[USUAL])


def find_owner(row: ToolkitField) -> FieldTable:
    """Return the first table, in the order of ``KINDS``, that has a field with the name of ``row``."""
    return next(table for table in TABLES.values() if any(one.name == row.name for one in table.fields))


def make_toolkit(kind: str, fields: Mapping[str, Any]) -> Toolkit:
    """Return a toolkit of a kind with the given fields.

    Parameters
    ----------
    kind : name or alias of the kind.
    fields : keyword arguments of its class; they override those of an alias.

    Raises
    ------
    InputError
        For an unknown kind, unknown or missing fields, and invalid values.

    Examples
    --------
    >>> make_toolkit("opening-vise", {"pitch": 10, "columns": 2, "peg_radius": 3}).clamping
    -1
    """
    known, said = resolve_kind(kind)
    toolkit, given = KINDS[known], {**said, **fields}
    has = fields_dict(toolkit)  # type: ignore[arg-type]
    for name in given:
        if name not in has:
            raise InputError(f"a toolkit of kind {known} has no {name.replace('_', ' ')[:40]}: leave it out.")
    for name, field in has.items():
        if field.default is NOTHING and name not in given:
            raise InputError(f"the {toolkit.noun}'s {name.replace('_', ' ')} is not given.")
    return toolkit(**given)
