"""The OpenAPI description of the server: FastAPI's own, completed by errors, shapes of answers and examples.

Answers are made from plain data and are not checked again when they are sent; tests compare them with the
shapes. Each operation has an example, which a test tries. An example shows only part of an answer: the first
entries of lists, some keys of objects.
"""

from __future__ import annotations

import json
from copy import deepcopy
from typing import Any, Literal

from attrs import field, frozen
from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel, ConfigDict, Field

__all__ = [
    "EXAMPLES",
    "FAMILY_NAME",
    "JOB_NAME",
    "NONE_NAME",
    "ApiExample",
    "ErrorAnswer",
    "JobAddress",
    "JobAnswer",
    "PlaceAnswer",
    "describe_app",
]

STATUSES = ("400", "401", "403", "404", "408", "409", "413", "415", "429", "500", "503")
REFERENCE = "#/components/schemas/{model}"
WRONG = {
    "description": "What is wrong, in one sentence",
    "content": {"application/json": {"schema": {"$ref": "#/components/schemas/ErrorAnswer"}}},
}
# Names of jobs as they stand in examples; a server makes others.
JOB_NAME = "9mQ2mFvVZ1lq2nF3f0n0xA"
NONE_NAME = "Y5oZ7uUeJ0cS4bK1d8w2Lg"
FAMILY_NAME = "c3Rk8tWq5bXo1nZ7yVh0Pw"


def describe_app(app: FastAPI) -> dict[str, Any]:
    """Return the OpenAPI description of the application; it is made at the first call and kept in the application."""
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
    """Add an example's parameters, body and answer to an operation of a description, in place."""
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


class AnswerShape(BaseModel):
    """The base of the shapes: every key is declared, and every declared key is present."""

    model_config = ConfigDict(extra="forbid")


class PlaceAnswer(AnswerShape):
    """A place of a drawing, in mm."""

    x: float
    y: float


class ErrorAnswer(AnswerShape):
    """A sentence that says what is wrong."""

    error: str = Field(description="one sentence, with the remedy")
    place: PlaceAnswer | None = Field(description="where in the drawing, if the sentence names a place")


class JobAddress(AnswerShape):
    """The address of a job that has begun."""

    job: str = Field(description="its name: who knows it can see the job")
    url: str = Field(description="its address, with the version of the interface that was asked")


class ArrangementAnswer(AnswerShape):
    """An arrangement of the fixtures of a toolkit."""

    title: str
    words: str


class JobAnswer(AnswerShape):
    """The state of a job, in the answer to a request and in each event."""

    job: str
    kind: Literal["design", "explore", "family"]
    state: Literal["queued", "running", "listing", "done", "failed", "cancelled"]
    fraction: float = Field(ge=0, le=1, description="how much of it is done")
    found: int = Field(description="fixtures so far")
    best: int = Field(default=0, description="of how many the best are on show while the rest is searched")
    seconds: float = Field(description="since it began")
    counts: dict[str, int] | None = Field(description="all fixtures by type, once it is over")
    distinct: dict[str, int] | None = Field(description="those that no symmetry makes the same")
    listed: int = Field(description="fixtures that can be asked for")
    arrangements: list[ArrangementAnswer]
    ranking: list[str] | None = Field(description="figures of quality, the first decides first")
    complete: bool = Field(description="whether the list has every fixture")
    notes: list[str]
    proof: dict[str, Any] | None = Field(description="the account of the proof, once it is over")
    error: str | None = Field(description="why it failed")
    revision: int = Field(description="grows whenever the fixtures or rows have changed")
    table: list[dict[str, Any]] | None = Field(description="the rows of a comparison")
    request: dict[str, Any] = Field(default={}, description="what was asked; not in events")


@frozen
class ApiExample:
    """An example of a request and its answer.

    Parameters
    ----------
    path, query, headers : values in the path, in the query and in headers, by name.
    body : body as JSON, or as the text of a file.
    status : status of the answer.
    answer : parts of the answer; None where it is neither JSON nor text.
    type : content type of the answer.
    """

    path: dict[str, Any] = field(factory=dict)
    query: dict[str, Any] = field(factory=dict)
    headers: dict[str, str] = field(factory=dict)
    body: Any = None
    status: int = 200
    answer: Any = None
    type: str = "application/json"


