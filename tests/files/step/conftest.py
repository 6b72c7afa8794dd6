"""STEP files are read in the process of the tests: starting one of its own takes longer than all that is read here.

What is not about processes cannot see the difference; ``test_damaged`` and ``test_library``, and the tests of
``files.apart``, read in processes as the program does.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib import import_module
from typing import Any

import pytest

# Modules whose tests are about the process.
APART = ("test_damaged", "test_library")


def run_here(module: str, content: bytes, options: Mapping[str, Any], what: str) -> Any:
    """What ``files.apart.run_apart`` returns, by way of JSON as well, so that nothing is passed that JSON does not hold."""
    reader = import_module(module)
    reader.prepare()
    return json.loads(json.dumps(reader.plain(content, **json.loads(json.dumps(dict(options))))))


@pytest.fixture(autouse=True)
def read_here(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Read without a process, where the tests are not about it."""
    if not request.module.__name__.endswith(APART):
        for module in ("reader", "by_height"):
            monkeypatch.setattr(f"workhold.files.step.{module}.run_apart", run_here)
