"""The command ``schema``: JSON Schemas of what goes in and out, generated from the forms that check it."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping
from typing import Annotated, Any

import typer

from workhold.cli.outputs import JsonOption, print_json
from workhold.cli.values import choice

__all__ = ["SCHEMAS", "schema", "schema_of"]

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def part_schema() -> dict[str, Any]:
    """The schema of a workpiece in JSON."""
    from workhold.files.input_forms import WorkpieceFile

    return WorkpieceFile.model_json_schema()


def toolkit_schema() -> dict[str, Any]:
    """The schema of a toolkit's TOML file: one of those of the kinds."""
    from pydantic import TypeAdapter

    from workhold.files.input_forms import FORMS, one_of
    from workhold.fixels.kinds import ALIASES, KINDS, USUAL, kind_of, table_of

    schema = TypeAdapter(one_of(FORMS)).json_schema()
    for noun, form in FORMS.items():
        names = [name for name in (*KINDS, *ALIASES) if table_of(kind_of(name)[0]).noun == noun]
        schema["$defs"][form.__name__]["properties"]["kind"] = {"enum": names, "title": "Kind"}
        if USUAL not in names:
            schema["$defs"][form.__name__]["required"].append("kind")
    return schema


def loads_schema() -> dict[str, Any]:
    """The schema of a loads file."""
    from workhold.files.input_forms import LoadsFile

    return LoadsFile.model_json_schema()


def query_schema() -> dict[str, Any]:
    """The schema of a search as it is asked over HTTP."""
    from workhold.web.forms import JobForm

    return JobForm.model_json_schema()


def result_schema() -> dict[str, Any]:
    """The schema of a result file."""
    from workhold.files.result.fixture_forms import ResultFile

    return ResultFile.model_json_schema()


# The schemas by name, each with what it is of.
SCHEMAS: Mapping[str, tuple[str, Callable[[], dict[str, Any]]]] = {
    "part": ("a part in JSON", part_schema),
    "toolkit": ("a vise, a plate or a fence, as its TOML file says it", toolkit_schema),
    "loads": ("a loads file, TOML or JSON", loads_schema),
    "query": ("a search as it is asked over HTTP", query_schema),
    "result": ("a result file in JSON", result_schema),
}


def schema_of(name: str) -> dict[str, Any]:
    """Returns the JSON Schema of a name.

    Forms of which a word in the file chooses one differ in all they say, so that a file must fit at least one
    of them.
    """
    words, make = SCHEMAS[name]
    schema: dict[str, Any] = loosened(make())
    return {
        "$schema": DIALECT,
        **schema,
        "title": f"workhold {name}",
        "description": f"The shape of {words}.",
    }


def loosened(schema: Any) -> Any:
    """Replaces "exactly one of these" by "any of these" throughout a schema."""
    if isinstance(schema, dict):
        return {("anyOf" if key == "oneOf" else key): loosened(value) for key, value in schema.items()}
    return [loosened(one) for one in schema] if isinstance(schema, list) else schema


def schema(
    name: Annotated[
        str | None, typer.Argument(metavar="[NAME]", help="part, toolkit, loads, query or result.")
    ] = None,
    json_: JsonOption = False,
) -> None:
    """Print the JSON Schema of a part, a toolkit, loads, a query or a result, or list them.

    TOML files have the same shape as JSON.

    Example: workhold schema result > result.schema.json
    """

    if name is not None:
        text = json.dumps(schema_of(choice("the schema", name, tuple(SCHEMAS))), indent=2)
        sys.stdout.write(text + "\n")
        sys.stdout.flush()
    elif json_:
        print_json(schemas=[{"name": one, "of": words} for one, (words, _) in SCHEMAS.items()])
    else:
        from workhold.cli.table import Table, print_tables

        table = Table(("name", "of"))
        for one, (words, _) in SCHEMAS.items():
            table.add_row(one, words)
        print_tables(table)
