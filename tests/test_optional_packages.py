"""Tests of what needs an extra skip where it is missing, before anything of it is imported."""

from __future__ import annotations

import ast
from pathlib import Path

TESTS = Path(__file__).parent
# What the extra for tests does not install.
OPTIONAL = {"OCP", "anywidget", "build123d", "cadquery", "distributed", "fsspec", "mcp", "pandas", "pyarrow"}


def imported_first(text: str) -> set[str]:
    """The optional packages that a module imports on loading, before it asks whether they are there."""
    found: set[str] = set()
    for statement in ast.parse(text).body:
        if "importorskip" in ast.unparse(statement):
            break
        if isinstance(statement, ast.Import):
            found |= {one.name.partition(".")[0] for one in statement.names}
        elif isinstance(statement, ast.ImportFrom):
            found.add((statement.module or "").partition(".")[0])
    return found & OPTIONAL


def test_no_test_needs_an_extra_to_be_collected() -> None:
    every = {path: imported_first(path.read_text(encoding="utf-8")) for path in TESTS.rglob("*.py")}
    assert {str(path.relative_to(TESTS)): found for path, found in every.items() if found} == {}


def test_an_import_before_the_question_is_found() -> None:
    assert imported_first("import os\nfrom OCP.gp import gp_Pnt\n") == {"OCP"}
    assert imported_first("import pytest\npytest.importorskip('OCP')\nimport OCP\n") == set()
