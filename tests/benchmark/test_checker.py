"""The stand-alone checker accepts true files of every kind, and refuses each forged one for the right reason."""

from __future__ import annotations

import ast
import json
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import workhold
from benchmark.forgeries import FORGERIES, MANIFEST_ONLY
from workhold.benchmark.catalogue import (
    compute_sha256,
    find_set,
    format_holes_line,
    format_set_text,
    load_manifest,
)

Content = Callable[[str], dict[str, Any]]
TRUE = (
    "kite-vise",
    "bar-plate",
    "bar-pair",
    "el-fence",
    "house-flat-opening",
    "triangle-vise",
    "saddle-opening",
    "el-fence-pair",
    "kite-fence-travel",
    "pentagon-bolted",
    "stadium-vise",
    "widget-rows",
    "house-points",
    "disc-pair",
)
STARTS = 1500
OF_LAST_DIGITS = [f"the checksum of the {what} is not that of the manifest" for what in ("fixtures", "file")]


@pytest.mark.thorough
@pytest.mark.parametrize("name", TRUE)
def test_a_true_file_holds(
    name: str, checker: ModuleType, content: Content, set_texts: Callable[[str], str]
) -> None:
    """Nothing is said against the complete list of a set, with its manifest.

    The last digits are those of a machine's arithmetic; the holes are the same on all machines.
    """
    lines = [line.rstrip(",") for line in set_texts(name).splitlines() if line.startswith('{"type"')]
    assert compute_sha256("\n".join(map(format_holes_line, lines))) == find_set(name).sums["holes"]
    said = checker.check(content(name), set_texts(name), load_manifest(), starts=200)
    assert [one for one in said if one not in OF_LAST_DIGITS] == []


@pytest.mark.thorough
@pytest.mark.parametrize("forgery", FORGERIES)
def test_a_forged_file_is_refused_without_the_manifest(
    forgery: str, checker: ModuleType, content: Content
) -> None:
    """The rules alone find it, and the first fault or one of the others names what was forged."""
    name, change, word = FORGERIES[forgery]
    forged = content(name)
    change(forged)
    assert forged != content(name)
    # Only what is lost has to be found by a search.
    faults = checker.check(forged, starts=STARTS if "lost" in forgery else 0)
    assert faults
    assert any(word in fault for fault in faults), faults


@pytest.mark.thorough
@pytest.mark.parametrize("forgery", [*FORGERIES, *MANIFEST_ONLY])
def test_the_checksums_refuse_every_forgery(forgery: str, checker: ModuleType, content: Content) -> None:
    """With the manifest a change of any digit shows."""
    name, change = (FORGERIES | MANIFEST_ONLY)[forgery][:2]
    forged = content(name)
    change(forged)
    lines = [json.dumps(one) for one in forged.get("fixtures", [])]
    head = {key: value for key, value in forged.items() if key != "fixtures"}
    assert checker.check(forged, format_set_text(head, lines), load_manifest(), starts=0)


def test_there_are_fifty_forgeries() -> None:
    """Fifty or more, each of another kind."""
    assert len(FORGERIES) + len(MANIFEST_ONLY) >= 50


def test_the_checker_imports_numpy_and_python_alone() -> None:
    """It shares nothing with the program whose lists it checks."""
    path = Path(workhold.__file__).parent / "data" / "benchmark" / "check.py"
    imported = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            imported |= {one.name.partition(".")[0] for one in node.names}
        elif isinstance(node, ast.ImportFrom):
            imported.add(str(node.module).partition(".")[0])
    assert imported - set(sys.stdlib_module_names) == {"numpy"}


@pytest.mark.parametrize("text", ["", "[]", '{"format": "workhold-benchmark/1"}'])
def test_what_is_no_set_is_refused(
    text: str, checker: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A file that is none ends in a sentence and the exit code 2."""
    path = tmp_path / "set.json"
    path.write_text(text)
    sys.argv, before = ["check.py", str(path)], sys.argv
    try:
        assert checker.main() == 2
    finally:
        sys.argv = before
    assert capsys.readouterr().out.strip()
