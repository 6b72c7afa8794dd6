"""The interface as its description tells it: versions, the shapes of answers, and examples that are tried.

Whatever is asked, the server answers with what is wrong and never with a mistake of its own.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from running_server import PATIENCE, SQUARE, RunningServer, request

from workhold.web.app import create_app
from workhold.web.description import (
    EXAMPLES,
    FAMILY_NAME,
    JOB_NAME,
    NONE_NAME,
    SEARCH,
    ApiExample,
    ErrorAnswer,
    JobAddress,
    JobAnswer,
)

DESCRIPTION = create_app().openapi()
OPERATIONS = {
    f"{method.upper()} {path}": operation
    for path, operations in DESCRIPTION["paths"].items()
    for method, operation in operations.items()
}
HELD_BY_NOTHING = {
    "workpiece": {"name": "s", "loops": [SQUARE]},
    "toolkit": {"pitch": [50, 50], "columns": 1, "peg_radius": 3},
}


@pytest.fixture(scope="module")
def names(server: RunningServer) -> dict[str, str]:
    """The names of jobs in examples, each with that of a job that is done."""
    family = EXAMPLES["POST /api/v1/families"].body
    urls = {
        JOB_NAME: server.done(SEARCH, "/api/v1/jobs"),
        NONE_NAME: server.done(HELD_BY_NOTHING, "/api/v1/jobs"),
        FAMILY_NAME: server.done(family, "/api/v1/families"),
    }
    return {name: url.rpartition("/")[2] for name, url in urls.items()}


def holds(answer: Any, part: Any) -> bool:
    """Whether an answer has all that an example shows of it."""
    if isinstance(part, dict):
        return all(key in answer and holds(answer[key], value) for key, value in part.items())
    if isinstance(part, list):
        return len(answer) >= len(part) and all(map(holds, answer, part))
    if isinstance(part, float):
        return answer == pytest.approx(part, rel=1e-6)
    # A name of a job that this request has begun.
    is_name = isinstance(part, str) and (JOB_NAME in part or FAMILY_NAME in part)
    return bool(answer == part) or (is_name and len(answer) == len(part))


def asked(server: RunningServer, name: str, example: ApiExample, names: dict[str, str]) -> Any:
    """What is answered to an example."""
    method, path = name.split(" ")
    url = path.format(**{key: names.get(value, value) for key, value in example.path.items()})
    sent = {"content": example.body} if isinstance(example.body, str) else {"json": example.body}
    return server.client.request(
        method,
        url,
        params={key: names.get(value, value) for key, value in example.query.items()},
        headers=example.headers,
        **({} if example.body is None else sent),
    )


@pytest.mark.thorough
@pytest.mark.parametrize("name", [name for name in EXAMPLES if not name.startswith("DELETE")])
def test_examples_are_answered_as_they_say(server: RunningServer, names: dict[str, str], name: str) -> None:
    example = EXAMPLES[name]
    answer = asked(server, name, example, names)
    assert answer.status_code == example.status, answer.text
    assert answer.headers["content-type"].startswith(example.type)
    if example.type == "application/json":
        assert holds(answer.json(), example.answer), answer.text[:2000]
        assert not holds(answer.json(), {"no such key": None} if isinstance(example.answer, dict) else [None])


@pytest.mark.thorough
def test_the_example_of_an_event_is_read_as_one(server: RunningServer, names: dict[str, str]) -> None:
    """Its lines have the names of those that are sent, and its data is part of what they tell."""
    example = EXAMPLES["GET /api/v1/jobs/{name}/events"]
    sent = asked(server, "GET /api/v1/jobs/{name}/events", example, names).text
    shown, told = (
        dict(line.split(": ", 1) for line in text.strip().splitlines()) for text in (example.answer, sent)
    )
    assert list(shown) == list(told) == ["id", "event", "data"]
    assert shown["event"] == told["event"]
    assert holds(json.loads(told["data"]), json.loads(shown["data"]))


@pytest.mark.thorough
def test_a_job_of_an_example_is_deleted(server: RunningServer, names: dict[str, str]) -> None:
    gone = server.done(request())
    answer = asked(
        server,
        "DELETE /api/v1/jobs/{name}",
        EXAMPLES["DELETE /api/v1/jobs/{name}"],
        {JOB_NAME: gone.rpartition("/")[2]},
    )
    assert answer.status_code == 204 and not answer.content
    assert server.client.get(gone).status_code == 404


@pytest.mark.parametrize("name", OPERATIONS)
def test_every_operation_is_described_with_an_example(name: str) -> None:
    """A summary, more words, and the example in its parameters, its request and its answer."""
    operation, example = OPERATIONS[name], EXAMPLES[name]
    assert operation["summary"] and operation["description"]
    given = {**example.path, **example.query, **example.headers}
    shown = {one["name"]: one["example"] for one in operation.get("parameters", ()) if "example" in one}
    assert {key.lower(): value for key, value in shown.items()} == {
        key.lower(): value for key, value in given.items()
    }
    contents = operation.get("requestBody", {}).get("content", {}).values()
    assert [one["example"] for one in contents] == ([] if example.body is None else [example.body])
    answer = operation["responses"][str(example.status)]
    if example.answer is not None:
        assert answer["content"][example.type]["example"] == example.answer


def test_there_is_no_example_of_what_is_not_there() -> None:
    assert set(EXAMPLES) == set(OPERATIONS)


def references(schema: Any) -> Iterator[str]:
    """The names that a schema leads to."""
    if isinstance(schema, dict):
        if isinstance(schema.get("$ref"), str):
            yield schema["$ref"]
        for one in schema.values():
            yield from references(one)
    elif isinstance(schema, list):
        for one in schema:
            yield from references(one)


def test_every_reference_of_the_description_leads_somewhere() -> None:
    shapes = DESCRIPTION["components"]["schemas"]
    found = set(references(DESCRIPTION))
    assert "#/components/schemas/ErrorAnswer" in found
    assert {name.removeprefix("#/components/schemas/") for name in found} <= set(shapes)


@pytest.mark.parametrize("name", OPERATIONS)
def test_errors_have_the_shape_that_is_described(name: str) -> None:
    answers = OPERATIONS[name]["responses"]
    for status in ("400", "401", "403", "404", "429", "503"):
        content = answers[status]["content"]["application/json"]
        assert content["schema"] == {"$ref": "#/components/schemas/ErrorAnswer"}
    assert "422" not in answers


@pytest.mark.thorough
def test_answers_have_the_shapes_that_are_described(server: RunningServer, names: dict[str, str]) -> None:
    """Of jobs of each kind, of addresses, and of errors with a place and without one."""
    for path, form in (("jobs", SEARCH), ("explore", EXAMPLES["POST /api/v1/explore"].body)):
        begun = server.client.post(f"/api/v1/{path}", json=form)
        url = JobAddress.model_validate(begun.json()).url
        assert begun.headers["location"] == url
        server.outcome(url)
        JobAnswer.model_validate(server.client.get(url).json())
    for name in names.values():
        state = server.client.get(f"/api/v1/jobs/{name}").json()
        JobAnswer.model_validate(state)
        with pytest.raises(ValidationError):
            JobAnswer.model_validate({**state, "more": 1})
    crossing = {"name": "x", "loops": [[[0, 0, 0], [10, 10, 0], [10, 0, 0], [0, 10, 0]]]}
    wrong = ErrorAnswer.model_validate(server.client.post("/api/v1/parts/check", json=crossing).json())
    assert wrong.place is not None
    assert ErrorAnswer.model_validate(server.client.get("/api/v1/none").json()).place is None


@pytest.mark.thorough
@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", OPERATIONS)
def test_the_newest_version_is_at_the_address_without_one(server: RunningServer, name: str) -> None:
    """The same is answered there, to a request that asks for what is not there or sends nothing."""
    method, path = name.split(" ")
    url = path.format(name="none", rank=1, kind="sheet.pdf")
    assert url.startswith("/api/v1/")
    answers = [server.client.request(method, one) for one in (url, url.replace("/api/v1/", "/api/"))]
    assert answers[0].status_code == answers[1].status_code != 405
    assert answers[0].content == answers[1].content
    assert "There is nothing at this address" not in answers[0].text


@pytest.mark.thorough
def test_addresses_in_answers_are_of_the_version_that_was_asked(server: RunningServer) -> None:
    for base in ("/api", "/api/v1"):
        url = server.submit(request(), f"{base}/jobs")
        assert url.startswith(f"{base}/jobs/")
        assert server.client.get(f"{base}/openapi.json").json() == DESCRIPTION
    server.outcome(url)
    assert server.client.get(url).json() == server.client.get(url.replace("/api/v1/", "/api/")).json()


@pytest.mark.thorough
def test_a_file_may_be_as_large_at_each_version(server: RunningServer) -> None:
    """More than other requests may be, which only addresses of files take."""
    large = b"<svg>" + b" " * (server.state.limits.request_bytes + 1)
    for base in ("/api", "/api/v1"):
        for path in ("parts", "parts/survey"):
            assert server.client.post(f"{base}/{path}", content=large).status_code != 413
        assert server.client.post(f"{base}/parts/check", content=large).status_code == 413


TRIED = {
    f"{operation.ok().method} {operation.ok().path}".upper(): operation.ok()
    for operation in schemathesis.openapi.from_dict(create_app().openapi()).get_all_operations()
}


@pytest.fixture(scope="module")
def job(server: RunningServer) -> str:
    """The name of a job that is done."""
    return server.done(request()).rpartition("/")[2]


@pytest.mark.thorough
@pytest.mark.parametrize("name", TRIED)
def test_no_request_brings_out_a_mistake(server: RunningServer, job: str, name: str) -> None:
    operation = TRIED[name]

    @given(data=st.data(), exists=st.booleans())
    @settings(
        max_examples=12,
        derandomize=True,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    def answers(data: Any, exists: bool) -> None:
        case = data.draw(operation.as_strategy())
        if exists and "name" in case.path_parameters and operation.method.upper() != "DELETE":
            case.path_parameters["name"] = job
        answer = case.call(base_url=str(server.client.base_url), timeout=PATIENCE)
        assert answer.status_code < 500, answer.text
        if answer.status_code >= 400:
            assert answer.json()["error"].endswith("."), answer.text

    answers()


def test_every_operation_is_asked() -> None:
    assert len(TRIED) >= 19
