"""``workhold schema``: the JSON Schemas of what goes in and out."""

from __future__ import annotations

import json
import sys
from typing import Annotated

import typer

from workhold.cli.json_output import JsonOption, print_json
from workhold.cli.values import choice

__all__ = ["schema"]


def schema(
    name: Annotated[str | None, typer.Argument(metavar="[NAME]", help="part, toolkit, loads, query or result.")] = None,
    json_: JsonOption = False,
) -> None:
    """Print the JSON Schema of a part, a toolkit, loads, a query or a result, or list them.

    TOML files have the same shape as JSON.

    Example: workhold schema result > result.schema.json
    """
    from workhold.cli.schemas import SCHEMAS, schema_of

    if name is not None:
        text = json.dumps(schema_of(choice("the schema", name, tuple(SCHEMAS))), indent=2)
        sys.stdout.write(text + "\n")
        sys.stdout.flush()
    elif json_:
        print_json(schemas=[{"name": one, "of": words} for one, (words, _) in SCHEMAS.items()])
    else:
        from workhold.cli.tables import Table, print_tables

        table = Table(("name", "of"))
        for one, (words, _) in SCHEMAS.items():
            table.add_row(one, words)
        print_tables(table)
