"""A search made up of prepared results, so that the command line can be tried without a search."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import attrs
import pytest
from typer.testing import CliRunner
from typer.testing import Result as Outcome

from fakes import fake_result
from workhold import Query, Result
from workhold.cli.main import app
from workhold.drawing import convert_svg_to_png

Run = Callable[..., Outcome]


@pytest.fixture(autouse=True)
def small_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw pictures an eighth as wide within this process; how wide they are is tested where they are rendered."""
    monkeypatch.setattr(convert_svg_to_png, "__defaults__", (300,))
    monkeypatch.setattr("workhold.presenting.papers.PNG_WIDTH", 300)


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run the command line within this process; the outcome has ``exit_code``, ``stdout`` and ``stderr``.

    Tables are as wide as they like, whatever width the processes that run tests are told.
    """
    monkeypatch.delenv("COLUMNS", raising=False)

    def invoke(*arguments: object) -> Outcome:
        return CliRunner().invoke(app, [str(argument) for argument in arguments])

    return invoke


@pytest.fixture
def searched(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Replace the search; set ``result`` to what it shall return, find in ``asked`` and ``options`` what it was asked."""
    memory: dict[str, Any] = {"result": fake_result(7), "asked": None, "options": None}

    def answer(query: Query, **options: object) -> Result:
        memory["asked"], memory["options"] = query, options
        options["progress"](0.5, 3)  # type: ignore[operator]
        result: Result = memory["result"]
        return attrs.evolve(result, table=result.table.take(slice(0, query.best)))

    module = ModuleType("workhold.search.design")
    module.answer = answer  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "workhold.search.design", module)
    return memory


@pytest.fixture
def process(tmp_path: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run the command line in a process of its own, in the test's folder."""

    def started(*arguments: object, **options: Any) -> subprocess.CompletedProcess[str]:
        command: Sequence[str] = [
            sys.executable,
            "-m",
            "workhold",
            *(str(argument) for argument in arguments),
        ]
        environment = {**os.environ, "COLUMNS": "100", **options.pop("environment", {})}
        return subprocess.run(
            command,
            capture_output=True,
            text=True,
            timeout=600,
            cwd=tmp_path,
            env=environment,
            check=False,
            **options,
        )

    return started
