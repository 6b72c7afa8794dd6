"""A test draws the same examples alone and after any other; of many like cases some are left to ``make prove``.

What needs an extra skips where it is missing, before anything of it is imported.
"""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import tomllib
from importlib import import_module
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st


def test_examples_do_not_depend_on_what_is_imported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A module full of numbers that the strategy could draw changes nothing."""
    drawn: list[list[float]] = []

    @given(st.lists(st.floats(10.0, 50.0), min_size=5))
    def draw(numbers: list[float]) -> None:
        drawn.append(numbers)

    draw()
    (tmp_path / "full_of_numbers.py").write_text(f"NUMBERS = {[10.5 + k / 7 for k in range(200)]}\n")
    monkeypatch.syspath_prepend(tmp_path)
    import_module("full_of_numbers")
    draw()
    assert len(drawn) % 2 == 0 and drawn[: len(drawn) // 2] == drawn[len(drawn) // 2 :]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("number", range(7))
def test_one_case_in_so_many_is_tried_here(number: int, request: pytest.FixtureRequest) -> None:
    """The first, and each third one after it."""
    assert (request.node.get_closest_marker("prove") is not None) == (number % 3 != 0)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("one", range(4))
@pytest.mark.parametrize(("two", "three"), [(0, 0), (1, 1)])
def test_of_two_lists_every_value_is_tried(
    one: int, two: int, three: int, request: pytest.FixtureRequest
) -> None:
    """Each of the first with one of the second, whose two names count once."""
    assert (request.node.get_closest_marker("prove") is not None) == ((one + two) % 2 != 0) and two == three


TESTS = Path(__file__).parent
ROOT = TESTS.parent
# What the extra for tests does not install.
OPTIONAL = {
    "OCP",
    "anywidget",
    "build123d",
    "cadquery",
    "distributed",
    "fsspec",
    "mcp",
    "netgen",
    "ngsolve",
    "pandas",
    "pyarrow",
}


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


@pytest.mark.thorough
def test_no_test_needs_an_extra_to_be_collected() -> None:
    every = {path: imported_first(path.read_text(encoding="utf-8")) for path in TESTS.rglob("*.py")}
    assert {str(path.relative_to(TESTS)): found for path, found in every.items() if found} == {}


def test_an_import_before_the_question_is_found() -> None:
    assert imported_first("import os\nfrom OCP.gp import gp_Pnt\n") == {"OCP"}
    assert imported_first("import pytest\npytest.importorskip('OCP')\nimport OCP\n") == set()


@pytest.mark.thorough
def test_the_examples_of_the_sources_are_collected_without_extras() -> None:
    """Also of modules that ask a library for something later on; those that import it as they are loaded are left out."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT / "src"), str(TESTS)])}
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-p",
        "without_extras",
        "-p",
        "no:cacheprovider",
        "--collect-only",
    ]
    done = subprocess.run(
        [*command, "src"], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "src/workhold/files/step/solids.py" in done.stdout


def test_the_check_on_a_bare_machine_begins_with_what_the_readme_says() -> None:
    """In a clone, by the commands as they stand there, before what only extras need is installed."""
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    clone, extras = script.index("git clone"), script.index("chromium-headless-shell")
    said = set(re.findall(r"^    (make (?:demo|test))(?:  |$)", readme, re.MULTILINE))
    done = re.findall(r"^    (make .*)$", script[clone:extras], re.MULTILINE)
    assert said == set(done) == {"make demo", "make test"} and len(done) == 2
    assert re.findall(r"^make (\w+)", script[:extras], re.MULTILINE) == []


def test_the_check_on_a_bare_machine_tries_every_extra() -> None:
    """With what tests them; the compiler comes with that."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    extras = set(project["project"]["optional-dependencies"]) - {"numba"}
    found = re.findall(r"EXTRAS=(\S+)", (ROOT / ".ci" / "run").read_text(encoding="utf-8"))
    assert len(found) == 2 and all(set(one.split(",")) == extras for one in found)
