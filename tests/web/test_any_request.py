"""Whatever is asked, the server answers with what is wrong and never with a mistake of its own."""

from __future__ import annotations

from typing import Any

import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from running_server import PATIENCE, RunningServer, request

from workhold.web.app import create_app

OPERATIONS = {
    f"{operation.ok().method} {operation.ok().path}".upper(): operation.ok()
    for operation in schemathesis.openapi.from_dict(create_app().openapi()).get_all_operations()
}


@pytest.fixture(scope="module")
def job(server: RunningServer) -> str:
    """The name of a job that is done."""
    return server.done(request()).rpartition("/")[2]


@pytest.mark.parametrize("name", OPERATIONS)
def test_no_request_brings_out_a_mistake(server: RunningServer, job: str, name: str) -> None:
    operation = OPERATIONS[name]

    @given(data=st.data(), exists=st.booleans())
    @settings(
        max_examples=12,
        derandomize=True,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    def holds(data: Any, exists: bool) -> None:
        case = data.draw(operation.as_strategy())
        if exists and "name" in case.path_parameters and operation.method.upper() != "DELETE":
            case.path_parameters["name"] = job
        answer = case.call(base_url=str(server.client.base_url), timeout=PATIENCE)
        assert answer.status_code < 500, answer.text
        if answer.status_code >= 400:
            assert answer.json()["error"].endswith("."), answer.text

    holds()


def test_every_operation_is_asked() -> None:
    assert len(OPERATIONS) >= 19