PLATE = {
    "name": "plate",
    "loops": [[[0, 0, 0], [60, 0, 0.2], [60, 40, 0], [0, 35, 0]]],
}
# As it is sent.
VISE = json.loads('{"pitch": [10, 10], "columns": 2, "peg_radius": 3}')
SEARCH = {"workpiece": PLATE, "toolkit": VISE}
SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40">'
    '<path d="M0 0H60V40H0Z" fill="none" stroke="black"/></svg>'
)
# The beginning of one: a whole one would fill pages.
NO_STEP = "ISO-10303-21;\nHEADER;\n"
OF_NO_SOLID = {
    "error": "plate.step: the part of this result was not read from a solid at the height of the pegs: "
    "design it again from its STEP file to show its shape.",
    "place": None,
}
PROGRAM = {
    "name": "slot.nc",
    "text": "G21 G90\nT1 M6\nG0 X10 Y20 Z5\nG1 Z-3 F100\nG1 X50 F300\nG0 Z5\nM30\n",
    "tools": {"name": "tools.csv", "text": "tool,diameter\n1,6\n"},
}
LOADS = [{"points": [[30, 20]], "force": 200, "directions": [0, 360]}]
FILE = {"X-Filename": "plate.svg"}
BEGUN = {"job": JOB_NAME, "url": f"/api/v1/jobs/{JOB_NAME}"}
OF_JOB, OF_FIRST = {"name": JOB_NAME}, {"name": JOB_NAME, "rank": 1}
STATE = {"job": JOB_NAME, "kind": "design", "state": "done", "complete": True, "error": None}
EVENT = 'id: 4\nevent: state\ndata: {"job": "' + JOB_NAME + '", "state": "done", "fraction": 1.0}\n\n'
JOB = "/api/v1/jobs/{name}"
FIRST = JOB + "/fixtures/{rank}"

