"""The OpenAPI description of the server: what FastAPI makes, with this server's errors and tried examples."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from workhold.web.answer_shapes import ErrorAnswer, PlaceAnswer
from workhold.web.examples import EXAMPLES, ApiExample

__all__ = ["described"]

STATUSES = ("400", "401", "403", "404", "408", "409", "413", "415", "429", "500", "503")
REFERENCE = "#/components/schemas/{model}"
WRONG = {
    "description": "What is wrong, in one sentence",
    "content": {"application/json": {"schema": {"$ref": "#/components/schemas/ErrorAnswer"}}},
}


def described(app: FastAPI) -> dict[str, Any]:
    """Makes the description, once."""
    if app.openapi_schema is None:
        schema = get_openapi(
            title=app.title,
            version=app.version,
            summary=app.summary,
            description=app.description,
            routes=app.routes,
            separate_input_output_schemas=False,
        )
        shapes = schema.setdefault("components", {}).setdefault("schemas", {})
        for path, operations in schema["paths"].items():
            for method, operation in operations.items():
                operation["responses"].pop("422", None)
                operation["responses"] |= {status: deepcopy(WRONG) for status in STATUSES}
                add_example(operation, EXAMPLES[f"{method.upper()} {path}"])
        for name in ("HTTPValidationError", "ValidationError"):
            shapes.pop(name, None)
        for shape in (PlaceAnswer, ErrorAnswer):
            made = shape.model_json_schema(ref_template=REFERENCE)
            made.pop("$defs", None)
            shapes[shape.__name__] = made
        app.openapi_schema = schema
    return app.openapi_schema


def add_example(operation: dict[str, Any], example: ApiExample) -> None:
    """Writes an example into the parameters, the request and the answer of an operation."""
    for parameter in operation.get("parameters", ()):
        given = example.headers if parameter["in"] == "header" else {**example.path, **example.query}
        if parameter["name"] in given:
            parameter["example"] = given[parameter["name"]]
    for content in operation.get("requestBody", {}).get("content", {}).values():
        if example.body is not None:
            content["example"] = example.body
    answer = operation["responses"][str(example.status)]
    if example.answer is not None:
        content = answer.setdefault("content", {}).setdefault(example.type, {"schema": {}})
        content["example"] = example.answer