EXAMPLES = {
    "GET /api/v1/about": ApiExample(answer={"limits": {"segments": 2000}}),
    "GET /api/v1/parts": ApiExample(
        answer=[{"name": "8Handle", "title": "round knob with eight lobes, all arcs"}]
    ),
    "GET /api/v1/parts/{name}": ApiExample({"name": "widget"}, answer={"name": "widget", "remarks": []}),
    "POST /api/v1/parts": ApiExample(
        query={"unit": "mm"}, headers=FILE, body=SVG, answer={"name": "plate", "bounds": [0, 0, 60, 40]}
    ),
    "POST /api/v1/parts/survey": ApiExample(
        query={"unit": "mm"}, headers=FILE, body=SVG, answer={"part": {"name": "plate"}, "error": None}
    ),
    "POST /api/v1/parts/check": ApiExample(body=PLATE, answer={"name": "plate", "departure": 0.0}),
    "POST /api/v1/parts/shape": ApiExample(
        query={"job": JOB_NAME},
        headers={"X-Filename": "plate.step"},
        body=NO_STEP,
        status=400,
        answer=OF_NO_SOLID,
    ),
    "POST /api/v1/lesson": ApiExample(body=PLATE, answer={}),
    "POST /api/v1/programs": ApiExample(
        body={"program": PROGRAM, "height": 10}, answer={"moves": 4, "box": [[10, 20, 7], [50, 20, 15]]}
    ),
    "GET /api/v1/toolkits": ApiExample(
        answer=[{"kind": "translating-clamp", "title": "Plate with one clamp or two"}]
    ),
    "GET /api/v1/questions": ApiExample(answer={"search": [{"name": "contact_margin", "form": "length"}]}),
    "GET /api/v1/presets": ApiExample(answer=[{"name": "clamp-plate-20mm", "unit": "mm"}]),
    "GET /api/v1/figures": ApiExample(answer=[{"key": "closure_margin", "more_is_better": True}]),
    "POST /api/v1/jobs": ApiExample(query={"when_left": "keep"}, body=SEARCH, status=202, answer=BEGUN),
    "POST /api/v1/explore": ApiExample(
        body={"workpiece": PLATE, "toolkits": [{**VISE, "title": "ours"}]}, status=202, answer=BEGUN
    ),
    f"GET {JOB}": ApiExample(OF_JOB, answer={**STATE, "counts": {"I": 1040, "II": 427}, "request": SEARCH}),
    f"DELETE {JOB}": ApiExample(OF_JOB, status=204),
    f"POST {JOB}/cancel": ApiExample(OF_JOB, status=202, answer=STATE),
    f"GET {JOB}/events": ApiExample(
        OF_JOB, headers={"last-event-id": "3"}, answer=EVENT, type="text/event-stream"
    ),
    f"GET {JOB}/fixtures": ApiExample(
        OF_JOB,
        {"limit": 5, "sort": "location_error", "angle": "0..90"},
        answer={"total": 679, "rows": [{"rank": 88, "holes": ["L-A4", "L-B1", "R-A2", "R-A6"]}]},
    ),
    f"GET {JOB}/explanation": ApiExample(
        {"name": NONE_NAME}, answer={"helps": [{"change": "with half the pitch", "fixtures": 2}]}
    ),
    f"POST {JOB}/resist": ApiExample(
        OF_JOB, body={"loads": LOADS}, answer={"best": [{"rank": 1109, "load_reaction": 212.223148}]}
    ),
    f"GET {JOB}/result.json": ApiExample(OF_JOB, answer={"format": "workhold-result/1"}),
    f"GET {JOB}/result.csv": ApiExample(OF_JOB, type="text/csv"),
    "POST /api/v1/families": ApiExample(
        body={
            "workpieces": [
                PLATE,
                {**PLATE, "name": "longer", "loops": [[[0, 0, 0], [80, 0, 0.2], [80, 40, 0], [0, 35, 0]]]},
            ],
            "toolkit": VISE,
        },
        status=202,
        answer={"job": FAMILY_NAME, "url": f"/api/v1/jobs/{FAMILY_NAME}"},
    ),
    f"GET {JOB}/family": ApiExample(
        {"name": FAMILY_NAME}, answer={"points": [{"setups": 1, "loss": 1.033943759}]}
    ),
    f"GET {JOB}/family/{{kind}}": ApiExample(
        {"name": FAMILY_NAME, "kind": "sheets.pdf"}, {"setups": 1}, type="application/pdf"
    ),
    f"GET {FIRST}": ApiExample(
        OF_FIRST, {"width": 640, "height": 480}, answer={"rank": 1, "holes": ["L-A4", "L-B1", "R-A1", "R-B5"]}
    ),
    f"GET {FIRST}/small.svg": ApiExample(OF_FIRST, type="image/svg+xml"),
    f"POST {FIRST}/loads": ApiExample(
        OF_FIRST, body={"loads": LOADS, "jaw_force": 3000}, answer={"cases": [{"keeps_contact": True}]}
    ),
    f"POST {FIRST}/supports": ApiExample(
        OF_FIRST, body={"thickness": 12, "best": 3}, answer={"sets": [{"holes": ["L-B3", "R-A2", "R-A4"]}]}
    ),
    f"GET {FIRST}/warnings": ApiExample(
        OF_FIRST,
        {"jaw_force": 3000},
        answer={
            "rank": 1,
            "warnings": [],
            "why_first": "First: no warning; location error 0.0389 mm, the least of all; as drawn.",
        },
    ),
    f"GET {FIRST}/seating": ApiExample(OF_FIRST, answer={"rank": 1, "capture_opening": 1.97524498}),
    f"POST {FIRST}/closing": ApiExample(
        OF_FIRST, body={"theta_deg": 269, "x": 3, "y": 66, "opening": 0.2}, answer={"ending": "wrong"}
    ),
    f"GET {FIRST}/{{kind}}": ApiExample(
        {**OF_FIRST, "kind": "sheet.pdf"}, {"jaw_force": 3000}, type="application/pdf"
    ),
}
